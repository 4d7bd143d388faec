/* Programs of models with constraints: residuals, matrices A and M, projections, impacts, multipliers, laws of
 * contacts. */
#include "lower/lower_impl.h"
#include "mech/constrain.h"

Prog *lower_residuals(const Eqns *e) {
  const Constraints *k = &e->constraints;
  Lower l = lower_new(e);
  Arena *a = l.p->arena;
  lower_roots(&l, k->c, k->nkept);
  lower_roots(&l, k->r, k->n);
  for (uint32_t i = 0; i < k->nkept; i++) prog_store(l.p, 0, i, lower_slot(&l, k->c[i]), k->of[i]->name);
  for (uint32_t i = 0; i < k->n; i++)
    prog_store(l.p, 1, i, lower_slot(&l, k->r[i]),
               i < k->nkept ? arena_printf(a, "%s'", k->of[i]->name) : k->of[i]->name);
  return lower_finish(&l, &(PassPlan){0}, NULL);
}

static void store_entries(Lower *l, uint32_t array, const Entries *x) {
  const Model *m = l->e->m;
  for (uint32_t i = 0; i < x->n; i++) lower_roots(l, &x->at[i].e, 1);
  for (uint32_t i = 0; i < x->n; i++) {
    const char *row = array ? m->coords.at[x->at[i].row].name : l->e->constraints.of[x->at[i].row]->name;
    prog_store(l->p, array, i, lower_slot(l, x->at[i].e),
               arena_printf(l->p->arena, "%s, %s", row, m->coords.at[x->at[i].col].name));
  }
}

Prog *lower_matrices(const Eqns *e) {
  Lower l = lower_new(e);
  store_entries(&l, 0, &e->constraints.A);
  store_entries(&l, 1, &e->mass);
  return lower_finish(&l, &(PassPlan){0}, NULL);
}

/* Stores 3 components of the force of each guide, by the multipliers of l. */
static void store_guide_loads(Lower *l) {
  const Eqns *e = l->e;
  const Model *m = e->m;
  uint32_t at = 0;
  for (uint32_t i = 0; i < m->contacts.n; i++) {
    const Contact *c = &m->contacts.at[i];
    for (uint32_t k = 0; k < 3 && c->parts; k++) {
      Slot sum = 0;
      for (uint32_t r = 0; k < c->parts && r < e->constraints.n; r++) {
        Expr slope = expr_diff(e->g, c->normal[k], e->constraints.of[r]->multiplier);
        lower_roots(l, &slope, 1);
        sum = prog_add_product(l->p, sum, lower_slot(l, slope), l->multipliers[r]);
      }
      prog_store(l->p, 2, at++, sum, c->name);
    }
  }
}

/* The least change d with A d = g of the first nrows constraints, and M d; loads: those of guides by M d, too. */
static Prog *lower_least_change(const Eqns *e, uint32_t nrows, int loads) {
  const Model *m = e->m;
  Lower l = lower_new(e);
  Arena *a = l.p->arena;
  Slot *g = ARENA_ARRAY(a, Slot, nrows + 1), *d = ARENA_ARRAY(a, Slot, e->n + 1),
       *force = ARENA_ARRAY(a, Slot, e->n + 1);
  for (uint32_t i = 0; i < nrows; i++)
    g[i] = prog_ins(l.p, (Ins){.op = IR_LOAD, .array = ARR_G, .index = i, .name = e->constraints.of[i]->name});
  lower_correction(&l, nrows, 1, g, NULL, d, force);
  for (uint32_t i = 0; i < e->n; i++) prog_store(l.p, 0, i, d[i], m->coords.at[i].name);
  for (uint32_t i = 0; i < e->n; i++) prog_store(l.p, 1, i, force[i], m->coords.at[i].name);
  if (loads) store_guide_loads(&l);
  return lower_finish(&l, &(PassPlan){0}, NULL);
}

Prog *lower_projection(const Eqns *e, uint32_t nrows) { return lower_least_change(e, nrows, 0); }

Prog *lower_guide_loads(const Eqns *e) {
  uint32_t guides = 0, n = e->m->contacts.n;
  for (uint32_t i = 0; i < n; i++) guides += e->m->contacts.at[i].parts > 0;
  return guides && (guides < n || e->m->families.n) ? lower_least_change(e, e->constraints.n, 1) : NULL;
}

/* The contact of row i of A, if it has a law of impact of its own, or NULL. */
static const Contact *striking_contact(const Eqns *e, uint32_t i) {
  const Contact *c = contact_of_constraint(e->m, e->constraints.of[i]);
  return c && !c->margin && !c->is_tangent ? c : NULL;
}

/* x of a constraint that is closed. */
static Expr as_closed(const Eqns *e, const Contact *c, Expr x) {
  Expr *with = ARENA_ARRAY(e->m->arena, Expr, c->closed + 1);
  with[c->closed] = expr_int(e->g, 1);
  return expr_substitute(e->g, x, with, c->closed + 1, "");
}

