/* Spectral radius from the size of a power (fastest_rate.h). */
#include "analysis/fastest_rate.h"
#include "numeric/dense.h"

#include <math.h>
#include <string.h>

double lag_fastest_rate(int n, double *A, double *B) {
  double rate = 1, root = 1;
  for (int turn = 0; turn < 5; turn++, root /= 2) {
    double size = lag_dot(n * n, A, A);
    size = sqrt(size);
    rate *= pow(size, root);
    if (!(size > 0)) return 0;
    memset(B, 0, (size_t)(n * n) * sizeof *B);
    for (int i = 0; i < n * n; i++) A[i] /= size;
    for (int i = 0; i < n && turn < 4; i++)
      for (int k = 0; k < n; k++) {
        double a = A[i * n + k];
        for (int j = 0; j < n && a != 0.0; j++) B[i * n + j] += a * A[k * n + j];
      }
    memcpy(A, B, (size_t)(n * n) * sizeof *A);
  }
  return rate;
}
