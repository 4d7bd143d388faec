/* Null space of rates at random states, less products of known charges; its rows become charges with coefficients in
 * closed form. */
#include "symmetry/polynomial_charges.h"

#include <math.h>

#include "base/dense_matrix.h"
#include "mech/discontinuity.h"
#include "symmetry/momentum_ansatz.h"
#include "symmetry/number_recognition.h"
#include "sym/normal_form.h"
#include "sym/print.h"
#include "sym/prove.h"
#include "sym/simplify.h"

enum { SPARE_ROWS = 12, PRODUCTS_MOST = 1000 };
static const long double REST = 1e-11L; /* as in solve_determining.c */

typedef struct {
  Eqns *e;
  ExprGraph *g;
  Arena *scratch;
  MomentumAnsatz *a;
  Choices choices;
  VEC(PolynomialCharge) known;
  PolynomialCharges *out;
  SearchLimit *limit;
} ChargeSearch;

typedef VEC(uint32_t) Columns;

/* --- the space of all charges --- */

/* Kernel of the rates, or of the values, of some columns at random states; notes a rank that is not certain. */
static DenseRows kernel_of(ChargeSearch *s, uint32_t choice, const Columns *in, int of_values) {
  uint32_t rows = in->n * 3 / 2 + SPARE_ROWS, all = s->a->columns;
  long double *value = ARENA_ARRAY(s->scratch, long double, all + 1),
              *rate = ARENA_ARRAY(s->scratch, long double, all + 1);
  long double *m = ARENA_ARRAY(s->scratch, long double, (size_t)rows * in->n + 1);
  double work = 2.0 * in->n * in->n * rows;
  for (uint32_t i = 0, seed = 1; i < rows; seed++) {
    if (seed > 20 * rows || !search_goes_on(s->limit, work)) {
      s->out->doubtful = 1;
      return (DenseRows){.width = in->n};
    }
    if (!momentum_row(s->a, s->choices.at[choice], seed, value, rate)) continue;
    long double *row = m + (size_t)i++ * in->n, most = 0;
    for (uint32_t j = 0; j < in->n; j++) most = fmaxl(most, fabsl(row[j] = (of_values ? value : rate)[in->at[j]]));
    for (uint32_t j = 0; j < in->n && most > 0; j++) row[j] /= most;
  }
  DenseRows kernel = dense_kernel(s->scratch, rows, in->n, m, REST);
  if (kernel.gap < 1e4L) s->out->doubtful = 1;
  return kernel;
}

/* Columns that are combinations of earlier ones, as y^2/r^2 is of 1 and x^2/r^2, are left out. */
static Columns independent_columns(ChargeSearch *s) {
  Columns last = {0}, left = {0};
  uint32_t n = s->a->columns, rank = 0, k = 0;
  for (uint32_t j = n; j-- > 0;) vec_push(s->scratch, &last, j);
  DenseRows relations = s->a->functions ? kernel_of(s, CHOICE_FIRST, &last, 1) : (DenseRows){0};
  uint32_t *pivot = ARENA_ARRAY(s->scratch, uint32_t, relations.n + 1);
  if (relations.n) {
    relations = dense_orthonormal(s->scratch, &relations, n);
    rank = dense_echelon(relations.n, n, relations.at, 1e-9L, pivot);
  }
  for (uint32_t j = 0; j < n; j++)
    if (k < rank && last.at[pivot[rank - 1 - k]] == j) k++;
    else vec_push(s->scratch, &left, j);
  return left;
}

/* Columns with a nonzero element in some row. */
static Columns columns_reached(ChargeSearch *s, const DenseRows *rows, const Columns *in) {
  Columns out = {0};
  for (uint32_t j = 0; j < in->n; j++)
    for (uint32_t k = 0; k < rows->n; k++)
      if (fabsl(rows->at[(size_t)k * in->n + j]) > REST) {
        vec_push(s->scratch, &out, in->at[j]);
        break;
      }
  return out;
}

/* All charges within the columns, in reduced echelon form; pivot[rows]. */
static DenseRows charges_at(ChargeSearch *s, uint32_t choice, const Columns *in, uint32_t *pivot) {
  DenseRows kernel = kernel_of(s, choice, in, 0);
  if (kernel.at == NULL) return kernel;
  DenseRows rows = dense_orthonormal(s->scratch, &kernel, in->n);
  rows.n = dense_echelon(rows.n, in->n, rows.at, 1e-9L, pivot);
  return rows;
}

