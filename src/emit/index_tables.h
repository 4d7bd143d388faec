/* Index tables of loop nests (Nest.begin, IrSubscript.row_at and IrSubscript.turn_at of ir/prog.h) as C arrays. Equal tables are
 * written once per file. */
#ifndef LAGC_EMIT_INDEX_TABLES_H
#define LAGC_EMIT_INDEX_TABLES_H

#include "ir/prog.h"

typedef struct {
  const uint32_t *values;
  uint32_t n;
  const char *name;
} IndexTable;

typedef struct {
  const char *stem; /* tables are named stem1, stem2, ... */
  VEC(IndexTable) all;
} IndexTables;

/* Writes the tables of p that the file does not have yet, `indent` before each line. */
void index_tables_declare(IndexTables *t, const Prog *p, const char *indent, Arena *a, StrBuf *out);

/* Name of the table with these n values, which must have been declared. */
const char *index_table_name(const IndexTables *t, const uint32_t *values, uint32_t n);

#endif
