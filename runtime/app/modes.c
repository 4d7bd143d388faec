/* --modes: the equilibrium near the start, its stability, and its normal modes. Enters: a simulation at its start;
 * leaves: a table, or one JSON object. */
#include "app/modes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const lag_var *lag_modes_variable(const lag_model *m, int i)
{
  return i < m->nq ? &m->q[i] : &m->z[i - m->nq];
}

void lag_modes_unknowns(const Equilibrium *r, double *x)
{
  int nq = r->sim->pb.nq;

  for (int i = 0; i < r->n; i++) {
    x[i] = r->y[i < nq ? i : nq + i];
  }
}

/* ---- Refusals */

/* Name of the first input that changes in time; NULL: none. */
static const char *changing_input(const App *app)
{
  lag_problem *pb = &app->sim->pb;
  const lag_model *m = pb->model;
  static const double times[] = {0, 0.1234567, 0.5772157, 2.7182818};
  double first[64];

  for (size_t k = 0; k < sizeof times / sizeof *times; k++) {
    if (lag_inputs(pb, app->scene->t0 + times[k])) {
      return NULL;
    }
    for (int i = 0; i < m->nu && i < 64; i++) {
      if (k > 0 && pb->u[i] != first[i]) {
        return m->u[i].name;
      }
      first[i] = k > 0 ? first[i] : pb->u[i];
    }
  }
  return NULL;
}

/* EXIT_USAGE after a message where this simulator or model has no modes; else 0. */
static int refuse(const App *app)
{
  const lag_model *m = app->scene->model;
  const Args *a = &app->args;
  const char *source = app->program->source;

  if (!app->extras.algebra) {
    return lag_app_error(a, "this simulator was built without GSL, which finds roots and eigenvalues; install GSL (libgsl-dev), make "
                        "lagc anew, and leave out --no-gsl");
  }
  if (m->constraints) {
    return lag_app_error(a, "modes with %s are not computed yet (%s): %s", m->ncontacts ? "contacts" : "constraints", m->constraints->of[0].name,
                     m->ncontacts ? "take a model without them" : "describe the model by coordinates that need no constraints, such as angles");
  }
  if (!m->linear) {
    return lag_app_error(a, "this simulator was built without the model's linearisation; write lagc modes %s, or build it with: lagc "
                        "build %s --with linear", source, source);
  }
  if (m->nq + m->nz == 0) {
    return lag_app_error(a, "model %s has neither coordinates nor states", m->name);
  }
  if (m->flags & LAG_AUTONOMOUS) {
    return 0;
  }
  if (!(m->flags & LAG_TIMELESS)) {
    return lag_app_error(a, "scene %s depends on time: t stands in its equations, so nothing stays at rest; take a scene without "
                        "what drives it, or put a parameter in place of t", app->scene->name);
  }
  const char *input = changing_input(app);
  return input ? lag_app_error(a, "scene %s depends on time by its input %s, so nothing stays at rest; hold it: %s=0", app->scene->name,
                           input, input)
               : 0;
}

/* ---- Caution and reason of a result */

const char *lag_modes_caution(const App *app, const Equilibrium *r)
{
  if (r->pole) {
    return "the mass matrix is nearly singular here: a coordinate has lost its meaning";
  }
  if (!(app->scene->model->flags & LAG_SMOOTH)) {
    return "the model has if, abs, sign, min, max or roots: where they switch at the equilibrium, the modes are those of one side";
  }
  return NULL;
}

