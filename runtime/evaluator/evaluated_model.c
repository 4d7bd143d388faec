/* Functions of lag_model.h that execute programs. Values lie in w, the caller's own; functions without w have a frame
 * on the stack, or a large one from malloc. */
#include "evaluator/evaluated_model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define IN const double *const in[PROGRAM_ARRAY_COUNT] = {&t, q, v, z, p, u}

/* The programs behind self. Users copy models and scenes; their parts stay where they are. */
static const EvaluatedModel *model_of(const void *self) { return ((const lag_model *)self)->programs; }
static const EvaluatedScene *scene_of(const void *self) { return ((const lag_scene *)self)->programs; }
static const EvaluatedConstraints *constraints_of(const void *self) { return self; }
static const EvaluatedFamily *family_of(const void *self) { return ((const lag_contact_family *)self)->programs; }
static const EvaluatedFamilies *families_of(const void *self) { return self; }
static const EvaluatedCharges *charges_of(const void *self) { return self; }
static const EvaluatedKepler *kepler_of(const void *self) { return self; }
static const EvaluatedLinear *linear_of(const void *self) { return self; }
static const EvaluatedPartials *partials_of(const void *self) { return self; }
static const EvaluatedAction *action_of(const void *self) { return self; }

/* FUNCTION(name, the structure, its member): a function with one array out. */
#define FUNCTION(name, of, member)                                    \
  static int name(LAG_STATE, double *x, double *w) {                  \
    IN;                                                               \
    return lag_run_program(of(self)->member, in, (double *[]){x}, w); \
  }

FUNCTION(energy, model_of, energy)
FUNCTION(events, model_of, events)
FUNCTION(size_values, model_of, sizes)
FUNCTION(moving_sizes, model_of, moving_sizes)
FUNCTION(switch_values, model_of, switch_values)
FUNCTION(switch_rates, model_of, switch_rates)
FUNCTION(switch_grips, model_of, switch_grips)
FUNCTION(contact_laws, model_of, contact_laws)
FUNCTION(member_values, family_of, values)
FUNCTION(reach, family_of, reach)
FUNCTION(family_inertia, families_of, inertia)
FUNCTION(charge_values, charges_of, values)
FUNCTION(kepler_values, kepler_of, values)
FUNCTION(charge_powers, charges_of, powers)
FUNCTION(jumps, linear_of, jumps)
FUNCTION(curve, action_of, of)
FUNCTION(momenta, action_of, momenta)

/* The same with two arrays out, and with g between. */
#define FUNCTION_2(name, of, member)                                     \
  static int name(LAG_STATE, double *x, double *y, double *w) {          \
    IN;                                                                  \
    return lag_run_program(of(self)->member, in, (double *[]){x, y}, w); \
  }
/* With one more array, g or accelerations. */
#define FUNCTION_WITH(name, of, member, array)                                       \
  static int name(LAG_STATE, const double *more, double *x, double *y, double *w) {    \
    const double *const in[PROGRAM_ARRAY_COUNT] = {&t, q, v, z, p, u, [array] = more}; \
    return lag_run_program(of(self)->member, in, (double *[]){x, y}, w);             \
  }

FUNCTION_2(accel, model_of, accel)
FUNCTION_2(residuals, constraints_of, residuals)
FUNCTION_2(matrices, constraints_of, matrices)
FUNCTION_WITH(position, constraints_of, position, PROGRAM_G)
FUNCTION_WITH(velocity, constraints_of, velocity, PROGRAM_G)

/* Methods that call these two refuse models with states, and give no z. */
static int variation(LAG_STATE, double *Lq, double *Lv, double *Q, double *w) {
  IN;
  if (!z && model_of(self)->model.nz) return LAG_ERETRY;
  return lag_run_program(model_of(self)->variation, in, (double *[]){Lq, Lv, Q}, w);
}

static int second(LAG_STATE, double *h, double *w) {
  IN;
  if (!z && model_of(self)->model.nz) return LAG_ERETRY;
  return lag_run_program(model_of(self)->second, in, (double *[]){h}, w);
}

