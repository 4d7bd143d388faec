/* What a model with constraints has besides its accelerations. */
#include "ir/lower_impl.h"

Prog *lower_residuals(const Eqns *e) {
  const Constraints *k = &e->constraints;
  Lower l = lower_new(e);
  Arena *a = l.p->arena;
  lower_roots(&l, k->c, k->nholonomic);
  lower_roots(&l, k->r, k->n);
  for (uint32_t i = 0; i < k->nholonomic; i++) prog_store(l.p, 0, i, lower_slot(&l, k->c[i]), k->of[i]->name);
  for (uint32_t i = 0; i < k->n; i++)
    prog_store(l.p, 1, i, lower_slot(&l, k->r[i]), i < k->nholonomic ? arena_printf(a, "%s'", k->of[i]->name) : k->of[i]->name);
  return prog_tidy(l.p);
}

static void store_entries(Lower *l, uint32_t array, const Entries *x) {
  const Model *m = l->e->m;
  for (uint32_t i = 0; i < x->n; i++) lower_roots(l, &x->at[i].e, 1);
  for (uint32_t i = 0; i < x->n; i++) {
    const char *row = array ? m->coords.at[x->at[i].row].name : l->e->constraints.of[x->at[i].row]->name;
    prog_store(l->p, array, i, lower_slot(l, x->at[i].e), arena_printf(l->p->arena, "%s, %s", row, m->coords.at[x->at[i].col].name));
  }
}

Prog *lower_matrices(const Eqns *e) {
  Lower l = lower_new(e);
  store_entries(&l, 0, &e->constraints.A);
  store_entries(&l, 1, &e->mass);
  return prog_tidy(l.p);
}

Prog *lower_change(const Eqns *e, uint32_t nrows) {
  const Model *m = e->m;
  Lower l = lower_new(e);
  Arena *a = l.p->arena;
  Slot *g = ARENA_ARRAY(a, Slot, nrows + 1), *d = ARENA_ARRAY(a, Slot, e->n + 1), *force = ARENA_ARRAY(a, Slot, e->n + 1);
  for (uint32_t i = 0; i < nrows; i++)
    g[i] = prog_ins(l.p, (Ins){.op = IR_LOAD, .array = ARR_G, .index = i, .name = e->constraints.of[i]->name});
  lower_correction(&l, nrows, g, d, force);
  for (uint32_t i = 0; i < e->n; i++) prog_store(l.p, 0, i, d[i], m->coords.at[i].name);
  for (uint32_t i = 0; i < e->n; i++) prog_store(l.p, 1, i, force[i], m->coords.at[i].name);
  return prog_tidy(l.p);
}
