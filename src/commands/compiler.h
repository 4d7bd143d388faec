/* One compilation, and the stages that commands share: text -> Ast -> Model -> Eqns -> ProgramSet.
 *
 * Functions that can fail say why: in c->diags, printed by main at the end, or on standard error by usage_error. */
#pragma once

#include "commands/command_table.h"
#include "commands/run_request.h"
#include "ir/program_set.h"
#include "mech/eqns.h"

/* Exit status: 0 ok, 1 bad model, 2 usage or files, 3 the run failed (a simulator's status). */
enum { STATUS_OK, STATUS_MODEL, STATUS_USAGE, STATUS_RUN };

typedef enum { JSON_FACTS, JSON_SCENES, JSON_SYMMETRIES, JSON_EXPECTS, JSON_UNITS, JSON_REPORT, JSON_LISTS } JsonList;

typedef struct KnownRun KnownRun;

/* Of a compilation for a smaller size than the one asked for (commands/small_sizes.h): what it would write, and the
 * size asked for as a multiple of its own and less it. */
typedef struct {
  StrBuf written;
  double times;
  int64_t more;
} SmallSize;

typedef struct {
  Arena *arena;
  Options o;
  const char *argv0;
  Sources *sources;
  Diags *diags;
  Ast *ast;
  RunRequest picture; /* requests of run, plot and animate */
  /* values, -D and --until of the command line, as a shell reads them: for commands that a report names */
  const char *given_words;
  GivenList given; /* values that the command line gives to names, for run, plot and animate */
  char *const *words; /* argv */
  KnownRun *known;    /* entry of this command in the cache (known_run.h) */
  StrBuf told;     /* comparisons with the text, for check --verbose */
  StrBuf json[JSON_LISTS]; /* lists of check --json (check_json.h) */
  const Eqns *run; /* equations of the scene that the command runs, */
  ProgramSet *run_by;  /* and their programs */
  SmallSize *small;    /* NULL: it is for the size asked for */
} Compiler;

/* Prints the messages so far; warnings about unused names too, if there is no error. */
void compiler_print_messages(const Compiler *c);
/* Appends them to the text instead. */
void compiler_messages(const Compiler *c, StrBuf *out);

/* "lagc: MESSAGE" on standard error. Returns STATUS_USAGE. */
int usage_error(const char *message);

/* Whether `path` is the model or a part of it, which an output would overwrite; reported. */
int compiler_is_source(Compiler *c, const char *path);

/* Writes the text to a file (NULL, "-": standard output), whole or not at all. Returns a STATUS. */
int compiler_write(Compiler *c, const char *path, const StrBuf *text);
/* The same of a C text with marks (emit/late_text.h). */
int compiler_write_c(Compiler *c, const char *path, const StrBuf *text);
/* The same of a report, unless an error was found while it was made. */
int compiler_report(Compiler *c, const char *path, const StrBuf *text);

/* An empty compilation, without sources. */
void compiler_begin(Compiler *c);
/* Reads the text of c->o.file, the first of c->sources. Returns a STATUS. */
int compiler_open(Compiler *c);
/* Parses it into c->ast. Returns a STATUS. */
int compiler_parse(Compiler *c);

/* required_derivatives.c: flags WANT_... (ir/program_set.h) that the methods of e's scene, of --method and of the
 * state of --resume need, and --with. */
const char *method_of_state(Arena *a, const char *path);
unsigned derivatives_required(const Eqns *e, const Options *o);
/* Derivatives, of those wanted, that `lagc cost` compiles in a part of --seconds, and that fit into `lagc page`. */
unsigned derivatives_afforded(unsigned wants, const Eqns *e, const ProgramSet *u, const Options *o);

/* Model of a choice of scene and effects, with the definitions of the command line; NULL with the reasons in c->diags.
 */
Model *compiler_model(Compiler *c, const ModelChoice *choice);
/* Equations of a choice of scene and effects; NULL with the reasons in c->diags. */
Eqns *compiler_derive(Compiler *c, const ModelChoice *choice);
/* The same of one scene (NULL: the first). */
Eqns *compiler_derive_scene(Compiler *c, const char *scene);
/* The same, regularised where the method that the command line or scene names needs an invertible mass matrix. */
Eqns *compiler_derive_wanted(Compiler *c, const ModelChoice *choice);
/* The same, for a report: their programs agree with the text. */
Eqns *compiler_derive_compared(Compiler *c, const ModelChoice *choice);
/* Runs work whose models and equations nobody needs afterwards: their memory is given back. */
void compiler_with_scratch(Compiler *c, void (*work)(Compiler *c, void *data), void *data);

ProgramSet *compiler_new_unit(Compiler *c, Eqns *e);
ProgramSet *compiler_unit_head(Compiler *c, Eqns *e); /* see unit_head */

/* Whether all programs of u are well formed and, for one of its scenes, compute what the text says; otherwise
 * reported: an internal error. */
int compiler_agrees(const Eqns *e, const ProgramSet *u, uint32_t scene);

/* Programs of one scene, compared with the text. hoists: derived parameters are taken out, as emitted models have
 * them. NULL with the reason in c->diags when a program is wrong: an internal error. */
ProgramSet *compiler_lower_scene(Compiler *c, Eqns *e, int hoists);

/* The same for an embedded header, with the consistent start in its scene. */
ProgramSet *compiler_lower_embedded(Compiler *c, Eqns *e);

/* Whether --method of emit and build is a method; reported if not. For a run the simulator judges. */
int compiler_knows_method(Compiler *c);
