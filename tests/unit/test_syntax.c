/* Unit tests of the front end: filter, brackets, precedence, spans, dots, limits, memory. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

#include "slow.h"
#include "syntax/token_filter.h"
#include "syntax/parse.h"

/* ---- a compilation for one test ---- */

typedef struct {
  Arena *arena;
  Ast *ast;
  const Source *source;
} Text;

static Text text_new(const char *lag) {
  Text t = {.arena = arena_new(NULL)};
  Sources *sources = sources_new(t.arena);
  t.ast = ast_new(t.arena, interner_new(t.arena), sources, diags_new(t.arena, sources));
  t.source = source_add(sources, "test.lag", lag, strlen(lag));
  return t;
}

static const char *messages(const Text *t) {
  StrBuf out = strbuf(t->arena);
  diags_print(t->ast->diags, &out);
  return sb_text(&out);
}

/* An expression in prefix form, every operation in parentheses: what precedence made of it. */
static void print_expr(const Ast *ast, AstId id, StrBuf *out) {
  const AstExpr *e = ast_expr(ast, id);
  static const char *const text[] = {
#define TEXT(kind, op) op,
      AST_EXPR_KINDS(TEXT)
#undef TEXT
  };
  if (e->kind == AST_NUM) {
    num_print(out, e->number);
    return;
  }
  if (e->kind == AST_NAME) {
    sb_puts(out, e->name);
    return;
  }
  const char *word = text[e->kind];
  if (e->kind == AST_PRIME) word = "'";
  if (e->kind == AST_UNIT) word = "unit";
  if (e->kind == AST_INDEX) word = "index";
  if (e->kind == AST_TUPLE) word = "tuple";
  if (e->kind == AST_LIST) word = "list";
  if (e->kind == AST_SUM) word = "sum";
  if (e->kind == AST_BIND) word = "bind";
  sb_printf(out, "(%s", word ? word : e->name);
  if (word && e->name) sb_printf(out, " %s", e->name);
  for (AstId child = e->args; child; child = ast_expr(ast, child)->next) {
    sb_putc(out, ' ');
    print_expr(ast, child, out);
  }
  const AstId children[] = {e->a, e->b, e->c};
  for (int i = 0; i < 3; i++)
    if (children[i]) {
      sb_putc(out, ' ');
      print_expr(ast, children[i], out);
    }
  if (e->kind == AST_UNIT) sb_printf(out, " [%s]", e->unit.text);
  sb_putc(out, ')');
}

static void expect_expr(const char *lag, const char *want) {
  Text t = text_new(lag);
  AstId id = parse_expression(t.ast, t.source);
  if (!id) fail_msg("%s", messages(&t));
  StrBuf out = strbuf(t.arena);
  print_expr(t.ast, id, &out);
  assert_string_equal(sb_text(&out), want);
  arena_free(t.arena);
}

static void expect_no_expr(const char *lag) {
  Text t = text_new(lag);
  assert_int_equal(parse_expression(t.ast, t.source), 0);
  assert_true(t.ast->diags->errors > 0);
  arena_free(t.arena);
}

/* ---- the filter ---- */

/* Token words in a row: `end` for END, `name` for IDENT, `!` for BADWORD. */
static void expect_tokens(const char *lag, const char *want) {
  Text t = text_new(lag);
  Filter *f = filter_new(scan_new(t.arena, t.ast->names, t.source), 0);
  StrBuf out = strbuf(t.arena);
  for (;;) {
    Token k = filter_next(f);
    if (k.kind == TOK_FINISH) break;
    const char *word = k.kind == TOK_END ? "end" : k.kind == TOK_IDENT ? "name" : k.kind == TOK_NUMBER ? "1"
                     : k.kind == TOK_UNIT ? "unit" : k.kind == TOK_BADWORD ? "!" : token_word(k.kind);
    sb_printf(&out, "%s%s", out.n ? " " : "", word);
  }
  assert_string_equal(sb_text(&out), want);
  arena_free(t.arena);
}

