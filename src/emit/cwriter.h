/* Prog -> the body of a C function.
 *
 * Reads only the Prog. Values that are used once and have no name become part of the expression
 * that uses them; all other values are `const` variables, with the user's name if they have one. */
#pragma once

#include "emit/cnames.h"
#include "ir/prog.h"

/* Names and options of the C code of a function. */
typedef struct {
  const char *prefix;               /* of the macros: `LAG` gives LAG_REAL, LAG_FN, LAG_C, LAG_SELECT, LAG_ESINGULAR */
  const char *const *in;            /* [ARR_COUNT] names of the arrays read; t is a scalar */
  const char *const *params;        /* member name of each parameter (p->name); NULL: an array (p[3]) */
  const char *const *out;           /* names of the arrays written */
  int apart;                        /* 1: no element is both read and written, even where an array is */
  /* bit i: stores to out[i] go two at a time, through PREFIX_PAIR(array, index, x, y) */
  unsigned paired;
  unsigned padded;                  /* bit i: out[i] has room for a pair where the last element has no partner */
  const char *const *own;           /* names in the function's scope, NULL at the end */
  const char *const *globals;         /* names that the function must not hide, NULL at the end; or NULL */
  const char *solve, *kkt;          /* functions that solve a linear system, and one with constraints */
  /* 1: linear systems were found regular before, and the function returns no status */
  int is_regular;
  const char *spline, *curve;       /* functions that evaluate tables: cubics, and derivatives of quintics */
  const char *const *rows;          /* names of the arrays of table rows; NULL: the body declares them */
  int prefer_short_code;                /* 1: prefer short code to fast code */
  const char *math;                 /* prefix of the embedded sincos, sin and cos; NULL: LAG_FN(sin) */
  double times;                     /* as in ProgramSet; 0: 1 */
  int turns;                        /* 1: LAG_TURNS turns of a nest side by side, where it may be */
  const char *guard;                /* array of flags of elements that stores leave alone; NULL: none */
  int loads_inline;                 /* 1: array elements are spelled at each use, not named at the top */
} CStyle;

/* Appends the body, without braces, indented by two spaces. */
void cwrite_body(const Prog *p, const CStyle *style, Arena *a, StrBuf *out);

/* Appends `static const PREFIX_LANE NAME[n][3] = {...};` with the rows of a table. */
void cwrite_rows(const IrTable *table, const char *name, const char *prefix, const char *indent, Arena *a, StrBuf *out);

/* "36 operations: 12 additions, 18 multiplications, 2 divisions, 4 calls of sin, cos, ..." */
const char *op_count_text(const Prog *p, Arena *a);

/* Whether the program computes reciprocals of distances cubed by a call for several. */
int ccubes_some(const Prog *p);

/* Whether the program, or a body of its nests, reads the array. */
int prog_reads(const Prog *p, IrArray array);

/* A C string literal, with quotes. */
const char *c_string(Arena *a, const char *s);

/* Text safe inside a C comment: spaces break up comment marks and trigraphs in s. */
const char *comment_text(Arena *a, const char *s);

/* A number as a C constant of type PREFIX_REAL; exact rationals are exact in every precision. */
const char *c_number(Arena *a, const char *prefix, Num n);
const char *c_number_by(Arena *a, const char *macro, Num n); /* as an argument of this macro */
