/* Storage of the expression graph: nodes, hash-consing, leaves, inspection and sign inference. */
#include "sym/expr.h"

#include <string.h>

#include "base/hash.h"
#include "sym/expr_impl.h"

#define X(NAME, arity, text) text,
static const char *const op_texts[EX_COUNT] = {
#include "sym/ops.def"
};
#undef X

ExprGraph *expr_graph(Arena *a, Interner *names) {
  ExprGraph *g = ARENA_NEW(a, ExprGraph);
  g->arena = a;
  g->names = names;
  g->share_kinds_at = expr_map(a);
  g->seen = expr_map_by_id(a);
  g->work = expr_map_by_id(a);
  g->live = expr_map_by_id(a);
  g->table = idtable(a, 512);
  g->named_table = idtable(a, 32);
  vec_push(a, &g->nodes, ((Node){0}));
  vec_push(a, &g->symbols, ((Symbol){0}));
  g->zero = expr_int(g, 0);
  g->one = expr_int(g, 1);
  g->minus_one = expr_int(g, -1);
  return g;
}

Arena *expr_arena(const ExprGraph *g) { return g->arena; }
uint32_t expr_count(const ExprGraph *g) { return g->nodes.n - 1; }
int expr_writes_sums_out(const ExprGraph *g) { return g->writes_sums_out; }
void expr_note_sums_out(ExprGraph *g) { g->writes_sums_out = 1; }

/* --- hash-consing --- */

static uint32_t hash_parts(ExprOp op, const Expr *args, uint32_t n, Name name) {
  uint32_t h = hash_mix(0x811c9dc5u, (uint32_t)op);
  for (uint32_t i = 0; i < n; i++) h = hash_mix(h, args[i]);
  for (const char *c = name; c && *c; c++) h = hash_mix(h, (unsigned char)*c);
  return h;
}

static uint32_t mix_64(uint32_t h, uint64_t x) { return hash_mix(hash_mix(h, (uint32_t)x), (uint32_t)(x >> 32)); }

/* Hash of the fields that num_equal compares; the error of an inexact number is not among them. */
static uint32_t hash_num(Num n) {
  uint64_t bits = 0;
  memcpy(&bits, &n.approx, sizeof bits);
  return n.den ? mix_64(mix_64(7, (uint64_t)n.num), (uint64_t)n.den) : mix_64(mix_64(11, bits), n.residue);
}

static Expr add_node(ExprGraph *g, Node n) {
  if (g->nodes.n >= UINT32_MAX / 2) arena_fail(g->arena);
  vec_push(g->arena, &g->nodes, n);
  return g->nodes.n - 1;
}

/* Appends a node and enters it into the hash table. */
static Expr add_hashed(ExprGraph *g, Node n, uint32_t hash) {
  Expr e = add_node(g, n);
  idtable_add(&g->table, hash, e);
  return e;
}

unsigned expr_traits(const ExprGraph *g, Expr e) { return g->nodes.at[e].has; }

static int can_overflow(ExprOp op) {
  return op == EX_EXP || op == EX_SINH || op == EX_COSH || op == EX_TANH || op == EX_POW;
}

/* Kinds and traits of a node's arguments, and its own. */
static void inherit(const ExprGraph *g, Node *n, const Expr *args) {
  unsigned has = can_overflow((ExprOp)n->op) ? HAS_GROWTH : 0;
  for (uint32_t i = 0; i < n->nargs; i++) {
    const Node *of = &g->nodes.at[args[i]];
    n->kinds |= of->kinds;
    has |= of->has | (n->op == EX_PROD && i % 2 && of->sign != SIGN_POSITIVE ? HAS_QUOTIENT : 0u);
  }
  n->has = has & 15u;
}

/* Name of a definition; NULL for other nodes. */
static Name name_of(const ExprGraph *g, const Node *n) {
  return n->op == EX_DEF ? g->def_names.at[g->args.at[n->payload + n->nargs]] : NULL;
}

static Expr make_named(ExprGraph *g, ExprOp op, const Expr *args, uint32_t nargs, Name name) {
  uint32_t hash = hash_parts(op, args, nargs, name), slot = idtable_start(&g->table, hash);
  for (Expr e; idtable_next(&g->table, hash, &slot, &e);) {
    const Node *n = &g->nodes.at[e];
    if (n->op == op && n->nargs == nargs && name_of(g, n) == name &&
        memcmp(g->args.at + n->payload, args, nargs * sizeof *args) == 0)
      return e;
  }
  Node n = {.op = (uint8_t)op, .nargs = nargs, .payload = g->args.n};
  n.sign = expr_infer_sign(g, op, args, nargs) & 15u;
  inherit(g, &n, args);
  for (uint32_t i = 0; i < nargs; i++) vec_push(g->arena, &g->args, args[i]);
  if (op == EX_DEF) {
    vec_push(g->arena, &g->args, g->def_names.n);
    vec_push(g->arena, &g->def_names, name);
  }
  return add_hashed(g, n, hash);
}

Expr expr_make(ExprGraph *g, ExprOp op, const Expr *args, uint32_t nargs) {
  return make_named(g, op, args, nargs, NULL);
}

