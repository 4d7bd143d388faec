/* LZMA1 without a header: literals and copies from any distance, by a range coder that learns. I. Pavlov, LZMA
 * specification, 2015; lc = 0, lp = 0, pb = 2. Decoded by runtime/page/motion.js. */
#pragma once

#include "base/strbuf.h"

/* Appends n, as 4 bytes, the low one first, and the stream of the n bytes. */
void lzma_append(const StrBuf *bytes, StrBuf *out);
