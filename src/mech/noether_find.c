#include "mech/noether_find.h"

#include <math.h>

#include "mech/noether_candidates.h"
#include "mech/noether_name.h"
#include "mech/noether_number.h"
#include "mech/noether_parametric.h"
#include "mech/noether_table.h"
#include "sym/diff.h"
#include "sym/normal.h"
#include "sym/print.h"
#include "sym/simplify.h"

/* A family of generators with one dependence on time. */
typedef struct {
  TimeKind kind;
  Expr rate;            /* w or s; 0 for powers of time */
  long double *rate2;   /* [choice] its square with its sign, where solutions have it */
  TimeList times;       /* of a list */
} Family;

typedef struct {
  Eqns *e;
  ExprGraph *g;
  Arena *scratch;
  Ansatz *ansatz;
  Choices choices;
  SolutionSpace *spaces; /* [choice]; width 0: not asked for yet */
  FoundSymmetries *out;
} Search;

static const SolutionSpace *space_at(Search *s, uint32_t choice) {
  if (s->spaces[choice].space.width == 0) s->spaces[choice] = solution_space(s->ansatz, s->scratch, s->choices.at[choice]);
  return &s->spaces[choice];
}

static uint32_t choice_count(const Search *s) { return 2 + s->choices.n; }

/* --- rates, as expressions --- */

/* A guess at a rate, whose square is a rational multiple of one that occurs. */
typedef struct {
  Expr square, root; /* root^2 = +-square */
} Guess;

typedef VEC(Guess) Guesses;

static int is_constant(const ExprGraph *g, Expr x) { return (expr_kinds(g, x) & ~(1u << SYM_PARAM | 1u << SYM_CONST)) == 0; }

static void add_guess(Search *s, Guesses *all, Expr root) {
  int negative = choice_value(&s->choices, CHOICE_FIRST, root) < 0;
  Expr square = expr_neg(s->g, expr_pow_num(s->g, root, num_int(2)));
  vec_push(s->scratch, all, ((Guess){square, negative ? expr_neg(s->g, root) : root}));
}

/* With velocities coupled by b = beta m and z = x + i y, z'' = kappa z - i beta z': frequencies w with w^2 + beta w + kappa = 0. */
static void add_coupled(Search *s, Guesses *all, Expr beta, Expr kappa) {
  ExprGraph *g = s->g;
  Expr four = expr_scale(g, num_int(4), kappa), inside = simplify(g, expr_sub(g, expr_pow_num(g, beta, num_int(2)), four));
  add_guess(s, all, beta);
  if (expr_is_zero(g, kappa) || choice_value(&s->choices, CHOICE_FIRST, inside) <= 0) return;
  Expr root = expr_sqrt(g, inside), sum = expr_add(g, beta, root), difference = expr_sub(g, root, beta);
  add_guess(s, all, expr_scale(g, num_ratio(1, 2), sum));
  add_guess(s, all, expr_scale(g, num_ratio(1, 2), difference));
  add_guess(s, all, root); /* of what breathes: the sum of both */
}

/* Of each coordinate whose own equation is m q'' = kappa m q + ..., and of pairs with the same kappa whose velocities are coupled. */
static Guesses guesses(Search *s) {
  Eqns *e = s->e;
  ExprGraph *g = s->g;
  Guesses all = {0};
  Expr *kappa = ARENA_ARRAY(s->scratch, Expr, e->n + 1);
  if (e->n && !e->mass_known) eqns_derive_mass(e);
  for (uint32_t i = 0; i < e->n; i++) {
    Expr m = simplify(g, eqns_mass(e, i, i)), k = simplify(g, expr_diff(g, e->dLdq[i], s->ansatz->q[i]));
    if (expr_is_zero(g, m) || !is_constant(g, m) || !is_constant(g, k)) continue;
    kappa[i] = simplify(g, expr_div(g, k, m));
    if (!expr_is_zero(g, k)) {
      int grows = choice_value(&s->choices, CHOICE_FIRST, kappa[i]) > 0;
      Expr root = expr_sqrt(g, grows ? kappa[i] : simplify(g, expr_neg(g, kappa[i])));
      vec_push(s->scratch, &all, ((Guess){kappa[i], root}));
    }
    for (uint32_t j = 0; j < i; j++) {
      Expr one = expr_diff(g, e->dLdq[i], s->ansatz->v[j]), other = expr_diff(g, e->dLdq[j], s->ansatz->v[i]);
      Expr b = simplify(g, expr_sub(g, one, other));
      if (kappa[j] == kappa[i] && is_constant(g, b) && !expr_is_zero(g, b)) add_coupled(s, &all, simplify(g, expr_div(g, b, m)), kappa[i]);
    }
  }
  return all;
}

