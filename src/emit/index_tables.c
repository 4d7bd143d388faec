/* Index tables as C arrays; equal tables are found by comparing their values. */
#include "emit/index_tables.h"

#include <string.h>

static const IndexTable *find(const IndexTables *t, const uint32_t *values, uint32_t n) {
  for (uint32_t k = 0; k < t->all.n; k++) {
    const IndexTable *x = &t->all.at[k];
    if (x->n == n && (x->values == values || memcmp(x->values, values, n * sizeof *values) == 0)) return x;
  }
  return NULL;
}

/* Smallest C type that holds all values and is promoted to int. */
static const char *type_of(const uint32_t *values, uint32_t n) {
  uint32_t most = 0;
  for (uint32_t k = 0; k < n; k++)
    if (values[k] > most) most = values[k];
  return most <= 255 ? "unsigned char" : most <= 65535 ? "unsigned short" : "int";
}

static void write_values(const uint32_t *values, uint32_t n, const char *indent, StrBuf *out) {
  enum { A_LINE = 32 };
  for (uint32_t k = 0; k < n; k++) {
    if (k % A_LINE == 0) sb_printf(out, "\n%s  ", indent);
    sb_printf(out, k + 1 < n ? "%u," : "%u", values[k]);
  }
}

static void declare(IndexTables *t, const uint32_t *values, uint32_t n, const char *indent, Arena *a, StrBuf *out) {
  if (!values || find(t, values, n)) return;
  IndexTable x = {values, n, arena_printf(a, "%s%u", t->stem, t->all.n + 1)};
  vec_push(a, &t->all, x);
  sb_printf(out, "%sstatic const %s %s[%u] = {", indent, type_of(values, n), x.name, n);
  write_values(values, n, indent, out);
  sb_printf(out, "\n%s};\n", indent);
}

void index_tables_declare(IndexTables *t, const Prog *p, const char *indent, Arena *a, StrBuf *out) {
  for (uint32_t k = 0; k < p->nests.n; k++) {
    const Nest *n = &p->nests.at[k];
    declare(t, n->begin, n->rows + 1, indent, a, out);
    for (uint32_t j = 0; j < n->n; j++) {
      declare(t, n->at[j].row_at, n->rows, indent, a, out);
      declare(t, n->at[j].turn_at, n->count, indent, a, out);
    }
  }
}

const char *index_table_name(const IndexTables *t, const uint32_t *values, uint32_t n) { return find(t, values, n)->name; }
