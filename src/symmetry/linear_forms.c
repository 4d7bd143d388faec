/* Reads affine forms off the graph of L, takes n independent ones of velocities as the rows of S, inverts S (exactly, or with parameters), and
 * rewrites L, momenta and mass in y. */
#include "symmetry/linear_forms.h"

#include <math.h>
#include <string.h>

#include "base/dense.h"
#include "base/rational_solve.h"
#include "sym/diff.h"
#include "sym/eval.h"
#include "sym/simplify.h"

enum { NODES_MOST = 20000, COORDINATES_MOST = 20, SYMBOLIC_MOST = 8 };

/* Affine form c[0] x_0 + ... + c[n-1] x_(n-1) + c[n] with constants c. */
typedef struct {
  Expr node;
  Expr *c;
} Form;

typedef struct {
  Arena *arena;
  ExprGraph *g;
  const SymId *symbol; /* [n] x */
  uint32_t n;
  ExprMap place;       /* position of a node in all, from 1 */
  VEC(Form) all;       /* affine nodes that are not constant */
} Forms;

static Expr *zeros(Arena *a, ExprGraph *g, size_t n) {
  Expr *x = ARENA_ARRAY(a, Expr, n + 1);
  for (size_t i = 0; i < n; i++) x[i] = expr_int(g, 0);
  return x;
}

/* --- affine forms in L --- */

/* Index of s among the n symbols; n: it is none of them. */
static uint32_t index_of(const Forms *f, SymId s) {
  uint32_t i = 0;
  while (i < f->n && f->symbol[i] != s) i++;
  return i;
}

static const Expr *form_of(const Forms *f, Expr x) {
  uint32_t at = expr_map_get(&f->place, x);
  return at ? f->all.at[at - 1].c : NULL;
}

/* to += factor * x for a constant or a form x; 0: x is neither. */
static int add_scaled(const Forms *f, Expr factor, Expr x, Expr *to) {
  const Expr *c = form_of(f, x);
  if (!c && !expr_is_constant(f->g, x)) return 0;
  if (!c) to[f->n] = expr_add(f->g, to[f->n], expr_mul(f->g, factor, x));
  for (uint32_t i = 0; c && i <= f->n; i++) to[i] = expr_add(f->g, to[i], expr_mul(f->g, factor, c[i]));
  return 1;
}

static int read_sum(const Forms *f, Expr x, Expr *to) {
  for (uint32_t i = 0; i < expr_pairs(f->g, x, EX_SUM); i++) {
    Num factor;
    Expr term = expr_pair(f->g, x, EX_SUM, i, &factor);
    if (!add_scaled(f, expr_num(f->g, factor), term, to)) return 0;
  }
  return 1;
}

/* Coefficients of a product of constants and one form. */
static int read_product(const Forms *f, Expr x, Expr *to) {
  Expr factor = expr_int(f->g, 1), form = 0;
  for (uint32_t i = 0; i < expr_pairs(f->g, x, EX_PROD); i++) {
    Num power;
    Expr base = expr_pair(f->g, x, EX_PROD, i, &power);
    if (expr_is_constant(f->g, base)) factor = expr_mul(f->g, factor, expr_pow_num(f->g, base, power));
    else if (form || !num_is_one(power)) return 0;
    else form = base;
  }
  return form && add_scaled(f, factor, form, to);
}

/* Coefficients of x; 0: it is not affine. */
static int read_form(const Forms *f, Expr x, Expr *to) {
  ExprOp op = expr_op(f->g, x);
  if (op == EX_SYM) {
    uint32_t i = index_of(f, expr_sym_id(f->g, x));
    if (i < f->n) to[i] = expr_int(f->g, 1);
    return i < f->n;
  }
  if (op == EX_DEF) return add_scaled(f, expr_int(f->g, 1), expr_arg(f->g, x, 0), to);
  return op == EX_SUM ? read_sum(f, x, to) : op == EX_PROD && read_product(f, x, to);
}

static int is_usable(const Forms *f, const Expr *c) {
  int some = 0;
  for (uint32_t i = 0; i <= f->n; i++) {
    if (expr_is_num(f->g, c[i]) && !num_is_exact(expr_number(f->g, c[i]))) return 0;
    some |= i < f->n && !expr_is_zero(f->g, c[i]);
  }
  return some;
}

