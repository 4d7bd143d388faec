/* Factors of the ansatz from the text of L, its columns, and their values and rates at random states. */
#include "symmetry/momentum_ansatz.h"

#include <math.h>

#include "sym/diff.h"
#include "sym/prove.h"

enum { COLUMNS_MOST = 500 };

/* --- functions of coordinates in L --- */

typedef struct {
  MomentumAnsatz *a;
  uint32_t *degree;   /* by node: of its polynomials in the coordinates; functions count as constants */
  uint8_t *has;       /* by node: which of HAS_Q, HAS_V it contains */
  uint8_t *is_other;  /* by node: contains coordinates, and is no polynomial of them */
  uint8_t *is_wanted; /* by node: its functions are factors of the ansatz */
  VEC(Expr) found;
} FunctionSearch;

enum { HAS_Q = 1, HAS_V = 2 };

/* HAS_Q, HAS_V or 0 for a symbol. */
static uint8_t role(const MomentumAnsatz *a, SymId s) {
  for (uint32_t i = 0; i < a->n; i++)
    if (s == a->q[i] || s == a->v[i]) return s == a->q[i] ? HAS_Q : HAS_V;
  return 0;
}

/* Roles of all symbols in x. */
static uint8_t roles_in(const MomentumAnsatz *a, Expr x) {
  ExprList all = expr_topo(a->g, &x, 1);
  uint8_t has = 0;
  for (uint32_t i = 0; i < all.n; i++)
    if (expr_op(a->g, all.at[i]) == EX_SYM) has |= role(a, expr_sym_id(a->g, all.at[i]));
  return has;
}

static int has_coordinates(const FunctionSearch *s, Expr x) { return (s->has[x] & HAS_Q) != 0; }

static int is_power(Num k) { return num_is_int(k) && num_sign(k) > 0; }

static void put_roles(FunctionSearch *s, Expr x) {
  ExprGraph *g = s->a->g;
  ExprOp op = expr_op(g, x);
  if (op == EX_SUM || op == EX_PROD)
    for (uint32_t i = 0; i < expr_pairs(g, x, op); i++) s->has[x] |= s->has[expr_pair(g, x, op, i, NULL)];
  else
    for (uint32_t i = 0; i < expr_nargs(g, x); i++) s->has[x] |= s->has[expr_arg(g, x, i)];
}

/* Fills in has, degree and is_other of a node whose arguments are done. */
static void classify(FunctionSearch *s, Expr x) {
  ExprGraph *g = s->a->g;
  ExprOp op = expr_op(g, x);
  if (op == EX_SYM) s->has[x] = role(s->a, expr_sym_id(g, x));
  else put_roles(s, x);
  if (!has_coordinates(s, x)) return;
  if (op == EX_SYM) s->degree[x] = 1;
  else if (op == EX_DEF) {
    s->degree[x] = s->degree[expr_arg(g, x, 0)];
    s->is_other[x] = s->is_other[expr_arg(g, x, 0)];
  } else if (op != EX_SUM && op != EX_PROD) s->is_other[x] = 1;
  else
    for (ExprPair part = {0}; expr_next_pair(g, x, op, &part);) {
      int whole = op == EX_SUM || is_power(part.num);
      uint32_t degree = !whole ? 0 : op == EX_SUM ? s->degree[part.of] : s->degree[part.of] * (uint32_t)part.num.num;
      s->degree[x] = op == EX_PROD ? s->degree[x] + degree : degree > s->degree[x] ? degree : s->degree[x];
      s->is_other[x] |= s->is_other[part.of] || (!whole && has_coordinates(s, part.of));
    }
}

