/* States for the self-check: random parameters, coordinates and inputs, projected on the model's constraints by
 * Newton's method; the programs' accelerations and multipliers there, with their sensitivity to rounding. */
#include <math.h>

#include "base/tolerance.h"
#include "lower/lower.h"
#include "self_check/self_check_impl.h"

/* --- random numbers: splitmix64, the same on every machine (G. Steele, D. Lea, C. Flood, OOPSLA 2014,
 * doi:10.1145/2660193.2660195) --- */

static Real uniform(Check *c) {
  uint64_t x = c->random += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return (Real)((x ^ (x >> 31)) >> 11) / 9007199254740992.0L;
}

Real check_random(Check *c, Real lo, Real hi) { return lo + (hi - lo) * uniform(c); }

/* --- programs --- */

int check_run(const Check *c, const Prog *p, Real *const *out) {
  const Real *in[ARR_COUNT] = {0};
  in[ARR_T] = &c->t;
  in[ARR_Q] = c->q;
  in[ARR_V] = c->v;
  in[ARR_Z] = c->z;
  in[ARR_P] = c->p;
  in[ARR_U] = c->signal;
  in[ARR_A] = c->a;
  in[ARR_G] = c->gap;
  return (c->samples ? prog_eval_sample : prog_eval)(p, in, out) == 0;
}

/* --- states --- */

/* Random value for an independent parameter: the same sign, 0.7 to 1.4 times as large; 0 becomes 0.2 to 0.9 in size. */
static Real other_value(Check *c, const Param *p, Real value) {
  Real factor = check_random(c, 0.7L, 1.4L);
  if (value != 0) return value * factor;
  return p->sign == SIGN_GT || p->sign == SIGN_GE   ? 0.5L * factor
         : p->sign == SIGN_LT || p->sign == SIGN_LE ? -0.5L * factor
                                                    : 0.5L - factor;
}

static int choose_parameters(Check *c) {
  const IrScene *scene = &c->u->scenes.at[c->scene];
  const IrParams *next = scene->params.at;
  for (uint32_t i = 0; i < c->m->params.n; i++) {
    const Param *p = &c->m->params.at[i];
    int is_first = !p->fixed && next < scene->params.at + scene->params.n && p->place == next->first;
    if (is_first && !check_run(c, next++->values, (Real *const[]){c->p})) return 0;
    if (!p->fixed && !(expr_kinds(c->e->g, p->value) & 1u << SYM_PARAM))
      c->p[p->place] = other_value(c, p, c->p[p->place]);
    c->given[i] = p->fixed ? (Real)num_value(p->number) : c->p[p->place];
  }
  return !c->u->derived || check_run(c, c->u->derived, (Real *const[]){c->p});
}

/* Random value within reach * 0.8 of `start` (reach * |start|/2 where |start| > 1); far: of any magnitude up to
 * 1000. */
static Real random_near(Check *c, Real start) {
  Real size = fabsl(start) > 1 ? fabsl(start) / 2 : 0.8L;
  if (c->far) return check_random(c, -1, 1) * powl(10, check_random(c, -1, 3));
  return start + c->reach * size * check_random(c, -1, 1);
}

/* Normalises quaternions, and makes their rates orthogonal to them. */
static void project_rotations(Check *c) {
  const Declarations *b = c->m->declared;
  for (uint32_t i = 0; i < b->rotations.n && !c->m->first_order; i++) {
    Real *q = c->q + b->rotations.at[i], *v = c->v + b->rotations.at[i], square = 0, along = 0;
    for (int k = 0; k < 4; k++) square += q[k] * q[k];
    for (int k = 0; k < 4; k++) q[k] /= sqrtl(square);
    for (int k = 0; k < 4; k++) along += q[k] * v[k];
    for (int k = 0; k < 4; k++) v[k] -= along * q[k];
  }
}

static Real largest(const Real *x, uint32_t n) {
  Real r = 0;
  for (uint32_t i = 0; i < n; i++) r = !(fabsl(x[i]) <= r) ? fabsl(x[i]) : r;
  return r;
}

/* Newton's method onto the constraints, by the program's own projection. 0: no convergence, or contradictory
 * constraints. */
