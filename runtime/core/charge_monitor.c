/* Monitors of charges: the energy and the charges of symmetries; where forces change a charge, its balance Q - int P
 * dt. Enters: states of the run, in order; leaves: for each charge the largest difference from the start, and
 * whether it grows.
 *
 * int P dt, where it is asked for, is a sum of quadratures on the dense output, of the order of the method: one over
 * each part of a step between events. Where the ends of steps are more accurate than the dense output the nodes are
 * Radau's: those of `radau` are its stages, whose errors cancel. Methods with long steps and rough dense output,
 * those of GSL, get no balance. The jump of a charge at an event moves the value that it is compared with.
 *
 * The size of a charge is the median over the time of the run of the sum of its terms' sizes (of the energy |p.v| +
 * |L|): the largest would grow with a blow-up, and hide it. The run ends where its energy is off by several times
 * that size, and by a large part of its present size.
 *
 * Growth: the differences are averaged over 16 to 32 parts of the run, and a line is fitted to the averages. A drift
 * grows where the line explains most of their variation; an oscillation of any size cancels in the averages. Batch
 * means: B. Schmeiser, Oper. Res. 30 (1982) 556, DOI 10.1287/opre.30.3.556. Differences below the accumulated
 * rounding are not judged: D. Brouwer, Astron. J. 46 (1937) 149, DOI 10.1086/105423. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "kernels/compensated_sum.h"
#include "core/rhs.h"
#include "numeric/line_fit.h"
#include "numeric/quadrature.h"

int lag_sim_ncharges(const lag_sim *s) {
  if (!s) return 0;
  const lag_model *m = s->scene->model;

  return !m->energy ? 0 : m->charges ? m->charges->n : 1;
}

unsigned lag_charge_flags(const lag_sim *s, int k) {
  const lag_model *m = s->scene->model;
  unsigned flags = m->charges                        ? m->charges->of[k].flags
                   : m->flags & LAG_CONSERVES_ENERGY ? LAG_CONSERVED | LAG_BALANCED
                                                     : 0;
  if (!(flags & LAG_CONSERVED) && s->run->balanced == 0.0) return flags & LAG_JUMPS;
  for (int i = 0; i < m->nu && (flags & LAG_BY_FORMULAS); i++)
    if (!isnan(s->hold[i]) || s->signal[i].fn) flags = 0;
  return flags;
}

int lag_conserves_energy(lag_sim *s) {
  enum { STATES = 3 };
  const double golden = 0.6180339887498949;
  const lag_model *m = s->scene->model;
  const lag_charges *c = m->charges;
  int n = 2 * m->nq + m->nz, still = (lag_charge_flags(s, 0) & LAG_CONSERVED) != 0;
  int known = c && c->powers && c->of[0].flags & LAG_BALANCED;
  if (still || !known || lag_inputs_at(&s->pb, s->run->t, s->now)) return still;
  double *y = s->yb, *power = calloc((size_t)c->n + 1, sizeof *power);
  still = power != NULL;
  for (int k = 1; k <= STATES && still; k++) {
    for (int i = 0; i < n; i++) {
      double part = fmod(golden * k * (i + 1), 1) - 0.5;
      y[i] = s->now[i] * (1 + 0.1 * part) + (i < m->nq ? 0.01 : 1) * part;
    }
    int rc = c->powers(c, s->run->t, y, y + m->nq, y + 2 * m->nq, s->p, s->u, power, s->work);
    still = rc == 0 && power[0] == 0 && !(c->dry_friction && power[c->n] != 0);
  }
  free(power);
  return still;
}

LAG_RARE void no_values(lag_sim *s, int from) {
  for (int i = 2 * from; i < 2 * lag_sim_ncharges(s); i++) s->charge_now[i] = NAN;
}

void lag_charges_at(lag_sim *s, double t, const double *y) {
  const lag_model *m = s->scene->model;
  int n = lag_sim_ncharges(s), nq = m->nq;
  if (n == 0) return;
  if (lag_inputs_at(&s->pb, t, y)) {
    no_values(s, 0);
    return;
  }
  if (m->energy(m, t, y, y + nq, y + 2 * nq, s->p, s->u, s->charge_now, s->work))
    s->charge_now[0] = s->charge_now[1] = NAN;
  if (n > 1 && m->charges->values(m->charges, t, y, y + nq, y + 2 * nq, s->p, s->u, s->charge_now + 2, s->work))
    no_values(s, 1);
}

int lag_sim_balance(lag_sim *s) {
  if (!s) return LAG_EINVAL;
  if (s->run->begun != 0.0) return lag_fail(s, LAG_EINVAL, "the run has begun: ask for balances before the first step");
  s->balances = 1;
  return LAG_OK;
}

int lag_method_balances(const lag_method *m) {
  if (!m) return 0;
  return m->order_most > 0 || m->order <= m->dense_order + 2;
}

/* Whether the work of forces on charges can be integrated with this model and method. */
static int can_balance(const lag_sim *s) {
  const lag_charges *c = s->scene->model->charges;
  return c && c->powers && lag_method_balances(s->method);
}

