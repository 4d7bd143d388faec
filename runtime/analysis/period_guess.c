/* The period of a motion that is not known: its first close return. Enters: a start; leaves: a period for shooting. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/periodic_orbit.h"

/* A motion at several places within each step, so that close passages are seen. */
typedef struct Track {
  const lag_model *m;
  const StateMap *closing, *reverse; /* what it shall come back to; NULL: its begin */
  double *goal, *rates;              /* [n] */
  int n, rows, room;
  double *t, *y; /* [rows], [rows n] */
  double *size;  /* [n] largest excursion from the first row */
} Track;

static int add_row(Track *k, double t, const double *y) {
  if (k->rows == k->room) {
    int room = k->room ? 2 * k->room : 1024;
    double *times = realloc(k->t, (size_t)room * sizeof *times);
    if (times) k->t = times;
    double *states = times ? realloc(k->y, (size_t)room * (size_t)k->n * sizeof *states) : NULL;
    if (!states) return LAG_ENOMEM;
    k->y = states;
    k->room = room;
  }
  k->t[k->rows] = t;
  memcpy(k->y + (size_t)k->rows * (size_t)k->n, y, (size_t)k->n * sizeof *y);
  for (int i = 0; i < k->n; i++) k->size[i] = fmax(k->size[i], fabs(lag_flow_change(k->m, i, y, k->y)));
  k->rows++;
  return LAG_OK;
}

/* Follows the motion until a time, or the event that ends it. */
static int follow_motion(Track *k, lag_sim *sim, double until, double *y) {
  enum { PLACES = 4, MOST_NUMBERS = 40000000 };
  int rc = lag_sim_advance(sim, lag_sim_time(sim));
  rc = rc ? rc : add_row(k, lag_sim_time(sim), sim->now);
  for (double reach; rc == LAG_OK && lag_sim_time(sim) < until && k->rows < MOST_NUMBERS / k->n;) {
    double from = lag_sim_time(sim);
    rc = lag_sim_ensure_step(sim, until, &reach);
    for (int j = 1; j <= PLACES && rc == LAG_OK && reach > from; j++) {
      rc = lag_sim_eval(sim, j == PLACES ? reach : from + (reach - from) * j / PLACES, y);
      rc = rc ? rc : add_row(k, from + (reach - from) * j / PLACES, y);
    }
    rc = rc ? rc : lag_sim_advance(sim, reach);
  }
  return rc == LAG_STOPPED ? LAG_OK : rc;
}

static const double *row_of(const Track *k, int r) { return k->y + (size_t)r * (size_t)k->n; }

/* k->goal := where the motion comes back to, seen from row r: its begin, the image of that, or its own image. */
static void set_goal(const Track *k, int r) {
  const StateMap *map = k->reverse ? k->reverse : k->closing;
  if (map) lag_map_apply(map, row_of(k, k->reverse ? r : 0), k->goal);
  else memcpy(k->goal, k->y, (size_t)k->n * sizeof *k->goal);
}

/* Distance of row r from its goal in parts of the excursions: the largest over components. */
static double away(const Track *k, int r) {
  double most = 0;
  set_goal(k, r);
  for (int i = 0; i < k->n; i++)
    if (k->size[i] > 0) most = fmax(most, fabs(lag_flow_change(k->m, i, row_of(k, r), k->goal)) / k->size[i]);
  return most;
}

/* Row of the first close return; 0: none. One in the next one and a half of its times that is ten times nearer is
 * taken before it: an angle that swings to both sides of a half turn is near its start after half a period. */
static int first_return(const Track *k) {
  const double near = 0.15, nearer = 0.1, next_times = 2.5;
  double before = 0, now = 0, least = near;
  int left = 0, found = 0;
  for (int r = 1; r < k->rows; r++) {
    if (found && k->t[r - 1] - k->t[0] > next_times * (k->t[found] - k->t[0])) return found;
    double next = away(k, r);
    left |= now > 2 * near;
    if (left && now <= before && now < next && now < least) {
      if (found) return r - 1;
      found = r - 1, least = nearer * now;
    }
    before = now;
    now = next;
  }
  return found;
}

