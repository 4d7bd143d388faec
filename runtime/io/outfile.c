/* Output files that appear only when complete, by a locked temporary file and rename. Holds: an existing file keeps its
 * contents until the new one is complete. */
#include "io/outfile.h"

#include "io/posix.h"

/* File name part of a path. */
static const char *name_in(const char *path) {
  const char *slash = lag_last_slash(path);
  return slash ? slash + 1 : path;
}

static const char *suffix_of(const char *path) {
  const char *name = name_in(path), *dot = *name ? strrchr(name + 1, '.') : NULL;
  return dot ? dot + 1 : "";
}

int lag_outfile_has_suffix(const char *path, const char *suffixes) {
  const char *suffix = suffix_of(path);
  const size_t length = strlen(suffix);
  for (const char *s = suffixes; length && *s; s += strspn(s, " ")) {
    size_t n = strcspn(s, " ");
    if (n == length && strncasecmp(s, suffix, n) == 0) return 1;
    s += n;
  }
  return 0;
}

const char *lag_outfile_other_type(const char *path, const char *suffixes) {
  static const char known[] =
      "csv tsv npy npz json xml yaml h5 hdf5 nc mat parquet pkl xls xlsx ods svg png jpg jpeg gif webp bmp tif tiff "
      "pdf eps ps html htm mp4 webm avi mov c h hpp o so a py tex zip gz";
  return lag_outfile_has_suffix(path, known) && !lag_outfile_has_suffix(path, suffixes) ? suffix_of(path) : NULL;
}

const char *lag_outfile_contents(const char *suffixes) {
  static const char *const contents[][2] = {
      {"csv npy h5", "CSV, NumPy where the name ends in .npy, or HDF5 where it ends in .h5"},
      {"csv npy", "CSV, or NumPy where the name ends in .npy"},
      {"csv", "CSV"},
      {"html htm", "HTML"},
      {"svg png csv json", "a picture, .svg or .png, or all runs, .csv or .json"},
      {"svg png", "SVG, or PNG where the name ends in .png"}, {"h hpp", "a C header"}, {"tex", "LaTeX"},
      {"json", "JSON"}, {"fmu", "an FMU"},
      {"c", "C"}};
  for (size_t i = 0; i < sizeof contents / sizeof *contents; i++)
    if (strcmp(contents[i][0], suffixes) == 0) return contents[i][1];
  return "text";
}

/* Removes temporary files of `path` left from killed runs: regular files of the user that no process has locked. */
static void remove_remains(const char *path) {
  const char *name = name_in(path);
  size_t n = strlen(name);
  char folder[sizeof((Outfile *)0)->path];
  struct stat st;
  snprintf(folder, sizeof folder, "%.*s", name > path ? (int)(name - path) : 1, name > path ? path : ".");
  DIR *d = opendir(folder);
  for (struct dirent *e; d && (e = readdir(d)) != NULL;) {
    const char *rest = e->d_name + n + strlen(".part-");
    if (strncmp(e->d_name, name, n) != 0 || strncmp(e->d_name + n, ".part-", 6) != 0 ||
        strspn(rest, "0123456789-") != strlen(rest))
      continue;
    int fd = lag_open_in(d, e->d_name, O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (fd >= 0 && fstat(fd, &st) == 0 && S_ISREG(st.st_mode) && st.st_uid == geteuid() && lag_file_lock(fd) == 0)
      lag_unlink_in(d, e->d_name);
    if (fd >= 0) close(fd);
  }
  if (d) closedir(d);
}

/* Whether path names an open stream, such as /dev/stdout; such a file is appended to, never replaced. */
static int is_stream(const char *path) {
  return strncmp(path, "/dev/std", 8) == 0 || strncmp(path, "/dev/fd/", 8) == 0 || strncmp(path, "/proc/", 6) == 0 ||
         lag_is_null_device(path);
}

/* o->path := path with links resolved. A link owned by another user (except root) is refused with EACCES. */
static int find_target(Outfile *o, const char *path) {
  struct stat st;
  char *target = NULL;
  if (lstat(path, &st) == 0 && S_ISLNK(st.st_mode)) {
    if (st.st_uid != geteuid() && st.st_uid != 0) {
      errno = EACCES;
      return -1;
    }
    if ((target = realpath(path, NULL)) == NULL) return -1;
    path = target;
  }
  int fits = strlen(path) < sizeof o->path;
  snprintf(o->path, sizeof o->path, "%s", path);
  free(target);
  errno = ENAMETOOLONG;
  return fits ? 0 : -1;
}

/* Creates o->part beside o->path, with mode and owner of an existing file there. Returns its descriptor, or -1. */
static int make_part(Outfile *o) {
  struct stat old, st;
  int there = stat(o->path, &old) == 0;
  for (int k = 0; k < 10000; k++) {
    snprintf(o->part, sizeof o->part, "%s.part-%ld-%d", o->path, (long)getpid(), k);
    int fd = open(o->part, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, there ? old.st_mode & 0600 : 0666);
    if (fd < 0 && errno != EEXIST) break;
    if (fd < 0) continue;
    lag_file_lock(fd);
    if (there && fstat(fd, &st) == 0 && (st.st_uid != old.st_uid || st.st_gid != old.st_gid)) {
      there = fchown(fd, old.st_uid, old.st_gid) == 0 ? 1 : 2; /* 2: the mode is kept, the owner cannot be changed */
    }
    if (fstat(fd, &st) == 0 && st.st_nlink > 0 && (!there || fchmod(fd, old.st_mode & 0777) == 0)) return fd;
    close(fd); /* another run removed the file before it was locked: try another name */
  }
  o->part[0] = '\0';
  return -1;
}

int lag_outfile_open(Outfile *o, const char *path) {
  struct stat st;
  *o = (Outfile){.f = stdout};
  if (strcmp(path, "-") == 0) return 0;
  int there = stat(path, &st) == 0;
  if (is_stream(path) || (there && !S_ISREG(st.st_mode))) {
    o->f = fopen(path, "ab");
    return o->f ? 0 : -1;
  }
  if (find_target(o, path) || (there && access(o->path, W_OK) != 0)) return -1;
  remove_remains(o->path);
  int fd = make_part(o);
  o->f = fd >= 0 ? fdopen(fd, "wb") : NULL;
  return o->f ? 0 : -1;
}

/* errno, or EIO where a library left it 0. */
static int error_number(void) { return errno ? errno : EIO; }

/* Why an earlier write to a file that is dropped has failed: the next one fails alike. */
static int write_error(FILE *f) {
  enum { BLOCK = 1 << 16 };
  errno = 0;
  clearerr(f);
  if (fseek(f, 0, SEEK_END) != 0) return error_number();
  for (int i = 0; i < BLOCK && !ferror(f); i++) putc('\n', f);
  return fflush(f) != 0 || ferror(f) ? error_number() : EIO;
}

int lag_outfile_close(Outfile *o, int keep) {
  int is_part = o->part[0] != '\0', error = !ferror(o->f) ? 0 : is_part ? write_error(o->f) : EIO;
  errno = 0;
  /* says why, where ferror does not */
  if (fflush(o->f) != 0 || (keep == OUTFILE_SYNC && is_part && fsync(fileno(o->f)) != 0)) error = error_number();
  if (o->f != stdout) {
    /* before the lock is released */
    if (is_part && !error && keep && rename(o->part, o->path) != 0) error = error_number();
    if (is_part && (error || !keep)) remove(o->part);
    if (fclose(o->f) != 0 && !error) error = error_number();
  }
  o->f = NULL;
  errno = error;
  return error ? -1 : 0;
}
