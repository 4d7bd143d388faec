/* Traversals of the expression graph: maps over nodes, reachable nodes, substitution, operation counts. */
#include <stdlib.h>
#include <string.h>

#include "sym/expr.h"
#include "sym/expr_impl.h"
#include "sym/sum_nest.h"

/* --- maps --- */

ExprMap expr_map(Arena *a) { return (ExprMap){.arena = a, .epoch = 1}; }
ExprMap expr_map_by_id(Arena *a) { return (ExprMap){.arena = a, .epoch = 1, .by_id = 1}; }

void expr_map_clear(ExprMap *m) {
  m->epoch++;
  m->n = 0;
}

/* Slot of e, or the free slot for it (open addressing; Knuth's multiplicative hash). */
static uint32_t map_slot(const ExprMap *m, Expr e) {
  uint32_t i = (e * 2654435769u) >> m->shift;
  while (m->at[i].stamp == m->epoch && m->at[i].key != e) i = (i + 1) & (m->cap - 1);
  return i;
}

static void map_grow(ExprMap *m) {
  ExprMap old = *m;
  m->cap = old.cap ? 2 * old.cap : 64;
  m->shift = old.cap ? old.shift - 1 : 26;
  m->at = ARENA_ARRAY(m->arena, ExprMapEntry, m->cap);
  for (uint32_t i = 0; i < old.cap; i++)
    if (old.at[i].stamp == m->epoch) m->at[map_slot(m, old.at[i].key)] = old.at[i];
  if (old.cap) arena_recycle(m->arena, old.at, old.cap * sizeof *old.at);
}

static void set_by_id(ExprMap *m, Expr e, uint32_t value) {
  uint32_t cap = m->cap ? m->cap : 64;
  while (cap <= e) cap *= 2;
  if (cap > m->cap) {
    uint64_t *of = ARENA_ARRAY(m->arena, uint64_t, cap);
    if (m->cap) memcpy(of, m->of, m->cap * sizeof *of);
    if (m->cap) arena_recycle(m->arena, m->of, m->cap * sizeof *of);
    m->of = of;
    m->cap = cap;
  }
  m->n += m->of[e] >> 32 != m->epoch;
  m->of[e] = (uint64_t)m->epoch << 32 | value;
}

void expr_map_set(ExprMap *m, Expr e, uint32_t value) {
  if (m->by_id) {
    set_by_id(m, e, value);
    return;
  }
  if (2 * m->n >= m->cap) map_grow(m);
  ExprMapEntry *x = &m->at[map_slot(m, e)];
  m->n += x->stamp != m->epoch;
  *x = (ExprMapEntry){e, value, m->epoch};
}

uint32_t expr_map_get(const ExprMap *m, Expr e) {
  if (!m->n) return 0;
  if (m->by_id) return e < m->cap && m->of[e] >> 32 == m->epoch ? (uint32_t)m->of[e] : 0;
  const ExprMapEntry *x = &m->at[map_slot(m, e)];
  return x->stamp == m->epoch ? x->value : 0;
}

void expr_map_free(ExprMap *m) {
  if (m->cap) arena_recycle(m->arena, m->at, m->cap * (m->by_id ? sizeof *m->of : sizeof *m->at));
  *m = m->by_id ? expr_map_by_id(m->arena) : expr_map(m->arena);
}

/* --- reachable nodes --- */

/* Sorts a few ids, which are descending for the most part. */
static void sort_few(Expr *at, uint32_t n) {
  for (uint32_t i = 0, k = n; i + 1 < k; i++) {
    Expr e = at[i];
    at[i] = at[--k];
    at[k] = e;
  }
  for (uint32_t i = 1, k; i < n; i++) {
    Expr e = at[i];
    for (k = i; k && at[k - 1] > e; k--) at[k] = at[k - 1];
    at[k] = e;
  }
}

/* Sorts n node ids: a few by insertion, otherwise a radix sort with digits of eight or eleven bits. */
static void sort_ids(ExprGraph *g, Expr *at, uint32_t n) {
  enum { FEW = 48, MANY = 512, BITS = 11 };
  uint32_t place[1 << BITS], bits = n < MANY ? 8 : BITS, last = (1u << bits) - 1;
  if (n < FEW) {
    sort_few(at, n);
    return;
  }
  Expr most = 0;
  for (uint32_t i = 0; i < n; i++) most = at[i] > most ? at[i] : most;
  if (g->spare_n < n) {
    g->spare_n = 2 * n;
    g->spare = ARENA_ARRAY(g->arena, Expr, g->spare_n);
  }
  for (uint32_t shift = 0; shift < 32 && most >> shift; shift += bits) {
    memset(place, 0, (last + 1) * sizeof *place);
    for (uint32_t i = 0; i < n; i++) place[(at[i] >> shift) & last]++;
    for (uint32_t d = 0, sum = 0; d <= last; d++) {
      uint32_t count = place[d];
      place[d] = sum;
      sum += count;
    }
    for (uint32_t i = 0; i < n; i++) g->spare[place[(at[i] >> shift) & last]++] = at[i];
    memcpy(at, g->spare, n * sizeof *at);
  }
}

