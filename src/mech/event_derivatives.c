/* Eqns -> derivatives of event functions and of the values that actions assign, for saltation matrices at events (runtime/core/tangent.c). */
#include "mech/event_derivatives.h"

#include "sym/diff.h"
#include "sym/simplify.h"

typedef VEC(EventPartial) EventPartialList;

static void add(const Eqns *e, EventPartialList *to, uint32_t event, int row, uint32_t col, Expr value) {
  value = simplify_shallow(e->g, value);
  if (!expr_is_zero(e->g, value) || row == (int)col) vec_push(e->m->arena, to, ((EventPartial){event, row, col, value}));
}

/* Derivatives of one value by the state, columns ascending, then by the time. */
static void differentiate(const Eqns *e, Expr value, uint32_t event, int row, EventPartialList *to) {
  const Model *m = e->m;
  const struct {
    SymKind kind;
    uint32_t n, first; /* first column */
  } blocks[] = {{SYM_COORD, e->n, 0}, {SYM_VEL, e->n, e->n}, {SYM_STATE, m->states.n, 2 * e->n}};
  int own = 0;
  for (int b = 0; b < 3; b++) {
    ExprPartials d = expr_gradient_sparse(e->g, value, blocks[b].kind, blocks[b].n);
    for (uint32_t k = 0; k < d.n; k++) {
      uint32_t col = blocks[b].first + d.at[k].index;
      own |= row == (int)col;
      add(e, to, event, row, col, d.at[k].e);
    }
  }
  if (row >= 0 && !own) add(e, to, event, row, (uint32_t)row, expr_int(e->g, 0));
  add(e, to, event, row, 2 * e->n + m->states.n, expr_diff(e->g, value, m->time));
}

static int is_input(const Symbol *s, const void *data) { return (void)data, s->kind == SYM_INPUT; }

static int depends_on_inputs(const Eqns *e, const Event *ev) {
  int some = expr_contains(e->g, ev->g, is_input, NULL);
  for (uint32_t i = 0; i < ev->actions.n; i++) some |= expr_contains(e->g, ev->actions.at[i].value, is_input, NULL);
  return some;
}

EventPartials eqns_event_derivatives(const Eqns *e) {
  const Model *m = e->m;
  EventPartialList found = {0};
  for (uint32_t k = 0; k < m->events.n; k++) {
    const Event *ev = &m->events.at[k];
    if (!ev->actions.n || depends_on_inputs(e, ev)) continue;
    differentiate(e, ev->g, k, -1, &found);
    for (uint32_t i = 0; i < ev->actions.n; i++) {
      const Symbol *s = expr_symbol(e->g, ev->actions.at[i].target);
      uint32_t first = s->kind == SYM_COORD ? 0 : s->kind == SYM_VEL ? e->n : 2 * e->n;
      differentiate(e, ev->actions.at[i].value, k, (int)(first + s->index), &found);
    }
  }
  return (EventPartials){found.at, found.n};
}
