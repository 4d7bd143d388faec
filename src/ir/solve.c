#include "ir/solve.h"

enum { STRAIGHT_LINE_MAX = 12 };

static Slot op(Prog *p, IrOp o, Slot a, Slot b) { return prog_op(p, o, a, b); }

/* x - a*b, with structural zeros skipped. */
static Slot minus_product(Prog *p, Slot x, Slot a, Slot b) {
  Slot ab = op(p, IR_MUL, a, b);
  return op(p, IR_SUB, x, ab);
}

/* x / divisor i. */
static Slot divided(Prog *p, const Factored *f, Slot x, uint32_t i) {
  return f->inverse ? op(p, IR_MUL, x, f->inverse[i]) : op(p, IR_DIV, x, f->divisor[i]);
}

Name block_name(const Block *b, Arena *a, const char *stem, uint32_t i, uint32_t j) {
  if (b->of == 1) return arena_strdup(a, stem);
  if (j == UINT32_MAX) return arena_printf(a, "%s%u", stem, i + 1);
  return arena_printf(a, b->of > 9 ? "%s%u_%u" : "%s%u%u", stem, j + 1, i + 1);
}

static void check_pivot(Prog *p, Slot d, int positive) {
  const Ins *i = &p->ins.at[d];
  if (d && i->op == IR_CONST && (num_sign(i->number) > 0 || !positive)) return; /* known now */
  prog_ins(p, (Ins){.op = IR_PIVOT, .a = d, .index = (uint32_t)positive});
}

/* --- factoring --- */

/* M = L D L^T: W holds L D below the diagonal and D on it, L the unit factor. */
static void factor_straight(Prog *p, const Block *b, Factored *fac) {
  uint32_t n = b->n;
  Slot *W = ARENA_ARRAY(p->arena, Slot, n * n), *L = ARENA_ARRAY(p->arena, Slot, n * n), *D = ARENA_ARRAY(p->arena, Slot, n);
  for (uint32_t j = 0; j < n; j++) {
    Slot d = b->M[j * n + j];
    for (uint32_t k = 0; k < j; k++) d = minus_product(p, d, W[j * n + k], L[j * n + k]);
    D[j] = d;
    prog_name(p, d, block_name(b, p->arena, "D", b->at[j], UINT32_MAX));
    check_pivot(p, d, 1);
    for (uint32_t i = j + 1; i < n; i++) {
      Slot w = b->M[i * n + j];
      for (uint32_t k = 0; k < j; k++) w = minus_product(p, w, W[i * n + k], L[j * n + k]);
      W[i * n + j] = w;
      L[i * n + j] = op(p, IR_DIV, w, d);
      prog_name(p, L[i * n + j], block_name(b, p->arena, "L", b->at[j], b->at[i]));
    }
  }
  fac->L = L;
  fac->divisor = D;
}

/* Two coordinates whose mass matrix may be indefinite (L = x'*y'): Cramer's rule. It needs no pivoting,
 * and for 2 x 2 its error is that of the matrix's condition (Higham, Accuracy and Stability of Numerical
 * Algorithms, 2nd ed., section 1.10.1). */
static void factor_pair(Prog *p, const Block *b, Factored *fac) {
  Slot *m = ARENA_ARRAY(p->arena, Slot, 3), *det = ARENA_ARRAY(p->arena, Slot, 1);
  m[0] = b->M[0], m[1] = b->M[2], m[2] = b->M[3];
  Slot square = op(p, IR_MUL, m[0], m[2]);
  det[0] = minus_product(p, square, m[1], m[1]);
  prog_name(p, det[0], "det_M");
  check_pivot(p, det[0], 0);
  fac->L = m;
  fac->divisor = det;
}

static void factor_loop(Prog *p, const Block *b, Factored *fac) {
  uint32_t n = b->n;
  Slot *full = ARENA_ARRAY(p->arena, Slot, n * n);
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t j = 0; j < n; j++) full[i * n + j] = i >= j ? b->M[i * n + j] : b->M[j * n + i];
  fac->L = full;
}

