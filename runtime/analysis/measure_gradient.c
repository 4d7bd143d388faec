/* Gradients of measures. Enters: a measure of a run that has ended; leaves: its derivatives by starts and parameters.
 * Holds: a measure depends on the states at some times: fixed ones, as the end and x(10); where a largest or smallest
 * value is, whose time is stationary; the places of a mean's quadrature; and where an event happens or a value passes
 * 0, whose time T changes by dT = -dg/(dg/dt). A value at an event, as the largest one before a bounce or any at the
 * end where an event ends the run, changes by its rate times dT, too; a mean by what its value jumps times dT. Weights
 * of these states come from the nodes in reverse, and within the expression at one time from differences of order 6;
 * lag_sim_gradient carries them to the start. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/measure_nodes.h"
#include "core/core.h"
#include "numeric/release.h"

enum { MOST_SEEDS = 64 };

typedef enum SeedKind { VALUE, PASSAGE, EVENT_VALUE, EVENT_TIME } SeedKind;

/* The measure changes by `weight` times the change of: the expression `node` at time t; the time near t at which it
 * passes 0; its value at an event; the time of an event. done: 1 once it is among the rows. top: the value is the
 * largest or smallest one of this track. */
typedef struct Seed {
  SeedKind kind;
  double t, weight;
  int node;
  Happening at;
  int done;
  const Track *top;
  double value; /* the largest or smallest */
} Seed;

/* ... and by factor times the integral of the track's value, or of half its square. */
typedef struct Sum {
  const Track *track;
  double factor;
  double last, most; /* at the end of the last step: the value, NaN where an event follows; the largest size so far */
} Sum;

/* An event that has happened: the states y[n] before it and y[n] after it. */
typedef struct Seen {
  Happening at;
  double t, *y;
} Seen;

/* A function to differentiate: an expression, or, event >= 0, that of an event; the expression a short time `later`, to
 * which the rates lead. */
typedef struct Function {
  int node, event;
  double later;
} Function;

typedef struct MeasureGradient {
  Measures *m;
  lag_sim *sim; /* the run under way */
  double *adjoint; /* [nodes] */
  Seed seed[MOST_SEEDS];
  Sum sum[MOST_SEEDS];
  int n, sums;
  const char *refused;
  double end;      /* of the measured run, */
  Happening ended; /* and the event that has ended it */

  double *firings, *hold; /* [nev]; [nu + nmodes] before the last event */
  Seen *seen;             /* events that are not among the rows yet */
  int nseen, seen_room, no_memory;
  int rows, row_room;
  double *t, *weight, *direct; /* [rows], [rows * n], [np]: for lag_sim_gradient, and what is added to it */
  double *by_y, *by_p, *there; /* [n], [np]: slopes of a function; [n] scratch */
  double *moved;                  /* [n] scratch */
} MeasureGradient;

static void put_seed(MeasureGradient *g, Seed of) {
  if (g->n == MOST_SEEDS) g->refused = "it has too many values at times";
  else if (of.weight != 0.0) g->seed[g->n++] = of;
}

/* A value at time t, or at the event that happens there. */
static void seed_value(MeasureGradient *g, int node, double t, Happening at, double weight) {
  put_seed(g, (Seed){at.event < 0 ? VALUE : EVENT_VALUE, t, weight, node, at, .top = NULL});
}

static void seed_top(MeasureGradient *g, const Track *k, int least, double weight) {
  seed_value(g, k->arg, least ? k->when_least : k->when_most, least ? k->least_at : k->most_at, weight);
  if (k->kind != TRACK_DRIFT && g->n) g->seed[g->n - 1].top = k, g->seed[g->n - 1].value = least ? k->least : k->most;
}

static void seed_event(MeasureGradient *g, Happening at, double weight) {
  put_seed(g, (Seed){EVENT_TIME, NAN, weight, -1, at, .top = NULL});
}

