/* Verdict on one generator: delta L term by term, a gauge function F for the rest, then the charge and its balance.
 * Zero is proved where possible; with constraints it may be seen at random states on every factor of them. */
#include "symmetry/noether_theorem_impl.h"

#include <math.h>

#include "mech/constrain.h"
#include "mech/discontinuity.h"
#include "mech/motion_proof.h"
#include "mech/states.h"
#include "sym/prove.h"
#include "sym/diff.h"
#include "sym/integrate.h"
#include "sym/simplify.h"
#include "sym/sum_nest.h"

/* Past this number of coordinates charges are not simplified, like the energy (mech/derive_equations.c). */
enum { SHORTEN_MAX = 64 };

static Expr *no_seed(const ProofWork *w) { return ARENA_ARRAY(w->m->arena, Expr, w->symbols); }

/* Sum of a_i b_i. */
static Expr dot(const ProofWork *w, const Expr *a, const Expr *b, uint32_t n) {
  Expr *terms = ARENA_ARRAY(w->m->arena, Expr, n + 1);
  for (uint32_t i = 0; i < n; i++) terms[i] = expr_mul(w->g, a[i], b[i]);
  return expr_add_n(w->g, terms, n);
}

static Expr tangent(const ProofWork *w, Expr x, const Expr *seed, const char *suffix) {
  Expr out;
  expr_tangent(w->g, &x, 1, (ExprSeeds){.at = seed, .n = w->symbols}, suffix, NULL, &out);
  return out;
}

Expr noether_total(const ProofWork *w, Expr x) { return tangent(w, x, w->along, "'"); }

static void fill_seeds(ProofWork *w) {
  w->along = no_seed(w);
  w->along[w->m->time] = expr_int(w->g, 1);
  for (uint32_t i = 0; i < w->n; i++) w->along[w->q[i]] = proof_node(w, w->v[i]);
  expr_tangent(w->g, w->xi, w->n, (ExprSeeds){.at = w->along, .n = w->symbols}, "'", NULL, w->Dxi);
  w->Dtau = noether_total(w, w->tau);
  w->moving = no_seed(w);
  w->moving[w->m->time] = w->tau;
  for (uint32_t i = 0; i < w->n; i++) {
    Expr slower = expr_mul(w->g, proof_node(w, w->v[i]), w->Dtau);
    w->moving[w->q[i]] = w->xi[i];
    w->moving[w->v[i]] = expr_sub(w->g, w->Dxi[i], slower);
  }
}

static ProofWork begin(const Eqns *e, const Generator *by) {
  Arena *a = e->m->arena;
  ProofWork w = {.e = e, .m = e->m, .g = e->g, .n = eqns_coordinates(e), .symbols = expr_symbol_count(e->g) + 1};
  Expr zero = expr_int(w.g, 0), *xi = ARENA_ARRAY(a, Expr, w.n + 1);
  w.q = eqns_symbols(e, 0);
  w.v = eqns_symbols(e, 1);
  w.Dxi = ARENA_ARRAY(a, Expr, w.n + 1);
  w.L = e->lagrangian;
  w.p = eqns_momenta(e);
  w.xi = xi;
  w.tau = by->tau ? by->tau : zero;
  for (uint32_t i = 0; i < w.n; i++) xi[i] = by->xi && by->xi[i] ? by->xi[i] : zero;
  fill_seeds(&w);
  return w;
}

Expr noether_shorten(const ProofWork *w, Expr x) { return w->n <= SHORTEN_MAX ? simplify(w->g, x) : x; }

/* x or its short form, whichever is shorter to read. */
static Expr readable(const ProofWork *w, Expr x) {
  uint32_t distinct;
  Expr other = noether_shorten(w, x);
  return expr_tree_size(w->g, other, &distinct) < expr_tree_size(w->g, x, &distinct) ? other : x;
}

/* --- delta L --- */

static Verdict is_zero(const ProofWork *w, Expr x) { return prove_zero(w->g, x, NULL); }

