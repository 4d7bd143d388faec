#include "mech/noether_forms.h"

#include <math.h>
#include <string.h>

enum { NODES_MOST = 20000, COORDINATES_MOST = 20 };

/* c[0] x_0 + ... + c[n-1] x_(n-1) + c[n]. */
typedef struct {
  Expr node;
  Num *c;
} Form;

typedef struct {
  Arena *arena;
  ExprGraph *g;
  const SymId *symbol; /* x */
  uint32_t n;
  ExprMap place;       /* of a node in all, from 1 */
  VEC(Form) all;       /* affine nodes that are no number */
} Forms;

/* The place in n symbols; n: it is none of them. */
static uint32_t index_of(const Forms *f, SymId s) {
  uint32_t i = 0;
  while (i < f->n && f->symbol[i] != s) i++;
  return i;
}

static const Num *form_of(const Forms *f, Expr x) {
  uint32_t at = expr_map_get(&f->place, x);
  return at ? f->all.at[at - 1].c : NULL;
}

/* to += factor * x, a number or a form; 0: it is neither. */
static int add_scaled(const Forms *f, Num factor, Expr x, Num *to) {
  const Num *c = form_of(f, x);
  if (expr_is_num(f->g, x)) to[f->n] = num_add(to[f->n], num_mul(factor, expr_number(f->g, x)));
  else if (!c) return 0;
  for (uint32_t i = 0; c && i <= f->n; i++) to[i] = num_add(to[i], num_mul(factor, c[i]));
  return 1;
}

static Num *zeros(Arena *a, size_t n) {
  Num *x = ARENA_ARRAY(a, Num, n + 1);
  for (size_t i = 0; i < n; i++) x[i] = num_int(0);
  return x;
}

/* What x is made of, if it is affine. */
static int read_form(const Forms *f, Expr x, Num *to) {
  ExprOp op = expr_op(f->g, x);
  if (op == EX_SYM) {
    uint32_t i = index_of(f, expr_sym_id(f->g, x));
    if (i < f->n) to[i] = num_int(1);
    return i < f->n;
  }
  if (op == EX_DEF) return add_scaled(f, num_int(1), expr_arg(f->g, x, 0), to);
  if (op != EX_SUM) return 0;
  for (uint32_t i = 0; i < expr_pairs(f->g, x, EX_SUM); i++) {
    Num factor;
    Expr term = expr_pair(f->g, x, EX_SUM, i, &factor);
    if (!add_scaled(f, factor, term, to)) return 0;
  }
  return 1;
}

static int is_usable(const Forms *f, const Num *c) {
  int some = 0;
  for (uint32_t i = 0; i <= f->n; i++) {
    if (!num_is_exact(c[i])) return 0;
    some |= i < f->n && !num_is_zero(c[i]);
  }
  return some;
}

static Forms forms_in(Arena *a, ExprGraph *g, ExprList nodes, const SymId *symbol, uint32_t n) {
  Forms f = {.arena = a, .g = g, .symbol = symbol, .n = n, .place = expr_map(a)};
  for (uint32_t k = 0; k < nodes.n; k++) {
    Num *c = zeros(a, n + 1);
    if (expr_is_num(g, nodes.at[k]) || !read_form(&f, nodes.at[k], c) || !is_usable(&f, c)) continue;
    vec_push(a, &f.all, ((Form){nodes.at[k], c}));
    expr_map_set(&f.place, nodes.at[k], f.all.n);
  }
  return f;
}

/* Those that something which is no form is made of: of x' + y' in its square, not x'. */
static ExprMap used_forms(Arena *a, const Forms *f, ExprList nodes) {
  ExprMap used = expr_map(a);
  for (uint32_t k = 0; k < nodes.n; k++) {
    if (form_of(f, nodes.at[k])) continue;
    for (uint32_t i = 0; i < expr_nargs(f->g, nodes.at[k]); i++) expr_map_set(&used, expr_arg(f->g, nodes.at[k], i), 1);
  }
  return used;
}

/* The place of the entry that is not zero and has the fewest digits: what is divided by it stays within 64 bits longest. n: all are zero. */
static uint32_t shortest(const Num *row, uint32_t n) {
  uint32_t best = n;
  double least = INFINITY;
  for (uint32_t k = 0; k < n; k++) {
    double size = fabs((double)row[k].num) * (double)row[k].den;
    if (num_is_zero(row[k]) || !num_is_exact(row[k]) || size >= least) continue;
    least = size;
    best = k;
  }
  return best;
}

/* Rows in reduced echelon form, as they come (Gauss and Jordan). */
typedef struct {
  uint32_t rows, leading, width; /* pivots stand among the leading columns */
  uint32_t *pivot;
  Num *at;                       /* [rows*width] */
} Echelon;

static Echelon echelon(Arena *a, uint32_t leading, uint32_t width) {
  return (Echelon){0, leading, width, ARENA_ARRAY(a, uint32_t, leading + 1), zeros(a, (size_t)leading * width)};
}

/* row less so many times the other. */
static void subtract(uint32_t n, Num *row, Num times, const Num *other) {
  for (uint32_t k = 0; k < n && !num_is_zero(times); k++) row[k] = num_sub(row[k], num_mul(times, other[k]));
}

