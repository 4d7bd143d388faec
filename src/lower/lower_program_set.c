/* Eqns -> ProgramSet: all programs of a model, and the tables of names, units, flags and positions that describe
 * them. */
#include "ir/program_set.h"

#include <string.h>

#include "lower/lower.h"
#include "mech/lagrange.h"
#include "mech/switches.h"
#include "sym/print.h"
#include "sym/sum_nest.h"
#include "symmetry/charges.h"

/* Units of variables, each once. */
typedef struct {
  const Model *m;
  VEC(Unit) of;
  VEC(const IrUnit *) units;
} Units;

static const IrUnit *ir_unit(Units *all, const Unit *u) {
  const Model *m = all->m;
  for (uint32_t k = 0; k < all->of.n; k++) {
    const Unit *x = &all->of.at[k];
    if (strcmp(x->text, u->text) == 0 && x->dim == u->dim && x->pi_power == u->pi_power &&
        num_equal(x->factor, u->factor) && num_equal(x->offset, u->offset))
      return all->units.at[k];
  }
  Dim d = dim_resolved(m->dims, u->dim);
  IrUnit *v = ARENA_NEW(m->arena, IrUnit);
  *v = (IrUnit){u->text, unit_factor(u), num_value(u->offset), u->factor, u->pi_power, unit_of_dim(m->dims, d).text,
                {0}};
  int whole = v->si[0] != '\0';
  for (int i = 0; i < DIM_BASES && whole; i++) whole = num_is_int(dim_exponent(m->dims, d, (DimBase)i));
  for (int i = 0; i < DIM_BASES && whole; i++)
    v->base[i] = (signed char)num_value(dim_exponent(m->dims, d, (DimBase)i));
  vec_push(m->arena, &all->of, *u);
  vec_push(m->arena, &all->units, v);
  return v;
}

static IrVar ir_var(Units *all, Name name, const Unit *u, int periodic, AstSign sign) {
  static const int signs[] = {[SIGN_ANY] = 0, [SIGN_GT] = 1, [SIGN_GE] = 2, [SIGN_LT] = -1, [SIGN_LE] = -2};
  return (IrVar){name, ir_unit(all, u), periodic, signs[sign]};
}

static const char *joined(Arena *a, const Name *names, uint32_t n) {
  StrBuf b = strbuf(a);
  for (uint32_t i = 0; i < n; i++) sb_printf(&b, "%s%s", i ? " " : "", names[i]);
  return sb_text(&b);
}

static unsigned flags_of(const Eqns *e) {
  const int set[UNIT_FLAGS] = {
      [UNIT_CONSERVES_ENERGY] = e->conserves_energy,
      [UNIT_CONSTANT_MASS] = e->constant_mass,
      [UNIT_AUTONOMOUS] = e->autonomous,
      [UNIT_SMOOTH] = e->smooth,
      [UNIT_SEPARABLE] = e->separable,
      [UNIT_TIMELESS] = e->timeless,
      [UNIT_LOSES_ENERGY] = e->loses_energy,
      [UNIT_FIRST_ORDER] = e->first.n != 0,
      [UNIT_CONSTANT_FORM] = e->first.n && e->first.constant && e->first.closed,
      [UNIT_MASSLESS] = e->singular_mass,
      [UNIT_SUM_HAMILTONIAN] = e->sum_hamiltonian,
  };
  unsigned flags = 0;
  for (unsigned i = 0; i < UNIT_FLAGS; i++) flags |= set[i] ? 1u << i : 0;
  return flags;
}

static void add_fixed(ProgramSet *u, const Model *m) {
  StrBuf names = strbuf(m->arena), values = strbuf(m->arena);
  Name last = NULL;
  for (uint32_t i = 0; i < m->params.n; i++) {
    const Param *p = &m->params.at[i];
    char text[32];
    if (!p->fixed) continue;
    num_format_double(text, num_value(p->number));
    sb_printf(&values, "%s%s = %s", last ? ", " : "", p->name, text);
    if (p->stem != last) sb_printf(&names, "%s%s", last ? " " : "", p->stem);
    last = p->stem;
  }
  u->fixed = sb_text(&names);
  u->fixed_values = sb_text(&values);
}

