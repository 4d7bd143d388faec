/* Consistent starts. Positions: Gauss-Newton steps, damped until the residual falls (P. Deuflhard, Newton Methods for Nonlinear Problems (2004),
 * 4.3, DOI 10.1007/978-3-642-23899-4), from the scene's start or from states near it; then Newton-like steps along the constraints to the nearest
 * state. Velocities: one linear problem. runtime/constraints/consistent_start.c does the same in a run with emitted functions; tests compare the two. */
#include "mech/consistent_start.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/sparse_solve.h"

enum { MOST_STEPS = 100, MOST_HALVINGS = 30 };

typedef struct {
  const Eqns *e;
  StateSolver *solver;
  StateValues at;                 /* values at `symbols` */
  int velocities;                 /* current level: velocities, else positions */
  uint32_t n, rows;               /* number of coordinates; number of constraints of the level */
  uint32_t *free, nfree;          /* coordinates that may move */
  uint32_t *place;                /* by coordinate: 1 + its index in `free`; 0: it may not move */
  SparseElements mass, system;    /* of the current step */
  const unsigned char *given;     /* by symbol: the stage from which it may move */
  long double *symbols, *asked, *best, *from; /* by symbol */
  long double *size, *terms, *b, *d;
  unsigned char *has_terms;            /* by constraint: it has terms of finite size */
  uint32_t nsymbols;
} Finder;

/* Stages: components that may move are those that nobody set, then also rotations that nobody set, then all. */
enum { UNSET, ROTATIONS, ALL };

static SymId component(const Finder *f, uint32_t i) { return f->velocities ? f->e->m->coords.at[i].v : f->e->m->coords.at[i].q; }

static void evaluate(Finder *f) { f->at = states_at(f->solver, f->symbols); }

/* Residual of constraint k; infinite where a double would overflow. */
static long double residual(const Finder *f, uint32_t k) {
  long double x = f->velocities ? f->at.r[k] : f->at.c[k];
  return fabsl(x) > DBL_MAX ? INFINITY : x;
}

static void copy(const Finder *f, long double *to, const long double *from) { memcpy(to, from, f->nsymbols * sizeof *to); }

/* --- scales --- */

static int same_unit(const Model *m, uint32_t i, uint32_t j) { return strcmp(m->coords.at[i].unit.text, m->coords.at[j].unit.text) == 0; }

/* most[i] := largest absolute value among coordinates (velocities) with the unit of coordinate i. The first coordinate of each unit searches
 * for all of that unit. */
static void largest_of_unit(const Finder *f, const long double *symbols, int velocities, long double *most) {
  const Model *m = f->e->m;
  for (uint32_t i = 0; i < f->n; i++) {
    uint32_t first = 0;
    while (!same_unit(m, first, i)) first++;
    most[i] = first < i ? most[first] : 0;
    for (uint32_t j = i; first == i && j < f->n; j++)
      if (same_unit(m, i, j)) most[i] = fmaxl(most[i], fabsl(symbols[velocities ? m->coords.at[j].v : m->coords.at[j].q]));
  }
}

/* reach[i] := scale of coordinate i or its velocity: the largest of its unit (velocities: at least that over the scene's duration); 1 if that is 0,
 * and at least 1 for an angle. */
static void coordinate_scales(const Finder *f, long double *reach) {
  const Model *m = f->e->m;
  double span = m->scene.has_span ? fabs(m->scene.t1 - m->scene.t0) : 0;
  long double *places = ARENA_ARRAY(m->arena, long double, f->n);
  largest_of_unit(f, f->symbols, f->velocities, reach);
  if (f->velocities) largest_of_unit(f, f->symbols, 0, places);
  for (uint32_t i = 0; i < f->n; i++) {
    const Coord *q = &m->coords.at[i];
    int is_angle = q->periodic || !*q->unit.text || strcmp(q->unit.text, "rad") == 0 || strcmp(q->unit.text, "deg") == 0;
    if (f->velocities) reach[i] = fmaxl(reach[i], places[i] / (span > 0 ? span : 1));
    if (reach[i] <= 0 || (reach[i] < 1 && is_angle)) reach[i] = 1;
  }
}

/* step[i] := `part` times the scale of coordinate i, times a factor from 0.5 to 1.5 (golden ratio sequence), different for each i. */
static void steps_beside(const Finder *f, long double part, long double *step) {
  coordinate_scales(f, step);
  for (uint32_t i = 0; i < f->n; i++) step[i] = part * step[i] * (0.5L + fmodl(0.618033988749894848L * (i + 1), 1));
}

