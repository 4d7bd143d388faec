/* `draw` statements: their shapes, places and sizes.
 *
 * Enters: the active statements and those of the scene. Leaves: Scene.shapes, whose numbers are outputs behind those
 * of the scene, in SI. Holds: places have one dimension, sizes the same; nodes come after all others, so that the
 * equations are numbered as without a drawing. */
#include "model/drawing.h"

#include <string.h>

#include "base/words.h"

typedef struct {
  const char *word, *subject, *needs, *takes, *example;
} ShapeRow;

#define ROW_(NAME, ...) [SHAPE_##NAME] = {__VA_ARGS__},
static const ShapeRow rows[] = {SHAPES(ROW_)};
enum { NSHAPES = sizeof rows / sizeof *rows };

const char *shape_word(ShapeKind kind) { return rows[kind].word; }

/* A statement being read. */
typedef struct {
  Drawing *d;
  const AstStmt *st;
  const ShapeRow *row;
  Name effect;
  Shape *shape;
} DrawReader;

/* --- values --- */

int drawn_value(Drawing *d, Expr value, Dim dim) {
  Builder *b = d->b;
  uint32_t there = expr_map_get(&d->column, value);
  if (there) return (int)there - 1;
  Output o = {.name = intern_printf(b, "drawing.%u", b->m->scene.ndrawn + 1), .unit = unit_si(dim, ""), .value = value};
  vec_push(b->arena, &b->m->scene.outputs, o);
  b->m->scene.ndrawn++;
  expr_map_set(&d->column, value, b->m->scene.outputs.n);
  return (int)b->m->scene.outputs.n - 1;
}

void drawn_place(Drawing *d, const Value *v, int out[3]) {
  uint32_t n = v->n ? v->n : 1;
  for (uint32_t k = 0; k < n; k++) out[k] = drawn_value(d, v->at[k], d->place);
}

Shape *add_shape(Drawing *d, ShapeKind kind, const char *role, const char *text) {
  Scene *sc = &d->b->m->scene;
  Shape s = {.kind = kind, .role = role, .text = text};
  memset(s.a, -1, sizeof s.a);
  memset(s.b, -1, sizeof s.b);
  memset(s.size, -1, sizeof s.size);
  memset(s.turn, -1, sizeof s.turn);
  vec_push(d->b->arena, &sc->shapes, s);
  return &sc->shapes.at[sc->shapes.n - 1];
}

/* Checks that a value is a length of the drawing; a plain number is one in SI. 0, reported, if not. */
static int is_length(DrawReader *r, const Value *v, AstId id) {
  Builder *b = r->d->b;
  Span span = ast_expr(b->ast, id)->span;
  if (v->bare || is_zero(b, v)) return 1;
  if (r->d->place == DIM_ANY) r->d->place = v->dim;
  if (dim_equate(b->dims, v->dim, r->d->place, span)) return 1;
  diag_error(b->diags, span, "units do not match: this is %s, other places and sizes of the drawing are %s",
             in_dim(b, v->dim), in_dim(b, r->d->place));
  diag_help(b->diags, "all places of a drawing have one unit; divide by a scale, or multiply by `1 [%s]`",
            dim_text(b->dims, r->d->place));
  explain_dims(b, v->dim, r->d->place);
  return 0;
}

static Value option_value(DrawReader *r, AstId id) { return resolve(r->d->b, id, IN_OUTPUT, r->effect); }

/* Value of a place: a vector, or a number along the first axis. e = 0 after an error. */
static Value place_value(DrawReader *r, AstId id) {
  Value v = option_value(r, id);
  Builder *b = r->d->b;
  if (v.e && v.n > 3) {
    diag_error(b->diags, ast_expr(b->ast, id)->span, "this is %s, but a place is needed here" HELP
               "a place is `(x, y)`, `(x, y, z)` or a vector", shape_text(b, v.n));
    return (Value){0};
  }
  return v.e && is_length(r, &v, id) ? v : (Value){0};
}

