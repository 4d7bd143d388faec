/* The start that a run takes: what the scene gives, brought to the constraints. */
#ifndef LAGC_START_H
#define LAGC_START_H

#include "mech/states.h"

typedef enum {
  START_FOUND,
  START_NO_VALUE, /* the constraint has no value where the scene starts */
  START_BROKEN,   /* it is not met by what is given `exactly` */
  START_FLAT,     /* its derivatives vanish where it holds */
  START_STEEP,    /* they have no value there */
  START_NONE      /* no state near that obeys it was found */
} StartKind;

typedef struct {
  StartKind kind;
  uint32_t constraint;   /* the one to blame, of Eqns.constraints */
  int velocities;        /* in its rate */
  long double residual;
} StartResult;

/* Values by symbol: parameters, and what the scene gives; 0 for what it does not. Closed contacts are open. */
long double *start_asked(const Eqns *e);

/* Brings them to the constraints as runtime/core/consistent.c does, by the same rules: what the scene does not give moves first, the rest
 * where that does not suffice; then to the nearest place, in the metric of the mass matrix; then velocities. What obeys the constraints
 * to a double's rounding stays. Otherwise symbols are left at the last place that was tried. */
StartResult start_find(const Eqns *e, StateSolver *solver, long double *symbols);

/* The same from what the scene gives, where there are constraints: found[2 n] of [q|v], and whether each was moved by more than a double's
 * rounding. Reported in the model's diagnostics when there is none and the scene gives a start; 0 then. */
int start_moves(const Eqns *e, long double *found, unsigned char *moved);

/* step[n] := where to look beside a state: `part` of how far each coordinate may be from 0 (as far as one of its unit is; an angle, 1), times 0.5 to
 * 1.5, so that none moves as another does. */
void start_steps_beside(const Eqns *e, long double *symbols, long double part, long double *step);

/* Says why there is none. */
void start_report(const Eqns *e, const StartResult *result);

/* What is said of how far a constraint is off: "; it is off by 0.1 [m]". */
const char *start_off_by(const Eqns *e, const StartResult *result);

#endif
