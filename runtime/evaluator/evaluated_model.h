/* Models, scenes and their parts whose functions execute programs. Each begins with the structure of lag_model.h that
 * holds its functions, so that `self` leads to the programs. */
#ifndef EVALUATOR_EVALUATED_MODEL_H
#define EVALUATOR_EVALUATED_MODEL_H

#include "evaluator/program.h"
#include "lag_model.h"

/* An event: what it does, or the constraint and the input of the contact that strikes. */
typedef struct {
  const Program *action;
  int stop, strikes, constraint, input;
} EvaluatedEvent;

typedef struct {
  lag_model model;
  const Program *derive, *inputs, *accel, *energy, *events, *impact, *sizes, *moving_sizes, *variation, *second,
      *inverse, *switch_values, *switch_rates, *switch_grips, *contact_laws, *guide_loads;
  const EvaluatedEvent *event;
  int nconstraints;
} EvaluatedModel;

typedef struct {
  lag_constraints constraints;
  const Program *residuals, *matrices, *position, *velocity;
} EvaluatedConstraints;

typedef struct {
  const Program *values, *reach;
} EvaluatedFamily;

typedef struct {
  lag_contact_families families;
  const EvaluatedFamily *of;
  const Program *inertia;
} EvaluatedFamilies;

typedef struct {
  lag_charges charges;
  const Program *values, *powers;
} EvaluatedCharges;

typedef struct {
  lag_kepler kepler;
  const Program *values;
} EvaluatedKepler;

typedef struct {
  lag_partials partials;
  const Program *eval;
} EvaluatedPartials;

typedef struct {
  lag_adjoint adjoint;
  const Program *eval, *rates, *project;
} EvaluatedAdjoint;

typedef struct {
  lag_linear linear;
  const Program *eval, *jumps;
} EvaluatedLinear;

/* Sums of products of coefficients, with the columns of their factors: products of different values, then squares from
 * first_square on. near: summed in the order of the C text that keeps the last order in registers. */
typedef struct {
  lag_taylor taylor;
  int nq, nz, sums, squares, first_square, row, constants, uses_time, near;
  const Program *first, *next;
} EvaluatedTaylor;

typedef struct {
  lag_action_curve curve;
  const Program *of, *momenta;
} EvaluatedAction;

/* Values of the next n parameters, none of which reads another of them. */
typedef struct {
  int n;
  const Program *values;
} EvaluatedParams;

typedef struct {
  lag_scene scene;
  const EvaluatedModel *of;
  const EvaluatedParams *params;
  int nparams;
  const Program *start, *observe, *exact;
  int nactions, nrow; /* nrow: inputs, modes and closed forms that observe finds in u */
  const EvaluatedAction *action;
} EvaluatedScene;

/* Set the functions of what has programs. */
void lag_set_model_functions(EvaluatedModel *m);
void lag_set_scene_functions(EvaluatedScene *s);
void lag_set_taylor_functions(EvaluatedTaylor *t);
void lag_set_constraint_functions(EvaluatedConstraints *c);
void lag_set_family_functions(EvaluatedFamilies *f, lag_contact_family *of);
void lag_set_charge_functions(EvaluatedCharges *c);
void lag_set_kepler_functions(EvaluatedKepler *k);
void lag_set_linear_functions(EvaluatedLinear *l);
void lag_set_partial_functions(EvaluatedPartials *p);
void lag_set_adjoint_functions(EvaluatedAdjoint *a);
void lag_set_action_functions(EvaluatedAction *a);

/* Doubles that functions of a model, of a scene and of a series need in w. */
size_t lag_model_room(const EvaluatedModel *m);
size_t lag_scene_room(const EvaluatedScene *s);
size_t lag_taylor_room(const EvaluatedTaylor *t);

#endif
