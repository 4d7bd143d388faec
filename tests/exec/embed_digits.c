/* Steps of a header against the runtime's, bit by bit, from a start within NEAR units in the last place: model M,
 * header prefixes M and U, scene SCENE; METHOD by name. TOL: tolerance of adaptive methods; STEPS: at most. A step
 * in which the runtime finds an event is the last. Exit status 0 when all are equal; prints how many there were. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include HEADER
#include "lag.h"

#ifndef TOL
#define TOL 1e-9
#define STEPS 300
#endif
#define JOIN2(a, b) a##b
#define JOIN(a, b) JOIN2(a, b)
extern const lag_scene SCENE;

/* Within `near` units in the last place of the largest component; 0: to the bit. */
static int same(const double *a, const double *b, int n, int near) {
  double most = 0;
  for (int i = 0; i < n; i++) most = fmax(most, fabs(b[i]));
  for (int i = 0; i < n; i++)
    if (!(fabs(a[i] - b[i]) <= near * DBL_EPSILON * most)) {
      printf("component %d: header %.17g, runtime %.17g\n", i, a[i], b[i]);
      return 0;
    }
  return 1;
}

int main(void) {
  enum { NY = JOIN(U, _NY), NQ = JOIN(U, _NQ) };
  JOIN(M, _params) p;
  JOIN(M, _state) s;
  JOIN(M, _defaults)(&p);
  (void)JOIN(M, _start)(&p, &s);
  double y[NY + 1], end = SCENE.t1 > SCENE.t0 ? SCENE.t1 : SCENE.t0 + 1, far = SCENE.t0 + 1e6 * (end - SCENE.t0), reach;
  lag_option opt[] = {{"step", (end - SCENE.t0) / 10000}, {"order", ORDER}};
  if (ADAPTIVE) opt[0] = (lag_option){"atol", TOL}; /* headers know no sizes of the motion */
  const int options = ORDER ? 2 : 1;
  lag_sim *sim = lag_sim_new(&SCENE);
  extern const lag_method JOIN(lag_, METHOD);
  const lag_method *method = &JOIN(lag_, METHOD);
  if (!sim || lag_sim_set_method(sim, method, opt, options) != LAG_OK) return 2;
  if (ADAPTIVE && lag_sim_set_tolerance(sim, TOL) != LAG_OK) return 2;
  int n = 0, rc = lag_sim_advance(sim, SCENE.t0);
  if (rc != LAG_OK) return printf("%s\n", lag_sim_message(sim)), 2;
  JOIN(M, _gather)(&s, y);
  if (!same(y, lag_sim_q(sim), NQ, NEAR) || !same(y + NQ, lag_sim_v(sim), NQ, NEAR) ||
      !same(y + 2 * NQ, lag_sim_z(sim), NY - 2 * NQ, NEAR))
    return printf("at the start\n"), 1;
  memcpy(y, lag_sim_q(sim), NQ * sizeof *y);
  memcpy(y + NQ, lag_sim_v(sim), NQ * sizeof *y);
  memcpy(y + 2 * NQ, lag_sim_z(sim), (NY - 2 * NQ) * sizeof *y);
  JOIN(M, _scatter)(y, &s);
  START
  for (; n < STEPS; n++) {
    rc = lag_sim_ensure_step(sim, far, &reach);
    if (rc == LAG_OK) rc = lag_sim_advance(sim, reach);
    if (rc == LAG_EMETHOD)
      return STEP == 0 ? printf("Newton's method of the runtime fails in step %d, the header's does not\n", n), 1 : 0;
    if (rc != LAG_OK) break;
    if (STEP != 0) return printf("the header's step %d fails\n", n), 1;
    if (s.t != lag_sim_time(sim)) {
      if (lag_sim_time(sim) < s.t && JOIN(U, _NEV) > 0) return printf("%d steps to an event\n", n), 0;
      if (NEAR > 0 && s.t < lag_sim_time(sim))
        return printf("%d steps to one whose error lies across the constraints\n", n), 0;
      printf("step %d, time: header %.17g, runtime %.17g\n", n, s.t, lag_sim_time(sim));
      return 1;
    }
    JOIN(M, _gather)(&s, y);
    if (!same(y, lag_sim_q(sim), NQ, 0) || !same(y + NQ, lag_sim_v(sim), NQ, 0) ||
        !same(y + 2 * NQ, lag_sim_z(sim), NY - 2 * NQ, 0)) {
      printf("after step %d\n", n + 1);
      return 1;
    }
  }
  printf("%d steps, status %d\n", n, rc);
  lag_sim_free(sim);
  return n == 0 && rc != LAG_EDRIFT; /* a step that loses the energy: the runtime refuses the first one */
}
