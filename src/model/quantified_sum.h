/* A sum over an index, or over pairs of two, while it is read (quantified_text.c) and evaluated (quantified_sum.c). */
#pragma once

#include "model/resolve_impl.h"

enum { REPRESENTATIVES = 2, COMPONENTS = 3, PASSES = REPRESENTATIVES + 1 };

/* Whole number that is affine in i and j. */
typedef struct {
  int64_t first, by_i, by_j;
} Affine;

/* Family e read at indices affine in i and j; rate: of its velocities. */
typedef struct {
  const Entity *e;
  int rate;
  Affine at[2];
} Read;

struct Quantified {
  AstId outer, inner; /* inner 0: a sum over i alone, which has one turn a row; inner = outer: i is a family's index */
  Name i, j;
  int64_t lo, hi;     /* of i */
  int64_t at, own[2]; /* of a family: the member in progress, and the range of its sum */
  Affine from, to;    /* of j, in i */
  LoopRange range;    /* row 0 is i = lo; turn j of row 0 is j - from */
  VEC(Read) reads;
  AstId first;
  /* [id - first] 1: an index stands for itself, as a symbol; else it is a number, inside of [] and ranges */
  unsigned char *counts;
  int has_lets;       /* definitions of families are opened */
  const AstNear *near; /* of the inner sum; NULL: over all j */
  NearTest test;
  const AstFar *far;   /* of the inner sum; NULL: every term counts by itself */
  Expr theta;
  int failed;          /* a mistake is reported */
  uint64_t turns;
  int sampled;        /* the self-check takes a sample of the turns */
  const char *why;    /* reason why there is no such form, and where: for a note */
  AstId where;
  int64_t pair[PASSES][2]; /* i and j; the last is i = j, evaluated for its mistakes alone */
  int pass, passes;
  Value body[PASSES], whole[PASSES];
  int beside;         /* the outer terms have more than the inner sum: they are written out, with `pairs` at the end */
  Expr pairs;
  SymId inside[COMPONENTS]; /* stand for the inner sum in the whole */
};

/* quantified_text.c: finds the inner sum, and all that the terms read; 0: the text has no such form. */
int quantified_text(Eval *ev, struct Quantified *q);

/* Whether the expression contains the name. */
int quantified_names(const Ast *ast, AstId id, Name name);

/* The last index from lo on up to which each `if` in the terms of a sum takes one branch, those of lets, too. */
int64_t quantified_same_branches(Eval *ev, AstId id, int64_t lo, int64_t hi);

/* The range of j, affine in i; what an expression reads, without indices as numbers. 0: q->why, at q->where. */
int quantified_range(Eval *ev, struct Quantified *q, AstId from, AstId to);
int quantified_reads(Eval *ev, struct Quantified *q, AstId id);

/* quantified_sum.c: whether the members that are read differ for this pair; the read that gave the symbol for the
 * first pair, and its component (NULL: none); the symbol of such a read; its element, in i and j; whether a symbol has
 * no index. */
int quantified_tells_apart(const struct Quantified *q, const int64_t *pair);
const Read *quantified_read_of(const struct Quantified *q, const Symbol *s, int64_t *part);
SymId quantified_symbol(const Model *m, const struct Quantified *q, const Read *r, int64_t part);
Affine quantified_element(const Read *r);
int quantified_is_plain(const Symbol *s);

/* far_form.c: the parts of a term, for the first pair, of a sum by a tree; NULL: it has no such form, which is
 * reported. */
const FarForm *quantified_far(Eval *ev, const struct Quantified *q, Expr term);

/* Whether row after row is the sum of one member of a family. family_sums.c: ends such a sum, of which *v is cell 0, or
 * has no value, with that of the member in progress. */
static inline int quantified_of_family(const struct Quantified *q) { return q->inner == q->outer; }
void family_sum_end(Eval *ev, const struct Quantified *q, Value *v);

/* quantified_sum.c: finds the representatives; starts the first. What stands at `near` or `by tree` in a sum; NULL. */
int quantified_find_pairs(struct Quantified *q, Arena *arena);
void quantified_start(Eval *ev, struct Quantified *q);
const AstNear *quantified_near(const Ast *ast, AstId sum);
const AstFar *quantified_far_sum(const Ast *ast, AstId sum);

/* quantified_sum.c: whether so many turns are too many to be written out; says that the sum is, and why, 0: no
 * expansion takes so many. */
int quantified_is_long(const Builder *b, uint64_t turns);
int quantified_write_out(const Eval *ev, const struct Quantified *q, uint64_t turns);

/* sum_diagonal.c: puts a condition around the terms of both representatives, if they have no derivative for i = j,
 * where their value is the number `same`; 0, or no number: leaves them. */
void quantified_guard_diagonal(const Eval *ev, const struct Quantified *q, Expr same, Expr *turned);

/* In rows and turns: i = lo + row, j = from(lo) + turn. */
Subscript quantified_turns(const struct Quantified *q, Affine x);
