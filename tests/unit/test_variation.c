/* What discrete mechanics needs of L, against L itself: first derivatives by differences of L, second ones by
 * differences of the first, forces by what is left of M q'' = f. All scenes of models/ and tests/exec/models/.
 * Differences are of order 4 in steps of 1e-5 and extended precision: truncation is 1e-20 times a fifth derivative,
 * rounding 1e-14. */
#include <glob.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "compile_text.h"
#include "slow.h"
#include "emit/emit_model.h"
#include "symmetry/charges.h"

typedef long double Real;

enum { MOST = 12 }; /* coordinates; differences of larger models take long */

/* A model at a state, and what its programs say there. */
typedef struct {
  const Eqns *e;
  const Prog *variation, *second;
  const Variation *x;
  const char *where;
  Real *v; /* by symbol */
} Case;

typedef struct {
  Real part[3][MOST]; /* dL/dq, dL/dq', Q */
} First;

static int first_at(const Case *c, const Real *v, First *r) {
  Real *out[3] = {r->part[0], r->part[1], r->part[2]};
  return run_prog_into(c->e, c->variation, v, out);
}

static Real lagrangian(const Case *c, const Real *v) { /* with what rotations add to it across their constraints */
  const Expr parts[2] = {c->e->m->lagrangian, c->e->m->regularising ? c->e->m->regularising : c->e->m->lagrangian};
  Real l[2];
  expr_eval(c->e->g, parts, 2, v, l);
  return c->e->m->regularising ? l[0] + l[1] : l[0];
}

static const Real step = 1e-5L, weight[4] = {1, -8, 8, -1}, place[4] = {-2, -1, 1, 2}; /* over 12 */

/* of: the size of what was differenced; off: what differences by another step say that these are off by. */
static void assert_within(const Case *c, const char *what, Real got, Real want, Real of, Real off) {
  Real size = 1 + fabsl(want) + 1e-4L * fabsl(of);
  if (isfinite(want) && !(fabsl(got - want) <= 1e-8L * size + off))
    fail_msg("%s: %s is %.12Lg, by differences %.12Lg", c->where, what, got, want);
}

static void assert_near(const Case *c, const char *what, Real got, Real want, Real of) {
  assert_within(c, what, got, want, of, 0);
}

/* d of out[k] by symbol s, for all of dL/dq, dL/dq', Q. */
static void differences(const Case *c, SymId s, Real step, First *d) {
  *d = (First){0};
  for (int k = 0; k < 4; k++) {
    First f = {0};
    Real was = c->v[s];
    c->v[s] = was + place[k] * step;
    assert_int_equal(first_at(c, c->v, &f), 0);
    c->v[s] = was;
    for (int part = 0; part < 3; part++)
      for (uint32_t i = 0; i < c->e->n; i++) d->part[part][i] += weight[k] * f.part[part][i] / (12 * step);
  }
}

static Real difference_of_l(const Case *c, SymId s) {
  Real was = c->v[s], d = 0;
  for (int k = 0; k < 4; k++) {
    c->v[s] = was + place[k] * step;
    d += weight[k] * lagrangian(c, c->v) / (12 * step);
  }
  c->v[s] = was;
  return d;
}

/* The entry of a part; zero where it is not listed. */
static Real entry(const Case *c, const Real *h, SecondPart part, uint32_t row, uint32_t col) {
  if ((part == SECOND_QQ || part == SECOND_VV) && col > row) return entry(c, h, part, col, row);
  for (uint32_t k = 0; k < c->x->second.n; k++) {
    const SecondEntry *s = &c->x->second.at[k];
    if (s->part == part && s->row == row && s->col == col) return h[k];
  }
  return 0;
}

