/* Internals of the expression graph, shared by the files of src/sym that make or print nodes. */
#pragma once

#include "base/id_table.h"
#include "sym/expr.h"

typedef struct {
  uint8_t op;
  uint8_t sign : 4, has : 4; /* has: traits of the node and all below */
  uint16_t kinds;            /* kinds of the symbols below the node: bits 1 << SymKind */
  uint32_t nargs;
  uint32_t payload; /* index of the first argument in g->args, behind which a DEF has the index of its name in
                       def_names; NUM: index into numbers; SYM: SymId */
} Node;

/* Contribution to a node's adjoint in a reverse sweep; each node's contributions are a linked list in g->pool. */
typedef struct {
  Expr value;
  uint32_t next;
} Contribution;

/* Definition made for (name, body) by expr_def_unique. The entry with body 0 counts the definitions that asked for
 * the name. */
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
  VEC(Name) def_names;
  VEC(Symbol) symbols;
  IdTable table; /* of nodes other than symbols */
  ExprMap seen; /* scratch of expr_topo */
  ExprMap live; /* scratch of reverse sweeps */
  VEC(Contribution) pool;
  ExprMap work; /* scratch of passes that do not call each other: substitution, derivatives */
  Expr *found, *spare; /* scratch of expr_topo, used again */
  uint32_t found_cap, spare_n;
  VEC(Named) named;          /* definitions by requested name and body: see expr_def_unique */
  IdTable named_table;       /* of `named` */
  VEC(SumNest) nests;        /* number k at [k - 1] */
  Expr twin_of, twin;        /* the last nest that expr_twin_cell was asked for, and its answer */
  uint32_t twin_number;
  ExprMap share_kinds_at;    /* of a NEST: 1 + place of the kinds of its first share in share_kinds */
  VEC(uint16_t) share_kinds;
  Expr *by_arg;              /* [nby_arg] 0 between calls of expr_sum_partials */
  uint32_t nby_arg;
  VEC(SymId) index_names;    /* symbols with names such as r[i].x, for the printer */
  VEC(Expr) terms;           /* scratch of sums written out */
  int writes_sums_out;       /* one was */
  Expr zero, one, minus_one;
};

/* Pair under construction: a term and its coefficient, or a base and its exponent. */
typedef struct {
  Expr node;
  Num number;
} Pair;

typedef VEC(Pair) Pairs;

/* Capacity of the stack buffers in which most sums and products are built; longer ones move to the arena. */
enum { ROOM = 8 };
#define ROOM_FOR(room) {(room), 0, ROOM}

/* A product under construction: number times factors. */
typedef struct {
  Num c;
  Pairs p;
} Product;

/* Multiplies r by base^e. */
void expr_push_power(ExprGraph *g, Product *r, Expr base, Num e);

/* finite_quotients.c: applies sinh/cosh = tanh, exp(u)/exp(v) = exp(u - v) or exp(u)/(1 + exp(u)) = 1/(1 + exp(-u))
 * once to the factors of r. Returns 1 when r changed. */
int expr_rewrite_quotient(ExprGraph *g, Product *r);

/* cosh(u) of the sum 1 - tanh(u)^2 = 1/cosh(u)^2, which rounds to 0 where u > 19; otherwise 0. */
Expr expr_cosh_of_tanh(ExprGraph *g, Expr sum);

/* Index of the sum T in exp(u)*T or T/S that must be distributed, so that each exp(u) meets the sums with exp(u)
 * below it; r->p.n if there is none. */
uint32_t expr_sum_to_distribute(const ExprGraph *g, const Product *r);

/* The hash-consed node (op, args). The caller guarantees that it is canonical. */
Expr expr_make(ExprGraph *g, ExprOp op, const Expr *args, uint32_t nargs);

ExprSign expr_infer_sign(const ExprGraph *g, ExprOp op, const Expr *args, uint32_t nargs);

ExprMap expr_map_by_id(Arena *a); /* for maps of the graph itself, which are used again and again */

/* Node e with its arguments mapped through m; an argument that is not in m stays. */
Name expr_name_with_suffix(ExprGraph *g, Name name, const char *suffix);
Expr expr_with_mapped_args(ExprGraph *g, const ExprMap *m, Expr e);

/* Sets m to 1 for those nodes of l (a result of expr_topo) that contain a symbol for which want() is true. */
void expr_mark_containing(ExprGraph *g, ExprList l, int (*want)(const Symbol *s, const void *data), const void *data,
                          ExprMap *m);

/* f(-x) = -f(x), f(x), or neither. */
typedef enum { NEITHER, ODD, EVEN } Symmetry;
Symmetry expr_symmetry(ExprOp op);
