/* Reverse mode of a run: the steps and jumps of its tangent, recorded, and the sweep back over them. Enters: a run with
 * a record; leaves: gradients by starts and parameters. Holds: memory is bounded, since earlier units of steps are
 * forgotten and repeated from marks; where a tangent would be multiplied by the derivative of
 * a step the record has the step, where by a matrix that matrix (flow_tangent.c decides both), so the
 * gradient is the transpose of sensitivities, up to rounding. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "core/rhs.h"

/* Matrices [n (n + np)] of changes of the state and by parameters: of jumps; of steps up to time t whose equations or
 * method have no reverse mode; of such a step up to a time within it, where the caller has looked at the state. AT: the
 * state [n] there of a step with reverse mode and constraints. */
typedef enum MatrixKind { OF_JUMP, OF_STEP, OF_PART, AT } MatrixKind;
typedef struct Matrix {
  MatrixKind kind;
  size_t steps; /* behind so many of the other steps */
  double t, *S;
} Matrix;

/* The run at the begin of a unit. */
typedef struct Mark {
  int unit;
  double *x;
} Mark;

/* A unit: as many steps as the record has room for. */
typedef struct Unit {
  double steps, t; /* of the run before it */
} Unit;

enum { MOST_MARKS = 64 };

/* Steps of the last unit: each [t0, dt, y0[n], kept by the method, modes[nmodes]], with constraints then y1[n]. */
struct lag_record {
  size_t nsteps, step_room, nmatrices, matrix_room;
  int stride;
  double *step;
  Matrix *matrix;
  size_t room, used; /* bytes of a unit */
  int silent, spent; /* 1: the run is repeated up to a unit; units have been repeated */
  int nunits, unit_room, nmarks, marks_every;
  Unit *unit;
  Mark mark[MOST_MARKS];
};

static void clear(struct lag_record *r) {
  for (size_t i = 0; i < r->nmatrices; i++) free(r->matrix[i].S);
  r->nmatrices = r->nsteps = r->used = 0;
}

void lag_record_free(lag_sim *s) {
  struct lag_record *r = s->record;
  if (r) clear(r), free(r->matrix), free(r->step), free(r->unit);
  for (int i = 0; r && i < r->nmarks; i++) free(r->mark[i].x);
  free(r);
  s->record = NULL;
}

/* The tangent begins anew: y changes by itself, and nothing by parameters yet. */
static void reset_columns(lag_sim *s) {
  int n = s->pb.n, k = s->tangent_columns;
  memset(s->tangent, 0, (size_t)(n * k) * sizeof *s->tangent);
  for (int i = 0; i < n; i++) s->tangent[i * k + i] = 1;
}

/* Whether the steps that the method makes now have no reverse mode of their own: within slides, with redundant
 * constraints, of methods without one. The derivative of each is then a matrix. */
static int needs_matrix(const lag_sim *s) {
  return s->pb.nslide || s->pb.redundant || !lag_adjoint_of(s->scene->model) || !s->method->adjoint ||
         s->method->adjoint_size(&s->pb) == 0;
}

static int is_held(const lag_sim *s) { return s->scene->model->constraints != NULL; }

/* Modes of a step, behind what its method keeps. */
static int modes_at(const lag_sim *s) {
  return 2 + s->pb.n + (s->method->kept ? (int)s->method->kept(&s->pb) : 0);
}

/* A mark of the present unit. */
static int put_mark(lag_sim *s) {
  struct lag_record *r = s->record;
  double *x = malloc((s->nsaved + 1) * sizeof *x);
  if (!x) return lag_fail(s, LAG_ENOMEM, "out of memory");
  lag_put_down(s, x);
  r->mark[r->nmarks++] = (Mark){r->nunits - 1, x};
  return LAG_OK;
}

/* Every other mark goes where there are as many as there may be. */
static void thin_marks(struct lag_record *r) {
  int kept = 0;
  r->marks_every *= 2;
  for (int i = 0; i < r->nmarks; i++) {
    if (r->mark[i].unit % r->marks_every == 0) r->mark[kept++] = r->mark[i];
    else free(r->mark[i].x);
  }
  r->nmarks = kept;
}

