/* Elimination by 2x2 pivots with Markowitz's count (Bunch 1982); the rest by Pfaffians of all subsets of its rows
 * (Knuth 1996), 2^m of them. */
#include "mech/antisymmetric_solve.h"

#include "sym/simplify.h"

typedef struct {
  ExprGraph *g;
  Arena *arena;
  uint32_t n;
  Expr *A, *b;
  uint8_t *gone;
  uint32_t *degree; /* nonzero entries of each row, among the remaining columns */
} SkewSystem;

static Expr *entry(const SkewSystem *s, uint32_t i, uint32_t j) { return &s->A[(size_t)i * s->n + j]; }

static int is_zero(const SkewSystem *s, uint32_t i, uint32_t j) { return expr_is_zero(s->g, *entry(s, i, j)); }

static void set(const SkewSystem *s, uint32_t i, uint32_t j, Expr e) {
  *entry(s, i, j) = e;
  *entry(s, j, i) = expr_neg(s->g, e);
}

/* --- elimination --- */

/* Whether e is nonzero wherever it has a value, as 1/(x*y). */
static int is_nonzero(const SkewSystem *s, Expr e) {
  Num k;
  if (expr_pairs(s->g, e, EX_SUM) == 1 && !expr_is_num(s->g, e)) e = expr_pair(s->g, e, EX_SUM, 0, &k);
  int safe = 1;
  for (uint32_t i = 0; i < expr_pairs(s->g, e, EX_PROD) && safe; i++) {
    Expr base = expr_pair(s->g, e, EX_PROD, i, &k);
    safe = num_sign(k) < 0 || expr_is_nonzero(s->g, base);
  }
  return safe || expr_is_nonzero(s->g, e);
}

static void count(SkewSystem *s) {
  for (uint32_t i = 0; i < s->n; i++) {
    s->degree[i] = 0;
    for (uint32_t j = 0; j < s->n && !s->gone[i]; j++) s->degree[i] += !s->gone[j] && !is_zero(s, i, j);
  }
}

/* The pair with a nonzero entry for certain and the least fill-in (Markowitz's count). 0: there is none. */
static int find_pair(SkewSystem *s, uint32_t *at, uint32_t *with) {
  uint64_t best = UINT64_MAX;
  count(s);
  for (uint32_t i = 0; i < s->n; i++)
    for (uint32_t j = i + 1; j < s->n && !s->gone[i]; j++) {
      uint64_t cost = 2 * (uint64_t)(s->degree[i] - 1) * (s->degree[j] - 1);
      if (s->gone[j] || is_zero(s, i, j) || !is_nonzero(s, *entry(s, i, j))) continue;
      cost += !expr_is_num(s->g, *entry(s, i, j)); /* numbers first */
      if (cost >= best) continue;
      best = cost;
      *at = i;
      *with = j;
    }
  return best < UINT64_MAX;
}

static Expr over(const SkewSystem *s, Expr a, Expr b, Expr pivot) {
  Expr product = expr_mul(s->g, a, b);
  return expr_div(s->g, product, pivot);
}

/* A_kl += (A_jk A_il - A_ik A_jl)/a, b_k += (A_jk b_i - A_ik b_j)/a, with a = A_ij. */
static void eliminate(SkewSystem *s, uint32_t i, uint32_t j) {
  ExprGraph *g = s->g;
  Expr a = *entry(s, i, j);
  s->gone[i] = s->gone[j] = 1;
  for (uint32_t k = 0; k < s->n; k++) {
    if (s->gone[k] || (is_zero(s, i, k) && is_zero(s, j, k))) continue;
    Expr up = over(s, *entry(s, j, k), s->b[i], a), down = over(s, *entry(s, i, k), s->b[j], a);
    Expr change = expr_sub(g, up, down);
    s->b[k] = expr_add(g, s->b[k], change);
    for (uint32_t l = k + 1; l < s->n; l++) {
      if (s->gone[l] || (is_zero(s, i, l) && is_zero(s, j, l))) continue;
      Expr plus = over(s, *entry(s, j, k), *entry(s, i, l), a), minus = over(s, *entry(s, i, k), *entry(s, j, l), a);
      Expr fill = expr_sub(g, plus, minus), sum = expr_add(g, *entry(s, k, l), fill);
      set(s, k, l, simplify(g, sum));
    }
  }
}

/* x/pivot, term by term if the pivot is a product, so that common factors cancel. */
static Expr divide(const SkewSystem *s, Expr x, Expr pivot) {
  ExprGraph *g = s->g;
  uint32_t n = expr_pairs(g, x, EX_SUM);
  if (n < 2 || expr_pairs(g, pivot, EX_SUM) > 1) return expr_div(g, x, pivot);
  Expr *terms = ARENA_ARRAY(s->arena, Expr, n);
  for (uint32_t i = 0; i < n; i++) {
    Num c;
    Expr term = expr_pair(g, x, EX_SUM, i, &c), part = expr_div(g, term, pivot);
    terms[i] = expr_scale(g, c, part);
  }
  return expr_add_n(g, terms, n);
}

