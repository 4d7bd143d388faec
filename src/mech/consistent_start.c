/* Consistent starts: the scene's start values, moved onto the constraints by numeric/consistent_state.c, which a run
 * calls with emitted functions; here are the functions by value. */
#include "mech/consistent_start.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/dense_matrix.h"
#include "base/sparse_solve.h"
#include "base/spline.h"
#include "numeric/magnitudes.h"

typedef struct {
  const Eqns *e;
  StateSolver *solver;
  StateValues at;                /* values at `symbols` */
  uint32_t *place;               /* by coordinate: 1 + its index in the level's `free`; 0: it may not move */
  SparseElements mass, system;   /* of the current step */
  const unsigned char *given;    /* by symbol: the stage from which it may move */
  long double *symbols, *b;      /* by symbol; right-hand side and solution */
} Finder;

static SymId component(const Eqns *e, uint32_t i, int positions) {
  return positions ? e->m->coords.at[i].q : e->m->coords.at[i].v;
}

/* Evaluates the equations at the level's components x. */
static Finder *evaluate(const lag_level *w, const long double *x) {
  Finder *f = w->context;
  for (uint32_t i = 0; i < f->e->n; i++) f->symbols[component(f->e, i, w->positions)] = x[i];
  f->at = states_at(f->solver, f->symbols);
  return f;
}

/* --- scales --- */

static int same_unit(const Model *m, uint32_t i, uint32_t j) {
  return strcmp(m->coords.at[i].unit.text, m->coords.at[j].unit.text) == 0;
}

/* most[i] := largest absolute value among coordinates (velocities) with the unit of coordinate i; a model has few
 * units. */
static void largest_of_unit(const Eqns *e, const long double *symbols, int positions, long double *most) {
  Arena *arena = e->m->arena;
  uint32_t units = 0, *first = ARENA_ARRAY(arena, uint32_t, e->n + 1), *unit = ARENA_ARRAY(arena, uint32_t, e->n + 1);
  for (uint32_t i = 0; i < e->n; i++) {
    uint32_t k = 0;
    while (k < units && !same_unit(e->m, first[k], i)) k++;
    if (k == units) first[units++] = i, most[i] = 0;
    unit[i] = first[k];
    most[unit[i]] = fmaxl(most[unit[i]], fabsl(symbols[component(e, i, positions)]));
  }
  for (uint32_t i = 0; i < e->n; i++) most[i] = most[unit[i]];
}

/* reach[i] := scale of coordinate i or its velocity: the largest of its unit (velocities: at least that over the
 * scene's duration); 1 if that is 0, and at least 1 for an angle. */
static void coordinate_scales(const Eqns *e, const long double *symbols, int positions, long double *reach) {
  const Model *m = e->m;
  double span = m->scene.has_span ? fabs(m->scene.t1 - m->scene.t0) : 0;
  long double *places = ARENA_ARRAY(m->arena, long double, e->n);
  largest_of_unit(e, symbols, positions, reach);
  if (!positions) largest_of_unit(e, symbols, 1, places);
  for (uint32_t i = 0; i < e->n; i++) {
    const Coord *q = &m->coords.at[i];
    if (!positions) reach[i] = fmaxl(reach[i], places[i] / (span > 0 ? span : 1));
    reach[i] = lag_component_scale(reach[i], q->periodic, q->unit.text);
  }
}

void start_nearby_steps(const Eqns *e, const long double *symbols, long double part, long double *step) {
  coordinate_scales(e, symbols, 1, step);
  for (uint32_t i = 0; i < e->n; i++) step[i] = part * step[i] * lag_uneven((int)i);
}

/* --- the model at the state of a level --- */

/* Infinite where a double would overflow. */
static int residuals(const lag_level *w, long double *residual) {
  const StateValues at = evaluate(w, w->x)->at;
  for (int k = 0; k < w->rows; k++) {
    residual[k] = w->positions ? at.c[k] : at.r[k];
    if (fabsl(residual[k]) > DBL_MAX) residual[k] = INFINITY;
  }
  return 0;
}

static int jacobian(const lag_level *w, long double *A) {
  const StateValues at = evaluate(w, w->x)->at;
  for (int k = 0; k < w->entries; k++) A[k] = at.A[k];
  return 0;
}

