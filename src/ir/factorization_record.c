/* Forward and backward substitution with recorded factors, as instructions. The order of operations is that of
 * eliminate.c and linear_solve.c. */
#include "ir/factorization_record.h"

static Slot op(Prog *p, IrOp o, Slot a, Slot b) { return prog_op(p, o, a, b); }

static Slot divided(Prog *p, const FactorRecord *f, uint32_t i, Slot x, Slot divisor) {
  return f->inverse ? op(p, IR_MUL, x, f->inverse[i]) : op(p, IR_DIV, x, divisor);
}

/* --- straight-line --- */

/* Eliminates variable v from b. A definition: with w' = C u' + s in u'^T H u'/2 - b^T u', b += C (b_v - h s) - r s. */
static void forward(Prog *p, const FactorRecord *f, uint32_t v, Slot *b, const Slot *s) {
  if (v < f->n) {
    for (uint32_t k = 0; k < f->below[v].n; k++) {
      SparseEntry l = f->below[v].at[k];
      b[l.col] = prog_sub_product(p, b[l.col], l.value, b[v]);
    }
    return;
  }
  Slot moved = s ? s[v] : 0, own = b[v];
  for (uint32_t k = 0; k < f->row[v].n; k++)
    if (f->row[v].at[k].col == v) own = prog_sub_product(p, own, f->row[v].at[k].value, moved);
  for (uint32_t k = 0; k < f->C[v].n; k++)
    b[f->C[v].at[k].col] = prog_add_product(p, b[f->C[v].at[k].col], f->C[v].at[k].value, own);
  for (uint32_t k = 0; k < f->row[v].n; k++) {
    SparseEntry r = f->row[v].at[k];
    if (r.col != v) b[r.col] = prog_sub_product(p, b[r.col], r.value, moved);
  }
}

void factor_record_backward(Prog *p, const FactorRecord *f, uint32_t v, const Slot *b, const Slot *s, Slot *x) {
  if (v < f->n) {
    x[v] = divided(p, f, v, b[v], f->pivot[v]);
    for (uint32_t k = 0; k < f->below[v].n; k++)
      x[v] = prog_sub_product(p, x[v], f->below[v].at[k].value, x[f->below[v].at[k].col]);
    return;
  }
  x[v] = s ? s[v] : 0;
  for (uint32_t k = 0; k < f->C[v].n; k++) x[v] = prog_add_product(p, x[v], f->C[v].at[k].value, x[f->C[v].at[k].col]);
}

/* --- blocks --- */

static void solve_pair(Prog *p, const FactorRecord *f, uint32_t k, const Slot *b, Slot *x) {
  const FactorBlock *m = &f->blocks.at[k];
  const uint32_t i = m->at[0], j = m->at[1];
  const Slot m11 = solve_element(&m->M, 0), m12 = solve_element(&m->M, 2), m22 = solve_element(&m->M, 3);
  Slot top1 = op(p, IR_MUL, b[i], m22), top2 = op(p, IR_MUL, m11, b[j]);
  Slot n1 = prog_sub_product(p, top1, m12, b[j]), n2 = prog_sub_product(p, top2, m12, b[i]);
  x[i] = divided(p, f, k, n1, m->divisor);
  x[j] = divided(p, f, k, n2, m->divisor);
}

static void solve_loop(Prog *p, const FactorBlock *m, const Slot *b, Slot *x) {
  uint32_t n = m->n;
  Slot *rhs = ARENA_ARRAY(p->arena, Slot, n), *y = ARENA_ARRAY(p->arena, Slot, n);
  for (uint32_t i = 0; i < n; i++) rhs[i] = b[m->at[i]];
  prog_solve(p, (Solve){.n = n, .rhs = rhs, .list = m->M}, y);
  for (uint32_t i = 0; i < n; i++) x[m->at[i]] = y[i];
}

void factor_record_solve(Prog *p, const FactorRecord *f, Slot *b, const Slot *s, Slot *x) {
  uint32_t total = f->n + f->ndefs;
  for (uint32_t k = 0; f->straight && k < total; k++) forward(p, f, f->order[k], b, s);
  for (uint32_t k = total; f->straight && k-- > 0;) factor_record_backward(p, f, f->order[k], b, s, x);
  for (uint32_t k = 0; k < f->blocks.n; k++) {
    const FactorBlock *m = &f->blocks.at[k];
    if (m->n == 1) x[m->at[0]] = divided(p, f, k, b[m->at[0]], m->divisor);
    else if (m->n == 2) solve_pair(p, f, k, b, x);
    else solve_loop(p, m, b, x);
  }
}
