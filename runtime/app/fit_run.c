/* --fit: parameters and starts from measured motions (analysis/fit.h). Enters: names, and a file of data whose columns
 * lagc has made outputs of the scene; leaves: values with errors, a report, a picture. Holds: columns are matched by
 * name and unit, times are taken as they are, and what does not fit is refused with its line. */
#include "app/fit_run.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "numeric/release.h"

enum { MOST_STEPS = 200, MOST_FILES = 100, MOST_PARTS = 100000 };

/* A new simulation with the settings of the command line. */
static lag_sim *fresh(void *run) {
  FitRun *r = run;
  lag_sim *sim = lag_app_fresh_bare_sim(r->app);
  if (!sim || lag_app_copy_method(r->app->sim, sim, 1) == LAG_OK) return sim;
  lag_sim_free(sim);
  return NULL;
}

/* ---- Targets */

static int starts_with(const char *list, const char *name, const char **rest) {
  size_t n = strlen(name);
  *rest = list + n;
  return strncmp(list, name, n) == 0;
}

/* name~normal(MEAN, DEVIATION) of --prior. */
static int take_prior(FitRun *r, const char *text) {
  const char *rest;
  int found = 0;
  for (int j = 0; j < r->fit.n; j++) {
    FitTarget *t = &r->fit.target[j];
    if (!starts_with(text, t->name, &rest) || *rest != '~') continue;
    found = 1;
    int end = 0;
    int read = sscanf(rest, "~normal(%lf ,%lf )%n", &t->prior, &t->prior_error, &end);
    if (read == 2 && end && !rest[end] && isfinite(t->prior) && t->prior_error > 0 && isfinite(t->prior_error)) {
      if (t->prior * t->sign >= 0) continue;
      return lag_app_error(&r->app->args, "--prior '%s': the model declares %s %c 0, and the mean is %g", text, t->name,
                           t->sign > 0 ? '>' : '<', t->prior);
    }
    return lag_app_error(&r->app->args, "--prior '%s': write --prior '%s~normal(MEAN, DEVIATION)', in %s", text,
                         t->name, t->unit[0] ? t->unit : "its own unit");
  }
  if (found) return 0;
  return lag_app_error(&r->app->args, "--prior '%s': write NAME~normal(MEAN, DEVIATION), with a NAME of --fit", text);
}

/* Splits "g,l,th(0)" at commas outside of brackets. */
static int split(char *text, char **name) {
  int n = 0, depth = 0;
  if (name) name[0] = text;
  for (char *c = text; *c; c++) {
    depth += *c == '(' || *c == '[' ? 1 : *c == ')' || *c == ']' ? -1 : 0;
    if (*c != ',' || depth > 0) continue;
    n++;
    if (name) {
      name[n] = c + 1;
      *c = '\0';
    }
  }
  return n + 1;
}

/* The name without blanks around it and without "(0)". */
static char *bare(char *name) {
  name += strspn(name, " ");
  size_t n = strlen(name);
  while (n && name[n - 1] == ' ') name[--n] = '\0';
  if (n > 3 && strcmp(name + n - 3, "(0)") == 0) name[n - 3] = '\0';
  return name;
}

/* Whether the name belongs to an effect that the scene does not use. */
static int is_of_other_effect(const App *app, const char *name) {
  const char *dot = strchr(name, '.');
  size_t n = dot ? (size_t)(dot - name) : 0;
  return dot && lag_app_has_word(app->program->effects, name, n) &&
         !lag_app_has_word(app->scene->model->effects, name, n);
}

