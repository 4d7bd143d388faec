/* Poincare section (--section): rows at the crossings of a surface, given as an event of the model that changes nothing.
 * Enters: the event's name, and events during the run; leaves: a row for each crossing. Holds: a row is on the surface as
 * precisely as events are located; a start on the surface is no crossing. */
#include <string.h>

#include "app/app.h"
#include "core/core.h"

int lag_section_choose(App *app)
{
  const lag_model *m = app->scene->model;
  const char *name = app->args.section;
  lag_nearest near = {.name = name};

  app->section = -1;
  for (int k = 0; name && k < m->nev; k++) {
    if (strcmp(name, m->ev[k].name) == 0) {
      app->section = k;
      return 0;
    }
    lag_try_nearest(&near, m->ev[k].name);
  }
  if (!name) {
    return 0;
  }
  if (near.best) {
    return lag_app_error(&app->args, "--section %s: there is no such event; did you mean \"%s\"?", name, near.best);
  }
  return lag_app_error(&app->args, "--section %s: scene %s has no such event; name one, or lagc run %s --section 'EXPR rising' makes it", name,
                   app->scene->name, app->program->source);
}

void lag_section_note(App *app, int k)
{
  if (k == app->section && app->section_rc == 0) {
    app->section_rc = lag_app_put_row(app);
  }
}
