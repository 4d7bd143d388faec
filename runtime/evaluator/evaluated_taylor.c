/* Taylor coefficients by the recurrences of a program: the sums of emitted C (src/emit/emit_taylor.c), column by
 * column, with the same terms in the same order. */
#include <string.h>

#include "evaluator/evaluated_model.h"

/* w: by order, the factors of the sums; the sums; constants of order 0; the frame. */
typedef struct {
  double *a, *b, *s, *c, *frame;
  size_t na, nb; /* factors an order */
} Work;

static Work work_of(const EvaluatedTaylor *t, double *w) {
  Work x = {.na = (size_t)t->row, .nb = (size_t)t->first_square};
  x.a = w;
  x.b = x.a + LAG_TAYLOR_ORDER * x.na;
  x.s = x.b + LAG_TAYLOR_ORDER * x.nb;
  x.c = x.s + x.na;
  x.frame = x.c + t->constants;
  return x;
}

size_t lag_taylor_room(const EvaluatedTaylor *t) {
  size_t a = (size_t)t->row, b = (size_t)t->first_square;
  size_t frame = t->first->frame > t->next->frame ? t->first->frame : t->next->frame;
  return LAG_TAYLOR_ORDER * (a + b) + a + (size_t)t->constants + frame;
}

static int first(LAG_STATE, const double *follows, double *x, double *w) {
  const EvaluatedTaylor *s = self;
  Work k = work_of(s, w);
  const double *const in[PROGRAM_ARRAY_COUNT] = {&t, q, v, z, p, u, [PROGRAM_FREE] = follows};
  for (int i = 0; i < s->nq; i++) x[i] = q[i], x[s->nq + i] = v[i];
  for (int i = 0; i < s->nz; i++) x[2 * s->nq + i] = z[i];
  return lag_run_program(s->first, in, (double *[]){x, k.c}, k.frame);
}

/* --- sums of order k: a[1] b[k-1] + ... + a[k-1] b[1] --- */

/* Terms from order `low` to k - low, then the outer ones in pairs. */
static void sums_in_memory(const EvaluatedTaylor *t, int k, const Work *w) {
  const double *a1 = w->a + w->na, *b1 = w->b + w->nb, *an = w->a + (size_t)(k - 1) * w->na,
               *bn = w->b + (size_t)(k - 1) * w->nb;
  for (int i = 0; i < t->sums; i++) w->s[i] = 0;
  for (int j = 2; j < k - 1; j++) {
    const double *a = w->a + (size_t)j * w->na, *b = w->b + (size_t)(k - j) * w->nb;
    for (int i = 0; i < t->sums; i++) w->s[i] += a[i] * b[i];
  }
  if (k > 2)
    for (int i = 0; i < t->sums; i++) w->s[i] = w->s[i] + an[i] * b1[i] + a1[i] * bn[i];
  else if (k == 2)
    for (int i = 0; i < t->sums; i++) w->s[i] = a1[i] * bn[i];
}

static void squares_in_memory(const EvaluatedTaylor *t, int k, const Work *w) {
  const int half = k / 2, n = t->first_square + t->squares;
  const double *a1 = w->a + w->na, *an = w->a + (size_t)(k - 1) * w->na, *m = w->a + (size_t)half * w->na,
               weight = k > 2 ? 2 : 1;
  for (int i = t->first_square; i < n; i++) w->s[i] = 0;
  for (int j = 2; j < k - j; j++) {
    const double *a = w->a + (size_t)j * w->na, *b = w->a + (size_t)(k - j) * w->na;
    for (int i = t->first_square; i < n; i++) w->s[i] += a[i] * b[i];
  }
  for (int i = t->first_square; i < n; i++) w->s[i] *= 2;
  if (half > 1 && 2 * half == k)
    for (int i = t->first_square; i < n; i++) w->s[i] += m[i] * m[i];
  if (k < 2) return;
  for (int i = t->first_square; i < n; i++) w->s[i] += weight * (a1[i] * an[i]);
}

static void sums_nearby(const EvaluatedTaylor *t, int k, const Work *w) {
  for (int i = 0; i < t->sums; i++) {
    const double *a = w->a + i, *b = w->b + i;
    const size_t na = w->na, nb = w->nb, last = (size_t)(k - 1);
    double s = 0;
    for (size_t j = 3; j + 2 < (size_t)k; j++) s += a[j * na] * b[((size_t)k - j) * nb];
    if (k > 4) s += a[(last - 1) * na] * b[2 * nb] + a[2 * na] * b[(last - 1) * nb];
    else if (k == 4) s = a[2 * na] * b[2 * nb];
    if (k > 2) s += a[last * na] * b[nb] + a[na] * b[last * nb];
    else if (k == 2) s = a[last * na] * b[last * nb];
    w->s[i] = s;
  }
}

