/* Terms k/|r_i - r_j| and k/|r| of L, and the bodies that they tell. The coupling of a pair is read off W = sum of k_ij
 * s_i s_j, which is L with s_i s_j in place of 1/|r_i - r_j|: its gradient by s is short for a sum over pairs, too. */
#include "mech/kepler_part.h"

#include "sym/diff.h"
#include "sym/sum_nest.h"

enum { MOST_DIM = 3 };

/* Places of a distance: the coordinates of one body, or of two. */
typedef struct {
  uint32_t n, of;                  /* components; bodies, 1 or 2 */
  const Symbol *at[2][MOST_DIM];
} Distance;

typedef struct {
  Expr of, factor;
} Term;
typedef VEC(Term) Terms;

typedef struct {
  const Eqns *e;
  ExprGraph *g;
  uint32_t dim, *body_of;          /* by coordinate: number of its body, from 1 */
  VEC(uint32_t) at;
  VEC(Expr) parts;                 /* of W */
  int centres; /* some distance is from the origin */
  const char *why;
} Finder;

static int by_index(const Symbol *a, const Symbol *b) { return a->index < b->index; }

/* Whether d is a coordinate, or the difference of two: component c of x. */
static int read_component(const ExprGraph *g, Expr d, Distance *x, uint32_t c) {
  const uint32_t of = expr_pairs(g, d, EX_SUM);
  Num sum = num_int(0);
  if (of > 2 || (c && of != x->of)) return 0;
  for (uint32_t k = 0; k < of; k++) {
    Num factor;
    Expr s = expr_pair(g, d, EX_SUM, k, &factor);
    if (expr_op(g, s) != EX_SYM || expr_sym_of(g, s)->kind != SYM_COORD || !num_is_one(num_mul(factor, factor)))
      return 0;
    x->at[k][c] = expr_sym_of(g, s);
    sum = num_add(sum, factor);
  }
  if (of == 2 && by_index(x->at[1][c], x->at[0][c])) {
    const Symbol *first = x->at[0][c];
    x->at[0][c] = x->at[1][c], x->at[1][c] = first;
  }
  x->of = of;
  return of == 1 || num_sign(sum) == 0;
}

/* Whether s is the square of a distance between two bodies, or of a body from the origin. */
static int read_distance(const ExprGraph *g, Expr s, Distance *x) {
  x->n = expr_pairs(g, s, EX_SUM);
  if (x->n < 2 || x->n > MOST_DIM) return 0;
  for (uint32_t c = 0; c < x->n; c++) {
    Num factor, power;
    Expr square = expr_pair(g, s, EX_SUM, c, &factor);
    if (!num_is_one(factor) || expr_pairs(g, square, EX_PROD) != 1) return 0;
    Expr d = expr_pair(g, square, EX_PROD, 0, &power);
    if (!num_equal(power, num_int(2)) || !read_component(g, d, x, c)) return 0;
  }
  for (uint32_t k = 0; k < x->of; k++) /* components in the order of the coordinates */
    for (uint32_t c = 1; c < x->n; c++)
      for (uint32_t i = c; i && by_index(x->at[k][i], x->at[k][i - 1]); i--) {
        const Symbol *later = x->at[k][i - 1];
        x->at[k][i - 1] = x->at[k][i], x->at[k][i] = later;
      }
  return 1;
}

/* Splits a term of L: k/|distance| into k and the distance; a constant times a sum into new terms. 0: something
 * else. */
static int read_term(Finder *f, Term t, Distance *x, Expr *k, Terms *more) {
  ExprGraph *g = f->g;
  Expr rest = t.factor, sum = 0;
  int found = 0;
  for (ExprPair p = {0}; expr_next_pair(g, t.of, EX_PROD, &p);) {
    if (!found && num_equal(p.num, num_ratio(-1, 2)) && read_distance(g, p.of, x)) found = 1;
    else if (!sum && num_is_one(p.num) && expr_op(g, p.of) == EX_SUM && !expr_is_constant(g, p.of)) sum = p.of;
    else rest = expr_mul(g, rest, expr_pow_num(g, p.of, p.num));
  }
  if (!expr_is_constant(g, rest) || found == (sum != 0)) return 0;
  *k = rest;
  for (ExprPair p = {0}; sum && expr_next_pair(g, sum, EX_SUM, &p);) {
    Term part = {p.of, expr_scale(g, p.num, rest)};
    vec_push(f->e->m->arena, more, part);
  }
  return found;
}

