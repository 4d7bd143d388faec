/* Simulators: programs of all scenes of a model, as C texts, compiled and linked with the runtime. */
#pragma once

#include "commands/compiler.h"
#include "emit/emit_model.h"
#include "toolchain/toolchain.h"

/* The scenes of a file as units: scenes with the same effects and inputs share one. */
typedef VEC(ProgramSet *) Units;
typedef VEC(SourceText) Texts;

/* Reads what the command line gives to a simulator: values of names, expressions to draw. Returns a STATUS. */
int simulator_prepare(Compiler *c);

/* Lowers the scenes to `units`: all, or the one that the command line asks something of. 0 with the reasons in
 * c->diags. */
int simulator_lower(Compiler *c, Units *units);

/* The C texts of a program of these units. */
Texts simulator_texts(Compiler *c, const Units *units, ProgramKind kind);

/* The same program as bytes for liblag's evaluator. */
StrBuf simulator_bytes(Compiler *c, const Units *units);

/* The toolchain and the kind of program that the command line asks for. Returns a STATUS. */
int simulator_tools(Compiler *c, const Units *units, const char *output, Toolchain *tools, ProgramKind *kind);

/* How a run goes that lag-run evaluates. */
typedef struct {
  const char *evaluator; /* path of lag-run; NULL: the run is compiled */
  /* names in the cache of the simulator and of the model's library, which take its place once they are there; NULL:
   * --compile never */
  const char *simulator, *library;
  StrBuf bytes; /* the programs */
} EvaluatedRun;

/* evaluation.c: lag-run in place of a simulator, where --compile allows it, the command line asks for nothing that is
 * linked, and the cache has no simulator. Returns a STATUS. */
int simulator_evaluate(Compiler *c, const Units *units, EvaluatedRun *e);
/* lag-run for programs that this command line need not compile; NULL: it must. */
const char *simulator_evaluator(Compiler *c, const Toolchain *tools);
/* The simulator that is compiled by now; NULL: there is none. */
const char *simulator_compiled(Compiler *c, const EvaluatedRun *e);
/* Gives lag-run, which this process becomes, what it runs: a library, or programs, of which one is compiled meanwhile
 * (units NULL: derived there). Returns a STATUS. */
int simulator_hand_over(Compiler *c, const EvaluatedRun *e, const Units *units);
/* The units of a known run, whose text has not been parsed. 0 with the reasons in c->diags. */
int simulator_derive_again(Compiler *c, Units *units);

/* Makes a program from the texts at `output`, or in the cache (NULL), and gives its path. Returns a STATUS. */
int simulator_make(Compiler *c, const Toolchain *tools, const Texts *texts, const char *output, const char **path);

/* The same from units, with the precision and the libraries that the command line asks for. */
int simulator_of_units(Compiler *c, const Units *units, const char *output, const char **path);

/* Whether mpirun or srun started this sweep as another process than the first one, which prints the warnings. */
int simulator_is_later_rank(const Compiler *c);

/* Surroundings of the command, beside text and words: other processes of a sweep, the lanes of this machine. */
const char *simulator_surroundings(const Compiler *c);

/* The words of the command line that say which motion is run: scene, name=value, --until. */
OptionTexts simulator_values(Compiler *c);

/* A simulator with more digits than doubles have, in the cache: long double, or quadruple precision where that is no
 * more than a double; NULL where there is neither. */
const char *simulator_precise(Compiler *c, const Units *units);
/* One with quadruple precision where the one above has long doubles; NULL elsewhere. */
const char *simulator_quad(Compiler *c, const Units *units);
