/* Saving and loading of a run. Enters: a simulation, or numbers of lag_sim_save; leaves: the numbers, or the run
 * that they describe. Holds: a block is loaded only with its seal, a hash of its numbers and of what they belong to;
 * a refused load changes nothing. */
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "numeric/fnv1a.h"

/* The hash h continued by x: all digits, sign and exponent, of any scalar type; NaN is one number. */
unsigned long long lag_hash_number(unsigned long long h, double x) {
  int e = 0;
  double m = isfinite(x) ? frexp(x, &e) : 0;
  long long high = (long long)ldexp(m, 62), low = (long long)ldexp(m - ldexp((double)high, -62), 124);
  const long long all[] = {high, low, isnan(x) ? 1000000 : isinf(x) ? (x > 0 ? 2000000 : -2000000) : e};

  return lag_fnv1a(h, (const char *)all, sizeof all);
}

unsigned long long lag_hash_numbers(unsigned long long h, long long n, const double *x) {
  for (long long i = 0; i < n; i++) h = lag_hash_number(h, x[i]);
  return h;
}

/* The seal of x[nsaved], whose own seal is not counted: 52 bits of a hash of its numbers, the signature, the
 * method's options and the inputs that are functions of the caller. */
static double seal_of(const lag_sim *s, const double *x) {
  const size_t seal = offsetof(Run, seal) / sizeof(double);
  unsigned long long h = lag_sim_signature(s);

  for (size_t i = 0; i < s->nsaved; i++) h = i == seal ? h : lag_hash_number(h, x[i]);
  if (s->options) h = lag_hash_numbers(h, s->method->noptions, s->options);
  for (int i = 0; i < s->scene->model->nu; i++) h = lag_hash_number(h, s->signal[i].fn != NULL);
  return (double)(h >> 12);
}

size_t lag_sim_save_size(const lag_sim *s) { return s ? s->nsaved : 0; }

void lag_put_down(lag_sim *s, double *x) {
  s->run->rhs_calls = s->pb.rhs_calls;
  s->run->rejected = s->pb.rejected;
  s->run->systems = s->pb.systems;
  s->run->iterations = s->pb.iterations;
  memcpy(x, s->saved, s->nsaved * sizeof *x);
}

int lag_sim_save(lag_sim *s, double *x) {
  if (!s || !x) return LAG_EINVAL;
  if (s->method->flags & LAG_METHOD_NO_SAVE)
    return lag_fail(s, LAG_EINVAL, "the state of method %s cannot be saved; those of liblag can", s->method->name);
  lag_put_down(s, x);
  x[offsetof(Run, seal) / sizeof *x] = s->run->seal = seal_of(s, s->saved);
  return LAG_OK;
}

/* Sets the values outside the saved block that follow from it. */
static void take_over(lag_sim *s) {
  const lag_model *m = s->scene->model;
  s->pb.rhs_calls = s->run->rhs_calls;
  s->pb.rejected = s->run->rejected;
  s->pb.systems = s->run->systems;
  s->pb.iterations = s->run->iterations;
  s->pb.dir = s->run->dir != 0.0 ? s->run->dir : 1;
  if (m->derive) m->derive(m, s->p);
  lag_note_redundant(s);
  lag_switch_count(s);
}

void lag_take_up(lag_sim *s, const double *x) {
  memcpy(s->saved, x, s->nsaved * sizeof *x);
  take_over(s);
}

int lag_sim_load(lag_sim *s, const double *x) {
  if (!s || !x) return LAG_EINVAL;
  if (s->method->flags & LAG_METHOD_NO_SAVE)
    return lag_fail(s, LAG_EINVAL, "the state of method %s cannot be resumed", s->method->name);
  if (s->tangent) return lag_fail(s, LAG_EINVAL, "a saved state holds no tangent: load it first, then begin one");
  if (x[offsetof(Run, seal) / sizeof *x] != seal_of(s, x)) {
    return lag_fail(s, LAG_EINVAL,
                    "the saved state is damaged, or of another run: it is none of scene %s by method %s with these "
                    "options and inputs",
                    s->scene->name, s->method->name);
  }
  lag_take_up(s, x);
  return LAG_OK;
}

unsigned long long lag_sim_signature(const lag_sim *s) {
  if (!s) return 0;
  const lag_model *m = s->scene->model;
  unsigned long long h = lag_hash_text(LAG_FNV1A_START, m->name);
  const struct {
    int n;
    const lag_var *vars;
  } tables[] = {{m->nq, m->q}, {m->nz, m->z}, {m->np, m->p}, {m->nu, m->u}};
  char sizes[128];

  for (size_t k = 0; k < sizeof tables / sizeof *tables; k++) {
    for (int i = 0; i < tables[k].n; i++)
      h = lag_hash_text(lag_hash_text(h, tables[k].vars[i].name), tables[k].vars[i].unit);
    h = lag_hash_text(h, ";");
  }
  for (int i = 0; i < m->nev; i++) h = lag_hash_text(h, m->ev[i].name);
  snprintf(sizes, sizeof sizes, "%zu %zu %d %s", sizeof(double), s->nsaved, s->scene->nmonitors, LAG_VERSION);
  h = lag_hash_text(lag_hash_text(h, m->effects ? m->effects : ""), m->digest ? m->digest : "");
  h = lag_hash_text(lag_hash_text(h, s->scene->name), s->method->name);
  return lag_hash_text(h, sizes);
}
