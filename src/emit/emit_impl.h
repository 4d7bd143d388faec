/* State of one emitted model file, shared by emit_model.c, emit_params.c and emit_charges.c. */
#ifndef LAGC_EMIT_IMPL_H
#define LAGC_EMIT_IMPL_H

#include "emit/cfunction.h"
#include "ir/unit.h"

typedef struct {
  const IrUnit *u;
  Arena *a;
  const char *name;           /* identifier of the lag_model */
  const char *const *globals; /* names that functions must not hide, NULL at the end */
  StrBuf *out;
} File;

/* Input parameters common to all functions of a state, as C text. */
extern const char *const emit_state_args;

/* Appends a function with the body of p. own: names of its parameters; written: names of its output arrays. */
void emit_function(const File *f, const Prog *p, const char *comment, const char *head, const char *const *own, const char *const *written);

/* Style of a function of this file. */
CStyle emit_style(const File *f, const char *const *own, const char *const *written);

/* emit_params.c: the function `derive`; a scene's `params`. */
void emit_derive(const File *f);
void emit_params(const File *f, const IrScene *s, const char *id);

/* emit_charges.c: functions and tables of conserved charges; nothing for a model without charges. */
void emit_charges(const File *f);

#endif
