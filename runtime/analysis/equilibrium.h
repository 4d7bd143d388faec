/* Equilibria: q' = 0 and every force balanced. Enters: a simulation before its first step; leaves: the state where
 * it would stay. */
#pragma once

#include "analysis/memory_pool.h"
#include "core/core.h"

/* The model at rest. Unknowns x[n], n = nq + nz, are coordinates and states over their scale; equations are forces
 * times that scale, so energies, and rates over it. */
typedef struct Equilibrium {
  Pool pool;
  lag_sim *sim;
  int n;
  double *start, *found; /* [n] start of the simulation, and the equilibrium, in SI */
  double *y;      /* [2 nq + nz] the state at rest, or the last one tried */
  double *rate;   /* [2 nq + nz] y' there */
  double *scale;  /* [n] scales: of angles 1 rad, else the largest start in that unit, or one unit */
  int steps;      /* that it took */
  int worst;      /* not found: the equation with the largest unbalanced force, */
  int away;       /* 1: forces only fade, far away */
  /* [n] unknowns: now, at the start, and points of the search */
  double *x, *begin, *from, *first, *trial, *near, *kept;
  double *f, *row, *J, *W; /* equations, their row scales, their derivatives; friction matrix */
  double *dx, *step;       /* [n] Newton step; right-hand side */
  double *values, *noise, *scratch; /* [n + n * n] f and J, and their perturbation noise */
  double *spread; /* [n] uncertainty of the root x, by rounding */
  int pole;       /* 1: a coordinate loses its meaning here, as longitude does at a pole */
  int rough;      /* 1: derivatives of forces jump here, or have no limit */
  int held;       /* 1: forces jump with velocities that are 0 here, as dry friction does */
  double delta;
  double *dr, *M, *work;   /* of lag_linearise */
} Equilibrium;

/* Finds an equilibrium from the simulation's start (velocities do not matter) by algebra->root, stable or not. If
 * none is within one scale of the start, it follows the overdamped motion, with all inertia replaced by friction, to
 * rest; it takes any other root last. Unknowns that no force determines keep their start. The model must not depend
 * on time. 1: found. 0: not found, see worst and rate. < 0: a status; LAG_EDOMAIN and others from the model: no
 * values at the start. Call lag_equilibrium_free in every case. */
int lag_equilibrium_find(Equilibrium *rest, lag_sim *sim, const lag_algebra *algebra);
void lag_equilibrium_free(Equilibrium *rest);

/* Whether the state at rest moved by c dx[n] (in SI) is a root, or another one lies near that place, nearer than the
 * first one: then they form a curve. */
int lag_equilibrium_continues(Equilibrium *rest, const double *dx, double c);

/* A switch at which a force jumps at the state y[2 nq + nz]: at rest dry friction, which holds what rests. NULL:
 * none. */
const lag_switch *lag_jump_at(lag_sim *sim, const double *y);

/* y := the state at rest for the unknowns x[n]. */
void lag_equilibrium_state(Equilibrium *rest, const double *x);

/* out[] := values at the unknowns x[n] with the parameters of r->sim->pb.p. Not 0: no values. */
typedef int lag_values(Equilibrium *r, const double *x, double *out);

/* Parameters and unknowns are numbers of 53 bits, so values of a model are known no better than rounding of these
 * lets them be. noise[count] := sum over all parameters and unknowns of |change of values[count] at x| when one of
 * them changes by DBL_EPSILON of itself; base[count] := the values. With more than 32 parameters and unknowns
 * several are perturbed at once. Perturbations without values are skipped. scratch[count + np + nderived + n]. 0, or
 * the status of `values` at x. */
int lag_perturbation_noise(Equilibrium *r, lag_values *values, const double *x, size_t count, double *base,
                           double *noise, double *scratch);
