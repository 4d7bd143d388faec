/* Measures of a run. Enters: a run, part by part; leaves: the value of each expression. Holds: the run does not
 * depend on it.
 *
 * Each part of the run, a step or what an event leaves of it, is sampled at equal times by dense output: at a few of
 * them, and at the rest where the few leave room for a larger value or a zero. Where the parabola through three
 * samples has its top between two of them, the top is found by golden section (R.P. Brent, Algorithms for
 * Minimization without Derivatives, 1973, ch. 5); where samples change their sign, the zero by kernels/locate.h.
 * Integrals are sums of quadratures over the parts, by the nodes that balances of charges take
 * (core/charge_monitor.c): of the order of the method, so that the error of a mean falls with the step as that of
 * the motion does; in methods of long steps, Taylor's, over halves of halves of them. Both sides of a jump count. A
 * drift, with equal steps, is that of the ends of steps. */
#include "analysis/measure.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/measure_nodes.h"
#include "core/core.h"
#include "kernels/compensated_sum.h"
#include "kernels/locate.h"
#include "numeric/release.h"

/* ---- Memory */

static int allocate(Measures *m) {
  const lag_model *model = m->scene->model;
  size_t n = 2 * (size_t)model->nq + (size_t)model->nz, samples = (size_t)m->ntracks * (MEASURE_SAMPLES + 1);
  m->y = calloc(n + (size_t)m->scene->nout + (size_t)model->nev + samples + 1, sizeof *m->y);
  if (!m->y) return LAG_ENOMEM;
  m->out = m->y + n;
  m->firings = m->out + m->scene->nout;
  m->sampled = m->firings + model->nev;
  return LAG_OK;
}

Measures *lag_measures_new(const lag_scene *scene, int n, const char *const *text, const MeasureDialect *dialect,
                           char *why, size_t size) {
  Measures *m = calloc(1, sizeof *m);
  size_t count = n > 0 ? (size_t)n : 1;
  snprintf(why, size, "out of memory");
  if (!m) return NULL;
  *m = (Measures){.scene = scene, .n = n, .dialect = dialect ? *dialect : (MeasureDialect){0}};
  m->root = calloc(count, sizeof *m->root);
  m->unit = calloc(count, sizeof *m->unit);
  m->why = calloc(count, sizeof *m->why);
  int rc = m->root && m->unit && m->why ? 0 : -1;
  for (int k = 0; k < n && rc == 0; k++) rc = lag_measure_read(m, k, text[k], why, size);
  if (rc == 0 && allocate(m) == LAG_OK) return why[0] = '\0', m;
  lag_measures_free(m);
  return NULL;
}

void lag_measures_free(Measures *m) {
  if (!m) return;
  lag_free_all(m->root, m->unit, m->why, m->node, m->track, m->y, m);
}

int lag_measures_count(const Measures *m) { return m->n; }

const char *lag_measures_unit(const Measures *m, int k) { return m->unit[k].text; }

const char *lag_measures_why(const Measures *m, int k) { return m->why[k]; }

/* ---- Evaluation */

/* out and charges at t and the state m->y, unless there is none. */
static void take_state(Measures *m, double t, int rc) {
  lag_sim *s = m->sim;
  m->t = t;
  for (int i = 0; i < s->pb.n && rc; i++) m->y[i] = NAN;
  if (m->uses[QUANTITY_OUTPUT] && (rc || lag_observe(s, t, m->y, m->out)))
    for (int i = 0; i < m->scene->nout; i++) m->out[i] = NAN;
  if (m->uses[QUANTITY_CHARGE]) lag_charges_at(s, t, m->y);
  if (m->uses[QUANTITY_INPUT]) lag_inputs(&s->pb, t);
}

/* The same within the present part of the run. */
static void take_row(Measures *m, double t) {
  double calls = m->sim->pb.rhs_calls; /* of the run: dense output may take more */
  int rc = lag_sim_eval(m->sim, t, m->y);
  m->sim->pb.rhs_calls = calls;
  take_state(m, t, rc);
}

/* A quantity in the row taken last. */
static double quantity(const Measures *m, const MeasureNode *n) {
  switch (n->of) {
    case QUANTITY_TIME: return m->t;
    case QUANTITY_STATE: return m->y[n->index];
    case QUANTITY_OUTPUT: return m->out[n->index];
    case QUANTITY_CHARGE: return m->sim->charge_now[2 * n->index];
    case QUANTITY_PARAMETER: return m->sim->p[n->index];
    case QUANTITY_INPUT: return m->sim->u[n->index];
    case QUANTITY_KINDS: break;
  }
  return NAN;
}

