/* Toolchain: compiles emitted C with the system's C compiler, and links it with the runtime into a simulator. */
#ifndef LAGC_TOOLCHAIN_TOOLCHAIN_H
#define LAGC_TOOLCHAIN_TOOLCHAIN_H

#include "base/strbuf.h"
#include "base/vec.h"

/* No vector stores in emitted C: the stages of an integrator read results number by number, and store forwarding needs loads of the
 * size of the store; vector stores cost 5 to 7 ns of latency a stage (make bench T=bench/methods). They are also what triggers the
 * compiler fault of probe.in. */
#define TOOLCHAIN_SCALAR "-fno-tree-slp-vectorize"

typedef struct {
  const char *cc;        /* $CC or cc */
  const char *include;   /* folder of lag.h */
  const char *lib;       /* folder of liblag.a */
  int gsl;               /* liblag_gsl.a exists and is to be linked */
  const char *library;   /* lag; lag_long or lag_quad: the runtime in another precision */
  const char *const *flags; /* matching flags for emitted C, NULL-terminated */
  const char *needs;     /* one more library to link, or NULL */
  const char *optimise;  /* -O2; -O0 where compilation takes longer than the run */
} Toolchain;

typedef struct {
  const char *name; /* file name without folder */
  const char *text;
} SourceText;

/* Finds the runtime: in $LAG_HOME, or beside the running executable (a build tree or an installation).
 * argv0: the name that lagc was called by. Returns 0, with *error, when it is not found. */
int toolchain_find(Arena *a, const char *argv0, int want_gsl, Toolchain *t, const char **error);

/* Switches the toolchain to a precision: double, long or quad. Returns 0, with *error, when the runtime was not built for it. */
int toolchain_precision(Arena *a, Toolchain *t, const char *precision, const char **error);

/* Compiles and links the texts into the executable `output`, which appears only on success.
 * Returns 0 on failure, with *error (it may contain the compiler's own messages). */
int toolchain_build(Arena *a, const Toolchain *t, const SourceText *texts, size_t n, const char *output, const char **error);

/* Splits $CC into words; like make's, it may contain options. */
typedef VEC(char *) Words;
Words toolchain_words(Arena *a, const char *cc);

/* Runs a program; *said gets its standard output and error. Returns its exit status, or -1. */
int toolchain_run(Arena *a, char *const *argv, char **said);
/* Runs the program at `path` in the same way, with any argv[0]. */
int toolchain_run_as(Arena *a, const char *path, char *const *argv, char **said);

/* Runs the program at path; its standard output becomes the standard input of this process, its messages are dropped.
 * Returns its exit status, or -1; unless that is 0 the standard input is unchanged. */
int toolchain_to_stdin(const char *path, char *const *argv);

/* The path of a simulator of these texts, from the cache or built; NULL, with *error. */
const char *toolchain_simulator(Arena *a, const Toolchain *t, const SourceText *texts, size_t n, const char **error);

#endif
