/* What physicists call the symmetries that the search finds. */
#ifndef LAGC_NOETHER_NAME_H
#define LAGC_NOETHER_NAME_H

#include "mech/noether_find.h"
#include "mech/noether_table.h"

/* A row of a table with its coefficients recognised; those of the generator by = (xi, tau). */
typedef struct {
  const Ansatz *ansatz;
  TimeKind kind;
  uint32_t blocks;
  Expr *c;      /* [blocks*shown], as in Table */
  Generator by;
} GeneratorRow;

/* Signs as in books: the energy is E, a turn goes from x to y, from y to z, from z to x. */
void orient(const Eqns *e, GeneratorRow *row);

void name_symmetry(const Eqns *e, const GeneratorRow *row, FoundSymmetry *to);

/* Energy, three momenta, three angular momenta, three boosts. */
int has_galilean_charges(const FoundSymmetries *all);

#endif
