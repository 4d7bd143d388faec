/* What the files of implicit steps share: implicit.c (steps, and their derivatives), links.c (one discrete Lagrangian after another) and
 * rattle.c (constraints). A step is a chain of links. */
#ifndef LAG_METHODS_LINKS_H
#define LAG_METHODS_LINKS_H

#include <stddef.h>

#include "lag.h"
#include "methods/composition.h"
#include "methods/rule.h"

/* One block of doubles; the arrays of x are in Arrays. */
typedef struct Implicit {
  double h;         /* the step, > 0 */
  double ready;     /* p belongs to the present q and v */
  double have_path; /* 1 made, -1 cannot be made, 0 not asked for yet */
  double t0, dt;    /* the last step began at t0 and was dt long */
  double tc;        /* what t has lost to rounding */
  double order, links;
  double part[2 * LAG_MAX_DRIFTS];
  lag_rule rule[2], momentum;
  double x[];
} Implicit;

/* A model with constraints: where a block begins, [q|v], its increments of q and p there, the impulse that leads to the constraints at
 * its end, and what is solved for it. Blocks are links that end on the constraints together. */
typedef struct Block {
  double *from, *to;                   /* [n] */
  double *dq, *dp, *impulse, *d, *force; /* [nq] */
  double *c, *r, *g, *sum;             /* [constraints]; the sum of all g, from which the impulse follows */
  double *A, *M;                       /* entries, as in lag_constraints */
  double *change, *turned;             /* [constraints nq], [constraints constraints]: see rattle.c */
  double *history;                     /* of the sum in each block */
} Block;

/* q and p have lost qc and pc to rounding; dq, dp are the increments of this step, ql and pl both together. */
typedef struct Arrays {
  double *p, *qc, *pc, *dq, *dp, *ql, *pl, *v; /* [nq] */
  double *y0, *y1, *f0, *f1;                   /* [n] both ends of the last step, f when it is asked for */
  double *u, *force;                           /* [2 free nq] of the links of a block, [points nq] */
  double *history;                             /* of u in each link, then of v */
  double *path, *discrete;
  Block block;
} Arrays;

/* The layout of a block of lag_links_size doubles, for rules with as many free velocities. */
size_t lag_links_size(const lag_problem *pb, int free, int links);
Arrays lag_links_arrays(Implicit *w, const lag_problem *pb);
/* Doubles of the history of one link. */
size_t lag_links_history(const lag_problem *pb, const Implicit *w);

/* ql, pl: what is to be added to q and p where the step is now. */
void lag_links_gather(const Arrays *a, int nq);

/* Link k, which begins at `at` of the step that leads on from y at t by dt: its velocities u and forces, and what they add to q and p. known:
 * u is a guess. LAG_OK, or a failure with its place and reason in pb. */
int lag_link(const Implicit *w, const Arrays *a, lag_problem *pb, double t, const double *y, double dt, int k, double at, double *u,
             int known);
/* Link k is done with the velocities u. */
void lag_link_note(const Implicit *w, const Arrays *a, const lag_problem *pb, int k, const double *u);

/* a->v where the step is now, dL/dv(q, v) = p. known: it is a guess. */
int lag_links_velocity(const Implicit *w, const Arrays *a, lag_problem *pb, double tb, const double *y, int known);

/* All links, of a model with constraints, and a->v at their end, tb. */
int lag_rattle(const Implicit *w, const Arrays *a, lag_problem *pb, double t, double tb, const double *y, double dt);

#endif
