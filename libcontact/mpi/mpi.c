/* The exchange of pieces by MPI: two reductions, and messages between neighbours. */
#include <libcontact/mpi.h>

#include <limits.h>
#include <stdlib.h>
#include <string.h>

struct ct_mpi {
  MPI_Comm comm;
  int count;
  MPI_Request *requests; /* two for each process */
};

enum { TAG = 1 };

/* Larger arrays go in several calls, whose counts are ints. */
static int reduce(ct_mpi *mpi, double *values, int64_t count, MPI_Op op)
{
  int failed = 0;
  for (int64_t first = 0, some; !failed && first < count; first += some) {
    some = count - first < INT_MAX ? count - first : INT_MAX;
    failed = MPI_Allreduce(MPI_IN_PLACE, values + first, (int)some, MPI_DOUBLE, op, mpi->comm) !=
             MPI_SUCCESS;
  }
  return failed;
}

static int sum(void *data, double *values, int64_t count)
{
  return reduce(data, values, count, MPI_SUM);
}

static int largest(void *data, double *values, int64_t count)
{
  return reduce(data, values, count, MPI_MAX);
}

/* Messages to and from the neighbours only. */
static int exchange(void *data, const double *send, const int32_t *send_count, double *receive,
                    const int32_t *receive_count)
{
  ct_mpi *mpi = data;
  int open = 0, failed = 0;
  for (int p = 0; p < mpi->count; receive += receive_count[p++])
    if (receive_count[p] > 0)
      failed |= MPI_Irecv(receive, receive_count[p], MPI_DOUBLE, p, TAG, mpi->comm,
                          &mpi->requests[open++]) != MPI_SUCCESS;
  for (int p = 0; p < mpi->count; send += send_count[p++])
    if (send_count[p] > 0)
      failed |= MPI_Isend(send, send_count[p], MPI_DOUBLE, p, TAG, mpi->comm,
                          &mpi->requests[open++]) != MPI_SUCCESS;
  failed |= MPI_Waitall(open, mpi->requests, MPI_STATUSES_IGNORE) != MPI_SUCCESS;
  return failed;
}

static ct_status refuse(ct_error *error, ct_status status, const char *text)
{
  if (error != NULL) {
    *error = (ct_error){.code = status, .body = -1, .element = -1, .point = -1};
    strncpy(error->text, text, sizeof error->text - 1);
  }
  return status;
}

ct_status ct_mpi_create(MPI_Comm comm, ct_piece_def *def, ct_mpi **out, ct_error *error)
{
  int rank;
  if (def == NULL || out == NULL || comm == MPI_COMM_NULL)
    return refuse(error, CT_ERROR_ARGUMENT, "ct_mpi_create: a required argument is null");
  ct_mpi *mpi = calloc(1, sizeof *mpi);
  if (mpi == NULL) return refuse(error, CT_ERROR_MEMORY, "out of memory");
  MPI_Comm_dup(comm, &mpi->comm);
  MPI_Comm_rank(mpi->comm, &rank);
  MPI_Comm_size(mpi->comm, &mpi->count);
  mpi->requests = calloc(2 * (size_t)mpi->count, sizeof(MPI_Request));
  if (mpi->requests == NULL) {
    ct_mpi_free(mpi);
    return refuse(error, CT_ERROR_MEMORY, "out of memory");
  }
  def->number = rank, def->count = mpi->count;
  def->join = (ct_pieces){mpi, sum, largest};
  def->exchange = exchange;
  *out = mpi;
  return CT_OK;
}

void ct_mpi_free(ct_mpi *mpi)
{
  if (mpi == NULL) return;
  MPI_Comm_free(&mpi->comm);
  free(mpi->requests);
  free(mpi);
}
