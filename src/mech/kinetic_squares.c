/* Reads the squares off L with lets expanded; then looks for a coordinate singularity of M, in numbers, at multiples
 * of a quarter turn. */
#include "mech/kinetic_squares.h"

#include <math.h>

#include "base/dense_matrix.h"
#include "mech/velocity_degree.h"
#include "sym/diff.h"
#include "sym/expr_eval.h"
#include "sym/prove.h"

enum { COORDINATES_MOST = 8, FORMS_MOST = 32 };

typedef struct {
  const Eqns *e;
  SquareForms of;
  Expr *W, *weight;
} Squares;

/* Adds the form weight*base^2/2. 0: base is not linear in velocities, or there are too many forms. */
static int add_form(Squares *s, Expr weight, Expr base) {
  const Eqns *e = s->e;
  if (s->of.n == FORMS_MOST) return 0;
  ExprPartials d = expr_gradient_sparse(e->g, base, SYM_VEL, e->n);
  Expr *row = s->W + (size_t)s->of.n * e->n;
  for (uint32_t i = 0; i < d.n; i++) {
    if (has_velocities(e->g, d.at[i].e)) return 0;
    row[d.at[i].index] = d.at[i].e;
  }
  s->weight[s->of.n++] = weight;
  return 1;
}

/* Adds the squares of weight*x/2, a part of L. 0: x contributes to M and is no sum of squares. */
static int collect_squares(Squares *s, Expr weight, Expr x) {
  const Eqns *e = s->e;
  ExprGraph *g = e->g;
  Expr moving = 0;
  Num power = num_int(1), p;
  if (is_linear_in_velocities(e->g, x, e->n)) return 1;
  if (expr_op(g, x) == EX_SUM) {
    int taken = 1;
    for (uint32_t i = 0; i < expr_pairs(g, x, EX_SUM) && taken; i++) {
      Expr term = expr_pair(g, x, EX_SUM, i, &p);
      taken = collect_squares(s, expr_scale(g, p, weight), term);
    }
    return taken;
  }
  for (uint32_t i = 0; i < expr_pairs(g, x, EX_PROD); i++) {
    Expr base = expr_pair(g, x, EX_PROD, i, &p);
    if (!has_velocities(e->g, base)) {
      Expr still = expr_pow_num(g, base, p);
      weight = expr_mul(g, weight, still);
    } else if (!moving) {
      moving = base;
      power = p;
    } else {
      return 0;
    }
  }
  if (num_equal(power, num_int(2))) return add_form(s, weight, moving);
  return num_is_one(power) && moving != x && collect_squares(s, weight, moving);
}

/* --- where M is singular --- */

/* M[n*n] := the mass matrix at a state. 0: its entries are not finite. */
static int mass_at(const Eqns *e, const long double *symbols, long double *M) {
  Expr *roots = ARENA_ARRAY(e->m->arena, Expr, e->mass.n + 1);
  long double *value = ARENA_ARRAY(e->m->arena, long double, e->mass.n + 1), sum = 0;
  for (uint32_t k = 0; k < e->mass.n; k++) roots[k] = e->mass.at[k].e;
  expr_eval(e->g, roots, e->mass.n, symbols, value);
  for (uint32_t k = 0; k < e->n * e->n; k++) M[k] = 0;
  for (uint32_t k = 0; k < e->mass.n; k++) {
    uint32_t i = e->mass.at[k].row, j = e->mass.at[k].col;
    M[i * e->n + j] = M[j * e->n + i] = value[k];
    sum += value[k];
  }
  return isfinite(sum);
}

/* Number of coordinates involved in the kernel of M at a state, scaled by size[n], roots of the inertia elsewhere.
 * 0: M is regular. */
static uint32_t singular_along(const Eqns *e, const long double *symbols, const long double *size) {
  long double M[COORDINATES_MOST * COORDINATES_MOST], null[COORDINATES_MOST], most = 0;
  uint32_t along = 0;
  if (!mass_at(e, symbols, M) || dense_solve(e->m->arena, e->n, M, NULL, 1e-12L, null) == e->n) return 0;
  for (uint32_t i = 0; i < e->n; i++) most = fmaxl(most, fabsl(null[i]) * size[i]);
  for (uint32_t i = 0; i < e->n; i++) along += fabsl(null[i]) * size[i] > 1e-6L * most;
  return along;
}

/* Tries each coordinate in turn at 0 and at quarters of a turn, where angles have their poles; all other symbols are
 * random. A singularity along fewer than `least` coordinates does not count. */
static int find_singularity(const Eqns *e, uint32_t least, MassPole *pole) {
  long double *symbols = ARENA_ARRAY(e->m->arena, long double, expr_symbol_count(e->g) + 1);
  long double M[COORDINATES_MOST * COORDINATES_MOST], size[COORDINATES_MOST];
  if (!e->n || e->n > COORDINATES_MOST || !e->mass_known || e->constant_mass) return 0;
  sample_state(e->g, 1, symbols);
  if (!mass_at(e, symbols, M)) return 0;
  for (uint32_t i = 0; i < e->n; i++) size[i] = sqrtl(fabsl(M[i * e->n + i]));
  if (dense_solve(e->m->arena, e->n, M, NULL, 1e-12L, NULL) < e->n) return 0;
  for (uint32_t i = 0; i < e->n; i++) {
    const SymId q = e->m->coords.at[i].q;
    const long double was = symbols[q], quarter = acosl(-1) / 2;
    for (int k = 0; k < 4; k++) {
      static const int turns[] = {0, 1, -1, 2};
      symbols[q] = turns[k] * quarter;
      *pole = (MassPole){i, turns[k]};
      if (singular_along(e, symbols, size) >= least) return 1;
    }
    symbols[q] = was;
  }
  return 0;
}

int mass_pole(const Eqns *e, MassPole *pole) { return find_singularity(e, 1, pole); }

SquareForms kinetic_squares(const Eqns *e) {
  const SquareForms none = {0};
  if (e->n < 2 || e->n > COORDINATES_MOST || !e->m->lagrangian || e->m->constraints.n) return none;
  Squares s = {.e = e,
               .W = ARENA_ARRAY(e->m->arena, Expr, FORMS_MOST * (size_t)e->n),
               .weight = ARENA_ARRAY(e->m->arena, Expr, FORMS_MOST)};
  Expr L = expr_expand_defs(e->g, e->m->lagrangian), two = expr_int(e->g, 2);
  if (!collect_squares(&s, two, L) || s.of.n < e->n) return none;
  s.of.W = s.W;
  s.of.weight = s.weight;
  MassPole pole;
  return find_singularity(e, 2, &pole) ? s.of : none;
}
