/* M q'' = f as instructions: blocks of coupled coordinates, each factored once and then solved for any
 * number of right-hand sides.
 *
 * A block whose mass matrix is proved positive definite is factored in straight-line code without
 * pivoting (Golub & Van Loan, Matrix Computations, 4th ed., algorithm 4.1.2); pivots are checked.
 * Other pairs go by Cramer's rule; other blocks, and large ones, by a loop with partial pivoting. */
#ifndef LAGC_SOLVE_H
#define LAGC_SOLVE_H

#include "ir/prog.h"

typedef struct {
  uint32_t n;
  const uint32_t *at;      /* [n] the coordinates of the block, ascending */
  const Slot *M;           /* [n*n] row-major, lower triangle filled; 0: a structural zero */
  const Slot *f;           /* [n] */
  int definite;            /* M is proved positive definite */
  uint32_t of;             /* number of coordinates of the model: one coordinate needs no numbers in names */
} Block;

typedef enum { FACTOR_ONE, FACTOR_STRAIGHT, FACTOR_PAIR, FACTOR_LOOP, FACTOR_INVERSE } FactorKind;

/* A factored block. Where `inverse` is set, it holds the reciprocals of `divisor`. */
typedef struct {
  FactorKind kind;
  uint32_t n;
  const Slot *L;       /* STRAIGHT: [n*n] unit lower factor; PAIR: m11, m12, m22; LOOP: M [n*n], or NULL: as factored before;
                          INVERSE: that of M [n*n] */
  const Slot *divisor; /* ONE: M; STRAIGHT: D [n]; PAIR: det */
  const Slot *inverse; /* the same number of slots, or NULL */
  uint32_t place;      /* LOOP: where the factored matrix stands in the function's work space */
} Factored;

/* "M12", "f2": a name with the numbers, from 1 on, of coordinates i and j (UINT32_MAX: none). */
Name block_name(const Block *b, Arena *a, const char *stem, uint32_t i, uint32_t j);

/* How many divisors a factor has. */
uint32_t factor_divisors(const Factored *f);

/* Appends what factors the block. *room: work space in use, in reals, to which a block that is factored by a loop adds its
 * own, to keep its factors; NULL: all such blocks share one place. */
Factored block_factor(Prog *p, const Block *b, uint32_t *room);

/* Room that a kept matrix needs, in reals: M[n*n], the right-hand side [n], the order of its rows [n]. */
uint32_t factored_room(uint32_t n);

/* Appends what solves for the right-hand side f[n]; x[n] receives the slots of the solution. */
void factor_solve(Prog *p, const Factored *fac, const Slot *f, Slot *x);

#endif
