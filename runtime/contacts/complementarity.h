/* The linear complementarity problem: w = q + M z, w >= 0, z >= 0, w_i z_i = 0. */
#pragma once

/* For M[n * n] symmetric and positive semidefinite, as J M^-1 J^T of contacts is. On return in[i] is 1 where z_i may be positive (w_i is 0
 * then); q[i] is z_i where in[i], else w_i; both are >= 0. M is scaled to a diagonal of ones, where it is not 0, and left as pivoted on those
 * with in[i]: a row whose diagonal element is at most lag_lcp_zero_pivot depends on them. scale[n] is scratch. Returns 1; 0 where no z makes all w >=
 * 0: *row cannot be met, or -1 where rounding makes the search cycle.
 *
 * The criss-cross method with the least-index rule, finite for such M whether or not solutions are unique: D. den Hertog, C. Roos, T. Terlaky,
 * Linear Algebra Appl. 187 (1993) 1, DOI 10.1016/0024-3795(93)90124-7. It has no start-up phase and needs no perturbation where contacts are
 * dependent; the number of its steps has no good bound, but contacts that touch at once are few. */
extern const double lag_lcp_zero_pivot;
int lag_solve_lcp(int n, double *M, double *q, double *scale, unsigned char *in, int *row);