/* k/|distance| with s_i s_j, or s_i, in place of 1/|distance|. */
static Expr marked(Finder *f, Expr k, const Distance *x) {
  for (uint32_t b = 0; b < x->of; b++) k = expr_mul(f->g, k, x->at[b][0]->node);
  f->centres |= x->of == 1;
  return k;
}

static void add_body(Finder *f, const uint32_t *at, uint32_t dim) {
  const uint32_t number = f->body_of[at[0]];
  f->why = f->dim && f->dim != dim ? "distances have different numbers of components" : f->why;
  f->dim = dim;
  for (uint32_t c = 0; c < dim && !f->why; c++)
    if (f->body_of[at[c]] != number || (number && f->at.at[(number - 1) * dim + c] != at[c]))
      f->why = "coordinates belong to different bodies in different distances";
  for (uint32_t c = 0; c < dim && !f->why && !number; c++) {
    vec_push(f->e->m->arena, &f->at, at[c]);
    f->body_of[at[c]] = f->at.n / dim + (f->at.n % dim != 0);
  }
}

static void add_bodies(Finder *f, const Distance *x) {
  for (uint32_t b = 0; b < x->of; b++) {
    uint32_t at[MOST_DIM];
    for (uint32_t c = 0; c < x->n; c++) at[c] = x->at[b][c]->index;
    add_body(f, at, x->n);
  }
}

/* Subscript of the argument that a coordinate of a body of a sum stands for. */
static const Subscript *subscript_of(const ExprGraph *g, const SumNest *s, const Symbol *x) {
  for (uint32_t r = 0; r < s->nreads; r++)
    if (expr_symbol(g, s->reads[r].symbol) == x) return &s->reads[r].at;
  return NULL;
}

/* The bodies that body b of the distance stands for in all turns; 0: an argument is no coordinate. */
static int add_members(Finder *f, Expr nest, const Distance *x, uint32_t b) {
  const SumNest *s = expr_sum_nest(f->g, nest);
  int64_t least, most, shift[MOST_DIM];
  const Subscript *first = subscript_of(f->g, s, x->at[b][0]), *at = first;
  for (uint32_t c = 0; c < x->n && at; c++) {
    at = subscript_of(f->g, s, x->at[b][c]);
    if (!at || at->by_row != first->by_row || at->by_turn != first->by_turn) return 0;
    shift[c] = at->first - first->first;
  }
  const int64_t step = at ? subscript_step(at) : 0;
  if (!at || !loop_extent(&s->range, first, &least, &most)) return 0;
  for (int64_t k = least; k <= most; k += step ? step : 1) {
    uint32_t index[MOST_DIM];
    for (uint32_t c = 0; c < x->n; c++) {
      Expr arg = expr_sum_arg(f->g, nest, (uint32_t)(k + shift[c]));
      if (expr_op(f->g, arg) != EX_SYM || expr_sym_of(f->g, arg)->kind != SYM_COORD) return 0;
      index[c] = expr_sym_of(f->g, arg)->index;
    }
    add_body(f, index, x->n);
  }
  return 1;
}

static void push_terms(Finder *f, Expr sum, Terms *to) {
  for (ExprPair p = {0}; expr_next_pair(f->g, sum, EX_SUM, &p);) {
    Term t = {p.of, expr_num(f->g, p.num)};
    vec_push(f->e->m->arena, to, t);
  }
}

