/* Flags with which a C compiler is safe: some compilers store wrong numbers, see probe.in. */
#ifndef LAGC_PROBE_H
#define LAGC_PROBE_H

#include "base/arena.h"

/* The flag that the compiler `cc` (with its options, as in $CC) needs besides `optimise` and TOOLCHAIN_SCALAR not to store wrong numbers: "" for
 * most. Writes and runs a program in the folder dir, and removes it; only where the compiler is for a processor with AVX-512.
 * NULL, with *error, when no flag helps. */
const char *probe_flag(Arena *a, const char *cc, const char *optimise, const char *dir, const char **error);

#endif
