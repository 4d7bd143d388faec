/* The cache of simulators: finds a safe folder, makes locked folders for builds there, removes the least recently
 * used entries. */
#include "toolchain/simulator_cache.h"

#include <inttypes.h>
#include <stdio.h>

#include "base/hash.h"
#include "base/posix.h" /* generated: a copy of runtime/io/posix.h */
#include "base/vec.h"
#include "toolchain/files.h"
#include "toolchain/outfile.h" /* generated: a copy of runtime/io/outfile.h */

/* digits of an entry's name; those of a reference follow after a dot */
enum { LIMIT_MIB = 1024, NAME = 32, SUFFIX = 9 };

/* --- folders --- */

static int dir_make(Arena *a, const char *path) {
  char *p = arena_strdup(a, path);
  for (char *c = p + 1; *c; c++)
    if (*c == '/') {
      *c = '\0';
      mkdir(p, 0777);
      *c = '/';
    }
  return mkdir(p, 0700) == 0 || errno == EEXIST;
}

/* Whether a parent folder is safe: of the user or root, and sticky where others may write, as /tmp. */
static int is_safe_above(const struct stat *st) {
  return (st->st_uid == 0 || st->st_uid == geteuid()) && (!(st->st_mode & 022) || st->st_mode & S_ISVTX);
}

static int dir_is_safe(const char *path) {
  struct stat st;
  char *whole = realpath(path, NULL);
  int safe = whole && stat(whole, &st) == 0 && S_ISDIR(st.st_mode) && st.st_uid == geteuid() && !(st.st_mode & 022);
  for (char *slash = whole ? strrchr(whole, '/') : NULL; safe && slash; slash = strrchr(whole, '/')) {
    *slash = '\0';
    safe = stat(*whole ? whole : "/", &st) == 0 && is_safe_above(&st);
  }
  free(whole);
  return safe;
}

/* Creates the folder at path if needed and removes write permission of others. Returns path; NULL if others can
 * still write there. */
static const char *own_folder(Arena *a, const char *path) {
  struct stat st;
  if (!dir_make(a, path)) return NULL;
  if (lstat(path, &st) == 0 && S_ISDIR(st.st_mode) && st.st_uid == geteuid() && st.st_mode & 022)
    chmod(path, st.st_mode & 0755);
  return dir_is_safe(path) && access(path, W_OK) == 0 ? path : NULL;
}

static const char *folder_of(Arena *a, const char *variable, const char *below) {
  const char *value = getenv(variable);
  return value && lag_is_absolute(value) ? own_folder(a, arena_printf(a, "%s/%s", value, below)) : NULL;
}

const char *cache_folder(Arena *a) {
  const char *own = arena_printf(a, "lagc-%ld", (long)geteuid()), *dir = folder_of(a, "XDG_CACHE_HOME", "lagc");
  const char *cache = getenv("XDG_CACHE_HOME");
  if (!dir && !(cache && lag_is_absolute(cache))) dir = folder_of(a, CACHE_VARIABLE, CACHE_FOLDER);
  if (!dir) dir = folder_of(a, TEMPORARY_FOLDER, own);
  return dir ? dir : own_folder(a, arena_printf(a, "/tmp/%s", own));
}

/* --- folders of builds --- */

/* Locks the file; 0 also where another process has removed it meanwhile. */
static int take_lock(int fd) {
  struct stat st;
  return lag_file_lock(fd) == 0 && fstat(fd, &st) == 0 && st.st_nlink > 0;
}

void build_folder_remove(BuildFolder *f) {
  DIR *d = lag_opendir(f->path);
  for (struct dirent *e; d && (e = readdir(d));) lag_unlink_in(d, e->d_name);
  if (d) closedir(d);
  if (f->lock >= 0) close(f->lock); /* before, since Windows removes a file when it is closed */
  rmdir(f->path);
}

static int try_folder(Arena *a, const char *base, BuildFolder *f) {
  char *path = arena_printf(a, "%s/lagc-build-XXXXXX", base);
  if (!mkdtemp(path)) return 0;
  f->path = path;
  f->lock = open(arena_printf(a, "%s/lock", path), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW, 0600);
  if (f->lock >= 0 && take_lock(f->lock)) return 1;
  int why = errno;
  build_folder_remove(f);
  errno = why;
  return 0;
}

int build_folder_make(Arena *a, const char *base, BuildFolder *f) {
  int made = 0;
  /* again where another process removed it as left over */
  for (int i = 0; i < 10 && !made; i++) made = try_folder(a, base, f);
  return made;
}

