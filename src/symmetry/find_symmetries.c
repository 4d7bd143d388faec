/* Drives the search: chooses parameter values, computes solution spaces, writes the rates of exp(A t) in closed form
 * (or, where L contains t or is of first order, lists functions of time), and adds each family of generators that
 * share them. */
#include "symmetry/find_symmetries_impl.h"

#include <math.h>

#include "base/dense_matrix.h"

#include "mech/lagrange.h"
#include "sym/diff.h"
#include "sym/expr_eval.h"
#include "sym/normal_form.h"
#include "sym/print.h"
#include "sym/prove.h"
#include "sym/simplify.h"

const SolutionSpace *noether_space_at(SymmetrySearch *s, uint32_t choice) {
  if (s->spaces[choice].space.width == 0) {
    const SolutionSpace *like = choice > CHOICE_SECOND ? noether_space_at(s, CHOICE_FIRST) : NULL;
    s->spaces[choice] = solution_space(s->ansatz, s->scratch, s->choices.at[choice], like);
  }
  return &s->spaces[choice];
}

uint32_t noether_choices(const SymmetrySearch *s) { return 2 + s->choices.n; }

/* --- rates, as expressions --- */

/* A candidate for rates: squares of actual rates are rational multiples of its square. */
typedef struct {
  Expr square, root; /* root^2 = +-square */
  int is_double;     /* a double root: t times the oscillation is a solution, too */
} RateCandidate;

typedef VEC(RateCandidate) RateCandidates;

static void add_guess(SymmetrySearch *s, RateCandidates *all, Expr root, int is_double) {
  int negative = choice_value(&s->choices, CHOICE_FIRST, root) < 0;
  Expr square = expr_neg(s->g, expr_pow_num(s->g, root, num_int(2)));
  vec_push(s->scratch, all, ((RateCandidate){square, negative ? expr_neg(s->g, root) : root, is_double}));
}

/* Rates of two coordinates coupled by b = beta m through velocities: with z = x + i y, z'' = kappa z - i beta z',
 * w^2 + beta w + kappa = 0; a double root in a frame that turns. */
static void add_coupled(SymmetrySearch *s, RateCandidates *all, Expr beta, Expr kappa) {
  ExprGraph *g = s->g;
  Expr four = expr_scale(g, num_int(4), kappa),
       inside = simplify(g, expr_sub(g, expr_pow_num(g, beta, num_int(2)), four));
  add_guess(s, all, beta, 0);
  if (expr_is_zero(g, inside)) add_guess(s, all, expr_scale(g, num_ratio(1, 2), beta), 1);
  if (expr_is_zero(g, kappa) || choice_value(&s->choices, CHOICE_FIRST, inside) <= 0) return;
  Expr root = expr_sqrt(g, inside), sum = expr_add(g, beta, root), difference = expr_sub(g, root, beta);
  add_guess(s, all, expr_scale(g, num_ratio(1, 2), sum), 0);
  add_guess(s, all, expr_scale(g, num_ratio(1, 2), difference), 0);
  add_guess(s, all, root, 0); /* of breathing modes: the sum of both */
}

/* Candidates from each coordinate with its own equation m q'' = kappa m q + ..., and from pairs with equal kappa and
 * coupled velocities. */
static RateCandidates rate_candidates(SymmetrySearch *s) {
  Eqns *e = s->e;
  ExprGraph *g = s->g;
  RateCandidates all = {0};
  Expr *kappa = ARENA_ARRAY(s->scratch, Expr, e->n + 1);
  if (e->n && !e->mass_known) eqns_derive_mass(e);
  for (uint32_t i = 0; i < e->n; i++) {
    Expr m = simplify(g, eqns_mass(e, i, i)), k = simplify(g, expr_diff(g, e->dLdq[i], s->ansatz->q[i]));
    if (expr_is_zero(g, m) || !expr_is_constant(g, m) || !expr_is_constant(g, k)) continue;
    kappa[i] = simplify(g, expr_div(g, k, m));
    if (!expr_is_zero(g, k)) {
      int grows = choice_value(&s->choices, CHOICE_FIRST, kappa[i]) > 0;
      Expr root = expr_sqrt(g, grows ? kappa[i] : simplify(g, expr_neg(g, kappa[i])));
      vec_push(s->scratch, &all, ((RateCandidate){kappa[i], root, 0}));
    }
    for (uint32_t j = 0; j < i; j++) {
      Expr one = expr_diff(g, e->dLdq[i], s->ansatz->v[j]), other = expr_diff(g, e->dLdq[j], s->ansatz->v[i]);
      Expr b = simplify(g, expr_sub(g, one, other));
      if (kappa[j] == kappa[i] && expr_is_constant(g, b) && !expr_is_zero(g, b))
        add_coupled(s, &all, simplify(g, expr_div(g, b, m)), kappa[i]);
    }
  }
  return all;
}

