/* Values on the command line: parses -D, compiles in inputs and starts of rotations, converts units and formulas to
 * plain numbers. */
#include "commands/run_request.h"

#include <string.h>

#include "base/words.h"
#include "commands/command_table.h"
#include "commands/const_ranges.h"
#include "commands/range.h"
#include "toolchain/files.h"
#include "syntax/parse.h"

const char *text_trimmed(Arena *a, const char *text, size_t n) {
  char *out = arena_alloc(a, n + 1);
  size_t k = 0;
  for (size_t i = 0; i < n; i++)
    if (!is_space(text[i])) out[k++] = text[i];
    else if (k && out[k - 1] != ' ') out[k++] = ' ';
  out[k - (k && out[k - 1] == ' ')] = '\0';
  return out;
}

/* --- inputs with a formula or a table --- */

/* The declaration of `name`, or of `effect.name`, with this kind; NULL: none. */
static const AstStmt *find_declared(const Ast *ast, AstStmtKind kind, const char *name) {
  const char *dot = strchr(name, '.'), *stem = dot ? dot + 1 : name;
  for (const AstStmt *s = ast->first; s; s = s->next) {
    if (s->kind == kind && !dot && strcmp(s->name, name) == 0) return s;
    if (s->kind != STMT_EFFECT ||
        (dot && (strlen(s->name) != (size_t)(dot - name) || strncmp(s->name, name, strlen(s->name)) != 0)))
      continue;
    for (const AstStmt *x = s->body; x; x = x->next)
      if (x->kind == kind && strcmp(x->name, stem) == 0) return x;
  }
  return NULL;
}

int text_is_number(const char *text) { return *text && strspn(text, "+-.0123456789eE") == strlen(text); }

/* Parses the expression after `name=`; 0 after a mistake. */
static AstId parse_setting(Ast *ast, const char *name, const char *text) {
  const Source *source = source_add(ast->sources, name, text, strlen(text));
  return source ? parse_expression(ast, source) : 0;
}

/* Puts back the quotes around a file's name, which the shell removed: `u=gust.csv` names a file. */
static const char *quoted_file(Arena *a, const char *text) {
  size_t n = strlen(text);
  int named = n > 4 && strcmp(text + n - 4, ".csv") == 0;
  return text[0] != '"' && (named || file_exists(text)) ? arena_printf(a, "\"%s\"", text) : text;
}

int settings_defines(Ast *ast, Define *defines, uint32_t n) {
  int ok = 1;
  for (uint32_t i = 0; i < n; i++) {
    Define *d = &defines[i];
    if (!d->expr) d->expr = parse_setting(ast, arena_printf(ast->arena, "-D %s", d->name), d->value);
    ok &= d->expr != 0;
  }
  return ok;
}

static int take_setting(Ast *ast, const char *setting, GivenList *given) {
  const char *eq = strchr(setting, '=');
  const char *name = arena_strndup(ast->arena, setting, (size_t)(eq - setting));
  const char *place = arena_strndup(ast->arena, setting, (size_t)(eq - setting) + 1); /* shown in messages: `u=` */
  CommandInput one = {parse_setting(ast, place, name), parse_setting(ast, place, quoted_file(ast->arena, eq + 1))};
  vec_push(ast->arena, given, one);
  return one.what && one.value;
}

/* Whether the name of a setting is a start of a rotation: R, R[2], R.w, omega(R). */
static int starts_rotation(const Ast *ast, const char *name) {
  const char *inner = strncmp(name, "omega(", 6) == 0 ? name + 6 : name;
  while (*inner == ' ') inner++;
  size_t n = strcspn(inner, "[.') ");
  const AstStmt *st = find_declared(ast, STMT_COORD, arena_strndup(ast->arena, inner, n));
  return st && st->type && strcmp(st->type, "rotation") == 0 && !strchr(inner, '\'');
}

/* Whether word i, a range of `name`, has a table or formula beside it: the simulator would not see that. */
static const char *value_beside(Arena *a, const Options *o, uint32_t i, const char *name) {
  for (uint32_t k = 0; k < o->rest.n; k++) {
    const char *word = o->rest.at[k], *eq = word[0] != '-' ? strchr(word, '=') : NULL;
    if (word[0] == '-' && option_takes_next(o->command, word)) k++;
    if (k != i && eq && strcmp(text_trimmed(a, word, (size_t)(eq - word)), name) == 0 && !range_split(a, word))
      return word;
  }
  return NULL;
}

/* Makes a constant that varies continuously a parameter, and says so. */
static void as_param(Ast *ast, const char *name) {
  AstStmt *st = (AstStmt *)find_declared(ast, STMT_CONST, name);
  st->kind = STMT_PARAM;
  diag_note(ast->diags, st->name_span, "`%s` is a constant: compiled as a parameter, which can vary", name);
}

