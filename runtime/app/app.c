/* Main program of a simulator. Enters: the command line; leaves: rows, pictures, a report and an exit status. Holds: rows
 * are at t0 + k*every, whatever the steps, and at the end; results up to a failure or an interrupt are written. */
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#ifndef _WIN32
#include <sys/wait.h>
#endif

#include "app/app.h"
#include "core/core.h"
#include "io/posix.h"
#include "numeric/clock.h"

/* Signal received, 0: none. The only mutable global, since a signal handler can reach nothing else. */
static volatile sig_atomic_t interrupted;

static void on_interrupt(int signal_number) { interrupted = signal_number; }

/* After each step: tests for signals, updates the progress line (on a terminal, after 1 s, at most 5 times a second). */
int lag_app_after_step(void *context, const lag_sim *sim) {
  App *app = context;
  if (app->watched && sim == app->sim) lag_error_estimate_note(&app->error, app->sim);
  if (app->volume.n && sim == app->sim) lag_app_volume_step(app);
  if (app->progress >= 0 && lag_clock_seconds() - app->shown >= (app->progress ? 0.2 : 1.0)) {
    double t = lag_sim_time(sim), t0 = app->scene->t0, part = (t - t0) / (app->until - t0);
    fprintf(stderr, "\rt = %.6g s, %.0f %% ", t, 100 * part);
    app->shown = lag_clock_seconds();
    app->progress = 1;
  }
  return interrupted != 0 || app->bad_file || app->section_rc || app->volume_rc;
}

/* ---- Settings of the run */

static int choose_end(App *app) {
  const Args *a = &app->args;
  double t = lag_sim_time(app->sim);
  if (app->until == t) {
    return lag_app_error(a, "nothing to compute: the run is at t = %g s and ends at %g s; write --until with a later time", t,
                     app->until);
  }
  if (app->resumed && (app->until - t) * (t - app->scene->t0) < 0)
    return lag_app_error(a, "%s is at t = %g s; --until %g would go back", a->resume, t, app->until);
  return 0;
}

/* Notes input tables that do not cover the run: outside, their first and last values hold. */
static void note_tables(const App *app) {
  const lag_model *m = app->scene->model;
  double from = fmin(lag_sim_time(app->sim), app->until), to = fmax(lag_sim_time(app->sim), app->until);
  for (int i = 0; i < m->ntables && !app->args.quiet; i++) {
    const lag_table *c = &m->tables[i];
    double first = c->row[0][0], last = c->row[c->n - 1][0];
    if (isnan(app->sim->hold[c->input]) && (from < first || to > last)) {
      fprintf(stderr, "%s: note: the table of %s reaches from %g to %g s; outside, its first and last values hold\n", app->args.self,
              m->u[c->input].name, first, last);
    }
  }
}

/* Whether two paths lead to the same existing regular file. */
static int same_file(const char *a, const char *b) {
  struct stat x, y;
  return stat(a, &x) == 0 && stat(b, &y) == 0 && x.st_dev == y.st_dev && x.st_ino == y.st_ino && S_ISREG(x.st_mode);
}

/* The path without ./ before it: files that are not there yet are told apart by their names. */
static const char *plain(const char *path) {
  while (strncmp(path, "./", 2) == 0) path += 2;
  return path;
}

int lag_app_check_outputs(const App *app) {
  const Args *a = &app->args;
  const char *const to[] = {a->out, a->svg, a->html, a->save, a->events, a->motions}, *const keep[] = {app->program->source, "/proc/self/exe", a->resume, a->rows};
  enum { N = sizeof to / sizeof *to, KEPT = sizeof keep / sizeof *keep };

  for (int i = 0; i < N; i++) {
    for (int k = 0; to[i] && k < KEPT; k++)
      if (keep[k] && same_file(to[i], keep[k]) && !(to[i] == a->save && keep[k] == a->resume)) {
        return lag_app_error(a, "%s would be overwritten: it is %s; write to another file", to[i],
                         k == 0 ? "the model" : k == 1 ? "this program" : k == 2 ? "the state to go on from" : "the file of --rows");
      }
    for (int k = 0; to[i] && k < i; k++)
      if (to[k] && (strcmp(plain(to[i]), plain(to[k])) == 0 ? !lag_is_null_device(to[i]) : same_file(to[i], to[k])))
        return lag_app_error(a, "%s would be written twice; give each result a file of its own", to[i]);
  }
  return 0;
}

