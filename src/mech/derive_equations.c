/* Derives Eqns: calls lagrange, constrain and first_order, adds the energy, and reads facts for every state
 * (conserved, smooth, separable, ...) off the graph. */
#include "mech/derive_equations.h"

#include <math.h>
#include <string.h>

#include "base/method_table.h"
#include "mech/constrain.h"
#include "mech/velocity_degree.h"
#include "mech/discontinuity.h"
#include "mech/first_order.h"
#include "mech/idle_time.h"
#include "mech/kepler_part.h"
#include "mech/lagrange.h"
#include "mech/mass_definiteness.h"
#include "mech/constraint_regularise.h"
#include "sym/diff.h"
#include "sym/simplify.h"
#include "sym/sum_nest.h"

typedef VEC(Expr) ExprVec;

static unsigned bit(SymKind kind) { return 1u << kind; }

static int contains_kind(const Eqns *e, Expr x, SymKind kind) { return (expr_kinds(e->g, x) & bit(kind)) != 0; }

/* Past this many coordinates the energy's lets are not expanded: along a chain they would grow with the square of
 * its length. */
enum { EXPAND_MAX_COORDS = 32 };

/* Past this many coordinates energy and momenta stay as differentiated: nobody reads them, and short forms of sums over
 * all coordinates cost more than the derivation. */
enum { SHORTEN_MAX_COORDS = 64 };

static Expr shorten(const Eqns *e, Expr x) {
  return e->mass_known && e->n <= SHORTEN_MAX_COORDS ? simplify(e->g, x) : x;
}

/* Momenta of L as written, without the regularising terms of Model.regularising. */
static const Expr *plain_momenta(const Eqns *e) {
  const Model *m = e->m;
  if (!m->regularising) return e->p;
  Expr *p = ARENA_ARRAY(m->arena, Expr, e->n + 1);
  expr_gradient(e->g, m->lagrangian, eqns_symbols(e, 1), e->n, p);
  return p;
}

/* p q' - less*x for a part x of L, by Euler's theorem from the velocity degrees of its terms; 0 if a term is not
 * homogeneous. */
static Expr moving_energy(const Eqns *e, Expr x, int less) {
  ExprGraph *g = e->g;
  uint32_t n = expr_pairs(g, x, EX_SUM);
  uint8_t *degree = ARENA_ARRAY(e->m->arena, uint8_t, n);
  VEC(Expr) terms = {0};
  velocity_degrees(g, e->m->arena, x, degree);
  for (uint32_t i = 0; i < n; i++) {
    Num c;
    Expr t = expr_pair(g, x, EX_SUM, i, &c);
    if (degree[i] == NO_DEGREE) return 0;
    Num times = num_mul(c, num_int(degree[i] - less));
    Expr part = expr_scale(g, times, t);
    vec_push(e->m->arena, &terms, part);
  }
  return expr_add_n(g, terms.at, terms.n);
}

/* Sum of p q' over all coordinates. */
static Expr momenta_times_velocities(const Eqns *e, const Expr *p) {
  ExprGraph *g = e->g;
  Expr *terms = ARENA_ARRAY(e->m->arena, Expr, e->n + 1);
  for (uint32_t i = 0; i < e->n; i++) terms[i] = expr_mul(g, p[i], expr_symbol(g, e->m->coords.at[i].v)->node);
  Expr sum = expr_add_n(g, terms, e->n);
  arena_recycle(e->m->arena, terms, (e->n + 1) * sizeof *terms);
  return sum;
}

/* Momenta to show, E = p q' - L, and |p q'| + |L|. The part of L without velocities enters E as written: k/2*(r -
 * l)^2 has more correct digits than its expansion. */
