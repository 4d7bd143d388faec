/* The inside of noether_find.c, shared with the files that make generators of tables. */
#ifndef LAGC_NOETHER_FIND_IMPL_H
#define LAGC_NOETHER_FIND_IMPL_H

#include "mech/noether_find.h"
#include "mech/noether_number.h"
#include "mech/noether_table.h"

/* A family of generators with one dependence on time. */
typedef struct {
  TimeKind kind;
  Expr rate;            /* w or s; 0 for powers of time */
  long double *rate2;   /* [choice] its square with its sign, where solutions have it */
  TimeList times;       /* of a list */
} Family;

typedef struct {
  Eqns *e;
  ExprGraph *g;
  Arena *scratch;
  Ansatz *ansatz;
  uint32_t first; /* of its choices of parameters' values, see mech/noether_number.h */
  Choices choices;
  SolutionSpace *spaces; /* [choice]; width 0: not asked for yet */
  FoundSymmetries *out;
} Search;

/* The tables of a family at all choices, those that are moved only when they are needed; and how rows of them were shortened. */
typedef struct {
  const Family *family;
  Table *at;
  int moved;
  VEC(TableChange) changes;
} Tables;

/* The space of solutions at a choice of parameters. */
const SolutionSpace *noether_space_at(Search *s, uint32_t choice);

/* Choices of parameters that there are. */
uint32_t noether_choices(const Search *s);

/* All coefficients of a row of the table at the first choice, c[blocks*shown], and the row may be shortened. 0: one is not recognised. */
int noether_recognise(Search *s, Tables *t, uint32_t row, Expr *c);

/* Whether the tables at all choices, which are made if they were not, have one shape. */
int noether_shapes_agree(Search *s, Tables *t);

Table noether_table_at(Search *s, const Family *f, uint32_t choice);

/* Lists what is proved of a family, and counts what is not. */
void noether_add_family(Search *s, const Family *f);

#endif
