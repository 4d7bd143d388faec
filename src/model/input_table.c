/* Tables: the file of `input u = "file.csv"` becomes a cubic spline (base/spline.h).
 *
 * A row has time in s, and value in the input's unit, separated by commas, semicolons, tabs or, in a table without
 * these, blanks. Blank lines and lines that begin with # are skipped. A first line whose first field is not a number
 * is a head: the time is the column `t` (or `time`), else the first; the value is the column named like the input,
 * or, of two columns, the other one. A head may state units, as lagc's own output does: `t [s],u [N]`; they must be
 * the input's. Without a head there are two columns. Each row has as many numbers as the head has names: decimal
 * commas do not pass as other columns. Two rows with the same time are a jump. A file that is no table is not
 * quoted. */
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "model/builder.h"
#include "syntax/parse.h"

enum { TABLE_ROWS_MAX = 100000, TABLE_MISTAKES_MAX = 5 };

/* Part of the file: offsets into its text. */
typedef struct {
  uint32_t begin, end;
} Piece;

typedef struct {
  Builder *b;
  Source file;
  AstId id;          /* the string in the model that names the file */
  const Input *in;
  Name stem;         /* the input's name without its effect */
  char separator;    /* ' ': any number of blanks */
  VEC(Piece) fields; /* of the current line, without blanks and quotes */
  uint32_t time, value; /* columns, from 0 */
  uint32_t columns;  /* of the head, or the first row */
  int holds;         /* a value holds until the next row */
  int begun;         /* the head or the first row was read */
  int wrong_head;    /* error in the head: rows are not read */
  int mistakes;
  double before;     /* time of the previous row */
  int jumped;        /* the previous row was the second one with its time */
  VEC(double) numbers; /* time, value in SI, row by row */
} Table;

static Span span_of(const Table *t, Piece p) { return (Span){t->file.base + p.begin, t->file.base + p.end}; }

static const char *text_of(const Table *t, Piece p) {
  return arena_strndup(t->b->arena, t->file.text + p.begin, p.end - p.begin);
}

static int is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

static Piece trimmed(const Table *t, Piece p) {
  const char *s = t->file.text;
  while (p.begin < p.end && is_blank(s[p.begin])) p.begin++;
  while (p.end > p.begin && is_blank(s[p.end - 1])) p.end--;
  return p;
}

/* Removes blanks and the quotes of a quoted field (RFC 4180). */
static Piece unquoted(const Table *t, Piece p) {
  const char *s = t->file.text;
  p = trimmed(t, p);
  if (p.end - p.begin >= 2 && s[p.begin] == '"' && s[p.end - 1] == '"') p.begin++, p.end--;
  return p;
}

/* Splits a line into t->fields. */
static void split(Table *t, Piece line) {
  const char *s = t->file.text;
  t->fields.n = 0;
  for (uint32_t at = line.begin, end; at <= line.end; at = end + 1) {
    int quoted = 0;
    for (end = at; end < line.end; end++) {
      if (s[end] == '"') quoted = !quoted;
      if (!quoted && (t->separator == ' ' ? is_blank(s[end]) : s[end] == t->separator)) break;
    }
    vec_push(t->b->arena, &t->fields, unquoted(t, (Piece){at, end}));
    while (t->separator == ' ' && end + 1 < line.end && is_blank(s[end + 1])) end++;
  }
}

static char find_separator(const Table *t, Piece line) {
  static const char known[] = {';', '\t', ','};
  for (size_t i = 0; i < sizeof known; i++)
    if (memchr(t->file.text + line.begin, known[i], line.end - line.begin)) return known[i];
  return ' ';
}

static int number(const Table *t, Piece p, double *x) { return num_parse_double(text_of(t, p), x); }

#define MISTAKE(t, p, ...) ((t)->mistakes++, diag_error((t)->b->diags, span_of(t, p), __VA_ARGS__))

/* A file of another kind: the mistake stands in the model, and the file is not shown. */
static void no_table(Table *t, const char *why) {
  diag_error(t->b->diags, ast_expr(t->b->ast, t->id)->span,
             "`%s` is not a table: %s" HELP
             "a table is a text with a row `time, value` in each line; a first line may name the columns",
             t->file.path, why);
  t->mistakes++;
}

