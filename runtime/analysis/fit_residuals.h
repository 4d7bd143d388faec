/* Residuals of a fit, and their derivatives by the coordinates of its targets. With multiple shooting a record has
 * parts, each with a start of its own, a node, and the gaps between them are residuals, too. */
#pragma once

#include "analysis/fit_problem.h"

typedef struct FitNodes {
  int n, ns;          /* nodes, and components of a state */
  int active;         /* parts of each record that count; the others follow */
  int *at, *row;      /* [nrows] node where a part begins at this row, -1: none; [n] the row */
  double *y, *unit;   /* [n ns] states; [ns] sizes of their components */
  double *gap, *by;   /* [n ns] end of the part before less y, in units; [n ns (targets + ns)] by the part's columns */
  double tie;         /* weight of gaps */
  lag_scene scene;    /* of the part that runs: at its time */
} FitNodes;

/* Coordinates: logarithms of values with a sign, others in units of their scale. The value at x, and its slope. */
double lag_fit_coordinate(const FitTarget *t, double value);
/* Below it a value ">= 0" is on its bound. */
double lag_fit_softened(const FitTarget *t);
double lag_fit_value_at(const FitTarget *t, double x, double *slope);
void lag_fit_take_values(Fit *f, const double *x, double *slope);
int lag_fit_fail(Fit *f, int status, const char *why);

/* Values in the first 1/part of each record, and priors: f->nvalues. */
int lag_fit_count_values(Fit *f, int part);
/* Row behind those of record k that count; row behind the part that begins at row i. */
int lag_fit_end_row(const Fit *f, int k);
int lag_fit_part_end(const Fit *f, int i, int end);
/* Columns of a derivative: targets, and the state of the part's node. */
int lag_fit_width(const Fit *f);

/* A simulation of record k, or of the part that begins at a node, with the present values; sensitive: with a column for
 * each of its targets and each component of its node. */
lag_sim *lag_fit_simulation(Fit *f, int k, int node, int sensitive);
/* The run at time t; -: the motion ends before. */
int lag_fit_advance(Fit *f, lag_sim *sim, double t);
/* The residual of a value, weighted, and its derivative by the output `got`, which it notes; NaN: not measured. */
double lag_fit_residual(const Fit *f, int i, int c, double got, double *slope);
/* r[nvalues] and J[nvalues width] of records and priors at the present values; NULL: not wanted. */
int lag_fit_run_rows(Fit *f, const double *slope, double *r, double *J);
/* lag_residuals_at: with springs to f->centre in the last n residuals. */
int lag_fit_residuals(void *fit, const double *x, double *r, double *J);

/* fit.c. Values ">= 0" that a shorter record has driven to 0, where they hardly move any more, begin again just above.
 */
void lag_fit_leave_bounds(const Fit *f, double *x);
/* fit_training.c. From the coordinates x of all targets, weights of networks among them; no errors, no directions. */
int lag_fit_train(Fit *f, double *x);

/* fit_shooting.c. Nodes by the growth of small changes along the motions at the present values, or f->parts; without
 * force none where it stays small. LAG_OK, or a status with its reason. */
int lag_fit_place_nodes(Fit *f, int force);
void lag_fit_nodes_free(Fit *f);
double lag_fit_widest_gap(const Fit *f);
/* The search over targets x and nodes: where grows from the first part to all, then with ever stiffer ties. */
int lag_fit_shoot(Fit *f, int grows, double *x);
/* J[n n] := the triangle of derivatives by the targets from which the nodes are eliminated. r: residuals. */
int lag_fit_eliminate(Fit *f, const double *r, const double *J, double *triangle);
