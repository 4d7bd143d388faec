/* Sample points of a model: states and parameters at which a function is compared with the equations of motion, the
 * same on every machine. */
#pragma once

#include "mech/eqns.h"

typedef struct SamplePoints SamplePoints;
SamplePoints *sample_points_new(const Eqns *e);

/* Components of y = (q, q', z), and parameters that are not compiled in, in order of declaration. */
typedef struct {
  const SymId *at;
  uint32_t n;
} SymList;
SymList sample_state_symbols(const SamplePoints *s);
SymList sample_parameters(const SamplePoints *s);

/* Point k = 0: the scene's start. START_LIKE points follow with the scene's parameters, RANDOM ones of magnitude 0.3
 * .. 2, WIDE ones with larger angles; parameters that the command line gives (Param.given) keep its values. No time
 * is before the scene's start. Values are doubles; parameters given by others follow them, and the state obeys the
 * constraints. symbols: by symbol; also gets inputs, and 0 for contacts, which are open. 0: no point inside the
 * model's domain was found. */
enum {
  POINTS_START_LIKE = 6,
  POINTS_RANDOM = 60,
  POINTS_WIDE = 8,
  POINTS = 1 + POINTS_START_LIKE + POINTS_RANDOM + POINTS_WIDE
};
int sample_point(SamplePoints *s, uint32_t k, long double *symbols);
static inline int sample_is_random(uint32_t k) {
  return k > POINTS_START_LIKE && k <= POINTS_START_LIKE + POINTS_RANDOM;
}

/* Puts the scene's value of parameter i of sample_parameters in. */
void sample_default(SamplePoints *s, uint32_t i, long double *symbols);
/* Values of inputs, and of parameters that are given by others, at the symbols' present values. */
void sample_follow(SamplePoints *s, long double *symbols);

/* "th1 = 1, m1 = 2, t = 0.5", in SI units. */
const char *sample_text(const SamplePoints *s, const long double *symbols);
