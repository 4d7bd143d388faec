/* Gradients of measures. Enters: a measure of a run that has ended; leaves: its derivatives by starts and parameters.
 * Holds: a measure depends on the states at some times: the end, x(10), where a largest or smallest value is, whose
 * time is stationary, and where an event happens or a value passes 0, whose time T changes by dT = -dg/(dg/dt). Weights
 * of these states come from the nodes in reverse, and within the expression at one time from differences of order 6;
 * lag_sim_gradient carries them to the start. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/measure_nodes.h"
#include "core/core.h"

enum { MOST_ROWS = 64 };

/* The measure changes by `weight` times the change of the expression `node` at time t, or, IS_TIME, of the time near t
 * at which it passes 0; event >= 0: at which this event happens for the firing-th time. */
typedef struct Seed {
  double t, weight;
  int node, is_time, event, firing;
} Seed;

/* The event that is waited for: its time, NaN before, and the state y[n] there before its action; firings[nev]
 * so far. */
typedef struct Wait {
  int event, firing, n;
  double t, *y, *firings;
} Wait;

typedef struct MeasureGradient {
  Measures *m;
  Wait wait;
  double *adjoint; /* [nodes] */
  Seed seed[MOST_ROWS];
  int n;
  const char *refused;
} MeasureGradient;

static void put_seed(MeasureGradient *g, Seed of) {
  if (g->n == MOST_ROWS) g->refused = "it has too many values at times";
  else if (of.weight != 0.0) g->seed[g->n++] = of;
}

static void seed_hit(MeasureGradient *g, const MeasureNode *n, double weight) {
  const Measures *m = g->m;
  if (m->scene->model->ev[n->index].direction == LAG_KICK)
    g->refused = "times of kicks have no gradient: they are multiples of a period, which a parameter may be";
  else put_seed(g, (Seed){n->result, weight, -1, 1, n->index, (int)m->node[n->a].value});
}

/* The mean time between the first upward passage of 0 and the last. */
static void seed_period(MeasureGradient *g, const Track *k, double weight) {
  double part = weight / (k->passages - 1) * (k->latest < k->passage ? -1 : 1);
  for (int i = 0; i < 2 && k->passages > 1; i++)
    put_seed(g, (Seed){i ? k->latest : k->passage, i ? part : -part, k->arg, 1, -1, 0});
}

/* ---- Nodes in reverse */

/* Derivative of a function of the nodes a and b by one of them. */
static double slope(const Measures *m, const MeasureNode *n, int by_b) {
  double a = m->node[n->a].value, b = n->two ? m->node[n->b].value : 0, at = by_b ? b : a,
         h = LAG_DIFFERENCE_PART * (at != 0.0 ? fabs(at) : 1), sum = 0;
  LAG_EACH_DIFFERENCE(k) {
    double x = by_b ? a : a + k * h, y = by_b ? b + k * h : b;
    sum += lag_difference_weight(k) * (n->two ? n->two(x, y) : n->one(x)) / h;
  }
  return sum;
}

static void seed_track(MeasureGradient *g, const Track *k, double weight) {
  int falls = k->kind == TRACK_MIN || (k->kind == TRACK_DRIFT && k->first - k->least > k->most - k->first);
  if (k->kind == TRACK_PERIOD) {
    seed_period(g, k, weight);
    return;
  }
  if (k->kind != TRACK_MAX && k->kind != TRACK_MIN && k->kind != TRACK_DRIFT) {
    g->refused =
      "means have no gradient yet: make the value a state, state S with flow S' = x, and take S/t at the end";
    return;
  }
  double part = k->kind == TRACK_DRIFT && falls ? -weight : weight;
  put_seed(g, (Seed){falls ? k->when_least : k->when_most, part, k->arg, .event = -1});
  if (k->kind == TRACK_DRIFT) put_seed(g, (Seed){g->m->t0, -part, k->arg, .event = -1});
}

