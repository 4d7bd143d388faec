/* The report of a run. Enters: a finished run; leaves: text, or one JSON object. */
#include <math.h>
#include <string.h>

#include "analysis/effect_variants.h"
#include "app/app.h"
#include "core/core.h"

enum { MOST_LINES = 24, BESIDE_PICTURE = 4 };

void lag_report_method(const App *app, char *s, size_t n) {
  const lag_method *m = lag_sim_method(app->sim);
  const double *opt = lag_sim_options(app->sim);
  size_t used = (size_t)snprintf(s, n, "%s(", m->name);
  if (m->flags & LAG_METHOD_ADAPTIVE)
    used += (size_t)snprintf(s + used, n - used, "tol=%g", lag_sim_tolerance(app->sim));
  for (int i = 0; i < m->noptions && used < n; i++) {
    if (opt[i] == m->options[i].value) continue;
    const char *comma = s[used - 1] == '(' ? "" : ", ";
    used += m->options[i].choices ? (size_t)snprintf(s + used, n - used, "%s%s=%s", comma, m->options[i].name,
                                                     m->options[i].choices[(int)opt[i]])
                                  : (size_t)snprintf(s + used, n - used, "%s%s=%g", comma, m->options[i].name, opt[i]);
  }
  if (used < n) snprintf(s[used - 1] == '(' ? s + used - 1 : s + used, n - used, "%s", s[used - 1] == '(' ? "" : ")");
}

void lag_report_head(const App *app, FILE *f) {
  char method[256];
  lag_report_method(app, method, sizeof method);
  fprintf(f, "model %s, scene %s, method %s\n", app->scene->model->name, app->scene->name, method);
}

/* ---- Energy and other charges: drift or balance of each, and whether it grows */

const char *lag_charge_word(const lag_charge_stats *c) {
  return c->flags & LAG_CONSERVED ? "drift" : c->flags & LAG_BALANCED ? "balance" : "change";
}

static void put_trend(const App *app, const lag_charge_stats *c, FILE *f) {
  const lag_method *m = lag_sim_method(app->sim);
  int bounded = (m->flags & LAG_METHOD_SYMPLECTIC) && (c->flags & LAG_CONSERVED);
  if (c->trend == LAG_TREND_GROWS) fprintf(f, ", grows by %.2g a second", fabs(c->slope));
  if (c->trend == LAG_TREND_OSCILLATES) fputs(", oscillates", f);
  if (c->trend == LAG_TREND_OSCILLATES && bounded)
    fprintf(f, " (as step^%d)", m->order_of ? m->order_of(lag_sim_options(app->sim)) : m->order);
  if (c->trend == LAG_TREND_ROUNDING) fputs(", rounding", f);
}

/* Reason why there is no balance. */
static const char *why_not(const App *app, const lag_charge_stats *c) {
  if (c->flags & LAG_JUMPS) return "jumps where L does";
  return lag_method_balances(lag_sim_method(app->sim)) ? "not decided: its rate is not known"
                                                       : "the dense output of the method is too coarse for a balance";
}

const char lag_energy_scale[] = "relative to the larger of |E0| and the median of |p.v| + |L|";

static void put_energy(const App *app, const lag_charge_stats *c, FILE *f) {
  const char *space = c->unit[0] ? " " : "";
  if (!(c->flags & (LAG_CONSERVED | LAG_BALANCED))) {
    fprintf(f, "(%s)", why_not(app, c));
    return;
  }
  fprintf(f, "(%.3g%s%s; ", c->absolute, space, c->unit);
  if (!(c->flags & LAG_CONSERVED)) fprintf(f, "work of forces and explicit time: %.6g%s%s; ", c->work, space, c->unit);
  fprintf(f, "%s)", lag_energy_scale);
}

static void put_charge(const App *app, const lag_charge_stats *c, FILE *f) {
  fprintf(f, "(from %.6g%s%s", c->begin + 0.0, c->unit[0] ? " " : "", c->unit);
  if (c->flags & LAG_CONSERVED) fputs(")", f);
  else if (c->flags & LAG_BALANCED) fprintf(f, "; change by forces: %.6g)", c->work);
  else fprintf(f, "; %s)", why_not(app, c));
}