static void add_function(FunctionSearch *s, Expr x) {
  ExprGraph *g = s->a->g;
  static const ExprOp partner[][2] = {{EX_SIN, EX_COS}, {EX_COS, EX_SIN}, {EX_SINH, EX_COSH}, {EX_COSH, EX_SINH}};
  for (uint32_t i = 0; i < s->found.n; i++)
    if (s->found.at[i] == x) return;
  vec_push(s->a->scratch, &s->found, x);
  for (size_t i = 0; i < sizeof partner / sizeof *partner; i++)
    if (expr_op(g, x) == partner[i][0]) add_function(s, expr_fn(g, partner[i][1], expr_arg(g, x, 0)));
}

/* Looks into sums, products and definitions; everything else that is no polynomial is a function. */
static void look_into(FunctionSearch *s, Expr x) {
  ExprGraph *g = s->a->g;
  ExprOp op = expr_op(g, x);
  if (!s->is_other[x]) return;
  if (op == EX_DEF) s->is_wanted[expr_arg(g, x, 0)] = 1;
  else if (op != EX_SUM && op != EX_PROD) {
    if (!(s->has[x] & HAS_V)) add_function(s, x);
  } else
    for (ExprPair part = {0}; expr_next_pair(g, x, op, &part);)
      if (op == EX_SUM || is_power(part.num)) s->is_wanted[part.of] = 1;
      else if (s->has[part.of] == HAS_Q) add_function(s, expr_pow_num(g, part.of, part.num));
}

/* Adds the functions in x; returns the degree of its polynomials. */
static uint32_t find_functions(FunctionSearch *s, Expr x) {
  size_t nodes = (size_t)expr_count(s->a->g) + 1;
  ExprList all = expr_topo(s->a->g, &x, 1);
  s->degree = ARENA_ARRAY(s->a->scratch, uint32_t, nodes);
  s->has = ARENA_ARRAY(s->a->scratch, uint8_t, nodes);
  s->is_other = ARENA_ARRAY(s->a->scratch, uint8_t, nodes);
  s->is_wanted = ARENA_ARRAY(s->a->scratch, uint8_t, nodes);
  for (uint32_t i = 0; i < all.n; i++) classify(s, all.at[i]);
  s->is_wanted[x] = 1;
  for (uint32_t i = all.n; i-- > 0;)
    if (s->is_wanted[all.at[i]]) look_into(s, all.at[i]);
  return s->degree[x];
}

/* --- the factors --- */

static Expr node(const MomentumAnsatz *a, SymId s) { return expr_symbol(a->g, s)->node; }

/* x with each velocity multiplied by a number. */
static Expr with_velocities(const MomentumAnsatz *a, Expr x, int64_t number) {
  Expr *to = ARENA_ARRAY(a->scratch, Expr, a->n + 1);
  for (uint32_t i = 0; i < a->n; i++) to[i] = expr_scale(a->g, num_int(number), node(a, a->v[i]));
  return expr_replace(a->g, x, a->v, to, a->n);
}

/* The degree of L's polynomials, its functions, and how it depends on v. */
static void read_function(MomentumAnsatz *a, FunctionSearch *s, Expr L) {
  Expr *first = ARENA_ARRAY(a->scratch, Expr, 2 * (size_t)a->n), *second = first + a->n;
  a->even = prove_zero(a->g, expr_sub(a->g, L, with_velocities(a, L, -1)), NULL) == PROVED_ZERO;
  a->quadratic = 1;
  a->potential_degree = find_functions(s, with_velocities(a, L, 0));
  expr_gradient(a->g, L, a->v, a->n, first);
  for (uint32_t i = 0; i < a->n; i++) {
    uint32_t degree = a->even ? 0 : 2 * find_functions(s, with_velocities(a, first[i], 0));
    if (degree > a->potential_degree) a->potential_degree = degree;
    expr_gradient(a->g, first[i], a->v, a->n, second);
    for (uint32_t j = 0; j < a->n; j++) {
      uint8_t has = roles_in(a, second[j]);
      a->curved |= (has & HAS_Q) != 0;
      a->quadratic &= !(has & HAS_V);
    }
  }
  if (a->curved) find_functions(s, L);
}

/* Sine and cosine of each coordinate that is declared periodic: the Runge-Lenz vector in polar coordinates contains
 * them, L does not. */
