/* mutate FILE: makes every single-edit mutant of the expectations of a model and checks each: it must be refuted, or
 * proved where the edit changes nothing, and the message must point at the edit. Prints what went wrong (-v: every
 * mutant) and counts; exit status 0 when every mutant was decided.
 *
 * Edits: each sign flipped, a sign put before each first term, each factor 2 dropped or made 3, each exponent dropped,
 * each sin for cos and back, each term of a sum and each factor of a product dropped. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "claims/expect.h"
#include "symmetry/charges.h"
#include "syntax/parse.h"

/* Bytes from..to of the text become `with`; in the mutant the edit is seen at begin..end, and a caret may lie anywhere
 * in around_begin..around_end: the sum or product that was edited. */
typedef struct {
  const char *kind;
  uint32_t from, to;
  char with[8];
  uint32_t begin, end, around_begin, around_end;
} Edit;

typedef struct {
  Edit *at;
  uint32_t n, cap;
} Edits;

typedef struct {
  const Ast *ast;
  uint32_t base; /* of the text */
  const char *text;
  Edits *out;
  const uint32_t *up; /* the node above each */
  AstId first;
} Walk;

/* --- making mutants --- */

/* Places are given in the old text; what follows the edit moves with it. */
static void add(Walk *w, const char *kind, Span span, const char *with, Span seen, Span around) {
  Edits *l = w->out;
  if (l->n == l->cap) {
    l->cap = l->cap ? 2 * l->cap : 256;
    l->at = realloc(l->at, l->cap * sizeof *l->at);
    if (!l->at) abort();
  }
  Edit e = {.kind = kind, .from = span.begin - w->base, .to = span.end - w->base};
  snprintf(e.with, sizeof e.with, "%s", with);
  int32_t moved = (int32_t)strlen(with) - (int32_t)(span.end - span.begin);
  uint32_t places[4] = {seen.begin - w->base, seen.end - w->base, around.begin - w->base, around.end - w->base};
  for (int i = 0; i < 4; i++)
    if (places[i] >= e.to && !(i % 2 == 0 && places[i] == e.from)) places[i] = (uint32_t)((int32_t)places[i] + moved);
    else if (places[i] > e.from) places[i] = i % 2 ? e.from + (uint32_t)strlen(with) : e.from;
  e.begin = places[0], e.end = places[1], e.around_begin = places[2], e.around_end = places[3];
  l->at[l->n++] = e;
}

static int is_sum(AstKind k) { return k == AST_ADD || k == AST_SUB; }
static int is_product(AstKind k) { return k == AST_MUL || k == AST_DIV; }
static const AstExpr *node(const Walk *w, AstId id) { return ast_expr(w->ast, id); }
static AstId above(const Walk *w, AstId id) { return w->up[id - w->first]; }

/* With parentheses that are written around it. */
static Span outer(const Walk *w, Span s) {
  const char *t = w->text;
  uint32_t b = s.begin - w->base, e = s.end - w->base;
  if (b > 0 && t[b - 1] == '(' && t[e] == ')' && (b < 2 || strchr("(+-*/ =", t[b - 2])))
    return (Span){s.begin - 1, s.end + 1};
  return s;
}

/* The whole chain of + and -, or of * and /, that a node is the left part of. */
static AstId whole(const Walk *w, AstId id) {
  for (;;) {
    AstId up = above(w, id);
    if (!up || node(w, up)->a != id) return id;
    AstKind k = node(w, id)->kind, u = node(w, up)->kind;
    if ((is_sum(k) && is_sum(u)) || (is_product(k) && is_product(u))) id = up;
    else return id;
  }
}

/* The innermost sum or product that a node stands in; the argument or the side when there is none. */
static Span enclosing(const Walk *w, AstId id) {
  AstId up = above(w, id);
  while (up && !is_sum(node(w, up)->kind) && !is_product(node(w, up)->kind)) {
    id = up;
    up = above(w, up);
  }
  return outer(w, node(w, up ? whole(w, up) : whole(w, id))->span);
}

static Span join(Span a, Span b) { return span_join(a, b); }

static int is_first_term(const Walk *w, AstId id) {
  AstId up = above(w, id);
  if (is_sum(node(w, id)->kind)) return 0;
  return !up || node(w, up)->kind == AST_CALL || (is_sum(node(w, up)->kind) && node(w, up)->a == id);
}