/* Whether the energy error exceeds the tolerance by far because the mass matrix was almost singular. */
static int lost_digits(const App *app, const lag_charge_stats *energy) {
  const double singular = 1e6, digits = 100;
  return (lag_sim_method(app->sim)->flags & LAG_METHOD_ADAPTIVE) &&
         energy->energy_jump > digits * lag_sim_tolerance(app->sim) && energy->mass_condition > singular;
}

/* Warns that the tolerance was missed because the mass matrix was almost singular on the way. */
static void put_lost_digits(const App *app, const lag_charge_stats *c, FILE *f) {
  if (lost_digits(app, c)) {
    fprintf(f,
            "accuracy: a tolerance of %.3g was asked for, and the energy is kept to %.2g: near t = %.9g s, where a "
            "step changed the energy by %.2g, the mass matrix is "
            "almost singular (its condition is %s%.2g, by the inertia of %s) and accelerations have about %.0f digits "
            "less; a `rotation` instead of angles, or other "
            "coordinates, has no such place (lagc help rotations)\n",
            lag_sim_tolerance(app->sim), c->drift, c->energy_jump_t, c->energy_jump,
            c->mass_condition > 1e15 ? "above " : "", fmin(c->mass_condition, 1e15), c->mass_condition_of,
            floor(log10(fmin(c->mass_condition, 1e15))));
  }
}

static int has_kicks(const App *app) {
  const lag_model *m = app->scene->model;
  int n = 0;
  for (int k = 0; k < m->nev; k++) n += m->ev[k].direction == LAG_KICK;
  return n > 0;
}

const double *lag_app_nonfinite_state(const App *app, double *t) {
  const double *now = lag_sim_q(app->sim);
  *t = lag_sim_time(app->sim);
  if (app->status == LAG_ENAN || app->status == LAG_EDOMAIN) return now;
  for (int k = 0; k < lag_sim_ncharges(app->sim) && app->status >= 0; k++) {
    lag_charge_stats c;
    lag_sim_charge(app->sim, k, &c);
    if (isfinite(c.drift)) continue;
    if (!isfinite(c.now)) return now;
    *t = app->scene->t0;
    return app->sim->begin;
  }
  *t = app->empty_t;
  return app->status >= 0 ? app->empty_state : NULL;
}

/* "energy: not finite at t = 0 s: x = 900, x' = 1". */
static void put_nonfinite(const App *app, const char *name, FILE *f) {
  enum { MOST = 8 };
  double t;
  const double *y = lag_app_nonfinite_state(app, &t);
  fprintf(f, "%s: not finite", name);
  if (y) fprintf(f, " at t = %.6g s", t);
  for (int i = 0; y && i < 2 * app->scene->model->nq + app->scene->model->nz && i < MOST; i++) {
    char of[128];
    lag_sim_state_info(app->sim, i, of, sizeof of, NULL, 0);
    fprintf(f, "%s%s = %.6g", i ? ", " : ": ", of, lag_sim_declared(app->sim, i, y[i]));
  }
  putc('\n', f);
}

static void charges(const App *app, FILE *f) {
  for (int k = 0; k < lag_sim_ncharges(app->sim); k++) {
    lag_charge_stats c;
    lag_sim_charge(app->sim, k, &c);
    if (!isfinite(c.drift)) {
      put_nonfinite(app, c.name, f);
      continue;
    }
    fprintf(f, "%s %s: %.3g ", c.name, lag_charge_word(&c), c.drift);
    if (k) put_charge(app, &c, f);
    else put_energy(app, &c, f);
    put_trend(app, &c, f);
    putc('\n', f);
    if (k == 0 && isfinite(c.dry_friction))
      fprintf(f, "work of dry friction: %.6g%s%s\n", c.dry_friction, c.unit[0] ? " " : "", c.unit);
    if (c.at_events != 0.0)
      fprintf(f, "%s and events: %.6g%s%s of energy\n", has_kicks(app) ? "kicks" : "impacts", c.at_events,
              c.unit[0] ? " " : "", c.unit);
    if (k == 0) put_lost_digits(app, &c, f);
  }
}

