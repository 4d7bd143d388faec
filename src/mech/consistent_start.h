/* Consistent start of a run: the scene's start values, moved onto the constraints. */
#ifndef LAGC_MECH_CONSISTENT_START_H
#define LAGC_MECH_CONSISTENT_START_H

#include "mech/states.h"

typedef enum {
  START_FOUND,
  START_NO_VALUE, /* the constraint has no value where the scene starts */
  START_BROKEN,   /* values given `exactly` violate the constraint */
  START_FLAT,     /* its derivatives vanish where it holds */
  START_STEEP,    /* its derivatives have no value where it holds */
  START_NONE      /* no state near the start was found that obeys it */
} StartKind;

typedef struct {
  StartKind kind;
  uint32_t constraint;   /* index of the violated constraint in Eqns.constraints */
  int velocities;        /* its rate is violated, not its position */
  long double residual;
} StartResult;

/* Values by symbol: parameters and the scene's start values; 0 for all other symbols, so that all contacts are open. */
long double *start_requested(const Eqns *e);

/* Moves symbols (from start_requested) onto the constraints by the rules of runtime/constraints/consistent_start.c: positions that the scene does not give
 * move first, the others if that does not suffice; then to the nearest state in the metric of the mass matrix; then velocities. A state that
 * obeys the constraints to a double's rounding stays. On failure symbols hold the last state that was tried. */
StartResult start_find(const Eqns *e, StateSolver *solver, long double *symbols);

/* The consistent start for the scene: found[2 n] = [q|v], and moved[2 n], set where a value moved by more than a double's rounding. Without
 * constraints, or if none was found, the scene's own values; 0, reported in the diagnostics, if none was found and the scene gives a start. */
int start_of_scene(const Eqns *e, long double *found, unsigned char *moved);

/* step[n] := displacements to a nearby state: `part` times the size of each coordinate (the largest of its unit; at least 1 for an angle) times
 * a factor from 0.5 to 1.5, different for each coordinate. */
void start_nearby_steps(const Eqns *e, long double *symbols, long double part, long double *step);

/* Reports in the model's diagnostics why there is no consistent start. */
void start_report(const Eqns *e, const StartResult *result);

/* Text of a constraint's residual: "; it is off by 0.1 [m]"; "" if not finite. */
const char *start_residual_text(const Eqns *e, const StartResult *result);

#endif
