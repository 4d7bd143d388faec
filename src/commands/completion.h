/* `lagc complete WORD...`: candidates for the last WORD of a command line, asked for by the shells' completion scripts
 * (complete.bash, .zsh and .fish), so that every shell knows what the parser knows.
 *
 * WORDs are the words after `lagc`; the last one ends at the cursor and may be empty. Each line of the answer is a candidate for
 * the whole word, a tab, and a description; no space follows a candidate that ends in `=` or `(`. The line `:files SUFFIX...`
 * stands for the names of files with one of these suffixes (without any: of all files), after the `=` in words like --output=FILE. */
#ifndef LAGC_COMMANDS_COMPLETION_H
#define LAGC_COMMANDS_COMPLETION_H

#include "base/strbuf.h"

/* Appends the candidates for words[n]. argv0: the name that lagc was called by. Mistakes in the model are ignored. */
void complete(StrBuf *out, const char *const *words, size_t n, const char *argv0);

#endif
