/* Canonical transformations z = (q, p) -> Z = (Q, P): equations of a generating function, the inverse, and the new
 * Hamiltonian.
 *
 * F1(q, Q): p = dF/dq, P = -dF/dQ; F2(q, P): p = dF/dq, Q = dF/dP; F3(p, Q): q = -dF/dp, P = -dF/dQ; F4(p, P): q =
 * -dF/dp, Q = dF/dP. A map that depends on t adds R to the Hamiltonian: K(Z, t) = H(z(Z, t), t) + R, with R = dF/dt
 * of a generating function and, of any canonical map,
 *   dR/dZ = dq/dZ dp/dt - dp/dZ dq/dt   at fixed Z.
 * H. Goldstein, C. Poole, J. Safko, Classical Mechanics, 3rd ed. (2002), 9.1; L. D. Landau, E. M. Lifshitz,
 * Mechanics, 3rd ed. (1976), 45. */
#pragma once

#include "phase_space/expression_brackets.h"

/* The 2n equations left = right of a generating function: the old conjugates, then the new ones. */
typedef struct {
  const Expr *left, *right; /* [2n] left: a symbol */
} GeneratorEquations;
GeneratorEquations generator_equations(const PhaseSpace *s, const Canonical *c);

/* det d2F/dx dX of a generating function's old and new arguments, or det dq/dQ of a point transformation;
 * simplified. */
Expr canonical_determinant(ExprGraph *g, const Canonical *c);

/* z(Z, t), [2n]: as given, or solved for. NULL: not found. */
const Expr *canonical_inverse(const PhaseSpace *s, const Canonical *c);

/* x with sines and cosines of inverse functions as quotients: sin(atan2(y, x)) is y/sqrt(x^2 + y^2). */
Expr without_inverse_functions(ExprGraph *g, Expr x);

typedef struct {
  Expr K;           /* H(z(Z, t), t) + R, or without R where that is not found */
  int has_R;        /* the map depends on t */
  int found_R;      /* R in closed form is in K */
  const Expr *motion; /* [2n] Z' by H and the map alone */
  const Expr *rate; /* [2n] Z' of Hamilton's equations, with the forces outside H */
} NewHamiltonian;

NewHamiltonian canonical_hamiltonian(const PhaseSpace *s, const Canonical *c, const Expr *z);
