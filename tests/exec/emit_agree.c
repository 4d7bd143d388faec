/* Emitted C, compiled for long double, against the evaluator of programs, at random states: the
 * same operations in the same order, so the same bits. To rounding where a block is solved by a
 * loop, which may take rows in another order, or where a constant is no ratio of small integers:
 * the compiler reads its decimal in full, the evaluator has a double.
 *
 *   emit_agree MODEL.lag...   in the order of all_scenes, the first scene of each */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ir/lower.h"
#include "lag_model.h"
#include "mech/eqns.h"
#include "model/model.h"
#include "syntax/parse.h"

extern const lag_scene *const all_scenes[];

#ifndef MAX
#define MAX 64
#endif
enum { STATES = 20 };

typedef long double Real;
typedef struct {
  Real t, q[MAX], v[MAX], z[MAX], p[MAX], u[MAX], w[1024];
} Point;

static uint64_t seed = 7;
static Real next(void) {
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return 1.5L * ((Real)(seed >> 11) / 9007199254740992.0L - 0.5L);
}

static void random_state(Point *s) {
  s->t = next();
  for (int i = 0; i < MAX; i++) s->q[i] = next(), s->v[i] = next(), s->z[i] = next(), s->u[i] = next();
}

static int differs(const char *name, const char *what, const Real *a, const Real *b, int n, int exact) {
  for (int i = 0; i < n; i++) {
    Real tolerance = exact ? 0 : 1e-15L * (1 + fabsl(b[i]));
    if (fabsl(a[i] - b[i]) <= tolerance) continue;
    printf("%s: %s[%d] is %.21Lg in emitted C, %.21Lg evaluated\n", name, what, i, a[i], b[i]);
    return 1;
  }
  return 0;
}

static int is_exact(const Prog *p) {
  for (Slot s = 1; s < p->ins.n; s++)
    if (p->ins.at[s].op == IR_CONST && !num_is_exact(p->ins.at[s].number)) return 0;
  return p->solves.n == 0;
}

static int compare(const lag_model *m, const Prog *accel, const Prog *energy, Point *s) {
  Real a[2 * MAX], b[2 * MAX], e[2], f[2];
  const Real *in[ARR_COUNT] = {&s->t, s->q, s->v, s->z, s->p, s->u};
  Real *out[] = {b, b + m->nq}, *out_energy[] = {f};
  int got = m->accel(s->t, s->q, s->v, s->z, s->p, s->u, a, a + m->nq, s->w), want = prog_eval(accel, in, out);
  if (got != want) return printf("%s: status %d in emitted C, %d evaluated\n", m->name, got, want), 1;
  if (got == 0 && differs(m->name, "accel", a, b, m->nq + m->nz, is_exact(accel))) return 1;
  if (!m->energy) return 0;
  m->energy(s->t, s->q, s->v, s->z, s->p, s->u, e, s->w);
  prog_eval(energy, in, out_energy);
  return differs(m->name, "energy", e, f, 2, is_exact(energy));
}

/* dL/dq, dL/dq', Q and their derivatives. */
static int compare_variation(const lag_model *m, const Eqns *e, Point *s) {
  Variation *x = variation_derive(e);
  Prog *first = lower_variation(e, x), *second = lower_second(e, x);
  uint32_t n = x->second.n;
  Real a[3 * MAX], b[3 * MAX], *h = ARENA_ARRAY(e->m->arena, Real, n + 1), *k = ARENA_ARRAY(e->m->arena, Real, n + 1);
  const Real *in[ARR_COUNT] = {&s->t, s->q, s->v, s->z, s->p, s->u};
  Real *out[] = {b, b + MAX, b + 2 * MAX}, *out_second[] = {k};
  m->variation(s->t, s->q, s->v, s->z, s->p, s->u, a, a + MAX, a + 2 * MAX, s->w);
  prog_eval(first, in, out);
  for (int part = 0; part < 3; part++)
    if (differs(m->name, "variation", a + part * MAX, b + part * MAX, m->nq, is_exact(first))) return 1;
  m->second(s->t, s->q, s->v, s->z, s->p, s->u, h, s->w);
  prog_eval(second, in, out_second);
  for (uint32_t i = 0; i < n; i++)
    if (m->second_at[i].part != (int)x->second.at[i].part || m->second_at[i].row != (int)x->second.at[i].row ||
        m->second_at[i].col != (int)x->second.at[i].col)
      return printf("%s: entry %u is another one\n", m->name, i), 1;
  return m->nsecond != (int)n || differs(m->name, "second", h, k, (int)n, is_exact(second));
}

static int check_model(Arena *arena, const char *path, const lag_scene *scene) {
  static const unsigned char none[MAX];
  Sources *sources = sources_new(arena);
  Diags *diags = diags_new(arena, sources);
  Ast *ast = ast_new(arena, interner_new(arena), sources, diags);
  const char *error = NULL;
  const Source *source = source_read(sources, path, &error);
  if (!source || !parse(ast, source)) return printf("%s does not parse\n", path), 1;
  Model *m = model_build(ast, &(ModelChoice){0});
  Eqns *e = m ? eqns_derive(m) : NULL;
  if (!e || strcmp(m->name, scene->model->name) != 0) return printf("%s is not %s\n", path, scene->model->name), 1;
  Prog *accel = lower_accel(e), *energy = lower_energy(e);
  Point s;
  scene->params(s.p, none);
  for (int i = 0; i < STATES; i++) {
    random_state(&s);
    if (compare(scene->model, accel, energy, &s)) return 1;
    if (scene->model->variation && i < 3 && compare_variation(scene->model, e, &s)) return 1;
  }
  return 0;
}

int main(int argc, char **argv) {
  int bad = 0;
  for (int i = 1; i < argc; i++) {
    Arena *arena = arena_new(NULL);
    jmp_buf failed;
    if (!arena || setjmp(failed)) return 2;
    arena_guard(arena, &failed);
    bad |= check_model(arena, argv[i], all_scenes[i - 1]);
    arena_free(arena);
  }
  return bad;
}
