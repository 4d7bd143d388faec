/* Each case is a substitution in the claim and in the equations of motion, judged by the one prover
 * (prove_by_motion). Depth is at most CASES_DEPTH_MAX, the number of proofs PROOFS_MOST. */
#include "claims/case_proofs.h"

#include "claims/branch_coverage.h"
#include "mech/motion_proof.h"
#include "mech/states.h"
#include "sym/prove.h"
#include "sym/diff.h"

enum { PROOFS_MOST = 60, ENTRIES_MOST = 400 };

typedef struct {
  const Model *m;
  ExprGraph *g;
  const CaseSymbols *symbols;
  int proofs; /* number still allowed */
} Prover;

typedef struct {
  const Eqns *e;
  Expr gap, domain; /* left minus right; domain 0: everywhere */
  uint32_t depth;
  int solved; /* the sides contain accelerations or multipliers */
} Claim;

/* --- signs --- */

/* Value of a comparison, min or max of a and b from the sign of b - a; 0: undecided. */
static Expr fold_comparison(ExprGraph *g, ExprOp op, Expr a, Expr b) {
  Expr gap = expr_sub(g, b, a), yes = expr_int(g, 1), no = expr_int(g, 0);
  ExprSign s = expr_sign(g, gap);
  int same = expr_is_zero(g, gap), nonneg = same || sign_is_nonnegative(s), nonpos = same || sign_is_nonpositive(s);
  int strict = sign_is_strict(s);
  switch (op) {
    case EX_LT: return nonneg && strict ? yes : nonpos ? no : 0;
    case EX_LE: return nonneg ? yes : nonpos && strict ? no : 0;
    case EX_EQ: return same ? yes : strict ? no : 0;
    case EX_MIN: return nonneg ? a : nonpos ? b : 0;
    case EX_MAX: return nonneg ? b : nonpos ? a : 0;
    default: return 0;
  }
}

/* e with comparisons, min and max replaced where the signs of symbols decide them. */
static Expr fold(ExprGraph *g, Expr e) {
  if (!e) return 0;
  ExprMap is = expr_map(expr_arena(g));
  ExprList l = expr_topo(g, &e, 1);
  Expr last = e;
  for (uint32_t i = 0; i < l.n; i++) {
    uint32_t n = expr_nargs(g, l.at[i]);
    ExprOp op = expr_op(g, l.at[i]);
    if (op == EX_NUM || op == EX_SYM) n = 0;
    Expr *args = ARENA_ARRAY(expr_arena(g), Expr, n + 1);
    int same = 1;
    for (uint32_t k = 0; k < n; k++) {
      Expr old = expr_arg(g, l.at[i], k);
      args[k] = expr_map_get(&is, old) ? expr_map_get(&is, old) : old;
      same &= args[k] == old;
    }
    Expr now = n == 2 ? fold_comparison(g, op, args[0], args[1]) : 0;
    last = now ? now : same ? l.at[i] : expr_rebuild(g, l.at[i], args);
    expr_map_set(&is, l.at[i], last);
  }
  return last;
}

/* --- substitution --- */

static Expr substitute_in(ExprGraph *g, Expr x, const Expr *with) {
  return expr_substitute(g, x, with, expr_symbol_count(g) + 1, "");
}

static Expr *substitute_all(ExprGraph *g, const Expr *x, uint32_t n, const Expr *with) {
  Expr *out = ARENA_ARRAY(expr_arena(g), Expr, n + 1);
  for (uint32_t i = 0; i < n; i++) out[i] = fold(g, substitute_in(g, x[i], with));
  return out;
}

static Entries substitute_entries(ExprGraph *g, const Entries *x, const Expr *with) {
  Entries out = {0};
  for (uint32_t i = 0; i < x->n; i++)
    vec_push(expr_arena(g), &out,
             ((MassEntry){x->at[i].row, x->at[i].col, fold(g, substitute_in(g, x->at[i].e, with))}));
  return out;
}

