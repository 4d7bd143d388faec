/* The journal of a sweep (journal.h): a head, then records, each a chunk's number, its size, its numbers as they lie
 * in memory, and a hash. */
#include "sweep/journal.h"

#include "io/posix.h"
#include "numeric/clock.h"
#include "numeric/fnv1a.h"

static const char magic[16] = "lagc sweep 1\n";

typedef struct Head {
  char magic[16];
  uint64_t signature;
  int64_t chunks, size, scalar;
} Head;

typedef struct Record {
  int64_t chunk, n;
} Record;

/* Room for so many numbers at most [256 MB]. */
enum { KEPT_MOST = 32 << 20 };

static void keep(Journal *j, long long chunk, const double *row, size_t n) {
  if (j->kept) memcpy(j->kept + (size_t)chunk * j->size, row, n * sizeof *row);
}

static uint64_t hash_of(const Record *r, const double *row) {
  return lag_fnv1a(lag_fnv1a(LAG_FNV1A_START, (const char *)r, sizeof *r), (const char *)row,
                   (size_t)r->n * sizeof *row);
}

static int read_all(int fd, void *bytes, size_t n, long long at) {
  if (lseek(fd, (off_t)at, SEEK_SET) < 0) return -1;
  for (char *to = bytes; n;) {
    ssize_t done = read(fd, to, n);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return -1;
    to += done;
    n -= (size_t)done;
  }
  return 0;
}

/* Notes the records of the file, and cuts it after the last whole one. */
static int scan(Journal *j, double *row) {
  long long at = sizeof(Head);
  for (;;) {
    Record r;
    uint64_t hash;
    if (read_all(j->fd, &r, sizeof r, at) || r.chunk < 0 || r.chunk >= j->chunks || r.n < 0 || (size_t)r.n > j->size)
      break;
    long long end = at + (long long)sizeof r + r.n * (long long)sizeof *row;
    if (read_all(j->fd, row, (size_t)r.n * sizeof *row, at + (long long)sizeof r) ||
        read_all(j->fd, &hash, sizeof hash, end) || hash != hash_of(&r, row))
      break;
    j->finished += !j->at[r.chunk];
    j->at[r.chunk] = at;
    keep(j, r.chunk, row, (size_t)r.n);
    at = end + (long long)sizeof hash;
  }
  j->end = at;
  return ftruncate(j->fd, (off_t)at) || fseeko(j->f, (off_t)at, SEEK_SET) < 0 ? -1 : 0;
}

static int fail(Journal *j, char *why, size_t nwhy, const char *what) {
  snprintf(why, nwhy, "%s: %s", j->path, what);
  return -1;
}

static const char at_work[] = "another process is at work on this sweep";

/* Why there is a file at path. */
static const char *reason_it_is_there(const char *path) {
  int fd = open(path, O_RDWR | O_CLOEXEC), locked = fd >= 0 && lag_file_lock(fd);
  if (fd >= 0) close(fd);
  return locked ? at_work : "a sweep that did not end is there; --resume goes on with it, or remove the file";
}

/* Length of the file, where it has no more than the first bytes of this head, as after a kill or on a full disk;
 * else -1. */
static long long length_of_cut_head(const Journal *j, const Head *head) {
  Head there;
  off_t n = lseek(j->fd, 0, SEEK_END);
  return n >= 0 && n < (off_t)sizeof there && read_all(j->fd, &there, (size_t)n, 0) == 0 &&
                 memcmp(&there, head, (size_t)n) == 0
             ? n
             : -1;
}