/* Whether a monitor of the scene is on a charge: its balance is then integrated. */
static int watches_charges(const lag_scene *c) {
  for (int i = 0; i < c->nmonitors; i++)
    if (c->monitors[i].output < 0) return 1;
  return 0;
}

void lag_charges_method(lag_sim *s, const lag_method *method) {
  int order = method->order_most > method->order ? method->order_most : method->order,
      between = method->dense_order + 1;
  int ends = method->order_most == 0 && order > between;
  order = ends || order < between ? order : between;
  s->nodes = (order + 1) / 2 > LAG_NODES ? LAG_NODES : order < 2 ? 1 : (order + 1) / 2;
  s->nodes_at_end = ends;
  s->node[0] = 0;
}

void lag_charges_nodes(lag_sim *s) {
  if (s->node[0] == 0.0) (s->nodes_at_end ? lag_radau_points : lag_gauss_points)(s->nodes, s->node, s->weight);
}

/* Number of powers: those of the charges, and that of dry friction. */
static int npowers(const lag_model *m) { return m->charges->n + m->charges->dry_friction; }

/* gain[npowers] += int P dt over [a, b], where dense output is smooth; NaN where P has no value. */
static void add_piece(lag_sim *s, double a, double b, double *gain) {
  const lag_model *m = s->scene->model;
  int n = npowers(m), nq = m->nq;
  double *y = s->yc;
  for (int i = 0; i < s->nodes && a != b; i++) {
    double t = a + s->node[i] * (b - a);
    s->method->dense(s->method_work, &s->pb, t, y);
    int rc = lag_inputs_at(&s->pb, t, y);
    rc = rc ? rc : m->charges->powers(m->charges, t, y, y + nq, y + 2 * nq, s->p, s->u, s->charge_power, s->work);
    for (int k = 0; k < n; k++) gain[k] += rc ? NAN : (b - a) * s->weight[i] * s->charge_power[k];
  }
}

/* gain[npowers] := int P dt over [a, b], within the last step, in whose middle velocities jump where contacts are
 * met by impulses. */
static void work_over(lag_sim *s, double a, double b, double *gain) {
  const lag_contact_stats *c = s->pb.contacts;
  double jump = c && a < c->from && c->from < b ? c->from : a;
  lag_charges_nodes(s);
  memset(gain, 0, (size_t)npowers(s->scene->model) * sizeof *gain);
  add_piece(s, a, jump, gain);
  add_piece(s, jump, b, gain);
}

/* Adds the work from the last look to t, within the step that the method still knows. */
static void add_work(lag_sim *s, double t) {
  double *gain = s->charge_gain;
  Run *r = s->run;
  if (r->balanced != 0.0) {
    work_over(s, r->watched, t, gain);
    if (s->scene->model->charges->dry_friction)
      r->dry_work = lag_compensated_sum(r->dry_work, gain[lag_sim_ncharges(s)], &r->dry_lost);
    for (int k = 0; k < lag_sim_ncharges(s); k++) {
      Charge *c = &s->charges[k];
      c->work = lag_compensated_sum(c->work, c->balanced * gain[k], &c->lost);
      c->through += fabs(c->balanced * gain[k]);
    }
  }
  r->watched = t;
}

