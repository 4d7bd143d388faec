/* All programs of a unit, and their verification. */
#include "ir/program_set.h"

#include <math.h>

ProgList program_set_programs(const ProgramSet *u) {
  ProgList all = {0};
  const IrConstraints *k = &u->constraints;
  const Prog *const of_unit[] = {u->accel,
                                 u->energy, u->event_values, u->inputs, u->derived, u->charge_values, u->charge_powers,
                                 u->switch_values, u->switch_rates, u->switch_grips, u->contact_laws, u->guide_loads,
                                 u->contact_coefficients, u->size_values, u->moving_sizes, u->held_accel, u->impact,
                                 k->residuals, k->matrices, k->position, k->velocity, u->variation, u->second,
                                 u->linear, u->mass, u->bias, u->inverse, u->multipliers, u->by_inputs, u->outputs,
                                 u->by_params, u->adjoint, u->kepler,
                                 u->adjoint_rates, u->adjoint_projection, u->jumps, u->taylor ? u->taylor->first : NULL,
                                 u->taylor ? u->taylor->next : NULL};
  for (size_t i = 0; i < sizeof of_unit / sizeof *of_unit; i++) vec_push(u->arena, &all, of_unit[i]);
  vec_push(u->arena, &all, u->family_inertia);
  for (uint32_t i = 0; i < u->families.n; i++) {
    vec_push(u->arena, &all, u->families.at[i].values);
    vec_push(u->arena, &all, u->families.at[i].reach);
  }
  for (uint32_t i = 0; i < u->events.n; i++) vec_push(u->arena, &all, u->events.at[i].action);
  for (uint32_t i = 0; i < u->scenes.n; i++) {
    const IrScene *s = &u->scenes.at[i];
    const Prog *const of_scene[] = {s->start, s->observe, s->observe_plain, s->observe_held, s->exact, s->momenta};
    for (size_t j = 0; j < sizeof of_scene / sizeof *of_scene; j++) vec_push(u->arena, &all, of_scene[j]);
    for (uint32_t j = 0; j < s->actions.n; j++) vec_push(u->arena, &all, s->actions.at[j].curve);
    for (uint32_t j = 0; j < s->params.n; j++) vec_push(u->arena, &all, s->params.at[j].values);
  }
  uint32_t n = 0;
  for (uint32_t i = 0; i < all.n; i++)
    if (all.at[i]) all.at[n++] = all.at[i];
  all.n = n;
  return all;
}

const char *program_set_verify(const ProgramSet *u) {
  ProgList all = program_set_programs(u);
  const char *wrong = NULL;
  for (uint32_t i = 0; i < all.n && !wrong; i++) wrong = prog_verify(all.at[i]);
  return wrong;
}

void scene_values(const ProgramSet *u, const IrScene *s, long double *p, long double *y, long double *in) {
  long double t = s->t0;
  uint32_t n = u->q.n;
  const long double *const from[ARR_COUNT] = {[ARR_T] = &t, [ARR_P] = p};
  long double *const to_p[] = {p}, *const to_y[] = {y, y + n, y + 2 * n}, *const to_in[] = {in};
  for (uint32_t k = 0; k < s->params.n; k++) {
    const IrParams *x = &s->params.at[k];
    int failed = prog_eval(x->values, from, to_p) != 0;
    for (uint32_t i = x->first; failed && i < x->first + x->n; i++) p[i] = (long double)NAN;
  }
  prog_eval(s->start, from, to_y);
  for (uint32_t i = 0; i < s->moves.n; i++) y[s->moves.at[i].component] = s->moves.at[i].value;
  prog_eval(u->inputs, from, to_in);
}

const char *program_set_kick(const ProgramSet *u) {
  for (uint32_t i = 0; i < u->events.n; i++)
    if (u->events.at[i].direction == EVENT_KICK) return u->events.at[i].name;
  return NULL;
}

const IrContact *program_set_striking_contact(const ProgramSet *u, uint32_t i) {
  for (uint32_t k = 0; k < u->contacts.n; k++)
    if (u->contacts.at[k].impact == i && !u->contacts.at[k].conditional && !u->contacts.at[k].is_tangent)
      return &u->contacts.at[k];
  return NULL;
}

uint32_t program_set_guides(const ProgramSet *u) {
  uint32_t n = 0;
  for (uint32_t i = 0; i < u->contacts.n; i++) n += u->contacts.at[i].parts > 0;
  return n;
}

uint32_t program_set_contacts(const ProgramSet *u) { return u->contacts.n - program_set_guides(u); }