/* --- products of known charges --- */

typedef struct {
  uint32_t n;
  uint32_t degree[PRODUCTS_MOST];
  long double *at[PRODUCTS_MOST]; /* [states] */
} Products;

/* Appends the product of product j and a charge with these values, if its degree allows. */
static void multiply(ChargeSearch *s, Products *p, uint32_t j, uint32_t degree, const long double *charge,
                     uint32_t states) {
  if (p->degree[j] + degree > s->a->degree || p->n == PRODUCTS_MOST) return;
  long double *to = p->at[p->n] = ARENA_ARRAY(s->scratch, long double, states);
  p->degree[p->n++] = p->degree[j] + degree;
  for (uint32_t k = 0; k < states; k++) to[k] = p->at[j][k] * charge[k];
}

/* Number of products of n charges of these degrees, up to a total degree; PRODUCTS_MOST where there are more. */
static uint32_t count_products(const ChargeSearch *s) {
  uint32_t of[POLYNOMIAL_DEGREE_MOST + 1] = {1}, sum = 0;
  for (uint32_t i = 0; i < s->known.n; i++)
    for (uint32_t d = s->known.at[i].degree; d <= s->a->degree; d++) of[d] += of[d - s->known.at[i].degree];
  for (uint32_t d = 0; d <= s->a->degree; d++) sum += of[d];
  return sum < PRODUCTS_MOST ? sum : PRODUCTS_MOST;
}

/* Values at the states with these seeds: of all products of known charges, 1 the first. */
static Products *products_at(ChargeSearch *s, uint32_t states, const uint32_t *seed) {
  Products *p = ARENA_NEW(s->scratch, Products);
  uint32_t n = s->known.n;
  Expr *roots = ARENA_ARRAY(s->scratch, Expr, n + 1);
  long double *out = ARENA_ARRAY(s->scratch, long double, n + 1),
              *charge = ARENA_ARRAY(s->scratch, long double, (size_t)states *n + 1);
  for (uint32_t i = 0; i < n; i++) roots[i] = s->known.at[i].charge;
  EvalTape *tape = eval_tape(s->g, roots, n);
  p->at[p->n++] = ARENA_ARRAY(s->scratch, long double, states);
  for (uint32_t k = 0; k < states; k++) {
    momentum_state(s->a, s->choices.at[CHOICE_FIRST], seed[k]);
    eval_run(tape, s->a->state, out);
    p->at[0][k] = 1;
    for (uint32_t i = 0; i < n; i++) charge[(size_t)i * states + k] = out[i];
  }
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t j = 0; j < p->n; j++) multiply(s, p, j, s->known.at[i].degree, charge + (size_t)i * states, states);
  return p;
}

/* Values of the charges in `rows` at random states, whose seeds it notes. 0: too few states have values. */
static int values_of_rows(ChargeSearch *s, const DenseRows *rows, const Columns *in, uint32_t states, uint32_t *seed,
                          long double *to) {
  long double *value = ARENA_ARRAY(s->scratch, long double, 2 * (size_t)s->a->columns), *rate = value + s->a->columns;
  uint32_t k = 0;
  for (uint32_t try = 1; k < states && try < 20 * states; try++) {
    if (!momentum_row(s->a, s->choices.at[CHOICE_FIRST], try, value, rate)) continue;
    for (uint32_t i = 0; i < rows->n; i++) {
      long double sum = 0;
      for (uint32_t j = 0; j < in->n; j++) sum += rows->at[(size_t)i * in->n + j] * value[in->at[j]];
      to[(size_t)i * states + k] = sum;
    }
    seed[k++] = try;
  }
  return k == states;
}

/* Divides the values at each state by their largest, so that no state drowns the others. */
static void level(uint32_t rows, uint32_t states, long double *m) {
  for (size_t k = 0; k < states; k++) {
    long double most = 0;
    for (size_t i = 0; i < rows; i++) most = fmaxl(most, fabsl(m[i * states + k]));
    for (size_t i = 0; i < rows && most > 0; i++) m[i * states + k] /= most;
  }
}

