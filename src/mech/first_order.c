/* Two-form and right-hand side by differentiation, split into blocks of coupled coordinates; each block solved on
 * the graph by mech/antisymmetric_solve.h, as a doubled antisymmetric system where forces make it unsymmetric. */
#include "mech/first_order.h"

#include <math.h>

#include "base/dense_matrix.h"
#include "base/union_find.h"
#include "mech/lagrange.h"
#include "mech/antisymmetric_solve.h"
#include "sym/diff.h"
#include "sym/expr_eval.h"
#include "sym/prove.h"
#include "sym/simplify.h"

/* State of the derivation. */
typedef struct {
  Eqns *e;
  const Model *m;
  ExprGraph *g;
  Arena *arena;
  FirstOrder *to;
  uint32_t n;
  uint32_t *place; /* [states] number of the coordinate plus 1; 0 for other states */
  Expr *still;     /* by symbol: substitution of 0 for all rates */
  Expr *rhs;
  VEC(Expr) divisors;
} FirstOrderBuilder;

static unsigned bit(SymKind kind) { return 1u << kind; }
static int has_rates(const FirstOrderBuilder *w, Expr x) { return (expr_kinds(w->g, x) & bit(SYM_RATE)) != 0; }
static const State *state_of(const FirstOrderBuilder *w, uint32_t i) { return &w->m->states.at[w->to->at[i]]; }
static Expr at_rest(const FirstOrderBuilder *w, Expr x) {
  return expr_substitute(w->g, x, w->still, expr_symbol_count(w->g) + 1, "_at_rest");
}

static void find_coordinates(FirstOrderBuilder *w) {
  uint32_t *at = ARENA_ARRAY(w->arena, uint32_t, w->m->states.n + 1);
  w->place = ARENA_ARRAY(w->arena, uint32_t, w->m->states.n + 1);
  w->still = ARENA_ARRAY(w->arena, Expr, expr_symbol_count(w->g) + 1);
  for (uint32_t i = 0; i < w->m->states.n; i++) {
    w->still[w->m->states.at[i].rate] = expr_int(w->g, 0);
    if (!w->m->states.at[i].coordinate) continue;
    at[w->n++] = i;
    w->place[i] = w->n;
  }
  w->to->n = w->n;
  w->to->at = at;
}

/* --- the parts of L --- */

/* theta, H, and the right-hand side dH/dq_i + dtheta_i/dt, still without forces. */
static int differentiate(FirstOrderBuilder *w) {
  SymId *rates = ARENA_ARRAY(w->arena, SymId, w->n), *q = ARENA_ARRAY(w->arena, SymId, w->n);
  Expr *theta = ARENA_ARRAY(w->arena, Expr, w->n), *dH = ARENA_ARRAY(w->arena, Expr, w->n);
  for (uint32_t i = 0; i < w->n; i++) {
    rates[i] = state_of(w, i)->rate;
    q[i] = state_of(w, i)->z;
  }
  expr_gradient(w->g, w->m->lagrangian, rates, w->n, theta);
  Expr still = at_rest(w, w->m->lagrangian), H = expr_neg(w->g, still);
  expr_gradient(w->g, H, q, w->n, dH);
  w->to->theta = theta;
  w->rhs = dH;
  w->e->energy = H;
  for (uint32_t i = 0; i < w->n; i++) {
    if (expr_kinds(w->g, theta[i]) & bit(SYM_INPUT)) {
      return diag_error(w->m->diags, w->m->lagrangian_span,
                        "the momentum of `%s` depends on an input, whose derivative would be needed" HELP
                        "write the input as a formula of t inside L instead",
                        state_of(w, i)->name);
    }
    Expr changing = expr_diff(w->g, theta[i], w->m->time);
    w->rhs[i] = expr_add(w->g, w->rhs[i], changing);
  }
  return 1;
}

static void add_part(FirstOrderBuilder *w, uint32_t row, uint32_t col, Expr e) {
  vec_push(w->arena, &w->to->form, ((MassEntry){row, col, e}));
}

