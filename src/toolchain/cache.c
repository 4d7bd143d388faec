/* The cache of simulators: finds a safe folder, seals entries with checksums, removes the least recently used. */
#include "toolchain/cache.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/hash.h"
#include "base/vec.h"
#include "toolchain/files.h"

enum { LIMIT_MIB = 1024, NAME = 32 }; /* NAME: digits of an entry's name */

/* --- folders --- */

/* The folder at path, made if need be, with write permission of others removed; NULL if others can write there. */
static const char *own_folder(Arena *a, const char *path) {
  struct stat st;
  if (!dir_make(a, path)) return NULL;
  if (lstat(path, &st) == 0 && S_ISDIR(st.st_mode) && st.st_uid == geteuid() && st.st_mode & 022) chmod(path, st.st_mode & 0755);
  return dir_is_safe(path) && access(path, W_OK) == 0 ? path : NULL;
}

static const char *folder_of(Arena *a, const char *variable, const char *below) {
  const char *value = getenv(variable);
  return value && value[0] == '/' ? own_folder(a, arena_printf(a, "%s/%s", value, below)) : NULL;
}

const char *cache_folder(Arena *a) {
  const char *own = arena_printf(a, "lagc-%ld", (long)geteuid()), *dir = folder_of(a, "XDG_CACHE_HOME", "lagc");
  const char *cache = getenv("XDG_CACHE_HOME");
  if (!dir && !(cache && cache[0] == '/')) dir = folder_of(a, "HOME", ".cache/lagc");
  if (!dir) dir = folder_of(a, "TMPDIR", own);
  return dir ? dir : own_folder(a, arena_printf(a, "/tmp/%s", own));
}

/* A temporary folder in which nobody else can replace a new folder of the user's. */
static const char *temporary(Arena *a) {
  const char *const places[] = {getenv("TMPDIR"), "/tmp", "/var/tmp", "."};
  for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
    BuildFolder probe;
    if (!places[i] || !places[i][0] || !build_folder_make(a, places[i], &probe)) continue;
    int safe = dir_is_safe(probe.path);
    build_folder_remove(&probe, NULL);
    if (safe) return places[i];
  }
  return NULL;
}

const char *cache_build_folder(Arena *a) {
  const char *cache = cache_folder(a);
  return cache ? cache : temporary(a);
}

void cache_remove_stale_builds(Arena *a) {
  const char *base = cache_build_folder(a);
  if (base) build_folder_remove_stale(a, base);
}

/* --- entries --- */

/* Size and FNV-1a checksum of a file, as text; NULL when it cannot be read. */
static const char *checksum(Arena *a, const char *path) {
  FILE *f = fopen(path, "rb");
  uint64_t h = FNV1A_START;
  char block[16384];
  long long size = 0;
  if (!f) return NULL;
  for (size_t n; (n = fread(block, 1, sizeof block, f)) > 0; size += (long long)n) h = hash_bytes(h, block, n);
  int bad = ferror(f);
  fclose(f);
  return bad ? NULL : arena_printf(a, "%lld %016llx\n", size, (unsigned long long)h);
}

static const char *seal_of(Arena *a, const char *path) { return arena_printf(a, "%s.sum", path); }

int cache_is_whole(Arena *a, const char *path) {
  char sealed[64] = "";
  const char *seal = seal_of(a, path);
  FILE *f = file_is_own(path) && access(path, X_OK) == 0 && file_is_own(seal) ? fopen(seal, "rb") : NULL;
  if (!f) return 0;
  size_t n = fread(sealed, 1, sizeof sealed - 1, f);
  fclose(f);
  sealed[n] = '\0';
  const char *sum = checksum(a, path);
  int whole = sum && strcmp(sum, sealed) == 0;
  if (whole) utimensat(AT_FDCWD, path, NULL, 0);
  return whole;
}

void cache_seal(Arena *a, const char *path) {
  const char *why, *sum = checksum(a, path);
  if (sum && file_write(seal_of(a, path), sum, strlen(sum), &why)) chmod(seal_of(a, path), 0600);
}

typedef struct {
  const char *path;
  long long size; /* with its seal */
  struct timespec used;
} Entry;
typedef VEC(Entry) Entries;

static int is_entry(const char *name) { return strlen(name) == NAME && strspn(name, "0123456789abcdef") == NAME; }

static int by_age(const void *x, const void *y) {
  const struct timespec *a = &((const Entry *)x)->used, *b = &((const Entry *)y)->used;
  return a->tv_sec != b->tv_sec ? (a->tv_sec > b->tv_sec) - (a->tv_sec < b->tv_sec) : (a->tv_nsec > b->tv_nsec) - (a->tv_nsec < b->tv_nsec);
}

/* All entries, the least recently used first; *total: their size [bytes]. */
static Entries entries(Arena *a, const char *dir, long long *total) {
  Entries all = {0};
  struct stat st, seal;
  DIR *d = dir ? opendir(dir) : NULL;
  *total = 0;
  for (struct dirent *e; d && (e = readdir(d));) {
    const char *path = arena_printf(a, "%s/%s", dir, e->d_name);
    if (!is_entry(e->d_name) || lstat(path, &st) != 0) continue;
    Entry entry = {path, st.st_size + (lstat(seal_of(a, path), &seal) == 0 ? seal.st_size : 0), st.st_mtim};
    vec_push(a, &all, entry);
    *total += entry.size;
  }
  if (d) closedir(d);
  if (all.n) qsort(all.at, all.n, sizeof *all.at, by_age);
  return all;
}

static void remove_entry(Arena *a, const Entry *e) {
  unlink(e->path);
  unlink(seal_of(a, e->path));
}

/* The cache's limit [bytes]: LIMIT_MIB, or LAGC_CACHE_MIB. */
static long long limit(void) {
  const char *text = getenv("LAGC_CACHE_MIB");
  char *end = NULL;
  long mib = text && *text ? strtol(text, &end, 10) : LIMIT_MIB;
  return (long long)(end && (*end || mib < 0 || mib > 1 << 30) ? LIMIT_MIB : mib) << 20;
}

void cache_limit(Arena *a, const char *keep) {
  long long total, most = limit();
  Entries all = entries(a, cache_folder(a), &total);
  for (uint32_t i = 0; i < all.n && total > most; i++) {
    if (strcmp(all.at[i].path, keep) == 0) continue;
    remove_entry(a, &all.at[i]);
    total -= all.at[i].size;
  }
}

static double mib(long long bytes) { return (double)bytes / (1 << 20); }

void cache_print(Arena *a, StrBuf *out) {
  long long total;
  const char *dir = cache_folder(a);
  Entries all = entries(a, dir, &total);
  sb_printf(out, "folder      %s\n", dir ? dir : "none: there is no folder that only you can write; simulators are built anew each time");
  sb_printf(out, "simulators  %u\nsize        %.1f MiB\nlimit       %.0f MiB (LAGC_CACHE_MIB)\n", all.n, mib(total), mib(limit()));
}

void cache_clear(Arena *a, StrBuf *out) {
  long long total;
  Entries all = entries(a, cache_folder(a), &total);
  for (uint32_t i = 0; i < all.n; i++) remove_entry(a, &all.at[i]);
  sb_printf(out, "removed %u simulator%s, %.1f MiB\n", all.n, all.n == 1 ? "" : "s", mib(total));
}
