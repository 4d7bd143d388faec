/* The inside of the self-check, shared by check_*.c and self_check.c. */
#ifndef LAGC_CHECK_IMPL_H
#define LAGC_CHECK_IMPL_H

#include "jets/self_check.h"
#include "jets/statements.h"

typedef JetReal Real;

enum { FEW = 6, LONG_TAPE = 30000 }; /* coordinates that are looked at one by one; instructions of a text at which one state must do */

/* A sum of terms, each with its error, and the sum of their sizes. */
typedef struct {
  Bounded sum;
  Real size;
  Real around; /* the size of what the terms themselves are made of, as far as it is known */
} Total;

typedef struct {
  const Eqns *e;
  const Model *m;
  const IrUnit *u;
  Arena *arena;
  TextDynamics *dynamics;
  TextOutputs *outputs;
  Jet *at, *at_outputs;
  const Prog *multipliers;
  uint64_t random;
  Real t, *q, *v, *a, *z, *zd, *zdd, *p, *given, *signal, *lambda, *gap; /* a state; given: parameters by their place in the model */
  Real *q0, *v0, *z0;                                     /* the scene's start */
  Real *c;          /* [n] the direction: of coordinates, or of states where L is of first order */
  Real error;       /* of accelerations and rates: rounding of the largest one; */
  Real *a_error, *zd_error, *lambda_error; /* and of each, of multipliers too, what becomes of rounding in the state: where the system that gives them is almost singular it is much more */
  uint32_t n, scene;
  int far;
  Real reach; /* of states beside the start: 1, or less once none was found on the constraints */
  Total energy;     /* of the text, at the state at hand, where */
  int has_energy;
  SelfCheck *told;
} Check;

typedef enum { AGREES, DISMISSED, DISAGREES } Verdict;

static inline Verdict worse(Verdict a, Verdict b) { return a > b ? a : b; }

/* The text says `t`, the program says `program`: an error tells of `what` `name` (or NULL) where they differ by more than rounding. DISMISSED where
 * rounding leaves nothing of the text's value. */
Verdict check_compare(Check *c, const Total *t, Real program, Span span, const char *what, const char *name);
Verdict check_value(Check *c, Bounded text, Real program, Span span, const char *what, const char *name);

void total_add(Total *t, Real factor, Bounded x);

/* Runs it in memory of its own, that is given back at once: a file may have thousands of scenes. */
int check_with(const Eqns *e, const IrUnit *u, uint32_t scene, SelfCheck *told, int (*run)(Check *c, const void *data), const void *data);

/* The state, for messages. */
const char *check_state_text(const Check *c);

/* check_state.c: room for states; one of them, on the constraints (0: it was not found); accelerations, rates and multipliers there, by the
 * program (0: it fails); runs a program at the state; a random number. */
void check_prepare(Check *c);
int check_choose_state(Check *c, int attempt);
int check_solve_motion(Check *c);
int check_run(const Check *c, const Prog *p, Real *const *out);
Real check_random(Check *c, Real lo, Real hi);

/* check_equations.c: runs the text's dynamics with displacements along c->c (0: something is not sure there); a coefficient of a value;
 * compares the equations of motion, momenta and forces; judges that the program failed where it should not have. */
int check_run_text(Check *c);
Bounded check_coefficient(const Tape *tape, const Jet *at, Ref r, int plane, int k);
void check_input(void *data, InputKind kind, uint32_t i, Jet *out);
uint32_t check_components(const Check *c);
Total check_residual(const Check *c); /* along c->c, of the text that was run last */
Verdict check_equations(Check *c);
Verdict check_failure(Check *c);

/* check_values.c: flows, constraints, energy; events, outputs, inputs. */
Verdict check_dynamic_values(Check *c);
Verdict check_other_values(Check *c);

/* check_motion.c: along the motion that the accelerations make: charges, linearisation, Taylor coefficients. */
Verdict check_motion(Check *c);

#endif
