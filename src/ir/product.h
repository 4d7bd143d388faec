/* Products in a Prog, taken apart. */
#ifndef LAGC_PRODUCT_H
#define LAGC_PRODUCT_H

#include "ir/prog.h"

enum { MOST_FACTORS = 8 };

typedef struct {
  Slot at[MOST_FACTORS];
  uint32_t n;
} Product;

/* Whether the value is a product of one use and without a name: it goes when what uses it is written otherwise. */
int product_is_part(const Prog *p, const uint32_t *uses, Slot s);

/* Its factors, in the order in which they are multiplied, products that are parts taken apart as far as there is room. */
Product product_of(const Prog *p, const uint32_t *uses, Slot s);

/* Marks the parts that were taken apart. */
void product_mark_inside(const Prog *p, const uint32_t *uses, Slot s, const Product *of, unsigned char *inside);

#endif
