/* Saved state of the Verlet family, for verlet.c and for its steps over lanes (lanes/verlet_lanes.h). */
#pragma once

#include "kernels/composition.h"
#include "methods/steps.h"

/* Saved state of the explicit methods, doubles only; x holds the arrays of n named below, then the path of
 * step_interpolant.h. */
typedef struct Verlet {
  lag_fixed_step step;
  double ready;     /* 1: F1 = f(t, y) is known */
  double have_path; /* dense output: 1 built, -1 failed, 0 not built */
  double x[];
} Verlet;

/* f = [v|a] and y at both ends; increments of y; compensation of y before and after. */
enum { VERLET_F0, VERLET_F1, VERLET_Y0, VERLET_Y1, VERLET_DY, VERLET_COMP, VERLET_COMP1, VERLET_NARRAYS };

/* A method of the family: its table for separable models, and the one for others. */
typedef struct VerletMember {
  const lag_composition *separable, *any;
} VerletMember;
