/* Printer of expressions. Pending items (text or node) wait on a stack, so that depth costs no recursion. */
#include "sym/print.h"

#include <string.h>

#include "sym/expr_impl.h"
#include "sym/sum_nest.h"

typedef enum { PREC_OR, PREC_AND, PREC_NOT, PREC_CMP, PREC_SUM, PREC_PROD, PREC_POW, PREC_ATOM } Prec;

typedef struct {
  const char *text; /* NULL: the item is a node */
  Expr node;
  Prec prec; /* precedence of the place: a weaker node gets parentheses */
} Item;

typedef struct {
  ExprGraph *g;
  PrintStyle style;
  VEC(Item) stack; /* items still to be printed, the next one last */
  VEC(Item) part;  /* the expansion of one node, in order */
} Printer;

static void text(Printer *p, const char *s) { vec_push(p->g->arena, &p->part, ((Item){.text = s})); }
static void node(Printer *p, Expr e, Prec prec) { vec_push(p->g->arena, &p->part, ((Item){NULL, e, prec})); }
static int latex(const Printer *p) { return p->style == PRINT_LATEX; }
static const char *by_style(const Printer *p, const char *t, const char *l) { return latex(p) ? l : t; }

static void open_paren(Printer *p) { text(p, by_style(p, "(", "\\left(")); }
static void close_paren(Printer *p) { text(p, by_style(p, ")", "\\right)")); }

static const char *num_text(Printer *p, Num n) {
  StrBuf b = strbuf(p->g->arena);
  if (latex(p) && num_is_exact(n) && n.den != 1)
    sb_printf(&b, "%s\\frac{%lld}{%lld}", n.num < 0 ? "-" : "", (long long)(n.num < 0 ? -n.num : n.num),
              (long long)n.den);
  else num_print(&b, n);
  return sb_text(&b);
}

/* --- products --- */

typedef struct {
  Expr base;
  Num exponent; /* positive */
  int rank;
} Factor;

/* Position of a factor in a product: numbers and sums of parameters, parameters, coordinates, functions, velocities:
 * (m1 + m2)*g*l*sin(th)*th'. */
static int rank_of(ExprGraph *g, Expr e) {
  switch (expr_op(g, e)) {
    case EX_NUM: return 0;
    case EX_SYM:
      switch (expr_sym_of(g, e)->kind) {
        case SYM_PARAM: case SYM_CONST: return 1;
        case SYM_INPUT: case SYM_TIME: case SYM_LOCAL: return 2;
        case SYM_COORD: case SYM_STATE: case SYM_MULTIPLIER: return 4;
        case SYM_VEL: case SYM_RATE: return 7;
        case SYM_ACC: return 8;
      }
      return 4;
    case EX_SUM: return !expr_is_constant(g, e) ? 3 : 0;
    case EX_DEF: return 5;
    default: return 6; /* functions, and powers as bases */
  }
}

static void sort_factors(Factor *f, uint32_t n) {
  for (uint32_t i = 1; i < n; i++)
    for (uint32_t k = i; k > 0 && f[k - 1].rank > f[k].rank; k--) {
      Factor t = f[k];
      f[k] = f[k - 1];
      f[k - 1] = t;
    }
}

/* Functions whose exponent stands before the argument: \sin^2 u. */
static int is_circular(ExprOp op) { return op >= EX_SIN && op <= EX_TAN; }

static void arguments(Printer *p, Expr e);

static void factor(Printer *p, Factor f, Prec place) {
  if (num_is_exact(f.exponent) && f.exponent.num == 1 && f.exponent.den == 2) {
    text(p, by_style(p, "sqrt(", "\\sqrt{"));
    node(p, f.base, PREC_OR);
    text(p, by_style(p, ")", "}"));
    return;
  }
  if (num_is_one(f.exponent)) {
    node(p, f.base, place);
    return;
  }
  if (latex(p) && is_circular(expr_op(p->g, f.base))) {
    StrBuf b = strbuf(p->g->arena);
    sb_printf(&b, "\\%s^{%s}", expr_op_text(expr_op(p->g, f.base)), num_text(p, f.exponent));
    text(p, sb_text(&b));
    arguments(p, f.base);
    return;
  }
  node(p, f.base, PREC_ATOM);
  StrBuf b = strbuf(p->g->arena);
  const char *k = num_text(p, f.exponent);
  if (latex(p)) sb_printf(&b, "^{%s}", k);
  else sb_printf(&b, num_is_int(f.exponent) ? "^%s" : "^(%s)", k);
  text(p, sb_text(&b));
}

