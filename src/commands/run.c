/* `lagc run`, `plot`, `animate`, `modes`, `lyapunov`, `cost`: the simulator in the cache, started with what the command line says. */
#include "commands/commands.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "commands/command_table.h"
#include "commands/simulator.h"
#include "jets/self_check.h"
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

/* After a run that ended for want of a finite value: reports the expression of the text that has none. */
static void tell_last_state(void *compiler, const double *number, uint32_t n) {
  Compiler *c = compiler;
  c->diags->list.n = 0; /* they have been printed */
  if (nonfinite_note(c->run, c->run_by, number, n)) compiler_print_messages(c);
}

/* lagc cost: a simulator in quadruple precision computes the reference solution, which the simulator reads from its standard input. On
 * failure the simulator computes a reference of its own. */
static void give_reference(Compiler *c, const Units *units) {
  VEC(char *) argv = {0};
  const char *path = c->picture.argv.n > 1 ? simulator_precise(c, units) : NULL;
  if (!path) return;
  vec_push(c->arena, &argv, c->picture.argv.at[0]);
  vec_push(c->arena, &argv, arena_strdup(c->arena, "--reference"));
  for (uint32_t i = 0; i < c->o.rest.n; i++) {
    const char *word = c->o.rest.at[i];
    int until = strncmp(word, "--until", 7) == 0, alone = until && !word[7];
    if (strcmp(word, "--against") == 0 || strncmp(word, "--against=", 10) == 0) return; /* the user gave a reference */
    if (word[0] == '-' && !until) i += (uint32_t)option_takes_next(c->o.command, word);
    else vec_push(c->arena, &argv, arena_strdup(c->arena, word));
    if (alone && i + 1 < c->o.rest.n) vec_push(c->arena, &argv, arena_strdup(c->arena, c->o.rest.at[++i]));
  }
  vec_push(c->arena, &argv, NULL);
  if (process_to_stdin(path, argv.at) != 0) return;
  c->picture.argv.n--; /* the NULL at the end */
  vec_push(c->arena, &c->picture.argv, arena_strdup(c->arena, "--against"));
  vec_push(c->arena, &c->picture.argv, arena_strdup(c->arena, "-"));
  vec_push(c->arena, &c->picture.argv, NULL);
}

/* run, plot, animate, modes, lyapunov, cost: builds the simulator and becomes it by exec. */
int command_run(Compiler *c) {
  const char *path;
  int status = simulator_prepare(c);
  if (status != STATUS_OK) return status;
  Units units = {0};
  status = simulator_lower(c, &units) ? simulator_of_units(c, &units, NULL, &path) : STATUS_MODEL;
  if (status != STATUS_OK) return status;
  if (writes_source(c)) return STATUS_USAGE;
  if (c->o.command == CMD_COST) give_reference(c, &units);
  fflush(stdout);
  compiler_print_messages(c); /* warnings: the simulator does not come back */
  if (c->picture.note) fprintf(stderr, "%s\n", c->picture.note);
  if (c->run && c->run->n <= LARGE) last_state_listen(c->arena, tell_last_state, c);
  execv(path, c->picture.argv.at);
  return usage_error(arena_printf(c->arena, "cannot run %s; delete it, and it is built anew", path));
}
