/* A program for liblag's evaluator: what emit_model.c, emit_scene.c and emit_program.c write as C, as bytes. The order
 * of the fields is that of runtime/evaluator/read_model.c. */
#include <stdlib.h>
#include <string.h>

#include "emit/emit_impl.h"
#include "emit/emit_model.h"
#include "emit/program_bytes.h"
#include "numeric/program_code.def"

typedef struct {
  const ProgramSet *u;
  CodeStyle style;
  StrBuf *out;
} Unit;

static void word(const Unit *w, uint32_t x) { put_word(w->out, x); }
static void integer(const Unit *w, int x) { put_word(w->out, (uint32_t)x); }
static void number(const Unit *w, double x) { put_number(w->out, x); }
static void text(const Unit *w, const char *s) { put_text(w->out, s); }
static void program(const Unit *w, const Prog *p) { put_program(w->out, p, w->style); }

/* A number as the compiler reads its text of more digits, where there is one: see table_number. */
static double longer(const Unit *w, double x, const char *digits) {
  const char *text = shortest_double(w->u->arena, x);
  return digits && strpbrk(text, ".e") && strlen(digits) > strlen(text) ? strtod(digits, NULL) : x;
}

static void variables(const Unit *w, const IrVar *v, uint32_t n) {
  word(w, n);
  for (uint32_t i = 0; i < n; i++) {
    const IrUnit *u = v[i].unit;
    text(w, v[i].name), text(w, u->text);
    number(w, longer(w, u->factor, decimal_literal(w->u->arena, u->ratio, u->pi_power))), number(w, u->offset);
    integer(w, v[i].periodic), integer(w, v[i].sign);
  }
}

static void entries(const Unit *w, const IrEntry *at, uint32_t n) {
  word(w, n);
  for (uint32_t i = 0; i < n; i++) word(w, at[i].row), word(w, at[i].col);
}

/* Events; a contact that strikes has the entry of its constraint and its input in place of an action. */
static void events(const Unit *w) {
  const ProgramSet *u = w->u;
  word(w, u->events.n);
  for (uint32_t i = 0; i < u->events.n; i++) {
    const IrContact *c = program_set_striking_contact(u, i);
    text(w, u->events.at[i].name);
    integer(w, u->events.at[i].direction), integer(w, u->events.at[i].stop && !c);
    word(w, c != NULL), word(w, c ? c->constraint : 0), word(w, c ? c->input : 0);
  }
}

static void actions(const Unit *w) {
  const ProgramSet *u = w->u;
  for (uint32_t i = 0; i < u->events.n; i++)
    program(w, program_set_striking_contact(u, i) ? NULL : u->events.at[i].action);
}

/* Derivatives by parameters or inputs; p NULL: none. */
static void partials(const Unit *w, const Prog *p, const IrEntry *at, uint32_t n) {
  integer(w, p != NULL);
  if (!p) return;
  entries(w, at, n);
  program(w, p);
}

static void constraints(const Unit *w) {
  const IrConstraints *k = &w->u->constraints;
  word(w, k->of.n), word(w, k->nkept);
  if (!k->of.n) return;
  for (uint32_t i = 0; i < k->of.n; i++) {
    text(w, k->of.at[i].name), text(w, k->of.at[i].unit);
    word(w, i < k->nholonomic), word(w, w->u->lines ? k->of.at[i].line : 0);
  }
  entries(w, k->jacobian.at, k->jacobian.n);
  entries(w, k->mass.at, k->mass.n);
  program(w, k->residuals);
  program(w, k->matrices);
  program(w, k->nkept ? k->position : NULL);
  program(w, k->velocity);
  partials(w, w->u->adjoint, w->u->formulas_at.at, w->u->formulas_at.n);
  if (w->u->adjoint) program(w, w->u->adjoint_rates), program(w, w->u->adjoint_projection);
}

static void contacts(const Unit *w) {
  word(w, w->u->contacts.n);
  vec_each(const IrContact, c, w->u->contacts) {
    word(w, c->input), word(w, c->constraint), word(w, c->impact), word(w, c->release), integer(w, c->is_tangent);
    word(w, c->force), integer(w, c->conditional), integer(w, c->law);
  }
  word(w, program_set_guides(w->u));
  for (uint32_t i = 0; i < w->u->contacts.n; i++) {
    const IrContact *c = &w->u->contacts.at[i];
    if (c->parts) word(w, i), word(w, c->parts), word(w, c->parts == 1 ? c->turn : UINT32_MAX);
  }
  program(w, w->u->contact_laws);
  program(w, w->u->guide_loads);
}

static void reads(const Unit *w, const IrRead *at, uint32_t n) {
  for (uint32_t i = 0; i < n; i++)
    integer(w, (int)at[i].first), integer(w, (int)at[i].by_row), integer(w, (int)at[i].by_turn);
}

