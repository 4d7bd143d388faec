/* Inside of this folder. Chunks that are not made yet (pool.c): threads (run_chunks.c) and other ranks (ranks.c)
 * take them, and give their rows. */
#pragma once

#include <stdint.h>

#include "analysis/measure.h"
#include "io/posix.h"
#include "sweep/run_chunks.h"

/* The measures of a variant, whose texts have been checked. NULL: no memory. */
Measures *lag_sweep_measures(const Sweep *s, int variant);

/* ---- One run (sweep_run.c) */

typedef struct SweepRun {
  lag_sim *sim;         /* of the last run, used again by the next; NULL: none. Freed by who has the SweepRun */
  Measures *measures;
  double *row;          /* [columns] */
  double *motion, *next; /* [nrows + 1][width] and the row to come; motion NULL: it is not kept */
  int k;                /* rows of the motion that are there */
  int begun;            /* 1: the transient is over, and measures are taken */
  const Sweep *sweep;
  int section;          /* event of its scene */
} SweepRun;

/* Numbers of run k of chunk c, which has the numbers `row`: its columns, then motion, or NULL. */
double *lag_sweep_row(const Sweep *s, double *row, long long k);
double *lag_sweep_motion(const Sweep *s, double *row, long long c, long long k);

/* Run i, for which measures, row and motion are set, in parts. open: its start, with value[factors] as scratch;
 * LAG_OK, or its status already. advance: its status, or one of lag_lane_waits, after which it is called again. end:
 * the row of a run with this status; why[size] := the message of a failure; why may be NULL. Returns LAG_OK, or
 * LAG_INTERRUPTED or LAG_ENOMEM: there is no row. */
int lag_sweep_run_open(Sweep *s, SweepRun *r, long long i, double *value);
int lag_sweep_run_advance(const Sweep *s, SweepRun *r);
int lag_sweep_run_end(const Sweep *s, SweepRun *r, int status, char *why, size_t size);
/* All of it. */
int lag_sweep_run_whole(Sweep *s, SweepRun *r, long long i, double *value, char *why, size_t size);

/* ---- Runs in the lanes of vectors (run_lanes.c) */

/* Where chunks come from, and where they go. */
typedef struct ChunkSource {
  long long (*take)(void *context, double **row); /* a chunk and room for its numbers; -1: none is left */
  /* the chunk, made in `time` [s]; rc not LAG_OK: why it is not there */
  void (*give)(void *context, long long c, double *row, int rc, double time);
  void *context;
} ChunkSource;

typedef struct LaneWorker LaneWorker;
/* The lanes of a thread. NULL: no memory. */
LaneWorker *lag_lane_worker_new(Sweep *s);
void lag_lane_worker_free(LaneWorker *w);
/* Makes all chunks of the source. LAG_OK, or why it ended before. */
int lag_lane_worker_run(LaneWorker *w, ChunkSource source);
/* The largest number of chunks that are under way at once. */
enum { LANE_CHUNKS = 9 };

/* ---- Chunks */

typedef struct Pool {
  Sweep *s;
  lag_lock lock;        /* for the rest */
  long long next, made; /* next chunk; runs made */
  int rc, error;
  /* [chunks] time at which a rank took the chunk, 0: none has it [s]; NULL: there are no other ranks */
  double *taken;
  long long out;        /* chunks that ranks have */
  double longest;       /* time that anyone took for what was taken at once [s] */
} Pool;

/* The next chunk that nobody took, for a thread of this process or for another rank; -1: none. */
long long lag_pool_take(Pool *p, int for_rank);
/* The rows of chunk c, made in `time` [s]; or rc says why there are none. */
void lag_pool_give(Pool *p, long long c, const double *row, int rc, double time);
/* Ends the sweep, if rc is not LAG_OK. */
void lag_pool_end(Pool *p, int rc);
/* Waits for the chunks that other ranks have. One whose rank is silent past the deadline; -1: all are there, or the
 * sweep ends. */
long long lag_pool_lost(Pool *p);
/* Time after which a rank is taken for dead [s]. */
double lag_pool_deadline(const Pool *p);

/* ---- Ranks. Rank 0 has the journal, hands out chunks and takes rows; the others ask it. */

enum { BATCH_MOST = 64 };

/* A message. To rank 0: chunks that were made, and their rows. From rank 0: chunks to make. */
typedef struct Batch {
  int64_t n, leaves; /* chunks; 1: the rank's last message */
  int64_t rc;        /* LAG_OK, or why the rank ends before the sweep does */
  double time;       /* that the chunks took [s] */
  int64_t chunk[BATCH_MOST];
  double row[];      /* [n][runs of a chunk * columns] */
} Batch;

/* A message with room for the rows; free() it. NULL: out of memory. */
Batch *lag_batch_new(const Sweep *s);
/* The rows of chunk k of the message. */
double *lag_batch_row(const Sweep *s, Batch *b, int64_t k);

/* Rank 0: serves the others until all chunks are there and all ranks have left, or the sweep ends. */
void lag_ranks_serve(Pool *p);
/* Another rank: sends what b holds; b := chunks to make, n = 0: none, *p says why. */
void lag_ranks_ask(Pool *p, Batch *b);
/* Another rank: its last message. */
void lag_ranks_leave(Pool *p, Batch *b);