/* omega_ij += dtheta_j/dq_i - dtheta_i/dq_j. */
static int add_form(FirstOrderBuilder *w) {
  for (uint32_t i = 0; i < w->n; i++) {
    ExprPartials d = expr_gradient_sparse(w->g, w->to->theta[i], SYM_STATE, w->m->states.n);
    for (uint32_t k = 0; k < d.n; k++) {
      uint32_t j = w->place[d.at[k].index];
      if (!j) {
        diag_error(w->m->diags, w->m->lagrangian_span, "the momentum of `%s` depends on the state `%s`",
                   state_of(w, i)->name, w->m->states.at[d.at[k].index].name);
        diag_help(w->m->diags,
                  "where L is linear in the velocities, a state may stand in terms without velocities only");
        return 0;
      }
      Expr minus = expr_neg(w->g, d.at[k].e);
      add_part(w, i, j - 1, minus);
      add_part(w, j - 1, i, d.at[k].e);
    }
  }
  return 1;
}

/* Velocities of a model that gives its Hamiltonian, q' = dH/dp - Q_p, in place of q' in Q: so Q may depend on them
 * in any way. */
static void replace_velocities(FirstOrderBuilder *w, Expr *Q) {
  const Model *m = w->m;
  SymId *rates = ARENA_ARRAY(w->arena, SymId, m->pairs.n + 1);
  Expr *velocity = ARENA_ARRAY(w->arena, Expr, m->pairs.n + 1);
  for (uint32_t k = 0; k < m->pairs.n; k++) {
    uint32_t p = m->pairs.at[k].p;
    Expr Qp = Q[w->place[p] - 1], rate = expr_sub(w->g, expr_diff(w->g, w->e->energy, m->states.at[p].z), Qp);
    rates[k] = m->states.at[m->pairs.at[k].q].rate;
    velocity[k] = has_rates(w, Qp) ? expr_symbol(w->g, rates[k])->node : simplify(w->g, rate);
  }
  for (uint32_t i = 0; i < w->n; i++)
    if (has_rates(w, Q[i])) Q[i] = expr_replace(w->g, Q[i], rates, velocity, m->pairs.n);
  w->to->velocity = velocity;
}

/* Whether x jumps with a velocity, as dry friction does: its derivatives do not show that. */
static int jumps_with_rates(const FirstOrderBuilder *w, Expr x) {
  ExprList nodes = expr_topo(w->g, &x, 1);
  for (uint32_t i = 0; i < nodes.n; i++) {
    ExprOp op = expr_op(w->g, nodes.at[i]);
    if ((op == EX_SIGN || op == EX_FLOOR || expr_is_bool(w->g, nodes.at[i])) && has_rates(w, nodes.at[i])) return 1;
  }
  return 0;
}

static int report_force(const FirstOrderBuilder *w, uint32_t i) {
  diag_error(w->m->diags, w->m->lagrangian_span,
             "the force on `%s` is not linear in the velocities, and L has no inertia", state_of(w, i)->name);
  diag_help(
      w->m->diags,
      "the velocities follow from a linear system where L is linear in them: write forces of q and t, or linear in q'");
  return 0;
}

/* Adds dQ/dq' to the form, and subtracts Q at q' = 0 from the right-hand side. */
static int add_forces(FirstOrderBuilder *w) {
  Expr *of = generalised_forces(w->m, SYM_STATE, SYM_RATE, w->m->states.n), *Q = ARENA_ARRAY(w->arena, Expr, w->n);
  w->e->Q = Q;
  for (uint32_t i = 0; i < w->n; i++) Q[i] = of[w->to->at[i]];
  if (w->m->hamiltonian) replace_velocities(w, Q);
  for (uint32_t i = 0; i < w->n; i++) {
    if (jumps_with_rates(w, Q[i])) return report_force(w, i);
    ExprPartials d =
        has_rates(w, Q[i]) ? expr_gradient_sparse(w->g, Q[i], SYM_RATE, w->m->states.n) : (ExprPartials){0};
    for (uint32_t k = 0; k < d.n; k++) {
      Expr part = simplify(w->g, d.at[k].e);
      if (has_rates(w, part)) return report_force(w, i);
      add_part(w, i, w->place[d.at[k].index] - 1, part);
      w->to->closed = 0;
    }
    Expr still = at_rest(w, Q[i]);
    w->rhs[i] = expr_sub(w->g, w->rhs[i], still);
  }
  return 1;
}