/* --- leaves --- */

Expr expr_num(ExprGraph *g, Num v) {
  uint32_t hash = hash_num(v), slot = idtable_start(&g->table, hash);
  for (Expr e; idtable_next(&g->table, hash, &slot, &e);) {
    const Node *n = &g->nodes.at[e];
    if (n->op == EX_NUM && num_equal(g->numbers.at[n->payload], v)) return e;
  }
  int s = num_sign(v);
  Node n = {.op = EX_NUM, .payload = g->numbers.n};
  ExprSign sign = !num_sign_is_sure(v) ? SIGN_UNKNOWN
                  : s > 0              ? SIGN_POSITIVE
                  : s < 0              ? SIGN_NEGATIVE
                                       : SIGN_NONNEGATIVE;
  n.sign = sign & 15u;
  vec_push(g->arena, &g->numbers, v);
  return add_hashed(g, n, hash);
}

Expr expr_int(ExprGraph *g, int64_t n) { return expr_num(g, num_int(n)); }

SymId expr_declare(ExprGraph *g, SymKind kind, uint32_t index, Name name, ExprSign sign) {
  SymId id = g->symbols.n;
  Node n = {.op = EX_SYM, .payload = id, .sign = sign & 15u, .kinds = (uint16_t)(1u << kind)};
  Expr node = add_node(g, n); /* stays out of the table: each declaration is its own node */
  Symbol s = {.kind = kind, .index = index, .name = name, .sign = sign, .node = node};
  vec_push(g->arena, &g->symbols, s);
  return id;
}

uint32_t expr_symbol_count(const ExprGraph *g) { return g->symbols.n - 1; }
const Symbol *expr_symbol(const ExprGraph *g, SymId id) { return &g->symbols.at[id]; }

Expr expr_def(ExprGraph *g, Name name, Expr body) {
  ExprOp op = expr_op(g, body);
  if (op == EX_NUM || op == EX_SYM || op == EX_DEF) return body;
  return make_named(g, EX_DEF, &body, 1, name);
}

/* The table entry of (name, body), made if absent. */
static Named *named_entry(ExprGraph *g, Name name, Expr body) {
  uint32_t hash = hash_parts(EX_DEF, &body, 1, name), slot = idtable_start(&g->named_table, hash), id;
  while (idtable_next(&g->named_table, hash, &slot, &id)) {
    Named *n = &g->named.at[id];
    if (n->name == name && n->body == body) return n;
  }
  vec_push(g->arena, &g->named, ((Named){.name = name, .body = body}));
  idtable_add(&g->named_table, hash, g->named.n - 1);
  return &g->named.at[g->named.n - 1];
}

Expr expr_def_unique(ExprGraph *g, Name name, Expr body) {
  ExprOp op = expr_op(g, body);
  if (op == EX_NUM || op == EX_SYM || op == EX_DEF) return body;
  Expr known = named_entry(g, name, body)->def;
  if (known) return known;
  uint32_t k = ++named_entry(g, name, 0)->count;
  Name own = k == 1 ? name : intern(g->names, arena_printf(g->arena, "%s_%u", name, k));
  Expr def = make_named(g, EX_DEF, &body, 1, own);
  named_entry(g, name, body)->def = def;
  return def;
}

/* --- inspection --- */

ExprOp expr_op(const ExprGraph *g, Expr e) { return (ExprOp)g->nodes.at[e].op; }
uint32_t expr_nargs(const ExprGraph *g, Expr e) { return g->nodes.at[e].nargs; }
Expr expr_arg(const ExprGraph *g, Expr e, uint32_t i) {
  MUST_BE_BELOW(i, expr_nargs(g, e));
  return g->args.at[g->nodes.at[e].payload + i];
}
Num expr_number(const ExprGraph *g, Expr e) { return g->numbers.at[g->nodes.at[e].payload]; }
SymId expr_sym_id(const ExprGraph *g, Expr e) { return g->nodes.at[e].payload; }
const Symbol *expr_sym_of(const ExprGraph *g, Expr e) { return &g->symbols.at[g->nodes.at[e].payload]; }
Name expr_def_name(const ExprGraph *g, Expr e) { return name_of(g, &g->nodes.at[e]); }
ExprSign expr_sign(const ExprGraph *g, Expr e) { return (ExprSign)g->nodes.at[e].sign; }
int expr_is_num(const ExprGraph *g, Expr e) { return g->nodes.at[e].op == EX_NUM; }
unsigned expr_kinds(const ExprGraph *g, Expr e) { return g->nodes.at[e].kinds; }
int expr_is_constant(const ExprGraph *g, Expr e) {
  return (expr_kinds(g, e) & ~(1u << SYM_PARAM | 1u << SYM_CONST)) == 0;
}
int expr_is_zero(const ExprGraph *g, Expr e) { return e == g->zero; }
int expr_is_nonzero(const ExprGraph *g, Expr e) {
  return sign_is_strict(expr_sign(g, e)) || (expr_is_num(g, e) && e != g->zero);
}
const char *expr_op_text(ExprOp op) { return op_texts[op]; }

