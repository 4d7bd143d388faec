/* galerkin_step.h: one step of a discrete Lagrangian: its equations, and Newton's method for them. Enters: q, p
 * and a guess; leaves: the velocities inside the step, and the forces at its points. Holds: all derivatives are exact.
 *
 * A step of length h from (q, p) at t, by a rule. With L_i = L(t + c_i h, Q_i, V_i), F = dL/dq + Q and the free
 * velocities u (galerkin_rule.h), the discrete Lagrange-d'Alembert principle p = -D1 L_d - F_d- gives the equations
 *
 *   sum_i b_i (value[i][k] dL_i/dv - h (whole[k] - integral[i][k]) F_i) = whole[k] p    for each k
 *
 * and the step ends at q + h sum_k whole[k] u_k and at p + h sum_i b_i F_i, which is p1 = D2 L_d + F_d+. With h = 0
 * the equations are dL/dv(q, u) = p, for the velocity u of a momentum p.
 *
 * An instance defines before it includes this text lag_second and its parts (lag_model.h), and:
 *   LAG_MODEL, LAG_THE_MODEL         the first parameters of functions: the model; the same as arguments
 *   LAG_COORDINATES(w)               w->n, where that is a constant known to compilers
 *   LAG_VARIATION(t, w)              a status; dL/dq, dL/dv and forces outside L at w->Q, w->V
 *   LAG_SECOND(t, w)                 a status; nonzero second derivatives of L and derivatives of these forces
 *   LAG_NEWTON_SOLVES(d)             called once a system,
 *   LAG_NEWTON_CORRECTS(d)           once a correction
 *   LAG_NEWTON_INFINITE(d, w)        the status of a residual that is not finite,
 *   LAG_NEWTON_LEAVES(d, w, status)  of a state behind a correction at which the model returned `status`,
 *   LAG_NEWTON_SINGULAR(d, w)        of a singular matrix,
 *   LAG_NEWTON_FAILS(d, w)           of too many corrections */
#ifndef LAG_GALERKIN_STEP_H
#define LAG_GALERKIN_STEP_H

#include "kernels/band_matrix.h"
#include "kernels/galerkin_rule.h"
#include "kernels/newton.h"

/* ---- discrete ---- */

typedef struct lag_discrete {
  const lag_rule *rule;
  LAG_REAL t, h, size;    /* size: length of a whole step; corrections of u are compared with the motion over it */
  const LAG_REAL *q, *dq; /* [n] the step begins at q + dq */
  const LAG_REAL *p, *dp; /* [n] and at p + dp */
  LAG_REAL *u;            /* [free n], u[k n + i]: in: a guess; out: the solution */
  LAG_REAL *force;        /* [points n] out: F at the points */
  LAG_REAL *work;         /* [LAG_DISCRETE_ROOM] */
  int counted;            /* 1: its corrections count as iterations of the method */
} lag_discrete;

/* Arrays of Newton's method for n coordinates and up to m = free n unknowns. */
typedef struct lag_discrete_room {
  int n, half, nsecond;          /* half: half bandwidth of the second derivatives, in the order of coordinates */
  const lag_second *at;          /* [nsecond] */
  LAG_REAL epsilon;              /* rounding of LAG_REAL */
  LAG_REAL *now;                 /* inputs, for the instance */
  LAG_REAL *Q, *V, *Lq, *Lv, *F; /* [n] at one point */
  LAG_REAL *R, *S, *du;          /* [m] residual, size of its terms, correction */
  LAG_REAL *second;              /* [nsecond] */
  lag_band_matrix J;
} lag_discrete_room;

#define LAG_DISCRETE_ROOM(n, m, nsecond, matrix) (5*(n) + 4*(m) + (nsecond) + (matrix))

/* Places arrays for the rule of d; n, half, nsecond and `at` are set. */
static inline void lag_discrete_place(const lag_discrete *d, lag_discrete_room *w) {
  const int n = w->n, velocities = (int)d->rule->free, m = n*velocities;
  LAG_REAL *room = d->work;
  w->J.n = m, w->J.band = velocities*(w->half + 1) - 1;
  w->Q = room, w->V = room += n, w->Lq = room += n, w->Lv = room += n, w->F = room += n, w->R = room += n;
  w->S = room += m, w->du = room += m, w->J.pivot = room += m, w->second = room += m, w->J.a = room + w->nsecond;
}

