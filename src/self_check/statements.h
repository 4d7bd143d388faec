/* Statements of the text on tapes: energies, forces, flows and constraints (TextDynamics); events, outputs and
 * inputs (TextOutputs). */
#pragma once

#include "self_check/direct_eval.h"

/* Force f along the displacement of `point`; or a torque (f: 3 components) on a rotation (point: 4). */
typedef struct {
  Ref point[4], f[3];
  int torque;
} TextForce;

typedef struct {
  SymKind kind; /* kind of the target: SYM_COORD, SYM_VEL, SYM_STATE */
  uint32_t index, event;
  Ref value;
} TextAction;

/* A member of a family of contacts: gap, restitution, friction, tangential restitution, static friction, slips. */
typedef struct {
  uint32_t family;
  int64_t row, turn;
  Ref value[7];
} TextMember;

/* Ref 0: the text has no such statement, or it contains a construct that tapes cannot evaluate (`why`). Memory is
 * the arena's. */
typedef struct {
  Tape *tape;
  Ref lagrangian, dissipation;
  VEC(TextForce) forces;
  Ref *flows;       /* [states] */
  Ref *constraints; /* [constraints of the model] left side minus right side; contacts: closed*gap */
  const char *why;  /* construct that was not evaluated; NULL: none */
} TextDynamics;

typedef struct {
  Tape *tape;
  Ref *events;  /* [events of the model] */
  VEC(TextAction) actions;
  VEC(TextMember) members; /* of each family of contacts the first and the last one */
  Ref *outputs; /* [outputs of the scene] */
  /* [outputs of the scene] 1: the name `energy` alone, compared with the energy instead of a formula */
  unsigned char *is_energy;
  Ref *signals; /* [inputs of the model] their formulas */
} TextOutputs;

TextDynamics *text_dynamics(const Model *m, int samples, Arena *a);
TextOutputs *text_outputs(const Model *m, int samples, Arena *a);
