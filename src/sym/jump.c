/* Search for jumps: candidates from the graph, sign changes of their switching functions on straight lines through
 * random states, then the one-sided values of the expression at shrinking distances. */
#include "sym/jump.h"

#include <math.h>

#include "sym/expr_eval.h"
#include "sym/prove.h"

typedef long double Real;

enum {
  MAX_CANDIDATES = 200,   /* candidates examined: models of many bodies repeat the same few */
  LINES = 64,   /* lines through random states */
  PLACES = 12   /* lines with a sign change tried for each candidate; one jump suffices */
};

static const unsigned varying_kinds =
    1u << SYM_TIME | 1u << SYM_COORD | 1u << SYM_VEL | 1u << SYM_STATE | 1u << SYM_RATE;

typedef struct {
  ExprGraph *g;
  Arena *arena;
  uint32_t nsymbols;
  VEC(SymId) symbols; /* symbols of all sources and of these terms */
  uint32_t nterms;    /* number of terms of x that contain sources */
  EvalTape *tape;     /* tape of these terms */
  Real *term;         /* their values */
  Real *base, *direction;   /* current line base + s*direction */
  int from_origin;    /* whether coordinates, velocities and time are 0 at its base */
  Real *at;           /* a state on the line */
  VEC(ExprJump) found;
} Search;

/* --- candidates --- */

/* Candidate: a node that may jump where `side` is 0. */
typedef struct {
  Expr node, side;
} Source;

typedef VEC(Source) Sources;

static void add(const Search *s, Sources *to, Expr node, Expr side) {
  if (!(expr_kinds(s->g, side) & varying_kinds) || to->n == MAX_CANDIDATES) return;
  vec_push(s->arena, to, ((Source){node, side}));
}

/* Whether op can turn a pole into a finite jump: atan(1/x), x/abs(x). */
static int bounds_poles(ExprOp op) {
  return op == EX_ATAN || op == EX_ATAN2 || op == EX_TANH || op == EX_EXP || op == EX_ABS;
}

static void add_divisors(const Search *s, Sources *to, Expr product) {
  ExprGraph *g = s->g;
  for (ExprPair base = {0}; expr_next_pair(g, product, EX_PROD, &base);) {
    if (num_sign(base.num) >= 0) continue;
    if (expr_op(g, base.of) == EX_ABS) base.of = expr_arg(g, base.of, 0);
    ExprSign sign = expr_sign(g, base.of);
    if (sign == SIGN_UNKNOWN) add(s, to, base.of, base.of);
  }
}

/* The node of pi; 0: the model has none. */
static Expr pi_of(const ExprGraph *g) {
  for (SymId i = 1; i <= expr_symbol_count(g); i++)
    if (expr_symbol(g, i)->kind == SYM_CONST) return expr_symbol(g, i)->node;
  return 0;
}

static Sources sources_of(const Search *s, Expr x) {
  ExprGraph *g = s->g;
  Sources all = {0};
  ExprList nodes = expr_topo(g, &x, 1);
  int poles = 0;
  for (uint32_t i = 0; i < nodes.n; i++) poles |= bounds_poles(expr_op(g, nodes.at[i]));
  for (uint32_t i = 0; i < nodes.n; i++) {
    Expr e = nodes.at[i];
    ExprOp op = expr_op(g, e);
    if (op == EX_LT || op == EX_LE) {
      Expr a = expr_arg(g, e, 0), b = expr_arg(g, e, 1);
      add(s, &all, e, expr_sub(g, b, a));
    } else if (op == EX_SIGN || op == EX_ATAN2) {
      add(s, &all, e, expr_arg(g, e, 0));
    } else if (op == EX_FLOOR && pi_of(g)) {
      Expr turns = expr_mul(g, pi_of(g), expr_arg(g, e, 0));
      add(s, &all, e, expr_fn(g, EX_SIN, turns));
    } else if (op == EX_TAN) {
      add(s, &all, e, expr_fn(g, EX_COS, expr_arg(g, e, 0)));
    } else if (op == EX_PROD && poles) {
      add_divisors(s, &all, e);
    }
  }
  return all;
}