static void test_lines(void **state) {
  (void)state;
  expect_tokens("let a = 1\n", "let name = 1 end");
  expect_tokens("let a = 1", "let name = 1 end");
  expect_tokens("\n\n# x\nlet a = 1 # y\n\n\nlet b = 2", "let name = 1 end let name = 1 end");
  expect_tokens("let a =\n 1 +\n 2", "let name = 1 + 1 end");
  expect_tokens("let a = 1\n # c\n\n - 2", "let name = 1 - 1 end");
  expect_tokens("let a = b\n and c", "let name = name and name end");
  expect_tokens("let a = x\n'", "let name = name end ' end");
  expect_tokens("let a = f(x\n)", "let name = name ( name ) end");
  expect_tokens("let a = f(x\nlet b = 1", "let name = name ( name end let name = 1 end");
  expect_tokens(";;let a = 1;;", "let name = 1 end");
  expect_tokens("effect a\n{\n}\n", "effect name { } end");
  expect_tokens("effect a { let b = 1 } effect c { }", "effect name { let name = 1 end } end effect name { } end");
  expect_tokens("event a: x { stop }", "event name : name { stop end } end");
  expect_tokens("let a = {1,\n2\n}", "let name = { 1 , 1 } end");
  expect_tokens("let a = 2*\nlet b = 3", "let name = 1 * end let name = 1 end");
  expect_tokens("constraint c: a +\nforce = b", "constraint name : name + name = name end");
  expect_tokens("\r\nlet a = 1\r\n", "let name = 1 end");
}

static void test_words(void **state) {
  (void)state;
  expect_tokens("coord force, d, let", "coord name , name , name end");
  expect_tokens("coord periodic periodic", "coord name periodic end");
  expect_tokens("let a = every + rising", "let name = name + name end");
  expect_tokens("scene s { span 2; span = 2; span.x = 1; span[1] = 1; span' = 1 }",
                "scene name { span 1 end name = 1 end name . name = 1 end name [ 1 ] = 1 end name ' = 1 end } end");
  expect_tokens("scene s { output x every 1; output every, y }",
                "scene name { output name every 1 end output name , name end } end");
  expect_tokens("scene s { start exactly x = 1; start exactly = 1 }",
                "scene name { start exactly name = 1 end start name = 1 end } end");
  expect_tokens("event a: x rising { stop; stop = 1 }", "event name : name rising { stop end name = 1 end } end");
  expect_tokens("contact c: y >= 0, restitution = restitution",
                "contact name : name >= 1 , restitution = name end");
  expect_tokens("let a = sum + sum(i in 1..2, i)", "let name = name + sum ( name in 1 .. 1 , name ) end");
  expect_tokens("start x = 1", "! name = 1 end");
  expect_tokens("lagragian = 1", "! = 1 end");
}

static void test_brackets(void **state) {
  (void)state;
  expect_expr("x[1]", "(index 1 x)");
  expect_expr("x [m]", "(unit x [m])");
  expect_expr("90 [deg]", "(unit 90 [deg])");
  expect_expr("90[deg]", "(unit 90 [deg])");
  expect_expr("x[1][2]", "(index 2 (index 1 x))");
  expect_expr("x[i, j+1]", "(index i (+ j 1) x)");
  expect_expr("x[y[1]]'", "(' (index (index 1 y) x))");
  expect_expr("(a + b) [m]", "(unit (+ a b) [m])");
  expect_expr("{1, 2}[m]", "(unit (list 1 2) [m])");
  expect_expr("{1, 2} [m]", "(unit (list 1 2) [m])");
  expect_expr("-90 [deg]", "(unit (- 90) [deg])");
  expect_expr("1/2 [m]", "(unit (/ 1 2) [m])");
  expect_expr("-1/2 [m]", "(unit (/ (- 1) 2) [m])");
  expect_expr("x/2 [m]", "(/ x (unit 2 [m]))");
  expect_expr("x - 1 [m]", "(- x (unit 1 [m]))");
  expect_no_expr("(a, b)[m]");
  expect_no_expr("x'[1]");
}

static void test_precedence(void **state) {
  (void)state;
  expect_expr("-x^2", "(- (^ x 2))");
  expect_expr("2^-1", "(^ 2 (- 1))");
  expect_expr("2^3^4", "(^ 2 (^ 3 4))");
  expect_expr("2**3^4", "(^ 2 (^ 3 4))");
  expect_expr("a - b - c", "(- (- a b) c)");
  expect_expr("a/b*c", "(* (/ a b) c)");
  expect_expr("a + b*c^d'", "(+ a (* b (^ c (' d))))");
  expect_expr("x'^2", "(^ (' x) 2)");
  expect_expr("x''", "(' (' x))");
  expect_expr("-x*y", "(* (- x) y)");
  expect_expr("a or b and not c < d", "(or a (and b (not (< c d))))");
  expect_expr("not a and b", "(and (not a) b)");
  expect_expr("a + 1 <= b", "(<= (+ a 1) b)");
  expect_expr("if(a < 1, b, c)", "(if (< a 1) b c)");
  expect_expr("sum(i in 1..N-1, x[i])", "(sum i 1 (- N 1) (index i x))");
  expect_expr("(a, b)", "(tuple a b)");
  expect_expr("f()", "(f)");
  expect_expr("1.5e1 + .5 + 2.", "(+ (+ 15 1/2) 2)");
  expect_expr("sum(i in 1..2, i)", "(sum i 1 2 i)");
  expect_no_expr("a < b < c");
  expect_no_expr("2x");
  expect_no_expr("");
  expect_no_expr("1 2");
  expect_no_expr("1; 2");
}

