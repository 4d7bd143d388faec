/* Equations of states of rest and of periodic motions over a parameter (branch_problems.h). */
#include "analysis/branch_problems.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/finite_difference.h"
#include "analysis/steady_motion.h"
#include "numeric/dense.h"

/* ---- States of rest */

/* Component of the state that unknown i is. */
static int component(const RestBranch *r, int i) { return i < r->flow.nq ? i : r->flow.nq + i; }

/* Unknowns u[cols] become the state and the parameter. */
static int place_rest(void *of, const double *u) {
  RestBranch *r = of;
  for (int i = 0; i < r->n; i++) r->y[component(r, i)] = u[i] * r->unit[i];
  r->parameter = u[r->n] * r->parameter_unit;
  r->flow.message[0] = '\0';
  int rc = lag_flow_set(&r->flow, r->name, r->parameter);
  rc = rc || lag_flow_is_open(&r->flow, r->flow.t0, r->y) ? rc : LAG_EDOMAIN;
  rc = rc ? rc : lag_flow_rates(&r->flow, r->flow.t0, r->y, r->rates);
  return rc || lag_not_finite(2 * r->flow.nq + r->n - r->flow.nq, r->rates) >= 0 ? LAG_EDOMAIN : LAG_OK;
}

/* out[rows] := accelerations, rates of states and residuals of constraints on positions at the present state and
 * parameter. */
static int balance(RestBranch *r, double *out) {
  int nq = r->flow.nq, rc = lag_flow_rates(&r->flow, r->flow.t0, r->y, r->rates);
  memcpy(out, r->rates + nq, (size_t)r->n * sizeof *out);
  if (rc || r->rows == r->n) return rc;
  return lag_residuals(&r->flow.probe->pb, r->flow.t0, r->y, out + r->n, out + r->rows);
}

/* Unknown k of the column that is made, the parameter behind the state; and its balance at another value. */
typedef struct RestColumn {
  RestBranch *r;
  int k;
} RestColumn;

static int balance_at(void *of, double x, double *out) {
  RestBranch *r = ((RestColumn *)of)->r;
  int k = ((RestColumn *)of)->k, rc = LAG_OK;
  if (k < r->n) r->y[component(r, k)] = x;
  else rc = lag_flow_set(&r->flow, r->name, x);
  return rc ? rc : balance(r, out);
}

/* Column k of J by differences of order 4, of states and of the parameter alike. */
static int column(RestBranch *r, int k, double *J) {
  const double part = 0x1p-10;
  RestColumn of = {r, k};
  double was = k < r->n ? r->y[component(r, k)] : r->parameter, unit = k < r->n ? r->unit[k] : r->parameter_unit;
  FiniteDifference d = {.order = 4, .n = r->rows, .stride = r->cols, .h = part * unit, .part = part, .out = r->up};
  int rc = lag_finite_difference(&d, balance_at, &of, was, J + k);
  if (k < r->n) r->y[component(r, k)] = was;
  else rc = rc ? rc : lag_flow_set(&r->flow, r->name, was);
  return rc;
}

static int rest_system(void *of, double *J, double *b) {
  RestBranch *r = of;
  int n = r->rows, cols = r->cols, rc = balance(r, r->down);
  memset(J, 0, (size_t)(n * cols) * sizeof *J);
  for (int k = 0; k < cols && rc == LAG_OK; k++) rc = column(r, k, J);
  for (int i = 0; i < n && rc == LAG_OK; i++) {
    double size = 0;
    for (int k = 0; k < cols; k++) size = fmax(size, fabs(J[i * cols + k]));
    if (r->row[i] == 0.0) r->row[i] = size > 0 ? size : 1;
  }
  for (int i = 0; i < n && rc == LAG_OK; i++) {
    for (int k = 0; k < cols; k++) J[i * cols + k] /= r->row[i];
    b[i] = -r->down[i] / r->row[i];
  }
  return rc;
}

