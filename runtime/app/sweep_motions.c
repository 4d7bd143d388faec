/* --sweep --motions FILE: the rows of each run, t and the outputs, with the number of the run. Enters: the times of
 * rows, or the section that they lie on; leaves: one file of all runs, in order. Holds: rows are kept in the
 * journal, beside the measures of their runs, so they are the same on any number of threads and after an
 * interruption; one chunk of runs is in memory. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/sweep.h"
#include "core/core.h"

enum { MOST_NUMBERS = 100000000 }; /* of one run: 0.8 GB */

/* s->times := times of rows, as `lagc run` has them. */
static int choose_times(SweepApp *s) {
  const App *app = s->app;
  const Args *a = &app->args;
  double every = app->scene->every > 0 ? app->scene->every : fabs(app->until - app->scene->t0) / 1000,
         dir = app->until < app->scene->t0 ? -1 : 1;
  if (lag_args_every(a, &every)) return EXIT_USAGE;
  double grid[3] = {app->scene->t0, every}, first = isnan(app->skip) ? 0 : ceil(lag_app_row_at(app, grid, app->skip)),
         n = floor(lag_app_row_at(app, grid, app->until)) + 1 - first;
  if (n * s->sweep.width > MOST_NUMBERS)
    return lag_app_error(a, "--motions: a row every %g s for %g s is %.3g rows a run; write a larger --every", every,
                         fabs(app->until - app->scene->t0), n);
  s->times = malloc((size_t)n * sizeof *s->times);
  if (!s->times) return lag_app_error(a, "out of memory");
  for (int k = 0; k < (int)n; k++) {
    double t = lag_app_row_time(app, (double[]){app->scene->t0, every, first + k});
    s->times[k] = (t - app->until) * dir > 0 ? app->until : t;
  }
  s->sweep.time = s->times;
  s->sweep.nrows = (int)n;
  return 0;
}

/* --section: rows are crossings, of the event that all variants have. */
static int choose_crossings(SweepApp *s) {
  App *app = s->app;
  const Args *a = &app->args;
  long long n = 200;
  if (!a->motions && !a->svg)
    return lag_app_error(a, "--section: the crossings need a file: --motions FILE.csv, or --svg FILE for a picture");
  if (a->crossings && lag_args_count(a, "--crossings", a->crossings, "--crossings 500", &n)) return EXIT_USAGE;
  if (lag_section_choose(app)) return EXIT_USAGE;
  if ((double)n * s->sweep.width > MOST_NUMBERS)
    return lag_app_error(a, "--crossings %lld: that is more than a run can keep; write fewer", n);
  for (int v = 0; v < s->sweep.nvariants; v++) {
    const lag_model *m = lag_sim_scene(s->variants[v].like)->model;
    int k = 0;
    while (k < m->nev && strcmp(m->ev[k].name, a->section) != 0) k++;
    if (k == m->nev)
      return lag_app_error(a, "--section %s: not for each value of %s is there such an event", a->section, a->consts);
    s->variants[v].section = k;
  }
  s->sweep.nrows = (int)n;
  return 0;
}

/* Columns: the number of the run, t, the outputs; those of all variants. */
static int choose_columns(SweepApp *s) {
  const Args *a = &s->app->args;
  Table t, other;
  char label[2][sizeof(Column) + 4];
  if (lag_table_init(&t, s->app->sim, 0)) return lag_app_error(a, "out of memory");
  s->motions = (Table){.ncols = t.ncols + 1, .cols = calloc((size_t)t.ncols + 1, sizeof *t.cols)};
  s->sweep.width = t.ncols;
  int rc = s->motions.cols ? 0 : lag_app_error(a, "out of memory");
  if (rc == 0) {
    strcpy(s->motions.cols[0].name, "run");
    memcpy(s->motions.cols + 1, t.cols, (size_t)t.ncols * sizeof *t.cols);
  }
  for (int v = 1; v < s->sweep.nvariants && rc == 0; v++) {
    if (lag_table_init(&other, s->variants[v].like, 0)) rc = lag_app_error(a, "out of memory");
    for (int i = 0; i < t.ncols && rc == 0; i++)
      if (other.ncols != t.ncols || strcmp(lag_column_label(&t.cols[i], label[0], sizeof label[0]),
                                           lag_column_label(&other.cols[i], label[1], sizeof label[1])) != 0)
        rc = lag_app_error(a,
                           "--motions: the outputs depend on %s; let the scene name outputs that are there for each "
                           "value, `output x[1]`",
                           a->consts);
    lag_table_free(&other);
  }
  lag_table_free(&t);
  return rc;
}

