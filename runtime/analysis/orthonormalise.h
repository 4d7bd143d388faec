/* Orthonormalisation of a tangent, step by step: its growth is kept as logarithms, so that it neither overflows nor
 * becomes one direction. */
#pragma once

/* Y[n * k] := Q of Y = Q R by modified Gram-Schmidt; enough, as vectors are still nearly orthogonal after one step.
 * Adds the logarithms of the diagonal of R to sum[k] if `counts`; with k = n their sum is that of |det|. joins: a
 * slide began, where neighbouring motions become one; a vector that is rounding then stays 0, with the sum
 * -HUGE_VAL. LAG_EDOMAIN: a vector has vanished or overflowed. */
int lag_orthonormalise(int n, int k, double *Y, double *sum, int counts, int joins);
