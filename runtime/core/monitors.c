/* Monitors of a run: charges (charge_monitor.c), outputs and residuals of constraints. Enters: states of the run;
 * leaves: largest drifts, and a failure when one passes its limit. Holds: the change of a quantity at an event is
 * not drift: the reference moves by the jump. */
#include <math.h>
#include <string.h>

#include "core/core.h"
#include "core/rhs.h"

static int outputs_at(lag_sim *s, double t, const double *y) {
  return s->scene->observe ? lag_observe(s, t, y, s->out) : 0;
}

static int watches_outputs(const lag_scene *c) {
  for (int i = 0; i < c->nmonitors; i++)
    if (c->monitors[i].output >= 0) return 1;
  return 0;
}

/* Updates the largest residuals of the constraints. */
static void see_constraints(lag_sim *s, double t, const double *y) {
  const lag_constraints *of = s->scene->model->constraints;
  double *c = s->pb.held, *r = c + (of ? of->n : 0);
  int rc = of ? lag_residuals(&s->pb, t, y, c, r) : 1;
  for (int k = 0; k < (rc ? 0 : of->n); k++) {
    s->run->c_peak = k < of->nholonomic ? fmax(s->run->c_peak, fabs(c[k])) : s->run->c_peak;
    s->run->r_peak = fmax(s->run->r_peak, fabs(r[k]));
  }
}

/* Output k at the start; 0 where it is rounding of its terms. */
static double first_value(lag_sim *s, int k) {
  double terms = lag_output_terms(s, s->run->t, s->now, k);
  if (outputs_at(s, s->run->t, s->now) || lag_above_rounding(fabs(s->out[k]), terms) > fabs(s->out[k])) return 0;
  return s->out[k];
}

int lag_monitors_begin(lag_sim *s) {
  const lag_scene *c = s->scene;
  see_constraints(s, s->run->t, s->now);
  lag_charges_begin(s, s->run->t, s->now);
  if (watches_outputs(c) && outputs_at(s, s->run->t, s->now))
    return lag_fail(s, LAG_EMODEL, "the outputs cannot be computed at the start");
  for (int i = 0; i < c->nmonitors; i++) {
    int k = c->monitors[i].output;
    s->mon_peak[i] = 0;
    s->mon_first[i] = c->monitors[i].absolute || k < 0 ? 0 : first_value(s, k);
  }
  return lag_closed_form_record(s, s->run->t, s->now);
}

/* The largest of x and y, NaN if y is: a NaN must not be forgotten. */
static double larger(double x, double y) { return y > x || isnan(y) ? y : x; }

/* Drift relative to the first value; of a quantity that begins at 0, in its declared unit. */
static double relative(const lag_sim *s, int i, double peak) {
  double unit = s->scene->outputs[s->scene->monitors[i].output].factor, size = fabs(s->mon_first[i]);
  return peak / (size > 0 ? size : unit);
}

double lag_sim_monitor_drift(lag_sim *s, int i) {
  if (!s || i < 0 || i >= s->scene->nmonitors) return NAN;
  int k = s->scene->monitors[i].output;
  double peak = s->mon_peak[i];

  if (k < 0) {
    lag_charge_stats c;
    lag_sim_charge(s, -1 - k, &c);
    return c.drift;
  }
  if (s->run->begun != 0.0)
    peak = larger(peak, outputs_at(s, s->run->t, s->now) ? NAN : fabs(s->out[k] - s->mon_first[i]));
  return relative(s, i, peak);
}

/* Fails the run where monitor i passes its limit. */
static int judge_monitor(lag_sim *s, int i, double drift) {
  const lag_monitor *m = &s->scene->monitors[i];
  if (drift <= m->limit) return LAG_OK;
  int rough = m->output < 0 && !lag_charge_flags(s, -1 - m->output) && !lag_method_balances(s->method);
  return lag_fail(s, LAG_EMONITOR, "monitor %s: drift %.3g is past its limit %.3g at t = %s s%s%s%s", m->name, drift,
                  m->limit, LAG_TEXT(s->run->t), rough ? "; the work of forces is not accounted for, as " : "",
                  rough ? s->method->name : "", rough ? " has no accurate dense output: take dop853" : "");
}

/* Reports that the energy has no value. The equations of motion may still have one past the end of L's domain, as
 * those of log(x) at x < 0, and equal steps may cross that end. */
static int left_domain(lag_sim *s, double t) {
  s->pb.bad_t = t;
  s->pb.bad_index = -1;
  s->pb.detail = "of its energy: the motion has left the domain of L";
  return lag_explain(s, LAG_ENAN);
}

