/* Num: an exact rational, or a double with a bound of its error where a rational would overflow 64 bits.
 * Always in lowest terms with den > 0; den == 0 marks the double. Pure values: no memory.
 *
 * Equality stays sound for inexact numbers: such a number is never "zero" or "one". Beside the double stands the
 * residue of the true value modulo a prime, which arithmetic carries without rounding; a difference is exactly 0
 * where value and residue both are. Different numbers pass for equal with probability 1 in 4e18 (Schwartz 1980, DOI
 * 10.1145/322217.322225), and 1 + 1e-20 is not 1. In the same way an integer on which value and residue agree is
 * exact. */
#pragma once

#include <stdint.h>

#include "base/strbuf.h"

typedef struct {
  union {
    int64_t num;
    double error; /* when den == 0: bound of |true value - approx| */
  };
  int64_t den;
  double approx;    /* the value when den == 0; otherwise 0 */
  uint64_t residue; /* when den == 0: residue of the true value, drawn by hash for irrational ones. Otherwise 0 */
} Num;

Num num_int(int64_t n);
Num num_ratio(int64_t n, int64_t d); /* d != 0 */
Num num_double(double x);            /* exact where x is an integer over a small power of two */

/* The exact value of a decimal literal (digits, optional fraction and exponent), given as n bytes. */
Num num_parse(const char *s, size_t n);

int num_is_exact(Num a);
int num_is_int(Num a);
int num_is_zero(Num a); /* certainly */
int num_is_one(Num a);  /* certainly */
int num_sign(Num a);    /* -1, 0, 1; 0 for the exact 0 alone */
int num_sign_is_sure(Num a);
int num_equal(Num a, Num b); /* certainly */
int num_cmp(Num a, Num b);   /* compares values; sure where num_sign_is_sure(num_sub(a, b)) */
double num_value(Num a);
double num_error(Num a); /* bound of the error of the value, as a long double; 0 where a is exact */
int num_is_imprecise(Num a);  /* fewer than six digits of the value are known */
Num num_drop_error(Num a);  /* drops error bound and residue: equal where the values are */

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

/* Reads a finite decimal number; 0: the text is none, as inf, nan and 0x1p3, which strtod reads. */
int num_parse_double(const char *text, double *x);

/* decimal_literal.c: x*pi^pi_power as a decimal literal, exact where it has at most 40 digits, else cut after 40.
 * NULL where x is no exact rational, its denominator is above 10^18, or pi_power is not -1, 0 or 1. */
const char *decimal_literal(Arena *a, Num x, int pi_power);
