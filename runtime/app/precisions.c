/* How far the digits of each precision carry, and what they cost, for `lagc cost`. Enters: times of other
 * precisions' most accurate runs, with the reference; leaves: horizons. Holds: errors grow along a motion by the
 * same factor in every precision, so that the growth of errors of this program tells where those of others, smaller
 * or larger by the ratio of their last digits, leave no digit. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/cost.h"
#include "core/core.h"
#include "numeric/clock.h"

/* The most accurate run of this program, noted in *e. */
typedef struct Course {
  App *app;
  ErrorEstimate *e;
  lag_sim *sim;
  double latest; /* processor time at which it is left [s] */
} Course;

static int note_step(void *course, const lag_sim *sim) {
  Course *c = course;
  (void)sim;
  lag_error_estimate_note(c->e, c->sim);
  return lag_processor_seconds() > c->latest || lag_app_interrupted() != EXIT_SIGNAL;
}

/* Horizon of each precision, from errors in this one. */
static void find_horizons(Cost *c, ErrorEstimate *e, double own, double dir) {
  for (int i = 0; i < c->nprecisions; i++)
    c->precision[i].horizon = e->t0 + dir * lag_error_reach(e, c->precision[i].epsilon / own);
}

int lag_cost_precisions(App *app, Cost *c, double seconds) {
  const double spans = 10; /* a single one may be too short to show how errors grow */
  ErrorEstimate e = {0};
  double begin = lag_processor_seconds(), dir = app->until < app->scene->t0 ? -1 : 1, used;
  Course course = {.app = app, .e = &e, .sim = lag_cost_most_accurate(app), .latest = begin + 0.5 * seconds};
  if (!course.sim) return LAG_OK; /* this run has been refused: the reference is another program's */
  int rc = lag_error_estimate_init(&e, course.sim);
  if (rc == LAG_OK) {
    lag_sim_on_step(course.sim, note_step, &course);
    int ended = lag_sim_advance(course.sim, app->until);
    used = lag_processor_seconds() - begin;
    c->seen = lag_sim_time(course.sim);
    memmove(c->precision + 1, c->precision, (LAG_COST_PRECISIONS - 1) * sizeof *c->precision);
    c->nprecisions = (int)fmin(c->nprecisions + 1, LAG_COST_PRECISIONS);
    c->precision[0] = (CostPrecision){.name = LAG_PRECISION, .epsilon = DBL_EPSILON, .seconds = used, .to = c->seen};
    if (ended == LAG_OK) {
      lag_sim_advance(course.sim, app->scene->t0 + spans * (app->until - app->scene->t0));
      c->seen = lag_sim_time(course.sim);
    }
    rc = lag_app_compare_errors(app, &e, course.sim, 4 * lag_app_work(course.sim));
    find_horizons(c, &e, DBL_EPSILON, dir);
  }
  lag_error_estimate_free(&e);
  lag_sim_free(course.sim);
  return rc;
}

/* Time of a whole run, from that of a run to t = to. */
static double whole(const Cost *c, const CostPrecision *p) {
  double t0 = c->reference.t[0];
  return p->seconds * fmax((c->event - t0) / (p->to - t0), 0);
}

/* Whether the errors that were seen tell of the horizon: growth is not continued for more than as long again. */
static int is_seen(const Cost *c, const CostPrecision *p) {
  const double further = 2;
  double t0 = c->reference.t[0];
  return fabs(p->horizon - t0) <= further * fabs(c->seen - t0);
}

void lag_cost_put_precisions(FILE *f, const Cost *c) {
  if (!c->nprecisions) return;
  fputs("\n  precision       digits last to t =     its most accurate run takes\n", f);
  for (int i = 0; i < c->nprecisions; i++) {
    const CostPrecision *p = &c->precision[i];
    char to[32];
    snprintf(to, sizeof to, is_seen(c, p) ? "%.3g s" : "more than %.3g s", is_seen(c, p) ? p->horizon : c->seen);
    fprintf(f, "  %-12s %22s %20.4g ms\n", p->name, to, 1e3 * whole(c, p));
  }
  fprintf(f,
          "digits last until rounding errors, as they grow along this motion, have reached the size of the motion; "
          "seen to t = %.3g s\n",
          c->seen);
}

void lag_cost_put_precisions_json(Json *j, const Cost *c) {
  JSON_OBJECTS(j, "precisions", i, c->nprecisions) {
    lag_json_string(j, "precision", c->precision[i].name);
    lag_json_number(j, "horizon", is_seen(c, &c->precision[i]) ? c->precision[i].horizon : NAN);
    lag_json_number(j, "seconds", whole(c, &c->precision[i]));
  }
}
