/* The search for symmetries against theory: how many there are, that textbook generators are among them, that what
 * is called conserved is conserved along the equations of motion, and that the space does not depend on coordinates.
 * Dimensions of point symmetries that leave the action alone: U. Niederer, Helv. Phys. Acta 45 (1972) 802 and 46
 * (1973) 191 (free particle, oscillator, uniform field: 12 in three dimensions, n(n + 3)/2 + 3 in n), V. de Alfaro,
 * S. Fubini, G. Furlan, Nuovo Cimento A 34 (1976) 569 (inverse square: sl(2)). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#include "base/dense_matrix.h"
#include "compile_text.h"
#include "slow.h"
#include "symmetry/find_symmetries.h"
#include "mech/states.h"
#include "sym/diff.h"

typedef struct {
  Arena *arena;
  Eqns *e;
  FoundSymmetries found;
} Model_;

static Model_ model(const char *lag) {
  Model_ m = {.arena = test_arena()};
  m.e = equations(m.arena, lag, NULL);
  assert_non_null(m.e);
  SearchLimit limit = search_limit(INFINITY);
  m.found = noether_find(m.e, &limit);
  return m;
}

/* --- every charge is conserved, by the accelerations of M q'' = f, which know nothing of Noether --- */

static long double rate_of(const Model_ *m, Expr Q, const long double *symbols) {
  const Eqns *e = m->e;
  uint32_t count = expr_symbol_count(e->g) + 1;
  Expr *seed = ARENA_ARRAY(m->arena, Expr, count), rate;
  long double value;
  seed[e->m->time] = expr_int(e->g, 1);
  for (uint32_t i = 0; i < e->m->coords.n; i++) {
    const Coord *c = &e->m->coords.at[i];
    seed[c->q] = expr_symbol(e->g, c->v)->node;
    seed[c->v] = expr_symbol(e->g, c->a)->node;
  }
  for (uint32_t i = 0; i < e->m->states.n; i++)
    seed[e->m->states.at[i].z] = expr_symbol(e->g, e->m->states.at[i].rate)->node;
  expr_tangent(e->g, &Q, 1, (ExprSeeds){.at = seed, .n = count}, "'", NULL, &rate);
  expr_eval(e->g, &rate, 1, symbols, &value);
  return value;
}

static void conserved(const Model_ *m) {
  StateSolver *solver = states_new(m->e);
  for (int turn = 0; turn < 4; turn++) {
    long double *symbols = random_point(m->e);
    for (SymId s = 1; s <= expr_symbol_count(m->e->g); s++)
      if (expr_symbol(m->e->g, s)->kind == SYM_COORD) symbols[s] += 2; /* away from where roots end */
    assert_true(states_complete(solver, symbols));
    for (uint32_t k = 0; k < m->found.all.n; k++) {
      const FoundSymmetry *s = &m->found.all.at[k];
      /* values are of the size of 1 .. 100, their digits 19 */
      if (!(fabsl(rate_of(m, s->is.charge, symbols)) < 1e-13L))
        fail_msg("%s: dQ/dt = %Lg", s->name, rate_of(m, s->is.charge, symbols));
    }
  }
}

/* --- spaces of generators, as their values at points --- */

enum { POINTS = 24 };

/* (xi, tau) of a generator at random points (q, t); map: what q and xi become. Rows of one model are taken at the
 * same points. */
static void values_of(const Model_ *m, const Generator *by, long double *to) {
  uint32_t n = eqns_coordinates(m->e);
  test_rng = 17;
  for (uint32_t p = 0; p < POINTS; p++) {
    long double *symbols = random_point(m->e);
    for (uint32_t i = 0; i < n; i++) symbols[eqns_coordinate(m->e, i)] = uniform(-1, 1);
    symbols[m->e->m->time] = uniform(0, 3);
    for (uint32_t i = 0; i < n; i++) {
      long double *at = to + (size_t)p * (n + 1) + i;
      *at = 0;
      if (by->xi && by->xi[i]) expr_eval(m->e->g, &by->xi[i], 1, symbols, at);
    }
    to[(size_t)p * (n + 1) + n] = 0;
    if (by->tau) expr_eval(m->e->g, &by->tau, 1, symbols, &to[(size_t)p * (n + 1) + n]);
  }
}

static uint32_t width_of(const Model_ *m) { return POINTS * (eqns_coordinates(m->e) + 1); }

static DenseRows space_of(const Model_ *m) {
  uint32_t w = width_of(m);
  DenseRows all = {m->found.all.n, w, ARENA_ARRAY(m->arena, long double, (size_t)m->found.all.n * w + 1), 0};
  for (uint32_t k = 0; k < m->found.all.n; k++) values_of(m, &m->found.all.at[k].by, all.at + (size_t)k * w);
  return dense_orthonormal(m->arena, &all, w);
}

static int is_in(const DenseRows *space, long double *row) {
  return dense_gram_schmidt(space->width, row, space->at, space->n) < 1e-9L;
}

