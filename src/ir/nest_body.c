/* The body of a nest from a canonical form. The order of sums and products is free here: terms and factors that stay
 * the same in a row come first. */
#include "ir/nest_impl.h"

/* How often a value changes. */
enum { ONCE, EACH_ROW, EACH_TURN };

typedef struct {
  const Partition *c;
  const CanonicalForm *t;
  const Fit *f;
  Prog *body;
  Slot *slot;           /* by node */
  unsigned char *often; /* by node */
  VEC(Slot) outer;
} BodyBuilder;

static int changes(const BodyBuilder *m, uint32_t column) {
  return m->f->at[column].by_turn ? EACH_TURN : m->f->at[column].by_row ? EACH_ROW : ONCE;
}

static void find_changes(BodyBuilder *m) {
  for (uint32_t id = 0; id < m->t->nodes.n; id++) {
    const Node *n = &m->t->nodes.at[id];
    int often = n->kind == NODE_CELL ? changes(m, n->column)
                : n->kind == NODE_LOAD && !ir_is_scalar(m->c->p->ins.at[n->slot].array) ? changes(m, n->column) : ONCE;
    for (uint32_t k = 0; k < n->n; k++)
      if (m->often[m->t->links.at[n->first + k].id] > often) often = m->often[m->t->links.at[n->first + k].id];
    m->often[id] = (unsigned char)often;
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

static Slot value(BodyBuilder *m, uint32_t id) {
  const Node *n = &m->t->nodes.at[id];
  const Ins *i = &m->c->p->ins.at[n->slot];
  if (n->kind != NODE_OP) return leaf(m, n);
  if (ir_is_sum(i->op)) return sum_of(m, n);
  Slot x[3] = {0};
  if (i->op == IR_MUL) {
    uint32_t *ids = ARENA_ARRAY(m->c->a, uint32_t, n->n);
    for (uint32_t k = 0; k < n->n; k++) ids[k] = m->t->links.at[n->first + k].id;
    return fold(m, IR_MUL, 0, ids, n->n);
  }
  uint32_t next = n->first;
  for (int k = 0; k < 3; k++) /* structural zeros are no children */
    if (ins_operand(i, k)) x[k] = m->slot[m->t->links.at[next++].id];
  return prog_ins(m->body, (Ins){.op = i->op, .a = x[0], .b = x[1], .c = x[2], .index = i->index, .text = i->text});
}

static int same_place(const BodyBuilder *m, uint32_t x, uint32_t y) {
  const IrSubscript *a = &m->f->at[x], *b = &m->f->at[y];
  return m->t->array.at[x] == m->t->array.at[y] && a->first == b->first && a->by_row == b->by_row &&
         a->by_turn == b->by_turn;
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
  BodyBuilder m = {.c = c, .t = t, .f = f, .body = prog_new(c->p->arena)};
  m.slot = ARENA_ARRAY(a, Slot, n);
  m.often = ARENA_ARRAY(a, unsigned char, n);
  find_changes(&m);
  for (uint32_t id = 0; id < n; id++) {
    const Ins *was = &c->p->ins.at[t->nodes.at[id].slot];
    m.slot[id] = value(&m, id);
    if (t->nodes.at[id].kind == NODE_OP && !ir_is_sum(was->op)) prog_name(m.body, m.slot[id], was->name);
  }
  store_gives(&m);
  *outer = m.outer.at;
  *nouter = m.outer.n;
  return prog_product_cse(prog_factor(prog_tidy(m.body)));
}
