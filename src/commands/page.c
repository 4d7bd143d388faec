/* `lagc page`: one HTML file that computes the motion: liblag as WebAssembly, the programs as bytes, and a script. */
#include "commands/commands.h"

#include "commands/live_page.h" /* generated from runtime/page */
#include "commands/page_model.h"
#include "commands/page_parts.h"

static const char *escaped(Arena *a, const char *text) {
  StrBuf out = strbuf(a);
  for (; *text; text++) {
    if (*text == '<') sb_puts(&out, "&lt;");
    else if (*text == '&') sb_puts(&out, "&amp;");
    else sb_putc(&out, *text);
  }
  return sb_text(&out);
}

int command_page(Compiler *c) {
  const char *title;
  StrBuf module = strbuf(c->arena), model = strbuf(c->arena), page = strbuf(c->arena);
  if (!c->o.output) return usage_error("`lagc page` needs -o FILE.html");
  if (!page_module(c, "lag.wasm.gz", &module)) return STATUS_USAGE;
  if (!page_model(c, &model, &title)) return STATUS_MODEL;
  const PageMark marks[] = {
      {"@TITLE@", escaped(c->arena, title)}, {"@MODEL@", sb_text(&model)}, {"@MODULE@", sb_text(&module)}};
  page_fill(&page, live_page, sizeof live_page / sizeof *live_page, marks, 3);
  if (compiler_is_source(c, c->o.output)) return STATUS_USAGE;
  return compiler_write(c, c->o.output, &page);
}
