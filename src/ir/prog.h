/* Prog: what one emitted function computes, as straight-line code in single assignment, but for nests of loops that add up sums.
 *
 * An instruction's operands have lower numbers; every value is computed once. A Prog knows names
 * for its values and carries its own texts, so that nothing after it needs the model. */
#ifndef LAGC_PROG_H
#define LAGC_PROG_H

#include "base/intern.h"
#include "base/num.h"
#include "base/spline.h"
#include "base/vec.h"

typedef uint32_t Slot; /* index of an instruction; 0: none (a structural zero) */
#define NOT_A_SLOT UINT32_MAX

typedef enum {
  IR_CONST,  /* number */
  IR_PI,
  IR_LOAD,   /* array, index, name */
  IR_ADD,
  IR_SUB,
  IR_MUL,
  IR_DIV,
  IR_NEG,
  IR_SQRT,
  IR_FN1,    /* text: the C library's name */
  IR_FN2,
  IR_MIN,
  IR_MAX,
  IR_SIGN,
  IR_LT,     /* conditions; they feed only conditions and IR_SELECT */
  IR_LE,
  IR_EQ,
  IR_NOT,
  IR_AND,
  IR_OR,
  IR_SELECT, /* a ? b : c */
  IR_PIVOT,  /* fails unless a > 0 (index 1), or a != 0 (index 0) */
  IR_SOLVE,  /* solves block `index` of prog->solves, with pivoting; fails when singular */
  IR_SOLVED, /* component `index` of the solution of solve a */
  IR_INVERT, /* the inverse of block `index` of prog->solves, with pivoting, to where that says: see Solve */
  IR_NEST,   /* runs nest `index` of prog->nests; a: the nest that has run before it, or 0 */
  IR_TABLE,  /* the curve of table `index` of prog->tables at a */
  IR_TITLE   /* text: a comment line that heads what follows */
} IrOp;

/* The arrays that a function reads; accelerations only in the linearisation, what A d must be (g) only where a state is corrected. The second line is of Taylor coefficients
 * (ir/series.h): whether an input is free of a constant, coefficients k, sums over those below k, what order 0 leaves for all
 * others; k, 1/k and T/(k + 1) are no arrays. The third line is of nests: sums, whose loads have the nest as operand a; what a body takes
 * from the code around it. */
typedef enum {
  ARR_T, ARR_Q, ARR_V, ARR_Z, ARR_P, ARR_U, ARR_A, ARR_G,
  ARR_FREE, ARR_COEF, ARR_SUMS, ARR_STEP, ARR_ORDER, ARR_PER_ORDER, ARR_UP,
  ARR_CELL, ARR_OUTER, ARR_COUNT
} IrArray;

/* Whether an array is a number, not to be indexed. */
int ir_is_scalar(IrArray array);

typedef struct {
  IrOp op;
  Slot a, b, c;
  Num number;
  uint32_t index;
  IrArray array;
  Name name;        /* of a load; or the name that the user, or the theory, gives the value; or NULL */
  const char *text; /* a function's name; a title */
} Ins;

/* out[index] = slot; the comment says what it is. */
typedef struct {
  uint32_t array; /* number of the output array, in the order of the function's declaration */
  uint32_t index;
  Slot slot;      /* 0: zero */
  const char *comment;
} Store;

/* A dense block that is solved by a loop: matrix[n*n] row-major (0: zero) and right-hand side. place: where it stands in the
 * work space. matrix is NULL where the one at that place was factored before, by another function. With m constraints A x = g on
 * the solution, M x - A^T l = f: behind M stands A[m*n], behind f g; behind x l. coarse: constraints that are nearly dependent count as
 * dependent; see lag_kkt.h. Without constraints, entries more than `band` beside the diagonal are zero, and a definite M is eliminated without
 * pivoting, from its upper triangle. inverse: where the inverse stands among the parameters, not 0: then there is no matrix, and a solution is
 * a product. filled: with constraints, the elements of the matrix that are not zero. Of IR_INVERT: where that writes [matrix | n | n | inverse |
 * 1 where there is one, and 0]; no right-hand side. */
typedef struct {
  uint32_t n, m, place, band, inverse;
  int coarse, definite;
  const Slot *matrix, *rhs;
  const uint32_t *filled; /* [nfilled] */
  uint32_t nfilled;
} Solve;

/* Elements of matrix and rhs. */
static inline uint32_t solve_elements(const Solve *k) { return k->matrix ? (k->n + k->m) * k->n : 0; }
static inline uint32_t solve_unknowns(const Solve *k) { return k->rhs ? k->n + k->m : 0; }

/* Where, from its place on, IR_INVERT leaves the inverse, and whether there is one. */
static inline uint32_t solve_inverse(const Solve *k) { return k->n * k->n + 2 * k->n; }
static inline uint32_t solve_is_regular(const Solve *k) { return 2 * k->n * k->n + 2 * k->n; }

