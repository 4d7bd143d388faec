/* Drawings: statements and guesses become shapes, whose places and sizes are outputs of the scene. */
#pragma once

#include "model/builder.h"

enum { CURVE_PARTS = 64, MOST_SHAPES = 20000 };

typedef struct {
  Builder *b;
  ExprMap column;  /* [Expr] output + 1 */
  Dim place;       /* dimension of places; DIM_ANY: none yet */
} Drawing;

/* Index of the output that has the value, an angle or a count where dim is DIM_NONE; added when new. */
int drawn_value(Drawing *d, Expr value, Dim dim);
/* Output of each component of a place, the others -1. */
void drawn_place(Drawing *d, const Value *v, int out[3]);
/* Adds a shape without values. */
Shape *add_shape(Drawing *d, ShapeKind kind, const char *role, const char *text);

/* guess_drawing.c: shapes of a model without `draw`. */
void guess_drawing(Drawing *d);
