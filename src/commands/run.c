/* `lagc run`, `plot`, `animate`, `modes`, `lyapunov`, `cost`: the simulator in the cache, started with what the
 * command line says. */
#include "commands/commands.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "commands/budget.h"
#include "commands/command_table.h"
#include "commands/cost_reference.h"
#include "commands/known_run.h"
#include "commands/simulator.h"

static double seconds_now(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9*(double)now.tv_nsec;
}

/* Makes the simulator of `lagc cost`, beside it the reference where three fifths of the time, or five seconds,
 * suffice, and tells it how much is left: at least a third. */
static int make_cost_simulator(Compiler *c, const Units *units, double begin, const char **path) {
  enum { LEAST_WAIT = 5 };
  double asked = c->o.seconds ? strtod(c->o.seconds, NULL) : 10;
  CostReference reference;
  cost_reference_begin(c, 0.4*asked, &reference);
  int status = simulator_of_units(c, units, NULL, path),
      given = cost_reference_end(&reference, fmax(0.6 * asked - (seconds_now() - begin), LEAST_WAIT));
  double left = asked - (seconds_now() - begin);
  c->picture.argv.n--; /* the NULL at the end */
  vec_push(c->arena, &c->picture.argv, arena_strdup(c->arena, "--seconds"));
  vec_push(c->arena, &c->picture.argv,
           !(asked > 0) ? arena_strdup(c->arena, c->o.seconds)
                        : arena_printf(c->arena, "%.3g", left > asked / 3 ? left : asked / 3));
  if (c->given_words[0]) {
    vec_push(c->arena, &c->picture.argv, arena_strdup(c->arena, "--given"));
    vec_push(c->arena, &c->picture.argv, arena_strdup(c->arena, c->given_words));
  }
  if (given) {
    vec_push(c->arena, &c->picture.argv, arena_strdup(c->arena, "--against"));
    vec_push(c->arena, &c->picture.argv, arena_strdup(c->arena, "-"));
  }
  vec_push(c->arena, &c->picture.argv, NULL);
  return status;
}

/* run, plot, animate, modes, lyapunov, cost: builds the simulator and becomes it by exec. */
int command_run(Compiler *c) {
  const char *path;
  double begin = seconds_now();
  int status = simulator_prepare(c);
  if (status != STATUS_OK) return status;
  if (c->o.budget) return cost_budget(c);
  Units units = {0};
  if (!simulator_lower(c, &units)) return STATUS_MODEL;
  const char *evaluator = simulator_evaluator(c, &units, &status);
  if (status != STATUS_OK) return status;
  if (evaluator) {
    StrBuf bytes = simulator_bytes(c, &units);
    return known_run_evaluate(c, evaluator, &bytes);
  }
  status = c->o.command == CMD_COST ? make_cost_simulator(c, &units, begin, &path)
                                    : simulator_of_units(c, &units, NULL, &path);
  return status == STATUS_OK ? known_run_keep_and_start(c, path) : status;
}
