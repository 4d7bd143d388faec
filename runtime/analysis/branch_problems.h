/* The equations of continuation.h for two kinds of solutions: states of rest, and periodic motions. */
#pragma once

#include "analysis/continuation.h"
#include "analysis/equilibrium.h"
#include "analysis/periodic_orbit.h"

/* States of rest over a parameter of the model: velocities are 0, accelerations and rates of states vanish. */
typedef struct RestBranch {
  Pool pool;
  FlowMap flow;
  const lag_algebra *algebra;
  BranchProblem problem;
  int n, cols;          /* coordinates and states; with the parameter */
  const char *name;
  double parameter, parameter_unit;
  double *unit, *row;   /* [n] sizes of unknowns, and of rows once they are known (0) */
  double *y;            /* [2 nq + nz] the state */
  double *rates, *up, *down, *J, *v;
} RestBranch;

/* like: as of lag_flow_open, with its start near a state of rest. size: of the parameter's range. LAG_OK, or a status
 * with its message in flow; LAG_EMETHOD: the model has constraints, or depends on time. */
int lag_rest_branch_open(RestBranch *r, lag_sim *like, const lag_algebra *algebra, const char *name, double value,
                         double size);
void lag_rest_branch_free(RestBranch *r);
/* u[cols] := the present unknowns. */
void lag_rest_branch_unknowns(const RestBranch *r, double *u);

/* Periodic motions: an orbit that is open, solved, and has `continues`, `led`, `name` and `parameter` set. */
void lag_orbit_branch(BranchProblem *p, PeriodicOrbit *o);
void lag_orbit_branch_unknowns(const PeriodicOrbit *o, double *u);
