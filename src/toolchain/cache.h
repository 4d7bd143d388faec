/* Cache of simulators: an entry is named by a hash of its texts, and run only where nobody but the user can have written it. */
#ifndef LAGC_TOOLCHAIN_CACHE_H
#define LAGC_TOOLCHAIN_CACHE_H

#include "base/strbuf.h"

/* The cache's folder, made if need be; NULL: no folder that only the user can write. */
const char *cache_folder(Arena *a);
/* A folder to build in: the cache, or a temporary folder where others cannot replace the user's files; NULL: none. */
const char *cache_build_folder(Arena *a);
/* Removes the folders of killed builds. Called before the first build of a command. */
void cache_remove_stale_builds(Arena *a);

/* Whether the simulator at path matches its seal and is the user's own; otherwise it is built anew. Marks the entry as used. */
int cache_is_whole(Arena *a, const char *path);
/* Writes the simulator's checksum beside it; on failure the simulator is built anew the next time. */
void cache_seal(Arena *a, const char *path);
/* Removes the entries used longest ago, except `keep`, until the cache is within its limit. */
void cache_limit(Arena *a, const char *keep);

/* lagc cache: prints folder, number, size and limit. lagc cache --clear: removes all entries. */
void cache_print(Arena *a, StrBuf *out);
void cache_clear(Arena *a, StrBuf *out);

#endif
