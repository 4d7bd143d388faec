/* `lagc derive`: the equations, for people, and what they cost. */
#include "commands/commands.h"

#include <string.h>

#include "base/words.h"
#include "claims/expect.h"
#include "emit/emit_model.h"
#include "emit/cwriter.h"
#include "report/equation_listing.h"
#include "phase_space/expression_brackets.h"
#include "syntax/parse.h"

static int refuse_form(const Eqns *e, const char *message, const char *help) {
  diag_error(e->m->diags, e->m->span, "%s", message);
  if (help) diag_help(e->m->diags, "%s", help);
  return 0;
}

/* Appends momenta, H(q, p) and Hamilton's equations. Returns 0, with the reason in the diags, where no such H
 * exists. */
static int hamiltonian_print(Eqns *e, PrintStyle style, StrBuf *out) {
  if (e->m->hamiltonian) show_equations(e, NULL, style, out);
  else if (e->n) show_hamiltonian(e, style, out);
  else if (!e->first.n) return refuse_form(e, "no Hamiltonian: the model has no Lagrangian", NULL);
  else
    return refuse_form(e, "no Hamiltonian by momenta: L is linear in velocities",
                       "coordinates are then canonical among themselves, and the energy is H: see `lagc derive` "
                       "without --hamiltonian");
  return 1;
}

/* Appends momenta and L(q, q') of a model that gives its Hamiltonian. */
static int lagrangian_print(Eqns *e, PrintStyle style, StrBuf *out) {
  if (!e->m->hamiltonian) {
    return refuse_form(e, e->m->lagrangian ? "the model gives its Lagrangian" : "the model gives no Hamiltonian",
                       "--lagrangian goes back from `hamiltonian = H` without a Lagrangian; beside one, H is a claim "
                       "that `lagc check` proves");
  }
  show_lagrangian(e, style, out);
  return 1;
}

/* Usage errors of the options that ask for another form than the equations of motion. */
static int form_is_wrong(Compiler *c) {
  const char *option = c->o.hamiltonian  ? "--hamiltonian"
                       : c->o.lagrangian ? "--lagrangian"
                       : c->o.bracket    ? "--bracket"
                                         : "--in";
  int forms = c->o.hamiltonian + c->o.lagrangian + (c->o.bracket != NULL) + (c->o.in != NULL);
  if (forms > 1) return usage_error("give one of --hamiltonian, --lagrangian, --bracket and --in");
  if (forms && (c->o.ops || (c->o.format && strcmp(c->o.format, "c") == 0)))
    return usage_error(arena_printf(c->arena, "%s goes with --format text or latex", option));
  return STATUS_OK;
}

static int print_form(Compiler *c, Eqns *e) {
  StrBuf out = strbuf(c->arena);
  int ok = (c->o.hamiltonian ? hamiltonian_print : lagrangian_print)(e, print_style(c->o.format), &out);
  return ok ? compiler_report(c, c->o.output, &out) : STATUS_MODEL;
}

/* {F, G} = value, in coordinates and momenta. */
static int print_bracket(Compiler *c, AstId bracket) {
  Eqns *e = compiler_derive(c, &(ModelChoice){.scene = c->o.scene, .bracket = bracket});
  StrBuf out = strbuf(c->arena);
  if (!e) return STATUS_MODEL;
  show_bracket(e, arena_printf(c->arena, "{%s}", c->o.bracket),
               expression_brackets_substitute(e, e->m->asked_bracket, 1), print_style(c->o.format), &out);
  return compiler_report(c, c->o.output, &out);
}

static const Canonical *find_canonical(const Model *m, const char *name) {
  Name *names = ARENA_ARRAY(m->arena, Name, m->canonicals.n + 1);
  for (uint32_t i = 0; i < m->canonicals.n; i++) {
    names[i] = m->canonicals.at[i].name;
    if (strcmp(names[i], name) == 0) return &m->canonicals.at[i];
  }
  Name near = suggest(name, names, m->canonicals.n);
  diag_error(m->diags, m->span, "the model has no canonical transformation `%s`", name);
  if (near) diag_help(m->diags, "did you mean `%s`?", near);
  else diag_help(m->diags, "declare it: `canonical %s: Q = ..., P = ...`", name);
  return NULL;
}

/* The Hamiltonian, or the equations of motion, in new variables. */
static int print_in(Compiler *c) {
  Eqns *e = compiler_derive(c, &(ModelChoice){.scene = c->o.scene, .domains = 1});
  const Canonical *to = e ? find_canonical(e->m, c->o.in) : NULL;
  StrBuf out = strbuf(c->arena);
  const char *how;
  if (!to) return STATUS_MODEL;
  const CaseSymbols symbols = cases_symbols(e->m);
  if (!canonical_holds(e, to, &symbols, &how)) return STATUS_MODEL;
  if (!to->is_point)
    return show_canonical(e, to, print_style(c->o.format), &out) ? compiler_report(c, c->o.output, &out) : STATUS_MODEL;
  e = compiler_derive_compared(c, &(ModelChoice){.bare = 1, .coordinates = to->name});
  if (!e) return STATUS_MODEL;
  show_equations(e, NULL, print_style(c->o.format), &out);
  return compiler_report(c, c->o.output, &out);
}

/* The operation count without --fix. */
static const char *unfixed_cost(Compiler *c) {
  Eqns *e = compiler_derive(c, &(ModelChoice){.scene = c->o.scene, .unfixed = 1});
  return e ? arena_printf(c->arena, "without --fix: %s\n", op_count_text(compiler_new_unit(c, e)->accel, c->arena))
           : "";
}

int command_derive(Compiler *c) {
  if (form_is_wrong(c)) return STATUS_USAGE;
  if (c->o.bracket) {
    const char *text = arena_printf(c->arena, "{%s}", c->o.bracket);
    const Source *source = source_add(c->sources, "--bracket", text, strlen(text));
    AstId bracket = source ? parse_expression(c->ast, source) : 0;
    return bracket ? print_bracket(c, bracket) : STATUS_USAGE;
  }
  if (c->o.in) return print_in(c);
  Eqns *e = compiler_derive_scene(c, c->o.scene);
  if (!e) return STATUS_MODEL;
  if (c->o.hamiltonian || c->o.lagrangian) return print_form(c, e);
  ProgramSet *u = compiler_lower_scene(c, e, 0);
  if (!u) return STATUS_MODEL;
  StrBuf out = strbuf(c->arena);
  const char *format = c->o.format ? c->o.format : "text";
  const char *cost = op_count_text(u->accel, c->arena);
  if (c->o.ops) sb_printf(&out, "%s\n%s", cost, c->o.fix ? unfixed_cost(c) : "");
  else if (strcmp(format, "c") == 0) {
    emit_accel(u, &out);
    return c->diags->errors ? STATUS_MODEL : compiler_write_c(c, c->o.output, &out);
  }
  else show_equations(e, cost, print_style(format), &out);
  return compiler_report(c, c->o.output, &out);
}
