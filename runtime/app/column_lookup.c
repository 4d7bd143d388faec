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

double lag_app_period(const App *app, const char *name) {
  const lag_model *m = app->scene->model;
  int i = lag_component_index(m, name);
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
  if (a->plot_x) d->beneath.period = lag_app_period(app, app->table.cols[d->x[0]].name);
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

/* Points of the command line. */
typedef struct Points {
  int n, *cols; /* x, y of each: [2 n] */
} Points;

/* Appends the points "X,Y X,Y ..."; x and y are scratch for the indices of all columns. */
static int add_points(App *app, const char *option, const char *text, int *x, int *y, Points *p) {
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
    int *cols = realloc(p->cols, 2 * (size_t)(p->n + n) * sizeof *cols);
    if (!cols) return lag_app_error(&app->args, "out of memory");
    p->cols = cols;
    for (int k = 0; k < n; k++) {
      cols[2 * p->n] = x[nx > 1 ? k : 0];
      cols[2 * p->n++ + 1] = y[ny > 1 ? k : 0];
    }
  }
  return p->n ? 0 : lag_app_error(&app->args, "%s \"%s\": each point is X,Y, two names of outputs", option, text);
}

static const lag_shape no_shape = {
    .a = {-1, -1, -1}, .b = {-1, -1, -1}, .size = {-1, -1, -1}, .turn = {-1, -1, -1, -1}};

static int add_shape(App *app, const char *kind, const char *role, const char *text, const int *a, const int *b) {
  Animation *show = &app->show;
  lag_shape *more = realloc(show->shapes, ((size_t)show->nshapes + 1) * sizeof *more);
  if (!more) return lag_app_error(&app->args, "out of memory");
  show->shapes = more;
  more[show->nshapes] = no_shape;
  lag_shape *s = &more[show->nshapes++];
  s->kind = kind;
  s->role = role;
  s->text = text;
  if (a) memcpy(s->a, a, 2 * sizeof *a);
  if (b) memcpy(s->b, b, 2 * sizeof *b);
  return 0;
}

/* Points as bodies, each hanging by a rod from the one before, the first from the origin. first: 1, point 0 is the
 * suspension. */
static int points_to_shapes(App *app, const Points *p, int first) {
  enum { LONGEST = 2 * sizeof app->table.cols->name + 8 };
  int rods = !app->args.no_rods, rc = 0;
  char *words = app->show.words = malloc((size_t)p->n * LONGEST);
  if (!words) return lag_app_error(&app->args, "out of memory");
  for (int i = first; i < p->n && rods && rc == 0; i++)
    rc = add_shape(app, "rod", "link", NULL, i ? p->cols + 2 * i - 2 : NULL, p->cols + 2 * i);
  for (int i = first; i < p->n && rc == 0; i++) {
    const int *xy = p->cols + 2 * i;
    snprintf(words, LONGEST, "(%s, %s)", app->table.cols[xy[0]].name, app->table.cols[xy[1]].name);
    rc = add_shape(app, "ball", "body", words, xy, NULL);
    words += LONGEST;
  }
  return rc;
}

/* show->unit := the common unit of all places; columns without a unit fit any. */
static int choose_unit(App *app) {
  Animation *show = &app->show;
  const Column *first = NULL;
  for (int i = 0; i < 3 * show->nshapes; i++) {
    int k = show->shapes[i / 3].a[i % 3];
    const Column *c = k < 0 ? NULL : &app->table.cols[k];
    if (!c || !c->unit[0]) continue;
    if (first && strcmp(first->unit, c->unit) != 0) {
      return lag_app_error(&app->args, "--points: %s is in [%s], %s in [%s]; a picture of places needs one unit",
                           first->name, first->unit, c->name, c->unit);
    }
    first = first ? first : c;
  }
  show->unit = first ? first->unit : "";
  return 0;
}

/* The shapes of the scene; outputs are the columns behind the time. */
static int copy_shapes(App *app) {
  const lag_scene *sc = app->scene;
  Animation *show = &app->show;
  if (!sc->nshapes)
    return lag_app_error(&app->args, "this program has no drawing: `lagc animate` makes one; or add --points 'X,Y "
                                     "X,Y ...' with the names of outputs");
  show->shapes = malloc((size_t)(sc->nshapes + 1) * sizeof *show->shapes);
  if (!show->shapes) return lag_app_error(&app->args, "out of memory");
  for (int i = 0; i < sc->nshapes; i++) {
    lag_shape *s = &show->shapes[show->nshapes++];
    int *parts[] = {s->a, s->b, s->size, s->turn};
    *s = sc->shapes[i];
    for (int k = 0; k < 4; k++)
      for (int c = 0; c < (k < 3 ? 3 : 4); c++) parts[k][c] += parts[k][c] >= 0;
  }
  return 0;
}

int lag_app_choose_shapes(App *app) {
  const Args *a = &app->args;
  int *found = calloc(2 * (size_t)app->table.ncols, sizeof *found), *x = found, *y = found + app->table.ncols, rc = 0;
  Points points = {0};
  app->show = (Animation){.trace = a->trace};
  if (!found) return lag_app_error(a, "out of memory");
  if (a->from && !a->no_rods) rc = add_points(app, "--from", a->from, x, y, &points);
  int from = points.n, rods = !a->no_rods;
  if (rc == 0 && from > 1) rc = lag_app_error(a, "--from \"%s\": one point, X,Y", a->from);
  if (rc == 0 && a->points) rc = add_points(app, "--points", a->points, x, y, &points);
  if (rc == 0 && a->points && rods && !from && strstr(app->table.cols[points.cols[0]].name, "[0]"))
    from = points.n > 1; /* member 0 of a family is where the rods hang from */
  if (rc == 0) rc = a->points ? points_to_shapes(app, &points, from) : copy_shapes(app);
  free(found);
  free(points.cols);
  return rc ? rc : choose_unit(app);
}
