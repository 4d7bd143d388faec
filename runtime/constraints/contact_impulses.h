/* Contacts that touch at one state, their impulses and forces; for contact.c. */
#ifndef LAG_CONSTRAINTS_CONTACT_IMPULSES_H
#define LAG_CONSTRAINTS_CONTACT_IMPULSES_H

#include "core/core.h"

/* All contacts of a model at a state: gaps, rates and the sizes of their terms; and of[n], the contacts that touch, with W: impulses L change
 * their rates by W L, where all constraints hold. Memory is freed by lag_contacts_free. */
typedef struct ContactSet {
  lag_sim *sim;
  double *y;                    /* [n of the state] */
  int n, *of;
  double *gap, *rate, *gap_size, *rate_size; /* [contacts] */
  double *W;                    /* [n n] */
  double *pull;                 /* [n] acceleration of each gap while all are open */
  double *push;                 /* [n] impulses, or forces */
  double *M, *scale;            /* [n n], [n] matrix and scales of the complementarity problem, whose row k is contact at[k] */
  int *at;
  unsigned char *part, *in;     /* [n] takes part; pushes */
  unsigned char *was;           /* [contacts] closed before */
  unsigned char *follows;       /* [n] its gap is held by the contacts that push */
  double *g, *c, *r, *d, *force, *test, *events; /* scratch: [constraints], [constraints], [constraints], [nq], [nq], [n of the state], [nev] */
  double *A, *mass;             /* sparse entries of the constraints' Jacobian, with all contacts closed, and of M */
  double *block;
} ContactSet;

/* size[constraints] := size of the terms of gaps, or of their rates, at y or at the start, whichever is larger: a ball that has come to lie at 0
 * is measured by its fall. Leaves all contacts closed. */
int lag_contacts_term_sizes(lag_sim *sim, const double *y, int holonomic, double *size, double *scratch);

/* *touch := all contacts at the state y, which stays the caller's; touch->of has room for all, n is 0. */
int lag_contacts_evaluate(lag_sim *sim, double *y, ContactSet *touch);
void lag_contacts_free(ContactSet *touch);

/* The coefficient of restitution of contact i; NaN where no impulse moves it. */
double lag_contacts_restitution(ContactSet *touch, int i);

/* Computes W for the contacts of[n]. */
int lag_contacts_responses(ContactSet *touch);

/* Applies the impulses where gaps close: changes y and touch->rate. e[n]: coefficients of restitution; struck[n]: gaps that were closing. */
int lag_contacts_impact(ContactSet *touch, const double *e, const unsigned char *struck);

/* touch->in := contacts that stay closed under forces: those that press, and those that depend on them where they share the load and none pulls.
 * acceleration[n] := of each gap then. y does not change; contacts are left open. */
int lag_contacts_at_rest(ContactSet *touch, double *acceleration);

/* Closes, in the simulation's hold, the contacts of touch with closed[n], and no others. */
void lag_contacts_close(const ContactSet *touch, const unsigned char *closed);

#endif