static Forms forms_in(Arena *a, ExprGraph *g, ExprList nodes, const SymId *symbol, uint32_t n) {
  Forms f = {.arena = a, .g = g, .symbol = symbol, .n = n, .place = expr_map(a)};
  for (uint32_t k = 0; k < nodes.n; k++) {
    Expr *c = zeros(a, g, n + 1);
    if (expr_is_constant(g, nodes.at[k]) || !read_form(&f, nodes.at[k], c) || !is_usable(&f, c)) continue;
    vec_push(a, &f.all, ((Form){nodes.at[k], c}));
    expr_map_set(&f.place, nodes.at[k], f.all.n);
  }
  return f;
}

/* Forms that are arguments of a node that is no form: x' + y' where its square stands, not x'. */
static ExprMap used_forms(Arena *a, const Forms *f, ExprList nodes) {
  ExprMap used = expr_map(a);
  for (uint32_t k = 0; k < nodes.n; k++) {
    if (form_of(f, nodes.at[k])) continue;
    for (uint32_t i = 0; i < expr_nargs(f->g, nodes.at[k]); i++) expr_map_set(&used, expr_arg(f->g, nodes.at[k], i), 1);
  }
  return used;
}

/* --- S and its inverse --- */

static int are_numbers(const ExprGraph *g, const Expr *x, size_t n) {
  for (size_t k = 0; k < n; k++)
    if (!expr_is_num(g, x[k])) return 0;
  return 1;
}

static Num *numbers(Arena *a, const ExprGraph *g, const Expr *x, size_t n) {
  Num *to = ARENA_ARRAY(a, Num, n + 1);
  for (size_t k = 0; k < n; k++) to[k] = expr_number(g, x[k]);
  return to;
}

/* Term i of a sum without its coefficient *c; a number is a multiple of 1. */
static Expr term_of(ExprGraph *g, Expr x, uint32_t i, Num *c) {
  if (!expr_is_num(g, x)) return expr_pair(g, x, EX_SUM, i, c);
  *c = expr_number(g, x);
  return expr_int(g, 1);
}

static Num coefficient_of(ExprGraph *g, Expr x, Expr term) {
  for (uint32_t i = 0; i < expr_pairs(g, x, EX_SUM); i++) {
    Num c;
    if (term_of(g, x, i, &c) == term) return c;
  }
  return num_int(0);
}

typedef VEC(Expr) Terms;

/* The distinct terms of all x, without their coefficients. */
static Terms terms_of(Arena *a, ExprGraph *g, const Expr *x, size_t n) {
  ExprMap seen = expr_map(a);
  Terms all = {0};
  for (size_t k = 0; k < n; k++)
    for (uint32_t i = 0; i < expr_pairs(g, x[k], EX_SUM); i++) {
      Num c;
      Expr term = term_of(g, x[k], i, &c);
      if (expr_map_get(&seen, term)) continue;
      expr_map_set(&seen, term, 1);
      vec_push(a, &all, term);
    }
  return all;
}

int forms_solve(Arena *a, ExprGraph *g, uint32_t n, const Num *m, uint32_t columns, Expr *x) {
  size_t size = (size_t)n * columns;
  Terms terms = terms_of(a, g, x, size);
  Num *b = ARENA_ARRAY(a, Num, size + 1);
  Expr *sum = zeros(a, g, size);
  for (uint32_t t = 0; t < terms.n; t++) {
    for (size_t k = 0; k < size; k++) b[k] = coefficient_of(g, x[k], terms.at[t]);
    if (!rational_solve(a, n, m, columns, b, b)) return 0;
    for (size_t k = 0; k < size; k++) {
      Expr term = expr_scale(g, b[k], terms.at[t]);
      sum[k] = expr_add(g, sum[k], term);
    }
  }
  memcpy(x, sum, size * sizeof *x);
  return 1;
}

/* sum of k[i*step] x[i*stride] */
static Expr combination(ExprGraph *g, Arena *a, uint32_t n, const Expr *k, size_t step, const Expr *x, size_t stride) {
  Expr *terms = ARENA_ARRAY(a, Expr, n + 1);
  for (size_t i = 0; i < n; i++) terms[i] = expr_mul(g, k[i * step], x[i * stride]);
  return expr_add_n(g, terms, n);
}

