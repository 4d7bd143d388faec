/* Sizes of the quantities of a model: what rounding is relative to. Enters: a state; leaves: the size of the terms
 * that make a quantity, which counts where the quantity is their rounding. Holds: with other units, or another part
 * at rest beside, each size has the same ratio to its quantity. What formulas round is seen in other rounding modes:
 * W. Kahan, How futile are mindless assessments of roundoff in floating-point computation? (2006), section 4. */
#include <fenv.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "numeric/magnitudes.h"

static const double moved = 1. / 1024; /* relative change of a state that shows terms that cancel */

double lag_above_rounding(double size, double terms) {
  const double rounding = 1e-12; /* of a few thousand operations */
  return size > rounding * terms || !(terms < HUGE_VAL) ? size : terms;
}

/* s->ya := y, each component times 1 + moved. */
static const double *moved_state(lag_sim *s, const double *y) {
  for (int i = 0; i < s->pb.n; i++) s->ya[i] = y[i] * (1 + moved);
  return s->ya;
}

/* e[2] := the energy and its scale; NaN where there is none. */
static void energy_at(lag_sim *s, double t, const double *y, double *e) {
  const lag_model *m = s->scene->model;
  int nq = m->nq, bad = !m->energy || lag_inputs_at(&s->pb, t, y);
  if (bad || m->energy(m, t, y, y + nq, y + 2 * nq, s->p, s->u, e, s->work)) e[0] = e[1] = NAN;
}

/* x := values of a formula at t, y, with the inputs as they are. Not 0: there are none. */
static int formula_at(lag_sim *s, LagFormula of, double t, const double *y, double *x) {
  const lag_model *m = s->scene->model;
  const double *v = y + m->nq, *z = v + m->nq;
  if (of == LAG_FORMULA_ENERGY) return !m->energy || m->energy(m, t, y, v, z, s->p, s->u, x, s->work);
  if (of == LAG_FORMULA_RATES) return m->accel(m, t, y, v, z, s->p, s->u, x, x + m->nq, s->work);
  return m->constraints->residuals(m->constraints, t, y, v, z, s->p, s->u, x, s->pb.held + m->constraints->n, s->work);
}

/* Number of values of a formula. */
static int formula_length(const lag_model *m, LagFormula of) {
  return of == LAG_FORMULA_ENERGY ? 1 : of == LAG_FORMULA_RATES ? m->nq + m->nz : m->constraints->nholonomic;
}

/* x := the formula of a state and parameters whose last digits are larger, or smaller: the same bits wherever the
 * formula has them. */
static int formula_beside(lag_sim *s, LagFormula of, double t, const double *y, int upwards, double *x) {
  const lag_model *m = s->scene->model;
  const int n = s->pb.n, np = m->np + m->nderived;
  double *beside = s->beside, *p = beside + n, by = upwards ? 1 : -1;
  memcpy(p, s->p, (size_t)np * sizeof *p);
  for (int i = 0; i < n; i++) beside[i] = y[i] * (1 + by * (1 + lag_uneven(i)) * DBL_EPSILON);
  for (int i = 0; i < np; i++) s->p[i] *= 1 + by * (1 + lag_uneven(n + i)) * DBL_EPSILON;
  int rc = formula_at(s, of, t, beside, x);
  memcpy(s->p, p, (size_t)np * sizeof *p);
  return rc;
}

/* x := the formula rounded upwards, or downwards; without rounding modes, as in WebAssembly, the one beside. */
static int formula_rounded(lag_sim *s, LagFormula of, double t, const double *y, int upwards, double *x) {
#if defined FE_UPWARD && defined FE_DOWNWARD && defined FE_TONEAREST
  int before = fegetround(), rc = fesetround(upwards ? FE_UPWARD : FE_DOWNWARD) || formula_at(s, of, t, y, x);
  return fesetround(before) || rc;
#else
  return formula_beside(s, of, t, y, upwards, x);
#endif
}

/* noise := the smaller change to up and down, where neither is 0: one of the modes costs lag_math.h digits of a small
 * angle, by its sign. Enters: noise is the formula. */
