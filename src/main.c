/* lagc: the way of a model from text to C, in one view.
 *
 *   text --parse--> Ast --model_build--> Model --eqns_derive--> Eqns --unit_new--> IrUnit --emit--> C
 *
 * Exit status: 0 ok, 1 bad model, 2 usage or files, 3 the run failed (a simulator's status). */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/diag.h"
#include "base/methods.h"
#include "base/suggest.h"
#include "base/visible.h"
#include "commands/check.h"
#include "toolchain/cache.h"
#include "toolchain/files.h"
#include "toolchain/last_state.h"
#include "toolchain/runtime_methods.h"
#include "commands/options.h"
#include "commands/shells.h"
#include "toolchain/toolchain.h"
#include "commands/completion.h"
#include "commands/noether.h"
#include "commands/effects_study.h"
#include "emit/cnames.h"
#include "emit/cwriter.h"
#include "emit/emit_header.h"
#include "emit/emit_model.h"
#include "ir/hoist.h"
#include "commands/help.h"
#include "lower/lower.h"
#include "jets/no_value.h"
#include "jets/self_check.h"
#include "mech/constrain.h"
#include "mech/definite.h"
#include "mech/discontinuity.h"
#include "mech/eqns.h"
#include "mech/start.h"
#include "report/show.h"
#include "model/model.h"
#include "commands/picture.h"
#include "commands/precision_warning.h"
#include "commands/settings.h"
#include "syntax/parse.h"
#include "commands/required_derivatives.h"

#define LAGC_VERSION "0.1"

enum { STATUS_OK, STATUS_MODEL, STATUS_USAGE, STATUS_RUN };
enum { MEMORY_LIMIT_MIB = 2048 };

/* One compilation. */
typedef struct {
  Arena *arena;
  Options o;
  const char *argv0;
  Sources *sources;
  Diags *diags;
  Ast *ast;
  Picture picture; /* of run, plot and animate */
  GivenList given; /* to them */
  StrBuf told;     /* what was compared with the text, for check --verbose */
  const Eqns *run; /* of the scene that the command runs, */
  IrUnit *run_by;  /* and its programs */
} Compiler;

static void print_messages(const Compiler *c) {
  StrBuf messages = strbuf(c->arena);
  if (!c->diags->errors) model_warn_unused(c->ast); /* by now the command line's expressions are read, too */
  diags_print(c->diags, &messages);
  fputs(sb_text(&messages), stderr);
}

static int fail_usage(const char *message) {
  fputs("lagc: ", stderr);
  fput_visible(stderr, message, "\n\t");
  fputc('\n', stderr);
  return STATUS_USAGE;
}

static int wants_dump(const Compiler *c, const char *stage) {
  const char *at = c->o.dump ? strstr(c->o.dump, stage) : NULL;
  size_t n = strlen(stage);
  return at && (at == c->o.dump || at[-1] == ',') && (at[n] == ',' || at[n] == '\0');
}

/* A mistyped output must not cost the model, nor a file that it is made of: includes, tables. */
static int is_source(Compiler *c, const char *path) {
  for (uint32_t i = 0; i < c->sources->files.n; i++) {
    if (!file_same(path, c->sources->files.at[i].path)) continue;
    const char *what = i == 0 ? "the model" : "a part of the model";
    fail_usage(arena_printf(c->arena, "%s would be overwritten: it is %s; write to another file", path, what));
    return 1;
  }
  return 0;
}

static int write_out(Compiler *c, const char *path, const StrBuf *text) {
  const char *why;
  if (path && c->sources && is_source(c, path)) return STATUS_USAGE;
  if (file_write(c->arena, path ? path : "-", sb_text(text), text->n, &why)) return STATUS_OK;
  return fail_usage(arena_printf(c->arena, "cannot write %s: %s", path ? path : "standard output", why));
}

/* --- the stages --- */

