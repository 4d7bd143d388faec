/* Linear maps are inverted by their transpose, S^-1 = -J S^T J; others unknown by unknown, where an equation is
 * linear in one. */
#include "phase_space/canonical_map.h"

#include "sym/diff.h"
#include "sym/integrate.h"
#include "sym/prove.h"
#include "sym/simplify.h"

static Expr node(ExprGraph *g, SymId s) { return expr_symbol(g, s)->node; }
static Expr short_diff(ExprGraph *g, Expr x, SymId s) { return simplify(g, expr_diff(g, x, s)); }

/* z as one array. */
static SymId *old_symbols(const PhaseSpace *s) {
  SymId *z = ARENA_ARRAY(s->e->m->arena, SymId, 2 * (size_t)s->n + 1);
  for (uint32_t i = 0; i < s->n; i++) z[i] = s->q[i], z[s->n + i] = s->p[i];
  return z;
}

GeneratorEquations generator_equations(const PhaseSpace *s, const Canonical *c) {
  ExprGraph *g = s->e->g;
  uint32_t n = c->n;
  Expr *left = ARENA_ARRAY(s->e->m->arena, Expr, 4 * (size_t)n + 1), *right = left + 2 * n;
  int has_p = c->kind > 2, has_P = c->kind % 2 == 0;
  for (uint32_t i = 0; i < n; i++) {
    SymId old = has_p ? s->p[i] : s->q[i], fresh = c->fresh[i + (has_P ? n : 0)];
    Expr F_old = expr_diff(g, c->generator, old), F_new = expr_diff(g, c->generator, fresh);
    left[i] = node(g, has_p ? s->q[i] : s->p[i]);
    right[i] = has_p ? expr_neg(g, F_old) : F_old;
    left[n + i] = node(g, c->fresh[i + (has_P ? 0 : n)]);
    right[n + i] = has_P ? F_new : expr_neg(g, F_new);
  }
  return (GeneratorEquations){left, right};
}

/* --- sines of inverse functions --- */

/* Sine or cosine of u = atan2(y, x), atan(y), asin(y) or acos(x); 0: u is none of these. */
static Expr circular_of_inverse(ExprGraph *g, ExprOp op, Expr u) {
  ExprOp inner = expr_op(g, u);
  if (inner != EX_ATAN2 && inner != EX_ATAN && inner != EX_ASIN && inner != EX_ACOS) return 0;
  Expr a = expr_arg(g, u, 0), b = inner == EX_ATAN2 ? expr_arg(g, u, 1) : expr_int(g, 1), square = expr_mul(g, a, a);
  if (inner == EX_ASIN || inner == EX_ACOS) {
    int plain = (inner == EX_ASIN) == (op == EX_SIN);
    return plain ? a : expr_sqrt(g, expr_sub(g, expr_int(g, 1), square));
  }
  Expr other = expr_mul(g, b, b), size = expr_sqrt(g, expr_add(g, square, other));
  return expr_div(g, op == EX_SIN ? a : b, size);
}

Expr without_inverse_functions(ExprGraph *g, Expr x) {
  VEC(Expr) nodes = {0}, with = {0};
  ExprList l = expr_topo(g, &x, 1);
  for (uint32_t i = 0; i < l.n; i++) {
    ExprOp op = expr_op(g, l.at[i]);
    Expr is = op == EX_SIN || op == EX_COS ? circular_of_inverse(g, op, expr_arg(g, l.at[i], 0)) : 0;
    if (!is) continue;
    vec_push(expr_arena(g), &nodes, l.at[i]);
    vec_push(expr_arena(g), &with, is);
  }
  if (nodes.n) expr_replace_nodes(g, &x, 1, nodes.at, with.at, nodes.n, &x);
  return x;
}

/* --- the determinant --- */

/* Row at or below k whose entry in column k is not 0; n: none. */
static uint32_t pivot_row(ExprGraph *g, const Expr *m, uint32_t n, uint32_t k) {
  uint32_t i = k;
  while (i < n && prove_zero(g, m[i * n + k], NULL) == PROVED_ZERO) i++;
  return i;
}

/* By Gauss's elimination; m[n*n] is overwritten. */
static Expr determinant(ExprGraph *g, Expr *m, uint32_t n) {
  Expr det = expr_int(g, 1);
  for (uint32_t k = 0; k < n; k++) {
    uint32_t at = pivot_row(g, m, n, k);
    if (at == n) return expr_int(g, 0);
    for (uint32_t j = 0; j < n && at != k; j++) {
      Expr kept = m[k * n + j];
      m[k * n + j] = m[at * n + j];
      m[at * n + j] = kept;
    }
    if (at != k) det = expr_neg(g, det);
    det = simplify(g, expr_mul(g, det, m[k * n + k]));
    for (uint32_t i = k + 1; i < n; i++) {
      Expr factor = expr_div(g, m[i * n + k], m[k * n + k]);
      for (uint32_t j = k; j < n; j++) {
        Expr part = expr_mul(g, factor, m[k * n + j]);
        m[i * n + j] = simplify(g, expr_sub(g, m[i * n + j], part));
      }
    }
  }
  return det;
}

