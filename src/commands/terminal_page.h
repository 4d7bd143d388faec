/* Text for a terminal, filled to lines of at most 80 columns; and the Markdown of the reference as such text. */
#pragma once

#include "base/strbuf.h"

enum { PAGE_WIDTH = 80 };

/* Number of screen columns of a text. */
size_t page_columns(const char *text);

/* Appends the words of text[n], separated by single spaces; the current line has `column` columns already, the
 * following lines begin with `indent` spaces. Ends with a newline. */
void page_words(StrBuf *out, const char *text, size_t n, size_t column, size_t indent);

/* A term with its meaning from `column` on, or below it where the term is too long. */
void page_term(StrBuf *out, const char *term, const char *meaning, size_t column);

/* Paragraphs separated by empty lines; a line that begins with white space is preformatted. */
void page_paragraphs(StrBuf *out, const char *text);

/* Markdown of the reference, from its lines (each ends with a newline): headings, paragraphs, lists, tables, code,
 * links. Comments are left out. */
void page_markdown(StrBuf *out, const char *const *lines, size_t n);

/* A row of a table, "| a | b |", as a term and its meaning. */
void page_row(StrBuf *out, const char *line);

/* Appends the block that begins at lines[0], a paragraph, an item or a row "term: meaning", as plain text; nothing of
 * headings, comments and code. Returns its number of lines; *code: whether it is code. */
size_t page_block(StrBuf *out, const char *const *lines, size_t n, int *code);

/* The code of a block that page_block measured. */
size_t page_code(StrBuf *out, const char *const *lines, size_t n);