/* The expression of node `root` at the row taken last. */
static double evaluate(Measures *m, int root) {
  for (int i = m->node[root].begin; i <= root; i++) {
    MeasureNode *n = &m->node[i];
    if (n->kind == MEASURE_QUANTITY) n->value = quantity(m, n);
    else if (n->kind == MEASURE_ONE) n->value = n->one(m->node[n->a].value);
    else if (n->kind == MEASURE_TWO) n->value = n->two(m->node[n->a].value, m->node[n->b].value);
    else n->value = n->result;
  }
  return m->node[root].value;
}

double lag_measure_at(Measures *m, int node, double t, const double *y) {
  memcpy(m->y, y, (size_t)m->sim->pb.n * sizeof *y);
  take_state(m, t, 0);
  return evaluate(m, node);
}

/* ---- Along a part of the run */

typedef struct Followed {
  Measures *m;
  int node;
  double sign;
} Followed;

static double value_at(void *context, double t) {
  const Followed *f = context;
  take_row(f->m, t);
  return f->sign * evaluate(f->m, f->node);
}

/* The event after which time t begins. */
static Happening event_before(const Measures *m, double t) {
  return t == m->last_time ? m->last : (Happening){.event = -1};
}

static void note(const Measures *m, Track *k, double t, double x) {
  if (!isfinite(x) && isnan(k->bad)) k->bad = t;
  if (!(x >= k->least)) k->when_least = t, k->least_at = event_before(m, t);
  if (!(x <= k->most)) k->when_most = t, k->most_at = event_before(m, t);
  k->least = fmin(k->least, x);
  k->most = fmax(k->most, x);
}

/* The largest value of f in [a, b], where it has one top, at *when. */
static double top(Followed *f, double a, double b, double *when) {
  const double golden = 0.6180339887498948482045868343656381177203, last = 1e-8 * fabs(b - a);
  double c = b - golden * (b - a), d = a + golden * (b - a), fc = value_at(f, c), fd = value_at(f, d);
  for (int i = 0; i < 60 && fabs(b - a) > last; i++) {
    if (fc > fd) b = d, d = c, fd = fc, c = b - golden * (b - a), fc = value_at(f, c);
    else a = c, c = d, fc = fd, d = a + golden * (b - a), fd = value_at(f, d);
  }
  *when = fc > fd ? c : d;
  return fmax(fc, fd);
}

/* Tops of sign*x[n + 1], samples at t[n + 1], that may exceed those known. */
static void find_tops(Measures *m, Track *track, double sign, int n, const double *t, const double *x) {
  const double beyond = 1.25; /* the parabola's top may be off by a quarter of an interval */
  Followed f = {m, track->arg, sign};
  for (int k = 1; k < n; k++) {
    double a = sign * x[k - 1], b = sign * x[k], c = sign * x[k + 1], bend = a - 2 * b + c,
           place = (a - c) / (2 * bend), rise = (a - c) * place / 4;
    double best = sign > 0 ? track->most : -track->least, here = fmax(fmax(a, b), c);
    if (!(bend < 0) || !(fabs(place) <= beyond) || (place < -0.5 && k > 1) || (place > 0.5 && k < n - 1)) continue;
    double gain = b - rise - here;
    if (here + 2 * fmax(gain, 0) - 0.125 * bend <= best || fabs(bend) <= 8 * DBL_EPSILON * fabs(here)) continue;
    double when, most = top(&f, t[k - 1], t[k + 1], &when);
    note(m, track, when, sign * most);
  }
}

static void find_passages(Measures *m, Track *track, int n, const double *t, const double *x) {
  Followed f = {m, track->arg, 1};
  for (int k = -1; k < n; k++) {
    double before = k < 0 ? track->last : x[k];
    if (!(before < 0 && x[k + 1] >= 0)) continue;
    track->latest = k < 0 || x[k + 1] == 0.0 ? t[k + 1] :
                    lag_root(value_at, &f, t[k], before, t[k + 1], x[k + 1], DBL_EPSILON);
    track->latest_at = k < 0 ? event_before(m, t[0]) : (Happening){.event = -1};
    if (!track->passages++) track->passage = track->latest, track->passage_at = track->latest_at;
  }
}

