/* Tries, in this order: other arguments (an order of y, swapped or fixed parameters), for which the equations of
 * motion give the function's values; one term of an equation of motion M q'' = f, of a rate z', or of two coupled
 * equations solved by Cramer's rule, changed so that they do. */
#include "claims/difference_cause.h"

#include <math.h>
#include <string.h>

#include "claims/feature_pool.h"
#include "mech/states.h"
#include "sym/print.h"
#include "sym/simplify.h"

typedef long double Real;

/* most terms of which pairs are tried; cost of a term too many, where others cost 1 and the size of a factor */
enum { PAIRS_MAX = 24, COST_MORE = 5 };

typedef struct {
  const Eqns *e;
  const Model *m;
  ExprGraph *g;
  Arena *arena;
  const DifferenceData *d;
  StateSolver *solver;
  SymList y;
  uint32_t nq;
  Real *trial;                       /* by symbol */
  Real *state[FEATURE_STATES];       /* by symbol; accelerations and rates are those of the function */
  const Features *features;
} CauseSearch;

/* A change of the derived value is an explanation of its difference only if it leaves no more than rounding
 * explains, and is itself more than that wherever the value differs. 0: it is none. */
static int fits(Real change, Real difference, Real bound) {
  return fabsl(change - difference) <= bound && (fabsl(difference) <= bound || fabsl(change) > bound);
}

/* ---- other arguments ---- */

/* Rate of component i of y at the trial's values. */
static Real trial_rate(const CauseSearch *s, uint32_t i) {
  if (i < s->nq) return s->trial[s->m->coords.at[i].v];
  return s->trial[i < 2 * s->nq ? s->m->coords.at[i - s->nq].a : s->m->states.at[i - 2 * s->nq].rate];
}

/* Whether at every state the equations give the function's values when its y[i] is component order[map[i]], or,
 * order NULL, after `change`. */
static int explains(CauseSearch *s, const uint32_t *order, void (*change)(CauseSearch *s, uint32_t j, uint32_t k),
                    uint32_t j, uint32_t k) {
  size_t bytes = (expr_symbol_count(s->g) + 1) * sizeof *s->trial;
  int changed = 0;
  for (uint32_t n = 0; n < s->d->n; n++) {
    const Real *state = s->d->state[n], *rate = s->d->rate[n];
    memcpy(s->trial, state, bytes);
    if (change) change(s, j, k);
    for (uint32_t i = 0; i < s->y.n && order; i++) s->trial[s->y.at[order[i]]] = state[s->y.at[i]];
    sample_follow(s->d->points, s->trial);
    if (!states_complete(s->solver, s->trial)) return 0;
    for (uint32_t i = 0; i < s->y.n; i++) {
      Real difference = s->d->difference[n][i], bound = s->d->bound[n][i],
           moved = trial_rate(s, order ? order[i] : i) - (rate[i] - difference);
      if (!fits(moved, difference, bound)) return 0;
      changed |= fabsl(moved) > bound;
    }
  }
  return changed;
}

static void swap_parameters(CauseSearch *s, uint32_t j, uint32_t k) {
  const SymId *p = sample_parameters(s->d->points).at;
  Real was = s->trial[p[j]];
  s->trial[p[j]] = s->trial[p[k]];
  s->trial[p[k]] = was;
}

/* Parameters j to k at the scene's values. */
static void fix_parameters(CauseSearch *s, uint32_t j, uint32_t k) {
  for (uint32_t i = j; i <= k; i++) sample_default(s->d->points, i, s->trial);
}

