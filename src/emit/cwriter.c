/* Function bodies in C: spelling of values as expressions with minimal parentheses, statements in the order of the
 * program, stores at the end. Rounding is that of the program: expressions are grouped as computed. */
#include <stdio.h>
#include <string.h>

#include "emit/cwriter_impl.h"

enum { LINE_MAX_COLUMNS = 100, WRAP_COLUMNS = 120 };

/* --- expressions --- */

CExpr cwriter_operand(const Writer *w, Slot s) {
  if (!s) return (CExpr){arena_printf(w->a, "%s_C(0.0)", w->style->prefix), C_ATOM, 0};
  return w->piece[s];
}

static const char *wrapped(Writer *w, Slot s, int prec) {
  CExpr x = cwriter_operand(w, s);
  return x.prec < prec ? arena_printf(w->a, "(%s)", x.text) : x.text;
}

/* Whether i is a power of two: scaling by it is exact, so 2*(a*b) may be written 2*a*b. */
static int is_power_of_two(const Ins *i) {
  int64_t n = i->number.num, d = i->number.den;
  return i->op == IR_CONST && num_is_exact(i->number) && n > 0 && (n & (n - 1)) == 0 && (d & (d - 1)) == 0;
}

/* a op b, grouped as computed: the text rounds as the program does. */
static CExpr infix(Writer *w, const Ins *i, const char *op, int prec) {
  CExpr left = cwriter_operand(w, i->a), right = cwriter_operand(w, i->b);
  int one = left.prec == C_ATOM; /* not a number that turns of a loop multiply */
  int flat = i->op == IR_MUL && right.prec == C_MUL && right.text[0] != '-' && one &&
             is_power_of_two(&w->p->ins.at[i->a]);
  const char *a = wrapped(w, i->a, prec), *b = flat ? right.text : wrapped(w, i->b, prec == C_MUL ? C_ATOM : prec + 1);
  return (CExpr){arena_printf(w->a, "%s%s%s", a, op, b), prec, 0};
}

static CExpr constant(Writer *w, const Ins *i) {
  const char *text = c_number(w->a, w->style->prefix, i->number);
  return (CExpr){text, strchr(text, '/') ? C_MUL : text[0] == '-' ? C_UNARY : C_ATOM, 0};
}

/* Negation: -a*b is (-a)*b, which rounds like -(a*b); and -(-a*b) is a*b. */
static CExpr negative(Writer *w, const Ins *i) {
  CExpr x = cwriter_operand(w, i->a);
  int product = x.prec == C_MUL;
  if (product && x.text[0] == '-') return (CExpr){x.text + 1, C_MUL, 0};
  return (CExpr){arena_printf(w->a, "-%s", wrapped(w, i->a, product ? C_MUL : C_ATOM)), product ? C_MUL : C_UNARY, 0};
}

/* A call of `head` with n operands. */
static CExpr call(Writer *w, const char *head, const Ins *i, int n) {
  StrBuf b = strbuf(w->a);
  for (int k = 0; k < n; k++) sb_printf(&b, "%s%s", k ? ", " : "", cwriter_operand(w, ins_operand(i, k)).text);
  return (CExpr){arena_printf(w->a, "%s(%s)", head, sb_text(&b)), C_ATOM, 0};
}

static CExpr macro(Writer *w, const char *name, const Ins *i, int n) {
  return call(w, arena_printf(w->a, "%s_%s", w->style->prefix, name), i, n);
}

/* A function of the C library; sin and cos may be embedded in the file. */
static CExpr function(Writer *w, const char *fn, const Ins *i, int n) {
  int is_own = w->style->math && (strcmp(fn, "sin") == 0 || strcmp(fn, "cos") == 0);
  if (w->style->params && strcmp(fn, "fabs") == 0) return macro(w, "ABS", i, n);
  return call(w,
              is_own ? arena_printf(w->a, "%s_%s", w->style->math, fn)
                     : arena_printf(w->a, "%s_FN(%s)", w->style->prefix, fn),
              i, n);
}

