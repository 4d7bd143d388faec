/* The order in which pairs come off, Levi-Civita's conditions by sym/prove.h, and the separated equations. */
#include "phase_space/separability.h"

#include "sym/diff.h"
#include "sym/prove.h"
#include "sym/simplify.h"

typedef struct {
  ExprGraph *g;
  const PhaseSpace *s;
  Expr *Hq, *Hp;  /* [n] */
  uint8_t *done;  /* [n] */
  uint32_t *order, count;
  PairKind *kind;
  Expr *left, *right;
  Expr H;         /* with constants for the pairs that have come off; 0: they have no closed form */
} Splitter;

/* --- which pairs come off --- */

static int is_free_of(const Splitter *w, Expr x, SymId s) {
  return !expr_contains_sym(w->g, x, s) || prove_zero(w->g, expr_diff(w->g, x, s), NULL) == PROVED_ZERO;
}

static int is_free_of_pair(const Splitter *w, Expr x, uint32_t i) {
  return is_free_of(w, x, w->s->q[i]) && is_free_of(w, x, w->s->p[i]);
}

/* Whether x is free of all other pairs: of those that are left, or of all. */
static int stands_alone(const Splitter *w, Expr x, uint32_t i, int of_all) {
  for (uint32_t j = 0; j < w->s->n; j++)
    if (j != i && (of_all || !w->done[j]) && !is_free_of_pair(w, x, j)) return 0;
  return 1;
}

/* The next pair with a curve of its own; n: none. */
static uint32_t next_pair(const Splitter *w) {
  for (uint32_t i = 0; i < w->s->n; i++)
    if (!w->done[i] && !expr_is_zero(w->g, w->Hp[i]) && stands_alone(w, expr_div(w->g, w->Hq[i], w->Hp[i]), i, 0))
      return i;
  return w->s->n;
}

static void take_off(Splitter *w, uint32_t i, PairKind kind) {
  w->kind[i] = kind;
  w->order[w->count++] = i;
  w->done[i] = 1;
}

static Expr levi_civita(const Splitter *w, uint32_t i, uint32_t j) {
  ExprGraph *g = w->g;
  const SymId *q = w->s->q, *p = w->s->p;
  const Expr *Hq = w->Hq, *Hp = w->Hp;
  const Expr factor[4][3] = {{Hp[i], Hp[j], expr_diff(g, Hq[i], q[j])},
                             {Hq[i], Hq[j], expr_diff(g, Hp[i], p[j])},
                             {Hp[i], Hq[j], expr_diff(g, Hq[i], p[j])},
                             {Hq[i], Hp[j], expr_diff(g, Hp[i], q[j])}};
  Expr sum = expr_int(g, 0);
  for (int k = 0; k < 4; k++) {
    Expr two = expr_mul(g, factor[k][0], factor[k][1]), three = expr_mul(g, two, factor[k][2]);
    sum = k < 2 ? expr_add(g, sum, three) : expr_sub(g, sum, three);
  }
  return sum;
}

/* Judges the conditions of the pairs that are left. Without dH/dp they say nothing: the equation of p cannot be
 * solved for it. */
static int conditions_hold(const Splitter *w, Separation *out) {
  for (uint32_t i = 0; i < w->s->n; i++)
    if (!w->done[i] && expr_is_zero(w->g, w->Hp[i])) {
      out->i = out->j = i, out->refuted = 1;
      return 0;
    }
  for (uint32_t i = 0; i < w->s->n; i++)
    for (uint32_t j = i + 1; j < w->s->n && !w->done[i]; j++) {
      Verdict v = w->done[j] ? PROVED_ZERO : prove_zero(w->g, levi_civita(w, i, j), NULL);
      if (v == PROVED_ZERO) continue;
      out->i = i, out->j = j, out->refuted = v == PROVED_NONZERO;
      return 0;
    }
  return 1;
}

/* --- separated equations --- */

typedef VEC(Expr) Terms;