/* --- the head --- */

static int same_letters(const char *a, const char *b, size_t n) {
  for (size_t i = 0; i < n; i++)
    if (tolower((unsigned char)a[i]) != tolower((unsigned char)b[i])) return 0;
  return 1;
}

/* 2 if a field of the head is `name`, without unit, 1 if a word in other letters, upper or lower (t and T are two
 * names); *unit is the text in brackets after it. */
static int is_called(const Table *t, Piece field, const char *name, Piece *unit) {
  const char *s = t->file.text, *open = memchr(s + field.begin, '[', field.end - field.begin);
  Piece stem = {field.begin, open ? (uint32_t)(open - s) : field.end};
  *unit = (Piece){field.end, field.end};
  if (open && s[field.end - 1] == ']') *unit = (Piece){stem.end + 1, field.end - 1};
  stem = trimmed(t, stem);
  size_t n = strlen(name);
  if (n != stem.end - stem.begin || !same_letters(s + stem.begin, name, n)) return 0;
  return memcmp(s + stem.begin, name, n) == 0 ? 2 : n > 1;
}

/* First column called `name`, from column `from` on, in the same letters if there is one; `none` if there is none. */
static uint32_t find_column(const Table *t, uint32_t from, const char *name, uint32_t none) {
  Piece unit;
  for (int like = 2; like > 0; like--)
    for (uint32_t i = from; i < t->fields.n; i++)
      if (is_called(t, t->fields.at[i], name, &unit) >= like) return i;
  return none;
}

/* Parses a unit of the head; reported, with DIM_ANY, when it is none. */
static Unit unit_written(const Table *t, const char *text) {
  Builder *b = t->b;
  Arena *a = b->ast->sources->arena; /* messages quote the text when the model is gone */
  const char *whole = arena_printf(a, "1 [%s]", text), *name = arena_printf(a, "unit in %s", t->file.path);
  const Source *source = source_add(b->ast->sources, name, whole, strlen(whole));
  AstId id = source ? parse_expression(b->ast, source) : 0;
  AstUnit none = {0};
  int is_unit = id && ast_expr(b->ast, id)->kind == AST_UNIT;
  return unit_resolve(is_unit ? &ast_expr(b->ast, id)->unit : &none, b->dims, b->diags, b->arena);
}

static int same_unit(const Table *t, const Unit *x, const Unit *y, Span why) {
  return dim_equate(t->b->dims, x->dim, y->dim, why) && num_equal(x->factor, y->factor) && x->pi_power == y->pi_power &&
         num_equal(x->offset, y->offset);
}

/* Reports a unit in the head other than the input's (want), or seconds (want NULL); spelling does not matter. */
static void check_unit(Table *t, Piece field, const Unit *want, const char *whose) {
  Piece unit;
  is_called(t, field, "", &unit);
  const char *text = text_of(t, trimmed(t, unit)), *wanted = want ? want->text : "s";
  if (!*text || strcmp(text, wanted) == 0) return;
  uint32_t errors = t->b->diags->errors;
  Unit is = unit_written(t, text), second = want ? *want : unit_written(t, "s");
  if (t->b->diags->errors > errors) t->mistakes++;
  else if (!*wanted || !same_unit(t, &is, &second, span_of(t, field))) {
    const char *other = *wanted ? arena_printf(t->b->arena, "is in [%s]", wanted) : "has no unit";
    MISTAKE(t, field, "this column is in [%s], and %s %s", text, whose, other);
    if (want) diag_help(t->b->diags, "convert the column, or declare `input %s [%s] = ...`", t->stem, text);
    else diag_help(t->b->diags, "convert the column to seconds");
  }
}

/* Reports another column with the name of column k, units and upper or lower case aside. */
static void check_twins(Table *t, uint32_t k) {
  Piece unit;
  is_called(t, t->fields.at[k], "", &unit);
  Piece name = trimmed(t, (Piece){t->fields.at[k].begin, unit.begin < unit.end ? unit.begin - 1 : t->fields.at[k].end});
  uint32_t again = find_column(t, k + 1, text_of(t, name), t->fields.n);
  if (again == t->fields.n) return;
  const char *called = text_of(t, name),
             *but = is_called(t, t->fields.at[again], called, &unit) < 2 ? ", but for upper and lower case" : "";
  MISTAKE(t, t->fields.at[again], "two columns are called `%s`%s" HELP "give one of them another name", called, but);
}

