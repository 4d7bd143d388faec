/* Verdict on an expectation: a state at which the sides differ, else a proof for all states, else a proof by cases.
 * With contacts, the equations are judged with all contacts open, and with each closed alone. */
#include "claims/expect.h"

#include "claims/case_proofs.h"
#include "symmetry/charges.h"
#include "phase_space/expression_brackets.h"
#include "claims/suggest_correction.h"
#include "claims/counterexample.h"

/* --- verdicts --- */

static const char *label_of(const Model *m, const Expect *x) {
  const char *left = short_text(m->ast, ast_expr(m->ast, x->lhs_ast)->span);
  return x->name ? arena_printf(m->arena, "%s (%s)", left, x->name) : left;
}

static void report_refuted(const Eqns *e, const Expect *x, const char *label, const char *difference) {
  const Model *m = e->m;
  SuggestedEdit mend = suggest_correction(e, x);
  if (mend.edit) diag_error(m->diags, mend.caret, "expect %s is false: %s", label, mend.edit);
  else diag_error(m->diags, mend.caret, "expect %s is false, and no single edit found makes it true", label);
  diag_help(m->diags, "%s", difference);
}

/* Whether all numbers are exact: otherwise a nonzero difference may be rounding. */
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
  const char *text = arena_printf(
      e->m->arena, "expect %s is not decided: no proof is found, and at all states tried the sides agree to %d digits",
      r->label, r->digits);
  if (allow_numeric) {
    diag_warning(d, x->span, "%s", text);
    return;
  }
  diag_error(d, x->span, "%s", text);
  const char *cure = "write it in another form, or accept agreement in numbers: `lagc check --allow-numeric`";
  diag_help(d, "%s", r->inexact ? arena_printf(e->m->arena, EXACT_NUMBERS "; %s", cure) : cure);
}

/* A state at which the sides differ refutes, whatever a proof says; without one, a proof decides. */
ExpectResult expect_judge(const Eqns *e, const CaseSymbols *symbols, const Expect *x) {
  enum { FEW_UNKNOWNS = 12 };
  ExpectResult r = {.label = x->lhs_ast ? label_of(e->m, x) : x->name, .span = x->span};
  Verdict v = prove_by_motion(e, x->lhs, x->rhs);
  Counterexample w = {0};
  int proved = v == PROVED_ZERO;
  if (!proved || e->n + e->constraints.n <= FEW_UNKNOWNS) w = counterexample_find(e, x, proved);
  r.difference = w.text;
  r.digits = w.digits;
  r.states = w.states;
  proved = !w.text && (proved || (w.states && prove_by_cases(e, symbols, x->lhs, x->rhs, x->domain)));
  if (proved) return r; /* EXPECT_PROVED */
  r.inexact = !numbers_are_exact(e, x);
  int somewhere_false = v == PROVED_NONZERO && !e->constraints.n; /* constraints exclude states */
  r.missing = !w.states ? NULL : somewhere_false ? "the difference that the proof finds" : w.missing;
  r.verdict = w.text ? EXPECT_REFUTED : w.states && !r.missing ? EXPECT_AGREES : EXPECT_UNKNOWN;
  return r;
}

static void report_unknown(const Eqns *e, const Expect *x, const ExpectResult *r) {
  if (r->missing) {
    diag_error(e->m->diags, x->span,
               "expect %s is not decided: no proof is found, and no state that was compared shows %s" HELP
               "state the expectation for one side of the switch alone, or in another form%s",
               r->label, r->missing, r->inexact ? "; " EXACT_NUMBERS : "");
    return;
  }
  diag_error(e->m->diags, x->span,
             "expect %s is not decided: no state tried gives both sides a meaningful value" HELP
             "state the expectation where its roots and logarithms are defined, with numbers of ordinary size%s",
             r->label, r->inexact ? "; " EXACT_NUMBERS : "");
}

/* --- parameters that follow from others, and contacts --- */

/* Substitutions for parameters that are given by others (param I = m*l^2 follows m and l), and for contacts: open
 * and without force, but for number `closed` (-1: none). NULL: there are none. */
static const Expr *parameter_substitutions(const Model *m, int closed) {
  /* each expectation may declare one more symbol */
  Expr *with = ARENA_ARRAY(m->arena, Expr, expr_symbol_count(m->g) + 2 + m->expects.n);
  int some = 0;
  vec_each(const Param, p, m->params) {
    if (!p->value || !(expr_kinds(m->g, p->value) & 1u << SYM_PARAM)) continue;
    with[p->sym] = expr_substitute(m->g, p->value, with, expr_symbol_count(m->g) + 1, "");
    some = 1;
  }
  for (uint32_t i = 0; i < m->contacts.n; i++) {
    const Contact *c = &m->contacts.at[i];
    with[c->closed] = expr_int(m->g, (int)i == closed);
    if (c->is_tangent && (int)i != closed && (int)i - 1 != closed &&
        !((int)i - 2 == closed && m->contacts.at[i - 1].is_tangent))
      with[c->force] = expr_int(m->g, 0);
    if ((int)i != closed) with[m->constraints.at[c->constraint].multiplier] = expr_int(m->g, 0);
  }
  return some || m->contacts.n ? with : NULL;
}

