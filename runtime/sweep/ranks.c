/* A sweep on several processes (run_chunks_impl.h). A rank that asks gets as many chunks as take it about 50 ms,
 * more where many ranks ask, fewer near the end. */
#include "sweep/run_chunks_impl.h"

#include <errno.h>
#include <math.h>
#include <stddef.h>

#include "numeric/clock.h"

enum { WAIT = 100000 }; /* of receive, between looks at signals [us] */

static size_t chunk_size(const Sweep *s) { return (size_t)s->chunk * lag_sweep_numbers(s); }

static size_t batch_bytes(const Sweep *s, int64_t n) {
  return offsetof(Batch, row) + (size_t)n * chunk_size(s) * sizeof(double);
}

/* Chunks of a message: up to a megabyte of rows. */
static int64_t batch_room(const Sweep *s) {
  const double bytes = 1 << 20;
  return (int64_t)fmax(1, fmin(BATCH_MOST, bytes / (double)(chunk_size(s) * sizeof(double))));
}

Batch *lag_batch_new(const Sweep *s) { return calloc(1, batch_bytes(s, batch_room(s))); }

double *lag_batch_row(const Sweep *s, Batch *b, int64_t k) { return b->row + (size_t)k * chunk_size(s); }

/* ---- Rank 0 */

typedef struct Server {
  Pool *pool;
  Batch *b;
  double *heard; /* [nranks] time of the last message, INFINITY: the rank has left [s] */
} Server;

/* Number of chunks for a rank that made b. README.md has the reasons of the numbers. */
static int64_t next_number(Pool *p, const Batch *b) {
  /* of a message here [s]; part of the time in which rank 0 serves; [s] */
  const double cost = 20e-6, busy = 0.25, least = 0.05;
  const Sweep *s = p->s;
  double asking = (double)s->nranks * s->threads, time = fmax(least, asking * cost / busy);
  lag_lock_take(&p->lock);
  double left = fmax(0, (double)((s->journal->chunks - p->next) / s->shards));
  lag_lock_give(&p->lock);
  double n = b->n ? fmin(2, time / b->time) * (double)b->n : 1;
  return (int64_t)fmax(1, fmin(fmin(n, left / (2 * asking)), (double)batch_room(s)));
}

static void answer(Server *v, int rank) {
  Pool *p = v->pool;
  Batch *b = v->b;
  for (int64_t k = 0; k < b->n; k++) lag_pool_give(p, b->chunk[k], lag_batch_row(p->s, b, k), LAG_OK, b->time);
  lag_pool_end(p, (int)b->rc);
  v->heard[rank] = b->leaves ? INFINITY : lag_clock_seconds();
  if (b->leaves) return;
  int64_t n = next_number(p, b);
  for (b->n = 0; b->n < n; b->n++)
    if ((b->chunk[b->n] = lag_pool_take(p, 1)) < 0) break;
  p->s->ranks->send(rank, b, batch_bytes(p->s, 0)); /* a rank that is gone is silent from now on */
}

/* Whether nothing is left to be made, and the other ranks have left or are silent. */
static int is_over(const Server *v) {
  Pool *p = v->pool;
  lag_lock_take(&p->lock);
  int ends = p->rc != LAG_OK, left = p->next < p->s->journal->chunks || p->out;
  double oldest = lag_clock_seconds() - lag_pool_deadline(p);
  lag_lock_give(&p->lock);
  if (ends || left) return ends;
  for (int r = 1; r < p->s->nranks; r++)
    if (v->heard[r] > oldest && isfinite(v->heard[r])) return 0;
  return 1;
}

void lag_ranks_serve(Pool *p) {
  Sweep *s = p->s;
  Server v = {p, lag_batch_new(s), calloc((size_t)s->nranks, sizeof(double))};
  if (!v.b || !v.heard) lag_pool_end(p, LAG_ENOMEM);
  for (int r = 0; r < s->nranks && v.heard; r++) v.heard[r] = lag_clock_seconds();
  while (!is_over(&v)) {
    size_t n = batch_bytes(s, batch_room(s));
    int rank = s->ranks->receive(v.b, &n, WAIT);
    if (rank >= 0) answer(&v, rank);
    if (s->stop && s->stop(s->context)) lag_pool_end(p, LAG_INTERRUPTED);
  }
  for (int r = 1; r < s->nranks && v.heard; r++) s->silent += isfinite(v.heard[r]);
  free(v.b);
  free(v.heard);
}

/* ---- Another rank */

/* Sends b. 0, or -1. */
static int send_batch(Pool *p, Batch *b) {
  Sweep *s = p->s;
  if (s->ranks->send(0, b, batch_bytes(s, b->n)) == 0) return 0;
  p->rc = LAG_EIO;
  p->error = ETIMEDOUT;
  return -1;
}

void lag_ranks_ask(Pool *p, Batch *b) {
  const double most = 60; /* [s] */
  Sweep *s = p->s;
  size_t n = 0;
  int rank = -1;
  lag_lock_take(&p->lock);
  double begin = lag_clock_seconds();
  if (p->rc == LAG_OK) p->rc = (int)b->rc;
  if (send_batch(p, b) == 0) {
    do {
      n = batch_bytes(s, batch_room(s));
      rank = s->ranks->receive(b, &n, WAIT);
      if (s->stop && s->stop(s->context)) p->rc = LAG_INTERRUPTED;
    } while (rank < 0 && p->rc == LAG_OK && lag_clock_seconds() - begin < most);
    if (rank < 0 && p->rc == LAG_OK) p->rc = LAG_EIO, p->error = ETIMEDOUT;
  }
  if (rank < 0 || p->rc != LAG_OK) b->n = 0;
  lag_lock_give(&p->lock);
}

void lag_ranks_leave(Pool *p, Batch *b) {
  b->n = 0;
  b->leaves = 1;
  b->rc = p->rc;
  send_batch(p, b);
}
