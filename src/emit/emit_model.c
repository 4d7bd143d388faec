/* The emitted model file: functions in the order of their use, then tables, then scenes. */
#include "emit/emit_model.h"

#include <string.h>

#include "base/words.h"
#include "emit/emit_impl.h"
#include "emit/late_text.h"

static const char *const arrays[ARR_COUNT] = {"t", "q", "v", "z", "p", "u", "a", "g"};

/* Names that the head of an emitted file defines, besides lag_... and LAG_..., which no name of a model becomes
 * (emit/cnames.c). */
static const char abi_names[] =
    "jump_table TAYLOR_COLUMNS TAYLOR_SUMS TAYLOR_CONSTANTS TAYLOR_WIDTH TAYLOR_LANES TAYLOR_GROUP TAYLOR_UNROLL "
    "TAYLOR_UNROLL_4 taylor_pair TAYLOR_PAIR taylor_at taylor_work taylor_first taylor_next taylor_sums taylor_rest "
    "taylor_squares TAYLOR_SQUARES taylor_four TAYLOR_WIDE TAYLOR_INLINE taylor_sums_wide taylor_squares_wide "
    "taylor_rest_wide taylor_at_wide taylor_part taylor_part_wide taylor_rest_any taylor_at_any taylor_along q_table "
    "z_table p_table u_table ev_table dr_table mass_table second_table linear curves singular constraint_table "
    "jacobian_table inertia_table constraints contact_table charge_table charges switch_table taylor_far taylor_add "
    "by_params by_params_table params_partials by_inputs by_inputs_table inputs_partials formula_table adjoint_of "
    "adjoint_rates adjoint_project";

/* --- identifiers --- */

/* Unique identifier of scene i: names that C spells alike get suffixes. */
const char *scene_id(const ProgramSet *u, uint32_t i) {
  CNames ids = cnames_new(u->arena);
  const char *id = "";
  for (uint32_t k = 0; k <= i; k++) id = cnames_take(&ids, u->scenes.at[k].name);
  return id;
}

const char *const *model_rows_names(const ProgramSet *u) {
  CNames ids = cnames_new(u->arena);
  const char **names = ARENA_ARRAY(u->arena, const char *, u->inputs->tables.n + 1);
  for (uint32_t i = 0; i < u->inputs->tables.n; i++)
    names[i] = u->inputs->tables.at[i].order
                   ? names[i - 1]
                   : arena_printf(u->arena, "rows_%s", cnames_take(&ids, u->inputs->tables.at[i].name));
  return names;
}

const char *model_id(Arena *a, const char *name) {
  static const char taken[] =
      "accel derive energy linearise jumps taylor variation second events act impact strike inputs params start "
      "observe outputs forces options monitors measures program scenes curves exact exact_of residuals matrices "
      "charge_values charge_powers switch_values switch_rates switch_grips contact_laws guide_loads size_values "
      "size_table correct_positions correct_velocities inverse_dynamics adjoint adjoint_rates adjoint_project "
      "families kepler_part kepler_part_at kepler_part_values";
  const char *id = cname(a, name);
  int clash = cname_is_library(id) || strncmp(id, "lag_", 4) == 0 || has_word(taken, id) || has_word(abi_names, id);
  return clash ? arena_printf(a, "%s_model", id) : id;
}

static const char *const *globals_of(const ProgramSet *u, const char *name) {
  CNames all = cnames_new(u->arena);
  cnames_reserve_words(&all, "", abi_names);
  if (!name) return cnames_list(&all);
  cnames_reserve(&all, name);
  for (uint32_t i = 0; i < u->inputs->tables.n; i++) cnames_reserve(&all, model_rows_names(u)[i]);
  for (uint32_t i = 0; i < u->scenes.n; i++) {
    const char *id = scene_id(u, i), *lists[] = {name,       "outputs",  "forces",   "options",
                                                 "monitors", "measures", "exact_of", "given"};
    for (size_t k = 0; k < sizeof lists / sizeof *lists; k++)
      cnames_reserve(&all, arena_printf(u->arena, "%s_%s", lists[k], id));
  }
  return cnames_list(&all);
}

/* --- functions --- */

