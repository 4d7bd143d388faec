/* Statements of the text on a tape: what the energies, forces, flows, constraints, events and outputs of a model are, as they stand there. */
#ifndef LAGC_STATEMENTS_H
#define LAGC_STATEMENTS_H

#include "jets/text.h"

/* A force f along the displacement of `point`; or a torque (three components) on a rotation (four). */
typedef struct {
  Ref point[4], f[3];
  int torque;
} TextForce;

typedef struct {
  SymKind kind; /* of what it sets: SYM_COORD, SYM_VEL, SYM_STATE */
  uint32_t index, event;
  Ref value;
} TextAction;

/* 0 in place of a Ref: the text has no such statement, or it says what tapes do not know (`why` names it). */
typedef struct {
  Tape *tape;
  Ref lagrangian, dissipation;
  VEC(TextForce) forces;
  Ref *flows;       /* [states] */
  Ref *constraints; /* [constraints of the model]: left side less right side; of contacts: the gap while closed */
  const char *why;  /* NULL: all of it is known */
} TextDynamics;

typedef struct {
  Tape *tape;
  Ref *events;  /* [events of the model] */
  VEC(TextAction) actions;
  Ref *outputs; /* [outputs of the scene] */
  unsigned char *is_energy; /* [outputs of the scene] just `energy`: no formula, as the energy itself is compared */
  Ref *signals; /* [inputs of the model]: their formulas */
} TextOutputs;

TextDynamics *text_dynamics(const Model *m, Arena *a);
TextOutputs *text_outputs(const Model *m, const Output *outputs, uint32_t noutputs, Arena *a);

#endif