/* Terms of the body of a sum over pairs: they make another sum. */
static void read_sum(Finder *f, Expr cell, Expr factor) {
  Expr nest = expr_cell_nest(f->g, cell), body = expr_int(f->g, 0), k;
  SumNest s = *expr_sum_nest(f->g, nest);
  Terms terms = {0};
  Distance x;
  if (s.near || s.ncells != 1) return;
  push_terms(f, expr_expand_defs(f->g, s.shares[0].value), &terms);
  for (uint32_t i = 0; i < terms.n; i++) {
    if (!read_term(f, terms.at[i], &x, &k, &terms)) continue;
    int known = 1;
    for (uint32_t b = 0; b < x.of; b++) known &= add_members(f, nest, &x, b);
    if (known) body = expr_add(f->g, body, marked(f, k, &x));
  }
  if (expr_is_zero(f->g, body)) return;
  NestShare share = {body, s.shares[0].at};
  Expr *args = ARENA_ARRAY(f->e->m->arena, Expr, s.nargs + 1);
  for (uint32_t i = 0; i < s.nargs; i++) args[i] = expr_sum_arg(f->g, nest, i);
  NestShare *shares = ARENA_NEW(f->e->m->arena, NestShare);
  *shares = share;
  s.shares = shares, s.slopes = NULL, s.far = NULL;
  Expr sum = expr_mul(f->g, factor, expr_sum_cell(f->g, &s, args, 0));
  vec_push(f->e->m->arena, &f->parts, sum);
}

static void read_lagrangian(Finder *f) {
  Terms terms = {0};
  Distance x;
  Expr k;
  push_terms(f, expr_expand_defs(f->g, f->e->lagrangian), &terms);
  for (uint32_t i = 0; i < terms.n && !f->why; i++) {
    const Term t = terms.at[i];
    if (expr_kinds(f->g, t.of) & 1u << SYM_VEL) continue;
    if (expr_op(f->g, t.of) == EX_CELL) {
      if (expr_is_constant(f->g, t.factor)) read_sum(f, t.of, t.factor);
    } else if (read_term(f, t, &x, &k, &terms)) {
      add_bodies(f, &x);
      Expr part = marked(f, k, &x);
      vec_push(f->e->m->arena, &f->parts, part);
    }
  }
}

/* Masses: one to each body, without products of velocities. */
static const Expr *masses(Finder *f) {
  const Eqns *e = f->e;
  const Entries *M = e->mass_known ? &e->mass : &e->system.H;
  Expr *of = ARENA_ARRAY(e->m->arena, Expr, e->n + 1);
  for (uint32_t k = 0; k < M->n && !f->why; k++) {
    const uint32_t body = f->body_of[M->at[k].row] - 1;
    if (M->at[k].row != M->at[k].col) f->why = "velocities of different coordinates occur in one product";
    else if (of[body] && of[body] != M->at[k].e) f->why = "the coordinates of a body have different masses";
    of[body] = M->at[k].e;
  }
  return of;
}

static const Expr *couplings(Finder *f, uint32_t bodies) {
  const Eqns *e = f->e;
  Expr *of = ARENA_ARRAY(e->m->arena, Expr, bodies + 1), W = expr_add_n(f->g, f->parts.at, f->parts.n);
  SymId *by = ARENA_ARRAY(e->m->arena, SymId, bodies + 1);
  for (uint32_t i = 0; i < bodies; i++) by[i] = e->m->coords.at[f->at.at[i * f->dim]].q;
  expr_gradient(f->g, W, by, bodies, of);
  return of;
}

const char *kepler_part(const Eqns *e, KeplerPart *out) {
  Finder f = {.e = e, .g = e->g, .body_of = ARENA_ARRAY(e->m->arena, uint32_t, e->n + 1)};
  if (!e->separable || !e->n || !e->lagrangian) return "forces depend on velocities, or masses on positions";
  if (!e->mass_known && e->system.ndefs) return "velocities of different coordinates occur in one product";
  read_lagrangian(&f);
  if (f.why) return f.why;
  if (!f.parts.n) return "the potential has no term -k/r of a distance in Cartesian coordinates";
  for (uint32_t i = 0; i < e->n; i++)
    if (!f.body_of[i])
      return arena_printf(e->m->arena, "no term -k/r contains the coordinate `%s`", e->m->coords.at[i].name);
  const Expr *mass = masses(&f);
  if (f.why) return f.why;
  uint32_t bodies = f.at.n / f.dim;
  *out = (KeplerPart){bodies, f.dim, f.centres, f.at.at, mass, couplings(&f, bodies)};
  return NULL;
}