/* Change of x under the generator, to first order. */
static Expr moved_by(const ProofWork *w, Expr x) { return tangent(w, x, w->moving, "_delta"); }

/* delta of a term of L. */
static Expr delta(const ProofWork *w, Expr term) {
  Expr moved = moved_by(w, term), stretched = expr_mul(w->g, term, w->Dtau);
  return expr_add(w->g, moved, stretched);
}

Expr noether_at_rest(const ProofWork *w, Expr x) {
  if (!(expr_kinds(w->g, x) & (1u << SYM_VEL | 1u << SYM_RATE))) return x;
  Expr *zero = ARENA_ARRAY(w->m->arena, Expr, w->n + 1);
  for (uint32_t i = 0; i < w->n; i++) zero[i] = expr_int(w->g, 0);
  return expr_replace(w->g, x, w->v, zero, w->n);
}

/* The change of the symbol `from` as that of `to`: in its coordinate and velocity. */
static Expr change_as_of(const Eqns *e, Expr change, SymId from, SymId to) {
  const Symbol *x = expr_symbol(e->g, from), *y = expr_symbol(e->g, to);
  SymId at[2] = {from, from};
  Expr by[2] = {y->node, y->node};
  if ((x->kind == SYM_COORD || x->kind == SYM_VEL) && y->kind == x->kind) {
    const Coord *c = &e->m->coords.at[x->index], *d = &e->m->coords.at[y->index];
    at[0] = c->q, at[1] = c->v;
    by[0] = expr_symbol(e->g, d->q)->node, by[1] = expr_symbol(e->g, d->v)->node;
  }
  return from == to ? change : expr_replace(e->g, change, at, by, 2);
}

int turns_move_alike(const Eqns *e, Expr nest, const Expr *seed, uint32_t symbols) {
  ExprGraph *g = e->g;
  const SumNest *s = expr_sum_nest(g, nest);
  if (s->near) return 0; /* the range of the test would move */
  for (uint32_t k = 0; k < s->nreads; k++) {
    const NestRead *read = &s->reads[k];
    int64_t lo, hi, step = subscript_step(&read->at);
    if (expr_symbol(g, read->symbol)->kind == SYM_LOCAL || read->symbol >= symbols) return 0;
    if (!loop_extent(&s->range, &read->at, &lo, &hi)) continue;
    for (int64_t x = lo; x <= hi; x += step ? step : 1) {
      Expr arg = expr_sum_arg(g, nest, (uint32_t)x), of = seed[read->symbol];
      SymId from = expr_op(g, arg) == EX_SYM ? expr_sym_id(g, arg) : symbols;
      if (from >= symbols || !seed[from] != !of) return 0;
      if (of && change_as_of(e, seed[from], from, read->symbol) != of) return 0;
    }
  }
  return 1;
}

/* Whether a quantified sum is invariant by itself: the body of one turn is. */
static int sum_is_invariant(const ProofWork *w, Expr term) {
  if (expr_op(w->g, term) != EX_CELL || !turns_move_alike(w->e, expr_cell_nest(w->g, term), w->moving, w->symbols))
    return 0;
  const SumNest *s = expr_sum_nest(w->g, expr_cell_nest(w->g, term));
  for (uint32_t k = 0; k < s->nshares; k++) {
    Expr change = delta(w, s->shares[k].value);
    if (is_zero(w, change) != PROVED_ZERO) return 0;
  }
  return 1;
}

/* delta L without the terms of L that are invariant by themselves: the pairs of N bodies are judged one by one. Each
 * remainder is in its short form. */
static Expr delta_lagrangian(const ProofWork *w) {
  ExprGraph *g = w->g;
  VEC(Expr) left = {0};
  for (ExprPair term = {0}; expr_next_pair(g, w->L, EX_SUM, &term);) {
    if (sum_is_invariant(w, term.of)) continue;
    Expr change = delta(w, term.of);
    if (is_zero(w, change) == PROVED_ZERO) continue;
    change = expr_scale(g, term.num, noether_shorten(w, change));
    vec_push(w->m->arena, &left, change);
  }
  return expr_add_n(g, left.at, left.n);
}