/* The squared rate nearest to x at another choice; NAN: there is none. */
static long double nearest_rate(SymmetrySearch *s, uint32_t choice, long double x) {
  const SolutionSpace *space = noether_space_at(s, choice);
  Rates r = space->sure ? space_rates(s->scratch, space) : (Rates){0};
  long double best = NAN;
  for (uint32_t k = 0; k < r.n; k++)
    if (!(fabsl(r.at[k] - x) >= fabsl(best - x))) best = r.at[k];
  return best;
}

static int close_to(long double a, long double b) { return fabsl(a - b) < 1e-8L * fabsl(b); }

/* Writes the rate as sqrt(c) times a candidate, c rational, and checks it at the second choice. 0: none fits. */
static int rate_by_guess(SymmetrySearch *s, const RateCandidates *all, long double rate2, Family *to) {
  for (uint32_t k = 0; k < all->n; k++) {
    Num c;
    long double ratio = rate2 / choice_value(&s->choices, CHOICE_FIRST, all->at[k].square);
    if (!recognise_rational(ratio, &c) || num_value(c) <= 0) continue;
    for (uint32_t i = 0; i < noether_choices(s); i++)
      to->rate2[i] = (long double)num_value(c) * choice_value(&s->choices, i, all->at[k].square);
    if (!close_to(nearest_rate(s, CHOICE_SECOND, to->rate2[CHOICE_SECOND]), to->rate2[CHOICE_SECOND])) continue;
    Expr root = expr_sqrt(s->g, expr_num(s->g, c));
    to->rate = expr_mul(s->g, root, all->at[k].root);
    return 1;
  }
  return 0;
}

/* Writes the squared rate as a product of powers of parameters, or a sum of parameters over one of them. 0: it is
 * neither. */
static int rate_by_value(SymmetrySearch *s, long double rate2, Family *to) {
  for (uint32_t i = 0; i < noether_choices(s); i++) to->rate2[i] = i == CHOICE_SECOND ? NAN : nearest_rate(s, i, rate2);
  const SolutionSpace *second = noether_space_at(s, CHOICE_SECOND);
  Rates r = second->sure ? space_rates(s->scratch, second) : (Rates){0};
  for (uint32_t k = 0; k < r.n; k++) {
    to->rate2[CHOICE_SECOND] = r.at[k];
    Expr square = recognise_monomial(&s->choices, to->rate2);
    if (!square) square = recognise_quotient(&s->choices, to->rate2);
    if (!square) continue;
    to->rate = expr_sqrt(s->g, rate2 < 0 ? expr_neg(s->g, square) : square);
    return 1;
  }
  return 0;
}

/* --- where coefficients may be any functions of time --- */

static void sort_rates(Rates *r) {
  for (uint32_t i = 1; i < r->n; i++)
    for (uint32_t k = i; k > 0 && fabsl(r->at[k]) < fabsl(r->at[k - 1]); k--) {
      long double swap = r->at[k];
      r->at[k] = r->at[k - 1];
      r->at[k - 1] = swap;
    }
}

static void search_rates(SymmetrySearch *s) {
  Rates rates = space_rates(s->scratch, noether_space_at(s, CHOICE_FIRST));
  if (!rates.n) return;
  sort_rates(&rates);
  RateCandidates all = rate_candidates(s);
  for (uint32_t k = 0; k < rates.n; k++) {
    Family f = {.kind = rates.at[k] < 0 ? TIME_CIRCULAR : TIME_EXPONENTIAL,
                .rate2 = ARENA_ARRAY(s->scratch, long double, noether_choices(s))};
    if (rate_by_guess(s, &all, rates.at[k], &f) || rate_by_value(s, rates.at[k], &f)) noether_add_family(s, &f);
  }
}