/* The mean time between the first upward passage of 0 and the last. */
static void seed_period(MeasureGradient *g, const Track *k, double weight) {
  double part = weight / (k->passages - 1) * (k->latest < k->passage ? -1 : 1);
  for (int i = 0; i < 2 && k->passages > 1; i++) {
    Happening at = i ? k->latest_at : k->passage_at;
    double t = i ? k->latest : k->passage, factor = i ? part : -part;
    if (at.event < 0) put_seed(g, (Seed){PASSAGE, t, factor, k->arg, at, .top = NULL});
    else seed_event(g, at, factor);
  }
}

/* A mean, or a root of a mean square. */
static void seed_sum(MeasureGradient *g, const Track *k, double weight) {
  double value = g->m->node[k->node].result, dir = g->m->t < g->m->t0 ? -1 : 1;
  if (g->sums == MOST_SEEDS) g->refused = "it has too many means";
  else if (k->covered == 0.0) g->refused = "its window of time has no length";
  else if (k->kind == TRACK_RMS && value == 0.0) g->refused = "a root of 0 has no derivative";
  else g->sum[g->sums++] = (Sum){k, weight * dir / k->covered / (k->kind == TRACK_RMS ? value : 1), NAN, 0};
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
  const Happening none = {.event = -1};
  int falls = k->first - k->least > k->most - k->first;
  switch (k->kind) {
    case TRACK_MAX: seed_top(g, k, 0, weight); break;
    case TRACK_MIN: seed_top(g, k, 1, weight); break;
    case TRACK_DRIFT:
      seed_top(g, k, falls, falls ? -weight : weight);
      seed_value(g, k->arg, k->when_first, none, falls ? weight : -weight);
      break;
    case TRACK_PERIOD: seed_period(g, k, weight); break;
    case TRACK_MEAN: case TRACK_RMS: seed_sum(g, k, weight); break;
    case TRACK_KINDS: break;
  }
}

static void pass_back(MeasureGradient *g, int i) {
  Measures *m = g->m;
  const MeasureNode *n = &m->node[i];
  double x = g->adjoint[i];
  switch (n->kind) {
    case MEASURE_NUMBER: case MEASURE_FIRINGS: return;
    case MEASURE_END:
      if (g->ended.event >= 0) seed_event(g, g->ended, x);
      return;
    case MEASURE_QUANTITY: seed_value(g, i, m->t, g->ended, x); return;
    case MEASURE_AT:
      if (m->node[n->b].known != MEASURE_STATIC) g->refused = "the time of a value is itself a measure";
      seed_value(g, n->a, m->node[n->b].value, (Happening){.event = -1}, x);
      return;
    case MEASURE_TRACK: seed_track(g, &m->track[n->index], x); return;
    case MEASURE_TWO: g->adjoint[n->a] += x * slope(m, n, 0), g->adjoint[n->b] += x * slope(m, n, 1); return;
    case MEASURE_ONE: g->adjoint[n->a] += x * slope(m, n, 0); return;
    case MEASURE_HIT: seed_event(g, (Happening){n->index, (int)m->node[n->a].value, 0}, x); return;
    case MEASURE_LYAPUNOV: case MEASURE_MEGNO: g->refused = "exponents have no gradient"; return;
  }
}

