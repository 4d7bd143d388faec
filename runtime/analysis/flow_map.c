/* The flow of a model as a map (flow_map.h). */
#include "analysis/flow_map.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/fastest_rate.h"
#include "numeric/dense.h"
#include "numeric/singular_values.h"

static int keep_message(FlowMap *f, const lag_sim *sim, int rc) {
  snprintf(f->message, sizeof f->message, "%s", rc == LAG_ENOMEM ? "out of memory" : lag_sim_message(sim));
  return rc;
}

lag_sim *lag_flow_sim(FlowMap *f, double t, const double *y0) {
  const lag_scene *own = f->like->scene;
  f->scene = *own;
  f->scene.t0 = t;
  f->scene.t1 = own->t1 + (t - own->t0);
  f->like->scene = &f->scene;
  lag_sim *sim = lag_sim_like(f->like);
  f->like->scene = own;
  if (!sim) return NULL;
  sim->kicks_late = t - own->t0;
  if (f->name) lag_sim_set(sim, f->name, f->value);
  if (y0) memcpy(sim->start, y0, (size_t)f->n * sizeof *y0);
  return sim;
}

lag_sim *lag_flow_sim_along(FlowMap *f, double t, const double *y0, double along) {
  const lag_scene *own = f->like->scene;
  lag_scene scene = *own;
  scene.t1 = own->t0 + along;
  f->like->scene = &scene;
  lag_sim *sim = lag_flow_sim(f, t, y0);
  f->like->scene = own;
  return sim;
}

/* probe := sim, at its start. */
static int take_probe(FlowMap *f, lag_sim *sim) {
  lag_sim_free(f->probe);
  f->probe = sim;
  int rc = lag_sim_advance(sim, f->t0);
  if (rc) return keep_message(f, sim, rc < 0 ? rc : LAG_EINVAL);
  lag_switch_set_free(sim, 1);
  return LAG_OK;
}

static int renew_probe(FlowMap *f) {
  lag_sim *sim = lag_flow_sim(f, f->t0, NULL);
  return sim ? take_probe(f, sim) : keep_message(f, NULL, LAG_ENOMEM);
}

int lag_flow_set(FlowMap *f, const char *name, double value) {
  if (f->name == name && f->value == value) return LAG_OK;
  f->name = NULL; /* a value of the wrong sign is refused with its words */
  lag_sim *sim = lag_flow_sim(f, f->t0, NULL);
  int rc = sim ? lag_sim_set(sim, name, value) : LAG_ENOMEM;
  if (rc) {
    keep_message(f, sim, rc);
    lag_sim_free(sim);
    return rc;
  }
  f->name = name;
  f->value = value;
  return take_probe(f, sim);
}

/* Numbers that a drive changes, n + nev: rates, and event functions, as of a contact with a plate that moves. */
static int driven_numbers(const FlowMap *f) { return f->n + f->like->scene->model->nev; }

static int driven_at(FlowMap *f, double t, const double *y, double *out) {
  lag_sim *s = f->probe;
  const lag_model *m = s->scene->model;
  int rc = lag_rhs(&s->pb, t, y, out);
  if (rc == 0 && m->nev)
    rc = m->events(m, t, y, y + m->nq, y + 2 * m->nq, s->p, s->u, out + f->n, s->work);
  return rc;
}

/* Weight of number i beside the rates, of those at[n + nev]: event functions count as much as all rates, whatever their
 * size: that of a distant surface is large. */
static double driven_weight(const FlowMap *f, const double *at, int i) {
  double rates = lag_dot(f->n, at, at);
  return i < f->n || !(rates > 0) || at[i] == 0.0 ? 1 : sqrt(rates) / fabs(at[i]);
}

