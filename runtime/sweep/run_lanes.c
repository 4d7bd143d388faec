/* The runs of a sweep in the lanes of vectors: as one ends, its lane takes the next run. Enters: chunks; leaves:
 * their numbers. Holds: steps are those of a run alone, bit by bit (lanes/lane_kernel.h); whatever a lane cannot do
 * is left to the run alone, from its start. */
#include <stdlib.h>
#include <string.h>

#include "lanes/lane_runs.h"
#include "numeric/clock.h"
#include "numeric/release.h"
#include "sweep/run_chunks_impl.h"

/* A chunk whose runs are under way. */
typedef struct OpenChunk {
  /* runs that have not ended, 0: there is no chunk; where to look for the next run of the variant */
  long long c, left, next;
  double *row, since;       /* its numbers; time of its beginning [s] */
  char *begun;              /* [chunk] */
} OpenChunk;

typedef struct Lane {
  SweepRun run;
  OpenChunk *chunk;
  long long i; /* of the sweep */
} Lane;

/* All lanes run the same variant; when none of its runs is left in the open chunks, the next variant has its turn. */
struct LaneWorker {
  Sweep *s;
  ChunkSource source;
  int variant, rc;
  LaneRuns runs;
  void **batch;        /* [nvariants] */
  Measures **measures; /* [nvariants][LAG_MOST_LANES] */
  double *value;       /* [factors] */
  char *begun;         /* of all chunks */
  Lane lane[LAG_MOST_LANES];
  OpenChunk chunk[LANE_CHUNKS];
};

static const LaneChoice *choice(const LaneWorker *w) { return &w->s->variant[w->variant].lanes; }

/* ---- Chunks */

/* Takes another chunk. NULL: there is no place for it, none is left, or the sweep ends. */
static OpenChunk *open_chunk(LaneWorker *w) {
  OpenChunk *o = w->chunk, *end = w->chunk + LANE_CHUNKS;
  while (o < end && o->left) o++;
  long long c = w->rc == LAG_OK && o < end ? w->source.take(w->source.context, &o->row) : -1;
  if (c < 0) return NULL;
  o->c = c;
  o->next = 0;
  o->left = lag_sweep_chunk_runs(w->s, c);
  o->since = lag_clock_seconds();
  memset(o->begun, 0, (size_t)o->left);
  return o;
}

/* A run of the variant in the chunk that is not begun, or where variant < 0 of any; -1: there is none. */
static long long next_run(const LaneWorker *w, OpenChunk *o, int variant) {
  long long n = o->left ? lag_sweep_chunk_runs(w->s, o->c) : 0, first = o->c * w->s->chunk;
  for (; o->next < n; o->next++)
    if (!o->begun[o->next] &&
        (w->s->nvariants == 1 || variant < 0 || lag_plan_variant(w->s->plan, first + o->next) == variant))
      return o->next;
  return -1;
}

/* The chunk with the next run of the variant, which is number o->next of it; NULL: there is none. */
static OpenChunk *chunk_of_next(LaneWorker *w) {
  for (OpenChunk *o = w->chunk; o < w->chunk + LANE_CHUNKS; o++)
    if (next_run(w, o, w->variant) >= 0) return o;
  for (OpenChunk *o; (o = open_chunk(w)) != NULL;)
    if (next_run(w, o, w->variant) >= 0) return o;
  return NULL;
}

/* Goes on to another variant, when no run of the present one is left in the open chunks. 0: no run of any is. */
static int next_variant(LaneWorker *w) {
  long long run = -1;
  for (OpenChunk *o = w->chunk; o < w->chunk + LANE_CHUNKS; o++) {
    o->next = 0;
    if (run < 0 && (run = next_run(w, o, -1)) >= 0) run += o->c * w->s->chunk;
    o->next = 0;
  }
  if (run >= 0) w->variant = (int)lag_plan_variant(w->s->plan, run);
  return run >= 0;
}

/* ---- Runs */

/* A run has ended; rc as from lag_sweep_run_end. */
static void note_end(LaneWorker *w, Lane *l, int rc) {
  OpenChunk *o = l->chunk;
  if (w->rc == LAG_OK) w->rc = rc;
  if (--o->left == 0 || rc) w->source.give(w->source.context, o->c, o->row, rc, lag_clock_seconds() - o->since);
}

static void run_alone(void *worker, int k) {
  LaneWorker *w = worker;
  Lane *l = &w->lane[k];
  note_end(w, l, lag_sweep_run_whole(w->s, &l->run, l->i, w->value, NULL, 0));
}

