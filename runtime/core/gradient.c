/* Reverse mode of a run: the steps and jumps of its tangent, recorded, and the sweep back over them. Enters: a run with
 * a record; leaves: gradients by starts and parameters. Holds: where a tangent would be multiplied by the derivative of
 * a step the record has the step, where by a saltation matrix that matrix (flow_tangent.c decides both), so the
 * gradient is the transpose of sensitivities, up to rounding. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"

/* A jump: the matrix [n (n + np)] of changes of the state and by parameters, behind so many steps. */
typedef struct Jump {
  size_t steps;
  double *S;
} Jump;

/* Steps: each [t0, dt, y0[n], modes[nmodes]]. */
struct lag_record {
  size_t nsteps, step_room, njumps, jump_room;
  int stride;
  double *step;
  Jump *jump;
};

void lag_record_free(lag_sim *s) {
  struct lag_record *r = s->record;
  for (size_t i = 0; r && i < r->njumps; i++) free(r->jump[i].S);
  if (r) free(r->jump), free(r->step);
  free(r);
  s->record = NULL;
}

/* The tangent begins anew: y changes by itself, and nothing by parameters yet. */
static void reset_columns(lag_sim *s) {
  int n = s->pb.n, k = s->tangent_columns;
  memset(s->tangent, 0, (size_t)(n * k) * sizeof *s->tangent);
  for (int i = 0; i < n; i++) s->tangent[i * k + i] = 1;
}

static int refuse(lag_sim *s) {
  const lag_model *m = s->scene->model;
  if (m->constraints)
    return lag_fail(s, LAG_EMETHOD,
                    "motions with constraints have no reverse mode yet; sensitivities (lag_sim_set_sensitivity) have "
                    "their derivatives");
  if (!m->linear || !m->linear->adjoint)
    return lag_fail(s, LAG_EMETHOD,
                    "gradients need the reverse sweep of the equations, which this program was built without: lagc "
                    "build --with derivatives");
  if (!s->method->adjoint || s->method->adjoint_size(&s->pb) == 0)
    return lag_fail(s, LAG_EMETHOD,
                    "method %s has no reverse mode for this model; rk4, rk45, dop853 and other explicit Runge-Kutta "
                    "methods have, and the Verlet family for separable models",
                    s->method->name);
  return LAG_OK;
}

int lag_sim_record(lag_sim *s) {
  if (!s) return LAG_EINVAL;
  if (s->run->begun != 0.0) return lag_fail(s, LAG_EINVAL, "the run has begun: record it from its first step");
  lag_tangent_free(s);
  int rc = refuse(s);
  rc = rc ? rc : lag_all_columns(s);
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

int lag_record_step(lag_sim *s, double t) {
  struct lag_record *r = s->record;
  if (s->pb.nslide)
    return lag_fail(s, LAG_EMETHOD, "at t = %s s the motion slides where a force jumps, which has no reverse mode yet",
                    LAG_TEXT(t));
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
  struct lag_record *r = s->record;
  size_t size = (size_t)s->pb.n * (size_t)s->tangent_columns;
  if (r->njumps == r->jump_room) {
    Jump *more = realloc(r->jump, (r->jump_room = 2 * r->jump_room + 16) * sizeof *more);
    if (!more) return lag_fail(s, LAG_ENOMEM, "out of memory");
    r->jump = more;
  }
  double *S = malloc(size * sizeof *S);
  if (!S) return lag_fail(s, LAG_ENOMEM, "out of memory");
  r->jump[r->njumps++] = (Jump){r->nsteps, memcpy(S, s->tangent, size * sizeof *S)};
  reset_columns(s);
  return LAG_OK;
}

/* ---- The sweep */

/* x[n]: dJ by the state; g[nu + np] by inputs and parameters, each as if it were free. Weights that are not used yet:
 * the first `rows`. */
typedef struct Sweep {
  lag_sim *s;
  int rows;
  const double *t, *weight;
  double *x, *g, *one, *step, *scratch;
} Sweep;

/* x := S^T x. */
static void back_over_jump(Sweep *w, const double *S) {
  int n = w->s->pb.n, k = w->s->tangent_columns;
  memset(w->one, 0, (size_t)n * sizeof *w->one);
  for (int i = 0; i < n; i++) {
    for (int c = 0; c < n; c++) w->one[c] += S[i * k + c] * w->x[i];
    for (int c = n; c < k; c++) w->g[w->s->pb.model->nu + c - n] += S[i * k + c] * w->x[i];
  }
  memcpy(w->x, w->one, (size_t)n * sizeof *w->x);
}

static void add(int n, const double *from, double *to) {
  for (int i = 0; i < n; i++) to[i] += from[i];
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
  if (s->run->have_step != 0.0 && s->run->t != s->run->step_t0 && !s->tangent_at_event) {
    put_step(s, s->run->t, w->step);
    rc = back_over_step(w, w->step);
  }
  for (size_t k = r->nsteps, j = r->njumps; rc == LAG_OK; k--) {
    for (; j > 0 && r->jump[j - 1].steps == k; j--) back_over_jump(w, r->jump[j - 1].S);
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
  size_t ups = (size_t)(nu + s->pb.model->np), stride = (size_t)s->record->stride,
         size = 2 * (size_t)n + ups + stride + (size_t)nmodes + s->method->adjoint_size(&s->pb);
  double calls = s->pb.rhs_calls, *block = calloc(size + 1, sizeof *block);
  if (!block) return lag_fail(s, LAG_ENOMEM, "out of memory");
  Sweep w = {s, rows, t, weight, .x = block, .one = block + n, .g = block + 2 * n};
  w.step = w.g + ups;
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
