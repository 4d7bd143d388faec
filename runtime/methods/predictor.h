/* Predictor: extrapolates a vector from its values at equally spaced times, stored as backward differences. */
#pragma once

#include <stddef.h>

/* Doubles of the history of a vector of m elements. All zeros: an empty history. */
size_t lag_predictor_size(int m);

/* x := the extrapolated next value, by the degree that would have been best last time. 0: the history is empty. */
int lag_predictor_guess(const double *history, int m, double *x);

/* x := the last value. */
void lag_predictor_last(const double *history, int m, double *x);

/* Appends the value x. */
void lag_predictor_add(double *history, int m, const double *x);