FUNCTION_WITH(linearise, linear_of, eval, PROGRAM_A)
FUNCTION_WITH(partials, partials_of, eval, PROGRAM_A)

static int inverse(LAG_STATE, const double *a, double *force, double *w) {
  const double *const in[PROGRAM_ARRAY_COUNT] = {&t, q, v, z, p, u, [PROGRAM_A] = a};
  return lag_run_program(model_of(self)->inverse, in, (double *[]){force}, w);
}

static int guide_loads(LAG_STATE, const double *g, double *d, double *force, double *load, double *w) {
  const double *const in[PROGRAM_ARRAY_COUNT] = {&t, q, v, z, p, u, [PROGRAM_G] = g};
  return lag_run_program(model_of(self)->guide_loads, in, (double *[]){d, force, load}, w);
}

static int adjoint(LAG_STATE, const double *a, const double *g, double *by_y, double *by_up, double *d, double *w) {
  const double *const in[PROGRAM_ARRAY_COUNT] = {&t, q, v, z, p, u, [PROGRAM_A] = a, [PROGRAM_G] = g};
  const EvaluatedAdjoint *of = self;
  return lag_run_program(of->eval, in, (double *[]){by_y, by_up, d}, w);
}

static int adjoint_rates(LAG_STATE, double *a, double *zd, double *l, double *w) {
  const double *const in[PROGRAM_ARRAY_COUNT] = {&t, q, v, z, p, u};
  const EvaluatedAdjoint *of = self;
  return lag_run_program(of->rates, in, (double *[]){a, zd, l}, w);
}

static int adjoint_project(LAG_STATE, const double *x, double *by_y, double *by_up, double *d, double *w) {
  const double *const in[PROGRAM_ARRAY_COUNT] = {&t, q, v, z, p, u, [PROGRAM_G] = x};
  const EvaluatedAdjoint *of = self;
  return lag_run_program(of->project, in, (double *[]){by_y, by_up, d}, w);
}

/* --- functions without w --- */

/* Executes a program in memory of its own; without memory as if a value left its domain. */
static int run_alone(const Program *p, const double *const *in, double *const *out) {
  enum { ROOM = 512 };
  double room[ROOM], *frame = p->frame <= ROOM ? room : malloc(p->frame * sizeof *frame);
  int rc = frame ? lag_run_program(p, in, out, frame) : LAG_ERETRY;
  if (frame != room) free(frame);
  return rc;
}

static void derive(const void *self, double *p) {
  const double *const in[PROGRAM_ARRAY_COUNT] = {[PROGRAM_P] = p};
  const EvaluatedModel *m = model_of(self);
  if (run_alone(m->derive, in, (double *[]){p}) == LAG_OK) return;
  for (int i = 0; i < m->model.nderived; i++) p[m->model.np + i] = NAN;
}

static int inputs(const void *self, double t, const double *p, double *u) {
  const double *const in[PROGRAM_ARRAY_COUNT] = {&t, [PROGRAM_P] = p};
  return run_alone(model_of(self)->inputs, in, (double *[]){u});
}

static void params(const void *self, double *p, const unsigned char *fixed) {
  const EvaluatedScene *s = scene_of(self);
  const double *const in[PROGRAM_ARRAY_COUNT] = {[PROGRAM_P] = p};
  double *value = malloc(((size_t)s->of->model.np + 1) * sizeof *value);
  for (int k = 0, i = 0; k < s->nparams; k++) {
    const EvaluatedParams *x = &s->params[k];
    int failed = !value || !x->values || run_alone(x->values, in, (double *[]){value}) != LAG_OK;
    for (int end = i + x->n; i < end; i++)
      if (!fixed[i]) p[i] = failed ? NAN : value[i];
  }
  free(value);
  if (s->of->derive) derive(&s->of->model, p);
}

