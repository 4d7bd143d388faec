/* Shortest form of a polynomial in sines and cosines. */
#pragma once

#include "sym/normal_form.h"

typedef struct {
  Num c;
  Expr e; /* a product of circular functions */
} TrigTerm;

typedef struct {
  TrigTerm *at; /* the form is the sum of c*e */
  uint32_t n;
} TrigForm;

/* Form of p (generators of kind GEN_SIN and GEN_COS only, p not 0) with the fewest terms among
 *   - powers of sines and cosines of the base angles, with sin^2 u or cos^2 u eliminated angle by
 *     angle, after common factors sin u and cos u are taken out;
 *   - sums of sines and cosines of combined angles (products to sums), where the multiples of one
 *     combined angle may be written as powers of its sine and cosine: cos u cos v + sin u sin v is
 *     cos(u - v), and 1/2 - cos(2u - 2v)/2 is sin(u - v)^2.
 * On a tie the first wins. */
TrigForm trig_simplify(Normal *n, Poly p);