/* Of several records each start is a target of its own, "th(0) in b.csv". */
static int separate_starts(FitRun *r) {
  Fit *f = &r->fit;
  FitTarget *all = calloc((size_t)(f->n * r->nfiles) + 1, sizeof *all);
  int n = 0;
  if (!all) return lag_app_error(&r->app->args, "out of memory");
  for (int j = 0; j < f->n; j++) {
    size_t length = strlen(f->target[j].label);
    int is_start = f->target[j].is_start;
    for (int k = 0; k < (is_start ? r->nfiles : 1); k++) {
      FitTarget *t = &all[n++];
      *t = f->target[j];
      if (!is_start) continue;
      const char *slash = strrchr(r->file[k], '/');
      t->record = k + 1;
      snprintf(t->label + length, sizeof t->label - length, " in %.50s", slash ? slash + 1 : r->file[k]);
    }
  }
  free(f->target);
  f->target = all;
  f->n = n;
  return 0;
}

int lag_fit_take_targets(FitRun *r) {
  const Args *a = &r->app->args;
  Fit *f = &r->fit;
  r->names = lag_network_targets(r->app->scene->model, a->fit);
  char **name = r->names ? calloc((size_t)split(r->names, NULL), sizeof *name) : NULL;
  f->n = name ? split(r->names, name) : 0;
  f->target = calloc((size_t)f->n + 1, sizeof *f->target);
  lag_sim *sim = lag_app_fresh_bare_sim(r->app);
  int rc = !name || !f->target || !sim ? lag_app_error(a, "out of memory") : 0;
  int all = f->n;
  f->n = 0;
  for (int j = 0; j < all && rc == 0; j++) {
    char *one = bare(name[j]);
    if (!r->compares || !is_of_other_effect(r->app, one)) f->target[f->n].name = name[f->n] = one, f->n++;
  }
  if (rc == 0 &&
      (lag_app_copy_method(r->app->sim, sim, 1) || lag_sim_set_sensitivity(sim, f->n, (const char *const *)name)))
    rc = lag_app_error(a, "--fit: %s", lag_sim_message(sim));
  for (int j = 0; j < f->n && rc == 0; j++) {
    FitTarget *t = &f->target[j];
    const lag_var *var;
    int i;
    t->factor = lag_sim_sensitivity_info(sim, j, t->label, sizeof t->label, t->unit, sizeof t->unit);
    t->is_start = lag_find_name(sim->scene->model, t->name, &i, &var) != LAG_IS_P;
    t->sign = t->is_start ? 0 : var->sign;
    t->begin = lag_declared(var, lag_sim_sensitivity_value(sim, j));
    t->weight = lag_network_key(a->fit, t->name) != NULL;
    t->scale = t->begin != 0.0 && !t->weight ? fabs(t->begin) : 1;
    f->trains |= t->weight;
  }
  lag_sim_free(sim);
  free(name);
  if (rc == 0 && r->nfiles > 1) rc = separate_starts(r);
  for (int i = 0; i < a->npriors && rc == 0; i++) rc = take_prior(r, a->priors[i]);
  return rc;
}

/* ---- Columns */

/* Number of the output with this name; -1: none. */
static int output_named(const FitRun *r, const char *label) {
  char name[96];
  int n = lag_sim_noutputs(r->app->sim), i = n - 1; /* those of the data stand last */
  while (i >= 0 && (lag_sim_output_info(r->app->sim, i, name, sizeof name, NULL, 0), strcmp(name, label) != 0)) i--;
  return i;
}

/* The column with the errors of another one: "sigma(th) [deg]" for "th [deg]"; 0: none. */
static int errors_of(const DataFile *d, const char *label) {
  char want[160];
  const char *unit = strstr(label, " [");
  int n = (int)(unit ? (size_t)(unit - label) : strlen(label));
  for (int k = 1; k < d->file.ncols; k++) {
    snprintf(want, sizeof want, "sigma(%.*s)%s", n, label, unit ? unit : "");
    if (strcmp(d->file.names[k], want) == 0) return k;
  }
  return 0;
}

/* Whether the first n letters are the label without its unit. */
static int is_name_of(const char *label, const char *name, size_t n) {
  const char *unit = strstr(label, " [");
  return (unit ? (size_t)(unit - label) : strlen(label)) == n && strncmp(label, name, n) == 0;
}

