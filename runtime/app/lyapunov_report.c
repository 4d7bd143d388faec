/* --lyapunov: Lyapunov exponents of a scene's motion. Enters: the command line; leaves: a table, JSON, rows and a
 * picture of the running estimates. Holds: an interrupted run reports the estimates so far. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/lyapunov.h"
#include "app/app.h"
#include "core/core.h"

/* default transient: a tenth of the time, in which tangent vectors align; rows of estimates */
enum { TURNING = 10, ROWS = 500 };

typedef struct Job {
  App *app;
  Lyapunov l;
  int rc;          /* failure within a step; 0: none */
  double next_row; /* time of the next row of estimates */
} Job;

/* ---- Settings */

/* app->until and *from: the end of the run, and of the transient. */
static int choose_times(App *app, double *from) {
  const Args *a = &app->args;
  double t0 = app->scene->t0;
  if (!(app->until > t0))
    return lag_app_error(a, "--until %s: exponents are means over a long time from t = %g s on; write a later one",
                         a->until ? a->until : "", t0);
  double turning = (app->until - t0) / TURNING;
  if (a->transient && !lag_args_number(a, "--transient", a->transient, "--transient 100", &turning)) return EXIT_USAGE;
  if (turning < 0 || turning >= app->until - t0)
    return lag_app_error(a, "--transient %g: the time left out at the beginning must be between 0 and %g s", turning,
                         app->until - t0);
  *from = t0 + turning;
  return 0;
}

static int choose_number(App *app, int *k) {
  const Args *a = &app->args;
  int n = lag_tangent_dimension(app->sim);
  double x = n;
  if (n < 0) return lag_app_error(a, "%s", lag_sim_message(app->sim));
  if (n == 0)
    return lag_app_error(a, "constraints fix all coordinates of the model: there are no neighbouring motions");
  if (a->exponents && !lag_args_number(a, "--exponents", a->exponents, "--exponents 1", &x)) return EXIT_USAGE;
  if (x < 1 || x > n || x != floor(x))
    return lag_app_error(
        a, "--exponents %s: write a whole number from 1 to %d, the coordinates, velocities and states of the model%s",
        a->exponents, n, app->scene->model->constraints ? " that constraints leave free" : "");
  *k = (int)x;
  return 0;
}

/* Table of t and the running estimates, in place of the scene's outputs. */
static int make_table(App *app, int k) {
  Table *t = &app->table;
  *t = (Table){.ncols = k + 1, .keep = 1, .cols = calloc((size_t)k + 1, sizeof *t->cols)};
  app->row = calloc((size_t)k + 1, sizeof *app->row);
  if (!t->cols || !app->row) return lag_app_error(&app->args, "out of memory");
  for (int i = 0; i <= k; i++) {
    snprintf(t->cols[i].name, sizeof t->cols[i].name, i ? "exponent %d" : "t", i);
    strcpy(t->cols[i].unit, i ? "1/s" : "s");
  }
  return 0;
}

/* ---- The run */

static int put_estimates(Job *job) {
  App *app = job->app;
  app->row[0] = job->l.t;
  for (int i = 0; i < job->l.k; i++) app->row[i + 1] = lag_lyapunov_exponent(&job->l, i);
  return lag_app_write_row(app, 1);
}

static void at_event(void *context, int k, double t, const double *before, const double *after) {
  Job *job = context;
  (void)k;
  if (memcmp(before, after, (size_t)job->l.n * sizeof *before) != 0)
    lag_lyapunov_event(&job->l, job->app->sim, t, before);
}

static int after_step(void *context, const lag_sim *sim) {
  Job *job = context;
  Lyapunov *l = &job->l;
  if (job->rc) return 1;
  job->rc = lag_lyapunov_step(l, job->app->sim);
  if (job->rc == 0 && l->t > l->begun && l->t >= job->next_row) {
    job->rc = put_estimates(job);
    job->next_row = l->t + (l->until - l->from) / ROWS;
  }
  return lag_app_after_step(job->app, sim) || job->rc != 0;
}

/* ---- The report */

/* Note where the sum of the exponents is not the mean divergence (Liouville): steps are too long for the fastest
 * decay. */
static void caution(FILE *f, const Lyapunov *l) {
  double sum = lag_lyapunov_exponent(l, l->k), divergence = lag_lyapunov_divergence(l),
         size = fabs(lag_lyapunov_exponent(l, l->k - 1));
  if (fabs(sum - divergence) > 1e-3 * fmax(size, fabs(divergence)) + 3 * lag_lyapunov_error(l, l->k)) {
    fprintf(f,
            "note: the sum should be the mean divergence of the flow, %.6g: the steps are too long for the fastest "
            "decay; take smaller steps, "
            "or trust only the first exponents\n",
            divergence);
  }
}

