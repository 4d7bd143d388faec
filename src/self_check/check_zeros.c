/* States near zeros of the text's divisors. Where the motion stays finite there, as with (1 - cos(x))/x, a program
 * that cancels has fewer digits than the text. Random states never come that near. */
#include <math.h>

#include "self_check/self_check_impl.h"

enum { MOST_DIVISORS = 6, MOST_LINES = 2 };

/* A line through a state: q = from + s*along. Divisor `of` is 0 at s = zero. */
typedef struct {
  Ref of;
  Real *from, *along, zero;
} Line;

static void go_to(Check *c, const Line *l, Real s) {
  for (uint32_t i = 0; i < c->n; i++) c->q[i] = l->from[i] + s * l->along[i];
}

/* The divisor at the present state; *slope := its derivative along the line. */
static Real divisor(Check *c, const Line *l, Real *slope) {
  for (uint32_t i = 0; i < c->n; i++) c->c[i] = l->along[i];
  tape_run_to(c->dynamics->tape, l->of, check_input, c, c->at);
  const Jet *b = tape_value(c->dynamics->tape, c->at, l->of);
  *slope = b->c[1][0].v;
  return b->c[0][0].v;
}

/* Newton's method for l->zero; double zeros halve their distance in a round. 0: none is found. */
static int find_zero(Check *c, Line *l) {
  enum { ROUNDS = 40, HOPELESS = 5 };
  const Real exact = 1e-9L, far = 10;
  Real slope, first = 0;
  l->zero = 0;
  for (int round = 0; round < ROUNDS; round++) {
    go_to(c, l, l->zero);
    Real b = divisor(c, l, &slope), step = b / slope;
    if (round == 0) first = fabsl(b);
    if (b == 0) return round > 0;
    if (!isfinite(step) || fabsl(l->zero) > far || (round == HOPELESS && !(fabsl(b) < 0.1L * first))) return 0;
    l->zero -= step;
    if (fabsl(step) < exact) return 1;
  }
  return 0;
}

static Real largest_acceleration(const Check *c) {
  Real most = 0;
  for (uint32_t i = 0; i < c->n; i++) most = !(fabsl(c->a[i]) <= most) ? fabsl(c->a[i]) : most;
  return most;
}

/* The comparison without its message. */
static CheckVerdict compare_unheard(Check *c) {
  Model *m = (Model *)c->m; /* only its diags */
  Diags *heard = m->diags;
  m->diags = diags_new(c->arena, m->ast->sources);
  CheckVerdict v = check_equations(c);
  m->diags = heard;
  return v;
}

/* Compares at two distances from the zero. The condition of M, which bounds errors, is that of a state beside it. */
static CheckVerdict check_line(Check *c, const Line *l) {
  const Real beside = 0.1L, near[] = {1e-4L, 1e-6L}, finite = 10;
  go_to(c, l, l->zero + beside);
  if (!check_solve_motion(c)) return DISMISSED;
  Real usual = largest_acceleration(c);
  CheckVerdict v = AGREES;
  for (int k = 0; k < 2 && v != DISAGREES; k++) {
    go_to(c, l, l->zero + near[k]);
    if (!check_solve(c) || !(largest_acceleration(c) <= finite * usual)) return DISMISSED;
    v = compare_unheard(c);
  }
  return v;
}

/* A line through the present state: the first to the origin, where distances vanish, the second at random. */
static void choose_line(Check *c, Line *l, int line) {
  Real most = 0;
  for (uint32_t i = 0; i < c->n; i++) {
    l->from[i] = c->q[i];
    l->along[i] = line == 0 ? c->q[i] : check_random(c, -1, 1);
    most = fmaxl(most, fabsl(l->along[i]));
  }
  for (uint32_t i = 0; i < c->n; i++) l->along[i] /= most;
}

/* Divisor of instruction i that is not a number; 0: none. */
static Ref divisor_of(const Tape *t, Ref i) {
  const TapeIns *x = &t->ins.at[i];
  Ref of = x->op == TAPE_DIV ? x->b : x->op == TAPE_POWER && num_sign(tape_ins_number(x)) < 0 ? x->a : 0;
  return of && t->ins.at[of].op != TAPE_NUMBER && t->ins.at[of].input != INPUT_PARAM ? of : 0;
}

/* Values are right there, with fewer digits: a warning. */
static void warn(const Check *c) {
  diag_warning(c->m->diags, c->m->lagrangian_span,
               "near a zero of a divisor the compiled equations of motion have fewer digits than this text");
  diag_help(c->m->diags, "at %s; this is a weakness of lagc, not of the model: please report it", check_state_text(c));
}

void check_zeros(Check *c) {
  const Tape *t = c->dynamics->tape;
  Line l = {.from = ARENA_ARRAY(c->arena, Real, c->n + 1), .along = ARENA_ARRAY(c->arena, Real, c->n + 1)};
  int tried = 0;
  for (Ref i = 1; i < t->ins.n && tried < MOST_DIVISORS; i++) {
    if (!(l.of = divisor_of(t, i))) continue;
    tried++;
    for (int line = 0; line < MOST_LINES; line++) {
      if (!check_choose_state(c, 0)) continue;
      choose_line(c, &l, line);
      if (!find_zero(c, &l) || check_line(c, &l) != DISAGREES) continue;
      warn(c);
      return;
    }
  }
}