static void sign_edits(Walk *w, AstId id) {
  const AstExpr *x = node(w, id);
  if (is_sum(x->kind)) {
    Span term = join(x->op_span, outer(w, node(w, x->b)->span));
    add(w, "sign", x->op_span, x->kind == AST_ADD ? "-" : "+", term, enclosing(w, x->b));
  }
  if (x->kind == AST_NEG) {
    Span all = enclosing(w, id);
    add(w, "sign", x->op_span, "", all, all);
  }
  if (is_first_term(w, id)) {
    Span span = outer(w, x->span);
    if (w->text[span.begin - w->base] == '-') return; /* the minus there is dropped already */
    add(w, "sign", (Span){span.begin, span.begin}, "-", span, enclosing(w, id));
  }
}

static int under_power(const Walk *w, AstId id) {
  AstId up = above(w, id);
  return up && node(w, up)->kind == AST_POW && node(w, up)->b == id;
}

static void number_edits(Walk *w, AstId id) {
  const AstExpr *x = node(w, id);
  AstId up = above(w, id);
  if (x->kind != AST_NUM || !up || !num_equal(x->number, num_int(2))) return;
  if (under_power(w, id)) {
    Span power = join(node(w, up)->op_span, x->span);
    add(w, "exponent", power, "", node(w, up)->span, enclosing(w, up));
    add(w, "number", x->span, "3", x->span, enclosing(w, up));
    return;
  }
  add(w, "number", x->span, "3", x->span, enclosing(w, id));
}

static void function_edits(Walk *w, AstId id) {
  const AstExpr *x = node(w, id);
  if (x->kind != AST_CALL) return;
  if (strcmp(x->name, "sin") == 0) add(w, "function", x->op_span, "cos", x->span, enclosing(w, id));
  if (strcmp(x->name, "cos") == 0) add(w, "function", x->op_span, "sin", x->span, enclosing(w, id));
}

/* a + b becomes a, and, where a is the first term, b (with its sign). */
static void dropped_terms(Walk *w, AstId id) {
  const AstExpr *x = node(w, id);
  if (!is_sum(x->kind)) return;
  Span sum = outer(w, node(w, whole(w, id))->span), a = outer(w, node(w, x->a)->span),
       b = outer(w, node(w, x->b)->span);
  add(w, "term", (Span){a.end, b.end}, "", sum, sum);
  if (is_sum(node(w, x->a)->kind)) return;
  uint32_t to = x->kind == AST_SUB ? x->op_span.begin : b.begin;
  add(w, "term", (Span){a.begin, to}, "", sum, sum);
}

/* a*b becomes a, and, where a is the first factor, b; a/b becomes a, or 1/b. */
static void dropped_factors(Walk *w, AstId id) {
  const AstExpr *x = node(w, id);
  if (!is_product(x->kind)) return;
  Span product = outer(w, node(w, whole(w, id))->span), a = outer(w, node(w, x->a)->span),
       b = outer(w, node(w, x->b)->span);
  add(w, "factor", (Span){a.end, b.end}, "", product, product);
  if (is_product(node(w, x->a)->kind)) return;
  const AstExpr *first = node(w, x->a);
  uint32_t from = first->kind == AST_NEG ? first->op_span.end : a.begin; /* -a*b becomes -b */
  if (x->kind == AST_MUL) add(w, "factor", (Span){from, b.begin}, "", product, product);
  else add(w, "factor", (Span){from, a.end}, "1", product, product);
}

static void edits_of(const Ast *ast, const Source *source, AstId root, Edits *out) {
  AstId first = ast_expr(ast, root)->first;
  uint32_t *up = calloc(root - first + 1, sizeof *up);
  if (!up) abort();
  for (AstId i = first; i <= root; i++) {
    const AstExpr *x = ast_expr(ast, i);
    AstId below[] = {x->a, x->b, x->c};
    for (int k = 0; k < 3; k++)
      if (below[k]) up[below[k] - first] = i;
    for (AstId k = x->args; k; k = ast_expr(ast, k)->next) up[k - first] = i;
  }
  Walk w = {.ast = ast, .base = source->base, .text = source->text, .out = out, .up = up, .first = first};
  for (AstId i = first; i <= root; i++) {
    sign_edits(&w, i);
    number_edits(&w, i);
    function_edits(&w, i);
    dropped_terms(&w, i);
    dropped_factors(&w, i);
  }
  free(up);
}

/* --- judging them --- */

typedef struct {
  uint32_t total, refuted, units, proved, undecided, broken, hits, advised;
  int verbose;
} Counts;

typedef struct {
  Arena *arena;
  Sources *sources;
  Diags *diags;
  Ast *ast;
  const Source *source;
} Reading;

static int read_text(Reading *r, Arena *a, const char *path, const char *text) {
  r->arena = a;
  r->sources = sources_new(a);
  r->sources->library = "models/lib";
  r->diags = diags_new(a, r->sources);
  r->ast = ast_new(a, interner_new(a), r->sources, r->diags);
  r->source = source_add(r->sources, path, text, strlen(text));
  return parse(r->ast, r->source);
}

