/* Multiple shooting (H. G. Bock, in Modelling of Chemical Reaction Systems, 1981, 102): a record has parts, and the
 * states where they begin are unknowns, too. Enters: first values, whose motion says how fast small changes grow;
 * leaves: targets and nodes with gaps of a millionth of the state at most. Holds: a step solves linearised residuals
 * and gaps by least squares, node after node, by reflections, so that no growth over the whole record enters; time and
 * memory grow with the number of parts. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/fit_residuals.h"
#include "core/core.h"
#include "numeric/dense.h"
#include "numeric/release.h"

/* Weight of gaps in the end: over a chaotic record errors of steps grow to more than this. Stated errors include it. */
static const double tightest = 1e6;

/* ---- Nodes */

static const double longest_part = 0.3; /* growth of small changes over a part, as a logarithm */

/* Largest change of the state in sizes of its components, for changes of the start of that size, as a logarithm. */
static double growth_of(const FitNodes *w, const double *Y) {
  double most = 0;
  for (int i = 0; i < w->ns; i++)
    for (int j = 0; j < w->ns; j++) most = fmax(most, fabs(Y[i * w->ns + j]) * w->unit[j] / w->unit[i]);
  return isfinite(most) ? log(fmax(most, 1)) : log(DBL_MAX);
}

/* Growth over record k, and over its first half. Takes the sizes of the state, unless Y, [ns ns], is there. */
static int follow_record(Fit *f, int k, double *Y, double growth[2]) {
  FitNodes *w = f->nodes;
  lag_sim *sim = lag_fit_simulation(f, k, -1, 0);
  int first = f->first[k], end = f->first[k + 1], rc = sim ? LAG_OK : LAG_EINVAL;
  if (rc == LAG_OK && Y) rc = lag_sim_set_tangent(sim, w->ns, NULL);
  for (int i = first; i < end && rc == LAG_OK; i++) {
    rc = f->t[i] > lag_sim_time(sim) ? lag_sim_advance(sim, f->t[i]) : LAG_OK;
    for (int c = 0; c < w->ns && !Y && rc == LAG_OK; c++)
      w->unit[c] = fmax(w->unit[c], fabs(lag_sim_state_value(sim, c)));
    int half = i == (first + end) / 2;
    if (Y && rc == LAG_OK && (half || i == end - 1) && (rc = lag_sim_tangent(sim, Y)) == LAG_OK)
      growth[half] = growth_of(w, Y);
  }
  if (rc && sim) lag_fit_fail(f, rc < 0 ? rc : LAG_EDOMAIN, lag_sim_message(sim));
  lag_sim_free(sim);
  return rc > 0 ? LAG_EDOMAIN : rc;
}

/* Parts of a record: as asked for, or by the growth. Changes that grow with a power of the time need none. */
static int count_parts(const Fit *f, int k, const double growth[2], int force) {
  const double far = 9, power = 3; /* 1e4 times; 20 times in the second half, which no power of the time below 4 has */
  int rows = f->first[k + 1] - f->first[k], most = rows / 2, by_growth = (int)ceil(growth[0] / longest_part);
  int exponential = growth[0] > far && growth[0] - growth[1] > power;
  int parts = f->parts ? f->parts : exponential ? by_growth : force ? (by_growth > 8 ? by_growth : 8) : 1;
  return parts < 1 || most < 1 ? 1 : parts > most ? most : parts;
}

/* Marks the first rows of the parts of record k, which have equal numbers of rows. */
static void mark_parts(Fit *f, int k, int parts) {
  FitNodes *w = f->nodes;
  int first = f->first[k], rows = f->first[k + 1] - first;
  for (int p = 1; p < parts; p++) {
    int i = first + (int)((long long)rows * p / parts);
    w->row[w->n] = i;
    w->at[i] = w->n++;
  }
}

