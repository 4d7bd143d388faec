/* Expressions from text, for tests only: numbers, names, + - * / ^, calls, parentheses. Every name
 * is a symbol: t is time, x' a velocity, x'' an acceleration; names in `params` are parameters (all
 * positive), other names coordinates. A test's language is small and trusted: errors abort. */
#ifndef TEST_EXPR_TEXT_H
#define TEST_EXPR_TEXT_H

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sym/expr.h"

typedef struct {
  ExprGraph *g;
  Interner *names;
  const char *params; /* " m l g " : between spaces */
  SymId known[64];
  uint32_t n;
  Expr lets[32]; /* definitions by name */
  const char *let_names[32];
  uint32_t nlets;
} Texts;

static inline Texts texts(Arena *a, const char *params) {
  Texts t = {.params = params};
  t.names = interner_new(a);
  t.g = expr_graph(a, t.names);
  return t;
}

static inline SymId text_symbol(Texts *t, const char *name) {
  for (uint32_t i = 0; i < t->n; i++)
    if (strcmp(expr_symbol(t->g, t->known[i])->name, name) == 0) return t->known[i];
  char padded[64];
  snprintf(padded, sizeof padded, " %s ", name);
  size_t len = strlen(name);
  int primes = len > 1 && name[len - 1] == '\'' ? 1 + (name[len - 2] == '\'') : 0;
  int param = strstr(t->params, padded) != NULL || strcmp(name, "pi") == 0;
  SymKind kind = param               ? SYM_PARAM
                 : primes == 2       ? SYM_ACC
                 : primes            ? SYM_VEL
                 : strcmp(name, "t") ? SYM_COORD
                                     : SYM_TIME;
  SymId s = expr_declare(t->g, kind, t->n, intern(t->names, name), param ? SIGN_POSITIVE : SIGN_UNKNOWN);
  t->known[t->n++] = s;
  return s;
}

static inline Expr text_sum(Texts *t, const char **s);

static inline void text_skip(const char **s) {
  while (**s == ' ' || **s == '\n') ++*s;
}

static inline int text_take(const char **s, char c) {
  text_skip(s);
  if (**s != c) return 0;
  ++*s;
  return 1;
}

static inline Expr text_call(Texts *t, const char *name, const char **s) {
  Expr a = text_sum(t, s), b = 0;
  if (text_take(s, ',')) b = text_sum(t, s);
  if (!text_take(s, ')')) abort();
  if (strcmp(name, "sqrt") == 0) return expr_sqrt(t->g, a);
  for (int op = EX_SIN; op < EX_COUNT; op++)
    if (strcmp(expr_op_text((ExprOp)op), name) == 0)
      return b ? expr_fn2(t->g, (ExprOp)op, a, b) : expr_fn(t->g, (ExprOp)op, a);
  abort();
}

static inline Expr text_atom(Texts *t, const char **s) {
  text_skip(s);
  const char *p = *s;
  if (text_take(s, '(')) {
    Expr e = text_sum(t, s);
    if (!text_take(s, ')')) abort();
    return e;
  }
  if (isdigit((unsigned char)*p)) {
    while (isdigit((unsigned char)**s) || **s == '.') ++*s;
    return expr_num(t->g, num_parse(p, (size_t)(*s - p)));
  }
  while (isalnum((unsigned char)**s) || **s == '_' || **s == '\'') ++*s;
  char name[32];
  snprintf(name, sizeof name, "%.*s", (int)(*s - p), p);
  if (!name[0]) abort();
  if (text_take(s, '(')) return text_call(t, name, s);
  for (uint32_t i = 0; i < t->nlets; i++)
    if (strcmp(t->let_names[i], name) == 0) return t->lets[i];
  return expr_symbol(t->g, text_symbol(t, name))->node;
}

static inline Expr text_unary(Texts *t, const char **s) {
  if (text_take(s, '-')) {
    Expr e = text_unary(t, s);
    return expr_neg(t->g, e);
  }
  Expr base = text_atom(t, s);
  if (!text_take(s, '^')) return base;
  Expr e = text_unary(t, s);
  return expr_pow(t->g, base, e);
}

static inline Expr text_product(Texts *t, const char **s) {
  Expr e = text_unary(t, s);
  for (;;) {
    int times = text_take(s, '*'), over = !times && text_take(s, '/');
    if (!times && !over) return e;
    Expr f = text_unary(t, s);
    e = times ? expr_mul(t->g, e, f) : expr_div(t->g, e, f);
  }
}

static inline Expr text_sum(Texts *t, const char **s) {
  Expr e = text_product(t, s);
  for (;;) {
    int plus = text_take(s, '+'), minus = !plus && text_take(s, '-');
    if (!plus && !minus) return e;
    Expr f = text_product(t, s);
    e = plus ? expr_add(t->g, e, f) : expr_sub(t->g, e, f);
  }
}

static inline Expr text_expr(Texts *t, const char *s) {
  Expr e = text_sum(t, &s);
  text_skip(&s);
  if (*s) abort();
  return e;
}

static inline void text_let(Texts *t, const char *name, const char *s) {
  Expr body = text_expr(t, s);
  t->let_names[t->nlets] = name;
  t->lets[t->nlets++] = expr_def(t->g, intern(t->names, name), body);
}

#endif
