/* Work-precision diagrams; the method and its source: Hairer, Norsett, Wanner, Solving Ordinary Differential
 * Equations I (1993), DOI 10.1007/978-3-540-78862-1, II.10. */
#include "analysis/work_precision.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "numeric/clock.h"
#include "numeric/magnitudes.h"
#include "numeric/release.h"

int lag_samples_init(Samples *s, int rows, int n) {
  *s = (Samples){.rows = rows, .n = n};
  s->t = calloc((size_t)rows + 1, sizeof *s->t);
  s->y = calloc((size_t)rows * (size_t)n + 1, sizeof *s->y);
  s->largest = calloc((size_t)n + 1, sizeof *s->largest);
  return s->t && s->y && s->largest ? LAG_OK : LAG_ENOMEM;
}

void lag_samples_free(Samples *s) {
  lag_free_all(s->t, s->y, s->largest);
  s->t = s->y = s->largest = NULL;
}

/* *y := output k of the scene. */
static int take_output(lag_sim *sim, int k, double *y) {
  double *all = malloc((size_t)lag_sim_scene(sim)->nout * sizeof *all);
  int rc = all ? lag_sim_outputs(sim, all) : LAG_ENOMEM;
  if (rc == LAG_OK) *y = all[k];
  free(all);
  return rc;
}

int lag_samples_note(Samples *s, lag_sim *sim) {
  enum { PLACES = 8 }; /* within a step: long ones pass by maxima */
  double from = sim->run->step_t0, h = sim->run->t - from, calls = sim->pb.rhs_calls, y;
  int rc = s->output > 0 ? take_output(sim, s->output - 1, &y) : LAG_OK;
  if (s->output > 0) {
    if (rc == LAG_OK) *s->largest = fmax(*s->largest, fabs(y));
    return rc;
  }
  for (int k = sim->method->flags & LAG_METHOD_STEPS_TO ? PLACES : 1; k <= PLACES && rc == LAG_OK; k++) {
    rc = k < PLACES ? lag_dense_state(sim, from + h * k / PLACES, sim->yc) : LAG_OK;
    for (int i = 0; i < s->n && rc == LAG_OK; i++)
      s->largest[i] = fmax(s->largest[i], fabs(k < PLACES ? sim->yc[i] : sim->now[i]));
  }
  sim->pb.rhs_calls = calls;
  return rc;
}

/* Residuals on their way: the largest of each component since the last row, and the hook that was there before. */
typedef struct Residuals {
  double *most, *r; /* [n] each; r: of one step */
  int rc;
  int (*before)(void *, const lag_sim *);
  void *context;
} Residuals;

/* r[n] := the residual in the middle of the last step. The derivative of the motion is that of a polynomial of
 * degree 8. */
static int take_residual(lag_sim *sim, double *r) {
  static const double weight[] = {4. / 5, -1. / 5, 4. / 105, -1. / 280};
  const double apart = 0.1; /* of a step */
  double from = sim->run->step_t0, h = sim->run->t - from, middle = from + 0.5 * h, calls = sim->pb.rhs_calls,
         *y = sim->yc;
  int n = sim->pb.n, rc = LAG_OK;
  memset(r, 0, (size_t)n * sizeof *r);
  if (h == 0) return LAG_OK;
  if (sim->method->flags & LAG_METHOD_STEPS_TO)
    return lag_fail(sim, LAG_EINVAL, "%s has no motion between the ends of its steps, and so no residual",
                    sim->method->name);
  rc = lag_dense_state(sim, middle, y);
  rc = rc ? rc : lag_rhs(&sim->pb, middle, y, r);
  for (int i = 0; i < n && rc == LAG_OK; i++) r[i] = -r[i];
  for (int k = 1; k <= 8 && rc == LAG_OK; k++) {
    int side = k > 4 ? -1 : 1, at = k > 4 ? k - 4 : k;
    rc = lag_dense_state(sim, middle + side * at * apart * h, y);
    for (int i = 0; i < n && rc == LAG_OK; i++) r[i] += side * weight[at - 1] / (apart * h) * y[i];
  }
  sim->pb.rhs_calls = calls;
  return rc;
}

