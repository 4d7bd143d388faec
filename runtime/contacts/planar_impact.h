/* The impact of one contact with friction, in a plane and in space. */
#pragma once

/* Where restitution ends: its normal impulse does e^2 of the work of compression (Stronge), is e times that of
 * compression (Poisson), or ends with -e times the normal velocity before (Newton). */
enum { LAG_IMPACT_STRONGE, LAG_IMPACT_POISSON, LAG_IMPACT_NEWTON };

/* W[4]: change of the normal and the tangential velocity by unit impulses, [nn nt; tn tt], symmetric and positive
 * definite; v[2]: velocities before, v[0] < 0; mu >= 0: friction; e, back: restitution of both velocities, 0 to 1.
 * P[2] := the impulses. Returns the kinetic energy that they bring in, 0 up to rounding where the law agrees with
 * its conservation; NaN: the law has no impulse.
 *
 * back = 0: the body slips, sticks, or slips back as the impulse grows (Routh), until restitution ends. With
 * Stronge's energetic coefficient energy never grows: W.J. Stronge, Proc. R. Soc. Lond. A 431 (1990) 169, DOI
 * 10.1098/rspa.1990.0125; Impact Mechanics, 2nd ed. (2018), ch. 5, DOI 10.1017/9781139050227. With Newton's it may,
 * where the slip turns: T.R. Kane, D.A. Levinson, Dynamics (1985), 5.8; with Poisson's it does not: Y. Wang, M.T.
 * Mason, J. Appl. Mech. 59 (1992) 635, DOI 10.1115/1.2893771.
 *
 * back > 0: the velocities after are -e v[0] and -back v[1] where the impulse is in the cone, else it lies on the
 * edge (Ch. Glocker, Set-Valued Force Laws (2001), ch. 9, DOI 10.1007/978-3-540-44479-4). Garwin's superball has mu
 * large, e = back = 1. */
double lag_planar_impact(const double *W, const double *v, int law, double mu, double e, double back, double *P);

/* The same in space: W[9], v[3], P[3] for the normal and two perpendicular tangents. The slip turns as the impulse
 * grows, where a response couples directions: an ordinary differential equation (J.B. Keller, J. Appl. Mech. 53 (1986)
 * 1, DOI 10.1115/1.3171712), to about 10 digits; back > 0 is for slips that stay in their direction. */
double lag_space_impact(const double *W, const double *v, int law, double mu, double e, double back, double *P);
