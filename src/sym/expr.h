/* The expression graph: hash-consed, canonical at construction.
 *
 * A node is an id (Expr); arguments have lower ids than their node, so every pass is a loop over ids, and equal
 * expressions have equal ids. Guaranteed by construction:
 *   - sums and products are flat; terms and factors are sorted by id, distinct, with collected
 *     rational coefficients and exponents: x - x is 0, x*x is x^2, x/x is 1;
 *   - a product holds no number except roots such as 2^(1/2): 3*x is a SUM of one pair (x, 3);
 *   - a sum raised to an integer power is primitive: its coefficients have no common factor, and
 *     the first is positive;
 *   - sin^2 u + cos^2 u with equal cofactors is 1, and 1 - sin^2 u is cos^2 u; likewise cosh^2 - sinh^2;
 *   - quotients of hyperbolic functions and exponentials have no infinity above and below: sinh u/cosh u is tanh u,
 *     exp(u)/exp(v)
 *     is exp(u - v), exp(u)/(1 + exp(u)) is 1/(1 + exp(-u));
 *   - odd and even functions take arguments whose first coefficient is positive;
 *   - nothing is distributed except numbers over sums, and sums in which such a quotient would hide; nothing crosses
 *     a DEF.
 * The order of ids is the order of creation; a caller that wants the same text everywhere names
 * intermediate results instead of nesting calls (C fixes no order of argument evaluation).
 *
 * Ownership: all in the arena given to expr_graph. Errors: none; running out of memory jumps to the arena's handler. */
#pragma once

#include "base/intern.h"
#include "base/loop_nest.h"
#include "base/num.h"
#include "base/vec.h"
#include "numeric/functions.def"

typedef uint32_t Expr; /* 0: none */

#define X(NAME, arity, text) EX_##NAME,
typedef enum {
#include "sym/ops.def"
  EX_COUNT
} ExprOp;
#undef X

/* Labels of a switch: all functions of functions.def. */
#define EX_CASE(OP, ...) case EX_##OP:
#define EX_FUNCTION_CASES FUNCTIONS(EX_CASE)

typedef enum {
  SYM_TIME,
  SYM_COORD, /* q */
  SYM_VEL,   /* q' */
  SYM_ACC,   /* q'' */
  SYM_STATE, /* z */
  SYM_RATE,  /* z' */
  SYM_PARAM,
  SYM_INPUT,
  SYM_CONST,  /* pi */
  SYM_MULTIPLIER, /* Lagrange multiplier of a constraint */
  SYM_LOCAL  /* the group parameter of a symmetry; scratch symbols of a pass */
} SymKind;

/* Sign of a value, as declared or inferred. */
typedef enum { SIGN_UNKNOWN, SIGN_POSITIVE, SIGN_NONNEGATIVE, SIGN_NEGATIVE, SIGN_NONPOSITIVE } ExprSign;

static inline int sign_is_nonnegative(ExprSign s) { return s == SIGN_POSITIVE || s == SIGN_NONNEGATIVE; }
static inline int sign_is_nonpositive(ExprSign s) { return s == SIGN_NEGATIVE || s == SIGN_NONPOSITIVE; }
static inline int sign_is_strict(ExprSign s) { return s == SIGN_POSITIVE || s == SIGN_NEGATIVE; }

typedef uint32_t SymId;

typedef struct {
  SymKind kind;
  uint32_t index; /* index within its kind */
  Name name;      /* as the user writes it: th, th', th'' */
  ExprSign sign;
  Expr node;
} Symbol;

typedef struct ExprGraph ExprGraph;

/* --- quantified sums: sum_nest.h --- */
/* A symbol of the body, and the argument that it stands for in each turn. */
typedef struct {
  SymId symbol;
  Subscript at;
  Name stem, tail;    /* of r[i].x: "r" and ".x"; NULL: a name without index */
  uint32_t nindices;
  Subscript index[2]; /* values of the indices */
} NestRead;

/* A value of the body, and the sum to which each turn adds it. */
typedef struct {
  Expr value;
  Subscript at;
} NestShare;

/* A turn counts only where `test` holds: place i is nearer to place j than `cut`, in the symbols of the body. */
typedef struct {
  Expr test, cut, at_i[3], at_j[3], side[3]; /* by component; side 0: the space is open */
  uint32_t n;
} NearTest;

/* The sum of factor*c_i*c_j/sqrt(d^2 + soft) over all pairs of `members` bodies; the first is body i of row `first`. In
 * the symbols of the body, c_i as `charge`. */
typedef struct {
  Expr term, factor, charge, soft, theta, at_i[3], at_j[3]; /* theta: opening angle of the tree */
  uint32_t n;                                               /* components of d */
  int64_t first, members;
  uint32_t begin, end; /* place in the text */
} FarForm;

