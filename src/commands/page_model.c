/* The model of a page: a program for each scene, and for each set of effects of it where there are few, so that only
 * what is switched on is computed; the equations; the text. */
#include "commands/page_model.h"

#include "commands/effect_study.h"
#include "commands/page_parts.h"
#include "emit/emit_model.h"
#include "mech/switches.h"
#include "report/equation_listing.h"

static void put_letters(Compiler *c, PageModel *d, const Model *m) {
  for (uint32_t i = 0; i < m->params.n; i++) {
    StrBuf latex = strbuf(c->arena);
    name_print(m->params.at[i].name, PRINT_LATEX, &latex);
    sb_puts(&d->letters, d->letters.n ? ", " : "");
    page_text(&d->letters, c->arena, m->params.at[i].name);
    sb_puts(&d->letters, ": ");
    page_text(&d->letters, c->arena, sb_text(&latex));
  }
}

/* A member of "programs": the scene with these effects, NULL: its own. 0: the model is wrong. */
static int put_program(Compiler *c, const char *scene, const EffectList *only, PageModel *d, Eqns **of) {
  ModelChoice choice = {.scene = scene, .only = only, .drawing = 1, .given = c->given.at, .ngiven = c->given.n};
  Eqns *e = *of = compiler_derive(c, &choice);
  if (e) switches_find(e);
  ProgramSet *u = e ? compiler_lower_scene(c, e, 1) : NULL;
  if (!u) return 0;
  const char *name = "page";
  size_t at = d->bytes.n;
  emit_bytes((const ProgramSet *const *)&u, &name, 1, &d->bytes);
  sb_puts(&d->programs, d->programs.n ? ", {\"scene\": " : "{\"scene\": ");
  page_text(&d->programs, c->arena, e->m->scene.name);
  sb_puts(&d->programs, ", \"doc\": ");
  page_text(&d->programs, c->arena, e->m->scene.doc ? e->m->scene.doc : "");
  sb_puts(&d->programs, ", \"effects\": [");
  for (uint32_t i = 0; i < e->m->effects.n; i++) {
    if (i) sb_puts(&d->programs, ", ");
    page_text(&d->programs, c->arena, e->m->effects.at[i]);
  }
  sb_printf(&d->programs, "], \"at\": %zu, \"n\": %zu}", at, d->bytes.n - at);
  put_letters(c, d, e->m);
  if (!d->shown) d->shown = e;
  return 1;
}

/* The scene's own set of effects, then the other sets, while there are few effects. */
static int put_scene(Compiler *c, const char *scene, PageModel *d) {
  Eqns *e;
  if (!put_program(c, scene, NULL, d, &e)) return 0;
  EffectStudy *s = effect_graph(c->ast).n ? effect_study_plan(e->m) : NULL;
  EffectSet sets = s && s->graph.n < 5 ? (EffectSet)1 << s->graph.n : 0;
  for (EffectSet set = 0; set < sets; set++) {
    if (set == s->used || !effect_set_valid(s, set)) continue;
    EffectList only = effect_names(s, set);
    if (!put_program(c, scene, &only, d, &e)) return 0;
  }
  return 1;
}

PageModel page_model_begin(Arena *a) {
  return (PageModel){.json = strbuf(a), .programs = strbuf(a), .bytes = strbuf(a), .letters = strbuf(a)};
}

int page_model_programs(Compiler *c, PageModel *d, int first) {
  SceneList all = model_scenes(c->ast);
  Eqns *e;
  d->whole = !first || (all.n < 2 && !effect_graph(c->ast).n);
  if (first) return put_program(c, all.at[0], NULL, d, &e);
  uint32_t n = c->o.scenes.n ? c->o.scenes.n : all.n;
  for (uint32_t i = 0; i < n; i++)
    if (!put_scene(c, c->o.scenes.n ? c->o.scenes.at[i] : all.at[i], d)) return 0;
  return 1;
}

void page_model_end(Compiler *c, PageModel *d, const char *recording) {
  enum { LONGEST = 40000 };
  StrBuf latex = strbuf(c->arena), more = strbuf(c->arena);
  show_equations(d->shown, NULL, PRINT_LATEX, &latex);
  sb_printf(&more, "{\"programs\": [%s], \"latex\": ", sb_text(&d->programs));
  page_text(&more, c->arena, latex.n < LONGEST ? sb_text(&latex) : "");
  sb_printf(&more, ", \"letters\": {%s}, \"recording\": %s}", sb_text(&d->letters), recording);
  sb_printf(&d->json, "{\"more\": [%zu, %zu],\n\"source\": ", d->bytes.n, more.n);
  sb_putn(&d->bytes, more.at, more.n);
  page_text(&d->json, c->arena, c->sources->files.at[0].text);
}