/* Nodes below which a traversal does not go: the arguments of quantified sums; definitions, too. */
typedef enum { TO_LEAVES, TO_SUMS, TO_DEFINITIONS } Depth;

/* Room of a list of n nodes: a power of 2, so that the next list may have it. */
static size_t list_room(uint32_t n) {
  size_t room = 4;
  while (room <= n) room *= 2;
  return room;
}

/* Nodes reachable from the roots, ascending; not below nodes of `leaves` (or NULL). Ends where there are more than
 * `most`. */
static ExprList reachable(ExprGraph *g, const Expr *roots, uint32_t n, const ExprMap *leaves, Depth depth,
                          uint32_t most) {
  VEC(Expr) found = {g->found, 0, g->found_cap};
  expr_map_clear(&g->seen);
  for (uint32_t i = 0; i < n; i++)
    if (roots[i] && !expr_map_get(&g->seen, roots[i])) {
      expr_map_set(&g->seen, roots[i], 1);
      vec_push(g->arena, &found, roots[i]);
    }
  for (uint32_t k = 0; k < found.n && found.n <= most; k++) {
    Expr e = found.at[k];
    ExprOp op = expr_op(g, e);
    if ((leaves && expr_map_get(leaves, e)) || (op == EX_DEF && depth == TO_DEFINITIONS) ||
        (op == EX_NEST && depth != TO_LEAVES))
      continue;
    for (uint32_t i = 0; i < expr_nargs(g, e); i++) {
      Expr a = expr_arg(g, e, i);
      if (expr_map_get(&g->seen, a)) continue;
      expr_map_set(&g->seen, a, 1);
      vec_push(g->arena, &found, a);
    }
  }
  sort_ids(g, found.at, found.n);
  g->found = found.at;
  g->found_cap = found.cap;
  Expr *list = ARENA_ARRAY(g->arena, Expr, list_room(found.n));
  if (found.n) memcpy(list, found.at, found.n * sizeof *list);
  return (ExprList){list, found.n};
}

void expr_list_free(ExprGraph *g, ExprList l) {
  arena_recycle(g->arena, (void *)(uintptr_t)l.at, list_room(l.n) * sizeof *l.at);
}

static ExprList topo(ExprGraph *g, const Expr *roots, uint32_t n, const ExprMap *leaves, Depth depth) {
  return reachable(g, roots, n, leaves, depth, UINT32_MAX);
}

ExprList expr_topo_few(ExprGraph *g, const Expr *roots, uint32_t n, uint32_t most) {
  return reachable(g, roots, n, NULL, TO_LEAVES, most);
}
ExprList expr_topo(ExprGraph *g, const Expr *roots, uint32_t n) { return topo(g, roots, n, NULL, TO_LEAVES); }
ExprList expr_topo_to_sums(ExprGraph *g, const Expr *roots, uint32_t n) { return topo(g, roots, n, NULL, TO_SUMS); }
ExprList expr_topo_shallow(ExprGraph *g, const Expr *roots, uint32_t n) {
  return topo(g, roots, n, NULL, TO_DEFINITIONS);
}
ExprList expr_topo_until(ExprGraph *g, const Expr *roots, uint32_t n, const ExprMap *leaves) {
  return topo(g, roots, n, leaves, TO_LEAVES);
}

int expr_contains(ExprGraph *g, Expr e, int (*want)(const Symbol *s, const void *data), const void *data) {
  ExprList l = expr_topo(g, &e, 1);
  uint32_t i = 0;
  while (i < l.n && !(expr_op(g, l.at[i]) == EX_SYM && want(expr_sym_of(g, l.at[i]), data))) i++;
  expr_list_free(g, l);
  return i < l.n;
}

static int same_symbol(const Symbol *s, const void *data) { return s->node == *(const Expr *)data; }

int expr_contains_sym(ExprGraph *g, Expr e, SymId sym) {
  Expr node = expr_symbol(g, sym)->node;
  return expr_contains(g, e, same_symbol, &node);
}

