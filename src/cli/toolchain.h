/* Emitted C -> a simulator, with the system's C compiler. */
#ifndef LAGC_TOOLCHAIN_H
#define LAGC_TOOLCHAIN_H

#include "base/strbuf.h"
#include "base/vec.h"

/* Emitted C stores what it computes number by number. The stages of an integrator wait for these numbers, and a processor hands on at
 * once only what is read as it was stored; side by side they take 5 to 7 ns longer to come (make bench T=bench/methods has what that is
 * of a step). The compiler fault of probe.in needs such stores, too. */
#define TOOLCHAIN_SCALAR "-fno-tree-slp-vectorize"

typedef struct {
  const char *cc;        /* $CC or cc */
  const char *include;   /* folder of lag.h */
  const char *lib;       /* folder of liblag.a */
  int gsl;               /* liblag_gsl.a is there and wanted */
  const char *library;   /* lag, or lag_long, lag_quad: the runtime for other numbers than doubles, */
  const char *const *flags; /* and what emitted C is compiled with to agree with it; NULL at the end */
  const char *needs;     /* one more library, or NULL */
  const char *optimise;  /* -O2; -O0 where the model is called a few times, and compiling it is what takes time */
} Toolchain;

typedef struct {
  const char *name; /* file name without folder */
  const char *text;
} SourceText;

/* Finds the runtime: $LAG_HOME, or beside the running executable (a build tree or an installation).
 * argv0 is what lagc was called as. 0, with *error, when it is not found. */
int toolchain_find(Arena *a, const char *argv0, int want_gsl, Toolchain *t, const char **error);

/* Makes it one for numbers of `precision`: double, long or quad. 0, with *error, when the runtime was not built for it. */
int toolchain_precision(Arena *a, Toolchain *t, const char *precision, const char **error);

/* Compiles and links the texts into the executable `output`, which appears only when all went
 * well. 0, with *error (it may contain the compiler's own messages), on failure. */
int toolchain_build(Arena *a, const Toolchain *t, const SourceText *texts, size_t n, const char *output, const char **error);

/* CC as words: it may hold options, as make has it. */
typedef VEC(char *) Words;
Words toolchain_words(Arena *a, const char *cc);

/* Runs a program; its output and messages go to *said. Returns its exit status, or -1. */
int toolchain_run(Arena *a, char *const *argv, char **said);
/* The same of the program at `path`, whatever its argv[0] is. */
int toolchain_run_as(Arena *a, const char *path, char *const *argv, char **said);

/* Runs the program at path: what it prints becomes the standard input of this one, from its beginning; its messages are
 * dropped. Its exit status, or -1; then the standard input is as it was. */
int toolchain_to_stdin(const char *path, char *const *argv);

/* A simulator of these texts, from the cache or built; NULL, with *error. */
const char *toolchain_simulator(Arena *a, const Toolchain *t, const SourceText *texts, size_t n, const char **error);

#endif
