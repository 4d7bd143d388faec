/* Finds the gallery beside lagc, and its models by name. */
#include "toolchain/gallery.h"

#include <stdlib.h>
#include <string.h>

#include "base/posix.h" /* generated: a copy of runtime/io/posix.h */
#include "base/words.h"
#include "toolchain/files.h"
#include "toolchain/toolchain.h"

static int by_name(const void *a, const void *b) { return strcmp(*(const Name *)a, *(const Name *)b); }

/* Folder of the gallery, or NULL. */
static const char *gallery_folder(Arena *a, const char *argv0) {
  const char *own = toolchain_own_folder(a, argv0), *home = getenv("LAG_HOME");
  const char *places[] = {home && home[0] ? arena_printf(a, "%s/share/lagc/models", home) : NULL,
                          arena_printf(a, "%s/../share/lagc/models", own), arena_printf(a, "%s/../models", own)};
  for (size_t i = 0; i < sizeof places / sizeof *places; i++)
    if (places[i] && file_exists(places[i])) return file_absolute(a, places[i]);
  return NULL;
}

const char *gallery_library(Arena *a, const char *argv0) {
  const char *folder = gallery_folder(a, argv0);
  return folder ? arena_printf(a, "%s/lib", folder) : NULL;
}

Gallery gallery_find(Arena *a, const char *argv0) {
  Gallery g = {.folder = gallery_folder(a, argv0)};
  DIR *d = g.folder ? opendir(g.folder) : NULL;
  for (struct dirent *e; d && (e = readdir(d));) {
    size_t n = strlen(e->d_name);
    if (n > 4 && e->d_name[0] != '.' && strcmp(e->d_name + n - 4, ".lag") == 0)
      vec_push(a, &g.names, arena_strndup(a, e->d_name, n - 4));
  }
  if (d) closedir(d);
  if (g.names.n) qsort(g.names.at, g.names.n, sizeof *g.names.at, by_name);
  return g;
}

const char *gallery_path(Arena *a, const char *argv0, const char *word, const char **error) {
  if (word[0] != '@') return word;
  Gallery g = gallery_find(a, argv0);
  for (uint32_t i = 0; i < g.names.n; i++)
    if (strcmp(g.names.at[i], word + 1) == 0) return arena_printf(a, "%s/%s.lag", g.folder, word + 1);
  if (!g.names.n) *error = "the gallery is not found beside lagc: `make install` brings it along";
  else {
    Name near = word[1] ? suggest(word + 1, g.names.at, g.names.n) : NULL;
    for (uint32_t i = 0; i < g.names.n && word[1] && !near; i++)
      if (strncmp(g.names.at[i], word + 1, strlen(word + 1)) == 0) near = g.names.at[i];
    *error = !word[1] ? "@ and the name of a gallery model, for example @pendulum; `lagc models` lists them"
             : near   ? arena_printf(a, "the gallery has no model %s; did you mean @%s?", word + 1, near)
                      : arena_printf(a, "the gallery has no model %s; `lagc models` lists them", word + 1);
  }
  return NULL;
}

const char *gallery_name(Arena *a, const char *argv0, const char *path) {
  const char *slash = strrchr(path, '/'), *base = slash ? slash + 1 : path;
  size_t n = strlen(base), bare = n > 4 && strcmp(base + n - 4, ".lag") == 0 ? n - 4 : n;
  Gallery g = gallery_find(a, argv0);
  for (uint32_t i = 0; i < g.names.n; i++)
    if (strlen(g.names.at[i]) == bare && strncmp(g.names.at[i], base, bare) == 0) return g.names.at[i];
  return NULL;
}

const char *gallery_title(Arena *a, const char *text) {
  const char *line = strncmp(text, "model ", 6) == 0 ? text : strstr(text, "\nmodel ");
  const char *quote = line ? strpbrk(line + 1, "\"\n") : NULL;
  return quote && *quote == '"' ? arena_strndup(a, quote + 1, strcspn(quote + 1, "\"\n")) : "";
}
