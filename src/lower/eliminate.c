/* M q'' = f by elimination without pivoting in straight-line code, in the order of mech/elimination_order.h.
 *
 * A coordinate's step is that of L D L^T without pivoting (Golub & Van Loan, Matrix Computations, 4th ed., algorithm
 * 4.1.2); its pivot is checked. A definition's step puts w' = C u' into the quadratic form u'^T H u'/2 - b^T u'
 * (mech/augmented_system.h). */
#include "base/sparse_pattern.h"
#include "lower/lower_impl.h"

typedef struct {
  Lower *l;
  const LinearSystem *s;
  Sparse H;          /* slots; the row of an eliminated variable stays as it was at its step */
  SparseRow *C;      /* [n + ndefs] slots */
  Slot *b, *x;       /* [n + ndefs] */
  SparseRow *factor; /* [n] the column of L below a coordinate's pivot */
  Slot *positive;    /* [n] diagonal entry before elimination, if proved positive by the declared signs; else 0 */
} Elimination;

void lower_pivot(Lower *l, Slot d, int positive) {
  const Ins *i = &l->p->ins.at[d];
  if (d && i->op == IR_CONST && (num_sign(i->number) > 0 || !positive)) return;
  prog_ins(l->p, (Ins){.op = IR_PIVOT, .a = d, .index = (uint32_t)positive});
}

static Elimination system_new(Lower *l) {
  const LinearSystem *s = &l->e->system;
  Arena *a = l->p->arena;
  uint32_t total = s->n + s->ndefs;
  Elimination y = {.l = l, .s = s, .H = sparse_new(a, total)};
  y.C = ARENA_ARRAY(a, SparseRow, total + 1);
  y.b = ARENA_ARRAY(a, Slot, total + 1);
  y.x = ARENA_ARRAY(a, Slot, total + 1);
  y.factor = ARENA_ARRAY(a, SparseRow, s->n + 1);
  y.positive = ARENA_ARRAY(a, Slot, s->n + 1);
  for (uint32_t k = 0; k < s->H.n; k++) {
    const MassEntry *m = &s->H.at[k];
    Slot slot = lower_slot(l, m->e);
    if (m->row < s->n) prog_name(l->p, slot, lower_numbered(l, "M", m->row, m->col));
    if (m->row < s->n && m->row == m->col && expr_sign(l->g, m->e) == SIGN_POSITIVE) y.positive[m->row] = slot;
    sparse_set(&y.H, m->row, m->col, slot);
  }
  for (uint32_t k = 0; k < s->C.n; k++) {
    const MassEntry *m = &s->C.at[k];
    vec_push(a, &y.C[m->row], ((SparseEntry){m->col, lower_slot(l, m->e)}));
  }
  for (uint32_t i = 0; i < s->n; i++) {
    y.b[i] = lower_slot(l, s->f[i]);
    prog_name(l->p, y.b[i], lower_numbered(l, "f", i, UINT32_MAX));
  }
  return y;
}

/* --- elimination --- */

/* Eliminates coordinate v from H and b: H -= h h^T/d, b -= h b_v/d, with h its column. */
static void eliminate_coordinate(Elimination *y, uint32_t v) {
  const SparseRow *row = &y->H.rows[v];
  Slot d = sparse_get(&y->H, v, v);
  prog_name(y->l->p, d, lower_numbered(y->l, "D", v, UINT32_MAX));
  if (!d || d != y->positive[v]) lower_pivot(y->l, d, 1);
  SparseRow *below = &y->factor[v];
  for (uint32_t k = 0; k < row->n; k++) {
    SparseEntry h = row->at[k];
    if (h.col == v) continue;
    Slot f = op(y->l, IR_DIV, h.value, d);
    if (h.col < y->s->n) prog_name(y->l->p, f, lower_numbered(y->l, "L", v, h.col));
    for (uint32_t j = 0; j < below->n; j++) { /* earlier entries of the column */
      SparseEntry g = below->at[j];
      sparse_set(&y->H, h.col, g.col, prog_sub_product(y->l->p, sparse_get(&y->H, h.col, g.col), h.value, g.value));
    }
    sparse_set(&y->H, h.col, h.col, prog_sub_product(y->l->p, sparse_get(&y->H, h.col, h.col), h.value, f));
    y->b[h.col] = prog_sub_product(y->l->p, y->b[h.col], f, y->b[v]);
    vec_push(y->l->p->arena, below, ((SparseEntry){h.col, f}));
  }
}

