/* M q'' = f, and its solution, as instructions.
 *
 * A positive definite mass matrix is eliminated in straight-line code (eliminate.c, gram_schmidt.c) unless that
 * would be long. Otherwise M falls into blocks of coupled coordinates: one by division, two by Cramer's rule, more
 * by a loop with partial pivoting. Coordinates that a constraint couples are one block, solved with their
 * multipliers. */
#include "base/union_find.h"
#include "lower/lower_impl.h"

/* Straight-line elimination of a dense matrix takes n^3/3 lines. Measured: it is faster than a loop
 * by a third at n = 10; past n = 12 the code is too long for what it gains. */
enum { STRAIGHT_OPS_A_VARIABLE = 100 };

typedef struct {
  uint32_t n;
  uint32_t *at; /* [n] its coordinates */
  SolveElements list; /* M's lower triangle, and the rows of A behind M */
  Slot *f;
  Slot divisor; /* n == 2: the determinant */
  uint32_t m;   /* constraints on these coordinates, */
  uint32_t *rows; /* [m] their numbers */
  Slot *g;      /* [m] */
} Block;

/* Right-hand sides: f[n] (0: zero), and g[nrows] of the first nrows constraints. factor[nrows]: of rows of A, 0: 1;
 * or NULL: all are 1. */
typedef struct {
  const Slot *f, *g, *factor;
  uint32_t nrows;
  int coarse; /* as in Solve */
} RightHandSides;

typedef VEC(Expr) ExprVec;

/* --- blocks --- */

/* label[i]: the first coordinate of the block of coordinate i. */
static uint32_t *label_blocks(const Eqns *e, uint32_t nrows) {
  uint32_t *parent = union_find_new(e->m->arena, e->n);
  const Entries *H = &e->system.H, *A = &e->constraints.A;
  for (uint32_t k = 0; k < H->n; k++) union_find_join(parent, H->at[k].row, H->at[k].col);
  for (uint32_t k = 1; k < A->n && A->at[k].row < nrows; k++)
    if (A->at[k].row == A->at[k - 1].row) union_find_join(parent, A->at[k].col, A->at[k - 1].col);
  for (uint32_t i = 0; i < e->n; i++) parent[i] = union_find_root(parent, i);
  return parent;
}

void lower_name(Lower *l, Slot s, const char *stem, uint32_t i, uint32_t j) {
  Arena *a = l->p->arena;
  if (!prog_takes_name(l->p, s)) return;
  prog_name(l->p, s, l->e->n == 1      ? stem
                     : j == UINT32_MAX ? arena_printf(a, "%s%u", stem, i + 1)
                                       : arena_printf(a, l->e->n > 9 ? "%s%u_%u" : "%s%u%u", stem, j + 1, i + 1));
}

/* Coordinate i is number place[i] of blocks[block[i]]; constraint k number row_place[k] of blocks[row_block[k]]. */
typedef struct {
  Block *blocks;
  uint32_t n, *block, *place, *row_block, *row_place;
} BlockLayout;

static void place_rows(Lower *l, const RightHandSides *s, BlockLayout *y) {
  const Eqns *e = l->e;
  const Entries *A = &e->constraints.A;
  Arena *a = l->p->arena;
  y->row_block = ARENA_ARRAY(a, uint32_t, s->nrows + 1);
  y->row_place = ARENA_ARRAY(a, uint32_t, s->nrows + 1);
  for (uint32_t k = 0; k < A->n && A->at[k].row < s->nrows; k++) {
    uint32_t row = A->at[k].row;
    if (k && A->at[k - 1].row == row) continue;
    y->row_block[row] = y->block[A->at[k].col];
    y->row_place[row] = y->blocks[y->row_block[row]].m++;
  }
}

