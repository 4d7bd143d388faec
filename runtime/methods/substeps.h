/* Shared by the files of implicit steps: implicit_symplectic.c (steps and their derivatives), substeps.c (one substep) and rattle.c (constraints). A step is
 * a chain of substeps; a substep is the step of one discrete Lagrangian. */
#ifndef LAG_METHODS_SUBSTEPS_H
#define LAG_METHODS_SUBSTEPS_H

#include <stddef.h>

#include "lag.h"
#include "methods/composition.h"
#include "methods/galerkin_rule.h"
#include "methods/steps.h"

/* Saved state of the method, doubles only; ImplicitArrays has pointers into x. */
typedef struct Implicit {
  lag_fixed_step step;
  double ready;     /* 1: p belongs to the present q and v */
  double have_path; /* dense output: 1 built, -1 Hermite only, -2 cubic only, 0 not built */
  double order, substeps;            /* order of the method, substeps a step */
  double part[2 * LAG_MAX_DRIFTS]; /* lengths of the substeps, parts of h */
  lag_rule rule[2], momentum;     /* rules of even and odd substeps; rule of v from p */
  double x[];
} Implicit;

/* A block: substeps that end on the constraints together. Only for models with constraints. The impulse at its start brings its end to the
 * constraints. */
typedef struct ConstraintBlock {
  double *from, *to;                   /* [n] start and end, [q|v] */
  double *dq, *dp, *impulse, *d, *force; /* [nq] increments of the step up to the block; impulse; a least change and its force */
  double *c, *r, *g, *sum;             /* [constraints] residuals; a requested change g, and the sum of all g, which determines the impulse */
  double *A, *M;                       /* nonzero entries of the constraint Jacobian and of M, as in lag_constraints */
  double *change, *end_jacobian;             /* [constraints nq], [constraints constraints]; see rattle.c */
  double *history;                     /* history of `sum` in each block, for the first guess */
} ConstraintBlock;

/* qc, pc: compensations of q and p; dq, dp: increments of this step; ql = qc + dq, pl = pc + dp. */
typedef struct ImplicitArrays {
  double *p, *qc, *pc, *dq, *dp, *ql, *pl, *v; /* [nq] */
  double *y0, *y1, *f0, *f1;                   /* [n] y at both ends of the last step, and f there for dense output */
  double *u, *force;                           /* [2 free nq] velocities of the substeps of a block; [points nq] forces */
  double *history;                             /* histories of u in each substep, then of v */
  double *path, *discrete;                     /* scratch of step_interpolant.h and discrete_lagrangian.h */
  ConstraintBlock block;
} ImplicitArrays;

/* Doubles of the state, for rules with this number of free velocities; and pointers into it. */
size_t lag_substeps_size(const lag_problem *pb, int free, int substeps);
ImplicitArrays lag_substeps_arrays(Implicit *w, const lag_problem *pb);
/* Doubles of the history of one substep. */
size_t lag_substep_history(const lag_problem *pb, const Implicit *w);

/* ql := qc + dq, pl := pc + dp: the present q and p less those at the start of the step. */
void lag_substeps_gather(const ImplicitArrays *a, int nq);

/* Solves substep k, which begins at t + at dt of the step from y at t: velocities u and forces; adds its increments to dq and dp. known: u holds
 * a guess. LAG_OK, or a failure with time and reason in pb. */
int lag_substep(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, double t, const double *y, double dt, int k, double at, double *u,
             int known);
/* Appends the velocities u of substep k to its history. */
void lag_substep_record(const Implicit *w, const ImplicitArrays *a, const lag_problem *pb, int k, const double *u);

/* Solves dL/dv(q, v) = p for a->v at the present q and p. known: a->v holds a guess. */
int lag_substeps_velocity(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, double tb, const double *y, int known);

/* All substeps of a step of a model with constraints, and a->v at its end, tb. */
int lag_rattle(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, double t, double tb, const double *y, double dt);

#endif
