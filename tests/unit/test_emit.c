/* Programs against the equations they come from, and what the writers of C promise. The models are
 * all of models/ and tests/exec/models/, in every scene; run from the top of the source tree. */
#include <glob.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "base/dense_matrix.h"
#include "emit/cwriter.h"
#include "lower/lower.h"
#include "mech/lagrange.h"
#include "slow.h"
#include "sym/expr_eval.h"
#include "symmetry/charges.h"
#include "syntax/parse.h"

typedef long double Real;

static Arena *arena;
static jmp_buf no_memory;

static int setup(void **state) {
  (void)state;
  arena = arena_new(NULL);
  if (!arena || setjmp(no_memory)) return -1;
  arena_guard(arena, &no_memory);
  return 0;
}

static int teardown(void **state) {
  (void)state;
  arena_free(arena);
  return 0;
}

static Real next(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return 1.5L * ((Real)(*seed >> 11) / 9007199254740992.0L - 0.5L);
}

/* --- M q'' = f --- */

/* Values of all symbols at a random state; q'' and z' are left zero. */
static Real *random_symbols(const Eqns *e, uint64_t *seed) {
  uint32_t n = expr_symbol_count(e->g);
  Real *v = ARENA_ARRAY(arena, Real, n + 1);
  for (SymId s = 1; s <= n; s++) {
    const Symbol *sym = expr_symbol(e->g, s);
    v[s] = next(seed);
    if (sym->kind == SYM_PARAM) v[s] = 1 + v[s] / 2; /* positive: what the models ask for */
    if (sym->kind == SYM_VEL) v[s] *= 0.3L;        /* below the speed of light, which is a parameter */
    if (sym->kind == SYM_CONST) v[s] = 3.14159265358979323846264338327950288L;
  }
  /* more of them at once hold no motion */
  for (uint32_t i = e->n; i < e->m->contacts.n; i++) v[e->m->contacts.at[i].closed] = 0;
  Name first = model_conditional(e->m); /* of constraints with `while`, which contradict each other, it alone holds */
  for (uint32_t i = 0; i < e->m->contacts.n; i++)
    if (e->m->contacts.at[i].margin) v[e->m->contacts.at[i].closed] = e->m->contacts.at[i].name == first;
  return v;
}

/* The arrays that a program reads, from the values of the symbols. */
static void split(const Eqns *e, const Real *value, Real *in[ARR_COUNT]) {
  uint32_t n = expr_symbol_count(e->g);
  for (int k = 0; k < ARR_COUNT; k++) in[k] = ARENA_ARRAY(arena, Real, n + 1);
  for (SymId s = 1; s <= n; s++) {
    const Symbol *sym = expr_symbol(e->g, s);
    switch (sym->kind) {
      case SYM_TIME: in[ARR_T][0] = value[s]; break;
      case SYM_COORD: in[ARR_Q][sym->index] = value[s]; break;
      case SYM_VEL: in[ARR_V][sym->index] = value[s]; break;
      case SYM_STATE: in[ARR_Z][sym->index] = value[s]; break;
      case SYM_PARAM: in[ARR_P][sym->index] = value[s]; break;
      case SYM_INPUT: in[ARR_U][sym->index] = value[s]; break;
      case SYM_ACC: case SYM_RATE: case SYM_CONST: case SYM_MULTIPLIER: case SYM_LOCAL: break;
    }
  }
}

static Real value_of(const Eqns *e, Expr x, const Real *value) {
  Real r;
  expr_eval(e->g, &x, 1, value, &r);
  return r;
}

/* What is left of a residual that no multiplier can take away: its part in the kernel of A. */
static void take_away_multipliers(const Eqns *e, const Real *value, Real *left) {
  const Entries *A = &e->constraints.A;
  uint32_t n = e->n, w = n + e->constraints.n;
  Real *K = ARENA_ARRAY(arena, Real, w * w), *x = ARENA_ARRAY(arena, Real, w);
  for (uint32_t i = 0; i < n; i++) K[i * w + i] = 1, x[i] = left[i];
  for (uint32_t k = 0; k < A->n; k++)
    K[(n + A->at[k].row) * w + A->at[k].col] = K[A->at[k].col * w + n + A->at[k].row] = value_of(e, A->at[k].e, value);
  dense_solve(arena, w, K, x, 1e-15L, NULL);
  for (uint32_t i = 0; i < n; i++) left[i] = x[i];
}