/* Element `index` of an array: p->m1 where the parameters are a struct. */
static const char *element(const Writer *w, const char *array, uint32_t index) {
  const CStyle *st = w->style;
  int member = st->params && strcmp(array, st->in[ARR_P]) == 0;
  return member ? arena_printf(w->a, "%s->%s", array, st->params[index]) : arena_printf(w->a, "%s[%u]", array, index);
}

const char *cwriter_array(const Writer *w, IrArray array) { return array == ARR_CELL ? w->cells : w->style->in[array]; }

static CExpr load(const Writer *w, const Ins *i) {
  const char *array = cwriter_array(w, i->array);
  return (CExpr){ir_is_scalar(i->array) ? array : element(w, array, i->index), C_ATOM, 0};
}

/* sign, min and max through SELECT: vectors have no ternary. */
static CExpr choose(Writer *w, const Ins *i) {
  const char *m = w->style->prefix, *a = wrapped(w, i->a, C_CMP + 1);
  if (i->op == IR_SIGN)
    return (CExpr){
        arena_printf(w->a, "%s_SELECT(%s > %s_C(0.0), %s_C(1.0), %s_SELECT(%s < %s_C(0.0), -%s_C(1.0), %s_C(0.0)))", m,
                     a, m, m, m, a, m, m, m),
        C_ATOM, 0};
  const char *b = wrapped(w, i->b, C_CMP + 1);
  return (CExpr){arena_printf(w->a, "%s_SELECT(%s %s %s, %s, %s)", m, a, i->op == IR_MIN ? "<" : ">", b, a, b), C_ATOM,
                 0};
}

static CExpr solved(Writer *w, const Ins *i) {
  const Solve *k = &w->p->solves.at[w->p->ins.at[i->a].index];
  return (CExpr){arena_printf(w->a, "w[%u]", solve_elements(k) + i->index), C_ATOM, 0};
}

CExpr cwriter_spell(Writer *w, const Ins *i) {
  const char *m = w->style->prefix;
  switch (i->op) {
    case IR_CONST: return constant(w, i);
    case IR_PI: return (CExpr){arena_printf(w->a, "%s_C(3.14159265358979323846264338327950288)", m), C_ATOM, 0};
    case IR_LOAD: return load(w, i);
    case IR_ADD: return infix(w, i, " + ", C_ADD);
    case IR_SUB: return infix(w, i, " - ", C_ADD);
    case IR_MUL: return infix(w, i, "*", C_MUL);
    case IR_DIV: return infix(w, i, "/", C_MUL);
    case IR_NEG: return negative(w, i);
    case IR_SQRT: return w->together ? call(w, "lag_turns_sqrt", i, 1) : function(w, "sqrt", i, 1);
    case IR_FN1: return function(w, i->text, i, 1);
    case IR_FN2: return function(w, i->text, i, 2);
    case IR_MIN: case IR_MAX: case IR_SIGN: return choose(w, i);
    case IR_LT: return infix(w, i, " < ", C_CMP);
    case IR_LE: return infix(w, i, " <= ", C_CMP);
    case IR_EQ: return infix(w, i, " == ", C_CMP);
    case IR_NOT: return macro(w, "NOT", i, 1);
    case IR_AND: return macro(w, "AND", i, 2);
    case IR_OR: return macro(w, "OR", i, 2);
    case IR_SELECT: return macro(w, "SELECT", i, 3);
    case IR_SOLVED: return solved(w, i);
    case IR_PIVOT: case IR_SOLVE: case IR_NEST: case IR_TABLE: case IR_TITLE: break;
  }
  return (CExpr){"", C_ATOM, 0};
}

/* --- statements --- */

/* Columns of the text in lines that are filled: indices from 100 on, as of x_2151 = q[2150] or D2151, count as four
 * digits, so that lines break in the same places whatever the size of a family is (late_text.h). */
