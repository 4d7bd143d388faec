/* Shared by sweep.c, which makes the runs, and sweep_report.c, which writes what they gave. */
#pragma once

#include "app/app.h"
#include "sweep/run_chunks.h"

typedef struct SweepApp {
  App *app;
  SweepPlan plan;
  Sweep sweep;
  Journal journal;
  Table table;       /* columns: names that vary, measures, status */
  SweepVariant *variants; /* one, or one for each combination of values of constants */
  Table motions;     /* columns of --motions: run, t, outputs */
  Table branches;    /* rows of --branches: value, output, branch, growing directions */
  double *times;     /* of their rows; NULL: they are crossings of --section */
  long long full;    /* runs that crossed it more often than is kept, of those read last */
  char *names;       /* of the measures where nobody gave one */
  double *points;    /* of a quasi-random sequence */
  const char *no_lanes; /* why runs are computed one by one; NULL: they are in lanes, or were asked for so */
  double seconds;    /* of this process */
  long long made;    /* runs of this process */
} SweepApp;

/* sweep_journal.c: hash of values, method, end and measures, equal for two processes of one sweep. */
uint64_t lag_sweep_signature(const SweepApp *s);
/* File of the rows, or else of the picture or the motions; NULL: none. is_stream: it is a stream or a device; the
 * journal has no name then, and ends with this process. */
const char *lag_sweep_result_file(const Args *a);
int lag_sweep_is_stream(const char *file);
/* Opens the journal; reads --shard i/n; --merge n: joins parts. The exit status. */
int lag_sweep_open_journal(SweepApp *s, int resume);
int lag_sweep_read_shard(SweepApp *s);
int lag_sweep_merge(SweepApp *s);

/* sweep_branches.c. read: s->branches, with the output y; 0, or EXIT_USAGE after a message. draw: lines in the columns
 * `first` (stable) and first + 1 of the picture's table; -1: no memory. */
int lag_sweep_branches_read(SweepApp *s, const Column *y);
int lag_sweep_branches_draw(const SweepApp *s, Table *t, int first, double period, int logarithmic);

/* sweep_ranks.c. Refuses --mpi where it cannot be; becomes mpirun (a message where that fails). Return EXIT_USAGE
 * after a message. */
int lag_sweep_check_mpi(const SweepApp *s);
int lag_sweep_start(SweepApp *s);
/* Joins the processes that mpirun started, if it did; checks that all have the same sweep; on another rank than 0,
 * makes runs for it; leaves, or where rc is not 0 ends them all. Return the exit status. */
int lag_sweep_join(SweepApp *s);
int lag_sweep_agree(SweepApp *s);
int lag_sweep_serve(SweepApp *s);
void lag_sweep_leave(const SweepApp *s, int rc);

/* Writes the rows of all runs to --output, and prints statistics. Returns the exit status. */
int lag_sweep_report(SweepApp *s);
/* Says where the runs of a part are. The same. */
int lag_sweep_report_part(SweepApp *s);
/* Passes all rows on, in order: row[table.ncols] to `take`, until it returns another number than 0. 0, or -1 with
 * errno set. */
int lag_sweep_each_row(SweepApp *s, int (*take)(void *context, long long run, const double *row), void *context);

/* sweep_picture.c: refuses --svg for what it does not draw; draws. 0, or EXIT_USAGE after a message. */
int lag_sweep_picture_check(SweepApp *s);
int lag_sweep_picture(SweepApp *s);
/* sweep_arrays.c: writes the rows to --output, FILE.h5, and motions to --motions, FILE.h5. The same. */
int lag_sweep_write_arrays(SweepApp *s);
int lag_sweep_write_motion_arrays(SweepApp *s);

/* sweep_motions.c: chooses the rows of --motions or --section, before the runs; writes the file, after them. Without
 * --motions nothing. The same. */
int lag_sweep_motions_open(SweepApp *s);
int lag_sweep_motions_write(SweepApp *s);

/* The motions of the journal, run after run. */
typedef struct MotionReader {
  SweepApp *s;
  double *chunk; /* free() it */
  long long run; /* the next one */
} MotionReader;
/* -1: no memory. */
int lag_sweep_motion_reader(MotionReader *r, SweepApp *s);
/* Rows [nrows + 1][width] of the next run; those after its end are NaN. NULL with errno set. */
const double *lag_sweep_next_motion(MotionReader *r);