static Expr observed(const Eqns *e, const char *name) {
  for (uint32_t i = 0; i < e->m->observes.n; i++)
    if (strcmp(e->m->observes.at[i].name, name) == 0) return e->m->observes.at[i].value;
  return 0;
}

/* Generators of textbooks are observables of the model: A_x and so on for xi of the coordinate x, A_t for tau; A, B,
 * ... */
static void contains_textbook(const Model_ *m) {
  DenseRows space = space_of(m);
  uint32_t n = eqns_coordinates(m->e);
  for (char letter = 'A'; letter <= 'Z'; letter++) {
    Expr *xi = ARENA_ARRAY(m->arena, Expr, n + 1), tau = observed(m->e, arena_printf(m->arena, "%c_t", letter));
    int some = tau != 0;
    for (uint32_t i = 0; i < n; i++) {
      xi[i] =
          observed(m->e, arena_printf(m->arena, "%c_%s", letter, expr_symbol(m->e->g, eqns_coordinate(m->e, i))->name));
      some = some || xi[i];
    }
    if (!some) continue;
    long double *row = ARENA_ARRAY(m->arena, long double, width_of(m));
    values_of(m, &(Generator){.xi = xi, .tau = tau}, row);
    if (!is_in(&space, row)) fail_msg("the generator %c is not found", letter);
  }
}

/* A model with so many charges, linearly independent, nothing left over; all are proved, but conservation is not looked
 * at in numbers, near singular planes. */
static Model_ counted(const char *lag, uint32_t dimension) {
  Model_ m = model(lag);
  if (m.found.all.n != dimension || m.found.unproved)
    fail_msg("%u found and %u not proved, instead of %u", m.found.all.n, m.found.unproved, dimension);
  assert_int_equal(space_of(&m).n, dimension);
  return m;
}

static void counts(const char *lag, uint32_t dimension) { arena_free(counted(lag, dimension).arena); }

/* The same, and all conserved. */
static Model_ finds(const char *lag, uint32_t dimension) {
  Model_ m = counted(lag, dimension);
  conserved(&m);
  contains_textbook(&m);
  return m;
}

static void has_only(const char *lag, uint32_t dimension) { arena_free(finds(lag, dimension).arena); }

static void has_name(const Model_ *m, const char *name) {
  for (uint32_t k = 0; k < m->found.all.n; k++)
    if (strcmp(m->found.all.at[k].name, name) == 0) return;
  fail_msg("no %s", name);
}

/* --- models --- */

#define FREE "model f\ncoord x, y, z\nparam m = 2 > 0\nlagrangian = m/2*(x'^2 + y'^2 + z'^2)\n"

/* Schroedinger's group: translations, boosts and rotations in space, and of time translation, scaling, expansion. */
static void free_particle(void **state) {
  (void)state;
  Model_ m = finds(FREE "observe A_t = -1\nobserve B_x = 1\nobserve C_z = t\nobserve D_x = -y\nobserve D_y = x\n"
                   "observe E_x = x\nobserve E_y = y\nobserve E_z = z\nobserve E_t = 2*t\n"
                   "observe F_x = t*x\nobserve F_y = t*y\nobserve F_z = t*z\nobserve F_t = t^2\n", 12);
  assert_true(m.found.galilean);
  has_name(&m, "angular momentum about z");
  has_name(&m, "boost along x");
  has_name(&m, "scaling");
  has_name(&m, "expansion");
  arena_free(m.arena);
}

/* A uniform force leaves the group as it is, in coordinates that fall along. */
static void uniform_field(void **state) {
  (void)state;
  has_only("model u\ncoord y\nparam m = 2 > 0, g = 9.81\nlagrangian = m/2*y'^2 - m*g*y\nobserve A_y = 1\nobserve B_y = "
           "t\nobserve C_t = 1\n",
           5);
}

static void kepler(void **state) {
  (void)state;
  has_only("model k\ncoord x, y\nparam m = 2 > 0, k = 3 > 0\nlagrangian = m/2*(x'^2 + y'^2) + k/hypot(x, y)\nobserve "
           "A_x = -y\nobserve A_y = x\nobserve B_t = 1\n",
           2);
  Model_ m = finds("model k\ncoord x, y, z\nparam m = 2 > 0, k = 3 > 0\nlagrangian = m/2*(x'^2 + y'^2 + z'^2) + "
                   "k/sqrt(x^2 + y^2 + z^2)\n"
                   "observe A_x = -z\nobserve A_z = x\nobserve B_y = -z\nobserve B_z = y\n",
                   4);
  assert_false(m.found.galilean);
  arena_free(m.arena);
}

