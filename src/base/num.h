/* Num: an exact rational, or a double where a rational would overflow 64 bits.
 * Always in lowest terms with den > 0; den == 0 marks the double. Pure values: no memory. */
#ifndef LAGC_NUM_H
#define LAGC_NUM_H

#include <stdint.h>

#include "base/strbuf.h"

typedef struct {
  int64_t num, den;
  double approx; /* the value when den == 0; otherwise 0 */
} Num;

Num num_int(int64_t n);
Num num_ratio(int64_t n, int64_t d); /* d != 0 */
Num num_double(double x);            /* exact where x is a small integer ratio of a power of two */

/* The exact value of a decimal literal (digits, optional fraction and exponent), given as n bytes. */
Num num_parse(const char *s, size_t n);

int num_is_exact(Num a);
int num_is_int(Num a);
int num_is_zero(Num a);
int num_is_one(Num a);
int num_sign(Num a); /* -1, 0, 1 */
int num_equal(Num a, Num b);
int num_cmp(Num a, Num b);
double num_value(Num a);

Num num_add(Num a, Num b);
Num num_sub(Num a, Num b);
Num num_mul(Num a, Num b);
Num num_div(Num a, Num b); /* b != 0 */
Num num_neg(Num a);
Num num_abs(Num a);

/* a^b. *exact is 0 when the power is irrational or too large: the result is then a double. */
Num num_pow(Num a, Num b, int *exact);

/* The greatest common divisor of two exact rationals (positive); 1 when either is a double. */
Num num_gcd(Num a, Num b);

/* "3", "-1/2", "6.674e-11": round-trips. */
void num_print(StrBuf *out, Num a);

/* The shortest decimal text that reads back as x; needs 32 bytes. */
void num_format_double(char *out, double x);

#endif