/* Outputs of a place. ground: a number is a height. */
static void read_place(DrawReader *r, AstId id, int out[3]) {
  Value v = place_value(r, id);
  if (!v.e) return;
  int ground = r->shape->kind == SHAPE_GROUND && !v.n;
  drawn_place(r->d, &v, out + ground);
}

static void read_sizes(DrawReader *r, AstId id, int least, int most) {
  Builder *b = r->d->b;
  Value v = option_value(r, id);
  int n = v.n ? (int)v.n : 1;
  if (!v.e) return;
  if (n < least || n > most) {
    const char *many = most == 1 ? "a number is" : least == 3 ? "three lengths are" : "two or three lengths are";
    diag_error(b->diags, ast_expr(b->ast, id)->span, "this is %s, but %s needed here" HELP "for example `%s`",
               shape_text(b, v.n), many, r->row->example);
    return;
  }
  if (!is_length(r, &v, id)) return;
  for (int k = 0; k < n; k++) r->shape->size[k] = drawn_value(r->d, v.at[k], r->d->place);
}

static void read_turn(DrawReader *r, AstId id, int only_rotation) {
  Builder *b = r->d->b;
  Span span = ast_expr(b->ast, id)->span;
  Value v = option_value(r, id);
  if (!v.e) return;
  if ((v.n && v.n != ROTATION) || (only_rotation && v.n != ROTATION)) {
    diag_error(b->diags, span, "this is %s, but %s is needed here", shape_text(b, v.n),
               only_rotation ? "a rotation" : "an angle or a rotation");
    if (only_rotation) diag_help(b->diags, "declare `coord R: rotation`; with an angle, `%s`", rows[SHAPE_BOX].example);
    else diag_help(b->diags, "for example `%s`", r->row->example);
  } else if (!v.n && !v.bare && !is_zero(b, &v) && !dim_equate(b->dims, v.dim, DIM_NONE, span)) {
    diag_error(b->diags, span, "this is %s, but an angle is needed here", in_dim(b, v.dim));
  } else {
    for (uint32_t k = 0; k < (v.n ? v.n : 1); k++) r->shape->turn[k] = drawn_value(r->d, v.at[k], DIM_NONE);
  }
}

static void read_count(DrawReader *r, AstId id) {
  int64_t n;
  Builder *b = r->d->b;
  if (!resolve_whole(b, id, r->effect, &n)) return;
  if (n >= 0 && n <= 1000) r->shape->count = (int)n;
  else diag_error(b->diags, ast_expr(b->ast, id)->span, "a number from 0 to 1000 is needed here");
}

static void read_role(DrawReader *r, AstId id) {
  Builder *b = r->d->b;
  const AstExpr *x = ast_expr(b->ast, id);
  if (x->kind == AST_NAME && has_word(DRAW_ROLES, x->name)) {
    r->shape->role = x->name;
    return;
  }
  diag_error(b->diags, x->span, "unknown role `%s`" HELP "the roles, each with its colour, are %s", ast_text(b, id),
             DRAW_ROLES);
}

/* --- arrows and curves --- */

/* The vector of an arrow; with a scale, the place that it spans. */
static void read_arrow(DrawReader *r, AstId scale) {
  Builder *b = r->d->b;
  AstId id = r->st->lhs;
  Value v = option_value(r, id), s = scale ? option_value(r, scale) : (Value){0};
  if (!v.e || (scale && !s.e)) return;
  if (v.n != 2 && v.n != 3) {
    diag_error(b->diags, ast_expr(b->ast, id)->span, "an arrow is a vector, and this is %s" HELP
               "write its components: `%s`", shape_text(b, v.n), r->row->example);
    return;
  }
  if (scale && s.n) {
    diag_error(b->diags, ast_expr(b->ast, scale)->span, "a scale is a number, and this is %s", shape_text(b, s.n));
    return;
  }
  if (scale) {
    Value length = {.n = v.n, .dim = dim_mul(b->dims, v.dim, s.dim), .bare = v.bare && s.bare};
    for (uint32_t k = 0; k < v.n; k++) length.at[k] = expr_mul(b->g, v.at[k], s.e);
    if (s.bare && !v.bare) length.dim = r->d->place; /* a plain number: length of one unit of SI */
    if (is_length(r, &length, scale)) drawn_place(r->d, &length, r->shape->b);
    return;
  }
  r->shape->count = 1;
  for (uint32_t k = 0; k < v.n; k++) r->shape->b[k] = drawn_value(r->d, v.at[k], v.dim);
}