static void add_contacts(ProgramSet *u, const Eqns *e) {
  const Model *m = e->m;
  for (uint32_t k = 0; k < m->contacts.n; k++) {
    const Contact *c = &m->contacts.at[k];
    IrContact one = {
        expr_symbol(e->g, c->closed)->index, 0, c->impact, c->release, 0, c->is_tangent, c->margin != 0, c->law,
        c->parts, c->turn};
    if (c->is_tangent) one.force = expr_symbol(e->g, c->force)->index;
    while (e->constraints.of[one.constraint] != &m->constraints.at[c->constraint]) one.constraint++;
    vec_push(u->arena, &u->contacts, one);
  }
  u->contact_laws = lower_contact_laws(e);
  u->guide_loads = lower_guide_loads(e);
  u->impact = lower_impact(e);
  u->contact_coefficients = lower_contact_coefficients(e);
}

static void add_events(ProgramSet *u, const Eqns *e) {
  static const int directions[] = {
      [CROSS_BOTH] = 0, [CROSS_RISING] = 1, [CROSS_FALLING] = -1, [AT_EQUAL_TIMES] = EVENT_KICK};
  for (uint32_t i = 0; i < e->m->events.n; i++) {
    const Event *ev = &e->m->events.at[i];
    IrEvent one = {ev->name, directions[ev->direction], lower_action(e, i), ev->stop};
    vec_push(u->arena, &u->events, one);
  }
  u->event_values = lower_events(e);
}

static void add_constraints(ProgramSet *u, const Eqns *e) {
  const Constraints *k = &e->constraints;
  IrConstraints *to = &u->constraints;
  if (!k->n) return;
  for (uint32_t i = 0; i < k->n; i++) {
    const char *unit = dim_text(e->m->dims, k->of[i]->dim);
    Place place = source_place(e->m->ast->sources, k->of[i]->span.begin);
    vec_push(u->arena, &to->of,
             ((IrConstraint){k->of[i]->name, strcmp(unit, "1") == 0 ? "" : unit, place.file ? place.line : 0}));
  }
  for (uint32_t i = 0; i < k->A.n; i++) vec_push(u->arena, &to->jacobian, ((IrEntry){k->A.at[i].row, k->A.at[i].col}));
  for (uint32_t i = 0; i < e->mass.n; i++)
    vec_push(u->arena, &to->mass, ((IrEntry){e->mass.at[i].row, e->mass.at[i].col}));
  to->nholonomic = k->nholonomic;
  to->nkept = k->nkept;
  to->residuals = lower_residuals(e);
  to->matrices = lower_matrices(e);
  to->position = lower_projection(e, k->nkept);
  to->velocity = k->nkept == k->n ? to->position : lower_projection(e, k->n);
}

/* Adds nothing if the energy is the only charge, is conserved whatever the inputs are, and has no unit. */
static void add_charges(ProgramSet *u, const Eqns *e) {
  const Prog *powers = e->ncharges ? lower_charge_rates(e) : NULL;
  int says_more = e->ncharges && (e->charges[0].unit.text[0] || e->charges[0].proof.by_formulas);
  if (e->ncharges < 2 && !powers && !e->energy_jumps && !says_more) return;
  for (uint32_t i = 0; i < e->ncharges; i++) {
    const Charge *c = &e->charges[i];
    int conserved = c->proof.drift == PROVED_ZERO;
    unsigned known = 1u << CHARGE_BALANCED | (conserved ? 1u << CHARGE_CONSERVED : 0) |
                     (c->proof.by_formulas ? 1u << CHARGE_BY_FORMULAS : 0);
    unsigned flags = c->proof.jumps ? 1u << CHARGE_JUMPS : c->proof.power_unknown ? 0 : known;
    vec_push(u->arena, &u->charges, ((IrCharge){c->name, c->unit.text, flags}));
  }
  u->charge_values = e->ncharges > 1 ? lower_charges(e) : NULL;
  u->charge_powers = powers;
  u->dry_friction = powers && lower_rubs(e);
}

static void add_switches(ProgramSet *u, const Eqns *e) {
  const Switches *all = &e->switches;
  for (uint32_t i = 0; i < all->n; i++) {
    const Switch *s = &all->at[i];
    Place place = source_place(e->m->ast->sources, s->span.begin);
    vec_push(u->arena, &u->switches,
             ((IrSwitch){s->surface, s->text, place.file ? place.line : 0, s->jumps, s->kind == SWITCH_FLOOR,
                         (expr_kinds(e->g, s->side) & 1u << SYM_TIME) != 0, s->kind == SWITCH_SPEED}));
  }
  u->nmodes = all->nmodes;
  if (all->n) u->switch_values = lower_switches(e);
  if (all->nmodes) u->switch_rates = lower_switch_rates(e);
  if (all->nmodes) u->switch_grips = lower_switch_grips(e);
}

