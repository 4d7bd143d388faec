/* The ansatz for charges that are polynomials of the momenta, Q = sum of c_k phi_k: the c_k are constants, each
 * phi_k is a product of momenta, of coordinates, and of functions of coordinates that stand in L, such as 1/r or
 * exp(x - y).
 *
 * Along the motion p' = dL/dq + forces, so the rate of phi_k at a state (q, q') needs no inverse of the mass matrix.
 * Of a model that gives its Hamiltonian, states are (q, p). */
#pragma once

#include "mech/eqns.h"
#include "sym/expr_eval.h"

typedef struct {
  Eqns *e;
  ExprGraph *g;
  Arena *scratch;
  uint32_t n, functions, factors; /* factors: n coordinates, the functions, n momenta */
  /* [n] v: velocities, or momenta of a Hamiltonian; p: symbols that stand for the momenta */
  const SymId *q, *v, *p;
  Expr *factor;                   /* [factors] */
  Expr *momenta, *rate, *force;   /* [n] p, q', p' in q, v, t */
  int even;                       /* L or H is even in v: charges of even and of odd degree are searched one by one */
  int curved, quadratic;          /* second derivatives by v contain coordinates; no v */
  uint32_t potential_degree;      /* of the polynomials in V, or twice that of those in terms linear in v */
  /* functions in the terms of the highest degree in the momenta: 0 where M is constant */
  uint32_t spare;
  uint32_t symbols;
  EvalTape *tape;                 /* values and rates of the factors, at */
  long double *state, *out;       /* the state evaluated last */
  uint32_t degree, leading;       /* degree in the momenta; degree in the coordinates of the terms of that degree */
  uint32_t columns;
  uint8_t *power;                 /* [columns*factors] exponents of phi_k */
} MomentumAnsatz;

/* Factors of the ansatz. Needs coordinates with accelerations, or a Hamiltonian. */
MomentumAnsatz *momentum_ansatz_new(Arena *scratch, Eqns *e);

/* Fills in the columns of charges of a degree in the momenta: coefficients at that degree are polynomials of the
 * coordinates of degree `leading`: the degree in the momenta, one more where M depends on coordinates, less where
 * there would be too many columns. 0: too many even with constants. */
int momentum_ansatz_fill(MomentumAnsatz *a, uint32_t degree);

/* Degree in the coordinates of the coefficients, and number of functions in a product, of the terms that are `below`
 * degrees lower in the momenta. */
uint32_t momentum_ansatz_polynomial(const MomentumAnsatz *a, uint32_t below);
uint32_t momentum_ansatz_functions(const MomentumAnsatz *a, uint32_t below);

/* Random state number `seed` with the given parameters: a->state[symbols]. */
void momentum_state(const MomentumAnsatz *a, const long double *parameters, uint32_t seed);

/* Values and rates of all phi_k at that state. 0: one is not finite. */
int momentum_row(const MomentumAnsatz *a, const long double *parameters, uint32_t seed, long double *value,
                 long double *rate);

/* phi_k, with momenta as symbols: the monomial, times the product of functions. */
Expr momentum_product(const MomentumAnsatz *a, uint32_t k, Expr *function);

/* dQ/dt along the motion, and Q in velocities if the model has some, of a Q with momenta as symbols. */
Expr momentum_rate(const MomentumAnsatz *a, Expr Q);
Expr momentum_in_velocities(const MomentumAnsatz *a, Expr Q);