static lag_sim *next(void *worker, int k) {
  LaneWorker *w = worker;
  Sweep *s = w->s;
  Lane *l = &w->lane[k];
  for (int rc = -1; rc && (l->chunk = chunk_of_next(w)) != NULL;) {
    long long of_chunk = l->chunk->next++;
    l->chunk->begun[of_chunk] = 1;
    l->i = l->chunk->c * s->chunk + of_chunk;
    l->run.measures = w->measures[w->variant * LAG_MOST_LANES + k];
    l->run.row = lag_sweep_row(s, l->chunk->row, of_chunk);
    l->run.motion = lag_sweep_motion(s, l->chunk->row, l->chunk->c, of_chunk);
    if ((rc = lag_sweep_run_open(s, &l->run, l->i, w->value)) != 0)
      note_end(w, l, lag_sweep_run_end(s, &l->run, rc, NULL, 0));
  }
  return l->chunk ? l->run.sim : NULL;
}

static int advance(void *worker, int k) {
  LaneWorker *w = worker;
  return lag_sweep_run_advance(w->s, &w->lane[k].run);
}

static int follows(void *worker, int k) { return lag_measures_follow(((LaneWorker *)worker)->lane[k].run.measures); }

static void end(void *worker, int k, int status) {
  LaneWorker *w = worker;
  note_end(w, &w->lane[k], lag_sweep_run_end(w->s, &w->lane[k].run, status, NULL, 0));
}

/* Begins runs in all free lanes. 0: all runs are made. */
static int refill(LaneWorker *w) {
  do {
    w->runs.choice = choice(w);
    w->runs.batch = w->batch[w->variant];
  } while (!lag_lane_runs_fill(&w->runs) && w->rc == LAG_OK && next_variant(w));
  return w->runs.busy != 0;
}

/* ---- Workers */

/* The batch and the measures of variant v. -1: no memory. */
static int open_variant(LaneWorker *w, int v) {
  const LaneChoice *c = &w->s->variant[v].lanes;
  int bad = (w->batch[v] = c->kernel->new_batch(w->s->variant[v].like, c->model)) == NULL;
  for (int k = 0; k < c->lanes; k++) bad |= (w->measures[v * LAG_MOST_LANES + k] = lag_sweep_measures(w->s, v)) == NULL;
  return -bad;
}

LaneWorker *lag_lane_worker_new(Sweep *s) {
  LaneWorker *w = calloc(1, sizeof *w);
  size_t n = (size_t)s->nvariants;
  if (!w) return NULL;
  w->s = s;
  w->runs = (LaneRuns){.next = next, .advance = advance, .follows = follows, .end = end, .alone = run_alone};
  w->runs.context = w;
  w->value = malloc((size_t)(s->plan->n + 1) * sizeof *w->value);
  w->begun = malloc(LANE_CHUNKS * (size_t)s->chunk);
  w->batch = calloc(n, sizeof *w->batch);
  w->measures = calloc(n * LAG_MOST_LANES, sizeof(Measures *));
  int bad = !w->value || !w->begun || !w->batch || !w->measures;
  for (int v = 0; v < s->nvariants && !bad; v++) bad = open_variant(w, v);
  for (int k = 0; k < LANE_CHUNKS && !bad; k++) w->chunk[k].begun = w->begun + k * s->chunk;
  if (!bad) return w;
  lag_lane_worker_free(w);
  return NULL;
}

void lag_lane_worker_free(LaneWorker *w) {
  if (!w) return;
  for (int k = 0; k < LAG_MOST_LANES; k++) lag_sim_free(w->lane[k].run.sim);
  for (int k = 0; w->measures && k < w->s->nvariants * LAG_MOST_LANES; k++) lag_measures_free(w->measures[k]);
  for (int v = 0; w->batch && v < w->s->nvariants; v++) w->s->variant[v].lanes.kernel->free_batch(w->batch[v]);
  lag_free_all(w->batch, w->measures, w->begun, w->value, w);
}

int lag_lane_worker_run(LaneWorker *w, ChunkSource source) {
  w->source = source;
  w->rc = LAG_OK;
  while (refill(w) && w->rc == LAG_OK)
    if (!lag_lane_runs_step(&w->runs) && w->s->stop && w->s->stop(w->s->context)) w->rc = LAG_INTERRUPTED;
  return w->rc;
}
