/* The plan of `lagc cost`: which setting of which method is run next, and when to stop. Enters: methods, a
 * reference, a time to spend; leaves: runs with errors and times, and the Pareto front. Holds: each method is tried
 * at two coarse settings before it is judged; after that the shortest run that may lie near the front comes next, so
 * that the front is known from its cheap end on, whenever the time is up. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/work_precision.h"
#include "numeric/clock.h"

/* A method within the sweep. */
typedef struct MethodProgress {
  int next;           /* number of its next setting, from coarse to fine */
  int done;
  int idle;           /* settings in a row that took more steps and did not reduce the error */
  double least;       /* smallest error */
  long long steps;    /* of the last setting with a result */
  double tried;       /* processor time of the last setting [s], also of one without a result */
  double time, error; /* of the next setting, predicted */
} MethodProgress;

typedef struct Plan {
  CostSweep *s;
  MethodProgress *of; /* [s->n] */
  Samples own;
  double begin, worked; /* by the clock, and by the processor's [s] */
  int stopped;  /* 1: the caller ended the sweep */
} Plan;

/* Errors above this are no result. */
static const double rough = 0.3;
/* A setting predicted to take so many times as long as a known one that is as accurate lies behind the front. */
static const double behind = 3;

static double used(const Plan *p) { return lag_clock_seconds() - p->begin; }

/* Time by the clock for one of the processor: more than 1 beside other programs. */
static double slowness(const Plan *p) {
  double worked = lag_processor_seconds() - p->worked;
  return worked > 1e-3 ? fmax(used(p) / worked, 1) : 1;
}

static int is_adaptive(const CostMethod *m) { return (m->method->flags & LAG_METHOD_ADAPTIVE) != 0; }

/* Tolerance or step of setting k; 0: there is none so fine. */
static double knob_of(const Plan *p, const CostMethod *m, int k) {
  const Samples *r = p->s->reference;
  int rows = r->rows - (r->t[0] == p->s->scene.t0); /* without the start */
  double span = fabs(r->t[r->rows - 1] - p->s->scene.t0),
         knob = is_adaptive(m) ? pow(10, -2 - k) : span / ldexp(rows, k);
  return knob < (is_adaptive(m) ? 4.5 * DBL_EPSILON : 1e-12 * span) ? 0 : knob;
}

/* Time and error of the next setting, from the last two. */
static void predict(const CostMethod *m, MethodProgress *g) {
  double longer = is_adaptive(m) ? 1.5 : 2, smaller = 0.1;
  if (m->nruns > 1) {
    const CostRun *last = &m->run[m->nruns - 1], *before = last - 1;
    longer = is_adaptive(m) ? fmin(fmax(last->time / before->time, 1.1), 10) : 2;
    smaller = fmin(fmax(last->error / before->error, 1e-4), 0.9);
  }
  g->time = longer * g->tried;
  g->error = m->nruns ? smaller * m->run[m->nruns - 1].error : rough;
}

/* Time of the fastest run with at most this error, or at most the smallest error found: below it nothing is gained
 * but luck in rounding. */
static double front_time(const CostSweep *s, double error) {
  const CostRun *run;
  double least = fmax(error, lag_cost_smallest_error(s->method, s->n));
  return lag_cost_cheapest(s->method, s->n, least, &run) ? run->time : HUGE_VAL;
}

/* Number of the method whose setting is run next; -1: nothing is left that the time allows. */
static int choose(const Plan *p) {
  const CostSweep *s = p->s;
  double slow = slowness(p), left = 0.7 * s->seconds - used(p), least = HUGE_VAL;
  int which = -1, near = 0;
  for (int i = 0; i < s->n; i++) {
    const MethodProgress *g = &p->of[i];
    if (g->done) continue;
    int pilot = s->method[i].nruns < 2, front = pilot || g->time <= behind * front_time(s, g->error);
    if (slow * g->time > fmin(left, s->seconds * (pilot ? 0.05 : front ? 0.3 : 0.01))) continue;
    if (front > near || (front == near && g->time < least)) {
      which = i;
      near = front;
      least = g->time;
    }
  }
  return which;
}

/* Runs the next setting of method i. */
static int run_next(Plan *p, int i) {
  CostSweep *s = p->s;
  CostMethod *m = &s->method[i];
  MethodProgress *g = &p->of[i];
  CostRun run = {.knob = knob_of(p, m, g->next++)};
  /* errors that stop falling there do so for rounding; coarse ones may rise and fall by chance */
  const double fine = 1e-7;
  double longest = fmax(0.01, s->seconds * (m->nruns < 2 ? 0.1 : 0.5));
  if (run.knob == 0 || m->nruns == LAG_COST_MOST_RUNS - 2) {
    g->done = 1;
    return LAG_OK;
  }
  int rc = lag_cost_run(m, s, 2e-3, 5, longest, &p->own, &run);
  g->done = rc == LAG_EINVAL || rc == LAG_INTERRUPTED;
  if (rc == LAG_INTERRUPTED) m->left_out = g->error;
  g->tried = run.time;
  if (rc == LAG_OK && run.error < rough) {
    int gained = run.error < 0.7 * g->least, worked = (double)run.steps > 1.1 * (double)g->steps;
    g->idle = gained ? 0 : g->idle + worked;
    g->least = fmin(g->least, run.error);
    g->steps = run.steps;
    m->run[m->nruns++] = run;
    g->done = g->done || g->idle == (g->least < fine ? 2 : 6);
  }
  predict(m, g);
  return rc == LAG_ENOMEM ? rc : LAG_OK;
}

