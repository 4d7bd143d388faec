/* Linear algebra on normal forms where the system is small; otherwise a combination of rows, whose coefficients
 * numbers at states suggest. Numbers refute, and never prove. */
#include "mech/motion_proof.h"

#include <math.h>

#include "base/dense_matrix.h"
#include "base/tolerance.h"
#include "mech/constrain.h"
#include "mech/states.h"
#include "sym/prove.h"
#include "sym/diff.h"
#include "sym/simplify.h"

/* --- by solving --- */

static Expr with_definitions(const Eqns *e, Expr x) {
  return e->definitions ? expr_substitute(e->g, x, e->definitions, expr_symbol_count(e->g) + 1, "") : x;
}

/* Proves that the difference is 0 by solving M q'' - A^T lambda = f, A q'' = demand for accelerations and
 * multipliers. Redundant constraints leave that undecided; so would contacts, whose rows are zero while they are
 * open and are left out. */
static Verdict prove_by_solving(const Eqns *e, Expr difference) {
  const Model *m = e->m;
  const Constraints *c = &e->constraints;
  ExprGraph *g = e->g;
  uint32_t n = e->n, w = n, *row = ARENA_ARRAY(m->arena, uint32_t, c->n + 1);
  for (uint32_t i = 0; i < c->n; i++) row[i] = UINT32_MAX;
  for (uint32_t k = 0; k < c->A.n; k++)
    if (row[c->A.at[k].row] == UINT32_MAX && !expr_is_zero(g, with_definitions(e, c->A.at[k].e)))
      row[c->A.at[k].row] = w++;
  Expr *M = ARENA_ARRAY(m->arena, Expr, (size_t)w * w + 1), *f = ARENA_ARRAY(m->arena, Expr, w + 1);
  SymId *acc = ARENA_ARRAY(m->arena, SymId, w + 1);
  for (size_t i = 0; i < (size_t)w * w; i++) M[i] = expr_int(g, 0);
  for (uint32_t i = 0; i < n; i++) {
    acc[i] = m->coords.at[i].a;
    f[i] = c->n ? with_definitions(e, e->system.f[i]) : e->f[i];
    for (uint32_t k = 0; k < n; k++) M[i * w + k] = eqns_mass(e, i, k);
  }
  for (uint32_t i = 0; i < c->n; i++) {
    if (row[i] == UINT32_MAX) continue;
    acc[row[i]] = c->of[i]->multiplier;
    f[row[i]] = with_definitions(e, c->demand[i]);
  }
  for (uint32_t k = 0; k < c->A.n; k++) {
    uint32_t i = row[c->A.at[k].row], j = c->A.at[k].col;
    if (i == UINT32_MAX) continue;
    Expr x = with_definitions(e, c->A.at[k].e);
    M[i * w + j] = x;
    M[j * w + i] = expr_neg(g, x);
  }
  return prove_solves(g, w, M, f, acc, difference, NULL);
}

/* --- by a combination of rows --- */

typedef struct {
  const Eqns *e;
  ExprGraph *g;
  VEC(Expr) row;      /* each is 0 along motions, and linear in the unknowns */
  VEC(SymId) unknown; /* accelerations, multipliers, then velocities of a model with constraints */
  uint32_t square;    /* number of the first rows, for as many accelerations and multipliers */
} RowSearch;

static void add_product(RowSearch *w, Expr *row, Expr factor, SymId unknown) {
  Expr part = expr_mul(w->g, with_definitions(w->e, factor), expr_symbol(w->g, unknown)->node);
  *row = expr_add(w->g, *row, part);
}

/* Rows M q'' - f, with the multipliers' forces in f. */
static void add_motion_rows(RowSearch *w) {
  const Eqns *e = w->e;
  Expr *row = ARENA_ARRAY(e->m->arena, Expr, e->n + 1);
  for (uint32_t i = 0; i < e->n; i++) row[i] = expr_neg(w->g, with_definitions(e, e->f[i]));
  for (uint32_t k = 0; k < e->mass.n; k++) {
    const MassEntry *x = &e->mass.at[k];
    add_product(w, &row[x->row], x->e, e->m->coords.at[x->col].a);
    if (x->row != x->col) add_product(w, &row[x->col], x->e, e->m->coords.at[x->row].a);
  }
  for (uint32_t i = 0; i < e->n; i++) {
    vec_push(e->m->arena, &w->row, expr_expand_defs(w->g, row[i]));
    vec_push(e->m->arena, &w->unknown, e->m->coords.at[i].a);
  }
}

