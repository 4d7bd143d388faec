/* A run: steps of the method, cut by events, evaluated where the caller asks. Enters: a time to reach; leaves: the
 * state there. Holds: neither steps nor events depend on the times that the caller asks for (except with STEPS_TO
 * methods), so a run that is split, saved or resumed is the same run. */
#include <math.h>
#include <string.h>

#include "core/core.h"
#include "core/rhs.h"

/* Refuses negative frictions at state y, by the branches of that state. */
LAG_RARE int judge_moving_sizes(lag_sim *s, double t, const double *y) {
  lag_switch_set_free(s, 1);
  int rc = lag_check_moving_sizes(s, t, y);
  lag_switch_set_free(s, 0);
  return rc;
}

/* Begins the run at the first advance: start, method, monitors, events. For t = t0 only the start is computed, as
 * the direction of time is not known yet. */
static int begin(lag_sim *s, double t) {
  s->run->dir = s->pb.dir = t < s->scene->t0 ? -1 : 1;
  int rc = lag_setup_start(s);

  rc = rc ? rc : judge_moving_sizes(s, s->run->t, s->now);
  rc = rc ? rc : lag_contact_begin(s);
  if (rc || t == s->scene->t0 || (rc = lag_switch_place(s)) != 0) return rc;
  if (!s->options && s->scene->method && strcmp(s->scene->method, s->method->name) != 0) {
    return lag_fail(
        s, LAG_EMETHOD,
        "scene %s asks for the method %s, which is not in liblag.a: set it by lag_sim_set_method, or another",
        s->scene->name, s->scene->method);
  }
  if (!s->options) { /* the scene's method was refused and not replaced: refuse it again, for the message */
    return lag_sim_set_method(s, s->method, s->scene->options, s->scene->noptions);
  }
  lag_start_sizes(s);
  if ((rc = s->method->init(s->method_work, &s->pb, s->options)) != 0) return lag_explain(s, rc);
  s->run->begun = 1;
  rc = lag_monitors_begin(s);
  rc = rc ? rc : lag_tangent_begin(s);
  rc = rc ? rc : lag_events_arm(s);
  return rc ? rc : lag_tangent_edges(s);
}

/* Passes a jump of a table, two rows next to each other in double precision, without a step. */
static int pass_jump(lag_sim *s) {
  Run *r = s->run;
  double row;
  if (s->scene->model->ntables && lag_next_row(&s->pb, r->t, &row) < HUGE_VAL &&
      row == nextafter(r->t, r->dir * HUGE_VAL)) {
    r->t = row;
    s->method->reset(s->method_work, &s->pb);
    return s->scene->model->nmodes ? lag_events_inputs_jump(s) : LAG_OK;
  }
  return LAG_OK;
}

/* Moves y and *t to the end of a step. */
static int make_step(lag_sim *s, double *t, double t_stop) {
  if (!s->outside.on) return s->method->step(s->method_work, &s->pb, t, s->y, t_stop);
  s->outside.made = 0;
  *t = s->outside.t;
  return LAG_OK;
}

/* Fails where the step, of which no event comes first, ends at a negative friction. */
LAG_ALWAYS_INLINE int judge_end(lag_sim *s) {
  Run *r = s->run;
  if (!s->scene->model->nmoving || r->have_step == 0.0 || r->pending != 0.0) return LAG_OK;
  int rc = judge_moving_sizes(s, r->step_t1, s->y);
  if (rc) r->have_step = 0;
  return rc;
}

/* Makes a step of the method and locates its first event. */
static int take(lag_sim *s, double t_stop) {
  Run *r = s->run;
  int rc = pass_jump(s);
  double t = r->t, row = t_stop;

  if (s->scene->model->nev && (rc = rc ? rc : lag_kicks_plan(s)) == 0 && lag_kicks_at_once(s)) return LAG_OK;
  if (lag_next_row_inline(&s->pb, t, &row) < fabs(t_stop - t)) t_stop = row;
  if (s->outside.on && !s->outside.made) {
    s->outside.to = t_stop;
    return LAG_WANTS_STEP;
  }
  lag_copy(s->pb.n, s->now, s->y0);
  s->pb.detail = NULL;
  s->pb.bad_t = t;
  rc = rc ? rc : make_step(s, &t, t_stop);
  rc = rc ? rc : lag_changes_branch(s, t);
  rc = rc ? rc : lag_detect_stall(s, t);
  rc = rc ? rc : lag_crosses_force_pole(s, t);
  rc = rc ? rc : lag_switch_step(s, t);
  if (rc) return lag_explain(s, rc);
  r->steps++;
  r->have_step = 1;
  r->step_t0 = r->from = r->t;
  r->step_t1 = t;
  rc = lag_events_locate(s);
  return rc ? rc : judge_end(s);
}