static int note_residual(void *residuals, const lag_sim *sim) {
  Residuals *w = residuals;
  w->rc = take_residual((lag_sim *)sim, w->r);
  for (int i = 0; i < sim->pb.n && w->rc == LAG_OK; i++)
    w->most[i] = w->r[i] - w->r[i] == 0 ? fmax(w->most[i], fabs(w->r[i])) : HUGE_VAL;
  return w->rc || (w->before && w->before(w->context, sim));
}

/* s->y := the largest residuals between the rows. */
static int take_residuals(Samples *s, lag_sim *sim) {
  Residuals w = {.before = sim->on_step, .context = sim->on_step_context};
  int rc = (w.r = calloc((size_t)s->n + 1, sizeof *w.r)) ? LAG_OK : LAG_ENOMEM;
  lag_sim_on_step(sim, note_residual, &w);
  for (int i = 0; i < s->rows && rc == LAG_OK; i++) {
    w.most = s->y + (size_t)i * (size_t)s->n;
    memset(w.most, 0, (size_t)s->n * sizeof *w.most);
    rc = lag_sim_advance(sim, s->t[i]);
    if (rc == LAG_STOPPED) s->rows = i;
    rc = w.rc ? w.rc : rc;
  }
  lag_sim_on_step(sim, w.before, w.context);
  free(w.r);
  return rc == LAG_STOPPED ? LAG_OK : rc;
}

int lag_samples_take(Samples *s, lag_sim *sim) {
  const lag_model *m = lag_sim_scene(sim)->model;
  size_t nq = (size_t)m->nq, nz = (size_t)m->nz;
  if (s->output == LAG_SAMPLES_RESIDUAL) return take_residuals(s, sim);
  for (int i = 0; i < s->rows; i++) {
    double *y = s->y + (size_t)i * (size_t)s->n;
    int rc = lag_sim_advance(sim, s->t[i]);
    if (rc == LAG_STOPPED) {
      s->rows = i;
      return LAG_OK;
    }
    if (rc) return rc;
    if (s->output) {
      if ((rc = take_output(sim, s->output - 1, y)) != 0) return rc;
      continue;
    }
    memcpy(y, lag_sim_q(sim), nq * sizeof *y);
    memcpy(y + nq, lag_sim_v(sim), nq * sizeof *y);
    memcpy(y + 2 * nq, lag_sim_z(sim), nz * sizeof *y);
  }
  return LAG_OK;
}

/* 0: component i is a coordinate, 1: a velocity, 2: a state. */
static int kind_of(const lag_model *m, int i) { return i < m->nq ? 0 : i < 2 * m->nq ? 1 : 2; }

int lag_previous_alike(const lag_sim *sim, int i) {
  const lag_model *m = lag_sim_scene(sim)->model;
  char unit[64], other[64];
  int k = i - 1;
  lag_sim_state_info(sim, i, NULL, 0, unit, sizeof unit);
  for (; k >= 0 && kind_of(m, k) == kind_of(m, i); k--) {
    lag_sim_state_info(sim, k, NULL, 0, other, sizeof other);
    if (strcmp(unit, other) == 0) return k;
  }
  return -1;
}

/* terms[n] := the largest of itself and of each component's size at y, t of a run of steps h to `span`, where its
 * values are rounding: of velocities by the energy, of coordinates with these over the run, of states by the terms
 * of their rates. */
