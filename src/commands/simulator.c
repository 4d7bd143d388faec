/* Simulators of all scenes: Eqns -> IrUnits -> C texts -> program. */
#include "commands/simulator.h"

#include <float.h>
#include <stdio.h>
#include <string.h>

#include "emit/cnames.h"
#include "emit/emit_model.h"
#include "ir/unit.h"
#include "lower/lower.h"
#include "mech/discontinuity.h"
#include "model/model.h"
#include "toolchain/cache.h"

/* The equations of a scene with the outputs, inputs and section of the command line. */
static Eqns *derive_asked(Compiler *c, const char *scene) {
  return compiler_derive_wanted(c, &(ModelChoice){.scene = scene, .asked = c->picture.asked.at, .nextra_outputs = c->picture.asked.n,
                                  .given = c->given.at, .ngiven = c->given.n, .section = c->picture.section});
}

/* Literals that are no 64-bit fraction were rounded to a double; those of up to SAFE characters lost nothing. */
static int warn_literal(const Ast *ast, const char *precision) {
  enum { SAFE = 17 };
  for (AstId i = 1; i < ast->exprs.n; i++) {
    const AstExpr *e = ast_expr(ast, i);
    if (e->kind != AST_NUM || num_is_exact(e->number) || e->span.end - e->span.begin <= SAFE) continue;
    diag_warning(ast->diags, e->span, "this number is rounded to 17 digits, fewer than --precision %s computes with", precision);
    diag_help(ast->diags, "if more digits matter, make it a parameter or a start, and give them as name=value");
    return 1;
  }
  return 0;
}

/* Warns of the first literal that was rounded to a double, or, where there is none, of the first such number in the model's graph. */
static void precision_warn(const Ast *ast, const ExprGraph *g, const char *precision) {
  enum { SAFE = 15, ROOM = 32 };
  if (warn_literal(ast, precision)) return;
  for (Expr e = 1; e <= expr_count(g); e++) {
    char text[ROOM];
    if (!expr_is_num(g, e) || num_is_exact(expr_number(g, e))) continue;
    num_format_double(text, num_value(expr_number(g, e)));
    if (strspn(text, "-0.123456789") - (text[0] == '-') - (strchr(text, '.') != NULL) <= SAFE) continue;
    fprintf(stderr, "lagc: warning: --precision %s: a product of numbers of the model, %s, is rounded to 17 digits; if more digits matter, make them "
            "parameters\n", precision, text);
    return;
  }
}

/* A scene of a unit with its equations. */
typedef struct {
  const Eqns *e;
  IrUnit *unit;
  uint32_t scene;
} Lowered;

typedef VEC(Lowered) Lowereds;

/* After lowering: hoists derived parameters, and checks every scene against the text. */
static int finish_units(const Units *units, const Lowereds *of) {
  for (uint32_t i = 0; i < units->n; i++) unit_hoist(units->at[i]);
  for (uint32_t i = 0; i < of->n; i++)
    if (!compiler_agrees(of->at[i].e, of->at[i].unit, of->at[i].scene)) return 0;
  return 1;
}

int simulator_lower(Compiler *c, Units *units) {
  SceneList scenes = model_scenes(c->ast);
  if (c->picture.asked.n || c->given.n || c->picture.section.expr) scenes = (SceneList){c->picture.scene ? &c->picture.scene : scenes.at, 1};
  Lowereds all = {0};
  for (uint32_t i = 0; i < scenes.n; i++) {
    Eqns *e = derive_asked(c, scenes.at[i]);
    if (!e) return 0;
    int runs = command_simulates(c->o.command) && strcmp(c->picture.scene ? c->picture.scene : scenes.at[0], scenes.at[i]) == 0;
    if (runs) discontinuity_warn(e);
    IrUnit *fresh = compiler_new_unit(c, e), *home = NULL;
    for (uint32_t k = 0; k < units->n && !home; k++)
      if (unit_accepts_scenes(units->at[k], fresh)) home = units->at[k];
    if (!home) vec_push(c->arena, units, home = fresh);
    home->lines = 1;
    if (runs) c->run = e, c->run_by = home;
    unit_require(home, e, derivatives_required(e, &c->o));
    unit_add_scene(home, e);
    vec_push(c->arena, &all, ((Lowered){e, home, home->scenes.n - 1}));
    if (options_more_digits(&c->o) && i + 1 == scenes.n) precision_warn(c->ast, e->m->g, c->o.precision);
  }
  return finish_units(units, &all);
}

