/* Finds the runtime, runs the C compiler in a folder of its own, and keeps simulators in the cache under a hash of
 * their texts. */
#include "toolchain/toolchain.h"

#include <errno.h>
#include <limits.h>
#include <stdint.h>

#include "base/hash.h"
#include "base/posix.h" /* generated: a copy of runtime/io/posix.h */
#include "base/vec.h"
#include "numeric/functions.def"
#include "numeric/program_code.def"
#include "toolchain/compiler_probe.h"
#include "toolchain/simulator_cache.h"
#include "toolchain/files.h"
#include "toolchain/process.h"

/* The program that the compiler makes. Compilers for Windows would append .exe to a name without it. */
#define SIMULATOR "simulator.exe"

/* --- finding the runtime --- */

const char *toolchain_own_folder(Arena *a, const char *argv0) {
  char path[PATH_MAX];
  long n = lag_own_path(path, sizeof path - 1);
  if (n > 0) path[n] = '\0';
  else if (!realpath(argv0, path)) return ".";
  char *slash = strrchr(path, '/');
  if (slash) *slash = '\0';
  return arena_strdup(a, path);
}

static int try_place(Arena *a, const char *lib, const char *include, Toolchain *t) {
  if (!file_exists(arena_printf(a, "%s/liblag.a", lib)) || !file_exists(arena_printf(a, "%s/lag.h", include))) return 0;
  t->lib = lib;
  t->include = include;
  return 1;
}

/* The path of an installed folder, which the Makefile gives from lagc's own folder on, or whole. */
static const char *installed(Arena *a, const char *own, const char *folder) {
  return lag_is_absolute(folder) ? folder : arena_printf(a, "%s/%s", own, folder);
}

/* $LAGC_OPTIMISE, -O0 to -O3; -O2 when it is not set; NULL when it is something else. */
static const char *optimisation(void) {
  const char *o = getenv("LAGC_OPTIMISE");
  if (!o || !o[0]) return "-O2";
  return o[0] == '-' && o[1] == 'O' && o[2] >= '0' && o[2] <= '3' && !o[3] ? o : NULL;
}

int toolchain_compiler(Arena *a, Toolchain *t, const char **error) {
  const char *cc = getenv("CC");
  static const char *const none[] = {NULL};
  *t = (Toolchain){.cc = cc && cc[0] ? cc : DEFAULT_CC, .optimise = optimisation(), .flags = none};
  return t->optimise ? 1
                     : fail_with(error, arena_printf(a, "LAGC_OPTIMISE is %s; it takes -O0, -O1, -O2 or -O3",
                                                     getenv("LAGC_OPTIMISE")));
}

int toolchain_find(Arena *a, const char *argv0, int want_gsl, Toolchain *t, const char **error) {
  const char *home = getenv("LAG_HOME"), *own = toolchain_own_folder(a, argv0);
  int found = 0;
  if (!toolchain_compiler(a, t, error)) return 0;
  t->library = "lag";
  if (home && home[0]) {
    found = try_place(a, arena_printf(a, "%s/lib", home), arena_printf(a, "%s/include", home), t);
    if (!found)
      return fail_with(error,
                       arena_printf(a, "LAG_HOME is %s, where lib/liblag.a and include/lag.h are not found", home));
  }
  found = found || try_place(a, own, arena_printf(a, "%s/../runtime/include", own), t);
  found = found || try_place(a, installed(a, own, LAGC_LIBDIR), installed(a, own, LAGC_INCLUDEDIR), t);
  if (!found)
    return fail_with(
        error,
        arena_printf(a, "the runtime (liblag.a and lag.h) is not found beside %s; run `make`, or set LAG_HOME", own));
  t->gsl = want_gsl && file_exists(arena_printf(a, "%s/liblag_gsl.a", t->lib));
  return 1;
}

const char *toolchain_part(Arena *a, const Toolchain *t, const char *part) {
  StrBuf words = strbuf(a);
  const char *error;
  if (!file_append(arena_printf(a, "%s/liblag_%s.libs", t->lib, part), &words, &error)) return NULL;
  return arena_printf(a, "-llag_%s %.*s", part, (int)strcspn(sb_text(&words), "\n"), sb_text(&words));
}

