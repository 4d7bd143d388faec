/* The action variable of one closed curve H(q, p) = E: J = 1/(2 pi) closed integral of p dq, and its period.
 *
 * The curve is cut at minima of E - H. From them, and from turning points, q = a + b sinh(w), or its square, leaves
 * no square root near the nodes, and Gauss's rule converges exponentially, beside a separatrix, too. The period
 * there has the digits that E - H has. L. D. Landau, E. M. Lifshitz, Mechanics, 3rd ed. (1976), 48 to 50; V. I.
 * Arnold, Mathematical Methods of Classical Mechanics, 2nd ed. (1989), 50. P. R. Johnston, D. Elliott, Int. J.
 * Numer. Meth. Engng 62 (2005) 564, doi:10.1002/nme.1208, on sinh for nearly singular integrals. */
#pragma once

/* H and its derivatives at a point. */
typedef struct lag_phase_point {
  double H, slope, bend, force; /* dH/dp, d2H/dp2, dH/dq */
} lag_phase_point;

typedef lag_phase_point lag_phase_fn(void *context, double q, double p);

typedef struct lag_action_integral {
  const char *why_not; /* reason for no action; NULL: there is one */
  int rests;           /* the point is an equilibrium: J = 0 */
  /* the curve goes round: J is the mean of p over a turn, with its sign; a curve that turns has J > 0 */
  int rotates;
  double J, time;      /* time: the period; < 0 where the curve goes round towards smaller q */
  double error, time_error; /* of J and time, relative */
  double low, high;    /* turning points, or the ends of a turn */
} lag_action_integral;

/* The curve through (q, p). periodic: q is an angle of period 2 pi. */
lag_action_integral lag_action_of_curve(lag_phase_fn *at, void *context, double q, double p, int periodic);
