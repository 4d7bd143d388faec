/* A model from text, for tests only: up to its equations, and its accelerations at a state. */
#ifndef TEST_COMPILE_TEXT_H
#define TEST_COMPILE_TEXT_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lower/lower.h"
#include "symmetry/charges.h"
#include "sym/expr_eval.h"
#include "syntax/parse.h"

#define TEST_PI 3.14159265358979323846264338327950288L

/* The same numbers in every run (Knuth's MMIX generator), in (lo, hi). */
static uint64_t test_rng = 1;
static inline long double uniform(long double lo, long double hi) {
  test_rng = test_rng * 6364136223846793005u + 1442695040888963407u;
  return lo + (hi - lo) * (long double)(test_rng >> 11) / 9007199254740992.0L;
}

/* An arena that ends the test where memory runs out. */
static inline Arena *test_arena(void) {
  static jmp_buf failed;
  Arena *a = arena_new(NULL);
  assert_non_null(a);
  if (setjmp(failed)) fail_msg("out of memory");
  arena_guard(a, &failed);
  return a;
}

/* NULL when there were errors; the messages are then on stderr. */
static inline Eqns *equations(Arena *a, const char *lag, const char *scene) {
  Sources *sources = sources_new(a);
  Ast *ast = ast_new(a, interner_new(a), sources, diags_new(a, sources));
  parse(ast, source_add(sources, "test.lag", lag, strlen(lag)));
  ModelChoice choice = {.scene = scene};
  Model *m = ast->diags->errors ? NULL : model_build(ast, &choice);
  Eqns *e = m ? equations_of(m) : NULL;
  if (e) return e;
  StrBuf out = strbuf(a);
  diags_print(ast->diags, &out);
  fputs(sb_text(&out), stderr);
  return NULL;
}

/* A value for each symbol: coordinates, velocities, states and t at random, parameters as declared. */
static inline long double *random_point(const Eqns *e) {
  long double *v = ARENA_ARRAY(e->m->arena, long double, expr_symbol_count(e->g) + 1);
  for (SymId s = 1; s <= expr_symbol_count(e->g); s++) v[s] = uniform(-1, 1);
  v[e->m->pi] = TEST_PI;
  for (uint32_t i = 0; i < e->m->params.n; i++) {
    const Param *p = &e->m->params.at[i];
    expr_eval(e->g, &p->value, 1, v, &v[p->sym]);
  }
  for (uint32_t i = 0; i < e->m->inputs.n; i++) {
    const Input *u = &e->m->inputs.at[i];
    expr_eval(e->g, &u->value, 1, v, &v[u->sym]);
  }
  return v;
}

static inline SymId symbol_named(const Eqns *e, const char *name) {
  for (SymId s = 1; s <= expr_symbol_count(e->g); s++)
    if (strcmp(expr_symbol(e->g, s)->name, name) == 0) return s;
  abort();
}

static inline long double at(const Eqns *e, const long double *v, const char *name) { return v[symbol_named(e, name)]; }

/* Runs a program at that point. */
static inline int run_prog_into(const Eqns *e, const Prog *p, const long double *v, long double *const *out) {
  const Model *m = e->m;
  long double *in[ARR_COUNT];
  uint32_t sizes[ARR_COUNT] = {1, m->coords.n, m->coords.n, m->states.n, m->params.n, m->inputs.n, m->coords.n};
  for (int i = 0; i < ARR_COUNT; i++) in[i] = ARENA_ARRAY(m->arena, long double, sizes[i] + 1);
  in[ARR_T][0] = v[m->time];
  for (uint32_t i = 0; i < m->coords.n; i++) {
    in[ARR_Q][i] = v[m->coords.at[i].q];
    in[ARR_V][i] = v[m->coords.at[i].v];
    in[ARR_A][i] = v[m->coords.at[i].a];
  }
  for (uint32_t i = 0; i < m->states.n; i++) in[ARR_Z][i] = v[m->states.at[i].z];
  for (uint32_t i = 0; i < m->params.n; i++) in[ARR_P][i] = v[m->params.at[i].sym];
  for (uint32_t i = 0; i < m->inputs.n; i++) in[ARR_U][i] = v[m->inputs.at[i].sym];
  return prog_eval(p, (const long double *const *)in, out);
}

static inline int run_prog(const Eqns *e, const Prog *p, const long double *v, long double *out0, long double *out1) {
  long double *out[3] = {out0, out1, NULL};
  return run_prog_into(e, p, v, out);
}

#endif