/* Follows a track through samples x[n + 1] at t[n + 1]; n = 0: the two sides of a jump. */
static void follow(Measures *m, Track *track, int n, const double *t, const double *x) {
  for (int k = 0; k <= n; k++) note(m, track, t[k], x[k]);
  if (track->how & HIGHEST) find_tops(m, track, 1, n, t, x);
  if (track->how & LOWEST) find_tops(m, track, -1, n, t, x);
  if (track->how & PASSAGES) find_passages(m, track, n, t, x);
  track->last = x[n];
}

/* Parts of a step that are sampled, and for quadrature: methods of high order take long steps. */
static int places(const lag_method *method) {
  return method->flags & LAG_METHOD_TAYLOR ? MEASURE_SAMPLES
         : method->order >= 6              ? MEASURE_SAMPLES / 2
                                           : MEASURE_SAMPLES / 4;
}

/* Whether sign*x may exceed `best` and all of its samples x[n + 1] between two of them, which are closer to each
 * other than the bend of x. */
static int may_have_top(double sign, double best, double bend, int n, const double *x) {
  for (int k = 0; k <= n; k++) best = fmax(best, sign * x[k]);
  for (int k = 0; k < n; k++)
    if (!(fabs(x[k + 1] - x[k]) > bend) && !(fmax(sign * x[k], sign * x[k + 1]) + bend <= best)) return 1;
  return 0;
}

/* Whether some of x[n + 1] is not on one side of 0, by more than its bend. */
static int may_pass(double bend, int n, const double *x) {
  for (int k = 0; k < n; k++)
    if (!(fmin(x[k], x[k + 1]) > bend) && !(fmax(x[k], x[k + 1]) < -bend)) return 1;
  return 0;
}

/* Whether samples between these x[n + 1] may tell more. The bend is 16 times the way of a parabola from its chord. */
static int needs_more(const Track *track, int n, const double *x) {
  double bend = 0;
  for (int k = 1; k < n; k++) bend = fmax(bend, 2 * fabs(x[k - 1] - 2 * x[k] + x[k + 1]));
  return (track->how & HIGHEST && may_have_top(1, track->most, bend, n, x)) ||
         (track->how & LOWEST && may_have_top(-1, -track->least, bend, n, x)) ||
         (track->how & PASSAGES && may_pass(bend, n, x));
}

/* Samples number first, first + stride, ... n of [a, b]: t[k] and the values of each track there. */
static void take_samples(Measures *m, double a, double b, int n, int first, int stride, double *t) {
  for (int k = first; k <= n; k += stride) {
    t[k] = k == n ? b : a + k * (b - a) / n;
    take_row(m, t[k]);
    for (int i = 0; i < m->ntracks; i++)
      if (m->track[i].how != INTEGRATED && m->track[i].active)
        m->sampled[i * (MEASURE_SAMPLES + 1) + k] = evaluate(m, m->track[i].arg);
  }
}

/* Whether a track is followed at ends of steps alone, where the method computes: a drift, with equal steps. Between
 * them is an interpolation, with errors of its own. */
static int is_at_ends(const Measures *m, const Track *k) { return k->kind == TRACK_DRIFT && m->sim->steps_equal; }

/* Notes a value at t if a step begins or ends there. */
static void note_end(const Measures *m, Track *k, double t, double x) {
  const Run *r = m->sim->run;
  if (r->have_step == 0.0 || t == r->step_t0 || t == r->step_t1) note(m, k, t, x);
}

