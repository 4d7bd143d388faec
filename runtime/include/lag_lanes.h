/* lag_lanes.h: arithmetic over LAG_REAL: selection, logic, checks of pivots, functions of the C library, bits of a
 * double. LAG_REAL is double, or, with LAG_LANES defined as 2, 4 or 8, the type of a vector with so many lanes (GCC and
 * Clang; arrays of it are aligned to its size: aligned_alloc; -Wno-psabi silences GCC on how it passes them). Another
 * scalar: -DLAG_REAL='long double' '-DLAG_FN(x)=x##l' '-DLAG_C(x)=x##L'. Includes only <math.h>.
 *
 * `lagc header` and `lagc emit --standalone` copy sections of this file, lag_math.h, lag_support.h and lag_kkt.h into
 * what they write, from a line `---- NAME ----` to the next, a header with its prefix for LAG_ and lag_. */
#ifndef LAG_LANES_H
#define LAG_LANES_H

#include <math.h>

#ifndef LAG_REAL
#ifdef LAG_LANES
typedef double lag_lanes __attribute__((vector_size(8 * LAG_LANES)));
#define LAG_REAL lag_lanes
#else
#define LAG_REAL double
#define LAG_REAL_IS_DOUBLE 1
#endif
#endif

/* ---- lanes: front ---- */
#ifdef LAG_LANES
/* Selection, logic and functions of vectors of doubles. */
#if !defined(__GNUC__) || (LAG_LANES != 2 && LAG_LANES != 4 && LAG_LANES != 8)
#error "LAG_LANES must be 2, 4 or 8, and the compiler GCC or Clang"
#endif
#define LAG_INLINE static __inline__ __attribute__((always_inline, unused))
typedef long long lag_lanes_mask __attribute__((vector_size(8 * LAG_LANES)));
typedef unsigned long long lag_lanes_word __attribute__((vector_size(8 * LAG_LANES)));

LAG_INLINE LAG_REAL lag_lanes_all(double x);
LAG_INLINE LAG_REAL lag_lanes_select(lag_lanes_mask c, LAG_REAL a, LAG_REAL b);
LAG_INLINE int lag_lanes_bits(lag_lanes_mask c);
LAG_INLINE int lag_lanes_any(lag_lanes_mask c);
LAG_INLINE int lag_lanes_reach(lag_lanes_word w, int bit);
LAG_INLINE LAG_REAL lag_lanes_fabs(LAG_REAL x);
LAG_INLINE LAG_REAL lag_lanes_sqrt(LAG_REAL x);
/* Functions without a vector form: one lane after the other. */
#define LAG_LANES_EACH(one, two) \
  one(tan) one(asin) one(acos) one(atan) one(sinh) one(cosh) one(tanh) one(cbrt) one(floor) \
  two(pow) two(atan2) two(hypot)
#define LAG_DECLARE_1(f) LAG_INLINE LAG_REAL lag_lanes_##f(LAG_REAL x);
#define LAG_DECLARE_2(f) LAG_INLINE LAG_REAL lag_lanes_##f(LAG_REAL x, LAG_REAL y);
LAG_LANES_EACH(LAG_DECLARE_1, LAG_DECLARE_2)

#define LAG_MASK lag_lanes_mask
#define LAG_LANE double
#define LAG_FN(f) lag_lanes_##f
#define LAG_C(x) lag_lanes_all(x)
#define LAG_SELECT(c, a, b) lag_lanes_select(c, a, b)
#define LAG_NOT(c) (~(c))
#define LAG_AND(a, b) ((a) & (b))
#define LAG_OR(a, b) ((a) | (b))
#define LAG_ANY(c) lag_lanes_any(c)
/* Checks of pivots. A lane with a singular matrix does not stop the others: its results are not finite, and its bit
 * is set in the negative of the status; so for a lane whose matrix is not finite. */