/* State that a part cannot know which begins within a record. */
static const char *memory_of(const lag_sim *sim) {
  const lag_model *m = sim->scene->model;
  for (int k = 0; k < m->nev; k++)
    if (lag_is_kick(m, k)) return "kicks are counted from the start";
  if (m->nmodes) return "conditional constraints keep their state";
  return sim->scene->nexact ? "closed forms know the start" : NULL;
}

static int allocate_states(Fit *f) {
  FitNodes *w = f->nodes;
  size_t all = (size_t)w->n * (size_t)w->ns;
  w->y = calloc(all + 1, sizeof *w->y);
  w->gap = calloc(all + 1, sizeof *w->gap);
  w->by = calloc(all * (size_t)lag_fit_width(f) + 1, sizeof *w->by);
  return w->y && w->gap && w->by ? LAG_OK : lag_fit_fail(f, LAG_ENOMEM, "out of memory");
}

static int measure_records(Fit *f, int force, double *Y) {
  FitNodes *w = f->nodes;
  double growth[2] = {0, 0};
  int rc = LAG_OK;
  for (int k = 0; k < f->nrecords && rc == LAG_OK; k++) rc = follow_record(f, k, NULL, growth);
  for (int i = 0; i < w->ns; i++)
    if (!(w->unit[i] > 0)) w->unit[i] = 1;
  for (int k = 0; k < f->nrecords && rc == LAG_OK; k++) {
    growth[0] = growth[1] = 0;
    /* a motion without a tangent is one part, unless parts are asked for */
    int followed = f->parts ? LAG_OK : follow_record(f, k, Y, growth);
    if (followed && force) rc = followed;
    mark_parts(f, k, followed ? 1 : count_parts(f, k, growth, force));
  }
  return rc;
}

int lag_fit_place_nodes(Fit *f, int force) {
  if (f->parts == 1) return LAG_OK;
  lag_sim *sim = f->fresh(f->context);
  FitNodes *w = calloc(1, sizeof *w);
  if (!sim || !w) return lag_sim_free(sim), free(w), lag_fit_fail(f, LAG_ENOMEM, "out of memory");
  const char *memory = memory_of(sim);
  w->ns = 2 * sim->pb.nq + sim->pb.nz;
  lag_sim_free(sim);
  if (memory) {
    free(w);
    if (!f->parts) return LAG_OK;
    snprintf(f->why, sizeof f->why, "a record cannot be fitted in parts, since %s; leave out --segments", memory);
    return LAG_EINVAL;
  }
  w->at = malloc((size_t)(f->nrows + 1) * sizeof *w->at);
  w->row = calloc((size_t)f->nrows + 1, sizeof *w->row);
  w->unit = calloc((size_t)w->ns + 1, sizeof *w->unit);
  double *Y = calloc((size_t)(w->ns * w->ns) + 1, sizeof *Y);
  int rc = w->at && w->row && w->unit && Y ? LAG_OK : lag_fit_fail(f, LAG_ENOMEM, "out of memory");
  for (int i = 0; i < f->nrows && rc == LAG_OK; i++) w->at[i] = -1;
  f->nodes = w;
  if (rc == LAG_OK) rc = measure_records(f, force, Y);
  free(Y);
  if (rc == LAG_OK && w->n > 0) return allocate_states(f);
  lag_fit_nodes_free(f);
  return rc;
}

void lag_fit_nodes_free(Fit *f) {
  FitNodes *w = f->nodes;
  f->nodes = NULL;
  if (!w) return;
  lag_free_all(w->at, w->row, w->unit, w->y, w->gap, w->by, w);
}

double lag_fit_widest_gap(const Fit *f) {
  double widest = lag_largest(f->nodes->n * f->nodes->ns, f->nodes->gap);
  return widest;
}

/* ---- Linear least squares */

/* Rows of a least-squares problem, of which only what matters is kept: where it is full it becomes a triangle. */
typedef struct Rows {
  int n, room, columns;
  double *a;
} Rows;

