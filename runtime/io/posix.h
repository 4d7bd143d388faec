/* POSIX's headers; on Windows MinGW's, and what they lack: windows.c. This header and windows.c include nothing of
 * the runtime, because the compiler is built with a copy of both (Makefile). */
#pragma once

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

/* Why a file cannot be read, after lag_open_to_read. */
#define lag_read_error() (errno == ENXIO ? "nothing writes to this pipe" : strerror(errno))

#ifdef __GLIBC__
#include <malloc.h>
#endif
/* Memory that is given back stays with the process: for programs that ask for it again at once. */
static inline void lag_keep_memory(void) {
#ifdef __GLIBC__
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
  mallopt(M_TOP_PAD, 4 << 20);
#endif
}

#ifdef _WIN32
#include <direct.h>
#include <io.h>
#include <process.h>
#include <signal.h>
#include <string.h>
#include <sys/utime.h>
#include <time.h>

/* Flags of open without a counterpart: Windows has neither devices nor terminals in folders, and links only of
 * administrators. */
#define O_NOFOLLOW 0
#define O_NONBLOCK 0
#define O_NOCTTY 0
#define O_CLOEXEC _O_NOINHERIT
/* Files belong to the user, and others have no rights: those are in lists that mode bits do not show. */
#define S_ISVTX 0
#define S_ISLNK(mode) 0
#define geteuid() 0
#define fchmod(fd, mode) ((void)(fd), (void)(mode), 0)
#define fchown(fd, user, group) ((void)(user), (void)(group), 0)
#define fsync(fd) _commit(fd)
#define mkdir(path, mode) _mkdir(path)
#define setenv(name, value, replace) _putenv_s(name, value)
#define unsetenv(name) _putenv_s(name, "")
#define AT_FDCWD 0
#define utimensat(fd, path, times, flags) _utime(path, times)

struct lag_stat {
  unsigned long st_dev;
  unsigned long long st_ino;
  unsigned st_mode, st_nlink, st_uid, st_gid;
  long long st_size;
  struct timespec st_mtim, st_ctim; /* st_ctim: of creation */
};
#define stat lag_stat
#define lstat(path, st) lag_stat(path, st)
#define fstat(fd, st) lag_fstat(fd, st)
int lag_stat(const char *path, struct lag_stat *st);
int lag_fstat(int fd, struct lag_stat *st);

/* A file opened so can be renamed and removed while it is open, as on POSIX. */
#define open(...) lag_open(__VA_ARGS__)
int lag_open(const char *path, int flags, ...);
/* Replaces an existing file. */
#define rename(from, to) lag_rename(from, to)
int lag_rename(const char *from, const char *to);
/* With `/` between folders. */
#define realpath(path, room) lag_realpath(path, room)
char *lag_realpath(const char *path, char *room);
#define mkdtemp(path) lag_mkdtemp(path)
char *lag_mkdtemp(char *path);

/* A handler is called once; Ctrl-Break is the signal for hanging up. */
#define SIGHUP SIGBREAK
#define SA_RESETHAND 0
struct sigaction {
  void (*sa_handler)(int);
  int sa_flags, sa_mask;
};
#define sigemptyset(mask) (*(mask) = 0)
#define sigaction(number, action, before) lag_sigaction(number, action, before)
int lag_sigaction(int number, const struct sigaction *action, struct sigaction *before);

/* Variables that name folders, and the folder of caches below one. */
#define TEMPORARY_FOLDER "TMP"
#define CACHE_VARIABLE "LOCALAPPDATA"
#define CACHE_FOLDER "lagc"
/* The C compiler where CC is not set. */
#define DEFAULT_CC "gcc"
#define PROGRAM_SUFFIX ".exe"
#define PATH_SEPARATOR ";"
/* Whether programs may fork, and end by alarms. */
#define HAS_POSIX 0

/* Locks the file until it is closed or the process ends. 0, or -1: another process holds the lock. */
int lag_file_lock(int fd);
/* The same after that process has ended or closed it. */
int lag_file_wait(int fd);
/* The path of the running program in path[n], with `/`. Its length, or -1. */
long lag_own_path(char *path, size_t n);
/* Waits [s]. */
void lag_nap(double time);
/* Processors of this machine. */
static inline long lag_processors(void) {
  const char *n = getenv("NUMBER_OF_PROCESSORS");
  return n ? atol(n) : 1;
}
/* A lock between threads, LAG_UNLOCKED at first. */
typedef struct lag_lock {
  void *word;
} lag_lock;
#define LAG_UNLOCKED {0}
void lag_lock_take(lag_lock *lock);
void lag_lock_give(lag_lock *lock);
/* A file in a folder that is being read. */
int lag_open_in(DIR *d, const char *name, int flags);
int lag_unlink_in(DIR *d, const char *name);

