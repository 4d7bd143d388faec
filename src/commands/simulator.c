/* Simulators of all scenes: Eqns -> ProgramSets -> C texts -> program. */
#include "commands/simulator.h"

#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands/const_ranges.h"
#include "commands/effect_sets.h"
#include "emit/emit_model.h"
#include "emit/late_text.h"
#include "ir/row_share.h"
#include "ir/program_set.h"
#include "lower/lower.h"
#include "mech/discontinuity.h"
#include "mech/far_error.h"
#include "mech/switches.h"
#include "model/model.h"
#include "toolchain/simulator_cache.h"
#include "toolchain/files.h"

/* A scene with the outputs, inputs and section of the command line. */
static ModelChoice choice_of(const Compiler *c, const char *scene, int measures) {
  return (ModelChoice){.scene = scene,
                       .asked = c->picture.asked.at,
                       .nextra_outputs = c->picture.asked.n,
                       .measures = c->picture.measures.at,
                       .nmeasures = measures ? c->picture.measures.n : 0,
                       .given = c->given.at,
                       .ngiven = c->given.n,
                       .section = c->picture.section,
                       .drawing = c->picture.drawing ? DRAWING_WANTED : DRAWING_NONE};
}

static Eqns *derive_asked(Compiler *c, const char *scene, int measures) {
  ModelChoice choice = choice_of(c, scene, measures);
  return compiler_derive_wanted(c, &choice);
}

typedef VEC(const Measures *) Measured; /* the measures of the command line, of each variant */

/* Hands them to the simulator as they are compiled: the name, and the words, of each variant where they differ. */
static void pass_measures(Compiler *c, const Measured *of) {
  if (!of->n || !of->at[0]->n) return;
  c->picture.argv.n--; /* the NULL at the end */
  for (uint32_t i = 0; i < of->at[0]->n; i++) {
    StrBuf b = strbuf(c->arena);
    uint32_t texts = 1;
    const char *first = measure_words(c->arena, &of->at[0]->at[i]);
    for (uint32_t v = 1; v < of->n; v++)
      if (strcmp(measure_words(c->arena, &of->at[v]->at[i]), first) != 0) texts = of->n;
    sb_puts(&b, of->at[0]->at[i].name);
    for (uint32_t v = 0; v < texts; v++) sb_printf(&b, ";%s", measure_words(c->arena, &of->at[v]->at[i]));
    vec_push(c->arena, &c->picture.argv, arena_strdup(c->arena, "--measure"));
    vec_push(c->arena, &c->picture.argv, arena_strdup(c->arena, sb_text(&b)));
  }
  vec_push(c->arena, &c->picture.argv, NULL);
}

/* Literals that are no 64-bit fraction were rounded to a double; those of up to SAFE characters lost nothing. */
static int warn_literal(const Ast *ast, const char *precision) {
  enum { SAFE = 17 };
  for (AstId i = 1; i < ast->exprs.n; i++) {
    const AstExpr *e = ast_expr(ast, i);
    if (e->kind != AST_NUM || num_is_exact(e->number) || e->span.end - e->span.begin <= SAFE) continue;
    diag_warning(ast->diags, e->span, "this number is rounded to 17 digits, fewer than --precision %s computes with",
                 precision);
    diag_help(ast->diags, "if more digits matter, make it a parameter or a start, and give them as name=value");
    return 1;
  }
  return 0;
}

/* Warns of the first literal that was rounded to a double, or, where there is none, of the first such number in the
 * model's graph. */
static void precision_warn(const Ast *ast, const ExprGraph *g, const char *precision) {
  enum { SAFE = 15, ROOM = 32 };
  if (warn_literal(ast, precision)) return;
  for (Expr e = 1; e <= expr_count(g); e++) {
    char text[ROOM];
    if (!expr_is_num(g, e) || num_is_exact(expr_number(g, e))) continue;
    num_format_double(text, num_value(expr_number(g, e)));
    if (strspn(text, "-0.123456789") - (text[0] == '-') - (strchr(text, '.') != NULL) <= SAFE) continue;
    diag_warning(ast->diags, (Span){0},
                 "--precision %s: a product of numbers of the model, %s, is rounded to 17 digits; if more digits "
                 "matter, make them parameters",
                 precision, text);
    return;
  }
}

