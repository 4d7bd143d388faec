/* `lagc cache`: what the cache holds, and --clear. */
#include "commands/commands.h"
#include "toolchain/simulator_cache.h"

int command_cache(Compiler *c) {
  StrBuf out = strbuf(c->arena);
  cache_remove_stale_builds(c->arena);
  if (c->o.clear) cache_clear(c->arena, &out);
  else cache_print(c->arena, &out);
  return compiler_write(c, NULL, &out);
}