static void derive_energy(Eqns *e) {
  ExprGraph *g = e->g;
  Arena *arena = e->m->arena;
  Expr *momenta = ARENA_ARRAY(arena, Expr, e->n + 1);
  const Expr *p = plain_momenta(e);
  for (uint32_t i = 0; i < e->n; i++) momenta[i] = shorten(e, p[i]);
  e->momenta = momenta;
  Expr l = e->lagrangian;
  VEC(Expr) still = {0};
  for (ExprPair t = {0}; expr_next_pair(g, l, EX_SUM, &t);) {
    if (contains_kind(e, t.of, SYM_VEL)) continue;
    Expr part = expr_scale(g, t.num, t.of);
    vec_push(arena, &still, part);
  }
  Expr l0 = expr_add_n(g, still.at, still.n);
  Expr l_moving = expr_sub(g, l, l0);
  /* With rotations p q' is long in the quaternions; degrees keep omega. */
  int has_sums = e->n > SHORTEN_MAX_COORDS && e->m->sums.n;
  Expr moving = e->m->regularising || has_sums ? moving_energy(e, l_moving, 1) : 0;
  Expr pv = moving && has_sums ? moving_energy(e, l_moving, 0) : momenta_times_velocities(e, p);
  if (!moving) {
    Expr whole = expr_sub(g, pv, l_moving);
    moving = shorten(e, whole);
  }
  e->energy = expr_sub(g, moving, l0);
  /* Lets are expanded: l + y with y = -l*cos(th) hides a cancellation. */
  Expr open = e->n <= EXPAND_MAX_COORDS ? expr_expand_defs(g, e->energy) : e->energy;
  e->energy_stable = e->n <= SHORTEN_MAX_COORDS ? simplify_stable(g, open) : open;
  Expr simple_pv = shorten(e, pv);
  Expr size_pv = expr_fn(g, EX_ABS, simple_pv), size_l = expr_fn(g, EX_ABS, l);
  e->energy_scale = expr_add(g, size_pv, size_l);
}

static unsigned kinds_in(const Eqns *e, const Expr *roots, uint32_t n) {
  unsigned kinds = 0;
  for (uint32_t i = 0; i < n; i++) kinds |= expr_kinds(e->g, roots[i]);
  return kinds;
}

/* Adds the formulas of the inputs that occur to the roots. A table depends on time, and the third derivative of its
 * spline jumps at each row: not autonomous, not smooth. */
static void add_input_formulas(Eqns *e, ExprVec *roots) {
  const Model *m = e->m;
  ExprList l = expr_topo(e->g, roots->at, roots->n);
  for (uint32_t i = 0; i < l.n; i++) {
    if (expr_op(e->g, l.at[i]) != EX_SYM || expr_sym_of(e->g, l.at[i])->kind != SYM_INPUT) continue;
    const Input *in = &m->inputs.at[expr_sym_of(e->g, l.at[i])->index];
    if (in->table) e->autonomous = e->smooth = 0;
    if (!in->value) continue;
    e->autonomous &= !contains_kind(e, in->value, SYM_TIME);
    vec_push(m->arena, roots, in->value);
  }
}

/* Whether the dissipation takes energy at every velocity: nonnegative terms, quadratic, 0 at rest, so that the power
 * q' dR/dq' = 2 R is nonnegative. Not so (q' - c)^2, a belt that drives. */
static int dissipation_is_passive(const Eqns *e) {
  const Model *m = e->m;
  ExprGraph *g = e->g;
  Expr R = m->dissipation;
  for (uint32_t i = 0; i < expr_pairs(g, R, EX_SUM); i++) {
    Num c;
    ExprSign sign = expr_sign(g, expr_pair(g, R, EX_SUM, i, &c));
    if (num_sign(c) <= 0 || !sign_is_nonnegative(sign)) return 0;
  }
  if (!expr_is_zero(g, eqns_at_rest(e, R))) return 0;
  ExprPartials d = expr_gradient_sparse(g, R, SYM_VEL, e->n);
  for (uint32_t i = 0; i < d.n; i++) {
    ExprPartials dd = expr_gradient_sparse(g, d.at[i].e, SYM_VEL, e->n);
    for (uint32_t k = 0; k < dd.n; k++)
      if (contains_kind(e, dd.at[k].e, SYM_VEL)) return 0;
  }
  return !(expr_kinds(g, R) & (bit(SYM_TIME) | bit(SYM_STATE)));
}

/* Whether nothing but forces can raise the energy while inputs stay as they are; it may be conserved. */
static int raised_by_forces_alone(const Eqns *e, unsigned lagrangian) {
  const Model *m = e->m;
  if (!m->lagrangian || e->first.n || e->energy_jumps || lagrangian & (bit(SYM_TIME) | bit(SYM_STATE))) return 0;
  return constraints_do_no_work(e) && (!m->dissipation || dissipation_is_passive(e));
}