#if defined(__AVX512DQ__) && LAG_LANES == 8 && !defined(__clang__)
#define LAG_PIVOTS int singular __attribute__((unused)) = 0
#define LAG_PIVOT(c) singular |= lag_lanes_bits(~(c))
#define LAG_POSITIVE(d)                                                                                      \
  singular |= (unsigned char)__builtin_ia32_cmppd512_mask(d, LAG_C(0.0), 26 /* not greater, or unordered */, \
                                                          (unsigned char)-1, 4)
#define LAG_PIVOTS_STATUS -singular
#else
#define LAG_PIVOTS LAG_MASK singular __attribute__((unused)) = {0}
#define LAG_PIVOT(c) singular |= ~(c)
#define LAG_POSITIVE(d) LAG_PIVOT((d) > LAG_C(0.0))
#define LAG_PIVOTS_STATUS -lag_lanes_bits(singular)
#endif
#endif

/* ---- scalar ---- */
#ifndef LAG_NUMBER
#define LAG_NUMBER(x) x /* of tables */
#endif
#ifndef LAG_FN
#define LAG_FN(f) f
#endif
#ifndef LAG_C
#define LAG_C(x) ((LAG_REAL)x)
#endif

/* ---- logic ---- */
#ifndef LAG_SELECT
#define LAG_SELECT(c, a, b) ((c) ? (LAG_REAL)(a) : (LAG_REAL)(b))
#endif
#ifndef LAG_NOT
#define LAG_NOT(c) (!(c))
#define LAG_AND(a, b) ((a) && (b))
#define LAG_OR(a, b) ((a) || (b))
#define LAG_ANY(c) (c)
#define LAG_MASK int
#define LAG_PIVOTS (void)0
#define LAG_PIVOT(c) do { if (!(c)) return LAG_ESINGULAR; } while (0)
#define LAG_PIVOTS_STATUS LAG_OK
#endif
#ifndef LAG_LANE
#define LAG_LANE LAG_REAL
#endif
#if defined(__GNUC__)
#define LAG_UNUSED __attribute__((unused)) /* a function that not every file calls */
#else
#define LAG_UNUSED
#endif

/* ---- positive ---- */
/* Test of a positive pivot in a simulator, which finds and names the expression without a value. */
#ifndef LAG_POSITIVE
#define LAG_POSITIVE(d) LAG_PIVOT(!((d) <= LAG_C(0.0))) /* NaN passes: the caller finds its cause */
#endif

/* ---- own: front ---- */
/* LAG_OWN: 1 where the functions below are used; for scalars other than double, and with LAG_LIBM or LAG_COMPLEX
 * defined, those of the library are. */
#define LAG_JOIN2(a, b) a##b
#define LAG_JOIN(a, b) LAG_JOIN2(a, b)
#define LAG_IS_float 0
#define LAG_IS_double 1
#define LAG_IS_long 0 && /* double */
#if defined(LAG_LIBM) || defined(LAG_COMPLEX)
#define LAG_OWN 0
#elif defined(LAG_LANES) || LAG_JOIN(LAG_IS_, LAG_REAL)
#define LAG_OWN 1
#else
#define LAG_OWN 0
#endif

#if LAG_OWN
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wlong-long" /* C++98 has none */
#endif
typedef long long lag_signed;
typedef unsigned long long lag_bits;
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif
#if !defined(LAG_LANES) && defined(__GNUC__)
#define LAG_INLINE static __inline__ __attribute__((always_inline, unused))
#elif !defined(LAG_LANES)
#define LAG_INLINE static inline
#endif
#if (defined(__FMA__) || defined(FP_FAST_FMA) || defined(__ARM_FEATURE_FMA)) && !defined(LAG_NO_FMA)
#define LAG_FMA 1
#else
#define LAG_FMA 0
#endif
LAG_INLINE LAG_REAL lag_mad(LAG_REAL a, LAG_REAL b, LAG_REAL c);
#endif