static int project_constraints(Check *c, int velocities) {
  /* no progress after HOPELESS rounds: give up, the next state is nearer to the start */
  enum { ROUNDS = 40, HOPELESS = 6 };
  const IrConstraints *k = &c->u->constraints;
  uint32_t rows = velocities ? k->of.n : k->nkept;
  Real *position = ARENA_ARRAY(c->arena, Real, k->of.n), *rate = ARENA_ARRAY(c->arena, Real, k->of.n);
  Real *change = ARENA_ARRAY(c->arena, Real, c->n), *force = ARENA_ARRAY(c->arena, Real, c->n),
       *of = velocities ? c->v : c->q;
  Real first = 0;
  for (int round = 0; round < ROUNDS; round++) {
    if (!check_run(c, k->residuals, (Real *const[]){position, rate})) return 0;
    for (uint32_t i = 0; i < rows; i++) c->gap[i] = velocities ? -rate[i] : i < k->nholonomic ? -position[i] : 0;
    Real left = largest(c->gap, rows);
    if (round == 0) first = left;
    if (round == HOPELESS && !(left < first)) return 0;
    if (!check_run(c, velocities ? k->velocity : k->position, (Real *const[]){change, force})) return 0;
    for (uint32_t i = 0; i < c->n; i++) of[i] += change[i];
    Real size = 1 + largest(of, c->n);
    if (largest(change, c->n) <= LONG_TOLERANCE(1e-16L) * size)
      return left <= 1e-9L * first + LONG_TOLERANCE(1e-13L) * size;
  }
  return 0;
}

/* side[switches]: values of the switching functions, with the modes of the state itself. */
static int switch_sides(Check *c, Real *side) {
  for (uint32_t i = 0; i < c->u->nmodes; i++) c->signal[c->m->inputs.n + i] = HELD_MOST;
  return !c->u->nmodes || check_run(c, c->u->switch_values, (Real *const[]){side});
}

/* Modes of switches: in every second state those of the state itself, which must give what no mode gives. Refuses a
 * state that constraints hold on the edge of a switch, where rounding decides; free[switches]: values before
 * constraints. */
static int hold_switches(Check *c, int attempt, const Real *free) {
  const ProgramSet *u = c->u;
  Real *mode = c->signal + c->m->inputs.n, *side = ARENA_ARRAY(c->arena, Real, u->switches.n + 1);
  if (!switch_sides(c, side)) return 0;
  for (uint32_t i = 0; i < u->nmodes; i++) {
    if (u->constraints.of.n && fabsl(side[i]) < 1e-9L * fabsl(free[i])) return 0;
    if (attempt % 2) mode[i] = u->switches.at[i].is_floor ? floorl(side[i]) : side[i] < 0 ? -1 : 1;
  }
  return 1;
}

/* free[switches]: see hold_switches. */
static int choose_state(Check *c, int attempt, Real *free) {
  const Model *m = c->m;
  const ProgramSet *u = c->u;
  c->far = attempt % 3 == 2 && c->reach == 1;
  if (!choose_parameters(c)) return 0;
  c->t = u->scenes.at[c->scene].t0 + check_random(c, -0.5L, 2);
  for (uint32_t i = 0; i < m->coords.n; i++) c->q[i] = random_near(c, c->q0[i]);
  for (uint32_t i = 0; i < m->coords.n; i++) c->v[i] = random_near(c, c->v0[i]);
  for (uint32_t i = 0; i < m->states.n; i++) c->z[i] = random_near(c, c->z0[i]);
  for (uint32_t i = 0; i < m->states.n; i++) c->zdd[i] = check_random(c, -1, 1);
  if (!check_run(c, u->inputs, (Real *const[]){c->signal})) return 0;
  for (uint32_t i = 0; i < m->inputs.n; i++) c->signal[i] += check_random(c, -0.5L, 0.5L);
  /* of many contacts, as of pairs, no more than a position can close */
  Real share = u->contacts.n > c->n / 2 ? 0.25L * c->n / u->contacts.n : 0.5L;
  for (uint32_t i = 0; i < u->contacts.n; i++) c->signal[u->contacts.at[i].input] = uniform(c) < share;
  project_rotations(c);
  if (!switch_sides(c, free)) return 0;
  Real before = largest(c->q, c->n);
  if (!u->constraints.of.n) return 1;
  /* refuses collapse to 0 */
  int obeys = project_constraints(c, 0) && project_constraints(c, 1) && largest(c->q, c->n) > 1e-6L * before;
  if (!obeys && !c->far) c->reach /= 16; /* long chains of constraints converge from nearby only */
  return obeys;
}

int check_choose_state(Check *c, int attempt) {
  Real *free = ARENA_ARRAY(c->arena, Real, c->u->switches.n + 1);
  return choose_state(c, attempt, free) && hold_switches(c, attempt, free);
}