/* Another order of y: each coordinate with its velocity, or velocities first. */
static const char *cause_order(CauseSearch *s) {
  uint32_t n = s->nq, *order = ARENA_ARRAY(s->arena, uint32_t, s->y.n + 1);
  for (int kind = 0; kind < 2 && n; kind++) {
    for (uint32_t i = 0; i < s->y.n; i++)
      order[s->d->map[i]] = i >= 2 * n ? i : kind ? (i + n) % (2 * n) : i / 2 + i % 2 * n;
    if (!explains(s, order, NULL, 0, 0)) continue;
    StrBuf b = strbuf(s->arena);
    for (uint32_t i = 0; i < s->y.n; i++)
      sb_printf(&b, "%s%s", i ? "," : "", expr_symbol(s->g, s->y.at[order[s->d->map[i]]])->name);
    return arena_printf(s->arena, "it has y in another order: --map \"%s\"", sb_text(&b));
  }
  return NULL;
}

static const char *cause_parameters(CauseSearch *s) {
  SymList p = sample_parameters(s->d->points);
  for (uint32_t j = 0; j < p.n; j++) {
    const char *name = expr_symbol(s->g, p.at[j])->name;
    for (uint32_t k = j + 1; k < p.n; k++)
      if (explains(s, NULL, swap_parameters, j, k))
        return arena_printf(s->arena, "`%s` and `%s` are swapped in it", name, expr_symbol(s->g, p.at[k])->name);
    if (!explains(s, NULL, fix_parameters, j, j)) continue;
    fix_parameters(s, j, j);
    return arena_printf(s->arena, "it has %.6Lg for `%s`, whatever p[%u] is", s->trial[p.at[j]], name, j);
  }
  return p.n > 1 && explains(s, NULL, fix_parameters, 0, p.n - 1) ? "it has the scene's parameters, whatever p is"
                                                                  : NULL;
}

/* ---- one term ---- */

/* Values of e at the states. */
static void values_of(CauseSearch *s, Expr e, Real *out) {
  EvalTape *tape = eval_tape(s->g, &e, 1);
  for (uint32_t n = 0; n < FEATURE_STATES; n++) eval_run(tape, s->state[n], &out[n]);
}

typedef VEC(Expr) Exprs;

/* The product without its factor at `at`, a sum, times each term of the sum. */
static void distribute(CauseSearch *s, Expr product, uint32_t at, Exprs *out) {
  Expr sum = expr_pair(s->g, product, EX_PROD, at, NULL), rest = expr_div(s->g, product, sum);
  for (ExprPair term = {0}; expr_next_pair(s->g, sum, EX_SUM, &term);) {
    Expr whole = expr_mul(s->g, term.of, rest);
    vec_push(s->arena, out, expr_scale(s->g, term.num, whole));
  }
}

/* Terms of a sum; behind a product with a sum stand its terms, too. */
static void add_terms(CauseSearch *s, Expr e, Exprs *out) {
  enum { MOST = 60 };
  Expr x = expr_expand_defs(s->g, simplify(s->g, e));
  Num c;
  uint32_t first = out->n;
  for (ExprPair term = {0}; expr_next_pair(s->g, x, EX_SUM, &term);)
    vec_push(s->arena, out, expr_scale(s->g, term.num, term.of));
  for (uint32_t k = first; k < out->n && out->n < MOST; k++) {
    Expr term = expr_pair(s->g, out->at[k], EX_SUM, 0, &c);
    for (uint32_t i = 0; i < expr_pairs(s->g, term, EX_PROD); i++) {
      Expr factor = expr_pair(s->g, term, EX_PROD, i, &c);
      if (expr_op(s->g, factor) != EX_SUM || !num_is_one(c)) continue;
      uint32_t from = out->n;
      Num coefficient;
      expr_pair(s->g, out->at[k], EX_SUM, 0, &coefficient);
      distribute(s, term, i, out);
      for (uint32_t n = from; n < out->n; n++) out->at[n] = expr_scale(s->g, coefficient, out->at[n]);
      break;
    }
  }
}

typedef struct {
  double cost;
  const char *text;
} Cause;

static int is_minus_one(const CauseSearch *s, Expr e) {
  return expr_is_num(s->g, e) && num_equal(expr_number(s->g, e), num_int(-1));
}

static void consider(Cause *best, double cost, const char *text) {
  if (best->text && best->cost <= cost) return;
  *best = (Cause){cost, text};
}

