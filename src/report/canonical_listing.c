/* The Hamiltonian in the variables of a canonical transformation, as text and as LaTeX. */
#include "phase_space/canonical_map.h"
#include "report/equation_listing.h"
#include "report/listing_text.h"

static Expr node(const Text *t, SymId s) { return expr_symbol(t->g, s)->node; }

static void show_inverse(Text *t, const PhaseSpace *s, const Canonical *c, const Expr *z) {
  text_heading(t, "old variables");
  for (uint32_t k = 0; k < 2 * c->n; k++)
    text_equation(t, node(t, k < c->n ? s->q[k] : s->p[k - c->n]), z[k], k + 1 == 2 * c->n);
  text_end(t);
}

static void show_motion(Text *t, const Canonical *c, const NewHamiltonian *new) {
  text_heading(t, "Hamilton's equations");
  for (uint32_t k = 0; k < 2 * c->n; k++) {
    Name name = expr_symbol(t->g, c->fresh[k])->name;
    text_named(t, arena_printf(t->e->m->arena, "%s'", name),
               arena_printf(t->e->m->arena, "\\dot{%s}", text_latex_name(t, name)), new->rate[k], k + 1 == 2 * c->n);
  }
  text_end(t);
}

static const char *heading_of(const Canonical *c, const NewHamiltonian *new) {
  if (!new->has_R) return "Hamiltonian: K = H";
  if (!new->found_R)
    return "part of the Hamiltonian: H; the map's own change in time has no closed form found, and is in the equations "
           "below";
  return c->kind ? "Hamiltonian: K = H + dF/dt"
                 : "Hamiltonian: K = H + R, R found from the map's own change in time, up to a function of t";
}

int show_canonical(Eqns *e, const Canonical *c, PrintStyle style, StrBuf *out) {
  Text t = {.e = e, .g = e->g, .style = style, .out = out};
  PhaseSpace s;
  if (!phase_space_of(e, c->span, &s)) return 0;
  const Expr *z = canonical_inverse(&s, c);
  if (!z)
    return diag_error(e->m->diags, c->span,
                      "the inverse of `%s` is not found" HELP
                      "give the old variables as functions of the new, too: `%s = ..., ...`",
                      c->name, expr_symbol(e->g, s.q[0])->name);
  NewHamiltonian new = canonical_hamiltonian(&s, c, z);
  text_title(&t);
  show_inverse(&t, &s, c, z);
  text_heading(&t, heading_of(c, &new));
  text_named(&t, new.has_R && !new.found_R ? "H" : "K", new.has_R && !new.found_R ? "H" : "K", new.K, 1);
  text_end(&t);
  show_motion(&t, c, &new);
  return 1;
}
