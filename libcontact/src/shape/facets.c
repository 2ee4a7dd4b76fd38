#include "facets.h"

#include <libcontact/base.h>

#include "../base/error.h"
#include "../base/memory.h"

#include <string.h>

void ct_facets_free(ct_facets *facets)
{
  if (facets == NULL) return;
  ct_release(facets->faces);
  ct_release(facets->nodes);
  ct_release(facets->first);
  ct_release(facets->place);
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

/* List the nodes, and for each the places of its values. */
static ct_status list_nodes(ct_facets *facets, int32_t node_count)
{
  int64_t entries = (int64_t)facets->face_count * facets->per;
  int32_t *number = ct_allocate((size_t)node_count + 1, sizeof *number);
  facets->place = ct_allocate((size_t)entries, sizeof *facets->place);
  if (number == NULL || facets->place == NULL) {
    ct_release(number);
    return CT_ERROR_MEMORY;
  }
  for (int64_t i = 0; i < entries; i++) number[facets->faces[i]] = 1;
  for (int32_t n = 0; n < node_count; n++) facets->node_count += number[n];
  facets->nodes = ct_allocate((size_t)facets->node_count, sizeof *facets->nodes);
  facets->first = ct_allocate((size_t)facets->node_count + 2, sizeof *facets->first);
  if (facets->nodes != NULL && facets->first != NULL) {
    for (int32_t n = 0, next = 0; n < node_count; n++)
      if (number[n]) facets->nodes[next] = n, number[n] = next++;
    // Count, sum up, and fill: first[i + 1] is where the next place of node i goes.
    for (int64_t i = 0; i < entries; i++) facets->first[number[facets->faces[i]] + 2]++;
    for (int32_t n = 0; n < facets->node_count; n++) {
      facets->most = facets->first[n + 2] > facets->most ? facets->first[n + 2] : facets->most;
      facets->first[n + 2] += facets->first[n + 1];
    }
    for (int64_t i = 0; i < entries; i++)
      facets->place[facets->first[number[facets->faces[i]] + 1]++] = (int32_t)i;
  }
  ct_release(number);
  return facets->nodes != NULL && facets->first != NULL ? CT_OK : CT_ERROR_MEMORY;
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
    facets->faces = ct_allocate(entries, sizeof *facets->faces);
  }
  if (facets != NULL && facets->faces != NULL) {
    memcpy(facets->faces, faces, entries * sizeof *faces);
    ct_rule_face(kind, &facets->rule);
    for (int q = 0; q < facets->rule.count; q++) {
      ct_segment_shape(kind, facets->rule.xi[q], facets->N[q]);
      ct_segment_gradient(kind, facets->rule.xi[q], facets->dN[q]);
    }
    status = check_faces(facets, node_count, reference, name, error);
    if (status == CT_OK) status = list_nodes(facets, node_count);
  }
  if (status == CT_ERROR_MEMORY) ct_fail(error, status, CT_NOWHERE, "%s: no memory", name);
  if (status != CT_OK) ct_facets_free(facets);
  else *out = facets;
  return status;
}

void ct_facets_sum(const ct_facets *facets, const double *values, double *terms, double *sums)
{
  for (int32_t i = 0; i < facets->node_count; i++)
    for (int c = 0; c < 3; c++) {
      int32_t count = facets->first[i + 1] - facets->first[i];
      for (int32_t k = 0; k < count; k++)
        terms[k] = values[3 * (int64_t)facets->place[facets->first[i] + k] + c];
      sums[3 * (int64_t)i + c] = ct_sum(terms, count);
    }
}