void model_flags(unsigned flags, const char *const *names, uint32_t n, StrBuf *out) {
  int some = 0;
  for (uint32_t i = 0; i < n; i++)
    if (flags >> i & 1) sb_printf(out, "%s%s", some++ ? " | " : "", names[i]);
  if (!some) sb_putc(out, '0');
}

CStyle model_style(const ModelFile *f, const char *const *own, const char *const *written) {
  return (CStyle){.prefix = "LAG",
                  .in = arrays, .out = written, .own = own, .globals = f->globals, .solve = "lag_solve",
                  .kkt = "lag_kkt", .spline = "lag_spline", .curve = "lag_curve",
                  .math = math_prefix(f->u, "lag"), .turns = !f->for_readers, .times = f->u->times};
}

/* Whether the function is called once a step, or once a row of output. */
static int is_seldom_called(const ProgramSet *u, const Prog *p) {
  int seldom = p == u->energy || p == u->charge_values || p == u->charge_powers || p == u->switch_values ||
               p == u->switch_rates || p == u->switch_grips || p == u->contact_laws || p == u->guide_loads ||
               p == u->size_values || p == u->kepler;
  for (uint32_t i = 0; i < u->scenes.n; i++) seldom |= p == u->scenes.at[i].observe || p == u->scenes.at[i].momenta;
  return seldom;
}

void state_function(const ModelFile *f, const Prog *p, const char *name, const char *comment, const char *in,
                    const char *written) {
  const char *own[14] = {"self", "t", "q", "v", "z", "p", "u"}, *out[6];
  uint32_t n = 7, outputs = 0;
  StrBuf head = strbuf(f->a);
  if (!p) return;
  while ((out[outputs] = word_at(f->a, written, outputs)) != NULL) outputs++;
  sb_printf(&head,
            "static int %s(const void *self, LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z,\n    "
            "const LAG_REAL *p, const LAG_REAL *u",
            name);
  for (; *in; in++) sb_printf(&head, ", const LAG_REAL *%s", own[n++] = arena_strndup(f->a, in, 1));
  int wraps = n > 7 || outputs > 2;
  for (uint32_t k = 0; k < outputs; k++)
    sb_printf(&head, "%s LAG_REAL *%s", !k && wraps ? ",\n   " : ",", own[n++] = out[k]);
  sb_puts(&head, ", LAG_REAL *w)");
  own[n] = "w";
  CStyle st = model_style(f, own, out);
  st.prefer_short_code = is_seldom_called(f->u, p);
  CFunction c = {.comment = comment, .head = sb_text(&head), .returns = 1};
  cfunction(p, &st, &c, f->out);
}

static void accel(const ModelFile *f) {
  const char *what = !f->u->z.n ? "Accelerations" : f->u->q.n ? "Accelerations and rates" : "Rates";
  state_function(f, f->u->accel, "accel", arena_printf(f->a, "%s: %s.", what, op_count_text(f->u->accel, f->a)), "",
                 "a zd");
}

void emit_accel(const ProgramSet *u, StrBuf *out) {
  accel(&(ModelFile){.u = u, .a = u->arena, .globals = globals_of(u, NULL), .out = out, .for_readers = 1});
}

static void emit_variation(const ModelFile *f) {
  const ProgramSet *u = f->u;
  if (!u->variation) return;
  state_function(f, u->variation, "variation", "dL/dq, the momenta dL/dq', and the generalised forces outside of L.",
                 "", "Lq Lv Q");
  state_function(f, u->second, "second",
                 arena_printf(f->a, "Their nonzero derivatives: %s.", op_count_text(u->second, f->a)), "", "h");
}

static void emit_kepler(const ModelFile *f) {
  const ProgramSet *u = f->u;
  if (!u->kepler) return;
  state_function(f, u->kepler, "kepler_part_values", "Masses of the bodies; k of terms -k/r.", "", "out");
  sb_puts(f->out, "\nstatic const int kepler_part_at[] = {");
  for (uint32_t i = 0; i < u->kepler_at.n; i++)
    sb_printf(f->out, "%s%u", !i ? "" : i % 16 ? ", " : ",\n  ", u->kepler_at.at[i]);
  sb_printf(f->out, "};\nstatic const lag_kepler kepler_part = {%u, %u, %d, kepler_part_at, kepler_part_values};\n",
            u->kepler_bodies, u->kepler_at.n / u->kepler_bodies, u->kepler_fixed);
}

