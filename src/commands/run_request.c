/* Parses the expressions of --observe, --measure, --section, plot and animate, finds the points of an animation, and
 * writes the simulator's argv. */
#include "commands/run_request.h"

#include <stdio.h>
#include <string.h>

#include "base/source.h"
#include "base/words.h"
#include "commands/command_table.h"
#include "syntax/parse.h"

typedef struct {
  RunRequest *p;
  Ast *ast;
  const Options *o;
  Arena *arena;
} RequestBuilder;

/* The name of a column, cut to the length that a simulator keeps. */
static const char *column_name(RequestBuilder *k, const char *text) {
  enum { LONGEST = 90, SHOWN = 76 };
  size_t n = strlen(text), cut = SHOWN;
  if (n <= LONGEST) return text;
  while (cut && ((unsigned char)text[cut] & 0xC0) == 0x80) cut--;
  return arena_printf(k->arena, "%.*s...#%u", (int)cut, text, k->p->asked.n + 1);
}

/* Adds an expression to the outputs and returns the name of its column; NULL after a mistake. from: the option that
 * holds the expression. */
static const char *add_output(RequestBuilder *k, const char *from, const char *text) {
  text = text_trimmed(k->arena, text, strlen(text));
  if (strcmp(text, "t") == 0) return text; /* every table begins with the time */
  const Source *source = source_add(k->ast->sources, from, text, strlen(text));
  CommandOutput asked = {source ? parse_expression(k->ast, source) : 0, intern(k->ast->names, column_name(k, text))};
  if (!asked.expr) return NULL;
  vec_push(k->arena, &k->p->asked, asked);
  return asked.name;
}

static void add_argument(RequestBuilder *k, const char *option, const char *value) {
  vec_push(k->arena, &k->p->argv, arena_strdup(k->arena, option));
  if (value) vec_push(k->arena, &k->p->argv, arena_strdup(k->arena, value));
}

/* The file of -o, or MODEL_SCENE.suffix, with all scenes that are named. */
static const char *file_name(RequestBuilder *k, const char *suffix) {
  if (k->o->output) return k->o->output;
  const char *model = "model";
  for (const AstStmt *s = k->ast->first; s; s = s->next)
    if (s->kind == STMT_MODEL && s->name) model = s->name;
  StrBuf name = strbuf(k->arena);
  SceneList scenes = k->p->scenes.n ? k->p->scenes : (SceneList){model_scenes(k->ast).at, 1};
  sb_puts(&name, model);
  for (uint32_t i = 0; i < scenes.n; i++) sb_printf(&name, "_%s", scenes.at[i]);
  sb_printf(&name, ".%s", suffix);
  return sb_text(&name);
}

/* The statement outside effects that declares `name` as a number or a family of numbers; NULL: none. */
static const AstStmt *find_quantity(const Ast *ast, const char *name) {
  for (const AstStmt *s = ast->first; s; s = s->next) {
    int counts = s->kind == STMT_COORD || s->kind == STMT_STATE || s->kind == STMT_LET || s->kind == STMT_OBSERVE;
    if (counts && s->name && !s->type && strcmp(s->name, name) == 0) return s;
  }
  return NULL;
}

/* --- sections --- */

/* The direction that the last word names; *n: length of the text before that word. -1: no direction. */
static int section_direction(const char *text, size_t *n) {
  static const char *const words[] = {
      [CROSS_BOTH] = "crossing", [CROSS_RISING] = "rising", [CROSS_FALLING] = "falling"};
  const char *space = strrchr(text, ' ');
  for (int k = 0; space && k < (int)(sizeof words / sizeof *words); k++) {
    if (strcmp(space + 1, words[k]) != 0) continue;
    *n = (size_t)(space - text);
    return k;
  }
  return -1;
}

typedef VEC(Name) Names;

/* Adds the names of events and kicks, also of effects. */
static void list_events(Arena *a, const AstStmt *first, Names *names) {
  for (const AstStmt *s = first; s; s = s->next) {
    if (s->kind == STMT_EVENT && !s->dims) vec_push(a, names, s->name);
    if (s->kind == STMT_EFFECT) list_events(a, s->body, names);
  }
}