/* Rows that are no combination of products of known charges and of rows before them. */
static Columns new_rows(ChargeSearch *s, const DenseRows *rows, const Columns *in) {
  const long double least = 1e-8L; /* values have 12 digits */
  uint32_t products = count_products(s), all = products + rows->n, states = all + SPARE_ROWS, rank = 0;
  uint32_t *seed = ARENA_ARRAY(s->scratch, uint32_t, states);
  long double *m = ARENA_ARRAY(s->scratch, long double, (size_t)all * states);
  Columns out = {0};
  if (!values_of_rows(s, rows, in, states, seed, m + (size_t)products * states)) {
    s->out->doubtful = 1;
    return out;
  }
  const Products *p = products_at(s, states, seed);
  for (uint32_t i = 0; i < products; i++) memcpy(m + (size_t)i * states, p->at[i], states * sizeof *m);
  level(all, states, m);
  for (uint32_t i = 0; i < all; i++) {
    long double *to = m + (size_t)rank * states;
    memmove(to, m + (size_t)i * states, states * sizeof *m);
    if (!(dense_gram_schmidt(states, to, m, rank) > least)) continue;
    rank++;
    if (i >= products) vec_push(s->scratch, &out, i - products);
  }
  return out;
}

/* --- from numbers to charges --- */

typedef struct {
  const Columns *in;
  DenseRows *rows; /* [choice] */
  uint32_t choices;
} Tables;

static long double element(const Tables *t, uint32_t choice, uint32_t row, uint32_t j) {
  return t->rows[choice].at[(size_t)row * t->in->n + j];
}

static Expr recognise(const ChargeSearch *s, const long double *x) {
  Expr known = recognise_by_two(&s->choices, x, NULL, 0);
  if (!known) known = recognise_linear(&s->choices, x);
  if (!known) known = recognise_monomial(&s->choices, x);
  return known ? known : recognise_quotient(&s->choices, x);
}

/* A coefficient from its values x[choices]: in closed form, or as a multiple of one of the row's coefficients c[n],
 * (4*A - B)*A. */
static Expr coefficient(const ChargeSearch *s, const Tables *t, const long double *x, const Expr *c, uint32_t n) {
  long double *ratio = ARENA_ARRAY(s->scratch, long double, t->choices);
  Expr known = recognise(s, x);
  for (uint32_t i = 0; i < n && !known; i++) {
    if (!c[i] || expr_is_num(s->g, c[i])) continue;
    for (uint32_t k = 0; k < t->choices; k++) ratio[k] = x[k] / choice_value(&s->choices, k, c[i]);
    Expr factor = recognise(s, ratio);
    if (factor) known = expr_mul(s->g, factor, c[i]);
  }
  return known;
}

/* A charge with momenta as symbols: the sum of polynomials times functions. */
typedef struct {
  Expr function, polynomial;
} ChargeTerm;
typedef VEC(ChargeTerm) ChargeTerms;

static void add_term(const ChargeSearch *s, ChargeTerms *to, Expr function, Expr x) {
  for (uint32_t i = 0; i < to->n; i++)
    if (to->at[i].function == function) {
      to->at[i].polynomial = expr_add(s->g, to->at[i].polynomial, x);
      return;
    }
  vec_push(s->scratch, to, ((ChargeTerm){function, x}));
}

/* The row divided by its element `unit`. 0: a coefficient is not recognised. */
static int charge_of_row(const ChargeSearch *s, const Tables *t, uint32_t row, uint32_t unit, ChargeTerms *to) {
  Expr *c = ARENA_ARRAY(s->scratch, Expr, t->in->n);
  long double *x = ARENA_ARRAY(s->scratch, long double, t->choices);
  for (uint32_t j = 0; j < t->in->n; j++) {
    if (element(t, CHOICE_FIRST, row, j) == 0) continue;
    for (uint32_t k = 0; k < t->choices; k++) x[k] = element(t, k, row, j) / element(t, k, row, unit);
    if (!(c[j] = coefficient(s, t, x, c, j))) return 0;
    Expr function, monomial = momentum_product(s->a, t->in->at[j], &function);
    add_term(s, to, function, expr_mul(s->g, c[j], monomial));
  }
  return 1;
}

