/* The Hamiltonian side of a model, as text and as LaTeX. */
#include "mech/hamilton.h"
#include "report/equation_listing.h"
#include "report/listing_text.h"
#include "sym/simplify.h"

typedef VEC(Expr) Exprs;

static void keep(Text *t, Exprs *roots, Expr x) { vec_push(t->e->m->arena, roots, x); }

static Expr rate_symbol(Text *t, uint32_t i) { return expr_symbol(t->g, t->e->m->coords.at[i].v)->node; }

static const char *latex_rate(Text *t, SymId p) {
  return arena_printf(t->e->m->arena, "\\dot{%s}", text_latex_name(t, expr_symbol(t->g, p)->name));
}

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
  if (e->mass.n && !e->m->regularising) text_heading(t, mass_heading(e));
  for (uint32_t k = 0; k < e->mass.n && !e->m->regularising; k++) {
    Name row = e->m->coords.at[e->mass.at[k].row].name, col = e->m->coords.at[e->mass.at[k].col].name;
    Expr x = e->n <= 16 ? simplify(t->g, e->mass.at[k].e) : e->mass.at[k].e;
    text_named(t, arena_printf(a, "M[%s,%s]", row, col),
               arena_printf(a, "M_{%s,%s}", text_latex_name(t, row), text_latex_name(t, col)), x, k + 1 == e->mass.n);
    keep(t, roots, x);
  }
  if (e->mass.n && !e->m->regularising) text_end(t);
  text_heading(t, "energy: H as a function of velocities");
  text_named(t, "E", "E", e->energy, 1);
  keep(t, roots, e->energy);
  text_end(t);
}

void show_bracket(const Eqns *e, const char *name, Expr value, PrintStyle style, StrBuf *out) {
  Text t = {.e = e, .g = e->g, .style = style, .out = out};
  Expr shown = simplify(t.g, value);
  if (text_latex(&t)) sb_printf(out, "%% %s\n", name);
  else sb_printf(out, "%s = ", name);
  text_expr(&t, shown);
  sb_putc(out, '\n');
}

/* Whether a product may be 0: at some state, or for some values of parameters. Divisors, as m in 1/m, cannot make it
 * so. */
static int may_vanish(ExprGraph *g, Expr x) {
  Num c;
  if (expr_pairs(g, x, EX_SUM) == 1) x = expr_pair(g, x, EX_SUM, 0, &c);
  for (uint32_t i = 0; i < expr_pairs(g, x, EX_PROD); i++) {
    Expr base = expr_pair(g, x, EX_PROD, i, &c);
    if (num_sign(c) > 0 && !expr_is_nonzero(g, base)) return 1;
  }
  return 0;
}

void show_lagrangian(Eqns *e, PrintStyle style, StrBuf *out) {
  Text t = {.e = e, .g = e->g, .style = style, .out = out};
  const Model *m = e->m;
  InverseLegendre back = lagrangian_derive(e);
  Exprs roots = {0};
  text_title(&t);
  if (!back.why_not) {
    text_heading(&t, "momenta");
    for (uint32_t i = 0; i < m->pairs.n; i++) {
      text_equation(&t, expr_symbol(t.g, m->states.at[m->pairs.at[i].p].z)->node, back.p[i], i + 1 == m->pairs.n);
      keep(&t, &roots, back.p[i]);
    }
    text_end(&t);
    text_heading(&t, "Lagrangian");
    text_named(&t, "L", "L", back.L, 1);
    keep(&t, &roots, back.L);
    text_end(&t);
  }
  if (back.det && (expr_kinds(t.g, back.det) & 1u << SYM_STATE || (!back.why_not && may_vanish(t.g, back.det)))) {
    text_heading(&t, "velocities determine the momenta where this is not 0");
    text_named(&t, "det d2H/dp2", "\\det \\partial^2 H/\\partial p^2", back.det, 1);
    keep(&t, &roots, back.det);
    text_end(&t);
  }
  text_definitions(&t, roots.at, roots.n);
  if (back.why_not) sb_printf(out, "%sno Lagrangian in closed form: %s\n", text_latex(&t) ? "% " : "\n", back.why_not);
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
  if (!h.is_closed)
    sb_printf(out, "%s%s: simulators compute H as the energy, from velocities\n", text_latex(&t) ? "% " : "\n",
              h.why_not);
}
