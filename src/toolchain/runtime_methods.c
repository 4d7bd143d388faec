/* Builds and runs a small program that prints the runtime's descriptors of methods. */
#include "toolchain/runtime_methods.h"
#include "toolchain/process.h"

#include <string.h>
static const char program[] =
  "#include \"lag.h\"\n"
  "#include <stdio.h>\n\n"
  "static void list(const lag_method *const *methods, int n) {\n"
  "  for (int i = 0; i < n; i++) printf(\"%%s\\t%%s\\n\", methods[i]->name, methods[i]->doc);\n"
  "}\n\n"
  "int main(int argc, char **argv) {\n"
  "  static const lag_program none = {.name = \"\", .doc = \"\", .source = \"\", .effects = \"\"};\n"
  "  const lag_extras *extras = %s;\n"
  "  if (argc > 1) return lag_app_main(argc, argv, &none, extras);\n"
  "  list(lag_methods, lag_nmethods);\n"
  "  if (extras) list(extras->methods, extras->nmethods);\n"
  "  return 0;\n"
  "}\n";

const char *methods_program(Arena *a, const char *argv0, int want_gsl, const char **error) {
  Toolchain tools;
  if (!toolchain_find(a, argv0, want_gsl, &tools, error)) return NULL;
  SourceText text = {"runtime_methods.c", arena_printf(a, program, tools.gsl ? "&lag_gsl" : "NULL")};
  return toolchain_simulator(a, &tools, &text, 1, error);
}

int methods_list(Arena *a, const char *argv0, int want_gsl, Methods *out, const char **error) {
  const char *path = methods_program(a, argv0, want_gsl, error);
  if (!path) return 0;
  char *argv[] = {arena_strdup(a, path), NULL}, *said = NULL;
  if (process_run(a, argv, &said) != 0) {
    *error = arena_printf(a, "cannot run %s; delete it, and it is built anew", path);
    return 0;
  }
  for (char *line = strtok(said, "\n"); line; line = strtok(NULL, "\n")) {
    char *tab = strchr(line, '\t');
    if (!tab) continue; /* a description of several lines */
    *tab = '\0';
    vec_push(a, out, ((MethodRow){line, tab + 1}));
  }
  return 1;
}