/* *longest := the longest period of a kick; 0: there are none. Whether T is a multiple of all of them. */
static int fits_kicks(FlowMap *f, double T, double *longest) {
  const double rounding = 1e-12;
  lag_sim *s = f->probe;
  int fits = 1;
  *longest = 0;
  for (int k = 0; k < s->scene->model->nev; k++) {
    if (!lag_is_kick(s->scene->model, k) || lag_events_eval(s, f->t0, s->now, s->g1)) continue;
    *longest = fmax(*longest, s->g1[k]);
    fits &= T > 0.5 * s->g1[k] && fabs(remainder(T, s->g1[k])) <= rounding * T;
  }
  return fits;
}

/* Whether numbers differ, by more than the sign of 0 that a drive without size leaves. */
static int differ(int n, const double *a, const double *b) {
  for (int i = 0; i < n; i++)
    if (a[i] != b[i] && !(isnan(a[i]) && isnan(b[i]))) return 1;
  return 0;
}

/* Whether they change with time at the start. */
static int depends_on_time(FlowMap *f) {
  static const double times[] = {0.1234567, 0.5772157, 2.7182818, 31.41592653};
  if (lag_facts(&f->probe->pb) & LAG_AUTONOMOUS && !f->like->scene->model->nev) return 0;
  for (int place = 0; place < 2; place++) {
    for (int i = 0; i < f->n; i++) f->at[i] = f->probe->now[i] + place * 0.1 * (1 + i % 3);
    if (driven_at(f, f->t0, f->at, f->up)) continue;
    for (size_t k = 0; k < sizeof times / sizeof *times; k++)
      if (driven_at(f, f->t0 + times[k], f->at, f->down) || differ(driven_numbers(f), f->up, f->down)) return 1;
  }
  return 0;
}

int lag_flow_shifts(FlowMap *f, int k, const int *q) {
  const double rounding = 1e-8; /* of light masses */
  int seen = 0;
  for (int place = 0; place < 5; place++) {
    double t = f->t0 + 0.7548776662 * place, size = 0, off = 0;
    for (int j = 0; j < f->n; j++)
      f->at[j] = f->probe->begin[j] + 0.1 * ((place + j) % 3) * lag_difference_scale(&f->probe->pb, f->probe->begin, j);
    if (driven_at(f, t, f->at, f->up)) continue;
    for (int i = 0; i < k; i++) f->at[q[i]] += 0.37 * lag_difference_scale(&f->probe->pb, f->probe->begin, q[0]);
    if (driven_at(f, t, f->at, f->down)) return 0;
    for (int j = 0; j < driven_numbers(f); j++) {
      double weight = driven_weight(f, f->up, j);
      size = fmax(size, weight * fabs(f->up[j])), off = fmax(off, weight * fabs(f->up[j] - f->down[j]));
    }
    if (!(off <= rounding * size)) return 0;
    seen = 1;
  }
  return seen;
}

int lag_flow_has_symmetry(FlowMap *f, const StateMap *map, double later) {
  const double rounding = 1e-8; /* of light masses */
  int n = map->n, seen = 0;
  double *y = f->at, *image = f->up, *rates = f->down, *other = f->square, *mapped = other + n;
  for (int place = 0; place < 5; place++) {
    double past = 0.7548776662 * place, size = 0, off = 0, t = f->t0 + past;
    for (int i = 0; i < n; i++)
      y[i] = f->probe->begin[i] + 0.1 * ((place + i) % 3) * lag_difference_scale(&f->probe->pb, f->probe->begin, i);
    lag_map_apply(map, y, image);
    if (lag_flow_rates(f, t, y, rates)) continue;
    if (lag_flow_rates(f, map->reverses ? f->t0 - past : t + later, image, other)) return 0;
    lag_map_apply(map, rates, mapped);
    for (int i = 0; i < n; i++) {
      size = fmax(size, fabs(mapped[i]));
      off = fmax(off, fabs(other[i] - (map->reverses ? -mapped[i] : mapped[i])));
    }
    if (!(off <= rounding * size)) return 0;
    seen = 1;
  }
  return seen;
}

