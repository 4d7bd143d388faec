/* Linear equations whose matrix may be singular, and whose rows have any units. */
#ifndef LAG_ANALYSIS_PIVOT_H
#define LAG_ANALYSIS_PIVOT_H

/* Solves A x = b, A[n * n], b[n], where size[n * n] >= |A| says how large the terms are that make A: what cancels among them, to
 * rounding, counts as 0. Unknowns that nothing determines are 0. Returns the rank; b[i] for i >= rank is then what
 * is left of combinations of equations that no unknown changes, and noise[i] by how much b[i] may be wrong. On entry noise[n] is
 * that of b. A is destroyed; column[n] is scratch.
 * Unknowns are in units that make them alike. Gaussian elimination with complete pivoting (J.H. Wilkinson, J. ACM 8 (1961) 281, DOI 10.1145/321075.321076) after
 * rows were divided by their largest size. */
int lag_pivot_solve(int n, double *A, const double *size, double *b, double *noise, double *x, double *column);

#endif