static void add_state_terms(lag_sim *sim, double t, const double *y, double span, double h, double *terms, double *v) {
  int nq = sim->pb.nq, n = sim->pb.n;
  double calls = sim->pb.rhs_calls, *rate = sim->yb, *beside = sim->yc;
  const double moved = 1. / 1024;
  lag_velocity_terms(sim, t, y, h, v);
  for (int i = 0; i < nq; i++) {
    double of = v[i] < HUGE_VAL ? v[i] : span > 0 ? fabs(y[i]) / span : 0; /* without mass: what shows in its place */
    terms[nq + i] = fmax(terms[nq + i], of);
    terms[i] = fmax(terms[i], of * span);
  }
  for (int i = 0; i < n; i++) beside[i] = y[i] * (1 + moved);
  if (n > 2 * nq && lag_rhs(&sim->pb, t, y, rate) == LAG_OK && lag_rhs(&sim->pb, t, beside, v) == LAG_OK)
    for (int i = 2 * nq; i < n; i++) {
      double of = fabs(v[i] - rate[i]) / moved;
      int rests = lag_above_rounding(fabs(rate[i]), of) > fabs(rate[i]);
      terms[i] = rests ? fmax(terms[i], of * span) : HUGE_VAL;
    }
  sim->pb.rhs_calls = calls;
}

/* terms[n] := sizes of components where their values are rounding, over some rows; 0, HUGE_VAL: not known. v:
 * scratch. */
static void take_terms(const Samples *s, lag_sim *sim, double *terms, double *v) {
  enum { ROWS = 5, FEW = 2, MANY_OPS = 1000000 };
  int n = s->n, last = s->rows - 1, rows = sim->scene->model->ops < MANY_OPS ? ROWS : FEW;
  double span = last > 0 ? fabs(s->t[last] - sim->scene->t0) : 0, h = lag_step_so_far(sim);
  if (!(h > 0) && last > 0) h = span / last; /* a run that has not begun: rows are about a step apart */
  if (s->output > 0) terms[0] = lag_output_terms(sim, lag_sim_time(sim), sim->now, s->output - 1);
  if (s->output != 0 || n != sim->pb.n) return;
  for (int k = 0, before = -1, row; k < rows && last >= 0; before = row, k++) {
    row = k * last / (rows - 1);
    if (row == before) continue;
    add_state_terms(sim, s->t[row], s->y + (size_t)row * (size_t)n, span, h, terms, v);
  }
}

double lag_size_in(const Samples *s, int i) {
  double size = s->largest ? s->largest[i] : 0;
  for (int r = 0; r < s->rows; r++) size = fmax(size, fabs(s->y[(size_t)r * (size_t)s->n + (size_t)i]));
  return size;
}

/* Scale of component i of the state, or of an output, -1, of this largest size: its terms where that is rounding, or
 * began as rounding and stays below the tolerance of a run whose reference is sim: long steps let it grow so far. */
static double scale_above(const lag_sim *sim, int i, double size, double terms) {
  const double beside = 40; /* the run's tolerance in those of its reference */
  int is_state = i >= 0 && i < sim->pb.n && terms < HUGE_VAL && sim->method->flags & LAG_METHOD_ADAPTIVE;
  int grew = is_state && lag_above_rounding(fabs(sim->begin[i]), terms) == terms && size < beside * sim->tol * terms;
  return grew ? terms : lag_above_rounding(size, terms);
}

int lag_cost_scales(const Samples *reference, lag_sim *sim, double *scale) {
  int n = reference->n, nq = sim->pb.nq;
  double *terms = calloc(2 * (size_t)n + 1, sizeof *terms);
  if (!terms) return LAG_ENOMEM;
  take_terms(reference, sim, terms, terms + n);
  for (int i = 0; i < n; i++) {
    int alike = reference->output > 0 ? -1 : lag_previous_alike(sim, i);
    scale[i] = fmax(alike < 0 ? 0 : scale[alike], lag_size_in(reference, i));
    if (alike >= 0) terms[i] = fmax(terms[i], terms[alike]);
  }
  for (int i = n - 1; i >= 0; i--) { /* the last of a kind has the largest */
    int alike = reference->output > 0 ? -1 : lag_previous_alike(sim, i);
    int velocity = reference->output == 0 && i < nq ? nq + i : i, of = reference->output == 0 ? i : -1;
    if (alike >= 0) scale[alike] = scale[i];
    if (alike >= 0) terms[alike] = terms[i];
    /* A coordinate rests if its velocity does, whose scale is its terms then. */
    if (velocity == i || scale[velocity] == terms[velocity]) scale[i] = scale_above(sim, of, scale[i], terms[i]);
    scale[i] = scale[i] > 0 ? scale[i] : 1;
  }
  free(terms);
  return LAG_OK;
}

