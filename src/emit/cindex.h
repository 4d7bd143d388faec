/* Index tables of loop nests (Nest.begin, IrPlace.row_at and IrPlace.turn_at of ir/prog.h) as C arrays. Equal tables are
 * written once per file. */
#ifndef LAGC_CINDEX_H
#define LAGC_CINDEX_H

#include "ir/prog.h"

typedef struct {
  const uint32_t *values;
  uint32_t n;
  const char *name;
} CIndex;

typedef struct {
  const char *stem; /* tables are named stem1, stem2, ... */
  VEC(CIndex) all;
} CIndices;

/* Writes the tables of p that the file does not have yet, `indent` before each line. */
void cindex_declare(CIndices *t, const Prog *p, const char *indent, Arena *a, StrBuf *out);

/* Name of the table with these n values, which must have been declared. */
const char *cindex_name(const CIndices *t, const uint32_t *values, uint32_t n);

#endif