/* The terms of x, products with one sum multiplied out. */
static Terms terms_of(const Splitter *w, Expr x) {
  enum { TERMS_MOST = 200 };
  Arena *a = expr_arena(w->g);
  Terms open = {0}, out = {0};
  vec_push(a, &open, x);
  for (uint32_t k = 0; k < open.n; k++) {
    Num c, power;
    Expr whole = open.at[k], y = whole, sum = expr_op(w->g, y) == EX_SUM && expr_pairs(w->g, y, EX_SUM) > 1 ? y : 0;
    if (!sum && expr_op(w->g, y) == EX_SUM) y = expr_pair(w->g, y, EX_SUM, 0, &c);
    for (uint32_t i = 0; !sum && i < expr_pairs(w->g, y, EX_PROD); i++) {
      Expr base = expr_pair(w->g, y, EX_PROD, i, &power);
      if (num_is_one(power) && expr_op(w->g, base) == EX_SUM) sum = base;
    }
    if (!sum || open.n > TERMS_MOST) {
      vec_push(a, &out, whole);
      continue;
    }
    Expr rest = expr_div(w->g, whole, sum);
    for (uint32_t i = 0; i < expr_pairs(w->g, sum, EX_SUM); i++) {
      Expr part = expr_pair(w->g, sum, EX_SUM, i, &c), scaled = expr_scale(w->g, c, part);
      vec_push(a, &open, expr_mul(w->g, rest, scaled));
    }
  }
  return out;
}

static int mentions(const Splitter *w, Expr x, uint32_t i) {
  return expr_contains_sym(w->g, x, w->s->q[i]) || expr_contains_sym(w->g, x, w->s->p[i]);
}

/* x with q = p = 1 of a pair. */
static Expr held(const Splitter *w, Expr x, uint32_t i) {
  const SymId of[2] = {w->s->q[i], w->s->p[i]};
  const Expr one[2] = {expr_int(w->g, 1), expr_int(w->g, 1)};
  return expr_replace(w->g, x, of, one, 2);
}

static Expr constant_of(const Splitter *w, uint32_t i) {
  Name name = arena_printf(expr_arena(w->g), "alpha_%s", expr_symbol(w->g, w->s->q[i])->name);
  return expr_symbol(w->g, expr_declare(w->g, SYM_LOCAL, i, name, SIGN_UNKNOWN))->node;
}

static Expr energy_of(const Splitter *w) { return expr_symbol(w->g, w->s->e->m->energy_sym)->node; }

/* The equation of a pair with a curve of its own: the terms of H with it are a factor times G, and G = alpha is put
 * into H. */
static void equation_alone(Splitter *w, uint32_t i) {
  ExprGraph *g = w->g;
  Expr with = expr_int(g, 0), G;
  Terms t = terms_of(w, w->H);
  for (uint32_t k = 0; k < t.n; k++)
    if (mentions(w, t.at[k], i)) with = expr_add(g, with, t.at[k]);
  G = with;
  for (uint32_t j = 0; j < w->s->n; j++)
    if (j != i && !w->done[j]) G = held(w, G, j);
  G = simplify(g, G);
  Expr factor = expr_div(g, with, G), alpha = constant_of(w, i);
  if (expr_is_constant(g, G) || !is_free_of_pair(w, factor, i)) {
    w->H = 0;
    return;
  }
  w->left[i] = G, w->right[i] = alpha;
  Expr kept = simplify(g, held(w, factor, i)), by_alpha = expr_mul(g, kept, alpha), rest = expr_sub(g, w->H, with);
  w->H = simplify(g, expr_add(g, rest, by_alpha));
}

/* T = Ti + Tj, each free of the other pair. 0: it has no such form. */
static int split(const Splitter *w, Expr T, uint32_t i, uint32_t j, Expr *Ti, Expr *Tj) {
  ExprGraph *g = w->g;
  Terms t = terms_of(w, T);
  *Ti = *Tj = expr_int(g, 0);
  Expr mixed = expr_int(g, 0);
  for (uint32_t k = 0; k < t.n; k++) {
    Expr x = simplify(g, t.at[k]);
    int has_i = mentions(w, x, i), has_j = mentions(w, x, j);
    if (has_i && has_j) mixed = expr_add(g, mixed, x);
    else if (has_j) *Tj = expr_add(g, *Tj, x);
    else *Ti = expr_add(g, *Ti, x);
  }
  mixed = simplify(g, mixed);
  Expr of_i = simplify(g, held(w, mixed, j)), of_j = simplify(g, expr_sub(g, mixed, of_i));
  if (!is_free_of_pair(w, of_j, i)) return 0;
  *Ti = simplify(g, expr_add(g, *Ti, of_i));
  *Tj = simplify(g, expr_add(g, *Tj, mentions(w, of_j, i) ? held(w, of_j, i) : of_j));
  return 1;
}

