/* Legendre transformation: M is inverted by cofactors, block by block; q' = M^-1 (p - a), and p' by differentiating
 * H. */
#include "mech/hamilton.h"

#include "base/union_find.h"
#include "mech/lagrange.h"
#include "sym/diff.h"
#include "sym/simplify.h"

enum { BLOCK_MOST = 3, OPS_MOST = 120, SHORT_MOST = 24 };

typedef struct {
  Eqns *e;
  ExprGraph *g;
  Arena *arena;
  uint32_t n;
  const Entries *form; /* the matrix to invert: M, or d2H/dp2 */
  SymId *q, *v, *p;
  Expr *inverse, *a, *rate, *force;
} LegendreTransform;

static Expr node(const LegendreTransform *w, SymId s) { return expr_symbol(w->g, s)->node; }
static Expr mul3(const LegendreTransform *w, Expr a, Expr b, Expr c) { return expr_mul(w->g, a, expr_mul(w->g, b, c)); }

/* --- the inverse of M --- */

static Expr minor2(const LegendreTransform *w, const Expr *m, uint32_t n, uint32_t r1, uint32_t r2, uint32_t c1,
                   uint32_t c2) {
  Expr a = expr_mul(w->g, m[r1 * n + c1], m[r2 * n + c2]), b = expr_mul(w->g, m[r1 * n + c2], m[r2 * n + c1]);
  return simplify(w->g, expr_sub(w->g, a, b));
}

/* Cofactor of element (i, j) of m[n*n], n up to 3. */
static Expr cofactor(const LegendreTransform *w, const Expr *m, uint32_t n, uint32_t i, uint32_t j) {
  if (n == 1) return expr_int(w->g, 1);
  if (n == 2) return (i + j) % 2 ? expr_neg(w->g, m[(1 - i) * 2 + (1 - j)]) : m[(1 - i) * 2 + (1 - j)];
  return minor2(w, m, 3, (i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3); /* cyclic: the sign is in it */
}

/* Inverse of the block of the n coordinates in at. 0: the block is singular, or an entry takes more than OPS_MOST
 * operations. */
static int invert_block(LegendreTransform *w, const uint32_t *at, uint32_t n) {
  ExprGraph *g = w->g;
  Expr m[BLOCK_MOST * BLOCK_MOST], det = expr_int(g, 0);
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t j = 0; j < n; j++) m[i * n + j] = simplify(g, entries_at(g, w->form, at[i], at[j]));
  for (uint32_t j = 0; j < n; j++) det = expr_add(g, det, expr_mul(g, m[j], cofactor(w, m, n, 0, j)));
  det = simplify(g, det);
  if (expr_is_zero(g, det)) return 0;
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t j = 0; j < n; j++) {
      Expr x = simplify(g, expr_div(g, cofactor(w, m, n, j, i), det));
      w->inverse[at[i] * w->n + at[j]] = x;
      if (expr_ops(g, &x, 1) > OPS_MOST) return 0;
    }
  return 1;
}

/* what: "the mass matrix", for messages. */
static const char *invert(LegendreTransform *w, const char *what) {
  uint32_t *block = union_find_new(w->arena, w->n); /* connected components of the matrix */
  for (uint32_t k = 0; k < w->form->n; k++) union_find_join(block, w->form->at[k].row, w->form->at[k].col);
  const Expr zero = expr_int(w->g, 0);
  for (size_t i = 0; i < (size_t)w->n * w->n; i++) w->inverse[i] = zero;
  for (uint32_t i = 0; i < w->n; i++) {
    uint32_t at[BLOCK_MOST], n = 0;
    if (union_find_root(block, i) != i) continue;
    for (uint32_t k = i; k < w->n; k++) {
      if (union_find_root(block, k) != i) continue;
      if (n == BLOCK_MOST)
        return arena_printf(w->arena, "%s couples more than three coordinates, too many for an inverse in closed form",
                            what);
      at[n++] = k;
    }
    if (!invert_block(w, at, n)) return arena_printf(w->arena, "the inverse of %s is too long in closed form", what);
  }
  return NULL;
}

/* --- H --- */

/* x at q' = 0; definitions with velocities are expanded. */
static Expr at_rest(const LegendreTransform *w, Expr x) {
  if (!(expr_kinds(w->g, x) & 1u << SYM_VEL)) return x;
  Expr *zero = ARENA_ARRAY(w->arena, Expr, w->n + 1);
  zero[0] = expr_int(w->g, 0);
  for (uint32_t i = 1; i < w->n; i++) zero[i] = zero[0];
  return expr_replace(w->g, expr_expand_defs(w->g, x), w->v, zero, w->n);
}

/* V = -L at rest, term by term; terms without velocities stay as written. */
static Expr potential(const LegendreTransform *w) {
  ExprGraph *g = w->g;
  Expr L = w->e->m->lagrangian;
  VEC(Expr) terms = {0};
  for (ExprPair term = {0}; expr_next_pair(g, L, EX_SUM, &term);) {
    Expr rest = at_rest(w, term.of);
    if (rest != term.of) rest = simplify(g, rest);
    vec_push(w->arena, &terms, expr_scale(g, num_neg(term.num), rest));
  }
  return expr_add_n(g, terms.at, terms.n);
}

