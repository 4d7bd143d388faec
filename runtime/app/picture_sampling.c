/* Adaptive sampling of a run for pictures. Enters: a run under way; leaves: in its table, as many rows as the motion
 * needs, whatever the steps of the method: the samples of a step are doubled until straight lines follow it, and a
 * "swinging door" (E. H. Bristol, Swinging door trending, ISA Transactions 1990) keeps rows such that the lines
 * between them miss no row by more than a given part of the drawn range. Of a method of equal steps a picture has
 * the ends of steps, joined by straight lines: that is what the method computes, and an interpolation has errors of
 * its own, of the energy a thousand times the method's. An animation moves between them, too. Holds: both sides of a
 * jump are kept, and the first and the last row; sampling does not change the run (except for STEPS_TO methods,
 * whose steps end at the times asked for). */
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "core/core.h"
#include "numeric/release.h"

enum { MOST_PLACES = 64 };          /* samples of a step */
enum { MOST_VALUES = 1 << 24 };     /* numbers in memory */
static const double PART = 1. / 3000; /* deviation allowed, as a part of the picture: a third of a pixel */

/* Changes below this part of the values count as rounding, not as motion. */
static const double ROUNDING = 1e-11;

/* ---- Thinning */

/* Adds a column to the drawn ones. place: 1, on the scale that places share. */
static void add_column(PictureSampling *w, int col, int place) {
  for (int i = 0; i < w->ndrawn; i++)
    if (w->drawn[i].col == col) return;
  if (col > 0) w->drawn[w->ndrawn++] = (DrawnColumn){.col = col, .place = place, .least = HUGE_VAL, .most = -HUGE_VAL};
}

/* Widens the ranges by a row; called before `thin` of the row. */
static void extend_range(PictureSampling *w, const double *row) {
  double widest = 0;
  for (DrawnColumn *d = w->drawn; d < w->drawn + w->ndrawn; d++) {
    double x = row[d->col];
    if (isfinite(x)) {
      d->least = fmin(d->least, x);
      d->most = fmax(d->most, x);
    }
    if (d->place) widest = fmax(widest, d->most - d->least);
  }
  for (DrawnColumn *d = w->drawn; d < w->drawn + w->ndrawn; d++)
    d->width = fmax(w->part * (w->common && d->place ? widest : fmax(0, d->most - d->least)),
                    ROUNDING * fmax(fabs(d->least), fabs(d->most)));
}

/* Whether the row `between` lies on the line from a to b, within the allowed deviation. A row without values is
 * never off the line. */
static int is_straight(const PictureSampling *w, const double *a, const double *b, const double *between) {
  double f = (between[0] - a[0]) / (b[0] - a[0]);
  for (const DrawnColumn *d = w->drawn; d < w->drawn + w->ndrawn; d++)
    if (fabs(between[d->col] - (a[d->col] + f * (b[d->col] - a[d->col]))) > d->width) return 0;
  return 1;
}

/* Keeps a row: the door opens anew from here. -1: no memory. */
static int keep(App *app, const double *row) {
  PictureSampling *w = &app->sampling;
  size_t bytes = (size_t)app->table.ncols * sizeof(double);
  memcpy(w->from, row, bytes);
  w->have_last = 0;
  w->kept++;
  return w->store ? lag_table_add(&app->table, row) : 0;
}

/* Returns 1 if no line from the last kept row passes near all rows since, this one included. Else returns 0 and
 * narrows the door, the slopes low to high of such lines. */
static int door_closes(PictureSampling *w, const double *row) {
  double dt = fabs(row[0] - w->from[0]);
  int shut = w->have_last && dt > w->longest;
  for (const DrawnColumn *d = w->drawn; d < w->drawn + w->ndrawn && !shut; d++) {
    double x = row[d->col], from = w->from[d->col];
    if (isfinite(x) != isfinite(from) || (w->have_last && isfinite(x) != isfinite(w->last[d->col]))) shut = 1;
    else if (isfinite(x) && w->have_last) shut = x - from < d->low * dt || x - from > d->high * dt;
  }
  for (DrawnColumn *d = w->drawn; d < w->drawn + w->ndrawn && !shut; d++) {
    double rise = row[d->col] - w->from[d->col], low = (rise - d->width) / dt, high = (rise + d->width) / dt;
    d->low = w->have_last ? fmax(d->low, low) : low;
    d->high = w->have_last ? fmin(d->high, high) : high;
  }
  return shut;
}

static int flush(App *app) { return app->sampling.have_last ? keep(app, app->sampling.last) : 0; }

