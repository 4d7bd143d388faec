/* `lagc complete WORD...`: what a shell may offer for the last WORD of a command line. The scripts of completion
 * (src/commands/complete.bash and its kin) ask it, so that all shells know what the parser knows, and nothing twice.
 *
 * WORDs are those after `lagc`, the last one as far as the cursor, perhaps empty. Each line of the answer is a
 * candidate for the whole word, a tab, and a description; after a candidate that ends in `=` or `(` the user goes on
 * without a space. The line `:files SUFFIX...` stands for the names of files with one of these suffixes, or, without
 * any, of all files; where a file's name is only the last part of the word, it begins after the `=`. */
#include <ctype.h>
#include <string.h>

#include "base/method_table.h"
#include "base/words.h"
#include "commands/command_table.h"
#include "commands/commands.h"
#include "commands/complete_bash.h" /* static const char *const complete_bash[]: generated from the scripts */
#include "commands/complete_fish.h"
#include "commands/complete_zsh.h"
#include "model/model.h"
#include "commands/run_request.h"
#include "syntax/parse.h"
#include "toolchain/gallery.h"

/* The command line before the cursor, parsed. */
typedef struct {
  Arena *arena;
  StrBuf *out;
  const char *word; /* the last one */
  const char *head; /* prefix of every candidate: "--method=", "th + ", or "" */
  const char *argv0;
  Command command;
  const char *file, *scene;
  const OptionRow *open; /* an option that waits for its value, or NULL */
  VEC(Define) defines;
  Ast *ast; /* the file's; NULL until it is needed, or where it cannot be read */
} CommandLine;

static void offer(CommandLine *l, const char *candidate, const char *description) {
  const char *whole = arena_printf(l->arena, "%s%s", l->head, candidate);
  if (strncmp(whole, l->word, strlen(l->word)) != 0) return;
  sb_printf(l->out, "%s\t%.*s\n", whole, (int)strcspn(description, "\n\t"), description);
}

/* ---- the model ---- */

static Ast *read_ast(CommandLine *l) {
  if (l->ast || !l->file) return l->ast;
  Sources *sources = sources_new(l->arena);
  sources->library = gallery_library(l->arena, l->argv0);
  const char *why;
  const char *path = gallery_path(l->arena, l->argv0, l->file, &why);
  const Source *source = path ? source_read_model(sources, path, &why) : NULL;
  if (!source) return NULL;
  l->ast = ast_new(l->arena, interner_new(l->arena), sources, diags_new(l->arena, sources));
  parse(l->ast, source);
  return l->ast;
}

static Model *read_model(CommandLine *l) {
  Ast *ast = read_ast(l);
  if (!ast) return NULL;
  if (!settings_defines(ast, l->defines.at, l->defines.n)) return NULL;
  ModelChoice choice = {.scene = l->scene, .defines = l->defines.at, .ndefines = l->defines.n};
  return model_build(ast, &choice);
}

static void offer_scenes(CommandLine *l) {
  Ast *ast = read_ast(l);
  for (const AstStmt *s = ast ? ast->first : NULL; s; s = s->next)
    if (s->kind == STMT_SCENE && s->name) offer(l, s->name, s->doc ? s->doc : "scene");
}

static void offer_setting(CommandLine *l, const char *name, const char *what, const Unit *unit) {
  const char *in = unit && unit->text[0] ? arena_printf(l->arena, ", [%s]", unit->text) : "";
  offer(l, arena_printf(l->arena, "%s=", name), arena_printf(l->arena, "%s%s", what, in));
}

/* Names that `name=value` sets: parameters, starts, states, inputs. */
static void offer_settings(CommandLine *l) {
  Model *m = read_model(l);
  if (!m) return;
  for (uint32_t i = 0; i < m->params.n; i++) offer_setting(l, m->params.at[i].name, "parameter", &m->params.at[i].unit);
  vec_each(const Coord, c, m->coords) {
    offer_setting(l, c->name, "start of the coordinate", &c->unit);
    offer_setting(l, arena_printf(l->arena, "%s'", c->name), "start of its velocity", NULL);
  }
  for (uint32_t i = 0; i < m->states.n; i++)
    offer_setting(l, m->states.at[i].name,
                  m->states.at[i].coordinate ? "start of the coordinate" : "start of the state", &m->states.at[i].unit);
  for (uint32_t i = 0; i < m->inputs.n; i++)
    offer_setting(l, m->inputs.at[i].name, "input, held constant", &m->inputs.at[i].unit);
}

