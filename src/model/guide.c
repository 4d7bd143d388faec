/* Guides: constraints that hold from both sides, with Coulomb's friction by their own force.
 *
 * `guide NAME: c = 0, friction = mu` is the constraint NAME and a tangent NAME.slip like that of a contact: the
 * constraint sticks*slip = 0 while it sticks, the input `force` while it slips. Contact.normal holds the components of
 * the force of the guide, linear in multipliers; its size is their norm. Tangents follow all constraints and contacts
 * of the model, so that a friction may name any of them. */
#include <math.h>
#include <string.h>

#include "model/resolve_impl.h"
#include "sym/diff.h"

static Expr vel_node(const Builder *b, uint32_t i) { return expr_symbol(b->g, b->m->coords.at[i].v)->node; }
static Expr multiplier_node(const Builder *b, uint32_t k) {
  return expr_symbol(b->g, b->m->constraints.at[k].multiplier)->node;
}

static int has_multiplier(const Builder *b, Expr e) { return (expr_kinds(b->g, e) & 1u << SYM_MULTIPLIER) != 0; }

static Expr norm_of(Builder *b, const Expr *x, uint32_t n) {
  if (n == 1) return expr_fn(b->g, EX_ABS, x[0]);
  Expr squares[3];
  for (uint32_t k = 0; k < n; k++) squares[k] = expr_pow_num(b->g, x[k], num_int(2));
  Expr sum = expr_add_n(b->g, squares, n);
  return expr_sqrt(b->g, sum);
}

/* --- the size of a friction: coefficient times the norm of a force --- */

/* normal[parts] := x[parts] of the sum of x^2; 0: it is none. */
static int read_squares(Builder *b, Expr sum, Contact *t) {
  ExprGraph *g = b->g;
  uint32_t n = expr_pairs(g, sum, EX_SUM);
  if (n > 3) return 0;
  for (uint32_t i = 0; i < n; i++) {
    Num factor, power;
    Expr term = expr_pair(g, sum, EX_SUM, i, &factor), x = expr_sqrt(g, expr_num(g, factor));
    for (uint32_t k = 0; k < expr_pairs(g, term, EX_PROD); k++) {
      Expr base = expr_pair(g, term, EX_PROD, k, &power), root = expr_pow_num(g, base, num_mul(power, num_ratio(1, 2)));
      if (has_multiplier(b, base) && num_cmp(power, num_int(2)) != 0) return 0;
      x = expr_mul(g, x, root);
    }
    t->normal[i] = x;
  }
  t->parts = n;
  return 1;
}

/* The factor of base[i]^power[i] of a product that contains no multiplier, times *of; *base, *power: of the other one.
 * 0: there are several. */
static Expr split_product(Builder *b, Expr product, Expr of, Expr *base, Num *power) {
  ExprGraph *g = b->g;
  *base = 0;
  for (ExprPair x = {0}; expr_next_pair(g, product, EX_PROD, &x);)
    if (!has_multiplier(b, x.of)) {
      Expr factor = expr_pow_num(g, x.of, x.num);
      of = expr_mul(g, of, factor);
    } else if (*base) return 0;
    else *base = x.of, *power = x.num;
  return of;
}

/* The coefficient of the norm that contains the multipliers of e: abs, hypot, or the root of a sum of squares;
 * t->normal := its components. 0: e is no product with one. */
static Expr find_norm(Builder *b, Expr e, Contact *t) {
  ExprGraph *g = b->g;
  Expr coefficient = expr_int(g, 1);
  for (Expr at = e; at;) {
    Num power;
    ExprOp op = expr_op(g, at);
    if (op == EX_ABS || op == EX_HYPOT) {
      t->parts = expr_nargs(g, at);
      for (uint32_t k = 0; k < t->parts; k++) t->normal[k] = expr_arg(g, at, k);
      return coefficient;
    }
    if (op == EX_SUM && expr_pairs(g, at, op) == 1) {
      at = expr_pair(g, at, op, 0, &power);
      coefficient = expr_scale(g, power, coefficient);
      continue;
    }
    if (op != EX_PROD || !(coefficient = split_product(b, at, coefficient, &at, &power)) || !at) return 0;
    if (num_cmp(power, num_ratio(1, 2)) == 0) return read_squares(b, at, t) ? coefficient : 0;
    if (!num_is_one(power)) return 0;
  }
  return 0;
}

static int same_force(const Contact *a, const Contact *b) {
  for (uint32_t k = 0; k < a->parts && a->parts == b->parts; k++)
    if (a->normal[k] != b->normal[k]) return 0;
  return a->parts == b->parts;
}

