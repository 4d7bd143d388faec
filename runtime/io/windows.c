/* POSIX functions that MinGW lacks, in Windows' own. Compiled for Windows only (Makefile). Holds: they fail as
 * POSIX's do, with errno. */
#include "io/posix.h"

#include <stdarg.h>
#include <stdint.h>
#define WIN32_LEAN_AND_MEAN
#include <windows.h>

/* errno := what Windows' last error is called; returns -1. */
static int failed(void) {
  switch (GetLastError()) {
  case ERROR_FILE_NOT_FOUND:
  case ERROR_PATH_NOT_FOUND:
  case ERROR_INVALID_NAME:
  case ERROR_BAD_PATHNAME:
  case ERROR_INVALID_DRIVE: errno = ENOENT; break;
  case ERROR_FILE_EXISTS:
  case ERROR_ALREADY_EXISTS: errno = EEXIST; break;
  case ERROR_DISK_FULL: errno = ENOSPC; break;
  case ERROR_NOT_ENOUGH_MEMORY:
  case ERROR_OUTOFMEMORY: errno = ENOMEM; break;
  case ERROR_ACCESS_DENIED:
  case ERROR_SHARING_VIOLATION:
  case ERROR_LOCK_VIOLATION:
  case ERROR_WRITE_PROTECT: errno = EACCES; break;
  default: errno = EIO; break;
  }
  return -1;
}

/* ---- files ---- */

static struct timespec time_of(FILETIME t) {
  const uint64_t to_1970 = UINT64_C(116444736000000000); /* of 100 ns, since 1601 */
  uint64_t n = ((uint64_t)t.dwHighDateTime << 32 | t.dwLowDateTime) - to_1970;
  return (struct timespec){.tv_sec = (time_t)(n / 10000000), .tv_nsec = (long)(n % 10000000 * 100)};
}

static int stat_of(HANDLE h, struct lag_stat *st) {
  BY_HANDLE_FILE_INFORMATION is;
  if (GetFileType(h) != FILE_TYPE_DISK) {
    *st = (struct lag_stat){.st_mode = _S_IFCHR | 0600, .st_nlink = 1};
    return 0;
  }
  if (!GetFileInformationByHandle(h, &is)) return failed();
  int folder = (is.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) != 0,
      fixed = (is.dwFileAttributes & FILE_ATTRIBUTE_READONLY) != 0;
  *st = (struct lag_stat){.st_dev = is.dwVolumeSerialNumber,
                          .st_ino = (unsigned long long)is.nFileIndexHigh << 32 | is.nFileIndexLow,
                          .st_mode = (folder ? _S_IFDIR : _S_IFREG) | (fixed ? 0500u : 0700u),
                          .st_nlink = is.nNumberOfLinks,
                          .st_size = (long long)is.nFileSizeHigh << 32 | is.nFileSizeLow,
                          .st_mtim = time_of(is.ftLastWriteTime),
                          .st_ctim = time_of(is.ftCreationTime)};
  return 0;
}

static const DWORD shared = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;

int lag_stat(const char *path, struct lag_stat *st) {
  HANDLE h = CreateFileA(path, 0, shared, NULL, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, NULL); /* folders, too */
  if (h == INVALID_HANDLE_VALUE) return failed();
  int rc = stat_of(h, st);
  CloseHandle(h);
  return rc;
}

int lag_fstat(int fd, struct lag_stat *st) { return stat_of((HANDLE)_get_osfhandle(fd), st); }

int lag_open(const char *path, int flags, ...) {
  DWORD to = flags & (_O_RDWR | _O_WRONLY) ? GENERIC_READ | GENERIC_WRITE : GENERIC_READ;
  DWORD how = !(flags & _O_CREAT) ? OPEN_EXISTING : flags & _O_EXCL ? CREATE_NEW : OPEN_ALWAYS;
  /* folders, too */
  HANDLE h = CreateFileA(path, to, shared, NULL, how, FILE_ATTRIBUTE_NORMAL | FILE_FLAG_BACKUP_SEMANTICS, NULL);
  if (h == INVALID_HANDLE_VALUE) return failed();
  int fd = _open_osfhandle((intptr_t)h, (flags & _O_APPEND) | _O_BINARY | _O_NOINHERIT);
  if (fd < 0) CloseHandle(h);
  return fd;
}

