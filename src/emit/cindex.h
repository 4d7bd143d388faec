/* Tables of indices, which nests take from Nest.begin, IrPlace.row_at and IrPlace.turn_at (ir/prog.h). A table is written once in a file,
 * whichever functions need it. */
#ifndef LAGC_CINDEX_H
#define LAGC_CINDEX_H

#include "ir/prog.h"

typedef struct {
  const uint32_t *values;
  uint32_t n;
  const char *name;
} CIndex;

typedef struct {
  const char *stem; /* of names, which are this and a number */
  VEC(CIndex) all;
} CIndices;

/* Writes the tables of p that are not there yet, `indent` before each line. */
void cindex_declare(CIndices *t, const Prog *p, const char *indent, Arena *a, StrBuf *out);

/* What these n values are called; they have been declared. */
const char *cindex_name(const CIndices *t, const uint32_t *values, uint32_t n);

#endif
