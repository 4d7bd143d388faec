/* M q'' = f as a program.
 *
 * A mass matrix that is proved positive definite is eliminated by eliminate.c, in straight-line code.
 * Otherwise blocks of coupled coordinates: pairs by Cramer's rule, other blocks, and large dense
 * ones, by a loop with partial pivoting. */
#include "ir/lower_impl.h"

/* Straight-line elimination of a dense matrix takes n^3/3 lines. Measured: it is faster than a loop
 * by a third at n = 10; past n = 12 the code is too long for what it gains. */
enum { STRAIGHT_OPS_A_VARIABLE = 100 };

typedef struct {
  uint32_t n;
  uint32_t *at; /* the coordinates of the block */
  Slot *M;      /* [n*n], lower triangle filled */
  Slot *f;
  Slot divisor; /* of two: the determinant */
} Block;

/* --- blocks --- */

static uint32_t find_root(uint32_t *parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/* label[i]: the first coordinate of the block that i belongs to. */
static uint32_t *label_blocks(const Eqns *e) {
  uint32_t *parent = ARENA_ARRAY(e->m->arena, uint32_t, e->n + 1);
  for (uint32_t i = 0; i < e->n; i++) parent[i] = i;
  for (uint32_t k = 0; k < e->system.H.n; k++) {
    uint32_t a = find_root(parent, e->system.H.at[k].row), b = find_root(parent, e->system.H.at[k].col);
    if (a < b) parent[b] = a;
    else parent[a] = b;
  }
  for (uint32_t i = 0; i < e->n; i++) parent[i] = find_root(parent, i);
  return parent;
}

Name lower_numbered(Lower *l, const char *stem, uint32_t i, uint32_t j) {
  Arena *a = l->p->arena;
  if (l->e->n == 1) return arena_strdup(a, stem);
  if (j == UINT32_MAX) return arena_printf(a, "%s%u", stem, i + 1);
  return arena_printf(a, l->e->n > 9 ? "%s%u_%u" : "%s%u%u", stem, j + 1, i + 1);
}

/* The blocks in the order of their first coordinates, filled in one pass over coordinates and entries. */
static uint32_t make_blocks(Lower *l, Block *blocks) {
  const Eqns *e = l->e;
  Arena *a = l->p->arena;
  const uint32_t *label = label_blocks(e);
  uint32_t n = 0, *block = ARENA_ARRAY(a, uint32_t, e->n), *place = ARENA_ARRAY(a, uint32_t, e->n);
  for (uint32_t i = 0; i < e->n; i++) {
    block[i] = label[i] == i ? n++ : block[label[i]];
    place[i] = blocks[block[i]].n++;
  }
  for (uint32_t k = 0; k < n; k++) {
    Block *b = &blocks[k];
    b->at = ARENA_ARRAY(a, uint32_t, b->n);
    b->f = ARENA_ARRAY(a, Slot, b->n);
    b->M = ARENA_ARRAY(a, Slot, (size_t)b->n * b->n);
  }
  for (uint32_t k = 0; k < e->system.H.n; k++) {
    const MassEntry *x = &e->system.H.at[k];
    Block *b = &blocks[block[x->row]];
    Slot s = lower_slot(l, x->e);
    prog_name(l->p, s, lower_numbered(l, "M", x->row, x->col));
    b->M[place[x->row] * b->n + place[x->col]] = s;
  }
  for (uint32_t i = 0; i < e->n; i++) {
    Block *b = &blocks[block[i]];
    b->at[place[i]] = i;
    b->f[place[i]] = lower_slot(l, e->system.f[i]);
    prog_name(l->p, b->f[place[i]], lower_numbered(l, "f", i, UINT32_MAX));
  }
  return n;
}

/* --- one coordinate, two, and loops --- */

static Slot op(Lower *l, IrOp o, Slot a, Slot b) { return prog_op(l->p, o, a, b); }

static void solve_one(Lower *l, const Block *b, Slot *x) {
  Expr M = eqns_mass(l->e, b->at[0], b->at[0]);
  if (expr_sign(l->g, M) != SIGN_POSITIVE) lower_pivot(l, b->M[0], 0);
  x[0] = op(l, IR_DIV, b->f[0], b->M[0]);
}

/* Two coordinates whose mass matrix may be indefinite (L = x'*y'): Cramer's rule. It needs no pivoting,
 * and for 2 x 2 its error is that of the matrix's condition (Higham, Accuracy and Stability of Numerical
 * Algorithms, 2nd ed., section 1.10.1). */
static void solve_two(Lower *l, Block *b, Slot *x) {
  Slot m11 = b->M[0], m12 = b->M[2], m22 = b->M[3];
  Slot square = op(l, IR_MUL, m11, m22);
  Slot det = lower_minus_product(l, square, m12, m12);
  prog_name(l->p, det, "det_M");
  b->divisor = det;
  lower_pivot(l, det, 0);
  Slot top1 = op(l, IR_MUL, b->f[0], m22), top2 = op(l, IR_MUL, m11, b->f[1]);
  Slot n1 = lower_minus_product(l, top1, m12, b->f[1]), n2 = lower_minus_product(l, top2, m12, b->f[0]);
  x[0] = op(l, IR_DIV, n1, det);
  x[1] = op(l, IR_DIV, n2, det);
}

static void solve_loop(Lower *l, const Block *b, Slot *x) {
  Arena *a = l->p->arena;
  Slot *full = ARENA_ARRAY(a, Slot, b->n * b->n);
  for (uint32_t i = 0; i < b->n; i++)
    for (uint32_t j = 0; j < b->n; j++) full[i * b->n + j] = i >= j ? b->M[i * b->n + j] : b->M[j * b->n + i];
  vec_push(a, &l->p->solves, ((Solve){b->n, 0, full, b->f}));
  Slot s = prog_ins(l->p, (Ins){.op = IR_SOLVE, .index = l->p->solves.n - 1});
  for (uint32_t i = 0; i < b->n; i++) x[i] = prog_ins(l->p, (Ins){.op = IR_SOLVED, .a = s, .index = i});
}

static int goes_straight(const Eqns *e) {
  const LinearSystem *s = &e->system;
  return e->definite_mass && (s->ndefs || s->ops <= STRAIGHT_OPS_A_VARIABLE * (uint64_t)e->n);
}

/* Each block that is factored by a loop gets a place of its own. */
static void keep_factors(Lower *l, const Block *blocks, uint32_t n, Slot *x) {
  Factored *f = l->factored;
  uint32_t place = 0, loop = 0;
  *f = (Factored){.n = l->e->n};
  for (uint32_t k = 0; k < n; k++) {
    const Block *b = &blocks[k];
    FactoredBlock kept = {.n = b->n, .at = b->at, .M = b->M, .divisor = b->n == 2 ? b->divisor : b->M[0], .place = place};
    vec_push(l->p->arena, &f->blocks, kept);
    if (b->n < 3) continue;
    l->p->solves.at[loop++].place = place;
    place += factored_room(b->n);
  }
  l->x = x;
}

static void solve_blocks(Lower *l, Slot *acc) {
  const Eqns *e = l->e;
  Arena *a = l->p->arena;
  Block *blocks = ARENA_ARRAY(a, Block, e->n);
  uint32_t n = make_blocks(l, blocks);
  prog_title(l->p, "M q'' = f");
  Slot *x = ARENA_ARRAY(a, Slot, e->n);
  for (uint32_t k = 0; k < n; k++) {
    Block *b = &blocks[k];
    if (b->n == 1) solve_one(l, b, x);
    else if (b->n == 2) solve_two(l, b, x);
    else solve_loop(l, b, x);
    for (uint32_t i = 0; i < b->n; i++) acc[b->at[i]] = x[i];
  }
  if (l->factored) keep_factors(l, blocks, n, acc);
}

void lower_solution(Lower *l, Slot *acc) {
  const Eqns *e = l->e;
  const LinearSystem *s = &e->system;
  if (!e->n) return;
  VEC(Expr) roots = {0};
  for (uint32_t k = 0; k < s->H.n; k++) vec_push(l->p->arena, &roots, s->H.at[k].e);
  for (uint32_t k = 0; k < s->C.n; k++) vec_push(l->p->arena, &roots, s->C.at[k].e);
  for (uint32_t i = 0; i < e->n; i++) vec_push(l->p->arena, &roots, s->f[i]);
  prog_title(l->p, "mass matrix M and forces f");
  lower_roots(l, roots.at, roots.n);
  if (goes_straight(e)) lower_elimination(l, acc);
  else solve_blocks(l, acc);
  for (uint32_t i = 0; i < e->n; i++) prog_name(l->p, acc[i], expr_symbol(e->g, e->m->coords.at[i].a)->name);
}
