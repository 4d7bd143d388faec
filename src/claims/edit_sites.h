/* Sites: the places of an expectation where an edit may be made, and the role of each in the formula around it. */
#ifndef LAGC_CLAIMS_EDIT_SITES_H
#define LAGC_CLAIMS_EDIT_SITES_H

#include "mech/eqns.h"

typedef enum {
  SITE_ROOT,      /* a whole side */
  SITE_TERM,      /* of a sum */
  SITE_FACTOR,    /* of a product */
  SITE_NUMERATOR, /* dividend of a /, or operand of a unary minus */
  SITE_DIVISOR,
  SITE_BASE,      /* of a power */
  SITE_ARGUMENT,  /* of a function */
  SITE_PART       /* left part of a longer chain of + and -, or of * and /: no place of its own */
} SiteRole;

typedef struct {
  AstId node;
  AstId up;     /* the node above; 0 for a whole side */
  int left;     /* on the left side of the equation */
  SiteRole role;
  Span span;    /* with the parentheses around the node */
  Span with_op; /* span, and the operator before it */
} Site;

typedef struct {
  Site *at;
  uint32_t n;
} SiteList;

/* The sites of both sides, outer ones first, left side first. Operands of primes, exponents, conditions and indices are no sites. */
SiteList edit_sites_of(const Model *m, const Expect *x);

int site_is_sum(const Model *m, const Site *s);

/* The text of a span on one line, without comments, its middle left out where it is long. */
const char *span_text(const Model *m, Span span);

#endif