int lag_sim_judge(lag_sim *s) {
  if (!s) return LAG_EINVAL;
  int rc = s->run->begun != 0.0 && lag_energy_undefined(s, s->run->t, s->now) ? left_domain(s, s->run->t) : LAG_OK;

  for (int i = 0; i < s->scene->nmonitors && rc == 0 && s->run->begun != 0.0; i++)
    rc = judge_monitor(s, i, lag_sim_monitor_drift(s, i));
  return rc ? rc : lag_energy_retained(s);
}

int lag_monitors_record(lag_sim *s, double t, const double *y) {
  const lag_scene *c = s->scene;
  int lost = lag_charges_record(s, t, y);
  if (lost) {
    if (s->run->from == s->run->step_t0) {
      lag_copy(s->pb.n, s->y0, s->now);
      s->run->t = s->run->from;
    }
    return lost == LAG_EDRIFT ? lost : left_domain(s, t);
  }
  if (c->model->constraints) see_constraints(s, t, y);
  if (c->nexact && lag_closed_form_record(s, t, y)) return LAG_EMODEL;
  if (watches_outputs(c) && outputs_at(s, t, y))
    return lag_fail(s, LAG_EMODEL, "the outputs cannot be computed at t = %s s", LAG_TEXT(t));
  for (int i = 0; i < c->nmonitors; i++) {
    int k = c->monitors[i].output;
    if (k >= 0) s->mon_peak[i] = larger(s->mon_peak[i], fabs(s->out[k] - s->mon_first[i]));
  }
  int rc = LAG_OK;
  for (int i = 0; i < c->nmonitors && rc == 0; i++) { /* after all are updated: a report shows them all */
    int k = c->monitors[i].output;
    rc = judge_monitor(s, i, k < 0 ? lag_charge_drift(s, -1 - k) : relative(s, i, s->mon_peak[i]));
  }
  return rc;
}

int lag_monitors_side(lag_sim *s, double t, const double *y, int after) {
  const lag_scene *c = s->scene;
  lag_charges_side(s, t, y, after);
  if (!watches_outputs(c)) return LAG_OK;
  if (outputs_at(s, t, y))
    return lag_fail(s, LAG_EMODEL, "the outputs cannot be computed at t = %s s", LAG_TEXT(t));
  for (int i = 0; i < c->nmonitors; i++) {
    int k = c->monitors[i].output;
    double *first = &s->mon_first[i], out = k >= 0 && !c->monitors[i].absolute ? s->out[k] : 0;
    *first += after ? -out : out;
    if (after && lag_above_rounding(fabs(*first), fabs(out)) > fabs(*first)) *first = 0;
  }
  return LAG_OK;
}

int lag_monitors_jump(lag_sim *s, double t, const double *ya, const double *yb) {
  see_constraints(s, t, yb);
  int rc = lag_monitors_side(s, t, ya, 0);
  return rc ? rc : lag_monitors_side(s, t, yb, 1);
}

LAG_RARE int record_impulses(lag_sim *s) {
  lag_contact_stats *c = s->pb.contacts;
  const Run *r = s->run;
  int nq = s->pb.nq;
  double before = r->at_events;
  memcpy(s->yb, s->now, (size_t)s->pb.n * sizeof *s->yb);
  for (int i = 0; i < nq; i++) s->yb[nq + i] -= s->pb.contact_change[i];
  int rc = lag_monitors_jump(s, r->t, s->yb, s->now);
  c->due = 0;
  lag_charges_add_work(s, c->work - (r->at_events - before), c->rubbed);
  return rc;
}

int lag_monitors_impulses(lag_sim *s) {
  const lag_contact_stats *c = s->pb.contacts;
  return !c || c->due == 0.0 || s->run->t < c->from ? LAG_OK : record_impulses(s);
}

int lag_sim_contacts(const lag_sim *s, lag_contact_stats *c) {
  if (!s || !c || !s->pb.contacts || !lag_has_gaps(s->scene->model)) return 0;
  *c = *s->pb.contacts;
  return 1;
}

void lag_sim_stats(lag_sim *s, lag_stats *st) {
  if (!s || !st) return;
  const Run *r = s->run;
  const lag_constraints *c = s->scene->model->constraints;
  lag_charge_stats energy = {.now = NAN, .drift = NAN};

  st->t = r->t;
  st->steps = (long long)r->steps;
  st->rejected = (long long)s->pb.rejected;
  st->rhs_calls = (long long)s->pb.rhs_calls;
  st->events = (long long)r->events;
  st->unresolved = r->looks >= 4 && 2 * r->coarse > r->looks ? r->period : NAN;
  st->systems = (long long)s->pb.systems;
  st->iterations = (long long)s->pb.iterations;
  st->constraint = c ? r->c_peak : NAN;
  st->constraint_rate = c ? r->r_peak : NAN;
  if (lag_sim_ncharges(s)) lag_sim_charge(s, 0, &energy);
  st->energy = energy.now;
  st->energy_drift = energy.drift;
}
