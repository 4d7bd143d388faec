/* Measures: numbers that one keeps of a run. Enters: `measure top = max(y) - h`, or an expression of the command line.
 * Leaves: its words for the runtime (runtime/analysis/measure.h), operations behind their operands, and its unit.
 * Holds: names, events, shapes and units are checked here. Arithmetic of quantities stays as it is; any other
 * expression, and in a scene what stands inside max( ), becomes an output. A function of measures is its text. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/words.h"
#include "model/builder.h"
#include "numeric/functions.def"

typedef struct {
  const char *text; /* words; NULL: not read yet, or wrong */
  Value value;      /* of the result: dimension, whether it is a plain number, and the node of an operand */
  Unit unit;        /* in which it is shown; text "": in SI */
  int measured;     /* 1: a value of the whole run */
  int varies;       /* 1: it changes along the run */
  int number;       /* 1: made of numbers and pi; value.e is its node */
  int plain;        /* 1: of numbers without a unit alone */
} Part;

/* Arguments of a function whose text is read. */
typedef struct {
  AstId name; /* the first */
  const Part *part;
  int depth;
} Frame;

typedef struct {
  Builder *b;
  AstId first, last;
  Part *part;      /* by node, of first to last */
  uint8_t *inside; /* 1: the node belongs to an operand that is read as a whole */
  uint8_t *whole;  /* 1: the node contains a value of the whole run, or an argument of the frame */
  const Frame *frame;
  int command;     /* 1: of the command line: plain numbers are in the unit beside them, mismatches draw warnings */
} MeasureReader;

typedef enum { CALL_TRACK, CALL_HIT, CALL_COUNT, CALL_FUNCTION, CALL_AT, CALL_TEXT, CALL_ELSE } CallKind;

/* Units of measures along the run; their words. */
enum { OF_VALUE, OF_DIFFERENCE, OF_TIME };
#define TRACK_UNIT(KIND, name, unit, how) {#name, unit},
static const struct {
  const char *name;
  int unit;
} tracks[] = {TRACKS(TRACK_UNIT)};
#define TRACK_WORD(KIND, name, unit, how) #name " "
static const char track_words[] = TRACKS(TRACK_WORD);

enum { UNCHECKED = 2 };

/* Whether measures have the function. */
static int is_function(const char *name) {
#define WORD(OP, name, ...) #name " "
  return has_word(FUNCTIONS(WORD) "sqrt abs floor sign atan2 hypot min max pow", name);
}

static CallKind call_kind(const MeasureReader *r, AstId id) {
  const AstExpr *x = ast_expr(r->b->ast, id);
  const Entity *e = entity_named(r->b, x->name);
  AstId second = x->args ? ast_expr(r->b->ast, x->args)->next : 0;
  if (e && e->kind == ENT_FUNCTION) return r->whole[id - r->first] ? CALL_TEXT : CALL_ELSE;
  int alone = x->args && (!second || ast_expr(r->b->ast, second)->kind == AST_BIND); /* max(x, y) is the larger */
  if (alone && has_word(track_words, x->name)) return CALL_TRACK;
  if (strcmp(x->name, "hit") == 0) return CALL_HIT;
  if (strcmp(x->name, "count") == 0) return CALL_COUNT;
  if ((e && e->kind != ENT_NONE) || has_word("energy lagrangian t", x->name)) return CALL_AT;
  return is_function(x->name) ? CALL_FUNCTION : CALL_ELSE;
}

/* Reports a mismatch of units: 0, or UNCHECKED where the numbers are taken all the same. */
#define MISMATCH(r, ...) \
  ((r)->command ? (diag_warning((r)->b->diags, __VA_ARGS__), UNCHECKED) : (diag_error((r)->b->diags, __VA_ARGS__), 0))

static int is_arithmetic(AstKind kind) { return kind == AST_NEG || (kind >= AST_ADD && kind <= AST_POW); }

