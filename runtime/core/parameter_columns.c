/* Sensitivities: a tangent whose columns are derivatives by parameters and by starts. Enters: names; leaves: the
 * columns at the start, and what parameters contribute at events and in outputs. Holds: along the motion the
 * derivatives by parameters are the emitted ones (linearisation.c); what is evaluated once, starts, events and outputs,
 * is differentiated by differences of order 6 between neighbouring parameters, which follow one another as the scene
 * says. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"

/* Names of a sensitivity: parameter (column of `by`), or component of the state. */
typedef struct Target {
  int kind, index;
} Target;

struct lag_sensitivity {
  lag_parameter_columns by;
  double *own, *shifted; /* the run's parameters; by.shifted */
  double *begin;         /* [n k] change of the start */
  Target *of;            /* [k] */
  lag_parameter_term *term;
  double room[];
};

void lag_parameter_columns_free(lag_sim *s) {
  s->pb.by = NULL;
  if (s->sensitivity) free(s->sensitivity->term);
  free(s->sensitivity);
  s->sensitivity = NULL;
}

void lag_use_parameters(lag_sim *s, int j, int k) {
  const struct lag_sensitivity *w = s->sensitivity;
  s->p = k ? w->shifted + (lag_shifted_parameters(&s->pb, &w->by, j, k) - w->shifted) : w->own;
  s->pb.p = s->p;
  s->parameters_shifted = k != 0;
}

/* P := the parameters with p[i] = x, and those that follow from it. */
static void put_parameters(const lag_sim *s, int i, double x, unsigned char *fixed, double *P) {
  const lag_model *m = s->scene->model;
  memcpy(P, s->p, (size_t)(m->np + m->nderived) * sizeof *P);
  memcpy(fixed, s->fixed, (size_t)m->np);
  fixed[i] = 1;
  P[i] = x;
  if (s->scene->params) s->scene->params(s->scene, P, fixed);
  else if (m->derive) m->derive(m, P);
}

/* Step of parameter i: a part of its value, or of its unit where that is 0. */
static double step_of(const lag_sim *s, int i) {
  return LAG_DIFFERENCE_PART * (s->p[i] != 0.0 ? fabs(s->p[i]) : fabs(s->scene->model->p[i].factor));
}

/* Derivative of parameter i by parameter column j. */
static double chain(const lag_sim *s, const lag_parameter_columns *by, int i, int j) {
  double sum = 0;
  LAG_EACH_DIFFERENCE(k)
    sum += lag_difference_weight(k) * lag_shifted_parameters(&s->pb, by, j, k)[i] / by->h[j];
  return sum;
}

/* The terms of each derivative of residuals by a parameter, or with constraints of each parameter by those of columns;
 * term NULL: they are counted. */
static int put_terms(const lag_sim *s, const lag_parameter_columns *by, lag_parameter_term *term) {
  const lag_model *m = s->scene->model;
  const lag_partials *of = m->linear ? m->linear->by_params : NULL;
  int n = 0, width = s->pb.n + by->n, from = m->constraints && m->constraints->adjoint ? m->np : of ? of->n : 0;
  for (int k = 0; k < from; k++)
    for (int j = 0; j < by->n; j++) {
      double factor = chain(s, by, of ? of->at[k].col : k, j);
      if (factor == 0.0) continue;
      if (term) term[n] = (lag_parameter_term){k, of ? of->at[k].row * width + s->pb.n + j : j, factor};
      n++;
    }
  return n;
}

