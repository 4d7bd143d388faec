/* What a run's report says of its energy, and of the charges of symmetries: how far each has drifted, or its balance, and whether that
 * grows. */
#include <math.h>

#include "app/app.h"

/* "energy drift", "spin balance" */
static const char *what_of(const lag_charge_stats *c)
{
  return c->flags & LAG_CONSERVED ? "drift" : c->flags & LAG_BALANCED ? "balance" : "change";
}

static void put_trend(const App *app, const lag_charge_stats *c, FILE *f)
{
  const lag_method *m = lag_sim_method(app->sim);
  int model_keeps = (app->scene->model->flags & LAG_CONSERVES_ENERGY) != 0;

  switch (c->trend) {
  case LAG_TREND_GROWS:
    fprintf(f, ", grows by %.2g a second", fabs(c->slope));
    break;
  case LAG_TREND_OSCILLATES:
    fputs(", oscillates", f);
    if ((m->flags & LAG_METHOD_SYMPLECTIC) && model_keeps) {
      fprintf(f, " (as step^%d)", m->order_of ? m->order_of(lag_sim_options(app->sim)) : m->order);
    }
    break;
  case LAG_TREND_ROUNDING:
    fputs(", rounding", f);
    break;
  default:
    break;
  }
}

/* Why there is no balance. */
static const char *why_not(const App *app, const lag_charge_stats *c)
{
  if (c->flags & LAG_JUMPS) {
    return "it jumps where L does";
  }
  return lag_method_balances(lag_sim_method(app->sim)) ? "not conserved, or not known to be" : "not conserved, and the method tells too little between steps for a balance";
}

static void put_energy(const App *app, const lag_charge_stats *c, FILE *f)
{
  const char *size = "relative to max(|E0|, max(|p.v| + |L|))";

  if (c->flags & LAG_CONSERVED) {
    fprintf(f, "(%s)", size);
  } else if (c->flags & LAG_BALANCED) {
    fprintf(f, "(forces and explicit time brought %.6g; %s)", c->work, size);
  } else {
    fprintf(f, "(%s)", why_not(app, c));
  }
}

static void put_charge(const App *app, const lag_charge_stats *c, FILE *f)
{
  fprintf(f, "(from %.6g%s%s", c->begin + 0.0, c->unit[0] ? " " : "", c->unit);
  if (c->flags & LAG_CONSERVED) {
    fputs(")", f);
  } else if (c->flags & LAG_BALANCED) {
    fprintf(f, "; forces brought %.6g)", c->work);
  } else {
    fprintf(f, "; %s)", why_not(app, c));
  }
}

void report_charges(const App *app, FILE *f)
{
  for (int k = 0; k < lag_sim_ncharges(app->sim); k++) {
    lag_charge_stats c;
    lag_sim_charge(app->sim, k, &c);
    if (!isfinite(c.drift)) {
      fprintf(f, "%s: not finite\n", c.name);
      continue;
    }
    fprintf(f, "%s %s: %.3g ", c.name, what_of(&c), c.drift);
    if (k) {
      put_charge(app, &c, f);
    } else {
      put_energy(app, &c, f);
    }
    put_trend(app, &c, f);
    putc('\n', f);
  }
}

static void field(FILE *f, const char *name, double x)
{
  fprintf(f, "\"%s\": ", name);
  json_number(f, x);
  fputs(", ", f);
}

void report_charges_json(const App *app, FILE *f)
{
  static const char *const trends[] = {
      [LAG_TREND_UNKNOWN] = NULL, [LAG_TREND_ROUNDING] = "rounding", [LAG_TREND_OSCILLATES] = "oscillates", [LAG_TREND_GROWS] = "grows"};
  const lag_scene *s = app->scene;

  fputs("\"charges\": {", f);
  for (int k = 0; k < lag_sim_ncharges(app->sim); k++) {
    lag_charge_stats c;
    lag_sim_charge(app->sim, k, &c);
    fputs(k ? ", " : "", f);
    json_string(f, c.name);
    fprintf(f, ": {\"is\": \"%s\", ", c.flags & LAG_CONSERVED ? "conserved" : c.flags & LAG_BALANCED ? "balanced" : "not known");
    field(f, "initial", c.begin);
    field(f, "final", c.now);
    field(f, "work", c.work);
    field(f, "drift", c.drift);
    field(f, "slope", c.slope);
    field(f, "slope_error", c.slope_error);
    fputs("\"trend\": ", f);
    json_string(f, trends[c.trend]);
    putc('}', f);
  }
  fputs("}, \"monitors\": {", f);
  for (int i = 0; i < s->nmonitors; i++) {
    fputs(i ? ", " : "", f);
    json_string(f, s->monitors[i].name);
    fputs(": ", f);
    json_number(f, lag_sim_monitor_drift(app->sim, i));
  }
  fputs("}, ", f);
}