static void families(const Unit *w) {
  const ProgramSet *u = w->u;
  word(w, u->families.n);
  if (!u->families.n) return;
  vec_each(const IrContactFamily, c, u->families) {
    text(w, c->name);
    integer(w, (int)c->indices), integer(w, (int)c->i0), integer(w, (int)c->j0), integer(w, (int)c->rows);
    integer(w, (int)c->skew), integer(w, (int)c->turns), integer(w, (int)c->more);
    word(w, c->tangents), word(w, c->reach ? c->nplaces : 0);
    word(w, c->coords.n), reads(w, c->coords.at, c->coords.n);
    word(w, c->params.n), reads(w, c->params.at, c->params.n);
    if (c->reach) reads(w, c->place, c->nplaces);
    program(w, c->values);
    program(w, c->reach);
  }
  entries(w, u->family_mass.at, u->family_mass.n);
  program(w, u->family_inertia);
}

static void sizes(const Unit *w) {
  const ProgramSet *u = w->u;
  word(w, u->sizes.n - u->nmoving), word(w, u->nmoving);
  for (uint32_t i = 0; i < u->sizes.n; i++) {
    text(w, u->sizes.at[i].what), text(w, u->sizes.at[i].text);
    integer(w, u->sizes.at[i].open), integer(w, u->sizes.at[i].part);
  }
  program(w, u->size_values);
  program(w, u->moving_sizes);
}

static void charges(const Unit *w) {
  const ProgramSet *u = w->u;
  word(w, u->charges.n);
  for (uint32_t i = 0; i < u->charges.n; i++) {
    text(w, u->charges.at[i].name), text(w, u->charges.at[i].unit);
    word(w, u->charges.at[i].flags);
  }
  integer(w, u->dry_friction);
  program(w, u->charge_values);
  program(w, u->charge_powers);
}

static void switches(const Unit *w) {
  const ProgramSet *u = w->u;
  word(w, u->switches.n), word(w, u->nmodes);
  vec_each(const IrSwitch, s, u->switches) {
    text(w, s->surface), text(w, s->text);
    word(w, u->lines ? s->line : 0);
    integer(w, s->jumps), integer(w, s->is_floor), integer(w, s->is_timed), integer(w, s->nonnegative);
  }
  program(w, u->switch_values);
  program(w, u->nmodes ? u->switch_rates : NULL);
  program(w, u->switch_grips);
}

static void linear(const Unit *w) {
  const ProgramSet *u = w->u;
  int has = model_has_linear(u);
  integer(w, has);
  if (!has) return;
  entries(w, u->linear_dr.at, u->linear_dr.n);
  entries(w, u->linear_mass.at, u->linear_mass.n);
  word(w, ops_as_int(ops_total(prog_count(u->linear))));
  program(w, u->linear);
  word(w, u->jumps ? u->jump_at.n : 0);
  for (uint32_t i = 0; u->jumps && i < u->jump_at.n; i++)
    word(w, u->jump_at.at[i].event), integer(w, u->jump_at.at[i].row), word(w, u->jump_at.at[i].col);
  program(w, u->jumps);
  int sensitive = (u->wants & WANT_SENSITIVITY) == WANT_SENSITIVITY;
  partials(w, sensitive ? u->by_params : NULL, u->by_params_dr.at, u->by_params_dr.n);
  partials(w, sensitive ? u->by_inputs : NULL, u->by_inputs_dr.at, u->by_inputs_dr.n);
  partials(w, u->adjoint, u->formulas_at.at, u->formulas_at.n);
}

static void variation(const Unit *w) {
  const ProgramSet *u = w->u;
  program(w, u->variation);
  word(w, u->variation ? u->second_at.n : 0);
  for (uint32_t i = 0; u->variation && i < u->second_at.n; i++)
    integer(w, u->second_at.at[i].part), word(w, u->second_at.at[i].row), word(w, u->second_at.at[i].col);
  program(w, u->variation ? u->second : NULL);
  program(w, u->inverse);
}

static void kepler(const Unit *w) {
  const ProgramSet *u = w->u;
  word(w, u->kepler != NULL);
  if (!u->kepler) return;
  word(w, u->kepler_bodies), word(w, u->kepler_at.n / u->kepler_bodies), integer(w, u->kepler_fixed);
  for (uint32_t i = 0; i < u->kepler_at.n; i++) word(w, u->kepler_at.at[i]);
  program(w, u->kepler);
}

static void taylor(const Unit *w) {
  const Series *s = w->u->taylor;
  word(w, s != NULL);
  if (!s) return;
  TaylorCosts c = taylor_costs(s);
  word(w, s->columns), word(w, s->sums), word(w, s->squares), word(w, s->first_square), word(w, s->width);
  word(w, s->constants), integer(w, s->uses_time), integer(w, taylor_sums_fit_registers(s));
  word(w, c.first), word(w, c.next), word(w, c.sums);
  program(w, s->first);
  put_program(w->out, s->next, (CodeStyle){w->style.own, 1});
}

/* The tables of the inputs' program whose rows the runtime sees, each with its input. */
static void tables(const Unit *w) {
  const Prog *p = w->u->inputs;
  uint32_t n = 0;
  for (int turn = 0; turn < 2; turn++) {
    if (turn) word(w, n);
    for (uint32_t k = 0; k < p->stores.n; k++) {
      const Ins *i = &p->ins.at[p->stores.at[k].slot];
      if (i->op != IR_TABLE || p->tables.at[i->index].order) continue;
      n++;
      if (turn) word(w, p->stores.at[k].index), word(w, i->index);
    }
  }
}

