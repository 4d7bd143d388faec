/* Cache of simulators, and of the reference motions that they computed: an entry is named by a hash of its texts,
 * and run only where nobody but the user can have written it. */
#pragma once

#include "base/strbuf.h"

/* The cache's folder, made if need be; NULL: no folder that only the user can write. */
const char *cache_folder(Arena *a);
/* Removes the folders of killed builds, by their locks. Called before the first build of a command. */
void cache_remove_stale_builds(Arena *a);

/* A folder for one build, with a lock that its process holds until it ends, across exec. */
typedef struct {
  const char *path;
  int lock;
} BuildFolder;

/* Makes a build folder in the folder `base`. Returns 0, with errno, on failure. */
int build_folder_make(Arena *a, const char *base, BuildFolder *f);
/* Removes the folder and its files. */
void build_folder_remove(BuildFolder *f);

/* Whether the simulator is there, whole and the user's own; otherwise it is built anew. Marks the entry as used. */
int cache_has(const char *path);
/* The same for a reference, beside its simulator with a suffix of eight digits. */
int cache_has_data(const char *path);
/* Appends CACHE_SEAL bytes, size and hash, to a file that becomes an entry: files cut short by a loss of power, or
 * overwritten, are built anew. 0: not written. */
enum { CACHE_SEAL = 41 };
int cache_seal(const char *path);
/* Writes a text as an entry. 0: not written. */
int cache_write(const char *path, const StrBuf *text);
/* Appends the text of an entry. 0: it is not there, not whole or not the user's own. */
int cache_read(const char *path, StrBuf *out);
/* Waits while another process builds this entry, as ranks of mpirun do together; then others wait, until cache_give.
 * A descriptor; -1: locks do not work there. */
int cache_take(Arena *a, const char *path);
void cache_give(Arena *a, const char *path, int lock);
/* Removes the entries used longest ago, except `keep`, until the cache is within its limit. */
void cache_limit(Arena *a, const char *keep);

/* lagc cache: prints folder, number, size and limit. lagc cache --clear: removes all entries. */
void cache_print(Arena *a, StrBuf *out);
void cache_clear(Arena *a, StrBuf *out);
