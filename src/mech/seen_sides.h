/* Which sides of an expression a search by states has seen: agreement says nothing of a side that no state was on. */
#ifndef LAGC_SEEN_SIDES_H
#define LAGC_SEEN_SIDES_H

#include "sym/expr.h"

typedef struct SeenSides SeenSides;

/* The sides of the roots: of conditions, true and false; of `min`, `max`, `abs` and `sign`, both signs where both are possible; of functions of one number
 * that vary, two values (tanh(x^2 + 30) is 1 in all digits there are). */
SeenSides *seen_sides(ExprGraph *g, const Expr *roots, uint32_t n);

/* A state that was compared. */
void seen_sides_note(SeenSides *s, const long double *symbols);

/* What no state showed, as "`x > 1000` true"; NULL: all was seen. */
const char *seen_sides_missing(const SeenSides *s);

#endif
