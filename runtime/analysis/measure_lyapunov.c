/* The measures `lyapunov`, the largest Lyapunov exponent of a run (lyapunov.h), and `megno`, the mean exponential
 * growth of nearby orbits: the mean over t of Y(t) = 2/t int s d(log |d|), which tends to 2 for regular motions and
 * grows as half the exponent times t for chaotic ones (P. M. Cincotta, C. Simo, Astron. Astrophys. Suppl. 147 (2000)
 * 205, DOI 10.1051/aas:2000108). Enters: a run that has ended; leaves: the number, or why there is none. Holds: each
 * takes a run of its own, with a tangent, so that the first has the steps that it has without. */
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
  double t, growth, y, mean; /* end of the last step; int s d(log |d|), Y and its integral until then, since l.begun */
} Exponent;

/* MEGNO over the last step, in whose middle its growth counts. */
static void add_growth(Exponent *e, double growth) {
  const Lyapunov *l = &e->l;
  double from = e->t - l->begun, to = l->t - l->begun, before = e->y;
  e->t = l->t;
  if (!(to > 0) || !(from >= 0)) return;
  e->growth += (from + to) / 2 * growth;
  e->y = 2 * e->growth / to;
  e->mean += (before + e->y) / 2 * (to - from);
}

static int after_step(void *exponent, const lag_sim *sim) {
  Exponent *e = exponent;
  double before = e->l.sum[0];
  if (e->rc == 0) e->rc = lag_lyapunov_step(&e->l, e->sim);
  if (e->rc == 0) add_growth(e, e->l.sum[0] - before);
  return e->rc != 0 || (e->first->on_step && e->first->on_step(e->first->on_step_context, sim));
}

static void at_event(void *exponent, int k, double t, const double *before, const double *after) {
  Exponent *e = exponent;
  (void)k;
  if (memcmp(before, after, (size_t)e->l.n * sizeof *before) != 0) lag_lyapunov_event(&e->l, e->sim, t, before);
}

/* A run like `first`, with a tangent; for MEGNO, which needs the growth from the begin, without a transient. 0, or a
 * status with the reason in why. */
static int begin(Exponent *e, const lag_sim *first, double until, MeasureKind kind, char *why, size_t size) {
  *e = (Exponent){.sim = lag_sim_like(first), .first = first};
  if (!e->sim) return snprintf(why, size, "out of memory"), LAG_ENOMEM;
  double t0 = lag_sim_time(e->sim), from = kind == MEASURE_MEGNO ? t0 : t0 + (until - t0) / TURNING;
  int rc = until > t0 ? lag_lyapunov_begin(&e->l, e->sim, 1, from, until) : LAG_EINVAL;
  if (kind == MEASURE_MEGNO) /* the first step counts, too */
    e->l.begun = e->l.block_from = e->l.traced = e->t = t0;
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
  if (m->exponent || m->megno) {
    rc = begin(&e, like, until, MEASURE_LYAPUNOV, why, size);
    if (rc == 0 && lag_sim_time(like) != lag_sim_time(e.sim))
      rc = LAG_EINVAL, snprintf(why, size, "a saved state holds no tangent; run it in one piece");
    end(&e);
  }
  return rc ? -1 : 0;
}

double lag_measure_lyapunov(Measures *m, const lag_sim *first, double until, MeasureKind kind) {
  Exponent e;
  double x = NAN;
  char *why = m->no_exponent;
  size_t size = sizeof m->no_exponent;
  if (m->status == LAG_STOPPED)
    snprintf(why, size, "an event stops the run at t = %s s, and an exponent is a mean over a motion that goes on",
             LAG_TEXT(until));
  else if (m->status) snprintf(why, size, "the run is not complete");
  if (m->status) return NAN;
  if (begin(&e, first, until, kind, why, size) == 0) {
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
    else if (kind == MEASURE_MEGNO) x = e.mean / (e.l.t - e.l.begun);
  }
  end(&e);
  return x;
}