/* The rate at another choice that lies nearest to x; NAN where that has none. */
static long double nearest_rate(Search *s, uint32_t choice, long double x) {
  const SolutionSpace *space = space_at(s, choice);
  Rates r = space->sure ? space_rates(s->scratch, space) : (Rates){0};
  long double best = NAN;
  for (uint32_t k = 0; k < r.n; k++)
    if (!(fabsl(r.at[k] - x) >= fabsl(best - x))) best = r.at[k];
  return best;
}

static int close_to(long double a, long double b) { return fabsl(a - b) < 1e-8L * fabsl(b); }

/* Finds what is c times a guess, c rational, at both choices. */
static int rate_by_guess(Search *s, const Guesses *all, long double rate2, Family *to) {
  for (uint32_t k = 0; k < all->n; k++) {
    Num c;
    long double ratio = rate2 / choice_value(&s->choices, CHOICE_FIRST, all->at[k].square);
    if (!rational_of(ratio, &c) || num_value(c) <= 0) continue;
    for (uint32_t i = 0; i < choice_count(s); i++) to->rate2[i] = (long double)num_value(c) * choice_value(&s->choices, i, all->at[k].square);
    if (!close_to(nearest_rate(s, CHOICE_SECOND, to->rate2[CHOICE_SECOND]), to->rate2[CHOICE_SECOND])) continue;
    Expr root = expr_sqrt(s->g, expr_num(s->g, c));
    to->rate = expr_mul(s->g, root, all->at[k].root);
    return 1;
  }
  return 0;
}

/* Its square as a product of powers of parameters, or a sum of parameters over one of them. */
static int rate_by_value(Search *s, long double rate2, Family *to) {
  for (uint32_t i = 0; i < choice_count(s); i++) to->rate2[i] = i == CHOICE_SECOND ? NAN : nearest_rate(s, i, rate2);
  const SolutionSpace *second = space_at(s, CHOICE_SECOND);
  Rates r = second->sure ? space_rates(s->scratch, second) : (Rates){0};
  for (uint32_t k = 0; k < r.n; k++) {
    to->rate2[CHOICE_SECOND] = r.at[k];
    Expr square = monomial_of(&s->choices, to->rate2);
    if (!square) square = quotient_of(&s->choices, to->rate2);
    if (!square) continue;
    to->rate = expr_sqrt(s->g, rate2 < 0 ? expr_neg(s->g, square) : square);
    return 1;
  }
  return 0;
}

/* --- tables, as generators --- */

static Table table_at(Search *s, const Family *f, uint32_t choice) {
  uint32_t shown = s->ansatz->shown;
  if (f->kind == TIME_LISTED) {
    int sure;
    Table t = table_listed(s->scratch, s->ansatz, &f->times, s->choices.at[choice], &sure);
    return sure ? t : (Table){0};
  }
  const SolutionSpace *space = space_at(s, choice);
  if (!space->sure) return (Table){0};
  return f->kind == TIME_POWERS ? table_powers(s->scratch, space, shown) : table_periodic(s->scratch, space, shown, f->rate2[choice]);
}

static int same_shape(const Table *a, const Table *b) {
  return a->rows == b->rows && a->shown == b->shown && memcmp(a->pivot, b->pivot, a->rows * sizeof *a->pivot) == 0;
}