/* Follows the tracks over [a, b]: by a few samples, and by all where these leave anything open. */
static void sample(Measures *m, double a, double b) {
  enum { FEW = MEASURE_SAMPLES / 4 };
  int n = a == b ? 0 : places(m->sim->method), stride = n > FEW ? n / FEW : 1, more = 0;
  double t[MEASURE_SAMPLES + 1], few[FEW + 1];
  take_samples(m, a, b, n, 0, stride, t);
  for (int i = 0; i < m->ntracks && stride > 1 && !more; i++) {
    if (!m->track[i].active) continue;
    for (int k = 0; k <= FEW; k++) few[k] = m->sampled[i * (MEASURE_SAMPLES + 1) + k * stride];
    more = m->track[i].how != INTEGRATED && !is_at_ends(m, &m->track[i]) && needs_more(&m->track[i], FEW, few);
  }
  for (int first = 1; more && first < stride; first++) take_samples(m, a, b, n, first, stride, t);
  if (more) stride = 1;
  for (int k = 0; k * stride <= n; k++) t[k] = t[k * stride];
  for (int i = 0; i < m->ntracks; i++) {
    double *x = m->sampled + i * (MEASURE_SAMPLES + 1);
    for (int k = 0; k * stride <= n; k++) x[k] = x[k * stride];
    if (m->track[i].how == INTEGRATED || !m->track[i].active) continue;
    if (!is_at_ends(m, &m->track[i])) follow(m, &m->track[i], n / stride, t, x);
    else note_end(m, &m->track[i], a, x[0]), note_end(m, &m->track[i], b, x[n / stride]);
  }
}

static int equal_parts(const lag_sim *s) { return s->method->flags & LAG_METHOD_TAYLOR ? 4 : 1; }

int lag_measure_places(const Measures *m) {
  lag_charges_nodes(m->sim);
  return equal_parts(m->sim) * m->sim->nodes;
}

double lag_measure_place(const Measures *m, int j, double a, double b, double *weight) {
  const lag_sim *s = m->sim;
  double h = (b - a) / equal_parts(s);
  *weight = s->weight[j % s->nodes] * h;
  return a + (j / s->nodes + s->node[j % s->nodes]) * h;
}

/* Whether a track has no corner or jump in [a, b], as abs(x) has: the last two of its nine Chebyshev coefficients are
 * 1e-8 of the largest, or rounding. So a corner is cut off up to 1e-8 of a part, as mean values' gradients need it. */
static int is_smooth(Measures *m, Track *k, double a, double b) {
  enum { LAST = 8 };
  const double pi = 3.14159265358979323846, small = 1e-8, rounding = 1e-13;
  double x[LAST + 1], largest = 0, end = 0;
  for (int j = 0; j <= LAST; j++) {
    take_row(m, j == 0 ? b : j == LAST ? a : a + (b - a) * (0.5 + 0.5 * cos(pi * j / LAST)));
    x[j] = evaluate(m, k->arg);
    k->size = fmax(k->size, fabs(x[j]));
  }
  for (int c = 1; c <= LAST; c++) {
    double sum = 0;
    for (int j = 0; j <= LAST; j++) sum += x[j] * cos(pi * j * c / LAST) * (j % LAST ? 1 : 0.5);
    sum = fabs(sum) * 2 / LAST;
    largest = fmax(largest, sum);
    if (c >= LAST - 1) end = fmax(end, sum);
  }
  return !(end > fmax(small * largest, rounding * k->size));
}

double lag_measure_smooth(Measures *m, double a, double reach, double last) {
  double least = fmax(fabs(m->sim->run->step_t1 - m->sim->run->step_t0) * 0x1p-33, 64 * DBL_EPSILON * fabs(reach));
  double b = last != 0.0 && fabs(2 * last) < fabs(reach - a) ? a + 2 * last : reach;
  for (int i = 0; i < m->ntracks && fabs(b - a) > least; i++)
    while (m->track[i].how == INTEGRATED && lag_track_counts(&m->track[i], a + (b - a) / 2) && fabs(b - a) > least &&
           !is_smooth(m, &m->track[i], a, b))
      b = a + (b - a) / 2;
  return b;
}

/* Adds the integrals over [a, b]. */
static void integrate_part(Measures *m, double a, double b) {
  for (int j = 0, n = lag_measure_places(m); j < n; j++) {
    double weight, t = lag_measure_place(m, j, a, b, &weight);
    take_row(m, t);
    for (Track *k = m->track; k < m->track + m->ntracks; k++) {
      if (k->how != INTEGRATED || !k->active) continue;
      double x = evaluate(m, k->arg);
      if (!isfinite(x) && isnan(k->bad)) k->bad = t;
      k->sum = lag_compensated_sum(k->sum, weight * (k->kind == TRACK_RMS ? x * x : x), &k->lost);
    }
  }
}

static void integrate(Measures *m, double a, double b) {
  for (double last = 0, to; a != b; last = to - a, a = to)
    to = lag_measure_smooth(m, a, b, last), integrate_part(m, a, to);
}