static Expr short_form(const LegendreTransform *w, Expr x) { return w->n <= SHORT_MOST ? simplify(w->g, x) : x; }

/* Derivatives of x by all coordinates in one sweep. NULL: each is made alone, which reads best, as there are few, or x
 * has definitions, whose derivatives the sweep would name. */
static Expr *swept_slopes(const LegendreTransform *w, Expr x) {
  if (w->n <= SHORT_MOST || expr_expand_defs(w->g, x) != x) return NULL;
  Expr *to = ARENA_ARRAY(w->arena, Expr, w->n + 1);
  expr_gradient(w->g, x, w->q, w->n, to);
  return to;
}

static Expr slope(const LegendreTransform *w, const Expr *swept, Expr x, uint32_t i) {
  return swept ? swept[i] : expr_diff(w->g, x, w->q[i]);
}

static Hamilton hamilton_equations(LegendreTransform *w) {
  ExprGraph *g = w->g;
  const Constraints *k = &w->e->constraints;
  Expr *u = ARENA_ARRAY(w->arena, Expr, w->n + 1), V = potential(w);
  VEC(Expr) terms = {0};
  for (uint32_t i = 0; i < w->n; i++) {
    w->a[i] = short_form(w, at_rest(w, w->e->p[i]));
    u[i] = expr_sub(g, node(w, w->p[i]), w->a[i]);
  }
  for (uint32_t i = 0; i < w->n; i++) {
    Expr rate = expr_int(g, 0);
    for (uint32_t j = 0; j < w->n; j++) {
      Expr x = w->inverse[i * w->n + j];
      if (expr_is_zero(g, x)) continue;
      rate = expr_add(g, rate, expr_mul(g, x, u[j]));
      if (j <= i) vec_push(w->arena, &terms, expr_scale(g, num_ratio(i == j ? 1 : 2, 2), mul3(w, x, u[i], u[j])));
    }
    w->rate[i] = short_form(w, rate);
  }
  Expr kinetic = expr_add_n(g, terms.at, terms.n), H = expr_add(g, short_form(w, kinetic), V);
  const Expr *of_kinetic = swept_slopes(w, kinetic), *of_V = swept_slopes(w, V);
  for (uint32_t i = 0; i < w->n; i++) {
    Expr force = expr_neg(g, slope(w, of_kinetic, kinetic, i)), pull = expr_neg(g, slope(w, of_V, V, i)),
         other = expr_replace(g, w->e->Q[i], w->v, w->rate, w->n);
    for (uint32_t x = 0; x < k->A.n; x++)
      if (k->A.at[x].col == i) {
        Expr lambda = node(w, k->of[k->A.at[x].row]->multiplier),
             A = expr_replace(g, k->A.at[x].e, w->v, w->rate, w->n);
        other = expr_add(g, other, expr_mul(g, A, lambda));
      }
    force = expr_add(g, short_form(w, force), short_form(w, pull));
    w->force[i] = expr_add(g, force, short_form(w, other));
  }
  return (Hamilton){1, NULL, w->p, H, w->rate, w->force};
}

static int is_quadratic(const Eqns *e) {
  for (uint32_t k = 0; k < e->mass.n; k++)
    if (expr_kinds(e->g, e->mass.at[k].e) & 1u << SYM_VEL) return 0;
  return 1;
}

Hamilton hamilton_derive(Eqns *e) {
  Arena *a = e->m->arena;
  LegendreTransform w = {.e = e, .g = e->g, .arena = a, .n = e->n};
  size_t n = e->n, nn = n * n;
  if (!e->mass_known) eqns_derive_mass(e);
  w.q = eqns_symbols(e, 0), w.v = eqns_symbols(e, 1), w.p = ARENA_ARRAY(a, SymId, n + 1);
  w.a = ARENA_ARRAY(a, Expr, n + 1), w.rate = ARENA_ARRAY(a, Expr, n + 1), w.force = ARENA_ARRAY(a, Expr, n + 1);
  w.inverse = ARENA_ARRAY(a, Expr, nn + 1);
  w.form = &e->mass;
  for (uint32_t i = 0; i < e->n; i++)
    w.p[i] = expr_declare(e->g, SYM_LOCAL, i, arena_printf(a, "p_%s", e->m->coords.at[i].name), SIGN_UNKNOWN);
  Hamilton open = {.p = w.p, .why_not = is_quadratic(e) ? NULL : "L is not quadratic in velocities"};
  if (e->m->regularising) open.why_not = "the components of a rotation are not independent";
  if (e->singular_mass && !open.why_not) open.why_not = "the mass matrix is singular";
  if (!open.why_not) open.why_not = invert(&w, "the mass matrix");
  return open.why_not ? open : hamilton_equations(&w);
}

/* --- back from H to L --- */