int lag_rename(const char *from, const char *to) {
  return MoveFileExA(from, to, MOVEFILE_REPLACE_EXISTING) ? 0 : failed();
}

static int take_lock(int fd, DWORD how) {
  /* locked bytes cannot be written by others: none of the file's */
  OVERLAPPED far_behind = {.Offset = 0, .OffsetHigh = 1 << 30};
  return LockFileEx((HANDLE)_get_osfhandle(fd), LOCKFILE_EXCLUSIVE_LOCK | how, 0, 1, 0, &far_behind) ? 0 : failed();
}

int lag_file_lock(int fd) { return take_lock(fd, LOCKFILE_FAIL_IMMEDIATELY); }

int lag_file_wait(int fd) { return take_lock(fd, 0); }

void lag_nap(double time) { Sleep((DWORD)(1e3 * time)); }

/* ---- paths ---- */

static void turn_slashes(char *path) {
  for (; *path; path++)
    if (*path == '\\') *path = '/';
}

char *lag_realpath(const char *path, char *room) {
  struct stat st;
  char *whole = lag_stat(path, &st) == 0 ? _fullpath(room, path, PATH_MAX) : NULL;
  if (whole) turn_slashes(whole);
  return whole;
}

long lag_own_path(char *path, size_t n) {
  DWORD length = GetModuleFileNameA(NULL, path, (DWORD)n);
  if (length == 0 || length >= n) return -1;
  turn_slashes(path);
  return (long)length;
}

/* Path of a file in the folder: MinGW keeps the pattern FOLDER\* in dd_name. */
static int path_in(DIR *d, const char *name, char *path, size_t size) {
  int folder = (int)strlen(d->dd_name) - 1, n = snprintf(path, size, "%.*s%s", folder, d->dd_name, name);
  errno = ENAMETOOLONG;
  return folder > 0 && n > 0 && (size_t)n < size;
}

int lag_open_in(DIR *d, const char *name, int flags) {
  char path[PATH_MAX];
  return path_in(d, name, path, sizeof path) ? lag_open(path, flags) : -1;
}

int lag_unlink_in(DIR *d, const char *name) {
  char path[PATH_MAX];
  return path_in(d, name, path, sizeof path) ? _unlink(path) : -1;
}

char *lag_mkdtemp(char *path) {
  static const char digits[] = "abcdefghijklmnopqrstuvwxyz0123456789";
  size_t n = strlen(path);
  uint64_t seed = (uint64_t)GetCurrentProcessId() << 20 ^ GetTickCount64();
  for (int tries = 0; tries < 10000; tries++) {
    uint64_t x = seed += UINT64_C(0x9e3779b97f4a7c15);
    for (size_t i = n - 6; i < n; i++, x /= 36) path[i] = digits[x % 36];
    if (_mkdir(path) == 0) return path;
    if (errno != EEXIST) return NULL;
  }
  return NULL;
}

/* ---- signals ---- */

int lag_sigaction(int number, const struct sigaction *action, struct sigaction *before) {
  if (before) *before = (struct sigaction){.sa_handler = SIG_DFL};
  return action && signal(number, action->sa_handler) == SIG_ERR ? -1 : 0;
}

/* ---- threads ---- */

void lag_lock_take(lag_lock *lock) { AcquireSRWLockExclusive((SRWLOCK *)lock); }
void lag_lock_give(lag_lock *lock) { ReleaseSRWLockExclusive((SRWLOCK *)lock); }

typedef struct Call {
  HANDLE thread;
  void (*work)(void *data);
  void *data;
} Call;

static unsigned __stdcall call(void *of) {
  const Call *c = of;
  c->work(c->data);
  return 0;
}

void lag_on_threads(int n, void (*work)(void *data), void *const *data) {
  Call *c = calloc((size_t)n, sizeof *c);
  int begun = 1;
  for (; c && begun < n; begun++) {
    c[begun] = (Call){.work = work, .data = data[begun]};
    c[begun].thread = (HANDLE)_beginthreadex(NULL, 0, call, &c[begun], 0, NULL);
    if (!c[begun].thread) break;
  }
  work(data[0]);
  for (int i = 1; c && i < begun; i++) {
    WaitForSingleObject(c[i].thread, INFINITE);
    CloseHandle(c[i].thread);
  }
  free(c);
}
