/* Prog: construction with value numbering, copies, dead code, verification, operation counts and the listing of
 * --dump=prog. */
#include "ir/prog.h"

#include <stdlib.h>
#include <string.h>

Prog *prog_new(Arena *a) {
  Prog *p = ARENA_NEW(a, Prog);
  p->arena = a;
  vec_push(a, &p->ins, ((Ins){0}));
  p->table = idtable(a, 128);
  return p;
}

/* An empty program with room for n instructions and the stores of p. */
static Prog *with_room(const Prog *p, uint32_t n) {
  Prog *r = ARENA_NEW(p->arena, Prog);
  r->arena = p->arena;
  r->folds_constants = p->folds_constants;
  r->ins.cap = n + 1;
  r->ins.at = ARENA_ARRAY(p->arena, Ins, r->ins.cap);
  r->stores.cap = p->stores.n + 1;
  r->stores.at = ARENA_ARRAY(p->arena, Store, r->stores.cap);
  vec_push(p->arena, &r->ins, ((Ins){0}));
  r->table = idtable(p->arena, n + 1);
  return r;
}

Prog *prog_new_like(const Prog *p) { return with_room(p, p->ins.n); }

void prog_release(Prog *p) {
  arena_release(p->arena, p->ins.at, p->ins.cap * sizeof *p->ins.at);
  arena_release(p->arena, p->stores.at, p->stores.cap * sizeof *p->stores.at);
  arena_release(p->arena, p->table.slots, p->table.cap * sizeof *p->table.slots);
}

/* --- value numbering --- */

/* Whether equal instructions may be merged; a pivot need not be checked twice. */
static int is_pure(IrOp op) { return op != IR_SOLVE && op != IR_NEST && op != IR_TITLE; }

static uint32_t hash_ins(const Ins *i) {
  uint32_t h = (uint32_t)i->op * 0x9e3779b9u;
  const uint32_t parts[] = {
      i->a, i->b, i->c, i->index, (uint32_t)i->array, (uint32_t)i->number.num, (uint32_t)i->number.den};
  for (size_t k = 0; k < sizeof parts / sizeof *parts; k++) h = (h ^ parts[k]) * 0x85ebca6bu + (h >> 13);
  for (const char *c = i->op == IR_FN1 || i->op == IR_FN2 ? i->text : NULL; c && *c; c++)
    h = (h ^ (unsigned char)*c) * 16777619u;
  return h ^ (h >> 16);
}

static int same(const Ins *x, const Ins *y) {
  if (x->op != y->op || x->a != y->a || x->b != y->b || x->c != y->c || x->index != y->index || x->array != y->array)
    return 0;
  if (x->op == IR_CONST) return num_equal(x->number, y->number);
  if (x->op == IR_FN1 || x->op == IR_FN2) return strcmp(x->text, y->text) == 0;
  return 1;
}

static Slot append(Prog *p, Ins i) {
  vec_push(p->arena, &p->ins, i);
  if (is_pure(i.op)) idtable_add(&p->table, hash_ins(&i), p->ins.n - 1);
  return p->ins.n - 1;
}

static int is_num(const Prog *p, Slot s, int64_t value) {
  const Ins *i = &p->ins.at[s];
  return s && i->op == IR_CONST && num_equal(i->number, num_int(value));
}

/* Identities x + 0, x - 0, 1*x, 0*x, x/1, 0/x, x + (-y), x - (-y), x^1, x^2; slot 0 is the structural zero.
 * NOT_A_SLOT: none applies. */
