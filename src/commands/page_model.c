/* The model of a page as JSON: a program for each scene, and for each set of effects of it where there are few, so that
 * only what is switched on is computed; the equations; the text. */
#include "commands/page_model.h"

#include "commands/effect_study.h"
#include "commands/page_parts.h"
#include "emit/emit_model.h"
#include "mech/switches.h"
#include "report/equation_listing.h"

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
  page_text(out, c->arena, e->m->scene.name);
  sb_puts(out, ", \"effects\": [");
  for (uint32_t i = 0; i < e->m->effects.n; i++) {
    if (i) sb_puts(out, ", ");
    page_text(out, c->arena, e->m->effects.at[i]);
  }
  sb_puts(out, "], \"bytes\": \"");
  page_base64(out, bytes.at, bytes.n);
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

int page_model(Compiler *c, StrBuf *out, const char **title) {
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
  page_text(out, c->arena, sb_text(&equations));
  sb_puts(out, ",\n\"source\": ");
  page_text(out, c->arena, c->sources->files.at[0].text);
  sb_puts(out, "}");
  return 1;
}
