/* Outputs of a scene: one column per number, per component of a vector, per member of a family. Names and units of
 * columns. */
#include "model/builder.h"

/* Entity at the stem of an output, ignoring indices, component and primes; or NULL. */
static const Entity *named(Builder *b, const Target *p) {
  const AstExpr *x = ast_expr(b->ast, p->stem);
  if (p->wrong) return NULL;
  if (x->kind == AST_MEMBER) return scope_own(&b->scope, x->name, ast_expr(b->ast, x->a)->name);
  return entity_named(b, x->name);
}

/* Unit of an output: the name's declared unit, otherwise none yet: fill_inferred_units derives it from the
 * dimension. */
static Unit output_unit(Builder *b, const Entity *e, uint32_t primes, Dim dim) {
  const Unit *own = e ? entity_unit(b, e) : NULL;
  Unit u = own && own->text[0] ? *own : unit_si(DIM_ANY, "");
  for (; primes; primes--) u = unit_per_second(b, &u);
  u.dim = dim;
  return u;
}

/* Angular velocities are in rad/s. */
static void show_spin(const Builder *b, const Value *v, Unit *unit) {
  const char *spin = spin_unit(b).text;
  if (!b->unitless && !unit->text[0] && v->unit && strcmp(v->unit, spin) == 0) unit->text = spin;
}

int push_output(Builder *b, const Output *o) {
  vec_push(b->arena, &b->m->scene.outputs, *o);
  return (int)b->m->scene.outputs.n - 1;
}

/* First output with this label; NULL: none. Labels enter the scope at the first question after they came. */
static const Entity *labelled(Builder *b, Name label) {
  for (; b->labelled < b->m->scene.outputs.n; b->labelled++) {
    Entity e = {.name = b->m->scene.outputs.at[b->labelled].name, .index = b->labelled};
    if (!scope_own(&b->outputs, e.name, NULL)) scope_add(&b->outputs, e);
  }
  return scope_own(&b->outputs, label, NULL);
}

void drop_outputs(Builder *b) {
  b->m->scene.outputs.n = b->labelled = 0;
  b->outputs = (Scope){.arena = b->arena};
}

/* Index of the output with this label; adds it if there is none. from: its expression in the text. */
static int add_one(Builder *b, Name label, Span span, Unit unit, Expr value, const OutputText *from) {
  const Entity *there = labelled(b, label);
  if (there) return (int)there->index;
  Output o = {.name = label, .span = span, .unit = unit, .value = value, .from = *from};
  return push_output(b, &o);
}

/* "stem", "stem'", "stem.x'" */
static Name label_of(Builder *b, const char *stem, int part, uint32_t primes) {
  StrBuf s = strbuf(b->arena);
  sb_puts(&s, stem);
  if (part >= 0) sb_printf(&s, ".%c", "xyzw"[part]);
  for (uint32_t i = 0; i < primes; i++) sb_putc(&s, '\'');
  return intern(b->ast->names, sb_text(&s));
}

/* Adds a number, or each component of a vector. Index of the number's output; -1 for a vector. */
static int add_value(Builder *b, const char *stem, uint32_t primes, const Entity *e, Span span, const Value *v,
                     OutputText from) {
  Unit unit = output_unit(b, e, primes, v->dim);
  show_spin(b, v, &unit);
  if (!v->n) return add_one(b, label_of(b, stem, -1, primes), span, unit, v->e, &from);
  for (uint32_t k = 0; k < v->n; k++) {
    int part = v->n == ROTATION ? ((int)k + 3) % ROTATION : (int)k;
    from.component = k;
    add_one(b, label_of(b, stem, part, primes), span, unit, v->at[k], &from);
  }
  return -1;
}

/* Adds all members of a family that is named without index. */
static void add_family(Builder *b, AstId id, const Target *p, const Entity *e) {
  Span span = ast_expr(b->ast, id)->span;
  int64_t at[2];
  const char *stem = ast_text(b, p->stem);
  for (int more = first_member(e, at); more; more = next_member(e, at)) {
    const Entity *member = e->kind == ENT_LET || e->kind == ENT_OBSERVE ? find_member(b->ast, &b->members, e, at) : e;
    if (!member) continue;
    Value v = resolve_member(b, e, at, p->primes, span, IN_OUTPUT);
    if (!v.e) return;
    int place = component_index(v.n, p->part);
    if (place >= 0) v = (Value){.e = v.at[place], .dim = v.dim};
    Name name = member_name(b->ast, stem, at, e->ndims);
    if (p->part >= 0) name = label_of(b, name, p->part, 0);
    add_value(b, name, p->primes, member, span, &v, (OutputText){.id = id, .member = {at[0], at[1]}, .is_member = 1});
  }
}