static size_t columns_of(const char *text, size_t n) {
  enum { FROM = 3, COUNT = 4, TO = 7 };
  size_t columns = n;
  for (size_t i = 0, digits; i < n; i += digits ? digits : 1) {
    for (digits = 0; i + digits < n && text[i + digits] >= '0' && text[i + digits] <= '9';) digits++;
    if (digits >= FROM && digits <= TO && i > 0 && strchr("_[DL", text[i - 1])) columns += COUNT - digits;
  }
  return columns;
}

void cwriter_statement(Writer *w, const char *text) {
  size_t column = 2 + w->indent;
  sb_printf(w->out, "%*s", (int)column, "");
  while (*text) {
    size_t n = strcspn(text + 1, " ") + 1; /* a word with the space before it */
    const size_t columns = columns_of(text, n);
    if (*text == ' ' && column > 8 + w->indent && column + columns > WRAP_COLUMNS) {
      sb_printf(w->out, "\n%*s", (int)(5 + w->indent), "");
      column = 5 + w->indent;
    }
    sb_putn(w->out, text, n);
    column += columns;
    text += n;
  }
}

void cwriter_line(Writer *w, const char *text) {
  cwriter_statement(w, text);
  sb_putc(w->out, '\n');
}

/* Whether the text is short enough to stand inside another expression; a long prefix counts as three letters. */
int cwriter_is_short(const Writer *w, CExpr x) {
  enum { INLINE_MAX = 64 };
  size_t n = columns_of(x.text, strlen(x.text)), prefix = strlen(w->style->prefix);
  for (const char *s = x.text; prefix > 3 && (s = strstr(s, w->style->prefix)) != NULL; s += prefix) n -= prefix - 3;
  return n <= INLINE_MAX;
}

void cwriter_flush_title(Writer *w) {
  if (!w->title) return;
  sb_printf(w->out, "\n  /* %s */\n", comment_text(w->a, w->title));
  w->title = NULL;
}

static int is_identifier(const char *s) {
  for (; *s; s++)
    if (!((*s >= 'a' && *s <= 'z') || (*s >= 'A' && *s <= 'Z') || (*s >= '0' && *s <= '9') || *s == '_')) return 0;
  return 1;
}

/* Name of an operand if it is an identifier with a meaning (not w1); else NULL. */
static const char *meaningful_name(const CExpr *x) {
  return x->text && !x->counted && is_identifier(x->text) ? x->text : NULL;
}

static const char *made_name(Writer *w, const Ins *i) {
  CExpr x = cwriter_operand(w, i->a), y = cwriter_operand(w, i->b);
  const Ins *top = &w->p->ins.at[i->a];
  return ir_made_name(w->a, i, top->op == IR_CONST && num_is_one(top->number), meaningful_name(&x),
                      meaningful_name(&y));
}

CExpr cwriter_name(Writer *w, const Ins *i) {
  if (w->again && is_identifier(w->again[i - w->p->ins.at].text)) return w->again[i - w->p->ins.at];
  const char *made = i->name ? i->name : made_name(w, i);
  if (made) return (CExpr){cnames_take(&w->names, made), C_ATOM, 0};
  const char *stem = ir_is_condition(i->op) ? "is" : "w";
  return (CExpr){cnames_take(&w->names, arena_printf(w->a, "%s%u", stem, ++w->temps)), C_ATOM, 1};
}

/* Comment for a name that C cannot spell: x1', and the derivatives d_x1' and x1'_drift. */
static const char *meaning(Writer *w, const char *name) {
  static const char drift[] = "_drift";
  size_t n = strlen(name), end = sizeof drift - 1;
  if (!strchr(name, '\'')) return name;
  int drifts = n > end && strcmp(name + n - end, drift) == 0, by = strncmp(name, "d_", 2) == 0;
  if (drifts) name = arena_strndup(w->a, name, n - end);
  if (by) name = arena_printf(w->a, "the derivative by %s", name + 2);
  return drifts ? arena_printf(w->a, "rate of %s, without q''", name) : by ? name + 4 : name;
}

