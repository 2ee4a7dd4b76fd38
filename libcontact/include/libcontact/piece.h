/* One model on several processes: each steps a piece of a state.
 * Threads: one call at a time per state; all pieces make the same calls at the same time. */
#ifndef LIBCONTACT_PIECE_H
#define LIBCONTACT_PIECE_H

#include <libcontact/step.h>

CT_BEGIN_DECLS

/**
 * A problem that is a part of the whole one: it has all elements around the nodes that its piece
 * moves, in the order of the whole problem, and the whole bounds, shortest edge and first element
 * of each body. Its effects are those of the whole problem, on the nodes that it has.
 */
typedef struct ct_piece_part {
  /** Number of nodes of the whole problem. */
  int32_t node_count;
  /** Number of each node in the whole problem, ascending, shape (node_count of the part). */
  const int32_t *nodes;
  /** Piece of each node in the whole problem, :eq:`piece-owner`, shape of `nodes`. */
  const int32_t *owners;
} ct_piece_part;

/**
 * How a state is cut into pieces, and how these exchange numbers. The first process has the whole
 * problem and its state. The others have the same problem and give the same `owners` and `common`,
 * or each has its `part` of it. Start from `ct_piece_def_default`.
 */
typedef struct ct_piece_def {
  /** Set by `ct_piece_def_default`. */
  int32_t cookie;
  /** Number of the piece of this process, 0 ... `count` - 1. */
  int32_t number;
  /** Number of pieces. */
  int32_t count;
  /** Piece of each element, those of all bodies one after another. A node belongs to the piece with
   * the lowest number among those of its elements, :eq:`piece-owner`. */
  const int32_t *owners;
  /** Null, or nodes of the problem whose motion every piece needs, for example for probes,
   * ascending. The nodes of contacts and obstacles are added. */
  const int32_t *common;
  /** Number of these nodes. */
  int32_t common_count;
  /** Null, or how the problem of this process, not the first one, is a part of the whole one. */
  const ct_piece_part *part;
  /** Sums, and largest numbers, of all pieces. */
  ct_pieces join;
  /**
   * Send the first `send_count[0]` numbers of `send` to piece 0, the next `send_count[1]` to piece
   * 1 and so on, and receive likewise; as ``MPI_Alltoallv``. `data` is that of `join`. Returns 0;
   * another value fails the step.
   */
  int (*exchange)(void *data, const double *send, const int32_t *send_count, double *receive,
                  const int32_t *receive_count);
} ct_piece_def;

/** No piece; the caller sets all members that have no default. */
CT_API ct_piece_def ct_piece_def_default(void);

/**
 * Choose pieces by coordinates: the elements of all bodies are halved across the longest edge of
 * the box around their centres, and so on, :eq:`piece-bisection`. `weights`, shape of `owners`, or
 * null: all 1. Writes the piece of each element into `owners`. ``CT_ERROR_ARGUMENT``: null
 * argument, fewer than 1 piece, or a weight that is not positive.
 */
CT_API ct_status ct_piece_bisect(const ct_problem *problem, int32_t count, const double *weights,
                                 int32_t *owners, ct_error *error);

/**
 * Create the piece of a state that this process steps, with `ct_step` or `ct_run`: it computes the
 * elements around its own nodes and the contact points of its own faces, and gets the forces on
 * other nodes from their owners, :eq:`piece-total`. Its own nodes have the bits of the whole state
 * at each step. All pieces get the state of piece 0. Arrays keep the numbers of the problem, but
 * memory is used only at the nodes that the piece needs; the others are at rest at their reference
 * positions. For results call `ct_state_collect`: calls that need all nodes, such as
 * `ct_ledger_of`, refuse a piece. ``CT_ERROR_UNSUPPORTED``: an effect that can't be computed in
 * pieces: one of a host without `cut`. ``CT_ERROR_ARGUMENT``: invalid definition, or not the same
 * in all pieces.
 */
CT_API ct_status ct_state_cut(const ct_state *whole, const ct_piece_def *def, ct_state **piece,
                              ct_error *error);

/** The same on a process that has no whole state; not the first one. */
CT_API ct_status ct_state_receive(const ct_problem *problem, const ct_piece_def *def,
                                  ct_state **piece, ct_error *error);

/** Write the whole state, from all pieces, into `whole`, a state of the same problem that is not a
 * piece; null: not on this process. All pieces make the call. */
CT_API ct_status ct_state_collect(const ct_state *piece, ct_state *whole, ct_error *error);

/** What one piece computes and exchanges; `ct_piece_counts_of` writes all members. */
typedef struct ct_piece_counts {
  /** Elements that it computes. */
  int64_t elements;
  /** Those of them that `owners` gave it; the others are computed by their owner, too. */
  int64_t own_elements;
  /** Nodes that it owns. */
  int64_t nodes;
  /** Nodes whose force it gets from their owners in each evaluation, three numbers each. */
  int64_t received;
  /** Such forces that it sends; a node counts for each piece that gets it. */
  int64_t sent;
  /** Pieces to which it sends. */
  int32_t neighbours;
  /** Calls of `exchange` so far. */
  int64_t exchanges;
  /** Calls of `join` so far. */
  int64_t joins;
  /** Numbers in them. */
  int64_t joined;
} ct_piece_counts;

/** Counts of a piece. ``CT_ERROR_ARGUMENT``: null argument, or the state is no piece. */
CT_API ct_status ct_piece_counts_of(const ct_state *piece, ct_piece_counts *out, ct_error *error);

CT_END_DECLS

#endif