int lag_flow_open(FlowMap *f, lag_sim *like) {
  size_t n = (size_t)like->pb.n, nq = (size_t)like->pb.nq, driven = n + (size_t)like->scene->model->nev;
  const lag_constraints *of = like->scene->model->constraints;
  size_t rows = of ? (size_t)of->n : 0;
  *f = (FlowMap){.like = like, .n = like->pb.n, .nq = like->pb.nq, .t0 = like->scene->t0};
  const lag_part parts[] = {{&f->at, n}, {&f->up, driven}, {&f->down, driven}, {&f->mass, nq * nq},
      {&f->linear, lag_linear_work(like->scene->model) + 1}, {&f->room, n * n + (rows + 1) * (nq + 1) + driven},
      {&f->square, 2 * n * n + (nq + 1) * (nq + 1)},
      {&f->jumps, (size_t)lag_sim_ncharges(like) + 1}, {&f->rates, n}};
  lag_pool_parts(&f->pool, sizeof parts / sizeof *parts, parts);
  if (f->pool.failed) return keep_message(f, NULL, LAG_ENOMEM);
  int rc = renew_probe(f);
  double kick = 0;
  if (rc == LAG_OK) fits_kicks(f, 0, &kick);
  f->kicks = kick > 0;
  f->forced = rc == LAG_OK && (kick > 0 || depends_on_time(f));
  return rc;
}

void lag_flow_free(FlowMap *f) {
  lag_sim_free(f->probe);
  lag_pool_free(&f->pool);
}

typedef struct StepLimit {
  FlowMap *f;
  double resolution; /* longest step times the fastest rate */
  double fastest;    /* of the steps before, each counting less */
} StepLimit;

/* The fastest rate of neighbouring motions at y, t; 0: it is not known. */
static double rate_at(FlowMap *f, lag_problem *pb, double t, const double *y) {
  int n = f->n, nq = f->nq;
  double *J = f->room, *A = f->square, *B = A + n * n;
  if (!pb->model->linear && !pb->model->constraints) return 0;
  if (lag_jacobian(pb, t, y, J, f->linear) || lag_not_finite((n - nq) * n, J) >= 0) return 0;
  memset(A, 0, (size_t)(nq * n) * sizeof *A);
  for (int i = 0; i < nq; i++) A[i * n + nq + i] = 1;
  memcpy(A + nq * n, J, (size_t)((n - nq) * n) * sizeof *A);
  return lag_fastest_rate(n, A, B);
}

/* Limits the next step to the fastest rate of neighbouring motions, now and shortly before: where the rate passes 0,
 * as of a spring whose stiffness is driven, a motion at rest has no error that keeps steps short. */
static int limit_step(void *limit, const lag_sim *run) {
  const double kept = 0.7;
  StepLimit *l = limit;
  lag_problem *pb = &((lag_sim *)run)->pb;
  double driven = l->f->drive > 0 ? 2 * acos(-1) / l->f->drive : 0;
  l->fastest = fmax(fmax(rate_at(l->f, pb, run->run->t, run->now), driven), kept * l->fastest);
  pb->longest = l->fastest > 0 ? l->resolution / l->fastest : 0;
  return 0;
}

/* A run with a tangent: one step of order p has an error of about (step rate)^(p + 1) / (p + 1)! of each column. */
static int advance_with_tangent(FlowMap *f, lag_sim *sim, double t) {
  enum { LOOKS = 8 };
  double order = sim->method->order, t0 = sim->scene->t0;
  StepLimit limit = {f, fmin(0.5, pow(sim->tol * tgamma(order + 2), 1 / (order + 1))), 0};
  int rc = lag_sim_set_tangent(sim, f->n, NULL);
  if (rc) return rc;
  for (int k = 1; k < LOOKS && f->forced; k++)
    limit.fastest = fmax(limit.fastest, rate_at(f, &sim->pb, t0 + (t - t0) * k / LOOKS, sim->start));
  limit_step(&limit, sim);
  lag_sim_on_step(sim, limit_step, &limit);
  return lag_sim_advance(sim, t);
}

