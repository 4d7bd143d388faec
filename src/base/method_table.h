/* Table of the methods of integration: their names, options and requirements, for the checks of models and the
 * emission of C. base/method_rows.def is a copy of the runtime's own table, with which
 * tests/golden/run_method_rows.sh compares it: lagc builds without liblag. */
#pragma once

#include "base/intern.h"

enum {
  METHOD_NO_STATES = 1,  /* refuses models with states */
  METHOD_VARIATION = 2,  /* needs derivatives of L, */
  METHOD_SPLITS = 4,     /* but not of a separable model */
  METHOD_JACOBIAN = 8,   /* needs the linearisation */
  METHOD_TAYLOR = 16,    /* needs Taylor coefficients, and so a smooth model */
  /* takes models of states alone, with the linearisation, though it refuses states beside coordinates */
  METHOD_FLOWS = 32,
  METHOD_CONSTRAINTS = 64, /* holds constraints */
  METHOD_KEPLER = 128      /* needs a Kepler part: mech/kepler_part.h */
};

typedef struct {
  const char *name;               /* NULL: past the last */
  double min, max;
  const char *const *choices;     /* NULL-terminated; NULL: a number from min to max, */
  double every, most;             /* of lag_option_range */
} MethodOption;

typedef struct {
  const char *name, *does; /* does: first line of the description */
  unsigned flags;
  const MethodOption *options;
} MethodInfo;

/* Method i, the default first; NULL past the last. */
const MethodInfo *method_at(size_t i);

/* The method whose name is the n bytes at `name`, or NULL. */
const MethodInfo *method_find(const char *name, size_t n);

/* Whether the name may belong to a library that lagc was built without: gsl-... */
int method_may_be_gsl(const char *name);

/* The known name nearest to an unknown one, else that of a method whose description has the word; or NULL. */
const char *method_suggest(Arena *a, const char *wrong);

/* Whether an option may not be x, of a model with constraints or without, as a run judges it; allowed := what it may
 * be. */
int method_option_refuses(const MethodOption *o, double x, int constrained, char allowed[128]);

/* The option of that name, or NULL. */
const MethodOption *method_option(const MethodInfo *m, const char *name);
