#include "cli/toolchain.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/vec.h"
#include "cli/files.h"
#include "cli/probe.h"

/* --- finding the runtime --- */

/* The folder of the running executable. */
static const char *own_folder(Arena *a, const char *argv0) {
  char path[PATH_MAX];
  ssize_t n = readlink("/proc/self/exe", path, sizeof path - 1);
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

int toolchain_find(Arena *a, const char *argv0, int want_gsl, Toolchain *t, const char **error) {
  const char *cc = getenv("CC"), *home = getenv("LAG_HOME"), *own = own_folder(a, argv0);
  static const char *const none[] = {NULL};
  *t = (Toolchain){.cc = cc && cc[0] ? cc : "cc", .optimise = "-O2", .library = "lag", .flags = none};
  int found = 0;
  if (home && home[0]) {
    found = try_place(a, arena_printf(a, "%s/lib", home), arena_printf(a, "%s/include", home), t);
    if (!found) {
      *error = arena_printf(a, "LAG_HOME is %s, where lib/liblag.a and include/lag.h are not found", home);
      return 0;
    }
  }
  found = found || try_place(a, own, arena_printf(a, "%s/../runtime/include", own), t);
  found = found || try_place(a, arena_printf(a, "%s/../lib", own), arena_printf(a, "%s/../include", own), t);
  if (!found) {
    *error = arena_printf(a, "the runtime (liblag.a and lag.h) is not found beside %s; run `make`, or set LAG_HOME", own);
    return 0;
  }
  t->gsl = want_gsl && file_exists(arena_printf(a, "%s/liblag_gsl.a", t->lib));
  return 1;
}

int toolchain_precision(Arena *a, Toolchain *t, const char *precision, const char **error) {
  static const char *const of_long[] = {"-DLAG_REAL=long double", "-DLAG_FN(x)=x##l", "-DLAG_C(x)=x##L", "-DLAG_NUMBER(x)=x##L",
                                        "-DLAG_TAYLOR_ORDER=48", NULL};
  static const char *const of_quad[] = {"-std=gnu11", "-include", "quadmath.h", "-DLAG_REAL=__float128", "-DLAG_FN(x)=x##q", "-DLAG_C(x)=x##Q",
                                        "-DLAG_NUMBER(x)=x##Q", "-DLAG_TAYLOR_ORDER=64", NULL};
  int quad = strcmp(precision, "quad") == 0;
  if (strcmp(precision, "double") == 0) return 1;
  t->library = arena_printf(a, "lag_%s", precision);
  t->flags = quad ? of_quad : of_long;
  t->needs = quad ? "-lquadmath" : NULL;
  t->gsl = 0;
  t->include = arena_printf(a, "%s/lag-%s", t->lib, precision);
  if (file_exists(arena_printf(a, "%s/lib%s.a", t->lib, t->library))) return 1;
  *error = arena_printf(a, "--precision %s: %s/lib%s.a is not there: this lagc was built without it%s", precision, t->lib, t->library,
                        quad ? ", as where the C compiler has no libquadmath" : "");
  return 0;
}

/* --- running the compiler --- */

static char *read_fd(Arena *a, int fd) {
  StrBuf b = strbuf(a);
  char buffer[4096];
  for (ssize_t n; (n = read(fd, buffer, sizeof buffer)) != 0;) {
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) break;
    sb_putn(&b, buffer, (size_t)n);
  }
  return arena_strdup(a, sb_text(&b));
}

int toolchain_run(Arena *a, char *const *argv, char **said) { return toolchain_run_as(a, argv[0], argv, said); }

