/* Links of a guessed drawing, read from the graph: an arm l*sin(th), -l*cos(th) hangs on the sum of the other terms; a
 * distance in a constraint is a rod, one in a quadratic potential a spring; a gap linear in a point is a wall. */
#include <string.h>

#include "base/words.h"
#include "model/guess_drawing.h"

/* Body of a definition, or the expression itself. */
static Expr body_of(const ExprGraph *g, Expr e) {
  while (expr_op(g, e) == EX_DEF) e = expr_arg(g, e, 0);
  return e;
}

/* --- arms --- */

/* Argument of the first sine or cosine, of something that moves, in a term; 0: none. *length: the factor that changes
 * beside such, or 0. */
static Expr angle_of(const ExprGraph *g, Expr term, Expr *length) {
  Expr angle = 0;
  *length = 0;
  for (ExprPair f = {0}; expr_next_pair(g, term, EX_PROD, &f);) {
    ExprOp op = expr_op(g, f.of);
    int turns = (op == EX_SIN || op == EX_COS) && num_is_one(f.num) && changes(g, f.of);
    if (turns && !angle) angle = expr_arg(g, f.of, 0);
    else if (!turns && changes(g, f.of)) *length = f.of;
  }
  return angle;
}

enum { MOST_ARMS = 8 };

typedef struct {
  Expr angle[MOST_ARMS], arm[MOST_ARMS][3], rest[3];
  Expr length[MOST_ARMS]; /* what changes in it; 0: nothing */
  uint32_t n;
} Arms;

/* Sorts the terms of component c into arms and the rest. */
static void split_terms(ExprGraph *g, Expr value, uint32_t c, Arms *a) {
  Expr e = body_of(g, value);
  a->rest[c] = expr_int(g, 0);
  for (ExprPair term = {0}; expr_next_pair(g, e, EX_SUM, &term);) {
    Expr length, angle = angle_of(g, term.of, &length), *into = &a->rest[c];
    uint32_t j = 0;
    while (j < a->n && a->angle[j] != angle) j++;
    if (angle && j < MOST_ARMS) {
      if (j == a->n) a->angle[a->n++] = angle;
      if (length) a->length[j] = length;
      into = &a->arm[j][c];
    }
    Expr scaled = expr_scale(g, term.num, term.of);
    *into = *into ? expr_add(g, *into, scaled) : scaled;
  }
}

static Expr sum_or(ExprGraph *g, Expr a, Expr b) { return b ? expr_add(g, a, b) : a; }

/* Whether a square of the potential contains the length, or terms of it. */
static int is_stretched(Guess *k, Expr length) {
  const ExprGraph *g = k->d->b->g;
  Expr e = body_of(g, length);
  int found = expr_map_get(&k->stretched, length) != 0;
  for (ExprPair term = {0}; expr_next_pair(g, e, EX_SUM, &term);)
    found |= changes(g, term.of) && expr_map_get(&k->stretched, term.of);
  return found;
}

static void note_pivot(Guess *k, const Expr *at, uint32_t n) {
  DrawnPoint pivot = {.n = n};
  int moves = 0;
  for (uint32_t c = 0; c < n; c++) moves |= changes(k->d->b->g, pivot.at[c] = at[c]);
  if (moves) vec_push(k->d->b->arena, &k->pivots, pivot);
}

/* Pivots that keep their distance are on one beam. */
static void link_pivots(Guess *k) {
  ExprGraph *g = k->d->b->g;
  for (uint32_t i = 1; i < k->pivots.n; i++) {
    const DrawnPoint *a = &k->pivots.at[i - 1], *b = &k->pivots.at[i];
    int apart = 0, rigid = a->n == b->n;
    for (uint32_t c = 0; c < a->n && rigid; c++) {
      Expr d = expr_sub(g, b->at[c], a->at[c]);
      apart |= !expr_is_zero(g, d);
      rigid = !changes(g, d);
    }
    if (rigid && apart) add_link(k, SHAPE_ROD, "support", a->at, b->at, a->n);
  }
}

