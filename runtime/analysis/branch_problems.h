/* The equations of continuation.h for two kinds of solutions: states of rest, and periodic motions. */
#pragma once

#include "analysis/continuation.h"
#include "analysis/periodic_orbit.h"

/* States of rest over a parameter of the model: velocities are 0, accelerations and rates of states vanish. */
typedef struct RestBranch {
  Pool pool;
  FlowMap flow;
  const lag_algebra *algebra;
  BranchProblem problem;
  int n, cols, rows; /* coordinates and states; with the parameter; with constraints on positions */
  const char *name;
  double parameter, parameter_unit;
  double *unit, *row; /* [n], [rows] sizes of unknowns, and of rows once they are known (0) */
  double *y;          /* [2 nq + nz] the state */
  double *rates, *up, *down, *J, *v, *room;
} RestBranch;

/* like: as of lag_flow_open, with its start near a state of rest. size: of the parameter's range. LAG_OK, or a status
 * with its message in flow; LAG_EMETHOD: the model depends on time. */
int lag_rest_branch_open(RestBranch *r, lag_sim *like, const lag_algebra *algebra, const char *name, double value,
                         double size);
void lag_rest_branch_free(RestBranch *r);
/* The periodic motions that leave a Hopf point: o, which is open then and solved for a small amplitude, with a start
 * from *like, which must outlive it; d[cols]: the direction of growing amplitude. 1: found, 0: not, < 0: a status. */
int lag_hopf_orbit(RestBranch *r, const BranchPoint *at, PeriodicOrbit *o, lag_sim **like, BranchProblem *p,
                   double **d);
/* u[cols] := the present unknowns. */
void lag_rest_branch_unknowns(const RestBranch *r, double *u);

/* Periodic motions: an orbit that is open, solved, and has `continues`, `led`, `name` and `parameter` set. */
void lag_orbit_branch(BranchProblem *p, PeriodicOrbit *o);
void lag_orbit_branch_unknowns(const PeriodicOrbit *o, double *u);