/* Memory of m parameters in k columns, with the parameters beside the run's. */
static struct lag_sensitivity *sensitivity_new(const lag_sim *s, const Target *of, int m, int k) {
  const lag_model *model = s->scene->model;
  size_t np = (size_t)model->np, all = np + (size_t)model->nderived, n = (size_t)s->pb.n, some = (size_t)m;
  struct lag_sensitivity *w = calloc(1, sizeof *w + (some * (1 + 7 * all) + n * (size_t)k) * sizeof(double) +
                                            (size_t)k * sizeof(Target) + some * sizeof(int) + np);
  if (!w) return NULL;
  double *h = w->room;
  w->own = s->p;
  w->shifted = h + some;
  w->begin = w->shifted + 7 * all * some;
  w->of = (Target *)(w->begin + n * (size_t)k);
  memcpy(w->of, of, (size_t)k * sizeof *of);
  int *column = (int *)(w->of + k);
  unsigned char *fixed = (unsigned char *)(column + m);
  w->by = (lag_parameter_columns){.n = m, .column = column, .h = h, .shifted = w->shifted};
  for (int c = 0, j = 0; c < k; c++) {
    if (of[c].kind != LAG_IS_P) continue;
    column[j] = c;
    h[j] = step_of(s, of[c].index);
    for (int step = -3; step <= 3; step++)
      put_parameters(s, of[c].index, s->p[of[c].index] + step * h[j], fixed,
                     w->shifted + (size_t)(7 * j + step + 3) * all);
    j++;
  }
  int terms = put_terms(s, &w->by, NULL);
  if (!(w->term = calloc((size_t)terms + 1, sizeof *w->term))) return free(w), NULL;
  w->by.term = w->term;
  w->by.nterms = put_terms(s, &w->by, w->term);
  return w;
}

int lag_all_parameters(lag_sim *s) {
  int np = s->scene->model->np;
  Target *of = malloc(((size_t)np + 1) * sizeof *of);
  for (int i = 0; of && i < np; i++) of[i] = (Target){LAG_IS_P, i};
  struct lag_sensitivity *all = of ? sensitivity_new(s, of, np, np) : NULL;
  free(of);
  if (!all) return lag_fail(s, LAG_ENOMEM, "out of memory");
  s->sensitivity = all;
  s->pb.by = &all->by;
  return LAG_OK;
}

void lag_all_parameters_end(lag_sim *s, struct lag_sensitivity *kept) {
  lag_parameter_columns_free(s);
  s->sensitivity = kept;
  s->pb.by = kept && kept->by.n ? &kept->by : NULL;
}

/* ---- The columns at the start */

/* e[n] := change of the start as asked for by parameter j, or by component `at` for j < 0. */
static int asked_change(lag_sim *s, int j, int at, double *e) {
  size_t n = (size_t)s->pb.n;
  double *kept = malloc(2 * n * sizeof *kept);
  memset(e, 0, n * sizeof *e);
  if (j < 0) e[at] = 1;
  if (!kept || j < 0) return free(kept), kept != NULL;
  memcpy(kept, s->now, n * sizeof *kept), memcpy(kept + n, s->begin, n * sizeof *kept);
  LAG_EACH_DIFFERENCE(k) {
    lag_use_parameters(s, j, k);
    lag_asked_start(s);
    for (size_t i = 0; i < n; i++) e[i] += lag_difference_weight(k) * s->now[i] / s->sensitivity->by.h[j];
    lag_use_parameters(s, 0, 0);
  }
  memcpy(s->now, kept, n * sizeof *kept), memcpy(s->begin, kept + n, n * sizeof *kept);
  return free(kept), 1;
}

/* Column c of `to` by linear equations at a start on constraints, where they tell; whether they do. */
static int linear_column(lag_sim *s, Target of, int j, int c, int k, double *to) {
  int n = s->pb.n, is_p = of.kind == LAG_IS_P;
  double *e = malloc((size_t)n * sizeof *e), asked = is_p ? 0 : s->asked[of.index],
         h = is_p ? s->sensitivity->by.h[j] : LAG_DIFFERENCE_PART * lag_difference_scale(&s->pb, s->begin, of.index);
  if (!is_p) s->asked[of.index] = s->begin[of.index];
  int by = is_p ? j : -1;
  int known = e && asked_change(s, by, of.index, e) && lag_start_change(s, &s->sensitivity->by, by, h, e);
  if (!is_p) s->asked[of.index] = asked;
  for (int i = 0; i < n && known; i++) to[i * k + c] = e[i];
  return free(e), known;
}

