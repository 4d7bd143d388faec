/* ProgramSet -> C: for the runtime, the functions and tables of lag_model.h; or one self-contained C99/C++ header
 * for programs that embed the model. */
#pragma once

#include "base/strbuf.h"
#include "ir/program_set.h"

/* Identifier of the lag_model for a model that the user called `name`; free in <math.h> and in the emitted file. */
const char *model_id(Arena *a, const char *name);

/* Texts of emit_model, emit_accel and emit_header have marks, which late_text_write replaces. */

/* A model by itself; one whose text has all that it needs of the runtime's headers but lag_model.h; one of a program
 * whose main() calls NAME_names(), if it has long tables (program_names_late). */
typedef enum { MODEL_PLAIN, MODEL_ALONE, MODEL_OF_MAIN } ModelTextKind;

/* Appends one file: a lag_model called NAME (a C identifier), and a lag_scene NAME_scene for each scene. */
void emit_model(const ProgramSet *u, const char *name, ModelTextKind kind, StrBuf *out);

/* Appends only the function that computes the accelerations. */
void emit_accel(const ProgramSet *u, StrBuf *out);

/* Kind of a program, a sum: a simulator with main(), with the gsl-* methods, with pictures as PNG, with rows as
 * HDF5, with MPI, with models also compiled for lanes; or a shared library. */
typedef enum {
  PROGRAM_PLAIN, PROGRAM_WITH_GSL = 1, PROGRAM_WITH_PNG = 2, PROGRAM_WITH_HDF5 = 4, PROGRAM_WITH_MPI = 8,
  PROGRAM_LIBRARY = 16,
  PROGRAM_WITH_LANES = 32
} ProgramKind;

/* Whether programs of this kind write the names of families when they begin. */
static inline int program_names_late(ProgramKind kind) { return !(kind & (PROGRAM_LIBRARY | PROGRAM_WITH_LANES)); }

/* Appends the main file of a program: a lag_program of the scenes of n units, and main() or lag_library(). names[i]:
 * the name of units[i] in emit_model. */
void emit_program(const ProgramSet *const *units, const char *const *names, uint32_t n, ProgramKind kind, StrBuf *out);

/* Appends the same program as bytes, which runtime/evaluator executes: all but what lanes need. */
void emit_bytes(const ProgramSet *const *units, const char *const *names, uint32_t n, StrBuf *out);

/* Appends the file that compiles a unit's text, in the file `text`, once more for vectors of so many doubles, where
 * the processor may have them. */
void emit_lanes(const ProgramSet *u, const char *name, const char *text, int lanes, StrBuf *out);

/* Parts of a header besides the functions of every header. */
enum {
  PART_MASS = 1, PART_INVERSE = 2, PART_JAC = 4, PART_LINEAR = 8, PART_PARAMS = 16, PART_CONSTRAINTS = 32,
  PART_EVENTS = 64, PART_NAMES = 128, PART_RHS = 256, PART_GSL = 512, PART_CVODE = 1024, PART_ARKODE = 2048,
  PART_IDA = 4096, PART_CASADI = 8192, PART_OUTPUTS = 16384,
  PART_PATH = 32768, /* internal, for FMUs: derivatives of outputs; events along steps */
  PART_OUTPUT_JACOBIAN = 65536, PART_ADJOINT = 131072
};
typedef struct {
  const char *prefix; /* identifier with which names begin; NULL: from the name */
  unsigned parts;     /* PART_... */
  unsigned methods;   /* bit i: method i of header_steps.c */
  /* 1: with the internal function _follow(p, given): formulas of the parameters that given[i] leaves out */
  int follows;
} HeaderParts;

/* Programs WANT_... that the parts of a list `mass,rk45`, or `gsl,cvode`, need; list may be NULL. */
unsigned header_wants(const char *list);

/* Whether _moreau_step follows friction of joints, beside contacts or without. */
int header_rubs(const ProgramSet *u);

/* Adds the words of a known list; `all` stands for all that the model has, a library for what its callbacks call and
 * the model has. 0: *error says what the model lacks for one of them. */
int header_parts(const ProgramSet *u, const char *list, HeaderParts *parts, const char **error);

/* emit_header.c: appends the header of the unit's first scene. Its names begin with the prefix, or with `name`
 * turned into an identifier, in upper or lower case. equations: text for the head comment, or NULL. */
void emit_header(const ProgramSet *u, const char *name, HeaderParts parts, const char *equations, StrBuf *out);
