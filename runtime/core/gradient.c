/* Reverse mode of a run: the steps and jumps of its tangent, recorded, and the sweep back over them. Enters: a run with
 * a record; leaves: gradients by starts and parameters. Holds: where a tangent would be multiplied by the derivative of
 * a step the record has the step, where by a matrix that matrix (flow_tangent.c decides both), so the
 * gradient is the transpose of sensitivities, up to rounding. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"

/* Matrices [n (n + np)] of changes of the state and by parameters: of jumps; of steps up to time t whose equations or
 * method have no reverse mode; of such a step up to a time within it, where the caller has looked at the state. */
typedef enum MatrixKind { OF_JUMP, OF_STEP, OF_PART } MatrixKind;
typedef struct Matrix {
  MatrixKind kind;
  size_t steps; /* behind so many of the other steps */
  double t, *S;
} Matrix;

/* Steps: each [t0, dt, y0[n], modes[nmodes]]. */
struct lag_record {
  size_t nsteps, step_room, nmatrices, matrix_room;
  int stride;
  double *step;
  Matrix *matrix;
};

void lag_record_free(lag_sim *s) {
  struct lag_record *r = s->record;
  for (size_t i = 0; r && i < r->nmatrices; i++) free(r->matrix[i].S);
  if (r) free(r->matrix), free(r->step);
  free(r);
  s->record = NULL;
}

/* The tangent begins anew: y changes by itself, and nothing by parameters yet. */
static void reset_columns(lag_sim *s) {
  int n = s->pb.n, k = s->tangent_columns;
  memset(s->tangent, 0, (size_t)(n * k) * sizeof *s->tangent);
  for (int i = 0; i < n; i++) s->tangent[i * k + i] = 1;
}

/* Whether the steps that the method makes now have no reverse mode of their own: with constraints, within slides, of
 * implicit methods and series. The derivative of each is then a matrix. */
static int needs_matrix(const lag_sim *s) {
  const lag_model *m = s->scene->model;
  return m->constraints || s->pb.nslide || !m->linear || !m->linear->adjoint || !s->method->adjoint ||
         s->method->adjoint_size(&s->pb) == 0;
}

int lag_sim_record(lag_sim *s) {
  if (!s) return LAG_EINVAL;
  if (s->run->begun != 0.0) return lag_fail(s, LAG_EINVAL, "the run has begun: record it from its first step");
  lag_tangent_free(s);
  int rc = lag_all_columns(s);
  if (rc) return lag_tangent_free(s), rc;
  reset_columns(s);
  s->record = calloc(1, sizeof *s->record);
  if (!s->record) return lag_tangent_free(s), lag_fail(s, LAG_ENOMEM, "out of memory");
  s->record->stride = 2 + s->pb.n + s->scene->model->nmodes;
  return LAG_OK;
}

/* step[stride] := the last step up to t. */
static void put_step(const lag_sim *s, double t, double *step) {
  step[0] = s->run->step_t0;
  step[1] = s->method->span(s->method_work, &s->pb, t);
  memcpy(step + 2, s->y0, (size_t)s->pb.n * sizeof *step);
  memcpy(step + 2 + s->pb.n, s->hold + s->pb.model->nu, (size_t)s->pb.model->nmodes * sizeof *step);
}

static int keep_matrix(lag_sim *s, MatrixKind kind, double t, const double *Y) {
  struct lag_record *r = s->record;
  size_t size = (size_t)s->pb.n * (size_t)s->tangent_columns;
  if (r->nmatrices == r->matrix_room) {
    Matrix *more = realloc(r->matrix, (r->matrix_room = 2 * r->matrix_room + 16) * sizeof *more);
    if (!more) return lag_fail(s, LAG_ENOMEM, "out of memory");
    r->matrix = more;
  }
  double *S = malloc(size * sizeof *S);
  if (!S) return lag_fail(s, LAG_ENOMEM, "no memory for the steps of a gradient: end the run before");
  r->matrix[r->nmatrices++] = (Matrix){kind, r->nsteps, t, memcpy(S, Y, size * sizeof *S)};
  return LAG_OK;
}