/* Bytes of the standard streams as they are, without \r. */
static inline void lag_prepare_streams(void) {
  for (int fd = 0; fd < 3; fd++) _setmode(fd, _O_BINARY);
}
static inline DIR *lag_opendir(const char *path) { return opendir(path); }
static inline FILE *lag_open_to_read(const char *path) { return fopen(path, "rb"); }
static inline int lag_is_absolute(const char *path) {
  return path[0] == '/' || path[0] == '\\' || (path[0] && path[1] == ':');
}
/* The last separator of folders, or NULL. */
static inline char *lag_last_slash(const char *path) {
  char *slash = strrchr(path, '/'), *other = strrchr(path, '\\');
  return !slash || (other && other > slash) ? other : slash;
}
static inline int lag_is_null_device(const char *path) { return _stricmp(path, "nul") == 0; }

#else
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <string.h>
#include <time.h>

#define TEMPORARY_FOLDER "TMPDIR"
#define CACHE_VARIABLE "HOME"
#define CACHE_FOLDER ".cache/lagc"
#define DEFAULT_CC "cc"
#define PROGRAM_SUFFIX ""
#define PATH_SEPARATOR ":"
#define HAS_POSIX 1

static inline int lag_file_lock(int fd) {
  struct flock all = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
  return fcntl(fd, F_SETLK, &all);
}
static inline int lag_file_wait(int fd) {
  struct flock all = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
  return fcntl(fd, F_SETLKW, &all);
}
/* of less than a second */
static inline void lag_nap(double time) { nanosleep(&(struct timespec){.tv_nsec = (long)(1e9 * time)}, NULL); }
static inline long lag_processors(void) { return sysconf(_SC_NPROCESSORS_ONLN); }
typedef struct lag_lock {
  pthread_mutex_t mutex;
} lag_lock;
#define LAG_UNLOCKED {PTHREAD_MUTEX_INITIALIZER}
static inline void lag_lock_take(lag_lock *lock) { pthread_mutex_lock(&lock->mutex); }
static inline void lag_lock_give(lag_lock *lock) { pthread_mutex_unlock(&lock->mutex); }
static inline long lag_own_path(char *path, size_t n) { return (long)readlink("/proc/self/exe", path, n); }
static inline int lag_open_in(DIR *d, const char *name, int flags) { return openat(dirfd(d), name, flags); }
static inline int lag_unlink_in(DIR *d, const char *name) { return unlinkat(dirfd(d), name, 0); }
/* Opens a file or pipe; a pipe to which nothing writes within two seconds fails with ENXIO. */
static inline FILE *lag_open_to_read(const char *path) {
  char first;
  int fd = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  struct stat st;
  struct pollfd ready = {.fd = fd, .events = POLLIN};
  ssize_t n = -1;
  if (fd < 0) return NULL;
  if (fstat(fd, &st) == 0 && S_ISFIFO(st.st_mode))
    /* a writer that is slow */
    while (poll(&ready, 1, 2000) == 0 && (n = read(fd, &first, 1)) < 0 && errno == EAGAIN) continue;
  FILE *f = n == 0 || fcntl(fd, F_SETFL, 0) != 0 ? NULL : fdopen(fd, "rb");
  if (f && n == 1) ungetc((unsigned char)first, f);
  if (!f) close(fd);
  if (!f && n == 0) errno = ENXIO;
  return f;
}
/* A file beyond a limit of its size is an error of its write, not the end of the process. */
static inline void lag_prepare_streams(void) { signal(SIGXFSZ, SIG_IGN); }
/* The folder at path, unless it is a link. */
static inline DIR *lag_opendir(const char *path) {
  int fd = open(path, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  DIR *d = fd >= 0 ? fdopendir(fd) : NULL;
  if (!d && fd >= 0) close(fd);
  return d;
}
static inline int lag_is_absolute(const char *path) { return path[0] == '/'; }
static inline char *lag_last_slash(const char *path) { return strrchr(path, '/'); }
static inline int lag_is_null_device(const char *path) { return strcmp(path, "/dev/null") == 0; }
#endif

/* Calls work(data[i]) for i < n, the first here, the others each on a thread of its own, and waits; those without a
 * thread are not called. */
void lag_on_threads(int n, void (*work)(void *data), void *const *data);
