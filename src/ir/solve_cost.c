/* Operation counts of the linear systems that loops of the runtime solve. With constraints the loops follow
 * envelopes (lag_kkt.h), so the count depends on the pattern of M and A. */
#include "ir/prog.h"

/* Operations on lower triangles, whose row i begins at column from[i]. */
typedef struct {
  uint64_t pairs, divisions, roots; /* pairs: multiply-adds; with each root goes one product more */
} Ops;

static uint32_t later(uint32_t a, uint32_t b) { return a > b ? a : b; }
static uint32_t span(uint32_t from, uint32_t to) { return to > from ? to - from : 0; }

static void cholesky(uint32_t n, const uint32_t *from, Ops *c) {
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t j = from[i]; j <= i; j++) {
      c->pairs += span(later(from[i], from[j]), j);
      *(j == i ? &c->roots : &c->divisions) += 1;
    }
}

/* L^-1 x, where x is zero before `begin`; with begin 0 also L^-T x. */
static void substitution(uint32_t n, const uint32_t *from, uint32_t begin, Ops *c) {
  for (uint32_t i = begin; i < n; i++) {
    c->pairs += span(later(from[i], begin), i);
    c->divisions++;
  }
}

/* Elements of one row of the system, by rising column. */
typedef struct {
  const SolveElement *at;
  uint32_t n, before; /* before: place of its column 0 */
} Row;

/* The row of k from element *e on; *e := the first element of the next row. */
static Row next_row(const Solve *k, uint32_t row, uint32_t *e) {
  Row r = {k->list.at + *e, 0, row*k->n};
  for (; *e < k->list.n && k->list.at[*e].at - r.before < k->n; ++*e) r.n++;
  return r;
}

/* First column of the row that is not zero, n at most. */
static uint32_t first_entry(const Row *r, uint32_t n) {
  uint32_t i = 0;
  while (i < r->n && !r->at[i].x) i++;
  return i < r->n && r->at[i].at - r->before < n ? r->at[i].at - r->before : n;
}

/* One past the last nonzero element of L^-1 x. */
static uint32_t end_of_solution(uint32_t n, const uint32_t *from, const Row *x) {
  uint32_t end = 0;
  for (uint32_t i = 0, e = 0; i < n; i++) {
    int is_listed = e < x->n && x->at[e].at - x->before == i;
    if ((is_listed && x->at[e].x) || from[i] < end) end = i + 1;
    e += (uint32_t)is_listed;
  }
  return end;
}

/* Schur's complement, as in lag_schur, line by line. Large banded systems go by lag_banded instead; they are counted
 * here too, though it takes about as many operations where M is diagonal, and fewer where it is not. */
static Ops by_complement(Arena *a, const Solve *k) {
  uint32_t n = k->n, m = k->m, e = 0;
  uint32_t *from = ARENA_ARRAY(a, uint32_t, n), *begin = ARENA_ARRAY(a, uint32_t, m),
           *end = ARENA_ARRAY(a, uint32_t, m), *row = ARENA_ARRAY(a, uint32_t, m);
  Ops c = {0};
  for (uint32_t i = 0; i < n; i++) {
    Row r = next_row(k, i, &e);
    from[i] = first_entry(&r, i);
  }
  cholesky(n, from, &c);
  for (uint32_t j = 0; j < m; j++) {
    Row r = next_row(k, n + j, &e);
    begin[j] = first_entry(&r, n);
    substitution(n, from, begin[j], &c);
    end[j] = end_of_solution(n, from, &r);
    row[j] = j;
    for (uint32_t i = j + 1; i-- > 0;) {
      uint32_t both = span(later(begin[j], begin[i]), end[j] < end[i] ? end[j] : end[i]);
      c.pairs += both;
      if (both) row[j] = i;
    }
  }
  cholesky(m, row, &c);
  substitution(n, from, 0, &c);
  for (uint32_t j = 0; j < m; j++) c.pairs += span(begin[j], end[j]);
  for (int turn = 0; turn < 2; turn++) { /* with one step of refinement */
    substitution(m, row, 0, &c);
    substitution(m, row, 0, &c);
    for (uint32_t j = 0; j < m; j++) c.pairs += span(begin[j], end[j]);
    substitution(n, from, 0, &c);
  }
  c.pairs += (uint64_t)m*n; /* residuals of the constraints */
  return c;
}

/* Elimination and two substitutions, within the band that lag_solve finds. */
static OpCount by_pivoting(const Solve *k) {
  OpCount c = {.div = k->n};
  uint64_t below = 0, above = 0;
  for (uint32_t e = 0; e < k->list.n; e++) {
    uint64_t i = k->list.at[e].at / k->n, j = k->list.at[e].at % k->n;
    if (!k->list.at[e].x) continue;
    if (i > j + below) below = i - j;
    if (j > i + above) above = j - i;
  }
  for (uint64_t left = k->n; left-- > 0;) {
    uint64_t rows = left < below ? left : below, columns = left < below + above ? left : below + above;
    c.mul += rows*columns + rows + columns;
    c.div += rows;
  }
  c.add = c.mul;
  return c;
}

OpCount solve_count(Arena *a, const Solve *k) {
  uint64_t n = k->n, m = k->m; /* their cubes pass 2^32 */
  if (m && m <= n) {
    Ops c = by_complement(a, k);
    return (OpCount){.add = c.pairs + 2*m, .mul = c.pairs + c.roots, .div = c.divisions, .sqrt = c.roots};
  }
  if (m) { /* dominated by the orthogonal factorization of A^T */
    uint64_t both = 2*n*n*n + 2*m*n*n + (n > m ? n - m : 0)*n*n/3;
    return (OpCount){.add = both, .mul = both, .div = n*n/2 + m*n + 2*(n + m), .sqrt = m};
  }
  return by_pivoting(k);
}
