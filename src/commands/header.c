/* `lagc header`: the model as a header that depends on nothing. */
#include "commands/commands.h"

#include <string.h>

#include "emit/emit_model.h"
#include "report/equation_listing.h"
#include "toolchain/files.h"

/* The prefix of a header's names: its file's (pend.h: PEND_IMPLEMENTATION), on standard output the model's. */
static const char *header_name(Compiler *c, const char *model) {
  const char *path = c->o.output;
  if (!path || strcmp(path, "-") == 0) return model;
  const char *stem = file_name(path), *dot = strchr(stem + (stem[0] == '.'), '.');
  return dot ? arena_strndup(c->arena, stem, (size_t)(dot - stem)) : stem;
}

/* An identifier that C and C++ do not reserve. */
static int is_prefix(const char *s) {
  size_t n = strspn(s, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_");
  return s[n] == '\0' && n > 0 && s[0] != '_' && (s[0] < '0' || s[0] > '9') && !strstr(s, "__") && s[n - 1] != '_';
}

int command_header(Compiler *c) {
  if (c->o.prefix && !is_prefix(c->o.prefix))
    return usage_error(arena_printf(
        c->arena,
        "--prefix %s is no name for C and C++: letters, digits and single `_` between them, as in `pend` or `arm_2`",
        c->o.prefix));
  Eqns *e = compiler_derive_scene(c, c->o.scene);
  if (!e) return STATUS_MODEL;
  Name conditional = model_conditional(e->m);
  if (conditional)
    return usage_error(
        arena_printf(c->arena,
                     "a header has no constraints with `while` (%s), whose impulses and times take a run of events: "
                     "`lagc build --shared` makes a library that has them",
                     conditional));
  ProgramSet *u = compiler_lower_embedded(c, e);
  if (!u) return STATUS_MODEL;
  HeaderParts parts = {.prefix = c->o.prefix};
  const char *error;
  if (!header_parts(u, c->o.with, &parts, &error) || !header_parts(u, c->o.target, &parts, &error))
    return usage_error(error);
  if (u->contact_laws && !header_parts(u, "moreau", &parts, &error))
    return usage_error(arena_printf(
        c->arena,
        "%s, and contacts and guides with friction need it: `lagc build --shared` makes a library that follows them",
        error));
  StrBuf equations = strbuf(c->arena), out = strbuf(c->arena);
  show_equations(e, "", PRINT_TEXT, &equations);
  emit_header(u, header_name(c, u->name), parts, sb_text(&equations), &out);
  return compiler_write_c(c, c->o.output, &out);
}