/* Error of column c by --sigma X or --sigma NAME=X, in the column's unit; 0: not given. */
int lag_fit_take_sigma(FitRun *r, FitColumn *c) {
  const Args *a = &r->app->args;
  for (int i = 0; i < a->nsigmas; i++) {
    const char *text = a->sigmas[i], *eq = strchr(text, '=');
    if (eq && !is_name_of(c->label, text, (size_t)(eq - text))) continue;
    if (strchr(eq ? eq + 1 : text, '['))
      return lag_app_error(a, "--sigma %s: write the number alone; its unit is that of the column, %s", text, c->label);
    if (lag_args_positive(a, "--sigma", eq ? eq + 1 : text, "--sigma 0.01, or --sigma th=0.5",
                          "the error of a value is positive", &c->sigma))
      return EXIT_USAGE;
  }
  return 0;
}

/* Copies column c of file `of`, and its errors. */
static int copy_column(FitRun *r, int c, int of) {
  Fit *f = &r->fit;
  const DataFile *d = &r->data[of];
  int errors = errors_of(d, f->column[c].label), k = 1;
  while (k < d->file.ncols && strcmp(d->file.names[k], f->column[c].label) != 0) k++;
  if (k == d->file.ncols || (of > 0 && (errors > 0) != f->column[c].per_row))
    return lag_app_error(&r->app->args, "%s: the column \"%s%s\" of %s is missing here", r->file[of],
                         k == d->file.ncols ? "" : "sigma of ", f->column[c].label, r->file[errors == 0 ? 0 : of]);
  f->column[c].per_row = errors > 0;
  for (int i = 0; i < (int)d->nrows; i++) {
    const double *row = d->x + (size_t)i * (size_t)d->file.ncols;
    int at = (r->first[of] + i) * f->ncolumns + c;
    f->data[at] = row[k];
    if (errors) f->errors[at] = row[errors];
    if (errors && !isnan(row[k]) && !(row[errors] > 0))
      return lag_app_error(&r->app->args, "%s:%lld: column %s: an error is positive, or its value is missing, too",
                           r->file[of], d->line[i], d->file.names[errors]);
  }
  return lag_fit_take_sigma(r, &f->column[c]);
}

/* Whether --columns names the column, or is not given. */
int lag_fit_is_asked(const Args *a, const char *label) {
  const char *list = a->columns;
  if (!list) return 1;
  while (*list) {
    size_t n = strcspn(list, ",");
    if (is_name_of(label, list, n)) return 1;
    list += n + (list[n] == ',');
  }
  return 0;
}

/* Whether one of the columns has the name. */
static int is_column(const Fit *f, const char *name, size_t n) {
  for (int c = 0; c < f->ncolumns; c++)
    if (is_name_of(f->column[c].label, name, n)) return 1;
  return 0;
}

int lag_fit_check_names(const Args *a, const Fit *f) {
  for (const char *list = a->columns; list && *list;) {
    size_t n = strcspn(list, ",");
    if (n && !is_column(f, list, n))
      return lag_app_error(a, "--columns %s: \"%.*s\" is none of the columns; they are named without units",
                           a->columns, (int)n, list);
    list += n + (list[n] == ',');
  }
  for (int i = 0; i < a->nsigmas; i++) {
    const char *eq = strchr(a->sigmas[i], '=');
    if (eq && !is_column(f, a->sigmas[i], (size_t)(eq - a->sigmas[i])))
      return lag_app_error(a,
                           "--sigma %s: \"%.*s\" is none of the columns, the first of which is \"%s\"; they are named "
                           "without units",
                           a->sigmas[i], (int)(eq - a->sigmas[i]), a->sigmas[i], f->column[0].label);
  }
  return 0;
}

