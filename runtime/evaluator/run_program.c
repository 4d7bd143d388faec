/* Executes a program: the operations of its C text, in the same order or with the same operands, hence the same bits.
 */
#include <string.h>

#include "evaluator/program.h"
#include "lag_kkt.h"
#include "lag_math.h"
#include "lag_model.h"
#include "lag_support.h"
#include "numeric/functions.def"

lag_function_1 *const lag_functions_1[] = {
#define ROW(OP, name, ...) name,
    FUNCTIONS(ROW)
#undef ROW
};
lag_function_2 *const lag_functions_2[] = {
#define ROW(name) name,
    PROGRAM_FUNCTIONS_2(ROW)
#undef ROW
};
const uint32_t lag_functions_1_count = sizeof lag_functions_1 / sizeof *lag_functions_1,
               lag_functions_2_count = sizeof lag_functions_2 / sizeof *lag_functions_2;

static const double *array(const Program *p, const double *const *in, const uint32_t *at) {
  return (at[1] == PROGRAM_CONSTANTS ? p->constants : in[at[1]]) + at[2];
}

/* Calls of the loop below, functions of their own, so that the loop keeps its registers. */
#if defined(__GNUC__)
#define APART __attribute__((noinline)) static
#else
#define APART static
#endif

APART double value_of(const Curve *c, double t) {
  if (c->columns == 4) return lag_curve(t, c->n, (const double(*)[4])(const void *)c->row, c->order);
  return lag_spline(t, c->n, (const double(*)[3])(const void *)c->row);
}

/* Whether the system is regular; its solution stands behind the matrix. */
APART int solve(const Program *p, const System *s, double *r) {
  double *w = r + p->work;
  int n = s->n, m = s->m, matrix = (n + m) * n, listed = m > 0 && n + m >= LAG_BAND_LEAST;
  if (listed) memset(w + matrix, 0, (size_t)(n + m) * sizeof *w);
  else memset(w, 0, (size_t)(matrix + n + m) * sizeof *w);
  for (uint32_t k = 0; k < s->entries; k++) w[s->entry[2 * k]] = r[s->entry[2 * k + 1]];
  if (listed) return lag_kkt_listed(n, m, s->coarse, s->entry, 2, (int)s->entries, w);
  return m ? lag_kkt(n, m, s->coarse, w) : lag_solve(n, w, w + matrix);
}

/* Two angles are read before anything is written. */
APART void two_sines(const uint32_t *at, double *r) {
  double a = r[at[1]], b = r[at[4]];
  lag_sincos2(a, &r[at[2]], &r[at[3]], b, &r[at[5]], &r[at[6]]);
}

APART void one_sine(const uint32_t *at, double *r) { lag_sincos(r[at[1]], &r[at[2]], &r[at[3]]); }
APART double sine(double x) { return lag_sin(x); }
APART double cosine(double x) { return lag_cos(x); }
APART void copy_many(double *to, const double *from, uint32_t n) { memcpy(to, from, n * sizeof *to); }

static void copy(double *to, const double *from, uint32_t n) {
  enum { MANY = 16 };
  if (n >= MANY) copy_many(to, from, n);
  else
    for (uint32_t i = 0; i < n; i++) to[i] = from[i];
}

static void copy_2(double *to, const double *from) {
  to[0] = from[0];
  to[1] = from[1];
}

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wpedantic" /* labels as values */
#define NEXT goto *label[*at]
#define TARGET(name) of_##name
#else
#define NEXT goto again
#define TARGET(name) case CODE_##name
#endif
#define A r[at[1]]
#define B r[at[2]]
#define C r[at[3]]
#define D r[at[4]]
#define WORDS(kinds) ((int)sizeof(kinds) + (*(kinds) == 'i' || *(kinds) == 'o')) /* with the code */

int lag_run_program(const Program *p, const double *const *in, double *const *out, double *r) {
  const uint32_t *at = p->words;
  double x = 0;
  r[0] = 0;
  if (p->ncells) memset(r + p->cells, 0, p->ncells * sizeof *r);
#if defined(__GNUC__)
  static const void *const label[] = {
#define ONE(name, ...) &&of_##name,
#define BOTH(name, ...) &&of_##name, &&of_##name##_TO,
      PROGRAM_CODES(ONE, ONE, BOTH)
#undef BOTH
  };
  NEXT;
#else
again:
  switch (*at) {
#endif

#define SPECIAL(name, kinds, statement) \
  TARGET(name) : statement;             \
  at += WORDS(kinds);                   \
  NEXT;
#define PLAIN(name, kinds, formula)                 \
  TARGET(name) : x = (formula), at += WORDS(kinds); \
  NEXT;
#define BOTH(name, kinds, formula)                                                    \
  PLAIN(name, kinds, formula)                                                         \
  TARGET(name##_TO) : x = (formula), r[at[WORDS(kinds)]] = x, at += WORDS(kinds) + 1; \
  NEXT;
  PROGRAM_CODES(SPECIAL, PLAIN, BOTH)
#if !defined(__GNUC__)
  }
  return LAG_ESINGULAR;
#endif
}
