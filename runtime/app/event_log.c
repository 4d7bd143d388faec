/* Event log (--events), rows at events (--section), and the report on events. Enters: events during the run, with
 * the state before and after; leaves: rows of time, name, state before, state after, in declared units with all
 * digits. Holds: a run that is saved and resumed logs each event once, in the part where it happens. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "core/core.h"

enum { MOST_EVENTS = 24 };

/* Columns of the log: t, event, the state before, the state after. -1: no memory. */
static int make_columns(App *app) {
  const lag_model *m = app->scene->model;
  int n = 2 * m->nq + m->nz;
  Table *t = &app->log;
  *t = (Table){.ncols = 2 + 2 * n, .cols = calloc((size_t)(2 + 2 * n), sizeof *t->cols)};
  app->log_row = calloc((size_t)t->ncols, sizeof *app->log_row);
  app->log_names = calloc((size_t)m->nev, sizeof *app->log_names);
  if (!t->cols || !app->log_row || !app->log_names) return -1;
  for (int k = 0; k < m->nev; k++) app->log_names[k] = m->ev[k].name;
  strcpy(t->cols[0].name, "t");
  strcpy(t->cols[0].unit, "s");
  strcpy(t->cols[1].name, "event");
  t->cols[1].words = app->log_names;
  for (int i = 0; i < n; i++) {
    Column *before = &t->cols[2 + i], *after = &t->cols[2 + n + i];
    *before = *after = lag_state_column(app->sim, i);
    strcpy(after->name + strnlen(after->name, sizeof after->name - sizeof " after"), " after");
  }
  return 0;
}

int lag_event_log_open(App *app) {
  const Args *a = &app->args;
  if (!a->events) return 0;
  if (app->scene->model->nev == 0)
    return lag_app_error(a, "--events %s: model %s has no events in scene %s", a->events, app->scene->model->name,
                         app->scene->name);
  if (make_columns(app)) return lag_app_error(a, "out of memory");
  return lag_rows_open(&app->log_rows, a->events, &app->log) ? lag_app_io_error(app, a->events) : 0;
}

void lag_event_note(void *context, int k, double t, const double *before, const double *after) {
  App *app = context;
  int n = (app->log.ncols - 2) / 2;
  if (k == app->section && app->section_rc == 0 && !app->skipping) app->section_rc = lag_app_put_row(app);
  if (lag_marks_event(app, k, t)) app->section_rc = LAG_ENOMEM;
  if (!app->log_rows.open) return;
  app->log_row[0] = t;
  app->log_row[1] = k;
  for (int i = 0; i < n; i++) {
    app->log_row[2 + i] = lag_sim_declared(app->sim, i, before[i]);
    app->log_row[2 + n + i] = lag_sim_declared(app->sim, i, after[i]);
  }
  if (lag_rows_write(&app->log_rows, app->log_row)) lag_app_bad_file(app, app->args.events);
}

void lag_event_log_free(App *app) {
  lag_table_free(&app->log);
  free(app->log_row);
  free(app->log_names);
}

/* ---- Poincare section (--section): rows at the crossings of a surface, given as an event that changes nothing. A
 * row is on the surface as precisely as events are located; a start on the surface is no crossing. */

int lag_section_choose(App *app) {
  const lag_model *m = app->scene->model;
  const char *name = app->args.section;
  lag_nearest near = {.name = name};
  app->section = -1;
  for (int k = 0; name && k < m->nev; k++) {
    if (strcmp(name, m->ev[k].name) == 0) {
      app->section = k;
      if (lag_event_is_located(app->sim, k)) return 0;
      return lag_app_error(&app->args, "--section %s: %s does not locate events of contacts; dop853 does", name,
                           lag_sim_method(app->sim)->name);
    }
    lag_try_nearest(&near, m->ev[k].name);
  }
  if (!name) return 0;
  if (near.best)
    return lag_app_error(&app->args, "--section %s: there is no such event; did you mean \"%s\"?", name, near.best);
  return lag_app_error(
      &app->args, "--section %s: scene %s has no such event; name one, or lagc run %s --section 'EXPR rising' makes it",
      name, app->scene->name, app->program->source);
}

/* ---- The report */

void lag_report_events(const App *app, FILE *f) {
  const lag_model *m = app->scene->model;
  for (int k = 0; k < m->nev && k < MOST_EVENTS; k++) {
    double first, last;
    if (!lag_event_is_located(app->sim, k)) continue;
    long long n = lag_sim_event_times(app->sim, k, &first, &last);
    fprintf(f, "%s %s: ",
            m->ev[k].direction == LAG_KICK ? "kick"
            : k == app->section            ? "section"
                                           : "event",
            m->ev[k].name);
    if (n == 0) fputs("never", f);
    else fprintf(f, "%lld time%s", n, n == 1 ? "" : "s");
    if (n == 1) fprintf(f, ", t = %s s", lag_number_text(first, (char[64]){0}));
    else if (n > 1)
      fprintf(f, ", first at t = %s s, last at %s s", lag_number_text(first, (char[64]){0}),
              lag_number_text(last, (char[64]){0}));
    if (app->sim->skipped[k] > 0)
      fprintf(f, "; then at rest: impacts of the next %.2g s are left out", app->sim->skipped[k]);
    putc('\n', f);
  }
  if (m->nev > MOST_EVENTS) fprintf(f, "  (and %d events more)\n", m->nev - MOST_EVENTS);
  if (app->args.events) fprintf(f, "%zu events in %s\n", app->log_rows.nrows, app->args.events);
}

void lag_report_events_json(const App *app, Json *j) {
  const lag_model *m = app->scene->model;
  JSON_EACH(j, "events", '{', k, m->nev) {
    double first, last;
    if (!lag_event_is_located(app->sim, k)) continue;
    lag_json_begin(j, m->ev[k].name, '{');
    lag_json_count(j, "count", lag_sim_event_times(app->sim, k, &first, &last));
    lag_json_numbers(j, {"first", first}, {"last", last});
    if (app->sim->skipped[k] > 0) lag_json_number(j, "left_out", app->sim->skipped[k]);
    lag_json_end(j, '}');
  }
}