/* Whether the components are linear in multipliers of constraints, none of them a contact's. */
static int is_force(Builder *b, const Contact *t) {
  for (uint32_t k = 0; k < t->parts; k++) {
    ExprList nodes = expr_topo(b->g, &t->normal[k], 1);
    for (uint32_t i = 0; i < nodes.n; i++) {
      const Symbol *s = expr_op(b->g, nodes.at[i]) == EX_SYM ? expr_sym_of(b->g, nodes.at[i]) : NULL;
      if (!s || s->kind != SYM_MULTIPLIER) continue;
      for (uint32_t c = 0; c < b->m->contacts.n; c++)
        if (b->m->contacts.at[c].constraint == s->index) return 0;
      if (has_multiplier(b, expr_diff(b->g, t->normal[k], expr_sym_id(b->g, nodes.at[i])))) return 0;
    }
  }
  return 1;
}

/* friction and hold of t, from the sizes that the text gives of a force of dimension `dim`; 0, reported. */
static int read_sizes(Builder *b, const AstStmt *st, Name effect, Dim dim, Contact *t) {
  AstId size = ast_option_value(b->ast, st, "friction"), most = ast_option_value(b->ast, st, "static");
  Span span = ast_expr(b->ast, size)->span;
  b->in_friction = 1;
  Value f = resolve(b, size, IN_DYNAMICS, effect), g = most ? resolve(b, most, IN_DYNAMICS, effect) : f;
  b->in_friction = 0;
  if (!f.e || !g.e) return 0;
  t->friction = f.n ? 0 : find_norm(b, f.e, t);
  if (!t->friction || !is_force(b, t))
    return diag_error(b->diags, span,
                      "friction by the force of a constraint is a coefficient times the size of that force" HELP
                      "write `mu*abs(lambda(rail))`, or `mu*r*hypot(lambda(px), lambda(py))` of a journal; two forces "
                      "are two frictions, and that of a contact is `contact NAME: y >= 0, restitution = 0, friction = "
                      "mu, slip = x'`");
  if (!dim_equate(b->dims, f.dim, dim, span))
    return diag_error(b->diags, span,
                      "a force along the slip of `%s` is %s, and this is %s" HELP
                      "of a journal of radius r it is `mu*r*hypot(lambda(px), lambda(py))`",
                      st->name, in_dim(b, dim), in_dim(b, f.dim));
  if (g.n || !dims_agree(b, &g, &f, ast_expr(b->ast, most ? most : size)->span))
    return diag_error(b->diags, ast_expr(b->ast, most)->span, "the static limit is %s, and the friction %s",
                      g.n ? "a vector" : in_dim(b, g.dim), in_dim(b, f.dim));
  Contact held = {0};
  t->hold = find_norm(b, g.e, &held);
  if (!t->hold || !same_force(t, &held))
    return diag_error(b->diags, ast_expr(b->ast, most)->span,
                      "static friction follows the same force as friction: `static = mu_s*abs(lambda(rail))`");
  add_size(b, t->friction, "this friction has a coefficient", span, 0);
  if (most) add_static_limit(b, t->hold, t->friction, ast_expr(b->ast, most)->span);
  return 1;
}

/* --- the slip of a guide --- */

/* Coordinates that span the space of the guide: those of its constraints, and one more of their kind. Returns their
 * number, at most 3; 0: not clear. */
static uint32_t find_space(const Builder *b, const Expr *c, uint32_t parts, uint32_t *at) {
  const Model *m = b->m;
  uint32_t n = 0, others = 0, other = 0;
  for (uint32_t i = 0; i < m->coords.n; i++) {
    int held = 0;
    for (uint32_t k = 0; k < parts; k++) held |= expr_contains_sym(b->g, c[k], m->coords.at[i].q);
    if (held && n == 3) return 0;
    if (held) at[n++] = i;
  }
  for (uint32_t i = 0; n == parts && i < m->coords.n; i++) {
    int held = 0, same = 1;
    for (uint32_t k = 0; k < n; k++) {
      held |= at[k] == i;
      const char *dot = strchr(m->coords.at[at[k]].name, '.'), *own = strchr(m->coords.at[i].name, '.');
      size_t stem = dot ? (size_t)(dot - m->coords.at[at[k]].name) : 0;
      same &= m->coords.at[i].unit.dim == m->coords.at[at[k]].unit.dim && !dot == !own &&
              (!dot || strncmp(m->coords.at[i].name, m->coords.at[at[k]].name, stem + 1) == 0);
    }
    if (held || !same) continue;
    other = i;
    others++;
  }
  if (others == 1) {
    at[n++] = other;
    for (uint32_t k = n - 1; k > 0 && at[k] < at[k - 1]; k--) {
      uint32_t swap = at[k];
      at[k] = at[k - 1];
      at[k - 1] = swap;
    }
  }
  for (uint32_t k = 1; k < n; k++)
    if (m->coords.at[at[k]].unit.dim != m->coords.at[at[0]].unit.dim) return 0;
  return n == parts + 1 ? n : 0;
}

