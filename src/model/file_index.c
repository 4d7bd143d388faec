/* Open-addressing hash table of a file's scenes and effects. Contract: file_index.h. */
#include "model/file_index.h"

#include "base/intern.h"

/* Slot of a name (interned: hashed by address), or the empty slot where it belongs. */
static const AstStmt **slot_of(const FileIndex *x, AstStmtKind kind, Name name) {
  uint32_t i = (uint32_t)(((uintptr_t)name >> 4) + kind) & (x->nslots - 1);
  while (x->slots[i] && (x->slots[i]->name != name || x->slots[i]->kind != kind)) i = (i + 1) & (x->nslots - 1);
  return &x->slots[i];
}

static void add(Ast *ast, FileIndex *x, const AstStmt *s) {
  const AstStmt **first = s->kind == STMT_MODEL ? &x->model : s->kind == STMT_SCENE ? &x->scene : s->kind == STMT_EFFECT ? &x->effect : NULL;
  if (s->kind != STMT_SCENE) vec_push(ast->arena, &x->common, s);
  if (!first || !s->name) return;
  if (!*first) *first = s;
  if (s->kind == STMT_MODEL) return;
  const AstStmt **slot = slot_of(x, s->kind, s->name);
  if (*slot) vec_push(ast->arena, &x->repeated, s);
  else *slot = s;
}

FileIndex *file_index(Ast *ast) {
  if (ast->index) return ast->index;
  FileIndex *x = ast->index = ARENA_NEW(ast->arena, FileIndex);
  uint32_t n = 0;
  for (const AstStmt *s = ast->first; s; s = s->next) n += s->kind == STMT_SCENE || s->kind == STMT_EFFECT;
  for (x->nslots = 16; x->nslots < 2 * n;) x->nslots *= 2;
  x->slots = ARENA_ARRAY(ast->arena, const AstStmt *, x->nslots);
  for (const AstStmt *s = ast->first; s; s = s->next) add(ast, x, s);
  return x;
}

const AstStmt *find_named(Ast *ast, AstStmtKind kind, const char *name) {
  const FileIndex *x = file_index(ast);
  if (!name) return kind == STMT_MODEL ? x->model : kind == STMT_SCENE ? x->scene : x->effect;
  return *slot_of(x, kind, intern(ast->names, name));
}
