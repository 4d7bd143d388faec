/* base/posix.h where there are no files: what base/source.c and the paths of models need. Copied by make. */
#pragma once

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define O_NOCTTY 0
#define lag_read_error() "a page has no files"
#define strerror(number) ((void)(number), lag_read_error())
static inline FILE *lag_open_to_read(const char *path) { return fopen(path, "rb"); }
static inline int lag_is_absolute(const char *path) { return path[0] == '/'; }
static inline char *lag_last_slash(const char *path) { return strrchr(path, '/'); }
