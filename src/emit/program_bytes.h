/* Texts of bytes: numbers in little endian, each a multiple of four bytes, for programs that liblag evaluates. */
#pragma once

#include "ir/program_set.h"

void put_word(StrBuf *out, uint32_t x);
void put_words(StrBuf *out, const uint32_t *x, uint32_t n); /* n first */
void put_signed(StrBuf *out, int64_t x);
void put_number(StrBuf *out, double x);
void put_text(StrBuf *out, const char *s); /* NULL is not "" */

/* Appends the code of a program (numeric/program_code.def); NULL: none. own: sines and cosines are lag_math.h's;
 * regular: linear systems were found regular before. Returns the number of its frame's values. */
typedef struct {
  int own, regular;
} CodeStyle;
void put_program(StrBuf *out, const Prog *p, CodeStyle style);
