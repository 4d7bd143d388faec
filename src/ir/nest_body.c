/* The body of a nest from a canonical form. The order of sums and products is free here: terms and factors that stay the same in a row
 * come first, and pairs of factors that several products share are computed once. */
#include <stdlib.h>

#include "ir/nest_impl.h"

enum { MOST_PRODUCTS = 64, MOST_FACTORS = 24 };

/* How often a value changes. */
enum { ONCE, EACH_ROW, EACH_TURN };

/* Two factors, by id: of nodes and, from their number on, of pairs. */
typedef struct {
  uint32_t a, b;
} Pair;

typedef struct {
  const Partition *c;
  const CanonicalForm *t;
  const Fit *f;
  Prog *body;
  Slot *slot;            /* by id */
  unsigned char *often;  /* by id */
  uint32_t **factors;    /* by id: of products, or NULL */
  uint32_t *nfactors;
  VEC(uint32_t) products; /* ids of products with factors */
  VEC(Pair) pairs;
  VEC(Slot) outer;
} BodyBuilder;

static uint32_t id_of_pair(const BodyBuilder *m, uint32_t k) { return m->t->nodes.n + k; }

static int changes(const BodyBuilder *m, uint32_t column) { return m->f->at[column].by_turn ? EACH_TURN : m->f->at[column].by_row ? EACH_ROW : ONCE; }

static int is_product(const BodyBuilder *m, const Node *n) { return n->kind == NODE_OP && m->c->p->ins.at[n->slot].op == IR_MUL; }

static void find_factors(BodyBuilder *m) {
  for (uint32_t id = 0; id < m->t->nodes.n; id++) {
    const Node *n = &m->t->nodes.at[id];
    int often = n->kind == NODE_CELL ? changes(m, n->column)
                : n->kind == NODE_LOAD && !ir_is_scalar(m->c->p->ins.at[n->slot].array) ? changes(m, n->column) : ONCE;
    for (uint32_t k = 0; k < n->n; k++)
      if (m->often[m->t->links.at[n->first + k].id] > often) often = m->often[m->t->links.at[n->first + k].id];
    m->often[id] = (unsigned char)often;
    if (!is_product(m, n) || n->n > MOST_FACTORS || m->products.n == MOST_PRODUCTS) continue;
    m->factors[id] = ARENA_ARRAY(m->c->a, uint32_t, n->n);
    m->nfactors[id] = n->n;
    for (uint32_t k = 0; k < n->n; k++) m->factors[id][k] = m->t->links.at[n->first + k].id;
    vec_push(m->c->a, &m->products, id);
  }
}

/* --- pairs of factors --- */

static int has_factor(const BodyBuilder *m, uint32_t id, uint32_t x, uint32_t after) {
  for (uint32_t k = after; k < m->nfactors[id]; k++)
    if (m->factors[id][k] == x) return (int)k + 1;
  return 0;
}

static int has_pair(const BodyBuilder *m, uint32_t id, Pair p) {
  int first = has_factor(m, id, p.a, 0);
  return first && has_factor(m, id, p.b, p.a == p.b ? (uint32_t)first : 0);
}

static void replace_pair(BodyBuilder *m, uint32_t id, Pair p, uint32_t by) {
  uint32_t *f = m->factors[id];
  for (int k = 0; k < 2; k++) {
    uint32_t at = (uint32_t)has_factor(m, id, k ? p.b : p.a, 0) - 1;
    for (uint32_t j = at; j + 1 < m->nfactors[id]; j++) f[j] = f[j + 1];
    m->nfactors[id]--;
  }
  f[m->nfactors[id]++] = by;
}

/* The pair in most products; ties go to the one that changes least often. 0 when no pair is in two products. */
static int best_pair(const BodyBuilder *m, Pair *best) {
  uint32_t most = 1;
  int rare = 0;
  for (uint32_t i = 0; i < m->products.n; i++) {
    uint32_t id = m->products.at[i];
    for (uint32_t a = 0; a < m->nfactors[id]; a++)
      for (uint32_t b = a + 1; b < m->nfactors[id]; b++) {
        Pair p = {m->factors[id][a], m->factors[id][b]};
        uint32_t n = 0;
        for (uint32_t j = 0; j < m->products.n; j++) n += has_pair(m, m->products.at[j], p) != 0;
        int often = -(m->often[p.a] > m->often[p.b] ? m->often[p.a] : m->often[p.b]);
        if (n < 2 || n < most || (n == most && often <= rare)) continue;
        most = n;
        rare = often;
        *best = p;
      }
  }
  return most > 1;
}

static void share_pairs(BodyBuilder *m) {
  for (Pair p; m->pairs.n < MOST_PRODUCTS && best_pair(m, &p);) {
    uint32_t id = id_of_pair(m, m->pairs.n);
    vec_push(m->c->a, &m->pairs, p);
    m->often[id] = m->often[p.a] > m->often[p.b] ? m->often[p.a] : m->often[p.b];
    for (uint32_t k = 0; k < m->products.n; k++)
      while (has_pair(m, m->products.at[k], p)) replace_pair(m, m->products.at[k], p, id);
  }
}

/* --- instructions --- */

static Slot leaf(BodyBuilder *m, const Node *n) {
  Ins i = m->c->p->ins.at[n->slot];
  if (n->kind == NODE_CONST) return prog_ins(m->body, (Ins){.op = i.op, .number = i.number});
  if (n->kind == NODE_LOAD && ir_is_scalar(i.array)) return prog_ins(m->body, i);
  if (n->kind != NODE_OUTER) {
    IrArray array = n->kind == NODE_CELL ? ARR_CELL : i.array;
    return prog_ins(m->body, (Ins){.op = IR_LOAD, .array = array, .index = n->column, .name = i.name});
  }
  vec_push(m->c->a, &m->outer, n->slot);
  return prog_ins(m->body, (Ins){.op = IR_LOAD, .array = ARR_OUTER, .index = m->outer.n - 1, .name = i.name});
}

