/* Partition of a program into hubs and pieces: the components of its graph without hubs. */
#include <stdlib.h>
#include <string.h>

#include "base/union_find.h"
#include "ir/nest_impl.h"

/* A sum of FEWEST_TERMS is long; a value with more than FEW users is shared. */
enum { FEWEST_TERMS = 8, FEW = 8 };

static IrOp op_of(const Partition *c, Slot s) { return c->p->ins.at[s].op; }

/* --- long sums --- */

static void find_joined(Partition *c) {
  for (Slot s = 1; s < c->p->ins.n; s++) {
    const Ins *i = &c->p->ins.at[s];
    for (int k = 0; k < 2; k++) {
      Slot x = ins_operand(i, k);
      int alike = ir_is_sum(i->op) ? ir_is_sum(op_of(c, x)) : i->op == IR_MUL && op_of(c, x) == IR_MUL;
      if (x && alike && c->uses[x] == 1) c->joined[x] = 1;
    }
  }
}

static void find_long_sums(Partition *c) {
  const Prog *p = c->p;
  uint32_t *terms = ARENA_ARRAY(c->a, uint32_t, p->ins.n);
  for (Slot s = 1; s < p->ins.n; s++) {
    const Ins *i = &p->ins.at[s];
    if (!ir_is_sum(i->op)) continue;
    for (int k = 0; k < 2; k++)
      if (ins_operand(i, k)) terms[s] += c->joined[ins_operand(i, k)] ? terms[ins_operand(i, k)] : 1;
    if (!c->joined[s] && terms[s] >= FEWEST_TERMS) c->hub[s] = HUB_SUM;
  }
}

/* Sums that share a term with another sum, as forces of springs do by Newton's third law. */
static void find_sums_in_common(Partition *c) {
  const Prog *p = c->p;
  /* number of sums with the term; of a partial sum, number of sums that contain it */
  uint32_t *uses = ARENA_ARRAY(c->a, uint32_t, p->ins.n);
  for (Slot s = p->ins.n; s-- > 1;)
    for (int k = 0; k < 2 && ir_is_sum(op_of(c, s)); k++)
      uses[ins_operand(&p->ins.at[s], k)] += c->joined[s] ? uses[s] : 1;
  for (Slot s = 1; s < p->ins.n; s++) {
    if (!ir_is_sum(op_of(c, s)) || c->joined[s]) continue;
    c->terms->n = 0;
    nest_terms(c, s, c->terms);
    for (uint32_t k = 0; k < c->terms->n && c->terms->n > 1; k++)
      if (uses[c->terms->at[k].value] > 1 && !ir_is_leaf(op_of(c, c->terms->at[k].value)) && !c->hub[s])
        c->hub[s] = HUB_COMMON;
  }
}

/* Records the hub of each partial sum. */
static void mark_parts(Partition *c) {
  for (Slot s = c->p->ins.n; s-- > 1;) {
    const Ins *i = &c->p->ins.at[s];
    if (c->hub[s]) c->sum[s] = s;
    for (int k = 0; k < 2 && c->sum[s]; k++)
      if (c->joined[ins_operand(i, k)]) c->sum[ins_operand(i, k)] = c->sum[s];
  }
}

void nest_terms(const Partition *c, Slot sum, HubTerms *terms) {
  HubTerms *open = c->open;
  open->n = 0;
  vec_push(c->a, open, ((HubTerm){sum, sum, 0}));
  while (open->n) {
    HubTerm t = open->at[--open->n];
    const Ins *i = &c->p->ins.at[t.value];
    if (t.value != sum && !(c->joined[t.value] && ir_is_sum(i->op))) {
      vec_push(c->a, terms, t);
      continue;
    }
    int turned = i->op == IR_NEG || i->op == IR_SUB;
    if (i->b) vec_push(c->a, open, ((HubTerm){i->b, sum, turned ? !t.minus : t.minus}));
    if (i->a) vec_push(c->a, open, ((HubTerm){i->a, sum, i->op == IR_NEG ? !t.minus : t.minus}));
  }
}

