/* The runs of a sweep in the lanes of vectors: as one ends, its lane takes the next run. Enters: chunks; leaves:
 * their numbers. Holds: steps are those of a run alone, bit by bit (lanes/lane_kernel.h); whatever a lane cannot do
 * is left to the run alone, from its start. */
#include <stdlib.h>
#include <string.h>

#include "lanes/lane_kernel.h"
#include "numeric/clock.h"
#include "sweep/run_chunks_impl.h"

enum { MOST_LANES = LANE_CHUNKS - 1 };

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
  unsigned busy;
  void **batch;        /* [nvariants] */
  Measures **measures; /* [nvariants][MOST_LANES] */
  double *value;       /* [factors] */
  char *begun;         /* of all chunks */
  Lane lane[MOST_LANES];
  OpenChunk chunk[LANE_CHUNKS];
};

static const LaneChoice *choice(const LaneWorker *w) { return &w->s->variant[w->variant].lanes; }

/* The batch and the measures of variant v. -1: no memory. */
static int open_variant(LaneWorker *w, int v) {
  const LaneChoice *c = &w->s->variant[v].lanes;
  int bad = (w->batch[v] = c->kernel->new_batch(w->s->variant[v].like, c->model)) == NULL;
  for (int k = 0; k < c->lanes; k++) bad |= (w->measures[v * MOST_LANES + k] = lag_sweep_measures(w->s, v)) == NULL;
  return -bad;
}

LaneWorker *lag_lane_worker_new(Sweep *s) {
  LaneWorker *w = calloc(1, sizeof *w);
  size_t n = (size_t)s->nvariants;
  if (!w) return NULL;
  w->s = s;
  w->value = malloc((size_t)(s->plan->n + 1) * sizeof *w->value);
  w->begun = malloc(LANE_CHUNKS * (size_t)s->chunk);
  w->batch = calloc(n, sizeof *w->batch);
  w->measures = calloc(n * MOST_LANES, sizeof(Measures *));
  int bad = !w->value || !w->begun || !w->batch || !w->measures;
  for (int v = 0; v < s->nvariants && !bad; v++) bad = open_variant(w, v);
  for (int k = 0; k < LANE_CHUNKS && !bad; k++) w->chunk[k].begun = w->begun + k * s->chunk;
  if (!bad) return w;
  lag_lane_worker_free(w);
  return NULL;
}

void lag_lane_worker_free(LaneWorker *w) {
  if (!w) return;
  for (int k = 0; k < MOST_LANES; k++) lag_sim_free(w->lane[k].run.sim);
  for (int k = 0; w->measures && k < w->s->nvariants * MOST_LANES; k++) lag_measures_free(w->measures[k]);
  for (int v = 0; w->batch && v < w->s->nvariants; v++) w->s->variant[v].lanes.kernel->free_batch(w->batch[v]);
  free(w->batch);
  free(w->measures);
  free(w->begun);
  free(w->value);
  free(w);
}

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

/* Makes the whole run again, alone. */
static void run_alone(LaneWorker *w, Lane *l) {
  note_end(w, l, lag_sweep_run_whole(w->s, &l->run, l->i, w->value, NULL, 0));
}

/* Lets the measures look at where the run is; it goes on in its lane where another step is needed, or ends. */
static void look(LaneWorker *w, int k) {
  const LaneChoice *lanes = choice(w);
  void *batch = w->batch[w->variant];
  Lane *l = &w->lane[k];
  int fresh = !(w->busy >> k & 1), rc = lag_sweep_run_advance(w->s, &l->run);
  w->busy &= ~(1u << k);
  if (rc >= 0 && !lag_lane_waits(rc) && !fresh && lag_lane_doubts(l->run.sim)) run_alone(w, l);
  else if (!lag_lane_waits(rc)) note_end(w, l, lag_sweep_run_end(w->s, &l->run, rc, NULL, 0));
  else if (!fresh && lanes->kernel->aim(batch, k, l->run.sim)) w->busy |= 1u << k;
  else if (lanes->kernel->load(batch, k, l->run.sim, lanes->pause || lag_measures_follow(l->run.measures)) == LAG_OK)
    w->busy |= 1u << k;
  else run_alone(w, l);
}

/* Begins runs in a free lane until one stays there. */
static void fill(LaneWorker *w, int k) {
  Sweep *s = w->s;
  Lane *l = &w->lane[k];
  while (!(w->busy >> k & 1) && (l->chunk = chunk_of_next(w)) != NULL) {
    long long of_chunk = l->chunk->next++;
    l->chunk->begun[of_chunk] = 1;
    l->i = l->chunk->c * s->chunk + of_chunk;
    l->run.measures = w->measures[w->variant * MOST_LANES + k];
    l->run.row = lag_sweep_row(s, l->chunk->row, of_chunk);
    l->run.motion = lag_sweep_motion(s, l->chunk->row, l->chunk->c, of_chunk);
    int rc = lag_sweep_run_open(s, &l->run, l->i, w->value);
    if (rc) {
      note_end(w, l, lag_sweep_run_end(s, &l->run, rc, NULL, 0));
    } else {
      lag_lane_enter(l->run.sim);
      look(w, k);
    }
  }
}

/* Begins runs in all free lanes. 0: all runs are made. */
static int refill(LaneWorker *w) {
  do {
    for (int k = 0; k < choice(w)->lanes; k++) fill(w, k);
  } while (!w->busy && w->rc == LAG_OK && next_variant(w));
  return w->busy != 0;
}

/* Steps all lanes until some pause, and looks at these. */
static void step(LaneWorker *w) {
  Sweep *s = w->s;
  const LaneChoice *c = choice(w);
  void *batch = w->batch[w->variant];
  unsigned bad, some = c->kernel->advance(batch, w->busy, &bad);
  if (!some && s->stop && s->stop(s->context)) w->rc = LAG_INTERRUPTED;
  for (int k = 0; k < c->lanes && some; k++) {
    if (!(some >> k & 1)) continue;
    if (bad >> k & 1) {
      w->busy &= ~(1u << k);
      run_alone(w, &w->lane[k]);
    } else {
      c->kernel->store(batch, k, w->lane[k].run.sim);
      look(w, k);
    }
  }
}

int lag_lane_worker_run(LaneWorker *w, ChunkSource source) {
  w->source = source;
  w->rc = LAG_OK;
  while (refill(w) && w->rc == LAG_OK) step(w);
  return w->rc;
}