int lag_record_step(lag_sim *s, double t) {
  struct lag_record *r = s->record;
  if (needs_matrix(s)) {
    int rc = lag_tangent_over(s, t, s->tangent);
    rc = rc ? rc : keep_matrix(s, OF_STEP, t, s->tangent);
    reset_columns(s);
    return rc;
  }
  if (r->nsteps == r->step_room) {
    size_t room = r->step_room ? 2 * r->step_room : 256;
    double *more = realloc(r->step, room * (size_t)r->stride * sizeof *more);
    if (!more) return lag_fail(s, LAG_ENOMEM, "no memory for the steps of a gradient: end the run before");
    r->step = more, r->step_room = room;
  }
  put_step(s, t, r->step + r->nsteps++ * (size_t)r->stride);
  return LAG_OK;
}

int lag_record_jump(lag_sim *s) {
  int rc = keep_matrix(s, OF_JUMP, s->run->t, s->tangent);
  reset_columns(s);
  return rc;
}

/* Whether the run stands within a step. */
static int is_within(const lag_sim *s) {
  return s->run->have_step != 0.0 && s->run->t != s->run->step_t0 && !s->tangent_at_event;
}

int lag_record_pause(lag_sim *s) {
  if (!is_within(s) || !needs_matrix(s)) return LAG_OK;
  int rc = lag_tangent_over(s, s->run->t, s->tangent);
  rc = rc ? rc : keep_matrix(s, OF_PART, s->run->t, s->tangent);
  reset_columns(s);
  return rc;
}

/* ---- The sweep */

/* x[n]: dJ by the state; g[nu + np] by inputs and parameters, each as if it were free; p[np] by parameters with those
 * that follow from them. Weights that are not used yet: the first `rows`. */
typedef struct Sweep {
  lag_sim *s;
  int rows;
  const double *t, *weight;
  double *x, *g, *p, *one, *step, *scratch;
} Sweep;

/* x := S^T x. */
static void back_over_matrix(Sweep *w, const double *S, double *x) {
  int n = w->s->pb.n, k = w->s->tangent_columns;
  double *sum = w->scratch;
  memset(sum, 0, (size_t)n * sizeof *sum);
  for (int i = 0; i < n; i++) {
    for (int c = 0; c < n; c++) sum[c] += S[i * k + c] * x[i];
    for (int c = n; c < k; c++) w->p[c - n] += S[i * k + c] * x[i];
  }
  memcpy(x, sum, (size_t)n * sizeof *x);
}

static void add(int n, const double *from, double *to) {
  for (int i = 0; i < n; i++) to[i] += from[i];
}

/* Adds the weights at time t to x. */
static void add_weights(Sweep *w, double t, double *x) {
  int n = w->s->pb.n;
  double rounding = 4 * DBL_EPSILON * fabs(t);
  for (; w->rows > 0 && fabs(w->t[w->rows - 1] - t) <= rounding; w->rows--)
    add(n, w->weight + (size_t)(w->rows - 1) * (size_t)n, x);
}

/* A jump, or a step, or a part of one: weights at its end belong to it. */
static void back_over(Sweep *w, const Matrix *m) {
  int n = w->s->pb.n;
  if (m->kind == OF_STEP) add_weights(w, m->t, w->x);
  if (m->kind != OF_PART) {
    back_over_matrix(w, m->S, w->x);
    return;
  }
  memset(w->one, 0, (size_t)n * sizeof *w->one);
  add_weights(w, m->t, w->one);
  back_over_matrix(w, m->S, w->one);
  add(n, w->one, w->x);
}

/* The step (t0, dt), and a shorter one for each weight within it. */
static int back_over_step(Sweep *w, const double *step) {
  lag_problem *pb = &w->s->pb;
  const lag_method *method = w->s->method;
  int n = pb->n, nu = pb->model->nu, rc;
  double t0 = step[0], dt = step[1], rounding = 4 * DBL_EPSILON * (fabs(t0) + fabs(t0 + dt));
  memcpy(w->s->hold + nu, step + 2 + n, (size_t)pb->model->nmodes * sizeof *step);
  lag_switch_count(w->s);
  for (; w->rows > 0 && fabs(w->t[w->rows - 1] - t0 - dt) <= rounding; w->rows--)
    add(n, w->weight + (size_t)(w->rows - 1) * (size_t)n, w->x);
  rc = method->adjoint(pb, t0, dt, step + 2, w->x, w->g, w->scratch);
  for (; rc == LAG_OK && w->rows > 0 && (w->t[w->rows - 1] - t0) * pb->dir > rounding; w->rows--) {
    memcpy(w->one, w->weight + (size_t)(w->rows - 1) * (size_t)n, (size_t)n * sizeof *w->one);
    rc = method->adjoint(pb, t0, w->t[w->rows - 1] - t0, step + 2, w->one, w->g, w->scratch);
    add(n, w->one, w->x);
  }
  return rc;
}

