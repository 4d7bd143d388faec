/* The runs of a sweep on threads and processes (run_chunks.h): each takes the next chunk until none is left. */
#include "sweep/run_chunks.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/measure.h"
#include "io/posix.h"
#include "numeric/clock.h"
#include "numeric/release.h"
#include "sweep/run_chunks_impl.h"

/* State of one thread. */
typedef struct Worker {
  Pool *pool;
  int serves;          /* 1: no runs, but messages of other ranks */
  Measures **measures; /* [nvariants] */
  double *row, *value; /* [chunk * numbers], so many times as chunks are under way; [factors] */
  char in_use[LANE_CHUNKS];
  Batch *batch;        /* of another rank than 0, instead of row */
  int64_t taken;       /* chunks of the batch */
  SweepRun run;        /* the last one */
  LaneWorker *lanes;   /* NULL: one run after the other */
} Worker;

long long lag_sweep_chunk_runs(const Sweep *s, long long c) {
  long long left = s->plan->runs - c * s->chunk;
  return left < s->chunk ? left : s->chunk;
}

/* The numbers of chunk c, one run after the other. */
static int make_chunk(Worker *w, long long c, double *row) {
  Sweep *s = w->pool->s;
  int rc = LAG_OK;
  for (long long k = 0, n = lag_sweep_chunk_runs(s, c); k < n && rc == LAG_OK; k++) {
    long long i = c * s->chunk + k;
    w->run.measures = w->measures[lag_plan_variant(s->plan, i)];
    w->run.row = lag_sweep_row(s, row, k);
    w->run.motion = lag_sweep_motion(s, row, c, k);
    rc = lag_sweep_run_whole(s, &w->run, i, w->value, NULL, 0);
  }
  return rc;
}

/* ---- Chunks of this process */

static long long take_from_pool(void *worker, double **row) {
  Worker *w = worker;
  int k = 0;
  while (w->in_use[k]) k++;
  long long c = lag_pool_take(w->pool, 0);
  w->in_use[k] = c >= 0;
  *row = w->row + (size_t)k * (size_t)w->pool->s->chunk * lag_sweep_numbers(w->pool->s);
  return c;
}

static void give_to_pool(void *worker, long long c, double *row, int rc, double time) {
  Worker *w = worker;
  w->in_use[(size_t)(row - w->row) / ((size_t)w->pool->s->chunk * lag_sweep_numbers(w->pool->s))] = 0;
  lag_pool_give(w->pool, c, row, rc, time);
}

static void make_chunks(Worker *w) {
  Pool *p = w->pool;
  long long c;
  if (w->lanes) lag_pool_end(p, lag_lane_worker_run(w->lanes, (ChunkSource){take_from_pool, give_to_pool, w}));
  while ((c = lag_pool_take(p, 0)) >= 0 || (c = lag_pool_lost(p)) >= 0) {
    double begin = lag_clock_seconds();
    int rc = make_chunk(w, c, w->row);
    lag_pool_give(p, c, w->row, rc, lag_clock_seconds() - begin);
  }
}

/* ---- Chunks from rank 0 */

static long long take_from_batch(void *worker, double **row) {
  Worker *w = worker;
  *row = lag_batch_row(w->pool->s, w->batch, w->taken);
  return w->taken < w->batch->n ? w->batch->chunk[w->taken++] : -1;
}

static void give_to_batch(void *worker, long long c, double *row, int rc, double time) {
  Batch *b = ((Worker *)worker)->batch;
  (void)c, (void)row, (void)time;
  if (rc) b->rc = rc;
}

/* Makes the chunks of w->batch; where that ends early, those that are there lose their place. */
static void make_batch(Worker *w) {
  Batch *b = w->batch;
  int64_t n = b->n;
  w->taken = 0;
  if (w->lanes) b->rc = lag_lane_worker_run(w->lanes, (ChunkSource){take_from_batch, give_to_batch, w});
  for (; !w->lanes && w->taken < n && b->rc == LAG_OK; w->taken += b->rc == LAG_OK)
    b->rc = make_chunk(w, b->chunk[w->taken], lag_batch_row(w->pool->s, b, w->taken));
  b->n = b->rc == LAG_OK ? n : w->lanes ? 0 : w->taken;
}