static int solve(Check *c, Real *a, Real *zd, Real *lambda) {
  if (!check_run(c, c->u->accel, (Real *const[]){a, zd})) return 0;
  if (!c->multipliers) return 1;
  Real *found = ARENA_ARRAY(c->arena, Real, c->e->constraints.n + 1);
  if (!check_run(c, c->multipliers, (Real *const[]){found})) return 0;
  for (uint32_t k = 0; k < c->e->constraints.n; k++) lambda[c->e->constraints.of[k] - c->m->constraints.at] = found[k];
  return 1;
}

/* error[i] := max(error[i], |x[i] - y[i]|), NaN ignored. */
static void note_difference(Real *error, const Real *x, const Real *y, uint32_t n) {
  for (uint32_t i = 0; i < n; i++) error[i] = fabsl(x[i] - y[i]) > error[i] ? fabsl(x[i] - y[i]) : error[i];
}

/* Sets a_error, zd_error, lambda_error by solving again at states perturbed by a few units in the last place. */
static void bound_rounding(Check *c) {
  enum { DIGITS = 16, TRIES = 2 };
  const Model *m = c->m;
  uint32_t n = c->n, nz = m->states.n, all = 2 * n + nz;
  Real *state = ARENA_ARRAY(c->arena, Real, all + 1), *a = ARENA_ARRAY(c->arena, Real, n + nz + 1),
       *zd = ARENA_ARRAY(c->arena, Real, nz + 1);
  Real *lambda = ARENA_ARRAY(c->arena, Real, m->constraints.n + 1), *const part[] = {c->q, c->v, c->z};
  const uint32_t size[] = {n, n, nz};
  for (uint32_t i = 0; i < n; i++) c->a_error[i] = 0;
  for (uint32_t i = 0; i < nz; i++) c->zd_error[i] = 0;
  for (uint32_t k = 0; k < m->constraints.n; k++) c->lambda_error[k] = 0;
  for (int turn = 0; turn < TRIES; turn++) {
    for (uint32_t p = 0, at = 0; p < 3; p++)
      for (uint32_t i = 0; i < size[p]; i++) {
        state[at++] = part[p][i];
        part[p][i] *= 1 + DIGITS * jet_unit * check_random(c, -1, 1);
      }
    for (uint32_t k = 0; k < m->constraints.n; k++) lambda[k] = c->lambda[k];
    int solved = solve(c, a, zd, lambda);
    for (uint32_t p = 0, at = 0; p < 3; p++)
      for (uint32_t i = 0; i < size[p]; i++) part[p][i] = state[at++];
    if (!solved) continue;
    note_difference(c->a_error, a, c->a, n);
    note_difference(c->zd_error, zd, c->zd, nz);
    note_difference(c->lambda_error, lambda, c->lambda, m->constraints.n);
  }
}

int check_solve(Check *c) { return solve(c, c->a, c->zd, c->lambda); }

int check_solve_motion(Check *c) {
  if (!check_solve(c)) return 0;
  c->error = 4 * jet_unit * (largest(c->a, c->n) + largest(c->zd, c->m->states.n));
  bound_rounding(c);
  return 1;
}

/* --- allocation --- */

void check_prepare(Check *c) {
  const Model *m = c->m;
  uint32_t n = m->coords.n, nz = m->states.n;
  Real **const all[] = {&c->q, &c->v, &c->a, &c->q0, &c->v0, &c->c},
               **const of_states[] = {&c->z, &c->zd, &c->zdd, &c->z0};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) *all[k] = check_reals(c, n + nz);
  for (size_t k = 0; k < sizeof of_states / sizeof *of_states; k++) *of_states[k] = check_reals(c, nz);
  c->p = check_reals(c, m->params.n + c->u->nderived);
  c->given = check_reals(c, m->params.n);
  c->signal = check_reals(c, m->inputs.n + c->u->nmodes + m->scene.exacts.n + c->e->nactions);
  c->lambda = check_reals(c, m->constraints.n);
  c->lambda_error = check_reals(c, m->constraints.n);
  c->a_error = check_reals(c, n + nz);
  c->zd_error = check_reals(c, nz);
  c->gap = check_reals(c, m->constraints.n);
  c->n = n;
  c->dynamics = text_dynamics(m, c->samples, c->arena);
  c->outputs = text_outputs(m, c->samples, c->arena);
  c->at = ARENA_ARRAY(c->arena, Jet, c->dynamics->tape->slots + 1);
  c->at_outputs = ARENA_ARRAY(c->arena, Jet, c->outputs->tape->slots + 1);
  c->multipliers = !c->e->constraints.n ? NULL : c->u->multipliers ? c->u->multipliers : lower_multipliers(c->e);
  choose_parameters(c);
  check_run(c, c->u->scenes.at[c->scene].start, (Real *const[]){c->q0, c->v0, c->z0});
}
