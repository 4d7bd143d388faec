/* A model in other coordinates: the new ones are declared, and the old ones are lets, whose primes are total time
 * derivatives. Constraints, forces and energies are read as they are written; claims, momenta, observables and
 * events of the old coordinates are left out. */
#include "model/builder.h"

static AstStmt *new_statement(Builder *b, AstStmtKind kind, Name name, Span span, AstId rhs) {
  AstStmt *s = ARENA_NEW(b->arena, AstStmt);
  *s = (AstStmt){.kind = kind, .span = span, .name_span = span, .name = name, .rhs = rhs};
  return s;
}

static int is_left_out(AstStmtKind kind) {
  return kind == STMT_COORD || kind == STMT_MOMENTUM || kind == STMT_SYMMETRY || kind == STMT_CANONICAL ||
         kind == STMT_EXPECT || kind == STMT_HAMILTONIAN || kind == STMT_OBSERVE || kind == STMT_EVENT;
}

void change_coordinates(Builder *b, Name to) {
  Actives now = {0};
  for (uint32_t i = 0; i < b->active.n; i++) {
    const AstStmt *st = b->active.at[i].stmt;
    if (!is_left_out(st->kind)) vec_push(b->arena, &now, b->active.at[i]);
    if (st->kind != STMT_CANONICAL || st->name != to) continue;
    for (AstId k = st->args; k; k = ast_expr(b->ast, k)->next)
      vec_push(b->arena, &now,
               ((Active){new_statement(b, STMT_COORD, ast_expr(b->ast, k)->name, ast_expr(b->ast, k)->span, 0), NULL}));
    for (const AstStmt *x = st->body; x; x = x->next)
      vec_push(b->arena, &now, ((Active){new_statement(b, STMT_LET, x->name, x->name_span, x->rhs), NULL}));
  }
  b->active = now;
}
