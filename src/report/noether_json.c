/* `lagc noether` as one JSON object: names and formulas are text of the language, in which no character needs an
 * escape. */
#include "symmetry/charges.h"
#include "model/printed_text.h"
#include "symmetry/noether_report.h"

static const char *comma(uint32_t k) { return k ? ", " : ""; }

/* Before element k of a list in lines. */
static const char *line(uint32_t k) { return k ? ",\n  " : "\n  "; }

static void put_expr(StrBuf *out, const Model *m, const char *before, Expr x) {
  sb_printf(out, "%s\"", before);
  expr_print_checked(m, x, PRINT_TEXT, out);
  sb_putc(out, '"');
}

/* The power; null where it is not known, or there is no charge. */
static void put_power(StrBuf *out, const Model *m, const Noether *is) {
  if (!is->charge || is->power_unknown) sb_puts(out, "null");
  else put_expr(out, m, "", is->power);
}

static void put_symmetry(StrBuf *out, const NoetherReport *r, uint32_t k) {
  const Eqns *e = r->e;
  const FoundSymmetry *s = &r->found.all.at[k];
  Name declared = noether_declared(r, k);
  uint32_t shown = 0;
  sb_printf(out, "%s{\"name\": \"%s\", \"delta\": {", line(k), s->name);
  for (uint32_t i = 0; i < eqns_coordinates(e); i++) {
    if (expr_is_zero(e->g, s->by.xi[i])) continue;
    sb_printf(out, "%s\"%s\": ", comma(shown++), expr_symbol(e->g, eqns_coordinate(e, i))->name);
    put_expr(out, e->m, "", s->by.xi[i]);
  }
  put_expr(out, e->m, "}, \"delta_t\": ", s->by.tau);
  put_expr(out, e->m, ", \"F\": ", s->is.F);
  put_expr(out, e->m, ", \"charge\": ", s->is.charge);
  sb_printf(out, ", \"is\": \"%s\", \"power\": ", charges_drift_word(s->is.drift));
  put_power(out, e->m, &s->is);
  Conditions positive = noether_conditions(r, k);
  for (uint32_t i = 0; i < positive.n; i++) put_expr(out, e->m, i ? ", " : ", \"positive\": [", positive.at[i]);
  if (positive.n) sb_putc(out, ']');
  if (s->is.over_time) put_expr(out, e->m, ", \"F_integral_of\": ", s->is.over_time);
  if (s->is.jumps) sb_puts(out, ", \"between_jumps\": true");
  if (declared) sb_printf(out, ", \"declared\": \"%s\"", declared);
  sb_putc(out, '}');
}

/* Nonzero coefficients by the number of their charge, from 1; the constant stands apart. */
static void put_bracket(StrBuf *out, const NoetherReport *r, uint32_t number) {
  const Bracket *k = &r->algebra.all.at[number];
  ExprGraph *g = r->e->g;
  uint32_t shown = 0;
  sb_printf(out, "%s{\"of\": [%u, %u], \"proved\": %s, ", line(number), k->a + 1, k->b + 1,
            k->proved ? "true" : "false");
  if (!k->c) {
    sb_printf(out, "\"is_combination\": %s, \"value\": ", k->is_outside ? "false" : "true");
    put_expr(out, r->e->m, "", k->value);
    sb_putc(out, '}');
    return;
  }
  put_expr(out, r->e->m, "\"constant\": ", k->constant);
  sb_puts(out, ", \"charges\": {");
  for (uint32_t i = 0; i < r->algebra.n; i++) {
    if (expr_is_zero(g, k->c[i])) continue;
    sb_printf(out, "%s\"%u\": ", comma(shown++), i + 1);
    put_expr(out, r->e->m, "", k->c[i]);
  }
  sb_puts(out, "}}");
}

static void put_scaling(StrBuf *out, const NoetherReport *r) {
  if (!r->scales) {
    sb_puts(out, "null");
    return;
  }
  sb_puts(out, "{\"powers\": {");
  for (uint32_t i = 0; i < r->e->n; i++) {
    sb_printf(out, "%s\"%s\": \"", comma(i), r->e->m->coords.at[i].name);
    num_print(out, r->scaling.alpha[i]);
    sb_putc(out, '"');
  }
  sb_puts(out, "}, \"t\": \"");
  num_print(out, r->scaling.beta);
  sb_puts(out, "\", \"action\": \"");
  num_print(out, r->scaling.kappa);
  sb_puts(out, "\"}");
}

