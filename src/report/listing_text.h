/* Writer of listings of equations, as text and as LaTeX. */
#pragma once

#include "mech/eqns.h"
#include "sym/print.h"

/* A line of a block: an equation, or words. */
typedef struct {
  const char *words, *name; /* words NULL: an equation; name NULL: of the expression `left` */
  Expr left, right;
  int last;
} TextRow;

typedef struct {
  const Eqns *e;
  ExprGraph *g;
  PrintStyle style;
  StrBuf *out;
  size_t block;      /* where the lines of the last heading begin */
  VEC(TextRow) rows; /* of the block, not written yet */
} Text;

int text_latex(const Text *t);

/* Model, scene and effects, on the first lines. */
void text_title(Text *t);

/* The block of momenta. */
void text_momenta(Text *t);

/* The block of constraints, if there are some. */
void text_constraints(Text *t);

/* For each declared symmetry: F if there is one, the charge, and its balance if it is not conserved. */
void text_charges(Text *t);

/* A block of equations, from its heading to its end, where equations of a family's members become one. */
void text_heading(Text *t, const char *title);
void text_end(Text *t);

/* Appends an expression, which is read again and compared (an internal error in the model's diags where it is another);
 * past a limit its length instead, as an expression that shares its parts can be far longer in writing than to compute.
 */
void text_expr(Text *t, Expr e);

/* Appends "  left = right", aligned in LaTeX; last: the block's last line. */
void text_equation(Text *t, Expr left, Expr right, int last);
void text_named(Text *t, const char *text, const char *in_latex, Expr right, int last);

const char *text_latex_name(Text *t, Name name);

/* The definitions that these expressions need, each before its use. */
void text_definitions(Text *t, const Expr *roots, uint32_t n);