static void add_variation(ProgramSet *u, const Eqns *e) {
  Variation *x = lagrangian_hessian_derive(e);
  u->variation = lower_variation(e, x);
  u->second = lower_second_derivatives(e, x);
  for (uint32_t k = 0; k < x->second.n; k++) {
    const SecondEntry *s = &x->second.at[k];
    vec_push(u->arena, &u->second_at, ((IrSecond){(int)s->part, s->row, s->col}));
  }
}

/* Whether the sums of the forces, which a series writes out, have so few turns that it ends; reported. */
static int sums_fit_series(const Eqns *e) {
  enum { MOST_TURNS = 20000 }; /* 200 bodies: some minutes of the C compiler */
  uint64_t turns = 0;
  ExprList l = expr_topo_to_sums(e->g, e->f, e->n);
  for (uint32_t k = 0; k < l.n; k++)
    if (expr_op(e->g, l.at[k]) == EX_NEST) turns += expr_sum_turns(e->g, l.at[k]);
  if (turns <= MOST_TURNS) return 1;
  diag_note(e->m->diags, e->m->lagrangian_span,
            "no Taylor series: it would write out the %llu terms of the sums in the forces, and takes at most %d" HELP
            "other methods keep sums: `dop853` has high order, `radau` and `gauss` are implicit",
            (unsigned long long)turns, MOST_TURNS);
  return 0;
}

/* Models with tables have no series, as tables are not analytic; models with constraints have none yet. */
static void add_taylor(ProgramSet *u, const Eqns *e) {
  const char *why;
  if (e->constraints.n) return;
  for (uint32_t i = 0; i < e->m->inputs.n; i++)
    if (e->m->inputs.at[i].table) return;
  if (!sums_fit_series(e)) return;
  IrSystem system = lower_system(e);
  u->taylor = series_new(&system, &why);
}

static void add_sizes(ProgramSet *u, const Eqns *e, int moving) {
  for (uint32_t i = 0; i < e->sizes.n; i++) {
    const ModelSize *s = &e->sizes.at[i];
    if (s->moves != moving) continue;
    u->nmoving += moving != 0;
    StrBuf what = strbuf(u->arena);
    for (const char *c = s->what; *c; c++)
      if (*c != '`') sb_putc(&what, *c);
    vec_push(u->arena, &u->sizes, ((IrSize){sb_text(&what), expr_text(e->g, s->value), s->open, s->part}));
  }
  *(moving ? &u->moving_sizes : &u->size_values) = lower_sizes(e, moving);
}

ProgramSet *unit_head(const Eqns *e, const char *source, int libm) {
  const Model *m = e->m;
  Units units = {.m = m};
  ProgramSet *u = ARENA_NEW(m->arena, ProgramSet);
  *u = (ProgramSet){.arena = m->arena,
                    .name = m->name, .doc = m->doc ? m->doc : "", .source = source, .flags = flags_of(e),
                    .times = m->times, .libm = libm};
  u->effects = joined(m->arena, m->effects.at, m->effects.n);
  u->all_effects = joined(m->arena, m->all_effects.at, m->all_effects.n);
  add_fixed(u, m);
  for (uint32_t i = 0; i < m->coords.n; i++)
    vec_push(m->arena, &u->q,
             ir_var(&units, m->coords.at[i].name, &m->coords.at[i].unit, m->coords.at[i].periodic, SIGN_ANY));
  for (uint32_t i = 0; i < m->states.n; i++)
    vec_push(m->arena, &u->z,
             ir_var(&units, m->states.at[i].name, &m->states.at[i].unit, m->states.at[i].periodic, SIGN_ANY));
  for (uint32_t i = 0; i < m->params.n; i++)
    if (!m->params.at[i].fixed)
      vec_push(m->arena, &u->p, ir_var(&units, m->params.at[i].name, &m->params.at[i].unit, 0, m->params.at[i].sign));
  for (uint32_t i = 0; i < m->inputs.n; i++)
    vec_push(m->arena, &u->u, ir_var(&units, m->inputs.at[i].name, &m->inputs.at[i].unit, 0, SIGN_ANY));
  u->inputs = lower_inputs(e);
  add_sizes(u, e, 0);
  add_sizes(u, e, 1);
  return u;
}

