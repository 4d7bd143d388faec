#include "mech/expect.h"

#include <float.h>
#include <math.h>

#include "mech/charges.h"
#include "mech/mend.h"
#include "mech/sites.h"
#include "mech/states.h"
#include "sym/prove.h"

/* --- agreement by value --- */

enum { SAMPLES = 20, FULL_DIGITS = 18, FEWEST_DIGITS = 6 };

/* The sum of the sizes of a side's terms, and of the bounds of their rounding errors. */
static void measure(ExprGraph *g, Expr side, const long double *symbols, long double *size, long double *bound) {
  for (uint32_t i = 0; i < expr_pairs(g, side, EX_SUM); i++) {
    Num c;
    long double error;
    Expr term = expr_pair(g, side, EX_SUM, i, &c);
    long double value = prove_value(g, term, symbols, NULL, &error), k = fabsl((long double)num_value(c));
    *size += k * fabsl(value);
    *bound += k * error + (long double)num_error(c) * fabsl(value);
  }
}

/* Digits to which the sides agree at a state, measured by the size of what they are summed of. -1
 * where that says nothing: a side has no value, or what it is summed of drowns in rounding (the sine
 * of a huge number, the sign of a difference that is zero). */
static int digits_at(const Eqns *e, const Expect *x, const long double *symbols) {
  const long double noise = 1e-6L;
  long double size = 0, bound = 0, unused;
  long double l = prove_value(e->g, x->lhs, symbols, NULL, &unused);
  long double r = prove_value(e->g, x->rhs, symbols, NULL, &unused);
  measure(e->g, x->lhs, symbols, &size, &bound);
  measure(e->g, x->rhs, symbols, &size, &bound);
  if (!isfinite(l - r) || !isfinite(size) || !(bound <= noise * size)) return -1;
  if (l == r) return FULL_DIGITS;
  long double digits = floorl(-log10l(fabsl(l - r) / size));
  return digits < 0 ? 0 : digits > FULL_DIGITS ? FULL_DIGITS : (int)digits;
}

/* The fewest digits of agreement at random states; *seen is the number of states compared. */
static int agreement(const Eqns *e, const Expect *x, int *seen) {
  StateSolver *solver = states_new(e);
  long double *symbols = ARENA_ARRAY(e->m->arena, long double, expr_symbol_count(e->g) + 1);
  int least = FULL_DIGITS;
  *seen = 0;
  for (uint32_t seed = 1; seed <= 3 * SAMPLES && *seen < SAMPLES; seed++) {
    if (seed % 2) prove_state(e->g, seed, symbols);
    else prove_state_wide(e->g, seed, symbols);
    if (!states_complete(solver, symbols)) continue;
    int digits = digits_at(e, x, symbols);
    if (digits < 0) continue;
    ++*seen;
    if (digits < least) least = digits;
  }
  return least;
}

/* --- a state that shows the difference --- */

typedef struct {
  const Eqns *e;
  const Expect *x;
  EvalTape *sides;
  StateSolver *solver;
  long double *symbols;
  long double left, right;
} Showing;

static void default_params(Showing *s) {
  const Model *m = s->e->m;
  s->symbols[m->pi] = 3.14159265358979323846264338327950288L;
  for (uint32_t i = 0; i < m->params.n; i++) {
    const Param *p = &m->params.at[i];
    if (p->value) expr_eval(s->e->g, &p->value, 1, s->symbols, &s->symbols[p->sym]);
  }
}

static void other_params(Showing *s) {
  const Model *m = s->e->m;
  for (uint32_t i = 0; i < m->params.n; i++) {
    const Symbol *sym = expr_symbol(s->e->g, m->params.at[i].sym);
    int negative = sym->sign == SIGN_NEGATIVE || sym->sign == SIGN_NONPOSITIVE;
    s->symbols[m->params.at[i].sym] = (negative ? -1 : 1) * (long double)(i % 5 + 2);
  }
}

