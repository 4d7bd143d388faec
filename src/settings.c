#include "settings.h"

#include <string.h>

#include "cli/files.h"
#include "syntax/parse.h"

/* The declaration of `name`, or of `effect.name`, of that kind; NULL: there is none. */
static const AstStmt *find_declared(const Ast *ast, AstStmtKind kind, const char *name) {
  const char *dot = strchr(name, '.'), *stem = dot ? dot + 1 : name;
  for (const AstStmt *s = ast->first; s; s = s->next) {
    if (s->kind == kind && !dot && strcmp(s->name, name) == 0) return s;
    if (s->kind != STMT_EFFECT || (dot && (strlen(s->name) != (size_t)(dot - name) || strncmp(s->name, name, strlen(s->name)) != 0))) continue;
    for (const AstStmt *x = s->body; x; x = x->next)
      if (x->kind == kind && strcmp(x->name, stem) == 0) return x;
  }
  return NULL;
}

static int is_number(const char *text) { return *text && strspn(text, "+-.0123456789eE") == strlen(text); }

/* The expression `text`, which stands behind `name=`; 0 after a mistake. */
static AstId parse_setting(Ast *ast, const char *name, const char *text) {
  const Source *source = source_add(ast->sources, name, text, strlen(text));
  return source ? parse_expression(ast, source) : 0;
}

/* A shell takes quotes away: `u=gust.csv` is the file. */
static const char *quoted_file(Arena *a, const char *text) {
  size_t n = strlen(text);
  int named = n > 4 && strcmp(text + n - 4, ".csv") == 0;
  return text[0] != '"' && (named || file_exists(text)) ? arena_printf(a, "\"%s\"", text) : text;
}

static int take(Ast *ast, const char *setting, GivenList *given) {
  const char *eq = strchr(setting, '=');
  const char *name = arena_strndup(ast->arena, setting, (size_t)(eq - setting));
  const char *place = arena_strndup(ast->arena, setting, (size_t)(eq - setting) + 1); /* what messages point to: `u=` */
  Given one = {parse_setting(ast, place, name), parse_setting(ast, place, quoted_file(ast->arena, eq + 1))};
  vec_push(ast->arena, given, one);
  return one.what && one.value;
}

int settings_take(Ast *ast, Options *o, GivenList *given, const char **error) {
  uint32_t kept = 0;
  int ok = 1;
  for (uint32_t i = 0; i < o->rest.n; i++) {
    const char *arg = o->rest.at[i], *eq = arg[0] != '-' ? strchr(arg, '=') : NULL;
    const char *name = eq ? arena_strndup(ast->arena, arg, (size_t)(eq - arg)) : "";
    if (eq && find_declared(ast, STMT_CONST, name) && !find_declared(ast, STMT_PARAM, name)) {
      *error = arena_printf(ast->arena, "%s: `%s` is a constant, fixed when compiling: write -D %s", arg, name, arg);
      return 0;
    }
    if (eq && eq[1] && !is_number(eq + 1) && find_declared(ast, STMT_INPUT, name)) ok &= take(ast, arg, given);
    else o->rest.at[kept++] = arg;
  }
  o->rest.n = kept;
  return ok;
}
