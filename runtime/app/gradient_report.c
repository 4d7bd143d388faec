/* --gradient: derivatives of the measures of a run by all its parameters and starts. Enters: a run that has ended, with
 * its measures; leaves: a list for each measure, in declared units, or members in JSON. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "core/core.h"
#include "core/rhs.h"

int lag_app_gradient_open(App *app) {
  if (!app->args.gradient) return 0;
  return app->measures ? 0 : lag_app_error(&app->args, "--gradient differentiates measures, and there are none");
}

/* Whether the gradient is that of the run's own method: its steps have derivatives by parameters. One that was chosen
 * automatically, and lacks the reverse mode that dop853 has, gives way: a matrix for each step takes longer. */
static int has_derivatives(App *app) {
  const lag_model *m = app->scene->model;
  const lag_method *method = lag_sim_method(app->sim);
  if (app->why[0] && !method->adjoint && lag_adjoint_of(m)) return 0;
  lag_sim *sim = lag_app_fresh_sim(app);
  int has = sim && lag_app_copy_method(app->sim, sim, 1) == LAG_OK && lag_sim_record(sim) == LAG_OK;
  lag_sim_free(sim);
  return has;
}

/* A run like the last one, before its first step, by its method or, where that has no derivative by parameters, by
 * dop853. */
static lag_sim *like_run(App *app) {
  lag_sim *sim = lag_app_fresh_sim(app);
  int own = has_derivatives(app),
      rc = !sim  ? LAG_ENOMEM
           : own ? lag_app_copy_method(app->sim, sim, 1)
                 : lag_sim_set_method(sim, &lag_dop853, NULL, 0);
  if (rc == LAG_OK && !own) rc = lag_sim_set_tolerance(sim, fmin(app->sim->tol, 1e-9));
  if (rc == LAG_OK) return sim;
  lag_sim_free(sim);
  return NULL;
}

int lag_measure_gradient(App *app, int k, double *d, char *why, size_t size) {
  const lag_model *m = app->scene->model;
  int n = app->sim->pb.n, rc = -1;
  lag_sim *sim = like_run(app);
  snprintf(why, size, "out of memory");
  if (sim) rc = lag_measures_gradient(app->measures, k, sim, d, d + n, why, size);
  for (int i = 0; i < n + m->np && rc == 0; i++)
    d[i] *= i < n ? lag_sim_state_info(app->sim, i, NULL, 0, NULL, 0) : m->p[i - n].factor;
  lag_sim_free(sim);
  return rc;
}

void lag_gradient_name(const App *app, int i, char *name, char *unit) {
  int n = app->sim->pb.n;
  const lag_var *p = i < n ? NULL : &app->scene->model->p[i - n];
  if (p) snprintf(name, LAG_GRADIENT_NAME, "%s", p->name), snprintf(unit, LAG_GRADIENT_NAME, "%s", p->unit);
  else lag_sim_state_info(app->sim, i, name, LAG_GRADIENT_NAME - 4, unit, LAG_GRADIENT_NAME), strcat(name, "(0)");
}

/* A unit; "" of pure numbers. */
static const char *bare(const char *unit) { return strcmp(unit, "1") == 0 ? "" : unit; }

static void put_list(App *app, FILE *f, int k, const double *d) {
  char name[LAG_GRADIENT_NAME], unit[LAG_GRADIENT_NAME], over[LAG_GRADIENT_NAME], under[LAG_GRADIENT_NAME];
  char label[LAG_GRADIENT_NAME + 60];
  const char *of = bare(lag_measures_unit(app->measures, k));
  lag_unit_in_fraction(over, sizeof over, of);
  fprintf(f, "gradient of %s, by reverse mode%s\n", app->measure_names[k],
          has_derivatives(app) ? "" : " of a run by dop853");
  for (int i = 0; i < app->sim->pb.n + app->scene->model->np; i++) {
    lag_gradient_name(app, i, name, unit);
    lag_unit_in_fraction(under, sizeof under, unit);
    snprintf(label, sizeof label, "d/d%s", name);
    if (strcmp(of, bare(unit)) == 0) fprintf(f, "  %-20s %.12g\n", label, d[i]);
    else if (!bare(unit)[0]) fprintf(f, "  %-20s %.12g %s\n", label, d[i], of);
    else fprintf(f, "  %-20s %.12g %s/%s\n", label, d[i], of[0] ? over : "1", under);
  }
}

void lag_report_gradient(App *app, FILE *f) {
  char why[400];
  if (!app->args.gradient || app->status < 0) return;
  double *d = calloc((size_t)(app->sim->pb.n + app->scene->model->np) + 1, sizeof *d);
  for (int k = 0; d && k < lag_measures_count(app->measures); k++) {
    int none = lag_measure_gradient(app, k, d, why, sizeof why);
    if (none) fprintf(f, "no gradient of %s: %s\n", app->measure_names[k], why);
    else put_list(app, f, k, d);
  }
  free(d);
}

void lag_report_gradient_json(App *app, Json *j) {
  char why[400], name[LAG_GRADIENT_NAME], unit[LAG_GRADIENT_NAME];
  int n = app->sim->pb.n, np = app->scene->model->np;
  if (!app->args.gradient || app->status < 0) return;
  double *d = calloc((size_t)(n + np) + 1, sizeof *d);
  lag_json_begin(j, "gradient", '{');
  for (int k = 0; d && k < lag_measures_count(app->measures); k++) {
    int none = lag_measure_gradient(app, k, d, why, sizeof why);
    lag_json_begin(j, app->measure_names[k], '{');
    if (none) lag_json_string(j, "none", why);
    for (int i = 0; i < n + np && !none; i++) lag_gradient_name(app, i, name, unit), lag_json_number(j, name, d[i]);
    lag_json_end(j, '}');
  }
  lag_json_end(j, '}');
  free(d);
}
