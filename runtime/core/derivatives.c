/* Rates, Jacobians and mass matrices at states that the caller gives. Enters: a simulation with its values set, states;
 * leaves: arrays, row-major, in SI. Holds: derivatives of rates are exact without constraints; those with constraints,
 * and of outputs, are differences of order 6, correct to 11 digits or so. The run is not touched. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "numeric/workspace.h"

/* Scratch of one call. */
typedef struct Room {
  double *J, *work, *y, *out, *block;
} Room;

/* ---- Outputs */

static int outputs_by_state(lag_sim *s, double t, const double *y, const Room *w, double *D) {
  int n = s->pb.n, rc = LAG_OK;
  memset(D, 0, (size_t)(lag_sim_noutputs(s) * n) * sizeof *D);
  memcpy(w->y, y, (size_t)n * sizeof *y);
  for (int c = 0; c < n; c++) {
    double h = LAG_DIFFERENCE_PART * lag_difference_scale(&s->pb, y, c);
    LAG_EACH_DIFFERENCE(k) {
      w->y[c] = y[c] + k * h;
      rc = rc ? rc : lag_add_outputs(s, t, w->y, lag_difference_weight(k) / h, w->out, n, D + c);
    }
    w->y[c] = y[c];
  }
  return rc;
}

static int outputs_by_parameters(lag_sim *s, double t, const double *y, const Room *w, double *D) {
  const lag_parameter_columns *by = s->pb.by;
  int rc = LAG_OK;
  memset(D, 0, (size_t)(lag_sim_noutputs(s) * by->n) * sizeof *D);
  for (int j = 0; j < by->n && rc == LAG_OK; j++) rc = lag_outputs_by_parameter(s, t, y, j, w->out, by->n, D + j);
  return rc;
}

/* ---- Differences by inputs, each replaced by constants beside its value */

static int by_inputs(lag_sim *s, double t, const double *y, int of_outputs, const Room *w, double *D) {
  lag_problem *pb = &s->pb;
  int nu = pb->model->nu, n = pb->n, rows = of_outputs ? lag_sim_noutputs(s) : n, rc = lag_inputs_at(pb, t, y);
  memset(D, 0, (size_t)(rows * nu) * sizeof *D);
  for (int c = 0; c < nu && rc == 0; c++) {
    double u = pb->u[c], h = LAG_DIFFERENCE_PART * (u != 0.0 ? fabs(u) : fabs(pb->model->u[c].factor)),
           held = pb->hold[c];
    lag_signal signal = pb->signal[c];
    s->signal[c].fn = NULL;
    LAG_EACH_DIFFERENCE(k) {
      pb->hold[c] = u + k * h;
      rc = rc ? rc : of_outputs ? lag_outputs_at(s, t, y, w->out) : lag_rhs(pb, t, y, w->out);
      for (int i = 0; i < rows; i++) D[i * nu + c] += lag_difference_weight(k) * w->out[i] / h;
    }
    pb->hold[c] = held;
    s->signal[c] = signal;
    rc = rc ? rc : lag_inputs_at(pb, t, y);
  }
  return rc;
}

/* ---- Rates */

/* Columns `from` to `from + columns` of the rates' Jacobian by state and parameters, which is J below its first nq
 * rows. */
static void copy_columns(const lag_sim *s, const double *J, int width, int from, int columns, double *out) {
  int n = s->pb.n, nq = s->pb.nq;
  memset(out, 0, (size_t)(n * columns) * sizeof *out);
  for (int i = 0; i < nq && from == 0; i++) out[i * columns + nq + i] = 1;
  for (int i = nq; i < n; i++)
    memcpy(out + i * columns, J + (i - nq) * width + from, (size_t)columns * sizeof *out);
}

