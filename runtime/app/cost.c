/* --cost: error and time of every method at many settings, against a reference. --reference: writes that reference, for a
 * simulator of lower precision. Enters: the command line; leaves: a table, JSON, a picture; or samples as text. Holds: times are
 * processor time of this process. */
#include "app/cost.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/core.h"

enum { SAMPLES = 16 };

/* The scene without monitors and closed forms, which would end a rough run early or cost time besides the method. */
typedef struct BareScene {
  App *app;
  lag_scene scene;
} BareScene;

/* A new simulation of the bare scene with the values of the command line; NULL: no memory, or a message. */
static lag_sim *new_simulation(void *context)
{
  BareScene *b = context;
  App *app = b->app;

  app->sim = lag_sim_new(&b->scene);
  if (app->sim && lag_app_set_values(app)) {
    lag_sim_free(app->sim);
    app->sim = NULL;
  }
  lag_sim *sim = app->sim;
  app->sim = NULL;
  return sim;
}

/* ---- The reference */

/* s := samples of a run by `method` at a tolerance. 0, or an exit status after a message. */
static int record_samples(BareScene *b, const lag_method *method, double tol, Samples *s)
{
  const Args *a = &b->app->args;
  lag_sim *sim = new_simulation(b);

  if (!sim) {
    return lag_app_error(a, "out of memory");
  }
  int rc = lag_sim_set_method(sim, method, NULL, 0);
  rc = rc ? rc : lag_sim_set_tolerance(sim, tol);
  rc = rc ? rc : lag_samples_take(s, sim);
  if (rc) {
    lag_app_error(a, "the reference run by %s(tol=%g) failed: %s", method->name, tol, lag_sim_message(sim));
  }
  lag_sim_free(sim);
  return rc ? EXIT_RUN : 0;
}

/* Reference by taylor, or by dop853 where the model has no Taylor series, at two tolerances; their difference is its uncertainty. */
static int compute_reference(BareScene *b, Cost *c)
{
  App *app = b->app;
  const lag_model *m = b->scene.model;
  int series = m->taylor && !m->constraints, n = c->reference.n;
  const lag_method *method = series ? &lag_taylor_method : &lag_dop853;
  /* --reference serves at most 19 digits, so 22 suffice: for 1e-26 dop853 takes 2.6 times as many steps. */
  double rough_enough = app->args.reference ? 1e-22 : 0;
  double tol = series ? 9 * DBL_EPSILON : fmax(pow(DBL_EPSILON, 0.75), rough_enough), *scale = calloc((size_t)n + 1, sizeof *scale);
  Samples rough;
  int rc = lag_samples_init(&rough, c->reference.rows, n) || !scale ? lag_app_error(&app->args, "out of memory") : 0;

  if (rc == 0) {
    memcpy(rough.t, c->reference.t, (size_t)rough.rows * sizeof(double));
    rc = record_samples(b, method, tol, &c->reference);
    rc = rc ? rc : record_samples(b, method, 10 * tol, &rough);
  }
  if (rc == 0) {
    lag_sim *sim = new_simulation(b);
    if (sim) {
      lag_cost_scales(&c->reference, sim, scale);
      c->reference.uncertainty = fmax(lag_cost_error(&rough, &c->reference, scale), DBL_EPSILON);
    }
    lag_sim_free(sim);
  }
  lag_samples_free(&rough);
  free(scale);
  snprintf(c->reference_name, sizeof c->reference_name, "%s, %d digits", method->name, (int)(DBL_MANT_DIG * 0.30103));
  return rc;
}

/* Sample times, equally spaced over the run. */
static int choose_times(App *app, Cost *c)
{
  double t0 = app->scene->t0, t1 = app->until;

  if (t1 == t0) {
    return lag_app_error(&app->args, "nothing to compute: the run begins and ends at t = %g s; write --until with another time", t0);
  }
  for (int i = 0; i < SAMPLES; i++) {
    c->reference.t[i] = t0 + (t1 - t0) * (i + 1) / SAMPLES;
  }
  return 0;
}

