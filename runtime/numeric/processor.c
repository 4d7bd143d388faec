/* Vectors that the processor has and the system saves (processor.h), asked once. */
#include "numeric/processor.h"

#if defined(__GNUC__) && defined(__x86_64__)
typedef struct {
  unsigned a, b, c, d;
} Registers;

static Registers cpuid(unsigned leaf) {
  Registers r;
  __asm__("cpuid" : "=a"(r.a), "=b"(r.b), "=c"(r.c), "=d"(r.d) : "a"(leaf), "c"(0));
  return r;
}

/* By cpuid, not __builtin_cpu_supports: that is a symbol of libgcc, which other compilers do not link. Intel, Software
 * Developer's Manual 1, 14.3 and 15.2: the processor has the instructions, the system saves the registers. */
static int ask(void) {
  enum { OSXSAVE = 1 << 27, FMA = 1 << 12, AVX2 = 1 << 5, AVX512F = 1 << 16, AVX512DQ = 1 << 17, YMM = 6, ZMM = 0xe6 };
  unsigned saved, high;
  if (cpuid(0).a < 7 || !(cpuid(1).c & OSXSAVE)) return 1;
  const Registers more = cpuid(7);
  __asm__ volatile("xgetbv" : "=a"(saved), "=d"(high) : "c"(0));
  if ((saved & YMM) != YMM || !(cpuid(1).c & FMA) || !(more.b & AVX2)) return 1;
  return (saved & ZMM) == ZMM && more.b & AVX512F && more.b & AVX512DQ ? 8 : 4;
}

/* A fact of the machine: whichever thread asks first writes what all others would; cpuid takes microseconds in a
 * virtual machine. */
int lag_processor_lanes(void) {
  static _Atomic int lanes;
  int known = lanes;
  if (!known) lanes = known = ask();
  return known;
}
#else
int lag_processor_lanes(void) { return 4; }
#endif