/* The k-th simple state: at rest or moving; a few angles; last with other parameters. */
static void simple_state(Showing *s, int k) {
  const Model *m = s->e->m;
  const long double at[] = {1, 0.5L, -0.5L, 2}, moving[] = {1, 2, -1, 0.5L};
  uint32_t shift = (uint32_t)k / 2 % 3;
  default_params(s);
  if (k >= 6) other_params(s);
  s->symbols[m->time] = k % 2;
  for (uint32_t i = 0; i < m->coords.n; i++) {
    s->symbols[m->coords.at[i].q] = at[(i + shift) % 4];
    s->symbols[m->coords.at[i].v] = k % 2 ? moving[(i + shift) % 4] : 0;
  }
  for (uint32_t i = 0; i < m->states.n; i++) s->symbols[m->states.at[i].z] = at[(i + shift) % 4];
  for (uint32_t i = 0; i < m->inputs.n; i++) s->symbols[m->inputs.at[i].sym] = at[i % 2];
}

static int differs(Showing *s, long double least) {
  long double out[2];
  if (!states_complete(s->solver, s->symbols)) return 0;
  eval_run(s->sides, s->symbols, out);
  s->left = out[0];
  s->right = out[1];
  return isfinite(out[0]) && isfinite(out[1]) && fabsl(out[0] - out[1]) > least * (fabsl(out[0]) + fabsl(out[1]));
}

/* The first simple state at which a person sees the difference; otherwise any state that has one. */
static int find_showing(Showing *s) {
  enum { SIMPLE = 12 };
  for (int k = 0; k < SIMPLE; k++) {
    simple_state(s, k);
    if (differs(s, 0.01L)) return 1;
  }
  for (uint32_t seed = 1; seed <= SAMPLES; seed++) {
    if (seed % 2) prove_state(s->e->g, seed, s->symbols);
    else prove_state_wide(s->e->g, seed, s->symbols);
    if (differs(s, 1e-12L)) return 1;
  }
  return 0;
}

static void put_value(StrBuf *b, const Showing *s, SymId sym, const Unit *unit) {
  const Symbol *symbol = expr_symbol(s->e->g, sym);
  double factor = unit_factor(unit), offset = symbol->kind == SYM_VEL ? 0 : num_value(unit->offset);
  sb_printf(b, "%s%s = %.6Lg", b->n ? ", " : "", symbol->name, (s->symbols[sym] - (long double)offset) / (long double)factor);
  if (factor != 1 || offset != 0) sb_printf(b, symbol->kind == SYM_VEL ? " [%s/s]" : " [%s]", unit->text);
}

static int is_acceleration(const Symbol *s, const void *data) {
  (void)data;
  return s->kind == SYM_ACC;
}

static int in_equations(const Eqns *e, SymId sym) {
  for (uint32_t i = 0; i < e->mass.n; i++)
    if (expr_contains_sym(e->g, e->mass.at[i].e, sym)) return 1;
  for (uint32_t i = 0; i < e->n; i++)
    if (expr_contains_sym(e->g, e->f[i], sym)) return 1;
  return 0;
}

/* Whether a symbol only says which contact is closed. */
static int is_switch(const Model *m, SymId sym) {
  for (uint32_t i = 0; i < m->contacts.n; i++)
    if (m->contacts.at[i].closed == sym) return 1;
  return 0;
}

