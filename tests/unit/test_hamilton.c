/* The Hamiltonian: with p = dL/dq' put in, H must be the energy p q' - L, q' must be q', and p' the change of p
 * along the motion, dL/dq + Q + A^T lambda; and H itself must be free of velocities. Together they say that the
 * Legendre transformation is right whatever form H takes. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "compile_text.h"
#include "mech/hamilton.h"
#include "model/printed_text.h"
#include "sym/print.h"
#include "sym/prove.h"

typedef struct {
  Arena *arena;
  Eqns *e;
  Hamilton h;
} Side;

static Side side(const char *lag) {
  Side s = {.arena = test_arena()};
  s.e = equations(s.arena, lag, NULL);
  assert_non_null(s.e);
  s.h = hamilton_derive(s.e);
  return s;
}

/* With momenta replaced by what they are. */
static Expr in_velocities(const Side *s, Expr x) { return expr_replace(s->e->g, x, s->h.p, s->e->p, s->e->n); }

static void same(const Side *s, const char *what, Expr got, Expr expected) {
  Expr left = expr_sub(s->e->g, in_velocities(s, got), expected);
  if (prove_zero(s->e->g, left, NULL) == PROVED_ZERO) return;
  StrBuf b = strbuf(s->arena);
  expr_print(s->e->g, got, PRINT_TEXT, &b);
  fail_msg("%s is %s", what, sb_text(&b));
}

static void is_right(const char *lag) {
  Side s = side(lag);
  ExprGraph *g = s.e->g;
  if (!s.h.is_closed) fail_msg("not in closed form: %s", s.h.why_not);
  assert_int_equal(expr_kinds(g, s.h.H) & 1u << SYM_VEL, 0);
  same(&s, "H", s.h.H, s.e->energy);
  for (uint32_t i = 0; i < s.e->n; i++) {
    Expr force = expr_add(g, s.e->dLdq[i], s.e->Q[i]);
    assert_int_equal((expr_kinds(g, s.h.rate[i]) | expr_kinds(g, s.h.force[i])) & 1u << SYM_VEL, 0);
    for (uint32_t k = 0; k < s.e->constraints.A.n; k++)
      if (s.e->constraints.A.at[k].col == i) {
        Expr lambda = expr_symbol(g, s.e->constraints.of[s.e->constraints.A.at[k].row]->multiplier)->node;
        force = expr_add(g, force, expr_mul(g, s.e->constraints.A.at[k].e, lambda));
      }
    same(&s, "q'", s.h.rate[i], expr_symbol(g, s.e->m->coords.at[i].v)->node);
    same(&s, "p'", s.h.force[i], force);
  }
  arena_free(s.arena);
}

static void diagonal(void **state) {
  (void)state;
  is_right("model p\ncoord th\nparam m = 1 > 0, g = 9.81, l = 2 > 0\nlagrangian = m*l^2/2*th'^2 + m*g*l*cos(th)\n");
  is_right("model s\ncoord th, phi\nparam m = 1 > 0, g = 9.81, l = 2 > 0\nlagrangian = m*l^2/2*(th'^2 + "
           "sin(th)^2*phi'^2) + m*g*l*cos(th)\n");
}

static void coupled(void **state) {
  (void)state;
  is_right("model d\ncoord a, b\nparam m1 = 1 > 0, m2 = 2 > 0, l1 = 1 > 0, l2 = 2 > 0, g = 9.81\n"
           "lagrangian = (m1 + m2)/2*l1^2*a'^2 + m2/2*l2^2*b'^2 + m2*l1*l2*a'*b'*cos(a - b) + (m1 + m2)*g*l1*cos(a) + "
           "m2*g*l2*cos(b)\n");
  is_right("model t\ncoord x, y, z\nparam m = 1 > 0, c = 0.1\nlagrangian = m/2*(x'^2 + y'^2 + z'^2) + c*(x'*y' + y'*z' "
           "+ 2*x'*z') - x*y*z\n");
  /* two blocks in one another's places */
  is_right("model t\ncoord x, y, z, w\nparam m = 1 > 0, c = 0.1\nlagrangian = m/2*(x'^2 + y'^2 + z'^2 + w'^2) + "
           "c*(x'*z' + 2*y'*w'*cos(y)) - x*y\n");
}

