/* What pages are put together from: modules in base 64, texts as JSON, a frame with marks. */
#include "commands/page_parts.h"

#include <string.h>

#include "toolchain/files.h"
#include "toolchain/toolchain.h"

void page_base64(StrBuf *out, const char *bytes, size_t n) {
  static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (size_t i = 0; i < n; i += 3) {
    uint32_t x = 0;
    for (size_t k = 0; k < 3; k++) x = x << 8 | (i + k < n ? (unsigned char)bytes[i + k] : 0u);
    for (size_t k = 0; k < 4; k++) sb_putc(out, i + k > n ? '=' : digit[x >> (18 - 6 * k) & 63]);
  }
}

void page_text(StrBuf *out, Arena *a, const char *text) {
  StrBuf b = strbuf(a);
  sb_json(&b, text);
  for (const char *s = sb_text(&b); *s; s++) {
    if (*s == '<') sb_puts(out, "\\u003c");
    else sb_putc(out, *s);
  }
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
  page_base64(out, bytes.at, bytes.n);
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