static void scales(const lag_level *w, const long double *x, long double *reach) {
  const Finder *f = evaluate(w, x);
  coordinate_scales(f->e, f->symbols, w->positions, reach);
}

/* Terms to first order, and as the constraint's change over a displacement of the size of the model. */
static int terms(const lag_level *w, long double *size) {
  Arena *arena = ((Finder *)w->context)->e->m->arena;
  lag_level beside = *w;
  long double *reach = ARENA_ARRAY(arena, long double, (size_t)w->n + 1),
              *c = ARENA_ARRAY(arena, long double, (size_t)w->rows + 1);
  beside.x = ARENA_ARRAY(arena, long double, (size_t)w->n + 1);
  jacobian(w, w->A);
  for (int k = 0; k < w->rows; k++) size[k] = 0;
  for (int k = 0; k < w->entries; k++)
    if (w->row[k] < w->rows) size[w->row[k]] += fabsl(w->A[k] * w->x[w->col[k]]);
  scales(w, w->x, reach);
  for (int i = 0; i < w->n; i++) beside.x[i] = w->x[i] + reach[i] * lag_uneven(i);
  residuals(&beside, c);
  for (int k = 0; k < w->rows; k++) size[k] = fmaxl(size[k], fabsl(c[k]));
  return 0;
}

/* f->mass := M scaled to a largest entry of `size` (0: not scaled); the unit matrix if M is 0. */
static void find_mass(Finder *f, long double size) {
  Arena *arena = f->e->m->arena;
  long double most = dense_largest(f->at.mass, f->e->mass.n);
  f->mass.n = 0;
  if (most > 0) states_put_mass(f->e, f->at.mass, &f->mass);
  for (uint32_t k = 0; k < f->mass.n && size > 0; k++) f->mass.at[k].value = f->mass.at[k].value / most * size;
  for (uint32_t i = 0; i < f->e->n && !(most > 0); i++) sparse_put(arena, &f->mass, i, i, 1);
}

/* Puts M of the free components into the system; pull: b += M (asked - x). */
static void put_mass(Finder *f, const lag_level *w, long double pull) {
  for (uint32_t k = 0; k < f->mass.n; k++) {
    const SparseElement *x = &f->mass.at[k];
    uint32_t row = f->place[x->row], col = f->place[x->col];
    if (!row || !col) continue;
    long double value = lag_level_weight(w, (int)x->row) * lag_level_weight(w, (int)x->col) * x->value;
    sparse_put(f->e->m->arena, &f->system, row - 1, col - 1, value);
    f->b[row - 1] += pull * value * (w->asked[x->col] - w->x[x->col]);
  }
}

static void put_constraints(Finder *f, const lag_level *w) {
  Arena *arena = f->e->m->arena;
  for (int e = 0; e < w->entries; e++) {
    uint32_t row = (uint32_t)w->nfree + (uint32_t)w->row[e], col = f->place[w->col[e]];
    if (!col || w->row[e] >= w->rows) continue;
    sparse_put(arena, &f->system, row, col - 1, f->at.A[e]);
    sparse_put(arena, &f->system, col - 1, row, -f->at.A[e]);
  }
}

static int direction(const lag_level *w, long double pull, long double *d) {
  Finder *f = evaluate(w, w->x);
  uint32_t nf = (uint32_t)w->nfree, rows = (uint32_t)w->rows;
  long double size = dense_largest(f->at.A, (size_t)w->entries); /* M as large as A, which changes no direction */
  find_mass(f, size > 0 ? size : 1);
  memset(f->place, 0, f->e->n * sizeof *f->place);
  for (uint32_t i = 0; i < nf; i++) f->place[w->free[i]] = i + 1, f->b[i] = 0;
  f->system.n = 0;
  put_mass(f, w, pull);
  put_constraints(f, w);
  for (uint32_t k = 0; k < rows; k++) f->b[nf + k] = -w->residual[k];
  sparse_solve(f->e->m->arena, nf + rows, &f->system, f->b, 1e-13L, NULL);
  for (uint32_t i = 0; i < nf; i++) {
    if (!isfinite(f->b[i])) return 1;
    d[i] = f->b[i];
  }
  return 0;
}

