/* Solutions along a branch (branch_walk.h): Newton's steps, tangents, test functions. */
#include "analysis/branch_walk.h"

#include <math.h>
#include <string.h>

#include "lag.h"
#include "numeric/dense.h"
#include "numeric/singular_values.h"

enum { MOST_NEWTON = 12, MOST_CHORD = 8 };

static const double least_rank = 1e-8; /* singular values below this part of the first count as 0 */

int lag_walk_open(Walk *w, Branch *b, const BranchProblem *p) {
  size_t rows = (size_t)p->rows + 1, cols = (size_t)p->cols;
  *w = (Walk){.b = b, .p = p, .rows = p->rows + 1, .cols = p->cols};
  const lag_part parts[] = {{&w->J, rows * cols}, {&w->rhs, rows}, {&w->V, cols * cols}, {&w->sigma, cols},
      {&w->x, cols}, {&w->made_at.J, rows * cols}, {&w->made_at.V, cols * cols}, {&w->made_at.sigma, cols}};
  lag_pool_parts(&b->pool, sizeof parts / sizeof *parts, parts);
  return b->pool.failed ? LAG_ENOMEM : LAG_OK;
}

/* x := the step for the residual rhs, across the direction d, where the system was decomposed. Returns its size. */
static double newton_step(Walk *w, const double *u, const double *d, double along) {
  const double least = w->p->noise ? w->p->noise(w->p->of) : least_rank;
  w->rhs[w->p->rows] = along - lag_dot(w->cols, u, d);
  lag_least_norm((lag_decomposed){w->rows, w->cols, w->J, w->V, w->sigma}, least, 0, w->rhs, w->x);
  if (fabs(d[w->cols - 1]) == 1.0) w->x[w->cols - 1] = 0; /* the parameter stays to the bit, as at its bound */
  return sqrt(lag_dot(w->cols, w->x, w->x));
}

/* Whether a step of this size behind one of `last` is the last one: nothing but rounding is left. */
static int is_last(double size, double last) { return size < 1e-12 || (size < 1e-9 && size > 0.3 * last); }

/* The same by the system at the point that was made last. HUGE_VAL: there is none, or its branch is across d. */
static double step_from_made(Walk *w, const double *u, const double *d, double along) {
  const double least = 0.3;
  int cols = w->cols, last = cols - 1;
  const double *V = w->made_at.V, *sigma = w->made_at.sigma;
  double part = 0, ahead = along - lag_dot(cols, u, d);
  for (int i = 0; i < cols && w->made_at.known; i++) part += d[i] * V[i * cols + last];
  if (!(fabs(part) > least)) return HUGE_VAL;
  memset(w->x, 0, (size_t)cols * sizeof *w->x);
  for (int k = 0; k < last; k++) {
    double by = 0;
    for (int r = 0; r < w->p->rows; r++) by += w->made_at.J[r * cols + k] * w->rhs[r];
    for (int i = 0; i < cols; i++) w->x[i] += by / (sigma[k] * sigma[k]) * V[i * cols + k];
  }
  double on = (ahead - lag_dot(cols, w->x, d)) / part;
  for (int i = 0; i < cols; i++) w->x[i] += on * V[i * cols + last];
  if (fabs(d[last]) == 1.0) w->x[last] = 0;
  return sqrt(lag_dot(cols, w->x, w->x));
}

typedef double NextStep(Walk *w, const double *u, const double *d, double along);

/* Steps by the matrix of an earlier one, while each is a tenth of the one before or less, from *size. Returns whether u
 * is a solution. */
static int chord(Walk *w, NextStep *step, double *u, const double *d, double along, double *size) {
  for (int k = 0; k < MOST_CHORD && w->p->residual && w->p->residual(w->p->of, u, w->rhs) == LAG_OK; k++) {
    double now = step(w, u, d, along), last = *size;
    if (!(now < 0.1 * last) && !is_last(now, last)) return 0;
    for (int i = 0; i < w->cols; i++) u[i] += w->x[i];
    *size = now;
    if (is_last(now, last) || (k > 0 && now * (now / last) < w->enough)) return 1;
  }
  return 0;
}

static const double solved = 1e-6; /* of the system's rows, in units; differences of runs have some 8 digits */

/* Whether u, behind its last step, is a solution, which is placed: steps end beside one where conditions contradict
 * each other. */
static int is_solved(Walk *w, const double *u) {
  return (w->enough > 0 || lag_largest(w->p->rows, w->rhs) < solved) && w->p->place(w->p->of, u) == LAG_OK;
}

/* Whether u is a solution but for rounding, and the step of this size behind one of `last`, too: beside a branch point
 * the system is nearly singular, and such steps never end. */
static int is_rounding(const Walk *w, double size, double last) {
  return size < 1e-6 && size > 0.1 * last && lag_largest(w->p->rows, w->rhs) < 1e-11;
}

/* By the system of the point before as long as its steps converge, then by Newton's method. */
int lag_walk_correct(Walk *w, double *u, const double *d) {
  double near = 1, last = HUGE_VAL, along = lag_dot(w->cols, u, d);
  w->newton = 0;
  if (w->enough > 0 && w->made_at.known && chord(w, step_from_made, u, d, along, &near)) return is_solved(w, u);
  for (w->newton = 0; w->newton < MOST_NEWTON; w->newton++) {
    if (w->p->place(w->p->of, u) || w->p->system(w->p->of, w->J, w->rhs)) return 0;
    memcpy(w->J + w->p->rows * w->cols, d, (size_t)w->cols * sizeof *d);
    lag_singular_values(w->rows, w->cols, w->J, w->V, w->sigma);
    double size = newton_step(w, u, d, along);
    if (!(size < 1)) return 0;
    if (is_rounding(w, size, last)) return is_solved(w, u);
    for (int i = 0; i < w->cols; i++) u[i] += w->x[i];
    if (is_last(size, last) || chord(w, newton_step, u, d, along, &size)) return is_solved(w, u);
    if (w->newton > 3 && size > 0.9 * last) return 0;
    last = size;
  }
  return 0;
}