/* --- zero on the constraints --- */

/* Whether base^power is a factor that contains coordinates and may be 0. */
static int may_vanish(const ProofWork *w, Expr base, Num power) {
  ExprSign sign = expr_sign(w->g, base);
  return num_sign(power) > 0 && !sign_is_strict(sign) && (expr_kinds(w->g, base) & 1u << SYM_COORD);
}

/* The first holonomic constraint, contacts left out, that is a product of factors two of which may be 0: random
 * states may miss one of these parts. NULL: there is none. */
static const Constraint *constraint_with_factors(const ProofWork *w) {
  const Constraints *k = &w->e->constraints;
  for (uint32_t i = 0; i < k->nholonomic; i++) {
    Num c, power;
    Expr product = expr_pair(w->g, k->c[i], EX_SUM, 0, &c);
    uint32_t count = 0;
    if (contact_of_constraint(w->m, k->of[i]) || expr_pairs(w->g, k->c[i], EX_SUM) > 1) continue;
    for (uint32_t f = 0; f < expr_pairs(w->g, product, EX_PROD); f++) {
      Expr base = expr_pair(w->g, product, EX_PROD, f, &power);
      count += (uint32_t)may_vanish(w, base, power);
    }
    if (count > 1) return k->of[i];
  }
  return NULL;
}

/* Whether x is zero where the constraints hold, those of contacts excepted. */
static Verdict zero_on_constraints(ProofWork *w, Expr x) {
  Verdict v = is_zero(w, x);
  if (v == PROVED_ZERO || !proof_is_constrained(w) || !motion_vanishes(w->e, x)) return v;
  w->product = constraint_with_factors(w);
  w->by_value = 1;
  return PROVED_ZERO;
}

/* --- F --- */

/* An F(q, t) whose total derivative removes what it can from dL = a.q' + b + terms of higher order in q'. */
static Expr find_gauge(const ProofWork *w, Expr dL) {
  Expr *a = ARENA_ARRAY(w->m->arena, Expr, w->n + 1), b = noether_at_rest(w, dL);
  expr_gradient(w->g, dL, w->v, w->n, a);
  for (uint32_t i = 0; i < w->n; i++) a[i] = noether_at_rest(w, a[i]);
  Expr F = expr_potential(w->g, a, w->q, w->n, 0), drift = expr_diff(w->g, F, w->m->time);
  Expr left = expr_sub(w->g, b, drift);
  left = simplify(w->g, left);
  Expr rest = expr_integrate(w->g, left, w->m->time, 1u << SYM_COORD | 1u << SYM_STATE | 1u << SYM_INPUT);
  return expr_add(w->g, F, rest);
}

/* Whether dL is a total derivative: its Euler-Lagrange expressions vanish. PROVED_NONZERO: one does not. */
static Verdict is_total_derivative(const ProofWork *w, Expr dL) {
  Verdict all = PROVED_ZERO;
  for (uint32_t i = 0; i < w->n; i++) {
    Expr a = expr_diff(w->g, dL, w->v[i]);
    for (uint32_t k = 0; k <= i; k++) {
      Expr twice = expr_diff(w->g, a, w->v[k]);
      Verdict v = is_zero(w, twice);
      if (v == PROVED_NONZERO) return v;
      if (v == NOT_DECIDED) all = v;
    }
    Expr change = noether_total(w, a), force = expr_diff(w->g, dL, w->q[i]), left = expr_sub(w->g, force, change);
    Verdict v = is_zero(w, left);
    if (v == PROVED_NONZERO) return v;
    if (v == NOT_DECIDED) all = v;
  }
  return all;
}

/* Whether x depends on time alone: then it is the derivative of its integral, which need not have a closed form. */
static int is_of_time(const ProofWork *w, Expr x) {
  return !expr_is_zero(w->g, x) &&
         !(expr_kinds(w->g, x) & ~(1u << SYM_TIME | 1u << SYM_INPUT | 1u << SYM_PARAM | 1u << SYM_CONST));
}

