/* Values that an option of a method may have. Enters: a range and a value; leaves: whether it is in it, and what is. */
#include "numeric/option_range.h"

#include <math.h>
#include <stdio.h>

int lag_option_refuses(const lag_option_range *r, double x, int constrained, char text[128]) {
  double most = constrained && r->most > 0 ? r->most : r->max;
  double every = r->choices ? 1 : r->every;
  int n = 0;
  if (isfinite(x) && x >= r->min && x <= most && !(every > 0 && fmod(x - r->min, every) != 0.0)) return 0;
  const char *with = most < r->max ? "with constraints it is" : "it is";
  if (r->choices) {
    n = snprintf(text, 128, "%s one of", with);
    for (int i = 0; r->choices[i] && n < 128; i++)
      n += snprintf(text + n, (size_t)(128 - n), "%s %s", i ? "," : "", r->choices[i]);
  } else if (r->min == most) {
    snprintf(text, 128, "%s %g", with, most);
  } else if (most < HUGE_VAL) {
    n = snprintf(text, 128, "%s a %snumber from %g to %g", with, r->every == 1 ? "whole " : "", r->min, most);
    if (r->every > 1) snprintf(text + n, (size_t)(128 - n), " in steps of %g", r->every);
  } else {
    snprintf(text, 128, "%s a number of at least %g, and must be finite", with, r->min);
  }
  return 1;
}