/* ---- The run */

static void note_event(void *context, int k, double t, const double *before, const double *after) {
  Measures *m = context;
  m->firings[k]++;
  for (Track *x = m->track; x < m->track + m->ntracks; x++) {
    Happening here = {k, (int)m->firings[k], 0};
    if (x->when_least == t && x->least_at.event < 0) x->least_at = here;
    if (x->when_most == t && x->most_at.event < 0) x->most_at = here;
  }
  m->last = (Happening){k, (int)m->firings[k], 1};
  m->last_time = t;
  for (MeasureNode *n = m->node; n < m->node + m->nnodes; n++)
    if (n->kind == MEASURE_HIT && n->index == k && m->node[n->a].value == m->firings[k]) n->result = t;
  if (m->on_event) m->on_event(m->on_event_context, k, t, before, after);
}

int lag_measures_follow(const Measures *m) { return m->ntracks > 0; }

double lag_measure_part(const Measures *m, double a, double reach) {
  double dir = reach < a ? -1 : 1;
  for (const Track *k = m->track; k < m->track + m->ntracks; k++)
    for (int end = 0; end < 2; end++) {
      double edge = end ? k->to : k->from;
      if ((edge - a) * dir > 0 && (reach - edge) * dir > 0) reach = edge;
    }
  return reach;
}

/* Begins a track with its value in the row taken last, at t. */
static void begin_track(Measures *m, Track *k, double t) {
  k->first = k->last = k->least = k->most = evaluate(m, k->arg);
  k->when_first = k->when_least = k->when_most = t;
  k->least_at = k->most_at = event_before(m, t);
  k->bad = isfinite(k->first) ? NAN : t;
  k->begun = 1;
}

/* Which tracks count in [a, b]; those that do for the first time begin at a. */
static void enter_windows(Measures *m, double a, double b) {
  int fresh = 0;
  for (Track *k = m->track; k < m->track + m->ntracks; k++) {
    k->active = lag_track_counts(k, (a + b) / 2);
    k->covered += k->active ? fabs(b - a) : 0;
    fresh |= k->active && !k->begun;
  }
  if (fresh) take_row(m, a);
  for (Track *k = m->track; k < m->track + m->ntracks && fresh; k++)
    if (k->active && !k->begun) begin_track(m, k, a);
}

static int follow_to(Measures *m, double t) {
  lag_sim *s = m->sim;
  int rc = LAG_OK;
  while (rc == 0 && m->ntracks && lag_sim_time(s) != t) {
    double reach;
    rc = lag_sim_ensure_step(s, t, &reach);
    double from = lag_sim_time(s); /* behind the jump of a table, where there is one */
    for (double a = from, b; rc == 0 && a != reach; a = b) {
      b = lag_measure_part(m, a, reach);
      enter_windows(m, a, b);
      if (m->samples) sample(m, a, b);
      if (m->integrates) integrate(m, a, b);
    }
    if (rc == 0 && reach != from) rc = lag_sim_advance(s, reach);
  }
  return rc ? rc : lag_sim_advance(s, t);
}

/* The values at times that are known after run `known`, which lie not before the present time: records those that
 * are now. Returns the node that is next in the direction to `until`, or NULL. */
static MeasureNode *next_time(Measures *m, int known, double until) {
  double now = lag_sim_time(m->sim), dir = until < now ? -1 : 1;
  MeasureNode *next = NULL;
  for (MeasureNode *n = m->node; n < m->node + m->nnodes; n++) {
    if (n->kind != MEASURE_AT || n->known != known || n->taken) continue;
    double t = m->node[n->b].value;
    if (t == now) {
      take_row(m, t);
      n->result = evaluate(m, n->a);
      n->taken = 1;
    } else if ((t - now) * dir > 0 && (until - t) * dir >= 0 && (!next || (m->node[next->b].value - t) * dir > 0)) {
      next = n;
    }
  }
  return next;
}

static void take_times(Measures *m, int known) {
  for (MeasureNode *n = m->node; n < m->node + m->nnodes; n++)
    if ((n->kind == MEASURE_AT && n->known == known && !n->taken) || (n->kind == MEASURE_HIT && known == 0))
      evaluate(m, n->kind == MEASURE_AT ? n->b : n->a);
}