/* Rows A q'' - demand and r. */
static void add_constraint_rows(RowSearch *w) {
  const Eqns *e = w->e;
  const Constraints *c = &e->constraints;
  Expr *row = ARENA_ARRAY(e->m->arena, Expr, c->n + 1);
  for (uint32_t k = 0; k < c->n; k++) row[k] = expr_neg(w->g, with_definitions(e, c->demand[k]));
  for (uint32_t i = 0; i < c->A.n; i++)
    add_product(w, &row[c->A.at[i].row], c->A.at[i].e, e->m->coords.at[c->A.at[i].col].a);
  for (uint32_t k = 0; k < c->n; k++) {
    if (contact_of_constraint(e->m, c->of[k])) continue;
    vec_push(e->m->arena, &w->row, expr_expand_defs(w->g, row[k]));
    vec_push(e->m->arena, &w->unknown, c->of[k]->multiplier);
  }
  w->square = w->row.n;
  for (uint32_t k = 0; k < c->n; k++)
    if (!contact_of_constraint(e->m, c->of[k]))
      vec_push(e->m->arena, &w->row, expr_expand_defs(w->g, with_definitions(e, c->r[k])));
  for (uint32_t i = 0; i < e->n && c->n; i++) vec_push(e->m->arena, &w->unknown, e->m->coords.at[i].v);
}

/* Whether x divides by what may be 0 along a motion: then a row times x proves nothing there. */
static int may_be_singular(ExprGraph *g, Expr x) {
  const unsigned moves = 1u << SYM_COORD | 1u << SYM_VEL | 1u << SYM_TIME | 1u << SYM_STATE | 1u << SYM_INPUT;
  ExprList all = expr_topo(g, &x, 1);
  for (uint32_t i = 0; i < all.n; i++)
    for (uint32_t k = 0; expr_op(g, all.at[i]) == EX_PROD && k < expr_pairs(g, all.at[i], EX_PROD); k++) {
      Num power;
      Expr base = expr_pair(g, all.at[i], EX_PROD, k, &power);
      if (num_sign(power) < 0 && expr_kinds(g, base) & moves && !expr_is_nonzero(g, base)) return 1;
    }
  return 0;
}

/* --- the combination of all rows that numbers suggest --- */

enum { LOOKS = 4 };
/* Values at LOOKS states: coefficients of the rows; parts of x, then constants, which may be factors of
 * coefficients. */
typedef struct {
  VEC(Expr) factor; /* the number 1 first */
  uint32_t parts;   /* number of those that are parts of x */
  long double *value[LOOKS], *c[LOOKS];
} Looks;

/* Rows, and the unknowns that a combination of them takes out. */
typedef struct {
  const Expr *row;
  const SymId *unknown;
  uint32_t rows, unknowns;
} RowBlock;

/* Factors: 1, the parts of x and of its slopes by the unknowns, parameters and constant masses. */
static void find_factors(const RowSearch *w, const RowBlock *b, Expr x, Looks *to) {
  Arena *a = w->e->m->arena;
  Expr *root = ARENA_ARRAY(a, Expr, b->unknowns + 1);
  expr_gradient(w->g, x, b->unknown, b->unknowns, root);
  root[b->unknowns] = x;
  ExprList parts = expr_topo(w->g, root, b->unknowns + 1), of_rows = expr_topo(w->g, w->row.at, w->square);
  vec_push(a, &to->factor, expr_int(w->g, 1));
  for (uint32_t i = 0; i < parts.n; i++) vec_push(a, &to->factor, parts.at[i]);
  to->parts = to->factor.n;
  for (uint32_t i = 0; i < of_rows.n; i++)
    if (expr_op(w->g, of_rows.at[i]) == EX_SYM && expr_sym_of(w->g, of_rows.at[i])->kind == SYM_PARAM)
      vec_push(a, &to->factor, of_rows.at[i]);
  for (uint32_t i = 0; i < w->e->mass.n; i++) {
    Expr m = w->e->mass.at[i].e;
    if (expr_is_constant(w->g, m) && m != to->factor.at[to->factor.n - 1]) vec_push(a, &to->factor, m);
  }
}

/* c := coefficients with W^T c = dx/d(unknowns) in least squares, from v = [W, dx/d(unknowns)]; 0: dependent rows,
 * or no values. */
static int fit_rows(Arena *a, const RowBlock *b, const long double *v, long double *c) {
  uint32_t n = b->rows, m = b->unknowns;
  long double *G = ARENA_ARRAY(a, long double, (size_t)n * n + 1);
  for (uint32_t i = 0; i < (n + 1) * m; i++)
    if (!isfinite(v[i])) return 0;
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t j = 0; j <= n; j++) {
      long double sum = 0;
      for (uint32_t k = 0; k < m; k++) sum += v[i * m + k] * v[j * m + k];
      *(j < n ? &G[i * n + j] : &c[i]) = sum;
    }
  return dense_solve_rows(a, n, G, 1, c);
}

/* Coefficients and factors at LOOKS states that obey the constraints; 0: the rows are dependent at one, or too few
 * are found. */
