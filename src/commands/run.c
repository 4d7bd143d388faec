/* `lagc run`, `plot`, `animate`, `modes`, `lyapunov`, `cost`: the simulator in the cache, started with what the
 * command line says. */
#include "commands/commands.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "commands/budget.h"
#include "commands/command_table.h"
#include "commands/cost_reference.h"
#include "commands/simulator.h"
#include "self_check/self_check.h"
#include "toolchain/process.h"

enum { LARGE = 1000 }; /* coordinates, beyond which the compiler's memory is not kept during the run */

/* Whether an output of the simulator would overwrite a file of the model. */
static int writes_source(Compiler *c) {
  for (char *const *a = c->picture.argv.at; *a; a++) {
    const char *eq = strncmp(*a, "--", 2) == 0 ? strchr(*a, '=') : NULL;
    if (compiler_is_source(c, eq ? eq + 1 : *a)) return 1;
  }
  return 0;
}

/* After a run that lacked a finite value: reports the expression of the text that has none. */
static void tell_last_state(void *compiler, const double *number, uint32_t n) {
  Compiler *c = compiler;
  c->diags->list.n = 0; /* they have been printed */
  if (nonfinite_note(c->run, c->run_by, number, n)) compiler_print_messages(c);
}

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
  if (writes_source(c)) return STATUS_USAGE;
  status = simulator_evaluate(c, &units, &path);
  if (status != STATUS_OK) return status;
  if (!path)
    status = c->o.command == CMD_COST ? make_cost_simulator(c, &units, begin, &path)
                                      : simulator_of_units(c, &units, NULL, &path);
  if (status != STATUS_OK) return status;
  fflush(stdout);
  if (!simulator_is_later_rank(c)) compiler_print_messages(c); /* warnings: the simulator does not come back */
  if (c->picture.note) fprintf(stderr, "%s\n", c->picture.note);
  if (c->run && c->run->n <= LARGE && c->o.command != CMD_SWEEP) last_state_listen(c->arena, tell_last_state, c);
  process_become(path, c->picture.argv.at);
  const char *why = strerror(errno);
  return usage_error(
      arena_printf(c->arena, "cannot run %s: %s; set XDG_CACHE_HOME to a folder where programs may run", path, why));
}