double lag_cost_row_error(int n, const double *a, const double *b, const double *scale) {
  double most = 0;
  for (int k = 0; k < n; k++) {
    double d = fabs(a[k] - b[k]) / scale[k];
    most = d <= HUGE_VAL ? fmax(most, d) : HUGE_VAL;
  }
  return most;
}

double lag_cost_error(const Samples *a, const Samples *b, const double *scale) {
  double most = 0;
  for (int i = 0; i < a->rows && i < b->rows; i++)
    most =
        fmax(most, lag_cost_row_error(a->n, a->y + (size_t)i * (size_t)a->n, b->y + (size_t)i * (size_t)a->n, scale));
  return most;
}

/* ---- One setting */

lag_sim *lag_cost_prepare(CostMethod *m, const CostScene *scene, double knob, int *rc) {
  lag_sim *sim = scene->fresh(scene->context);
  int adaptive = (m->method->flags & LAG_METHOD_ADAPTIVE) != 0, n = 0;
  lag_option opt[2];
  *rc = LAG_ENOMEM;
  if (!sim) return NULL;
  if (m->option.name) opt[n++] = m->option;
  if (!adaptive) opt[n++] = (lag_option){.name = "step", .value = knob};
  if (lag_sim_set_method(sim, m->method, opt, n) || (adaptive && lag_sim_set_tolerance(sim, knob))) {
    snprintf(m->why, sizeof m->why, "%s", lag_sim_message(sim));
    lag_sim_free(sim);
    *rc = LAG_EINVAL;
    return NULL;
  }
  return sim;
}

/* Ends a run that takes too long, or with the sweep. The clock is read about once a millisecond. */
typedef struct Watch {
  const CostSweep *s;
  const CostMethod *m;
  double begin, longest; /* [s] */
  long long steps, next;
} Watch;

static int is_too_long(void *watch, const lag_sim *sim) {
  Watch *w = watch;
  (void)sim;
  if (++w->steps < w->next) return 0;
  double used = lag_processor_seconds() - w->begin;
  w->next = w->steps + 1 + (long long)fmin((double)w->steps, 1e-3 * (double)w->steps / fmax(used, 1e-9));
  return used > w->longest || (w->s->end > 0 && lag_clock_seconds() > w->s->end) ||
         (w->s->note && w->s->note(w->s->context, w->m, -1));
}

/* One run: own, *run's time, steps and calls. `watched`: it is left after `longest` [s]. */
static int run_once(CostMethod *m, const CostSweep *s, int watched, double longest, Samples *own, CostRun *run) {
  int rc;
  lag_sim *sim = lag_cost_prepare(m, &s->scene, run->knob, &rc);
  lag_stats st;
  Watch watch = {.s = s, .m = m, .begin = lag_processor_seconds(), .longest = longest};
  if (!sim) return rc;
  own->rows = s->reference->rows;
  if (watched) lag_sim_on_step(sim, is_too_long, &watch);
  double begin = lag_processor_seconds();
  rc = lag_samples_take(own, sim);
  run->time = lag_processor_seconds() - begin;
  if (rc == LAG_INTERRUPTED) {
    snprintf(m->why, sizeof m->why, "it took longer than %.2g s", longest);
  } else if (rc) {
    snprintf(m->why, sizeof m->why, "%s", lag_sim_message(sim));
  } else {
    lag_sim_stats(sim, &st);
    run->steps = st.steps;
    run->calls = st.rhs_calls;
    /* A motion that has left the true one, and all forces, has a small residual. */
    if (own->output == LAG_SAMPLES_RESIDUAL && lag_sim_judge(sim) < 0) own->y[0] = HUGE_VAL;
    m->why[0] = '\0';
  }
  lag_sim_free(sim);
  return rc ? rc : own->rows < s->reference->rows ? LAG_STOPPED : LAG_OK;
}