static void read_head(Table *t, Piece line) {
  uint32_t n = t->fields.n, again;
  t->time = find_column(t, 0, "t", find_column(t, 0, "time", 0));
  t->value = find_column(t, 0, t->stem, n > 2 ? n : 1 - t->time);
  if (n < 2) no_table(t, "it has one column");
  else if ((again = find_column(t, 0, "", n)) < n) {
    Piece column = {t->fields.at[again].begin, again + 1 < n ? t->fields.at[again + 1].begin : 0};
    MISTAKE(t, again + 1 < n ? column : line,
            "column %u has no name" HELP "name every column, as in `t,%s`, and end no line with a separator", again + 1,
            t->stem);
  } else if (t->value == n) {
    MISTAKE(t, line, "none of these %u columns is called `%s`" HELP "give the column of the values that name", n,
            t->stem);
  } else if (t->value == t->time) MISTAKE(t, t->fields.at[0], "the column of the time is also that of the value");
  else {
    check_unit(t, t->fields.at[t->time], NULL, "the time");
    check_unit(t, t->fields.at[t->value], &t->in->unit, arena_printf(t->b->arena, "`%s`", t->stem));
    check_twins(t, t->time);
    check_twins(t, t->value);
  }
  t->wrong_head = t->mistakes > 0;
}

/* --- rows --- */

static int read_number(Table *t, Piece line, uint32_t column, const char *what, double *x, Piece *field) {
  Builder *b = t->b;
  uint32_t n = t->fields.n;
  if (n <= column) {
    MISTAKE(t, line,
            "the %s is in column %u, but this row has %u" HELP "a row is `time, value`; a comment begins with `#`",
            what, column + 1, n);
    return 0;
  }
  *field = t->fields.at[column];
  if (number(t, *field, x)) return 1;
  if (field->begin == field->end) MISTAKE(t, ((Piece){field->begin, field->begin + 1}), "the %s is missing", what);
  else MISTAKE(t, *field, "the %s is not a number", what);
  if (memchr(t->file.text + field->begin, ',', field->end - field->begin))
    diag_help(b->diags, "numbers are written with a point: `0.5`");
  else
    diag_help(b->diags,
              "numbers are decimal and finite: `0.5`, `1e-3`; the row can be left out, or commented out with `#`");
  return 0;
}

static void read_row(Table *t, Piece line) {
  double time, value;
  Piece at, of;
  const char *nul = memchr(t->file.text + line.begin, '\0', line.end - line.begin);
  if (nul) {
    no_table(t, "it has bytes that are not text");
    t->wrong_head = 1;
    return;
  }
  if (t->fields.n != t->columns && t->fields.n > t->time && t->fields.n > t->value) {
    MISTAKE(t, line, "this row has %u fields, and the first line %u", t->fields.n, t->columns);
    diag_help(t->b->diags, t->separator == ',' ? "numbers are written with a point, `0.5`, and separated by commas"
                                               : "each row has one number for each column");
    return;
  }
  if (!read_number(t, line, t->time, "time", &time, &at) || !read_number(t, line, t->value, "value", &value, &of))
    return;
  double before = t->before;
  int jumps = t->numbers.n && time == before;
  if (t->numbers.n && (time < before || (jumps && t->jumped))) {
    char now[32], then[32];
    num_format_double(now, time);
    num_format_double(then, before);
    MISTAKE(t, at, jumps ? "this is the third row at %s" : "times must increase, and %s does not come after %s", now,
            then);
    diag_help(t->b->diags, "sort the rows; a jump is two rows of one time: the value before it, and the one after it");
    return;
  }
  t->before = time;
  t->jumped = jumps;
  if (t->holds && jumps && t->numbers.n > 2) t->numbers.n -= 2; /* holds for no time */
  else if (t->holds && t->numbers.n && !jumps) { /* a jump at each row */
    double last = t->numbers.at[t->numbers.n - 1];
    vec_push(t->b->arena, &t->numbers, time);
    vec_push(t->b->arena, &t->numbers, last);
    jumps = 1;
  }
  if (jumps) time = nextafter(time, HUGE_VAL); /* no step of the runtime crosses such a gap */
  vec_push(t->b->arena, &t->numbers, time);
  vec_push(t->b->arena, &t->numbers, value * unit_factor(&t->in->unit) + num_value(t->in->unit.offset));
}

