/* Writes files atomically, judges permissions of folders, and makes locked folders for builds. */
#include "toolchain/files.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "toolchain/outfile.h" /* generated: a copy of runtime/io/outfile.h */

/* --- files --- */

/* Closes the file, and keeps or drops it. */
static int close_outfile(Outfile *o, int ok, const char **error) {
  int why = errno;
  if (lag_outfile_close(o, ok ? OUTFILE_KEEP : OUTFILE_DROP) != 0 && ok) {
    ok = 0;
    why = errno;
  }
  if (!ok) *error = strerror(why ? why : EIO);
  return ok;
}

int file_write(const char *path, const char *text, size_t n, const char **error) {
  Outfile o;
  errno = 0;
  if (lag_outfile_open(&o, path) != 0) {
    *error = strerror(errno);
    return 0;
  }
  return close_outfile(&o, fwrite(text, 1, n, o.f) == n && fflush(o.f) == 0, error);
}

static int copy(FILE *from, FILE *to) {
  char block[65536];
  for (size_t n; (n = fread(block, 1, sizeof block, from)) > 0;)
    if (fwrite(block, 1, n, to) != n) return 0;
  return !ferror(from) && fflush(to) == 0;
}

int file_install(const char *path, const char *from, const char **error) {
  Outfile o;
  struct stat st;
  FILE *f = fopen(from, "rb");
  int ok = 0;
  errno = f ? 0 : errno;
  if (!f || lag_outfile_open(&o, path) != 0) *error = strerror(errno);
  else {
    ok = copy(f, o.f) && fstat(fileno(o.f), &st) == 0;
    ok = close_outfile(&o, ok && fchmod(fileno(o.f), (st.st_mode | (st.st_mode & 0444) >> 2) & 0777) == 0, error); /* readers may execute it */
  }
  if (f) fclose(f);
  return ok;
}

int file_same(const char *a, const char *b) {
  struct stat x, y;
  return stat(a, &x) == 0 && stat(b, &y) == 0 && x.st_dev == y.st_dev && x.st_ino == y.st_ino && S_ISREG(x.st_mode);
}

int file_is_own(const char *path) {
  struct stat st;
  return lstat(path, &st) == 0 && S_ISREG(st.st_mode) && st.st_uid == geteuid() && !(st.st_mode & 022) && st.st_nlink == 1 && st.st_size > 0;
}

int file_exists(const char *path) { return access(path, F_OK) == 0; }

/* --- folders --- */

int dir_make(Arena *a, const char *path) {
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

int dir_is_safe(const char *path) {
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

/* --- folders of builds --- */

/* Locks the file; 0 also where another process has removed it meanwhile. */
static int take_lock(int fd) {
  struct flock all = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
  struct stat st;
  return fcntl(fd, F_SETLK, &all) == 0 && fstat(fd, &st) == 0 && st.st_nlink > 0;
}

void build_folder_remove(BuildFolder *f) {
  int fd = open(f->path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  DIR *d = fd >= 0 ? fdopendir(fd) : NULL;
  for (struct dirent *e; d && (e = readdir(d));) unlinkat(fd, e->d_name, 0);
  if (d) closedir(d);
  else if (fd >= 0) close(fd);
  rmdir(f->path);
  if (f->lock >= 0) close(f->lock);
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
  for (int i = 0; i < 10 && !made; i++) made = try_folder(a, base, f); /* again where another process removed it as left over */
  return made;
}

/* Removes the folder if its lock can be taken. A missing lock (its process was killed, or is about to make it) is made here: a process that is
 * still making the folder then fails to get its lock, and makes another folder. */
static void remove_if_stale(Arena *a, const char *path) {
  struct stat st;
  if (lstat(path, &st) != 0 || !S_ISDIR(st.st_mode) || st.st_uid != geteuid()) return;
  BuildFolder f = {path, open(arena_printf(a, "%s/lock", path), O_RDWR | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0600)};
  if (f.lock >= 0 && take_lock(f.lock)) build_folder_remove(&f);
  else if (f.lock >= 0) close(f.lock);
}

void build_folder_remove_stale(Arena *a, const char *base) {
  DIR *d = opendir(base);
  for (struct dirent *e; d && (e = readdir(d));)
    if (strncmp(e->d_name, "lagc-build-", 11) == 0 && strlen(e->d_name) == 17) remove_if_stale(a, arena_printf(a, "%s/%s", base, e->d_name));
  if (d) closedir(d);
}
