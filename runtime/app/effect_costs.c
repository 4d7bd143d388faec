/* --effects: measures the variants in a program made by `lagc effects`, whose first scene is the user's and whose
 * others are that scene with other effects. Enters: the command line; leaves: lines for lagc, `method`, `span`,
 * `error`, then `variant NUMBER OPERATIONS SECONDS DIFFERENCE WEIGHT` for each. `--effects runs`: differences only.
 * `--effects budget`: for each variant `setting NUMBER ERROR SECONDS METHOD KNOB VALUE`, its fastest setting whose
 * error against the first scene's motion is at most --target, or `none NUMBER SMALLEST`. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/effect_variants.h"
#include "app/cost.h"
#include "core/core.h"

typedef struct Trial {
  App *app;
  Variant *v;  /* [nscenes] */
  Variant finer; /* the first scene with smaller errors */
  int nscenes;
  double t0, t1;
  const lag_method *method; /* named by the user, or chosen for the first scene */
  lag_option options[MOST_OPTIONS];
  double tol;
} Trial;

/* ---- Simulations */

/* Whether the model of a scene has the name in `name=value`. */
static int knows(const lag_scene *scene, const char *text) {
  char name[128], part[160];
  const lag_var *var;
  int index;
  snprintf(name, sizeof name, "%.*s", (int)strcspn(text, "="), text);
  return lag_find_name(scene->model, name, &index, &var) != LAG_IS_NOTHING ||
         lag_family_member(scene->model, name, 0, part, sizeof part);
}

/* Sets the values of the command line; those of effects that are off in this variant and on in another are left out. */
static int set_values(Trial *k) {
  App *app = k->app;
  for (int i = 0; i < app->args.nsets; i++) {
    int here = knows(app->scene, app->args.sets[i]), anywhere = here;
    for (int s = 0; s < k->nscenes && !anywhere; s++) anywhere = knows(k->app->program->scenes[s], app->args.sets[i]);
    int rc = here || !anywhere ? lag_app_set_value(app, app->args.sets[i]) : 0;
    if (rc) return rc;
  }
  return 0;
}

/* Gives a variant the parameter values and the start of the first scene, for all names that it has, since its own
 * text may compute them without the effects that are off. */
static void copy_start(const lag_sim *first, lag_sim *sim) {
  const lag_model *m = first->scene->model, *own = sim->scene->model;
  const lag_var *var;
  int at;
  for (int i = 0; i < m->np; i++)
    if (lag_find_name(own, m->p[i].name, &at, &var) == LAG_IS_P && strcmp(var->name, m->p[i].name) == 0) {
      sim->p[at] = first->p[i];
      sim->fixed[at] = 1;
    }
  if (own->derive) own->derive(own, sim->p);
  for (int i = 0; i < first->pb.n; i++) {
    at = lag_component_index(own, lag_state_column(first, i).name);
    if (at >= 0 && sim->now[at] != first->now[i]) sim->start[at] = first->now[i];
  }
}

/* Sets the method of the first scene, or an automatic one where the variant refuses that. */
static int set_method(Trial *k, lag_sim *sim, double tol) {
  if (lag_sim_set_method(sim, k->method, k->options, k->method->noptions) == LAG_OK &&
      lag_sim_set_tolerance(sim, tol) == LAG_OK)
    return 0;
  return lag_app_choose_method(k->app);
}

/* app->sim := a simulation of scene number `scene` with the values of the command line. */
static int make(Trial *k, int scene) {
  App *app = k->app;
  app->scene = k->app->program->scenes[scene];
  app->sim = lag_sim_new(app->scene);
  return !app->sim ? lag_app_error(&app->args, "out of memory") : lag_app_read_until(app) ? EXIT_USAGE : set_values(k);
}

/* v := a variant with app->sim. */
static void adopt_simulation(Trial *k, Variant *v) {
  *v = (Variant){.sim = k->app->sim};
  k->app->sim = NULL;
}

/* The first scene, whose method, start and times the others take. */
static int prepare_first(Trial *k) {
  App *app = k->app;
  char method[256];
  int rc = make(k, 0);
  rc = rc ? rc : lag_app_choose_method(app);
  if (rc) return rc;
  lag_report_method(app, method, sizeof method);
  printf("method %s\n", method);
  k->method = lag_sim_method(app->sim);
  k->tol = lag_sim_tolerance(app->sim);
  k->t0 = app->scene->t0;
  k->t1 = app->until;
  adopt_simulation(k, &k->v[0]);
  if (k->t1 == k->t0) return lag_app_no_span(app);
  printf("span %.17g\n", k->t1 - k->t0);
  return 0;
}

static int prepare_others(Trial *k) {
  int rc = 0;
  lag_app_options(k->method, lag_sim_options(k->v[0].sim), 1, k->options);
  for (int i = 1; i < k->nscenes && rc == 0; i++) {
    rc = make(k, i);
    if (rc == 0) copy_start(k->v[0].sim, k->app->sim);
    rc = rc ? rc : set_method(k, k->app->sim, k->tol);
    adopt_simulation(k, &k->v[i]);
  }
  return rc;
}