void cwriter_declare(Writer *w, Slot s, CExpr name, CExpr x) {
  const Ins *i = &w->p->ins.at[s];
  cwriter_flush_title(w);
  const char *type = arena_printf(w->a, "%s_%s", w->style->prefix, ir_is_condition(i->op) ? "MASK" : "REAL");
  cwriter_statement(w, arena_printf(w->a, "const %s %s = %s;", w->together ? "lag_turns" : type, name.text, x.text));
  /* in a loop, the name common to all turns */
  const char *said = i->name && w->indent ? cloop_stem(w->a, i->name) : i->name;
  if (said && strcmp(said, name.text) != 0) sb_printf(w->out, " /* %s */", comment_text(w->a, meaning(w, said)));
  sb_putc(w->out, '\n');
  w->piece[s] = name;
}

void cwriter_pivot(Writer *w, const Ins *i) {
  const char *m = w->style->prefix;
  cwriter_flush_title(w);
  cwriter_line(w, i->index ? arena_printf(w->a, "%s_POSITIVE(%s);", m, cwriter_operand(w, i->a).text)
                                : arena_printf(w->a, "%s_PIVOT(%s != %s_C(0.0));", m, wrapped(w, i->a, C_CMP + 1), m));
}

/* Rows of a table, as many on a line as fit. */
void cwrite_rows(const IrTable *table, const char *name, const char *prefix, const char *indent, Arena *a,
                 StrBuf *out) {
  const Spline *c = table->curve;
  const int width = c->jet ? 4 : 3;
  sb_printf(out, "%s/* %s: time, value, %ssecond derivative. */\n", indent, comment_text(a, table->file),
            c->jet ? "first and " : "");
  sb_printf(out, "%sstatic const %s_LANE %s[%u][%d] = {", indent, prefix, name, c->n, width);
  size_t column = WRAP_COLUMNS;
  for (uint32_t k = 0; k < c->n; k++) {
    const double *x = c->jet ? c->jet[k] : c->row[k];
    StrBuf row = strbuf(a);
    sb_printf(&row, " %s_%s(", prefix, c->jet ? "JET" : "ROW");
    for (int i = 0; i < width; i++) {
      char number[32];
      num_format_double(number, x[i]);
      sb_printf(&row, "%s%s", i ? ", " : "", number);
    }
    sb_puts(&row, k + 1 < c->n ? ")," : ")");
    const size_t columns = columns_of(row.at, row.n);
    if (column + columns > WRAP_COLUMNS) {
      sb_printf(out, "\n%s ", indent);
      column = strlen(indent) + 1;
    }
    sb_putn(out, sb_text(&row), row.n);
    column += columns;
  }
  sb_printf(out, "\n%s};\n", indent);
}

/* The name of a table's rows, which are written once: a rate shares those of its input. */
static const char *rows_of(Writer *w, const Ins *i) {
  const IrTable *table = &w->p->tables.at[i->index];
  if (w->style->rows) return w->style->rows[i->index];
  for (uint32_t k = 0; k < w->nrows; k++)
    if (w->rows[k].curve == table->curve) return w->rows[k].name;
  const char *name = cnames_take(&w->names, arena_printf(w->a, "%s_rows", table->name));
  cwrite_rows(table, name, w->style->prefix, "  ", w->a, w->out);
  if (w->nrows < sizeof w->rows / sizeof *w->rows)
    w->rows[w->nrows].curve = table->curve, w->rows[w->nrows++].name = name;
  return name;
}

static void write_table(Writer *w, Slot s, const Ins *i) {
  const IrTable *table = &w->p->tables.at[i->index];
  const char *name = rows_of(w, i), *t = cwriter_operand(w, i->a).text;
  const char *call =
      table->curve->jet
          ? arena_printf(w->a, "%s(%s, %u, %s, %d)", w->style->curve, t, table->curve->n, name, table->order)
          : arena_printf(w->a, "%s(%s, %u, %s)", w->style->spline, t, table->curve->n, name);
  w->piece[s] = (CExpr){call, C_ATOM, 0};
}