static void noise_between(int n, double *noise, const double *up, const double *down) {
  for (int i = 0; i < n; i++) {
    double over = fabs(up[i] - noise[i]), under = fabs(down[i] - noise[i]);
    noise[i] = over > 0 && under > 0 ? fmin(over, under) : fmax(over, under);
  }
}

/* noise := rounding of a formula. Enters: noise is the formula. Not 0: there are no values. */
static int rounding_of(lag_sim *s, LagFormula of, double t, const double *y, double *noise, double *up, double *down) {
  int rc = formula_rounded(s, of, t, y, 1, up) || formula_rounded(s, of, t, y, 0, down);
  if (!rc) noise_between(formula_length(s->scene->model, of), noise, up, down);
  return rc;
}

int lag_formula_rounding(lag_sim *s, LagFormula of, double t, const double *y, double *noise, double *up,
                         double *down) {
  return formula_at(s, of, t, y, noise) || rounding_of(s, of, t, y, noise, up, down);
}

/* yb[nq] := how far residuals as large as the terms of the constraints move coordinates: lengths that the state
 * lacks. */
static int constraint_lengths(lag_sim *s, double t, const double *y) {
  const lag_constraints *of = s->scene->model->constraints;
  if (!of || !of->nholonomic) return 1;
  double *c = s->pb.held, *up = c + 2 * of->n, *down = up + of->n;
  if (lag_formula_rounding(s, LAG_FORMULA_RESIDUALS, t, y, c, up, down)) return 1;
  for (int k = 0; k < of->nholonomic; k++) c[k] /= DBL_EPSILON;
  return lag_least_change(&s->pb, t, y, 1, c, s->yb, s->yb + s->pb.nq);
}

/* The change of the energy e where component `at` + i moves by d[i]. */
static double change_of_energy(lag_sim *s, double t, const double *y, int at, const double *d, double e) {
  double there[2];
  memcpy(s->yc, y, (size_t)s->pb.n * sizeof(double));
  for (int i = 0; i < s->pb.nq; i++) s->yc[at + i] += d[i] * lag_uneven(i);
  energy_at(s, t, s->yc, there);
  return fabs(there[0] - e) < HUGE_VAL ? fabs(there[0] - e) : 0;
}

/* Whether variables i and k have one unit; compilers merge equal texts. */
static int same_unit(const lag_var *var, int i, int k) {
  return var[i].unit == var[k].unit || strcmp(var[i].unit, var[k].unit) == 0;
}

/* first[n] := the first variable with the unit of each. Families have one unit. */
static void find_alike(const lag_var *var, int n, int *first) {
  for (int i = 0; i < n; i++) {
    int k = 0;
    if (i > 0 && same_unit(var, i - 1, i)) k = first[i - 1];
    else
      while (!same_unit(var, k, i)) k++;
    first[i] = k;
  }
}

void lag_find_alike(const lag_model *m, int *first) {
  find_alike(m->q, m->nq, first);
  find_alike(m->z, m->nz, first + m->nq);
}

/* The energy where all coordinates with the unit of coordinate i have the velocity h, and others rest. */
static double energy_moving(lag_sim *s, double t, const double *y, int i, double h) {
  const lag_model *m = s->scene->model;
  const int nq = m->nq;
  double e[2];
  memcpy(s->ya, y, (size_t)s->pb.n * sizeof(double));
  for (int j = 0; j < nq; j++) s->ya[nq + j] = s->alike[j] == s->alike[i] ? h : 0;
  energy_at(s, t, s->ya, e);
  return e[0];
}

/* The energies with which each search for a velocity begins: at rest, and where velocities are 1. */
typedef struct Moving {
  int known;
  double rest, one;
} Moving;

/* The velocity of all coordinates with the unit of coordinate i at which they have this kinetic energy; HUGE_VAL:
 * there is none. */
