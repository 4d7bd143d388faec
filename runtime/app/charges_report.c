/* Report on the energy and the charges of symmetries. Enters: a finished run; leaves, as text or JSON: drift or balance of each,
 * and whether it grows. */
#include <math.h>

#include "app/app.h"

/* The word after the name: "energy drift", "spin balance". */
static const char *what_of(const lag_charge_stats *c) { return c->flags & LAG_CONSERVED ? "drift" : c->flags & LAG_BALANCED ? "balance" : "change"; }

static void put_trend(const App *app, const lag_charge_stats *c, FILE *f) {
  const lag_method *m = lag_sim_method(app->sim);
  int model_keeps = (app->scene->model->flags & LAG_CONSERVES_ENERGY) != 0;
  switch (c->trend) {
  case LAG_TREND_GROWS:
    fprintf(f, ", grows by %.2g a second", fabs(c->slope));
    break;
  case LAG_TREND_OSCILLATES:
    fputs(", oscillates", f);
    if ((m->flags & LAG_METHOD_SYMPLECTIC) && model_keeps)
      fprintf(f, " (as step^%d)", m->order_of ? m->order_of(lag_sim_options(app->sim)) : m->order);
    break;
  case LAG_TREND_ROUNDING:
    fputs(", rounding", f);
    break;
  default:
    break;
  }
}

/* Reason why there is no balance. */
static const char *why_not(const App *app, const lag_charge_stats *c) {
  if (c->flags & LAG_JUMPS) return "jumps where L does";
  return lag_method_balances(lag_sim_method(app->sim)) ? "not conserved, or not known to be" : "not conserved; the dense output of the method is too coarse for a balance";
}

static void put_energy(const App *app, const lag_charge_stats *c, FILE *f) {
  const char *size = "relative to the larger of |E0| and the median of |p.v| + |L|", *space = c->unit[0] ? " " : "";
  if (!(c->flags & (LAG_CONSERVED | LAG_BALANCED))) {
    fprintf(f, "(%s)", why_not(app, c));
    return;
  }
  fprintf(f, "(%.3g%s%s; ", c->absolute, space, c->unit);
  if (!(c->flags & LAG_CONSERVED)) fprintf(f, "work of forces and explicit time: %.6g%s%s; ", c->work, space, c->unit);
  fprintf(f, "%s)", size);
}

static void put_charge(const App *app, const lag_charge_stats *c, FILE *f) {
  fprintf(f, "(from %.6g%s%s", c->begin + 0.0, c->unit[0] ? " " : "", c->unit);
  if (c->flags & LAG_CONSERVED) fputs(")", f);
  else if (c->flags & LAG_BALANCED) fprintf(f, "; change by forces: %.6g)", c->work);
  else fprintf(f, "; %s)", why_not(app, c));
}

int lag_report_lost_digits(const App *app, const lag_charge_stats *energy) {
  const double singular = 1e6, digits = 100;
  return (lag_sim_method(app->sim)->flags & LAG_METHOD_ADAPTIVE) && energy->energy_jump > digits * lag_sim_tolerance(app->sim) && energy->mass_condition > singular;
}

/* Warns that the tolerance was missed because the mass matrix was almost singular on the way. */
static void put_lost_digits(const App *app, const lag_charge_stats *c, FILE *f) {
  if (lag_report_lost_digits(app, c)) {
    fprintf(f, "accuracy: a tolerance of %.3g was asked for, and the energy is kept to %.2g: near t = %.9g s, where a step changed the energy by %.2g, the mass matrix is "
               "almost singular (its condition is %s%.2g, by the inertia of %s) and accelerations have about %.0f digits less; a `rotation` instead of angles, or other "
               "coordinates, has no such place (lagc help rotations)\n",
            lag_sim_tolerance(app->sim), c->drift, c->energy_jump_t, c->energy_jump, c->mass_condition > 1e15 ? "above " : "", fmin(c->mass_condition, 1e15), c->mass_condition_of, floor(log10(fmin(c->mass_condition, 1e15))));
  }
}

void lag_report_charges(const App *app, FILE *f) {
  for (int k = 0; k < lag_sim_ncharges(app->sim); k++) {
    lag_charge_stats c;
    lag_sim_charge(app->sim, k, &c);
    if (!isfinite(c.drift)) {
      fprintf(f, "%s: not finite\n", c.name);
      continue;
    }
    fprintf(f, "%s %s: %.3g ", c.name, what_of(&c), c.drift);
    if (k) put_charge(app, &c, f);
    else put_energy(app, &c, f);
    put_trend(app, &c, f);
    putc('\n', f);
    if (k == 0) put_lost_digits(app, &c, f);
  }
}

void lag_report_charges_json(const App *app, Json *j) {
  static const char *const trends[] = {
      [LAG_TREND_UNKNOWN] = NULL, [LAG_TREND_ROUNDING] = "rounding", [LAG_TREND_OSCILLATES] = "oscillates", [LAG_TREND_GROWS] = "grows"};
  const lag_scene *s = app->scene;
  lag_json_begin(j, "charges", '{');
  for (int k = 0; k < lag_sim_ncharges(app->sim); k++) {
    lag_charge_stats c;
    lag_sim_charge(app->sim, k, &c);
    lag_json_begin(j, c.name, '{');
    lag_json_string(j, "is", c.flags & LAG_CONSERVED ? "conserved" : c.flags & LAG_BALANCED ? "balanced" : "not known");
    lag_json_number(j, "initial", c.begin);
    lag_json_number(j, "final", c.now);
    lag_json_number(j, "work", c.work);
    lag_json_number(j, "drift", c.drift);
    lag_json_number(j, "drift_absolute", c.absolute);
    lag_json_string(j, "unit", c.unit);
    lag_json_number(j, "slope", c.slope);
    lag_json_number(j, "slope_error", c.slope_error);
    lag_json_string(j, "trend", trends[c.trend]);
    lag_json_end(j, '}');
  }
  lag_json_end(j, '}');
  lag_json_begin(j, "monitors", '{');
  for (int i = 0; i < s->nmonitors; i++) lag_json_number(j, s->monitors[i].name, lag_sim_monitor_drift(app->sim, i));
  lag_json_end(j, '}');
}