/* --- signatures --- */

/* The finisher of splitmix64 (G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014, DOI 10.1145/2660193.2660195). */
static uint64_t mixed(uint64_t x) {
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  x = (x ^ x >> 27) * 0x94d049bb133111ebu;
  return x ^ x >> 31;
}

static uint64_t with(uint64_t h, uint64_t x) { return mixed(h * 0x9e3779b97f4a7c15u + x + 1); }

static uint64_t leaf_signature(const Ins *i) {
  uint64_t h = with(1, (uint64_t)i->op);
  if (i->op == IR_LOAD) return with(h, (uint64_t)i->array);
  if (i->op != IR_CONST) return h;
  uint64_t bits;
  memcpy(&bits, &i->number.approx, sizeof bits);
  return num_is_exact(i->number) ? with(with(h, (uint64_t)i->number.num), (uint64_t)i->number.den) : with(h, bits);
}

/* Signature of operand x as a term of a sum, or (minus) of its negative. */
static uint64_t part_of_sum(const Partition *c, Slot x, int minus) {
  if (!x) return 0;
  if (c->joined[x] && ir_is_sum(op_of(c, x))) return minus ? c->flip[x] : c->sig[x];
  return with(minus ? 2 : 3, c->sig[x]);
}

static uint64_t part_of_product(const Partition *c, Slot x) {
  return c->joined[x] && op_of(c, x) == IR_MUL ? c->sig[x] : with(4, c->sig[x]);
}

static void sign_sum(Partition *c, Slot s, const Ins *i) {
  int a = i->op == IR_NEG, b = i->op == IR_SUB;
  uint64_t plus = part_of_sum(c, i->a, a) + part_of_sum(c, i->b, b),
           minus = part_of_sum(c, i->a, !a) + part_of_sum(c, i->b, !b);
  c->sig[s] = c->hub[s] == HUB_SUM ? 5 : c->joined[s] ? plus : with(6, plus);
  c->flip[s] = minus;
}

static void sign(Partition *c, Slot s) {
  const Ins *i = &c->p->ins.at[s];
  if (ir_is_sum(i->op)) {
    sign_sum(c, s, i);
  } else if (i->op == IR_MUL) {
    uint64_t all = part_of_product(c, i->a) + part_of_product(c, i->b);
    c->sig[s] = c->joined[s] ? all : with(7, all);
  } else if (ir_is_leaf(i->op)) {
    c->sig[s] = leaf_signature(i);
  } else {
    uint64_t h = with(with(8, (uint64_t)i->op), i->index);
    for (const char *t = i->text; t && *t; t++) h = with(h, (unsigned char)*t);
    for (int k = 0; k < 3; k++) h = with(h, c->sig[ins_operand(i, k)]);
    c->sig[s] = h;
  }
}

/* Sort keys `low` and `mass`. Long sums read the same elements, so that only `mass` tells them apart. */
static void order(Partition *c, Slot s) {
  const Ins *i = &c->p->ins.at[s];
  c->low[s] = UINT64_MAX;
  if (i->op == IR_LOAD && !ir_is_scalar(i->array)) {
    c->low[s] = (uint64_t)i->array << 40 | i->index;
    c->mass[s] = (uint64_t)i->index + 1;
  }
  for (int k = 0; k < 3; k++) {
    Slot x = ins_operand(i, k);
    if (!x) continue;
    c->mass[s] += c->mass[x];
    if (c->low[x] < c->low[s]) c->low[s] = c->low[x];
  }
  if (c->hub[s] == HUB_SUM || c->hub[s] == HUB_COMMON) c->low[s] = (uint64_t)ARR_COUNT << 40;
}

/* --- shared values --- */

static int can_share(const Partition *c, Slot s) {
  IrOp op = op_of(c, s);
  return !ir_is_leaf(op) && !ir_is_condition(op) && !c->sum[s] && !c->joined[s] && op != IR_PIVOT && op != IR_TITLE;
}