int lag_measures_begin(Measures *m, lag_sim *sim) {
  for (const MeasureNode *n = m->node; n < m->node + m->nnodes; n++)
    if ((n->kind == MEASURE_HIT || n->kind == MEASURE_FIRINGS) && !lag_event_is_located(sim, n->index))
      return lag_fail(sim, LAG_EMETHOD,
                      "%s does not locate events of contacts, as %s is one; dop853 does, and an event of your own, as "
                      "`event low: y - 1 falling`, is located by both",
                      sim->method->name, sim->scene->model->ev[n->index].name);
  int rc = lag_sim_advance(sim, lag_sim_time(sim)); /* only then is there a state */
  if (rc < 0) return rc;
  m->sim = sim;
  m->on_event = sim->on_event;
  m->on_event_context = sim->on_event_context;
  lag_sim_on_event(sim, note_event, m);
  m->t0 = lag_sim_time(sim);
  m->status = rc;
  m->last_time = NAN;
  memset(m->firings, 0, (size_t)m->scene->model->nev * sizeof *m->firings);
  for (MeasureNode *n = m->node; n < m->node + m->nnodes; n++)
    if (n->kind != MEASURE_NUMBER) n->result = NAN, n->taken = 0;
  take_row(m, m->t0);
  for (Track *k = m->track; k < m->track + m->ntracks; k++) {
    k->sum = k->lost = k->covered = 0;
    k->passages = k->begun = 0;
    k->first = k->last = k->least = k->most = k->bad = NAN;
    k->active = !(m->t0 < k->from) && !(m->t0 > k->to);
    if (k->active) begin_track(m, k, m->t0);
  }
  take_times(m, 0);
  next_time(m, 0, m->t0);
  return rc;
}

/* Advances to t by way of the times of run `known`. */
static int advance(Measures *m, int known, double t) {
  int rc = LAG_OK;
  for (MeasureNode *n; rc == 0 && (n = next_time(m, known, t));) rc = follow_to(m, m->node[n->b].value);
  rc = rc ? rc : follow_to(m, t);
  if (rc == 0) next_time(m, known, t);
  return rc;
}

int lag_measures_advance(Measures *m, double t) { return m->status = advance(m, 0, t); }

/* ---- Its end */

static double track_value(const Measures *m, const Track *k) {
  if (!isnan(k->bad) || !k->begun) return NAN;
  switch (k->kind) {
    case TRACK_MAX: return k->most;
    case TRACK_MIN: return k->least;
    case TRACK_DRIFT: return fmax(k->most - k->first, k->first - k->least);
    case TRACK_PERIOD: return k->passages > 1 ? fabs(k->latest - k->passage) / (k->passages - 1) : NAN;
    case TRACK_MEAN: return k->covered == 0.0 ? k->first : copysign(1, m->t - m->t0) * k->sum / k->covered;
    case TRACK_RMS: return k->covered == 0.0 ? fabs(k->first) : sqrt(fabs(k->sum) / k->covered);
    case TRACK_KINDS: break;
  }
  return NAN;
}

/* Values at times that are themselves measures, and with past_end those after the end, in runs of their own. */
static int run_again(Measures *m, lag_sim *sim, double end) {
  int last = 0, rc = LAG_OK;
  for (const MeasureNode *n = m->node; n < m->node + m->nnodes; n++)
    last = n->kind == MEASURE_AT && n->known > last ? n->known : last;
  for (int known = m->dialect.past_end ? 0 : 1; known <= last && rc != LAG_ENOMEM; known++) {
    double until = end;
    int some = 0;
    take_row(m, end);
    take_times(m, known);
    for (const MeasureNode *n = m->node; n < m->node + m->nnodes; n++) {
      if (n->kind != MEASURE_AT || n->known != known || n->taken) continue;
      some = 1;
      double t = m->node[n->b].value;
      if (m->dialect.past_end && fabs(t - m->t0) > fabs(until - m->t0)) until = t;
    }
    if (!some) continue;
    lag_sim *again = lag_sim_like(sim);
    if (!again) return LAG_ENOMEM;
    m->sim = again;
    int tracks = m->ntracks;
    m->ntracks = 0; /* they are known */
    rc = lag_sim_advance(again, lag_sim_time(again));
    if (rc == 0) advance(m, known, until);
    m->ntracks = tracks;
    m->sim = sim;
    lag_sim_free(again);
  }
  return rc == LAG_ENOMEM ? rc : LAG_OK;
}