static long double distance(const lag_level *w) {
  Finder *f = evaluate(w, w->x);
  long double s = 0;
  find_mass(f, 0);
  for (uint32_t k = 0; k < f->mass.n; k++) {
    uint32_t i = f->mass.at[k].row, j = f->mass.at[k].col;
    s += lag_level_weight(w, (int)i) * (w->x[i] - w->asked[i]) * f->mass.at[k].value * lag_level_weight(w, (int)j) *
         (w->x[j] - w->asked[j]);
  }
  return s;
}

static int stage(const lag_level *w, int i) {
  const Finder *f = w->context;
  return f->given[component(f->e, (uint32_t)i, w->positions)];
}

static int is_contact(const lag_level *w, int k) {
  const Eqns *e = ((Finder *)w->context)->e;
  for (uint32_t i = 0; i < e->m->contacts.n; i++)
    if (e->constraints.of[k] == &e->m->constraints.at[e->m->contacts.at[i].constraint]) return 1;
  return 0;
}

static const Contact *gap_of(const Eqns *e, int k) {
  for (uint32_t i = 0; i < e->m->contacts.n; i++) {
    const Contact *c = &e->m->contacts.at[i];
    int is_gap = !c->is_tangent && c->gap;
    if (is_gap && e->constraints.of[k] == &e->m->constraints.at[c->constraint]) return c;
  }
  return NULL;
}

/* size[rows] := sizes of terms of gaps at the symbols, w at the level of velocities. */
static void gap_sizes(const lag_level *w, long double *size) {
  Finder *f = w->context;
  Arena *arena = f->e->m->arena;
  lag_level at = *w;
  long double *all = ARENA_ARRAY(arena, long double, (size_t)w->rows + 1);
  at.positions = 1;
  at.rows = (int)f->e->constraints.nholonomic;
  at.x = ARENA_ARRAY(arena, long double, (size_t)w->n + 1);
  for (int i = 0; i < w->n; i++) at.x[i] = f->symbols[component(f->e, (uint32_t)i, 1)];
  terms(&at, all);
  evaluate(&at, at.x);
  for (int k = 0; k < at.rows; k++) size[k] = all[k];
}

/* As the runtime's: constraints/nearest_start.c. */
static int close_gap(const lag_level *w) {
  Finder *f = w->context;
  const Eqns *e = f->e;
  Arena *arena = e->m->arena;
  const long double rounding = 0x1p12L * DBL_EPSILON;
  size_t n = (size_t)w->rows + 1;
  long double *gap = ARENA_ARRAY(arena, long double, n), *was = ARENA_ARRAY(arena, long double, n),
              *asked = ARENA_ARRAY(arena, long double, n), *now = ARENA_ARRAY(arena, long double, n),
              *size = ARENA_ARRAY(arena, long double, n), fastest = rounding;
  const Contact *which = NULL;
  for (int k = 0; k < w->rows; k++) {
    const Contact *c = gap_of(e, k);
    if (c) was[k] = f->symbols[c->closed], f->symbols[c->closed] = 1;
  }
  gap_sizes(w, gap);
  StateValues at = evaluate(w, w->asked)->at;
  for (int k = 0; k < w->rows; k++) {
    asked[k] = at.r[k];
    gap[k] = k < (int)e->constraints.nholonomic && fabsl(at.c[k]) <= rounding * gap[k];
  }
  at = evaluate(w, w->x)->at;
  for (int k = 0; k < w->rows; k++) now[k] = at.r[k];
  terms(w, size);
  evaluate(w, w->x);
  for (int k = 0; k < w->rows; k++) {
    const Contact *c = gap_of(e, k);
    if (!c) continue;
    f->symbols[c->closed] = was[k];
    if (gap[k] == 0 || was[k] > 0 || !(-now[k] > fastest * size[k]) || asked[k] < -rounding * size[k]) continue;
    fastest = -now[k] / size[k];
    which = c;
  }
  if (which) f->symbols[which->closed] = 1;
  return which != NULL;
}

/* --- entry points --- */