/* Adds a row, which is destroyed; 0: its leading columns depend on those before it. */
static int echelon_add(Echelon *e, Num *row) {
  for (uint32_t r = 0; r < e->rows; r++) subtract(e->width, row, row[e->pivot[r]], e->at + (size_t)r * e->width);
  uint32_t first = shortest(row, e->leading);
  if (first == e->leading) return 0;
  Num by = row[first];
  for (uint32_t k = 0; k < e->width; k++) row[k] = num_div(row[k], by);
  for (uint32_t r = 0; r < e->rows; r++) subtract(e->width, e->at + (size_t)r * e->width, e->at[(size_t)r * e->width + first], row);
  memcpy(e->at + (size_t)e->rows * e->width, row, e->width * sizeof *row);
  e->pivot[e->rows++] = first;
  return 1;
}

/* S and its inverse from the velocities' forms. */
static int take_rows(Arena *a, const Forms *f, ExprList nodes, LinearForms *to) {
  ExprMap used = used_forms(a, f, nodes);
  size_t n = f->n;
  Echelon e = echelon(a, f->n, 2 * f->n); /* S beside the identity */
  Num *row = zeros(a, 2 * n);
  for (uint32_t k = 0; k < f->all.n && e.rows < n; k++) {
    const Num *c = f->all.at[k].c;
    uint32_t i = e.rows;
    for (size_t x = 0; x < n; x++) row[x] = c[x], row[n + x] = num_int(x == i);
    if (expr_map_get(&used, f->all.at[k].node) && echelon_add(&e, row)) memcpy(to->S + i * n, c, n * sizeof *c);
  }
  if (e.rows < n) return 0;
  for (size_t r = 0; r < n; r++)
    for (size_t k = 0; k < n; k++) {
      to->inverse[e.pivot[r] * n + k] = e.at[r * 2 * n + n + k];
      if (!num_is_exact(to->inverse[e.pivot[r] * n + k])) return 0;
    }
  return 1;
}

/* Shifts with which the forms in q have no constant left when they are written in y: all of them, or the first ones. */
static void take_shifts(Arena *a, const Forms *f, LinearForms *to) {
  size_t n = f->n;
  Echelon e = echelon(a, f->n, f->n + 1);
  Num *row = zeros(a, n + 1);
  for (uint32_t k = 0; k < f->all.n && e.rows < n; k++) {
    const Num *c = f->all.at[k].c;
    for (size_t i = 0; i <= n; i++) row[i] = i < n ? num_int(0) : c[n];
    for (size_t i = 0; i < n; i++)
      for (size_t j = 0; j < n; j++) row[i] = num_add(row[i], num_mul(c[j], to->inverse[j * n + i]));
    if (expr_op(f->g, f->all.at[k].node) != EX_SYM) echelon_add(&e, row);
  }
  for (uint32_t r = 0; r < e.rows; r++) {
    Num shift = e.at[r * (n + 1) + n];
    if (num_is_exact(shift)) to->shift[e.pivot[r]] = shift;
  }
}

/* M S^-1, [n*n] */
static Expr *mass_times_inverse(Arena *a, const Eqns *e, const LinearForms *f) {
  size_t n = f->n;
  Expr *to = ARENA_ARRAY(a, Expr, n * n + 1);
  for (size_t k = 0; k < n * n; k++) to[k] = expr_int(e->g, 0);
  for (uint32_t k = 0; k < e->mass.n; k++) {
    const MassEntry *m = &e->mass.at[k];
    for (size_t i = 0; i < n; i++) {
      Expr one = expr_scale(e->g, f->inverse[m->col * n + i], m->e), other = expr_scale(e->g, f->inverse[m->row * n + i], m->e);
      to[m->row * n + i] = expr_add(e->g, to[m->row * n + i], one);
      if (m->row != m->col) to[m->col * n + i] = expr_add(e->g, to[m->col * n + i], other);
    }
  }
  return to;
}

/* Whether M = S^T D S with a diagonal D: each column of M S^-1 = S^T D is then a multiple of a row of S. */
static int is_diagonal(Arena *a, const Eqns *e, const LinearForms *f) {
  size_t n = f->n;
  const Expr *by = mass_times_inverse(a, e, f);
  for (size_t i = 0; i < n; i++) {
    const Num *row = f->S + i * n;
    size_t first = 0;
    while (num_is_zero(row[first])) first++;
    Expr mass = expr_scale(e->g, num_div(num_int(1), row[first]), by[first * n + i]);
    for (size_t k = 0; k < n; k++)
      if (by[k * n + i] != expr_scale(e->g, row[k], mass)) return 0;
  }
  return 1;
}

/* sum of k[i*step] x[i*stride] */
static Expr combination(ExprGraph *g, Arena *a, uint32_t n, const Num *k, size_t step, const Expr *x, size_t stride) {
  Expr *terms = ARENA_ARRAY(a, Expr, n + 1);
  for (size_t i = 0; i < n; i++) terms[i] = expr_scale(g, k[i * step], x[i * stride]);
  return expr_add_n(g, terms, n);
}