/* x is the rational c at both choices. */
static int is_same(const long double *x, Num *c) {
  return fabsl(x[CHOICE_FIRST] - x[CHOICE_SECOND]) < 1e-9L * fabsl(x[CHOICE_FIRST]) && rational_of(x[CHOICE_FIRST], c);
}

/* The tables of a family at all choices, those that are moved only when they are needed; and how rows of them were shortened. */
typedef struct {
  const Family *family;
  Table *at;
  int moved;
  VEC(TableChange) changes;
} Tables;

/* Whether the tables at all choices have one shape. */
static int shapes_agree(Search *s, Tables *t) {
  int agree = 1;
  for (uint32_t i = CHOICE_MOVED; i < choice_count(s) && !t->moved; i++) {
    t->at[i] = table_at(s, t->family, i);
    for (uint32_t k = 0; k < t->changes.n && same_shape(&t->at[0], &t->at[i]); k++) agree = table_change(s->scratch, &t->at[i], t->changes.at[k]) && agree;
  }
  t->moved = 1;
  for (uint32_t i = CHOICE_SECOND; i < choice_count(s); i++) agree = agree && same_shape(&t->at[0], &t->at[i]);
  return agree;
}

/* The coefficient in `row` and `place`; 0: not recognised. */
static Expr coefficient(Search *s, Tables *t, uint32_t row, size_t place, int moved) {
  size_t at = (size_t)row * t->at[0].blocks * t->at[0].shown + place;
  long double *x = ARENA_ARRAY(s->scratch, long double, choice_count(s));
  Expr rate = t->family->rate;
  Num c;
  for (uint32_t i = 0; i < CHOICE_MOVED; i++) x[i] = t->at[i].at[at];
  if (x[CHOICE_FIRST] == 0 && x[CHOICE_SECOND] == 0) return expr_int(s->g, 0);
  if (is_same(x, &c)) return expr_num(s->g, c);
  Expr ratio = rate ? power_of(&s->choices, x, rate) : 0;
  if (!ratio) ratio = ratio_of(&s->choices, x);
  if (!ratio && rate) ratio = ratio_with(&s->choices, x, rate);
  if (ratio || !moved) return ratio;
  for (uint32_t i = CHOICE_MOVED; i < choice_count(s); i++) x[i] = t->at[i].at[at];
  return monomial_of(&s->choices, x);
}

static Expr time_function(Search *s, const Family *f, uint32_t block) {
  ExprGraph *g = s->g;
  Expr t = expr_symbol(g, s->e->m->time)->node;
  if (f->kind == TIME_LISTED) return f->times.f[block];
  if (f->kind == TIME_POWERS) return expr_pow_num(g, t, num_int(block));
  Expr phase = expr_mul(g, f->rate, t);
  if (f->kind == TIME_CIRCULAR) return expr_fn(g, block ? EX_SIN : EX_COS, phase);
  return expr_fn(g, EX_EXP, block ? expr_neg(g, phase) : phase);
}

/* Numbers of a row come to whole numbers without a common factor. */
static void clear_fractions(Search *s, Expr *c, size_t n) {
  Num common = num_int(0);
  for (size_t k = 0; k < n; k++) {
    Num number = num_int(1);
    if (expr_is_zero(s->g, c[k])) continue;
    if (expr_is_num(s->g, c[k])) number = expr_number(s->g, c[k]);
    else expr_pair(s->g, c[k], EX_SUM, 0, &number);
    common = num_is_zero(common) ? num_abs(number) : num_gcd(common, number);
  }
  if (num_is_zero(common) || !num_is_exact(common)) return;
  for (size_t k = 0; k < n; k++) c[k] = expr_scale(s->g, num_div(num_int(1), common), c[k]);
}

/* The lowest whole power of x in the monomials c, where it is negative. */
static int32_t lowest_power(const ExprGraph *g, const Expr *c, size_t n, Expr x) {
  int32_t lowest = 0;
  for (size_t k = 0; k < n; k++) {
    Num number, power;
    Expr term = expr_pair(g, c[k], EX_SUM, 0, &number);
    for (uint32_t i = 0; i < expr_pairs(g, term, EX_PROD); i++)
      if (expr_pair(g, term, EX_PROD, i, &power) == x && num_is_int(power) && power.num < lowest) lowest = (int32_t)power.num;
  }
  return lowest;
}