Expr canonical_determinant(ExprGraph *g, const Canonical *c) {
  uint32_t n = c->n;
  Expr *m = ARENA_ARRAY(expr_arena(g), Expr, (size_t)n * n + 1);
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t j = 0; j < n; j++) {
      SymId old = c->is_point ? 0 : c->old[i + (c->kind > 2 ? n : 0)],
            fresh = c->fresh[j + (!c->is_point && c->kind % 2 == 0 ? n : 0)];
      Expr row =
          c->is_point ? expr_expand_defs(g, c->inverse[i]) : expr_diff(g, expr_expand_defs(g, c->generator), old);
      m[i * n + j] = short_diff(g, row, fresh);
    }
  return determinant(g, m, n);
}

/* --- the inverse --- */

/* Z = S z + b with S free of z: z = -J S^T J (Z - b). NULL: not linear. */
static const Expr *linear_inverse(const PhaseSpace *s, const Canonical *c, const Expr *forward) {
  ExprGraph *g = s->e->g;
  uint32_t n = c->n, N = 2 * n;
  SymId *z = old_symbols(s);
  Expr *S = ARENA_ARRAY(s->e->m->arena, Expr, (size_t)N * N + 1),
       *rest = ARENA_ARRAY(s->e->m->arena, Expr, 3 * (size_t)N + 1), *zero = rest + N, *out = zero + N;
  for (uint32_t k = 0; k < N; k++) zero[k] = expr_int(g, 0);
  for (uint32_t i = 0; i < N; i++) {
    Expr b = expr_replace(g, forward[i], z, zero, N);
    rest[i] = expr_sub(g, node(g, c->fresh[i]), b);
    for (uint32_t k = 0; k < N; k++) {
      S[i * N + k] = short_diff(g, forward[i], z[k]);
      for (uint32_t j = 0; j < N; j++)
        if (expr_contains_sym(g, S[i * N + k], z[j])) return NULL;
    }
  }
  for (uint32_t k = 0; k < N; k++) {
    out[k] = expr_int(g, 0);
    for (uint32_t i = 0; i < N; i++) {
      uint32_t row = (i + n) % N, col = (k + n) % N;
      Expr part = expr_mul(g, S[row * N + col], rest[i]);
      out[k] = (i < n) == (k < n) ? expr_add(g, out[k], part) : expr_sub(g, out[k], part);
    }
    out[k] = simplify(g, out[k]);
  }
  return out;
}

/* Solves eq = 0 for symbol x where it is linear in x with a factor that is not 0 everywhere; 0: it is not. */
static Expr solve_linear(ExprGraph *g, Expr eq, SymId x) {
  Expr slope = short_diff(g, eq, x), zero = expr_int(g, 0);
  if (expr_contains_sym(g, slope, x) || prove_zero(g, slope, NULL) != PROVED_NONZERO) return 0;
  Expr rest = expr_replace(g, eq, &x, &zero, 1), value = expr_neg(g, expr_div(g, rest, slope));
  return simplify(g, value);
}

/* Eliminates the unknowns x[N] from the equations eq[N], one by one. NULL: an unknown is left. */
static const Expr *eliminate(ExprGraph *g, Expr *eq, const SymId *x, uint32_t N) {
  Expr *out = ARENA_ARRAY(expr_arena(g), Expr, N + 1);
  for (uint32_t done = 0; done < N; done++) {
    uint32_t i = 0, k = 0;
    Expr value = 0;
    for (i = 0; i < N && !value; i++)
      for (k = 0; k < N && !value && eq[i]; k++) value = out[k] ? 0 : solve_linear(g, eq[i], x[k]);
    if (!value) return NULL;
    i--, k--;
    eq[i] = 0;
    for (uint32_t j = 0; j < N; j++) {
      if (eq[j]) eq[j] = expr_replace(g, eq[j], &x[k], &value, 1);
      if (out[j]) out[j] = simplify(g, expr_replace(g, out[j], &x[k], &value, 1));
    }
    out[k] = value;
  }
  return out;
}

/* Whether z solves all equations. */
static int solves(ExprGraph *g, const Expr *eq, const SymId *x, const Expr *z, uint32_t N) {
  for (uint32_t i = 0; i < N; i++)
    if (prove_zero(g, expr_replace(g, eq[i], x, z, N), NULL) != PROVED_ZERO) return 0;
  return 1;
}

