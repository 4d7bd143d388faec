/* Dry friction of joints in one step of moreau: the instance of kernels/joint_friction.h for a lag_problem. */
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
  lag_joint_friction of; /* first */
  double *at, *all;      /* [n] the model's switch; [nswitch] its values */
  double *entry;         /* [n] modes in pb->hold before the step */
  double *coupled;       /* room of kernels/coupled_friction.h */
} JointFriction;

size_t lag_joint_friction_size(const lag_problem *pb);
JointFriction lag_joint_friction_of(const lag_problem *pb, double *room);

/* Modes before the step: noted, and brought back after a failure. */
void lag_joint_friction_enter(JointFriction *w, lag_problem *pb);
void lag_joint_friction_back(const JointFriction *w, lag_problem *pb);
/* Beside contacts: modes in pb->hold of surfaces that stick at their limit differ from those of slipping bodies. */
void lag_joint_friction_stick(JointFriction *w, lag_problem *pb);