/* Selects the terms of x that contain sources, and their symbols; other terms would only add rounding. */
static void select_terms(Search *s, const Sources *all, Expr x) {
  ExprGraph *g = s->g;
  ExprMap nodes = expr_map(s->arena);
  VEC(Expr) roots = {0};
  for (uint32_t i = 0; i < all->n; i++) expr_map_set(&nodes, all->at[i].node, 1);
  for (ExprPair term = {0}; expr_next_pair(g, x, EX_SUM, &term);) {
    ExprList l = expr_topo(g, &term.of, 1);
    uint32_t k = 0;
    while (k < l.n && !expr_map_get(&nodes, l.at[k])) k++;
    if (k < l.n) vec_push(s->arena, &roots, expr_scale(g, term.num, term.of));
  }
  s->nterms = roots.n;
  s->tape = eval_tape(g, roots.at, roots.n);
  s->term = ARENA_ARRAY(s->arena, Real, roots.n + 1);
  for (uint32_t i = 0; i < all->n; i++) vec_push(s->arena, &roots, all->at[i].side);
  ExprList l = expr_topo(g, roots.at, roots.n);
  for (uint32_t i = 0; i < l.n; i++)
    if (expr_op(g, l.at[i]) == EX_SYM) vec_push(s->arena, &s->symbols, expr_sym_id(g, l.at[i]));
}

/* --- lines --- */

/* Random line. Every second line starts at the origin, so that powers of 10 along it meet every length and time
 * scale: the radius of an atom, and of an orbit. Of the others, every second one moves velocities and states alone:
 * g(q) q' changes its sign with q' there, not with g. */
static void draw_line(Search *s, uint32_t seed) {
  const Real wide = 4; /* past half a turn */
  const unsigned kinds = seed % 4 == 3 ? 1u << SYM_VEL | 1u << SYM_STATE | 1u << SYM_RATE : varying_kinds;
  s->from_origin = seed % 2 == 0;
  for (uint32_t i = 0; i < s->symbols.n; i++) {
    SymId k = s->symbols.at[i];
    int moves = (1u << expr_symbol(s->g, k)->kind & kinds) != 0;
    s->base[k] = moves && s->from_origin ? 0 : sample_symbol(s->g, k, seed) * (moves ? wide : 1);
    s->direction[k] = moves ? sample_symbol(s->g, k, seed + 2 * LINES) : 0;
  }
}

/* Sets the state to base + where*direction; returns 0 if a symbol violates its declared sign. */
static int set_state(Search *s, Real where) {
  for (uint32_t i = 0; i < s->symbols.n; i++) {
    SymId k = s->symbols.at[i];
    ExprSign sign = expr_symbol(s->g, k)->sign;
    Real x = s->at[k] = s->base[k] + where * s->direction[k];
    if ((sign_is_nonnegative(sign) && x < 0) || (sign_is_nonpositive(sign) && x > 0)) return 0;
  }
  return 1;
}

/* Switching function at a place of the line; NaN where a declared sign is violated. */
static Real switching_value(Search *s, EvalTape *side, Real where) {
  Real value;
  if (!set_state(s, where)) return NAN;
  eval_run(side, s->at, &value);
  return value;
}

/* Sampling point i of the line: 0, and on both sides powers of 10 for lines from the origin, of 2 for others. */
static Real sampling_point(const Search *s, int i) {
  int power = (i < 0 ? -i : i) - 1;
  Real size = i == 0 ? 0 : s->from_origin ? powl(10, power - 9) : ldexpl(1, power - 2);
  return i < 0 ? -size : size;
}

/* A part of the line at whose ends the switching function has other signs; lo: at its lower end it is positive. */
typedef struct {
  Real lo, hi;
  int positive;
} SignChange;

enum { CHANGES = 4 }; /* on a line: of a product, as sin(x)*x', one factor may change its sign without a jump */