int simulator_make(Compiler *c, const Toolchain *tools, const Texts *texts, const char *output, const char **path) {
  const char *error = NULL;
  *path = output;
  cache_remove_stale_builds(c->arena);
  if (!output) *path = toolchain_simulator(c->arena, tools, texts->at, texts->n, &error);
  else if (!toolchain_build(c->arena, tools, texts->at, texts->n, output, &error)) *path = NULL;
  return *path ? STATUS_OK : usage_error(error);
}

/* A text for each unit, the last of them with the program: a file less to compile. */
Texts simulator_texts(Compiler *c, const Units *units, int gsl) {
  Texts texts = {0};
  const char **names = ARENA_ARRAY(c->arena, const char *, units->n);
  for (uint32_t i = 0; i < units->n; i++) {
    names[i] = arena_printf(c->arena, "%s_%u", model_id(c->arena, units->at[i]->name), i);
    StrBuf b = strbuf(c->arena);
    emit_model(units->at[i], names[i], &b);
    if (i + 1 == units->n) emit_program((const IrUnit *const *)units->at, names, units->n, gsl, &b);
    vec_push(c->arena, &texts, ((SourceText){arena_printf(c->arena, "model_%u.c", i), sb_text(&b)}));
  }
  return texts;
}

int simulator_of_units(Compiler *c, const Units *units, const char *output, const char **path) {
  if (output && compiler_is_source(c, output)) return STATUS_USAGE;
  Toolchain tools;
  const char *error = NULL;
  if (!toolchain_find(c->arena, c->argv0, !c->o.no_gsl, &tools, &error)) return usage_error(error);
  if (c->o.precision && !toolchain_precision(c->arena, &tools, c->o.precision, &error)) return usage_error(error);
  if (c->o.command == CMD_MODES) tools.optimise = "-O0";
  Texts texts = simulator_texts(c, units, tools.gsl);
  return simulator_make(c, &tools, &texts, output, path);
}

const char *simulator_precise(Compiler *c, const Units *units) {
  Toolchain tools;
  const char *error = NULL;
  const char *precision = LDBL_MANT_DIG > DBL_MANT_DIG ? "long" : "quad";
  if (!toolchain_find(c->arena, c->argv0, 0, &tools, &error) || !toolchain_precision(c->arena, &tools, precision, &error)) return NULL;
  Texts texts = simulator_texts(c, units, 0);
  return toolchain_simulator(c->arena, &tools, texts.at, texts.n, &error);
}

OptionTexts simulator_values(Compiler *c) {
  OptionTexts words = {0};
  for (uint32_t i = 0; i < c->o.rest.n; i++) {
    const char *word = c->o.rest.at[i];
    int until = strncmp(word, "--until", 7) == 0, alone = until && !word[7];
    if (word[0] == '-' && !until) i += (uint32_t)option_takes_next(c->o.command, word);
    else vec_push(c->arena, &words, word);
    if (alone && i + 1 < c->o.rest.n) vec_push(c->arena, &words, c->o.rest.at[++i]);
  }
  return words;
}

/* " word", in quotes where a shell would read it otherwise. */
static void add_word(StrBuf *b, const char *word) {
  static const char plain[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.=+-/";
  if (!word[strspn(word, plain)]) {
    sb_printf(b, " %s", word);
    return;
  }
  sb_puts(b, " '");
  for (const char *c = word; *c; c++) sb_printf(b, *c == '\'' ? "'\\''" : "%c", *c);
  sb_puts(b, "'");
}

/* Before settings_compiled, which takes values away. */
static const char *words_given(Compiler *c) {
  StrBuf b = strbuf(c->arena);
  for (uint32_t i = 0; i < c->o.defines.n; i++) sb_printf(&b, " -D %s=%s", c->o.defines.at[i].name, c->o.defines.at[i].value);
  OptionTexts words = simulator_values(c);
  for (uint32_t i = 0; i < words.n; i++)
    if (!c->o.scene || strcmp(words.at[i], c->o.scene) != 0) add_word(&b, words.at[i]);
  return sb_text(&b);
}

int simulator_prepare(Compiler *c) {
  const char *error = NULL;
  c->given_words = words_given(c);
  if (c->o.scene && !model_has_scene(c->ast, c->o.scene)) return STATUS_MODEL;
  if (!settings_compiled(c->ast, &c->o, &c->given, &error)) return error ? usage_error(error) : STATUS_MODEL;
  if (!settings_units(c->ast, &c->o)) return STATUS_USAGE;
  if (!run_request_prepare(&c->picture, c->ast, &c->o, &error)) return error ? usage_error(error) : STATUS_MODEL;
  return STATUS_OK;
}
