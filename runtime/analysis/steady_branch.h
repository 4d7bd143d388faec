/* Steady motions (steady_motion.h) over a parameter, a charge or a component of the state: the equations of
 * continuation.h. Unknowns: the state, the motion as a sum of symmetries, the parameter. */
#pragma once

#include "analysis/continuation.h"
#include "analysis/periodic_orbit.h"
#include "analysis/steady_motion.h"

typedef struct SteadyBranch {
  Pool pool;
  FlowMap flow;
  SteadyMotion steady;
  Equilibrium rest; /* what the search needs besides */
  const lag_algebra *algebra;
  BranchProblem problem;
  int n, rows, cols;
  int nheld;
  OrbitHold held[ORBIT_MOST_HELD]; /* set before opening; values are those of the start */
  int led;                         /* the condition whose value is the parameter; -1: a parameter of the model */
  const char *name;
  double parameter, parameter_unit;
  double rate; /* unit of the motion's coefficients [1/s] */
  double *row; /* [rows] sizes of rows, once they are known */
  double *X, *DX, *e, *up, *down;
} SteadyBranch;

/* like: as of lag_flow_open, with its start near a steady motion. The members held, nheld, led, name, parameter and
 * parameter_unit are set before. LAG_OK, or a status with its message in flow. Free in any case. */
int lag_steady_branch_open(SteadyBranch *s, lag_sim *like, const lag_algebra *algebra);
void lag_steady_branch_free(SteadyBranch *s);
/* u[cols] := the present unknowns; the parameter becomes the value of the condition that leads. */
void lag_steady_branch_unknowns(SteadyBranch *s, double *u);
