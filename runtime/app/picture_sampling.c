/* Adaptive sampling of a run for pictures. Enters: a run under way; leaves: in its table, as many rows as the motion needs,
 * whatever the steps of the method: the samples of a step are doubled until straight lines follow it. Holds: sampling does
 * not change the run (except for STEPS_TO methods, whose steps end at the times asked for). */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "core/core.h"

enum { MOST_PLACES = 64 };          /* samples of a step */
enum { MOST_VALUES = 1 << 24 };     /* numbers in memory */
static const double PART = 1. / 3000; /* deviation allowed, as a part of the picture: a third of a pixel */

/* Selects the columns that pictures draw. */
static void choose_columns(App *app) {
  RowThinning *w = &app->sampling.rows;
  if (app->args.html) {
    for (int i = 0; i < 2 * app->show.npoints; i++) lag_thin_add_column(w, app->show.cols[i]);
    w->common = !app->args.svg && !app->args.sketch;
  }
  for (int i = 0; i < app->drawn.n && (app->args.svg || app->args.sketch); i++) {
    lag_thin_add_column(w, app->drawn.x[i]);
    lag_thin_add_column(w, app->drawn.y[i]);
  }
}

int lag_sampling_open(App *app) {
  PictureSampling *f = &app->sampling;
  double span = fabs(app->until - lag_sim_time(app->sim));
  size_t ncols = (size_t)app->table.ncols;
  if (!app->table.keep || app->section >= 0 || app->args.tangent) { /* a tangent is known at rows only */
    return 0;
  }
  f->on = 1;
  f->places = 16;
  f->soonest = span / (1 << 20);
  f->y = malloc((size_t)app->sim->pb.n * sizeof *f->y);
  f->seen = malloc((MOST_PLACES + 1) * ncols * sizeof *f->seen);
  if (lag_thin_init(&f->rows, &app->table, !app->args.every, PART, span / 400) || !f->y || !f->seen)
    return lag_app_error(&app->args, "out of memory");
  choose_columns(app);
  return 0;
}

void lag_sampling_free(App *app) {
  lag_thin_free(&app->sampling.rows);
  free(app->sampling.y);
  free(app->sampling.seen);
}

/* Sample k := the row at time t within the present step; NaN where outputs have no value, a gap in the curve. */
static void sample(App *app, int k, double t) {
  PictureSampling *f = &app->sampling;
  double *row = f->seen + (size_t)k * (size_t)app->table.ncols;
  row[0] = t;
  if (lag_sim_outputs_at(app->sim, t, f->y, row + 1))
    for (int i = 1; i < app->table.ncols; i++) row[i] = NAN;
  lag_thin_extend_range(&f->rows, row);
}

/* Whether each odd sample of 0 .. n lies on the line between its neighbours. */
static int lines_suffice(const App *app, int n) {
  const PictureSampling *f = &app->sampling;
  size_t ncols = (size_t)app->table.ncols, by = (size_t)(MOST_PLACES / n) * ncols;
  for (int k = 1; k < n; k += 2) {
    const double *row = f->seen + (size_t)k * by;
    if (!lag_thin_is_straight(&f->rows, row - by, row + by, row)) return 0;
  }
  return 1;
}

/* Samples the present step from time a to b and thins the rows. Sample k of n is stored at index MOST_PLACES/n k. */
static int sample_step(App *app, double a, double b) {
  PictureSampling *f = &app->sampling;
  int n = f->places / 2 > 2 ? f->places / 2 : 2, rc = 0;
  for (int k = 0; k <= n; k++) sample(app, MOST_PLACES / n * k, k == n ? b : a + k * (b - a) / n);
  while (n < MOST_PLACES && !lines_suffice(app, n)) {
    n *= 2;
    for (int k = 1; k < n; k += 2) sample(app, MOST_PLACES / n * k, a + k * (b - a) / n);
  }
  f->places = n;
  for (int k = 0; k <= n && rc == 0; k++) rc = lag_thin_add(&f->rows, f->seen + (size_t)(MOST_PLACES / n * k) * (size_t)app->table.ncols);
  if (rc == 0 && f->rows.store && app->table.nrows * (size_t)app->table.ncols > MOST_VALUES)
    rc = lag_thin_reduce(&f->rows, MOST_VALUES / 2 / (size_t)app->table.ncols);
  return rc ? LAG_ENOMEM : LAG_OK;
}

/* Time to step to: for STEPS_TO methods so near that few samples resolve the step; for others `until`. */
static double sampling_stop(const App *app, double t, double until) {
  const PictureSampling *f = &app->sampling;
  double most = f->length > 0 ? f->length : fabs(app->until - t) / 1000;
  return lag_sim_method(app->sim)->flags & LAG_METHOD_STEPS_TO && fabs(until - t) > most ? t + copysign(most, until - t) : until;
}

int lag_sampling_advance(App *app, double until) {
  PictureSampling *f = &app->sampling;
  double reach;
  int rc = f->on ? lag_sim_advance(app->sim, lag_sim_time(app->sim)) : LAG_OK; /* starts the run */
  while (rc == 0 && f->on && lag_sim_time(app->sim) != until) {
    rc = lag_sim_ensure_step(app->sim, sampling_stop(app, lag_sim_time(app->sim), until), &reach);
    double t = lag_sim_time(app->sim);
    if (rc < 0) return rc;
    if (rc || reach == until || f->rows.kept == 0 || fabs(reach - f->seen_to) >= f->soonest) {
      int bad = sample_step(app, t, reach);
      rc = bad ? bad : rc;
      f->length = fabs(reach - t) * 4 / f->places;
      f->seen_to = reach;
    }
    rc = rc ? rc : lag_sim_advance(app->sim, reach);
  }
  return rc ? rc : lag_sim_advance(app->sim, until);
}

/* Keeps the last row, and thins the rows to the size of an HTML page. -1: no memory. */
int lag_sampling_close(App *app) {
  enum { MOST_NUMBERS = 2000000 }; /* 12 MB */
  PictureSampling *f = &app->sampling;
  size_t most = app->args.html ? MOST_NUMBERS / (size_t)(2 * app->show.npoints + 1) : SIZE_MAX;

  return f->on && lag_thin_reduce(&f->rows, most) ? -1 : 0;
}

/* A round --every that resolves the motion. */
static double fine_enough(const App *app) {
  const Table *t = &app->table;
  double span = fabs(lag_table_cell(t, t->nrows - 1, 0) - lag_table_cell(t, 0, 0)), raw = span / (double)app->sampling.rows.kept;
  return lag_tick_step(0, raw / 1.6, 1);
}

void lag_sampling_warn(App *app, char *note, size_t size) {
  enum { FINER = 2 }; /* rows at equal times must be more than chosen ones */
  const PictureSampling *f = &app->sampling;

  note[0] = '\0';
  if (!f->on || !app->table.nrows) return;
  if (!f->rows.store && f->rows.kept > FINER * app->table.nrows) {
    snprintf(note, size, "rows every %s s are too coarse for this motion, and straight lines join them: leave --every out, or write --every %g",
             app->args.every, fine_enough(app));
  } else if (f->rows.part > 32 * PART) {
    snprintf(note, size, "the run is too long to be shown finely: lines are off by up to %.2g %% of the picture; an earlier --until shows it better",
             100 * f->rows.part);
  }
  if (note[0] && !app->args.quiet) fprintf(stderr, "%s: note: %s\n", app->args.self, note);
}