static void emit_inverse(const ModelFile *f) {
  const Prog *p = f->u->inverse;
  if (p)
    state_function(f, p, "inverse_dynamics",
                   arena_printf(f->a, "Forces that the accelerations a need: %s.", op_count_text(p, f->a)), "a", "out");
}

/* Newton's law of impact for the contact whose constraint is `row`, which its input closes. */
static void emit_strike(const ModelFile *f) {
  const ProgramSet *u = f->u;
  if (!u->impact) return;
  state_function(f, u->impact, "impact", "Velocities after the impact of the contact whose entry of g is 1.", "g",
                 "v1");
  sb_printf(f->out,
            "\nstatic int strike(const void *self, int row, int input, LAG_REAL t, const LAG_REAL *q, const LAG_REAL "
            "*v,\n    const LAG_REAL *z, const LAG_REAL *p, const LAG_REAL *u, LAG_REAL *v1, LAG_REAL *w) {\n"
            "  LAG_REAL g[%u], with[%u];\n"
            "  for (int i = 0; i < %u; i++) g[i] = LAG_C(0.0);\n  for (int i = 0; i < %u; i++) with[i] = u[i];\n"
            "  g[row] = with[input] = LAG_C(1.0);\n  return impact(self, t, q, v, z, p, with, g, v1, w);\n}\n",
            u->constraints.of.n, u->u.n, u->constraints.of.n, u->u.n);
}

static void emit_events(const ModelFile *f) {
  const ProgramSet *u = f->u;
  const char *const *id = u->events.n ? cnames_of_events(u) : NULL;
  if (!id) return;
  state_function(f, u->event_values, "events", "An event happens where its function changes sign.", "", "out");
  emit_strike(f);
  for (uint32_t i = 0; i < u->events.n; i++)
    if (!program_set_striking_contact(u, i))
      state_function(f, u->events.at[i].action, arena_printf(f->a, "act_%s", id[i]),
                     arena_printf(f->a, "What the event %s does.", u->events.at[i].name), "", "q1 v1 z1");
  sb_puts(
      f->out,
      "\nstatic int act(const void *self, int k, LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z,\n"
      "    const LAG_REAL *p, const LAG_REAL *u,\n"
      "    LAG_REAL *q1, LAG_REAL *v1, LAG_REAL *z1, int *stop, LAG_REAL *w) {\n  switch (k) {\n");
  for (uint32_t i = 0; i < u->events.n; i++) {
    const IrContact *c = program_set_striking_contact(u, i);
    if (c)
      sb_printf(f->out, "    case %u: return strike(self, %u, %u, t, q, v, z, p, u, v1, w);\n", i, c->constraint,
                c->input);
    else
      sb_printf(f->out, "    case %u:%s return act_%s(self, t, q, v, z, p, u, q1, v1, z1, w);\n", i,
                u->events.at[i].stop ? " *stop = 1;" : "", id[i]);
  }
  sb_puts(f->out, "    default: (void)self; (void)stop; return LAG_OK;\n  }\n}\n");
}

static void emit_switches(const ModelFile *f) {
  const ProgramSet *u = f->u;
  if (!u->switches.n) return;
  state_function(f, u->switch_values, "switch_values",
                 "Switching functions: forces jump, or have a corner, where one of them is 0.", "", "out");
  state_function(f, u->switch_rates, "switch_rates", "Their rates.", "", "out");
  state_function(f, u->switch_grips, "switch_grips", "Static limits, relative to the force on a sliding body.", "",
                 "out");
  sb_puts(f->out, "\nstatic const lag_switch switch_table[] = {\n");
  vec_each(const IrSwitch, s, u->switches) {
    sb_printf(f->out, "  {%s, %s, %u, %d, %d, %d, %d},\n", c_string(f->a, s->surface), c_string(f->a, s->text),
              u->lines ? s->line : 0, s->jumps, s->is_floor, s->is_timed, s->nonnegative);
  }
  sb_puts(f->out, "};\n");
}

