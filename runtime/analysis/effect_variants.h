/* Comparison of a scene with variants that have other sets of effects. Enters: simulations at their start; leaves:
 * difference of each motion from the scene's, difference of accelerations, time of a call of the right-hand side. */
#pragma once

#include "analysis/work_precision.h"

enum { LAG_VARIANT_ROWS = 256 };

/* Zeros but for `sim` at the start. */
typedef struct Variant {
  lag_sim *sim;
  /* q, v, z [SI] at equally spaced times; the last row is the end, earlier where an event stopped the run */
  Samples run;
  double difference; /* difference of its motion from the scene's, relative to the scene's size */
  double weight;     /* the largest |acceleration with - without| / |with| */
  double time;       /* time of one call of the right-hand side [s] */
  char why[200];     /* why there is no run; "": there is one */
} Variant;

void lag_variant_free(Variant *v); /* with its sim */

/* Runs the variant from t0 to t1. < 0: failure on the way, with v->why. */
int lag_variant_run(Variant *v, double t0, double t1);

/* The component of [q | v | z] of this name; -1: there is none. */
int lag_component_index(const lag_model *m, const char *name);

/* The largest difference of components of the same name, at times that both reached, and at their ends, relative to
 * the scene's largest value of its kind and unit; and of the times at which events ended them, relative to the span.
 * HUGE_VAL where a difference is not finite. LAG_OK, or LAG_ENOMEM. */
int lag_variant_difference(const Variant *scene, const Variant *other, double *difference);

/* The largest ratio of |a_with - a_without| to |a_with| along the motion of `along`, whose coordinates are those of
 * `with` or `without`; accelerations and rates of states of one unit are taken together. |a_with| counts at least as
 * its root mean square: a pendulum's acceleration vanishes where its drag is largest. NaN: no values. LAG_OK or
 * LAG_ENOMEM. */
int lag_variant_weight(const Variant *along, const Variant *with, const Variant *without, double *weight);

/* v[i].time := the shortest mean time of a call in many rounds, in each of which every variant that has run takes
 * its turn, at states of its own run. */
int lag_variants_time(Variant *v, int n);