static void test_dots(void **state) {
  (void)state;
  expect_expr("q\xCC\x87", "(' q)");
  expect_expr("\xE1\xBA\x8B", "(' x)");
  expect_expr("\xE1\xBA\x8D", "(' (' x))");
  expect_expr("\xCE\xB8\xCC\x88", "(' (' \xCE\xB8))");
  expect_expr("q\xCC\x87" "1", "(' q1)");
  expect_expr("\xCE\xB8\xCC\x87[i]^2", "(^ (' (index i \xCE\xB8)) 2)");
  expect_expr("q\xCC\x87[r\xCC\x87[1]]", "(' (index (' (index 1 r)) q))");
  expect_expr("\xCE\xB8" "1 + Fl\xC3\xA4" "che", "(+ \xCE\xB8" "1 Fl\xC3\xA4" "che)");
}

/* ---- spans and `first` ---- */

static void check_nodes(const Text *t) {
  const Ast *ast = t->ast;
  for (AstId id = 1; id < ast->exprs.n; id++) {
    const AstExpr *e = ast_expr(ast, id);
    const AstId children[] = {e->a, e->b, e->c};
    assert_true(e->first >= 1 && e->first <= id);
    assert_true(e->span.begin >= t->source->base && e->span.begin < e->span.end);
    assert_true(e->span.end <= t->source->base + t->source->len);
    for (int i = 0; i < 3; i++)
      if (children[i]) assert_true(children[i] < id && ast_expr(ast, children[i])->first >= e->first);
    for (AstId arg = e->args; arg; arg = ast_expr(ast, arg)->next)
      assert_true(arg < id && ast_expr(ast, arg)->first >= e->first);
  }
}

static void test_nodes(void **state) {
  (void)state;
  Text t = text_new(
      "let a = (x + y)*z - sum(i in 1..N, f(i, -1/2 [m], x'[i])) + 1/2 [m] - -3 [s]\n"
      "contact c: y >= h, restitution = 1/2\n"
      "start x = 1\nforce (a, b, c) = (d, e)\n");
  parse(t.ast, t.source);
  check_nodes(&t);
  arena_free(t.arena);
}

static void test_spans(void **state) {
  (void)state;
  static const char lag[] = "let a = (x + y)*z\n";
  Text t = text_new(lag);
  assert_true(parse(t.ast, t.source));
  const AstStmt *s = t.ast->first;
  const AstExpr *mul = ast_expr(t.ast, s->rhs), *add = ast_expr(t.ast, mul->a);
  uint32_t base = t.source->base;
  assert_int_equal(mul->kind, AST_MUL);
  assert_int_equal(mul->span.begin, base + 8);
  assert_int_equal(mul->span.end, base + 17);
  assert_int_equal(mul->op_span.begin, base + 15);
  assert_int_equal(add->span.begin, base + 9);
  assert_int_equal(add->span.end, base + 14);
  assert_int_equal(s->name_span.begin, base + 4);
  arena_free(t.arena);
}

/* ---- sizes ---- */

static double seconds(clock_t from) { return (double)(clock() - from) / CLOCKS_PER_SEC; }

/* head, then `piece` n times, then tail */
static char *repeated(const char *head, const char *piece, size_t n, const char *tail) {
  size_t len = strlen(piece), at = strlen(head);
  char *text = malloc(at + n * len + strlen(tail) + 1);
  assert_non_null(text);
  memcpy(text, head, at);
  for (size_t i = 0; i < n; i++, at += len) memcpy(text + at, piece, len);
  memcpy(text + at, tail, strlen(tail) + 1);
  return text;
}

static void parse_fast(const char *lag, int ok) {
  clock_t from = clock();
  Text t = text_new(lag);
  if (parse(t.ast, t.source) != ok) fail_msg("%s", messages(&t));
  if (ok) {
    StrBuf out = strbuf(t.arena);
    ast_dump(t.ast, &out);
  }
  arena_free(t.arena);
  assert_true(seconds(from) < 20); /* generous: it takes well under two, but not under a sanitizer */
}

static void test_many_terms(void **state) {
  (void)state;
  char *lag = repeated("let a = x", " + x", (size_t)slow(1000000, 100000), "\n");
  parse_fast(lag, 1);
  free(lag);
}