/* A scene of a unit with its equations. */
typedef struct {
  const Eqns *e;
  ProgramSet *unit;
  uint32_t scene;
} Lowered;

typedef VEC(Lowered) Lowereds;

/* Whether the runs of a sweep or of build --lanes may go in lanes (runtime/lanes/lane_choice.c knows of methods and
 * scenes). */
static int may_have_lanes(const Compiler *c, const Units *units) {
  int may = (c->o.command == CMD_SWEEP || c->o.lanes) && !c->o.precision && toolchain_has_lanes();
  for (uint32_t i = 0; i < units->n; i++) may &= !units->at[i]->constraints.of.n && !units->at[i]->libm;
  return may;
}

/* After lowering: hoists derived parameters, and checks every scene against the text. */
static int finish_units(const Compiler *c, const Units *units, const Lowereds *of) {
  int lanes = may_have_lanes(c, units);
  for (uint32_t i = 0; i < units->n; i++) units->at[i]->lanes = lanes;
  for (uint32_t i = 0; i < units->n; i++) unit_hoist(units->at[i]);
  for (uint32_t i = 0; i < of->n; i++)
    if (!compiler_agrees(of->at[i].e, of->at[i].unit, of->at[i].scene)) return 0;
  return 1;
}

/* Says for which values of the constants the model is wrong; returns 0. */
static int tell_variant(Compiler *c) {
  for (uint32_t k = c->o.defines.n - c->o.consts.n; k < c->o.defines.n; k++)
    fprintf(stderr, "lagc: with %s=%s:\n", c->o.defines.at[k].name, c->o.defines.at[k].value);
  return 0;
}

/* Adds a scene to a unit that accepts it, or to one of its own (apart: always). */
static void lower_scene(Compiler *c, Eqns *e, int runs, int apart, Units *units, Lowereds *all) {
  switches_find(e);
  if (runs) switches_warn(e), discontinuity_warn(e), far_errors_note(e);
  ProgramSet *fresh = compiler_unit_head(c, e), *home = NULL;
  for (uint32_t k = 0; k < units->n && !home && !apart; k++)
    if (unit_accepts_scenes(units->at[k], fresh)) home = units->at[k];
  if (!home) {
    unit_add_programs(fresh, e);
    vec_push(c->arena, units, home = fresh);
  }
  home->lines = 1;
  if (runs) c->run = e, c->run_by = home;
  unsigned wants = derivatives_required(e, &c->o), afforded = derivatives_afforded(wants, e, home, &c->o);
  if (afforded != wants)
    c->picture.note = "methods that need second derivatives of L are left out: their C takes long to compile; "
                      "--seconds 60 or --methods NAME has them";
  unit_require(home, e, afforded);
  unit_add_scene(home, e);
  vec_push(c->arena, all, ((Lowered){e, home, home->scenes.n - 1}));
}

/* One more argument of the simulator. */
static void pass_argument(Compiler *c, const char *text) {
  c->picture.argv.at[c->picture.argv.n - 1] = arena_strdup(c->arena, text);
  vec_push(c->arena, &c->picture.argv, NULL);
}

/* fit --effects: scenes like that of `run` without each effect that it uses, and with each that it does not. */
static int add_effect_scenes(Compiler *c, const Eqns *run, Units *units, Lowereds *all) {
  const char *scene = run->m->scene.name;
  EffectStudy *s = effect_study_plan(run->m);
  if (!s) return 0;
  if (!c->o.scene) pass_argument(c, scene);
  vec_each(const EffectRow, row, s->rows) {
    if (row->excluded_by) continue;
    EffectList only = effect_names(s, s->variants.at[row->apart]);
    ModelChoice choice = choice_of(c, scene, 0);
    choice.only = &only;
    Eqns *e = compiler_derive_wanted(c, &choice);
    if (!e) return 0;
    const char *name = arena_printf(c->arena, "%s %s %s", scene, row->on ? "without" : "with",
                                    s->graph.at[row->effect].stmt->name);
    lower_scene(c, e, 0, 0, units, all);
    const Lowered *last = &all->at[all->n - 1];
    last->unit->scenes.at[last->scene].name = name;
    pass_argument(c, name);
  }
  return 1;
}