void unit_add_programs(ProgramSet *u, const Eqns *e) {
  u->accel = lower_accel(e, u->libm);
  u->energy = e->energy ? lower_energy(e) : NULL;
  add_events(u, e);
  add_constraints(u, e);
  add_contacts(u, e);
  lower_families(u, e);
  add_charges(u, e);
  add_switches(u, e);
  lower_kepler(u, e);
}

ProgramSet *unit_new(const Eqns *e, const char *source, int libm) {
  ProgramSet *u = unit_head(e, source, libm);
  unit_add_programs(u, e);
  return u;
}

static int is_same(const Prog *a, const Prog *b) { return a && b ? prog_same(a, b) : a == b; }

int unit_accepts_scenes(const ProgramSet *a, const ProgramSet *b) {
  return a->flags == b->flags && strcmp(a->effects, b->effects) == 0 && strcmp(a->fixed_values, b->fixed_values) == 0 &&
         prog_same(a->inputs, b->inputs) && a->sizes.n == b->sizes.n && a->nmoving == b->nmoving &&
         is_same(a->size_values, b->size_values) && is_same(a->moving_sizes, b->moving_sizes);
}

/* Index in [q|v|z]. */
static uint32_t place_of_start(const Model *m, SymId target) {
  const Symbol *of = expr_symbol(m->g, target);
  uint32_t n = m->coords.n;
  return of->kind == SYM_COORD ? of->index : of->kind == SYM_VEL ? n + of->index : 2 * n + of->index;
}

/* Guesses, and quaternion coordinates of rotations with an implied start, except those to which the scene gives a
 * value. */
static void add_implied(IrScene *s, const Model *m) {
  unsigned char *said = ARENA_ARRAY(m->arena, unsigned char, m->coords.n + 1);
  for (uint32_t i = 0; i < m->scene.starts.n; i++) {
    const Symbol *of = expr_symbol(m->g, m->scene.starts.at[i].target);
    if (of->kind == SYM_COORD && !m->scene.starts.at[i].implied) said[of->index] = 1;
  }
  for (uint32_t i = 0; i < m->scene.starts.n; i++) {
    uint32_t first = expr_symbol(m->g, m->scene.starts.at[i].target)->index;
    for (uint32_t k = first; m->scene.starts.at[i].implied && k < first + 4; k++)
      if (!said[k]) vec_push(m->arena, &s->implied, k);
    if (m->scene.starts.at[i].guess) vec_push(m->arena, &s->implied, place_of_start(m, m->scene.starts.at[i].target));
  }
}

/* Outputs with held modes, beside accelerations with them. */
static void add_held_outputs(IrScene *s, const ProgramSet *u, const Eqns *e) {
  Eqns held = *e;
  if (!u->held_accel || !s->plain.n) return;
  switches_find(&held);
  s->observe_held = lower_plain_outputs(&held);
}

static void add_actions(IrScene *s, const Eqns *e) {
  if (e->nactions && e->n) s->momenta = lower_momenta(e);
  for (uint32_t i = 0; i < e->nactions; i++) {
    const ActionCurve *c = &e->actions[i];
    IrAction a = {c->name, lower_action_curve(e, i), c->coordinate, c->momentum, c->periodic};
    vec_push(e->m->arena, &s->actions, a);
  }
}

static void add_exact(IrScene *s, const Eqns *e) {
  const Model *m = e->m;
  const Scene *sc = &m->scene;
  s->observe_plain = s->plain.n < s->outputs.n ? lower_plain_outputs(e) : s->observe;
  s->exact = lower_closed_forms(e);
  for (uint32_t i = 0; i < sc->exacts.n; i++) {
    const Symbol *of = expr_symbol(m->g, sc->exacts.at[i].target);
    uint32_t before = of->kind == SYM_COORD ? 0 : of->kind == SYM_VEL ? m->coords.n : 2 * m->coords.n;
    vec_push(m->arena, &s->exact_of, before + of->index);
  }
}

/* Positions of the entries of M that programs of derivatives compute. */
static void note_mass(ProgramSet *u, const Eqns *e) {
  for (uint32_t k = u->linear_mass.n; k < e->mass.n; k++)
    vec_push(u->arena, &u->linear_mass, ((IrEntry){e->mass.at[k].row, e->mass.at[k].col}));
}

static void add_linear(ProgramSet *u, Eqns *e) {
  Partials dr = eqns_linearise(e);
  u->linear = lower_linear(e, dr, BY_STATE);
  for (uint32_t k = 0; k < dr.n; k++) vec_push(u->arena, &u->linear_dr, ((IrEntry){dr.at[k].row, dr.at[k].col}));
  note_mass(u, e);
}