static int read_model(Compiler *c) {
  const char *why = NULL;
  const Source *source = source_read_model(c->sources, c->o.file, &why);
  if (!source) return fail_usage(arena_printf(c->arena, "cannot read %s: %s", c->o.file, why));
  parse(c->ast, source);
  settings_defines(c->ast, c->o.defines.at, c->o.defines.n);
  if (wants_dump(c, "ast")) {
    StrBuf b = strbuf(c->arena);
    ast_dump(c->ast, &b);
    write_out(c, NULL, &b);
  }
  return c->diags->errors ? STATUS_MODEL : STATUS_OK;
}

/* The equations of what was chosen; NULL with the reasons in c->diags. */
static Eqns *derive(Compiler *c, const ModelChoice *choice) {
  ModelChoice with_defines = *choice;
  with_defines.defines = c->o.defines.at;
  with_defines.ndefines = c->o.defines.n;
  if (!choice->bare && !choice->unfixed) with_defines.fix = c->o.fix;
  Model *m = model_build(c->ast, &with_defines);
  if (!m) return NULL;
  StrBuf listing = strbuf(c->arena);
  if (wants_dump(c, "model")) model_dump(m, &listing);
  Eqns *e = eqns_derive(m);
  if (e && !choice->bare) mass_warn(e); /* claims are about all values */
  if (e && wants_dump(c, "eqns")) dump_equations(e, &listing);
  if (listing.n) write_out(c, NULL, &listing);
  return e;
}

/* Of one scene (NULL: the first). */
static Eqns *derive_scene(Compiler *c, const char *scene) { return derive(c, &(ModelChoice){.scene = scene}); }

/* For a method that finds velocities from momenta, what has no inertia of its own gets some. */
static Eqns *derive_wanted(Compiler *c, const ModelChoice *choice) {
  Eqns *e = derive(c, choice);
  if (!e || !e->singular_mass || !(wants_of(e, &c->o) & WANT_VARIATION)) return e;
  ModelChoice lends = *choice;
  lends.lends = 1;
  return derive(c, &lends);
}

/* With what the command line asks for besides the scene's outputs. */
static Eqns *derive_asked(Compiler *c, const char *scene) {
  return derive_wanted(c, &(ModelChoice){.scene = scene, .asked = c->picture.asked.at, .nasked = c->picture.asked.n,
                                  .given = c->given.at, .ngiven = c->given.n, .section = c->picture.section});
}

static IrUnit *new_unit(Compiler *c, Eqns *e) {
  return unit_new(e, c->o.file, c->o.math && strcmp(c->o.math, "libm") == 0);
}

/* Whether the programs of u, for one of its scenes, compute what the text says. */
static int agrees(const Eqns *e, const IrUnit *u, uint32_t scene) {
  SelfCheck told;
  return self_check(e, u, scene, &told);
}

/* hoists: its derived parameters are taken out, as emitted models have them. NULL, with the reason in c->diags, when the program is wrong: a bug. */
static IrUnit *lower_scene(Compiler *c, Eqns *e, int hoists) {
  IrUnit *u = new_unit(c, e);
  unit_want(u, e, wants_of(e, &c->o));
  unit_add_scene(u, e);
  const char *wrong = prog_verify(u->accel);
  if (wrong) {
    diag_error(c->diags, (Span){0}, "internal error: %s", wrong);
    return NULL;
  }
  if (hoists) unit_hoist(u);
  if (!agrees(e, u, 0)) return NULL;
  if (wants_dump(c, "prog")) {
    StrBuf b = strbuf(c->arena);
    prog_dump(u->accel, &b);
    write_out(c, NULL, &b);
  }
  return u;
}

/* --- the commands --- */

/* Equations that are reported, compared with the text. */
static Eqns *derive_for(void *compiler, const ModelChoice *choice) {
  Compiler *c = compiler;
  Eqns *e = derive(c, choice);
  if (!e) return NULL;
  IrUnit *u = new_unit(c, e);
  unit_add_scene(u, e);
  SelfCheck told;
  if (!self_check(e, u, 0, &told)) return NULL;
  if (c->o.verbose) self_check_print(e, &told, &c->told);
  return e;
}