/* The charge; in_velocities: for readers. */
static Expr sum_of_terms(const ChargeSearch *s, const ChargeTerms *t, int in_velocities) {
  Expr sum = expr_int(s->g, 0);
  for (uint32_t i = 0; i < t->n; i++) {
    Expr x = t->at[i].polynomial;
    if (in_velocities) x = simplify_shallow(s->g, momentum_in_velocities(s->a, x));
    sum = expr_add(s->g, sum, expr_mul(s->g, x, t->at[i].function));
  }
  return sum;
}

static int is_proved(const ChargeSearch *s, Expr Q) {
  NormalLimits limits = prove_limits();
  limits.max_terms *= 10;
  limits.max_work *= 10;
  return prove_zero(s->g, momentum_rate(s->a, Q), &limits) == PROVED_ZERO;
}

/* Lists the charge of a row, with the first unit for which it is recognised and proved; otherwise counts it. */
static void list_charge(ChargeSearch *s, const Tables *t, uint32_t row) {
  enum { UNITS_MOST = 4 };
  long double tried[UNITS_MOST], size;
  uint32_t n = 0;
  for (uint32_t j = 0; j < t->in->n && n < UNITS_MOST; j++) {
    uint32_t k = 0;
    if ((size = fabsl(element(t, CHOICE_FIRST, row, j))) == 0) continue;
    while (k < n && fabsl(tried[k] - size) > 1e-9L * size) k++;
    if (k < n) continue;
    tried[n++] = size;
    ChargeTerms terms = {0};
    if (!charge_of_row(s, t, row, j, &terms) || !is_proved(s, sum_of_terms(s, &terms, 0))) continue;
    PolynomialCharge found = {s->a->degree, sum_of_terms(s, &terms, 1)};
    if (expr_is_zero(s->g, found.charge)) return;
    vec_push(s->e->m->arena, &s->out->all, found);
    vec_push(s->scratch, &s->known, found);
    return;
  }
  s->out->unproved++;
}

/* Tables of all choices, if rows and pivots agree; otherwise 0. */
static int fill_tables(ChargeSearch *s, Tables *t, const uint32_t *pivot) {
  uint32_t n = t->rows[CHOICE_FIRST].n, *other = ARENA_ARRAY(s->scratch, uint32_t, t->in->n + 1);
  for (uint32_t k = 1; k < t->choices; k++) {
    t->rows[k] = charges_at(s, k, t->in, other);
    if (t->rows[k].n != n || memcmp(pivot, other, n * sizeof *pivot) != 0) return 0;
  }
  return 1;
}

/* --- the search --- */

/* "2, times at most one of 1/r" */
static void put_coefficients(const ChargeSearch *s, uint32_t below, StrBuf *out) {
  enum { SHOWN_MOST = 6 };
  const MomentumAnsatz *a = s->a;
  uint32_t most = momentum_ansatz_functions(a, below);
  sb_printf(out, "%u", momentum_ansatz_polynomial(a, below));
  if (most) sb_printf(out, ", times at most %s of", most == 1 ? "one" : arena_printf(s->e->m->arena, "%u", most));
  for (uint32_t i = 0; most && i < a->functions && i < SHOWN_MOST; i++) {
    sb_puts(out, i ? ", " : " ");
    expr_print(s->g, a->factor[a->n + i], PRINT_TEXT, out);
  }
  if (most && a->functions > SHOWN_MOST) sb_printf(out, " and %u more functions in L", a->functions - SHOWN_MOST);
}

/* "charges of degree 2 in the momenta, free of t: coefficients at p^2 are polynomials of the coordinates of degree
 * 2; at p^0 of degree 2, times .." */
static const char *ansatz_text(const ChargeSearch *s) {
  const MomentumAnsatz *a = s->a;
  StrBuf b = strbuf(s->e->m->arena);
  sb_printf(&b,
            "charges of degree %u in the momenta, free of t: coefficients at p^%u are polynomials of the coordinates "
            "of degree ",
            a->degree, a->degree);
  put_coefficients(s, 0, &b);
  for (uint32_t below = a->even ? 2 : 1; below <= a->degree; below += a->even ? 2 : 1) {
    sb_printf(&b, "; at p^%u of degree ", a->degree - below);
    put_coefficients(s, below, &b);
  }
  return sb_text(&b);
}