/* Merges neighbouring bins in pairs. */
LAG_RARE void merge_bins(Charge *c) {
  for (int i = 0; i < LAG_BINS / 2; i++) {
    c->t[i] = (c->t[2 * i] + c->t[2 * i + 1]) / 2;
    c->d[i] = (c->d[2 * i] + c->d[2 * i + 1]) / 2;
    c->m[i] = (c->m[2 * i] + c->m[2 * i + 1]) / 2;
  }
  c->bins = LAG_BINS / 2;
  c->width *= 2;
}

/* Median of the bins' sizes, weighted by time, as there are many steps in front of a pole; without zeros, as at
 * rest; of few bins the largest. */
LAG_RARE double median_size(const Charge *c) {
  enum { FEW = 8 };
  double size[LAG_BINS], time[LAG_BINS], whole = 0, half = 0;
  int n = 0, bins = (int)c->bins, i = 0;

  for (; i < bins; i++) {
    double lasts = fabs(c->t[i + 1 < bins ? i + 1 : i] - c->t[i > 0 ? i - 1 : 0]) * (i > 0 && i + 1 < bins ? 1 : 2);
    int k = c->m[i] > 0 ? n++ : bins;
    whole += k < bins ? lasts : 0;
    for (; k < bins && k > 0 && size[k - 1] > c->m[i]; k--) {
      size[k] = size[k - 1];
      time[k] = time[k - 1];
    }
    if (k < bins) {
      size[k] = c->m[i];
      time[k] = lasts;
    }
  }
  for (i = 0; i < n && half + time[i] < whole / 2; i++) half += time[i];
  return n == 0 ? 0 : size[n < FEW || i == n ? n - 1 : i];
}

/* The size of the charge in this run, which is not needed at each step. */
static double size_of(const Charge *c) { return lag_above_rounding(c->bins > 0 ? median_size(c) : c->size, c->terms); }

static double relative(const Charge *c, double x, double size) { return x == 0.0 ? 0 : x / fmax(fabs(c->begin), size); }

static void add_to_trend(Charge *c, double t, double d, double size) {
  const int open = LAG_BINS;
  c->t[open] += t;
  c->d[open] += d;
  c->m[open] += size;
  if (++c->in_bin < c->width) return;
  c->t[(int)c->bins] = c->t[open] / c->width;
  c->d[(int)c->bins] = c->d[open] / c->width;
  c->m[(int)c->bins] = c->m[open] / c->width;
  c->t[open] = c->d[open] = c->m[open] = c->in_bin = 0;
  if (++c->bins >= LAG_BINS) merge_bins(c);
}

/* Sizes that charges have if the values so far are rounding: of momenta, those with the velocities of the energy's
 * size. */
LAG_RARE void take_terms(lag_sim *s, double t, const double *y) {
  int n = lag_sim_ncharges(s), nq = s->pb.nq;
  double *beside = s->yb, *v = beside + nq, h = lag_step_so_far(s);
  double energy = n > 0 ? lag_energy_terms(s, t, y, h) : 0;
  if (n > 1) lag_velocity_terms(s, t, y, h, v);
  memcpy(beside, y, (size_t)nq * sizeof *beside);
  memcpy(v + nq, y + 2 * nq, (size_t)s->pb.nz * sizeof *v);
  for (int i = 0; i < nq; i++) v[i] = v[i] < HUGE_VAL ? v[i] : y[nq + i];
  if (n > 1) lag_charges_at(s, t, beside);
  for (int k = 0; k < n; k++) s->charges[k].terms = fmax(s->charges[k].terms, k ? s->charge_now[2 * k + 1] : energy);
  if (n > 0) s->charges[0].step = h;
}