/* Column c of `to` := the change of the start by target c. The run has not begun. */
static int start_column(lag_sim *s, Target of, int j, int c, int k, double *to) {
  int n = s->pb.n, rc = LAG_OK, is_p = of.kind == LAG_IS_P;
  double at = s->begin[of.index], given = is_p ? 0 : s->start[of.index],
         h = is_p ? s->sensitivity->by.h[j] : LAG_DIFFERENCE_PART * lag_difference_scale(&s->pb, s->begin, of.index);
  if (is_p ? !s->scene->start : !s->scene->model->constraints) {
    if (!is_p) to[of.index * k + c] = 1;
    return LAG_OK;
  }
  if (!is_p) s->start[of.index] = at;
  int known = s->scene->model->constraints && linear_column(s, of, j, c, k, to);
  if (!is_p) s->start[of.index] = given;
  if (known) return LAG_OK;
  LAG_EACH_DIFFERENCE(step) {
    if (is_p) lag_use_parameters(s, j, step);
    else s->start[of.index] = at + step * h;
    rc = rc ? rc : lag_start_state(s);
    for (int i = 0; i < n; i++) to[i * k + c] += lag_difference_weight(step) * s->now[i] / h;
  }
  if (is_p) lag_use_parameters(s, 0, 0);
  else s->start[of.index] = given;
  return rc ? rc : lag_start_state(s); /* `begin` of the run again */
}

static int start_columns(lag_sim *s, const Target *of, int k, double *to) {
  int rc = LAG_OK;
  for (int c = 0, j = 0; c < k && rc == LAG_OK; c++) {
    rc = start_column(s, of[c], j, c, k, to);
    j += of[c].kind == LAG_IS_P;
  }
  return rc;
}

/* ---- Names */

/* The name without "(0)" behind a start, in s[n]. */
static const char *bare_name(const char *name, char *s, size_t n) {
  size_t length = strlen(name), more = length > 3 && strcmp(name + length - 3, "(0)") == 0 ? 3 : 0;
  snprintf(s, n, "%.*s", (int)(length - more), name);
  return s;
}

static int find_target(lag_sim *s, const char *name, Target *of) {
  const lag_var *var;
  char bare[128];
  const lag_model *m = s->scene->model;
  of->kind = lag_find_name(m, bare_name(name, bare, sizeof bare), &of->index, &var);
  if (of->kind == LAG_IS_P && strcmp(bare, name) != 0)
    return lag_fail(s, LAG_EINVAL, "%s: %s is a parameter, the same at all times; leave (0) out", name, bare);
  if (of->kind == LAG_IS_U)
    return lag_fail(s, LAG_EINVAL, "%s is an input; name the parameters of its formula, or make it a parameter", bare);
  if (of->kind == LAG_IS_NOTHING) return lag_no_such_name(s, bare, "name", "parameter or coordinate");
  if (of->kind == LAG_IS_V) of->index += m->nq;
  if (of->kind == LAG_IS_Z) of->index += 2 * m->nq;
  return LAG_OK;
}

static int find_targets(lag_sim *s, int k, const char *const *names, Target *of) {
  int rc = LAG_OK;
  for (int c = 0; c < k && rc == LAG_OK; c++) {
    rc = find_target(s, names[c], &of[c]);
    for (int b = 0; b < c && rc == LAG_OK; b++)
      if ((of[b].kind == LAG_IS_P) == (of[c].kind == LAG_IS_P) && of[b].index == of[c].index)
        rc = lag_fail(s, LAG_EINVAL, "%s is named twice", names[c]);
  }
  return rc;
}

static int set_columns(lag_sim *s, int k, const Target *of) {
  const lag_model *m = s->scene->model;
  int by = 0, rc;
  for (int c = 0; c < k; c++) by += of[c].kind == LAG_IS_P;
  if (by && !m->constraints && !(m->linear && m->linear->by_params))
    return lag_fail(s, LAG_EMETHOD,
                    "sensitivities by parameters need derivatives, which this program was built without; `lagc run "
                    "--sensitivity` builds them in, and so does `lagc build --with sensitivities`");
  if (!(s->sensitivity = sensitivity_new(s, of, by, k))) return lag_fail(s, LAG_ENOMEM, "out of memory");
  rc = lag_setup_start(s);
  rc = rc ? rc : start_columns(s, of, k, s->sensitivity->begin);
  if (rc) return rc;
  s->pb.by = by ? &s->sensitivity->by : NULL;
  return lag_tangent_set(s, k, s->sensitivity->begin);
}

