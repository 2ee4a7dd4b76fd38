#include "polynomial.h"

CT_CLONES
ct_status ct_patch_init(ct_patch *patch, ct_face_kind kind, const double node[8][3],
                        const double point[3])
{
  double v[8][4], p[4] = {point[0], point[1], point[2], 0};
  int count = ct_face_node_count(kind);
  if (count == 0) return CT_INVALID;
  for (int i = 0; i < count; i++)
    v[i][0] = node[i][0], v[i][1] = node[i][1], v[i][2] = node[i][2], v[i][3] = 0;
  patch->kind = kind;
  return patch_from((const double (*)[4])v, p, patch) ? CT_OK : CT_INVALID;
}

double ct_patch_value(const ct_patch *patch, const double xi[2], double d[3])
{
  double e[4], f = value(patch, xi, e);
  for (int k = 0; k < 3; k++) d[k] = e[k];
  return f;
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