/* --- where L contains t, or is of first order: functions of time from a list --- */

typedef VEC(Expr) Exprs;

static void add_once(SymmetrySearch *s, Exprs *list, Expr x) {
  for (uint32_t k = 0; k < list->n; k++)
    if (list->at[k] == x) return;
  vec_push(s->scratch, list, x);
}

/* Rates w of sin(w t + ...) and cos(w t + ...) in L, and s of exp(s t + ...). */
static void rates_in_text(SymmetrySearch *s, Exprs *circular, Exprs *exponential) {
  ExprGraph *g = s->g;
  Expr L = s->e->lagrangian;
  ExprList all = expr_topo(g, &L, 1);
  for (uint32_t i = 0; i < all.n; i++) {
    ExprOp op = expr_op(g, all.at[i]);
    if (op != EX_SIN && op != EX_COS && op != EX_EXP) continue;
    Expr rate = simplify(g, expr_diff(g, expr_arg(g, all.at[i], 0), s->e->m->time));
    if (expr_is_zero(g, rate) || !expr_is_constant(g, rate)) continue;
    if (choice_value(&s->choices, CHOICE_FIRST, rate) < 0) rate = expr_neg(g, rate);
    add_once(s, op == EX_EXP ? exponential : circular, rate);
  }
}

static void add_circular(SymmetrySearch *s, Exprs *to, Expr w) {
  Expr phase = expr_mul(s->g, w, expr_symbol(s->g, s->e->m->time)->node);
  if (expr_is_zero(s->g, w)) return;
  add_once(s, to, expr_fn(s->g, EX_COS, phase));
  Expr sine = expr_fn(s->g, EX_SIN, phase);
  Num sign;
  expr_pair(s->g, sine, EX_SUM, 0, &sign);
  add_once(s, to, num_sign(sign) < 0 ? expr_neg(s->g, sine) : sine);
}

/* cos(w t) and sin(w t) times t and t^2. */
static void add_growing(SymmetrySearch *s, Exprs *to, Expr w) {
  Exprs plain = {0};
  Expr t = expr_symbol(s->g, s->e->m->time)->node;
  add_circular(s, &plain, w);
  for (int power = 1; power <= 2; power++)
    for (uint32_t k = 0; k < plain.n; k++)
      add_once(s, to, expr_mul(s->g, expr_pow_num(s->g, t, num_int(power)), plain.at[k]));
}

static void add_exponential(SymmetrySearch *s, Exprs *to, Expr rate) {
  Expr phase = expr_mul(s->g, rate, expr_symbol(s->g, s->e->m->time)->node);
  add_once(s, to, expr_fn(s->g, EX_EXP, phase));
  add_once(s, to, expr_fn(s->g, EX_EXP, expr_neg(s->g, phase)));
}

/* Functions of time for the ansatz. For xi and tau: 1, t, t^2 and those of L's own rates, double rates times t and
 * t^2; for F their products, too. A first-order L gets constants only for xi and tau: more would let each charge be
 * multiplied by functions of others. */