/* The steps from here on are another unit. */
static int begin_unit(lag_sim *s) {
  struct lag_record *r = s->record;
  if (r->nunits == r->unit_room) {
    Unit *more = realloc(r->unit, (size_t)(r->unit_room = 2 * r->unit_room + 16) * sizeof *more);
    if (!more) return lag_fail(s, LAG_ENOMEM, "out of memory");
    r->unit = more;
  }
  r->unit[r->nunits++] = (Unit){s->run->steps, s->run->t};
  clear(r);
  if (r->nmarks == MOST_MARKS / 2) thin_marks(r); /* the others are for the way back */
  return (r->nunits - 1) % r->marks_every ? LAG_OK : put_mark(s);
}

int lag_record_cut(lag_sim *s) {
  const struct lag_record *r = s->record;
  int repeats = !(s->method->flags & (LAG_METHOD_NO_SAVE | LAG_METHOD_STEPS_TO));
  return s->run->have_step == 0.0 && repeats && !r->silent && r->used > r->room ? begin_unit(s) : LAG_OK;
}

int lag_sim_record(lag_sim *s) {
  const size_t room = (size_t)1 << 26;
  return lag_sim_record_within(s, room);
}

int lag_sim_record_within(lag_sim *s, size_t bytes) {
  if (!s) return LAG_EINVAL;
  if (s->run->begun != 0.0) return lag_fail(s, LAG_EINVAL, "the run has begun: record it from its first step");
  lag_tangent_free(s);
  int rc = lag_all_columns(s);
  if (rc) return lag_tangent_free(s), rc;
  reset_columns(s);
  s->record = calloc(1, sizeof *s->record);
  if (!s->record) return lag_tangent_free(s), lag_fail(s, LAG_ENOMEM, "out of memory");
  s->record->stride = modes_at(s) + s->scene->model->nmodes + (is_held(s) ? s->pb.n : 0);
  s->record->room = bytes;
  s->record->marks_every = 1;
  return begin_unit(s);
}

/* step[stride] := the last step up to t. */
static void put_step(const lag_sim *s, double t, double *step) {
  step[0] = s->run->step_t0;
  step[1] = s->method->span(s->method_work, &s->pb, t);
  memcpy(step + 2, s->y0, (size_t)s->pb.n * sizeof *step);
  if (s->method->keep) s->method->keep(s->method_work, &s->pb, step + 2 + s->pb.n);
  memcpy(step + modes_at(s), s->hold + s->pb.model->nu, (size_t)s->pb.model->nmodes * sizeof *step);
  if (is_held(s))
    memcpy(step + modes_at(s) + s->pb.model->nmodes, s->now, (size_t)s->pb.n * sizeof *step);
}

static int keep_matrix(lag_sim *s, MatrixKind kind, double t, const double *Y) {
  struct lag_record *r = s->record;
  size_t size = (size_t)s->pb.n * (size_t)(kind == AT ? 1 : s->tangent_columns);
  if (r->silent) return LAG_OK;
  if (r->nmatrices == r->matrix_room) {
    Matrix *more = realloc(r->matrix, (r->matrix_room = 2 * r->matrix_room + 16) * sizeof *more);
    if (!more) return lag_fail(s, LAG_ENOMEM, "out of memory");
    r->matrix = more;
  }
  double *S = malloc(size * sizeof *S);
  if (!S) return lag_fail(s, LAG_ENOMEM, "no memory for the steps of a gradient: end the run before");
  r->matrix[r->nmatrices++] = (Matrix){kind, r->nsteps, t, memcpy(S, Y, size * sizeof *S)};
  r->used += size * sizeof *S;
  return LAG_OK;
}