/* The same group as that of a free particle: shifts along solutions, the rotation, energy and two breathing ones. */
static void oscillators(void **state) {
  (void)state;
  has_only("model o\ncoord x, y\nparam m = 2 > 0, k = 3 > 0\nlagrangian = m/2*(x'^2 + y'^2) - k/2*(x^2 + y^2)\n"
           "observe A_x = cos(sqrt(k/m)*t)\nobserve B_y = sin(sqrt(k/m)*t)\nobserve C_x = -y\nobserve C_y = x\n"
           "observe D_x = -sqrt(k/m)*x*sin(2*sqrt(k/m)*t)\nobserve D_y = -sqrt(k/m)*y*sin(2*sqrt(k/m)*t)\nobserve D_t "
           "= cos(2*sqrt(k/m)*t)\n",
           8);
  /* different frequencies: shifts and the energy */
  has_only("model o\ncoord x, y\nparam m = 2 > 0, k = 3 > 0, c = 1 > 0\nlagrangian = m/2*(x'^2 + y'^2) - k/2*x^2 - "
           "c/2*y^2\nobserve A_x = cos(sqrt(k/m)*t)\n",
           5);
  /* on a hilltop */
  has_only("model o\ncoord x\nparam m = 2 > 0, k = 3 > 0\nlagrangian = m/2*x'^2 + k/2*x^2\nobserve A_x = "
           "exp(sqrt(k/m)*t)\nobserve B_x = exp(-sqrt(k/m)*t)\n",
           5);
}

/* Larmor: in a frame that turns with half the gyration a charge is an oscillator. */
static void magnetic(void **state) {
  (void)state;
  Model_ m = finds("model b\ncoord x, y\nparam m = 2 > 0, b = 3\nlagrangian = m/2*(x'^2 + y'^2) + b/2*(x*y' - y*x')\n"
                   "observe A_x = 1\nobserve B_y = 1\nobserve C_x = -y\nobserve C_y = x\nobserve D_x = "
                   "cos(b*t/m)\nobserve D_y = -sin(b*t/m)\n",
                   8);
  has_name(&m, "magnetic translation along x");
  arena_free(m.arena);
  /* with a spring: two frequencies, and breathing with their sum (V. Fock, Z. Phys. 47 (1928) 446) */
  has_only("model b\ncoord x, y\nparam m = 2 > 0, b = 3, k = 1 > 0\nlagrangian = m/2*(x'^2 + y'^2) + b/2*(x*y' - y*x') "
           "- k/2*(x^2 + y^2)\nlet w = sqrt(b^2 + 4*m*k)/m\n"
           "observe A_x = cos((w - b/m)*t/2)\nobserve A_y = sin((w - b/m)*t/2)\nobserve B_x = cos((w + "
           "b/m)*t/2)\nobserve B_y = -sin((w + b/m)*t/2)\n",
           8);
}

static void inverse_square(void **state) {
  (void)state;
  has_only(
      "model i\ncoord x, y\nparam m = 2 > 0, k = 3\nlagrangian = m/2*(x'^2 + y'^2) - k/(x^2 + y^2)\n"
      "observe A_x = x\nobserve A_y = y\nobserve A_t = 2*t\nobserve B_x = t*x\nobserve B_y = t*y\nobserve B_t = t^2\n",
      4);
  /* on a line: sl(2), the centre of mass and its boost (F. Calogero, J. Math. Phys. 12 (1971) 419); with a third
   * that is free, that one's momentum and boost, and its turn with the centre of mass, too */
  counts("model c\ncoord x, y, z\nparam g = 1 > 0\nlagrangian = (x'^2 + y'^2 + z'^2)/2 - g/(x - y)^2 - g/(y - z)^2 - "
         "g/(z - x)^2\n",
         5);
  counts("model c\ncoord x, y, z\nlagrangian = (x'^2 + y'^2 + z'^2)/2 - 1/(x - y)^2\n", 8);
  /* another power: no scaling */
  has_only("model i\ncoord x, y\nparam m = 2 > 0, k = 3\nlagrangian = m/2*(x'^2 + y'^2) - k/(x^2 + y^2)^2\n", 2);
}

/* Galileo's ten, and the turns of the centre of mass by itself. */
static void bodies(void **state) {
  (void)state;
  Model_ m = finds("model n\ncoord r1: vec3, r2: vec3, r3: vec3\nparam G = 1 > 0, m1 = 1 > 0, m2 = 2 > 0, m3 = 3 > 0\n"
                   "kinetic = m1/2*dot(r1', r1') + m2/2*dot(r2', r2') + m3/2*dot(r3', r3')\n"
                   "potential = -G*m1*m2/norm(r1 - r2) - G*m1*m3/norm(r1 - r3) - G*m2*m3/norm(r2 - r3)\n", 13);
  assert_true(m.found.galilean);
  has_name(&m, "total angular momentum about x");
  has_name(&m, "boost along z: the centre of mass moves uniformly");
  arena_free(m.arena);
}

/* Past a hundred coordinates the usual ones are tried: on a free chain they hold, on one that hangs on a wall but
 * one does not. */
