/* Warnings about parameters, lets, inputs and functions of the model's main file that no expression uses, and about
 * names that hide the model's energy or L.
 *
 * In: a parsed Ast without errors, with the expressions of the command line. Names are not resolved: any occurrence
 * in an expression, active or not, counts as a use; the left side of a scene's assignment does not. */
#include <string.h>

#include "model/model.h"
#include "model/scope.h"

/* Marks left sides of a scene's assignments: `m[2] = 1` is not a use of m. */
static void skip_settings(const Ast *ast, const AstStmt *list, uint8_t *skip) {
  for (const AstStmt *s = list; s; s = s->next) {
    if (s->kind == STMT_USE) skip_settings(ast, s->body, skip);
    for (AstId id = s->kind == STMT_SET ? s->lhs : 0; id; id = ast_expr(ast, id)->a) skip[id] = 1;
  }
}

static Scope used_names(const Ast *ast) {
  Scope used = {.arena = ast->arena};
  uint8_t *skip = ARENA_ARRAY(ast->arena, uint8_t, ast->exprs.n);
  for (const AstStmt *s = ast->first; s; s = s->next)
    if (s->kind == STMT_SCENE) skip_settings(ast, s->body, skip);
  for (AstId id = 1; id < ast->exprs.n; id++) {
    const AstExpr *x = ast_expr(ast, id);
    if (skip[id] || (x->kind != AST_NAME && x->kind != AST_CALL && x->kind != AST_MEMBER)) continue;
    if (!scope_own(&used, x->name, NULL)) scope_add(&used, (Entity){.name = x->name});
  }
  return used;
}

/* x, y, x1, y1, px, py: `lagc animate` draws points of these names. */
static int is_drawn(const char *name) {
  const char *rest = name + (name[0] == 'p');
  if (*rest != 'x' && *rest != 'y') return 0;
  return !rest[1] || (rest == name && strspn(rest + 1, "0123456789") == strlen(rest + 1));
}

static int can_be_unused(const AstStmt *s) {
  return s->name && (s->kind == STMT_PARAM || s->kind == STMT_INPUT || s->kind == STMT_FUNCTION ||
                     (s->kind == STMT_LET && !is_drawn(s->name)));
}

static void warn_list(Ast *ast, const Scope *used, const AstStmt *list) {
  for (const AstStmt *s = list; s; s = s->next) {
    if (s->kind == STMT_EFFECT) warn_list(ast, used, s->body);
    if (!can_be_unused(s) || scope_own(used, s->name, NULL) ||
        source_place(ast->sources, s->name_span.begin).file != ast->sources->files.at)
      continue;
    const char *what = s->kind == STMT_PARAM      ? "parameter"
                       : s->kind == STMT_INPUT    ? "input"
                       : s->kind == STMT_FUNCTION ? "function"
                                                  : "let";
    diag_warning(ast->diags, s->name_span, "nothing uses the %s `%s`", what, s->name);
    if (s->kind == STMT_LET) diag_help(ast->diags, "remove it, or show it: `output %s`", s->name);
    else diag_help(ast->diags, "use it in a formula, or remove it");
  }
}

static int gives_energy(const AstStmt *list) {
  for (const AstStmt *s = list; s; s = s->next)
    if (s->kind == STMT_LAGRANGIAN || s->kind == STMT_KINETIC || s->kind == STMT_HAMILTONIAN) return 1;
  return 0;
}

/* Names that take the place of the model's own `energy` and `lagrangian` in outputs and measures. */
static void warn_hidden(Ast *ast, const AstStmt *list) {
  for (const AstStmt *s = list; s; s = s->next) {
    int named = s->kind == STMT_PARAM || s->kind == STMT_CONST || s->kind == STMT_INPUT || s->kind == STMT_LET ||
                s->kind == STMT_OBSERVE || s->kind == STMT_FUNCTION;
    if (s->kind == STMT_EFFECT) warn_hidden(ast, s->body);
    if (!named || !s->name || (strcmp(s->name, "energy") != 0 && strcmp(s->name, "lagrangian") != 0)) continue;
    diag_warning(ast->diags, s->name_span, "`%s` hides the model's own %s in outputs, measures and expectations",
                 s->name, s->name);
    diag_help(ast->diags, "call it `my_%s`, or leave it out: `output %s` needs no declaration", s->name, s->name);
  }
}

void model_warn_unused(Ast *ast) {
  Scope used = used_names(ast);
  warn_list(ast, &used, ast->first);
  if (gives_energy(ast->first)) warn_hidden(ast, ast->first);
}
