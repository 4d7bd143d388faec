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

/* The node with these parts, new or found. The caller guarantees that it is canonical. */
Expr expr_make(ExprGraph *g, ExprOp op, const Expr *args, uint32_t nargs);

ExprSign expr_infer_sign(const ExprGraph *g, ExprOp op, const Expr *args, uint32_t nargs);

/* expr_topo without what only nodes of the map need. */
ExprList expr_topo_until(ExprGraph *g, const Expr *roots, uint32_t n, const ExprMap *leaves);

/* Sets m to 1 for the nodes of l (all that some roots need) which contain a wanted symbol. */
void expr_mark_containing(ExprGraph *g, ExprList l, int (*want)(const Symbol *s, const void *data), const void *data, ExprMap *m);

#endif