/* Argument of the frame, or NULL. */
static const Part *argument(const MeasureReader *r, Name name) {
  AstId id = r->frame ? r->frame->name : 0;
  for (uint32_t i = 0; id; id = ast_expr(r->b->ast, id)->next, i++)
    if (ast_expr(r->b->ast, id)->name == name) return &r->frame->part[i];
  return NULL;
}

/* "end", "lyapunov", "megno" where the model has no such name; NULL: another node. */
static const char *word_of_run(MeasureReader *r, const AstExpr *x) {
  if (x->kind != AST_NAME || !has_word("end lyapunov megno", x->name)) return NULL;
  return entity_named(r->b, x->name) ? NULL : x->name;
}

/* Whether the node by itself is a value of the whole run, or an argument of the frame. */
static uint8_t is_of_run(MeasureReader *r, AstId id) {
  const AstExpr *x = ast_expr(r->b->ast, id);
  CallKind call = x->kind == AST_CALL ? call_kind(r, id) : CALL_ELSE;
  if (x->kind == AST_NAME) return word_of_run(r, x) || argument(r, x->name);
  return x->kind == AST_AT || call == CALL_TRACK || call == CALL_HIT || call == CALL_COUNT || call == CALL_AT;
}

/* Marks nodes that contain such values: from arguments to parents. */
static void mark_whole(MeasureReader *r, AstId root) {
  for (AstId id = r->first; id <= root; id++) {
    const AstExpr *x = ast_expr(r->b->ast, id);
    const AstId parts[] = {x->a, x->b, x->c};
    uint8_t *whole = &r->whole[id - r->first];
    for (int k = 0; k < 3; k++) *whole |= parts[k] && r->whole[parts[k] - r->first];
    for (AstId arg = x->args; arg; arg = ast_expr(r->b->ast, arg)->next) *whole |= r->whole[arg - r->first];
    *whole |= is_of_run(r, id);
  }
}

static void mark_list(MeasureReader *r, AstId id) {
  for (; id; id = ast_expr(r->b->ast, id)->next) r->inside[id - r->first] = 1;
}

/* Marks the nodes that are read as parts of others: from parents to arguments, whose numbers are lower. */
static void mark_operands(MeasureReader *r, AstId root) {
  for (AstId id = root; id >= r->first; id--) {
    const AstExpr *x = ast_expr(r->b->ast, id);
    CallKind call = x->kind == AST_CALL ? call_kind(r, id) : CALL_ELSE;
    int output = call == CALL_ELSE || (call == CALL_TRACK && !r->command && !r->frame);
    int whole = r->inside[id - r->first] || (!is_arithmetic(x->kind) && x->kind != AST_AT && output);
    const AstId parts[] = {whole || x->kind == AST_AT ? x->a : 0, whole ? x->b : 0, whole ? x->c : 0};
    for (int k = 0; k < 3; k++)
      if (parts[k]) r->inside[parts[k] - r->first] = 1;
    if (whole) mark_list(r, x->args);
    else if (call == CALL_TRACK) mark_list(r, ast_expr(r->b->ast, x->args)->next);
    else if ((call == CALL_HIT || call == CALL_COUNT) && x->args) r->inside[x->args - r->first] = 1;
  }
}

static Part part_of(const char *text, Unit unit, int measured) {
  return (Part){.text = text, .value = {.dim = unit.dim}, .unit = unit, .measured = measured};
}

static const char *number_text(Builder *b, double x) {
  char text[32];
  num_format_double(text, x);
  return arena_strdup(b->arena, text);
}

/* A name as a word. */
static const char *name_word(Builder *b, const char *name) {
  return arena_printf(b->arena, strpbrk(name, " ()+-*/^") ? "\"%s\"" : "%s", name);
}