static int is_one_of(const Symbol *s, const void *data) {
  const LegendreTransform *w = data;
  for (uint32_t i = 0; i < w->n; i++)
    if (expr_symbol(w->g, w->p[i]) == s) return 1;
  return 0;
}

/* x at p = 0. */
static Expr without_momenta(const LegendreTransform *w, Expr x) {
  Expr *zero = ARENA_ARRAY(w->arena, Expr, w->n + 1);
  for (uint32_t i = 0; i < w->n; i++) zero[i] = expr_int(w->g, 0);
  return simplify(w->g, expr_replace(w->g, x, w->p, zero, w->n));
}

/* Determinant of the form, of up to three coordinates. */
static Expr determinant(const LegendreTransform *w) {
  ExprGraph *g = w->g;
  Expr m[BLOCK_MOST * BLOCK_MOST], det = expr_int(g, 0);
  for (uint32_t i = 0; i < w->n; i++)
    for (uint32_t j = 0; j < w->n; j++) m[i * w->n + j] = entries_at(g, w->form, i, j);
  for (uint32_t j = 0; j < w->n; j++) det = expr_add(g, det, expr_mul(g, m[j], cofactor(w, m, w->n, 0, j)));
  return simplify(g, det);
}

/* d2H/dp2, and the rates dH/dp. */
static Entries momentum_hessian(LegendreTransform *w, Expr H) {
  Entries W = {0};
  expr_gradient(w->g, H, w->p, w->n, w->rate);
  for (uint32_t i = 0; i < w->n; i++)
    for (uint32_t j = 0; j <= i; j++) {
      Expr x = simplify(w->g, expr_diff(w->g, w->rate[i], w->p[j]));
      if (!expr_is_zero(w->g, x)) vec_push(w->arena, &W, ((MassEntry){i, j, x}));
    }
  return W;
}

/* p = W^-1 (q' - b), L = (q' - b) W^-1 (q' - b)/2 - H(q, 0, t), by degree in q'. */
static void put_lagrangian(const LegendreTransform *w, Expr H, InverseLegendre *out) {
  ExprGraph *g = w->g;
  Expr *b = ARENA_ARRAY(w->arena, Expr, w->n + 1), *p = ARENA_ARRAY(w->arena, Expr, w->n + 1), parts[3];
  for (int k = 0; k < 3; k++) parts[k] = expr_int(g, 0);
  for (uint32_t i = 0; i < w->n; i++) b[i] = without_momenta(w, w->rate[i]);
  for (uint32_t i = 0; i < w->n; i++) {
    Expr sum = expr_int(g, 0), vi = node(w, w->v[i]);
    for (uint32_t j = 0; j < w->n; j++) {
      Expr x = w->inverse[i * w->n + j], vj = node(w, w->v[j]), u = expr_sub(g, vj, b[j]);
      sum = expr_add(g, sum, expr_mul(g, x, u));
      parts[0] = expr_add(g, parts[0], expr_scale(g, num_ratio(1, 2), mul3(w, x, vi, vj)));
      parts[1] = expr_sub(g, parts[1], mul3(w, x, b[i], vj));
      parts[2] = expr_add(g, parts[2], expr_scale(g, num_ratio(1, 2), mul3(w, x, b[i], b[j])));
    }
    p[i] = short_form(w, sum);
  }
  parts[2] = expr_sub(g, parts[2], without_momenta(w, H));
  for (int k = 0; k < 3; k++) parts[k] = short_form(w, parts[k]);
  out->p = p;
  out->L = expr_add_n(g, parts, 3);
}

InverseLegendre lagrangian_derive(Eqns *e) {
  Arena *a = e->m->arena;
  LegendreTransform w = {.e = e, .g = e->g, .arena = a, .n = e->m->pairs.n};
  InverseLegendre out = {0};
  w.p = ARENA_ARRAY(a, SymId, w.n + 1), w.v = ARENA_ARRAY(a, SymId, w.n + 1), w.rate = ARENA_ARRAY(a, Expr, w.n + 1);
  w.inverse = ARENA_ARRAY(a, Expr, (size_t)w.n * w.n + 1);
  for (uint32_t i = 0; i < w.n; i++) {
    w.p[i] = e->m->states.at[e->m->pairs.at[i].p].z;
    w.v[i] = e->m->states.at[e->m->pairs.at[i].q].rate;
  }
  Expr H = expr_expand_defs(e->g, e->energy);
  Entries W = momentum_hessian(&w, H);
  w.form = &W;
  if (w.n <= BLOCK_MOST) out.det = determinant(&w);
  if (out.det && expr_is_zero(e->g, out.det))
    out.why_not = "det d2H/dp2 = 0 in every state: velocities do not determine the momenta";
  for (uint32_t k = 0; k < W.n && !out.why_not; k++)
    if (expr_contains(e->g, W.at[k].e, is_one_of, &w)) out.why_not = "H is not quadratic in the momenta";
  if (!out.why_not) out.why_not = invert(&w, "d2H/dp2");
  if (!out.why_not) put_lagrangian(&w, H, &out);
  return out;
}