/* Adds or multiplies: operands that change less often come first, otherwise in their order. */
static Slot fold(BodyBuilder *m, IrOp op, Slot sum, const uint32_t *ids, uint32_t n) {
  for (int often = ONCE; often <= EACH_TURN; often++)
    for (uint32_t k = 0; k < n; k++)
      if (m->often[ids[k]] == often) sum = sum ? prog_op(m->body, op, sum, m->slot[ids[k]]) : m->slot[ids[k]];
  return sum;
}

static Slot sum_of(BodyBuilder *m, const Node *n) {
  uint32_t *ids = ARENA_ARRAY(m->c->a, uint32_t, n->n), up = 0, down = 0;
  for (uint32_t k = 0; k < n->n; k++)
    if (!m->t->links.at[n->first + k].minus) ids[up++] = m->t->links.at[n->first + k].id;
  for (uint32_t k = 0; k < n->n; k++)
    if (m->t->links.at[n->first + k].minus) ids[up + down++] = m->t->links.at[n->first + k].id;
  Slot sum = fold(m, IR_ADD, 0, ids, up);
  if (!up) return prog_op(m->body, IR_NEG, fold(m, IR_ADD, 0, ids, down), 0);
  return fold(m, IR_SUB, sum, ids + up, down);
}

/* Computes the pairs whose factors are known, nodes up to `done`. */
static void make_pairs(BodyBuilder *m, uint32_t done) {
  for (uint32_t k = 0; k < m->pairs.n; k++) {
    uint32_t id = id_of_pair(m, k);
    Pair p = m->pairs.at[k];
    int there = (p.a <= done || p.a >= m->t->nodes.n) && (p.b <= done || p.b >= m->t->nodes.n) && m->slot[p.a] && m->slot[p.b];
    if (!m->slot[id] && there) m->slot[id] = prog_op(m->body, IR_MUL, m->slot[p.a], m->slot[p.b]);
  }
}

static Slot value(BodyBuilder *m, uint32_t id) {
  const Node *n = &m->t->nodes.at[id];
  const Ins *i = &m->c->p->ins.at[n->slot];
  if (n->kind != NODE_OP) return leaf(m, n);
  if (nest_is_sum(i->op)) return sum_of(m, n);
  if (m->factors[id]) {
    make_pairs(m, id);
    return fold(m, IR_MUL, 0, m->factors[id], m->nfactors[id]);
  }
  Slot x[3] = {0};
  if (i->op == IR_MUL) {
    uint32_t *ids = ARENA_ARRAY(m->c->a, uint32_t, n->n);
    for (uint32_t k = 0; k < n->n; k++) ids[k] = m->t->links.at[n->first + k].id;
    return fold(m, IR_MUL, 0, ids, n->n);
  }
  uint32_t next = n->first;
  for (int k = 0; k < 3; k++) /* structural zeros are no children */
    if (k == 0 ? i->a : k == 1 ? i->b : i->c) x[k] = m->slot[m->t->links.at[next++].id];
  return prog_ins(m->body, (Ins){.op = i->op, .a = x[0], .b = x[1], .c = x[2], .index = i->index, .text = i->text});
}

static int same_place(const BodyBuilder *m, uint32_t x, uint32_t y) {
  const IrSubscript *a = &m->f->at[x], *b = &m->f->at[y];
  return m->t->array.at[x] == m->t->array.at[y] && a->first == b->first && a->by_row == b->by_row && a->by_turn == b->by_turn &&
         a->row_at == b->row_at && a->turn_at == b->turn_at;
}

/* Stores the shares; shares of one sum are added first. */
static void store_gives(BodyBuilder *m) {
  uint32_t n = m->t->gives.n, first = m->t->columns.n - n;
  unsigned char *done = ARENA_ARRAY(m->c->a, unsigned char, n + 1);
  for (uint32_t k = 0; k < n; k++) {
    Link x = m->t->gives.at[k];
    Slot sum = m->slot[x.id];
    if (done[k]) continue;
    for (uint32_t j = k + 1; j < n; j++) {
      if (!same_place(m, first + k, first + j)) continue;
      sum = prog_op(m->body, m->t->gives.at[j].minus == x.minus ? IR_ADD : IR_SUB, sum, m->slot[m->t->gives.at[j].id]);
      done[j] = 1;
    }
    prog_store(m->body, (uint32_t)x.minus, first + k, sum, "");
  }
}

const Prog *nest_body(const Partition *c, const CanonicalForm *t, const Fit *f, const Slot **outer, uint32_t *nouter) {
  Arena *a = c->a;
  uint32_t n = t->nodes.n;
  BodyBuilder m = {.c = c, .t = t, .f = f, .body = prog_new(a)};
  m.slot = ARENA_ARRAY(a, Slot, n + MOST_PRODUCTS);
  m.often = ARENA_ARRAY(a, unsigned char, n + MOST_PRODUCTS);
  m.factors = ARENA_ARRAY(a, uint32_t *, n);
  m.nfactors = ARENA_ARRAY(a, uint32_t, n);
  find_factors(&m);
  share_pairs(&m);
  for (uint32_t id = 0; id < n; id++) {
    const Ins *was = &c->p->ins.at[t->nodes.at[id].slot];
    m.slot[id] = value(&m, id);
    if (t->nodes.at[id].kind == NODE_OP && !nest_is_sum(was->op)) prog_name(m.body, m.slot[id], was->name);
  }
  store_gives(&m);
  *outer = m.outer.at;
  *nouter = m.outer.n;
  return prog_factor(prog_tidy(m.body));
}
