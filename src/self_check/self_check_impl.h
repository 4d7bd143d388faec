/* State and parts of the self-check, shared by check_*.c, nonfinite.c and self_check.c. */
#pragma once

#include "self_check/self_check.h"
#include "self_check/statements.h"

typedef JetReal Real;

/* most coordinates checked one by one; tape length from which one state suffices */
enum { FEW = 6, LONG_TAPE = 30000 };

/* Sum of terms with error bounds, and the sum of their magnitudes. */
typedef struct {
  Bounded sum;
  Real size;
  Real inner_magnitude; /* magnitude of the quantities inside the terms, as far as known */
} BoundedSum;

typedef struct {
  const Eqns *e;
  const Model *m;
  const ProgramSet *u;
  Arena *arena;
  TextDynamics *dynamics;
  TextOutputs *outputs;
  Jet *at, *at_outputs;
  const Prog *multipliers;
  uint64_t random;
  /* the state; p in program order, given in model order */
  Real t, *q, *v, *a, *z, *zd, *zdd, *p, *given, *signal, *lambda, *gap;
  Real *q0, *v0, *z0;                                     /* the scene's start */
  Real *c;          /* virtual displacement: [coordinates], or [states] where L is of first order */
  Real error;       /* rounding of the largest acceleration or rate */
  /* Change of each acceleration, rate and multiplier under rounding of the state: large where M is almost singular. */
  Real *a_error, *zd_error, *lambda_error;
  uint32_t n, scene;
  int samples; /* quantified sums have a sample of their terms, in the text and in programs alike */
  int far;
  Real reach; /* relative distance of near states from the start: 1, reduced when projection on the constraints fails */
  BoundedSum energy;     /* energy of the text at this state, if has_energy */
  int has_energy;
  SelfCheck *statistics;  /* counts of what was compared */
} Check;

static inline Real *check_reals(const Check *c, uint32_t n) { return ARENA_ARRAY(c->arena, Real, n + 1); }

typedef enum { AGREES, DISMISSED, DISAGREES } CheckVerdict;

static inline CheckVerdict worse(CheckVerdict a, CheckVerdict b) { return a > b ? a : b; }

/* Compares the text's value t with the program's; reports a difference beyond rounding as an internal error in
 * `what` `name` (or NULL). DISMISSED: rounding left no digits of the text's value. */
CheckVerdict check_compare(Check *c, const BoundedSum *t, Real program, Span span, const char *what, const char *name);
CheckVerdict check_value(Check *c, Bounded text, Real program, Span span, const char *what, const char *name);

void bounded_sum_add(BoundedSum *t, Real factor, Bounded x);

/* Calls run() with a new Check whose arena is freed on return: a file may have thousands of scenes. */
int check_with(const Eqns *e, const ProgramSet *u, uint32_t scene, SelfCheck *statistics,
               int (*run)(Check *c, const void *data), const void *data);

/* The state as text, for messages. */
const char *check_state_text(const Check *c);

/* check_state.c: allocates states; chooses one on the constraints (0: none found); computes accelerations, rates and
 * multipliers by the programs (0: they fail), and with check_solve_motion bounds on their rounding; runs a program at
 * the state (0: it fails); uniform random number. */
void check_prepare(Check *c);
int check_choose_state(Check *c, int attempt);
int check_solve(Check *c);
int check_solve_motion(Check *c);
int check_run(const Check *c, const Prog *p, Real *const *out);
Real check_random(Check *c, Real lo, Real hi);

/* check_equations.c: evaluates the text's dynamics with displacement c->c (0: a comparison or value is unsure);
 * coefficient k of plane `plane` of a value; compares equations of motion, momenta, forces; judges whether a failure
 * of the program is an error. */
int check_run_text(Check *c);
Bounded check_coefficient(const Tape *tape, const Jet *at, Ref r, int plane, int k);
void check_input(void *data, InputKind kind, uint32_t i, Jet *out);
uint32_t check_components(const Check *c);
Real check_rounding_part(Check *c); /* of the sizes of all equations' terms, by their error bounds; overwrites c->c */
BoundedSum check_residual(const Check *c); /* along c->c, from the last check_run_text */
CheckVerdict check_equations(Check *c);
CheckVerdict check_failure(Check *c);

/* check_zeros.c: equations of motion near zeros of divisors; warns where they have lost digits. */
void check_zeros(Check *c);

/* check_values.c: flows, constraints, energy; events, outputs, inputs. */
CheckVerdict check_dynamic_values(Check *c);
CheckVerdict check_other_values(Check *c);

/* check_motion.c: charges, matrices, Taylor coefficients. Derivative of a function from its values at -h, h, -2h,
 * 2h, with an error bound. */
CheckVerdict check_motion(Check *c);
BoundedSum check_derivative(const Real at[4], Real h, Real size, Real rounding);

/* check_matrices.c: mass matrix, bias, inverse dynamics; derivatives by state, inputs and parameters, against finite
 * differences of the text. */
CheckVerdict check_matrices(Check *c);
void check_keep_rotations(Check *c); /* makes c->c a displacement that keeps rotations of unit length */