/* Each is solved by a function of its own. */
typedef enum { SOLVE_PIVOTING, SOLVE_CONSTRAINED, SOLVE_DEFINITE, SOLVE_INVERSE } SolveKind;
static inline SolveKind solve_kind(const Solve *k) {
  return k->inverse ? SOLVE_INVERSE : k->m ? SOLVE_CONSTRAINED : k->definite ? SOLVE_DEFINITE : SOLVE_PIVOTING;
}

/* Index first + by_row*row_at[i] + by_turn*turn_at[j]; a table that is NULL has i in place i. */
typedef struct {
  int64_t first, by_row, by_turn;
  const uint32_t *row_at, *turn_at;
} IrPlace;

/* for i in 0 .. rows - 1, for j in skew*i .. skew*i + turns + more*i - 1, or in begin[i] .. begin[i + 1] - 1: what the body computes is added to sums, which are 0
 * before the first nest; what goes to one sum in all turns of the inner loop, or of the only one, is added up from 0 before it is
 * added. The body is a program without nests: its loads of arrays and sums, and its stores, have numbers of `at`
 * as index (those that are no arrays have none); its loads of ARR_OUTER have numbers of `outer`. A store to array 0 adds, to array 1
 * subtracts. */
typedef struct {
  uint32_t rows, count; /* count: of all turns */
  int64_t skew, turns, more;
  const uint32_t *begin; /* [rows + 1] of rows whose lengths follow no rule; or NULL */
  const struct Prog *body;
  const IrPlace *at;    /* [n] */
  const Slot *outer;    /* [nouter] values of the program that the nest is in */
  uint32_t n, nouter;
} Nest;

/* Whether there is a loop over j: one over i is the only one where each row has one turn. */
static inline int nest_has_turns(const Nest *n) { return n->rows == 1 || n->begin || n->turns != 1 || n->more != 0; }

/* Whether place k of `at` moves from turn to turn of the inner loop, or of the only one. */
static inline int nest_moves(const Nest *n, uint32_t k) { return (nest_has_turns(n) ? n->at[k].by_turn : n->at[k].by_row) != 0; }

/* The first turn of row i, and the one behind its last. */
static inline int64_t nest_from(const Nest *n, int64_t i) { return n->begin ? n->begin[i] : n->skew*i; }
static inline int64_t nest_to(const Nest *n, int64_t i) { return n->begin ? n->begin[i + 1] : (n->skew + n->more)*i + n->turns; }

/* The index at place k of `at` in turn j of row i. */
static inline int64_t nest_index(const Nest *n, uint32_t k, int64_t i, int64_t j) {
  const IrPlace *x = &n->at[k];
  return x->first + x->by_row*(x->row_at ? x->row_at[i] : i) + x->by_turn*(x->turn_at ? x->turn_at[j] : j);
}

/* A table that the user gave for what is called `name`. */
typedef struct {
  const char *name, *file;
  const Spline *curve;
} IrTable;

typedef struct Prog {
  Arena *arena;
  VEC(Ins) ins;       /* [0] unused */
  VEC(Store) stores;
  VEC(Solve) solves;
  VEC(IrTable) tables;
  VEC(Nest) nests;
  uint32_t cells;     /* sums of ARR_CELL */
  int reckons;        /* arithmetic of numbers alone is done now, and what a number divides is multiplied by its reciprocal */
  uint32_t *table;    /* value numbering */
  uint32_t table_cap;
} Prog;

typedef struct {
  uint64_t add, mul, div, sqrt, fn, other; /* fn: sin, cos, exp ... */
} OpCount;

Prog *prog_new(Arena *a);

/* An empty one with room for as much as p has: growing would take twice the memory. */
Prog *prog_like(const Prog *p);

/* Appends an instruction, or finds the same computation done before. Sums and products are
 * commutative: their operands are ordered. Folds what adds 0 or multiplies by 1. */
Slot prog_ins(Prog *p, Ins i);
Slot prog_op(Prog *p, IrOp op, Slot a, Slot b);
Slot prog_num(Prog *p, Num n);
void prog_title(Prog *p, const char *text);
void prog_store(Prog *p, uint32_t array, uint32_t index, Slot s, const char *comment);

/* Gives a value the name that the user or the theory has for it, unless it has one or is a leaf. */
void prog_name(Prog *p, Slot s, Name name);

int ir_is_condition(IrOp op);

/* Whether `index` is that of a Solve. */
int ir_has_solve(IrOp op);

/* sin_th1, m2_l1, th1_dot_sq, inv_M11: a name made of those of the operands, x and y (NULL: they have none that says anything), for a value
 * without one; or NULL. of_one: its first operand is the number 1. */