static Slot fold(Prog *p, const Ins *i) {
  switch (i->op) {
    case IR_ADD:
      if (!i->a) return i->b;
      if (!i->b) return i->a;
      if (p->ins.at[i->b].op == IR_NEG) return prog_op(p, IR_SUB, i->a, p->ins.at[i->b].a);
      return p->ins.at[i->a].op == IR_NEG ? prog_op(p, IR_SUB, i->b, p->ins.at[i->a].a) : NOT_A_SLOT;
    case IR_SUB:
      if (!i->b) return i->a;
      if (!i->a) return prog_op(p, IR_NEG, i->b, 0);
      return p->ins.at[i->b].op == IR_NEG ? prog_op(p, IR_ADD, i->a, p->ins.at[i->b].a) : NOT_A_SLOT;
    case IR_MUL:
      if (!i->a || !i->b) return 0;
      if (is_num(p, i->a, -1)) return prog_op(p, IR_NEG, i->b, 0);
      if (is_num(p, i->b, -1)) return prog_op(p, IR_NEG, i->a, 0);
      if (is_num(p, i->a, 1)) return i->b;
      return is_num(p, i->b, 1) ? i->a : NOT_A_SLOT;
    case IR_DIV:
      if (!i->a) return 0;
      if (is_num(p, i->b, -1)) return prog_op(p, IR_NEG, i->a, 0);
      return is_num(p, i->b, 1) ? i->a : NOT_A_SLOT;
    case IR_NEG:
      if (!i->a) return 0;
      if (p->ins.at[i->a].op == IR_CONST) return prog_num(p, num_neg(p->ins.at[i->a].number));
      return p->ins.at[i->a].op == IR_NEG ? p->ins.at[i->a].a : NOT_A_SLOT;
    case IR_FN2: /* C compilers make these of such powers */
      if (strcmp(i->text, "pow") != 0) return NOT_A_SLOT;
      if (is_num(p, i->b, 1)) return i->a;
      return is_num(p, i->b, 2) ? prog_op(p, IR_MUL, i->a, i->a) : NOT_A_SLOT;
    case IR_CONST: case IR_PI: case IR_LOAD: case IR_SQRT: case IR_FN1: case IR_MIN: case IR_MAX:
    case IR_SIGN: case IR_LT: case IR_LE: case IR_EQ: case IR_NOT: case IR_AND: case IR_OR: case IR_SELECT:
    case IR_PIVOT: case IR_SOLVE: case IR_SOLVED: case IR_NEST: case IR_TABLE: case IR_TITLE: break;
  }
  return NOT_A_SLOT;
}

Slot prog_ins(Prog *p, Ins i) {
  Slot folded = p->folds_constants ? prog_constant_fold(p, &i) : NOT_A_SLOT;
  if (folded == NOT_A_SLOT) folded = fold(p, &i);
  if (folded != NOT_A_SLOT) return folded;
  if (!is_pure(i.op)) return append(p, i);
  Ins key = i;
  int commutes = i.op == IR_ADD || i.op == IR_MUL;
  for (int turn = 0; turn <= commutes; turn++) {
    uint32_t hash = hash_ins(&key), slot = idtable_start(&p->table, hash), known;
    while (idtable_next(&p->table, hash, &slot, &known))
      if (same(&p->ins.at[known], &key)) return known;
    key.a = i.b;
    key.b = i.a;
  }
  return append(p, i);
}

Slot prog_op(Prog *p, IrOp op, Slot a, Slot b) { return prog_ins(p, (Ins){.op = op, .a = a, .b = b}); }

Slot prog_add_product(Prog *p, Slot x, Slot a, Slot b) {
  Slot ab = prog_op(p, IR_MUL, a, b);
  return prog_op(p, IR_ADD, x, ab);
}

Slot prog_sub_product(Prog *p, Slot x, Slot a, Slot b) {
  Slot ab = prog_op(p, IR_MUL, a, b);
  return prog_op(p, IR_SUB, x, ab);
}

Slot prog_num(Prog *p, Num n) {
  return num_value(n) == 0 ? 0 : prog_ins(p, (Ins){.op = IR_CONST, .number = num_drop_error(n)});
}
void prog_title(Prog *p, const char *text) { prog_ins(p, (Ins){.op = IR_TITLE, .text = text}); }

void prog_store(Prog *p, uint32_t array, uint32_t index, Slot s, const char *comment) {
  vec_push(p->arena, &p->stores, ((Store){array, index, s, comment}));
}

void prog_copy_stores(Prog *to, const Prog *from, const Slot *map) {
  for (uint32_t k = 0; k < from->stores.n; k++) {
    const Store *s = &from->stores.at[k];
    prog_store(to, s->array, s->index, map[s->slot], s->comment);
  }
}

Slot solve_element(const SolveElements *list, uint32_t at) {
  for (uint32_t k = 0; k < list->n; k++)
    if (list->at[k].at == at) return list->at[k].x;
  return 0;
}

