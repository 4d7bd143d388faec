/* One emitted file: shared by emit_model.c and what it writes by subject. */
#ifndef LAGC_EMIT_IMPL_H
#define LAGC_EMIT_IMPL_H

#include "emit/cfunction.h"
#include "ir/unit.h"

typedef struct {
  const IrUnit *u;
  Arena *a;
  const char *name;           /* of the lag_model */
  const char *const *globals; /* what a function's own names must not hide; NULL at the end */
  StrBuf *out;
  CIndices *indices;          /* those that stand in the file */
} File;

/* The parameters that all functions of a state have, up to what they write. */
extern const char *const emit_state_args;

/* A function with the body of p. own: the names of its parameters, written: those of its output arrays. */
void emit_function(const File *f, const Prog *p, const char *comment, const char *head, const char *const *own, const char *const *written);

/* How its function spells what is read and written. */
CStyle emit_style(const File *f, const char *const *own, const char *const *written);

/* emit_params.c: the functions that factor and invert matrices, where any are needed; the function `derive`; a scene's `params`. */
void emit_inverses(const File *f);
void emit_derive(const File *f);
void emit_params(const File *f, const IrScene *s, const char *id);

/* emit_charges.c: the functions and tables of charges; nothing where there are none. */
void emit_charges(const File *f);

#endif