/* Parameters below fractions come away: m1/m2*x1 + x2 becomes m1*x1 + m2*x2. */
static void clear_parameters(Search *s, Expr *c, size_t n) {
  ExprGraph *g = s->g;
  for (uint32_t p = 0; p < s->choices.n; p++) {
    Expr x = expr_symbol(g, s->choices.param[p])->node;
    int32_t lowest = lowest_power(g, c, n, x);
    if (lowest == 0) continue;
    Expr factor = expr_pow_num(g, x, num_int(-lowest));
    for (size_t k = 0; k < n; k++) c[k] = expr_mul(g, c[k], factor);
  }
}

static Expr phi(Search *s, uint32_t k) { return k ? expr_symbol(s->g, s->ansatz->q[k - 1])->node : expr_int(s->g, 1); }

/* All coefficients of a row; 0 where one is not recognised. */
static int row_coefficients(Search *s, Tables *t, uint32_t row, int moved, Expr *c) {
  for (size_t k = 0; k < (size_t)t->at[0].blocks * t->at[0].shown; k++)
    if (!(c[k] = coefficient(s, t, row, k, moved))) return 0;
  return 1;
}

/* The same for a shorter row, which takes the place of the other when it is recognised. */
static int shorter_coefficients(Search *s, Tables *t, uint32_t row, int moved, Expr *c) {
  uint32_t n = moved || t->moved ? choice_count(s) : CHOICE_MOVED, width = t->at[0].blocks * t->at[0].shown;
  long double *kept = ARENA_ARRAY(s->scratch, long double, (size_t)n * width);
  TableChange changes[CHANGES_MOST];
  for (uint32_t i = 0; i < n; i++) memcpy(kept + (size_t)i * width, t->at[i].at + (size_t)row * width, width * sizeof *kept);
  uint32_t count = table_shorten(s->scratch, &t->at[0], row, changes);
  int found = count > 0;
  for (uint32_t i = CHOICE_SECOND; i < n; i++)
    for (uint32_t k = 0; k < count && found; k++) found = same_shape(&t->at[0], &t->at[i]) && table_change(s->scratch, &t->at[i], changes[k]);
  found = found && row_coefficients(s, t, row, moved, c);
  for (uint32_t i = 0; i < n && !found; i++) memcpy(t->at[i].at + (size_t)row * width, kept + (size_t)i * width, width * sizeof *kept);
  for (uint32_t k = 0; k < count && found; k++) vec_push(s->scratch, &t->changes, changes[k]);
  return found;
}

/* Sums of parameters, when the row is multiplied by `scale`. */
static int linear_coefficients(Search *s, const Tables *t, uint32_t row, Expr scale, Expr *c) {
  uint32_t n = t->at[0].blocks * t->at[0].shown, count = choice_count(s);
  long double *x = ARENA_ARRAY(s->scratch, long double, count);
  for (uint32_t k = 0; k < n; k++) {
    for (uint32_t i = 0; i < count; i++) x[i] = t->at[i].at[(size_t)row * n + k] * choice_value(&s->choices, i, scale);
    c[k] = x[CHOICE_FIRST] == 0 && x[CHOICE_SECOND] == 0 ? expr_int(s->g, 0) : linear_of(&s->choices, x);
    if (!c[k]) return 0;
  }
  return 1;
}

/* The same with each parameter, and each sum of two, as the scale: of two bodies m1/(m1 + m2). */
static int scaled_coefficients(Search *s, const Tables *t, uint32_t row, Expr *c) {
  enum { PARAMETERS_MOST = 12 };
  ExprGraph *g = s->g;
  if (s->choices.n > PARAMETERS_MOST) return 0;
  for (uint32_t i = 0; i < s->choices.n; i++)
    for (uint32_t k = 0; k <= i; k++) {
      Expr one = expr_symbol(g, s->choices.param[i])->node, other = expr_symbol(g, s->choices.param[k])->node;
      if (linear_coefficients(s, t, row, i == k ? one : expr_add(g, one, other), c)) return 1;
    }
  return 0;
}

