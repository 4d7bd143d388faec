/* Names, units and values in declared units of the components of a state, and of outputs. */
#include <math.h>
#include <stdio.h>

#include "core/core.h"

/* Copies a variable's name and unit, of a velocity with ' and /s. A quantity without a unit has a rate without one:
 * a model in which nothing has units stays so. */
static double put_info(const lag_var *v, int velocity, char *name, size_t nname, char *unit, size_t nunit) {
  if (name) snprintf(name, nname, "%s%s", v->name, velocity ? "'" : "");
  if (unit) snprintf(unit, nunit, "%s%s", v->unit, velocity && v->unit[0] ? "/s" : "");
  return v->factor;
}

double lag_sim_state_info(const lag_sim *s, int i, char *name, size_t nname, char *unit, size_t nunit) {
  if (!s || i < 0 || i >= s->pb.n) return NAN;
  const lag_model *m = s->scene->model;
  const lag_var *v = i < 2 * m->nq ? &m->q[i % m->nq] : &m->z[i - 2 * m->nq];

  return put_info(v, i >= m->nq && i < 2 * m->nq, name, nname, unit, nunit);
}

double lag_sim_declared(const lag_sim *s, int i, double value) {
  if (!s || i < 0 || i >= s->pb.n) return NAN;
  const lag_model *m = s->scene->model;
  int rate = i >= m->nq && i < 2 * m->nq;
  const lag_var *v = i < 2 * m->nq ? &m->q[i % m->nq] : &m->z[i - 2 * m->nq];

  return rate ? value / v->factor : lag_declared(v, value);
}

double lag_sim_state_value(const lag_sim *s, int i) {
  if (!s || i < 0 || i >= s->pb.n) return NAN;
  return lag_sim_declared(s, i, s->now[i]);
}

double lag_sim_output_info(const lag_sim *s, int i, char *name, size_t nname, char *unit, size_t nunit) {
  if (!s || i < 0 || i >= lag_sim_noutputs(s)) return NAN;
  if (s->scene->nout == 0) return lag_sim_state_info(s, i, name, nname, unit, nunit);
  return put_info(&s->scene->outputs[i], 0, name, nname, unit, nunit);
}