/* Used loads of one array, by index; 0: none. */
static Slot *loads_of(Writer *w, int array, uint32_t *n) {
  const Prog *p = w->p;
  *n = 0;
  for (Slot s = 1; s < p->ins.n; s++)
    if (p->ins.at[s].op == IR_LOAD && (int)p->ins.at[s].array == array && p->ins.at[s].index >= *n)
      *n = p->ins.at[s].index + 1;
  Slot *at = ARENA_ARRAY(w->a, Slot, *n + 1);
  for (Slot s = 1; s < p->ins.n; s++)
    if (p->ins.at[s].op == IR_LOAD && (int)p->ins.at[s].array == array && w->uses[s] && cloop_names_load(w, s))
      at[p->ins.at[s].index] = s;
  return at;
}

/* Declares the named loads of an array once, as many on a line as fit. */
static void write_array(Writer *w, int array) {
  size_t column = 0;
  uint32_t n;
  if (w->named[array]) return;
  w->named[array] = 1;
  const Slot *at = loads_of(w, array, &n);
  for (uint32_t k = 0; k < n; k++) {
    if (!at[k]) continue;
    CExpr x = load(w, &w->p->ins.at[at[k]]);
    if (w->style->loads_inline || ir_is_scalar((IrArray)array) || array >= ARR_SUMS) {
      w->piece[at[k]] = x;
      continue;
    }
    const char *name = cnames_take(&w->names, w->p->ins.at[at[k]].name);
    const char *text = arena_printf(w->a, "%s = %s", name, x.text);
    if (column && column + columns_of(text, strlen(text)) + 2 >= LINE_MAX_COLUMNS) {
      sb_puts(w->out, ";\n");
      column = 0;
    }
    const char *full =
        column ? arena_printf(w->a, ", %s", text) : arena_printf(w->a, "  const %s_REAL %s", w->style->prefix, text);
    sb_puts(w->out, full);
    column += columns_of(full, strlen(full));
    w->piece[at[k]] = (CExpr){name, C_ATOM, 0};
  }
  if (column) sb_puts(w->out, ";\n");
}

static void write_arrays(Writer *w) {
  for (int array = 0; array < ARR_COUNT; array++) write_array(w, array);
}

/* Declares the loads of the arrays that instruction s reads: here and not at the top, where calls in between would
 * have to save them. */
void cwriter_arrays_of(Writer *w, Slot s) {
  for (int which = 0; which < 3; which++) {
    const Ins *x = &w->p->ins.at[ins_operand(&w->p->ins.at[s], which)];
    if (x->op == IR_LOAD) write_array(w, (int)x->array);
  }
}

static void count_uses(Writer *w) {
  const Prog *p = w->p;
  w->uses = prog_uses(p);
  for (Slot s = 1; s < p->ins.n; s++) {
    const Ins *i = &p->ins.at[s];
    if (i->op != IR_PIVOT && i->op != IR_SIGN && i->op != IR_MIN && i->op != IR_MAX) continue;
    w->uses[i->a]++; /* spelled twice */
    w->uses[i->b]++;
  }
  for (uint32_t k = 0; k < p->stores.n; k++) w->stored[p->stores.at[k].slot] = p->stores.at[k].comment;
}

/* Pairs the sine and cosine of the same value: one sincos call computes both. */
void cwriter_find_sincos(Writer *w) {
  const Prog *p = w->p;
  Slot *sine = ARENA_ARRAY(w->a, Slot, p->ins.n);
  w->pair = ARENA_ARRAY(w->a, Slot, p->ins.n);
  for (int turn = 0; turn < 2 && w->style->math; turn++)
    for (Slot s = 1; s < p->ins.n; s++) {
      const Ins *i = &p->ins.at[s];
      if (i->op != IR_FN1 || strcmp(i->text, turn ? "cos" : "sin") != 0) continue;
      if (!turn) sine[i->a] = s;
      else if (sine[i->a] && cloop_share_turn(w, s, sine[i->a])) w->pair[w->pair[s] = sine[i->a]] = s;
    }
}