/* The cheap ways first: what takes tables at all choices comes last. */
static int recognise_row(Search *s, Tables *t, uint32_t row, Expr *c) {
  if (row_coefficients(s, t, row, 0, c) || shorter_coefficients(s, t, row, 0, c)) return 1;
  if (!shapes_agree(s, t)) return 0;
  return row_coefficients(s, t, row, 1, c) || shorter_coefficients(s, t, row, 1, c) || scaled_coefficients(s, t, row, c);
}

/* Generator with these coefficients, which are cleared of fractions. */
static void make_generator(Search *s, const Tables *t, GeneratorRow *to) {
  const Ansatz *a = s->ansatz;
  uint32_t blocks = t->at[0].blocks;
  size_t n = (size_t)blocks * a->shown;
  for (uint32_t m = 0; m < blocks && a->forms; m++) forms_to_coordinates(a->forms, s->g, to->c + (size_t)m * a->shown + 1);
  clear_parameters(s, to->c, n);
  clear_fractions(s, to->c, n);
  to->ansatz = a;
  to->kind = t->family->kind;
  to->blocks = blocks;
  orient(s->e, to);
  Expr *xi = ARENA_ARRAY(s->e->m->arena, Expr, a->n), tau = expr_int(s->g, 0);
  for (uint32_t i = 0; i < a->n; i++) xi[i] = expr_int(s->g, 0);
  for (uint32_t m = 0; m < blocks; m++) {
    Expr of_time = time_function(s, t->family, m);
    const Expr *c = to->c + (size_t)m * a->shown;
    tau = expr_add(s->g, tau, expr_mul(s->g, c[0], of_time));
    for (uint32_t j = 0; j < a->xi.n; j++) {
      if (expr_is_zero(s->g, c[1 + j])) continue;
      Expr term = expr_mul(s->g, c[1 + j], of_time);
      term = expr_mul(s->g, term, phi(s, a->xi.at[j].k));
      xi[a->xi.at[j].i] = expr_add(s->g, xi[a->xi.at[j].i], term);
    }
  }
  to->by = (Generator){xi, tau};
}

/* The constraints of contacts, which are open in states at random, say nothing. */
static int is_proved(const Search *s, const Noether *is) {
  return (is->is == INVARIANT || is->is == INVARIANT_UP_TO_F) && !is->broken && (!is->by_value || s->ansatz->held.n == 0);
}

/* Lists a row whose coefficients are recognised, if it is proved. */
static int add_row(Search *s, const Tables *t, Expr *c) {
  GeneratorRow r = {.c = c};
  make_generator(s, t, &r);
  FoundSymmetry found = {.is = noether_prove(s->e, &r.by), .by = r.by, .rate = t->family->rate};
  if (!is_proved(s, &found.is)) return 0;
  name_symmetry(s->e, &r, &found);
  vec_push(s->e->m->arena, &s->out->all, found);
  return 1;
}

/* Takes the place of rows that were not listed: rows by their dependence on parameters, as far as those listed do not contain them. Returns how
 * many. */
static uint32_t add_parametric(Search *s, Tables *t, DenseRows *listed, uint32_t most) {
  uint32_t width = listed->width, count = 0;
  if (t->family->kind == TIME_LISTED || !shapes_agree(s, t)) return 0;
  ParametricRows rows = parametric_rows(s->scratch, &s->choices, t->at, choice_count(s));
  for (uint32_t k = 0; k < rows.n && count < most; k++) {
    long double *row = listed->at + (size_t)listed->n * width;
    memcpy(row, rows.at[k].value, width * sizeof *row);
    if (dense_reduce(width, row, listed->at, listed->n) < 1e-6L || !add_row(s, t, rows.at[k].c)) continue;
    listed->n++;
    count++;
  }
  return count;
}

