/* `lagc fmu`: the model as a Functional Mock-up Unit, for tools that import FMI. */
#include "commands/commands.h"

#include <string.h>

#include "fmu/fmu_archive.h"
#include "report/equation_listing.h"
#include "toolchain/toolchain.h"

typedef VEC(FmuBinary) FmuBinaries;

/* The binary by $CC, and those by the compilers of --also-cc. Returns 0, with *error. */
static int make_binaries(Compiler *c, const Fmu *f, FmuBinaries *all, const char **error) {
  Arena *a = c->arena;
  const SourceText texts[] = {{"model.h", f->header}, {"fmu.c", f->wrapper}};
  Toolchain tools;
  VEC(const char *) compilers = {0};
  if (!toolchain_compiler(a, &tools, error)) return 0;
  vec_push(a, &compilers, tools.cc);
  for (char *w = strtok(arena_strdup(a, c->o.also_cc ? c->o.also_cc : ""), ","); w; w = strtok(NULL, ","))
    vec_push(a, &compilers, w);
  tools.soname = arena_printf(a, "%s.so", f->identifier);
  for (uint32_t i = 0; i < compilers.n; i++) {
    FmuBinary one = {.library = strbuf(a)};
    tools.cc = compilers.at[i];
    if (!toolchain_library(a, &tools, texts, 2, &one.library, error)) return 0;
    one.machine = toolchain_machine(a, &tools);
    vec_push(a, all, one);
  }
  return 1;
}

int command_fmu(Compiler *c) {
  const char *error = NULL;
  Fmu f;
  FmuBinaries binaries = {0};
  if (!c->o.output) return usage_error("`lagc fmu` needs -o FILE.fmu");
  Eqns *e = compiler_derive_scene(c, c->o.scene);
  ProgramSet *u = e ? compiler_lower_embedded(c, e) : NULL;
  if (!u) return STATUS_MODEL;
  StrBuf equations = strbuf(c->arena), archive = strbuf(c->arena);
  show_equations(e, "", PRINT_TEXT, &equations);
  if (!fmu_make(u, c->o.fmi && strcmp(c->o.fmi, "3") == 0 ? 3 : 2, sb_text(&equations), &f, &error))
    return usage_error(error);
  if (compiler_is_source(c, c->o.output)) return STATUS_USAGE;
  if (!make_binaries(c, &f, &binaries, &error) || !fmu_pack(&f, binaries.at, binaries.n, &archive, &error))
    return usage_error(error);
  return compiler_write(c, c->o.output, &archive);
}