int lag_journal_open(Journal *j, const char *path, int resume, char *why, size_t nwhy) {
  Head head = {.signature = j->signature, .chunks = j->chunks, .size = (int64_t)j->size, .scalar = sizeof(double)},
      there;
  *j = (Journal){.fd = -1, .chunks = j->chunks, .size = j->size, .signature = j->signature};
  memcpy(head.magic, magic, sizeof magic);
  snprintf(j->path, sizeof j->path, "%s", path);
  j->at = calloc((size_t)j->chunks + 1, sizeof *j->at);
  if ((double)j->chunks * (double)j->size <= KEPT_MOST) j->kept = malloc((size_t)j->chunks * j->size * sizeof *j->kept);
  double *row = malloc((j->size + 1) * sizeof *row);
  long long cut = -1;
  int rc = -1;
  why[0] = '\0';
  if (!j->at || !row) {
    fail(j, why, nwhy, "out of memory");
  } else if ((j->fd = open(path, O_RDWR | O_APPEND | O_CLOEXEC | (resume ? 0 : O_CREAT | O_EXCL), 0666)) < 0) {
    fail(j, why, nwhy,
         errno == EEXIST             ? reason_it_is_there(path)
         : errno == ENOENT && resume ? "there is nothing to go on with; leave out --resume"
                                     : strerror(errno));
  } else if (lag_file_lock(j->fd)) {
    fail(j, why, nwhy, at_work);
  } else if (!(j->f = fdopen(j->fd, "a+b"))) {
    fail(j, why, nwhy, strerror(errno));
  } else if (!resume || (cut = length_of_cut_head(j, &head)) >= 0) {
    if (cut >= 0) fail(j, why, nwhy, "the file has no run, since it ends within its head; all runs are made");
    j->end = sizeof head;
    rc =
        ftruncate(j->fd, 0) || fseeko(j->f, 0, SEEK_SET) < 0 || fwrite(&head, sizeof head, 1, j->f) != 1 || fflush(j->f)
            ? fail(j, why, nwhy, strerror(errno))
            : 0;
    if (rc) unlink(path);
  } else if (read_all(j->fd, &there, sizeof there, 0) || memcmp(&there, &head, sizeof head) != 0) {
    fail(j, why, nwhy,
         "this is another sweep: model, ranges, measures, method, end or samples differ; give the same, or remove the "
         "file");
  } else {
    rc = scan(j, row) ? fail(j, why, nwhy, strerror(errno)) : 0;
  }
  free(row);
  return rc;
}

int lag_journal_flush(Journal *j) {
  j->written = lag_clock_seconds();
  return fflush(j->f) ? -1 : 0;
}

int lag_journal_put(Journal *j, long long chunk, const double *row, size_t n) {
  const double soon = 0.1, often = 10; /* [s] */
  Record r = {chunk, (int64_t)n};
  uint64_t hash = hash_of(&r, row);
  if (fwrite(&r, sizeof r, 1, j->f) != 1 || fwrite(row, sizeof *row, n, j->f) != n ||
      fwrite(&hash, sizeof hash, 1, j->f) != 1)
    return -1;
  double now = lag_clock_seconds();
  if (now - j->written >= soon && lag_journal_flush(j)) return -1;
  if (now - j->synced >= often) {
    fsync(j->fd); /* where that is not possible, the file is as safe as the system makes it */
    j->synced = now;
  }
  keep(j, chunk, row, n);
  j->finished += !j->at[chunk];
  j->at[chunk] = j->end;
  j->end += (long long)(sizeof r + n * sizeof *row + sizeof hash);
  return 0;
}

int lag_journal_get(const Journal *j, long long chunk, double *row, size_t n) {
  Record r;
  if (j->at[chunk] && j->kept) {
    memcpy(row, j->kept + (size_t)chunk * j->size, n * sizeof *row);
    return 0;
  }
  if (!j->at[chunk] || fflush(j->f) || read_all(j->fd, &r, sizeof r, j->at[chunk]) || r.chunk != chunk ||
      r.n < (int64_t)n)
    return -1;
  return read_all(j->fd, row, n * sizeof *row, j->at[chunk] + (long long)sizeof r);
}

void lag_journal_close(Journal *j, int remove) {
  if (j->fd >= 0 && remove) unlink(j->path);
  if (j->f) fclose(j->f);
  else if (j->fd >= 0) close(j->fd);
  free(j->at);
  free(j->kept);
  *j = (Journal){.fd = -1};
}
