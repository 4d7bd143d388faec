/* Start values by extrapolation: the values of a vector at equal distances in time, as their backward differences. */
#ifndef LAG_METHODS_HISTORY_H
#define LAG_METHODS_HISTORY_H

#include <stddef.h>

/* Doubles for vectors of m elements. All of them zero: nothing is known. */
size_t lag_history_size(int m);

/* x := what the vector will be next, by the degree that would have been best the last time. 0: nothing is known. */
int lag_history_guess(const double *history, int m, double *x);

/* x := what the vector was last. */
void lag_history_last(const double *history, int m, double *x);

/* As lag_method.sound. */
int lag_history_is_sound(const double *history);

/* The vector has become x. */
void lag_history_add(double *history, int m, const double *x);

#endif
