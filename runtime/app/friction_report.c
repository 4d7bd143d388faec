/* The report of a run on switching surfaces and guides, as text and JSON. */
#include <math.h>
#include <stdio.h>

#include "app/app.h"
#include "core/core.h"

enum { MOST_LINES = 24 };

/* Switching surfaces that the motion has crossed, or slid on. */
void lag_report_switches(const App *app, FILE *f) {
  const lag_model *m = app->scene->model;
  int lines = 0;
  for (int k = 0; k < m->nmodes && lines < MOST_LINES; k++) {
    long long crossings, slides;
    double time = lag_sim_switch_times(app->sim, k, &crossings, &slides);
    if (crossings + slides == 0) continue;
    lines++;
    fprintf(f, "surface %s = %s: crossed %lld time%s", m->switches[k].surface, lag_switch_value(&m->switches[k]),
            crossings, crossings == 1 ? "" : "s");
    if (slides) fprintf(f, "; stuck or slid there %lld time%s, for %.6g s", slides, slides == 1 ? "" : "s", time);
    putc('\n', f);
  }
}

/* Guides that stick at the end of the run. */
void lag_report_guides(const App *app, FILE *f) {
  const lag_model *m = app->scene->model;
  for (int k = 0; k < m->nguides && k < MOST_LINES; k++) {
    double part = lag_sim_guide_part(app->sim, k);
    if (isnan(part)) continue;
    fprintf(f, "guide %s sticks", m->constraints->of[m->contacts[m->guides[k].tangent].constraint].name);
    if (part > 1e-9) /* beyond rounding */
      fprintf(f,
              ", self-locking: it needs %.3g %% of the friction that its force allows, also where all loads grow alike",
              100 * part);
    putc('\n', f);
  }
}

void lag_report_guides_json(const App *app, Json *j) {
  const lag_model *m = app->scene->model;
  if (m->nguides == 0) return;
  JSON_EACH(j, "guides", '{', k, m->nguides)
    lag_json_number(j, m->constraints->of[m->contacts[m->guides[k].tangent].constraint].name,
                    lag_sim_guide_part(app->sim, k));
}

void lag_report_switches_json(const App *app, Json *j) {
  const lag_model *m = app->scene->model;
  if (m->nmodes == 0) return;
  JSON_EACH(j, "surfaces", '{', k, m->nmodes) {
    long long crossings, slides;
    double time = lag_sim_switch_times(app->sim, k, &crossings, &slides);
    lag_json_begin(j, m->switches[k].surface, '{');
    lag_json_counts(j, {"crossings", crossings}, {"slides", slides});
    lag_json_number(j, "sliding_s", time);
    lag_json_end(j, '}');
  }
}
