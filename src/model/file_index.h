/* Index of a file's statements by name, made once: a file may have thousands of scenes, each compiled by itself. */
#ifndef LAGC_FILE_INDEX_H
#define LAGC_FILE_INDEX_H

#include "model/scope.h"
#include "syntax/ast.h"

typedef struct FileIndex {
  Scope scenes, effects;                   /* the first of each name: index into `named` */
  VEC(const AstStmt *) named;
  const AstStmt *model, *scene, *effect;   /* the first named statement of each kind, or NULL */
  VEC(const AstStmt *) common;             /* all statements but scenes, in the file's order */
  VEC(const AstStmt *) repeated;           /* scenes and effects whose name was declared before */
  int is_sound, clashes;                   /* names and effects were checked and are right; effects_check found an error */
} FileIndex;

FileIndex *file_index(Ast *ast);

/* The statement of a scene or effect by name (NULL: the first); the model statement; or NULL. */
const AstStmt *find_named(Ast *ast, AstStmtKind kind, const char *name);

#endif
