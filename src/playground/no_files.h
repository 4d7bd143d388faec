/* base/posix.h where there are no files: the paths of models. Copied by make. */
#pragma once

#include <string.h>

static inline int lag_is_absolute(const char *path) { return path[0] == '/'; }
static inline char *lag_last_slash(const char *path) { return strrchr(path, '/'); }
