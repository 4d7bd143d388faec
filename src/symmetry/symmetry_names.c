/* Names a generator by the time blocks in which tau, shifts and linear terms occur, and by the coordinates that
 * these couple. */
#include "symmetry/symmetry_names.h"

#include <ctype.h>
#include <stdlib.h>

/* --- coordinates of bodies --- */

/* Axis of a component by its name alone: r[2].x, x[2], x2, x and X lie along x. */
static uint32_t axis_of(Name name) {
  const char *dot = strrchr(name, '.'), *letter = dot ? dot + 1 : name;
  int axis = tolower((unsigned char)*letter) - 'x';
  if (axis < 0 || axis > 2 || (dot ? letter[1] != '\0' : isalpha((unsigned char)letter[1]))) return AXIS_NONE;
  return (uint32_t)axis;
}

int name_same_body(Name a, Name b) {
  const char *x = strrchr(a, '.'), *y = strrchr(b, '.');
  if (!x != !y) return 0;
  if (!x) return strcmp(a + 1, b + 1) == 0;
  return x - a == y - b && memcmp(a, b, (size_t)(x - a)) == 0;
}

struct SortedName {
  Name name;
  uint32_t i;
};

static int by_name(const void *a, const void *b) {
  return strcmp(((const SortedName *)a)->name, ((const SortedName *)b)->name);
}

uint32_t name_component(const CoordinateNames *e, uint32_t i, char letter) {
  Name name = e->name[i];
  const char *dot = strrchr(name, '.');
  const SortedName key = {dot ? arena_printf(e->arena, "%.*s.%c", (int)(dot - name), name, letter)
                              : arena_printf(e->arena, "%c%s", letter, name + 1), 0};
  const SortedName *found = bsearch(&key, e->sorted, e->n, sizeof key, by_name);
  return found ? found->i : UINT32_MAX;
}

/* Component `letter` of the vector or rotation that coordinate i belongs to; UINT32_MAX: there is none. */
static uint32_t sibling(const CoordinateNames *e, uint32_t i, char letter) {
  return strchr(e->name[i], '.') ? name_component(e, i, letter) : UINT32_MAX;
}

/* Components of a rotation lie along no axis. */
uint32_t name_axis(const CoordinateNames *e, uint32_t i) { return e->axis[i]; }

int name_same_kind(const CoordinateNames *e, uint32_t i, uint32_t k) {
  uint32_t a = name_axis(e, i), b = name_axis(e, k);
  Name one = e->name[i], other = e->name[k];
  size_t n = strcspn(one, "[");
  if (a != AXIS_NONE || b != AXIS_NONE) return a == b;
  return n == strcspn(other, "[") && memcmp(one, other, n) == 0;
}

CoordinateNames coordinate_names(const Eqns *e) {
  CoordinateNames c = {e->g, e->m->arena, eqns_coordinates(e), NULL, NULL, NULL};
  Name *name = ARENA_ARRAY(c.arena, Name, c.n + 1);
  uint32_t *axis = ARENA_ARRAY(c.arena, uint32_t, c.n + 1);
  SortedName *sorted = ARENA_ARRAY(c.arena, SortedName, c.n + 1);
  for (uint32_t i = 0; i < c.n; i++) {
    name[i] = expr_symbol(c.g, eqns_coordinate(e, i))->name;
    sorted[i] = (SortedName){name[i], i};
  }
  if (c.n) qsort(sorted, c.n, sizeof *sorted, by_name);
  c.name = name;
  c.axis = axis;
  c.sorted = sorted;
  for (uint32_t i = 0; i < c.n; i++) axis[i] = sibling(&c, i, 'w') == UINT32_MAX ? axis_of(name[i]) : AXIS_NONE;
  return c;
}

static uint32_t along(const CoordinateNames *e, uint32_t axis) {
  uint32_t n = 0;
  for (uint32_t i = 0; i < e->n; i++) n += name_axis(e, i) == axis;
  return n;
}

/* --- the parts of a row --- */

typedef struct {
  uint32_t tau, shift, linear; /* bit m: occurs in block m */
} Parts;

/* Time blocks in which tau, shifts and linear terms of a row occur. */
static Parts parts_of(const CoordinateNames *e, const GeneratorRow *r) {
  Parts p = {0};
  for (uint32_t m = 0; m < r->blocks; m++) {
    const Expr *c = r->c + (size_t)m * r->ansatz->shown;
    if (!expr_is_zero(e->g, c[0])) p.tau |= 1u << m;
    for (uint32_t j = 0; j < r->ansatz->xi.n; j++) {
      if (expr_is_zero(e->g, c[1 + j])) continue;
      if (r->ansatz->xi.at[j].k) p.linear |= 1u << m;
      else p.shift |= 1u << m;
    }
  }
  return p;
}

