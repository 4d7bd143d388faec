/* Fits each bracket to the charges at random states for every choice of parameter values, recognises the
 * coefficients as expressions, and proves the combination against the symbolic bracket. */
#include "symmetry/poisson_brackets.h"

#include <math.h>

#include "base/dense_matrix.h"
#include "mech/lagrange.h"
#include "symmetry/number_recognition.h"
#include "sym/diff.h"
#include "sym/expr_eval.h"
#include "sym/prove.h"
#include "sym/simplify.h"
#include "sym/sum_nest.h"

enum { CHARGES_MOST = 48, SPARE_STATES = 6 };

typedef struct {
  Eqns *e;
  ExprGraph *g;
  Arena *scratch;
  const FoundSymmetries *of;
  uint32_t n, r, pairs; /* numbers of coordinates, charges, pairs of charges */
  const SymId *q, *v;   /* [n] */
  uint32_t energy;      /* number of the energy if no bracket contains it, see energy_apart; r: there is none such */
  EvalTape *tape;       /* [r] charges, [r*n] dQ/dq, [r*n] dQ/dv, [r] with_energy, entries of M or omega, of dp/dq */
  uint32_t roots;
  double turns;         /* of the quantified sums on the tape */
  Entries form, slope;  /* of M or omega; of dp/dq: those that are not 0 */
  int is_diagonal;      /* form */
  Choices choices;
  long double **fits;   /* [choice][pairs*(r + 1)] coefficients; NULL: not computed yet, see fit_at */
  VEC(Expr) rates;      /* of the charges that have one */
  Expr *slopes;         /* [r*2n] dA/dp, then dA/dq of each charge */
  SearchLimit *limit;
  Algebra *out;
} BracketFit;

static const FoundSymmetry *at(const BracketFit *w, uint32_t a) { return &w->of->all.at[a]; }
static Expr node(const BracketFit *w, SymId s) { return expr_symbol(w->g, s)->node; }

/* --- in numbers --- */

static int is_energy(const BracketFit *w, uint32_t a) {
  return at(w, a)->kind == SYMMETRY_ENERGY && expr_is_zero(w->g, at(w, a)->is.power);
}

/* {Q, E} of a conserved E is minus the explicit time derivative of Q, as Q is already proved conserved. */
static Expr with_energy(const BracketFit *w, uint32_t a) {
  return expr_neg(w->g, expr_diff(w->g, at(w, a)->is.charge, w->e->m->time));
}

/* The conserved energy, where all other generators leave time alone, as their commutators then do: {Q, E} is known,
 * and no bracket contains E, whose values take all pairs of bodies. */
static uint32_t energy_apart(const BracketFit *w) {
  uint32_t energy = w->r;
  for (uint32_t a = 0; a < w->r; a++) {
    if (!expr_is_zero(w->g, at(w, a)->is.power)) return w->r;
    if (is_energy(w, a) && energy == w->r) energy = a;
    else if (!expr_is_zero(w->g, at(w, a)->by.tau)) return w->r;
  }
  return energy;
}

/* The entries of M, or omega of a first-order L, and of dp/dq. */
static void put_entries(BracketFit *w) {
  const Entries *form = w->e->n ? &w->e->mass : &w->e->first.form;
  w->is_diagonal = w->e->n > 0;
  for (uint32_t k = 0; k < form->n; k++) {
    MassEntry x = form->at[k];
    vec_push(w->scratch, &w->form, x);
    if (x.row == x.col) continue;
    w->is_diagonal = 0;
    if (w->e->n) vec_push(w->scratch, &w->form, ((MassEntry){x.col, x.row, x.e}));
  }
  for (uint32_t i = 0; i < w->n && w->e->n; i++) {
    ExprPartials by_q = expr_gradient_sparse(w->g, w->e->p[i], SYM_COORD, w->n);
    for (uint32_t k = 0; k < by_q.n; k++)
      vec_push(w->scratch, &w->slope, ((MassEntry){i, by_q.at[k].index, by_q.at[k].e}));
  }
}