static void many(void **state) {
  (void)state;
#define CHAIN "model c\nconst N = 101\ncoord u[N]\nkinetic = sum(i in 1..N, u[i]'^2/2)\n"
  Model_ m = finds(CHAIN "potential = sum(i in 1..N-1, (u[i+1] - u[i])^4/4)\n", 3);
  has_name(&m, "total momentum along u");
  arena_free(m.arena);
  has_only(CHAIN "potential = sum(i in 1..N-1, (u[i+1] - u[i])^4/4) + u[1]^2/2\n", 1);
  m = counted("model n\nconst N = 34\ncoord r[N]: vec3\nparam G = 1 > 0, m[N] = 1 > 0\nkinetic = sum(i in 1..N, "
            "m[i]/2*dot(r[i]', r[i]'))\n"
            "potential = -sum(i in 2..N, G*m[1]*m[i]/norm(r[i] - r[1]))\n", 10);
  assert_true(m.found.galilean);
  arena_free(m.arena);
}

/* Chaotic ones have their energy, and nothing else may be found. */
static void nothing_false(void **state) {
  (void)state;
  has_only("model p\ncoord th\nparam g = 9.81 > 0, l = 2 > 0\nlagrangian = l^2*th'^2/2 + g*l*cos(th)\n", 1);
  has_only("model d\ncoord a, b\nparam m1 = 1 > 0, m2 = 2 > 0, l1 = 1 > 0, l2 = 2 > 0, g = 9.81\n"
           "lagrangian = (m1 + m2)/2*l1^2*a'^2 + m2/2*l2^2*b'^2 + m2*l1*l2*a'*b'*cos(a - b) + (m1 + m2)*g*l1*cos(a) + "
           "m2*g*l2*cos(b)\n",
           1);
  has_only("model h\ncoord x, y\nlagrangian = (x'^2 + y'^2)/2 - (x^2 + y^2)/2 - x^2*y + y^3/3\n", 1);
  has_only("model a\ncoord r, th\nparam M = 3 > 0, m = 1 > 0, g = 9.81\nlagrangian = (M + m)/2*r'^2 + m/2*r^2*th'^2 - "
           "g*r*(M - m*cos(th))\n",
           1);
}

static void curved(void **state) {
  (void)state;
  has_only("model s\ncoord th, phi\nparam m = 2 > 0, l = 1 > 0, g = 9.81\nlagrangian = m*l^2/2*(th'^2 + "
           "sin(th)^2*phi'^2) + m*g*l*cos(th)\nobserve A_phi = 1\n",
           2);
  has_only(
      "model t\ncoord x1, x2, x3\nlagrangian = (x1'^2 + x2'^2 + x3'^2)/2 - exp(x1 - x2) - exp(x2 - x3) - exp(x3 - x1)\n"
      "observe A_x1 = 1\nobserve A_x2 = 1\nobserve A_x3 = 1\nobserve B_x1 = t\nobserve B_x2 = t\nobserve B_x3 = t\n",
      3);
}

/* L contains t: the energy is none of the charges; shifts along the free oscillation are. The third one is the
 * energy about the forced oscillation, whose amplitude a/(m (w^2 - v^2)) is no product of powers: it is counted, not
 * listed. */
static void driven(void **state) {
  (void)state;
  Model_ m = model("model o\ncoord x\nparam m = 2 > 0, w = 3 > 0, a = 0.5, v = 1.5 > 0\nlagrangian = m/2*x'^2 - "
                   "m*w^2/2*x^2 + a*x*cos(v*t)\n"
                   "observe A_x = cos(w*t)\nobserve B_x = sin(w*t)\n");
  assert_int_equal(m.found.all.n, 2);
  assert_int_equal(m.found.unproved, 1);
  conserved(&m);
  contains_textbook(&m);
  arena_free(m.arena);
}

/* F has any part that is a function of t alone: of boosts by Newton's law, F = m x - g t^3/3 in a field that grows,
 * and F = m x - g (cos(k t) + k t sin(k t))/k^2 in one that oscillates. In the frame that falls as g t^3/6 the
 * energy is conserved. */
static void growing_field(void **state) {
  (void)state;
  has_only("model f\ncoord x\nparam m = 2 > 0, g = 3\nlagrangian = m/2*x'^2 - g*t*x\nobserve A_x = 1\nobserve "
           "B_x = t\nobserve C_x = g*t^2/2\nobserve C_t = -m\n",
           3);
  has_only("model f\ncoord x, y\nparam m = 2 > 0, g = 3, k = 2 > 0\nlagrangian = m/2*(x'^2 + y'^2) - "
           "g*cos(k*t)*x\nobserve A_x = t\nobserve B_y = t\n",
           6);
}

/* Attraction that fades as 1/t (I.V. Meshcherskii 1893; J.P. Vinti, MNRAS 169 (1974) 417, DOI
 * 10.1093/mnras/169.3.417): time -1/t makes it Kepler's problem, whose energy and angular momentum it keeps. */
