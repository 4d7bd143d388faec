/* A search in depth over the known charges, in their order: the next one that commutes with all chosen and adds to
 * the rank. Brackets are sorted out in numbers at random states, and those that are left are proved when they are
 * needed. The search ends after STEPS_MOST tries, or when its time is spent, and says so. */
#include "symmetry/involution.h"

#include <math.h>

#include "base/dense_matrix.h"
#include "mech/discontinuity.h"
#include "symmetry/charges.h"
#include "phase_space/expression_brackets.h"
#include "symmetry/find_symmetries.h"
#include "sym/diff.h"
#include "sym/expr_eval.h"
#include "sym/prove.h"

enum { KNOWN_MOST = 400, STATES = 4, TRIES = 200, ROTATIONS_MOST = 6, STEPS_MOST = 20000 };

typedef struct {
  InvolutionCharge is;
  Expr value; /* in q, p */
} Known;

typedef struct {
  Eqns *e;
  ExprGraph *g;
  Arena *scratch;
  const FoundSymmetries *found;
  const PolynomialCharges *polynomial;
  SearchLimit *limit;
  PhaseSpace space;
  VEC(Known) known;
  long double *slope;  /* [STATES][known.n][2n] gradients by q, then by p */
  uint8_t *verdict;    /* [known.n^2] Verdict of a bracket, NOT_DECIDED: not asked for yet */
  long double *rows;   /* [known.n + 1][2n] of rank_of */
  Involution *out;
} Search;

/* --- the known charges --- */

/* Whether x has one value for an angle and the angle and a turn, to rounding at random states. */
static int same_after_a_turn(const Search *w, Expr x, SymId angle) {
  const long double turn = 6.28318530717958647692528676655900577L, rounding = 1e-12L;
  long double *symbols = ARENA_ARRAY(w->scratch, long double, expr_symbol_count(w->g) + 1), here, there;
  EvalTape *tape = eval_tape(w->g, &x, 1);
  for (uint32_t seed = 1, done = 0; done < STATES && seed < TRIES; seed++) {
    sample_state(w->g, 900 + seed, symbols);
    eval_run(tape, symbols, &here);
    symbols[angle] += turn;
    eval_run(tape, symbols, &there);
    if (!isfinite(here) || !isfinite(there)) continue;
    if (fabsl(there - here) > rounding * (1 + fabsl(here) + fabsl(there))) return 0;
    done++;
  }
  return 1;
}

/* Whether x is a function on phase space: the same after a turn of each angle, if H is. */
static int is_single_valued(const Search *w, Expr x) {
  for (uint32_t i = 0; i < w->space.n; i++) {
    SymId q = w->space.q[i];
    if (!model_is_periodic(w->e->m, q) || !expr_contains_sym(w->g, x, q)) continue;
    if (!same_after_a_turn(w, x, q) && same_after_a_turn(w, w->space.H, q)) return 0;
  }
  return 1;
}

/* Lists a conserved charge, unless it contains t, is constant, or has several values. */
static void add_known(Search *w, InvolutionCharge is, Expr value) {
  unsigned kinds = expr_kinds(w->g, value);
  if (kinds & 1u << SYM_TIME || expr_is_constant(w->g, value)) return;
  for (uint32_t i = 0; i < w->known.n; i++)
    if (w->known.at[i].value == value) return;
  if (w->known.n >= KNOWN_MOST) w->out->left_out++;
  else if (is_single_valued(w, value)) vec_push(w->scratch, &w->known, ((Known){is, value}));
}

static Expr in_phase_space(const Search *w, Expr x) { return phase_space_expression(&w->space, x); }

/* Whether x is the same number in every state, as (a + b)^2 - a^2 - 2*a*b - b^2: its gradient is rounding alone, and
 * no rank is read off it. */
static int is_same_everywhere(const Search *w, Expr x) {
  for (uint32_t i = 0; i < w->space.n; i++) {
    Expr by_q = expr_diff(w->g, x, w->space.q[i]), by_p = expr_diff(w->g, x, w->space.p[i]);
    if (prove_zero(w->g, by_q, NULL) != PROVED_ZERO || prove_zero(w->g, by_p, NULL) != PROVED_ZERO) return 0;
  }
  return 1;
}

/* A function of the text, where it is conserved: {f, H} = 0, and neither f nor H jumps, as {f, H} has no part from
 * jumps, nor from the rate of an input. */
static void add_declared(Search *w, const char *name, Expr x) {
  if (!search_goes_on(w->limit, 0)) {
    w->out->left_out++;
    return;
  }
  InvolutionCharge is = {.kind = INVOLUTION_DECLARED, .name = name, .charge = x};
  if (!name && expr_op(w->g, x) == EX_DEF) is.name = expr_def_name(w->g, x);
  Expr value = in_phase_space(w, x), rate;
  if (expr_kinds(w->g, value) & (1u << SYM_TIME | 1u << SYM_VEL | 1u << SYM_ACC | 1u << SYM_RATE | 1u << SYM_INPUT))
    return;
  if (w->e->energy_jumps || discontinuities_of(w->e, value).n || is_same_everywhere(w, value)) return;
  rate = poisson_bracket(w->g, value, w->space.H, w->space.q, w->space.p, w->space.n);
  if (prove_zero(w->g, rate, NULL) == PROVED_ZERO) add_known(w, is, value);
}