static int do_noether(Compiler *c) {
  StrBuf out = strbuf(c->arena);
  return conserved_print(&(Deriver){derive_for, c}, c->o.scene, c->o.format, &out) ? write_out(c, c->o.output, &out) : STATUS_MODEL;
}

static int do_hamiltonian(Compiler *c, Eqns *e) {
  StrBuf out = strbuf(c->arena);
  if (c->o.ops || (c->o.format && strcmp(c->o.format, "c") == 0)) return fail_usage("--hamiltonian goes with --format text or latex");
  return hamiltonian_print(e, c->o.format, &out) ? write_out(c, c->o.output, &out) : STATUS_MODEL;
}

/* What the operations would be without --fix. */
static const char *unfixed_cost(Compiler *c) {
  Eqns *e = derive(c, &(ModelChoice){.scene = c->o.scene, .unfixed = 1});
  return e ? arena_printf(c->arena, "without --fix: %s\n", ops_text(new_unit(c, e)->accel, c->arena)) : "";
}

static int do_derive(Compiler *c) {
  Eqns *e = derive_scene(c, c->o.scene);
  if (!e) return STATUS_MODEL;
  if (c->o.hamiltonian) return do_hamiltonian(c, e);
  IrUnit *u = lower_scene(c, e, 0);
  if (!u) return STATUS_MODEL;
  StrBuf out = strbuf(c->arena);
  const char *format = c->o.format ? c->o.format : "text";
  const char *cost = ops_text(u->accel, c->arena);
  if (c->o.ops) sb_printf(&out, "%s\n%s", cost, c->o.fix ? unfixed_cost(c) : "");
  else if (strcmp(format, "c") == 0) emit_accel(u, &out);
  else show_equations(e, cost, strcmp(format, "latex") == 0 ? PRINT_LATEX : PRINT_TEXT, &out);
  return write_out(c, c->o.output, &out);
}

static int do_emit(Compiler *c) {
  Eqns *e = derive_scene(c, c->o.scene);
  if (!e) return STATUS_MODEL;
  IrUnit *u = lower_scene(c, e, 1);
  if (!u) return STATUS_MODEL;
  StrBuf out = strbuf(c->arena);
  emit_model(u, model_id(c->arena, u->name), &out);
  return write_out(c, c->o.output, &out);
}

/* A header is called by its file: pend.h has PEND_IMPLEMENTATION. On standard output, by its model. */
static const char *header_name(Compiler *c, const char *model) {
  const char *path = c->o.output;
  if (!path || strcmp(path, "-") == 0) return model;
  const char *slash = strrchr(path, '/'), *stem = slash ? slash + 1 : path, *dot = strchr(stem + (stem[0] == '.'), '.');
  return dot ? arena_strndup(c->arena, stem, (size_t)(dot - stem)) : stem;
}

/* A header does not look for the start that a run takes: it is told. */
static int bake_start(Compiler *c, const Eqns *e, IrUnit *u) {
  long double *found = ARENA_ARRAY(c->arena, long double, 2 * (size_t)e->n + 1);
  unsigned char *moved = ARENA_ARRAY(c->arena, unsigned char, 2 * (size_t)e->n + 1);
  if (!start_moves(e, found, moved)) return 0;
  for (uint32_t i = 0; i < 2 * e->n; i++)
    if (moved[i]) vec_push(c->arena, &u->scenes.at[0].moves, ((IrMove){i, (double)found[i]}));
  return 1;
}

static int do_header(Compiler *c) {
  Eqns *e = derive_scene(c, c->o.scene);
  if (!e) return STATUS_MODEL;
  constraints_keep_none(e);
  IrUnit *u = lower_scene(c, e, 0);
  if (!u || !bake_start(c, e, u)) return STATUS_MODEL;
  StrBuf equations = strbuf(c->arena), out = strbuf(c->arena);
  show_equations(e, "", PRINT_TEXT, &equations);
  emit_header(u, header_name(c, u->name), sb_text(&equations), &out);
  return write_out(c, c->o.output, &out);
}

