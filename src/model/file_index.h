/* The statements of a file by name, made once: a file may have thousands of scenes, each of which is compiled. */
#ifndef LAGC_FILE_INDEX_H
#define LAGC_FILE_INDEX_H

#include "syntax/ast.h"

typedef struct FileIndex {
  uint32_t nslots;
  const AstStmt **slots;                   /* scenes and effects by kind and name, the first of each; a power of 2 */
  const AstStmt *model, *scene, *effect;   /* the first that has a name, or NULL */
  VEC(const AstStmt *) common;             /* all but scenes, in the file's order */
  VEC(const AstStmt *) repeated;           /* scenes and effects whose name another has */
  int is_sound, clashes;                   /* nothing was wrong with names and effects; effects do not go together (effects_check) */
} FileIndex;

FileIndex *file_index(Ast *ast);

/* The model's name, the scene or the effect of that name (NULL: the first), or NULL. */
const AstStmt *find_named(Ast *ast, AstStmtKind kind, const char *name);

#endif
