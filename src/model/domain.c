/* Domains: the condition under which an expression, as written, has a real value. Graph nodes lose it: sqrt(x)^2 is
 * the node x. Conditions are graph nodes, made only if Builder.domains is set; 0 stands for a condition that always
 * holds. */
#include "model/resolve_impl.h"
#include "sym/jump.h"

Expr domain_and(const Builder *b, Expr p, Expr q) {
  if (!p || !q || p == q) return p ? p : q;
  return expr_fn2(b->g, EX_AND, p, q);
}

/* not a or p */
static Expr implied(const Builder *b, Expr a, Expr p) {
  if (!p) return 0;
  Expr otherwise = expr_fn(b->g, EX_NOT, a);
  return expr_fn2(b->g, EX_OR, otherwise, p);
}

/* The condition, or 0 if it is the number 1. */
static Expr drop_if_true(const Builder *b, Expr p) { return p == expr_int(b->g, 1) ? 0 : p; }

static Expr not_equal(const Builder *b, Expr x, Expr y) {
  Expr equal = expr_fn2(b->g, EX_EQ, x, y);
  return drop_if_true(b, expr_fn(b->g, EX_NOT, equal));
}

static Expr at_least(const Builder *b, Expr x, Expr y) { return drop_if_true(b, expr_fn2(b->g, EX_LE, y, x)); }
static Expr not_zero(const Builder *b, Expr x) { return not_equal(b, x, expr_int(b->g, 0)); }

/* Domain of base^exponent; cube roots are real. 0 for a variable exponent: the values at a state decide. */
static Expr power_domain(const Builder *b, Expr base, Expr exponent) {
  if (!expr_is_num(b->g, exponent)) return 0;
  Num e = expr_number(b->g, exponent);
  int root = !num_is_exact(e) || (e.den != 1 && e.den != 3);
  if (num_sign(e) < 0)
    return root ? drop_if_true(b, expr_fn2(b->g, EX_LT, expr_int(b->g, 0), base)) : not_zero(b, base);
  return root ? at_least(b, base, expr_int(b->g, 0)) : 0;
}

Expr domain_of_derivative(const Builder *b, const Value *of) {
  return b->domains ? expr_smooth_domain(b->g, of->at, component_count(of), NULL) : 0;
}

static Expr if_domain(const Eval *ev, const AstExpr *x, const Value *v) {
  const Builder *b = ev->b;
  AstId yes = ast_expr(b->ast, x->args)->next, no = ast_expr(b->ast, yes)->next;
  const Value *c = value_of(ev, x->args);
  if (expr_is_num(b->g, c->e)) return domain_and(b, c->domain, v->domain);
  Expr not = expr_fn(b->g, EX_NOT, c->e);
  Expr first = implied(b, c->e, value_of(ev, yes)->domain), second = implied(b, not, value_of(ev, no)->domain);
  return domain_and(b, c->domain, domain_and(b, first, second));
}

/* Domain of a built-in function, without the domains of its arguments. */
static Expr function_domain(const Eval *ev, const AstExpr *x) {
  const Builder *b = ev->b;
  const Value *v = value_of(ev, x->args);
  AstId second = ast_expr(b->ast, x->args)->next;
  Expr u = v->e, zero = expr_int(b->g, 0), one = expr_int(b->g, 1);
  if (strcmp(x->name, "log") == 0) return drop_if_true(b, expr_fn2(b->g, EX_LT, zero, u));
  if (strcmp(x->name, "sqrt") == 0) return at_least(b, u, zero);
  if (strcmp(x->name, "asin") == 0 || strcmp(x->name, "acos") == 0) {
    Expr above = at_least(b, u, expr_int(b->g, -1)), below = at_least(b, one, u);
    return domain_and(b, above, below);
  }
  if (strcmp(x->name, "pow") == 0) return power_domain(b, u, value_of(ev, second)->e);
  if (strcmp(x->name, "d") == 0) return domain_of_derivative(b, v);
  if (strcmp(x->name, "atan2") != 0) return 0;
  Expr first = expr_fn2(b->g, EX_EQ, u, zero), both = expr_fn2(b->g, EX_EQ, value_of(ev, second)->e, zero);
  both = expr_fn2(b->g, EX_AND, first, both);
  return drop_if_true(b, expr_fn(b->g, EX_NOT, both));
}

static Expr call_domain(const Eval *ev, const AstExpr *x, const Value *v) {
  const Builder *b = ev->b;
  const Entity *own = own_function(ev, x);
  if (!own && strcmp(x->name, "if") == 0) return if_domain(ev, x, v);
  Expr all = own || !x->args || !value_of(ev, x->args)->e ? v->domain : function_domain(ev, x);
  for (AstId i = x->args; i; i = ast_expr(b->ast, i)->next) all = domain_and(b, all, value_of(ev, i)->domain);
  return all;
}

/* Domain of the sum or product of ev->operands: divisors are not 0. */
static Expr chain_domain(const Eval *ev, int product) {
  const Builder *b = ev->b;
  Expr all = 0;
  for (uint32_t i = 0; i < ev->operands.n; i++) {
    Operand o = ev->operands.at[i];
    const Value *v = value_of(ev, o.at);
    all = domain_and(b, all, v->domain);
    if (product && o.inverted) all = domain_and(b, all, not_zero(b, v->e));
  }
  return all;
}

Expr domain_of_node(const Eval *ev, AstId id, const Value *v) {
  const Builder *b = ev->b;
  const AstExpr *x = ast_expr(b->ast, id);
  switch (x->kind) {
  case AST_NAME: case AST_INDEX: case AST_SUM: case AST_PRODUCT: case AST_NUM: case AST_LIST: case AST_STRING:
  case AST_BIND: case AST_ERROR: return v->domain;
  case AST_ADD: case AST_SUB: return chain_domain(ev, 0);
  case AST_MUL: case AST_DIV: return chain_domain(ev, 1);
  case AST_POW: {
    const Value *base = value_of(ev, x->a), *e = value_of(ev, x->b);
    return domain_and(b, domain_and(b, base->domain, e->domain), power_domain(b, base->e, e->e));
    }
    case AST_PRIME: return domain_and(b, value_of(ev, x->a)->domain, domain_of_derivative(b, value_of(ev, x->a)));
    case AST_MEMBER: return v->domain ? v->domain : value_of(ev, x->a)->domain;
    case AST_NEG: case AST_NOT: case AST_UNIT: case AST_AT: return value_of(ev, x->a)->domain;
    case AST_LT: case AST_LE: case AST_GT: case AST_GE: case AST_EQ: case AST_NE:
      return domain_and(b, value_of(ev, x->a)->domain, value_of(ev, x->b)->domain);
    /* short circuit: the second operand needs a value only where the first does not decide */
    case AST_AND: case AST_OR: {
      const Value *first = value_of(ev, x->a);
      Expr open = x->kind == AST_AND ? first->e : expr_fn(b->g, EX_NOT, first->e);
      return domain_and(b, first->domain, implied(b, open, value_of(ev, x->b)->domain));
    }
    case AST_CALL: return call_domain(ev, x, v);
    case AST_TUPLE: {
      Expr all = 0;
      for (AstId i = x->args; i; i = ast_expr(b->ast, i)->next) all = domain_and(b, all, value_of(ev, i)->domain);
      return all;
    }
  }
  return v->domain;
}