/* Residual of an equation at the states with the function's rates, and the part of it that rounding explains; the
 * accelerations that it determines. */
typedef struct {
  Real value[FEATURE_STATES], bound[FEATURE_STATES];
  uint32_t solved; /* bit j: q''_j */
} Lack;

static uint32_t accelerations_in(CauseSearch *s, Expr e) {
  uint32_t bits = 0;
  for (uint32_t j = 0; j < s->nq; j++) bits |= (uint32_t)(expr_contains_sym(s->g, e, s->m->coords.at[j].a) != 0) << j;
  return bits;
}

/* Whether `e`, in place of a term with the accelerations `had`, brings in one that the equation determines: so any
 * difference could be explained. */
static int is_circular(CauseSearch *s, Expr e, uint32_t had, const Lack *lack) {
  return (accelerations_in(s, e) & ~had & lack->solved) != 0;
}

static int is_lack(CauseSearch *s, Expr change, const Lack *lack) {
  Real value[FEATURE_STATES];
  int fit = 1;
  values_of(s, change, value);
  for (uint32_t n = 0; n < FEATURE_STATES; n++) fit &= fits(value[n], lack->value[n], lack->bound[n]);
  return fit;
}

/* The change of `term` by which its sum changes by the lack. */
static void consider_term(CauseSearch *s, Expr term, const Lack *lack, Cause *best) {
  Real value[FEATURE_STATES], ratio[FEATURE_STATES];
  int missing = is_lack(s, expr_neg(s->g, term), lack);
  values_of(s, term, value);
  for (uint32_t n = 0; n < FEATURE_STATES; n++) {
    ratio[n] = (value[n] + lack->value[n]) / value[n];
    if (!isfinite(ratio[n])) return;
  }
  Monomial factor = missing ? (Monomial){0} : features_fit(s->features, ratio);
  if (!missing && !factor.e) return;
  Expr now = missing ? term : expr_mul(s->g, term, factor.e);
  if (!missing &&
      (is_circular(s, now, accelerations_in(s, term), lack) || !is_lack(s, expr_sub(s->g, now, term), lack)))
    return;
  const char *text = expr_text(s->g, term);
  if (missing) consider(best, 0, arena_printf(s->arena, "it lacks `%s`", text));
  else if (is_minus_one(s, factor.e))
    consider(best, 1, arena_printf(s->arena, "it has `%s` with the opposite sign", text));
  else consider(best, 1 + factor.size, arena_printf(s->arena, "it has `%s` in place of `%s`", expr_text(s->g, now),
                                                    text));
}

/* The change of one term, or a term too many; else the change of two terms that were written as a product with a
 * sum. */
static const char *changed_term(CauseSearch *s, const Exprs *terms, const Lack *lack) {
  Cause best = {0};
  for (uint32_t k = 0; k < terms->n; k++) consider_term(s, terms->at[k], lack, &best);
  Monomial more = features_fit(s->features, lack->value);
  if (more.e && !is_circular(s, more.e, 0, lack) && is_lack(s, more.e, lack))
    consider(&best, COST_MORE, arena_printf(s->arena, "it has one more term, `%s`", expr_text(s->g, more.e)));
  for (uint32_t k = 0; k < terms->n && terms->n <= PAIRS_MAX && !best.text; k++)
    for (uint32_t j = 0; j < k; j++)
      if (accelerations_in(s, terms->at[j]) == accelerations_in(s, terms->at[k]))
        consider_term(s, expr_add(s->g, terms->at[j], terms->at[k]), lack, &best);
  return best.text;
}

static Real difference_of(const CauseSearch *s, uint32_t n, uint32_t component) {
  return s->d->difference[n][component];
}

static Real bound_of(const CauseSearch *s, uint32_t n, uint32_t component) { return s->d->bound[n][component]; }