int is_no_coordinate(const Symbol *s, const void *states) {
  return s->kind == SYM_STATE && !((const State *)states)[s->index].coordinate;
}

/* Kinds of symbols in L; coordinates of a model of first order do not count as states. */
static unsigned kinds_of_lagrangian(const Eqns *e) {
  const Model *m = e->m;
  unsigned kinds = kinds_in(e, &e->lagrangian, 1);
  return e->first.n && !expr_contains(e->g, e->lagrangian, is_no_coordinate, m->states.at) ? kinds & ~bit(SYM_STATE)
                                                                                           : kinds;
}

typedef struct {
  uint32_t from, to; /* states [from, to) */
  int with_time;
} StateRange;

static int is_in_range(const Symbol *s, const void *data) {
  const StateRange *r = data;
  if (s->kind == SYM_STATE) return s->index >= r->from && s->index < r->to;
  return r->with_time && (s->kind == SYM_TIME || s->kind == SYM_INPUT);
}

/* Whether no rate of the states [from, to) contains what the range has. */
static int rates_lack(const Eqns *e, uint32_t from, uint32_t to, StateRange what) {
  for (uint32_t i = from; i < to; i++)
    if (expr_contains(e->g, e->flow[i], is_in_range, &what)) return 0;
  return 1;
}

/* H = T(p) + V(q, t): rates of q do not contain q or t. With forces of q and t, rates of p do not contain p: a
 * splitting method can take both. */
static void find_splitting(Eqns *e) {
  uint32_t n = e->m->pairs.n;
  e->sum_hamiltonian = n && e->m->states.n == 2 * n && rates_lack(e, 0, n, (StateRange){0, n, 1});
  e->separable |= e->sum_hamiltonian && rates_lack(e, n, 2 * n, (StateRange){n, 2 * n, 0});
}

/* Facts that hold at every state, read off the graph. */
static void classify(Eqns *e) {
  const Model *m = e->m;
  ExprVec entries = {0}, roots = {0};
  const Entries *H = e->mass_known ? &e->mass : &e->system.H, *C = &e->system.C;
  for (uint32_t i = 0; i < H->n; i++) vec_push(m->arena, &entries, H->at[i].e);
  for (uint32_t i = 0; i < C->n && !e->mass_known; i++) vec_push(m->arena, &entries, C->at[i].e);
  for (uint32_t i = 0; i < e->n; i++) vec_push(m->arena, &roots, e->f[i]);
  for (uint32_t i = 0; i < m->states.n; i++) vec_push(m->arena, &roots, e->flow[i]);
  const Constraints *k = &e->constraints;
  for (uint32_t i = 0; i < k->n; i++) vec_push(m->arena, &roots, k->demand[i]);
  unsigned mass = kinds_in(e, entries.at, entries.n), rest = kinds_in(e, roots.at, roots.n);
  e->constant_mass = !(mass & (bit(SYM_COORD) | bit(SYM_VEL) | bit(SYM_TIME) | bit(SYM_STATE)));
  e->separable = e->n && e->constant_mass && !m->states.n && !(rest & bit(SYM_VEL)) && !k->n;
  find_splitting(e);
  e->autonomous = e->timeless = !((mass | rest) & bit(SYM_TIME));
  int inputs = (rest & bit(SYM_INPUT)) != 0 && m->inputs.n > model_contact_inputs(m); /* those of contacts do no work */
  e->smooth = 1;
  if (inputs) add_input_formulas(e, &roots);
  ExprList l = expr_topo_with_bodies(e->g, roots.at, roots.n);
  for (uint32_t i = 0; i < l.n; i++) {
    ExprOp op = expr_op(e->g, l.at[i]);
    /* where the angle jumps by 2 pi */
    int cut = op == EX_ATAN2 && expr_sign(e->g, expr_arg(e->g, l.at[i], 1)) != SIGN_POSITIVE;
    e->smooth &=
        op != EX_SELECT && op != EX_ABS && op != EX_SIGN && op != EX_FLOOR && op != EX_MIN && op != EX_MAX && !cut;
  }
  unsigned lagrangian = kinds_of_lagrangian(e);
  e->energy_jumps = e->energy && discontinuities_of(e, e->energy).n > 0;
  e->loses_energy = raised_by_forces_alone(e, lagrangian);
}