/* The coefficient of phi_k in xi_i, in block m. */
static Expr entry(const CoordinateNames *e, const GeneratorRow *r, uint32_t m, uint32_t i, uint32_t k) {
  const Expr *c = r->c + (size_t)m * r->ansatz->shown + 1;
  for (uint32_t j = 0; j < r->ansatz->xi.n; j++)
    if (r->ansatz->xi.at[j].i == i && r->ansatz->xi.at[j].k == k) return c[j];
  return expr_int(e->g, 0);
}

static int is_energy(Parts p) { return p.tau == 1 && !p.shift && !p.linear; }

/* Whether the linear part of block 0 turns q_i against q_j. */
static int turns(const CoordinateNames *e, const GeneratorRow *r, uint32_t i, uint32_t j) {
  Expr a = entry(e, r, 0, i, j + 1), b = entry(e, r, 0, j, i + 1);
  return !expr_is_zero(e->g, a) && a == expr_neg(e->g, b);
}

/* --- signs --- */

static void flip(const CoordinateNames *e, GeneratorRow *r) {
  for (size_t k = 0; k < (size_t)r->blocks * r->ansatz->shown; k++) r->c[k] = expr_neg(e->g, r->c[k]);
}

/* Whether the coefficient c of q_j in xi_i has the wrong sign for a turn as in books, x to y to z to x. */
static int wrong_turn(const CoordinateNames *e, uint32_t i, uint32_t j, Expr c) {
  uint32_t a = name_axis(e, i), b = name_axis(e, j);
  int z_and_x = a == 0 && b == 2;
  Num number;
  expr_pair(e->g, c, EX_SUM, 0, &number);
  return z_and_x ? num_sign(number) < 0 : num_sign(number) > 0;
}

void orient_generator(const CoordinateNames *e, GeneratorRow *r) {
  Parts p = parts_of(e, r);
  if (r->kind != TIME_POWERS && r->kind != TIME_LISTED) return;
  if (p.tau == 1) {
    if (num_sign(expr_is_num(e->g, r->c[0]) ? expr_number(e->g, r->c[0]) : num_int(1)) > 0) flip(e, r);
    return;
  }
  if (p.tau || p.shift || p.linear != 1) return;
  for (uint32_t i = 0; i < e->n; i++)
    for (uint32_t j = i + 1; j < e->n; j++) {
      if (!turns(e, r, i, j)) continue;
      if (wrong_turn(e, i, j, entry(e, r, 0, i, j + 1))) flip(e, r);
      return;
    }
}

/* --- names --- */

/* The only coordinate that block m shifts; UINT32_MAX: none, or several. */
static uint32_t only_shift(const CoordinateNames *e, const GeneratorRow *r, uint32_t m) {
  uint32_t only = UINT32_MAX, n = 0;
  for (uint32_t i = 0; i < e->n; i++)
    if (!expr_is_zero(e->g, entry(e, r, m, i, 0))) only = i, n++;
  return n == 1 ? only : UINT32_MAX;
}

/* The axis along which block m shifts all bodies alike; AXIS_NONE: there is none. */
static uint32_t common_shift(const CoordinateNames *e, const GeneratorRow *r, uint32_t m) {
  uint32_t axis = AXIS_NONE, n = 0;
  Expr one = 0;
  for (uint32_t i = 0; i < e->n; i++) {
    Expr c = entry(e, r, m, i, 0);
    if (expr_is_zero(e->g, c)) continue;
    uint32_t own = name_axis(e, i);
    if (own == AXIS_NONE || (one && (c != one || own != axis))) return AXIS_NONE;
    one = c;
    axis = own;
    n++;
  }
  return n && n == along(e, axis) ? axis : AXIS_NONE;
}

const char *axis_text(uint32_t axis) { return axis == 0 ? "x" : axis == 1 ? "y" : "z"; }

static void name_shift(const CoordinateNames *e, const GeneratorRow *r, FoundSymmetry *to) {
  Arena *a = e->arena;
  uint32_t axis = common_shift(e, r, 0), only = only_shift(e, r, 0);
  int has_F = to->is.is == INVARIANT_UP_TO_F, magnetic = has_F && (expr_kinds(e->g, to->is.F) & 1u << SYM_COORD);
  to->kind = SYMMETRY_MOMENTUM;
  to->axis = axis;
  to->of_all = axis != AXIS_NONE;
  if (only != UINT32_MAX)
    to->name = arena_printf(a,
                            magnetic ? "magnetic translation along %s"
                            : has_F  ? "translation along %s: momentum less the impulse of the uniform force"
                                     : "momentum of %s",
                            e->name[only]);
  else if (axis != AXIS_NONE)
    to->name = arena_printf(a, magnetic ? "magnetic translation of all bodies along %s" : "total momentum along %s",
                            axis_text(axis));
  else to->name = magnetic ? "magnetic translation" : "momentum along a direction";
}