static void factors(Printer *p, const char *number, const Factor *f, uint32_t n) {
  const char *times = by_style(p, "*", " ");
  if (number) text(p, number);
  for (uint32_t i = 0; i < n; i++) {
    if (i || number) text(p, times);
    factor(p, f[i], n == 1 && !number ? PREC_PROD : PREC_POW);
  }
  if (!n && !number) text(p, "1");
}

/* Prints |c| * e as a fraction where c or e has a denominator. */
static void term(Printer *p, Expr e, Num c) {
  ExprGraph *g = p->g;
  c = num_abs(c);
  uint32_t n = expr_pairs(g, e, EX_PROD), top = 0, bottom = 0;
  Factor *above = ARENA_ARRAY(g->arena, Factor, n + 1), *below = ARENA_ARRAY(g->arena, Factor, n + 1);
  for (uint32_t i = 0; i < n; i++) {
    Num k;
    Expr b = expr_pair(g, e, EX_PROD, i, &k);
    if (b == g->one) continue;
    Factor f = {b, num_abs(k), rank_of(g, b)};
    if (num_sign(k) < 0) below[bottom++] = f;
    else above[top++] = f;
  }
  sort_factors(above, top);
  sort_factors(below, bottom);
  Num up = c, down = num_int(1);
  if (num_is_exact(c)) {
    up = num_int(c.num);
    down = num_int(c.den);
  }
  const char *up_text = num_is_one(up) ? NULL : num_text(p, up);
  const char *down_text = num_is_one(down) ? NULL : num_text(p, down);
  int fraction = bottom || down_text;
  if (latex(p) && fraction) text(p, "\\frac{");
  factors(p, up_text, above, top);
  if (!fraction) return;
  text(p, by_style(p, "/", "}{"));
  int group = !latex(p) && bottom + (down_text != NULL) > 1;
  if (group) open_paren(p);
  if (!latex(p) && !group && bottom == 1) {
    factor(p, below[0], PREC_POW);
  } else factors(p, down_text, below, bottom);
  if (group) close_paren(p);
  if (latex(p)) text(p, "}");
}

/* Terms of a quantified sum, of the opposite signs if `minus`, behind others unless `leads`; signs inside the sums. */
static void cell_terms(Printer *p, Expr e, int minus, int leads, int inside) {
  SumTerms terms = expr_sum_terms(p->g, e);
  for (uint32_t k = 0; k < terms.n; k++) {
    const SumTerm *t = &terms.at[k];
    int first = leads && !k, negative = !inside && t->minus != minus;
    text(p, negative ? (first ? "-" : " - ") : first ? "" : " + ");
    for (int n = 0; n < 2; n++)
      if (t->index[n])
        text(p, arena_printf(p->g->arena, by_style(p, "sum(%s in %s..%s, ", "\\sum_{%s=%s}^{%s} "), t->index[n],
                             t->from[n], t->to[n]));
    Expr body = inside && t->minus ? expr_neg(p->g, t->body) : t->body;
    node(p, body, latex(p) || !t->index[0] ? PREC_PROD : PREC_OR);
    for (int n = 0; n < 2; n++)
      if (t->index[n]) text(p, by_style(p, ")", ""));
  }
  if (!terms.n && leads) text(p, "0");
}

static void sum(Printer *p, Expr e) {
  ExprGraph *g = p->g;
  uint32_t n = expr_pairs(g, e, EX_SUM), lead = 0;
  Num c;
  /* "b - a" reads better than "-a + b" */
  while (lead < n && (expr_pair(g, e, EX_SUM, lead, &c), num_sign(c) < 0)) lead++;
  if (lead == n) lead = 0;
  for (uint32_t i = 0; i < n; i++) {
    Expr t = expr_pair(g, e, EX_SUM, i == 0 ? lead : i <= lead ? i - 1 : i, &c);
    if (expr_op(g, t) == EX_CELL && num_is_one(num_abs(c))) {
      cell_terms(p, t, num_sign(c) < 0, !i, 0);
      continue;
    }
    if (i) text(p, num_sign(c) < 0 ? " - " : " + ");
    else if (num_sign(c) < 0) text(p, "-");
    if (expr_op(g, t) == EX_NUM) text(p, num_text(p, num_abs(num_mul(c, expr_number(g, t)))));
    else if (expr_op(g, t) == EX_PROD || !num_is_one(num_abs(c))) term(p, t, c);
    else node(p, t, PREC_PROD);
  }
}