/* Refuses errors that belong to no column. */
static int check_errors(const FitRun *r, int of) {
  const DataFile *d = &r->data[of];
  for (int k = 1; k < d->file.ncols; k++) {
    int j = 1;
    if (strncmp(d->file.names[k], "sigma(", 6) != 0) continue;
    while (j < d->file.ncols && errors_of(d, d->file.names[j]) != k) j++;
    if (j == d->file.ncols)
      return lag_app_error(&r->app->args,
                           "%s: \"%s\" are the errors of no column here: those of \"th [deg]\" are called "
                           "\"sigma(th) [deg]\"",
                           r->file[of], d->file.names[k]);
  }
  return 0;
}

static int take_columns(FitRun *r) {
  const Args *a = &r->app->args;
  const DataFile *d = &r->data[0];
  Fit *f = &r->fit;
  f->nrows = r->first[r->nfiles];
  f->column = calloc((size_t)d->file.ncols, sizeof *f->column);
  for (int k = 1; k < d->file.ncols && f->column; k++) {
    for (int j = 1; j < k; j++)
      if (strcmp(d->file.names[j], d->file.names[k]) == 0)
        return lag_app_error(a, "%s: there are two columns \"%.40s\"; leave one out", r->file[0], d->file.names[k]);
    int output = lag_fit_is_asked(a, d->file.names[k]) ? output_named(r, d->file.names[k]) : -1;
    if (output >= 0) f->column[f->ncolumns++] = (FitColumn){.label = d->file.names[k], .output = output};
  }
  for (int of = 0; of < r->nfiles; of++)
    if (check_errors(r, of)) return EXIT_USAGE;
  if (lag_fit_check_names(a, f)) return EXIT_USAGE;
  if (f->ncolumns == 0)
    return lag_app_error(a, d->file.ncols == 1 ? "%s: there is no column besides the time"
                                               : "%s: no column besides the time is an output here; `lagc fit` makes "
                                                 "them outputs", r->file[0]);
  size_t many = (size_t)f->nrows * (size_t)f->ncolumns;
  f->data = calloc(many, sizeof *f->data);
  f->errors = calloc(many, sizeof *f->errors);
  if (!f->data || !f->errors) return lag_app_error(a, "out of memory");
  int rc = 0;
  for (int of = 0; of < r->nfiles; of++)
    for (int c = 0; c < f->ncolumns && rc == 0; c++) rc = copy_column(r, c, of);
  return rc;
}

/* The unit of the file's times in seconds: the value of the output that lagc has named after the column. */
static int take_time_unit(FitRun *r) {
  const Args *a = &r->app->args;
  const char *label = r->data[0].file.names[0];
  r->time_unit = 1;
  for (int of = 1; of < r->nfiles; of++)
    if (strcmp(r->data[of].file.names[0], label) != 0)
      return lag_app_error(a, "%s: the time is \"%.40s\", that of %s is \"%.40s\"; write one unit", r->file[of],
                           r->data[of].file.names[0], r->file[0], label);
  if (strcmp(label, "t") == 0 || strcmp(label, "t [s]") == 0) return 0;
  if (strncmp(label, "t [", 3) != 0)
    return lag_app_error(a, "%s: the first column is \"%.40s\"; it must be the time: t [s]", r->file[0], label);
  int k = output_named(r, label), n = lag_sim_noutputs(r->app->sim);
  double *out = calloc((size_t)n + 1, sizeof *out);
  int rc = k < 0 || !out || lag_sim_outputs(r->app->sim, out)
               ? lag_app_error(a, "%s: the unit of the time, %s, is not known here; write t [s]", r->file[0], label)
               : 0;
  if (rc == 0) r->time_unit = 1 / out[k];
  free(out);
  return rc;
}