static void squares_nearby(const EvaluatedTaylor *t, int k, const Work *w) {
  for (int i = t->first_square; i < t->first_square + t->squares; i++) {
    const double *a = w->a + i;
    const size_t na = w->na, last = (size_t)(k - 1), half = (size_t)k / 2;
    double s = 0;
    for (int j = 3; j < k - j; j++) s += a[(size_t)j * na] * a[(size_t)(k - j) * na];
    s = 2 * s;
    if (half > 1 && 2 * half == (size_t)k) s += a[half * na] * a[half * na];
    if (k > 4) s += 2 * (a[(last - 1) * na] * a[2 * na]);
    if (k > 2) s += 2 * (a[last * na] * a[na]);
    else if (k == 2) s = a[last * na] * a[last * na];
    w->s[i] = s;
  }
}

static void sums(const EvaluatedTaylor *t, int k, const Work *w) {
  if (k < 2) {
    memset(w->s, 0, w->na * sizeof *w->s);
  } else if (t->near) {
    sums_nearby(t, k, w);
    squares_nearby(t, k, w);
  } else {
    sums_in_memory(t, k, w);
    squares_in_memory(t, k, w);
  }
}

/* Rates of order k from the coefficients of y in row k; y of the next order, those of a motion, into `next`. */
static void order(const EvaluatedTaylor *s, int k, double T, double *row, double *next, const Work *w) {
  const double per_k = 1.0 / k, number = k, up = T * (1.0 / (k + 1));
  sums(s, k, w);
  const double *const in[PROGRAM_ARRAY_COUNT] = {
      [PROGRAM_COEF] = row,      [PROGRAM_SUMS] = w->s,        [PROGRAM_STEP] = w->c,
      [PROGRAM_ORDER] = &number, [PROGRAM_PER_ORDER] = &per_k, [PROGRAM_UP] = &up};
  double *const out[] = {row, next, w->a + (size_t)k * w->na, w->b + (size_t)k * w->nb};
  lag_run_program(s->next, in, out, w->frame);
}

static void rest(const void *self, int n, double T, double *x, double *work) {
  const EvaluatedTaylor *s = self;
  const Work w = work_of(s, work);
  const int columns = s->taylor.columns, nq = s->nq, nz = s->nz, t = 3 * nq + 2 * nz;
  if (s->uses_time) x[columns + t] = T;
  for (int i = 0; i < 2 * nq + nz; i++) x[columns + i] = T * x[i < nq ? nq + i : nq + nz + i];
  for (int k = 1; k < n; k++) {
    order(s, k, T, x + k * columns, x + (k + 1) * columns, &w);
    if (s->uses_time) x[k * columns + t] = 0;
  }
}

static void along(const void *self, int n, double *x, double *work) {
  const EvaluatedTaylor *s = self;
  const Work w = work_of(s, work);
  const int columns = s->taylor.columns;
  for (int k = 1; k < n; k++) order(s, k, 1, x + k * columns, x + n * columns, &w);
}

/* Even and odd powers by Horner's rule: s o(u) + u e(u), u = s^2. */
static void at(const void *self, int n, double s, const double *x, double *y, double *dy) {
  const lag_taylor *t = self;
  const double u = s * s, twice = 2;
  for (int i = 0; i < t->width; i++) {
    const double *c = x + i;
    double e = 0, de = 0, o = 0, d = 0;
    int k = n;
    if (k % 2 == 0) e = c[k * t->columns], k--;
    for (; k > 0; k -= 2) {
      d = d * u + o;
      o = o * u + c[k * t->columns];
      if (k == 1) break;
      de = de * u + e;
      e = e * u + c[(k - 1) * t->columns];
    }
    y[i] = e * u + o * s;
    dy[i] = (de * u + e) * (twice * s) + d * (twice * u) + o;
  }
}

void lag_set_taylor_functions(EvaluatedTaylor *t) {
  t->taylor.first = first, t->taylor.rest = rest, t->taylor.at = at, t->taylor.along = along;
}