static void charges_json(const App *app, Json *j) {
  static const char *const trends[] = {[LAG_TREND_UNKNOWN] = NULL,
                                       [LAG_TREND_ROUNDING] = "rounding",
                                       [LAG_TREND_OSCILLATES] = "oscillates",
                                       [LAG_TREND_GROWS] = "grows"};
  const lag_scene *s = app->scene;
  JSON_EACH(j, "charges", '{', k, lag_sim_ncharges(app->sim)) {
    lag_charge_stats c;
    lag_sim_charge(app->sim, k, &c);
    lag_json_begin(j, c.name, '{');
    lag_json_string(j, "is", c.flags & LAG_CONSERVED ? "conserved" : c.flags & LAG_BALANCED ? "balanced" : "not known");
    lag_json_numbers(j, {"initial", c.begin}, {"final", c.now}, {"work", c.work});
    if (isfinite(c.dry_friction)) lag_json_number(j, "dry_friction", c.dry_friction);
    if (k == 0) lag_json_number(j, "at_events", c.at_events);
    lag_json_numbers(j, {"drift", c.drift}, {"drift_absolute", c.absolute});
    lag_json_string(j, "unit", c.unit);
    lag_json_numbers(j, {"slope", c.slope}, {"slope_error", c.slope_error});
    lag_json_string(j, "trend", trends[c.trend]);
    lag_json_end(j, '}');
  }
  JSON_EACH(j, "monitors", '{', i, s->nmonitors)
    lag_json_number(j, s->monitors[i].name, lag_sim_monitor_drift(app->sim, i));
}

/* ---- The run */

static void final_state(const App *app, FILE *f) {
  const lag_model *m = app->scene->model;
  int n = 2 * m->nq + m->nz, most = n > MOST_LINES && (app->args.html || app->args.svg) ? BESIDE_PICTURE : MOST_LINES;
  for (int i = 0; i < n && i < most; i++) {
    Column c = lag_state_column(app->sim, i);
    fprintf(f, "  %-14s %.15g%s%s\n", c.name, lag_sim_state_value(app->sim, i), c.unit[0] ? " " : "", c.unit);
  }
  if (n > most) fprintf(f, "  (and %d more)\n", n - most);
}

/* Whether constraint k is redundant at the start; contacts do not count. */
static int is_redundant(const App *app, int k) {
  const lag_model *m = app->scene->model;
  for (int i = 0; i < m->ncontacts; i++)
    if (m->contacts[i].constraint == k) return 0;
  return lag_sim_is_redundant(app->sim, k);
}

/* Describes a singular start, where constraints are dependent that are independent nearby. */
static void singular(const App *app, FILE *f) {
  int n = 0;
  fprintf(f, "; singular: %d nearby", lag_sim_nearby_rank(app->sim));
  for (int i = 0; i < app->scene->model->nq; i++)
    if (lag_sim_is_undetermined(app->sim, i) && n++ < MOST_LINES)
      fprintf(f, "%s%s'", n == 1 ? ", and the starting value of " : ", ", app->scene->model->q[i].name);
  fprintf(f, "%s%s", n > MOST_LINES ? ", ..." : "", n ? " decides the branch of the motion" : "");
}

/* Constraints that are independent at the start; what friction holds there does not count. */
static int independent(const App *app) {
  int held = app->scene->model->constraints->n - app->scene->model->ncontacts, rank = lag_sim_rank(app->sim);
  return rank < held ? rank : held;
}

/* Whether the other assembly has another value of coordinate i than the start. */
static int is_elsewhere(const App *app, int i) {
  double other = lag_sim_other_start(app->sim, i), begin = lag_sim_actual_start(app->sim, i);
  return fabs(other - begin) > 1e-9 * (fabs(other) + fabs(begin));
}