static void write_reference(FILE *f, const Cost *c)
{
  const Samples *s = &c->reference;

  fprintf(f, "samples %d %d\nby %s\nuncertainty %.17g\n", s->rows, s->n, c->reference_name, s->uncertainty);
  for (int i = 0; i < s->rows; i++) {
    fprintf(f, "%.17g", s->t[i]);
    for (int k = 0; k < s->n; k++) {
      fprintf(f, " %.17g", s->y[(size_t)i * (size_t)s->n + (size_t)k]);
    }
    putc('\n', f);
  }
}

/* *x := next number in the file. 0: there is none. */
static int read_number(FILE *f, double *x)
{
  char word[128], *end;

  if (fscanf(f, "%127s", word) != 1) {
    return 0;
  }
  *x = strtod(word, &end);
  return *end == '\0';
}

static int read_reference(App *app, Cost *c)
{
  const Args *a = &app->args;
  Samples *s = &c->reference;
  FILE *f = strcmp(a->against, "-") == 0 ? stdin : fopen(a->against, "r");
  int rows, n, good;

  if (!f) {
    return lag_app_error(a, "cannot read %s: %s", a->against, strerror(errno));
  }
  good = fscanf(f, "samples %d %d by %95[^\n]", &rows, &n, c->reference_name) == 3 && rows > 0 && rows <= s->rows && n == s->n;
  good = good && fscanf(f, " uncertainty") == 0 && read_number(f, &s->uncertainty);
  for (int i = 0; good && i < rows; i++) {
    good = read_number(f, &s->t[i]);
    for (int k = 0; good && k < n; k++) {
      good = read_number(f, &s->y[(size_t)i * (size_t)n + (size_t)k]);
    }
  }
  s->rows = rows;
  if (f != stdin) {
    fclose(f);
  }
  return good ? 0 : lag_app_error(a, "%s holds no reference for this scene; `--reference` of a simulator of the same model writes one",
                              strcmp(a->against, "-") == 0 ? "standard input" : a->against);
}

/* ---- Measurements */

/* Methods whose order is an option; each value is measured as a separate method. */
static const struct {
  const char *method, *option;
  int from, to, by;
} families[] = {{"variational", "order", 2, 8, 2}, {"gauss", "stages", 1, 4, 1}};

/* Whether --methods names the method, or is not given. */
static int is_selected(const Args *a, const lag_method *m)
{
  size_t n = strlen(m->name);

  for (const char *s = a->methods ? a->methods : m->name; *s; s += strcspn(s, ", "), s += strspn(s, ", ")) {
    if (strcspn(s, ", ") == n && strncmp(s, m->name, n) == 0) {
      return 1;
    }
  }
  return 0;
}

static int add(Cost *c, const lag_method *m, lag_option option)
{
  CostMethod *all = realloc(c->method, ((size_t)c->nmethods + 1) * sizeof *all);

  if (!all) {
    return LAG_ENOMEM;
  }
  c->method = all;
  c->method[c->nmethods++] = (CostMethod){.method = m, .option = option};
  return LAG_OK;
}

static int list_methods(App *app, Cost *c)
{
  const lag_method *m;
  int bad = 0;

  for (int i = 0; (m = lag_app_method_at(app, i)) != NULL; i++) {
    int plain = 1;
    for (size_t k = 0; is_selected(&app->args, m) && k < sizeof families / sizeof *families; k++) {
      for (int x = families[k].from; strcmp(families[k].method, m->name) == 0 && x <= families[k].to; x += families[k].by) {
        bad |= add(c, m, (lag_option){.name = families[k].option, .value = x});
        plain = 0;
      }
    }
    if (plain && is_selected(&app->args, m)) {
      bad |= add(c, m, (lag_option){0});
    }
  }
  if (c->nmethods == 0) {
    return lag_app_error(&app->args, "--methods %s: none of them is a method; --method help lists them", app->args.methods);
  }
  return bad ? lag_app_error(&app->args, "out of memory") : 0;
}

/* Refuses unknown names in --methods. */
static int check_methods(App *app)
{
  const Args *a = &app->args;
  char name[64];

  for (const char *s = a->methods; s && *s; s += strcspn(s, ", "), s += strspn(s, ", ")) {
    snprintf(name, sizeof name, "%.*s", (int)strcspn(s, ", "), s);
    if (!lag_app_find_method(app, name)) {
      return lag_app_unknown_method(app, name);
    }
  }
  return 0;
}

