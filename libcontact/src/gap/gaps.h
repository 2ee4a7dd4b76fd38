#ifndef CT_SRC_GAPS_H
#define CT_SRC_GAPS_H

#include "../base/list.h"
#include "side.h"

/* Constant data of the gaps between two surfaces, of one with itself, or of one with an obstacle,
 * which has only the members from `approach` on that do not concern a search. */
typedef struct ct_gaps_fixed {
  ct_project_options project; /* method and tolerance of the search */
  double depth; /* search distance of points at the start, and largest depth at which a point comes
                   into contact */
  double near;  /* search distance of points afterwards (eq:contact-near) */
  double approach; /* the largest safe approach of the surfaces in a step (eq:tunnelling) */
  double skin;     /* additional distance to which candidates are listed */
  int sides;       /* 2, or 1 for a surface with itself or an obstacle without stations */
  int alone;       /* whether the surface touches neither another one nor itself */
  ct_side_fixed side[2];
  int64_t point_count; /* of all sides */
  int32_t *place[2];   /* places of the nodes of each side in one list of the nodes of both; null:
                          the nodes of the only surface, in order */
} ct_gaps_fixed;

/* Number of sides with nodes: all but stations. */
static inline int ct_gaps_surfaces(const ct_gaps_fixed *fixed)
{
  return fixed->sides - (fixed->side[fixed->sides - 1].kind == CT_SIDE_STATIONS);
}

/* The surface on whose faces the points of side `s` act. */
static inline int ct_gaps_surface(const ct_gaps_fixed *fixed, int s)
{
  return fixed->side[s].kind == CT_SIDE_STATIONS ? 0 : s;
}

/* Place of node `n` of surface `s` in the list of the nodes of both. */
static inline int32_t ct_gaps_node(const ct_gaps_fixed *fixed, int s, int32_t n)
{
  return fixed->place[s] == NULL ? n : fixed->place[s][n];
}

/* Length of the row of nodes from node `n` of surface `s` on whose places there are consecutive. */
static inline int32_t ct_gaps_row(const ct_gaps_fixed *fixed, int s, int32_t n)
{
  const int32_t count = fixed->side[s].search->node_count - n;
  return fixed->place[s] == NULL ? count : ct_row_length(&fixed->place[s][n], count);
}

/* The same at a time. */
typedef struct ct_gaps {
  const ct_gaps_fixed *fixed;
  int begun;    /* whether the points have a status */
  int start;    /* whether this is t = 0 of a scene */
  int built;    /* whether the candidate lists exist */
  double reach; /* the search distance of points for which they were made */
  double since; /* bound of the motion of the surfaces relative to each other since then */
  double clear; /* not 0: when they were built, no two faces were nearer than the search distance of
                   points plus this (eq:contact-clear) */
  ct_side side[2];
} ct_gaps;

/* Mark the faces of the only surface that a face across an edge faces now, as where a wall is
 * folded flat; returns whether there are any (eq:self-adjacent). */
int ct_gaps_mark_creases(ct_gaps *gaps);

/* Update the candidates of all faces; and whether the update is not needed, because the surfaces
 * are too far apart to touch (eq:contact-clear). */
ct_status ct_gaps_list_candidates(ct_gaps *gaps, ct_error *error);
int ct_gaps_are_separated(const ct_gaps *gaps);

/* Present search distance of points: `depth` at the start, when initial penetrations and gaps are
 * unknown; afterwards less, because a point that comes into contact was near before
 * (eq:contact-near). */
double ct_gaps_reach(const ct_gaps *gaps);

/* Move the nodes of all surfaces to the coordinates in `moved`; or none, if one is not finite. */
ct_status ct_gaps_place(ct_gaps *gaps, ct_error *error);

/* Closest points of all points at the coordinates in `moved` of the sides; or those of one side. */
ct_status ct_gaps_measure(ct_gaps *gaps, int threads, ct_error *error);
void ct_pass_search(ct_gaps *gaps, int s, int wanted);

/* Search distance of points after the start, and largest safe approach of two surfaces in a step,
 * with a depth that is `given` and gaps up to `adjust` that are closed at the start; and refuse a
 * step of length `dt` to `time` with a larger approach, given the velocities in the list of the
 * nodes of both sides (eq:tunnelling). */
ct_status ct_tunnelling_init(ct_gaps_fixed *fixed, int given, double adjust);
ct_status ct_tunnelling_check(ct_gaps *gaps, const double *velocity, double dt, double time,
                              ct_error *error);

/* Width of the narrowest face of a surface, and the largest safe approach of a place to it in a
 * step: this width, or 3/4 of the smallest thickness (eq:tunnelling). */
ct_status ct_tunnelling_surface(const ct_search *search, double *narrowest, double *approach);

/* Bounding box of `values` at the nodes of a surface, indexed by `nodes`, or in order if that is
 * null. */
void ct_tunnelling_box(const ct_search *search, const int32_t *nodes, const double *values,
                       ct_bounds *box);

#endif
