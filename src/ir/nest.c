/* The search for nests, and the program with the nests found (nest.h).
 *
 * Pieces are searched in waves: first those that need no hub, then those whose hubs are complete. Each wave sorts its pieces into groups by their
 * canonical form; groups become nests. Several ways to partition the program are tried; the one that covers most of it, or is shortest, wins. */
#include "ir/nest.h"

#include <stdlib.h>

#include "base/hash.h"
#include "ir/nest_impl.h"
#include "ir/roll.h"

enum { FEWEST_PIECES = 8, MOST_VALUES = 2000 };

/* A group: pieces with one canonical form. */
typedef struct {
  CanonicalForm tape;
  VEC(int64_t) columns; /* indices of all pieces, one after the other */
  VEC(uint32_t) pieces;
} PieceGroup;

typedef struct {
  Nest nest;
  const uint32_t *class_of; /* by position in nest.at: class of the hub, from 1; 0: an array */
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
  uint64_t h = hash_bytes(FNV1A_START, (const char *)t->words.at, t->words.n * sizeof *t->words.at);
  return (uint32_t)(h ^ h >> 32);
}

static int same_words(const CanonicalForm *x, const CanonicalForm *y) {
  return x->words.n == y->words.n && x->columns.n == y->columns.n && memcmp(x->words.at, y->words.at, x->words.n * sizeof *x->words.at) == 0;
}

#define COPY(a, v) \
  do { \
    (v).at = memcpy(arena_alloc((a), ((v).n + 1) * sizeof *(v).at), (v).at, (v).n * sizeof *(v).at); \
    (v).cap = (v).n; \
  } while (0)

static CanonicalForm copy_tape(Arena *a, const CanonicalForm *t) {
  CanonicalForm r = *t;
  COPY(a, r.nodes);
  COPY(a, r.links);
  COPY(a, r.gives);
  COPY(a, r.words);
  COPY(a, r.class_of);
  COPY(a, r.array);
  return r;
}

static PieceGroup *group_of(Search *s, const CanonicalForm *t) {
  uint32_t hash = hash_words(t), slot = idtable_start(&s->table, hash), id;
  while (idtable_next(&s->table, hash, &slot, &id))
    if (same_words(&s->groups.at[id].tape, t)) return &s->groups.at[id];
  vec_push(s->c.a, &s->groups, ((PieceGroup){.tape = copy_tape(s->c.a, t)}));
  idtable_add(&s->table, hash, s->groups.n - 1);
  return &s->groups.at[s->groups.n - 1];
}

/* --- nests --- */

static void add_nest(Search *s, const PieceGroup *x, const Fit *f) {
  Arena *a = s->c.a;
  Nest n = {.rows = f->rows, .skew = f->skew, .turns = f->turns, .more = f->more, .begin = f->begin, .at = f->at, .n = x->tape.columns.n, .count = f->count};
  n.body = nest_body(&s->c, &x->tape, f, &n.outer, &n.nouter);
  vec_push(a, &s->found, ((FoundNest){n, x->tape.class_of.at}));
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
  Indices all = {a, x->columns.at, x->tape.array.at, x->tape.columns.n, x->tape.nodes.n};
  nest_affine(&all, order, n, &fits);
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
    PieceGroup *x = group_of(s, &s->tape);
    for (uint32_t j = 0; j < s->tape.columns.n; j++) vec_push(s->c.a, &x->columns, s->tape.columns.at[j]);
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
  uint32_t *base;      /* by class of hubs: first cell */
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
  r->base = ARENA_ARRAY(c->a, uint32_t, c->classes + 1);
  for (uint32_t k = 0; k < c->classes; k++) {
    r->base[k] = r->to->cells;
    r->to->cells += size[k];
  }
}

static int has_cell(const Rebuild *r, Slot x) { return r->s->c.hub[x] && r->s->terms[x]; }

/* Whether a nest computes the term. */
static int is_nested(const Rebuild *r, Slot term) {
  uint32_t piece = r->s->c.piece[term];
  return piece && r->s->nested[piece];
}

static void push_needed(Rebuild *r, uint32_t item) {
  if (item && !r->done[item]) vec_push(r->to->arena, &r->open, item);
}

/* The terms of a hub that no nest adds. */
static void other_terms(const Rebuild *r, Slot hub, HubTerms *terms) {
  const Partition *c = &r->s->c;
  terms->n = 0;
  if (c->hub[hub] == HUB_SUM) nest_terms(c, hub, terms);
  uint32_t n = 0, leaves = 0;
  for (uint32_t k = 0; k < terms->n; k++) {
    Slot x = terms->at[k].value;
    int is_leaf = c->leaves[hub] && nest_is_leaf(c, x);
    if (is_leaf ? !r->s->nested[c->leaves[hub] + leaves++] : !is_nested(r, x)) terms->at[n++] = terms->at[k];
  }
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
    at[j] = n.at[j];
    if (f->class_of[j]) at[j].first += r->base[f->class_of[j] - 1];
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
  return prog_ins(r->to, (Ins){.op = IR_LOAD, .array = ARR_CELL, .a = r->map[r->from->ins.n + nest - 1], .index = cell, .name = name});
}

