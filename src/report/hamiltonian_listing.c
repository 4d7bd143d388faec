/* The Hamiltonian side of a model, as text and as LaTeX. */
#include "mech/hamilton.h"
#include "report/equation_listing.h"
#include "report/listing_text.h"
#include "sym/simplify.h"

typedef VEC(Expr) Exprs;

static void keep(Text *t, Exprs *roots, Expr x) { vec_push(t->e->m->arena, roots, x); }

static Expr rate_symbol(Text *t, uint32_t i) { return expr_symbol(t->g, t->e->m->coords.at[i].v)->node; }

static const char *latex_rate(Text *t, SymId p) { return arena_printf(t->e->m->arena, "\\dot{%s}", text_latex_name(t, expr_symbol(t->g, p)->name)); }

/* q' = dH/dp, p' = -dH/dq + Q, and flows of states with velocities replaced by dH/dp. */
static void motion(Text *t, const Hamilton *h, Exprs *roots) {
  const Model *m = t->e->m;
  uint32_t n = t->e->n;
  SymId *v = ARENA_ARRAY(m->arena, SymId, n + 1);
  text_heading(t, "Hamilton's equations");
  for (uint32_t i = 0; i < n; i++) {
    v[i] = m->coords.at[i].v;
    text_equation(t, rate_symbol(t, i), h->rate[i], 0);
    keep(t, roots, h->rate[i]);
  }
  for (uint32_t i = 0; i < n; i++) {
    Name p = expr_symbol(t->g, h->p[i])->name;
    text_named(t, arena_printf(m->arena, "%s'", p), latex_rate(t, h->p[i]), h->force[i], i + 1 == n && !m->states.n);
    keep(t, roots, h->force[i]);
  }
  for (uint32_t i = 0; i < m->states.n; i++) {
    Expr flow = expr_replace(t->g, m->states.at[i].flow, v, h->rate, n);
    text_equation(t, expr_symbol(t->g, m->states.at[i].rate)->node, flow, i + 1 == m->states.n);
    keep(t, roots, flow);
  }
  text_end(t);
}

static void constraints(Text *t, Exprs *roots) {
  const Constraints *k = &t->e->constraints;
  text_constraints(t);
  for (uint32_t i = 0; i < k->n; i++) keep(t, roots, i < k->nholonomic ? k->c[i] : k->r[i]);
}

/* The heading of M; momenta are M q' + a only while M contains no velocities. */
static const char *mass_heading(const Eqns *e) {
  for (uint32_t k = 0; k < e->mass.n; k++)
    if (expr_kinds(e->g, e->mass.at[k].e) & 1u << SYM_VEL) return "mass matrix: M = dp/dq'";
  return "mass matrix: p = M q' + a";
}

/* M, entry by entry, and the energy, which is H as a function of velocities. */
static void open_form(Text *t, Exprs *roots) {
  const Eqns *e = t->e;
  Arena *a = e->m->arena;
  if (e->mass.n && !e->m->across) text_heading(t, mass_heading(e));
  for (uint32_t k = 0; k < e->mass.n && !e->m->across; k++) {
    Name row = e->m->coords.at[e->mass.at[k].row].name, col = e->m->coords.at[e->mass.at[k].col].name;
    Expr x = e->n <= 16 ? simplify(t->g, e->mass.at[k].e) : e->mass.at[k].e;
    text_named(t, arena_printf(a, "M[%s,%s]", row, col), arena_printf(a, "M_{%s,%s}", text_latex_name(t, row), text_latex_name(t, col)), x, k + 1 == e->mass.n);
    keep(t, roots, x);
  }
  if (e->mass.n && !e->m->across) text_end(t);
  text_heading(t, "energy: H as a function of velocities");
  text_named(t, "E", "E", e->energy, 1);
  keep(t, roots, e->energy);
  text_end(t);
}

void show_hamiltonian(Eqns *e, PrintStyle style, StrBuf *out) {
  Text t = {.e = e, .g = e->g, .style = style, .out = out};
  Hamilton h = hamilton_derive(e);
  Exprs roots = {0};
  text_title(&t);
  text_momenta(&t);
  for (uint32_t i = 0; i < e->n; i++) keep(&t, &roots, e->momenta[i]);
  if (h.is_closed) {
    text_heading(&t, "Hamiltonian");
    text_named(&t, "H", "H", h.H, 1);
    text_end(&t);
    keep(&t, &roots, h.H);
    motion(&t, &h, &roots);
  } else open_form(&t, &roots);
  constraints(&t, &roots);
  text_definitions(&t, roots.at, roots.n);
  if (!h.is_closed) sb_printf(out, "%s%s: simulators compute H as the energy, from velocities\n", text_latex(&t) ? "% " : "\n", h.why_not);
}
