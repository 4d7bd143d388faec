/* The size of large families: a constant N, as of `coord x[N]`, of which the text says the same for every value.
 *
 * Such a text names members by their distance from an end (x[3], x[N-1], x[N/2 + 1]). Numbers that the compiler knows,
 * and that depend on N or on an index, are polynomials, quotients or sines; none is compared or rounded but those that
 * say where a member stands. So no member is special that is not so in every size, and what is true of one size is
 * true of all that are large enough and leave the same remainder by FAMILY_STEP: a cutoff, as in the verification of
 * parameterised systems (E. A. Emerson, K. S. Namjoshi, Reasoning about rings, POPL 1995, 85,
 * doi:10.1145/199448.199468). */
#pragma once

#include "model/model.h"

/* Places are given by numbers up to FAMILY_END; from FAMILY_LEAST members on, nothing is near two of the first, the
 * middle and the last. Headers have dense matrices of up to 300 quantities. */
enum { FAMILY_LEAST = 304, FAMILY_STEP = 16, FAMILY_END = 32 };

typedef struct {
  Name name; /* NULL: there is none */
  int64_t value;
} FamilySize;

/* Such a constant with a value of `from` or more, which the text or a definition of the command line gives as a
 * number. */
FamilySize family_size(const Ast *ast, const Define *defines, uint32_t n, int64_t from);
