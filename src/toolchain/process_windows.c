/* Programs run as child processes, on Windows: process.c for POSIX. Compiled for Windows only (Makefile). */
#include "toolchain/process.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#define WIN32_LEAN_AND_MEAN
#include <windows.h>
#include <io.h>

#include "base/posix.h" /* generated: a copy of runtime/io/posix.h */

int stderr_is_terminal(void) { return _isatty(2); }

enum { NOT_FOUND = 127 }; /* as shells and process.c say it */

/* Appends a word so that the C library of the program reads the same word: in quotes, with \ before quotes and
 * doubled before the closing one. */
static void add_word(StrBuf *line, const char *word) {
  sb_puts(line, line->n ? " \"" : "\"");
  for (const char *c = word;; c++) {
    size_t n = strspn(c, "\\");
    c += n;
    int quoted = *c == '"' || !*c;
    for (size_t i = 0; i < (quoted ? 2 * n : n); i++) sb_putc(line, '\\');
    if (!*c) break;
    if (*c == '"') sb_putc(line, '\\');
    sb_putc(line, *c);
  }
  sb_putc(line, '"');
}

static HANDLE of_file(int fd) { return (HANDLE)_get_osfhandle(fd); }

/* Starts the program with these streams; without folder in its name, it is looked for in PATH. Returns the process;
 * NULL: it is not started. */
static HANDLE start(Arena *a, const char *path, char *const *argv, HANDLE out, HANDLE err) {
  StrBuf line = strbuf(a);
  STARTUPINFOA how = {
      .cb = sizeof how, .dwFlags = STARTF_USESTDHANDLES, .hStdInput = of_file(0), .hStdOutput = out, .hStdError = err};
  PROCESS_INFORMATION is;
  add_word(&line, path);
  for (char *const *w = argv + 1; *w; w++) add_word(&line, *w);
  SetHandleInformation(how.hStdInput, HANDLE_FLAG_INHERIT, HANDLE_FLAG_INHERIT);
  SetHandleInformation(out, HANDLE_FLAG_INHERIT, HANDLE_FLAG_INHERIT);
  SetHandleInformation(err, HANDLE_FLAG_INHERIT, HANDLE_FLAG_INHERIT);
  if (!CreateProcessA(lag_last_slash(path) ? path : NULL, arena_strdup(a, sb_text(&line)), NULL, NULL, TRUE, 0, NULL,
                      NULL, &how, &is))
    return NULL;
  CloseHandle(is.hThread);
  return is.hProcess;
}

/* Waits for the process; its exit status. */
static int wait_for(HANDLE process) {
  DWORD status = (DWORD)-1;
  WaitForSingleObject(process, INFINITE);
  GetExitCodeProcess(process, &status);
  CloseHandle(process);
  return (int)status;
}

int process_run(Arena *a, const char *path, char *const *argv, char **said) {
  HANDLE from, to;
  StrBuf b = strbuf(a);
  char buffer[4096];
  *said = arena_strdup(a, "");
  if (!CreatePipe(&from, &to, NULL, 0)) return -1;
  HANDLE process = start(a, path, argv, to, to);
  CloseHandle(to);
  for (DWORD n; process && ReadFile(from, buffer, sizeof buffer, &n, NULL) && n;) sb_putn(&b, buffer, n);
  CloseHandle(from);
  *said = arena_strdup(a, sb_text(&b));
  return process ? wait_for(process) : NOT_FOUND;
}

static int run_to(Arena *a, const char *path, char *const *argv, HANDLE out, HANDLE err) {
  HANDLE process = start(a, path, argv, out, err);
  return process ? wait_for(process) : NOT_FOUND;
}

int process_to_file(const char *path, char *const *argv, FILE *out) {
  Arena *a = arena_new(NULL);
  HANDLE nul = CreateFileA("NUL", GENERIC_WRITE, FILE_SHARE_READ | FILE_SHARE_WRITE, NULL, OPEN_EXISTING, 0, NULL);
  int status = a ? run_to(a, path, argv, of_file(_fileno(out)), nul) : -1;
  CloseHandle(nul);
  if (a) arena_free(a);
  return status;
}

/* Both processes get Ctrl-C: this one leaves it to the program. */
void process_become(const char *path, char *const *argv) {
  Arena *a = arena_new(NULL);
  fflush(NULL);
  SetConsoleCtrlHandler(NULL, TRUE);
  HANDLE process = a ? start(a, path, argv, of_file(1), of_file(2)) : NULL;
  if (process) exit(wait_for(process));
}

/* Beside the program's other temporary files, which the system's own care removes. */
int process_give(const char *name, const StrBuf *bytes) {
  char folder[MAX_PATH + 1], path[MAX_PATH + 1];
  FILE *f = GetTempPathA(MAX_PATH, folder) && GetTempFileNameA(folder, "lag", 0, path) ? fopen(path, "wb") : NULL;
  int ok = f && fwrite(bytes->at, 1, bytes->n, f) == bytes->n;
  if (f && fclose(f) != 0) ok = 0;
  return ok && _putenv_s(name, path) == 0;
}

void process_beside(void (*work)(void *data, int fd), void *data, const char *name) {
  (void)work, (void)data, (void)name;
}

void process_set(const char *name, const char *value) { _putenv_s(name, value); }
void process_tell(int fd, const char *line) { (void)fd, (void)line; }

int process_reader_ends(int fd, double seconds) { return (void)seconds, fd < 0; }

long process_begin(int (*work)(void *data), void *data) {
  (void)work;
  (void)data;
  return -1;
}

int process_end(long process, double seconds) { return (void)seconds, (int)process; }

int process_read_from(FILE *f) {
  return _lseeki64(_fileno(f), 0, SEEK_END) > 0 && _lseeki64(_fileno(f), 0, SEEK_SET) == 0 && _dup2(_fileno(f), 0) == 0;
}

void last_state_listen(Arena *a, void (*tell)(void *data, const double *number, uint32_t n), void *data) {
  (void)a;
  (void)tell;
  (void)data;
}