/* Range of a curve's variable, lo..hi; 0, reported, after an error. */
static int read_range(DrawReader *r, AstId bind, Value ends[2]) {
  Builder *b = r->d->b;
  const AstExpr *x = ast_expr(b->ast, bind);
  AstId ids[] = {x->a, x->b};
  if (x->kind != AST_BIND)
    return diag_error(b->diags, x->span, "a range is missing" HELP "for example `%s`", r->row->example);
  for (int k = 0; k < 2; k++) {
    ends[k] = option_value(r, ids[k]);
    if (ends[k].e && !need_number(b, ast_expr(b->ast, ids[k])->span, ends[k].n)) return 0;
    if (!ends[k].e || (r->st->rhs && !is_length(r, &ends[k], ids[k]))) return 0;
  }
  int plain = r->st->rhs && (ends[0].bare || ends[1].bare); /* a number is a length */
  if (plain || dims_agree(b, &ends[0], &ends[1], x->span)) return 1;
  return diag_error(b->diags, x->span, "units do not match: the range begins at %s and ends at %s",
                    in_dim(b, ends[0].dim), in_dim(b, ends[1].dim));
}

/* Point of a curve at value s of its variable. */
static Value curve_point(DrawReader *r, const Value *of, SymId sym, Expr s) {
  ExprGraph *g = r->d->b->g;
  Value p = *of;
  if (r->st->rhs) p = (Value){.at = {s, expr_replace(g, of->e, &sym, &s, 1)}, .n = 2, .dim = of->dim};
  else for (uint32_t k = 0; k < p.n; k++) p.at[k] = expr_replace(g, of->at[k], &sym, &s, 1);
  return p;
}

static void read_curve(DrawReader *r, AstId bind) {
  Builder *b = r->d->b;
  Value ends[2];
  AstId id = r->st->rhs ? r->st->rhs : r->st->lhs;
  b->m->scene.shapes.n--; /* its points are shapes */
  if (!read_range(r, bind, ends)) return;
  Dim dim = r->st->rhs ? r->d->place : is_zero(b, &ends[0]) ? ends[1].dim : ends[0].dim;
  Name name = ast_expr(b->ast, bind)->name;
  BoundName variable = {name, declare_symbol(b, SYM_LOCAL, 0, name, SIGN_UNKNOWN, dim)};
  b->bound = &variable;
  b->nbound = 1;
  Value of = place_value(r, id);
  b->nbound = 0;
  if (!of.e) return;
  if (r->st->rhs ? of.n : !of.n) {
    diag_error(b->diags, ast_expr(b->ast, id)->span, "this is %s" HELP "a curve is `curve y = f(x) for x in a..b`, or "
               "`curve (x, y) for s in a..b` with places", shape_text(b, of.n));
    return;
  }
  for (int k = 0; k <= CURVE_PARTS; k++) {
    Expr run = expr_scale(b->g, num_ratio(k, CURVE_PARTS), expr_sub(b->g, ends[1].e, ends[0].e));
    Value p = curve_point(r, &of, variable.sym, expr_add(b->g, ends[0].e, run));
    Shape *s = add_shape(r->d, SHAPE_CURVE, r->shape->role, NULL);
    s->count = CURVE_PARTS + 1 - k;
    drawn_place(r->d, &p, s->a);
  }
}

