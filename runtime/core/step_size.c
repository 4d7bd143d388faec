/* Sizes of steps that are given: by the option of a method, by the span. */
#include <math.h>
#include <string.h>

#include "core/core.h"
#include "numeric/option_range.h"

const char *lag_step_error(const lag_sim *s, double x) {
  const lag_scene *c = s->scene;
  if (!(x > 0 && isfinite(x))) return "a step must be a positive number";
  return x < 4.5 * DBL_EPSILON * (c->has_span ? fmax(fabs(c->t0), fabs(c->t1)) : fmax(fabs(c->t0), 1))
             ? "time would not move in " LAG_PRECISION " precision" : NULL;
}

double lag_step_size(const lag_problem *pb, double option) {
  return option > 0 ? option : (pb->span > 0 ? pb->span : 10) / 10000;
}

int lag_few_contacts(const lag_model *m) {
  enum { FEW = 8 };
  int contacts = 0;
  for (int i = 0; i < m->ncontacts; i++) contacts += !m->contacts[i].is_tangent;
  return !m->families && contacts <= FEW;
}

double lag_equal_step(const lag_sim *s) {
  const lag_method *m = s->method;
  int adaptive = (m->flags & LAG_METHOD_ADAPTIVE) != 0;
  double step = 0;
  for (int i = 0; i < m->noptions; i++) {
    step = strcmp(m->options[i].name, "step") == 0 ? s->options[i] : step;
    adaptive = strcmp(m->options[i].name, "adapt") == 0 ? s->options[i] == 0.0 : adaptive;
  }
  adaptive |= (m->flags & LAG_METHOD_IMPULSES) && !(step > 0) && lag_few_contacts(s->scene->model);
  return adaptive ? 0 : lag_step_size(&s->pb, step);
}
