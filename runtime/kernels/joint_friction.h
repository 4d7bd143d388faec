/* joint_friction.h: dry friction of joints and sliders in one step of Moreau's time-stepping. Enters: coordinates at
 * the middle of the step, velocities and states at its end; leaves: those with friction that holds or brakes. Holds:
 * each surface obeys Coulomb's law after its turn: no slip is left at the end where less than the bound holds the body,
 * else friction is at its size, against the slip.
 *
 * A mode is the mean of sign(slip) in a step: friction in parts of its size while the body slips. Bounds are 1, or
 * static friction in these parts where the body rests at the begin or turns round in the step. In a step with an
 * impact friction opposes the mean of the slips at both ends, as that of contacts: it drives the slip s into the
 * interval from -s0 to 0, so it brings no energy in where the impact turns the slip round.
 *
 * An instance defines before it includes this text:
 *   LAG_MODEL, LAG_THE_MODEL            the first parameters of functions: the model; the same as arguments
 *   LAG_JOINTS(w)                  w->n, where that is a constant known to compilers
 *   LAG_HOLD(w, j, value)          w->mode[j] := value, for the model, too
 *   LAG_SLIPS(t, y, x, w, g)       a status; slips g[n] for coordinates y, velocities and states x
 *   LAG_GRIPS(t, y, w, g)          a status; g[n], 1 so far, := static friction in parts of that of motion
 *   LAG_MODE_RATES(t, y, w, k)     a status; rates k with modes as held
 *   LAG_FRICTION_FAILS(t, j, what) the status of a failure at surface j */
#ifndef LAG_JOINT_FRICTION_H
#define LAG_JOINT_FRICTION_H

#include "kernels/coulomb.h"

/* ---- surfaces ---- */

/* n surfaces of friction; states: components of a state, nq of them coordinates. */
typedef struct lag_joint_friction {
  int n, states, nq;
  LAG_REAL *mode, *sticks;    /* [n] in the last step; whether that held it */
  LAG_REAL *bound, *grip;     /* [n] the largest mode, and that of a slip which does not turn */
  LAG_REAL *response;         /* [n] change of the slip by a mode of 1 */
  LAG_REAL *before, *centre;  /* [n] slip at the begin; middle of the interval from there to the slip aimed at */
  LAG_REAL *slip, *other;     /* [n] */
  LAG_REAL *d, *x;            /* [n states] rates for a mode of 1; [states] */
} lag_joint_friction;

#define LAG_JOINT_ROOM(n, states) ((n)*(9 + (states)) + (states))
#define LAG_COUPLED_ROOM(n, states) (4*(n) + 2*(states)) /* of coupled_friction.h */

static inline void lag_joints_place(lag_joint_friction *w, LAG_REAL *room) {
  const int n = w->n;
  w->mode = room, w->sticks = room += n, w->bound = room += n, w->response = room += n, w->before = room += n;
  w->centre = room += n, w->slip = room += n, w->other = room += n, w->grip = room += n;
  w->d = room += n, w->x = room + n*w->states;
}

/* Slips at the begin of the step from y at t, and bounds. */
static inline int lag_joints_begin(LAG_MODEL, lag_joint_friction *w, LAG_REAL t, const LAG_REAL *y) {
  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0);
  int status = 0;
  for (int j = 0; j < LAG_JOINTS(w); j++) LAG_HOLD(w, j, w->mode[j]);
  for (int j = 0; j < LAG_JOINTS(w); j++) w->bound[j] = one;
  LAG_TRY(LAG_SLIPS(t, y, y, w, w->before));
  LAG_TRY(LAG_GRIPS(t, y, w, w->bound));
  for (int j = 0; j < LAG_JOINTS(w); j++) {
    const int rests = w->sticks[j] > zero || !(w->before[j] < zero || w->before[j] > zero);
    if (rests && w->bound[j] < one - LAG_C(1e-9))
      return LAG_FRICTION_FAILS(t, j, "has a static limit smaller than the friction of a sliding body: let "
                                      "`static = mu_s*N` have a mu_s of at least mu");
    w->bound[j] = w->bound[j] > one ? w->bound[j] : one;
    w->grip[j] = rests ? w->bound[j] : one;
  }
  return status;
}

/* d, response: changes by a mode of 1 in a step, from the states at its middle and its end without contacts. A model
 * writes abs(slip) as mode*slip, so the mode of a body that slips has the sign of its slip. */
static inline int lag_joints_respond(LAG_MODEL, lag_joint_friction *w, const lag_kick *s) {
  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0);
  int status = 0;
  for (int j = 0; j < LAG_JOINTS(w); j++) {
    const LAG_REAL mode = w->mode[j], slip = w->before[j];
    const LAG_REAL low = LAG_SELECT(slip > zero, zero, -one), high = LAG_SELECT(slip < zero, zero, one);
    LAG_REAL *const d = w->d + j*w->states;
    LAG_HOLD(w, j, low);
    LAG_TRY(LAG_MODE_RATES(s->t, s->mid, w, w->x));
    LAG_HOLD(w, j, high);
    LAG_TRY(LAG_MODE_RATES(s->t, s->mid, w, d));
    LAG_HOLD(w, j, mode);
    for (int i = 0; i < w->states; i++) {
      d[i] = (d[i] - w->x[i])/(high - low);
      w->x[i] = s->y1[i] + s->h*d[i];
    }
    LAG_TRY(LAG_SLIPS(s->end, s->mid, s->y1, w, w->slip));
    LAG_TRY(LAG_SLIPS(s->end, s->mid, w->x, w, w->other));
    w->response[j] = w->other[j] - w->slip[j];
  }
  return status;
}

