/* Compiles and runs the program of probe.in with the flags of simulators, and with further flags until it passes. */
#include "toolchain/compiler_probe.h"

#include <stdio.h>
#include <string.h>

#include "base/strbuf.h"
#include "toolchain/files.h"
#include "toolchain/probe_text.h" /* static const char *const probe_text[]: generated from probe.in */
#include "toolchain/process.h"

enum { N_LINES = sizeof probe_text / sizeof *probe_text, WRONG = 1 };

/* Runs the compiler with the words `more` after those of cc; returns its exit status. */
static int run_compiler(Arena *a, const char *cc, const char *const *more, char **said) {
  Words argv = process_words(a, cc);
  for (; *more; more++)
    if (**more) vec_push(a, &argv, arena_strdup(a, *more));
  vec_push(a, &argv, NULL);
  return process_run(a, argv.at, said);
}

/* Whether the compiler is GCC with AVX-512, the only one known to fail; its predefined macros tell, in 10 ms. */
static int is_suspect(Arena *a, const char *cc, const char *source) {
  const char *const more[] = {"-dM", "-E", source, NULL};
  char *said = NULL;
  return run_compiler(a, cc, more, &said) == 0 && strstr(said, "#define __AVX512F__ ") && !strstr(said, "#define __clang__ ");
}

static int fails_with(Arena *a, const char *cc, const char *optimise, const char *flag, const char *source, const char *program) {
  const char *const more[] = {optimise, TOOLCHAIN_SCALAR, flag, "-o", program, source, NULL};
  char *said = NULL, *argv[] = {arena_strdup(a, program), NULL};
  if (run_compiler(a, cc, more, &said) != 0) return 0; /* the build itself will report that */
  return process_run(a, argv, &said) == WRONG;
}

const char *probe_flag(Arena *a, const char *cc, const char *optimise, const char *dir, const char **error) {
  static const char *const flags[] = {"", "-march=x86-64-v3"};
  enum { N_FLAGS = sizeof flags / sizeof *flags };
  const char *source = arena_printf(a, "%s/probe.c", dir), *program = arena_printf(a, "%s/probe", dir), *why;
  StrBuf text = strbuf(a);
  size_t found = 0;
  for (size_t i = 0; i < N_LINES; i++) sb_puts(&text, probe_text[i]);
  if (!file_write(source, sb_text(&text), text.n, &why)) return "";
  if (is_suspect(a, cc, source))
    while (found < N_FLAGS && fails_with(a, cc, optimise, flags[found], source, program)) found++;
  remove(source);
  remove(program);
  if (found < N_FLAGS) return flags[found];
  *error = arena_printf(a, "the C compiler `%s` stores wrong numbers, with " TOOLCHAIN_SCALAR " and -march=x86-64-v3 too; set CC to another", cc);
  return NULL;
}
