/* noether_prove against closed forms: delta L, F, charges and powers of textbook symmetries. Generators are written
 * as observables of the model: xi_NAME for each coordinate that moves, and tau; so are the F, the charge and the
 * power that are expected, of which F and the charge are compared up to a constant, the power exactly. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "compile_text.h"
#include "symmetry/find_symmetries_impl.h"
#include "sym/print.h"
#include "sym/prove.h"

static Expr observed(const Eqns *e, const char *name) {
  for (uint32_t i = 0; i < e->m->observes.n; i++)
    if (strcmp(e->m->observes.at[i].name, name) == 0) return e->m->observes.at[i].value;
  return 0;
}

static const char *text_of(const Eqns *e, Expr x) {
  StrBuf b = strbuf(e->m->arena);
  expr_print(e->g, x, PRINT_TEXT, &b);
  return sb_text(&b);
}

typedef struct {
  Arena *arena;
  Eqns *e;
  Noether n;
} Proof;

static Proof prove_model(const char *lag) {
  Proof p = {.arena = arena_new(NULL)};
  jmp_buf failed;
  assert_non_null(p.arena);
  if (setjmp(failed)) fail_msg("out of memory");
  arena_guard(p.arena, &failed);
  p.e = equations(p.arena, lag, NULL);
  assert_non_null(p.e);
  uint32_t n = eqns_coordinates(p.e);
  Expr *xi = ARENA_ARRAY(p.arena, Expr, n + 1);
  for (uint32_t i = 0; i < n; i++)
    xi[i] = observed(p.e, arena_printf(p.arena, "xi_%s", expr_symbol(p.e->g, eqns_coordinate(p.e, i))->name));
  p.n = noether_prove(p.e, &(Generator){.xi = xi, .tau = observed(p.e, "tau")});
  return p;
}

static void same(const Proof *p, const char *what, Expr found, const char *name) {
  Expr expected = observed(p->e, name);
  if (!expected) return;
  Expr left = expr_sub(p->e->g, found, expected);
  if (prove_zero(p->e->g, left, NULL) == PROVED_ZERO) return;
  fail_msg("%s is %s, expected %s", what, text_of(p->e, found), text_of(p->e, expected));
}

static void proves(const char *lag, Invariance is) {
  Proof p = prove_model(lag);
  if (p.n.is != is)
    fail_msg("verdict %d instead of %d; F = %s, remainder %s", p.n.is, is, text_of(p.e, p.n.F),
             text_of(p.e, p.n.remainder));
  same(&p, "F", p.n.F, "F");
  same(&p, "the charge", p.n.charge, "Q");
  same(&p, "the power", p.n.power, "P");
  same(&p, "the remainder", p.n.remainder, "left");
  arena_free(p.arena);
}

#define KEPLER "model k\ncoord x, y\nparam m = 1 > 0, k = 2 > 0\nlagrangian = m/2*(x'^2 + y'^2) + k/hypot(x, y)\n"

static void kepler(void **state) {
  (void)state;
  proves(KEPLER "observe xi_x = -y\nobserve xi_y = x\nobserve F = 0\nobserve Q = m*(x*y' - y*x')\nobserve P = 0\n",
         INVARIANT);
  proves(KEPLER "observe xi_x = y\nobserve xi_y = x\nobserve left = 2*m*x'*y' - 2*k*x*y/hypot(x, y)^3\n",
         NOT_INVARIANT);
  proves(KEPLER "observe tau = -1\nobserve Q = m/2*(x'^2 + y'^2) - k/hypot(x, y)\nobserve P = 0\n", INVARIANT);
  proves(KEPLER "observe xi_x = 1\nobserve left = -k*x/hypot(x, y)^3\nobserve P = -k*x/hypot(x, y)^3\n", NOT_INVARIANT);
}

/* Boosts: F = m x; in a uniform field what it does adds up to m g t^2/2. */
static void boosts(void **state) {
  (void)state;
  proves("model b\ncoord x\nparam m = 2 > 0\nlagrangian = m/2*x'^2\nobserve xi_x = t\nobserve F = m*x\nobserve Q = "
         "m*t*x' - m*x\n",
         INVARIANT_UP_TO_F);
  proves("model b\ncoord x\nparam m = 2 > 0, g = 9.81\nlagrangian = m/2*x'^2 - m*g*x\nobserve xi_x = t\nobserve F = "
         "m*x - m*g*t^2/2\nobserve P = 0\n",
         INVARIANT_UP_TO_F);
  proves("model b\ncoord x\nparam m = 2 > 0, g = 9.81\nlagrangian = m/2*x'^2 - m*g*x\nobserve xi_x = 1\nobserve F = "
         "-m*g*t\nobserve Q = m*x' + m*g*t\n",
         INVARIANT_UP_TO_F);
  proves("model b\ncoord x\nparam m = 2 > 0, k = 3\nlagrangian = m/2*x'^2 - k/4*x^4\nobserve xi_x = t\nobserve F = "
         "m*x\nobserve left = -k*t*x^3\n",
         NOT_INVARIANT);
}

