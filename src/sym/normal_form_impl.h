/* Internals of the normal form, for the .c files that build it. */
#pragma once

#include "sym/normal_form.h"

/* Look-up of the generator with a key of len words (GEN_NONE: absent), and its entry into the table. */
GenId normal_find_key(const Normal *n, const IdTable *t, const uint32_t *key, uint32_t len);
void normal_add_key(Normal *n, IdTable *t, const uint32_t *key, uint32_t len, GenId x);

/* addition_theorems.c: sin and cos of u (arg: the node of u), exp(u), base^u. */
Circular normal_circular(Normal *n, Expr arg, Frac u);
Frac normal_exp(Normal *n, Frac u);
Frac normal_power(Normal *n, Frac base, Frac u);

/* radicals.c: a^e for exact rational e. */
Frac normal_pow_num(Normal *n, Frac a, Num e);

/* sqrt(a^2 + b^2), or |a| for b = 0; printed as e where squaring might overflow. */
Frac normal_hypot(Normal *n, Frac a, Frac b, Expr e);

/* expand_logs.c, for proofs: base^exponent as a product of powers b^u or e^u, split at numbers, factors of known
 * sign and squares; log(u) as the sum over the powers of u. */
typedef struct {
  Frac base, exponent;
  int is_e;
} PowerPart;
typedef VEC(PowerPart) PowerParts;
PowerParts normal_power_parts(Normal *n, Frac base, Frac exponent);
Frac normal_log(Normal *n, Frac u);

/* normal_form.c: log(u) as a generator. */
Frac normal_opaque_log(Normal *n, Frac u);

/* radicals.c: whether all terms of p are positive by coefficients, even powers and positive generators. */
int normal_poly_positive(const Normal *n, Poly p);

/* Whether generator x is known to be positive wherever the expression is defined. */
int normal_gen_positive(const Normal *n, GenId x);