/* `now` := the state at time t of the present step. */
static int move_to(lag_sim *s, double t) {
  const Run *r = s->run;
  if (t == r->step_t1) {
    lag_copy(s->pb.n, s->y, s->now);
  } else if (t != r->t) {
    int rc = lag_dense_state(s, t, s->yc);
    if (rc) return rc;
    lag_copy(s->pb.n, s->yc, s->now);
  }
  s->run->t = t;
  return LAG_OK;
}

/* Moves to the next event, or to the end of the step. */
static int pass_limit(lag_sim *s) {
  Run *r = s->run;
  int rc = move_to(s, r->limit);

  rc = rc ? rc : lag_monitors_impulses(s);
  rc = rc ? rc : lag_monitors_record(s, r->t, s->now);
  if (rc) return rc;
  if (r->pending != 0.0) {
    rc = lag_events_fire(s);
    return rc ? rc : judge_end(s);
  }
  r->have_step = 0;
  lag_copy(lag_watched(s), s->sign_end, s->sign);
  if (s->scene->model->contact_laws && !s->pb.contacts) lag_contacts_turn(s);
  return LAG_OK;
}

/* Begins the run if needed; whether it can advance to t. */
static int begin_or_check(lag_sim *s, double t) {
  const Run *r = s->run;
  int rc = 0;
  if (!isfinite(t)) return lag_fail(s, LAG_EINVAL, "cannot advance to t = %g", t);
  if (r->begun == 0.0 && (rc = begin(s, t)) != 0) return rc;
  return (t - r->t) * r->dir < 0 ? lag_fail(s, LAG_EINVAL, "cannot go from t = %g back to %g", r->t, t) : LAG_OK;
}

/* Ends the present step, or makes a new one. */
static int continue_run(lag_sim *s, double t) {
  int rc;
  if (s->run->have_step != 0.0) {
    rc = pass_limit(s);
    int bad = rc < 0 || !s->tangent ? rc : lag_tangent_pass(s);
    rc = bad ? bad : rc;
  } else {
    rc = take(s, t);
  }
  if (rc == 0 && s->run->have_step == 0.0 && s->on_step && s->on_step(s->on_step_context, s)) rc = LAG_INTERRUPTED;
  return rc;
}

int lag_sim_advance(lag_sim *s, double t) {
  if (!s) return LAG_EINVAL;
  const Run *r = s->run;
  int rc = begin_or_check(s, t);

  while (rc == 0) {
    if (r->have_step != 0.0 && (r->limit - t) * r->dir >= 0) {
      rc = move_to(s, t);
      return rc || !s->record ? rc : lag_record_pause(s);
    }
    if (r->have_step == 0.0 && r->t == t) return LAG_OK;
    rc = continue_run(s, t);
  }
  return rc;
}

int lag_run_to_step(lag_sim *s, double steps, double t) {
  const Run *r = s->run;
  int rc = begin_or_check(s, t);
  while (rc == 0 && (r->steps < steps || r->have_step != 0.0)) rc = continue_run(s, t);
  return rc;
}

int lag_sim_ensure_step(lag_sim *s, double t, double *reach) {
  if (!s || !reach) return LAG_EINVAL;
  const Run *r = s->run;
  int rc = begin_or_check(s, t);

  while (rc == 0 && r->t != t && (r->have_step == 0.0 || r->limit == r->t)) rc = continue_run(s, t);
  *reach = r->t == t || rc ? r->t : (r->limit - t) * r->dir < 0 ? r->limit : t;
  return rc;
}

