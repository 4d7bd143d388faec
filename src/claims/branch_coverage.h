/* Coverage of switches by the states of a search: agreement says nothing of a side that no state was on. */
#pragma once

#include "sym/expr.h"

/* The function at whose zeros a comparison, `min`, `max`, `abs` or `sign` switches; 0: e is none of these. */
Expr switching_function(ExprGraph *g, Expr e);

typedef struct BranchCoverage BranchCoverage;

/* The sides in the roots: true and false of conditions; both signs of the arguments of `min`, `max`, `abs` and
 * `sign` where both are possible; two values of functions of one number that vary (tanh(x^2 + 30) is 1 in all digits
 * there are). */
BranchCoverage *branch_coverage(ExprGraph *g, const Expr *roots, uint32_t n);

/* Records a state that was compared. */
void branch_coverage_note(BranchCoverage *s, const long double *symbols);

/* The first side that no state was on, as "`x > 1000` true"; NULL: all were seen. */
const char *branch_coverage_missing(const BranchCoverage *s);