void toolchain_scalar(Toolchain *t, const char *precision) {
  static const char *const of_long[] = {"-DLAG_REAL=long double", "-DLAG_FN(x)=x##l",      "-DLAG_C(x)=x##L",
                                        "-DLAG_NUMBER(x)=x##L",   "-DLAG_TAYLOR_ORDER=48", NULL};
  static const char *const of_quad[] = {"-std=gnu11",
                                        "-include", "quadmath.h", "-DLAG_REAL=__float128", "-DLAG_FN(x)=x##q",
                                        "-DLAG_C(x)=x##Q", "-DLAG_NUMBER(x)=x##Q", "-DLAG_TAYLOR_ORDER=64",
                                        NULL};
  int quad = strcmp(precision, "quad") == 0;
  t->flags = quad ? of_quad : of_long;
  t->needs = quad ? "-lquadmath" : NULL;
  t->gsl = 0;
}

int toolchain_precision(Arena *a, Toolchain *t, const char *precision, const char **error) {
  if (strcmp(precision, "double") == 0) return 1;
  toolchain_scalar(t, precision);
  t->library = arena_printf(a, "lag_%s", precision);
  t->include = arena_printf(a, "%s/lag-%s", t->lib, precision);
  if (file_exists(arena_printf(a, "%s/lib%s.a", t->lib, t->library))) return 1;
  return fail_with(error,
                   arena_printf(a, "--precision %s: %s/lib%s.a is not there; `make precisions` builds it%s", precision,
                                t->lib, t->library, t->needs ? ", where the C compiler has libquadmath" : ""));
}

/* --- running the compiler; a toolchain without the runtime makes shared libraries --- */

/* A library of the text alone, without the runtime. */
static int is_alone(const Toolchain *t) { return t->soname && !t->library; }

/* File that the compiler makes in a build folder. */
static const char *made_in(Arena *a, const Toolchain *t, const char *dir) {
  return arena_printf(a, "%s/%s", dir, t->soname ? "library.so" : SIMULATOR);
}

/* Without a name gold writes the path of the build folder into the library. */
#ifdef __APPLE__
#define SONAME_FLAG(a, name) ""
#else
#define SONAME_FLAG(a, name) arena_printf(a, "-Wl,-soname,%s", name)
#endif

/* Flags that keep the time and a hash of the build folder's path out of a library for Windows. */
static const char *steady_flags(Arena *a, const Toolchain *t) {
  return strstr(toolchain_machine(a, t), "mingw") ? "-Wl,--no-insert-timestamp,--disable-auto-image-base" : "";
}

