/* Training of networks in a fit: the sum of squares of the residuals, made small by quasi-Newton steps on its gradient
 * in reverse mode, whose time does not depend on the number of weights. Enters: a Fit whose targets are weights, and
 * other parameters and starts; leaves: their values, without errors, since data do not determine weights one by one.
 * Holds: records are fitted from an eighth to the whole; the search ends where 20 steps gain a tenth of what one
 * standard error of one value does. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/fit_residuals.h"
#include "core/core.h"
#include "numeric/release.h"

enum { WINDOW = 20 }; /* steps */

typedef struct Training {
  Fit *f;
  int n, np, nout;
  int *at;              /* [targets] start, or n + parameter */
  unsigned char *feels; /* [np] whether outputs depend on a parameter by themselves */
  int probed;           /* `feels` is known */
  double *slope, *x;    /* [targets] */
  double *y, *out, *by; /* [n]; [nout] SI; [nout] derivative of the sum by outputs in SI */
  double *weight;       /* [nrows n] */
  double *d;            /* [n + np] of one record */
  double gain[WINDOW];  /* last sums */
  int nsteps;
} Training;

/* ---- One record */

/* The change of the sum where the outputs at y differ from the present ones. */
static double along_outputs(Training *w, lag_sim *s, const double *y, int *rc) {
  double sum = 0;
  *rc = *rc ? *rc : lag_observe(s, s->run->t, y, w->out);
  for (int i = 0; i < w->nout && *rc == LAG_OK; i++)
    if (w->by[i] != 0.0) sum += w->by[i] * w->out[i];
  return sum;
}

/* weight[n] := derivatives of the sum by the present state; those by parameters at this state are added to d. */
static int weigh(Training *w, lag_sim *s, double *weight) {
  const lag_parameter_columns *by = s->pb.by;
  int n = w->n, rc = lag_sim_eval(s, s->run->t, w->y);
  for (int c = 0; c < n && rc == LAG_OK; c++) {
    double y = w->y[c], h = LAG_DIFFERENCE_PART * lag_difference_scale(&s->pb, w->y, c);
    weight[c] = 0;
    LAG_EACH_DIFFERENCE(k) {
      w->y[c] = y + k * h;
      weight[c] += lag_difference_weight(k) * along_outputs(w, s, w->y, &rc) / h;
    }
    w->y[c] = y;
  }
  for (int j = 0; by && j < by->n && rc == LAG_OK; j++) {
    if (w->probed && !w->feels[j]) continue;
    double sum = 0;
    LAG_EACH_DIFFERENCE(k) {
      lag_use_parameters(s, j, k);
      sum += lag_difference_weight(k) * along_outputs(w, s, w->y, &rc) / by->h[j];
    }
    lag_use_parameters(s, 0, 0);
    w->d[n + j] += sum;
    w->feels[j] |= sum != 0.0;
  }
  return rc;
}

/* Residuals of row i, squared; w->by. */
static double squares_of_row(Training *w, lag_sim *s, int i) {
  Fit *f = w->f;
  double sum = 0, slope;
  memset(w->by, 0, (size_t)w->nout * sizeof *w->by);
  for (int c = 0; c < f->ncolumns; c++) {
    int o = f->column[c].output;
    double r = lag_fit_residual(f, i, c, f->row[o], &slope);
    if (isnan(f->data[i * f->ncolumns + c])) continue;
    sum += r * r;
    w->by[o] += r * slope / lag_sim_output_info(s, o, NULL, 0, NULL, 0);
  }
  return sum;
}

static int run_record(Training *w, int k, double *squares, double *g) {
  Fit *f = w->f;
  int first = f->first[k], end = lag_fit_end_row(f, k), n = w->n;
  lag_sim *s = lag_fit_simulation(f, k, -1, 0);
  if (!s) return LAG_EINVAL;
  int rc = g ? lag_sim_record(s) : LAG_OK;
  memset(w->d, 0, (size_t)(n + w->np) * sizeof *w->d);
  for (int i = first; i < end && rc == LAG_OK; i++) {
    rc = lag_fit_advance(f, s, f->t[i]);
    rc = rc ? rc : lag_sim_outputs(s, f->row);
    if (rc == LAG_OK) *squares += squares_of_row(w, s, i);
    if (rc == LAG_OK && g) rc = weigh(w, s, w->weight + (i - first) * n);
  }
  double *by = w->d + n + w->np;
  if (rc == LAG_OK && g) rc = lag_sim_gradient(s, end - first, f->t + first, w->weight, by, by + n);
  for (int i = 0; i < n + w->np && rc == LAG_OK && g; i++) w->d[i] += by[i];
  for (int j = 0; j < f->n && rc == LAG_OK && g; j++) {
    const FitTarget *t = &f->target[j];
    if (!t->record || t->record == k + 1) g[j] += w->d[w->at[j]] * t->factor * w->slope[j];
  }
  if (rc && !f->why[0]) lag_fit_fail(f, rc, lag_sim_message(s));
  lag_sim_free(s);
  return rc;
}