/* Links from the rest over each arm to the point. */
static void link_arms(Guess *k, const DrawnPoint *p, Arms *a) {
  ExprGraph *g = k->d->b->g;
  Expr from[3], to[3];
  for (uint32_t j = 0; j < a->n; j++) { /* an arm of one component only is no arm */
    int parts = 0;
    for (uint32_t c = 0; c < p->n; c++) parts += a->arm[j][c] != 0;
    for (uint32_t c = 0; c < p->n && parts < 2; c++) a->rest[c] = sum_or(g, a->rest[c], a->arm[j][c]);
    if (parts < 2) memset(a->arm[j], 0, sizeof a->arm[j]);
  }
  memcpy(from, a->rest, sizeof from);
  note_pivot(k, from, p->n);
  for (uint32_t j = 0; j < a->n; j++) {
    if (!a->arm[j][0] && !a->arm[j][1]) continue;
    int last = 1;
    for (uint32_t i = j + 1; i < a->n; i++) last &= !a->arm[i][0] && !a->arm[i][1];
    for (uint32_t c = 0; c < p->n; c++) to[c] = last ? p->at[c] : sum_or(g, from[c], a->arm[j][c]);
    if (!a->length[j]) add_link(k, SHAPE_ROD, "link", from, to, p->n);
    else if (is_stretched(k, a->length[j])) add_link(k, SHAPE_SPRING, "spring", from, to, p->n);
    memcpy(from, to, sizeof from);
  }
}

void guess_arms(Guess *k) {
  ExprGraph *g = k->d->b->g;
  vec_each(const DrawnPoint, p, k->points) {
    Arms a = {0};
    for (uint32_t c = 0; c < p->n; c++) split_terms(g, p->at[c], c, &a);
    if (a.n) link_arms(k, p, &a);
  }
  link_pivots(k);
}

/* --- distances --- */

/* Components whose squares a distance, or its square, adds; their number, 0: not a distance. */
static uint32_t distance_parts(const ExprGraph *g, Expr e, Expr out[3]) {
  uint32_t n = 0;
  Num k;
  e = body_of(g, e);
  if (expr_op(g, e) == EX_HYPOT) {
    out[0] = expr_arg(g, e, 0);
    out[1] = expr_arg(g, e, 1);
    return 2;
  }
  if (expr_op(g, e) == EX_PROD && expr_pairs(g, e, EX_PROD) == 1) e = expr_pair(g, e, EX_PROD, 0, &k);
  e = body_of(g, e);
  if (expr_op(g, e) != EX_SUM) return 0;
  for (uint32_t i = 0; i < expr_pairs(g, e, EX_SUM); i++) {
    Expr square = expr_pair(g, e, EX_SUM, i, &k);
    if (expr_op(g, square) != EX_PROD || expr_pairs(g, square, EX_PROD) != 1 || !num_is_one(k)) continue;
    Expr base = expr_pair(g, square, EX_PROD, 0, &k);
    if (!num_equal(k, num_int(2)) || !changes(g, base)) continue;
    if (n == 3) return 0;
    out[n++] = base;
  }
  return n;
}

/* Coefficient of x in the sum d; 0: not in it. */
static int sign_in(const ExprGraph *g, Expr d, Expr x) {
  for (ExprPair term = {0}; expr_next_pair(g, d, EX_SUM, &term);)
    if (term.of == x) return num_is_one(term.num) ? 1 : num_is_one(num_neg(term.num)) ? -1 : 0;
  return 0;
}

/* Other end of the distance from point p; 0: p is not one of its ends. */
static int other_end(ExprGraph *g, const DrawnPoint *p, const Expr *part, uint32_t n, Expr out[3]) {
  unsigned used = 0;
  if (p->n != n) return 0;
  for (uint32_t c = 0; c < n; c++) {
    uint32_t i = 0;
    int sign = 0;
    for (; i < n && !sign; i++) sign = used & 1u << i ? 0 : sign_in(g, part[i], p->at[c]);
    if (!sign) return 0;
    used |= 1u << (i - 1);
    Expr d = sign > 0 ? part[i - 1] : expr_neg(g, part[i - 1]);
    out[c] = expr_sub(g, p->at[c], d);
  }
  return 1;
}