/* The other assembly, and how it is chosen. */
static void other_start(const App *app, FILE *f) {
  int n = 0, first = -1;
  for (int i = 0; i < app->scene->model->nq; i++) {
    if (!is_elsewhere(app, i)) continue;
    Column c = lag_state_column(app->sim, i);
    first = n == 0 ? i : first;
    if (n++ < MOST_LINES)
      fprintf(f, "%s%s = %.6g%s%s", n == 1 ? "  other places obey them, too: " : ", ", c.name,
              lag_sim_other_start(app->sim, i), c.unit[0] ? " " : "", c.unit);
  }
  if (n)
    fprintf(f, "%s; `start guess %s = %.3g` takes that one\n", n > MOST_LINES ? ", ..." : "",
            lag_state_column(app->sim, first).name, lag_sim_other_start(app->sim, first));
}

/* Constraints: changes of the start, rank, redundant ones, largest residuals. */
static void constraints(const App *app, const lag_stats *st, FILE *f) {
  const lag_model *m = app->scene->model;
  const lag_constraints *of = m->constraints;
  int n = 2 * m->nq, moved = 0, redundant = 0;
  for (int i = 0; of && i < n; i++) {
    Column c = lag_state_column(app->sim, i);
    double asked = lag_sim_requested_start(app->sim, i), begin = lag_sim_actual_start(app->sim, i);
    if (asked != begin && moved++ < MOST_LINES) {
      fprintf(f, "%s %s from %.15g to %.15g%s%s (by %.3g)\n", moved == 1 ? "start moved to the constraints:" : "  and",
              c.name, asked, begin, c.unit[0] ? " " : "", c.unit, begin - asked);
    }
  }
  if (moved > MOST_LINES) fprintf(f, "  (and %d more)\n", moved - MOST_LINES);
  if (!of) return;
  other_start(app, f);
  if (of->n > m->ncontacts)
    fprintf(f, "constraints: %d, %d independent at the start", of->n - m->ncontacts, independent(app));
  for (int k = 0; k < of->n; k++)
    if (is_redundant(app, k) && redundant++ < MOST_LINES)
      fprintf(f, "%s%s", redundant == 1 ? "; redundant: " : ", ", of->of[k].name);
  if (lag_sim_nearby_rank(app->sim) > lag_sim_rank(app->sim)) singular(app, f);
  fprintf(f, "%s%sconstraint residual: %.3g, of rates %.3g (the largest, in SI)\n",
          redundant > MOST_LINES ? ", ..." : "", of->n > m->ncontacts ? "\n" : "", st->constraint, st->constraint_rate);
}

/* Notes: steps too long for the fastest oscillation; a symplectic method on a model for which it is not symplectic. */
/* 1: the run ends in the state in which it began, without velocities. *started: a start is not 0. */
static int stands_still(const App *app, int *started) {
  const lag_model *m = app->scene->model;
  *started = 0;
  for (int i = 0; i < 2 * m->nq + m->nz; i++) {
    double x = lag_sim_state_value(app->sim, i);
    if (x != lag_sim_actual_start(app->sim, i) || (i >= m->nq && i < 2 * m->nq && x != 0)) return 0;
    *started |= x != 0;
  }
  return app->status >= 0;
}

static void caveat(const App *app, const lag_stats *st, FILE *f) {
  const lag_method *m = lag_sim_method(app->sim);
  unsigned has = app->scene->model->flags;
  int started;
  if (st->steps > 0 && stands_still(app, &started)) {
    const char *name = lag_state_column(app->sim, 0).name;
    int held = app->scene->model->nguides && !isnan(lag_sim_guide_part(app->sim, 0));
    fprintf(f, "note: nothing moves: the scene begins at rest, where %s", held ? "friction holds it" : "no force acts");
    if (!started && !held)
      fprintf(f, "; write a start into it, `start %s = 0.1`, or give one here: %s=0.1", name, name);
    putc('\n', f);
  }
  if (isfinite(st->unresolved)) {
    fprintf(f,
            "note: steps are longer than half a period, about %.2g s, of the fastest oscillation: its motion is wrong, "
            "even if the energy is kept; take "
            "--step %.0e or less, or radau, which damps the oscillation, or dop853, which resolves it\n",
            st->unresolved, st->unresolved / 20);
  }
  if (!(m->flags & LAG_METHOD_SYMPLECTIC)) return;
  if (app->scene->model->nq == 0 && !(has & LAG_FIRST_ORDER)) {
    fprintf(f, "note: %s is symplectic for Lagrangians; here it is symmetric, and keeps quadratic invariants\n",
            m->name);
  } else if ((has & LAG_FIRST_ORDER) && (has & LAG_CONSERVES_ENERGY) && !(has & LAG_CONSTANT_FORM)) {
    fprintf(f,
            "note: %s is symplectic where the two-form of L is constant; here it varies, and the method is symmetric\n",
            m->name);
  } else if (!(has & LAG_CONSERVES_ENERGY)) {
    fprintf(f, "note: %s is symplectic for conservative models; the energy of this one is not proved to be conserved "
               "(lagc check)\n", m->name);
  }
}