uint32_t factored_room(uint32_t n) { return n * n + 2 * n; }

Factored block_factor(Prog *p, const Block *b, uint32_t *room) {
  Factored fac = {.n = b->n};
  if (b->n == 1) {
    fac.kind = FACTOR_ONE;
    fac.divisor = b->M;
    if (!b->definite) check_pivot(p, b->M[0], 0);
  } else if (b->definite && b->n <= STRAIGHT_LINE_MAX) {
    fac.kind = FACTOR_STRAIGHT;
    factor_straight(p, b, &fac);
  } else if (b->n == 2) {
    fac.kind = FACTOR_PAIR;
    factor_pair(p, b, &fac);
  } else {
    fac.kind = FACTOR_LOOP;
    fac.place = room ? *room : 0;
    if (room) *room += factored_room(b->n);
    factor_loop(p, b, &fac);
  }
  return fac;
}

uint32_t factor_divisors(const Factored *f) {
  switch (f->kind) {
    case FACTOR_ONE: case FACTOR_PAIR: return 1;
    case FACTOR_STRAIGHT: return f->n;
    case FACTOR_LOOP: case FACTOR_INVERSE: break;
  }
  return 0;
}

/* --- solving --- */

static void solve_straight(Prog *p, const Factored *fac, const Slot *f, Slot *x) {
  uint32_t n = fac->n;
  const Slot *L = fac->L;
  for (uint32_t i = 0; i < n; i++) {
    x[i] = f[i];
    for (uint32_t k = 0; k < i; k++) x[i] = minus_product(p, x[i], L[i * n + k], x[k]);
  }
  for (uint32_t i = 0; i < n; i++) x[i] = divided(p, fac, x[i], i);
  for (uint32_t i = n; i-- > 0;)
    for (uint32_t k = i + 1; k < n; k++) x[i] = minus_product(p, x[i], L[k * n + i], x[k]);
}

static void solve_pair(Prog *p, const Factored *fac, const Slot *f, Slot *x) {
  const Slot m11 = fac->L[0], m12 = fac->L[1], m22 = fac->L[2];
  Slot top1 = op(p, IR_MUL, f[0], m22), top2 = op(p, IR_MUL, m11, f[1]);
  Slot n1 = minus_product(p, top1, m12, f[1]), n2 = minus_product(p, top2, m12, f[0]);
  x[0] = divided(p, fac, n1, 0);
  x[1] = divided(p, fac, n2, 0);
}

static void solve_loop(Prog *p, const Factored *fac, const Slot *f, Slot *x) {
  Slot *rhs = ARENA_ARRAY(p->arena, Slot, fac->n);
  for (uint32_t i = 0; i < fac->n; i++) rhs[i] = f[i];
  vec_push(p->arena, &p->solves, ((Solve){fac->n, fac->place, fac->L, rhs}));
  Slot s = prog_ins(p, (Ins){.op = IR_SOLVE, .index = p->solves.n - 1});
  for (uint32_t i = 0; i < fac->n; i++) x[i] = prog_ins(p, (Ins){.op = IR_SOLVED, .a = s, .index = i});
}

static void solve_inverse(Prog *p, const Factored *fac, const Slot *f, Slot *x) {
  for (uint32_t i = 0; i < fac->n; i++) {
    x[i] = 0;
    for (uint32_t j = 0; j < fac->n; j++) {
      Slot product = op(p, IR_MUL, fac->L[i * fac->n + j], f[j]);
      x[i] = op(p, IR_ADD, x[i], product);
    }
  }
}

void factor_solve(Prog *p, const Factored *fac, const Slot *f, Slot *x) {
  switch (fac->kind) {
    case FACTOR_ONE: x[0] = divided(p, fac, f[0], 0); return;
    case FACTOR_STRAIGHT: solve_straight(p, fac, f, x); return;
    case FACTOR_PAIR: solve_pair(p, fac, f, x); return;
    case FACTOR_LOOP: solve_loop(p, fac, f, x); return;
    case FACTOR_INVERSE: solve_inverse(p, fac, f, x); return;
  }
}
