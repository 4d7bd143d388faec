/* Ast: a .lag file as it was written. Names are not resolved, kinds are not checked, nothing is
 * folded: every later pass can still point at the user's own text.
 *
 * Expressions live in one array and are named by AstId; children come before parents, and the nodes of one
 * expression are contiguous (the parser builds bottom-up), so passes are loops. Statements are structs in lists. Id
 * 0 means "absent". */
#pragma once

#include <string.h>

#include "base/diag.h"
#include "base/intern.h"
#include "base/num.h"

typedef uint32_t AstId;

/* X(kind, text of the operator or NULL) */
#define AST_EXPR_KINDS(X)                                                                       \
  X(AST_NUM, NULL)      /* 1.5              number                                           */ \
  X(AST_STRING, NULL)   /* "file.csv"       name = the text without quotes                   */ \
  X(AST_NAME, NULL)     /* th               name                                             */ \
  X(AST_INDEX, NULL)    /* x[i, j]          a = x, args = indices                            */ \
  X(AST_MEMBER, NULL)   /* r.x              a, name = "x"                                    */ \
  X(AST_PRIME, NULL)    /* th'              a; one node a prime                              */ \
  X(AST_UNIT, NULL)     /* 90 [deg]         a, unit                                          */ \
  X(AST_NEG, "-")       /* -a                                                                */ \
  X(AST_NOT, "not")     /* not a                                                             */ \
  X(AST_ADD, "+")       /* a + b                                                             */ \
  X(AST_SUB, "-")                                                                               \
  X(AST_MUL, "*")                                                                               \
  X(AST_DIV, "/")                                                                               \
  X(AST_POW, "^")                                                                               \
  X(AST_LT, "<")                                                                                \
  X(AST_LE, "<=")                                                                               \
  X(AST_GT, ">")                                                                                \
  X(AST_GE, ">=")                                                                               \
  X(AST_EQ, "==")                                                                               \
  X(AST_NE, "!=")                                                                               \
  X(AST_AND, "and")                                                                             \
  X(AST_OR, "or")                                                                               \
  X(AST_CALL, NULL)     /* f(x, y)          name, args; also if(c, a, b)                     */ \
  X(AST_AT, NULL)       /* th'(0)           a at time b; x(0) is an AST_CALL                 */ \
  X(AST_SUM, NULL)      /* sum(i in 1..N, e)      name = i, a = lo, b = hi, c = e            */ \
  X(AST_PRODUCT, NULL)  /* product(i in 1..N, e)  likewise                                   */ \
  X(AST_TUPLE, NULL)    /* (a, b, c)        args; two or more                                */ \
  X(AST_LIST, NULL)     /* {a, b, c}        args                                             */ \
  X(AST_BIND, NULL)     /* i in 1..N        inside an index of let, param or start: name, a, b */ \
  X(AST_ERROR, NULL)    /* placeholder where the parser reported an error                    */

#define AST_ENUM_(kind, text) kind,
typedef enum { AST_EXPR_KINDS(AST_ENUM_) } AstKind;
#undef AST_ENUM_

/* One factor of a unit: [kg*m^2/s] is kg^1 m^2 s^-1. name "1" is the dimensionless unit. */
typedef struct {
  Name name;
  Num exponent;
  Span span;
} AstUnitFactor;

typedef struct {
  const AstUnitFactor *at;
  uint32_t n; /* 0: no unit was written */
  Span span;
  const char *text; /* as written, without brackets */
} AstUnit;

typedef struct {
  AstKind kind;
  Span span;     /* the whole expression, without surrounding parentheses */
  Span op_span;  /* the operator, or the name of a call */
  AstId a, b, c;
  AstId next;    /* next element of the list (args) that holds this node; 0: the last */
  AstId args;    /* first of a list of arguments */
  AstId first;   /* lowest id of this expression: its nodes are first..own id */
  Name name;
  Num number;
  AstUnit unit;
} AstExpr;

