/* Inline parts of the right-hand side, called so often, for so few numbers, that a function call would take as long
 * as the work: for rhs.c and for methods with many stages; and the compensated sum of all steps. */
#pragma once

#include <math.h>

#include "kernels/compensated_sum.h"
#include "lag.h"

#ifdef __GNUC__
#define LAG_ALWAYS_INLINE static inline __attribute__((always_inline))
#define LAG_RARE static __attribute__((noinline)) /* work of few steps: others do not save registers for it */
#else
#define LAG_ALWAYS_INLINE static inline
#define LAG_RARE static
#endif

/* to[n] := from[n]. */
LAG_ALWAYS_INLINE void lag_copy(int n, const double *from, double *to) {
  int i = 0;
  for (; i + 1 < n; i += 2) {
    double a = from[i], b = from[i + 1];
    to[i] = a;
    to[i + 1] = b;
  }
  if (i < n) to[i] = from[i];
}

/* The reverse mode of a model; NULL: not emitted. */
static inline const lag_adjoint *lag_adjoint_of(const lag_model *m) {
  return m->constraints ? m->constraints->adjoint : m->linear ? m->linear->adjoint : NULL;
}

/* linearisation.c: g[nu + np] += by_up, and by parameters of the inputs that follow their formulas; by_up and d as
 * lag_adjoint gives them. */
void lag_add_by_parameters(const lag_problem *pb, const double *by_up, const double *d, double *g);

/* linearisation.c: whether the mass matrix is diagonal, so that elements of the Jacobian are those of the residuals';
 * and lag_fine_jacobian that sets only these, model->linear->dr, and the columns by parameters. */
int lag_has_listed_jacobian(const lag_problem *pb);
int lag_listed_jacobian(lag_problem *pb, const lag_parameter_columns *by, double t, const double *y, double *J,
                        double *work);

/* The parts that few models have: pb->u := inputs and modes of switches; where constraints are redundant, *y := its
 * projection onto them. */
int lag_rhs_prepare(lag_problem *pb, double t, const double **y);

/* switching.c: modes in pb->u that keep the motion on the surfaces on which it slides, at y, t. > 0: there are none. */
int lag_sliding_values(lag_problem *pb, double t, const double *y);

/* contact_friction.c: friction of contacts that slip, in pb->u, at y, t. > 0: there is none. */
int lag_contact_friction_forces(lag_problem *pb, double t, const double *y);

/* moreau_contacts.c: size of pb->contact_room in doubles. */
size_t lag_moreau_contacts_size(const lag_model *m);
/* moreau_families.c: rows of families of contacts that may act at once, and the most numbers that each reads. */
int lag_family_rows_of(const lag_model *m);
int lag_family_parts_of(const lag_model *m);

/* Inline lag_inputs; the distance to the next row of a table or kick, as lag_next_row. */
LAG_ALWAYS_INLINE int lag_inputs_inline(lag_problem *pb, double t) {
  return pb->model->nu | pb->model->nmodes ? lag_inputs(pb, t) : 0;
}

/* Distance from t to the next kick, *at; HUGE_VAL where there is none. */
LAG_ALWAYS_INLINE double lag_next_kick(const lag_problem *pb, double t, double *at) {
  *at = pb->kick;
  return pb->kick > t ? pb->kick - t : HUGE_VAL;
}

LAG_ALWAYS_INLINE double lag_next_row_inline(const lag_problem *pb, double t, double *row) {
  double kick, gap = pb->model->ntables ? lag_next_row(pb, t, row) : HUGE_VAL, to_kick = lag_next_kick(pb, t, &kick);
  if (to_kick < gap) *row = kick;
  return to_kick < gap ? to_kick : gap;
}

#ifndef LAG_LANES /* where accel takes vectors */
/* Inline lag_rhs; nq is the model's, perhaps a compile-time constant. */
LAG_ALWAYS_INLINE int lag_rhs_inline(lag_problem *pb, int nq, double t, const double *y, double *dy) {
  const lag_model *m = pb->model;
  pb->rhs_calls++;
  if (m->nu | m->nmodes | pb->redundant) {
    int rc = lag_rhs_prepare(pb, t, &y);
    if (rc) return rc;
  }
  lag_copy(nq, y + nq, dy);
  return m->accel(m, t, y, y + nq, y + 2 * nq, pb->p, pb->u, dy + nq, dy + 2 * nq, pb->work);
}
#endif

/* methods/taylor.c: the order of the series, from the work of a run by taylor that has begun. */
double lag_taylor_order(const double *method_work);
