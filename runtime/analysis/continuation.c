/* Pseudo-arclength continuation (continuation.h). */
#include "analysis/continuation.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "analysis/branch_walk.h"
#include "lag.h"
#include "numeric/singular_values.h"
#include "numeric/dense.h"

enum { MOST_LOCATE = 60 };

static void append(Branch *b, BranchPoint *at) {
  if (b->last) b->last->next = at;
  else b->first = at;
  b->last = at;
  b->npoints++;
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

/* Whether the parameter stays along the branch, as of a family at one value: its folds would be rounding. */
static int stands(const BranchPoint *at) { return fabs(at->fold) < 1e-6; }

/* Kind of the point between two others; BRANCH_REGULAR: none, or no further one after `after`. */
static BranchKind between(const BranchProblem *p, const BranchPoint *a, const BranchPoint *b, BranchKind after) {
  int fold = changes_sign(a->fold, b->fold) && !(stands(a) && stands(b)),
      zero = changes_sign(a->zero, b->zero) && !(a->stays && b->stays),
      minus = p->maps && changes_sign(a->minus, b->minus);
  if (fold && after == BRANCH_REGULAR) return BRANCH_FOLD;
  if (minus && after != BRANCH_DOUBLING && after != BRANCH_POINT) return BRANCH_DOUBLING;
  if (zero && !fold && after != BRANCH_POINT) return BRANCH_POINT;
  if (fold || minus || zero) return BRANCH_REGULAR;
  int grow = a->unstable - b->unstable, decay = a->stable - b->stable;
  if (abs(grow) < 2) return BRANCH_REGULAR;
  if (p->pairs || (grow == decay && grow % 2 == 0)) return BRANCH_COLLISION; /* a pair grows, and another decays */
  double from = lag_growth_sign(a->pair), to = lag_growth_sign(b->pair);
  if (!changes_sign(from, to) && !(from > 0 && to == 0.0)) return BRANCH_REGULAR;
  return p->maps ? BRANCH_TORUS : BRANCH_HOPF;
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
      BranchPoint *at = lag_walk_correct(w, u, u + w->cols) ? lag_walk_point(w, u, from->tangent) : NULL;
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
    BranchPoint *at = w->p->place(w->p->of, u) ? NULL : lag_walk_point(w, u, from->tangent);
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
  if (kind == BRANCH_HOPF || kind == BRANCH_TORUS) r.fa = lag_growth_sign(r.fa);
  const double rounding = 1e-12;
  double least = HUGE_VAL, last = HUGE_VAL, *u = lag_pool_doubles(&w->b->pool, 2 * (size_t)w->cols);
  BranchPoint *best = NULL;
  if (!u) return NULL;
  for (int k = 0; k < MOST_LOCATE && r.b - r.a > 1e-13 * to; k++) {
    double s = counts ? (r.a + r.b) / 2 : (r.a * r.fb - r.b * r.fa) / (r.fb - r.fa);
    if (!(s > r.a && s < r.b)) s = (r.a + r.b) / 2;
    between_points(w->cols, from, far, to, s, u, u + w->cols);
    w->enough = kind == BRANCH_POINT ? 0 : rounding; /* there the system is nearly singular */
    BranchPoint *at = lag_walk_correct(w, u, u + w->cols) ? lag_walk_point(w, u, from->tangent) : NULL;
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
    BranchPoint *at = lag_walk_point_at(w, d->at[from], s - d->s[from], d->at[from + 1], d->s[from + 1] - d->s[from]);
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
    stays |= kinds[k] == BRANCH_FOLD && stands(b);
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
  return lag_walk_correct(w, u, d) ? lag_walk_point(w, u, from->tangent) : NULL;
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

/* The longest step from a point: a part of what the branch has gone through, as motions grow; the parameter changes
 * little in it. */
static double longest_step(const Walk *w, const BranchPoint *from, const BranchLimits *l) {
  const double most = 2; /* at 4 a branch point of halo orbits was off by 7e-4 */
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
    BranchPoint *at = lag_walk_point_at(w, from, *step, before, -made);
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
  if (!lag_walk_correct(w, u, along)) return LAG_EDOMAIN;
  BranchPoint *at = lag_walk_point(w, u, along);
  if (!at) return w->b->pool.failed ? LAG_ENOMEM : LAG_EDOMAIN;
  if (!sign) memcpy(at->tangent, d, (size_t)w->cols * sizeof *d); /* at a branch point there are several */
  else if (lag_walk_tangent(w, along, at->tangent) == LAG_ESINGULAR) return LAG_ESINGULAR;
  at->fold = at->tangent[w->cols - 1];
  append(w->b, at);
  return LAG_OK;
}

int lag_branch_follow(Branch *b, const BranchProblem *p, const double *u0, const double *d, int sign,
                      const BranchLimits *limits) {
  Walk w;
  *b = (Branch){.end = BRANCH_AT_NUMBER};
  int rc = lag_walk_open(&w, b, p), last = p->cols - 1;
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
  int cols = p->cols, rc = lag_walk_open(&w, &scratch, p);
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
