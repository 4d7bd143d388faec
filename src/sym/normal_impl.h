/* The inside of the normal form, shared by normal.c, angles.c and roots.c only. */
#ifndef LAGC_NORMAL_IMPL_H
#define LAGC_NORMAL_IMPL_H

#include "sym/normal.h"

/* The generator with this key, or GEN_NONE; and remembering one. len words. */
GenId normal_find_key(const Normal *n, const IdTable *t, const uint32_t *key, uint32_t len);
void normal_add_key(Normal *n, IdTable *t, const uint32_t *key, uint32_t len, GenId x);

/* angles.c: sin and cos of u, exp(u), b^u. arg is the argument's node. */
Circular normal_circular(Normal *n, Expr arg, Frac u);
Frac normal_exp(Normal *n, Frac u);
Frac normal_power(Normal *n, Frac base, Frac u);

/* roots.c: a^e for exact rational e. */
Frac normal_pow_num(Normal *n, Frac a, Num e);

/* sqrt(a^2 + b^2), written as e where the squares might overflow; with b 0, |a|. */
Frac normal_hypot(Normal *n, Frac a, Frac b, Expr e);

/* logs.c: a product of powers, base^exponent or e^exponent, that base^exponent is: numbers, known signs and squares are taken apart. For proofs:
 * expressions would grow. The logarithm of u that way. */
typedef struct {
  Frac base, exponent;
  int is_e;
} PowerPart;
typedef VEC(PowerPart) PowerParts;
PowerParts normal_power_parts(Normal *n, Frac base, Frac exponent);
Frac normal_log(Normal *n, Frac u);

/* normal.c: log(u) as a generator. */
Frac normal_opaque_log(Normal *n, Frac u);

/* roots.c: all terms positive, by their coefficients, even powers and positive generators. */
int normal_poly_positive(const Normal *n, Poly p);

/* For proofs: q that is plainly positive, with q^2 = p; 0 where none is found. */
int normal_positive_root(Normal *n, Poly p, Poly *q);

/* Whether generator x is known to be positive wherever the expression is defined. */
int normal_gen_positive(const Normal *n, GenId x);

#endif