static void make_tape(BracketFit *w) {
  put_entries(w);
  size_t n = w->n, r = w->r, count = 0;
  Expr *roots = ARENA_ARRAY(w->scratch, Expr, 2 * r * (n + 1) + w->form.n + w->slope.n + 1);
  const SymId *by[2] = {w->q, w->v};
  for (uint32_t a = 0; a < r; a++) roots[count++] = a == w->energy ? 0 : at(w, a)->is.charge;
  for (int k = 0; k < 2; k++)
    for (uint32_t a = 0; a < r; a++, count += n)
      if (a != w->energy) expr_gradient(w->g, at(w, a)->is.charge, by[k], w->n, roots + count);
  for (uint32_t a = 0; a < r; a++) roots[count++] = w->energy < r ? with_energy(w, a) : 0;
  for (uint32_t k = 0; k < w->form.n; k++) roots[count++] = w->form.at[k].e;
  for (uint32_t k = 0; k < w->slope.n; k++) roots[count++] = w->slope.at[k].e;
  w->roots = (uint32_t)count;
  ExprList l = expr_topo(w->g, roots, w->roots);
  for (uint32_t k = 0; k < l.n; k++)
    if (expr_op(w->g, l.at[k]) == EX_NEST) w->turns += (double)expr_sum_turns(w->g, l.at[k]);
  w->tape = eval_tape(w->g, roots, w->roots);
}

/* Replaces dQ/dv, [r*n], by M^-1 dQ/dv. 0: M (or omega) has no inverse. */
static int divide_by_form(const BracketFit *w, const long double *entries, long double *by_v) {
  size_t n = w->n;
  long double *form = ARENA_ARRAY(w->scratch, long double, (w->is_diagonal ? n : n * n) + 1);
  for (uint32_t k = 0; k < w->form.n; k++)
    form[w->is_diagonal ? w->form.at[k].row : w->form.at[k].row * n + w->form.at[k].col] = entries[k];
  if (!w->is_diagonal) return dense_solve_rows(w->scratch, w->n, form, w->r, by_v);
  for (size_t i = 0; i < n; i++) {
    if (form[i] == 0) return 0;
    for (size_t a = 0; a < w->r; a++) by_v[a * n + i] /= form[i];
  }
  return 1;
}

/* Replaces the derivatives by q and v with those in phase space. 0: M (or omega) has no inverse. */
static int to_phase_space(const BracketFit *w, long double *out) {
  size_t n = w->n, r = w->r;
  long double *by_q = out + r, *by_v = by_q + r * n, *form = by_v + r * n + r, *slope = form + w->form.n;
  ArenaMark before = arena_mark(w->scratch);
  if (!w->e->n) memcpy(by_v, by_q, r * n * sizeof *by_v);
  int has_inverse = divide_by_form(w, form, by_v);
  arena_forget(w->scratch, before);
  for (size_t a = 0; a < r && has_inverse; a++)
    for (uint32_t k = 0; k < w->slope.n; k++)
      by_q[a * n + w->slope.at[k].col] -= by_v[a * n + w->slope.at[k].row] * slope[k];
  return has_inverse;
}

/* Brackets [pairs] at a state from derivatives in phase space; size[pairs] keeps the largest products of derivatives
 * so far, the measure for rounding. */
static void all_brackets(const BracketFit *w, const long double *out, long double *to, long double *size) {
  size_t n = w->n, r = w->r;
  const long double *by_q = out + r, *by_p = by_q + r * n, *with_E = by_p + r * n;
  long double *most = ARENA_ARRAY(w->scratch, long double, 2 * r);
  for (size_t a = 0; a < 2 * r; a++) most[a] = dense_largest(by_q + a * n, n);
  for (size_t a = 0; a < r; a++)
    for (size_t b = a + 1; b < r; b++, to++, size++) {
      const long double *aq = by_q + a * n, *bq = by_q + b * n, *ap = by_p + a * n, *bp = by_p + b * n;
      long double now = most[a] * most[r + b] + most[r + a] * most[b];
      *to = 0;
      for (size_t i = 0; i < n; i++) *to += aq[i] * bp[i] - (w->e->n ? ap[i] * bq[i] : 0);
      if (b == w->energy) *to = with_E[a], now = fabsl(*to);
      if (a == w->energy) *to = -with_E[b], now = fabsl(*to);
      *size = fmaxl(*size, now);
    }
}