static int by_value(const void *x, const void *y) {
  uint64_t a = *(const uint64_t *)x, b = *(const uint64_t *)y;
  return (a > b) - (a < b);
}

/* Values with many users, and all values of the same signature: the last bodies of a family have few users. */
static void find_shared(Partition *c) {
  VEC(uint64_t) often = {0};
  for (Slot s = 1; s < c->p->ins.n; s++)
    if (c->uses[s] > FEW && can_share(c, s)) vec_push(c->a, &often, c->sig[s]);
  if (!often.n) return;
  qsort(often.at, often.n, sizeof *often.at, by_value);
  for (Slot s = 1; s < c->p->ins.n; s++)
    if (can_share(c, s) && bsearch(&c->sig[s], often.at, often.n, sizeof *often.at, by_value)) c->hub[s] = HUB_SHARED;
}

/* Stored values as hubs. */
static void find_stored(Partition *c) {
  for (uint32_t k = 0; k < c->p->stores.n; k++) {
    Slot s = c->p->stores.at[k].slot;
    if (s && !c->hub[s] && can_share(c, s)) c->hub[s] = HUB_STORED;
  }
}

/* --- pieces --- */

/* Whether a value belongs to a piece. */
static int in_piece(const Partition *c, Slot s) {
  IrOp op = op_of(c, s);
  return s && !ir_is_leaf(op) && !c->sum[s] && op != IR_PIVOT && op != IR_TITLE;
}

static const Slot MIXED = UINT32_MAX;

static Slot same_or_mixed(Slot known, Slot x) { return !known || known == x ? x : MIXED; }

/* By hub: the piece of all its users; MIXED where there are several. */
static Slot *find_users(const Partition *c, Slot *parent) {
  Slot *user = ARENA_ARRAY(c->a, Slot, c->p->ins.n);
  for (Slot s = 1; s < c->p->ins.n; s++)
    for (int k = 0; k < 3; k++) {
      Slot x = ins_operand(&c->p->ins.at[s], k);
      if (x && c->hub[x]) user[x] = same_or_mixed(user[x], in_piece(c, s) ? union_find_root(parent, s) : MIXED);
    }
  for (uint32_t k = 0; k < c->p->stores.n; k++) user[c->p->stores.at[k].slot] = MIXED;
  return user;
}

/* Whether all terms of a sum are leaves, or of the piece of its users. */
static int is_of_one_piece(Partition *c, Slot *parent, Slot sum, Slot user) {
  c->terms->n = 0;
  nest_terms(c, sum, c->terms);
  for (uint32_t k = 0; k < c->terms->n; k++) {
    Slot x = c->terms->at[k].value;
    if (c->hub[x] || (in_piece(c, x) && union_find_root(parent, x) != user)) return 0;
  }
  return 1;
}

/* Returns hubs to pieces: a shared value whose users are all in one piece, and a sum whose terms and users are.
 * Returns whether there was one. */
static int return_hubs(Partition *c, Slot *parent) {
  int some = 0;
  const Slot *user = find_users(c, parent);
  for (Slot s = 1; s < c->p->ins.n; s++) {
    if ((c->hub[s] != HUB_SHARED && c->hub[s] != HUB_COMMON) || user[s] == MIXED || !user[s]) continue;
    if (c->hub[s] == HUB_COMMON && !is_of_one_piece(c, parent, s, union_find_root(parent, user[s]))) continue;
    c->hub[s] = HUB_NO;
    union_find_join(parent, s, user[s]);
    some = 1;
  }
  for (Slot s = 1; s < c->p->ins.n; s++) {
    Slot sum = c->sum[s];
    if (!sum || c->hub[sum]) continue;
    c->sum[s] = 0; /* sums come after their partial sums */
    union_find_join(parent, s, sum);
  }
  return some;
}

