/* All programs of a unit, and their verification. */
#include "ir/unit.h"

ProgList unit_programs(const IrUnit *u) {
  ProgList all = {0};
  const IrConstraints *k = &u->constraints;
  const Prog *const of_unit[] = {u->accel, u->energy, u->event_values, u->inputs, u->derived, u->charge_values, u->charge_powers, u->switch_values, k->residuals,
                                 k->matrices, k->position, k->velocity, u->variation, u->second, u->linear, u->jumps, u->taylor ? u->taylor->first : NULL,
                                 u->taylor ? u->taylor->next : NULL};
  for (size_t i = 0; i < sizeof of_unit / sizeof *of_unit; i++) vec_push(u->arena, &all, of_unit[i]);
  for (uint32_t i = 0; i < u->events.n; i++) vec_push(u->arena, &all, u->events.at[i].action);
  for (uint32_t i = 0; i < u->scenes.n; i++) {
    const IrScene *s = &u->scenes.at[i];
    const Prog *const of_scene[] = {s->start, s->observe, s->observe_plain, s->exact};
    for (size_t j = 0; j < sizeof of_scene / sizeof *of_scene; j++) vec_push(u->arena, &all, of_scene[j]);
    for (uint32_t j = 0; s->params && j < u->p.n; j++) vec_push(u->arena, &all, s->params[j]);
  }
  uint32_t n = 0;
  for (uint32_t i = 0; i < all.n; i++)
    if (all.at[i]) all.at[n++] = all.at[i];
  all.n = n;
  return all;
}

const char *unit_verify(const IrUnit *u) {
  ProgList all = unit_programs(u);
  const char *wrong = NULL;
  for (uint32_t i = 0; i < all.n && !wrong; i++) wrong = prog_verify(all.at[i]);
  return wrong;
}