/* J[n n] := its part in the tangent space of the constraints, k by k. */
static int within_constraints(RestBranch *r, double *J, int *k) {
  Pool pool = {0};
  int n = r->flow.n;
  double *B = lag_pool_doubles(&pool, 2 * (size_t)(n * n)), *JB = B ? B + n * n : NULL, *unit = r->room;
  for (int i = 0; i < n; i++) unit[i] = lag_difference_scale(&r->flow.probe->pb, r->y, i);
  int rc = B ? lag_flow_tangent_basis(&r->flow, &pool, r->flow.t0, r->y, unit, B, k) : LAG_ENOMEM;
  for (int i = 0; i < n * *k && rc == LAG_OK; i++)
    for (int l = 0; l < n; l++) JB[i] += J[i / *k * n + l] * unit[l] / unit[i / *k] * B[l * *k + i % *k];
  for (int i = 0; i < *k * *k && rc == LAG_OK; i++) {
    J[i] = 0;
    for (int l = 0; l < n; l++) J[i] += B[l * *k + i / *k] * JB[l * *k + i % *k];
  }
  lag_pool_free(&pool);
  return rc;
}

/* Rates of small motion. */
static int rest_spectrum(void *of, Spectrum *s) {
  RestBranch *r = of;
  int n = r->flow.n, nq = r->flow.nq;
  double *J = r->J;
  s->n = n;
  memset(J, 0, (size_t)(n * n) * sizeof *J);
  for (int i = 0; i < nq; i++) J[i * n + nq + i] = 1;
  int rc = lag_fine_jacobian(&r->flow.probe->pb, NULL, r->flow.t0, r->y, J + nq * n, r->flow.linear);
  rc = rc || r->rows == r->n ? rc : within_constraints(r, J, &s->n);
  return rc ? rc : r->algebra->general(s->n, J, s->re, s->im, r->v, r->v + n * n, r->v + 2 * n * n);
}

/* y := the state of rest next to the start, at the parameter's first value. */
static int find_rest(RestBranch *r) {
  Equilibrium rest = {0};
  int rc = lag_flow_set(&r->flow, r->name, r->parameter);
  if (rc) return rc;
  SteadyMotion steady = {0};
  int found = r->flow.probe->pb.model->constraints ? lag_steady_find(&steady, &rest, r->flow.probe, r->algebra, 0)
                                                   : lag_equilibrium_find(&rest, r->flow.probe, r->algebra);
  if (found > 0) memcpy(r->y, rest.y, (size_t)r->flow.n * sizeof *r->y);
  lag_steady_free(&steady);
  lag_equilibrium_free(&rest);
  if (found > 0) return LAG_OK;
  snprintf(
      r->flow.message, sizeof r->flow.message,
      "no state of rest found near the start: start near one: name=VALUE; for periodic motions write about how long "
      "they take: --guess T");
  return LAG_EDOMAIN;
}

static int refuse(RestBranch *r, const char *words) {
  snprintf(r->flow.message, sizeof r->flow.message, "%s", words);
  return LAG_EMETHOD;
}

int lag_rest_branch_open(RestBranch *r, lag_sim *like, const lag_algebra *algebra, const char *name, double value,
                         double size) {
  const lag_model *m = like->scene->model;
  size_t n = (size_t)(like->pb.nq + like->pb.nz), all = (size_t)like->pb.n;
  *r = (RestBranch){
      .algebra = algebra, .n = (int)n, .cols = (int)n + 1, .name = name, .parameter = value, .parameter_unit = size};
  const lag_constraints *of = m->constraints;
  size_t rows = n + (size_t)(of ? of->nholonomic : 0), residuals = rows + (size_t)(of ? of->n : 0);
  r->rows = (int)rows;
  int rc = lag_flow_open(&r->flow, like);
  if (rc) return rc;
  if (r->flow.forced)
    return refuse(r, "the scene depends on time, so that nothing rests: continue its periodic motions: "
                     "--guess T");
  const lag_part parts[] = {{&r->unit, n}, {&r->row, rows}, {&r->y, all}, {&r->rates, all}, {&r->up, residuals},
      {&r->down, residuals}, {&r->J, all * all}, {&r->v, 3 * all * all}, {&r->room, 2 * all}};
  lag_pool_parts(&r->pool, sizeof parts / sizeof *parts, parts);
  if (r->pool.failed) return refuse(r, "out of memory"), LAG_ENOMEM;
  if ((rc = find_rest(r)) != LAG_OK) return rc;
  for (int i = 0; i < r->n; i++) {
    int at = component(r, i);
    r->unit[i] = lag_difference_scale(&r->flow.probe->pb, r->y, at);
  }
  r->problem = (BranchProblem){.of = r,
                               .rows = r->rows,
                               .cols = r->cols,
                               .eigenvalues = r->flow.n,
                               .place = place_rest,
                               .system = rest_system,
                               .spectrum = rest_spectrum,
                               .pairs = (lag_facts(&r->flow.probe->pb) & LAG_CONSERVES_ENERGY) != 0};
  return LAG_OK;
}

