/* Builders of the Ast, called by the grammar's actions, one function a rule. Builders never fail: a
 * mistake is reported, and a node that later passes can walk over is returned. */
#pragma once

#include "syntax/ast.h"

typedef struct {
  Name name;
  Span span;
} Ident;

typedef struct {
  AstId first, last;
} AstList;

typedef struct {
  AstStmt *first, *last;
} StmtList;

typedef struct {
  const char *text; /* NULL: none was written */
  Span span;
} AstText;

/* ---- expressions (ast.c); `span` is the whole, `op` the operator or name ---- */
AstId ast_number(Ast *ast, Span span, Num number);
AstId ast_string(Ast *ast, AstText text);
AstId ast_name(Ast *ast, Ident name);
AstId ast_declared(Ast *ast, Ident name); /* an AST_NAME that is declared here */
AstId ast_unary(Ast *ast, AstKind kind, Span span, Span op, AstId a);
AstId ast_binary(Ast *ast, AstKind kind, Span span, Span op, AstId a, AstId b);
AstId ast_index(Ast *ast, Span span, AstId a, AstList indices);
AstId ast_member(Ast *ast, Span span, AstId a, Ident member);
AstId ast_prime(Ast *ast, Span span, Span op, AstId a);
AstId ast_unit(Ast *ast, Span span, AstId a, AstUnit unit);
AstId ast_call(Ast *ast, Span span, Ident function, AstList args);
AstId ast_option(Ast *ast, Span span, const char *word, AstId value); /* word = value, a call of that name */
AstId ast_at(Ast *ast, Span span, AstId a, AstId time);
/* `op(index in lo..hi, body)` */
typedef struct AstTurns {
  Ident index;
  AstId lo, hi;
} AstTurns;
/* Copy of an expression, behind all others. */
AstId ast_copy(Ast *ast, AstId id);
AstId ast_reduce(Ast *ast, AstKind kind, Span span, Span op, AstTurns over, AstId body);
/* near_sum.c: sum(index in near(...), body); range: the expression behind `in`. */
AstId ast_near(Ast *ast, Span span, Ident index, AstId range, AstId body, Span op);
/* The same as a range of members, AST_BIND. */
AstId ast_near_bind(Ast *ast, Span span, Ident index, AstId range);
/* far_sum.c: sum(index in lo..hi, body, by way(theta)). */
typedef struct {
  Ident by, way;
  AstId theta;
} FarWay;
AstId ast_far(Ast *ast, Span span, Span op, AstTurns turns, AstId body, FarWay how);
AstId ast_collect(Ast *ast, AstKind kind, Span span, AstList items); /* AST_LIST */
AstId ast_bind(Ast *ast, Span span, Ident index, AstId lo, AstId hi);

AstId ast_tuple(Ast *ast, Span span, AstId head, AstList rest);
AstId ast_contact_gap(Ast *ast, Span span, Span op, AstId gap, AstId least); /* contact: gap >= least */

/* Reports a declaration of `t` or `pi`. */
void check_declared(Ast *ast, Ident name);

AstList ast_list(AstId item);
AstList ast_list_add(Ast *ast, AstList list, AstId item);
AstId ast_window(Ast *ast, Span span, AstId lo, AstId hi);
AstList ast_list_before(Ast *ast, AstId item, AstList list);

/* `floor sticks`, the name of an event of a contact; other words behind a name are a mistake, reported. */
AstId ast_happening(Ast *ast, Span span, Ident contact, Ident does);

/* ---- statements (ast_stmt.c) ---- */
StmtList stmts_one(AstStmt *s);
StmtList stmts_add(StmtList list, AstStmt *s);
StmtList stmts_join(StmtList a, StmtList b);

/* Gives the statements of a list the kind of the statement that holds the list, and its `exactly`. */
StmtList stmts_set_kind(Ast *ast, StmtList list, AstStmtKind kind, int exactly);