/* Adds a row; rows come in order of time. -1: no memory. */
static int thin(App *app, const double *row) {
  PictureSampling *w = &app->sampling;
  size_t bytes = (size_t)app->table.ncols * sizeof(double);
  const double *before = w->have_last ? w->last : w->from;
  if (w->kept == 0) return keep(app, row);
  if (memcmp(before, row, bytes) == 0) return 0;
  if (row[0] == before[0]) { /* a jump: two rows at one time */
    int rc = flush(app);
    return rc ? rc : keep(app, row);
  }
  if (door_closes(w, row)) {
    int rc = flush(app);
    /* still shut: a change between finite and not finite */
    if (rc || door_closes(w, row)) return rc ? rc : keep(app, row);
  }
  memcpy(w->last, row, bytes);
  w->have_last = 1;
  return 0;
}

/* Keeps the last row, and thins the kept rows: doubles `part` until at most `most` rows are left or part is 1/2. -1:
 * no memory. */
static int reduce(App *app, size_t most) {
  PictureSampling *w = &app->sampling;
  Table *t = &app->table;
  double *row = malloc((size_t)t->ncols * sizeof *row);
  if (!row || flush(app)) {
    free(row);
    return -1;
  }
  while (w->store && t->nrows > most && w->part < 0.5) {
    size_t n = t->nrows;
    w->part *= 2;
    t->nrows = w->kept = 0;
    for (size_t i = 0; i < n; i++) { /* kept rows overwrite rows already read */
      memcpy(row, t->data + i * (size_t)t->ncols, (size_t)t->ncols * sizeof *row);
      extend_range(w, row);
      thin(app, row);
    }
    flush(app);
    w->longest *= 2;
  }
  free(row);
  return 0;
}

/* ---- Sampling */

/* Selects the columns that pictures draw. */
static void choose_columns(App *app) {
  PictureSampling *w = &app->sampling;
  if (app->args.html || app->args.picture.drawing) {
    for (int i = 0; i < app->show.nshapes; i++) {
      const lag_shape *s = &app->show.shapes[i];
      for (int k = 0; k < 3; k++) add_column(w, s->a[k], 1);
      for (int k = 0; k < 3; k++) add_column(w, s->b[k], lag_shape_has_length(s));
      for (int k = 0; k < 3; k++) add_column(w, s->size[k], 0);
      for (int k = 0; k < 4; k++) add_column(w, s->turn[k], 0);
    }
    w->common = (!app->args.svg || app->args.picture.drawing) && !app->args.sketch;
  }
  for (int i = 0; i < app->drawn.n && ((app->args.svg && !app->args.picture.drawing) || app->args.sketch); i++) {
    add_column(w, app->drawn.x[i], 0);
    add_column(w, app->drawn.y[i], 0);
  }
}

int lag_sampling_open(App *app) {
  PictureSampling *f = &app->sampling;
  double span = fabs(app->until - lag_sim_time(app->sim));
  size_t ncols = (size_t)app->table.ncols;
  /* a tangent is known at rows only */
  if (!app->table.keep || app->section >= 0 || app->args.tangent || app->args.sensitivity ||
      lag_app_equal_times(&app->args)) {
    return 0;
  }
  *f = (PictureSampling){.on = 1,
                         .places = 16, .soonest = span / (1 << 20), .store = !app->args.every, .part = PART,
                         .longest = span / 400};
  f->ends = lag_equal_step(app->sim) > 0 && !app->args.html;
  f->y = malloc((size_t)app->sim->pb.n * sizeof *f->y);
  f->seen = malloc((MOST_PLACES + 1) * ncols * sizeof *f->seen);
  f->drawn = calloc(ncols, sizeof *f->drawn);
  f->from = calloc(2 * ncols, sizeof *f->from);
  if (!f->y || !f->seen || !f->drawn || !f->from) return lag_app_error(&app->args, "out of memory");
  f->last = f->from + ncols;
  choose_columns(app);
  return 0;
}

void lag_sampling_free(App *app) {
  lag_free_all(app->sampling.from, app->sampling.drawn, app->sampling.y, app->sampling.seen);
}

/* Sample k := the row at time t within the present step; NaN where outputs have no value, a gap in the curve. */
static void sample(App *app, int k, double t) {
  PictureSampling *f = &app->sampling;
  double *row = f->seen + (size_t)k * (size_t)app->table.ncols;
  row[0] = t;
  if (lag_sim_outputs_at(app->sim, t, f->y, row + 1))
    for (int i = 1; i < app->table.ncols; i++) row[i] = NAN;
  extend_range(f, row);
}