static void add_angles(MomentumAnsatz *a, FunctionSearch *s) {
  a->spare = (uint32_t)a->curved;
  for (uint32_t i = 0; i < a->n; i++) {
    if (!model_is_periodic(a->e->m, a->q[i])) continue;
    add_function(s, expr_fn(a->g, EX_SIN, node(a, a->q[i])));
    a->spare = 2 * (uint32_t)a->curved;
  }
}

/* Tape of functions, their rates, momenta, their rates, and q'. */
static void make_tape(MomentumAnsatz *a) {
  Expr *roots = ARENA_ARRAY(a->scratch, Expr, 2 * (size_t)a->factors),
       *seed = ARENA_ARRAY(a->scratch, Expr, a->symbols);
  uint32_t k = a->functions;
  for (uint32_t i = 0; i < a->n; i++) seed[a->q[i]] = a->rate[i];
  memcpy(roots, a->factor + a->n, k * sizeof *roots);
  expr_tangent(a->g, a->factor + a->n, k, (ExprSeeds){.at = seed, .n = a->symbols}, "'", NULL, roots + k);
  memcpy(roots + 2 * (size_t)k, a->momenta, a->n * sizeof *roots);
  memcpy(roots + 2 * (size_t)k + a->n, a->force, a->n * sizeof *roots);
  memcpy(roots + 2 * (size_t)(k + a->n), a->rate, a->n * sizeof *roots);
  a->tape = eval_tape(a->g, roots, 2 * k + 3 * a->n);
  a->state = ARENA_ARRAY(a->scratch, long double, a->symbols);
  a->out = ARENA_ARRAY(a->scratch, long double, 4 * (size_t)a->factors);
}

/* Momenta are those of L, with symbols of their own. */
static void from_lagrangian(MomentumAnsatz *a) {
  SymId *p = ARENA_ARRAY(a->scratch, SymId, a->n);
  a->q = eqns_symbols(a->e, 0);
  a->v = eqns_symbols(a->e, 1);
  a->p = p;
  for (uint32_t i = 0; i < a->n; i++) {
    a->momenta[i] = eqns_momenta(a->e)[i];
    a->rate[i] = node(a, a->v[i]);
    a->force[i] = a->e->Q ? expr_add(a->g, a->e->dLdq[i], a->e->Q[i]) : a->e->dLdq[i];
    p[i] = expr_declare(a->g, SYM_LOCAL, i, arena_printf(a->e->m->arena, "p_%s", expr_symbol(a->g, a->q[i])->name),
                        SIGN_UNKNOWN);
  }
}

static void from_hamiltonian(MomentumAnsatz *a) {
  const Model *m = a->e->m;
  SymId *q = ARENA_ARRAY(a->scratch, SymId, 2 * (size_t)a->n), *p = q + a->n;
  a->q = q;
  a->v = a->p = p;
  for (uint32_t i = 0; i < a->n; i++) {
    CanonicalPair pair = m->pairs.at[i];
    q[i] = m->states.at[pair.q].z, p[i] = m->states.at[pair.p].z;
    a->momenta[i] = node(a, p[i]);
    a->rate[i] = a->e->flow[pair.q];
    a->force[i] = a->e->flow[pair.p];
  }
}