/* e with the rows of A of contacts that strike as if all were closed. */
static Eqns with_closed_rows(const Eqns *e) {
  Eqns to = *e;
  to.constraints.A = (Entries){0};
  for (uint32_t i = 0; i < e->constraints.A.n; i++) {
    MassEntry x = e->constraints.A.at[i];
    const Contact *c = striking_contact(e, x.row);
    if (c) x.e = as_closed(e, c, x.e);
    vec_push(e->m->arena, &to.constraints.A, x);
  }
  return to;
}

/* The change of the rate of contact c by its impact, where g names it. */
static Slot impact_change(Lower *l, const Eqns *e, const Contact *c, uint32_t row) {
  ExprGraph *g = e->g;
  Expr speed = as_closed(e, c, e->constraints.r[row]), one = expr_int(g, 1), both = expr_add(g, one, c->restitution),
       change = expr_mul(g, both, speed), back = expr_neg(g, change);
  lower_roots(l, &back, 1);
  Slot named = prog_ins(l->p, (Ins){.op = IR_LOAD, .array = ARR_G, .index = row, .name = e->constraints.of[row]->name});
  return prog_op(l->p, IR_MUL, lower_slot(l, back), named);
}

/* Newton's law of restitution for the contact that g names by a 1, J v1 + g_t = -e (J v + g_t), with the impulse M
 * (v1 - v) = A^T Lambda that keeps all other constraints and closed contacts; its own row of A is active, as its
 * input `closed` is 1. One program serves all contacts. */
Prog *lower_impact(const Eqns *e) {
  const Model *m = e->m;
  const Constraints *k = &e->constraints;
  Eqns closed = with_closed_rows(e);
  Lower l = lower_new(&closed);
  Slot *change = ARENA_ARRAY(m->arena, Slot, k->n + 1), *factor = ARENA_ARRAY(m->arena, Slot, k->n + 1),
       *d = ARENA_ARRAY(m->arena, Slot, e->n + 1);
  uint32_t some = 0;
  for (uint32_t i = 0; i < k->n; i++) {
    const Contact *c = striking_contact(e, i);
    if (!c) continue;
    change[i] = impact_change(&l, e, c, i);
    factor[i] = lower_load(&l, ARR_U, expr_symbol(e->g, c->closed));
    some++;
  }
  if (!some) return NULL;
  lower_correction(&l, k->n, 0, change, factor, d, NULL);
  for (uint32_t i = 0; i < e->n; i++) {
    Expr v = expr_symbol(e->g, m->coords.at[i].v)->node;
    lower_roots(&l, &v, 1);
    Slot after = d[i] ? prog_op(l.p, IR_ADD, lower_slot(&l, v), d[i]) : 0;
    if (after) prog_store(l.p, 0, i, after, expr_symbol(e->g, m->coords.at[i].v)->name);
  }
  return lower_finish(&l, &(PassPlan){0}, NULL);
}

Prog *lower_multipliers(const Eqns *e) {
  Lower l = lower_new(e);
  Slot *acc = ARENA_ARRAY(e->m->arena, Slot, e->n + 1);
  lower_solution(&l, acc);
  for (uint32_t k = 0; k < e->constraints.n; k++) prog_store(l.p, 0, k, l.multipliers[k], e->constraints.of[k]->name);
  return lower_finish(&l, &(PassPlan){0}, NULL);
}

/* each: numbers of a contact, 2 of one that is no guide; or 3, behind which those of guides stand. */
static Prog *lower_contacts(const Eqns *e, uint32_t each) {
  Lower l = lower_new(e);
  const Model *m = e->m;
  const Expr none = expr_int(e->g, 0);
  uint32_t n = m->contacts.n, some = 0;
  while (each == 2 && n && m->contacts.at[n - 1].parts) n--; /* guides are the last */
  for (uint32_t i = 0; i < n; i++) {
    const Contact *c = &m->contacts.at[i];
    some += (uint32_t)c->is_tangent;
    lower_output(&l, c->is_tangent ? c->friction : i + 1 < n && c[1].is_tangent ? c[1].hold : none, c->name);
    lower_output(&l, c->is_tangent ? c->restitution : none, c->name);
    if (each > 2)
      lower_output(&l, expr_symbol(e->g, m->constraints.at[c->constraint].multiplier)->node, c->name);
  }
  for (uint32_t i = 0; i < n && each > 2; i++) {
    const Contact *c = &m->contacts.at[i];
    for (uint32_t k = 0; k < 4 && c->parts; k++)
      lower_output(&l, k == 0 ? c->hold : k <= c->parts ? c->normal[k - 1] : none, c->name);
  }
  return some ? lower_outputs_seldom(&l) : NULL;
}

Prog *lower_contact_laws(const Eqns *e) { return lower_contacts(e, 3); }

Prog *lower_contact_coefficients(const Eqns *e) { return lower_contacts(e, 2); }
