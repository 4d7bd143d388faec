/* --design: where and when to measure so that values are determined best (analysis/design.h). Enters: names to be
 * found, outputs and rows of a run, errors of measured values; leaves: the best measurements and the errors of a fit of
 * them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/design.h"
#include "app/fit_run.h"
#include "core/core.h"
#include "numeric/release.h"
#include "numeric/singular_values.h"

enum { NAME = 200, MOST_CANDIDATES = 1000000 };

/* Candidates: columns at the times of rows, [ntimes ncolumns]. */
typedef struct DesignRun {
  FitRun of;
  int n, ntimes, best;
  double *t, *G, *prior, *error; /* [ntimes]; [candidates n]; [n]; [3 n] chosen, at equal distances, all */
  int *chosen, *even;            /* [best] */
  char *labels;                  /* of columns */
  double size;                   /* of all candidates, in their errors */
} DesignRun;

/* ---- Candidates */

static int refuse_exact(const App *app, const char *label) {
  int n = (int)strcspn(label, " ");
  return lag_app_error(&app->args,
                       "how exact is a measured value of %s? Write --sigma %.*s=0.01, or take some outputs: --columns "
                       "%.*s",
                       label, n, label, n, label);
}

/* The outputs that --columns names, or all, each with its error. */
static int take_columns(DesignRun *d) {
  const App *app = d->of.app;
  Fit *f = &d->of.fit;
  int nout = lag_sim_noutputs(app->sim), rc = 0;
  f->column = calloc((size_t)nout + 1, sizeof *f->column);
  d->labels = calloc((size_t)nout + 1, NAME);
  if (!f->column || !d->labels) return lag_app_error(&app->args, "out of memory");
  for (int i = 0; i < nout && rc == 0; i++) {
    char unit[64], *label = d->labels + (size_t)i * NAME;
    lag_sim_output_info(app->sim, i, label, NAME - sizeof unit - 4, unit, sizeof unit);
    FitColumn *c = &f->column[f->ncolumns];
    if (unit[0] && strcmp(unit, "1") != 0) sprintf(label + strlen(label), " [%s]", unit);
    if (!lag_fit_is_asked(&app->args, label)) continue;
    *c = (FitColumn){.label = label, .output = i};
    rc = lag_fit_take_sigma(&d->of, c);
    if (rc == 0 && !(c->sigma > 0))
      rc = refuse_exact(app, label);
    f->ncolumns++;
  }
  if (rc == 0 && f->ncolumns && (rc = lag_fit_check_names(&app->args, f)) != 0) return rc;
  if (rc == 0 && f->ncolumns == 0)
    return lag_app_error(&app->args, "no output of the scene is left to be measured; --columns takes their names");
  return rc;
}

/* Times of rows, as of a run. */
static int take_times(DesignRun *d) {
  App *app = d->of.app;
  const Args *a = &app->args;
  double t0 = app->scene->t0, span = app->until - t0, every = app->scene->every;
  if (!(every > 0)) every = fabs(span) / 200;
  if (lag_args_positive(a, "--every", a->every, "--every 0.1", "the time between measurements is positive", &every))
    return EXIT_USAGE;
  double rows = floor(fabs(span) / every * (1 + 1e-12)) + 1;
  if (rows * d->of.fit.ncolumns > MOST_CANDIDATES)
    return lag_app_error(&app->args, "%.0f candidates are too many; write a larger --every", rows * d->of.fit.ncolumns);
  d->ntimes = (int)rows;
  d->t = calloc((size_t)rows, sizeof *d->t);
  if (!d->t) return lag_app_error(&app->args, "out of memory");
  for (int k = 0; k < d->ntimes; k++) d->t[k] = t0 + copysign(k * every, span);
  return 0;
}

static int take_number(DesignRun *d) {
  const Args *a = &d->of.app->args;
  long long n = 2 * d->n, candidates = (long long)d->ntimes * d->of.fit.ncolumns;
  int rc = a->best ? lag_args_count(a, "--best", a->best, "--best 10", &n) : 0, priors = 0;
  for (int j = 0; j < d->n; j++) priors += d->of.fit.target[j].prior_error > 0;
  if (rc == 0 && n > candidates) n = candidates;
  if (rc == 0 && n + priors < d->n)
    return lag_app_error(a, "%lld measurements cannot determine %d quantities; write --best %d or more", n, d->n, d->n);
  d->best = (int)n;
  return rc;
}

/* ---- Derivatives */

