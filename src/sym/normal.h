/* Normal form: expressions as fractions of polynomials whose generators are symbols, sines and
 * cosines of base angles, exponentials, roots, and functions that are not understood further.
 *
 * Enters: any expressions of a graph; definitions are looked through, unless the limits say otherwise. Leaves: fractions over one
 * ring. Equal fractions mean equal expressions wherever all of them are defined; a zero numerator
 * is a proof. The converse holds while `canonical` is 1: then no relation between the generators
 * is missing, and a numerator that is not zero is a function that is not zero.
 *
 * How the generators are chosen:
 *   - sin u, cos u, tan u: u is a sum of rational multiples of terms; a term divided so that all its
 *     multiples in the problem are whole is a base angle, with the relation s^2 = 1 - c^2; whole
 *     multiples and sums follow from the addition theorems. Multiples of pi are exact where the
 *     values are square roots;
 *   - exp u, cosh u, b^u likewise, with one generator each that may have negative exponents; or, for forms that are evaluated, with
 *     hyperbolic functions as they are and exp of a sum as one generator: quotients of exponentials overflow where tanh does not;
 *   - u^(1/k): x with x^k = u; numbers and factors known to be positive are taken out of the root.
 *     |u| is the square root of u^2, hypot(u, v) of u^2 + v^2;
 *   - everything else is one generator for equal normal forms of the arguments. So is a number that
 *     is not an exact rational: a proof then holds whatever its value is. */
#ifndef LAGC_NORMAL_H
#define LAGC_NORMAL_H

#include "sym/expr.h"
#include "sym/frac.h"

typedef struct {
  uint32_t max_terms; /* of one polynomial */
  uint64_t max_work;  /* products of terms */
  int shallow;        /* a definition is a generator of its own: what it stands for is not looked at */
  int proof;          /* logarithms, powers and roots of squares are taken apart as far as signs allow: what is left is not for people */
  int keep_range;     /* hyperbolic functions and exp of sums are not taken apart: for forms that are evaluated */
  int residues;       /* numbers that 64 bits do not hold are coefficients, with their residues: for proofs that something is 0 */
} NormalLimits;

typedef enum { GEN_SYMBOL, GEN_SIN, GEN_COS, GEN_POWER, GEN_ROOT, GEN_OPAQUE } GenKind;

typedef struct {
  GenKind kind;
  Expr expr;     /* what it stands for */
  uint32_t atom; /* SIN, COS, POWER: index into atoms */
  ExprOp op;     /* OPAQUE */
  Frac arg;      /* OPAQUE: the first argument */
} GenInfo;

/* A base angle, or what is exponentiated: unit * part / den. */
typedef struct {
  PolyId base_num; /* b of b^u as a fraction; both 0: exp u; base_num GEN_NONE: an angle */
  DenId base_den;
  PolyId part;   /* of one term, unless keep_range is set */
  DenId den;
  Num unit;      /* the greatest common divisor of the coefficients met */
  int made;      /* whether what follows exists */
  Expr u;        /* unit * part / den, with its sign: sine and cosine nodes hold u or -u */
  GenId cos, sin; /* powers: cos only */
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
  int restart; /* a unit became finer: what was computed with the old one must be redone */
  VEC(GenInfo) gens;
  VEC(Atom) atoms;
  VEC(GenId) of_symbol; /* generator + 1, by SymId */
  ExprMap index;        /* node -> index into value */
  VEC(Frac) value;      /* [0] unused */
  ExprMap circular_index;
  VEC(Circular) circular; /* [0] unused; by argument */
  IdTable opaque_table, root_table;
  VEC(uint32_t) keys; /* opaque and root generators: op or k, then (num, den) of each argument */
  VEC(uint32_t) key_at, key_gen; /* where entry i of the tables has its key, and its generator */
} Normal;

/* A new problem; everything is in the arena, which must not be the graph's if it is freed. */
Normal *normal_new(ExprGraph *g, Arena *a, NormalLimits limits);

/* The normal forms of the roots (0 gives 0), all over the same generators. out is only valid when
 * the result is POLY_OK, and until the next call. */
PolyStatus normal_run(Normal *n, const Expr *roots, uint32_t count, Frac *out);

/* Records what a new generator of the ring stands for. */
void normal_name_gen(Normal *n, GenId x, GenInfo info);

/* A base angle u of its own, unrelated to the others; and cos and sin of k times an angle. */
uint32_t normal_new_angle(Normal *n, Expr u);
Circular normal_multiple(Normal *n, uint32_t angle, int32_t k);

/* Back to an expression, term by term, without looking for a short form. */
Expr normal_mono_expr(Normal *n, MonoId m);
Expr normal_poly_expr(Normal *n, Poly p);
Expr normal_expr(Normal *n, Frac a);

/* Runs work(scratch, data) with an arena that is freed afterwards, however work ends: running out
 * of memory in it, or in the graph's arena, is passed on to the graph's handler. */
void normal_with_scratch(ExprGraph *g, void (*work)(Arena *scratch, void *data), void *data);

#endif