/* Whether rounding explains it. */
static int vanishes(const Lack *lack) {
  for (uint32_t n = 0; n < FEATURE_STATES; n++)
    if (!(fabsl(lack->value[n]) <= lack->bound[n])) return 0;
  return 1;
}

/* Equation i of M q'' = f: with the function's accelerations the right side lacks R = M (q'' - derived q''). */
static const char *cause_in_equation(CauseSearch *s, uint32_t i) {
  Exprs terms = {0};
  Lack lack = {0};
  Real entry[FEATURE_STATES];
  add_terms(s, s->e->f[i], &terms);
  for (uint32_t j = 0; j < s->nq; j++) {
    Expr M = eqns_mass(s->e, i, j);
    if (expr_is_zero(s->g, M)) continue;
    lack.solved |= 1u << j;
    values_of(s, M, entry);
    for (uint32_t n = 0; n < FEATURE_STATES; n++) {
      lack.value[n] += entry[n] * difference_of(s, n, s->nq + j);
      lack.bound[n] += fabsl(entry[n]) * bound_of(s, n, s->nq + j);
    }
    uint32_t first = terms.n;
    add_terms(s, expr_neg(s->g, M), &terms);
    for (uint32_t k = first; k < terms.n; k++)
      terms.at[k] = expr_mul(s->g, terms.at[k], expr_symbol(s->g, s->m->coords.at[j].a)->node);
  }
  return vanishes(&lack) ? "" : changed_term(s, &terms, &lack);
}

/* The function's q''_i is the derived one times a monomial of parameters; "": no difference. */
static const char *cause_in_factor(CauseSearch *s, uint32_t i) {
  Real ratio[FEATURE_STATES], value[FEATURE_STATES];
  Lack lack;
  for (uint32_t n = 0; n < FEATURE_STATES; n++) {
    lack.value[n] = difference_of(s, n, s->nq + i);
    lack.bound[n] = bound_of(s, n, s->nq + i);
    ratio[n] = s->d->rate[n][s->nq + i] / (s->d->rate[n][s->nq + i] - lack.value[n]);
  }
  if (vanishes(&lack)) return "";
  Monomial factor = features_fit(s->features, ratio);
  if (!factor.e || !expr_is_constant(s->g, factor.e)) return NULL;
  values_of(s, factor.e, value);
  for (uint32_t n = 0; n < FEATURE_STATES; n++)
    if (!fits((value[n] - 1) * (s->d->rate[n][s->nq + i] - lack.value[n]), lack.value[n], lack.bound[n])) return NULL;
  if (is_minus_one(s, factor.e)) return "the sign is the opposite one";
  return arena_printf(s->arena, "there is a factor `%s` too many", expr_text(s->g, factor.e));
}

/* q''_i = N/det M of two coupled equations: a term of the numerator N, or (`below`) of the determinant. */
static const char *cause_in_solution(CauseSearch *s, uint32_t i, int below) {
  uint32_t j = 1 - i;
  Expr own = eqns_mass(s->e, i, i), other = eqns_mass(s->e, j, j), cross = eqns_mass(s->e, i, j);
  Expr det = expr_sub(s->g, expr_mul(s->g, own, other), expr_mul(s->g, cross, cross));
  Expr first = expr_mul(s->g, other, s->e->f[i]), second = expr_mul(s->g, cross, s->e->f[j]),
       numerator = expr_sub(s->g, first, second);
  Exprs terms = {0};
  Real divisor[FEATURE_STATES], above[FEATURE_STATES];
  Lack lack = {.solved = 3};
  add_terms(s, below ? det : numerator, &terms);
  values_of(s, det, divisor);
  values_of(s, numerator, above);
  for (uint32_t n = 0; n < FEATURE_STATES; n++) {
    Real rate = s->d->rate[n][s->nq + i];
    lack.value[n] = below ? above[n] / rate - divisor[n] : divisor[n] * difference_of(s, n, s->nq + i);
    lack.bound[n] = fabsl(below ? above[n] / (rate * rate) : divisor[n]) * bound_of(s, n, s->nq + i);
  }
  return vanishes(&lack) ? "" : changed_term(s, &terms, &lack);
}