/* Scales x[n] to length 1, and returns what that was. */
static Real normalise(uint32_t n, Real *x) {
  Real size = 0;
  for (uint32_t i = 0; i < n; i++) size += x[i] * x[i];
  for (uint32_t i = 0; i < n && size > 0; i++) x[i] /= sqrtl(size);
  return sqrtl(size);
}

/* The least part of a constraint that is independent of those before it, by Gram and Schmidt. */
static Real independence(const Eqns *e, const Real *value) {
  const Entries *A = &e->constraints.A;
  uint32_t n = e->n, m = e->constraints.n;
  Real *Q = ARENA_ARRAY(arena, Real, (size_t)m * n + 1), least = 1;
  for (uint32_t k = 0; k < A->n; k++) Q[A->at[k].row * n + A->at[k].col] = value_of(e, A->at[k].e, value);
  for (Real *row = Q; row < Q + m * n; row += n) {
    normalise(n, row);
    for (const Real *before = Q; before < row; before += n) {
      Real along = 0;
      for (uint32_t i = 0; i < n; i++) along += row[i] * before[i];
      for (uint32_t i = 0; i < n; i++) row[i] -= along * before[i];
    }
    least = fminl(least, normalise(n, row));
  }
  return least;
}

/* A q'' against what it must be, but for states next to dependent constraints, of which one is left out. */
static void check_demand(const Eqns *e, const char *where, const Real *value, const Real *a) {
  const Constraints *k = &e->constraints;
  if (independence(e, value) < 0.02L) return; /* their rank is judged coarsely: lag_kkt.h */
  for (uint32_t row = 0; row < k->n; row++) {
    Real want = value_of(e, k->demand[row], value), left = -want, size = 1 + fabsl(want);
    for (uint32_t j = 0; j < k->A.n; j++) {
      Real term = k->A.at[j].row == row ? value_of(e, k->A.at[j].e, value) * a[k->A.at[j].col] : 0;
      left += term;
      size += fabsl(term);
    }
    if (!(fabsl(left) <= 1e-15L * size))
      fail_msg("%s: constraint %s is left with %Lg of %Lg", where, k->of[row]->name, left, size);
  }
}

/* |M q'' - f| against |M| |q''| + |f|: rounding is 1e-19, and f itself is a sum with cancellation. */
static void check_state(const Eqns *e, const Prog *accel, const char *where, const Real *value) {
  Real *in[ARR_COUNT], *a = ARENA_ARRAY(arena, Real, e->n + 1), *zd = ARENA_ARRAY(arena, Real, e->m->states.n + 1);
  Real *out[] = {a, zd};
  split(e, value, in);
  if (prog_eval(accel, (const Real *const *)in, out) != 0) fail_msg("%s: singular", where);
  Real *left = ARENA_ARRAY(arena, Real, e->n + 1), *size = ARENA_ARRAY(arena, Real, e->n + 1);
  for (uint32_t i = 0; i < e->n; i++)
    if (isnan(value_of(e, e->system.f[i], value))) return; /* a state outside of the model's domain */
  for (uint32_t i = 0; i < e->n; i++) {
    Real f = value_of(e, e->system.f[i], value);
    left[i] = -f;
    size[i] = 1 + fabsl(f);
    for (uint32_t j = 0; j < e->n; j++) {
      Real term = value_of(e, eqns_mass(e, i, j), value) * a[j];
      left[i] += term;
      size[i] += fabsl(term);
    }
  }
  if (e->constraints.n) take_away_multipliers(e, value, left);
  for (uint32_t i = 0; i < e->n; i++)
    if (!(fabsl(left[i]) <= 1e-15L * size[i]))
      fail_msg("%s: row %u is left with %Lg of %Lg", where, i, left[i], size[i]);
  check_demand(e, where, value, a);
  for (uint32_t i = 0; i < e->m->states.n; i++) {
    Real want = value_of(e, e->flow[i], value);
    if (isnan(zd[i]) && isnan(want)) continue; /* the root of a negative number, at a random state */
    if (!(fabsl(zd[i] - want) <= 1e-15L * (1 + fabsl(want))))
      fail_msg("%s: rate %u is %Lg, not %Lg", where, i, zd[i], want);
  }
}