/* why[k] of a value that is NaN: the first part of it that is not known. */
static void explain(Measures *m, int k, double end) {
  char *why = m->why[k];
  size_t size = sizeof m->why[k];
  snprintf(why, size, "no number: 0/0, or a function of a number outside its domain");
  for (int i = m->node[m->root[k]].begin; i <= m->root[k]; i++) {
    const MeasureNode *n = &m->node[i];
    if (n->kind == MEASURE_TRACK && isnan(n->result)) {
      const Track *track = &m->track[n->index];
      if (!track->begun)
        snprintf(why, size, "the run ends at t = %s s, before the window of time begins", LAG_TEXT(end));
      else if (!isnan(track->bad)) snprintf(why, size, "it has no value at t = %s s", LAG_TEXT(track->bad));
      else snprintf(why, size, "no period: it passes 0 upwards %s", track->passages ? "once" : "never");
      return;
    } else if ((n->kind == MEASURE_LYAPUNOV || n->kind == MEASURE_MEGNO) && isnan(n->result)) {
      snprintf(why, size, "%s", m->no_exponent);
      return;
    } else if (n->kind == MEASURE_HIT && isnan(n->result)) {
      double times = m->firings[n->index];
      if (times == 0.0) snprintf(why, size, "%s never happens", m->scene->model->ev[n->index].name);
      else
        snprintf(why, size, "%s happens %s time%s", m->scene->model->ev[n->index].name, LAG_TEXT(times),
                 times == 1 ? "" : "s");
      return;
    } else if (n->kind == MEASURE_AT && isnan(n->result) && !isnan(m->node[n->b].value)) {
      double t = m->node[n->b].value, dir = end < m->t0 ? -1 : 1;
      if ((t - end) * dir > 0) snprintf(why, size, "the run ends at t = %s s, before %s s", LAG_TEXT(end), LAG_TEXT(t));
      else if ((t - m->t0) * dir < 0)
        snprintf(why, size, "the run begins at t = %s s, after %s s", LAG_TEXT(m->t0), LAG_TEXT(t));
      else snprintf(why, size, "it has no value at t = %s s", LAG_TEXT(t));
      return;
    }
  }
}

int lag_measures_end(Measures *m, double *value) {
  lag_sim *sim = m->sim;
  double end = lag_sim_time(sim);
  lag_sim_on_event(sim, m->on_event, m->on_event_context);
  enter_windows(m, end, end);
  if (m->samples) sample(m, end, end); /* what a last event has changed */
  double exponent = m->exponent ? lag_measure_lyapunov(m, sim, end, MEASURE_LYAPUNOV) : NAN;
  double megno = m->megno ? lag_measure_lyapunov(m, sim, end, MEASURE_MEGNO) : NAN;
  m->t = end;
  for (const Track *k = m->track; k < m->track + m->ntracks; k++) m->node[k->node].result = track_value(m, k);
  for (MeasureNode *n = m->node; n < m->node + m->nnodes; n++) {
    if (n->kind == MEASURE_END) n->result = end;
    if (n->kind == MEASURE_FIRINGS) n->result = m->firings[n->index];
    if (n->kind == MEASURE_LYAPUNOV) n->result = exponent;
    if (n->kind == MEASURE_MEGNO) n->result = megno;
  }
  take_row(m, end);
  for (int k = 0; k < m->n; k++) evaluate(m, m->root[k]);
  int rc = run_again(m, sim, end);
  take_row(m, end);
  for (int k = 0; k < m->n; k++) {
    const MeasureUnit *u = &m->unit[k];
    double x = evaluate(m, m->root[k]);
    value[k] = (x - u->offset) / u->factor;
    m->why[k][0] = '\0';
    if (isnan(x)) explain(m, k, end);
  }
  return rc;
}

int lag_measures_run(Measures *m, lag_sim *sim, double until, double *value) {
  int rc = lag_measures_begin(m, sim);
  for (int k = 0; k < m->n && rc < 0; k++) {
    value[k] = NAN;
    snprintf(m->why[k], sizeof m->why[k], "%s", lag_sim_message(sim));
  }
  if (rc < 0) return rc;
  rc = lag_measures_advance(m, until);
  return lag_measures_end(m, value) == LAG_OK ? rc : LAG_ENOMEM;
}