/* Adds the increments of the solved step. */
static inline void lag_discrete_move(const lag_discrete *d, int n, LAG_REAL *dq, LAG_REAL *dp) {
  const lag_rule *const r = d->rule;
  for (int i = 0; i < n; i++) {
    for (int k = 0; k < (int)r->free; k++) dq[i] += d->h*(r->whole[k]*d->u[k*n + i]);
    for (int k = 0; k < (int)r->points; k++) dp[i] += d->h*(r->b[k]*d->force[k*n + i]);
  }
}

/* Q and V at point i; returns its time. */
static inline LAG_REAL lag_discrete_at(const lag_discrete *d, const lag_discrete_room *w, int i) {
  const lag_rule *const r = d->rule;
  const int n = LAG_COORDINATES(w);
  for (int a = 0; a < n; a++) {
    LAG_REAL q = LAG_C(0.0), v = LAG_C(0.0);
    for (int k = 0; k < (int)r->free; k++) {
      q += r->integral[i][k]*d->u[k*n + a];
      v += r->value[i][k]*d->u[k*n + a];
    }
    w->Q[a] = d->q[a] + (d->dq[a] + d->h*q);
    w->V[a] = v;
  }
  return d->t + r->c[i]*d->h;
}

/* R := residual, S := size of its terms by component, d->force := forces at the points. */
static inline int lag_discrete_residual(LAG_MODEL, const lag_discrete *d, const lag_discrete_room *w) {
  const lag_rule *const r = d->rule;
  const int n = LAG_COORDINATES(w), velocities = (int)r->free;
  LAG_REAL finite = LAG_C(0.0);
  int status = 0;
  for (int k = 0; k < velocities; k++)
    for (int a = 0; a < n; a++) {
      const LAG_REAL momentum = d->p[a] + d->dp[a];
      w->R[k*n + a] = -r->whole[k]*momentum;
      w->S[k*n + a] = LAG_FN(fabs)(r->whole[k]*momentum);
    }
  for (int i = 0; i < (int)r->points; i++) {
    LAG_REAL *const force = d->force + i*n, t = lag_discrete_at(d, w, i);
    LAG_TRY(LAG_VARIATION(t, w));
    for (int a = 0; a < n; a++) {
      force[a] = w->Lq[a] + w->F[a];
      for (int k = 0; k < velocities; k++) {
        const LAG_REAL moved = r->b[i]*r->value[i][k]*w->Lv[a];
        const LAG_REAL pushed = d->h*r->b[i]*(r->whole[k] - r->integral[i][k])*force[a];
        w->R[k*n + a] += moved - pushed;
        w->S[k*n + a] += LAG_FN(fabs)(moved) + LAG_FN(fabs)(pushed);
      }
    }
  }
  for (int i = 0; i < velocities*n; i++) finite += w->R[i] - w->R[i];
  return finite >= LAG_C(0.0) ? status : LAG_NEWTON_INFINITE(d, w);
}

/* Adds of[k] by[l] x to the block (row, col) of the matrix, in equation k and column of free velocity l. Unknown u_k
 * of coordinate a has index a free + k, so that the matrix of a chain is banded. */
static inline void lag_discrete_block(const lag_discrete_room *w, int velocities, int row, int col, const LAG_REAL *of,
                                      const LAG_REAL *by, LAG_REAL x) {
  for (int k = 0; k < velocities; k++) {
    LAG_REAL *const at = lag_band_matrix_at(&w->J, row*velocities + k, col*velocities);
    for (int l = 0; l < velocities; l++) at[l] += of[k]*by[l]*x;
  }
}