/* --- the statement --- */

static int find_shape(DrawReader *r) {
  Builder *b = r->d->b;
  Name names[NSHAPES];
  StrBuf all = strbuf(b->arena);
  for (uint32_t k = 0; k < NSHAPES; k++) {
    names[k] = intern(b->ast->names, rows[k].word);
    sb_printf(&all, "%s%s", k ? " " : "", rows[k].word);
    if (strcmp(rows[k].word, r->st->name) == 0) r->row = &rows[k];
  }
  if (r->row) return 1;
  Name near = suggest(r->st->name, names, NSHAPES);
  diag_error(b->diags, r->st->name_span, "unknown shape `%s`", r->st->name);
  if (near) diag_help(b->diags, "did you mean `%s`?", near);
  else diag_help(b->diags, "the shapes are %s; for example `%s`", sb_text(&all), rows[SHAPE_BALL].example);
  return 0;
}

/* Reports options that the shape does not take or that are given twice, missing ones and a wrong subject; 0 then. */
static int check_options(DrawReader *r) {
  Builder *b = r->d->b;
  const AstStmt *st = r->st;
  for (AstId i = st->args; i; i = ast_expr(b->ast, i)->next) {
    const AstExpr *x = ast_expr(b->ast, i);
    if (!has_word(r->row->needs, x->name) && !has_word(r->row->takes, x->name))
      return diag_error(b->diags, x->span, "a %s has no `%s`" HELP "it takes %s%s%s: `%s`", st->name, x->name,
                        r->row->needs, r->row->needs[0] ? " " : "", r->row->takes, r->row->example);
    if (ast_option_value(b->ast, st, x->name) == x->args) continue;
    return diag_error(b->diags, x->span, "`%s` is given twice" HELP "leave out one of them", x->name);
  }
  const char *word;
  for (size_t k = 0; (word = word_at(b->arena, r->row->needs, k)) && *word; k++) {
    if (ast_option_value(b->ast, st, word)) continue;
    diag_error(b->diags, st->span, "`draw %s` lacks `%s`" HELP "for example `%s`", st->name, word, r->row->example);
    return 0;
  }
  if (!st->lhs == !r->row->subject[0] && (!st->rhs || strcmp(st->name, "curve") == 0)) return 1;
  if (st->lhs && !r->row->subject[0])
    diag_error(b->diags, ast_expr(b->ast, st->lhs)->span, "nothing stands between `%s` and its options" HELP
               "for example `%s`", st->name, r->row->example);
  else
    diag_error(b->diags, st->span, "`draw %s` needs %s behind the shape" HELP "for example `%s`", st->name,
               r->row->subject, r->row->example);
  return 0;
}

static void read_option(DrawReader *r, const char *word, AstId id) {
  ShapeKind kind = r->shape->kind;
  if (has_word("from at of", word)) read_place(r, id, r->shape->a);
  else if (strcmp(word, "to") == 0) read_place(r, id, r->shape->b);
  else if (strcmp(word, "box") == 0) read_sizes(r, id, 3, 3);
  else if (strcmp(word, "size") == 0) read_sizes(r, id, 2, 3);
  else if (has_word("width radius", word)) read_sizes(r, id, 1, 1);
  else if (strcmp(word, "turn") == 0) read_turn(r, id, 0);
  else if (has_word("coils spokes", word)) read_count(r, id);
  else if (strcmp(word, "as") == 0) read_role(r, id);
  else if (strcmp(word, "scale") == 0 && kind == SHAPE_ARROW) return; /* read with the vector */
}

static const char *usual_role(ShapeKind kind) {
  static const char *const roles[NSHAPES] = {
      [SHAPE_ROD] = "link",    [SHAPE_SPRING] = "spring",   [SHAPE_DAMPER] = "spring",  [SHAPE_WALL] = "support",
      [SHAPE_GROUND] = "support", [SHAPE_CURVE] = "support", [SHAPE_PATH] = "path",     [SHAPE_ARROW] = "force",
      [SHAPE_TEXT] = "text"};
  return roles[kind] ? roles[kind] : "body";
}

