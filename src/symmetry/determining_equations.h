/* Internals of the search for symmetries (symmetry/find_symmetries.h): the ansatz, the linear equations for its
 * coefficients that delta L = dF/dt gives, and the space of their solutions.
 *
 * A generator is looked for as
 *   xi_i = sum over k of c_ik(t) phi_k, phi = 1, q_1 .. q_n, tau(t), F = sum over l of f_l(t) psi_l, psi monomials
 *   of q.
 * delta L - dF/dt is linear in u = (tau, c, f) and in u'. For an L without t this is, at each state (q, q'),
 *   B0 u + B1 u' = 0
 * with numbers B0, B1. The u that solve this at all states and times form the largest space V with B0 V in B1 V; on
 * it u' = A u, so u(t) = exp(A t) u(0): the coefficients may be functions of time of any kind. */
#pragma once

#include "base/dense_matrix.h"
#include "symmetry/noether_theorem.h"
#include "symmetry/search_limit.h"
#include "sym/expr_eval.h"

/* Coefficient of phi_k in xi_i; k is 0 for phi = 1, j + 1 for q_j. */
typedef struct {
  uint32_t i, k;
} XiColumn;

enum { GAUGE_DEGREE_MOST = 3 };

/* A monomial of q: the product of phi with these three indices. */
typedef struct {
  uint32_t of[GAUGE_DEGREE_MOST];
} GaugeColumn;

typedef struct {
  const Eqns *e;
  uint32_t n;              /* coordinates */
  const SymId *q, *v;      /* [n]; of a first-order L states and rates */
  uint32_t degree;         /* of the gauge function */
  /* 0: L contains inputs or states besides q, and tau is not looked for: column 0 stays zero */
  int has_tau;
  int has_time;            /* L contains t */
  /* every second time is four times as far out, to separate oscillations of nearly equal rates */
  int far_times;
  VEC(XiColumn) xi;
  VEC(GaugeColumn) gauge;  /* psi; the first is 1 */
  uint32_t shown;          /* columns of tau and xi: 1 + xi.n */
  uint32_t columns;        /* shown + gauge.n */
  /* number of symbols when the search begins, plus 1; integrals declare more, which it never evaluates */
  uint32_t symbols;
  VEC(uint32_t) held;      /* constraints that always hold: those of contacts do not */
  int whole;               /* 0: the linear part of xi mixes only the components of one vector */
  SearchLimit *limit;
} Ansatz;

enum { WHOLE_MOST = 20 };  /* coordinates of a whole ansatz */

Ansatz *ansatz_new(Arena *a, const Eqns *e, int whole, SearchLimit *limit);

/* Kinds of rows. ROWS_ALL: delta L - dF/dt at a state. ROWS_AT_REST: at q' = 0. ROWS_EVEN: the part even in q', less
 * its value at rest. ROWS_DIFFERENCE: delta L - dF/dt at two states of one time, subtracted: F(t) alone drops out,
 * and the first gauge column is zero. ROWS_CONSTRAINTS: a generator preserves the constraints. */
typedef enum { ROWS_EVEN, ROWS_AT_REST, ROWS_ALL, ROWS_DIFFERENCE, ROWS_CONSTRAINTS } RowKind;

typedef struct RowSource RowSource;

/* A source of random rows. parameters: values by symbol, at least [a->symbols]; only those of SYM_PARAM and
 * SYM_CONST are used. */
RowSource *rows_new(const Ansatz *a, Arena *scratch, const long double *parameters);

/* Whether rows can be had: L has finite values at these parameters. */
int rows_exist(const Ansatz *a, Arena *scratch, const long double *parameters);

/* Fills in up to `n` rows b0, b1 [n*columns] at new states; states with a value that is not finite are skipped.
 * Returns their number: 0 where no state works, or L has no such rows. */
uint32_t rows_fill(RowSource *r, RowKind kind, uint32_t n, long double *b0, long double *b1);

/* One more row of ROWS_DIFFERENCE or ROWS_CONSTRAINTS, at a state and a time *t. 0: no state works. */
int rows_at_time(RowSource *r, RowKind kind, long double *b0, long double *b1, long double *t);

/* Solutions u(t) = sum of x_a(t) space[a], x' = A x. */
typedef struct {
  DenseRows space;   /* orthonormal; one direction is F = 1 */
  long double *A;    /* [n*n] */
  /* 0: ranks are doubtful, L has symmetries with arbitrary functions of time, or the time is spent */
  int sure;
} SolutionSpace;

/* Solution space at given values of the parameters. like: the space at other generic values, in which only the
 * coefficients that occur there are searched; or NULL. */
SolutionSpace solution_space(const Ansatz *a, Arena *scratch, const long double *parameters, const SolutionSpace *like);