static double velocity_of(lag_sim *s, double t, const double *y, int i, double energy, Moving *at) {
  enum { MOST = 60 };
  double h = 1, far = 1e4;
  if (!at->known) *at = (Moving){1, energy_moving(s, t, y, i, 0), energy_moving(s, t, y, i, h)};
  for (int k = 0; k < MOST; k++) {
    double ratio = fabs((k ? energy_moving(s, t, y, i, h) : at->one) - at->rest) / energy;
    if (ratio > 0.25 && ratio < 4) return h;
    if (ratio > 1e-3 && ratio < HUGE_VAL) h /= sqrt(ratio);
    else if (ratio <= 1e-3) h *= far;
    else h /= (far = sqrt(far)); /* beyond the domain of L, as the speed of light */
  }
  return HUGE_VAL;
}

/* The energy that a force along the coordinates with the unit of coordinate i gives in a step h, if nothing holds
 * them, and that is more than `least`; 0: there is none. The force, as the energy is linear in a displacement by h
 * v. */
static double energy_of_force(lag_sim *s, double t, const double *y, int i, double h, double e, double least) {
  enum { MOST = 20 };
  const double linear = 0.4, shorter = 1e-8;
  const lag_model *m = s->scene->model;
  int nq = m->nq;
  double energy = 1, *d = s->yb;
  Moving at = {0};
  for (int turn = 0; turn < MOST; turn++) {
    double v = velocity_of(s, t, y, i, energy, &at);
    if (!(v < HUGE_VAL)) return 0;
    for (int j = 0; j < nq; j++) d[j] = s->alike[j] == s->alike[i] ? h * v : 0;
    double whole = change_of_energy(s, t, y, 0, d, e);
    for (int j = 0; j < nq; j++) d[j] /= 2;
    double half = change_of_energy(s, t, y, 0, d, e), ratio = whole / energy;
    int is_linear = half > linear * whole && half < (1 - linear) * whole;
    if (is_linear && (whole <= least || (ratio > 1. / 16 && ratio < 16))) return whole <= least ? 0 : whole;
    energy *= is_linear ? ratio * ratio : shorter;
    if (!(energy > 0 && energy < HUGE_VAL)) return 0;
  }
  return 0;
}

/* ya[n] := changes of the rates by the friction of switch k, from slipping at its size to none, where the motion sticks
 * at it; 0: it does not. Uses yc. */
static int friction_rates(lag_sim *s, int k, double t, const double *y) {
  double *mode = &s->hold[s->scene->model->nu + k], was = *mode;
  if (!s->scene->model->switches[k].jumps || !lag_switch_sticks(s, k)) return 0;
  lag_switch_hold(s, k, -1);
  int rc = lag_rhs(&s->pb, t, y, s->ya);
  lag_switch_hold(s, k, 1);
  rc = rc || lag_rhs(&s->pb, t, y, s->yc);
  lag_switch_hold(s, k, was);
  for (int i = 0; i < s->pb.n; i++) s->ya[i] = rc ? 0 : fabs(s->yc[i] - s->ya[i]) / 2;
  return !rc;
}

/* The size of the energy e of which rounding is what a body at rest has: of its formula, of rates and of forces in
 * balance in a step h, friction among them, and of lengths in constraints. */
static double resting_terms(lag_sim *s, double t, const double *y, double h, double e) {
  const lag_model *m = s->scene->model;
  double of = e, up[2], down[2];
  double terms = rounding_of(s, LAG_FORMULA_ENERGY, t, y, &of, up, down) ? 0 : of / DBL_EPSILON;
  double least = 1e3 * DBL_EPSILON * fmax(fabs(e), terms), *a = s->ya;
  if (h > 0 && lag_formula_rounding(s, LAG_FORMULA_RATES, t, y, a, s->yb, s->yc) == 0) {
    for (int i = 0; i < m->nq; i++) a[i] *= h / DBL_EPSILON;
    terms += change_of_energy(s, t, y, m->nq, a, e);
  }
  for (int i = 0; i < m->nq && h > 0 && !(m->flags & LAG_FIRST_ORDER); i++)
    terms += s->alike[i] == i ? energy_of_force(s, t, y, i, h, e, least) : 0;
  for (int k = 0; k < m->nmodes && h > 0; k++) {
    if (!friction_rates(s, k, t, y)) continue;
    for (int i = 0; i < m->nq; i++) s->ya[m->nq + i] *= h;
    terms += change_of_energy(s, t, y, m->nq, s->ya + m->nq, e);
  }
  return constraint_lengths(s, t, y) ? terms : terms + change_of_energy(s, t, y, 0, s->yb, e);
}