/* ---- Measurements */

/* Numerical error of the first scene: its difference from a run with tolerance/100 or half the step; at the smallest
 * tolerance from a run with 10 times the tolerance. */
static int measure_error(Trial *k) {
  App *app = k->app;
  const double least = 1e-15;
  double error = 0, tol = k->tol > 10 * least ? fmax(k->tol / 100, least) : 10 * k->tol;
  int rc = make(k, 0);
  lag_app_options(k->method, lag_sim_options(k->v[0].sim), 0.5, k->options);
  rc = rc ? rc : set_method(k, app->sim, tol);
  adopt_simulation(k, &k->finer);
  if (rc == 0 && lag_variant_run(&k->finer, k->t0, k->t1) < 0) {
    printf("error nan\n");
    return 0;
  }
  rc = rc ? rc : lag_variant_difference(&k->v[0], &k->finer, &error) ? lag_app_error(&app->args, "out of memory") : 0;
  printf("error %.17g\n", error);
  return rc;
}

/* Whether each of `words` is among `those`, two lists with spaces. */
static int all_among(const char *words, const char *those) {
  for (const char *s = words; *s; s += strspn(s, " ")) {
    size_t n = strcspn(s, " ");
    if (!lag_app_has_word(those, s, n)) return 0;
    s += n;
  }
  return 1;
}

static int has_all_coordinates(const lag_model *m, const lag_model *other) {
  int all = 1;
  for (int i = 0; i < other->nq; i++) all &= lag_component_index(m, other->q[i].name) >= 0;
  for (int i = 0; i < other->nz; i++) all &= lag_component_index(m, other->z[i].name) >= 0;
  return all;
}

/* v->weight := the change of the accelerations by the effects in which the variant differs. */
static int weigh(Variant *scene, Variant *v) {
  const lag_model *m = scene->sim->scene->model, *other = v->sim->scene->model;
  const Variant *with = all_among(other->effects, m->effects) ? scene : v;
  const Variant *along = has_all_coordinates(m, other) ? scene : v;
  v->weight = NAN;
  return along->why[0] ? 0 : lag_variant_weight(along, with, with == scene ? v : scene, &v->weight);
}

static int measure(Trial *k) {
  const Args *a = &k->app->args;
  int all = strcmp(a->effects, "runs") != 0, n = k->nscenes, rc;
  if (lag_variant_run(&k->v[0], k->t0, k->t1) < 0) {
    return lag_app_no_result(a, "%s", k->v[0].why);
  }
  if (all && (rc = measure_error(k)) != 0) return rc;
  for (int i = 1, bad = 0; i < n; i++) {
    if (lag_variant_run(&k->v[i], k->t0, k->t1) < 0) k->v[i].difference = HUGE_VAL;
    else bad = lag_variant_difference(&k->v[0], &k->v[i], &k->v[i].difference);
    if (bad || (all && weigh(&k->v[0], &k->v[i]))) return lag_app_error(a, "out of memory");
  }
  return all && lag_variants_time(k->v, n) ? lag_app_error(a, "out of memory") : 0;
}

static void print(const Trial *k) {
  for (int i = 0; i < k->nscenes; i++) {
    const Variant *v = &k->v[i];
    printf("variant %d %d %.9g %.17g %.9g\n", i, k->app->program->scenes[i]->model->ops, v->time, v->difference,
           v->weight);
    if (v->why[0]) printf("failed %d %s\n", i, v->why);
  }
}

/* ---- Budget: the error of a variant is measured against the first scene, effects that are left out included */

typedef struct VariantSource {
  Trial *k;
  int scene;
} VariantSource;

static lag_sim *fresh_variant(void *source) {
  const VariantSource *s = source;
  App *app = s->k->app;
  int rc = make(s->k, s->scene);
  if (rc == 0) copy_start(s->k->v[0].sim, app->sim);
  lag_sim *sim = rc ? NULL : app->sim;
  if (rc) lag_sim_free(app->sim);
  app->sim = NULL;
  return sim;
}

/* own := the reference's values of the components that the variant has. LAG_OK, LAG_ENOMEM, or LAG_EINVAL: the scene
 * lacks one. */
static int take_components(const Cost *c, const lag_model *m, lag_sim *sim, Cost *own) {
  const Samples *all = &c->reference;
  int n = sim->pb.n, rc = lag_cost_begin(own, all->rows, n, 0, 0);
  for (int k = 0; k < n && rc == LAG_OK; k++) {
    int at = lag_component_index(m, lag_state_column(sim, k).name);
    if (at < 0) rc = LAG_EINVAL;
    own->reference.largest[k] = at < 0 ? 0 : all->largest[at];
    for (int i = 0; i < all->rows && rc == LAG_OK; i++)
      own->reference.y[(size_t)i * (size_t)n + (size_t)k] = all->y[(size_t)i * (size_t)all->n + (size_t)at];
  }
  if (rc) return rc;
  memcpy(own->reference.t, all->t, (size_t)all->rows * sizeof *all->t);
  own->reference.uncertainty = all->uncertainty;
  return lag_cost_scales(&own->reference, sim, own->scale);
}

