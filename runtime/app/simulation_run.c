/* One run. Enters: the command line; leaves: the rows and app->status. Holds: rows are at t0 + k*every, whatever the
 * steps, and at the end. */
#include <math.h>
#include <stdlib.h>

#include "app/app.h"
#include "core/core.h"
#include "numeric/clock.h"
#include "numeric/release.h"

/* After each step: tests for signals, updates the progress line (on a terminal, after 1 s, at most 5 times a
 * second). */
int lag_app_after_step(void *context, const lag_sim *sim) {
  App *app = context;
  if (app->extras.after_step) app->extras.after_step(app->program);
  if (app->watched && sim == app->sim) lag_error_estimate_note(&app->error, app->sim);
  if (app->volume.n && sim == app->sim) lag_app_volume_step(app);
  if (app->progress >= 0 && lag_clock_seconds() - app->shown >= (app->progress ? 0.2 : 1.0)) {
    double t = lag_sim_time(sim), t0 = app->scene->t0, part = (t - t0) / (app->until - t0);
    fprintf(stderr, "\rt = %.6g s, %.0f %% ", t, 100 * part);
    app->shown = lag_clock_seconds();
    app->progress = 1;
  }
  return lag_app_interrupted() != EXIT_SIGNAL || app->bad_file || app->section_rc || app->volume_rc;
}

/* ---- Settings of the run */

static int choose_end(App *app) {
  const Args *a = &app->args;
  double t = lag_sim_time(app->sim);
  if (app->until == t) {
    return lag_app_error(a,
                         "nothing to compute: the run is at t = %g s and ends at %g s; write --until with a later time",
                         t, app->until);
  }
  if (app->resumed && (app->until - t) * (t - app->scene->t0) < 0)
    return lag_app_error(a, "%s is at t = %g s; --until %g would go back", a->resume, t, app->until);
  return 0;
}

/* Notes a position that stops at an end of its table: the equations lack the impulse of the stop. */
static void note_stop(const App *app, const lag_table *c, double t) {
  lag_sim *s = app->sim;
  const lag_model *m = app->scene->model;
  int rate = lag_input_rate(m, c->input);
  double most = 0, span = c->row[c->width * (c->n - 1)] - c->row[0];
  for (int i = 0; i < c->n; i++) most = fmax(most, fabs(c->row[c->width * i + 1]));
  if (rate < 0 || m->inputs(m, t, s->p, s->u) || !(fabs(s->u[rate]) * span > 1e-9 * most)) return;
  fprintf(stderr,
          "%s: note: there %s stops at once, from %s = %.3g in SI units: an impulse that the motion lacks. End the run "
          "at that row, or let the velocity end at 0: v = integral(a, level), u = integral(v)\n",
          app->args.self, m->u[c->input].name, m->u[rate].name, s->u[rate]);
}

/* Notes input tables that do not cover the run: outside, their first and last values hold. */
static void note_tables(const App *app) {
  const lag_model *m = app->scene->model;
  double from = fmin(lag_sim_time(app->sim), app->until), to = fmax(lag_sim_time(app->sim), app->until);
  for (int i = 0; i < m->ntables && !app->args.quiet; i++) {
    const lag_table *c = &m->tables[i];
    double first = c->row[0], last = c->row[c->width * (c->n - 1)];
    if (isnan(app->sim->hold[c->input]) && (from < first || to > last)) {
      const char *self = app->args.self, *name = m->u[c->input].name;
      if (last <= nextafter(first, HUGE_VAL))
        fprintf(stderr, "%s: note: the table of %s is a jump at %g s; its values hold before and after it\n", self,
                name, first);
      else
        fprintf(stderr, "%s: note: the table of %s reaches from %g to %g s; outside, its first and last values hold\n",
                self, name, first, last);
      if (from < first) note_stop(app, c, first);
      if (to > last) note_stop(app, c, last);
    }
  }
}

int lag_app_choose_skip(App *app) {
  const Args *a = &app->args;
  app->skip = NAN;
  if (!a->skip) return 0;
  if (!lag_args_number(a, "--skip", a->skip, "--skip 100", &app->skip)) return EXIT_USAGE;
  double t = app->resumed ? lag_sim_time(app->sim) : app->scene->t0, dir = app->until < t ? -1 : 1;
  if ((app->skip - t) * dir < 0 || (app->until - app->skip) * dir <= 0)
    return lag_app_error(a, "--skip %s: the run is from %g to %g s; what is left out ends between them", a->skip, t,
                         app->until);
  return 0;
}

/* Sets the grid of rows, saved with the run: grid[0] origin, [1] spacing, [2] index of the next row. */
static int choose_grid(App *app) {
  const Args *a = &app->args;
  double *grid = lag_sim_output_grid(app->sim), every = app->resumed ? grid[1] : app->scene->every;
  if (lag_app_equal_times(a)) every = 0;
  double t = lag_sim_time(app->sim), origin = app->resumed && every > 0 ? grid[0] : t;
  if (lag_args_every(a, &every)) return EXIT_USAGE;
  if (a->every) origin = app->scene->t0;
  if (!(every > 0)) {
    double h = a->energy_error ? lag_equal_step(app->sim) : 0; /* equal steps: the energy at ends of them */
    every = fabs(app->until - t) / 1000;
    if (h > 0) every = h * ceil(every / h * (1 - 1e-9));
    origin = t;
  }
  if (app->section < 0 &&
      (a->out || ((a->every || a->tangent || a->sensitivity) && (a->svg || a->html || a->sketch))) &&
      fabs(app->until - t) / every > 1e9) {
    return lag_app_error(a, "a row every %g s for %g s is %.3g rows; write a larger --every", every,
                         fabs(app->until - t), fabs(app->until - t) / every);
  }
  grid[0] = origin;
  grid[1] = every;
  grid[2] = app->resumed ? floor(lag_app_row_at(app, grid, t)) + 1 : 0;
  return 0;
}

