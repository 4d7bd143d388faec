/* Toolchain: compiles emitted C with the system's C compiler, and links it with the runtime into a simulator. */
#pragma once

#include "base/strbuf.h"
#include "base/vec.h"

typedef struct {
  const char *cc;        /* $CC or cc */
  const char *include;   /* folder of lag.h */
  const char *lib;       /* folder of liblag.a */
  int gsl;               /* liblag_gsl.a exists and is to be linked */
  const char *library;   /* lag; lag_long or lag_quad: the runtime in another precision */
  const char *const *flags; /* matching flags for emitted C, NULL-terminated */
  const char *needs;     /* one more library to link, or NULL */
  const char *optimise;  /* -O2 or $LAGC_OPTIMISE; -O0 where compilation takes longer than the run */
} Toolchain;

typedef struct {
  const char *name; /* file name without folder */
  const char *text;
} SourceText;

/* Finds the runtime: in $LAG_HOME, or beside the running executable (a build tree or an installation).
 * argv0: the name that lagc was called by. Returns 0, with *error, when it is not found or $LAGC_OPTIMISE is no level. */
int toolchain_find(Arena *a, const char *argv0, int want_gsl, Toolchain *t, const char **error);

/* SwitchingFunctions the toolchain to a precision: double, long or quad. Returns 0, with *error, when the runtime was not built for it. */
int toolchain_precision(Arena *a, Toolchain *t, const char *precision, const char **error);

/* Compiles and links the texts into the executable `output`, which appears only on success.
 * Returns 0 on failure, with *error (it may contain the compiler's own messages). */
int toolchain_build(Arena *a, const Toolchain *t, const SourceText *texts, size_t n, const char *output, const char **error);

/* The path of a simulator of these texts, from the cache or built; NULL, with *error. */
const char *toolchain_simulator(Arena *a, const Toolchain *t, const SourceText *texts, size_t n, const char **error);
