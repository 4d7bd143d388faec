/* Requests of --observe, --measure, plot and animate, turned into outputs and measures of the scene and into arguments
 * of its simulator.
 *
 * In: the options and the parsed file. Expressions are parsed here; model_build resolves them like any output of a
 * scene, so mistakes in them are reported with their text and a caret. */
#pragma once

#include "commands/command_table.h"
#include "model/model.h"

typedef struct {
  VEC(CommandOutput) asked, measures;
  Section section;  /* Poincare section that chooses the rows; or none */
  Name scene;       /* scene of the run; NULL: the first */
  SceneList scenes; /* scenes that the command line names: a picture may show several */
  VEC(char *) argv; /* the simulator's, NULL-terminated */
  const char *error; /* cost --error: name of the output that is judged, "final" or "residual"; NULL: the state */
  int drawing;       /* 1: the drawing of the model is wanted */
  const char *note;  /* what was left out, or NULL */
} RunRequest;

/* --- settings.c: values on the command line. A simulator takes plain numbers in declared units; so inputs with a
 * formula or a table, and starts of rotations, are compiled in, and values with units or formulas become numbers.
 * Each returns 0 on a mistake, which is in ast->diags or *error. --- */

/* Parses the values of constants, -D. */
int settings_defines(Ast *ast, Define *defines, uint32_t n);

typedef VEC(CommandInput) GivenList;

/* Moves inputs with a formula or a table, and starts of rotations, from o->rest to *given; `all`: each name=value. */
int settings_compiled(Ast *ast, Options *o, int all, GivenList *given, const char **error);

/* Replaces values with a unit (`th=90[deg]`, `--until 2[min]`) and formulas (`th=pi/3`) in o->rest by numbers. */
int settings_units(Ast *ast, const Options *o);

/* Whether the text is a plain number. */
int text_is_number(const char *text);

/* A text on one line, without white space at its ends and with single spaces inside. */
const char *text_trimmed(Arena *a, const char *text, size_t n);

/* The first line of a record, which has the names of its columns; NULL, with *why. */
const char *data_head(Arena *a, const char *path, const char **why);

/* Returns 0 on a mistake, which *error or ast->diags describes. */
int run_request_prepare(RunRequest *p, Ast *ast, const Options *o, const char **error);