double lag_step_so_far(const lag_sim *s) {
  return s->run->have_step != 0.0 ? fabs(s->run->step_t1 - s->run->step_t0) : lag_equal_step(s);
}

double lag_energy_terms(lag_sim *s, double t, const double *y, double h) {
  double e[2], beside[2], calls = s->pb.rhs_calls;
  energy_at(s, t, moved_state(s, y), beside);
  energy_at(s, t, y, e);
  double rest = resting_terms(s, t, y, h, e[0]);
  s->pb.rhs_calls = calls;
  return lag_above_rounding(fmax(e[1], fabs(e[0])), fmax(fabs(beside[0] - e[0]) / moved, rest));
}

double lag_output_change(lag_sim *s, double t, const double *y, int k) {
  if (lag_observe(s, t, y, s->out)) return NAN;
  double at = s->out[k];
  return lag_observe(s, t, moved_state(s, y), s->out) ? NAN : fabs(s->out[k] - at) / moved;
}

double lag_output_terms(lag_sim *s, double t, const double *y, int k) {
  double change = lag_output_change(s, t, y, k);
  if (lag_observe(s, t, y, s->out)) return NAN;
  return isnan(change) ? fabs(s->out[k]) : lag_above_rounding(fabs(s->out[k]), change);
}

void lag_velocity_terms(lag_sim *s, double t, const double *y, double h, double *v) {
  const lag_model *m = s->scene->model;
  double energy = lag_energy_terms(s, t, y, h);
  int known = energy > 0 && energy < HUGE_VAL && !(m->flags & LAG_FIRST_ORDER);
  for (int i = 0; i < m->nq; i++) {
    if (s->alike[i] != i) continue;
    double of = known ? velocity_of(s, t, y, i, energy, &(Moving){0}) : HUGE_VAL;
    for (int k = i; k < m->nq; k++) v[k] = s->alike[k] == i ? of : v[k];
  }
}

/* ---- Sizes of a motion, from its start */

/* Over all coordinates with one unit: the largest |q|, rate and acceleration at the start, and change of the
 * acceleration where coordinates are displaced. still: the acceleration is rounding of forces that cancel, and there is
 * no rate. */
typedef struct Kind {
  double q, v, a, bend;
  int still;
} Kind;

/* The largest |x[k]| over the n variables with the unit of variable i. */
static double largest_of_unit(int n, const int *alike, const double *x, int i) {
  double most = 0;
  for (int k = 0; k < n; k++)
    if (alike[k] == alike[i]) most = fmax(most, fabs(x[k]));
  return most;
}

enum { ROUNDINGS = 1000 }; /* of a few hundred operations */

/* f: rates at the start; bend: their change; noise[nq]: rounding of accelerations, NULL: not known. */
static Kind kind_of(const lag_sim *s, const double *f, const double *bend, const double *noise, int i) {
  const lag_var *var = s->scene->model->q;
  const int nq = s->pb.nq;
  double q = lag_component_scale(fmax(largest_of_unit(nq, s->alike, s->now, i), DBL_MIN), var[i].periodic, var[i].unit);
  double v = largest_of_unit(nq, s->alike, f, i), a = largest_of_unit(nq, s->alike, f + nq, i);
  int still = noise && !(v > 0) && a > 0 && a < ROUNDINGS * noise[i];
  return (Kind){q > DBL_MIN ? q : 0, v, a, largest_of_unit(nq, s->alike, bend + nq, i), still};
}

static double reach(Kind k, double time) {
  return k.q > 0 ? k.q : k.still && k.bend > 0 ? k.bend * time * time : fmax(k.v * time, k.a * time * time);
}

/* The time in which the motion changes by its own size; at most `time`. */
static double time_scale(Kind k, double time) {
  double q = reach(k, time);
  if (k.q > 0 && k.a > 0) time = fmin(time, sqrt(k.q / k.a));
  if (k.q > 0 && k.v > 0) time = fmin(time, k.q / k.v);
  /* a smaller v is rounding */
  if (!(k.q > 0) && k.a > 0 && time < HUGE_VAL && k.v > 1e-9 * k.a * time) time = fmin(time, k.v / k.a);
  return q > 0 && k.bend > 0 ? fmin(time, sqrt(q / k.bend)) : time;
}

