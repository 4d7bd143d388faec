/* Saving and loading of a run. Enters: a simulation, or numbers from anywhere; leaves: the numbers, or the run that they describe. Holds:
 * numbers are loaded only when each is in its range, so that any bytes are safe; a refused load changes nothing. The ranges stand in three
 * tables: arrays of the saved block (lag_saved_arrays), Run and Charge here; a method checks its own block (lag_method.sound). */
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "numeric/fnv1a.h"

enum { RUN_DOUBLES = sizeof(Run) / sizeof(double), CHARGE_DOUBLES = sizeof(Charge) / sizeof(double) };

typedef struct Field {
  size_t at; /* offset in bytes */
  int kind;
} Field;

#define OF(type, name, kind) {offsetof(type, name), kind}
static const Field run_fields[] = {
    OF(Run, begun, LAG_SAVED_FLAG), OF(Run, dir, LAG_SAVED_SIGN), OF(Run, t, LAG_SAVED_FINITE), OF(Run, have_step, LAG_SAVED_FLAG),
    OF(Run, step_t0, LAG_SAVED_FINITE), OF(Run, step_t1, LAG_SAVED_FINITE), OF(Run, from, LAG_SAVED_FINITE),
    OF(Run, limit, LAG_SAVED_FINITE), OF(Run, pending, LAG_SAVED_FLAG), OF(Run, steps, LAG_SAVED_COUNT),
    OF(Run, rejected, LAG_SAVED_COUNT), OF(Run, rhs_calls, LAG_SAVED_COUNT), OF(Run, systems, LAG_SAVED_COUNT),
    OF(Run, iterations, LAG_SAVED_COUNT), OF(Run, events, LAG_SAVED_COUNT), OF(Run, watched, LAG_SAVED_FINITE),
    OF(Run, balanced, LAG_SAVED_FLAG), OF(Run, c_peak, LAG_SAVED_NUMBER), OF(Run, r_peak, LAG_SAVED_NUMBER),
    OF(Run, rank, LAG_SAVED_COUNT), OF(Run, beside, LAG_SAVED_COUNT), OF(Run, apart, LAG_SAVED_NUMBER),
    OF(Run, steps_since_rank, LAG_SAVED_COUNT), OF(Run, steps_until_rank, LAG_SAVED_COUNT), OF(Run, looks, LAG_SAVED_COUNT), OF(Run, coarse, LAG_SAVED_COUNT),
    OF(Run, period, LAG_SAVED_NUMBER), OF(Run, stall_since, LAG_SAVED_FINITE), OF(Run, energy_jump, LAG_SAVED_FINITE),
    OF(Run, energy_jump_t, LAG_SAVED_FINITE), OF(Run, mass_condition, LAG_SAVED_NUMBER), OF(Run, mass_condition_of, LAG_SAVED_COUNT), OF(Run, chatter, LAG_SAVED_COUNT),
    OF(Run, chatter_since, LAG_SAVED_FINITE), OF(Run, row_origin, LAG_SAVED_FINITE), OF(Run, row_every, LAG_SAVED_FINITE),
    OF(Run, row_next, LAG_SAVED_COUNT)};
static const Field charge_fields[] = {OF(Charge, balanced, LAG_SAVED_FLAG), OF(Charge, bins, LAG_SAVED_COUNT), OF(Charge, width, LAG_SAVED_COUNT),
                                      OF(Charge, in_bin, LAG_SAVED_COUNT)}; /* the others may be any numbers */
_Static_assert(sizeof run_fields / sizeof *run_fields == RUN_DOUBLES, "each field of Run has a kind");

int lag_is_count(double x, double most)
{
  return x >= 0 && x <= most && x == floor(x);
}

int lag_is_flag(double x)
{
  return x == 0.0 || x == 1.0;
}

int lag_is_sign(double x)
{
  return x == 0.0 || fabs(x) == 1.0;
}

int lag_same_numbers(const double *a, const double *b, size_t n)
{
  size_t i = 0;

  while (i < n && a[i] == b[i]) {
    i++;
  }
  return i == n;
}

