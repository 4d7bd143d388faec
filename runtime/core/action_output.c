/* Action variables in outputs. Enters: a state, the curve H(q, p) = E through it; leaves: J, or NaN. */
#include <math.h>

#include "lag_model.h"
#include "numeric/action_integral.h"

typedef struct {
  const lag_action_curve *of;
  double t;
  const double *p, *u;
  double *y, *w;
} Place;

static lag_phase_point point_at(void *context, double q, double p) {
  const Place *c = context;
  double out[4], *y = c->y;
  int nq = c->of->nq;
  y[c->of->q] = q;
  y[c->of->p] = p;
  if (c->of->curve(c->of, c->t, y, y + nq, y + 2 * nq, c->p, c->u, out, c->w))
    return (lag_phase_point){NAN, NAN, NAN, NAN};
  return (lag_phase_point){out[0], out[1], out[2], out[3]};
}

double lag_action(const lag_action_curve *of, double t, const double *q, const double *v, const double *z,
                  const double *p, const double *u, double *y, double *w) {
  Place c = {of, t, p, u, y, w};
  for (int i = 0; i < of->nq; i++) y[i] = q[i];
  for (int i = 0; i < of->nz; i++) y[2 * of->nq + i] = z[i];
  if (of->momenta && of->momenta(of, t, q, v, z, p, u, y + of->nq, w)) return NAN;
  lag_action_integral x = lag_action_of_curve(point_at, &c, y[of->q], y[of->p], of->periodic);
  return x.why_not ? NAN : x.J;
}
