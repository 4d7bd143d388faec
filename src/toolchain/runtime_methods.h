/* The methods of integration of the runtime that simulators are linked with.
 *
 * The compiler includes no header of the runtime: it builds, and caches like a simulator, a program that prints the
 * descriptors, once for each runtime. */
#ifndef LAGC_TOOLCHAIN_RUNTIME_METHODS_H
#define LAGC_TOOLCHAIN_RUNTIME_METHODS_H

#include "base/vec.h"
#include "toolchain/toolchain.h"

typedef struct {
  const char *name, *does; /* does: first line of the description */
} MethodRow;

typedef VEC(MethodRow) Methods;

/* The path of that program; with `--method help` it prints the table. NULL, with *error, when there is no runtime or no C
 * compiler. argv0: the name that lagc was called by. */
const char *methods_program(Arena *a, const char *argv0, int want_gsl, const char **error);

/* Runs the program and lists all methods. Returns 0, with *error, on failure. */
int methods_list(Arena *a, const char *argv0, int want_gsl, Methods *out, const char **error);

#endif
