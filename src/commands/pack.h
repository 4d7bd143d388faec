/* Packs bytes for pages by liblzma (XZ Utils), which finds what the programs of scenes share, however far apart. */
#pragma once

#include "base/strbuf.h"

/* Appends n, as 4 bytes, the low one first, and the n bytes: as a stream of LZMA1 without a header, with lc = 0, lp =
 * 0, pb = 2 (I. Pavlov, LZMA specification, 2015), whose first byte is 0; where lagc was built without liblzma a byte 1
 * and the bytes as they are. Unpacked by runtime/page/motion.js. Returns 0 where they are not packed. */
int pack_append(const StrBuf *bytes, StrBuf *out);
