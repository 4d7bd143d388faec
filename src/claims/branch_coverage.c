/* One entry for each condition, switch and function in the roots, with two flags that compared states set. */
#include "claims/branch_coverage.h"

#include <math.h>

#include "sym/expr_eval.h"
#include "sym/print.h"

typedef long double Real;

typedef enum { TRUTH, SIGN, VALUE } SideKind;

typedef struct {
  Expr e;
  SideKind kind;
  int one, other; /* seen: true and false; positive and negative; a value, and another */
  Real value;
} Sides;

struct BranchCoverage {
  ExprGraph *g;
  EvalTape *tape;
  VEC(Sides) all;
  Real *values;
  uint32_t missing;
};

/* Whether e depends on any symbol but constants. */
static int varies(ExprGraph *g, Expr e) {
  const unsigned fixed = 1u << SYM_CONST;
  return (expr_kinds(g, e) & ~fixed) != 0;
}

static void add(BranchCoverage *s, Expr e, SideKind kind) {
  for (uint32_t i = 0; i < s->all.n; i++)
    if (s->all.at[i].e == e) return;
  vec_push(expr_arena(s->g), &s->all, ((Sides){.e = e, .kind = kind}));
}

Expr switching_function(ExprGraph *g, Expr e) {
  ExprOp op = expr_op(g, e);
  if (op == EX_ABS || op == EX_SIGN) return expr_arg(g, e, 0);
  if (op != EX_LT && op != EX_LE && op != EX_EQ && op != EX_MIN && op != EX_MAX) return 0;
  return expr_sub(g, expr_arg(g, e, 0), expr_arg(g, e, 1));
}

BranchCoverage *branch_coverage(ExprGraph *g, const Expr *roots, uint32_t n) {
  Arena *a = expr_arena(g);
  BranchCoverage *s = ARENA_NEW(a, BranchCoverage);
  VEC(Expr) tape = {0};
  *s = (BranchCoverage){.g = g};
  ExprList l = expr_topo(g, roots, n);
  for (uint32_t i = 0; i < l.n; i++) {
    ExprOp op = expr_op(g, l.at[i]);
    if (!varies(g, l.at[i])) continue;
    if (expr_is_bool(g, l.at[i])) add(s, l.at[i], TRUTH);
    else if (op >= EX_SIN && op <= EX_CBRT) add(s, l.at[i], VALUE);
  }
  for (uint32_t i = 0; i < l.n; i++) {
    Expr u = switching_function(g, l.at[i]);
    if (u && expr_sign(g, u) == SIGN_UNKNOWN && varies(g, u)) add(s, u, SIGN);
  }
  for (uint32_t i = 0; i < s->all.n; i++) vec_push(a, &tape, s->all.at[i].e);
  s->tape = eval_tape(g, tape.at, tape.n);
  s->values = ARENA_ARRAY(a, Real, tape.n + 1);
  s->missing = s->all.n;
  return s;
}

void branch_coverage_note(BranchCoverage *s, const long double *symbols) {
  if (s->missing == 0) return;
  eval_run(s->tape, symbols, s->values);
  s->missing = 0;
  for (uint32_t i = 0; i < s->all.n; i++) {
    Sides *of = &s->all.at[i];
    Real x = s->values[i];
    if (isfinite(x)) {
      of->other |= of->kind == VALUE ? of->one && x != of->value : of->kind == SIGN ? x < 0 : x == 0;
      of->one |= of->kind == VALUE || x > 0;
      if (of->kind == VALUE && !of->other) of->value = x;
    }
    s->missing += !of->one || !of->other;
  }
}

const char *branch_coverage_missing(const BranchCoverage *s) {
  StrBuf b = strbuf(expr_arena(s->g));
  vec_each(const Sides, of, s->all) {
    if (of->one && of->other) continue;
    sb_putc(&b, '`');
    expr_print(s->g, of->e, PRINT_TEXT, &b);
    sb_puts(&b, of->kind == TRUTH  ? of->one ? "` false" : "` true"
                : of->kind == SIGN ? of->one ? "` negative" : "` positive"
                                   : "` with two distinguishable values");
    return sb_text(&b);
  }
  return NULL;
}
