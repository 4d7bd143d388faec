/* The flow of a model as a map: the state after a time, its tangent, conserved charges and the fields of their
 * symmetries. Each run is a simulation of its own, so that one map can be taken at many states and times. */
#pragma once

#include "analysis/state_map.h"
#include "core/core.h"

typedef struct FlowMap {
  Pool pool;
  lag_sim *like;  /* values, method and tolerance of all runs; not advanced here */
  lag_sim *probe; /* at the start: right-hand sides and charges at any state */
  int n, nq;
  double t0;
  int forced;       /* 1: the rates depend on time */
  int kicks;        /* 1: there are kicks, at the scene's begin and a number of their periods */
  double drive;     /* the period of what drives it; 0: not known */
  const StateMap *closing;   /* what a drive's period is closed by: components that are exchanged; NULL: none */
  const char *name; /* parameter with another value, in its declared unit; NULL: none */
  double value;
  lag_scene scene;                                        /* of the runs: the scene's, with another start of the span */
  int stopped;                                            /* 1: the last run was ended by an event */
  int differences; /* 1: Phi is by differences of runs, to some eight digits: a run over contacts had no tangent */
  double *rates;                                          /* [n] at the end of the last run, on its side of switches */
  double *jumps;                                          /* of each charge: 1: events changed it in a run */
  double *at, *up, *down, *mass, *linear, *room, *square; /* scratch */
  char message[600];                                      /* of the last failure */
} FlowMap;

/* `like` has values, method and tolerance, and has not begun. LAG_OK, or a status with its message. Free in any
 * case; `like` stays the caller's. */
int lag_flow_open(FlowMap *f, lag_sim *like);
void lag_flow_free(FlowMap *f);
/* Another value of a parameter, as of lag_sim_set. */
int lag_flow_set(FlowMap *f, const char *name, double value);

/* A simulation from y0[n] at time t. NULL: no memory. */
lag_sim *lag_flow_sim(FlowMap *f, double t, const double *y0);
/* The same, with an end so much later, or before the start. */
lag_sim *lag_flow_sim_along(FlowMap *f, double t, const double *y0, double along);
/* y1[n] := the state a time dt after y0[n] at t; Phi[n n], row-major, unless NULL := its derivative by y0. LAG_OK, or
 * a status with its message; LAG_STOPPED: an event ended the run before. */
int lag_flow_run(FlowMap *f, double t, double dt, const double *y0, double *y1, double *Phi);
/* Whether the model has contacts, which may close. */
int lag_flow_contacts(const FlowMap *f);
/* Whether all contacts are open at y, t; 0 with the name of one that is not in the message. */
int lag_flow_is_open(FlowMap *f, double t, const double *y);
/* f[n] := y' at y, t. */
int lag_flow_rates(FlowMap *f, double t, const double *y, double *rates);

/* *T := the period of what drives the model next to *T, to rounding, by Gauss-Newton steps on the rates at several
 * states and times. Returns what is left of their difference a period later, relative to the rates; HUGE_VAL: they
 * have no values. find: the shortest one up to `longest`, or 0. */
double lag_flow_drive(FlowMap *f, double *T);
double lag_flow_find_drive(FlowMap *f, double longest);

/* Number of charges, the energy first; whether charge k is conserved, by proof, and by the events of all runs so
 * far. */
int lag_flow_charges(const FlowMap *f);
int lag_flow_conserves(const FlowMap *f, int k);
/* Value of charge k at y, t; d[n] := its derivatives by y, by central differences of order 8. */
double lag_flow_charge(FlowMap *f, int k, double t, const double *y);
int lag_flow_gradient(FlowMap *f, int k, double t, const double *y, double *d);
/* X[n] := the field of the symmetry of charge k at y, t: changes of coordinates M^-1 dQ/dv, and their rate; of the
 * energy, y'. LAG_EMETHOD: the model has no mass matrix. */
int lag_flow_field(FlowMap *f, int k, double t, const double *y, double *X);
/* Whether neither rates nor event functions change where coordinates q[k] are shifted by one amount, seen at some
 * states and times. */
int lag_flow_shifts(FlowMap *f, int k, const int *q);
/* Whether the map is a symmetry: the rates at y, t and those at the image, `later` after it (of a reversing one: as
 * long before t0 as t is after it), are related by it, seen at some states and times. */
int lag_flow_has_symmetry(FlowMap *f, const StateMap *map, double later);
/* B[n *k] := an orthonormal basis of the tangent space of the constraints at y, t, components in unit[n]; without
 * constraints all of them. */
int lag_flow_tangent_basis(FlowMap *f, Pool *pool, double t, const double *y, const double *unit, double *B, int *k);
/* G[nq + 1][nq + 1] := the affine map of coordinates by which the symmetry of charge k acts, per unit of its
 * parameter: q -> A q + b in the first nq rows. LAG_EMETHOD: it is not affine. */
int lag_flow_affine(FlowMap *f, int k, double t, const double *y, double *G);
/* Whether component i is a periodic angle; y - y0 of it, of such angles modulo a turn. */
int lag_flow_is_angle(const lag_model *m, int i);
double lag_flow_change(const lag_model *m, int i, const double *y, const double *y0);
