/* Linear systems that are solved in a loop: their entries are written to the workspace w, and a support function solves them. */
#include "emit/cwriter_impl.h"

/* Writes to[at], to[at + 1], ... = values; eight or more equal neighbours, such as zeros of a sparse matrix, as a loop. */
static void write_entries_from(Writer *w, const char *to, uint32_t at, const Slot *values, uint32_t n) {
  enum { MANY = 8 };
  for (uint32_t j = 0, end; j < n; j = end) {
    for (end = j + 1; end < n && values[end] == values[j];) end++;
    const char *x = cwriter_operand(w, values[j]).text;
    if (end - j >= MANY) sb_printf(w->out, "  for (int i = %u; i < %u; i++) %s[i] = %s;\n", at + j, at + end, to, x);
    for (uint32_t k = j; k < end && end - j < MANY; k++) sb_printf(w->out, "  %s[%u] = %s;\n", to, at + k, x);
  }
}

/* Clears the first `all` reals of w and writes the nonzero entries of a sparse matrix. */
static void write_entries(Writer *w, const Solve *k, uint32_t all) {
  sb_printf(w->out, "  for (int i = 0; i < %u; i++) w[i] = %s_C(0.0);\n", all, w->style->prefix);
  for (uint32_t j = 0; j < solve_elements(k); j++)
    if (k->matrix[j]) sb_printf(w->out, "  w[%u] = %s;\n", j, cwriter_operand(w, k->matrix[j]).text);
}

/* A system with constraints; its matrix is cleared first, as large ones are mostly zeros. */
static void write_constrained(Writer *w, const Solve *k) {
  const CStyle *st = w->style;
  uint32_t b = k->m * k->n + k->n * k->n;
  write_entries(w, k, b + solve_unknowns(k));
  for (uint32_t j = 0; j < solve_unknowns(k); j++)
    if (k->rhs[j]) sb_printf(w->out, "  w[%u] = %s;\n", b + j, cwriter_operand(w, k->rhs[j]).text);
  sb_printf(w->out, "  %s_PIVOT(%s(%u, %u, %d, w));\n", st->prefix, st->kkt, k->n, k->m, k->coarse);
}

/* Writes the matrix: nonzero entries of a narrow band, the upper triangle of a definite matrix, or all entries. */
static void write_matrix(Writer *w, const Solve *k) {
  uint32_t n = k->n;
  if (k->band < n / 2 - 1) write_entries(w, k, n * n);
  else if (!k->definite) write_entries_from(w, "w", 0, k->matrix, n * n);
  else for (uint32_t i = 0; i < n; i++) write_entries_from(w, "w", i * n + i, k->matrix + i * n + i, n - i);
}

void csolve_write(Writer *w, const Ins *i) {
  const Solve *k = &w->p->solves.at[i->index];
  const CStyle *st = w->style;
  uint32_t n = k->n, M = k->place, b = M + n * n;
  cwriter_flush_title(w);
  if (k->m) {
    write_constrained(w, k);
    return;
  }
  if (k->inverse) {
    write_entries_from(w, "w", 0, k->rhs, n);
    sb_printf(w->out, "  %s(%u, %s + %u, w);\n", st->multiply, n, st->in[ARR_P], k->inverse);
    return;
  }
  if (k->matrix && !st->factor) write_matrix(w, k);
  else if (k->matrix) write_entries_from(w, "w", M, k->matrix, n * n);
  if (st->factor && k->matrix) sb_printf(w->out, "  %s_PIVOT(%s(%u, w + %u));\n", st->prefix, st->factor, n, M);
  write_entries_from(w, "w", b, k->rhs, n);
  if (st->factor) sb_printf(w->out, "  %s(%u, w + %u);\n", st->substitute, n, M);
  else sb_printf(w->out, "  %s_PIVOT(%s%s(%u, %u, w, w + %u));\n", st->prefix, st->solve, k->definite ? "_definite" : "", n, k->band, b);
}

void csolve_write_inverse(Writer *w, const Ins *i) {
  const Solve *k = &w->p->solves.at[i->index];
  cwriter_flush_title(w);
  write_entries_from(w, w->style->in[ARR_P], k->place, k->matrix, solve_elements(k));
  sb_printf(w->out, "  %s(%u, %s + %u);\n", w->style->invert, k->n, w->style->in[ARR_P], k->place);
}