static void fading_attraction(void **state) {
  (void)state;
  Model_ m = finds("model v\ncoord x, y\nparam k = 1 > 0\nlagrangian = (x'^2 + y'^2)/2 + k/(t*hypot(x, y))\nobserve "
                   "A_x = -y\nobserve A_y = x\nobserve B_x = t*x\nobserve B_y = t*y\nobserve B_t = t^2\n",
                   2);
  assert_string_equal(m.found.all.at[1].name, "expansion");
  arena_free(m.arena);
}

/* Modes of coupled oscillators, whose rates are roots of sums of parameters: the energy and four shifts; of three
 * masses six, and a rotation of the pair of equal rates. */
static void coupled(void **state) {
  (void)state;
  has_only("model c\ncoord x, y\nparam m = 1.3 > 0, k = 1.1 > 0, c = 0.3 > 0\nlet w = sqrt((k + 2*c)/m)\n"
           "lagrangian = m/2*(x'^2 + y'^2) - k/2*(x^2 + y^2) - c/2*(x - y)^2\nobserve A_x = cos(w*t)\nobserve "
           "A_y = -cos(w*t)\nobserve B_x = sin(w*t)\nobserve B_y = -sin(w*t)\n",
           5);
  has_only("model c\ncoord x, y, z\nparam m = 1.3 > 0, k = 1.1 > 0, c = 0.3 > 0\nlet w = sqrt((k + 3*c)/m)\n"
           "lagrangian = m/2*(x'^2 + y'^2 + z'^2) - k/2*(x^2 + y^2 + z^2) - c/2*((x - y)^2 + (y - z)^2 + (z - x)^2)\n"
           "observe A_x = cos(w*t)\nobserve A_y = -cos(w*t)\nobserve B_x = y - z\nobserve B_y = z - x\nobserve B_z = "
           "x - y\n",
           8);
}

/* Penning's trap holds for b^2 > 2 k m only (L.S. Brown, G. Gabrielse, Rev. Mod. Phys. 58 (1986) 233, DOI
 * 10.1103/RevModPhys.58.233): the energy, angular momentum and shifts along three motions, axial, cyclotron and
 * magnetron, two each. Where it does not hold, two of these spiral. */
static void trap(void **state) {
  (void)state;
  counts("model p\ncoord x, y, z\nparam m = 1.3 > 0, b = 3 > 0, k = 0.4 > 0\n"
         "lagrangian = m/2*(x'^2 + y'^2 + z'^2) + b/2*(x*y' - y*x') - k/4*(2*z^2 - x^2 - y^2)\n",
         8);
}

static void constrained(void **state) {
  (void)state;
  has_only("model s\ncoord x, y, z\nparam g = 9.81, l = 1 > 0\nlagrangian = (x'^2 + y'^2 + z'^2)/2 - g*z\n"
           "constraint rod: x^2 + y^2 + z^2 = l^2\nobserve A_x = -y\nobserve A_y = x\nobserve B_t = 1\n",
           2);
  /* the arm carries the bead round: neither the energy nor angular momentum, but the energy in the turning frame */
  has_only("model s\ncoord x, y\nparam w = 1\nlagrangian = (x'^2 + y'^2)/2\nconstraint arm: x*sin(w*t) = y*cos(w*t)\n"
           "observe A_x = -w*y\nobserve A_y = w*x\nobserve A_t = 1\n",
           1);
  /* a ball on a turntable: the energy seen by the table, momenta about the place of contact, and what moves with
   * them */
  has_only("model b\ncoord x, y, a, b\nparam m = 1 > 0, R = 0.5 > 0, I = 0.3 > 0, W = 2\nlagrangian = "
           "m/2*(x'^2 + y'^2) + I/2*(a'^2 + b'^2)\n"
           "constraint r: x' - R*b' = -W*y\nconstraint s: y' + R*a' = W*x\n"
           "observe A_x = -W*y\nobserve A_y = W*x\nobserve A_t = 1\nobserve B_x = R\nobserve B_b = 1\nobserve "
           "C_y = R*t\nobserve C_a = -t\n",
           6);
}

/* A free body: the angular momentum in space, to which the quaternion turns twice as fast; L*(1, 0, 0) of R*l is the
 * textbook's. */
static void rotations(void **state) {
  (void)state;
  static const char *const spins[3] = {"spin.x", "spin.y", "spin.z"};
  Model_ m = counted("model b\ncoord R: rotation\nparam A = 2 > 0, B = 1 > 0, C = 0.7 > 0\nlet w = omega(R)\nkinetic = "
                   "A/2*w.x^2 + B/2*w.y^2 + C/2*w.z^2\npotential = 0\n"
                   "observe spin = R*(A*w.x, B*w.y, C*w.z)\n", 4);
  StateSolver *solver = states_new(m.e);
  for (int turn = 0; turn < 4; turn++) {
    long double *symbols = random_point(m.e);
    assert_true(states_complete(solver, symbols));
    for (uint32_t k = 0; k < 3; k++) {
      const FoundSymmetry *s = &m.found.all.at[k + 1];
      Expr spin = observed(m.e, spins[k]);
      long double Q, L;
      assert_string_equal(s->name,
                          arena_printf(m.arena, "turns about %c in space: twice the angular momentum", "xyz"[k]));
      expr_eval(m.e->g, &s->is.charge, 1, symbols, &Q);
      expr_eval(m.e->g, &spin, 1, symbols, &L);
      assert_true(fabsl(Q - 2 * L) < 1e-15L * (1 + fabsl(Q)) * 100);
    }
  }
  conserved(&m);
  arena_free(m.arena);
}

