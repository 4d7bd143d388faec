/* --linearize: the matrices A, B, C, D of small changes about the start, a rest, or a steady motion. Enters: a
 * simulation at its start; leaves: equations of small changes, one JSON object, or the matrix [A B; C D] in a file. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/equilibrium.h"
#include "app/app.h"
#include "core/core.h"
#include "io/io.h"
#include "numeric/workspace.h"

/* The system y' = A y + B u, out = C y + D u of small changes about the state y, in SI; rate: y' there. */
typedef struct LinearSystem {
  lag_sim *sim;
  int n, nu, nout;
  double *y, *rate, *A, *B, *C, *D, *block;
} LinearSystem;

enum { WIDE = 118, NAME = 200 };

/* ---- Names */

static const char *state_name(const LinearSystem *s, int i, char *name) {
  lag_sim_state_info(s->sim, i, name, NAME, NULL, 0);
  return name;
}

/* Name of row i of A, "th''", or of C behind them. */
static const char *row_name(const LinearSystem *s, int i, char *name) {
  if (i < s->n) return state_name(s, i, name), strcat(name, "'"); /* buffers have NAME + 4 characters */
  lag_sim_output_info(s->sim, i - s->n, name, NAME, NULL, 0);
  return name;
}

static const char *column_name(const LinearSystem *s, int k, char *name) {
  if (k < s->n) return state_name(s, k, name);
  snprintf(name, NAME, "%s", s->sim->scene->model->u[k - s->n].name);
  return name;
}

/* Element of [A B; C D]. */
static double element(const LinearSystem *s, int i, int k) {
  const double *left = i < s->n ? s->A + i * s->n : s->C + (i - s->n) * s->n,
               *right = i < s->n ? s->B + i * s->nu : s->D + (i - s->n) * s->nu;
  return k < s->n ? left[k] : right[k - s->n];
}

/* ---- Text */

/* "  th'' = -9.81 th + 2 u", wrapped. Elements below 1e-12 of the row's largest are the rounding of differences. */
static void put_row(FILE *f, const LinearSystem *s, int i, int wide) {
  char name[NAME + 4];
  double most = 0;
  int terms = 0, at = fprintf(f, "  %-*s =", wide, row_name(s, i, name));
  for (int k = 0; k < s->n + s->nu; k++) most = fmax(most, fabs(element(s, i, k)));
  for (int k = 0; k < s->n + s->nu; k++) {
    double x = element(s, i, k);
    char word[NAME + 40];
    if (!(fabs(x) > 1e-12 * most)) continue;
    const char *sign = x < 0 ? (terms ? "- " : "-") : terms ? "+ " : "";
    char factor[32];
    snprintf(factor, sizeof factor, "%.7g ", fabs(x));
    int n = snprintf(word, sizeof word, " %s%s%s", sign, strcmp(factor, "1 ") ? factor : "", column_name(s, k, name));
    if (at + n > WIDE) at = fprintf(f, "\n%*s", wide + 4, "") - 1;
    at += fprintf(f, "%s", word);
    terms++;
  }
  fputs(terms ? "\n" : " 0\n", f);
}

static const char *about(const Args *a) {
  return a->steady ? "steady motion" : a->equilibrium ? "equilibrium" : "start";
}

static void put_text(FILE *f, const App *app, const LinearSystem *s) {
  char name[NAME + 4], unit[64];
  int wide = 0, moving = 0;
  fprintf(f, "%s: scene %s\nsmall changes about the %s, in SI units (angles in rad):", app->scene->model->name,
          app->scene->name, about(&app->args));
  for (int i = 0; i < s->n; i++) {
    lag_sim_state_info(s->sim, i, name, NAME, unit, sizeof unit);
    fprintf(f, "%s%s = %.7g%s%s", i ? ", " : "\n  ", name, lag_sim_declared(s->sim, i, s->y[i]), unit[0] ? " " : "",
            unit);
    moving |= s->rate[i] != 0.0;
  }
  fputs("\n\n", f);
  for (int i = 0; i < s->n + s->nout; i++) {
    int n = (int)strlen(row_name(s, i, name));
    wide = n > wide && n < 24 ? n : wide;
  }
  for (int i = 0; i < s->n; i++) put_row(f, s, i, wide);
  fputs("outputs:\n", f);
  for (int i = s->n; i < s->n + s->nout; i++) put_row(f, s, i, wide);
  if (moving && strcmp(about(&app->args), "start") == 0)
    fputs("the start is no equilibrium: changes are from the motion that begins there; --equilibrium finds one\n", f);
  const lag_switch *jump = lag_jump_at(s->sim, s->y);
  if (jump)
    fprintf(f,
            "%s jumps here, at %s = %s: small motions there are not linear, and these are the equations without it\n",
            jump->text, jump->surface, lag_switch_value(jump));
}

/* ---- JSON and files */

/* A name with its declared unit, whose size in SI is `factor`; value: in that unit, where there is one. */
static void json_variable(Json *j, const char *name, const char *unit, double factor, const double *value) {
  lag_json_begin(j, NULL, '{');
  lag_json_strings(j, {"name", name}, {"unit", unit});
  lag_json_number(j, "factor", factor);
  if (value) lag_json_number(j, "value", *value);
  lag_json_end(j, '}');
}