static int is_of_kind(double x, int kind)
{
  switch (kind) {
  case LAG_SAVED_FINITE: return isfinite(x);
  case LAG_SAVED_HELD: return isfinite(x) || isnan(x);
  case LAG_SAVED_FLAG: return lag_is_flag(x);
  case LAG_SAVED_SIGN: return lag_is_sign(x);
  case LAG_SAVED_COUNT: return lag_is_count(x, 0x1p53);
  default: return 1;
  }
}

static int fields_are_sound(const void *at, const Field *field, size_t n)
{
  size_t i = 0;

  while (i < n && is_of_kind(*(const double *)(const void *)((const char *)at + field[i].at), field[i].kind)) {
    i++;
  }
  return i == n;
}

static int parts_are_sound(lag_sim *s)
{
  lag_saved_array part[LAG_SAVED_ARRAYS];

  lag_saved_arrays(s, part);
  for (int i = 0; i < LAG_SAVED_ARRAYS; i++) {
    for (size_t k = 0; k < part[i].n; k++) {
      if (!is_of_kind((*part[i].at)[k], part[i].kind)) {
        return 0;
      }
    }
  }
  return 1;
}

/* Bins: full ones below LAG_BINS; width a power of two, more than the samples in the open bin. */
static int charge_is_sound(const Charge *c)
{
  int e;

  return fields_are_sound(c, charge_fields, sizeof charge_fields / sizeof *charge_fields) && c->bins < LAG_BINS &&
         (c->width == 0.0 ? c->in_bin == 0.0 && c->bins == 0.0 : frexp(c->width, &e) == 0.5 && c->in_bin < c->width);
}

/* Whether times of the step are in order: step_t0, from, t, limit, step_t1. */
static int step_is_sound(const Run *r)
{
  const double at[] = {r->step_t0, r->from, r->limit, r->step_t1};
  double dir = r->dir;

  for (int i = 0; i + 1 < 4; i++) {
    if (!((at[i + 1] - at[i]) * dir >= 0)) {
      return 0;
    }
  }
  return (r->step_t1 - r->step_t0) * dir > 0 && (r->t - r->from) * dir >= 0 && (r->limit - r->t) * dir >= 0;
}

static int run_is_sound(const lag_sim *s)
{
  const Run *r = s->run;
  const lag_model *m = s->scene->model;
  double constraints = m->constraints ? m->constraints->n : 0;

  return fields_are_sound(r, run_fields, RUN_DOUBLES) && r->rank <= constraints && r->beside <= constraints && r->row_every >= 0 && (r->mass_condition_of < m->nq || (r->energy_jump == 0.0 && r->mass_condition_of == 0.0)) &&
         (r->pending == 0.0 || (m->nev > 0 && r->have_step != 0.0)) && (r->balanced == 0.0 || lag_can_balance(s)) &&
         (r->have_step == 0.0 || (r->begun != 0.0 && step_is_sound(r))) && (r->begun == 0.0 || (r->dir != 0.0 && s->options != NULL));
}

/* Whether the method accepts its block; before the first step the block is cleared. LAG_OK, LAG_EINVAL, LAG_ENOMEM. */
static int check_method_block(lag_sim *s)
{
  const lag_method *m = s->method;
  lag_problem pb = s->pb;

  if (s->run->begun == 0.0) {
    memset(s->method_work, 0, s->nwork * sizeof(double));
    return LAG_OK;
  }
  if (!m->sound) {
    return LAG_OK;
  }
  void *room = calloc(s->nwork * sizeof(double) + LAG_WORK_ALIGN, 1);
  if (!room) {
    return LAG_ENOMEM;
  }
  void *fresh = (char *)room + (LAG_WORK_ALIGN - (uintptr_t)room % LAG_WORK_ALIGN) % LAG_WORK_ALIGN;
  pb.dir = s->run->dir;
  int rc = m->init(fresh, &pb, s->options) == 0 && m->sound(s->method_work, fresh, &pb) ? LAG_OK : LAG_EINVAL;
  free(room);
  return rc;
}

