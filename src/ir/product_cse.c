/* Common subproducts, see prog_product_cse. Products become lists of factors; the pair of factors in most lists is
 * replaced by a new factor until no pair is in two; then the program is built again with the pairs. */
#include "ir/product.h"

/* A factor: a slot of the program or, from ins.n on, ins.n + the number of a pair. */
typedef uint32_t Factor;

typedef struct {
  Factor a, b;
  Slot last; /* of the program: the pair is available after this slot */
} Pair;

typedef struct {
  Slot root;
  Product of;
} ProductAt;

typedef struct {
  Factor a, b;
  uint32_t count, seen; /* number of products with the pair; the last of them */
} Tally;

typedef struct {
  const Prog *from;
  Prog *to;
  const uint32_t *uses;
  VEC(ProductAt) products;
  VEC(Pair) pairs;
  Tally *table;           /* hashed, empty where count is 0 */
  uint32_t room;
  unsigned char *inside;  /* by slot: part of a larger product */
  uint32_t *product;      /* by slot: number of the product, from 1; 0: none */
  Slot *map, *made;       /* slots of `to`: by slot, by pair */
} ProductCse;

/* --- products --- */

static void find_products(ProductCse *s) {
  for (Slot k = s->from->ins.n; k-- > 1;) {
    if (s->from->ins.at[k].op != IR_MUL || s->inside[k]) continue;
    ProductAt w = {k, product_of(s->from, s->uses, k, s->inside)};
    vec_push(s->from->arena, &s->products, w);
    s->product[k] = s->products.n;
  }
}

/* --- the most frequent pair --- */

static Tally *tally(ProductCse *s, Factor a, Factor b) {
  uint32_t k = (a * 0x9e3779b9u ^ b * 0x85ebca6bu) & (s->room - 1);
  while (s->table[k].count && (s->table[k].a != a || s->table[k].b != b)) k = (k + 1) & (s->room - 1);
  return &s->table[k];
}

static int is_better(const Tally *x, const Tally *y) {
  if (x->count != y->count) return x->count > y->count;
  return x->a != y->a ? x->a < y->a : x->b < y->b;
}

/* The pair in most products, each of which counts once; ties go to earlier factors. */
static Tally most_frequent(ProductCse *s) {
  Tally best = {0};
  for (uint32_t k = 0; k < s->room; k++) s->table[k] = (Tally){0};
  for (uint32_t w = 0; w < s->products.n; w++) {
    const Product *p = &s->products.at[w].of;
    for (uint32_t i = 0; i < p->n; i++)
      for (uint32_t j = i + 1; j < p->n; j++) {
        Factor a = p->at[i] < p->at[j] ? p->at[i] : p->at[j], b = p->at[i] < p->at[j] ? p->at[j] : p->at[i];
        Tally *t = tally(s, a, b);
        if (t->count && t->seen == w) continue;
        *t = (Tally){a, b, t->count + 1, w};
        if (is_better(t, &best)) best = *t;
      }
  }
  return best;
}

/* --- replacing it --- */

static Slot last_of(const ProductCse *s, Factor f) {
  return f < s->from->ins.n ? f : s->pairs.at[f - s->from->ins.n].last;
}

/* Replaces factors a and b by `pair`, at the position of the later one. */
static void take_out(Product *p, Factor a, Factor b, Factor pair) {
  uint32_t i = 0, j = p->n;
  while (i < p->n && p->at[i] != a) i++;
  while (j-- > 0 && (j == i || p->at[j] != b)) continue;
  if (i >= p->n || j >= p->n) return;
  uint32_t first = i < j ? i : j;
  p->at[i < j ? j : i] = pair;
  p->n--;
  for (uint32_t k = first; k < p->n; k++) p->at[k] = p->at[k + 1];
}

static void take_out_everywhere(ProductCse *s, const Tally *t) {
  Slot x = last_of(s, t->a), y = last_of(s, t->b);
  Factor pair = s->from->ins.n + s->pairs.n;
  vec_push(s->from->arena, &s->pairs, ((Pair){t->a, t->b, x > y ? x : y}));
  for (uint32_t w = 0; w < s->products.n; w++) take_out(&s->products.at[w].of, t->a, t->b, pair);
}

/* --- the program with pairs --- */

static Slot slot_of(const ProductCse *s, Factor f) {
  return f < s->from->ins.n ? s->map[f] : s->made[f - s->from->ins.n];
}

static Slot multiply(ProductCse *s, const Product *p) {
  Slot r = slot_of(s, p->at[0]);
  for (uint32_t k = 1; k < p->n; k++) r = prog_op(s->to, IR_MUL, r, slot_of(s, p->at[k]));
  return r;
}

/* By slot: list of the pairs that are computed after it, in the order in which they were found. */
static uint32_t *lists_of_pairs(const ProductCse *s, uint32_t *next) {
  uint32_t *first = ARENA_ARRAY(s->from->arena, uint32_t, s->from->ins.n);
  for (uint32_t k = s->pairs.n; k-- > 0;) {
    next[k] = first[s->pairs.at[k].last];
    first[s->pairs.at[k].last] = k + 1;
  }
  return first;
}

static void rebuild(ProductCse *s) {
  const Prog *p = s->from;
  uint32_t *next = ARENA_ARRAY(p->arena, uint32_t, s->pairs.n + 1), *first = lists_of_pairs(s, next);
  s->made = ARENA_ARRAY(p->arena, Slot, s->pairs.n + 1);
  for (Slot k = 1; k < p->ins.n; k++) {
    if (s->inside[k]) continue;
    const Ins *i = &p->ins.at[k];
    s->map[k] = s->product[k] ? multiply(s, &s->products.at[s->product[k] - 1].of)
                              : prog_ins(s->to, prog_import(s->to, p, s->map, *i));
    prog_name(s->to, s->map[k], i->name);
    for (uint32_t at = first[k]; at; at = next[at - 1]) {
      const Pair *pair = &s->pairs.at[at - 1];
      s->made[at - 1] = prog_op(s->to, IR_MUL, slot_of(s, pair->a), slot_of(s, pair->b));
    }
  }
  prog_copy_stores(s->to, p, s->map);
}

Prog *prog_product_cse(Prog *p) {
  Arena *a = p->arena;
  ProductCse s = {.from = p,
                  .to = prog_new_like(p), .uses = prog_uses(p), .inside = ARENA_ARRAY(a, unsigned char, p->ins.n),
                  .product = ARENA_ARRAY(a, uint32_t, p->ins.n),
                  .map = ARENA_ARRAY(a, Slot, p->ins.n)};
  find_products(&s);
  uint32_t pairs = 0;
  for (uint32_t w = 0; w < s.products.n; w++) pairs += s.products.at[w].of.n * (s.products.at[w].of.n - 1) / 2;
  for (s.room = 256; s.room < 2 * pairs;) s.room *= 2;
  s.table = ARENA_ARRAY(a, Tally, s.room);
  for (Tally t; t = most_frequent(&s), t.count > 1;) take_out_everywhere(&s, &t);
  rebuild(&s);
  Prog *r = prog_tidy(s.to);
  return ops_total(prog_count(r)) < ops_total(prog_count(p)) ? r : p;
}