const char *ir_made_name(Arena *a, const Ins *i, int of_one, const char *x, const char *y);

/* A number or a load: what takes no instruction of its own. */
int ir_is_leaf(IrOp op);

/* reckon.c: what the instruction comes to where its operands are numbers, appended; NOT_A_SLOT: not to a number. */
Slot prog_reckon(Prog *p, const Ins *i);
int prog_is_number(const Prog *p, Slot s);

/* eval.c: a function of the C library by its name; NaN for unknown ones. */
long double prog_call1(const char *name, long double x);

/* Divisions by one value that occur more than once become products with its reciprocal; what no
 * store needs goes. Keeps the order of what stays. Needs nothing, breaks nothing. */
Prog *prog_tidy(const Prog *p);

/* a*x + a*y becomes a*(x + y) where both products are used there alone, as long as that saves operations. Needs a tidy
 * program and leaves one; changes rounding. */
Prog *prog_factor(Prog *p);

/* m*l*a and m*l*b share m*l: the pair of factors that most products contain becomes a value of its own, again and again (M. Breuer,
 * Generation of optimal code for expressions via factorization, Comm. ACM 12 (1969) 333, doi:10.1145/363011.363153). Time
 * grows with the number of products times that of pairs: for programs that are not long. Needs a tidy program and
 * leaves one, with fewer operations or the same; changes rounding. */
Prog *prog_share(Prog *p);

/* The same instructions in the order in which the stores need them, pivots first; without titles. What one store needs
 * stands together, and makes one loop with what its neighbours need. Not for programs with solves. */
Prog *prog_by_demand(const Prog *p);

/* The same instructions in the order in which they must begin for nothing to wait: what is on the longest way to the end comes first,
 * what is needed late stands where it is needed. calls_first: functions are calls, before which all values in registers would have to
 * be put away: they come first. Without titles; programs with solves keep their order. */
Prog *prog_by_deadline(const Prog *p, int calls_first);

/* After how many cycles a processor has the result, about. */
uint32_t ir_latency(IrOp op);

/* Whether two programs compute the same. */
int prog_same(const Prog *a, const Prog *b);

/* The instruction with its operands, and the solve that it names, as they are in the program `to`; map: the slots there. */
Ins prog_moved(Prog *to, const Prog *from, const Slot *map, Ins i);

/* The program itself, 0, and the bodies of its nests, 1 ... prog_parts - 1: where instructions are. */
uint32_t prog_parts(const Prog *p);
const Prog *prog_part(const Prog *p, uint32_t k);

/* How many instructions, stores, solves and nests take each value: [p->ins.n]. */
uint32_t *prog_uses(const Prog *p);

/* Sums of several terms are added up in the order in which the terms can be there, earliest first: what comes late passes
 * through few additions. ready[p->ins.n]: when the value of each load can be there, in cycles of a processor. Changes the
 * order of rounding; drops names of parts of sums. */
Prog *prog_balance(const Prog *p, const uint32_t *ready);

/* The same for a processor that multiplies and adds at once, from loads that are there at the start: the terms in a row,
 * earliest first, so that each product is taken in by its addition; so are factors. Keeps names. Of two orders that are as fast it
 * takes the one with fewer instructions; the operations are the same. */
Prog *prog_in_time(const Prog *p);

/* Checks that operands precede their use, conditions feed only selections, stores and what nests take are there.
 * NULL, or what is wrong. */
const char *prog_verify(const Prog *p);

/* A listing, one instruction a line, for --dump=prog. */
void prog_dump(const Prog *p, StrBuf *out);

/* Whether it divides by what may be 0: IR_PIVOT, IR_SOLVE. */
int prog_has_pivots(const Prog *p);

/* Whether it solves a system of that kind by a loop. p may be NULL. */
int prog_solves(const Prog *p, SolveKind kind);

/* Room that IR_SOLVE needs, in reals. */
uint32_t prog_work(const Prog *p);

/* solve_ops.c: of a system that is solved by a loop. Where constraints are mostly independent and M is positive definite, which is what
 * is counted, zeros outside of envelopes cost nothing. */
OpCount solve_count(Arena *a, const Solve *k);
OpCount invert_count(const Solve *k);

OpCount prog_count(const Prog *p);
uint64_t ops_total(OpCount c);

/* As what an int holds: its largest number stands for all beyond. */
uint32_t ops_as_int(uint64_t ops);

/* Runs the program in extended precision, with the range of doubles: in[array] are the inputs, out[array][index] the stores. Of derived
 * parameters in[ARR_P] is out[0]. Returns 0, or -1 when a pivot failed. */
int prog_eval(const Prog *p, const long double *const in[ARR_COUNT], long double *const *out);

#endif
