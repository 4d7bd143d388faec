/* Types of declared names: the unit, the components of a vector or a rotation, the sizes of a family. */
#include <string.h>

#include "model/builder.h"

/* Declares the name of a refused declaration, so that its uses are not reported as unknown. */
void declare_refused(Builder *b, const AstStmt *st, Name effect) {
  if (!scope_own(&b->scope, st->name, effect))
    scope_add(&b->scope, (Entity){.kind = ENT_NONE, .name = st->name, .effect = effect, .span = st->name_span});
}

/* 1 for `coord q[m]`: the index contains names of units, and no constant. */
static int dims_are_units(Builder *b, const AstStmt *st) {
  const AstExpr *x = ast_expr(b->ast, st->dims);
  uint32_t names = 0;
  for (AstId i = x->first; i <= st->dims; i++) {
    const AstExpr *y = ast_expr(b->ast, i);
    if (y->kind != AST_NAME) continue;
    const AstStmt *st2 = declared_in_use(b, y->name, NULL);
    if (st2 && st2->kind == STMT_CONST) return 0;
    names++;
    if (!unit_exists(y->name)) return 0;
  }
  return names > 0 && !x->next;
}

/* Brackets after a space are a unit, else a size: 0, reported, where a unit was written without the space. */
int check_brackets(Builder *b, const AstStmt *st, Name effect) {
  if (!st->dims) {
    if (st->unit.n && !(st->kind == STMT_PARAM && st->unit.span.begin > ast_expr(b->ast, st->rhs)->span.begin))
      warn_unit_is_constant(b, &st->unit);
    return 1;
  }
  if (!dims_are_units(b, st)) return 1;
  const char *index = ast_text(b, st->dims);
  diag_error(b->diags, st->name_span, "`%s[%s]` declares a family, but `%s` is not a constant", st->name, index, index);
  diag_help(b->diags, "a unit stands apart: `%s [%s]`", st->name, index);
  declare_refused(b, st, effect);
  return 0;
}

/* Refuses members for which memory does not suffice, before they are made. */
static int fits_memory(Builder *b, const AstStmt *st, const Entity *e) {
  enum { MEMBER_BYTES = 3000 }; /* least of `lagc check`, of sums that stay sums; 3.9 kB of three-dimensional atoms */
  const double MB = 1e6;
  uint64_t all = (uint64_t)b->m->coords.n + b->m->states.n + entity_size(e);
  size_t limit = arena_limit(b->arena);
  if (!limit || (e->kind != ENT_COORD && e->kind != ENT_STATE) || all * MEMBER_BYTES <= limit) return 1;
  return diag_error(b->diags, st->name_span,
                    "%llu coordinates and states take some %.0f MB, and lagc has %.0f MB" HELP
                    "choose fewer members, as by `-D N=1000` where `N` is their number",
                    (unsigned long long)all, (double)all * MEMBER_BYTES / MB, (double)limit / MB);
}

/* A size, N or, of parameters whose value depends on it, the range `i in 1..N`; 0, reported, on error. */
static int read_size(Builder *b, const AstStmt *st, AstId id, Name effect, int64_t *n) {
  const AstExpr *x = ast_expr(b->ast, id);
  if (x->kind != AST_BIND) return resolve_whole(b, id, effect, n);
  int64_t lo;
  if (!resolve_whole(b, x->a, effect, &lo) || !resolve_whole(b, x->b, effect, n)) return 0;
  if (*n < 0) *n = 0; /* an empty range, as 1..0 is */
  if (st->kind == STMT_PARAM && lo == 1) return 1;
  return diag_error(b->diags, x->span,
                    "a family is declared by its size, and its members begin at 1" HELP "write `%s[%s]`", st->name,
                    ast_text(b, x->b));
}

/* Reads the sizes of a family into e, as index ranges 1..N. */
static int read_sizes(Builder *b, const AstStmt *st, Name effect, Entity *e) {
  const int64_t most = FAMILY_MAX / (e->parts ? e->parts : 1);
  int64_t all = 1;
  for (AstId i = st->dims; i; i = ast_expr(b->ast, i)->next) {
    Span span = ast_expr(b->ast, i)->span;
    int64_t n;
    if (e->ndims == 2) {
      report_many_indices(b, span);
      return 0;
    }
    if (!read_size(b, st, i, effect, &n)) return 0;
    if (n < 0) return diag_error(b->diags, span, "the size of a family is negative: %lld" HELP
                                  "a family of size 0 has no members", (long long)n);
    if (n > most || (all *= n) > most)
      return diag_error(b->diags, span, "a family%s has at most %lld members",
                        e->parts == 4 ? " of rotations" : e->parts ? " of vectors" : "", (long long)most);
    e->lo[e->ndims] = 1;
    e->hi[e->ndims++] = n;
  }
  return fits_memory(b, st, e);
}

int read_family(Builder *b, const AstStmt *st, Name effect, EntKind kind, uint32_t index, uint8_t parts, Entity *e) {
  *e =
      (Entity){.kind = kind, .index = index, .name = st->name, .effect = effect, .span = st->name_span, .parts = parts};
  if (!check_brackets(b, st, effect)) return 0;
  if (read_sizes(b, st, effect, e)) return 1;
  declare_refused(b, st, effect);
  return 0;
}

Name scalar_name(Builder *b, const Entity *e, Name stem, const int64_t *at, uint32_t k) {
  Name name = member_name(b->ast, stem, at, e->ndims);
  return e->parts ? intern_printf(b, "%s.%c", name, component_letter(e->parts, k)) : name;
}

Unit declared_unit(Builder *b, const AstStmt *st, Name effect) {
  Unit u = unit_resolve(&st->unit, b->dims, b->diags, b->arena);
  if (st->unit.n || b->unitless) return u;
  u.dim = dim_unknown(b->dims, st->name);
  vec_push(b->arena, &b->undeclared,
           ((Undeclared){effect ? intern_printf(b, "%s.%s", effect, st->name) : st->name, u.dim}));
  return u;
}

static void report_rotation(Builder *b, const AstStmt *st) {
  if (st->kind != STMT_COORD) {
    diag_error(b->diags, st->name_span, "only a coordinate can be a rotation");
    diag_help(b->diags, "a rotation made of others is a `let`: `let R0 = turn((0, 0, 1), a)*R`");
  } else if (st->unit.n) {
    diag_error(b->diags, st->unit.span, "a rotation has no unit: its four numbers are those of a unit quaternion");
    diag_help(b->diags, "write `coord %s: rotation`", st->name);
  } else
    diag_error(b->diags, st->name_span,
               "a rotation is not an angle, and cannot be `periodic`" HELP "write `coord %s: rotation`", st->name);
}

/* Number of components of a declared type (vec2, vec3, rotation); 0, reported, where the kind of statement cannot
 * have it. */
int read_type(Builder *b, const AstStmt *st, Name effect, uint8_t *parts) {
  int two = st->type && strcmp(st->type, "vec2") == 0, three = st->type && strcmp(st->type, "vec3") == 0;
  *parts = two ? 2 : three ? 3 : 0;
  if (!st->type || two || three) return 1;
  *parts = ROTATION;
  if (st->kind == STMT_COORD && !st->unit.n && !st->periodic) return 1;
  report_rotation(b, st);
  declare_refused(b, st, effect);
  return 0;
}