/* --- other nodes --- */

/* Whether an argument is a sum of plain names, which needs no \left( \right). */
static int is_flat(const ExprGraph *g, Expr e) {
  for (ExprPair t = {0}; expr_next_pair(g, e, EX_SUM, &t);)
    if (!num_is_int(t.num) || (expr_op(g, t.of) != EX_SYM && expr_op(g, t.of) != EX_DEF && expr_op(g, t.of) != EX_NUM))
      return 0;
  return 1;
}

static void arguments(Printer *p, Expr e) {
  ExprOp op = expr_op(p->g, e);
  Expr first = expr_arg(p->g, e, 0);
  int flat = expr_nargs(p->g, e) == 1 && is_flat(p->g, first);
  if (latex(p) && flat && (op == EX_SIN || op == EX_COS || op == EX_TAN) && expr_op(p->g, first) == EX_SYM) {
    text(p, " ");
    node(p, first, PREC_OR);
    return;
  }
  if (flat) text(p, "(");
  else open_paren(p);
  for (uint32_t i = 0; i < expr_nargs(p->g, e); i++) {
    if (i) text(p, ", ");
    node(p, expr_arg(p->g, e, i), PREC_OR);
  }
  if (flat) text(p, ")");
  else close_paren(p);
}

static void call(Printer *p, Expr e, const char *name, const char *latex_name) {
  text(p, by_style(p, name, latex_name));
  arguments(p, e);
}

static void infix(Printer *p, Expr e, const char *op, Prec prec) {
  node(p, expr_arg(p->g, e, 0), prec + 1);
  text(p, op);
  node(p, expr_arg(p->g, e, 1), prec + 1);
}

static const char *named(Printer *p, Name name) {
  StrBuf b = strbuf(p->g->arena);
  name_print(name, p->style, &b);
  return sb_text(&b);
}

static Prec prec_of_cell(const Printer *p, Expr e) {
  SumTerms terms = expr_sum_terms(p->g, e);
  return terms.n > 1 || (terms.n && terms.at[0].minus) ? PREC_SUM : latex(p) ? PREC_PROD : PREC_ATOM;
}

/* Whether it is one sum over an index, with a sign in front. */
static int is_negative_sum(const Printer *p, Expr e) {
  if (expr_op(p->g, e) != EX_CELL) return 0;
  SumTerms terms = expr_sum_terms(p->g, e);
  return terms.n == 1 && terms.at[0].minus && terms.at[0].index[0];
}

static Prec prec_of(const ExprGraph *g, Expr e) {
  switch (expr_op(g, e)) {
    case EX_NUM: {
      Num n = expr_number(g, e);
      return num_sign(n) < 0 ? PREC_SUM : num_is_exact(n) && n.den != 1 ? PREC_PROD : PREC_ATOM;
    }
    case EX_SUM: return PREC_SUM;
    case EX_PROD: {
      Num k;
      expr_pair(g, e, EX_PROD, 0, &k);
      int root = num_is_exact(k) && k.num == 1 && k.den == 2;
      if (expr_pairs(g, e, EX_PROD) > 1 || num_sign(k) < 0) return PREC_PROD;
      return root ? PREC_ATOM : PREC_POW;
    }
    case EX_POW: return PREC_POW;
    case EX_LT: case EX_LE: case EX_EQ: return PREC_CMP;
    case EX_NOT: return PREC_NOT;
    case EX_AND: return PREC_AND;
    case EX_OR: return PREC_OR;
    default: return PREC_ATOM;
  }
}

