/* Programs of charges and of their time derivatives, as functions of the state. */
#include "lower/lower_impl.h"
#include "mech/switches.h"
#include "symmetry/charges.h"

Prog *lower_charges(const Eqns *e) {
  Lower l = lower_new(e);
  for (uint32_t i = 1; i < e->ncharges; i++) {
    const Charge *c = &e->charges[i];
    lower_output(&l, c->value, c->name);
    lower_output(&l, c->scale, arena_printf(l.p->arena, "the scale of %s", c->name));
  }
  return lower_outputs_seldom(&l);
}

/* dQ/dt of charge i; 0 where it is not known. */
static Expr power_of(const Eqns *e, uint32_t i) {
  const Noether *n = &e->charges[i].proof;
  return n->power_unknown ? expr_int(e->g, 0) : n->power;
}

int lower_rubs(const Eqns *e) {
  vec_each(const ContactFamily, f, e->m->families) if (f->tangents) return 1; /* moreau knows its work */
  return !expr_is_zero(e->g, switch_power(e));
}

Prog *lower_charge_rates(const Eqns *e) {
  Lower l = lower_new(e);
  int rubs = lower_rubs(e), some = rubs;
  for (uint32_t i = 0; i < e->ncharges; i++) {
    Expr power = power_of(e, i);
    some |= !expr_is_zero(e->g, power);
    lower_output(&l, power, arena_printf(l.p->arena, "d(%s)/dt", e->charges[i].name));
  }
  if (!some) return NULL;
  if (rubs) lower_output(&l, switch_power(e), "power of dry friction");
  return lower_outputs_seldom(&l);
}
