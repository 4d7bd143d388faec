/* Prog -> the body of a C function.
 *
 * Reads only the Prog. Values that are used once and have no name become part of the expression
 * that uses them; everything else is a `const` with the user's name where there is one. */
#ifndef LAGC_CWRITER_H
#define LAGC_CWRITER_H

#include "emit/cindex.h"
#include "emit/cnames.h"
#include "ir/prog.h"

/* How a function spells things: `LAG` gives LAG_REAL, LAG_FN, LAG_C, LAG_SELECT, LAG_ESINGULAR. */
typedef struct {
  const char *prefix;               /* of the macros */
  const char *const *in;            /* [ARR_COUNT] names of the arrays read: t is no array */
  const char *const *params;        /* NULL: p[3]; else p->name of parameter i, read and written */
  const char *const *out;           /* names of the arrays written */
  int apart;                        /* no element is written that is read, though arrays are both */
  unsigned paired;                  /* bit i: stores to out[i] go two at a time, through PREFIX_PAIR(array, index, x, y); */
  unsigned padded;                  /* and there is room for two where the last stands alone */
  const char *const *own;           /* names in the function's scope, NULL at the end */
  const char *const *globals;         /* names that the function must not hide, NULL at the end; or NULL */
  const char *solve, *kkt;          /* names of the functions that factor and solve; with constraints */
  const char *invert, *multiply;    /* once, and with what that leaves: of matrices that depend on parameters alone */
  const char *factor, *substitute;  /* instead of it, where factors are kept; or NULL */
  const char *spline;               /* name of the function that evaluates tables, */
  const char *const *rows;          /* and of their arrays; NULL: they stand in the body */
  CIndices *indices;                /* the file's tables of indices, those of the program among them; NULL: they stand in the body */
  int seldom_called;                /* shorter code is worth more here than the last nanosecond */
  const char *math;                 /* prefix of sincos, sin and cos where they come with the file; NULL: LAG_FN(sin) */
  int loads_inline;                 /* spell loads at their use instead of naming them at the top */
} CStyle;

/* Appends the body, without braces, indented by two spaces. */
void cwrite_body(const Prog *p, const CStyle *style, Arena *a, StrBuf *out);

/* `static const double NAME[n][3] = {...};` with the rows of a table. */
void cwrite_rows(const IrTable *table, const char *name, const char *indent, Arena *a, StrBuf *out);

/* "36 operations: 12 additions, 18 multiplications, 2 divisions, 4 calls of sin, cos, ..." */
const char *ops_text(const Prog *p, Arena *a);

/* Whether the program reads that array. */
int prog_reads(const Prog *p, IrArray array);

/* A C string literal, with quotes. */
const char *c_string(Arena *a, const char *s);

/* s with spaces where it would end the comment, open another, or spell a trigraph. */
const char *comment_text(Arena *a, const char *s);

/* A number as a C constant of the style's scalar: exact decimals are exact in every precision. */
const char *c_number(Arena *a, const char *prefix, Num n);

#endif
