/* From the space of solutions of the search for symmetries to tables of numbers: generators as coefficients of known functions of
 * time, in echelon form. Shared by the files of the search. */
#ifndef LAGC_NOETHER_TABLE_H
#define LAGC_NOETHER_TABLE_H

#include "mech/noether_search.h"

/* How the coefficients of a family of generators depend on time. */
typedef enum { TIME_POWERS, TIME_CIRCULAR, TIME_EXPONENTIAL, TIME_LISTED } TimeKind;

enum { TIME_BLOCKS_MOST = 6 };

/* One row a generator; block m stands for t^m, or for cos wt and sin wt, or for exp st and exp -st, both times t behind them, and t^2 if these occur, or for a
 * function of a list, which begins with 1, t and t^2. Entry [m*shown + column]. */
typedef struct {
  uint32_t rows, blocks, shown;
  long double *at;  /* reduced echelon form */
  uint32_t *pivot;
} Table;

/* Whether rows and pivots agree. */
int table_same_shape(const Table *a, const Table *b);

Table table_powers(Arena *a, const SolutionSpace *s, uint32_t shown);

/* rate2 < 0: those with frequency sqrt(-rate2); > 0: those that grow and fall with sqrt(rate2). */
Table table_periodic(Arena *a, const SolutionSpace *s, uint32_t shown, long double rate2);

/* For an L that contains t: coefficients that are combinations of listed functions of time, those of F of a longer list. Functions are roots
 * of tapes, derivatives behind them. rows 0 and *sure 0: the equations could not be solved. */
typedef struct {
  uint32_t n, ngauge; /* the first n functions are for xi and tau */
  const Expr *f;      /* [ngauge] */
} TimeList;

Table table_listed(Arena *a, const Ansatz *s, const TimeList *times, const long double *parameters, int *sure);

/* The squares of the rates with which solutions go, those that are real and not 0. */
typedef struct {
  uint32_t n, others; /* others: not real */
  long double *at;
} Rates;

Rates space_rates(Arena *a, const SolutionSpace *s);

/* Row + factor*other makes the entries in two places equal, or opposite: that is the factor. */
typedef struct {
  uint32_t row, other, one, two;
  int sign;
} TableChange;

enum { CHANGES_MOST = 3 };

/* Changes after which the entries of a row take fewer different values: what stands in books has few. They are made, so the rows span what
 * they did; the pivots of the other rows come back into this one. Returns how many, up to CHANGES_MOST, are in to[]. */
uint32_t table_shorten(Arena *a, Table *t, uint32_t row, TableChange *to);

/* Makes a change that was found on another table of this shape. 0: there is no such factor. */
int table_change(Arena *a, Table *t, TableChange c);

#endif
