/* Steady motions over a parameter (steady_branch.h). Rows: f(y) - X(y) with the field X of a sum of symmetries,
 * constraints, conditions, and one row across each symmetry. J. E. Marsden, Lectures on Mechanics (1992), chapter 4. */
#include "analysis/steady_branch.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/finite_difference.h"
#include "analysis/quotient_space.h"
#include "numeric/dense.h"

/* ---- Equations */

static double held_value(SteadyBranch *s, const OrbitHold *h, const double *y) {
  return h->kind == ORBIT_STATE ? y[h->of] : lag_flow_charge(&s->flow, h->of, s->flow.t0, y);
}


static double goal_of(const SteadyBranch *s, int k) { return k == s->led ? s->parameter : s->held[k].value; }

/* out[nrows + nheld] := rates, residuals of constraints, and conditions at the present state and parameter. */
static int values(SteadyBranch *s, double *out) {
  const SteadyMotion *m = &s->steady;
  const lag_constraints *of = s->flow.probe->scene->model->constraints;
  int rc = lag_flow_rates(&s->flow, s->flow.t0, m->y, out);
  if (rc == LAG_OK && of)
    rc = lag_residuals(&s->flow.probe->pb, s->flow.t0, m->y, out + m->n, out + m->n + of->nholonomic);
  for (int k = 0; k < s->nheld && rc == LAG_OK; k++) out[m->nrows + k] = held_value(s, &s->held[k], m->y);
  return rc;
}

static int set_parameter(SteadyBranch *s, double value) {
  int rc = s->led < 0 ? lag_flow_set(&s->flow, s->name, value) : LAG_OK;
  s->steady.sim = s->flow.probe;
  return rc;
}

/* Unknowns u[cols] become the state, the motion and the parameter. */
static int place(void *of, const double *u) {
  SteadyBranch *s = of;
  SteadyMotion *m = &s->steady;
  for (int i = 0; i < s->n; i++) m->y[i] = u[i] * m->unit[i];
  for (int k = 0; k < m->m; k++) m->c[k] = u[s->n + k] * s->rate;
  s->parameter = u[s->cols - 1] * s->parameter_unit;
  s->flow.message[0] = '\0';
  int rc = set_parameter(s, s->parameter);
  rc = rc || lag_flow_is_open(&s->flow, s->flow.t0, m->y) ? rc : LAG_EDOMAIN;
  rc = rc ? rc : values(s, s->up);
  return rc || lag_not_finite(m->nrows + s->nheld, s->up) >= 0 ? LAG_EDOMAIN : LAG_OK;
}

static int values_at(void *of, double parameter, double *out) {
  int rc = set_parameter(of, parameter);
  return rc ? rc : values(of, out);
}

/* The last column by differences of order 4. */
static int parameter_column(SteadyBranch *s, double *J) {
  const double part = 0x1p-10;
  int all = s->steady.nrows + s->nheld, col = s->cols - 1;
  if (s->led >= 0) {
    J[(s->steady.nrows + s->led) * s->cols + col] = -s->parameter_unit;
    return LAG_OK;
  }
  FiniteDifference d = {
      .order = 4, .n = all, .stride = s->cols, .h = part * s->parameter_unit, .part = part, .out = s->up};
  int rc = lag_finite_difference(&d, values_at, s, s->parameter, J + col);
  return rc ? rc : set_parameter(s, s->parameter);
}

/* Field X of symmetry k alone, in SI. */
static const double *field_of(SteadyBranch *s, int k) {
  memset(s->e, 0, (size_t)s->steady.m * sizeof *s->e);
  s->e[k] = 1;
  lag_steady_generator(&s->steady, s->e, s->steady.y, s->X, NULL);
  return s->X;
}

/* Columns of the symmetries, and rows across them: those that move the state. */
static void symmetries(SteadyBranch *s, double *J) {
  const SteadyMotion *m = &s->steady;
  for (int k = 0; k < m->m; k++) {
    const double *X = field_of(s, k);
    double size = 0, *row = J + (m->nrows + s->nheld + k) * s->cols;
    for (int i = 0; i < s->n; i++) {
      J[i * s->cols + s->n + k] = -X[i] * s->rate;
      size += X[i] * X[i] / (m->unit[i] * m->unit[i]);
    }
    for (int i = 0; i < s->n && size > 1e-16; i++) row[i] = X[i] / m->unit[i] / sqrt(size);
  }
}