void lag_rest_branch_free(RestBranch *r) {
  lag_flow_free(&r->flow);
  lag_pool_free(&r->pool);
}

void lag_rest_branch_unknowns(const RestBranch *r, double *u) {
  for (int i = 0; i < r->n; i++) u[i] = r->y[component(r, i)] / r->unit[i];
  u[r->n] = r->parameter / r->parameter_unit;
}

/* ---- Periodic motions */

/* y[n] := the state at the Hopf point, moved along the real part of the mode with frequency *w; returns the
 * component that moves most, by `part` of its size. */
static int along_mode(RestBranch *r, double part, double *y, double *w) {
  int n = r->flow.n, k = 0, most = 0;
  double *re = r->room, *im = re + n, size = 0;
  Spectrum s = {0, re, im};
  if (r->rows > r->n || rest_spectrum(r, &s)) return -1; /* modes have other components with constraints */
  for (int i = 0; i < n; i++)                            /* the pair nearest to the axis */
    if (im[i] > 0 && (im[k] <= 0 || fabs(re[i]) < fabs(re[k]))) k = i;
  *w = im[k];
  for (int i = 0; i < n; i++) {
    double moved = fabs(r->v[i * n + k]) / lag_difference_scale(&r->flow.probe->pb, r->y, i);
    if (moved > size) most = i, size = moved;
  }
  for (int i = 0; i < n; i++) y[i] = r->y[i] + part / size * r->v[i * n + k];
  return most;
}

int lag_hopf_orbit(RestBranch *r, const BranchPoint *at, PeriodicOrbit *o, lag_sim **like, BranchProblem *p,
                   double **d) {
  const double part = 0.02, larger = 10; /* first amplitude; units of the branch in it */
  double w = 0, *y = lag_pool_doubles(&r->pool, (size_t)r->flow.n);
  if (!y) return LAG_ENOMEM;
  if (place_rest(r, at->u)) return 0;
  int most = along_mode(r, part, y, &w), n = r->flow.n;
  if (most < 0 || !(w > 0) || !(*like = lag_flow_sim(&r->flow, r->flow.t0, y))) return *like ? 0 : LAG_ENOMEM;
  (*like)->scene = r->flow.like->scene;
  *o = (PeriodicOrbit){.nheld = 1,
                       .led = -1,
                       .name = r->name,
                       .parameter = r->parameter,
                       .parameter_unit = r->parameter_unit,
                       .continues = 1};
  o->held[0] = (OrbitHold){.kind = ORBIT_STATE, .of = most, .value = y[most]};
  int rc = lag_orbit_open(o, *like, r->algebra, 2 * acos(-1) / w, 0);
  rc = rc ? 0 : lag_flow_set(&o->flow, o->name, o->parameter) ? 0 : lag_orbit_solve(o);
  if (rc != 1) return rc == LAG_ENOMEM ? rc : 0;
  o->nheld = 0;
  for (int i = 0; i < n; i++) o->unit[i] *= larger;
  o->pairing = NAN;
  lag_orbit_branch(p, o);
  *d = lag_pool_doubles(&o->pool, (size_t)o->cols);
  if (!*d) return LAG_ENOMEM;
  for (int s = 0; s < o->m; s++)
    for (int i = 0; i < n; i++) (*d)[s * n + i] = (o->y[s * n + i] - r->y[i]) / o->unit[i];
  return 1;
}

void lag_orbit_branch_unknowns(const PeriodicOrbit *o, double *u) {
  int n = o->n, k = o->m * n;
  for (int i = 0; i < k; i++) u[i] = o->y[i] / o->unit[i % n];
  if (!o->flow.forced) u[k++] = o->T / o->time;
  for (int j = 0; j < o->ngroup; j++) u[k++] = o->shift[j];
  u[k] = o->parameter / o->parameter_unit;
}

