/* Probes of the C compiler, once for each: what lagc finds out is kept in the cache under the compiler's identity. */
#pragma once

#include "base/strbuf.h"

/* No vector stores in emitted C: the stages of an integrator read results number by number, and store forwarding
 * needs loads of the size of the store; vector stores cost 5 to 7 ns of latency a stage (make bench
 * T=bench/methods). They are also what triggers the compiler fault of compiler_probe.in. */
#define TOOLCHAIN_SCALAR "-fno-tree-slp-vectorize"

typedef struct {
  const char *safe;   /* a flag that it needs to store right numbers; "" for most */
  const char *linker; /* the flag of the fastest linker that works, or "" */
  int exports;        /* its linker takes a version script, which hides what a library does not show */
} CompilerTraits;

/* Runs the compiler with the words `more` after those of cc, which may hold options; returns its exit status. */
int compiler_run(Arena *a, const char *cc, const char *const *more, char **said);

/* The file that the first word of cc names, from $PATH; NULL: there is none. */
const char *compiler_file(Arena *a, const char *cc);

/* The traits of `cc` (with its options, as in $CC) at this level of optimisation; its programs are made in the folder
 * dir, which lies in the cache. Returns 0, with *error, when it stores wrong numbers with every flag. */
int compiler_probe(Arena *a, const char *cc, const char *optimise, const char *dir, CompilerTraits *t,
                   const char **error);