static Slot make_hub(Rebuild *r, Slot hub) {
  const Search *s = r->s;
  Name name = r->from->ins.at[hub].name;
  Slot sum = load_cell(r, r->base[s->c.class_of[hub]] + s->c.number[hub], s->last[hub], name ? name : "sum");
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
    r->map[x] = x >= n ? make_nest(r, x - n)
                : has_cell(r, x) ? make_hub(r, x) : prog_ins(r->to, prog_import(r->to, r->from, r->map, r->from->ins.at[x]));
    if (x < n) prog_name(r->to, r->map[x], r->from->ins.at[x].name);
  }
}

/* By store: cell, from 1, for a zero between stored sums. No nest adds to it, and one loop stores all; 0: no cell. */
static const uint32_t *empty_cells(const Rebuild *r) {
  enum { FEW = 16 };
  const Prog *p = r->from;
  const Partition *c = &r->s->c;
  uint32_t *cell = ARENA_ARRAY(c->a, uint32_t, p->stores.n + 1), zeros = 0, known = 0;
  for (uint32_t k = 0; k < p->stores.n; k++) {
    Slot x = p->stores.at[k].slot;
    if (!x) {
      zeros++;
      continue;
    }
    uint32_t is_cell = c->hub[x] == HUB_STORED && r->s->terms[x] && c->number[x] == k;
    for (uint32_t j = k - zeros; j < k && known && is_cell && zeros < FEW; j++) cell[j] = r->base[c->class_of[x]] + j + 1;
    zeros = 0;
    known = is_cell;
  }
  return cell;
}

static Prog *with_nests(const Search *s) {
  const Prog *p = s->c.p;
  uint32_t items = p->ins.n + s->found.n;
  Rebuild r = {.s = s, .from = p, .to = prog_new(p->arena), .map = ARENA_ARRAY(p->arena, Slot, items)};
  r.done = ARENA_ARRAY(p->arena, unsigned char, items);
  number_cells(&r);
  for (Slot x = 1; x < p->ins.n; x++) {
    uint32_t piece = s->c.piece[x];
    Slot sum = s->c.sum[x];
    int gone = (piece && s->nested[piece]) || (sum && sum != x && has_cell(&r, sum)) || ir_is_leaf(p->ins.at[x].op);
    if (!gone) rebuild(&r, x);
  }
  const uint32_t *empty = empty_cells(&r);
  for (uint32_t k = 0; k < p->stores.n; k++) {
    Store st = p->stores.at[k];
    rebuild(&r, st.slot);
    Slot x = empty[k] ? load_cell(&r, empty[k] - 1, s->found.n, "sum") : r.map[st.slot];
    prog_store(r.to, st.array, st.index, x, st.comment);
  }
  return prog_tidy(r.to);
}

/* Number of entries in the tables of a nest; indices share tables. */
static uint32_t table_entries(const Nest *n) {
  uint32_t entries = n->begin ? n->rows + 1 : 0;
  for (uint32_t k = 0; k < n->n; k++) {
    int turns = n->at[k].turn_at != NULL, rows = n->at[k].row_at != NULL;
    for (uint32_t j = 0; j < k; j++) turns &= n->at[j].turn_at != n->at[k].turn_at, rows &= n->at[j].row_at != n->at[k].row_at;
    entries += (turns ? n->count : 0) + (rows ? n->rows : 0);
  }
  return entries;
}

/* Number of instructions that nests replace; 0 where all nests are single loops without tables, which are left to ir/roll.h: there they
 * share values with the code around. */
static uint32_t instructions_replaced(const Search *s, int *tables) {
  const Partition *c = &s->c;
  uint32_t inside = 0;
  int deep = *tables = 0;
  for (uint32_t k = 0; k < s->found.n; k++) {
    const Nest *n = &s->found.at[k].nest;
    *tables |= table_entries(n) > 0;
    deep |= n->rows > 1 && n->count > n->rows;
  }
  for (uint32_t k = 0; k < c->pieces.n; k++)
    if (s->nested[k + 1]) inside += c->pieces.at[k].n;
  for (Slot x = 1; x < c->p->ins.n; x++) {
    inside += c->sum[x] && c->celled[c->sum[x]] == 2;
    if (*tables && c->hub[x] == HUB_SUM && c->celled[x] == 1) inside += s->terms[x] - 1;
  }
  return deep || *tables ? inside : 0;
}