/* Functions of headers. */
static void add_mass(ProgramSet *u, Eqns *e) {
  Expr *bias = ARENA_ARRAY(u->arena, Expr, e->n + 1);
  const Expr *f = eqns_forces(e);
  eqns_derive_mass(e);
  for (uint32_t i = 0; i < e->n; i++) bias[i] = expr_neg(e->g, f[i]);
  u->mass = lower_mass(e);
  u->bias = lower_forces(e, bias);
}

static void add_outputs(ProgramSet *u, const Eqns *e) {
  Partials d;
  u->outputs = lower_output_partials(e, &d);
  for (uint32_t k = 0; k < d.n; k++) vec_push(u->arena, &u->outputs_at, ((IrEntry){d.at[k].row, d.at[k].col}));
}

/* Whether no output contains multipliers, whose derivatives are not known. */
static int outputs_derive(const Eqns *e) {
  unsigned kinds = 0;
  for (uint32_t i = 0; i < e->noutputs; i++) kinds |= expr_kinds(e->g, e->outputs[i]);
  return !(kinds & 1u << SYM_MULTIPLIER);
}

/* Adds the derivatives of rates by inputs, or by parameters. */
static void add_partials(ProgramSet *u, Eqns *e, PartialsBy by) {
  Partials dr = eqns_partials(e, by);
  *(by == BY_INPUTS ? &u->by_inputs : &u->by_params) = lower_linear(e, dr, by);
  for (uint32_t k = 0; k < dr.n; k++) {
    IrEntry at = {dr.at[k].row, dr.at[k].col};
    if (by == BY_INPUTS) vec_push(u->arena, &u->by_inputs_dr, at);
    else vec_push(u->arena, &u->by_params_dr, at);
  }
  note_mass(u, e);
}

static void add_adjoint(ProgramSet *u, Eqns *e) {
  AdjointPartials d = eqns_adjoint(e);
  u->adjoint = lower_adjoint(e, &d);
  if (e->constraints.n) u->adjoint_rates = lower_rates_and_multipliers(e);
  if (e->constraints.n) u->adjoint_projection = lower_adjoint_projection(e, &d);
  for (uint32_t k = 0; k < d.formulas.n; k++)
    vec_push(u->arena, &u->formulas_at, ((IrEntry){d.formulas.at[k].row, d.formulas.at[k].col}));
}

static void add_jumps(ProgramSet *u, const Eqns *e) {
  EventPartials jumps = eqns_event_derivatives(e);
  if (!jumps.n) return;
  u->jumps = lower_event_derivatives(e, jumps);
  for (uint32_t k = 0; k < jumps.n; k++)
    vec_push(u->arena, &u->jump_at, ((IrJump){jumps.at[k].event, jumps.at[k].row, jumps.at[k].col}));
}

/* Switches of equations that otherwise follow the text: where a motion may stick, accelerations with held modes,
 * too. */
static void add_held(ProgramSet *u, const Eqns *e) {
  Eqns held = *e;
  int some = 0;
  if (u->switches.n) return;
  switches_find(&held);
  add_switches(u, &held);
  for (uint32_t k = 0; k < u->nmodes; k++) some |= u->switches.at[k].jumps;
  if (some) u->held_accel = lower_accel(&held, u->libm);
  if (some && program_set_guides(u)) u->contact_laws = lower_contact_laws(&held);
}

/* Not with contacts, whose friction follows their multipliers. */
static int has_reverse_mode(const Eqns *e) { return !e->constraints.n || !e->m->contacts.n; }

void unit_require(ProgramSet *u, Eqns *e, unsigned wants) {
  unsigned fresh = wants & ~u->wants;
  u->wants |= wants;
  if (fresh & WANT_VARIATION && e->n) add_variation(u, e);
  if (fresh & WANT_TAYLOR) add_taylor(u, e);
  if (fresh & WANT_MASS && e->n) add_mass(u, e);
  if (fresh & WANT_INVERSE && e->n) u->inverse = lower_forces(e, eqns_inverse_dynamics(e));
  int derives = !e->constraints.n || (wants & WANT_CONSTRAINED && !e->m->contacts.n);
  if (fresh & WANT_BY_INPUTS && e->m->inputs.n && derives) add_partials(u, e, BY_INPUTS);
  if (fresh & WANT_BY_PARAMS && u->p.n && derives) add_partials(u, e, BY_PARAMS);
  if (fresh & WANT_OUTPUTS && derives && outputs_derive(e)) add_outputs(u, e);
  if (fresh & WANT_MULTIPLIERS && e->constraints.n) u->multipliers = lower_multipliers(e);
  if (fresh & WANT_LINEAR && derives) add_linear(u, e);
  if (fresh & WANT_LINEAR && !e->constraints.n) add_jumps(u, e);
  unsigned reverse = e->constraints.n ? WANT_ADJOINT | WANT_BY_PARAMS : WANT_ADJOINT;
  if (fresh & reverse && !u->adjoint && has_reverse_mode(e)) add_adjoint(u, e);
  if (fresh & WANT_HELD) add_held(u, e);
}