/* Empty blocks in the order of their first coordinates. */
static BlockLayout make_layout(Lower *l, const RightHandSides *s) {
  const Eqns *e = l->e;
  Arena *a = l->p->arena;
  const uint32_t *label = label_blocks(e, s->nrows);
  BlockLayout y = {.blocks = ARENA_ARRAY(a, Block, e->n),
                   .block = ARENA_ARRAY(a, uint32_t, e->n),
                   .place = ARENA_ARRAY(a, uint32_t, e->n)};
  uint32_t *first = ARENA_ARRAY(a, uint32_t, e->n);
  for (uint32_t i = 0; i < e->n; i++) {
    if (label[i] == i) first[y.n] = i;
    y.block[i] = label[i] == i ? y.n++ : y.block[label[i]];
    y.place[i] = y.blocks[y.block[i]].n++;
  }
  if (!s->nrows) lower_band_order(l, first, y.n, y.place);
  place_rows(l, s, &y);
  for (uint32_t k = 0; k < y.n; k++) {
    Block *b = &y.blocks[k];
    b->at = ARENA_ARRAY(a, uint32_t, b->n);
    b->f = ARENA_ARRAY(a, Slot, b->n);
    if (!b->m) continue;
    b->rows = ARENA_ARRAY(a, uint32_t, b->m);
    b->g = ARENA_ARRAY(a, Slot, b->m);
  }
  return y;
}

static void fill_constraints(Lower *l, const RightHandSides *s, const BlockLayout *y) {
  const Entries *A = &l->e->constraints.A;
  for (uint32_t k = 0; k < A->n && A->at[k].row < s->nrows; k++) {
    uint32_t row = A->at[k].row;
    Block *b = &y->blocks[y->row_block[row]];
    Slot entry = lower_slot(l, A->at[k].e), factor = s->factor ? s->factor[row] : 0;
    if (factor) entry = prog_op(l->p, IR_MUL, entry, factor);
    uint32_t at = (b->n + y->row_place[row]) * b->n + y->place[A->at[k].col];
    vec_push(l->p->arena, &b->list, ((SolveElement){at, entry}));
    b->rows[y->row_place[row]] = row;
    b->g[y->row_place[row]] = s->g[row];
  }
}

static uint32_t make_blocks(Lower *l, const RightHandSides *s, Block **blocks) {
  const Eqns *e = l->e;
  BlockLayout y = make_layout(l, s);
  for (uint32_t k = 0; k < e->system.H.n; k++) {
    const MassEntry *x = &e->system.H.at[k];
    Block *b = &y.blocks[y.block[x->row]];
    Slot slot = lower_slot(l, x->e);
    lower_name(l, slot, "M", x->row, x->col);
    uint32_t i = y.place[x->row], j = y.place[x->col];
    vec_push(l->p->arena, &b->list, ((SolveElement){i > j ? i * b->n + j : j * b->n + i, slot}));
  }
  for (uint32_t i = 0; i < e->n; i++) {
    Block *b = &y.blocks[y.block[i]];
    b->at[y.place[i]] = i;
    b->f[y.place[i]] = s->f[i];
    if (s->f[i]) lower_name(l, s->f[i], "f", i, UINT32_MAX);
  }
  fill_constraints(l, s, &y);
  for (uint32_t k = 0; k < y.n; k++) solve_sort(&y.blocks[k].list);
  *blocks = y.blocks;
  return y.n;
}

/* --- one coordinate, two, and loops --- */

static void solve_one(Lower *l, const Block *b, Slot *x) {
  Expr M = eqns_mass(l->e, b->at[0], b->at[0]);
  Slot divisor = solve_element(&b->list, 0);
  if (expr_sign(l->g, M) != SIGN_POSITIVE) lower_pivot(l, divisor, 0);
  x[0] = op(l, IR_DIV, b->f[0], divisor);
}

/* Cramer's rule for two coordinates whose mass matrix may be indefinite (L = x'*y'). It needs no pivoting, and for 2
 * x 2 is forward stable (Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., section 1.10.1). */