static void test_deep(void **state) {
  (void)state;
  char *open = repeated("let a = ", "(", 100000, "x");
  char *lag = repeated(open, ")", 100000, "\n");
  parse_fast(lag, 1);
  free(open);
  free(lag);
  lag = repeated("let a = 1", "^1", (size_t)slow(300000, 50000), "\n");
  parse_fast(lag, 1);
  free(lag);
  lag = repeated("let a = ", "-", (size_t)slow(300000, 50000), "x\n");
  parse_fast(lag, 1);
  free(lag);
  lag = repeated("let a = x", "'", (size_t)slow(300000, 50000), "\n");
  parse_fast(lag, 1);
  free(lag);
}

/* Past a limit there is one message that names it, and the rest of the file is still read. */
static void test_limits(void **state) {
  (void)state;
  char *lag = repeated("let a = ", "(", 1000001, "x\nlet b = ,\n");
  Text t = text_new(lag);
  assert_false(parse(t.ast, t.source));
  assert_non_null(strstr(t.ast->diags->list.at[0].message, "1000000"));
  assert_int_equal(t.ast->diags->errors, 2);
  arena_free(t.arena);
  free(lag);
  lag = repeated("", "for i in 1..2 {\n", 65, "");
  t = text_new(lag);
  assert_false(parse(t.ast, t.source));
  assert_non_null(strstr(messages(&t), "64 deep"));
  arena_free(t.arena);
  free(lag);
  lag = repeated("let a = ", "-", 4100000, "x\n");
  t = text_new(lag);
  assert_false(parse(t.ast, t.source));
  assert_non_null(strstr(messages(&t), "4000000"));
  arena_free(t.arena);
  free(lag);
}

static void test_many_errors(void **state) {
  (void)state;
  char *lag = repeated("", "let a = ,\n", 5000, "");
  Text t = text_new(lag);
  assert_false(parse(t.ast, t.source));
  assert_int_equal(t.ast->diags->errors, 5000);
  arena_free(t.arena);
  free(lag);
}

/* ---- memory ---- */

typedef struct {
  long left;  /* allocations until one fails; negative: none fails */
  long alive; /* blocks not freed yet */
} Budget;

static void *budget_alloc(void *user, size_t n) {
  Budget *b = user;
  if (b->left == 0) return NULL;
  if (b->left > 0) b->left--;
  void *p = malloc(n);
  if (p) b->alive++;
  return p;
}

static void budget_free(void *user, void *p) {
  Budget *b = user;
  if (p) b->alive--;
  free(p);
}

/* Parses with the n-th allocation failing. 1 when it was not reached. */
static int parse_with_budget(const char *lag, long n) {
  Budget budget = {.left = n};
  ArenaConfig config = {.alloc = budget_alloc, .dealloc = budget_free, .user = &budget, .chunk = 64};
  volatile int done = 0;
  Arena *volatile a = arena_new(&config);
  if (!a) return 0;
  jmp_buf failed;
  if (!setjmp(failed)) {
    arena_guard(a, &failed);
    Sources *sources = sources_new(a);
    Ast *ast = ast_new(a, interner_new(a), sources, diags_new(a, sources));
    const Source *source = source_add(sources, "test.lag", lag, strlen(lag));
    parse(ast, source);
    StrBuf out = strbuf(a);
    ast_dump(ast, &out);
    diags_print(ast->diags, &out);
    done = 1;
  }
  arena_free(a);
  assert_int_equal(budget.alive, 0);
  return done;
}

static void test_memory(void **state) {
  (void)state;
  static const char head[] =
      "model m \"doc\"\ncoord x [m], th[N] [rad] periodic, r: vec3 [kg*(m/s)^2]\nparam k = 1/2 [N/m] > 0\n"
      "let a[i in 1..N] = a[i-1] + sum(j in 1..i, sin(th[j]))\nlagrangean = 1\nlet b = x +* 2\n"
      "symmetry s(e): for i in 1..N: x -> x + e, y -> y\nevent hit: x rising { x' = -x'; stop }\n"
      "contact c: y >= h, restitution = 1\ninclude \"nowhere.lag\"\nlet c = ";
  char *lag = repeated(head, "(", 300, "x\nscene s { start q\xCC\x87 = 90 [deg/s], r = {1, 2}; foo; use d(c = 1) }");
  long n = 0;
  while (!parse_with_budget(lag, n)) n++;
  assert_true(n > 100);
  free(lag);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_lines),     cmocka_unit_test(test_words),         cmocka_unit_test(test_brackets),
      cmocka_unit_test(test_precedence), cmocka_unit_test(test_dots),         cmocka_unit_test(test_nodes),
      cmocka_unit_test(test_spans),     cmocka_unit_test(test_many_terms)   , cmocka_unit_test(test_deep),
      cmocka_unit_test(test_limits),    cmocka_unit_test(test_many_errors),   cmocka_unit_test(test_memory),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
