/* `lagc page`: one HTML file that computes the motion: liblag as WebAssembly, the programs as bytes, and a script. */
#include "commands/commands.h"

#include <stdio.h>
#include <string.h>

#include "commands/live_page.h" /* generated from runtime/page */
#include "commands/pack.h"
#include "commands/page_model.h"
#include "commands/page_parts.h"
#include "toolchain/files.h"
#include "toolchain/process.h"
#include "toolchain/toolchain.h"

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

static const char *escaped(Arena *a, const char *text) {
  StrBuf out = strbuf(a);
  for (; *text; text++)
    if (*text == '<') sb_puts(&out, "&lt;");
    else if (*text == '&') sb_puts(&out, "&amp;");
    else sb_putc(&out, *text);
  return sb_text(&out);
}

int command_page(Compiler *c) {
  Arena *a = c->arena;
  StrBuf module = strbuf(a), page = strbuf(a), packed = strbuf(a), bytes = strbuf(a), recording = strbuf(a);
  PageModel d = page_model_begin(a);
  if (!c->o.output) return usage_error("`lagc page` needs -o FILE.html");
  if (!page_module(c, "lag.wasm", &module)) return STATUS_USAGE;
  if (compiler_is_source(c, c->o.output)) return STATUS_USAGE;
  if (!page_model_programs(c, &d, 0)) return STATUS_MODEL;
  put_recording(c, &d.shown->m->scene, &recording);
  page_model_end(c, &d, sb_text(&recording));
  sb_putc(&d.json, '}');
  pack_append(&d.bytes, &packed);
  page_bytes(&bytes, packed.at, packed.n);
  const Model *m = d.shown->m;
  const PageMark marks[] = {{"@TITLE@", escaped(a, *m->doc ? m->doc : m->name)},
                            {"@MODEL@", sb_text(&d.json)},
                            {"@BYTES@", sb_text(&bytes)},
                            {"@MODULE@", sb_text(&module)},
                            {"@LIVE@", page_script(a)}};
  page_fill(&page, live_page, sizeof live_page / sizeof *live_page, marks, sizeof marks / sizeof *marks);
  return compiler_write(c, c->o.output, &page);
}
