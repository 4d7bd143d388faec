/* Equations of a family's members as one with an index. */
#pragma once

#include "base/strbuf.h"
#include "sym/print.h"
#include "sym/text_shape.h"

/* The lines of a block, made when they are needed. Of many that follow one another and have shapes of one family the
 * first ones and the last are made alone. */
typedef struct {
  uint32_t n;
  const ExprShape *shape; /* [n]; NULL: all lines are made */
  const char *(*line)(Arena *a, void *data, uint32_t k);
  void *data;
} FamilyLines;

/* The lines, each with its end, as family_rows writes them. */
const char *family_lines(Arena *a, const FamilyLines *lines, PrintStyle style);

/* The sum a + b + ..., also one in brackets, with terms of families as sums over their index. */
const char *family_sum(Arena *a, const char *text, PrintStyle style);

/* The lines of a block, each with its end, where five or more that follow one another differ by an index alone
 * written once: `u[i]'' = u[i + 1] - u[i]  for i in 2..9`. */
const char *family_rows(Arena *a, const char *lines, PrintStyle style);