static void add_scene_outputs(IrScene *s, const Eqns *e) {
  const Model *m = e->m;
  Units units = {.m = m};
  uint32_t nplain = 0;
  s->outputs.cap = e->noutputs;
  s->outputs.at = ARENA_ARRAY(m->arena, IrVar, e->noutputs + 1);
  for (uint32_t i = 0; i < e->noutputs; i++) {
    IrVar v = ir_var(&units, e->m->scene.outputs.at[i].name, &e->m->scene.outputs.at[i].unit, 0, SIGN_ANY);
    vec_push(m->arena, &s->outputs, v);
    nplain += output_is_plain(e, i) != 0;
    if (e->constraints.n)
      vec_push(m->arena, &s->forces,
               (expr_kinds(e->g, e->outputs[i]) & (1u << SYM_ACC | 1u << SYM_MULTIPLIER)) != 0);
  }
  s->plain.n = nplain;
  s->plain.at = s->outputs.at;
  if (nplain == e->noutputs) return;
  s->plain.n = 0, s->plain.at = NULL;
  for (uint32_t i = 0; i < e->noutputs; i++)
    if (output_is_plain(e, i)) vec_push(m->arena, &s->plain, s->outputs.at[i]);
}

static void add_shapes(IrScene *s, const Model *m) {
  for (uint32_t i = 0; i < m->scene.shapes.n; i++) {
    const Shape *of = &m->scene.shapes.at[i];
    IrShape x = {.kind = shape_word(of->kind), .role = of->role, .text = of->text, .count = of->count};
    memcpy(x.a, of->a, sizeof x.a);
    memcpy(x.b, of->b, sizeof x.b);
    memcpy(x.size, of->size, sizeof x.size);
    memcpy(x.turn, of->turn, sizeof x.turn);
    vec_push(m->arena, &s->shapes, x);
  }
}

void unit_add_scene(ProgramSet *u, const Eqns *e) {
  const Model *m = e->m;
  const Scene *sc = &m->scene;
  IrScene s = {.exactly = sc->exactly.end != 0,
               .name = sc->name, .doc = sc->doc, .t0 = sc->t0, .t1 = sc->t1, .t1_digits = sc->t1_digits,
               .has_span = sc->has_span, .method = sc->method, .tolerance = sc->tolerance,
               .every = sc->every};
  for (uint32_t i = 0, n = 0; n < u->p.n; n += s.params.at[s.params.n - 1].n) {
    IrParams some = lower_params(e, &i);
    vec_push(m->arena, &s.params, some);
  }
  s.start = lower_start(e);
  add_implied(&s, m);
  s.observe = lower_outputs(e);
  for (uint32_t i = 0; i < sc->options.n; i++) {
    IrOption o = {sc->options.at[i].name, sc->options.at[i].text, sc->options.at[i].value};
    vec_push(m->arena, &s.options, o);
  }
  add_scene_outputs(&s, e);
  add_exact(&s, e);
  add_actions(&s, e);
  add_held_outputs(&s, u, e);
  for (uint32_t i = 0; i < sc->monitors.n; i++) {
    IrMonitor mon = {sc->monitors.at[i].name, sc->monitors.at[i].output, sc->monitors.at[i].limit,
                     sc->monitors.at[i].absolute};
    vec_push(m->arena, &s.monitors, mon);
  }
  for (uint32_t i = 0; i < sc->measures.n; i++) {
    IrMeasure x = {sc->measures.at[i].name, measure_words(m->arena, &sc->measures.at[i])};
    vec_push(m->arena, &s.measures, x);
  }
  add_shapes(&s, m);
  s.ndrawn = sc->ndrawn;
  vec_push(m->arena, &u->scenes, s);
}
