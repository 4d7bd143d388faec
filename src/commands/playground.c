/* `lagc playground`: one HTML file in which lagc compiles what one types: lagc and liblag as WebAssembly, the live
 * page, and models of the gallery to begin with. */
#include "commands/commands.h"

#include <string.h>

#include "commands/live_page.h"       /* generated from runtime/page */
#include "commands/page_parts.h"
#include "commands/playground_page.h" /* generated from src/playground */
#include "toolchain/files.h"
#include "toolchain/gallery.h"

/* A member of `examples` of playground.html; 0: the file cannot be read. */
static int put_example(Compiler *c, const char *name, const char *path, StrBuf *out) {
  StrBuf text = strbuf(c->arena);
  const char *why;
  if (!file_append(path, &text, &why)) return 0;
  sb_puts(out, out->n > 1 ? ",\n{\"name\": " : "{\"name\": ");
  page_text(out, c->arena, name);
  sb_puts(out, ", \"title\": ");
  page_text(out, c->arena, gallery_title(c->arena, sb_text(&text)));
  sb_puts(out, ", \"text\": ");
  page_text(out, c->arena, sb_text(&text));
  sb_puts(out, "}");
  return 1;
}

/* The model of the command line, then some of the gallery. 0, reported: there is none. */
static int put_examples(Compiler *c, StrBuf *out) {
  static const char *const shown[] = {"pendulum", "double_pendulum", "spring", "kepler", "bouncing_ball",
                                      "lagrange_top", "slider_crank", "stick_slip", "henon_heiles"};
  const char *folder = gallery_find(c->arena, c->argv0).folder, *why = NULL;
  const char *own = c->o.file ? gallery_path(c->arena, c->argv0, c->o.file, &why) : NULL;
  sb_putc(out, '[');
  if (why) return usage_error(why), 0;
  if (own && !put_example(c, file_name(own), own, out))
    return usage_error(arena_printf(c->arena, "cannot read %s", own)), 0;
  for (size_t i = 0; folder && i < sizeof shown / sizeof *shown; i++)
    put_example(c, shown[i], arena_printf(c->arena, "%s/%s.lag", folder, shown[i]), out);
  sb_putc(out, ']');
  return out->n > 2 ? 1 : (usage_error("the gallery is not found beside lagc: name a model to begin with"), 0);
}

int command_playground(Compiler *c) {
  StrBuf lag = strbuf(c->arena), lagc = strbuf(c->arena), live = strbuf(c->arena), text = strbuf(c->arena),
         examples = strbuf(c->arena), page = strbuf(c->arena);
  if (!c->o.output) return usage_error("`lagc playground` needs -o FILE.html");
  if (!page_module(c, "lag.wasm", &lag) || !page_module(c, "lagc.wasm.gz", &lagc)) return STATUS_USAGE;
  if (!put_examples(c, &examples)) return STATUS_USAGE;
  const PageMark script = {"@LIVE@", page_script(c->arena)};
  page_fill(&text, live_page, sizeof live_page / sizeof *live_page, &script, 1);
  page_text(&live, c->arena, sb_text(&text));
  const PageMark marks[] = {{"@LAG@", sb_text(&lag)},
                            {"@LAGC@", sb_text(&lagc)},
                            {"@LIVE@", sb_text(&live)},
                            {"@EXAMPLES@", sb_text(&examples)}};
  page_fill(&page, playground_page, sizeof playground_page / sizeof *playground_page, marks, 4);
  if (c->o.file && file_same(c->o.output, c->o.file))
    return usage_error(arena_printf(c->arena, "%s would be overwritten: it is the model", c->o.output));
  return compiler_write(c, c->o.output, &page);
}
