/* Coverage of switches by the states of a search: agreement says nothing of a side that no state was on. */
#ifndef LAGC_CLAIMS_SEEN_SIDES_H
#define LAGC_CLAIMS_SEEN_SIDES_H

#include "sym/expr.h"

typedef struct SeenSides SeenSides;

/* The sides in the roots: true and false of conditions; both signs of the arguments of `min`, `max`, `abs` and `sign` where both are possible; two
 * values of functions of one number that vary (tanh(x^2 + 30) is 1 in all digits there are). */
SeenSides *seen_sides(ExprGraph *g, const Expr *roots, uint32_t n);

/* Records a state that was compared. */
void seen_sides_note(SeenSides *s, const long double *symbols);

/* The first side that no state was on, as "`x > 1000` true"; NULL: all were seen. */
const char *seen_sides_missing(const SeenSides *s);

#endif
