#include "facets.h"

#include <libcontact/base.h>

#include "../base/error.h"
#include "../base/memory.h"

void ct_facets_free(ct_facets *facets)
{
  if (facets == NULL) return;
  ct_release(facets->faces);
  ct_incidence_release(&facets->incidence);
  ct_release(facets);
}

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
                           ct_facets **out, ct_error *error)
{
  int per = ct_face_node_count(kind);
  if (faces == NULL || face_count < 1 || per == 0)
    return ct_fail(error, CT_ERROR_ARGUMENT, CT_NOWHERE, "%s: the surface has no faces", name);
  ct_facets *facets = ct_allocate(1, sizeof *facets);
  size_t entries = (size_t)face_count * (size_t)per;
  ct_status status = CT_ERROR_MEMORY;
  if (facets != NULL) {
    facets->kind = kind, facets->per = per, facets->face_count = face_count;
    facets->faces = ct_duplicate(faces, entries * sizeof *faces);
  }
  if (facets != NULL && facets->faces != NULL) {

    ct_rule_face(kind, 0, &facets->rule);
    for (int q = 0; q < facets->rule.count; q++) {
      ct_segment_shape(kind, facets->rule.xi[q], facets->N[q]);
      ct_segment_gradient(kind, facets->rule.xi[q], facets->dN[q]);
    }
    status = check_faces(facets, node_count, reference, name, error);
    if (status == CT_OK)
      status = ct_incidence_init(&facets->incidence, (int64_t)entries, faces, node_count, NULL);
    facets->nodes = facets->incidence.nodes;
    facets->node_count = facets->incidence.count;
  }
  if (status == CT_ERROR_MEMORY) ct_fail(error, status, CT_NOWHERE, "%s: no memory", name);
  if (status != CT_OK) ct_facets_free(facets);
  else *out = facets;
  return status;
}

void ct_facets_sum(const ct_facets *facets, const double *values, double *terms, double *sums)
{
  const ct_incidence *at = &facets->incidence;
  for (int32_t i = 0; i < facets->node_count; i++)
    for (int c = 0; c < 3; c++) {
      int32_t count = at->first[i + 1] - at->first[i];
      for (int32_t k = 0; k < count; k++)
        terms[k] = values[3 * (int64_t)at->place[at->first[i] + k] + c];
      sums[3 * (int64_t)i + c] = ct_sum(terms, count);
    }
}