static void put_effect(StrBuf *out, const NoetherReport *r, uint32_t number) {
  const EffectVerdict *v = &r->effects.at[number];
  const char *note = noether_note_on_impacts(v->e->m);
  sb_printf(out, "%s{\"effect\": \"%s\", \"note\": \"%s\", \"powers\": [", line(number), v->effect, note ? note : "");
  for (uint32_t k = 0; k < r->found.all.n; k++) {
    sb_puts(out, comma(k));
    put_power(out, v->e->m, &v->is[k]);
  }
  sb_puts(out, "]}");
}

/* Charges of higher degree in the momenta, if they were asked for. */
static void put_polynomial_charges(StrBuf *out, const NoetherReport *r) {
  const PolynomialCharges *f = r->polynomial;
  if (!f) return;
  sb_printf(
      out,
      ",\n \"degree\": {\"searched_to\": %u, \"not_proved\": %u, \"certain\": %s, \"why_not\": \"%s\", \"ansatz\": [",
      f->ansatz.n ? f->ansatz.n + 1 : 0, f->unproved, f->doubtful ? "false" : "true", f->why_not ? f->why_not : "");
  for (uint32_t k = 0; k < f->ansatz.n; k++) sb_printf(out, "%s\"%s\"", comma(k), f->ansatz.at[k]);
  sb_puts(out, "], \"charges\": [");
  for (uint32_t k = 0; k < f->all.n; k++) {
    sb_printf(out, "%s{\"degree\": %u, \"charge\": ", line(k), f->all.at[k].degree);
    put_expr(out, r->e->m, "", f->all.at[k].charge);
    sb_putc(out, '}');
  }
  sb_puts(out, "]}");
}

static void put_involution(StrBuf *out, const NoetherReport *r) {
  const Involution *v = r->involution;
  if (!v) return;
  sb_printf(out,
            ",\n \"involution\": {\"degrees_of_freedom\": %u, \"integrable\": %s, \"independent\": %u, "
            "\"search_ended_early\": %s, \"why_not\": \"%s\", \"charges\": [",
            v->n, !v->why_not && v->all.n == v->n ? "true" : "false", v->independent,
            v->steps || v->stopped || v->left_out ? "true" : "false", v->why_not ? v->why_not : "");
  for (uint32_t k = 0; k < v->all.n; k++) {
    const InvolutionCharge *x = &v->all.at[k];
    sb_puts(out, k ? ",\n  {" : "\n  {");
    if (x->kind == INVOLUTION_LISTED) sb_printf(out, "\"number\": %u, ", x->number + 1);
    if (x->kind == INVOLUTION_SQUARES)
      sb_printf(out, "\"squares_of\": [%u, %u, %u], ", x->of[0] + 1, x->of[1] + 1, x->of[2] + 1);
    if (x->name) sb_printf(out, "\"declared\": \"%s\", ", x->name);
    put_expr(out, r->e->m, "\"charge\": ", x->charge);
    sb_putc(out, '}');
  }
  sb_puts(out, "]}");
}

void show_noether_json(const NoetherReport *r, StrBuf *out) {
  const Model *m = r->e->m;
  const FoundSymmetries *f = &r->found;
  sb_printf(out, "{\"model\": \"%s\", \"effects_on\": [", m->name);
  for (uint32_t i = 0; i < m->effects.n; i++) sb_printf(out, "%s\"%s\"", comma(i), m->effects.at[i]);
  sb_printf(out, "], \"energy\": \"%s\", \"cyclic\": [", charges_energy_word(r->e));
  for (uint32_t i = 0; i < r->cyclic.n; i++) sb_printf(out, "%s\"%s\"", comma(i), m->coords.at[r->cyclic.at[i]].name);
  sb_printf(out,
            "],\n \"note\": \"%s\", \"ansatz\": \"%s\", \"searched\": %s, \"not_proved\": %u, \"galilean\": %s,\n "
            "\"symmetries\": [",
            f->note ? f->note : "", f->ansatz, f->searched ? "true" : "false", f->unproved,
            f->galilean ? "true" : "false");
  for (uint32_t k = 0; k < f->all.n; k++) put_symmetry(out, r, k);
  sb_puts(out, "],\n \"scaling\": ");
  put_scaling(out, r);
  sb_printf(out, ",\n \"brackets_known\": %s, \"brackets\": [", r->algebra.why_not ? "false" : "true");
  for (uint32_t k = 0; k < r->algebra.all.n; k++) put_bracket(out, r, k);
  sb_putc(out, ']');
  put_polynomial_charges(out, r);
  put_involution(out, r);
  sb_puts(out, ",\n \"effects\": [");
  for (uint32_t k = 0; k < r->effects.n; k++) put_effect(out, r, k);
  sb_puts(out, "]}\n");
}