typedef struct {
  LoopRange range;
  const FarForm *far;   /* NULL: of other sums; else this one, or its derivatives by all places */
  const NearTest *near; /* NULL: all turns count; else values contain the test, too */
  const NestRead *reads;
  const NestShare *shares;
  uint32_t nreads, nshares, nargs, ncells;
  int sampled;       /* the self-check takes a sample of the turns: there are many more than arguments */
  Name i, j;         /* indices in the text: i is i0 in row 0, j is j0 in turn 0 */
  int64_t i0, j0;
  int64_t row, turn; /* the turn whose arguments are the body's symbols themselves */
  const Expr *slopes; /* [share*nreads + read] derivatives of the shares; NULL: not made yet */
  uint32_t gradient; /* nest of the partial derivatives; 0: not made yet */
} SumNest;

ExprGraph *expr_graph(Arena *a, Interner *names);
Arena *expr_arena(const ExprGraph *g);
uint32_t expr_count(const ExprGraph *g); /* ids are 1 .. count */
/* Whether quantified sums have been written out, but for proofs; expr_note_sums_out: now they are. */
int expr_writes_sums_out(const ExprGraph *g);
void expr_note_sums_out(ExprGraph *g);

/* --- leaves --- */
Expr expr_num(ExprGraph *g, Num n);
Expr expr_int(ExprGraph *g, int64_t n);
/* A new symbol; its node is expr_symbol(g, id)->node. */
SymId expr_declare(ExprGraph *g, SymKind kind, uint32_t index, Name name, ExprSign sign);
uint32_t expr_symbol_count(const ExprGraph *g);
const Symbol *expr_symbol(const ExprGraph *g, SymId id);
/* Definition with a unique name: name, name_2, name_3 ... in order of request; equal (name, body) give one
 * definition. */
Expr expr_def_unique(ExprGraph *g, Name name, Expr body);
/* Definition `name = body`; leaves (numbers, symbols, definitions) are returned unchanged. */
Expr expr_def(ExprGraph *g, Name name, Expr body);

/* --- construction; all return canonical nodes --- */
Expr expr_add(ExprGraph *g, Expr a, Expr b);
Expr expr_sub(ExprGraph *g, Expr a, Expr b);
Expr expr_neg(ExprGraph *g, Expr a);
Expr expr_mul(ExprGraph *g, Expr a, Expr b);
Expr expr_div(ExprGraph *g, Expr a, Expr b);
Expr expr_scale(ExprGraph *g, Num c, Expr a);
Expr expr_add_n(ExprGraph *g, const Expr *terms, uint32_t n);
Expr expr_mul_n(ExprGraph *g, const Expr *factors, uint32_t n);
Expr expr_pow_num(ExprGraph *g, Expr base, Num exponent);
Expr expr_pow(ExprGraph *g, Expr base, Expr exponent);
Expr expr_sqrt(ExprGraph *g, Expr a);
Expr expr_fn(ExprGraph *g, ExprOp op, Expr a);           /* SIN .. SIGN, NOT */
Expr expr_fn2(ExprGraph *g, ExprOp op, Expr a, Expr b);  /* ATAN2 .. OR */
Expr expr_select(ExprGraph *g, Expr condition, Expr a, Expr b);

/* Node with e's operation and new arguments, for passes that rewrite bottom-up. args has expr_nargs(g, e) elements
 * in the order of expr_arg. */
Expr expr_rebuild(ExprGraph *g, Expr e, const Expr *args);

/* --- inspection --- */
ExprOp expr_op(const ExprGraph *g, Expr e);
uint32_t expr_nargs(const ExprGraph *g, Expr e);
Expr expr_arg(const ExprGraph *g, Expr e, uint32_t i); /* SUM, PROD: term or base at 2i, number at 2i+1 */
Num expr_number(const ExprGraph *g, Expr e);           /* of a NUM */
const Symbol *expr_sym_of(const ExprGraph *g, Expr e); /* of a SYM */
SymId expr_sym_id(const ExprGraph *g, Expr e);         /* of a SYM */
Name expr_def_name(const ExprGraph *g, Expr e);        /* of a DEF; its body is argument 0 */
ExprSign expr_sign(const ExprGraph *g, Expr e);
int expr_is_nonzero(const ExprGraph *g, Expr e); /* a number or an expression of strict sign that is not 0 */
int expr_is_num(const ExprGraph *g, Expr e);
unsigned expr_kinds(const ExprGraph *g, Expr e); /* kinds of the symbols on which e depends, as bits 1 << SymKind */

/* Traits of a node and all below: an operation that overflows where its argument is moderate; a power that may be
 * negative. */
