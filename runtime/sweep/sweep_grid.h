/* The runs of a sweep: the values of each. Enters: ranges, as words of the command line; leaves: for run i the value
 * of each name that varies. Holds: run i has the same values in any order. Names are not looked up here. */
#pragma once

#include <stddef.h>
#include <stdint.h>

/* A name that varies: over n values of a grid, or as one dimension of samples. */
typedef enum { FACTOR_LINEAR, FACTOR_LOG, FACTOR_LIST, FACTOR_UNIFORM, FACTOR_NORMAL } FactorKind;

typedef struct Factor {
  char name[96], unit[48]; /* as a file of rows has it; "": the declared one */
  FactorKind kind;
  double a, b;  /* ends of a range; mean and deviation */
  long long n;  /* values of a grid, 0: samples */
  int compiled; /* 1: a constant, of which the program has a variant for each value */
  double *list; /* [n] of FACTOR_LIST */
} Factor;

typedef enum { SAMPLING_RANDOM, SAMPLING_HYPERCUBE, SAMPLING_POINTS } Sampling;

typedef struct SweepPlan {
  Factor *factor; /* [n] */
  int n;
  int zip;        /* 1: grids are walked together, not multiplied */
  long long grid, samples, runs; /* runs = grid * samples */
  Sampling sampling;
  uint64_t seed;
  const double *points; /* SAMPLING_POINTS: [samples * dimensions] numbers in [0, 1) */
  int dimensions; /* of samples */
} SweepPlan;

/* Whether the word is a range: name=A..B:N, name=A..B:log:N, name=A,B,C, name~normal(MEAN, DEVIATION),
 * name~uniform(A, B); and with samples name=A..B. */
int lag_plan_is_range(const char *word);

/* Adds the range. 0, or -1 with the reason in why: what is wrong, and what to write. */
int lag_plan_add(SweepPlan *p, const char *word, char *why, size_t size);

/* rows_file.c: adds the columns of a CSV file: a row a run, names in its first line, "th [rad]" for th; walked
 * together with each other. The same. */
int lag_plan_add_rows(SweepPlan *p, const char *path, char *why, size_t size);

/* Counts runs when all ranges are there; samples: of distributions, 0: none given. 0, or -1 with the reason. */
int lag_plan_finish(SweepPlan *p, long long samples, char *why, size_t size);

/* value[n] := the values of run i. */
void lag_plan_values(const SweepPlan *p, long long i, double *value);

/* The variant of run i: its place in the grid of the compiled names alone, the last fastest; 0 where there are none.
 * And a run of a variant. */
long long lag_plan_variant(const SweepPlan *p, long long i);
long long lag_plan_run_of(const SweepPlan *p, long long variant);

void lag_plan_free(SweepPlan *p);

/* ---- For rows_file.c */

/* The number at *s, after which *s stands: 1, or 0. */
int lag_plan_number(const char **s, double *x);
/* Adds a name whose values follow. 0, or -1 with the reason. */
int lag_plan_add_column(SweepPlan *p, const char *name, const char *unit, char *why, size_t size);
/* Adds x to the values of a list. 0, or -1: out of memory. */
int lag_factor_add(Factor *f, double x);