/* Methods that choose() passes over are left out from their next error on. */
static void note_left_out(Plan *p) {
  for (int i = 0; i < p->s->n; i++)
    if (!p->of[i].done) p->s->method[i].left_out = p->of[i].error;
}

static void insert_run(CostMethod *m, CostRun run) {
  int at = m->nruns++;
  while (at > 0 && m->run[at - 1].knob < run.knob) {
    m->run[at] = m->run[at - 1];
    at--;
  }
  m->run[at] = run;
}

/* A setting between two of *m's whose error is just below the target, if its neighbours lie on both sides. */
static int try_between(Plan *p, CostMethod *m) {
  const double share = 0.7;
  CostRun run = {0};
  for (int k = 1; k < m->nruns && m->nruns < LAG_COST_MOST_RUNS; k++) {
    const CostRun *a = &m->run[k - 1], *b = &m->run[k];
    if (!(a->error > p->s->target && b->error <= p->s->target && b->error < share * p->s->target)) continue;
    double part = log(share * p->s->target / b->error) / log(a->error / b->error);
    run.knob = b->knob * pow(a->knob / b->knob, part);
    int rc = lag_cost_run(m, p->s, 2e-3, 5, p->s->seconds, &p->own, &run);
    if (rc == LAG_OK) insert_run(m, run);
    return rc == LAG_ENOMEM ? rc : LAG_OK;
  }
  return LAG_OK;
}

/* Of methods whose fastest run within the target takes at most twice as long as the fastest of all, settings closer
 * to the target. */
static int refine_target(Plan *p) {
  CostSweep *s = p->s;
  const CostRun *own;
  double least = front_time(s, s->target);
  int rc = LAG_OK;
  for (int i = 0; i < s->n && rc == LAG_OK && s->target > 0 && used(p) < 0.9 * s->seconds; i++)
    if (lag_cost_cheapest(&s->method[i], 1, s->target, &own) && own->time <= 2 * least)
      rc = try_between(p, &s->method[i]);
  return rc;
}

/* Times again what the front is made of, and what may be: its first times come from few repeats. */
static int repeat_front(Plan *p) {
  CostSweep *s = p->s;
  const double close = 1.3, enough = 0.05;
  int rc = LAG_OK;
  for (int i = 0; i < s->n; i++)
    for (int k = 0; k < s->method[i].nruns && rc == LAG_OK && !p->stopped; k++) {
      CostRun *run = &s->method[i].run[k], again = *run;
      if (run->time > close * front_time(s, run->error) || used(p) + 3 * slowness(p) * run->time > s->seconds) continue;
      p->stopped = s->note && s->note(s->context, &s->method[i], used(p) / s->seconds);
      rc = lag_cost_run(&s->method[i], s, fmax(enough, 3 * run->time), run->time > enough ? 3 : 41, HUGE_VAL, &p->own,
                        &again);
      if (rc == LAG_OK) *run = again;
      else if (rc != LAG_ENOMEM) rc = LAG_OK;
    }
  return rc;
}

int lag_cost_sweep(CostSweep *s) {
  Plan p = {.s = s, .of = calloc((size_t)s->n + 1, sizeof *p.of), .begin = lag_clock_seconds(),
            .worked = lag_processor_seconds()};
  int rc = lag_samples_init(&p.own, s->reference->rows, s->reference->n), i;
  p.own.output = s->reference->output;
  s->end = p.begin + s->seconds;
  if (rc == LAG_OK) memcpy(p.own.t, s->reference->t, (size_t)s->reference->rows * sizeof *p.own.t);
  if (!p.of) rc = LAG_ENOMEM;
  for (i = 0; i < s->n && rc == LAG_OK; i++) {
    p.of[i] = (MethodProgress){.least = HUGE_VAL, .error = rough};
    s->method[i].nruns = 0;
    s->method[i].why[0] = '\0';
    s->method[i].left_out = 0;
  }
  while (rc == LAG_OK && !p.stopped && (i = choose(&p)) >= 0) {
    p.stopped = s->note && s->note(s->context, &s->method[i], used(&p) / s->seconds);
    if (!p.stopped) rc = run_next(&p, i);
  }
  if (rc == LAG_OK) note_left_out(&p);
  if (rc == LAG_OK && !p.stopped) rc = refine_target(&p);
  if (rc == LAG_OK && !p.stopped) rc = repeat_front(&p);
  for (i = 0; i < s->n; i++) s->method[i].order = lag_cost_order(&s->method[i], s->reference->uncertainty);
  lag_pareto_front(s->method, s->n);
  lag_samples_free(&p.own);
  free(p.of);
  return rc;
}