/* Row of the candidates at the present time. */
static int put_candidates(DesignRun *d, lag_sim *sim, int row, double *Y, double *D) {
  const Fit *f = &d->of.fit;
  double *out = D + lag_sim_noutputs(sim) * d->n;
  int rc = lag_sim_tangent(sim, Y);
  rc = rc ? rc : lag_sim_output_sensitivity(sim, Y, D);
  rc = rc ? rc : lag_sim_outputs(sim, out);
  for (int c = 0; c < f->ncolumns && rc == LAG_OK; c++) {
    d->size = hypot(d->size, out[f->column[c].output] / f->column[c].sigma);
    for (int j = 0; j < d->n; j++)
      d->G[((size_t)row * (size_t)f->ncolumns + (size_t)c) * (size_t)d->n + (size_t)j] =
          D[f->column[c].output * d->n + j] * f->target[j].factor / f->column[c].sigma;
  }
  return rc;
}

static int run_motion(DesignRun *d) {
  App *app = d->of.app;
  lag_sim *sim = lag_app_fresh_bare_sim(app);
  size_t n = (size_t)d->n, nout = (size_t)lag_sim_noutputs(app->sim), state = (size_t)app->sim->pb.n;
  double *Y = calloc((state + nout) * n + nout + 1, sizeof *Y);
  const char **name = calloc(n + 1, sizeof *name);
  d->G = calloc((size_t)(d->ntimes * d->of.fit.ncolumns) * n + 1, sizeof *d->G);
  int rc = sim && Y && name && d->G ? LAG_OK : LAG_ENOMEM;
  for (int j = 0; j < d->n && rc == LAG_OK; j++) name[j] = d->of.fit.target[j].name;
  rc = rc ? rc : lag_app_copy_method(app->sim, sim, 1);
  rc = rc ? rc : lag_sim_set_sensitivity(sim, d->n, name);
  for (int k = 0; k < d->ntimes && rc == LAG_OK; k++) {
    rc = k ? lag_sim_advance(sim, d->t[k]) : LAG_OK;
    if (rc > 0) d->ntimes = k, rc = k ? LAG_OK : LAG_EDOMAIN; /* an event ends the run, and what can be measured */
    if (rc == LAG_OK && k < d->ntimes) rc = put_candidates(d, sim, k, Y, Y + state * n);
  }
  if (rc) lag_app_error(&app->args, "%s", rc == LAG_ENOMEM ? "out of memory" : lag_sim_message(sim));
  lag_sim_free(sim);
  lag_free_all(Y, name);
  return rc ? EXIT_RUN : 0;
}

/* "m by 2, k by 8": the last column of V, in declared units. The number of names. */
static int put_direction(const DesignRun *d, const double *V, char *text) {
  const Fit *f = &d->of.fit;
  int n = d->n;
  double most = 0;
  int names = 0;
  text[0] = '\0';
  for (int j = 0; j < n; j++) most = fmax(most, fabs(V[j * n + n - 1]));
  for (int j = 0; j < n; j++) {
    double v = V[j * n + n - 1] / most;
    size_t at = strlen(text);
    if (!(fabs(v) > 1e-6)) continue;
    names++;
    snprintf(text + at, NAME - at, "%s%.60s by %.3g", at ? ", " : "", f->target[j].label, v * f->target[j].scale);
  }
  return names;
}

/* Refuses a direction that no candidate feels: beside the others, or at all, since a change of a value by its own size
 * that moves outputs by 1e-10 of theirs is rounding. 0: there is none. */
static int refuse_flat(DesignRun *d) {
  const double rounding = 1e-8, least = 1e-10;
  const Fit *f = &d->of.fit;
  int n = d->n, rows = d->ntimes * f->ncolumns;
  double *A = calloc((size_t)(rows + n) * (size_t)n + (size_t)(n * n + n), sizeof *A);
  char text[NAME];
  if (!A) return lag_app_error(&d->of.app->args, "out of memory");
  double *V = A + (rows + n) * n, *s = V + n * n;
  for (int i = 0; i < rows * n; i++) A[i] = d->G[i] * f->target[i % n].scale;
  for (int j = 0; j < n; j++) A[(rows + j) * n + j] = sqrt(d->prior[j]) * f->target[j].scale;
  lag_singular_values(rows + n, n, A, V, s);
  int names = put_direction(d, V, text), flat = !(s[n - 1] > fmax(rounding * s[0], least * d->size));
  free(A);
  if (!flat) return 0;
  return lag_app_error(&d->of.app->args,
                       "no measurement feels a change of %s; leave %s out of --fit, observe what feels it with "
                       "--observe, or add a --prior", text, names > 1 ? "one of these" : "it");
}

/* ---- The report */

static void put_points(const DesignRun *d) {
  const Fit *f = &d->of.fit;
  for (int c = 0; c < f->ncolumns; c++) {
    int at = 0;
    for (int k = 0; k < d->best; k++) {
      if (d->chosen[k] % f->ncolumns != c) continue;
      at = at == 0 ? printf("  %s at t = %.6g", f->column[c].label, d->t[d->chosen[k] / f->ncolumns])
           : at > 100 ? printf("\n    %.6g", d->t[d->chosen[k] / f->ncolumns]) - 1
                      : at + printf(", %.6g", d->t[d->chosen[k] / f->ncolumns]);
    }
    if (at) puts(" s");
  }
}

