/* Linear systems that are solved in a loop: their entries are written to the workspace w, and a support function
 * solves them. */
#include "emit/cwriter_impl.h"

/* Writes w[from] to w[end - 1] = value; eight or more, such as zeros of a sparse matrix, as a loop. */
static void write_run(Writer *w, uint32_t from, uint32_t end, Slot value) {
  enum { MANY = 8 };
  const char *x = cwriter_operand(w, value).text;
  if (end - from >= MANY) sb_printf(w->out, "  for (int i = %u; i < %u; i++) w[i] = %s;\n", from, end, x);
  for (uint32_t k = from; k < end && end - from < MANY; k++) sb_printf(w->out, "  w[%u] = %s;\n", k, x);
}

/* Writes the matrix, with its zeros. */
static void write_matrix(Writer *w, const Solve *k) {
  const SolveElement *at = k->list.at;
  for (uint32_t j = 0, e = 0, n = k->list.n, end; j < solve_elements(k); j = end) {
    while (e < n && (at[e].at < j || !at[e].x)) e++;
    Slot x = e < n && at[e].at == j ? at[e].x : 0;
    end = x ? j + 1 : e < n ? at[e].at : solve_elements(k);
    for (uint32_t f = e + 1; x && f < n && at[f].at == end && at[f].x == x; f++) end++;
    write_run(w, j, end, x);
  }
}

/* Solves a system whose elements stand at their places, with a list of these. */
static void write_listed(Writer *w, const Solve *k) {
  const CStyle *st = w->style;
  uint32_t count = 0, column = 0;
  sb_puts(w->out, "  {\n  static const unsigned at[] = {");
  for (uint32_t j = 0; j < k->list.n; j++)
    if (k->list.at[j].x)
      sb_printf(w->out, "%s%u", count++ == 0 ? "" : column++ % 16 == 15 ? ",\n    " : ", ", k->list.at[j].at);
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
  for (uint32_t j = 0; j < k->list.n + solve_unknowns(k); j++) {
    SolveElement e = j < k->list.n ? k->list.at[j] : (SolveElement){b + j - k->list.n, k->rhs[j - k->list.n]};
    if (e.x) sb_printf(w->out, "  w[%u] = %s;\n", e.at, cwriter_operand(w, e.x).text);
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
  write_matrix(w, k);
  for (uint32_t j = 0, end; j < k->n; j = end) {
    for (end = j + 1; end < k->n && k->rhs[end] == k->rhs[j];) end++;
    write_run(w, b + j, b + end, k->rhs[j]);
  }
  const char *call = arena_printf(w->a, "%s(%u, w, w + %u)", w->style->solve, k->n, b);
  if (w->style->is_regular) sb_printf(w->out, "  (void)%s;\n", call);
  else sb_printf(w->out, "  %s_PIVOT(%s);\n", w->style->prefix, call);
}
