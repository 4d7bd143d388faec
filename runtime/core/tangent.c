/* The tangent of a run: small changes of the state, carried along. Enters: what they are at one time; leaves: what has become
 * of them. Holds: the run itself is the same, bit by bit, with a tangent or without: steps are differentiated after they
 * were taken, and the counts of the run do not include what that costs. */
#include <stdlib.h>
#include <string.h>

#include "core/core.h"

static size_t block(const lag_sim *s)
{
  return (size_t)s->pb.n * (size_t)s->tangent_columns;
}

void lag_tangent_free(lag_sim *s)
{
  free(s->tangent);
  s->tangent = s->tangent_scratch = NULL;
  s->tangent_columns = 0;
}

/* May steps be differentiated? If not, the message says what to do. */
static int check(lag_sim *s)
{
  const lag_model *m = s->scene->model;
  int in_p = m->nq > 0 && (s->method->flags & LAG_METHOD_VARIATION) && !((s->method->flags & LAG_METHOD_SPLITS) && (m->flags & LAG_SEPARABLE));

  if (m->constraints) {
    return lag_fail(s, LAG_EMETHOD, "there is no tangent of a motion with constraints yet (%s): give the model coordinates that need none",
                    m->constraints->of[0].name);
  }
  if (!s->method->tangent) {
    return lag_fail(s, LAG_EMETHOD, "method %s has no derivative of its steps; %s has", s->method->name,
                    s->method->flags & LAG_METHOD_SYMPLECTIC ? "verlet8" : "dop853");
  }
  if (!in_p && !m->linear) {
    return lag_fail(s, LAG_EMETHOD,
                    "the tangent needs the derivatives of the equations, which this program was built without; `lagc run --tangent` builds "
                    "them in, and so does `lagc build --with linear`");
  }
  return LAG_OK;
}

/* Room for k columns, when there is another number of them. */
static int make_room(lag_sim *s, int k)
{
  size_t n = (size_t)s->pb.n, size = n * (size_t)k;

  if (s->tangent && s->tangent_columns == k) {
    return LAG_OK;
  }
  lag_tangent_free(s);
  s->tangent = calloc(size + s->method->tangent_size(&s->pb, k) + 1, sizeof *s->tangent);
  if (!s->tangent) {
    return lag_fail(s, LAG_ENOMEM, "out of memory");
  }
  s->tangent_scratch = s->tangent + size;
  s->tangent_columns = k;
  return LAG_OK;
}

int lag_sim_set_tangent(lag_sim *s, int k, const double *Y)
{
  int n = s->pb.n, rc;

  if (k == 0) {
    lag_tangent_free(s);
    return LAG_OK;
  }
  if (k < 0 || (!Y && k != n)) {
    return lag_fail(s, LAG_EINVAL, "a tangent of %d columns: give them, or take all %d", k, n);
  }
  if (s->run->have_step != 0.0) {
    return lag_fail(s, LAG_EINVAL, "a tangent begins at the end of a step, and t = %.17g lies within one", s->run->t);
  }
  if ((rc = check(s)) != 0 || (rc = make_room(s, k)) != 0) {
    return rc;
  }
  if (Y) {
    memcpy(s->tangent, Y, block(s) * sizeof *Y);
  } else {
    memset(s->tangent, 0, block(s) * sizeof *s->tangent);
  }
  for (int i = 0; i < n && !Y; i++) {
    s->tangent[i * n + i] = 1;
  }
  return LAG_OK;
}

/* Y := what the last step, up to t, makes of it. */
static int carry(lag_sim *s, double t, double *Y)
{
  lag_problem *pb = &s->pb;
  double rhs_calls = pb->rhs_calls, systems = pb->systems, iterations = pb->iterations;

  pb->detail = NULL;
  pb->bad_index = -1;
  int rc = s->method->tangent(s->method_work, pb, t, s->tangent_columns, Y, s->tangent_scratch);
  pb->rhs_calls = rhs_calls;
  pb->systems = systems;
  pb->iterations = iterations;
  return rc ? lag_explain(s, rc) : LAG_OK;
}

int lag_tangent_pass(lag_sim *s)
{
  return s->tangent && s->run->have_step == 0.0 ? carry(s, s->run->t, s->tangent) : LAG_OK;
}

int lag_tangent_refuse(lag_sim *s, int k)
{
  if (!s->tangent) {
    return LAG_OK;
  }
  return lag_fail(s, LAG_EMETHOD,
                  "event %s changes the state at t = %.17g s: what it does to neighbouring motions needs derivatives of its function and "
                  "its actions, which a model does not have; take a scene without it, or end the run before",
                  s->scene->model->ev[k].name, s->run->t);
}

int lag_sim_tangent(lag_sim *s, double *Y)
{
  const Run *r = s->run;

  if (!s->tangent) {
    return lag_fail(s, LAG_EINVAL, "this run has no tangent: lag_sim_set_tangent");
  }
  memcpy(Y, s->tangent, block(s) * sizeof *Y);
  return r->have_step != 0.0 && r->t != r->step_t0 ? carry(s, r->t, Y) : LAG_OK;
}