/* Of models that are also compiled for lanes: all of a program has them, so that a double gets the bits of a lane. */
#ifdef __x86_64__
static const char *const lane_flags[] = {"-mavx2", "-mfma", NULL};
int toolchain_has_lanes(void) { return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"); }
#elif defined(__aarch64__)
static const char *const lane_flags[] = {NULL};
int toolchain_has_lanes(void) { return 1; }
#else
static const char *const lane_flags[] = {NULL};
int toolchain_has_lanes(void) { return 0; }
#endif

typedef VEC(const char *) Words;
#define PUSH(list) push(a, &words, list, sizeof(list) / sizeof *(list))
static void push(Arena *a, Words *words, const char *const *list, size_t n) {
  for (size_t i = 0; i < n; i++) vec_push(a, words, list[i]);
}

/* Calls of the C library on constants are not folded: compilers round them in their own way, cbrt(2) and sinh(2) not
 * as the library does, which evaluated programs call. */
#define UNFOLDED(OP, name, ...) "-fno-builtin-" #name,
#define UNFOLDED_2(name) "-fno-builtin-" #name,
static const char *const unfolded[] = {FUNCTIONS(UNFOLDED) PROGRAM_FUNCTIONS_2(UNFOLDED_2)};

/* Macro LAG_BUILD: how the program was compiled. */
static const char *build_macro(Arena *a, const Toolchain *t, const char *safe) {
  char *build = arena_printf(a, "-DLAG_BUILD=\"%s %s -std=c11 -ffp-contract=off " TOOLCHAIN_SCALAR "%s%s%s\"", t->cc,
                             t->optimise, t->threads ? " -fopenmp" : "", *safe ? " " : "", safe);
  for (char *c = build + strlen("-DLAG_BUILD=\""); c[1]; c++)
    if (*c == '"' || *c == '\\') *c = ' ';
  return build;
}

/* Compiles and links with the flags that the simulator reports as LAG_BUILD: no contraction (same bits with and
 * without fused multiply-add), no vector stores, and the flag of the probe. */
static const char *const *compiler_words(Arena *a, const Toolchain *t, const char *dir, const CompilerTraits *is,
                                         const SourceText *texts, size_t n) {
  int alone = is_alone(t), single = alone && !t->models,
      links_sines = !alone && !t->lanes && strcmp(t->library, "lag") == 0;
  const char *archive = arena_printf(a, "%s/lib%s.a", t->lib, t->library);
  const char *first[] = {t->optimise, "-std=c11", "-ffp-contract=off", TOOLCHAIN_SCALAR, "-o", made_in(a, t, dir)};
  const char *runtime[] = {build_macro(a, t, is->safe), links_sines ? "-DLAG_LINKED_SINES" : "", "-I", t->include};
  const char *same = t->models ? "-DLAG_NO_FMA" : ""; /* sines with the evaluator's bits, whatever the options of CC */
  const char *library[] = {"-shared", "-fPIC", SONAME_FLAG(a, t->soname ? t->soname : ""), same},
             *hidden[] = {"-fvisibility=hidden", "-s", alone ? steady_flags(a, t) : ""};
  const char *exports = is->exports ? arena_printf(a, "-Wl,--version-script=%s/exports.map", dir) : "";
  const char *whole[] = {"-Wl,-Bsymbolic", exports, "-Wl,--whole-archive", archive, "-Wl,--no-whole-archive"};
  const char *last[] = {t->gsl ? "-llag_gsl" : "", t->soname ? "" : archive,    t->gsl ? "-lgsl" : "",
                        t->gsl ? "-lgslcblas" : "", t->needs ? t->needs : "", "-lm", NULL};
  const char *threads[] = {"-fopenmp", arena_printf(a, "-DLAG_THREADS=%ld", t->threads)};
  Words words = {0};
  PUSH(first);
  if (t->threads) PUSH(threads);
  PUSH(unfolded);
  if (!single) PUSH(runtime);
  if (t->soname) PUSH(library);
  if (single) PUSH(hidden);
  for (const char *const *f = t->flags; *f; f++) vec_push(a, &words, *f);
  for (const char *const *f = lane_flags; t->lanes && *f; f++) vec_push(a, &words, *f);
  vec_push(a, &words, is->safe);
  if (!t->soname) vec_push(a, &words, is->linker);
  for (size_t i = single ? n - 1 : 0; i < n; i++) vec_push(a, &words, arena_printf(a, "%s/%s", dir, texts[i].name));
  if (t->soname && !alone) PUSH(whole);
  vec_push(a, &words, alone ? "" : arena_printf(a, "-L%s", t->lib));
  for (int i = 0; i < 3; i++)
    for (char *w = t->parts[i] ? strtok(arena_strdup(a, t->parts[i]), " ") : NULL; w; w = strtok(NULL, " "))
      vec_push(a, &words, w);
  PUSH(last);
  return words.at;
}

static int compile(Arena *a, const Toolchain *t, const char *dir, const SourceText *texts, size_t n,
                   const char **error) {
  CompilerTraits is;
  char *said = NULL;
  if (!compiler_probe(a, t->cc, t->optimise, dir, &is, error)) return 0;
  int status = compiler_run(a, t->cc, compiler_words(a, t, dir, &is, texts, n), &said);
  if (status == 0) return 1;
  if (status == 127)
    *error = arena_printf(a, "the C compiler `%s` cannot be run; install one (gcc or clang), or set CC", t->cc);
  else if (t->needs && said && strstr(said, "quadmath"))
    *error = arena_printf(
        a,
        "quadruple precision needs libquadmath, which comes with gcc; the C compiler `%s` does not find it: set CC=gcc",
        t->cc);
  else if (t->threads && said && (strstr(said, "omp") || strstr(said, "openmp") || strstr(said, "OpenMP")))
    *error = arena_printf(a,
                          "--threads needs OpenMP, which the C compiler `%s` does not have: `apt-get install %s`, or "
                          "set CC to another, or leave --threads out",
                          t->cc, strstr(t->cc, "clang") ? "libomp-dev" : "gcc libgomp1");
  else *error = arena_printf(a, "the C compiler `%s` failed:\n%s", t->cc, said ? said : "");
  return 0;
}

/* Compiles with the variable of temporary files set to the build folder, so that the compiler's temporary files are
 * removed with it. */
static int compile_with_tmpdir(Arena *a, const Toolchain *t, const char *dir, const SourceText *texts, size_t n,
                               const char **error) {
  const char *was = getenv(TEMPORARY_FOLDER), *before = was ? arena_strdup(a, was) : NULL;
  setenv(TEMPORARY_FOLDER, dir, 1);
  int ok = compile(a, t, dir, texts, n, error);
  if (before) setenv(TEMPORARY_FOLDER, before, 1);
  else unsetenv(TEMPORARY_FOLDER);
  return ok;
}

static const char *cannot_write(Arena *a, const char *folder, const char *why) {
  return arena_printf(a, "cannot write in %s: %s; make room, or set XDG_CACHE_HOME to another folder", folder, why);
}

/* Compiles in a new build folder, which stays only on success, with made_in of f->path. */
static int build(Arena *a, const Toolchain *t, const SourceText *texts, size_t n, BuildFolder *f, const char **error) {
  const char *base = cache_folder(a);
  if (!base)
    return fail_with(error, "there is no folder to build in that only you can write: set XDG_CACHE_HOME to one");
  if (!build_folder_make(a, base, f)) return fail_with(error, cannot_write(a, base, strerror(errno)));
  /* a shared library shows the functions of lag.h only */
  static const char exports[] = "{ global: lag_*; local: *; };\n";
  const char *why;
  int ok = !t->soname || is_alone(t) ||
           file_write(arena_printf(a, "%s/exports.map", f->path), exports, strlen(exports), &why);
  for (size_t i = 0; i < n && ok; i++)
    ok = file_write(arena_printf(a, "%s/%s", f->path, texts[i].name), texts[i].text, strlen(texts[i].text), &why);
  if (!ok) *error = cannot_write(a, f->path, why);
  ok = ok && compile_with_tmpdir(a, t, f->path, texts, n, error);
  if (ok && !file_exists(made_in(a, t, f->path))) {
    *error = arena_printf(a, "cannot write %s: the C compiler `%s` wrote no file", made_in(a, t, f->path), t->cc);
    ok = 0;
  }
  if (!ok) build_folder_remove(f);
  return ok;
}

int toolchain_build(Arena *a, const Toolchain *t, const SourceText *texts, size_t n, const char *output,
                    const char **error) {
  struct stat st;
  BuildFolder f;
  const char *why;
  if (stat(output, &st) == 0 && !S_ISREG(st.st_mode))
    return fail_with(error, arena_printf(a, "cannot write %s: it is not an ordinary file", output));
  if (!build(a, t, texts, n, &f, error)) return 0;
  int ok = file_install(output, made_in(a, t, f.path), &why);
  if (!ok) *error = arena_printf(a, "cannot write %s: %s", output, why);
  build_folder_remove(&f);
  return ok;
}

int toolchain_run_once(Arena *a, const Toolchain *t, const SourceText *texts, size_t n, OneRun *run) {
  BuildFolder f;
  if (!build(a, t, texts, n, &f, &run->error)) return 0;
  char *path = arena_printf(a, "%s/" SIMULATOR, f.path), *argv[] = {path, NULL};
  run->status = process_read_from(run->in) ? process_to_file(path, argv, run->out) : -1;
  build_folder_remove(&f);
  return 1;
}

const char *toolchain_machine(Arena *a, const Toolchain *t) {
  const char *const more[] = {"-dumpmachine", NULL};
  char *said = NULL;
  return compiler_run(a, t->cc, more, &said) == 0 ? said : "";
}

int toolchain_library(Arena *a, const Toolchain *t, const SourceText *texts, size_t n, StrBuf *out,
                      const char **error) {
  BuildFolder f;
  const char *why;
  if (!build(a, t, texts, n, &f, error)) return 0;
  int ok = file_append(made_in(a, t, f.path), out, &why);
  if (!ok) *error = arena_printf(a, "cannot read %s: %s", made_in(a, t, f.path), why);
  build_folder_remove(&f);
  return ok;
}

/* --- simulators in the cache --- */

const char *toolchain_evaluator(Arena *a, const Toolchain *t) {
  const char *path = arena_printf(a, "%s/lag-run" PROGRAM_SUFFIX, t->lib);
  return file_exists(path) ? path : NULL;
}

static uint64_t hash_library(Arena *a, uint64_t h, const char *path) {
  const char *text = file_identity(a, path);
  return lag_fnv1a(h, text, strlen(text));
}

static const char *const part_names[] = {"png", "hdf5", "mpi"};

const char *toolchain_own_build(Arena *a, const Toolchain *t, const char *argv0) {
  char path[PATH_MAX];
  long n = lag_own_path(path, sizeof path - 1);
  const char *text = file_identity(a, n > 0 ? arena_strndup(a, path, (size_t)n) : argv0);
  for (int i = 0; i < 3; i++)
    text = arena_printf(a, "%s\n%s", text, file_identity(a, arena_printf(a, "%s/liblag_%s.a", t->lib, part_names[i])));
  return text;
}

static uint64_t hash_all(Arena *a, uint64_t h, const Toolchain *t, const SourceText *texts, size_t n) {
  for (size_t i = 0; i < n; i++) h = lag_fnv1a(h, texts[i].text, strlen(texts[i].text) + 1);
  h = lag_fnv1a(h, t->cc, strlen(t->cc) + 1);
  h = lag_fnv1a(h, t->optimise, strlen(t->optimise) + 1);
  if (t->threads) h = lag_fnv1a(h, (const char *)&t->threads, sizeof t->threads);
  h = hash_library(a, h, t->models ? toolchain_evaluator(a, t) : arena_printf(a, "%s/lib%s.a", t->lib, t->library));
  for (int i = 0; i < 3; i++)
    if (t->parts[i]) h = hash_library(a, h, arena_printf(a, "%s/liblag_%s.a", t->lib, part_names[i]));
  return t->gsl ? hash_library(a, h, arena_printf(a, "%s/liblag_gsl.a", t->lib)) : h;
}

const char *toolchain_entry(Arena *a, const Toolchain *t, const SourceText *texts, size_t n) {
  uint64_t h1 = hash_all(a, LAG_FNV1A_START, t, texts, n), h2 = hash_all(a, 0x9e3779b97f4a7c15u, t, texts, n);
  return arena_printf(a, "%016llx%016llx", (unsigned long long)h1, (unsigned long long)h2);
}

int toolchain_has_compiler(Arena *a, const Toolchain *t) { return compiler_file(a, t->cc) != NULL; }

/* Whether the file begins as the running program does: with the mark of ELF, Mach-O, PE. */
static int is_program(const char *path) {
  char own[PATH_MAX], mark[2][4] = {{0}};
  long n = lag_own_path(own, sizeof own - 1);
  own[n > 0 ? n : 0] = '\0';
  const char *const paths[] = {own, path};
  for (int k = 0; k < 2; k++) {
    FILE *f = fopen(paths[k], "rb");
    size_t got = f ? fread(mark[k], 1, sizeof mark[k], f) : 0;
    if (f) fclose(f);
    if (got < sizeof mark[k]) return k == 0; /* nothing to compare with */
  }
  return memcmp(mark[0], mark[1], sizeof mark[0]) == 0;
}

const char *toolchain_simulator(Arena *a, const Toolchain *t, const SourceText *texts, size_t n, const char **error) {
  const char *cache = cache_folder(a),
             *path = cache ? arena_printf(a, "%s/%s", cache, toolchain_entry(a, t, texts, n)) : NULL;
  BuildFolder f;
  if (path && cache_has(path)) return path;
  int lock = path ? cache_take(a, path) : -1, there = lock >= 0 && cache_has(path), ok = there;
  if (!there && build(a, t, texts, n, &f, error)) {
    const char *made = made_in(a, t, f.path);
    int right = is_program(made);
    ok = right && cache_seal(made) && chmod(made, 0700) == 0 && rename(made, path) == 0;
    if (!right) *error = arena_printf(a, "the C compiler `%s` wrote no program of this machine", t->cc);
    else if (!ok) *error = arena_printf(a, "cannot write %s: %s", path, strerror(errno));
    build_folder_remove(&f);
    if (ok) cache_limit(a, path);
  }
  if (path) cache_give(a, path, lock);
  return ok ? path : NULL;
}