/* The scenes of the file as units: those with the same effects and inputs share one. What the command line asks for is asked
 * of one scene, and only that one is built then. */
typedef VEC(IrUnit *) Units;

/* A scene of a unit, and its equations. */
typedef struct {
  const Eqns *e;
  IrUnit *unit;
  uint32_t scene;
} Lowered;

typedef VEC(Lowered) Lowereds;

/* When all programs are there: derived parameters are taken out, and what is left is compared with the text. */
static int finish_units(const Units *units, const Lowereds *of) {
  for (uint32_t i = 0; i < units->n; i++) unit_hoist(units->at[i]);
  for (uint32_t i = 0; i < of->n; i++)
    if (!agrees(of->at[i].e, of->at[i].unit, of->at[i].scene)) return 0;
  return 1;
}

static int lower_all(Compiler *c, Units *units) {
  SceneList scenes = model_scenes(c->ast);
  if (c->picture.asked.n || c->given.n || c->picture.section.expr) scenes = (SceneList){c->picture.scene ? &c->picture.scene : scenes.at, 1};
  Lowereds all = {0};
  for (uint32_t i = 0; i < scenes.n; i++) {
    Eqns *e = derive_asked(c, scenes.at[i]);
    if (!e) return 0;
    int runs = command_simulates(c->o.command) && strcmp(c->picture.scene ? c->picture.scene : scenes.at[0], scenes.at[i]) == 0;
    if (runs) discontinuity_warn(e);
    IrUnit *fresh = new_unit(c, e), *home = NULL;
    for (uint32_t k = 0; k < units->n && !home; k++)
      if (unit_shares(units->at[k], fresh)) home = units->at[k];
    if (!home) vec_push(c->arena, units, home = fresh);
    home->lines = 1;
    if (runs) c->run = e, c->run_by = home;
    unit_want(home, e, wants_of(e, &c->o));
    unit_add_scene(home, e);
    vec_push(c->arena, &all, ((Lowered){e, home, home->scenes.n - 1}));
    if (options_more_digits(&c->o) && i + 1 == scenes.n) rounded_warn(c->ast, e->m->g, c->o.precision);
  }
  return finish_units(units, &all);
}

typedef VEC(SourceText) Texts;

/* A program from these texts at `output`, or in the cache (NULL). */
static int make_program(Compiler *c, const Toolchain *tools, const Texts *texts, const char *output, const char **path) {
  const char *error = NULL;
  *path = output;
  cache_remove_remains(c->arena);
  if (!output) *path = toolchain_simulator(c->arena, tools, texts->at, texts->n, &error);
  else if (!toolchain_build(c->arena, tools, texts->at, texts->n, output, &error)) *path = NULL;
  return *path ? STATUS_OK : fail_usage(error);
}

static Texts program_texts(Compiler *c, const Units *units, int gsl) {
  Texts texts = {0};
  const char **names = ARENA_ARRAY(c->arena, const char *, units->n);
  for (uint32_t i = 0; i < units->n; i++) {
    names[i] = arena_printf(c->arena, "%s_%u", model_id(c->arena, units->at[i]->name), i);
    StrBuf b = strbuf(c->arena);
    emit_model(units->at[i], names[i], &b);
    vec_push(c->arena, &texts, ((SourceText){arena_printf(c->arena, "model_%u.c", i), sb_text(&b)}));
  }
  StrBuf b = strbuf(c->arena);
  emit_program((const IrUnit *const *)units->at, names, units->n, gsl, &b);
  vec_push(c->arena, &texts, ((SourceText){"program.c", sb_text(&b)}));
  return texts;
}

