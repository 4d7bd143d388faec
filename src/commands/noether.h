/* The reports of `lagc noether` and `lagc derive --hamiltonian`. */
#ifndef LAGC_COMMANDS_NOETHER_H
#define LAGC_COMMANDS_NOETHER_H

#include "commands/deriver.h"

/* Appends the symmetries of the scene's model; scene NULL: of the model without effects, and with each effect alone. format: text, latex, json or
 * NULL. Returns 0, with the reason in the diags, for a wrong model, a declared symmetry that is false, or no Lagrangian. */
int conserved_print(const Deriver *d, const char *scene, const char *format, StrBuf *out);

/* Appends momenta, H(q, p) and Hamilton's equations. Returns 0, with the reason in the diags, where no such H exists. */
int hamiltonian_print(Eqns *e, const char *format, StrBuf *out);

#endif
