/* Families of contacts in a step of moreau: the members that take part, as contacts of the kernel. Enters: positions
 * and velocities at the middle of the step; leaves: rows of these contacts, ascending by family, row and turn, with
 * the impulses of the step before as a guess. Holds: what it finds does not depend on how old lists of neighbours
 * are. */
#pragma once

#include "core/rhs.h"

/* Doubles of room; 0: the model has no families. */
size_t lag_families_size(const lag_model *m);

/* The contacts of a step: numbers of families' rows of A, each a contact or its tangent, and of their entries; then,
 * behind the model's own, contacts, positions of entries, impulses as a guess, whether constraints hold its bodies. */
typedef struct lag_family_step {
  int contacts, rows, entries;
  const lag_contact *at;
  const lag_entry *jacobian;
  const double *guess;
  const char *bound;
} lag_family_step;

/* Finds them, in room of lag_families_size, which lag_families_begin has laid out. banded: M couples coordinates. */
int lag_families_find(lag_problem *pb, double t, double h, const double *mid, const double *end, int banded,
                      lag_family_step *to);
void lag_families_begin(lag_problem *pb, double *room);
/* [nq] whether constraints hold a coordinate. */
const char *lag_families_tied(const lag_problem *pb);

/* The kernel's questions about them, as in moreau_contacts.h; i, c, r, A, law: from the first of families on. */
int lag_families_gaps(lag_problem *pb, double t, const double *q, const double *v, double *c, double *r);
int lag_families_rows(lag_problem *pb, double t, const double *y, double *A);
int lag_families_laws(lag_problem *pb, double t, const double *y, double *law);
int lag_families_strike(lag_problem *pb, double t, const double *y, int i, double *v);

/* Name of the contact of row i: hit[3, 2]. */
const char *lag_families_member(const lag_problem *pb, int i, char *text, size_t room);

/* Keeps the impulses of a step in pb->contact_impulse, and whose they are. */
void lag_families_note(lag_problem *pb);

/* A failure where members overlap at the start, by more than rounding. */
int lag_families_check_start(lag_problem *pb, double t, const double *y);
