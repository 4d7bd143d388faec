/* Toolchain: compiles emitted C with the system's C compiler, and links it with the runtime into a simulator. */
#pragma once

#include <stdio.h>

#include "base/strbuf.h"
#include "base/vec.h"

typedef struct {
  const char *cc;        /* $CC or cc */
  const char *include;   /* folder of lag.h */
  const char *lib;       /* folder of liblag.a */
  int gsl;               /* liblag_gsl.a exists and is to be linked */
  const char *parts[3];  /* what links liblag_png.a, liblag_hdf5.a, liblag_mpi.a; NULL: they are not to be linked */
  const char *library;   /* lag; lag_long or lag_quad: the runtime in another precision */
  const char *const *flags; /* matching flags for emitted C, NULL-terminated */
  long threads;          /* that share the sums of emitted C, by OpenMP; 0: it has none */
  int lanes;             /* models are also compiled for lanes of vectors */
  const char *needs;     /* one more library to link, or NULL */
  /* of the shared library that is made instead of a program, with the runtime where `library` names it; NULL: a
   * program */
  const char *soname;
  int models;            /* that shared library is a program for lag-run, which has the runtime */
  const char *optimise;  /* -O2 or $LAGC_OPTIMISE; -O0 where compilation takes longer than the run */
} Toolchain;

typedef struct {
  const char *name; /* file name without folder */
  const char *text;
} SourceText;

/* The folder of the running executable. */
const char *toolchain_own_folder(Arena *a, const char *argv0);

/* Finds the runtime: in $LAG_HOME, or beside the running executable (a build tree or an installation). argv0: the
 * name that lagc was called by. Returns 0, with *error, when it is not found or $LAGC_OPTIMISE is no level. */
int toolchain_find(Arena *a, const char *argv0, int want_gsl, Toolchain *t, const char **error);

/* The words that link a part of the runtime, liblag_PART.a; NULL: it is not there. */
const char *toolchain_part(Arena *a, const Toolchain *t, const char *part);

/* The flags for models over another scalar, long or quad, in programs that call nothing of the runtime. */
void toolchain_scalar(Toolchain *t, const char *precision);

/* Sets the toolchain to a precision: double, long or quad. Returns 0, with *error, when the runtime was not built
 * for it. */
int toolchain_precision(Arena *a, Toolchain *t, const char *precision, const char **error);

/* The C compiler alone, without the runtime. Returns 0, with *error, when $LAGC_OPTIMISE is no level. */
int toolchain_compiler(Arena *a, Toolchain *t, const char **error);

/* Whether this machine computes in lanes: it has AVX2 and FMA, or is an AArch64. */
int toolchain_has_lanes(void);

/* The machine that the compiler compiles for, as it names it: x86_64-linux-gnu; "" where it does not say. */
const char *toolchain_machine(Arena *a, const Toolchain *t);

/* Compiles the last text, which may include the others, to a shared library called t->soname without the runtime,
 * and appends its bytes. Returns 0, with *error. */
int toolchain_library(Arena *a, const Toolchain *t, const SourceText *texts, size_t n, StrBuf *out, const char **error);

/* Compiles and links the texts into the executable or library `output`, which appears only on success.
 * Returns 0 on failure, with *error (it may contain the compiler's own messages). */
int toolchain_build(Arena *a, const Toolchain *t, const SourceText *texts, size_t n, const char *output,
                    const char **error);

/* Path, size and time of lagc itself and of the parts of the runtime. */
const char *toolchain_own_build(Arena *a, const Toolchain *t, const char *argv0);

/* The name of a cache entry: a 128-bit hash of texts, compiler and libraries. */
const char *toolchain_entry(Arena *a, const Toolchain *t, const SourceText *texts, size_t n);

/* The path of a simulator of these texts, from the cache or built; NULL, with *error. */
const char *toolchain_simulator(Arena *a, const Toolchain *t, const SourceText *texts, size_t n, const char **error);

/* lag-run, the simulator that evaluates models; NULL: it is not there. */
const char *toolchain_evaluator(Arena *a, const Toolchain *t);
/* Whether the C compiler is a program of $PATH, or of its own. */
int toolchain_has_compiler(Arena *a, const Toolchain *t);

/* One run of a program, from `in` to `out`. */
typedef struct {
  FILE *in, *out;
  int status;        /* its exit status, or -1 */
  const char *error; /* why it was not built */
} OneRun;

/* Builds a program of the texts in a folder of its own, which is then removed, and runs it. Returns
 * 0, with run->error, when it is not built. */
int toolchain_run_once(Arena *a, const Toolchain *t, const SourceText *texts, size_t n, OneRun *run);