typedef struct {
  uint32_t states;
  long double *charges;  /* [states*(r + 1)] charges and a 1 behind them, divided by scale */
  long double *brackets; /* [states*pairs] */
  long double *scale;    /* [r + 1] largest magnitude of each charge */
  long double *size;     /* [pairs] see all_brackets */
} Sample;

static Sample sample_new(const BracketFit *w, uint32_t states) {
  size_t m = w->r + 1;
  return (Sample){states, ARENA_ARRAY(w->scratch, long double, states *m),
                  ARENA_ARRAY(w->scratch, long double, (size_t)states * w->pairs + 1),
                  ARENA_ARRAY(w->scratch, long double, m), ARENA_ARRAY(w->scratch, long double, w->pairs + 1)};
}

/* Scales each charge to largest magnitude 1. */
static void scale_charges(const BracketFit *w, Sample *x) {
  size_t m = w->r + 1;
  for (size_t k = 0; k < m; k++) {
    for (size_t s = 0; s < x->states; s++) x->scale[k] = fmaxl(x->scale[k], fabsl(x->charges[s * m + k]));
    if (x->scale[k] == 0) x->scale[k] = 1;
    for (size_t s = 0; s < x->states; s++) x->charges[s * m + k] /= x->scale[k];
  }
}

/* Evaluates all roots at a random state, bodies in a row at distances of 4 or so where `in_row`; returns the largest
 * derivative, infinite where a root is not finite. */
static long double draw_one(const BracketFit *w, uint32_t choice, uint32_t seed, int in_row, long double *symbols,
                            long double *out) {
  sample_state(w->g, 50 + seed + (in_row ? 1000 : 0), symbols);
  for (uint32_t i = 0; i < w->n && in_row; i++) symbols[w->q[i]] += 4 * (long double)i - 2 * (long double)w->n;
  for (uint32_t k = 0; k < w->choices.n; k++)
    symbols[w->choices.param[k]] = w->choices.at[choice][w->choices.param[k]];
  eval_run(w->tape, symbols, out);
  for (uint32_t k = 0; k < w->roots; k++)
    if (!isfinite(out[k])) return HUGE_VALL;
  return dense_largest(out + w->r, (size_t)w->r * w->n);
}

/* Whether the states have the bodies in a row: of many at random places some nearly touch, and the rounding of their
 * forces would drown the other charges. The first states decide. */
static int is_row_better(const BracketFit *w, uint32_t choice, long double *symbols, long double *out) {
  if (w->n <= 16) return 0;
  long double at_random = draw_one(w, choice, 1, 0, symbols, out);
  return draw_one(w, choice, 1, 1, symbols, out) < at_random;
}

/* Evaluates charges and brackets at random states. 0: too few states have finite values. */
static int draw_sample(const BracketFit *w, uint32_t choice, Sample *x) {
  uint32_t count = expr_symbol_count(w->g) + 1, done = 0;
  long double *symbols = ARENA_ARRAY(w->scratch, long double, count),
              *out = ARENA_ARRAY(w->scratch, long double, w->roots + 1);
  double n = w->n, work = w->form.n > 8 * w->n ? n * n * n : 0; /* elimination skips zeros */
  int in_row = is_row_better(w, choice, symbols, out);
  for (uint32_t seed = 1; done < x->states && seed < 20 + 4 * x->states; seed++) {
    if (!search_goes_on(w->limit, work)) return 0;
    if (draw_one(w, choice, seed, in_row, symbols, out) == HUGE_VALL || !to_phase_space(w, out)) continue;
    memcpy(x->charges + (size_t)done * (w->r + 1), out, w->r * sizeof *out);
    x->charges[(size_t)done * (w->r + 1) + w->r] = 1;
    all_brackets(w, out, x->brackets + (size_t)done * w->pairs, x->size);
    done++;
  }
  scale_charges(w, x);
  return done == x->states;
}

