/* Text -> Ast -> expression: nodes of the Ast stand in order, children first, so that one loop builds the value. */
#include "model/printed_text.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sym/expr_eval.h"
#include "sym/prove.h"
#include "syntax/parse.h"

/* ---- names ---- */

typedef struct {
  Name name;
  Expr e;
} Named;

typedef struct {
  Named *at;
  uint32_t n;
} NameTable;

static int by_name(const void *a, const void *b) { return strcmp(((const Named *)a)->name, ((const Named *)b)->name); }

/* Symbols and definitions that stand in e by their names. */
static NameTable names_in(ExprGraph *g, Arena *a, Expr e) {
  ExprList l = expr_topo_shallow(g, &e, 1);
  NameTable t = {ARENA_ARRAY(a, Named, l.n + 1), 0};
  for (uint32_t i = 0; i < l.n; i++) {
    ExprOp op = expr_op(g, l.at[i]);
    if (op == EX_SYM || op == EX_DEF)
      t.at[t.n++] = (Named){op == EX_SYM ? expr_sym_of(g, l.at[i])->name : expr_def_name(g, l.at[i]), l.at[i]};
  }
  if (t.n) qsort(t.at, t.n, sizeof *t.at, by_name);
  return t;
}

static Expr find_name(const NameTable *t, const char *name) {
  Named key = {name, 0};
  const Named *found = t->n ? bsearch(&key, t->at, t->n, sizeof *t->at, by_name) : NULL;
  return found ? found->e : 0;
}

/* The text with names of definitions that no user could write, as px'_drift, as plain names of the same length. */
static const char *parseable(Arena *a, const char *text, const NameTable *t) {
  char *plain = arena_strdup(a, text);
  for (uint32_t i = t->n; i-- > 0;) { /* px'_drift_2 before px'_drift */
    size_t n = strlen(t->at[i].name);
    if (!strstr(t->at[i].name, "'_") && !strstr(t->at[i].name, "]_")) continue;
    for (char *s = plain; (s = strstr(s, t->at[i].name)) != NULL; s += n)
      for (size_t k = 0; k < n; k++) s[k] = isalnum((unsigned char)s[k]) || (s[k] & 0x80) ? s[k] : '_';
  }
  return plain;
}

/* ---- values ---- */

typedef struct {
  ExprGraph *g;
  const Ast *ast;
  AstId first;
  Expr *value;
} Reader;

static Expr value_at(const Reader *r, AstId id) { return id >= r->first ? r->value[id - r->first] : 0; }

static Expr call(const Reader *r, const AstExpr *x) {
  Expr arg[3] = {0};
  uint32_t n = 0;
  for (AstId i = x->args; i; i = ast_expr(r->ast, i)->next, n++)
    if (n < 3 && !(arg[n] = value_at(r, i))) return 0;
  if (n == 1 && strcmp(x->name, "sqrt") == 0) return expr_sqrt(r->g, arg[0]);
  if (n == 3 && strcmp(x->name, "if") == 0) return expr_select(r->g, arg[0], arg[1], arg[2]);
  for (ExprOp op = EX_SIN; op <= EX_MAX && n && n < 3; op++)
    if (strcmp(x->name, expr_op_text(op)) == 0 && (op >= EX_ATAN2) == (n == 2))
      return n == 1 ? expr_fn(r->g, op, arg[0]) : expr_fn2(r->g, op, arg[0], arg[1]);
  return 0;
}

Expr operation_value(ExprGraph *g, const AstExpr *x, Expr a, Expr b) {
  if (!a || (!b && x->kind != AST_NEG && x->kind != AST_NOT)) return 0;
  switch (x->kind) {
    case AST_NEG: return expr_neg(g, a);
    case AST_NOT: return expr_fn(g, EX_NOT, a);
    case AST_ADD: return expr_add(g, a, b);
    case AST_SUB: return expr_sub(g, a, b);
    case AST_MUL: return expr_mul(g, a, b);
    case AST_DIV: return expr_div(g, a, b);
    case AST_POW: return expr_is_num(g, b) ? expr_pow_num(g, a, expr_number(g, b)) : expr_pow(g, a, b);
    case AST_LT: return expr_fn2(g, EX_LT, a, b);
    case AST_LE: return expr_fn2(g, EX_LE, a, b);
    case AST_GT: return expr_fn2(g, EX_LT, b, a);
    case AST_GE: return expr_fn2(g, EX_LE, b, a);
    case AST_EQ: return expr_fn2(g, EX_EQ, a, b);
    case AST_AND: return expr_fn2(g, EX_AND, a, b);
    case AST_OR: return expr_fn2(g, EX_OR, a, b);
    default: return 0;
  }
}