AstStmt *stmt_plain(Ast *ast, AstStmtKind kind, Span span);
AstStmt *stmt_include(Ast *ast, Span span, AstText path);
AstStmt *stmt_name(Ast *ast, AstStmtKind kind, Span span, Ident name);
AstStmt *stmt_titled(Ast *ast, AstStmtKind kind, Span span, Ident name, AstText doc, StmtList body);
/* `NAME[places]: TYPE [UNIT]` of a declaration. */
typedef struct AstDeclared {
  Ident name, type;
  AstList dims;
  AstUnit unit;
} AstDeclared;
AstStmt *stmt_coord(Ast *ast, AstStmtKind kind, Span span, AstDeclared of, int periodic);
/* `momentum p of q`: a coordinate with the term p*q' of the action, or, where L is given, a name of dL/dq'. */
AstStmt *stmt_momentum(Ast *ast, Span span, Ident name, AstList dims, Ident type, Ident coord, AstUnit unit);
AstStmt *stmt_hamiltonian(Ast *ast, Span span, AstId rhs);
AstStmt *stmt_valued(Ast *ast, AstStmtKind kind, Span span, Ident name, AstUnit unit, AstId value);
AstStmt *stmt_param(Ast *ast, Span span, AstDeclared of, AstId value, AstSign sign);
AstStmt *stmt_define(Ast *ast, AstStmtKind kind, Span span, Ident name, AstList dims, AstUnit unit, AstId rhs);
AstStmt *stmt_function(Ast *ast, Span span, Ident name, AstList args, AstId rhs);
/* network.c; activation.name NULL: tanh. */
AstStmt *stmt_network(Ast *ast, Span span, Ident name, AstList args, AstText path, AstList layers, Ident activation);
AstStmt *stmt_value(Ast *ast, AstStmtKind kind, Span span, AstId rhs);
AstStmt *stmt_pair(Ast *ast, AstStmtKind kind, Span span, AstId lhs, AstId rhs);
/* `NAME[dims]: LHS = RHS`, a contact with its gap and restitution, `draw SHAPE[dims] SUBJECT = VALUE`; args: options,
 * the condition of a constraint. 0 and empty: not written. */
AstStmt *stmt_equation(Ast *ast, AstStmtKind kind, Span span, Ident name, AstList dims, AstId lhs, AstId rhs,
                       AstId args);
/* A guide; where its slip has two components, along a surface, the contacts NAME and NAME.back of its two sides. */
StmtList stmts_guide(Ast *ast, Span span, Ident name, AstList dims, AstId sides, AstList rubbing);
AstId ast_sides(Ast *ast, Span span, Span op, AstId lhs, AstId rhs); /* -(lhs - rhs), and before both 0 */
/* `friction NAME on q: f, static = most`: the force -f*sign(q') on q, and its value, the observable NAME. most: 0
 * where there is none. Where f contains `lambda(...)`, a guide whose slip is q'. */
StmtList stmts_friction(Ast *ast, Span span, Ident name, AstList dims, AstId place, AstId f, AstId most);
/* `symmetry NAME(args): maps`; `canonical NAME(args): maps`, items `Q = ...` and `F2(q, P) = ...`. */
AstStmt *stmt_maps(Ast *ast, AstStmtKind kind, Span span, Ident name, AstList args, AstText doc, StmtList maps);
AstStmt *stmt_event(Ast *ast, Span span, Ident name, AstList dims, AstId when, AstDirection way, StmtList body);
/* The statements inside a `for` over each range `i in 1..N` among the expressions first .. last, in whose place its
 * index stands: `observe u[i in 1..N] = e` is `for i in 1..N { observe u[i] = e }`. last 0: the statements alone. */
StmtList stmts_each(Ast *ast, AstId first, AstId last, StmtList list);
AstStmt *stmt_for(Ast *ast, Span span, Ident index, AstId lo, AstId hi, StmtList body);

/* Adds an item to a symmetry; a map after `for ...:` belongs to that `for`. */
StmtList maps_add(StmtList maps, AstStmt *item);

/* `a-b`, the name of a method. */
Ident ident_dashed(Ast *ast, Span span, Ident a, Ident b);

/* The sign declared by `> 0`, `>= 0`, ...; a bound other than 0 is reported. */
AstSign sign_of(Ast *ast, Span span, AstSign sign, Num number);