static void name_boost(const CoordinateNames *e, const GeneratorRow *r, FoundSymmetry *to) {
  uint32_t axis = common_shift(e, r, 1), only = only_shift(e, r, 1);
  to->kind = SYMMETRY_BOOST;
  to->axis = axis;
  to->of_all = axis != AXIS_NONE;
  to->name = only != UINT32_MAX ? arena_printf(e->arena, "boost along %s", e->name[only])
             : axis != AXIS_NONE
                 ? arena_printf(e->arena, "boost along %s: the centre of mass moves uniformly", axis_text(axis))
                 : "boost";
}

static uint32_t terms_of(const CoordinateNames *e, const GeneratorRow *r) {
  uint32_t terms = 0;
  for (uint32_t j = 0; j < r->ansatz->xi.n; j++) terms += !expr_is_zero(e->g, r->c[1 + j]);
  return terms;
}

/* Axis about which the linear part turns some bodies by one angle, and their number *bodies; AXIS_NONE: it is no
 * such turn. */
static uint32_t common_turn(const CoordinateNames *e, const GeneratorRow *r, uint32_t *bodies) {
  uint32_t axis = AXIS_NONE, terms = terms_of(e, r);
  Expr one = 0;
  *bodies = 0;
  for (uint32_t i = 0; i < e->n; i++)
    for (uint32_t j = i + 1; j < e->n; j++) {
      uint32_t a = name_axis(e, i), b = name_axis(e, j);
      if (!turns(e, r, i, j)) continue;
      if (a == AXIS_NONE || b == AXIS_NONE || a == b || !name_same_body(e->name[i], e->name[j])) return AXIS_NONE;
      Expr c = entry(e, r, 0, i, j + 1);
      if ((b + 3 - a) % 3 == 2) c = expr_neg(e->g, c);
      if (one && (c != one || axis != 3 - a - b)) return AXIS_NONE;
      one = c;
      axis = 3 - a - b;
      ++*bodies;
    }
  return terms == 2 * *bodies ? axis : AXIS_NONE;
}

static uint32_t bodies_with(const CoordinateNames *e, uint32_t axis) {
  uint32_t a = (axis + 1) % 3, n = 0;
  for (uint32_t i = 0; i < e->n; i++)
    for (uint32_t j = 0; j < e->n; j++)
      n += name_axis(e, i) == a && name_axis(e, j) == (axis + 2) % 3 && name_same_body(e->name[i], e->name[j]);
  return n;
}

/* Whether the linear part turns two directions, mixing the bodies: xi_x = -S y, xi_y = S x. */
static int mixes_bodies(const CoordinateNames *e, const GeneratorRow *r) {
  for (uint32_t j = 0; j < r->ansatz->xi.n; j++) {
    if (expr_is_zero(e->g, r->c[1 + j])) continue;
    uint32_t i = r->ansatz->xi.at[j].i, k = r->ansatz->xi.at[j].k - 1, a = name_axis(e, i), b = name_axis(e, k),
             found = 0;
    if (a == AXIS_NONE || b == AXIS_NONE || a == b) return 0;
    for (uint32_t other = 0; other < e->n && !found; other++)
      for (uint32_t last = 0; last < e->n && !found; last++)
        found = name_same_body(e->name[i], e->name[other]) && name_axis(e, other) == b &&
                name_same_body(e->name[k], e->name[last]) && name_axis(e, last) == a &&
                entry(e, r, 0, other, last + 1) == expr_neg(e->g, r->c[1 + j]);
    if (!found) return 0;
  }
  return 1;
}

/* The components of the rotation that begins at coordinate w: along `axis` and those behind it. 0: one is missing. */
static int vector_part(const CoordinateNames *e, uint32_t w, uint32_t axis, uint32_t at[3]) {
  int whole = 1;
  for (uint32_t k = 0; k < 3; k++) whole &= (at[k] = sibling(e, w, (char)('x' + (axis + k) % 3))) != UINT32_MAX;
  return whole;
}

/* Whether xi is a multiple of n q (a turn in space) or q n (about the body's own axis): q the quaternion that begins
 * at coordinate w, n its unit vector `axis`. */
static int turns_rotation(const CoordinateNames *e, const GeneratorRow *r, uint32_t w, uint32_t axis, int own) {
  uint32_t v[3];
  if (!vector_part(e, w, axis, v)) return 0;
  Expr c = entry(e, r, 0, v[0], w + 1), minus = expr_neg(e->g, c), other = own ? minus : c;
  return !expr_is_zero(e->g, c) && entry(e, r, 0, w, v[0] + 1) == minus && entry(e, r, 0, v[2], v[1] + 1) == other &&
         entry(e, r, 0, v[1], v[2] + 1) == expr_neg(e->g, other);
}