/* Values of constants at random values of the parameters. */
static void values_of(Arena *a, ExprGraph *g, const Expr *x, uint32_t n, long double *to) {
  long double *symbols = ARENA_ARRAY(a, long double, expr_symbol_count(g) + 1);
  sample_state(g, 1, symbols);
  expr_eval(g, x, n, symbols, to);
}

/* Row, k or below, with the shortest entry in column k; n: all are zero. */
static size_t pivot_row(ExprGraph *g, size_t n, const Expr *m, size_t k) {
  size_t best = n;
  uint32_t least = UINT32_MAX, distinct;
  for (size_t i = k; i < n; i++) {
    uint32_t size = (uint32_t)expr_tree_size(g, m[i * 2 * n + k], &distinct);
    if (expr_is_zero(g, m[i * 2 * n + k]) || size >= least) continue;
    least = size;
    best = i;
  }
  return best;
}

/* Gauss-Jordan elimination of [S | 1] on expressions. 0: a pivot is missing. */
static int invert_symbols(Arena *a, ExprGraph *g, size_t n, const Expr *S, Expr *to) {
  Expr *m = zeros(a, g, 2 * n * n), *kept = ARENA_ARRAY(a, Expr, 2 * n + 1);
  for (size_t i = 0; i < n; i++) {
    memcpy(m + i * 2 * n, S + i * n, n * sizeof *m);
    m[i * 2 * n + n + i] = expr_int(g, 1);
  }
  for (size_t k = 0; k < n; k++) {
    size_t best = pivot_row(g, n, m, k), size = 2 * n * sizeof *m;
    if (best == n) return 0;
    memcpy(kept, m + best * 2 * n, size);
    memcpy(m + best * 2 * n, m + k * 2 * n, size);
    for (size_t j = 0; j < 2 * n; j++) m[k * 2 * n + j] = simplify(g, expr_div(g, kept[j], kept[k]));
    for (size_t i = 0; i < n; i++) {
      Expr factor = m[i * 2 * n + k];
      for (size_t j = 0; j < 2 * n && i != k && !expr_is_zero(g, factor); j++) {
        Expr taken = expr_mul(g, factor, m[k * 2 * n + j]);
        m[i * 2 * n + j] = simplify(g, expr_sub(g, m[i * 2 * n + j], taken));
      }
    }
  }
  for (size_t i = 0; i < n; i++) memcpy(to + i * n, m + i * 2 * n + n, n * sizeof *to);
  return 1;
}

static int invert(Arena *a, ExprGraph *g, LinearForms *to) {
  size_t n = to->n;
  if (!to->exact) return n <= SYMBOLIC_MOST && invert_symbols(a, g, n, to->S, to->inverse);
  Expr *x = zeros(a, g, n * n);
  for (size_t i = 0; i < n; i++) x[i * n + i] = expr_int(g, 1);
  memcpy(to->inverse, x, n * n * sizeof *x);
  return forms_solve(a, g, to->n, to->exact, to->n, to->inverse);
}

/* S and its inverse: the first n forms of velocities that are independent at generic parameters. 0: there are fewer. */
static int independent_rows(Arena *a, const Forms *f, ExprList nodes, LinearForms *to) {
  ExprMap used = used_forms(a, f, nodes);
  size_t n = f->n;
  uint32_t rows = 0;
  long double *before = ARENA_ARRAY(a, long double, n * n + 1);
  for (uint32_t k = 0; k < f->all.n && rows < n; k++) {
    const Form *form = &f->all.at[k];
    if (!expr_map_get(&used, form->node)) continue;
    values_of(a, f->g, form->c, f->n, before + rows * n);
    if (dense_gram_schmidt(f->n, before + rows * n, before, rows) < 1e-12L) continue;
    memcpy(to->S + rows * n, form->c, n * sizeof *form->c);
    to->rate[rows++] = form->node;
  }
  if (rows < n) return 0;
  to->exact = are_numbers(f->g, to->S, n * n) ? numbers(a, f->g, to->S, n * n) : NULL;
  return invert(a, f->g, to);
}

/* --- names --- */

/* Name X of the definition X', x of the velocity x'; NULL: the sum has no name. */
static Name name_of_rate(Arena *a, const ExprGraph *g, Expr rate) {
  ExprOp op = expr_op(g, rate);
  Name name = op == EX_DEF ? expr_def_name(g, rate) : op == EX_SYM ? expr_sym_of(g, rate)->name : "";
  size_t n = strlen(name);
  return n > 1 && name[n - 1] == '\'' && name[n - 2] != '\'' ? arena_strndup(a, name, n - 1) : NULL;
}

