/* Internals of find_symmetries.c, shared with the files that make generators from tables. */
#pragma once

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
  SearchLimit *limit;
} SymmetrySearch;

/* Solution space at a choice of parameter values; computed once. */
const SolutionSpace *noether_space_at(SymmetrySearch *s, uint32_t choice);

/* Number of choices of parameter values. */
uint32_t noether_choices(const SymmetrySearch *s);

/* Lists the proved generators of a family, and counts the others. 0: its equations could not be solved reliably. */
int noether_add_family(SymmetrySearch *s, const Family *f);

/* Whether the model has more coordinates than the search for all symmetries takes: a hundred. */
int too_large_to_search(const Eqns *e);

/* A scaling that keeps the action, with one exponent for all coordinates of a kind, by numbers; kappa is 0. */
int scaling_of_kinds(const Eqns *e, Scaling *found, SearchLimit *limit);

/* The generators of both lists that are independent: those of `first`, then of `second`. */
FoundSymmetries join_symmetries(const Eqns *e, const FoundSymmetries *first, const FoundSymmetries *second);

/* Tries the energy, momenta of cyclic coordinates, translations, boosts and rotations of all coordinates of a kind,
 * scalings and expansions. */
void try_usual_symmetries(Eqns *e, FoundSymmetries *out, SearchLimit *limit);