/* A section without a direction: the nearest event or kick, unless it is a quantity of the model. 0 with *error. */
static int refuse_section(RequestBuilder *k, const char *text, Names events, const char **error) {
  Name near = find_quantity(k->ast, text) ? NULL : suggest(text, events.at, events.n);
  if (near)
    return fail_with(error, arena_printf(k->arena, "--section %s: there is no event or kick `%s`; did you mean `%s`?",
                                         text, text, near));
  const char *last = strrchr(text, ' '), *of = last ? arena_strndup(k->arena, text, (size_t)(last - text)) : text;
  int other = last && find_quantity(k->ast, of); /* x sideways */
  return fail_with(
      error,
      arena_printf(k->arena, "--section %s: %s; write --section '%s rising', falling or crossing (both)", text,
                   other ? arena_printf(k->arena, "`%s` is no direction", last + 1) : "a direction is missing",
                   other ? of : text));
}

/* --section 'EXPR rising' becomes an event of the model, at which the simulator writes rows; the name of an event or
 * a kick is passed on. */
static int prepare_section(RequestBuilder *k, const char **error) {
  const char *text = k->o->section;
  size_t n = 0;
  if (!text) return 1;
  text = text_trimmed(k->arena, text, strlen(text));
  Names events = {0};
  list_events(k->arena, k->ast->first, &events);
  for (uint32_t i = 0; i < events.n; i++) {
    if (strcmp(events.at[i], text) != 0) continue;
    add_argument(k, "--section", text);
    return 1;
  }
  int direction = section_direction(text, &n);
  if (direction < 0) return refuse_section(k, text, events, error);
  const Source *source = source_add(k->ast->sources, "--section", text, n);
  k->p->section =
      (Section){source ? parse_expression(k->ast, source) : 0, (AstDirection)direction, intern(k->ast->names, text)};
  if (!k->p->section.expr) return 0;
  add_argument(k, "--section", text);
  return 1;
}

/* --- measures --- */

/* The expression of NAME=EXPR, or of EXPR, whose name is its text; T^(2/3)=... has a name, x(t=2) has none. */
static const char *split_name(const char *text, size_t *name_length) {
  const char *equals = NULL;
  int depth = 0;
  for (const char *c = text; *c && !equals; c++) {
    depth += (*c == '(') - (*c == ')');
    if (*c == '=' && depth == 0) equals = c;
  }
  *name_length = equals ? (size_t)(equals - text) : strlen(text);
  while (*name_length && text[*name_length - 1] == ' ') --*name_length;
  return equals ? equals + 1 : text;
}

/* The expression, in which a quoted name of an output is its text in parentheses. */
static const char *without_quotes(Arena *a, const char *text) {
  char *s = arena_strdup(a, text);
  int open = 0;
  for (char *c = s; *c; c++)
    if (*c == '"') *c = (open = !open) ? '(' : ')';
  return s;
}

static int prepare_measures(RequestBuilder *k, const OptionTexts *list, const char *option, const char **error) {
  for (uint32_t i = 0; i < list->n; i++) {
    size_t n;
    const char *given = list->at[i], *text = without_quotes(k->arena, split_name(given, &n));
    if (!*given) return fail_with(error, arena_printf(k->arena, "%s needs a value: %s EXPR", option, option));
    if (!n) return fail_with(error, arena_printf(k->arena, "%s %s: a name is missing before `=`", option, given));
    CommandOutput asked = {.name = intern_n(k->ast->names, given, n)};
    const Source *source = source_add(k->ast->sources, option, text, strlen(text));
    if (!source || !(asked.expr = parse_expression(k->ast, source))) return 0;
    vec_push(k->arena, &k->p->measures, asked);
  }
  return 1;
}

/* --- plot --- */

/* The text of the time derivative: name', or (expression)'. */
static const char *derivative_text(RequestBuilder *k, const char *text) {
  int plain = 1;
  for (const char *c = text; *c; c++)
    if (strchr(" +-*/^()[]<>=,", *c)) plain = 0;
  return arena_printf(k->arena, plain ? "%s'" : "(%s)'", text);
}