/* A first guess of F by Cartan's formula: theta.xi + phi tau, where theta q' + phi are the terms of L of degree 1
 * and 0 in velocities. If these terms are a gauge, the rest of delta L is small or 0, and their primitive need not
 * be found. */
static Expr contraction(const ProofWork *w, int with_phi) {
  Expr *theta = ARENA_ARRAY(w->m->arena, Expr, w->n + 1);
  for (uint32_t i = 0; i < w->n; i++) theta[i] = noether_at_rest(w, w->p[i]);
  Expr F = dot(w, theta, w->xi, w->n), phi = with_phi ? noether_at_rest(w, w->L) : expr_int(w->g, 0);
  return expr_add(w->g, F, expr_mul(w->g, phi, w->tau));
}

/* An F that begins with contraction(); 0: none is proved. */
static Expr contracted_gauge(ProofWork *w, Expr dL) {
  ExprGraph *g = w->g;
  for (int with_phi = 0; with_phi < 2; with_phi++) {
    Expr first = contraction(w, with_phi), taken = noether_total(w, first), rest = simplify(g, expr_sub(g, dL, taken));
    if (expr_is_zero(g, first)) continue;
    Expr more = find_gauge(w, rest), F = readable(w, expr_add(g, first, more)), DF = noether_total(w, F);
    if (zero_on_constraints(w, expr_sub(g, dL, DF)) == PROVED_ZERO) return F;
  }
  return 0;
}

/* Verdict, F and remainder: delta L = 0, else an F from its coefficients, else from Cartan's formula. */
static void judge(ProofWork *w, Noether *to) {
  ExprGraph *g = w->g;
  Expr zero = expr_int(g, 0), dL = delta_lagrangian(w);
  *to = (Noether){.F = zero, .remainder = zero, .by_constraints = zero};
  if (zero_on_constraints(w, dL) == PROVED_ZERO) return;
  dL = readable(w, dL);
  Expr F = simplify(g, find_gauge(w, dL)), DF = noether_total(w, F), left = expr_sub(g, dL, DF);
  if (!expr_is_zero(g, F) && zero_on_constraints(w, left) == PROVED_ZERO) {
    to->is = INVARIANT_UP_TO_F;
    to->F = F;
    return;
  }
  left = simplify(g, left);
  if (is_of_time(w, left)) {
    *to = (Noether){.is = INVARIANT_UP_TO_F, .F = F, .remainder = left, .over_time = left, .by_constraints = zero};
    return;
  }
  Expr other = contracted_gauge(w, dL);
  if (other) {
    *to = (Noether){.is = INVARIANT_UP_TO_F, .F = other, .remainder = zero, .by_constraints = zero};
    return;
  }
  uint32_t distinct;
  int better = expr_tree_size(g, left, &distinct) < expr_tree_size(g, dL, &distinct);
  to->F = better ? F : zero;
  to->remainder = better ? left : dL;
  to->is = is_total_derivative(w, dL) == PROVED_NONZERO ? NOT_INVARIANT : INVARIANCE_NOT_DECIDED;
}

/* --- the charge and its balance --- */

/* p q' - L. */
static Expr bare_energy(const Eqns *e) { return e->potential ? expr_sub(e->g, e->energy, e->potential) : e->energy; }

/* p.xi - E tau - F. */
static Expr charge_of(const ProofWork *w, Expr F) {
  ExprGraph *g = w->g;
  Expr px = dot(w, w->p, w->xi, w->n), minus_F = expr_neg(g, F);
  Expr et = expr_mul(g, bare_energy(w->e), w->tau), minus_et = expr_neg(g, et);
  Expr front = expr_add(g, px, minus_F);
  front = noether_shorten(w, front);
  return expr_add(g, front, minus_et);
}

