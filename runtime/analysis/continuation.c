/* Pseudo-arclength continuation (continuation.h). */
#include "analysis/continuation.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "lag.h"
#include "numeric/singular_values.h"
#include "numeric/dense.h"

enum { MOST_NEWTON = 12, MOST_CHORD = 8, MOST_LOCATE = 60 };

static const double least_rank = 1e-8; /* singular values below this part of the first count as 0 */

typedef struct Walk {
  Branch *b;
  const BranchProblem *p;
  int rows, cols; /* of the equations with the row across the tangent */
  double *J, *rhs, *V, *sigma, *x;
  /* the system at the point that was made last, without the row across the tangent, which is the last column of its V;
   * 0: there is none */
  struct { double *J, *V, *sigma; int known; } made_at;
  double enough; /* steps end where the next would be shorter: the system at the point takes it, too; 0: at rounding */
  int newton;  /* steps of the last correction */
  double made; /* arclength of the last step */
  int border;  /* 1: that step ends at the border of the range */
} Walk;

static int open_walk(Walk *w, Branch *b, const BranchProblem *p) {
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

/* Steps from u, each across the direction d: u := a solution; by the system of the point before as long as they
 * converge, then by Newton's method. 0: none. */
static int correct(Walk *w, double *u, const double *d) {
  double near = 1, last = HUGE_VAL, along = lag_dot(w->cols, u, d);
  w->newton = 0;
  if (w->enough > 0 && w->made_at.known && chord(w, step_from_made, u, d, along, &near)) return is_solved(w, u);
  for (w->newton = 0; w->newton < MOST_NEWTON; w->newton++) {
    if (w->p->place(w->p->of, u) || w->p->system(w->p->of, w->J, w->rhs)) return 0;
    memcpy(w->J + w->p->rows * w->cols, d, (size_t)w->cols * sizeof *d);
    lag_singular_values(w->rows, w->cols, w->J, w->V, w->sigma);
    double size = newton_step(w, u, d, along);
    if (!(size < 1)) return 0;
    for (int i = 0; i < w->cols; i++) u[i] += w->x[i];
    if (is_last(size, last) || chord(w, newton_step, u, d, along, &size)) return is_solved(w, u);
    if (w->newton > 3 && size > 0.9 * last) return 0;
    last = size;
  }
  return 0;
}

static const double no_growth = 1e-7;

static double sign_of(double growth) { return fabs(growth) < no_growth ? 0 : growth; }

/* Test functions from eigenvalues: products that vanish where one is 0 (a multiplier 1), or a multiplier -1; growth
 * of the complex pair that is nearest to the border. */
static void judge(const BranchProblem *p, BranchPoint *at) {
  const Spectrum *s = &at->spectrum;
  const double rounding = 1e-6; /* multipliers by differences have some 8 digits */
  at->zero = at->minus = 1;
  at->stays = 0;
  at->pair = HUGE_VAL;
  at->unstable = 0;
  for (int i = 0; i < s->n; i++) {
    double growth = p->maps ? log(fmax(hypot(s->re[i], s->im[i]), 1e-300)) : s->re[i], size = hypot(s->re[i], s->im[i]);
    at->unstable += growth > no_growth * fmax(1, p->maps ? 1 : size);
    if (s->im[i] > 0 && fabs(growth) < fabs(at->pair)) at->pair = growth;
    if (s->im[i] < 0) continue; /* with its conjugate */
    double re = s->re[i] - (p->maps ? 1 : 0);
    at->stays |= p->maps && s->im[i] <= 0 && fabs(re) < rounding;
    at->zero *= s->im[i] > 0 ? re * re + s->im[i] * s->im[i] : re;
    at->minus *= s->im[i] > 0 ? (s->re[i] + 1) * (s->re[i] + 1) + s->im[i] * s->im[i] : s->re[i] + 1;
  }
}

/* The tangent of the branch at the solution that is placed: the unit vector that the equations leave free, with a
 * positive part along d. LAG_ESINGULAR: there are several. */
static int find_tangent(Walk *w, const double *d, double *tangent) {
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

/* A point at the solution u that is placed. NULL: no memory, or no values. */
static BranchPoint *make_point(Walk *w, const double *u, const double *d) {
  size_t cols = (size_t)w->cols, n = (size_t)w->p->eigenvalues, room = sizeof(BranchPoint) / sizeof(double) + 1;
  BranchPoint *at = (BranchPoint *)(void *)lag_pool_doubles(&w->b->pool, room + 2 * cols + 2 * n);
  if (!at) return NULL;
  at->u = (double *)(void *)at + room;
  at->tangent = at->u + cols;
  at->spectrum = (Spectrum){0, at->tangent + cols, at->tangent + cols + n};
  memcpy(at->u, u, cols * sizeof *u);
  int rc = find_tangent(w, d, at->tangent);
  if (rc == LAG_EDOMAIN || (w->enough > 0 && !take_last_step(w, at)) || w->p->spectrum(w->p->of, &at->spectrum)) return NULL;
  at->fold = at->tangent[cols - 1];
  at->kind = BRANCH_REGULAR;
  judge(w->p, at);
  return at;
}

static void append(Branch *b, BranchPoint *at) {
  if (b->last) b->last->next = at;
  else b->first = at;
  b->last = at;
  b->npoints++;
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

/* The point at arclength s from `from` along its tangent, on the parabola with the tangent of another point, `apart`
 * from it, or NULL. NULL: there is none. */
static BranchPoint *point_at(Walk *w, const BranchPoint *from, double s, const BranchPoint *other, double apart) {
  double *u = lag_pool_doubles(&w->b->pool, 2 * (size_t)w->cols), *bend = u + w->cols;
  if (!u) return NULL;
  double turn = other ? lag_dot(w->cols, from->tangent, other->tangent) : 1;
  for (int i = 0; i < w->cols && other; i++) bend[i] = (other->tangent[i] - turn * from->tangent[i]) / apart;
  keep_form(w, bend);
  for (int i = 0; i < w->cols; i++) u[i] = from->u[i] + s * from->tangent[i] + s * s / 2 * bend[i];
  return correct(w, u, from->tangent) ? make_point(w, u, from->tangent) : NULL;
}

/* ---- Bifurcations between two points */

static double test_of(const BranchPoint *at, BranchKind kind) {
  return kind == BRANCH_FOLD       ? at->fold
         : kind == BRANCH_POINT    ? at->zero
         : kind == BRANCH_DOUBLING ? at->minus
                                   : at->pair;
}

/* Whether a test function changes its sign from a to b, or leaves 0, as where a branch begins. */
static int changes_sign(double a, double b) { return (a <= 0 && b > 0) || (a >= 0 && b < 0); }

/* Kind of the point between two others; BRANCH_REGULAR: none, or no further one after `after`. */
static BranchKind between(const BranchProblem *p, const BranchPoint *a, const BranchPoint *b, BranchKind after) {
  int fold = changes_sign(a->fold, b->fold), zero = changes_sign(a->zero, b->zero) && !(a->stays && b->stays),
      minus = p->maps && changes_sign(a->minus, b->minus);
  if (fold && after == BRANCH_REGULAR) return BRANCH_FOLD;
  if (minus && after != BRANCH_DOUBLING && after != BRANCH_POINT) return BRANCH_DOUBLING;
  if (zero && !fold && after != BRANCH_POINT) return BRANCH_POINT;
  if (fold || minus || zero) return BRANCH_REGULAR;
  if (abs(a->unstable - b->unstable) < 2) return BRANCH_REGULAR;
  if (p->pairs) return BRANCH_COLLISION;
  return changes_sign(sign_of(a->pair), sign_of(b->pair)) ? p->maps ? BRANCH_TORUS : BRANCH_HOPF : BRANCH_REGULAR;
}

/* The kind of a further point there. */
static BranchKind more_kinds(const BranchProblem *p, const BranchPoint *a, const BranchPoint *b, BranchKind after) {
  return after == BRANCH_FOLD || after == BRANCH_DOUBLING ? between(p, a, b, after) : BRANCH_REGULAR;
}

/* An interval of arclength at whose ends a test function has values of different sign. */
typedef struct Bracket {
  double a, b, fa, fb;
  int side; /* the end that moved last */
} Bracket;

/* Takes the value f at s; of an end that stays twice half the value, by the method of Illinois (M. Dowell, P.
 * Jarratt, BIT 11 (1971) 168). */
static void narrow(Bracket *r, double s, double f) {
  int upper = changes_sign(r->fa, f);
  if (upper) r->b = s, r->fb = f, r->fa /= r->side > 0 ? 2 : 1;
  else r->a = s, r->fa = f, r->fb /= r->side < 0 ? 2 : 1;
  r->side = upper ? 1 : -1;
}

/* u[cols] := the cubic through two points with their tangents, at arclength s of `to`; d[cols], unless NULL, := its
 * direction. */
static void between_points(int cols, const BranchPoint *a, const BranchPoint *b, double to, double s, double *u,
                           double *d) {
  double x = s / to, size = 0;
  for (int i = 0; i < cols; i++) {
    double p = a->u[i], q = b->u[i], v = to * a->tangent[i], w = to * b->tangent[i];
    u[i] = p + x * (v + x * (3 * (q - p) - 2 * v - w + x * (2 * (p - q) + v + w)));
    if (!d) continue;
    d[i] = v + x * (2 * (3 * (q - p) - 2 * v - w) + 3 * x * (2 * (p - q) + v + w));
    size += d[i] * d[i];
  }
  for (int i = 0; i < cols && d; i++) d[i] /= sqrt(size);
}

/* Points beside a branch point, at arclengths x[n] relative to a middle, in units of a width; for Lagrange's
 * polynomials. */
typedef struct Nodes {
  int n;
  double middle, width;
  double x[8];
  BranchPoint *at[8];
} Nodes;

/* weight[n] of the values at the nodes in that of their polynomial at x. */
static void lagrange(const Nodes *k, double x, double *weight) {
  for (int i = 0; i < k->n; i++) {
    weight[i] = 1;
    for (int j = 0; j < k->n; j++) weight[i] *= j != i ? (x - k->x[j]) / (k->x[i] - k->x[j]) : 1;
  }
}

static double zero_at(const Nodes *k, double x) {
  double weight[8], sum = 0;
  lagrange(k, x, weight);
  for (int i = 0; i < k->n; i++) sum += weight[i] * k->at[i]->zero;
  return sum;
}

/* u[cols] := the state on the polynomial at x. */
static void state_at(const Nodes *k, int cols, double x, double *u) {
  double weight[8];
  lagrange(k, x, weight);
  memset(u, 0, (size_t)cols * sizeof *u);
  for (int i = 0; i < k->n; i++)
    for (int c = 0; c < cols; c++) u[c] += weight[i] * k->at[i]->u[c];
}

/* Root of the polynomial of the test function that is nearest to the middle of -1 to 1, by bisection; NAN: none. */
static double root_of(const Nodes *k) {
  enum { PARTS = 20 };
  double a = NAN, b = NAN;
  for (int i = -PARTS; i < PARTS; i++) {
    double x = (double)i / PARTS, y = (i + 1.0) / PARTS;
    if (changes_sign(zero_at(k, x), zero_at(k, y)) && !(fabs(a + b) <= fabs(x + y))) a = x, b = y;
  }
  double fa = zero_at(k, a);
  for (int i = 0; i < 60; i++) {
    double x = (a + b) / 2, f = zero_at(k, x);
    if (changes_sign(fa, f)) b = x;
    else a = x, fa = f;
  }
  return (a + b) / 2;
}

/* A branch point between two points: next to it another branch is near, and the equations are singular, so that it
 * is found by interpolation between points at some distance, in smaller and smaller widths. NULL: it is not found. */
static BranchPoint *locate_branch_point(Walk *w, const BranchPoint *from, const BranchPoint *far, double to) {
  static const double places[] = {-1, -0.7, -0.4, 0.4, 0.7, 1};
  double middle = to / 2, width = to / 2, *u = lag_pool_doubles(&w->b->pool, 2 * (size_t)w->cols);
  if (!u) return NULL;
  BranchPoint *best = NULL;
  Nodes known = {0};
  for (int round = 0, narrower = 0; round < 6 && narrower < 3; round++) {
    Nodes k = {.middle = middle, .width = width};
    for (int i = 0; i < 6; i++) {
      double s = fmin(fmax(middle + width * places[i], 0), to);
      between_points(w->cols, from, far, to, s, u, u + w->cols);
      if (known.n) state_at(&known, w->cols, (s - known.middle) / known.width, u);
      BranchPoint *at = correct(w, u, u + w->cols) ? make_point(w, u, from->tangent) : NULL;
      if (!at || (k.n && (s - middle) / width <= k.x[k.n - 1])) continue;
      k.x[k.n] = (s - middle) / width;
      k.at[k.n++] = at;
    }
    double x = k.n > 3 ? root_of(&k) : NAN;
    if (isnan(x) && !best) return NULL;
    if (isnan(x)) { /* the root lies beside these points */
      width = fmin(4 * width, to / 2);
      continue;
    }
    state_at(&k, w->cols, x, u);
    known = k;
    BranchPoint *at = w->p->place(w->p->of, u) ? NULL : make_point(w, u, from->tangent);
    if (!at) return best;
    best = at;
    middle += width * x;
    width = to / (narrower++ ? 150 : 20);
  }
  return best;
}

/* The point of this kind between two points by its test function; where only the number of growing eigenvalues tells,
 * by bisection. */
static BranchPoint *locate_by_test(Walk *w, const BranchPoint *from, const BranchPoint *far, double to,
                                   BranchKind kind) {
  int counts = kind == BRANCH_COLLISION;
  Bracket r = {0, to, counts ? -1 : test_of(from, kind), counts ? 1 : test_of(far, kind), 0};
  if (kind == BRANCH_HOPF || kind == BRANCH_TORUS) r.fa = sign_of(r.fa);
  const double rounding = 1e-12;
  double least = HUGE_VAL, last = HUGE_VAL, *u = lag_pool_doubles(&w->b->pool, 2 * (size_t)w->cols);
  BranchPoint *best = NULL;
  if (!u) return NULL;
  for (int k = 0; k < MOST_LOCATE && r.b - r.a > 1e-13 * to; k++) {
    double s = counts ? (r.a + r.b) / 2 : (r.a * r.fb - r.b * r.fa) / (r.fb - r.fa);
    if (!(s > r.a && s < r.b)) s = (r.a + r.b) / 2;
    between_points(w->cols, from, far, to, s, u, u + w->cols);
    w->enough = rounding;
    BranchPoint *at = correct(w, u, u + w->cols) ? make_point(w, u, from->tangent) : NULL;
    w->enough = 0;
    if (!at) break;
    double f = !counts ? test_of(at, kind) : at->unstable == from->unstable ? -1 : 1;
    if (counts || fabs(f) < least) best = at, least = fabs(f);
    if (f == 0.0 || fabs(s - last) < rounding * to) break;
    last = s;
    narrow(&r, s, f);
    if (counts) r.fa = -1, r.fb = 1;
  }
  return best;
}

/* The point of this kind between `from` and `far`, which is at arclength `to`. */
static BranchPoint *locate(Walk *w, const BranchPoint *from, const BranchPoint *far, double to, BranchKind kind) {
  BranchPoint *best = kind == BRANCH_POINT ? locate_branch_point(w, from, far, to) : NULL;
  if (!best) best = locate_by_test(w, from, far, to, kind);
  if (!best) return NULL;
  best->kind = kind;
  double size = 0; /* at a branch point the equations leave two directions free: that of the secant is this branch's */
  for (int i = 0; i < w->cols; i++) size += (far->u[i] - from->u[i]) * (far->u[i] - from->u[i]);
  for (int i = 0; i < w->cols && kind != BRANCH_FOLD; i++) best->tangent[i] = (far->u[i] - from->u[i]) / sqrt(size);
  return best;
}

/* ---- Two bifurcations within one step */

/* Three points in order of their arclength s, with values of a test function that are less in the middle. */
typedef struct Dip {
  BranchPoint *at[3];
  double s[3];
} Dip;

static Dip dip_of(const Dip *d, int first, BranchPoint *new, double s) {
  BranchPoint *other = d->at[first + 1];
  return (Dip){{d->at[first], new, other}, {d->s[first], s, d->s[first + 1]}};
}

/* Arclength where the parabola through the test function has its vertex; *least: how near it comes to 0 there, as a
 * part of the lesser value at the ends; < 0: beyond. */
static double vertex(const Dip *d, BranchKind kind, double *least) {
  double a = d->s[0] - d->s[1], b = d->s[2] - d->s[1], f = test_of(d->at[1], kind),
         fa = (test_of(d->at[0], kind) - f) / a, fb = (test_of(d->at[2], kind) - f) / b;
  double bend = (fb - fa) / (b - a), slope = fa - bend * a, x = -slope / (2 * bend), off = 0.1 * fmin(-a, b);
  *least = (f - slope * slope / (4 * bend)) / copysign(fmin(fabs(f + fa * a), fabs(f + fb * b)), f);
  if (fabs(x) < off) x = -a > b ? -off : off; /* beside the middle */
  return d->s[1] + fmin(fmax(x, 0.9 * a), 0.9 * b);
}

/* Narrows the dip until its middle has another sign than its ends. 0: it has not. */
static int crosses(Walk *w, Dip *d, BranchKind kind) {
  const double near = 0.1;
  for (int k = 0; k < 12; k++) {
    double least = HUGE_VAL, s = vertex(d, kind, &least), f = test_of(d->at[1], kind);
    if (!(least < near)) return 0;
    int before = s < d->s[1], from = before ? 0 : 1;
    BranchPoint *at = point_at(w, d->at[from], s - d->s[from], d->at[from + 1], d->s[from + 1] - d->s[from]);
    if (!at) return 0;
    double now = test_of(at, kind);
    int lower = fabs(now) < fabs(f), other = (now < 0) != (f < 0);
    if (other || lower) *d = dip_of(d, from, at, s);
    else *d = (Dip){{before ? at : d->at[0], d->at[1], before ? d->at[2] : at},
                    {before ? s : d->s[0], d->s[1], before ? d->s[2] : s}};
    if (other) return 1;
  }
  return 0;
}

static BranchPoint *insert(Branch *b, BranchPoint *after, BranchPoint *at) {
  at->next = after->next;
  after->next = at;
  if (b->last == after) b->last = at;
  b->npoints++;
  return at;
}

/* Test functions that dip between a, b and c, at steps of this arclength, and have no other sign there: both
 * bifurcations of one that crosses 0 and comes back are put between these points. */
static void look_within(Walk *w, BranchPoint *a, BranchPoint *b, BranchPoint *c, double to_b, double to_c) {
  static const BranchKind kinds[] = {BRANCH_FOLD, BRANCH_POINT, BRANCH_DOUBLING};
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
    Dip d = {{a, b, c}, {0, to_b, to_b + to_c}};
    double f = fabs(test_of(b, kinds[k]));
    int of_maps = kinds[k] == BRANCH_DOUBLING, stays = kinds[k] == BRANCH_POINT && b->stays;
    if ((of_maps && !w->p->maps) || stays || f == 0.0) continue;
    if (f > fabs(test_of(a, kinds[k])) || f > fabs(test_of(c, kinds[k])) || !crosses(w, &d, kinds[k])) continue;
    BranchPoint *one = locate(w, d.at[0], d.at[1], d.s[1] - d.s[0], kinds[k]),
                *two = locate(w, d.at[1], d.at[2], d.s[2] - d.s[1], kinds[k]), *after = d.s[1] < to_b ? a : b;
    if (one && two) insert(w->b, insert(w->b, insert(w->b, after, one), d.at[1]), two);
    return;
  }
}

/* ---- The walk */

/* Puts a point behind `from`, and behind or before another one there, along the tangent. */
static void append_in_order(Branch *b, BranchPoint *from, BranchPoint *at, int cols) {
  const BranchPoint *other = from->next;
  if (other && lag_dot(cols, at->u, from->tangent) < lag_dot(cols, other->u, from->tangent)) insert(b, from, at);
  else append(b, at);
}

/* Whether the branch has come back to its first point. */
static int is_closed(const Branch *b, const BranchPoint *at, double step, int cols) {
  double d = 0;
  for (int i = 0; i < cols; i++) d += (at->u[i] - b->first->u[i]) * (at->u[i] - b->first->u[i]);
  return b->npoints > 6 && sqrt(d) < 0.6 * step && lag_dot(cols, at->tangent, b->first->tangent) > 0.9;
}

/* The point where the branch leaves the range, between `from` and one beyond, at arclength w->made. */
static BranchPoint *at_border(Walk *w, const BranchPoint *from, const BranchPoint *far, const BranchLimits *l) {
  int last = w->cols - 1;
  double border = far->u[last] > l->high ? l->high : l->low;
  double part = (border - from->u[last]) / (far->u[last] - from->u[last]);
  double *u = lag_pool_doubles(&w->b->pool, 2 * (size_t)w->cols), *d = u + w->cols;
  if (!u) return NULL;
  between_points(w->cols, from, far, w->made, part * w->made, u, NULL);
  u[last] = border;
  d[last] = 1;
  return correct(w, u, d) ? make_point(w, u, from->tangent) : NULL;
}

static int outside(const double *u, int last, const BranchLimits *l) {
  return u[last] > l->high * (1 + 4 * DBL_EPSILON) || u[last] < l->low - 4 * DBL_EPSILON * fabs(l->low);
}

/* The point at the border where a step goes beyond, and there is nothing beyond, as of a parameter declared >= 0. */
static BranchPoint *last_point(Walk *w, const BranchPoint *from, double step, const BranchLimits *l) {
  double *u = lag_pool_doubles(&w->b->pool, (size_t)w->cols);
  if (!u) return NULL;
  for (int i = 0; i < w->cols; i++) u[i] = from->u[i] + step * from->tangent[i];
  if (!outside(u, w->cols - 1, l)) return NULL;
  BranchPoint beyond = {.u = u, .tangent = from->tangent}, *at = at_border(w, from, &beyond, l);
  w->made = at ? lag_dot(w->cols, at->u, from->tangent) - lag_dot(w->cols, from->u, from->tangent) : 0;
  return at;
}

/* The longest step from a point: a part of what the branch has gone through, as motions grow, that changes the parameter
 * little. */
static double longest_step(const Walk *w, const BranchPoint *from, const BranchLimits *l) {
  const double most = 2;
  int last = w->cols - 1;
  double way = 0;
  for (int i = 0; i < last; i++) way += (from->u[i] - w->b->first->u[i]) * (from->u[i] - w->b->first->u[i]);
  double step = l->longest * fmin(fmax(1, sqrt(way)), most);
  return fmin(step, l->longest / fabs(from->tangent[last]));
}

/* Makes the next step; its length adapts to the number of Newton's steps and the turn of the tangent. NULL: none is
 * short enough. */
static BranchPoint *next_point(Walk *w, double *step, double least, const BranchPoint *before, const BranchLimits *l) {
  const double shortest = 1e-7, nearly = 1e-8;
  const BranchPoint *from = w->b->last;
  double made = w->made;
  for (*step = fmax(*step, shortest); *step >= shortest; *step /= 2) { /* at least one, which says what keeps it */
    w->enough = nearly;
    BranchPoint *at = point_at(w, from, *step, before, -made);
    w->enough = 0;
    w->made = *step;
    w->border = !at && (at = last_point(w, from, *step, l)) != NULL;
    if (!at) continue;
    double turn = lag_dot(w->cols, at->tangent, from->tangent);
    if (turn < least) continue;
    int easy = w->newton <= 4 && turn > 0.98;
    *step = easy ? fmax(*step, fmin((turn > 0.995 ? 2 : 1.4) * *step, longest_step(w, at, l))) : *step;
    return at;
  }
  return NULL;
}

static int first_point(Walk *w, const double *u0, const double *d, int sign) {
  double *u = lag_pool_doubles(&w->b->pool, 2 * (size_t)w->cols), *along = u + w->cols;
  if (!u) return LAG_ENOMEM;
  memcpy(u, u0, (size_t)w->cols * sizeof *u);
  if (d) memcpy(along, d, (size_t)w->cols * sizeof *d);
  else along[w->cols - 1] = sign;
  if (!correct(w, u, along)) return LAG_EDOMAIN;
  BranchPoint *at = make_point(w, u, along);
  if (!at) return w->b->pool.failed ? LAG_ENOMEM : LAG_EDOMAIN;
  if (!sign) memcpy(at->tangent, d, (size_t)w->cols * sizeof *d); /* at a branch point there are several */
  else if (find_tangent(w, along, at->tangent) == LAG_ESINGULAR) return LAG_ESINGULAR;
  at->fold = at->tangent[w->cols - 1];
  append(w->b, at);
  return LAG_OK;
}

int lag_branch_follow(Branch *b, const BranchProblem *p, const double *u0, const double *d, int sign,
                      const BranchLimits *limits) {
  Walk w;
  *b = (Branch){.end = BRANCH_AT_NUMBER};
  int rc = open_walk(&w, b, p), last = p->cols - 1;
  rc = rc ? rc : first_point(&w, u0, d, sign);
  BranchPoint *before = NULL; /* the point before the last one, with nothing found between them */
  double made = 0;
  for (double step = limits->step; rc == LAG_OK && b->npoints < limits->most;) {
    BranchPoint *from = b->last;
    BranchPoint *at = next_point(&w, &step, 0.9, b->npoints > 1 ? before : NULL, limits);
    if (!at && !sign && b->npoints == 1) { /* the direction was across the other branch, not yet along this one */
      step = limits->step;
      at = next_point(&w, &step, 0.3, NULL, limits);
    }
    if (!at) return b->end = b->pool.failed ? BRANCH_NO_MEMORY : BRANCH_LOST, LAG_OK;
    /* from a branch point, where test functions are 0 but for rounding, nothing is looked for in the first step */
    int looks = sign || b->npoints > 1;
    BranchKind kind = looks ? between(p, from, at, BRANCH_REGULAR) : BRANCH_REGULAR;
    for (BranchKind now = kind; now != BRANCH_REGULAR; now = more_kinds(p, from, at, now)) {
      BranchPoint *found = locate(&w, from, at, w.made, now);
      if (found && now == BRANCH_FOLD && p->stands && p->stands(p->of, found->u, found->tangent)) found = NULL;
      if (found && !outside(found->u, last, limits)) append_in_order(b, from, found, p->cols);
    }
    if (outside(at->u, last, limits)) at = at_border(&w, from, at, limits), w.border = 1;
    if (!at) return b->end = b->pool.failed ? BRANCH_NO_MEMORY : BRANCH_LOST, LAG_OK; /* none at the border itself */
    append(b, at);
    if (before && kind == BRANCH_REGULAR && !w.border) look_within(&w, before, from, at, made, w.made);
    before = kind == BRANCH_REGULAR ? from : NULL;
    made = w.made;
    if (w.border) return b->end = BRANCH_AT_RANGE, LAG_OK;
    if (is_closed(b, at, step, p->cols)) return b->end = BRANCH_CLOSED, LAG_OK;
  }
  return rc;
}

void lag_branch_free(Branch *b) { lag_pool_free(&b->pool); }

int lag_branch_other(const BranchProblem *p, const BranchPoint *at, double *d) {
  Walk w;
  Branch scratch = {0};
  int cols = p->cols, rc = open_walk(&w, &scratch, p);
  rc = rc ? rc : p->place(p->of, at->u) || p->system(p->of, w.J, w.rhs) ? LAG_EDOMAIN : LAG_OK;
  if (rc == LAG_OK) {
    lag_singular_values(p->rows, cols, w.J, w.V, w.sigma);
    double size = 0, a = 0, b = 0; /* in the plane of the last two directions, across the tangent */
    for (int i = 0; i < cols; i++) {
      a += w.V[i * cols + cols - 2] * at->tangent[i];
      b += w.V[i * cols + cols - 1] * at->tangent[i];
    }
    for (int i = 0; i < cols; i++) {
      d[i] = b * w.V[i * cols + cols - 2] - a * w.V[i * cols + cols - 1];
      size += d[i] * d[i];
    }
    for (int i = 0; i < cols; i++) d[i] /= sqrt(size);
  }
  lag_branch_free(&scratch);
  return rc;
}
