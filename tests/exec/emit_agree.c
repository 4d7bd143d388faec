/* Emitted C, compiled for long double, against the evaluator of programs, at random states: the
 * same operations in the same order, so the same bits. To rounding where a block is solved by a
 * loop, which may take rows in another order, or where a constant is no ratio of small integers:
 * the compiler reads its decimal in full, the evaluator has a double.
 *
 *   emit_agree MODEL.lag...   in the order of all_scenes, the first scene of each */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/dense_matrix.h"
#include "lower/lower.h"
#include "mech/lagrange.h"
#include "mech/switches.h"
#include "lag_model.h"
#include "symmetry/charges.h"
#include "model/model.h"
#include "sym/expr_eval.h"
#include "syntax/parse.h"

extern const lag_scene *const all_scenes[];

enum { PARAMS = 8192 }; /* with derived ones */
#ifndef MAX
#define MAX 64
#endif
#ifndef LOOSE
#define LOOSE 0 /* what differs may differ by, where arithmetic is not that of the processor */
#endif
enum { STATES = 20, GRAPH_STATES = 5, WORK = 1 << 14 };

typedef long double Real;
static Real loose = LOOSE;
typedef struct {
  Real t, q[MAX], v[MAX], z[MAX], p[PARAMS], u[MAX], w[WORK];
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

/* Of constraints with `while`, which contradict each other, the first alone holds; so do contacts beyond the number
 * of coordinates that other constraints leave free, which are open. */
static void close_first(const Model *m, Point *s) {
  Name first = model_conditional(m);
  uint32_t always = m->constraints.n - m->contacts.n;
  for (uint32_t i = 0; i < m->contacts.n; i++) {
    const Contact *c = &m->contacts.at[i];
    if (c->margin || always + i >= m->coords.n)
      s->u[expr_symbol(m->g, c->closed)->index] = c->margin && c->name == first;
  }
}

/* Neither a number, or the same: a random state may be outside of a logarithm's domain. */
static int agree(Real a, Real b, Real tolerance) {
  return (isnan(a) && isnan(b)) || fabsl(a - b) <= tolerance;
}

static int differs(const char *name, const char *what, const Real *a, const Real *b, int n, int exact) {
  for (int i = 0; i < n; i++) {
    Real tolerance = fmaxl(loose, exact ? 0 : 1e-15L) * (1 + fabsl(b[i]));
    if (agree(a[i], b[i], isnan(tolerance) ? 0 : tolerance)) continue;
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
  int got = m->accel(m, s->t, s->q, s->v, s->z, s->p, s->u, a, a + m->nq, s->w), want = prog_eval(accel, in, out);
  if (got != want) return printf("%s: status %d in emitted C, %d evaluated\n", m->name, got, want), 1;
  if (got == 0 && differs(m->name, "accel", a, b, m->nq + m->nz, is_exact(accel))) return 1;
  if (!m->energy) return 0;
  m->energy(m, s->t, s->q, s->v, s->z, s->p, s->u, e, s->w);
  prog_eval(energy, in, out_energy);
  return differs(m->name, "energy", e, f, 2, is_exact(energy));
}

/* The values of all symbols at the state; q'' and z' as they are in the array. */
static Real *symbol_values(const Eqns *e, const Point *s) {
  Real *v = ARENA_ARRAY(e->m->arena, Real, expr_symbol_count(e->g) + 1);
  for (SymId k = 1; k <= expr_symbol_count(e->g); k++) {
    const Symbol *sym = expr_symbol(e->g, k);
    switch (sym->kind) {
      case SYM_TIME: v[k] = s->t; break;
      case SYM_COORD: v[k] = s->q[sym->index]; break;
      case SYM_VEL: v[k] = s->v[sym->index]; break;
      case SYM_STATE: v[k] = s->z[sym->index]; break;
      case SYM_PARAM: v[k] = s->p[sym->index]; break;
      case SYM_INPUT: v[k] = s->u[sym->index]; break;
      case SYM_CONST: v[k] = 3.14159265358979323846264338327950288L; break;
      case SYM_ACC: case SYM_RATE: case SYM_MULTIPLIER: case SYM_LOCAL: break;
    }
  }
  return v;
}

/* left[n] without what multipliers make up for: its part in the kernel of A. */
static void take_away_multipliers(const Eqns *e, const Real *symbols, Real *left) {
  Arena *arena = e->m->arena;
  const Entries *A = &e->constraints.A;
  uint32_t n = e->n, w = n + e->constraints.n;
  Expr *roots = ARENA_ARRAY(arena, Expr, A->n + 1);
  Real *K = ARENA_ARRAY(arena, Real, w * w), *x = ARENA_ARRAY(arena, Real, w),
       *value = ARENA_ARRAY(arena, Real, A->n + 1);
  for (uint32_t k = 0; k < A->n; k++) roots[k] = A->at[k].e;
  expr_eval(e->g, roots, A->n, symbols, value);
  for (uint32_t i = 0; i < n; i++) K[i * w + i] = 1, x[i] = left[i];
  for (uint32_t k = 0; k < A->n; k++)
    K[(n + A->at[k].row) * w + A->at[k].col] = K[A->at[k].col * w + n + A->at[k].row] = value[k];
  dense_solve(arena, w, K, x, 1e-15L, NULL);
  for (uint32_t i = 0; i < n; i++) left[i] = x[i];
}

/* Programs against the graph that they come from, evaluated node by node: M q'' = f, the rates, the energy. Rounding is
 * 1e-19 (5e-20 of 64 bits), and sums and eliminations of some hundred terms make more of it. */
static int compare_graph(Eqns *e, const Prog *accel, const Prog *energy, const Point *s) {
  Arena *arena = e->m->arena;
  uint32_t n = e->n, nz = e->m->states.n, total = n + nz + 2 + e->mass.n, k = 0;
  Real a[2 * MAX], f[2], *left = ARENA_ARRAY(arena, Real, n + 1), *size = ARENA_ARRAY(arena, Real, n + 1),
                         tolerance = fmaxl(loose, 1e-15L);
  const Real *in[ARR_COUNT] = {&s->t, s->q, s->v, s->z, s->p, s->u};
  Real *out[] = {a, a + n}, *out_energy[] = {f}, *value = ARENA_ARRAY(arena, Real, total);
  Expr *roots = ARENA_ARRAY(arena, Expr, total);
  for (uint32_t i = 0; i < n; i++) roots[k++] = e->constraints.n ? e->system.f[i] : e->f[i];
  for (uint32_t i = 0; i < nz; i++) roots[k++] = e->flow[i];
  for (uint32_t i = 0; i < e->mass.n; i++) roots[k++] = e->mass.at[i].e;
  if (e->energy) roots[k++] = e->energy_stable, roots[k++] = e->energy_scale;
  expr_eval(e->g, roots, k, symbol_values(e, s), value);
  for (uint32_t i = 0; i < n + nz; i++)
    if (isnan(value[i])) return 0; /* outside of the domain of a root */
  if (prog_eval(accel, in, out) != 0) return 0;
  for (uint32_t i = 0; i < n; i++) left[i] = -value[i], size[i] = 1 + fabsl(value[i]);
  for (uint32_t i = 0; i < e->mass.n; i++) {
    uint32_t r = e->mass.at[i].row, c = e->mass.at[i].col;
    Real M = value[n + nz + i];
    left[r] += M * a[c], size[r] += fabsl(M * a[c]);
    if (r != c) left[c] += M * a[r], size[c] += fabsl(M * a[r]);
  }
  if (e->constraints.n) take_away_multipliers(e, symbol_values(e, s), left);
  for (uint32_t i = 0; i < n; i++)
    if (!(fabsl(left[i]) <= tolerance * size[i]))
      return printf("%s: row %u of M q'' = f is left with %Lg of %Lg\n", e->m->name, i, left[i], size[i]), 1;
  for (uint32_t i = 0; i < nz; i++)
    if (!(fabsl(a[n + i] - value[n + i]) <= tolerance * (1 + fabsl(value[n + i]))))
      return printf("%s: rate %u\n", e->m->name, i), 1;
  if (!e->energy) return 0;
  prog_eval(energy, in, out_energy);
  Real scale = 1 + (isnan(value[k - 1]) ? fabsl(value[k - 2]) : fabsl(value[k - 1]));
  /* of coordinates of first order, which the graph has no values of */
  int rates = (expr_kinds(e->g, e->energy_scale) & 1u << SYM_RATE) != 0;
  if (agree(f[0], value[k - 2], tolerance * scale) && (rates || agree(f[1], value[k - 1], tolerance * scale))) return 0;
  return printf("%s: the energy is %.21Lg, of the graph %.21Lg\n", e->m->name, f[0], value[k - 2]), 1;
}

/* dL/dq, dL/dq', Q and their derivatives. */
static int compare_variation(const lag_model *m, const Eqns *e, Point *s) {
  Variation *x = lagrangian_hessian_derive(e);
  Prog *first = lower_variation(e, x), *second = lower_second_derivatives(e, x);
  uint32_t n = x->second.n;
  Real a[3 * MAX], b[3 * MAX], *h = ARENA_ARRAY(e->m->arena, Real, n + 1), *k = ARENA_ARRAY(e->m->arena, Real, n + 1);
  const Real *in[ARR_COUNT] = {&s->t, s->q, s->v, s->z, s->p, s->u};
  Real *out[] = {b, b + MAX, b + 2 * MAX}, *out_second[] = {k};
  m->variation(m, s->t, s->q, s->v, s->z, s->p, s->u, a, a + MAX, a + 2 * MAX, s->w);
  prog_eval(first, in, out);
  for (int part = 0; part < 3; part++)
    if (differs(m->name, "variation", a + part * MAX, b + part * MAX, m->nq, is_exact(first))) return 1;
  m->second(m, s->t, s->q, s->v, s->z, s->p, s->u, h, s->w);
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
  sources->library = "models/lib";
  Diags *diags = diags_new(arena, sources);
  Ast *ast = ast_new(arena, interner_new(arena), sources, diags);
  const char *error = NULL;
  const Source *source = source_read(sources, path, &error);
  if (!source || !parse(ast, source)) return printf("%s does not parse\n", path), 1;
  Model *m = model_build(ast, &(ModelChoice){0});
  Eqns *e = m ? equations_of(m) : NULL;
  if (!e || strcmp(m->name, scene->model->name) != 0) return printf("%s is not %s\n", path, scene->model->name), 1;
  switches_find(e);
  if (scene->model->np + scene->model->nderived > PARAMS) return printf("%s has too many parameters\n", m->name), 1;
  if (scene->model->nw > WORK) return printf("%s has too much work space\n", m->name), 1;
  Prog *accel = lower_accel(e, 0), *energy = lower_energy(e);
  /* its feet have a millionth of the mass: rows of the solution lose that much */
  loose = strcmp(m->name, "compass_walker") == 0 ? fmaxl(LOOSE, 1e-9L) : LOOSE;
  Point s;
  seed = 7; /* the states of a model do not depend on which models come before it */
  scene->params(scene, s.p, none);
  eqns_derive_mass(e); /* where the program does without */
  for (int i = 0; i < STATES; i++) {
    random_state(&s);
    close_first(m, &s);
    if (compare(scene->model, accel, energy, &s)) return 1;
    /* which has no held branches */
    if (i < GRAPH_STATES && !e->switches.nmodes && compare_graph(e, accel, energy, &s)) return 1;
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
