/* Parts common to all emitted files: the C function around the body of a Prog, and (embedded_math.c) what is taken from
 * the headers of runtime/include. */
#pragma once

#include "emit/cwriter.h"

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

/* Appends a body after `condition` (may be ""): a single statement on the same line, more in braces. */
void cwrite_guarded(const char *condition, const char *body, StrBuf *out);

/* Shortest text that reads back as x; integers below 1e9 without exponent. */
const char *shortest_double(Arena *a, double x);

/* Section NAME of a text of the runtime: include/lag_math.h, lag_kkt.h, kernels/. */
void embedded_section(const char *name, const char *prefix, const char *lower, StrBuf *out);

/* The generic text of a model file: the runtime's headers that it needs, or, alone, their sections. solver: of dense systems. */
void math_of_model(const ProgramSet *u, int solver, int alone, StrBuf *out);

/* Macros for selection and logic (PREFIX_SELECT, PREFIX_MASK, ...), each under #ifndef: vector types have no ternary in C. */
void math_logic(const char *prefix, StrBuf *out);

/* Function that solves a linear system in a loop: lower_solve. With constraints: see math_kkt_solver. */
void math_solver(const char *prefix, const char *lower, StrBuf *out);

/* `static LAG_REAL lower_spline(t, n, row)` and `lower_curve(t, n, row, order)`, for inputs given by a table: cubics, and
 * quintics with their derivatives. */
void math_curves(const ProgramSet *u, const char *prefix, const char *lower, StrBuf *out);

/* Vector lanes (PREFIX_LANES): mask type, selection, functions lane by lane. Must precede everything that has a default. */
void math_lanes(const char *prefix, const char *lower, StrBuf *out);

/* Functions that the unit calls and that do not come from the C library: lower_sincos, lower_sin, lower_cos, and exp and log
 * over lanes. Must follow PREFIX_FN and PREFIX_C. */
void math_functions(const ProgramSet *u, const char *prefix, const char *lower, StrBuf *out);

/* lower_rough_power(x, p), for step sizes. */
void math_power(const char *prefix, const char *lower, StrBuf *out);

/* `static LAG_MASK lower_kkt(n, m, coarse, w)`, if the model has constraints. */
void math_kkt_solver(const ProgramSet *u, const char *prefix, const char *lower, StrBuf *out);

/* Whether some program of the unit calls a function of the C library. */
int unit_calls(const ProgramSet *u, const char *name);

/* Prefix of sincos, sin and cos in emitted code of the unit (`lower`); NULL: the C library's sin and cos. */
const char *math_prefix(const ProgramSet *u, const char *lower);

/* Sentence for the head of the file: where its elementary functions come from. */
const char *math_source_text(const ProgramSet *u);