/* Conclusions from the exponents that their errors allow: chaos, entropy, dimension. */
static void conclude(FILE *f, const Lyapunov *l) {
  double first = lag_lyapunov_exponent(l, 0), off = lag_lyapunov_error(l, 0), error,
         x = lag_lyapunov_entropy(l, &error);
  int sign = lag_lyapunov_sign(l, 0);
  if (sign > 0)
    fprintf(
        f,
        "chaotic, if the motion is bounded: small errors grow by a factor of e in %.3g s (%.3g to %.3g), in the mean\n",
        1 / first, 1 / (first + off), 1 / (first - off));
  if (sign > 0 && l->k == l->d)
    fprintf(f, "sum of the positive exponents (entropy by Pesin): %.4g, error %.1g 1/s\n", x, error);
  if (sign == 0)
    fprintf(
        f,
        "not known to be chaotic: the first exponent is 0 within three errors; one below %.1g 1/s needs a longer run\n",
        3 * off);
  if (sign < 0) fputs("not chaotic: small errors decay\n", f);
  if (isinf(lag_lyapunov_exponent(l, l->k)))
    fputs("minus infinity: where the motion begins to slide, or a body to stick, neighbouring motions become one\n", f);
  x = lag_lyapunov_dimension(l, &error);
  if (isfinite(x)) fprintf(f, "dimension by Kaplan and Yorke: %.4g, error %.1g\n", x, error);
  fprintf(f,
          "error: the largest of the standard error from %d blocks, of the change since half the time, and of one "
          "factor of e in the whole time; zero is "
          "reached as log(t)/t only\n",
          l->nblocks);
}

static void put_text(FILE *f, App *app, const Lyapunov *l) {
  lag_report_head(app, f);
  if (app->why[0]) fprintf(f, "chosen: %s\n", app->why);
  if (!(l->t > l->begun)) {
    fprintf(f, "no step of the run ends after t = %g s, where the measurement begins; run longer: --until\n", l->from);
    return;
  }
  fprintf(f, "measured from t = %.6g to %.6g s, over %lld step%s\n", l->begun, l->t, l->steps,
          l->steps == 1 ? "" : "s");
  if (l->d < l->n)
    fprintf(f, "phase space: %d dimensions, the %d coordinates, velocities and states less %d that constraints fix\n",
            l->d, l->n, l->n - l->d);
  fprintf(f, "  %-4s%18s%14s%22s\n", "", "exponent [1/s]", "error", "at half the time");
  for (int i = 0; i < l->k; i++)
    fprintf(f, "  %-4d%18.8g%14.2g%22.8g\n", i + 1, lag_lyapunov_exponent(l, i), lag_lyapunov_error(l, i),
            lag_lyapunov_at_half(l, i));
  if (l->k == l->d) {
    fprintf(f, "  %-4s%18.8g%14.2g%22.8g\n", "sum", lag_lyapunov_exponent(l, l->k), lag_lyapunov_error(l, l->k),
            lag_lyapunov_at_half(l, l->k));
    caution(f, l);
  }
  if (l->nblocks < 2) {
    fputs("no errors: the time measured is too short\n", f);
    return;
  }
  conclude(f, l);
}

static void json_list(Json *j, const char *name, const Lyapunov *l, double (*value)(const Lyapunov *, int)) {
  JSON_EACH(j, name, '[', i, l->k) lag_json_number(j, NULL, value(l, i));
}

/* Number of exponents that are minus infinity. */
static int infinite(const Lyapunov *l) {
  int count = 0;
  for (int i = 0; i < l->k; i++) count += isinf(lag_lyapunov_exponent(l, i)) != 0;
  return count;
}

