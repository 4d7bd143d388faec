/* M q'' = f by elimination without pivoting in straight-line code, in the order of mech/elimination_order.h.
 *
 * A coordinate's step is that of L D L^T without pivoting (Golub & Van Loan, Matrix Computations, 4th ed., algorithm
 * 4.1.2); its pivot is checked. A definition's step puts w' = C u' into the quadratic form u'^T H u'/2 - b^T u'
 * (mech/augmented_system.h). */
#include "base/sparse_pattern.h"
#include "lower/lower_impl.h"

/* Quotient of two slots; num == 0: none. */
typedef struct {
  Slot num, den;
} Fraction;

/* Row of definition p, one of the two positions of a point mass, all below it eliminated: H_pp = own + lambda c_mate^2
 * = full and H_p,mate = -lambda c c_mate, where c, c_mate are the coefficients of the rod below. lambda 0: no rod. */
typedef struct {
  uint32_t mate;
  Slot own, full, lambda, c, length2; /* length2 = c^2 + c_mate^2 */
  Fraction ahead;                     /* lambda as a quotient, for every other rod */
} MassForm;

/* Rod: the two definitions p = parent + c v of coordinate v, in the order of elimination. n NO_LINK: v is no rod's. */
typedef struct {
  uint32_t n, def[2], parent[2];
  Slot c[2];
} Link;

/* LINKED: eliminated by link_row. A chain of up to SHORT_CHAIN coordinates has fewer operations without. */
enum { LINKED = 3, NO_LINK, SHORT_CHAIN = 4 };
#define NO_VARIABLE UINT32_MAX

typedef struct {
  Lower *l;
  const LinearSystem *s;
  Sparse H;          /* slots; the row of an eliminated variable stays as it was at its step */
  SparseRow *C;      /* [n + ndefs] slots */
  Slot *b, *x;       /* [n + ndefs] */
  SparseRow *factor; /* [n] the column of L below a coordinate's pivot */
  Slot *positive;    /* [n] diagonal entry before elimination, if proved positive by the declared signs; else 0 */
  MassForm *form;    /* [n + ndefs] of definitions */
  Link *link;        /* [n] */
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
  y.form = ARENA_ARRAY(a, MassForm, total + 1);
  y.link = ARENA_ARRAY(a, Link, s->n + 1);
  for (uint32_t k = 0; k < s->H.n; k++) {
    const MassEntry *m = &s->H.at[k];
    Slot slot = lower_slot(l, m->e);
    if (m->row < s->n) lower_name(l, slot, "M", m->row, m->col);
    if (m->row == m->col && expr_sign(l->g, m->e) == SIGN_POSITIVE) {
      if (m->row < s->n) y.positive[m->row] = slot;
      else y.form[m->row] = (MassForm){.mate = NO_VARIABLE, .own = slot, .full = slot};
    }
    sparse_set(&y.H, m->row, m->col, slot);
  }
  for (uint32_t k = 0; k < s->C.n; k++) {
    const MassEntry *m = &s->C.at[k];
    vec_push(a, &y.C[m->row], ((SparseEntry){m->col, lower_slot(l, m->e)}));
  }
  for (uint32_t i = 0; i < s->n; i++) {
    y.b[i] = lower_slot(l, s->f[i]);
    lower_name(l, y.b[i], "f", i, UINT32_MAX);
  }
  return y;
}

/* --- links of point masses in a plane --- */

static int is_one(const Elimination *y, Slot s) {
  const Ins *i = &y->l->p->ins.at[s];
  return i->op == IR_CONST && num_is_one(i->number);
}

/* Whether position `parent` has a mass and nothing coupled to it yet. */
static int is_free_mass(const Elimination *y, uint32_t parent) {
  return y->H.rows[parent].n == 1 && y->form[parent].own && !y->form[parent].lambda;
}

/* Records definition p, about to be substituted, in the Link of its coordinate. */
static void note_link(Elimination *y, uint32_t p) {
  const SparseRow *c = &y->C[p];
  uint32_t v = NO_VARIABLE, parent = NO_VARIABLE, others = 0;
  Slot coefficient = 0;
  for (uint32_t i = 0; i < c->n; i++) {
    SparseEntry e = c->at[i];
    if (e.col < y->s->n && v == NO_VARIABLE) v = e.col, coefficient = e.value;
    else if (e.col >= y->s->n && parent == NO_VARIABLE && is_one(y, e.value)) parent = e.col;
    else others++;
  }
  others += parent != NO_VARIABLE && !is_free_mass(y, parent);
  for (uint32_t i = 0; i < c->n; i++) {
    if (c->at[i].col >= y->s->n) continue;
    Link *k = &y->link[c->at[i].col];
    if (others || k->n >= 2 || (!k->n && y->H.rows[v].n)) k->n = NO_LINK;
    else k->def[k->n] = p, k->parent[k->n] = parent, k->c[k->n++] = coefficient;
  }
}