/* Contacts that the method meets by impulses. */
static void impulses(const App *app, FILE *f) {
  lag_contact_stats c;
  if (!lag_sim_contacts(app->sim, &c)) return;
  fprintf(f,
          "contacts: at most %g act at once, %g impact%s, %.3g iterations a step with contacts; the deepest is %.3g "
          "inside (in SI)",
          c.touching, c.impacts, c.impacts == 1 ? "" : "s", c.steps > 0 ? c.sweeps / c.steps : 0, c.depth);
  if (c.gained > 0) fprintf(f, "; they bring in %.3g J", c.gained);
  putc('\n', f);
}

static void impulses_json(const App *app, Json *j) {
  lag_contact_stats c;
  if (!lag_sim_contacts(app->sim, &c)) return;
  lag_json_begin(j, "contacts", '{');
  lag_json_numbers(j, {"at_once", c.touching}, {"impacts", c.impacts}, {"iterations", c.sweeps}, {"steps", c.steps},
                      {"deepest", c.depth}, {"energy_gained", c.gained});
  lag_json_end(j, '}');
}

/* "explicit" or "implicit", and *why, for a method that has both forms; NULL for others. */
static const char *form(const App *app, const char **why) {
  unsigned has = app->scene->model->flags;
  if (!(lag_sim_method(app->sim)->flags & LAG_METHOD_SPLITS)) return NULL;
  has = app->scene->model->constraints ? has & ~(unsigned)LAG_SEPARABLE : has;
  *why = app->scene->model->constraints ? "in q and p by Newton's method: the model has constraints"
         : has & LAG_SEPARABLE ? "the model is separable"
         : has & LAG_CONSTANT_MASS ? "in q and p by Newton's method: forces depend on velocities"
                                   : "in q and p by Newton's method: the mass matrix varies";
  return has & LAG_SEPARABLE ? "explicit" : "implicit";
}

static void newton(const App *app, const lag_stats *st, FILE *f) {
  const char *why, *word = form(app, &why);
  if (word) fprintf(f, "%s steps, %s\n", word, why);
  if (st->systems > 0) {
    fprintf(f, "Newton's method: %.3g corrections a system, %.3g systems a step\n",
            (double)st->iterations / (double)st->systems, (double)st->systems / (double)(st->steps ? st->steps : 1));
  }
}

const char *lag_app_way_on(const App *app) {
  return app->status == LAG_EMONITOR ? "; with --no-monitors the run goes on past it" : "";
}

static void verdict(const App *app, FILE *f) {
  double t = lag_sim_time(app->sim);
  switch (app->status) {
  case LAG_OK: fprintf(f, "reached t = %.15g s\n", t); break;
  case LAG_STOPPED: fprintf(f, "stopped by an event at t = %s s\n", lag_number_text(t, (char[64]){0})); break;
  case LAG_INTERRUPTED: fprintf(f, "interrupted at t = %s s\n", lag_number_text(t, (char[64]){0})); break;
  default: fprintf(f, "FAILED: %s%s\n", lag_sim_message(app->sim), lag_app_way_on(app));
  }
}

