/* Parts of pages: modules, texts as JSON, a frame with marks. */
#include "commands/page_parts.h"

#include <stdio.h>
#include <string.h>

#include "commands/live_script.h" /* generated from runtime/page */
#include "commands/pack.h"
#include "toolchain/files.h"
#include "toolchain/toolchain.h"

void page_bytes(StrBuf *out, const char *bytes, size_t n) {
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

void page_text(StrBuf *out, Arena *a, const char *text) {
  StrBuf b = strbuf(a);
  sb_json(&b, text);
  for (const char *s = sb_text(&b); *s; s++)
    if (*s == '<') sb_puts(out, "\\u003c");
    else sb_putc(out, *s);
}

int page_module(Compiler *c, const char *name, StrBuf *out) {
  static const char need[] =
      "`lagc %s` needs %s, which is WebAssembly: run `make page` where lagc is built, with Clang "
      "for it (apt-get install clang lld wasi-libc libclang-rt-14-dev-wasm32)";
  Toolchain tools;
  StrBuf bytes = strbuf(c->arena);
  const char *error = NULL;
  if (!toolchain_find(c->arena, c->argv0, 0, &tools, &error)) return usage_error(error), 0;
  const char *path = arena_printf(c->arena, "%s/%s", tools.lib, name);
  if (!file_append(path, &bytes, &error))
    return usage_error(arena_printf(c->arena, need, command_find(c->o.command)->name, path)), 0;
  StrBuf packed = strbuf(c->arena);
  if (!strstr(name, ".gz") && !pack_append(&bytes, &packed))
    fprintf(stderr, "lagc: note: the page is longer than it need be, since this lagc was built without liblzma: "
                    "apt-get install liblzma-dev, and make lagc anew\n");
  page_bytes(out, packed.n ? packed.at : bytes.at, packed.n ? packed.n : bytes.n);
  return 1;
}

void page_fill(StrBuf *out, const char *const *lines, size_t nlines, const PageMark *marks, size_t n) {
  for (size_t i = 0; i < nlines; i++) {
    const char *at = NULL;
    size_t k = 0;
    while (k < n && !(at = strstr(lines[i], marks[k].mark))) k++;
    if (!at) {
      sb_puts(out, lines[i]);
      continue;
    }
    sb_putn(out, lines[i], (size_t)(at - lines[i]));
    sb_puts(out, marks[k].text);
    sb_puts(out, at + strlen(marks[k].mark));
  }
}

const char *page_script(Arena *a) {
  StrBuf script = strbuf(a), packed = strbuf(a), text = strbuf(a);
  for (size_t i = 0; i < sizeof live_script / sizeof *live_script; i++) sb_puts(&script, live_script[i]);
  pack_append(&script, &packed);
  page_bytes(&text, packed.at, packed.n);
  return sb_text(&text);
}
