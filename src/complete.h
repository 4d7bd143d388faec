/* `lagc complete WORD...`: what a shell may offer for the last WORD of a command line. The scripts of completion
 * (src/cli/complete.bash and its kin) ask it, so that all shells know what the parser knows, and nothing twice.
 *
 * WORDs are those after `lagc`, the last one as far as the cursor, perhaps empty. Each line of the answer is a candidate for
 * the whole word, a tab, and a description; after a candidate that ends in `=` or `(` the user goes on without a space. The
 * line `:files SUFFIX...` stands for the names of files with one of these suffixes, or, without any, of all files; where
 * a file's name is only the last part of the word, it begins after the `=`. */
#ifndef LAGC_COMPLETE_H
#define LAGC_COMPLETE_H

#include "base/strbuf.h"

/* Appends the answer for words[n]. argv0 is what lagc was called as. What is wrong with the model is no matter here. */
void complete(StrBuf *out, const char *const *words, size_t n, const char *argv0);

#endif
