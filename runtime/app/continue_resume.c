/* --continue --resume: the rows of an earlier run, and the place where a branch goes on. Enters: the file; leaves: its
 * rows in app->table, the start and the direction. Holds: a file of another model, parameter or options is refused. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/continue_branches.h"
#include "core/core.h"
#include "io/csv_file.h"
#include "numeric/fnv1a.h"

/* Hash of the model and of all values but the parameter. */
static unsigned long long hash_values(Job *job) {
  lag_sim *sim = job->app->sim;
  const lag_var *v = NULL;
  unsigned long long h = lag_sim_signature(sim);
  int index = 0, is_parameter = lag_find_name(job->app->scene->model, job->name, &index, &v) == LAG_IS_P;
  for (int i = 0; i < job->app->scene->model->np; i++)
    h = lag_hash_number(h, is_parameter && i == index ? 0 : sim->p[i]);
  h = lag_hash_numbers(h, sim->scene->model->nu, sim->hold);
  return lag_hash_numbers(h, lag_sim_method(sim)->noptions, lag_sim_options(sim));
}

void lag_continue_describe(Job *job) {
  const App *app = job->app;
  const Args *a = &app->args;
  const char *const options[][2] = {{"--period", a->period}, {"--hold", a->hold}, {"--relative", a->relative},
                                    {"--reverse", a->reverse}, {"--steady", a->steady ? "" : NULL}};
  char text[64], *s = job->written_by;
  size_t size = sizeof job->written_by, n = 0;
  unsigned long long h = hash_values(job);
  n += (size_t)snprintf(s, size, "%.80s %.80s over %s, %.64s, tol %s", app->scene->model->name, app->scene->name,
                        job->name, lag_sim_method(app->sim)->name,
                        lag_number_text(lag_sim_tolerance(app->sim), text));
  for (size_t k = 0; k < sizeof options / sizeof *options; k++) {
    if (!options[k][1]) continue;
    h = lag_hash_text(h, options[k][1]);
    n += (size_t)snprintf(s + n, size - n, ", %s%s%.60s", options[k][0], *options[k][1] ? " " : "", options[k][1]);
  }
  snprintf(s + n, size - n, ", values %016llx", h);
}

/* *x := the number of field i, or the index of its word. */
static int read_field(const CsvFile *f, const Column *c, int i, double *x) {
  if (!c->words) return lag_csv_number(f, i, c->name, x);
  for (int k = 0; c->words[k]; k++)
    if (strcmp(c->words[k], f->field[i]) == 0) return *x = k, 0;
  return lag_csv_refuse(f, "%s: `%s` is none of the words of this column", c->name, f->field[i]);
}

/* The names in the first line are those of this run. */
static int check_columns(const CsvFile *f, const Table *t) {
  for (int i = 0; i < t->ncols; i++) {
    char label[sizeof(Column) + 4];
    lag_column_label(&t->cols[i], label, sizeof label);
    if (i >= f->ncols || strcmp(f->names[i], label) != 0)
      return lag_csv_refuse(f, "column %d is `%s`, and should be `%s`: the file is none of this model and NAME by -o",
                            i + 1, i < f->ncols ? f->names[i] : "", label);
  }
  return f->ncols == t->ncols ? 0 : lag_csv_refuse(f, "there are %d columns too many", f->ncols - t->ncols);
}

/* One row into the table; the first one says what wrote the file. */
static int take_row(Job *job, CsvFile *f) {
  Table *t = &job->app->table;
  double *row = job->app->row;
  const char *by = f->field[t->ncols - 1];
  if (!t->nrows && strcmp(by, job->written_by) != 0)
    return lag_csv_refuse(f, "the file was written by `%s`; this is `%s`: write the same model, NAME, values and "
                             "options, or leave out --resume", by, job->written_by);
  for (int i = 0; i < t->ncols; i++)
    if (read_field(f, &t->cols[i], i, &row[i])) return -1;
  if (!isfinite(row[0])) return lag_csv_refuse(f, "%s: `%s` is no place of a branch", f->names[0], f->field[0]);
  if (!(row[1] >= 1 && row[1] <= 1e6 && row[1] == rint(row[1])))
    return lag_csv_refuse(f, "%s: `%s` is no number of a branch: 1, 2, ...", f->names[1], f->field[1]);
  return lag_table_add(t, row) ? lag_csv_refuse(f, "out of memory") : 0;
}