/* Times of file `of` to t[rows]. */
static int take_times_of(FitRun *r, int of, double *t) {
  const Args *a = &r->app->args;
  const DataFile *d = &r->data[of];
  const char *file = r->file[of];
  double t0 = r->app->scene->t0;
  int rc = 0;
  for (size_t i = 0; i < d->nrows && rc == 0; i++) {
    t[i] = d->x[i * (size_t)d->file.ncols] * r->time_unit;
    if (isnan(t[i])) rc = lag_app_error(a, "%s:%lld: the time is missing", file, d->line[i]);
    else if (i && t[i] == t[i - 1])
      rc = lag_app_error(a, "%s:%lld: t = %.9g s stands twice; join the rows, for example by their mean", file,
                         d->line[i], t[i]);
    else if (i && t[i] < t[i - 1])
      rc = lag_app_error(a, "%s:%lld: t = %.9g s comes after %.9g s; sort the rows by time", file, d->line[i], t[i],
                         t[i - 1]);
    else if (t[i] < t0)
      rc = lag_app_error(
          a,
          "%s:%lld: t = %.9g s lies before the scene, which begins at %.9g s; write `span %.9g..` into the "
          "scene",
          file, d->line[i], t[i], t0, t[0]);
  }
  return rc;
}

static int take_times(FitRun *r) {
  int rc = take_time_unit(r);
  double *t = r->t = calloc((size_t)r->first[r->nfiles] + 1, sizeof *t);
  if (!t) return lag_app_error(&r->app->args, "out of memory");
  for (int of = 0; of < r->nfiles && rc == 0; of++) rc = take_times_of(r, of, t + r->first[of]);
  r->fit.t = t;
  return rc;
}

/* ---- Files */

/* Splits FILE,FILE, unless a file of the whole name is there. */
static void split_files(FitRun *r, char *text) {
  FILE *whole = fopen(text, "rb");
  r->file[0] = text;
  r->nfiles = 1;
  if (whole) fclose(whole);
  for (char *c = text; !whole && *c && r->nfiles < MOST_FILES; c++)
    if (*c == ',') *c = '\0', r->file[r->nfiles++] = c + 1;
}

static int read_files(FitRun *r) {
  const Args *a = &r->app->args;
  char why[400];
  size_t rows = 0;
  r->file = calloc(MOST_FILES, sizeof *r->file);
  char *text = r->file ? malloc(strlen(a->data) + 1) : NULL;
  if (!text) return lag_app_error(a, "out of memory");
  split_files(r, strcpy(text, a->data));
  r->data = calloc((size_t)r->nfiles, sizeof *r->data);
  r->first = calloc((size_t)r->nfiles + 1, sizeof *r->first);
  if (!r->data || !r->first) return lag_app_error(a, "out of memory");
  for (int of = 0; of < r->nfiles; of++) {
    if (lag_data_read(r->file[of], &r->data[of], why, sizeof why)) return lag_app_error(a, "--data %s", why);
    r->first[of + 1] = (int)(rows += r->data[of].nrows);
  }
  r->fit.nrecords = r->nfiles;
  r->fit.first = r->first;
  return 0;
}

/* ---- The analysis */

/* Data and records that take long are announced; more than indices reach are refused. */
static int check_size(const FitRun *r) {
  const Args *a = &r->app->args;
  const double many = 2e6, rows = r->fit.nrows, data = rows * r->fit.ncolumns, derivatives = data * (r->fit.n + 1);
  if (derivatives > INT_MAX)
    return lag_app_error(a, "--data %s: %.0f rows are more than a fit takes; leave out all but every %.0fth", a->data,
                         rows, ceil(derivatives / many));
  if (data > many && !a->quiet)
    fprintf(stderr,
            "%s: note: %.0f rows take %.2g GB, and each of ten to a hundred runs passes all of them; every %.0fth row "
            "says nearly as much\n",
            a->self, rows, (derivatives + 5 * data) * sizeof(double) / 1e9, ceil(100 * data / many));
  const double before = r->t[0] - r->app->scene->t0, length = r->t[r->first[1] - 1] - r->t[0], far = 1000;
  if (before > far * length && length > 0 && !a->quiet)
    fprintf(stderr,
            "%s: note: the record begins %g s after the scene, where each run begins: let the span begin nearer\n",
            a->self, before);
  return 0;
}

