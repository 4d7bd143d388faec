/* Holonomic constraints by index reduction: c = 0 is kept as c, c' and c'' (E. Hairer, G. Wanner, Solving Ordinary
 * Differential Equations II, 2nd ed. (1996), VII.1, DOI 10.1007/978-3-642-05221-7); constraints on velocities by
 * Lagrange-d'Alembert's principle: their forces do no work on virtual displacements, A dq = 0. (Not vakonomic
 * mechanics, which puts lambda c into the action and has other motions.) */
#include "mech/constrain.h"

#include "mech/frobenius.h"
#include "sym/diff.h"
#include "sym/simplify.h"

static int is_holonomic(const Eqns *e, const Constraint *k) { return !(expr_kinds(e->g, k->c) & 1u << SYM_VEL); }

/* dx/dt without the part with q''. */
static Expr rate(const Eqns *e, Expr x, const char *suffix) {
  const Model *m = e->m;
  Expr out, *seed = ARENA_ARRAY(m->arena, Expr, expr_symbol_count(e->g) + 1);
  model_seed_time(m, seed);
  for (uint32_t i = 0; i < e->n; i++) seed[m->coords.at[i].q] = expr_symbol(e->g, m->coords.at[i].v)->node;
  expr_tangent(e->g, &x, 1, (ExprSeeds){.at = seed, .n = expr_symbol_count(e->g) + 1}, suffix, NULL, &out);
  return out;
}

static int check_linear(const Eqns *e, const Constraint *k, const ExprPartials *row) {
  Diags *d = e->m->diags;
  for (uint32_t i = 0; i < row->n; i++)
    if (expr_kinds(e->g, simplify(e->g, row->at[i].e)) & 1u << SYM_VEL) {
      return diag_error(d, k->span, "the constraint `%s` is not linear in the velocities"
                        HELP "Lagrange-d'Alembert's principle holds for A(q, t) q' + b(q, t) = 0", k->name);
    }
  return 1;
}

static int check_contains(const Eqns *e, const Constraint *k, const ExprPartials *row) {
  Diags *d = e->m->diags;
  if (row->n) return 1;
  if (expr_is_zero(e->g, simplify(e->g, k->c))) {
    return diag_error(
        d, k->span,
        "the constraint `%s` demands nothing: its sides are the same for all coordinates" HELP "leave it out", k->name);
  }
  return diag_error(d, k->span, "the constraint `%s` contains no coordinate"
                    HELP "a condition on parameters and time alone cannot be met by any force", k->name);
}

/* c = 0 and c + 1 = 0 cannot both hold. */
static int check_contradiction(const Eqns *e, const Constraint *k) {
  ExprGraph *g = e->g;
  Diags *d = e->m->diags;
  for (const Constraint *other = e->m->constraints.at; other < k; other++) {
    for (int sum = 0; sum < 2; sum++) {
      Expr both = simplify(g, sum ? expr_add(g, k->c, other->c) : expr_sub(g, k->c, other->c));
      if (!expr_is_num(g, both) || expr_is_zero(g, both)) continue;
      diag_error(d, k->span, "the constraint `%s` contradicts `%s`", k->name, other->name);
      diag_also(d, other->span, "that one is here");
      return 0;
    }
  }
  return 1;
}

/* At most as many constraints as coordinates; contacts do not count, since they are not all closed at once. */
static int check_count(const Eqns *e) {
  const Model *m = e->m;
  uint32_t held = 0, i = 0;
  while (i < m->constraints.n && (held += !contact_of_constraint(m, &m->constraints.at[i])) <= e->n) i++;
  if (held <= e->n) return 1;
  const Constraint *k = &m->constraints.at[i];
  diag_error(m->diags, k->span, "there are more constraints than coordinates: `%s` is number %u, of %u coordinates",
             k->name, e->n + 1, e->n);
  diag_help(m->diags,
            "at most %u of them are independent: leave out those that follow from others, which `lagc check` names "
            "where there are not too many",
            e->n);
  return 0;
}

/* Past this many constraints pairs are not compared: nobody wrote them by hand. */
enum { COMPARE_MAX = 64 };

/* The row of A, and the function of positions that keeps its value: c if holonomic, F if r = dF/dt, else 0. */
typedef struct {
  ExprPartials row;
  Expr kept;
} ConstraintRow;

