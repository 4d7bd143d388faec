/* Programs from bytes, checked: no index leaves what it indexes. */
#ifndef EVALUATOR_READ_PROGRAM_H
#define EVALUATOR_READ_PROGRAM_H

#include "evaluator/bytes.h"
#include "evaluator/program.h"

/* Lengths of the arrays that a program may read and write. */
typedef struct {
  int64_t in[PROGRAM_ARRAY_COUNT], out[PROGRAM_OUTPUTS];
} Lengths;

/* The next program of the bytes; NULL: there is none, or a fault. */
const Program *lag_read_program(Bytes *b, const Lengths *of);

#endif