int lag_all_columns(lag_sim *s) {
  int n = s->pb.n, np = s->scene->model->np;
  Target *of = malloc((size_t)(n + np + 1) * sizeof *of);
  for (int c = 0; of && c < n + np; c++) of[c] = c < n ? (Target){LAG_IS_Q, c} : (Target){LAG_IS_P, c - n};
  int rc = of ? set_columns(s, n + np, of) : lag_fail(s, LAG_ENOMEM, "out of memory");
  free(of);
  return rc;
}

const double *lag_columns_at_start(const lag_sim *s) { return s->sensitivity->begin; }

double lag_parameter_chain(const lag_sim *s, int i, int j) { return chain(s, &s->sensitivity->by, i, j); }

int lag_sim_set_sensitivity(lag_sim *s, int k, const char *const *names) {
  if (!s) return LAG_EINVAL;
  if (k <= 0 || !names) return lag_fail(s, LAG_EINVAL, "a sensitivity without names");
  if (s->run->begun != 0.0) return lag_fail(s, LAG_EINVAL, "the run has begun: set this before the first step");
  lag_tangent_free(s);
  Target *of = malloc((size_t)k * sizeof *of);
  int rc = of ? find_targets(s, k, names, of) : lag_fail(s, LAG_ENOMEM, "out of memory");
  rc = rc ? rc : set_columns(s, k, of);
  if (rc) lag_tangent_free(s);
  free(of);
  return rc;
}

double lag_sim_sensitivity_info(const lag_sim *s, int c, char *name, size_t nname, char *unit, size_t nunit) {
  const Target *of = &s->sensitivity->of[c];
  const lag_var *p = of->kind == LAG_IS_P ? &s->scene->model->p[of->index] : NULL;
  if (!p) {
    double factor = lag_sim_state_info(s, of->index, name, nname, unit, nunit);
    if (name && strlen(name) + 3 < nname) strcat(name, "(0)");
    return factor;
  }
  if (name) snprintf(name, nname, "%s", p->name);
  if (unit) snprintf(unit, nunit, "%s", p->unit);
  return p->factor;
}

double lag_sim_sensitivity_value(const lag_sim *s, int c) {
  const Target *of = &s->sensitivity->of[c];
  return of->kind == LAG_IS_P ? s->p[of->index] : s->begin[of->index];
}

/* ---- Events and outputs */

int lag_event_by_parameters(lag_sim *s, int event, double *change) {
  const lag_parameter_columns *by = s->pb.by;
  int rc = LAG_OK;
  memset(change, 0, (size_t)s->tangent_columns * sizeof *change);
  for (int j = 0; by && j < by->n; j++)
    LAG_EACH_DIFFERENCE(k) {
      lag_use_parameters(s, j, k);
      rc = rc ? rc : lag_events_eval(s, s->run->t, s->now, s->g1);
      change[by->column[j]] += lag_difference_weight(k) * s->g1[event] / by->h[j];
      lag_use_parameters(s, 0, 0);
    }
  return rc;
}

int lag_action_by_parameters(lag_sim *s, int event, double *after, double *change) {
  const lag_parameter_columns *by = s->pb.by;
  const lag_model *m = s->scene->model;
  int n = s->pb.n, nq = s->pb.nq, columns = s->tangent_columns, rc = LAG_OK, stop = 0;
  const double *y = s->now;
  memset(change, 0, (size_t)(n * columns) * sizeof *change);
  for (int j = 0; by && j < by->n; j++)
    LAG_EACH_DIFFERENCE(k) {
      lag_use_parameters(s, j, k);
      memcpy(after, y, (size_t)n * sizeof *y);
      rc = rc ? rc : lag_inputs(&s->pb, s->run->t);
      if (rc == LAG_OK)
        rc = m->act(m, event, s->run->t, y, y + nq, y + 2 * nq, s->p, s->u, after, after + nq, after + 2 * nq, &stop,
                    s->work);
      for (int i = 0; i < n; i++)
        change[i * columns + by->column[j]] += lag_difference_weight(k) * after[i] / by->h[j];
      lag_use_parameters(s, 0, 0);
    }
  return rc;
}