/* The momentum of the coordinate in a model that gives its Hamiltonian; NULL: the model gives its Lagrangian. */
static const char *momentum_of(const Ast *ast, const char *coordinate) {
  const char *momentum = NULL;
  for (const AstStmt *s = ast->first; s; s = s->next) {
    if (s->kind == STMT_LAGRANGIAN || s->kind == STMT_KINETIC || s->kind == STMT_POTENTIAL) return NULL;
    if (s->kind == STMT_MOMENTUM && ast_expr(ast, s->lhs)->name == coordinate) momentum = s->name;
  }
  return momentum;
}

/* The only coordinate of the model, *second its momentum or NULL; or, for --portrait, its only two. NULL: it has
 * others, which *error says. */
static const char *only_coordinate(RequestBuilder *k, const char *option, const char **second, const char **error) {
  const AstStmt *found[2] = {NULL, NULL};
  uint32_t n = 0;
  for (const AstStmt *s = k->ast->first; s; s = s->next) {
    if (s->kind != STMT_COORD) continue;
    if (n < 2 && s->name && !s->dims && !s->type) found[n] = s;
    n++;
  }
  *second = NULL;
  if (n == 1 && found[0]) *second = momentum_of(k->ast, found[0]->name);
  if (n == 2 && found[0] && found[1] && k->o->portrait) *second = found[1]->name;
  if ((n == 1 || *second) && found[0]) return found[0]->name;
  *error = arena_printf(k->arena, "%s needs a model with one coordinate%s; --x and --y draw any expressions", option,
                        k->o->portrait ? ", or with two of first order" : "");
  return NULL;
}

/* --y of a sweep: what its section draws. */
static int prepare_sweep(RequestBuilder *k, const char **error) {
  add_argument(k, "--sweep", NULL);
  if (k->o->y.n > 1 || (k->o->y.n && !k->o->section))
    return fail_with(error, "--y EXPR is one expression, which --section draws over the values");
  const char *drawn = k->o->y.n ? add_output(k, "--y", k->o->y.at[0]) : NULL;
  if (drawn) add_argument(k, "--plot-y", drawn);
  return !k->o->y.n || drawn;
}

static int prepare_plot(RequestBuilder *k, const char **error) {
  const Options *o = k->o;
  const char *x = o->phase ? o->phase : o->x,
             *y = o->phase ? derivative_text(k, o->phase)
                  : o->y.n ? o->y.at[0]
                           : NULL,
             *second;
  if (o->energy_error && !x && !y) y = "energy";
  else if (o->energy_error) *error = "--energy-error chooses the axes; leave out --x, --y and --phase";
  else if (o->distance && x) *error = "--distance is over time; leave out --x and --phase";
  if (o->cloud && o->phase) *error = "--cloud draws the coordinate and its momentum, or --x and --y; leave out --phase";
  else if (o->cloud && !x && !y && (x = only_coordinate(k, "--cloud", &second, error)))
    y = second ? second : arena_printf(k->arena, "p_%s", x);
  for (uint32_t i = 0; i < o->rest.n; i++)
    if (strncmp(o->rest.at[i], "--drawing", strlen("--drawing")) == 0) k->p->drawing = 1;
  if (o->cloud) add_argument(k, "--cloud", o->cloud);
  if (o->energy_error) add_argument(k, "--energy-error", NULL);
  if (o->distance) add_argument(k, "--distance", NULL);
  const char *beneath = o->portrait ? "--portrait" : o->potential ? "--potential" : NULL;
  if (*error) return 0;
  if (o->portrait && o->potential) *error = "--portrait and --potential are two pictures; leave one of them out";
  else if (beneath && (x || y))
    *error = arena_printf(k->arena, "%s chooses the axes; leave out --x, --y and --phase", beneath);
  else if (o->phase && (o->x || o->y.n))
    *error = "--phase EXPR draws the rate of EXPR against it; leave out --x and --y";
  else if (beneath && (x = only_coordinate(k, beneath, &second, error))) {
    y = o->potential ? "energy" : second ? second : derivative_text(k, x);
    add_argument(k, beneath, NULL);
  } else if (x && !y) *error = arena_printf(k->arena, "--x %s: the other axis is missing; add --y EXPR", x);
  if (*error) return 0;
  if (!options_passed(o, "--svg")) add_argument(k, "--svg", file_name(k, "svg"));
  if (x && !(x = add_output(k, o->phase ? "--phase" : "--x", x))) return 0;
  if (y && !(y = add_output(k, o->phase ? "--phase" : "--y", y))) return 0;
  if (x) add_argument(k, "--plot-x", x);
  if (y) add_argument(k, "--plot-y", y);
  for (uint32_t i = 1; i < o->y.n; i++) {
    if (!(y = add_output(k, "--y", o->y.at[i]))) return 0;
    add_argument(k, "--plot-y", y);
  }
  return 1;
}