static void print_setting(int variant, const Cost *c, double target) {
  const CostRun *run;
  const CostMethod *m = lag_cost_cheapest(c->method, c->nmethods, target, &run);
  if (m)
    printf("setting %d %.9g %.9g %s %s %.9g\n", variant, run->error, run->time, m->name, lag_cost_knob(m->method),
           run->knob);
  else printf("none %d %.9g\n", variant, lag_cost_smallest_error(c->method, c->nmethods));
}

static int note_nothing(void *context, const CostMethod *m, double part) {
  (void)context, (void)m, (void)part;
  return lag_app_interrupted() != EXIT_SIGNAL;
}

/* Sweeps over the settings of one variant. */
static int weigh_variant(Trial *k, const Cost *c, int scene, double seconds, double target) {
  App *app = k->app;
  Cost own = {0};
  VariantSource source = {k, scene};
  lag_sim *sim = fresh_variant(&source);
  int rc = sim ? take_components(c, k->v[0].sim->scene->model, sim, &own) : LAG_ENOMEM;
  rc = rc == LAG_EINVAL ? LAG_EINVAL
       : rc             ? lag_app_error(&app->args, "out of memory")
                        : lag_cost_list_methods(app, &own);
  if (rc == 0) {
    CostSweep sweep = {.method = own.method,
                       .n = own.nmethods, .scene = {fresh_variant, &source, k->t0}, .reference = &own.reference,
                       .scale = own.scale, .seconds = seconds, .target = target,
                       .note = note_nothing};
    rc = lag_cost_sweep(&sweep) ? lag_app_error(&app->args, "out of memory") : 0;
  }
  if (rc == 0) print_setting(scene, &own, target);
  lag_sim_free(sim);
  lag_cost_end(&own);
  return rc == LAG_EINVAL ? 0 : rc;
}

static int weigh_budget(Trial *k) {
  App *app = k->app;
  const Args *a = &app->args;
  Cost cost = {.reached = NAN};
  double seconds, target;
  int limited;
  const double before = 0.95; /* of a run that an event ends: other sets of effects end it at other times */
  if (!lag_args_number(a, "--seconds", a->seconds, "--seconds 10", &seconds) ||
      !lag_args_number(a, "--target", a->target, "--target 1e-6", &target))
    return EXIT_USAGE;
  if (target < 10 * DBL_EPSILON) { /* below what this precision can show */
    for (int i = 0; i < k->nscenes; i++) printf("none %d nan\n", i);
    return 0;
  }
  cost.target = target;
  lag_app_catch_interrupt();
  app->scene = app->program->scenes[0];
  app->sim = k->v[0].sim;
  app->until = k->t1;
  cost.event = lag_cost_event_end(app);
  double span = cost.event == k->t1 ? k->t1 - k->t0 : before * (cost.event - k->t0);
  int rc = lag_cost_begin(&cost, LAG_COST_ROWS, app->sim->pb.n, k->t0, span)
               ? lag_app_error(a, "out of memory")
               : lag_cost_reference(app, &cost, 0.4 * seconds, &limited);
  app->sim = NULL;
  if (rc == 0 && cost.reference.rows < 2)
    rc = lag_app_error(a,
                       "no digit of %g is left at t = %g s, the first time of comparison; end the run earlier: --until",
                       target, cost.reference.t[1]);
  if (rc == 0)
    printf("reference %.9g %.17g %d %s\n", cost.reference.uncertainty, cost.reference.t[cost.reference.rows - 1],
           cost.event != k->t1, cost.reference_name);
  for (int i = 0; i < k->nscenes && rc == 0 && lag_app_interrupted() == EXIT_SIGNAL; i++)
    rc = weigh_variant(k, &cost, i, 0.6 * seconds / k->nscenes, target);
  lag_cost_end(&cost);
  return rc;
}

int lag_app_effects(App *app) {
  Trial k = {.app = app, .nscenes = app->program->nscenes};
  k.v = calloc((size_t)k.nscenes + 1, sizeof *k.v);
  int rc = k.v ? prepare_first(&k) : lag_app_error(&app->args, "out of memory");
  if (rc == 0 && strcmp(app->args.effects, "budget") == 0) {
    rc = weigh_budget(&k);
  } else {
    rc = rc ? rc : prepare_others(&k);
    rc = rc ? rc : measure(&k);
    if (rc == 0) print(&k);
  }
  for (int i = 0; k.v && i < k.nscenes; i++) lag_variant_free(&k.v[i]);
  lag_variant_free(&k.finer);
  free(k.v);
  return rc || lag_app_interrupted() == EXIT_SIGNAL ? rc : lag_app_interrupted();
}