void start_nearby_steps(const Eqns *e, long double *symbols, long double part, long double *step) {
  steps_beside(&(Finder){.e = e, .n = e->n, .symbols = symbols}, part, step);
}

/* size[k] := magnitude of the terms of constraint k: to first order, and as its change over a displacement of the size of the model. */
static void find_terms(Finder *f, long double *size) {
  const Entries *A = &f->e->constraints.A;
  evaluate(f);
  for (uint32_t k = 0; k < f->rows; k++) size[k] = 0;
  for (uint32_t i = 0; i < A->n; i++)
    if (A->at[i].row < f->rows) size[A->at[i].row] += fabsl(f->at.A[i] * f->symbols[component(f, A->at[i].col)]);
  long double *was = f->from;
  copy(f, was, f->symbols);
  steps_beside(f, 1, f->d);
  for (uint32_t i = 0; i < f->n; i++) f->symbols[component(f, i)] += f->d[i];
  evaluate(f);
  for (uint32_t k = 0; k < f->rows; k++) size[k] = fmaxl(size[k], fabsl(residual(f, k)));
  copy(f, f->symbols, was);
  evaluate(f);
}

/* The constraint with the largest residual in units of its terms' rounding; *times: that number of units. */
static uint32_t worst_constraint(Finder *f, long double *times) {
  uint32_t which = 0;
  *times = -1;
  find_terms(f, f->terms);
  for (uint32_t k = 0; k < f->rows; k++) {
    long double x = fabsl(residual(f, k)), part = x == 0 ? 0 : x / (DBL_EPSILON * f->terms[k]);
    part = isnan(part) ? INFINITY : part;
    if (part > *times) *times = part, which = k;
  }
  return which;
}

/* Merit function: sum of squares of the scaled residuals; infinite where they have no value. */
static long double merit(Finder *f) {
  long double s = 0;
  evaluate(f);
  for (uint32_t k = 0; k < f->rows; k++) s += residual(f, k) / f->size[k] * (residual(f, k) / f->size[k]);
  return isfinite(s) ? s : INFINITY;
}

/* --- steps --- */

static long double largest(const long double *x, uint32_t n) {
  long double most = 0;
  for (uint32_t i = 0; i < n; i++) most = fmaxl(most, fabsl(x[i]));
  return most;
}

/* f->mass := M scaled to a largest entry of `size` (0: not scaled); the unit matrix if M is 0. */
static void find_mass(Finder *f, long double size) {
  Arena *arena = f->e->m->arena;
  long double most = largest(f->at.mass, f->e->mass.n);
  f->mass.n = 0;
  if (most > 0) states_put_mass(f->e, f->at.mass, &f->mass);
  for (uint32_t k = 0; k < f->mass.n && size > 0; k++) f->mass.at[k].value = f->mass.at[k].value / most * size;
  for (uint32_t i = 0; i < f->n && !(most > 0); i++) sparse_put(arena, &f->mass, i, i, 1);
}

/* Puts M of the free components into the system; pull: b += M (asked - here). */
static void put_mass(Finder *f, int pull) {
  for (uint32_t k = 0; k < f->mass.n; k++) {
    const SparseElement *x = &f->mass.at[k];
    uint32_t row = f->place[x->row], col = f->place[x->col];
    SymId at = component(f, x->col);
    if (!row || !col) continue;
    sparse_put(f->e->m->arena, &f->system, row - 1, col - 1, x->value);
    if (pull) f->b[row - 1] += x->value * (f->asked[at] - f->symbols[at]);
  }
}

static void put_constraints(Finder *f) {
  Arena *arena = f->e->m->arena;
  const Entries *A = &f->e->constraints.A;
  for (uint32_t e = 0; e < A->n; e++) {
    uint32_t row = f->nfree + A->at[e].row, col = f->place[A->at[e].col];
    if (!col || A->at[e].row >= f->rows) continue;
    sparse_put(arena, &f->system, row, col - 1, f->at.A[e]);
    sparse_put(arena, &f->system, col - 1, row, -f->at.A[e]);
  }
}

