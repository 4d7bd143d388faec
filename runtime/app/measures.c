/* Measures of a run (analysis/measure.h): those of the scene, and of --measure, as lagc compiles them. Enters: words.
 * Leaves: a line each in the report, a member each in JSON. Holds: wrong words are refused before anything runs. */
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "numeric/fnv1a.h"
#include "numeric/release.h"

/* The words of NAME=WORDS, or, as lagc writes them, NAME;WORDS;WORDS for the variants of the model; alone they are
 * the name. */
static const char *split(const char *text, size_t *name_length) {
  size_t n = strcspn(text, ";");
  *name_length = text[n] ? n : strcspn(text, "=");
  return text[*name_length] ? text + *name_length + 1 : text;
}

/* Measures while they are collected: n of them, and their numbers, from 1, in a hash table; 0: free. */
typedef struct Collected {
  App *app;
  const char **texts;
  int n, *place;
  size_t places;
} Collected;

static int *place_of(const Collected *c, const char *name, size_t length) {
  size_t i = (size_t)lag_fnv1a(LAG_FNV1A_START, name, length) % c->places;
  for (const char *known; c->place[i]; i = (i + 1) % c->places) {
    known = c->app->measure_names[c->place[i] - 1];
    if (strlen(known) == length && memcmp(known, name, length) == 0) break;
  }
  return &c->place[i];
}

/* Adds a measure; one of the command line replaces the scene's of its name. 0, or -1 after a message. */
static int add(Collected *c, const char *name, size_t length, const char *text) {
  App *app = c->app;
  int *place = place_of(c, name, length), k = *place - 1, ofscene = app->scene->nmeasures;
  if (k >= 0 && (k >= ofscene || c->n < ofscene))
    return lag_app_error(&app->args, "--measure %.*s: another measure is called so; write NAME=EXPR with another name",
                         (int)length, name), -1;
  c->texts[k < 0 ? c->n : k] = text;
  if (k >= 0) return 0;
  app->measure_names[c->n] = calloc(length + 1, 1);
  if (!app->measure_names[c->n]) return lag_app_error(&app->args, "out of memory"), -1;
  memcpy(app->measure_names[c->n], name, length);
  *place = ++c->n;
  return 0;
}

/* Expressions of the scene, then of the command line. 0, or -1 after a message. */
static int collect(Collected *c) {
  const App *app = c->app;
  const lag_scene *scene = app->scene;
  for (int k = 0; k < scene->nmeasures; k++)
    if (add(c, scene->measures[k].name, strlen(scene->measures[k].name), scene->measures[k].text)) return -1;
  for (int k = 0; k < app->args.nmeasures; k++) {
    size_t length;
    const char *given = app->args.measures[k], *text = split(given, &length);
    if (length == 0) return lag_app_error(&app->args, "--measure %s: a name is missing before `=`", given), -1;
    if (add(c, given, length, text)) return -1;
  }
  return 0;
}

int lag_app_measures_open(App *app) {
  size_t most = (size_t)(app->args.nmeasures + app->scene->nmeasures);
  char why[400];
  if (most == 0) return 0;
  Collected c = {.app = app, .places = 2 * most};
  c.place = calloc(c.places, sizeof *c.place);
  c.texts = app->measure_texts = calloc(most, sizeof *c.texts);
  app->measured = calloc(most, sizeof *app->measured);
  app->measure_names = calloc(most + 1, sizeof *app->measure_names);
  int rc = c.place && c.texts && app->measured && app->measure_names
               ? collect(&c)
               : (lag_app_error(&app->args, "out of memory"), -1);
  free(c.place);
  if (rc == 0 && !(app->measures = lag_measures_new(app->scene, c.n, c.texts, NULL, why, sizeof why)))
    lag_app_error(&app->args, "--measure %s", why);
  if (!app->measures) return EXIT_USAGE;
  return lag_measures_refused(app->measures, app->sim, app->until, why, sizeof why)
             ? lag_app_error(&app->args, "--measure lyapunov: %s", why)
             : 0;
}

void lag_app_measures_free(App *app) {
  for (int k = 0; app->measure_names && app->measure_names[k]; k++) free(app->measure_names[k]);
  lag_free_all(app->measure_names, app->measure_texts, app->measured);
  lag_measures_free(app->measures);
}

int lag_app_measures_begin(App *app) { return app->measures ? lag_measures_begin(app->measures, app->sim) : LAG_OK; }

int lag_app_advance(App *app, double t) {
  return app->measures ? lag_measures_advance(app->measures, t) : lag_sim_advance(app->sim, t);
}

int lag_app_measures_end(App *app) { return app->measures ? lag_measures_end(app->measures, app->measured) : LAG_OK; }

void lag_report_measures(const App *app, FILE *f) {
  enum { NARROWEST = 14, WIDEST = 40 };
  int width = NARROWEST;
  for (int k = 0; app->measures && k < lag_measures_count(app->measures); k++) {
    int n = (int)strlen(app->measure_names[k]);
    width = n > width && n <= WIDEST ? n : width;
  }
  for (int k = 0; app->measures && k < lag_measures_count(app->measures); k++) {
    const char *unit = lag_measures_unit(app->measures, k), *why = lag_measures_why(app->measures, k);
    if (k == 0) fputs("measures\n", f);
    if (why[0]) fprintf(f, "  %-*s none: %s\n", width, app->measure_names[k], why);
    else fprintf(f, "  %-*s %.15g%s%s\n", width, app->measure_names[k], app->measured[k], unit[0] ? " " : "", unit);
  }
}

void lag_report_measures_json(const App *app, Json *j) {
  if (!app->measures) return;
  JSON_EACH(j, "measures", '{', k, lag_measures_count(app->measures))
    lag_json_number(j, app->measure_names[k], app->measured[k]);
}