static int make_simulator(Compiler *c, const Units *units, const char *output, const char **path) {
  if (output && is_source(c, output)) return STATUS_USAGE;
  Toolchain tools;
  const char *error = NULL;
  if (!toolchain_find(c->arena, c->argv0, !c->o.no_gsl, &tools, &error)) return fail_usage(error);
  if (c->o.precision && !toolchain_precision(c->arena, &tools, c->o.precision, &error)) return fail_usage(error);
  if (c->o.command == CMD_MODES) tools.optimise = "-O0";
  Texts texts = program_texts(c, units, tools.gsl);
  return make_program(c, &tools, &texts, output, path);
}

/* Of `emit` and `build`, which emit what it needs. That of a run is the simulator's to judge. */
static int method_is_known(Compiler *c) {
  size_t n = c->o.method ? strcspn(c->o.method, " (") : 0;
  if (!n || method_find(c->o.method, n) || method_is_foreign(c->o.method)) return 1;
  const char *name = arena_strndup(c->arena, c->o.method, n), *near = method_suggest(c->arena, name);
  const char *help = near ? arena_printf(c->arena, "did you mean %s? ", near) : "";
  fail_usage(arena_printf(c->arena, "unknown method %s; %s`lagc methods` lists them", name, help));
  return 0;
}

/* A simulator in quadruple precision, in the cache; NULL where there is no such precision. */
static const char *make_precise(Compiler *c, const Units *units) {
  Toolchain tools;
  const char *error = NULL;
  if (!toolchain_find(c->arena, c->argv0, 0, &tools, &error) || !toolchain_precision(c->arena, &tools, "quad", &error)) return NULL;
  Texts texts = program_texts(c, units, 0);
  return toolchain_simulator(c->arena, &tools, texts.at, texts.n, &error);
}

static int do_build(Compiler *c) {
  const char *path;
  Units units = {0};
  if (!c->o.output) return fail_usage("`lagc build` needs -o SIMULATOR");
  return lower_all(c, &units) ? make_simulator(c, &units, c->o.output, &path) : STATUS_MODEL;
}

/* Whether a file that the simulator would write is one that the model is made of. */
static int writes_source(Compiler *c) {
  for (char *const *a = c->picture.argv.at; *a; a++) {
    const char *eq = strncmp(*a, "--", 2) == 0 ? strchr(*a, '=') : NULL;
    if (is_source(c, eq ? eq + 1 : *a)) return 1;
  }
  return 0;
}

/* cost: a simulator with more digits computes what errors are measured against, and the other one reads it from its
 * standard input. Where that does not work, it has its own. */
static void give_reference(Compiler *c, const Units *units) {
  VEC(char *) argv = {0};
  const char *path = c->picture.argv.n > 1 ? make_precise(c, units) : NULL;
  if (!path) return;
  vec_push(c->arena, &argv, c->picture.argv.at[0]);
  vec_push(c->arena, &argv, arena_strdup(c->arena, "--reference"));
  for (uint32_t i = 0; i < c->o.rest.n; i++) {
    const char *word = c->o.rest.at[i];
    int until = strncmp(word, "--until", 7) == 0, alone = until && !word[7];
    if (strcmp(word, "--against") == 0 || strncmp(word, "--against=", 10) == 0) return; /* the user's own */
    if (word[0] == '-' && !until) i += (uint32_t)option_takes_next(c->o.command, word);
    else vec_push(c->arena, &argv, arena_strdup(c->arena, word));
    if (alone && i + 1 < c->o.rest.n) vec_push(c->arena, &argv, arena_strdup(c->arena, c->o.rest.at[++i]));
  }
  vec_push(c->arena, &argv, NULL);
  if (toolchain_to_stdin(path, argv.at) != 0) return;
  c->picture.argv.n--; /* the NULL at the end */
  vec_push(c->arena, &c->picture.argv, arena_strdup(c->arena, "--against"));
  vec_push(c->arena, &c->picture.argv, arena_strdup(c->arena, "-"));
  vec_push(c->arena, &c->picture.argv, NULL);
}