/* Unit in which symbol s is shown; NULL: it has no name in the runtime. */
static const Unit *unit_of_symbol(Builder *b, const Symbol *s, Unit *room) {
  Model *m = b->m;
  switch (s->kind) {
    case SYM_TIME: return *room = unit_si(b->dim_of.at[m->time], "s"), room;
    case SYM_COORD: return &m->coords.at[s->index].unit;
    case SYM_VEL: return *room = unit_per_second(b, &m->coords.at[s->index].unit), room;
    case SYM_STATE: return &m->states.at[s->index].unit;
    case SYM_INPUT: return &m->inputs.at[s->index].unit;
    case SYM_PARAM: return m->params.at[s->index].fixed ? NULL : &m->params.at[s->index].unit;
    case SYM_ACC: case SYM_RATE: case SYM_CONST: case SYM_MULTIPLIER: case SYM_LOCAL: break;
  }
  for (uint32_t i = 0; i < m->symmetries.n; i++)
    if (expr_symbol(b->g, m->symmetries.at[i].charge) == s) return &m->symmetries.at[i].unit;
  return NULL;
}

/* Refuses comparisons and choices of measures; 0. */
static int refuse_choice(MeasureReader *r, AstId id) {
  return diag_error(r->b->diags, ast_expr(r->b->ast, id)->span,
                    "`%s` is a choice among measures, which have none" HELP
                    "measure both sides, and compare them in the rows of a sweep; along the run a choice is an "
                    "observable: `max(if(x > 0, x, 0))`",
                    ast_short(r->b, id));
}

/* An operand of the language by its name in the runtime; it becomes an output where it has none. */
static Part operand(MeasureReader *r, AstId id) {
  Builder *b = r->b;
  int chooses = id <= r->last && r->whole[id - r->first]; /* at_time makes nodes behind the last */
  Value v = chooses && !refuse_choice(r, id) ? (Value){0} : resolve(b, id, IN_OUTPUT, NULL);
  Part p = part_of(NULL, unit_si(v.dim, ""), 0);
  Span span = ast_expr(b->ast, id)->span;
  p.value.bare = v.bare;
  p.value.e = v.e;
  if (!v.e) return p;
  if (v.n || v.condition) {
    const char *what = v.n ? "a vector" : "a condition";
    diag_error(b->diags, span, "a measure is made of numbers, and `%s` is %s", ast_short(b, id), what);
    if (v.n) diag_help(b->diags, "take a component: `%s.x`", ast_short(b, id));
    return p;
  }
  p.varies = (expr_kinds(b->g, v.e) & ~(1u << SYM_PARAM | 1u << SYM_CONST)) != 0;
  const Symbol *s = expr_op(b->g, v.e) == EX_SYM ? expr_sym_of(b->g, v.e) : NULL;
  int energy = s && expr_sym_id(b->g, v.e) == b->m->energy_sym;
  Unit room;
  int same = s && b->dim_of.at[expr_sym_id(b->g, v.e)] == v.dim; /* y/1 [m] is the symbol y, too, but a pure number */
  const Unit *own = same ? unit_of_symbol(b, s, &room) : NULL;
  if (own || energy) p.text = name_word(b, s->name);
  if (own && own->text[0]) p.unit = *own;
  p.unit.dim = v.dim;
  p.number = expr_is_num(b->g, v.e) || (s && s->kind == SYM_CONST);
  p.plain = expr_is_num(b->g, v.e) && v.bare;
  if (p.number) p.text = expr_is_num(b->g, v.e) ? number_text(b, num_value(expr_number(b->g, v.e))) : "pi()";
  if (p.text) return p;
  int output = add_outputs(b, id);
  if (output < 0) return p;
  const Output *o = &b->m->scene.outputs.at[output];
  p.text = name_word(b, o->name);
  p.unit = o->unit;
  return p;
}

static Unit seconds(Builder *b, const char *text) {
  return unit_si(b->unitless ? DIM_ANY : dim_base(b->dims, DIM_TIME), text);
}

static Part wrong_call(MeasureReader *r, const AstExpr *x, const char *form) {
  diag_error(r->b->diags, x->span, "a measure `%s` is written `%s`", x->name, form);
  return (Part){0};
}

/* ---- Arithmetic */