int simulator_lower(Compiler *c, Units *units) {
  SceneList scenes = model_scenes(c->ast), named = c->picture.scenes.n ? c->picture.scenes : (SceneList){scenes.at, 1};
  if (c->picture.argv.n || c->picture.asked.n || c->given.n || c->picture.section.expr || c->picture.drawing ||
      c->o.consts.n)
    scenes = named; /* a run's programs are those of its scenes, build's of all */
  Lowereds all = {0};
  const char *error, *first = c->picture.scene ? c->picture.scene : scenes.at[0];
  uint32_t variants = const_range_variants(c->arena, &c->o, &error);
  Measured measured = {0};
  int simulates = command_simulates(c->o.command);
  for (uint32_t v = 0; v < variants; v++) { /* of the constants that a sweep varies */
    if (!const_range_define(c->ast, &c->o, v)) return 0;
    Eqns *run = simulates ? derive_asked(c, first, 1) : NULL;
    if (simulates && !run) return c->o.consts.n ? tell_variant(c) : 0;
    if (run) vec_push(c->arena, &measured, &run->m->asked_measures);
    if (run && run->m->measured_outputs) scenes = named; /* which a program of all scenes lacks */
    for (uint32_t i = 0; i < scenes.n; i++) {
      int runs = run && strcmp(first, scenes.at[i]) == 0;
      Eqns *e = runs ? run : derive_asked(c, scenes.at[i], scenes.at == named.at && scenes.n == named.n);
      if (!e) return c->o.consts.n ? tell_variant(c) : 0;
      lower_scene(c, e, runs, variants > 1, units, &all);
      if (options_more_digits(&c->o) && i + 1 == scenes.n && !simulator_is_later_rank(c))
        precision_warn(c->ast, all.at[all.n - 1].e->m->g, c->o.precision);
    }
    if (run && c->o.by_effects && !add_effect_scenes(c, run, units, &all)) return 0;
  }
  pass_measures(c, &measured);
  return finish_units(c, units, &all);
}

int simulator_make(Compiler *c, const Toolchain *tools, const Texts *texts, const char *output, const char **path) {
  const char *error = NULL;
  *path = output;
  cache_remove_stale_builds(c->arena);
  if (!output) *path = toolchain_simulator(c->arena, tools, texts->at, texts->n, &error);
  else if (!toolchain_build(c->arena, tools, texts->at, texts->n, output, &error)) *path = NULL;
  return *path ? STATUS_OK : usage_error(error);
}

static void add_lanes(Compiler *c, const ProgramSet *u, const char *name, const char *file, int lanes, Texts *texts) {
  StrBuf b = strbuf(c->arena);
  emit_lanes(u, name, file, lanes, &b);
  vec_push(c->arena, texts, ((SourceText){arena_printf(c->arena, "lanes_%d_%s", lanes, file), sb_text(&b)}));
}

/* C names of the models. */
static const char *const *unit_names(Compiler *c, const Units *units) {
  const char **names = ARENA_ARRAY(c->arena, const char *, units->n);
  for (uint32_t i = 0; i < units->n; i++)
    names[i] = arena_printf(c->arena, "%s_%u", model_id(c->arena, units->at[i]->name), i);
  return names;
}

StrBuf simulator_bytes(Compiler *c, const Units *units) {
  StrBuf out = strbuf(c->arena);
  emit_bytes((const ProgramSet *const *)units->at, unit_names(c, units), units->n, &out);
  return out;
}

/* A text for each unit, the last of them with the program: a file less to compile. */
Texts simulator_texts(Compiler *c, const Units *units, ProgramKind kind) {
  Texts texts = {0};
  const char *const *names = unit_names(c, units);
  for (uint32_t i = 0; i < units->n; i++) {
    StrBuf b = strbuf(c->arena);
    const char *file = arena_printf(c->arena, "model_%u.c", i);
    emit_model(units->at[i], names[i], program_names_late(kind) ? MODEL_OF_MAIN : MODEL_PLAIN, &b);
    if (i + 1 == units->n) emit_program((const ProgramSet *const *)units->at, names, units->n, kind, &b);
    for (int lanes = 4; lanes <= 8 && kind & PROGRAM_WITH_LANES; lanes *= 2)
      add_lanes(c, units->at[i], names[i], file, lanes, &texts);
    const StrBuf whole = late_text_write(&b);
    vec_push(c->arena, &texts, ((SourceText){file, sb_text(&whole)}));
  }
  return texts;
}