/* Back substitution for the pair (i, j); x[k] is the null Expr for unknowns eliminated before it. */
static void substitute(const SkewSystem *s, uint32_t i, uint32_t j, Expr *x) {
  ExprGraph *g = s->g;
  Expr a = *entry(s, i, j), at_i = s->b[i], at_j = expr_neg(g, s->b[j]);
  for (uint32_t k = 0; k < s->n; k++) {
    if (!x[k]) continue;
    Expr ik = expr_mul(g, *entry(s, i, k), x[k]), jk = expr_mul(g, *entry(s, j, k), x[k]);
    at_i = expr_sub(g, at_i, ik);
    at_j = expr_add(g, at_j, jk);
  }
  x[j] = divide(s, at_i, a);
  x[i] = divide(s, at_j, a);
}

/* --- Pfaffians --- */

static int bits(uint32_t set) {
  int n = 0;
  for (; set; set &= set - 1) n++;
  return n;
}

/* pf[set] = Pfaffian of the rows and columns at[k] for the bits k of set, expanded along its first row. */
static Expr *pfaffians(const SkewSystem *s, const uint32_t *at, uint32_t m) {
  ExprGraph *g = s->g;
  Expr *pf = ARENA_ARRAY(s->arena, Expr, (size_t)1 << m);
  pf[0] = expr_int(g, 1);
  for (uint32_t set = 1; set < 1u << m; set++) {
    uint32_t first = 0;
    int negative = 0;
    if (bits(set) % 2) continue;
    while (!(set >> first & 1)) first++;
    Expr sum = expr_int(g, 0);
    for (uint32_t k = first + 1; k < m; k++) {
      if (!(set >> k & 1)) continue;
      Expr term = expr_mul(g, *entry(s, at[first], at[k]), pf[set & ~(1u << first) & ~(1u << k)]);
      sum = negative ? expr_sub(g, sum, term) : expr_add(g, sum, term);
      negative = !negative;
    }
    pf[set] = sum;
  }
  return pf;
}

/* Above the diagonal, A^-1 has the entries (-1)^(i + j) Pf(without i, j)/Pf, counted from 1. */
static void solve_by_pfaffians(const SkewSystem *s, const uint32_t *at, uint32_t m, Name name, Expr *x, Expr *divisor) {
  enum { NAMED = 4 };
  ExprGraph *g = s->g;
  Expr *pf = pfaffians(s, at, m);
  uint32_t all = (1u << m) - 1;
  Expr whole = simplify(g, pf[all]);
  if (m >= NAMED) whole = expr_def_unique(g, name, whole);
  *divisor = is_nonzero(s, whole) ? 0 : whole;
  for (uint32_t i = 0; i < m; i++) {
    Expr sum = expr_int(g, 0);
    for (uint32_t j = 0; j < m; j++) {
      if (i == j) continue;
      int negative = ((i + j) % 2 != 0) != (j < i);
      Expr term = expr_mul(g, pf[all & ~(1u << i) & ~(1u << j)], s->b[at[j]]);
      sum = negative ? expr_sub(g, sum, term) : expr_add(g, sum, term);
    }
    x[at[i]] = divide(s, sum, whole);
  }
}

int antisymmetric_solve(ExprGraph *g, uint32_t n, Expr *A, Expr *b, Name name, SkewSolution *to) {
  Arena *arena = expr_arena(g);
  Expr *x = ARENA_ARRAY(arena, Expr, n + 1);
  SkewSystem s = {g, arena, n, A, b, ARENA_ARRAY(arena, uint8_t, n + 1), ARENA_ARRAY(arena, uint32_t, n + 1)};
  uint32_t *pairs = ARENA_ARRAY(arena, uint32_t, n + 2), npairs = 0;
  *to = (SkewSolution){.x = x, .left = ARENA_ARRAY(arena, uint32_t, n + 1)};
  while (find_pair(&s, &pairs[npairs], &pairs[npairs + 1])) {
    eliminate(&s, pairs[npairs], pairs[npairs + 1]);
    npairs += 2;
  }
  for (uint32_t i = 0; i < n; i++)
    if (!s.gone[i]) to->left[to->nleft++] = i;
  if (to->nleft > ANTISYMMETRIC_MOST || to->nleft % 2) return 0;
  if (to->nleft) solve_by_pfaffians(&s, to->left, to->nleft, name, x, &to->divisor);
  while (npairs) {
    npairs -= 2;
    substitute(&s, pairs[npairs], pairs[npairs + 1], x);
  }
  return 1;
}