int lag_flow_contacts(const FlowMap *f) { return f->like->scene->model->ncontacts > 0; }

int lag_flow_is_open(FlowMap *f, double t, const double *y) {
  const lag_model *m = f->like->scene->model;
  int k = lag_contact_not_open(f->probe, t, y);
  if (k >= 0)
    snprintf(f->message, sizeof f->message,
             "contact %s closes: states beyond are held by its force, and are not followed",
             m->constraints->of[m->contacts[k].constraint].name);
  return k == -1;
}

/* d[n] := derivative of the end by the start in direction b[n], column j of B[n k] in units: differences of order 4. */
static int end_slope(FlowMap *f, double t, double dt, const double *y0, const double *b, int k, double *d) {
  static const double weight[] = {2.0 / 3, -1.0 / 12};
  const double h = 0x1p-11;
  double *start = f->down, *end = f->square;
  int rc = LAG_OK;
  memset(d, 0, (size_t)f->n * sizeof *d);
  for (int e = 0; e < 4 && rc == LAG_OK; e++) {
    double off = (e % 2 ? -1 : 1) * (1 + e / 2) * h;
    for (int i = 0; i < f->n; i++) start[i] = y0[i] + off * b[i * k] * f->at[i];
    rc = lag_flow_run(f, t, dt, start, end, NULL);
    for (int i = 0; i < f->n; i++) d[i] += (off < 0 ? -1 : 1) * weight[e / 2] * end[i] / h;
  }
  return rc;
}

/* Phi := derivatives of the end by the start, on the tangent space of the constraints, by differences of runs. */
static int end_derivatives(FlowMap *f, double t, double dt, const double *y0, double *Phi) {
  int n = f->n, k = 0;
  Pool pool = {0};
  double *B = lag_pool_doubles(&pool, (size_t)(n * n)), *d = lag_pool_doubles(&pool, (size_t)n);
  for (int i = 0; i < n; i++) f->at[i] = lag_difference_scale(&f->probe->pb, y0, i);
  int rc = B && d ? lag_flow_tangent_basis(f, &pool, t, y0, f->at, B, &k) : LAG_ENOMEM;
  memset(Phi, 0, (size_t)(n * n) * sizeof *Phi);
  for (int j = 0; j < k && rc == LAG_OK; j++) {
    rc = end_slope(f, t, dt, y0, B + j, k, d);
    for (int e = 0; e < n * n && rc == LAG_OK; e++) Phi[e] += d[e / n] * B[e % n * k + j] / f->at[e % n];
  }
  lag_pool_free(&pool);
  return rc;
}

int lag_flow_run(FlowMap *f, double t, double dt, const double *y0, double *y1, double *Phi) {
  int differences = Phi && f->differences, rc = differences ? end_derivatives(f, t, dt, y0, Phi) : LAG_OK;
  if (rc) return rc;
  lag_sim *sim = lag_flow_sim(f, t, y0);
  if (!sim) return keep_message(f, NULL, LAG_ENOMEM);
  double end = t + dt + (f->kicks ? 32 * DBL_EPSILON * fmax(fabs(t), fabs(dt)) : 0); /* a kick there is of this run */
  rc = Phi && !differences ? advance_with_tangent(f, sim, end) : lag_sim_advance(sim, end);
  if (rc == LAG_EMETHOD && Phi && !differences && lag_flow_contacts(f)) { /* from here on: one map has one precision */
    lag_sim_free(sim);
    f->differences = 1;
    return lag_flow_run(f, t, dt, y0, y1, Phi);
  }
  rc = rc || !Phi || differences ? rc : lag_sim_tangent(sim, Phi);
  for (int k = 0; k < lag_sim_ncharges(sim); k++)
    if (sim->charges[k].jumped > 1e-12 * sim->charges[k].size) f->jumps[k] = 1;
  f->stopped = rc == LAG_STOPPED;
  if (f->stopped)
    snprintf(f->message, sizeof f->message, "an event ends the motion at t = %s s", LAG_TEXT(lag_sim_time(sim)));
  else if (rc) keep_message(f, sim, rc);
  memcpy(y1, sim->now, (size_t)f->n * sizeof *y1);
  if (rc == LAG_OK && lag_rhs(&sim->pb, sim->run->t, sim->now, f->rates)) f->rates[0] = NAN;
  lag_sim_free(sim);
  return rc;
}