/* The coordinate or definition of that name; 0: there is none. */
static Expr named_node(const Forms *of, Name name) {
  ExprGraph *g = of->g;
  for (uint32_t i = 0; i < of->n; i++)
    if (strcmp(expr_symbol(g, of->symbol[i])->name, name) == 0) return expr_symbol(g, of->symbol[i])->node;
  for (Expr x = 1; x <= expr_count(g); x++)
    if (expr_op(g, x) == EX_DEF && strcmp(expr_def_name(g, x), name) == 0) return x;
  return 0;
}

static int same_constants(ExprGraph *g, const Expr *one, const Expr *other, uint32_t n) {
  for (uint32_t i = 0; i < n; i++)
    if (one[i] != other[i] && prove_zero(g, expr_sub(g, one[i], other[i]), NULL) != PROVED_ZERO) return 0;
  return 1;
}

/* Names row i of S after the form of coordinates with that rate, whose constant is the shift. 0: it has no name. */
static int name_row(Arena *a, const Forms *of, LinearForms *to, uint32_t i) {
  ExprGraph *g = of->g;
  Name name = name_of_rate(a, g, to->rate[i]);
  Expr node = name ? named_node(of, name) : 0;
  if (!node) return 0;
  ExprList nodes = expr_topo(g, &node, 1);
  Forms alone = forms_in(a, g, nodes, of->symbol, of->n);
  const Expr *c = form_of(&alone, node);
  if (!c || !same_constants(g, c, to->S + (size_t)i * of->n, of->n)) return 0;
  to->name[i] = name;
  to->y[i] = node;
  to->shift[i] = c[of->n];
  return 1;
}

/* Whether c is `times` a row of S. */
static int is_multiple(ExprGraph *g, uint32_t n, Expr times, const Expr *row, const Expr *c) {
  for (uint32_t k = 0; k < n; k++) {
    Expr left = expr_sub(g, c[k], expr_mul(g, times, row[k]));
    if (!expr_is_zero(g, left) && prove_zero(g, left, NULL) != PROVED_ZERO) return 0;
  }
  return 1;
}

/* The row of S that c is a multiple of, and the factor *times; n: there is none. */
static uint32_t row_of(ExprGraph *g, const LinearForms *f, const Expr *c, Expr *times) {
  for (uint32_t i = 0; i < f->n; i++) {
    const Expr *row = f->S + (size_t)i * f->n;
    uint32_t first = 0;
    while (expr_is_zero(g, row[first])) first++;
    if (expr_is_zero(g, c[first])) continue;
    *times = f->exact ? expr_div(g, c[first], row[first]) : simplify(g, expr_div(g, c[first], row[first]));
    if (is_multiple(g, f->n, *times, row, c)) return i;
  }
  return f->n;
}

/* Index of the first nonzero entry; n: all are zero. */
static uint32_t leading(const Num *row, uint32_t n) {
  uint32_t k = 0;
  while (k < n && num_is_zero(row[k])) k++;
  return k;
}

/* row -= times * other */
static void subtract(uint32_t n, Num *row, Num times, const Num *other) {
  for (uint32_t k = 0; k < n && !num_is_zero(times); k++) row[k] = num_sub(row[k], num_mul(times, other[k]));
}

/* Adds a row to `rows` rows in reduced echelon form if its first n entries are independent of theirs. Returns the new number of rows. */
static uint32_t echelon_add(uint32_t n, uint32_t rows, Num *at, Num *row) {
  uint32_t width = n + 1;
  for (uint32_t r = 0; r < rows; r++) subtract(width, row, row[leading(at + (size_t)r * width, n)], at + (size_t)r * width);
  uint32_t first = leading(row, n);
  if (first == n) return rows;
  Num by = row[first];
  for (uint32_t k = 0; k < width; k++) row[k] = num_div(row[k], by);
  for (uint32_t r = 0; r < rows; r++) subtract(width, at + (size_t)r * width, at[(size_t)r * width + first], row);
  memcpy(at + (size_t)rows * width, row, width * sizeof *row);
  return rows + 1;
}