/* x -> x + s cos(w t) with w^2 = k/m, driven at another frequency: F has the integral of the drive, products of
 * cosines. */
static void oscillator(void **state) {
  (void)state;
  proves(
      "model o\ncoord x\nparam m = 2 > 0, w = 3 > 0, a = 0.5, v = 1.5 > 0\nlagrangian = m/2*x'^2 - m*w^2/2*x^2 + "
      "a*x*cos(v*t)\n"
      "observe xi_x = cos(w*t)\nobserve F = -m*w*x*sin(w*t) + a/2*(sin((v - w)*t)/(v - w) + sin((v + w)*t)/(v + w))\n"
      "observe Q = m*x'*cos(w*t) + m*w*x*sin(w*t) - a/2*(sin((v - w)*t)/(v - w) + sin((v + w)*t)/(v + w))\nobserve P = "
      "0\n",
      INVARIANT_UP_TO_F);
  proves(
      "model o\ncoord x\nparam m = 2 > 0, g = 0.3 > 0, k = 1\nlagrangian = exp(2*g*t)*(m/2*x'^2 - k/2*x^2)\n"
      "observe xi_x = -g*x\nobserve tau = 1\nobserve F = 0\nobserve Q = exp(2*g*t)*(-g*m*x*x' - m/2*x'^2 - k/2*x^2)\n",
      INVARIANT);
  proves("model o\ncoord x\nparam m = 2 > 0, g = 0.3 > 0\nlagrangian = m/2*x'^2 + x*t*exp(-g*t)\n"
         "observe xi_x = 1\nobserve F = -(t/g + 1/g^2)*exp(-g*t)\n",
         INVARIANT_UP_TO_F);
}

/* Gauge terms: magnetic translations, a gauge function with a sine, and one that is homogeneous of degree -1. */
static void gauges(void **state) {
  (void)state;
  proves("model c\ncoord x, y\nparam m = 1 > 0, b = 2\nlagrangian = m/2*(x'^2 + y'^2) + b/2*(x*y' - y*x')\n"
         "observe xi_x = 1\nobserve F = b/2*y\nobserve Q = m*x' - b*y\n",
         INVARIANT_UP_TO_F);
  proves("model c\ncoord x, y\nparam m = 1 > 0, b = 2\nlagrangian = m/2*(x'^2 + y'^2) + b*(cos(x)*x'*y + sin(x)*y')\n"
         "observe xi_x = 1\nobserve F = b*y*cos(x)\nobserve Q = m*x' \n",
         INVARIANT_UP_TO_F);
  proves("model c\ncoord x, y\nparam m = 1 > 0, b = 2\nlagrangian = m/2*(x'^2 + y'^2) + b*(x*y' - y*x')/(x^2 + y^2)\n"
         "observe xi_x = 1\nobserve F = -b*y/(x^2 + y^2)\nobserve Q = m*x'\n",
         INVARIANT_UP_TO_F);
}