static int conditions(SteadyBranch *s, double *J, double *b) {
  const SteadyMotion *m = &s->steady;
  int rc = LAG_OK;
  for (int k = 0; k < s->nheld && rc == LAG_OK; k++) {
    double *row = J + (m->nrows + k) * s->cols;
    b[m->nrows + k] = goal_of(s, k) - held_value(s, &s->held[k], m->y);
    if (s->held[k].kind == ORBIT_STATE) row[s->held[k].of] = m->unit[s->held[k].of];
    else rc = lag_flow_gradient(&s->flow, s->held[k].of, s->flow.t0, m->y, s->down);
    for (int i = 0; i < s->n && s->held[k].kind != ORBIT_STATE; i++) row[i] = s->down[i] * m->unit[i];
  }
  return rc;
}

/* f, G, X and DX at the present state. */
static int fields(SteadyBranch *s) {
  int rc = lag_steady_derivatives(&s->steady);
  lag_steady_generator(&s->steady, s->steady.c, s->steady.y, s->X, s->DX);
  return rc;
}

/* Rows by their largest derivative at the first state; those of symmetries have the length 1. */
static void scale_rows(SteadyBranch *s, double *J, double *b) {
  for (int r = 0; r < s->steady.nrows + s->nheld; r++) {
    double size = 0;
    for (int k = 0; k < s->cols; k++) size = fmax(size, fabs(J[r * s->cols + k]));
    if (s->row[r] == 0.0) s->row[r] = size > 0 ? size : 1;
    for (int k = 0; k < s->cols; k++) J[r * s->cols + k] /= s->row[r];
    b[r] /= s->row[r];
  }
}

static int system_of(void *of, double *J, double *b) {
  SteadyBranch *s = of;
  const SteadyMotion *m = &s->steady;
  int rc = fields(s);
  memset(J, 0, (size_t)s->rows * (size_t)s->cols * sizeof *J);
  memset(b, 0, (size_t)s->rows * sizeof *b);
  for (int r = 0; r < m->nrows && rc == LAG_OK; r++) {
    b[r] = (r < s->n ? s->X[r] : 0) - m->f[r];
    for (int i = 0; i < s->n; i++)
      J[r * s->cols + i] = (m->G[r * s->n + i] - (r < s->n ? s->DX[r * s->n + i] : 0)) * m->unit[i];
  }
  rc = rc ? rc : parameter_column(s, J);
  rc = rc ? rc : conditions(s, J, b);
  if (rc) return rc;
  symmetries(s, J);
  scale_rows(s, J, b);
  return LAG_OK;
}

/* ---- Rates of small motion in the frame that moves along */

/* L[n *nl] := gradients of conserved charges, R[n *nr] := directions of symmetries, in units and of length 1. */
static int invariants(SteadyBranch *s, double *L, int nl, double *R) {
  const SteadyMotion *m = &s->steady;
  int rc = LAG_OK;
  for (int k = 0, at = 0; k < lag_flow_charges(&s->flow) && rc == LAG_OK; k++) {
    if (!lag_flow_conserves(&s->flow, k)) continue;
    rc = lag_flow_gradient(&s->flow, k, s->flow.t0, m->y, s->down);
    for (int i = 0; i < s->n; i++) L[i * nl + at] = s->down[i] * m->unit[i];
    at++;
  }
  for (int k = 0; k < m->m; k++) {
    const double *X = field_of(s, k);
    for (int i = 0; i < s->n; i++) R[i * m->m + k] = X[i] / m->unit[i];
  }
  lag_normalise_columns(s->n, nl, L);
  lag_normalise_columns(s->n, m->m, R);
  return rc;
}

/* Basis of small motions without those along symmetries, within the levels of charges. */
static int other_motions(SteadyBranch *s, Pool *pool, Basis *b) {
  size_t n = (size_t)s->n;
  int nl = 0, nr = s->steady.m;
  for (int k = 0; k < lag_flow_charges(&s->flow); k++) nl += lag_flow_conserves(&s->flow, k);
  double *L = lag_pool_doubles(pool, n * ((size_t)nl + 1)), *R = lag_pool_doubles(pool, n * ((size_t)nr + 1));
  *b = (Basis){s->n, s->n, lag_pool_doubles(pool, n * n)};
  if (pool->failed) return LAG_ENOMEM;
  int rc = lag_flow_tangent_basis(&s->flow, pool, s->flow.t0, s->steady.y, s->steady.unit, b->B, &b->k);
  rc = rc ? rc : invariants(s, L, nl, R);
  rc = rc ? rc : lag_within_levels(pool, s->n, nl, L, &nr, R);
  rc = rc ? rc : lag_basis_take_out(pool, b, nl, L);
  return rc ? rc : lag_basis_take_out(pool, b, nr, R);
}

