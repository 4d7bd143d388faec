/* The fastest rate of neighbouring motions, by which steps of a tangent are limited: embedded methods choose them for
 * the state alone, and at rest they would grow past any neighbouring motion. */
#pragma once

/* Upper bound of the spectral radius of A[n n] = Df: |A^16|^(1/16), in which units hardly count. A is destroyed;
 * B[n n] is scratch. */
double lag_fastest_rate(int n, double *A, double *B);