/* Test functions from eigenvalues: products that vanish where one is 0 (a multiplier 1), or a multiplier -1; growth
 * of the complex pair that is nearest to the border. */
static void judge(const BranchProblem *p, BranchPoint *at) {
  const Spectrum *s = &at->spectrum;
  const double rounding = 1e-6; /* multipliers by differences have some 8 digits */
  at->zero = at->minus = 1;
  at->stays = 0;
  at->pair = HUGE_VAL;
  at->unstable = at->stable = 0;
  for (int i = 0; i < s->n; i++) {
    double growth = p->maps ? log(fmax(hypot(s->re[i], s->im[i]), 1e-300)) : s->re[i], size = hypot(s->re[i], s->im[i]);
    double least = no_growth * fmax(1, p->maps ? 1 : size);
    at->unstable += growth > least;
    at->stable += growth < -least;
    if (s->im[i] > 0 && fabs(growth) < fabs(at->pair)) at->pair = growth;
    if (s->im[i] < 0) continue; /* with its conjugate */
    double re = s->re[i] - (p->maps ? 1 : 0);
    at->stays |= p->maps && s->im[i] <= 0 && fabs(re) < rounding;
    at->zero *= s->im[i] > 0 ? re * re + s->im[i] * s->im[i] : re;
    at->minus *= s->im[i] > 0 ? (s->re[i] + 1) * (s->re[i] + 1) + s->im[i] * s->im[i] : s->re[i] + 1;
  }
}

int lag_walk_tangent(Walk *w, const double *d, double *tangent) {
  const double *V = w->made_at.V, *sigma = w->made_at.sigma;
  w->made_at.known = 0;
  if (w->p->system(w->p->of, w->made_at.J, w->rhs)) return LAG_EDOMAIN;
  lag_singular_values(w->p->rows, w->cols, w->made_at.J, w->made_at.V, w->made_at.sigma);
  int free = 0;
  for (int i = 0; i < w->cols; i++) free += sigma[i] <= least_rank * sigma[0];
  double sign = 0;
  for (int i = 0; i < w->cols; i++) sign += V[i * w->cols + w->cols - 1] * d[i];
  for (int i = 0; i < w->cols; i++) tangent[i] = (sign < 0 ? -1 : 1) * V[i * w->cols + w->cols - 1];
  w->made_at.known = free == 1;
  return free > 1 ? LAG_ESINGULAR : LAG_OK;
}

/* The point moves by the step that its own system gives. 0: that is no rounding of a solution. */
static int take_last_step(Walk *w, BranchPoint *at) {
  if (!(lag_largest(w->p->rows, w->rhs) < solved)) return 0;
  double size = step_from_made(w, at->u, at->tangent, lag_dot(w->cols, at->u, at->tangent));
  for (int i = 0; i < w->cols && size < solved; i++) at->u[i] += w->x[i];
  return size < solved || !w->made_at.known;
}

BranchPoint *lag_walk_point(Walk *w, const double *u, const double *d) {
  size_t cols = (size_t)w->cols, n = (size_t)w->p->eigenvalues, room = sizeof(BranchPoint) / sizeof(double) + 1;
  BranchPoint *at = (BranchPoint *)(void *)lag_pool_doubles(&w->b->pool, room + 2 * cols + 2 * n);
  if (!at) return NULL;
  at->u = (double *)(void *)at + room;
  at->tangent = at->u + cols;
  at->spectrum = (Spectrum){0, at->tangent + cols, at->tangent + cols + n};
  memcpy(at->u, u, cols * sizeof *u);
  int rc = lag_walk_tangent(w, d, at->tangent);
  if (rc == LAG_EDOMAIN || (w->enough > 0 && !take_last_step(w, at))) return NULL;
  if (w->p->spectrum(w->p->of, &at->spectrum)) return NULL;
  at->fold = at->tangent[cols - 1];
  at->kind = BRANCH_REGULAR;
  judge(w->p, at);
  return at;
}

/* Removes the parts of x that lead from a solution to another form of it: along rows of the system at the point that
 * was made last. */
static void keep_form(Walk *w, double *x) {
  int cols = w->cols;
  double *row = w->x;
  for (int r = w->p->rows - w->p->forms; r < w->p->rows && w->made_at.known; r++) {
    for (int i = 0; i < cols; i++) row[i] = lag_dot(cols, w->made_at.J + r * cols, w->made_at.V + i * cols);
    double size = lag_dot(cols, row, row), part = size > 0 ? lag_dot(cols, row, x) / size : 0;
    for (int i = 0; i < cols; i++) x[i] -= part * row[i];
  }
}

BranchPoint *lag_walk_point_at(Walk *w, const BranchPoint *from, double s, const BranchPoint *other, double apart) {
  double *u = lag_pool_doubles(&w->b->pool, 2 * (size_t)w->cols), *bend = u + w->cols;
  if (!u) return NULL;
  double turn = other ? lag_dot(w->cols, from->tangent, other->tangent) : 1;
  for (int i = 0; i < w->cols && other; i++) bend[i] = (other->tangent[i] - turn * from->tangent[i]) / apart;
  keep_form(w, bend);
  for (int i = 0; i < w->cols; i++) u[i] = from->u[i] + s * from->tangent[i] + s * s / 2 * bend[i];
  return lag_walk_correct(w, u, from->tangent) ? lag_walk_point(w, u, from->tangent) : NULL;
}
