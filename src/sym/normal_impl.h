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

/* Whether generator x is known to be positive wherever the expression is defined. */
int normal_gen_positive(const Normal *n, GenId x);

#endif