void expr_mark_containing(ExprGraph *g, ExprList l, int (*want)(const Symbol *s, const void *data), const void *data,
                          ExprMap *m) {
  expr_map_clear(m);
  for (uint32_t i = 0; i < l.n; i++) {
    Expr e = l.at[i];
    int yes = expr_op(g, e) == EX_SYM && want(expr_sym_of(g, e), data);
    for (uint32_t k = 0; k < expr_nargs(g, e) && !yes; k++) yes = expr_map_get(m, expr_arg(g, e, k)) != 0;
    if (yes) expr_map_set(m, e, 1);
  }
}

/* --- rewriting bottom-up --- */

/* Arguments of e mapped through m; an argument not in m stays. Returns 1 when one changed. */
static int mapped_args(const ExprGraph *g, const ExprMap *m, Expr e, Expr *args) {
  int changed = 0;
  for (uint32_t k = 0; k < expr_nargs(g, e); k++) {
    Expr a = expr_arg(g, e, k), b = expr_map_get(m, a);
    args[k] = b ? b : a;
    changed |= args[k] != a;
  }
  return changed;
}

Expr expr_with_mapped_args(ExprGraph *g, const ExprMap *m, Expr e) {
  uint32_t n = expr_nargs(g, e) + 1;
  Expr *args = ARENA_ARRAY(g->arena, Expr, n), x = mapped_args(g, m, e, args) ? expr_rebuild(g, e, args) : e;
  arena_recycle(g->arena, args, n * sizeof *args);
  return x;
}

Name expr_name_with_suffix(ExprGraph *g, Name name, const char *suffix) {
  if (!*suffix) return name;
  size_t n = strlen(name) + strlen(suffix) + 1;
  char *text = arena_printf(g->arena, "%s%s", name, suffix);
  Name interned = intern(g->names, text);
  arena_recycle(g->arena, text, n);
  return interned;
}

/* out[i] = roots[i] with the nodes in the map replaced; rewritten nodes are added to the map. */
static void rewrite(ExprGraph *g, const Expr *roots, uint32_t n, ExprMap *m, const char *suffix, Expr *out) {
  ExprList l = expr_topo(g, roots, n);
  uint32_t most = 1;
  for (uint32_t i = 0; i < l.n; i++) most = expr_nargs(g, l.at[i]) > most ? expr_nargs(g, l.at[i]) : most;
  Expr *args = ARENA_ARRAY(g->arena, Expr, most);
  for (uint32_t i = 0; i < l.n; i++) {
    Expr x = l.at[i];
    if (expr_op(g, x) == EX_SYM || expr_map_get(m, x) || !mapped_args(g, m, x, args)) continue;
    Expr y = expr_op(g, x) == EX_DEF
                 ? expr_def(g, expr_name_with_suffix(g, expr_def_name(g, x), suffix), args[0])
                 : expr_rebuild(g, x, args);
    expr_map_set(m, x, y);
  }
  arena_recycle(g->arena, args, most * sizeof *args);
  expr_list_free(g, l);
  for (uint32_t i = 0; i < n; i++) {
    Expr r = expr_map_get(m, roots[i]);
    out[i] = r ? r : roots[i];
  }
}

static Expr rewrite_one(ExprGraph *g, Expr e, ExprMap *m, const char *suffix) {
  Expr out;
  rewrite(g, &e, 1, m, suffix, &out);
  return out;
}

Expr expr_substitute(ExprGraph *g, Expr e, const Expr *with, uint32_t n, const char *suffix) {
  if (!e) return 0;
  expr_map_clear(&g->work);
  ExprList l = expr_topo(g, &e, 1);
  for (uint32_t i = 0; i < l.n; i++) {
    if (expr_op(g, l.at[i]) != EX_SYM) continue;
    SymId s = expr_sym_id(g, l.at[i]);
    if (s < n && with[s]) expr_map_set(&g->work, l.at[i], with[s]);
  }
  expr_list_free(g, l);
  return g->work.n ? rewrite_one(g, e, &g->work, suffix) : e;
}

Expr expr_replace(ExprGraph *g, Expr e, const SymId *syms, const Expr *with, uint32_t n) {
  if (!e) return 0;
  expr_map_clear(&g->work);
  for (uint32_t i = 0; i < n; i++) expr_map_set(&g->work, expr_symbol(g, syms[i])->node, with[i]);
  return rewrite_one(g, e, &g->work, "");
}

Expr expr_replace_by(ExprGraph *g, Expr e, ExprMap *m) { return m->n ? rewrite_one(g, e, m, "") : e; }

void expr_replace_nodes(ExprGraph *g, const Expr *roots, uint32_t n, const Expr *nodes, const Expr *with,
                        uint32_t nnodes, Expr *out) {
  expr_map_clear(&g->work);
  for (uint32_t i = 0; i < nnodes; i++) expr_map_set(&g->work, nodes[i], with[i]);
  rewrite(g, roots, n, &g->work, "", out);
}

