/* What the commands share: files, messages, equations of a scene, programs. */
#include "compiler.h"

#include <stdio.h>
#include <string.h>

#include "base/diag.h"
#include "cli/files.h"
#include "emit/cnames.h"
#include "emit/emit_model.h"
#include "ir/lower.h"
#include "mech/show.h"

void compiler_messages(const Compiler *c) {
  StrBuf messages = strbuf(c->arena);
  diags_print(c->diags, &messages);
  fputs(sb_text(&messages), stderr);
}

int fail_usage(const char *message) {
  fprintf(stderr, "lagc: %s\n", message);
  return STATUS_USAGE;
}

int compiler_dumps(const Compiler *c, const char *stage) {
  const char *at = c->o.dump ? strstr(c->o.dump, stage) : NULL;
  size_t n = strlen(stage);
  return at && (at == c->o.dump || at[-1] == ',') && (at[n] == ',' || at[n] == '\0');
}

/* A mistyped output must not cost the model, nor a file that it is made of: includes, tables. */
int compiler_reads(Compiler *c, const char *path) {
  for (uint32_t i = 0; i < c->sources->files.n; i++) {
    if (!file_same(path, c->sources->files.at[i].path)) continue;
    const char *what = i == 0 ? "the model" : "a part of the model";
    fail_usage(arena_printf(c->arena, "%s would be overwritten: it is %s; write to another file", path, what));
    return 1;
  }
  return 0;
}

int compiler_write(Compiler *c, const char *path, const StrBuf *text) {
  const char *why;
  if (path && c->sources && compiler_reads(c, path)) return STATUS_USAGE;
  if (file_write(c->arena, path ? path : "-", sb_text(text), text->n, &why)) return STATUS_OK;
  return fail_usage(arena_printf(c->arena, "cannot write %s: %s", path ? path : "standard output", why));
}

Eqns *compiler_derive(Compiler *c, const ModelChoice *choice) {
  ModelChoice with_defines = *choice;
  with_defines.defines = c->o.defines.at;
  with_defines.ndefines = c->o.defines.n;
  if (!choice->bare && !choice->unfixed) with_defines.fix = c->o.fix;
  Model *m = model_build(c->ast, &with_defines);
  if (!m) return NULL;
  StrBuf listing = strbuf(c->arena);
  if (compiler_dumps(c, "model")) model_dump(m, &listing);
  Eqns *e = eqns_derive(m);
  if (e && compiler_dumps(c, "eqns")) dump_equations(e, &listing);
  if (listing.n) compiler_write(c, NULL, &listing);
  return e;
}

IrUnit *compiler_unit(Compiler *c, Eqns *e) {
  return unit_new(e, c->o.file, c->o.math && strcmp(c->o.math, "libm") == 0);
}

int compiler_prepare(Compiler *c) {
  const char *error = NULL;
  if (c->o.scene && !model_has_scene(c->ast, c->o.scene)) return STATUS_MODEL;
  if (!settings_compiled(c->ast, &c->o, &c->given, &error)) return error ? fail_usage(error) : STATUS_MODEL;
  if (!settings_units(c->ast, &c->o)) return STATUS_USAGE;
  if (!picture_prepare(&c->picture, c->ast, &c->o, &error)) return error ? fail_usage(error) : STATUS_MODEL;
  return STATUS_OK;
}

int compiler_make(Compiler *c, const Toolchain *tools, const Texts *texts, const char *output, const char **path) {
  const char *error = NULL;
  *path = output ? output : toolchain_cached(c->arena, tools, texts->at, texts->n);
  if (!output && toolchain_is_whole(c->arena, *path)) return STATUS_OK;
  if (!toolchain_build(c->arena, tools, texts->at, texts->n, *path, &error)) return fail_usage(error);
  if (!output) toolchain_seal(c->arena, *path);
  return STATUS_OK;
}

Texts compiler_texts(Compiler *c, const Units *units, int gsl) {
  Texts texts = {0};
  const char **names = ARENA_ARRAY(c->arena, const char *, units->n);
  for (uint32_t i = 0; i < units->n; i++) {
    names[i] = arena_printf(c->arena, "%s_%u", model_id(c->arena, units->at[i]->name), i);
    StrBuf b = strbuf(c->arena);
    emit_model(units->at[i], names[i], &b);
    vec_push(c->arena, &texts, ((SourceText){arena_printf(c->arena, "model_%u.c", i), sb_text(&b)}));
  }
  StrBuf b = strbuf(c->arena);
  emit_program((const IrUnit *const *)units->at, names, units->n, gsl, &b);
  vec_push(c->arena, &texts, ((SourceText){"program.c", sb_text(&b)}));
  return texts;
}
