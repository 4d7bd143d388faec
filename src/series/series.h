/* Prog -> Series: the recurrences of the Taylor coefficients of a model's motion.
 *
 * A value x(t) along the motion from t0 on has coefficients x[k] = x^(k)(t0) T^k / k!, in time measured in units of
 * T. Automatic differentiation gives coefficient k of each value from those of its operands up to k, and those of
 * itself below k (E. Hairer, S.P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed. 1993, DOI
 * 10.1007/978-3-540-78862-1, I.8; A. Jorba, M. Zou, Experimental Mathematics 14 (2005) 99, DOI
 * 10.1080/10586458.2005.10128904, section 2). Lower orders enter only by convolution sums
 *
 *     s = a[1] b[k-1] + a[2] b[k-2] + ... + a[k-1] b[1]
 *
 * over pairs of values (a, b); the rest is straight-line code in the coefficients of order k. So a Series is two
 * programs and a list of pairs, of a size proportional to the model's program; the loops over the order are the same
 * for all models.
 *
 * M q'' = f is solved order by order with the factors of M[0], which `first` makes: M[0] q''[k] is
 * f[k] - M[k] q''[0] less the sums over M and q''. Where M is kept as a product, through definitions w' = C q'' + ...
 * (mech/augmented_system.h), the same holds for the larger sparse system of the rates w' and their adjoints,
 *     H u' + C^T lambda = f (rows of q),   H u' + C^T lambda = lambda (rows of w),   w' = C u',
 * so that the number of sums is proportional to the length of the text. */
#pragma once

#include "ir/factorization_record.h"
#include "ir/program_set.h"

typedef struct {
  uint32_t row, col;
  Slot slot;
} IrSlotEntry;
typedef VEC(IrSlotEntry) IrEntries;

/* A program for q'' and the rates of the states, with the slots of the linear system that it solves: see
 * LinearSystem in mech/eqns.h. Unknowns are accelerations and, from nq on, the rates of definitions. */
typedef struct {
  Prog *p;
  uint32_t nq, ndefs, nz;
  IrEntries H, C;        /* H: lower triangle */
  const Slot *f;         /* [nq] */
  const Slot *x;         /* [nq + ndefs] the solution */
  const FactorRecord *factored; /* the factors by which x was found */
  const Slot *flow;      /* [nz] */
  const Name *velocities, *rates; /* [nq] and [nq + nz]: names of q', and of q'' and z' */
} IrSystem;

/* NULL where the program is not analytic; *why is then the function or word ("abs", "if") that is not. */
Series *series_new(const IrSystem *system, const char **why);
