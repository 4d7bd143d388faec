/* The Kepler part of L: masses of bodies, and couplings of their terms -k/r. */
#include "lower/lower_impl.h"
#include "mech/kepler_part.h"

static Prog *values(const Eqns *e, const KeplerPart *of) {
  Lower l = lower_new(e);
  for (uint32_t k = 0; k < 2 * of->bodies; k++) {
    Name name = e->m->coords.at[of->at[k % of->bodies * of->dim]].name;
    lower_output(&l, k < of->bodies ? of->mass[k] : of->coupling[k - of->bodies],
                 arena_printf(l.p->arena, k < of->bodies ? "mass of %s" : "coupling of %s", name));
  }
  return lower_outputs_seldom(&l);
}

void lower_kepler(ProgramSet *u, const Eqns *e) {
  KeplerPart of;
  if (kepler_part(e, &of)) return;
  u->kepler = values(e, &of);
  u->kepler_bodies = of.bodies, u->kepler_fixed = of.fixed;
  for (uint32_t i = 0; i < of.bodies * of.dim; i++) vec_push(u->arena, &u->kepler_at, of.at[i]);
}