static void show(const Counts *c, const char *why, const Edit *e, const char *text, const Reading *r) {
  if (!c->verbose && strcmp(why, "hit") == 0) return;
  const char *line = text + e->from, *end;
  while (line > text && line[-1] != '\n') line--;
  end = strchr(line, '\n');
  printf("# %s: %s: %.*s\n", why, e->kind, (int)(end - line), line);
  StrBuf b = strbuf(r->arena);
  diags_print(r->diags, &b);
  for (char *s = b.n ? strtok(b.at, "\n") : NULL; s; s = strtok(NULL, "\n")) printf("#     %s\n", s);
}

static int hits(const Edit *e, const Reading *r) {
  if (r->diags->list.n != 1) return 0;
  Span at = r->diags->list.at[0].span;
  uint32_t b = at.begin - r->source->base, n = at.end - r->source->base;
  return b < e->end && n > e->begin && b >= e->around_begin && n <= e->around_end;
}

static void judge(Counts *c, const Edit *e, const char *text, Reading *r) {
  ModelChoice choice = {.bare = 1};
  ExpectResults results = {0};
  c->total++;
  Model *m = model_build(r->ast, &choice);
  if (!m) {
    c->units++;
    return;
  }
  Eqns *eqns = equations_of(m);
  if (!eqns) {
    c->broken++;
    show(c, "not a model", e, text, r);
    return;
  }
  expects_check(eqns, NULL, 0, &results);
  int refuted = 0, undecided = 0;
  for (uint32_t i = 0; i < results.n; i++) {
    refuted += results.at[i].verdict == EXPECT_REFUTED;
    undecided += results.at[i].verdict == EXPECT_AGREES;
  }
  c->undecided += undecided > 0;
  c->refuted += refuted > 0;
  c->proved += !refuted && !undecided;
  if (undecided) show(c, "not decided", e, text, r);
  if (!refuted) {
    if (c->verbose && !undecided) show(c, "equivalent", e, text, r);
    return;
  }
  c->advised += strstr(r->diags->list.at[0].message, "no single edit") == NULL;
  int hit = hits(e, r);
  c->hits += (uint32_t)hit;
  show(c, hit ? "hit" : "missed", e, text, r);
}

static void try_mutant(Counts *c, const char *path, const char *text, const Edit *e) {
  Arena *a = arena_new(NULL);
  jmp_buf failed;
  if (!a || setjmp(failed)) abort();
  arena_guard(a, &failed);
  char *mutant = arena_printf(a, "%.*s%s%s", (int)e->from, text, e->with, text + e->to);
  Reading r;
  if (read_text(&r, a, path, mutant)) {
    judge(c, e, mutant, &r);
  } else {
    c->total++, c->broken++;
    show(c, "does not parse", e, mutant, &r);
  }
  arena_free(a);
}

static int run(Arena *a, const char *path, int verbose) {
  const char *why;
  Sources *files = sources_new(a);
  const Source *file = source_read(files, path, &why);
  Reading r;
  if (!file || !read_text(&r, a, path, file->text)) {
    fprintf(stderr, "mutate: cannot read %s\n", path);
    return 2;
  }
  Edits edits = {0};
  for (const AstStmt *s = r.ast->first; s; s = s->next)
    if (s->kind == STMT_EXPECT) edits_of(r.ast, r.source, s->rhs, &edits);
  Counts c = {.verbose = verbose};
  for (uint32_t i = 0; i < edits.n; i++) try_mutant(&c, path, file->text, &edits.at[i]);
  free(edits.at);
  printf("%u mutants: %u refuted by proof, %u by units, %u equivalent and proved, %u not decided, %u broken; "
         "caret on the edit in %u of %u, the edit named in %u\n",
         c.total, c.refuted, c.units, c.proved, c.undecided, c.broken, c.hits, c.refuted, c.advised);
  return c.undecided || c.broken;
}

int main(int argc, char **argv) {
  int verbose = argc == 3 && strcmp(argv[1], "-v") == 0;
  if (argc != 2 + verbose) {
    fputs("usage: mutate [-v] FILE\n", stderr);
    return 2;
  }
  Arena *a = arena_new(NULL);
  jmp_buf failed;
  if (!a || setjmp(failed)) {
    arena_free(a);
    fputs("mutate: out of memory\n", stderr);
    return 2;
  }
  arena_guard(a, &failed);
  int status = run(a, argv[argc - 1], verbose);
  arena_free(a);
  return status;
}
