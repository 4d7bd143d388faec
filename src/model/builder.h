/* The inside of model_build, shared by model.c, resolve.c and scene.c only. */
#ifndef LAGC_BUILDER_H
#define LAGC_BUILDER_H

#include "model/model.h"
#include "model/scope.h"

typedef enum { TODO, DOING, DONE } Progress;

/* A let or a function: evaluated when first needed. */
typedef struct {
  const AstStmt *stmt;
  Name effect;
  Progress progress;
  Expr value; /* 0 after an error */
  Dim dim;
  int condition;
  const SymId *args; /* of a function: LOCAL symbols */
  uint32_t nargs;
} Definition;

typedef struct {
  Name name;
  Num value;
} Constant;

typedef struct {
  const AstStmt *stmt;
  Name effect;
} Active;

typedef struct Builder Builder;
struct Builder {
  Ast *ast;
  Diags *diags;
  Arena *arena;
  ExprGraph *g;
  Model *m;
  Scope scope;
  VEC(Active) active; /* the statements that this scene uses */
  VEC(Definition) lets, functions;
  VEC(Constant) constants;
  VEC(Dim) dims; /* by SymId */
  const Define *defines;
  uint32_t ndefines;
  const AstStmt **chain; /* the scene and those it is like, oldest first; NULL-terminated */
  int unitless;    /* no name has a unit: nothing is checked */
  AstId stand_in;  /* a node that stands for `stands_for` (see model_reresolve), or 0 */
  Expr stands_for;
};

/* Where an expression stands decides what may be in it. */
typedef enum {
  IN_CONST,    /* numbers and earlier constants */
  IN_PARAM,    /* and earlier parameters */
  IN_START,    /* and all parameters */
  IN_INPUT,    /* and t */
  IN_DYNAMICS, /* everything but q'' and z' */
  IN_OBSERVE   /* everything */
} Context;

typedef struct {
  Expr e;   /* 0 after an error: reported already */
  Dim dim;
  int bare;      /* made of numbers alone: takes on the unit of what it is given to */
  int condition; /* true or false, no number */
} Value;

/* The value of an expression; errors are reported and give e = 0. */
Value resolve(Builder *b, AstId id, Context where, Name effect);

/* A value given to something with a unit: a bare number is multiplied by that unit, anything else
 * must have its dimension. 0 after an error. resolve_in resolves it first. */
Expr value_in(Builder *b, Value v, Span span, const Unit *unit);
Expr resolve_in(Builder *b, AstId id, Context where, Name effect, const Unit *unit);

/* A number known now (spans, steps, tolerances); NAN after an error. */
double resolve_number(Builder *b, AstId id, const Unit *unit, const char *what);

/* Evaluates a let or a function that nothing has needed so far. */
void resolve_definition(Builder *b, EntKind kind, uint32_t index);

/* The entity a name stands for; unknown and ambiguous names are reported. `declare` is the statement
 * that would declare what is wanted ("state"), or NULL where it may be anything. */
const Entity *resolve_name(Builder *b, Name name, Span span, Name effect, const char *declare);

/* Warns when a unit is also the name of a constant: `th [N]` is th in newtons. */
void warn_unit_is_constant(Builder *b, const AstUnit *u);

/* Reports a value that is not of the sign that its parameter is declared to have. */
void check_sign(Builder *b, const Param *p, Span span);

/* advice.c: adds a way out to the message about an unknown name, or an unknown `effect.name`. */
void advise_unknown_name(Builder *b, Name name, Span span, Name effect, const char *declare);
void advise_unknown_member(Builder *b, Name effect, Name name);

/* The active statement that declares the name, before or after; NULL when there is none. */
const AstStmt *declared_in_use(const Builder *b, Name name, Name effect);

/* "not yet: what" */
void not_yet(Builder *b, Span span, const char *what);

/* The source text of an expression on one line, without comments; and the same with its middle left
 * out where it is long. */
const char *ast_text(const Builder *b, AstId id);
const char *ast_short(const Builder *b, AstId id);
Name intern_printf(Builder *b, const char *fmt, ...) __attribute__((format(printf, 2, 3)));

/* The unit of a dimension in SI, for quantities that were declared without one. */
Unit unit_of_dim(Builder *b, Dim d);

/* scene.c: which statements are active (those of the effect `also` too), and the scene's contents. */
void scene_select(Builder *b, const ModelChoice *choice);
void scene_build(Builder *b, const ModelChoice *choice);

#endif