static const char *cause_in_rate(CauseSearch *s, uint32_t i) {
  Exprs terms = {0};
  Lack lack = {.solved = 0};
  add_terms(s, s->e->flow[i], &terms);
  for (uint32_t n = 0; n < FEATURE_STATES; n++) {
    lack.value[n] = difference_of(s, n, 2 * s->nq + i);
    lack.bound[n] = bound_of(s, n, 2 * s->nq + i);
  }
  return vanishes(&lack) ? "" : changed_term(s, &terms, &lack);
}

/* Adds "in the equation of th1 CAUSE", and returns 1; 0: the cause is not known. "": no difference. */
static int add_cause(StrBuf *b, const char *where, const char *name, const char *cause) {
  if (cause && *cause) sb_printf(b, "%sin %s%s %s", b->n ? "; " : "", where, name, cause);
  return cause != NULL;
}

enum { IN_FACTOR, IN_EQUATION, IN_DETERMINANT, IN_NUMERATOR };

/* Causes of this kind in all accelerations that differ; NULL: one of them is not known. */
static const char *cause_in_accelerations(CauseSearch *s, int kind) {
  static const char *const where[] = {"", "the equation of ", "det M of ", "the numerator over det M of "};
  StrBuf b = strbuf(s->arena);
  int known = 1;
  for (uint32_t i = 0; i < s->nq && known; i++) {
    const Coord *q = &s->m->coords.at[i];
    const char *cause = kind == IN_FACTOR     ? cause_in_factor(s, i)
                        : kind == IN_EQUATION ? cause_in_equation(s, i)
                                              : cause_in_solution(s, i, kind == IN_DETERMINANT);
    known = add_cause(&b, where[kind], kind == IN_EQUATION ? q->name : expr_symbol(s->g, q->a)->name, cause);
  }
  return known && b.n ? sb_text(&b) : NULL;
}

static const char *cause_in_terms(CauseSearch *s) {
  StrBuf b = strbuf(s->arena);
  const char *cause = NULL;
  for (uint32_t i = 0; i < s->m->states.n; i++)
    if (!add_cause(&b, "the rate of ", s->m->states.at[i].name, cause_in_rate(s, i))) return NULL;
  if (b.n || !s->nq) return b.n ? sb_text(&b) : NULL; /* a rate before the accelerations that may contain the state */
  if (s->nq > 1) cause = cause_in_accelerations(s, IN_FACTOR);
  for (int kind = IN_EQUATION; kind <= (s->nq == 2 ? IN_NUMERATOR : IN_EQUATION) && !cause; kind++)
    cause = cause_in_accelerations(s, kind);
  return cause;
}

/* dydt has something else where a velocity is due: another component of y. "": all velocities are right. */
static const char *cause_in_velocities(CauseSearch *s) {
  for (uint32_t i = 0; i < s->nq; i++) {
    uint32_t wrong = 0, place = 0;
    for (uint32_t n = 0; n < s->d->n; n++) wrong += !(fabsl(difference_of(s, n, i)) <= bound_of(s, n, i));
    if (!wrong) continue;
    while (s->d->map[place] != i) place++;
    for (uint32_t j = 0; j < s->y.n; j++) {
      uint32_t equal = 0;
      for (uint32_t n = 0; n < s->d->n; n++) equal += s->d->state[n][s->y.at[j]] == s->d->rate[n][i];
      if (equal == s->d->n)
        return arena_printf(s->arena, "it has `dydt[%u] = %s` in place of `%s`", place,
                            expr_symbol(s->g, s->y.at[j])->name, expr_symbol(s->g, s->m->coords.at[i].v)->name);
    }
    return NULL;
  }
  return "";
}

/* ---- quantities of the model ---- */

