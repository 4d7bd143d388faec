/* Nests of loops for sums over pairs, sites or bodies: the search, and the program with the nests found.
 *
 * The search is one for connected components of a program's graph, so that bodies written out by hand are found as a
 * family is. Hubs are sums of many terms, and values with many users; without hubs the graph falls into pieces, one
 * for each pair of bodies. Pieces that differ only in the array elements that they read and the sums that they add
 * to are a group. Where these indices are affine in two counters, a group becomes a Nest (ir/prog.h) of the size of
 * one piece.
 *
 * Pieces are searched in waves: first those that need no hub, then those whose hubs are complete. Each wave sorts
 * its pieces into groups by their canonical form; groups become nests. Several ways to partition the program are
 * tried; the one that covers most of it wins. */
#include "base/hash.h"
#include "ir/nest_impl.h"

enum { FEWEST_PIECES = 8, MOST_VALUES = 2000 };

/* A group: pieces with one canonical form. */
typedef struct {
  CanonicalForm tape;
  VEC(int64_t) columns; /* indices of all pieces, one after the other */
  VEC(uint32_t) pieces;
} PieceGroup;

typedef struct {
  Nest nest;
  const uint32_t *array; /* by position in nest.at: the array, or ARR_COUNT + class of the hub */
} FoundNest;

typedef struct {
  Partition c;
  Local *local;
  CanonicalForm tape;
  VEC(PieceGroup) groups;     /* groups of one wave */
  IdTable table;        /* of `groups` */
  VEC(uint32_t) ready;  /* pieces, from 1, whose hubs are complete */
  VEC(Slot) complete;   /* hubs whose terms are all known, to be processed */
  VEC(FoundNest) found;
  uint32_t *nested;     /* by piece: its nest, from 1 */
  uint32_t *terms;      /* by slot of hubs: number of terms that nests add, */
  uint32_t *last;       /* and the last nest that adds one, from 1 */
} Search;

/* --- groups --- */

static uint32_t hash_words(const CanonicalForm *t) {
  uint64_t h = lag_fnv1a(LAG_FNV1A_START, (const char *)t->words.at, t->words.n * sizeof *t->words.at);
  return (uint32_t)(h ^ h >> 32);
}

static int same_words(const CanonicalForm *x, const CanonicalForm *y) {
  return x->words.n == y->words.n && x->columns.n == y->columns.n &&
         memcmp(x->words.at, y->words.at, x->words.n * sizeof *x->words.at) == 0;
}

/* The group of the form in s->tape, which a new group takes. */
static PieceGroup *group_of(Search *s) {
  const CanonicalForm *t = &s->tape;
  uint32_t hash = hash_words(t), slot = idtable_start(&s->table, hash), id;
  while (idtable_next(&s->table, hash, &slot, &id))
    if (same_words(&s->groups.at[id].tape, t)) return &s->groups.at[id];
  vec_push(s->c.a, &s->groups, ((PieceGroup){.tape = *t}));
  s->tape = (CanonicalForm){0};
  idtable_add(&s->table, hash, s->groups.n - 1);
  return &s->groups.at[s->groups.n - 1];
}

/* --- nests --- */

static void add_nest(Search *s, const PieceGroup *x, const Fit *f) {
  Arena *a = s->c.a;
  Nest n = {.rows = f->rows,
            .skew = f->skew, .turns = f->turns, .more = f->more, .at = f->at, .n = x->tape.columns.n,
            .count = f->count};
  n.body = nest_body(&s->c, &x->tape, f, &n.outer, &n.nouter);
  vec_push(a, &s->found, ((FoundNest){n, x->tape.array.at}));
  for (uint32_t k = 0; k < f->count; k++) {
    uint32_t piece = x->pieces.at[f->pieces[k]];
    const HubTerms *gives = &s->c.pieces.at[piece - 1].gives;
    s->nested[piece] = s->found.n;
    for (uint32_t j = 0; j < gives->n; j++) {
      s->terms[gives->at[j].hub]++;
      s->last[gives->at[j].hub] = s->found.n;
    }
  }
}