static void add_listed(Search *w) {
  for (uint32_t k = 0; k < w->found->all.n; k++) {
    const FoundSymmetry *f = &w->found->all.at[k];
    if (f->is.power_unknown || f->is.jumps || !expr_is_zero(w->g, f->is.power)) continue;
    add_known(w, (InvolutionCharge){.number = k, .charge = f->is.charge}, in_phase_space(w, f->is.charge));
  }
  for (uint32_t k = 0; w->polynomial && k < w->polynomial->all.n; k++) {
    Expr charge = w->polynomial->all.at[k].charge;
    add_known(w, (InvolutionCharge){.number = w->found->all.n + k, .charge = charge}, in_phase_space(w, charge));
  }
}

/* The square of an angular momentum is none of the charges found, and commutes with its components. */
static void add_squares(Search *w) {
  uint32_t of[ROTATIONS_MOST + 1], n = 0;
  for (uint32_t k = 0; k < w->known.n && n <= ROTATIONS_MOST; k++) {
    const Known *x = &w->known.at[k];
    if (x->is.kind == INVOLUTION_LISTED && x->is.number < w->found->all.n &&
        w->found->all.at[x->is.number].kind == SYMMETRY_ROTATION)
      of[n++] = k;
  }
  if (n > ROTATIONS_MOST) return;
  for (uint32_t a = 0; a < n; a++)
    for (uint32_t b = a + 1; b < n; b++)
      for (uint32_t c = b + 1; c < n; c++) {
        const uint32_t three[3] = {of[a], of[b], of[c]};
        InvolutionCharge is = {.kind = INVOLUTION_SQUARES, .charge = expr_int(w->g, 0)};
        Expr value = expr_int(w->g, 0);
        for (int i = 0; i < 3; i++) {
          const Known *x = &w->known.at[three[i]];
          Expr square = expr_pow_num(w->g, x->value, num_int(2)), shown = expr_pow_num(w->g, x->is.charge, num_int(2));
          is.of[i] = x->is.number;
          value = expr_add(w->g, value, square);
          is.charge = expr_add(w->g, is.charge, shown);
        }
        add_known(w, is, value);
      }
}

static void add_all_declared(Search *w) {
  const Model *m = w->e->m;
  for (uint32_t k = 1; k < w->e->ncharges; k++) add_declared(w, w->e->charges[k].name, w->e->charges[k].proof.charge);
  for (uint32_t k = 0; k < m->observes.n; k++) add_declared(w, m->observes.at[k].name, m->observes.at[k].value);
  for (uint32_t k = 0; k < m->brackets.n; k++) {
    add_declared(w, NULL, m->brackets.at[k].f);
    add_declared(w, NULL, m->brackets.at[k].g);
  }
}

/* --- numbers --- */

/* Gradients at random states. 0: too few states have values. */
static int draw_slopes(Search *w) {
  uint32_t r = w->known.n, n = w->space.n, width = 2 * n, count = expr_symbol_count(w->g) + 1, done = 0;
  Expr *roots = ARENA_ARRAY(w->scratch, Expr, (size_t)r * width + 1);
  for (uint32_t k = 0; k < r; k++) {
    expr_gradient(w->g, w->known.at[k].value, w->space.q, n, roots + (size_t)k * width);
    expr_gradient(w->g, w->known.at[k].value, w->space.p, n, roots + (size_t)k * width + n);
  }
  EvalTape *tape = eval_tape(w->g, roots, r * width);
  long double *symbols = ARENA_ARRAY(w->scratch, long double, count);
  w->slope = ARENA_ARRAY(w->scratch, long double, (size_t)STATES * r * width + 1);
  for (uint32_t seed = 1; done < STATES && seed < TRIES; seed++) {
    long double *to = w->slope + (size_t)done * r * width;
    int finite = 1;
    sample_state(w->g, 700 + seed, symbols);
    eval_run(tape, symbols, to);
    for (uint32_t k = 0; k < r * width; k++) finite = finite && isfinite(to[k]);
    done += (uint32_t)finite;
  }
  return done == STATES;
}

static const long double *slope_of(const Search *w, uint32_t state, uint32_t k) {
  return w->slope + ((size_t)state * w->known.n + k) * 2 * w->space.n;
}

/* Rank of the gradients of these charges: the largest of those at the states. */
static uint32_t rank_of(const Search *w, const uint32_t *chosen, uint32_t count) {
  const long double least = 1e-8L; /* gradients have 15 digits or more */
  uint32_t width = 2 * w->space.n, best = 0;
  long double *rows = w->rows;
  for (uint32_t s = 0; s < STATES; s++) {
    uint32_t rank = 0;
    for (uint32_t i = 0; i < count; i++) {
      memcpy(rows + (size_t)rank * width, slope_of(w, s, chosen[i]), width * sizeof *rows);
      if (dense_gram_schmidt(width, rows + (size_t)rank * width, rows, rank) > least) rank++;
    }
    if (rank > best) best = rank;
  }
  return best;
}