/* Names a xi that turns only w against `axis` (the sum of n q and q n) or only the two other components (their
 * difference). 0: neither. */
static int name_double_turn(const CoordinateNames *e, const GeneratorRow *r, FoundSymmetry *to) {
  for (uint32_t w = 0; w < e->n && terms_of(e, r) == 2; w++)
    for (uint32_t axis = 0; axis < 3 && sibling(e, w, 'w') == w; axis++) {
      uint32_t v[3];
      if (!vector_part(e, w, axis, v)) continue;
      int sum = turns(e, r, w, v[0]);
      if (!sum && !turns(e, r, v[1], v[2])) continue;
      to->kind = SYMMETRY_OTHER;
      to->name =
          arena_printf(e->arena, "turns about %s in space and about the body's own: the %s of the angular momenta",
                       axis_text(axis), sum ? "sum" : "difference");
      return 1;
    }
  return 0;
}

/* Names the turn of one rotation, in space or about a body's own axis. 0: xi is none. */
static int name_turn(const CoordinateNames *e, const GeneratorRow *r, FoundSymmetry *to) {
  for (uint32_t w = 0; w < e->n && terms_of(e, r) == 4; w++)
    for (uint32_t k = 0; k < 6 && sibling(e, w, 'w') == w; k++) {
      if (!turns_rotation(e, r, w, k / 2, k % 2)) continue;
      to->kind = SYMMETRY_OTHER;
      to->name = arena_printf(e->arena,
                              k % 2 ? "turns about the body's own %s: twice its angular momentum"
                                    : "turns about %s in space: twice the angular momentum",
                              axis_text(k / 2));
      return 1;
    }
  return 0;
}

/* Whether the linear part of block 0 is antisymmetric. */
static int block_turns(const CoordinateNames *e, const GeneratorRow *r) {
  for (uint32_t i = 0; i < e->n; i++)
    for (uint32_t j = 0; j <= i; j++)
      if (entry(e, r, 0, i, j + 1) != expr_neg(e->g, entry(e, r, 0, j, i + 1))) return 0;
  return 1;
}

static void name_linear(const CoordinateNames *e, const GeneratorRow *r, FoundSymmetry *to) {
  if (name_turn(e, r, to) || name_double_turn(e, r, to)) return;
  uint32_t bodies, axis = common_turn(e, r, &bodies);
  int space = along(e, 2) > 0 && along(e, 0) > 0;
  if (axis != AXIS_NONE) {
    int all = bodies == bodies_with(e, axis);
    to->kind = SYMMETRY_ROTATION;
    to->axis = axis;
    to->of_all = all;
    const char *whole = all && bodies > 1 ? "total angular momentum" : "angular momentum";
    to->name = space || axis != 2 ? arena_printf(e->arena, "%s about %s", whole, axis_text(axis)) : whole;
  } else if (mixes_bodies(e, r)) to->name = "angular momentum of a part of the motion";
  else to->name = block_turns(e, r) ? "rotation among coordinates" : "linear map of the coordinates";
}

void name_symmetry(const CoordinateNames *e, const GeneratorRow *r, FoundSymmetry *to) {
  Parts p = parts_of(e, r);
  to->axis = AXIS_NONE;
  to->name = "point symmetry";
  /* the frame of the forced motion */
  if (r->kind == TIME_LISTED && p.tau == 1 && p.shift > 1 && !p.linear) to->name = "energy in a moving frame";
  else if (r->kind != TIME_POWERS && (r->kind != TIME_LISTED || (p.tau | p.shift | p.linear) > 7)) {
    const char *what = p.tau ? "breathing" : p.linear ? "turning" : "shift along a solution";
    const char *of_time = r->kind == TIME_CIRCULAR ? "periodic" : "exponential";
    int grows = (p.tau | p.shift | p.linear) > 3;
    to->name =
        r->kind == TIME_LISTED ? what : arena_printf(e->arena, grows ? "%s, t times %s" : "%s, %s in t", what, of_time);
  } else if (is_energy(p)) {
    to->kind = SYMMETRY_ENERGY;
    to->name = "energy";
  } else if (p.tau == 1) to->name = "energy in a moving frame";
  else if (!p.tau && !p.linear && p.shift == 1) name_shift(e, r, to);
  else if (!p.tau && !p.linear && p.shift == 2) name_boost(e, r, to);
  else if (!p.tau && !p.shift && p.linear == 1) name_linear(e, r, to);
  else if (p.tau == 2 && (p.linear == 1 || p.linear == 3)) {
    to->kind = SYMMETRY_SCALING;
    to->name = "scaling";
  } else if (p.tau & 4) to->name = "expansion";
  else if (!p.tau && p.linear == 1)
    to->name = block_turns(e, r) ? "rotation and translation at once" : "affine map of the coordinates";
}
