/* Results of a sweep: a row a run, in order; statistics of each measure; failures, each kind with its first run. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/sweep.h"
#include "numeric/magnitudes.h"
#include "numeric/release.h"

/* One measure over the runs that have it. */
typedef struct Statistics {
  long long n;
  double mean, deviation, least, most, quantile[3]; /* 5, 50, 95 % */
} Statistics;

static const double parts[3] = {0.05, 0.5, 0.95};

/* ---- Rows */

/* The word of a status in the table's last column. */
static double word_of(int status) { return status >= 0 ? status == LAG_STOPPED : 1 - status; }

int lag_sweep_each_row(SweepApp *s, int (*take)(void *context, long long run, const double *row), void *context) {
  const Sweep *w = &s->sweep;
  size_t columns = (size_t)lag_sweep_columns(w);
  double *chunk = malloc((size_t)w->chunk * columns * sizeof *chunk),
         *row = malloc((size_t)s->table.ncols * sizeof *row);
  int rc = chunk && row ? 0 : -1;
  for (long long c = 0; c < s->journal.chunks && rc == 0; c++) {
    long long n = lag_sweep_chunk_runs(w, c);
    rc = lag_journal_get(&s->journal, c, chunk, (size_t)n * columns);
    for (long long k = 0; k < n && rc == 0; k++) {
      lag_plan_values(&s->plan, c * w->chunk + k, row);
      memcpy(row + s->plan.n, chunk + (size_t)k * columns, columns * sizeof *row);
      rc = take(context, c * w->chunk + k, row);
    }
  }
  lag_free_all(chunk, row);
  return rc;
}

typedef struct Output {
  Rows rows;
  double *copy; /* [ncols] */
} Output;

static int write_row(void *output, long long run, const double *row) {
  Output *o = output;
  size_t n = (size_t)o->rows.ncols;
  (void)run;
  memcpy(o->copy, row, n * sizeof *row);
  if (!o->rows.npy) o->copy[n - 1] = word_of((int)row[n - 1]);
  return lag_rows_write(&o->rows, o->copy);
}

static int write_rows(SweepApp *s) {
  const Args *a = &s->app->args;
  Output o = {.copy = malloc((size_t)s->table.ncols * sizeof(double))};
  if (!o.copy) return lag_app_error(a, "out of memory");
  int rc = lag_rows_open(&o.rows, a->out, &s->table);
  rc = rc ? rc : lag_sweep_each_row(s, write_row, &o);
  if (lag_rows_close(&o.rows, rc == 0)) rc = -1;
  free(o.copy);
  return rc ? lag_app_io_error(s->app, a->out) : 0;
}

/* ---- Statistics */

enum { MOST_VALUES = 1 << 22 }; /* numbers in memory, if one measure has no more */

/* Values of some measures, n[k] of column + k. */
typedef struct Values {
  int column, count; /* of the first; their number */
  size_t room;       /* for each */
  double *value;
  size_t *n;
} Values;

static int take_values(void *values, long long run, const double *row) {
  Values *v = values;
  (void)run;
  for (int k = 0; k < v->count; k++)
    if (isfinite(row[v->column + k])) v->value[(size_t)k * v->room + v->n[k]++] = row[v->column + k];
  return 0;
}

/* Quantile by linear interpolation between order statistics: definition 7 of R. J. Hyndman, Y. Fan, The American
 * Statistician 50 (1996) 361. */
static double quantile(const double *sorted, long long n, double part) {
  double at = part * (double)(n - 1);
  long long i = (long long)at;
  return i + 1 < n ? sorted[i] + (at - (double)i) * (sorted[i + 1] - sorted[i]) : sorted[n - 1];
}

static Statistics statistics_of(double *value, long long n) {
  double sum = 0, squares = 0;
  Statistics t = {.n = n, .mean = NAN, .deviation = NAN, .least = NAN, .most = NAN, .quantile = {NAN, NAN, NAN}};
  if (n == 0) return t;
  qsort(value, (size_t)n, sizeof *value, lag_ascending);
  for (long long i = 0; i < n; i++) sum += value[i];
  t.mean = sum / (double)n;
  for (long long i = 0; i < n; i++) squares += (value[i] - t.mean) * (value[i] - t.mean);
  if (n > 1) t.deviation = sqrt(squares / (double)(n - 1));
  t.least = value[0];
  t.most = value[n - 1];
  for (int k = 0; k < 3; k++) t.quantile[k] = quantile(value, n, parts[k]);
  return t;
}

