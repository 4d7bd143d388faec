/* Connections: motions that leave one periodic motion along its unstable manifold and reach another, or the same one,
 * along its stable manifold. Both manifolds are cut by a section; where the cuts of neighbouring starts cross, Newton's
 * method on both places of departure and arrival closes the gap. */
#pragma once

#include "analysis/manifold.h"

/* One end: manifolds of a motion with one direction, and the place of a start between two of them. */
typedef struct ConnectionEnd {
  PeriodicOrbit *orbit;
  const Manifold *manifold;
  int side, cut; /* 1 or -1; which crossing of the section, from 1 */
  double phase;  /* in places along the motion */
  double *start; /* [n] */
  double time;   /* from the start to the section, > 0; backwards at the stable end */
} ConnectionEnd;

typedef struct Connection {
  struct Connection *next;
  ConnectionEnd from, to;
  double *at;      /* [n] state in the section */
  double residual; /* of the ends' states there, in units of the motions */
} Connection;

typedef struct Connections {
  Pool pool;
  Connection *first;
  int count, tried; /* pairs of cuts that cross, and were refined */
  double nearest;   /* the smallest gap of those that failed; HUGE_VAL: none */
} Connections;

/* Connections that cross the event `section` within `time` after departure, and before arrival. part: as of the
 * manifolds. LAG_OK, LAG_ENOMEM, or LAG_EMETHOD: a manifold has more than one direction, or its direction changes its
 * side in each period. Free in any case. */
int lag_connections_find(Connections *c, const ConnectionEnd *from, const ConnectionEnd *to, int section, double time,
                         double part);
void lag_connections_free(Connections *c);

/* connection_chain.c: a connection by multiple shooting. start: y[n] := that of the first end (0), or the second one,
 * at a place along its motion. */
typedef struct LongConnection {
  FlowMap *flow;
  int n;
  const double *unit; /* [n] */
  double rate;        /* of growth [1/s] */
  void *of;
  int (*start)(void *of, int end, double phase, double *y);
  double phase[2], time[2]; /* of both ends, to the section; first estimates, then refined */
  int parts[2];
  double *before;  /* [n] the last node of the first end before the section */
  double residual; /* the largest gap between parts, in units */
} LongConnection;
/* LAG_OK, with what is left in c->residual, or a status. */
int lag_connection_refine(LongConnection *c);