static int by_place(const void *a, const void *b) {
  uint32_t x = ((const SolveElement *)a)->at, y = ((const SolveElement *)b)->at;
  return (x > y) - (x < y);
}

void solve_sort(SolveElements *list) {
  if (list->n) qsort(list->at, list->n, sizeof *list->at, by_place);
}

void prog_solve(Prog *p, Solve k, Slot *x) {
  SolveElements list = {0};
  for (uint32_t e = 0; e < k.list.n; e++) {
    SolveElement s = k.list.at[e];
    uint32_t i = s.at / k.n, j = s.at % k.n;
    if (!s.x) continue;
    vec_push(p->arena, &list, s);
    if (i < k.n && i != j) vec_push(p->arena, &list, ((SolveElement){j * k.n + i, s.x}));
  }
  solve_sort(&list);
  k.list = list;
  vec_push(p->arena, &p->solves, k);
  Slot s = prog_ins(p, (Ins){.op = IR_SOLVE, .index = p->solves.n - 1});
  for (uint32_t i = 0; i < k.n + k.m; i++) x[i] = prog_ins(p, (Ins){.op = IR_SOLVED, .a = s, .index = i});
}

int prog_takes_name(const Prog *p, Slot s) {
  const Ins *i = &p->ins.at[s];
  return s && !i->name && i->op != IR_CONST && i->op != IR_PI && i->op != IR_LOAD;
}

void prog_name(Prog *p, Slot s, Name name) {
  if (prog_takes_name(p, s)) p->ins.at[s].name = name;
}

int ir_is_scalar(IrArray array) {
  return array == ARR_T || array == ARR_ORDER || array == ARR_PER_ORDER || array == ARR_UP;
}

int ir_is_condition(IrOp op) { return op >= IR_LT && op <= IR_OR; }

const char *ir_made_name(Arena *a, const Ins *i, int of_one, const char *x, const char *y) {
  enum { MADE_NAME_MAX = 14 };
  if (i->op == IR_FN1 && x) return arena_printf(a, "%s_%s", i->text, x);
  if (i->op == IR_DIV && of_one && y) return arena_printf(a, "inv_%s", y);
  if (i->op != IR_MUL || !x || !y) return NULL;
  if (i->a == i->b) return arena_printf(a, "%s_sq", x);
  return strlen(x) + strlen(y) <= MADE_NAME_MAX ? arena_printf(a, "%s_%s", x, y) : NULL;
}

int ir_is_leaf(IrOp op) { return op == IR_CONST || op == IR_PI || op == IR_LOAD; }

/* --- passes --- */

uint32_t prog_operands(const Prog *p, const Ins *i) {
  const Solve *k = i->op == IR_SOLVE ? &p->solves.at[i->index] : NULL;
  return 3 + (i->op == IR_NEST ? p->nests.at[i->index].nouter : k ? k->list.n + solve_unknowns(k) : 0);
}

Slot prog_operand(const Prog *p, const Ins *i, uint32_t k) {
  if (k < 3) return ins_operand(i, (int)k);
  if (i->op == IR_NEST) return p->nests.at[i->index].outer[k - 3];
  const Solve *s = &p->solves.at[i->index];
  return k - 3 < s->list.n ? s->list.at[k - 3].x : s->rhs[k - 3 - s->list.n];
}

static void mark_needed(const Prog *p, unsigned char *need) {
  for (uint32_t i = 0; i < p->stores.n; i++) need[p->stores.at[i].slot] = 1;
  for (Slot s = p->ins.n; s-- > 1;) {
    const Ins *i = &p->ins.at[s];
    if (i->op == IR_PIVOT || i->op == IR_TITLE || (i->op == IR_NEST && nest_sets(&p->nests.at[i->index]))) need[s] = 1;
    for (uint32_t k = 0; need[s] && k < prog_operands(p, i); k++) need[prog_operand(p, i, k)] = 1;
  }
}

static const Slot *moved(Arena *a, const Slot *map, const Slot *from, uint32_t n) {
  Slot *to = ARENA_ARRAY(a, Slot, n);
  for (uint32_t i = 0; i < n; i++) to[i] = map[from[i]];
  return to;
}

