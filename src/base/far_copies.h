/* Long passages that occur again, however far apart: a step before deflate, whose window is 32 KiB. */
#pragma once

#include "base/strbuf.h"

/* Appends the bytes as records: n, n bytes as they are, then from and m, a copy of m bytes at `from` of what the
 * records give so far; numbers as 4 bytes, the low one first. */
void far_copies_append(const StrBuf *bytes, StrBuf *out);