/* Whether row i of H has entries in columns a, b, c alone. */
static int has_only(const Elimination *y, uint32_t i, uint32_t a, uint32_t b, uint32_t c) {
  for (uint32_t k = 0; k < y->H.rows[i].n; k++) {
    uint32_t col = y->H.rows[i].at[k].col;
    if (col != a && col != b && col != c) return 0;
  }
  return 1;
}

/* Whether coordinate v turns a rod with equal masses in both directions, and with all below in its MassForm. */
static int is_link(const Elimination *y, uint32_t v) {
  const Link *k = &y->link[v];
  if (y->s->n <= SHORT_CHAIN || k->n != 2) return 0;
  uint32_t p = k->def[0], q = k->def[1], a = k->parent[0], b = k->parent[1];
  const MassForm *f = &y->form[p], *g = &y->form[q];
  return (a == b ? a == NO_VARIABLE : a != NO_VARIABLE && b != NO_VARIABLE && y->form[a].own == y->form[b].own) &&
         f->own && f->own == g->own && f->lambda == g->lambda && f->mate == (f->lambda ? q : NO_VARIABLE) &&
         sparse_get(&y->H, p, p) == f->full && sparse_get(&y->H, q, q) == g->full && has_only(y, p, p, f->mate, p) &&
         has_only(y, q, q, f->lambda ? a : q, f->lambda ? v : q) && has_only(y, v, v, a, b);
}

/* lambda of a rod's parents: det H/H_vv of the row that the rod below left, det H = m (m + lambda |n|^2). Every other
 * one is taken from the quotient below, so that two rods wait for one division. */
static Fraction next_lambda(Elimination *y, const MassForm *f, Slot own, Slot d, Slot across2) {
  Prog *p = y->l->p;
  if (f->lambda && f->ahead.num) {
    Slot num = prog_add_product(p, op(y->l, IR_MUL, f->own, f->ahead.den), f->length2, f->ahead.num);
    Slot den = prog_add_product(p, op(y->l, IR_MUL, own, f->ahead.den), across2, f->ahead.num);
    return (Fraction){op(y->l, IR_MUL, f->own, num), den};
  }
  Slot inner = f->lambda ? prog_add_product(p, f->own, f->lambda, f->length2) : f->own;
  return (Fraction){op(y->l, IR_MUL, f->own, inner), d};
}

/* Sets row v of H from the MassForms, as sums of positive terms: with n across the rod below and g = (n c), H_vv = m
 * |c|^2 + lambda g^2. The elimination of v leaves lambda' n' n'^T on the parents, n' across c; returns lambda'. */
static Fraction link_row(Elimination *y, uint32_t v) {
  Prog *p = y->l->p;
  Link *k = &y->link[v];
  const MassForm *f = &y->form[k->def[0]], *g = &y->form[k->def[1]];
  Slot length2 = prog_add_product(p, op(y->l, IR_MUL, k->c[0], k->c[0]), k->c[1], k->c[1]);
  Slot own = op(y->l, IR_MUL, f->own, length2), d = own, across2 = 0;
  Slot h[2] = {op(y->l, IR_MUL, f->own, k->c[0]), op(y->l, IR_MUL, f->own, k->c[1])};
  if (f->lambda) {
    Slot across = prog_sub_product(p, op(y->l, IR_MUL, f->c, k->c[1]), g->c, k->c[0]);
    Slot pull = op(y->l, IR_MUL, f->lambda, across);
    across2 = op(y->l, IR_MUL, across, across);
    d = prog_add_product(p, own, f->lambda, across2);
    h[0] = prog_sub_product(p, h[0], pull, g->c);
    h[1] = prog_add_product(p, h[1], pull, f->c);
  }
  Fraction next = next_lambda(y, f, own, d, across2);
  k->n = LINKED;
  sparse_set(&y->H, v, v, d);
  for (int i = 0; i < 2 && k->parent[i] != NO_VARIABLE; i++) {
    sparse_set(&y->H, v, k->parent[i], h[i]);
    y->form[k->parent[i]].length2 = length2;
    y->form[k->parent[i]].ahead = next.den == d ? next : (Fraction){0};
  }
  return next;
}