Ins prog_import(Prog *to, const Prog *from, const Slot *map, Ins i) {
  i.a = map[i.a];
  i.b = map[i.b];
  i.c = map[i.c];
  if (i.op == IR_TABLE) {
    vec_push(to->arena, &to->tables, from->tables.at[i.index]);
    i.index = to->tables.n - 1;
  }
  if (i.op == IR_NEST) {
    Nest n = from->nests.at[i.index];
    n.outer = moved(to->arena, map, n.outer, n.nouter);
    i.index = to->nests.n;
    to->cells = from->cells;
    vec_push(to->arena, &to->nests, n);
  }
  if (i.op != IR_SOLVE) return i;
  Solve k = from->solves.at[i.index];
  SolveElements list = {0};
  for (uint32_t e = 0; e < k.list.n; e++)
    vec_push(to->arena, &list, ((SolveElement){k.list.at[e].at, map[k.list.at[e].x]}));
  k.list = list;
  k.rhs = moved(to->arena, map, k.rhs, solve_unknowns(&k));
  i.index = to->solves.n;
  vec_push(to->arena, &to->solves, k);
  return i;
}

uint32_t prog_parts(const Prog *p) { return p->nests.n + 1; }
const Prog *prog_part(const Prog *p, uint32_t k) { return k ? p->nests.at[k - 1].body : p; }

uint32_t *prog_uses(const Prog *p) {
  uint32_t *uses = ARENA_ARRAY(p->arena, uint32_t, p->ins.n);
  for (Slot s = 1; s < p->ins.n; s++) {
    const Ins *i = &p->ins.at[s];
    for (uint32_t k = 0; k < prog_operands(p, i); k++) uses[prog_operand(p, i, k)]++;
  }
  for (uint32_t k = 0; k < p->stores.n; k++) uses[p->stores.at[k].slot]++;
  return uses;
}

Prog *prog_tidy(const Prog *p) {
  Arena *arena = p->arena;
  unsigned char *need = ARENA_ARRAY(arena, unsigned char, p->ins.n);
  uint32_t *divisions = ARENA_ARRAY(arena, uint32_t, p->ins.n);
  Slot *map = ARENA_ARRAY(arena, Slot, p->ins.n);
  mark_needed(p, need);
  for (Slot s = 1; s < p->ins.n; s++)
    if (need[s] && p->ins.at[s].op == IR_DIV && p->ins.at[p->ins.at[s].b].op != IR_CONST) divisions[p->ins.at[s].b]++;
  uint32_t room = 1; /* for the number 1, what is needed, and inverses */
  for (Slot s = 1; s < p->ins.n; s++) room += (uint32_t)(need[s] + (divisions[s] > 1));
  Prog *r = with_room(p, room);
  Slot one = 0;
  for (Slot s = 1; s < p->ins.n; s++) {
    if (!need[s]) continue;
    uint32_t shared = p->ins.at[s].op == IR_DIV ? divisions[p->ins.at[s].b] : 0;
    Ins i = prog_import(r, p, map, p->ins.at[s]);
    if (shared > 1) {
      one = prog_num(r, num_int(1));
      Slot inverse = prog_op(r, IR_DIV, one, i.b);
      map[s] = prog_op(r, IR_MUL, i.a, inverse);
      prog_name(r, map[s], i.name);
    } else {
      map[s] = prog_ins(r, i);
      prog_name(r, map[s], i.name);
    }
  }
  prog_copy_stores(r, p, map);
  arena_release(arena, need, p->ins.n * sizeof *need);
  arena_release(arena, divisions, p->ins.n * sizeof *divisions);
  arena_release(arena, map, p->ins.n * sizeof *map);
  return r;
}

/* Checks the nest at slot s: its operands, the indices of its body, and the body. */
static const char *verify_nest(const Prog *p, Slot s) {
  const Nest *n = &p->nests.at[p->ins.at[s].index];
  for (uint32_t k = 0; k < n->nouter; k++)
    if (n->outer[k] >= s) return arena_printf(p->arena, "nest %u uses a later instruction", s);
  for (Slot k = 1; k < n->body->ins.n; k++) {
    const Ins *i = &n->body->ins.at[k];
    if (i->op == IR_LOAD && !ir_is_scalar(i->array) && i->index >= (i->array == ARR_OUTER ? n->nouter : n->n))
      return arena_printf(p->arena, "a load of nest %u has an index out of range", s);
  }
  return prog_verify(n->body);
}

