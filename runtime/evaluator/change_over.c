/* From evaluated functions to compiled ones, which have the same bits and ignore their first argument. */
#include <string.h>

#include "evaluator/evaluator.h"

/* Structures of the evaluator are const to all others. */
#define MUTABLE(Type, x) ((Type *)(size_t)(const void *)(x))

static int is_same_model(const lag_model *x, const lag_model *y) {
  int same = y->abi == LAG_ABI && y->real_size == x->real_size && strcmp(x->digest, y->digest) == 0 && y->nw <= x->nw &&
             x->nq == y->nq && x->nz == y->nz && x->np == y->np && x->nu == y->nu && x->nderived == y->nderived;
  int parts = !x->constraints == !y->constraints && !x->charges == !y->charges && !x->linear == !y->linear &&
              (x->families ? x->families->n : 0) == (y->families ? y->families->n : 0) &&
              !x->taylor == !y->taylor && !x->kepler == !y->kepler && !x->variation == !y->variation;
  return same && parts &&
         (!x->taylor || (y->taylor->nw <= x->taylor->nw && x->taylor->columns == y->taylor->columns &&
                         x->taylor->order == y->taylor->order));
}

static void change_model(const lag_model *evaluated, const lag_model *y) {
  lag_model *x = MUTABLE(lag_model, evaluated);
  x->derive = y->derive, x->inputs = y->inputs, x->accel = y->accel, x->energy = y->energy, x->events = y->events;
  x->act = y->act, x->size_values = y->size_values, x->moving_sizes = y->moving_sizes, x->variation = y->variation;
  x->second = y->second, x->switch_values = y->switch_values, x->switch_rates = y->switch_rates;
  x->switch_grips = y->switch_grips, x->contact_laws = y->contact_laws, x->inverse = y->inverse;
  x->guide_loads = y->guide_loads;
  if (x->constraints) {
    lag_constraints *k = MUTABLE(lag_constraints, x->constraints);
    k->residuals = y->constraints->residuals, k->matrices = y->constraints->matrices;
    k->position = y->constraints->position, k->velocity = y->constraints->velocity;
  }
  for (int i = 0; x->families && i < x->families->n; i++) {
    lag_contact_family *f = MUTABLE(lag_contact_family, &x->families->of[i]);
    f->values = y->families->of[i].values, f->reach = y->families->of[i].reach;
  }
  if (x->families) MUTABLE(lag_contact_families, x->families)->inertia = y->families->inertia;
  if (x->charges) {
    lag_charges *k = MUTABLE(lag_charges, x->charges);
    k->values = y->charges->values, k->powers = y->charges->powers;
  }
  if (x->linear) {
    lag_linear *k = MUTABLE(lag_linear, x->linear);
    k->eval = y->linear->eval, k->jumps = y->linear->jumps;
  }
  if (x->kepler) MUTABLE(lag_kepler, x->kepler)->values = y->kepler->values;
  if (x->taylor) {
    lag_taylor *k = MUTABLE(lag_taylor, x->taylor);
    k->first = y->taylor->first, k->rest = y->taylor->rest, k->at = y->taylor->at, k->along = y->taylor->along;
  }
}

int lag_program_change_over(const lag_program *evaluated, const lag_program *compiled) {
  int same = evaluated->nscenes == compiled->nscenes;
  for (int i = 0; same && i < evaluated->nscenes; i++)
    same = is_same_model(evaluated->scenes[i]->model, compiled->scenes[i]->model) &&
           evaluated->scenes[i]->nout == compiled->scenes[i]->nout;
  for (int i = 0; same && i < evaluated->nscenes; i++) {
    const lag_scene *y = compiled->scenes[i];
    lag_scene *x = MUTABLE(lag_scene, evaluated->scenes[i]);
    x->params = y->params, x->start = y->start, x->observe = y->observe, x->exact = y->exact;
    change_model(x->model, y->model);
  }
  return same;
}
