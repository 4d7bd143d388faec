/* Processes of a sweep, by MPI (lag_ranks of lag.h). Waiting gives the processor away: MPI's own waiting takes all
 * of it. */
#include <limits.h>
#include <mpi.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "lag.h"

enum { BRIEF = 200, NAP = 500 }; /* looks without a nap; [us] */

/* Call k of a wait. */
static void rest(int k) {
  if (k >= BRIEF) nanosleep(&(struct timespec){.tv_nsec = 1000 * NAP}, NULL);
}

static int join(int *rank, int *n) {
  int level;
  if (MPI_Init_thread(NULL, NULL, MPI_THREAD_SERIALIZED, &level) || level < MPI_THREAD_SERIALIZED) return -1;
  MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
  return MPI_Comm_rank(MPI_COMM_WORLD, rank) || MPI_Comm_size(MPI_COMM_WORLD, n) ? -1 : 0;
}

/* Until the request is done. */
static int finish(MPI_Request *r) {
  int done = 0;
  for (int k = 0; !done; k += k < BRIEF) {
    if (MPI_Test(r, &done, MPI_STATUS_IGNORE)) return -1;
    if (!done) rest(k);
  }
  return 0;
}

static int share(void *bytes, size_t n) {
  MPI_Request r;
  return n > INT_MAX || MPI_Ibcast(bytes, (int)n, MPI_BYTE, 0, MPI_COMM_WORLD, &r) ? -1 : finish(&r);
}

/* Messages on their way. One to a process that died stays here: a send never waits. */
typedef struct Sent {
  struct Sent *next;
  MPI_Request request;
  char bytes[];
} Sent;

static Sent *sent;

/* Frees those that have arrived. */
static void look_at_sent(void) {
  for (Sent **at = &sent; *at;) {
    Sent *m = *at;
    int done = 0;
    MPI_Test(&m->request, &done, MPI_STATUS_IGNORE);
    if (done) *at = m->next, free(m);
    else at = &m->next;
  }
}

static int send_bytes(int rank, const void *bytes, size_t n) {
  Sent *m = n > INT_MAX ? NULL : malloc(sizeof *m + n);
  look_at_sent();
  if (!m) return -1;
  memcpy(m->bytes, bytes, n);
  m->next = sent;
  if (MPI_Isend(m->bytes, (int)n, MPI_BYTE, rank, 0, MPI_COMM_WORLD, &m->request)) return free(m), -1;
  sent = m;
  return 0;
}

static int receive(void *bytes, size_t *n, int wait) {
  MPI_Status s;
  int there = 0, size = 0;
  look_at_sent();
  for (int k = 0; !there && k < BRIEF + wait / NAP; k++) {
    if (MPI_Iprobe(MPI_ANY_SOURCE, 0, MPI_COMM_WORLD, &there, &s)) return -1;
    if (!there) rest(k);
  }
  if (!there || MPI_Get_count(&s, MPI_BYTE, &size) || (size_t)size > *n ||
      MPI_Recv(bytes, size, MPI_BYTE, s.MPI_SOURCE, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE))
    return -1;
  *n = (size_t)size;
  return s.MPI_SOURCE;
}

static void leave(void) {
  for (Sent *m = sent; m; m = m->next) finish(&m->request);
  look_at_sent();
  MPI_Finalize();
}

static void end(int status) { MPI_Abort(MPI_COMM_WORLD, status); }

const lag_ranks lag_mpi = {
    .join = join, .share = share, .send = send_bytes, .receive = receive, .leave = leave, .end = end};
