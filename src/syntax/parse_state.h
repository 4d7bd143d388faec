/* State of one parse of one text, shared by parse.c, syntax_errors.c and the generated parser. */
#pragma once

#include "syntax/ast_build.h"
#include "syntax/token_filter.h"

enum { PARSE_STACK = 4 * 1000 * 1000 }; /* entries of the parser's stack: limit of nesting */

struct lag_pstate;

typedef struct {
  Ast *ast;
  Filter *filter;
  struct lag_pstate *stack; /* the parser's own memory: malloc, freed by parse_close */
  Token current, before;    /* current and previous token */
  OpenBracket open;         /* the innermost bracket still open before the current token */
  int reported;             /* a mistake was reported at the current token */
  StmtList stmts;           /* the result: statements of a file, */
  AstId value;              /* or one expression */
} Parse;

/* The generated parser (lag.y). parse_push returns 1 while it needs more tokens. */
void parse_open(Parse *cx);
int parse_push(Parse *cx, const Token *t);
void parse_close(Parse *cx);

/* Its callbacks: results (parse.c) and errors (syntax_errors.c). */
void parse_done_file(Parse *cx, StmtList stmts);
void parse_done_value(Parse *cx, AstId value);
void parse_report(Parse *cx, const TokKind *expected, int n);
void parse_too_deep(Parse *cx, Span span);

/* mistake_advice.c: advice for a word that begins no statement in a place (W_...), or NULL. */
const char *advice_for_word(const char *word, unsigned where);

/* Advice where the current token cannot follow the previous one; set[n]: expected tokens. NULL: none. */
const char *advice_for_token(const Parse *cx, const TokKind *set, int n);