/* The equations of motion with all contacts open, and with each closed alone. */
typedef struct {
  const Expr *with;
  const Eqns *e;
} ContactCase;

static ContactCase *contact_cases(const Eqns *e) {
  uint32_t n = e->m->contacts.n;
  ContactCase *cases = ARENA_ARRAY(e->m->arena, ContactCase, (size_t)n + 1);
  for (uint32_t i = 0; i <= n; i++) {
    cases[i].with = parameter_substitutions(e->m, (int)i - 1);
    cases[i].e = equations_with(e, cases[i].with);
  }
  return cases;
}

/* Verdict in the first case in which the expectation is not proved, or in the last. */
static ExpectResult judge_cases(const ContactCase *cases, const CaseSymbols *symbols, const Expect *x, Expect *shown,
                                const Eqns **e) {
  const Model *m = cases[0].e->m;
  ExpectResult r = {0};
  for (uint32_t i = 0; i <= m->contacts.n; i++) {
    const Expr *with = cases[i].with;
    uint32_t n = expr_symbol_count(m->g) + 1;
    *shown = *x;
    *e = cases[i].e;
    if (with) shown->lhs = expr_substitute(m->g, x->lhs, with, n, "");
    if (with) shown->rhs = expr_substitute(m->g, x->rhs, with, n, "");
    if (with && x->domain) shown->domain = expr_substitute(m->g, x->domain, with, n, "");
    r = expect_judge(*e, symbols, shown);
    if (r.verdict == EXPECT_PROVED) continue;
    if (m->contacts.n)
      r.label = i ? arena_printf(m->arena, "%s, while `%s` is closed,", r.label, m->contacts.at[i - 1].name)
                  : arena_printf(m->arena, "%s, while all contacts are open,", r.label);
    break;
  }
  return r;
}

/* Domain of an expectation: that of its text and of its brackets, and, if it uses accelerations,
 * multipliers, rates or the energy, that of the equations of motion. */
static Expr domain_of(const Eqns *e, const Expect *x, Expr brackets) {
  const unsigned solved = 1u << SYM_ACC | 1u << SYM_MULTIPLIER | 1u << SYM_RATE | 1u << SYM_LOCAL;
  Expr domain = x->domain ? charges_substitute(e, x->domain) : 0, motion = e->m->domain;
  int uses = ((expr_kinds(e->g, x->lhs) | expr_kinds(e->g, x->rhs)) & solved) != 0;
  if (brackets) domain = domain ? expr_fn2(e->g, EX_AND, domain, brackets) : brackets;
  return !uses || !motion ? domain : domain ? expr_fn2(e->g, EX_AND, domain, motion) : motion;
}

/* The nodes of a side with the values of their brackets, so that no correction names a placeholder. */
static const Expr *nodes_with_brackets(const Eqns *e, AstId side, const Expr *nodes) {
  uint32_t n = side - ast_expr(e->m->ast, side)->first + 1;
  Expr *out = ARENA_ARRAY(e->m->arena, Expr, n);
  if (!nodes || !e->nbrackets) return nodes;
  for (uint32_t i = 0; i < n; i++) out[i] = nodes[i] ? expression_brackets_substitute(e, nodes[i], 0) : 0;
  return out;
}

void expects_check(const Eqns *e, Name effect, int allow_numeric, ExpectResults *out) {
  const Model *m = e->m;
  const CaseSymbols symbols = cases_symbols(m);
  const ContactCase *cases = contact_cases(e);
  for (uint32_t i = 0; i < m->expects.n; i++) {
    Expect x = m->expects.at[i], shown;
    const Eqns *at;
    if (x.effect != effect) continue;
    int between = 0;
    Expr brackets = expression_brackets_domain(e, expr_sub(e->g, x.lhs, x.rhs), &between);
    x.lhs = charges_substitute(e, x.lhs);
    x.rhs = charges_substitute(e, x.rhs);
    x.domain = domain_of(e, &x, brackets);
    x.nodes[0] = nodes_with_brackets(e, x.lhs_ast, x.nodes[0]);
    x.nodes[1] = nodes_with_brackets(e, x.rhs_ast, x.nodes[1]);
    ExpectResult r = judge_cases(cases, &symbols, &x, &shown, &at);
    if (r.verdict == EXPECT_REFUTED) report_refuted(at, &shown, r.label, r.difference);
    if (r.verdict == EXPECT_AGREES) report_agrees(at, &shown, &r, allow_numeric);
    if (r.verdict == EXPECT_UNKNOWN) report_unknown(at, &shown, &r);
    r.label = label_of(m, &x);
    r.between = between;
    vec_push(m->arena, out, r);
  }
}

static void print_one(const ExpectResult *r, const Sources *sources, StrBuf *out) {
  Place p = source_place(sources, r->span.begin);
  sb_printf(out, "%s:%u: expect %s: ", p.file ? p.file->path : "", p.line, r->label);
  switch (r->verdict) {
    case EXPECT_PROVED: sb_puts(out, r->between ? "proved between jumps\n" : "proved\n"); return;
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
  if (r->n)
    sb_printf(out, "%u of %u expectation%s proved%s\n", proved, r->n, r->n == 1 ? "" : "s",
              proved ? ": for all states at which both sides have real values" : "");
}