static void offer_names(CommandLine *l, const AstStmt *list) {
  static const char *const quantity[STMT_STOP + 1] = {
      [STMT_COORD] = "coordinate", [STMT_MOMENTUM] = "momentum", [STMT_PARAM] = "parameter",
      [STMT_CONST] = "constant",   [STMT_INPUT] = "input",       [STMT_STATE] = "state",
      [STMT_LET] = "let",          [STMT_OBSERVE] = "observable"};
  for (const AstStmt *s = list; s; s = s->next) {
    if (s->name && quantity[s->kind])
      offer(l, s->dims ? arena_printf(l->arena, "%s[", s->name) : s->name, quantity[s->kind]);
    if (s->name && s->kind == STMT_FUNCTION) offer(l, arena_printf(l->arena, "%s(", s->name), "function of the model");
  }
}

/* Offers names for the identifier at the end of an expression; the text before it is kept. */
static void offer_expression(CommandLine *l) {
  size_t n = strlen(l->word), head = strlen(l->head);
  while (n > head && (isalnum((unsigned char)l->word[n - 1]) || strchr("_.", l->word[n - 1]) ||
                      (unsigned char)l->word[n - 1] >= 0x80))
    n--;
  if (isdigit((unsigned char)l->word[n])) return;
  l->head = arena_strndup(l->arena, l->word, n);
  Ast *ast = read_ast(l);
  offer_names(l, ast ? ast->first : NULL);
  static const char *const known[] = {"t", "pi", "energy", "lagrangian"};
  for (size_t i = 0; i < sizeof known / sizeof *known; i++) offer(l, known[i], "of every model");
  for (size_t i = 0; function_name(i); i++) offer(l, arena_printf(l->arena, "%s(", function_name(i)), "function");
}

/* ---- values of options ---- */

static void offer_methods(CommandLine *l) {
  offer(l, "help", "list them, with their options");
  for (size_t i = 0; method_at(i); i++) offer(l, method_at(i)->name, method_at(i)->does);
}

static void offer_choices(CommandLine *l, const OptionRow *o) {
  const char *comma = o->takes == TAKES_CHOICES ? strrchr(l->word, ',') : NULL;
  if (comma) l->head = arena_strndup(l->arena, l->word, (size_t)(comma - l->word) + 1);
  for (size_t i = 0; word_at(l->arena, o->hint, i); i++) offer(l, word_at(l->arena, o->hint, i), "");
}

static void offer_params(CommandLine *l, const OptionRow *o) {
  const char *comma = strrchr(l->word, ',');
  if (comma) l->head = arena_strndup(l->arena, l->word, (size_t)(comma - l->word) + 1);
  offer(l, o->hint, "all parameters");
  Ast *ast = read_ast(l);
  for (const AstStmt *s = ast ? ast->first : NULL; s; s = s->next) {
    if (s->kind == STMT_PARAM && s->name) offer(l, s->name, "parameter");
    for (const AstStmt *x = s->kind == STMT_EFFECT ? s->body : NULL; x; x = x->next)
      if (x->kind == STMT_PARAM && x->name) offer(l, arena_printf(l->arena, "%s.%s", s->name, x->name), "parameter");
  }
}

static void offer_constants(CommandLine *l) {
  Ast *ast = read_ast(l);
  for (const AstStmt *s = ast ? ast->first : NULL; s; s = s->next)
    if (s->kind == STMT_CONST && s->name) offer(l, arena_printf(l->arena, "%s=", s->name), "constant");
}

static void offer_value(CommandLine *l, const OptionRow *o) {
  switch (o->takes) {
    case TAKES_FILE: sb_printf(l->out, ":files%s%s\n", o->hint[0] ? " " : "", o->hint); break;
    case TAKES_METHOD: offer_methods(l); break;
    case TAKES_CHOICE: case TAKES_CHOICES: offer_choices(l, o); break;
    case TAKES_EXPR: case TAKES_EXPRS: case TAKES_TEXT: offer_expression(l); break;
    case TAKES_PARAMS: offer_params(l, o); break;
    case TAKES_DEFINE: offer_constants(l); break;
    case TAKES_NUMBER: case TAKES_NOTHING: break;
  }
}

/* ---- words ---- */

static void offer_commands(CommandLine *l) {
  for (size_t i = 0; command_row(i); i++) {
    const CommandRow *row = command_row(i);
    if (row->help) offer(l, row->name, row->does ? row->does : row->help);
  }
}

