#ifndef CONTACT_LOAD_H
#define CONTACT_LOAD_H

#include <contact/history.h>
#include <contact/segment.h>
#include <contact/step.h>

CT_BEGIN_DECLS

/** A traction and a pressure on faces, with a history in time. */
typedef struct ct_load {
  /** What the faces are. */
  ct_face_kind kind;
  /** Number of faces. */
  int32_t face_count;
  /** Node numbers of the problem, shape (face_count, 4 or 8), so that normals point out of the
   * body. */
  const int32_t *faces;
  /** Force for each unit of the undeformed area, of fixed direction [stress]. */
  double traction[3];
  /** Pressure against the normal [stress]. */
  double pressure;
  /** Not zero: the pressure follows the deformed surface, normal and area; zero: it acts as on the
   * undeformed one. */
  int following;
  /** Factor of both in time. */
  ct_history history;
} ct_load;

/**
 * The effect "load", :eq:`load-force`. It stores nothing; its work stands in the ledger. Arrays are
 * copied. The problem is a joined one, see `ct_scene_join`. ``CT_ERROR_ARGUMENT``, ``CT_INVALID``,
 * ``CT_ERROR_GEOMETRY``: what is missing, not finite, or a face without area, named by its number.
 */
CT_API ct_status ct_load_create_effect(const ct_load *load, const ct_problem *problem,
                                       ct_effect **effect, ct_error *error);

CT_END_DECLS

#endif