/* ---- libm: front ---- */
#if defined(LAG_LANES) && !LAG_OWN
LAG_DECLARE_1(sin) LAG_DECLARE_1(cos) LAG_DECLARE_1(exp) LAG_DECLARE_1(log)
#endif

/* ---- turns: front ---- */
/* LAG_TURNS turns of a loop side by side, where the compiler has vectors of doubles: elements that lie `step` apart,
 * sums in the order of turns. Whatever their number, the bits are those of one turn after the other. */
#if defined(__GNUC__) && defined(LAG_REAL_IS_DOUBLE) && \
    (defined(__x86_64__) || defined(__aarch64__) || defined(__wasm_simd128__))
#ifdef __AVX__
#define LAG_TURNS 4
#define LAG_TURNS_EACH(f) f(0) f(1) f(2) f(3)
#define LAG_TURNS_APART(x, step) {(x)[0], (x)[step], (x)[2*(step)], (x)[3*(step)]}
#else
#define LAG_TURNS 2
#define LAG_TURNS_EACH(f) f(0) f(1)
#define LAG_TURNS_APART(x, step) {(x)[0], (x)[step]}
#endif
#define LAG_REST(from, end) ((end) - ((end) - (from)) % LAG_TURNS) /* first turn that they leave */
#define LAG_TURNS_INLINE static __inline__ __attribute__((always_inline, unused))
typedef double lag_turns __attribute__((vector_size(8 * LAG_TURNS)));
typedef double lag_turns_near __attribute__((vector_size(8 * LAG_TURNS), aligned(8), may_alias));

LAG_TURNS_INLINE lag_turns lag_turns_at(const double *x, int step) {
  const lag_turns apart = LAG_TURNS_APART(x, step);
  if (step == 1) return *(const lag_turns_near *)x;
  return apart;
}

LAG_TURNS_INLINE lag_turns lag_turns_sqrt(lag_turns x) {
#ifdef __AVX__
  return __builtin_ia32_sqrtpd256(x);
#elif defined(__x86_64__)
  return __builtin_ia32_sqrtpd(x);
#else
  const lag_turns root = {sqrt(x[0]), sqrt(x[1])};
  return root;
#endif
}

/* lag_turns_plus(sum, x): the sum and its terms; lag_turns_each_plus(sum, step, x): sums that lie `step` apart, each
 * and its term. The same with less. */
#define LAG_TURNS_ADD(k) sum += x[k];
#define LAG_TURNS_SUBTRACT(k) sum -= x[k];
#define LAG_TURNS_ADD_EACH(k) sum[(k)*step] += x[k];
#define LAG_TURNS_SUBTRACT_EACH(k) sum[(k)*step] -= x[k];
LAG_TURNS_INLINE double lag_turns_plus(double sum, lag_turns x) {
  LAG_TURNS_EACH(LAG_TURNS_ADD)
  return sum;
}
LAG_TURNS_INLINE double lag_turns_less(double sum, lag_turns x) {
  LAG_TURNS_EACH(LAG_TURNS_SUBTRACT)
  return sum;
}
LAG_TURNS_INLINE void lag_turns_each_plus(double *sum, int step, lag_turns x) {
  if (step == 1) *(lag_turns_near *)sum += x;
  else { LAG_TURNS_EACH(LAG_TURNS_ADD_EACH) }
}
LAG_TURNS_INLINE void lag_turns_each_less(double *sum, int step, lag_turns x) {
  if (step == 1) *(lag_turns_near *)sum -= x;
  else { LAG_TURNS_EACH(LAG_TURNS_SUBTRACT_EACH) }
}
#else
#define LAG_REST(from, end) (from)
#endif

/* to[n] := 1/(x sqrt(x)). */
static LAG_UNUSED void lag_inverse_cubes(int n, const LAG_REAL *x, LAG_REAL *to) {
  int k = 0;
#ifdef LAG_TURNS
  for (; k + LAG_TURNS <= n; k += LAG_TURNS) {
    const lag_turns x_k = lag_turns_at(x + k, 1);
    *(lag_turns_near *)(to + k) = 1.0/(x_k*lag_turns_sqrt(x_k));
  }
#endif
  for (; k < n; k++) to[k] = LAG_C(1.0)/(x[k]*LAG_FN(sqrt)(x[k]));
}