MomentumAnsatz *momentum_ansatz_new(Arena *scratch, Eqns *e) {
  MomentumAnsatz *a = ARENA_NEW(scratch, MomentumAnsatz);
  int hamiltonian = e->m->hamiltonian;
  *a = (MomentumAnsatz){.e = e, .g = e->g, .scratch = scratch, .n = hamiltonian ? e->m->pairs.n : e->n};
  FunctionSearch s = {.a = a};
  a->momenta = ARENA_ARRAY(scratch, Expr, 3 * (size_t)a->n);
  a->rate = a->momenta + a->n;
  a->force = a->rate + a->n;
  (hamiltonian ? from_hamiltonian : from_lagrangian)(a);
  a->symbols = expr_symbol_count(a->g) + 1;
  read_function(a, &s, hamiltonian ? e->energy : e->lagrangian);
  add_angles(a, &s);
  a->functions = s.found.n;
  a->factors = 2 * a->n + a->functions;
  a->factor = ARENA_ARRAY(scratch, Expr, a->factors);
  for (uint32_t i = 0; i < a->n; i++)
    a->factor[i] = node(a, a->q[i]), a->factor[a->n + a->functions + i] = node(a, a->p[i]);
  if (a->functions) memcpy(a->factor + a->n, s.found.at, a->functions * sizeof *a->factor);
  make_tape(a);
  return a;
}

/* --- the columns --- */

uint32_t momentum_ansatz_polynomial(const MomentumAnsatz *a, uint32_t below) {
  return a->leading + below * a->potential_degree / 2;
}
uint32_t momentum_ansatz_functions(const MomentumAnsatz *a, uint32_t below) {
  return a->functions ? (below + 1) / 2 + a->spare : 0;
}

/* First and next monomial of a degree in n variables: x^2, x*y, y^2. 0: there is none. */
static int first_power(uint8_t *x, uint32_t n, uint32_t degree) {
  memset(x, 0, n);
  if (n) x[0] = (uint8_t)degree;
  return n || !degree;
}
static int next_power(uint8_t *x, uint32_t n) {
  uint32_t i = n - 1;
  if (n < 2) return 0;
  while (i > 0 && !x[i - 1]) i--;
  if (!i) return 0;
  uint8_t last = x[n - 1];
  x[n - 1] = 0;
  x[i - 1]--;
  x[i] = (uint8_t)(last + 1);
  return 1;
}

static int is_pure(const uint8_t *x, uint32_t n) {
  uint32_t variables = 0;
  for (uint32_t i = 0; i < n; i++) variables += x[i] > 0;
  return variables <= 1;
}

/* Appends the functions in x times each monomial of the coordinates times each of the momenta: powers of one
 * momentum (pure), or the others. 0: too many columns. */
static int add_products(MomentumAnsatz *a, uint8_t *x, uint32_t in_q, uint32_t in_p, int pure) {
  uint8_t *p = x + a->n + a->functions;
  first_power(x, a->n, in_q);
  do {
    first_power(p, a->n, in_p);
    do {
      if (is_pure(p, a->n) != pure) continue;
      if (a->columns == COLUMNS_MOST) return 0;
      memcpy(a->power + (size_t)a->columns++ * a->factors, x, a->factors);
    } while (next_power(p, a->n));
  } while (next_power(x, a->n));
  return 1;
}

/* The same for each product of this many functions. Powers of single momenta first: they lead the charges, x*py^2 -
 * y*px*py. */
static int add_functions(MomentumAnsatz *a, uint32_t in_q, uint32_t in_functions, uint32_t in_p) {
  uint8_t *x = ARENA_ARRAY(a->scratch, uint8_t, a->factors), *f = x + a->n;
  if (!first_power(f, a->functions, in_functions)) return 1;
  do
    if (!add_products(a, x, in_q, in_p, 1) || !add_products(a, x, in_q, in_p, 0)) return 0;
  while (next_power(f, a->functions));
  return 1;
}

/* Columns of the highest degree in the momenta first, then those with the fewest functions, then of the lowest
 * degree in the coordinates. */
static int add_columns(MomentumAnsatz *a) {
  a->columns = 0;
  for (uint32_t below = 0; below <= a->degree; below += a->even ? 2 : 1)
    for (uint32_t f = 0; f <= momentum_ansatz_functions(a, below); f++)
      for (uint32_t q = 0; q <= momentum_ansatz_polynomial(a, below); q++)
        if (!add_functions(a, q, f, a->degree - below)) return 0;
  return 1;
}

