/* --sensitivity: derivatives of outputs by parameters and starts. Enters: a run and names; leaves: additional columns
 * dx/dg, output by output, in declared units; the derivatives at the end for the report; and which names the outputs
 * feel. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "core/core.h"

enum { MOST_COLUMNS = 4096 };

struct Sensitivity {
  int n, nout;       /* names, outputs */
  char **names;      /* [n] "g", "th(0)"; their texts stand behind them */
  double *factor;    /* [n] of each name's unit */
  double *Y, *D;     /* [state n], [nout n] */
  double *by, *size; /* [nout n] largest |D| so far; [nout] largest |output| */
  double room[];
};

/* Splits "g,l,th(0)" at commas outside of brackets: number of names, which are written to names (NULL: counted). */
static int split_names(const char *list, char *text, char **names) {
  int n = 0, depth = 0;
  if (text) strcpy(text, list);
  for (size_t i = 0, from = 0;; i++) {
    char c = list[i];
    depth += c == '(' || c == '[' ? 1 : c == ')' || c == ']' ? -1 : 0;
    if (c && (c != ',' || depth > 0)) continue;
    if (names) {
      names[n] = text + from;
      text[i] = '\0';
    }
    n++;
    from = i + 1;
    if (!c) return n;
  }
}

/* Name and unit of dx/d(name j). */
static Column quotient(const App *app, const Column *of, int j) {
  Column x = *of, y = {0}, c = {0};
  char over[72], under[72];
  lag_sim_sensitivity_info(app->sim, j, y.name, sizeof y.name, y.unit, sizeof y.unit);
  lag_unit_in_fraction(over, sizeof over, x.unit);
  lag_unit_in_fraction(under, sizeof under, y.unit);
  snprintf(c.name, sizeof c.name, "d%.40s/d%.40s", x.name, y.name);
  if (strcmp(x.unit, y.unit) == 0) return c;
  snprintf(c.unit, sizeof c.unit, y.unit[0] ? "%.30s/%.30s" : "%.30s", y.unit[0] ? over : x.unit, under);
  return c;
}

static Column describe(const App *app, int output, int j) {
  Column x = {0};
  lag_sim_output_info(app->sim, output, x.name, sizeof x.name, x.unit, sizeof x.unit);
  return quotient(app, &x, j);
}

static Sensitivity *sensitivity_new(const App *app, const char *list) {
  int n = split_names(list, NULL, NULL), state = app->sim->pb.n, nout = lag_sim_noutputs(app->sim);
  size_t reals = (size_t)(n + state * n + 2 * nout * n + nout);
  Sensitivity *s = calloc(1, sizeof *s + reals * sizeof(double) + (size_t)n * sizeof(char *) + strlen(list) + 1);
  if (!s) return NULL;
  s->n = n;
  s->nout = nout;
  s->factor = s->room;
  s->Y = s->factor + n;
  s->D = s->Y + state * n;
  s->by = s->D + nout * n;
  s->size = s->by + nout * n;
  s->names = (char **)(s->size + nout);
  split_names(list, (char *)(s->names + n), s->names);
  return s;
}

int lag_sensitivity_open(App *app) {
  const Args *a = &app->args;
  if (!a->sensitivity) return 0;
  Sensitivity *s = app->sensitivity = sensitivity_new(app, a->sensitivity);
  if (!s) return lag_app_error(a, "out of memory");
  if (s->n * s->nout > MOST_COLUMNS)
    return lag_app_error(a, "--sensitivity: %d outputs by %d names would make %d columns; %d are allowed", s->nout,
                         s->n, s->nout * s->n, MOST_COLUMNS);
  if (lag_sim_set_sensitivity(app->sim, s->n, (const char *const *)s->names))
    return lag_app_error(a, "--sensitivity: %s", lag_sim_message(app->sim));
  for (int j = 0; j < s->n; j++) s->factor[j] = lag_sim_sensitivity_info(app->sim, j, NULL, 0, NULL, 0);
  Column *cols = lag_app_add_columns(app, s->n * s->nout);
  if (!cols) return lag_app_error(a, "out of memory");
  for (int k = 0; k < s->n * s->nout; k++) cols[k] = describe(app, k / s->n, k % s->n);
  return 0;
}

