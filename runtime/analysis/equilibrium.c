#include "analysis/equilibrium.h"

#include <math.h>
#include <string.h>

enum { MOST_STEPS = 200, MOST_DESCENT = 200 };

/* A force counts as 0 when displacements of this size, relative to the state and its scale, make more. */
static const double SMALL = 1e-9;

static const lag_var *unknown(const Rest *r, int i)
{
  const lag_model *m = r->sim->scene->model;

  return i < m->nq ? &m->q[i] : &m->z[i - m->nq];
}

static int is_angle(const lag_var *v)
{
  return v->periodic || strcmp(v->unit, "rad") == 0 || strcmp(v->unit, "deg") == 0 || strcmp(v->unit, "rev") == 0;
}

static void choose_scales(Rest *r)
{
  for (int i = 0; i < r->n; i++) {
    const lag_var *v = unknown(r, i);
    double largest = 0;
    for (int j = 0; j < r->n; j++) {
      largest = strcmp(unknown(r, j)->unit, v->unit) == 0 ? fmax(largest, fabs(r->start[j])) : largest;
    }
    r->scale[i] = is_angle(v) ? 1 : largest > 0 ? largest : v->factor;
  }
}

/* The state of x[n]. */
static void place(Rest *r, const double *x)
{
  int nq = r->sim->pb.nq;

  for (int i = 0; i < r->n; i++) {
    r->y[i < nq ? i : nq + i] = x[i] * r->scale[i];
  }
}

/* Forces M a (a from the model, so that both vanish together) and rates, and their derivatives, at r->y. */
static int equations(void *context, const double *x, double *f, double *J)
{
  Rest *r = context;
  lag_problem *pb = &r->sim->pb;
  int nq = pb->nq, n = r->n;
  double t = r->sim->run->t;

  place(r, x);
  int rc = lag_rhs(pb, t, r->y, r->rate);
  rc = rc ? rc : lag_linearise(pb, t, r->y, NULL, r->dr, r->M, r->work);
  for (int i = 0; i < n && rc == 0; i++) {
    double weight = (i < nq ? r->scale[i] : 1 / r->scale[i]) * r->row[i], sum = 0;
    for (int j = 0; j < nq && i < nq; j++) {
      sum += r->M[i * nq + j] * r->rate[nq + j];
    }
    f[i] = weight * (i < nq ? sum : r->rate[nq + i]);
    for (int j = 0; j < n && J; j++) {
      J[i * n + j] = weight * r->dr[i * pb->n + (j < nq ? j : nq + j)] * r->scale[j];
    }
  }
  return rc;
}

/* Forces as a whole, and rates as a whole, get the size 1: what they are made of may differ by any factor. */
static int choose_rows(Rest *r)
{
  int nq = r->sim->pb.nq, n = r->n;
  double largest[2] = {0, 0};

  for (int i = 0; i < n; i++) {
    r->row[i] = 1;
  }
  int rc = equations(r, r->x, r->f, r->J);
  if (rc) {
    return rc;
  }
  for (int i = 0; i < n; i++) {
    double *size = &largest[i >= nq];
    *size = fmax(*size, fabs(r->f[i]));
    for (int j = 0; j < n; j++) {
      *size = fmax(*size, fabs(r->J[i * n + j]));
    }
  }
  for (int i = 0; i < n; i++) {
    double size = largest[i >= nq];
    r->row[i] = size > 0 && isfinite(size) ? 1 / size : 1;
  }
  return LAG_OK;
}

/* Are all equations 0 at x[n]? A force that nothing changes must be exactly 0. */
static int holds(Rest *r, const double *x)
{
  double most = 0;
  int n = r->n, good = 1;

  r->worst = 0;
  if (equations(r, x, r->f, r->J) || lag_not_finite(n, r->f) >= 0) {
    return 0;
  }
  for (int i = 0; i < n; i++) {
    double allowed = 0;
    for (int j = 0; j < n; j++) {
      allowed += SMALL * fabs(r->J[i * n + j]) * (fabs(x[j]) + 1);
    }
    if (fabs(r->f[i]) <= allowed) {
      continue;
    }
    good = 0;
    if (fabs(r->f[i]) > most) {
      most = fabs(r->f[i]);
      r->worst = i;
    }
  }
  return good;
}

/* 1e-27 is 0 where 0 is as good. */
static void clean(Rest *r)
{
  for (int i = 0; i < r->n; i++) {
    r->trial[i] = fabs(r->x[i]) > 1e-12 ? r->x[i] : 0;
  }
  if (holds(r, r->trial)) {
    memcpy(r->x, r->trial, (size_t)r->n * sizeof *r->x);
  }
  holds(r, r->x);
}

/* ---- Downhill */

/* How far x is from y, in scales. */
static double distance(const Rest *r, const double *x, const double *y)
{
  double most = 0;

  for (int i = 0; i < r->n; i++) {
    most = fmax(most, fabs(x[i] - y[i]));
  }
  return most;
}

/* An implicit step of the motion with all inertia replaced by friction, M q' = f: f(x) - W (x - from)/delta. */
static int friction(void *context, const double *x, double *f, double *J)
{
  Rest *r = context;
  int n = r->n, rc = equations(r, x, f, J);

  for (int i = 0; i < n && rc == 0; i++) {
    for (int j = 0; j < n; j++) {
      f[i] -= r->W[i * n + j] * (x[j] - r->from[j]) / r->delta;
      if (J) {
        J[i * n + j] -= r->W[i * n + j] / r->delta;
      }
    }
  }
  return rc;
}