/* --- lists of points --- */

typedef struct {
  const char *x, *y; /* one line, spaces collapsed */
} PointText;

typedef VEC(PointText) PointTexts;

static int is_blank(char c) { return c && strchr(" \t\r\n", c); }

/* Whether the white space at s, after the character `before`, separates two expressions. */
static int separates(char before, const char *s) {
  s += strspn(s, " \t\r\n");
  if (*s == '\0' || *s == ';' || strchr("+-*/^(,<>=", before)) return 0;
  if (*s == '+' || *s == '-') return !is_blank(s[1]); /* "a -b" is two, "a - b" one */
  return !strchr("*/^),<>=[", *s);
}

/* The end of the point that begins at s; *comma is its first comma outside of brackets, or NULL. */
static const char *point_end(const char *s, const char **comma) {
  int depth = 0;
  char before = ',';
  *comma = NULL;
  for (; *s && (*s != ';' || depth); s++) {
    if (*s == '(' || *s == '[' || *s == '{') depth++;
    if (*s == ')' || *s == ']' || *s == '}') depth--;
    if (*s == ',' && depth == 0) {
      if (*comma) return s;
      *comma = s;
    }
    if (is_blank(*s) && depth == 0 && *comma && separates(before, s)) return s;
    if (!is_blank(*s)) before = *s;
  }
  return s;
}

/* Splits "x1,y1 x2,y2" or "x1, y1; x2, y2" into the texts of each point. After its comma a point ends at a space
 * that no operator touches (a sign may follow it). Returns 0, with *error, where a point has not two parts. */
static int points_split(Arena *a, const char *text, PointTexts *points, const char **error) {
  for (const char *s = text;;) {
    s += strspn(s, "; \t\r\n");
    if (!*s) break;
    const char *comma, *end = point_end(s, &comma);
    if (!comma || *end == ',')
      return fail_with(error, arena_printf(a, "\"%s\": each point is x,y, for example 'x1,y1 x2,y2'", text));
    PointText p = {text_trimmed(a, s, (size_t)(comma - s)), text_trimmed(a, comma + 1, (size_t)(end - comma - 1))};
    if (!p.x[0] || !p.y[0]) return fail_with(error, arena_printf(a, "\"%s\": a point lacks x or y", text));
    vec_push(a, points, p);
    s = end;
  }
  if (points->n) return 1;
  return fail_with(error, "no point is given; write for example 'x1,y1 x2,y2'");
}

/* --- animate --- */

/* Makes each part of "x1,y1 x2,y2" an output of the scene and returns the names of the columns, written likewise;
 * NULL after a mistake. */
static const char *add_points(RequestBuilder *k, const char *from, const char *text, uint32_t most,
                              const char **error) {
  PointTexts points = {0};
  const char *why = NULL;
  if (!points_split(k->arena, text, &points, &why) || points.n > most) {
    *error = arena_printf(k->arena, "%s %s", from, why ? why : "takes one point: x,y");
    return NULL;
  }
  StrBuf out = strbuf(k->arena);
  int ok = 1;
  for (uint32_t i = 0; i < points.n; i++) {
    const char *x = add_output(k, from, points.at[i].x), *y = add_output(k, from, points.at[i].y);
    if (x && y) sb_printf(&out, "%s%s,%s", i ? " " : "", x, y);
    else ok = 0;
  }
  return ok ? sb_text(&out) : NULL;
}

