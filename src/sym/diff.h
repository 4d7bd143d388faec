/* Differentiation on the graph: never on a tree, each node once. Forward mode: Wengert (1964). Reverse mode:
 * Linnainmaa (1976); Griewank & Walther, Evaluating Derivatives (2008), chapters 3.1 and 3.2. */
#pragma once

#include "sym/expr.h"

/* de/dsym. */
Expr expr_diff(ExprGraph *g, Expr e, SymId sym);

/* out[i] = de/d(syms[i]) for all i in one reverse sweep. Adjoints of definitions that are sums or long products
 * become definitions themselves, so that the derivative of a chain of lets stays as long as the chain. */
void expr_gradient(ExprGraph *g, Expr e, const SymId *syms, uint32_t n, Expr *out);

/* Nonzero derivatives of e by the symbols of one kind with index < below, in ascending index. Work grows with the
 * nodes of e, not with the symbols of the model. */
typedef struct {
  uint32_t index; /* index of the symbol within its kind */
  Expr e;
} ExprPartial;

typedef struct {
  const ExprPartial *at;
  uint32_t n;
} ExprPartials;

ExprPartials expr_gradient_sparse(ExprGraph *g, Expr e, SymKind kind, uint32_t below);

/* Seeds of the symbols first .. first + n - 1; 0: zero. */
typedef struct {
  const Expr *at;
  uint32_t n;
  SymId first;
} ExprSeeds;

/* Directional derivatives out[i] = sum over symbols s of d(roots[i])/ds times their seed.
 * The derivative of a definition `a` becomes the definition `a` + suffix ("'" for the total time derivative). known:
 * derivatives of definitions from earlier calls with the same seed, read and extended; or NULL. */
void expr_tangent(ExprGraph *g, const Expr *roots, uint32_t n, ExprSeeds seed, const char *suffix, ExprMap *known,
                  Expr *out);