static void expand(Printer *p, Expr e) {
  ExprGraph *g = p->g;
  ExprOp op = expr_op(g, e);
  switch (op) {
    case EX_NUM: text(p, num_text(p, expr_number(g, e))); return;
    case EX_SYM: text(p, named(p, expr_sym_of(g, e)->name)); return;
    case EX_DEF: text(p, named(p, expr_def_name(g, e))); return;
    case EX_SUM: sum(p, e); return;
    case EX_PROD: term(p, e, num_int(1)); return;
    case EX_NEST: return;
    case EX_CELL: cell_terms(p, e, 0, 1, 0); return;
    case EX_POW:
      node(p, expr_arg(g, e, 0), PREC_ATOM);
      text(p, by_style(p, "^", "^{"));
      node(p, expr_arg(g, e, 1), latex(p) ? PREC_OR : PREC_ATOM);
      if (latex(p)) text(p, "}");
      return;
#define CALL(OP, name, latex, ...) case EX_##OP: call(p, e, #name, latex); return;
    FUNCTIONS(CALL)
    case EX_MIN: call(p, e, "min", "\\min"); return;
    case EX_MAX: call(p, e, "max", "\\max"); return;
    case EX_ABS: case EX_SIGN: case EX_FLOOR: case EX_ATAN2: case EX_HYPOT: case EX_SELECT: {
      const char *name = expr_op_text(op);
      const char *upright = arena_printf(g->arena, "\\operatorname{%s}", name);
      call(p, e, name, upright);
      return;
    }
    case EX_LT: infix(p, e, " < ", PREC_CMP); return;
    case EX_LE: infix(p, e, by_style(p, " <= ", " \\le "), PREC_CMP); return;
    case EX_EQ: infix(p, e, by_style(p, " == ", " = "), PREC_CMP); return;
    case EX_AND: infix(p, e, by_style(p, " and ", " \\wedge "), PREC_AND); return;
    case EX_OR: infix(p, e, by_style(p, " or ", " \\vee "), PREC_OR); return;
    case EX_NOT:
      text(p, by_style(p, "not ", "\\neg "));
      node(p, expr_arg(g, e, 0), PREC_ATOM);
      return;
    case EX_COUNT: return;
  }
}

void expr_print(ExprGraph *g, Expr e, PrintStyle style, StrBuf *out) {
  Printer p = {.g = g, .style = style};
  vec_push(g->arena, &p.stack, ((Item){NULL, e, PREC_OR}));
  while (p.stack.n) {
    Item top = p.stack.at[--p.stack.n];
    if (top.text) {
      sb_puts(out, top.text);
      continue;
    }
    Prec prec = expr_op(g, top.node) == EX_CELL ? prec_of_cell(&p, top.node) : prec_of(g, top.node);
    int group = prec < top.prec, inside = group && is_negative_sum(&p, top.node); /* K*sum(j in 1..N, -sin(x[j])) */
    if (inside) group = latex(&p);
    p.part.n = 0;
    int flat = group && is_flat(g, top.node);
    if (group) text(&p, flat ? "(" : by_style(&p, "(", "\\left("));
    if (inside) cell_terms(&p, top.node, 0, 1, 1);
    else expand(&p, top.node);
    if (group) text(&p, flat ? ")" : by_style(&p, ")", "\\right)"));
    for (uint32_t i = p.part.n; i-- > 0;) vec_push(g->arena, &p.stack, p.part.at[i]);
  }
}

/* --- names --- */

/* LaTeX names of Greek letters with their other spellings; "th" and "ph" abbreviate theta and phi. */
static const char *const greek[][2] = {
  {"alpha", "α"}, {"beta", "β"}, {"gamma", "γ"}, {"delta", "δ"}, {"epsilon", "ε"}, {"zeta", "ζ"},
  {"eta", "η"}, {"theta", "θ"}, {"iota", "ι"}, {"kappa", "κ"}, {"lambda", "λ"}, {"mu", "μ"}, {"nu", "ν"},
  {"xi", "ξ"}, {"pi", "π"}, {"rho", "ρ"}, {"sigma", "σ"}, {"tau", "τ"}, {"upsilon", "υ"}, {"phi", "φ"},
  {"chi", "χ"}, {"psi", "ψ"}, {"omega", "ω"}, {"Gamma", "Γ"}, {"Delta", "Δ"}, {"Theta", "Θ"},
  {"Lambda", "Λ"}, {"Xi", "Ξ"}, {"Pi", "Π"}, {"Sigma", "Σ"}, {"Phi", "Φ"}, {"Psi", "Ψ"}, {"Omega", "Ω"},
  {"theta", "th"}, {"phi", "ph"},
};

