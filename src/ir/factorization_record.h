/* The factors of a linear system M q'' = f as slots of the program that made them, to solve it for further
 * right-hand sides. Filled on request by eliminate.c, gram.c and solve.c. */
#pragma once

#include "base/sparse_pattern.h"
#include "ir/prog.h"

/* A block: n = 1: M and its divisor M; n = 2: m11, m12, m22, divisor det M; n > 2: solved by a loop. */
typedef struct {
  uint32_t n;
  const uint32_t *at; /* [n] the coordinates */
  SolveElements M;    /* lower triangle */
  Slot divisor;
} FactorBlock;

/* Variables are those of LinearSystem in mech/eqns.h: 0 .. n-1 accelerations, n + k the rate of definition k. */
typedef struct {
  uint32_t n, ndefs;
  int straight;            /* eliminated in straight-line code, without pivoting; else blocks */
  const uint32_t *order;   /* [n + ndefs] of elimination */
  const Slot *pivot;       /* [n] */
  const SparseRow *below;  /* [n] columns of the unit lower factor */
  const SparseRow *C;      /* [n + ndefs] coefficients of each definition, */
  const SparseRow *row;    /* and its row of the quadratic form, as at its step of elimination */
  VEC(FactorBlock) blocks; /* without blocks whose forces are all zero */
  const Slot *inverse;     /* reciprocals of pivots [n], or of divisors of blocks [blocks.n]; NULL: divide */
} FactorRecord;

/* Appends to p, of which f has the slots, the solution x[n + ndefs] for the right-hand side b[n + ndefs], where the
 * rate of definition k is C u' + s[n + k] (s NULL: 0). b is destroyed. */
void factor_record_solve(Prog *p, const FactorRecord *f, Slot *b, const Slot *s, Slot *x);

/* Computes x[v] from b and the unknowns eliminated after v: the step of back substitution. */
void factor_record_backward(Prog *p, const FactorRecord *f, uint32_t v, const Slot *b, const Slot *s, Slot *x);
