/* The methods of integration, as the runtime that simulators are linked with has them.
 *
 * The compiler knows none of the runtime's headers: it makes a program that reads its descriptors, once for each runtime,
 * as a simulator without a model is made and cached. */
#ifndef LAGC_METHODS_H
#define LAGC_METHODS_H

#include "base/vec.h"
#include "cli/toolchain.h"

typedef struct {
  const char *name, *does; /* the first line of its description */
} MethodRow;

typedef VEC(MethodRow) Methods;

/* The path of the program: called with `--method help` it prints the table. NULL, with *error, when there is no runtime or
 * no C compiler. argv0 is what lagc was called as. */
const char *methods_program(Arena *a, const char *argv0, int want_gsl, const char **error);

/* Asks it for all methods. 0, with *error. */
int methods_list(Arena *a, const char *argv0, int want_gsl, Methods *out, const char **error);

#endif
