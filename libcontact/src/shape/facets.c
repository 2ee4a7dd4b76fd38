#include "facets.h"

#include <libcontact/base.h>

#include "../base/error.h"
#include "../base/vector.h"

#include <math.h>

void ct_facets_face(const ct_facets *facets, int32_t face, const double *x, const double *u,
                    ct_face *out)
{
  out->kind = facets->kind;
  for (int a = 0; a < facets->per; a++)
    for (int c = 0; c < 3; c++) {
      int64_t dof = 3 * (int64_t)facets->faces[(int64_t)face * facets->per + a] + c;
      out->node[a][c] = u == NULL ? x[dof] : x[dof] + u[dof];
    }
}

static ct_status check_faces(const ct_facets *facets, int32_t node_count, const double *reference,
                             const char *name, ct_error *error)
{
  for (int64_t i = 0; i < (int64_t)facets->face_count * facets->per; i++)
    if (facets->faces[i] < 0 || facets->faces[i] >= node_count)
      return ct_fail(error, CT_ERROR_ARGUMENT, (ct_place){-1, i / facets->per, facets->faces[i]},
                     "%s: face %d names node %d, there are nodes 0 to %d", name,
                     (int)(i / facets->per), (int)facets->faces[i], (int)node_count - 1);
  for (int32_t f = 0; f < facets->face_count; f++) {
    ct_face face;
    ct_facets_face(facets, f, reference, NULL, &face);
    for (int q = 0; q < facets->rule.count; q++)
      if (!(ct_segment_area_element(&face, facets->rule.xi[q]) > 0.0))
        return ct_fail(error, CT_ERROR_GEOMETRY, (ct_place){-1, f, q},
                       "%s: face %d has no area at Gauss point %d", name, (int)f, q);
  }
  return CT_OK;
}

ct_status ct_facets_create(ct_face_kind kind, int32_t face_count, const int32_t *faces,
                           int32_t node_count, const double *reference, const char *name,
                           ct_pool *pool, ct_facets *out, ct_error *error)
{
  int per = ct_face_node_count(kind);
  if (faces == NULL || face_count < 1 || per == 0)
    return CT_REFUSE(error, "%s: the surface has no faces", name);
  size_t entries = (size_t)face_count * (size_t)per;
  out->kind = kind, out->per = per, out->face_count = face_count;
  out->faces = ct_pool_copy(pool, faces, entries * sizeof *faces);
  if (out->faces == NULL) return CT_NO_MEMORY(error, "%s", name);
  ct_rule_face(kind, &out->rule, NULL);
  for (int q = 0; q < out->rule.count; q++) {
    ct_segment_shape(kind, out->rule.xi[q], out->N[q]);
    ct_segment_gradient(kind, out->rule.xi[q], out->dN[q]);
  }
  ct_status status = check_faces(out, node_count, reference, name, error);
  if (status != CT_OK) return status;
  if (ct_incidence_init(&out->incidence, (int64_t)entries, faces, node_count, NULL, pool) != CT_OK)
    return CT_NO_MEMORY(error, "%s", name);
  out->nodes = out->incidence.nodes;
  out->node_count = out->incidence.count;
  return CT_OK;
}

void ct_facets_areas(const ct_facets *facets, const ct_face *face, double area[25][3],
                     double length[25])
{
  for (int q = 0; q < facets->rule.count; q++) {
    double t1[3], t2[3];
    ct_segment_tangents(face, facets->rule.xi[q], t1, t2);
    ct_vector_cross(t1, t2, area[q]);
    length[q] = sqrt(ct_vector_dot(area[q], area[q]));
  }
}

size_t ct_facets_value_count(const ct_facets *facets, int components)
{
  return (size_t)facets->face_count * (size_t)(facets->per * components) +
         (size_t)facets->incidence.most;
}

void ct_facets_sum(const ct_facets *facets, int components, double *values, double *sums)
{
  const ct_incidence *at = &facets->incidence;
  double *terms = values + (int64_t)facets->face_count * facets->per * components;
  for (int32_t i = 0; i < facets->node_count; i++)
    for (int c = 0; c < components; c++) {
      int32_t count = at->first[i + 1] - at->first[i];
      for (int32_t k = 0; k < count; k++)
        terms[k] = values[components * (int64_t)at->place[at->first[i] + k] + c];
      sums[components * (int64_t)i + c] = ct_sum(terms, count);
    }
}