int expr_is_bool(const ExprGraph *g, Expr e) {
  ExprOp op = expr_op(g, e);
  return op == EX_LT || op == EX_LE || op == EX_EQ || op == EX_NOT || op == EX_AND || op == EX_OR;
}

uint32_t expr_pairs(const ExprGraph *g, Expr e, ExprOp op) { return expr_op(g, e) == op ? expr_nargs(g, e) / 2 : 1; }

Expr expr_pair(const ExprGraph *g, Expr e, ExprOp op, uint32_t i, Num *number) {
  MUST_BE_BELOW(i, expr_pairs(g, e, op));
  int has = expr_op(g, e) == op;
  if (number) *number = has ? expr_number(g, expr_arg(g, e, 2 * i + 1)) : num_int(1);
  return has ? expr_arg(g, e, 2 * i) : e;
}

int expr_next_pair(const ExprGraph *g, Expr e, ExprOp op, ExprPair *x) {
  if (x->next == expr_pairs(g, e, op)) return 0;
  x->of = expr_pair(g, e, op, x->next++, &x->num);
  return 1;
}

/* --- signs --- */

static ExprSign flip(ExprSign s) {
  switch (s) {
    case SIGN_POSITIVE: return SIGN_NEGATIVE;
    case SIGN_NONNEGATIVE: return SIGN_NONPOSITIVE;
    case SIGN_NEGATIVE: return SIGN_POSITIVE;
    case SIGN_NONPOSITIVE: return SIGN_NONNEGATIVE;
    case SIGN_UNKNOWN: break;
  }
  return SIGN_UNKNOWN;
}

static ExprSign sum_sign(const ExprGraph *g, const Expr *args, uint32_t n) {
  int all_nonneg = 1, all_nonpos = 1, strict = 0;
  for (uint32_t i = 0; i < n; i += 2) {
    ExprSign s = expr_sign(g, args[i]);
    Num c = expr_number(g, args[i + 1]);
    if (!num_sign_is_sure(c)) return SIGN_UNKNOWN;
    if (num_sign(c) < 0) s = flip(s);
    all_nonneg &= sign_is_nonnegative(s);
    all_nonpos &= sign_is_nonpositive(s);
    strict |= sign_is_strict(s);
  }
  if (all_nonneg) return strict ? SIGN_POSITIVE : SIGN_NONNEGATIVE;
  if (all_nonpos) return strict ? SIGN_NEGATIVE : SIGN_NONPOSITIVE;
  return SIGN_UNKNOWN;
}

/* Sign of base^e: even powers are nonnegative; a power with an even denominator has a nonnegative base. */
static ExprSign factor_sign(ExprSign base, Num e) {
  if (base == SIGN_POSITIVE) return SIGN_POSITIVE;
  if (num_is_exact(e) && e.den % 2 == 1) {
    if (e.num % 2 == 0) return base == SIGN_NEGATIVE ? SIGN_POSITIVE : SIGN_NONNEGATIVE;
    return base;
  }
  return SIGN_NONNEGATIVE;
}

static ExprSign prod_sign(const ExprGraph *g, const Expr *args, uint32_t n) {
  int negative = 0, strict = 1;
  for (uint32_t i = 0; i < n; i += 2) {
    ExprSign s = factor_sign(expr_sign(g, args[i]), expr_number(g, args[i + 1]));
    if (s == SIGN_UNKNOWN) return SIGN_UNKNOWN;
    negative ^= sign_is_nonpositive(s);
    strict &= sign_is_strict(s);
  }
  ExprSign s = strict ? SIGN_POSITIVE : SIGN_NONNEGATIVE;
  return negative ? flip(s) : s;
}

ExprSign expr_infer_sign(const ExprGraph *g, ExprOp op, const Expr *args, uint32_t n) {
  switch (op) {
#define SIGN_OF_ARGUMENT expr_sign(g, args[0])
#define SIGN_CASE(OP, name, latex, symmetry, at_0, sign, ...) case EX_##OP: return SIGN_##sign;
    FUNCTIONS(SIGN_CASE)
    case EX_SUM: return sum_sign(g, args, n);
    case EX_PROD: return prod_sign(g, args, n);
    case EX_DEF: case EX_SIGN: return SIGN_OF_ARGUMENT;
    case EX_POW: return expr_sign(g, args[0]) == SIGN_POSITIVE ? SIGN_POSITIVE : SIGN_UNKNOWN;
    case EX_ABS: case EX_HYPOT: return SIGN_NONNEGATIVE;
    case EX_SELECT:
      return expr_sign(g, args[1]) == expr_sign(g, args[2]) ? expr_sign(g, args[1]) : SIGN_UNKNOWN;
    case EX_NUM:
    case EX_SYM:
    case EX_NEST:
    case EX_CELL:
    case EX_FLOOR:
    case EX_ATAN2:
    case EX_MIN:
    case EX_MAX:
    case EX_LT:
    case EX_LE:
    case EX_EQ:
    case EX_NOT:
    case EX_AND: case EX_OR: case EX_COUNT: break;
  }
  return SIGN_UNKNOWN;
}
