/* Runs the scenes of all_scenes and compares with known values: cases METHOD TOL ATOL FILE [MODEL | -MODEL | digits], this
 * model only or all but this one, where a line of FILE is
 *   MODEL TIME OUTPUT VALUE TOLERANCE
 * in the order of time. digits: what is allowed is a unit in the last digit of VALUE, or 1e-18 of TOLERANCE where that is more, as numbers
 * of 34 digits are to those of 16. Prints a line a model: ok or not
 * ok, the largest error over its tolerance, steps. For other precisions it goes through runtime/precision.awk. */
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

/* Starts and parameters with more digits than lagc keeps of a number in a model. */
static const struct {
  const char *model, *name;
  double value;
} starts[] = {
  {"arenstorf1", "y'", -2.00158510637908252240537862224},
  {"cr3bp_l1_departure", "x", 0.8369161257723573513650754},
  {"lagrange_top_slow", "f'", 0.367826846322586348126209587409},
  {"lagrange_top_slow", "s'", 5.71867051031667766935783785543},
  {"lagrange_top_fast", "f'", 3.55455093287819526149780891851},
  {"lagrange_top_fast", "s'", 3.28132948968332233064216214457},
  {"three_body_figure_eight", "v1", 0.347116888118926938242776920320},
  {"three_body_figure_eight", "v2", 0.532724945388030229262027987692},
};

/* One unit in the last digit of a decimal. */
static double last_digit(const char *text) {
  double unit = 1;
  const char *e = strpbrk(text, "eE"), *point = strchr(text, '.');
  for (const char *c = point ? point + 1 : text; point && *c && c != e; c++) unit /= 10;
  for (int k = e ? atoi(e + 1) : 0; k != 0; k += k < 0 ? 1 : -1) unit = k < 0 ? unit / 10 : unit * 10;
  return unit;
}

static int read_fact(FILE *f, int digits, Fact *fact) {
  char t[64], value[64], allowed[64];
  if (fscanf(f, "%63s %63s %63s %63s %63s", fact->model, t, fact->output, value, allowed) != 5) return 0;
  fact->t = strtod(t, NULL);
  fact->value = strtod(value, NULL);
  fact->allowed = digits ? fmax(last_digit(value), 1e-18 * strtod(allowed, NULL)) : strtod(allowed, NULL);
  return 1;
}

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
  for (size_t i = 0; i < sizeof starts / sizeof *starts; i++)
    if (strcmp(starts[i].model, s->model->name) == 0 && lag_sim_set(sim, starts[i].name, starts[i].value)) worst = NAN;
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
  int digits = argc > 5 && strcmp(argv[5], "digits") == 0;
  const char *only = argc > 5 && argv[5][0] != '-' && !digits ? argv[5] : NULL, *not_this = argc > 5 && argv[5][0] == '-' ? argv[5] + 1 : NULL;
  FILE *f = fopen(argv[4], "r");
  while (f && n < 2000 && read_fact(f, digits, &facts[n])) n++;
  if (f) fclose(f);
  for (int i = 0; all_scenes[i]; i++) {
    lag_stats stats;
    const char *name = all_scenes[i]->model->name;
    if ((only && strcmp(only, name) != 0) || (not_this && strcmp(not_this, name) == 0)) continue;
    double worst = run(all_scenes[i], find_method(argv[1]), strtod(argv[2], NULL), strtod(argv[3], NULL), facts, n, &stats);
    int ok = worst <= 1;
    printf("%sok %d - %s by %s: error over what is allowed %.2g, %lld steps, %lld rejected\n", ok ? "" : "not ", ++count, name,
           argv[1], worst, stats.steps, stats.rejected);
    bad |= !ok;
  }
  printf("1..%d\n", count);
  return bad;
}
