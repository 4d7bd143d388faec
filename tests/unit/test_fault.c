/* Memory runs out, once at each allocation (in `make test` at every third) of a compilation from text to C: every
 * time the way ends in the arena's guard, with all memory given back. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "emit/cnames.h"
#include "emit/cwriter.h"
#include "emit/emit_model.h"
#include "lower/lower.h"
#include "report/equation_listing.h"
#include "slow.h"
#include "symmetry/charges.h"
#include "syntax/parse.h"

typedef struct {
  long left; /* allocations until one fails */
  long alive;
} Budget;

static void *budget_alloc(void *user, size_t n) {
  Budget *b = user;
  if (b->left-- == 0) return NULL;
  void *p = malloc(n);
  if (p) b->alive++;
  return p;
}

static void budget_free(void *user, void *p) {
  ((Budget *)user)->alive--;
  free(p);
}

static const char good[] = "model cart \"a cart with a pendulum\"\n"
                           "coord x [m], th [rad] periodic\n"
                           "param M = 2 [kg] > 0, m = 1 [kg] > 0, l = 1/2 [m] > 0, g = 9.81 [m/s^2] > 0\n"
                           "const N = 3\nstate i [A]\ninput u [N] = sin(t/(1 [s]))*1 [N]\n"
                           "function square(a) = a^2\n"
                           "let px = x + l*sin(th)\nlet py = -l*cos(th)\n"
                           "lagrangian = M/2*square(x') + m/2*(px'^2 + py'^2) - m*g*py\n"
                           "force (px, py) = (u, 0)\nflow i' = -i/(1 [s])\n"
                           "effect drag { param c = 0.1 [N*s/m]; dissipation = c/2*x'^2 }\n"
                           "observe reach [cm] = abs(px)\n"
                           "event bump: x - 1 [m] rising { x' = -0.5*x'; stop }\n"
                           "scene s { use drag(c = 0.3); start th = 90 [deg]; span 3; output x, th, reach, energy "
                           "every 0.1; monitor energy 1e-6 }\n";

static const char bad[] = "model m\ncoord x [m], x [kg], q[m]\nparam k = kk, l = 1 [metre], n = -1 > 0\nlet a = b\nlet "
                          "b = a + sum(i in 1..3, i)\n"
                          "lagrangian = x'^2 + x + sin(1 [m]) + nope(x) + 1/0\nforce (x, y) = 3\nflow w' = 1\n"
                          "effect e { requires f; param c = 1 }\nscene s { use e(d = 1), g; span = 3; start y = 1; "
                          "like t; output x.y, drag.c }\n"
                          "scene t { like s }\nconstraint c: x = 1\n";

static void emit_all(Arena *a, Eqns *e) {
  ProgramSet *u = unit_new(e, "test.lag", 0);
  unit_require(u, e, WANT_VARIATION);
  unit_add_scene(u, e);
  StrBuf out = strbuf(a), text = strbuf(a);
  emit_model(u, cname(a, u->name), MODEL_PLAIN, &out);
  const char *cost = op_count_text(u->accel, a);
  show_equations(e, cost, PRINT_TEXT, &text);
  show_equations(e, cost, PRINT_LATEX, &out);
  emit_header(u, u->name, (HeaderParts){0}, sb_text(&text), &out);
}

static void compile_all(Arena *a, const char *lag, int errors) {
  Sources *sources = sources_new(a);
  Ast *ast = ast_new(a, interner_new(a), sources, diags_new(a, sources));
  const Source *source = source_add(sources, "test.lag", lag, strlen(lag));
  int parsed = parse(ast, source);
  assert_true(parsed);
  SceneList scenes = model_scenes(ast);
  for (uint32_t i = 0; i < scenes.n; i++) {
    ModelChoice choice = {.scene = scenes.at[i]};
    Model *m = model_build(ast, &choice);
    Eqns *e = m ? equations_of(m) : NULL;
    assert_int_equal(e == NULL, errors);
    if (e) emit_all(a, e);
  }
  StrBuf messages = strbuf(a);
  diags_print(ast->diags, &messages);
}

/* 1 when the way was gone to its end, 0 when memory ran out on it. */
static int with_budget(const char *lag, int errors, long n, size_t chunk, size_t max) {
  Budget budget = {n, 0};
  ArenaConfig config = {budget_alloc, budget_free, &budget, chunk, max};
  Arena *a = arena_new(&config);
  volatile int done = 0;
  if (!a) return 0;
  jmp_buf failed;
  if (!setjmp(failed)) {
    arena_guard(a, &failed);
    compile_all(a, lag, errors);
    done = 1;
  }
  arena_free(a);
  assert_int_equal(budget.alive, 0);
  return done;
}

static void test_each_allocation(void **state) {
  (void)state;
  const long step = depth(8, 2, 1);
  long n = (long)first_row((size_t)step);
  while (!with_budget(good, 0, n, 2048, 0)) n += step;
  assert_true(n > 200); /* or the chunks are too large to say anything */
}

static void test_each_allocation_of_errors(void **state) {
  (void)state;
  const long step = depth(8, 2, 1);
  long n = (long)first_row((size_t)step);
  while (!with_budget(bad, 1, n, 256, 0)) n += step;
  assert_true(n > 100);
}

/* The limit in bytes ends in the same way. */
static void test_each_limit(void **state) {
  (void)state;
  size_t max = 1000;
  int refused = 0;
  while (!with_budget(good, 0, -1, 0, max)) {
    max += max / 16;
    refused++;
  }
  assert_true(refused > 20);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_each_allocation),
    cmocka_unit_test(test_each_allocation_of_errors),
    cmocka_unit_test(test_each_limit),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