/* Draws a link along a distance between points, or from a point to elsewhere. 1: drawn. */
static int link_distance(Guess *k, ShapeKind kind, const char *role, Expr e) {
  ExprGraph *g = k->d->b->g;
  Expr part[3], to[3];
  uint32_t n = distance_parts(g, e, part);
  for (uint32_t i = 0; i < k->points.n && n >= 2; i++) {
    if (!other_end(g, &k->points.at[i], part, n, to)) continue;
    add_link(k, kind, role, to, k->points.at[i].at, n);
    return 1;
  }
  return 0;
}

void guess_rods(Guess *k) {
  Builder *b = k->d->b;
  vec_each(const Constraint, c, b->m->constraints) {
    if (c->inside) continue;
    int done = link_distance(k, SHAPE_ROD, "link", c->c);
    Expr e = body_of(b->g, c->c);
    for (uint32_t j = 0; j < expr_pairs(b->g, e, EX_SUM) && !done; j++)
      done = link_distance(k, SHAPE_ROD, "link", expr_pair(b->g, e, EX_SUM, j, NULL));
  }
}

/* --- springs --- */

/* x2 - x1 - l, or x - l: a spring along the line of points; alone it is held at the left, of the last point at the
 * right. */
static void link_line(Guess *k, Expr base) {
  ExprGraph *g = k->d->b->g;
  const DrawnPoint *end[2] = {NULL, NULL};
  uint32_t n = 0, moving = 0;
  for (ExprPair term = {0}; expr_next_pair(g, base, EX_SUM, &term);) {
    if (!changes(g, term.of)) continue;
    moving++;
    for (uint32_t j = 0; j < k->points.n && n < 2; j++) {
      const DrawnPoint *p = &k->points.at[j];
      uint32_t c = p->n == 2 && expr_is_zero(g, p->at[0]) ? 1 : 0;
      if (p->n == 2 && expr_is_zero(g, p->at[1 - c]) && p->at[c] == term.of) end[n++] = p;
    }
  }
  if (!n || n != moving) return;
  int right = n == 1 && k->points.n > 1 && end[0] == &k->points.at[k->points.n - 1];
  const Expr *from = n == 2 || right ? end[0]->at : NULL, *to = right ? NULL : end[n - 1]->at;
  add_link(k, SHAPE_SPRING, "spring", from, to, 2);
}

/* Calls fn for the base of each square in the potential, or in L, in products without velocities. */
static void each_square(Guess *k, void (*fn)(Guess *k, Expr base)) {
  Builder *b = k->d->b;
  ExprGraph *g = b->g;
  Expr root = b->m->potential ? b->m->potential : b->m->lagrangian;
  ExprList all = expr_topo(g, &root, 1);
  for (uint32_t i = 0; i < all.n; i++) {
    Expr e = all.at[i];
    if (expr_op(g, e) != EX_PROD || (expr_kinds(g, e) & (1u << SYM_VEL | 1u << SYM_RATE))) continue;
    for (ExprPair base = {0}; expr_next_pair(g, e, EX_PROD, &base);)
      if (num_equal(base.num, num_int(2)) && changes(g, base.of)) fn(k, body_of(g, base.of));
  }
}

static void note_square(Guess *k, Expr base) {
  for (ExprPair term = {0}; expr_next_pair(k->d->b->g, base, EX_SUM, &term);) expr_map_set(&k->stretched, term.of, 1);
}

static void link_square(Guess *k, Expr base) {
  ExprGraph *g = k->d->b->g;
  uint32_t n = expr_pairs(g, base, EX_SUM);
  int done = 0;
  for (uint32_t i = 0; i < n && !done && n <= 3; i++)
    done = link_distance(k, SHAPE_SPRING, "spring", expr_pair(g, base, EX_SUM, i, NULL));
  if (!done) link_line(k, base);
}

void guess_springs(Guess *k) { each_square(k, link_square); }
void note_squares(Guess *k) { each_square(k, note_square); }