/* Three vortices: Kirchhoff's invariants, and sl(2) of the centre of vorticity, of which one turn is the common
 * one's own part. */
static void first_order(void **state) {
  (void)state;
  Model_ m = model("model v\ncoord x1, y1, x2, y2\nparam a = 1, b = 2\nlagrangian = a*(x1*y1' - y1*x1')/2 + b*(x2*y2' "
                   "- y2*x2')/2 + a*b*log((x1 - x2)^2 + (y1 - y2)^2)\n"
                   "observe A_x1 = 1\nobserve A_x2 = 1\nobserve B_x1 = -y1\nobserve B_x2 = -y2\nobserve B_y1 = "
                   "x1\nobserve B_y2 = x2\n");
  contains_textbook(&m);
  assert_int_equal(m.found.unproved, 0);
  conserved(&m);
  arena_free(m.arena);
}

/* A frame that turns sees as many symmetries as one at rest: of a free particle n(n + 3)/2 + 3, of two bodies in
 * space 13. What is constant in a frame at rest, A and D, is (cos wt, -sin wt) and (sin wt, cos wt); boosts are that
 * times t, C is the energy there. Exponentials meet t in x'y'. */
static void turning_frame(void **state) {
  (void)state;
#define TURNING "kinetic = m1/2*((x' - w*y)^2 + (y' + w*x)^2)"
  has_only("model r\ncoord x, y\nparam m1 = 2 > 0, w = 0.7 > 0\n" TURNING
           "\npotential = 0\nobserve A_x = cos(w*t)\nobserve A_y = -sin(w*t)\nobserve B_x = t*cos(w*t)\nobserve B_y = "
           "-t*sin(w*t)\n"
           "observe C_t = 1\nobserve C_x = w*y\nobserve C_y = -w*x\nobserve D_x = sin(w*t)\nobserve D_y = "
           "cos(w*t)\nobserve E_x = t*sin(w*t)\nobserve E_y = t*cos(w*t)\n",
           8);
  has_only("model r\ncoord x, y, z\nparam m1 = 2 > 0, w = 0.7\n" TURNING
           " + m1/2*z'^2\npotential = 0\nobserve B_x = t*cos(w*t)\nobserve B_y = -t*sin(w*t)\n"
           "observe F_x = -z*sin(w*t)\nobserve F_y = -z*cos(w*t)\nobserve F_z = x*sin(w*t) + y*cos(w*t)\n",
           12);
  if (slow(1, 0))
    has_only("model r\ncoord x, y, z, a, b, c\nparam m1 = 2 > 0, m2 = 3 > 0, w = 0.7 > 0, G = 1 > 0\n" TURNING
             " + m2/2*((a' - w*b)^2 + (b' + w*a)^2) + m1/2*z'^2 + m2/2*c'^2\n"
             "potential = -G*m1*m2/sqrt((x - a)^2 + (y - b)^2 + (z - c)^2)\nobserve B_x = t*cos(w*t)\nobserve B_y = "
             "-t*sin(w*t)\nobserve B_a = t*cos(w*t)\nobserve B_b = -t*sin(w*t)\n",
             13);
  /* the first search's equations are badly conditioned: it sees 13, and can write 5 */
  has_only("model r\ncoord x, y, z, a, b, c\nparam m1 = 2 > 0, m2 = 3 > 0, w = 0.7 > 0, G = 1 > 0\n" TURNING
           " + m2/2*((a' - w*b)^2 + (b' + w*a)^2) + m1/2*z'^2 + m2/2*c'^2\n"
           "potential = -G*m1*m2/((x - a)^2 + (y - b)^2 + (z - c)^2)^(5/2)\n",
           13);
  has_only("model r\ncoord x, y\nparam s = 2 > 0\nlagrangian = x'*y' + s*(x*y' - x'*y) - s^2*x*y\n", 8);
  /* x'' = -k x, y'' = -k y + x: y grows as t cos */
  has_only("model r\ncoord x, y\nparam k = 2 > 0\nlagrangian = x'*y' - k*x*y + x^2/2\n", 5);
  /* a field that stays where it is, seen from the frame: L contains t. Its expansion has t^3 cos(w t), which is not
   * looked for */
  has_only("model r\ncoord x, y\nparam m1 = 2 > 0, w = 0.7 > 0, g = 1\n" TURNING
           "\npotential = m1*g*(x*cos(w*t) - y*sin(w*t))\n"
           "observe A_x = cos(w*t)\nobserve A_y = -sin(w*t)\nobserve B_x = t*cos(w*t)\nobserve B_y = -t*sin(w*t)\n",
           7);
}

