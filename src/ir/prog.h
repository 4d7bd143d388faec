/* Prog: the program of one emitted function. Straight-line code in single assignment, except for nests of loops that
 * accumulate sums.
 *
 * Operands have lower numbers than their instruction; every value is computed once. A Prog knows names
 * for its values and carries its own texts, so that nothing after it needs the model. */
#pragma once

#include "base/id_table.h"
#include "base/intern.h"
#include "base/loop_nest.h"
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
  IR_NEST,   /* runs nest `index` of prog->nests; a: the nest that must run before, or 0 */
  IR_TABLE,  /* value at a of the spline of prog->tables[index] */
  IR_TITLE   /* text: a comment line above the instructions that follow */
} IrOp;
static inline int ir_is_sum(IrOp op) { return op == IR_ADD || op == IR_SUB || op == IR_NEG; }

/* Arrays that a function reads. Line 1: time, state, parameters, inputs; accelerations (linearisation only);
 * right-hand side g of A d = g (state corrections only). Line 2, Taylor coefficients (series/series.h): flags of
 * inputs that follow their formulas (0: held constant), coefficients x[k], sums over lower coefficients, constants
 * of order 0; the scalars k, 1/k and T/(k + 1). Line 3, nests: accumulated sums, whose loads have the nest as
 * operand a; values that a body reads from the program around its nest; the whole numbers, element k being k. */
typedef enum {
  ARR_T, ARR_Q, ARR_V, ARR_Z, ARR_P, ARR_U, ARR_A, ARR_G,
  ARR_FREE, ARR_COEF, ARR_SUMS, ARR_STEP, ARR_ORDER, ARR_PER_ORDER, ARR_UP,
  ARR_CELL, ARR_OUTER, ARR_INDEX, ARR_COUNT
} IrArray;

/* Whether an array is a single number, without index. */
int ir_is_scalar(IrArray array);

typedef struct {
  IrOp op;
  Slot a, b, c;
  Num number;
  uint32_t index;
  IrArray array;
  Name name;        /* of the element loaded; or the user's or the theory's name of the value; or NULL */
  const char *text; /* a function's name; a title */
} Ins;

/* Operand 0, 1, 2 of an instruction. */
static inline Slot ins_operand(const Ins *i, int k) { return k == 0 ? i->a : k == 1 ? i->b : i->c; }

/* out[index] = slot; the comment names the value. */
typedef struct {
  uint32_t array; /* output array, numbered in the order of the emitted function's declaration */
  uint32_t index;
  Slot slot;      /* 0: zero */
  const char *comment;
} Store;

/* An element that is not zero, at row n + column of [M; A], row-major. */
typedef struct {
  uint32_t at;
  Slot x;
} SolveElement;
typedef VEC(SolveElement) SolveElements;

/* Sorts by place. */
void solve_sort(SolveElements *list);

/* Element of the list; 0: none. */
Slot solve_element(const SolveElements *list, uint32_t at);

/* A system that a loop solves: symmetric M[n*n], rhs[n]. m > 0 constraints: M x - A^T l = f, A x = g. A[m*n] follows M,
 * g follows f, l follows x. list: elements by rising place. coarse: nearly dependent constraints count as dependent
 * (lag_kkt.h). */
typedef struct {
  uint32_t n, m;
  int coarse;
  const Slot *rhs;
  SolveElements list;
} Solve;

/* Size of [M; A], and length of rhs. */
static inline uint32_t solve_elements(const Solve *k) { return (k->n + k->m) * k->n; }
static inline uint32_t solve_unknowns(const Solve *k) { return k->n + k->m; }

/* Array index in row i, turn j of a nest. */
typedef Subscript IrSubscript;

/* Of a nest over neighbours: positions in its `at` of the elements of q that are the places i and j, by component; in
 * `outer`, of the cut and the sides of the box, where it has any. Turn j of row i is taken only if the value of the
 * body's store to array NEST_TEST holds. n 0: of another nest. */
typedef struct {
  uint32_t n, at_i[3], at_j[3], cut, side[3];
  int boxed;
} IrNear;
enum { NEST_TEST = 2, NEST_SETS = 3 };

/* Of a nest that a tree sums, factor*c_i*c_j/sqrt(d^2 + soft) over all pairs of bodies: component c of body k is
 * q[first[c] + step*k], its charge the sum charge + k. The nest adds to the sum `energy`, or derivatives by places to
 * slope[c] + by*k; -1: it does not. numbers: positions in `outer` of factor, soft, opening angle. n 0: another nest. */
typedef struct {
  uint32_t n, members, charge, numbers[3];
  int64_t first[3], step, slope[3], by, energy;
} IrFar;

/* Two loops that accumulate sums: for i in 0 .. rows - 1, for j in skew*i .. skew*i + turns + more*i - 1. Sums
 * (ARR_CELL) are 0 before the first nest. A sum that stays the same in all turns of the inner (or only) loop gets
 * their total at once, added up from 0.
 *
 * The body is a program without nests. The index of its loads and stores is a position in `at` (scalars have none),
 * of loads of ARR_OUTER a position in `outer`. A store to array 0 adds to the sum, a store to array 1 subtracts, one to
 * array NEST_SETS + k is a store to array k of the program around, before its own. */
