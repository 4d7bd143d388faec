#include "mech/noether_forms.h"

#include <string.h>

enum { NODES_MOST = 20000 };

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

/* row less multiples of the rows of done[count*width], whose first entries that are not zero are 1 in other places; the place of its own first one of the
 * `n`, or n. */
static uint32_t reduce_row(Num *row, const Num *done, const uint32_t *pivot, uint32_t count, uint32_t width, uint32_t n) {
  uint32_t first = 0;
  for (uint32_t r = 0; r < count; r++) {
    Num times = row[pivot[r]];
    for (uint32_t k = 0; k < width && !num_is_zero(times); k++) row[k] = num_sub(row[k], num_mul(times, done[(size_t)r * width + k]));
  }
  while (first < n && num_is_zero(row[first])) first++;
  if (first == n) return n;
  Num by = row[first];
  for (uint32_t k = 0; k < width; k++) row[k] = num_div(row[k], by);
  return first;
}

/* Gauss and Jordan, row by row: S comes with its inverse. */
typedef struct {
  LinearForms *to;
  uint32_t rows, *pivot;
  Num *done; /* [n][2n] reduced rows of S, and what of the identity they took */
} Elimination;

/* Adds a row of S, where it is independent of those before it. */
static void add_form(Elimination *e, const Num *c, Num *scratch) {
  uint32_t n = e->to->n, w = 2 * n;
  for (uint32_t i = 0; i < n; i++) scratch[i] = c[i], scratch[n + i] = num_int(i == e->rows);
  uint32_t first = reduce_row(scratch, e->done, e->pivot, e->rows, w, n);
  if (first == n) return;
  memcpy(e->to->S + (size_t)e->rows * n, c, n * sizeof *c);
  for (uint32_t r = 0; r < e->rows; r++) {
    Num *row = e->done + (size_t)r * w, times = row[first];
    for (uint32_t k = 0; k < w && !num_is_zero(times); k++) row[k] = num_sub(row[k], num_mul(times, scratch[k]));
  }
  memcpy(e->done + (size_t)e->rows * w, scratch, w * sizeof *scratch);
  e->pivot[e->rows++] = first;
}

/* S and its inverse from the velocities' forms. */
static int take_rows(Arena *a, const Forms *f, ExprList nodes, LinearForms *to) {
  ExprMap used = used_forms(a, f, nodes);
  size_t n = f->n;
  Elimination e = {to, 0, ARENA_ARRAY(a, uint32_t, n), zeros(a, 2 * n * n)};
  Num *scratch = zeros(a, 2 * n);
  for (uint32_t k = 0; k < f->all.n && e.rows < n; k++)
    if (expr_map_get(&used, f->all.at[k].node)) add_form(&e, f->all.at[k].c, scratch);
  if (e.rows < n) return 0;
  for (size_t r = 0; r < n; r++)
    for (size_t k = 0; k < n; k++) {
      to->inverse[e.pivot[r] * n + k] = e.done[r * 2 * n + n + k];
      if (!num_is_exact(to->inverse[e.pivot[r] * n + k])) return 0;
    }
  return 1;
}

/* The constant of the first form in q that is a multiple of row i. */
static Num shift_of(const Forms *f, const Num *row) {
  uint32_t first = 0;
  while (num_is_zero(row[first])) first++;
  for (uint32_t k = 0; k < f->all.n; k++) {
    const Num *c = f->all.at[k].c;
    Num times = num_div(c[first], row[first]);
    int same = !num_is_zero(times);
    for (uint32_t i = 0; i < f->n && same; i++) same = num_equal(c[i], num_mul(times, row[i]));
    Num shift = same ? num_div(c[f->n], times) : num_int(0);
    if (same && num_is_exact(shift)) return shift;
  }
  return num_int(0);
}

/* Whether column i of the inverse and column j of it are orthogonal in the metric of the mass matrix. */
static int is_diagonal(Arena *a, const Eqns *e, const LinearForms *f) {
  size_t n = f->n;
  Expr *terms = ARENA_ARRAY(a, Expr, 2 * e->mass.n + 1);
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < i; j++) {
      uint32_t count = 0;
      for (uint32_t k = 0; k < e->mass.n; k++) {
        const MassEntry *m = &e->mass.at[k];
        Num one = num_mul(f->inverse[m->row * n + i], f->inverse[m->col * n + j]);
        Num other = m->row == m->col ? num_int(0) : num_mul(f->inverse[m->col * n + i], f->inverse[m->row * n + j]);
        terms[count++] = expr_scale(e->g, num_add(one, other), m->e);
      }
      if (!expr_is_zero(e->g, expr_add_n(e->g, terms, count))) return 0;
    }
  return 1;
}

const LinearForms *forms_new(Arena *a, const Eqns *e, const SymId *q, const SymId *v, uint32_t n) {
  Expr L = e->m->lagrangian;
  ExprList nodes = expr_topo(e->g, &L, 1);
  if (nodes.n > NODES_MOST) return NULL;
  LinearForms *to = ARENA_NEW(a, LinearForms);
  *to = (LinearForms){n, zeros(a, (size_t)n * n), zeros(a, (size_t)n * n), zeros(a, n)};
  Forms of_velocities = forms_in(a, e->g, nodes, v, n);
  if (!take_rows(a, &of_velocities, nodes, to) || !is_diagonal(a, e, to)) return NULL;
  Forms of_coordinates = forms_in(a, e->g, nodes, q, n);
  for (uint32_t i = 0; i < n; i++) to->shift[i] = shift_of(&of_coordinates, to->S + (size_t)i * n);
  return to;
}

/* sum of k[i*step] x[i*stride] */
static Expr combination(ExprGraph *g, Arena *a, uint32_t n, const Num *k, size_t step, const Expr *x, size_t stride) {
  Expr *terms = ARENA_ARRAY(a, Expr, n + 1);
  for (size_t i = 0; i < n; i++) terms[i] = expr_scale(g, k[i * step], x[i * stride]);
  return expr_add_n(g, terms, n);
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