/* Seeds at events have no time of their own, and stand anywhere. */
static int by_time(const void *a, const void *b) {
  const Seed *x = a, *y = b;
  double s = x->kind < EVENT_VALUE ? x->t : -HUGE_VAL, t = y->kind < EVENT_VALUE ? y->t : -HUGE_VAL;
  return (s > t) - (s < t);
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

/* ---- Slopes of functions */

static double value_of(MeasureGradient *g, Function of, double t, const double *y) {
  lag_sim *s = g->sim;
  if (of.later != 0.0) {
    if (lag_rhs(&s->pb, t, y, g->moved)) return NAN;
    for (int i = 0; i < s->pb.n; i++) g->moved[i] = y[i] + of.later * g->moved[i];
    return lag_measure_at(g->m, of.node, t + of.later, g->moved);
  }
  if (of.event < 0) return lag_measure_at(g->m, of.node, t, y);
  return lag_events_eval(s, t, y, s->g1) == LAG_OK ? s->g1[of.event] : NAN;
}

/* Whether a function contains parameters: an expression of states and t does not. */
static int feels_parameters(const Measures *m, Function of) {
  return of.event >= 0 || m->uses[QUANTITY_OUTPUT] || m->uses[QUANTITY_CHARGE] || m->uses[QUANTITY_PARAMETER] ||
         m->uses[QUANTITY_INPUT];
}

/* by_y[n], by_p[np] := derivatives at the state y[n]. */
static void find_slopes(MeasureGradient *g, Function of, double t, const double *y) {
  lag_sim *s = g->sim;
  const lag_parameter_columns *by = s->pb.by;
  int n = s->pb.n;
  memset(g->by_y, 0, (size_t)n * sizeof *g->by_y);
  memset(g->by_p, 0, (size_t)s->pb.model->np * sizeof *g->by_p);
  memcpy(g->there, y, (size_t)n * sizeof *y);
  for (int c = 0; c < n; c++) {
    double h = LAG_DIFFERENCE_PART * lag_difference_scale(&s->pb, y, c);
    LAG_EACH_DIFFERENCE(k) {
      g->there[c] = y[c] + k * h;
      g->by_y[c] += lag_difference_weight(k) * value_of(g, of, t, g->there) / h;
    }
    g->there[c] = y[c];
  }
  for (int j = 0; by && feels_parameters(g->m, of) && j < by->n; j++) {
    LAG_EACH_DIFFERENCE(k) {
      lag_use_parameters(s, j, k);
      g->by_p[j] += lag_difference_weight(k) * value_of(g, of, t, y) / by->h[j];
    }
    lag_use_parameters(s, 0, 0);
  }
}

/* The rate along the motion of a function whose slopes are known. */
static double rate_of(MeasureGradient *g, Function of, double t, const double *y) {
  lag_problem *pb = &g->sim->pb;
  double h = LAG_DIFFERENCE_PART * (pb->span > 0 ? pb->span : 1) / 64, rate = 0;
  if (lag_rhs(pb, t, y, g->there)) return NAN;
  for (int i = 0; i < pb->n; i++) rate += g->by_y[i] * g->there[i];
  LAG_EACH_DIFFERENCE(k) rate += lag_difference_weight(k) * value_of(g, of, t + k * h, y) / h;
  return rate;
}

/* ---- Rows of weights */

/* The measure changes by factor times the function at t whose slopes are known: a row, behind those up to t. */
static void put_row(MeasureGradient *g, double t, double factor) {
  enum { MOST = 1 << 26 }; /* numbers: 512 MiB */
  size_t n = (size_t)g->sim->pb.n;
  if (g->rows == g->row_room) {
    size_t room = 2 * (size_t)g->row_room + 64;
    double *at = room * (n + 1) < MOST ? realloc(g->t, room * sizeof *at) : NULL;
    g->t = at ? at : g->t;
    double *x = at ? realloc(g->weight, room * n * sizeof *x) : NULL;
    g->weight = x ? x : g->weight;
    g->no_memory |= !x;
    if (!x) return;
    g->row_room = (int)room;
  }
  int k = g->rows++;
  for (; k > 0 && (g->t[k - 1] - t) * g->sim->pb.dir > 0; k--) {
    g->t[k] = g->t[k - 1];
    memcpy(g->weight + (size_t)k * n, g->weight + (size_t)(k - 1) * n, n * sizeof *g->weight);
  }
  g->t[k] = t;
  for (size_t c = 0; c < n; c++) g->weight[(size_t)k * n + c] = factor * g->by_y[c];
  for (int j = 0; j < g->sim->pb.model->np; j++) g->direct[j] += factor * g->by_p[j];
}

/* The measure changes by factor times the time at which a function passes 0. */
static void put_time(MeasureGradient *g, Function of, double t, const double *y, double factor) {
  find_slopes(g, of, t, y);
  double rate = rate_of(g, of, t, y);
  if (factor != 0.0) put_row(g, t, -factor / rate);
}

/* ... or of an event; firing number k of a kick has the time t0 + k T. */
static void put_event_time(MeasureGradient *g, const Seen *e, double factor) {
  Function of = {-1, e->at.event, 0};
  lag_hold_swap(g->sim, g->hold);
  if (g->sim->pb.model->ev[of.event].direction != LAG_KICK) {
    put_time(g, of, e->t, e->y, factor);
  } else {
    find_slopes(g, of, e->t, e->y);
    put_row(g, e->t, factor * e->at.firing);
  }
  lag_hold_swap(g->sim, g->hold);
}

/* The value at an event: a row behind it is the next number behind its time. */
static void put_event_value(MeasureGradient *g, const Seen *e, const Seed *x) {
  int n = g->sim->pb.n;
  const double *y = x->at.after ? e->y + n : e->y;
  Function of = {x->node, -1, 0};
  if (!x->at.after) lag_hold_swap(g->sim, g->hold);
  find_slopes(g, of, e->t, y);
  put_row(g, x->at.after ? nextafter(e->t, g->sim->pb.dir * HUGE_VAL) : e->t, x->weight);
  double rate = rate_of(g, of, e->t, y);
  if (!x->at.after) lag_hold_swap(g->sim, g->hold);
  put_event_time(g, e, x->weight * rate);
}

static int is_same(Happening a, Happening b) { return a.event == b.event && a.firing == b.firing; }

/* Rows of a sum, which an event that comes later changes: the value before it counts longer, that after it shorter.
 * Where the event ends the run a mean loses its value. */
static void put_jump(MeasureGradient *g, const Seen *e, const Sum *sum) {
  const Track *k = sum->track;
  int squares = k->kind == TRACK_RMS;
  double before = lag_measure_at(g->m, k->arg, e->t, e->y),
         after = is_same(e->at, g->ended) ? g->m->node[k->node].result :
                                            lag_measure_at(g->m, k->arg, e->t, e->y + g->sim->pb.n),
         jump = squares ? (before * before - after * after) / 2 : before - after;
  if (lag_track_counts(k, e->t) && jump != 0.0) put_event_time(g, e, sum->factor * jump);
}

/* Rows of the events that have happened. */
static void put_events(MeasureGradient *g) {
  for (int i = 0; i < g->nseen; i++) {
    Seen *e = &g->seen[i];
    for (Seed *x = g->seed; x < g->seed + g->n; x++) {
      if (x->kind < EVENT_VALUE || x->done || !is_same(e->at, x->at)) continue;
      x->done = 1;
      if (x->kind == EVENT_VALUE) put_event_value(g, e, x);
      else put_event_time(g, e, x->weight);
    }
    for (int k = 0; k < g->sums; k++) put_jump(g, e, &g->sum[k]), g->sum[k].last = NAN;
    if (is_same(e->at, g->ended)) g->sums = 0;
    free(e->y);
  }
  g->nseen = 0;
}

static void note_event(void *context, int k, double t, const double *before, const double *after) {
  MeasureGradient *g = context;
  size_t n = (size_t)g->sim->pb.n;
  double *y = malloc(2 * n * sizeof *y);
  if (y && g->nseen == g->seen_room) {
    Seen *more = realloc(g->seen, (size_t)(g->seen_room = 2 * g->seen_room + 8) * sizeof *more);
    if (more) g->seen = more;
    else free(y), y = NULL;
  }
  g->no_memory |= !y;
  if (!y) return;
  memcpy(y, before, n * sizeof *y), memcpy(y + n, after, n * sizeof *y);
  g->seen[g->nseen++] = (Seen){{k, (int)++g->firings[k], 0}, t, y};
}

/* ---- The run */

/* Rows of the means over [a, b], a part of a step. */
static int put_places(MeasureGradient *g, double a, double b, double *y) {
  int rc = LAG_OK;
  for (int j = 0; j < lag_measure_places(g->m) && rc == LAG_OK; j++) {
    double weight, t = lag_measure_place(g->m, j, a, b, &weight);
    rc = lag_sim_advance(g->sim, t); /* the record knows the states at which it stops */
    rc = rc ? rc : lag_sim_eval(g->sim, t, y);
    for (const Sum *k = g->sum; k < g->sum + g->sums && rc == LAG_OK; k++) {
      if (!lag_track_counts(k->track, (a + b) / 2)) continue;
      double x = k->track->kind == TRACK_RMS ? lag_measure_at(g->m, k->track->arg, t, y) : 1;
      find_slopes(g, (Function){k->track->arg, -1, 0}, t, y);
      put_row(g, t, k->factor * weight * x);
    }
  }
  return rc;
}

/* Notes the sums' values at t. goes_on: they must be those noted last, at a switch, too, whose time no function here
 * gives. */
static void check_jumps(MeasureGradient *g, double t, int goes_on, double *y) {
  if (lag_sim_eval(g->sim, t, y)) return;
  for (Sum *k = g->sum; k < g->sum + g->sums; k++) {
    double x = lag_measure_at(g->m, k->track->arg, t, y);
    k->most = fmax(k->most, fabs(x));
    if (goes_on && fabs(x - k->last) > 1e-6 * k->most && lag_track_counts(k->track, t))
      g->refused = "a value jumps at a switch within the mean: make the value a state, S with flow S' = x, and take "
                   "S/t";
    k->last = x;
  }
}

/* Runs to t, which an event may prevent. y[n]: scratch. */
static int walk(MeasureGradient *g, double t, double *y) {
  lag_sim *s = g->sim;
  int rc = LAG_OK;
  while (rc == LAG_OK && lag_sim_time(s) != t && !g->no_memory && !g->refused) {
    double reach;
    memcpy(g->hold, s->hold, (size_t)(s->pb.model->nu + s->pb.model->nmodes) * sizeof *g->hold);
    rc = lag_sim_ensure_step(s, t, &reach);
    put_events(g);
    if (rc == LAG_OK && g->sums) check_jumps(g, lag_sim_time(s), 1, y);
    for (double a = lag_sim_time(s), b, last = 0; rc == LAG_OK && g->sums && a != reach; last = b - a, a = b) {
      b = lag_measure_smooth(g->m, a, lag_measure_part(g->m, a, reach), last);
      rc = put_places(g, a, b, y);
      check_jumps(g, b, fabs(b - a) < 0x1p-30 * fabs(reach - lag_sim_time(s)), y); /* so short: at a corner or a jump */
    }
    if (rc == LAG_OK) rc = lag_sim_advance(s, reach);
    if (rc == LAG_OK && g->sums) check_jumps(g, reach, 0, y);
  }
  return rc == LAG_STOPPED ? LAG_OK : rc;
}

/* Time from t, where the value is largest or smallest up to half of the digits, to where its rate is 0. */
static double time_to_rest(MeasureGradient *g, Function of, double t, const double *y) {
  const Run *r = g->sim->run;
  double later = (r->step_t1 - r->step_t0) / 256, rate, then, *f = g->moved;
  int n = g->sim->pb.n;
  find_slopes(g, of, t, y);
  rate = rate_of(g, of, t, y);
  double *beside = malloc((size_t)n * sizeof *beside);
  if (!beside || lag_rhs(&g->sim->pb, t, y, f)) return free(beside), 0;
  for (int i = 0; i < n; i++) beside[i] = y[i] + later * f[i];
  find_slopes(g, of, t + later, beside);
  then = rate_of(g, of, t + later, beside);
  free(beside);
  double rest = -rate * later / (then - rate);
  return fabs(rest) < fabs(later) ? rest : 0;
}

/* A row of a value at a fixed or stationary time, not at a switch, where a largest value may jump or have a corner. */
static void put_value(MeasureGradient *g, const Seed *x, const double *y) {
  Function of = {x->node, -1, 0};
  const Track *k = x->top;
  const Run *r = g->sim->run;
  int stands = k && x->t != k->when_first && x->t != g->end && x->t != k->from && x->t != k->to;
  of.later = stands ? time_to_rest(g, of, x->t, y) : 0;
  find_slopes(g, of, x->t, y);
  put_row(g, x->t, x->weight);
  of.later = 0;
  if (!stands) return;
  double size = k->most - k->least + 1e-6 * fabs(x->value), off = lag_measure_at(g->m, x->node, x->t, y) - x->value,
         way = rate_of(g, of, x->t, y) * (r->step_t1 - r->step_t0);
  if (fabs(off) > 1e-6 * size || fabs(way) > 1e-4 * size)
    g->refused = "its largest or smallest value is at a switch, where it jumps or has a corner";
}

static int is_done(const MeasureGradient *g) {
  int done = g->sums == 0;
  for (const Seed *x = g->seed; x < g->seed + g->n; x++) done &= x->done;
  return done;
}

/* Runs by way of the seeds at times, in their order, to the end, and a little further for an event there. */
static int run_through(MeasureGradient *g, double *y) {
  double end = g->end, beyond = end + (end - g->m->t0) / 1024;
  int rc = LAG_OK;
  for (Seed *x = g->seed; x < g->seed + g->n && rc == LAG_OK && !g->no_memory; x++) {
    if (x->kind >= EVENT_VALUE) continue;
    rc = walk(g, x->t, y);
    rc = rc ? rc : lag_sim_eval(g->sim, x->t, y);
    if (rc) break;
    x->done = 1;
    if (x->kind == PASSAGE) put_time(g, (Function){x->node, -1, 0}, x->t, y, x->weight);
    else put_value(g, x, y);
  }
  if (rc == LAG_OK && !is_done(g)) rc = walk(g, end, y);
  g->sums = g->ended.event < 0 ? 0 : g->sums;
  if (rc == LAG_OK && !is_done(g)) rc = walk(g, beyond, y);
  g->sums = 0;
  if (rc == LAG_OK && !is_done(g)) g->refused = "an event of it does not happen in the run of the gradient";
  return rc;
}

static int run_back(MeasureGradient *g, double *by_start, double *by_p, double *y) {
  lag_sim *s = g->sim;
  int rc = lag_sim_record(s);
  lag_sim_on_event(s, note_event, g);
  rc = rc ? rc : run_through(g, y);
  lag_sim_on_event(s, NULL, NULL);
  if (rc || g->refused) return rc;
  if (g->no_memory) return lag_fail(s, LAG_ENOMEM, "no memory for the rows of its means: end the run before");
  rc = lag_sim_gradient(s, g->rows, g->t, g->weight, by_start, by_p);
  for (int j = 0; j < s->pb.model->np && rc == LAG_OK; j++) by_p[j] += g->direct[j];
  return rc;
}

/* Room, and the seeds of measure k. */
static int begin(MeasureGradient *g, int k, double **room) {
  const lag_model *model = g->sim->pb.model;
  size_t n = (size_t)g->sim->pb.n, np = (size_t)model->np, nev = (size_t)model->nev;
  double *x = *room = calloc(4 * n + 2 * np + nev + (size_t)(model->nu + model->nmodes) + 1, sizeof *x);
  g->adjoint = calloc((size_t)g->m->nnodes + 1, sizeof *g->adjoint);
  if (isnan(g->m->node[g->m->root[k]].value)) g->refused = g->m->why[k];
  if (!x || !g->adjoint) return lag_fail(g->sim, LAG_ENOMEM, "out of memory");
  g->by_y = x + n, g->there = g->by_y + n, g->moved = g->there + n, g->by_p = g->moved + n, g->direct = g->by_p + np;
  g->firings = g->direct + np, g->hold = g->firings + nev;
  g->ended = g->m->status == LAG_STOPPED ? g->m->last : (Happening){.event = -1};
  g->t = malloc(sizeof *g->t), g->weight = malloc(n * sizeof *g->weight);
  if (!g->refused) collect_seeds(g, k, g->m->t < g->m->t0 ? -1 : 1);
  return LAG_OK;
}

int lag_measures_gradient(Measures *m, int k, lag_sim *sim, double *by_start, double *by_p, char *why, size_t size) {
  lag_sim *own = m->sim;
  double end = m->t, *y; /* evaluations at other times set it */
  MeasureGradient g = {.m = m, .sim = sim, .end = end};
  int rc = begin(&g, k, &y);
  m->sim = sim;
  if (rc == LAG_OK && !g.refused) rc = run_back(&g, by_start, by_p, y);
  m->sim = own;
  m->t = end;
  for (int i = 0; i < g.nseen; i++) free(g.seen[i].y);
  lag_free_all(g.adjoint, y, g.seen, g.t, g.weight);
  snprintf(why, size, "%s", g.refused ? g.refused : rc ? lag_sim_message(sim) : "");
  return g.refused || rc ? -1 : 0;
}