static TimeList time_list(SymmetrySearch *s) {
  enum { RATES_MOST = 4 };
  Exprs circular = {0}, exponential = {0}, growing = {0}, list = {0};
  ExprGraph *g = s->g;
  Expr t = expr_symbol(g, s->e->m->time)->node;
  rates_in_text(s, &circular, &exponential);
  if (s->e->n) {
    RateCandidates own = rate_candidates(s);
    for (uint32_t k = 0; k < own.n; k++)
      if (own.at[k].is_double) add_once(s, &growing, own.at[k].root);
    for (uint32_t k = 0; k < own.n && circular.n + exponential.n < RATES_MOST; k++)
      add_once(s, choice_value(&s->choices, CHOICE_FIRST, own.at[k].square) < 0 ? &circular : &exponential,
               own.at[k].root);
  }
  if (circular.n > RATES_MOST) circular.n = RATES_MOST;
  if (exponential.n > RATES_MOST) exponential.n = RATES_MOST;
  vec_push(s->scratch, &list, expr_int(g, 1));
  if (s->e->n) vec_push(s->scratch, &list, t);
  if (s->e->n) vec_push(s->scratch, &list, expr_pow_num(g, t, num_int(2)));
  for (uint32_t k = 0; k < circular.n && s->e->n; k++) add_circular(s, &list, circular.at[k]);
  for (uint32_t k = 0; k < growing.n; k++) add_growing(s, &list, growing.at[k]);
  for (uint32_t k = 0; k < exponential.n && s->e->n; k++) add_exponential(s, &list, exponential.at[k]);
  s->ansatz->far_times = !exponential.n;
  uint32_t own = list.n;
  add_once(s, &list, t);
  add_once(s, &list, expr_pow_num(g, t, num_int(2)));
  for (uint32_t k = 0; k < circular.n; k++) {
    add_circular(s, &list, circular.at[k]);
    for (uint32_t j = 0; j <= k; j++) {
      add_circular(s, &list, expr_add(g, circular.at[k], circular.at[j]));
      add_circular(s, &list, expr_sub(g, circular.at[k], circular.at[j]));
    }
  }
  for (uint32_t k = 0; k < exponential.n; k++) add_exponential(s, &list, exponential.at[k]);
  for (uint32_t k = 2; k < own; k++) add_once(s, &list, expr_mul(g, t, list.at[k]));
  return (TimeList){own, list.n, list.at};
}

static const char *functions_text(SymmetrySearch *s, const TimeList *times, uint32_t from, uint32_t to) {
  StrBuf b = strbuf(s->e->m->arena);
  for (uint32_t k = from; k < to; k++) {
    sb_puts(&b, k > from ? ", " : "");
    expr_print(s->g, times->f[k], PRINT_TEXT, &b);
  }
  return sb_text(&b);
}

/* Of inputs and states only values are known, no rates: time is not shifted where L contains one. */
static const char *tau_text(const Ansatz *a) {
  return a->has_tau ? ", tau" : ", no tau since L contains an input or a state";
}

static void use_attempt(SymmetrySearch *s, uint32_t attempt) {
  s->out->attempt = attempt;
  s->choices = choices_new(s->scratch, s->e, attempt, 1);
  s->spaces = ARENA_ARRAY(s->scratch, SolutionSpace, noether_choices(s));
}

/* Other values of the parameters where rounding decides at the first ones. */
static void search_listed(SymmetrySearch *s) {
  enum { ATTEMPTS = 4 };
  Family f = {.kind = TIME_LISTED, .times = time_list(s)};
  while (!(s->out->searched = noether_add_family(s, &f)) && s->choices.n && s->out->attempt < ATTEMPTS &&
         search_goes_on(s->limit, 0)) {
    use_attempt(s, s->out->attempt + 1);
    f.times = time_list(s);
  }
  s->out->ansatz =
      arena_printf(s->e->m->arena,
                   "xi affine in the coordinates%s%s, with coefficients in t: %s; F a polynomial of degree %u in the "
                   "coordinates, with those%s%s, and any function of t alone",
                   !s->ansatz->whole ? " (turns and stretches of one vector only)" : "", tau_text(s->ansatz),
                   functions_text(s, &f.times, 0, f.times.n), s->ansatz->degree,
                   f.times.n < f.times.ngauge ? " and " : "", functions_text(s, &f.times, f.times.n, f.times.ngauge));
}

/* --- the search --- */

static const char *ansatz_text(const SymmetrySearch *s) {
  const Ansatz *a = s->ansatz;
  return arena_printf(s->e->m->arena,
                      "xi affine in the coordinates%s%s%s with any dependence on time; F a polynomial of degree "
                      "%u in the coordinates",
                      !a->whole ? " (turns and stretches of one vector only)" : "", tau_text(a),
                      a->has_tau ? ", both" : ",", a->degree);
}

/* least ratio of pivots to rounding that is trusted; models have 1e13 and more */
static const long double GAP_WEAK = 1e10L;

