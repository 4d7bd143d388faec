/* The parts of an emitted header: emit_header.c (names, head), header_decl.c, header_body.c. */
#ifndef LAGC_HEADER_IMPL_H
#define LAGC_HEADER_IMPL_H

#include "emit/cfunction.h"
#include "ir/unit.h"

typedef struct {
  const IrUnit *u;
  const IrScene *scene;
  Arena *a;
  StrBuf *out;
  const char *file;            /* without .h */
  const char *upper, *lower;   /* the prefix */
  CNames taken;                /* macros and enumerators */
  const char **q, **z, **p, **in, **ev, **outputs; /* enumerators */
  const char *const *fields;   /* members of the struct of parameters */
  const char *const *globals;
  CIndices *indices;           /* those that stand in the file */
} Header;

/* Macros, enums, structs and prototypes; the definitions. */
void header_declarations(const Header *h);
void header_implementation(const Header *h);

/* The functions of a header; whether this model has one; its prototype without `;`. */
typedef enum { FN_DEFAULTS, FN_PARAM, FN_START, FN_INPUTS, FN_ACCEL, FN_ENERGY, FN_CHARGES, FN_POWERS, FN_OBSERVE, FN_EVENTS, FN_ACT, FN_HOLD, FN_RK4_STEP, FN_RK4_STEP_WITH, FN_COUNT } HeaderFn;
int header_has(const Header *h, HeaderFn f);
const char *header_prototype(const Header *h, HeaderFn f);

/* A prototype, broken into lines at its commas. */
const char *header_wrapped(const Header *h, const char *prototype);

/* "t, q, v, z, p, u" without the arrays that the model does not have: as parameters with their
 * types, or as arguments with `from` ("s->") before what is in the state. */
const char *header_state_args(const Header *h, int typed, const char *from);

#endif
