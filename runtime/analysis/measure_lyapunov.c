/* The measure `lyapunov`: the largest Lyapunov exponent of a run (lyapunov.h). Enters: a run that has ended; leaves:
 * the exponent, or why there is none. Holds: it takes a run of its own, with a tangent, so that the first has the
 * steps that it has without. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/lyapunov.h"
#include "analysis/measure_nodes.h"
#include "core/core.h"

enum { TURNING = 10 }; /* a tenth of the time is left out, in which the vector turns, as by `lagc lyapunov` */

typedef struct Exponent {
  Lyapunov l;
  lag_sim *sim;
  const lag_sim *first; /* the run that is measured: its hook ends this one, too */
  int rc;
} Exponent;

static int after_step(void *exponent, const lag_sim *sim) {
  Exponent *e = exponent;
  if (e->rc == 0) e->rc = lag_lyapunov_step(&e->l, e->sim);
  return e->rc != 0 || (e->first->on_step && e->first->on_step(e->first->on_step_context, sim));
}

static void at_event(void *exponent, int k, double t, const double *before, const double *after) {
  Exponent *e = exponent;
  (void)k;
  if (memcmp(before, after, (size_t)e->l.n * sizeof *before) != 0) lag_lyapunov_event(&e->l, e->sim, t, before);
}

/* A run like `first`, with a tangent. 0, or a status with the reason in why. */
static int begin(Exponent *e, const lag_sim *first, double until, char *why, size_t size) {
  *e = (Exponent){.sim = lag_sim_like(first), .first = first};
  if (!e->sim) return snprintf(why, size, "out of memory"), LAG_ENOMEM;
  double t0 = lag_sim_time(e->sim);
  int rc = until > t0 ? lag_lyapunov_begin(&e->l, e->sim, 1, t0 + (until - t0) / TURNING, until) : LAG_EINVAL;
  if (rc)
    snprintf(why, size, "%s",
             until > t0 ? lag_sim_message(e->sim) : "an exponent is a mean over a long time, forwards");
  return rc;
}

static void end(Exponent *e) {
  lag_lyapunov_free(&e->l);
  lag_sim_free(e->sim);
}

int lag_measures_refused(const Measures *m, const lag_sim *like, double until, char *why, size_t size) {
  Exponent e;
  int rc = 0;
  if (m->exponent) {
    rc = begin(&e, like, until, why, size);
    if (rc == 0 && lag_sim_time(like) != lag_sim_time(e.sim))
      rc = LAG_EINVAL, snprintf(why, size, "a saved state holds no tangent; run it in one piece");
    end(&e);
  }
  return rc ? -1 : 0;
}

double lag_measure_lyapunov(Measures *m, const lag_sim *first, double until) {
  Exponent e;
  double x = NAN;
  char *why = m->no_exponent;
  size_t size = sizeof m->no_exponent;
  if (m->status == LAG_STOPPED)
    snprintf(why, size, "an event stops the run at t = %s s, and an exponent is a mean over a motion that goes on",
             LAG_TEXT(until));
  else if (m->status) snprintf(why, size, "the run is not complete");
  if (m->status) return NAN;
  if (begin(&e, first, until, why, size) == 0) {
    lag_sim_on_step(e.sim, after_step, &e);
    lag_sim_on_event(e.sim, at_event, &e);
    int rc = lag_sim_advance(e.sim, until);
    x = lag_lyapunov_exponent(&e.l, 0);
    snprintf(why, size, "no step of the run ends in the last nine tenths of its time");
    if (e.rc == LAG_EDOMAIN)
      snprintf(why, size, "neighbouring motions become one within a step, an exponent of minus infinity");
    else if (e.rc || rc)
      snprintf(why, size, "the run with a tangent ends at t = %s s: %s", LAG_TEXT(lag_sim_time(e.sim)),
               lag_sim_message(e.sim));
    else if (x == -HUGE_VAL)
      snprintf(why, size,
               "neighbouring motions become one where the motion begins to slide, an exponent of minus infinity");
    if (e.rc || rc || x == -HUGE_VAL) x = NAN;
  }
  end(&e);
  return x;
}