/* Solves M d - A^T l = pull M (asked - here), A d = -residual for d[nfree]. 0: not finite. */
static int direction(Finder *f, int pull) {
  uint32_t nf = f->nfree;
  evaluate(f);
  long double size = largest(f->at.A, f->e->constraints.A.n); /* M as large as A, which changes no direction */
  find_mass(f, size > 0 ? size : 1);
  memset(f->place, 0, f->n * sizeof *f->place);
  for (uint32_t i = 0; i < nf; i++) f->place[f->free[i]] = i + 1, f->b[i] = 0;
  f->system.n = 0;
  put_mass(f, pull);
  put_constraints(f);
  for (uint32_t k = 0; k < f->rows; k++) f->b[nf + k] = -residual(f, k);
  sparse_solve(f->e->m->arena, nf + f->rows, &f->system, f->b, 1e-13L, NULL);
  for (uint32_t i = 0; i < nf; i++) {
    if (!isfinite(f->b[i])) return 0;
    f->d[i] = f->b[i];
  }
  return 1;
}

static void move(Finder *f, const long double *from, long double part) {
  for (uint32_t i = 0; i < f->nfree; i++) {
    SymId at = component(f, f->free[i]);
    f->symbols[at] = from[at] + part * f->d[i];
  }
}

/* Damped Gauss-Newton steps. Returns whether they end on the constraints, up to 1024 units of rounding. */
static int descend(Finder *f) {
  long double before = merit(f), times;
  for (int step = 0; step < MOST_STEPS && before > 0 && f->nfree > 0; step++) {
    long double part = 1, now = INFINITY;
    if (!direction(f, 0)) return 0;
    copy(f, f->from, f->symbols);
    for (int i = 0; i < MOST_HALVINGS && !(now < before); i++, part /= 2) {
      move(f, f->from, part);
      now = merit(f);
    }
    if (!(now <= before)) copy(f, f->symbols, f->from);
    if (!(now < before * (1 - 1e-6L))) break;
    before = now;
  }
  worst_constraint(f, &times);
  return times <= 1024;
}

static long double moved(const Finder *f, uint32_t i) { return f->symbols[component(f, i)] - f->asked[component(f, i)]; }

static long double distance(Finder *f) {
  long double s = 0;
  evaluate(f);
  find_mass(f, 0);
  for (uint32_t k = 0; k < f->mass.n; k++) s += moved(f, f->mass.at[k].row) * f->mass.at[k].value * moved(f, f->mass.at[k].col);
  return s;
}

/* Moves to the nearest state on the constraints, by steps as long as the distance falls. */
static void approach(Finder *f) {
  for (int step = 0; step < MOST_STEPS; step++) {
    copy(f, f->best, f->symbols);
    if (!direction(f, 1)) return;
    long double before = distance(f);
    move(f, f->best, 1);
    if (descend(f) && distance(f) < before * (1 - 1e-14L)) continue;
    copy(f, f->symbols, f->best);
    return;
  }
}

/* Whether component i occurs in a constraint of the level. */
static int is_held(const Finder *f, uint32_t i) {
  const Entries *A = &f->e->constraints.A;
  uint32_t k = 0;
  while (k < A->n && !(A->at[k].col == i && A->at[k].row < f->rows)) k++;
  return k < A->n;
}

/* Descends from the start asked for, then from displaced starts; positions continue to the nearest state. 0: none of them ends on the constraints. */
static int reach(Finder *f) {
  static const long double beside[] = {0, 1e-3L, -1e-3L, 0.03L, -0.03L, 0.3L, -0.3L, 1, -1};
  long double typical = 0;
  size_t tries = f->velocities ? 1 : sizeof beside / sizeof *beside;
  for (uint32_t i = 0; i < f->n; i++) typical = fmaxl(typical, fabsl(f->asked[component(f, i)]));
  for (size_t k = 0; k < tries && f->nfree > 0; k++) {
    copy(f, f->symbols, f->asked);
    for (uint32_t i = 0; i < f->nfree; i++)
      if (is_held(f, f->free[i])) f->symbols[component(f, f->free[i])] += beside[k] * (typical > 0 ? typical : 1) * (0.5L + fmodl(0.618033988749894848L * (i + 1), 1));
    if (!descend(f)) continue;
    if (!f->velocities) approach(f);
    return 1;
  }
  return 0;
}

/* Lists the components that may move at this stage. */
static void choose_free(Finder *f, int stage) {
  f->nfree = 0;
  for (uint32_t i = 0; i < f->n; i++)
    if (f->given[component(f, i)] <= stage) f->free[f->nfree++] = i;
}

/* --- refused starts --- */

static StartResult fault(const Finder *f, StartKind kind, uint32_t k) { return (StartResult){kind, k, f->velocities, residual(f, k)}; }