static int measure(BareScene *b, Cost *c, double longest)
{
  App *app = b->app;
  double *scale = calloc((size_t)c->reference.n + 1, sizeof *scale);
  lag_sim *sim = new_simulation(b);
  int rc = scale && sim ? LAG_OK : LAG_ENOMEM;
  CostScene scene = {new_simulation, b, b->scene.t0};

  if (rc == LAG_OK) {
    lag_cost_scales(&c->reference, sim, scale);
  }
  for (int i = 0; i < c->nmethods && rc == LAG_OK; i++) {
    if (app->progress >= 0) {
      fprintf(stderr, "\r\33[K%s (%d of %d)", c->method[i].method->name, i + 1, c->nmethods);
      fflush(stderr);
    }
    rc = lag_cost_measure(&c->method[i], &scene, &c->reference, scale, longest);
  }
  if (app->progress >= 0) {
    fputs("\r\33[K", stderr);
  }
  lag_sim_free(sim);
  free(scale);
  lag_pareto_front(c->method, c->nmethods);
  return rc ? lag_app_error(&app->args, "out of memory") : 0;
}

static int show(App *app, const Cost *c)
{
  const Args *a = &app->args;
  const CostRun *run;

  if (a->json) {
    lag_cost_json(stdout, app, c);
  } else if (!a->quiet) {
    lag_cost_text(stdout, app, c);
  }
  if (a->svg && lag_cost_picture(a->svg, app, c)) {
    return lag_app_io_error(app, a->svg);
  }
  if (fflush(stdout)) {
    return lag_app_io_error(app, "standard output");
  }
  if (c->target > 0 && !lag_cost_cheapest(c->method, c->nmethods, c->target, &run)) {
    return EXIT_RUN;
  }
  return EXIT_FINE;
}

static int run_cost(BareScene *b, Cost *c)
{
  App *app = b->app;
  const Args *a = &app->args;
  double longest = 0.5;
  int rc = check_methods(app);

  if (rc == 0 && a->target && (!lag_args_number(a, "--target", a->target, "--target 1e-8", &c->target) || c->target <= 0)) {
    rc = lag_app_error(a, "--target %s: an error to reach, relative and positive; for example --target 1e-8", a->target);
  }
  if (rc == 0 && a->longest && (!lag_args_number(a, "--longest", a->longest, "--longest 10", &longest) || longest <= 0)) {
    rc = lag_app_error(a, "--longest %s: a time in seconds, for example --longest 10", a->longest);
  }
  rc = rc ? rc : a->against ? read_reference(app, c) : compute_reference(b, c);
  if (rc == 0 && c->reference.rows == 0) {
    rc = lag_app_error(a, "an event ends the run before t = %g s, the first time of comparison; write --until with an earlier time", c->reference.t[0]);
  }
  rc = rc ? rc : list_methods(app, c);
  app->progress = isatty(2) && !a->quiet ? 0 : -1;
  rc = rc ? rc : measure(b, c, longest);
  return rc ? rc : show(app, c);
}

int lag_app_cost(App *app)
{
  Cost cost = {0};
  int rc = lag_app_set_up_start(app);
  BareScene b = {.app = app};

  if (rc == 0) {
    b.scene = *app->scene;
    b.scene.nmonitors = b.scene.nexact = 0;
    lag_sim_free(app->sim);
    app->sim = NULL;
    rc = lag_samples_init(&cost.reference, SAMPLES, 2 * b.scene.model->nq + b.scene.model->nz) ? lag_app_error(&app->args, "out of memory") : 0;
  }
  rc = rc ? rc : choose_times(app, &cost);
  if (rc == 0 && app->args.reference) {
    rc = compute_reference(&b, &cost);
    if (rc == 0) {
      write_reference(stdout, &cost);
      rc = fflush(stdout) ? lag_app_io_error(app, "standard output") : EXIT_FINE;
    }
  } else if (rc == 0) {
    rc = run_cost(&b, &cost);
  }
  lag_samples_free(&cost.reference);
  free(cost.method);
  return rc;
}
