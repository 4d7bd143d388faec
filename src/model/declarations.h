/* Declarations: names of a model, and the text of its definitions. The self-check (self_check/) evaluates the text
 * from this table, by code of its own. */
#pragma once

#include "model/scope.h"
#include "model/units.h"
#include "syntax/ast.h"

enum { ROTATION = 4 }; /* components of a rotation: the unit quaternion w, x, y, z */

/* Letter of component k of a value of n components: xyz, or wxyz for a rotation. */
static inline char component_letter(uint32_t n, uint32_t k) { return "wxyz"[k + (n != ROTATION)]; }

/* Current value of an index variable of `for`, `sum`, or a definition with an index. */
typedef struct {
  Name name;
  int64_t at;
} IndexVar;

typedef VEC(IndexVar) IndexVars;

/* A let, an observable (or one member of a family of them), or a function. */
typedef struct {
  const AstStmt *stmt;
  Name name, effect;
  IndexVar index[2]; /* indices of a family member; name NULL: a number in the text */
  const IndexVar *around; /* observables only: indices of the enclosing `for` */
  uint32_t naround;
  int64_t range[2]; /* of the only index; both 0: not known */
  int composed; /* a function of functions.def that is defined by its text */
} Definition;

typedef VEC(Definition) Definitions;

typedef struct {
  Name name, effect;
  AstId given; /* expression of the file, or of -D; a bare number is in `unit` */
  Unit unit;
} Constant;

typedef VEC(Constant) Constants;

/* A statement that the scene uses, and the effect around it. */
typedef struct {
  const AstStmt *stmt;
  Name effect;
} Active;

typedef VEC(Active) Actives;

typedef VEC(uint32_t) Rotations;

typedef struct Declarations {
  Ast *ast;
  Diags *diags;
  Dims *dims;
  Scope scope, members;
  Scope constraints;   /* constraints by name; index of the first component in Model.constraints */
  Rotations rotations; /* index of each rotation's first coordinate, w */
  Actives active;
  Definitions lets, functions, observes; /* observes[i] belongs to Model.observes[i] */
  Constants constants;
} Declarations;

/* Offset of a member from the family's first scalar, in the model's array. */
uint32_t member_offset(const Entity *e, const int64_t *at);

/* Name of a family member: "th[2]", "u[2,1]". */
Name member_name(const Ast *ast, Name name, const int64_t *at, uint32_t ndims);

/* The other side of a guide on a surface, or its slip (syntax/ast_build.h: stmts_guide); NULL: e is none. */
const Entity *other_side(const Scope *constraints, Ast *ast, const Entity *e);

/* Entity of member `at` of a family of lets or observables, or NULL. members: Declarations.members. */
const Entity *find_member(const Ast *ast, const Scope *members, const Entity *e, const int64_t *at);
