/* Look-ups in the table of tokens (token.h). */
#include "syntax/token.h"

typedef struct {
  const char *word;
  unsigned flags;
} TokenInfo;

#define TOKEN_INFO_(name, word, flags) {word, flags},
static const TokenInfo info[TOK_COUNT] = {TOKENS(TOKEN_INFO_)};
#undef TOKEN_INFO_

const char *token_word(TokKind kind) { return info[kind].word; }
unsigned token_flags(TokKind kind) { return info[kind].flags; }

TokKind token_statement(Name name, unsigned where) {
  for (int k = TOK_MODEL; k <= TOK_STOP; k++)
    if ((info[k].flags & where & W_ANY) && strcmp(info[k].word, name) == 0) return (TokKind)k;
  return TOK_IDENT;
}
