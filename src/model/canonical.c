/* Canonical transformations: `canonical NAME: Q = ..., P = ...`, its inverse `q = ..., p = ...`, or a generating
 * function `F2(q, P) = ...`. Here names, units and completeness; claims/canonical_claims.c judges. New variables are
 * symbols that no equation of motion contains. */
#include "base/words.h"
#include "model/resolve_impl.h"

typedef struct {
  Builder *b;
  const AstStmt *st;
  Canonical c;
  uint32_t nold, nnew; /* symbols of c.old and c.fresh */
  int lifts;           /* other coordinates of a model that gives H: momenta follow, by F3 = -p q(Q, t) */
  BoundName *names;    /* [nnew] Q, then P */
  SymId *old;
  Span *spans;
} Reader;

/* --- names --- */

/* Symbols of an old coordinate or momentum: places first .. first + size - 1 in c.old; size 0: no such name. */
typedef struct {
  uint32_t first, size;
} OldPlaces;

static OldPlaces old_places(const Reader *r, Name name) {
  const Entity *e = scope_own(&r->b->scope, name, NULL);
  const Model *m = r->b->m;
  SymId s = 0;
  if (!e || !entity_size(e)) return (OldPlaces){0, 0};
  if (e->kind == ENT_COORD) s = m->coords.at[e->index].q;
  if (e->kind == ENT_STATE) s = m->states.at[e->index].z;
  for (uint32_t i = 0; s && i < r->nold; i++)
    if (r->old[i] == s) return (OldPlaces){i, entity_size(e)};
  return (OldPlaces){0, 0};
}

static int is_old(const Reader *r, Name name) { return old_places(r, name).size > 0; }

static int is_hamiltonian(const AstStmt *x) { return x->kind == STMT_SET && strcmp(x->name, "hamiltonian") == 0; }
static int is_forward(const Reader *r, const AstStmt *x) {
  return x->kind == STMT_SET && !is_old(r, x->name) && !is_hamiltonian(x);
}

/* Place of a new variable in c.fresh; nnew: no such name. */
static uint32_t new_place(const Reader *r, Name name) {
  uint32_t k = 0;
  while (k < r->nnew && r->names[k].name != name) k++;
  return k;
}

/* Place of the k-th name in order of the text, Q1, P1, Q2, P2: coordinates first. */
static uint32_t place_in_order(const Reader *r, uint32_t k) { return r->c.is_point ? k : k / 2 + k % 2 * r->c.n; }

static int name_variable(Reader *r, uint32_t place, Name name, Span span) {
  const Entity *other = entity_named(r->b, name);
  if (other) {
    diag_error(r->b->diags, span, "`%s` is %s of the model, and here a new variable", name, ent_kind_text(other->kind));
    diag_also(r->b->diags, other->span, "declared here; a new variable needs a name of its own");
    return 0;
  }
  if (new_place(r, name) < r->nnew) return diag_error(r->b->diags, span, "two new variables are called `%s`", name);
  r->names[place].name = name;
  r->spans[place] = span;
  return 1;
}

static int report_count(const Reader *r, Span span, uint32_t found) {
  const char *what = r->c.is_point ? "coordinates" : "variables, each coordinate followed by its momentum";
  return diag_error(r->b->diags, span, "`%s` has %u new variable%s, and the model needs %u new %s", r->st->name, found,
                    plural(found), r->nnew, what);
}

/* Conjugate of a variable that only a generating function names: Q for P, Qx for Px, else Q_name. */
static Name conjugate_name(const Reader *r, Name of, int is_momentum) {
  if (is_momentum && of[0] == 'Q') return intern_printf(r->b, "P%s", of + 1);
  if (!is_momentum && of[0] == 'P') return intern_printf(r->b, "Q%s", of + 1);
  return intern_printf(r->b, "%c_%s", is_momentum ? 'P' : 'Q', of);
}

static const AstStmt *generator_of(const Reader *r) {
  for (const AstStmt *x = r->st->body; x; x = x->next)
    if (x->kind == STMT_FUNCTION) return x;
  return NULL;
}