/* Sign changes of the switching function, those nearest to the base of the line first. */
static int sign_changes(Search *s, EvalTape *side, SignChange change[CHANGES]) {
  enum { REACH = 24 };
  Real left = switching_value(s, side, 0), right = left;
  int n = 0;
  for (int i = 1; i <= REACH && n < CHANGES; i++) {
    Real before = left, after = right, near = sampling_point(s, 1 - i), far = sampling_point(s, -i);
    left = switching_value(s, side, far);
    right = switching_value(s, side, sampling_point(s, i));
    if (isfinite(before) && isfinite(left) && (left > 0) != (before > 0))
      change[n++] = (SignChange){far, near, left > 0};
    near = sampling_point(s, i - 1), far = sampling_point(s, i);
    if (n < CHANGES && isfinite(after) && isfinite(right) && (right > 0) != (after > 0))
      change[n++] = (SignChange){near, far, after > 0};
  }
  return n;
}

/* Bisects a sign change to the last bit; returns 0 if there are places without a value. */
static int find_place(Search *s, EvalTape *side, SignChange c, Real *where) {
  enum { HALVINGS = 200 };
  for (int i = 0; i < HALVINGS && c.lo < c.hi; i++) {
    Real mid = (c.lo + c.hi) / 2, value = switching_value(s, side, mid);
    if (!isfinite(value)) return 0;
    if ((value > 0) == c.positive) c.lo = mid;
    else c.hi = mid;
  }
  *where = (c.lo + c.hi) / 2;
  return 1;
}

/* --- both sides --- */

/* Sum of the selected terms at a place of the line; *size: the sum of their magnitudes. */
static Real value_at(Search *s, Real where, Real *size) {
  Real value = 0;
  *size = 0;
  if (!set_state(s, where)) return NAN;
  eval_run(s->tape, s->at, s->term);
  for (uint32_t i = 0; i < s->nterms; i++) {
    value += s->term[i];
    *size += fabsl(s->term[i]);
  }
  return value;
}

/* Length scale for steps along the line at `where`. */
static Real length_scale(const Search *s, Real where) { return s->from_origin ? fabsl(where) : fmaxl(1, fabsl(where)); }

/* Height of the jump of x at `where`, 0 if there is none. Across a jump the difference of both sides stays constant
 * as the distance shrinks; for a continuous x it falls, to about half per step even for an eighth root; at a pole,
 * or for log, it grows. */
static Real jump_at(Search *s, Real where) {
  static const Real distance[] = {1e-5L, 1e-7L, 1e-9L, 1e-11L};
  enum { DISTANCES = sizeof distance / sizeof *distance };
  /* tolerance is relative to the jump, least to its terms; positions are known to 1e-11 even if long double is
   * double */
  const Real tolerance = 0.02L, least = 1e-9L;
  Real far = length_scale(s, where), jump[DISTANCES], size, other, most = 0;
  for (int i = 0; i < DISTANCES; i++) {
    Real h = distance[i] * far, above = value_at(s, where + h, &size), below = value_at(s, where - h, &other);
    jump[i] = above - below;
    most = fmaxl(most, size + other);
    if (!isfinite(jump[i])) return 0;
  }
  Real is = jump[DISTANCES - 1];
  if (!(fabsl(is) > least * most) || !(fabsl(jump[1] - jump[0]) <= 10 * tolerance * fabsl(is))) return 0;
  for (int i = 2; i < DISTANCES; i++)
    if (!(fabsl(jump[i] - jump[i - 1]) <= tolerance * fabsl(is))) return 0;
  return is;
}

static void add_jump(Search *s, const Source *from, EvalTape *side, uint32_t seed, Real where, Real by) {
  Real h = 1e-6L * length_scale(s, where),
       slope = (switching_value(s, side, where + h) - switching_value(s, side, where - h)) / (2 * h);
  Real *symbols = ARENA_ARRAY(s->arena, Real, s->nsymbols + 1);
  sample_state(s->g, seed, symbols); /* symbols without influence on the jump */
  set_state(s, where);
  for (uint32_t i = 0; i < s->symbols.n; i++) symbols[s->symbols.at[i]] = s->at[s->symbols.at[i]];
  vec_push(s->arena, &s->found, ((ExprJump){from->node, from->side, symbols, by, slope}));
}

