/* Output of --cost: the table of all runs, the time for each accuracy, JSON, and the picture. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/cost.h"

static int adaptive(const CostMethod *m)
{
  return (m->method->flags & LAG_METHOD_ADAPTIVE) != 0;
}

/* text[n] := the method with its option, "variational(order=4)". */
static void name_of(const CostMethod *m, char *text, size_t n)
{
  if (m->option.name) {
    snprintf(text, n, "%s(%s=%g)", m->method->name, m->option.name, m->option.value);
  } else {
    snprintf(text, n, "%s", m->method->name);
  }
}

void lag_cost_setting(const CostMethod *m, const CostRun *run, char *text, size_t n)
{
  char option[64] = "";

  if (m->option.name) {
    snprintf(option, sizeof option, "%s=%g, ", m->option.name, m->option.value);
  }
  snprintf(text, n, "%s(%s%s=%.9g)", m->method->name, option, adaptive(m) ? "tol" : "step", run->knob);
}

void lag_cost_options(const CostMethod *m, const CostRun *run, char *text, size_t n)
{
  char option[64] = "";

  if (m->option.name) {
    snprintf(option, sizeof option, " --%s %g", m->option.name, m->option.value);
  }
  snprintf(text, n, "--method %s%s --%s %.9g", m->method->name, option, adaptive(m) ? "tol" : "step", run->knob);
}

static const char *order_of(const CostMethod *m, char *text, size_t n)
{
  snprintf(text, n, adaptive(m) ? "%.1f" : "%.2f", m->order);
  return isnan(m->order) ? "-" : text;
}

static void table(FILE *f, const Cost *c)
{
  char setting[160], order[32], spread[32];

  fprintf(f, "  %-44s %-9s %12s %6s %10s %11s  %s\n", "", "error", "time [ms]", "+-", "steps", "calls", "order");
  for (int i = 0; i < c->nmethods; i++) {
    const CostMethod *m = &c->method[i];
    for (int k = 0; k < m->nruns; k++) {
      const CostRun *r = &m->run[k];
      lag_cost_setting(m, r, setting, sizeof setting);
      snprintf(spread, sizeof spread, "%.0f %%", 50 * r->spread);
      fprintf(f, "%c %-44s %-9.2e %12.4g %6s %10lld %11lld%s%s\n", r->best ? '*' : ' ', setting, r->error, 1e3 * r->time,
              isnan(r->spread) ? "-" : spread, r->steps, r->calls, k == 0 ? "  " : "", k == 0 ? order_of(m, order, sizeof order) : "");
    }
  }
  fputs("* no other run is both faster and more accurate. time: median processor time; +- half of the interquartile range of the\n"
        "times. order: slope of log error against log steps, at the smallest errors above rounding\n", f);
}

/* The fastest run of a method with at most this error; NULL: none. */
static const CostRun *fastest(const CostMethod *m, double error)
{
  const CostRun *best = NULL;

  return lag_cost_cheapest(m, 1, error, &best) ? best : NULL;
}

/* A line for each method: its time for errors of 1e-2, 1e-4, ... */
static void print_time_table(FILE *f, const Cost *c)
{
  enum { COLUMNS = 7 };
  char name[96];

  fprintf(f, "\n  %-30s", "time [ms] for an error of");
  for (int e = 1; e <= COLUMNS; e++) {
    snprintf(name, sizeof name, "1e-%d", 2 * e);
    fprintf(f, " %9s", name);
  }
  putc('\n', f);
  for (int i = 0; i < c->nmethods; i++) {
    const CostMethod *m = &c->method[i];
    if (m->nruns == 0) {
      continue;
    }
    name_of(m, name, sizeof name);
    fprintf(f, "  %-30s", name);
    for (int e = 1; e <= COLUMNS; e++) {
      const double error = pow(10, -2 * e);
      const CostRun *own = fastest(m, error), *any;
      if (own) {
        lag_cost_cheapest(c->method, c->nmethods, error, &any);
        fprintf(f, " %8.3g%c", 1e3 * own->time, own == any ? '*' : ' ');
      } else {
        fprintf(f, " %8s ", "-");
      }
    }
    putc('\n', f);
  }
}

static void print_omitted(FILE *f, const Cost *c)
{
  char name[96];

  for (int i = 0; i < c->nmethods; i++) {
    const CostMethod *m = &c->method[i];
    if (m->nruns == 0) {
      name_of(m, name, sizeof name);
      fprintf(f, "not in the table: %s: %s\n", name, m->why[0] ? m->why : "no run had an error below 0.3 in the time allowed (--longest)");
    }
  }
}