/* An operation on p and q: what it has of them. */
static Part joined(const char *text, Unit unit, const Part *p, const Part *q) {
  Part of = part_of(text, unit, p->measured || q->measured);
  of.varies = p->varies || q->varies;
  of.value.bare = p->value.bare && q->value.bare;
  of.number = p->number && q->number;
  of.plain = p->plain && q->plain;
  return of;
}

static int is_si(const Unit *u) { return !u->text[0] || (num_is_one(u->factor) && !u->pi_power); }

/* A term: the command line reads plain numbers beside a quantity in its unit. */
static const char *term(const MeasureReader *r, const Part *p, const Part *beside) {
  if (!r->command || !p->plain || beside->plain || is_si(&beside->unit)) return p->text;
  return arena_printf(r->b->arena, "%s %s *", p->text, unit_factor_text(r->b->arena, &beside->unit));
}

static int is_zero_part(const Builder *b, const Part *p) { return p->value.e && expr_is_zero(b->g, p->value.e); }

/* 1; 0 or UNCHECKED, reported, where operands have other units. */
static int units_fit(MeasureReader *r, Span span, AstId left, AstId right) {
  Builder *b = r->b;
  const Part *p = &r->part[left - r->first], *q = &r->part[right - r->first];
  const Part *number = p->value.bare ? p : q->value.bare ? q : NULL, *other = number == p ? q : p;
  if (b->unitless || is_zero_part(b, p) || is_zero_part(b, q)) return 1;
  if (number && (r->command || dim_is_open(b->dims, dim_resolved(b->dims, other->value.dim)))) return 1;
  if (dim_equate(b->dims, p->value.dim, q->value.dim, span)) return 1;
  const char *unit = dim_text(b->dims, other->value.dim);
  int fits = MISMATCH(r, span, "units do not match: `%s` is %s, `%s` %s", ast_short(b, left), in_dim(b, p->value.dim),
                      ast_short(b, right), in_dim(b, q->value.dim));
  if (number) diag_help(b->diags, "give the number its unit: `%s [%s]`", number->text, unit);
  return fits;
}

static int same_unit(const Unit *u, const Unit *v) {
  return strcmp(u->text, v->text) == 0 && num_equal(u->factor, v->factor) && u->pi_power == v->pi_power;
}

/* Unit of a sum: the common one, or that beside a number; in a scene pure numbers beside an angle are in radians. */
static Unit unit_of_sum(const MeasureReader *r, const Part *p, const Part *q) {
  int first = (p->plain && r->command) || (p->number && !q->number), second = (q->plain && r->command) || q->number;
  const Unit *u = first ? &q->unit : &p->unit;
  int fits = first || second || (same_unit(&p->unit, &q->unit) && num_is_zero(q->unit.offset));
  return fits && num_is_zero(u->offset) ? *u : unit_si(p->value.bare ? q->value.dim : p->value.dim, "");
}

static int is_pure(const Builder *b, const Part *p) {
  Dim dim = dim_resolved(b->dims, p->value.dim);
  return p->value.bare || (!p->unit.text[0] && (dim == DIM_NONE || dim_is_open(b->dims, dim)));
}

/* Unit of a product or quotient with a pure number: the other one's. */
static Unit unit_of_product(const Builder *b, int times, const Part *p, const Part *q) {
  Dim dim = (times ? dim_mul : dim_div)(b->dims, p->value.dim, q->value.dim);
  const Unit *u = is_pure(b, q) ? &p->unit : times && is_pure(b, p) ? &q->unit : NULL;
  Unit unit = u && num_is_zero(u->offset) ? *u : unit_si(dim, "");
  unit.dim = dim;
  return unit;
}

/* Unit of p to the power that node `exponent` is, where that is a number. */
static Unit unit_of_power(const MeasureReader *r, const Part *p, AstId exponent) {
  Value v = r->part[exponent - r->first].number && !r->frame ? resolve(r->b, exponent, IN_CONST, NULL) : (Value){0};
  int known = v.e && expr_is_num(r->b->g, v.e);
  return unit_si(known ? dim_pow(r->b->dims, p->value.dim, expr_number(r->b->g, v.e)) : DIM_NONE, "");
}