/* Refuses numbers in the equations that overflow a double or lost their digits, by differentiation or cancellation. */
int eqns_check_numbers(const Eqns *e) {
  const Model *m = e->m;
  VEC(Expr) roots = {0};
  for (uint32_t i = 0; i < e->n; i++) vec_push(m->arena, &roots, e->f[i]);
  for (uint32_t i = 0; i < e->mass.n; i++) vec_push(m->arena, &roots, e->mass.at[i].e);
  for (uint32_t i = 0; i < e->system.H.n; i++) vec_push(m->arena, &roots, e->system.H.at[i].e);
  for (uint32_t i = 0; i < e->system.C.n; i++) vec_push(m->arena, &roots, e->system.C.at[i].e);
  for (uint32_t i = 0; i < m->states.n; i++) vec_push(m->arena, &roots, e->flow[i]);
  for (uint32_t i = 0; i < e->noutputs; i++) vec_push(m->arena, &roots, e->outputs[i]);
  vec_push(m->arena, &roots, e->energy_scale);
  ExprList l = expr_topo(e->g, roots.at, roots.n);
  arena_release(m->arena, roots.at, roots.cap * sizeof *roots.at);
  Span span = m->lagrangian_span.end ? m->lagrangian_span : m->span;
  for (uint32_t i = 0; i < l.n; i++) {
    if (!expr_is_num(e->g, l.at[i])) continue;
    Num n = expr_number(e->g, l.at[i]);
    if (!isfinite(num_value(n))) {
      return diag_error(m->diags, span, "a number in the equations of motion is not finite"
                        HELP "numbers reach up to 1.8e308; measure in other units");
    }
    if (num_is_imprecise(n)) {
      diag_error(m->diags, span, "rounding leaves fewer than six digits of a number in the equations of motion");
      diag_help(m->diags, "numbers are exact as fractions of whole numbers up to 9.2e18, others have 16 digits; write "
                          "the result of such a "
                          "difference as one number");
      return 0;
    }
  }
  expr_list_free(e->g, l);
  return 1;
}

/* Needs of methods that model/method.c could not know yet: smooth equations, a Kepler part. */
static int check_method(const Eqns *e) {
  const Scene *sc = &e->m->scene;
  const MethodInfo *method = sc->method ? method_find(sc->method, strlen(sc->method)) : NULL;
  KeplerPart kepler;
  const char *why = method && method->flags & METHOD_KEPLER ? kepler_part(e, &kepler) : NULL;
  if (why)
    return diag_error(e->m->diags, sc->method_span,
                      "the method `%s` needs bodies with constant masses and terms -k/r, and %s" HELP
                      "`verlet6` and `dop853` do without",
                      method->name, why);
  if (!method || !(method->flags & METHOD_TAYLOR) || e->smooth) return 1;
  return diag_error(e->m->diags, sc->method_span,
                    "the method `%s` needs a model without if, abs, sign, min, max, atan2 and tables" HELP
                    "`dop853` does not",
                    method->name);
}

Eqns *eqns_derive(const Model *m) {
  Eqns *e = ARENA_NEW(m->arena, Eqns);
  e->m = m;
  e->g = m->g;
  e->n = m->coords.n;
  e->lagrangian = m->lagrangian;
  Expr *flow = ARENA_ARRAY(m->arena, Expr, m->states.n + 1);
  for (uint32_t i = 0; i < m->states.n; i++) flow[i] = m->states.at[i].flow;
  e->flow = flow;
  if (e->n) {
    lagrange_momenta_and_forces(e);
    if (!constrain(e) || !lagrange_check_mass(e)) return NULL;
    drop_idle_time(e);
    derive_energy(e);
  }
  if (m->first_order && !first_order_derive(e, m)) return NULL;
  if (!e->n) drop_idle_time(e);
  classify(e);
  sizes_find(e);
  return check_method(e) ? e : NULL;
}

Eqns *eqns_derive_regularised(const Eqns *singular) {
  Model *m = ARENA_NEW(singular->m->arena, Model);
  *m = *singular->m;
  Expr lent = regularising_term(singular);
  m->regularising = m->regularising ? expr_add(singular->g, m->regularising, lent) : lent;
  return eqns_derive(m);
}
