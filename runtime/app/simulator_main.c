/* Main program of a simulator. Enters: the command line; leaves: files, a report and an exit status. Holds: results
 * up to a failure or an interrupt are written. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#ifndef _WIN32
#include <sys/wait.h>
#endif

#include "app/app.h"
#include "io/posix.h"
#include "numeric/release.h"

/* After a value that is not finite: sends t, q, v, z and p of a state through the pipe $LAG_LAST_STATE (a
 * descriptor) to the waiting lagc process, if there is one, which names the expression that has none; and whether
 * the run ended there. Waits for its end. */
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

static int save_state(const App *app) {
  State st = {
      .tol = lag_sim_tolerance(app->sim), .signature = lag_sim_signature(app->sim), .t = lag_sim_time(app->sim)};
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
  if (!st.data || lag_sim_save(app->sim, st.data))
    rc = lag_app_error(&app->args, "%s", st.data ? lag_sim_message(app->sim) : "out of memory");
  else if (lag_state_write(path, &st)) rc = lag_app_io_error(app, path);
  free(st.data);
  return rc;
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
    const char *why = lag_sim_message(app->sim), *full = "out of memory"; /* of rows the simulation does not know */
    if (app->status == LAG_ENOMEM && strncmp(why, full, strlen(full)) != 0) why = full;
    return app->status == LAG_EIO ? lag_app_io_error(app, app->bad_file) : lag_app_error(a, "%s", why);
  }
  if (app->rows.open && lag_rows_close(&app->rows, 1)) bad = lag_app_io_error(app, a->out);
  else app->written = 1;
  if (lag_rows_close(&app->log_rows, 1)) bad = lag_app_io_error(app, a->events);
  note_horizon(app);
  lag_sampling_warn(app, note, sizeof note);
  app->show.note = note;
  snprintf(title, sizeof title, "%s: %s%s%s", app->scene->model->name, app->scene->name, app->section < 0 ? "" : ", ",
           app->section < 0 ? "" : app->scene->model->ev[app->section].name);
  if (a->html && lag_html_write(a->html, &app->table, title, &app->show)) {
    bad = lag_app_io_error(app, a->html);
    app->args.html = NULL; /* the report names files that are there */
  }
  lag_table_scale_time(&app->table);
  if (a->energy_error) lag_energy_errors(app, app->sim);
  if (lag_app_draw_table(app, title)) bad = EXIT_USAGE, app->args.svg = NULL;
  if (a->save && app->status >= 0 && save_state(app)) bad = EXIT_USAGE;
  if (a->sketch) {
    FILE *to = a->json ? stderr : f;
    lag_sketch_write(to, &app->table, &app->drawn);
  }
  if (a->json) lag_report_json(app, stdout);
  else if (!a->quiet) lag_report_text(app, f);
  if (app->status < 0 && (a->json || a->quiet))
    lag_app_error(a, "%s%s", lag_sim_message(app->sim), lag_app_way_on(app));
  if (lag_app_flush(app)) bad = EXIT_USAGE;
  tell_last_state(app);
  return bad ? bad : rc;
}

static int simulate(App *app) {
  int rc = lag_app_run(app);
  return rc ? rc : finish(app);
}

typedef int Analysis(App *app);

/* Work that the command line asks for. */
static Analysis *analysis_of(const Args *a) {
  switch (a->analysis) {
    case SWEEP: return lag_app_sweep;
    case DESIGN: return lag_app_design;
    case FIT: return lag_app_fit;
    case MODES: return lag_app_modes;
    case LINEARIZE: return lag_app_linearize;
    case ORBIT: return lag_app_orbit;
    case CONTINUE: return lag_app_continue;
    case LYAPUNOV: return lag_app_lyapunov;
    case EFFECTS: return lag_app_effects;
    case COST:
    case REFERENCE: return lag_app_cost;
    default: return a->cloud ? lag_app_cloud : lag_app_overlays(a) ? lag_app_overlay : simulate;
  }
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
  } else if (rc == 0 && app.args.method && strncmp(app.args.method, "help ", 5) == 0 &&
             lag_app_find_method(&app, app.args.method + 5)) {
    lag_app_list_methods(&app, app.args.method + 5, stdout);
  } else if (rc == 0) {
    rc = analysis_of(&app.args)(&app);
  }
  if (rc != EXIT_USAGE && lag_app_flush(&app)) rc = EXIT_USAGE;
  lag_app_free(&app);
  lag_free_all(app.args.sets, app.args.scenes, app.args.measures, app.args.plot_ys, app.args.vs, app.args.sigmas,
               app.args.priors);
  return rc;
}
