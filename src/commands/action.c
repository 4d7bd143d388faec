/* `lagc action`: action variables of the scene's start, and their frequencies. */
#include "commands/commands.h"

#include <math.h>

#include "phase_space/action_variables.h"
#include "sym/print.h"
#include "symmetry/charges.h"
#include "symmetry/find_symmetries.h"

static void print_one(const ActionVariables *v, uint32_t i, StrBuf *out) {
  const ExprGraph *g = v->space->e->g;
  const ActionVariable *x = &v->at[i];
  sb_printf(out, "%s: ", expr_symbol(g, v->space->q[i])->name);
  if (x->why_not) sb_printf(out, "no action variable: %s\n", x->why_not);
  else if (x->cyclic)
    sb_printf(out, "J = %.16Lg, the momentum %s, constant\n", x->J, expr_symbol(g, v->space->p[i])->name);
  else if (x->rests) sb_puts(out, "J = 0, at rest\n");
  else {
    sb_printf(out, "J = %.*Lg", x->digits, x->J);
    if (isfinite(x->omega))
      sb_printf(out, ", omega = dE/dJ = %.*Lg, period %.*Lg", x->omega_digits, x->omega, x->omega_digits,
                2 * acosl(-1) / fabsl(x->omega));
    if (x->rotates) sb_puts(out, ", going round: over a turn");
    else sb_printf(out, ", between %.10Lg and %.10Lg", x->low, x->high);
    sb_printf(out, "%s\n",
              x->digits < 16 ? "; no more digits are sure, as H is not smooth along the curve, or its terms cancel"
              : x->omega_digits < 16 ? "; omega has no more digits, as a separatrix is near"
                                     : "");
  }
}

static Name name_of(const ActionVariables *v, SymId s) { return expr_symbol(v->space->e->g, s)->name; }

/* "  r: pr^2/2 + alpha_th/r^2 - 1/r = energy", a line for each pair of a system that separates. */
static void print_separated(const ActionVariables *v, StrBuf *out) {
  const Separation *x = &v->separation;
  ExprGraph *g = v->space->e->g;
  if (!x->separates || x->n < 2) return;
  sb_puts(out, "H separates; the equations of its parts:\n");
  for (uint32_t k = 0; k < x->n; k++) {
    uint32_t i = x->order[k];
    sb_printf(out, "  %s: ", name_of(v, v->space->q[i]));
    if (x->left[i]) {
      expr_print(g, x->left[i], PRINT_TEXT, out);
      sb_puts(out, " = ");
      expr_print(g, x->right[i], PRINT_TEXT, out);
    } else sb_puts(out, "H = energy, with the other coordinates and momenta held");
    sb_putc(out, '\n');
  }
}

/* Remark on what the actions leave out; "" where there is none. */
static const char *remark_on(const Eqns *e) {
  if (noether_note_on_impacts(e->m))
    return "kicks, events or impacts change the state: the actions are those of the motion between them";
  if (eqns_has_forces(e)) return "forces stand outside H: the actions are those of the motion without them";
  if (e->conserves_energy) return "";
  return arena_printf(e->m->arena, "%s; the actions are those of the start, all else held", charges_energy_text(e));
}

static void print_text(const ActionVariables *v, StrBuf *out) {
  const Eqns *e = v->space->e;
  const char *remark = remark_on(e);
  sb_printf(out, "%s, scene %s: E = %.16Lg; all numbers in SI units\n", e->m->name, e->m->scene.name, v->E);
  for (uint32_t i = 0; i < v->space->n; i++) print_one(v, i, out);
  print_separated(v, out);
  if (*remark) sb_printf(out, "%s\n", remark);
}

/* --- JSON --- */

static void json_number(const char *name, long double x, int digits, StrBuf *out) {
  if (isfinite(x)) sb_printf(out, ", \"%s\": %.*Lg", name, digits, x);
  else sb_printf(out, ", \"%s\": null", name);
}

static void json_expr(const char *name, ExprGraph *g, Expr x, StrBuf *out) {
  sb_printf(out, ", \"%s\": ", name);
  if (!x) {
    sb_puts(out, "null");
    return;
  }
  sb_putc(out, '"');
  expr_print(g, x, PRINT_TEXT, out);
  sb_putc(out, '"');
}

static void json_action(const ActionVariables *v, uint32_t i, StrBuf *out) {
  const ActionVariable *x = &v->at[i];
  const Separation *s = &v->separation;
  ExprGraph *g = v->space->e->g;
  int turns = !x->why_not && !x->cyclic && !x->rests;
  sb_printf(out, "%s{\"coordinate\": \"%s\", \"momentum\": \"%s\", \"why_not\": \"%s\", \"cyclic\": %s",
            i ? ",\n  " : "\n  ", name_of(v, v->space->q[i]), name_of(v, v->space->p[i]), x->why_not ? x->why_not : "",
            x->cyclic ? "true" : "false");
  json_number("action", x->why_not ? NAN : x->J, turns ? x->digits : 17, out);
  json_number("frequency", turns ? x->omega : NAN, x->omega_digits, out);
  sb_printf(out, ", \"digits\": %d, \"frequency_digits\": %d", turns ? x->digits : 16, turns ? x->omega_digits : 16);
  json_number("low", turns && !x->rotates ? x->low : NAN, 17, out);
  json_number("high", turns && !x->rotates ? x->high : NAN, 17, out);
  json_expr("left", g, s->separates ? s->left[i] : 0, out);
  json_expr("right", g, s->separates ? s->right[i] : 0, out);
  sb_putc(out, '}');
}

static void print_json(const ActionVariables *v, StrBuf *out) {
  const Eqns *e = v->space->e;
  const Separation *s = &v->separation;
  sb_printf(out, "{\"model\": \"%s\", \"scene\": \"%s\"", e->m->name, e->m->scene.name);
  json_number("energy", v->E, 17, out);
  sb_printf(out, ", \"remark\": \"%s\", \"separates\": %s, \"tied\": [", remark_on(e), s->separates ? "true" : "false");
  if (!s->separates && s->kind[s->i] == PAIR_TIED)
    sb_printf(out, "\"%s\", \"%s\"", name_of(v, v->space->q[s->i]), name_of(v, v->space->q[s->j]));
  sb_puts(out, "], \"actions\": [");
  for (uint32_t i = 0; i < v->space->n; i++) json_action(v, i, out);
  sb_puts(out, "]}\n");
}

int command_action(Compiler *c) {
  const char *error = NULL;
  StrBuf out = strbuf(c->arena);
  ActionVariables v;
  int some = 0;
  if (!settings_compiled(c->ast, &c->o, 1, &c->given, &error)) return error ? usage_error(error) : STATUS_MODEL;
  if (c->o.rest.n) return usage_error(arena_printf(c->arena, "%s has no value: write name=value", c->o.rest.at[0]));
  Eqns *e = compiler_derive(c, &(ModelChoice){.scene = c->o.scene, .given = c->given.at, .ngiven = c->given.n});
  if (!e) return STATUS_MODEL;
  const char *why = reason_against_brackets(e->m);
  if (why) return diag_error(e->m->diags, e->m->span, "%s", why), STATUS_MODEL;
  if (!action_variables(e, &v)) return STATUS_MODEL;
  (c->o.json ? print_json : print_text)(&v, &out);
  for (uint32_t i = 0; i < v.space->n; i++) some |= !v.at[i].why_not;
  int status = compiler_write(c, NULL, &out);
  return status == STATUS_OK && !some ? STATUS_RUN : status;
}