/* Names of the head `NAME(Q, P)`. */
static int names_of_head(Reader *r) {
  uint32_t k = 0, n = ast_list_length(r->b->ast, r->st->args);
  if (n != (r->lifts ? r->c.n : r->nnew)) return report_count(r, r->st->name_span, n);
  for (AstId i = r->st->args; i; i = ast_expr(r->b->ast, i)->next, k++) {
    const AstExpr *x = ast_expr(r->b->ast, i);
    if (!name_variable(r, r->lifts ? k : place_in_order(r, k), x->name, x->span)) return 0;
    if (r->lifts && !name_variable(r, k + r->c.n, intern_printf(r->b, "p_%s", x->name), x->span)) return 0;
  }
  return 1;
}

/* Names of the new arguments of a generating function, and of their conjugates. */
static int names_of_generator(Reader *r, const AstStmt *F) {
  uint32_t k = 0, n = r->c.n, momenta = r->c.kind % 2 == 0;
  for (AstId i = F->args; i; i = ast_expr(r->b->ast, i)->next) {
    const AstExpr *x = ast_expr(r->b->ast, i);
    if (is_old(r, x->name)) continue;
    if (k == n || !name_variable(r, k + momenta * n, x->name, x->span))
      return k < n ? 0 : report_count(r, F->span, k + 1);
    if (!name_variable(r, k + !momenta * n, conjugate_name(r, x->name, !momenta), x->span)) return 0;
    k++;
  }
  return k == n ? 1 : report_count(r, F->span, k);
}

/* The left sides that are new, in order. */
static int names_of_maps(Reader *r) {
  uint32_t k = 0;
  for (const AstStmt *x = r->st->body; x; x = x->next) {
    if (!is_forward(r, x)) continue;
    if (k == r->nnew) return report_count(r, x->name_span, k + 1);
    if (!name_variable(r, place_in_order(r, k), x->name, x->name_span)) return 0;
    k++;
  }
  return k == r->nnew ? 1 : report_count(r, r->st->name_span, k);
}

static int names_new_variables(const Reader *r) {
  for (const AstStmt *x = r->st->body; x; x = x->next)
    if (is_forward(r, x)) return 1;
  return 0;
}

static int read_names(Reader *r) {
  const AstStmt *F = generator_of(r);
  if (r->st->args) return names_of_head(r);
  if (names_new_variables(r)) return names_of_maps(r);
  if (F) return names_of_generator(r, F);
  return diag_error(r->b->diags, r->st->name_span,
                    "the new variables have no names" HELP "name them: `canonical %s(Q, P): ...`", r->st->name);
}

/* Symbols with the units and signs of the forward map, where there is one: r = sqrt(x^2 + y^2) is not negative. */
static void declare_variables(Reader *r, const Value *forward) {
  Builder *b = r->b;
  SymId *fresh = ARENA_ARRAY(b->arena, SymId, r->nnew + 1);
  for (uint32_t k = 0; k < r->nnew; k++) {
    Dim dim = b->unitless ? DIM_ANY : forward[k].e ? forward[k].dim : dim_unknown(b->dims, r->names[k].name);
    ExprSign sign = forward[k].e ? expr_sign(b->g, forward[k].e) : SIGN_UNKNOWN;
    fresh[k] = r->names[k].sym = declare_symbol(b, SYM_INPUT, b->m->inputs.n + k, r->names[k].name, sign, dim);
  }
  r->c.fresh = fresh;
}

/* --- values --- */

static int is_unknown(const Symbol *s, const void *data) {
  const Reader *r = data;
  if (s->kind == SYM_ACC || s->kind == SYM_MULTIPLIER) return 1;
  return s->kind == SYM_INPUT && s->index < r->b->m->inputs.n;
}

/* Value of a map or a generating function. bound: it may contain new variables, and has no velocities; else old
 * variables alone. */
static Value map_value(Reader *r, AstId id, int bound) {
  Builder *b = r->b;
  Span v = {0};
  b->bound = r->names;
  b->nbound = bound ? r->nnew : 0;
  Value x = resolve(b, id, IN_OBSERVE, NULL);
  b->nbound = 0;
  if (x.e && refuse_actions(b, &x, ast_expr(b->ast, id)->span)) return FAILED;
  if (bound && x.e) v = velocity_in(b, id, &x);
  if (v.end)
    return refuse(b, v, "a transformation of phase space is made of coordinates, momenta and t, and has no velocities");
  for (uint32_t k = 0; x.e && k < component_count(&x); k++)
    if (expr_contains(b->g, x.at[k], is_unknown, r))
      return refuse(b, ast_expr(b->ast, id)->span,
                    "a canonical transformation has no accelerations, multipliers or inputs");
  r->c.domain = domain_and(b, r->c.domain, x.domain);
  return x;
}

