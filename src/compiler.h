/* One compilation: what the commands share. */
#ifndef LAGC_COMPILER_H
#define LAGC_COMPILER_H

#include "cli/options.h"
#include "cli/toolchain.h"
#include "ir/unit.h"
#include "mech/eqns.h"
#include "picture.h"
#include "settings.h"

/* Exit status. */
enum { STATUS_OK, STATUS_MODEL, STATUS_USAGE, STATUS_RUN };

typedef struct {
  Arena *arena;
  Options o;
  const char *argv0;
  Sources *sources;
  Diags *diags;
  Ast *ast;
  Picture picture; /* of run, plot and animate */
  GivenList given; /* to them */
} Compiler;

typedef VEC(IrUnit *) Units;
typedef VEC(SourceText) Texts;

/* Prints what was reported. */
void compiler_messages(const Compiler *c);
/* "lagc: message" to the standard error; STATUS_USAGE. */
int fail_usage(const char *message);

/* Whether --dump names the stage. */
int compiler_dumps(const Compiler *c, const char *stage);

/* Whether the model is made of the file at path, which must not be written then; said where it is. */
int compiler_reads(Compiler *c, const char *path);
/* Writes text to path (NULL: to standard output). A status, after a message where it is not STATUS_OK. */
int compiler_write(Compiler *c, const char *path, const StrBuf *text);

/* The equations of what was chosen; NULL with the reasons in c->diags. */
Eqns *compiler_derive(Compiler *c, const ModelChoice *choice);
/* Their unit, without scenes. */
IrUnit *compiler_unit(Compiler *c, Eqns *e);

/* Reads what a simulator is told, and the names that it gives values to. A status, as above. */
int compiler_prepare(Compiler *c);

/* The C of a program with all scenes of these units. */
Texts compiler_texts(Compiler *c, const Units *units, int gsl);
/* A program from these texts at `output`, or in the cache (NULL): *path. A status, as above. */
int compiler_make(Compiler *c, const Toolchain *tools, const Texts *texts, const char *output, const char **path);

/* weigh.c: the command effects. A status. */
int do_effects(Compiler *c);

#endif
