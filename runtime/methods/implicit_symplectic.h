/* Implicit symplectic methods for any L, in q and p: a step is a chain of substeps, each the step of one discrete
 * Lagrangian (galerkin_rule.h), solved by Newton's method (discrete_lagrangian.h). */
#pragma once

#include "lag.h"
#include "kernels/composition.h"
#include "kernels/galerkin_rule.h"
#include "methods/steps.h"

/* Doubles of state: for one rule with this number of free velocities, or for a composition of symplectic Euler and
 * its adjoint. */
size_t lag_implicit_size(const lag_problem *pb, int free);
size_t lag_implicit_composed_size(const lag_problem *pb, const lag_composition *c);

/* Prepares steps of size h by one rule of this order, or by a composition. */
void lag_implicit_init(void *work, lag_problem *pb, double h, int order, const lag_rule *rule);
void lag_implicit_compose(void *work, lag_problem *pb, double h, const lag_composition *c);

/* Members of lag_method of the same names. Forces enter by the discrete Lagrange-d'Alembert principle at the points
 * of the rules. */
void lag_implicit_reset(void *work, lag_problem *pb);
int lag_implicit_step(void *work, lag_problem *pb, double *t, double *y, double t_stop);
void lag_implicit_dense(void *work, lag_problem *pb, double t, double *y);

/* Derivative of the last step, or of a shorter step from the same start, in q and v. */
size_t lag_implicit_tangent_size(const lag_problem *pb, int k);
int lag_implicit_tangent(void *work, lag_problem *pb, double t, int k, double *Y, double *scratch);

/* ---- Shared with rattle.c */

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

/* A block: substeps that end on the constraints together. Only for models with constraints. The impulse at its start
 * brings its end to the constraints. */
typedef struct ConstraintBlock {
  double *from, *to;                   /* [n] start and end, [q|v] */
  /* [nq] increments of the step up to the block; impulse; a least change and its force */
  double *dq, *dp, *impulse, *d, *force;
  /* [constraints] residuals; a requested change g, and the sum of all g, which determines the impulse */
  double *c, *r, *g, *sum;
  double *A, *M;                       /* nonzero entries of the constraint Jacobian and of M, as in lag_constraints */
  double *change, *end_jacobian;             /* [constraints nq], [constraints constraints]; see rattle.c */
  double *history;                     /* history of `sum` in each block, for the first guess */
} ConstraintBlock;

/* qc, pc: compensations of q and p; dq, dp: increments of this step; ql = qc + dq, pl = pc + dp. */
typedef struct ImplicitArrays {
  double *p, *qc, *pc, *dq, *dp, *ql, *pl, *v; /* [nq] */
  double *y0, *y1, *f0, *f1;                   /* [n] y at both ends of the last step, and f there for dense output */
  /* [2 free nq] velocities of the substeps of a block; [points nq] forces */
  double *u, *force;
  double *history;                             /* histories of u in each substep, then of v */
  double *path, *discrete;                     /* scratch of step_interpolant.h and discrete_lagrangian.h */
  ConstraintBlock block;
} ImplicitArrays;

/* ql := qc + dq, pl := pc + dp: the present q and p less those at the start of the step. */
void lag_substeps_gather(const ImplicitArrays *a, int nq);

/* Substep k of a step of dt from y at t; it begins at t + at dt. */
typedef struct Substep {
  int k;
  double t, dt, at;
  const double *y;
} Substep;

/* Solves a substep: velocities u and forces; adds its increments to dq and dp. known: u holds a guess. LAG_OK, or a
 * failure with time and reason in pb. */
int lag_substep(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, const Substep *s, double *u, int known);
/* Appends the velocities u of substep k to its history. */
void lag_substep_record(const Implicit *w, const ImplicitArrays *a, const lag_problem *pb, int k, const double *u);

/* Solves dL/dv(q, v) = p for a->v at the present q and p. known: a->v holds a guess. */
int lag_substeps_velocity(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, double tb, const double *y,
                          int known);

/* All substeps of a step of a model with constraints, and a->v at its end, tb. */
int lag_rattle(const Implicit *w, const ImplicitArrays *a, lag_problem *pb, double t, double tb, const double *y,
               double dt);