/* The file's name without folder, suffix and "lib". */
static const char *file_stem(Compiler *c, const char *path) {
  const char *name = file_name(path);
  if (strncmp(name, "lib", 3) == 0) name += 3;
  return arena_strndup(c->arena, name, strcspn(name, "."));
}

/* Whether a word of the simulator's command line names a file with this suffix. */
static int names_file(const Compiler *c, const char *suffix) {
  for (uint32_t i = 0; i < c->picture.argv.n && c->picture.argv.at[i]; i++) {
    const char *word = c->picture.argv.at[i];
    size_t n = strlen(word), k = strlen(suffix);
    if (n > k && strcmp(word + n - k, suffix) == 0) return 1;
  }
  return 0;
}

int simulator_is_later_rank(const Compiler *c) {
  static const char *const ranks[] = {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"};
  int later = 0;
  for (size_t i = 0; i < sizeof ranks / sizeof *ranks; i++) later |= getenv(ranks[i]) && atoi(getenv(ranks[i])) > 0;
  return later && c->o.command == CMD_SWEEP;
}

/* Whether a sweep has several processes: by --mpi, or because mpirun or srun started this one with others. */
static int asks_ranks(const Compiler *c) {
  /* of Open MPI; of srun, which sets PMIX_RANK beside the last one */
  static const char *const sizes[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"};
  if (c->o.command != CMD_SWEEP) return 0;
  for (uint32_t i = 0; i < c->picture.argv.n && c->picture.argv.at[i]; i++)
    if (strncmp(c->picture.argv.at[i], "--mpi", 5) == 0) return 1;
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
    const char *n = i == 2 && !getenv("PMIX_RANK") ? NULL : getenv(sizes[i]);
    if (n && atoi(n) > 1) return 1;
  }
  return 0;
}

const char *simulator_surroundings(const Compiler *c) {
  return arena_printf(c->arena, "%d %d %d", simulator_is_later_rank(c), asks_ranks(c), toolchain_has_lanes());
}

/* Links the parts of the runtime that the command line asks for: those that write its files, and MPI. Returns
 * PROGRAM_WITH_..., or -1 with *error. */
static int find_parts(Compiler *c, Toolchain *t, const char **error) {
  static const struct {
    const char *suffix, *part, *needs;
    int kind;
  } rows[] = {{".png", "png",
               "a picture as PNG needs librsvg, which this lagc was built without: `apt-get install librsvg2-dev`, "
               "then `make`; .svg needs nothing",
               PROGRAM_WITH_PNG},
              {".h5", "hdf5",
               "HDF5 needs libhdf5, which this lagc was built without: `apt-get install libhdf5-dev`, then `make`; "
               ".csv and .npy need nothing",
               PROGRAM_WITH_HDF5},
              {NULL, "mpi",
               "several processes (--mpi, mpirun) need Open MPI, which this lagc was built without: `apt-get install "
               "libopenmpi-dev openmpi-bin`, then `make`; --threads needs nothing",
               PROGRAM_WITH_MPI}};
  int kind = 0;
  for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
    if (rows[i].suffix ? !names_file(c, rows[i].suffix) : !asks_ranks(c)) continue;
    t->parts[i] = toolchain_part(c->arena, t, rows[i].part);
    if (!t->parts[i]) return fail_with(error, rows[i].needs) - 1;
    kind |= rows[i].kind;
  }
  return kind;
}

/* --threads: their number for the compiler, 0 where there is nothing to share. Returns a STATUS. */
static int find_threads(Compiler *c, const Units *units, long *threads) {
  enum { MOST = 1024 };
  char *end = NULL;
  const char *text = c->o.command == CMD_SWEEP ? NULL : c->o.threads;
  int shares = 0;
  *threads = text ? strtol(text, &end, 10) : 1;
  if (text && (end == text || *end || *threads < 1 || *threads > MOST))
    return usage_error(arena_printf(c->arena, "--threads %s: write a number from 1 to %d: --threads 2", text, MOST));
  for (uint32_t i = 0; i < units->n && *threads > 1; i++) shares |= unit_shares(units->at[i], 1);
  if (*threads > 1 && !shares && !options_pass_flag(&c->o, "--quiet")) {
    const char *says = "--threads: nothing to share; threads share sums over pairs, each taken once, of 246 bodies "
                       "and more, and sums over neighbours and trees of 2000";
    if (c->o.command == CMD_BUILD) fprintf(stderr, "lagc build: %s\n", says);
    else if (!c->picture.note) c->picture.note = says;
  }
  if (!shares) *threads = 0;
  return STATUS_OK;
}