/* Sums the parts of each entry of the form; nonzero entries, in short forms. */
static void collect(FirstOrderBuilder *w) {
  unsigned kinds = 0;
  entries_collect(w->g, &w->to->form, simplify);
  for (uint32_t k = 0; k < w->to->form.n; k++) kinds |= expr_kinds(w->g, w->to->form.at[k].e);
  w->to->constant = !(kinds & (bit(SYM_STATE) | bit(SYM_TIME)));
}

/* --- blocks --- */

/* Numbers the connected components of the form by their first coordinates (union-find). Returns their number. */
static uint32_t find_blocks(FirstOrderBuilder *w) {
  uint32_t *up = union_find_new(w->arena, w->n), *block = ARENA_ARRAY(w->arena, uint32_t, w->n), count = 0;
  for (uint32_t k = 0; k < w->to->form.n; k++) union_find_join(up, w->to->form.at[k].row, w->to->form.at[k].col);
  for (uint32_t i = 0; i < w->n; i++) block[i] = union_find_root(up, i) == i ? count++ : block[union_find_root(up, i)];
  w->to->block = block;
  return count;
}

/* One block: its coordinates at[n], and A q' = b with A[n * n] from the form, b[n] from the right-hand side. */
typedef struct {
  uint32_t n, *at;
  Expr *A, *b;
} Block;

typedef VEC(Block) Blocks;

static Blocks split(FirstOrderBuilder *w) {
  Blocks blocks = {0};
  uint32_t count = find_blocks(w), *inside = ARENA_ARRAY(w->arena, uint32_t, w->n);
  for (uint32_t i = 0; i < count; i++) vec_push(w->arena, &blocks, ((Block){0}));
  for (uint32_t i = 0; i < w->n; i++) inside[i] = blocks.at[w->to->block[i]].n++;
  for (uint32_t i = 0; i < count; i++) {
    Block *b = &blocks.at[i];
    b->at = ARENA_ARRAY(w->arena, uint32_t, b->n);
    b->A = ARENA_ARRAY(w->arena, Expr, (size_t)b->n * b->n);
    b->b = ARENA_ARRAY(w->arena, Expr, b->n);
    for (size_t k = 0; k < (size_t)b->n * b->n; k++) b->A[k] = expr_int(w->g, 0);
  }
  for (uint32_t i = 0; i < w->n; i++) {
    Block *b = &blocks.at[w->to->block[i]];
    b->at[inside[i]] = i;
    b->b[inside[i]] = w->rhs[i];
  }
  for (uint32_t k = 0; k < w->to->form.n; k++) {
    const MassEntry *x = &w->to->form.at[k];
    Block *b = &blocks.at[w->to->block[x->row]];
    b->A[(size_t)inside[x->row] * b->n + inside[x->col]] = x->e;
  }
  return blocks;
}

static const char *names_of(const FirstOrderBuilder *w, const Block *b, const uint32_t *which, uint32_t n) {
  enum { FEW = 12 };
  StrBuf names = strbuf(w->arena);
  for (uint32_t i = 0; i < n && i < FEW; i++)
    sb_printf(&names, "%s`%s`", i ? ", " : "", state_of(w, b->at[which ? which[i] : i])->name);
  if (n > FEW) sb_puts(&names, " and others");
  return sb_text(&names);
}

/* A determinant that is not identically zero vanishes at a random state with probability zero. 1: regular, or
 * defined at no state tried. */