static Unit unit_of_size(const Part *p) { return num_is_zero(p->unit.offset) ? p->unit : unit_si(p->value.dim, ""); }

static Part arithmetic(MeasureReader *r, AstKind kind, Span span, AstId left, AstId right) {
  Builder *b = r->b;
  const Part *p = &r->part[left - r->first], *q = kind == AST_NEG ? p : &r->part[right - r->first];
  int sum = kind == AST_ADD || kind == AST_SUB, fits = 1;
  if (!p->text || !q->text || (sum && !(fits = units_fit(r, span, left, right)))) return (Part){0};
  if (kind == AST_NEG) return joined(arena_printf(b->arena, "%s neg()", p->text), unit_of_size(p), p, p);
  Unit unit = sum               ? unit_of_sum(r, p, q)
              : kind == AST_POW ? unit_of_power(r, p, right)
                                : unit_of_product(b, kind == AST_MUL, p, q);
  const char *first = sum ? term(r, p, q) : p->text, *second = sum ? term(r, q, p) : q->text;
  const char *text = arena_printf(b->arena, "%s %s %c", first, second, "+-*/^"[kind - AST_ADD]);
  return joined(text, fits == UNCHECKED ? unit_si(DIM_NONE, "") : unit, p, q);
}

/* ---- Functions of numbers */

static Part function_of_two(MeasureReader *r, const AstExpr *x, AstId left, AstId right) {
  const Part *p = &r->part[left - r->first], *q = &r->part[right - r->first];
  const char *word = strcmp(x->name, "min") == 0 ? "lesser" : strcmp(x->name, "max") == 0 ? "greater" : x->name;
  if (strcmp(x->name, "pow") == 0) return arithmetic(r, AST_POW, x->span, left, right);
  if (!p->text || !q->text || !units_fit(r, x->span, left, right)) return (Part){0};
  Unit unit = strcmp(x->name, "atan2") == 0 ? unit_si(DIM_NONE, "rad") : unit_of_sum(r, p, q);
  return joined(arena_printf(r->b->arena, "%s %s %s()", term(r, p, q), term(r, q, p), word), unit, p, q);
}

static Part function(MeasureReader *r, const AstExpr *x) {
  Builder *b = r->b;
  int two = has_word("atan2 hypot min max pow", x->name);
  if (ast_list_length(b->ast, x->args) != (two ? 2 : 1))
    return wrong_call(r, x, arena_printf(b->arena, two ? "%s(y, x)" : "%s(x)", x->name));
  if (two) return function_of_two(r, x, x->args, ast_expr(b->ast, x->args)->next);
  const Part *p = &r->part[x->args - r->first];
  Num root = num_ratio(1, strcmp(x->name, "sqrt") == 0 ? 2 : 3);
  Unit unit = has_word("sqrt cbrt", x->name) ? unit_si(dim_pow(b->dims, p->value.dim, root), "")
              : strcmp(x->name, "abs") == 0  ? unit_of_size(p)
                                             : unit_si(DIM_NONE, has_word("asin acos atan", x->name) ? "rad" : "");
  if (!p->text) return (Part){0};
  if (!has_word("abs sqrt cbrt sign", x->name) && !dim_equate(b->dims, p->value.dim, DIM_NONE, x->span) &&
      !MISMATCH(r, ast_expr(b->ast, x->args)->span, "`%s` takes a pure number or an angle, and this is %s", x->name,
                in_dim(b, p->value.dim)))
    return (Part){0};
  return joined(arena_printf(b->arena, "%s %s()", p->text, x->name), unit, p, p);
}

/* ---- Calls */

