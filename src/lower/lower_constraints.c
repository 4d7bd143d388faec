/* Programs of models with constraints: residuals, matrices A and M, projections, impacts, multipliers. */
#include "ir/passes.h"
#include "lower/lower_impl.h"

Prog *lower_residuals(const Eqns *e) {
  const Constraints *k = &e->constraints;
  Lower l = lower_new(e);
  Arena *a = l.p->arena;
  lower_roots(&l, k->c, k->nkept);
  lower_roots(&l, k->r, k->n);
  for (uint32_t i = 0; i < k->nkept; i++) prog_store(l.p, 0, i, lower_slot(&l, k->c[i]), k->of[i]->name);
  for (uint32_t i = 0; i < k->n; i++)
    prog_store(l.p, 1, i, lower_slot(&l, k->r[i]), i < k->nkept ? arena_printf(a, "%s'", k->of[i]->name) : k->of[i]->name);
  return passes_run(l.p, &(PassPlan){0}, NULL);
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
  return passes_run(l.p, &(PassPlan){0}, NULL);
}

Prog *lower_projection(const Eqns *e, uint32_t nrows) {
  const Model *m = e->m;
  Lower l = lower_new(e);
  Arena *a = l.p->arena;
  Slot *g = ARENA_ARRAY(a, Slot, nrows + 1), *d = ARENA_ARRAY(a, Slot, e->n + 1), *force = ARENA_ARRAY(a, Slot, e->n + 1);
  for (uint32_t i = 0; i < nrows; i++)
    g[i] = prog_ins(l.p, (Ins){.op = IR_LOAD, .array = ARR_G, .index = i, .name = e->constraints.of[i]->name});
  lower_correction(&l, nrows, 1, g, d, force);
  for (uint32_t i = 0; i < e->n; i++) prog_store(l.p, 0, i, d[i], m->coords.at[i].name);
  for (uint32_t i = 0; i < e->n; i++) prog_store(l.p, 1, i, force[i], m->coords.at[i].name);
  return passes_run(l.p, &(PassPlan){0}, NULL);
}

/* Newton's law of restitution for the contact, J v1 + g_t = -e (J v + g_t), with the impulse M (v1 - v) = A^T Lambda that keeps all other
 * constraints and closed contacts; the contact's own row of A is made active by setting its input `closed` to 1. */
Prog *lower_impact(const Eqns *e, const Contact *contact) {
  const Model *m = e->m;
  const Constraints *k = &e->constraints;
  ExprGraph *g = e->g;
  Arena *a = m->arena;
  Eqns closed = *e;
  Expr *with = ARENA_ARRAY(a, Expr, expr_symbol_count(g) + 1), back;
  with[contact->closed] = expr_int(g, 1);
  closed.constraints.A = (Entries){0};
  for (uint32_t i = 0; i < k->A.n; i++) {
    MassEntry x = k->A.at[i];
    x.e = expr_substitute(g, x.e, with, expr_symbol_count(g) + 1, "");
    vec_push(a, &closed.constraints.A, x);
  }
  Lower l = lower_new(&closed);
  Slot *demand = ARENA_ARRAY(a, Slot, k->n + 1), *d = ARENA_ARRAY(a, Slot, e->n + 1), *force = ARENA_ARRAY(a, Slot, e->n + 1);
  for (uint32_t i = 0; i < k->n; i++) {
    if (k->of[i] != &m->constraints.at[contact->constraint]) continue;
    Expr speed = expr_substitute(g, k->r[i], with, expr_symbol_count(g) + 1, ""), one = expr_int(g, 1);
    Expr both = expr_add(g, one, contact->restitution), change = expr_mul(g, both, speed);
    back = expr_neg(g, change);
    lower_roots(&l, &back, 1);
    demand[i] = lower_slot(&l, back);
  }
  lower_correction(&l, k->n, 0, demand, d, force);
  for (uint32_t i = 0; i < e->n; i++) {
    Expr v = expr_symbol(g, m->coords.at[i].v)->node;
    lower_roots(&l, &v, 1);
    Slot after = d[i] ? prog_op(l.p, IR_ADD, lower_slot(&l, v), d[i]) : 0;
    if (after) prog_store(l.p, 1, i, after, expr_symbol(g, m->coords.at[i].v)->name);
  }
  return passes_run(l.p, &(PassPlan){0}, NULL);
}

Prog *lower_multipliers(const Eqns *e) {
  Lower l = lower_new(e);
  Slot *acc = ARENA_ARRAY(e->m->arena, Slot, e->n + 1);
  lower_solution(&l, acc);
  for (uint32_t k = 0; k < e->constraints.n; k++) prog_store(l.p, 0, k, l.multipliers[k], e->constraints.of[k]->name);
  return passes_run(l.p, &(PassPlan){0}, NULL);
}