/* x with contact c closed; unchanged where c is NULL. */
static Expr while_closed(const ProofWork *w, const Contact *c, Expr x) {
  Expr one = expr_int(w->g, 1);
  return c ? expr_replace(w->g, x, &c->closed, &one, 1) : x;
}

static Expr size_of_sum(ExprGraph *g, const ExprMap *size, Expr x) {
  uint32_t n = expr_pairs(g, x, EX_SUM);
  Expr *terms = ARENA_ARRAY(expr_arena(g), Expr, n);
  for (uint32_t i = 0; i < n; i++) {
    Num c;
    Expr term = expr_pair(g, x, EX_SUM, i, &c);
    terms[i] = expr_scale(g, num_sign(c) < 0 ? num_neg(c) : c, expr_map_get(size, term));
  }
  return expr_add_n(g, terms, n);
}

static Expr size_of_product(ExprGraph *g, const ExprMap *size, Expr x) {
  uint32_t n = expr_pairs(g, x, EX_PROD);
  Expr *factors = ARENA_ARRAY(expr_arena(g), Expr, n);
  for (uint32_t i = 0; i < n; i++) {
    Num power;
    Expr base = expr_pair(g, x, EX_PROD, i, &power);
    int whole = num_is_int(power) && num_sign(power) > 0;
    if (whole) base = expr_map_get(size, base);
    Expr factor = expr_pow_num(g, base, power);
    factors[i] = whole ? factor : expr_fn(g, EX_ABS, factor);
  }
  return expr_mul_n(g, factors, n);
}

/* Sum of the absolute values of the terms of x, as if products of sums were multiplied out: |a|*(|x| + |z|) for a*(x
 * - z). Denominators, roots and functions count as single terms; definitions are expanded. size: magnitudes known
 * from earlier calls. */
static Expr term_magnitude(ExprGraph *g, ExprMap *size, Expr x) {
  ExprList l = expr_topo_until(g, &x, 1, size);
  for (uint32_t i = 0; i < l.n; i++) {
    Expr e = l.at[i];
    ExprOp op = expr_op(g, e);
    if (expr_map_get(size, e)) continue;
    expr_map_set(size, e, op == EX_SUM ? size_of_sum(g, size, e)
                        : op == EX_PROD ? size_of_product(g, size, e)
                        : op == EX_DEF ? expr_map_get(size, expr_arg(g, e, 0))
                        : expr_fn(g, EX_ABS, e));
  }
  expr_list_free(g, l);
  return expr_map_get(size, x);
}

static Expr scale_of(const ProofWork *w, Expr F) {
  ExprGraph *g = w->g;
  const Expr *p = w->e->n ? w->e->momenta : w->p;
  ExprMap size = expr_map(w->m->arena);
  Expr *terms = ARENA_ARRAY(w->m->arena, Expr, w->n + 2), size_tau = term_magnitude(g, &size, w->tau);
  for (uint32_t i = 0; i < w->n; i++) {
    Expr size_p = term_magnitude(g, &size, p[i]), size_xi = term_magnitude(g, &size, w->xi[i]);
    terms[i] = expr_mul(g, size_p, size_xi);
  }
  terms[w->n] = expr_mul(g, w->e->energy_scale, size_tau);
  terms[w->n + 1] = term_magnitude(g, &size, F);
  return expr_add_n(g, terms, w->n + 2);
}

/* Change of a constraint under the generator: inputs move with the time. */
static Expr constraint_moved(const ProofWork *w, Expr c) {
  Expr *seed = ARENA_ARRAY(w->m->arena, Expr, w->symbols);
  memcpy(seed, w->moving, w->symbols * sizeof *seed);
  vec_each(const Input, in, w->m->inputs)
    if (in->rate) seed[in->sym] = expr_mul(w->g, w->tau, proof_node(w, w->m->inputs.at[in->rate].sym));
  return tangent(w, c, seed, "_delta");
}

/* lambda^T (A xi + b tau), contacts closed. For a holonomic constraint: the change of c under the generator; for r =
 * A q' + b: A xi + b tau. */