static int has_dim(Reader *r, AstId id, const Value *v, Dim want, const char *what) {
  Builder *b = r->b;
  Span span = ast_expr(b->ast, id)->span;
  if (b->unitless || dim_equate(b->dims, v->dim, want, span)) return 1;
  diag_error(b->diags, span, "units do not match: %s is %s, and this is %s", what, in_dim(b, want), in_dim(b, v->dim));
  explain_dims(b, v->dim, want);
  return 0;
}

static Dim dim_of_symbol(const Reader *r, SymId s) { return r->b->dim_of.at[s]; }

static int read_forward(Reader *r, const AstStmt *x, Value *forward) {
  Builder *b = r->b;
  uint32_t k = new_place(r, x->name);
  if (k == r->nnew)
    return diag_error(b->diags, x->name_span,
                      "`%s` is neither a coordinate or momentum of the model nor a new variable of `%s`", x->name,
                      r->st->name);
  if (forward[k].e) return diag_error(b->diags, x->name_span, "`%s` is given twice", x->name);
  Value v = map_value(r, x->rhs, 0);
  if (v.e && v.n)
    return diag_error(b->diags, ast_expr(b->ast, x->rhs)->span,
                      "a new variable is a number, and this is %s" HELP "give each component a name",
                      shape_text(b, v.n));
  forward[k] = v;
  r->spans[k] = x->name_span;
  return v.e != 0;
}

static int read_inverse(Reader *r, const AstStmt *x, Expr *inverse) {
  Builder *b = r->b;
  OldPlaces at = old_places(r, x->name);
  if (r->lifts && at.first >= r->c.n)
    return diag_error(b->diags, x->name_span,
                      "`%s` follows from the coordinates" HELP
                      "leave it out, or name the new momenta, too: `%s(Q, P): ...`",
                      x->name, r->st->name);
  if (inverse[at.first]) return diag_error(b->diags, x->name_span, "`%s` is given twice", x->name);
  Value v = map_value(r, x->rhs, 1);
  if (!v.e) return 0;
  if (component_count(&v) != at.size)
    return diag_error(b->diags, x->span, "`%s` is %s, and this is %s", x->name,
                      shape_text(b, at.size > 1 ? at.size : 0), shape_text(b, v.n));
  for (uint32_t k = 0; k < at.size; k++) inverse[at.first + k] = v.at[k];
  return has_dim(r, x->rhs, &v, dim_of_symbol(r, r->old[at.first]), arena_printf(b->arena, "`%s`", x->name));
}

/* Whether the arguments of F are all old coordinates (momenta), and all new coordinates (momenta), as its kind says. */
static int check_arguments(Reader *r, const AstStmt *F) {
  static const char *const forms[] = {"F1(q, Q)", "F2(q, P)", "F3(p, Q)", "F4(p, P)"};
  uint32_t n = r->c.n, old = 0, fresh = 0, from = r->c.kind > 2 ? n : 0, to = r->c.kind % 2 ? 0 : n;
  for (AstId i = F->args; i; i = ast_expr(r->b->ast, i)->next) {
    Name name = ast_expr(r->b->ast, i)->name;
    OldPlaces at = old_places(r, name);
    uint32_t k = new_place(r, name);
    int fits = at.size ? at.first >= from && at.first < from + n : k >= to && k < to + n;
    if (!fits)
      return diag_error(r->b->diags, ast_expr(r->b->ast, i)->span,
                        "`%s` is no argument of this kind of generating function, %s", name, forms[r->c.kind - 1]);
    if (at.size) old += at.size;
    else fresh++;
  }
  if (old == n && fresh == n) return 1;
  return diag_error(r->b->diags, F->span,
                    "a generating function %s has %u old and %u new arguments, and this one %u and %u",
                    forms[r->c.kind - 1], n, n, old, fresh);
}