static void check_scene(Ast *ast, const char *path, const char *scene) {
  const char *where = arena_printf(arena, "%s, scene %s", path, scene);
  Model *m = model_build(ast, &(ModelChoice){.scene = scene});
  Eqns *e = m ? equations_of(m) : NULL;
  if (!e) fail_msg("%s has no equations", where);
  Prog *accel = lower_accel(e, 0);
  eqns_derive_mass(e); /* where the solution did without */
  const char *wrong = prog_verify(accel);
  if (wrong) fail_msg("%s: %s", where, wrong);
  uint64_t seed = 3;
  for (int i = 0; i < slow(10, 3); i++) check_state(e, accel, where, random_symbols(e, &seed));
}

static int check_file(const char *path) {
  Sources *sources = sources_new(arena);
  sources->library = "models/lib";
  Ast *ast = ast_new(arena, interner_new(arena), sources, diags_new(arena, sources));
  const char *why = NULL;
  const Source *source = source_read(sources, path, &why);
  if (!source || !parse(ast, source)) fail_msg("%s does not parse", path);
  SceneList scenes = model_scenes(ast);
  for (uint32_t i = 0; i < scenes.n; i++) check_scene(ast, path, scenes.at[i]);
  return 1;
}

static void test_equations(void **state) {
  (void)state;
  glob_t found;
  assert_int_equal(glob("models/*.lag", 0, NULL, &found), 0);
  assert_int_equal(glob("tests/exec/models/*.lag", GLOB_APPEND, NULL, &found), 0);
  for (size_t step = (size_t)depth(12, 4, 2), i = first_row(step); i < found.gl_pathc; i += step)
    if (light(found.gl_pathv[i])) check_file(found.gl_pathv[i]);
  globfree(&found);
}

/* --- texts --- */

static void test_names(void **state) {
  (void)state;
  static const char *const cases[][2] = {
    {"th1'", "th1_dot"}, {"x''", "x_ddot"}, {"\xCE\xB8" "1", "theta1"}, {"\xCE\xA9", "Omega"}, {"\xC3\xA9", "u00e9"},
    {"drag.c", "drag_c"}, {"double", "double_"}, {"I", "I_"}, {"sin", "sin_"}, {"_a", "x_a"}, {"2x", "n2x"},
    {"size_t", "size_t_"}, {"M_PI", "M_PI_"}, {"gamma", "gamma"},
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) assert_string_equal(cname(arena, cases[i][0]), cases[i][1]);
  CNames names = cnames_new(arena);
  assert_string_equal(cnames_take(&names, "x'"), "x_dot");
  assert_string_equal(cnames_take(&names, "x_dot"), "x_dot_2");
  assert_string_equal(cnames_take(&names, "double"), "double_");
  assert_string_equal(cnames_take(&names, "double_"), "double_2");
}

static void test_strings(void **state) {
  (void)state;
  assert_string_equal(c_string(arena, "a\"b\\c"), "\"a\\\"b\\\\c\"");
  assert_string_equal(c_string(arena, "what?\?\?/"), "\"what?\\?\\?/\"");
  assert_null(strstr(comment_text(arena, "a*/b/*c**//"), "*/"));
  assert_null(strstr(comment_text(arena, "a*/b/*c"), "/*"));
  assert_null(strstr(comment_text(arena, "?\?\?/"), "?\?"));
}

static void test_numbers(void **state) {
  (void)state;
  assert_string_equal(c_number(arena, "LAG", num_int(3)), "LAG_C(3.0)");
  assert_string_equal(c_number(arena, "LAG", num_ratio(-1, 8)), "-LAG_C(0.125)");
  assert_string_equal(c_number(arena, "LAG", num_ratio(1, 3)), "LAG_C(1.0)/LAG_C(3.0)");
  assert_string_equal(c_number(arena, "LAG", num_parse("9.81", 4)), "LAG_C(9.81)");
  assert_string_equal(c_number(arena, "LAG", num_parse("1.6e-19", 7)), "LAG_C(1.6e-19)");
  assert_string_equal(c_number(arena, "LAG", num_neg(num_parse("0.00002", 7))), "-LAG_C(2e-5)");
  assert_string_equal(c_number(arena, "LAG", num_parse("0.0001", 6)), "LAG_C(0.0001)");
  assert_string_equal(c_number(arena, "LAG", num_int(12000000)), "LAG_C(12e6)");
  assert_string_equal(c_number(arena, "LAG", num_int(0)), "LAG_C(0.0)");
  assert_string_equal(c_number(arena, "LAG", num_int(1200)), "LAG_C(1200.0)");
}

/* --- how sums and products are written --- */

