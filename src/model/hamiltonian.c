/* Models that give their Hamiltonian: each momentum is a coordinate, and L = sum p q' - H is of first order
 * (mech/first_order.h). Beside an L, momenta are names of dL/dq', and H is a claim that `lagc check` judges. */

#include "model/builder.h"

void find_hamiltonian(Builder *b) {
  int H = 0, L = 0;
  for (uint32_t i = 0; i < b->active.n; i++) {
    AstStmtKind kind = b->active.at[i].stmt->kind;
    if (b->active.at[i].effect) continue;
    H |= kind == STMT_HAMILTONIAN;
    L |= kind == STMT_LAGRANGIAN || kind == STMT_KINETIC || kind == STMT_POTENTIAL;
  }
  b->m->hamiltonian = H && !L;
  b->gives_lagrangian = L;
}

static int is_input_rate(const Builder *b, AstId prime) {
  const AstExpr *of = ast_expr(b->ast, ast_expr(b->ast, prime)->a);
  const Entity *e = of->kind == AST_NAME ? entity_named(b, of->name) : NULL;
  return e && e->kind == ENT_INPUT;
}

Span velocity_in(const Builder *b, AstId id, const Value *v) {
  int known = v && v->e, moves = known && expr_kinds(b->g, v->e) & (1u << SYM_VEL | 1u << SYM_RATE);
  if (known && !moves) return (Span){0}; /* rates of inputs are functions of time */
  for (AstId k = ast_expr(b->ast, id)->first; k <= id; k++)
    if (ast_expr(b->ast, k)->kind == AST_PRIME && !is_input_rate(b, k)) return ast_expr(b->ast, k)->span;
  return moves ? ast_expr(b->ast, id)->span : (Span){0};
}

int is_free_of_velocities(Builder *b, const AstStmt *st, const Value *v) {
  Span span = velocity_in(b, st->rhs, v);
  if (!span.end) return 1;
  diag_error(b->diags, span, "a Hamiltonian is a function of coordinates, momenta and t, and has no velocities");
  diag_help(b->diags, "declare the momentum, `momentum p of x`, and write p^2/(2*m) for m/2*x'^2");
  return 0;
}

int gives_hamiltonian(Builder *b, const AstStmt *st, Name effect, Span *first) {
  if (!b->m->hamiltonian && !effect) return 0;
  if (!b->m->hamiltonian)
    return diag_error(b->diags, st->span,
                      "the model gives its Lagrangian, and this effect a Hamiltonian" HELP
                      "write the effect's terms of L: `potential = ...`");
  if (!effect && first->end) {
    diag_error(b->diags, st->span, "H is given twice");
    diag_also(b->diags, *first, "first given here; write one sum");
    return 0;
  }
  if (!effect) *first = st->span;
  return 1;
}

Value value_of_hamiltonian(Builder *b, const AstStmt *st, Name effect) {
  Value v = resolve(b, st->rhs, IN_DYNAMICS, effect);
  if (v.e) need_number(b, ast_expr(b->ast, st->rhs)->span, v.n);
  if (!v.e || v.n || !is_free_of_velocities(b, st, &v)) return (Value){0};
  b->m->domain = domain_and(b, b->m->domain, v.domain);
  return v;
}

int adds_to_hamiltonian(Builder *b, const AstStmt *st) {
  if (!b->m->hamiltonian || (st->kind != STMT_LAGRANGIAN && st->kind != STMT_KINETIC)) return 1;
  return diag_error(b->diags, st->span,
                    "the model gives its Hamiltonian, and this effect a term of L" HELP
                    "write its term of H: `hamiltonian = ...`");
}

int pair_fits(Builder *b, const AstStmt *st, const Entity *p, const Entity *q) {
  Span span = ast_expr(b->ast, st->lhs)->span;
  if (q->kind == ENT_NONE) return 0;
  if (!is_coordinate(b, q))
    return diag_error(b->diags, span, "`%s` is %s, and only a coordinate has a momentum", q->name,
                      ent_kind_text(q->kind));
  for (uint32_t i = 0; i < b->m->pairs.n && entity_size(q); i++) {
    if (b->m->pairs.at[i].p == q->index) return diag_error(b->diags, span, "`%s` is a momentum itself", q->name);
    if (b->m->pairs.at[i].q == q->index) return diag_error(b->diags, span, "`%s` has two momenta", q->name);
  }
  int same = p->parts == q->parts && p->ndims == q->ndims;
  for (int k = 0; same && k < p->ndims; k++) same = p->hi[k] == q->hi[k];
  if (same) return 1;
  diag_error(b->diags, st->name_span, "`%s` and its coordinate `%s` differ in size", p->name, q->name);
  diag_help(b->diags, "`coord r[N]: vec2` has the momenta `momentum p[N]: vec2 of r`");
  return 0;
}

Value action_of_momentum(Builder *b, const AstStmt *st, Name effect) {
  const AstExpr *of = ast_expr(b->ast, st->lhs);
  const Entity *q = resolve_name(b, of->name, of->span, effect, "coord"), *p = scope_own(&b->scope, st->name, effect);
  if (!q || !p || p->kind == ENT_NONE || !pair_fits(b, st, p, q)) return (Value){0};
  for (uint32_t k = 0; k < entity_size(p); k++)
    vec_push(b->arena, &b->m->pairs, ((CanonicalPair){q->index + k, p->index + k}));
  return resolve(b, st->args, IN_DYNAMICS, effect);
}

void check_momenta(Builder *b) {
  for (uint32_t i = 0; i < b->active.n && b->m->hamiltonian; i++) {
    const AstStmt *q = b->active.at[i].stmt;
    int found = q->kind != STMT_COORD;
    for (uint32_t k = 0; k < b->active.n && !found; k++) {
      const AstStmt *p = b->active.at[k].stmt;
      found = p->kind == STMT_MOMENTUM && ast_expr(b->ast, p->lhs)->name == q->name;
    }
    if (found) continue;
    diag_error(b->diags, q->name_span, "the coordinate `%s` has no momentum, and the model gives its Hamiltonian",
               q->name);
    if (is_momentum_name(q->name))
      diag_help(b->diags, "a momentum is no coordinate: in place of `coord %s` write `momentum %s of q`", q->name,
                q->name);
    else diag_help(b->diags, "declare one: `momentum p of %s`", q->name);
  }
}