static void add_family(Search *s, const Family *f) {
  Tables t = {.family = f, .at = ARENA_ARRAY(s->scratch, Table, choice_count(s))};
  for (uint32_t i = 0; i < CHOICE_MOVED; i++) t.at[i] = table_at(s, f, i);
  uint32_t width = t.at[0].blocks * t.at[0].shown, rows = t.at[0].rows, missing = 0;
  DenseRows listed = {.width = width, .at = ARENA_ARRAY(s->scratch, long double, (size_t)(rows + 1) * width + 1)};
  if (!same_shape(&t.at[0], &t.at[1])) {
    s->out->unproved += rows;
    return;
  }
  for (uint32_t row = 0; row < rows; row++) {
    Expr *c = ARENA_ARRAY(s->scratch, Expr, width + 1);
    if (!recognise_row(s, &t, row, c) || !add_row(s, &t, c)) {
      missing++;
      continue;
    }
    long double *kept = listed.at + (size_t)listed.n * width;
    memcpy(kept, t.at[0].at + (size_t)row * width, width * sizeof *kept);
    if (dense_reduce(width, kept, listed.at, listed.n) > 0) listed.n++;
  }
  if (missing) missing -= add_parametric(s, &t, &listed, missing);
  s->out->unproved += missing;
}

/* --- where coefficients may be any functions of time --- */

static void sort_rates(Rates *r) {
  for (uint32_t i = 1; i < r->n; i++)
    for (uint32_t k = i; k > 0 && fabsl(r->at[k]) < fabsl(r->at[k - 1]); k--) {
      long double swap = r->at[k];
      r->at[k] = r->at[k - 1];
      r->at[k - 1] = swap;
    }
}

static void search_rates(Search *s) {
  Rates rates = space_rates(s->scratch, space_at(s, CHOICE_FIRST));
  if (!rates.n) return;
  sort_rates(&rates);
  Guesses all = guesses(s);
  for (uint32_t k = 0; k < rates.n; k++) {
    Family f = {.kind = rates.at[k] < 0 ? TIME_CIRCULAR : TIME_EXPONENTIAL, .rate2 = ARENA_ARRAY(s->scratch, long double, choice_count(s))};
    if (rate_by_guess(s, &all, rates.at[k], &f) || rate_by_value(s, rates.at[k], &f)) add_family(s, &f);
  }
}

/* --- where L contains t, or is of first order: functions of time from a list --- */

typedef VEC(Expr) Exprs;

static void add_once(Search *s, Exprs *list, Expr x) {
  for (uint32_t k = 0; k < list->n; k++)
    if (list->at[k] == x) return;
  vec_push(s->scratch, list, x);
}

/* w of the sin(w t + ...) and cos(w t + ...) in L, s of its exp(s t + ...). */
static void rates_in_text(Search *s, Exprs *circular, Exprs *exponential) {
  ExprGraph *g = s->g;
  Expr L = s->e->m->lagrangian;
  ExprList all = expr_topo(g, &L, 1);
  for (uint32_t i = 0; i < all.n; i++) {
    ExprOp op = expr_op(g, all.at[i]);
    if (op != EX_SIN && op != EX_COS && op != EX_EXP) continue;
    Expr rate = simplify(g, expr_diff(g, expr_arg(g, all.at[i], 0), s->e->m->time));
    if (expr_is_zero(g, rate) || !is_constant(g, rate)) continue;
    if (choice_value(&s->choices, CHOICE_FIRST, rate) < 0) rate = expr_neg(g, rate);
    add_once(s, op == EX_EXP ? exponential : circular, rate);
  }
}

static void add_circular(Search *s, Exprs *to, Expr w) {
  Expr phase = expr_mul(s->g, w, expr_symbol(s->g, s->e->m->time)->node);
  if (expr_is_zero(s->g, w)) return;
  add_once(s, to, expr_fn(s->g, EX_COS, phase));
  Expr sine = expr_fn(s->g, EX_SIN, phase);
  Num sign;
  expr_pair(s->g, sine, EX_SUM, 0, &sign);
  add_once(s, to, num_sign(sign) < 0 ? expr_neg(s->g, sine) : sine);
}