/* The slip along the direction that constraints from..from + parts - 1 leave free in their space, and their force. */
static Expr slip_along(Builder *b, uint32_t from, uint32_t parts, Contact *t) {
  ExprGraph *g = b->g;
  Expr c[2], d[2][3] = {{0}}, along[3], part[3];
  for (uint32_t k = 0; k < parts; k++) c[k] = b->m->constraints.at[from + k].c;
  uint32_t n = parts <= 2 ? find_space(b, c, parts, t->space) : 0;
  if (!n) return 0;
  for (uint32_t i = 0; i < n; i++) {
    t->normal[i] = expr_int(g, 0);
    for (uint32_t k = 0; k < parts; k++) {
      d[k][i] = expr_diff(g, c[k], b->m->coords.at[t->space[i]].q);
      part[k] = expr_mul(g, d[k][i], multiplier_node(b, from + k));
      t->normal[i] = expr_add(g, t->normal[i], part[k]);
    }
  }
  for (uint32_t i = 0; i < n; i++) { /* at right angles to the gradients */
    uint32_t j = (i + 1) % n, k = (i + 2) % n;
    if (n == 2) along[i] = i ? expr_neg(g, d[0][0]) : d[0][1];
    else {
      Expr up = expr_mul(g, d[0][j], d[1][k]), down = expr_mul(g, d[0][k], d[1][j]);
      along[i] = expr_sub(g, up, down);
    }
  }
  for (uint32_t i = 0; i < n; i++) part[i] = expr_mul(g, along[i], vel_node(b, t->space[i]));
  Expr speed = expr_add_n(g, part, n), size = n == 2 ? norm_of(b, d[0], 2) : norm_of(b, along, n);
  if (n == 2) t->normal[0] = expr_mul(g, size, multiplier_node(b, from)); /* the length of the gradient */
  t->parts = n == 2 ? 1 : n;
  t->nspace = n;
  return expr_div(g, speed, size);
}

static int refuse_options(Builder *b, const AstStmt *st) {
  for (AstId i = st->args; i; i = ast_expr(b->ast, i)->next) {
    const AstExpr *x = ast_expr(b->ast, i);
    int known = strcmp(x->name, "tangential") != 0 && strcmp(x->name, "law") != 0;
    if (!known)
      return diag_error(b->diags, x->span,
                        "`%s` is a law of impacts, which a guide has not" HELP
                        "a guide has `friction = mu`, and perhaps `static = mu_s` and `slip = x'`",
                        x->name);
    if (ast_option_value(b->ast, st, x->name) != x->args)
      return diag_error(b->diags, x->span, "the guide `%s` has `%s` twice", st->name, x->name);
  }
  if (!ast_option_value(b->ast, st, "friction"))
    return diag_error(b->diags, st->span,
                      "the guide `%s` has no friction" HELP
                      "`guide %s: y = 0, friction = mu`; without friction it is a `constraint`",
                      st->name, st->name);
  return 1;
}

/* Whether the velocity `slip` is the rate of constraint c times a factor, which is 0 whatever the motion: their
 * gradients are parallel. */
static int is_rate_of(const Builder *b, Expr slip, Expr c) {
  const Model *m = b->m;
  ExprGraph *g = b->g;
  int of_rates = (expr_kinds(g, c) & 1u << SYM_VEL) != 0;
  Expr s0 = 0, c0 = 0;
  for (uint32_t i = 0; i < m->coords.n; i++) {
    Expr s = expr_diff(g, slip, m->coords.at[i].v);
    Expr d = expr_diff(g, c, of_rates ? m->coords.at[i].v : m->coords.at[i].q);
    if (expr_is_zero(g, s) && expr_is_zero(g, d)) continue;
    if (expr_is_zero(g, s) || expr_is_zero(g, d)) return 0;
    if (s0 && !expr_is_zero(g, expr_sub(g, expr_mul(g, s, c0), expr_mul(g, s0, d)))) return 0;
    if (!s0) s0 = s, c0 = d;
  }
  return s0 != 0;
}

