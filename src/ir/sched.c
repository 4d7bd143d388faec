#include "ir/prog.h"

typedef struct {
  const Prog *from;
  Prog *to;
  Slot *map;
  unsigned char *done;
  VEC(Slot) open;
} Schedule;

/* Operands first, a before b before c; by a list, since sums may have any number of terms. */
static void compute(Schedule *d, Slot s) {
  vec_push(d->to->arena, &d->open, s);
  while (d->open.n) {
    Slot x = d->open.at[d->open.n - 1];
    const Ins *i = &d->from->ins.at[x];
    Slot next = !i->a || d->done[i->a] ? !i->b || d->done[i->b] ? !i->c || d->done[i->c] ? 0 : i->c : i->b : i->a;
    const Nest *n = i->op == IR_NEST ? &d->from->nests.at[i->index] : NULL;
    for (uint32_t k = 0; n && !next && k < n->nouter; k++)
      if (!d->done[n->outer[k]]) next = n->outer[k];
    if (!d->done[x] && next) {
      vec_push(d->to->arena, &d->open, next);
      continue;
    }
    d->open.n--;
    if (d->done[x]) continue;
    d->done[x] = 1;
    d->map[x] = prog_ins(d->to, prog_moved(d->to, d->from, d->map, *i));
    prog_name(d->to, d->map[x], i->name);
  }
}

Prog *prog_by_demand(const Prog *p) {
  Arena *a = p->arena;
  Schedule d = {.from = p, .to = prog_like(p), .map = ARENA_ARRAY(a, Slot, p->ins.n), .done = ARENA_ARRAY(a, unsigned char, p->ins.n)};
  for (Slot s = 1; s < p->ins.n; s++)
    if (p->ins.at[s].op == IR_PIVOT) compute(&d, s);
  for (uint32_t k = 0; k < p->stores.n; k++)
    if (p->stores.at[k].slot) compute(&d, p->stores.at[k].slot);
  for (uint32_t k = 0; k < p->stores.n; k++) {
    Store st = p->stores.at[k];
    prog_store(d.to, st.array, st.index, d.map[st.slot], st.comment);
  }
  return d.to;
}
