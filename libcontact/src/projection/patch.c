#include "polynomial.h"

CT_CLONES
ct_status ct_patch_init(ct_patch *patch, ct_face_kind kind, const double node[8][3],
                        const double point[3])
{
  if (ct_face_node_count(kind) == 0) return CT_INVALID;
  patch->kind = kind;
  return patch_from(node, point, patch) ? CT_OK : CT_INVALID;
}

double ct_patch_value(const ct_patch *patch, const double xi[2], double d[3])
{
  return value(patch, xi, d);
}

int ct_patch_normal(const ct_patch *patch, const double xi[2], double n[3])
{
  return normal(patch, xi, n);
}

ct_where ct_patch_where(ct_face_kind kind, const double xi[2], double slack, int *index)
{
  *index = -1;
  int triangular = ct_is_triangular(kind), touched[4] = {0}, edges = triangular ? 3 : 4;
  if (!triangular && fabs(xi[0]) < 1 - slack && fabs(xi[1]) < 1 - slack) return CT_INTERIOR;
  // -- Distance to each edge, positive inside
  double inside[4] = {xi[1], 1 - (xi[0] + xi[1]), xi[0], 1};
  if (!triangular)
    inside[0] = 1 + xi[1], inside[1] = 1 - xi[0], inside[2] = 1 - xi[1], inside[3] = 1 + xi[0];
  for (int i = 0; i < edges; i++) {
    if (!(inside[i] >= -slack)) return CT_OUTSIDE;
    touched[i] = inside[i] <= slack;
    if (touched[i]) *index = i;
  }
  if (*index < 0) return CT_INTERIOR;
  // -- Corner i lies between edges i - 1 and i
  for (int i = 0; i < edges; i++)
    if (touched[i] && touched[(i + edges - 1) % edges]) {
      *index = i;
      return CT_VERTEX;
    }
  return CT_EDGE;
}