static void add_exponential(Search *s, Exprs *to, Expr rate) {
  Expr phase = expr_mul(s->g, rate, expr_symbol(s->g, s->e->m->time)->node);
  add_once(s, to, expr_fn(s->g, EX_EXP, phase));
  add_once(s, to, expr_fn(s->g, EX_EXP, expr_neg(s->g, phase)));
}

/* 1, t and the functions of L's own rates for xi and tau; for what F has of coordinates their products, too. An L of first order gets constants only: more
 * would let each charge be multiplied by functions of others. */
static TimeList time_list(Search *s) {
  enum { RATES_MOST = 4 };
  Exprs circular = {0}, exponential = {0}, list = {0};
  ExprGraph *g = s->g;
  Expr t = expr_symbol(g, s->e->m->time)->node;
  rates_in_text(s, &circular, &exponential);
  if (s->e->n) {
    Guesses own = guesses(s);
    for (uint32_t k = 0; k < own.n && circular.n + exponential.n < RATES_MOST; k++)
      add_once(s, choice_value(&s->choices, CHOICE_FIRST, own.at[k].square) < 0 ? &circular : &exponential, own.at[k].root);
  }
  if (circular.n > RATES_MOST) circular.n = RATES_MOST;
  if (exponential.n > RATES_MOST) exponential.n = RATES_MOST;
  vec_push(s->scratch, &list, expr_int(g, 1));
  if (s->e->n) vec_push(s->scratch, &list, t);
  if (s->e->n) vec_push(s->scratch, &list, expr_pow_num(g, t, num_int(2)));
  for (uint32_t k = 0; k < circular.n && s->e->n; k++) add_circular(s, &list, circular.at[k]);
  for (uint32_t k = 0; k < exponential.n && s->e->n; k++) add_exponential(s, &list, exponential.at[k]);
  s->ansatz->far_times = !exponential.n;
  uint32_t own = list.n;
  add_once(s, &list, t);
  add_once(s, &list, expr_pow_num(g, t, num_int(2)));
  for (uint32_t k = 0; k < circular.n; k++) {
    add_circular(s, &list, circular.at[k]);
    for (uint32_t j = 0; j <= k; j++) {
      add_circular(s, &list, expr_add(g, circular.at[k], circular.at[j]));
      add_circular(s, &list, expr_sub(g, circular.at[k], circular.at[j]));
    }
  }
  for (uint32_t k = 0; k < exponential.n; k++) add_exponential(s, &list, exponential.at[k]);
  for (uint32_t k = 2; k < own; k++) add_once(s, &list, expr_mul(g, t, list.at[k]));
  return (TimeList){own, list.n, list.at};
}

static const char *functions_text(Search *s, const TimeList *times, uint32_t from, uint32_t to) {
  StrBuf b = strbuf(s->e->m->arena);
  for (uint32_t k = from; k < to; k++) {
    sb_puts(&b, k > from ? ", " : "");
    expr_print(s->g, times->f[k], PRINT_TEXT, &b);
  }
  return sb_text(&b);
}

static void search_listed(Search *s) {
  Family f = {.kind = TIME_LISTED, .times = time_list(s)};
  Tables t = {.family = &f, .at = ARENA_ARRAY(s->scratch, Table, 1)};
  t.at[0] = table_at(s, &f, CHOICE_FIRST);
  s->out->searched = t.at[0].shown != 0;
  if (s->out->searched) add_family(s, &f);
  s->out->ansatz = arena_printf(s->e->m->arena, "xi affine in the coordinates%s, tau, with coefficients in t: %s; F a polynomial of degree %u in the coordinates, "
                                "with those%s%s, and any function of t alone",
                                ansatz_is_restricted(s->ansatz) ? " (turns and stretches of one vector only)" : "", functions_text(s, &f.times, 0, f.times.n),
                                s->ansatz->degree, f.times.n < f.times.ngauge ? " and " : "", functions_text(s, &f.times, f.times.n, f.times.ngauge));
}

