/* base/source_file.c where there are no files: those that come with lagc (models/lib) stand in the module. */
#include <string.h>

#include "base/source.h"
#include "base/strbuf.h"
#include "playground/library.h" /* generated from models/lib */

enum { LIBRARY_FILES = sizeof library / sizeof *library };

/* The text of `lib/NAME`; NULL: there is none. */
static const char *library_text(const char *path) {
  for (size_t i = 0; i < LIBRARY_FILES; i++)
    if (strncmp(path, "lib/", 4) == 0 && strcmp(path + 4, library[i].name) == 0) return library[i].text;
  return NULL;
}

int source_is_readable(const char *path) { return library_text(path) != NULL; }

const Source *source_read(Sources *s, const char *path, const char **error) {
  const char *text = library_text(path);
  StrBuf names = strbuf(s->arena);
  if (text) {
    source_add(s, arena_strdup(s->arena, path), text, strlen(text));
    s->files.at[s->files.n - 1].is_file = 1;
    return &s->files.at[s->files.n - 1];
  }
  for (size_t i = 0; i < LIBRARY_FILES; i++) sb_printf(&names, "%s%s", i ? ", " : "", library[i].name);
  *error = arena_printf(s->arena, "a page has no files but %s", sb_text(&names));
  return NULL;
}

FILE *source_open(const char *path, const char **error) {
  (void)path;
  *error = "a page has no files";
  return NULL;
}
