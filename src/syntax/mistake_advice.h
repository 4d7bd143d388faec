/* Advice for known mistakes: forms from other languages, or from paper, and their spelling here. */
#ifndef LAGC_SYNTAX_MISTAKE_ADVICE_H
#define LAGC_SYNTAX_MISTAKE_ADVICE_H

#include "syntax/parse_state.h"

/* Advice for a word that begins no statement in a place (W_...), or NULL. */
const char *advice_for_word(const char *word, unsigned where);

/* Advice where the current token cannot follow the previous one; set[n]: expected tokens. NULL: none. */
const char *advice_for_token(const Parse *cx, const TokKind *set, int n);

#endif
