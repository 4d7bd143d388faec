/* Parts common to all emitted files: the C function around the body of a Prog, and (embedded_math.c) what is taken from
 * the headers of runtime/include. */
#pragma once

#include "emit/cwriter.h"
#include "ir/program_set.h"

/* Appends text with LAG_ and lag_ replaced by the prefix in upper and lower case. */
void csupport_expand(const char *text, const char *prefix, const char *lower, StrBuf *out);

typedef struct {
  const char *comment; /* text of the comment, or NULL */
  const char *head;    /* declaration up to the brace */
  int returns;         /* 1: returns a status, see cfunction_status */
  int own_work;        /* 1: the workspace w is a local array, not a parameter */
} CFunction;

/* Status that a function with the body of p returns: PREFIX_OK, or PREFIX_PIVOTS_STATUS if p checks pivots. */
const char *cfunction_status(const Prog *p, const CStyle *style);

/* Appends the function: comment, head, `(void)` for unused parameters, body, return. */
void cfunction(const Prog *p, const CStyle *style, const CFunction *f, StrBuf *out);

/* Appends the values of parameters, stores under the style's guard: one parameter is computed under it, too. */
void cwrite_params(const IrParams *x, CStyle style, Arena *a, StrBuf *out);

/* Shortest text that reads back as x; integers below 1e9 without exponent. */
const char *shortest_double(Arena *a, double x);

/* Section NAME of a text of the runtime: include/lag_math.h, lag_kkt.h, kernels/. */
void embedded_section(const char *name, const char *prefix, const char *lower, StrBuf *out);

/* Needs of a file from the headers of runtime/include, with the prefix of its names. solver: of dense linear
 * systems. */
typedef struct {
  const ProgramSet *u;
  const char *prefix, *lower;
  int solver;
} MathText;

/* Vector lanes (PREFIX_LANES): mask type, selection, functions lane by lane. Must precede everything that has a
 * default. */
void math_lanes(const MathText *m, StrBuf *out);

/* Macros and prototypes: selection and logic (PREFIX_SELECT, PREFIX_MASK, ...), lower_sincos, exp and log over lanes,
 * lower_solve, lower_kkt, lower_spline and lower_curve. Must follow PREFIX_FN and PREFIX_C. */
void math_front(const MathText *m, StrBuf *out);

/* The functions themselves, which stand behind those of the model. */
void math_bodies(const MathText *m, StrBuf *out);

/* Text before a model: includes of the runtime's headers, or, alone, all fronts. */
void math_of_model(const MathText *m, int alone, StrBuf *out);

/* lower_rough_power(x, p), for step sizes. */
void math_power(const char *prefix, const char *lower, StrBuf *out);

/* Whether some program of the unit calls a function of the C library. */
int unit_calls(const ProgramSet *u, const char *name);

/* Prefix of sincos, sin and cos in emitted code of the unit (`lower`); NULL: the C library's sin and cos. */
const char *math_prefix(const ProgramSet *u, const char *lower);

/* Sentence for the head of the file: where its elementary functions come from. */
const char *math_source_text(const ProgramSet *u);
