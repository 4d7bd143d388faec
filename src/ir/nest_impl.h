/* Shared by nest.c (search, and the program with nests), nest_partition.c (hubs and pieces), nest_canonical_form.c
 * (canonical form of a piece), nest_affine.c (indices affine in two counters) and nest_body.c (the body of a nest).
 * */
#pragma once

#include "ir/prog.h"

/* A value that a piece adds to a hub or (minus) subtracts from it. */
typedef struct {
  Slot value, hub;
  int minus;
} HubTerm;

typedef VEC(HubTerm) HubTerms;

/* HUB_COMMON: a sum that shares terms with another; becomes HUB_SUM, or no hub, when pieces are known. */
typedef enum { HUB_NO, HUB_SUM, HUB_SHARED, HUB_STORED, HUB_COMMON } HubKind;

typedef struct {
  Slot *slots;  /* in order */
  uint32_t n;
  int apart;    /* may be a turn of a loop: has only operations that loops allow, and only hubs use it */
  uint32_t waits; /* number of uses of hubs that are not complete yet */
  HubTerms gives;
} Piece;

/* A user of a hub: a piece, from 1, or a sum; before: the previous entry in the hub's list, from 1. */
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
  unsigned char *joined; /* by slot: a sum inside its only user, a sum; likewise products */
  unsigned char *hub;    /* by slot: HubKind */
  Slot *sum;             /* by slot: the hub that it is a partial sum of, or is; or 0 */
  /* by slot: signature of its computation, without array indices; of a partial sum, of its terms and of their
   * negatives */
  uint64_t *sig, *flip;
  /* by slot: lowest array element read, and sum of all indices read: order of equal signatures */
  uint64_t *low, *mass;
  uint32_t *piece;       /* by slot: number of its piece, from 1; 0: none */
  VEC(Piece) pieces;
  VEC(Slot) hubs;        /* in the order in which stores need them */
  uint32_t *class_of;    /* by slot of hubs: sums of one class are neighbours in ARR_CELL, */
  uint32_t *number;      /* with numbers from 0 */
  uint32_t classes;
  uint32_t *terms_of;    /* by slot of hubs: number of terms, */
  uint32_t *waits;       /* and number of terms not known yet */
  VEC(Waiting) waiting;  /* lists of users of hubs */
  uint32_t *last_waiting; /* by slot of hubs: last entry of its list, from 1 */
  unsigned char *celled; /* by slot of hubs: 1: nests add some of its terms; 2: all */
  HubTerms *open, *terms;  /* scratch */
} Partition;


/* Additional hubs: sums that share terms, stored values. */
enum { CUT_COMMON_TERMS = 1, CUT_STORES = 2 };

/* Partitions the program into hubs and pieces, in `a`; `celled` is left 0. ends: CUT_... bits. */
Partition nest_partition(Arena *a, const Prog *p, unsigned ends);

/* Appends the terms of a sum, through joined partial sums; hub is the sum. */
void nest_terms(const Partition *c, Slot sum, HubTerms *terms);

/* An operand of a node with its sort keys, whose order is the same in all pieces of a group. */
typedef struct {
  Slot slot;
  int minus;
  uint64_t sig, low, mass;
} Child;

typedef VEC(Child) Children;

typedef enum { NODE_LOAD, NODE_CELL, NODE_OUTER, NODE_CONST, NODE_OP } NodeKind;

typedef struct {
  uint32_t id;
  int minus;
} Link;

typedef struct {
  NodeKind kind;
  Slot slot;        /* in the first piece of the group */
  uint32_t column;  /* of loads and cells: position in CanonicalForm.columns */
  uint32_t first, n; /* its operands: links first ... first + n - 1 */
} Node;

/* The canonical form of a piece, the same for all pieces of a group except for the indices: nodes after their
 * operands, then the shares. */
typedef struct {
  VEC(Node) nodes;
  VEC(Link) links;
  VEC(Link) gives;           /* shares for hubs: their nodes; their indices are the last entries of `columns` */
  VEC(uint32_t) words;       /* serialised form, for comparison */
  VEC(int64_t) columns;      /* array indices of one piece */
  VEC(uint32_t) array;       /* by column: the array, or ARR_COUNT + class of the hub */
  Children children, given;  /* scratch */
  VEC(Slot) open;
} CanonicalForm;

/* Node number of a slot in the piece `stamp`. */
typedef struct {
  uint32_t stamp, id;
} Local;
/* Writes the piece to `tape`, which is reused. stamp: number of the piece, from 1; local: by slot, zeroed before the
 * first piece. */
void nest_canonical_form(const Partition *c, Piece *piece, Local *local, uint32_t stamp, CanonicalForm *tape);

/* A nest of loops over pieces of a group. */
typedef struct {
  uint32_t rows;
  int64_t skew, turns, more; /* as in Nest */
  const IrSubscript *at;         /* by column */
  const uint32_t *pieces;    /* [count] their numbers */
  uint32_t count;
} Fit;

typedef VEC(Fit) Fits;

/* Indices of the n pieces of a group: columns[piece*width + k] is an index into array[k]. */
typedef struct {
  Arena *a;
  const int64_t *columns;
  const uint32_t *array;
  uint32_t width, n;
  uint32_t *order;             /* [n] numbers of the pieces */
  const unsigned char *varies; /* [width] by column: differs between pieces; set by nest_affine */
} Indices;

/* Sorts `order`, and appends nests with affine indices; pieces outside of these stay as they are. */
void nest_affine(Indices all, Fits *fits);

/* The body of a nest; outer[nouter]: slots of the program around it that the body reads. */
const Prog *nest_body(const Partition *c, const CanonicalForm *t, const Fit *f, const Slot **outer, uint32_t *nouter);
