/* What a caller may see of a simulation, and its saving. Enters: a simulation; leaves: its values. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/core.h"

double lag_sim_time(const lag_sim *s)
{
  return s->run->t;
}

const double *lag_sim_q(const lag_sim *s)
{
  return s->now;
}

const double *lag_sim_v(const lag_sim *s)
{
  return s->now + s->pb.nq;
}

const double *lag_sim_z(const lag_sim *s)
{
  return s->now + 2 * s->pb.nq;
}

const double *lag_sim_p(const lag_sim *s)
{
  return s->p;
}

const lag_scene *lag_sim_scene(const lag_sim *s)
{
  return s->scene;
}

const lag_method *lag_sim_method(const lag_sim *s)
{
  return s->method;
}

double lag_sim_tolerance(const lag_sim *s)
{
  return s->tol;
}

const double *lag_sim_options(const lag_sim *s)
{
  return s->options;
}

const char *lag_sim_message(const lag_sim *s)
{
  return s->message;
}

long long lag_sim_event_count(const lag_sim *s, int k)
{
  return (long long)s->count[k];
}

double *lag_sim_rows(lag_sim *s)
{
  return &s->run->row_origin;
}

void lag_sim_on_step(lag_sim *s, int (*hook)(void *, const lag_sim *), void *context)
{
  s->on_step = hook;
  s->on_step_context = context;
}

long long lag_sim_event_times(const lag_sim *s, int k, double *first, double *last)
{
  *first = s->count[k] > 0 ? s->first[k] : NAN;
  *last = s->count[k] > 0 ? s->last[k] : NAN;
  return (long long)s->count[k];
}

void lag_sim_on_event(lag_sim *s, lag_event_fn *hook, void *context)
{
  s->on_event = hook;
  s->on_event_context = context;
}

int lag_sim_noutputs(const lag_sim *s)
{
  return s->scene->nout > 0 ? s->scene->nout : s->pb.n;
}

/* Copies a variable's name and unit, with what a time derivative adds to them. A quantity without a
 * unit has a rate without one: a model in which nothing has units stays so. */
static double put_info(const lag_var *v, int velocity, char *name, size_t nname, char *unit, size_t nunit)
{
  if (name) {
    snprintf(name, nname, "%s%s", v->name, velocity ? "'" : "");
  }
  if (unit) {
    snprintf(unit, nunit, "%s%s", v->unit, velocity && v->unit[0] ? "/s" : "");
  }
  return v->factor;
}

double lag_sim_state_info(const lag_sim *s, int i, char *name, size_t nname, char *unit, size_t nunit)
{
  const lag_model *m = s->scene->model;
  const lag_var *v = i < 2 * m->nq ? &m->q[i % m->nq] : &m->z[i - 2 * m->nq];

  return put_info(v, i >= m->nq && i < 2 * m->nq, name, nname, unit, nunit);
}

double lag_sim_declared(const lag_sim *s, int i, double value)
{
  const lag_model *m = s->scene->model;
  int rate = i >= m->nq && i < 2 * m->nq;
  const lag_var *v = i < 2 * m->nq ? &m->q[i % m->nq] : &m->z[i - 2 * m->nq];

  return rate ? value / v->factor : lag_declared(v, value);
}

double lag_sim_state_value(const lag_sim *s, int i)
{
  return lag_sim_declared(s, i, s->now[i]);
}

double lag_sim_asked(const lag_sim *s, int i)
{
  return lag_sim_declared(s, i, s->asked[i]);
}

double lag_sim_begin(const lag_sim *s, int i)
{
  return lag_sim_declared(s, i, s->begin[i]);
}

int lag_sim_rank(const lag_sim *s)
{
  return (int)s->run->rank;
}

int lag_sim_is_redundant(const lag_sim *s, int k)
{
  return s->redundant[k] != 0.0;
}

int lag_sim_rank_beside(const lag_sim *s)
{
  return (int)s->run->beside;
}

int lag_sim_is_loose(const lag_sim *s, int i)
{
  return s->loose[i] != 0.0;
}

double lag_sim_output_info(const lag_sim *s, int i, char *name, size_t nname, char *unit, size_t nunit)
{
  if (s->scene->nout == 0) {
    return lag_sim_state_info(s, i, name, nname, unit, nunit);
  }
  return put_info(&s->scene->outputs[i], 0, name, nname, unit, nunit);
}

static int outputs(lag_sim *s, double t, const double *y, double *out)
{
  const lag_scene *c = s->scene;
  int rc = 0, nout = lag_sim_noutputs(s);

  if (c->nout > 0) {
    if ((rc = lag_observe(s, t, y, out)) != 0) {
      return lag_fail(s, rc < 0 ? rc : LAG_EDOMAIN, "the outputs cannot be computed at t = %.17g s", t);
    }
  } else {
    for (int i = 0; i < nout; i++) {
      out[i] = lag_sim_declared(s, i, y[i]);
    }
  }
  for (int i = 0; i < c->nout; i++) {
    out[i] = lag_declared(&c->outputs[i], out[i]);
  }
  return LAG_OK;
}

int lag_sim_outputs(lag_sim *s, double *out)
{
  return outputs(s, s->run->t, s->now, out);
}

int lag_sim_outputs_at(lag_sim *s, double t, double *y, double *out)
{
  int rc = lag_sim_eval(s, t, y);

  return rc ? rc : outputs(s, t, y, out);
}

size_t lag_sim_save_size(const lag_sim *s)
{
  return s->nsaved;
}

int lag_sim_save(lag_sim *s, double *x)
{
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

int lag_sim_load(lag_sim *s, const double *x)
{
  if (s->method->flags & LAG_METHOD_NO_SAVE) {
    return lag_fail(s, LAG_EINVAL, "the state of method %s cannot be resumed", s->method->name);
  }
  if (s->tangent) {
    return lag_fail(s, LAG_EINVAL, "a saved state holds no tangent: load it first, then begin one");
  }
  memcpy(s->saved, x, s->nsaved * sizeof *x);
  s->pb.rhs_calls = s->run->rhs_calls;
  s->pb.rejected = s->run->rejected;
  s->pb.systems = s->run->systems;
  s->pb.iterations = s->run->iterations;
  s->pb.dir = s->run->dir;
  lag_note_redundant(s);
  return LAG_OK;
}

/* FNV-1a over text, with its end, so that "ab","c" and "a","bc" differ. */
static unsigned long long hash(unsigned long long h, const char *text)
{
  do {
    h = (h ^ (unsigned char)*text) * 0x100000001b3ull;
  } while (*text++);
  return h;
}

unsigned long long lag_sim_signature(const lag_sim *s)
{
  const lag_model *m = s->scene->model;
  unsigned long long h = hash(0xcbf29ce484222325ull, m->name);
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