const char *prog_verify(const Prog *p) {
  if (p->fault) return p->fault;
  for (Slot s = 1; s < p->ins.n; s++) {
    const Ins *i = &p->ins.at[s];
    const char *wrong = i->op == IR_NEST ? verify_nest(p, s) : NULL;
    if (wrong) return wrong;
    if (i->op == IR_LOAD && i->array == ARR_CELL && i->a && p->ins.at[i->a].op != IR_NEST)
      return arena_printf(p->arena, "sum %u has no nest", s);
    if (i->a >= s || i->b >= s || i->c >= s) return arena_printf(p->arena, "instruction %u uses a later one", s);
    int takes_condition = i->op == IR_NOT || i->op == IR_AND || i->op == IR_OR;
    if (i->a && ir_is_condition(p->ins.at[i->a].op) && !takes_condition && i->op != IR_SELECT)
      return arena_printf(p->arena, "instruction %u computes with a condition", s);
    if (takes_condition && !ir_is_condition(p->ins.at[i->a].op))
      return arena_printf(p->arena, "instruction %u needs a condition", s);
    if (i->op == IR_SOLVED && p->ins.at[i->a].op != IR_SOLVE)
      return arena_printf(p->arena, "instruction %u has no solve", s);
  }
  for (uint32_t k = 0; k < p->stores.n; k++)
    if (p->stores.at[k].slot >= p->ins.n) return "a store names no instruction";
  return NULL;
}

static int same_table(const IrTable *a, const IrTable *b) {
  const Spline *x = a->curve, *y = b->curve;
  return strcmp(a->name, b->name) == 0 && a->order == b->order && x->n == y->n && !x->jet == !y->jet &&
         memcmp(x->row, y->row, x->n * sizeof *x->row) == 0;
}

int prog_same(const Prog *a, const Prog *b) {
  if (a->tables.n != b->tables.n) return 0;
  for (uint32_t i = 0; i < a->tables.n; i++)
    if (!same_table(&a->tables.at[i], &b->tables.at[i])) return 0;
  StrBuf x = strbuf(a->arena), y = strbuf(a->arena);
  prog_dump(a, &x);
  prog_dump(b, &y);
  return x.n == y.n && memcmp(sb_text(&x), sb_text(&y), x.n) == 0;
}

/* --- counting --- */

static OpCount ops_sum(OpCount a, OpCount b) {
  return (OpCount){a.add + b.add, a.mul + b.mul, a.div + b.div, a.sqrt + b.sqrt, a.fn + b.fn, a.other + b.other};
}

/* Operations of all turns of a nest. */
static OpCount count_nest(const Nest *n) {
  OpCount c = prog_count(n->body);
  uint64_t t = n->count;
  return (OpCount){(c.add + n->body->stores.n)*t, c.mul*t, c.div*t, c.sqrt*t, c.fn*t, c.other*t};
}

OpCount prog_count(const Prog *p) {
  OpCount c = {0};
  for (Slot s = 1; s < p->ins.n; s++) {
    const Ins *i = &p->ins.at[s];
    switch (i->op) {
      case IR_ADD: case IR_SUB: c.add++; break;
      case IR_MUL: c.mul++; break;
      case IR_DIV: c.div++; break;
      case IR_SQRT: c.sqrt++; break;
      case IR_FN1: case IR_FN2: case IR_TABLE: c.fn++; break;
      case IR_MIN: case IR_MAX: case IR_SIGN: case IR_LT: case IR_LE: case IR_EQ: case IR_NOT: case IR_AND:
      case IR_OR: case IR_SELECT: c.other++; break;
      case IR_SOLVE: c = ops_sum(c, solve_count(p->arena, &p->solves.at[i->index])); break;
      case IR_NEST: c = ops_sum(c, count_nest(&p->nests.at[i->index])); break;
      case IR_NEG: case IR_CONST: case IR_PI: case IR_LOAD: case IR_PIVOT: case IR_SOLVED: case IR_TITLE: break;
    }
  }
  return c;
}

