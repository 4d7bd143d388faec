/* Slips with a known cure: what people write who have read other languages, or paper, and what stands for it here. */
#ifndef LAGC_SLIPS_H
#define LAGC_SLIPS_H

#include "syntax/parse_state.h"

/* A way out for a word that begins no statement in a place (W_...), or NULL. */
const char *slip_word(const char *word, unsigned where);

/* A way out where the token in hand cannot follow the one before it; set[n] are the tokens that could. Or NULL. */
const char *slip_token(const Parse *cx, const TokKind *set, int n);

#endif