static void find_pieces(Partition *c) {
  enum { TURNS = 3 };
  const Prog *p = c->p;
  Slot *parent = union_find_new(c->a, p->ins.n);
  for (Slot s = 1; s < p->ins.n; s++)
    for (int k = 0; k < 3 && in_piece(c, s); k++) {
      Slot x = ins_operand(&p->ins.at[s], k);
      if (in_piece(c, x) && !c->hub[x]) union_find_join(parent, s, x);
    }
  for (int turn = 0; turn < TURNS && return_hubs(c, parent); turn++) {}
  for (Slot s = 1; s < p->ins.n; s++)
    if (c->hub[s] == HUB_COMMON) c->hub[s] = HUB_SUM;
  for (Slot s = 1; s < p->ins.n; s++) {
    if (!in_piece(c, s)) continue;
    Slot r = union_find_root(parent, s);
    if (r == s) vec_push(c->a, &c->pieces, ((Piece){.apart = 1}));
    c->piece[s] = r == s ? c->pieces.n : c->piece[r];
    c->pieces.at[c->piece[s] - 1].n++;
  }
  for (uint32_t k = 0; k < c->pieces.n; k++) {
    c->pieces.at[k].slots = ARENA_ARRAY(c->a, Slot, c->pieces.at[k].n);
    c->pieces.at[k].n = 0;
  }
  for (Slot s = 1; s < p->ins.n; s++) {
    if (!c->piece[s]) continue;
    Piece *q = &c->pieces.at[c->piece[s] - 1];
    q->slots[q->n++] = s;
    if (op_of(c, s) == IR_TABLE) q->apart = 0;
  }
}

/* --- shares and uses between pieces and hubs --- */

static void not_apart(Partition *c, Slot s) {
  if (c->piece[s] && !c->hub[s]) c->pieces.at[c->piece[s] - 1].apart = 0;
}

static void wait_for(Partition *c, Slot hub, uint32_t piece, Slot sum) {
  vec_push(c->a, &c->waiting, ((Waiting){piece, sum, c->last_waiting[hub]}));
  c->last_waiting[hub] = c->waiting.n;
  if (sum) c->waits[sum]++;
  else c->pieces.at[piece - 1].waits++;
}

static void find_shares(Partition *c) {
  const Prog *p = c->p;
  HubTerms terms = {0};
  for (Slot s = 1; s < p->ins.n; s++) {
    const Ins *i = &p->ins.at[s];
    if (i->op == IR_PIVOT) not_apart(c, i->a);
    for (int k = 0; k < 3 && c->piece[s]; k++)
      if (ins_operand(i, k) && c->hub[ins_operand(i, k)] && c->piece[ins_operand(i, k)] != c->piece[s])
        wait_for(c, ins_operand(i, k), c->piece[s], 0);
    terms.n = 0;
    if (c->hub[s] == HUB_SUM) nest_terms(c, s, &terms);
    if (c->hub[s] == HUB_SHARED || c->hub[s] == HUB_STORED) vec_push(c->a, &terms, ((HubTerm){s, s, 0}));
    for (uint32_t k = 0; k < terms.n; k++) {
      Slot x = terms.at[k].value;
      c->terms_of[s]++;
      if (!c->piece[x] && c->hub[x]) wait_for(c, x, 0, s);
      if (!c->piece[x]) continue; /* a leaf, or a hub */
      c->waits[s]++;
      vec_push(c->a, &c->pieces.at[c->piece[x] - 1].gives, terms.at[k]);
    }
  }
  for (uint32_t k = 0; k < p->stores.n; k++) not_apart(c, p->stores.at[k].slot);
}

/* Hubs in the order in which stores need them. */
static void list_hubs(Partition *c) {
  const Prog *p = c->p;
  unsigned char *seen = ARENA_ARRAY(c->a, unsigned char, p->ins.n);
  VEC(Slot) open = {0};
  for (uint32_t k = 0; k < p->stores.n; k++) {
    vec_push(c->a, &open, p->stores.at[k].slot);
    while (open.n) {
      Slot s = open.at[--open.n];
      if (seen[s]) continue;
      seen[s] = 1;
      if (c->hub[s]) vec_push(c->a, &c->hubs, s);
      for (int j = 3; j-- > 0;)
        if (ins_operand(&p->ins.at[s], j)) vec_push(c->a, &open, ins_operand(&p->ins.at[s], j));
    }
  }
}

