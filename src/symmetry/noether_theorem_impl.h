/* Shared by noether_theorem.c and potential_forces.c: one generator and what is known of it. */
#pragma once

#include "symmetry/noether_theorem.h"

typedef struct {
  const Eqns *e;
  const Model *m;
  ExprGraph *g;
  uint32_t n;
  SymId *q, *v;     /* [n] */
  Expr L;
  const Expr *p;    /* [n] */
  const Expr *xi;   /* [n] */
  Expr tau;
  Expr *Dxi, Dtau;  /* total time derivatives */
  uint32_t symbols; /* entries of a seed */
  Expr *along, *moving; /* seeds of d/dt and of the generator, by symbol */
  int by_value;
  /* a constraint whose states were sought, but perhaps not on each of its factors; or NULL */
  const Constraint *product;
} ProofWork;

static inline Expr proof_node(const ProofWork *w, SymId s) { return expr_symbol(w->g, s)->node; }
/* Whether some constraint always holds, which those of contacts do not. */
static inline int proof_is_constrained(const ProofWork *w) { return w->e->constraints.n > w->m->contacts.n; }

Expr noether_shorten(const ProofWork *w, Expr x);
Expr noether_at_rest(const ProofWork *w, Expr x);
/* d/dt along q'. */
Expr noether_total(const ProofWork *w, Expr x);

/* V(q, t) with power = -dV/dt along motions, of forces and explicit time; 0: none. *exists: whether
 * there may be one, as Noether.open_integral. */
Expr noether_potential(const ProofWork *w, Expr power, int *exists);
