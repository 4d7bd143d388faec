/* --volume: the volume of the phase space along a run (analysis/phase_volume.h). Enters: a run; leaves: a line of
 * the report, or members in JSON. */
#include <math.h>

#include "app/app.h"

int lag_app_volume_open(App *app) {
  if (!app->args.volume) return 0;
  int rc = lag_phase_volume_begin(&app->volume, app->sim);
  return rc ? lag_app_error(&app->args, "%s", rc == LAG_ENOMEM ? "out of memory" : lag_sim_message(app->sim)) : 0;
}

void lag_app_volume_step(App *app) {
  if (app->volume_rc == 0) app->volume_rc = lag_phase_volume_step(&app->volume, app->sim);
}

/* The space whose volume is meant. */
static const char *space_of(const App *app) {
  const lag_model *m = app->scene->model;
  return m->nq == 0 ? "of the state" : m->nz ? "of q, p and the states" : "of q and p";
}

/* Where q and p in which the flow keeps volumes are no coordinates of the model. */
static const char *caveat(const App *app) {
  unsigned has = app->scene->model->flags;
  return (has & LAG_FIRST_ORDER) && !(has & LAG_CONSTANT_FORM) ? "; not that of Liouville, as the two-form of L varies"
                                                               : "";
}

void lag_report_volume(App *app, FILE *f) {
  PhaseVolume *v = &app->volume;
  if (!v->n || app->status < 0) return;
  double log_det = lag_phase_volume_now(v, app->sim);
  if (isinf(log_det)) fprintf(f, "volume of phase space: 0, as neighbouring motions become one where a slide begins\n");
  else
    fprintf(f, "volume of phase space, %s: log %.6g at the end, at most %.3g in size on the way%s\n", space_of(app),
            log_det, fmax(v->largest, fabs(log_det)), caveat(app));
}

void lag_report_volume_json(App *app, Json *j) {
  PhaseVolume *v = &app->volume;
  if (!v->n || app->status < 0) return;
  double log_det = lag_phase_volume_now(v, app->sim);
  lag_json_begin(j, "volume", '{');
  lag_json_string(j, "space", space_of(app));
  lag_json_numbers(j, {"log", log_det}, {"largest", fmax(v->largest, fabs(log_det))});
  lag_json_end(j, '}');
}
