/* `lagc build`: a simulator as a program of its own. */
#include "commands/commands.h"
#include "commands/simulator.h"

int command_build(Compiler *c) {
  if (!compiler_knows_method(c)) return STATUS_USAGE;
  const char *path;
  Units units = {0};
  if (!c->o.output) return usage_error("`lagc build` needs -o SIMULATOR");
  return simulator_lower(c, &units) ? simulator_of_units(c, &units, c->o.output, &path) : STATUS_MODEL;
}
