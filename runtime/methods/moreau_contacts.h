/* Contacts in one step of moreau: the instance of kernels/contact_step.h for a lag_problem. */
#pragma once

#include "core/rhs.h"

/* Calls of the model for a state y, with the inputs of lag_moreau_close; each returns 0 or the status of the step. */
int lag_moreau_close(lag_problem *pb, double t, int only);
int lag_moreau_gaps(lag_problem *pb, double t, const double *q, const double *v, const double *z, double *c, double *r);
int lag_moreau_matrices(lag_problem *pb, double t, const double *y, double *A, double *M);
int lag_moreau_strike(lag_problem *pb, double t, const double *y, int i, double *v);
int lag_moreau_frictions(lag_problem *pb, double t, const double *y, double *law);
int lag_moreau_contact_fails(lag_problem *pb, double t, int i, const char *words);
int lag_moreau_singular(lag_problem *pb, double t);
struct lag_moreau_contacts;
int lag_moreau_unit_change(lag_problem *pb, struct lag_moreau_contacts *w, int row, double t, const double *y,
                           double *d, double *effort);

#define LAG_MODEL lag_problem *pb
#define LAG_THE_MODEL pb
#define LAG_IS_GAP(c) (!(c).is_tangent && !(c).conditional)
#define LAG_CLOSE(t, only, u) lag_moreau_close(pb, t, only)
#define LAG_GAPS(t, q, v, z, u, c, r) lag_moreau_gaps(pb, t, q, v, z, c, r)
#define LAG_GAP_MATRICES(t, y, u, A, M) lag_moreau_matrices(pb, t, y, A, M)
#define LAG_UNIT_CHANGE(w, row, t, y, u, g, d, effort) lag_moreau_unit_change(pb, w, row, t, y, d, effort)
#define LAG_STRIKE(t, y, u, i, v) lag_moreau_strike(pb, t, y, i, v)
#define LAG_FRICTIONS(t, y, u, law) lag_moreau_frictions(pb, t, y, law)
#define LAG_CONTACT_FAILS(t, i, words) lag_moreau_contact_fails(pb, t, i, words)
#define LAG_SINGULAR(t) lag_moreau_singular(pb, t)
#include "kernels/contact_step.h"

/* Whether m has constraints beside contacts. */
int lag_moreau_has_others(const lag_model *m);
/* Whether families have more rows, beside constraints or in a mass matrix that is not diagonal, than indices count. */
int lag_moreau_is_too_large(const lag_model *m);
/* In pb->contact_room; law[2 contacts]: friction and tangential restitution of the model's; NULL: not known. */
lag_moreau_contacts lag_moreau_contacts_of(lag_problem *pb, double *law);
/* Finds the contacts that take part, as lag_contacts_find; of families first those that are near. */
int lag_moreau_find(lag_problem *pb, lag_moreau_contacts *w, double t, double h, const double *mid, const double *end);
/* Notes forces, counts and work of the step in pb; v0, v1: velocities at both ends, from: time from which on dense
 * output contains the impulses. */
void lag_moreau_contacts_note(const lag_moreau_contacts *w, lag_problem *pb, double h, double from, const double *v0,
                              const double *v1);