int start_of_scene(const Eqns *e, long double *found, unsigned char *moved) {
  const Model *m = e->m;
  uint32_t all = expr_symbol_count(e->g) + 1;
  long double *asked = start_requested(e), *symbols = ARENA_ARRAY(m->arena, long double, all);
  for (uint32_t i = 0; i < all; i++) symbols[i] = asked[i];
  StartResult r = e->constraints.n ? start_find(e, states_new(e), symbols) : (StartResult){.kind = LAG_START_FOUND};
  if (r.kind != LAG_START_FOUND) {
    if (m->scene.starts.n) start_report(e, &r);
    symbols = asked;
  }
  long double *most = ARENA_ARRAY(m->arena, long double, e->n + 1);
  for (uint32_t i = 0; i < 2 * e->n; i++) {
    if (i % e->n == 0) largest_of_unit(e, symbols, i == 0, most);
    SymId at = component(e, i % e->n, i < e->n);
    found[i] = symbols[at];
    /* more than rounding of the largest of its unit */
    moved[i] = symbols != asked && fabsl(symbols[at] - asked[at]) > DBL_EPSILON / 4 * most[i % e->n];
  }
  return r.kind == LAG_START_FOUND || !m->scene.starts.n;
}

long double *start_requested(const Eqns *e) {
  const Model *m = e->m;
  long double *symbols = ARENA_ARRAY(m->arena, long double, expr_symbol_count(e->g) + 1);
  symbols[m->pi] = 3.14159265358979323846264338327950288L;
  symbols[m->time] = (long double)m->scene.t0;
  for (uint32_t i = 0; i < m->params.n; i++)
    if (m->params.at[i].value) expr_eval(e->g, &m->params.at[i].value, 1, symbols, &symbols[m->params.at[i].sym]);
  for (uint32_t i = 0; i < m->inputs.n; i++) {
    const Input *in = &m->inputs.at[i];
    if (in->table) symbols[in->sym] = spline_at(in->table, in->order, symbols[m->time]);
    else if (in->value) expr_eval(e->g, &in->value, 1, symbols, &symbols[in->sym]);
  }
  model_eval_starts(m, symbols);
  return symbols;
}

static const unsigned char *given_by(const Eqns *e) {
  const Model *m = e->m;
  unsigned char *given = ARENA_ARRAY(m->arena, unsigned char, expr_symbol_count(e->g) + 1);
  for (uint32_t i = 0; i < m->scene.starts.n; i++)
    if (!m->scene.starts.at[i].implied)
      given[m->scene.starts.at[i].target] = m->scene.starts.at[i].guess ? LAG_MOVES_SECOND : LAG_MOVES_LAST;
  for (uint32_t i = 0; i < m->scene.starts.n; i++) { /* implied: target is the first of a rotation's four components */
    uint32_t first = expr_symbol(m->g, m->scene.starts.at[i].target)->index;
    for (uint32_t k = first; m->scene.starts.at[i].implied && k < first + 4; k++)
      if (!given[m->coords.at[k].q]) given[m->coords.at[k].q] = LAG_MOVES_SECOND;
  }
  return given;
}

/* Room for a level of the constraints, with the functions above. */
static lag_level level_new(Finder *f) {
  Arena *a = f->e->m->arena;
  const Entries *A = &f->e->constraints.A;
  size_t n = f->e->n, m = f->e->constraints.n;
  int *row = ARENA_ARRAY(a, int, A->n + 1), *col = ARENA_ARRAY(a, int, A->n + 1);
  lag_level w = {.context = f,
                 .n = (int)n, .entries = (int)A->n, .row = row, .col = col, .exactly = f->e->m->scene.exactly.end != 0,
                 .rounding = DBL_EPSILON, .residuals = residuals, .jacobian = jacobian, .terms = terms,
                 .scales = scales, .direction = direction, .distance = distance, .stage = stage,
                 .is_contact = is_contact, .close_gap = f->e->m->contacts.n ? close_gap : NULL,
                 .A = ARENA_ARRAY(a, long double, A->n + 1),
                 .free = ARENA_ARRAY(a, int, n + 1)};
  long double **const by_component[] = {&w.x, &w.asked, &w.best, &w.from, &w.d, &w.along,
                                        &w.reach, &w.nearest, &w.other},
                      **const by_row[] = {&w.residual, &w.size, &w.terms_here, &w.slope, &w.has_terms};
  for (size_t i = 0; i < sizeof by_component / sizeof *by_component; i++)
    *by_component[i] = ARENA_ARRAY(a, long double, n + 1);
  for (size_t i = 0; i < sizeof by_row / sizeof *by_row; i++) *by_row[i] = ARENA_ARRAY(a, long double, m + 1);
  for (uint32_t k = 0; k < A->n; k++) row[k] = (int)A->at[k].row, col[k] = (int)A->at[k].col;
  return w;
}