int lag_flow_rates(FlowMap *f, double t, const double *y, double *rates) { return lag_rhs(&f->probe->pb, t, y, rates); }

/* ---- The drive */

enum { DRIVE_SAMPLES = 12, DRIVE_LOOKS = 4000 };

/* Rates of change at time t of a state that differs from sample to sample, or of its image by `map`. */
static int sample_rates(FlowMap *f, int k, double t, const StateMap *map, double *rates) {
  double *y = map ? f->square : f->at;
  for (int i = 0; i < f->n; i++)
    y[i] = f->probe->begin[i] + 0.1 * (k % 3) * lag_difference_scale(&f->probe->pb, f->probe->begin, i);
  if (map) lag_map_apply(map, y, f->at);
  return driven_at(f, t, f->at, rates);
}

/* The same at the begin of a period: the image of the rates. Which event functions are exchanged is not known. */
static int first_rates(FlowMap *f, int k, double t, double *rates) {
  int rc = sample_rates(f, k, t, NULL, rates);
  if (!f->closing) return rc;
  memcpy(f->square, rates, (size_t)f->n * sizeof *rates);
  lag_map_apply(f->closing, f->square, rates);
  return rc;
}

/* Difference of the rates a time T later, relative to them, and *step: the change of T that makes it least, to first
 * order. */
static double drive_difference(FlowMap *f, double T, double *step) {
  double off = 0, size = 0, along = 0, slope = 0, h = 1e-6 * T, *a = f->up, *b = f->down, *c = f->room;
  int numbers = f->closing ? f->n : driven_numbers(f);
  for (int k = 0; k < DRIVE_SAMPLES; k++) {
    double t = f->t0 + 0.7548776662 * (k + 0.3) * T / DRIVE_SAMPLES * 1.3;
    const StateMap *map = f->closing;
    if (first_rates(f, k, t, a) || sample_rates(f, k, t + T - h, map, b) || sample_rates(f, k, t + T + h, map, c))
      return HUGE_VAL;
    for (int i = 0; i < numbers; i++) c[i] = (c[i] - b[i]) / (2 * h);
    if (sample_rates(f, k, t + T, map, b)) return HUGE_VAL;
    for (int i = 0; i < numbers; i++) {
      double weight = driven_weight(f, a, i), w = weight * weight;
      off += w * (b[i] - a[i]) * (b[i] - a[i]);
      size += w * (a[i] * a[i] + b[i] * b[i]);
      along += w * (b[i] - a[i]) * c[i];
      slope += w * c[i] * c[i];
    }
  }
  *step = slope > 0 ? -along / slope : 0;
  return size > 0 ? sqrt(off / size) : 0;
}

/* after[n] := the state after the action of kick k at y, t. */
static int kicked(FlowMap *f, int k, double t, const double *y, double *after) {
  lag_sim *s = f->probe;
  const lag_model *m = s->scene->model;
  int nq = m->nq, stop = 0, rc = lag_inputs(&s->pb, t);
  memcpy(after, y, (size_t)f->n * sizeof *after);
  if (rc || !m->act) return rc;
  return m->act(m, k, t, y, y + nq, y + 2 * nq, s->p, s->u, after, after + nq, after + 2 * nq, &stop, s->work);
}

