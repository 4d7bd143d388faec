/* Contacts that touch at a state: what contact.c and contact_friction.c share. */
#pragma once

#include <float.h>
#include <math.h>

#include "core/core.h"

/* All contacts of a model at a state: gaps, rates and the sizes of their terms; and of[n], the contacts that touch,
 * with the response: impulses L change their rates by response L, where all constraints hold. Memory is freed by
 * free_contacts. */
typedef struct ContactSet {
  lag_sim *sim;
  double *y;                    /* [n of the state] */
  int n, *of;
  int rows;                     /* n, and behind them in of[] the tangents of those with friction */
  double *gap, *rate, *gap_size, *rate_size; /* [contacts] */
  double *response;             /* [n n] */
  double *rhs;                  /* [n] acceleration of each gap while all are open */
  double *impulse;              /* [n] impulses, or forces */
  /* [n n], [n] matrix and scales of the complementarity problem, whose row k is contact at[k] */
  double *lcp, *scale;
  int *at;
  int *island, *body;           /* [n] islands of contacts that move each other; [nq] scratch: bodies joined */
  double *push;                 /* scratch: [n] impulses */
  unsigned char *active, *closed; /* [n] takes part; pushes */
  unsigned char *was_closed;    /* [contacts] closed before */
  unsigned char *follows, *state; /* [n] its gap is held by the contacts that push; scratch */
  /* scratch: [constraints], [constraints], [constraints], [nq], [nq], [n of the state], [nev], [contacts] */
  double *g, *c, *r, *d, *force, *test, *events, *ahead;
  /* of the model's contact_laws; [n] side to which a contact slips, NaN: it sticks, 0: by a force that
   * is not unique */
  double *law, *side, *way; /* way[2 n]: direction in which it slips in space */
  double *pressed;              /* [guides][3][rows + 1] force of each guide: without other forces, and by each */
  double *A, *mass;             /* sparse entries of the constraints' Jacobian, with all contacts closed, and of M */
  int *row, *entry;             /* entry[row[k]] to entry[row[k + 1]]: entries of the Jacobian of constraint k */
  int band;                     /* of M, half; -1: other constraints hold, too, or M is singular */
  double *lu, *pivot, *diagonal; /* M factored within its band */
  double *block;
} ContactSet;

/* Rounding of a gap or of its rate, relative to their terms. */
static const double lag_no_gap = 0x1p12 * DBL_EPSILON;
/* A flight too low to be followed, relative to the terms of the gap. */
static const double lag_no_flight = 0x1p6 * DBL_EPSILON;

static inline const lag_contact *lag_contacts_at(const ContactSet *w, int a) {
  return &w->sim->scene->model->contacts[w->of[a]];
}

static inline const char *lag_contacts_name(const ContactSet *w, int a) {
  return w->sim->scene->model->constraints->of[lag_contacts_at(w, a)->constraint].name;
}

static inline const double *lag_guide_law(const lag_model *m, const double *law, int guide) {
  return law + 3 * m->ncontacts + 4 * guide;
}

static inline double lag_norm(const double *x, int n) {
  double s = 0;
  for (int i = 0; i < n; i++) s = hypot(s, x[i]);
  return s;
}

/* contact.c. tangent_of: the tangent of contact i of the model; -1: it has no friction. set_closed: closes or opens
 * contact i of the model; a tangent sticks, or has no friction. close_only: closes all, or `which` alone, or none
 * (-1). rates: rate[i] := rate of each gap, and slip velocity of each tangent, at y; leaves all closed. response: d
 * := the least change of velocities that changes the rate of contact i by 1, the others open; returns the change per
 * unit impulse. no_values: reports that contact i has none. term_sizes: size[constraints] := size of the terms of gaps,
 * or of their rates, at y or at the start, whichever is larger: a ball that has come to lie at 0 is measured by its
 * fall; leaves all closed. */
int lag_tangent_of(const lag_model *m, int i);
void lag_contact_set_closed(lag_sim *sim, int i, int closed);
void lag_contacts_close_only(const ContactSet *w, int all, int which);
int lag_contacts_rates(ContactSet *w, const double *y, double *rate);
double lag_contacts_response(ContactSet *w, int i);
int lag_contacts_no_values(ContactSet *w, int i);
int lag_contact_term_sizes(lag_sim *s, const double *y, int holonomic, double *size, double *scratch);

