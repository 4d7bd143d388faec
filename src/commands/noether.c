/* `lagc noether`: symmetries with their charges. */
#include "commands/commands.h"

#include <stdio.h>
#include <string.h>

#include "symmetry/charges.h"
#include "symmetry/noether_report.h"
#include "toolchain/process.h"

/* Each stage that begins or goes on after a second. */
static void show_progress(SearchLimit *l, double spent) {
  if (spent < 1 || l->shown == l->doing) return;
  fprintf(stderr, "lagc: %.2g of %.3g s; looking for %s\n", spent, l->seconds, l->doing);
  l->shown = l->doing;
}

int noether_print(Compiler *c, const char *scene, double seconds, const char *format, StrBuf *out) {
  Eqns *e = compiler_derive_compared(c, &(ModelChoice){.scene = scene, .bare = !scene});
  if (!e) return 0;
  if (!e->m->lagrangian)
    return diag_error(e->m->diags, e->m->span, "no symmetries to look for: the model has no Lagrangian");
  if (!scene && !charges_judge(e, NULL)) return 0;
  SearchLimit limit = search_limit(seconds);
  if (stderr_is_terminal()) limit.show = show_progress;
  NoetherReport *r = noether_report(e, &limit);
  if (c->o.degree) r->polynomial = polynomial_charges_find(e, &r->found, (uint32_t)(*c->o.degree - '0'), &limit);
  if (c->o.involution) r->involution = involution_find(e, &r->found, r->polynomial, &limit);
  for (uint32_t i = 0; i < e->m->all_effects.n && !scene; i++) {
    Name effect = e->m->all_effects.at[i];
    const Eqns *with = compiler_derive_compared(c, &(ModelChoice){.bare = 1, .also = effect});
    if (with) noether_report_effect(r, effect, with);
  }
  if (format && strcmp(format, "json") == 0) show_noether_json(r, out);
  else show_noether(r, print_style(format), out);
  return 1;
}

int command_noether(Compiler *c) {
  StrBuf out = strbuf(c->arena);
  double seconds = 10;
  if (c->o.seconds && (!num_parse_double(c->o.seconds, &seconds) || !(seconds > 0)))
    return usage_error(
        arena_printf(c->arena, "--seconds %s: the time for the search, for example --seconds 60", c->o.seconds));
  return noether_print(c, c->o.scene, seconds, c->o.format, &out) ? compiler_report(c, c->o.output, &out)
                                                                  : STATUS_MODEL;
}