static Expr power_of_constraints(ProofWork *w, Noether *to) {
  ExprGraph *g = w->g;
  const Constraints *k = &w->e->constraints;
  Expr sum = expr_int(g, 0), *seed = no_seed(w), moved;
  for (uint32_t j = 0; j < w->n; j++) seed[w->v[j]] = w->xi[j];
  for (uint32_t i = 0; i < k->n; i++) {
    const Contact *contact = contact_of_constraint(w->m, k->of[i]);
    if (i < k->nholonomic) {
      moved = constraint_moved(w, while_closed(w, contact, k->c[i]));
    } else {
      Expr b = noether_at_rest(w, k->r[i]), part = expr_mul(g, b, w->tau);
      Expr slide = tangent(w, k->r[i], seed, "_delta");
      moved = expr_add(g, slide, part);
    }
    if (zero_on_constraints(w, moved) == PROVED_ZERO) continue;
    moved = noether_shorten(w, moved);
    if (i < k->nholonomic && !to->broken && !contact) {
      to->broken = i + 1;
      to->breaks = moved;
    }
    Expr force = expr_mul(g, proof_node(w, k->of[i]->multiplier), moved);
    /* a tangent has it in its row */
    if (contact && !contact->is_tangent) force = expr_mul(g, proof_node(w, contact->closed), force);
    sum = expr_add(g, sum, force);
  }
  return sum;
}

static int is_other_state(const Eqns *e, uint32_t i) { return !e->m->states.at[i].coordinate; }

/* tau dL/dt from everything in L besides q and t: states with their flow, inputs with the derivative of their
 * formula. */
static Expr power_of_change(const ProofWork *w, Noether *to) {
  ExprGraph *g = w->g;
  const Model *m = w->m;
  Expr *seed = no_seed(w);
  if (expr_is_zero(g, w->tau)) return expr_int(g, 0);
  for (uint32_t i = 0; i < m->states.n; i++)
    if (is_other_state(w->e, i)) seed[m->states.at[i].z] = w->e->flow[i];
  vec_each(const Input, in, m->inputs) {
    if (!(expr_kinds(g, w->L) & 1u << SYM_INPUT) || !expr_contains_sym(g, w->L, in->sym) ||
        model_is_contact_switch(m, in->sym))
      continue;
    if (in->rate) seed[in->sym] = proof_node(w, m->inputs.at[in->rate].sym);
    else if (in->value) seed[in->sym] = expr_diff(g, in->value, m->time);
    to->by_formulas |= !in->rate && in->value;
    to->power_unknown |= !in->rate && !in->value;
  }
  Expr rate = tangent(w, w->L, seed, "_drift");
  return expr_mul(g, w->tau, rate);
}

/* sum Q_i (xi_i - q_i' tau) */
static Expr power_of_forces(const ProofWork *w) {
  ExprGraph *g = w->g;
  Expr *along = ARENA_ARRAY(w->m->arena, Expr, w->n + 1);
  if (!w->e->Q) return expr_int(g, 0);
  for (uint32_t i = 0; i < w->n; i++) {
    Expr carried = expr_mul(g, proof_node(w, w->v[i]), w->tau);
    along[i] = expr_sub(g, w->xi[i], carried);
  }
  return dot(w, w->e->Q, along, w->n);
}

/* Whether the generator moves the surfaces where L jumps. */
static int moves_jumps(const ProofWork *w) {
  const long double still = 1e-7L; /* states lie on a jump to 1e-19 of their size, slopes are known to 1e-6 */
  ExprJumps all = discontinuities_of(w->e, w->L);
  vec_each(const ExprJump, jump, all) {
    Expr change = moved_by(w, jump->side);
    long double bound, value = value_with_bound(w->g, change, jump->symbols, NULL, &bound);
    if (!(fabsl(value) <= still * fabsl(jump->slope))) return 1;
  }
  return 0;
}