/* Whether F contains its arguments, t and parameters alone; otherwise reported. */
static int depends_on_arguments(Reader *r, const AstStmt *F) {
  uint32_t n = r->c.n;
  for (uint32_t i = 0; i < 4 * n; i++) {
    int fresh = i >= 2 * n, momentum = i % (2 * n) >= n,
        argument = fresh ? momentum == (r->c.kind % 2 == 0) : momentum == (r->c.kind > 2);
    SymId s = fresh ? r->c.fresh[i - 2 * n] : r->old[i];
    if (argument || !expr_contains_sym(r->b->g, r->c.generator, s)) continue;
    return diag_error(r->b->diags, ast_expr(r->b->ast, F->rhs)->span,
                      "`%s` contains `%s`, which is none of its arguments", F->name, expr_symbol(r->b->g, s)->name);
  }
  return 1;
}

static int read_kind(Reader *r, const AstStmt *F) {
  if (F->name[0] == 'F' && F->name[1] >= '1' && F->name[1] <= '4' && !F->name[2]) r->c.kind = F->name[1] - '0';
  else
    return diag_error(r->b->diags, F->name_span,
                      "a generating function is called F1, F2, F3 or F4" HELP
                      "F1(q, Q), F2(q, P), F3(p, Q), F4(p, P), with old q, p and new Q, P");
  for (const AstStmt *x = F->next; x; x = x->next)
    if (x->kind == STMT_FUNCTION)
      return diag_error(r->b->diags, x->name_span, "`%s` has two generating functions", r->st->name);
  return !r->b->gives_lagrangian || diag_error(r->b->diags, F->span,
                                               "the model gives its Lagrangian, which has no symbols for momenta" HELP
                                               "give its Hamiltonian: `momentum p of x`, `hamiltonian = ...`");
}

static int read_generator(Reader *r, const AstStmt *F) {
  Builder *b = r->b;
  if (!check_arguments(r, F)) return 0;
  Value v = map_value(r, F->rhs, 1);
  if (v.e && v.n)
    return diag_error(b->diags, ast_expr(b->ast, F->rhs)->span, "a generating function is a number, and this is %s",
                      shape_text(b, v.n));
  r->c.generator = v.e;
  Dim action = dim_mul(b->dims, b->energy, dim_of_symbol(r, b->m->time));
  return v.e && has_dim(r, F->rhs, &v, action, "an action") && depends_on_arguments(r, F);
}

/* `hamiltonian = K`, in the new variables. */
static int read_hamiltonian(Reader *r, const AstStmt *x) {
  Builder *b = r->b;
  if (r->c.is_point) return diag_error(b->diags, x->span, "a change of coordinates claims no Hamiltonian");
  if (r->c.K) return diag_error(b->diags, x->name_span, "`%s` is given twice", x->name);
  Value v = map_value(r, x->rhs, 1);
  if (v.e && v.n)
    return diag_error(b->diags, ast_expr(b->ast, x->rhs)->span, "a Hamiltonian is a number, and this is %s",
                      shape_text(b, v.n));
  for (uint32_t i = 0; v.e && i < r->nold; i++)
    if (expr_contains_sym(b->g, v.e, r->old[i]))
      return diag_error(b->diags, ast_expr(b->ast, x->rhs)->span,
                        "the new Hamiltonian is a function of the new variables, and this contains `%s`",
                        expr_symbol(b->g, r->old[i])->name);
  r->c.K = v.e;
  r->c.K_span = x->span;
  return v.e && has_dim(r, x->rhs, &v, b->energy, "a Hamiltonian");
}

/* Products of a coordinate and its momentum are actions. */
static int check_pairs(Reader *r) {
  Builder *b = r->b;
  Dim action = dim_mul(b->dims, b->energy, dim_of_symbol(r, b->m->time));
  for (uint32_t i = 0; i < r->c.n && !r->c.is_point && !b->unitless; i++) {
    Dim product = dim_mul(b->dims, dim_of_symbol(r, r->c.fresh[i]), dim_of_symbol(r, r->c.fresh[r->c.n + i]));
    if (dim_equate(b->dims, product, action, r->spans[i])) continue;
    return diag_error(b->diags, r->spans[i], "units do not match: `%s*%s` is %s, and an action %s", r->names[i].name,
                      r->names[r->c.n + i].name, in_dim(b, product), in_dim(b, action));
  }
  return 1;
}