/* "10" of a window of time, in s; NULL, reported, if it is none. */
static const char *window_end(Builder *b, AstId id) {
  if (!id) return "";
  Value v = resolve(b, id, IN_CONST, NULL);
  if (!v.e) return NULL;
  Span span = ast_expr(b->ast, id)->span;
  if (expr_is_num(b->g, v.e) && (v.bare || dim_equate(b->dims, v.dim, seconds(b, "").dim, span)))
    return number_text(b, num_value(expr_number(b->g, v.e)));
  diag_error(b->diags, span, "`%s` is no end of a window of time" HELP
             "write numbers: `max(x, 10..20)`, `max(x, 1 [min]..2 [min])`", ast_short(b, id));
  return NULL;
}

/* "10..20", "" */
static const char *window_text(Builder *b, AstId id) {
  if (!id) return "";
  const AstExpr *x = ast_expr(b->ast, id);
  const char *from = window_end(b, x->a), *to = from ? window_end(b, x->b) : NULL;
  if (to && *from && *to && !(strtod(from, NULL) < strtod(to, NULL))) {
    diag_error(b->diags, x->span, "this window of time is empty");
    return NULL;
  }
  return to ? arena_printf(b->arena, "%s..%s", from, to) : NULL;
}

/* max(x), max(x, 10..20), ... */
static Part track(MeasureReader *r, AstId id) {
  Builder *b = r->b;
  const AstExpr *x = ast_expr(b->ast, id);
  Name name = x->name;
  Span span = x->span;
  AstId args = x->args, window = ast_expr(b->ast, args)->next;
  Part of = {.text = "", .measured = !r->frame && r->whole[args - r->first]};
  if (!of.measured) of = r->inside[args - r->first] ? operand(r, args) : r->part[args - r->first];
  const char *within = of.text ? window_text(b, window) : NULL;
  if (!within) return (Part){0};
  if (of.measured)
    diag_error(b->diags, ast_expr(b->ast, args)->span,
               "`%s` takes quantities, as x or x^2 + y^2; a value of the whole run stands outside", name);
  else if (!of.varies) diag_error(b->diags, span, "`%s` does not change along the run", ast_short(b, args));
  if (of.measured || !of.varies) return (Part){0};
  int of_unit = OF_VALUE;
  for (size_t i = 0; i < sizeof tracks / sizeof *tracks; i++)
    if (strcmp(tracks[i].name, name) == 0) of_unit = tracks[i].unit;
  Unit unit = of_unit == OF_TIME ? seconds(b, "s") : of.unit;
  if (of_unit == OF_DIFFERENCE) unit.offset = num_int(0);
  return part_of(arena_printf(b->arena, "%s %s(%s)", of.text, name, within), unit, 1);
}

/* hit(EVENT, n), count(EVENT) */
static Part event_time(MeasureReader *r, const AstExpr *x, int hit) {
  Builder *b = r->b;
  uint32_t n = ast_list_length(b->ast, x->args);
  if (n < 1 || n > (hit ? 2u : 1u)) return wrong_call(r, x, hit ? "hit(EVENT) or hit(EVENT, 3)" : "count(EVENT)");
  const char *event = ast_text(b, x->args);
  uint32_t k = 0, events = b->m->events.n;
  Name *names = ARENA_ARRAY(b->arena, Name, events + 1);
  for (uint32_t i = 0; i < events; i++) names[i] = b->m->events.at[i].name;
  while (k < events && strcmp(names[k], event) != 0) k++;
  if (k == events) {
    Name near = suggest(event, names, events);
    diag_error(b->diags, ast_expr(b->ast, x->args)->span, "no event is called `%s`", event);
    if (near) diag_help(b->diags, "did you mean `%s`?", near);
    else if (events) diag_help(b->diags, "the model has `%s`", names[0]);
    else diag_help(b->diags, "declare it: `event %s: x - 1 rising { }`", event);
    return (Part){0};
  }
  AstId second = ast_expr(b->ast, x->args)->next;
  const Part *nth = second ? &r->part[second - r->first] : NULL;
  if (nth && !nth->text) return (Part){0};
  double number = nth && ast_expr(b->ast, second)->kind == AST_NUM ? strtod(nth->text, NULL) : 1;
  if (number < 1 || number != floor(number) || (nth && (nth->measured || nth->varies))) {
    Span span = ast_expr(b->ast, second)->span;
    diag_error(b->diags, span, "no event happens for the `%s`th time", ast_short(b, second));
    diag_help(b->diags, "`hit(%s)` is its first time, `hit(%s, 2)` its second", event, event);
    return (Part){0};
  }
  if (!hit) return part_of(arena_printf(b->arena, "count(%s)", event), unit_si(DIM_NONE, ""), 1);
  return part_of(arena_printf(b->arena, "%s hit(%s)", nth ? nth->text : "1", event), seconds(b, "s"), 1);
}

