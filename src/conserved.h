/* What `lagc noether` and `lagc derive --hamiltonian` print. */
#ifndef LAGC_CONSERVED_H
#define LAGC_CONSERVED_H

#include "deriver.h"

/* The symmetries of the scene's model; scene NULL: of the model without effects, and of each effect alone. format: text, latex, json, or
 * NULL. 0, with the reasons in the diags: a model that is wrong, a symmetry of it that is false, no Lagrangian. */
int conserved_print(const Deriver *d, const char *scene, const char *format, StrBuf *out);

/* Momenta, H(q, p), Hamilton's equations. 0, with the reason in the diags, where there is no such H. */
int hamiltonian_print(Eqns *e, const char *format, StrBuf *out);

#endif
