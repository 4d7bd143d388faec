/* Consistent start of a run: the scene's start values, moved onto the constraints. */
#pragma once

#include "mech/states.h"
#include "numeric/consistent_state.h"

typedef struct {
  lag_start_kind kind;
  uint32_t constraint;   /* index of the violated constraint in Eqns.constraints */
  int velocities;        /* its rate is violated, not its position */
  long double residual;
} StartResult;

/* Values by symbol: parameters, the scene's start values and inputs then; 0 for all other symbols, so that all contacts
 * are open. */
long double *start_requested(const Eqns *e);

/* Moves symbols (from start_requested) onto the constraints as a run does (numeric/consistent_state.h): positions
 * that the scene does not give first, then velocities. On failure symbols hold the last state that was tried. */
StartResult start_find(const Eqns *e, StateSolver *solver, long double *symbols);

/* The consistent start for the scene: found[2 n] = [q|v], and moved[2 n], set where a value moved by more than a
 * double's rounding. Without constraints, or if none was found, the scene's own values; 0, reported in the
 * diagnostics, if none was found and the scene gives a start. */
int start_of_scene(const Eqns *e, long double *found, unsigned char *moved);

/* step[n] := displacements to a nearby state: `part` times the size of each coordinate (the largest of its unit; at
 * least 1 for an angle) times a factor from 0.5 to 1.5, different for each coordinate. */
void start_nearby_steps(const Eqns *e, const long double *symbols, long double part, long double *step);

/* Moves the symbols, whose positions obey the constraints, to positions about a hundredth away that do, too; 0: none
 * was found. */
int start_beside(const Eqns *e, StateSolver *solver, long double *symbols);

/* Reports in the model's diagnostics why there is no consistent start. */
void start_report(const Eqns *e, const StartResult *result);

/* Text of a constraint's residual: "; it is off by 0.1 [m]"; "" if not finite. */
const char *start_residual_text(const Eqns *e, const StartResult *result);