enum { HAS_GROWTH = 1, HAS_QUOTIENT = 2 };
unsigned expr_traits(const ExprGraph *g, Expr e);
int expr_is_constant(const ExprGraph *g, Expr e); /* made of numbers, parameters and constants alone */
int expr_is_zero(const ExprGraph *g, Expr e);
int expr_is_bool(const ExprGraph *g, Expr e); /* a comparison or logical operation */
const char *expr_op_text(ExprOp op);

/* Pairs (term, coefficient) of a SUM, or (base, exponent) of a PROD; any other node counts as the single pair (node,
 * 1). */
uint32_t expr_pairs(const ExprGraph *g, Expr e, ExprOp op);
Expr expr_pair(const ExprGraph *g, Expr e, ExprOp op, uint32_t i, Num *number); /* number NULL: not wanted */

/* A walk over them: for (ExprPair x = {0}; expr_next_pair(g, e, op, &x);) */
typedef struct {
  Expr of;
  Num num;
  uint32_t next;
} ExprPair;
int expr_next_pair(const ExprGraph *g, Expr e, ExprOp op, ExprPair *x);

/* --- sets of nodes --- */
typedef struct {
  const Expr *at;
  uint32_t n;
} ExprList;

/* All nodes reachable from the roots, ascending: arguments before their nodes. Zero roots are skipped. */
ExprList expr_topo(ExprGraph *g, const Expr *roots, uint32_t n);

/* expr_topo where that is at most `most` nodes; else some of them, more than `most`. */
ExprList expr_topo_few(ExprGraph *g, const Expr *roots, uint32_t n, uint32_t most);

/* Gives up a list, whose memory the next one may have. */
void expr_list_free(ExprGraph *g, ExprList l);

/* expr_topo without the arguments of quantified sums. */
ExprList expr_topo_to_sums(ExprGraph *g, const Expr *roots, uint32_t n);

/* expr_topo_to_sums that stops at definitions: their bodies are left out. */
ExprList expr_topo_shallow(ExprGraph *g, const Expr *roots, uint32_t n);

/* Whether e contains a symbol for which want() is true; bodies of definitions count. */
int expr_contains(ExprGraph *g, Expr e, int (*want)(const Symbol *s, const void *data), const void *data);
int expr_contains_sym(ExprGraph *g, Expr e, SymId sym);

/* Hash map from node to number, emptied in O(1) by expr_map_clear. Its memory grows with its entries, not with the
 * graph: a model may make one for each of its thousands of equations. */
typedef struct {
  Expr key;
  uint32_t value, stamp;
} ExprMapEntry;

typedef struct {
  Arena *arena;
  union {
    ExprMapEntry *at; /* hash table */
    uint64_t *of;     /* [e] stamp and value: memory grows with the graph */
  };
  uint32_t cap, shift, n, epoch;
  int by_id;
} ExprMap;
ExprMap expr_map(Arena *a);
void expr_map_clear(ExprMap *m);
void expr_map_free(ExprMap *m); /* gives up its memory; it is empty */
void expr_map_set(ExprMap *m, Expr e, uint32_t value);
uint32_t expr_map_get(const ExprMap *m, Expr e); /* 0 when not set */

/* expr_topo that stops at the nodes of the map `leaves` (NULL: none). */
ExprList expr_topo_until(ExprGraph *g, const Expr *roots, uint32_t n, const ExprMap *leaves);

/* e with symbols replaced: symbol s becomes with[s] where that is not 0 (n entries).
 * Definitions whose body changes are rebuilt under their name followed by suffix (may be ""). */
Expr expr_substitute(ExprGraph *g, Expr e, const Expr *with, uint32_t n, const char *suffix);

/* e with n symbols replaced: syms[i] becomes with[i]. */
Expr expr_replace(ExprGraph *g, Expr e, const SymId *syms, const Expr *with, uint32_t n);

/* The same for the nodes of a map, to which it adds rewritten ones. */
Expr expr_replace_by(ExprGraph *g, Expr e, ExprMap *m);

/* out[i] = roots[i] with each nodes[k] replaced by with[k], all roots in one pass. */
void expr_replace_nodes(ExprGraph *g, const Expr *roots, uint32_t n, const Expr *nodes, const Expr *with,
                        uint32_t nnodes, Expr *out);

/* e with every definition replaced by its body. */
Expr expr_expand_defs(ExprGraph *g, Expr e);

/* Number of nodes of e written out as a tree, definitions by name; *distinct: its number of distinct nodes. */
double expr_tree_size(ExprGraph *g, Expr e, uint32_t *distinct);

/* Operation count of the roots, every node computed once; a transcendental function counts 20. */
uint32_t expr_ops(ExprGraph *g, const Expr *roots, uint32_t n);

/* Operation count of one root, its definitions already computed. */
uint32_t expr_ops_shallow(ExprGraph *g, Expr e);