int simulator_tools(Compiler *c, const Units *units, const char *output, Toolchain *tools, ProgramKind *kind) {
  const char *error = NULL;
  if (!toolchain_find(c->arena, c->argv0, !c->o.no_gsl && !c->o.shared, tools, &error)) return usage_error(error);
  if (c->o.precision && !toolchain_precision(c->arena, tools, c->o.precision, &error)) return usage_error(error);
  if (c->o.command == CMD_MODES) tools->optimise = "-O0";
  tools->soname = c->o.shared ? arena_printf(c->arena, "lib%s.so", file_stem(c, output ? output : c->o.file)) : NULL;
  tools->lanes = units->at[0]->lanes;
  int status = find_threads(c, units, &tools->threads);
  if (status != STATUS_OK) return status;
  int parts = find_parts(c, tools, &error);
  if (parts < 0) return usage_error(error);
  int lanes = tools->lanes ? PROGRAM_WITH_LANES : 0;
  *kind = (ProgramKind)(lanes | (c->o.shared ? PROGRAM_LIBRARY : (tools->gsl ? PROGRAM_WITH_GSL : 0) | parts));
  return STATUS_OK;
}

int simulator_of_units(Compiler *c, const Units *units, const char *output, const char **path) {
  if (output && compiler_is_source(c, output)) return STATUS_USAGE;
  Toolchain tools;
  ProgramKind kind;
  int status = simulator_tools(c, units, output, &tools, &kind);
  if (status != STATUS_OK) return status;
  Texts texts = simulator_texts(c, units, kind);
  return simulator_make(c, &tools, &texts, output, path);
}

static const char *simulator_in(Compiler *c, const Units *units, const char *precision) {
  Toolchain tools;
  const char *error = NULL;
  if (!toolchain_find(c->arena, c->argv0, 0, &tools, &error) ||
      !toolchain_precision(c->arena, &tools, precision, &error))
    return NULL;
  Texts texts = simulator_texts(c, units, PROGRAM_PLAIN);
  return toolchain_simulator(c->arena, &tools, texts.at, texts.n, &error);
}

const char *simulator_precise(Compiler *c, const Units *units) {
  return simulator_in(c, units, LDBL_MANT_DIG > DBL_MANT_DIG ? "long" : "quad");
}

const char *simulator_quad(Compiler *c, const Units *units) {
  return LDBL_MANT_DIG > DBL_MANT_DIG ? simulator_in(c, units, "quad") : NULL;
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
  for (uint32_t i = 0; i < c->o.defines.n; i++)
    sb_printf(&b, " -D %s=%s", c->o.defines.at[i].name, c->o.defines.at[i].value);
  OptionTexts words = simulator_values(c);
  for (uint32_t i = 0; i < words.n; i++)
    if (!c->o.scene || strcmp(words.at[i], c->o.scene) != 0) add_word(&b, words.at[i]);
  return sb_text(&b);
}

int simulator_prepare(Compiler *c) {
  const char *error = NULL;
  c->given_words = words_given(c);
  for (uint32_t i = 0; i < c->o.scenes.n; i++)
    if (!model_has_scene(c->ast, c->o.scenes.at[i])) return STATUS_MODEL;
  if (!settings_compiled(c->ast, &c->o, 0, &c->given, &error)) return error ? usage_error(error) : STATUS_MODEL;
  if (!const_range_variants(c->arena, &c->o, &error)) return usage_error(error);
  if (c->o.consts.n)
    vec_push(c->arena, &c->o.rest, arena_printf(c->arena, "--consts=%s", const_range_names(c->arena, &c->o)));
  if (!settings_units(c->ast, &c->o)) return STATUS_USAGE;
  if (!run_request_prepare(&c->picture, c->ast, &c->o, &error)) return error ? usage_error(error) : STATUS_MODEL;
  return STATUS_OK;
}