/* Householder's reflections of rows below each pivot. */
static void triangularise(Rows *b) {
  int columns = b->columns, n = b->n < columns ? b->n : columns;
  for (int c = 0; c < n; c++) {
    double size = 0, *top = b->a + c * columns;
    for (int i = c; i < b->n; i++) size = hypot(size, b->a[i * columns + c]);
    if (size == 0.0) continue;
    double diagonal = top[c] > 0 ? -size : size, head = top[c] - diagonal, beta = -1 / (diagonal * head);
    for (int j = c + 1; j < columns; j++) {
      double sum = head * top[j];
      for (int i = c + 1; i < b->n; i++) sum += b->a[i * columns + c] * b->a[i * columns + j];
      sum *= beta;
      top[j] -= sum * head;
      for (int i = c + 1; i < b->n; i++) b->a[i * columns + j] -= sum * b->a[i * columns + c];
    }
    top[c] = diagonal;
    for (int i = c + 1; i < b->n; i++) b->a[i * columns + c] = 0;
  }
  b->n = n;
}

static double *new_row(Rows *b) {
  if (b->n == b->room) triangularise(b);
  return memset(b->a + b->n++ * b->columns, 0, (size_t)b->columns * sizeof *b->a);
}

/* x[n] := the solution of the triangle's first n rows less `right` at their end. */
static void solve_triangle(int n, int columns, const double *a, double *x) {
  for (int i = n - 1; i >= 0; i--) {
    for (int j = i + 1; j < n; j++) x[i] -= a[i * columns + j] * x[j];
    x[i] = a[i * columns + i] != 0.0 ? x[i] / a[i * columns + i] : 0;
  }
}

/* ---- A step: nodes are eliminated one after the other */

typedef struct Step {
  Fit *f;
  const double *r, *J, *gap; /* residuals, their derivatives, gaps */
  double damping;
  Rows top, stage; /* [targets, right]; [state of the node, of the next one, targets, right] */
  double *kept;    /* [nodes][ns columns of stage] rows that give the state from what follows */
  double *dx, *dy; /* [targets], [n ns] */
  double *room;
} Step;

static int step_open(Step *s, Fit *f) {
  size_t n = (size_t)f->n, ns = (size_t)f->nodes->ns, wide = 2 * ns + n + 1, nodes = (size_t)f->nodes->n;
  *s = (Step){.f = f, .gap = f->nodes->gap};
  s->top = (Rows){0, 3 * (int)n + 8, (int)n + 1, NULL};
  s->stage = (Rows){0, 3 * (int)wide, (int)wide, NULL};
  size_t top = (size_t)(s->top.room * s->top.columns), stage = (size_t)(s->stage.room * s->stage.columns);
  s->room = calloc(top + stage + nodes * ns * (wide + 1) + n + 1, sizeof *s->room);
  if (!s->room) return lag_fit_fail(f, LAG_ENOMEM, "out of memory");
  s->top.a = s->room;
  s->stage.a = s->top.a + top;
  s->kept = s->stage.a + stage;
  s->dy = s->kept + nodes * ns * wide;
  s->dx = s->dy + nodes * ns;
  return LAG_OK;
}

/* A residual r with derivatives d by targets and the part's node. */
static void put_residual(Step *s, int own, double r, const double *d) {
  int n = s->f->n, ns = s->f->nodes->ns;
  double *row = new_row(own < 0 ? &s->top : &s->stage), *targets = own < 0 ? row : row + 2 * ns;
  memcpy(targets, d, (size_t)n * sizeof *d);
  if (own >= 0) memcpy(row, d + n, (size_t)ns * sizeof *d);
  targets[n] = -r;
}

