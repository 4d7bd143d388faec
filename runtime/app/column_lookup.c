/* Finds the columns that --plot-x, --plot-y, --points and --from name. Enters: the names and the table; leaves:
 * column indices. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/effect_variants.h"
#include "app/app.h"
#include "core/core.h"

/* Whether a column is a member or component of `name`: th[2]' of th', r[1].x of r or of r.x. */
static int is_part(const char *column, const char *name) {
  size_t primes = 0, n = strlen(name);
  while (n > primes && name[n - primes - 1] == '\'') primes++;
  n -= primes;
  for (size_t i = 0; i < n; i++) {
    if (*column == '[' && name[i] != '[') {
      column += strcspn(column, "]");
      column += *column == ']';
    }
    if (*column++ != name[i]) return 0;
  }
  if (*column == '[') {
    column += strcspn(column, "]");
    column += *column == ']';
  }
  if (*column == '.') column += column[1] ? 2 : 1;
  return strlen(column) == primes && strspn(column, "'") == primes;
}

/* Prints that there is no such column; returns -1. */
static int no_column(const App *app, const char *name) {
  lag_nearest near = {.name = name};
  for (int i = 0; i < app->table.ncols; i++) lag_try_nearest(&near, app->table.cols[i].name);
  lag_app_error(&app->args, near.best ? "no output is named %s; did you mean %s?" : "no output is named %s", name,
                near.best);
  return -1;
}

/* Like strcmp, but compares numbers by value: x[2] before x[10]. */
static int compare(const char *a, const char *b) {
  for (;;) {
    int digits = *a >= '0' && *a <= '9' && *b >= '0' && *b <= '9';
    char *behind_a, *behind_b;
    long x = digits ? strtol(a, &behind_a, 10) : (unsigned char)*a,
         y = digits ? strtol(b, &behind_b, 10) : (unsigned char)*b;
    if (x != y || *a == '\0') return x < y ? -1 : x > y;
    a = digits ? behind_a : a + 1;
    b = digits ? behind_b : b + 1;
  }
}

/* cols := the column of this name, or all its members and components in order. Returns their number; -1 after a
 * message. */
static int columns_of(const App *app, const char *name, int *cols) {
  const Column *c = app->table.cols;
  int n = 0;
  for (int i = 0; i < app->table.ncols; i++)
    if (strcmp(name, c[i].name) == 0) {
      cols[0] = i;
      return 1;
    }
  for (int i = 1; i < app->table.ncols; i++)
    if (is_part(c[i].name, name)) {
      int k = n++;
      for (; k > 0 && compare(c[cols[k - 1]].name, c[i].name) > 0; k--) cols[k] = cols[k - 1];
      cols[k] = i;
    }
  return n ? n : no_column(app, name);
}

/* The period of an angle that is declared periodic, in the unit of its column, over which pictures of more than a
 * turn, and points of a section, are drawn; 0: none. */
static double period_of(const App *app, int col) {
  const lag_model *m = app->scene->model;
  int i = lag_component_index(m, app->table.cols[col].name);
  const lag_var *v = i >= 0 && i < m->nq ? &m->q[i] : i >= 2 * m->nq ? &m->z[i - 2 * m->nq] : NULL;
  return v && v->periodic ? 2 * acos(-1) / v->factor : 0;
}

/* d->y := the columns of each --plot-y; d->yname := their names, NULL for several over the time, whose axes have
 * units. -1 after a message. */
static int choose_ys(App *app) {
  const Args *a = &app->args;
  PlottedCurves *d = &app->drawn;
  size_t used = 0;
  d->n = 0;
  for (int i = 0; i < a->nplot_ys; i++) {
    int n = columns_of(app, a->plot_ys[i], d->y + d->n);
    if (n < 0) return -1;
    d->n += n;
    if (used < sizeof app->drawn_ys)
      used += (size_t)snprintf(app->drawn_ys + used, sizeof app->drawn_ys - used, "%s%s", i ? ", " : "", a->plot_ys[i]);
  }
  d->yname = a->nplot_ys == 1 ? a->plot_y : a->plot_x ? app->drawn_ys : NULL;
  return 0;
}

int lag_app_choose_curves(App *app) {
  const Args *a = &app->args;
  PlottedCurves *d = &app->drawn;
  int most = app->table.ncols, all = most * (a->nplot_ys ? a->nplot_ys : 1), nx = 1;
  *d = (PlottedCurves){.n = most - 1, .x = calloc(2 * (size_t)all, sizeof *d->x), .xname = a->plot_x ? a->plot_x : "t"};
  if (!d->x) return lag_app_error(a, "out of memory");
  d->y = d->x + all;
  for (int i = 1; i < most; i++) d->y[i - 1] = i;
  if ((a->plot_x && (nx = columns_of(app, a->plot_x, d->x)) < 0) || (a->plot_y && choose_ys(app))) return EXIT_USAGE;
  if (nx != 1 && nx != d->n)
    return lag_app_error(a, "--plot-x %s has %d parts, --plot-y %s has %d; draw one against the other by naming a part",
                         a->plot_x, nx, a->plot_y, d->n);
  for (int i = nx; i < d->n; i++) d->x[i] = d->x[0];
  if (a->plot_x) d->beneath.period = period_of(app, d->x[0]);
  return 0;
}