static void put_json(FILE *f, const App *app, const Lyapunov *l) {
  int all = l->k == l->d, sign = lag_lyapunov_sign(l, 0);
  double error, dimension = lag_lyapunov_dimension(l, &error), entropy_error,
                entropy = lag_lyapunov_entropy(l, &entropy_error);
  Json j = lag_report_json_open(app, f);
  lag_json_numbers(&j, {"from", l->begun}, {"until", l->t});
  lag_json_counts(&j, {"steps", l->steps}, {"blocks", l->nblocks}, {"phase_space", l->d});
  json_list(&j, "exponents", l, lag_lyapunov_exponent);
  json_list(&j, "spread", l, lag_lyapunov_spread);
  json_list(&j, "errors", l, lag_lyapunov_error);
  json_list(&j, "at_half", l, lag_lyapunov_at_half);
  lag_json_count(&j, "minus_infinity", infinite(l));
  lag_json_numbers(&j, {"sum", all ? lag_lyapunov_exponent(l, l->k) : NAN},
                       {"sum_spread", all ? lag_lyapunov_spread(l, l->k) : NAN},
                       {"divergence", lag_lyapunov_divergence(l)},
                       {"sum_error", all ? lag_lyapunov_error(l, l->k) : NAN}, {"dimension", dimension},
                       {"dimension_error", error}, {"entropy", all && sign > 0 ? entropy : NAN},
                       {"entropy_error", all && sign > 0 ? entropy_error : NAN});
  lag_json_truth(&j, "chaotic", l->nblocks < 2 || sign == 0 ? -1 : sign > 0);
  lag_json_close(&j);
}

/* ---- The command */

/* Exit status and message where there is no result; else 0. */
static int failed(App *app, const Job *job) {
  const Args *a = &app->args;
  double t = lag_sim_time(app->sim);
  errno = app->bad_errno;
  if (app->bad_file) return lag_app_io_error(app, app->bad_file);
  if (job->rc == LAG_EDOMAIN)
    lag_app_error(a,
                  "at t = %g s neighbouring motions become one within a step, an exponent of minus infinity; take "
                  "fewer: --exponents %d, or "
                  "smaller steps",
                  t, job->l.k > 1 ? job->l.k - 1 : 1);
  else if (job->rc || app->status < 0)
    lag_app_error(a, "%s", job->rc == LAG_ENOMEM ? "out of memory" : lag_sim_message(app->sim));
  else if (app->status == LAG_STOPPED)
    lag_app_error(a,
                  "an event stopped the run at t = %g s: exponents are means over a motion that goes on; take another "
                  "start, or an earlier "
                  "--until",
                  t);
  else return 0;
  return EXIT_RUN;
}

static int finish(App *app, Job *job) {
  const Args *a = &app->args;
  int on_stdout = a->out && strcmp(a->out, "-") == 0, rc = failed(app, job);
  char title[300];
  lag_lyapunov_end(&job->l);
  if (rc) {
    lag_rows_close(&app->rows, 0);
    return rc;
  }
  snprintf(title, sizeof title, "%s: %s, Lyapunov exponents so far", app->scene->model->name, app->scene->name);
  if (lag_rows_close(&app->rows, 1)) rc = lag_app_io_error(app, a->out);
  if (a->svg && (lag_app_choose_curves(app) || lag_app_draw_table(app, title))) rc = EXIT_USAGE;
  if (a->json) put_json(stdout, app, &job->l);
  else if (!a->quiet) put_text(on_stdout ? stderr : stdout, app, &job->l);
  return rc ? rc : app->status == LAG_INTERRUPTED ? lag_app_interrupted() : EXIT_FINE;
}

static int run(App *app, Job *job) {
  const Args *a = &app->args;
  lag_app_catch_interrupt();
  if (a->out && lag_rows_open(&app->rows, a->out, &app->table)) return lag_app_io_error(app, a->out);
  lag_sim_on_step(app->sim, after_step, job);
  lag_sim_on_event(app->sim, at_event, job);
  lag_app_start_clock(app);
  app->status = lag_sim_advance(app->sim, app->until);
  lag_app_stop_clock(app);
  return finish(app, job);
}

int lag_app_lyapunov(App *app) {
  Job job = {.app = app};
  double from = 0;
  int k = 0, rc = lag_app_set_up_start(app);
  rc = rc ? rc : lag_app_choose_method(app);
  rc = rc ? rc : lag_app_check_outputs(app);
  rc = rc ? rc : choose_times(app, &from);
  rc = rc ? rc : choose_number(app, &k);
  rc = rc ? rc : make_table(app, k);
  if (rc == 0 && lag_lyapunov_begin(&job.l, app->sim, k, from, app->until))
    rc = lag_app_error(&app->args, "%s", job.l.pool.failed ? "out of memory" : lag_sim_message(app->sim));
  job.next_row = from + (app->until - from) / ROWS;
  rc = rc ? rc : run(app, &job);
  lag_lyapunov_free(&job.l);
  return rc;
}