/* A power of 1024, as a change from m to nm or km is one: 1 for sizes from 1/8 to 128. A tolerance is at most 8
 * times that of the size itself. */
static double size_unit(double size) {
  return size > 0 && size < HUGE_VAL ? scalbn(1, 10 * (int)floor((log2(size) + 3) / 10)) : 1;
}

/* dy[n] := rates at the start, where y[at + i] is displaced by by[i], i < count, less f; NULL: nothing is displaced,
 * or subtracted. Zeros where there are none. */
static void rates_beside(lag_sim *s, int at, int count, const double *by, const double *f, double *dy) {
  const int n = s->pb.n;
  memcpy(s->ya, s->now, (size_t)n * sizeof *dy);
  for (int i = 0; i < count && by; i++) s->ya[at + i] += by[i] * lag_uneven(i);
  int none = lag_rhs(&s->pb, s->run->t, s->ya, dy) || lag_not_finite(n, dy) >= 0;
  for (int i = 0; i < n; i++) dy[i] = none ? 0 : dy[i] - (f ? f[i] : 0);
}

/* noise[nq] := rounding of the accelerations at the start, the largest of each unit, in a block of 3 n; NULL: not
 * known. Steps depend on it, and what rounding modes show depends on the compiler: it is what last digits of the state
 * and of parameters change. */
static double *acceleration_noise(lag_sim *s, double *noise) {
  const double t = s->run->t, *y = s->now;
  double *up = noise + s->pb.n, *down = up + s->pb.n;
  if (formula_beside(s, LAG_FORMULA_RATES, t, y, 1, up) || formula_beside(s, LAG_FORMULA_RATES, t, y, 0, down) ||
      formula_at(s, LAG_FORMULA_RATES, t, y, noise))
    return NULL;
  noise_between(s->pb.nq, noise, up, down);
  for (int i = 0; i < s->pb.nq; i++) { /* that of one coordinate alone may be 0 */
    int first = s->alike[i];
    noise[i] = first < i ? noise[first] : largest_of_unit(s->pb.nq, s->alike, noise, i);
  }
  return noise;
}

/* f[n] := 0 for accelerations that are rounding, as of forces that constraints and contacts balance. */
static void drop_rounding(const lag_sim *s, const double *noise, double *f) {
  const int nq = s->pb.nq;
  for (int i = 0; noise && i < nq; i++)
    if (fabs(f[nq + i]) < ROUNDINGS * noise[i]) f[nq + i] = 0;
}

/* bend[n] := change of the rates f where y[at + i] is displaced by by[i], i < nq. */
static void bends(lag_sim *s, int at, const double *by, const double *f, const double *noise, double *bend) {
  rates_beside(s, at, s->pb.nq, by, f, bend);
  drop_rounding(s, noise, bend);
}

/* The sizes of coordinates and velocities, f: rates at the start, of which `noise` is rounding, `balanced` what
 * constraints leave. Returns the time scale, which begins as `time`.
 * Turn 0: from the start alone; 1: with the forces of displaced coordinates; 2: of displaced velocities. */
static double coordinate_sizes(lag_sim *s, const double *f, const double *noise, const double *balanced, double time) {
  const lag_model *m = s->scene->model;
  const int nq = m->nq;
  double *bend = s->yc, *size = s->pb.size, *of_v = size + nq;
  for (int turn = 0; turn < 3; turn++) {
    double before = time;
    if (turn) bends(s, turn == 2 ? nq : 0, turn == 2 ? of_v : size, f, balanced, bend);
    for (int i = 0; i < nq; i++) {
      if (s->alike[i] != i) continue;
      Kind k = kind_of(s, f, bend, noise, i);
      time = turn < 2 ? time_scale(k, time) : k.bend > 0 ? fmin(time, of_v[i] / k.bend) : time;
    }
    for (int i = 0; i < nq; i++) {
      if (s->alike[i] != i) continue;
      Kind k = kind_of(s, f, bend, noise, i);
      double v =
          turn < 2 ? lag_above_rounding(fmax(k.v, k.a * time), k.bend * time) : fmax(k.v, of_v[i] * time / before);
      const int rests = !(k.v > 0) && !(k.a > 0);
      v = rests && v * time < 1e-12 * reach(k, time) ? 0 : v; /* rounding of forces that hold a displaced body, too */
      for (int j = nq - 1; j >= i; j--) {
        if (s->alike[j] != i) continue;
        size[j] = reach(k, time);
        of_v[j] = v;
      }
    }
  }
  return time;
}

