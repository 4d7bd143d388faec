/* Gauss collocation of y' = f(t, y) for models with states only (nq = 0): flows, and Lagrangians linear in all
 * velocities. */
#pragma once

#include "lag.h"

/* Fixed steps of size h with 1 .. LAG_RULE_FREE stages; the order is twice the number of stages. Needs the
 * linearisation, and nq = 0. */
size_t lag_collocation_size(const lag_problem *pb, int stages);
void lag_collocation_init(void *work, lag_problem *pb, double h, int stages);

/* Members of lag_method of the same names. */
void lag_collocation_reset(void *work, lag_problem *pb);
int lag_collocation_step(void *work, lag_problem *pb, double *t, double *y, double t_stop);
void lag_collocation_dense(void *work, lag_problem *pb, double t, double *y);
size_t lag_collocation_tangent_size(const lag_problem *pb, int k);
int lag_collocation_tangent(void *work, lag_problem *pb, double t, int k, double *Y, double *scratch);
