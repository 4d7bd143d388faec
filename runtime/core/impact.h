/* For contact.c: contacts that touch at one state, and what pushes them. */
#ifndef LAG_CORE_IMPACT_H
#define LAG_CORE_IMPACT_H

#include "core/core.h"

/* Of the contacts of a model: gap and its rate at a state, and the size of their terms; and of those n that touch, of[n], what one
 * does to another: an impulse L changes their rates by W L, where all constraints hold. One block of memory, freed by lag_touch_free. */
typedef struct Touch {
  lag_sim *sim;
  double *y;                    /* [n of the state] */
  int n, *of;
  double *gap, *rate, *gap_size, *rate_size; /* [contacts] */
  double *W;                    /* [n n] */
  double *pull;                 /* [n] the acceleration of each gap while all of them are open */
  double *push;                 /* [n] impulses, or forces */
  double *M, *scale;            /* [n n], [n] of the complementarity problem, and which of them is which in it: */
  int *at;
  unsigned char *part, *in;     /* [n] takes part; pushes */
  unsigned char *was;           /* [contacts] it was closed */
  unsigned char *follows;       /* [n] its gap is one that those which push hold already */
  double *g, *c, *r, *d, *force, *test, *events; /* scratch: [constraints], [constraints], [constraints], [nq], [nq], [n of the state], [nev] */
  double *A, *mass;             /* entries of the constraints' derivatives, with all contacts closed, and of M */
  double *block;
} Touch;

/* size[constraints]: of the terms of gaps, or of their rates, at y or at the start, whichever are larger: a ball that has come to lie at 0 is
 * measured by what it fell. All contacts are closed for it. */
int lag_touch_sizes(lag_sim *sim, const double *y, int holonomic, double *size, double *scratch);

/* All contacts at the state y, which stays the caller's. touch->of has room for all; n is 0. */
int lag_touch_look(lag_sim *sim, double *y, Touch *touch);
void lag_touch_free(Touch *touch);

/* The coefficient of restitution of contact i; NaN where no impulse moves it. */
double lag_touch_restitution(Touch *touch, int i);

/* W, once of[n] is known. */
int lag_touch_responses(Touch *touch);

/* The impulses where gaps close: rates change in y, and in touch->rate. e[n]: coefficients; struck[n]: those that were closing. */
int lag_touch_impact(Touch *touch, const double *e, const unsigned char *struck);

/* Which of those that take part stay closed under forces, touch->in: those that press, and what follows from them, where it then shares the
 * load and none pulls. y does not change, and contacts are left open. acceleration[n]: of each gap then. */
int lag_touch_rest(Touch *touch, double *acceleration);

/* Of the contacts named by touch, and no others: hold. */
void lag_touch_close(const Touch *touch, const unsigned char *closed);

#endif