int lag_record_step(lag_sim *s, double t) {
  struct lag_record *r = s->record;
  if (r->silent) return LAG_OK;
  if (needs_matrix(s)) {
    int rc = lag_tangent_over(s, t, s->tangent);
    rc = rc ? rc : keep_matrix(s, OF_STEP, t, s->tangent);
    reset_columns(s);
    return rc;
  }
  int none = lag_tangent_exists(s, t);
  if (none) return none;
  if (r->nsteps == r->step_room) {
    size_t room = r->step_room ? 2 * r->step_room : 256;
    double *more = realloc(r->step, room * (size_t)r->stride * sizeof *more);
    if (!more) return lag_fail(s, LAG_ENOMEM, "no memory for the steps of a gradient: end the run before");
    r->step = more, r->step_room = room;
  }
  put_step(s, t, r->step + r->nsteps++ * (size_t)r->stride);
  r->used += (size_t)r->stride * sizeof *r->step;
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
  if (!is_within(s) || s->record->silent) return LAG_OK;
  if (!needs_matrix(s)) return is_held(s) ? keep_matrix(s, AT, s->run->t, s->now) : LAG_OK;
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
  double end; /* time of the run */
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

/* Modes of a step. */
static void put_modes(lag_sim *s, const double *step) {
  memcpy(s->hold + s->pb.model->nu, step + modes_at(s), (size_t)s->pb.model->nmodes * sizeof *step);
  lag_switch_count(s);
}

static void add(int n, const double *from, double *to) {
  for (int i = 0; i < n; i++) to[i] += from[i];
}

/* Adds the weights at time t to x: up to rounding at the end of a step or of the run, which an event may have moved by
 * one number, exactly at a place within a step. */
static void add_weights(Sweep *w, double t, int within, double *x) {
  int n = w->s->pb.n;
  double rounding = within && t != w->end ? 0 : 4 * DBL_EPSILON * fabs(t);
  for (; w->rows > 0 && fabs(w->t[w->rows - 1] - t) <= rounding; w->rows--)
    add(n, w->weight + (size_t)(w->rows - 1) * (size_t)n, x);
}

/* The projection onto constraints at the end of a step, and the step (t0, dt). */
static int back_from(Sweep *w, const double *step, double dt, const double *y1, double *x) {
  lag_problem *pb = &w->s->pb;
  int rc = is_held(w->s) ? lag_project_back(pb, step[0] + dt, y1, x, w->g, w->scratch) : LAG_OK;
  return rc ? rc : w->s->method->adjoint(pb, step[0], dt, step + 2, x, w->g, w->scratch);
}

/* The weights at a state within a step. */
static int back_from_place(Sweep *w, const Matrix *m, const double *step) {
  memset(w->one, 0, (size_t)w->s->pb.n * sizeof *w->one);
  add_weights(w, m->t, 1, w->one);
  put_modes(w->s, step);
  int rc = back_from(w, step, m->t - step[0], m->S, w->one);
  add(w->s->pb.n, w->one, w->x);
  return rc;
}

/* A jump, or a step, or a part of one: weights at its end belong to it; behind a jump those behind its time. */
static void back_over(Sweep *w, const Matrix *m) {
  int n = w->s->pb.n;
  for (; m->kind == OF_JUMP && w->rows > 0 && (w->t[w->rows - 1] - m->t) * w->s->pb.dir > 0; w->rows--)
    add(n, w->weight + (size_t)(w->rows - 1) * (size_t)n, w->x);
  if (m->kind == OF_STEP) add_weights(w, m->t, 0, w->x);
  if (m->kind != OF_PART) {
    back_over_matrix(w, m->S, w->x);
    return;
  }
  memset(w->one, 0, (size_t)n * sizeof *w->one);
  add_weights(w, m->t, 1, w->one);
  back_over_matrix(w, m->S, w->one);
  add(n, w->one, w->x);
}

/* The step (t0, dt), and a shorter one for each weight within it: however short, not for one at t0. */
static int back_over_step(Sweep *w, const double *step) {
  lag_problem *pb = &w->s->pb;
  int n = pb->n, rc;
  double t0 = step[0], dt = step[1], rounding = 4 * DBL_EPSILON * (fabs(t0) + fabs(t0 + dt));
  put_modes(w->s, step);
  for (; w->rows > 0 && fabs(w->t[w->rows - 1] - t0 - dt) <= rounding && fabs(w->t[w->rows - 1] - t0) > 0; w->rows--)
    add(n, w->weight + (size_t)(w->rows - 1) * (size_t)n, w->x);
  rc = back_from(w, step, dt, step + modes_at(w->s) + pb->model->nmodes, w->x);
  for (; rc == LAG_OK && !is_held(w->s) && w->rows > 0 && (w->t[w->rows - 1] - t0) * pb->dir > rounding; w->rows--) {
    memcpy(w->one, w->weight + (size_t)(w->rows - 1) * (size_t)n, (size_t)n * sizeof *w->one);
    rc = back_from(w, step, w->t[w->rows - 1] - t0, NULL, w->one);
    add(n, w->one, w->x);
  }
  return rc;
}

/* The steps that are recorded. */
static int back_over_record(Sweep *w) {
  lag_sim *s = w->s;
  const struct lag_record *r = s->record;
  int rc = LAG_OK;
  for (size_t k = r->nsteps, j = r->nmatrices; rc == LAG_OK; k--) {
    for (; j > 0 && r->matrix[j - 1].steps == k && rc == LAG_OK; j--) {
      const Matrix *m = &r->matrix[j - 1];
      if (m->kind != AT) back_over(w, m);
      else rc = back_from_place(w, m, k < r->nsteps ? r->step + k * (size_t)r->stride : w->step);
    }
    if (rc) break;
    if (k == 0) break;
    rc = back_over_step(w, r->step + (k - 1) * (size_t)r->stride);
  }
  return rc;
}

/* ---- Units that are recorded again */

/* The run from a mark to the begin of a unit. */
static int repeat_to(Sweep *w, const double *mark, int unit) {
  lag_sim *s = w->s;
  struct lag_record *r = s->record;
  clear(r);
  lag_take_up(s, mark);
  reset_columns(s);
  s->tangent_at_event = s->tangent_meets = s->tangent_moves = 0;
  r->silent = 1;
  int rc = unit == 0 ? LAG_OK : lag_run_to_step(s, r->unit[unit].steps, w->end);
  r->silent = 0;
  return rc;
}

/* Records the unit that begins here: with pauses where weights are. */
static int repeat_unit(Sweep *w, int unit) {
  lag_sim *s = w->s;
  struct lag_record *r = s->record;
  const Unit *next = &r->unit[unit + 1];
  int rc = LAG_OK;
  r->room = (size_t)-1;
  for (int k = 0; k < w->rows && rc == LAG_OK; k++)
    if ((w->t[k] - s->run->t) * s->pb.dir > 0 && (next->t - w->t[k]) * s->pb.dir > 0) rc = lag_sim_advance(s, w->t[k]);
  return rc ? rc : lag_run_to_step(s, next->steps, w->end);
}

/* Units to advance before the next mark, of l, with c marks left. */
static int split_of(int l, int c) {
  double before = 1; /* (c + r - 1 over c) */
  for (int r = 1;; r++) {
    double all = before * (c + r) / r;
    if (all >= l) return before < l - 1 ? (int)before : l - 1;
    before = all;
  }
}

/* Units first to last, from a mark at the first, with room for c more marks: the fewest repetitions for their number
 * (A. Griewank, A. Walther, ACM Trans. Math. Softw. 26 (2000) 19, DOI 10.1145/347837.347846). */
static int back_over_units(Sweep *w, const double *mark, int first, int last, int c) {
  int rc = LAG_OK;
  while (last >= first && rc == LAG_OK) {
    if (last > first && c > 0) {
      int at = first + split_of(last - first + 1, c);
      double *x = malloc((w->s->nsaved + 1) * sizeof *x);
      rc = x ? repeat_to(w, mark, at) : LAG_ENOMEM;
      if (rc == LAG_OK) lag_put_down(w->s, x), rc = back_over_units(w, x, at, last, c - 1);
      free(x);
      last = at - 1;
    } else {
      rc = repeat_to(w, mark, last);
      rc = rc ? rc : repeat_unit(w, last);
      rc = rc ? rc : back_over_record(w);
      last--;
    }
  }
  return rc;
}

/* All units but the last, which is recorded. The run is as before afterwards, but for its record. */
static int back_over_marks(Sweep *w) {
  lag_sim *s = w->s;
  struct lag_record *r = s->record;
  int (*on_step)(void *, const lag_sim *) = s->on_step;
  lag_event_fn *on_event = s->on_event;
  double *x = malloc((s->nsaved + 1) * sizeof *x);
  int rc = x ? LAG_OK : LAG_ENOMEM, last = r->nunits - 2;
  if (x) lag_put_down(s, x);
  s->on_step = NULL, s->on_event = NULL;
  if (r->nmarks && r->mark[r->nmarks - 1].unit > last) free(r->mark[--r->nmarks].x);
  for (; r->nmarks > 0 && rc == LAG_OK; free(r->mark[--r->nmarks].x)) {
    const Mark *m = &r->mark[r->nmarks - 1];
    rc = back_over_units(w, m->x, m->unit, last, MOST_MARKS - r->nmarks);
    last = m->unit - 1;
  }
  s->on_step = on_step, s->on_event = on_event;
  if (x) lag_take_up(s, x);
  free(x);
  r->spent = 1;
  return rc;
}

static int sweep(Sweep *w) {
  lag_sim *s = w->s;
  int n = s->pb.n, rc = LAG_OK;
  w->end = s->run->t;
  if (is_within(s) && !needs_matrix(s)) {
    put_step(s, s->run->t, w->step);
    if (!is_held(s)) rc = back_over_step(w, w->step); /* else its places are in the record */
  }
  rc = rc ? rc : back_over_record(w);
  if (rc == LAG_OK && s->record->nunits > 1) rc = back_over_marks(w);
  for (; rc == LAG_OK && w->rows > 0 && w->t[w->rows - 1] == s->scene->t0; w->rows--)
    add(n, w->weight + (size_t)(w->rows - 1) * (size_t)n, w->x);
  return rc || w->rows == 0 ? rc
                            : lag_fail(s, LAG_EMETHOD,
                                       "the weights of a gradient at t = %s s lie at no step of the run",
                                       LAG_TEXT(w->t[w->rows - 1]));
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
  double last = nextafter(r->t, s->pb.dir * HUGE_VAL); /* behind an event at the end */
  for (int k = 0; k < rows; k++)
    if (!((t[k] - (k ? t[k - 1] : s->scene->t0)) * s->pb.dir >= 0 && (last - t[k]) * s->pb.dir >= 0))
      return lag_fail(s, LAG_EINVAL,
                      "time %d of a gradient, %s s, is not in order within the run, which is at t = %s s", k,
                      LAG_TEXT(t[k]), LAG_TEXT(r->t));
  return LAG_OK;
}

int lag_sim_gradient(lag_sim *s, int rows, const double *t, const double *weight, double *by_start, double *by_p) {
  if (!s || rows < 0 || !t || !weight || !by_start || !by_p) return LAG_EINVAL;
  if (!s->record)
    return lag_fail(s, LAG_EINVAL, "this run keeps no steps: lag_sim_record before its first advance");
  if (s->record->spent)
    return lag_fail(s, LAG_EINVAL, "a gradient of so many steps can be taken once: record another run");
  int rc = check_rows(s, rows, t), n = s->pb.n, nu = s->pb.model->nu, nmodes = s->pb.model->nmodes;
  if (rc) return rc;
  size_t np = (size_t)s->pb.model->np, stride = (size_t)s->record->stride,
         held = lag_project_back_size(&s->pb), step = s->method->adjoint ? s->method->adjoint_size(&s->pb) : 0,
         scratch = (size_t)n > step ? (size_t)n : step,
         size = 2 * (size_t)n + (size_t)nu + 2 * np + stride + (size_t)nmodes + (scratch > held ? scratch : held);
  double calls = s->pb.rhs_calls, *block = calloc(size + 1, sizeof *block);
  if (!block) return lag_fail(s, LAG_ENOMEM, "out of memory");
  Sweep w = {.s = s, .rows = rows, .t = t, .weight = weight, .x = block, .one = block + n, .g = block + 2 * n};
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
