/* cut_effects FILE: the names of the file's effects, one a line. cut_effects FILE EFFECT...: the file without the
 * text of these effects, cut by the parser's own spans, and without what others say of them: uses, requirements,
 * exclusions, values of theirs. */
#include <stdio.h>
#include <string.h>

#include "syntax/parse.h"

typedef struct {
  Ast *ast;
  char **names; /* of the effects to cut; NULL at the end */
  VEC(const AstStmt *) cuts;
} Cutter;

static int is_named(const Cutter *c, Name name) {
  for (char **n = c->names; *n; n++)
    if (strcmp(name, *n) == 0) return 1;
  return 0;
}

/* drag.c = 3, start drag.y = 1: whose is it? */
static Name owner_of(const Ast *ast, AstId id) {
  const AstExpr *x = ast_expr(ast, id);
  while (x->kind == AST_PRIME || x->kind == AST_INDEX ||
         (x->kind == AST_MEMBER && ast_expr(ast, x->a)->kind != AST_NAME))
    x = ast_expr(ast, x->a);
  return x->kind == AST_MEMBER ? ast_expr(ast, x->a)->name : NULL;
}

static int speaks_of(const Cutter *c, const AstStmt *s) {
  if (s->kind == STMT_USE || s->kind == STMT_REQUIRES || s->kind == STMT_EXCLUDES) return is_named(c, s->name);
  Name owner = s->kind == STMT_SET || s->kind == STMT_START ? owner_of(c->ast, s->lhs) : NULL;
  return owner && is_named(c, owner);
}

static void find_cuts(Cutter *c) {
  for (const AstStmt *s = c->ast->first; s; s = s->next) {
    if (s->kind != STMT_EFFECT && s->kind != STMT_SCENE) continue;
    if (s->kind == STMT_EFFECT && is_named(c, s->name)) {
      vec_push(c->ast->arena, &c->cuts, s);
      continue;
    }
    for (const AstStmt *x = s->body; x; x = x->next)
      if (speaks_of(c, x)) vec_push(c->ast->arena, &c->cuts, x);
  }
}

static int is_blank(char ch) { return ch == ' ' || ch == '\n'; }
static int is_letter(char ch) { return ch >= 'a' && ch <= 'z'; }

/* What stands alone in its statement takes the word before it along, what stands in a list its comma. */
static void write_rest(Cutter *c, const Source *source) {
  const char *text = source->text;
  char *out = arena_alloc(c->ast->arena, source->len + 1);
  size_t n = 0, from = 0;
  for (uint32_t i = 0; i < c->cuts.n; i++) {
    const AstStmt *s = c->cuts.at[i];
    size_t begin = s->span.begin - source->base, end = s->span.end - source->base, blanks = strspn(text + end, " ");
    for (; from < begin; from++) out[n++] = text[from];
    from = end;
    if (text[end + blanks] == ',') {
      from = end + blanks + 1;
      continue;
    }
    if (s->kind == STMT_EFFECT || s->kind == STMT_SET) continue;
    while (n && is_blank(out[n - 1])) n--;
    if (n && out[n - 1] == ',') n--;
    else
      while (n && is_letter(out[n - 1])) n--;
  }
  fwrite(out, 1, n, stdout);
  fputs(text + from, stdout);
}

static int run(Arena *a, int argc, char **argv) {
  const char *why;
  Sources *sources = sources_new(a);
  sources->library = "models/lib";
  Diags *diags = diags_new(a, sources);
  Ast *ast = ast_new(a, interner_new(a), sources, diags);
  const Source *source = source_read(sources, argv[1], &why);
  if (!source || !parse(ast, source)) return 1;
  if (argc > 2) {
    Cutter c = {.ast = ast, .names = argv + 2};
    find_cuts(&c);
    write_rest(&c, source);
  } else {
    for (const AstStmt *s = ast->first; s; s = s->next)
      if (s->kind == STMT_EFFECT) puts(s->name);
  }
  return 0;
}

int main(int argc, char **argv) {
  Arena *a = arena_new(NULL);
  jmp_buf failed;
  if (!a || argc < 2 || setjmp(failed)) {
    arena_free(a);
    fputs("usage: cut_effects FILE [EFFECT...]\n", stderr);
    return 2;
  }
  arena_guard(a, &failed);
  int status = run(a, argc, argv);
  arena_free(a);
  return status;
}
