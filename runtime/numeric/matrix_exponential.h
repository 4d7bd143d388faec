/* Exponential of a matrix. */
#pragma once

/* E[size * size] := exp(c G), by scaling and squaring of its series. scratch[2 * size * size]. */
void lag_matrix_exponential(int size, const double *G, double c, double *E, double *scratch);