static int rates_by(lag_sim *s, double t, const double *y, int parameters, const Room *w, double *out) {
  const lag_parameter_columns *by = parameters ? s->pb.by : NULL;
  int n = s->pb.n, width = n + (by ? by->n : 0);
  int rc = lag_fine_jacobian(&s->pb, by, t, y, w->J, w->work);
  if (rc == 0) copy_columns(s, w->J, width, by ? n : 0, by ? by->n : n, out);
  return rc;
}

static int rates_by_inputs(lag_sim *s, double t, const double *y, const Room *w, double *out) {
  int nu = s->pb.model->nu, nq = s->pb.nq, rc = lag_input_jacobian(&s->pb, t, y, out + nq * nu, w->work);
  memset(out, 0, (size_t)(nq * nu) * sizeof *out);
  return rc == LAG_EMETHOD ? by_inputs(s, t, y, 0, w, out) : rc;
}

/* ---- The mass matrix */

static int mass_matrix(lag_sim *s, double t, const double *y, const Room *w, double *M) {
  lag_problem *pb = &s->pb;
  const lag_model *m = pb->model;
  const lag_constraints *c = m->constraints;
  int nq = pb->nq, rc = lag_inputs_at(pb, t, y);
  if (!c) return rc ? rc : lag_linearise(pb, t, y, NULL, w->J, M, w->work);
  double *mass = w->J + c->njacobian;
  rc = rc ? rc : c->matrices(m, t, y, y + nq, y + 2 * nq, pb->p, pb->u, w->J, mass, pb->work);
  if (rc == 0) lag_symmetric_matrix((size_t)nq, c->nmass, c->mass, mass, M);
  return rc;
}

static int inverse_dynamics(lag_sim *s, double t, const double *y, const double *a, double *force) {
  lag_problem *pb = &s->pb;
  int nq = pb->nq, rc = lag_inputs_at(pb, t, y);
  return rc ? rc : pb->model->inverse(pb->model, t, y, y + nq, y + 2 * nq, pb->p, pb->u, a, force, pb->work);
}

/* ---- One state, many states */

static int at_state(lag_sim *s, lag_quantity of, double t, const double *y, const double *a, const Room *w,
                    double *out) {
  switch (of) {
    case LAG_RATES: return lag_rhs(&s->pb, t, y, out);
    case LAG_RATES_BY_STATE: return rates_by(s, t, y, 0, w, out);
    case LAG_RATES_BY_INPUTS: return rates_by_inputs(s, t, y, w, out);
    case LAG_RATES_BY_PARAMETERS: return rates_by(s, t, y, 1, w, out);
    case LAG_OUTPUTS: return lag_outputs_at(s, t, y, out);
    case LAG_OUTPUTS_BY_STATE: return outputs_by_state(s, t, y, w, out);
    case LAG_OUTPUTS_BY_INPUTS: return by_inputs(s, t, y, 1, w, out);
    case LAG_OUTPUTS_BY_PARAMETERS: return outputs_by_parameters(s, t, y, w, out);
    case LAG_MASS_MATRIX: return mass_matrix(s, t, y, w, out);
    case LAG_INVERSE_DYNAMICS: return inverse_dynamics(s, t, y, a, out);
  }
  return LAG_EINVAL;
}

void lag_sim_quantity_size(const lag_sim *s, lag_quantity of, int *rows, int *columns) {
  int by_state = of == LAG_RATES_BY_STATE || of == LAG_OUTPUTS_BY_STATE,
      by_input = of == LAG_RATES_BY_INPUTS || of == LAG_OUTPUTS_BY_INPUTS,
      by_parameter = of == LAG_RATES_BY_PARAMETERS || of == LAG_OUTPUTS_BY_PARAMETERS;
  const lag_model *m = s->scene->model;
  *rows = of >= LAG_MASS_MATRIX ? m->nq : of >= LAG_OUTPUTS ? lag_sim_noutputs(s) : s->pb.n;
  *columns = by_state ? s->pb.n : by_input ? m->nu : by_parameter ? m->np : of == LAG_MASS_MATRIX ? m->nq : 1;
}

