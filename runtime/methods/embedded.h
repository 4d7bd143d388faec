/* Embedded explicit Runge-Kutta methods: all that rk45 and dop853 share. A method is a tableau, the constants of
 * its step control, and its dense output. */
#ifndef LAG_METHODS_EMBEDDED_H
#define LAG_METHODS_EMBEDDED_H

#include "lag.h"
#include "methods/tableau.h"

typedef struct EmbeddedPair {
  const lag_tableau *tab;
  int late;            /* the error does not need the last stage: it waits until the step is accepted */
  double power, beta;  /* h grows by safety err_old^beta / err^power */
  double shrink_most, grow_most;
} EmbeddedPair;

/* One block of doubles; x holds the arrays of n named below. */
typedef struct Embedded {
  double h;         /* the next step to try, > 0; 0: not chosen yet */
  double h_option, h_max, atol;
  double fixed;     /* 1: every step has the size h */
  double ready;     /* 1: K1 = f(t, y) is known; 2: it stands in the last stage */
  double have_extra; /* the stages of the dense output: 1 are known, -1 cannot be had, 0 not asked for yet */
  double err_power; /* (error of the last accepted step)^beta, of the PI controller; 0: there is none */
  double t0, dt;    /* the last step */
  double tc;        /* what t has lost to rounding */
  double t_begin;   /* where the first step began */
  double begun;
  double x[];
} Embedded;

/* COMP: what y has lost to rounding; COMP1: the same after the step. K1: the first of stages + extra arrays. */
enum { EMBEDDED_COMP, EMBEDDED_COMP1, EMBEDDED_Y0, EMBEDDED_Y1, EMBEDDED_YS, EMBEDDED_K1 };

enum { EMBEDDED_NOPTIONS = 4 };
extern const lag_method_option lag_embedded_options[EMBEDDED_NOPTIONS];

/* Doubles of work, with `more` arrays of n behind the stages. */
size_t lag_embedded_size(const EmbeddedPair *pair, const lag_problem *pb, int more);

/* These are as lag_method says. */
int lag_embedded_init(void *work, lag_problem *pb, const double *opt);
void lag_embedded_reset(void *work, lag_problem *pb);
int lag_embedded_step(const EmbeddedPair *pair, void *work, lag_problem *pb, double *t, double *y);

/* The derivative of the last step, or of a shorter one. */
size_t lag_embedded_tangent_size(const EmbeddedPair *pair, const lag_problem *pb, int k);
int lag_embedded_tangent(const EmbeddedPair *pair, void *work, lag_problem *pb, double t, int k, double *Y, double *scratch);

/* What the descriptors have in common, after their own work_size, step, dense and tangent. */
#define EMBEDDED_DESCRIPTOR                                                                          \
  .flags = LAG_METHOD_ADAPTIVE | LAG_METHOD_CONSTRAINTS, .noptions = EMBEDDED_NOPTIONS, .options = lag_embedded_options,      \
  .work_size = work_size, .init = lag_embedded_init, .step = step, .dense = dense, .reset = lag_embedded_reset,      \
  .tangent_size = tangent_size, .tangent = tangent

/* out := sum_j coef[j] K_j over j < count. */
void lag_embedded_sum(const double *k, int n, int count, const double *coef, double *restrict out);

/* K_s = f(t0 + c_s dt, y0 + dt sum a_sj K_j). ys[n] is scratch. > 0: a smaller step may help. */
int lag_embedded_stage(const lag_tableau *tab, lag_problem *pb, int s, double t0, double dt, const double *y0, double *k,
                       double *ys);

#endif
