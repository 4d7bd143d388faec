/* Probes of the C compiler: wrong stores, linkers. */
#include "toolchain/compiler_probe.h"

#include <stdint.h>
#include <stdlib.h>

#include "base/hash.h"
#include "base/posix.h" /* generated: a copy of runtime/io/posix.h */
#include "base/vec.h"
#include "toolchain/files.h"
#include "toolchain/probe_text.h" /* static const char *const probe_text[]: generated from compiler_probe.in */
#include "toolchain/process.h"
#include "toolchain/simulator_cache.h"

enum { N_LINES = sizeof probe_text / sizeof *probe_text, WRONG = 1 };

/* The compiler at work: its words, the program of the probe, where it is compiled to. */
typedef struct {
  Arena *arena;
  const char *cc, *optimise, *source, *program;
} Probe;

int compiler_run(Arena *a, const char *cc, const char *const *more, char **said) {
  VEC(char *) argv = {0};
  for (char *w = strtok(arena_strdup(a, cc), " "); w; w = strtok(NULL, " ")) vec_push(a, &argv, w);
  for (; *more; more++)
    if (**more) vec_push(a, &argv, arena_strdup(a, *more));
  vec_push(a, &argv, NULL);
  return process_run(a, argv.at[0], argv.at, said);
}

/* Whether the compiler is GCC with AVX-512, the only one known to fail; its predefined macros tell, in 10 ms. */
static int is_suspect(const Probe *p) {
  const char *const more[] = {"-dM", "-E", p->source, NULL};
  char *said = NULL;
  return compiler_run(p->arena, p->cc, more, &said) == 0 && strstr(said, "#define __AVX512F__ ") &&
         !strstr(said, "#define __clang__ ");
}

/* Exit status of the probe, compiled with two flags; -1: not compiled, which the build itself will report. */
static int status_with(const Probe *p, const char *flag, const char *other) {
  const char *const more[] = {p->optimise, flag, other, "-o", p->program, p->source, NULL};
  char *said = NULL, *argv[] = {arena_strdup(p->arena, p->program), NULL};
  return compiler_run(p->arena, p->cc, more, &said) == 0 ? process_run(p->arena, p->program, argv, &said) : -1;
}

static const char *find_safe(const Probe *p, const char **error) {
  static const char *const flags[] = {"", "-march=x86-64-v3"};
  enum { N_FLAGS = sizeof flags / sizeof *flags };
  size_t found = 0;
  if (is_suspect(p))
    while (found < N_FLAGS && status_with(p, TOOLCHAIN_SCALAR, flags[found]) == WRONG) found++;
  if (found < N_FLAGS) return flags[found];
  *error = arena_printf(p->arena,
                        "the C compiler `%s` stores wrong numbers, with " TOOLCHAIN_SCALAR
                        " and -march=x86-64-v3 too; set CC to another",
                        p->cc);
  return NULL;
}

/* Linkers for Linux, fastest first (a simulator: gold 26 ms, lld 41, that of binutils 44), unless CC names one. */
static const char *find_linker(const Probe *p) {
#ifdef __linux__
  static const char *const flags[] = {"-fuse-ld=mold", "-fuse-ld=gold", "-fuse-ld=lld"};
  for (size_t i = 0; i < sizeof flags / sizeof *flags && !strstr(p->cc, "-fuse-ld"); i++)
    if (status_with(p, TOOLCHAIN_SCALAR, flags[i]) >= 0) return flags[i];
#else
  (void)p;
#endif
  return "";
}

/* Whether a shared library is linked with a version script: not by tcc. */
static int takes_exports(const Probe *p) {
  static const char script[] = "{ local: *; };\n";
  const char *why, *map = arena_printf(p->arena, "%s.map", p->program);
  const char *flag = arena_printf(p->arena, "-Wl,--version-script=%s", map);
  const char *const more[] = {"-shared", "-fPIC", flag, "-o", p->program, p->source, NULL};
  char *said = NULL;
  int takes = file_write(map, script, strlen(script), &why);
  takes = takes && compiler_run(p->arena, p->cc, more, &said) == 0;
  remove(map);
  return takes;
}

const char *compiler_file(Arena *a, const char *cc) {
  const char *word = arena_strndup(a, cc, strcspn(cc, " ")), *path = getenv("PATH");
  if (strpbrk(word, "/\\")) return file_exists(word) ? word : NULL;
  for (size_t n; path && *path; path += n + (path[n] != '\0')) {
    n = strcspn(path, PATH_SEPARATOR);
    const char *file = arena_printf(a, "%.*s/%s" PROGRAM_SUFFIX, (int)n, path, word);
    if (file_exists(file)) return file;
  }
  return NULL;
}

/* The entry of this compiler, in the cache around the build folder: its words, its file, and what it says its version
 * is; NULL: it says none. */
static const char *entry_of(Arena *a, const char *cc, const char *optimise, const char *dir) {
  static const char *const more[] = {"--version", NULL};
  char *said = NULL;
  if (compiler_run(a, cc, more, &said) != 0) return NULL;
  const char *path = compiler_file(a, cc), *file = file_identity(a, path ? path : cc);
  const char *is = arena_printf(a, "%s %s\n%s\n%s\nexports", cc, optimise, file, said);
  uint64_t h1 = lag_fnv1a(LAG_FNV1A_START, is, strlen(is)),
           h2 = lag_fnv1a(UINT64_C(0x9e3779b97f4a7c15), is, strlen(is));
  return arena_printf(a, "%.*s/%016llx%016llx.cc", (int)(strrchr(dir, '/') - dir), dir, (unsigned long long)h1,
                      (unsigned long long)h2);
}

static int recall(Arena *a, const char *entry, CompilerTraits *t) {
  StrBuf text = strbuf(a);
  if (!entry || !cache_read(entry, &text)) return 0;
  const char *lines = sb_text(&text);
  size_t n = strcspn(lines, "\n");
  t->safe = arena_strndup(a, lines, n);
  lines += n + 1;
  n = strcspn(lines, "\n");
  t->linker = arena_strndup(a, lines, n);
  t->exports = lines[n] == '\n' && lines[n + 1] == 'e';
  return 1;
}

int compiler_probe(Arena *a, const char *cc, const char *optimise, const char *dir, CompilerTraits *t,
                   const char **error) {
  Probe p = {a, cc, optimise, arena_printf(a, "%s/probe.c", dir), arena_printf(a, "%s/probe", dir)};
  StrBuf text = strbuf(a), kept = strbuf(a);
  const char *entry = entry_of(a, cc, optimise, dir), *why;
  *t = (CompilerTraits){"", "", 1};
  if (recall(a, entry, t)) return 1;
  for (size_t i = 0; i < N_LINES; i++) sb_puts(&text, probe_text[i]);
  if (!file_write(p.source, sb_text(&text), text.n, &why)) return 1;
  if ((t->safe = find_safe(&p, error)) != NULL) t->linker = find_linker(&p), t->exports = takes_exports(&p);
  remove(p.source);
  remove(p.program);
  sb_printf(&kept, "%s\n%s\n%s\n", t->safe ? t->safe : "", t->linker, t->exports ? "exports" : "");
  if (t->safe && entry) cache_write(entry, &kept);
  return t->safe != NULL;
}
