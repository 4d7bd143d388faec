/* Periodic motions by multiple shooting: y(T) = G y(0), with G the turns of periodic angles and, for relative ones,
 * the action of proved symmetries. Newton's steps are those of Levenberg and Marquardt with a damping of the squared
 * residual, which converge quadratically to the nearest solution of a family (N. Yamashita, M. Fukushima, Computing
 * Suppl. 15 (2001) 239): no phase needs to be chosen. Proved charges make the rows dependent; the part of the
 * residual along their gradients is left out. */
#pragma once

#include "analysis/flow_map.h"

enum { ORBIT_MOST_HELD = 16, ORBIT_MOST_GROUP = 8, ORBIT_MOST_JOINT = 16, ORBIT_TRACE = 8 };

typedef enum { ORBIT_STATE, ORBIT_CHARGE, ORBIT_PERIOD } OrbitHoldKind;

/* A condition: component `of` of the state (ORBIT_STATE), a charge, or the period, equals `value`. */
typedef struct OrbitHold {
  OrbitHoldKind kind;
  int of;
  double value;
} OrbitHold;

/* The symmetry of a charge, or the shift of n > 0 coordinates by one amount. */
typedef struct OrbitClosing {
  int charge;
  int n, shifted[ORBIT_MOST_JOINT];
} OrbitClosing;

typedef struct PeriodicOrbit {
  Pool pool;
  FlowMap flow;
  const lag_algebra *algebra;
  int n, m;              /* size of the state; segments */
  double T;              /* the period [s] */
  int drives;            /* of a driven model: periods of the drive in it */
  double *y;             /* [m n] the states at the begin of each segment */
  double *end, *Phi;     /* [m n], [m n n] states at the ends, and their derivatives */
  double *rates;         /* [m n] rates at the ends, where Phi was made */
  double *unit, time;    /* [n] sizes of the motion's components, and of the period */
  double *turns;         /* [n] advance of periodic angles over a period */
  int ncharges, *charge; /* conserved charges */
  int nheld;
  OrbitHold held[ORBIT_MOST_HELD];
  /* what closes the motion: the symmetry of a charge, or a shift of coordinates, on which nothing depends */
  int ngroup;
  OrbitClosing group[ORBIT_MOST_GROUP];
  double shift[ORBIT_MOST_GROUP]; /* their parameters */
  double *affine;                      /* [ngroup (nq + 1)^2] their generators */
  /* before them: components that are exchanged; NULL: none. Of a motion that is the same backwards in time, the map
   * that leaves its begin and its middle: only half of it is solved */
  const StateMap *closing, *reverse;
  int half;        /* 1: T, m and the conditions are those of the first half */
  double *offset;  /* [n] turns of periodic angles that `reverse` adds at the begin */
  int asymmetric;  /* 1: events do not have the symmetry `closing` */
  /* 1: one more unknown, `parameter`: the value that condition `led` keeps, or, for -1, that of the model's parameter
   * `name`; and rows that fix the phase and the place along symmetries */
  int continues, led, pinned; /* pinned: the component of a reversible begin that fixes the phase; -1: none */
  const char *name;
  double parameter, parameter_unit;
  double *target; /* [n] G y(0), */
  double *G;      /* [n n] and its derivative */
  /* the linear system, in units: rows and columns; A[rows cols], b[rows], V, sigma and a step */
  int rows, cols;
  double *A, *b, *V, *sigma, *x, *saved, *w;
  double *ends; /* [m n] copy of end */
  double *across; /* [nacross m n] gradients of charges, made orthonormal, whose part of the residual is left out */
  int nacross;
  double residual;           /* of y(T) = G y(0), in units: root of the mean square */
  int nfree;                 /* directions in which there are other solutions */
  int normal;                /* directions of nodes across the constraints */
  int steps;                 /* Newton's steps made */
  int settled;               /* periods for which the motion ran before */
  double trace[ORBIT_TRACE]; /* the first residuals */
  double period_error;       /* change of the period by a run that is a hundred times as precise, or more */
  int repeats;               /* > 1: the period is that many times the shortest one */
  int at_rest;               /* 1: it is an equilibrium */
  int steady;                /* 1: the symmetries by which it may close carry it along: it closes after any period */
  /* multipliers: of the directions that no charge, no symmetry and no phase fixes */
  int nmultipliers, ntrivial;
  double *re, *im;
  const char *closed, *opens; /* a contact that is closed at the begin; one that a push leaves open for a period */
  double pairing; /* largest |a b - 1| over pairs a, b of reciprocals; NaN: they are none */
} PeriodicOrbit;