static void make_batches(Worker *w) {
  Batch *b = w->batch;
  for (lag_ranks_ask(w->pool, b); b->n; lag_ranks_ask(w->pool, b)) {
    double begin = lag_clock_seconds();
    make_batch(w);
    b->time = lag_clock_seconds() - begin;
  }
}

static void work(void *worker) {
  Worker *w = worker;
  if (w->serves) lag_ranks_serve(w->pool);
  else if (w->batch) make_batches(w);
  else make_chunks(w);
}

/* ---- Threads */

Measures *lag_sweep_measures(const Sweep *s, int variant) {
  char why[1];
  return lag_measures_new(lag_sim_scene(s->variant[variant].like), s->nmeasures, s->variant[variant].measure, NULL, why,
                          sizeof why);
}

static void close_measures(const Sweep *s, Measures **m) {
  for (int v = 0; m && v < s->nvariants; v++) lag_measures_free(m[v]);
  free(m);
}

/* The measures of each variant, whose texts have been checked. NULL: no memory. */
static Measures **open_measures(const Sweep *s) {
  Measures **m = calloc((size_t)s->nvariants, sizeof *m);
  for (int v = 0; m && v < s->nvariants; v++) {
    m[v] = lag_sweep_measures(s, v);
    if (!m[v]) return close_measures(s, m), NULL;
  }
  return m;
}

static int open_worker(Worker *w, Pool *pool) {
  Sweep *s = pool->s;
  int lanes = s->variant[0].lanes.kernel != NULL;
  *w = (Worker){.pool = pool};
  w->measures = open_measures(s);
  w->value = malloc((size_t)s->plan->n * sizeof *w->value);
  if (s->rank) w->batch = lag_batch_new(s);
  else w->row = malloc((lanes ? LANE_CHUNKS : 1) * (size_t)s->chunk * lag_sweep_numbers(s) * sizeof *w->row);
  if (lanes) w->lanes = lag_lane_worker_new(s);
  return w->measures && w->value && (w->row || w->batch) && (w->lanes || !lanes) ? LAG_OK : LAG_ENOMEM;
}

static void close_worker(Worker *w) {
  lag_lane_worker_free(w->lanes);
  lag_sim_free(w->run.sim);
  close_measures(w->pool->s, w->measures);
  lag_free_all(w->row, w->value, w->batch);
}

int lag_sweep_run(Sweep *s) {
  Pool pool = {.s = s, .lock = LAG_UNLOCKED, .next = s->shard};
  int serves = s->ranks && s->rank == 0, n = s->threads + serves;
  Worker *w = calloc((size_t)n, sizeof *w);
  void **all = calloc((size_t)n, sizeof *all);
  if (serves) pool.taken = calloc((size_t)s->journal->chunks, sizeof *pool.taken);
  int rc = w && all && (pool.taken || !serves) ? LAG_OK : LAG_ENOMEM;
  for (int i = 0; i < n && rc == LAG_OK; i++) { /* the first is on the thread of main, as MPI wants its messages */
    if (i < serves) w[i] = (Worker){.pool = &pool, .serves = 1};
    else rc = open_worker(&w[i], &pool);
    all[i] = &w[i];
  }
  if (rc == LAG_OK) {
    lag_on_threads(n, work, all);
    if (s->rank) lag_ranks_leave(&pool, w[0].batch);
    rc = pool.rc;
    errno = pool.error;
    if (!s->rank && lag_journal_flush(s->journal) && rc == LAG_OK) rc = LAG_EIO;
  }
  for (int i = 0; w && i < n && w[i].pool; i++) close_worker(&w[i]);
  lag_free_all(pool.taken, w, all);
  return rc;
}

int lag_sweep_run_one(Sweep *s, long long i, int k, double *row, char *why, size_t size) {
  Measures *m = lag_sweep_measures(s, (int)lag_plan_variant(s->plan, i));
  double *value = malloc((size_t)s->plan->n * sizeof *value);
  SweepRun r = {.measures = m, .row = row};
  int rc = m && value ? lag_sweep_run_whole(s, &r, i, value, why, size) : LAG_ENOMEM;
  if (rc == LAG_OK && row[s->nmeasures] >= 0) snprintf(why, size, "%s", lag_measures_why(m, k));
  lag_sim_free(r.sim);
  lag_measures_free(m);
  free(value);
  return rc;
}