typedef enum {
  /* declarations */
  STMT_MODEL,       /* name, doc */
  STMT_INCLUDE,     /* doc = the path */
  /* from here to STMT_FUNCTION: declarations of names. name, dims, type (vec2, vec3, rotation or NULL), unit,
   * periodic */
  STMT_COORD,
  STMT_MOMENTUM,    /* name, dims, type, unit, lhs = coordinate, rhs = its name p_x, args = the action p*x' */
  STMT_PARAM,       /* name, dims, type (vec2, vec3 or NULL), unit (of the name, or its value), rhs, sign */
  STMT_CONST,       /* name, unit, rhs */
  STMT_INPUT,       /* name, unit, rhs */
  STMT_STATE,       /* name, dims, type, unit */
  STMT_LET,         /* name, dims (numbers, or AST_BINDs), rhs */
  STMT_FUNCTION,    /* name, args (AST_NAMEs), rhs */
  STMT_NETWORK,     /* name, args (AST_NAMEs), rhs = path of its weights or 0, dims = layers, type = activation */
  STMT_HAMILTONIAN, /* rhs; lhs: `energy`, which a model that also gives L claims to be rhs */
  STMT_LAGRANGIAN,  /* rhs; likewise the next three */
  STMT_KINETIC,
  STMT_POTENTIAL,
  STMT_DISSIPATION,
  STMT_FORCE,       /* lhs, rhs; of a friction also args: its velocity, size, and static limit, if it has one */
  STMT_FLOW,        /* lhs, rhs */
  STMT_CONSTRAINT,  /* name, lhs, rhs; args = the condition while which it holds, or 0 */
  STMT_SYMMETRY,    /* name, args (AST_NAMEs), doc, body of STMT_MAP and STMT_FOR */
  STMT_CANONICAL,   /* name, args (AST_NAMEs of the new variables, or 0), doc, body of STMT_SET and STMT_FUNCTION */
  STMT_MAP,         /* lhs -> rhs */
  STMT_EXPECT,      /* name or NULL, lhs, rhs */
  STMT_EVENT,       /* name, lhs, direction, body of STMT_SET and STMT_STOP */
  STMT_CONTACT,     /* name, lhs (>= 0), rhs = restitution; with friction also args: options, see ast_option_value */
  /* name, lhs, rhs, args: options as of a contact; lhs 0: a friction whose size contains a multiplier */
  STMT_GUIDE,
  STMT_OBSERVE,     /* name, unit, rhs */
  STMT_DRAW,        /* name = the shape, dims, lhs = what it draws or 0, rhs: of `lhs = rhs`; args: options */
  STMT_FOR,         /* name, lhs = lo, rhs = hi, body; alone: the range stood in an index of its one statement */
  STMT_EFFECT,      /* name, doc, body */
  STMT_REQUIRES,    /* name */
  STMT_EXCLUDES,    /* name */
  STMT_SCENE,       /* name, doc, body */
  /* inside a scene */
  STMT_START,       /* lhs, rhs, exactly */
  STMT_EXACT,       /* lhs, rhs */
  STMT_SET,         /* lhs = rhs: a parameter's value, an event's action, an option */
  STMT_USE,         /* name, body of STMT_SET; "none" clears */
  STMT_SPAN,        /* rhs */
  STMT_METHOD,      /* name, body of STMT_SET */
  STMT_TOLERANCE,   /* rhs */
  STMT_OUTPUT,      /* args = expressions, rhs = every (0: absent) */
  STMT_MONITOR,     /* lhs = quantity, rhs = limit */
  STMT_MEASURE,     /* name, rhs */
  STMT_LIKE,        /* name */
  /* inside an event */
  STMT_STOP
} AstStmtKind;

typedef enum { START_PLAIN, START_EXACTLY, START_GUESS } AstStartKind; /* `exactly` of a start */
typedef enum { SIGN_ANY, SIGN_GT, SIGN_GE, SIGN_LT, SIGN_LE } AstSign; /* param ... > 0 */
/* the last: a kick, whose lhs is its period */
typedef enum { CROSS_BOTH, CROSS_RISING, CROSS_FALLING, AT_EQUAL_TIMES } AstDirection;

typedef struct AstStmt AstStmt;
struct AstStmt {
  AstStmtKind kind;
  Span span, name_span;
  Name name;
  const char *doc;  /* text without quotes, or NULL */
  AstId lhs, rhs;
  AstId dims;       /* first of a list of sizes or indices */
  AstId args;       /* first of a list */
  Name type;
  AstUnit unit;
  AstSign sign;
  AstDirection direction;
  int periodic, exactly, alone;
  AstStmt *body, *last; /* a list, and its end */
  AstStmt *next;
};

/* A family of coordinates with one index, by which neighbours may be found; components 0: numbers. */
typedef struct {
  Name name;
  uint32_t components;
} AstPlace;

/* sum(j in near(i, cut, box), ...): the condition, and the members and sides of the box in it, by component. */
typedef struct {
  Name i;
  AstId sum, test, cut, at_i[3], at_j[3], box[3];
  uint32_t n;
  Span span;
} AstNear;

/* sum(j in ..., ..., by tree(theta)). */
typedef struct {
  AstId sum, theta;
  Span span;
} AstFar;

typedef struct {
  Arena *arena;
  Interner *names;
  Sources *sources;
  Diags *diags;
  VEC(AstExpr) exprs;        /* exprs.at[0] is unused */
  VEC(AstPlace) places;
  VEC(AstNear) nears;
  VEC(AstFar) fars;
  AstStmt *first, *last;     /* the file's statements, includes already spliced in */
  AstStmt *composed;         /* functions that functions.def defines by a text; NULL: not yet parsed */
  VEC(const AstStmt *) called; /* those that expressions before `noted` call, in order of first calls */
  AstId noted;
  struct FileIndex *index;   /* statements by name (model/file_index.c); NULL: not yet made */
} Ast;

Ast *ast_new(Arena *a, Interner *names, Sources *sources, Diags *diags);

static inline const AstExpr *ast_expr(const Ast *ast, AstId id) { return &ast->exprs.at[id]; }

/* The value of the option `word = value` of a contact; 0: there is none. */
static inline AstId ast_option_value(const Ast *ast, const AstStmt *st, const char *word) {
  for (AstId i = st->args; i; i = ast_expr(ast, i)->next)
    if (strcmp(ast_expr(ast, i)->name, word) == 0) return ast_expr(ast, i)->args;
  return 0;
}

/* Number of arguments or elements in the list that begins with `first`. */
static inline uint32_t ast_list_length(const Ast *ast, AstId first) {
  uint32_t n = 0;
  for (; first; first = ast_expr(ast, first)->next) n++;
  return n;
}
