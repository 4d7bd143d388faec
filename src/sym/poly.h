/* Sparse multivariate polynomials over Q, modulo relations x^k = R.
 *
 * Enters: generators, and for some of them a relation x^k = R, where R contains older generators only. Leaves:
 * polynomials in normal form, that is the unique combination of monomials in which the exponent of such an x is 0 ..
 * k-1. Generators without a relation may have negative exponents (Laurent polynomials); generators with a relation
 * may not. Must hold: coefficients are exact. A coefficient beyond 64 bits ends the computation with the status
 * POLY_INEXACT; more terms or work than allowed end it with POLY_TOO_LARGE. The status stays, and later operations
 * return at once with meaningless results: callers check the status at the end. In a ring with `residues` set such a
 * coefficient is a double with its residue (base/num.h): a polynomial that vanishes is still the polynomial 0.
 *
 * Ownership: all in the ring's arena. Polynomials are values that are never changed. */
#pragma once

#include "base/num.h"
#include "base/vec.h"
#include "base/hash.h"
#include "base/id_table.h"

typedef uint32_t GenId;
typedef uint32_t MonoId; /* monomials are interned; 0 is the monomial 1 */
typedef uint32_t PolyId; /* polynomials are interned on request; 0 is the polynomial 0 */

enum { GEN_NONE = 0x7fffffff };

typedef struct {
  GenId gen;
  int32_t exp;
} MonoPow;

typedef struct {
  const MonoPow *at; /* by ascending generator, no exponent is 0 */
  uint32_t n, hash;
  GenId reducible; /* the last generator whose exponent its relation lowers, or GEN_NONE */
} Mono;

typedef struct {
  MonoId mono;
  Num c; /* not 0; exact, unless the ring has residues */
} Term;

typedef struct {
  const Term *at; /* by ascending monomial id */
  uint32_t n;
} Poly;

typedef enum { POLY_OK, POLY_INEXACT, POLY_TOO_LARGE, POLY_DIVIDED_BY_ZERO } PolyStatus;

typedef struct {
  int32_t degree; /* k of x^k = relation; 0: none */
  Poly relation;
} PolyGen;

typedef struct {
  Arena *arena;
  PolyStatus status;
  int residues;       /* coefficients need not be exact */
  uint32_t max_terms; /* limit for one polynomial */
  uint64_t work;      /* remaining budget of term products */
  VEC(PolyGen) gens;
  VEC(Mono) monos;
  IdTable mono_table;
  VEC(Poly) polys; /* interned polynomials */
  IdTable poly_table;
  uint32_t *slot; /* accumulator: index + 1 in sum, by monomial */
  uint32_t slot_cap;
  VEC(Term) sum;
  VEC(MonoPow) scratch;
} PolyRing;

PolyRing *poly_ring(Arena *a, uint32_t max_terms, uint64_t max_work);

/* Records a failure; the first one counts. */
void poly_fail(PolyRing *r, PolyStatus why);

/* --- generators and monomials --- */
GenId poly_new_gen(PolyRing *r);
GenId poly_new_root(PolyRing *r, int32_t degree, Poly relation); /* degree >= 2 */
MonoId mono_of(PolyRing *r, const MonoPow *at, uint32_t n);      /* sorted; exponents may be 0 */
MonoId mono_mul(PolyRing *r, MonoId a, MonoId b);
MonoId mono_pow(PolyRing *r, MonoId a, int32_t n);
int32_t mono_exp(const PolyRing *r, MonoId m, GenId x);
MonoId mono_without(PolyRing *r, MonoId m, GenId x);
static inline const Mono *mono_at(const PolyRing *r, MonoId m) { return &r->monos.at[m]; }

/* --- polynomials --- */
Poly poly_zero(void);
Poly poly_num(PolyRing *r, Num c);
Poly poly_mono(PolyRing *r, Num c, MonoId m);
Poly poly_gen(PolyRing *r, GenId x);
Poly poly_add(PolyRing *r, Poly a, Poly b);
Poly poly_sub(PolyRing *r, Poly a, Poly b);
Poly poly_scale(PolyRing *r, Num c, Poly a);
Poly poly_mul_mono(PolyRing *r, Poly a, Num c, MonoId m);
Poly poly_mul(PolyRing *r, Poly a, Poly b);
Poly poly_pow(PolyRing *r, Poly a, uint32_t n);

/* The sum of c[i]*p[i] (c NULL: all 1) in one pass. */
Poly poly_sum(PolyRing *r, const Poly *p, const Num *c, uint32_t n);

int poly_equal(Poly a, Poly b);
int poly_is_one(Poly a);

/* Content: the gcd of the coefficients with the sign of the first; a must not be 0. */
Num poly_content(PolyRing *r, Poly a);

/* Common monomial: each generator's lowest exponent in the terms of a, 0 where it is absent; a must not be 0. */
MonoId poly_common_monomial(PolyRing *r, Poly a);

/* a = content * common * primitive, and the primitive part's first coefficient is positive. */
Poly poly_primitive(PolyRing *r, Poly a, Num *content, MonoId *common);

/* Exact division: returns 1 and *q with a = q*b if b divides a. Returns 0 for divisors that contain a generator with
 * a relation: factorization modulo such a relation is not unique. */
int poly_div_exact(PolyRing *r, Poly a, Poly b, Poly *q);

/* Interning: equal polynomials have equal ids. */
PolyId poly_intern(PolyRing *r, Poly a);
static inline Poly poly_at(const PolyRing *r, PolyId id) { return r->polys.at[id]; }

/* Polynomial from terms in any order; equal monomials are added. */
Poly poly_collect(PolyRing *r, const Term *terms, uint32_t n);