static void put_json(FILE *f, const App *app, const LinearSystem *s) {
  Json j = lag_app_json(app, f);
  char name[NAME + 4], unit[64];
  const lag_model *m = app->scene->model;
  lag_json_strings(&j, {"status", "ok"}, {"about", about(&app->args)});
  lag_json_number(&j, "t", s->sim->run->t);
  JSON_EACH(&j, "states", '[', i, s->n) {
    double factor = lag_sim_state_info(s->sim, i, name, NAME, unit, sizeof unit),
           value = lag_sim_declared(s->sim, i, s->y[i]);
    json_variable(&j, name, unit, factor, &value);
  }
  JSON_EACH(&j, "inputs", '[', k, s->nu) json_variable(&j, m->u[k].name, m->u[k].unit, m->u[k].factor, NULL);
  JSON_EACH(&j, "outputs", '[', i, s->nout) {
    double factor = lag_sim_output_info(s->sim, i, name, NAME, unit, sizeof unit);
    json_variable(&j, name, unit, factor, NULL);
  }
  const lag_switch *jump = lag_jump_at(s->sim, s->y);
  if (jump) lag_json_string(&j, "jumps", jump->text);
  lag_json_row(&j, "rate", s->n, s->rate);
  lag_json_matrix(&j, "A", s->n, s->n, s->A), lag_json_matrix(&j, "B", s->n, s->nu, s->B);
  lag_json_matrix(&j, "C", s->nout, s->n, s->C), lag_json_matrix(&j, "D", s->nout, s->nu, s->D);
  lag_json_close(&j);
}

/* The rows of [A B; C D], with a column for each state and input. */
static int put_file(App *app, const LinearSystem *s) {
  int columns = s->n + s->nu, rc = 0;
  Table t = {.ncols = columns, .keep = 1, .cols = calloc((size_t)columns, sizeof *t.cols)};
  double *row = calloc((size_t)columns, sizeof *row);
  char name[NAME + 4];
  if (!t.cols || !row) rc = -1;
  for (int k = 0; k < columns && rc == 0; k++)
    snprintf(t.cols[k].name, sizeof t.cols[k].name, "%s", column_name(s, k, name));
  for (int i = 0; i < s->n + s->nout && rc == 0; i++) {
    for (int k = 0; k < columns; k++) row[k] = element(s, i, k);
    rc = lag_table_add(&t, row);
  }
  rc = rc ? lag_app_error(&app->args, "out of memory") : lag_app_write_table(app, app->args.out, &t);
  lag_table_free(&t);
  free(row);
  return rc;
}

/* ---- The command */

static int fill(LinearSystem *s) {
  const struct {
    lag_quantity of;
    double *to;
  } all[] = {{LAG_RATES, s->rate},
             {LAG_RATES_BY_STATE, s->A},
             {LAG_RATES_BY_INPUTS, s->B},
             {LAG_OUTPUTS_BY_STATE, s->C},
             {LAG_OUTPUTS_BY_INPUTS, s->D}};
  int rc = 0;
  for (size_t i = 0; i < sizeof all / sizeof *all && rc == 0; i++)
    rc = lag_sim_quantity(s->sim, all[i].of, 1, &s->sim->run->t, s->y, NULL, all[i].to);
  return rc;
}

static int linearize(App *app, LinearSystem *s) {
  const Args *a = &app->args;
  int rc = a->equilibrium || a->steady ? lag_app_rest(app, s->y) : 0;
  if (rc) return rc;
  if (fill(s)) return lag_app_no_result(a, "%s", lag_sim_message(s->sim));
  if (a->out) return put_file(app, s);
  if (a->json) put_json(stdout, app, s);
  else put_text(stdout, app, s);
  return EXIT_FINE;
}

int lag_app_linearize(App *app) {
  int rc = lag_app_set_up_start(app);
  if (rc == 0 && lag_sim_advance(app->sim, app->scene->t0))
    rc = lag_app_error(&app->args, "%s", lag_sim_message(app->sim));
  if (rc) return rc;
  if (app->scene->model->ncontacts)
    return lag_app_error(&app->args,
                         "contacts open and close, so that no linear system follows the motion: take a scene or "
                         "model without them");
  LinearSystem s = {.sim = app->sim, .n = app->sim->pb.n, .nu = app->scene->model->nu,
                    .nout = lag_sim_noutputs(app->sim)};
  size_t n = (size_t)s.n, nu = (size_t)s.nu, nout = (size_t)s.nout;
  const lag_part parts[] = {{&s.y, n}, {&s.rate, n}, {&s.A, n * n}, {&s.B, n * nu + 1}, {&s.C, nout * n},
      {&s.D, nout * nu + 1}};
  if (!(s.block = lag_workspace(sizeof parts / sizeof *parts, parts)))
    return lag_app_error(&app->args, "out of memory");
  memcpy(s.y, app->sim->now, n * sizeof *s.y);
  rc = linearize(app, &s);
  free(s.block);
  return rc;
}
