/* Runs the scenes of all_scenes and compares with known values: cases METHOD TOL ATOL FILE [MODEL | -MODEL], this model only
 * or all but this one, where a line of FILE is
 *   MODEL TIME OUTPUT VALUE TOLERANCE
 * in the order of time. Prints a line a model: ok or not ok, the largest error over its tolerance, steps. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lag.h"

extern const lag_scene *const all_scenes[];

typedef struct {
  char model[64], output[64];
  double t, value, allowed;
} Fact;

static int find_output(const lag_scene *s, const char *name) {
  for (int i = 0; i < s->nout; i++)
    if (strcmp(s->outputs[i].name, name) == 0) return i;
  return -1;
}

static const lag_method *find_method(const char *name) {
  for (int i = 0; i < lag_nmethods; i++)
    if (strcmp(lag_methods[i]->name, name) == 0) return lag_methods[i];
  return NULL;
}

/* The largest error of the facts of one model in units of what is allowed; NaN when the run failed. */
static double run(const lag_scene *s, const lag_method *method, double tol, double atol_, const Fact *facts, int n, lag_stats *stats) {
  lag_sim *sim = lag_sim_new(s);
  const lag_option opt = {"atol", atol_, NULL};
  double out[64], worst = 0;
  if (lag_sim_set_tolerance(sim, tol) || lag_sim_set_method(sim, method, &opt, 1)) worst = NAN;
  for (int i = 0; i < n && !isnan(worst); i++) {
    if (strcmp(facts[i].model, s->model->name) != 0) continue;
    int k = find_output(s, facts[i].output);
    if (k < 0 || lag_sim_advance(sim, facts[i].t) || lag_sim_outputs(sim, out)) worst = NAN;
    else worst = fmax(worst, fabs(out[k] - facts[i].value) / facts[i].allowed);
  }
  if (isnan(worst)) printf("# %s\n", lag_sim_message(sim));
  lag_sim_stats(sim, stats);
  lag_sim_free(sim);
  return worst;
}

int main(int argc, char **argv) {
  static Fact facts[2000];
  int n = 0, bad = 0, count = 0;
  if (argc < 5) return 2;
  const char *only = argc > 5 && argv[5][0] != '-' ? argv[5] : NULL, *not_this = argc > 5 && argv[5][0] == '-' ? argv[5] + 1 : NULL;
  FILE *f = fopen(argv[4], "r");
  while (f && n < 2000 && fscanf(f, "%63s %lf %63s %lf %lf", facts[n].model, &facts[n].t, facts[n].output, &facts[n].value, &facts[n].allowed) == 5) n++;
  if (f) fclose(f);
  for (int i = 0; all_scenes[i]; i++) {
    lag_stats stats;
    const char *name = all_scenes[i]->model->name;
    if ((only && strcmp(only, name) != 0) || (not_this && strcmp(not_this, name) == 0)) continue;
    double worst = run(all_scenes[i], find_method(argv[1]), atof(argv[2]), atof(argv[3]), facts, n, &stats);
    int ok = worst <= 1;
    printf("%sok %d - %s by %s: error over what is allowed %.2g, %lld steps, %lld rejected\n", ok ? "" : "not ", ++count, name,
           argv[1], worst, stats.steps, stats.rejected);
    bad |= !ok;
  }
  printf("1..%d\n", count);
  return bad;
}