typedef struct {
  uint32_t rows, count; /* count: turns of all rows together */
  int64_t skew, turns, more;
  const struct Prog *body;
  const IrSubscript *at;    /* [n] */
  const Slot *outer;    /* [nouter] values of the program that the nest is in */
  uint32_t n, nouter;
  IrNear near;
  IrFar far;
  /* of a quantified sum, which is not written out anywhere: rows of its text, of which those without turns are left
   * out, and the number of the first; 0: of another nest. Turns of a row of the text, where the nest takes half;
   * else 0 */
  uint32_t text_rows, first_row, text_turns;
} Nest;

/* Whether there is a loop over j: where each row has one turn, the loop over i is the only one. */
static inline int nest_has_turns(const Nest *n) { return n->rows == 1 || n->turns != 1 || n->more != 0; }

/* Whether the index at[k] changes from turn to turn of the inner loop, or of the only one. */
static inline int nest_moves(const Nest *n, uint32_t k) {
  return (nest_has_turns(n) ? n->at[k].by_turn : n->at[k].by_row) != 0;
}

/* First turn of row i, and one past its last. */
static inline int64_t nest_from(const Nest *n, int64_t i) { return n->skew*i; }
static inline int64_t nest_to(const Nest *n, int64_t i) { return (n->skew + n->more)*i + n->turns; }

/* Value of the index at[k] in turn j of row i. */
static inline int64_t nest_index(const Nest *n, uint32_t k, int64_t i, int64_t j) {
  return subscript_at(&n->at[k], i, j);
}

/* The spline of the table that the user gave for input `name`; order: of its derivative, 0 unless the curve is
 * quintic. */
typedef struct {
  const char *name, *file;
  const Spline *curve;
  int order;
} IrTable;

typedef struct Prog {
  Arena *arena;
  VEC(Ins) ins;       /* [0] unused */
  VEC(Store) stores;
  VEC(Solve) solves;
  VEC(IrTable) tables;
  VEC(Nest) nests;
  uint32_t cells;     /* number of sums of ARR_CELL */
  int folds_constants;        /* constants are folded at once, and x/number becomes x*(1/number) */
  const char *fault;  /* a pass left it malformed (ir/passes.h), and how; NULL: none did */
  IdTable table;      /* of instructions, for value numbering */
} Prog;

/* Whether a nest stores values, and has no sums. */
static inline int nest_sets(const Nest *n) { return n->body->stores.n && n->body->stores.at[0].array >= NEST_SETS; }

typedef struct {
  uint64_t add, mul, div, sqrt, fn, other; /* fn: sin, cos, exp ... */
} OpCount;

Prog *prog_new(Arena *a);

/* An empty program with room for as many instructions as p has: growing would take twice the memory. */
Prog *prog_new_like(const Prog *p);

/* Gives up the memory of a program from which all that is needed was copied. Its solves, tables, nests and texts
 * stay: copies have them. */
void prog_release(Prog *p);

/* Appends an instruction, or returns an equal earlier one; operands of a sum or product match in either order.
 * Simplifies x + 0, 1*x and the like. */
Slot prog_ins(Prog *p, Ins i);
Slot prog_op(Prog *p, IrOp op, Slot a, Slot b);
Slot prog_add_product(Prog *p, Slot x, Slot a, Slot b); /* x + a*b */
Slot prog_sub_product(Prog *p, Slot x, Slot a, Slot b); /* x - a*b */
Slot prog_num(Prog *p, Num n);
void prog_title(Prog *p, const char *text);
void prog_store(Prog *p, uint32_t array, uint32_t index, Slot s, const char *comment);

/* Appends the stores of `from`, their slots renumbered by map[slot]. */
void prog_copy_stores(Prog *to, const Prog *from, const Slot *map);

/* Appends the solve, and its solution x[n + m]; k.list: lower triangle of M and A, in any order. */
void prog_solve(Prog *p, Solve k, Slot *x);

/* Gives a value the user's or the theory's name, unless it has a name or is a leaf. */
void prog_name(Prog *p, Slot s, Name name);
int prog_takes_name(const Prog *p, Slot s);

int ir_is_condition(IrOp op);

/* Name of an unnamed value made from the names x and y of its operands (NULL: none): sin_th1, m2_l1, th1_dot_sq,
 * inv_M11; or NULL. of_one: the first operand is the number 1. */
const char *ir_made_name(Arena *a, const Ins *i, int of_one, const char *x, const char *y);

/* Whether a value is a number or a load, which takes no instruction of its own. */
int ir_is_leaf(IrOp op);

/* constant_fold.c: the folded or simplified form of an instruction with numbers among its operands, appended;
 * NOT_A_SLOT: there is none. */