typedef struct {
  uint64_t sig, low, mass;
  uint32_t rank; /* position among the hubs */
} HubKey;

/* Sort key: shared values by the array elements that they read, other hubs in the order of stores. */
static HubKey key_of(const Partition *c, uint32_t rank) {
  Slot s = c->hubs.at[rank];
  return c->hub[s] == HUB_SHARED ? (HubKey){c->sig[s], c->low[s], c->mass[s], rank}
                                 : (HubKey){.sig = c->hub[s], .rank = rank};
}

static int by_key(const void *x, const void *y) {
  const HubKey *a = x, *b = y;
  if (a->sig != b->sig) return a->sig < b->sig ? -1 : 1;
  if (a->low != b->low) return a->low < b->low ? -1 : 1;
  if (a->mass != b->mass) return a->mass < b->mass ? -1 : 1;
  return (a->rank > b->rank) - (a->rank < b->rank);
}

/* Classes and numbers of hubs. Sums are one class, stored values another, shared values one for each signature.
 * Stored values have the number of their first store, with gaps, so that a loop stores them. */
static void number_hubs(Partition *c) {
  HubKey *keys = ARENA_ARRAY(c->a, HubKey, c->hubs.n + 1);
  for (uint32_t k = 0; k < c->hubs.n; k++) keys[k] = key_of(c, k);
  qsort(keys, c->hubs.n, sizeof *keys, by_key);
  for (uint32_t k = 0, first = 0; k < c->hubs.n; k++) {
    Slot s = c->hubs.at[keys[k].rank];
    if (!k || keys[k].sig != keys[k - 1].sig) {
      first = k;
      c->classes++;
    }
    c->class_of[s] = c->classes - 1;
    c->number[s] = k - first;
  }
  for (uint32_t k = c->p->stores.n; k-- > 0;)
    if (c->hub[c->p->stores.at[k].slot] == HUB_STORED) c->number[c->p->stores.at[k].slot] = k;
}

Partition nest_partition(Arena *a, const Prog *p, unsigned ends) {
  uint32_t n = p->ins.n;
  Partition c = {.p = p, .a = a, .uses = prog_uses(p), .open = ARENA_NEW(a, HubTerms), .terms = ARENA_NEW(a, HubTerms)};
  c.joined = ARENA_ARRAY(a, unsigned char, n);
  c.hub = ARENA_ARRAY(a, unsigned char, n);
  c.celled = ARENA_ARRAY(a, unsigned char, n);
  c.sum = ARENA_ARRAY(a, Slot, n);
  c.sig = ARENA_ARRAY(a, uint64_t, n);
  c.flip = ARENA_ARRAY(a, uint64_t, n);
  c.low = ARENA_ARRAY(a, uint64_t, n);
  c.mass = ARENA_ARRAY(a, uint64_t, n);
  c.piece = ARENA_ARRAY(a, uint32_t, n);
  c.class_of = ARENA_ARRAY(a, uint32_t, n);
  c.number = ARENA_ARRAY(a, uint32_t, n);
  c.waits = ARENA_ARRAY(a, uint32_t, n);
  c.terms_of = ARENA_ARRAY(a, uint32_t, n);
  c.last_waiting = ARENA_ARRAY(a, uint32_t, n);
  find_joined(&c);
  find_long_sums(&c);
  if (ends & CUT_COMMON_TERMS) find_sums_in_common(&c);
  mark_parts(&c);
  for (Slot s = 1; s < n; s++) sign(&c, s);
  find_shared(&c);
  if (ends & CUT_STORES) find_stored(&c);
  for (Slot s = 1; s < n; s++) order(&c, s);
  find_pieces(&c);
  find_shares(&c);
  list_hubs(&c);
  number_hubs(&c);
  return c;
}