static void search_degree(ChargeSearch *s, uint32_t degree) {
  Tables t = {.choices = 2 + s->choices.n, .rows = ARENA_ARRAY(s->scratch, DenseRows, 2 + s->choices.n)};
  if (!momentum_ansatz_fill(s->a, degree)) {
    s->out->why_not = "too many unknowns, for the number of coordinates and of functions in L";
    return;
  }
  if (count_products(s) == PRODUCTS_MOST) {
    s->out->why_not = "the charges have more than a thousand products";
    return;
  }
  if (degree > 1) vec_push(s->e->m->arena, &s->out->ansatz, ansatz_text(s));
  Columns all = independent_columns(s);
  uint32_t *pivot = ARENA_ARRAY(s->scratch, uint32_t, all.n + 1);
  DenseRows space = charges_at(s, CHOICE_FIRST, &all, pivot);
  Columns in = columns_reached(s, &space, &all);
  if (s->limit->stopped) s->out->why_not = search_stop_text(s->limit);
  if (!in.n || s->limit->stopped) return;
  t.in = &in;
  t.rows[CHOICE_FIRST] = charges_at(s, CHOICE_FIRST, &in, pivot); /* again, with the digits that fewer columns leave */
  Columns fresh = new_rows(s, &t.rows[CHOICE_FIRST], &in);
  if (fresh.n && !fill_tables(s, &t, pivot)) s->out->unproved += fresh.n;
  else
    for (uint32_t k = 0; k < fresh.n && search_goes_on(s->limit, 0); k++) list_charge(s, &t, fresh.at[k]);
  if (s->limit->stopped) s->out->why_not = search_stop_text(s->limit);
}

static const char *reason_against(const Eqns *e) {
  if (e->constraints.n) return "the model has constraints";
  if (!e->n && !e->m->hamiltonian) return "L is linear in velocities";
  if (e->m->states.n != 2 * e->m->pairs.n) return "the model has states beside its coordinates";
  if (discontinuities_of(e, e->lagrangian).n) return "L is discontinuous";
  return e->singular_mass ? "the mass matrix is singular" : NULL;
}

/* Whether the charge is conserved, and free of t in phase space. */
static int is_constant(const ChargeSearch *s, const FoundSymmetry *f) {
  unsigned kinds = expr_kinds(s->g, f->by.tau) | expr_kinds(s->g, f->is.F);
  for (uint32_t i = 0; i < eqns_coordinates(s->e); i++) kinds |= expr_kinds(s->g, f->by.xi[i]);
  return !f->is.power_unknown && expr_is_zero(s->g, f->is.power) && !(kinds & 1u << SYM_TIME);
}

typedef struct {
  ChargeSearch search;
  const FoundSymmetries *known;
} SearchTask;

static void search_all(Arena *scratch, void *data) {
  SearchTask *task = data;
  ChargeSearch *s = &task->search;
  s->scratch = scratch;
  s->choices = choices_new(scratch, s->e, task->known->attempt, 1);
  s->a = momentum_ansatz_new(scratch, s->e);
  uint32_t of_energy = s->a->quadratic ? 2 : 1; /* y*sqrt(1 + y'^2): the square of the energy is of degree 2 */
  vec_each(const FoundSymmetry, f, task->known->all) {
    PolynomialCharge charge = {expr_is_zero(s->g, f->by.tau) ? 1 : of_energy, f->is.charge};
    if (is_constant(s, f)) vec_push(scratch, &s->known, charge);
  }
  for (uint32_t degree = 1; degree <= s->out->degree && !s->out->why_not; degree++) search_degree(s, degree);
}

PolynomialCharges *polynomial_charges_find(Eqns *e, const FoundSymmetries *known, uint32_t degree, SearchLimit *limit) {
  PolynomialCharges *out = ARENA_NEW(e->m->arena, PolynomialCharges);
  SearchTask task = {{.e = e, .g = e->g, .out = out, .limit = limit}, known};
  *out = (PolynomialCharges){.degree = degree, .why_not = reason_against(e)};
  search_stage(limit, 0.8, "charges of higher degree");
  limit->stopped = limit->no_room = 0;
  if (!out->why_not) arena_with_scratch(expr_arena(e->g), search_all, &task);
  return out;
}