/* Whether `saved` is a state of this simulation. */
static int check_saved(lag_sim *s)
{
  int charges = lag_sim_ncharges(s), k = 0;

  while (k < charges && charge_is_sound(&s->charges[k]) && (s->run->begun == 0.0 || s->charges[k].width > 0)) {
    k++;
  }
  return k == charges && run_is_sound(s) && parts_are_sound(s) && lag_signs_hold(s) ? check_method_block(s) : LAG_EINVAL;
}

size_t lag_sim_save_size(const lag_sim *s)
{
  return s ? s->nsaved : 0;
}

int lag_sim_save(lag_sim *s, double *x)
{
  if (!s || !x) {
    return LAG_EINVAL;
  }
  if (s->method->flags & LAG_METHOD_NO_SAVE) {
    return lag_fail(s, LAG_EINVAL, "the state of method %s cannot be saved; those of liblag can", s->method->name);
  }
  s->run->rhs_calls = s->pb.rhs_calls;
  s->run->rejected = s->pb.rejected;
  s->run->systems = s->pb.systems;
  s->run->iterations = s->pb.iterations;
  memcpy(x, s->saved, s->nsaved * sizeof *x);
  return LAG_OK;
}

/* Sets the values outside the saved block that follow from it. */
static void take_over(lag_sim *s)
{
  const lag_model *m = s->scene->model;

  s->pb.rhs_calls = s->run->rhs_calls;
  s->pb.rejected = s->run->rejected;
  s->pb.systems = s->run->systems;
  s->pb.iterations = s->run->iterations;
  s->pb.dir = s->run->dir != 0.0 ? s->run->dir : 1;
  if (m->derive) {
    m->derive(s->p);
  }
  lag_note_redundant(s);
  lag_reset_rate_history(s);
}

int lag_sim_load(lag_sim *s, const double *x)
{
  if (!s || !x) {
    return LAG_EINVAL;
  }
  const size_t bytes = s->nsaved * sizeof *x;

  if (s->method->flags & LAG_METHOD_NO_SAVE) {
    return lag_fail(s, LAG_EINVAL, "the state of method %s cannot be resumed", s->method->name);
  }
  if (s->tangent) {
    return lag_fail(s, LAG_EINVAL, "a saved state holds no tangent: load it first, then begin one");
  }
  double *before = malloc(bytes);
  if (!before) {
    return lag_fail(s, LAG_ENOMEM, "out of memory");
  }
  memcpy(before, s->saved, bytes);
  memcpy(s->saved, x, bytes);
  int rc = check_saved(s);
  if (rc == 0) {
    take_over(s);
  } else {
    memcpy(s->saved, before, bytes);
    lag_fail(s, rc, rc == LAG_ENOMEM ? "out of memory" : "the saved state is damaged, or of another run: its numbers cannot be those of a state "
             "of scene %s by method %s", s->scene->name, s->method->name);
  }
  free(before);
  return rc;
}

/* FNV-1a hash of text with its final 0, so that "ab","c" and "a","bc" differ. */
static unsigned long long hash(unsigned long long h, const char *text)
{
  return lag_fnv1a(h, text, strlen(text) + 1);
}

unsigned long long lag_sim_signature(const lag_sim *s)
{
  if (!s) {
    return 0;
  }
  const lag_model *m = s->scene->model;
  unsigned long long h = hash(LAG_FNV1A_START, m->name);
  const struct {
    int n;
    const lag_var *vars;
  } tables[] = {{m->nq, m->q}, {m->nz, m->z}, {m->np, m->p}, {m->nu, m->u}};
  char sizes[128];

  for (size_t k = 0; k < sizeof tables / sizeof *tables; k++) {
    for (int i = 0; i < tables[k].n; i++) {
      h = hash(hash(h, tables[k].vars[i].name), tables[k].vars[i].unit);
    }
    h = hash(h, ";");
  }
  for (int i = 0; i < m->nev; i++) {
    h = hash(h, m->ev[i].name);
  }
  snprintf(sizes, sizeof sizes, "%zu %zu %d %s", sizeof(double), s->nsaved, s->scene->nmonitors, LAG_VERSION);
  h = hash(hash(h, m->effects ? m->effects : ""), m->digest ? m->digest : "");
  h = hash(hash(h, s->scene->name), s->method->name);
  return hash(h, sizes);
}