/* t[nmeasures]. The rows are read once for as many measures as the memory holds. */
static int all_statistics(SweepApp *s, Statistics *t) {
  size_t runs = (size_t)s->plan.runs, held = runs < MOST_VALUES ? MOST_VALUES / (runs + 1) + 1 : 1;
  int all = s->sweep.nmeasures, most = held < (size_t)all ? (int)held : all;
  Values v = {.room = runs, .value = malloc(runs * (size_t)most * sizeof(double) + 1)};
  int rc = v.value ? 0 : -1;
  for (int from = 0; from < all && rc == 0; from += v.count) {
    v.column = s->plan.n + from;
    v.count = all - from < most ? all - from : most;
    v.n = calloc((size_t)v.count, sizeof *v.n);
    rc = v.n ? lag_sweep_each_row(s, take_values, &v) : -1;
    for (int k = 0; k < v.count && rc == 0; k++)
      t[from + k] = statistics_of(v.value + (size_t)k * v.room, (long long)v.n[k]);
    free(v.n);
  }
  free(v.value);
  return rc;
}

/* ---- Failures, and runs whose measures have no value */

enum { MOST_KINDS = 20 };

/* Runs of one kind: how many, and the first. */
typedef struct Lacking {
  long long n, first;
} Lacking;

typedef struct Failures {
  const SweepApp *s;
  Lacking failed[MOST_KINDS]; /* by the word of the status */
  Lacking *none;              /* [nmeasures] runs that did not fail */
} Failures;

static void count(Lacking *l, long long run) {
  if (l->n++ == 0) l->first = run;
}

static int count_failure(void *failures, long long run, const double *row) {
  Failures *f = failures;
  const SweepApp *s = f->s;
  int status = (int)row[s->table.ncols - 1], kind = (int)word_of(status);
  if (status < 0 && kind < MOST_KINDS) count(&f->failed[kind], run);
  for (int k = 0; k < s->sweep.nmeasures && status >= 0; k++)
    if (isnan(row[s->plan.n + k])) count(&f->none[k], run);
  return 0;
}

/* why[size] := the message of a run, or why its measure k has no value, by making it again. Returns why. */
static const char *reason_of(SweepApp *s, long long run, int k, char *why, size_t size) {
  double *row = malloc((size_t)lag_sweep_columns(&s->sweep) * sizeof *row);
  snprintf(why, size, "%s", "");
  if (row) lag_sweep_run_one(&s->sweep, run, k, row, why, size);
  free(row);
  return why;
}

/* "12 failed, the first in row 3 (h=2): " and the reason. */
static void print_lacking(SweepApp *s, FILE *f, const Lacking *l, const char *what, int k) {
  double *value = l->n ? malloc((size_t)s->plan.n * sizeof *value) : NULL;
  char why[600];
  if (!value) return;
  lag_plan_values(&s->plan, l->first, value);
  fprintf(f, "%lld %s, the first in row %lld (", l->n, what, l->first + 1);
  for (int i = 0; i < s->plan.n; i++)
    fprintf(f, "%s%s=%s", i ? " " : "", s->plan.factor[i].name, lag_number_text(value[i], (char[64]){0}));
  fprintf(f, "): %s\n", reason_of(s, l->first, k, why, sizeof why));
  free(value);
}

/* ---- Report */

static const char *runs_text(long long n, char text[40]) {
  snprintf(text, 40, "%lld run%s", n, n == 1 ? "" : "s");
  return text;
}

static void print_text(SweepApp *s, FILE *f, const Statistics *t, const Failures *bad, long long failed) {
  const Args *a = &s->app->args;
  char method[256], label[sizeof(Column) + 4], processes[60] = "", runs[40];
  lag_report_method(s->app, method, sizeof method);
  if (s->sweep.nranks > 1) snprintf(processes, sizeof processes, " of each of %d processes", s->sweep.nranks);
  fprintf(f, "model %s, scene %s, method %s: %s to t = %s s, %lld failed\n", s->app->program->name, s->app->scene->name,
          method, runs_text(s->plan.runs, runs), lag_number_text(s->sweep.until, (char[64]){0}), failed);
  if (s->made) {
    fprintf(f, "%s in %.3g s, %.3g a second on %d thread%s%s", runs_text(s->made, runs), s->seconds,
            (double)s->made / s->seconds, s->sweep.threads, s->sweep.threads == 1 ? "" : "s", processes);
    if (s->variants[0].lanes.kernel) fprintf(f, ", %d at once in lanes\n", s->variants[0].lanes.lanes);
    else fprintf(f, "%s%s\n", s->no_lanes ? ", one by one, " : "", s->no_lanes ? s->no_lanes : "");
  }
  fprintf(f, "\n  %-28s %8s %12s %12s %12s %12s %12s %12s %12s\n", "", "runs", "mean", "deviation", "least", "5 %",
          "50 %", "95 %", "largest");
  for (int k = 0; k < s->sweep.nmeasures; k++)
    fprintf(f, "  %-28s %8lld %12.6g %12.6g %12.6g %12.6g %12.6g %12.6g %12.6g\n",
            lag_column_label(&s->table.cols[s->plan.n + k], label, sizeof label), t[k].n, t[k].mean, t[k].deviation,
            t[k].least, t[k].quantile[0], t[k].quantile[1], t[k].quantile[2], t[k].most);
  for (int k = 0; k < MOST_KINDS; k++) print_lacking(s, f, &bad->failed[k], "failed", 0);
  for (int k = 0; k < s->sweep.nmeasures; k++) {
    snprintf(label, sizeof label, "%s no %s", bad->none[k].n == 1 ? "has" : "have", s->app->measure_names[k]);
    print_lacking(s, f, &bad->none[k], label, k);
  }
  if (a->out) fprintf(f, "%s has a row a run\n", a->out);
  if (a->motions) fprintf(f, "%s has the motions, up to %d rows a run\n", a->motions, s->sweep.nrows + !a->section);
  if (s->full)
    fprintf(f, "%s crosse%s the section more than %d times: --crossings N keeps more\n", runs_text(s->full, runs),
            s->full == 1 ? "s" : "", s->sweep.nrows);
}

