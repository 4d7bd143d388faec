/* The report of a fit: values with errors, what data cannot tell apart, how well the motion fits, and a scene to paste.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/fit_residuals.h"
#include "app/fit_run.h"

/* A value with the digits that its error leaves, and two more; or so many where it is not determined. */
static void put_value(FILE *f, const FitTarget *t, int undetermined) {
  double digits = t->error > 0 && t->value != 0.0 ? ceil(log10(fabs(t->value) / t->error)) + 2 : undetermined;
  fprintf(f, "%.*g", (int)fmin(fmax(digits, 3), 15), t->value);
}

static void put_values(const Fit *f, FILE *out) {
  for (int j = 0; j < f->n; j++) {
    const FitTarget *t = &f->target[j];
    if (t->weight) continue;
    fprintf(out, "  %-14s ", t->label);
    put_value(out, t, f->trains ? 8 : 4);
    if (t->flat) fputs(" not determined", out);
    else if (!f->trains) fprintf(out, " +- %.2g", t->error);
    fprintf(out, "%s%s", t->unit[0] ? " " : "", t->unit);
    if (!isnan(t->low) && !isnan(t->high)) fprintf(out, ", 95 %% from %.6g to %.6g", t->low, t->high);
    if (t->prior_error > 0) fprintf(out, " (prior: %.6g +- %.2g)", t->prior, t->prior_error);
    putc('\n', out);
  }
}

/* ---- Directions that data do not feel */

/* The exponent of a quotient as a small fraction p/q. 0: it is none. */
static int small_fraction(double x, int *p, int *q) {
  for (*q = 1; *q <= 4; ++*q) {
    *p = (int)lround(x * *q);
    if (abs(*p) <= 8 && fabs(x * *q - *p) < 1e-4) return 1;
  }
  return 0;
}

static void put_power(FILE *out, const char *name, int p) {
  if (p == 1) fputs(name, out);
  else fprintf(out, "%s^%d", name, p);
}

/* "g/l", "k*m": the combination of name and pivot that is constant where both move by factors exp(v), exp(pivot's). */
static void put_combination(FILE *out, const char *name, double v, const char *pivot, double by) {
  int p, q;
  if (!small_fraction(v / by, &p, &q)) fprintf(out, "%s/%s^%.4g", name, pivot, v / by);
  else {
    put_power(out, name, q);
    putc(p > 0 ? '/' : '*', out);
    put_power(out, pivot, abs(p));
  }
}

static int count_of(const Fit *f, const FitDirection *d) {
  int n = 0;
  for (int j = 0; j < f->n; j++) n += d->change[j] != 0.0;
  return n;
}

/* "(g, l) along (9.81, 1)" */
static void put_direction(const Fit *f, const FitDirection *d, FILE *out) {
  double unit = 0; /* of shifts: the largest is 1 */
  for (int j = 0; j < f->n; j++) unit = fmax(unit, fabs(d->change[j] * f->target[j].scale));
  for (int values = 0; values < 2; values++) {
    int n = 0;
    fputs(values ? " along (" : "(", out);
    for (int j = 0; j < f->n; j++) {
      if (d->change[j] == 0.0) continue;
      if (n++) fputs(", ", out);
      if (values) fprintf(out, "%.3g", d->change[j] * f->target[j].scale / (d->shift ? unit : 1));
      else fputs(f->target[j].label, out);
    }
    putc(')', out);
  }
}

/* "only g/l: (g, l) along (9.81, 1) changes nothing" */
static void put_flat(const Fit *f, const FitDirection *d, FILE *out) {
  int pivot = 0, n = count_of(f, d), put = 0;
  while (d->change[pivot] == 0.0) pivot++;
  for (int j = 0; j < f->n; j++)
    if (d->change[j] != 0.0) pivot = j; /* the last one is the divisor */
  if (n == 1) {
    fprintf(out, "%s: no value of the data feels it", f->target[pivot].label);
    return;
  }
  for (int j = 0; j < pivot && (d->product || d->shift); j++) {
    if (d->change[j] == 0.0) continue;
    fputs(put++ ? ", " : "only ", out);
    double factor = d->change[j] * f->target[j].scale / (d->change[pivot] * f->target[pivot].scale);
    if (d->product) put_combination(out, f->target[j].label, d->change[j], f->target[pivot].label, d->change[pivot]);
    else if (fabs(fabs(factor) - 1) < 1e-4)
      fprintf(out, "%s %c %s", f->target[j].label, factor > 0 ? '-' : '+', f->target[pivot].label);
    else fprintf(out, "%s - %.4g*%s", f->target[j].label, factor, f->target[pivot].label);
  }
  if (put) fputs(": ", out);
  put_direction(f, d, out);
  fputs(put ? " changes nothing" : " changes nothing, near these values", out);
}

/* ---- How well the motion fits */

static void put_correlations(const Fit *f, FILE *out) {
  const double strong = 0.9;
  int n = 0;
  for (int i = 0; i < f->n; i++)
    for (int j = 0; j < i; j++)
      if (fabs(f->correlation[i * f->n + j]) > strong)
        fprintf(out, "%s%s with %s %.4f", n++ ? ", " : "correlated: ", f->target[j].label, f->target[i].label,
                f->correlation[i * f->n + j]);
  if (n) putc('\n', out);
}

