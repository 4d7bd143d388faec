/* `monitor` statements: limits on the drift of the energy, of symmetries' charges, and of outputs. */
#include "model/builder.h"

/* Adds a monitor; a second limit for the same quantity replaces the first. */
static void add_monitor(Builder *b, Monitor mon) {
  Scene *sc = &b->m->scene;
  for (uint32_t i = 0; i < sc->monitors.n; i++)
    if (sc->monitors.at[i].output == mon.output) {
      sc->monitors.at[i] = mon;
      return;
    }
  vec_push(b->arena, &sc->monitors, mon);
}

/* `monitor exact 1e-6`: monitors the error of every closed form. */
static void monitor_exact(Builder *b, Monitor mon, Span span) {
  Scene *sc = &b->m->scene;
  mon.absolute = 1;
  for (uint32_t i = 0; i < sc->exacts.n; i++) {
    mon.output = add_error(b, &sc->exacts.at[i], span);
    mon.name = sc->outputs.at[mon.output].name;
    add_monitor(b, mon);
  }
  if (sc->exacts.n) return;
  diag_error(b->diags, span, "the scene has no closed form to compare with" HELP "`exact q = ...` gives one");
}

/* Charge named by x: 0 the energy, k + 1 the charge of symmetry k; -1: none. */
static int charge_named(Builder *b, const AstExpr *x) {
  const Entity *e = NULL;
  if (x->kind == AST_NAME && strcmp(x->name, "energy") == 0) return 0;
  if (x->kind == AST_NAME) e = entity_named(b, x->name);
  if (x->kind == AST_MEMBER && ast_expr(b->ast, x->a)->kind == AST_NAME)
    e = scope_own(&b->scope, x->name, ast_expr(b->ast, x->a)->name);
  return e && e->kind == ENT_SYMMETRY ? (int)e->index + 1 : -1;
}

void set_monitor(Builder *b, const AstStmt *st) {
  if (!st->lhs) {
    diag_error(b->diags, st->name_span, "`monitor %s` has no limit", st->name);
    diag_help(b->diags,
              "give the largest drift allowed: `monitor %s 1e-8`; `monitor none` drops the monitors before it",
              st->name);
    return;
  }
  const AstExpr *x = ast_expr(b->ast, st->lhs);
  Unit none = unit_si(DIM_NONE, "1");
  int charge = charge_named(b, x);
  Monitor mon = {.output = -1 - charge, .limit = resolve_number(b, st->rhs, &none, "a monitor's limit", NULL)};
  mon.name = intern(b->ast->names, ast_text(b, st->lhs));
  mon.absolute = x->kind == AST_CALL && strcmp(x->name, "error") == 0;
  if (mon.limit <= 0) diag_error(b->diags, ast_expr(b->ast, st->rhs)->span, "a monitor's limit must be positive");
  if (x->kind == AST_NAME && strcmp(x->name, "exact") == 0 && !declared_in_use(b, x->name, NULL)) {
    monitor_exact(b, mon, x->span);
    return;
  }
  if (charge < 0) {
    uint32_t errors = b->diags->errors;
    mon.output = add_outputs(b, st->lhs);
    if (mon.output < 0) {
      if (b->diags->errors == errors) diag_error(b->diags, x->span, "a monitor watches one number");
      return;
    }
  }
  add_monitor(b, mon);
}
