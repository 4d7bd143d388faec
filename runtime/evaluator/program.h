/* A program as liblag executes it, and its parts; numeric/program_code.def says what its words mean. */
#ifndef EVALUATOR_PROGRAM_H
#define EVALUATOR_PROGRAM_H

#include <stdint.h>

#include "numeric/program_code.def"

typedef enum {
#define ONE(name, kinds, ...) CODE_##name,
#define BOTH(name, kinds, ...) CODE_##name, CODE_##name##_TO,
  PROGRAM_CODES(ONE, ONE, BOTH)
#undef ONE
#undef BOTH
      CODES
} Code;

enum {
#define OP(name, operands, formula) TURN_##name,
  PROGRAM_TURN_OPS(OP, OP)
#undef OP
      TURN_OPS
};

enum {
#define ARRAY(name) PROGRAM_##name,
  PROGRAM_ARRAYS(ARRAY)
#undef ARRAY
      PROGRAM_ARRAY_COUNT
};

enum { PROGRAM_OUTPUTS = 4 }; /* the most arrays that a function writes */

typedef double lag_function_1(double);
typedef double lag_function_2(double, double);
extern lag_function_1 *const lag_functions_1[];
extern lag_function_2 *const lag_functions_2[];
extern const uint32_t lag_functions_1_count, lag_functions_2_count;

/* Rows of a spline of 3 columns, or 4 with derivatives. */
typedef struct {
  int order, columns, n;
  const double *row;
} Curve;

/* w[at] = r[from] for the entries; then lag_solve or lag_kkt. */
typedef struct {
  int n, m, coarse;
  uint32_t entries;
  const uint32_t *entry; /* [2 entries] at, from */
} System;

/* Index first + by_row i + by_turn j. */
typedef struct {
  int64_t first, by_row, by_turn;
} Subscript;

/* Where values of a turn change: nowhere, from row to row, from turn to turn. */
typedef enum { IN_NEST, IN_ROW, IN_TURN, LEVELS } TurnLevel;

/* One instruction of a turn. */
typedef struct {
  uint32_t op, a, b, c, number;
  TurnLevel level;
} TurnIns;

/* Term that a turn adds to a sum, or (1) subtracts; NEST_SETS + k: that it stores in array k. */
enum { NEST_SETS = 3 };
typedef struct {
  uint32_t how, subscript, value;
  int moves;
} TurnSum;

/* Order in which turns are computed: any; row by row, as a turn reads sums of earlier rows; one by one. */
typedef enum { ANY_ORDER, ROW_BY_ROW, TURN_BY_TURN } TurnOrder;

/* Of a nest over neighbours: subscripts of the places i and j, by component; outer values of the cut and, + 1, of the
 * sides of the box; the value of the turn that says whether it counts. n 0: of another nest. */
typedef struct {
  uint32_t n, at_i[3], at_j[3], side[3], cut, test;
  int members; /* of the family of places */
} Near;

/* Of a nest that a tree sums (lag_tree.h): component c of body k is q[first[c] + step*k], its charge the sum
 * charge + k. It adds to the sum `energy`, or to slope[c] + by*k; -1: it does not. numbers: outer values of the factor,
 * the softening, the opening angle. n 0: of another nest. */
typedef struct {
  int n, members, charge, step, by, energy, first[3], slope[3];
  uint32_t numbers[3];
} Far;

/* for i < rows, for j in skew i .. (skew + more) i + turns - 1. A loop without turns is one row of them. */
typedef struct {
  int64_t rows, skew, turns, more;
  int apart; /* apart: no two sums share an element in a row */
  TurnOrder turn_order;
  uint32_t nsubscripts, nouter, nins, nsums;
  const Subscript *at;
  const uint32_t *outer; /* places in the frame */
  const TurnIns *ins;
  const uint32_t *order; /* [nins] instructions by level, in each loads first */
  uint32_t end[LEVELS];  /* of each level in order */
  const TurnSum *sum;
  Near near;
  Far far;
} Nest;

typedef struct {
  uint32_t frame; /* numbers that a call needs, with scratch of nests at its end */
  uint32_t scratch;
  int regular; /* the systems were found regular before */
  uint32_t cells, ncells, work, nwork;
  const double *constants;
  const Curve *curves;
  const System *systems;
  const Nest *nests;
  const uint32_t *words;
  uint32_t nconstants, ncurves, nsystems, nnests, nwords;
} Program;

/* in[PROGRAM_ARRAY_COUNT], of which the last is set here; r[frame]: memory. Returns LAG_OK or LAG_ESINGULAR. */
int lag_run_program(const Program *p, const double *const *in, double *const *out, double *r);

/* Numbers that the list of a nest over neighbours takes, and the tree of a nest. */
uint64_t lag_near_room(int members);
uint64_t lag_tree_room(int members);

/* Runs a nest of the program; see lag_run_program. */
void lag_run_nest(const Program *p, const Nest *n, const double *const *in, double *const *out, double *r);

enum { NEST_BLOCK = 64 }; /* turns that an operation of a nest computes at once */

#endif