static void find_nests(Search *s, const PieceGroup *x) {
  Arena *a = s->c.a;
  uint32_t n = x->pieces.n, *order = ARENA_ARRAY(a, uint32_t, n);
  Fits fits = {0};
  for (uint32_t k = 0; k < n; k++) order[k] = k;
  nest_affine((Indices){a, x->columns.at, x->tape.array.at, x->tape.columns.n, n, order, NULL}, &fits);
  for (uint32_t k = 0; k < fits.n; k++) add_nest(s, x, &fits.at[k]);
}

/* Finds the nests of one wave: the pieces ready.at[from] ... */
static void search_wave(Search *s, uint32_t from) {
  s->groups.n = 0;
  s->table = idtable(s->c.a, 0);
  for (uint32_t k = from; k < s->ready.n; k++) {
    Piece *q = &s->c.pieces.at[s->ready.at[k] - 1];
    if (!q->apart || !q->gives.n || q->n > MOST_VALUES) continue;
    nest_canonical_form(&s->c, q, s->local, s->ready.at[k], &s->tape);
    const CanonicalForm form = s->tape;
    PieceGroup *x = group_of(s);
    for (uint32_t j = 0; j < form.columns.n; j++) vec_push(s->c.a, &x->columns, form.columns.at[j]);
    vec_push(s->c.a, &x->pieces, s->ready.at[k]);
  }
  for (uint32_t k = 0; k < s->groups.n; k++)
    if (s->groups.at[k].pieces.n >= FEWEST_PIECES) find_nests(s, &s->groups.at[k]);
}

/* --- waves: pieces that are ready, then pieces that those make ready --- */

static void complete_hubs(Search *s) {
  Partition *c = &s->c;
  while (s->complete.n) {
    Slot hub = s->complete.at[--s->complete.n];
    c->celled[hub] = s->terms[hub] == 0 ? 0 : s->terms[hub] == c->terms_of[hub] ? 2 : 1;
    for (uint32_t k = c->last_waiting[hub]; k; k = c->waiting.at[k - 1].before) {
      const Waiting *w = &c->waiting.at[k - 1];
      if (w->sum && --c->waits[w->sum] == 0) vec_push(c->a, &s->complete, w->sum);
      if (w->piece && --c->pieces.at[w->piece - 1].waits == 0) vec_push(c->a, &s->ready, w->piece);
    }
  }
}

static void search_all(Search *s) {
  Partition *c = &s->c;
  for (uint32_t k = 1; k <= c->pieces.n; k++)
    if (!c->pieces.at[k - 1].waits) vec_push(c->a, &s->ready, k);
  for (uint32_t k = 0; k < c->hubs.n; k++)
    if (!c->waits[c->hubs.at[k]]) vec_push(c->a, &s->complete, c->hubs.at[k]);
  complete_hubs(s);
  for (uint32_t from = 0; from < s->ready.n;) {
    uint32_t end = s->ready.n;
    if (end - from >= FEWEST_PIECES) search_wave(s, from);
    for (; from < end; from++) {
      const HubTerms *gives = &c->pieces.at[s->ready.at[from] - 1].gives;
      for (uint32_t k = 0; k < gives->n; k++)
        if (--c->waits[gives->at[k].hub] == 0) vec_push(c->a, &s->complete, gives->at[k].hub);
    }
    complete_hubs(s);
  }
}

/* --- the program with its nests --- */

typedef struct {
  const Search *s;
  const Prog *from;
  Prog *to;
  CellOrder *order;    /* by class of hubs */
  Slot *map;           /* by item: a slot of `from` or, from ins.n on, a nest */
  unsigned char *done;
  VEC(uint32_t) open;
} Rebuild;

static void number_cells(Rebuild *r) {
  const Search *s = r->s;
  const Partition *c = &s->c;
  uint32_t *size = ARENA_ARRAY(c->a, uint32_t, c->classes + 1);
  for (uint32_t k = 0; k < c->hubs.n; k++) {
    Slot hub = c->hubs.at[k];
    if (s->terms[hub] && size[c->class_of[hub]] <= c->number[hub]) size[c->class_of[hub]] = c->number[hub] + 1;
  }
  r->order = ARENA_ARRAY(c->a, CellOrder, c->classes + 1);
  for (uint32_t k = 0; k < s->found.n; k++) {
    const FoundNest *f = &s->found.at[k];
    for (uint32_t j = 0; j < f->nest.n; j++)
      if (f->array[j] >= ARR_COUNT) cells_follow(&r->order[f->array[j] - ARR_COUNT], &f->nest.at[j]);
  }
  for (uint32_t k = 0; k < c->classes; k++) {
    r->order[k].base = r->to->cells;
    cells_complete(&r->order[k], (int64_t)size[k] - 1);
    r->to->cells += (uint32_t)(r->order[k].step * r->order[k].each);
  }
}

