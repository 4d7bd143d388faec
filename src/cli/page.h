/* Text for a terminal: words in lines of at most 80 columns, and the Markdown of the reference as such text. */
#ifndef LAGC_PAGE_H
#define LAGC_PAGE_H

#include "base/strbuf.h"

enum { PAGE_WIDTH = 80 };

/* Columns that a text takes. */
size_t page_columns(const char *text);

/* Puts the words of text[n], one space between two; the line that is under way has `column` columns, the lines
 * after it begin with `indent` spaces. Ends with a newline. */
void page_words(StrBuf *out, const char *text, size_t n, size_t column, size_t indent);

/* A term, and what it means beside it, or below it where the term is too long. */
void page_term(StrBuf *out, const char *term, const char *meaning, size_t column);

/* Paragraphs with empty lines between them; a line that begins with white space stands as it is. */
void page_paragraphs(StrBuf *out, const char *text);

/* Markdown, as far as the reference uses it, from its lines (each ends with a newline): headings, paragraphs, lists,
 * tables, code, links. Comments are left out. */
void page_markdown(StrBuf *out, const char *const *lines, size_t n);

/* A row of a table, "| a | b |", as a term and its meaning. */
void page_row(StrBuf *out, const char *line);

#endif