static void put_columns(const FitRun *r, FILE *out) {
  const double unlikely = 0.01;
  const Fit *f = &r->fit;
  for (int c = 0; c < f->ncolumns; c++) {
    const FitColumn *k = &f->column[c];
    fprintf(out, "residuals of %s: %d values, rms %.3g%s\n  %d runs of one sign, %.1f +- %.1f expected: %s\n", k->label,
            k->n, k->rms, k->per_row || f->known_errors ? "" : ", taken as their error", k->runs, k->runs_expected,
            k->runs_deviation,
            k->exact                     ? "rounding"
            : k->runs_chance > unlikely    ? "no trend is left"
            : k->runs < k->runs_expected ? "a trend is left, which the model lacks"
                                         : "they swing from row to row");
  }
}

static void put_chi_squared(const FitRun *r, FILE *out) {
  const Fit *f = &r->fit;
  if (!f->known_errors || f->huber || !(f->freedom > 0)) return;
  double chance = f->by->chance_of_more(f->chi_squared, f->freedom);
  fprintf(out, "chi squared %.4g for %.0f degrees of freedom, p = %.2g%s\n", f->chi_squared, f->freedom, chance,
          chance < 0.001   ? ": the model or the errors are wrong"
          : chance > 0.999 ? ": the errors are too large"
                           : "");
}

/* The scenes to paste, one a record. */
static void put_scene(const FitRun *r, int record, FILE *out) {
  const Fit *f = &r->fit;
  fputs("scene fitted", out);
  if (r->nfiles > 1) fprintf(out, "_%d", record + 1);
  fprintf(out, " { like %s\n", r->app->scene->name);
  for (int j = 0; j < f->n; j++) {
    const FitTarget *t = &f->target[j];
    if (t->weight || (t->record && t->record != record + 1)) continue;
    fprintf(out, "  %s%s = ", t->is_start ? "start " : "", t->name);
    put_value(out, t, 8);
    if (t->unit[0]) fprintf(out, " [%s]", t->unit);
    putc('\n', out);
  }
  fputs("}\n", out);
}

static void put_weights(const FitRun *r, FILE *out) {
  const Fit *f = &r->fit;
  int n = 0;
  double largest = 0;
  for (int j = 0; j < f->n; j++)
    if (f->target[j].weight) n++, largest = fmax(largest, fabs(f->target[j].value));
  fprintf(out, "%d weights in %s, the largest %.3g; gradients by reverse mode\n", n, r->app->args.out, largest);
}

void lag_fit_report(const FitRun *r, FILE *out) {
  const Fit *f = &r->fit;
  lag_report_head(r->app, out);
  fprintf(out, "%s after %d steps, %d runs of the motion\n", f->converged ? "converged" : "not converged", f->steps,
          f->evaluations);
  if (f->nodes)
    fprintf(out,
            "multiple shooting: %d parts, which join within %.1e of the size of the state; where small changes grow a "
            "run of the scene departs from the record\n",
            f->nodes->n + f->nrecords, lag_fit_widest_gap(f));
  if (f->trains) put_weights(r, out);
  put_values(f, out);
  if (!f->converged && f->weakest.change) {
    fputs("flattest direction: ", out);
    put_direction(f, &f->weakest, out);
    fputs("; hold one of these, add a prior, or begin nearer\n", out);
  }
  for (int k = 0; k < f->nflat; k++) {
    fputs(k ? "  " : "cannot be told apart: ", out);
    put_flat(f, &f->flat[k], out);
    putc('\n', out);
  }
  if (!f->trains) put_correlations(f, out);
  put_chi_squared(r, out);
  put_columns(r, out);
  if (r->app->args.svg) fprintf(out, "picture in %s\n", r->app->args.svg);
  for (int k = 0; k < r->nfiles; k++) put_scene(r, k, out);
}

static void columns_json(const Fit *f, Json *j) {
  JSON_EACH(j, "columns", '{', c, f->ncolumns) {
    lag_json_begin(j, f->column[c].label, '{');
    lag_json_count(j, "values", f->column[c].n);
    lag_json_number(j, "rms", f->column[c].rms);
    lag_json_count(j, "runs", f->column[c].runs);
    lag_json_numbers(j, {"runs_expected", f->column[c].runs_expected}, {"runs_chance", f->column[c].runs_chance});
    lag_json_end(j, '}');
  }
}

void lag_fit_report_json(const FitRun *r, FILE *out) {
  const Fit *f = &r->fit;
  Json j = lag_app_json(r->app, out);
  lag_json_string(&j, "method", lag_sim_method(r->app->sim)->name);
  lag_json_truth(&j, "converged", f->converged);
  lag_json_counts(&j, {"steps", f->steps}, {"runs", f->evaluations},
                      {"segments", f->nodes ? f->nodes->n + f->nrecords : f->nrecords});
  if (f->nodes) lag_json_number(&j, "gap", lag_fit_widest_gap(f));
  for (int what = 0; what < 2; what++) {
    JSON_EACH(&j, what ? "errors" : "values", '{', i, f->n)
      lag_json_number(&j, f->target[i].label, what ? f->target[i].error : f->target[i].value);
  }
  for (int what = 0; what < 2 && r->app->args.profile; what++) {
    JSON_EACH(&j, what ? "high" : "low", '{', i, f->n)
      lag_json_number(&j, f->target[i].label, what ? f->target[i].high : f->target[i].low);
  }
  if (!f->trains) lag_json_matrix(&j, "correlations", f->n, f->n, f->correlation);
  JSON_OBJECTS(&j, "flat", k, f->nflat) {
    for (int i = 0; i < f->n; i++)
      if (f->flat[k].change[i] != 0.0)
        lag_json_number(&j, f->target[i].label, f->flat[k].change[i] * f->target[i].scale);
  }
  lag_json_row(&j, "singular_values", f->trains ? 0 : f->n, f->singular);
  lag_json_numbers(&j, {"chi_squared", f->chi_squared}, {"freedom", f->freedom});
  columns_json(f, &j);
  lag_json_close(&j);
}