static void start(const void *self, const double *p, double *q, double *v, double *z) {
  const EvaluatedScene *s = scene_of(self);
  const double *const in[PROGRAM_ARRAY_COUNT] = {[PROGRAM_P] = p};
  for (int i = 0; i < s->of->model.nq; i++) q[i] = v[i] = 0;
  for (int i = 0; i < s->of->model.nz; i++) z[i] = 0;
  if (s->start) run_alone(s->start, in, (double *[]){q, v, z});
}

static int exact(LAG_STATE, double *out) {
  IN;
  return run_alone(scene_of(self)->exact, in, (double *[]){out});
}

/* --- events and outputs --- */

/* Newton's law of impact for the contact whose constraint is `row`, which its input closes. w: g, u, the frame. */
static int strike(const EvaluatedModel *m, const EvaluatedEvent *e, const double *const *state, double *v1, double *w) {
  const double *in[PROGRAM_ARRAY_COUNT];
  double *g = w, *u = w + m->nconstraints;
  memcpy(in, state, sizeof in);
  for (int i = 0; i < m->nconstraints; i++) g[i] = 0;
  for (int i = 0; i < m->model.nu; i++) u[i] = state[PROGRAM_U][i];
  g[e->constraint] = u[e->input] = 1;
  in[PROGRAM_G] = g, in[PROGRAM_U] = u;
  return lag_run_program(m->impact, in, (double *[]){v1}, u + m->model.nu);
}

static int act(const void *self, int k, double t, const double *q, const double *v, const double *z, const double *p,
               const double *u, double *q1, double *v1, double *z1, int *stop, double *w) {
  IN;
  const EvaluatedModel *m = model_of(self);
  if (k < 0 || k >= m->model.nev) return LAG_OK;
  const EvaluatedEvent *e = &m->event[k];
  if (e->strikes) return strike(m, e, in, v1, w);
  if (e->stop) *stop = 1;
  return e->action ? lag_run_program(e->action, in, (double *[]){q1, v1, z1}, w) : LAG_OK;
}

static int observe(LAG_STATE, double *out, double *w) {
  const EvaluatedScene *s = scene_of(self);
  int n = s->nrow, ny = 2 * s->of->model.nq + s->of->model.nz;
  if (s->nactions) { /* w: inputs and action variables, a state, the frame */
    double *with = w, *y = with + n + s->nactions, *rest = y + ny;
    for (int i = 0; i < n; i++) with[i] = u[i];
    for (int i = 0; i < s->nactions; i++) with[n + i] = lag_action(&s->action[i].curve, t, q, v, z, p, u, y, rest);
    u = with, w = rest;
  }
  IN;
  return lag_run_program(s->observe, in, (double *[]){out}, w);
}

/* --- tables of functions --- */

void lag_set_model_functions(EvaluatedModel *m) {
  lag_model *f = &m->model;
  f->programs = m;
  if (m->derive) f->derive = derive;
  if (m->inputs) f->inputs = inputs;
  f->accel = accel;
  if (m->energy) f->energy = energy;
  if (m->events) f->events = events, f->act = act;
  if (m->sizes) f->size_values = size_values;
  if (m->moving_sizes) f->moving_sizes = moving_sizes;
  if (m->variation) f->variation = variation;
  if (m->second) f->second = second;
  if (m->inverse) f->inverse = inverse;
  if (m->switch_values) f->switch_values = switch_values;
  if (m->switch_rates) f->switch_rates = switch_rates;
  if (m->switch_grips) f->switch_grips = switch_grips;
  if (m->contact_laws) f->contact_laws = contact_laws;
  if (m->guide_loads) f->guide_loads = guide_loads;
}

void lag_set_scene_functions(EvaluatedScene *s) {
  s->scene.programs = s;
  s->scene.params = params;
  s->scene.start = start;
  s->scene.observe = observe;
  if (s->exact) s->scene.exact = exact;
}

void lag_set_constraint_functions(EvaluatedConstraints *c) {
  lag_constraints *f = &c->constraints;
  f->residuals = residuals, f->matrices = matrices, f->velocity = velocity;
  if (c->position) f->position = position;
}