/* Row next to time t0 + about that is nearest to the first; 0: none is near. */
static int nearest_return(const Track *k, double about) {
  const double part = 0.2;
  double least = 0.3;
  int best = 0;
  for (int r = 1; r < k->rows; r++) {
    if (fabs(k->t[r] - k->t[0] - about) > part * about) continue;
    double off = away(k, r);
    if (off < least) best = r, least = off;
  }
  return best;
}

/* Time by which the motion at row r comes still nearer to its goal: along the rates there, in excursions. */
static double nearer(FlowMap *f, const Track *k, int r) {
  double along = 0, length = 0;
  const double *y = row_of(k, r);
  set_goal(k, r);
  if (lag_flow_rates(f, f->t0, k->reverse ? y : k->goal, k->rates)) return 0;
  if (k->reverse) lag_map_apply(k->reverse, k->rates, f->up);
  for (int i = 0; i < k->n; i++) {
    double weight = k->size[i] > 0 ? 1 / (k->size[i] * k->size[i]) : 0,
           rate = k->rates[i] - (k->reverse ? f->up[i] : 0);
    along -= lag_flow_change(k->m, i, y, k->goal) * rate * weight;
    length += rate * rate * weight;
  }
  double least = k->t[r > 0 ? r - 1 : r] - k->t[r], most = k->t[r < k->rows - 1 ? r + 1 : r] - k->t[r];
  return length > 0 ? fmin(fmax(along / length, least), most) : 0; /* where it nearly rests rates say nothing */
}

/* text := the nearest approach after the motion has left its start. */
static void put_nearest(const Track *k, double parts, char *text, size_t size) {
  double least = HUGE_VAL, before = 0, now = 0;
  int best = 0;
  for (int r = 1; r < k->rows; r++) {
    double next = away(k, r);
    if (r > 1 && now <= before && now < next && now < least) best = r - 1, least = now;
    before = now, now = next;
  }
  if (best)
    snprintf(text, size, "; it comes nearest after %.4g s, to %.2g of its excursions",
             parts * (k->t[best] - k->t[0]), least);
  else snprintf(text, size, "; it only goes away from it");
}

int lag_orbit_guess(const PeriodicOrbit *o, lag_sim *like, double until, double about, double *T, char *message,
                    size_t size) {
  FlowMap f;
  Pool pool = {0};
  Track k = {.m = like->scene->model, .n = like->pb.n, .closing = o->closing, .reverse = o->reverse};
  size_t n = (size_t)k.n;
  double parts = o->reverse ? 2 : 1;
  int rc = lag_flow_open(&f, like);
  k.size = lag_pool_doubles(&pool, 2 * n);
  k.goal = lag_pool_doubles(&pool, n);
  k.rates = lag_pool_doubles(&pool, n);
  rc = rc ? rc : lag_orbit_check_maps(o, &f, 0);
  lag_sim *sim = rc ? NULL : lag_flow_sim(&f, f.t0, NULL);
  *T = 0;
  if (rc == LAG_OK && (!sim || pool.failed)) rc = LAG_ENOMEM;
  rc = rc ? rc : follow_motion(&k, sim, until, k.size + k.n);
  if (rc) snprintf(message, size, "%s", sim ? lag_sim_message(sim) : f.message);
  if (rc == LAG_OK) {
    int at = about > 0 ? nearest_return(&k, about / parts) : first_return(&k);
    *T = at ? parts * (k.t[at] - k.t[0] + nearer(&f, &k, at)) : 0;
    message[0] = '\0';
    if (!at) put_nearest(&k, parts, message, size);
  }
  free(k.t);
  free(k.y);
  lag_sim_free(sim);
  lag_flow_free(&f);
  lag_pool_free(&pool);
  return rc;
}