static void pass_back(MeasureGradient *g, int i) {
  Measures *m = g->m;
  const MeasureNode *n = &m->node[i];
  double x = g->adjoint[i];
  switch (n->kind) {
    case MEASURE_NUMBER: case MEASURE_END: case MEASURE_FIRINGS: return;
    case MEASURE_QUANTITY: put_seed(g, (Seed){m->t, x, i, .event = -1}); return;
    case MEASURE_AT:
      if (m->node[n->b].known != MEASURE_STATIC) g->refused = "the time of a value is itself a measure";
      put_seed(g, (Seed){m->node[n->b].value, x, n->a, .event = -1});
      return;
    case MEASURE_TRACK: seed_track(g, &m->track[n->index], x); return;
    case MEASURE_TWO: g->adjoint[n->a] += x * slope(m, n, 0), g->adjoint[n->b] += x * slope(m, n, 1); return;
    case MEASURE_ONE: g->adjoint[n->a] += x * slope(m, n, 0); return;
    case MEASURE_HIT: seed_hit(g, n, x); return;
    case MEASURE_LYAPUNOV: case MEASURE_MEGNO: g->refused = "exponents have no gradient"; return;
  }
}

static int by_time(const void *a, const void *b) {
  const Seed *x = a, *y = b;
  return (x->t > y->t) - (x->t < y->t);
}

/* Seeds of measure k, in the order of the run. */
static void collect_seeds(MeasureGradient *g, int k, double dir) {
  Measures *m = g->m;
  int root = m->root[k];
  memset(g->adjoint, 0, (size_t)m->nnodes * sizeof *g->adjoint);
  g->adjoint[root] = 1 / m->unit[k].factor;
  for (int i = root; i >= m->node[root].begin && !g->refused; i--)
    if (g->adjoint[i] != 0.0) pass_back(g, i);
  qsort(g->seed, (size_t)g->n, sizeof *g->seed, by_time);
  for (int i = 0; i < g->n / 2 && dir < 0; i++) {
    Seed x = g->seed[i];
    g->seed[i] = g->seed[g->n - 1 - i], g->seed[g->n - 1 - i] = x;
  }
}

/* ---- Weights */

/* The expression of a seed, or its event function. */
static double value_of(Measures *m, const Seed *of, double t, const double *y) {
  lag_sim *s = m->sim;
  if (of->event < 0) return lag_measure_at(m, of->node, t, y);
  return lag_events_eval(s, t, y, s->g1) == LAG_OK ? s->g1[of->event] : NAN;
}

/* -1 over the rate of the expression along the motion, with its slopes by y[n]; f[n] is scratch. */
static double time_factor(Measures *m, const Seed *of, const double *y, const double *slopes, double *f) {
  lag_sim *s = m->sim;
  double h = LAG_DIFFERENCE_PART * (s->pb.span > 0 ? s->pb.span : 1) / 64, rate = 0;
  if (lag_rhs(&s->pb, of->t, y, f)) return NAN;
  for (int i = 0; i < s->pb.n; i++) rate += slopes[i] * f[i];
  LAG_EACH_DIFFERENCE(k) rate += lag_difference_weight(k) * value_of(m, of, of->t + k * h, y) / h;
  return -1 / rate;
}