/* Functions of time without an integral in closed form, and inputs: any function of time is a derivative, and their
 * part of the balance. */
static void integrals(void **state) {
  (void)state;
  proves("model e\ncoord x\nlagrangian = x'^2/2 + x*exp(-t^2)\nobserve xi_x = 1\nobserve F = 0\nobserve Q = "
         "x'\nobserve P = exp(-t^2)\nobserve left = exp(-t^2)\n",
         INVARIANT_UP_TO_F);
  proves("model e\ncoord x\ninput u = 0\nlagrangian = x'^2/2 + x*u\nobserve xi_x = t\nobserve F = x\nobserve Q = t*x' "
         "- x\nobserve P = t*u\n",
         INVARIANT_UP_TO_F);
  proves("model e\ncoord x\ninput u = 0\nlagrangian = x'^2/2 + x^2*u\nobserve xi_x = 1\nobserve P = 2*x*u\n",
         NOT_INVARIANT);
  proves("model e\ncoord x\nstate z\nflow z' = -z + x\nlagrangian = x'^2/2 + x*z\nobserve xi_x = 1\nobserve P = z\n",
         INVARIANCE_NOT_DECIDED);
}

/* x -> exp(s/2) x, t -> exp(s) t leaves an inverse-square potential alone; another power does not. */
static void scaling(void **state) {
  (void)state;
  proves("model i\ncoord x\nparam m = 1 > 0, k = 1\nlagrangian = m/2*x'^2 - k/x^2\n"
         "observe xi_x = x/2\nobserve tau = t\nobserve Q = m*x*x'/2 - t*(m/2*x'^2 + k/x^2)\n",
         INVARIANT);
  proves("model i\ncoord x\nparam m = 1 > 0, k = 1\nlagrangian = m/2*x'^2 - k/x\n"
         "observe xi_x = x/2\nobserve tau = t\nobserve left = -k/(2*x)\n",
         NOT_INVARIANT);
}

/* Friction, a drive, and an input inside L. */
static void balances(void **state) {
  (void)state;
  proves("model d\ncoord th\nparam c = 0.1, a = 1, w = 2\nlagrangian = th'^2/2 + cos(th)\ndissipation = "
         "c/2*th'^2\nforce th = a*cos(w*t)\n"
         "observe tau = -1\nobserve Q = th'^2/2 - cos(th)\nobserve P = th'*(a*cos(w*t) - c*th')\n",
         INVARIANT);
  proves("model d\ncoord x\ninput u = sin(t)\nlagrangian = x'^2/2 - u*x\nobserve tau = -1\nobserve Q = x'^2/2 + "
         "u*x\nobserve P = x*cos(t)\n",
         INVARIANT);
}

static void constrained(void **state) {
  (void)state;
  proves("model s\ncoord x, y, z\nparam g = 9.81, l = 1 > 0\nlagrangian = (x'^2 + y'^2 + z'^2)/2 - g*z\nconstraint "
         "rod: x^2 + y^2 + z^2 = l^2\n"
         "observe xi_x = -y\nobserve xi_y = x\nobserve Q = x*y' - y*x'\nobserve P = 0\n",
         INVARIANT);
  proves("model s\ncoord x, y\nlagrangian = (x'^2 + y'^2)/2 - y\nconstraint slope: y = 2*x\nobserve xi_x = 1\nobserve "
         "P = -2*lambda(slope)\n",
         INVARIANT);
  proves("model s\ncoord x, y\nparam w = 1\nlagrangian = (x'^2 + y'^2)/2\nconstraint arm: x*sin(w*t) = y*cos(w*t)\n"
         "observe tau = -1\nobserve P = -lambda(arm)*w*(x*cos(w*t) + y*sin(w*t))\n",
         INVARIANT);
  proves("model s\ncoord x, y, a\nparam w = 1\nlagrangian = (x'^2 + y'^2 + a'^2)/2 - x\nconstraint belt: x' = a' + w\n"
         "observe tau = -1\nobserve P = lambda(belt)*w\n",
         INVARIANT);
}