/* The time scale of a motion that begins where no coordinate has a size, by the forces where it leads: `time` tends
 * to it. */
static double time_from_zero(lag_sim *s, const double *f, const double *noise, double time) {
  enum { TURNS = 8 };
  double *bend = s->yc, *size = s->pb.size;
  for (int turn = 0; turn < TURNS; turn++) {
    double next = HUGE_VAL;
    for (int i = 0; i < s->pb.nq; i++) {
      int first = s->alike[i];
      size[i] = first < i ? size[first] : reach(kind_of(s, f, bend, NULL, i), time);
    }
    bends(s, 0, size, f, noise, bend);
    for (int i = 0; i < s->pb.nq; i++) {
      if (s->alike[i] != i) continue;
      Kind k = kind_of(s, f, bend, NULL, i);
      if (size[i] > 0 && k.bend > 0) next = fmin(next, sqrt(size[i] / k.bend));
    }
    if (!(next < HUGE_VAL)) break;
    time = sqrt(time) * sqrt(next);
  }
  memset(bend, 0, (size_t)s->pb.n * sizeof *bend);
  return time;
}

/* The sizes of states: at the start; of those that begin at 0, where their rates f lead in `time`, or before, where
 * they change as much as f: a state that relaxes goes no further. */
static void state_sizes(lag_sim *s, const double *f, double time) {
  enum { TURNS = 8 };
  const lag_model *m = s->scene->model;
  const int nq = s->pb.nq, at = 2 * nq, nz = m->nz, *alike = s->alike + nq;
  double *bend = s->yc, *size = s->pb.size + at;
  int shrinks = 0;
  for (int i = 0; i < nz; i++) {
    int first = alike[i];
    double z = first < i ? 0 : largest_of_unit(nz, alike, s->now + at, i);
    size[i] = first < i ? size[first] : z > 0 ? z : largest_of_unit(nz, alike, f + at, i) * time;
    shrinks |= first == i && !(z > 0);
  }
  for (int turn = 0; turn < TURNS && shrinks; turn++) {
    shrinks = 0;
    rates_beside(s, at, nz, size, f, bend);
    for (int i = 0; i < nz; i++) {
      int first = alike[i];
      if (first < i) {
        size[i] = size[first];
        continue;
      }
      double rate = largest_of_unit(nz, alike, f + at, i), change = largest_of_unit(nz, alike, bend + at, i);
      if (largest_of_unit(nz, alike, s->now + at, i) > 0 || !(rate > 0 && change > 2 * rate)) continue;
      size[i] *= rate / change;
      shrinks = 1;
    }
  }
}

/* f[n] := the larger of |f| and of change[n], beyond its rounding (NULL: it has none), of coordinates that are at
 * rest. */
static void raise_rates(const lag_sim *s, const double *change, const double *noise, double *f) {
  const int nq = s->pb.nq;
  double v = 0;
  for (int i = 0; i < nq; i++) {
    double by = fabs(change[nq + i]);
    if (i == 0 || s->alike[i] != s->alike[i - 1]) v = largest_of_unit(nq, s->alike, s->now + nq, i);
    if (!(v > 0) && by > ROUNDINGS * (noise ? noise[i] : 0)) f[nq + i] = fmax(fabs(f[nq + i]), by);
  }
}

/* The same by what contacts that are open now change. */
static void raise_open(lag_sim *s, double *f) {
  rates_beside(s, 0, 0, NULL, f, s->yc);
  double *noise = acceleration_noise(s, s->beside_open);
  if (noise) raise_rates(s, s->yc, noise, f);
}