static Finder finder_new(const Eqns *e, StateSolver *solver, long double *symbols) {
  Arena *a = e->m->arena;
  return (Finder){.e = e,
                  .solver = solver, .given = given_by(e), .symbols = symbols,
                  .place = ARENA_ARRAY(a, uint32_t, e->n + 1),
                  .b = ARENA_ARRAY(a, long double, (size_t)e->n + e->constraints.n + 1)};
}

/* Takes up positions, or velocities, of the symbols. */
static void begin_level(lag_level *w, int positions) {
  const Finder *f = w->context;
  w->positions = positions;
  w->rows = (int)(positions ? f->e->constraints.nholonomic : f->e->constraints.n);
  for (uint32_t i = 0; i < f->e->n; i++) w->x[i] = f->symbols[component(f->e, i, positions)];
}

StartResult start_find(const Eqns *e, StateSolver *solver, long double *symbols) {
  Finder f = finder_new(e, solver, symbols);
  lag_level w = level_new(&f);
  for (int positions = 1; positions >= 0; positions--) {
    int k;
    begin_level(&w, positions);
    lag_start_kind kind = lag_consistent_state(&w, &k);
    evaluate(&w, w.x);
    for (uint32_t i = 0; i < e->m->contacts.n; i++) symbols[e->m->contacts.at[i].closed] = 0;
    if (kind != LAG_START_FOUND) return (StartResult){kind, (uint32_t)k, !positions, w.residual[k]};
  }
  return (StartResult){.kind = LAG_START_FOUND};
}

int start_beside(const Eqns *e, StateSolver *solver, long double *symbols) {
  Finder f = finder_new(e, solver, symbols);
  lag_level w = level_new(&f);
  begin_level(&w, 1);
  int found = lag_state_beside(&w);
  evaluate(&w, w.x);
  return found;
}

/* --- messages for starts that are refused --- */

const char *start_residual_text(const Eqns *e, const StartResult *r) {
  const Model *m = e->m;
  Dim dim = e->constraints.of[r->constraint]->dim;
  int rate = r->velocities && r->constraint < e->constraints.nholonomic;
  const char *unit = dim_text(m->dims, dim); /* "1", "?" where units are not known */
  int bare = *unit == '1' || *unit == '?';
  if (!isfinite(r->residual)) return "";
  return arena_printf(m->arena, "; it is off by %.3Lg%s%s%s%s", fabsl(r->residual), bare ? "" : " [", bare ? "" : unit,
                      bare ? "" : "]",
                      rate            ? " in its rate"
                      : r->velocities ? " in its velocities"
                                      : "");
}

void start_report(const Eqns *e, const StartResult *r) {
  const Model *m = e->m;
  const Constraint *k = e->constraints.of[r->constraint];
  const char *scene = m->scene.name, *off = start_residual_text(e, r);
  switch (r->kind) {
    case LAG_START_FOUND: return;
    case LAG_START_NO_VALUE:
      diag_error(m->diags, k->span,
                 "scene %s: the constraint `%s` has no value at the start" HELP "start where it has one", scene,
                 k->name);
      return;
    case LAG_START_BROKEN:
      diag_error(m->diags, k->span, "scene %s: the start contradicts the constraint `%s`%s", scene, k->name, off);
      diag_help(m->diags, "without `exactly` the nearest start is taken");
      return;
    case LAG_START_FLAT:
      diag_error(m->diags, k->span,
                 "scene %s: the derivatives of the constraint `%s` vanish where it holds, so that no force can hold it",
                 scene, k->name);
      diag_help(m->diags, "write a constraint whose derivatives do not vanish: x = 0 in place of x^2 = 0");
      return;
    case LAG_START_STEEP:
      diag_error(m->diags, k->span, "scene %s: the derivatives of the constraint `%s` have no value where it holds",
                 scene, k->name);
      diag_help(m->diags, "write a constraint whose derivatives have values: x = 1 in place of sqrt(x - 1) = 0");
      return;
    case LAG_START_NONE:
      diag_error(m->diags, k->span, "scene %s: no state near its start obeys the constraint `%s`%s", scene, k->name,
                 off);
      diag_help(m->diags,
                "start nearer to a state that obeys it; where its derivatives vanish no direction leads there");
  }
}