/* Whether some state shows that a bracket is not 0. */
static int differs(const Search *w, uint32_t a, uint32_t b) {
  uint32_t n = w->space.n;
  for (uint32_t s = 0; s < STATES; s++) {
    const long double *x = slope_of(w, s, a), *y = slope_of(w, s, b);
    long double sum = 0;
    for (uint32_t i = 0; i < n; i++) sum += x[i] * y[n + i] - x[n + i] * y[i];
    if (fabsl(sum) > 1e-10L * dense_largest(x, 2 * n) * dense_largest(y, 2 * n)) return 1;
  }
  return 0;
}

/* --- the set --- */

/* Whether {a, b} = 0 is proved; b < a. */
static int commute(Search *w, uint32_t a, uint32_t b) {
  uint8_t *verdict = &w->verdict[(size_t)a * w->known.n + b];
  if (*verdict == NOT_DECIDED && differs(w, a, b)) *verdict = PROVED_NONZERO;
  if (*verdict == NOT_DECIDED) {
    Expr bracket =
        poisson_bracket(w->g, w->known.at[a].value, w->known.at[b].value, w->space.q, w->space.p, w->space.n);
    *verdict = prove_zero(w->g, bracket, NULL) == PROVED_ZERO ? PROVED_ZERO : PROVED_NONZERO;
  }
  return *verdict == PROVED_ZERO;
}

/* Whether charge k may join the chosen ones. */
static int may_join(Search *w, uint32_t *chosen, uint32_t count, uint32_t k) {
  for (uint32_t i = 0; i < count; i++)
    if (!commute(w, k, chosen[i])) return 0;
  chosen[count] = k;
  return rank_of(w, chosen, count + 1) == count + 1;
}

/* The largest set, the first of its size, among those that were tried. Returns the size. */
static uint32_t choose(Search *w, uint32_t *best) {
  uint32_t n = w->space.n, r = w->known.n, count = 0, most = 0, k = 0,
           *chosen = ARENA_ARRAY(w->scratch, uint32_t, n + 1);
  for (uint32_t step = 0; most < n; step++) {
    if (step == STEPS_MOST || !search_goes_on(w->limit, 0)) {
      w->out->steps = step;
      break;
    }
    if (k < r && count + (r - k) > most) {
      if (may_join(w, chosen, count, k)) count++;
      if (count > most) memcpy(best, chosen, (most = count) * sizeof *best);
      k++;
    } else if (count) k = chosen[--count] + 1;
    else break;
  }
  return most;
}

static void search(Arena *scratch, void *data) {
  Search *w = data;
  w->scratch = scratch;
  w->out->n = w->space.n;
  add_listed(w);
  add_squares(w);
  add_all_declared(w);
  uint32_t r = w->known.n, *all = ARENA_ARRAY(scratch, uint32_t, r + 1),
           *best = ARENA_ARRAY(scratch, uint32_t, w->space.n + 1);
  if (!draw_slopes(w)) w->out->why_not = "the charges have no values at random states";
  if (w->out->why_not) return;
  w->verdict = ARENA_ARRAY(scratch, uint8_t, (size_t)r * r + 1);
  w->rows = ARENA_ARRAY(scratch, long double, (size_t)(r + 1) * 2 * w->space.n);
  for (uint32_t k = 0; k < r; k++) all[k] = k;
  w->out->independent = rank_of(w, all, r);
  uint32_t count = choose(w, best);
  if (w->limit->stopped) w->out->stopped = search_stop_text(w->limit);
  for (uint32_t i = 0; i < count; i++) vec_push(w->e->m->arena, &w->out->all, w->known.at[best[i]].is);
}

static const char *reason_against(const Eqns *e) {
  if (e->constraints.n) return "the model has constraints, which need Dirac brackets";
  if (!e->n && !e->m->hamiltonian) return "L is linear in velocities, and the model does not give its Hamiltonian";
  if (e->m->states.n != 2 * e->m->pairs.n) return "the model has states beside its coordinates";
  if (noether_note_on_impacts(e->m)) return "kicks, events or impacts change the state, and the charges with it";
  return eqns_has_forces(e) ? "forces stand outside L" : NULL;
}

Involution *involution_find(Eqns *e, const FoundSymmetries *found, const PolynomialCharges *polynomial,
                            SearchLimit *limit) {
  Involution *out = ARENA_NEW(e->m->arena, Involution);
  Search w = {.e = e, .g = e->g, .found = found, .polynomial = polynomial, .limit = limit, .out = out};
  search_stage(limit, 1, "charges in involution");
  limit->stopped = limit->no_room = 0;
  out->n = e->m->hamiltonian ? e->m->pairs.n : e->n;
  out->why_not = reason_against(e);
  if (!out->why_not) out->why_not = phase_space_try(e, &w.space);
  if (!out->why_not) arena_with_scratch(expr_arena(e->g), search, &w);
  return out;
}