const Eqns *equations_with(const Eqns *e, const Expr *with) {
  if (!with) return e;
  ExprGraph *g = e->g;
  const Constraints *k = &e->constraints;
  Eqns *c = ARENA_NEW(e->m->arena, Eqns);
  *c = *e;
  c->mass = substitute_entries(g, &e->mass, with);
  c->f = substitute_all(g, e->f, e->n, with);
  c->flow = substitute_all(g, e->flow, e->m->states.n, with);
  c->energy = substitute_in(g, e->energy, with);
  c->constraints.A = substitute_entries(g, &k->A, with);
  c->constraints.c = substitute_all(g, k->c, k->nkept, with);
  c->constraints.r = substitute_all(g, k->r, k->n, with);
  c->constraints.demand = substitute_all(g, k->demand, k->n, with);
  if (k->n) c->system.f = substitute_all(g, e->system.f, e->n, with);
  c->definitions = with;
  return c;
}

CaseSymbols cases_symbols(const Model *m) {
  CaseSymbols s;
  for (int i = 0; i < CASES_DEPTH_MAX; i++) {
    Name name = intern(m->ast->names, "?");
    s.positive[i] = expr_declare(m->g, SYM_LOCAL, 0, name, SIGN_POSITIVE);
  }
  return s;
}

/* --- one more case --- */

static int prove(Prover *p, const Claim *c);

/* Whether the claim holds with `is` in place of symbol s. */
static int holds_with(Prover *p, const Claim *c, SymId s, Expr is) {
  ExprGraph *g = p->g;
  Expr *with = ARENA_ARRAY(p->m->arena, Expr, expr_symbol_count(g) + 1);
  with[s] = is;
  Claim next = {.e = c->e, .depth = c->depth + 1, .solved = c->solved};
  next.gap = fold(g, substitute_in(g, c->gap, with));
  next.domain = c->domain ? fold(g, substitute_in(g, c->domain, with)) : 0;
  if (c->solved || c->e->constraints.n) next.e = equations_with(c->e, with);
  return prove(p, &next);
}

/* u = A s + B */
typedef struct {
  SymId s;
  Expr A, B;
} Linear;

static int is_free(const Symbol *s) {
  return s->kind != SYM_ACC && s->kind != SYM_MULTIPLIER && s->kind != SYM_RATE && s->kind != SYM_LOCAL &&
         s->kind != SYM_CONST;
}

/* Whether u = A s + B: du/ds is free of s, and u has no steps in s, whose derivative is 0. */
static int linear_in(ExprGraph *g, Expr u, SymId s, Linear *out) {
  Expr zero = expr_int(g, 0);
  ExprList l = expr_topo(g, &u, 1);
  *out = (Linear){.s = s, .A = expr_diff(g, u, s)};
  for (uint32_t i = 0; i < l.n; i++) {
    ExprOp op = expr_op(g, l.at[i]);
    int steps = op == EX_SIGN || op == EX_FLOOR || op == EX_LT || op == EX_LE || op == EX_EQ;
    if (steps && expr_contains_sym(g, l.at[i], s)) return 0;
  }
  out->B = expr_replace(g, u, &s, &zero, 1);
  return !expr_contains_sym(g, out->A, s);
}

/* The value of the symbol where u is `value`. */
static Expr solution(ExprGraph *g, const Linear *l, Expr value) {
  Expr rest = expr_sub(g, value, l->B);
  return expr_div(g, rest, l->A);
}

/* A symbol in which u is linear, and its value where u is `value`. Preferred: a symbol of unknown sign, then one
 * whose sign the value shows. 0: there is none. */
static int solve_for_symbol(ExprGraph *g, Expr u, Expr value, SymId *s, Expr *is) {
  ExprList l = expr_topo(g, &u, 1);
  int best = 0;
  for (uint32_t i = 0; i < l.n && best < 3; i++) {
    Linear one;
    if (expr_op(g, l.at[i]) != EX_SYM || !is_free(expr_sym_of(g, l.at[i])) ||
        !linear_in(g, u, expr_sym_id(g, l.at[i]), &one) || !expr_is_nonzero(g, one.A))
      continue;
    Expr found = solution(g, &one, value);
    ExprSign sign = expr_sym_of(g, l.at[i])->sign;
    int rank = sign == SIGN_UNKNOWN ? 3 : expr_sign(g, found) == sign ? 2 : 1;
    if (rank <= best) continue;
    best = rank;
    *s = one.s;
    *is = found;
  }
  return best > 0;
}