static int is_regular(const FirstOrderBuilder *w, const Block *b) {
  enum { TRIES = 8 };
  long double *symbols = ARENA_ARRAY(w->arena, long double, expr_symbol_count(w->g) + 1);
  long double *a = ARENA_ARRAY(w->arena, long double, (size_t)b->n * b->n);
  int judged = 0;
  for (uint32_t seed = 1; seed <= TRIES; seed++) {
    sample_state(w->g, seed, symbols);
    expr_eval(w->g, b->A, b->n * b->n, symbols, a);
    int finite = 1;
    for (uint32_t k = 0; k < b->n * b->n; k++) finite &= isfinite(a[k]) != 0;
    if (!finite) continue;
    if (dense_solve(w->arena, b->n, a, NULL, 1e-13L, NULL) == b->n) return 1;
    judged = 1;
  }
  return !judged;
}

static void report_singular(const FirstOrderBuilder *w, const Block *b) {
  Diags *d = w->m->diags;
  Span span = w->m->lagrangian_span;
  if (w->to->closed && w->n % 2) {
    diag_error(
        d, span,
        "L is linear in the velocities, and has an odd number of coordinates, %u: they do not determine their motion",
        w->n);
    diag_help(d, "of first order, coordinates come in pairs, as positions and momenta do; declare a coordinate whose "
                 "rate is known as a `state` "
                 "with a `flow`");
  } else if (b->n == 1) {
    diag_error(d, state_of(w, b->at[0])->span,
               "L is linear in the velocities, and does not determine the velocity of `%s`",
               state_of(w, b->at[0])->name);
    diag_help(d, "terms like x*y' must couple the coordinates in pairs; total time derivatives do not count");
  } else {
    diag_error(
        d, span,
        "L is linear in the velocities, and does not determine them: the two-form of %s is singular in every state",
        names_of(w, b, NULL, b->n));
    diag_help(d, "with dL/dq_i' = theta_i, the matrix dtheta_j/dq_i - dtheta_i/dq_j must be regular; total time "
                 "derivatives do not count");
  }
}

/* --- rates --- */

/* Replaces A by the antisymmetric [0 A; -A^T 0], with the solution (y, x): A x = b, A^T y = 0. */
static void double_block(const FirstOrderBuilder *w, Block *b) {
  uint32_t n = b->n, m = 2 * n;
  Expr *A = ARENA_ARRAY(w->arena, Expr, (size_t)m * m), *rhs = ARENA_ARRAY(w->arena, Expr, m);
  for (size_t k = 0; k < (size_t)m * m; k++) A[k] = expr_int(w->g, 0);
  for (uint32_t i = 0; i < n; i++) {
    rhs[i] = b->b[i];
    rhs[n + i] = expr_int(w->g, 0);
    for (uint32_t j = 0; j < n; j++) {
      A[(size_t)i * m + n + j] = b->A[(size_t)i * n + j];
      A[(size_t)(n + j) * m + i] = expr_neg(w->g, b->A[(size_t)i * n + j]);
    }
  }
  b->A = A;
  b->b = rhs;
}

enum { BLOCK_MOST = 200 };

/* Writes the rates of the block's coordinates into rate[]. 0, reported: the block couples too many coordinates. */
static int solve(FirstOrderBuilder *w, Block *b, Expr *rate) {
  SkewSolution by = {0};
  uint32_t m = w->to->closed ? b->n : 2 * b->n;
  Name name = intern(w->m->ast->names, "Pf");
  if (!w->to->closed) double_block(w, b);
  int many = b->n > BLOCK_MOST;
  if (many || !antisymmetric_solve(w->g, m, b->A, b->b, name, &by)) {
    int all = many || !w->to->closed;
    diag_error(w->m->diags, w->m->lagrangian_span,
               "L is linear in the velocities, and its two-form couples too many coordinates: %s",
               names_of(w, b, all ? NULL : by.left, all ? b->n : by.nleft));
    diag_help(w->m->diags,
              "pairs whose entry cannot vanish are eliminated first: declare signs of parameters, `param G = 1 > 0`");
    return 0;
  }
  for (uint32_t i = 0; i < b->n; i++) rate[b->at[i]] = by.x[w->to->closed ? i : b->n + i];
  if (by.divisor) vec_push(w->arena, &w->divisors, by.divisor);
  return 1;
}

/* Flows := the rates in the form with the fewest operations; substituted for rates in other flows, in events and
 * their actions. */