Expr expr_expand_defs(ExprGraph *g, Expr e) {
  if (!e) return 0;
  ExprList l = expr_topo(g, &e, 1);
  ExprMap m = expr_map(g->arena);
  for (uint32_t i = 0; i < l.n; i++) {
    Expr x = l.at[i], body = expr_op(g, x) == EX_DEF ? expr_arg(g, x, 0) : 0, known = body ? expr_map_get(&m, body) : 0;
    Expr y = known ? known : body ? body : expr_with_mapped_args(g, &m, x);
    if (y != x) expr_map_set(&m, x, y);
  }
  Expr r = expr_map_get(&m, e);
  expr_list_free(g, l);
  expr_map_free(&m);
  return r ? r : e;
}

/* --- counting --- */

double expr_tree_size(ExprGraph *g, Expr e, uint32_t *distinct) {
  ExprList l = expr_topo_shallow(g, &e, 1);
  double *size = ARENA_ARRAY(g->arena, double, l.n);
  for (uint32_t k = 0; k < l.n; k++) {
    expr_map_set(&g->seen, l.at[k], k + 1);
    size[k] = 1;
    int whole = expr_op(g, l.at[k]) == EX_DEF || expr_op(g, l.at[k]) == EX_NEST;
    for (uint32_t i = 0; !whole && i < expr_nargs(g, l.at[k]); i++)
      size[k] += size[expr_map_get(&g->seen, expr_arg(g, l.at[k], i)) - 1];
  }
  double all = size[l.n - 1];
  *distinct = l.n;
  arena_recycle(g->arena, size, l.n * sizeof *size);
  expr_list_free(g, l);
  return all;
}

/* Operations of b^e: repeated squaring for integers, one square root for halves, 20 for other powers. */
static uint32_t power_ops(Num e) {
  if (!num_is_exact(e)) return 20;
  int64_t n = e.num < 0 ? -e.num : e.num;
  uint32_t ops = 0;
  for (int64_t k = n; k > 1; k >>= 1) ops += 1 + (uint32_t)(k & 1);
  if (e.den == 2) return ops + 1;
  return e.den == 1 ? ops : 20;
}

static uint32_t sum_ops(const ExprGraph *g, Expr e) {
  uint32_t n = expr_pairs(g, e, EX_SUM), ops = n - 1;
  for (uint32_t i = 0; i < n; i++) {
    Num c;
    Expr t = expr_pair(g, e, EX_SUM, i, &c);
    ops += !num_is_one(num_abs(c)) && !expr_is_num(g, t);
  }
  return ops;
}

static uint32_t prod_ops(const ExprGraph *g, Expr e) {
  uint32_t n = expr_pairs(g, e, EX_PROD), ops = n - 1, inverse = 0;
  for (uint32_t i = 0; i < n; i++) {
    Num k;
    expr_pair(g, e, EX_PROD, i, &k);
    ops += power_ops(k);
    inverse += num_sign(k) < 0;
  }
  return ops + (inverse == n);
}

/* Operations of one turn: the number of turns is the same in all forms that are compared. */
static uint32_t nest_ops(const ExprGraph *g, Expr e) {
  const SumNest *s = expr_sum_nest(g, e);
  return s->nshares + s->nreads;
}

/* Operations of a list, which is given up. */
static uint32_t count_ops(ExprGraph *g, ExprList l) {
  uint32_t ops = 0;
  for (uint32_t i = 0; i < l.n; i++) {
    Expr e = l.at[i];
    switch (expr_op(g, e)) {
      case EX_NUM: case EX_SYM: case EX_DEF: case EX_CELL: case EX_COUNT: break;
      case EX_NEST: ops += nest_ops(g, e); break;
      case EX_SUM: ops += sum_ops(g, e); break;
      case EX_PROD: ops += prod_ops(g, e); break;
      EX_FUNCTION_CASES
      case EX_POW: case EX_ATAN2: case EX_HYPOT: ops += 20; break;
      case EX_ABS: case EX_SIGN: case EX_FLOOR: case EX_MIN: case EX_MAX: case EX_LT: case EX_LE: case EX_EQ:
      case EX_NOT: case EX_AND: case EX_OR: case EX_SELECT: ops += 1; break;
    }
  }
  expr_list_free(g, l);
  return ops;
}

uint32_t expr_ops(ExprGraph *g, const Expr *roots, uint32_t n) { return count_ops(g, expr_topo(g, roots, n)); }
uint32_t expr_ops_shallow(ExprGraph *g, Expr e) { return count_ops(g, expr_topo_shallow(g, &e, 1)); }