static void emit_sizes(const ModelFile *f) {
  if (!f->u->sizes.n) return;
  if (f->u->size_values)
    state_function(f, f->u->size_values, "size_values",
                   "Sizes of friction, inertias and coefficients, of parameters alone.", "", "out");
  if (f->u->moving_sizes)
    state_function(f, f->u->moving_sizes, "moving_sizes", "Sizes of friction that change along a run.", "", "out");
  sb_puts(f->out, "\nstatic const lag_size size_table[] = {\n");
  vec_each(const IrSize, s, f->u->sizes)
    sb_printf(f->out, "  {%s, %s, %d, %d},\n", c_string(f->a, s->what), c_string(f->a, s->text), s->open, s->part);
  sb_puts(f->out, "};\n");
}

/* Charges of symmetries. */
static void emit_charges(const ModelFile *f) {
  static const char *const flags[CHARGE_FLAGS] = {
#define CHARGE_FLAG(name) "LAG_" #name,
#include "ir/flags.def"
#undef CHARGE_FLAG
  };
  const ProgramSet *u = f->u;
  if (!u->charges.n) return;
  state_function(f, u->charge_values, "charge_values", "The charges of symmetries, and the scales of their drifts.", "",
                 "out");
  state_function(f, u->charge_powers, "charge_powers", "Rates of change of the energy and of these charges.", "",
                 "out");
  sb_puts(f->out, "\nstatic const lag_charge charge_table[] = {\n");
  vec_each(const IrCharge, c, u->charges) {
    sb_printf(f->out, "  {%s, %s, ", c_string(f->a, c->name), c_string(f->a, c->unit));
    model_flags(c->flags, flags, CHARGE_FLAGS, f->out);
    sb_puts(f->out, "},\n");
  }
  sb_printf(
      f->out,
      "};\n\nstatic const lag_charges charges = {\n  .n = %u, .of = charge_table, .values = %s, .powers = %s,%s\n};\n",
      u->charges.n, u->charge_values ? "charge_values" : "NULL", u->charge_powers ? "charge_powers" : "NULL",
      u->dry_friction ? " .dry_friction = 1," : "");
}

/* --- parameters and inputs --- */

static void emit_derive(const ModelFile *f) {
  static const char *const own[] = {"self", "p", NULL}, *const written[] = {"p"};
  if (!f->u->nderived) return;
  CStyle st = model_style(f, own, written);
  st.apart = st.prefer_short_code = 1;
  CFunction c = {.comment = arena_printf(f->a, "Derived parameters, for the functions below: %s.",
                                         op_count_text(f->u->derived, f->a)),
                 .head = "static void derive(const void *self, LAG_REAL *p)"};
  cfunction(f->u->derived, &st, &c, f->out);
}

static void emit_inputs(const ModelFile *f) {
  static const char *const own[] = {"self", "t", "p", "u", NULL}, *const written[] = {"u"};
  const Prog *p = f->u->inputs;
  if (!f->u->u.n) return;
  CStyle st = model_style(f, own, written);
  st.rows = model_rows_names(f->u);
  for (uint32_t i = 0; i < p->tables.n; i++) {
    if (p->tables.at[i].order) continue;
    sb_putc(f->out, '\n');
    cwrite_rows(&p->tables.at[i], st.rows[i], "LAG", "", f->a, f->out);
  }
  CFunction c = {.comment = p->tables.n ? "Inputs, by their formulas and tables." : "Inputs that have a formula.",
                 .head = "static int inputs(const void *self, LAG_REAL t, const LAG_REAL *p, LAG_REAL *u)",
                 .returns = 1};
  cfunction(p, &st, &c, f->out);
}

void emit_entries(const char *name, const IrEntry *at, uint32_t n, StrBuf *out) {
  enum { A_LINE = 10 };
  if (!n) return;
  sb_printf(out, "\nstatic const lag_entry %s[] = {", name);
  for (uint32_t i = 0; i < n; i++) sb_printf(out, "%s{%u, %u},", i % A_LINE ? " " : "\n  ", at[i].row, at[i].col);
  sb_puts(out, "\n};\n");
}