static void solve_two(Lower *l, Block *b, Slot *x) {
  const SolveElements *M = &b->list;
  Slot m11 = solve_element(M, 0), m12 = solve_element(M, 2), m22 = solve_element(M, 3);
  Slot square = op(l, IR_MUL, m11, m22);
  Slot det = prog_sub_product(l->p, square, m12, m12);
  prog_name(l->p, det, "det_M");
  b->divisor = det;
  lower_pivot(l, det, 0);
  Slot top1 = op(l, IR_MUL, b->f[0], m22), top2 = op(l, IR_MUL, m11, b->f[1]);
  Slot n1 = prog_sub_product(l->p, top1, m12, b->f[1]), n2 = prog_sub_product(l->p, top2, m12, b->f[0]);
  x[0] = op(l, IR_DIV, n1, det);
  x[1] = op(l, IR_DIV, n2, det);
}

/* Solves the block by a loop of the runtime: x[n], then the m multipliers. */
static void solve_loop(Lower *l, const Block *b, int coarse, Slot *x) {
  Arena *a = l->p->arena;
  size_t n = b->n, m = b->m;
  Slot *rhs = ARENA_ARRAY(a, Slot, n + m);
  for (size_t i = 0; i < n + m; i++) rhs[i] = i < n ? b->f[i] : b->g[i - n];
  Solve k = {.n = b->n, .m = b->m, .coarse = coarse, .rhs = rhs, .list = b->list};
  prog_solve(l->p, k, x);
}

/* Whether M has a block of more than two coordinates. */
static int has_large_block(const Eqns *e) {
  const uint32_t *label = label_blocks(e, 0);
  uint32_t *size = ARENA_ARRAY(e->m->arena, uint32_t, e->n + 1);
  for (uint32_t i = 0; i < e->n; i++)
    if (++size[label[i]] > 2) return 1;
  return 0;
}

/* Whether to eliminate in straight-line code without pivoting. Where M is definite only for the values of
 * parameters, small blocks go by the rules below instead: they cost the same, and work for any M. */
static int is_straight_line(const Eqns *e) {
  const LinearSystem *s = &e->system;
  if (e->squares.n) return 1; /* kinetic_squares needs M definite, by values of parameters at least */
  int definite = e->definite_mass || (e->definite_by_values && (s->ndefs || has_large_block(e)));
  return definite && !e->constraints.n && (s->ndefs || s->ops <= STRAIGHT_OPS_A_VARIABLE * (uint64_t)e->n);
}

/* Whether all forces of the block are structural zeros. */
static int is_empty(const Block *b) {
  for (uint32_t i = 0; i < b->n; i++)
    if (b->f[i]) return 0;
  return 1;
}

/* Records blocks for factor_record_solve. */
static void keep_factors(Lower *l, const Block *blocks, uint32_t n, Slot *x) {
  FactorRecord *f = l->factored;
  *f = (FactorRecord){.n = l->e->n};
  for (uint32_t k = 0; k < n; k++) {
    const Block *b = &blocks[k];
    if (is_empty(b)) continue; /* the solution of an empty block is 0 to all orders */
    Slot divisor = b->n == 2 ? b->divisor : solve_element(&b->list, 0);
    FactorBlock kept = {.n = b->n, .at = b->at, .M = b->list, .divisor = divisor};
    vec_push(l->p->arena, &f->blocks, kept);
  }
  l->x = x;
}

/* Solves all blocks: acc[n], and the multipliers of the first nrows constraints. */
static void solve_blocks(Lower *l, const RightHandSides *s, Slot *acc, Slot *multipliers) {
  Block *blocks;
  uint32_t n = make_blocks(l, s, &blocks), nrows = s->nrows;
  Slot *x = ARENA_ARRAY(l->p->arena, Slot, l->e->n + nrows + 1);
  for (uint32_t k = 0; k < n; k++) {
    Block *b = &blocks[k];
    if (!b->m && is_empty(b)) continue;
    if (b->n > 2 || b->m) solve_loop(l, b, s->coarse, x);
    else if (b->n == 1) solve_one(l, b, x);
    else solve_two(l, b, x);
    for (uint32_t i = 0; i < b->n; i++) acc[b->at[i]] = x[i];
    for (uint32_t i = 0; i < b->m; i++) multipliers[b->rows[i]] = x[b->n + i];
  }
  if (l->factored) keep_factors(l, blocks, n, acc);
}

