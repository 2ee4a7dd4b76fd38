/* Pieces of a state on the processes of MPI: the add-on library libcontact-mpi.
 * Threads: MPI_THREAD_SINGLE suffices; all calls come from the thread that steps the state. */
#ifndef LIBCONTACT_MPI_H
#define LIBCONTACT_MPI_H

#include <libcontact/piece.h>

#include <mpi.h>

CT_BEGIN_DECLS

/** The communicator of the pieces, and memory for their counts; opaque. */
typedef struct ct_mpi ct_mpi;

/**
 * Let the processes of a communicator, which is duplicated, exchange the numbers of pieces: sets
 * `number`, `count`, `join` and `exchange` of the definition. The caller frees `*mpi` after all
 * states that were cut with it, and before ``MPI_Finalize``. All processes make the call.
 */
CT_API ct_status ct_mpi_create(MPI_Comm comm, ct_piece_def *def, ct_mpi **mpi, ct_error *error);

/** Free it; null is allowed. All processes make the call. */
CT_API void ct_mpi_free(ct_mpi *mpi);

CT_END_DECLS

#endif
