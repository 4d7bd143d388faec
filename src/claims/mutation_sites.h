/* Sites: the places of an expectation where an edit may be made, and the role of each in the formula around it. */
#pragma once

#include "mech/eqns.h"

typedef enum {
  SITE_ROOT,      /* a whole side */
  SITE_TERM,      /* of a sum */
  SITE_FACTOR,    /* of a product */
  SITE_NUMERATOR, /* dividend of a /, or operand of a unary minus */
  SITE_DIVISOR,
  SITE_BASE,      /* of a power */
  SITE_ARGUMENT,  /* of a function of one number */
  SITE_PART       /* left part of a longer chain of + and -, or of * and /: no place of its own */
} SiteRole;

typedef struct {
  AstId node;
  AstId up;     /* the node above; 0 for a whole side */
  int side;     /* 0: left side of the equation, 1: right side */
  SiteRole role;
  Span span;    /* with the parentheses around the node */
  Span with_op; /* span, and the operator before it */
  Expr value;   /* as written */
} Site;

typedef struct {
  const Model *m;
  const Expect *x;
  Site *at;
  uint32_t n;
  Expr *nodes[2]; /* values of all nodes of a side */
  AstId *up[2];   /* the site above each node of a side */
} SiteList;

/* The sites of both sides of an expectation that is the only instance of its statement, outer ones first, left side
 * first. Operands of primes, exponents, conditions and indices are no sites. */
SiteList mutation_sites_of(const Model *m, const Expect *x);

/* Values as written: of a node of a side, and of side k; 0: none of its own. */
Expr edit_node(const SiteList *l, int side, AstId node);
Expr edit_side(const SiteList *l, int k);

/* Value of the side of s with `with` at the site. */
Expr edit_replaced(const SiteList *l, const Site *s, Expr with);

/* The function of one number that a call names; EX_NUM: none. */
ExprOp edit_function(const AstExpr *x);

int ast_is_sum(AstKind k);