/* Reports a slip along the normal of the guide st. */
static int check_along(Builder *b, const AstStmt *st, AstId id, Expr slip, const Entity *of, uint32_t parts) {
  for (uint32_t k = 0; of && k < parts; k++)
    if (is_rate_of(b, slip, b->m->constraints.at[of->index + k].c))
      return diag_error(b->diags, ast_expr(b->ast, id)->span,
                        "the slip of the guide `%s` is the rate of its own constraint, which is 0 at all times" HELP
                        "it is the velocity along the guide, which the constraint leaves free: of y = 0 it is `slip = "
                        "x'`",
                        st->name);
  return 1;
}

/* The slip of the guide st, whose constraints are `of`, and its force; *dim := its dimension. 0, reported. */
static Expr slip_of(Builder *b, const AstStmt *st, Name effect, const Entity *of, Contact *t, Dim *dim) {
  AstId id = ast_option_value(b->ast, st, "slip");
  uint32_t parts = of && of->parts ? of->parts : 1;
  *dim = of ? dim_per_second(b->dims, b->m->constraints.at[of->index].dim) : DIM_NONE;
  if (!id) {
    Expr slip = slip_along(b, of->index, parts, t);
    if (slip) *dim = dim_per_second(b->dims, b->m->coords.at[t->space[0]].unit.dim);
    else
      diag_error(b->diags, st->span,
                 "the guide `%s` does not say how it slips" HELP
                 "give the velocity along it: `guide %s: ..., friction = mu, slip = x'`, of a journal `slip = "
                 "r*(th1' - th2')`",
                 st->name, st->name);
    return slip;
  }
  for (uint32_t k = 0; of && k < parts; k++) t->normal[k] = multiplier_node(b, of->index + k);
  if (of) t->parts = parts;
  b->in_friction = !of; /* q' of `friction ... on q` stands behind its size */
  Value v = resolve(b, id, IN_DYNAMICS, effect);
  b->in_friction = 0;
  if (!v.e || !check_slip(b, st, id, &v, of ? &b->m->constraints.at[of->index] : NULL)) return 0;
  if (!of) *dim = v.dim;
  if (!v.n) return check_along(b, st, id, v.e, of, parts) ? v.e : 0;
  diag_error(
      b->diags, ast_expr(b->ast, id)->span,
      "the slip of a guide is a number: the velocity along it" HELP
      "on a surface in space it has two components, which stand there: `slip = (x', y')`");
  return 0;
}

static void declare_slip(Builder *b, const AstStmt *st, Name name, uint32_t constraint) {
  scope_add(&b->constraints,
            (Entity){.index = constraint, .name = intern_printf(b, "slip"), .effect = name, .span = st->name_span});
}

void add_guide_friction(Builder *b, const AstStmt *st, Name effect, void *data) {
  (void)data;
  IndexRange r = {0};
  if (st->kind != STMT_GUIDE || (st->dims && !resolve_indices(b, st->dims, effect, &r))) return;
  Name name = member_name(b->ast, st->name, r.lo, r.n);
  const Entity *found = st->lhs ? scope_own(&b->constraints, name, effect) : NULL;
  Entity own = found ? *found : (Entity){0}, *of = found ? &own : NULL; /* declarations move entities */
  declare_slip(b, st, name, UINT32_MAX);                                /* refused, unless declared again */
  if ((st->lhs && (!of || of->index >= b->m->constraints.n)) || !refuse_options(b, st)) return;
  Contact t = {.is_tangent = 1, .restitution = expr_int(b->g, 0)};
  Dim dim;
  Expr slip = slip_of(b, st, effect, of, &t, &dim);
  if (slip && of) {
    t.friction = coefficient(b, st, effect, "friction", HUGE_VAL, "a coefficient of friction", 0);
    t.hold = static_coefficient(b, st, effect, t.friction);
  }
  if (!slip || (of ? !t.friction || !t.hold : !read_sizes(b, st, effect, multiplier_dim(b, dim, 0), &t))) return;
  declare_slip(b, st, name, b->m->constraints.n);
  t.gap = slip;
  push_tangent(b, st, name, t, norm_of(b, t.normal, t.parts), dim, "");
  if (!b->m->dissipation_span.end) b->m->dissipation_span = st->span;
}

void add_guide(Builder *b, const AstStmt *st, Name effect) {
  AstStmt constraint = *st;
  constraint.args = 0;
  if (st->lhs) add_constraint(b, &constraint, effect);
}