/* x(10), th'(10): `what` at the time of part `time`. */
static Part at_time(MeasureReader *r, AstId what, AstId time) {
  Builder *b = r->b;
  const Part *t = &r->part[time - r->first];
  Part of = operand(r, what);
  if (!of.text || !t->text) return (Part){0};
  if (!t->value.bare && !dim_equate(b->dims, t->value.dim, seconds(b, "").dim, ast_expr(b->ast, time)->span) &&
      !MISMATCH(r, ast_expr(b->ast, time)->span, "a time is in [s], and this is %s", in_dim(b, t->value.dim)))
    return (Part){0};
  return part_of(arena_printf(b->arena, "%s %s at()", of.text, t->text), of.unit, 1);
}

static Part read_measure(Builder *b, AstId root, const Frame *frame, int command);

/* A function of measures: its text, with the arguments' words. */
static Part text_call(MeasureReader *r, AstId id) {
  enum { DEEPEST = 50 };
  Builder *b = r->b;
  const AstExpr *x = ast_expr(b->ast, id);
  const AstStmt *f = b->functions.at[entity_named(b, x->name)->index].stmt;
  uint32_t n = ast_list_length(b->ast, x->args), want = ast_list_length(b->ast, f->args), i = 0;
  int depth = r->frame ? r->frame->depth + 1 : 1, ok = 1;
  if (n != want) return wrong_call(r, x, arena_printf(b->arena, "%s(%s)", x->name, want == 1 ? "x" : "x, y, ..."));
  if (depth > DEEPEST) {
    diag_error(b->diags, x->span, "`%s` needs itself, or functions stand too deep in one another", x->name);
    return (Part){0};
  }
  Part *part = ARENA_ARRAY(b->arena, Part, n + 1);
  Span span = x->span;
  uint32_t errors = b->diags->errors;
  for (AstId arg = x->args; arg; arg = ast_expr(b->ast, arg)->next) part[i++] = r->part[arg - r->first];
  while (i) ok &= part[--i].text != NULL;
  Part p = ok ? read_measure(b, f->rhs, &(Frame){f->args, part, depth}, r->command) : (Part){0};
  int fresh = b->diags->errors > errors && !b->diags->list.at[b->diags->latest].note;
  if (fresh) diag_also(b->diags, span, "in this call");
  return p;
}

static Part call(MeasureReader *r, AstId id) {
  Builder *b = r->b;
  const AstExpr *x = ast_expr(b->ast, id);
  switch (call_kind(r, id)) {
    case CALL_TRACK: return track(r, id);
    case CALL_HIT: case CALL_COUNT: return event_time(r, x, strcmp(x->name, "hit") == 0);
    case CALL_FUNCTION: return function(r, x);
    case CALL_TEXT: return text_call(r, id);
    case CALL_ELSE:
      if (!has_word(track_words, x->name) || entity_named(b, x->name)) return operand(r, id);
      return wrong_call(r, x, arena_printf(b->arena, "%s(x)` or `%s(x, 10..20)", x->name, x->name));
    case CALL_AT: break;
  }
  if (ast_list_length(b->ast, x->args) != 1) return wrong_call(r, x, arena_printf(b->arena, "%s(10 [s])", x->name));
  Span at = x->op_span;
  AstExpr name = {.kind = AST_NAME, .name = x->name, .span = at, .op_span = at, .first = b->ast->exprs.n};
  AstId time = x->args;
  vec_push(b->arena, &b->ast->exprs, name);
  return at_time(r, b->ast->exprs.n - 1, time);
}