static void latex_stem(StrBuf *out, const char *s, size_t n) {
  for (size_t i = 0; i < sizeof greek / sizeof *greek; i++)
    for (int k = 0; k < 2; k++)
      if (strlen(greek[i][k]) == n && memcmp(greek[i][k], s, n) == 0) {
        sb_printf(out, "\\%s", greek[i][0]);
        return;
      }
  if (n <= 1) sb_putn(out, s, n);
  else sb_printf(out, "\\mathrm{%.*s}", (int)n, s);
}

static void latex_plain(Name name, StrBuf *out) {
  const char *dot = strchr(name, '.'); /* drag.c: c of drag */
  const char *s = dot ? dot + 1 : name;
  size_t end = strlen(s), primes = 0;
  while (end > 1 && s[end - 1] == '\'') end--, primes++;
  size_t stem = 0;
  while (stem < end && s[stem] != '_' && s[stem] != '[' && !(stem && s[stem] >= '0' && s[stem] <= '9')) stem++;
  static const char *const dots[] = {"", "\\dot{", "\\ddot{", "\\dddot{"};
  if (primes) sb_puts(out, dots[primes < 3 ? primes : 3]);
  latex_stem(out, s, stem);
  if (primes) sb_putc(out, '}');
  size_t sub = stem;
  if (sub < end && (s[sub] == '_' || s[sub] == '[')) sub++;
  size_t sub_end = end > sub && s[end - 1] == ']' ? end - 1 : end;
  size_t index = sub; /* where the index of d_stretch[3] begins: a subscript's own */
  while (index < sub_end && s[index] != '[') index++;
  if (sub_end > sub || dot) {
    sb_puts(out, "_{");
    if (sub_end > sub && s[sub] >= '0' && s[sub] <= '9') sb_putn(out, s + sub, sub_end - sub);
    else if (sub_end > sub) latex_stem(out, s + sub, index - sub);
    if (index + 1 < sub_end) sb_printf(out, "_{%.*s}", (int)(sub_end - index - 1), s + index + 1);
    if (dot) sb_printf(out, "%s\\mathrm{%.*s}", sub_end > sub ? "," : "", (int)(dot - name), name);
    sb_putc(out, '}');
  }
}

/* The name with Unicode subscript digits as plain digits: LaTeX has no subscript digits. */
static Name with_plain_digits(Arena *a, Name name) {
  if (!strstr(name, "\xe2\x82")) return name;
  StrBuf b = strbuf(a);
  for (const unsigned char *s = (const unsigned char *)name; *s; s++) {
    int small = s[0] == 0xe2 && s[1] == 0x82 && s[2] >= 0x80 && s[2] <= 0x89;
    sb_putc(&b, small ? (char)('0' + (s[2] - 0x80)) : (char)*s);
    if (small) s += 2;
  }
  return sb_text(&b);
}

/* LaTeX form of a name; the momentum p_th1 has the whole name th1 as subscript. */
static void latex_name(Name name, StrBuf *out) {
  int momentum = strncmp(name, "p_", 2) == 0 && name[2];
  name = with_plain_digits(out->arena, name);
  if (momentum) sb_puts(out, "p_{");
  latex_plain(momentum ? name + 2 : name, out);
  if (momentum) sb_putc(out, '}');
}

void name_print(Name name, PrintStyle style, StrBuf *out) {
  size_t n = strlen(name);
  if (style == PRINT_TEXT) sb_puts(out, name);
  /* a multiplier */
  else if (strncmp(name, "lambda(", 7) == 0) sb_printf(out, "\\lambda_{\\mathrm{%.*s}}", (int)(n - 8), name + 7);
  else latex_name(name, out);
}

const char *expr_text(ExprGraph *g, Expr e) {
  StrBuf b = strbuf(expr_arena(g));
  expr_print(g, e, PRINT_TEXT, &b);
  return sb_text(&b);
}