/* What a simulator is told, and the names that it gives values to. */
static int prepare_run(Compiler *c) {
  const char *error = NULL;
  if (c->o.scene && !model_has_scene(c->ast, c->o.scene)) return STATUS_MODEL;
  if (!settings_compiled(c->ast, &c->o, &c->given, &error)) return error ? fail_usage(error) : STATUS_MODEL;
  if (!settings_units(c->ast, &c->o)) return STATUS_USAGE;
  if (!picture_prepare(&c->picture, c->ast, &c->o, &error)) return error ? fail_usage(error) : STATUS_MODEL;
  return STATUS_OK;
}

/* A run ended for want of a finite value: where in the text there is none. */
static void tell_last_state(void *compiler, const double *number, uint32_t n) {
  Compiler *c = compiler;
  c->diags->list.n = 0; /* they have been printed */
  if (no_value_note(c->run, c->run_by, number, n)) print_messages(c);
}

enum { LARGE = 1000 }; /* coordinates: the memory of compiling them is not kept for the run */

/* run, plot and animate: what they draw becomes outputs of the scene and arguments of its simulator. */
static int do_run(Compiler *c) {
  const char *path;
  int status = prepare_run(c);
  if (status != STATUS_OK) return status;
  Units units = {0};
  status = lower_all(c, &units) ? make_simulator(c, &units, NULL, &path) : STATUS_MODEL;
  if (status != STATUS_OK) return status;
  if (writes_source(c)) return STATUS_USAGE;
  if (c->o.command == CMD_COST) give_reference(c, &units);
  fflush(stdout);
  print_messages(c); /* warnings: the simulator does not come back */
  if (c->picture.note) fprintf(stderr, "%s\n", c->picture.note);
  if (c->run && c->run->n <= LARGE) last_state_wait(c->arena, tell_last_state, c);
  execv(path, c->picture.argv.at);
  return fail_usage(arena_printf(c->arena, "cannot run %s; delete it, and it is built anew", path));
}

/* The scene with another set of effects, as a unit of its own. */
static IrUnit *lower_variant(Compiler *c, EffectList effects, unsigned *wants) {
  Eqns *e = derive_wanted(c, &(ModelChoice){.scene = c->o.scene, .only = &effects, .given = c->given.at, .ngiven = c->given.n});
  if (!e) return NULL;
  IrUnit *u = new_unit(c, e);
  *wants |= wants_of(e, &c->o); /* all of them are to run by the first one's method */
  unit_want(u, e, *wants);
  unit_add_scene(u, e);
  unit_hoist(u);
  return agrees(e, u, 0) ? u : NULL;
}

/* Makes a program of these variants, runs it, and reads what it measured. */
static int run_variants(Compiler *c, EffectStudy *s, const EffectSets *sets, const char *what, Measured **measured) {
  Toolchain tools;
  Units units = {0};
  unsigned wants = 0;
  const char *error = NULL, *path, *rest;
  char *said = NULL;
  for (uint32_t i = 0; i < sets->n; i++) {
    IrUnit *u = lower_variant(c, effects_of(s, sets->at[i]), &wants);
    if (!u) return STATUS_MODEL;
    vec_push(c->arena, &units, u);
  }
  if (!toolchain_find(c->arena, c->argv0, !c->o.no_gsl, &tools, &error)) return fail_usage(error);
  if (strcmp(what, "runs") == 0) tools.optimise = "-O0"; /* the same bits, and compiling is what takes time */
  Texts texts = program_texts(c, &units, tools.gsl);
  int status = make_program(c, &tools, &texts, NULL, &path);
  if (status != STATUS_OK) return status;
  char *const program = arena_strdup(c->arena, path), **argv = ARENA_ARRAY(c->arena, char *, c->picture.argv.n);
  memcpy(argv, c->picture.argv.at, c->picture.argv.n * sizeof *argv);
  argv[2] = arena_strdup(c->arena, what);
  status = toolchain_run_as(c->arena, program, argv, &said);
  *measured = effects_read(s, said, sets->n, &rest);
  fputs(rest, stderr);
  if (status == STATUS_OK && !*measured) return fail_usage("the simulator of `lagc effects` did not say what it measured");
  return status;
}