/* contact_complementarity.c. close: closes the contacts of w with closed[n], and no others. impact: applies the
 * impulses where gaps close, changes y and w->rate; e[n]: coefficients of restitution; struck[n]: gaps that were
 * closing. at_rest: w->closed := contacts that stay closed under forces: those that press, and those that depend on
 * them where they share the load and none pulls; acceleration[n] := of each gap then; y stays, contacts are open. */
void lag_contacts_close(const ContactSet *w, const unsigned char *closed);
int lag_contacts_impact(ContactSet *w, const double *e, const unsigned char *struck);
int lag_contacts_at_rest(ContactSet *w, double *acceleration);

/* contact_response.c. rate_change: of contact i by a change d of velocities; A: entries of the Jacobian;
 * change_of_rate: of w. band: half bandwidth of M, -1: constraints hold besides the contacts. list_entries: sorts
 * those of the Jacobian by rows. factor_mass: w->band := -1 where M is singular. find_islands: of those that take part:
 * contacts that share bodies, or whose bodies share inertia, are of one; all are where w->band < 0. free_response:
 * lag_contacts_response where w->band >= 0. keep_constraints: whether a change d of velocities, d M d = square, keeps
 * the constraints that always hold: it does not where they imply the row that d moves, and the solver has left out one
 * of theirs. Rates are measured by those of free coordinates. */
double lag_contacts_rate_change(const lag_model *m, const double *A, int i, const double *d);
double lag_contacts_change_of_rate(const ContactSet *w, int i, const double *d);
int lag_contacts_band(const lag_model *m);
void lag_contacts_list_entries(ContactSet *w);
void lag_contacts_factor_mass(ContactSet *w);
void lag_contacts_find_islands(ContactSet *w);
double lag_contacts_free_response(ContactSet *w, int i);
int lag_contacts_keep_constraints(const ContactSet *w, const double *d, double square);

/* guide_forces.c. stop: takes what is left of a slip that ends, at this event, out of the velocities. find_pressed:
 * forces of guides without friction and contacts, and by a unit force of each row, with `rhs` of all rows; pressed:
 * those of component c. gain: of row a, a guide's tangent, force on its guide by a unit of friction. */
int lag_guides_stop(ContactSet *w, int event);
int lag_guides_find_pressed(ContactSet *w);
double *lag_guide_pressed(const ContactSet *w, int guide, int c);
double lag_guide_gain(const ContactSet *w, int a);

/* contact_friction.c, where some contact of w has friction. laws_at: values of contact_laws. strike: impacts one
 * after the other, the fastest first, until no gap closes; e[n]: restitution. choose_modes: in[n] and side[n] of the
 * contacts that take part, after the event, or -1; acceleration[n] of all gaps then. set_friction: sets the friction
 * of those closed. */
int lag_contact_laws_at(lag_problem *pb, double t, const double *y, double *law);
int lag_contacts_strike(ContactSet *w, const double *e);
int lag_contacts_choose_modes(ContactSet *w, int event, double *acceleration);
void lag_contacts_set_friction(ContactSet *w);

/* space_friction.c: slips of two components. second_of: the other tangent of a contact in space, behind its first,
 * i; -1: i is none. gap_of: the contact of a tangent. slips_in_space: of the first tangent. slip_velocities: r :=
 * residuals, with the velocities of those that slip; pb->u are inputs. slip_direction: e[2] := unit vector against
 * which friction of tangent i acts, from r. slip_noise: slips back that are no end of one, as where it begins by forces
 * that have just grown enough; 0: it does not slip in space. slip_ends: whether s[2], beside slips of this size, is 0
 * to the tolerance. some_stick_in_space: law of space_events, event functions of all, is that of the state then. */
int lag_second_of(const lag_model *m, int i);
int lag_gap_of(const lag_model *m, int tangent);
int lag_slips_in_space(const lag_problem *pb, int i);
int lag_slip_velocities(lag_problem *pb, double t, const double *y, double *c, double *r);
void lag_slip_direction(const lag_problem *pb, const double *r, int i, double *e);
double lag_slip_noise(const lag_problem *pb, int i);
int lag_slip_ends(const lag_problem *pb, const double *s, double size);
int lag_some_stick_in_space(const lag_sim *s);
void lag_space_events(const lag_sim *s, const double *law, double *g);
