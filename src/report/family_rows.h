/* Equations of a family's members as one with an index. */
#pragma once

#include "base/strbuf.h"
#include "sym/print.h"

/* The lines of a block, each with its end, where five or more that follow one another differ by an index alone
 * written once: `u[i]'' = u[i + 1] - u[i]  for i in 2..9`. */
const char *family_rows(Arena *a, const char *lines, PrintStyle style);