static Expr operation(const Reader *r, const AstExpr *x) {
  if (x->kind == AST_NUM) return expr_num(r->g, x->number);
  return x->kind == AST_CALL ? call(r, x) : operation_value(r->g, x, value_at(r, x->a), value_at(r, x->b));
}

static Expr read(const Model *m, Arena *scratch, const char *text, Expr like, KnownPart known, const void *data) {
  Sources *sources = sources_new(scratch);
  NameTable names = names_in(m->g, scratch, like);
  const char *plain = parseable(scratch, text, &names);
  const Source *source = source_add(sources, "printed", plain, strlen(plain));
  Ast *ast = ast_new(scratch, m->ast->names, sources, diags_new(scratch, sources));
  AstId root = source ? parse_expression(ast, source) : 0;
  if (!root) return 0;
  Reader r = {.g = m->g, .ast = ast, .first = ast_expr(ast, root)->first};
  r.value = ARENA_ARRAY(scratch, Expr, root - r.first + 1);
  for (AstId id = r.first; id <= root; id++) {
    const AstExpr *x = ast_expr(ast, id);
    uint32_t begin = x->span.begin - source->base, end = x->span.end - source->base;
    Expr v = known ? known(data, ast, x, begin, end) : 0;
    int a_name = x->kind == AST_NAME || x->kind == AST_PRIME || x->kind == AST_INDEX || x->kind == AST_MEMBER ||
                 x->kind == AST_CALL || x->kind == AST_AT;
    if (!v && a_name) v = find_name(&names, arena_strndup(scratch, text + begin, end - begin));
    r.value[id - r.first] = v ? v : operation(&r, x);
  }
  return r.value[root - r.first];
}

typedef struct {
  const Model *m;
  const char *text;
  Expr like, value;
  KnownPart known;
  const void *data;
} Reading;

static void read_in(Arena *scratch, void *data) {
  Reading *r = data;
  r->value = read(r->m, scratch, r->text, r->like, r->known, r->data);
}

Expr printed_value(const Model *m, const char *text, Expr like, KnownPart known, const void *data) {
  Reading r = {m, text, like, 0, known, data};
  arena_with_scratch(m->arena, read_in, &r);
  return r.value;
}

/* ---- comparison ---- */

/* 1 where the values differ by more than rounding. */
static int differs(ExprGraph *g, EvalTape *tape, uint32_t seed, long double *symbols) {
  const long double rounding = 1e-9L; /* of long doubles, after cancellation of nine digits */
  long double v[2];
  sample_state(g, seed, symbols);
  eval_run(tape, symbols, v);
  return isfinite(v[0]) ? !(fabsl(v[0] - v[1]) <= rounding * (fabsl(v[0]) + fabsl(v[1]) + 1e-6L)) : isfinite(v[1]) != 0;
}

static int has_sums(ExprGraph *g, Expr e) {
  ExprList l = expr_topo_to_sums(g, &e, 1);
  for (uint32_t k = 0; k < l.n; k++)
    if (expr_op(g, l.at[k]) == EX_CELL) return 1;
  return 0;
}

int printed_says(const Model *m, const char *text, Expr e) {
  enum { STATES = 5, MOST = 1 };                 /* one state may lie beside a pole or a branch */
  /* of models whose texts people read; the bicycle has 22,500 nodes */
  enum { SYMBOLS_MOST = 2000, NODES_MOST = 50000 };
  if (expr_symbol_count(m->g) > SYMBOLS_MOST || expr_count(m->g) > NODES_MOST) return 1;
  if (has_sums(m->g, e)) return 1; /* they are not read again */
  Expr both[2] = {e, printed_value(m, text, e, NULL, NULL)};
  if (!both[1] || both[0] == both[1]) return both[1] != 0;
  EvalTape *tape = eval_tape(m->g, both, 2);
  long double *symbols = ARENA_ARRAY(m->arena, long double, expr_symbol_count(m->g) + 1);
  int wrong = 0;
  for (uint32_t seed = 1; seed <= STATES; seed++) wrong += differs(m->g, tape, seed, symbols);
  return wrong <= MOST;
}

void expr_print_checked(const Model *m, Expr e, PrintStyle style, StrBuf *out) {
  StrBuf as_text = strbuf(m->arena);
  expr_print(m->g, e, style, out);
  expr_print(m->g, e, PRINT_TEXT, &as_text);
  if (!printed_says(m, sb_text(&as_text), e))
    diag_error(m->diags, (Span){0}, "internal error: `%s` is not the formula that was to be printed",
               sb_text(&as_text));
}