static int look(const RowSearch *w, const RowBlock *b, Expr x, Looks *to) {
  Arena *a = w->e->m->arena;
  uint32_t n = b->rows, m = b->unknowns, slopes = (n + 1) * m;
  Expr *root = ARENA_ARRAY(a, Expr, (size_t)slopes + to->factor.n);
  for (uint32_t i = 0; i <= n; i++) expr_gradient(w->g, i < n ? b->row[i] : x, b->unknown, m, root + i * m);
  memcpy(root + slopes, to->factor.at, to->factor.n * sizeof *root);
  EvalTape *tape = eval_tape(w->g, root, slopes + to->factor.n);
  long double *symbols = ARENA_ARRAY(a, long double, expr_symbol_count(w->g) + 1);
  StateSolver *solver = w->e->constraints.n ? states_new(w->e) : NULL;
  uint32_t seen = 0;
  for (uint32_t seed = 1; seed <= 4 * LOOKS && seen < LOOKS; seed++) {
    long double *v = ARENA_ARRAY(a, long double, slopes + to->factor.n);
    sample_state(w->g, seed, symbols);
    if (solver && !states_complete(solver, symbols)) continue;
    to->c[seen] = ARENA_ARRAY(a, long double, n + 1);
    to->value[seen] = v + slopes;
    eval_run(tape, symbols, v);
    if (!fit_rows(a, b, v, to->c[seen++])) return 0;
  }
  return seen == LOOKS;
}

/* factor[part]^e1 factor[constant]^e2 */
typedef struct {
  uint32_t part, constant;
  int e1, e2;
} Monomial;

/* The ratio p/q, q small, of coefficient i to the monomial at all states; the number 0: none. */
static Num ratio_of(const Looks *l, uint32_t i, Monomial m) {
  const long double tiny = 1e-9L;
  long double first = 0;
  for (uint32_t s = 0; s < LOOKS; s++) {
    long double a = l->value[s][m.part], b = l->value[s][m.constant];
    long double r = l->c[s][i] / (m.e1 < 0 ? 1 / a : a) / (m.e2 < 0 ? 1 / b : b);
    if (s == 0) first = r;
    if (!isfinite(r) || fabsl(r - first) > tiny * fabsl(first)) return num_int(0);
  }
  for (int q = 1; q <= 24 && fabsl(first) < 1e6L; q++)
    if (fabsl(first * q - roundl(first * q)) < tiny * q * fabsl(first)) return num_ratio((int64_t)roundl(first * q), q);
  return num_int(0);
}

/* Coefficient i as a number times a part of x, a constant, or their inverses; 0: it is none. */
static Expr coefficient(const RowSearch *w, const Looks *l, uint32_t i) {
  int zero = 1;
  for (uint32_t s = 0; s < LOOKS; s++) zero &= fabsl(l->c[s][i]) < 1e-12L;
  if (zero) return expr_int(w->g, 0);
  for (uint32_t k = 0; k < 2 * l->parts; k++)
    for (uint32_t p = 2 * l->parts - 1; p < 2 * l->factor.n; p++) {
      Monomial m = {k / 2, p < 2 * l->parts ? 0 : p / 2, k % 2 ? -1 : 1, p % 2 ? -1 : 1};
      Num r = ratio_of(l, i, m);
      if (num_is_zero(r)) continue;
      Expr a = expr_pow_num(w->g, l->factor.at[m.part], num_int(m.e1));
      Expr b = expr_pow_num(w->g, l->factor.at[m.constant], num_int(m.e2));
      return expr_scale(w->g, r, expr_mul(w->g, a, b));
    }
  return 0;
}

/* x less the combination of rows that takes the unknowns out of it; x itself: none is found. */
static Expr without_rows(const RowSearch *w, const RowBlock *b, Expr x) {
  enum { FACTORS_MOST = 2000 };
  Looks l = {0};
  Expr left = x;
  if (!b->rows) return x;
  find_factors(w, b, x, &l);
  if (l.factor.n > FACTORS_MOST || !look(w, b, x, &l)) return x;
  for (uint32_t i = 0; i < b->rows; i++) {
    Expr c = coefficient(w, &l, i);
    if (!c || may_be_singular(w->g, c)) return x;
    left = expr_sub(w->g, left, expr_mul(w->g, c, b->row[i]));
  }
  return left;
}