void lag_modes_reason(const Modes *s, char *text, size_t n)
{
  const Mode *m = s->mode;
  int last = s->n - 1;

  switch (s->verdict) {
  case LAG_UNSTABLE: {
    double rate = 0;
    int at = 0;
    for (int i = 0; i < s->n; i++) {
      if (m[i].re > rate) {
        rate = m[i].re;
        at = i;
      }
    }
    snprintf(text, n, "mode %d grows by a factor of e in %.6g s", at + 1, 1 / rate);
    return;
  }
  case LAG_DECAYS: {
    double slowest = m[last].re;
    for (int i = 0; i < s->n; i++) {
      slowest = fmax(slowest, m[i].re);
    }
    snprintf(text, n, "every mode decays, the slowest by a factor of e in %.6g s", -1 / slowest);
    return;
  }
  case LAG_MINIMUM:
    snprintf(text, n, "the energy, which is conserved, has a minimum here (Lagrange, Dirichlet)");
    return;
  case LAG_DISSIPATIVE_MINIMUM:
    snprintf(text, n, "the energy, less the work of constant forces, has a minimum here, and nothing raises it (Lagrange, Dirichlet, Kelvin)");
    return;
  case LAG_NEUTRAL:
    snprintf(text, n, "no force along the zero modes%s%s", s->drifts ? ", so a push causes an endless drift" : "",
             m[last].re == 0.0 && m[last].im == 0.0              ? "; there are no others"
             : s->lowering == 0 && s->pairs ? "; the energy has a minimum in all other directions"
                                            : "; all other modes decay");
    return;
  case LAG_GYROSCOPIC:
    snprintf(text, n, "all modes oscillate, but the energy falls in %d direction%s: forces at right angles to the motion alone hold "
                      "it, and damping in all directions would make it unstable (Thomson, Tait, Chetaev)",
             s->lowering, s->lowering == 1 ? "" : "s");
    return;
  case LAG_DEGENERATE:
    snprintf(text, n, "a zero mode: the linearisation has no force along it, so it does not decide stability");
    return;
  case LAG_FREE_SEPARATELY:
    snprintf(text, n, "no force along each zero mode alone, but along some together, so the linearisation does not decide stability");
    return;
  case LAG_COORDINATE_POLE:
    snprintf(text, n, "a coordinate has lost its meaning here, as a longitude does at a pole; these are the modes of the others, and "
                      "coordinates without a pole here would show all");
    return;
  case LAG_NONSMOOTH:
    snprintf(text, n, "the forces' derivatives jump here, or have no limit, so that no motion is small enough to be linear");
    return;
  case LAG_DEFECTIVE:
    snprintf(text, n, "a multiple frequency with too few shapes: small motion grows in proportion to time, until the "
                      "nonlinear terms matter");
    return;
  case LAG_CENTRE:
    snprintf(text, n, "some modes neither grow nor decay, and no energy is known that is conserved and has a minimum here");
    return;
  }
}

/* ---- JSON */

/* A JSON object of a state in declared units; with im a mode shape, entries [re, im]. */
static void json_vector(Json *j, const char *name, const lag_model *m, const double *re, const double *im)
{
  lag_json_begin(j, name, '{');
  for (int i = 0; i < m->nq + m->nz; i++) {
    const lag_var *v = lag_modes_variable(m, i);
    if (im) {
      lag_json_begin(j, v->name, '[');
      lag_json_number(j, NULL, re[i] / v->factor);
      lag_json_number(j, NULL, im[i] / v->factor);
      lag_json_end(j, ']');
    } else {
      lag_json_number(j, v->name, (re[i] - v->offset) / v->factor);
    }
  }
  lag_json_end(j, '}');
}

static void json_head(Json *j, const App *app, const char *status)
{
  lag_json_begin(j, NULL, '{');
  lag_json_string(j, "model", app->scene->model->name);
  lag_json_string(j, "scene", app->scene->name);
  lag_json_string(j, "status", status);
}

static void json_modes(FILE *f, const App *app, const Equilibrium *r, const Modes *s, double *x)
{
  const lag_model *m = app->scene->model;
  char text[300];
  Json j = {.f = f};

  lag_modes_reason(s, text, sizeof text);
  json_head(&j, app, "ok");
  lag_json_string(&j, "verdict", lag_verdict_name(s->verdict));
  lag_json_string(&j, "reason", text);
  lag_json_string(&j, "note", lag_modes_caution(app, r));
  lag_json_count(&j, "steps", r->steps);
  json_vector(&j, "start", m, r->start, NULL);
  lag_modes_unknowns(r, x);
  json_vector(&j, "equilibrium", m, x, NULL);
  lag_json_truth(&j, "pairs", s->pairs != 0);
  lag_json_begin(&j, "modes", '[');
  for (int i = 0; i < s->n; i++) {
    const Mode *k = &s->mode[i];
    lag_json_begin(&j, NULL, '{');
    lag_json_number(&j, "re", k->re);
    lag_json_number(&j, "im", k->im);
    lag_json_truth(&j, "free", k->free != 0);
    lag_json_count(&j, "repeats", k->repeats);
    json_vector(&j, "shape", m, k->shape_re, k->shape_im);
    lag_json_end(&j, '}');
  }
  lag_json_end(&j, ']');
  lag_json_end(&j, '}');
  putc('\n', f);
}