/* Whether values may be ranges. */
static int takes_ranges(const Options *o) { return o->command == CMD_SWEEP || o->command == CMD_CONTINUE; }

/* Refuses names with a range and a value. */
static int check_ranges(Ast *ast, const Options *o, const char **error) {
  for (uint32_t i = 0; i < o->rest.n && o->command == CMD_SWEEP; i++) {
    const char *word = o->rest.at[i];
    if (word[0] == '-' && option_takes_next(o->command, word)) i++;
    if (word[0] == '-' || !range_split(ast->arena, word)) continue;
    const char *name = text_trimmed(ast->arena, word, strcspn(word, "=~")),
               *beside = value_beside(ast->arena, o, i, name);
    if (beside) return fail_with(error, arena_printf(ast->arena, "%s: %s varies; leave one out", beside, name));
  }
  return 1;
}

int settings_compiled(Ast *ast, Options *o, int all, GivenList *given, const char **error) {
  uint32_t kept = 0;
  int ok = 1;
  if (!check_ranges(ast, o, error)) return 0;
  for (uint32_t i = 0; i < o->rest.n; i++) {
    /* --measure u=x is no value of u */
    if (o->rest.at[i][0] == '-' && option_takes_next(o->command, o->rest.at[i]) && i + 1 < o->rest.n) {
      o->rest.at[kept++] = o->rest.at[i++];
      o->rest.at[kept++] = o->rest.at[i];
      continue;
    }
    const char *arg = o->rest.at[i], *eq = arg[0] != '-' ? strpbrk(arg, o->command == CMD_SWEEP ? "=~" : "=") : NULL;
    const char *name = eq ? text_trimmed(ast->arena, arg, (size_t)(eq - arg)) : "";
    int ranges = eq && takes_ranges(o) && range_split(ast->arena, arg) != NULL;
    int constant = eq && find_declared(ast, STMT_CONST, name) && !find_declared(ast, STMT_PARAM, name);
    if (constant && !ranges)
      return fail_with(
          error, arena_printf(ast->arena, "%s: `%s` is a constant, fixed when compiling: write -D %s", arg, name, arg));
    if (constant && o->command == CMD_CONTINUE) constant = 0, as_param(ast, name);
    if (constant && !const_range_take(ast, o, i, name, error)) return 0;
    arg = o->rest.at[i];
    if (ranges && starts_rotation(ast, name))
      return fail_with(error, arena_printf(ast->arena,
                                           "%s: the start of a rotation is compiled and cannot vary: write a `param` "
                                           "into it, as in `start omega(R) = (w, 0, 0)`, which can",
                                           arg));
    int formula = eq && !text_is_number(eq + 1) && !ranges && find_declared(ast, STMT_INPUT, name);
    if (eq && eq[1] && (all || formula || starts_rotation(ast, name))) ok &= take_setting(ast, arg, given);
    else o->rest.at[kept++] = arg;
  }
  o->rest.n = kept;
  return ok;
}

/* --- values with units --- */

/* A word of the command line, and the place in it of a value that is to become a plain number. */
typedef struct {
  const char **word, *before; /* the new word is `before` and the number */
} ValuePlace;

typedef struct {
  const Options *o;
  Ast *ast;
  Arena *arena;
  VEC(ValuePlace) places;
  VEC(CommandValue) values; /* of the places */
  int follows;              /* as of CommandValue */
} Converter;

/* Whether the value has a unit or is a formula of numbers; all else goes to the simulator as it stands. */
static int needs_conversion(const char *value) {
  size_t n = strlen(value);
  if (text_is_number(value)) return 0;
  return strchr(value, '[') || strspn(value, "+-*/^.0123456789eE() pi") == n;
}

/* Notes that `value`, of `name` (NULL: a time), is to become a number in the word. Returns 0 where it cannot be
 * read. */
static int convert_later(Converter *c, const char *name, const char *value, const char **word, const char *before) {
  CommandValue v = {.target = name ? parse_setting(c->ast, "command line", name) : 0, .follows = c->follows};
  v.value = parse_setting(c->ast, "command line", value);
  vec_push(c->arena, &c->places, ((ValuePlace){word, before}));
  vec_push(c->arena, &c->values, v);
  return (!name || v.target) && v.value;
}

/* Converts name=value, with spaces around both removed. */
static int convert_setting(Converter *c, const char **arg) {
  const char *eq = strchr(*arg, '=');
  const char *name = text_trimmed(c->arena, *arg, (size_t)(eq - *arg)),
             *value = text_trimmed(c->arena, eq + 1, strlen(eq + 1));
  if (needs_conversion(value)) return convert_later(c, name, value, arg, arena_printf(c->arena, "%s=", name));
  *arg = arena_printf(c->arena, "%s=%s", name, value);
  return 1;
}