/* --- other coordinates --- */

/* xi of old coordinates at q = A Q + b is A times that of the new ones, which stand in the same places of the text. */
static void same_space(const char *old, const char *new, const long double A[2][2], const long double b[2]) {
  Model_ m = model(old), w = model(new);
  assert_int_equal(m.found.all.n, w.found.all.n);
  assert_int_equal(w.found.unproved, 0);
  conserved(&w);
  uint32_t width = width_of(&m);
  DenseRows all = {w.found.all.n, width, ARENA_ARRAY(m.arena, long double, (size_t)w.found.all.n * width), 0};
  for (uint32_t k = 0; k < w.found.all.n; k++) {
    const Generator *by = &w.found.all.at[k].by;
    test_rng = 17;
    for (uint32_t p = 0; p < POINTS; p++) {
      random_point(m.e); /* the same numbers as in values_of */
      long double *to = all.at + (size_t)k * width + p * 3, q[2], xi[2], det = A[0][0] * A[1][1] - A[0][1] * A[1][0];
      for (int i = 0; i < 2; i++) q[i] = uniform(-1, 1) - b[i];
      long double t = uniform(0, 3), *there = ARENA_ARRAY(w.arena, long double, expr_symbol_count(w.e->g) + 1);
      for (uint32_t i = 0; i < w.e->m->params.n; i++)
        expr_eval(w.e->g, &w.e->m->params.at[i].value, 1, there, &there[w.e->m->params.at[i].sym]);
      there[w.e->m->time] = t;
      there[w.e->m->coords.at[0].q] = (A[1][1] * q[0] - A[0][1] * q[1]) / det;
      there[w.e->m->coords.at[1].q] = (A[0][0] * q[1] - A[1][0] * q[0]) / det;
      for (int i = 0; i < 2; i++) expr_eval(w.e->g, &by->xi[i], 1, there, &xi[i]);
      for (int i = 0; i < 2; i++) to[i] = A[i][0] * xi[0] + A[i][1] * xi[1];
      expr_eval(w.e->g, &by->tau, 1, there, &to[2]);
    }
  }
  DenseRows space = space_of(&m);
  for (uint32_t k = 0; k < all.n; k++)
    if (!is_in(&space, all.at + (size_t)k * width))
      fail_msg("%s is no symmetry in the old coordinates", w.found.all.at[k].name);
  arena_free(m.arena);
  arena_free(w.arena);
}

#define SKEW "let x = 2*X + Y/3 + 1/2\nlet y = -X/4 + 3*Y/5 - 2\n"

static void affine_change(void **state) {
  (void)state;
  const long double A[2][2] = {{2, 1 / 3.0L}, {-0.25L, 0.6L}}, b[2] = {0.5L, -2};
  same_space("model k\ncoord x, y\nlagrangian = (x'^2 + y'^2)/2 + 1/hypot(x, y)\n",
             "model k\ncoord X, Y\n" SKEW "lagrangian = (x'^2 + y'^2)/2 + 1/hypot(x, y)\n", A, b);
  same_space("model o\ncoord x, y\nlagrangian = (x'^2 + y'^2)/2 - 2*(x^2 + y^2)\n",
             "model o\ncoord X, Y\n" SKEW "lagrangian = (x'^2 + y'^2)/2 - 2*(x^2 + y^2)\n", A, b);
  same_space("model f\ncoord x, y\nlagrangian = (x'^2 + y'^2)/2\n",
             "model f\ncoord X, Y\n" SKEW "lagrangian = (x'^2 + y'^2)/2\n", A, b);
  same_space("model h\ncoord x, y\nlagrangian = (x'^2 + y'^2)/2 - x^2*y + y^3/3\n",
             "model h\ncoord X, Y\n" SKEW "lagrangian = (x'^2 + y'^2)/2 - x^2*y + y^3/3\n", A, b);
}

/* Bodies by their places relative to the first: mass matrices that are not diagonal. Two carts with a spring, three
 * in a row; Galileo's ten for two bodies, and the three turns of their separation alone; seven in a plane, also for
 * heliocentric coordinates of three bodies. */