/* The gaps between a part and the next. */
static void put_gaps(Step *s, int own, int next) {
  const FitNodes *w = s->f->nodes;
  int n = s->f->n, ns = w->ns;
  for (int i = 0; i < ns; i++) {
    double *row = new_row(&s->stage), *targets = row + 2 * ns;
    const double *by = w->by + (next * ns + i) * lag_fit_width(s->f);
    for (int j = 0; j < ns && own >= 0; j++) row[j] = w->tie * by[n + j];
    row[ns + i] = -w->tie;
    for (int j = 0; j < n; j++) targets[j] = w->tie * by[j];
    targets[n] = -w->tie * s->gap[next * ns + i];
  }
}

/* Keeps the rows that give the state of the node; the others move on to the next one, at the end to the targets. */
static void eliminate_node(Step *s, int own, int next) {
  int ns = s->f->nodes->ns, wide = s->stage.columns, first = 0, to = 0;
  if (own >= 0) {
    while (s->stage.n < ns) new_row(&s->stage);
    triangularise(&s->stage);
    memcpy(s->kept + own * ns * wide, s->stage.a, (size_t)(ns * wide) * sizeof *s->kept);
    first = ns;
  }
  for (int i = first; i < s->stage.n; i++) {
    const double *from = s->stage.a + i * wide;
    if (next < 0) memcpy(new_row(&s->top), from + 2 * ns, (size_t)s->top.columns * sizeof *from);
    else {
      double *row = s->stage.a + to++ * wide;
      memmove(row, from + ns, (size_t)ns * sizeof *row);
      memmove(row + 2 * ns, from + 2 * ns, (size_t)s->top.columns * sizeof *row);
      memset(row + ns, 0, (size_t)ns * sizeof *row);
    }
  }
  s->stage.n = to;
}

static void put_damping(Step *s, Rows *b, int n) {
  for (int i = 0; i < n && s->damping > 0; i++) new_row(b)[i] = s->damping;
}

static int values_in(const Fit *f, int i, int end) {
  int m = 0;
  for (int e = i * f->ncolumns; e < end * f->ncolumns; e++) m += !isnan(f->data[e]);
  return m;
}

/* The triangle of the targets, with all nodes eliminated; springs: as many rows more behind the residuals. */
static void eliminate(Step *s, int springs) {
  const Fit *f = s->f;
  int at = 0, width = lag_fit_width(f);
  s->top.n = 0;
  for (int k = 0; k < f->nrecords; k++) {
    int end = lag_fit_end_row(f, k);
    s->stage.n = 0;
    for (int i = f->first[k], after; i < end; i = after) {
      after = lag_fit_part_end(f, i, end);
      int own = f->nodes->at[i], next = after < end ? f->nodes->at[after] : -1;
      if (next >= 0) put_gaps(s, own, next); /* first, since they are large */
      for (int m = values_in(f, i, after); m > 0; m--, at++) put_residual(s, own, s->r[at], s->J + at * width);
      if (own >= 0) put_damping(s, &s->stage, f->nodes->ns);
      eliminate_node(s, own, next);
    }
  }
  for (; at < f->nvalues + springs; at++) put_residual(s, -1, s->r[at], s->J + at * width);
  put_damping(s, &s->top, f->n);
  while (s->top.n < f->n) new_row(&s->top);
  triangularise(&s->top);
}

/* dx, dy := the step. */
static void take_step(Step *s) {
  const Fit *f = s->f;
  const FitNodes *w = f->nodes;
  int n = f->n, ns = w->ns, wide = s->stage.columns;
  eliminate(s, n);
  for (int j = 0; j < n; j++) s->dx[j] = s->top.a[j * (n + 1) + n];
  solve_triangle(n, n + 1, s->top.a, s->dx);
  memset(s->dy, 0, (size_t)(w->n * ns) * sizeof *s->dy);
  for (int k = f->nrecords - 1, own = w->n - 1; k >= 0; k--) {
    int end = lag_fit_end_row(f, k);
    for (; own >= 0 && w->row[own] >= f->first[k]; own--) {
      if (w->row[own] >= end) continue;
      double *y = s->dy + own * ns;
      int last = own + 1 == w->n || w->row[own + 1] >= end;
      for (int i = 0; i < ns; i++) {
        const double *row = s->kept + (own * ns + i) * wide;
        y[i] = row[wide - 1];
        for (int j = 0; j < ns && !last; j++) y[i] -= row[ns + j] * y[ns + j];
        for (int j = 0; j < n; j++) y[i] -= row[2 * ns + j] * s->dx[j];
      }
      solve_triangle(ns, wide, s->kept + own * ns * wide, y);
    }
  }
}

