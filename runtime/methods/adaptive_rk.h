/* Explicit Runge-Kutta methods, shared by all: a method is a tableau, the constants of its
 * step control, and its dense output. A tableau whose order_embedded is 0 has no error estimate: all its steps are
 * of equal size. */
#pragma once

#include "methods/step_control.h"
#include "methods/tableau.h"

typedef struct EmbeddedPair EmbeddedPair;
typedef struct Embedded Embedded;

struct EmbeddedPair {
  const lag_tableau *tab;
  int late;            /* 1: the error does not use the last stage, which is computed once the step is accepted */
  lag_controller control;
  int more;            /* rows of Embedded.x behind the stages, for dense output */

  /* One trial step from (t, Y0) to tb = t + dt: fills Y1 and COMP1, returns the squared norm of the error, NaN where
   * a value is not finite. *rc: status of the model; > 0: a smaller step may help. Defined by EMBEDDED_TRIAL of
   * embedded_trial.h. */
  double (*trial)(Embedded *w, lag_problem *pb, double t, double tb, double dt, int *rc);
};

/* Saved state of the method, doubles only; x holds the arrays named below, each a row of lag_adaptive_rk_row()
 * doubles (n, then zeros). x is aligned to a cache line: a pair of doubles across two lines is slow to read back. */
struct Embedded {
  double h;         /* the next step to try, > 0; 0: not chosen yet */
  lag_step_limits limits;
  double ready;     /* 1: K1 = f(t, y) is known; 2: the last stage holds f(t, y) */
  double have_extra; /* extra stages of dense output: 1 known, -1 failed, 0 not computed */
  double err_power; /* PI controller: (error of the last accepted step)^-beta; 0: no such step */
  double t0, dt;    /* the last step */
  double tc;        /* compensation of t: rounding lost so far */
  double per;       /* 1/n */
  double across;    /* squared error including the part across the constraints, where err left that part out; else 0 */
  _Alignas(LAG_WORK_ALIGN) double x[];
};

/* COMP: rounding that y has lost; COMP1: the same after the step. YS: stage or scratch. K1: first of stages + extra
 * arrays. */
enum { EMBEDDED_COMP, EMBEDDED_COMP1, EMBEDDED_Y0, EMBEDDED_Y1, EMBEDDED_YS, EMBEDDED_K1 };

extern const lag_method_option lag_adaptive_rk_options[LAG_NADAPTIVE_OPTIONS];

/* Rows have even length, so that loops over pairs have no remainder. Small models share one length, known at compile
 * time. */
enum { EMBEDDED_SMALL = 8 };
static inline int lag_adaptive_rk_row(const lag_problem *pb) {
  return pb->n <= EMBEDDED_SMALL ? EMBEDDED_SMALL : (pb->n + 1) & ~1;
}

static inline double *lag_adaptive_rk_array(Embedded *w, const lag_problem *pb, int which) {
  return w->x + which * lag_adaptive_rk_row(pb);
}

/* Members of lag_method of the same names; lag_method.variant is the EmbeddedPair. */
size_t lag_adaptive_rk_work_size(const lag_problem *pb);
int lag_adaptive_rk_init(void *work, lag_problem *pb, const double *opt);
void lag_adaptive_rk_reset(void *work, lag_problem *pb);
int lag_adaptive_rk_step(void *work, lag_problem *pb, double *t, double *y, double t_stop);
size_t lag_adaptive_rk_tangent_size(const lag_problem *pb, int k);
int lag_adaptive_rk_tangent(void *work, lag_problem *pb, double t, int k, double *Y, double *scratch);
double lag_adaptive_rk_span(const void *work, const lag_problem *pb, double t);
size_t lag_adaptive_rk_adjoint_size(const lag_problem *pb);
int lag_adaptive_rk_adjoint(lag_problem *pb, double t0, double dt, const double *y0, double *x, double *g,
                            double *scratch);

/* Before a step at t, y: K1 := f(t, y), Y0 := y, w->h := the step to try. LAG_OK, or a failure. */
int lag_adaptive_rk_prepare(const EmbeddedPair *pair, Embedded *w, lag_problem *pb, double t, const double *y);

/* > 0: a coordinate moved against its velocities at both ends of the step to tb, in a model whose constraints
 * contain time. The step led over a pole, as of x = tan(t), or is too long; the error estimate does not see it,
 * because constraints determine the coordinate. */
int lag_adaptive_rk_reversal(Embedded *w, lag_problem *pb, double tb);
/* Squared error of the step just computed, along the constraints only: the part that projection removes is large
 * near singular positions and says nothing of the result. whole: squared error including that part, kept in
 * w->across. */
double lag_adaptive_rk_error_along(const lag_tableau *tab, int late, Embedded *w, lag_problem *pb, double tb, double dt,
                                   double whole);

/* The members that descriptors share, all but dense, a function of the file that uses it, as is `pair`. */
#define EMBEDDED_DESCRIPTOR                                                                                          \
  .flags = LAG_METHOD_ADAPTIVE | LAG_METHOD_CONSTRAINTS,                                                     \
  .noptions = LAG_NADAPTIVE_OPTIONS, .options = lag_adaptive_rk_options, EMBEDDED_FUNCTIONS
#define EMBEDDED_FUNCTIONS EMBEDDED_MEMBERS(pair)
#define EMBEDDED_MEMBERS(pair)                                                            \
  .variant = &pair, .work_size = lag_adaptive_rk_work_size, .init = lag_adaptive_rk_init, \
  .step = lag_adaptive_rk_step, .dense = dense, .reset = lag_adaptive_rk_reset,           \
  .tangent_size = lag_adaptive_rk_tangent_size, .tangent = lag_adaptive_rk_tangent,       \
  .span = lag_adaptive_rk_span, .adjoint_size = lag_adaptive_rk_adjoint_size, .adjoint = lag_adaptive_rk_adjoint