/* Q = f - dL/dq + (dp/dq) q' + (dp/dz) z' + dp/dt. */
static void check_forces(const Case *c, const First *f, const Real *h) {
  const Model *m = c->e->m;
  First by_t;
  differences(c, m->time, 1e-6L, &by_t); /* inputs may be fast */
  for (uint32_t k = 0; k < m->inputs.n; k++) { /* which change with t, too, where their rates count */
    First by_u;
    if (!m->inputs.at[k].rate) continue;
    differences(c, m->inputs.at[k].sym, step, &by_u);
    for (uint32_t i = 0; i < c->e->n; i++)
      by_t.part[1][i] += by_u.part[1][i] * c->v[m->inputs.at[m->inputs.at[k].rate].sym];
  }
  for (uint32_t i = 0; i < c->e->n && !m->states.n; i++) {
    Real want, size = 0;
    /* without multipliers */
    expr_eval(c->e->g, c->e->constraints.n ? &c->e->system.f[i] : &c->e->f[i], 1, c->v, &want);
    want += by_t.part[1][i] - f->part[0][i];
    for (uint32_t j = 0; j < c->e->n; j++) {
      Real term = entry(c, h, SECOND_VQ, i, j) * c->v[m->coords.at[j].v];
      want += term;
      size += fabsl(term);
    }
    Real rounding = fabsl(f->part[1][i]); /* of differences of the momentum by t */
    assert_near(c, "a force", f->part[2][i], want, 1e5L * (size + fabsl(f->part[0][i])) + rounding);
  }
}

static void check_state(const Case *c) {
  static const SecondPart by_q[] = {SECOND_QQ, SECOND_VQ, SECOND_FQ}, by_v[] = {SECOND_VQ, SECOND_VV, SECOND_FV};
  const Model *m = c->e->m;
  Real *h = ARENA_ARRAY(m->arena, Real, c->x->second.n + 1);
  First f, dq, dv, finer_q, finer_v;
  if (!isfinite(lagrangian(c, c->v))) return;
  assert_int_equal(first_at(c, c->v, &f), 0);
  assert_int_equal(run_prog(c->e, c->second, c->v, h, NULL), 0);
  Real l = lagrangian(c, c->v), largest = 0;
  for (int part = 0; part < 3; part++)
    for (uint32_t i = 0; i < c->e->n; i++) largest = fmaxl(largest, fabsl(f.part[part][i]));
  for (uint32_t j = 0; j < c->e->n; j++) {
    Real lq = difference_of_l(c, m->coords.at[j].q), lv = difference_of_l(c, m->coords.at[j].v);
    assert_near(c, "dL/dq", f.part[0][j], lq, l);
    assert_near(c, "dL/dq'", f.part[1][j], lv, l);
    differences(c, m->coords.at[j].q, step, &dq);
    differences(c, m->coords.at[j].v, step, &dv);
    differences(c, m->coords.at[j].q, step / 2, &finer_q);
    differences(c, m->coords.at[j].v, step / 2, &finer_v);
    for (uint32_t i = 0; i < c->e->n; i++)
      for (int part = 0; part < 3; part++) {
        Real q = entry(c, h, by_q[part], i, j), v = part ? entry(c, h, by_v[part], i, j) : entry(c, h, SECOND_VQ, j, i);
        assert_within(c, "a second derivative by q", q, dq.part[part][i], largest,
                      2 * fabsl(dq.part[part][i] - finer_q.part[part][i]));
        assert_within(c, "a second derivative by q'", v, dv.part[part][i], largest,
                      2 * fabsl(dv.part[part][i] - finer_v.part[part][i]));
      }
  }
  check_forces(c, &f, h);
}

/* A random state with the parameters as declared, and velocities below that of light. */
static Real *state_of(const Eqns *e) {
  Real *v = random_point(e);
  for (uint32_t i = 0; i < e->n; i++) v[e->m->coords.at[i].v] *= 0.2L;
  return v;
}

static void check_scene(Ast *ast, const char *path, const char *scene) {
  Arena *arena = ast->arena;
  Model *m = model_build(ast, &(ModelChoice){.scene = scene});
  Eqns *e = m ? equations_of(m) : NULL;
  assert_non_null(e);
  if (!e->n || !e->smooth) return;
  if (e->n > MOST) return;
  Variation *x = lagrangian_hessian_derive(e);
  Case c = {.e = e, .x = x, .variation = lower_variation(e, x), .second = lower_second_derivatives(e, x)};
  c.where = arena_printf(arena, "%s, scene %s", path, scene);
  assert_null(prog_verify(c.variation));
  assert_null(prog_verify(c.second));
  for (int i = 0; i < slow(4, 2); i++) {
    c.v = state_of(e);
    check_state(&c);
  }
}

