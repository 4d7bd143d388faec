/* Verification of a right-hand side by hand: verify.c judges, verify_program.c runs both. */
#pragma once

#include "claims/sample_points.h"
#include "commands/simulator.h"

typedef long double Real;

/* arguments beside a point, and their largest distance in ulp; directions of rounding; fewest points */
enum { BESIDE = 6, ROUNDINGS = 8, MODES = 4, FEWEST = 8 };

/* Results of one set of arguments; dydt in the order of the function. */
typedef struct {
  double status;
  const double *high, *low;                 /* [na] */
  double yours_status[MODES];
  const double *dydt[MODES];                /* [ny] */
} Evaluation;

/* Findings on one component of dydt, in the model's order. */
typedef struct {
  /* points compared; those where it differs; those of RANDOM where rounding leaves no digits */
  uint32_t points, differs, scattered;
  int is_rounding;                     /* it is not exact at points where the value is 0 up to roundings */
  Real ulps;                           /* largest difference in ulp that rounding explains */
  Real worst;                          /* largest of the relative differences that rounding does not explain, */
  uint32_t worst_at;                   /* and its point */
} Component;

typedef struct {
  Compiler *c;
  const Eqns *e;
  const Model *m;
  ExprGraph *g;
  Arena *arena;
  const char *file, *function;
  const char *given; /* values of the command line */
  uint32_t nq, ny, na, np;
  uint32_t *map;                 /* [ny] component of y at each place of the function's y */
  SamplePoints *points;
  Real *symbols[POINTS];         /* NULL: outside the domain */
  uint32_t n, point[POINTS];     /* points that are evaluated */
  double *results;
  Component *component;          /* [ny] */
  int quiet;                     /* a trial of other effects: nothing is printed */
  const char *path;              /* of the file, absolute */
  const ProgramSet *program;     /* derived equations */
  OneRun run;                    /* arguments and results */
} Verification;

/* The message for a file that does not have the function; NULL: it seems to have it. */
const char *verify_function_missing(Verification *v, const char *text);
/* Builds and runs the program with derived equations in this precision. 0, with run.error: it is not built. */
int verify_run(Verification *v, const char *precision);
