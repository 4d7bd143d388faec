/* `lagc derive`: the equations, for people, and what they cost. */
#include "commands/commands.h"

#include <string.h>

#include "emit/emit_model.h"
#include "emit/cwriter.h"
#include "lower/lower.h"
#include "report/equation_listing.h"

static PrintStyle style_of(const char *format) { return format && strcmp(format, "latex") == 0 ? PRINT_LATEX : PRINT_TEXT; }

/* Appends momenta, H(q, p) and Hamilton's equations. Returns 0, with the reason in the diags, where no such H exists. */
static int hamiltonian_print(Eqns *e, const char *format, StrBuf *out) {
  if (e->n) {
    show_hamiltonian(e, style_of(format), out);
    return 1;
  }
  diag_error(e->m->diags, e->m->span, e->first.n ? "no Hamiltonian by momenta: L is linear in velocities" : "no Hamiltonian: the model has no Lagrangian");
  if (e->first.n) diag_help(e->m->diags, "coordinates are then canonical among themselves, and the energy is H: see `lagc derive` without --hamiltonian");
  return 0;
}

static int print_hamiltonian(Compiler *c, Eqns *e) {
  StrBuf out = strbuf(c->arena);
  if (c->o.ops || (c->o.format && strcmp(c->o.format, "c") == 0)) return usage_error("--hamiltonian goes with --format text or latex");
  return hamiltonian_print(e, c->o.format, &out) ? compiler_write(c, c->o.output, &out) : STATUS_MODEL;
}

/* The operation count without --fix. */
static const char *unfixed_cost(Compiler *c) {
  Eqns *e = compiler_derive(c, &(ModelChoice){.scene = c->o.scene, .unfixed = 1});
  return e ? arena_printf(c->arena, "without --fix: %s\n", op_count_text(compiler_new_unit(c, e)->accel, c->arena)) : "";
}

int command_derive(Compiler *c) {
  Eqns *e = compiler_derive_scene(c, c->o.scene);
  if (!e) return STATUS_MODEL;
  if (c->o.hamiltonian) return print_hamiltonian(c, e);
  IrUnit *u = compiler_lower_scene(c, e, 0);
  if (!u) return STATUS_MODEL;
  StrBuf out = strbuf(c->arena);
  const char *format = c->o.format ? c->o.format : "text";
  const char *cost = op_count_text(u->accel, c->arena);
  if (c->o.ops) sb_printf(&out, "%s\n%s", cost, c->o.fix ? unfixed_cost(c) : "");
  else if (strcmp(format, "c") == 0) emit_accel(u, &out);
  else show_equations(e, cost, style_of(format), &out);
  return compiler_write(c, c->o.output, &out);
}