/* --accuracy: the smallest set of effects. */
static int find_least(Compiler *c, EffectStudy *s) {
  char *end;
  Measured *measured = NULL;
  s->accuracy = strtod(c->o.accuracy, &end);
  if (*end || !(s->accuracy > 0)) return fail_usage(arena_printf(c->arena, "--accuracy %s: a difference that does not matter, relative and positive; for example 1e-6", c->o.accuracy));
  if (!(s->error <= s->accuracy / 10)) {
    fprintf(stderr, "lagc: --accuracy %g: the error of integration, %.2g, is not well below it; add --tol with a smaller number, or --step\n", s->accuracy, s->error);
    return STATUS_RUN;
  }
  for (EffectSets sets = effects_try(s, NULL, NULL); sets.n;) {
    int status = run_variants(c, s, &sets, "runs", &measured);
    if (status != STATUS_OK) return status;
    EffectSets next = effects_try(s, &sets, measured);
    sets = next;
  }
  return STATUS_OK;
}

static int do_effects(Compiler *c) {
  int status = prepare_run(c);
  Model *m = status == STATUS_OK ? model_build(c->ast, &(ModelChoice){.scene = c->o.scene, .defines = c->o.defines.at, .ndefines = c->o.defines.n}) : NULL;
  EffectStudy *s = m ? effects_plan(m) : NULL;
  if (!s) return status == STATUS_OK ? STATUS_MODEL : status;
  status = run_variants(c, s, &s->variants, "report", &s->measured);
  if (status == STATUS_OK && c->o.accuracy) status = find_least(c, s);
  if (status != STATUS_OK) return status;
  StrBuf out = strbuf(c->arena);
  if (c->o.json) effects_json(s, &out);
  else effects_text(s, &out);
  return write_out(c, NULL, &out);
}

static int do_check(Compiler *c) {
  StrBuf out = strbuf(c->arena);
  c->told = strbuf(c->arena);
  if (!check_print(&(Deriver){derive_for, c}, c->ast, c->o.scene, c->o.allow_numeric, &out)) return STATUS_MODEL;
  sb_puts(&out, sb_text(&c->told));
  int status = write_out(c, NULL, &out);
  return c->diags->errors ? STATUS_MODEL : status;
}

/* The runtime has them: asked with `--method help` it prints its table, with `--method "help NAME"` one of them. */
static int help_methods(Compiler *c, const char *name) {
  const char *error = NULL, *path = methods_program(c->arena, c->argv0, !c->o.no_gsl, &error);
  char *argv[] = {"lagc", "--method", name ? arena_printf(c->arena, "help %s", name) : "help", NULL};
  if (!path) return fail_usage(error);
  execv(path, argv);
  return fail_usage(arena_printf(c->arena, "cannot run %s; delete it, and it is built anew", path));
}

static int do_help(Compiler *c) {
  StrBuf out = strbuf(c->arena);
  const char *topic = c->o.topic, *error;
  Name near;
  Methods methods = {0};
  if (topic && strcmp(topic, "methods") == 0) return help_methods(c, NULL);
  if (help_print(&out, topic, &near)) return write_out(c, NULL, &out);
  methods_list(c->arena, c->argv0, 1, &methods, &error); /* without a C compiler there are none */
  VEC(Name) names = {0};
  for (uint32_t i = 0; i < methods.n; i++) {
    if (strcmp(methods.at[i].name, topic) == 0) return help_methods(c, topic);
    vec_push(c->arena, &names, methods.at[i].name);
  }
  Name method = suggest(topic, names.at, names.n);
  near = near ? near : method;
  return fail_usage(near ? arena_printf(c->arena, "no help on `%s`: did you mean `%s`?", topic, near)
                         : arena_printf(c->arena, "no help on `%s`; `lagc help` lists the topics", topic));
}

