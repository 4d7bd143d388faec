/* Index of a file's scenes and effects. Contract: builder.h. */
#include "model/builder.h"
#include "syntax/parse.h"

static void add(Ast *ast, FileIndex *x, const AstStmt *s) {
  const AstStmt **first = s->kind == STMT_MODEL    ? &x->model
                          : s->kind == STMT_SCENE  ? &x->scene
                          : s->kind == STMT_EFFECT ? &x->effect
                                                   : NULL;
  if (s->kind != STMT_SCENE) vec_push(ast->arena, &x->common, s);
  if (!first || !s->name) return;
  if (!*first) *first = s;
  if (s->kind == STMT_MODEL) return;
  if (find_named(ast, s->kind, s->name)) {
    vec_push(ast->arena, &x->repeated, s);
    return;
  }
  scope_add(s->kind == STMT_SCENE ? &x->scenes : &x->effects, (Entity){.name = s->name, .index = x->named.n});
  vec_push(ast->arena, &x->named, s);
}

FileIndex *file_index(Ast *ast) {
  if (ast->index) return ast->index;
  FileIndex *x = ast->index = ARENA_NEW(ast->arena, FileIndex);
  x->scenes.arena = x->effects.arena = ast->arena;
  for (const AstStmt *s = ast->first; s; s = s->next) add(ast, x, s);
  return x;
}

void note_composed(Ast *ast) {
  const AstStmt *first = parse_composed(ast);
  AstId id = ast->noted ? ast->noted : 1;
  for (; id < ast->exprs.n; id++) {
    const AstExpr *x = ast_expr(ast, id);
    for (const AstStmt *s = x->kind == AST_CALL ? first : NULL; s; s = s->next) {
      uint32_t k = 0;
      while (k < ast->called.n && ast->called.at[k] != s) k++;
      if (s->name == x->name && k == ast->called.n) vec_push(ast->arena, &ast->called, s);
    }
  }
  ast->noted = id;
}

void model_prepare(Ast *ast) {
  file_index(ast);
  note_composed(ast);
}

const AstStmt *find_named(Ast *ast, AstStmtKind kind, const char *name) {
  const FileIndex *x = file_index(ast);
  if (!name) return kind == STMT_MODEL ? x->model : kind == STMT_SCENE ? x->scene : x->effect;
  const Entity *e = scope_own(kind == STMT_SCENE ? &x->scenes : &x->effects, intern(ast->names, name), NULL);
  return e ? x->named.at[e->index] : NULL;
}
