/* Programs of charges and of their time derivatives, as functions of the state. */
#include "lower/lower_impl.h"
#include "mech/switches.h"
#include "symmetry/charges.h"

Prog *lower_charges(const Eqns *e) {
  uint32_t n = e->ncharges - 1;
  Lower l = lower_new(e);
  Arena *a = l.p->arena;
  Expr *roots = ARENA_ARRAY(a, Expr, 2 * n + 1);
  for (uint32_t i = 0; i < n; i++) {
    roots[2 * i] = e->charges[i + 1].value;
    roots[2 * i + 1] = e->charges[i + 1].scale;
  }
  lower_with_accelerations(&l, roots, 2 * n);
  for (uint32_t i = 0; i < n; i++) {
    Name name = e->charges[i + 1].name;
    prog_store(l.p, 0, 2 * i, lower_slot(&l, roots[2 * i]), name);
    prog_store(l.p, 0, 2 * i + 1, lower_slot(&l, roots[2 * i + 1]), arena_printf(a, "the scale of %s", name));
  }
  return lower_finish_seldom(&l);
}

/* dQ/dt of charge i; 0 where it is not known. */
static Expr power_of(const Eqns *e, uint32_t i) {
  const Noether *n = &e->charges[i].proof;
  return n->power_unknown ? expr_int(e->g, 0) : n->power;
}

Prog *lower_charge_rates(const Eqns *e) {
  Lower l = lower_new(e);
  Arena *a = l.p->arena;
  Expr *roots = ARENA_ARRAY(a, Expr, e->ncharges + 2);
  int some = 0;
  for (uint32_t i = 0; i < e->ncharges; i++) {
    roots[i] = power_of(e, i);
    some |= !expr_is_zero(e->g, roots[i]);
  }
  if (!some) return NULL;
  Expr dry = roots[e->ncharges] = switch_power(e);
  lower_with_accelerations(&l, roots, e->ncharges + 1);
  for (uint32_t i = 0; i < e->ncharges; i++)
    prog_store(l.p, 0, i, lower_slot(&l, roots[i]), arena_printf(a, "d(%s)/dt", e->charges[i].name));
  if (!expr_is_zero(e->g, dry)) prog_store(l.p, 0, e->ncharges, lower_slot(&l, dry), "power of dry friction");
  return lower_finish_seldom(&l);
}