static void relative_coordinates(void **state) {
  (void)state;
  has_only("model c\ncoord x, u\nparam m1 = 2 > 0, m2 = 1 > 0, k = 3 > 0\nkinetic = m1/2*x'^2 + m2/2*(x' + "
           "u')^2\npotential = k/4*u^4\nobserve A_x = 1\nobserve B_x = t\n",
           3);
  has_only("model c\ncoord x, u, v\nparam m = 1 > 0, k = 2 > 0\nlet x2 = x + u\nlet x3 = x2 + v\nkinetic = m/2*(x'^2 + "
           "x2'^2 + x3'^2)\npotential = k/2*(u^2 + v^2)\n"
           "let w = sqrt(k/m)\nobserve A_x = cos(w*t)\nobserve A_u = -cos(w*t)\nobserve A_v = -cos(w*t)\n",
           7);
  counts("model b\ncoord r: vec3, d: vec3\nparam m1 = 2 > 0, m2 = 1 > 0, G = 3 > 0\nlet r2 = r + d\nkinetic = "
         "m1/2*dot(r', r') + m2/2*dot(r2', r2')\npotential = -G*m1*m2/norm(d)\n",
         13);
  has_only("model h\ncoord x, y, u1, v1, u2, v2\nparam M = 5 > 0, m1 = 2 > 0, m2 = 1 > 0, G = 3 > 0\n"
           "kinetic = M/2*(x'^2 + y'^2) + m1/2*((x' + u1')^2 + (y' + v1')^2) + m2/2*((x' + u2')^2 + (y' + v2')^2)\n"
           "potential = -G*M*m1/hypot(u1, v1) - G*M*m2/hypot(u2, v2) - G*m1*m2/hypot(u1 - u2, v1 - v2)\n"
           "observe A_x = -y\nobserve A_y = x\nobserve A_u1 = -v1\nobserve A_v1 = u1\nobserve A_u2 = -v2\nobserve A_v2 "
           "= u2\n",
           7);
}

/* Two rates that differ by a part in 1e13 to 1e6: the energy and four shifts along solutions; or the report says
 * that some may be missing. */
static void near_rates(void **state) {
  (void)state;
  static const char *const differences[] = {"1e-6", "1e-7", "1e-8", "1e-9", "1e-10", "1e-12"};
  for (size_t i = 0; i < sizeof differences / sizeof *differences; i++) {
    char lag[200];
    snprintf(lag, sizeof lag, "model n\ncoord x, y\nlagrangian = (x'^2 + y'^2)/2 - (x^2 + y^2)/2 - %s*x^2\n",
             differences[i]);
    Model_ m = model(lag);
    if (m.found.all.n != 5 && !m.found.unproved && !m.found.note)
      fail_msg("%s: %u of 5, and no word of it", differences[i], m.found.all.n);
    conserved(&m);
    arena_free(m.arena);
  }
}

/* --- scalings that have no charge --- */

/* Powers by which coordinates, time and the action scale; a first of 0: nothing scales. */
static void scales(const char *lag, int64_t first, int64_t t, int64_t action) {
  Model_ m = model(lag);
  SearchLimit limit = search_limit(60);
  Scaling s;
  assert_int_equal(noether_scaling(m.e, &s, &limit), first != 0);
  if (first)
    assert_true(num_equal(s.alpha[0], num_int(first)) && num_equal(s.beta, num_int(t)) &&
                num_equal(s.kappa, num_int(action)));
  arena_free(m.arena);
}

/* Kepler's third law, Galileo's law of fall, an oscillator's independence of amplitude (Landau & Lifshitz,
 * Mechanics, 10). */
static void scalings(void **state) {
  (void)state;
  scales("model k\ncoord x, y\nparam m = 2 > 0, k = 3 > 0\nlagrangian = m/2*(x'^2 + y'^2) + k/hypot(x, y)\n", 2, 3, 1);
  scales("model u\ncoord x, y\nparam m = 2 > 0, g = 9.81\nlagrangian = m/2*(x'^2 + y'^2) - m*g*y\n", 2, 1, 3);
  scales("model o\ncoord x\nparam m = 2 > 0, k = 3 > 0\nlagrangian = m/2*x'^2 - k/2*x^2\n", 1, 0, 2);
  /* a pendulum has none; what an input does in time is not for L to say; that of the inverse square has a charge */
  scales("model p\ncoord th\nlagrangian = th'^2/2 + cos(th)\n", 0, 0, 0);
  scales("model u\ncoord x\ninput u = sin(t)\nlagrangian = x'^2/2 - u*x\n", 0, 0, 0);
  scales("model i\ncoord x\nparam k = 2\nlagrangian = x'^2/2 - k/x^2\n", 0, 0, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(free_particle), cmocka_unit_test(uniform_field), cmocka_unit_test(kepler),
      cmocka_unit_test(oscillators), cmocka_unit_test(magnetic), cmocka_unit_test(inverse_square),
      cmocka_unit_test(bodies), cmocka_unit_test(nothing_false), cmocka_unit_test(curved), cmocka_unit_test(driven),
      cmocka_unit_test(constrained), cmocka_unit_test(first_order), cmocka_unit_test(affine_change),
      cmocka_unit_test(relative_coordinates), cmocka_unit_test(turning_frame), cmocka_unit_test(near_rates),
      cmocka_unit_test(scalings), cmocka_unit_test(rotations), cmocka_unit_test(many), cmocka_unit_test(growing_field),
      cmocka_unit_test(fading_attraction), cmocka_unit_test(coupled), cmocka_unit_test(trap),
  };
  return cmocka_run_group_tests_name("found", tests, NULL, NULL);
}