static void offer_options(CommandLine *l) {
  for (size_t i = 0; option_row(i); i++) {
    const OptionRow *o = option_row(i);
    if (!(o->commands & command_bit(l->command))) continue;
    offer(l, o->name, o->does);
    if (o->brief) offer(l, o->brief, o->does);
  }
}

static void offer_topics(CommandLine *l) {
  Topics topics = {0};
  help_topics(l->arena, &topics);
  for (uint32_t i = 0; i < topics.n; i++) offer(l, topics.at[i], "");
  for (size_t i = 0; function_name(i); i++) offer(l, function_name(i), "function");
}

/* Records a word before the last one: an option, its value, the file or the scene. */
static void record_word(CommandLine *l, const char *word) {
  const char *value = NULL;
  if (l->open) {
    const char *eq = strchr(word, '=');
    if (l->open->takes == TAKES_DEFINE && eq)
      vec_push(l->arena, &l->defines,
               ((Define){.name = arena_strndup(l->arena, word, (size_t)(eq - word)), .value = eq + 1}));
    l->open = NULL;
    return;
  }
  const OptionRow *o = word[0] == '-' ? option_find(l->command, word, &value) : NULL;
  if (o && o->takes != TAKES_NOTHING) {
    l->open = o;
    if (value) record_word(l, value);
  } else if (word[0] != '-' && !strchr(word, '=')) {
    if (!l->file) l->file = word;
    else if (!l->scene) l->scene = word;
  }
}

static void offer_models(CommandLine *l, const char *before) {
  Gallery g = gallery_find(l->arena, l->argv0);
  for (uint32_t i = 0; i < g.names.n; i++)
    offer(l, arena_printf(l->arena, "%s%s", before, g.names.at[i]), "model of the gallery");
}

static void offer_word(CommandLine *l) {
  const char *value;
  const OptionRow *o = l->word[0] == '-' ? option_find(l->command, l->word, &value) : NULL;
  if (l->open) offer_value(l, l->open);
  else if (o && value) {
    l->head = arena_strndup(l->arena, l->word, (size_t)(value - l->word));
    offer_value(l, o);
  } else if (l->word[0] == '-') offer_options(l);
  else if (!l->file && l->word[0] == '@') offer_models(l, "@");
  else if (!l->file) sb_puts(l->out, ":files lag\n");
  else {
    if (!l->scene) offer_scenes(l);
    if (command_takes_values(l->command)) offer_settings(l);
  }
}

static void complete(StrBuf *out, const char *argv0, const char *const *words, size_t n) {
  if (!n) return;
  CommandLine l = {.arena = out->arena, .out = out, .word = words[n - 1], .head = "", .argv0 = argv0};
  if (n == 1) {
    offer_commands(&l);
    return;
  }
  l.command = command_named(words[0]);
  for (size_t i = 1; i + 1 < n && l.command; i++) record_word(&l, words[i]);
  if (l.command == CMD_HELP && n == 2) offer_topics(&l);
  else if (l.command == CMD_COMPLETION && n == 2) {
    for (size_t i = 0; word_at(l.arena, "bash zsh fish", i); i++) offer(&l, word_at(l.arena, "bash zsh fish", i), "");
  } else if (command_reads_model(l.command)) offer_word(&l);
  else if (l.command == CMD_NEW && l.open) offer_models(&l, "");
  else if (l.command == CMD_CACHE || l.command == CMD_NEW || l.command == CMD_PLAYGROUND) offer_options(&l);
}

/* `lagc completion SHELL`: prints a built-in script. */
static void print_script(StrBuf *out, const char *shell) {
  static const struct {
    const char *shell;
    const char *const *lines;
    size_t n;
  } scripts[] = {
    {"bash", complete_bash, sizeof complete_bash / sizeof *complete_bash},
    {"zsh", complete_zsh, sizeof complete_zsh / sizeof *complete_zsh},
    {"fish", complete_fish, sizeof complete_fish / sizeof *complete_fish},
  };
  for (size_t i = 0; i < sizeof scripts / sizeof *scripts; i++)
    for (size_t k = 0; k < scripts[i].n && strcmp(scripts[i].shell, shell) == 0; k++) sb_puts(out, scripts[i].lines[k]);
}

int command_completion(Compiler *c) {
  StrBuf out = strbuf(c->arena);
  if (c->o.command == CMD_COMPLETE) complete(&out, c->argv0, c->o.rest.at, c->o.rest.n);
  else print_script(&out, c->o.topic);
  return compiler_write(c, NULL, &out);
}