/* Points of the command line, or the drawing of the model. */
static int prepare_animate(RequestBuilder *k, const char **error) {
  const Options *o = k->o;
  k->p->drawing = !o->points;
  add_argument(k, "--html", file_name(k, "html"));
  if (!o->points && (o->from || o->no_rods))
    return fail_with(error, arena_printf(k->arena, "%s needs --points 'X,Y X,Y'; the model's `draw` statements say "
                                         "what else is drawn", o->from ? "--from" : "--no-rods"));
  if (!o->points) return 1;
  const char *points = add_points(k, "--points", o->points, UINT32_MAX, error), *from = NULL;
  if (!points || (o->from && !o->no_rods && !(from = add_points(k, "--from", o->from, 1, error)))) return 0;
  add_argument(k, "--points", points);
  if (from) add_argument(k, "--from", from);
  if (o->no_rods) add_argument(k, "--no-rods", NULL);
  return 1;
}

/* --- columns of data --- */

/* Length of the field of a CSV line at s, and its text without quotes and blanks around it. */
static size_t csv_field(Arena *a, const char *s, const char **text) {
  size_t n = 0;
  for (int quoted = 0; s[n] && !strchr("\r\n", s[n]) && (s[n] != ',' || quoted); n++) quoted ^= s[n] == '"';
  const char *trimmed = text_trimmed(a, s, n);
  size_t length = strlen(trimmed);
  int in_quotes = length > 1 && trimmed[0] == '"' && trimmed[length - 1] == '"';
  *text = in_quotes ? arena_strndup(a, trimmed + 1, length - 2) : trimmed;
  return n;
}

/* Whether --columns names the column, or is not given. */
static int is_column_asked(const Options *o, const char *label, size_t length) {
  const char *list = options_passed(o, "--columns");
  if (!list) return 1;
  while (*list) {
    size_t n = strcspn(list, ",");
    if (n == length && memcmp(list, label, n) == 0) return 1;
    list += n + (list[n] == ',');
  }
  return 0;
}

/* Makes the column an output called by its label: a number in its unit, or the quantity in its own where the label has
 * none. The difference has both in one unit, which the compiler checks. */
static int add_column(RequestBuilder *k, const char *label, int is_time) {
  const char *unit = strstr(label, " [");
  size_t n = unit ? (size_t)(unit - label) : strlen(label);
  const char *name = is_time ? "1 [s]" : arena_strndup(k->arena, label, n), *text = name;
  if (strncmp(label, "sigma(", 6) == 0 || (!is_time && !is_column_asked(k->o, label, n))) return 1;
  if (unit && strcmp(unit, " [degC]") == 0) text = arena_printf(k->arena, "(%s - 0 [degC])/(1 [K])", name);
  else if (unit) text = arena_printf(k->arena, "(%s - 1%s + 1%s)/(1%s)", name, unit, unit, unit);
  const Source *source =
      source_add(k->ast->sources, arena_printf(k->arena, "--data, column %s", label), text, strlen(text));
  CommandOutput asked = {source ? parse_expression(k->ast, source) : 0, intern(k->ast->names, label)};
  if (!asked.expr) return 0;
  vec_push(k->arena, &k->p->asked, asked);
  return 1;
}

const char *data_head(Arena *a, const char *path, const char **why) {
  enum { LONGEST = 1 << 16 };
  FILE *f = source_open(path, why);
  if (!f && strchr(path, ',')) f = source_open(arena_strndup(a, path, strcspn(path, ",")), why); /* of several */
  if (!f) return NULL;
  char *line = arena_alloc(a, LONGEST), *at;
  do at = fgets(line, LONGEST, f); /* comments and blank lines do not count */
  while (at && (line[strspn(line, " \t")] == '#' || !line[strspn(line, " \t\r\n")]));
  fclose(f);
  if (!at) *why = "the file is empty";
  return at;
}

/* Whether a comma has cut a name in two: it has more `(` than `)`. */
static int is_cut_in_parentheses(const char *label) {
  int open = 0;
  for (; *label; label++) open += *label == '(' ? 1 : *label == ')' ? -1 : 0;
  return open > 0;
}