/* Appends "sin_x, cos_x" to names and "x, &sin_x, &cos_x" to arguments. */
static void declare_pair(Writer *w, Slot s, const Ins *first, const Ins *second, StrBuf *names, StrBuf *arguments) {
  const char *x = cwriter_operand(w, first->a).text;
  CExpr a = cwriter_name(w, first), b = cwriter_name(w, second);
  int in_order = strcmp(first->text, "sin") == 0;
  sb_printf(names, "%s%s, %s", names->n ? ", " : "", a.text, b.text);
  sb_printf(arguments, "%s%s, &%s, &%s", arguments->n ? ", " : "", x, in_order ? a.text : b.text,
            in_order ? b.text : a.text);
  w->piece[s] = a;
  w->piece[w->pair[s]] = b;
}

int cwriter_declare_sincos(Writer *w, Slot s, const Ins *first, const Ins *second) {
  Slot pair = w->pair[s];
  if (!pair || pair < s) return pair != 0;
  StrBuf names = strbuf(w->a), arguments = strbuf(w->a);
  declare_pair(w, s, first, second, &names, &arguments);
  cwriter_flush_title(w);
  cwriter_statement(w, arena_printf(w->a, "%s_REAL %s;", w->style->prefix, sb_text(&names)));
  sb_printf(w->out, " %s_sincos(%s);\n", w->style->math, sb_text(&arguments));
  return 1;
}

static int is_computed_before(const Writer *w, Slot x, Slot s) { return x < s || w->p->ins.at[x].op == IR_LOAD; }

/* Collects, from s on, up to SINCOS_BATCH sines or cosines with a pair whose angles are known when s is computed;
 * returns their number. */
static uint32_t collect_sincos(const Writer *w, Slot s, Slot *at) {
  enum { NEAR = 400 };
  uint32_t n = 0;
  for (Slot k = s; k < w->p->ins.n && k < s + NEAR && n < SINCOS_BATCH; k++)
    if (w->pair[k] > k && !w->piece[k].text && !cloop_contains(w, k) && is_computed_before(w, w->p->ins.at[k].a, s))
      at[n++] = k;
  return n;
}

/* Computes sines and cosines outside of loops by calls for two or four angles, which processors overlap. Returns 0
 * if s has no pair, or fewer than two angles are left. */
static int write_sincos_batch(Writer *w, Slot s) {
  if (!w->pair[s] || w->piece[s].text) return w->pair[s] != 0;
  Slot at[SINCOS_BATCH];
  uint32_t n = collect_sincos(w, s, at);
  if (n < 2) return 0;
  n = n < SINCOS_BATCH ? 2 : SINCOS_BATCH;
  for (uint32_t k = 0; k < n; k++) cwriter_arrays_of(w, at[k]);
  StrBuf names = strbuf(w->a), arguments = strbuf(w->a);
  for (uint32_t k = 0; k < n; k++)
    declare_pair(w, at[k], &w->p->ins.at[at[k]], &w->p->ins.at[w->pair[at[k]]], &names, &arguments);
  cwriter_flush_title(w);
  cwriter_line(w, arena_printf(w->a, "%s_REAL %s;", w->style->prefix, sb_text(&names)));
  cwriter_line(w, arena_printf(w->a, "%s_sincos%u(%s);", w->style->math, n, sb_text(&arguments)));
  return 1;
}