/* ---- The whole */

static Part read_node(MeasureReader *r, AstId id) {
  Builder *b = r->b;
  const AstExpr x = *ast_expr(b->ast, id);
  const char *word = word_of_run(r, &x);
  const Part *given = x.kind == AST_NAME ? argument(r, x.name) : NULL;
  if (given) return *given;
  if (word && *word == 'e') return part_of("end()", seconds(b, "s"), 1);
  if (word && *word == 'm') return part_of("megno()", unit_si(DIM_NONE, ""), 1);
  if (word) return part_of("lyapunov()", unit_si(dim_div(b->dims, DIM_NONE, seconds(b, "").dim), "1/s"), 1);
  if (x.kind == AST_CALL) return call(r, id);
  if (x.kind == AST_AT) return at_time(r, x.a, x.b);
  return is_arithmetic(x.kind) ? arithmetic(r, x.kind, x.span, x.a, x.b) : operand(r, id);
}

static Part read_measure(Builder *b, AstId root, const Frame *frame, int command) {
  enum { WORDS = 2000, LONGEST = 5*WORDS }; /* a function of functions can double it fifty times */
  MeasureReader r = {.b = b, .first = ast_expr(b->ast, root)->first, .last = root, .frame = frame, .command = command};
  uint32_t n = root - r.first + 1;
  r.part = ARENA_ARRAY(b->arena, Part, n);
  r.inside = ARENA_ARRAY(b->arena, uint8_t, n);
  r.whole = ARENA_ARRAY(b->arena, uint8_t, n);
  b->is_measuring++;
  mark_whole(&r, root);
  mark_operands(&r, root);
  for (AstId id = r.first; id <= root; id++) {
    Part *p = &r.part[id - r.first];
    if (!r.inside[id - r.first]) *p = read_node(&r, id);
    if (!p->text || strlen(p->text) < LONGEST) continue;
    Span span = ast_expr(b->ast, id)->span;
    diag_error(b->diags, span, "this measure has more than %d words: give its parts names, `let`", WORDS);
    *p = r.part[root - r.first] = (Part){0};
    break;
  }
  b->is_measuring--;
  return r.part[root - r.first];
}

static Measure measure_of(Name name, const Part *p) {
  return (Measure){.name = name, .text = p->text, .unit = p->unit, .alone = p->value.e && !strchr(p->text, ' ')};
}

void set_measure(Builder *b, const AstStmt *st) {
  Measures *list = &b->m->scene.measures;
  uint32_t errors = b->diags->errors, i = 0;
  Part p = read_measure(b, st->rhs, NULL, 0);
  if (!p.text || b->diags->errors > errors) return;
  while (i < list->n && list->at[i].name != st->name) i++;
  if (i == list->n) vec_push(b->arena, list, (Measure){0});
  list->at[i] = measure_of(st->name, &p);
}

void ask_measure(Builder *b, const CommandOutput *asked) {
  uint32_t outputs = b->m->scene.outputs.n;
  Part p = read_measure(b, asked->expr, NULL, 1);
  b->m->measured_outputs |= b->m->scene.outputs.n > outputs;
  if (p.text) vec_push(b->arena, &b->m->asked_measures, measure_of(asked->name, &p));
}

const char *measure_words(Arena *a, const Measure *m) {
  if (m->alone) return m->text;
  const Unit *u = &m->unit;
  const char *offset = num_is_zero(u->offset) ? "0" : decimal_literal(a, u->offset, 0);
  return arena_printf(a, "%s [%s %s %s]", m->text, unit_factor_text(a, u), offset, u->text);
}
