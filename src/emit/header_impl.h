/* State and parts of an emitted header, shared by emit_header.c (names, head comment), header_declarations.c and header_definitions.c. */
#pragma once

#include "emit/cfunction.h"
#include "ir/unit.h"

typedef struct {
  const IrUnit *u;
  const IrScene *scene;
  Arena *a;
  StrBuf *out;
  const char *file;            /* name of the file without .h */
  const char *upper, *lower;   /* prefix of all names, in upper and lower case */
  CNames taken;                /* macros and enumerators of the header */
  const char **q, **z, **p, **in, **ev, **outputs; /* enumerators by index */
  const char *const *fields;   /* members of the struct of parameters */
  const char *const *globals;
} Header;

/* Append the declarations (macros, enums, structs, prototypes) and the definitions. */
void header_declarations(const Header *h);
void header_implementation(const Header *h);

/* Functions of a header; whether this model has function f; its prototype without `;`. */
typedef enum { FN_DEFAULTS, FN_PARAM, FN_START, FN_INPUTS, FN_ACCEL, FN_ENERGY, FN_CHARGES, FN_POWERS, FN_OBSERVE, FN_EVENTS, FN_ACT, FN_HOLD, FN_RK4_STEP, FN_RK4_STEP_WITH, FN_COUNT } HeaderFn;
int header_has(const Header *h, HeaderFn f);
const char *header_prototype(const Header *h, HeaderFn f);

/* Prototype broken into lines at its commas. */
const char *header_wrapped(const Header *h, const char *prototype);

/* "t, q, v, z, p, u" without arrays that the model lacks: as typed parameters, or as arguments with `from` ("s->")
 * before the members of the state. */
const char *header_state_args(const Header *h, int typed, const char *from);
