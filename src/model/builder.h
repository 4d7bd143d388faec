/* The inside of model_build, shared by model.c, resolve.c and scene.c only. */
#ifndef LAGC_BUILDER_H
#define LAGC_BUILDER_H

#include "model/model.h"
#include "model/scope.h"

typedef enum { TODO, DOING, DONE } Progress;

/* Where an expression stands decides what may be in it. */
typedef enum {
  IN_CONST,    /* numbers and earlier constants */
  IN_PARAM,    /* and earlier parameters */
  IN_START,    /* and all parameters */
  IN_INPUT,    /* and t */
  IN_DYNAMICS, /* everything but q'' and z' */
  IN_OBSERVE   /* everything */
} Context;

/* A number, or a vector of n = 2 or 3 components with one dimension. */
typedef struct {
  union {
    Expr e; /* 0 after an error: reported already */
    Expr at[3];
  };
  Dim dim;
  int bare;      /* made of numbers alone: takes on the unit of what it is given to */
  int condition; /* true or false, no number */
  uint32_t n;    /* 0: a number */
} Value;

/* What an index stands for, inside `for`, `sum`, and definitions with an index. */
typedef struct {
  Name name;
  int64_t at;
} IndexVar;

typedef VEC(IndexVar) IndexVars;

/* A let, a member of a family of lets, or a function: evaluated when first needed. */
typedef struct {
  const AstStmt *stmt;
  Name name, effect;
  Progress progress;
  Value value; /* e is 0 after an error */
  const SymId *args; /* of a function: LOCAL symbols */
  uint32_t nargs;
  IndexVar index[2]; /* of a member: its indices, by name where the let binds one */
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
  Scope scope, members;
  IndexVars index; /* of the `for` around the statement in hand */
  VEC(struct Eval *) idle; /* evaluations to use again */
  VEC(Expr) scratch;
  uint32_t *start_of; /* place in the scene's starts, from 1, by SymId */
  Expr *seeds; /* what each symbol becomes under d/dt, for nseeds symbols */
  uint32_t nseeds;
  ExprMap rates; /* the time derivatives of definitions */
  EntKind needed_kind; /* the definition that an evaluation waits for */
  uint32_t needed;
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

/* The value of an expression; errors are reported and give e = 0. */
Value resolve(Builder *b, AstId id, Context where, Name effect);

/* A value given to something with a unit: a bare number is multiplied by that unit, anything else
 * must have its dimension. 0 after an error. resolve_in resolves it first. */
Value values_in(Builder *b, Value v, Span span, const Unit *unit);
Expr value_in(Builder *b, Value v, Span span, const Unit *unit);
Expr resolve_in(Builder *b, AstId id, Context where, Name effect, const Unit *unit);

/* The value of member `at` of a family (of all its components where it is a family of vectors); primes
 * are taken of it. Indices must be in range: see index_in_range, which reports where they are not. */
Value resolve_member(Builder *b, const Entity *e, const int64_t *at, uint32_t primes, Span span, Context where);
int index_in_range(Builder *b, const Entity *e, const int64_t *at, Span span);

/* Position of a member, in its model's array, behind the family's first. */
uint32_t member_offset(const Entity *e, const int64_t *at);

/* The next member, row by row; 0 after the last. */
int next_member(const Entity *e, int64_t *at);

/* "th[2]", "u[2,1]" */
Name member_name(Builder *b, Name name, const int64_t *at, uint32_t ndims);

/* The entity of member `at` where members are declared one by one, or NULL. */
const Entity *find_member(const Builder *b, const Entity *e, const int64_t *at);

/* A whole number known when compiling: an index, or the end of a range. 0, reported, when it is none. */
int resolve_whole(Builder *b, AstId id, Name effect, int64_t *out);

/* Whether a range is short enough to be written out; reported where it is not. */
int range_fits(Builder *b, int64_t from, int64_t to, Span span);

/* The ends of a range; at most RANGE_MAX members. */
enum { RANGE_MAX = 10000000 };
int resolve_range(Builder *b, AstId lo, AstId hi, Name effect, int64_t *from, int64_t *to);

/* The indices of a place, `[2]` or `[i in 1..N]`, as ranges (from == to where it is one number). */
typedef struct {
  uint32_t n;
  Name name[2]; /* NULL: a number */
  int64_t lo[2], hi[2];
} IndexRange;
int resolve_indices(Builder *b, AstId list, Name effect, IndexRange *out);

/* "a number", "a vector of 3 components" */
const char *shape_text(const Builder *b, uint32_t n);

/* Calls fn for each statement that `for` around it makes of st, with b->index set. */
typedef void StatementFn(Builder *b, const AstStmt *st, Name effect, void *data);
void each_statement(Builder *b, const AstStmt *st, Name effect, StatementFn *fn, void *data);

/* What a statement names: `drag.c`, `m[i in 1..N]`, `r[2].x'`. */
typedef struct {
  AstId stem;      /* the name, or effect.name */
  uint32_t primes;
  int part;        /* the component; -1: all there are */
  AstId indices;   /* 0: the whole family */
  int wrong;       /* it is not of this form */
} Target;
Target read_target(const Builder *b, AstId id);

/* The elements of a list that gives a family its values, and the unit behind it: `{1, 3} [kg]`. NULL:
 * it is no list. */
const AstExpr *list_behind(const Builder *b, AstId id, const AstUnit **unit);

/* Gives what the place names, of entity e, its values: `give` is called for each scalar, with its place
 * in the model's array. `unit` tells in what unit a scalar takes bare numbers. */
typedef struct {
  const Unit *(*unit)(Builder *b, uint32_t scalar, void *data);
  void (*give)(Builder *b, uint32_t scalar, Expr value, Span span, void *data);
  void *data;
} Giver;
void assign_values(Builder *b, const Target *p, const Entity *e, AstId lhs, AstId rhs, const Giver *giver);

/* output.c: adds what an expression puts out to the scene's outputs. The place of the one number that
 * it is; -1 when it is more, or after an error. */
int add_outputs(Builder *b, AstId id);

/* The same under a name of the caller's choice. */
int add_outputs_as(Builder *b, AstId id, Name label);

/* declare.c: the declarations of a statement. */
void declare_statement(Builder *b, const AstStmt *st, Name effect, void *data);
SymId declare_symbol(Builder *b, SymKind kind, uint32_t index, Name name, ExprSign sign, Dim dim);

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
