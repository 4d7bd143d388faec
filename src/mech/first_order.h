/* Lagrangians that are linear in all velocities: guiding centres, point vortices, populations.
 *
 * For L = theta(q, t) q' - H(q, t) and forces Q(q, q', t), the Euler-Lagrange equations d/dt theta_i = dL/dq_i + Q_i
 * read
 *
 *   sum_j omega_ij q_j' = dH/dq_i + dtheta_i/dt - Q_i,   omega_ij = dtheta_j/dq_i - dtheta_i/dq_j
 *
 * (G. D. Birkhoff, Dynamical Systems (1927), II.10; L. Faddeev, R. Jackiw, Phys. Rev. Lett. 60 (1988) 1692, DOI
 * 10.1103/PhysRevLett.60.1692). There is no mass matrix; the coordinates determine the velocities where the
 * antisymmetric matrix omega is regular. Forces may be linear in velocities, Q = Q0 + B q': then omega + B replaces
 * omega, and Q0 replaces Q. In a model that gives its Hamiltonian q' is dH/dp, and forces may depend on velocities
 * in any way, as dry friction does. */
#pragma once

#include "mech/eqns.h"

/* Fills e->first, e->flow and the energy of a model of first order; in other flows, events and their actions rates
 * are replaced by the flows. 0, reported, when omega is singular at every state or too large, or when a force is not
 * linear in velocities. */
int first_order_derive(Eqns *e, const Model *m);