/* Prepares: period T > 0, m segments (0: by the growth over a period). like: as of lag_flow_open. The members held,
 * group, closing and reverse are set before. LAG_OK, or a status with the message in o->flow. Free in any case. */
int lag_orbit_open(PeriodicOrbit *o, lag_sim *like, const lag_algebra *algebra, double T, int m);
void lag_orbit_free(PeriodicOrbit *o);

/* *T := the time after which the motion from the start of `like` comes back next to it, or to its image by
 * o->closing, until the time given; of one that o->reverse leaves twice that until it next does so. about > 0: next to
 * that time. 0: it does not, and message[size] ends a sentence with its
 * nearest approach. LAG_OK, or a status with its message. */
int lag_orbit_guess(const PeriodicOrbit *o, lag_sim *like, double until, double about, double *T, char *message,
                    size_t size);

/* Whether closing and reverse are symmetries of the equations; of a driven scene with a drive of period T. LAG_OK, or
 * LAG_EMETHOD with its message in f. */
int lag_orbit_check_maps(const PeriodicOrbit *o, FlowMap *f, double T);

/* orbit_closing.c. y[n] := G y; d[n], unless NULL, := its derivative by shift j; linear: of small changes. */
void lag_orbit_close_motion(const PeriodicOrbit *o, double *y, int linear, int j, double *d);
/* target and G at the present y, shifts and ends. */
void lag_orbit_set_target(PeriodicOrbit *o);
/* Shifts with which the first motion closes best: one by one the best of many, narrowed; of angles all values. */
void lag_orbit_guess_shifts(PeriodicOrbit *o);
/* The charges that are conserved, and generators of the shifts. LAG_OK, or a status with its message. */
int lag_orbit_list_charges(PeriodicOrbit *o);

/* For continuation (branch_problems.c): runs all segments at the present unknowns; then A and b, or b alone, across the
 * charges as of the last A. */
int lag_orbit_shoot(PeriodicOrbit *o, int tangents);
/* orbit_units.c: unit[n] := the largest excursion from y0 of components of that unit, over a period; of those that do
 * not move the largest value, or 1 declared unit. */
int lag_orbit_choose_units(PeriodicOrbit *o, const double *y0);
int lag_orbit_assemble(PeriodicOrbit *o);
void lag_orbit_residual(PeriodicOrbit *o);
/* orbit_drive.c. drives := how many periods of the drive T is. */
void lag_orbit_count_drives(PeriodicOrbit *o);
/* The parameter of the continuation := value. LAG_OK, or a status: both stay at the last value that was
 * reached on the way, with the period of the drive there. */
int lag_orbit_set_parameter(PeriodicOrbit *o, double value);
/* 0: the period is 30 times the first one, or longer, with a message in o->flow. */
int lag_orbit_period_is_usual(PeriodicOrbit *o);
/* rows and cols for the present settings. */
void lag_orbit_count(PeriodicOrbit *o);

/* The motion begins where that of the start is after so many periods of the drive. LAG_OK, or a status. */
int lag_orbit_settle(PeriodicOrbit *o, int periods);
/* Solves. 1: found; 0: not, o->residual and o->trace say how near it came; < 0: a status with its message. */
int lag_orbit_solve(PeriodicOrbit *o);
/* Solves again more precisely, for the error of the period; how often it repeats; whether it is at rest. */
int lag_orbit_refine(PeriodicOrbit *o);
/* Multipliers of the solution. LAG_OK, or a status. */
int lag_orbit_multipliers(PeriodicOrbit *o);
/* orbit_events.c. event_at_begin: the name of an event that is about to pass the time at which a segment of the motion
 * begins: the state there jumps, and no branch of it goes on. grazes: that of an event or contact next to which the
 * motion comes without meeting it, at *time: beyond, it happens once more. NULL: none. */
const char *lag_orbit_event_at_begin(PeriodicOrbit *o);
const char *lag_orbit_grazes(PeriodicOrbit *o, double *time);

/* orbit_contacts.c: closed and opens of the solution. LAG_OK, or LAG_ENOMEM. */
int lag_orbit_contacts(PeriodicOrbit *o);