/* Whether the claim holds where u is `sign` times a positive number, or 0 for sign 0; -1: no symbol gives u that
 * value. */
static int holds_where(Prover *p, const Claim *c, Expr u, int sign) {
  ExprGraph *g = p->g;
  Expr value = expr_scale(g, num_int(sign), expr_symbol(g, p->symbols->positive[c->depth])->node), is;
  SymId s;
  return solve_for_symbol(g, u, sign ? value : expr_int(g, 0), &s, &is) ? holds_with(p, c, s, is) : -1;
}

/* --- facts of the domain --- */

/* Uses one fact of the domain's conjunction, u > 0 or u >= 0; -1: there is none. */
static int use_domain(Prover *p, const Claim *c) {
  ExprGraph *g = p->g;
  VEC(Expr) list = {0};
  if (c->domain) vec_push(p->m->arena, &list, c->domain);
  for (uint32_t i = 0; i < list.n; i++) {
    Expr x = list.at[i];
    ExprOp op = expr_op(g, x);
    if (op == EX_AND)
      for (uint32_t k = 0; k < 2; k++) vec_push(p->m->arena, &list, expr_arg(g, x, k));
    if (op != EX_LT && op != EX_LE) continue;
    Expr u = expr_sub(g, expr_arg(g, x, 1), expr_arg(g, x, 0));
    int is = expr_sign(g, u) == SIGN_UNKNOWN ? holds_where(p, c, u, 1) : -1;
    if (is >= 0) return is && (op == EX_LT || holds_where(p, c, u, 0));
  }
  return -1;
}

/* --- constraints --- */

/* Solves c = A s^2 + B = 0 for s, both roots or that of the declared sign; 1 or 0 as the claim holds with them, -1:
 * there is no such s. */
static int use_square(Prover *p, const Claim *c, Expr constraint) {
  ExprGraph *g = p->g;
  ExprList l = expr_topo(g, &constraint, 1);
  for (int with_sign = 1; with_sign >= 0; with_sign--)
    for (uint32_t i = 0; i < l.n; i++) {
      if (expr_op(g, l.at[i]) != EX_SYM || !is_free(expr_sym_of(g, l.at[i]))) continue;
      SymId s = expr_sym_id(g, l.at[i]);
      ExprSign sign = expr_symbol(g, s)->sign;
      if ((sign != SIGN_UNKNOWN) != with_sign) continue;
      Expr slope = expr_diff(g, constraint, s), twice = expr_diff(g, slope, s),
           A = expr_scale(g, num_ratio(1, 2), twice);
      Expr square = expr_pow_num(g, l.at[i], num_int(2)), part = expr_mul(g, A, square),
           B = expr_sub(g, constraint, part);
      if (!expr_is_nonzero(g, A) || expr_contains_sym(g, A, s) || expr_contains_sym(g, B, s)) continue;
      Expr minus = expr_neg(g, B), root = expr_sqrt(g, expr_div(g, minus, A)), other = expr_neg(g, root);
      return (sign_is_nonpositive(sign) || holds_with(p, c, s, root)) &&
             (sign_is_nonnegative(sign) || holds_with(p, c, s, other));
    }
  return -1;
}

/* Uses a constraint c = 0 on positions to replace one of its symbols; -1: none is left. */
static int use_positions(Prover *p, const Claim *c) {
  const Constraints *k = &c->e->constraints;
  for (uint32_t i = 0; i < k->nholonomic; i++) {
    if (prove_zero(p->g, k->c[i], NULL) == PROVED_ZERO) continue; /* used by a case before */
    int is = holds_where(p, c, k->c[i], 0);
    if (is < 0) is = use_square(p, c, k->c[i]);
    if (is >= 0) return is;
  }
  return -1;
}

/* Uses a constraint r = 0 on velocities, solved for each velocity whose factor is not 0. The claim must hold with
 * each of them: then it holds wherever one factor is not 0. -1: none is left. */
