/* Charges that are polynomials of the momenta with coefficients free of t, of degree 2 to 4: the energies of parts,
 * Runge and Lenz's vector, Fradkin's tensor. Their symmetries move no points of space, so the search for generators
 * does not see them.
 *
 * Numbers find candidates, symbols decide: dQ/dt = 0 at random states gives the space of all charges within the
 * ansatz (momentum_ansatz.h); products of charges known before are taken out of it; coefficients are recognised, and
 * dQ/dt = 0 is proved. J. Hietarinta, Direct methods for the search of the second invariant, Physics Reports 147
 * (1987) 87, DOI 10.1016/0370-1573(87)90089-5. */
#pragma once

#include "symmetry/find_symmetries.h"

enum { POLYNOMIAL_DEGREE_MOST = 4 };

typedef struct {
  uint32_t degree; /* in the momenta */
  Expr charge;     /* in q, q' */
} PolynomialCharge;

typedef struct {
  uint32_t degree;      /* searched up to */
  const char *why_not;  /* reason for no search; or NULL */
  VEC(PolynomialCharge) all;
  VEC(const char *) ansatz; /* for each degree from 2, in words */
  uint32_t unproved;    /* directions that are no products, and were not recognised or not proved */
  int doubtful;         /* a rank was not certain */
} PolynomialCharges;

/* Searches degree 1, 2, .. up to `degree`; products of known charges and of those found before are not listed.
 * Charges of degree 1 are new where their generator is not affine in the coordinates. */
PolynomialCharges *polynomial_charges_find(Eqns *e, const FoundSymmetries *known, uint32_t degree, SearchLimit *limit);