static int has_cell(const Rebuild *r, Slot x) { return r->s->c.hub[x] && r->s->terms[x]; }

/* Whether a nest computes the term. */
static int is_nested(const Rebuild *r, Slot term) {
  uint32_t piece = r->s->c.piece[term];
  return piece && r->s->nested[piece];
}

static void push_needed(Rebuild *r, uint32_t item) {
  if (item && !r->done[item]) vec_push(r->s->c.a, &r->open, item);
}

/* The terms of a hub that no nest adds. */
static void other_terms(const Rebuild *r, Slot hub, HubTerms *terms) {
  const Partition *c = &r->s->c;
  terms->n = 0;
  if (c->hub[hub] == HUB_SUM) nest_terms(c, hub, terms);
  uint32_t n = 0;
  for (uint32_t k = 0; k < terms->n; k++)
    if (!is_nested(r, terms->at[k].value)) terms->at[n++] = terms->at[k];
  terms->n = n;
}

static void push_operands(Rebuild *r, uint32_t item) {
  const Search *s = r->s;
  uint32_t n = r->from->ins.n;
  if (item >= n) {
    const Nest *x = &s->found.at[item - n].nest;
    for (uint32_t k = x->nouter; k-- > 0;) push_needed(r, x->outer[k]);
    if (item > n) push_needed(r, item - 1);
  } else if (has_cell(r, item)) {
    other_terms(r, item, s->c.terms);
    for (uint32_t k = s->c.terms->n; k-- > 0;) push_needed(r, s->c.terms->at[k].value);
    push_needed(r, n + s->last[item] - 1);
  } else {
    const Ins *i = &r->from->ins.at[item];
    push_needed(r, i->c);
    push_needed(r, i->b);
    push_needed(r, i->a);
  }
}

static Slot make_nest(Rebuild *r, uint32_t k) {
  const FoundNest *f = &r->s->found.at[k];
  Nest n = f->nest;
  IrSubscript *at = ARENA_ARRAY(r->to->arena, IrSubscript, n.n + 1);
  for (uint32_t j = 0; j < n.n; j++) {
    at[j] = f->array[j] >= ARR_COUNT ? cell_in_order(&r->order[f->array[j] - ARR_COUNT], &n.at[j]) : n.at[j];
  }
  Slot *outer = ARENA_ARRAY(r->to->arena, Slot, n.nouter + 1);
  for (uint32_t j = 0; j < n.nouter; j++) outer[j] = r->map[n.outer[j]];
  n.at = at;
  n.outer = outer;
  vec_push(r->to->arena, &r->to->nests, n);
  return prog_ins(r->to, (Ins){.op = IR_NEST, .a = k ? r->map[r->from->ins.n + k - 1] : 0, .index = k});
}

/* The value of a cell after nest number `nest`, from 1. */
static Slot load_cell(Rebuild *r, uint32_t cell, uint32_t nest, Name name) {
  return prog_ins(
      r->to,
      (Ins){.op = IR_LOAD, .array = ARR_CELL, .a = r->map[r->from->ins.n + nest - 1], .index = cell, .name = name});
}

static Slot make_hub(Rebuild *r, Slot hub) {
  const Search *s = r->s;
  Name name = r->from->ins.at[hub].name;
  const Subscript cell = cell_in_order(&r->order[s->c.class_of[hub]], &(Subscript){.first = s->c.number[hub]});
  Slot sum = load_cell(r, (uint32_t)cell.first, s->last[hub], name ? name : "sum");
  other_terms(r, hub, s->c.terms);
  for (uint32_t k = 0; k < s->c.terms->n; k++)
    sum = prog_op(r->to, s->c.terms->at[k].minus ? IR_SUB : IR_ADD, sum, r->map[s->c.terms->at[k].value]);
  return sum;
}