/* ---- The command */

static int not_found(const App *app, const Equilibrium *r)
{
  const lag_model *m = app->scene->model;
  int i = r->worst, nq = m->nq, at = nq + i;
  const lag_var *v = lag_modes_variable(m, i);
  char unit[80] = "";

  if (v->unit[0]) {
    snprintf(unit, sizeof unit, " %s/s%s", v->unit, i < nq ? "^2" : "");
  }
  if (app->args.json) {
    Json j = {.f = stdout};
    json_head(&j, app, "no equilibrium");
    lag_json_end(&j, '}');
    putchar('\n');
  }
  if (r->away) {
    lag_app_error(&app->args, "no equilibrium found from the start of scene %s: forces only vanish at infinity. Where the model has one, start near it: %s=VALUE",
              app->scene->name, v->name);
    return EXIT_RUN;
  }
  lag_app_error(&app->args, "no equilibrium found in %d steps from the start of scene %s: at %s = %.6g%s%s, %s%s is still %.6g%s%s. A force "
                        "that vanishes nowhere has none: add a force that balances it, such as a spring; where it vanishes, start near there: %s=VALUE", r->steps, app->scene->name, v->name, (r->y[i < nq ? i : at] - v->offset) / v->factor,
            v->unit[0] ? " " : "", v->unit, v->name, i < nq ? "''" : "'", r->rate[at] / v->factor, unit,
            r->pole ? "; the mass matrix is nearly singular there: other coordinates may help" : "", v->name);
  return EXIT_RUN;
}

/* Message for a failure of the analysis; returns the exit status. */
static int analysis_failed(const App *app, int rc, const char *where)
{
  const Args *a = &app->args;

  if (rc == LAG_ENOMEM) {
    return lag_app_error(a, "out of memory");
  }
  if (rc == LAG_ESINGULAR) {
    lag_app_error(a, "the %s is singular %s: choose other coordinates there, or another start: name=VALUE",
              app->scene->model->flags & LAG_FIRST_ORDER ? "two-form of L" : "mass matrix", where);
  } else {
    lag_app_error(a, "%s %s; another start: name=VALUE", rc == LAG_EMETHOD ? "the eigenvalues do not converge" : "the model has no values", where);
  }
  return EXIT_RUN;
}

static int analyse(const App *app, Equilibrium *r, Modes *s)
{
  int rc = lag_equilibrium_find(r, app->sim, app->extras.algebra);

  if (rc == 0) {
    return not_found(app, r);
  }
  if (rc < 0) {
    return analysis_failed(app, rc, "at the start");
  }
  rc = lag_modes_find(s, r, app->extras.algebra);
  double *x = rc ? NULL : lag_pool_doubles(&s->pool, (size_t)r->n);
  if (rc || !x) {
    return analysis_failed(app, rc ? rc : LAG_ENOMEM, "at the equilibrium");
  }
  if (app->args.json) {
    json_modes(stdout, app, r, s, x);
  } else {
    lag_modes_text(stdout, app, r, s, x);
  }
  return fflush(stdout) ? lag_app_error(&app->args, "cannot write standard output") : EXIT_FINE;
}

int lag_app_modes(App *app)
{
  Equilibrium rest = {0};
  Modes modes = {0};
  int rc = lag_app_set_up_start(app);

  if (rc == 0 && lag_sim_advance(app->sim, app->scene->t0)) {
    rc = lag_app_error(&app->args, "%s", lag_sim_message(app->sim));
  }
  rc = rc ? rc : refuse(app);
  rc = rc ? rc : analyse(app, &rest, &modes);
  lag_modes_free(&modes);
  lag_equilibrium_free(&rest);
  return rc;
}
