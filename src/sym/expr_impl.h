/* The inside of the expression graph, shared by the files of src/sym that make or print nodes. */
#ifndef LAGC_EXPR_IMPL_H
#define LAGC_EXPR_IMPL_H

#include "sym/expr.h"

typedef struct {
  uint8_t op, sign;
  uint16_t kinds;   /* of the symbols below it: bits 1 << SymKind */
  uint32_t nargs;
  uint32_t payload; /* first argument in g->args; NUM: index into numbers; SYM: SymId; DEF: see name */
  Name name;        /* DEF only */
} Node;

/* Contributions to a node's adjoint in a reverse sweep: a list in a shared array. */
typedef struct {
  Expr value;
  uint32_t next;
} Contribution;

/* A definition by the name it was asked for. body 0: counts how often the name was given away. */
typedef struct {
  Name name;
  Expr body, def;
  uint32_t count;
} Named;

struct ExprGraph {
  Arena *arena;
  Interner *names;
  VEC(Node) nodes; /* [0] unused */
  VEC(Expr) args;
  VEC(Num) numbers;
  VEC(Symbol) symbols;
  Expr *table; /* hash of nodes, open addressing */
  uint32_t table_cap;
  ExprMap seen; /* scratch of expr_topo */
  ExprMap live; /* scratch of reverse sweeps */
  VEC(Contribution) pool;
  ExprMap work; /* scratch of passes that do not call each other: substitution, derivatives */
  Expr *found, *spare; /* scratch of expr_topo, used again */
  uint32_t found_cap, spare_n;
  VEC(Named) named;          /* definitions by name asked for and body: see expr_def_fresh */
  uint32_t *named_table, named_cap;
  Expr zero, one, minus_one;
};

/* A list of (node, number) pairs under construction: terms with coefficients, bases with exponents. */
typedef struct {
  Expr node;
  Num number;
} Pair;

typedef VEC(Pair) Pairs;

/* Room for the pairs of most sums and products, in the frame of the function that builds one. */
enum { ROOM = 8 };
#define ROOM_FOR(room) {(room), 0, ROOM}

/* A product under construction: number times factors. */
typedef struct {
  Num c;
  Pairs p;
} Product;

/* Multiplies r by base^e. */
void expr_push_power(ExprGraph *g, Product *r, Expr base, Num e);

/* quotient.c: one use of sinh/cosh = tanh, exp(u)/exp(v) = exp(u - v) or exp(u)/(1 + exp(u)) = 1/(1 + exp(-u)) among
 * the factors of r. Returns 1 when something changed. */
int expr_use_quotient(ExprGraph *g, Product *r);

/* cosh(u) of the sum 1 - tanh(u)^2 = 1/cosh(u)^2, which rounds to 0 where u > 19; otherwise 0. */
Expr expr_cosh_of_tanh(ExprGraph *g, Expr sum);

/* The factor T of exp(u)*T or T/S that is to be distributed, so that each exp(u) meets the sums with exp(u) that it is divided by;
 * r->p.n: none. */
uint32_t expr_mixed_sum(const ExprGraph *g, const Product *r);

/* The node with these parts, new or found. The caller guarantees that it is canonical. */
Expr expr_make(ExprGraph *g, ExprOp op, const Expr *args, uint32_t nargs);

ExprSign expr_infer_sign(const ExprGraph *g, ExprOp op, const Expr *args, uint32_t nargs);

/* expr_topo without what only nodes of the map need. */
ExprList expr_topo_until(ExprGraph *g, const Expr *roots, uint32_t n, const ExprMap *leaves);

/* Sets m to 1 for the nodes of l (all that some roots need) which contain a wanted symbol. */
void expr_mark_containing(ExprGraph *g, ExprList l, int (*want)(const Symbol *s, const void *data), const void *data, ExprMap *m);

#endif
