/* A drawing for a model without `draw`: points by names and vectors, bodies of rotations, and links.
 *
 * Enters: the names of the model. Leaves: shapes. Points are vectors and pairs of quantities whose names differ in x
 * and y; a model without these is drawn by its coordinates. */
#include <string.h>

#include "base/words.h"
#include "model/guess_drawing.h"

enum { MOST_POINTS = 2000 };

int changes(const ExprGraph *g, Expr e) {
  return (expr_kinds(g, e) & (1u << SYM_COORD | 1u << SYM_STATE | 1u << SYM_TIME | 1u << SYM_INPUT)) != 0;
}

static int has_rates(const ExprGraph *g, Expr e) {
  return (expr_kinds(g, e) & (1u << SYM_VEL | 1u << SYM_ACC | 1u << SYM_RATE | 1u << SYM_MULTIPLIER)) != 0;
}

static void place_of(Guess *k, const Expr *at, uint32_t n, int out[3]) {
  Value v = {.n = n, .dim = k->d->place};
  memcpy(v.at, at, n * sizeof *at);
  drawn_place(k->d, &v, out);
}

void add_link(Guess *k, ShapeKind kind, const char *role, const Expr *a, const Expr *b, uint32_t n) {
  Shape s = *add_shape(k->d, kind, role, NULL);
  if (a) place_of(k, a, n, s.a);
  if (b) place_of(k, b, n, s.b);
  Scene *sc = &k->d->b->m->scene;
  sc->shapes.at[sc->shapes.n - 1] = s;
}

/* Whether a quantity with this dimension may be a place; the first one decides. */
static int is_place(Guess *k, Dim dim) {
  Dims *dims = k->d->b->dims;
  dim = dim_resolved(dims, dim);
  if (dim == DIM_NONE && !k->d->b->unitless) return 0;
  if (k->d->place == DIM_ANY) k->d->place = dim;
  return dim == dim_resolved(dims, k->d->place) || dim == DIM_ANY;
}

/* --- points by name --- */

static int is_momentum(const Builder *b, const Entity *e) {
  for (uint32_t i = 0; e->kind == ENT_STATE && i < b->m->pairs.n; i++)
    if (b->m->pairs.at[i].p == e->index) return 1;
  return 0;
}

static int is_quantity(const Builder *b, const Entity *e) {
  int counts = e->kind == ENT_COORD || e->kind == ENT_STATE || e->kind == ENT_LET || e->kind == ENT_OBSERVE;
  return counts && !is_momentum(b, e);
}

/* The quantity whose name has `to` in the place of letter i; NULL: none with the same indices. */
static const Entity *sibling(Guess *k, const Entity *e, size_t i, char to) {
  Builder *b = k->d->b;
  char *name = arena_strdup(b->arena, e->name);
  name[i] = to;
  const Entity *other = scope_own(&b->scope, intern(b->ast->names, name), e->effect);
  return other && is_quantity(b, other) && other->ndims == e->ndims && !other->parts ? other : NULL;
}

static int same_range(const Entity *e, const Entity *f) {
  for (int k = 0; k < e->ndims; k++)
    if (e->lo[k] != f->lo[k] || e->hi[k] != f->hi[k]) return 0;
  return 1;
}

static void add_point(Guess *k, const Expr *at, uint32_t n, const char *text) {
  ExprGraph *g = k->d->b->g;
  DrawnPoint p = {.n = n, .text = text};
  for (uint32_t c = 0; c < n; c++) {
    if (has_rates(g, at[c])) return;
    p.at[c] = at[c];
  }
  if (k->points.n < MOST_POINTS) vec_push(k->d->b->arena, &k->points, p);
}

static Value member_value(Guess *k, const Entity *e, const int64_t *at) {
  Builder *b = k->d->b;
  int listed = e->ndims && (e->kind == ENT_LET || e->kind == ENT_OBSERVE);
  if (listed && !find_member(b->ast, &b->members, e, at)) return (Value){0};
  return resolve_member(b, e, at, 0, e->span, IN_OUTPUT);
}

/* Points of scalars: each member of x with those of y and z. */
static void add_named(Guess *k, const Entity *const *of, uint32_t n) {
  Builder *b = k->d->b;
  int64_t at[2];
  for (int more = first_member(of[0], at); more; more = next_member(of[0], at)) {
    Expr place[3];
    uint32_t c = 0;
    for (; c < n; c++) {
      Value v = member_value(k, of[c], at);
      if (!v.e || v.n || !is_place(k, v.dim)) break;
      place[c] = v.e;
    }
    const char *text = of[0]->ndims ? NULL
                       : n == 3     ? arena_printf(b->arena, "(%s, %s, %s)", of[0]->name, of[1]->name, of[2]->name)
                                    : arena_printf(b->arena, "(%s, %s)", of[0]->name, of[1]->name);
    if (c == n) add_point(k, place, n, text);
  }
}