static void emit_jumps(const ModelFile *f) {
  const ProgramSet *u = f->u;
  enum { A_LINE = 8 };
  if (!u->jumps) return;
  state_function(f, u->jumps, "jumps",
                 "Linearised events: derivatives of their functions and of the values that their actions set.", "",
                 "d");
  sb_puts(f->out, "\nstatic const lag_jump jump_table[] = {");
  for (uint32_t i = 0; i < u->jump_at.n; i++)
    sb_printf(f->out, "%s{%u, %d, %u},", i % A_LINE ? " " : "\n  ", u->jump_at.at[i].event, u->jump_at.at[i].row,
              u->jump_at.at[i].col);
  sb_puts(f->out, "\n};\n");
}

/* See WANT_CONSTRAINED. */
int model_has_linear(const ProgramSet *u) { return u->linear && !u->constraints.of.n; }

/* Derivatives by parameters or inputs, with their table. */
static void emit_partials(const ModelFile *f, const Prog *p, const IrEntry *at, uint32_t n, const char *by) {
  const char *table = arena_printf(f->a, "by_%s_table", by);
  state_function(f, p, arena_printf(f->a, "by_%s", by),
                 arena_printf(f->a, "The same, dr: each equation by the %s; M: %s.", by, op_count_text(p, f->a)), "a",
                 "dr M");
  emit_entries(table, at, n, f->out);
  sb_printf(f->out, "\nstatic const lag_partials %s = {%u, %s, by_%s};\n", arena_printf(f->a, "%s_partials", by), n,
            n ? table : "NULL", by);
}

static void emit_adjoint(const ModelFile *f) {
  const ProgramSet *u = f->u;
  state_function(f, u->adjoint, "adjoint",
                 arena_printf(f->a, "Reverse mode: products g^T dF/dy and by inputs and parameters: %s.",
                              op_count_text(u->adjoint, f->a)),
                 "ag", "by_y by_up d");
  state_function(f, u->adjoint_rates, "adjoint_rates", "Accelerations, rates and multipliers.", "", "a zd l");
  state_function(f, u->adjoint_projection, "adjoint_project",
                 "Transpose of the projection of small changes g onto the constraints.", "g", "by_y by_up d");
  emit_entries("formula_table", u->formulas_at.at, u->formulas_at.n, f->out);
  sb_printf(f->out, "\nstatic const lag_adjoint adjoint_of = {%u, %s, adjoint%s};\n", u->formulas_at.n,
            u->formulas_at.n ? "formula_table" : "NULL", u->adjoint_rates ? ", adjoint_rates, adjoint_project" : "");
}

static void emit_linear(const ModelFile *f) {
  const ProgramSet *u = f->u;
  if (!model_has_linear(u)) return;
  const char *comment =
      arena_printf(f->a, "The linearisation, dr: each equation by each component of its state; M: %s.",
                   op_count_text(u->linear, f->a));
  state_function(f, u->linear, "linearise", comment, "a", "dr M");
  emit_entries("dr_table", u->linear_dr.at, u->linear_dr.n, f->out);
  emit_entries("mass_table", u->linear_mass.at, u->linear_mass.n, f->out);
  emit_jumps(f);
  int sensitive = (u->wants & WANT_SENSITIVITY) == WANT_SENSITIVITY, params = sensitive && u->by_params,
      inputs = sensitive && u->by_inputs;
  if (params) emit_partials(f, u->by_params, u->by_params_dr.at, u->by_params_dr.n, "params");
  if (u->adjoint) emit_adjoint(f);
  if (inputs) emit_partials(f, u->by_inputs, u->by_inputs_dr.at, u->by_inputs_dr.n, "inputs");
  sb_printf(f->out,
            "\nstatic const lag_linear linear = {\n  .ndr = %u, .dr = %s, .nmass = %u, .mass = %s,\n  .ops = ",
            u->linear_dr.n, u->linear_dr.n ? "dr_table" : "NULL", u->linear_mass.n,
            u->linear_mass.n ? "mass_table" : "NULL");
  late_int(f->out, ops_total(prog_count(u->linear)));
  sb_puts(f->out, ", .eval = linearise,\n");
  if (u->jumps) sb_printf(f->out, "  .njump = %u, .jump = jump_table, .jumps = jumps,\n", u->jump_at.n);
  if (params) sb_puts(f->out, "  .by_params = &params_partials,\n");
  if (inputs) sb_puts(f->out, "  .by_inputs = &inputs_partials,\n");
  if (u->adjoint) sb_puts(f->out, "  .adjoint = &adjoint_of,\n");
  sb_puts(f->out, "};\n");
}