/* Removes the folder if its lock can be taken. A missing lock (its process was killed, or is about to make it) is
 * made here: a process that is still making the folder then fails to get its lock, and makes another folder. */
static void remove_if_stale(Arena *a, const char *path) {
  struct stat st;
  if (lstat(path, &st) != 0 || !S_ISDIR(st.st_mode) || st.st_uid != geteuid()) return;
  BuildFolder f = {
      path, open(arena_printf(a, "%s/lock", path), O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0600)};
  if (f.lock >= 0 && take_lock(f.lock)) build_folder_remove(&f);
  else if (f.lock >= 0) close(f.lock);
}

/* Removes the lock of an entry whose process was killed. */
static void remove_lock_if_stale(const char *path) {
  int fd = open(path, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) return;
  if (take_lock(fd)) unlink(path);
  close(fd);
}

void cache_remove_stale_builds(Arena *a) {
  const char *base = cache_folder(a);
  DIR *d = base ? opendir(base) : NULL;
  for (struct dirent *e; d && (e = readdir(d));) {
    const char *path = arena_printf(a, "%s/%s", base, e->d_name);
    if (strncmp(e->d_name, "lagc-build-", 11) == 0 && strlen(e->d_name) == 17) remove_if_stale(a, path);
    else if (strspn(e->d_name, "0123456789abcdef") == NAME && strcmp(e->d_name + NAME, ".lock") == 0)
      remove_lock_if_stale(path);
  }
  if (d) closedir(d);
}

/* --- entries --- */

static int file_is_own(const char *path) {
  struct stat st;
  return lstat(path, &st) == 0 && S_ISREG(st.st_mode) && st.st_uid == geteuid() && !(st.st_mode & 022) &&
         st.st_nlink == 1 && st.st_size > 0;
}

/* A seal, the last CACHE_SEAL bytes of an entry: size and hash of the bytes before it. Loaders of programs do not
 * read so far. */
static const char seal_form[] = "\n#lagc %016" PRIx64 " %016" PRIx64 "\n";

/* FNV-1a by words of 8 bytes, the last filled with zeros. */
static uint64_t hash_words(uint64_t h, const char *s, size_t n) {
  for (uint64_t word; n > 0; s += 8) {
    size_t some = n < 8 ? n : 8;
    word = 0;
    memcpy(&word, s, some);
    h = (h ^ word) * UINT64_C(0x100000001b3);
    n -= some;
  }
  return h;
}

/* Hash of the next n bytes, or of all (n < 0); *n := their number. */
static uint64_t hash_file(FILE *f, int64_t *n) {
  char block[65536];
  uint64_t h = LAG_FNV1A_START;
  int64_t left = *n < 0 ? INT64_MAX : *n;
  *n = 0;
  for (size_t some;
       left > 0 && (some = fread(block, 1, left < (int64_t)sizeof block ? (size_t)left : sizeof block, f)) > 0;
       left -= (int64_t)some, *n += (int64_t)some)
    h = hash_words(h, block, some);
  return h;
}

int cache_seal(const char *path) {
  FILE *f = fopen(path, "r+b");
  int64_t n = -1;
  if (!f) return 0;
  uint64_t h = hash_file(f, &n);
  int ok = !ferror(f) && fseek(f, 0, SEEK_END) == 0 && fprintf(f, seal_form, (uint64_t)n, h) == CACHE_SEAL;
  return (fclose(f) == 0) & ok;
}

/* Whether the file is whole, as it was sealed. */
static int has_seal(const char *path) {
  char is[CACHE_SEAL + 1] = "", should[CACHE_SEAL + 1];
  struct stat st;
  FILE *f = fopen(path, "rb");
  if (!f) return 0;
  int64_t n = fstat(fileno(f), &st) == 0 ? (int64_t)st.st_size - CACHE_SEAL : 0, asked = n;
  uint64_t h = n > 0 ? hash_file(f, &n) : 0;
  snprintf(should, sizeof should, seal_form, (uint64_t)n, h);
  int whole = n > 0 && n == asked && fread(is, 1, CACHE_SEAL, f) == CACHE_SEAL && strcmp(is, should) == 0;
  fclose(f);
  return whole;
}

int cache_has_data(const char *path) {
  int whole = file_is_own(path) && has_seal(path);
  if (whole) utimensat(AT_FDCWD, path, NULL, 0);
  return whole;
}