int lag_sweep_motions_open(SweepApp *s) {
  const Args *a = &s->app->args;
  const double much = 1e9; /* bytes */
  if (a->crossings && !a->section)
    return lag_app_error(a, "--crossings is for sections: add --section 'x rising', of any expression");
  if (a->every && !a->motions) return lag_app_error(a, "--every is for the rows of motions: add --motions FILE.csv");
  if (!a->motions && !a->section) return 0;
  if (choose_columns(s) || (a->section ? choose_crossings(s) : choose_times(s))) return EXIT_USAGE;
  double bytes = (double)s->plan.runs * (double)lag_sweep_numbers(&s->sweep) * sizeof(double);
  if (bytes > much && !a->quiet)
    fprintf(
        stderr,
        "%s: the motions of %lld runs take about %.2g GB, twice that while they are written; --every DT: fewer rows\n",
        a->self, s->plan.runs, bytes / 1e9);
  return 0;
}

/* ---- Reading and writing */

int lag_sweep_motion_reader(MotionReader *r, SweepApp *s) {
  *r =
      (MotionReader){.s = s, .chunk = malloc((size_t)s->sweep.chunk * lag_sweep_numbers(&s->sweep) * sizeof *r->chunk)};
  s->full = 0;
  return r->chunk ? 0 : -1;
}

/* The last row of a motion of crossings only says that there are more. */
static double *without_next(MotionReader *r, double *motion) {
  const Sweep *w = &r->s->sweep;
  double *next = motion + (size_t)w->nrows * (size_t)w->width;
  r->s->full += !w->time && !isnan(*next);
  if (!w->time) *next = NAN;
  return motion;
}

const double *lag_sweep_next_motion(MotionReader *r) {
  const Sweep *w = &r->s->sweep;
  long long c = r->run / w->chunk, k = r->run++ % w->chunk, n = lag_sweep_chunk_runs(w, c);
  size_t each = lag_sweep_numbers(w), before = (size_t)lag_sweep_columns(w);
  if (k == 0 && lag_journal_get(&r->s->journal, c, r->chunk, (size_t)n * each)) return NULL;
  return without_next(r, r->chunk + (size_t)n * before + (size_t)k * (each - before));
}

/* The rows of a run, motion[nrows + 1][width]; those after its end have no time. */
static int write_run(Rows *rows, const Sweep *w, long long run, const double *motion, double *row) {
  int rc = 0;
  for (int k = 0; k <= w->nrows && !isnan(motion[k * w->width]) && rc == 0; k++) {
    row[0] = (double)(run + 1);
    memcpy(row + 1, motion + k * w->width, (size_t)w->width * sizeof *row);
    rc = lag_rows_write(rows, row);
  }
  return rc;
}

int lag_sweep_motions_write(SweepApp *s) {
  const char *path = s->app->args.motions;
  MotionReader r;
  Rows rows;
  if (!path) return 0;
  if (lag_outfile_has_suffix(path, "h5")) return lag_sweep_write_motion_arrays(s);
  double *row = malloc((size_t)s->motions.ncols * sizeof *row);
  if (lag_sweep_motion_reader(&r, s) || !row)
    return free(r.chunk), free(row), lag_app_error(&s->app->args, "out of memory");
  int rc = lag_rows_open(&rows, path, &s->motions);
  for (long long i = 0; i < s->plan.runs && rc == 0; i++) {
    const double *motion = lag_sweep_next_motion(&r);
    rc = motion ? write_run(&rows, &s->sweep, i, motion, row) : -1;
  }
  if (lag_rows_close(&rows, rc == 0)) rc = -1;
  free(r.chunk);
  free(row);
  return rc ? lag_app_io_error(s->app, path) : 0;
}
