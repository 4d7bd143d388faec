/* Explicit Runge-Kutta methods that are rows of kernels/steppers.def, rk4 and others. Steps: adaptive_rk.c. f at the
 * end of a step is the first stage of the next, so dense output (lag_hermite) costs nothing. */
#include "kernels/steppers.def"
#include "methods/adaptive_rk.h"
#include "methods/steps.h"

enum {
#define ID(name, NAME, kind, dense, order, line, words) ID_##name,
  LAG_RUNGE_KUTTA_METHODS(ID)
};

/* Rows with dense output of their own have none here. */
#define OWN_CASE(name, NAME, kind)
#define HERMITE_CASE(name, NAME, kind) case ID_##name: { LAG_##NAME##_STAGES LAG_##NAME##_RESULT } break;
#define CASE(name, NAME, kind, dense, order, line, words) dense##_CASE(name, NAME, kind)
#define EMBEDDED_STAGES switch (id) { LAG_RUNGE_KUTTA_METHODS(CASE) default: break; }

#define OWN_ERRORS(name, NAME, kind)
#define HERMITE_ERRORS(name, NAME, kind) kind##_ERRORS(name, NAME)
#define FIXED_ERRORS(name, NAME)
#define ADAPTIVE_ERRORS(name, NAME) case ID_##name: { LAG_##NAME##_ERRORS } break;
#define LATE_ERRORS ADAPTIVE_ERRORS
#define ERRORS(name, NAME, kind, dense, order, line, words) dense##_ERRORS(name, NAME, kind)
#define EMBEDDED_ERRORS (void)per; switch (id) { LAG_RUNGE_KUTTA_METHODS(ERRORS) default: break; }
#include "methods/embedded_trial.h"

static void dense(void *work, lag_problem *pb, double t, double *y) {
  const Embedded *w = work;
  const EmbeddedPair *pair = pb->variant;
  int row = lag_adaptive_rk_row(pb);
  const double *y0 = w->x + EMBEDDED_Y0 * row, *y1 = w->x + EMBEDDED_Y1 * row, *k = w->x + EMBEDDED_K1 * row;
  lag_hermite(pb->nq, pb->nz, w->dt, (t - w->t0) / w->dt, y0, k, y1, k + (pair->tab->stages - 1) * row, y);
}

static const lag_method_option fixed_options[] = {LAG_STEP_OPTION};

/* ---- by rows */

#define FIXED_CONTROL(NAME) {0}
#define ADAPTIVE_CONTROL(NAME) {LAG_##NAME##_CONTROL}
#define LATE_CONTROL ADAPTIVE_CONTROL
#define FIXED_OPTIONS LAG_METHOD_CONSTRAINTS, .noptions = 1, .options = fixed_options
#define ADAPTIVE_OPTIONS                                                                                \
  LAG_METHOD_ADAPTIVE | LAG_METHOD_CONSTRAINTS, .noptions = LAG_NADAPTIVE_OPTIONS, .options = lag_adaptive_rk_options
#define LATE_OPTIONS ADAPTIVE_OPTIONS
enum { FIXED, ADAPTIVE, LATE };

#define OWN_METHOD(name, NAME, kind, of_order, line)
#define HERMITE_METHOD(id, NAME, kind, of_order, line)                                                     \
  static double id##_trial(Embedded *w, lag_problem *pb, double t, double tb, double dt, int *rc);          \
  static const EmbeddedPair id##_pair = {                                                                  \
      .tab = &lag_##id##_tableau, .late = kind == LATE, .control = kind##_CONTROL(NAME), .trial = id##_trial}; \
  EMBEDDED_TRIAL(id##_trial, id##_pair, ID_##id)                                                           \
  extern const lag_method lag_##id;                                                                        \
  const lag_method lag_##id = {.name = #id, .order = of_order, .dense_order = of_order < 4 ? of_order : 4,  \
                               .doc = line, .flags = kind##_OPTIONS, EMBEDDED_MEMBERS(id##_pair)};
#define METHOD(name, NAME, kind, dense, order, line, words) dense##_METHOD(name, NAME, kind, order, line)
LAG_RUNGE_KUTTA_METHODS(METHOD)
