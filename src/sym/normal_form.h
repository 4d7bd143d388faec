/* Normal form: expressions as fractions of polynomials whose generators are symbols, sines and
 * cosines of base angles, exponentials, roots, and opaque functions.
 *
 * Enters: any expressions of a graph; definitions are expanded unless limits.shallow is set. Leaves: fractions over
 * one ring. Equal fractions mean equal expressions wherever all of them are defined; a zero numerator is a proof.
 * The converse holds while `canonical` is 1: then all relations between the generators are known, and a nonzero
 * numerator is a nonzero function.
 *
 * How the generators are chosen:
 *   - sin u, cos u, tan u: u is a sum of rational multiples of terms; a term divided so that all its
 *     multiples in the problem are whole is a base angle, with the relation s^2 = 1 - c^2; whole
 *     multiples and sums follow from the addition theorems. Multiples of pi are exact where the
 *     values are square roots;
 *   - exp u, cosh u, b^u likewise, with one generator each that may have negative exponents; with keep_range set,
 *     hyperbolic
 *     functions stay opaque and exp of a sum is one generator: quotients of exponentials overflow where tanh does not;
 *   - u^(1/k): x with x^k = u; numbers and factors known to be positive are taken out of the root.
 *     |u| is the square root of u^2, hypot(u, v) of u^2 + v^2;
 *   - any other operation is opaque: one generator per operation and normal forms of its arguments. So is a number that
 *     is not an exact rational: a proof then holds for any value of the number. */
#pragma once

#include "sym/expr.h"
#include "sym/frac.h"

typedef struct {
  uint32_t max_terms; /* limit for one polynomial */
  uint64_t max_work;  /* limit on products of terms */
  int shallow;        /* definitions stay opaque: each is a generator */
  /* logarithms, powers, min and max are expanded as far as signs allow; results are not for readers */
  int proof;
  int keep_range;     /* hyperbolic functions and exp of sums are not expanded: for forms that are evaluated */
  /* numbers beyond 64 bits are coefficients with residues (base/num.h): for proofs that an expression is 0 */
  int residues;
} NormalLimits;

typedef enum { GEN_SYMBOL, GEN_SIN, GEN_COS, GEN_POWER, GEN_ROOT, GEN_OPAQUE } GenKind;

typedef struct {
  GenKind kind;
  Expr expr;     /* the generator as an expression */
  uint32_t atom; /* SIN, COS, POWER: index into atoms */
  ExprOp op;     /* OPAQUE */
  Frac arg;      /* OPAQUE: the first argument */
} GenInfo;

/* Base angle, or exponent of a power generator: unit * part / den. */
typedef struct {
  PolyId base_num; /* b of b^u as a fraction; both 0: exp u; base_num GEN_NONE: an angle */
  DenId base_den;
  PolyId part;   /* a single monomial, unless keep_range is set */
  DenId den;
  Num unit;      /* gcd of the coefficients met so far */
  int made;      /* whether u, cos and sin below exist */
  Expr u;        /* unit * part / den, with its sign: sine and cosine nodes hold u or -u */
  GenId cos, sin; /* generators; a power has its generator in cos */
} Atom;

typedef struct {
  Frac cos, sin;
} Circular;

typedef struct {
  ExprGraph *g;
  Arena *arena;
  PolyRing *ring;
  FracField *field;
  int canonical;
  int shallow, keep_range, proof;
  int restart; /* the unit of an atom became finer: the run must be repeated */
  VEC(GenInfo) gens;
  VEC(Atom) atoms;
  ExprMap of_symbol;    /* generator + 1, by node */
  ExprMap index;        /* node -> index into value */
  VEC(Frac) value;      /* [0] unused */
  ExprMap circular_index;
  VEC(Circular) circular; /* [0] unused; by argument */
  IdTable opaque_table, root_table;
  VEC(uint32_t) keys; /* keys of opaque and root generators: length, op or k, then ids of the arguments */
  VEC(uint32_t) key_at, key_gen; /* entry i of the tables: position of its key in keys, and its generator */
} Normal;

/* New normal-form problem; its memory is in the arena a, which must not be the graph's if it is freed. */
Normal *normal_new(ExprGraph *g, Arena *a, NormalLimits limits);

/* Normal forms of the roots (a root 0 gives 0), all over the same generators. out is valid only if the result is
 * POLY_OK, and until the next call. */
PolyStatus normal_run(Normal *n, const Expr *roots, uint32_t count, Frac *out);

/* Records kind and expression of a new generator of the ring. */
void normal_set_gen_info(Normal *n, GenId x, GenInfo info);

/* New base angle u, unrelated to the others (returns its atom); cos and sin of k times a base angle. */
uint32_t normal_new_angle(Normal *n, Expr u);
Circular normal_multiple(Normal *n, uint32_t angle, int32_t k);

/* Conversion back to an expression, term by term; not shortened. */
Expr normal_mono_expr(Normal *n, MonoId m);
Expr normal_poly_expr(Normal *n, Poly p);
Expr normal_expr(Normal *n, Frac a);
/* The same, with polynomials as poly_expr writes them. */
Expr normal_expr_by(Normal *n, Frac a, Expr (*poly_expr)(Normal *n, Poly p));