static void check_file(const char *path) {
  Arena *arena = arena_new(NULL);
  jmp_buf no_memory;
  if (!arena || setjmp(no_memory)) fail_msg("out of memory");
  arena_guard(arena, &no_memory);
  Sources *sources = sources_new(arena);
  sources->library = "models/lib";
  Ast *ast = ast_new(arena, interner_new(arena), sources, diags_new(arena, sources));
  const char *why = NULL;
  const Source *source = source_read(sources, path, &why);
  if (!source || !parse(ast, source)) fail_msg("%s does not parse", path);
  SceneList scenes = model_scenes(ast);
  for (uint32_t i = 0; i < scenes.n; i++) check_scene(ast, path, scenes.at[i]);
  arena_free(arena);
}

static void test_derivatives(void **state) {
  (void)state;
  glob_t found;
  assert_int_equal(glob("models/*.lag", 0, NULL, &found), 0);
  assert_int_equal(glob("tests/exec/models/*.lag", GLOB_APPEND, NULL, &found), 0);
  for (size_t step = (size_t)depth(12, 4, 2), i = first_row(step); i < found.gl_pathc; i += step)
    if (light(found.gl_pathv[i])) check_file(found.gl_pathv[i]);
  globfree(&found);
}

/* --- what is emitted, and what is not --- */

static const char spring[] =
  "model m\ncoord x, y\nparam k = 3\nlagrangian = x'^2/2 + y'^2/2 - k*(x - y)^2/2\ndissipation = x'^2/2\n";

static const char *emitted(Arena *arena, unsigned wants) {
  Eqns *e = equations(arena, spring, NULL);
  assert_non_null(e);
  ProgramSet *u = unit_new(e, "test.lag", 0);
  unit_require(u, e, wants);
  unit_require(u, e, wants);
  unit_add_scene(u, e);
  StrBuf out = strbuf(arena);
  emit_model(u, "m", MODEL_PLAIN, &out);
  return sb_text(&out);
}

/* The digits after `.digest = "`. */
static const char *digest(const char *c) { return strstr(c, ".digest"); }

static void test_only_when_wanted(void **state) {
  (void)state;
  Arena *arena = arena_new(NULL);
  const char *without = emitted(arena, 0), *with = emitted(arena, WANT_VARIATION);
  assert_null(strstr(without, "second("));
  assert_null(strstr(without, "variation"));
  assert_non_null(
      strstr(with, ".variation = variation, .second = second,\n  .second_at = second_table, .nsecond = 6,"));
  assert_non_null(strstr(with, "static int variation("));
  /* once, though asked for twice */
  assert_null(strstr(strstr(with, "static int variation(") + 1, "static int variation("));
  assert_memory_equal(digest(without), digest(with), 28); /* a saved state goes on with or without them */
  arena_free(arena);
}

/* Of two masses on a spring, by hand: what is zero is not listed. */
static void test_entries(void **state) {
  (void)state;
  static const struct {
    SecondPart part;
    uint32_t row, col;
    Real value;
  } hand[] = {{SECOND_QQ, 0, 0, -3}, {SECOND_QQ, 1, 1, -3}, {SECOND_QQ, 1, 0, 3},
              {SECOND_VV, 0, 0, 1},  {SECOND_VV, 1, 1, 1},  {SECOND_FV, 0, 0, -1}};
  Arena *arena = arena_new(NULL);
  Eqns *e = equations(arena, spring, NULL);
  Variation *x = lagrangian_hessian_derive(e);
  Real h[8];
  assert_int_equal(x->second.n, sizeof hand / sizeof *hand);
  assert_int_equal(run_prog(e, lower_second_derivatives(e, x), random_point(e), h, NULL), 0);
  for (uint32_t k = 0; k < x->second.n; k++) {
    const SecondEntry *s = &x->second.at[k];
    assert_true(s->part == hand[k].part && s->row == hand[k].row && s->col == hand[k].col && h[k] == hand[k].value);
  }
  arena_free(arena);
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_derivatives),
    cmocka_unit_test(test_only_when_wanted),
    cmocka_unit_test(test_entries),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
