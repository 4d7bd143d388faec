/* Parameters and starts from a measured motion: what a fit is given and finds. */
#pragma once

#include "lag.h"

/* Targets of a fit. Values are in declared units. */
typedef struct FitTarget {
  const char *name; /* as lag_sim_set takes it */
  char label[160], unit[64];
  int is_start;              /* 0: a parameter */
  int weight;                /* 1: of a network */
  int record;                /* 1 + the record whose start it is; 0: of all records */
  double factor;             /* of the unit, in SI */
  int sign;                  /* as in lag_var; 0 of starts */
  double begin, scale;       /* first value; a typical change */
  double prior, prior_error; /* mean and deviation; error 0: none */
  double value, error;       /* result and standard error; NaN: not determined */
  double low, high;          /* of its profile of likelihood, 95 %; infinite: open; NaN: not asked, not determined */
  int flat;                  /* 1: it moves in a direction that data do not feel */
} FitTarget;

/* A column of data. */
typedef struct FitColumn {
  const char *label; /* "th [deg]" */
  int output;        /* of the simulation */
  double sigma;      /* error of a value; 0: not given, estimated from the residuals */
  int per_row;       /* 1: errors stand in `errors` */
  int n;             /* values that are there */
  double rms;        /* of the residuals */
  int exact;           /* 1: that is rounding */
  int runs;          /* of residuals with one sign; */
  double runs_expected, runs_deviation,
      runs_chance; /* expected of independent ones; chance of being as far from that */
} FitColumn;

/* A direction in which the sum of squares is flat. */
typedef struct FitDirection {
  const double *change; /* [n] relative changes, largest 1 */
  int product;          /* 1: products of powers are constant along it, also far away */
  int shift;            /* 1: the same for sums */
} FitDirection;

typedef struct Fit {
  const lag_least_squares *by;
  /* A new simulation with all settings but the values of targets; NULL: no memory. */
  lag_sim *(*fresh)(void *context);
  void *context;
  int n, ncolumns, nrows;
  FitTarget *target;     /* [n] */
  FitColumn *column;     /* [ncolumns] */
  const double *t;       /* [nrows], increasing within a record [s] */
  int nrecords;          /* motions of their own, at least 1, */
  const int *first;      /* [nrecords + 1] and their rows */
  double *data, *errors; /* [nrows * ncolumns]; NaN: not measured */
  double *model;         /* [nrows * ncolumns] the fitted motion; NaN behind its end */
  int trains;            /* 1: targets are weights of networks, whose search is another one */
  int huber;             /* 1: residuals count linearly beyond 1.345 errors */
  int most;              /* steps of the search */
  int parts;             /* of each record, solved together; 0: chosen by the growth of small changes */
  /* results */
  int converged, steps, evaluations, nvalues, nflat;
  double chi_squared, freedom; /* of residuals with weights, priors included */
  int known_errors;            /* 1: the errors of all columns are given */
  double *correlation;         /* [n * n] */
  double *singular;            /* [n] of the scaled Jacobian, relative to the largest */
  FitDirection *flat;          /* [nflat] */
  double *directions;          /* their changes; behind them that of the flattest other direction: */
  FitDirection weakest;
  char why[400];
  struct FitNodes *nodes;      /* multiple shooting (fit_residuals.h); NULL: records are one part each */
  /* within a search */
  int part;                            /* the first 1/part of each record counts */
  int *mine, nmine;                    /* [n] targets of the record that runs */
  double steps_of_run, steps_of_first; /* a run may take 50 times as many steps as the longest of the first runs */
  double *centre, pull;                /* [n] coordinates to which weak springs of this stiffness hold the search */
  int held;                            /* 1 + a target, held at a coordinate by a stiff spring; 0: none */
  double held_at;
  double *y, *row, *D;                 /* scratch */
} Fit;
