/* `lagc page`: one HTML file that computes the motion: liblag as WebAssembly, the programs as bytes, and a script. A
 * program for each scene, and for each set of effects of it where there are few, so that only what is switched on is
 * computed. */
#include "commands/commands.h"

#include <stdio.h>
#include <string.h>

#include "base/far_copies.h"
#include "commands/effect_study.h"
#include "commands/live_page.h" /* generated from runtime/page */
#include "commands/simulator.h"
#include "emit/emit_model.h"
#include "fmu/zip.h"
#include "mech/switches.h"
#include "report/equation_listing.h"
#include "toolchain/files.h"
#include "toolchain/process.h"
#include "toolchain/toolchain.h"

static const char need[] =
    "`lagc page` needs %s, liblag as WebAssembly: run `make page` where lagc is built, with Clang "
    "for it (apt-get install clang lld wasi-libc libclang-rt-14-dev-wasm32)";

/* Appends bytes as text: 13 bits, the low ones first, as two of the 91 printable characters without " < and \;
 * up to 6 bits at the end as one. */
static void put_text91(StrBuf *out, const char *bytes, size_t n) {
  enum { BITS = 13, BASE = 91 };
  char digit[BASE];
  uint32_t bits = 0, have = 0;
  for (int c = '!', k = 0; c <= '~'; c++)
    if (c != '"' && c != '<' && c != '\\') digit[k++] = (char)c;
  for (size_t i = 0; i < n; i++) {
    bits |= (uint32_t)(unsigned char)bytes[i] << have;
    have += 8;
    if (have < BITS) continue;
    uint32_t x = bits & ((1u << BITS) - 1);
    sb_putc(out, digit[x / BASE]);
    sb_putc(out, digit[x % BASE]);
    bits >>= BITS, have -= BITS;
  }
  if (have > 6) sb_putc(out, digit[bits / BASE]);
  if (have) sb_putc(out, digit[bits % BASE]);
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

/* The page's data in two texts: `model` of live.js, and the bytes that it points into, which are compressed as one. */
typedef struct {
  StrBuf model, bytes;
  StrBuf letters; /* members "NAME": "LATEX" of parameters */
  const Eqns *shown;
} PageData;

static void put_letters(Compiler *c, PageData *d, const Model *m) {
  for (uint32_t i = 0; i < m->params.n; i++) {
    StrBuf latex = strbuf(c->arena);
    name_print(m->params.at[i].name, PRINT_LATEX, &latex);
    sb_puts(&d->letters, d->letters.n ? ", " : "");
    put_text(&d->letters, c->arena, m->params.at[i].name);
    sb_puts(&d->letters, ": ");
    put_text(&d->letters, c->arena, sb_text(&latex));
  }
}

/* A member of "programs": the scene with these effects, NULL: its own. 0: the model is wrong. */
static int put_program(Compiler *c, const char *scene, const EffectList *only, PageData *d, Eqns **of) {
  ModelChoice choice = {.scene = scene, .only = only, .drawing = 1, .given = c->given.at, .ngiven = c->given.n};
  Eqns *e = *of = compiler_derive(c, &choice);
  if (e) switches_find(e);
  ProgramSet *u = e ? compiler_lower_scene(c, e, 1) : NULL;
  if (!u) return 0;
  const char *name = "page";
  size_t at = d->bytes.n;
  emit_bytes((const ProgramSet *const *)&u, &name, 1, &d->bytes);
  sb_puts(&d->model, d->shown ? ",\n{\"scene\": " : "\n{\"scene\": ");
  put_text(&d->model, c->arena, e->m->scene.name);
  sb_puts(&d->model, ", \"doc\": ");
  put_text(&d->model, c->arena, e->m->scene.doc ? e->m->scene.doc : "");
  sb_puts(&d->model, ", \"effects\": [");
  for (uint32_t i = 0; i < e->m->effects.n; i++) {
    if (i) sb_puts(&d->model, ", ");
    put_text(&d->model, c->arena, e->m->effects.at[i]);
  }
  sb_printf(&d->model, "], \"at\": %zu, \"n\": %zu}", at, d->bytes.n - at);
  put_letters(c, d, e->m);
  if (!d->shown) d->shown = e;
  return 1;
}

/* The scene's own set of effects, then the other sets, while there are few effects. */
static int put_scene(Compiler *c, const char *scene, PageData *d) {
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

/* A recording of the scene, for browsers without WebAssembly: what `lagc animate` embeds. */
typedef struct {
  Compiler *c;
  const Scene *scene;
  const char *to;
  int rows;
} Recording;

static int record(void *data) {
  const Recording *r = data;
  Arena *a = r->c->arena;
  char *said, *argv[] = {arena_strdup(a, "lagc"), arena_strdup(a, "animate"), arena_strdup(a, r->c->o.file),
                         arena_strdup(a, r->scene->name), arena_strdup(a, "--quiet"), arena_strdup(a, "--every"),
                         arena_printf(a, "%.9g", (r->scene->t1 - r->scene->t0) / r->rows), arena_strdup(a, "-o"),
                         arena_strdup(a, r->to), NULL};
  const char *self = arena_printf(a, "%s/%s", toolchain_own_folder(a, r->c->argv0), file_name(r->c->argv0));
  return process_run(a, self, argv, &said);
}

typedef enum { RECORDED, TOO_LONG, NOT_RECORDED } Recorded;

/* Appends a recording of so many rows; none where the run takes longer than some seconds, or the rows are more than a
 * page should hold. */
static Recorded put_rows(Compiler *c, const Scene *scene, int rows, StrBuf *out) {
  enum { LONGEST = 60000, SECONDS = 4 };
  static const char begin[] = "\nconst run =\n";
  const char *to = arena_printf(c->arena, "%s.recording.html", c->o.output), *why, *from = NULL, *end = NULL;
  Recording r = {c, scene, to, rows};
  StrBuf page = strbuf(c->arena);
  long process = process_begin(record, &r);
  if (process > 0 && process_end(process, SECONDS) == STATUS_OK && file_append(to, &page, &why))
    from = strstr(sb_text(&page), begin);
  remove(to);
  if (from) end = strstr(from += strlen(begin), "\n;\n");
  if (!end) return NOT_RECORDED;
  if (end - from > LONGEST) return TOO_LONG;
  sb_putn(out, from, (size_t)(end - from));
  return RECORDED;
}

/* The recording, or null: for a text that has no name, and where the command line gives values, too. */
static void put_recording(Compiler *c, const Scene *scene, StrBuf *out) {
  int can = scene->has_span && strcmp(c->o.file, "-") != 0 && !c->given.n && !c->o.defines.n;
  Recorded done = can ? put_rows(c, scene, 150, out) : NOT_RECORDED;
  if (done == TOO_LONG) done = put_rows(c, scene, 40, out);
  if (done != RECORDED) sb_puts(out, "null");
}

/* The JSON that live.js calls `model`; its member "more" is the place of a JSON text among the bytes. */
static int put_model(Compiler *c, PageData *d) {
  enum { LONGEST = 40000 };
  StrBuf latex = strbuf(c->arena), more = strbuf(c->arena);
  SceneList all = model_scenes(c->ast);
  uint32_t n = c->o.scenes.n ? c->o.scenes.n : all.n;
  sb_puts(&d->model, "{\"programs\": [");
  for (uint32_t i = 0; i < n; i++)
    if (!put_scene(c, c->o.scenes.n ? c->o.scenes.at[i] : all.at[i], d)) return 0;
  show_equations(d->shown, NULL, PRINT_LATEX, &latex);
  sb_puts(&more, "{\"latex\": ");
  put_text(&more, c->arena, latex.n < LONGEST ? sb_text(&latex) : "");
  sb_printf(&more, ", \"letters\": {%s}, \"recording\": ", sb_text(&d->letters));
  put_recording(c, &d->shown->m->scene, &more);
  sb_puts(&more, "}");
  sb_printf(&d->model, "],\n\"more\": [%zu, %zu],\n\"source\": ", d->bytes.n, more.n);
  sb_putn(&d->bytes, more.at, more.n);
  put_text(&d->model, c->arena, c->sources->files.at[0].text);
  sb_puts(&d->model, "}");
  return 1;
}

static void put_escaped(StrBuf *out, const char *text) {
  for (; *text; text++) {
    if (*text == '<') sb_puts(out, "&lt;");
    else if (*text == '&') sb_puts(out, "&amp;");
    else sb_putc(out, *text);
  }
}

/* The template with its marks replaced: @TITLE@ anywhere, the others once a line. */
static void put_page(StrBuf *out, const char *title, const PageData *d, const StrBuf *packed, const StrBuf *module) {
  const struct {
    const char *mark;
    const StrBuf *text, *bytes;
  } marks[] = {{"@MODEL@", &d->model, NULL}, {"@BYTES@", NULL, packed}, {"@MODULE@", NULL, module}};
  for (size_t i = 0; i < sizeof live_page / sizeof *live_page; i++) {
    const char *line = live_page[i], *at = strstr(line, "@TITLE@");
    if (at) {
      sb_putn(out, line, (size_t)(at - line));
      put_escaped(out, title);
      line = at + strlen("@TITLE@");
    }
    for (size_t k = 0; !at && k < sizeof marks / sizeof *marks; k++) {
      const char *mark = strstr(line, marks[k].mark);
      if (!mark) continue;
      sb_putn(out, line, (size_t)(mark - line));
      if (marks[k].text) sb_putn(out, sb_text(marks[k].text), marks[k].text->n);
      else put_text91(out, marks[k].bytes->at, marks[k].bytes->n);
      line = mark + strlen(marks[k].mark);
    }
    sb_puts(out, line);
  }
}

int command_page(Compiler *c) {
  Toolchain tools;
  const char *error = NULL, *why;
  Arena *a = c->arena;
  StrBuf module = strbuf(a), page = strbuf(a), copies = strbuf(a), packed = strbuf(a);
  PageData d = {.model = strbuf(a), .bytes = strbuf(a), .letters = strbuf(a)};
  if (!c->o.output) return usage_error("`lagc page` needs -o FILE.html");
  if (!toolchain_find(a, c->argv0, 0, &tools, &error)) return usage_error(error);
  const char *path = arena_printf(a, "%s/lag.wasm.gz", tools.lib);
  if (!file_append(path, &module, &why)) return usage_error(arena_printf(a, need, path));
  if (compiler_is_source(c, c->o.output)) return STATUS_USAGE;
  if (!put_model(c, &d)) return STATUS_MODEL;
  far_copies_append(&d.bytes, &copies);
  gzip_append(&copies, &packed);
  const Model *m = d.shown->m;
  put_page(&page, m->doc ? m->doc : m->name, &d, &packed, &module);
  return compiler_write(c, c->o.output, &page);
}
