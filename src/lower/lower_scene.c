/* Programs of a scene: values of its parameters, and its start. */
#include "lower/lower_impl.h"

/* The tidy program; the memory of the lowering is given up. */
static Prog *tidied(Lower *l) {
  Prog *p = prog_tidy(l->p);
  prog_release(l->p);
  arena_release(l->slots.arena, l->slots.at, l->slots.cap * sizeof *l->slots.at);
  return p;
}

/* Whether a value reads parameters of the model from number `first` on. */
static int reads_params_from(ExprGraph *g, Expr value, uint32_t first) {
  if (!(expr_kinds(g, value) & 1u << SYM_PARAM)) return 0;
  ExprList l = expr_topo(g, &value, 1);
  for (uint32_t k = 0; k < l.n; k++) {
    const Symbol *s = expr_op(g, l.at[k]) == EX_SYM ? expr_sym_of(g, l.at[k]) : NULL;
    if (s && s->kind == SYM_PARAM && s->index >= first) return 1;
  }
  return 0;
}

IrParams lower_params(const Eqns *e, uint32_t *i) {
  const Model *m = e->m;
  Lower l = lower_by_text(e);
  IrParams r = {0};
  VEC(Expr) roots = {0};
  const Param *from = &m->params.at[*i], *end = from;
  for (; *i < m->params.n; ++*i, ++end) {
    if (end->fixed) continue;
    if (r.n && reads_params_from(e->g, end->value, (uint32_t)(from - m->params.at))) break;
    if (!r.n++) r.first = end->place;
    vec_push(m->arena, &roots, end->value);
  }
  lower_roots(&l, roots.at, roots.n);
  for (const Param *p = from; p < end; p++)
    if (!p->fixed) prog_store(l.p, 0, p->place, lower_slot(&l, p->value), p->name);
  r.values = tidied(&l);
  return r;
}

/* Starts of a family as a loop around one body. */
static void lower_family_start(Lower *l, const FamilyStart *f) {
  const FamilyValue *x = &f->of;
  Arena *a = l->p->arena;
  Lower body = lower_by_text(l->e);
  Nest n = {.rows = x->range.rows, .turns = x->range.turns};
  VEC(IrSubscript) at = {0};
  VEC(Slot) outer = {0};
  ExprList list = expr_topo(l->g, x->value, x->n);
  for (uint32_t k = 0; k < list.n; k++) {
    if (expr_op(l->g, list.at[k]) != EX_SYM) continue;
    SymId id = expr_sym_id(l->g, list.at[k]);
    Ins load = {.op = IR_LOAD, .array = ARR_INDEX, .index = at.n, .name = expr_symbol(l->g, id)->name};
    int which = id == x->index[1];
    if (which || id == x->index[0]) {
      vec_push(a, &at, ((IrSubscript){x->lo[which], !which, which}));
    } else {
      lower_roots(l, &list.at[k], 1);
      load.array = ARR_OUTER, load.index = outer.n;
      vec_push(a, &outer, lower_slot(l, list.at[k]));
    }
    Slot s = prog_ins(body.p, load);
    expr_map_set(&body.slots, list.at[k], s + 1);
  }
  lower_roots(&body, x->value, x->n);
  for (uint32_t k = 0; k < x->n; k++) {
    const Symbol *one = expr_symbol(l->g, model_start_target(l->e->m, f, 0, 0, k)),
                 *last = expr_symbol(l->g, model_start_target(l->e->m, f, n.rows - 1, n.turns - 1, k));
    prog_store(body.p, NEST_SETS + lower_array_of_target(f->kind), at.n, lower_slot(&body, x->value[k]),
               arena_printf(a, "%s ... %s", one->name, last->name));
    vec_push(a, &at, ((IrSubscript){x->at.first + k, x->at.by_row, x->at.by_turn}));
  }
  n.count = n.rows * (uint32_t)n.turns;
  n.body = tidied(&body);
  n.at = at.at, n.n = at.n, n.outer = outer.at, n.nouter = outer.n;
  vec_push(a, &l->p->nests, n);
  prog_ins(l->p, (Ins){.op = IR_NEST, .index = l->p->nests.n - 1});
}

Prog *lower_start(const Eqns *e) {
  Lower l = lower_by_text(e);
  const Scene *sc = &e->m->scene;
  for (uint32_t i = 0; i < sc->family_starts.n; i++) lower_family_start(&l, &sc->family_starts.at[i]);
  for (uint32_t i = 0; i < sc->starts.n; i++) lower_roots(&l, &sc->starts.at[i].value, 1);
  for (uint32_t i = 0; i < sc->starts.n; i++) lower_store_target(&l, sc->starts.at[i].target, sc->starts.at[i].value);
  return tidied(&l);
}
