/* Outer planets over 10^4 years by wisdom_holman: times by scheme and step, with the watch on the energy at each step.
 *   planets SCHEME STEP ...: a row each; time: processor time, the least of nine runs. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include "lag.h"

extern const lag_scene outer_planets_years;
static const double at[] = {
#include "planets.h"
};
enum { RUNS = 9 };

static double run(const char *scheme, double step, double *error, double *forces)
{
  const lag_option options[] = {{"step", step, NULL}, {"scheme", 0, scheme}};
  lag_sim *sim = lag_sim_new(&outer_planets_years);
  lag_stats stats;
  if (lag_sim_set_method(sim, &lag_wisdom_holman, options, 2)) exit(1);
  const clock_t begin = clock();
  if (lag_sim_advance(sim, 3652500)) exit(1);
  const double took = (double)(clock() - begin)/CLOCKS_PER_SEC;
  *error = 0;
  for (int i = 0; i < 18; i++) *error = fmax(*error, fabs(lag_sim_q(sim)[i] - at[i]));
  lag_sim_stats(sim, &stats);
  *forces = (double)stats.rhs_calls;
  lag_sim_free(sim);
  return took;
}

int main(int argc, char **argv)
{
  for (int k = 1; k + 1 < argc; k += 2) {
    double best = HUGE_VAL, error, forces;
    for (int i = 0; i < RUNS; i++) best = fmin(best, run(argv[k], atof(argv[k + 1]), &error, &forces));
    printf("| %s | %s | %.1e | %.2f | %.0f |\n", argv[k], argv[k + 1], error, 1e3*best, forces);
  }
  return 0;
}