/* --- the search --- */

static const char *ansatz_text(const Search *s) {
  const Ansatz *a = s->ansatz;
  return arena_printf(s->e->m->arena, "xi affine in the coordinates%s, tau, both with any dependence on time; F a polynomial of degree %u in the coordinates",
                      ansatz_is_restricted(a) ? " (turns and stretches of one vector only)" : "", a->degree);
}

static const long double GAP_WEAK = 1e10L; /* what tells solutions from rounding; models have 1e13 and more */

static void search_any(Search *s) {
  const SolutionSpace *space = space_at(s, CHOICE_FIRST);
  s->out->ansatz = ansatz_text(s);
  s->out->searched = space->sure;
  if (!space->sure) return;
  Family powers = {.kind = TIME_POWERS};
  add_family(s, &powers);
  search_rates(s);
  uint32_t dimension = space->space.n ? space->space.n - 1 : 0, known = s->out->all.n + s->out->unproved; /* less F = 1 */
  if (dimension > known) s->out->unproved += dimension - known;
  int weak = space->space.gap < GAP_WEAK;
  if (!weak && !s->out->unproved) return;
  uint32_t more = candidates_try_shifts(s->e, s->out);
  s->out->unproved -= more < s->out->unproved ? more : s->out->unproved;
  if (weak) s->out->note = "rates or couplings lie so close to one another that some may be missing";
}

/* How many solutions at a choice neither oscillate nor grow, but both. */
static uint32_t spirals(Search *s, uint32_t choice) {
  const SolutionSpace *space = space_at(s, choice);
  return space->sure ? space_rates(s->scratch, space).others : 0;
}

static void take_choices(Search *s, uint32_t attempt) {
  s->out->attempt = attempt;
  s->choices = choices_new(s->scratch, s->e, attempt);
  s->spaces = ARENA_ARRAY(s->scratch, SolutionSpace, choice_count(s));
}

/* Values of the parameters; others, where some oscillations have no rate that can be written, as those of a trap that does not hold what is in it. */
static void choose(Search *s) {
  enum { ATTEMPTS = 12 };
  take_choices(s, 0);
  if (s->ansatz->has_time || !s->e->n || !s->choices.n || !(spirals(s, CHOICE_FIRST) + spirals(s, CHOICE_SECOND))) return;
  for (uint32_t attempt = 1; attempt < ATTEMPTS; attempt++) {
    take_choices(s, attempt);
    if (spirals(s, CHOICE_FIRST) + spirals(s, CHOICE_SECOND) == 0) return;
  }
  take_choices(s, 0);
}

static void search_work(Arena *scratch, void *data) {
  Search *s = data;
  s->scratch = scratch;
  s->ansatz = ansatz_new(scratch, s->e);
  choose(s);
  if (s->ansatz->has_time || !s->e->n) search_listed(s);
  else search_any(s);
  if (s->out->searched) return;
  candidates_try(s->e, s->out);
  candidates_try_shifts(s->e, s->out);
  s->out->ansatz = "the energy, momenta of cyclic coordinates, translations, boosts and turns of all of a kind together, shifts along solutions of single coordinates";
  s->out->note = "the linear equations of the search for more could not be solved reliably";
}

const char *noether_note_on_impacts(const Model *m) {
  uint32_t setting = 0;
  if (m->contacts.n) return "impacts and contacts change charges: what is said holds between them";
  for (uint32_t i = 0; i < m->events.n; i++) setting += m->events.at[i].actions.n > 0;
  return setting ? "events change charges: what is said holds between them" : NULL;
}

FoundSymmetries noether_find(Eqns *e) {
  FoundSymmetries out = {0};
  Search s = {.e = e, .g = e->g, .out = &out};
  if (candidates_only(e)) candidates_try(e, &out);
  else normal_with_scratch(e->g, search_work, &s);
  out.galilean = has_galilean_charges(&out);
  if (!out.note) out.note = noether_note_on_impacts(e->m);
  return out;
}
