/* A guessed drawing: its points, and what joins them. */
#pragma once

#include "model/drawing.h"

typedef struct {
  Expr at[3]; /* 0: a component that the point has not */
  uint32_t n;
  const char *text; /* its names, or NULL for members of families */
  Expr radius;      /* 0: none is known */
} DrawnPoint;

typedef struct {
  Drawing *d;
  VEC(DrawnPoint) points;
  VEC(DrawnPoint) pivots; /* that arms hang from, and move */
  ExprMap stretched; /* terms of the squares of the potential */
} Guess;

/* 1 if e changes with the motion or with time. */
int changes(const ExprGraph *g, Expr e);
/* A shape between two places of n components. */
void add_link(Guess *k, ShapeKind kind, const char *role, const Expr *a, const Expr *b, uint32_t n);

/* guess_links.c: rods of arms l*sin(th), of constraints; springs of the potential; walls of contacts, which also know
 * radii of points. */
void note_squares(Guess *k); /* first: Guess.stretched */
void guess_arms(Guess *k);
void guess_rods(Guess *k);
void guess_springs(Guess *k);
void guess_walls(Guess *k);
