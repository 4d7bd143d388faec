/* The model as y' = f(t, y): the only way in which methods call it. Enters: t, y = [q|v|z]; leaves: y' = [v|a|z']. */
#include <math.h>
#include <string.h>

#include "core/core.h"
#include "core/rhs.h"

int lag_rhs_prepare(lag_problem *pb, double t, const double **y) {
  if (!pb->redundant) return lag_inputs_at(pb, t, *y);
  double *at = pb->held + lag_constraint_scratch_size(pb->model) - pb->n;
  memcpy(at, *y, (size_t)pb->n * sizeof *at);
  int rc = lag_project(pb, t, at, NULL);
  *y = at;
  return rc ? rc : lag_inputs_at(pb, t, *y);
}

int lag_rhs(lag_problem *pb, double t, const double *y, double *dy) { return lag_rhs_inline(pb, pb->nq, t, y, dy); }

/* The first row after t in direction dir; -1: none. */
static int row_after(const lag_table *c, double t, double dir) {
  int k = 0, end = c->n;
  while (k < end) { /* rows before k are <= t (forward) or < t (backward) */
    int mid = (k + end) / 2;
    if (dir > 0 ? c->row[c->width * mid] <= t : c->row[c->width * mid] < t) k = mid + 1;
    else end = mid;
  }
  k = dir > 0 ? k : k - 1;
  return k < c->n ? k : -1;
}

double lag_next_row(const lag_problem *pb, double t, double *row) {
  const lag_model *m = pb->model;
  double least = HUGE_VAL;
  for (int i = 0; i < m->ntables; i++) {
    const lag_table *c = &m->tables[i];
    int in_use = isnan(pb->hold[c->input]) && !pb->signal[c->input].fn, k = in_use ? row_after(c, t, pb->dir) : -1;
    if (k >= 0 && fabs(c->row[c->width * k] - t) < least) {
      *row = c->row[c->width * k];
      least = fabs(*row - t);
    }
  }
  return least;
}

int lag_variation(lag_problem *pb, double t, const double *q, const double *v, double *Lq, double *Lv, double *Q) {
  int rc = lag_inputs(pb, t);
  pb->rhs_calls++;
  return rc ? rc : pb->model->variation(pb->model, t, q, v, NULL, pb->p, pb->u, Lq, Lv, Q, pb->work);
}

int lag_second_derivatives(lag_problem *pb, double t, const double *q, const double *v, double *h) {
  int rc = lag_inputs(pb, t);
  return rc ? rc : pb->model->second(pb->model, t, q, v, NULL, pb->p, pb->u, h, pb->work);
}
