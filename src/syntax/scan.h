/* Scanner: text -> raw tokens, one at a time. The patterns are in grammar/lag.l, their actions here. */
#pragma once

#include "syntax/token.h"

typedef struct {
  Arena *arena;
  Interner *names;
  const Source *source;
  uint32_t begin, end; /* offsets of the text matched last */
  uint32_t touch;      /* end of the last token if a `[` that touches it is an index, else 0 */
  void *flex;          /* the generated scanner */
} Scan;

/* A scanner for one source; its memory comes from the arena. */
Scan *scan_new(Arena *a, Interner *names, const Source *source);

/* The next raw token: NEWLINE and SEMICOLON included, every name an IDENT; at the end always FINISH. */
Token scan_next(Scan *s);

/* Actions of the patterns of lag.l. Each fills t from the n matched bytes and returns how many of
 * them belong to the token (the rest is scanned again); t->kind FINISH means "skip them". */
int scan_sign(Scan *s, Token *t, TokKind kind, int n);
int scan_number(Scan *s, Token *t, const char *text, int n);
int scan_name(Scan *s, Token *t, const char *text, int n);
int scan_string(Scan *s, Token *t, const char *text, int n);
int scan_bracket(Scan *s, Token *t, const char *text, int n);
int scan_unknown(Scan *s, Token *t, const char *text, int n);
int scan_advice(Scan *s, Token *t, const char *text, int n, const char *write);

/* The generated scanner (lag.l): set up for s, and one token from it. */
void scan_open(Scan *s);
void scan_lex(Scan *s, Token *t);

/* Advice where brackets were meant for a list. */
#define LIST_IS_WRITTEN                                                                                           \
  "a vector is written `(0, 0, 1)`, a list `{1, 2}`, a matrix as a list of its rows: `param K[2,2] = {{2, 0.5}, " \
  "{0.5, 1}}`"

/* Parses the text of a unit, without brackets, that begins at offset `begin`, into t->unit. Returns 1
 * on success; on failure the token becomes BAD with place and message. (unit.c) */
int unit_parse(Scan *s, Token *t, const char *text, uint32_t n, uint32_t begin);

/* The code point at text (valid UTF-8 of at least one byte); *len is its length in bytes. */
uint32_t utf8_decode(const char *text, uint32_t *len);