/* ---- The run */

/* Advances along the grid and writes a row at each time up to app->until. */
static int run_rows(App *app) {
  double *grid = lag_sim_output_grid(app->sim), last = lag_app_row_at(app, grid, app->until);
  int rc = 0;
  while (rc == 0 && grid[2] <= last) {
    double t = lag_app_row_time(app, grid);
    if (grid[2] == last) app->until = t; /* same time up to rounding */
    rc = lag_app_interrupted() != EXIT_SIGNAL ? LAG_INTERRUPTED : lag_sampling_advance(app, t);
    rc = rc ? rc : lag_app_put_row(app);
    grid[2] += rc == 0;
  }
  return rc;
}

/* --skip: advances without rows, points and measures, which begin at that time. */
static int skip_transient(App *app) {
  double *grid = lag_sim_output_grid(app->sim), t = app->skip;
  if (isnan(t)) return LAG_OK;
  app->skipping = 1;
  int rc = lag_sim_advance(app->sim, t);
  app->skipping = 0;
  grid[2] = ceil(lag_app_row_at(app, grid, t));
  return rc;
}

static void run(App *app) {
  int skipped = skip_transient(app);
  int rows = app->section < 0 && (app->args.out || (app->table.keep && (app->args.every || !app->sampling.on))),
      rc = skipped ? skipped : lag_app_measures_begin(app), begun = !skipped && rc >= 0;
  rc = rows && rc == 0 ? run_rows(app) : rc;
  if (rc == 0) {
    rc = lag_sampling_advance(app, app->until);
    rc = rc ? rc : lag_sim_judge(app->sim);
  }
  int within = app->args.energy_error && !app->args.every && lag_equal_step(app->sim) > 0; /* a step */
  if (rows && rc >= 0 && app->last_row != lag_sim_time(app->sim) && !within) {
    int bad = lag_app_put_row(app);
    rc = bad ? bad : rc;
  }
  if (begun && lag_app_measures_end(app)) rc = LAG_ENOMEM;
  if (lag_sampling_close(app)) rc = LAG_ENOMEM;
  app->status = app->bad_file                ? LAG_EIO
                : app->section_rc && rc >= 0 ? app->section_rc
                : app->volume_rc && rc >= 0  ? app->volume_rc
                                             : rc;
  lag_app_stop_clock(app);
}

static int open_output(App *app) {
  const Args *a = &app->args;
  if (lag_table_init(&app->table, app->sim, a->svg || a->sketch || a->html) ||
      !(app->row = calloc((size_t)app->table.ncols, sizeof *app->row))) {
    return lag_app_error(a, "out of memory");
  }
  app->table.points = app->section >= 0;
  if (lag_tangent_columns_open(app) || lag_sensitivity_open(app) || lag_app_volume_open(app) ||
      lag_app_choose_curves(app) || lag_portrait_open(app))
    return EXIT_USAGE;
  if ((a->html || a->picture.drawing) && lag_app_choose_shapes(app)) return EXIT_USAGE;
  if (lag_app_try_file(app, a->svg) || lag_app_try_file(app, a->html) || lag_app_try_file(app, a->save))
    return EXIT_USAGE;
  int rc = lag_sampling_open(app);
  rc = rc ? rc : lag_marks_open(app);
  rc = rc ? rc : lag_event_log_open(app);
  return rc ? rc : a->out && lag_rows_open(&app->rows, a->out, &app->table) ? lag_app_io_error(app, a->out) : 0;
}

int lag_app_run(App *app) {
  int rc = lag_app_set_up(app);
  rc = rc || !app->args.accuracy ? rc : lag_app_choose_by_accuracy(app);
  if (rc || (rc = lag_section_choose(app)) != 0 || (rc = lag_app_check_outputs(app)) != 0 ||
      (rc = choose_end(app)) != 0 || (rc = lag_app_choose_skip(app)) != 0 || (rc = choose_grid(app)) != 0)
    return rc;
  if (app->args.save && (lag_sim_method(app->sim)->flags & LAG_METHOD_NO_SAVE)) {
    return lag_app_error(&app->args, "--save-state: the state of method %s cannot be saved; those of liblag can",
                     lag_sim_method(app->sim)->name);
  }
  if ((rc = lag_app_measures_open(app)) != 0 || (rc = lag_app_gradient_open(app)) != 0) return rc;
  lag_app_catch_interrupt();
  if ((rc = open_output(app)) != 0) return rc;
  if (!app->args.quiet || app->args.json || app->args.save || app->args.energy_error) {
    lag_sim_balance(app->sim); /* no effect on a resumed run, which keeps its setting */
  }
  note_tables(app);
  lag_sim_on_step(app->sim, lag_app_after_step, app);
  lag_sim_on_event(app->sim, lag_event_note, app);
  if ((rc = lag_app_error_begin(app)) != 0) return rc;
  lag_app_start_clock(app);
  run(app);
  lag_app_error_end(app);
  return 0;
}

void lag_app_free(App *app) {
  lag_sim_free(app->sim);
  lag_table_free(&app->table);
  lag_event_log_free(app);
  lag_sampling_free(app);
  lag_marks_free(app);
  lag_error_estimate_free(&app->error);
  lag_app_measures_free(app);
  lag_phase_volume_free(&app->volume);
  free(app->show.shapes);
  lag_sensitivity_free(app);
  lag_free_all(app->show.words, app->portrait, app->drawn.x, app->drawn.note, app->row, app->empty_state,
               app->state.data);
}