void cwriter_instruction(Writer *w, Slot s) {
  const Ins *i = &w->p->ins.at[s];
  if (i->op == IR_TITLE) {
    w->title = i->text;
    return;
  }
  cwriter_arrays_of(w, s);
  if (i->op == IR_PIVOT) {
    cwriter_pivot(w, i);
    return;
  }
  if (i->op == IR_SOLVE) {
    write_arrays(w);
    csolve_write(w, i);
    return;
  }
  if (i->op == IR_TABLE) {
    write_table(w, s, i);
    return;
  }
  if (i->op == IR_NEST) {
    cnest_write(w, i);
    return;
  }
  if (ir_is_leaf(i->op) || ccubes_write(w, s) || write_sincos_batch(w, s) ||
      cwriter_declare_sincos(w, s, i, &w->p->ins.at[w->pair[s]]))
    return;
  CExpr x = cwriter_spell(w, i);
  int told = !i->name || (w->stored[s] && strcmp(i->name, w->stored[s]) == 0); /* the store's comment says the name */
  int part = w->uses[s] <= 1 && told && cwriter_is_short(w, x) && i->op != IR_SOLVED;
  if (part) w->piece[s] = x;
  else cwriter_declare(w, s, cwriter_name(w, i), x);
}

const char *cwriter_guard(const Writer *w, const char *index) {
  return w->style->guard ? arena_printf(w->a, "if (!%s[%s]) ", w->style->guard, index) : "";
}

static void write_store(Writer *w, const Store *st) {
  const char *text = cwriter_operand(w, st->slot).text;
  const char *target = element(w, w->style->out[st->array], st->index), *member = strstr(target, "->");
  int said = !st->comment[0] || strcmp(st->comment, text) == 0 ||
             (w->style->params && member && strcmp(member + 2, st->comment) == 0);
  const char *guard = cwriter_guard(w, arena_printf(w->a, "%u", st->index));
  cwriter_statement(w, arena_printf(w->a, "%s%s = %s;", guard, target, text));
  if (!said) sb_printf(w->out, " /* %s */", comment_text(w->a, st->comment));
  sb_putc(w->out, '\n');
}

/* Store k + 1 if its element follows that of store k in the same array; else NULL. */
static const Store *next_store(const Writer *w, uint32_t k) {
  const Store *st = &w->p->stores.at[k];
  return k + 1 < w->p->stores.n && st[1].array == st->array && st[1].index == st->index + 1 ? st + 1 : NULL;
}

/* Whether store k, at an even index, is written together with its neighbour. */
static int is_paired(const Writer *w, uint32_t k) {
  const Store *st = &w->p->stores.at[k], *other = next_store(w, k);
  if (!(w->style->paired >> st->array & 1) || st->index % 2 != 0) return 0;
  return other ? !w->rolls.stored[k + 1] : (w->style->padded >> st->array & 1) != 0;
}

static uint32_t write_pair(Writer *w, uint32_t k) {
  const Store *st = &w->p->stores.at[k], *other = next_store(w, k);
  const char *x = cwriter_operand(w, st->slot).text, *y = cwriter_operand(w, other ? other->slot : 0).text;
  cwriter_line(
      w, arena_printf(w->a, "%s_PAIR(%s, %u, %s, %s);", w->style->prefix, w->style->out[st->array], st->index, x, y));
  return other ? 2 : 1;
}

static void write_stores(Writer *w) {
  for (uint32_t k = 0; k < w->p->stores.n;) {
    if (!k) sb_putc(w->out, '\n');
    if (w->rolls.stored[k]) {
      k++;
      continue;
    }
    uint32_t n = cloop_stores(w, k);
    if (n) cloop_write_stores(w, k, n);
    else if (is_paired(w, k)) n = write_pair(w, k);
    else write_store(w, &w->p->stores.at[k]);
    k += n ? n : 1;
  }
}

/* Bit set of the arrays that can be indexed by a variable: not scalars such as t, nor struct members. */
static unsigned arrays_by_index(const CStyle *style) {
  return style->params ? 1u << ARR_Q | 1u << ARR_V | 1u << ARR_Z | 1u << ARR_U | 1u << ARR_CELL
                       : ~(1u << ARR_T | 1u << ARR_ORDER | 1u << ARR_PER_ORDER | 1u << ARR_UP);
}

