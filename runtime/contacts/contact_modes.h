/* Which contacts with friction stay closed, and which of them stick: Coulomb's law on
 * accelerations, in one tangential direction for each contact; and forces within Coulomb's
 * cones, where those of several contacts are not unique. */
#pragma once

typedef enum { LAG_CONTACT_OPEN, LAG_CONTACT_STICKS, LAG_CONTACT_SLIPS } lag_contact_mode;

typedef struct lag_touch {
  double mu, hold; /* friction while it slips; while it sticks, where that is larger */
  int contact;     /* the caller's number */
  int tangent;     /* its row; -1: there is no friction */
  int second;      /* row of the other direction in space; 0: there is none */
  double way[2];   /* in space the direction of slipping, given where it slips already */
  int slip;        /* sign of the slip velocity, in space 1; 0: at rest */
  int cannot_stick;
  int shared;            /* it sticks, and its force is not unique */
  lag_contact_mode mode; /* without friction a closed contact slips */
  int to;                /* the side to which it slips: -1, 1 */
  /* of a guide: not 0; its force N[parts] = pressed[parts][1 + rows] (1, x); and the direction of N */
  int guide, parts;
  double *pressed, toward[3];
  int presses; /* side of its force from which the direction is sought: -1, 1 */
} lag_touch;

enum { LAG_MOST_TOUCHES = 16, LAG_TRIED_TOUCHES = 6 };

/* The largest friction of a contact that sticks, beside the force that presses. */
static inline double lag_touch_holds(const lag_touch *c) { return c->hold > c->mu ? c->hold : c->mu; }

/* Rows 0..n-1 are gaps, or forces |N| of guides, without W and pull; behind them the tangents: accelerations are
 * W[rows rows] x + pull for forces x[rows]. Fills in mode, to, shared and x. A contact sticks where some forces that
 * hold it obey Coulomb's law; at rest, with a larger static friction, as few contacts begin to slip as can. Returns
 * the number of motions, 0, 1 or 2: none (Painleve's paradox, where friction is large), one, or more than one.
 * room[rows (rows + 5)] is scratch. Up to LAG_TRIED_TOUCHES all combinations are tried, at most 5^n. P. Loetstedt,
 * SIAM J. Appl. Math. 42 (1982) 281, DOI 10.1137/0142022. Of more, n <= LAG_MOST_TOUCHES, a motion is sought by
 * changes of one mode at a time, the least index first (K. G. Murty, Numer. Math. 24 (1974) 265), then in other orders,
 * none beside it: 1 or 0. */
int lag_contact_modes(int n, lag_touch *of, int rows, const double *W, const double *pull, double *x, double *room);

/* All forces x + sum c[j] D[j][rows] hold the same accelerations. x := those whose least margin,
 * of the largest friction less |F| where a contact sticks and of N where it does not, is
 * largest; c[n_directions + 1] := their coefficients, at most 2 LAG_MOST_TOUCHES, and the
 * margin. It is bounded by the size of the forces given; returns 1, wedged, where nothing else
 * bounds it. A linear programme; numeric/complementarity.h solves its conditions of optimality. */
int lag_cone_forces(int n, const lag_touch *of, int rows, double *x, int n_directions, const double *D, double *c);