static void put_flows(FirstOrderBuilder *w, const Model *m, const Expr *rate) {
  uint32_t nsymbols = expr_symbol_count(w->g) + 1;
  const Expr *best = lagrange_short_forms(w->e, rate, w->n);
  Expr *with = ARENA_ARRAY(w->arena, Expr, nsymbols), *flow = ARENA_ARRAY(w->arena, Expr, m->states.n + 1);
  for (uint32_t i = 0; i < w->n; i++) with[state_of(w, i)->rate] = flow[w->to->at[i]] = best[i];
  for (uint32_t i = 0; i < m->states.n; i++)
    if (!w->place[i])
      flow[i] = with[m->states.at[i].rate] = expr_substitute(w->g, m->states.at[i].flow, with, nsymbols, "");
  Model *own = ARENA_NEW(w->arena, Model);
  *own = *m;
  own->events.at = ARENA_ARRAY(w->arena, Event, m->events.n + 1);
  for (uint32_t i = 0; i < m->events.n; i++) {
    Event *ev = &own->events.at[i];
    *ev = m->events.at[i];
    ev->g = expr_substitute(w->g, ev->g, with, nsymbols, "");
    Action *actions = ARENA_ARRAY(w->arena, Action, ev->actions.n + 1);
    for (uint32_t k = 0; k < ev->actions.n; k++) {
      actions[k] = ev->actions.at[k];
      actions[k].value = expr_substitute(w->g, actions[k].value, with, nsymbols, "");
    }
    ev->actions.at = actions;
  }
  own->grips.at = ARENA_ARRAY(w->arena, Grip, m->grips.n + 1);
  for (uint32_t i = 0; i < m->grips.n; i++)
    own->grips.at[i] = (Grip){expr_substitute(w->g, m->grips.at[i].velocity, with, nsymbols, ""),
                              expr_substitute(w->g, m->grips.at[i].ratio, with, nsymbols, "")};
  w->e->m = own;
  w->e->flow = flow;
}

/* Energy E = theta q' - L = H, and its scale |theta q'| + |L|. */
static void put_energy(FirstOrderBuilder *w) {
  enum { SHORTEN_MAX = 64 };
  ExprGraph *g = w->g;
  Expr *terms = ARENA_ARRAY(w->arena, Expr, w->n + 1);
  for (uint32_t i = 0; i < w->n; i++)
    terms[i] = expr_mul(g, w->to->theta[i], expr_symbol(g, state_of(w, i)->rate)->node);
  Expr pv = expr_add_n(g, terms, w->n), size_pv = expr_fn(g, EX_ABS, pv), l = expr_sub(g, pv, w->e->energy),
       size_l = expr_fn(g, EX_ABS, l);
  w->e->energy_stable = w->n <= SHORTEN_MAX ? simplify_stable(g, w->e->energy) : w->e->energy;
  w->e->energy_scale = expr_add(g, size_pv, size_l);
}

int first_order_derive(Eqns *e, const Model *m) {
  FirstOrderBuilder w = {.e = e, .m = m, .g = m->g, .arena = m->arena, .to = &e->first};
  w.to->closed = 1;
  find_coordinates(&w);
  if (!differentiate(&w) || !add_form(&w) || !add_forces(&w)) return 0;
  collect(&w);
  w.to->rhs = lagrange_short_forms(e, w.rhs, w.n);
  w.rhs = ARENA_ARRAY(w.arena, Expr, w.n);
  for (uint32_t i = 0; i < w.n; i++) w.rhs[i] = w.to->rhs[i];
  Blocks blocks = split(&w);
  Expr *rate = ARENA_ARRAY(w.arena, Expr, w.n);
  for (uint32_t i = 0; i < blocks.n; i++) {
    if (blocks.at[i].n <= BLOCK_MOST && !is_regular(&w, &blocks.at[i])) {
      report_singular(&w, &blocks.at[i]);
      return 0;
    }
    if (!solve(&w, &blocks.at[i], rate)) return 0;
  }
  w.to->rates = rate;
  w.to->divisors = w.divisors.at;
  w.to->ndivisors = w.divisors.n;
  put_flows(&w, m, rate);
  put_energy(&w);
  return 1;
}