static int use_velocities(Prover *p, const Claim *c) {
  ExprGraph *g = p->g;
  const Constraints *k = &c->e->constraints;
  for (uint32_t i = 0; i < k->n; i++) {
    Expr r = k->r[i];
    int some = 0;
    if (prove_zero(g, r, NULL) == PROVED_ZERO) continue;
    for (int sure = 1; sure >= 0; sure--)
      for (uint32_t j = 0; j < c->e->n; j++) {
        SymId v = p->m->coords.at[j].v;
        Linear l;
        if (!linear_in(g, r, v, &l) || expr_is_zero(g, l.A) || expr_is_nonzero(g, l.A) != sure) continue;
        if (!holds_with(p, c, v, solution(g, &l, expr_int(g, 0)))) return 0;
        if (sure) return 1;
        some = 1;
      }
    if (some) return 1;
  }
  return -1;
}

/* --- switches --- */

/* Cases u > 0, u < 0 and u = 0, or those of a factor of u; -1: no symbol can be replaced. */
static int use_sides(Prover *p, const Claim *c, Expr u) {
  ExprGraph *g = p->g;
  uint32_t factors = expr_op(g, u) == EX_PROD ? expr_pairs(g, u, EX_PROD) : 0;
  for (uint32_t i = 0; i <= factors; i++) {
    Num power;
    Expr x = i ? expr_pair(g, u, EX_PROD, i - 1, &power) : u;
    int above = expr_sign(g, x) == SIGN_UNKNOWN ? holds_where(p, c, x, 1) : -1;
    if (above >= 0) return above && holds_where(p, c, x, -1) && holds_where(p, c, x, 0);
  }
  return -1;
}

/* u without its number, where it is one term: x*y of -2*x*y. */
static Expr without_number(ExprGraph *g, Expr u) {
  return expr_pairs(g, u, EX_SUM) == 1 ? expr_pair(g, u, EX_SUM, 0, NULL) : u;
}

/* Cases of the first switch for which a symbol can be replaced; -1: there is none. */
static int use_switches(Prover *p, const Claim *c) {
  ExprGraph *g = p->g;
  VEC(Expr) roots = {0};
  Arena *a = p->m->arena;
  vec_push(a, &roots, c->gap);
  if (c->domain) vec_push(a, &roots, c->domain);
  for (uint32_t i = 0; i < c->e->n && c->solved; i++) vec_push(a, &roots, c->e->f[i]);
  for (uint32_t i = 0; i < c->e->mass.n && c->solved; i++) vec_push(a, &roots, c->e->mass.at[i].e);
  ExprList l = expr_topo(g, roots.at, roots.n);
  for (uint32_t i = 0; i < l.n; i++) {
    Expr u = switching_function(g, l.at[i]);
    int is = u ? use_sides(p, c, without_number(g, u)) : -1;
    if (is >= 0) return is;
  }
  return -1;
}

/* Recursion ends at CASES_DEPTH_MAX. */
static int prove(Prover *p, const Claim *c) {
  if (c->domain && expr_is_zero(p->g, c->domain)) return 1; /* there is no such state */
  if (p->proofs-- <= 0) return 0;
  if (prove_by_motion(c->e, c->gap, expr_int(p->g, 0)) == PROVED_ZERO) return 1;
  if (c->depth == CASES_DEPTH_MAX) return 0;
  int (*const use[])(Prover *, const Claim *) = {use_domain, use_positions, use_velocities, use_switches};
  for (int k = 0; k < 4; k++) {
    int is = use[k](p, c);
    if (is >= 0) return is;
  }
  return 0;
}

int prove_by_cases(const Eqns *e, const CaseSymbols *symbols, Expr lhs, Expr rhs, Expr domain) {
  const unsigned solved = 1u << SYM_ACC | 1u << SYM_MULTIPLIER;
  ExprGraph *g = e->g;
  Prover p = {.m = e->m, .g = g, .symbols = symbols, .proofs = PROOFS_MOST};
  Expr left = states_substitute(e, lhs), right = states_substitute(e, rhs), gap = expr_sub(g, left, right);
  Claim c = {.e = e,
             .gap = fold(g, gap),
             .domain = domain ? fold(g, states_substitute(e, domain)) : 0,
             .solved = (expr_kinds(g, gap) & solved) != 0};
  return e->mass.n + e->constraints.A.n <= ENTRIES_MOST && prove(&p, &c);
}
