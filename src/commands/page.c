/* `lagc page`: one HTML file that computes the motion: liblag as WebAssembly, the programs as bytes, and a script. A
 * program for each scene, and for each set of effects of it where there are few, so that only what is switched on is
 * computed. */
#include "commands/commands.h"

#include <stdio.h>
#include <string.h>

#include "commands/effect_study.h"
#include "commands/live_page.h" /* generated from runtime/page */
#include "commands/simulator.h"
#include "emit/emit_model.h"
#include "mech/switches.h"
#include "report/equation_listing.h"
#include "toolchain/files.h"
#include "toolchain/toolchain.h"

static const char need[] =
    "`lagc page` needs %s, liblag as WebAssembly: run `make page` where lagc is built, with Clang "
    "for it (apt-get install clang lld wasi-libc libclang-rt-14-dev-wasm32)";

/* Appends bytes in base 64 (RFC 4648, 4). */
static void put_base64(StrBuf *out, const char *bytes, size_t n) {
  static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (size_t i = 0; i < n; i += 3) {
    uint32_t x = 0;
    for (size_t k = 0; k < 3; k++) x = x << 8 | (i + k < n ? (unsigned char)bytes[i + k] : 0u);
    for (size_t k = 0; k < 4; k++) sb_putc(out, i + k > n ? '=' : digit[x >> (18 - 6 * k) & 63]);
  }
}

/* Appends a text as JSON that may stand in a script: without `<`, nothing in it is markup. */
static void put_text(StrBuf *out, Arena *a, const char *text) {
  StrBuf b = strbuf(a);
  sb_json(&b, text);
  for (const char *s = sb_text(&b); *s; s++) {
    if (*s == '<') sb_puts(out, "\\u003c");
    else sb_putc(out, *s);
  }
}

/* A member of "programs": the scene with these effects, NULL: its own. 0: the model is wrong. */
static int put_program(Compiler *c, const char *scene, const EffectList *only, int first, StrBuf *out, Eqns **of) {
  ModelChoice choice = {.scene = scene, .only = only, .drawing = 1, .given = c->given.at, .ngiven = c->given.n};
  Eqns *e = *of = compiler_derive(c, &choice);
  if (e) switches_find(e);
  ProgramSet *u = e ? compiler_lower_scene(c, e, 1) : NULL;
  if (!u) return 0;
  StrBuf bytes = strbuf(c->arena);
  const char *name = "page";
  emit_bytes((const ProgramSet *const *)&u, &name, 1, &bytes);
  sb_puts(out, first ? "\n{\"scene\": " : ",\n{\"scene\": ");
  put_text(out, c->arena, e->m->scene.name);
  sb_puts(out, ", \"effects\": [");
  for (uint32_t i = 0; i < e->m->effects.n; i++) {
    if (i) sb_puts(out, ", ");
    put_text(out, c->arena, e->m->effects.at[i]);
  }
  sb_puts(out, "], \"bytes\": \"");
  put_base64(out, bytes.at, bytes.n);
  sb_puts(out, "\"}");
  return 1;
}

/* The scene's own set of effects, then the other sets, while there are few effects. */
static int put_scene(Compiler *c, const char *scene, int first, StrBuf *out, const Eqns **shown) {
  Eqns *e;
  if (!put_program(c, scene, NULL, first, out, &e)) return 0;
  if (first) *shown = e;
  EffectStudy *s = effect_graph(c->ast).n ? effect_study_plan(e->m) : NULL;
  EffectSet sets = s && s->graph.n < 5 ? (EffectSet)1 << s->graph.n : 0;
  for (EffectSet set = 0; set < sets; set++) {
    if (set == s->used || !effect_set_valid(s, set)) continue;
    EffectList only = effect_names(s, set);
    if (!put_program(c, scene, &only, 0, out, &e)) return 0;
  }
  return 1;
}

/* The JSON that live.js calls `model`. */
static int put_model(Compiler *c, StrBuf *out, const char **title) {
  StrBuf equations = strbuf(c->arena);
  const Eqns *shown = NULL;
  SceneList all = model_scenes(c->ast);
  uint32_t n = c->o.scenes.n ? c->o.scenes.n : all.n;
  sb_puts(out, "{\"programs\": [");
  for (uint32_t i = 0; i < n; i++)
    if (!put_scene(c, c->o.scenes.n ? c->o.scenes.at[i] : all.at[i], i == 0, out, &shown)) return 0;
  *title = shown->m->doc ? shown->m->doc : shown->m->name;
  show_equations(shown, "", PRINT_TEXT, &equations);
  sb_puts(out, "],\n\"equations\": ");
  put_text(out, c->arena, sb_text(&equations));
  sb_puts(out, ",\n\"source\": ");
  put_text(out, c->arena, c->sources->files.at[0].text);
  sb_puts(out, "}");
  return 1;
}

static void put_escaped(StrBuf *out, const char *text) {
  for (; *text; text++) {
    if (*text == '<') sb_puts(out, "&lt;");
    else if (*text == '&') sb_puts(out, "&amp;");
    else sb_putc(out, *text);
  }
}

/* The template with its marks replaced: @TITLE@ anywhere, @MODEL@ and @MODULE@ once a line. */
static void put_page(StrBuf *out, const char *title, const StrBuf *model, const StrBuf *module) {
  for (size_t i = 0; i < sizeof live_page / sizeof *live_page; i++) {
    const char *line = live_page[i], *at;
    if ((at = strstr(line, "@TITLE@")) != NULL) {
      sb_putn(out, line, (size_t)(at - line));
      put_escaped(out, title);
      sb_puts(out, at + strlen("@TITLE@"));
    } else if ((at = strstr(line, "@MODEL@")) != NULL || (at = strstr(line, "@MODULE@")) != NULL) {
      int whole = at[4] == 'E';
      sb_putn(out, line, (size_t)(at - line));
      if (whole) sb_putn(out, sb_text(model), model->n);
      else put_base64(out, module->at, module->n);
      sb_puts(out, at + strlen(whole ? "@MODEL@" : "@MODULE@"));
    } else sb_puts(out, line);
  }
}

int command_page(Compiler *c) {
  Toolchain tools;
  const char *error = NULL, *why, *title;
  StrBuf module = strbuf(c->arena), model = strbuf(c->arena), page = strbuf(c->arena);
  if (!c->o.output) return usage_error("`lagc page` needs -o FILE.html");
  if (!toolchain_find(c->arena, c->argv0, 0, &tools, &error)) return usage_error(error);
  const char *path = arena_printf(c->arena, "%s/lag.wasm.gz", tools.lib);
  if (!file_append(path, &module, &why)) return usage_error(arena_printf(c->arena, need, path));
  if (!put_model(c, &model, &title)) return STATUS_MODEL;
  put_page(&page, title, &model, &module);
  if (compiler_is_source(c, c->o.output)) return STATUS_USAGE;
  return compiler_write(c, c->o.output, &page);
}
