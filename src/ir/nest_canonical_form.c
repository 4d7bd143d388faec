/* The canonical form of a piece: pieces that compute the same, except for array indices, have equal `words`. */
#include <stdlib.h>

#include "ir/nest_impl.h"

/* Order of commutative operands: by signature; ties by the array elements that they read. */
static int by_signature(const void *x, const void *y) {
  const Child *a = x, *b = y;
  if (a->sig != b->sig) return a->sig < b->sig ? -1 : 1;
  if (a->minus != b->minus) return a->minus - b->minus;
  if (a->low != b->low) return a->low < b->low ? -1 : 1;
  if (a->mass != b->mass) return a->mass < b->mass ? -1 : 1;
  return (a->slot > b->slot) - (a->slot < b->slot);
}

static Child child(const Partition *c, Slot s, int minus) {
  return (Child){s, minus, c->sig[s], c->low[s], c->mass[s]};
}

static void take_factors(const Partition *c, Slot s, Children *to) {
  const Prog *p = c->p;
  vec_push(c->a, to, child(c, s, 0));
  for (uint32_t k = 0; k < to->n;) {
    Slot x = to->at[k].slot;
    if (x != s && !(c->joined[x] && p->ins.at[x].op == IR_MUL)) {
      k++;
      continue;
    }
    to->at[k] = child(c, p->ins.at[x].a, 0);
    vec_push(c->a, to, child(c, p->ins.at[x].b, 0));
  }
}

/* Operands of a node: terms of a sum or factors of a product in canonical order, else the instruction's operands. */
static void nest_children(const Partition *c, Slot s, Children *to) {
  const Ins *i = &c->p->ins.at[s];
  to->n = 0;
  if (ir_is_sum(i->op)) {
    c->terms->n = 0;
    nest_terms(c, s, c->terms);
    for (uint32_t k = 0; k < c->terms->n; k++)
      vec_push(c->a, to, child(c, c->terms->at[k].value, c->terms->at[k].minus));
  } else if (i->op == IR_MUL) {
    take_factors(c, s, to);
  } else {
    for (int k = 0; k < 3; k++)
      if (ins_operand(i, k)) vec_push(c->a, to, child(c, ins_operand(i, k), 0));
    return;
  }
  qsort(to->at, to->n, sizeof *to->at, by_signature);
}

typedef struct {
  const Partition *c;
  Local *local;
  uint32_t stamp;
  CanonicalForm *t;
} FormWriter;

static void word(FormWriter *w, uint64_t x) {
  vec_push(w->c->a, &w->t->words, (uint32_t)x);
  vec_push(w->c->a, &w->t->words, (uint32_t)(x >> 32));
}

/* Appends an index. array: the array, or ARR_COUNT + class of the hub. */
static uint32_t column(FormWriter *w, int64_t index, uint32_t array) {
  vec_push(w->c->a, &w->t->columns, index);
  vec_push(w->c->a, &w->t->array, array);
  return w->t->columns.n - 1;
}

/* A node for slot s. A hub whose terms all come from nests is a cell, any other one a value of the program around. */
static Node node_of(FormWriter *w, Slot s) {
  const Partition *c = w->c;
  const Ins *i = &c->p->ins.at[s];
  Node n = {.slot = s, .first = w->t->links.n};
  if (c->hub[s] && c->piece[s] != w->stamp) {
    n.kind = c->celled[s] == 2 ? NODE_CELL : NODE_OUTER;
    word(w, c->celled[s] == 2 ? c->class_of[s] : s);
    if (n.kind == NODE_CELL) n.column = column(w, c->number[s], ARR_COUNT + c->class_of[s]);
  } else if (i->op == IR_LOAD) {
    n.kind = NODE_LOAD;
    word(w, (uint64_t)i->array);
    if (!ir_is_scalar(i->array)) n.column = column(w, i->index, (uint32_t)i->array);
  } else if (i->op == IR_CONST || i->op == IR_PI) {
    n.kind = NODE_CONST;
    word(w, c->sig[s]);
  } else {
    n.kind = NODE_OP;
    n.n = w->t->children.n;
    word(w, ir_is_sum(i->op) ? IR_ADD : i->op);
    if (!ir_is_sum(i->op) && i->op != IR_MUL) word(w, i->index);
    uint64_t text = 0;
    for (const char *t = i->text; t && *t; t++) text = text * 31 + (unsigned char)*t;
    word(w, text);
  }
  word(w, (uint64_t)n.kind << 32 | n.n);
  return n;
}

static int is_known(const FormWriter *w, Slot s) { return w->local[s].stamp == w->stamp; }

/* Appends the node of s, whose operands have nodes. */
static void append(FormWriter *w, Slot s) {
  Node n = node_of(w, s);
  for (uint32_t k = 0; k < n.n; k++) {
    Link l = {w->local[w->t->children.at[k].slot].id, w->t->children.at[k].minus};
    vec_push(w->c->a, &w->t->links, l);
    word(w, (uint64_t)l.id << 1 | (uint64_t)l.minus);
  }
  w->local[s] = (Local){w->stamp, w->t->nodes.n};
  vec_push(w->c->a, &w->t->nodes, n);
}

static void write_value(FormWriter *w, Slot s) {
  CanonicalForm *t = w->t;
  vec_push(w->c->a, &t->open, s);
  while (t->open.n) {
    Slot x = t->open.at[t->open.n - 1];
    uint32_t before = t->open.n;
    w->t->children.n = 0;
    if (!is_known(w, x) && w->c->piece[x] == w->stamp) nest_children(w->c, x, &w->t->children);
    for (uint32_t k = w->t->children.n; k-- > 0;)
      if (!is_known(w, w->t->children.at[k].slot)) vec_push(w->c->a, &t->open, w->t->children.at[k].slot);
    if (t->open.n > before) continue;
    t->open.n--;
    if (!is_known(w, x)) append(w, x);
  }
}

void nest_canonical_form(const Partition *c, Piece *piece, Local *local, uint32_t stamp, CanonicalForm *t) {
  FormWriter w = {.c = c, .local = local, .stamp = stamp, .t = t};
  t->nodes.n = t->links.n = t->gives.n = t->words.n = t->columns.n = t->array.n = t->given.n = 0;
  for (uint32_t k = 0; k < piece->gives.n; k++) {
    HubTerm s = piece->gives.at[k];
    vec_push(c->a, &t->given, ((Child){s.value, s.minus, c->sig[s.value], c->number[s.hub], k}));
  }
  qsort(t->given.at, t->given.n, sizeof *t->given.at, by_signature);
  for (uint32_t k = 0; k < t->given.n; k++) write_value(&w, t->given.at[k].slot);
  for (uint32_t k = 0; k < t->given.n; k++) {
    Slot hub = piece->gives.at[t->given.at[k].mass].hub;
    Link l = {local[t->given.at[k].slot].id, t->given.at[k].minus};
    vec_push(c->a, &t->gives, l);
    word(&w, (uint64_t)l.id << 1 | (uint64_t)l.minus);
    word(&w, c->class_of[hub]);
    column(&w, c->number[hub], ARR_COUNT + c->class_of[hub]);
  }
}