/* Place in words, for those who do not see the drawing; NULL: none. */
static const char *place_words(DrawReader *r) {
  AstId at = ast_option_value(r->d->b->ast, r->st, "at");
  return at && !r->d->b->index.n ? ast_text(r->d->b, at) : NULL;
}

static void read_text(DrawReader *r) {
  const AstExpr *x = ast_expr(r->d->b->ast, r->st->lhs);
  if (x->kind == AST_STRING) r->shape->text = x->name;
  else
    diag_error(r->d->b->diags, x->span, "a text stands in quotes" HELP "for example `%s`", r->row->example);
}

static void read_member(DrawReader *r) {
  const AstStmt *st = r->st;
  Builder *b = r->d->b;
  ShapeKind kind = (ShapeKind)(r->row - rows);
  uint32_t at = b->m->scene.shapes.n;
  if (at >= MOST_SHAPES) {
    diag_error(b->diags, st->span, "a drawing has at most %d shapes" HELP "draw fewer members of the family",
               MOST_SHAPES);
    return;
  }
  Shape own = *add_shape(r->d, kind, usual_role(kind), place_words(r));
  r->shape = &own;
  for (AstId i = st->args; i; i = ast_expr(b->ast, i)->next)
    read_option(r, ast_expr(b->ast, i)->name, ast_expr(b->ast, i)->args);
  if (kind == SHAPE_BODY) read_turn(r, st->lhs, 1);
  if (kind == SHAPE_ARROW) read_arrow(r, ast_option_value(b->ast, st, "scale"));
  if (kind == SHAPE_TEXT) read_text(r);
  if (kind == SHAPE_CURVE) read_curve(r, ast_option_value(b->ast, st, "for"));
  else b->m->scene.shapes.at[at] = own;
}

/* Reads a `draw`, once for each member that its index names; a StatementFn. */
static void draw_statement(Builder *b, const AstStmt *st, Name effect, void *data) {
  DrawReader r = {.d = data, .st = st, .effect = effect};
  IndexRange range;
  uint32_t outer = b->index.n, errors = b->diags->errors;
  if (st->kind != STMT_DRAW || !find_shape(&r) || !check_options(&r)) return;
  if (!st->dims) {
    read_member(&r);
    return;
  }
  if (!resolve_indices(b, st->dims, effect, &range) || !range_count(&range)) return;
  int64_t at[2] = {range.lo[0], range.lo[1]};
  for (uint32_t k = 0; k < range.n; k++)
    if (range.name[k]) vec_push(b->arena, &b->index, ((IndexVar){range.name[k], at[k]}));
  do {
    for (uint32_t k = 0, i = outer; k < range.n; k++)
      if (range.name[k]) b->index.at[i++].at = at[k];
    read_member(&r);
  } while (b->diags->errors == errors && range_next(&range, at));
  b->index.n = outer;
}

void build_drawing(Builder *b, int wanted) {
  Drawing d = {.b = b, .column = expr_map(b->arena), .place = DIM_ANY};
  Scene *sc = &b->m->scene;
  uint32_t outputs = sc->outputs.n;
  for (uint32_t i = 0; i < b->active.n; i++)
    each_statement(b, b->active.at[i].stmt, b->active.at[i].effect, draw_statement, &d);
  for (const AstStmt **s = b->chain; *s; s++)
    for (const AstStmt *x = (*s)->body; x; x = x->next) draw_statement(b, x, NULL, &d);
  sc->guessed = !sc->shapes.n;
  if (wanted && sc->guessed && !b->diags->errors) guess_drawing(&d);
  if (wanted) return;
  sc->outputs.n = outputs;
  sc->shapes.n = sc->ndrawn = 0;
}