/* Symbols, sines and cosines of the equations, then those of other combinations of two angles. */
static const Features *gather_features(CauseSearch *s) {
  const unsigned quantities = 1u << SYM_PARAM | 1u << SYM_COORD | 1u << SYM_VEL | 1u << SYM_STATE | 1u << SYM_TIME |
                              1u << SYM_INPUT | 1u << SYM_ACC;
  const int combine[][2] = {{1, 0}, {0, 1}, {1, -1}, {1, 1}, {1, -2}, {2, -1}, {2, -2}};
  const Model *m = s->m;
  Exprs roots = {0};
  FeaturePool pool = {.g = s->g};
  for (uint32_t i = 0; i < s->nq; i++) vec_push(s->arena, &roots, simplify(s->g, s->e->f[i]));
  for (uint32_t i = 0; i < s->e->mass.n; i++) vec_push(s->arena, &roots, simplify(s->g, s->e->mass.at[i].e));
  for (uint32_t i = 0; i < m->states.n; i++) vec_push(s->arena, &roots, s->e->flow[i]);
  ExprList nodes = expr_topo(s->g, roots.at, roots.n);
  pool_nodes(&pool, nodes, POOL_SYMBOLS, quantities);
  for (uint32_t i = 0; i < s->nq; i++) pool_add(&pool, expr_symbol(s->g, m->coords.at[i].v)->node);
  pool_nodes(&pool, nodes, POOL_ANGLES, 0);
  pool_nodes(&pool, nodes, POOL_COMPOUNDS, 0);
  for (uint32_t i = 0; i < s->nq; i++) pool_add(&pool, expr_symbol(s->g, m->coords.at[i].a)->node);
  for (uint32_t k = 0; k < sizeof combine / sizeof *combine && s->nq == 2; k++) {
    Expr a = expr_symbol(s->g, m->coords.at[0].q)->node, b = expr_symbol(s->g, m->coords.at[1].q)->node;
    if (!m->coords.at[0].periodic || !m->coords.at[1].periodic) break;
    Expr x = expr_scale(s->g, num_int(combine[k][0]), a), y = expr_scale(s->g, num_int(combine[k][1]), b);
    Expr angle = expr_add(s->g, x, y);
    pool_angle(&pool, angle);
  }
  return features_new(s->g, pool.at, pool.n, s->state);
}

/* ---- the search ---- */

const char *difference_cause(const Eqns *e, const DifferenceData *d) {
  enum { COORDINATES_MAX = 12 };
  const Model *m = e->m;
  CauseSearch s = {
      .e = e, .m = m, .g = e->g, .arena = m->arena, .d = d, .y = sample_state_symbols(d->points), .nq = m->coords.n};
  uint32_t count = expr_symbol_count(e->g) + 1;
  if (d->n < FEATURE_STATES || (m->coords.n && !e->mass_known) || m->coords.n > COORDINATES_MAX) return NULL;
  for (uint32_t n = 0; n < d->n; n++)
    for (uint32_t i = 0; i < s.y.n; i++)
      if (!isfinite(d->rate[n][i])) return NULL;
  s.solver = states_new(e);
  s.trial = ARENA_ARRAY(s.arena, Real, count);
  const char *cause = cause_order(&s);
  if (!cause) cause = cause_parameters(&s);
  if (!cause) cause = cause_in_velocities(&s);
  if (!cause || *cause || e->constraints.n) return cause && *cause ? cause : NULL;
  for (uint32_t n = 0; n < FEATURE_STATES; n++) {
    s.state[n] = ARENA_ARRAY(s.arena, Real, count);
    memcpy(s.state[n], d->state[n], count * sizeof(Real));
    for (uint32_t i = 0; i < s.nq; i++) s.state[n][m->coords.at[i].a] = d->rate[n][s.nq + i];
    for (uint32_t i = 0; i < m->states.n; i++) s.state[n][m->states.at[i].rate] = d->rate[n][2 * s.nq + i];
  }
  s.features = gather_features(&s);
  return cause_in_terms(&s);
}