void lag_charges_begin(lag_sim *s, double t, const double *y) {
  lag_charges_at(s, t, y);
  s->run->watched = t;
  s->run->balanced = can_balance(s) && (s->balances || watches_charges(s->scene));
  for (int k = 0; k < lag_sim_ncharges(s); k++) {
    s->charges[k] = (Charge){.begin = s->charge_now[2 * k],
                             .first = s->charge_now[2 * k],
                             .size = fmax(s->charge_now[2 * k + 1], 0),
                             .width = 1};
    s->charges[k].balanced = (lag_charge_flags(s, k) & LAG_BALANCED) != 0;
  }
  take_terms(s, t, y);
}

int lag_energy_undefined(lag_sim *s, double t, const double *y) {
  int n = lag_sim_ncharges(s);
  lag_charges_at(s, t, y);
  return n > 0 && isfinite(s->charges[0].begin) && !isfinite(s->charge_now[0]);
}

/* Whether the energy, known to be conserved or balanced, is off by d: by several times its size in this run, and by
 * a large part of the work done so far and of `size`, its present one (in free motion |p.v| + |L| is three times the
 * energy). The second condition spares rough tolerances, which lose as much as there is without a pole. Not judged:
 * few bins, since a motion from rest has no size yet; errors below 1e-12 of the terms; constraints that move with
 * time, whose peaks may lie between steps. */
LAG_ALWAYS_INLINE int is_lost(const lag_model *m, const Charge *c, double d, double size) {
  const double part = 0.25, times = 4, least = 1e-12, few = 8, off = fabs(d);
  int driven = m->constraints && !(m->flags & LAG_AUTONOMOUS);

  return c->balanced != 0.0 && !driven && c->bins >= few && off > times * fabs(c->begin) && off > least * c->terms &&
         off > part * fmax(size, c->through) && off > times * size_of(c);
}

/* *c := the energy's; whether half of it is lost. */
static int is_half_lost(lag_sim *s, lag_charge_stats *c) {
  const double half = 0.5, least = 1e-12;
  lag_sim_charge(s, 0, c);
  /* where forces do more work than the energy that there was */
  double large = fmax(fabs(c->now), s->charges[0].through);
  int known = (c->flags & (LAG_CONSERVED | LAG_BALANCED)) != 0;
  return known && c->drift >= half && c->absolute > fmax(least * s->charges[0].terms, half * large);
}

int lag_energy_retained(lag_sim *s) {
  const lag_model *m = s->scene->model;
  lag_charge_stats c;
  if (lag_sim_ncharges(s) == 0 || s->run->begun == 0.0 || (m->constraints && !(m->flags & LAG_AUTONOMOUS)))
    return LAG_OK;
  if (!is_half_lost(s, &c)) return LAG_OK;
  take_terms(s, s->run->t, s->now);
  if (!is_half_lost(s, &c)) return LAG_OK;
  const char *space = c.unit[0] ? " " : "";
  return lag_fail(s, LAG_EDRIFT,
                  "up to t = %.9g s the energy has an error of %.3g%s%s, of %.3g%s%s at the start: the numbers mean "
                  "nothing; take %s",
                  s->run->t, c.absolute, space, c.unit, c.begin, space, c.unit,
                  s->steps_equal ? "smaller steps" : "a smaller tolerance");
}

LAG_RARE int say_lost(lag_sim *s, double t, double before, double d) {
  const lag_model *m = s->scene->model;
  const Charge *c = &s->charges[0];
  const char *unit = m->charges ? m->charges->of[0].unit : "", *space = unit[0] ? " " : "";
  double h = lag_equal_step(s);
  return lag_fail(
      s, LAG_EDRIFT,
      "at t = %.9g s the energy is off by %.3g%s%s, %.2g times its size in this run: the numbers mean nothing from "
      "here on. The step from "
      "t = %.9g s, of %.3g s, caused %.3g%s%s of that error: it crosses a pole of a force, or is too long; %s",
      t, d, space, unit, relative(c, fabs(d), size_of(c)), s->run->step_t0, s->run->step_t1 - s->run->step_t0,
      d - before, space, unit,
      h > 0 ? "take smaller steps, or dop853, which stops in front of a pole" : "take a smaller tolerance");
}

