/* Prints symmetries with their charges (`lagc noether`), and Hamilton's equations (`lagc derive --hamiltonian`). */
#include "commands/noether.h"

#include <string.h>

#include "symmetry/charges.h"
#include "symmetry/noether_report.h"
#include "report/show.h"

static PrintStyle style_of(const char *format) { return format && strcmp(format, "latex") == 0 ? PRINT_LATEX : PRINT_TEXT; }

int conserved_print(const Deriver *d, const char *scene, const char *format, StrBuf *out) {
  Eqns *e = d->derive(d->data, &(ModelChoice){.scene = scene, .bare = !scene});
  if (!e) return 0;
  if (!e->m->lagrangian) {
    diag_error(e->m->diags, e->m->span, "no symmetries to look for: the model has no Lagrangian");
    return 0;
  }
  if (!scene && !charges_judge(e, NULL)) return 0;
  NoetherReport *r = noether_report(e);
  for (uint32_t i = 0; i < e->m->all_effects.n && !scene; i++) {
    Name effect = e->m->all_effects.at[i];
    const Eqns *with = d->derive(d->data, &(ModelChoice){.bare = 1, .also = effect});
    if (with) noether_report_effect(r, effect, with);
  }
  if (format && strcmp(format, "json") == 0) show_noether_json(r, out);
  else show_noether(r, style_of(format), out);
  return 1;
}

int hamiltonian_print(Eqns *e, const char *format, StrBuf *out) {
  if (e->n) {
    show_hamiltonian(e, style_of(format), out);
    return 1;
  }
  diag_error(e->m->diags, e->m->span, e->first.n ? "no Hamiltonian by momenta: L is linear in velocities" : "no Hamiltonian: the model has no Lagrangian");
  if (e->first.n) diag_help(e->m->diags, "coordinates are then canonical among themselves, and the energy is H: see `lagc derive` without --hamiltonian");
  return 0;
}