/* Columns of --data, by the first line of the file. */
static int prepare_columns(RequestBuilder *k, const char **error) {
  const char *path = options_passed(k->o, "--data"), *why = NULL, *label;
  if (!path || !options_passed(k->o, "--fit"))
    return fail_with(error, "lagc fit needs the record and what to find: --data motion.csv --fit g,l");
  const char *at = data_head(k->arena, path, &why);
  if (!at) return fail_with(error, arena_printf(k->arena, "--data %s cannot be read: %s", path, why));
  if (strncmp(at, "\xEF\xBB\xBF", 3) == 0) at += 3;
  for (int column = 0, ok = 1;; column++) {
    const char *field = at, *separator;
    at += csv_field(k->arena, at, &label);
    separator = strpbrk(field, ";\t");
    if (column == 0 && *at != ',' && separator && separator < at)
      return fail_with(error, arena_printf(k->arena, "--data %s: the names in the first line, `%s`, have no commas "
                                                     "between them; CSV with commas is read", path, label));
    if (!*label)
      return fail_with(error, arena_printf(k->arena, "--data %s: column %d has no name; write one with its unit, or "
                                                     "take the column and its comma away", path, column + 1));
    if (is_cut_in_parentheses(label))
      return fail_with(error, arena_printf(k->arena, "--data %s: the name `%s` ends within parentheses; a name with a "
                                                     "comma stands in quotes: \"hypot(x, y) [m]\"", path, label));
    int is_time = column == 0 && strncmp(label, "t [", 3) == 0 && strcmp(label, "t [s]") != 0;
    /* the simulator refuses a first line without names */
    if ((column || is_time) && !text_is_number(label)) ok = add_column(k, label, is_time);
    if (!ok) return 0;
    if (*at++ != ',') return 1;
  }
}

int run_request_prepare(RunRequest *p, Ast *ast, const Options *o, const char **error) {
  RequestBuilder k = {p, ast, o, ast->arena};
  int ok = 1;
  Name *scenes = ARENA_ARRAY(ast->arena, Name, o->scenes.n + 1);
  for (uint32_t i = 0; i < o->scenes.n; i++) scenes[i] = intern(ast->names, o->scenes.at[i]);
  p->scenes = (SceneList){scenes, o->scenes.n};
  p->scene = o->scene ? scenes[0] : NULL;
  /* head of the simulator's messages */
  const char *name = command_find(o->command)->name;
  add_argument(&k, arena_printf(k.arena, "lagc %s", name), NULL);
  if (o->command == CMD_EFFECTS) add_argument(&k, "--effects", "report");
  for (uint32_t i = 0; i < o->observe.n; i++) ok &= add_output(&k, "--observe", o->observe.at[i]) != NULL;
  ok = ok && prepare_section(&k, error) && prepare_measures(&k, &o->measure, "--measure", error) &&
       prepare_measures(&k, &o->gradient, "--gradient", error);
  if (o->gradient.n) add_argument(&k, "--gradient", NULL);
  if (o->command == CMD_PLOT) ok = ok && prepare_plot(&k, error);
  if (o->command == CMD_ANIMATE) ok = ok && prepare_animate(&k, error);
  if (has_word("modes design linearize orbit continue lyapunov cost", name))
    add_argument(&k, arena_printf(k.arena, "--%s", name), NULL);
  if (o->by_effects && o->scenes.n > 1) return fail_with(error, "--effects: name one scene, whose effects are judged");
  if (o->by_effects) add_argument(&k, "--each-effect", NULL);
  if (o->command == CMD_FIT) ok = ok && prepare_columns(&k, error);
  if (o->command == CMD_SWEEP) ok = ok && prepare_sweep(&k, error);
  if (o->command == CMD_COST && o->error) {
    p->error = strcmp(o->error, "final") == 0 || strcmp(o->error, "residual") == 0
                   ? o->error
                   : add_output(&k, "--error", o->error);
    ok = ok && p->error;
    if (p->error) add_argument(&k, "--error", p->error);
  }
  for (uint32_t i = 0; i < o->rest.n; i++) add_argument(&k, o->rest.at[i], NULL);
  vec_push(k.arena, &p->argv, NULL);
  return ok;
}
