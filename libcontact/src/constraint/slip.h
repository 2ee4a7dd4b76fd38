#ifndef CT_SRC_CONSTRAINT_SLIP_H
#define CT_SRC_CONSTRAINT_SLIP_H

#include <math.h>
#include <stdint.h>

/* Coulomb friction at a point in one step: a spring between the two surfaces, whose force stays in
 * a disc, and a reserve of energy that bounds what friction may give back (eq:slip-law). */

enum { CT_SLIP_SUMS = 6 }; /* numbers of a node in the sums of ct_slips */

/* Numbers of a point: first those that the solver reads, of which it replaces those from the
 * elastic slip on; then those that it only writes; and those of its row. A vector fills three. */
enum {
  CT_SLIP_NORMAL = 0,                  /* unit normal of the row */
  CT_SLIP_K = CT_SLIP_NORMAL + 3,      /* stiffness of the tangential spring [force / length] */
  CT_SLIP_E,                           /* elastic slip e_n; afterwards e_{n+1} */
  CT_SLIP_BEFORE = CT_SLIP_E + 3,      /* e_{n-1}; afterwards e_n */
  CT_SLIP_FORCE = CT_SLIP_BEFORE + 3,  /* T of the last step, at t = 0 that with which the iteration
                                          begins; afterwards T, the force on the point's own face */
  CT_SLIP_RESERVE = CT_SLIP_FORCE + 3, /* R of the last step; afterwards of this one */
  CT_SLIP_STUCK,                       /* whether the point stuck in that step, 1 or 0 */
  CT_SLIP_IMAGE,                       /* W T of that step, its motion by all forces T, if it were a
                                          whole one; afterwards of this one */
  CT_SLIP_OPENED = CT_SLIP_IMAGE + 3,  /* by how much these opened the gap, likewise */
  CT_SLIP_WORK,                        /* of T between the middles of two steps (eq:slip-work) */
  CT_SLIP_LAG,   /* correction of the leapfrog's energy at t_n by T (eq:slip-held) */
  CT_SLIP_LEVER, /* d = ȳ - y, from the point to its partner */
  CT_SLIP_WEIGHT = CT_SLIP_LEVER + 3, /* w_b, for each node b of the partner: the force T adds
                                         -(w_b · T) d there (eq:slip-row) */
  CT_SLIP_GIVEN = CT_SLIP_WORK        /* number of those that the solver reads */
};

/* Points with one coefficient of friction. Their numbers stand side by side: number i of point n is
 * `numbers[stride i + n]`. */
typedef struct ct_slips {
  double mu;        /* coefficient of friction */
  int moves;        /* whether the points meet an obstacle that moves */
  double came[3];   /* its motion since the last step */
  double coming[3]; /* and until the next one */
  int64_t stride;
  double *numbers;
  /* Sums of the forces of a step at the nodes of the effect that lists the rows, for each node
   * three of the coarse grid and three of the fine one, of this piece alone (eq:order-free-sum);
   * the solver writes them if there are forces. */
  int32_t node_count;
  double *sums;
  const int32_t *place; /* of these nodes among the solver's, which writes it */
} ct_slips;

/* One of them, to which its row refers. */
typedef struct ct_slip {
  ct_slips *of;
  int64_t at; /* its number */
} ct_slip;

/* Number of the numbers of a point whose partners have at most `nodes` nodes. */
static inline int ct_slip_count(int nodes) { return CT_SLIP_WEIGHT + 3 * nodes; }

/* A number of a point, and a vector. */
static inline double *ct_slip_number(const ct_slip *slip, int number)
{
  return &slip->of->numbers[slip->of->stride * number + slip->at];
}

static inline void ct_slip_vector(const ct_slip *slip, int first, double v[3])
{
  for (int c = 0; c < 3; c++) v[c] = *ct_slip_number(slip, first + c);
}

/* A point without a normal force: its spring is empty, as that of a new point. */
void ct_slip_open(const ct_slip *slip);

/* The allowed forces of a step: |T| <= limit and T · c <= most (eq:slip-set). */
typedef struct ct_slip_set {
  double limit, most, c[3];
} ct_slip_set;

/* The factor of a force with the square `size2` that shortens it to a limit. */
static inline double ct_slip_part(double limit, double size2)
{
  const double size = sqrt(size2), most = size > limit ? size : limit;
  // 1 where the limit is larger; without a branch
  return limit / (most + (most == 0.0 ? 1.0 : 0.0));
}

/* The force of a set that is closest to `T`. */
void ct_slip_project(const ct_slip_set *set, double T[3]);

/* Energies S of the springs and the reserves of the first points at the middle of a step
 * (eq:slip-store). */
void ct_slip_stored(const ct_slips *of, int64_t count, double *stored);

#endif