/* Number of letters of axes in a name: `wxx` is no place. */
static int axis_letters(const char *name) {
  int n = 0;
  for (; *name; name++) n += strchr("xyzXYZ", *name) != NULL;
  return n;
}

/* x and y; px and py, xP and yP, X1 and Y1; with z where there is one. */
static void find_names(Guess *k, const Entity *e) {
  for (size_t i = 0; e->name[i] && axis_letters(e->name) == 1; i++) {
    int upper = e->name[i] == 'X';
    if (e->name[i] != 'x' && !upper) continue;
    const Entity *y = sibling(k, e, i, upper ? 'Y' : 'y'), *z = sibling(k, e, i, upper ? 'Z' : 'z');
    if (!y || !same_range(e, y)) continue;
    const Entity *const of[] = {e, y, z};
    add_named(k, of, z && same_range(e, z) ? 3 : 2);
    return;
  }
}

/* Vectors among coordinates, states and definitions. */
static void find_vectors(Guess *k, const Entity *e) {
  int64_t at[2];
  for (int more = first_member(e, at); more; more = next_member(e, at)) {
    Value v = member_value(k, e, at);
    if ((v.n == 2 || v.n == 3) && is_place(k, v.dim)) add_point(k, v.at, v.n, e->ndims ? NULL : e->name);
  }
}

/* Coordinates first: they say what a place is. */
static void find_points(Guess *k) {
  Builder *b = k->d->b;
  for (int lets = 0; lets < 2; lets++)
    for (uint32_t i = 0, n = b->scope.all.n; i < n; i++) {
      const Entity e = b->scope.all.at[i];
      if (!is_quantity(b, &e) || (e.kind == ENT_LET || e.kind == ENT_OBSERVE) != lets || e.parts == ROTATION) continue;
      if (e.parts || lets) find_vectors(k, &e);
      if (!e.parts) find_names(k, &e);
    }
}

/* --- models without points --- */

typedef struct {
  Expr e;
  const char *name;
  Dim dim;
  int angle;
} Scalar;

typedef VEC(Scalar) Scalars;

/* Scalar coordinates, momenta excepted. */
static Scalars scalars_of(Guess *k) {
  Builder *b = k->d->b;
  Scalars out = {0};
  for (uint32_t i = 0; i < b->scope.all.n; i++) {
    const Entity e = b->scope.all.at[i];
    if (!is_coordinate(b, &e) || e.parts || is_momentum(b, &e)) continue;
    int64_t at[2];
    for (int more = first_member(&e, at); more; more = next_member(&e, at)) {
      Value v = member_value(k, &e, at);
      uint32_t place = e.index + (e.ndims ? (uint32_t)(at[0] - e.lo[0]) : 0);
      const Unit *u = entity_unit(b, &e);
      int periodic = e.kind == ENT_COORD ? b->m->coords.at[place].periodic : b->m->states.at[place].periodic;
      Scalar s = {v.e, e.ndims ? NULL : e.name, v.dim, periodic || (u->text && has_word("rad deg", u->text))};
      if (v.e && !v.n && out.n < MOST_POINTS) vec_push(b->arena, &out, s);
    }
  }
  return out;
}

static Expr whole(Guess *k, int64_t n) { return expr_int(k->d->b->g, n); }

/* A family of numbers: over its index. */
static void draw_row(Guess *k, const Scalars *of) {
  for (uint32_t i = 0; i < of->n; i++) add_point(k, (Expr[]){whole(k, i + 1), of->at[i].e}, 2, NULL);
}

/* One angle: a rod that hangs; several: wheels side by side. */
static void draw_angles(Guess *k, const Scalars *of) {
  ExprGraph *g = k->d->b->g;
  for (uint32_t i = 0; i < of->n && of->n > 1; i++) {
    Shape s = *add_shape(k->d, SHAPE_DISC, "body", of->at[i].name);
    place_of(k, (Expr[]){expr_scale(g, num_ratio(5, 2), whole(k, i)), whole(k, 0)}, 2, s.a);
    s.size[0] = drawn_value(k->d, whole(k, 1), k->d->place);
    s.turn[0] = drawn_value(k->d, of->at[i].e, DIM_NONE);
    k->d->b->m->scene.shapes.at[k->d->b->m->scene.shapes.n - 1] = s;
  }
  if (of->n != 1) return;
  Expr s = expr_fn(g, EX_SIN, of->at[0].e), c = expr_fn(g, EX_COS, of->at[0].e), at[] = {s, expr_neg(g, c)};
  add_point(k, at, 2, arena_printf(k->d->b->arena, "(sin(%s), -cos(%s))", of->at[0].name, of->at[0].name));
}