/* Sets the parents' MassForms after the elimination of v. */
static void link_parents(Elimination *y, uint32_t v, Slot lambda) {
  Prog *p = y->l->p;
  const Link *k = &y->link[v];
  if (k->parent[0] == NO_VARIABLE) return;
  for (int i = 0; i < 2; i++) {
    MassForm *f = &y->form[k->parent[i]];
    Slot other = k->c[!i];
    f->mate = k->parent[!i], f->lambda = lambda, f->c = k->c[i];
    f->full = prog_add_product(p, f->own, lambda, op(y->l, IR_MUL, other, other));
    sparse_set(&y->H, k->parent[i], k->parent[i], f->full);
  }
  Slot cross = op(y->l, IR_MUL, lambda, op(y->l, IR_MUL, k->c[0], k->c[1]));
  sparse_set(&y->H, k->parent[0], k->parent[1], op(y->l, IR_NEG, cross, 0));
}

/* --- elimination --- */

/* Eliminates coordinate v from H and b: H -= h h^T/d, b -= h b_v/d, with h its column. */
static void eliminate_coordinate(Elimination *y, uint32_t v) {
  Fraction link = is_link(y, v) ? link_row(y, v) : (Fraction){0};
  const SparseRow *row = &y->H.rows[v];
  Slot d = sparse_get(&y->H, v, v);
  lower_name(y->l, d, "D", v, UINT32_MAX);
  if (!d || d != y->positive[v]) lower_pivot(y->l, d, 1);
  SparseRow *below = &y->factor[v];
  for (uint32_t k = 0; k < row->n; k++) {
    SparseEntry h = row->at[k];
    if (h.col == v) continue;
    Slot f = op(y->l, IR_DIV, h.value, d);
    if (h.col < y->s->n) lower_name(y->l, f, "L", v, h.col);
    for (uint32_t j = 0; j < below->n && !link.num; j++) { /* earlier entries of the column */
      SparseEntry g = below->at[j];
      sparse_set(&y->H, h.col, g.col, prog_sub_product(y->l->p, sparse_get(&y->H, h.col, g.col), h.value, g.value));
    }
    Slot rest = prog_sub_product(y->l->p, sparse_get(&y->H, h.col, h.col), h.value, f);
    if (!link.num) sparse_set(&y->H, h.col, h.col, rest);
    y->b[h.col] = prog_sub_product(y->l->p, y->b[h.col], f, y->b[v]);
    vec_push(y->l->p->arena, below, ((SparseEntry){h.col, f}));
  }
  if (link.num) link_parents(y, v, op(y->l, IR_DIV, link.num, link.den));
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
  note_link(y, v);
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

/* Back substitution of coordinate v, with x_a = x_a' + c x_u of the rod above put in, so that x_v waits for one product
 * with x_u instead of three. Returns 0 where no rod is above. */
static int link_backward(Elimination *y, uint32_t v, const FactorRecord *f) {
  const SparseRow *below = &y->factor[v];
  if (y->link[v].n != LINKED || below->n != 2) return 0;
  const SparseRow *C[2] = {&y->C[below->at[0].col], &y->C[below->at[1].col]};
  uint32_t u = NO_VARIABLE;
  for (uint32_t i = 0; i < C[0]->n; i++)
    if (C[0]->at[i].col < y->s->n) u = C[0]->at[i].col;
  if (u == NO_VARIABLE || y->link[u].n != LINKED) return 0;
  Prog *p = y->l->p;
  Slot x = op(y->l, IR_DIV, y->b[v], f->pivot[v]), turn = 0;
  for (int i = 0; i < 2; i++)
    for (uint32_t j = 0; j < C[i]->n; j++) {
      SparseEntry c = C[i]->at[j];
      if (c.col == u) turn = prog_add_product(p, turn, below->at[i].value, c.value);
      else x = prog_sub_product(p, x, below->at[i].value, y->x[c.col]);
    }
  y->x[v] = prog_sub_product(p, x, turn, y->x[u]);
  return 1;
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
  for (uint32_t k = total; k-- > 0;) {
    uint32_t v = y.s->order[k];
    if (v >= y.s->n || !link_backward(&y, v, &factors)) factor_record_backward(l->p, &factors, v, y.b, NULL, y.x);
  }
  for (uint32_t i = 0; i < y.s->n; i++) acc[i] = y.x[i];
  if (l->factored) *l->factored = factors;
  l->x = y.x;
}
