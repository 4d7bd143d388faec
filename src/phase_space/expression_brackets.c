/* Partial derivatives in canonical coordinates; the result goes back to velocities by p = dL/dq'. */
#include "phase_space/expression_brackets.h"

#include "mech/hamilton.h"
#include "mech/states.h"
#include "sym/diff.h"
#include "sym/jump.h"
#include "sym/simplify.h"

const char *phase_space_try(Eqns *e, PhaseSpace *s) {
  const Model *m = e->m;
  *s = (PhaseSpace){.e = e, .n = m->hamiltonian ? m->pairs.n : e->n};
  if (!m->hamiltonian) {
    Hamilton h = hamilton_derive(e);
    s->q = eqns_symbols(e, 0), s->v = eqns_symbols(e, 1), s->p = h.p, s->rate = h.rate, s->H = h.H;
    return h.is_closed ? NULL : h.why_not;
  }
  SymId *q = ARENA_ARRAY(m->arena, SymId, s->n + 1), *p = ARENA_ARRAY(m->arena, SymId, s->n + 1);
  for (uint32_t i = 0; i < s->n; i++) {
    q[i] = m->states.at[m->pairs.at[i].q].z;
    p[i] = m->states.at[m->pairs.at[i].p].z;
  }
  s->q = q, s->p = p, s->H = expr_expand_defs(e->g, e->energy);
  return NULL;
}

int phase_space_of(Eqns *e, Span span, PhaseSpace *s) {
  const char *why_not = phase_space_try(e, s);
  if (why_not) diag_error(e->m->diags, span, "no bracket in closed form: %s", why_not);
  return !why_not;
}

Expr phase_space_expression(const PhaseSpace *s, Expr x) {
  ExprGraph *g = s->e->g;
  Expr energy = s->e->energy;
  x = expression_brackets_substitute(s->e, x, 1);
  if (energy) x = expr_replace(g, x, &s->e->m->energy_sym, &energy, 1);
  x = expr_expand_defs(g, x);
  if (!s->rate) x = states_substitute(s->e, x); /* q' = dH/dp */
  return s->rate ? expr_replace(g, x, s->v, s->rate, s->n) : x;
}

Expr poisson_bracket(ExprGraph *g, Expr f, Expr h, const SymId *q, const SymId *p, uint32_t n) {
  Expr *d = ARENA_ARRAY(expr_arena(g), Expr, 4 * (size_t)n + 1), *fq = d, *fp = fq + n, *hq = fp + n, *hp = hq + n,
       sum = expr_int(g, 0);
  expr_gradient(g, f, q, n, fq);
  expr_gradient(g, f, p, n, fp);
  expr_gradient(g, h, q, n, hq);
  expr_gradient(g, h, p, n, hp);
  for (uint32_t i = 0; i < n; i++) {
    Expr one = expr_mul(g, fq[i], hp[i]), other = expr_mul(g, fp[i], hq[i]), both = expr_sub(g, one, other);
    sum = expr_add(g, sum, both);
  }
  return simplify(g, sum);
}

/* Both conditions; 0: always. */
static Expr both(ExprGraph *g, Expr a, Expr b) { return !a ? b : !b ? a : expr_fn2(g, EX_AND, a, b); }

Expr expression_brackets_domain(const Eqns *e, Expr x, int *jumps) {
  Expr all = 0;
  for (uint32_t i = 0; i < e->nbrackets; i++) {
    if (!e->brackets[i].domain || !expr_contains_sym(e->g, x, e->m->brackets.at[i].sym)) continue;
    all = both(e->g, all, e->brackets[i].domain);
    *jumps |= e->brackets[i].jumps;
  }
  return all;
}

int expression_brackets_derive(Eqns *e, const ChargeNames *charges) {
  const Model *m = e->m;
  PhaseSpace s;
  if (!m->brackets.n) return 1;
  if (!phase_space_of(e, m->brackets.at[0].span, &s)) return 0;
  struct BracketValue *all = ARENA_ARRAY(m->arena, struct BracketValue, m->brackets.n);
  e->brackets = all;
  for (e->nbrackets = 0; e->nbrackets < m->brackets.n; e->nbrackets++) {
    const ExpressionBracket *b = &m->brackets.at[e->nbrackets];
    Expr part[2] = {b->f, b->g};
    for (int k = 0; k < 2; k++)
      part[k] = phase_space_expression(&s, expr_replace(e->g, part[k], charges->sym, charges->value, charges->n));
    Expr shown = poisson_bracket(e->g, part[0], part[1], s.q, s.p, s.n);
    struct BracketValue x = {.value = shown, .shown = shown};
    x.domain = both(e->g, expr_smooth_domain(e->g, part, 2, &x.jumps),
                    expression_brackets_domain(e, expr_add(e->g, b->f, b->g), &x.jumps));
    if (!m->hamiltonian) x.value = expr_replace(e->g, shown, s.p, e->p, s.n);
    if (!m->hamiltonian && x.domain) x.domain = expr_replace(e->g, x.domain, s.p, e->p, s.n);
    all[e->nbrackets] = x;
  }
  return 1;
}

Expr expression_brackets_substitute(const Eqns *e, Expr x, int in_momenta) {
  if (!e->nbrackets || !(expr_kinds(e->g, x) & 1u << SYM_LOCAL)) return x;
  SymId *syms = ARENA_ARRAY(e->m->arena, SymId, e->nbrackets);
  Expr *with = ARENA_ARRAY(e->m->arena, Expr, e->nbrackets);
  for (uint32_t i = 0; i < e->nbrackets; i++) {
    syms[i] = e->m->brackets.at[i].sym;
    with[i] = in_momenta ? e->brackets[i].shown : e->brackets[i].value;
  }
  return expr_replace(e->g, x, syms, with, e->nbrackets);
}
