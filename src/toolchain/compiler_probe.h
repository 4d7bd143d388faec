/* Probe for a fault of some C compilers, which store wrong numbers (probe.in), and the flag that avoids it. */
#ifndef LAGC_TOOLCHAIN_COMPILER_PROBE_H
#define LAGC_TOOLCHAIN_COMPILER_PROBE_H

#include "base/arena.h"

/* No vector stores in emitted C: the stages of an integrator read results number by number, and store forwarding needs loads of the
 * size of the store; vector stores cost 5 to 7 ns of latency a stage (make bench T=bench/methods). They are also what triggers the
 * compiler fault of probe.in. */
#define TOOLCHAIN_SCALAR "-fno-tree-slp-vectorize"

/* The flag that the compiler `cc` (with its options, as in $CC) needs besides `optimise` and TOOLCHAIN_SCALAR: "" for most. Compilers for processors
 * with AVX-512 are probed by a program that is written, run and removed in the folder dir. NULL, with *error, when no flag helps. */
const char *probe_flag(Arena *a, const char *cc, const char *optimise, const char *dir, const char **error);

#endif