/* Shifts that absorb the constants of sums in q when they are written in y: of all sums, or of the first independent ones. S is made of numbers. */
static void find_shifts(Arena *a, const Forms *of, LinearForms *to) {
  ExprGraph *g = of->g;
  size_t n = of->n;
  Num *across = ARENA_ARRAY(a, Num, n * n + 1), *at = ARENA_ARRAY(a, Num, n * (n + 1) + 1), *row = ARENA_ARRAY(a, Num, n + 1);
  uint32_t rows = 0;
  for (size_t k = 0; k < n * n; k++) across[k] = to->exact[k % n * n + k / n];
  for (uint32_t k = 0; k < of->all.n && rows < n; k++) {
    const Form *form = &of->all.at[k];
    if (expr_op(g, form->node) == EX_SYM || !are_numbers(g, form->c, n + 1)) continue;
    memcpy(row, numbers(a, g, form->c, n + 1), (n + 1) * sizeof *row);
    if (rational_solve(a, of->n, across, 1, row, row)) rows = echelon_add(of->n, rows, at, row);
  }
  for (uint32_t r = 0; r < rows; r++) {
    Num shift = at[r * (n + 1) + n];
    if (num_is_exact(shift)) to->shift[leading(at + r * (n + 1), of->n)] = expr_num(g, shift);
  }
}

/* y without names, written as sums. */
static void write_sums(Arena *a, const Forms *of, LinearForms *to) {
  ExprGraph *g = of->g;
  Expr *x = ARENA_ARRAY(a, Expr, of->n + 1);
  for (uint32_t k = 0; k < of->n; k++) x[k] = expr_symbol(g, of->symbol[k])->node, to->shift[k] = expr_int(g, 0);
  if (to->exact) find_shifts(a, of, to);
  for (uint32_t i = 0; i < of->n; i++) {
    Expr sum = combination(g, a, of->n, to->S + (size_t)i * of->n, 1, x, 1);
    to->y[i] = expr_add(g, sum, to->shift[i]);
  }
}

static void name_rows(Arena *a, const Forms *of, LinearForms *to) {
  to->named = 1;
  for (uint32_t i = 0; i < of->n && to->named; i++) to->named = name_row(a, of, to, i);
  if (!to->named) write_sums(a, of, to);
}

/* --- L in y --- */

/* Records forms that are multiples of y (or of y') up to a constant, and the symbols of q, with their expressions in y. */
static void note_forms(Arena *a, const Forms *of, LinearForms *f, int shifted) {
  ExprGraph *g = of->g;
  Expr *y = ARENA_ARRAY(a, Expr, f->n + 1), times;
  for (uint32_t i = 0; i < f->n; i++) {
    Expr node = expr_symbol(g, of->symbol[i])->node;
    y[i] = shifted ? expr_sub(g, node, f->shift[i]) : node;
  }
  for (uint32_t k = 0; k < of->all.n; k++) {
    const Form *form = &of->all.at[k];
    uint32_t i = expr_op(g, form->node) == EX_SYM ? f->n : row_of(g, f, form->c, &times);
    if (i == f->n) continue;
    Expr scaled = expr_mul(g, times, y[i]);
    vec_push(a, &f->node, form->node);
    vec_push(a, &f->is, expr_add(g, scaled, form->c[f->n]));
  }
  for (uint32_t i = 0; i < f->n; i++) {
    vec_push(a, &f->node, expr_symbol(g, of->symbol[i])->node);
    vec_push(a, &f->is, combination(g, a, f->n, f->inverse + (size_t)i * f->n, 1, y, 1));
  }
}

/* L, momenta and the coefficients of the kinetic energy in y. 0: it is no sum of squares with constant coefficients. */
static int derive_mass(const Eqns *e, LinearForms *f) {
  ExprGraph *g = e->g;
  expr_replace_nodes(g, &e->m->lagrangian, 1, f->node.at, f->is.at, f->node.n, &f->L);
  for (uint32_t i = 0; i < f->n; i++) {
    f->p[i] = expr_diff(g, f->L, e->m->coords.at[i].v);
    for (uint32_t k = 0; k < i; k++) {
      Expr mixed = expr_diff(g, f->p[i], e->m->coords.at[k].v);
      if (!expr_is_zero(g, mixed) && prove_zero(g, mixed, NULL) != PROVED_ZERO) return 0;
    }
    f->mass[i] = simplify(g, expr_diff(g, f->p[i], e->m->coords.at[i].v));
    if (!expr_is_constant(g, f->mass[i])) return 0;
  }
  return 1;
}

