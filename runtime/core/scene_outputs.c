/* Outputs of a state, and the independence of constraints that decides how. Near a position where constraints become dependent, with
 * independence s, multipliers and accelerations have an error of at least eps/s^2, and of the state's error over s^2 (measured: 1e-8 at s =
 * 0.01, 2e21 at 1e-11): where s < 1e-3 they are extrapolated along the motion.
 *
 * Holds: outputs that contain no force are those of the state, everywhere. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"

static int observe(lag_sim *s, double t, const double *y, double *out)
{
  const lag_scene *c = s->scene;
  int rc = lag_inputs(&s->pb, t);

  rc = rc ? rc : lag_closed_form_at(s, t);
  return rc ? rc : c->observe(t, y, y + s->pb.nq, y + 2 * s->pb.nq, s->p, s->u, out, s->work);
}

/* Spacing in time, with its sign, of four places within the step that are far from the singular one; 0: no step, or no such places. y[n] is
 * scratch. */
static double find_side(lag_sim *s, double t, double *y)
{
  const double good = 5e-2, enough = 1e-4; /* `enough` for the longest spacing */
  const Run *r = s->run;
  double back = r->have_step != 0.0 ? r->step_t0 - t : 0, on = r->have_step != 0.0 ? r->limit - t : 0, room = (fabs(back) > fabs(on) ? back : on) / 4;
  int weakest;

  for (double part = 0x1p-20; part <= 1 && room != 0.0; part *= 2) {
    double apart = part * room;
    if (fabs(apart) > 64 * DBL_EPSILON * fabs(t) && lag_dense_state(s, t + apart, y) == 0 &&
        lag_independence(&s->pb, t + apart, y, &weakest) >= (part < 1 ? good : enough)) {
      return apart;
    }
  }
  return 0;
}

/* Replaces outputs with forces among out[nout] by cubic extrapolation from four places of the step; NaN where there are none. */
static int replace_forces(lag_sim *s, double t, double *out)
{
  static const double weight[] = {4, -6, 4, -1};
  const lag_scene *c = s->scene;
  size_t n = (size_t)s->pb.n, nout = (size_t)c->nout;
  double *y = calloc(n + nout, sizeof *y), *there = y + n, apart = y ? find_side(s, t, y) : 0;
  int rc = y ? 0 : LAG_ENOMEM;

  for (int i = 0; i < c->nout; i++) {
    out[i] = c->forces[i] ? (apart != 0.0 ? 0 : NAN) : out[i];
  }
  for (int k = 0; k < 4 && apart != 0.0 && rc == 0; k++) {
    rc = lag_dense_state(s, t + (k + 1) * apart, y);
    rc = rc ? rc : observe(s, t + (k + 1) * apart, y, there);
    for (int i = 0; i < c->nout && rc == 0; i++) {
      out[i] += c->forces[i] ? weight[k] * there[i] : 0;
    }
  }
  free(y);
  return rc;
}

int lag_observe(lag_sim *s, double t, const double *y, double *out)
{
  const double doubtful = 1e-3;
  int weakest, rc = observe(s, t, y, out);

  if (rc == 0 && s->scene->forces && s->scene->model->constraints && lag_independence(&s->pb, t, y, &weakest) < doubtful) {
    rc = replace_forces(s, t, out);
  }
  return rc;
}
