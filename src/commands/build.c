/* `lagc build`: a simulator as a program of its own, or a shared library. */
#include "commands/commands.h"

#include "commands/simulator.h"
#include "toolchain/outfile.h" /* generated: a copy of runtime/io/outfile.h */

/* The program for liblag's evaluator. */
static int build_bytes(Compiler *c) {
  Units units = {0};
  if (options_more_digits(&c->o) || c->o.shared) return usage_error("--bytes are evaluated in doubles: give it alone");
  if (!c->o.output) return usage_error("`lagc build --bytes` needs -o FILE");
  if (!simulator_lower(c, &units)) return STATUS_MODEL;
  StrBuf bytes = simulator_bytes(c, &units);
  return compiler_write(c, c->o.output, &bytes);
}

int command_build(Compiler *c) {
  if (!compiler_knows_method(c)) return STATUS_USAGE;
  if (c->o.bytes) return build_bytes(c);
  const char *path;
  Units units = {0};
  int is_so = c->o.output && lag_outfile_has_suffix(c->o.output, "so");
  if (!c->o.output && !c->o.shared) return usage_error("`lagc build` needs -o SIMULATOR");
  if (is_so && !c->o.shared)
    return usage_error("build writes a program: write -o SIMULATOR, or --shared for a library");
  if (c->o.output && !is_so && c->o.shared) return usage_error("--shared writes a library: write -o libNAME.so");
  if (c->o.lanes && !c->o.shared)
    return usage_error("--lanes are for batches of a library: add --shared; `lagc sweep` has its own");
  if (c->o.shared && options_more_digits(&c->o))
    return usage_error("a shared library has doubles: leave --precision out");
  int status = simulator_lower(c, &units) ? simulator_of_units(c, &units, c->o.output, &path) : STATUS_MODEL;
  if (status != STATUS_OK || c->o.output) return status;
  StrBuf b = strbuf(c->arena);
  sb_printf(&b, "%s\n", path);
  return compiler_write(c, NULL, &b);
}