/* s->D at the present time, per declared unit of each name. */
static int derivatives(App *app) {
  Sensitivity *s = app->sensitivity;
  int rc = lag_sim_tangent(app->sim, s->Y);
  rc = rc ? rc : lag_sim_output_sensitivity(app->sim, s->Y, s->D);
  for (int i = 0; i < s->nout && rc == 0; i++)
    for (int j = 0; j < s->n; j++) {
      s->D[i * s->n + j] *= s->factor[j];
      s->by[i * s->n + j] = fmax(s->by[i * s->n + j], fabs(s->D[i * s->n + j]));
    }
  return rc;
}

int lag_sensitivity_row(App *app) {
  Sensitivity *s = app->sensitivity;
  if (!s) return LAG_OK;
  int rc = derivatives(app), many = s->n * s->nout;
  if (rc) return rc;
  memcpy(app->row + app->table.ncols - many, s->D, (size_t)many * sizeof(double));
  for (int i = 0; i < s->nout; i++) s->size[i] = fmax(s->size[i], fabs(app->row[1 + i]));
  return LAG_OK;
}

/* ---- The report */

/* Whether an output changes, beyond rounding, with name j. */
static int is_felt(const App *app, int j) {
  const double rounding = 1e-10;
  const Sensitivity *s = app->sensitivity;
  double value = fabs(lag_sim_sensitivity_value(app->sim, j) / s->factor[j]);
  int felt = 0;
  for (int i = 0; i < s->nout; i++)
    felt |= s->by[i * s->n + j] * (value > 0 ? value : 1) > rounding * (s->size[i] > 0 ? s->size[i] : 1);
  return felt;
}

static int known_at_end(App *app) { return app->sensitivity && app->status >= 0 && derivatives(app) == 0; }

static void report_felt(App *app, FILE *f) {
  const Sensitivity *s = app->sensitivity;
  int count[2] = {0};
  for (int felt = 1; felt >= 0; felt--) {
    for (int j = 0; j < s->n; j++)
      if (is_felt(app, j) == felt)
        fprintf(f, "%s%s",
                count[felt]++ ? ", "
                : felt        ? "outputs feel "
                : count[1]    ? "; not "
                              : "outputs feel none of ",
                s->names[j]);
  }
  putc('\n', f);
}

/* The start or parameter of name j, among those of a gradient. */
static int place_of(const App *app, int j) {
  char name[LAG_GRADIENT_NAME], asked[LAG_GRADIENT_NAME], unit[LAG_GRADIENT_NAME];
  int i = 0, n = app->sim->pb.n + app->scene->model->np;
  lag_sim_sensitivity_info(app->sim, j, asked, sizeof asked, NULL, 0);
  for (; i < n; i++) {
    lag_gradient_name(app, i, name, unit);
    if (strcmp(name, asked) == 0) return i;
  }
  return -1;
}

/* D[measures n] := derivatives of the measures, by reverse mode where they have one, else by differences of runs:
 * by_runs[measures] = 1. Returns their number, 0: there are none, or a run fails. */
static int derive_measures(App *app, double **D, int **by_runs) {
  const Sensitivity *s = app->sensitivity;
  char why[400];
  int n = app->measures ? lag_measures_count(app->measures) : 0, some = 0;
  size_t all = (size_t)(app->sim->pb.n + app->scene->model->np);
  *D = n ? calloc((size_t)(n * s->n) + (size_t)n + all, sizeof **D) : NULL;
  *by_runs = calloc((size_t)n + 1, sizeof **by_runs);
  if (!*D || !*by_runs) return 0;
  double *one = *D + n * s->n;
  for (int i = 0; i < n; i++) {
    int none = lag_measure_gradient(app, i, one, why, sizeof why);
    for (int j = 0, at; j < s->n && !none; j++) {
      none = (at = place_of(app, j)) < 0;
      (*D)[i * s->n + j] = none ? 0 : one[at];
    }
    some |= (*by_runs)[i] = none != 0;
  }
  for (int j = 0; some && j < s->n; j++) {
    if (lag_measures_by(app, j, one)) return 0;
    for (int i = 0; i < n; i++)
      if ((*by_runs)[i]) (*D)[i * s->n + j] = one[i];
  }
  return n;
}