/* Adds the second derivatives at point i to the matrix. */
static inline void lag_discrete_scatter(const lag_discrete *d, const lag_discrete_room *w, int i) {
  const lag_rule *const r = d->rule;
  const int velocities = (int)r->free;
  LAG_REAL of_f[LAG_RULE_FREE], of_p[LAG_RULE_FREE], by_q[LAG_RULE_FREE];
  for (int k = 0; k < velocities; k++) {
    of_f[k] = -d->h*r->b[i]*(r->whole[k] - r->integral[i][k]);
    of_p[k] = r->b[i]*r->value[i][k];
    by_q[k] = d->h*r->integral[i][k];
  }
  for (int e = 0; e < w->nsecond; e++) {
    const int row = w->at[e].row, col = w->at[e].col, part = w->at[e].part;
    const LAG_REAL x = w->second[e], *const of = part == LAG_VV || part == LAG_VQ ? of_p : of_f;
    const LAG_REAL *const by = part == LAG_VV || part == LAG_FV ? r->value[i] : by_q;
    lag_discrete_block(w, velocities, row, col, of, by, x);
    if (part == LAG_VQ) lag_discrete_block(w, velocities, col, row, of_f, r->value[i], x); /* d2L/dq dv */
    else if (row != col && (part == LAG_QQ || part == LAG_VV)) lag_discrete_block(w, velocities, col, row, of, by, x);
  }
}

/* Newton's matrix at the present u, factored. */
static inline int lag_discrete_matrix(LAG_MODEL, const lag_discrete *d, lag_discrete_room *w) {
  int status = 0;
  for (int i = 0; i < lag_band_matrix_size(w->J.n, w->J.band); i++) w->J.a[i] = LAG_C(0.0);
  for (int i = 0; i < (int)d->rule->points; i++) {
    const LAG_REAL t = lag_discrete_at(d, w, i);
    LAG_TRY(LAG_SECOND(t, w));
    lag_discrete_scatter(d, w, i);
  }
  return lag_band_matrix_factor(&w->J, w->du) ? LAG_NEWTON_SINGULAR(d, w) : status;
}

/* One Newton correction of u. Its size beside rounding is sqrt(sum |du R| / sum |u| S), which does not depend on
 * units. */
static inline lag_correction lag_discrete_correct(const lag_discrete *d, const lag_discrete_room *w) {
  const int n = LAG_COORDINATES(w), velocities = (int)d->rule->free;
  LAG_REAL work = LAG_C(0.0), whole = LAG_C(0.0);
  lag_correction size = {LAG_C(0.0), LAG_C(0.0)};
  for (int a = 0; a < n; a++)
    for (int k = 0; k < velocities; k++) w->du[a*velocities + k] = -w->R[k*n + a];
  lag_band_matrix_solve(&w->J, w->du);
  for (int a = 0; a < n; a++)
    for (int k = 0; k < velocities; k++) {
      LAG_REAL *const u = &d->u[k*n + a], du = w->du[a*velocities + k];
      *u += du;
      const LAG_REAL part = lag_relative_correction(d->size, du, *u, d->q[a]);
      size.part = part > size.part ? part : size.part;
      work += LAG_FN(fabs)(du*w->R[k*n + a]);
      whole += LAG_FN(fabs)(*u)*w->S[k*n + a];
    }
  if (work > LAG_C(0.0)) size.rounding = LAG_FN(sqrt)(work/whole);
  return size;
}

/* Newton's method, until corrections are rounding: larger residuals would have the same sign step after step and add up
 * over a long run. The matrix is refreshed while corrections are large. After a failure u is undefined. */
static inline int lag_discrete_newton(LAG_MODEL, const lag_discrete *d, lag_discrete_room *w) {
  lag_correction before = {LAG_C(1.0), LAG_C(1.0)};
  LAG_NEWTON_SOLVES(d);
  for (int turn = 0, settled = 0; turn <= LAG_MOST_CORRECTIONS; turn++) {
    int status = lag_discrete_residual(LAG_THE_MODEL, d, w);
    if (status != 0) return turn > 0 ? LAG_NEWTON_LEAVES(d, w, status) : status;
    if (settled) return status;
    const int fresh = lag_newton_needs_matrix(turn, before);
    if (fresh) LAG_TRY(lag_discrete_matrix(LAG_THE_MODEL, d, w));
    const lag_correction now = lag_discrete_correct(d, w);
    LAG_NEWTON_CORRECTS(d);
    settled = lag_newton_has_converged(now, before, fresh, turn, w->epsilon);
    before = now;
  }
  return LAG_NEWTON_FAILS(d, w);
}

/* ---- end ---- */
#endif