int lag_cost_run(CostMethod *m, const CostSweep *s, double enough, int most, double longest, Samples *own,
                 CostRun *run) {
  enum { MOST_REPEATS = 41 };
  double times[MOST_REPEATS], total = 0;
  int n = 0, residual = own->output == LAG_SAMPLES_RESIDUAL, rc = run_once(m, s, 1, longest, own, run);
  if (rc) return rc;
  run->error = 0;
  for (int i = 0; i < own->rows && i < LAG_COST_MOST_ROWS; i++) {
    size_t at = (size_t)i * (size_t)own->n;
    run->at[i] = lag_cost_row_error(own->n, own->y + at, s->reference->y + at, s->scale);
    run->error = fmax(run->error, run->at[i]);
  }
  own->output = residual ? 0 : own->output; /* whose computation is not part of a run's time */
  if (!residual) total = times[n++] = run->time;
  while (n < MOST_REPEATS && (n == 0 || (n < most && total < enough)) && rc == LAG_OK) {
    rc = run_once(m, s, 0, longest, own, run);
    total += times[n++] = run->time;
  }
  own->output = residual ? LAG_SAMPLES_RESIDUAL : own->output;
  qsort(times, (size_t)n, sizeof *times, lag_ascending);
  run->time = times[n / 2];
  run->spread = n > 1 ? (times[3 * n / 4] - times[n / 4]) / times[n / 2] : NAN;
  return rc;
}

double lag_cost_order(const CostMethod *m, double uncertainty) {
  enum { SLOPES = 3 };
  double slope[LAG_COST_MOST_RUNS], *last, floor = HUGE_VAL;
  int n = 0, varies = m->method->order_most > 0 && !m->option.name;

  for (int i = 0; i < m->nruns; i++) floor = fmin(floor, m->run[i].error);
  for (int i = 1; i < m->nruns && !varies; i++) {
    const CostRun *a = &m->run[i - 1], *b = &m->run[i];
    if (a->error < 1e-2 && b->error > 30 * floor && b->error > 10 * uncertainty && b->error < a->error &&
        b->steps > a->steps)
      slope[n++] = log(a->error / b->error) / log((double)b->steps / (double)a->steps);
  }
  if (n < SLOPES) return NAN;
  last = slope + n - SLOPES;
  qsort(last, SLOPES, sizeof *last, lag_ascending);
  return last[SLOPES / 2];
}

/* ---- All methods */

void lag_pareto_front(CostMethod *m, int n) {
  for (int i = 0; i < n; i++)
    for (int k = 0; k < m[i].nruns; k++) {
      CostRun *run = &m[i].run[k];
      const CostRun *better = NULL;
      for (int j = 0; j < n && !better; j++)
        for (int l = 0; l < m[j].nruns && !better; l++) {
          const CostRun *other = &m[j].run[l];
          better = other->time <= run->time && other->error <= run->error &&
                           (other->time < run->time || other->error < run->error)
                       ? other
                       : NULL;
        }
      run->best = !better;
    }
}

/* answers: 1: without runs that monitors stop. */
static const CostMethod *find_cheapest(const CostMethod *m, int n, double target, int answers, const CostRun **run) {
  const CostMethod *which = NULL;
  for (int i = 0; i < n; i++)
    for (int k = 0; k < m[i].nruns; k++) {
      const CostRun *r = &m[i].run[k];
      if (r->error <= target && !(answers && r->stopped) && (!which || r->time < (*run)->time)) {
        which = &m[i];
        *run = r;
      }
    }
  return which;
}

double lag_cost_smallest_error(const CostMethod *m, int n) {
  double least = HUGE_VAL;
  for (int i = 0; i < n; i++)
    for (int k = 0; k < m[i].nruns; k++) least = fmin(least, m[i].run[k].error);
  return least;
}

const CostMethod *lag_cost_cheapest(const CostMethod *m, int n, double target, const CostRun **run) {
  return find_cheapest(m, n, target, 0, run);
}

const CostMethod *lag_cost_answer(const CostMethod *m, int n, double target, const CostRun **run) {
  return find_cheapest(m, n, target, 1, run);
}
