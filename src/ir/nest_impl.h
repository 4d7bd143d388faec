/* Shared by nest.c (the program in its new form), nest_cut.c (hubs and pieces), nest_tape.c (which pieces compute the same),
 * nest_fit.c (indices as loops), nest_scatter.c (indices as tables) and nest_body.c (what a turn computes). */
#ifndef LAGC_NEST_IMPL_H
#define LAGC_NEST_IMPL_H

#include "ir/nest.h"

/* A value that a piece adds to a hub, or takes from it. */
typedef struct {
  Slot value, hub;
  int minus;
} Share;

typedef VEC(Share) Shares;

/* HUB_COMMON: a sum with terms in common with others, while pieces are found; a HUB_SUM then. */
typedef enum { HUB_NO, HUB_SUM, HUB_SHARED, HUB_STORED, HUB_COMMON } HubKind;

typedef struct {
  Slot *slots;  /* in order */
  uint32_t n;
  int apart;    /* may be a turn of a loop: computes what a loop can, and is used by hubs alone */
  uint32_t waits; /* for so many shares of hubs to be there */
  Shares gives;
} Piece;

/* A piece, from 1, or a sum that needs a hub; the one before in the hub's list, from 1. */
typedef struct {
  uint32_t piece;
  Slot sum;
  uint32_t before;
} Waiting;

/* A program as pieces and hubs. */
typedef struct {
  const Prog *p;
  Arena *a;
  const uint32_t *uses;
  unsigned char *joined; /* by slot: a part of the sum or product that is its only user */
  unsigned char *hub;    /* by slot: HubKind */
  Slot *sum;             /* by slot: the long sum that it is, or is joined to; or 0 */
  uint64_t *sig, *flip;  /* by slot: what it computes, but for elements of arrays; of a part of a sum, the terms, and their negatives */
  uint64_t *low, *mass;  /* by slot: the lowest of the elements that it reads, and all of them added up: to order what is alike */
  uint32_t *piece;       /* by slot: from 1; 0: in none */
  VEC(Piece) pieces;
  VEC(Slot) hubs;        /* in the order in which stores need them */
  uint32_t *class_of;    /* by slot of hubs: hubs of one class are numbered side by side, */
  uint32_t *number;      /* from 0 */
  uint32_t *store;       /* by slot of hubs: the first store that needs it */
  uint32_t *leaves;      /* by slot of hubs: the piece, from 1, of its first term that is a leaf, others follow; 0: they are in no pieces */
  uint32_t classes;
  uint32_t *terms_of;    /* by slot of hubs: how many terms there are, */
  uint32_t *waits;       /* and how many of pieces and hubs are still to come */
  VEC(Waiting) waiting;  /* lists, */
  uint32_t *last_waiting; /* by slot of hubs */
  unsigned char *celled; /* by slot of hubs: 1: nests add to it; 2: and nothing else */
  Shares *open, *terms;  /* scratch */
} Cut;

int nest_is_sum(IrOp op);

/* Where pieces end, besides long sums and what many use: at sums with terms in common, at what is stored, at sums of elements of arrays. */
enum { CUT_COMMON_TERMS = 1, CUT_STORES = 2, CUT_LEAVES = 4 };

/* Everything but celled. ends: of these bits. */
Cut nest_cut(const Prog *p, unsigned ends);

/* Whether a term of a sum is an element of an array, which may be a piece by itself. */
int nest_is_leaf(const Cut *c, Slot term);

/* The terms of a sum, through the parts that are joined to it; hub is the sum. */
void nest_terms(const Cut *c, Slot sum, Shares *terms);

/* A child of a node, in the order that is the same in all pieces of a group. */
typedef struct {
  Slot slot;
  int minus;
  uint64_t sig, low, mass;
} Child;

typedef VEC(Child) Children;

/* What a node is computed from: terms of a sum, factors of a product (in canonical order), or operands. */
void nest_children(const Cut *c, Slot s, Children *children);

typedef enum { NODE_LOAD, NODE_CELL, NODE_OUTER, NODE_CONST, NODE_OP } NodeKind;

typedef struct {
  uint32_t id;
  int minus;
} Link;

typedef struct {
  NodeKind kind;
  Slot slot;        /* in the first piece of the group */
  uint32_t column;  /* of loads and cells: which index */
  uint32_t first, n; /* of the links: what it is computed from */
} Node;

/* What the pieces of a group compute: nodes after what they are computed from, and what is given to hubs. */
typedef struct {
  VEC(Node) nodes;
  VEC(Link) links;
  VEC(Link) gives;           /* by give: the node; its column is `columns` less their number, plus its place */
  VEC(uint32_t) words;       /* all this, for comparison */
  VEC(int64_t) columns;      /* indices of one piece */
  VEC(uint32_t) class_of;    /* by column: of cells, from 1; 0: of an array */
  VEC(uint32_t) array;       /* by column: the array, or past them the class */
  Children children, given;  /* scratch */
  VEC(Slot) open;
} Tape;

/* Fills `tape`, which may have been used before. local: by slot, zeroed once, of which `stamp` was not used yet. */
typedef struct {
  uint32_t stamp, id;
} Local;
void nest_tape(const Cut *c, Piece *piece, Local *local, uint32_t stamp, Tape *tape);

/* Loops over the pieces of a group. */
typedef struct {
  uint32_t rows;
  int64_t skew, turns, more; /* as in Nest */
  const uint32_t *begin;
  const IrPlace *at;         /* by column */
  const uint32_t *pieces;    /* [count] their numbers */
  uint32_t count;
} Fit;

typedef VEC(Fit) Fits;

/* Indices of pieces: columns[piece*width + k] goes into array[k]. size: how many values a piece computes. */
typedef struct {
  Arena *a;
  const int64_t *columns;
  const uint32_t *array;
  uint32_t width, size;
} Indices;

/* Sorts `order`, which holds the numbers of n pieces, and appends loops of enough turns; what they leave goes by tables where
 * that is shorter than its text. */
void nest_fit(const Indices *x, uint32_t *order, uint32_t n, Fits *fits);

/* The greatest common divisor; of 0 and b, |b|. */
int64_t nest_gcd(int64_t a, int64_t b);

/* One loop over n pieces, or a loop over rows of them, that take their indices from tables. */
Fit nest_scatter(const Indices *x, const uint32_t *pieces, uint32_t n);

/* The program of one turn. */
const Prog *nest_body(const Cut *c, const Tape *t, const Fit *f, const Slot **outer, uint32_t *nouter);

#endif
