/* Mending a false expectation: the single edit that makes it provable, and where it is. */
#ifndef LAGC_MEND_H
#define LAGC_MEND_H

#include "mech/eqns.h"
#include "sym/prove.h"

typedef struct {
  Span caret;
  const char *edit; /* "`sin(th1)` should be `cos(th1)`"; NULL when no single edit was found: the caret is
                       then where the least would have to change */
} Mend;

/* Needs an expectation that does not hold. The edit was proved to mend it. */
Mend mend_find(const Eqns *e, const Expect *x);

/* Whether two sides are equal by the equations of motion (accelerations solved for, rates and the
 * energy put in). */
Verdict mend_verdict(const Eqns *e, Expr lhs, Expr rhs);

#endif