int lag_fit_eliminate(Fit *f, const double *r, const double *J, double *triangle) {
  Step s;
  int rc = step_open(&s, f), n = f->n;
  s.r = r, s.J = J;
  if (rc == LAG_OK) eliminate(&s, 0);
  for (int i = 0; i < n && rc == LAG_OK; i++)
    for (int j = 0; j < n; j++) triangle[i * n + j] = j < i ? 0 : s.top.a[i * (n + 1) + j];
  free(s.room);
  return rc;
}

/* ---- The search (D. W. Marquardt, J. SIAM 11 (1963) 431) */

typedef struct Shoot {
  Step step;
  double *r, *J, *gap, *x, *y; /* residuals and gaps; a trial of x; nodes before it */
  double squares, stiff;
  double pull; /* of springs to f->centre; 0: weak ones to where the search is */
} Shoot;

static int shoot_open(Shoot *s, Fit *f) {
  size_t m = (size_t)(lag_fit_count_values(f, 1) + f->n), all = (size_t)(f->nodes->n * f->nodes->ns);
  int rc = step_open(&s->step, f);
  s->r = calloc(m * (1 + (size_t)lag_fit_width(f)) + 2 * all + (size_t)f->n + 1, sizeof *s->r);
  if (rc || !s->r) return rc ? rc : lag_fit_fail(f, LAG_ENOMEM, "out of memory");
  s->J = s->r + m;
  s->gap = s->J + m * (size_t)lag_fit_width(f);
  s->y = s->gap + all;
  s->x = s->y + all;
  s->step.r = s->r, s->step.J = s->J, s->step.gap = s->gap;
  return LAG_OK;
}

static void shoot_free(Shoot *s) {
  lag_free_all(s->r, s->step.room);
}

/* Squares of the residuals r and of the gaps of nodes that count. */
static double squares_of(const Fit *f, const double *r) {
  const FitNodes *w = f->nodes;
  double sum = lag_dot(f->nvalues + f->n, r, r);
  for (int k = 0; k < f->nrecords; k++)
    for (int node = 0, end = lag_fit_end_row(f, k); node < w->n; node++)
      for (int i = node * w->ns; i < (node + 1) * w->ns && w->row[node] >= f->first[k] && w->row[node] < end; i++) {
        double gap = w->tie * w->gap[i];
        sum += gap * gap;
      }
  return sum;
}

/* Derivatives at x, and the largest of residuals. */
static int linearise(Fit *f, Shoot *s, const double *x) {
  const FitNodes *w = f->nodes;
  int rc = lag_fit_residuals(f, x, s->r, s->J), width = lag_fit_width(f);
  if (rc) return rc;
  memcpy(s->gap, w->gap, (size_t)(w->n * w->ns) * sizeof *s->gap);
  s->squares = squares_of(f, s->r);
  s->stiff = 0;
  for (int j = 0; j < width; j++) {
    double sum = 0;
    for (int i = 0; i < f->nvalues; i++) sum += s->J[i * width + j] * s->J[i * width + j];
    s->stiff = fmax(s->stiff, sqrt(sum));
  }
  return LAG_OK;
}