/* At the largest energy change in a step, notes the condition of the mass matrix. The answer costs n^2 energies and
 * n^3 products, so it is computed only where the change has doubled. */
static void note_jolt(lag_sim *s, double t, const double *y, double change) {
  enum { MANY = 64 };
  const double rounding = 64 * DBL_EPSILON;
  const lag_model *m = s->scene->model;
  const Charge *c = &s->charges[0];
  Run *r = s->run;
  int which;

  if (m->nq == 0 || m->nq > MANY || m->flags & (LAG_FIRST_ORDER | LAG_CONSTANT_MASS)) return;
  if (!(change > fmax(2 * r->energy_jump, rounding * fabs(c->begin)) && change > rounding * size_of(c))) return;
  r->energy_jump = change;
  r->energy_jump_t = t;
  r->mass_condition = lag_mass_condition(&s->pb, t, y, &which);
  r->mass_condition_of = which;
}

int lag_charges_record(lag_sim *s, double t, const double *y) {
  const double longer = 4;
  int lost = 0;
  int judged = !s->unreported || watches_charges(s->scene);
  if (judged && lag_sim_ncharges(s) && lag_step_so_far(s) > longer * s->charges[0].step) take_terms(s, t, y);
  if (lag_energy_undefined(s, t, y)) return LAG_ENAN;
  add_work(s, t);
  for (int k = 0, n = lag_sim_ncharges(s); k < n; k++) {
    Charge *c = &s->charges[k];
    double d = s->charge_now[2 * k] - c->work - c->first, size = s->charge_now[2 * k + 1];
    c->peak = fabs(d) > c->peak || isnan(d) ? fabs(d) : c->peak; /* a NaN must not be forgotten */
    if (k == 0 && is_lost(s->scene->model, c, d, size)) {
      take_terms(s, t, y);
      lag_charges_at(s, t, y);
      lost = is_lost(s->scene->model, c, d, size) && say_lost(s, t, c->before, d);
    }
    add_to_trend(c, t, d, size);
    if (k == 0 && c->balanced != 0.0 && isfinite(d)) note_jolt(s, t, y, fabs(d - c->before));
    c->before = d;
  }
  return lost ? LAG_EDRIFT : LAG_OK;
}

void lag_charges_side(lag_sim *s, double t, const double *y, int after) {
  lag_charges_at(s, t, y);
  for (int k = 0; k < lag_sim_ncharges(s); k++) {
    Charge *c = &s->charges[k];
    double Q = s->charge_now[2 * k];
    c->first += after ? Q : -Q;
    if (after) c->jumped += fabs(Q - c->left);
    c->left = Q;
  }
  if (lag_sim_ncharges(s)) s->run->at_events += after ? s->charge_now[0] : -s->charge_now[0];
}

void lag_charges_add_work(lag_sim *s, double at_events, double rubbed) {
  if (!lag_sim_ncharges(s)) return;
  Charge *c = &s->charges[0];
  const lag_charges *of = s->scene->model->charges; /* NULL: the energy is the only one, and no force takes from it */
  int known = c->balanced != 0.0 && of && of->dry_friction;
  *(known ? &c->work : &c->first) += rubbed;
  *(known ? &s->run->dry_work : &s->run->at_events) += rubbed;
  c->first += at_events;
  c->jumped += fabs(at_events);
  s->run->at_events += at_events;
}

/* Adds work of contacts by impulses in the present step up to now that is not in the charges yet. */
static void add_pending_work(const lag_sim *s, Charge *energy, lag_charge_stats *st) {
  const lag_contact_stats *c = s->pb.contacts;
  const Run *r = s->run;
  if (!c || c->due == 0.0 || r->have_step == 0.0) return;
  double part = c->from < r->step_t1 ? r->t >= c->from : (r->t - r->step_t0) / (r->step_t1 - r->step_t0);
  const int known = isfinite(st->dry_friction);
  const double rubbed = part * c->rubbed, struck = part * c->work + (known ? 0 : rubbed);
  if (known) st->dry_friction += rubbed, st->work += rubbed;
  st->at_events += struck;
  energy->first += struck;
}

