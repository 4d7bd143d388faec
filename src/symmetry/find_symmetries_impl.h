/* Internals of find_symmetries.c, shared with the files that make generators from tables. */
#ifndef LAGC_SYMMETRY_FIND_SYMMETRIES_IMPL_H
#define LAGC_SYMMETRY_FIND_SYMMETRIES_IMPL_H

#include "symmetry/find_symmetries.h"
#include "symmetry/number_recognition.h"
#include "symmetry/generator_table.h"

/* A family of generators with one dependence on time. */
typedef struct {
  TimeKind kind;
  Expr rate;            /* w or s; 0 for powers of time */
  long double *rate2;   /* [choice] -w^2 or s^2; NAN: no solution has it at that choice */
  TimeList times;       /* functions of a list */
} Family;

typedef struct {
  Eqns *e;
  ExprGraph *g;
  Arena *scratch;
  Ansatz *ansatz;
  Choices choices;
  SolutionSpace *spaces; /* [choice]; width 0: not computed yet */
  FoundSymmetries *out;
} SymmetrySearch;

/* The tables of a family, one a choice of parameter values; those at CHOICE_MOVED and above are made when needed (moved). changes: how rows were
 * shortened. */
typedef struct {
  const Family *family;
  GeneratorTable *at;
  int moved;
  VEC(RowChange) changes;
} FamilyTables;

/* Solution space at a choice of parameter values; computed once. */
const SolutionSpace *noether_space_at(SymmetrySearch *s, uint32_t choice);

/* Number of choices of parameter values. */
uint32_t noether_choices(const SymmetrySearch *s);

/* Coefficients of a row of the table at the first choice as expressions, c[blocks*shown]; the row may be shortened. 0: one is not recognised. */
int noether_recognise(SymmetrySearch *s, FamilyTables *t, uint32_t row, Expr *c);

/* The table of a family at a choice of parameter values; no rows where the equations could not be solved reliably. */
GeneratorTable generator_table_at(SymmetrySearch *s, const Family *f, uint32_t choice);

/* Lists the proved generators of a family, and counts the others. */
void noether_add_family(SymmetrySearch *s, const Family *f);

#endif