/* --- constraints --- */

static void constraint_table(const ProgramSet *u, StrBuf *out) {
  const IrConstraints *k = &u->constraints;
  Arena *a = u->arena;
  sb_puts(out, "\nstatic const lag_constraint constraint_table[] = {\n");
  for (uint32_t i = 0; i < k->of.n; i++)
    sb_printf(out, "  {%s, %d, %s, %u},\n", c_string(a, k->of.at[i].name), i < k->nholonomic,
              c_string(a, k->of.at[i].unit), u->lines ? k->of.at[i].line : 0);
  sb_puts(out, "};\n");
}

static void emit_contacts(const ModelFile *f) {
  if (!f->u->contacts.n) return;
  sb_puts(f->out, "\nstatic const lag_contact contact_table[] = {\n");
  vec_each(const IrContact, c, f->u->contacts) {
    sb_printf(f->out, "  {%u, %u, %u, %u, %d, %u, %d, %d},\n", c->input, c->constraint, c->impact, c->release,
              c->is_tangent, c->force, c->conditional, c->law);
  }
  sb_puts(f->out, "};\n");
  if (program_set_guides(f->u)) sb_puts(f->out, "\nstatic const lag_guide guide_table[] = {\n");
  for (uint32_t i = 0; i < f->u->contacts.n; i++)
    if (f->u->contacts.at[i].parts)
      sb_printf(f->out, "  {%u, %u, %d},\n", i, f->u->contacts.at[i].parts,
                f->u->contacts.at[i].parts == 1 ? (int)f->u->contacts.at[i].turn : -1);
  if (program_set_guides(f->u)) sb_puts(f->out, "};\n");
  state_function(f, f->u->contact_laws, "contact_laws",
                 "Friction, tangential restitution and multiplier of each contact; static friction beside a gap.", "",
                 "out");
  state_function(f, f->u->guide_loads, "guide_loads",
                 "The least change d of velocities with A d = g; force: M d; load: forces of guides by that.", "g",
                 "d force load");
}

static void emit_constraints(const ModelFile *f) {
  const IrConstraints *k = &f->u->constraints;
  if (!k->of.n) return;
  state_function(
      f, k->residuals, "residuals",
      k->nkept > k->nholonomic
          ? "What the constraints say is zero, or stays as it is at the start: c on positions; r on velocities."
          : "What the constraints say is zero: c on positions, r on velocities.",
      "", "c r");
  state_function(f, k->matrices, "matrices",
                 "A, the derivatives of r by the velocities, and the mass matrix: the entries that are not zero.", "",
                 "A M");
  int both = k->velocity == k->position;
  if (k->nkept)
    state_function(f, k->position, "correct_positions",
                   both ? "The least change d with A d = g, for positions or velocities; force: M d."
                        : "The least change d of positions with A d = g; force: M d.",
                   "g", "d force");
  if (!both)
    state_function(f, k->velocity, "correct_velocities", "The least change d of velocities with A d = g; force: M d.",
                   "g", "d force");
  constraint_table(f->u, f->out);
  emit_entries("jacobian_table", k->jacobian.at, k->jacobian.n, f->out);
  emit_entries("inertia_table", k->mass.at, k->mass.n, f->out);
  if (f->u->adjoint) emit_adjoint(f);
  sb_printf(f->out,
            "\nstatic const lag_constraints constraints = {\n  .n = %u, .nholonomic = %u, .of = constraint_table,\n",
            k->of.n, k->nkept);
  sb_printf(f->out, "  .njacobian = %u, .jacobian = jacobian_table, .nmass = %u, .mass = %s,\n", k->jacobian.n,
            k->mass.n, k->mass.n ? "inertia_table" : "NULL");
  sb_printf(f->out, "  .residuals = residuals, .matrices = matrices,\n  .position = %s, .velocity = %s,\n%s};\n",
            k->nkept ? "correct_positions" : "NULL", both ? "correct_positions" : "correct_velocities",
            f->u->adjoint ? "  .adjoint = &adjoint_of,\n" : "");
  emit_contacts(f);
}

