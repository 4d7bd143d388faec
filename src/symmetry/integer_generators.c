/* Multiplies rows xi by M, finds short integer combinations of them, and solves exactly for xi. */
#include "symmetry/integer_generators.h"

#include <math.h>

#include "symmetry/lattice_reduction.h"
#include "sym/simplify.h"

static int momenta_are_linear(Arena *a, const Ansatz *s) {
  Expr *zero = ARENA_ARRAY(a, Expr, s->n + 1);
  ExprGraph *g = s->e->g;
  for (uint32_t i = 0; i < s->n; i++) zero[i] = expr_int(g, 0);
  for (uint32_t i = 0; i < s->n; i++)
    if (!expr_is_zero(g, simplify(g, expr_replace(g, eqns_momenta(s->e)[i], s->v, zero, s->n)))) return 0;
  return 1;
}

const Num *exact_mass(Arena *a, const Ansatz *s) {
  const Eqns *e = s->e;
  size_t n = s->n;
  if (s->forms || !forms_are_needed(e) || e->constraints.n || s->shown != 1 + n + n * n || !momenta_are_linear(a, s)) return NULL;
  Num *M = ARENA_ARRAY(a, Num, n * n + 1);
  for (size_t k = 0; k < n * n; k++) M[k] = num_int(0);
  for (uint32_t k = 0; k < e->mass.n; k++) {
    const MassEntry *m = &e->mass.at[k];
    if (!expr_is_num(e->g, m->e) || !num_is_exact(expr_number(e->g, m->e))) return NULL;
    M[m->row * n + m->col] = M[m->col * n + m->row] = expr_number(e->g, m->e);
  }
  return M;
}

/* Index in a block of the coefficient of phi_k in xi_i. */
static size_t place(size_t n, size_t i, size_t k) { return 1 + (k ? n + i * n + k - 1 : i); }

static long double value_of(Num x) { return num_is_exact(x) ? (long double)x.num / (long double)x.den : num_value(x); }

/* M xi from xi, by value. */
static void multiply_by_mass(const Ansatz *s, const Num *M, uint32_t blocks, const long double *xi, long double *to) {
  size_t n = s->n;
  for (uint32_t m = 0; m < blocks; m++, xi += s->shown, to += s->shown) {
    to[0] = xi[0];
    for (size_t k = 0; k <= n; k++)
      for (size_t i = 0; i < n; i++) {
        to[place(n, i, k)] = 0;
        for (size_t j = 0; j < n; j++) to[place(n, i, k)] += value_of(M[i * n + j]) * xi[place(n, j, k)];
      }
  }
}

int raise_generator(Arena *a, const Ansatz *s, const Num *M, uint32_t blocks, Expr *c) {
  ExprGraph *g = s->e->g;
  size_t n = s->n;
  Expr *x = ARENA_ARRAY(a, Expr, n * (n + 1) + 1);
  for (uint32_t m = 0; m < blocks; m++, c += s->shown) {
    for (size_t i = 0; i < n; i++)
      for (size_t k = 0; k <= n; k++) x[i * (n + 1) + k] = c[place(n, i, k)];
    if (!forms_solve(a, g, s->n, M, s->n + 1, x)) return 0;
    for (size_t i = 0; i < n; i++)
      for (size_t k = 0; k <= n; k++) c[place(n, i, k)] = x[i * (n + 1) + k];
  }
  return 1;
}

/* Sets to 0 the elements that are rounding beside the largest of a row. */
static void clear_rounding(long double *row, size_t width) {
  long double most = dense_largest(row, width);
  for (size_t k = 0; k < width; k++)
    if (fabsl(row[k]) < 1e-13L * most) row[k] = 0;
}

static uint32_t leading(const int64_t *row, size_t width) {
  uint32_t k = 0;
  while (k < width && row[k] == 0) k++;
  return k;
}

/* Sorts rows by their first nonzero entry: the energy, generators independent of time, the rest. */
static void sort(Arena *a, int64_t *rows, uint32_t count, size_t width) {
  int64_t *kept = ARENA_ARRAY(a, int64_t, width + 1);
  for (size_t i = 1; i < count; i++)
    for (size_t k = i; k > 0 && leading(rows + k * width, width) < leading(rows + (k - 1) * width, width); k--) {
      memcpy(kept, rows + k * width, width * sizeof *kept);
      memcpy(rows + k * width, rows + (k - 1) * width, width * sizeof *kept);
      memcpy(rows + (k - 1) * width, kept, width * sizeof *kept);
    }
}

uint32_t integer_generators(Arena *a, const Ansatz *s, const Num *M, const DenseRows *space, Expr **to, long double **value) {
  ExprGraph *g = s->e->g;
  size_t width = space->width;
  uint32_t blocks = (uint32_t)width / s->shown, count = 0;
  DenseRows lowered = {space->n, space->width, ARENA_ARRAY(a, long double, space->n * width + 1), space->gap};
  int64_t *whole = ARENA_ARRAY(a, int64_t, space->n * width + 1);
  for (size_t k = 0; k < space->n; k++) {
    multiply_by_mass(s, M, blocks, space->at + k * width, lowered.at + k * width);
    clear_rounding(lowered.at + k * width, width);
  }
  uint32_t found = integer_rows(a, &lowered, whole);
  sort(a, whole, found, width);
  for (size_t k = 0; k < found; k++) {
    Expr *c = ARENA_ARRAY(a, Expr, width + 1), *xi = ARENA_ARRAY(a, Expr, width + 1);
    for (size_t j = 0; j < width; j++) c[j] = expr_num(g, num_int(whole[k * width + j]));
    memcpy(xi, c, width * sizeof *xi);
    if (!raise_generator(a, s, M, blocks, xi)) continue;
    value[count] = ARENA_ARRAY(a, long double, width + 1);
    for (size_t j = 0; j < width; j++) value[count][j] = value_of(expr_number(g, xi[j]));
    to[count++] = c;
  }
  return count;
}
