/* `lagc noether`: symmetries with their charges. */
#include "commands/commands.h"

#include <string.h>

#include "symmetry/charges.h"
#include "symmetry/noether_report.h"
#include "report/equation_listing.h"

static PrintStyle style_of(const char *format) { return format && strcmp(format, "latex") == 0 ? PRINT_LATEX : PRINT_TEXT; }

int noether_print(Compiler *c, const char *scene, const char *format, StrBuf *out) {
  Eqns *e = compiler_derive_compared(c, &(ModelChoice){.scene = scene, .bare = !scene});
  if (!e) return 0;
  if (!e->m->lagrangian) return diag_error(e->m->diags, e->m->span, "no symmetries to look for: the model has no Lagrangian");
  if (!scene && !charges_judge(e, NULL)) return 0;
  NoetherReport *r = noether_report(e);
  if (c->o.degree) r->polynomial = polynomial_charges_find(e, &r->found, (uint32_t)(*c->o.degree - '0'));
  if (c->o.involution) r->involution = involution_find(e, &r->found, r->polynomial);
  for (uint32_t i = 0; i < e->m->all_effects.n && !scene; i++) {
    Name effect = e->m->all_effects.at[i];
    const Eqns *with = compiler_derive_compared(c, &(ModelChoice){.bare = 1, .also = effect});
    if (with) noether_report_effect(r, effect, with);
  }
  if (format && strcmp(format, "json") == 0) show_noether_json(r, out);
  else show_noether(r, style_of(format), out);
  return 1;
}

int command_noether(Compiler *c) {
  StrBuf out = strbuf(c->arena);
  return noether_print(c, c->o.scene, c->o.format, &out) ? compiler_report(c, c->o.output, &out) : STATUS_MODEL;
}
