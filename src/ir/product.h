/* Products in a Prog as lists of factors. */
#pragma once

#include "ir/prog.h"

enum { MOST_FACTORS = 8 };

typedef struct {
  Slot at[MOST_FACTORS];
  uint32_t n;
} Product;

/* Whether the value is an unnamed product with one use, which may be dissolved in its user. uses: see prog_uses. */
int product_is_part(const Prog *p, const uint32_t *uses, Slot s);

/* The factors of product s in order; parts are replaced by their factors, up to MOST_FACTORS. inside: these parts
 * are marked; or NULL. */
Product product_of(const Prog *p, const uint32_t *uses, Slot s, unsigned char *inside);
