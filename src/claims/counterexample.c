/* Draws states, completes them by constraints and M q'' = f, compares both sides with running bounds on rounding,
 * and writes the first difference with as few digits as still show it. */
#include "claims/counterexample.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "claims/branch_coverage.h"
#include "claims/state_error_bounds.h"
#include "mech/states.h"
#include "sym/prove.h"

typedef long double Real;

enum { FULL_DIGITS = 18 };

/* A symbol that states give a value, and how it is printed. */
typedef struct {
  SymId sym;
  const Unit *unit;
  int rate, shown;
} FreeSymbol;

typedef struct {
  const Eqns *e;
  const Model *m;
  ExprGraph *g;
  Expr left, right, gap, domain; /* gap: left minus right, simplified; domain 0: everywhere */
  BoundTape *tape;
  StateSolver *solver;
  StateErrorBounds *inside; /* bounds for what is solved for; NULL: the sides contain nothing of it */
  VEC(FreeSymbol) free;
  EvalTape *defaults, *given; /* values of parameters; of those that follow from others */
  VEC(SymId) with_default, followers;
  Real *symbols, *errors, *kept, *out;
  Real l, r, d;
  int states, digits; /* states compared so far; digits to which the sides agree at ordinary ones */
  int ordinary;       /* the current state is of ordinary size */
  BranchCoverage *sides;
} CounterexampleSearch;

/* --- one state --- */

static void put_params(CounterexampleSearch *s, EvalTape *values, const SymId *of, uint32_t n) {
  eval_run(values, s->symbols, s->out);
  for (uint32_t i = 0; i < n; i++) s->symbols[of[i]] = s->out[i];
}

static int holds(const CounterexampleSearch *s, Expr condition) {
  Real bound;
  return !condition || (bound_value(s->tape, condition, &bound) != 0 && bound == 0);
}

/* Sum of the magnitudes of a side's terms. */
static Real size_of(const CounterexampleSearch *s, Expr side) {
  Real size = 0, bound;
  for (ExprPair term = {0}; expr_next_pair(s->g, side, EX_SUM, &term);)
    size += fabsl((Real)num_value(term.num) * bound_value(s->tape, term.of, &bound));
  return size;
}

static int certain(Real value, Real bound) {
  return isfinite(value) && isfinite(bound) && fabsl(value) > 16 * bound + LDBL_MIN;
}

/* Completes the state and compares the sides; 1: both are defined and differ. */
static int differs(CounterexampleSearch *s) {
  const Real noise = 1e-9L; /* relative to the terms: 6 digits and more are compared */
  put_params(s, s->given, s->followers.at, s->followers.n);
  if (!states_complete(s->solver, s->symbols)) return 0;
  if (s->inside && !state_error_bounds_at(s->inside, s->solver, s->symbols, s->errors)) return 0;
  bound_run(s->tape, s->symbols, s->errors);
  Real off_l, off_r, off_d;
  s->l = bound_value(s->tape, s->left, &off_l);
  s->r = bound_value(s->tape, s->right, &off_r);
  s->d = bound_value(s->tape, s->gap, &off_d);
  if (!isfinite(s->l - s->r) || !isfinite(off_l + off_r) || !holds(s, s->domain)) return 0;
  if (certain(s->l - s->r, off_l + off_r) || certain(s->d, off_d)) return 1;
  Real size = size_of(s, s->left) + size_of(s, s->right);
  if (!(off_l + off_r <= noise * size)) return 0;
  int digits = s->l == s->r ? FULL_DIGITS : (int)floorl(-log10l(fabsl(s->l - s->r) / size));
  s->states++;
  branch_coverage_note(s->sides, s->symbols);
  if (s->ordinary && digits < s->digits) s->digits = digits;
  return 0;
}

/* --- states to look at --- */

static void other_params(CounterexampleSearch *s) {
  const Model *m = s->m;
  for (uint32_t i = 0; i < m->params.n; i++) {
    const Symbol *sym = expr_symbol(s->g, m->params.at[i].sym);
    s->symbols[m->params.at[i].sym] = (sign_is_nonpositive(sym->sign) ? -1 : 1) * (Real)(i % 5 + 2);
  }
}

static uint32_t variables_of(const Canonical *c) { return c->is_point ? c->n : 2 * c->n; }

