/* Token filter: raw tokens -> tokens of the grammar, with statement words, statement ends, and primes of dotted
 * names. */
#pragma once

#include "syntax/scan.h"

enum {
  FILTER_BLOCKS = 64,           /* blocks { } may be nested this deep */
  FILTER_BRACKETS = 1000 * 1000 /* and brackets of an expression this deep */
};

/* A bracket of the current statement that is still open. */
typedef struct {
  TokKind kind; /* LPAREN, INDEX, or LBRACE of a list */
  Span span;
  uint32_t dots; /* INDEX: primes of the name before it, emitted after the `]` */
} OpenBracket;

typedef struct {
  Scan *scan;
  Token ahead[2];  /* raw tokens already taken from the scanner */
  uint32_t n_ahead;
  int end_due;     /* a block was closed: the next token is an END */
  TokKind prev;    /* the last token emitted */
  Token primes;    /* the name whose dots become PRIMEs */
  uint32_t pending_primes;   /* number of PRIMEs still to be emitted */
  int single;      /* the text is one expression: no statement words, no blocks */
  int inside;      /* a statement has begun */
  TokKind word;    /* its statement word, or IDENT */
  int headed;      /* the shape of a `draw` was read, and nothing behind it */
  int assigned;    /* an `=` was seen since its last `,` outside brackets */
  int has_block;   /* its next `{` outside brackets opens a block */
  VEC(OpenBracket) brackets;
  uint32_t lists;  /* how many of them are LBRACE */
  Token open[FILTER_BLOCKS]; /* the `{` of each block around the statement */
  unsigned where[FILTER_BLOCKS + 1]; /* kind of each open block, W_FILE first */
  uint32_t depth;
} Filter;

/* A filter over a scanner; single: the text is one expression. */
Filter *filter_new(Scan *scan, int single);

/* The next token; FINISH for ever at the end, after an END for each statement. */
Token filter_next(Filter *f);

/* The innermost bracket that is still open in the current statement, or NULL. */
const OpenBracket *filter_open_bracket(const Filter *f);
