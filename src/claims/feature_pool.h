/* Candidates for the factors of a monomial (monomial_fit.h): quantities of the model, each once, preferred ones
 * first. */
#pragma once

#include "claims/monomial_fit.h"

typedef struct {
  ExprGraph *g;
  int (*barred)(const void *data, Expr e); /* symbols and compounds that may not be candidates; NULL: none */
  const void *data;
  Expr at[FEATURES_MAX];
  uint32_t n;
} FeaturePool;

enum { POOL_SYMBOLS = 1, POOL_ANGLES = 2, POOL_COMPOUNDS = 4 };

/* Adds e, unless it is there or the pool is full. */
void pool_add(FeaturePool *pool, Expr e);

/* Adds the sine and the cosine of the angle. */
void pool_angle(FeaturePool *pool, Expr angle);

/* Adds what the nodes contain, of `what`: symbols of these kinds (bits 1 << SymKind); sines and cosines; sums and
 * other functions. */
void pool_nodes(FeaturePool *pool, ExprList nodes, unsigned what, unsigned kinds);
