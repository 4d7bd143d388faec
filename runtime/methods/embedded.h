/* Embedded explicit Runge-Kutta methods: all that rk45 and dop853 share. A method is a tableau, the constants of
 * its step control, and its dense output. */
#ifndef LAG_METHODS_EMBEDDED_H
#define LAG_METHODS_EMBEDDED_H

#include "lag.h"
#include "methods/tableau.h"

typedef struct EmbeddedPair EmbeddedPair;
typedef struct Embedded Embedded;

struct EmbeddedPair {
  const lag_tableau *tab;
  int late;            /* the error does not need the last stage: it waits until the step is accepted */
  double beta;         /* h grows by safety err_old^beta / err^(ratio beta) */
  int ratio;
  double safety, shrink_most, grow_most;

  /* Stages and error of one trial from (t, Y0) to tb = t + dt: Y1, COMP1, and the square of the error's norm; NaN when anything in
   * it is not finite. *rc: the model's answer; > 0: a smaller step may help. By EMBEDDED_TRIAL of embedded_trial.h. */
  double (*trial)(Embedded *w, lag_problem *pb, double t, double tb, double dt, int *rc);
};

/* One block of doubles; x holds the arrays named below, each in a row of lag_embedded_row() doubles: n, and zeros. It begins at a line of
 * the cache: a pair across two lines is slow to read back, and the stages wait for little else. */
struct Embedded {
  double h;         /* the next step to try, > 0; 0: not chosen yet */
  double h_option, h_max, atol;
  double fixed;     /* 1: every step has the size h */
  double ready;     /* 1: K1 = f(t, y) is known; 2: it stands in the last stage */
  double have_extra; /* the stages of the dense output: 1 are known, -1 cannot be had, 0 not asked for yet */
  double err_power; /* (error of the last accepted step)^-beta, of the PI controller; 0: there is none */
  double t0, dt;    /* the last step */
  double tc;        /* what t has lost to rounding */
  double t_begin;   /* where the first step began */
  double begun;
  double per;       /* 1/n */
  double across;    /* the square of the error with what the projection takes back, where that was left out of it; or 0 */
  _Alignas(LAG_WORK_ALIGN) double x[];
};

/* COMP: what y has lost to rounding; COMP1: the same after the step. K1: the first of stages + extra arrays. */
enum { EMBEDDED_COMP, EMBEDDED_COMP1, EMBEDDED_Y0, EMBEDDED_Y1, EMBEDDED_YS, EMBEDDED_K1 };

enum { EMBEDDED_NOPTIONS = 4 };
extern const lag_method_option lag_embedded_options[EMBEDDED_NOPTIONS];

/* Rows are whole pairs: sums over them have no remainder. Those of small models are of one size, which the compiler knows. */
enum { EMBEDDED_SMALL = 8 };
static inline int lag_embedded_row(const lag_problem *pb)
{
  return pb->n <= EMBEDDED_SMALL ? EMBEDDED_SMALL : (pb->n + 1) & ~1;
}

static inline double *lag_embedded_array(Embedded *w, const lag_problem *pb, int which)
{
  return w->x + which * lag_embedded_row(pb);
}

/* Doubles of work, with `more` rows behind the stages. */
size_t lag_embedded_size(const EmbeddedPair *pair, const lag_problem *pb, int more);

/* These are as lag_method says. */
int lag_embedded_init(void *work, lag_problem *pb, const double *opt);
void lag_embedded_reset(void *work, lag_problem *pb);
int lag_embedded_sound(const void *work, const void *fresh, const lag_problem *pb);
int lag_embedded_step(const EmbeddedPair *pair, void *work, lag_problem *pb, double *t, double *y);

/* > 0 where constraints contain the time, and a coordinate has gone back while its velocities at both ends, tb being the later one, lead on: it ran off to
 * infinity, and came from the other side, as x = tan(t) does, or the step is too long for what the time makes of it. What constraints
 * determine has no error that would tell. */
int lag_embedded_turns(Embedded *w, lag_problem *pb, double tb);
/* The square of the error of the step just computed, without what its projection takes back: near positions where constraints become
 * dependent that part is large, and says nothing. whole: with it. */
double lag_embedded_error_along(const lag_tableau *tab, int late, Embedded *w, lag_problem *pb, double tb, double dt, double whole);

/* The derivative of the last step, or of a shorter one. */
size_t lag_embedded_tangent_size(const EmbeddedPair *pair, const lag_problem *pb, int k);
int lag_embedded_tangent(const EmbeddedPair *pair, void *work, lag_problem *pb, double t, int k, double *Y, double *scratch);

/* What the descriptors have in common, after their own work_size, step, dense and tangent. */
#define EMBEDDED_DESCRIPTOR                                                                          \
  .flags = LAG_METHOD_ADAPTIVE | LAG_METHOD_CONSTRAINTS | LAG_METHOD_STRETCHES | LAG_METHOD_LANDS,                   \
  .noptions = EMBEDDED_NOPTIONS, .options = lag_embedded_options,                                                    \
  .work_size = work_size, .init = lag_embedded_init, .step = step, .dense = dense, .reset = lag_embedded_reset,      \
  .sound = lag_embedded_sound,                                                                                       \
  .tangent_size = tangent_size, .tangent = tangent

#endif