/* ---- shares: front ---- */
/* Shares of sums over lists and trees, each with memory of its own. */
#if defined(_OPENMP) && _OPENMP >= 201107
#include <omp.h>
#if defined(__unix__) || defined(__APPLE__)
#include <sched.h>
#define LAG_YIELD() (void)sched_yield()
#endif
#ifdef LAG_THREADS
#define LAG_SHARES LAG_THREADS
#define LAG_MOST_SHARES LAG_THREADS
#else
#define LAG_MOST_SHARES 16
#define LAG_SHARES (omp_get_max_threads() < LAG_MOST_SHARES ? omp_get_max_threads() : LAG_MOST_SHARES)
#endif
#else
#define LAG_MOST_SHARES 1
#endif

/* ---- share: front ---- */
/* Nests of loops that threads share, compiled with OpenMP (-fopenmp), in tiles of rows and turns. A tile follows the
 * one above it and the one before it, so that every sum gets its terms in the order of one thread, and the bits do not
 * depend on the number of threads. LAG_THREADS: their number; by default as OpenMP says (OMP_NUM_THREADS). */
#if defined(_OPENMP) && _OPENMP >= 201107
#define LAG_OPENMP 1
#elif defined(LAG_THREADS)
#error "LAG_THREADS needs OpenMP 3.1: -fopenmp"
#endif
#ifdef LAG_OPENMP
#ifdef LAG_THREADS
#define LAG_TEAM num_threads(LAG_THREADS)
#else
#define LAG_TEAM
#endif
#ifndef LAG_YIELD
#define LAG_YIELD() (void)0 /* a thread that waits lets others run: sched_yield() of POSIX */
#endif
/* First of n members of share k, and first row, row 0 being that of member `before`. */
#define LAG_SHARE_OF(n, k, shares) ((int)((long long)(n)*(k)/(shares)))
#define LAG_SHARE_FROM(n, k, shares, before) \
  (LAG_SHARE_OF(n, k, shares) > (before) ? LAG_SHARE_OF(n, k, shares) - (before) : 0)
#define LAG_SHARE_HAS(n, k, shares, j) ((j) >= LAG_SHARE_OF(n, k, shares))
#define LAG_SIDE 64 /* rows and turns of a tile */
#define LAG_SIDES(n) (((n) + LAG_SIDE - 1)/LAG_SIDE)
#define LAG_FROM(x, k) ((x) > LAG_SIDE*(k) ? (x) : LAG_SIDE*(k))
#define LAG_TO(x, k) ((x) < LAG_SIDE*((k) + 1) ? (x) : LAG_SIDE*((k) + 1))
#define LAG_KEPT(x) (x)
#define LAG_TILES lag_tiles
#define LAG_TILE lag_tile
#define LAG_NEXT_TILE lag_next_tile

/* Of all threads: tiles of a column and of a row, how many are taken, and those of each row that are done. */
typedef struct {
  int rows, turns, taken, *done;
} lag_tiles;

/* Of one thread: its tile, and the wave of tiles with this sum of row and turn, whose first has the number `first`. */
typedef struct {
  int number, row, turn, wave, first;
} lag_tile;

LAG_UNUSED static int lag_tiles_read(const int *x) {
  int value;
#pragma omp atomic read
  value = *x;
  return value;
}

LAG_UNUSED static void lag_tiles_wait(const int *done, int least) {
  for (int tries = 1; lag_tiles_read(done) < least; tries++)
    if (tries % 256 == 0) LAG_YIELD();
}