/* One step with less and less length, until one gains. Returns the part of the squares gained; 0: none does. */
static double gain(Fit *f, Shoot *s, double *damping, double *x, double *trial) {
  FitNodes *w = f->nodes;
  int all = w->n * w->ns;
  const double least = 1e-10, most = 1e4; /* of the stiffest direction */
  memcpy(s->y, w->y, (size_t)all * sizeof *s->y);
  for (; *damping < most; *damping *= 5) {
    s->step.damping = *damping * s->stiff;
    take_step(&s->step);
    for (int j = 0; j < f->n; j++) s->x[j] = x[j] + s->step.dx[j];
    for (int i = 0; i < all; i++) w->y[i] = s->y[i] + w->unit[i % w->ns] * s->step.dy[i];
    double now = lag_fit_residuals(f, s->x, trial, NULL) ? HUGE_VAL : squares_of(f, trial);
    if (now < s->squares) {
      memcpy(x, s->x, (size_t)f->n * sizeof *x);
      *damping = fmax(*damping / 10, least);
      return 1 - now / s->squares;
    }
    memcpy(w->y, s->y, (size_t)all * sizeof *s->y);
  }
  return 0;
}

/* Steps until one gains less than `least` of the squares. */
static int descend(Fit *f, Shoot *s, double least, int most, double *x) {
  const double soft = 1e-6; /* springs, as of a search in one part */
  double damping = 1e-3, gained = 1;
  int m = lag_fit_count_values(f, 1), rc = LAG_OK;
  double *trial = calloc((size_t)(m + f->n), sizeof *trial);
  f->converged = 0;
  if (!trial) return lag_fit_fail(f, LAG_ENOMEM, "out of memory");
  const int held = s->pull > 0;
  f->pull = s->pull;
  if (!held) memcpy(f->centre, x, (size_t)f->n * sizeof *x);
  for (int k = 0; k < most && !f->converged && (rc = linearise(f, s, x)) == LAG_OK; k++) {
    if (!held) {
      f->pull = soft * s->stiff;
      memcpy(f->centre, x, (size_t)f->n * sizeof *x);
      if (k == 0 && (rc = linearise(f, s, x)) != LAG_OK) break;
    }
    gained = gain(f, s, &damping, x, trial);
    f->steps++;
    f->converged = gained < least;
  }
  free(trial);
  return rc;
}

/* Parts of the record that has most. */
static int most_parts(const Fit *f) {
  int most = 0;
  for (int k = 0; k < f->nrecords; k++) {
    int parts = 1;
    for (int i = f->first[k]; i < f->first[k + 1]; i++) parts += f->nodes->at[i] >= 0;
    most = parts > most ? parts : most;
  }
  return most;
}

/* From the first part to all. Gaps of a hundredth of the state are cheap while parameters, held near their begin by
 * weak springs, are far off. */
static int grow(Fit *f, Shoot *s, int all, double *x) {
  const double part = 1e-3;
  enum { FEW = 6 };
  FitNodes *w = f->nodes;
  int rc = LAG_OK;
  memcpy(f->centre, x, (size_t)f->n * sizeof *x);
  s->pull = 2;
  w->tie = 1e2;
  for (w->active = 1; w->active < all && rc == LAG_OK; w->active++)
    if ((rc = descend(f, s, part, FEW, x)) == LAG_OK) rc = lag_fit_residuals(f, x, s->r, NULL); /* the next nodes */
  s->pull = 0;
  for (; w->tie < tightest && rc == LAG_OK; w->tie *= 10) rc = descend(f, s, part, f->most, x);
  return rc;
}

int lag_fit_shoot(Fit *f, int grows, double *x) {
  const double least = 1e-9;
  FitNodes *w = f->nodes;
  Shoot s = {0};
  int all = most_parts(f), rc;
  w->active = all;
  rc = shoot_open(&s, f);
  if (rc == LAG_OK && grows) rc = grow(f, &s, all, x);
  w->tie = tightest;
  rc = rc ? rc : descend(f, &s, least, f->most, x);
  shoot_free(&s);
  return rc;
}
