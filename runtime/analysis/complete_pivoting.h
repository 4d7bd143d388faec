/* Linear equations with a singular matrix, in rows of any units. */
#ifndef LAG_ANALYSIS_COMPLETE_PIVOTING_H
#define LAG_ANALYSIS_COMPLETE_PIVOTING_H

/* Solves A x = b, A[n * n], b[n], by Gaussian elimination with complete pivoting (J.H. Wilkinson, J. ACM 8 (1961) 281, DOI
 * 10.1145/321075.321076) after rows were divided by their largest size. size[n * n] >= |A|: size of the terms that make A; pivots that cancel
 * among them, to rounding, count as 0. Returns the rank; undetermined unknowns are 0; b[i] for i >= rank is then the residual of combinations of
 * equations that no unknown changes. noise[n]: error of b, on entry and on return. A is destroyed; column[n] is scratch. The caller scales the
 * unknowns. */
int lag_complete_pivot_solve(int n, double *A, const double *size, double *b, double *noise, double *x, double *column);

#endif