int momentum_ansatz_fill(MomentumAnsatz *a, uint32_t degree) {
  a->degree = degree;
  a->leading = degree + (uint32_t)a->curved;
  if (!a->power) a->power = ARENA_ARRAY(a->scratch, uint8_t, (size_t)COLUMNS_MOST * a->factors);
  while (!add_columns(a))
    if (a->leading-- == 0) return 0;
  return 1;
}

/* --- values and rates --- */

/* phi_k and its rate from those of the factors. */
static void product_rule(const MomentumAnsatz *a, uint32_t k, const long double *value, const long double *rate,
                         long double *phi, long double *change) {
  const uint8_t *power = a->power + (size_t)k * a->factors;
  *phi = 1;
  *change = 0;
  for (uint32_t i = 0; i < a->factors; i++)
    for (uint8_t j = 0; j < power[i]; j++) {
      *change = *change * value[i] + *phi * rate[i];
      *phi *= value[i];
    }
}

/* Every second state is wide: near the origin sines and cosines are nearly polynomials. */
void momentum_state(const MomentumAnsatz *a, const long double *parameters, uint32_t seed) {
  for (SymId s = 1; s < a->symbols; s++) {
    SymKind kind = expr_symbol(a->g, s)->kind;
    a->state[s] = kind == SYM_PARAM || kind == SYM_CONST ? parameters[s] : sample_symbol(a->g, s, seed);
  }
  for (uint32_t i = 0; i < a->n && seed % 2; i++) a->state[a->q[i]] *= 4;
}

int momentum_row(const MomentumAnsatz *a, const long double *parameters, uint32_t seed, long double *value,
                 long double *rate) {
  uint32_t k = a->functions;
  long double *x = a->out + 2 * (size_t)a->factors, *dx = x + a->factors;
  int finite = 1;
  momentum_state(a, parameters, seed);
  eval_run(a->tape, a->state, a->out);
  for (uint32_t i = 0; i < a->n; i++) {
    x[i] = a->state[a->q[i]], dx[i] = a->out[2 * (k + a->n) + i];
    x[a->n + k + i] = a->out[2 * k + i], dx[a->n + k + i] = a->out[2 * k + a->n + i];
  }
  memcpy(x + a->n, a->out, k * sizeof *x);
  memcpy(dx + a->n, a->out + k, k * sizeof *x);
  for (uint32_t j = 0; j < a->columns; j++) {
    product_rule(a, j, x, dx, &value[j], &rate[j]);
    finite &= isfinite(value[j]) && isfinite(rate[j]);
  }
  return finite;
}

/* --- in symbols --- */

Expr momentum_product(const MomentumAnsatz *a, uint32_t k, Expr *function) {
  Expr monomial = *function = expr_int(a->g, 1);
  for (uint32_t i = 0; i < a->factors; i++) {
    uint8_t power = a->power[(size_t)k * a->factors + i];
    Expr *to = i >= a->n && i < a->n + a->functions ? function : &monomial;
    if (power) *to = expr_mul(a->g, *to, expr_pow_num(a->g, a->factor[i], num_int(power)));
  }
  return monomial;
}

Expr momentum_in_velocities(const MomentumAnsatz *a, Expr Q) { return expr_replace(a->g, Q, a->p, a->momenta, a->n); }

Expr momentum_rate(const MomentumAnsatz *a, Expr Q) {
  Expr *dQdq = ARENA_ARRAY(a->scratch, Expr, 2 * (size_t)a->n), *dQdp = dQdq + a->n, sum = expr_int(a->g, 0);
  expr_gradient(a->g, Q, a->q, a->n, dQdq);
  expr_gradient(a->g, Q, a->p, a->n, dQdp);
  for (uint32_t i = 0; i < a->n; i++) {
    Expr moved = expr_mul(a->g, dQdq[i], a->rate[i]), pushed = expr_mul(a->g, dQdp[i], a->force[i]),
         both = expr_add(a->g, moved, pushed);
    sum = expr_add(a->g, sum, both);
  }
  return momentum_in_velocities(a, sum);
}
