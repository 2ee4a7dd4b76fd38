/* Results of a contact for plots and tests: points, tractions, penetration.
 * Threads: the calls only read the contact; several threads may use one contact at the same time,
 * but not while another call changes it. */
#ifndef LIBCONTACT_CONTACT_RESULT_H
#define LIBCONTACT_CONTACT_RESULT_H

#include <libcontact/contact.h>

CT_BEGIN_DECLS

/** What friction does at a point or at a node in the last step. */
typedef enum ct_friction_state {
  /** no friction, or no normal force */
  CT_FRICTION_NONE = 0,
  /** it sticks; at a node: all of its points that have a force stick */
  CT_FRICTION_STICKS = 1,
  /** it slips; at a node: some of its points slip */
  CT_FRICTION_SLIPS = 2
} ct_friction_state;

/** One contact point, for plots and tests; `ct_contact_points` writes all members. */
typedef struct ct_contact_point {
  /** 0: a point of surface a; 1: of surface b. */
  int32_t side;
  /** Face of the point. */
  int32_t face;
  /** Number of the point on its face. */
  int32_t point;
  /** Closest face of the other surface, or -1 if there is none within the search distance. */
  int32_t other;
  /** Position y [length]. */
  double position[3];
  /** Closest point ȳ on the other surface [length]; NaN when `other` is -1. */
  double closest[3];
  /** Reference coordinates of ȳ on the other face. */
  double xi[2];
  /**
   * Gap in the contact law [length], negative where the point penetrates: the signed distance minus
   * `start_gap`; NaN when `other` is -1.
   */
  double gap;
  /**
   * Force of the point over its weight [stress]: ε⟨-g⟩ for the explicit penalty, otherwise that of
   * the enforcement. Uneven from point to point on unlike meshes and curved surfaces; the pressure
   * to show is that of the nodes, `ct_contact_traction`.
   */
  double raw_pressure;
  /** Weight w J_ref [area]. */
  double weight;
  /**
   * Start gap [length] from which `gap` is measured, :eq:`initial-shift`: negative for an overlap
   * that is kept, positive for a gap that was adjusted, else 0. The signed distance of the point
   * from the other surface is `gap` + `start_gap`.
   */
  double start_gap;
  /** Force of friction on the point's own face over its weight [stress]; 0 without friction. */
  double friction[3];
  /** A ct_friction_state. */
  int32_t slip;
} ct_contact_point;

/** Number of contact points of both surfaces. */
CT_API int64_t ct_contact_point_count(const ct_contact *contact);

/** Write the points of the last update or step, those of surface a first; `points` has the shape
 * (ct_contact_point_count). */
CT_API ct_status ct_contact_points(const ct_contact *contact, ct_contact_point *points,
                                   ct_error *error);

/**
 * Tractions at the nodes of surface `side` (0 or 1), recovered from the forces of the last update
 * or step without friction, and averaged over both passes and the faces around a node,
 * :eq:`recovered-traction`. At the rim of a contact it is the mean over the faces around the node,
 * in contact or not. With `side` = 2 + k the tractions of obstacle k at the nodes of its
 * surface. The pressure at a node is the magnitude of its traction. The sum of area times traction
 * is the force on the surface; the sum of their moments is the moment of this force if edges are
 * straight. Entries of nodes that are not on the surface do not change.
 *
 * `traction` [stress], shape (node_count, 3): force on the surface per reference area; 0 where no
 * face has contact forces. `area` [area], shape (node_count): the part of the faces around a node
 * that takes its force, :eq:`recovered-fraction`; 0 where no force is near.
 * ``CT_ERROR_ARGUMENT``: null argument or unknown side; ``CT_ERROR_MEMORY``: out of memory.
 */
CT_API ct_status ct_contact_traction(const ct_contact *contact, int32_t side, double *traction,
                                     double *area, ct_error *error);

/**
 * Tractions of friction at the nodes of surface `side`, 0 or 1, on the areas that
 * `ct_contact_traction` writes, :eq:`recovered-friction`: area times the sum of both tractions is
 * the whole force of the contact on the surface. `traction` [stress] has the shape (node_count, 3).
 * `slip`, shape (node_count), is a ct_friction_state for each node, from the points of both sides
 * that are nearest to it. Entries of nodes that are not on the surface do not change.
 * ``CT_ERROR_ARGUMENT``: null argument or unknown side; ``CT_ERROR_MEMORY``: out of memory.
 */
CT_API ct_status ct_contact_friction(const ct_contact *contact, int32_t side, double *traction,
                                     int32_t *slip, ct_error *error);

/** Positions at which penetration is measured. */
typedef enum ct_penetration_at {
  /** The points of the contact. */
  CT_AT_POINTS,
  /** The corners of all faces. */
  CT_AT_CORNERS,
  /** The middles of the edges of all faces. */
  CT_AT_EDGES
} ct_penetration_at;

/**
 * Penetration of two surfaces by true distances, without start gaps; `ct_contact_penetration`
 * writes all members.
 */
typedef struct ct_penetration {
  /** Number of positions that penetrate; a corner or an edge counts once per face. */
  int64_t inside;
  /**
   * Number of points among them that are not in contact, because they did not enter from outside,
   * :eq:`point-status`; 0 at corners and edges.
   */
  int64_t buried;
  /** Depth of the deepest position that is not buried [length]; 0 when there is none. */
  double deepest;
  /** Surface of the deepest position, 0 or 1; -1 when there is none. */
  int32_t side;
  /** Its face; -1 when there is none. */
  int32_t face;
  /** Its position [length]; NaN when there is none. */
  double position[3];
  /**
   * Depth [length] up to which two surfaces count as touching: 1e-9 of the largest face, or the
   * rounding of their coordinates if that is larger.
   */
  double touching;
  /**
   * Number of points that were found deeper than 0.01 of the largest face since the start, without
   * having come in through the surface, :eq:`admitted`; a point counts each time; 0 at corners and
   * edges.
   */
  int64_t late;
  /** Largest of their depths [length]. */
  double late_depth;
} ct_penetration;

/**
 * Penetration at the coordinates of the last update: at the contact points, or at corners or edges,
 * where a contact with Gauss points has no points. ``CT_ERROR_UNSUPPORTED``: corners or edges of a
 * surface in contact with itself.
 */
CT_API ct_status ct_contact_penetration(const ct_contact *contact, ct_penetration_at at,
                                        ct_penetration *out, ct_error *error);

/** Penetration into an obstacle of a host's contact after its last step. ``CT_ERROR_ARGUMENT``:
 * null argument, unknown obstacle or place, or the last call was not a successful step. */
CT_API ct_status ct_contact_obstacle_penetration(const ct_contact *contact, int32_t obstacle,
                                                 ct_penetration_at at, ct_penetration *out,
                                                 ct_error *error);

CT_END_DECLS

#endif
