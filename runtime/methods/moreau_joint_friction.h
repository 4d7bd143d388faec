/* Dry friction of joints and sliders in one step of moreau: the instance of kernels/joint_friction.h for a lag_problem,
 * and its turns beside contacts. */
#pragma once

#include "methods/steps.h"

/* Calls of the model with modes as held; each returns 0 or the status of the step. */
struct lag_joint_friction;
void lag_joint_friction_hold(lag_problem *pb, struct lag_joint_friction *w, int j, double mode);
int lag_joint_friction_slips(lag_problem *pb, double t, const double *y, const double *x,
                             const struct lag_joint_friction *w, double *g);
int lag_joint_friction_grips(lag_problem *pb, double t, const double *y, const struct lag_joint_friction *w, double *g);
int lag_joint_friction_fails(lag_problem *pb, double t, const struct lag_joint_friction *w, int j, const char *words);

#define LAG_MODEL lag_problem *pb
#define LAG_THE_MODEL pb
#define LAG_JOINTS(w) (w)->n
#define LAG_HOLD(w, j, value) lag_joint_friction_hold(pb, w, j, value)
#define LAG_SLIPS(t, y, x, w, g) lag_joint_friction_slips(pb, t, y, x, w, g)
#define LAG_GRIPS(t, y, w, g) lag_joint_friction_grips(pb, t, y, w, g)
#define LAG_MODE_RATES(t, y, w, k) lag_step_rhs(pb, t, y, k)
#define LAG_FRICTION_FAILS(t, j, words) lag_joint_friction_fails(pb, t, w, j, words)
#include "kernels/joint_friction.h"

/* The kernel's part lasts from step to step; the rest is scratch. */
typedef struct JointFriction {
  lag_joint_friction of;    /* first */
  double *at, *all;         /* [n] the model's switch; [nswitch] its values */
  double *entry, *was;      /* [n] modes in pb->hold before the step; before a round */
  double *change, *stride;  /* [n] change by the last round, and strides in parts of it */
} JointFriction;

size_t lag_joint_friction_size(const lag_problem *pb);
JointFriction lag_joint_friction_of(const lag_problem *pb, double *room);

/* Modes before the step: noted, and brought back after a failure. */
void lag_joint_friction_enter(JointFriction *w, lag_problem *pb);
void lag_joint_friction_back(const JointFriction *w, lag_problem *pb);
/* A round of lag_joints_solve. *moved: the largest change of a slip, in units of the largest slip. */
int lag_joint_friction_round(JointFriction *w, lag_problem *pb, const lag_kick *s, int struck, double *moved);
/* Beside contacts, once all agree: notes the surfaces whose slip is 0 at the end; friction may be at its limit where
 * contacts hold the body, too. */
int lag_joint_friction_note(JointFriction *w, lag_problem *pb, const lag_kick *s);
/* Goes on by longer strides on surfaces whose mode changes in the same direction round by round, as where contacts
 * leave a slip that is small beside what friction changes: then friction comes to its limit by small equal steps. */
void lag_joint_friction_lengthen(JointFriction *w, lag_problem *pb);
/* x[n] := x + part times what the last calls of round and lengthen changed. */
void lag_joint_friction_carry(const JointFriction *w, double part, double *x);