/* A variable in the step of definition v: c its coefficient in C_v, r its entry in row v of H, y = r + h*c. */
typedef struct {
  uint32_t col;
  Slot c, r, y;
} StepEntry;

static void step_entries(Elimination *y, const SparseRow *row, const SparseRow *c, Slot h, uint32_t v, uint32_t *n,
                         StepEntry *at) {
  *n = 0;
  for (uint32_t i = 0; i < c->n; i++) {
    Slot hc = op(y->l, IR_MUL, h, c->at[i].value), r = sparse_get(&y->H, v, c->at[i].col);
    at[(*n)++] = (StepEntry){c->at[i].col, c->at[i].value, r, op(y->l, IR_ADD, r, hc)};
  }
  for (uint32_t k = 0; k < row->n; k++) {
    uint32_t col = row->at[k].col, inside = 0;
    for (uint32_t i = 0; i < c->n; i++) inside |= c->at[i].col == col;
    if (col != v && !inside) at[(*n)++] = (StepEntry){col, 0, row->at[k].value, row->at[k].value};
  }
}

static void add_product(Elimination *y, const StepEntry *s, const StepEntry *t, Slot a, Slot b) {
  sparse_set(&y->H, s->col, t->col, prog_add_product(y->l->p, sparse_get(&y->H, s->col, t->col), a, b));
}

/* Substitutes w_v' = C_v u' into the quadratic form: H += c r^T + r c^T + h c c^T = c y^T + r c^T with
 * y = r + h c, computed once per variable; b += c b_v. */
static void eliminate_definition(Elimination *y, uint32_t v) {
  const SparseRow *row = &y->H.rows[v], *c = &y->C[v];
  uint32_t n;
  StepEntry *at = ARENA_ARRAY(y->l->p->arena, StepEntry, row->n + c->n + 1);
  step_entries(y, row, c, sparse_get(&y->H, v, v), v, &n, at);
  for (uint32_t i = 0; i < c->n; i++) { /* at[c->n] and later have c = 0 */
    const StepEntry *s = &at[i];
    Slot twice = op(y->l, IR_ADD, s->y, s->r);
    add_product(y, s, s, s->c, twice);
    for (uint32_t k = 0; k < n; k++) {
      const StepEntry *t = &at[k];
      if (k <= i && k < c->n) continue; /* each pair of variables once */
      int turned = s->r == 0; /* then the entry is c_s y_t alone */
      add_product(y, s, t, turned ? s->c : t->c, turned ? t->y : s->y);
      if (!turned) add_product(y, s, t, s->c, t->r);
    }
    y->b[s->col] = prog_add_product(y->l->p, y->b[s->col], s->c, y->b[v]);
  }
}

static FactorRecord record(const Elimination *y) {
  Slot *pivot = ARENA_ARRAY(y->l->p->arena, Slot, y->s->n + 1);
  for (uint32_t v = 0; v < y->s->n; v++) pivot[v] = sparse_get(&y->H, v, v);
  return (FactorRecord){.n = y->s->n,
                        .ndefs = y->s->ndefs, .straight = 1, .order = y->s->order, .pivot = pivot, .below = y->factor,
                        .C = y->C,
                        .row = y->H.rows};
}

void lower_elimination(Lower *l, Slot *acc) {
  Elimination y = system_new(l);
  uint32_t total = y.s->n + y.s->ndefs;
  prog_title(l->p, "M q'' = f");
  for (uint32_t k = 0; k < total; k++) {
    uint32_t v = y.s->order[k];
    if (v < y.s->n) eliminate_coordinate(&y, v);
    else eliminate_definition(&y, v);
    sparse_eliminate(&y.H, v);
  }
  FactorRecord factors = record(&y);
  for (uint32_t k = total; k-- > 0;) factor_record_backward(l->p, &factors, y.s->order[k], y.b, NULL, y.x);
  for (uint32_t i = 0; i < y.s->n; i++) acc[i] = y.x[i];
  if (l->factored) *l->factored = factors;
  l->x = y.x;
}