/* Accelerations of a body that friction or a contact holds are rounding: raises f[n], rates at the start, to those
 * without it. */
static void raise_held(lag_sim *s, double *f) {
  const lag_model *m = s->scene->model;
  for (int k = 0; k < m->nmodes; k++)
    if (friction_rates(s, k, s->run->t, s->now)) raise_rates(s, s->ya, NULL, f);
  int holds = 0;
  for (int i = 0; i < m->ncontacts && !s->pb.contacts; i++) {
    double *held = &s->hold[m->contacts[i].input];
    s->contact_was[i] = *held;
    if (!(*held > 0.5)) continue;
    *held = NAN;
    holds = 1;
  }
  if (holds) raise_open(s, f);
  for (int i = 0; i < m->ncontacts && !s->pb.contacts; i++) s->hold[m->contacts[i].input] = s->contact_was[i];
}

/* The time of the fastest small oscillation about the start; `time`: none is seen. noise: with its block, which is
 * scratch. */
static double local_time(lag_sim *s, const double *f, double *noise, double time) {
  const int nq = s->pb.nq;
  double *by = noise + s->pb.n, *bend = s->yc, least = HUGE_VAL;
  for (int i = 0; i < nq; i++) {
    int first = s->alike[i];
    by[i] = first < i ? by[first] : sqrt(DBL_EPSILON) * largest_of_unit(nq, s->alike, s->now, i);
  }
  bends(s, 0, by, f, noise, bend);
  for (int i = 0; i < nq; i++) {
    if (s->alike[i] < i) continue;
    double change = largest_of_unit(nq, s->alike, bend + nq, i);
    if (by[i] > 0 && change > 0) least = fmin(least, sqrt(by[i] / change));
  }
  return least < HUGE_VAL ? least : time;
}

enum { STEPS = 16 }; /* of the longest kind, by high orders, in the time of an oscillation over 2 pi */

/* Raises the sizes of coordinates and velocities to where the tolerance is what the rounding of accelerations gives in
 * a step: smaller errors cannot be asked for, and steps would be refused without end. */
static void raise_to_rounding(lag_sim *s, const double *noise, double step) {
  const lag_model *m = s->scene->model;
  const int nq = m->nq;
  double *size = s->pb.size, v = 0;
  for (int i = 0; i < nq; i++) {
    if (i == 0 || s->alike[i] != s->alike[i - 1])
      v = noise[i] * step / s->pb.tol;
    if (!(v > 0 && v < HUGE_VAL)) continue;
    size[i] = fmax(size[i], exp2(ceil(log2(v * step))));
    size[nq + i] = fmax(size[nq + i], exp2(ceil(log2(v))));
  }
}

void lag_start_sizes(lag_sim *s) {
  const lag_model *m = s->scene->model;
  const int nq = m->nq, n = s->pb.n;
  double *f = s->yb, *bend = s->yc, *size = s->pb.size, time = HUGE_VAL, calls = s->pb.rhs_calls;
  rates_beside(s, 0, 0, NULL, NULL, f);
  double *noise = acceleration_noise(s, s->beside_noise), *balanced = m->constraints || m->ncontacts ? noise : NULL;
  drop_rounding(s, balanced, f);
  raise_held(s, f);
  memset(bend, 0, (size_t)n * sizeof *bend);
  for (int i = 0; i < nq; i++) time = s->alike[i] == i ? time_scale(kind_of(s, f, bend, noise, i), time) : time;
  const double span = s->pb.span;
  time = time < HUGE_VAL ? time : time_from_zero(s, f, balanced, span > 0 ? span : 10);
  time = coordinate_sizes(s, f, noise, balanced, span > 0 ? fmin(time, span) : time);
  state_sizes(s, f, time);
  for (int i = 0; i < n; i++) size[i] = size_unit(size[i]);
  if (noise) raise_to_rounding(s, noise, local_time(s, f, noise, time) / STEPS);
  size[n + 1] = size_unit(time);
  s->pb.rhs_calls = calls;
}