Slot prog_constant_fold(Prog *p, const Ins *i);
int prog_is_number(const Prog *p, Slot s);

/* prog_eval.c: value at x of the C library's function `name`; NaN for unknown names. */
long double prog_call1(const char *name, long double x);

/* Removes dead code; several divisions by one value become products with its reciprocal. Keeps the order of the rest.
 * Needs nothing, breaks nothing. */
Prog *prog_tidy(const Prog *p);

/* Common factors of sums: a*x + a*y becomes a*(x + y) where neither product has another use, as long as that saves
 * operations. Needs a tidy program and leaves one; changes rounding. */
Prog *prog_factor(Prog *p);

/* Common subproducts: m*l*a and m*l*b share m*l. The pair of factors that most products contain becomes a value of
 * its own, again and again (M. Breuer, Generation of optimal code for expressions via factorization, Comm. ACM 12
 * (1969) 333, doi:10.1145/363011.363153). Time grows as products times pairs, so only for short programs. Needs a
 * tidy program and leaves one with at most as many operations; changes rounding. */
Prog *prog_product_cse(Prog *p);

/* Sums over pairs, sites or bodies as nests (nest.c); p itself where there are none, p has fewer than `from`
 * instructions, or it has solves. Needs a tidy program and leaves one; adds sums in another order. */
Prog *prog_find_nests(Prog *p, uint32_t from);

/* Schedule store by store, pivots first, without titles: the instructions that one store needs stand together, and
 * form a loop with those of its neighbours. Not for programs with solves. */
Prog *prog_schedule_by_store(const Prog *p);

/* Schedule by critical path: the longest path of latencies to the end comes first, late values stand where they are
 * needed. calls_first: functions are calls and come first, since values in registers would have to be saved before
 * them. Without titles; programs with solves keep their order. */
Prog *prog_schedule_by_path(const Prog *p, int calls_first);

/* Approximate latency of an operation, in cycles. */
uint32_t ir_latency(IrOp op);

/* Whether two programs have equal listings and tables. */
int prog_same(const Prog *a, const Prog *b);

/* Instruction i of `from` for `to`: operands renumbered by map[slot]; its solve, table or nest is copied. Does not
 * append it. */
Ins prog_import(Prog *to, const Prog *from, const Slot *map, Ins i);

/* All programs with instructions: part 0 is p itself, parts 1 ... prog_parts - 1 are the bodies of its nests. */
uint32_t prog_parts(const Prog *p);
const Prog *prog_part(const Prog *p, uint32_t k);

/* Number of operands of an instruction, and operand k (0: a structural zero): a, b, c; then the values that its nest
 * reads, or the matrix and the right-hand side of its system. */
uint32_t prog_operands(const Prog *p, const Ins *i);
Slot prog_operand(const Prog *p, const Ins *i, uint32_t k);

/* Number of uses of each value by instructions, stores, solves and nests: [p->ins.n]. */
uint32_t *prog_uses(const Prog *p);

/* Reassociates sums: terms are added in the order in which they are ready, so that a late one passes through few
 * additions. ready[p->ins.n]: time at which each load has its value, in cycles. Changes rounding; drops names of
 * partial sums. */
Prog *prog_reassociate(const Prog *p, const uint32_t *ready);

/* Reassociates sums and products for fused multiply-add, all loads being ready at the start: terms in a row,
 * earliest first, so that each addition takes in a product. Of two equally fast orders it takes the one with fewer
 * instructions. Keeps names and operations. */
Prog *prog_reassociate_fma(const Prog *p);

/* Checks that operands precede their uses, conditions feed only conditions and selections, and stores and operands
 * of nests exist. NULL, or the first fault. */
const char *prog_verify(const Prog *p);

/* A listing, one instruction a line, for --dump=prog. */
void prog_dump(const Prog *p, StrBuf *out);

/* Whether the program may fail at a zero pivot: IR_PIVOT, IR_SOLVE. */
int prog_has_pivots(const Prog *p);

/* Whether the program solves a system without constraints. p may be NULL. */
int prog_solves_dense(const Prog *p);

/* Size of the work space that IR_SOLVE needs, in reals. */
uint32_t prog_work_size(const Prog *p);

/* solve_cost.c: operations of a system that a loop solves. With constraints, counted for independent ones and a
 * positive definite M, where zeros outside of envelopes cost nothing. */
OpCount solve_count(Arena *a, const Solve *k);

OpCount prog_count(const Prog *p);
uint64_t ops_total(OpCount c);

/* As an int, saturated at INT32_MAX. */
uint32_t ops_as_int(uint64_t ops);

/* Evaluates the program in extended precision, with the range of doubles: in[array] are the inputs,
 * out[array][index] the stores. Returns 0, or -1 when a pivot failed. */
int prog_eval(const Prog *p, const long double *const in[ARR_COUNT], long double *const *out);

/* The same with a sample of the turns of quantified sums (loop_samples). */
int prog_eval_sample(const Prog *p, const long double *const in[ARR_COUNT], long double *const *out);