/* Two pairs that separate together, H quadratic in their momenta: mu (H - E) = Fi + Fj, mu from the ratio of the
 * inverse masses, which is a product. */
static void equations_of_two(Splitter *w, uint32_t i, uint32_t j) {
  ExprGraph *g = w->g;
  Expr mi = simplify(g, expr_diff(g, expr_diff(g, w->H, w->s->p[i]), w->s->p[i])),
       mj = simplify(g, expr_diff(g, expr_diff(g, w->H, w->s->p[j]), w->s->p[j]));
  if (expr_is_zero(g, mi) || expr_is_zero(g, mj)) return;
  Expr ratio = held(w, simplify(g, expr_div(g, mi, mj)), j), mu = simplify(g, expr_div(g, ratio, mi)),
       zero = expr_sub(g, w->H, energy_of(w)), Fi, Fj;
  Terms t = terms_of(w, zero);
  Expr sum = expr_int(g, 0), constant = constant_of(w, i);
  for (uint32_t k = 0; k < t.n; k++) sum = expr_add(g, sum, simplify(g, expr_mul(g, mu, t.at[k])));
  if (!split(w, sum, i, j, &Fi, &Fj)) return;
  w->left[i] = Fi, w->right[i] = constant;
  w->left[j] = Fj, w->right[j] = expr_neg(g, constant);
}

/* --- the whole --- */

static void separated_equations(Splitter *w) {
  uint32_t n = w->s->n, left[2] = {0}, nleft = 0;
  for (uint32_t i = 0; i < n; i++) {
    if (w->done[i]) continue;
    if (nleft < 2) left[nleft] = i;
    nleft++;
  }
  if (w->H && nleft == 2) equations_of_two(w, left[0], left[1]);
}

static void cyclic_off(Splitter *w) {
  for (uint32_t i = 0; i < w->s->n; i++) {
    if (prove_zero(w->g, w->Hq[i], NULL) != PROVED_ZERO) continue;
    w->left[i] = expr_symbol(w->g, w->s->p[i])->node;
    w->right[i] = constant_of(w, i);
    take_off(w, i, PAIR_CYCLIC);
  }
}

static void alone_off(Splitter *w, uint8_t *tangled) {
  uint32_t n = w->s->n;
  for (uint32_t i = next_pair(w); i < n; i = next_pair(w)) {
    tangled[i] = !(stands_alone(w, w->Hq[i], i, 1) && stands_alone(w, w->Hp[i], i, 1)) && w->count + 1 < n;
    if (w->count + 1 == n) w->left[i] = w->H, w->right[i] = energy_of(w);
    else if (w->H) equation_alone(w, i);
    take_off(w, i, PAIR_ALONE);
  }
}

Separation separation_of(const PhaseSpace *s) {
  ExprGraph *g = s->e->g;
  Arena *a = expr_arena(g);
  uint32_t n = s->n;
  Expr *by = ARENA_ARRAY(a, Expr, 4 * (size_t)n + 1);
  uint8_t *flags = ARENA_ARRAY(a, uint8_t, 2 * (size_t)n + 1), *tangled = flags + n;
  Splitter w = {.g = g,
                .s = s, .Hq = by, .Hp = by + n, .left = by + 2 * n, .right = by + 3 * n, .done = flags,
                .order = ARENA_ARRAY(a, uint32_t, n + 1), .kind = ARENA_ARRAY(a, PairKind, n + 1),
                .H = s->H};
  Separation out = {.n = n, .order = w.order, .kind = w.kind, .tangled = tangled, .left = w.left, .right = w.right};
  for (uint32_t i = 0; i < n; i++) {
    w.Hq[i] = simplify(g, expr_diff(g, s->H, s->q[i]));
    w.Hp[i] = simplify(g, expr_diff(g, s->H, s->p[i]));
  }
  cyclic_off(&w);
  alone_off(&w, tangled);
  out.separates = conditions_hold(&w, &out);
  if (out.separates) separated_equations(&w);
  for (uint32_t i = 0; i < n; i++) {
    if (w.done[i]) continue;
    tangled[i] = 1;
    take_off(&w, i, out.separates ? PAIR_STAECKEL : PAIR_TIED);
  }
  return out;
}
