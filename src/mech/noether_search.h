/* The inside of the search for symmetries (mech/noether_find.h): the ansatz, the linear equations that L makes of its coefficients, and
 * the space of their solutions.
 *
 * A generator is looked for as
 *   xi_i = sum over k of c_ik(t) phi_k,  phi = 1, q_1 .. q_n,   tau(t),   F = sum over l of f_l(t) psi_l, psi monomials of q.
 * delta L - dF/dt is linear in u = (tau, c, f) and in u'. For an L without t this is, at each state (q, q'),
 *   B0 u + B1 u' = 0
 * with numbers B0, B1. What satisfies that at all states and for all times is a space V on which u' = A u: the largest one with
 * B0 V in B1 V. So the coefficients are functions of time of any kind: exp(A t) says which. */
#ifndef LAGC_NOETHER_SEARCH_H
#define LAGC_NOETHER_SEARCH_H

#include "base/dense.h"
#include "mech/noether.h"
#include "mech/noether_forms.h"
#include "sym/eval.h"

/* xi_i contains c times phi_k: k is 0 for 1, j + 1 for q_j. */
typedef struct {
  uint32_t i, k;
} XiColumn;

enum { GAUGE_DEGREE_MOST = 3 };

/* A monomial of q: the product of phi of these. */
typedef struct {
  uint32_t of[GAUGE_DEGREE_MOST];
} GaugeColumn;

typedef struct {
  const Eqns *e;
  uint32_t n;              /* coordinates */
  const SymId *q, *v;      /* [n]; of an L of first order states and rates */
  uint32_t degree;         /* of the gauge function */
  int has_tau;             /* 0: L contains what is given from outside; column 0 then stays zero */
  int has_time;            /* L contains t */
  const LinearForms *forms; /* or NULL: phi are 1 and these, not the coordinates, and so are xi */
  int far_times;           /* every second time is four times as far out, which tells apart what oscillates with rates close to one another */
  VEC(XiColumn) xi;
  VEC(GaugeColumn) gauge;  /* the first is 1 */
  uint32_t shown;          /* columns of tau and xi: 1 + xi.n */
  uint32_t columns;        /* shown + gauge.n */
  uint32_t symbols;        /* symbols of the graph when the search begins, and 1; integrals declare more, which occur in nothing that it evaluates */
  VEC(uint32_t) held;      /* constraints that always hold: contacts do not */
} Ansatz;

/* All of it for up to 20 coordinates. Beyond that the linear part of xi mixes only the components of one vector. */
Ansatz *ansatz_new(Arena *a, const Eqns *e);

/* Whether the linear part was cut down. */
int ansatz_is_restricted(const Ansatz *a);

/* Which rows: of delta L - dF/dt; of its part that is even in velocities, without that at rest; of that at rest; of constraints, which a
 * generator must respect. ROWS_DIFFERENCE: of delta L - dF/dt less that of another state at the same time, which does not ask what F has of
 * t alone: its first gauge column is zero. */
typedef enum { ROWS_EVEN, ROWS_AT_REST, ROWS_ALL, ROWS_DIFFERENCE, ROWS_CONSTRAINTS } RowKind;

typedef struct RowSource RowSource;
typedef struct NoetherFrame NoetherFrame;

/* Rows are those of generators and gauge functions in other coordinates; NULL: in the model's own. */
const NoetherFrame *rows_frame(const RowSource *r);

/* parameters: values by symbol, at least [a->symbols], those of kinds other than SYM_PARAM and SYM_CONST are not looked at. */
RowSource *rows_new(const Ansatz *a, Arena *scratch, const long double *parameters);

/* Fills in up to `n` rows at states not yet used; those of a state with values that are not finite are left out. b0 and b1 are
 * [n*columns]. Returns how many there are: 0 where no state works, or L has no such rows. */
uint32_t rows_fill(RowSource *r, RowKind kind, uint32_t n, long double *b0, long double *b1);

/* One more row of ROWS_DIFFERENCE, or of constraints, at a state and a time, *t. 0: no state works. */
int rows_at_time(RowSource *r, RowKind kind, long double *b0, long double *b1, long double *t);

/* A space of solutions u(t): u = sum of x_a space[a], x' = A x. */
typedef struct {
  DenseRows space;   /* orthonormal in the frame of the search (its columns of xi are the model's, those of F the frame's); the gauge function 1, which means nothing, is one of its directions */
  long double *A;    /* [n*n] */
  int sure;          /* 0: ranks could not be told, or L has symmetries that are functions of time at will */
} SolutionSpace;

/* The space at values of the parameters. Where `like`, the space at other values in general position, is not NULL, and no frame depends on them, only
 * the coefficients that it has are looked at. */
SolutionSpace solution_space(const Ansatz *a, Arena *scratch, const long double *parameters, const SolutionSpace *like);

#endif