static int do_completion(Compiler *c) {
  StrBuf out = strbuf(c->arena);
  if (c->o.command == CMD_COMPLETE) complete(&out, c->o.rest.at, c->o.rest.n, c->argv0);
  else completion_script(&out, c->o.topic);
  return write_out(c, NULL, &out);
}

static int do_cache(Compiler *c) {
  StrBuf out = strbuf(c->arena);
  cache_remove_remains(c->arena);
  if (c->o.clear) cache_clear(c->arena, &out);
  else cache_print(c->arena, &out);
  return write_out(c, NULL, &out);
}

static int do_command(Compiler *c) {
  switch (c->o.command) {
    case CMD_CHECK: return do_check(c);
    case CMD_DERIVE: return do_derive(c);
    case CMD_NOETHER: return do_noether(c);
    case CMD_EMIT: return method_is_known(c) ? do_emit(c) : STATUS_USAGE;
    case CMD_HEADER: return do_header(c);
    case CMD_BUILD: return method_is_known(c) ? do_build(c) : STATUS_USAGE;
    case CMD_RUN: case CMD_PLOT: case CMD_ANIMATE: case CMD_MODES: case CMD_LYAPUNOV: case CMD_COST: return do_run(c);
    case CMD_EFFECTS: return do_effects(c);
    case CMD_METHODS: case CMD_CACHE: case CMD_HELP: case CMD_VERSION: case CMD_COMPLETION: case CMD_COMPLETE: case CMD_NONE: case CMD_COUNT: break;
  }
  return STATUS_USAGE;
}

/* Numbers are folded as doubles. */
static int folds_digits(const Compiler *c) {
  if (!c->o.fix || !options_more_digits(&c->o)) return 1;
  fail_usage("--fix makes doubles of parameters: leave it out where --precision has more digits");
  return 0;
}

static int compile(Compiler *c) {
  c->sources = sources_new(c->arena);
  c->diags = diags_new(c->arena, c->sources);
  c->ast = ast_new(c->arena, interner_new(c->arena), c->sources, c->diags);
  int status = read_model(c);
  if (status == STATUS_OK) status = folds_digits(c) ? do_command(c) : STATUS_USAGE;
  print_messages(c);
  return c->diags->errors && status == STATUS_OK ? STATUS_MODEL : status;
}

static int run_lagc(Compiler *c, int argc, char **argv) {
  const char *error;
  c->argv0 = argv[0];
  if (!options_read(c->arena, argc, argv, &c->o, &error)) return fail_usage(error);
  if (c->o.command == CMD_HELP) return do_help(c);
  if (c->o.command == CMD_COMPLETION || c->o.command == CMD_COMPLETE) return do_completion(c);
  if (c->o.command == CMD_METHODS) return help_methods(c, NULL);
  if (c->o.command == CMD_CACHE) return do_cache(c);
  if (c->o.command == CMD_VERSION) {
    puts("lagc " LAGC_VERSION);
    return fflush(stdout) == 0 ? STATUS_OK : fail_usage("cannot write standard output");
  }
  return compile(c);
}

int main(int argc, char **argv) {
  ArenaConfig config = {.max_bytes = (size_t)MEMORY_LIMIT_MIB << 20};
  Compiler c = {.arena = arena_new(&config)};
  jmp_buf out_of_memory;
  int status;
  if (!c.arena) return fail_usage("out of memory");
  if (setjmp(out_of_memory)) {
    if (arena_hit_limit(c.arena)) fprintf(stderr, "lagc: the model needs more than the limit of %d MiB of memory\n", MEMORY_LIMIT_MIB);
    else fprintf(stderr, "lagc: out of memory\n");
    status = STATUS_USAGE;
  } else {
    arena_guard(c.arena, &out_of_memory);
    status = run_lagc(&c, argc, argv);
  }
  arena_free(c.arena);
  return status;
}