/* "th1 = 1, th1' = 0, m1 = 1": the coordinates and what else the sides contain. */
static const char *state_text(const Showing *s) {
  enum { FEW_COORDINATES = 4 };
  const Model *m = s->e->m;
  const Unit si = {.factor = num_int(1), .offset = num_int(0), .text = ""};
  ExprGraph *g = s->e->g;
  Expr both = expr_sub(g, s->x->lhs, s->x->rhs);
  StrBuf b = strbuf(m->arena);
  for (int rates = 0; rates < 2; rates++)
    for (uint32_t i = 0; i < m->coords.n; i++) {
      const Coord *c = &m->coords.at[i];
      SymId sym = rates ? c->v : c->q;
      if (m->coords.n <= FEW_COORDINATES || expr_contains_sym(g, both, sym)) put_value(&b, s, sym, &c->unit);
    }
  for (uint32_t i = 0; i < m->states.n; i++) put_value(&b, s, m->states.at[i].z, &m->states.at[i].unit);
  if (expr_contains_sym(g, both, m->time)) put_value(&b, s, m->time, &si);
  for (uint32_t i = 0; i < m->inputs.n; i++)
    if (!is_switch(m, m->inputs.at[i].sym)) put_value(&b, s, m->inputs.at[i].sym, &m->inputs.at[i].unit);
  int moves = expr_contains(g, both, is_acceleration, NULL); /* then all of M and f is in it */
  for (uint32_t i = 0; i < m->params.n; i++) {
    const Param *p = &m->params.at[i];
    int in = expr_contains_sym(g, both, p->sym) || (moves && in_equations(s->e, p->sym));
    if (in) put_value(&b, s, p->sym, &p->unit);
  }
  return sb_text(&b);
}

/* "at th1 = 1, ...: th1'' is -9.81, the right side 9.81" */
static const char *difference_text(const Eqns *e, const Expect *x) {
  const Model *m = e->m;
  Showing s = {.e = e, .x = x, .solver = states_new(e)};
  Expr sides[2] = {x->lhs, x->rhs};
  s.sides = eval_tape(e->g, sides, 2);
  s.symbols = ARENA_ARRAY(m->arena, long double, expr_symbol_count(e->g) + 1);
  if (!find_showing(&s)) return NULL;
  const char *left = arena_printf(m->arena, "%.6Lg", s.left), *right = arena_printf(m->arena, "%.6Lg", s.right);
  if (strcmp(left, right) == 0) {
    left = arena_printf(m->arena, "%.17Lg", s.left);
    right = arena_printf(m->arena, "%.17Lg", s.right);
  }
  return arena_printf(m->arena, "the left side is %s, the right side %s at %s", left, right, state_text(&s));
}

/* --- verdicts --- */

static const char *label_of(const Model *m, const Expect *x) {
  const char *left = span_text(m, ast_expr(m->ast, x->lhs_ast)->span);
  return x->name ? arena_printf(m->arena, "%s (%s)", left, x->name) : left;
}

static void report_refuted(const Eqns *e, const Expect *x, const char *label) {
  const Model *m = e->m;
  Mend mend = mend_find(e, x);
  const char *difference = difference_text(e, x);
  if (mend.edit) diag_error(m->diags, mend.caret, "expect %s is false: %s", label, mend.edit);
  else diag_error(m->diags, mend.caret, "expect %s is false, and no single edit found makes it true; the fault seems to be here", label);
  if (difference) diag_help(m->diags, "%s", difference);
}

/* Whether all numbers are exact: otherwise what differs need not be different. */
static int numbers_are_exact(const Eqns *e, const Expect *x) {
  VEC(Expr) roots = {0};
  vec_push(e->m->arena, &roots, x->lhs);
  vec_push(e->m->arena, &roots, x->rhs);
  for (uint32_t i = 0; i < e->n; i++) vec_push(e->m->arena, &roots, e->f[i]);
  for (uint32_t i = 0; i < e->mass.n; i++) vec_push(e->m->arena, &roots, e->mass.at[i].e);
  for (uint32_t i = 0; i < e->m->states.n; i++) vec_push(e->m->arena, &roots, e->flow[i]);
  ExprList l = expr_topo(e->g, roots.at, roots.n);
  for (uint32_t i = 0; i < l.n; i++)
    if (expr_is_num(e->g, l.at[i]) && !num_is_exact(expr_number(e->g, l.at[i]))) return 0;
  return 1;
}

#define EXACT_NUMBERS "numbers are exact as fractions of whole numbers up to 9.2e18, others have 16 digits"