/* Includes the present state in the peak. */
static void with_present(Charge *c, double now, double work) {
  double d = fabs(now - work - c->first);
  c->peak = d > c->peak || isnan(d) ? d : c->peak;
}

double lag_charge_drift(const lag_sim *s, int k) {
  return relative(&s->charges[k], s->charges[k].peak, size_of(&s->charges[k]));
}

/* Fits a line to the bins: *slope and *error; returns the trend. */
static int trend_of(const Charge *c, double size, double steps, double *slope, double *error) {
  const int fewest = 16;
  const double explained = 0.8; /* a line explains at most 6/pi^2 = 0.61 of a sine whose period is the run */
  int n = (int)c->bins;
  *slope = *error = NAN;
  if (n < fewest || !isfinite(c->peak)) return LAG_TREND_UNKNOWN;
  LineFit f = lag_line_fit(n, c->t, c->d);
  *slope = f.xy / f.xx;
  *error = sqrt(fmax(f.yy - f.xy * *slope, 0) / (n - 2) / f.xx);
  if (c->peak <= 16 * DBL_EPSILON * size * sqrt(steps)) return LAG_TREND_ROUNDING;
  return f.xy * f.xy >= explained * f.xx * f.yy ? LAG_TREND_GROWS : LAG_TREND_OSCILLATES;
}

void lag_sim_charge(lag_sim *s, int k, lag_charge_stats *st) {
  if (!st) return;
  *st = (lag_charge_stats){.name = "",
                           .unit = "", .begin = NAN, .now = NAN, .drift = NAN, .slope = NAN, .slope_error = NAN,
                           .mass_condition = NAN,
                           .mass_condition_of = ""};
  if (!s || k < 0 || k >= lag_sim_ncharges(s)) return;
  const lag_model *m = s->scene->model;
  const Run *r = s->run;
  Charge seen = s->charges[k], *c = &seen;
  double since = 0, size = size_of(c);

  *st = (lag_charge_stats){.name = m->charges ? m->charges->of[k].name : "energy",
                           .unit = m->charges ? m->charges->of[k].unit : "", .flags = lag_charge_flags(s, k),
                           .begin = c->begin, .mass_condition = NAN,
                           .mass_condition_of = ""};
  if (r->begun != 0.0 && r->have_step != 0.0 && r->balanced != 0.0) { /* the run's end is within a step */
    work_over(s, r->watched, r->t, s->charge_gain);
    since = c->balanced * s->charge_gain[k];
    if (k == 0 && m->charges->dry_friction) st->dry_friction = s->charge_gain[m->charges->n];
  }
  lag_charges_at(s, r->t, s->now);
  st->now = s->charge_now[2 * k];
  st->work = c->work + since;
  st->dry_friction =
      k == 0 && m->charges && m->charges->dry_friction && r->balanced != 0.0 ? r->dry_work + st->dry_friction : NAN;
  st->at_events = k == 0 ? r->at_events : 0;
  if (k == 0) add_pending_work(s, c, st);
  if (r->begun == 0.0) st->begin = st->now;
  else with_present(c, st->now, st->work);
  if (r->begun != 0.0 && !(size > 0)) size = s->charge_now[2 * k + 1];
  st->drift = relative(c, c->peak, size);
  st->absolute = c->peak;
  st->trend = trend_of(c, size, r->steps, &st->slope, &st->slope_error);
  st->slope = relative(c, st->slope, size);
  st->slope_error = relative(c, st->slope_error, size);
  if (k == 0 && r->energy_jump > 0) {
    st->energy_jump = relative(c, r->energy_jump, size);
    st->energy_jump_t = r->energy_jump_t;
    st->mass_condition = r->mass_condition;
    st->mass_condition_of = m->q[(int)r->mass_condition_of].name;
  }
}