int cache_write(const char *path, const StrBuf *text) {
  Outfile o;
  if (lag_outfile_open(&o, path) != 0) return 0;
  int whole = fwrite(sb_text(text), 1, text->n, o.f) == text->n && fflush(o.f) == 0 && cache_seal(o.part);
  return lag_outfile_close(&o, whole ? OUTFILE_KEEP : OUTFILE_DROP) == 0 && whole;
}

int cache_read(const char *path, StrBuf *out) {
  const char *why;
  if (!cache_has_data(path) || !file_append(path, out, &why) || out->n < CACHE_SEAL) return 0;
  out->at[out->n -= CACHE_SEAL] = '\0';
  return 1;
}

int cache_has(const char *path) { return access(path, X_OK) == 0 && cache_has_data(path); }

static const char *lock_of(Arena *a, const char *path) { return arena_printf(a, "%s.lock", path); }

int cache_take(Arena *a, const char *path) {
  int fd = open(lock_of(a, path), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (fd >= 0) lag_file_wait(fd);
  return fd;
}

void cache_give(Arena *a, const char *path, int lock) {
  if (lock < 0) return;
  unlink(lock_of(a, path));
  close(lock);
}

typedef struct {
  const char *path;
  long long size;
  struct timespec used;
} Entry;
typedef VEC(Entry) Entries;

static int is_reference(const char *name) {
  return strlen(name) == NAME + SUFFIX && name[NAME] == '.' &&
         strspn(name + NAME + 1, "0123456789abcdef") == SUFFIX - 1;
}

static int is_entry(const char *name) {
  if (strspn(name, "0123456789abcdef") != NAME) return 0;
  return name[NAME] == '\0' || is_reference(name) || strcmp(name + NAME, ".run") == 0 ||
         strcmp(name + NAME, ".cc") == 0 || strcmp(name + NAME, ".bytes") == 0;
}

static int by_age(const void *x, const void *y) {
  const struct timespec *a = &((const Entry *)x)->used, *b = &((const Entry *)y)->used;
  return a->tv_sec != b->tv_sec ? (a->tv_sec > b->tv_sec) - (a->tv_sec < b->tv_sec)
                                : (a->tv_nsec > b->tv_nsec) - (a->tv_nsec < b->tv_nsec);
}

/* All entries, the least recently used first; *total: their size [bytes]. */
static Entries entries(Arena *a, const char *dir, long long *total) {
  Entries all = {0};
  struct stat st;
  DIR *d = dir ? opendir(dir) : NULL;
  *total = 0;
  for (struct dirent *e; d && (e = readdir(d));) {
    const char *path = arena_printf(a, "%s/%s", dir, e->d_name);
    if (!is_entry(e->d_name) || lstat(path, &st) != 0) continue;
    vec_push(a, &all, ((Entry){path, st.st_size, st.st_mtim}));
    *total += st.st_size;
  }
  if (d) closedir(d);
  if (all.n) qsort(all.at, all.n, sizeof *all.at, by_age);
  return all;
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
    unlink(all.at[i].path);
    total -= all.at[i].size;
  }
}

/* The entries whose name has so many characters. */
static uint32_t count(const Entries *all, size_t characters) {
  uint32_t n = 0;
  for (uint32_t i = 0; i < all->n; i++) n += strlen(strrchr(all->at[i].path, '/') + 1) == characters;
  return n;
}

static double mib(long long bytes) { return (double)bytes / (1 << 20); }

void cache_print(Arena *a, StrBuf *out) {
  long long total;
  const char *dir = cache_folder(a);
  Entries all = entries(a, dir, &total);
  sb_printf(out, "folder      %s\n", dir ? dir : "none: set XDG_CACHE_HOME to a folder that only you can write");
  sb_printf(out,
            "simulators  %u\nreferences  %u (lagc cost)\nruns        %u (start at once)\nsize        %.1f MiB\n"
            "limit       %.0f MiB (LAGC_CACHE_MIB)\n",
            count(&all, NAME), count(&all, NAME + SUFFIX), count(&all, NAME + 4), mib(total), mib(limit()));
}

void cache_clear(Arena *a, StrBuf *out) {
  long long total;
  Entries all = entries(a, cache_folder(a), &total);
  for (uint32_t i = 0; i < all.n; i++) unlink(all.at[i].path);
  uint32_t n = count(&all, NAME);
  sb_printf(out, "removed %u simulator%s, %.1f MiB\n", n, n == 1 ? "" : "s", mib(total));
}