static const char *body_with(Prog *p, const char *math, Slot s) {
  static const char *const in[ARR_COUNT] = {"t", "q", "v", "z", "p", "u"}, *const out[] = {"a"},
                           *const own[] = {"q", "a", NULL};
  CStyle style = {.prefix = "R", .in = in, .out = out, .own = own, .solve = "solve", .loads_inline = 1, .math = math};
  prog_store(p, 0, 0, s, "it");
  StrBuf b = strbuf(arena);
  cwrite_body(prog_tidy(p), &style, arena, &b);
  return sb_text(&b);
}

static const char *body(Prog *p, Slot s) { return body_with(p, NULL, s); }

static Slot q(Prog *p, uint32_t i) {
  return prog_ins(p, (Ins){.op = IR_LOAD, .array = ARR_Q, .index = i, .name = "q"});
}

static void test_grouping(void **state) {
  (void)state;
  Prog *p = prog_new(arena);
  Slot ab = prog_op(p, IR_MUL, q(p, 0), q(p, 1)), minus = prog_op(p, IR_NEG, ab, 0);
  assert_string_equal(body(p, prog_op(p, IR_SUB, q(p, 2), minus)), "\n  a[0] = q[2] + q[0]*q[1]; /* it */\n");
  p = prog_new(arena);
  Slot sum = prog_op(p, IR_ADD, q(p, 1), q(p, 2));
  assert_string_equal(body(p, prog_op(p, IR_ADD, q(p, 0), sum)), "\n  a[0] = q[0] + (q[1] + q[2]); /* it */\n");
  p = prog_new(arena);
  Slot ratio = prog_op(p, IR_DIV, q(p, 1), q(p, 2));
  assert_string_equal(body(p, prog_op(p, IR_MUL, q(p, 0), ratio)), "\n  a[0] = q[0]*(q[1]/q[2]); /* it */\n");
  p = prog_new(arena);
  Slot product = prog_op(p, IR_MUL, q(p, 0), q(p, 1));
  assert_string_equal(body(p, prog_op(p, IR_NEG, product, 0)), "\n  a[0] = -q[0]*q[1]; /* it */\n");
  p = prog_new(arena);
  Slot eighth = prog_num(p, num_ratio(-1, 8)), scaled = prog_op(p, IR_MUL, eighth, q(p, 0));
  assert_null(strchr(body(p, prog_op(p, IR_NEG, scaled, 0)), '-')); /* --0.125*q[0] is no C */
}

/* sum + sin x + cos x */
static Slot plus_circle(Prog *p, Slot sum, Slot x) {
  Slot s = prog_ins(p, (Ins){.op = IR_FN1, .a = x, .text = "sin"}),
       c = prog_ins(p, (Ins){.op = IR_FN1, .a = x, .text = "cos"});
  Slot both = prog_op(p, IR_ADD, s, c);
  return prog_op(p, IR_ADD, sum, both);
}

static int count_text(const char *text, const char *what) {
  int n = 0;
  for (const char *at = text; (at = strstr(at, what)) != NULL; at++) n++;
  return n;
}

/* Of seven angles four go by one call, two by another, one alone; that of a sum of sines waits for these and goes
 * alone, too. */
static void test_abreast(void **state) {
  (void)state;
  Prog *p = prog_new(arena);
  Slot sum = 0;
  for (uint32_t i = 0; i < 7; i++) sum = plus_circle(p, sum, q(p, i));
  const char *text = body_with(p, "r", plus_circle(p, sum, sum));
  assert_int_equal(count_text(text, "r_sincos4("), 1);
  assert_int_equal(count_text(text, "r_sincos2("), 1);
  assert_int_equal(count_text(text, "r_sincos("), 2);
  assert_true(strstr(text, "r_sincos4(") < strstr(text, "r_sincos2(") &&
              strstr(text, "r_sincos2(") < strstr(text, "r_sincos("));
  assert_int_equal(count_text(text, "r_sin("), 0);
  for (int i = 0; i < 7; i++)
    assert_int_equal(count_text(text, arena_printf(arena, "(q[%d], &", i)) +
                         count_text(text, arena_printf(arena, " q[%d], &", i)),
                     1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_setup_teardown(test_equations, setup, teardown),
      cmocka_unit_test_setup_teardown(test_names, setup, teardown),
      cmocka_unit_test_setup_teardown(test_strings, setup, teardown),
      cmocka_unit_test_setup_teardown(test_numbers, setup, teardown),
      cmocka_unit_test_setup_teardown(test_grouping, setup, teardown),
      cmocka_unit_test_setup_teardown(test_abreast, setup, teardown),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