uint64_t ops_total(OpCount c) { return c.add + c.mul + c.div + c.sqrt + c.fn + c.other; }

uint32_t ops_as_int(uint64_t ops) { return ops < INT32_MAX ? (uint32_t)ops : INT32_MAX; }

int prog_has_pivots(const Prog *p) {
  for (Slot s = 1; s < p->ins.n; s++)
    if (p->ins.at[s].op == IR_PIVOT || p->ins.at[s].op == IR_SOLVE) return 1;
  return 0;
}

int prog_solves_dense(const Prog *p) {
  for (uint32_t i = 0; p && i < p->solves.n; i++)
    if (!p->solves.at[i].m) return 1;
  return 0;
}

uint32_t prog_work_size(const Prog *p) {
  uint32_t most = 0;
  for (uint32_t i = 0; i < p->solves.n; i++) {
    const Solve *k = &p->solves.at[i];
    uint32_t n = k->n, m = k->m, system = n * n + m * n + n + m, scratch = n * n + m * n + m * m + 2 * n + 9 * m;
    /* where reals are vectors, each lane is solved by itself in doubles: at most a quarter of the room */
    uint32_t lane = (system + scratch + 3) / 4;
    uint32_t need = system + (!m ? 0 : scratch > lane ? scratch : lane);
    if (need > most) most = need;
  }
  return most;
}

/* --- listing --- */

static const char *const op_names[] = {
  "const", "pi", "load", "add", "sub", "mul", "div", "neg", "sqrt", "fn", "fn2", "min", "max", "sign",
  "lt", "le", "eq", "not", "and", "or", "select", "pivot", "solve", "solved", "nest", "table", "title",
};

static const char *const array_names[ARR_COUNT] = {"t", "q", "v", "z",     "p",         "u",  "a",   "g",    "free",
                                                   "x", "s", "c", "order", "per_order", "up", "sum", "outer"};

static void dump_nest(const Nest *n, StrBuf *out) {
  sb_printf(out, "  %u rows, %lld + %lld*i turns from %lld*i\n", n->rows, (long long)n->turns, (long long)n->more,
            (long long)n->skew);
  for (uint32_t k = 0; k < n->n; k++)
    sb_printf(out, "  #%u: %lld + %lld*i + %lld*j\n", k, (long long)n->at[k].first, (long long)n->at[k].by_row,
              (long long)n->at[k].by_turn);
  for (uint32_t k = 0; k < n->nouter; k++) sb_printf(out, "  outer[%u]: %%%u\n", k, n->outer[k]);
  prog_dump(n->body, out);
  sb_puts(out, "  end of nest\n");
}

void prog_dump(const Prog *p, StrBuf *out) {
  for (Slot s = 1; s < p->ins.n; s++) {
    const Ins *i = &p->ins.at[s];
    sb_printf(out, "%%%u = %s", s, op_names[i->op]);
    if (i->op == IR_CONST) {
      sb_putc(out, ' ');
      num_print(out, i->number);
    }
    if (i->op == IR_LOAD) sb_printf(out, " %s[%u]", array_names[i->array], i->index);
    if (i->text) sb_printf(out, " %s", i->text);
    if (i->op == IR_PIVOT || i->op == IR_SOLVE || i->op == IR_SOLVED || i->op == IR_NEST || i->op == IR_TABLE)
      sb_printf(out, " #%u", i->index);
    if (i->a) sb_printf(out, " %%%u", i->a);
    if (i->b) sb_printf(out, " %%%u", i->b);
    if (i->c) sb_printf(out, " %%%u", i->c);
    if (i->name) sb_printf(out, "  ; %s", i->name);
    sb_putc(out, '\n');
    if (i->op == IR_NEST) dump_nest(&p->nests.at[i->index], out);
  }
  for (uint32_t k = 0; k < p->stores.n; k++)
    sb_printf(out, "out%u[%u] = %%%u  ; %s\n", p->stores.at[k].array, p->stores.at[k].index, p->stores.at[k].slot,
              p->stores.at[k].comment);
}
