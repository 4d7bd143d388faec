/* A fit of several scenes to the same data: which effects do the data call for. Enters: scenes with other effects;
 * leaves: how well each fits for the number of values it takes, by Akaike's and the Bayesian criterion, and an F test
 * against the scene with the fewest. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/fit_run.h"

typedef struct Judged {
  const char *scene;
  int n, values, converged;
  double misfit, aic, bic; /* -2 ln(likelihood) but for a constant */
  double chance;           /* of an improvement on the simplest scene as large by chance; NaN: that scene itself */
} Judged;

static void judge(const FitRun *r, Judged *j) {
  const Fit *f = &r->fit;
  j->scene = r->app->scene->name;
  j->n = f->n - f->nflat;
  j->values = f->nvalues;
  j->converged = f->converged;
  j->misfit = f->known_errors ? f->chi_squared : 0;
  for (int c = 0; c < f->ncolumns && !f->known_errors; c++)
    j->misfit += f->column[c].n * log(f->column[c].rms * f->column[c].rms);
  j->aic = j->misfit + 2 * j->n;
  j->bic = j->misfit + j->n * log(j->values);
}

/* Chance that the larger model gains so much where the simpler one is true: by chi squared where errors are known, else
 * by Fisher's F. */
static double chance_of(const lag_least_squares *by, int known, const Judged *simple, const Judged *j) {
  int more = j->n - simple->n, left = j->values - j->n;
  double gain = simple->misfit - j->misfit;
  if (more <= 0 || left <= 0) return NAN;
  if (!(gain > 0)) return 1;
  return known ? by->chance_of_more(gain, more) : by->chance_of_f(expm1(gain / j->values) * left / more, more, left);
}

static int by_bic(const void *a, const void *b) {
  double x = ((const Judged *)a)->bic, y = ((const Judged *)b)->bic;
  return (x > y) - (x < y);
}

/* The verdict of the data on one effect: the fit `j` beside that of the scene itself. Of few values BIC alone keeps
 * more than one wrong effect of twenty. */
static void put_effect(const Judged *scene, const Judged *j) {
  const double unlikely = 0.05;
  int without = strncmp(j->scene + strlen(scene->scene), " without ", 9) == 0;
  const char *effect = j->scene + strlen(scene->scene) + (without ? 9 : 6);
  double gain = without ? j->bic - scene->bic : scene->bic - j->bic; /* of the effect */
  printf("%-20s %12.4f %12.4f  ", effect, without ? j->aic - scene->aic : scene->aic - j->aic, gain);
  if (isnan(j->chance)) fputs("-", stdout);
  else printf("%-8.2g", j->chance);
  printf("  %s%s%s\n", gain > 0 && !(j->chance > unlikely) ? "called for" : "not called for",
         fabs(gain) < 2 ? ", by little" : "", j->converged && scene->converged ? "" : ", not converged");
}

static void put_effects(const Judged *all, int n) {
  printf("scene %s: misfit %.4f, AIC %.4f, BIC %.4f, %d values\n", all[0].scene, all[0].misfit, all[0].aic, all[0].bic,
         all[0].n);
  printf("%-20s %12s %12s  %s\n", "effect", "AIC gained", "BIC gained", "chance of such a gain without it");
  for (int i = 1; i < n; i++) put_effect(&all[0], &all[i]);
}

static void put_table(const Judged *all, int n, const char *simplest) {
  printf("%-20s %6s %12s %12s %12s  %s %s\n", "scene", "values", "misfit", "AIC", "BIC", "chance beside", simplest);
  for (int i = 0; i < n; i++) {
    const Judged *j = &all[i];
    printf("%-20s %6d %12.4f %12.4f %12.4f  ", j->scene, j->n, j->misfit, j->aic, j->bic);
    if (isnan(j->chance)) putchar('-');
    else printf("%.2g", j->chance);
    puts(j->converged ? "" : ", not converged");
  }
  if (n > 1)
    printf("the data call for %s: its BIC is lower by %.3g than that of %s%s\n", all[0].scene, all[1].bic - all[0].bic,
           all[1].scene, all[1].bic - all[0].bic < 2 ? ", which is little" : "");
}

static void put_json(const Judged *all, int n) {
  Json j = lag_json_open(stdout);
  JSON_OBJECTS(&j, "scenes", i, n) {
    lag_json_string(&j, "scene", all[i].scene);
    lag_json_count(&j, "values", all[i].n);
    lag_json_truth(&j, "converged", all[i].converged);
    lag_json_numbers(&j, {"misfit", all[i].misfit}, {"aic", all[i].aic}, {"bic", all[i].bic},
                         {"chance", all[i].chance});
  }
  lag_json_close(&j);
}

int lag_fit_compare(App *app) {
  int n = app->args.nscenes, rc = 0, known = 0, simplest = 0;
  Judged *all = calloc((size_t)n, sizeof *all);
  if (!all) return lag_app_error(&app->args, "out of memory");
  for (int i = 0; i < n && rc == 0; i++) {
    App one = lag_app_like(app);
    one.args.scene = app->args.scenes[i];
    FitRun r = {.app = &one, .compares = 1};
    rc = lag_fit_run(&r);
    if (rc == 0) judge(&r, &all[i]);
    known = r.fit.known_errors;
    if (all[i].n < all[simplest].n) simplest = i;
    lag_fit_run_free(&r);
    lag_app_free(&one);
  }
  const char *name = all[simplest].scene;
  int each = app->args.each_effect;
  for (int i = 0; i < n && rc == 0; i++) {
    const Judged *beside = &all[each ? 0 : simplest], *few = all[i].n < beside->n ? &all[i] : beside;
    all[i].chance = chance_of(app->extras.fits, known, few, few == beside ? &all[i] : beside);
  }
  if (!each) qsort(all, (size_t)n, sizeof *all, by_bic);
  if (rc == 0 && app->args.json) put_json(all, n);
  if (rc == 0 && !app->args.json && each) put_effects(all, n);
  if (rc == 0 && !app->args.json && !each) put_table(all, n, name);
  free(all);
  return rc;
}
