#include "settings.h"

#include <string.h>

#include "cli/points.h"
#include "syntax/parse.h"

typedef struct {
  Options *o;
  Ast *ast;
  Arena *arena;
  Model *model; /* made for the first value that needs it */
} Converter;

/* A plain number is the simulator's business, and so is whatever else it may read, such as a file. */
static int needs_conversion(const char *value) {
  size_t n = strlen(value);
  if (strspn(value, "+-.0123456789eE") == n) return 0;
  return strchr(value, '[') || strspn(value, "+-*/^.0123456789eE() pi") == n;
}

static AstId parse_text(Converter *c, const char *from, const char *text) {
  const Source *source = source_add(c->ast->sources, from, text, strlen(text));
  return source ? parse_expression(c->ast, source) : 0;
}

/* The value as a simulator takes it; NULL after a mistake. `name` is NULL for a time. */
static const char *converted(Converter *c, const char *name, const char *value) {
  enum { ROOM = 32 };
  if (!c->model) {
    ModelChoice choice = {.scene = c->o->scene, .defines = c->o->defines.at, .ndefines = c->o->defines.n};
    c->model = model_build(c->ast, &choice);
  }
  if (!c->model) return NULL;
  AstId target = name ? parse_text(c, "command line", name) : 0, id = parse_text(c, "command line", value);
  double x;
  if ((name && !target) || !id || !model_setting(c->model, target, id, &x)) return NULL;
  char *text = arena_alloc(c->arena, ROOM);
  num_format_double(text, x);
  return text;
}

/* name=value: without spaces around either. */
static int convert_setting(Converter *c, const char **arg) {
  const char *eq = strchr(*arg, '=');
  const char *name = text_trimmed(c->arena, *arg, (size_t)(eq - *arg)), *value = text_trimmed(c->arena, eq + 1, strlen(eq + 1));
  if (needs_conversion(value) && !(value = converted(c, name, value))) return 0;
  *arg = arena_printf(c->arena, "%s=%s", name, value);
  return 1;
}

/* --until 2[min], --until=2[min]. */
static int convert_time(Converter *c, uint32_t *i) {
  static const char *const options[] = {"--until", "--every", "--step"};
  const char **at = c->o->rest.at;
  for (size_t k = 0; k < sizeof options / sizeof *options; k++) {
    size_t n = strlen(options[k]);
    if (strncmp(at[*i], options[k], n) != 0 || (at[*i][n] != '=' && at[*i][n])) continue;
    int joined = at[*i][n] == '=';
    if (!joined && *i + 1 == c->o->rest.n) return 1;
    const char *value = joined ? at[*i] + n + 1 : at[++*i];
    if (!needs_conversion(value)) return 1;
    if (!(value = converted(c, NULL, value))) return 0;
    at[*i] = joined ? arena_printf(c->arena, "%s=%s", options[k], value) : value;
  }
  return 1;
}

int settings_convert(Options *o, Ast *ast) {
  Converter c = {.o = o, .ast = ast, .arena = ast->arena};
  int ok = 1;
  for (uint32_t i = 0; i < o->rest.n; i++) {
    if (o->rest.at[i][0] == '-') ok &= convert_time(&c, &i);
    else if (strchr(o->rest.at[i], '=')) ok &= convert_setting(&c, &o->rest.at[i]);
  }
  return ok;
}