/* The row of S that c is a multiple of, and *times; n: there is none. */
static uint32_t row_of(const LinearForms *f, const Num *c, Num *times) {
  for (uint32_t i = 0; i < f->n; i++) {
    const Num *row = f->S + (size_t)i * f->n;
    uint32_t first = 0, same = 0;
    while (num_is_zero(row[first])) first++;
    *times = num_div(c[first], row[first]);
    while (!num_is_zero(*times) && same < f->n && num_equal(c[same], num_mul(*times, row[same]))) same++;
    if (same == f->n) return i;
  }
  return f->n;
}

/* Notes what forms are that are multiples of y less the shift, or of y', and of their symbols. */
static void note_forms(Arena *a, const Forms *of, LinearForms *f, int shifted) {
  ExprGraph *g = of->g;
  Expr *y = ARENA_ARRAY(a, Expr, f->n + 1);
  for (uint32_t i = 0; i < f->n; i++) {
    Expr node = expr_symbol(g, of->symbol[i])->node, shift = expr_num(g, f->shift[i]);
    y[i] = shifted ? expr_sub(g, node, shift) : node;
  }
  for (uint32_t k = 0; k < of->all.n; k++) {
    Num times, constant = of->all.at[k].c[f->n];
    uint32_t i = row_of(f, of->all.at[k].c, &times);
    if (i == f->n || expr_op(g, of->all.at[k].node) == EX_SYM) continue;
    Expr scaled = expr_scale(g, times, y[i]), rest = expr_num(g, constant);
    vec_push(a, &f->node, of->all.at[k].node);
    vec_push(a, &f->is, expr_add(g, scaled, rest));
  }
  for (uint32_t i = 0; i < f->n; i++) {
    vec_push(a, &f->node, expr_symbol(g, of->symbol[i])->node);
    vec_push(a, &f->is, combination(g, a, f->n, f->inverse + (size_t)i * f->n, 1, y, 1));
  }
}

int forms_are_needed(const Eqns *e) {
  int skew = 0;
  if (!e->n || e->n > COORDINATES_MOST || !e->mass_known || !e->constant_mass) return 0;
  for (uint32_t k = 0; k < e->mass.n; k++) skew |= e->mass.at[k].row != e->mass.at[k].col;
  for (uint32_t i = 0; i < e->n; i++)
    if (expr_symbol(e->g, e->m->coords.at[i].q)->sign != SIGN_UNKNOWN) return 0;
  return skew;
}

const LinearForms *forms_new(Arena *a, const Eqns *e) {
  uint32_t n = e->n;
  Expr L = e->m->lagrangian;
  if (!forms_are_needed(e)) return NULL;
  ExprList nodes = expr_topo(e->g, &L, 1);
  if (nodes.n > NODES_MOST) return NULL;
  LinearForms *to = ARENA_NEW(a, LinearForms);
  *to = (LinearForms){.n = n, .S = zeros(a, (size_t)n * n), .inverse = zeros(a, (size_t)n * n), .shift = zeros(a, n)};
  SymId *q = ARENA_ARRAY(a, SymId, n), *v = ARENA_ARRAY(a, SymId, n);
  for (uint32_t i = 0; i < n; i++) q[i] = e->m->coords.at[i].q, v[i] = e->m->coords.at[i].v;
  Forms of_velocities = forms_in(a, e->g, nodes, v, n), of_coordinates = forms_in(a, e->g, nodes, q, n);
  if (!take_rows(a, &of_velocities, nodes, to) || !is_diagonal(a, e, to)) return NULL;
  take_shifts(a, &of_coordinates, to);
  note_forms(a, &of_velocities, to, 0);
  note_forms(a, &of_coordinates, to, 1);
  return to;
}

Verdict forms_prove_zero(const LinearForms *f, ExprGraph *g, Expr x) {
  Verdict v = prove_zero(g, x, NULL);
  if (v != NOT_DECIDED || !f) return v;
  expr_cut(g, &x, 1, f->node.at, f->is.at, f->node.n, &x);
  return prove_zero(g, x, NULL);
}

void forms_to_coordinates(const LinearForms *f, ExprGraph *g, Expr *c) {
  size_t n = f->n;
  Arena *a = expr_arena(g);
  Expr *column = ARENA_ARRAY(a, Expr, n * (n + 1) + 1); /* xi of y as affine in q: [i][1, q_0 ..] */
  for (size_t i = 0; i < n; i++) {
    const Expr *linear = c + n + i * n;
    Expr of_shift = combination(g, a, f->n, f->shift, 1, linear, 1);
    column[i * (n + 1)] = expr_add(g, c[i], of_shift);
    for (size_t k = 0; k < n; k++) column[i * (n + 1) + 1 + k] = combination(g, a, f->n, f->S + k, n, linear, 1);
  }
  for (size_t j = 0; j < n; j++) {
    c[j] = combination(g, a, f->n, f->inverse + j * n, 1, column, n + 1);
    for (size_t k = 0; k < n; k++) c[n + j * n + k] = combination(g, a, f->n, f->inverse + j * n, 1, column + 1 + k, n + 1);
  }
}