static void model(const Unit *w, const char *name) {
  const ProgramSet *u = w->u;
  text(w, u->name), text(w, u->doc), text(w, u->effects), text(w, model_digest(u, name));
  text(w, u->fixed[0] ? u->fixed : NULL);
  integer(w, w->style.own);
  word(w, u->flags), word(w, ops_as_int(ops_total(prog_count(u->accel))));
  variables(w, u->q.at, u->q.n), variables(w, u->z.at, u->z.n);
  variables(w, u->p.at, u->p.n), variables(w, u->u.at, u->u.n);
  word(w, u->nderived), word(w, u->nmodes), word(w, u->constraints.of.n);
  program(w, u->nderived ? u->derived : NULL);
  program(w, u->accel);
  program(w, u->energy);
  events(w);
  program(w, u->events.n ? u->event_values : NULL);
  program(w, u->impact);
  actions(w);
  program(w, u->u.n ? u->inputs : NULL);
  tables(w);
  constraints(w), contacts(w), families(w), sizes(w), charges(w), switches(w), linear(w), variation(w);
  kepler(w), taylor(w);
}

static void scene_lists(const Unit *w, const IrScene *s) {
  word(w, s->options.n);
  for (uint32_t i = 0; i < s->options.n; i++)
    text(w, s->options.at[i].name), number(w, s->options.at[i].value), text(w, s->options.at[i].text);
  word(w, s->monitors.n);
  for (uint32_t i = 0; i < s->monitors.n; i++) {
    text(w, s->monitors.at[i].name), integer(w, s->monitors.at[i].output);
    number(w, s->monitors.at[i].limit), integer(w, s->monitors.at[i].absolute);
  }
  word(w, s->measures.n);
  for (uint32_t i = 0; i < s->measures.n; i++) text(w, s->measures.at[i].name), text(w, s->measures.at[i].text);
}

static void indices(const Unit *w, const int *at, int n) {
  for (int i = 0; i < n; i++) integer(w, at[i]);
}

static void shapes(const Unit *w, const IrScene *s) {
  word(w, s->ndrawn), word(w, s->shapes.n);
  vec_each(const IrShape, x, s->shapes) {
    text(w, x->kind), text(w, x->role), text(w, x->text), integer(w, x->count);
    indices(w, x->a, 3), indices(w, x->b, 3), indices(w, x->size, 3), indices(w, x->turn, 4);
  }
}

static void outputs(const Unit *w, const IrScene *s) {
  variables(w, s->outputs.at, s->outputs.n);
  int forces = s->forces.n && memchr(s->forces.at, 1, s->forces.n);
  integer(w, forces);
  for (uint32_t i = 0; forces && i < s->outputs.n; i++) word(w, s->forces.at[i]);
  word(w, s->exact_of.n);
  for (uint32_t i = 0; i < s->exact_of.n; i++) word(w, s->exact_of.at[i]);
  program(w, s->exact_of.n ? s->exact : NULL);
  word(w, s->actions.n);
  vec_each(const IrAction, a, s->actions) {
    word(w, a->q), word(w, a->p), integer(w, a->periodic);
    program(w, a->curve);
  }
  program(w, s->actions.n ? s->momenta : NULL);
  program(w, s->observe);
}

static void scene(const Unit *w, const IrScene *s) {
  const ProgramSet *u = w->u;
  text(w, s->name), text(w, s->doc), text(w, s->method);
  number(w, s->t0), number(w, longer(w, s->t1, s->t1_digits)), number(w, s->tolerance), number(w, s->every);
  integer(w, s->has_span), integer(w, s->exactly);
  word(w, s->params.n);
  for (uint32_t i = 0; i < s->params.n; i++) word(w, s->params.at[i].n), program(w, s->params.at[i].values);
  program(w, s->start);
  const unsigned char *given = u->constraints.of.n ? scene_given(u, s) : NULL;
  for (uint32_t i = 0; given && i < 2 * u->q.n + u->z.n; i++) word(w, given[i]);
  outputs(w, s);
  scene_lists(w, s), shapes(w, s);
}

void emit_bytes(const ProgramSet *const *units, const char *const *names, uint32_t n, StrBuf *out) {
  const ProgramSet *first = units[0];
  put_word(out, PROGRAM_MAGIC), put_word(out, PROGRAM_VERSION);
  put_text(out, first->name), put_text(out, first->doc), put_text(out, first->source),
      put_text(out, first->all_effects);
  put_word(out, n);
  for (uint32_t i = 0; i < n; i++) {
    Unit w = {units[i], {!units[i]->libm, 0}, out};
    model(&w, names[i]);
    put_word(out, units[i]->scenes.n);
    for (uint32_t k = 0; k < units[i]->scenes.n; k++) scene(&w, &units[i]->scenes.at[k]);
  }
}