/* Whether each odd sample of 0 .. n lies on the line between its neighbours. */
static int lines_suffice(const App *app, int n) {
  const PictureSampling *f = &app->sampling;
  size_t ncols = (size_t)app->table.ncols, by = (size_t)(MOST_PLACES / n) * ncols;
  for (int k = 1; k < n; k += 2) {
    const double *row = f->seen + (size_t)k * by;
    if (!is_straight(f, row - by, row + by, row)) return 0;
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
  for (int k = 0; k <= n && rc == 0; k++)
    rc = thin(app, f->seen + (size_t)(MOST_PLACES / n * k) * (size_t)app->table.ncols);
  return rc ? LAG_ENOMEM : LAG_OK;
}

/* Adds the ends of the present step that a and b are; stopped: the run ends at a. b may be an event within the step:
 * its row is added if the event changes the state, and so begins a new step. A run of less than a step is a line,
 * too. */
static int sample_ends(App *app, double a, double b, int stopped) {
  PictureSampling *f = &app->sampling;
  const Run *r = app->sim->run;
  size_t by = (size_t)app->table.ncols;
  int begins = stopped || a == r->step_t0, rc = begins && f->cut ? thin(app, f->seen + by) : 0;
  f->cut = 0;
  if (begins && rc == 0) {
    sample(app, 0, a);
    rc = thin(app, f->seen);
  }
  if (rc == 0 && (b == r->limit || (b == app->until && f->kept == 1 && !f->have_last))) {
    sample(app, 1, b);
    f->cut = b == r->limit && b != r->step_t1;
    rc = f->cut ? 0 : thin(app, f->seen + by);
  }
  return rc ? LAG_ENOMEM : LAG_OK;
}

/* Time to step to: for STEPS_TO methods so near that few samples resolve the step; for others `until`. */
static double sampling_stop(const App *app, double t, double until) {
  const PictureSampling *f = &app->sampling;
  double most = f->length > 0 ? f->length : fabs(app->until - t) / 1000;
  return lag_sim_method(app->sim)->flags & LAG_METHOD_STEPS_TO && fabs(until - t) > most ? t + copysign(most, until - t)
                                                                                         : until;
}

int lag_sampling_advance(App *app, double until) {
  PictureSampling *f = &app->sampling;
  double reach;
  int rc = f->on ? lag_sim_advance(app->sim, lag_sim_time(app->sim)) : LAG_OK; /* starts the run */
  while (rc == 0 && f->on && lag_sim_time(app->sim) != until) {
    rc = lag_sim_ensure_step(app->sim, sampling_stop(app, lag_sim_time(app->sim), until), &reach);
    double t = lag_sim_time(app->sim);
    if (rc < 0 || (lag_marks_note(app) && (rc = LAG_ENOMEM))) return rc;
    if (rc || reach == until || f->kept == 0 || fabs(reach - f->seen_to) >= f->soonest) {
      int bad = f->ends ? sample_ends(app, t, reach, rc == LAG_STOPPED) : sample_step(app, t, reach);
      if (bad == 0 && f->store && app->table.nrows * (size_t)app->table.ncols > MOST_VALUES &&
          reduce(app, MOST_VALUES / 2 / (size_t)app->table.ncols))
        bad = LAG_ENOMEM;
      rc = bad ? bad : rc;
      f->length = fabs(reach - t) * 4 / f->places;
      f->seen_to = reach;
    }
    rc = rc ? rc : lag_app_advance(app, reach);
  }
  return rc ? rc : lag_app_advance(app, until);
}

/* Keeps the last row, and thins the rows to the size of an HTML page. -1: no memory. */
int lag_sampling_close(App *app) {
  enum { MOST_NUMBERS = 2000000 }; /* 12 MB */
  PictureSampling *f = &app->sampling;
  size_t most = app->args.html ? MOST_NUMBERS / (size_t)(f->ndrawn + 1) : SIZE_MAX;

  return f->on && reduce(app, most) ? -1 : 0;
}

void lag_sampling_warn(App *app, char *note, size_t size) {
  enum { FINER = 2 }; /* rows at equal times must be more than chosen ones */
  const PictureSampling *f = &app->sampling;

  note[0] = '\0';
  if (!f->on || !app->table.nrows) return;
  if (!f->store && f->kept > FINER * app->table.nrows) {
    double span = fabs(lag_table_cell(&app->table, app->table.nrows - 1, 0) - lag_table_cell(&app->table, 0, 0));
    snprintf(note, size,
             "rows every %s s are too coarse for this motion, and straight lines join them: leave --every out, or "
             "write --every %g",
             /* a round number that resolves the motion */
             app->args.every, fmax(lag_equal_step(app->sim), lag_tick_step(0, span / (double)f->kept / 1.6, 1)));
  } else if (f->part > 32 * PART) {
    snprintf(note, size,
             "the run is too long to be shown finely: lines are off by up to %.2g %% of the picture; an earlier "
             "--until shows it better",
             100 * f->part);
  }
  if (note[0] && !app->args.quiet) fprintf(stderr, "%s: note: %s\n", app->args.self, note);
}