static void report_agrees(const Eqns *e, const Expect *x, const ExpectResult *r, int allow_numeric) {
  Diags *d = e->m->diags;
  if (allow_numeric) {
    diag_warning(d, x->span, "expect %s is not proved; the sides agree to %d digits", r->label, r->digits);
    return;
  }
  diag_error(d, x->span, "expect %s is not proved; the sides agree to %d digits at %d random states", r->label, r->digits, r->states);
  const char *cure = "write it in another form, or take agreement in numbers for enough: `lagc check --allow-numeric`";
  diag_help(d, "%s", r->inexact ? arena_printf(e->m->arena, EXACT_NUMBERS "; %s", cure) : cure);
}

static ExpectResult judge(const Eqns *e, const Expect *x) {
  ExpectResult r = {.label = label_of(e->m, x), .span = x->span};
  switch (mend_verdict(e, x->lhs, x->rhs)) {
    case PROVED_ZERO: r.verdict = EXPECT_PROVED; return r;
    case PROVED_NONZERO:
      if (e->constraints.n) break; /* not for all states; but for those that obey the constraints it may hold */
      r.verdict = EXPECT_REFUTED;
      return r;
    case NOT_DECIDED: break;
  }
  r.digits = agreement(e, x, &r.states);
  r.inexact = !numbers_are_exact(e, x);
  r.verdict = !r.states ? EXPECT_UNKNOWN : r.digits >= FEWEST_DIGITS ? EXPECT_AGREES : r.inexact ? EXPECT_UNKNOWN : EXPECT_REFUTED;
  return r;
}

static void report_unknown(const Eqns *e, const Expect *x, const ExpectResult *r) {
  diag_error(e->m->diags, x->span, "expect %s is not decided: no state tried gives both sides a value that means something", r->label);
  diag_help(e->m->diags, "write it where its roots and logarithms are defined, and in numbers of ordinary size%s", r->inexact ? "; " EXACT_NUMBERS : "");
}

/* --- parameters that follow from others --- */

static int is_param(const Symbol *s, const void *data) {
  (void)data;
  return s->kind == SYM_PARAM;
}

/* What parameters stand for that are given by others: param I = m*l^2 follows m and l. Contacts are open, which leaves them no force, but
 * number `closed` (-1: none). NULL when there are none. */
static const Expr *definitions(const Model *m, int closed) {
  Expr *with = ARENA_ARRAY(m->arena, Expr, expr_symbol_count(m->g) + 2 + m->expects.n); /* each expectation may declare one more */
  int some = 0;
  for (uint32_t i = 0; i < m->params.n; i++) {
    const Param *p = &m->params.at[i];
    if (!p->value || !expr_contains(m->g, p->value, is_param, NULL)) continue;
    with[p->sym] = expr_substitute(m->g, p->value, with, expr_symbol_count(m->g) + 1, "");
    some = 1;
  }
  for (uint32_t i = 0; i < m->contacts.n; i++) {
    const Contact *c = &m->contacts.at[i];
    with[c->closed] = expr_int(m->g, (int)i == closed);
    if ((int)i != closed) with[m->constraints.at[c->constraint].multiplier] = expr_int(m->g, 0);
  }
  return some || m->contacts.n ? with : NULL;
}

/* The equations with these definitions in the place of their parameters. */
static const Eqns *with_definitions(const Eqns *e, const Expr *with) {
  if (!with) return e;
  ExprGraph *g = e->g;
  uint32_t n = expr_symbol_count(g) + 1;
  Eqns *c = ARENA_NEW(e->m->arena, Eqns);
  *c = *e;
  c->mass.n = c->mass.cap = 0;
  Expr *f = ARENA_ARRAY(e->m->arena, Expr, e->n + 1), *flow = ARENA_ARRAY(e->m->arena, Expr, e->m->states.n + 1);
  for (uint32_t i = 0; i < e->mass.n; i++) {
    MassEntry entry = e->mass.at[i];
    entry.e = expr_substitute(g, entry.e, with, n, "");
    vec_push(e->m->arena, &c->mass, entry);
  }
  for (uint32_t i = 0; i < e->n; i++) f[i] = expr_substitute(g, e->f[i], with, n, "");
  for (uint32_t i = 0; i < e->m->states.n; i++) flow[i] = expr_substitute(g, e->flow[i], with, n, "");
  c->f = f;
  c->flow = flow;
  c->energy = expr_substitute(g, e->energy, with, n, "");
  c->definitions = with;
  return c;
}