int add_error(Builder *b, const Exact *x, Span span) {
  Expr e = closed_form_error(b, x);
  return add_one(b, intern_printf(b, "error(%s)", x->name), span, unit_of_difference(&x->unit), e, &(OutputText){0});
}

/* 1 for exact(q) or error(q), unless the model declares a function of that name. */
static int is_closed_form(Builder *b, const AstExpr *x) {
  if (x->kind != AST_CALL || !x->args || (strcmp(x->name, "exact") != 0 && strcmp(x->name, "error") != 0)) return 0;
  const Entity *e = entity_named(b, x->name);
  return !e || e->kind != ENT_FUNCTION;
}

/* Adds exact(q) or error(q) in the unit of q; components of a vector get the names that they have by themselves. */
static int add_closed_form(Builder *b, AstId id, Name label) {
  const AstExpr *x = ast_expr(b->ast, id);
  AstId arg = x->args;
  Span span = x->span;
  Name call = x->name;
  Value v = resolve(b, id, IN_OUTPUT, NULL);
  if (!v.e) return -1;
  Value of = resolve(b, arg, IN_OUTPUT, NULL);
  int place = -1;
  for (uint32_t k = 0; k < (v.n ? v.n : 1); k++) {
    const Exact *form = find_closed_form(b, of.at[k]);
    Name own = intern_printf(b, "%s(%s)", call, form->name);
    Unit unit = strcmp(call, "error") == 0 ? unit_of_difference(&form->unit) : form->unit;
    place = add_one(b, label && !v.n ? label : own, span, unit, v.at[k], &(OutputText){.id = id, .component = k});
  }
  return v.n ? -1 : place;
}

int add_outputs(Builder *b, AstId id) {
  if (is_closed_form(b, ast_expr(b->ast, id))) return add_closed_form(b, id, NULL);
  Target p = read_target(b, id);
  const Entity *e = named(b, &p);
  Span span = ast_expr(b->ast, id)->span;
  const OutputText from = {.id = id};
  if (e && e->ndims && !p.indices && e->kind != ENT_NONE) {
    add_family(b, id, &p, e);
    return -1;
  }
  Value v = resolve(b, id, IN_OUTPUT, NULL);
  if (!v.e) return -1;
  const Entity *shown = e;
  if (e && p.indices) { /* label from the index's value, not from how it is written */
    IndexRange r;
    if (!resolve_indices(b, p.indices, NULL, &r)) return -1;
    if (e->kind == ENT_LET || e->kind == ENT_OBSERVE) shown = find_member(b->ast, &b->members, e, r.lo);
    Name name = member_name(b->ast, ast_text(b, p.stem), r.lo, r.n);
    if (p.part >= 0) name = label_of(b, name, p.part, 0);
    return add_value(b, name, p.primes, shown, span, &v, from);
  }
  if (e && v.n) return add_value(b, ast_text(b, p.stem), p.primes, e, span, &v, from);
  const char *text = ast_text(b, id);
  int call = ast_expr(b->ast, id)->kind == AST_CALL;
  if (v.n) return add_value(b, arena_printf(b->arena, call ? "%s" : "(%s)", text), 0, NULL, span, &v, from);
  Unit unit = output_unit(b, e, p.primes, v.dim);
  show_spin(b, &v, &unit);
  return add_one(b, intern(b->ast->names, text), span, unit, v.e, &from);
}

int add_outputs_as(Builder *b, AstId id, Name label) {
  if (is_closed_form(b, ast_expr(b->ast, id))) return add_closed_form(b, id, label);
  Target p = read_target(b, id);
  const Entity *e = named(b, &p);
  if (e && e->ndims && !p.indices && e->kind != ENT_NONE) return add_outputs(b, id);
  Value v = resolve(b, id, IN_OUTPUT, NULL);
  Span span = ast_expr(b->ast, id)->span;
  if (!v.e) return -1;
  if (v.n) return add_value(b, label, 0, NULL, span, &v, (OutputText){.id = id});
  return add_one(b, label, span, output_unit(b, e, p.primes, v.dim), v.e, &(OutputText){.id = id});
}