static int prepare(FitRun *r) {
  App *app = r->app;
  const Args *a = &app->args;
  if (!app->extras.fits) return lag_app_no_gsl(app, "solves least squares");
  if (!a->data) return lag_app_error(a, "--fit %s: the data are missing: --data motion.csv", a->fit);
  int rc = read_files(r);
  if (rc || (rc = lag_app_set_up_start(app)) != 0 || (rc = take_times(r)) != 0) return rc;
  app->until = r->t[r->first[1] - 1];
  if ((rc = lag_app_choose_method(app)) != 0 || (rc = take_columns(r)) != 0) return rc;
  r->fit.by = app->extras.fits;
  r->fit.fresh = fresh;
  r->fit.context = r;
  r->fit.most = MOST_STEPS;
  long long parts = 0;
  if (a->segments && (rc = lag_args_count(a, "--segments", a->segments, "--segments 20", &parts)) != 0) return rc;
  r->fit.parts = (int)(parts > MOST_PARTS ? MOST_PARTS : parts);
  r->fit.huber = a->loss && strcmp(a->loss, "huber") == 0;
  if ((rc = lag_fit_take_targets(r)) != 0 || (rc = check_size(r)) != 0) return rc;
  if (r->fit.trains && !a->out)
    return lag_app_error(a, "--fit %s: where do the weights go? Write -o weights.json", a->fit);
  if (r->fit.trains && r->compares)
    return lag_app_error(a, "--fit %s: one file of weights is for one scene; name one, without --effects", a->fit);
  if (r->fit.trains && a->profile)
    return lag_app_error(a, "--profile: data do not determine the weights of a network one by one; leave it out");
  if (a->out && !r->fit.trains)
    return lag_app_error(a, "-o %s: weights of a network are written there, and --fit %s names none", a->out, a->fit);
  return 0;
}

int lag_fit_run(FitRun *r) {
  int rc = prepare(r);
  for (int j = 0; j < r->fit.n; j++) r->fit.target[j].low = r->fit.target[j].high = NAN;
  if (rc || (r->status = lag_fit(&r->fit)) == LAG_OK) return rc;
  lag_app_error(&r->app->args, "%s", r->fit.why);
  return r->status == LAG_EINVAL ? EXIT_USAGE : EXIT_RUN;
}

void lag_fit_run_free(FitRun *r) {
  lag_fit_free(&r->fit);
  lag_free_all(r->fit.target, r->fit.column, r->fit.data, r->fit.errors, r->t, r->names);
  for (int of = 0; of < r->nfiles && r->data; of++) lag_data_free(&r->data[of]);
  lag_free_all(r->data, r->first);
  if (r->file) free(r->file[0]);
  free(r->file);
}

int lag_app_fit(App *app) {
  FitRun r = {.app = app};
  const Args *a = &app->args;
  if (a->nscenes > 1 && a->svg) return lag_app_error(a, "--svg: a picture is of one fit; name one scene");
  if (a->nscenes > 1) return lag_fit_compare(app);
  int rc = lag_fit_run(&r);
  if (rc == 0 && a->svg && r.nfiles > 1) rc = lag_app_error(a, "--svg: a picture is of one record; name one file");
  if (rc == 0 && a->profile && lag_fit_profile(&r.fit)) rc = lag_app_error(a, "%s", r.fit.why);
  if (rc == 0 && a->svg) rc = lag_fit_picture(&r);
  if (rc == 0 && a->out && lag_network_write(&r, a->out)) rc = lag_app_io_error(app, a->out);
  if (rc == 0 && a->json) lag_fit_report_json(&r, stdout);
  if (rc == 0 && !a->json) lag_fit_report(&r, stdout);
  if (rc == 0 && !r.fit.converged) rc = EXIT_RUN;
  lag_fit_run_free(&r);
  return rc;
}