/* The equations of motion with all contacts open, and with each closed alone. */
typedef struct {
  const Expr *with;
  const Eqns *e;
} Case;

static Case *cases_of(const Eqns *e) {
  uint32_t n = e->m->contacts.n;
  Case *cases = ARENA_ARRAY(e->m->arena, Case, (size_t)n + 1);
  for (uint32_t i = 0; i <= n; i++) {
    cases[i].with = definitions(e->m, (int)i - 1);
    cases[i].e = with_definitions(e, cases[i].with);
  }
  return cases;
}

/* The first case in which it is not proved, or the last. */
static ExpectResult judge_cases(const Case *cases, const Expect *x, Expect *shown, const Eqns **e) {
  const Model *m = cases[0].e->m;
  ExpectResult r = {0};
  for (uint32_t i = 0; i <= m->contacts.n; i++) {
    const Expr *with = cases[i].with;
    uint32_t n = expr_symbol_count(m->g) + 1;
    *shown = *x;
    *e = cases[i].e;
    if (with) shown->lhs = expr_substitute(m->g, x->lhs, with, n, "");
    if (with) shown->rhs = expr_substitute(m->g, x->rhs, with, n, "");
    r = judge(*e, shown);
    if (r.verdict == EXPECT_PROVED) continue;
    if (m->contacts.n) r.label = i ? arena_printf(m->arena, "%s, while `%s` is closed,", r.label, m->contacts.at[i - 1].name)
                                   : arena_printf(m->arena, "%s, while all contacts are open,", r.label);
    break;
  }
  return r;
}

void expects_check(const Eqns *e, Name effect, int allow_numeric, ExpectResults *out) {
  const Model *m = e->m;
  const Case *cases = cases_of(e);
  for (uint32_t i = 0; i < m->expects.n; i++) {
    Expect x = m->expects.at[i], shown;
    const Eqns *at;
    if (x.effect != effect) continue;
    x.lhs = charges_fill(e, x.lhs);
    x.rhs = charges_fill(e, x.rhs);
    ExpectResult r = judge_cases(cases, &x, &shown, &at);
    if (r.verdict == EXPECT_REFUTED) report_refuted(at, &shown, r.label);
    if (r.verdict == EXPECT_AGREES) report_agrees(at, &shown, &r, allow_numeric);
    if (r.verdict == EXPECT_UNKNOWN) report_unknown(at, &shown, &r);
    r.label = label_of(m, &x);
    vec_push(m->arena, out, r);
  }
}

static void print_one(const ExpectResult *r, const Sources *sources, StrBuf *out) {
  Place p = source_place(sources, r->span.begin);
  sb_printf(out, "%s:%u: expect %s: ", p.file ? p.file->path : "", p.line, r->label);
  switch (r->verdict) {
    case EXPECT_PROVED: sb_puts(out, "proved\n"); return;
    case EXPECT_REFUTED: sb_puts(out, "refuted\n"); return;
    case EXPECT_AGREES: sb_printf(out, "not proved, agrees to %d digits\n", r->digits); return;
    case EXPECT_UNKNOWN: sb_puts(out, "not decided\n"); return;
  }
}

void expects_print(const ExpectResults *r, const Sources *sources, StrBuf *out) {
  uint32_t proved = 0;
  for (uint32_t i = 0; i < r->n; i++) {
    print_one(&r->at[i], sources, out);
    proved += r->at[i].verdict == EXPECT_PROVED;
  }
  if (r->n) sb_printf(out, "%u of %u expectation%s proved\n", proved, r->n, r->n == 1 ? "" : "s");
}