/* Terms linear in velocities: charges in fields, turning frames, a drive that depends on time. */
static void magnetic(void **state) {
  (void)state;
  is_right("model b\ncoord x, y\nparam m = 2 > 0, b = 3, k = 1\nlagrangian = m/2*(x'^2 + y'^2) + b/2*(x*y' - y*x') - "
           "k*x^2\n");
  is_right("model r\ncoord x, y\nparam w = 3\nlagrangian = ((x' - w*y)^2 + (y' + w*x)^2)/2 + 1/hypot(x, y)\n");
  is_right("model k\ncoord th\nparam a = 0.1, w = 30, g = 9.81\nlet x = sin(th)\nlet y = a*cos(w*t) - "
           "cos(th)\nlagrangian = (x'^2 + y'^2)/2 - g*y\n");
}

static void forces(void **state) {
  (void)state;
  is_right("model f\ncoord x, y\nparam m = 2 > 0, c = 0.1, b = 1\ninput u = sin(t)\nlagrangian = m/2*(x'^2 + y'^2) + "
           "b*x*y' - x^4\ndissipation = c/2*(x'^2 + y'^2)\nforce x = u\n");
  is_right("model s\ncoord x, y\nparam m = 2 > 0, g = 9.81, l = 1 > 0\nlagrangian = m/2*(x'^2 + y'^2) - "
           "m*g*y\nconstraint rod: x^2 + y^2 = l^2\n");
}

/* What is left to the program says why. */
static void open_forms(void **state) {
  (void)state;
  Side s =
      side("model c\ncoord a, b, c, d\nlagrangian = (a'^2 + b'^2 + c'^2 + d'^2)/2 + 0.1*(a'*b' + b'*c' + c'*d')\n");
  assert_false(s.h.is_closed);
  assert_non_null(s.h.why_not);
  arena_free(s.arena);
  s = side("model r\ncoord x\nlagrangian = -sqrt(1 - x'^2) - x^2/2\n");
  assert_false(s.h.is_closed);
  assert_string_equal(s.h.why_not, "L is not quadratic in velocities");
  arena_free(s.arena);
}

/* A printed formula is read again: slips that a printer could make are seen. The force is -k*(x - l)/(a + b) -
 * c*x'*exp(-x) */
static void printed(void **state) {
  (void)state;
  static const char *const wrong[] = {
      "k*(x - l)/(a + b) - c*x'*exp(-x)",  "-k*(x - l)/(a + b) + c*x'*exp(-x)", "-k*(x - l)/a + b - c*x'*exp(-x)",
      "-k*x - l/(a + b) - c*x'*exp(-x)",   "-k*(x - l)/(a + b) - c*x'*exp(x)",  "-k*(x - l)/(a + b) - c*x'",
      "-k*(x - l)/(a + b) - c x'*exp(-x)", "-k*(x - l)/(a + b) - c*y'*exp(-x)", ""};
  static const char *const right[] = {"-k*(x - l)/(a + b) - c*x'*exp(-x)", "c*x'*exp(-x)*(-1) + (l - x)*k/(b + a)",
                                      "-(k*x - k*l)/(a + b) - c*x'/exp(x)"};
  Side s = side("model f\ncoord x, y\nparam k = 1, l = 2, a = 3, b = 4, c = 5\nlagrangian = (x'^2 + y'^2)/2\nforce x = "
                "-k*(x - l)/(a + b) - c*x'*exp(-x)\n");
  for (size_t i = 0; i < sizeof right / sizeof *right; i++) assert_true(printed_says(s.e->m, right[i], s.e->f[0]));
  for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) assert_false(printed_says(s.e->m, wrong[i], s.e->f[0]));
  arena_free(s.arena);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(diagonal), cmocka_unit_test(coupled),    cmocka_unit_test(magnetic),
      cmocka_unit_test(forces),   cmocka_unit_test(open_forms), cmocka_unit_test(printed),
  };
  return cmocka_run_group_tests_name("hamilton", tests, NULL, NULL);
}
