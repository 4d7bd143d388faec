/* unit_hoist. For each program: slots that depend on parameters alone are marked, and which of them the rest needs;
 * if moving them saves enough operations, they move to the program `derived`, and the rest loads them as parameters.
 * */
#include "ir/program_set.h"

#include "ir/roll.h"

enum {
  FEW = 64, /* derived parameters: up to so many are always worth their place, more must save operations */
  A_SHARE = 8 /* of a call's operations must be saved: 1/A_SHARE */
};

typedef struct {
  Prog *derived;       /* store k is parameter first + k */
  uint32_t first, n, nameless;
  VEC(uint32_t) index; /* by slot of `derived`: k + 1, or 0 */
  VEC(Name) called;    /* by slot of `derived`: its name, or one made from names of its operands; or NULL */
} Hoist;

/* Whether the instruction can move to `derived`: loads of parameters, and operations without effects. */
static int can_move(const Ins *i) {
  switch (i->op) {
    case IR_PIVOT: case IR_SOLVE: case IR_SOLVED: case IR_NEST: case IR_TABLE: case IR_TITLE: return 0;
    case IR_LOAD: return i->array == ARR_P;
    default: return 1;
  }
}

/* By slot: whether its value depends on parameters alone. */
static unsigned char *find_constant(const Prog *p) {
  unsigned char *constant = ARENA_ARRAY(p->arena, unsigned char, p->ins.n);
  constant[0] = 1;
  for (Slot s = 1; s < p->ins.n; s++) {
    const Ins *i = &p->ins.at[s];
    constant[s] = can_move(i) && constant[i->a] && constant[i->b] && constant[i->c];
  }
  return constant;
}

/* By slot: whether its value may become a derived parameter. Not numbers, which the C compiler folds unless a
 * function takes them, nor a changed sign, which is not worth a load. */
static unsigned char *find_worthy(const Prog *p, const unsigned char *constant) {
  unsigned char *worthy = ARENA_ARRAY(p->arena, unsigned char, p->ins.n),
                *number = ARENA_ARRAY(p->arena, unsigned char, p->ins.n);
  number[0] = 1;
  for (Slot s = 1; s < p->ins.n; s++) {
    const Ins *i = &p->ins.at[s];
    number[s] = constant[s] && i->op != IR_LOAD && i->op != IR_FN1 && i->op != IR_FN2 && i->op != IR_SQRT &&
                number[i->a] && number[i->b] && number[i->c];
    worthy[s] = constant[s] && !number[s] && !ir_is_leaf(i->op) && !ir_is_condition(i->op) && i->op != IR_NEG;
  }
  return worthy;
}

/* mark[s]: HERE where the remaining program needs slot s, ONCE where derived parameters do. */
static unsigned char *mark_needed(const Prog *p, const unsigned char *worthy) {
  enum { HERE = 1, ONCE = 2 };
  unsigned char *mark = ARENA_ARRAY(p->arena, unsigned char, p->ins.n);
  for (uint32_t k = 0; k < p->stores.n; k++) mark[p->stores.at[k].slot] |= HERE;
  for (Slot s = p->ins.n; s-- > 1;) {
    const Ins *i = &p->ins.at[s];
    if (i->op == IR_PIVOT || i->op == IR_TITLE || i->op == IR_SOLVE) mark[s] |= HERE;
    unsigned char below = worthy[s] && mark[s] ? ONCE : mark[s];
    for (uint32_t k = 0; k < prog_operands(p, i); k++) mark[prog_operand(p, i, k)] |= below;
  }
  return mark;
}

static int is_derived(const unsigned char *worthy, const unsigned char *mark, Slot s) {
  return worthy[s] && mark[s] & 1;
}