static void search_autonomous(SymmetrySearch *s) {
  const SolutionSpace *space = noether_space_at(s, CHOICE_FIRST);
  s->out->ansatz = ansatz_text(s);
  s->out->searched = space->sure;
  if (!space->sure) return;
  Family powers = {.kind = TIME_POWERS};
  noether_add_family(s, &powers);
  search_rates(s);
  /* less F = 1 */
  uint32_t dimension = space->space.n ? space->space.n - 1 : 0, known = s->out->all.n + s->out->unproved;
  if (dimension > known) s->out->unproved += dimension - known;
  if (space->space.gap < GAP_WEAK)
    s->out->note = "rates or couplings lie so close to one another that some symmetries may be missing";
}

/* Number of solutions at a choice whose rate is complex: they oscillate and grow at once. */
static uint32_t complex_rates(SymmetrySearch *s, uint32_t choice) {
  const SolutionSpace *space = noether_space_at(s, choice);
  return space->sure ? space_rates(s->scratch, space).others : 0;
}

/* Chooses values of the parameters at which L has values, and others where some rate is complex and
 * has no closed form: a trap that does not confine. */
static void draw_parameters(SymmetrySearch *s) {
  enum { ATTEMPTS = 12 };
  for (uint32_t attempt = 0; attempt < ATTEMPTS; attempt++) {
    use_attempt(s, attempt);
    if (rows_exist(s->ansatz, s->scratch, s->choices.at[CHOICE_FIRST]) &&
        rows_exist(s->ansatz, s->scratch, s->choices.at[CHOICE_SECOND]))
      break;
  }
  if (s->ansatz->has_time || !s->e->n || !s->choices.n ||
      !(complex_rates(s, CHOICE_FIRST) + complex_rates(s, CHOICE_SECOND)))
    return;
  for (uint32_t attempt = 1; attempt < ATTEMPTS && search_goes_on(s->limit, 0); attempt++) {
    use_attempt(s, attempt);
    if (complex_rates(s, CHOICE_FIRST) + complex_rates(s, CHOICE_SECOND) == 0) return;
  }
  use_attempt(s, 0);
}

static void search_ansatz(SymmetrySearch *s, int whole) {
  *s->out = (FoundSymmetries){0};
  search_stage(s->limit, whole ? 0.5 : 0.7,
               whole ? "all generators affine in the coordinates" : "generators that mix the components of one vector");
  s->ansatz = ansatz_new(s->scratch, s->e, whole, s->limit);
  draw_parameters(s);
  if (s->ansatz->has_time || !s->e->n) search_listed(s);
  else search_autonomous(s);
}

static const char *stopped_note(Arena *a, const SearchLimit *limit) {
  if (limit->no_room) return arena_printf(a, "%s, and nothing was searched beyond", search_stop_text(limit));
  return arena_printf(
      a, "%.3g s did not suffice for more, and nothing was searched beyond: --seconds %.3g gives more time",
      limit->seconds, 10 * limit->seconds);
}

FoundSymmetries join_symmetries(const Eqns *e, const FoundSymmetries *first, const FoundSymmetries *second) {
  enum { STATES = 4 };
  Arena *a = e->m->arena;
  FoundSymmetries all = {0};
  uint32_t n = eqns_coordinates(e), width = STATES * (n + 1), rank = 0;
  long double *symbols = ARENA_ARRAY(a, long double, expr_symbol_count(e->g) + 1);
  long double *rows = ARENA_ARRAY(a, long double, (size_t)width * (first->all.n + second->all.n + 1));
  for (uint32_t k = 0; k < first->all.n + second->all.n; k++) {
    const FoundSymmetry *x = k < first->all.n ? &first->all.at[k] : &second->all.at[k - first->all.n];
    long double *row = rows + (size_t)rank * width;
    for (uint32_t i = 0; i < STATES; i++) { /* as functions of the coordinates and of time */
      sample_state(e->g, i + 1, symbols);
      expr_eval(e->g, x->by.xi, n, symbols, row + (size_t)i * (n + 1));
      expr_eval(e->g, &x->by.tau, 1, symbols, row + (size_t)i * (n + 1) + n);
    }
    if (dense_gram_schmidt(width, row, rows, rank) < 1e-9L) continue; /* rounding is 1e-18 */
    vec_push(a, &all.all, *x);
    rank++;
  }
  return all;
}