/* A closed contact pushes: with closed, which is 0 or 1, times lambda along the change of its gap; also where it is
 * the only constraint, and beside one that holds. */
static void contacts(void **state) {
  (void)state;
#define BALL "model b\ncoord x, y\nparam m = 2 > 0, g = 9.81 > 0\nlagrangian = m/2*(x'^2 + y'^2) - m*g*y\n"
  Proof p = prove_model(BALL "contact floor: y >= 0, restitution = 0.5\nobserve xi_y = 1\nobserve F = -m*g*t\n");
  assert_int_equal(p.n.is, INVARIANT_UP_TO_F);
  assert_false(p.n.by_value);
  assert_string_equal(text_of(p.e, p.n.power), "floor.closed*lambda(floor)");
  arena_free(p.arena);
  p = prove_model(
      BALL "contact slope: x + y >= 0, restitution = 0\nobserve xi_x = 1\nobserve xi_y = -1\nobserve F = m*g*t\n");
  assert_false(p.n.by_value);
  assert_true(expr_is_zero(p.e->g, p.n.power));
  arena_free(p.arena);
  p = prove_model(
      BALL "constraint rail: y = x/2\ncontact wall: x >= 0, restitution = 0\nobserve xi_x = 2\nobserve xi_y = 1\n");
  assert_int_equal(p.n.broken, 0);
  assert_string_equal(text_of(p.e, p.n.power), "2*wall.closed*lambda(wall)");
  arena_free(p.arena);
}

/* L = theta q' - H: rotations of the plane for vortices. */
static void first_order(void **state) {
  (void)state;
  proves("model v\ncoord x, y\nparam k = 1 > 0\nlagrangian = k*(x*y' - y*x')/2 - (x^2 + y^2)^2\nobserve xi_x = "
         "-y\nobserve xi_y = x\n"
         "observe Q = k*(x^2 + y^2)/2\nobserve P = 0\n",
         INVARIANT);
}

/* By hand: with H = r^4/4 and Q_x = -a x', x' = -r^2 y and y' = r^2 x - a r^2 y; so (r^2/2)' = -a r^2 y^2, H' = r^2
 * (r^2/2)'. */
static void first_order_forced(void **state) {
  (void)state;
#define EDDY "model v\ncoord x, y\nparam a = 0.7\nlagrangian = (x*y' - y*x')/2 - (x^2 + y^2)^2/4\n"
  static const char *const drags[] = {EDDY "force x = -a*x'\n", EDDY "dissipation = a/2*x'^2\n"};
  for (int i = 0; i < 2; i++) {
    char lag[1000];
    snprintf(lag, sizeof lag, "%sobserve xi_x = -y\nobserve xi_y = x\nobserve P = -a*(x^2 + y^2)*y^2\n", drags[i]);
    proves(lag, INVARIANT);
    snprintf(lag, sizeof lag, "%sobserve tau = -1\nobserve P = -a*(x^2 + y^2)^2*y^2\n", drags[i]);
    proves(lag, INVARIANT);
  }
  proves(EDDY "force x = -a*x\nobserve xi_x = -y\nobserve xi_y = x\nobserve P = a*x*y\n", INVARIANT);
}

/* A free particle whose L has dG/dt besides: its charges are those of the free particle, and F = xi grad G + tau
 * dG/dt and what that has, though G is no combination of what an integration by parts knows. With a potential the
 * same ones are false. */
#define GAUGED                                                                                        \
  "model g\ncoord x, y\nparam k = 1\nlet G = x^2*y*exp(x*y) + log(1 + x^2 + exp(y)) + atan(x*y)*t + " \
  "x^3*exp(sin(x*y))\n"
#define FREE "lagrangian = (x'^2 + y'^2)/2 + d(G, x)*x' + d(G, y)*y' + d(G, t)\n"
#define BOUND "lagrangian = (x'^2 + y'^2)/2 + d(G, x)*x' + d(G, y)*y' + d(G, t) - k*x^4\n"