static void report_measures(App *app, FILE *f) {
  const Sensitivity *s = app->sensitivity;
  double *D;
  int *by_runs, n = derive_measures(app, &D, &by_runs);
  for (int runs = 0, told = 0; runs < 2; runs++, told = 0)
    for (int k = 0; k < n * s->n; k++) {
      Column c = {0}, x = {0};
      if (by_runs[k / s->n] != runs) continue;
      if (!told++) fprintf(f, "derivatives of measures%s\n", runs ? ", by differences of runs" : "");
      snprintf(x.name, sizeof x.name, "%.40s", app->measure_names[k / s->n]);
      snprintf(x.unit, sizeof x.unit, "%s", lag_measures_unit(app->measures, k / s->n));
      c = quotient(app, &x, k % s->n);
      fprintf(f, "  %-20s %.*g%s%s\n", c.name, runs ? 9 : 12, D[k], c.unit[0] ? " " : "", c.unit);
    }
  free(D);
  free(by_runs);
}

void lag_report_sensitivity(App *app, FILE *f) {
  const Sensitivity *s = app->sensitivity;
  if (!known_at_end(app)) return;
  for (int i = 0; i < s->nout; i++)
    s->size[i] = fmax(s->size[i], lag_sim_outputs(app->sim, app->row + 1) ? 0 : fabs(app->row[1 + i]));
  fprintf(f, "sensitivity: derivative of the outputs at the end");
  if (app->status == LAG_STOPPED)
    fprintf(f, ", at t = %s s whenever the event happens", LAG_TEXT(lag_sim_time(app->sim)));
  fputc('\n', f);
  for (int k = 0; k < s->n * s->nout; k++) {
    Column c = describe(app, k / s->n, k % s->n);
    fprintf(f, "  %-20s %.15g%s%s\n", c.name, s->D[k], c.unit[0] ? " " : "", c.unit);
  }
  report_felt(app, f);
  report_measures(app, f);
}

/* Key of a measure: "measure x" where an output is called x. */
static const char *measure_key(const App *app, int i, char *key, size_t size) {
  char name[64];
  int is_output = 0;
  for (int k = 0; k < app->sensitivity->nout; k++) {
    lag_sim_output_info(app->sim, k, name, sizeof name, NULL, 0);
    is_output |= strcmp(name, app->measure_names[i]) == 0;
  }
  snprintf(key, size, "%s%s", is_output ? "measure " : "", app->measure_names[i]);
  return key;
}

void lag_report_sensitivity_json(App *app, Json *out) {
  const Sensitivity *s = app->sensitivity;
  char key[300];
  if (!known_at_end(app)) return;
  lag_json_begin(out, "sensitivity", '{');
  for (int i = 0; i < s->nout; i++) {
    char name[64];
    lag_sim_output_info(app->sim, i, name, sizeof name, NULL, 0);
    JSON_EACH(out, name, '{', j, s->n) lag_json_number(out, s->names[j], s->D[i * s->n + j]);
  }
  double *D;
  int *by_runs, n = derive_measures(app, &D, &by_runs);
  for (int i = 0; i < n; i++) {
    JSON_EACH(out, measure_key(app, i, key, sizeof key), '{', j, s->n)
      lag_json_number(out, s->names[j], D[i * s->n + j]);
  }
  free(D);
  free(by_runs);
  lag_json_end(out, '}');
}

void lag_sensitivity_free(App *app) { free(app->sensitivity); }