/* Appends the item after its operands. */
static void rebuild(Rebuild *r, uint32_t item) {
  uint32_t n = r->from->ins.n;
  push_needed(r, item);
  while (r->open.n) {
    uint32_t x = r->open.at[r->open.n - 1], before = r->open.n;
    if (!r->done[x]) push_operands(r, x);
    if (r->open.n > before) continue;
    r->open.n--;
    if (r->done[x]) continue;
    r->done[x] = 1;
    r->map[x] = x >= n           ? make_nest(r, x - n)
                : has_cell(r, x) ? make_hub(r, x)
                                 : prog_ins(r->to, prog_import(r->to, r->from, r->map, r->from->ins.at[x]));
    if (x < n) prog_name(r->to, r->map[x], r->from->ins.at[x].name);
  }
}

static Prog *with_nests(const Search *s) {
  const Prog *p = s->c.p;
  uint32_t items = p->ins.n + s->found.n;
  Rebuild r = {.s = s, .from = p, .to = prog_new(p->arena), .map = ARENA_ARRAY(s->c.a, Slot, items)};
  r.done = ARENA_ARRAY(s->c.a, unsigned char, items);
  number_cells(&r);
  for (Slot x = 1; x < p->ins.n; x++) {
    uint32_t piece = s->c.piece[x];
    Slot sum = s->c.sum[x];
    int gone = (piece && s->nested[piece]) || (sum && sum != x && has_cell(&r, sum)) || ir_is_leaf(p->ins.at[x].op);
    if (!gone) rebuild(&r, x);
  }
  for (uint32_t k = 0; k < p->stores.n; k++) {
    Store st = p->stores.at[k];
    rebuild(&r, st.slot);
    prog_store(r.to, st.array, st.index, r.map[st.slot], st.comment);
  }
  Prog *tidy = prog_tidy(r.to);
  prog_release(r.to);
  return tidy;
}

/* Number of instructions that nests replace; 0 where all nests are single loops, which are left to ir/roll.h: there
 * they share values with the code around. */
static uint32_t instructions_replaced(const Search *s) {
  const Partition *c = &s->c;
  uint32_t inside = 0;
  int deep = 0;
  for (uint32_t k = 0; k < s->found.n; k++) {
    const Nest *n = &s->found.at[k].nest;
    deep |= n->rows > 1 && n->count > n->rows;
  }
  for (uint32_t k = 0; k < c->pieces.n; k++)
    if (s->nested[k + 1]) inside += c->pieces.at[k].n;
  for (Slot x = 1; x < c->p->ins.n; x++) inside += c->sum[x] && c->celled[c->sum[x]] == 2;
  return deep ? inside : 0;
}

static Search search(Arena *a, const Prog *p, unsigned ends) {
  Search s = {.c = nest_partition(a, p, ends)};
  s.local = ARENA_ARRAY(a, Local, p->ins.n);
  s.nested = ARENA_ARRAY(a, uint32_t, s.c.pieces.n + 1);
  s.terms = ARENA_ARRAY(a, uint32_t, p->ins.n);
  s.last = ARENA_ARRAY(a, uint32_t, p->ins.n);
  if (s.c.hubs.n && s.c.pieces.n >= FEWEST_PIECES) search_all(&s);
  return s;
}

/* The program, replaced by one with nests where they are worth it. */
static void nest_work(Arena *scratch, void *data) {
  static const unsigned tried[] = {0, CUT_COMMON_TERMS, CUT_COMMON_TERMS | CUT_STORES};
  Prog **p = data;
  uint32_t n = (*p)->ins.n, most = n / 2; /* nests of less than half of the program are not worth it */
  Search best = {0};
  for (size_t k = 0; k < sizeof tried / sizeof *tried && most < n - n / 8; k++) {
    ArenaMark before = arena_mark(scratch);
    Search s = search(scratch, *p, tried[k]);
    uint32_t inside = instructions_replaced(&s);
    if (inside > most) {
      most = inside;
      best = s;
    } else {
      arena_forget(scratch, before);
    }
  }
  if (best.found.n) *p = with_nests(&best);
}

Prog *prog_find_nests(Prog *p, uint32_t from) {
  if (p->ins.n < from || p->solves.n || p->nests.n) return p;
  arena_with_scratch(p->arena, nest_work, &p);
  return p;
}