static void target(FILE *f, const App *app, const Cost *c)
{
  const CostRun *run;
  const CostMethod *m = lag_cost_cheapest(c->method, c->nmethods, c->target, &run);
  char options[160];

  if (m) {
    lag_cost_options(m, run, options, sizeof options);
    fprintf(f, "\ncheapest setting for an error of %g: %s (error %.2e, %.4g ms)\n  lagc run %s %s %s\n", c->target, options, run->error,
            1e3 * run->time, app->program->source, app->scene->name, options);
  } else {
    fprintf(f, "\nno setting has an error of %g or less; raise --target, or allow longer runs: --longest SECONDS\n", c->target);
  }
}

void lag_cost_text(FILE *f, const App *app, const Cost *c)
{
  const Samples *s = &c->reference;

  fprintf(f, "model %s, scene %s, to t = %.15g s\n", app->scene->model->name, app->scene->name, s->t[s->rows - 1]);
  fprintf(f, "error: the largest difference from the reference at %d times, relative to the largest value of its kind and unit\n", s->rows);
  fprintf(f, "reference: %s, itself uncertain by %.1e\n\n", c->reference_name, s->uncertainty);
  table(f, c);
  print_time_table(f, c);
  print_omitted(f, c);
  if (c->target > 0) {
    target(f, app, c);
  }
}

/* ---- JSON */

void lag_cost_json(FILE *f, const App *app, const Cost *c)
{
  const Samples *s = &c->reference;
  const CostRun *cheapest = NULL;

  if (c->target > 0) {
    lag_cost_cheapest(c->method, c->nmethods, c->target, &cheapest);
  }
  Json j = {.f = f};
  lag_json_begin(&j, NULL, '{');
  lag_json_string(&j, "model", app->scene->model->name);
  lag_json_string(&j, "scene", app->scene->name);
  lag_json_number(&j, "until", s->t[s->rows - 1]);
  lag_json_string(&j, "reference", c->reference_name);
  lag_json_number(&j, "uncertainty", s->uncertainty);
  lag_json_number(&j, "target", c->target > 0 ? c->target : NAN);
  lag_json_begin(&j, "methods", '[');
  for (int i = 0; i < c->nmethods; i++) {
    const CostMethod *m = &c->method[i];
    char name[96];
    name_of(m, name, sizeof name);
    lag_json_begin(&j, NULL, '{');
    lag_json_string(&j, "method", name);
    lag_json_number(&j, "order", m->order);
    lag_json_string(&j, "refused", m->why[0] ? m->why : NULL);
    lag_json_begin(&j, "runs", '[');
    for (int k = 0; k < m->nruns; k++) {
      const CostRun *r = &m->run[k];
      lag_json_begin(&j, NULL, '{');
      lag_json_number(&j, adaptive(m) ? "tolerance" : "step", r->knob);
      lag_json_number(&j, "error", r->error);
      lag_json_number(&j, "seconds", r->time);
      lag_json_number(&j, "spread", r->spread);
      lag_json_count(&j, "steps", r->steps);
      lag_json_count(&j, "calls", r->calls);
      lag_json_truth(&j, "front", r->best);
      lag_json_truth(&j, "cheapest", r == cheapest);
      lag_json_end(&j, '}');
    }
    lag_json_end(&j, ']');
    lag_json_end(&j, '}');
  }
  lag_json_end(&j, ']');
  lag_json_end(&j, '}');
  putc('\n', f);
}

/* ---- Picture */

int lag_cost_picture(const char *path, const App *app, const Cost *c)
{
  Series *series = calloc((size_t)c->nmethods + 1, sizeof *series);
  double *values = calloc((size_t)c->nmethods * LAG_COST_MOST_RUNS * 2 + 1, sizeof *values);
  char title[300];
  int n = 0, rc = -1;

  for (int i = 0; series && values && i < c->nmethods; i++) {
    const CostMethod *m = &c->method[i];
    Series *s = &series[n];
    double *at = values + (size_t)i * LAG_COST_MOST_RUNS * 2;
    if (m->nruns == 0) {
      continue;
    }
    name_of(m, s->name, sizeof s->name);
    s->n = m->nruns;
    s->x = at;
    s->y = at + LAG_COST_MOST_RUNS;
    for (int k = 0; k < m->nruns; k++) {
      at[k] = fmax(m->run[k].error, DBL_EPSILON / 1024);
      at[LAG_COST_MOST_RUNS + k] = m->run[k].time;
    }
    n++;
  }
  snprintf(title, sizeof title, "%s, %s: time against error", app->scene->model->name, app->scene->name);
  if (series && values) {
    rc = lag_svg_chart(path, title, "error", "processor time [s]", series, n);
  }
  free(series);
  free(values);
  return rc;
}