/* Difference of the actions of kicks a time T later, relative to the change that they make. */
static double kick_difference(FlowMap *f, double T) {
  enum { KICKS = 48 };
  double off = 0, size = 0, *a = f->up, *b = f->down, *image = f->square, period;
  for (int k = 0; k < f->like->scene->model->nev; k++) {
    if (!lag_is_kick(f->like->scene->model, k)) continue;
    if (lag_events_eval(f->probe, f->t0, f->probe->now, f->probe->g1)) return HUGE_VAL;
    period = f->probe->g1[k];
    for (int j = 1; j <= KICKS; j++) {
      const double *y = f->at;
      for (int i = 0; i < f->n; i++)
        f->at[i] = f->probe->begin[i] + 0.1 * (j % 3) * lag_difference_scale(&f->probe->pb, f->probe->begin, i);
      if (kicked(f, k, f->t0 + j * period, y, a)) return HUGE_VAL;
      for (int i = 0; i < f->n; i++) size += (a[i] - y[i]) * (a[i] - y[i]);
      if (f->closing) {
        memcpy(b, a, (size_t)f->n * sizeof *b);
        lag_map_apply(f->closing, b, a);
        lag_map_apply(f->closing, y, image);
        y = image;
      }
      if (kicked(f, k, f->t0 + j * period + T, y, b)) return HUGE_VAL;
      for (int i = 0; i < f->n; i++) off += (b[i] - a[i]) * (b[i] - a[i]);
    }
  }
  return size > 0 ? sqrt(off / size) : off > 0 ? HUGE_VAL : 0;
}

double lag_flow_drive(FlowMap *f, double *T) {
  double kick, step = 0;
  fits_kicks(f, 0, &kick);
  if (kick > 0) {
    *T = kick * fmax(1, rint(*T / kick));
    return fits_kicks(f, *T, &kick) ? fmax(drive_difference(f, *T, &step), kick_difference(f, *T)) : HUGE_VAL;
  }
  double off = drive_difference(f, *T, &step);
  for (int k = 0; k < 20 && isfinite(off); k++) {
    double next = *T + fmin(fmax(step, -*T / 8), *T / 8), further, now = drive_difference(f, next, &further);
    if (!(now < off)) break;
    *T = next;
    off = now;
    step = further;
  }
  return off;
}

double lag_flow_find_drive(FlowMap *f, double longest) {
  const double same = 1e-9;
  double step, before = 0, now = 0, kick;
  fits_kicks(f, 0, &kick);
  for (int k = 1; kick > 0; k++) {
    double T = k * kick;
    if (k > 1 && (T > longest || k > DRIVE_LOOKS)) return 0;
    if (fits_kicks(f, T, &kick) && lag_flow_drive(f, &T) < same) return T;
  }
  for (int k = 1; k <= DRIVE_LOOKS; k++) { /* a local minimum of the difference, which is 0 */
    double T = longest * k / DRIVE_LOOKS, next = drive_difference(f, T, &step);
    if (k > 2 && now <= before && now <= next) {
      T -= longest / DRIVE_LOOKS;
      if (lag_flow_drive(f, &T) < same) return T;
    }
    before = now;
    now = next;
  }
  return 0;
}

/* ---- Charges */

int lag_flow_charges(const FlowMap *f) { return lag_sim_ncharges(f->probe); }

int lag_flow_conserves(const FlowMap *f, int k) {
  return (lag_charge_flags(f->probe, k) & LAG_CONSERVED) && f->jumps[k] == 0;
}

double lag_flow_charge(FlowMap *f, int k, double t, const double *y) {
  lag_charges_at(f->probe, t, y);
  return f->probe->charge_now[2 * k];
}

static const double stencil[] = {0.8, -0.2, 4.0 / 105, -1.0 / 280};