/* Whether stores may stand in loops: no array is both read and written, nor members of a struct. */
static int stores_apart(const Prog *p, const CStyle *style) {
  if (style->params && p->stores.n && strcmp(style->in[ARR_P], style->out[p->stores.at[0].array]) == 0) return 0;
  if (style->apart) return 1;
  for (int k = 0; k < ARR_COUNT; k++) {
    if (k == ARR_CELL || k == ARR_OUTER || k == ARR_INDEX || !prog_reads(p, (IrArray)k)) continue; /* local */
    for (uint32_t s = 0; s < p->stores.n; s++)
      if (strcmp(style->in[k], style->out[p->stores.at[s].array]) == 0) return 0;
  }
  return 1;
}

void cwriter_init_pieces(Writer *w) {
  w->piece = ARENA_ARRAY(w->a, CExpr, w->p->ins.n);
  for (Slot s = 1; s < w->p->ins.n; s++) {
    const Ins *i = &w->p->ins.at[s];
    if (i->op == IR_CONST || i->op == IR_PI) w->piece[s] = cwriter_spell(w, i);
  }
}

static void write_code(Writer *w) {
  uint32_t next = 0; /* loop */
  for (Slot s = 1; s < w->p->ins.n; s++) {
    uint32_t in = w->rolls.place[s] ? w->rolls.loop[w->rolls.place[s] - 1] : 0;
    if (!in) cwriter_instruction(w, s);
    else if (in > next) cloop_write(w, in - 1), next = in;
  }
}

void cwrite_body(const Prog *p, const CStyle *style, Arena *a, StrBuf *out) {
  Writer w = {.p = p, .style = style, .a = a, .names = cnames_new(a), .out = out};
  /* programs with nests are long */
  const double times = style->times > 0 ? style->times : 1;
  uint32_t from = p->nests.n ? 0 : (uint32_t)((style->prefer_short_code ? ROLL_SELDOM_FROM : ROLL_FROM)/times);
  w.rolls = roll_find(p, arrays_by_index(style), from, stores_apart(p, style));
  w.stored = ARENA_ARRAY(a, const char *, p->ins.n), w.in_call = ARENA_ARRAY(a, unsigned char, p->ins.n);
  cwriter_init_pieces(&w);
  for (const char *const *own = style->own; *own; own++) cnames_reserve(&w.names, *own);
  for (const char *const *g = style->globals; g && *g; g++) cnames_reserve(&w.names, *g);
  if (p->solves.n) cnames_reserve(&w.names, "w"), cnames_reserve(&w.names, "i"); /* i: counter in csolve_write */
  count_uses(&w);
  cloop_prepare(&w);
  cnest_prepare(&w);
  if (prog_has_pivots(p) && !style->is_regular) sb_printf(out, "  %s_PIVOTS;\n", style->prefix);
  cwriter_find_sincos(&w);
  if (w.rolls.loops.n || p->nests.n) write_arrays(&w);
  write_code(&w);
  write_arrays(&w);
  write_stores(&w);
}

int prog_reads(const Prog *p, IrArray array) {
  for (uint32_t k = 0; k < prog_parts(p); k++)
    for (Slot s = 1; s < prog_part(p, k)->ins.n; s++)
      if (prog_part(p, k)->ins.at[s].op == IR_LOAD && prog_part(p, k)->ins.at[s].array == array) return 1;
  return 0;
}

static void put_count(StrBuf *b, uint64_t n, const char *one, const char *many) {
  if (!n) return;
  sb_printf(b, "%s%llu %s", b->n ? ", " : "", (unsigned long long)n, n == 1 ? one : many);
}

const char *op_count_text(const Prog *p, Arena *a) {
  OpCount c = prog_count(p);
  StrBuf b = strbuf(a);
  put_count(&b, c.add, "addition", "additions");
  put_count(&b, c.mul, "multiplication", "multiplications");
  put_count(&b, c.div, "division", "divisions");
  put_count(&b, c.sqrt, "square root", "square roots");
  put_count(&b, c.fn, "function call", "function calls");
  put_count(&b, c.other, "comparison or choice", "comparisons and choices");
  return arena_printf(a, "%llu operations%s%s", (unsigned long long)ops_total(c), b.n ? ": " : "", sb_text(&b));
}
