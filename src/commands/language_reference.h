/* Chapters of the language reference, grammar/LANGUAGE.md, built into lagc for `lagc help`.
 *
 * A chapter runs from a heading (## or ###) to the next. A comment below the heading lists the words that it explains;
 * the first one names the chapter: <!-- help: scenes scene start span --> */
#ifndef LAGC_COMMANDS_LANGUAGE_REFERENCE_H
#define LAGC_COMMANDS_LANGUAGE_REFERENCE_H

#include "base/strbuf.h"
#include "base/vec.h"

typedef struct {
  const char *const *lines; /* the heading first */
  size_t n;
  const char *words; /* "scenes scene start span"; "" where there is no comment */
} Chapter;

typedef VEC(Chapter) Chapters;

void reference_chapters(Arena *a, Chapters *out);

/* The text of the chapter's heading. */
const char *chapter_title(Arena *a, const Chapter *c);

/* Appends the chapter's text on a word: rows of tables that begin with it; for one of the chapter's own words also items of
 * lists that do, or, without any, the whole chapter. Returns 0 when there is nothing. */
int chapter_print(StrBuf *out, const Chapter *c, const char *word);

#endif