static int is_contact(const Eqns *e, uint32_t k) {
  for (uint32_t i = 0; i < e->m->contacts.n; i++)
    if (e->constraints.of[k] == &e->m->constraints.at[e->m->contacts.at[i].constraint]) return 1;
  return 0;
}

/* f->terms[k] := change of constraint k, to first order, when each coordinate moves by its scale, here or as asked for. */
static void constraint_slopes(Finder *f) {
  const Entries *A = &f->e->constraints.A;
  Finder asked = *f;
  asked.symbols = f->asked;
  long double *reach = ARENA_ARRAY(f->e->m->arena, long double, f->n), *reach_asked = ARENA_ARRAY(f->e->m->arena, long double, f->n);
  coordinate_scales(f, reach);
  coordinate_scales(&asked, reach_asked);
  evaluate(f);
  for (uint32_t k = 0; k < f->rows; k++) f->terms[k] = 0;
  for (uint32_t i = 0; i < A->n; i++) {
    long double far = fmaxl(reach[A->at[i].col], reach_asked[A->at[i].col]);
    if (A->at[i].row < f->rows) f->terms[A->at[i].row] += fabsl(f->at.A[i]) * far;
  }
}

static int is_flat(const Finder *f, uint32_t k) { return f->has_terms[k] && f->terms[k] < 1e-6L * f->size[k]; }

/* Whether a constraint with vanishing derivatives here has them at a nearby state on the constraints, too; a linkage at its dead centre has not. */
static int is_flat_beside(Finder *f, uint32_t k) {
  copy(f, f->best, f->symbols);
  choose_free(f, ALL);
  steps_beside(f, 0.01L, f->d);
  for (uint32_t i = 0; i < f->n; i++)
    if (is_held(f, i)) f->symbols[component(f, i)] += f->d[i];
  int flat = !descend(f);
  constraint_slopes(f);
  flat |= is_flat(f, k);
  copy(f, f->symbols, f->best);
  constraint_slopes(f);
  return flat;
}

static StartResult check_slopes(Finder *f, int reached) {
  constraint_slopes(f);
  for (uint32_t k = 0; k < f->rows; k++) {
    if (is_contact(f->e, k)) continue;
    if (!isfinite(f->terms[k]) && reached) return fault(f, START_STEEP, k);
    if (!is_flat(f, k)) continue;
    if (!reached && fabsl(residual(f, k)) > 1e-6L * f->size[k]) return fault(f, START_NONE, k); /* violated where it is flat */
    if (!reached || is_flat_beside(f, k)) return fault(f, START_FLAT, k);
  }
  return (StartResult){.kind = START_FOUND};
}

/* Brings one level, positions or velocities, onto its constraints, stage by stage; checks their derivatives there. */
static StartResult satisfy_level(Finder *f, int velocities) {
  const Constraints *k = &f->e->constraints;
  f->velocities = velocities;
  f->rows = velocities ? k->n : k->nholonomic;
  if (!f->rows) return (StartResult){.kind = START_FOUND};
  copy(f, f->asked, f->symbols);
  long double off;
  uint32_t which = worst_constraint(f, &off);
  for (uint32_t i = 0; i < f->rows; i++) {
    f->has_terms[i] = f->terms[i] > 0 && isfinite(f->terms[i]);
    f->size[i] = f->has_terms[i] ? f->terms[i] : 1;
  }
  if (!isfinite(merit(f))) return fault(f, START_NO_VALUE, which);
  if (off > 2) {
    if (f->e->m->scene.exactly.end && !(off <= 1 / sqrtl(DBL_EPSILON))) return fault(f, START_BROKEN, which);
    int found = 0;
    for (int stage = UNSET; stage <= ALL && !found; stage++) {
      uint32_t before = f->nfree;
      choose_free(f, stage);
      found = (stage == UNSET || f->nfree != before) && reach(f);
    }
    if (!found) {
      copy(f, f->symbols, f->asked);
      descend(f); /* the least residual from the start asked for, to report it */
      StartResult flat = velocities ? (StartResult){.kind = START_FOUND} : check_slopes(f, 0);
      which = worst_constraint(f, &off);
      return flat.kind != START_FOUND ? flat : fault(f, START_NONE, which);
    }
  }
  return velocities ? (StartResult){.kind = START_FOUND} : check_slopes(f, 1);
}

/* --- entry points --- */