/* Checks coefficients c[r + 1] of one bracket, which the first states gave, at the others. NAN: the bracket is no
 * combination of charges. */
static void check_fit(const BracketFit *w, const Sample *x, size_t pair, long double *c) {
  uint32_t m = w->r + 1;
  long double worst = 0;
  for (size_t s = m; s < x->states; s++) {
    long double left = x->brackets[s * w->pairs + pair];
    for (uint32_t k = 0; k < m; k++) left -= c[k] * x->charges[s * m + k];
    worst = fmaxl(worst, fabsl(left));
  }
  for (uint32_t k = 0; k < m; k++)
    if (worst > 1e-8L * x->size[pair]) c[k] = NAN;
    else c[k] = fabsl(c[k]) < 1e-10L * x->size[pair] ? 0 : c[k] / x->scale[k];
}

/* Coefficients of all brackets, [pairs*(r + 1)]; NAN where a bracket is no combination. 0: they cannot be had. */
static int fit(const BracketFit *w, uint32_t choice, long double *c) {
  uint32_t m = w->r + 1;
  Sample x = sample_new(w, m + SPARE_STATES);
  enum { TURN = 40 }; /* operations of one turn of a sum */
  if (!search_goes_on(w->limit, TURN * w->turns * (x.states + 2)) || !draw_sample(w, choice, &x)) return 0;
  if (w->energy < w->r) x.charges[w->energy * m + w->energy] = 1; /* an energy apart keeps what is left there: 0 */
  for (size_t pair = 0; pair < w->pairs; pair++)
    for (size_t s = 0; s < m; s++) c[pair * m + s] = x.brackets[s * w->pairs + pair];
  if (!dense_solve_rows(w->scratch, m, x.charges, w->pairs, c)) return 0;
  for (size_t pair = 0; pair < w->pairs; pair++) check_fit(w, &x, pair, c + pair * m);
  return 1;
}

/* --- symbolically --- */

static Expr *slopes_of(const BracketFit *w, uint32_t a) { return w->slopes + 2 * (size_t)w->n * a; }

/* dA/dp_i and dA/dq_i at fixed p, A the charge number a. */
static void put_slopes(const BracketFit *w, uint32_t a) {
  ExprGraph *g = w->g;
  Expr *by_p = slopes_of(w, a), *by_q = by_p + w->n;
  const Generator *by = &at(w, a)->by;
  expr_gradient(g, at(w, a)->is.F, w->q, w->n, by_q);
  for (uint32_t i = 0; i < w->n; i++) {
    Expr rate = w->e->n ? node(w, w->v[i]) : w->e->first.rates[i], moved = expr_mul(g, by->tau, rate);
    by_p[i] = expr_sub(g, by->xi[i], moved);
    by_q[i] = w->e->n ? expr_sub(g, expr_mul(g, by->tau, w->e->dLdq[i]), by_q[i]) : expr_int(g, 0);
  }
  for (uint32_t k = 0; k < w->n && w->e->n; k++) {
    ExprPartials of_xi = expr_gradient_sparse(g, by->xi[k], SYM_COORD, w->n);
    for (uint32_t x = 0; x < of_xi.n; x++) {
      Expr *to = &by_q[of_xi.at[x].index], part = expr_mul(g, w->e->p[k], of_xi.at[x].e);
      *to = expr_add(g, *to, part);
    }
  }
}

