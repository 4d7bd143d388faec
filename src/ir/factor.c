/* Common factors of sums of two products, see prog_factor: passes over the program, repeated while they save
 * operations. */
#include "ir/product.h"

enum { NONE = MOST_FACTORS };

typedef struct {
  const Prog *from;
  Prog *to;
  Slot *map;
  const uint32_t *uses;
} Factor;

/* Position in x of the first factor that y has, too, and in *other its position in y; or NONE. Numbers do not count:
 * lower.c takes out common coefficients. */
static uint32_t common_factor(const Factor *f, const Product *x, const Product *y, uint32_t *other) {
  for (uint32_t i = 0; i < x->n; i++)
    for (*other = 0; *other < y->n; ++*other)
      if (x->at[i] == y->at[*other] && f->from->ins.at[x->at[i]].op != IR_CONST) return i;
  return NONE;
}

/* The product without its factor number `out`, in the new program. */
static Slot product_without(Factor *f, const Product *p, uint32_t out) {
  Slot r = 0;
  for (uint32_t k = 0; k < p->n; k++) {
    if (k == out) continue;
    Slot x = f->map[p->at[k]];
    r = r ? prog_op(f->to, IR_MUL, r, x) : x;
  }
  return r;
}

/* a*x + a*y as a*(x + y); 0 where there is no common factor. */
static Slot factored_sum(Factor *f, const Ins *i) {
  if (!product_is_part(f->from, f->uses, i->a) || !product_is_part(f->from, f->uses, i->b)) return 0;
  Product x = product_of(f->from, f->uses, i->a, NULL), y = product_of(f->from, f->uses, i->b, NULL);
  uint32_t in_y, in_x = common_factor(f, &x, &y, &in_y);
  if (in_x == NONE) return 0;
  Slot a = product_without(f, &x, in_x), b = product_without(f, &y, in_y);
  Slot sum = prog_op(f->to, i->op, a, b);
  return prog_op(f->to, IR_MUL, f->map[x.at[in_x]], sum);
}

static Prog *factor_once(const Prog *p) {
  Factor f = {.from = p, .to = prog_new_like(p), .map = ARENA_ARRAY(p->arena, Slot, p->ins.n)};
  uint32_t *uses = prog_uses(p);
  f.uses = uses;
  for (Slot s = 1; s < p->ins.n; s++) {
    const Ins *i = &p->ins.at[s];
    Slot sum = i->op == IR_ADD || i->op == IR_SUB ? factored_sum(&f, i) : 0;
    f.map[s] = sum ? sum : prog_ins(f.to, prog_import(f.to, p, f.map, *i));
    prog_name(f.to, f.map[s], i->name);
  }
  prog_copy_stores(f.to, p, f.map);
  arena_release(p->arena, f.map, p->ins.n * sizeof *f.map);
  arena_release(p->arena, uses, p->ins.n * sizeof *uses);
  Prog *tidy = prog_tidy(f.to);
  prog_release(f.to);
  return tidy;
}

Prog *prog_factor(Prog *given) {
  enum { TURNS = 3, LONG = 100000 };
  Prog *p = given;
  for (int turn = 0; turn < (p->ins.n < LONG ? TURNS : 1); turn++) {
    Prog *next = factor_once(p);
    int is_better = ops_total(prog_count(next)) < ops_total(prog_count(p));
    Prog *worse = is_better ? p : next;
    if (worse != given) prog_release(worse);
    if (!is_better) return p;
    p = next;
  }
  return p;
}