static void try_source(Search *s, const Source *from) {
  EvalTape *side = eval_tape(s->g, &from->side, 1);
  uint32_t places = 0;
  for (uint32_t seed = 1; seed <= LINES && places < PLACES; seed++) {
    SignChange change[CHANGES];
    draw_line(s, seed);
    int n = sign_changes(s, side, change);
    places += n > 0;
    for (int i = 0; i < n; i++) {
      Real where, by = find_place(s, side, change[i], &where) ? jump_at(s, where) : 0;
      if (by == 0) continue;
      add_jump(s, from, side, seed, where, by);
      return;
    }
  }
}

ExprJumps expr_jumps(ExprGraph *g, Expr x) {
  Search s = {.g = g, .arena = expr_arena(g), .nsymbols = expr_symbol_count(g)};
  if (!(expr_kinds(g, x) & varying_kinds)) return (ExprJumps){0};
  Sources all = sources_of(&s, x);
  if (!all.n) return (ExprJumps){0};
  select_terms(&s, &all, x);
  s.base = ARENA_ARRAY(s.arena, Real, s.nsymbols + 1);
  s.direction = ARENA_ARRAY(s.arena, Real, s.nsymbols + 1);
  s.at = ARENA_ARRAY(s.arena, Real, s.nsymbols + 1);
  for (uint32_t i = 0; i < all.n; i++) try_source(&s, &all.at[i]);
  return (ExprJumps){s.found.at, s.found.n};
}

typedef struct {
  ExprGraph *g;
  Expr all; /* 0: everywhere */
} SmoothDomain;

/* Adds the condition a != b. 1: it restricts the motion. */
static int add_apart(SmoothDomain *d, Expr a, Expr b) {
  Expr u = expr_sub(d->g, a, b), apart;
  if (!(expr_kinds(d->g, u) & ~(1u << SYM_PARAM | 1u << SYM_CONST | 1u << SYM_TIME)) || expr_is_nonzero(d->g, u))
    return 0;
  apart = expr_fn(d->g, EX_NOT, expr_fn2(d->g, EX_EQ, a, b));
  d->all = d->all ? expr_fn2(d->g, EX_AND, d->all, apart) : apart;
  return 1;
}

Expr expr_smooth_domain(ExprGraph *g, const Expr *roots, uint32_t n, int *jumps) {
  SmoothDomain d = {.g = g};
  ExprList l = expr_topo(g, roots, n);
  Expr zero = expr_int(g, 0), one = expr_int(g, 1), minus = expr_int(g, -1);
  int some = 0;
  for (uint32_t i = 0; i < l.n; i++) {
    Expr e = l.at[i], u = expr_nargs(g, e) ? expr_arg(g, e, 0) : 0;
    ExprOp op = expr_op(g, e);
    if (op == EX_ABS || op == EX_SIGN) some |= add_apart(&d, u, zero);
    if (op == EX_FLOOR) some |= add_apart(&d, u, e);
    if (op == EX_MIN || op == EX_MAX || op == EX_LT || op == EX_LE || op == EX_EQ)
      some |= add_apart(&d, u, expr_arg(g, e, 1));
    if (op == EX_CBRT) add_apart(&d, u, zero);
    if (op == EX_ASIN || op == EX_ACOS) add_apart(&d, u, one), add_apart(&d, u, minus);
    for (uint32_t k = 0; op == EX_PROD && k < expr_pairs(g, e, EX_PROD); k++) {
      Num power;
      Expr base = expr_pair(g, e, EX_PROD, k, &power);
      if (!num_is_int(power)) add_apart(&d, base, zero);
    }
  }
  if (jumps) *jumps |= some;
  return d.all;
}
