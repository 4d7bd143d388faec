/* Linear systems that are solved in a loop: their entries are written to the workspace w, and a support function
 * solves them. */
#include "emit/cwriter_impl.h"

/* Writes w[at], w[at + 1], ... = values; eight or more equal neighbours, such as zeros of a sparse matrix, as a
 * loop. */
static void write_entries(Writer *w, uint32_t at, const Slot *values, uint32_t n) {
  enum { MANY = 8 };
  for (uint32_t j = 0, end; j < n; j = end) {
    for (end = j + 1; end < n && values[end] == values[j];) end++;
    const char *x = cwriter_operand(w, values[j]).text;
    if (end - j >= MANY) sb_printf(w->out, "  for (int i = %u; i < %u; i++) w[i] = %s;\n", at + j, at + end, x);
    for (uint32_t k = j; k < end && end - j < MANY; k++) sb_printf(w->out, "  w[%u] = %s;\n", at + k, x);
  }
}

/* Solves a system whose elements stand at their places, with a list of these. */
static void write_listed(Writer *w, const Solve *k) {
  const CStyle *st = w->style;
  uint32_t count = 0, column = 0;
  sb_puts(w->out, "  {\n  static const unsigned at[] = {");
  for (uint32_t j = 0; j < solve_elements(k); j++)
    if (k->matrix[j]) sb_printf(w->out, "%s%u", count++ == 0 ? "" : column++ % 16 == 15 ? ",\n    " : ", ", j);
  sb_puts(w->out, "};\n");
  sb_printf(w->out, "  %s_PIVOT(%s_listed(%u, %u, %d, at, 1, %u, w));\n  }\n", st->prefix, st->kkt, k->n, k->m,
            k->coarse, count);
}

/* A system with constraints; its matrix is cleared first, as most of it is zeros, unless these are so many that its
 * elements are listed. */
static void write_constrained(Writer *w, const Solve *k) {
  enum { BAND_LEAST = 62 }; /* LAG_BAND_LEAST of lag_kkt.h */
  const CStyle *st = w->style;
  uint32_t b = solve_elements(k), listed = k->n + k->m >= BAND_LEAST;
  sb_printf(w->out, "  for (int i = %u; i < %u; i++) w[i] = %s_C(0.0);\n", listed ? b : 0, b + solve_unknowns(k),
            st->prefix);
  for (uint32_t j = 0; j < b + solve_unknowns(k); j++) {
    Slot x = j < b ? k->matrix[j] : k->rhs[j - b];
    if (x) sb_printf(w->out, "  w[%u] = %s;\n", j, cwriter_operand(w, x).text);
  }
  if (listed) write_listed(w, k);
  else sb_printf(w->out, "  %s_PIVOT(%s(%u, %u, %d, w));\n", st->prefix, st->kkt, k->n, k->m, k->coarse);
}

void csolve_write(Writer *w, const Ins *i) {
  const Solve *k = &w->p->solves.at[i->index];
  uint32_t b = solve_elements(k);
  cwriter_flush_title(w);
  if (k->m) {
    write_constrained(w, k);
    return;
  }
  write_entries(w, 0, k->matrix, b);
  write_entries(w, b, k->rhs, k->n);
  const char *call = arena_printf(w->a, "%s(%u, w, w + %u)", w->style->solve, k->n, b);
  if (w->style->is_regular) sb_printf(w->out, "  (void)%s;\n", call);
  else sb_printf(w->out, "  %s_PIVOT(%s);\n", w->style->prefix, call);
}