static void exact(const App *app, FILE *f) {
  const lag_scene *c = app->scene;
  for (int k = 0; k < c->nexact && k < MOST_LINES; k++) {
    Column v = lag_state_column(app->sim, c->exact_of[k]);
    double largest, now;
    lag_sim_exact(app->sim, k, &largest, &now);
    const char *unit = strcmp(v.unit, "degC") == 0 ? "K" : v.unit; /* a difference */
    if (isnan(largest)) {
      fprintf(
          f, "exact %s: the closed form has no finite value at some states of the run, so the deviation is not known\n",
          v.name);
    } else {
      fprintf(f, "exact %s: largest deviation %.3g%s%s, final %.3g\n", v.name, largest, unit[0] ? " " : "", unit, now);
    }
  }
  if (c->nexact > MOST_LINES) fprintf(f, "  (and %d more)\n", c->nexact - MOST_LINES);
}

static void exact_json(const App *app, Json *j) {
  const lag_scene *c = app->scene;
  if (c->nexact == 0) return;
  JSON_EACH(j, "exact", '{', k, c->nexact) {
    Column v = lag_state_column(app->sim, c->exact_of[k]);
    double largest, now;
    lag_sim_exact(app->sim, k, &largest, &now);
    lag_json_begin(j, v.name, '{');
    lag_json_numbers(j, {"largest", largest}, {"final", now});
    lag_json_end(j, '}');
  }
}

void lag_report_text(App *app, FILE *f) {
  const lag_scene *c = app->scene;
  lag_stats st;
  lag_sim_stats(app->sim, &st);
  lag_report_head(app, f);
  if (app->why[0]) fprintf(f, "chosen: %s\n", app->why);
  verdict(app, f);
  final_state(app, f);
  lag_report_measures(app, f);
  fprintf(f, "steps %lld, rejected %lld, right-hand sides %lld, %.3g s\n", st.steps, st.rejected, st.rhs_calls,
          app->wall);
  newton(app, &st, f);
  impulses(app, f);
  lag_report_error(app, f);
  charges(app, f);
  constraints(app, &st, f);
  caveat(app, &st, f);
  for (int i = 0; i < c->nmonitors; i++)
    fprintf(f, "monitor %s: drift %.3g, limit %.3g\n", c->monitors[i].name, lag_sim_monitor_drift(app->sim, i),
            c->monitors[i].limit);
  exact(app, f);
  if (app->empty_rows) {
    fprintf(f, "note: the output %s has no finite value at t = %.9g s; the same in %lld of %lld rows\n",
            app->table.cols[app->empty_column].name, app->empty_t, app->empty_rows, app->rows_put);
  }
  lag_report_events(app, f);
  lag_report_switches(app, f);
  lag_report_guides(app, f);
  lag_report_tangent(app, f);
  lag_report_sensitivity(app, f);
  lag_report_gradient(app, f);
  lag_report_volume(app, f);
  if (app->written && app->args.out)
    fprintf(f, "%zu rows%s in %s\n", app->rows.nrows, app->status < 0 ? " up to the failure" : "", app->args.out);
  if (app->args.svg) fprintf(f, "picture in %s\n", app->args.svg);
  if (app->args.html) fprintf(f, "animation in %s\n", app->args.html);
}

/* JSON members: outputs at the end, except coordinates, velocities and states, so that no name appears twice. */
static void final_outputs(App *app, Json *j) {
  if (app->scene->nout == 0 || lag_sim_outputs(app->sim, app->row + 1)) return;
  for (int i = 1; i <= lag_sim_noutputs(app->sim); i++)
    if (lag_component_index(app->scene->model, app->table.cols[i].name) < 0)
      lag_json_number(j, app->table.cols[i].name, app->row[i]);
}

static void constraints_json(const App *app, Json *j) {
  const lag_model *m = app->scene->model;
  const lag_constraints *of = m->constraints;
  if (!of) return;
  lag_json_counts(j, {"constraints", of->n - m->ncontacts}, {"rank", lag_sim_rank(app->sim)});
  JSON_EACH(j, "redundant", '[', k, of->n)
    if (is_redundant(app, k)) lag_json_string(j, NULL, of->of[k].name);
  lag_json_count(j, "rank_beside", lag_sim_nearby_rank(app->sim));
  JSON_EACH(j, "start_moved", '{', i, 2 * m->nq) {
    double asked = lag_sim_requested_start(app->sim, i), begin = lag_sim_actual_start(app->sim, i);
    if (asked != begin) {
      lag_json_row(j, lag_state_column(app->sim, i).name, 2, (const double[]){asked, begin});
    }
  }
  JSON_EACH(j, "start_other", '{', i, m->nq)
    if (is_elsewhere(app, i)) lag_json_number(j, lag_state_column(app->sim, i).name, lag_sim_other_start(app->sim, i));
}