/* Where forces and friction do not agree in a few turns: responses at the friction so far, since friction that follows
 * a load is no sum of that of each surface; in later turns a surface that slips has broken loose. */
static inline int lag_joints_respond_again(LAG_MODEL, lag_joint_friction *w, const lag_kick *s, int turn) {
  for (int k = 0; k < LAG_JOINTS(w) && turn >= 20; k++)
    if (!(w->sticks[k] > LAG_C(0.0))) w->bound[k] = w->grip[k] = LAG_C(1.0);
  return turn == 0 || turn >= 8 ? lag_joints_respond(LAG_THE_MODEL, w, s) : 0;
}

/* One turn of surface k; *size, *change: the largest slip, and change of one. A surface with a response < 0 is driven
 * to the nearest slip of an interval about centre[k]; one without slips. Where friction pushes it on, as that of a
 * guide may which others hold, it keeps its mode while it rests. */
static inline int lag_joint_turn(LAG_MODEL, lag_joint_friction *w, const lag_kick *s, int k, LAG_REAL *size,
                                 LAG_REAL *change) {
  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0), own = w->response[k], was = w->mode[k];
  const LAG_REAL *const d = w->d + k*w->states;
  LAG_REAL slip[1], to[1];
  int status = 0;
  LAG_TRY(LAG_SLIPS(s->end, s->mid, s->y1, w, w->slip));
  slip[0] = w->slip[k];
  const LAG_REAL g = LAG_FN(fabs)(slip[0]), response = LAG_FN(fabs)(own);
  to[0] = was;
  if (own < zero) {
    const lag_coulomb law = {1, own, LAG_FN(fabs)(w->centre[k]), w->grip[k], w->bound[k],
                             one, w->centre + k, w->before + k};
    lag_friction_turn(&law, slip, to);
  } else {
    const LAG_REAL rests = LAG_SELECT(own > zero, was, zero), little = LAG_C(1e-6)*lag_larger(response, *size);
    const LAG_REAL least = LAG_SELECT(own > zero, little, zero);
    to[0] = LAG_SELECT(slip[0] > least, one, LAG_SELECT(slip[0] < -least, -one, rests));
    slip[0] = zero;
  }
  if (!lag_is_number(to[0])) return LAG_FRICTION_FAILS(s->end, k, "has no finite values");
  const LAG_REAL part = LAG_FN(fabs)(to[0]);
  const int at_limit = !(part < one || part > one || w->bound[k] > one);
  for (int i = w->nq; i < w->states; i++) s->y1[i] += s->h*(to[0] - was)*d[i];
  LAG_HOLD(w, k, to[0]);
  w->sticks[k] = LAG_SELECT(slip[0] < zero || slip[0] > zero || at_limit, zero, one);
  *change = lag_larger(LAG_FN(fabs)((to[0] - was)*own), *change);
  *size = lag_larger(lag_larger(g, response), *size);
  return status;
}

/* Finds modes that agree, and the end of the step. struck: the step has an impact. *size: the largest slip. */
static inline int lag_joints_solve(LAG_MODEL, lag_joint_friction *w, const lag_kick *s, int struck, LAG_REAL *size) {
  const LAG_REAL zero = LAG_C(0.0);
  LAG_REAL last = zero;
  int status = 0;
  *size = zero;
  for (int k = 0; k < LAG_JOINTS(w); k++) w->centre[k] = struck ? -w->before[k]/LAG_C(2.0) : zero;
  for (int sweep = 0; sweep < 10000; sweep++) {
    LAG_REAL change = zero;
    for (int k = 0; k < LAG_JOINTS(w); k++) {
      LAG_TRY(lag_joint_turn(LAG_THE_MODEL, w, s, k, size, &change));
      /* with static friction surfaces that share a load may hold and slip in turns: one that slips has broken loose */
      if (sweep >= 50 && !(w->sticks[k] > zero)) w->bound[k] = w->grip[k] = LAG_C(1.0);
    }
    const LAG_REAL unit = s->epsilon*(*size);
    if (change <= LAG_C(64.0)*unit) return status;
    /* surfaces that hold one motion, to what positions leave of their slips: on curves they drift by equal steps */
    const int drifts = change >= last*(LAG_C(1.0) - LAG_C(1e-6));
    const LAG_REAL little = sweep < 100 ? LAG_C(1e7) : drifts ? LAG_C(1e13) : LAG_C(1e10);
    if (sweep > 0 && change <= little*unit && change >= last/LAG_C(2.0)) return status;
    last = change;
  }
  return LAG_FRICTION_FAILS(s->end, 0, "and others find no forces that agree: take smaller steps");
}

/* Size of the terms of rate i: at rest forces cancel, and rounding is that of friction. */
static inline LAG_REAL lag_joints_size(const lag_joint_friction *w, int i, LAG_REAL rate) {
  for (int k = 0; k < LAG_JOINTS(w); k++) rate = LAG_FN(fabs)(rate) + LAG_FN(fabs)(w->d[k*w->states + i]);
  return rate;
}

/* ---- end ---- */
#endif