static void any_gauge(void **state) {
  (void)state;
  proves(GAUGED FREE "observe xi_x = 1\nobserve Q = x'\nobserve F = d(G, x)\nobserve P = 0\n", INVARIANT_UP_TO_F);
  proves(GAUGED FREE "observe xi_x = -y\nobserve xi_y = x\nobserve Q = x*y' - y*x'\nobserve F = x*d(G, y) - y*d(G, "
                     "x)\nobserve P = 0\n",
         INVARIANT_UP_TO_F);
  proves(GAUGED FREE "observe xi_x = t\nobserve Q = t*x' - x\nobserve F = x + t*d(G, x)\nobserve P = 0\n",
         INVARIANT_UP_TO_F);
  proves(GAUGED FREE "observe tau = -1\nobserve Q = (x'^2 + y'^2)/2\nobserve F = -atan(x*y)\nobserve P = 0\n",
         INVARIANT_UP_TO_F);
  proves(GAUGED FREE "observe xi_x = x\nobserve xi_y = y\nobserve tau = 2*t\nobserve Q = x*x' + y*y' - t*(x'^2 + "
                     "y'^2)\nobserve P = 0\n",
         INVARIANT_UP_TO_F);
  proves(GAUGED BOUND "observe xi_x = 1\n", NOT_INVARIANT);
  proves(GAUGED BOUND "observe xi_y = 1\nobserve Q = y'\nobserve P = 0\n", INVARIANT_UP_TO_F);
  proves(GAUGED BOUND "observe xi_x = -y\nobserve xi_y = x\n", NOT_INVARIANT);
}

/* Of a free particle in a plane: combinations of shifts and turns that are known are left out, others stay. */
static void joined_symmetries(void **state) {
  (void)state;
  Proof p = prove_model("model m\ncoord x, y\nlagrangian = (x'^2 + y'^2)/2\nobserve xi_x = 1\n");
  ExprGraph *g = p.e->g;
  Expr zero = expr_int(g, 0), one = expr_int(g, 1), t = expr_symbol(g, p.e->m->time)->node;
  Expr x = expr_symbol(g, p.e->m->coords.at[0].q)->node, y = expr_symbol(g, p.e->m->coords.at[1].q)->node;
  const Expr shift_x[] = {one, zero}, shift_y[] = {zero, one}, both[] = {expr_int(g, 3), expr_int(g, -2)};
  const Expr turn[] = {expr_neg(g, y), x}, about[] = {expr_sub(g, one, y), x}, scale[] = {x, y}, still[] = {zero, zero};
  const Generator usual[] = {{still, expr_int(g, -1)}, {shift_x, zero}, {shift_y, zero}, {turn, zero}},
                  found[] = {{both, zero}, {scale, expr_add(g, t, t)}, {about, zero}, {shift_x, t}};
  FoundSymmetries first = {0}, second = {0};
  for (int k = 0; k < 4; k++) {
    vec_push(p.arena, &first.all, ((FoundSymmetry){.by = usual[k]}));
    vec_push(p.arena, &second.all, ((FoundSymmetry){.by = found[k]}));
  }
  FoundSymmetries all = join_symmetries(p.e, &first, &second), other = join_symmetries(p.e, &second, &first);
  assert_int_equal(all.all.n, 6);
  assert_ptr_equal(all.all.at[4].by.xi, scale);
  assert_ptr_equal(all.all.at[5].by.xi, shift_x);
  assert_int_equal(other.all.n, 6);
  assert_ptr_equal(other.all.at[2].by.xi, about);
  arena_free(p.arena);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(joined_symmetries),
                                     cmocka_unit_test(kepler),      cmocka_unit_test(boosts),
                                     cmocka_unit_test(oscillator),  cmocka_unit_test(gauges),
                                     cmocka_unit_test(integrals),   cmocka_unit_test(scaling),
                                     cmocka_unit_test(balances),    cmocka_unit_test(constrained),
                                     cmocka_unit_test(first_order), cmocka_unit_test(first_order_forced),
                                     cmocka_unit_test(contacts),    cmocka_unit_test(any_gauge)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