static void read_line(Table *t, Piece line) {
  double x;
  line = trimmed(t, line);
  if (line.begin == line.end || t->file.text[line.begin] == '#') return;
  int first = !t->begun;
  t->begun = 1;
  if (first) t->separator = find_separator(t, line);
  split(t, line);
  if (first) t->columns = t->fields.n;
  if (first && !number(t, t->fields.at[0], &x)) read_head(t, line);
  else if (first && t->columns > 2) {
    MISTAKE(t, line, "this table has %u columns, and no first line that names them", t->columns);
    diag_help(t->b->diags, "begin with a line of names, `t,%s,...`; numbers are written with a point, `0.5`", t->stem);
    t->wrong_head = 1;
  } else read_row(t, line);
}

static void read_lines(Table *t) {
  for (uint32_t at = 0; at < t->file.len && !t->wrong_head && t->mistakes < TABLE_MISTAKES_MAX;) {
    const char *nl = memchr(t->file.text + at, '\n', t->file.len - at);
    uint32_t end = nl ? (uint32_t)(nl - t->file.text) : t->file.len;
    read_line(t, (Piece){at, end});
    at = end + 1;
    if (t->numbers.n <= 2 * TABLE_ROWS_MAX) continue;
    MISTAKE(t, ((Piece){0, 1}), "a table has at most %d rows" HELP "leave rows out: a cubic runs between each two",
            TABLE_ROWS_MAX);
    return;
  }
}

/* --- the file --- */

/* Reads the file, once for all scenes. */
static int find_table_file(Table *t, const char *path) {
  Builder *b = t->b;
  if (!*path) path = ".";
  const Sources *all = b->ast->sources;
  for (uint32_t i = 0; i < all->files.n; i++)
    if (strcmp(all->files.at[i].path, path) == 0) {
      t->file = all->files.at[i];
      return 1;
    }
  const char *error = NULL;
  const Source *file = source_read(b->ast->sources, path, &error);
  if (file) {
    t->file = *file;
    return 1;
  }
  diag_error(b->diags, ast_expr(b->ast, t->id)->span, "cannot read `%s`: %s", path, error);
  const char *from = source_place(all, ast_expr(b->ast, t->id)->span.begin).file->path,
             *beside = path_relative_to(b->arena, all->files.at[0].path, path);
  if (!strchr(from, '=')) diag_help(b->diags, "the path is relative to the file that names it");
  else if (source_read(b->ast->sources, beside, &error))
    diag_help(b->diags, "on the command line a path is relative to the folder where lagc is called: write `%s`",
              beside);
  else diag_help(b->diags, "on the command line a path is relative to the folder where lagc is called");
  return 0;
}

/* Warns of overshoot by more than half the range of values: a cubic overshoots where rows are sparse near a steep rise.
 * (A step between equidistant rows overshoots by an eighth.) */
static void warn_of_overshoot(const Table *t, const Spline *s) {
  enum { PARTS = 16 }; /* of each interval */
  double lo = s->row[0][1], hi = lo, low = lo, high = lo;
  for (uint32_t i = 0; i < s->n; i++) {
    lo = fmin(lo, s->row[i][1]);
    hi = fmax(hi, s->row[i][1]);
  }
  for (uint32_t i = 0; i + 1 < s->n; i++)
    for (int k = 0; k <= PARTS; k++) {
      double y = (double)spline_at(s, 0, s->row[i][0] + (s->row[i + 1][0] - s->row[i][0]) * k / PARTS);
      low = fmin(low, y);
      high = fmax(high, y);
    }
  if (lo - low <= (hi - lo) / 2 && high - hi <= (hi - lo) / 2) return;
  double unit = unit_factor(&t->in->unit), zero = num_value(t->in->unit.offset);
  diag_warning(t->b->diags, ast_expr(t->b->ast, t->id)->span,
               "between its rows the curve goes from %.3g to %.3g, and the rows from %.3g to %.3g", (low - zero) / unit,
               (high - zero) / unit, (lo - zero) / unit, (hi - zero) / unit);
  diag_help(t->b->diags, "a cubic swings where rows lie far apart beside a steep rise: add rows there, or make it a "
                         "jump, two rows of one time; `hold(\"file.csv\")` holds each value until the next row");
}

