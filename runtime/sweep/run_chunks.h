/* The runs of a sweep on threads and processes, by chunks. Enters: a plan, a simulation with all other values;
 * leaves: finished chunks in the journal. Holds: numbers do not depend on threads, processes or order; a run that
 * fails is a row with its status. */
#pragma once

#include "lag.h"
#include "lanes/lane_choice.h"
#include "sweep/journal.h"
#include "sweep/sweep_grid.h"

/* The simulation that a run begins from: one for all, or where constants vary one for each combination of their
 * values. */
typedef struct SweepVariant {
  lag_sim *like;        /* values, method, tolerance; not begun */
  const char **measure; /* [nmeasures] */
  int section;          /* the event at which rows are put, where there are sections */
  LaneChoice lanes;     /* kernel NULL, for all variants: one run after the other */
} SweepVariant;

typedef struct Sweep {
  const SweepPlan *plan;
  const SweepVariant *variant; /* [nvariants], as lag_plan_variant counts them */
  int nvariants;
  double until;
  int nmeasures, threads;
  int nrows, width;     /* rows of a motion and their columns, t and the outputs; 0: no motions are kept */
  const double *time;   /* [nrows] of rows; NULL: the first nrows crossings of the section */
  double skip;          /* measures and crossings begin at this time; NaN: at the start */
  long long chunk;      /* runs of a chunk, the last one may have fewer */
  long long shard, shards; /* chunks shard, shard + shards, ... are run here */
  Journal *journal;     /* of rank 0 */
  const lag_ranks *ranks; /* processes that share the runs, by way of rank 0; NULL: this one alone */
  int rank, nranks;
  int silent;           /* after lag_sweep_run: ranks that did not answer to the end */
  /* after a chunk: runs made here so far; != 0 ends the sweep. One thread at a time */
  int (*note)(void *context, long long runs);
  int (*stop)(void *context); /* after a step of any thread: != 0 ends its run, and the sweep */
  void *context;
} Sweep;

/* Numbers of a row: measures, then the status of the run (LAG_OK, LAG_STOPPED, or that of its failure). */
static inline int lag_sweep_columns(const Sweep *s) { return s->nmeasures + 1; }

/* Numbers of a run in the journal: its row, and its motion: a row for each time, one for its end, or one for each
 * crossing and the next one, and NaN after that. A chunk has the rows of its runs, then their motions. */
static inline size_t lag_sweep_numbers(const Sweep *s) {
  return (size_t)lag_sweep_columns(s) + (s->nrows ? (size_t)(s->nrows + 1) * (size_t)s->width : 0);
}

/* Runs of chunk c. */
long long lag_sweep_chunk_runs(const Sweep *s, long long c);

/* Makes all chunks that the journal lacks; on another rank than 0, those that rank 0 hands out. LAG_OK;
 * LAG_INTERRUPTED by note or stop; LAG_ENOMEM; LAG_EIO: errno says why the journal was not written, or rank 0 does
 * not answer. */
int lag_sweep_run(Sweep *s);

/* row[columns] := run i. why[size] := the message where it failed; else why measure k has no value; "" where
 * neither. LAG_OK, LAG_INTERRUPTED or LAG_ENOMEM. */
int lag_sweep_run_one(Sweep *s, long long i, int k, double *row, char *why, size_t size);