/* Whether component i of [q|v] moved by more than rounding of the largest of its unit. */
static int is_moved(const Eqns *e, const long double *asked, const long double *found, uint32_t i) {
  const Model *m = e->m;
  const Coord *q = &m->coords.at[i % e->n];
  long double most = 0;
  for (uint32_t j = 0; j < e->n; j++) {
    SymId at = i < e->n ? m->coords.at[j].q : m->coords.at[j].v;
    if (strcmp(q->unit.text, m->coords.at[j].unit.text) == 0) most = fmaxl(most, fabsl(found[at]));
  }
  SymId at = i < e->n ? q->q : q->v;
  return fabsl(found[at] - asked[at]) > DBL_EPSILON / 4 * most;
}

int start_of_scene(const Eqns *e, long double *found, unsigned char *moved) {
  const Model *m = e->m;
  uint32_t all = expr_symbol_count(e->g) + 1;
  long double *asked = start_requested(e), *symbols = ARENA_ARRAY(m->arena, long double, all);
  for (uint32_t i = 0; i < all; i++) symbols[i] = asked[i];
  StartResult r = e->constraints.n ? start_find(e, states_new(e), symbols) : (StartResult){.kind = START_FOUND};
  if (r.kind != START_FOUND) {
    if (m->scene.starts.n) start_report(e, &r);
    symbols = asked;
  }
  for (uint32_t i = 0; i < 2 * e->n; i++) {
    found[i] = symbols[i < e->n ? m->coords.at[i].q : m->coords.at[i - e->n].v];
    moved[i] = symbols != asked && is_moved(e, asked, symbols, i);
  }
  return r.kind == START_FOUND || !m->scene.starts.n;
}

long double *start_requested(const Eqns *e) {
  const Model *m = e->m;
  long double *symbols = ARENA_ARRAY(m->arena, long double, expr_symbol_count(e->g) + 1);
  symbols[m->pi] = 3.14159265358979323846264338327950288L;
  symbols[m->time] = (long double)m->scene.t0;
  for (uint32_t i = 0; i < m->params.n; i++)
    if (m->params.at[i].value) expr_eval(e->g, &m->params.at[i].value, 1, symbols, &symbols[m->params.at[i].sym]);
  for (uint32_t i = 0; i < m->scene.starts.n; i++) {
    const Start *s = &m->scene.starts.at[i];
    expr_eval(e->g, &s->value, 1, symbols, &symbols[s->target]);
  }
  return symbols;
}

static const unsigned char *given_by(const Eqns *e) {
  const Model *m = e->m;
  unsigned char *given = ARENA_ARRAY(m->arena, unsigned char, expr_symbol_count(e->g) + 1);
  for (uint32_t i = 0; i < m->scene.starts.n; i++)
    if (!m->scene.starts.at[i].implied) given[m->scene.starts.at[i].target] = ALL;
  for (uint32_t i = 0; i < m->scene.starts.n; i++) { /* implied: target is the first of a rotation's four components */
    uint32_t first = expr_symbol(m->g, m->scene.starts.at[i].target)->index;
    for (uint32_t k = first; m->scene.starts.at[i].implied && k < first + 4; k++)
      if (!given[m->coords.at[k].q]) given[m->coords.at[k].q] = ROTATIONS;
  }
  return given;
}

StartResult start_find(const Eqns *e, StateSolver *solver, long double *symbols) {
  Arena *a = e->m->arena;
  uint32_t n = e->n, m = e->constraints.n, all = expr_symbol_count(e->g) + 1, w = n + m;
  Finder f = {.e = e, .solver = solver, .n = n, .nsymbols = all, .symbols = symbols, .given = given_by(e)};
  f.asked = ARENA_ARRAY(a, long double, all);
  f.best = ARENA_ARRAY(a, long double, all);
  f.from = ARENA_ARRAY(a, long double, all);
  f.size = ARENA_ARRAY(a, long double, m + 1);
  f.terms = ARENA_ARRAY(a, long double, m + 1);
  f.has_terms = ARENA_ARRAY(a, unsigned char, m + 1);
  f.b = ARENA_ARRAY(a, long double, w + 1);
  f.d = ARENA_ARRAY(a, long double, n + 1);
  f.free = ARENA_ARRAY(a, uint32_t, n + 1);
  f.place = ARENA_ARRAY(a, uint32_t, n + 1);
  StartResult r = satisfy_level(&f, 0);
  return r.kind == START_FOUND ? satisfy_level(&f, 1) : r;
}
