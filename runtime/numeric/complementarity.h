/* Laws of contacts, dry friction and switches: one problem, and its exact solution by pivoting.
 *
 * Mixed linear complementarity problem with boxes: z[n] and w = q + M z with, for each i,
 *   w_i >= 0 where z_i = lower_i,  w_i <= 0 where z_i = upper_i,  w_i = 0 where z_i is between.
 * M is the response of the motion to the laws, J K^-1 J^T of constraints J on inertia K.
 *
 *   law                           z                        box              w
 *   forces of contacts            force                    0, inf           acceleration of the gap
 *   impacts of contacts           impulse                  0, inf           rate after + e (rate before)
 *   sliding on switching surfaces mode                     -1, 1            -(rate of the surface)
 *   best forces in cones          forces, least margin     -inf, inf        } conditions of optimality of
 *                                 prices of limits         0, inf           } a linear programme
 *
 * Boxes of Coulomb's law depend on z: -mu N <= F <= mu N. Its solutions are counted by contacts/contact_modes.h for
 * few contacts, found by sweeps for many: kernels/impulses.h. */
#pragma once

/* Rank decisions of all laws. A row depends on others where this part of its response is left beside theirs. */
static const double lag_dependent_row = 1e-10;
/* Whether a law moves its row: its rate has changed by `change` where 1 was asked for, or by about 0 where other
 * constraints imply the row. */
static inline int lag_row_moves(double change) { return change > 0.5 && change < 1.5; }

/* Between its bounds z may exceed them by `reserve`: static friction holds more than friction while it slips. */
typedef struct lag_box {
  double lower, upper, reserve;
  double is_switch; /* 1: no z between its bounds, the motion leaves the surface; else 0 */
} lag_box;

enum { LAG_AT_LOWER, LAG_BETWEEN, LAG_AT_UPPER };
enum { LAG_SOLVED, LAG_NO_SOLUTION, LAG_NOT_MONOTONE, LAG_CYCLES };

/* box: NULL: 0 to infinity, for all. at: where the search begins; on return, of the solution. q: on return z.
 * M: on return scaled to a diagonal of ones, where it is positive, and pivoted on those between: there row i
 * depends on them where its diagonal element is at most `zero`. rounding: relative size of a w, or of a z beside
 * its bound, that counts as 0. row: where it ended without a solution. */
typedef struct lag_complementarity {
  int n, row;
  double *M, *q, *scale; /* [n n], [n]; scratch [n] */
  const lag_box *box;
  unsigned char *at;
  double zero, rounding;
} lag_complementarity;

/* For contacts: boxes 0 to infinity, beginning with z = 0. */
lag_complementarity lag_contact_complementarity(int n, double *M, double *q, double *scale, unsigned char *at);

/* LAG_NO_SOLUTION: w_row has the wrong sign whatever z. LAG_NOT_MONOTONE: M is not sufficient, as are
 * matrices positive semidefinite or of positive principal minors; several z may solve the problem.
 * LAG_CYCLES: rounding.
 *
 * Criss-cross method with the least-index rule, finite for sufficient M, whether or not solutions are
 * unique; without start-up and perturbation of dependent rows: D. den Hertog, C. Roos, T. Terlaky,
 * Linear Algebra Appl. 187 (1993) 1, DOI 10.1016/0024-3795(93)90124-7. Each bound counts as a pair of
 * its own. For positive principal minors it is K.G. Murty's, Linear
 * Algebra Appl. 7 (1974) 65, DOI 10.1016/0024-3795(74)90063-5. */
int lag_solve_complementarity(lag_complementarity *p);