/* --- walls --- */

/* The constant terms of a gap, and the radius of the body in them: y - r. */
static Expr constant_part(Guess *k, Expr gap, Expr *radius, double *times) {
  ExprGraph *g = k->d->b->g;
  Expr rest = expr_int(g, 0);
  *radius = 0;
  for (ExprPair term = {0}; expr_next_pair(g, gap, EX_SUM, &term);) {
    if (changes(g, term.of)) continue;
    int is_radius = expr_op(g, term.of) == EX_SYM && has_word("r R a radius rad", expr_sym_of(g, term.of)->name);
    if (is_radius && num_value(term.num) < 0) {
      *radius = term.of;
      *times = -num_value(term.num);
    } else {
      rest = expr_add(g, rest, expr_scale(g, term.num, term.of));
    }
  }
  return rest;
}

/* Direction of a gap that is linear in a point; 0: it does not contain the point. */
static int normal_of(ExprGraph *g, Expr gap, const DrawnPoint *p, Expr n[3]) {
  int found = 0;
  for (uint32_t c = 0; c < p->n; c++) {
    n[c] = expr_int(g, 0);
    for (ExprPair term = {0}; expr_next_pair(g, gap, EX_SUM, &term);) {
      Expr over = expr_div(g, term.of, p->at[c]);
      if (!changes(g, p->at[c]) || !changes(g, term.of) || changes(g, over)) continue;
      n[c] = expr_add(g, n[c], expr_scale(g, term.num, over));
      found = 1;
    }
  }
  return found;
}

/* The wall n.X + rest = 0: through its foot, at right angles to n. */
static void add_wall(Guess *k, const Expr *n, Expr rest, uint32_t dims) {
  ExprGraph *g = k->d->b->g;
  Expr length = expr_int(g, 0), foot[3];
  for (uint32_t c = 0; c < dims; c++) length = expr_add(g, length, expr_pow_num(g, n[c], num_int(2)));
  for (uint32_t c = 0; c < dims; c++) foot[c] = expr_neg(g, expr_div(g, expr_mul(g, rest, n[c]), length));
  Scene *sc = &k->d->b->m->scene;
  uint32_t at = sc->shapes.n;
  add_link(k, SHAPE_GROUND, "support", foot, NULL, dims);
  if (dims == 2)
    sc->shapes.at[at].turn[0] = drawn_value(k->d, expr_fn2(g, EX_ATAN2, expr_neg(g, n[0]), n[1]), DIM_NONE);
  for (uint32_t i = 0; i < at; i++) /* once for all bodies on it */
    if (memcmp(&sc->shapes.at[i], &sc->shapes.at[at], sizeof sc->shapes.at[i]) == 0) sc->shapes.n = at;
}

/* Balls that meet have half their sum of radii each. */
static void note_radii(Guess *k, Expr gap, Expr radius, double times) {
  ExprGraph *g = k->d->b->g;
  Expr part[3], to[3];
  for (ExprPair term = {0}; radius && times == 2 && expr_next_pair(g, gap, EX_SUM, &term);) {
    uint32_t n = distance_parts(g, term.of, part);
    for (uint32_t i = 0; i < k->points.n && n >= 2; i++)
      if (other_end(g, &k->points.at[i], part, n, to)) k->points.at[i].radius = radius;
  }
}

void guess_walls(Guess *k) {
  Builder *b = k->d->b;
  vec_each(const Contact, c, b->m->contacts) {
    if (c->is_tangent || c->margin) continue;
    Expr gap = body_of(b->g, c->gap), radius, n[3];
    double times = 0;
    Expr rest = constant_part(k, gap, &radius, &times);
    note_radii(k, gap, radius, times);
    for (uint32_t j = 0, found = 0; j < k->points.n && !found; j++) {
      if (!normal_of(b->g, gap, &k->points.at[j], n)) continue;
      found = 1;
      if (radius && times == 1) k->points.at[j].radius = radius;
      add_wall(k, n, rest, k->points.at[j].n);
    }
  }
}