static int is_shift_of_time(const ProofWork *w) {
  for (uint32_t i = 0; i < w->n; i++)
    if (!expr_is_zero(w->g, w->xi[i])) return 0;
  return expr_is_num(w->g, w->tau) && num_is_one(num_neg(expr_number(w->g, w->tau)));
}

/* Judges dQ/dt along motions. Where a potential of forces and explicit time completes the energy, it does. */
static void judge_drift(const ProofWork *w, Noether *to, Expr power) {
  if (to->power_unknown) return;
  to->drift = motion_verdict(w->e, to->power);
  int exists = 0;
  if (to->drift != PROVED_ZERO && is_shift_of_time(w)) to->potential = noether_potential(w, power, &exists);
  if (to->potential) to->drift = PROVED_ZERO;
  if (exists) to->drift = NOT_DECIDED;
  to->open_integral = exists;
  if (to->drift == PROVED_ZERO) to->power = to->by_constraints = expr_int(w->g, 0);
}

/* Balance of the charge, and the part of the constraints in it. */
static void put_power(ProofWork *w, Noether *to, Expr remainder) {
  ExprGraph *g = w->g;
  to->by_constraints = power_of_constraints(w, to);
  Expr forces = power_of_forces(w), change = power_of_change(w, to);
  Expr parts[3] = {forces, change, remainder}, rest = noether_shorten(w, expr_add_n(g, parts, 3));
  to->power = expr_add(g, states_substitute(w->e, rest), to->by_constraints);
  judge_drift(w, to, expr_add(g, rest, to->by_constraints));
  to->by_value = w->by_value;
  to->product = w->product;
  if (w->product && (to->is == INVARIANT || to->is == INVARIANT_UP_TO_F)) to->is = INVARIANCE_NOT_DECIDED;
}

int noether_moves_jumps(const Eqns *e, const Generator *by) {
  if (discontinuities_of(e, e->lagrangian).n == 0) return 0;
  ProofWork w = begin(e, by);
  return moves_jumps(&w);
}

Noether noether_prove(const Eqns *e, const Generator *by) {
  ProofWork w = begin(e, by);
  Noether out;
  judge(&w, &out);
  put_power(&w, &out, out.remainder);
  Expr whole = out.potential ? expr_sub(w.g, out.F, out.potential) : out.F;
  out.charge = charge_of(&w, whole);
  out.scale = scale_of(&w, whole);
  out.jumps = discontinuities_of(e, out.charge).n > 0 || moves_jumps(&w);
  return out;
}

Noether noether_energy(const Eqns *e) {
  ProofWork w = begin(e, &(Generator){.tau = expr_int(e->g, -1)});
  Expr zero = expr_int(w.g, 0), drift = expr_diff(w.g, w.L, w.m->time);
  Noether out = {.is = INVARIANT, .F = zero, .remainder = zero, .charge = e->energy, .scale = e->energy_scale};
  put_power(&w, &out, expr_neg(w.g, drift));
  out.jumps = e->energy_jumps;
  return out;
}

int noether_forces_are_potential(const Eqns *e) {
  const unsigned varies = 1u << SYM_TIME | 1u << SYM_STATE | 1u << SYM_COORD | 1u << SYM_VEL;
  const Model *m = e->m;
  unsigned kinds = 0;
  int exists;
  for (uint32_t i = 0; i < m->forces.n; i++) kinds |= expr_kinds(e->g, m->forces.at[i].f);
  if (!(kinds & varies)) return 1;
  ProofWork w = begin(e, &(Generator){.tau = expr_int(e->g, -1)});
  Expr power = power_of_forces(&w);
  for (uint32_t i = 0; i < w.n && m->dissipation; i++) {
    Expr drag = expr_diff(w.g, m->dissipation, w.v[i]), part = expr_mul(w.g, drag, proof_node(&w, w.v[i]));
    power = expr_add(w.g, power, part);
  }
  power = noether_shorten(&w, power);
  return motion_verdict(e, power) == PROVED_ZERO || noether_potential(&w, power, &exists) || exists;
}
