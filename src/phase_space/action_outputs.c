/* Curves of the actions that outputs contain. */
#include "phase_space/action_outputs.h"

#include "phase_space/action_variables.h"

static int is_used(const Eqns *e, SymId sym) {
  const Scene *sc = &e->m->scene;
  for (uint32_t i = 0; i < sc->outputs.n; i++)
    if (expr_contains_sym(e->g, sc->outputs.at[i].value, sym)) return 1;
  return 0;
}

static ActionCurve curve_of(const PhaseSpace *s, uint32_t i) {
  const Model *m = s->e->m;
  ExprGraph *g = s->e->g;
  uint32_t n = m->coords.n;
  ActionCurve c = {.name = expr_symbol(g, s->q[i])->name, .periodic = model_is_periodic(s->e->m, s->q[i])};
  Expr *velocity = ARENA_ARRAY(m->arena, Expr, s->n);
  action_roots(s, i, c.roots);
  c.coordinate = s->rate ? i : 2 * n + expr_symbol(g, s->q[i])->index;
  c.momentum = s->rate ? n + i : 2 * n + expr_symbol(g, s->p[i])->index;
  for (uint32_t k = 0; k < s->n && s->rate; k++) velocity[k] = expr_symbol(g, s->v[k])->node;
  for (uint32_t k = 0; k < 4 && s->rate; k++) c.roots[k] = expr_replace(g, c.roots[k], s->p, velocity, s->n);
  return c;
}

/* The value of one action; 0, reported: there is none. */
static Expr value_of(Eqns *e, const PhaseSpace *s, const ActionOutput *a, ActionCurve *curves) {
  const Model *m = e->m;
  ExprGraph *g = e->g;
  const char *why_not;
  uint32_t i = 0;
  while (s->q[i] != a->coordinate) i++;
  PairKind kind = pair_with_action(s, i, &why_not);
  if (why_not) {
    diag_error(m->diags, a->span, "`%s` has no action variable: %s", a->name, why_not);
    if (kind == PAIR_TIED)
      diag_help(m->diags,
                "`lagc action` tells which coordinates separate; others than these may: `lagc help canonical`");
    return 0;
  }
  if (kind == PAIR_CYCLIC) return s->rate ? e->p[i] : expr_symbol(g, s->p[i])->node;
  SymId sym = expr_declare(g, SYM_INPUT, m->inputs.n + m->scene.exacts.n + e->nactions, expr_symbol(g, a->sym)->name,
                           SIGN_UNKNOWN);
  curves[e->nactions++] = curve_of(s, i);
  return expr_symbol(g, sym)->node;
}

int action_outputs(Eqns *e, Expr *value) {
  const Model *m = e->m;
  PhaseSpace s = {0};
  ActionCurve *curves = ARENA_ARRAY(m->arena, ActionCurve, m->actions.n + 1);
  e->actions = curves;
  for (uint32_t k = 0; k < m->actions.n; k++) {
    const ActionOutput *a = &m->actions.at[k];
    if (!is_used(e, a->sym)) continue;
    const char *why_not = s.e ? NULL : phase_space_try(e, &s);
    if (why_not)
      return diag_error(m->diags, a->span, "no action variable of `%s` in closed form: %s", a->name, why_not);
    s.H = expr_expand_defs(e->g, s.H);
    if (!(value[k] = value_of(e, &s, a, curves))) return 0;
  }
  return 1;
}