/* The k-th simple state: at rest or moving, at a few angles; the last ones with other parameters. */
static void simple_state(CounterexampleSearch *s, int k) {
  const Model *m = s->m;
  const Real at[] = {1, 0.5L, -0.5L, 2}, moving[] = {1, 2, -1, 0.5L};
  uint32_t shift = (uint32_t)k / 2 % 3;
  s->symbols[m->pi] = acosl(-1);
  put_params(s, s->defaults, s->with_default.at, s->with_default.n);
  if (k >= 6) other_params(s);
  s->symbols[m->time] = k % 2;
  for (uint32_t i = 0; i < m->coords.n; i++) {
    s->symbols[m->coords.at[i].q] = at[(i + shift) % 4];
    s->symbols[m->coords.at[i].v] = k % 2 ? moving[(i + shift) % 4] : 0;
  }
  for (uint32_t i = 0; i < m->states.n; i++) s->symbols[m->states.at[i].z] = at[(i + shift) % 4];
  for (uint32_t i = 0; i < m->inputs.n; i++) s->symbols[m->inputs.at[i].sym] = at[i % 2];
  for (uint32_t i = 0; i < m->canonicals.n; i++)
    for (uint32_t j = 0; j < variables_of(&m->canonicals.at[i]); j++)
      s->symbols[m->canonicals.at[i].fresh[j]] = at[(j + shift) % 4];
}

static void random_state(CounterexampleSearch *s, uint32_t seed) {
  if (seed % 2) sample_state(s->g, seed, s->symbols);
  else sample_state_wide(s->g, seed, s->symbols);
}

/* A state with sizes from 1e-6 to 1e12 of every symbol or, in every second state, of about a third of them. */
static void far_state(CounterexampleSearch *s, uint32_t seed) {
  sample_state(s->g, seed, s->symbols);
  for (uint32_t i = 0; i < s->free.n; i++) {
    SymId sym = s->free.at[i].sym;
    Real choice = (fabsl(sample_symbol(s->g, sym, seed + 7000)) - 0.3L) / 1.7L,
         power = (fabsl(sample_symbol(s->g, sym, seed + 9000)) - 0.3L) / 1.7L;
    if (seed % 2 == 0 && choice > 0.35L) continue;
    s->symbols[sym] *= powl(10, 18 * power - 6);
  }
}

/* A state of whole numbers from -3 to 3, in every second state halves too, of the declared signs. */
static void whole_state(CounterexampleSearch *s, uint32_t seed) {
  sample_state(s->g, seed, s->symbols);
  for (uint32_t i = 0; i < s->free.n; i++) {
    const Symbol *sym = expr_symbol(s->g, s->free.at[i].sym);
    Real part = (fabsl(sample_symbol(s->g, s->free.at[i].sym, seed + 5000)) - 0.3L) / 1.7L,
         x = seed % 2 ? floorl(13 * part) / 2 - 3 : floorl(7 * part) - 3;
    int may_vanish = !sign_is_strict(sym->sign);
    if (sym->sign != SIGN_UNKNOWN) x = (sign_is_nonpositive(sym->sign) ? -1 : 1) * fabsl(x);
    s->symbols[s->free.at[i].sym] = x == 0 && !may_vanish ? (sign_is_nonpositive(sym->sign) ? -1 : 1) : x;
  }
}

/* --- the search --- */

/* Tries states in order: simple ones, which show a difference best, then random, whole and far ones. */
static int find_difference(CounterexampleSearch *s, int quick) {
  enum { SIMPLE = 12, QUICK = 10, RANDOM = 60, FAR = 120, WHOLE = 120 };
  for (int k = 0; k < SIMPLE; k++) {
    simple_state(s, k);
    if (differs(s) && fabsl(s->l - s->r) > 0.01L * (fabsl(s->l) + fabsl(s->r))) return 1;
  }
  s->states = 0;
  s->digits = FULL_DIGITS;
  static const struct {
    void (*draw)(CounterexampleSearch *s, uint32_t seed);
    uint32_t count;
  } kinds[] = {{random_state, RANDOM}, {whole_state, WHOLE}, {far_state, FAR}};
  for (int k = 0; k < (quick ? 1 : 3); k++) {
    s->ordinary = k == 0;
    for (uint32_t seed = 1; seed <= (quick ? QUICK : kinds[k].count); seed++) {
      kinds[k].draw(s, seed);
      if (differs(s)) return 1;
    }
  }
  return 0;
}