/* Converts the value of an option that is a time: --until 2[min], --until=2[min]. */
static int convert_time(Converter *c, uint32_t *i) {
  static const char *const options[] = {"--until", "--every", "--step", "--transient", "--period", "--guess"};
  const char **at = c->o->rest.at;
  for (size_t k = 0; k < sizeof options / sizeof *options; k++) {
    size_t n = strlen(options[k]);
    if (strncmp(at[*i], options[k], n) != 0 || (at[*i][n] != '=' && at[*i][n])) continue;
    int joined = at[*i][n] == '=';
    if (!joined && *i + 1 == c->o->rest.n) return 1;
    const char *value = joined ? at[*i] + n + 1 : at[++*i];
    return !needs_conversion(value) ||
           convert_later(c, NULL, value, &at[*i], joined ? arena_printf(c->arena, "%s=", options[k]) : "");
  }
  return 1;
}

/* The value as text, with all its digits where the precision asks for them; NULL after a mistake. */
static const char *number_text(Converter *c, const CommandValue *v) {
  enum { ROOM = 32 };
  if (options_more_digits(c->o) && v->digits) return v->digits;
  if (options_more_digits(c->o)) {
    diag_error(c->ast->diags, ast_expr(c->ast, v->value)->span,
               "--precision %s needs more digits of this value than lagc computes", c->o->precision);
    diag_help(c->ast->diags, "lagc has all digits of fractions and of multiples of pi; write other values as decimals");
    return NULL;
  }
  char *text = arena_alloc(c->arena, ROOM);
  num_format_double(text, v->number);
  return text;
}

/* Evaluates the values in the scene, and writes them into their words. */
static int convert_all(Converter *c) {
  ModelChoice choice = {.scene = c->o->scene,
                        .defines = c->o->defines.at,
                        .ndefines = c->o->defines.n,
                        .values = c->values.at,
                        .nvalues = c->values.n};
  if (!c->values.n) return 1;
  if (!model_build(c->ast, &choice)) return 0;
  for (uint32_t i = 0; i < c->values.n; i++) {
    const char *text = number_text(c, &c->values.at[i]);
    if (!text) return 0;
    *c->places.at[i].word = arena_printf(c->arena, "%s%s", c->places.at[i].before, text);
  }
  return 1;
}

static int is_constant(const Options *o, const char *name) {
  for (uint32_t k = 0; k < o->consts.n; k++)
    if (strcmp(o->consts.at[k].name, name) == 0) return 1;
  return 0;
}

typedef VEC(Range *) Ranges;

/* Notes a range, which stands in word `at`, and its numbers for conversion. */
static void note_range(Converter *c, Ranges *ranges, Range *range, uint32_t at, int *ok) {
  range->word = at;
  vec_push(c->arena, ranges, range);
  c->follows = c->o->command == CMD_CONTINUE;
  for (uint32_t k = 0; k < range->numbers.n; k++) *ok &= convert_setting(c, &range->numbers.at[k]);
  if (range->zero) *ok &= convert_setting(c, &range->zero);
  c->follows = 0;
}

int settings_units(Ast *ast, const Options *o) {
  Converter c = {.o = o, .ast = ast, .arena = ast->arena};
  Ranges ranges = {0};
  int ok = 1;
  for (uint32_t i = 0; i < o->rest.n; i++) {
    const char *word = o->rest.at[i];
    uint32_t at = i;
    Range *range = takes_ranges(o) && word[0] != '-' ? range_split(ast->arena, word) : NULL;
    if (range && is_constant(o, range->name)) continue;
    if (range) {
      note_range(&c, &ranges, range, i, &ok);
      continue;
    }
    if (word[0] != '-') {
      if (strchr(word, '=')) ok &= convert_setting(&c, &o->rest.at[i]);
      continue;
    }
    Range *starts =
        strcmp(word, "--starts") == 0 && i + 1 < o->rest.n ? range_split(ast->arena, o->rest.at[i + 1]) : NULL;
    if (starts) note_range(&c, &ranges, starts, i + 1, &ok);
    else if (strcmp(word, "--vs") == 0 && i + 1 < o->rest.n && strchr(o->rest.at[i + 1], '='))
      ok &= convert_setting(&c, &o->rest.at[i + 1]);
    ok &= convert_time(&c, &i);
    if (i == at && option_takes_next(o->command, word)) i++;
  }
  ok = ok && convert_all(&c);
  for (uint32_t i = 0; i < ranges.n && ok; i++) o->rest.at[ranges.at[i]->word] = range_joined(ast->arena, ranges.at[i]);
  return ok;
}