int toolchain_run_as(Arena *a, const char *path, char *const *argv, char **said) {
  int pipe_fd[2];
  if (pipe(pipe_fd) != 0) return -1;
  pid_t pid = fork();
  if (pid == 0) {
    dup2(pipe_fd[1], 1);
    dup2(pipe_fd[1], 2);
    close(pipe_fd[0]);
    close(pipe_fd[1]);
    execvp(path, argv);
    _exit(127);
  }
  close(pipe_fd[1]);
  *said = pid > 0 ? read_fd(a, pipe_fd[0]) : arena_strdup(a, "");
  close(pipe_fd[0]);
  int status = 0;
  if (pid < 0 || waitpid(pid, &status, 0) < 0) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

int toolchain_to_stdin(const char *path, char *const *argv) {
  FILE *out = tmpfile();
  pid_t pid = out ? fork() : -1;
  if (pid == 0) {
    dup2(fileno(out), 1);
    if (!freopen("/dev/null", "w", stderr)) _exit(127);
    execv(path, argv);
    _exit(127);
  }
  int status = -1;
  if (pid > 0 && waitpid(pid, &status, 0) == pid) status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  if (status == 0 && (lseek(fileno(out), 0, SEEK_SET) != 0 || dup2(fileno(out), 0) != 0)) status = -1;
  if (out) fclose(out);
  return status;
}

static void remove_folder(Arena *a, const char *dir, const SourceText *texts, size_t n) {
  for (size_t i = 0; i < n; i++) remove(arena_printf(a, "%s/%s", dir, texts[i].name));
  remove(arena_printf(a, "%s/simulator", dir));
  rmdir(dir);
}

Words toolchain_words(Arena *a, const char *cc) {
  Words words = {0};
  char *text = arena_strdup(a, cc);
  for (char *w = strtok(text, " "); w; w = strtok(NULL, " ")) vec_push(a, &words, w);
  return words;
}

/* With the flags that the simulator reports as LAG_BUILD: bits that do not depend on whether a processor multiplies and adds in
 * one instruction, numbers stored one by one, and what the compiler needs not to go wrong. */
static int compile(Arena *a, const Toolchain *t, const char *dir, const SourceText *texts, size_t n, const char **error) {
  Words argv = toolchain_words(a, t->cc);
  const char *safe = probe_flag(a, t->cc, t->optimise, dir, error);
  if (!safe) return 0;
  char *build = arena_printf(a, "-DLAG_BUILD=\"%s %s -std=c11 -ffp-contract=off " TOOLCHAIN_SCALAR "%s%s\"", t->cc, t->optimise, *safe ? " " : "", safe);
  for (char *c = build + strlen("-DLAG_BUILD=\""); c[1]; c++)
    if (*c == '"' || *c == '\\') *c = ' ';
  const char *fixed[] = {t->optimise, "-std=c11", "-ffp-contract=off", TOOLCHAIN_SCALAR, build, "-I", t->include, "-o", arena_printf(a, "%s/simulator", dir)};
  for (size_t i = 0; i < sizeof fixed / sizeof *fixed; i++) vec_push(a, &argv, arena_strdup(a, fixed[i]));
  for (const char *const *f = t->flags; *f; f++) vec_push(a, &argv, arena_strdup(a, *f));
  if (*safe) vec_push(a, &argv, arena_strdup(a, safe));
  for (size_t i = 0; i < n; i++) vec_push(a, &argv, arena_printf(a, "%s/%s", dir, texts[i].name));
  vec_push(a, &argv, arena_printf(a, "-L%s", t->lib));
  if (t->gsl) vec_push(a, &argv, arena_strdup(a, "-llag_gsl"));
  vec_push(a, &argv, arena_printf(a, "-l%s", t->library));
  if (t->gsl) {
    vec_push(a, &argv, arena_strdup(a, "-lgsl"));
    vec_push(a, &argv, arena_strdup(a, "-lgslcblas"));
  }
  if (t->needs) vec_push(a, &argv, arena_strdup(a, t->needs));
  vec_push(a, &argv, arena_strdup(a, "-lm"));
  vec_push(a, &argv, NULL);
  char *said = NULL;
  int status = toolchain_run(a, argv.at, &said);
  if (status == 0) return 1;
  if (status == 127) *error = arena_printf(a, "the C compiler `%s` cannot be run; install one (gcc or clang), or set CC", t->cc);
  else if (t->needs && said && strstr(said, "quadmath"))
    *error = arena_printf(a, "quadruple precision needs libquadmath, which comes with gcc; the C compiler `%s` does not find it: set CC=gcc", t->cc);
  else *error = arena_printf(a, "the C compiler `%s` failed:\n%s", t->cc, said ? said : "");
  return 0;
}

int toolchain_build(Arena *a, const Toolchain *t, const SourceText *texts, size_t n, const char *output, const char **error) {
  struct stat st;
  if (stat(output, &st) == 0 && !S_ISREG(st.st_mode)) {
    *error = arena_printf(a, "cannot write %s: it is no ordinary file", output);
    return 0;
  }
  char *dir = arena_printf(a, "%s.XXXXXX", output); /* beside the output: the last step is a rename */
  if (!mkdtemp(dir)) {
    *error = arena_printf(a, "cannot write beside %s: %s", output, strerror(errno));
    return 0;
  }
  int ok = 1;
  for (size_t i = 0; i < n && ok; i++) {
    const char *why;
    ok = file_write(a, arena_printf(a, "%s/%s", dir, texts[i].name), texts[i].text, strlen(texts[i].text), &why);
    if (!ok) *error = arena_printf(a, "cannot write in %s: %s", dir, why);
  }
  ok = ok && compile(a, t, dir, texts, n, error);
  if (ok && rename(arena_printf(a, "%s/simulator", dir), output) != 0) {
    *error = arena_printf(a, "cannot write %s: %s", output, strerror(errno));
    ok = 0;
  }
  remove_folder(a, dir, texts, n);
  return ok;
}

/* --- the cache --- */

static uint64_t hash_more(uint64_t h, const char *s, size_t n) {
  for (size_t i = 0; i < n; i++) h = (h ^ (unsigned char)s[i]) * 1099511628211u;
  return h;
}

/* A library is known by its size and time. */
static uint64_t hash_library(Arena *a, uint64_t h, const char *path) {
  struct stat st;
  if (stat(path, &st) != 0) return h;
  const char *text = arena_printf(a, "%s %lld %lld.%09ld", path, (long long)st.st_size, (long long)st.st_mtim.tv_sec, st.st_mtim.tv_nsec);
  return hash_more(h, text, strlen(text));
}

static uint64_t hash_all(Arena *a, uint64_t h, const Toolchain *t, const SourceText *texts, size_t n) {
  for (size_t i = 0; i < n; i++) h = hash_more(h, texts[i].text, strlen(texts[i].text) + 1);
  h = hash_more(h, t->cc, strlen(t->cc) + 1);
  h = hash_more(h, t->optimise, strlen(t->optimise) + 1);
  h = hash_library(a, h, arena_printf(a, "%s/lib%s.a", t->lib, t->library));
  return t->gsl ? hash_library(a, h, arena_printf(a, "%s/liblag_gsl.a", t->lib)) : h;
}

/* The size of a file and a checksum of what is in it, as text; NULL when it cannot be read. */
static const char *checksum(Arena *a, const char *path) {
  FILE *f = fopen(path, "rb");
  uint64_t h = 1469598103934665603u;
  char block[16384];
  long long size = 0;
  if (!f) return NULL;
  for (size_t n; (n = fread(block, 1, sizeof block, f)) > 0; size += (long long)n) h = hash_more(h, block, n);
  int bad = ferror(f);
  fclose(f);
  return bad ? NULL : arena_printf(a, "%lld %016llx\n", size, (unsigned long long)h);
}

static const char *seal_of(Arena *a, const char *path) { return arena_printf(a, "%s.sum", path); }

int toolchain_is_whole(Arena *a, const char *path) {
  char sealed[64] = "";
  FILE *f = file_runs(path) ? fopen(seal_of(a, path), "rb") : NULL;
  if (!f) return 0;
  size_t n = fread(sealed, 1, sizeof sealed - 1, f);
  fclose(f);
  sealed[n] = '\0';
  const char *sum = checksum(a, path);
  return sum && strcmp(sum, sealed) == 0;
}

void toolchain_seal(Arena *a, const char *path) {
  const char *why, *sum = checksum(a, path);
  if (sum) file_write(a, seal_of(a, path), sum, strlen(sum), &why);
}

const char *toolchain_cached(Arena *a, const Toolchain *t, const SourceText *texts, size_t n) {
  const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME"), *tmp = getenv("TMPDIR");
  const char *dir = cache && cache[0] == '/' ? arena_printf(a, "%s/lagc", cache)
                  : home && home[0] == '/' ? arena_printf(a, "%s/.cache/lagc", home) : NULL;
  if (!dir || !dir_make(a, dir) || access(dir, W_OK) != 0) {
    dir = arena_printf(a, "%s/lagc-%ld", tmp && tmp[0] ? tmp : "/tmp", (long)getuid());
    struct stat st;
    /* what lies there is run: it must be ours */
    if ((mkdir(dir, 0700) != 0 && errno != EEXIST) || lstat(dir, &st) != 0 || !S_ISDIR(st.st_mode) || st.st_uid != getuid()) {
      char *own = arena_printf(a, "%s.XXXXXX", dir);
      if (mkdtemp(own)) dir = own;
    }
  }
  uint64_t h1 = hash_all(a, 1469598103934665603u, t, texts, n), h2 = hash_all(a, 0x9e3779b97f4a7c15u, t, texts, n);
  return arena_printf(a, "%s/%016llx%016llx", dir, (unsigned long long)h1, (unsigned long long)h2);
}