/* --- the text of a difference --- */

static Real shown_value(const CounterexampleSearch *s, const FreeSymbol *f) {
  Real offset = f->rate ? 0 : (Real)num_value(f->unit->offset);
  return (s->symbols[f->sym] - offset) / (Real)unit_factor(f->unit);
}

/* Whether the state still shows the difference with values of so many digits, as they are printed. */
static int shows_with(CounterexampleSearch *s, int digits) {
  vec_each(const FreeSymbol, f, s->free) {
    char text[64];
    snprintf(text, sizeof text, "%.*Lg", digits, shown_value(s, f));
    s->symbols[f->sym] =
        strtold(text, NULL) * (Real)unit_factor(f->unit) + (f->rate ? 0 : (Real)num_value(f->unit->offset));
  }
  return differs(s);
}

static int fewest_digits(CounterexampleSearch *s) {
  static const int digits[] = {6, 12, 17};
  size_t bytes = (expr_symbol_count(s->g) + 1) * sizeof *s->symbols;
  memcpy(s->kept, s->symbols, bytes);
  for (int k = 0; k < 3; k++) {
    memcpy(s->symbols, s->kept, bytes);
    if (shows_with(s, digits[k])) return digits[k];
  }
  memcpy(s->symbols, s->kept, bytes);
  differs(s);
  return 21;
}

/* "th1 = 1, th1' = 0, m1 = 1": the coordinates, and other symbols in the sides. */
static const char *state_text(const CounterexampleSearch *s, int digits) {
  StrBuf b = strbuf(s->m->arena);
  vec_each(const FreeSymbol, f, s->free) {
    if (!f->shown) continue;
    sb_printf(&b, "%s%s = %.*Lg", b.n ? ", " : "", expr_symbol(s->g, f->sym)->name, digits, shown_value(s, f));
    if (unit_factor(f->unit) != 1 || (!f->rate && !num_is_zero(f->unit->offset)))
      sb_printf(&b, f->rate ? " [%s/s]" : " [%s]", f->unit->text);
  }
  return sb_text(&b);
}

/* "the left side is -9.81, the right side 9.81 at th1 = 1, ..." */
static const char *difference_text(CounterexampleSearch *s) {
  Arena *a = s->m->arena;
  int digits = fewest_digits(s);
  const char *state = state_text(s, digits);
  for (int i = 0; i < 3; i++) {
    int k = (const int[]){6, 17, 21}[i];
    const char *left = arena_printf(a, "%.*Lg", k, s->l), *right = arena_printf(a, "%.*Lg", k, s->r);
    if (strcmp(left, right) != 0)
      return arena_printf(a, "the left side is %s, the right side %s at %s", left, right, state);
  }
  return arena_printf(a, "the left side is %.6Lg, the right side differs from it by %.6Lg at %s", s->l, -s->d, state);
}

/* --- the symbols of a state --- */

static int in_equations(const Eqns *e, SymId sym) {
  for (uint32_t i = 0; i < e->mass.n; i++)
    if (expr_contains_sym(e->g, e->mass.at[i].e, sym)) return 1;
  for (uint32_t i = 0; i < e->n; i++)
    if (expr_contains_sym(e->g, e->f[i], sym)) return 1;
  return 0;
}

/* Tapes for the values of parameters, and for parameters that follow from others at every state. */
static void gather_params(CounterexampleSearch *s) {
  const Model *m = s->m;
  Arena *a = m->arena;
  VEC(Expr) is = {0}, follows = {0};
  Expr *with = ARENA_ARRAY(a, Expr, expr_symbol_count(s->g) + 1);
  vec_each(const Param, p, m->params) {
    if (!p->value) continue;
    with[p->sym] = expr_substitute(s->g, p->value, with, expr_symbol_count(s->g) + 1, "");
    vec_push(a, &is, with[p->sym]);
    vec_push(a, &s->with_default, p->sym);
    if (!s->e->definitions || !s->e->definitions[p->sym]) continue;
    vec_push(a, &follows, s->e->definitions[p->sym]);
    vec_push(a, &s->followers, p->sym);
  }
  s->defaults = eval_tape(s->g, is.at, is.n);
  s->given = eval_tape(s->g, follows.at, follows.n);
  s->out = ARENA_ARRAY(a, Real, is.n + 1);
}