/* Says that the tile is done, and takes the next as soon as those that it follows are done; 0: none is left. */
LAG_UNUSED static int lag_next_tile(lag_tiles *all, lag_tile *t) {
  int number;
  if (t->number >= 0) {
#pragma omp flush
#pragma omp atomic write
    all->done[t->row] = t->turn + 1;
  }
#pragma omp atomic capture
  number = all->taken++;
  if (number >= all->rows*all->turns) return 0;
  t->number = number;
  for (;;) { /* tiles side by side share lines of a cache: of a wave every other one, then those between */
    const int top = t->wave < all->turns ? 0 : t->wave - all->turns + 1;
    const int size = (t->wave < all->rows ? t->wave + 1 : all->rows) - top, k = number - t->first;
    if (k < size) {
      t->row = top + (k < (size + 1)/2 ? 2*k : 2*(k - (size + 1)/2) + 1);
      t->turn = t->wave - t->row;
      break;
    }
    t->first += size;
    t->wave++;
  }
  if (t->row) lag_tiles_wait(&all->done[t->row - 1], t->turn + 1);
  lag_tiles_wait(&all->done[t->row], t->turn);
#pragma omp flush
  return 1;
}
#else
#define LAG_SHARE_FROM(n, k, shares, before) 0
#define LAG_SHARE_HAS(n, k, shares, j) 1
#define LAG_FROM(x, k) (x)
#define LAG_TO(x, k) (x)
#define LAG_KEPT(x) LAG_C(0.0)
#endif

/* ---- lanes ---- */
#ifdef LAG_LANES
LAG_INLINE LAG_REAL lag_lanes_all(double x) {
  const LAG_REAL zero = {0};
  return x - zero;
}

LAG_INLINE LAG_REAL lag_lanes_select(lag_lanes_mask c, LAG_REAL a, LAG_REAL b) {
  return (LAG_REAL)((c & (lag_lanes_mask)a) | (~c & (lag_lanes_mask)b));
}

/* Bit k: whether the condition holds in lane k. */
LAG_INLINE int lag_lanes_bits(lag_lanes_mask c) {
#if defined(__AVX512DQ__) && LAG_LANES == 8 && !defined(__clang__)
  return (unsigned char)__builtin_ia32_cvtq2mask512(c);
#elif defined(__AVX__) && LAG_LANES == 4
  return __builtin_ia32_movmskpd256((LAG_REAL)c);
#else
  int bits = 0;
  for (int k = 0; k < LAG_LANES; k++) bits |= (int)(c[k] & 1) << k;
  return bits;
#endif
}

LAG_INLINE int lag_lanes_any(lag_lanes_mask c) {
#if defined(__AVX512DQ__) && LAG_LANES == 8 && !defined(__clang__)
  return __builtin_ia32_cvtq2mask512(c) != 0;
#elif LAG_LANES == 2
  return (c[0] | c[1]) != 0;
#else
  typedef long long half __attribute__((vector_size(4 * LAG_LANES)));
  union { lag_lanes_mask all; half part[2]; } u = {c};
  const half h = u.part[0] | u.part[1];
  long long some = h[0] | h[1];
  for (int k = 2; k < LAG_LANES/2; k++) some |= h[k];
  return some != 0;
#endif
}

/* Whether any lane is 2^bit or more. */
LAG_INLINE int lag_lanes_reach(lag_lanes_word w, int bit) {
#if defined(__AVX512F__) && LAG_LANES == 8 && !defined(__clang__)
  const lag_lanes_mask no = {0}, all = no + (long long)(~0ULL << bit);
  return __builtin_ia32_ptestmq512((lag_lanes_mask)w, all, (unsigned char)-1) != 0;
#elif defined(__AVX__) && LAG_LANES == 4
  const lag_lanes_mask no = {0}, all = no + (long long)(~0ULL << bit);
  return !__builtin_ia32_ptestz256((lag_lanes_mask)w, all);
#else
  return lag_lanes_any((lag_lanes_mask)(w >> bit));
#endif
}