static int derive_row(Eqns *e, const Constraint *k, ConstraintRow *to) {
  int holonomic = is_holonomic(e, k);
  to->row = expr_gradient_sparse(e->g, k->c, holonomic ? SYM_COORD : SYM_VEL, e->n);
  if (!check_contains(e, k, &to->row) || (!holonomic && !check_linear(e, k, &to->row))) return 0;
  if (e->m->constraints.n <= COMPARE_MAX && !check_contradiction(e, k)) return 0;
  const Contact *contact = contact_of_constraint(e->m, k);
  /* what sticks may slip on */
  to->kept = holonomic ? k->c : contact && contact->is_tangent ? 0 : frobenius_leaf(e, k->c);
  return 1;
}

static void add(Eqns *e, const Constraint *k, const ConstraintRow *kind, const Constraint **of, Expr *c, Expr *r,
                Expr *demand) {
  Constraints *all = &e->constraints;
  uint32_t at = all->n++;
  of[at] = k;
  c[at] = kind->kept;
  r[at] = is_holonomic(e, k) ? rate(e, k->c, "'") : k->c;
  demand[at] = expr_neg(e->g, rate(e, r[at], "_drift"));
  for (uint32_t i = 0; i < kind->row.n; i++)
    vec_push(e->m->arena, &all->A, ((MassEntry){at, kind->row.at[i].index, kind->row.at[i].e}));
}

static void add_forces(Eqns *e) {
  ExprGraph *g = e->g;
  const Constraints *k = &e->constraints;
  Expr *f = ARENA_ARRAY(e->m->arena, Expr, e->n + 1);
  for (uint32_t i = 0; i < e->n; i++) f[i] = e->f[i];
  for (uint32_t j = 0; j < k->A.n; j++) {
    const MassEntry *x = &k->A.at[j];
    Expr part = expr_mul(g, x->e, expr_symbol(g, k->of[x->row]->multiplier)->node);
    f[x->col] = expr_add(g, f[x->col], part);
  }
  e->f = f;
}

int constrain(Eqns *e) {
  const Model *m = e->m;
  Arena *a = m->arena;
  uint32_t n = m->constraints.n;
  if (!n) return 1;
  const Constraint **of = ARENA_ARRAY(a, const Constraint *, n);
  Expr *c = ARENA_ARRAY(a, Expr, n), *r = ARENA_ARRAY(a, Expr, n), *demand = ARENA_ARRAY(a, Expr, n);
  ConstraintRow *kinds = ARENA_ARRAY(a, ConstraintRow, n);
  int good = check_count(e);
  for (uint32_t i = 0; i < n; i++) good &= derive_row(e, &m->constraints.at[i], &kinds[i]);
  for (int turn = 0; turn < 3 && good; turn++) {
    for (uint32_t i = 0; i < n; i++) {
      const Constraint *k = &m->constraints.at[i];
      int kind = is_holonomic(e, k) ? 0 : kinds[i].kept ? 1 : 2;
      if (kind == turn) add(e, k, &kinds[i], of, c, r, demand);
    }
    if (turn == 0) e->constraints.nholonomic = e->constraints.n;
    if (turn == 1) e->constraints.nkept = e->constraints.n;
  }
  e->constraints.of = of;
  e->constraints.c = c;
  e->constraints.r = r;
  e->constraints.demand = demand;
  if (good) add_forces(e);
  return good;
}

int constraints_do_no_work(const Eqns *e) {
  const Constraints *k = &e->constraints;
  for (uint32_t i = 0; i < k->n; i++) {
    int moves = i < k->nholonomic ? (expr_kinds(e->g, k->c[i]) & 1u << SYM_TIME) != 0
                                  : !expr_is_zero(e->g, eqns_at_rest(e, k->r[i]));
    if (moves) return 0;
  }
  return 1;
}

void constraints_keep_none(Eqns *e) { e->constraints.nkept = e->constraints.nholonomic; }

const Contact *contact_of_constraint(const Model *m, const Constraint *k) {
  for (uint32_t i = 0; i < m->contacts.n; i++)
    if (&m->constraints.at[m->contacts.at[i].constraint] == k) return &m->contacts.at[i];
  return NULL;
}