/* r and an angle: polar coordinates. 0: they are not. */
static int draw_polar(Guess *k, const Scalars *of) {
  ExprGraph *g = k->d->b->g;
  for (uint32_t i = 0; i < of->n && of->n == 2; i++) {
    const Scalar *r = &of->at[i], *phi = &of->at[1 - i];
    if (r->angle || !phi->angle || !r->name || !has_word("r rho R", r->name) || !is_place(k, r->dim)) continue;
    Expr c = expr_fn(g, EX_COS, phi->e), s = expr_fn(g, EX_SIN, phi->e), x = expr_mul(g, r->e, c);
    add_point(k, (Expr[]){x, expr_mul(g, r->e, s)}, 2, arena_printf(k->d->b->arena, "(%s, %s)", r->name, phi->name));
    return 1;
  }
  return 0;
}

/* Each length along its own line: heights up, others across. */
static void draw_lines(Guess *k, const Scalars *of) {
  for (uint32_t i = 0; i < of->n; i++) {
    const Scalar *s = &of->at[i];
    if (s->angle || !is_place(k, s->dim)) continue;
    int up = s->name && strchr("yzhYZH", s->name[0]);
    Expr zero = whole(k, 0), at[] = {up ? zero : s->e, up ? s->e : zero};
    add_point(k, at, 2, s->name);
  }
}

static void draw_coordinates(Guess *k) {
  Scalars of = scalars_of(k);
  int family = of.n > 1 && !of.at[0].name, angles = 1;
  for (uint32_t i = 0; i < of.n; i++) {
    family = family && !of.at[i].name;
    angles = angles && of.at[i].angle;
  }
  if (family && !angles) draw_row(k, &of);
  else if (angles && of.n) draw_angles(k, &of);
  else if (!draw_polar(k, &of)) draw_lines(k, &of);
}

/* --- bodies --- */

static int moves(const ExprGraph *g, const DrawnPoint *p) {
  return p->n == 3 && expr_op(g, p->at[0]) == EX_SYM;
}

/* Rotations as boxes with axes, the k-th at the k-th vector of space among the coordinates. */
static void draw_rotations(Guess *k) {
  Builder *b = k->d->b;
  uint32_t next = 0;
  for (uint32_t i = 0; i < b->rotations.n; i++) {
    Shape s = *add_shape(k->d, SHAPE_BODY, "body", NULL);
    Value r = {.n = ROTATION};
    for (uint32_t c = 0; c < ROTATION; c++) {
      r.at[c] = expr_symbol(b->g, b->m->coords.at[b->rotations.at[i] + c].q)->node;
      s.turn[c] = drawn_value(k->d, r.at[c], DIM_NONE);
    }
    while (next < k->points.n && !moves(b->g, &k->points.at[next])) next++;
    if (next < k->points.n) {
      place_of(k, k->points.at[next].at, 3, s.a);
      s.text = k->points.at[next].text;
      k->points.at[next++].n = 0; /* drawn */
    }
    b->m->scene.shapes.at[b->m->scene.shapes.n - 1] = s;
  }
}

static void draw_balls(Guess *k) {
  Builder *b = k->d->b;
  vec_each(const DrawnPoint, p, k->points) {
    int moves = 0;
    for (uint32_t c = 0; c < p->n; c++) moves |= changes(b->g, p->at[c]);
    if (!moves) continue;
    Shape s = *add_shape(k->d, SHAPE_BALL, "body", p->text);
    place_of(k, p->at, p->n, s.a);
    if (p->radius) s.size[0] = drawn_value(k->d, p->radius, k->d->place);
    b->m->scene.shapes.at[b->m->scene.shapes.n - 1] = s;
  }
}

void guess_drawing(Drawing *d) {
  Guess k = {.d = d, .stretched = expr_map(d->b->arena)};
  note_squares(&k);
  find_points(&k);
  if (!k.points.n && !d->b->rotations.n) draw_coordinates(&k);
  guess_walls(&k);
  guess_arms(&k);
  guess_rods(&k);
  guess_springs(&k);
  draw_rotations(&k);
  draw_balls(&k);
}
