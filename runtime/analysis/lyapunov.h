/* Lyapunov exponents of a run with a tangent: k vectors are carried along and made orthonormal again after each
 * step; the logarithms of their growth are summed. With constraints vectors lie in their tangent space. G. Benettin,
 * L. Galgani, A. Giorgilli, J.-M. Strelcyn, Meccanica 15 (1980) 9, DOI 10.1007/BF02128236; I. Shimada, T. Nagashima,
 * Prog. Theor. Phys. 61 (1979) 1605, DOI 10.1143/PTP.61.1605. */
#pragma once

#include "analysis/memory_pool.h"
#include "lag.h"

enum { LAG_LYAPUNOV_BLOCKS = 20 };

typedef struct Lyapunov {
  int n, d, k;             /* size of the state; dimension of the phase space, smaller with constraints; exponents */
  double from, until;      /* interval of the measurement */
  double begun, t;         /* its actual begin and present end, both ends of steps; NaN: not yet */
  double *sum;             /* [k] sum of the logarithms of growth since `begun` */
  long long steps;         /* steps since `begun` */
  int nblocks;             /* complete blocks, of equal length up to a step */
  double *block;           /* [LAG_LYAPUNOV_BLOCKS * (k + 1)] mean rates in each block, and their sum */
  double half, *at_half;   /* middle of the measurement, and [k] `sum` then */
  double *Y;               /* [n * k] the vectors */
  /* trace of Df, and its time; its integral since `begun`, plus log |det S| of events */
  double trace, traced, divergence;
  double *J, *work, *A, *B; /* Df [n n], scratch of lag_jacobian, scratch [n n] */
  double block_from, *block_sum; /* the present block: its begin, and [k] `sum` there */
  Pool pool;
} Lyapunov;

/* Prepares the first k exponents of a simulation before its first advance, with its method set; it gets a tangent of
 * k columns. Vectors align until `from`, and are measured from there to `until`. LAG_OK, LAG_ENOMEM, or the status
 * of a missing tangent: lag_sim_message. Free with lag_lyapunov_free in any case. */
int lag_lyapunov_begin(Lyapunov *l, lag_sim *sim, int k, double from, double until);
void lag_lyapunov_free(Lyapunov *l);

/* At the end of each step: call it from the hook of lag_sim_on_step. It limits the steps of embedded methods by
 * pb.longest to the fastest rate of Df: their steps are chosen for the state alone, and at rest they would grow past
 * any neighbouring motion. LAG_EDOMAIN: a vector has vanished or overflowed within one step. */
int lag_lyapunov_step(Lyapunov *l, lag_sim *sim);

/* Before an event changes the state, at time t, from `before`[n]: call it from the hook of lag_sim_on_event. Events
 * enter by their saltation matrices S (core/flow_tangent.c): vectors are multiplied by S, volumes by its
 * determinant. */
void lag_lyapunov_event(Lyapunov *l, lag_sim *sim, double t, const double *before);

/* At the end of the run: closes the last block if it is at least half full. */
void lag_lyapunov_end(Lyapunov *l);

/* Exponent i, or for i = k the sum of all, and its estimate at half the time, 0 before; NaN without a measurement.
 * -HUGE_VAL, with error 0: the motion has begun to slide on a surface, where neighbouring motions become one. */
double lag_lyapunov_exponent(const Lyapunov *l, int i);
double lag_lyapunov_at_half(const Lyapunov *l, int i);
/* Standard error of exponent i from the means of blocks, as if these were independent; NaN where there are fewer
 * than two. */
double lag_lyapunov_spread(const Lyapunov *l, int i);

/* Mean of the trace of Df along the motion, and of log |det S| at events: by Liouville the sum of all exponents,
 * estimated independently by the trapezoidal rule over steps. NaN as above. */
double lag_lyapunov_divergence(const Lyapunov *l);

/* The error of exponent i, or for i = k of their sum: the largest of its standard error, its change since half of
 * the time (0 is approached as log(t)/t), a factor of e in the whole time, and rounding. */
double lag_lyapunov_error(const Lyapunov *l, int i);
/* Sign of exponent i, 0 where it is within three errors of 0. */
int lag_lyapunov_sign(const Lyapunov *l, int i);

/* Pesin's entropy: the sum of the positive ones among the k exponents. *error: summed over these and over those
 * within their errors of 0. */
double lag_lyapunov_entropy(const Lyapunov *l, double *error);

/* Lyapunov dimension of the attractor by J.L. Kaplan and J.A. Yorke (1979, DOI 10.1007/BFb0064319), from all d
 * exponents; those within three errors of 0 count as 0. NaN where not all are known, or volumes are not known to
 * shrink. */
double lag_lyapunov_dimension(const Lyapunov *l, double *error);