/* Whether the motion has become a state of rest, where its period means nothing. */
static int shrinks(PeriodicOrbit *o) {
  const double least = 1e-3;
  double most = 0;
  if (o->flow.forced || lag_flow_rates(&o->flow, o->flow.t0, o->y, o->x)) return 0;
  for (int i = 0; i < o->n; i++) most = fmax(most, fabs(o->x[i]) * o->time / o->unit[i]);
  return most < least;
}

static int place_with(PeriodicOrbit *o, const double *u, int tangents) {
  int n = o->n, k = o->m * n;
  for (int i = 0; i < k; i++) o->y[i] = fabs(u[i]) < 1e-100 ? 0 : u[i] * o->unit[i % n]; /* steps halve zeros */
  if (!o->flow.forced) o->T = u[k++] * o->time;
  for (int j = 0; j < o->ngroup; j++) o->shift[j] = u[k++];
  o->flow.message[0] = '\0';
  if (!o->flow.forced && !lag_orbit_period_is_usual(o)) return LAG_EDOMAIN;
  if (lag_orbit_set_parameter(o, u[k] * o->parameter_unit)) return LAG_EDOMAIN;
  if (shrinks(o)) {
    snprintf(o->flow.message, sizeof o->flow.message, "the motion shrinks to a state of rest");
    return LAG_EDOMAIN;
  }
  return lag_orbit_shoot(o, tangents) ? LAG_EDOMAIN : LAG_OK;
}

static int place_orbit(void *of, const double *u) { return place_with(of, u, 1); }

static int orbit_residual(void *of, const double *u, double *b) {
  PeriodicOrbit *o = of;
  int rc = place_with(o, u, 0);
  if (rc == LAG_OK) lag_orbit_residual(o);
  memcpy(b, o->b, (size_t)o->rows * sizeof *b);
  return rc;
}

static int orbit_system(void *of, double *J, double *b) {
  PeriodicOrbit *o = of;
  int rc = lag_orbit_assemble(o);
  memcpy(J, o->A, (size_t)o->rows * (size_t)o->cols * sizeof *J);
  memcpy(b, o->b, (size_t)o->rows * sizeof *b);
  return rc;
}

/* Tangents over several segments between which small changes grow have singular values as small as their inverse. */
static double orbit_noise(void *of) { return ((PeriodicOrbit *)of)->flow.differences ? 1e-8 : 1e-11; }

static int orbit_spectrum(void *of, Spectrum *s) {
  PeriodicOrbit *o = of;
  int rc = lag_orbit_multipliers(o);
  s->n = rc ? 0 : o->nmultipliers;
  memcpy(s->re, o->re, (size_t)s->n * sizeof *s->re);
  memcpy(s->im, o->im, (size_t)s->n * sizeof *s->im);
  return rc;
}

/* Whether direction d only leads along the motion, as where a held place is a turning point: the energy over it turns
 * back there, and the family does not. */
static int orbit_stands(void *of, const double *u, const double *d) {
  const double most = 1e-3; /* the square of what is left across the motion */
  PeriodicOrbit *o = of;
  double along = 0, size = 0;
  if (o->flow.forced || o->led < 0 || place_orbit(o, u)) return 0;
  for (int i = 0; i < o->m * o->n; i++) {
    if (i % o->n == 0 && lag_flow_rates(&o->flow, o->flow.t0, o->y + i, o->x)) return 0;
    double rate = o->x[i % o->n] / o->unit[i % o->n];
    along += rate * d[i];
    size += rate * rate;
  }
  double all = lag_dot(o->cols, d, d);
  return all - along * along / size < most * all;
}

void lag_orbit_branch(BranchProblem *p, PeriodicOrbit *o) {
  lag_orbit_count(o);
  *p = (BranchProblem){.of = o,
                       .rows = o->rows,
                       .cols = o->cols,
                       .eigenvalues = o->n,
                       .forms = o->rows - o->m * o->n - o->nheld - (o->half ? o->n : 0),
                       .maps = 1,
                       .pairs = isfinite(o->pairing),
                       .place = place_orbit,
                       .system = orbit_system,
                       .residual = orbit_residual,
                       .noise = orbit_noise,
                       .spectrum = orbit_spectrum,
                       .stands = orbit_stands};
}
