/* Scaling and squaring: G. H. Golub, C. F. Van Loan, Matrix Computations, 4th ed. (2013), 9.3. */
#include "numeric/matrix_exponential.h"

#include <math.h>
#include <string.h>

void lag_matrix_exponential(int size, const double *G, double c, double *E, double *scratch) {
  double norm = 0, *term = scratch, *next = scratch + size * size;
  int halvings = 0;
  for (int e = 0; e < size * size; e++) norm += fabs(c * G[e]);
  for (; norm > 0.5; norm /= 2) halvings++;
  double part = ldexp(c, -halvings);
  for (int e = 0; e < size * size; e++) E[e] = term[e] = e % (size + 1) == 0;
  for (int k = 1; k <= 24 + halvings; k++) {
    const double *left = k <= 24 ? term : E, *right = k <= 24 ? G : E;
    for (int i = 0; i < size; i++)
      for (int j = 0; j < size; j++) {
        double sum = 0;
        for (int l = 0; l < size; l++) sum += left[i * size + l] * right[l * size + j];
        next[i * size + j] = k <= 24 ? sum * part / k : sum;
      }
    memcpy(k <= 24 ? term : E, next, (size_t)(size * size) * sizeof *E);
    for (int e = 0; e < size * size && k <= 24; e++) E[e] += term[e];
  }
}
