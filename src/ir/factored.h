/* A linear system M q'' = f as the instructions that factor it leave it, to solve it again for other right-hand sides. Filled
 * by the files that factor, eliminate.c and solve.c, where they are asked to. */
#ifndef LAGC_FACTORED_H
#define LAGC_FACTORED_H

#include "base/sparse.h"
#include "ir/prog.h"

/* One coordinate: M. Two: m11, m12, m22, and det is the divisor. More: factored by a loop. */
typedef struct {
  uint32_t n;
  const uint32_t *at; /* [n] the coordinates */
  const Slot *M;      /* [n*n] row-major, lower triangle filled */
  Slot divisor;
  uint32_t place;     /* of the factored matrix in the work space */
} FactoredBlock;

/* Variables are those of LinearSystem in mech/eqns.h: 0 .. n-1 accelerations, n + k the rate of definition k. */
typedef struct {
  uint32_t n, ndefs;
  int straight;            /* eliminated in straight-line code, without pivoting; else blocks */
  const uint32_t *order;   /* [n + ndefs] of elimination, */
  const Slot *pivot;       /* [n] pivots, */
  const SparseRow *below;  /* [n] columns of the unit lower factor, */
  const SparseRow *C;      /* [n + ndefs] of a definition: its coefficients, */
  const SparseRow *row;    /* [n + ndefs] and its row of the quadratic form, as they are at its turn */
  VEC(FactoredBlock) blocks; /* without those that nothing accelerates */
  const Slot *inverse;     /* [n, or blocks.n] reciprocals of pivots, or of the divisors of blocks; NULL: divide by them */
} Factored;

/* Room that a matrix needs to stay factored, in reals: M[n*n], the right-hand side [n], the order of its rows [n]. */
static inline uint32_t factored_room(uint32_t n) { return n * n + 2 * n; }

/* Appends what solves the system in the program that the slots of `f` are of: x[n + ndefs] from the right-hand side b[n +
 * ndefs] and, of definitions, from what adds to C u', s[n + ndefs] (NULL: nothing). b is destroyed. */
void factored_solve(Prog *p, const Factored *f, Slot *b, const Slot *s, Slot *x);

#endif