/* Refuses a quantity that needs derivatives which the program was built without. */
static int check_built(lag_sim *s, lag_quantity of) {
  const lag_model *m = s->scene->model;
  int jacobian = of == LAG_RATES_BY_STATE || of == LAG_RATES_BY_PARAMETERS || of == LAG_MASS_MATRIX,
      lacks = of == LAG_INVERSE_DYNAMICS ? !m->inverse : jacobian && !m->constraints && !m->linear;
  return lacks && m->nq ? lag_fail(s, LAG_EMETHOD,
                                   "derivatives are needed, which this program was built without: lagc build --with "
                                   "derivatives")
                        : LAG_OK;
}

static int room_for(const lag_sim *s, Room *w) {
  const lag_model *m = s->scene->model;
  const lag_constraints *c = m->constraints;
  size_t n = (size_t)s->pb.n, nout = (size_t)lag_sim_noutputs(s), most = nout > n ? nout : n,
         J = n * (n + (size_t)m->np) + 1, A = c ? (size_t)c->njacobian + (size_t)c->nmass : 0;
  const lag_part parts[] = {
      {&w->J, J > A ? J : A}, {&w->work, lag_linear_work(m) + 1}, {&w->y, n}, {&w->out, most + 1}};
  w->block = lag_workspace(sizeof parts / sizeof *parts, parts);
  return w->block != NULL;
}

static int at_states(lag_sim *s, lag_quantity of, int count, const double *t, const double *y, const double *a,
                     double *out) {
  int rows, columns, rc = LAG_OK;
  size_t n = (size_t)s->pb.n, nq = (size_t)s->pb.nq;
  Room w;
  lag_sim_quantity_size(s, of, &rows, &columns);
  if (!room_for(s, &w)) return lag_fail(s, LAG_ENOMEM, "out of memory");
  for (size_t k = 0; k < (size_t)count && rc == 0; k++) {
    const double *at = y + k * n;
    rc = lag_conditional_place(s, t[k], at);
    rc = rc ? rc : at_state(s, of, t[k], at, a ? a + k * nq : NULL, &w, out + k * (size_t)rows * (size_t)columns);
    int bad = rc ? 0 : lag_check_moving_sizes(s, t[k], at);
    if (rc) lag_fail(s, rc, "the equations have no value at t = %s s, state %d", LAG_TEXT(t[k]), (int)k);
    rc = rc ? rc : bad;
  }
  free(w.block);
  return rc;
}

int lag_sim_quantity(lag_sim *s, lag_quantity of, int count, const double *t, const double *y, const double *a,
                     double *out) {
  if (!s || count < 0 || !t || !y || !out || (of == LAG_INVERSE_DYNAMICS && !a)) return LAG_EINVAL;
  const lag_model *m = s->scene->model;
  double *held = s->contact_scratch;
  int rc = lag_check_parameters(s), all = of == LAG_RATES_BY_PARAMETERS || of == LAG_OUTPUTS_BY_PARAMETERS;
  struct lag_sensitivity *kept = s->sensitivity;
  rc = rc ? rc : check_built(s, of);
  rc = rc || !all ? rc : lag_all_parameters(s);
  if (rc) return rc;
  lag_switch_set_free(s, 1);
  for (int i = 0; i < m->ncontacts; i++) held[i] = s->hold[m->contacts[i].input];
  rc = at_states(s, of, count, t, y, a, out);
  lag_switch_set_free(s, 0);
  for (int i = 0; i < m->ncontacts; i++) s->hold[m->contacts[i].input] = held[i];
  if (all) lag_all_parameters_end(s, kept);
  return rc;
}

int lag_sim_rhs(lag_sim *s, int count, const double *t, const double *y, double *dy) {
  return lag_sim_quantity(s, LAG_RATES, count, t, y, NULL, dy);
}
