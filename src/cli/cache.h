/* Simulators that are kept: named by what they were made of, run only where nobody but the user can have put them. */
#ifndef LAGC_CACHE_H
#define LAGC_CACHE_H

#include "base/strbuf.h"

/* The folder, made if need be; NULL where there is none that only the user can write. */
const char *cache_folder(Arena *a);
/* A folder to build in: the cache, or one for temporary files in which others cannot take what is the user's; NULL: none. */
const char *cache_build_folder(Arena *a);
/* Removes what builds that were killed have left. Before the first build of a command. */
void cache_remove_remains(Arena *a);

/* Whether the simulator at path is as it was sealed: what a full disk or a crash cut short is built anew, and what others can have
 * written, too. It counts as used. seal notes its checksum beside it; should that fail, the simulator is built anew the next time. */
int cache_is_whole(Arena *a, const char *path);
void cache_seal(Arena *a, const char *path);
/* Removes what was used longest ago until the cache is within its limit; not `keep`. */
void cache_limit(Arena *a, const char *keep);

/* lagc cache: folder, number, size and limit; clear: all entries go. */
void cache_print(Arena *a, StrBuf *out);
void cache_clear(Arena *a, StrBuf *out);

#endif
