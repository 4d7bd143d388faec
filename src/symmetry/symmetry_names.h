/* Names of the symmetries found, as physicists call them: momentum, rotation, boost, scaling. */
#pragma once

#include "symmetry/find_symmetries.h"
#include "symmetry/generator_table.h"

/* A row of a table with recognised coefficients: those of the generator by = (xi, tau). */
typedef struct {
  const Ansatz *ansatz;
  TimeKind kind;
  uint32_t blocks;
  Expr *c;      /* [blocks*shown], as in Table */
  Generator by;
} GeneratorRow;

typedef struct SortedName SortedName;

/* The coordinates that generators move. */
typedef struct {
  ExprGraph *g;
  Arena *arena;      /* for texts */
  uint32_t n;
  const Name *name;  /* [n] */
  const uint32_t *axis;     /* [n] see name_axis */
  const SortedName *sorted; /* [n] */
} CoordinateNames;

CoordinateNames coordinate_names(const Eqns *e);

enum { AXIS_NONE = 3 };

/* Axis of coordinate i by its name (r[2].x, x[2], x2, x): 0, 1, 2 for x, y, z; AXIS_NONE: none. Components of
 * rotations have none. */
uint32_t name_axis(const CoordinateNames *e, uint32_t i);
const char *axis_text(uint32_t axis);

/* The coordinate with that letter for its axis: r[2].y or y2 from r[2].x or x2; UINT32_MAX: there is none. */
uint32_t name_component(const CoordinateNames *e, uint32_t i, char letter);

/* Whether two coordinates are of a kind: along one axis, or members of one family. */
int name_same_kind(const CoordinateNames *e, uint32_t i, uint32_t k);

/* Whether two components belong to one body: their names agree in all but the letter. */
int name_same_body(Name a, Name b);

/* Gives a row the sign of textbooks: the energy is E, a turn goes from x to y, from y to z, from z to x. */
void orient_generator(const CoordinateNames *e, GeneratorRow *row);

/* Sets kind, name, axis and of_all of a found symmetry from its row. */
void name_symmetry(const CoordinateNames *e, const GeneratorRow *row, FoundSymmetry *to);