/* cols := the column with the longest name at *s (names may contain spaces and commas), or all parts of the name
 * there. Moves *s past the name. Returns their number; -1 after a message. */
static int columns_at(const App *app, const char **s, int *cols) {
  size_t longest = 0;
  for (int i = 0; i < app->table.ncols; i++) {
    const char *name = app->table.cols[i].name;
    size_t n = strlen(name);
    if (n > longest && strncmp(*s, name, n) == 0 && strchr(" ,;", (*s)[n])) { /* or the end: strchr also finds '\0' */
      longest = n;
      cols[0] = i;
    }
  }
  if (longest) {
    *s += longest;
    return 1;
  }
  char word[96];
  size_t n = strcspn(*s, " ,;");
  snprintf(word, sizeof word, "%.*s", (int)n, *s);
  *s += n;
  return columns_of(app, word, cols);
}

/* If the points are a family from index 0 on, member 0 is the fixed point that the rods hang from. */
static void suspend_at_zero(App *app, int x) {
  const char *name = app->table.cols[x].name, *at = strstr(name, "[0]");
  if (at && app->show.rods && !app->show.from && app->show.npoints == 0) app->show.from = 1;
}

/* Appends the points "X,Y X,Y ..." to app->show; x and y are scratch for the indices of all columns. */
static int add_points(App *app, const char *option, const char *text, int *x, int *y) {
  Animation *show = &app->show;
  const char *s = text + strspn(text, " ,;");
  while (*s) {
    int nx = columns_at(app, &s, x), ny = 0;
    s += strspn(s, " ,;");
    if (nx > 0 && *s) {
      ny = columns_at(app, &s, y);
      s += strspn(s, " ,;");
    }
    if (nx < 0 || ny < 0) return EXIT_USAGE;
    if (ny == 0) return lag_app_error(&app->args, "%s \"%s\": each point is X,Y, two names of outputs", option, text);
    if (nx != ny && nx != 1 && ny != 1)
      return lag_app_error(&app->args, "%s \"%s\": %d places across for %d up", option, text, nx, ny);
    int n = nx > ny ? nx : ny;
    int *cols = realloc(show->cols, 2 * (size_t)(show->npoints + n) * sizeof *cols);
    if (!cols) return lag_app_error(&app->args, "out of memory");
    show->cols = cols;
    if (nx > 1) suspend_at_zero(app, x[0]);
    for (int k = 0; k < n; k++) {
      cols[2 * show->npoints] = x[nx > 1 ? k : 0];
      cols[2 * show->npoints++ + 1] = y[ny > 1 ? k : 0];
    }
  }
  return show->npoints ? 0
                       : lag_app_error(&app->args, "%s \"%s\": each point is X,Y, two names of outputs", option, text);
}

/* show->unit := the common unit of all points; columns without a unit fit any. */
static int choose_unit(App *app) {
  Animation *show = &app->show;
  const Column *first = NULL;
  for (int i = 0; i < 2 * show->npoints; i++) {
    const Column *c = &app->table.cols[show->cols[i]];
    if (!c->unit[0]) continue;
    if (first && strcmp(first->unit, c->unit) != 0) {
      return lag_app_error(&app->args, "--points: %s is in [%s], %s in [%s]; a picture of places needs one unit",
                           first->name, first->unit, c->name, c->unit);
    }
    first = first ? first : c;
  }
  show->unit = first ? first->unit : "";
  return 0;
}

int lag_app_choose_points(App *app) {
  const Args *a = &app->args;
  Animation *show = &app->show;
  int *found = calloc(2 * (size_t)app->table.ncols, sizeof *found), *x = found, *y = found + app->table.ncols, rc = 0;
  *show = (Animation){.rods = !a->no_rods, .trace = a->trace, .from = a->from && !a->no_rods};
  if (!found) return lag_app_error(a, "out of memory");
  if (show->from) rc = add_points(app, "--from", a->from, x, y);
  if (rc == 0 && show->from && show->npoints != 1) rc = lag_app_error(a, "--from \"%s\": one point, X,Y", a->from);
  rc = rc ? rc : add_points(app, "--points", a->points, x, y);
  free(found);
  return rc ? rc : choose_unit(app);
}
