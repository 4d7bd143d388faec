/* The documents as arrays of lines, made by `make` from the files that they are. */
#include "commands/manual.h"

#include <string.h>

#include "commands/language.h" /* generated from grammar/LANGUAGE.md */
#include "commands/python.h"   /* runtime/python/README.md, without its decisions */
#include "commands/readme.h"   /* README.md */
#include "commands/tutorial.h" /* models/TUTORIAL.md */

#define LINES(name) name, sizeof name / sizeof *name

const Document documents[N_DOCUMENTS] = {
  [LANGUAGE] = {"", "the language", LINES(language)},
  {"tutorial", "Tutorial", LINES(tutorial)},
  {"python", "Python", LINES(python)},
  {"readme", "README", LINES(readme)},
};

int document_heading(const char *line) { return strncmp(line, "## ", 3) == 0 || strncmp(line, "### ", 4) == 0; }

const char *document_words(Arena *a, const char *line) {
  static const char head[] = "<!-- help: ";
  size_t n = sizeof head - 1;
  if (strncmp(line, head, n) != 0) return "";
  const char *end = strstr(line, " -->");
  return end ? arena_strndup(a, line + n, (size_t)(end - line) - n) : "";
}