/* F3 = -sum p_i q_i(Q, t) of other coordinates q(Q, t). */
static void lift(Reader *r) {
  ExprGraph *g = r->b->g;
  Expr sum = expr_int(g, 0);
  for (uint32_t i = 0; i < r->c.n; i++)
    sum = expr_sub(g, sum, expr_mul(g, expr_symbol(g, r->old[r->c.n + i])->node, r->c.inverse[i]));
  r->c.kind = 3;
  r->c.generator = sum;
  r->c.inverse = NULL;
}

static int all_given(const Reader *r, uint32_t given, const Expr *map, const SymId *sym, uint32_t n) {
  for (uint32_t k = 0; k < n && given; k++)
    if (!map[k])
      return diag_error(r->b->diags, r->st->span, "`%s` gives no `%s`", r->st->name,
                        expr_symbol(r->b->g, sym[k])->name);
  return 1;
}

/* The forward map first: it has no new variables. */
static int read_maps(Reader *r) {
  Builder *b = r->b;
  Value *values = ARENA_ARRAY(b->arena, Value, r->nnew + 1);
  Expr *forward = ARENA_ARRAY(b->arena, Expr, r->nnew + 1), *inverse = ARENA_ARRAY(b->arena, Expr, r->nold + 1);
  uint32_t forwards = 0, inverses = 0;
  for (const AstStmt *x = r->st->body; x; x = x->next) {
    if (!is_forward(r, x)) continue;
    if (!read_forward(r, x, values)) return 0;
    forwards++;
  }
  declare_variables(r, values);
  for (const AstStmt *x = r->st->body; x; x = x->next) {
    int is_map = x->kind == STMT_SET && is_old(r, x->name);
    if (x->kind == STMT_FUNCTION ? !read_generator(r, x)
        : is_map                 ? !read_inverse(r, x, inverse)
                                 : is_hamiltonian(x) && !read_hamiltonian(r, x))
      return 0;
    inverses += (uint32_t)is_map;
  }
  for (uint32_t k = 0; k < r->nnew; k++) forward[k] = values[k].e;
  if (forwards) r->c.forward = forward;
  if (inverses) r->c.inverse = inverse;
  if (!all_given(r, forwards, forward, r->c.fresh, r->nnew) ||
      !all_given(r, inverses, inverse, r->old, r->lifts ? r->c.n : r->nold))
    return 0;
  if (r->lifts) lift(r);
  return check_pairs(r);
}

/* --- the statement --- */

static void gather_old(Reader *r) {
  const Model *m = r->b->m;
  uint32_t n = r->c.n = m->hamiltonian ? m->pairs.n : m->coords.n;
  r->nold = m->hamiltonian ? 2 * n : n;
  r->old = ARENA_ARRAY(r->b->arena, SymId, r->nold + 1);
  for (uint32_t i = 0; i < n; i++) {
    r->old[i] = m->hamiltonian ? m->states.at[m->pairs.at[i].q].z : m->coords.at[i].q;
    if (m->hamiltonian) r->old[n + i] = m->states.at[m->pairs.at[i].p].z;
  }
  r->c.old = r->old;
}

void add_canonical(Builder *b, const AstStmt *st) {
  Reader r = {.b = b, .st = st, .c = {.name = st->name, .span = st->span, .stmt = st}};
  const char *why = reason_against_brackets(b->m);
  if (b->m->hamiltonian && !b->m->first_order) return; /* the first of two builds */
  check_name_is_new(b, "canonical transformation", st->name, NULL, st->name_span);
  if (why) {
    diag_error(b->diags, st->span, "%s", why);
    return;
  }
  gather_old(&r);
  const AstStmt *F = generator_of(&r);
  if (F && !read_kind(&r, F)) return;
  r.c.is_point = !b->m->hamiltonian && !names_new_variables(&r);
  r.lifts = b->m->hamiltonian && !F && !names_new_variables(&r) && ast_list_length(b->ast, st->args) == r.c.n;
  r.nnew = r.c.is_point ? r.c.n : 2 * r.c.n;
  r.names = ARENA_ARRAY(b->arena, BoundName, r.nnew + 1);
  r.spans = ARENA_ARRAY(b->arena, Span, r.nnew + 1);
  r.c.spans = r.spans;
  if (read_names(&r) && read_maps(&r)) vec_push(b->arena, &b->m->canonicals, r.c);
}
