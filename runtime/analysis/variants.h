/* What effects do to a motion: a scene beside variants of it that have other sets of effects. Enters: simulations at their start;
 * leaves: how far each ends from the scene, how much its accelerations differ, what a call of its right-hand side takes. */
#ifndef LAG_ANALYSIS_VARIANTS_H
#define LAG_ANALYSIS_VARIANTS_H

#include "analysis/cost.h"

enum { LAG_VARIANT_ROWS = 16, LAG_VARIANT_STATES = 256 };

typedef struct Variant {
  lag_sim *sim;      /* the caller's */
  Samples run;       /* q, v, z [SI] at equally spaced times; the last row: the end, earlier where an event stopped it */
  double *t, *y;     /* [LAG_VARIANT_STATES], and as many rows: states at ends of steps, over the whole run, nstates of them */
  int nstates;
  int n;
  double difference; /* of its motion from the scene's, relative to the scene's size */
  double weight;     /* the largest |acceleration with - without| / |with| */
  double time;       /* of one call of the right-hand side [s] */
  char why[200];     /* of no run: why; "": there is one */
} Variant;

/* For a simulation at its start; the variant must not be moved before it is freed. LAG_OK or LAG_ENOMEM. */
int lag_variant_init(Variant *v, lag_sim *sim);
void lag_variant_free(Variant *v); /* not its sim */

/* Runs it from t0 to t1. < 0, with v->why: it failed on the way. */
int lag_variant_run(Variant *v, double t0, double t1);

/* The largest difference of what both have, matched by name, at the times of rows that both reached, and at their ends; each relative to
 * the scene's largest value of its kind and unit; and of the times at which events ended them, relative to the span. LAG_OK, or LAG_ENOMEM;
 * HUGE_VAL is a difference that is no number. */
int lag_variant_difference(const Variant *scene, const Variant *other, double *difference);

/* The largest ratio of |a_with - a_without| to |a_with| along the motion of `with`, or of `along`, whose coordinates are those of one of
 * them; of accelerations and rates of states, those of a unit together. Where |a_with| is below its root mean square, that takes its
 * place: a pendulum's acceleration vanishes where its drag does most. NaN: there are no values. LAG_OK or LAG_ENOMEM. */
int lag_variant_weight(const Variant *along, const Variant *with, const Variant *without, double *weight);

/* v[i].time of all that have run: the best of many rounds, in each of which every variant has its turn, at states of its own run. */
int lag_variants_time(Variant *v, int n);

#endif