/* Derivative of charge k by component i at y, t, by differences of half-width 4 h; y is restored. */
static double slope_within(FlowMap *f, int k, double t, double *y, int i, double h) {
  double was = y[i], sum = 0;
  h = (was + h) - was; /* a number of 53 bits */
  for (int j = 1; j <= 4; j++) {
    y[i] = was + j * h;
    double up = lag_flow_charge(f, k, t, y);
    y[i] = was - j * h;
    sum += stencil[j - 1] * (up - lag_flow_charge(f, k, t, y));
  }
  y[i] = was;
  return sum / h;
}

/* The same on the branch of each switch at y, by those two widths that agree best: near a singularity, as where bodies
 * meet, narrow ones. */
static double slope(FlowMap *f, int k, double t, double *y, int i) {
  enum { LEVELS = 9 };
  double h = 0x1p-4 * lag_difference_scale(&f->probe->pb, y, i), best = NAN, least = HUGE_VAL, before = NAN;
  if (lag_switch_hold_sides(f->probe, t, y)) return NAN;
  for (int level = 0; level < LEVELS; level++, h /= 3) {
    double now = slope_within(f, k, t, y, i, h), off = fabs(now - before);
    if (off < least || (isnan(best) && isfinite(now))) best = now;
    if (off < least) least = off;
    before = now;
  }
  for (int j = 0; j < f->probe->scene->model->nmodes; j++) lag_switch_hold(f->probe, j, LAG_FREE);
  return best;
}

int lag_flow_gradient(FlowMap *f, int k, double t, const double *y, double *d) {
  memcpy(f->at, y, (size_t)f->n * sizeof *y);
  for (int i = 0; i < f->n; i++) d[i] = slope(f, k, t, f->at, i);
  return lag_not_finite(f->n, d) >= 0 ? LAG_EDOMAIN : LAG_OK;
}

/* f->mass := the mass matrix at y, t. */
static int mass_matrix(FlowMap *f, double t, const double *y) {
  lag_problem *pb = &f->probe->pb;
  if (pb->model->constraints) {
    double *A = f->room, *unit = A + pb->model->constraints->n * f->nq;
    return lag_constraint_jacobian(pb, t, y, A, unit, f->mass);
  }
  return pb->model->linear && f->nq ? lag_linearise(pb, t, y, NULL, f->room, f->mass, f->linear) : LAG_EMETHOD;
}

/* xi[nq] := M^-1 dQ/dv of charge k at y[n], which is changed and restored. */
static int shift_of(FlowMap *f, int k, double t, double *y, double *xi) {
  int rc = mass_matrix(f, t, y);
  if (rc) return rc;
  for (int i = 0; i < f->nq; i++) xi[i] = slope(f, k, t, y, f->nq + i);
  return lag_solve_dense((size_t)f->nq, 1, f->mass, xi) ? LAG_ESINGULAR : LAG_OK;
}

int lag_flow_field(FlowMap *f, int k, double t, const double *y, double *X) {
  int n = f->n, nq = f->nq, rc = lag_flow_rates(f, t, y, f->up);
  if (k == 0 || rc) return memcpy(X, f->up, (size_t)n * sizeof *X), rc;
  memcpy(f->at, y, (size_t)n * sizeof *y);
  if ((rc = shift_of(f, k, t, f->at, X)) != 0) return rc;
  double fastest = 0;
  for (int i = 0; i < n; i++) fastest = fmax(fastest, fabs(f->up[i]) / lag_difference_scale(&f->probe->pb, y, i));
  double h = fastest > 0 ? 0x1p-6 / fastest : 1;
  memset(X + nq, 0, (size_t)(n - nq) * sizeof *X);
  for (int j = -4; j <= 4 && rc == LAG_OK; j++) { /* the rate of xi along the motion */
    if (j == 0) continue;
    for (int i = 0; i < n; i++) f->at[i] = y[i] + j * h * f->up[i];
    rc = shift_of(f, k, t + j * h, f->at, f->down);
    for (int i = 0; i < nq; i++) X[nq + i] += (j < 0 ? -stencil[-j - 1] : stencil[j - 1]) * f->down[i] / h;
  }
  return rc;
}

