/* Rational functions: fractions of polynomials. The denominator stays factored, as a list of (polynomial, exponent):
 * sums over equal denominators stay small, and no greatest common divisor is needed.
 *
 * Must hold: factors are interned polynomials, primitive (integer coefficients without a common factor, the first
 * positive) and without a monomial of generators that may have negative exponents, which the numerator carries. A
 * power of a generator with a relation x^k = R is the factor x, never the expanded power; a factor equal to such an
 * R becomes x^k. Failures are those of the ring (poly.h); dividing by 0 adds POLY_DIVIDED_BY_ZERO. */
#pragma once

#include "sym/poly.h"

typedef uint32_t DenId; /* 0 is the denominator 1; equal lists have equal ids */

typedef struct {
  Poly num;
  DenId den;
} Frac;

typedef struct {
  PolyId factor;
  uint32_t exp;
} DenFactor;

typedef struct {
  const DenFactor *at; /* by ascending factor */
  uint32_t n;
} Den;

typedef struct {
  PolyRing *ring;
  VEC(Den) dens;
  IdTable den_table;
  VEC(GenId) root_of; /* by PolyId: 1 + the generator x whose relation x^k = R has this polynomial as R; 0: none */
} FracField;

FracField *frac_field(PolyRing *r);

/* Registers the relation x^k = R of x, so that a denominator equal to R becomes x^k. */
void frac_register_root(FracField *f, GenId x);

static inline Den frac_den(const FracField *f, DenId id) { return f->dens.at[id]; }

Frac frac_poly(Poly p);
Frac frac_num(FracField *f, Num c);
Frac frac_add(FracField *f, Frac a, Frac b);
Frac frac_sub(FracField *f, Frac a, Frac b);
Frac frac_neg(FracField *f, Frac a);
Frac frac_mul(FracField *f, Frac a, Frac b);
Frac frac_inv(FracField *f, Frac a);
Frac frac_pow(FracField *f, Frac a, int32_t n);

/* The sum of c[i]*a[i]; fractions over equal denominators are added in one pass. */
Frac frac_sum(FracField *f, const Frac *a, const Num *c, uint32_t n);

/* Least common multiple of two denominators; the cofactor to/from as a polynomial. */
DenId frac_lcm(FracField *f, DenId a, DenId b);
Poly frac_cofactor(FracField *f, DenId from, DenId to);

/* The product of a denominator's factors. */
Poly frac_den_poly(FracField *f, DenId den);

/* The denominator with these factors, given in any order; equal factors are merged, exponents 0 dropped. */
DenId frac_den_of(FracField *f, const DenFactor *at, uint32_t n);

/* a with factors of its denominator divided out of its numerator where that is exact. */
Frac frac_cancel(FracField *f, Frac a);
