/* --sensitivity beside --measure: derivatives of measures. A measure is a number of the whole run, such as a maximum or
 * the time of an event; it is differentiated by differences of order 4 between runs with neighbouring values. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "core/core.h"

static const double part = 0x1p-7; /* of a value, or of its unit where it is 0: a step */

/* out[measures] of a run with one value, in its declared unit. LAG_OK, or a failure. */
static int measures_with(App *app, const char *name, double value, double *out) {
  char why[400];
  lag_sim *sim = lag_app_fresh_sim(app);
  Measures *m =
      sim ? lag_measures_new(app->scene, lag_measures_count(app->measures), app->measure_texts, NULL, why, sizeof why)
          : NULL;
  int rc = !m ? LAG_ENOMEM : lag_app_copy_method(app->sim, sim, 1);
  rc = rc ? rc : lag_sim_set(sim, name, value);
  rc = rc || isnan(app->skip) ? rc : lag_sim_advance(sim, app->skip);
  rc = rc ? rc : lag_measures_begin(m, sim);
  if (rc == LAG_OK) rc = lag_measures_advance(m, app->until);
  if (rc >= 0 && m) rc = lag_measures_end(m, out);
  lag_measures_free(m);
  lag_sim_free(sim);
  return rc;
}

int lag_measures_by(App *app, int j, double *d) {
  static const double weight[] = {0, 2.0 / 3, -1.0 / 12};
  char label[128], name[128];
  double factor = lag_sim_sensitivity_info(app->sim, j, label, sizeof label, NULL, 0);
  snprintf(name, sizeof name, "%.*s", (int)(strlen(label) - (strstr(label, "(0)") ? 3 : 0)), label);
  int n = lag_measures_count(app->measures), rc = LAG_OK;
  double at = lag_sim_sensitivity_value(app->sim, j) / factor, h = part * (at != 0.0 ? fabs(at) : 1),
         *out = calloc((size_t)n + 1, sizeof *out);
  if (!out) return LAG_ENOMEM;
  memset(d, 0, (size_t)n * sizeof *d);
  for (int k = -1; k >= -2 && rc == LAG_OK; k = k < 0 ? -k : -k - 1) {
    rc = measures_with(app, name, at + k * h, out);
    for (int i = 0; i < n; i++) d[i] += (k < 0 ? -weight[-k] : weight[k]) * out[i] / h;
  }
  free(out);
  return rc;
}