int lag_outputs_at(lag_sim *s, double t, const double *y, double *out) {
  if (s->scene->nout) return lag_observe(s, t, y, out);
  memcpy(out, y, (size_t)s->pb.n * sizeof *out);
  return LAG_OK;
}

int lag_add_outputs(lag_sim *s, double t, const double *y, double weight, double *out, int columns, double *column) {
  int rc = lag_outputs_at(s, t, y, out);
  for (int i = 0; i < lag_sim_noutputs(s) && rc == 0; i++) column[i * columns] += weight * out[i];
  return rc;
}

int lag_outputs_by_parameter(lag_sim *s, double t, const double *y, int j, double *out, int columns, double *column) {
  int rc = LAG_OK;
  LAG_EACH_DIFFERENCE(k) {
    lag_use_parameters(s, j, k);
    rc = rc ? rc : lag_add_outputs(s, t, y, lag_difference_weight(k) / s->pb.by->h[j], out, columns, column);
  }
  lag_use_parameters(s, 0, 0);
  return rc;
}

/* The start, on which closed forms depend, moves along column c. */
static void move_begin(lag_sim *s, int c, double by) {
  for (int i = 0; i < s->pb.n; i++) s->begin[i] += by * s->sensitivity->begin[i * s->tangent_columns + c];
}

/* Change of the outputs along column c of Y. */
static int outputs_along(lag_sim *s, const double *Y, int c, double *y, double *out, double *D) {
  int n = s->pb.n, columns = s->tangent_columns, rc = LAG_OK;
  double far = 0;
  for (int i = 0; i < n; i++) far = fmax(far, fabs(Y[i * columns + c]) / lag_difference_scale(&s->pb, s->now, i));
  if (!(far > 0)) return LAG_OK;
  double h = LAG_DIFFERENCE_PART / far, *kept = out + lag_sim_noutputs(s);
  memcpy(kept, s->begin, (size_t)n * sizeof *kept);
  LAG_EACH_DIFFERENCE(k) {
    for (int i = 0; i < n; i++) y[i] = s->now[i] + k * h * Y[i * columns + c];
    if (s->scene->nexact) move_begin(s, c, k * h);
    rc = rc ? rc : lag_add_outputs(s, s->run->t, y, lag_difference_weight(k) / h, out, columns, D + c);
    memcpy(s->begin, kept, (size_t)n * sizeof *kept);
  }
  return rc;
}

int lag_sim_output_sensitivity(lag_sim *s, const double *Y, double *D) {
  if (!s || !Y || !D) return LAG_EINVAL;
  if (!s->sensitivity) return lag_fail(s, LAG_EINVAL, "this run has no sensitivity: lag_sim_set_sensitivity");
  int n = s->pb.n, nout = lag_sim_noutputs(s), columns = s->tangent_columns, rc = LAG_OK;
  double *y = malloc((size_t)(2 * n + nout + 1) * sizeof *y);
  if (!y) return lag_fail(s, LAG_ENOMEM, "out of memory");
  memset(D, 0, (size_t)(nout * columns) * sizeof *D);
  for (int c = 0; c < columns && rc == LAG_OK; c++) rc = outputs_along(s, Y, c, y, y + n, D);
  for (int j = 0; s->pb.by && j < s->pb.by->n && rc == LAG_OK; j++)
    rc = lag_outputs_by_parameter(s, s->run->t, s->now, j, y + n, columns, D + s->pb.by->column[j]);
  for (int i = 0; i < nout; i++)
    for (int c = 0; c < columns; c++) D[i * columns + c] /= lag_sim_output_info(s, i, NULL, 0, NULL, 0);
  free(y);
  return rc ? lag_fail(s, rc < 0 ? rc : LAG_EDOMAIN, "the outputs have no derivatives at t = %s s", LAG_TEXT(s->run->t))
            : LAG_OK;
}