/* app->skip := the end of the transient; NaN: none is left out. */
static int choose_skip(App *app) {
  const Args *a = &app->args;
  app->skip = NAN;
  if (!a->skip) return 0;
  if (!lag_args_number(a, "--skip", a->skip, "--skip 100", &app->skip)) return EXIT_USAGE;
  double t = lag_sim_time(app->sim), dir = app->until < t ? -1 : 1;
  if ((app->skip - t) * dir < 0 || (app->until - app->skip) * dir <= 0)
    return lag_app_error(a, "--skip %s: the run is from %g to %g s; what is left out ends between them", a->skip, t, app->until);
  return 0;
}

/* Sets the grid of rows, saved with the run: grid[0] origin, [1] spacing, [2] index of the next row. */
static int choose_grid(App *app) {
  const Args *a = &app->args;
  double *grid = lag_sim_output_grid(app->sim), every = app->resumed ? grid[1] : app->scene->every;
  if (lag_app_equal_times(a)) every = 0;
  double t = lag_sim_time(app->sim), origin = app->resumed && every > 0 ? grid[0] : t;
  if (a->every) {
    if (!lag_args_number(a, "--every", a->every, "--every 0.01", &every)) return EXIT_USAGE;
    if (every <= 0) return lag_app_error(a, "--every %s: the time between rows must be positive, for example --every 0.01", a->every);
    origin = app->scene->t0;
  }
  if (!(every > 0)) {
    double h = a->energy_error ? lag_equal_step(app->sim) : 0; /* equal steps: the energy at ends of them */
    every = fabs(app->until - t) / 1000;
    if (h > 0) every = h * ceil(every / h * (1 - 1e-9));
    origin = t;
  }
  if (app->section < 0 && (a->out || ((a->every || a->tangent) && (a->svg || a->html || a->sketch))) && fabs(app->until - t) / every > 1e9) {
    return lag_app_error(a, "a row every %g s for %g s is %.3g rows; write a larger --every", every, fabs(app->until - t),
                     fabs(app->until - t) / every);
  }
  grid[0] = origin;
  grid[1] = every;
  grid[2] = app->resumed ? floor(lag_app_row_at(app, grid, t)) + 1 : 0;
  return 0;
}

double lag_app_row_at(const App *app, const double *grid, double t) {
  double dir = app->until < app->scene->t0 ? -1 : 1, at = dir * (t - grid[0]) / grid[1], whole = nearbyint(at);
  return fabs(at - whole) * grid[1] <= 4 * DBL_EPSILON * (fabs(grid[0]) + fabs(t)) ? whole : at;
}

/* Time of the next row k: k/(1/every) where 1/every is whole, so that times are 0.3, not 0.1*3. */
double lag_app_row_time(const App *app, const double *grid) {
  double dir = app->until < app->scene->t0 ? -1 : 1, whole = 1 / grid[1], n = nearbyint(whole);
  if (n >= 1 && fabs(whole - n) <= 4e-16 * n) return grid[0] + dir * (grid[2] / n);
  return grid[0] + dir * (grid[2] * grid[1]);
}

/* ---- The run */

/* Counts a row, and records its first output that is not finite. */
static void note_empty(App *app, double t) {
  int i = 1, n = lag_sim_noutputs(app->sim);
  while (i <= n && isfinite(app->row[i])) i++;
  app->rows_put++;
  if (i <= n && app->empty_rows++ == 0) {
    const size_t size = (size_t)(2 * app->scene->model->nq + app->scene->model->nz) * sizeof(double);
    app->empty_column = i;
    app->empty_t = t;
    if ((app->empty_state = malloc(size + 1)) != NULL) memcpy(app->empty_state, lag_sim_q(app->sim), size);
  }
}

int lag_app_write_row(App *app, int drawn) {
  if (app->rows.open && lag_rows_write(&app->rows, app->row)) return lag_app_bad_file(app, app->args.out);
  if (drawn && app->args.energy_error) lag_energy_kept(app);
  return drawn && lag_table_add(&app->table, app->row) ? LAG_ENOMEM : LAG_OK;
}