/* G[nq][nq + 1] := derivatives of xi by the coordinates, with y and all its components moved by `off`. */
static int linear_part(FlowMap *f, int k, double t, const double *y, double off, double *G) {
  int nq = f->nq, size = nq + 1, rc = LAG_OK;
  memset(G, 0, (size_t)size * (size_t)size * sizeof *G);
  for (int e = 0; e < 2 * nq && rc == LAG_OK; e++) {
    int j = e / 2, side = e % 2 ? 1 : -1;
    for (int i = 0; i < f->n; i++) f->at[i] = y[i] + off * (1 + i % 5);
    double h = 0.25 * lag_difference_scale(&f->probe->pb, y, j);
    f->at[j] += side * h;
    rc = shift_of(f, k, t, f->at, f->down);
    for (int i = 0; i < nq; i++) G[i * size + j] += side * f->down[i] / (2 * h);
  }
  return rc;
}

int lag_flow_affine(FlowMap *f, int k, double t, const double *y, double *G) {
  const double same = 1e-7, rounding = 1e-9;
  int nq = f->nq, size = nq + 1;
  double *other = f->square, most = 0;
  int rc = linear_part(f, k, t, y, 0.03, other);
  rc = rc ? rc : linear_part(f, k, t, y, 0, G);
  for (int e = 0; e < size * size && rc == LAG_OK; e++) {
    most = fmax(most, fabs(G[e] - other[e]));
    double half = rint(2 * G[e]) / 2; /* coefficients of proved symmetries are halves, mostly */
    G[e] = fabs(G[e] - half) < rounding ? half : G[e];
  }
  memcpy(f->at, y, (size_t)f->n * sizeof *y);
  rc = rc ? rc : most > same ? LAG_EMETHOD : shift_of(f, k, t, f->at, f->down);
  for (int i = 0; i < nq && rc == LAG_OK; i++) {
    G[i * size + nq] = f->down[i];
    for (int j = 0; j < nq; j++) G[i * size + nq] -= G[i * size + j] * y[j];
  }
  return rc;
}

int lag_flow_tangent_basis(FlowMap *f, Pool *pool, double t, const double *y, const double *unit, double *B, int *k) {
  const double least = 1e-7;
  int n = f->n;
  lag_problem *pb = &f->probe->pb;
  double *Y = lag_pool_doubles(pool, (size_t)(n * n)), *V = lag_pool_doubles(pool, (size_t)(n * n)),
         *sigma = lag_pool_doubles(pool, (size_t)n),
         *scratch = lag_pool_doubles(pool, lag_tangent_projection_size(pb) + 1);
  if (pool->failed) return LAG_ENOMEM;
  for (int e = 0; e < n * n; e++) B[e] = Y[e] = e % (n + 1) == 0;
  *k = n;
  if (!pb->model->constraints) return LAG_OK;
  int rc = lag_tangent_project(pb, t, y, n, Y, scratch);
  for (int e = 0; e < n * n; e++) Y[e] *= unit[e % n] / unit[e / n];
  lag_singular_values(n, n, Y, V, sigma);
  for (*k = 0; *k < n && sigma[*k] > least * sigma[0];) ++*k;
  for (int r = 0; r < n; r++)
    for (int j = 0; j < *k; j++) B[r * *k + j] = Y[r * n + j] / sigma[j];
  return rc;
}

int lag_flow_is_angle(const lag_model *m, int i) {
  return i < m->nq ? m->q[i].periodic : i >= 2 * m->nq && m->z[i - 2 * m->nq].periodic;
}

double lag_flow_change(const lag_model *m, int i, const double *y, const double *y0) {
  double d = y[i] - y0[i], turn = 2 * acos(-1);
  return lag_flow_is_angle(m, i) ? d - turn * rint(d / turn) : d;
}
