/* Values that an option of a method may have: one judgement for the compiler and for runs. */
#pragma once

#include <string.h>

typedef struct lag_option_range {
  double min, max, every, most; /* in steps of `every` from min, 0: all; most: with constraints, 0: max */
  const char *const *choices;   /* NULL-terminated; NULL: numbers */
} lag_option_range;

/* Whether the option is a step [s], which is positive where it is given. */
static inline int lag_is_step_option(const char *option) {
  return strcmp(option, "step") == 0 || strcmp(option, "max_step") == 0;
}

/* 0 where x is allowed, or 1 and text := the values that are. */
int lag_option_refuses(const lag_option_range *r, double x, int constrained, char text[128]);