/* Whether the operations saved are worth the derived parameters that they take. */
static int is_profitable(const Prog *p, const unsigned char *worthy, const unsigned char *mark) {
  Prog once = {.arena = p->arena};
  uint64_t taken = 0;
  vec_push(p->arena, &once.ins, ((Ins){0}));
  for (Slot s = 1; s < p->ins.n; s++) {
    taken += (uint64_t)is_derived(worthy, mark, s);
    int leaves = mark[s] == 2 || is_derived(worthy, mark, s);
    if (leaves) vec_push(p->arena, &once.ins, ((Ins){.op = p->ins.at[s].op}));
  }
  return taken > 0 && (taken <= FEW || ops_total(prog_count(&once)) * A_SHARE >= ops_total(prog_count(p)));
}

/* Appends an instruction of `derived`. */
static Slot derive(Hoist *h, Ins i) {
  Prog *p = h->derived;
  Slot s = prog_ins(p, i);
  prog_name(p, s, i.name);
  while (h->called.n <= s) {
    const Ins *k = &p->ins.at[h->called.n], *top = &p->ins.at[k->a];
    int of_one = top->op == IR_CONST && num_is_one(top->number);
    Name name = h->called.n ? k->name : NULL;
    if (h->called.n && !name) name = ir_made_name(p->arena, k, of_one, h->called.at[k->a], h->called.at[k->b]);
    vec_push(p->arena, &h->called, name);
    vec_push(p->arena, &h->index, 0);
  }
  return s;
}

/* Load of the parameter that slot s of `derived` becomes; unnamed ones are called k1, k2, ... */
static Ins load_derived(Hoist *h, Slot s) {
  Prog *p = h->derived;
  uint32_t *at = &h->index.at[s];
  if (!*at) {
    *at = ++h->n;
    if (!h->called.at[s]) h->called.at[s] = arena_printf(p->arena, "k%u", ++h->nameless);
    prog_store(p, 0, h->first + *at - 1, s, h->called.at[s]);
  }
  return (Ins){.op = IR_LOAD, .array = ARR_P, .index = h->first + *at - 1, .name = h->called.at[s]};
}

static Prog *split_program(Hoist *h, const Prog *p) {
  unsigned char *constant = find_constant(p), *worthy = find_worthy(p, constant), *mark = mark_needed(p, worthy);
  if (!is_profitable(p, worthy, mark)) return NULL;
  Prog *left = prog_new_like(p);
  Slot *map = ARENA_ARRAY(p->arena, Slot, p->ins.n), *once = ARENA_ARRAY(p->arena, Slot, p->ins.n);
  for (Slot s = 1; s < p->ins.n; s++) {
    const Ins *i = &p->ins.at[s];
    if (mark[s] & 2 || is_derived(worthy, mark, s)) once[s] = derive(h, prog_import(h->derived, p, once, *i));
    if (is_derived(worthy, mark, s)) {
      map[s] = once[s] ? prog_ins(left, load_derived(h, once[s])) : 0;
    } else if (mark[s] & 1) {
      map[s] = prog_ins(left, prog_import(left, p, map, *i));
      prog_name(left, map[s], i->name);
    }
  }
  prog_copy_stores(left, p, map);
  return left;
}

static void hoist_from(Hoist *h, const Prog **p) {
  Prog *left = *p ? split_program(h, *p) : NULL;
  if (!left) return;
  *p = prog_tidy(left);
  prog_release(left);
}

void unit_hoist(ProgramSet *u) {
  IrConstraints *c = &u->constraints;
  Hoist h = {.derived = prog_new(u->arena), .first = u->p.n};
  const Prog *same = c->position == c->velocity ? c->position : NULL;
  const Prog **all[] = {&u->accel,    &c->residuals, &c->matrices, &c->position,
                        &c->velocity, &u->variation, &u->second,   &u->linear};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++)
    if (!same || all[k] != &c->velocity) hoist_from(&h, all[k]);
  if (same) c->velocity = c->position;
  if (!h.n) return;
  u->derived = h.derived;
  u->nderived = h.n;
}