/* --- tables --- */

int model_has_long_tables(const ProgramSet *u) {
  int is_long = table_needs_macros(u->q.at, u->q.n) || table_needs_macros(u->z.at, u->z.n) ||
                table_needs_macros(u->p.at, u->p.n) || table_needs_macros(u->u.at, u->u.n);
  for (uint32_t i = 0; i < u->scenes.n; i++)
    is_long |= table_needs_macros(u->scenes.at[i].outputs.at, u->scenes.at[i].outputs.n);
  return is_long;
}

static int needs_solver(const ProgramSet *u) {
  ProgList all = program_set_programs(u);
  int some = 0;
  for (uint32_t i = 0; i < all.n; i++) some |= prog_solves_dense(all.at[i]);
  return some;
}

static void emit_head(const ProgramSet *u, StrBuf *out) {
  sb_printf(out, "/* %s: %s\n", u->name, comment_text(u->arena, u->doc));
  sb_printf(out, " * Emitted by lagc; effects in use: %s.\n", u->effects[0] ? u->effects : "none");
  if (u->fixed[0]) sb_printf(out, " * Parameters that are numbers here: %s.\n", u->fixed_values);
  sb_printf(out, " * Accelerations: %s.\n", op_count_text(u->accel, u->arena));
  if (u->nderived) sb_printf(out, " * Once for a set of parameters: %s.\n", op_count_text(u->derived, u->arena));
  sb_printf(out, " * %s\n", math_source_text(u));
  sb_puts(out, " * This text may be used for any purpose without conditions (0BSD). */\n");
  sb_puts(out, "#include <math.h>\n\n#include \"lag_model.h\"\n");
}

/* The functions on which a saved state depends, and their digest. */
static void emit_equations(const ModelFile *f) {
  late_digest_from(f->out);
  emit_derive(f);
  accel(f);
  state_function(f, f->u->energy, "energy",
                 "The energy p q' - L, and the scale |p q'| + |L| that its drift is compared with.", "", "out");
  emit_events(f);
  emit_inputs(f);
  emit_constraints(f);
  emit_families(f);
  late_digest_to(f->out);
}

const char *model_digest(const ProgramSet *u, const char *name) {
  StrBuf text = strbuf(u->arena);
  emit_equations(&(ModelFile){.u = u, .a = u->arena, .globals = globals_of(u, name), .out = &text});
  const StrBuf whole = late_text_write(&text);
  return late_text_digest(u->arena, sb_text(&whole), whole.n);
}

void emit_model(const ProgramSet *u, const char *name, ModelTextKind kind, StrBuf *out) {
  const int alone = kind == MODEL_ALONE;
  StrBuf fill = strbuf(u->arena), *late = kind == MODEL_OF_MAIN && model_has_long_tables(u) ? &fill : NULL;
  ModelFile f = {.u = u, .a = u->arena, .globals = globals_of(u, name), .fill = late, .out = out};
  emit_head(u, out);
  MathText math = {u, "LAG", "lag", needs_solver(u)};
  math_of_model(&math, alone, out);
  if (!late && model_has_long_tables(u)) table_macros(out);
  emit_equations(&f);
  emit_sizes(&f);
  emit_charges(&f);
  emit_switches(&f);
  /* after the digest: a saved state depends on the equations, not on the methods' derivatives of them */
  emit_linear(&f);
  if (u->taylor)
    emit_taylor(u->taylor,
                &(CStyle){.prefix = "LAG", .globals = f.globals, .solve = "lag_solve", .math = math_prefix(u, "lag")},
                u->lanes, out);
  emit_variation(&f);
  emit_kepler(&f);
  emit_inverse(&f);
  emit_model_struct(u, name, late, out);
  for (uint32_t i = 0; i < u->scenes.n; i++) emit_scene(&f, name, i);
  if (late)
    sb_printf(out,
              "\n/* Names of families. */\n"
              "void lag_app_names(lag_var *table, int first, int groups, const lag_var *pattern, int size);\n"
              "void %s_names(void) {\n%s}\n",
              name, sb_text(late));
  if (!alone) return;
  sb_puts(out, "\n/* ---- lag_math.h and others, of lagc ---- */\n\n");
  math_bodies(&math, out);
}
