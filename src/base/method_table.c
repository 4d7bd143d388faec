/* Look-ups in the table of methods. */
#include "base/method_table.h"

#include <math.h>
#include <string.h>

#include "base/words.h"
#include "base/vec.h"
#include "kernels/steppers.def"
#include "numeric/edit_distance.h"
#include "numeric/option_range.h"

#define STEP {"step", 0, HUGE_VAL, NULL, 0, 0}
#define NO_MORE {NULL, 0, 0, NULL, 0, 0}
#define FIXED_OPTIONS (const MethodOption[]){STEP, NO_MORE}
#define ADAPTIVE_OPTIONS                                                                          \
  (const MethodOption[]){STEP, {"max_step", 0, HUGE_VAL, NULL, 0, 0}, {"atol", 0, HUGE_VAL, NULL, 0, 0}, \
                         {"adapt", 0, 1, (const char *const[]){"on", "off", NULL}, 0, 0}, NO_MORE}
#define LATE_OPTIONS ADAPTIVE_OPTIONS
#define RUNGE_KUTTA_ROW(name, NAME, kind, dense, order, line, words) {#name, line, METHOD_CONSTRAINTS, kind##_OPTIONS},

static const MethodInfo methods[] = {
LAG_RUNGE_KUTTA_METHODS(RUNGE_KUTTA_ROW)
#include "base/method_rows.def"
};

enum { METHODS = sizeof methods / sizeof *methods };

const MethodInfo *method_at(size_t i) { return i < METHODS ? &methods[i] : NULL; }

const MethodInfo *method_find(const char *name, size_t n) {
  for (size_t i = 0; i < METHODS; i++)
    if (strlen(methods[i].name) == n && strncmp(methods[i].name, name, n) == 0) return &methods[i];
  return NULL;
}

int method_may_be_gsl(const char *name) {
  static const char gsl[] = "gsl-";
  for (size_t i = 0; i < METHODS; i++)
    if (strncmp(methods[i].name, gsl, strlen(gsl)) == 0) return 0;
  return strncmp(name, gsl, strlen(gsl)) == 0;
}

const char *method_suggest(Arena *a, const char *wrong) {
  VEC(Name) names = {0};
  for (size_t i = 0; i < METHODS; i++) vec_push(a, &names, methods[i].name);
  Name near = suggest(wrong, names.at, names.n);
  for (size_t i = 0; i < METHODS && !near; i++)
    if (lag_text_has_word(methods[i].does, wrong)) near = methods[i].name;
  return near;
}

int method_option_refuses(const MethodOption *o, double x, int constrained, char allowed[128]) {
  if (lag_is_step_option(o->name) && !(x > 0)) {
    strcpy(allowed, "a step is a positive number of seconds; without one the method takes its own");
    return 1;
  }
  lag_option_range range = {o->min, o->max, o->every, o->most, o->choices};
  return lag_option_refuses(&range, x, constrained, allowed);
}

const MethodOption *method_option(const MethodInfo *m, const char *name) {
  for (const MethodOption *o = m->options; o->name; o++)
    if (strcmp(o->name, name) == 0) return o;
  return NULL;
}
