/* Weights of the regularising term: of the size of the inertia that the constraint moves. They affect only the
 * rounding, and the constraint error in the middle of a step. */
#include "mech/constraint_regularise.h"

#include <math.h>

#include "mech/constrain.h"
#include "mech/consistent_start.h"
#include "sym/expr_eval.h"

static int is_fixed(const Eqns *e, Expr x) { return expr_is_constant(e->g, x) && !expr_is_zero(e->g, x); }

/* Diagonal entry j of M if constant, else 0. */
static Expr inertia_of(const Eqns *e, uint32_t j) {
  for (uint32_t i = 0; i < e->mass.n; i++)
    if (e->mass.at[i].row == j && e->mass.at[i].col == j && is_fixed(e, e->mass.at[i].e)) return e->mass.at[i].e;
  return 0;
}

/* A constant inertia: of a coordinate in constraint k, else of any coordinate, else 1. */
static Expr typical_inertia(const Eqns *e, uint32_t k) {
  const Entries *A = &e->constraints.A;
  for (uint32_t i = 0; i < A->n; i++)
    if (A->at[i].row == k && inertia_of(e, A->at[i].col)) return inertia_of(e, A->at[i].col);
  for (uint32_t j = 0; j < e->n; j++)
    if (inertia_of(e, j)) return inertia_of(e, j);
  return expr_int(e->g, 1);
}

/* The power of two next to 1/sum A_kj^2 near the scene's start. */
static Num weight_near_start(const Eqns *e, uint32_t k) {
  const Entries *A = &e->constraints.A;
  const Model *m = e->m;
  uint32_t all = expr_symbol_count(e->g) + 1, n = 0;
  long double *there = ARENA_ARRAY(m->arena, long double, all), *asked = start_requested(e),
              *step = ARENA_ARRAY(m->arena, long double, e->n), sum = 0;
  Expr *row = ARENA_ARRAY(m->arena, Expr, A->n + 1);
  long double *value = ARENA_ARRAY(m->arena, long double, A->n + 1);
  for (uint32_t i = 0; i < all; i++) there[i] = asked[i];
  start_nearby_steps(e, asked, 0.1L, step);
  for (uint32_t i = 0; i < e->n; i++) there[m->coords.at[i].q] += step[i];
  for (uint32_t i = 0; i < A->n; i++)
    if (A->at[i].row == k) row[n++] = A->at[i].e;
  expr_eval(e->g, row, n, there, value);
  for (uint32_t i = 0; i < n; i++) sum += value[i] * value[i];
  int power = sum > 0 && isfinite(sum) ? (int)lroundl(-log2l(sum)) : 0;
  power = power > 40 ? 40 : power < -40 ? -40 : power;
  return power >= 0 ? num_int(INT64_C(1) << power) : num_ratio(1, INT64_C(1) << -power);
}

/* M_jj/A_kj^2 where both are constants: the right dimension, and it follows parameters. Else an estimate near the
 * start. */
static Expr weight(const Eqns *e, uint32_t k) {
  const Entries *A = &e->constraints.A;
  for (uint32_t i = 0; i < A->n; i++) {
    Expr own = A->at[i].row == k && is_fixed(e, A->at[i].e) ? inertia_of(e, A->at[i].col) : 0;
    if (!own) continue;
    Expr square = expr_pow_num(e->g, A->at[i].e, num_int(2));
    return expr_div(e->g, own, square);
  }
  Expr typical = typical_inertia(e, k);
  return expr_scale(e->g, weight_near_start(e, k), typical);
}

Expr regularising_term(const Eqns *e) {
  const Constraints *all = &e->constraints;
  Expr *terms = ARENA_ARRAY(e->m->arena, Expr, all->n + 1);
  uint32_t n = 0;
  for (uint32_t k = 0; k < all->n; k++) {
    if (contact_of_constraint(e->m, all->of[k])) continue;
    Expr square = expr_pow_num(e->g, all->r[k], num_int(2)), w = weight(e, k);
    Expr term = expr_mul(e->g, w, square);
    terms[n++] = expr_scale(e->g, num_ratio(1, 2), term);
  }
  return expr_add_n(e->g, terms, n);
}
