/* Connections by multiple shooting (connection.h): nodes along the whole motion, as rounding of one run from the start
 * grows too much on long ones. J. Stoer, R. Bulirsch, Introduction to Numerical Analysis, 3rd ed. (2002), section
 * 7.3. */
#include <math.h>
#include <string.h>

#include "analysis/connection.h"
#include "numeric/dense.h"
#include "numeric/singular_values.h"

enum { MOST_PARTS = 24, MOST_STEPS = 20, MOST_ROWS = 400 };

/* Nodes y[m + 1][n], of which the ends are starts at places along the motions; unknowns are the others, both places,
 * and the time, by the factor of all parts. */
typedef struct Nodes {
  LongConnection *c;
  int n, m, rows, cols;
  double *y, *end, *Phi, *A, *b, *V, *sigma, *x, *up, *down;
} Nodes;

static int open_nodes(Nodes *w, Pool *pool, LongConnection *c) {
  const double growth = log(100); /* of small changes within a part */
  for (int e = 0; e < 2; e++)
    c->parts[e] = (int)fmin(fmax(2, ceil(c->rate * c->time[e] / growth)), MOST_PARTS);
  *w = (Nodes){.c = c, .n = c->n, .m = c->parts[0] + c->parts[1]};
  w->rows = w->m * w->n, w->cols = (w->m - 1) * w->n + 3;
  if (w->rows > MOST_ROWS) return LAG_EDOMAIN;
  size_t n = (size_t)w->n, m = (size_t)w->m, rows = m * n, cols = (size_t)w->cols;
  const lag_part parts[] = {{&w->y, (m + 1) * n}, {&w->end, rows}, {&w->Phi, rows * n}, {&w->A, rows * cols},
                            {&w->b, rows}, {&w->V, cols * cols}, {&w->sigma, cols}, {&w->x, cols}, {&w->up, n},
                            {&w->down, n}};
  lag_pool_parts(pool, sizeof parts / sizeof *parts, parts);
  return pool->failed ? LAG_ENOMEM : LAG_OK;
}

static double length_of(const Nodes *w, int k) {
  const LongConnection *c = w->c;
  return k < c->parts[0] ? c->time[0] / c->parts[0] : c->time[1] / c->parts[1];
}

/* Nodes along the runs from both ends. */
static int place(Nodes *w) {
  LongConnection *c = w->c;
  FlowMap *f = c->flow;
  int n = w->n, m = w->m, rc = c->start(c->of, 0, c->phase[0], w->y);
  rc = rc ? rc : c->start(c->of, 1, c->phase[1], w->y + m * n);
  for (int k = 0; k < c->parts[0] - 1 && rc == LAG_OK; k++)
    rc = lag_flow_run(f, f->t0, length_of(w, k), w->y + k * n, w->y + (k + 1) * n, NULL);
  const lag_scene *own = f->like->scene;
  lag_scene back = *own;
  back.t1 = f->t0 - c->time[1];
  f->like->scene = &back;
  lag_sim *sim = rc ? NULL : lag_flow_sim(f, f->t0, w->y + m * n);
  f->like->scene = own;
  if (rc == LAG_OK && !sim) rc = LAG_ENOMEM;
  for (int k = m - 1; k >= c->parts[0] && rc == LAG_OK; k--) {
    rc = lag_sim_advance(sim, f->t0 - (m - k) * length_of(w, k));
    memcpy(w->y + k * n, sim->now, (size_t)n * sizeof *w->y);
  }
  lag_sim_free(sim);
  return rc;
}

/* Column of the place of one end: the change of its start, or of what that becomes a part later. */
static int column_of_place(Nodes *w, int e) {
  const double h = 1e-4;
  LongConnection *c = w->c;
  int n = w->n, col = w->cols - 3 + e, rc = c->start(c->of, e, c->phase[e] + h, w->up);
  rc = rc ? rc : c->start(c->of, e, c->phase[e] - h, w->down);
  for (int i = 0; i < n && rc == LAG_OK; i++) {
    double sum = e ? -(w->up[i] - w->down[i]) : 0;
    for (int j = 0; j < n && !e; j++) sum += w->Phi[i * n + j] * (w->up[j] - w->down[j]);
    w->A[((e ? w->m - 1 : 0) * n + i) * w->cols + col] = sum / (2 * h * c->unit[i]);
  }
  return rc;
}

/* The linear system at the present unknowns; c->residual := the largest gap. */
static int assemble(Nodes *w) {
  LongConnection *c = w->c;
  FlowMap *f = c->flow;
  int n = w->n, cols = w->cols, rc = LAG_OK;
  memset(w->A, 0, (size_t)w->rows * (size_t)cols * sizeof *w->A);
  c->residual = 0;
  for (int k = 0; k < w->m && rc == LAG_OK; k++) {
    double *end = w->end + k * n, *Phi = w->Phi + k * n * n, h = length_of(w, k);
    rc = lag_flow_run(f, f->t0, h, w->y + k * n, end, Phi);
    rc = rc ? rc : lag_flow_rates(f, f->t0, end, w->up);
    for (int i = 0; i < n && rc == LAG_OK; i++) {
      double *row = w->A + (k * n + i) * cols;
      for (int j = 0; j < n && k > 0; j++) row[(k - 1) * n + j] = Phi[i * n + j] * c->unit[j] / c->unit[i];
      if (k < w->m - 1) row[k * n + i] = -1;
      row[cols - 1] = w->up[i] * h / c->unit[i];
      w->b[k * n + i] = (w->y[(k + 1) * n + i] - end[i]) / c->unit[i];
      c->residual = fmax(c->residual, fabs(w->b[k * n + i]));
    }
  }
  rc = rc ? rc : column_of_place(w, 0);
  return rc ? rc : column_of_place(w, 1);
}

static int step(Nodes *w, double *size) {
  const double least = 1e-12, longest = 0.3;
  LongConnection *c = w->c;
  int inner = w->cols - 3;
  lag_singular_values(w->rows, w->cols, w->A, w->V, w->sigma);
  lag_least_norm((lag_decomposed){w->rows, w->cols, w->A, w->V, w->sigma}, least, 0, w->b, w->x);
  *size = lag_largest(w->cols, w->x);
  double part = *size > longest ? longest / *size : 1;
  for (int i = 0; i < inner; i++) w->y[w->n + i] += part * w->x[i] * c->unit[i % w->n];
  for (int e = 0; e < 2; e++) {
    c->phase[e] += part * w->x[inner + e];
    c->time[e] *= 1 + part * w->x[inner + 2];
  }
  int rc = c->start(c->of, 0, c->phase[0], w->y);
  return rc ? rc : c->start(c->of, 1, c->phase[1], w->y + w->m * w->n);
}

int lag_connection_refine(LongConnection *c) {
  const double rounding = 1e-10;
  Pool pool = {0};
  Nodes w;
  double size = HUGE_VAL, last = HUGE_VAL;
  int rc = open_nodes(&w, &pool, c);
  rc = rc ? rc : place(&w);
  for (int k = 0; k < MOST_STEPS && rc == LAG_OK && size > rounding; k++) {
    rc = assemble(&w);
    rc = rc ? rc : step(&w, &size);
    if (k > 6 && !(size < 0.5 * last)) break;
    last = size;
  }
  rc = rc ? rc : assemble(&w);
  if (rc == LAG_OK) memcpy(c->before, w.y + (c->parts[0] - 1) * w.n, (size_t)w.n * sizeof *c->before);
  lag_pool_free(&pool);
  return rc;
}