static Expr symbolic(const BracketFit *w, uint32_t a, uint32_t b) {
  ExprGraph *g = w->g;
  Expr *ap = slopes_of(w, a), *aq = ap + w->n, *bp = slopes_of(w, b), *bq = bp + w->n;
  Expr *terms = ARENA_ARRAY(w->scratch, Expr, w->n + 1);
  if (is_energy(w, b) && expr_is_zero(g, at(w, a)->is.power)) return with_energy(w, a);
  if (is_energy(w, a) && expr_is_zero(g, at(w, b)->is.power)) return expr_neg(g, with_energy(w, b));
  if (!w->e->n) { /* minus the change of B under A */
    bq = ARENA_ARRAY(w->scratch, Expr, w->n + 1);
    expr_gradient(g, at(w, b)->is.charge, w->q, w->n, bq);
    for (uint32_t i = 0; i < w->n; i++) terms[i] = expr_neg(g, expr_mul(g, bq[i], ap[i]));
    return expr_add_n(g, terms, w->n);
  }
  for (uint32_t i = 0; i < w->n; i++) {
    Expr one = expr_mul(g, aq[i], bp[i]), other = expr_mul(g, ap[i], bq[i]);
    terms[i] = expr_sub(g, one, other);
  }
  return expr_add_n(g, terms, w->n);
}

/* --- the brackets --- */

static uint32_t choices(const BracketFit *w) { return 2 + w->choices.n; }

/* The coefficients at a choice, computed once; NULL: they cannot be had, see why_not. */
static const long double *fit_at(BracketFit *w, uint32_t choice) {
  if (w->out->why_not) return NULL;
  if (w->fits[choice]) return w->fits[choice];
  if (choice == CHOICE_MOVED) w->choices = choices_new(w->scratch, w->e, w->of->attempt, 1);
  w->fits[choice] = ARENA_ARRAY(w->scratch, long double, (size_t)w->pairs * (w->r + 1) + 1);
  if (fit(w, choice, w->fits[choice])) return w->fits[choice];
  w->out->why_not = w->limit->stopped ? search_stop_text(w->limit)
                                      : "the charges depend on one another, or M has no inverse at random states";
  return NULL;
}

/* x := the coefficient at the first n choices; 0: it has no value at one. */
static int coefficient(BracketFit *w, size_t place, uint32_t n, long double *x) {
  for (uint32_t k = 0; k < n; k++) {
    const long double *c = fit_at(w, k);
    if (!c || isnan(x[k] = c[place])) return 0;
  }
  return 1;
}

/* A coefficient from its values: numbers, ratios and powers of parameters and rates of the charges by two choices; sums
 * of parameters and other powers by all; 0: not recognised. */
static Expr recognise(BracketFit *w, size_t place) {
  long double *x = ARENA_ARRAY(w->scratch, long double, choices(w));
  Expr known = 0;
  if (!coefficient(w, place, CHOICE_MOVED, x)) return 0;
  known = recognise_by_two(&w->choices, x, w->rates.at, w->rates.n);
  if (known || !coefficient(w, place, choices(w), x)) return known;
  known = recognise_linear(&w->choices, x);
  return known ? known : recognise_monomial(&w->choices, x);
}

/* The constant of a bracket, its difference from the combination of charges: by simplification, or recognised and
 * then proved. */
static void find_bracket_constant(BracketFit *w, Bracket *k, size_t place) {
  ExprGraph *g = w->g;
  Expr sum = expr_int(g, 0), left;
  for (uint32_t i = 0; i < w->r; i++) sum = expr_add(g, sum, expr_mul(g, k->c[i], at(w, i)->is.charge));
  left = expr_sub(g, k->value, sum);
  if (!expr_is_constant(g, left)) left = simplify(g, left);
  k->constant = left;
  k->proved = expr_is_constant(w->g, left);
  if (k->proved) return;
  k->constant = recognise(w, place + w->r);
  if (k->constant) k->proved = prove_zero(g, expr_sub(g, left, k->constant), NULL) == PROVED_ZERO;
  else k->c = NULL;
}

/* Whether the fit has failed at every choice; failures at some are rounding and prove nothing. */
static int is_outside(BracketFit *w, size_t place) {
  for (uint32_t k = 0; k < choices(w); k++) {
    const long double *c = fit_at(w, k);
    if (!c || !isnan(c[place])) return 0;
  }
  return 1;
}

