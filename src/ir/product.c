/* Products in a Prog as lists of factors. */
#include "ir/product.h"

int product_is_part(const Prog *p, const uint32_t *uses, Slot s) {
  const Ins *i = &p->ins.at[s];
  return s && i->op == IR_MUL && uses[s] == 1 && !i->name;
}

Product product_of(const Prog *p, const uint32_t *uses, Slot s, unsigned char *inside) {
  const Ins *whole = &p->ins.at[s];
  Product r = {{whole->a, whole->b}, 2};
  for (uint32_t k = 0; k < r.n;) {
    const Ins *i = &p->ins.at[r.at[k]];
    if (r.n == MOST_FACTORS || !product_is_part(p, uses, r.at[k])) {
      k++;
      continue;
    }
    if (inside) inside[r.at[k]] = 1;
    r.at[k] = i->a;
    for (uint32_t j = r.n++; j > k + 1; j--) r.at[j] = r.at[j - 1];
    r.at[k + 1] = i->b;
  }
  return r;
}