static int prove_by_rows(const Eqns *e, Expr x) {
  enum { ROWS_MOST = 200, LONGEST = 20000 };
  uint32_t distinct;
  RowSearch w = {.e = e, .g = e->g, };
  if (!e->mass_known || e->n + e->constraints.n > ROWS_MOST || expr_tree_size(e->g, x, &distinct) > LONGEST) return 0;
  add_motion_rows(&w);
  add_constraint_rows(&w);
  x = simplify(e->g, expr_expand_defs(e->g, x));
  RowBlock motion = {w.row.at, w.unknown.at, w.square, w.square};
  RowBlock rates = {w.row.at + w.square, w.unknown.at + w.square, w.row.n - w.square, w.unknown.n - w.square};
  Expr left = without_rows(&w, &motion, x);
  if (left != x) left = simplify(e->g, left);
  left = without_rows(&w, &rates, left);
  return left != x && prove_zero(e->g, left, NULL) == PROVED_ZERO;
}

Verdict prove_by_motion(const Eqns *e, Expr lhs, Expr rhs) {
  Expr difference = expr_sub(e->g, lhs, rhs);
  Expr closed = states_substitute(e, with_definitions(e, difference));
  Verdict v = prove_by_solving(e, closed);
  int open = v == NOT_DECIDED || (v == PROVED_NONZERO && e->constraints.n); /* it may be 0 on the constraints */
  return open && prove_by_rows(e, closed) ? PROVED_ZERO : v;
}

/* --- by value --- */

/* 1: x is rounding at a state that obeys the constraints; 0: it is more; -1: it has no value there. */
static int is_small(const Eqns *e, Expr x, const long double *symbols, long double tiny) {
  BoundTape *tape = bound_tape(e->g, &x, 1);
  bound_run(tape, symbols, NULL);
  long double bound, value = bound_value(tape, x, &bound), size = 0;
  if (!isfinite(value)) return -1;
  for (ExprPair term = {0}; expr_next_pair(e->g, x, EX_SUM, &term);)
    size += fabsl((long double)num_value(term.num) * bound_value(tape, term.of, &bound));
  return fabsl(value) <= tiny * fmaxl(size, 1);
}

/* Scales coordinates by powers of two and flips unknown signs by the bits of the seed: where constraints have
 * several branches, the nearest states then lie on several of them. */
static void spread(const Eqns *e, uint32_t seed, long double *symbols) {
  static const int powers[] = {0, 2, -3, 4, 1, 7, -6, 3};
  for (uint32_t i = 0; i < eqns_coordinates(e); i++) {
    const Symbol *q = expr_symbol(e->g, eqns_coordinate(e, i));
    symbols[eqns_coordinate(e, i)] = ldexpl(symbols[eqns_coordinate(e, i)], powers[seed % 8]);
    if (q->sign == SIGN_UNKNOWN && (seed / 8 * 5 + seed) >> (i + seed) % 8 & 1) symbols[eqns_coordinate(e, i)] *= -1;
  }
}

/* 1: |x| is below `tiny` at random states that obey the constraints, near ones first, then from starts that are far
 * apart; 0: it is not at one of them; -1: too few were found. A large x at a far state is judged by the size of its
 * terms. */
static int vanishes_by_value(const Eqns *e, Expr x, long double tiny) {
  enum { STATES = 12, NEAR = 4 * STATES, ALL = NEAR + 64 };
  long double *symbols = ARENA_ARRAY(e->m->arena, long double, expr_symbol_count(e->g) + 1);
  StateSolver *solver = states_new(e);
  uint32_t seen = 0;
  for (uint32_t seed = 1; seed <= ALL; seed++) {
    if (seed <= NEAR && seen == STATES) continue;
    sample_state(e->g, seed, symbols);
    if (seed > NEAR) spread(e, seed - NEAR - 1, symbols);
    if (!states_complete(solver, symbols)) continue;
    int small = is_small(e, x, symbols, tiny);
    if (!small) return 0;
    seen += small > 0;
  }
  return seen >= STATES ? 1 : -1;
}

int motion_vanishes(const Eqns *e, Expr x) {
  const long double tiny = LONG_TOLERANCE(1e-14L); /* states obey to 1e-16; terms of x have size 1 */
  return vanishes_by_value(e, x, tiny) == 1;
}

Verdict motion_verdict(const Eqns *e, Expr x) {
  enum { LARGEST = 64 };
  const long double seen = 1e-8L; /* multipliers of a badly conditioned state have half of 19 digits */
  if (expr_is_zero(e->g, x)) return PROVED_ZERO;
  if (e->constraints.n == e->m->contacts.n) return prove_nonzero(e->g, x) ? PROVED_NONZERO : prove_zero(e->g, x, NULL);
  if (e->n + e->constraints.n > LARGEST) return prove_zero(e->g, x, NULL) == PROVED_ZERO ? PROVED_ZERO : NOT_DECIDED;
  if (vanishes_by_value(e, x, seen) == 0) return PROVED_NONZERO;
  return prove_by_motion(e, x, expr_int(e->g, 0)) == PROVED_ZERO ? PROVED_ZERO : NOT_DECIDED;
}