/* Whether store k continues a run: of zeros, or of consecutive elements of an array. */
static int continues_run(const Prog *p, uint32_t k) {
  const Store *st = &p->stores.at[k];
  const Ins *i = &p->ins.at[st->slot], *last = k ? &p->ins.at[st[-1].slot] : NULL;
  if (!k || st->array != st[-1].array || !st->slot != !st[-1].slot) return 0;
  return !st->slot || (i->op == IR_LOAD && last->op == IR_LOAD && i->array == last->array && i->index == last->index + 1);
}

/* Length of the emitted text, in lines of C: one an instruction or store outside of loops, one for eight entries of a table. */
static uint32_t length(const Prog *p) {
  unsigned by_index = 0;
  for (int k = 0; k < ARR_COUNT; k++) by_index |= ir_is_scalar((IrArray)k) ? 0 : 1u << k;
  Rolls r = roll_find(p, by_index, 0, 1);
  uint32_t n = r.n;
  for (uint32_t k = 0; k < r.loops.n; k++) n -= r.loops.at[k].period * (r.loops.at[k].count - 1);
  for (uint32_t k = 0; k < p->stores.n; k++) n += !r.stored[k] && !continues_run(p, k);
  for (uint32_t k = 0; k < p->nests.n; k++) n += p->nests.at[k].body->ins.n + table_entries(&p->nests.at[k]) / 8;
  return n;
}

static Search search(const Prog *p, unsigned ends) {
  Arena *a = p->arena;
  Search s = {.c = nest_partition(p, ends)};
  s.local = ARENA_ARRAY(a, Local, p->ins.n);
  s.nested = ARENA_ARRAY(a, uint32_t, s.c.pieces.n + 1);
  s.terms = ARENA_ARRAY(a, uint32_t, p->ins.n);
  s.last = ARENA_ARRAY(a, uint32_t, p->ins.n);
  if (s.c.hubs.n && s.c.pieces.n >= FEWEST_PIECES) search_all(&s);
  return s;
}

/* With tables: the program of the shortest text, of partitions that replace about as many instructions. */
static Prog *shortest_with_tables(Prog *p) {
  static const unsigned tried[] = {0, CUT_COMMON_TERMS, CUT_STORES, CUT_COMMON_TERMS | CUT_STORES, CUT_LEAVES, CUT_LEAVES | CUT_STORES};
  Prog *best = p;
  uint32_t least = UINT32_MAX, most = p->ins.n / 2;
  for (size_t k = 0; k < sizeof tried / sizeof *tried; k++) {
    int tables;
    if (tried[k] & CUT_LEAVES && most > p->ins.n - p->ins.n / 8) break;
    ArenaMark before = arena_mark(p->arena);
    Search s = search(p, tried[k]);
    uint32_t inside = instructions_replaced(&s, &tables);
    int enough = inside + p->ins.n / 16 > most;
    if (enough && inside > most) most = inside;
    Prog *now = enough ? with_nests(&s) : NULL;
    uint32_t n = now ? length(now) : least;
    if (n < least) best = now, least = n;
    else arena_forget(p->arena, before);
  }
  return best;
}

Prog *prog_find_nests(Prog *p, uint32_t from) {
  static const unsigned tried[] = {0, CUT_COMMON_TERMS, CUT_STORES, CUT_COMMON_TERMS | CUT_STORES, CUT_LEAVES};
  if (p->ins.n < from || p->solves.n || p->nests.n) return p;
  Search best = {0};
  uint32_t most = p->ins.n / 2; /* nests of less than half of the program are not worth it */
  for (size_t k = 0; k < sizeof tried / sizeof *tried && most < p->ins.n - p->ins.n / 8; k++) {
    int tables;
    ArenaMark before = arena_mark(p->arena);
    Search s = search(p, tried[k]);
    uint32_t inside = instructions_replaced(&s, &tables);
    if (inside <= most || tables) arena_forget(p->arena, before);
    if (inside <= most) continue;
    if (tables) return shortest_with_tables(p);
    most = inside;
    best = s;
  }
  return best.found.n ? with_nests(&best) : p;
}

static int has_tables(const Prog *p) {
  for (uint32_t k = 0; k < p->nests.n; k++)
    if (table_entries(&p->nests.at[k])) return 1;
  return 0;
}

Prog *prog_find_shorter_nests(Prog *factored, Prog *tidy, uint32_t from) {
  Prog *first = prog_find_nests(factored, from), *second = has_tables(first) ? prog_find_nests(tidy, from) : tidy;
  if (second == tidy) return first;
  second = prog_factor(second);
  return length(second) < length(first) ? second : first;
}