static void push_entries(Lower *l, ExprVec *roots, const Entries *from) {
  for (uint32_t k = 0; k < from->n; k++) vec_push(l->p->arena, roots, from->at[k].e);
}

static void push_forms(Lower *l, ExprVec *roots) {
  const SquareForms *s = &l->e->squares;
  for (uint32_t k = 0; k < s->n; k++) vec_push(l->p->arena, roots, s->weight[k]);
  for (uint32_t k = 0; k < s->n * l->e->n; k++)
    if (s->W[k]) vec_push(l->p->arena, roots, s->W[k]);
}

static const Slot *slots_of(Lower *l, const Expr *of, uint32_t n) {
  Slot *s = ARENA_ARRAY(l->p->arena, Slot, n + 1);
  for (uint32_t i = 0; i < n; i++) s[i] = lower_slot(l, of[i]);
  return s;
}

void lower_solution(Lower *l, Slot *acc) {
  const Eqns *e = l->e;
  const LinearSystem *s = &e->system;
  const Constraints *k = &e->constraints;
  if (!e->n) return;
  ExprVec roots = {0};
  push_forms(l, &roots);
  if (!e->squares.n || l->factored) push_entries(l, &roots, &s->H); /* series need the entries of M */
  push_entries(l, &roots, &s->C);
  push_entries(l, &roots, &k->A);
  for (uint32_t i = 0; i < e->n; i++) vec_push(l->p->arena, &roots, s->f[i]);
  for (uint32_t i = 0; i < k->n; i++) vec_push(l->p->arena, &roots, k->demand[i]);
  prog_title(l->p, k->n ? "mass matrix M, forces f, constraints A q'' = g" : "mass matrix M and forces f");
  lower_roots(l, roots.at, roots.n);
  l->multipliers = ARENA_ARRAY(l->p->arena, Slot, k->n + 1);
  if (is_straight_line(e)) {
    (e->squares.n ? lower_gram_schmidt : lower_elimination)(l, acc);
  } else {
    RightHandSides sides = {slots_of(l, s->f, e->n), slots_of(l, k->demand, k->n), NULL, k->n, l->coarse};
    prog_title(l->p, k->n ? "M q'' = f + A^T lambda" : "M q'' = f");
    solve_blocks(l, &sides, acc, l->multipliers);
  }
  for (uint32_t i = 0; i < e->n; i++) prog_name(l->p, acc[i], expr_symbol(e->g, e->m->coords.at[i].a)->name);
}

static void lower_matrices_of_solution(Lower *l) {
  ExprVec roots = {0};
  push_entries(l, &roots, &l->e->system.H);
  push_entries(l, &roots, &l->e->constraints.A);
  lower_roots(l, roots.at, roots.n);
}

void lower_held_weights(Lower *l, uint32_t nrows, int coarse, const Slot *x, Slot *w, Slot *multipliers) {
  lower_matrices_of_solution(l);
  RightHandSides sides = {x, ARENA_ARRAY(l->p->arena, Slot, nrows + 1), NULL, nrows, coarse};
  solve_blocks(l, &sides, w, multipliers);
}

void lower_correction(Lower *l, uint32_t nrows, int coarse, const Slot *g, const Slot *factor, Slot *d, Slot *force) {
  const Eqns *e = l->e;
  const Entries *A = &e->constraints.A;
  Arena *a = l->p->arena;
  lower_matrices_of_solution(l);
  Slot *multipliers = l->multipliers = ARENA_ARRAY(a, Slot, nrows + 1);
  RightHandSides sides = {ARENA_ARRAY(a, Slot, e->n + 1), g, factor, nrows, coarse};
  solve_blocks(l, &sides, d, multipliers);
  for (uint32_t i = 0; i < e->n && force; i++) force[i] = 0;
  for (uint32_t k = 0; force && k < A->n && A->at[k].row < nrows; k++) {
    Slot *sum = &force[A->at[k].col];
    *sum = prog_add_product(l->p, *sum, lower_slot(l, A->at[k].e), multipliers[A->at[k].row]);
  }
}