/* ---- The sum */

/* Half the sum of squares at x, and its gradient. */
static int objective(void *training, const double *x, double *half, double *g) {
  Training *w = training;
  Fit *f = w->f;
  double squares = 0;
  int rc = LAG_OK;
  f->why[0] = '\0';
  lag_fit_take_values(f, x, w->slope);
  if (g) memset(g, 0, (size_t)f->n * sizeof *g);
  for (int k = 0; k < f->nrecords && rc == LAG_OK; k++) rc = run_record(w, k, &squares, g);
  for (int j = 0; j < f->n && rc == LAG_OK; j++) {
    const FitTarget *t = &f->target[j];
    double r = t->prior_error > 0 ? (t->value - t->prior) / t->prior_error : 0;
    squares += r * r;
    if (g && r != 0.0) g[j] += r / t->prior_error * w->slope[j];
  }
  if (g && rc == LAG_OK) w->probed = 1;
  f->evaluations++;
  *half = squares / 2;
  return rc ? rc : isfinite(squares) ? LAG_OK : LAG_ENAN;
}

/* Whether the search goes on: the last 20 steps have gained a tenth of a squared error. */
static int goes_on(void *training, double half) {
  const double little = 0.1;
  Training *w = training;
  double before = w->gain[w->nsteps % WINDOW], error = w->f->known_errors ? 1 : 2 * half / w->f->nvalues;
  w->gain[w->nsteps++ % WINDOW] = half;
  return w->nsteps <= WINDOW || 2 * (before - half) > little * error;
}

/* ---- The search */

static int open_training(Training *w) {
  Fit *f = w->f;
  lag_sim *s = lag_fit_simulation(f, 0, -1, 0);
  if (!s) return LAG_ENOMEM;
  const lag_model *m = lag_sim_scene(s)->model;
  w->n = s->pb.n, w->np = m->np, w->nout = lag_sim_noutputs(s);
  size_t n = (size_t)w->n, np = (size_t)w->np, nout = (size_t)w->nout, all = (size_t)f->n;
  w->at = calloc(all + 1, sizeof *w->at);
  w->feels = calloc(np + 1, 1);
  double *room = w->slope = calloc(all + 3 * n + 2 * np + 2 * nout + (size_t)f->nrows * n + 1, sizeof *room);
  for (int j = 0; j < f->n && w->at; j++) {
    const lag_var *var;
    int kind = lag_find_name(m, f->target[j].name, &w->at[j], &var);
    w->at[j] += kind == LAG_IS_P ? w->n : kind == LAG_IS_V ? m->nq : kind == LAG_IS_Z ? 2 * m->nq : 0;
  }
  lag_sim_free(s);
  if (!w->at || !w->feels || !room) return lag_fit_fail(f, LAG_ENOMEM, "out of memory");
  w->y = room + all;
  w->out = w->y + n;
  w->by = w->out + nout;
  w->d = w->by + nout;
  w->weight = w->d + 2 * (n + np);
  return LAG_OK;
}

static int search(Training *w) {
  enum { SHORT = 100, WHOLE = 1000, ENOUGH = 8 };
  Fit *f = w->f;
  int rc = LAG_OK;
  for (int part = 64; part > 0 && rc == LAG_OK; part /= 2) {
    int steps = 0;
    if (lag_fit_count_values(f, part) < ENOUGH && part > 1) continue;
    w->nsteps = 0;
    lag_fit_leave_bounds(f, w->x);
    rc = f->by->descend(f->n, w->x, objective, goes_on, w, part > 1 ? SHORT : WHOLE, &steps);
    f->steps += steps;
    f->converged = rc == LAG_OK;
    if (rc == LAG_EMETHOD) rc = LAG_OK;
  }
  return rc;
}

int lag_fit_train(Fit *f, double *x) {
  Training w = {.f = f, .x = x};
  double half = 0;
  int rc = open_training(&w);
  rc = rc ? rc : search(&w);
  lag_fit_count_values(f, 1);
  rc = rc ? rc : objective(&w, x, &half, NULL);
  f->chi_squared = 2 * half;
  f->freedom = f->nvalues;
  for (int j = 0; j < f->n; j++) f->target[j].error = NAN;
  lag_free_all(w.at, w.feels, w.slope);
  return rc;
}