/* weight[n] := derivatives by the state y[n]; by_p += those by parameters, at this state. there[n] is scratch. */
static void weigh(Measures *m, const Seed *of, const double *y, double *there, double *weight, double *by_p) {
  lag_sim *s = m->sim;
  const lag_parameter_columns *by = s->pb.by;
  int n = s->pb.n;
  memset(weight, 0, (size_t)n * sizeof *weight);
  memcpy(there, y, (size_t)n * sizeof *there);
  for (int c = 0; c < n; c++) {
    double h = LAG_DIFFERENCE_PART * lag_difference_scale(&s->pb, y, c);
    LAG_EACH_DIFFERENCE(k) {
      there[c] = y[c] + k * h;
      weight[c] += lag_difference_weight(k) * value_of(m, of, of->t, there) / h;
    }
    there[c] = y[c];
  }
  double factor = of->weight * (of->is_time ? time_factor(m, of, y, weight, there) : 1);
  for (int c = 0; c < n; c++) weight[c] *= factor;
  for (int j = 0; by && j < by->n; j++) {
    LAG_EACH_DIFFERENCE(k) {
      lag_use_parameters(s, j, k);
      by_p[j] += factor * lag_difference_weight(k) * value_of(m, of, of->t, y) / by->h[j];
    }
    lag_use_parameters(s, 0, 0);
  }
}

static void note_event(void *context, int k, double t, const double *before, const double *after) {
  Wait *w = context;
  (void)after;
  w->firings[k]++;
  if (k != w->event || w->firings[k] < w->firing || !isnan(w->t)) return;
  w->t = t;
  memcpy(w->y, before, (size_t)w->n * sizeof *before);
}

/* The state y[n] of a seed, whose time becomes that of its event in this run. */
static int go_to(MeasureGradient *g, lag_sim *sim, Seed *of, double *y) {
  g->wait = (Wait){of->event, of->firing, sim->pb.n, NAN, y, g->wait.firings};
  int rc = lag_sim_advance(sim, of->t), before = isnan(g->wait.t);
  if (!before) of->t = g->wait.t;
  return rc || !before ? rc : lag_sim_eval(sim, of->t, y);
}

/* Runs to each seed and weighs the state there, then goes back. room[(n + 1) seeds + 2 n + np + nev]. */
static int run_back(MeasureGradient *g, lag_sim *sim, double *by_start, double *by_p, double *room) {
  int n = sim->pb.n, np = sim->pb.model->np, rc = lag_sim_record(sim), count = g->n;
  double *t = room, *weight = t + count, *y = weight + count * n, *there = y + n, *direct = there + n;
  g->wait.firings = direct + np;
  lag_sim_on_event(sim, note_event, &g->wait);
  for (int k = 0; k < count && rc == LAG_OK; k++) {
    rc = go_to(g, sim, &g->seed[k], y);
    t[k] = g->seed[k].t;
    if (rc == LAG_OK) weigh(g->m, &g->seed[k], y, there, weight + k * n, direct);
  }
  lag_sim_on_event(sim, NULL, NULL);
  rc = rc ? rc : lag_sim_gradient(sim, count, t, weight, by_start, by_p);
  for (int j = 0; j < np && rc == LAG_OK; j++) by_p[j] += direct[j];
  return rc;
}

int lag_measures_gradient(Measures *m, int k, lag_sim *sim, double *by_start, double *by_p, char *why, size_t size) {
  size_t n = (size_t)sim->pb.n, np = (size_t)sim->pb.model->np;
  lag_sim *own = m->sim;
  double end = m->t; /* evaluations at other times set it */
  MeasureGradient g = {.m = m, .adjoint = calloc((size_t)m->nnodes + 1, sizeof *g.adjoint)};
  double *room = calloc((size_t)MOST_ROWS * (n + 1) + 2 * n + np + 1 + (size_t)sim->pb.model->nev, sizeof *room);
  int rc = g.adjoint && room ? LAG_OK : lag_fail(sim, LAG_ENOMEM, "out of memory");
  if (rc == LAG_OK) collect_seeds(&g, k, m->t < m->t0 ? -1 : 1);
  m->sim = sim;
  if (rc == LAG_OK && !g.refused) rc = run_back(&g, sim, by_start, by_p, room);
  m->sim = own;
  m->t = end;
  free(g.adjoint);
  free(room);
  snprintf(why, size, "%s", g.refused ? g.refused : rc ? lag_sim_message(sim) : "");
  return g.refused || rc ? -1 : 0;
}
