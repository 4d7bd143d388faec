/* The reference of `lagc cost`, computed with more digits. */
#include "commands/cost.h"
#include "toolchain/process.h"

#include <string.h>

/* lagc cost: a simulator in quadruple precision computes the reference solution, which the simulator reads from its standard input. On
 * failure the simulator computes a reference of its own. */
void cost_give_reference(Compiler *c, const Units *units) {
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