static void put_report(const DesignRun *d) {
  const Fit *f = &d->of.fit;
  char even[40];
  lag_report_head(d->of.app, stdout);
  printf("best %d of %d measurements, at %d times from %.6g to %.6g s:\n", d->best, d->ntimes * f->ncolumns, d->ntimes,
         d->t[0], d->t[d->ntimes - 1]);
  put_points(d);
  snprintf(even, sizeof even, "%d equally far", d->best);
  printf("%-24s %14s %18s %14s\n", "expected standard error", "of these", even, "of all");
  for (int j = 0; j < d->n; j++) {
    const FitTarget *t = &f->target[j];
    printf("  %-22s", t->label);
    for (int k = 0; k < 3; k++) {
      double e = d->error[k * d->n + j];
      if (isnan(e)) printf(k == 1 ? " %18s" : " %14s", "undetermined");
      else printf(k == 1 ? " %18.4g" : " %14.4g", e);
    }
    printf("%s%s\n", t->unit[0] ? " " : "", t->unit);
  }
}

static void put_json(const DesignRun *d) {
  static const char *const kinds[] = {"errors", "errors_equally_far", "errors_of_all"};
  const Fit *f = &d->of.fit;
  Json j = lag_app_json(d->of.app, stdout);
  lag_json_count(&j, "candidates", d->ntimes * f->ncolumns);
  JSON_OBJECTS(&j, "measurements", k, d->best) {
    lag_json_string(&j, "output", f->column[d->chosen[k] % f->ncolumns].label);
    lag_json_number(&j, "t", d->t[d->chosen[k] / f->ncolumns]);
  }
  for (int kind = 0; kind < 3; kind++) {
    JSON_EACH(&j, kinds[kind], '{', i, d->n) lag_json_number(&j, f->target[i].label, d->error[kind * d->n + i]);
  }
  lag_json_close(&j);
}

/* ---- The analysis */

static int choose(DesignRun *d) {
  int rows = d->ntimes * d->of.fit.ncolumns, n = d->n;
  d->chosen = calloc(2 * (size_t)d->best + 1, sizeof *d->chosen);
  d->error = calloc(3 * (size_t)n + 1, sizeof *d->error);
  if (!d->chosen || !d->error) return lag_app_error(&d->of.app->args, "out of memory");
  d->even = d->chosen + d->best;
  for (int k = 0, nc = d->of.fit.ncolumns; k < d->best; k++)
    d->even[k] = (int)((k + 0.5) * d->ntimes / d->best) * nc + k % nc;
  int rc = lag_design_choose(rows, n, d->G, d->prior, d->best, d->chosen);
  for (int kind = 0; kind < 3 && rc == LAG_OK; kind++) {
    const int *of = kind == 0 ? d->chosen : kind == 1 ? d->even : NULL;
    int bad = lag_design_errors(rows, n, d->G, d->prior, d->best, of, d->error + kind * n);
    for (int j = 0; j < n && bad; j++) d->error[kind * n + j] = NAN;
  }
  if (rc == LAG_EDOMAIN)
    return lag_app_error(&d->of.app->args, "no %d measurements determine all of --fit; write a larger --best", d->best);
  return rc ? lag_app_error(&d->of.app->args, "out of memory") : 0;
}

static int prepare(DesignRun *d) {
  App *app = d->of.app;
  if (!app->args.fit) return lag_app_error(&app->args, "what are the measurements to determine? --fit g,l");
  int rc = lag_app_set_up_start(app);
  rc = rc ? rc : lag_app_choose_method(app);
  d->of.nfiles = 1;
  rc = rc ? rc : lag_fit_take_targets(&d->of);
  d->n = d->of.fit.n;
  rc = rc ? rc : take_columns(d);
  rc = rc ? rc : take_times(d);
  rc = rc ? rc : take_number(d);
  if (rc) return rc;
  if (!(d->prior = calloc((size_t)d->n + 1, sizeof *d->prior))) return lag_app_error(&app->args, "out of memory");
  for (int j = 0; j < d->n; j++) {
    double e = d->of.fit.target[j].prior_error;
    d->prior[j] = e > 0 ? 1 / (e * e) : 0;
  }
  return 0;
}

int lag_app_design(App *app) {
  DesignRun d = {.of = {.app = app}};
  int rc = prepare(&d);
  rc = rc ? rc : run_motion(&d);
  if (rc == 0 && d.best > d.ntimes * d.of.fit.ncolumns) d.best = d.ntimes * d.of.fit.ncolumns;
  rc = rc ? rc : refuse_flat(&d);
  rc = rc ? rc : choose(&d);
  if (rc == 0 && app->args.json) put_json(&d);
  if (rc == 0 && !app->args.json) put_report(&d);
  lag_free_all(d.t, d.G, d.prior, d.error, d.chosen, d.labels);
  lag_fit_run_free(&d.of);
  return rc;
}
