/* Names of outputs on the command line. Enters: the names, and the table's columns; leaves: which columns they are. */
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "core/core.h"

/* The first column that is a member or a component of `name`, or NULL. */
static const char *part_of(const App *app, const char *name)
{
  size_t n = strlen(name);

  for (int i = 0; i < app->table.ncols; i++) {
    const char *whole = app->table.cols[i].name;
    if (strncmp(whole, name, n) == 0 && (whole[n] == '[' || whole[n] == '.')) {
      return whole;
    }
  }
  return NULL;
}

int app_column(const App *app, const char *name)
{
  const char *best = NULL, *part;
  int least = LAG_FAR;

  for (int i = 0; i < app->table.ncols; i++) {
    int d = lag_near(name, app->table.cols[i].name);
    if (d == 0) {
      return i;
    }
    if (d < least) {
      least = d;
      best = app->table.cols[i].name;
    }
  }
  if ((part = part_of(app, name)) != NULL) {
    app_error(&app->args, "%s has parts, each an output of its own; name one: %s", name, part);
  } else {
    app_error(&app->args, best ? "no output is named %s; did you mean %s?" : "no output is named %s", name, best);
  }
  return -1;
}

/* The column whose name stands at *s, the longest one: names may hold spaces and commas themselves. *s is moved behind it. */
static int column_at(const App *app, const char **s)
{
  size_t longest = 0;
  int found = -1;

  for (int i = 0; i < app->table.ncols; i++) {
    const char *name = app->table.cols[i].name;
    size_t n = strlen(name);
    if (n > longest && strncmp(*s, name, n) == 0 && strchr(" ,;", (*s)[n])) { /* or the end: strchr finds it too */
      longest = n;
      found = i;
    }
  }
  if (found < 0) {
    char word[96];
    snprintf(word, sizeof word, "%.*s", (int)strcspn(*s, " ,;"), *s);
    return app_column(app, word);
  }
  *s += longest;
  return found;
}

/* Appends the columns of "X,Y X,Y ..." to the animation's. */
static int add_points(App *app, const char *option, const char *text)
{
  Animation *show = &app->show;
  int n = 0;

  for (const char *s = text + strspn(text, " ,;"); *s; s += strspn(s, " ,;"), n++) {
    int col = column_at(app, &s);
    if (col < 0) {
      return EXIT_USAGE;
    }
    show->cols[2 * show->npoints + n] = col;
  }
  if (n == 0 || n % 2) {
    return app_error(&app->args, "%s \"%s\": each point is X,Y, two names of outputs", option, text);
  }
  show->npoints += n / 2;
  return 0;
}

/* One unit for all: where it is empty, anything goes. */
static int choose_unit(App *app)
{
  Animation *show = &app->show;
  const Column *first = NULL;

  for (int i = 0; i < 2 * show->npoints; i++) {
    const Column *c = &app->table.cols[show->cols[i]];
    if (!c->unit[0]) {
      continue;
    }
    if (first && strcmp(first->unit, c->unit) != 0) {
      return app_error(&app->args, "--points: %s is in [%s], %s in [%s]; a picture of places needs one unit", first->name, first->unit,
                       c->name, c->unit);
    }
    first = first ? first : c;
  }
  show->unit = first ? first->unit : "";
  return 0;
}

int app_choose_points(App *app)
{
  const Args *a = &app->args;
  Animation *show = &app->show;

  *show = (Animation){.rods = !a->no_rods, .trace = a->trace, .from = a->from && !a->no_rods};
  show->cols = calloc(strlen(a->points) + (a->from ? strlen(a->from) : 0) + 2, sizeof *show->cols);
  if (!show->cols) {
    return app_error(a, "out of memory");
  }
  if (show->from && add_points(app, "--from", a->from)) {
    return EXIT_USAGE;
  }
  if (show->from && show->npoints != 1) {
    return app_error(a, "--from \"%s\": one point, X,Y", a->from);
  }
  return add_points(app, "--points", a->points) ? EXIT_USAGE : choose_unit(app);
}