/* The bracket with its coefficients; c NULL: one is not recognised. */
static Bracket combined(BracketFit *w, Bracket k, size_t place) {
  Expr *c = ARENA_ARRAY(w->e->m->arena, Expr, w->r + 1);
  k.c = c;
  for (uint32_t i = 0; i < w->r && k.c; i++)
    if (!(c[i] = recognise(w, place + i))) k.c = NULL;
  if (k.c) find_bracket_constant(w, &k, place);
  return k;
}

static Bracket bracket_of(BracketFit *w, uint32_t a, uint32_t b, size_t place) {
  Bracket k = {.a = a,
               .b = b,
               .constant = expr_int(w->g, 0),
               .value = symbolic(w, a, b),
               .is_outside = is_outside(w, place)};
  Bracket known = combined(w, k, place);
  if (known.c) return known;
  k.value = simplify(w->g, k.value);
  if (!expr_is_zero(w->g, k.value)) return k;
  Expr *c = ARENA_ARRAY(w->e->m->arena, Expr, w->r + 1);
  for (uint32_t i = 0; i < w->r; i++) c[i] = k.value; /* all 0: rounding spoilt the fit */
  k.c = c;
  k.constant = k.value;
  k.proved = 1;
  return k;
}

/* Whether a bracket is 0. */
static int is_null(const BracketFit *w, const Bracket *k) {
  for (uint32_t i = 0; k->c && i < w->r; i++)
    if (!expr_is_zero(w->g, k->c[i])) return 0;
  return k->c && expr_is_zero(w->g, k->constant);
}

static void compute_brackets(Arena *scratch, void *data) {
  BracketFit *w = data;
  w->scratch = scratch;
  w->choices = choices_new(scratch, w->e, w->of->attempt, 0);
  w->energy = energy_apart(w);
  make_tape(w);
  w->slopes = ARENA_ARRAY(scratch, Expr, 2 * (size_t)w->n * w->r + 1);
  for (uint32_t a = 0; a < w->r; a++) put_slopes(w, a);
  for (uint32_t a = 0; a < w->r; a++)
    if (at(w, a)->rate) vec_push(scratch, &w->rates, at(w, a)->rate);
  w->fits = ARENA_ARRAY(scratch, long double *, choices(w));
  size_t place = 0;
  for (uint32_t a = 0; a < w->r; a++)
    for (uint32_t b = a + 1; b < w->r; b++, place += w->r + 1) {
      if (!search_goes_on(w->limit, 0)) w->out->why_not = search_stop_text(w->limit);
      Bracket k = fit_at(w, CHOICE_FIRST) ? bracket_of(w, a, b, place) : (Bracket){0};
      if (w->out->why_not) return;
      w->out->by_value += !k.proved;
      if (!is_null(w, &k)) vec_push(w->e->m->arena, &w->out->all, k);
    }
}

static const char *reason_against(const Eqns *e, uint32_t r) {
  if (e->constraints.n) return "the model has constraints, which need Dirac brackets";
  if (!e->n && (e->m->forces.n || e->m->dissipation))
    return "L is linear in velocities, and forces change the two-form of the brackets";
  if (e->m->states.n && e->n) return "the model has states beside its coordinates";
  if (r > CHARGES_MOST) return arena_printf(e->m->arena, "there are more than %d charges", CHARGES_MOST);
  return NULL;
}

Algebra brackets_find(Eqns *e, const FoundSymmetries *of, SearchLimit *limit) {
  Algebra out = {.n = of->all.n, .why_not = reason_against(e, of->all.n)};
  BracketFit w = {.e = e,
                  .g = e->g, .of = of, .n = eqns_coordinates(e), .r = of->all.n,
                  .pairs = of->all.n * (of->all.n - 1) / 2, .out = &out,
                  .limit = limit};
  search_stage(limit, 1, "Poisson brackets");
  limit->stopped = 0;
  if (out.why_not || of->all.n < 2) return out;
  if (e->n && !e->mass_known) eqns_derive_mass(e);
  w.q = eqns_symbols(e, 0);
  w.v = eqns_symbols(e, 1);
  arena_with_scratch(expr_arena(e->g), compute_brackets, &w);
  return out;
}
