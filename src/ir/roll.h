/* Loops in a Prog: runs of isomorphic groups of instructions, found in its order and nowhere else: a chain
 * written out by hand rolls as a family does, since neither names nor families are looked at.
 *
 * The Prog stays as it is; loops are a way to write it shorter. Every value is computed by the same
 * operations in the same order. */
#ifndef LAGC_ROLL_H
#define LAGC_ROLL_H

#include "ir/prog.h"

/* A value that every iteration stores: out[array][index + r*step]. */
typedef struct {
  uint32_t offset, array;
  int64_t index, step;
  const char *first, *last; /* comments */
} LoopStore;

/* `count` times the `period` instructions from place `begin` of the code on. */
typedef struct {
  uint32_t begin, period, count;
  uint32_t *kept;         /* [period] 1 + how many iterations back a value is needed; 0: in its own iteration only */
  unsigned char *carried; /* [period] 1: the next iteration needs it, and behind the loop at most the last one is needed */
  VEC(LoopStore) stores;
} Loop;

/* How an operand changes from iteration to iteration. */
typedef enum {
  STEP_SAME,   /* the same value in all */
  STEP_LOAD,   /* elements of an array: index + r*step */
  STEP_NUMBER, /* numbers, unit*(first + r): see roll_number */
  STEP_OWN,    /* a value of the same iteration */
  STEP_BEFORE, /* a value of the iteration `back` before; in the first ones, of the code before the loop */
  STEP_OTHER   /* a value of an earlier loop: its iteration + r*step */
} StepKind;

typedef struct {
  StepKind kind;
  int64_t step;
  uint32_t back;
} Step;

typedef struct {
  const Prog *p;
  uint32_t n;
  const Slot *code;      /* [n] the instructions that are no leaves, in order */
  const uint32_t *place; /* by slot: its place in code, from 1; 0: a leaf */
  VEC(Loop) loops;       /* in order */
  const uint32_t *loop;  /* by place: the loop that holds it, from 1 */
  unsigned char *stored; /* by store of p: 1 when a loop has it in its `stores` */
} Rolls;

/* Programs of fewer instructions get no loops: straight-line code is faster there, and reads better. */
enum { ROLL_FROM = 1500, ROLL_SELDOM_FROM = 500 };

/* by_index: the arrays of loads that can be indexed by a variable, as bits 1 << IrArray. A program of fewer than `from`
 * instructions gets no loops. early: stores may come before the last load. */
Rolls roll_find(const Prog *p, unsigned by_index, uint32_t from, int early);

/* How operand `which` (0, 1, 2) of instruction `offset` of the loop changes. */
Step roll_step(const Rolls *r, const Loop *l, uint32_t offset, int which);

/* The numbers of a STEP_NUMBER that begins with x and y: y - x is a unit whose numerator has exact multiples in binary, so that
 * dividing them by its denominator rounds as the number itself does; x is `first` times that. 0 when they are not like that. */
int roll_number(const Ins *x, const Ins *y, Num *unit, int64_t *first);

Slot roll_operand(const Ins *i, int which);

#endif