static int spectrum(void *of, Spectrum *p) {
  SteadyBranch *s = of;
  const SteadyMotion *m = &s->steady;
  Pool pool = {0};
  Basis b;
  size_t n = (size_t)s->n;
  double *A = lag_pool_doubles(&pool, 3 * n * n), *W = A + n * n, *v = lag_pool_doubles(&pool, 3 * n * n);
  int rc = fields(s);
  rc = pool.failed ? LAG_ENOMEM : rc ? rc : other_motions(s, &pool, &b);
  for (int i = 0; i < s->n && rc == LAG_OK; i++) /* A := (G - DX) B */
    for (int j = 0; j < b.k; j++)
      for (int l = 0; l < s->n; l++) {
        double a = m->G[i * s->n + l] - s->DX[i * s->n + l];
        A[i * b.k + j] += a * m->unit[l] / m->unit[i] * b.B[l * b.k + j];
      }
  if (rc == LAG_OK) lag_multiply_transposed(b.k, s->n, b.k, b.B, A, W);
  p->n = rc ? 0 : b.k;
  rc = rc || !p->n ? rc : s->algebra->general(b.k, W, p->re, p->im, v, v + n * n, v + 2 * n * n);
  lag_pool_free(&pool);
  return rc;
}

/* ---- Beginning */

static int refuse(SteadyBranch *s, int rc, const char *words) {
  snprintf(s->flow.message, sizeof s->flow.message, "%s", words);
  return rc;
}

static int allocate(SteadyBranch *s) {
  size_t n = (size_t)s->n, rows = (size_t)(s->steady.nrows + s->nheld + s->steady.m);
  const lag_part parts[] = {{&s->row, rows}, {&s->X, n}, {&s->DX, n * n}, {&s->e, (size_t)s->steady.m + 1},
      {&s->up, rows + n}, {&s->down, rows + n}};
  lag_pool_parts(&s->pool, sizeof parts / sizeof *parts, parts);
  return s->pool.failed ? LAG_ENOMEM : LAG_OK;
}

int lag_steady_branch_open(SteadyBranch *s, lag_sim *like, const lag_algebra *algebra) {
  int rc = lag_flow_open(&s->flow, like);
  if (rc) return rc;
  if (s->flow.forced) return refuse(s, LAG_EMETHOD, "the scene depends on time, so that no motion is steady");
  s->algebra = algebra;
  rc = s->led < 0 ? lag_flow_set(&s->flow, s->name, s->parameter) : LAG_OK;
  if (rc) return rc;
  rc = lag_steady_find(&s->steady, &s->rest, s->flow.probe, algebra, 1);
  if (rc < 0) return refuse(s, rc, "out of memory");
  if (rc == 0)
    return refuse(s, LAG_EDOMAIN, "no steady motion found near the start: start near one: name=VALUE; `lagc modes "
                                  "--steady` looks for one, too");
  s->n = s->flow.n;
  s->rate = 1e-3;
  for (int i = 0; i < s->n; i++) s->rate = fmax(s->rate, fabs(s->steady.f[i]) / s->steady.unit[i]);
  for (int k = 0; k < s->nheld; k++) s->held[k].value = held_value(s, &s->held[k], s->flow.probe->now);
  s->rows = s->steady.nrows + s->nheld + s->steady.m;
  s->cols = s->n + s->steady.m + 1;
  s->problem = (BranchProblem){.of = s, .rows = s->rows, .cols = s->cols, .eigenvalues = s->n,
                               .place = place, .system = system_of, .spectrum = spectrum,
                               .pairs = (lag_facts(&s->flow.probe->pb) & LAG_CONSERVES_ENERGY) != 0};
  return allocate(s);
}

void lag_steady_branch_free(SteadyBranch *s) {
  lag_steady_free(&s->steady);
  lag_equilibrium_free(&s->rest);
  lag_flow_free(&s->flow);
  lag_pool_free(&s->pool);
}

void lag_steady_branch_unknowns(SteadyBranch *s, double *u) {
  const SteadyMotion *m = &s->steady;
  if (s->led >= 0) s->parameter = held_value(s, &s->held[s->led], m->y);
  for (int i = 0; i < s->n; i++) u[i] = m->y[i] / m->unit[i];
  for (int k = 0; k < m->m; k++) u[s->n + k] = m->c[k] / s->rate;
  u[s->cols - 1] = s->parameter / s->parameter_unit;
}
