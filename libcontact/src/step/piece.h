#ifndef CT_SRC_STEP_PIECE_H
#define CT_SRC_STEP_PIECE_H

#include <libcontact/piece.h>

#include "../base/memory.h"
#include "../base/pieces.h"

/* A plane between pieces: those below it have places with x[axis] < at. */
typedef struct ct_piece_plane {
  double at;
  int axis;
} ct_piece_plane;

/* The nodes of an effect, or of the problem, in those of the whole problem. */
typedef struct ct_piece_numbers {
  int32_t whole; /* number of nodes there */
  int32_t count; /* here */
  int32_t *at;   /* the place of each node there, ascending; null: the same */
} ct_piece_numbers;

/* The piece of a state. Nodes and elements have the numbers of the problem. */
typedef struct ct_piece {
  ct_pool pool;
  const ct_problem *problem;
  ct_piece_def def; /* without its arrays */
  ct_pieces join;   /* counts, and calls that of `def` */
  int32_t *owner;   /* the piece of each node */
  const uint8_t *
      *mine;         /* for each body: 1 for its own elements, 2 for others that it computes, 0 */
  uint64_t *touched; /* nodes of the elements that it computes */
  uint64_t *held;    /* and those that all pieces need: the nodes that it moves */
  int32_t *send_count, *receive_count; /* numbers to and from each piece, three for a node */
  int32_t *sent, *received;            /* the nodes, by pieces */
  double *send, *receive;
  ct_piece_numbers nodes, *effects; /* of the problem, and of each effect */
  ct_piece_plane *planes;           /* between the places of the pieces, shape (pieces - 1) */
  double *passed, *halves;          /* numbers that are collected at once, and twice as many */
  ct_piece_counts counts;
} ct_piece;

/* Whether a node belongs to this piece. */
static inline int ct_piece_owns(const ct_piece *piece, int32_t node)
{
  return piece->owner[node] == piece->def.number;
}

/* The piece that computes the points of a face of a contact, by its place at the reference shape.
 */
int32_t ct_piece_of_face(const ct_piece *piece, int32_t count, const int32_t *nodes);

/* Halve some places, shape (count, 3), as ct_piece_bisect does the elements; the `pieces` - 1
 * planes between the pieces in the order of their numbers. */
ct_status ct_piece_divide(int64_t count, const double *places, int32_t pieces,
                          ct_piece_plane *planes);

/* Refuse a definition without what the pieces need to tell each other anything. */
ct_status ct_piece_check(const ct_piece_def *def, ct_error *error);

/* Refuse definitions that are not the same in all pieces, which all make the call. */
ct_status ct_piece_check_same(const ct_piece *piece, const ct_piece_def *def, ct_error *error);

/* A piece of a problem; free it with ct_pool_free. Nothing is exchanged. */
ct_status ct_piece_create(const ct_problem *problem, const ct_piece_def *def, ct_piece **out,
                          ct_error *error);

/* Get the rows of `values`, shape (node_count, 3), of nodes of other pieces from these. */
ct_status ct_piece_share(ct_piece *piece, double *values, ct_error *error);

/* The same status in all pieces: CT_OK if all have it, else an error in all; null: one piece. */
ct_status ct_piece_agree(const ct_piece *piece, ct_status own, ct_error *error);

/* The same by the functions of a definition, and the largest of some counts. */
ct_status ct_pieces_agree(const ct_pieces *join, ct_status own, int64_t *count, ct_error *error);

/* The same of a piece; null: one piece. */
ct_status ct_piece_agree_on(const ct_piece *piece, ct_status own, int64_t *count, ct_error *error);

/* Numbers that are collected at once. */
enum { CT_COLLECTED = 3 * 8192 };

/* Join numbers of which each is 0 in all pieces but one, to the last bit. */
ct_status ct_piece_collect(const ct_piece *piece, double *values, int64_t count, ct_error *error);

/* For effects that need nothing to be computed in pieces: their force on a node depends on this
 * node alone, or on elements around it. */
ct_status ct_piece_local(const ct_effect *effect, const struct ct_piece *piece, void *scratch,
                         ct_error *error);

/* Refuse a state that is a piece, for calls that need all nodes. */
ct_status ct_piece_refuse(const ct_state *state, ct_error *error);

#endif
