/* Dry friction of joints and sliders in one step of moreau. Enters: coordinates at the middle of a step, velocities and
 * states at its end; leaves: those with friction that holds or brakes, and its modes. */
#pragma once

#include "core/rhs.h"

/* Room of a method, for n surfaces on which bodies may stick: the first two arrays last from step to step, the
 * others are scratch. A mode is the mean of sign(slip) in a step: friction in parts of its size. */
typedef struct JointFriction {
  int n;
  double *mode, *sticks;    /* [n] in the last step; whether that held it */
  double *at;               /* [n] the model's switch */
  double *bound, *response; /* [n] the largest mode; change of the slip by a mode of 1 */
  double *before, *centre;  /* [n] slip at the begin; middle of the interval from there to the slip aimed at */
  double *was, *entry;      /* [n] modes before a round; in pb->hold before the step */
  double *change, *stride;  /* [n] change by the last round, and strides in parts of it */
  double *slip, *other;     /* [nswitch] */
  double *d, *x;            /* [n states] rates for a mode of 1; [states] */
} JointFriction;

size_t lag_joint_friction_size(const lag_problem *pb);
JointFriction lag_joint_friction(const lag_problem *pb, double *room);

/* Slips at the begin of the step from y at t, and bounds. back: modes before the step, after a failure. These and
 * the next return 0, or the status of the step. */
int lag_joint_friction_begin(JointFriction *w, lag_problem *pb, double t, const double *y);
void lag_joint_friction_back(JointFriction *w, lag_problem *pb);
/* d and response from `mid`, the middle at tm, and x, the end at t without contacts. */
int lag_joint_friction_response(JointFriction *w, lag_problem *pb, double tm, double t, double h, const double *mid,
                                const double *x);
/* x := velocities and states with friction, in pb->hold its modes; struck: the step has an impact. *moved: the
 * largest change of a slip by this call, in units of the largest slip. */
int lag_joint_friction_solve(JointFriction *w, lag_problem *pb, double t, double h, int struck, const double *mid,
                             double *x, double *moved);
/* Beside contacts, once all agree at x: notes the surfaces whose slip is 0 there; friction may be at its limit where
 * contacts hold the body, too. */
int lag_joint_friction_note(JointFriction *w, lag_problem *pb, double t, const double *mid, const double *x);
/* Goes on by longer strides on surfaces whose mode changes in the same direction round by round, as where contacts
 * leave a slip that is small beside what friction changes: then friction comes to its limit by small equal steps. */
void lag_joint_friction_lengthen(JointFriction *w, lag_problem *pb);
/* x[n] := x + part times what the last calls of solve and lengthen changed. */
void lag_joint_friction_carry(const JointFriction *w, const lag_problem *pb, double part, double *x);