const Expr *canonical_inverse(const PhaseSpace *s, const Canonical *c) {
  ExprGraph *g = s->e->g;
  uint32_t N = 2 * c->n;
  Expr *eq = ARENA_ARRAY(s->e->m->arena, Expr, 3 * (size_t)N + 1), *left = eq + N, *forward = left + N;
  GeneratorEquations F = {0};
  for (uint32_t i = 0; i < N && c->inverse; i++) left[i] = expr_expand_defs(g, c->inverse[i]);
  if (c->inverse) return left;
  if (!c->forward) F = generator_equations(s, c);
  for (uint32_t i = 0; i < N; i++) {
    if (c->forward) forward[i] = phase_space_expression(s, c->forward[i]);
    eq[i] = left[i] = c->forward ? expr_sub(g, node(g, c->fresh[i]), forward[i])
                                 : expr_expand_defs(g, expr_sub(g, F.left[i], F.right[i]));
  }
  SymId *x = old_symbols(s);
  const Expr *z = c->forward ? linear_inverse(s, c, forward) : NULL;
  if (!z) z = eliminate(g, left, x, N);
  return z && solves(g, eq, x, z, N) ? z : NULL;
}

/* --- the new Hamiltonian --- */

/* dR/dZ at fixed Z. */
static Expr *time_gradient(const PhaseSpace *s, const Canonical *c, const Expr *z) {
  ExprGraph *g = s->e->g;
  uint32_t n = c->n;
  SymId t = s->e->m->time;
  Expr *r = ARENA_ARRAY(s->e->m->arena, Expr, 2 * (size_t)n + 1);
  for (uint32_t k = 0; k < 2 * n; k++) {
    r[k] = expr_int(g, 0);
    for (uint32_t i = 0; i < n; i++) {
      Expr dq = expr_diff(g, z[i], c->fresh[k]), dp = expr_diff(g, z[n + i], c->fresh[k]), qt = expr_diff(g, z[i], t),
           pt = expr_diff(g, z[n + i], t);
      Expr one = expr_mul(g, dq, pt), other = expr_mul(g, dp, qt), both = expr_sub(g, one, other);
      r[k] = expr_add(g, r[k], both);
    }
    r[k] = simplify(g, r[k]);
  }
  return r;
}

/* R with the gradient r, proved; 0: none found. */
static Expr time_part(const PhaseSpace *s, const Canonical *c, const Expr *z, const Expr *r) {
  ExprGraph *g = s->e->g;
  SymId *x = old_symbols(s);
  Expr R = c->kind ? expr_replace(g, expr_expand_defs(g, expr_diff(g, c->generator, s->e->m->time)), x, z, 2 * c->n)
                   : expr_potential(g, r, c->fresh, 2 * c->n, 0);
  for (uint32_t k = 0; k < 2 * c->n; k++) {
    Expr slope = expr_diff(g, R, c->fresh[k]);
    if (prove_zero(g, expr_sub(g, slope, r[k]), NULL) != PROVED_ZERO) return 0;
  }
  return R;
}

/* Work of the forces outside H along Z_k: sum of Q_i dq_i/dZ_k. */
static Expr force_along(const PhaseSpace *s, const Canonical *c, const Expr *z, uint32_t k) {
  const Eqns *e = s->e;
  ExprGraph *g = e->g;
  SymId *x = old_symbols(s);
  Expr sum = expr_int(g, 0);
  for (uint32_t i = 0; e->Q && i < (e->first.n ? e->first.n : e->n); i++) {
    uint32_t at = e->first.n ? c->n : i;
    for (uint32_t j = 0; j < c->n && e->first.n; j++)
      if (e->m->pairs.at[j].q == e->first.at[i]) at = j;
    if (at == c->n || expr_is_zero(g, e->Q[i])) continue;
    Expr Q = phase_space_expression(s, e->Q[i]);
    Expr slope = expr_diff(g, z[at], c->fresh[k]);
    sum = expr_add(g, sum, expr_mul(g, expr_replace(g, Q, x, z, 2 * c->n), slope));
  }
  return sum;
}

NewHamiltonian canonical_hamiltonian(const PhaseSpace *s, const Canonical *c, const Expr *z) {
  ExprGraph *g = s->e->g;
  uint32_t n = c->n;
  Expr *rate = ARENA_ARRAY(s->e->m->arena, Expr, 4 * (size_t)n + 1), *motion = rate + 2 * n,
       *r = time_gradient(s, c, z), R = 0;
  NewHamiltonian out = {.rate = rate, .motion = motion};
  for (uint32_t k = 0; k < 2 * n; k++) out.has_R |= !expr_is_zero(g, r[k]);
  if (out.has_R) R = time_part(s, c, z, r);
  out.found_R = R != 0;
  out.K = expr_replace(g, s->H, old_symbols(s), z, 2 * n);
  out.K = simplify(g, R ? expr_add(g, out.K, R) : out.K);
  for (uint32_t k = 0; k < 2 * n; k++) {
    uint32_t by = (k + n) % (2 * n);
    Expr slope = expr_diff(g, out.K, c->fresh[by]), all = R ? slope : expr_add(g, slope, r[by]),
         net = expr_sub(g, all, force_along(s, c, z, by));
    motion[k] = k < n ? all : expr_neg(g, all);
    rate[k] = simplify(g, k < n ? net : expr_neg(g, net));
  }
  return out;
}
