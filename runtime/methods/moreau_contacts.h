/* Contacts in one step of moreau. Enters: positions at the middle of a step, velocities at its begin, and at its end
 * without contacts; leaves: those with contacts. */
#pragma once

#include "core/rhs.h"
#include "kernels/impulses.h"

/* Scratch in pb->contact_room. Rows are those of the contacts that take part, of[n]. */
typedef struct MoreauContacts {
  int n, rows;
  lag_pressing *of;
  lag_sparse_rows A, D;
  double *response, *b, *P, *before; /* [rows]; before: rates at the begin of the step */
  double *force;                     /* [contacts of the model] impulses, a guess for the next step */
  /* [constraints] gaps, rates at the begin, rates without contacts, their changes by forces and curvature in a step,
   * by curvature in its first half, a unit; [nq], [nq] */
  double *c, *r0, *r1, *pace, *bend, *g, *d, *effort;
  double *jacobian, *mass, *band, *pivot, *scale; /* M, factored */
  double *test, *after;              /* [n of the state] twice */
  double sweeps, impacts;            /* of this step */
} MoreauContacts;

MoreauContacts lag_moreau_contacts(const lag_problem *pb);

/* Tangents of contact i of the model, which follow it: 0, 1 or 2. */
int lag_contact_tangents(const lag_model *m, int i);

/* Chooses the contacts that take part in the step h with its middle at t: y = [middle q|v at the begin|z], free[nq]:
 * velocities at the end without contacts. law[2 contacts]: friction and tangential restitution. 0, or the status of
 * the step. */
int lag_moreau_contacts_find(MoreauContacts *w, lag_problem *pb, double t, double h, const double *y,
                             const double *free, const double *law);
/* v[nq], velocities without contacts, := those with them. 0, or the status of the step. */
int lag_moreau_contacts_solve(MoreauContacts *w, lag_problem *pb, double t, double *v);
/* Notes forces, counts and work of the step in pb; v0, v1: velocities at both ends, from: time from which on dense
 * output contains the impulses. */
void lag_moreau_contacts_note(MoreauContacts *w, lag_problem *pb, double h, double from, const double *v0,
                              const double *v1);