void lag_set_family_functions(EvaluatedFamilies *f, lag_contact_family *of) {
  for (int i = 0; i < f->families.n; i++) {
    of[i].programs = &f->of[i];
    of[i].values = member_values;
    if (f->of[i].reach) of[i].reach = reach;
  }
  f->families.of = of;
  f->families.inertia = family_inertia;
}

void lag_set_charge_functions(EvaluatedCharges *c) {
  if (c->values) c->charges.values = charge_values;
  if (c->powers) c->charges.powers = charge_powers;
}

void lag_set_kepler_functions(EvaluatedKepler *k) { k->kepler.values = kepler_values; }

void lag_set_linear_functions(EvaluatedLinear *l) {
  l->linear.eval = linearise;
  if (l->jumps) l->linear.jumps = jumps;
}

void lag_set_partial_functions(EvaluatedPartials *p) { p->partials.eval = partials; }

void lag_set_adjoint_functions(EvaluatedAdjoint *a) {
  a->adjoint.eval = adjoint;
  if (a->rates) a->adjoint.rates = adjoint_rates, a->adjoint.project = adjoint_project;
}

void lag_set_action_functions(EvaluatedAction *a) {
  a->curve.curve = curve;
  if (a->momenta) a->curve.momenta = momenta;
}

static void widen(size_t *room, const Program *p, size_t more) {
  if (p && p->frame + more > *room) *room = p->frame + more;
}

size_t lag_model_room(const EvaluatedModel *m) {
  const Program *const all[] = {m->accel,        m->energy,       m->events,      m->sizes,
                                m->moving_sizes, m->variation,    m->second,      m->switch_values,
                                m->switch_rates, m->switch_grips, m->contact_laws, m->guide_loads,
                                m->inverse};
  size_t room = 0;
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) widen(&room, all[i], 0);
  for (int k = 0; k < m->model.nev; k++) widen(&room, m->event[k].action, 0);
  widen(&room, m->impact, (size_t)(m->nconstraints + m->model.nu));
  const EvaluatedConstraints *c = (const void *)m->model.constraints;
  const EvaluatedCharges *q = (const void *)m->model.charges;
  const EvaluatedLinear *l = (const void *)m->model.linear;
  if (c)
    widen(&room, c->residuals, 0), widen(&room, c->matrices, 0), widen(&room, c->position, 0),
        widen(&room, c->velocity, 0);
  const EvaluatedFamilies *f = (const void *)m->model.families;
  for (int i = 0; f && i < f->families.n; i++) widen(&room, f->of[i].values, 0), widen(&room, f->of[i].reach, 0);
  if (f) widen(&room, f->inertia, 0);
  const EvaluatedKepler *k = (const void *)m->model.kepler;
  if (k) widen(&room, k->values, 0);
  if (q) widen(&room, q->values, 0), widen(&room, q->powers, 0);
  if (l) widen(&room, l->eval, 0), widen(&room, l->jumps, 0);
  const EvaluatedPartials *by_params = (const void *)(l ? l->linear.by_params : NULL),
                          *by_inputs = (const void *)(l ? l->linear.by_inputs : NULL);
  if (by_params) widen(&room, by_params->eval, 0);
  if (by_inputs) widen(&room, by_inputs->eval, 0);
  const EvaluatedAdjoint *of = (const void *)(l ? l->linear.adjoint : c ? c->constraints.adjoint : NULL);
  if (of) widen(&room, of->eval, 0), widen(&room, of->rates, 0), widen(&room, of->project, 0);
  return room;
}

size_t lag_scene_room(const EvaluatedScene *s) {
  size_t room = 0, more = s->nactions ? (size_t)(s->nrow + s->nactions + 2 * s->of->model.nq + s->of->model.nz) : 0;
  widen(&room, s->observe, more);
  for (int i = 0; i < s->nactions; i++) widen(&room, s->action[i].of, more), widen(&room, s->action[i].momenta, more);
  return room;
}
