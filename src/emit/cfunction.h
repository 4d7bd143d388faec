/* What all emitted files share: the macros of the scalar, the solver, a C function around a Prog,
 * text that may stand in a comment. */
#ifndef LAGC_CFUNCTION_H
#define LAGC_CFUNCTION_H

#include "emit/cwriter.h"

/* Choices and logic as macros (PREFIX_SELECT, PREFIX_MASK, ...), unless they are defined already:
 * vectors of numbers have no ternary in C. */
void csupport_logic(const char *prefix, StrBuf *out);

/* The function that solves blocks of a kind which are not solved in straight-line code: lower_solve, lower_solve_definite, lower_multiply (w[2 n] =
 * right-hand side, solution). Not SOLVE_CONSTRAINED: that is cmath_kkt. */
void csupport_solver(SolveKind kind, const char *prefix, const char *lower, StrBuf *out);

/* `static LAG_REAL lower_spline(t, n, row)`, for the inputs that have a table. */
void csupport_spline(const char *prefix, const char *lower, StrBuf *out);

/* The same in two functions, lag_factor(n, w) and lag_substitute(n, w), with w[n*n + 2 n] = matrix, right-hand side, order
 * of the rows: one factorization for several right-hand sides. */
void csupport_factor(const char *prefix, const char *lower, StrBuf *out);

/* lag_invert(n, w), which needs csupport_factor, with w as Solve in ir/prog.h says for IR_INVERT. */
void csupport_inverter(const char *prefix, const char *lower, StrBuf *out);

/* text with LAG_ and lag_ replaced by the prefix in upper and lower case. */
void csupport_fill(const char *text, const char *prefix, const char *lower, StrBuf *out);

typedef struct {
  const char *comment; /* without the marks of a comment; or NULL */
  const char *head;    /* up to the brace */
  int returns;         /* a status: OK, or whether all pivots were what they had to be */
  int own_work;        /* work space is a local array, not a parameter */
} CFunction;

/* What a function with the body of p returns at its end: PREFIX_OK, or what its pivots came to. */
const char *cfunction_status(const Prog *p, const CStyle *style);

/* The comment, the head, `(void)` for parameters that p does not need, the body. */
void cfunction(const Prog *p, const CStyle *style, const CFunction *f, StrBuf *out);

/* A body after `condition` (may be ""): on its line when it is one statement, or in braces. */
void cwrite_guarded(const char *condition, const char *body, StrBuf *out);

/* The shortest text that reads back as x. */
const char *double_text(Arena *a, double x);

#endif