static int is_in_sides(const CounterexampleSearch *s, SymId sym) {
  return expr_contains_sym(s->g, s->left, sym) || expr_contains_sym(s->g, s->right, sym);
}

/* Lists the symbols that states give values: coordinates, velocities, states, time, inputs, free parameters. */
static void gather_free(CounterexampleSearch *s) {
  enum { FEW_COORDINATES = 4 };
  const Model *m = s->m;
  Arena *a = m->arena;
  Unit *si = ARENA_NEW(a, Unit);
  *si = unit_si(DIM_ANY, "");
  for (int rates = 0; rates < 2; rates++)
    vec_each(const Coord, c, m->coords) {
      SymId sym = rates ? c->v : c->q;
      int shown = m->coords.n <= FEW_COORDINATES || is_in_sides(s, sym);
      vec_push(a, &s->free, ((FreeSymbol){sym, &c->unit, rates, shown}));
    }
  for (uint32_t i = 0; i < m->states.n; i++)
    vec_push(a, &s->free, ((FreeSymbol){m->states.at[i].z, &m->states.at[i].unit, 0, 1}));
  for (uint32_t i = 0; i < m->canonicals.n; i++)
    for (uint32_t j = 0; j < variables_of(&m->canonicals.at[i]); j++) {
      SymId sym = m->canonicals.at[i].fresh[j];
      if (is_in_sides(s, sym)) vec_push(a, &s->free, ((FreeSymbol){sym, si, 0, 1}));
    }
  vec_push(a, &s->free, ((FreeSymbol){m->time, si, 0, is_in_sides(s, m->time)}));
  for (uint32_t i = 0; i < m->inputs.n; i++)
    if (!model_is_contact_switch(m, m->inputs.at[i].sym))
      vec_push(a, &s->free, ((FreeSymbol){m->inputs.at[i].sym, &m->inputs.at[i].unit, 0, 1}));
  /* then M and f matter */
  int moves = ((expr_kinds(s->g, s->left) | expr_kinds(s->g, s->right)) & (1u << SYM_ACC | 1u << SYM_MULTIPLIER)) != 0;
  vec_each(const Param, p, m->params) {
    if (s->e->definitions && s->e->definitions[p->sym]) continue;
    int shown = is_in_sides(s, p->sym) || (moves && in_equations(s->e, p->sym));
    vec_push(a, &s->free, ((FreeSymbol){p->sym, &p->unit, 0, shown}));
  }
}

Counterexample counterexample_find(const Eqns *e, const Expect *x, int quick) {
  Arena *a = e->m->arena;
  ExprGraph *g = e->g;
  uint32_t count = expr_symbol_count(g) + 1;
  CounterexampleSearch s = {.e = e, .m = e->m, .g = g, .digits = FULL_DIGITS, .solver = states_new(e)};
  s.left = states_substitute(e, x->lhs);
  s.right = states_substitute(e, x->rhs);
  s.gap = expr_sub(g, s.left, s.right);
  s.domain = x->domain ? states_substitute(e, x->domain) : 0;
  Expr roots[4] = {s.left, s.right, s.gap, s.domain};
  s.tape = bound_tape(g, roots, 4);
  unsigned kinds = expr_kinds(g, s.left) | expr_kinds(g, s.right);
  if (e->constraints.n || kinds & (1u << SYM_ACC | 1u << SYM_MULTIPLIER)) s.inside = state_error_bounds_new(e);
  s.symbols = ARENA_ARRAY(a, Real, count);
  s.kept = ARENA_ARRAY(a, Real, count);
  s.errors = ARENA_ARRAY(a, Real, count);
  gather_params(&s);
  gather_free(&s);
  s.sides = branch_coverage(g, roots, 2);
  if (find_difference(&s, quick)) return (Counterexample){.text = difference_text(&s)};
  return (Counterexample){.states = s.states, .digits = s.digits, .missing = branch_coverage_missing(s.sides)};
}
