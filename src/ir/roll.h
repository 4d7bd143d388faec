/* Loop rolling: finds runs of isomorphic groups of consecutive instructions in a Prog. Names and families are not
 * looked at, so that a chain written out by hand rolls as a family does.
 *
 * The Prog stays as it is; the writer of C uses the loops to write it shorter. Every value is computed by the same
 * operations in the same order. */
#pragma once

#include "ir/prog.h"

/* A value that every iteration r stores: out[array][index + r*step]. offset: of its instruction in the period. */
typedef struct {
  uint32_t offset, array;
  int64_t index, step;
  const char *first, *last; /* comments */
} LoopStore;

/* `count` iterations of `period` instructions, from place `begin` of the code on. */
typedef struct {
  uint32_t begin, period, count;
  /* [period] 0: value used in its own iteration only; 1: behind the loop, too; 1 + b: b iterations later, too */
  uint32_t *kept;
  /* [period] 1: only the next iteration needs the value and, behind the loop, at most the last one is needed */
  unsigned char *carried;
  VEC(LoopStore) stores;
} Loop;

/* Iteration, and offset in the period, of a place in the code. */
static inline uint32_t loop_turn(const Loop *l, uint32_t place) { return (place - l->begin) / l->period; }
static inline uint32_t loop_offset(const Loop *l, uint32_t place) { return (place - l->begin) % l->period; }

/* How an operand changes from iteration to iteration. */
typedef enum {
  STEP_SAME,   /* one value in all iterations */
  STEP_LOAD,   /* elements of an array: index + r*step */
  STEP_NUMBER, /* numbers, unit*(first + r): see roll_number */
  STEP_OWN,    /* a value of the same iteration */
  STEP_BEFORE, /* a value of `back` iterations before; in the first ones, of the code before the loop */
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
  const Slot *code;      /* [n] instructions except leaves, in order */
  const uint32_t *place; /* by slot: its place in code, from 1; 0: a leaf */
  VEC(Loop) loops;       /* in order */
  const uint32_t *loop;  /* by place: the loop that holds it, from 1 */
  unsigned char *stored; /* by store of p: 1 when a loop has it in its `stores` */
} Rolls;

/* Programs of fewer instructions get no loops: straight-line code is faster and reads better. SELDOM: called once a
 * step or a row. */
enum { ROLL_FROM = 1500, ROLL_SELDOM_FROM = 500 };

/* by_index: bits 1 << IrArray of arrays that may be indexed by a variable. from: fewest instructions of a program with
 * loops. early: stores may come before the last load, so that loops may store. */
Rolls roll_find(const Prog *p, unsigned by_index, uint32_t from, int early);

/* How operand `which` (0, 1, 2) of instruction `offset` of the loop changes from iteration to iteration. */
Step roll_step(const Rolls *r, const Loop *l, uint32_t offset, int which);

/* Numbers of a STEP_NUMBER, unit*(first + r), from those of its first two iterations, x and y. The numerators are
 * exact in binary, so that division by the unit's denominator rounds as the number itself. Returns 0 when the
 * numbers have no such form. */
int roll_number(const Ins *x, const Ins *y, Num *unit, int64_t *first);

/* Number of stores from k on, of numbers to neighbouring elements: all of one value, or as in roll_number. */
uint32_t roll_constants(const Prog *p, uint32_t k);
