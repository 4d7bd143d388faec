/* `lagc models` lists the gallery; `lagc new` starts a model from one of it. */
#include "commands/commands.h"

#include <ctype.h>
#include <string.h>

#include "base/words.h"
#include "toolchain/files.h"
#include "toolchain/gallery.h"

/* The text of a model of the gallery; "" where it cannot be read. */
static StrBuf gallery_text(Arena *a, const Gallery *g, Name name) {
  StrBuf text = strbuf(a);
  const char *error;
  file_append(arena_printf(a, "%s/%s.lag", g->folder, name), &text, &error);
  return text;
}

/* Whether the word is a part of the text, in capitals or not. */
static int holds(const char *text, const char *word) {
  size_t n = strlen(word);
  for (; *text; text++) {
    size_t i = 0;
    while (i < n && tolower((unsigned char)text[i]) == tolower((unsigned char)word[i])) i++;
    if (i == n) return 1;
  }
  return 0;
}

uint32_t models_list(Compiler *c, const char *word, StrBuf *out) {
  Gallery g = gallery_find(c->arena, c->argv0);
  int widest = 0;
  uint32_t found = 0;
  for (uint32_t i = 0; i < g.names.n; i++)
    widest = (int)strlen(g.names.at[i]) > widest ? (int)strlen(g.names.at[i]) : widest;
  for (uint32_t i = 0; i < g.names.n; i++) {
    StrBuf text = gallery_text(c->arena, &g, g.names.at[i]);
    const char *title = gallery_title(c->arena, sb_text(&text));
    if (word && !holds(g.names.at[i], word) && !holds(title, word)) continue;
    sb_printf(out, "@%-*s  %s\n", widest, g.names.at[i], title);
    found++;
  }
  return found;
}

int command_models(Compiler *c) {
  StrBuf out = strbuf(c->arena);
  Gallery g = gallery_find(c->arena, c->argv0);
  if (!g.names.n) return usage_error("the gallery is not found beside lagc: `make install` brings it along");
  if (!models_list(c, c->o.topic, &out))
    return usage_error(
        arena_printf(c->arena, "no model has `%s` in its name or title; `lagc models` lists all", c->o.topic));
  sb_printf(&out, "\nFiles in %s. `lagc run @pendulum` runs one, `lagc new NAME --like pendulum` copies one.\n",
            g.folder);
  return compiler_write(c, NULL, &out);
}

/* The model whose name is a part of `name`, the longest; else the nearest by letters; else pendulum. */
static Name nearest_model(const Gallery *g, const char *name) {
  Name best = NULL;
  for (uint32_t i = 0; i < g->names.n; i++) {
    Name of = g->names.at[i];
    if (strstr(name, of) && (!best || strlen(of) > strlen(best))) best = of;
  }
  best = best ? best : suggest(name, g->names.at, g->names.n);
  return best ? best : "pendulum";
}

/* Whether the text is a name of the language, of at most 60 letters. */
static int is_name(const char *s) {
  size_t n = strlen(s);
  for (size_t i = 0; i < n; i++)
    if (!isalpha((unsigned char)s[i]) && s[i] != '_' && !(i && isdigit((unsigned char)s[i]))) return 0;
  return n && n <= 60;
}

int command_new(Compiler *c) {
  Arena *a = c->arena;
  size_t n = strlen(c->o.file), suffix = n > 4 && strcmp(c->o.file + n - 4, ".lag") == 0 ? 4 : 0;
  const char *name = arena_strndup(a, c->o.file, n - suffix), *path = arena_printf(a, "%s.lag", name);
  Gallery g = gallery_find(a, c->argv0);
  const char *error = NULL, *like = c->o.like ? c->o.like + (c->o.like[0] == '@') : nearest_model(&g, name);
  if (c->o.scene)
    return usage_error(arena_printf(a, "one word too many: `%s`; usage: lagc new NAME [--like MODEL]", c->o.scene));
  if (!is_name(name)) {
    char *better = arena_strdup(a, name);
    for (char *s = better; *s; s++) *s = *s == '-' || *s == ' ' || *s == '.' ? '_' : *s;
    return usage_error(arena_printf(a, "%s: a model's name has letters, digits and _, and begins with a letter%s%s",
                                    name, is_name(better) ? "; write lagc new " : "", is_name(better) ? better : ""));
  }
  if (!gallery_path(a, c->argv0, arena_printf(a, "@%s", like), &error)) return usage_error(error);
  if (file_exists(path)) return usage_error(arena_printf(a, "%s is there already; take another name", path));
  StrBuf text = gallery_text(a, &g, like), out = strbuf(a);
  const char *from = sb_text(&text), *line = strncmp(from, "model ", 6) == 0 ? from : strstr(from, "\nmodel ") + 1;
  sb_putn(&out, from, (size_t)(line - from));
  sb_printf(&out, "model %s%s", name, line + 6 + strcspn(line + 6, " \n"));
  int status = compiler_write(c, path, &out);
  if (status == STATUS_OK)
    printf("%s begins as a copy of %s; `lagc check %s`, `lagc run %s --sketch`\n", path, like, path, path);
  return status;
}
