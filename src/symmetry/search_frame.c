/* S is the matrix of the forms that L is written with, or the Cholesky factor of the mass matrix. */
#include "symmetry/search_frame.h"

#include <math.h>
#include <string.h>

/* Upper Cholesky factor, S^T S = M, from the values of the entries of M; 0: M is not positive definite. */
static int factor(const Eqns *e, uint32_t n, const long double *mass, long double *S) {
  for (uint32_t k = 0; k < e->mass.n; k++) {
    const MassEntry *x = &e->mass.at[k];
    S[x->row * n + x->col] = S[x->col * n + x->row] = mass[k];
  }
  for (uint32_t k = 0; k < n; k++) {
    long double pivot = S[k * n + k];
    if (!(pivot > 0) || !isfinite(pivot)) return 0;
    for (uint32_t i = k + 1; i < n; i++)
      for (uint32_t j = i; j < n; j++) S[i * n + j] -= S[k * n + i] * S[k * n + j] / pivot;
    for (uint32_t j = k; j < n; j++) S[k * n + j] /= sqrtl(pivot);
    for (uint32_t j = 0; j < k; j++) S[k * n + j] = 0;
  }
  return 1;
}

static void invert(uint32_t n, const long double *S, long double *to) {
  for (uint32_t j = 0; j < n; j++)
    for (uint32_t i = n; i-- > 0;) {
      long double sum = i == j;
      for (uint32_t k = i + 1; k < n; k++) sum -= S[i * n + k] * to[k * n + j];
      to[i * n + j] = sum / S[i * n + i];
    }
}

static NoetherFrame *frame_sized(Arena *scratch, size_t n) {
  NoetherFrame *f = ARENA_NEW(scratch, NoetherFrame);
  *f = (NoetherFrame){(uint32_t)n, 0, ARENA_ARRAY(scratch, long double, n * n), ARENA_ARRAY(scratch, long double, n * n), ARENA_ARRAY(scratch, long double, n + 1)};
  return f;
}

static const NoetherFrame *frame_of_forms(const LinearForms *forms, ExprGraph *g, Arena *scratch, const long double *parameters) {
  uint32_t n = forms->n;
  NoetherFrame *f = frame_sized(scratch, n);
  expr_eval(g, forms->S, n * n, parameters, f->S);
  expr_eval(g, forms->inverse, n * n, parameters, f->inverse);
  expr_eval(g, forms->shift, n, parameters, f->shift);
  f->stays = 1;
  return f;
}

const NoetherFrame *frame_new(const Ansatz *a, Arena *scratch, const long double *parameters) {
  const Eqns *e = a->e;
  if (a->forms) return frame_of_forms(a->forms, e->g, scratch, parameters);
  if (!forms_are_needed(e) || ansatz_is_restricted(a)) return NULL;
  NoetherFrame *f = frame_sized(scratch, a->n);
  Expr *entry = ARENA_ARRAY(scratch, Expr, e->mass.n);
  long double *mass = ARENA_ARRAY(scratch, long double, e->mass.n);
  for (uint32_t k = 0; k < e->mass.n; k++) entry[k] = e->mass.at[k].e;
  expr_eval(e->g, entry, e->mass.n, parameters, mass);
  if (!factor(e, a->n, mass, f->S)) return NULL; /* S^T S is the mass matrix */
  invert(a->n, f->S, f->inverse);
  return f;
}

/* x = m x */
static void apply(uint32_t n, const long double *m, long double *x, long double *scratch) {
  memcpy(scratch, x, n * sizeof *x);
  for (uint32_t i = 0; i < n; i++) {
    x[i] = 0;
    for (uint32_t k = 0; k < n; k++) x[i] += m[i * n + k] * scratch[k];
  }
}

/* x = x m */
static void apply_left(uint32_t n, const long double *m, long double *x, long double *scratch) {
  memcpy(scratch, x, n * sizeof *x);
  for (uint32_t k = 0; k < n; k++) {
    x[k] = 0;
    for (uint32_t i = 0; i < n; i++) x[k] += scratch[i] * m[i * n + k];
  }
}

void frame_vector(const NoetherFrame *f, long double *x, long double *scratch) { apply(f->n, f->S, x, scratch); }
void frame_vector_back(const NoetherFrame *f, long double *x, long double *scratch) { apply(f->n, f->inverse, x, scratch); }
void frame_covector(const NoetherFrame *f, long double *x, long double *scratch) { apply_left(f->n, f->inverse, x, scratch); }

/* Columns of shown: tau, the constants of all xi_i, then the coefficients of y_1 .. y_n for each xi_i. */
void frame_generator_back(const NoetherFrame *f, long double *shown, long double *scratch) {
  uint32_t n = f->n;
  if (f->stays) return;
  long double *shift = shown + 1, *linear = shift + n, *column = scratch + n;
  frame_vector_back(f, shift, scratch);
  for (uint32_t i = 0; i < n; i++) apply_left(n, f->S, linear + (size_t)i * n, scratch);
  for (uint32_t k = 0; k < n; k++) {
    for (uint32_t i = 0; i < n; i++) column[i] = linear[i * n + k];
    frame_vector_back(f, column, scratch);
    for (uint32_t i = 0; i < n; i++) linear[i * n + k] = column[i];
  }
}
