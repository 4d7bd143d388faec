/* Lyapunov exponents of a run with a tangent: k vectors are carried along, made orthonormal again after each step, and what
 * they had grown by is added up. G. Benettin, L. Galgani, A. Giorgilli, J.-M. Strelcyn, Meccanica 15 (1980) 9, DOI
 * 10.1007/BF02128236; I. Shimada, T. Nagashima, Prog. Theor. Phys. 61 (1979) 1605, DOI 10.1143/PTP.61.1605. */
#ifndef LAG_ANALYSIS_LYAPUNOV_H
#define LAG_ANALYSIS_LYAPUNOV_H

#include "analysis/pool.h"
#include "lag.h"

enum { LAG_LYAPUNOV_BLOCKS = 20 };

typedef struct Lyapunov {
  int n, k;
  double from, until;      /* what is measured lies between */
  double begun, t;         /* from the end of a step, to the end of a step; NaN: not yet */
  double *sum;             /* [k] what logarithms have grown by since `begun` */
  long long steps;         /* in that time */
  int nblocks;             /* that are complete, of equal length but for a step */
  double *block;           /* [LAG_LYAPUNOV_BLOCKS * (k + 1)] mean rates in each, and their sum */
  double half, *at_half;   /* the time when half of it was over, and [k] the estimates then */
  double *Y;               /* [n * k] the vectors */
  double trace, traced, divergence; /* of Df, and when, at the last look; its integral since `begun`, with log |det S| of events */
  double *J, *work, *A, *B; /* Df, scratch of lag_jacobian and of lag_lyapunov_rate: [n n] */
  double block_from, *block_sum; /* [k] of the present block: where it began, and `sum` there */
  Pool pool;
} Lyapunov;

/* For the first k exponents of a simulation before its first advance, with its method set; it gets a tangent of k columns. Vectors
 * turn until `from`, then they are measured, to `until`. LAG_OK, LAG_ENOMEM, or why there is no tangent: lag_sim_message. Free with
 * lag_lyapunov_free in any case. */
int lag_lyapunov_begin(Lyapunov *l, lag_sim *sim, int k, double from, double until);
void lag_lyapunov_free(Lyapunov *l);

/* At the end of each step: call it from the function of lag_sim_on_step. Embedded methods, whose steps are chosen for the state
 * alone, are told by pb.longest how long steps may be for its fastest changes, too: a system at rest would be passed over by any
 * step. LAG_EDOMAIN: a vector has vanished or grown past all
 * bounds within one step. */
int lag_lyapunov_step(Lyapunov *l, lag_sim *sim);

/* Before an event changes the state, at time t, from `before`[n]: from the function of lag_sim_on_event. Events enter by their saltation
 * matrices S (core/tangent.c): vectors become S times what they were, and volumes change by its determinant. */
void lag_lyapunov_event(Lyapunov *l, lag_sim *sim, double t, const double *before);

/* At the end of the run: its last block is as complete as it gets. */
void lag_lyapunov_end(Lyapunov *l);

/* Exponent i, or for i = k the sum of all; NaN where nothing was measured. */
double lag_lyapunov_exponent(const Lyapunov *l, int i);
/* Its standard error from the means of blocks, as if these were independent; NaN where there are fewer than two. */
double lag_lyapunov_spread(const Lyapunov *l, int i);

/* The mean of the trace of Df along the motion, and of log |det S| at events, which the sum of all exponents is (Liouville): an estimate by
 * other means, the trapezoidal rule over steps. NaN as above. */
double lag_lyapunov_divergence(const Lyapunov *l);

/* The error of exponent i, or for i = k of their sum: the largest of its standard error, of what it has moved by since half of the time (0 is reached
 * as log(t)/t), of a factor of e in the whole time, and of rounding. */
double lag_lyapunov_error(const Lyapunov *l, int i);
/* Its sign, 0 where it is within three errors of 0. */
int lag_lyapunov_sign(const Lyapunov *l, int i);

/* The sum of the positive exponents, of which k are known: Pesin's entropy. *error: that of these and of those that are 0 within theirs. */
double lag_lyapunov_entropy(const Lyapunov *l, double *error);

/* The dimension of the attractor by J.L. Kaplan and J.A. Yorke (1979, DOI 10.1007/BFb0064319), from all n exponents, of which those within three
 * errors of 0 count as 0. NaN where not all are known, or volumes are not known to shrink. */
double lag_lyapunov_dimension(const Lyapunov *l, double *error);

#endif