static int sweep(Sweep *w) {
  lag_sim *s = w->s;
  const struct lag_record *r = s->record;
  int n = s->pb.n, rc = LAG_OK;
  if (is_within(s) && !needs_matrix(s)) {
    put_step(s, s->run->t, w->step);
    rc = back_over_step(w, w->step);
  }
  for (size_t k = r->nsteps, j = r->nmatrices; rc == LAG_OK; k--) {
    for (; j > 0 && r->matrix[j - 1].steps == k; j--) back_over(w, &r->matrix[j - 1]);
    if (k == 0) break;
    rc = back_over_step(w, r->step + (k - 1) * (size_t)r->stride);
  }
  for (; rc == LAG_OK && w->rows > 0 && w->t[w->rows - 1] == s->scene->t0; w->rows--)
    add(n, w->weight + (size_t)(w->rows - 1) * (size_t)n, w->x);
  return rc;
}

/* Of the start by starts and parameters, and of parameters by one another. */
static void finish(const Sweep *w, double *by_start, double *by_p) {
  const lag_sim *s = w->s;
  int n = s->pb.n, nu = s->pb.model->nu, np = s->pb.model->np;
  const double *begin = lag_columns_at_start(s);
  for (int c = 0; c < n + np; c++) {
    double sum = 0;
    for (int i = 0; i < n; i++) sum += begin[i * (n + np) + c] * w->x[i];
    if (c >= n) sum += w->p[c - n];
    for (int a = 0; c >= n && a < np; a++)
      if (w->g[nu + a] != 0.0) sum += w->g[nu + a] * lag_parameter_chain(s, a, c - n);
    *(c < n ? &by_start[c] : &by_p[c - n]) = sum;
  }
}

static int check_rows(lag_sim *s, int rows, const double *t) {
  const Run *r = s->run;
  for (int k = 0; k < rows; k++)
    if (!((t[k] - (k ? t[k - 1] : s->scene->t0)) * s->pb.dir >= 0 && (r->t - t[k]) * s->pb.dir >= 0))
      return lag_fail(s, LAG_EINVAL,
                      "time %d of a gradient, %s s, is not in order within the run, which is at t = %s s", k,
                      LAG_TEXT(t[k]), LAG_TEXT(r->t));
  return LAG_OK;
}

int lag_sim_gradient(lag_sim *s, int rows, const double *t, const double *weight, double *by_start, double *by_p) {
  if (!s || rows < 0 || !t || !weight || !by_start || !by_p) return LAG_EINVAL;
  if (!s->record)
    return lag_fail(s, LAG_EINVAL, "this run keeps no steps: lag_sim_record before its first advance");
  int rc = check_rows(s, rows, t), n = s->pb.n, nu = s->pb.model->nu, nmodes = s->pb.model->nmodes;
  if (rc) return rc;
  size_t np = (size_t)s->pb.model->np, stride = (size_t)s->record->stride,
         own = s->method->adjoint ? s->method->adjoint_size(&s->pb) : 0,
         size = 2 * (size_t)n + (size_t)nu + 2 * np + stride + (size_t)nmodes + (own > (size_t)n ? own : (size_t)n);
  double calls = s->pb.rhs_calls, *block = calloc(size + 1, sizeof *block);
  if (!block) return lag_fail(s, LAG_ENOMEM, "out of memory");
  Sweep w = {s, rows, t, weight, .x = block, .one = block + n, .g = block + 2 * n};
  w.p = w.g + nu + np;
  w.step = w.p + np;
  double *modes = w.step + stride;
  w.scratch = modes + nmodes;
  memcpy(modes, s->hold + nu, (size_t)nmodes * sizeof *modes);
  rc = sweep(&w);
  memcpy(s->hold + nu, modes, (size_t)nmodes * sizeof *modes);
  lag_switch_count(s);
  s->pb.rhs_calls = calls;
  if (rc == LAG_OK) finish(&w, by_start, by_p);
  free(block);
  return rc ? lag_explain(s, rc) : LAG_OK;
}