Json lag_app_json(const App *app, FILE *f) {
  Json j = lag_json_open(f);
  lag_json_strings(&j, {"model", app->scene->model->name}, {"scene", app->scene->name});
  return j;
}

Json lag_report_json_open(const App *app, FILE *f) {
  Json j = lag_app_json(app, f);
  lag_json_strings(&j, {"method", lag_sim_method(app->sim)->name}, {"chosen", app->why[0] ? app->why : NULL},
                       {"status", app->status < 0 ? "failed" : lag_status_name(app->status)});
  return j;
}

/* The energy, the error of the motion, and digits that were lost. */
static void energy_json(App *app, const lag_stats *st, Json *j) {
  lag_charge_stats energy = {.absolute = NAN};
  if (lag_sim_ncharges(app->sim)) lag_sim_charge(app->sim, 0, &energy);
  int conserved = (energy.flags & LAG_CONSERVED) != 0; /* else null */
  lag_json_number(j, "energy_drift", conserved ? st->energy_drift : NAN);
  lag_report_error_json(app, j);
  lag_json_number(j, "energy_drift_absolute", conserved ? energy.absolute : NAN);
  lag_json_number(j, "unresolved_period", st->unresolved);
  lag_json_count(j, "rows_without_value", app->empty_rows);
  if (!lost_digits(app, &energy)) return;
  lag_json_begin(j, "digits_lost", '{');
  lag_json_numbers(j, {"t", energy.energy_jump_t}, {"energy_step", energy.energy_jump});
  lag_json_string(j, "coordinate", energy.mass_condition_of);
  lag_json_number(j, "condition", energy.mass_condition);
  lag_json_end(j, '}');
}

void lag_report_json(App *app, FILE *f) {
  const lag_model *m = app->scene->model;
  int n = 2 * m->nq + m->nz;
  const char *why;
  lag_stats st;
  Json j = lag_report_json_open(app, f);
  lag_sim_stats(app->sim, &st);
  lag_json_string(&j, "message", app->status < 0 ? lag_sim_message(app->sim) : NULL);
  lag_json_number(&j, "t_end", st.t);
  lag_json_counts(&j, {"steps", st.steps}, {"rejected", st.rejected}, {"rhs_calls", st.rhs_calls});
  lag_json_string(&j, "form", form(app, &why));
  lag_json_counts(&j, {"newton_systems", st.systems}, {"newton_iterations", st.iterations});
  lag_json_name(&j, "wall_s");
  fprintf(f, "%.6g", app->wall); /* 6 digits in any precision */
  energy_json(app, &st, &j);
  charges_json(app, &j);
  lag_report_events_json(app, &j);
  lag_report_switches_json(app, &j);
  lag_report_guides_json(app, &j);
  exact_json(app, &j);
  lag_report_measures_json(app, &j);
  lag_report_tangent_json(app, &j);
  lag_report_sensitivity_json(app, &j);
  lag_report_gradient_json(app, &j);
  lag_report_volume_json(app, &j);
  lag_json_strings(&j, {"math", m->math}, {"build", app->program->build});
  lag_json_number(&j, "constraint_residual", st.constraint); /* null without constraints */
  lag_json_number(&j, "constraint_rate_residual", st.constraint_rate);
  constraints_json(app, &j);
  impulses_json(app, &j);
  lag_json_begin(&j, "final", '{');
  for (int i = 0; i < n; i++) lag_json_number(&j, lag_state_column(app->sim, i).name, lag_sim_state_value(app->sim, i));
  final_outputs(app, &j);
  lag_json_end(&j, '}');
  lag_json_close(&j);
}