/* The mass matrix in the units of the equations, and the identity for rates; the first step goes 0.3 of a scale. */
static void prepare_friction(Rest *r)
{
  int n = r->n, nq = r->sim->pb.nq;
  double fastest = 0;

  holds(r, r->x);
  for (int i = 0; i < n; i++) {
    fastest = fmax(fastest, fabs(r->rate[nq + i]) / r->scale[i]);
    for (int j = 0; j < n; j++) {
      int both = i < nq && j < nq;
      r->W[i * n + j] = both ? r->M[i * nq + j] * r->scale[i] * r->scale[j] * r->row[i] : i == j ? r->row[i] : 0;
    }
  }
  r->delta = fastest > 0 && isfinite(fastest) ? 0.3 / fastest : 1;
}

/* Follows friction from x[n] until hardly anything moves. */
static int descend(Rest *r, const lag_algebra *algebra)
{
  size_t bytes = (size_t)r->n * sizeof(double);

  prepare_friction(r);
  for (int k = 0; k < MOST_DESCENT; k++) {
    int steps = 0;
    memcpy(r->from, r->x, bytes);
    int rc = algebra->root(r->n, r->x, friction, r, 20, &steps);
    double moved = distance(r, r->x, r->from);
    r->steps += steps;
    if (rc == LAG_ENOMEM) {
      return rc;
    }
    if (rc || !(moved < 0.5)) {
      memcpy(r->x, r->from, bytes);
      r->delta /= 4;
    } else if (moved < 1e-3) {
      return LAG_OK;
    } else {
      r->delta *= moved < 0.2 ? 2 : 1;
    }
  }
  return LAG_OK;
}

/* ---- The search */

/* Has x left everything behind? Forces that fade have no root there. */
static int ran_away(const Rest *r)
{
  double start = 1;

  for (int i = 0; i < r->n; i++) {
    start = fmax(start, fabs(r->begin[i]));
  }
  return distance(r, r->x, r->begin) > 1e4 * start;
}

static int find_root(Rest *r, const lag_algebra *algebra)
{
  int steps = 0, rc = algebra->root(r->n, r->x, equations, r, MOST_STEPS, &steps);

  r->steps += steps;
  return rc ? rc : holds(r, r->x);
}

/* A root near the start, stable or not; else one downhill; else any. */
static int search(Rest *r, const lag_algebra *algebra)
{
  size_t bytes = (size_t)r->n * sizeof(double);
  int rc = find_root(r, algebra);

  if (rc < 0 || (rc == 1 && distance(r, r->x, r->begin) <= 1)) {
    return rc;
  }
  memcpy(r->first, r->x, bytes);
  r->away = rc == 0 && ran_away(r);
  int first = rc;
  memcpy(r->x, r->begin, bytes);
  rc = descend(r, algebra);
  rc = rc ? rc : find_root(r, algebra);
  if (rc != 0) {
    return rc;
  }
  memcpy(r->x, r->first, bytes);
  holds(r, r->x);
  return first;
}

static int allocate(Rest *r)
{
  const lag_model *m = r->sim->scene->model;
  size_t n = (size_t)r->n, nq = (size_t)m->nq, ny = (size_t)r->sim->pb.n;
  double **const parts[] = {&r->start, &r->y, &r->rate, &r->scale, &r->x, &r->begin, &r->from, &r->first, &r->trial,
                            &r->f, &r->row, &r->J, &r->W, &r->dr, &r->M, &r->work};
  const size_t sizes[] = {n, ny, ny, n, n, n, n, n, n, n, n, n * n, n * n, n * ny, nq * nq, lag_linear_work(m)};

  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
    *parts[i] = pool_doubles(&r->pool, sizes[i]);
  }
  return r->pool.failed ? LAG_ENOMEM : LAG_OK;
}

int lag_rest_find(Rest *r, lag_sim *sim, const lag_algebra *algebra)
{
  int nq = sim->pb.nq, n = nq + sim->pb.nz;

  *r = (Rest){.sim = sim, .n = n};
  int rc = allocate(r);
  if (rc) {
    return rc;
  }
  for (int i = 0; i < n; i++) {
    r->start[i] = sim->now[i < nq ? i : nq + i];
  }
  choose_scales(r);
  for (int i = 0; i < n; i++) {
    r->x[i] = r->begin[i] = r->start[i] / r->scale[i];
  }
  if ((rc = choose_rows(r)) != 0) {
    return rc < 0 ? rc : LAG_EDOMAIN;
  }
  rc = holds(r, r->x) ? 1 : search(r, algebra);
  if (rc == 1) {
    clean(r);
  }
  return rc;
}

int lag_rest_holds(Rest *r, const double *dx, double c)
{
  for (int i = 0; i < r->n; i++) {
    r->trial[i] = r->x[i] + c * dx[i] / r->scale[i];
  }
  int good = holds(r, r->trial);
  holds(r, r->x);
  return good;
}

int lag_rest_continues(Rest *r, const lag_algebra *algebra, const double *dx, double c)
{
  double along = 0, size = 0;
  int steps;

  for (int i = 0; i < r->n; i++) {
    r->from[i] = r->x[i] + c * dx[i] / r->scale[i];
  }
  int found = algebra->root(r->n, r->from, equations, r, MOST_STEPS, &steps) == LAG_OK && holds(r, r->from);
  for (int i = 0; i < r->n; i++) {
    double step = c * dx[i] / r->scale[i];
    along += (r->from[i] - r->x[i]) * step;
    size += step * step;
  }
  holds(r, r->x);
  return found && along > 0.5 * size;
}

void lag_rest_free(Rest *r)
{
  pool_free(&r->pool);
}