static void print_json(SweepApp *s, const Statistics *t, const Failures *bad, long long failed) {
  Json j = lag_report_json_open(s->app, stdout);
  char why[600];
  lag_json_counts(&j, {"runs", s->plan.runs}, {"failed", failed});
  lag_json_numbers(&j, {"until", s->sweep.until}, {"seconds", s->seconds});
  lag_json_counts(&j, {"threads", s->sweep.threads}, {"lanes", s->variants[0].lanes.lanes},
                      {"processes", s->sweep.nranks});
  JSON_EACH(&j, "measures", '{', k, s->sweep.nmeasures) {
    lag_json_begin(&j, s->app->measure_names[k], '{');
    lag_json_string(&j, "unit", s->table.cols[s->plan.n + k].unit);
    lag_json_count(&j, "runs", t[k].n);
    lag_json_numbers(&j, {"mean", t[k].mean}, {"deviation", t[k].deviation}, {"least", t[k].least},
                         {"q5", t[k].quantile[0]}, {"q50", t[k].quantile[1]}, {"q95", t[k].quantile[2]},
                         {"largest", t[k].most});
    lag_json_count(&j, "none", bad->none[k].n);
    lag_json_string(&j, "none_why", bad->none[k].n ? reason_of(s, bad->none[k].first, k, why, sizeof why) : NULL);
    lag_json_end(&j, '}');
  }
  JSON_EACH(&j, "failures", '{', k, MOST_KINDS)
    if (bad->failed[k].n) lag_json_count(&j, s->table.cols[s->table.ncols - 1].words[k], bad->failed[k].n);
  lag_json_close(&j);
}

int lag_sweep_report(SweepApp *s) {
  const Args *a = &s->app->args;
  Failures bad = {.s = s, .none = calloc((size_t)s->sweep.nmeasures + 1, sizeof *bad.none)};
  Statistics *t = calloc((size_t)s->sweep.nmeasures + 1, sizeof *t);
  long long failed = 0;
  int rc = !t || !bad.none                        ? lag_app_error(a, "out of memory")
           : !a->out                              ? 0
           : lag_outfile_has_suffix(a->out, "h5") ? lag_sweep_write_arrays(s)
                                                  : write_rows(s);
  rc = rc ? rc : lag_sweep_picture(s);
  rc = rc ? rc : lag_sweep_motions_write(s);
  if (rc == 0) {
    int lost = lag_sweep_each_row(s, count_failure, &bad);
    lost = lost ? lost : all_statistics(s, t);
    for (int k = 0; k < MOST_KINDS; k++) failed += bad.failed[k].n;
    if (lost) rc = lag_app_error(a, "out of memory for the statistics; the rows are written");
    else if (a->json) print_json(s, t, &bad, failed);
    else if (!a->quiet) print_text(s, a->out && strcmp(a->out, "-") == 0 ? stderr : stdout, t, &bad, failed);
  }
  lag_free_all(bad.none, t);
  return rc;
}

int lag_sweep_report_part(SweepApp *s) {
  const Args *a = &s->app->args;
  if (a->json) {
    Json j = lag_report_json_open(s->app, stdout);
    lag_json_count(&j, "runs", s->plan.runs);
    lag_json_strings(&j, {"part", a->shard}, {"journal", s->journal.path});
    lag_json_count(&j, "made", s->made);
    lag_json_number(&j, "seconds", s->seconds);
    lag_json_count(&j, "threads", s->sweep.threads);
    lag_json_close(&j);
  } else if (!a->quiet) {
    printf("%s has the runs of part %s; when all are there, --merge %lld in place of --shard writes the rows\n",
           s->journal.path, a->shard, s->sweep.shards);
  }
  return EXIT_FINE;
}