int forms_are_needed(const Eqns *e) {
  int skew = 0;
  if (!e->n || e->n > COORDINATES_MOST || !e->mass_known || !e->constant_mass) return 0;
  for (uint32_t k = 0; k < e->mass.n; k++) skew |= e->mass.at[k].row != e->mass.at[k].col;
  for (uint32_t i = 0; i < e->n; i++)
    if (expr_symbol(e->g, e->m->coords.at[i].q)->sign != SIGN_UNKNOWN) return 0;
  return skew;
}

static LinearForms *forms_sized(Arena *a, ExprGraph *g, uint32_t n) {
  LinearForms *to = ARENA_NEW(a, LinearForms);
  *to = (LinearForms){.n = n, .S = zeros(a, g, (size_t)n * n), .inverse = zeros(a, g, (size_t)n * n), .shift = zeros(a, g, n)};
  to->mass = zeros(a, g, n);
  to->p = zeros(a, g, n);
  to->y = zeros(a, g, n);
  to->rate = zeros(a, g, n);
  to->name = ARENA_ARRAY(a, Name, n + 1);
  to->q = ARENA_ARRAY(a, SymId, 2 * n + 1);
  return to;
}

const LinearForms *forms_new(Arena *a, const Eqns *e) {
  uint32_t n = e->n;
  Expr L = e->m->lagrangian;
  if (!forms_are_needed(e)) return NULL;
  ExprList nodes = expr_topo(e->g, &L, 1);
  if (nodes.n > NODES_MOST) return NULL;
  LinearForms *to = forms_sized(a, e->g, n);
  for (uint32_t i = 0; i < n; i++) to->q[i] = e->m->coords.at[i].q, to->q[n + i] = e->m->coords.at[i].v;
  Forms of_velocities = forms_in(a, e->g, nodes, to->q + n, n), of_coordinates = forms_in(a, e->g, nodes, to->q, n);
  if (!independent_rows(a, &of_velocities, nodes, to)) return NULL;
  name_rows(a, &of_coordinates, to);
  note_forms(a, &of_velocities, to, 0);
  note_forms(a, &of_coordinates, to, 1);
  return derive_mass(e, to) ? to : NULL;
}

/* --- there and back --- */

Expr forms_back(const LinearForms *f, ExprGraph *g, Expr x) {
  Expr *with = ARENA_ARRAY(expr_arena(g), Expr, 2 * (size_t)f->n + 1);
  memcpy(with, f->y, f->n * sizeof *with);
  memcpy(with + f->n, f->rate, f->n * sizeof *with);
  return expr_replace(g, x, f->q, with, 2 * f->n);
}

Verdict forms_prove_zero(const LinearForms *f, ExprGraph *g, Expr x) {
  Verdict v = prove_zero(g, x, NULL);
  if (v != NOT_DECIDED || !f) return v;
  expr_replace_nodes(g, &x, 1, f->node.at, f->is.at, f->node.n, &x);
  return prove_zero(g, x, NULL);
}

void forms_to_coordinates(const LinearForms *f, ExprGraph *g, Expr *c) {
  size_t n = f->n, width = n + 1;
  Arena *a = expr_arena(g);
  Expr *x = ARENA_ARRAY(a, Expr, n * width + 1); /* xi of y as affine functions of q: [i][q_0 .., 1] */
  for (size_t i = 0; i < n; i++) {
    const Expr *linear = c + n + i * n;
    for (size_t k = 0; k < n; k++) x[i * width + k] = combination(g, a, f->n, f->S + k, n, linear, 1);
    Expr of_shift = combination(g, a, f->n, f->shift, 1, linear, 1);
    x[i * width + n] = expr_add(g, c[i], of_shift);
  }
  if (f->exact) forms_solve(a, g, f->n, f->exact, (uint32_t)width, x); /* S has an inverse */
  for (size_t i = 0; i < n; i++)
    for (size_t k = 0; k < width; k++) {
      Expr to = f->exact ? x[i * width + k] : simplify(g, combination(g, a, f->n, f->inverse + i * n, 1, x + k, width));
      if (k == n) c[i] = to;
      else c[n + i * n + k] = to;
    }
}