/* The last branch that ended at the number of its points, or at the end of a range that was narrower. */
static int choose_row(Job *job, const CsvFile *f) {
  const Table *t = &job->app->table;
  double low = fmin(job->low, job->high), high = fmax(job->low, job->high), near = 1e-9 * (high - low);
  for (size_t k = t->nrows; k-- > 0;) {
    double x = lag_table_cell(t, k, 0), end = lag_table_cell(t, k, t->ncols - 2);
    int ends = end == 1.0 + BRANCH_AT_RANGE || end == 1.0 + BRANCH_AT_NUMBER;
    if (!ends || x < low + near || x > high - near) continue;
    int single = k == 0 || lag_table_cell(t, k - 1, 1) != lag_table_cell(t, k, 1) ||
                 lag_table_cell(t, k - 1, t->ncols - 2) != 0.0;
    if (single) continue; /* no direction */
    job->resumed = k + 1;
    return 0;
  }
  return lag_csv_refuse(f, "no branch can go on within %g..%g: each ends at its border or outside, is closed, lost, or "
                           "a single row; widen the range", job->low, job->high);
}

static int read_rows(Job *job, CsvFile *f) {
  int rc = check_columns(f, &job->app->table), more = 1;
  while (rc == 0 && (more = lag_csv_row(f)) == 1) rc = take_row(job, f);
  f->line = 0; /* of the file as a whole */
  return rc || more < 0 ? -1 : choose_row(job, f);
}

/* The state and the period of the row become those to begin with. */
static int begin_there(Job *job) {
  App *app = job->app;
  const double *row = lag_continue_last(job);
  for (int i = 0; i < app->sim->pb.n; i++) {
    Column c = lag_state_column(app->sim, i);
    if (lag_sim_set(app->sim, c.name, row[OF_STATE + i]))
      return lag_app_error(&app->args, "%s", lag_sim_message(app->sim));
  }
  job->begin = row[0];
  if (isnan(row[OF_PERIOD])) return 0;
  lag_number_text(row[OF_PERIOD], job->guess);
  app->args.guess = job->guess;
  return 0;
}

int lag_continue_resume(Job *job) {
  const Args *a = &job->app->args;
  CsvFile f;
  char why[2000];
  if (!a->resume) return 0;
  int rc = lag_csv_open(&f, a->resume, why, sizeof why);
  rc = rc ? rc : read_rows(job, &f);
  lag_csv_close(&f);
  return rc ? lag_app_error(a, "--resume %s", why) : begin_there(job);
}

const double *lag_continue_last(const Job *job) {
  const Table *t = &job->app->table;
  return t->data + (job->resumed - 1) * (size_t)t->ncols;
}

void lag_continue_direction(const Job *job, const PeriodicOrbit *o, int cols, double *d) {
  const lag_sim *sim = job->app->sim;
  const double *row = lag_continue_last(job), *before = row - job->app->table.ncols;
  int n = sim->pb.n, nq = sim->pb.nq;
  double size = 0;
  memset(d, 0, (size_t)cols * sizeof *d);
  for (int i = 0; i < n; i++) {
    double x = (row[OF_STATE + i] - before[OF_STATE + i]) / (lag_sim_declared(sim, i, 1) - lag_sim_declared(sim, i, 0));
    if (o) d[i] = x / o->unit[i];
    else if (job->steady.cols) d[i] = x / job->steady.steady.unit[i];
    else if (i < nq) d[i] = x / job->rest.unit[i];
    else if (i >= 2 * nq) d[i - nq] = x / job->rest.unit[i - nq];
  }
  if (o && !o->flow.forced) d[o->m * o->n] = (row[OF_PERIOD] - before[OF_PERIOD]) / o->time;
  d[cols - 1] = (row[0] - before[0]) / job->size * (job->led_kind >= 0 && job->factor < 0 ? -1 : 1);
  for (int i = 0; i < cols; i++) size += d[i] * d[i];
  for (int i = 0; i < cols; i++) d[i] /= sqrt(size);
}