LAG_INLINE LAG_REAL lag_lanes_fabs(LAG_REAL x) {
  return (LAG_REAL)((lag_lanes_word)x & ~0ULL >> 1);
}

LAG_INLINE LAG_REAL lag_lanes_sqrt(LAG_REAL x) {
#if defined(__AVX512F__) && LAG_LANES == 8 && !defined(__clang__)
  return __builtin_ia32_sqrtpd512_mask(x, x, (char)-1, 4);
#elif defined(__AVX512F__) && LAG_LANES == 8
  return __builtin_ia32_sqrtpd512(x, 4);
#elif defined(__AVX__) && LAG_LANES == 4
  return __builtin_ia32_sqrtpd256(x);
#elif defined(__SSE2__) && LAG_LANES == 2
  return __builtin_ia32_sqrtpd(x);
#else
  for (int k = 0; k < LAG_LANES; k++) x[k] = sqrt(x[k]);
  return x;
#endif
}

#define LAG_LANES_1(f) \
  LAG_INLINE LAG_REAL lag_lanes_##f(LAG_REAL x) { \
    for (int k = 0; k < LAG_LANES; k++) x[k] = f(x[k]); \
    return x; \
  }
#define LAG_LANES_2(f) \
  LAG_INLINE LAG_REAL lag_lanes_##f(LAG_REAL x, LAG_REAL y) { \
    for (int k = 0; k < LAG_LANES; k++) x[k] = f(x[k], y[k]); \
    return x; \
  }
LAG_LANES_EACH(LAG_LANES_1, LAG_LANES_2)
#endif

/* ---- own ---- */
#if LAG_OWN
#define LAG_BITS(high, low) ((lag_bits)(high) << 32 | (low))
#ifdef LAG_LANES
typedef lag_lanes_word lag_word;
LAG_INLINE lag_word lag_to_word(LAG_REAL x) { return (lag_word)x; }
LAG_INLINE LAG_REAL lag_to_real(lag_word w) { return (LAG_REAL)w; }
#define LAG_K(x) lag_lanes_all(x)
#else
typedef lag_bits lag_word;
LAG_INLINE lag_word lag_to_word(double x) {
  union { double x; lag_word w; } u;
  u.x = x;
  return u.w;
}
LAG_INLINE double lag_to_real(lag_word w) {
  union { lag_word w; double x; } u;
  u.w = w;
  return u.x;
}
#define LAG_K(x) (x)
#endif

/* a*b + c, fused where the processor has an instruction for it. */
LAG_INLINE LAG_REAL lag_mad(LAG_REAL a, LAG_REAL b, LAG_REAL c) {
#if !LAG_FMA
  return a*b + c;
#elif !defined(LAG_LANES)
  return fma(a, b, c);
#elif LAG_LANES == 8 && defined(__AVX512F__)
  return __builtin_ia32_vfmaddpd512_mask(a, b, c, (unsigned char)-1, 4);
#elif LAG_LANES == 4 && defined(__FMA__)
  return __builtin_ia32_vfmaddpd256(a, b, c);
#elif LAG_LANES == 2 && defined(__FMA__)
  return __builtin_ia32_vfmaddpd(a, b, c);
#elif defined(__FMA__)
  typedef double half __attribute__((vector_size(32)));
  union { LAG_REAL all; half part[2]; } x = {a}, y = {b}, z = {c};
  for (int k = 0; k < 2; k++) z.part[k] = __builtin_ia32_vfmaddpd256(x.part[k], y.part[k], z.part[k]);
  return z.all;
#else
  for (int k = 0; k < LAG_LANES; k++) a[k] = fma(a[k], b[k], c[k]);
  return a;
#endif
}
#endif

/* ---- libm ---- */
#if defined(LAG_LANES) && !LAG_OWN
LAG_LANES_1(sin) LAG_LANES_1(cos) LAG_LANES_1(exp) LAG_LANES_1(log)
#endif

/* ---- end ---- */
#endif