/* Adds the usual symmetries that the search has not found, as its random equations are too badly conditioned to tell
 * all solutions, or time was short. */
static void compare_with_usual(SymmetrySearch *s) {
  FoundSymmetries usual = {0}, *out = s->out;
  int stopped = s->limit->stopped, none = !out->searched || (stopped && !out->all.n);
  try_usual_symmetries(s->e, &usual, s->limit);
  uint32_t found = out->all.n, missing = join_symmetries(s->e, out, &usual).all.n - found;
  if (!none && !missing) {
    s->limit->stopped = stopped;
    return;
  }
  FoundSymmetries joined = join_symmetries(s->e, &usual, out);
  joined.searched = 1;
  joined.attempt = out->attempt;
  joined.unproved = none || out->unproved < missing ? 0 : out->unproved - missing;
  *out = joined;
  out->ansatz = "the energy, momenta of cyclic coordinates, translations, boosts, rotations, scalings and expansions "
                "of all coordinates of a kind together";
  s->out->note = "the linear equations of the full search could not be solved reliably";
}

/* The largest ansatz that can be searched in its part of the time, else the usual symmetries. */
static void search_work(Arena *scratch, void *data) {
  SymmetrySearch *s = data;
  int whole = eqns_coordinates(s->e) <= WHOLE_MOST;
  s->scratch = scratch;
  search_ansatz(s, whole);
  if (whole && s->limit->stopped && !s->out->all.n) search_ansatz(s, 0);
  if (!s->out->searched || !s->ansatz->whole || (s->limit->stopped && !s->out->all.n)) compare_with_usual(s);
}

const char *noether_note_on_impacts(const Model *m) {
  uint32_t setting = 0;
  if (model_conditional(m))
    return "constraints with `while` change charges where they begin, and while they hold, if their symmetry moves "
           "them: the charges are those of the motion without them";
  if (m->contacts.n || m->families.n) return "impacts and contacts change charges: the balances hold between them";
  for (uint32_t i = 0; i < m->events.n; i++) setting += m->events.at[i].actions.n > 0;
  return setting ? "events change charges: the balances hold between them" : NULL;
}

static FoundSymmetries search_in(Eqns *e, SearchLimit *limit) {
  FoundSymmetries out = {0};
  SymmetrySearch s = {.e = e, .g = e->g, .out = &out, .limit = limit};
  arena_with_scratch(expr_arena(e->g), search_work, &s);
  return out;
}

/* Where t drops out of L, and not all symmetries are found in closed form, the text may have their functions of
 * time. */
static FoundSymmetries search(Eqns *e, SearchLimit *limit) {
  FoundSymmetries out = search_in(e, limit);
  if (e->lagrangian == e->m->lagrangian || (out.searched && !out.unproved)) return out;
  Eqns written = *e;
  written.lagrangian = e->m->lagrangian;
  FoundSymmetries other = search_in(&written, limit);
  return other.searched && other.all.n > out.all.n ? other : out;
}

/* Whether energy, three momenta, three angular momenta and three boosts are among them. */
static int has_galilean_charges(const FoundSymmetries *all) {
  uint32_t seen[SYMMETRY_SCALING + 1] = {0};
  vec_each(const FoundSymmetry, s, all->all)
    if (s->kind == SYMMETRY_ENERGY) seen[s->kind] = 7;
    else if (s->of_all) seen[s->kind] |= 1u << s->axis;
  return seen[SYMMETRY_ENERGY] && seen[SYMMETRY_MOMENTUM] == 7 && seen[SYMMETRY_ROTATION] == 7 &&
         seen[SYMMETRY_BOOST] == 7;
}

FoundSymmetries noether_find(Eqns *e, SearchLimit *limit) {
  FoundSymmetries out = {0};
  if (too_large_to_search(e)) try_usual_symmetries(e, &out, limit);
  else out = search(e, limit);
  if (limit->stopped) out.note = stopped_note(e->m->arena, limit);
  out.galilean = has_galilean_charges(&out);
  if (!out.note) out.note = noether_note_on_impacts(e->m);
  return out;
}