int lag_app_put_row(App *app) {
  double t = lag_sim_time(app->sim);
  app->row[0] = app->last_row = t;
  int rc = lag_sim_outputs(app->sim, app->row + 1);
  rc = rc ? rc : lag_marks_note(app);
  rc = rc ? rc : lag_tangent_columns_row(app);
  if (rc) return rc;
  note_empty(app, t);
  return lag_app_write_row(app, app->args.every || !app->sampling.on); /* otherwise picture_sampling.c chooses the rows of pictures */
}

/* Advances along the grid and writes a row at each time up to app->until. */
static int run_rows(App *app) {
  double *grid = lag_sim_output_grid(app->sim), last = lag_app_row_at(app, grid, app->until);
  int rc = 0;
  while (rc == 0 && grid[2] <= last) {
    double t = lag_app_row_time(app, grid);
    if (grid[2] == last) app->until = t; /* same time up to rounding */
    rc = interrupted ? LAG_INTERRUPTED : lag_sampling_advance(app, t);
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
  app->status = app->bad_file ? LAG_EIO : app->section_rc && rc >= 0 ? app->section_rc : app->volume_rc && rc >= 0 ? app->volume_rc : rc;
  lag_app_stop_clock(app);
}

/* ---- Files */

int lag_app_io_error(const App *app, const char *path) { return lag_app_error(&app->args, "cannot write %s: %s", path, strerror(errno ? errno : EIO)); }

int lag_app_flush(const App *app) {
  errno = 0;
  return fflush(stdout) || ferror(stdout) ? lag_app_io_error(app, "standard output") : 0;
}

int lag_app_bad_file(App *app, const char *path) {
  app->bad_file = path;
  app->bad_errno = errno;
  return LAG_EIO;
}

int lag_app_try_file(const App *app, const char *path) {
  Outfile o;
  return path && (lag_outfile_open(&o, path) || lag_outfile_close(&o, OUTFILE_DROP)) ? lag_app_io_error(app, path) : 0;
}

static int open_output(App *app) {
  const Args *a = &app->args;
  if (lag_table_init(&app->table, app->sim, a->svg || a->sketch || a->html) ||
      !(app->row = calloc((size_t)app->table.ncols, sizeof *app->row))) {
    return lag_app_error(a, "out of memory");
  }
  app->table.points = app->section >= 0;
  if (lag_tangent_columns_open(app) || lag_app_volume_open(app) || lag_app_choose_curves(app) || lag_portrait_open(app)) return EXIT_USAGE;
  if (a->html && lag_app_choose_points(app)) return EXIT_USAGE;
  if (lag_app_try_file(app, a->svg) || lag_app_try_file(app, a->html) || lag_app_try_file(app, a->save)) return EXIT_USAGE;
  int rc = lag_sampling_open(app);
  rc = rc ? rc : lag_marks_open(app);
  rc = rc ? rc : lag_event_log_open(app);
  return rc ? rc : a->out && lag_rows_open(&app->rows, a->out, &app->table) ? lag_app_io_error(app, a->out) : 0;
}

static int save_state(const App *app) {
  State st = {.tol = lag_sim_tolerance(app->sim), .signature = lag_sim_signature(app->sim), .t = lag_sim_time(app->sim)};
  const lag_method *m = lag_sim_method(app->sim);
  const char *path = app->args.save;
  int rc = 0;
  snprintf(st.program, sizeof st.program, "%s", app->program->name);
  snprintf(st.scene, sizeof st.scene, "%s", app->scene->name);
  snprintf(st.method, sizeof st.method, "%s", m->name);
  st.noptions = m->noptions;
  memcpy(st.options, lag_sim_options(app->sim), (size_t)m->noptions * sizeof(double));
  st.n = lag_sim_save_size(app->sim);
  st.data = malloc(st.n * sizeof(double));
  if (!st.data || lag_sim_save(app->sim, st.data)) rc = lag_app_error(&app->args, "%s", st.data ? lag_sim_message(app->sim) : "out of memory");
  else if (lag_state_write(path, &st)) rc = lag_app_io_error(app, path);
  free(st.data);
  return rc;
}

const double *lag_app_nonfinite_state(const App *app, double *t) {
  const double *now = lag_sim_q(app->sim);
  *t = lag_sim_time(app->sim);
  if (app->status == LAG_ENAN || app->status == LAG_EDOMAIN) return now;
  for (int k = 0; k < lag_sim_ncharges(app->sim) && app->status >= 0; k++) {
    lag_charge_stats c;
    lag_sim_charge(app->sim, k, &c);
    if (isfinite(c.drift)) continue;
    if (!isfinite(c.now)) return now;
    *t = app->scene->t0;
    return app->sim->begin;
  }
  *t = app->empty_t;
  return app->status >= 0 ? app->empty_state : NULL;
}

/* After a value that is not finite: sends t, q, v, z and p of a state through the pipe $LAG_LAST_STATE (a descriptor) to
 * the waiting lagc process, if there is one, which names the expression that has none; and whether the run ended there.
 * Waits for its end. */
#ifdef _WIN32
static void tell_last_state(const App *app) { (void)app; } /* lagc does not wait there */
#else
static void tell_last_state(const App *app) {
  const char *name = getenv("LAG_LAST_STATE");
  const lag_model *m = app->scene->model;
  const int n[] = {2 * m->nq + m->nz, m->np};
  double t;
  const double *of[] = {lag_app_nonfinite_state(app, &t), lag_sim_p(app->sim)};
  FILE *f = name && of[0] ? fdopen(atoi(name), "w") : NULL;
  if (!f) return;
  signal(SIGPIPE, SIG_IGN); /* lagc may have been killed; the status of this run does not depend on it */
  fprintf(f, "%.17g\n", (double)t);
  for (int k = 0; k < 2; k++)
    for (int i = 0; i < n[k]; i++) fprintf(f, "%.17g\n", (double)of[k][i]);
  fprintf(f, "%d\n", app->status < 0);
  fclose(f);
  while (wait(NULL) < 0 && errno == EINTR) continue;
}
#endif

/* Pictures are grey past the horizon. */
static void note_horizon(App *app) {
  Table *t = &app->table;
  double dir = app->until < app->scene->t0 ? -1 : 1;
  size_t n = 0;
  if (!app->watched || isnan(app->error.horizon)) return;
  while (n < t->nrows && dir * (lag_table_cell(t, n, 0) - app->error.horizon) <= 0) n++;
  t->certain = n < t->nrows ? n : 0;
  t->horizon = app->error.horizon;
}

/* Completes the files and prints the report. Returns the exit status. */
static int finish(App *app) {
  const Args *a = &app->args;
  int rc = app->status < 0 ? EXIT_RUN : app->status == LAG_INTERRUPTED ? lag_app_interrupted() : EXIT_FINE, bad = 0;
  int on_stdout = (a->out && strcmp(a->out, "-") == 0) || (a->events && strcmp(a->events, "-") == 0);
  FILE *f = on_stdout ? stderr : stdout;
  char title[300], note[300];
  if (app->status == LAG_EINVAL || app->status == LAG_ENOMEM || app->status == LAG_EIO) {
    lag_rows_close(&app->rows, 0);
    lag_rows_close(&app->log_rows, 0);
    errno = app->bad_errno;
    return app->status == LAG_EIO ? lag_app_io_error(app, app->bad_file) : lag_app_error(a, "%s", app->status == LAG_ENOMEM ? "out of memory" : lag_sim_message(app->sim));
  }
  if (app->rows.open && lag_rows_close(&app->rows, 1)) bad = lag_app_io_error(app, a->out);
  else app->written = 1;
  if (lag_rows_close(&app->log_rows, 1)) bad = lag_app_io_error(app, a->events);
  note_horizon(app);
  lag_sampling_warn(app, note, sizeof note);
  app->show.note = note;
  snprintf(title, sizeof title, "%s: %s%s%s", app->scene->model->name, app->scene->name, app->section < 0 ? "" : ", ",
           app->section < 0 ? "" : app->scene->model->ev[app->section].name);
  if (a->html && lag_html_write(a->html, &app->table, title, &app->show)) bad = lag_app_io_error(app, a->html);
  lag_table_scale_time(&app->table);
  if (a->energy_error) lag_energy_errors(app, app->sim);
  if (lag_app_draw_table(app, title)) bad = EXIT_USAGE;
  if (a->save && app->status >= 0 && save_state(app)) bad = EXIT_USAGE;
  if (a->sketch) {
    FILE *to = a->json ? stderr : f;
    lag_sketch_write(to, &app->table, &app->drawn);
  }
  if (a->json) lag_report_json(app, stdout);
  else if (!a->quiet) lag_report_text(app, f);
  if (app->status < 0 && (a->json || a->quiet)) lag_app_error(a, "%s%s", lag_sim_message(app->sim), lag_app_way_on(app));
  if (lag_app_flush(app)) bad = EXIT_USAGE;
  tell_last_state(app);
  return bad ? bad : rc;
}

void lag_app_catch_interrupt(void) {
  static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
  struct sigaction action = {0}, before;
  action.sa_handler = on_interrupt;
  action.sa_flags = (int)SA_RESETHAND; /* a second Ctrl-C ends at once */
  sigemptyset(&action.sa_mask);
  for (size_t i = 0; i < sizeof signals / sizeof *signals; i++) {
    int nohup = signals[i] == SIGHUP && sigaction(SIGHUP, NULL, &before) == 0 && before.sa_handler == SIG_IGN;
    if (!nohup) sigaction(signals[i], &action, NULL);
  }
}

void lag_app_start_clock(App *app) {
  lag_app_catch_interrupt();
  app->progress = isatty(2) && !app->args.quiet ? 0 : -1;
  app->begun = app->shown = lag_clock_seconds();
}

void lag_app_stop_clock(App *app) {
  app->wall = lag_clock_seconds() - app->begun;
  if (app->progress > 0) fputs("\r\33[K", stderr);
}

int lag_app_interrupted(void) { return EXIT_SIGNAL + interrupted; }

int lag_app_run(App *app) {
  int rc = lag_app_set_up(app);
  if (rc || (rc = lag_section_choose(app)) != 0 || (rc = lag_app_check_outputs(app)) != 0 ||
      (rc = choose_end(app)) != 0 || (rc = choose_skip(app)) != 0 || (rc = choose_grid(app)) != 0)
    return rc;
  if (app->args.save && (lag_sim_method(app->sim)->flags & LAG_METHOD_NO_SAVE)) {
    return lag_app_error(&app->args, "--save-state: the state of method %s cannot be saved; those of liblag can",
                     lag_sim_method(app->sim)->name);
  }
  if ((rc = lag_app_measures_open(app)) != 0) return rc;
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

static int simulate(App *app) {
  int rc = lag_app_run(app);
  return rc ? rc : finish(app);
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
  free(app->show.cols);
  free(app->portrait);
  free(app->drawn.x);
  free(app->drawn.note);
  free(app->row);
  free(app->empty_state);
  free(app->state.data);
}

int lag_app_main(int argc, char **argv, const lag_program *program, const lag_extras *extras) {
  App app = {.program = program, .extras = extras ? *extras : (lag_extras){0}, .last_row = NAN};
  lag_prepare_streams();
  int rc = lag_args_parse(&app.args, argc, argv);
  rc = rc ? rc : lag_app_check_parts(&app);
  if (rc == 0 && app.args.help) {
    lag_app_help(&app, stdout);
  } else if (rc == 0 && app.args.method && strcmp(app.args.method, "help") == 0) {
    lag_app_list_methods(&app, NULL, stdout);
  } else if (rc == 0 && app.args.method && strncmp(app.args.method, "help ", 5) == 0 && lag_app_find_method(&app, app.args.method + 5)) {
    lag_app_list_methods(&app, app.args.method + 5, stdout);
  } else if (rc == 0 && app.args.sweep) {
    rc = lag_app_sweep(&app);
  } else if (rc == 0 && app.args.modes) {
    rc = lag_app_modes(&app);
  } else if (rc == 0 && app.args.lyapunov) {
    rc = lag_app_lyapunov(&app);
  } else if (rc == 0 && app.args.effects) {
    rc = lag_app_effects(&app);
  } else if (rc == 0 && app.args.where) {
    rc = lag_app_where(&app);
  } else if (rc == 0 && (app.args.cost || app.args.reference)) {
    rc = lag_app_cost(&app);
  } else if (rc == 0) {
    rc = app.args.cloud ? lag_app_cloud(&app) : lag_app_overlays(&app.args) ? lag_app_overlay(&app) : simulate(&app);
  }
  if (rc != EXIT_USAGE && lag_app_flush(&app)) rc = EXIT_USAGE;
  lag_app_free(&app);
  free(app.args.sets);
  free(app.args.scenes);
  free(app.args.measures);
  free(app.args.plot_ys);
  free(app.args.vs);
  return rc;
}