/* Fits a spline to each piece between two jumps. */
static int fit_pieces(Arena *a, double (*row)[3], uint32_t n) {
  for (uint32_t from = 0, to = 1; to <= n; to++) {
    if (to < n && row[to][0] != nextafter(row[to - 1][0], HUGE_VAL)) continue;
    if (!spline_fit(a, row + from, to - from)) return 0;
    from = to;
  }
  return 1;
}

/* The spline through all rows; NULL, reported, for fewer than two rows or an infinite curve. */
static const Spline *fit(Table *t) {
  Builder *b = t->b;
  uint32_t n = t->numbers.n / 2;
  Span span = ast_expr(b->ast, t->id)->span;
  if (n < 2) {
    diag_error(b->diags, span, "the table `%s` has %s, and a curve needs two", t->file.path, n ? "one row" : "no rows");
    diag_help(b->diags, "a row is `time, value`; a constant is written `input %s = 1`", t->stem);
    return NULL;
  }
  double(*row)[3] = arena_alloc(b->arena, n * sizeof *row);
  for (uint32_t i = 0; i < n; i++) {
    row[i][0] = t->numbers.at[2 * i];
    row[i][1] = t->numbers.at[2 * i + 1];
  }
  if (!fit_pieces(b->arena, row, n)) {
    diag_error(b->diags, span, "the curve through `%s` is not finite", t->file.path);
    diag_help(b->diags, "rows are too close, or values too far apart, for double precision");
    return NULL;
  }
  Spline *s = ARENA_NEW(b->arena, Spline);
  *s = (Spline){n, (const double(*)[3])row, NULL};
  warn_of_overshoot(t, s);
  return s;
}

static const Spline *read_table(Builder *b, const Input *in, Name stem, AstId id) {
  Table t = {.b = b, .id = id, .in = in, .stem = stem, .value = 1, .holds = in->holds};
  const AstExpr *x = ast_expr(b->ast, id);
  Place from = source_place(b->ast->sources, x->span.begin);
  if (!find_table_file(&t, source_locate(b->ast->sources, from.file ? from.file->path : "", x->name))) return NULL;
  read_lines(&t);
  return t.mistakes ? NULL : fit(&t);
}

/* The file name in `hold("file.csv")`; 0: rhs is another value. */
static AstId held_file(Builder *b, AstId rhs) {
  const AstExpr *x = ast_expr(b->ast, rhs);
  if (x->kind != AST_CALL || !x->args || ast_expr(b->ast, x->args)->kind != AST_STRING) return 0;
  if (strcmp(x->name, "hold") != 0)
    diag_error(b->diags, x->span,
               "a file is a table by itself, or held from row to row" HELP
               "write `\"%s\"`, or `hold(\"%s\")`; an integral is that of an input, `integral(a)`",
               ast_expr(b->ast, x->args)->name, ast_expr(b->ast, x->args)->name);
  return x->args;
}

void give_input(Builder *b, uint32_t index, Name stem, AstId rhs, Name effect) {
  Input *in = &b->m->inputs.at[index];
  in->value = 0;
  in->table = NULL;
  in->file = "";
  in->text = in->integral = 0;
  in->effect = effect;
  if (is_input_integral(b, rhs)) {
    in->integral = rhs;
    return;
  }
  AstId held = held_file(b, rhs);
  in->holds = held != 0;
  rhs = held ? held : rhs;
  if (ast_expr(b->ast, rhs)->kind != AST_STRING) {
    in->value = resolve_in(b, rhs, IN_INPUT, effect, &in->unit);
    in->text = rhs;
    return;
  }
  in->file = ast_expr(b->ast, rhs)->name;
  in->table = read_table(b, in, stem, rhs);
}
