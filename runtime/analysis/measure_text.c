/* Measures from text (measure.h has the notation). Enters: the text of an expression, the names of a scene; leaves: nodes, each with the unit of its
 * value. Holds: recursion is limited to DEEPEST; a wrong text leaves a message with the character. Precedence: + -, * /, unary -, ^. */
#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/measure_nodes.h"
#include "core/core.h"

enum { DEEPEST = 50, LONGEST_NAME = 128 };

typedef struct Reader {
  Measures *m;
  const char *text, *at; /* the expression, and the next character */
  int depth;
  const char *within;    /* the abbreviation that is being read; NULL: the expression itself */
  char *why;
  size_t size;
} Reader;

static const MeasureUnit none = {UNIT_NONE, "", 1, 0}, in_si = {UNIT_SI, "", 1, 0}, mixed = {UNIT_MIXED, "", 1, 0}, seconds = {UNIT_KNOWN, "s", 1, 0}, radians = {UNIT_KNOWN, "rad", 1, 0},
                         rates = {UNIT_KNOWN, "1/s", 1, 0};

static const char *const track_words[TRACK_KINDS] = {"max", "min", "mean", "rms", "drift", "period"};
static const char *const event_words[] = {"hit", "count"};

static double add(double a, double b) { return a + b; }
static double subtract(double a, double b) { return a - b; }
static double multiply(double a, double b) { return a * b; }
static double divide(double a, double b) { return a / b; }
static double negative(double a) { return -a; }

static const MeasureFunction functions[] = {
  {"sin", sin, NULL}, {"cos", cos, NULL}, {"tan", tan, NULL}, {"asin", asin, NULL}, {"acos", acos, NULL}, {"atan", atan, NULL},
  {"sinh", sinh, NULL}, {"cosh", cosh, NULL}, {"tanh", tanh, NULL}, {"sqrt", sqrt, NULL}, {"cbrt", cbrt, NULL}, {"exp", exp, NULL},
  {"log", log, NULL}, {"abs", fabs, NULL}, {"floor", floor, NULL}, {"atan2", NULL, atan2}, {"hypot", NULL, hypot},
};
enum { FUNCTIONS = sizeof functions / sizeof *functions };

/* Writes the message; returns -1. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
static int fail(Reader *r, const char *at, const char *format, ...) {
  va_list list;
  int n = r->within ? snprintf(r->why, r->size, "%s: %s: ", r->text, r->within) : snprintf(r->why, r->size, "%s: character %d: ", r->text, (int)(at - r->text) + 1);
  if (n < 0 || (size_t)n >= r->size) return -1;
  va_start(list, format);
  vsnprintf(r->why + n, r->size - (size_t)n, format, list);
  va_end(list);
  return -1;
}

/* ---- Nodes */

/* A new node; -1 after a message. a, b: arguments or -1. */
static int put(Reader *r, MeasureKind kind, int a, int b, MeasureUnit unit) {
  Measures *m = r->m;
  if (m->nnodes == m->room) {
    int room = m->room ? 2 * m->room : 32;
    MeasureNode *node = realloc(m->node, (size_t)room * sizeof *node);
    if (!node) return fail(r, r->at, "out of memory");
    m->node = node;
    m->room = room;
  }
  MeasureNode *n = &m->node[m->nnodes];
  *n = (MeasureNode){.kind = kind, .begin = m->nnodes, .a = a, .b = b, .unit = unit, .known = MEASURE_STATIC, .result = NAN};
  const int arguments[] = {b, a};
  for (int i = 0; i < 2; i++) {
    if (arguments[i] < 0) continue;
    const MeasureNode *of = &m->node[arguments[i]];
    n->begin = of->begin;
    n->measured |= of->measured;
    n->known = of->known > n->known ? of->known : n->known;
  }
  return m->nnodes++;
}

static int number(Reader *r, double x, MeasureUnit unit) {
  int i = put(r, MEASURE_NUMBER, -1, -1, unit);
  if (i >= 0) r->m->node[i].result = x, r->m->node[i].literal = unit.kind == UNIT_NONE;
  return i;
}

/* pi beside an angle is in radians, whatever the unit of the angle. */
static int not_scaled(Reader *r, int i) {
  if (i >= 0) r->m->node[i].literal = 0;
  return i;
}

/* Units of a function of numbers: angles from inverse functions, the argument's for abs. */
static MeasureUnit unit_of_call(double (*one)(double), double (*two)(double, double), const MeasureUnit *a) {
  if (one == fabs || one == negative) return a->offset != 0.0 ? mixed : *a;
  if (one == asin || one == acos || one == atan || two == atan2) return radians;
  return (one == sqrt || two == pow) && a->kind != UNIT_NONE ? mixed : none; /* exp and sin of units are nonsense, and have none */
}

static int call_one(Reader *r, double (*f)(double), int a) {
  if (a < 0) return -1;
  int i = put(r, MEASURE_ONE, a, -1, unit_of_call(f, NULL, &r->m->node[a].unit));
  if (i >= 0) r->m->node[i].one = f, r->m->node[i].literal = r->m->node[a].literal;
  return i;
}

static int call_two(Reader *r, double (*f)(double, double), int a, int b, MeasureUnit unit) {
  if (a < 0 || b < 0) return -1;
  int i = put(r, MEASURE_TWO, a, b, unit);
  if (i < 0) return -1;
  r->m->node[i].two = f;
  r->m->node[i].begin = r->m->node[a].begin < r->m->node[b].begin ? r->m->node[a].begin : r->m->node[b].begin;
  r->m->node[i].literal = r->m->node[a].literal && r->m->node[b].literal;
  return i;
}

static int same_unit(const MeasureUnit *a, const MeasureUnit *b) {
  return a->kind == b->kind && strcmp(a->text, b->text) == 0 && a->factor == b->factor; /* factors of one declaration: the same bits */
}

/* The number a in the unit of node b, if that has one. */
static int in_unit_of(Reader *r, int a, int b) {
  const MeasureNode *x = &r->m->node[a], *y = &r->m->node[b];
  if (!x->literal || y->literal || y->unit.kind != UNIT_KNOWN || r->m->dialect.si) return a;
  MeasureUnit unit = y->unit;
  return call_two(r, multiply, a, number(r, unit.factor, none), unit);
}

/* Unit of a sum: the common one. */
static int put_sum(Reader *r, double (*f)(double, double), int a, int b) {
  if (a < 0 || b < 0) return -1;
  int x = in_unit_of(r, a, b), y = in_unit_of(r, b, a);
  if (x < 0 || y < 0) return -1;
  const MeasureUnit *u = &r->m->node[x].unit, *v = &r->m->node[y].unit, *unit = u->kind == UNIT_SI ? v : u;
  int fit = u->kind == UNIT_SI || v->kind == UNIT_SI || same_unit(u, v);
  return call_two(r, f, x, y, fit && unit->offset == 0.0 ? *unit : mixed);
}

/* Unit of a product or quotient with a pure number: the other one's. */
static int put_product(Reader *r, double (*f)(double, double), int a, int b) {
  if (a < 0 || b < 0) return -1;
  const MeasureUnit *u = &r->m->node[a].unit, *v = &r->m->node[b].unit, *unit = &mixed;
  if (v->kind == UNIT_NONE) unit = u->kind == UNIT_SI ? &mixed : u;
  else if (u->kind == UNIT_NONE && f == multiply) unit = v;
  else if (f == divide && same_unit(u, v) && u->kind == UNIT_KNOWN) unit = &none;
  return call_two(r, f, a, b, unit->offset != 0.0 ? mixed : *unit);
}

/* ---- Characters */

static void skip_blanks(Reader *r) { r->at += strspn(r->at, " \t\r\n"); }

static int take(Reader *r, char c) {
  skip_blanks(r);
  if (*r->at != c) return 0;
  r->at++;
  return 1;
}

/* 0, or -1 after a message. */
static int need(Reader *r, char c) {
  if (take(r, c)) return 0;
  return *r->at ? fail(r, r->at, "expected `%c` before `%s`", c, r->at) : fail(r, r->at, "expected `%c` at the end", c);
}

/* Length of a name with its indices, dots and primes: th[2]', r[1].x. */
static size_t name_length(const char *s) {
  size_t n = 0;
  int open = 0;
  for (; s[n]; n++) {
    unsigned char c = (unsigned char)s[n];
    open += (c == '[') - (c == ']' && open);
    if (!(isalnum(c) || c == '_' || c == '\'' || c == '.' || c >= 0x80 || c == '[' || (open && c == ',') || (c == ']' && n))) break;
  }
  return n;
}

/* A name; or any in quotes, as of the output "l*sin(th)". */
static int take_name(Reader *r, char name[LONGEST_NAME]) {
  int quoted = take(r, '"');
  size_t n = quoted ? strcspn(r->at, "\"") : name_length(r->at);
  if (quoted && (n == 0 || !r->at[n])) return fail(r, r->at, "a quoted name ends with `\"`");
  if (!quoted && (n == 0 || isdigit((unsigned char)*r->at))) return *r->at ? fail(r, r->at, "expected a name before `%s`", r->at) : fail(r, r->at, "expected a name at the end");
  if (n >= LONGEST_NAME) return fail(r, r->at, "this name is too long");
  memcpy(name, r->at, n);
  name[n] = '\0';
  r->at += n + (size_t)quoted;
  return 0;
}

/* ---- Names */

static MeasureUnit unit_of_var(const lag_var *v, int rate) {
  if (!v->unit[0] && v->factor == 1 && v->offset == 0.0) return none;
  MeasureUnit u = {UNIT_KNOWN, "", v->factor, rate ? 0 : v->offset};
  snprintf(u.text, sizeof u.text, "%s%s", v->unit, rate && v->unit[0] ? "/s" : "");
  return u;
}

static int find_charge(const lag_model *m, const char *name) {
  if (!m->energy) return -1;
  if (!m->charges) return strcmp(name, "energy") == 0 ? 0 : -1;
  for (int k = 0; k < m->charges->n; k++)
    if (strcmp(m->charges->of[k].name, name) == 0) return k;
  return -1;
}

/* *of, *index, *unit of the quantity called name; 0: there is none. */
static int find_quantity(const lag_scene *scene, const char *name, QuantityKind *of, int *index, MeasureUnit *unit) {
  static const QuantityKind kinds[] = {[LAG_IS_P] = QUANTITY_PARAMETER, [LAG_IS_Q] = QUANTITY_STATE, [LAG_IS_V] = QUANTITY_STATE, [LAG_IS_Z] = QUANTITY_STATE, [LAG_IS_U] = QUANTITY_INPUT};
  const lag_model *m = scene->model;
  const lag_var *var;
  int found, kind = lag_find_name(m, name, &found, &var), state = kind == LAG_IS_Q || kind == LAG_IS_V || kind == LAG_IS_Z;
  for (*index = 0; *index < scene->nout && !state; ++*index) /* an output of a state is the state, and costs all outputs */
    if (strcmp(scene->outputs[*index].name, name) == 0) {
      *of = QUANTITY_OUTPUT;
      *unit = unit_of_var(&scene->outputs[*index], 0);
      return 1;
    }
  if (kind != LAG_IS_NOTHING) {
    *of = kinds[kind];
    *index = found + (kind == LAG_IS_V ? m->nq : kind == LAG_IS_Z ? 2 * m->nq : 0);
    *unit = unit_of_var(var, kind == LAG_IS_V);
    return 1;
  }
  *of = QUANTITY_CHARGE;
  *unit = mixed;
  if ((*index = find_charge(m, name)) >= 0) {
    if (m->charges && m->charges->of[*index].unit[0]) {
      unit->kind = UNIT_KNOWN;
      snprintf(unit->text, sizeof unit->text, "%s", m->charges->of[*index].unit);
    }
    return 1;
  }
  *of = QUANTITY_TIME;
  *unit = seconds;
  return strcmp(name, "t") == 0;
}

/* The node of a quantity; -1: there is none, without a message. */
static int quantity(Reader *r, const char *name) {
  QuantityKind of;
  int index;
  MeasureUnit unit;
  if (!find_quantity(r->m->scene, name, &of, &index, &unit)) return -1;
  int i = put(r, MEASURE_QUANTITY, -1, -1, unit);
  if (i < 0) return -1;
  r->m->node[i].of = of;
  r->m->node[i].index = index;
  r->m->node[i].known = of == QUANTITY_PARAMETER ? MEASURE_STATIC : 0;
  r->m->uses[of] = 1;
  return i;
}

static const MeasureFunction *find_function(const Reader *r, const char *name) {
  const MeasureDialect *d = &r->m->dialect;
  for (int i = 0; i < FUNCTIONS; i++)
    if (strcmp(functions[i].name, name) == 0) return &functions[i];
  for (int i = 0; i < d->nfunctions; i++)
    if (strcmp(d->functions[i].name, name) == 0) return &d->functions[i];
  return NULL;
}

/* Whether the name is one of a function, max or sin. */
static int is_function(const Reader *r, const char *name) {
  int found = find_function(r, name) != NULL;
  for (int i = 0; i < TRACK_KINDS; i++) found |= strcmp(name, track_words[i]) == 0;
  return found;
}

static int no_name(Reader *r, const char *at, const char *name, int call) {
  const lag_scene *scene = r->m->scene;
  const lag_model *m = scene->model;
  char known[LONGEST_NAME];
  if (!call && is_function(r, name)) return fail(r, at, "%s is a function, and takes its argument in parentheses, %s(%s)", name, name, m->nq ? m->q[0].name : "t");
  for (int i = 0; i < 2; i++)
    if (strcmp(name, event_words[i]) == 0) return fail(r, at, "%s takes an event in parentheses, %s(%s)", name, name, m->nev ? m->ev[0].name : "EVENT");
  lag_nearest near = {.name = name};
  for (int i = 0; i < TRACK_KINDS && call; i++) lag_try_nearest(&near, track_words[i]);
  for (int i = 0; i < 2 && call; i++) lag_try_nearest(&near, event_words[i]);
  for (int i = 0; i < FUNCTIONS && call; i++) lag_try_nearest(&near, functions[i].name);
  for (int i = 0; i < scene->nout; i++) lag_try_nearest(&near, scene->outputs[i].name);
  for (int k = 0; m->charges && k < m->charges->n; k++) lag_try_nearest(&near, m->charges->of[k].name);
  if (m->energy) lag_try_nearest(&near, "energy");
  if (!call) lag_try_nearest(&near, "lyapunov");
  if (!near.best && lag_nearest_name(m, name, known, sizeof known)) near.best = known;
  const char *what = call ? "function, output or coordinate" : "output, coordinate, parameter or charge";
  if (near.best) return fail(r, at, "no %s is called %s; did you mean %s?", what, name, near.best);
  return fail(r, at, call ? "no %s is called %s; of a run there are max, min, mean, rms, drift, period, hit, count, and lyapunov without parentheses" : "no %s is called %s", what, name);
}

/* ---- Grammar */

static int read_sum(Reader *r);

/* An end of a window, up to `stop`: a number of seconds; NaN where it is left out. */
static int read_window_end(Reader *r, const char *stop, double *t) {
  char number[64], *end;
  const char *to = strstr(r->at, stop);
  r->at += strspn(r->at, " ");
  if (!to) return fail(r, r->at, "a window of time is written max(x, 10..20), in s");
  snprintf(number, sizeof number, "%.*s", (int)(to - r->at), r->at);
  *t = strtod(number, &end);
  if (end == number) *t = NAN;
  if (end[strspn(end, " ")]) return fail(r, r->at, "a window of time is written max(x, 10..20), in s; `%s` is no number", number);
  r->at = to;
  return 0;
}

static int read_window(Reader *r, double *from, double *to) {
  if (read_window_end(r, "..", from)) return -1;
  r->at += 2;
  return read_window_end(r, ")", to) ? -1 : !(*to <= *from) ? 0 : fail(r, r->at, "this window of time is empty");
}

/* max(x), max(x, 10..20), ...: `which` is read up to its parenthesis. */
static int read_track(Reader *r, const char *at, TrackKind which) {
  Measures *m = r->m;
  double from = NAN, to = NAN;
  int arg = read_sum(r);
  if (arg < 0 || (take(r, ',') && read_window(r, &from, &to)) || need(r, ')')) return -1;
  const MeasureNode *of = &m->node[arg];
  if (of->measured) return fail(r, at, "%s takes quantities, as x or x^2 + y^2; a value of the whole run stands outside", track_words[which]);
  if (of->known == MEASURE_STATIC) return fail(r, at, "%s takes something that changes along the run", track_words[which]);
  MeasureUnit unit = which == TRACK_PERIOD ? seconds : of->unit;
  if (which == TRACK_DRIFT || which == TRACK_RMS) unit.offset = 0; /* a difference */
  Track *track = realloc(m->track, (size_t)(m->ntracks + 1) * sizeof *track);
  if (!track) return fail(r, at, "out of memory");
  m->track = track;
  int i = put(r, MEASURE_TRACK, arg, -1, unit);
  if (i < 0) return -1;
  track[m->ntracks] = (Track){.kind = which, .node = i, .arg = arg, .from = from, .to = to};
  m->node[i].index = m->ntracks++;
  m->node[i].measured = 1;
  m->node[i].known = 0;
  if (which == TRACK_MEAN || which == TRACK_RMS) m->integrates = 1;
  else m->samples = 1;
  return i;
}

/* Adds the second word of a contact's event to its name, if there is one: `floor opens`. */
static void take_contact_word(Reader *r, char *name) {
  static const char *const words[] = {" opens", " sticks", " slips"};
  for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
    size_t n = strlen(words[i]) - 1;
    if (strncmp(r->at, words[i] + 1, n) != 0 || strlen(name) + n + 2 > LONGEST_NAME) continue;
    strcat(name, words[i]);
    r->at += n;
    return;
  }
}

/* hit(EVENT), hit(EVENT, n), count(EVENT); EVENT is a name, or `NAME opens`, `NAME sticks`, `NAME slips` of a contact. */
static int read_event(Reader *r, int hit) {
  const lag_model *m = r->m->scene->model;
  char name[LONGEST_NAME];
  skip_blanks(r);
  const char *at = r->at;
  if (take_name(r, name)) return -1;
  skip_blanks(r);
  take_contact_word(r, name);
  int k = 0;
  lag_nearest near = {.name = name};
  while (k < m->nev && strcmp(m->ev[k].name, name) != 0) lag_try_nearest(&near, m->ev[k++].name);
  if (k == m->nev) return fail(r, at, near.best ? "no event is called %s; did you mean %s?" : m->nev ? "no event is called %s; the model has %s" : "no event is called %s: the model has none", name, near.best ? near.best : m->nev ? m->ev[0].name : "");
  int nth = -1;
  if (hit) {
    nth = take(r, ',') ? read_sum(r) : number(r, 1, none);
    if (nth < 0) return -1;
    const MeasureNode *n = &r->m->node[nth];
    if (n->known != MEASURE_STATIC) return fail(r, at, "hit(%s, n): n is a number", name);
    if (n->kind == MEASURE_NUMBER && (n->result < 1 || n->result != floor(n->result))) return fail(r, at, "hit(%s, n): n is 1 for the first time, 2 for the second, ...", name);
  }
  if (need(r, ')')) return -1;
  int i = put(r, hit ? MEASURE_HIT : MEASURE_FIRINGS, nth, -1, hit ? seconds : none);
  if (i < 0) return -1;
  r->m->node[i].index = k;
  r->m->node[i].measured = 1;
  r->m->node[i].known = 0;
  return i;
}

/* x(10). */
static int read_at(Reader *r, int x) {
  int t = read_sum(r);
  if (t < 0 || need(r, ')')) return -1;
  int i = put(r, MEASURE_AT, x, t, r->m->node[x].unit);
  if (i < 0) return -1;
  r->m->node[i].measured = 1;
  r->m->node[i].known = r->m->node[t].known + 1; /* the time is known before the run, or after some run */
  return i;
}

/* name( is read. */
static int read_call(Reader *r, const char *at, const char *name) {
  for (int i = 0; i < TRACK_KINDS; i++)
    if (strcmp(name, track_words[i]) == 0) return read_track(r, at, (TrackKind)i);
  for (int i = 0; i < 2; i++)
    if (strcmp(name, event_words[i]) == 0) return read_event(r, i == 0);
  int x = quantity(r, name), a, b = -1;
  if (x >= 0) return read_at(r, x);
  const MeasureFunction *f = find_function(r, name);
  if (!f) return no_name(r, at, name, 1);
  if ((a = read_sum(r)) < 0 || (take(r, ',') && (b = read_sum(r)) < 0) || need(r, ')')) return -1;
  if ((f->two == NULL) != (b < 0)) return fail(r, at, "%s takes %s", name, f->two ? "two numbers" : "one number");
  return f->two ? call_two(r, f->two, a, b, unit_of_call(NULL, f->two, &r->m->node[a].unit)) : call_one(r, f->one, a);
}

/* The expression for which a name stands. */
static int read_abbreviation(Reader *r, const char *name, const char *text) {
  const char *back = r->at, *outer = r->within;
  r->at = text;
  r->within = name;
  int x = read_sum(r);
  skip_blanks(r);
  if (x >= 0 && *r->at) x = fail(r, r->at, "`%s` is too much", r->at);
  r->at = back;
  r->within = outer;
  return x;
}

static int read_name(Reader *r, const char *at, const char *name) {
  static const MeasureUnit degrees = {UNIT_KNOWN, "deg", 3.14159265358979323846264338327950288 / 180, 0};
  const MeasureDialect *d = &r->m->dialect;
  const char *text = d->text ? d->text(d->context, name) : NULL;
  if (text) return read_abbreviation(r, name, text);
  int i = quantity(r, name);
  if (i >= 0) return i;
  if (strcmp(name, "pi") == 0) return not_scaled(r, number(r, 3.14159265358979323846264338327950288, none));
  if (strcmp(name, "deg") == 0) return number(r, degrees.factor, degrees);
  int exponent = strcmp(name, "lyapunov") == 0;
  if (strcmp(name, "end") != 0 && !exponent) return no_name(r, at, name, 0);
  r->m->exponent |= exponent;
  i = exponent ? put(r, MEASURE_LYAPUNOV, -1, -1, rates) : put(r, MEASURE_END, -1, -1, seconds);
  if (i >= 0) r->m->node[i].measured = 1, r->m->node[i].known = 0;
  return i;
}

static int read_primary(Reader *r) {
  char name[LONGEST_NAME], *end;
  skip_blanks(r);
  const char *at = r->at;
  if (isdigit((unsigned char)*at) || *at == '.') {
    double x = strtod(at, &end);
    if (end == at) return fail(r, at, "expected a number before `%s`", at);
    int si = strncmp(end, "[SI]", 4) == 0;
    r->at = end + (si ? 4 : 0);
    return number(r, x, si ? in_si : none);
  }
  if (take(r, '(')) {
    int x = read_sum(r);
    return x < 0 || need(r, ')') ? -1 : x;
  }
  if (take_name(r, name)) return -1;
  return take(r, '(') ? read_call(r, at, name) : read_name(r, at, name);
}

static int read_power(Reader *r) {
  int minus = 0;
  while (take(r, '-')) minus = !minus;
  int x = read_primary(r);
  if (x >= 0 && take(r, '^')) {
    int y = ++r->depth > DEEPEST ? fail(r, r->at, "too deep") : read_power(r);
    r->depth--;
    x = y < 0 ? -1 : call_two(r, pow, x, y, unit_of_call(NULL, pow, &r->m->node[x].unit));
  }
  return minus ? call_one(r, negative, x) : x;
}

static int read_product(Reader *r) {
  int x = read_power(r);
  for (;;) {
    if (x >= 0 && take(r, '*')) x = put_product(r, multiply, x, read_power(r));
    else if (x >= 0 && take(r, '/')) x = put_product(r, divide, x, read_power(r));
    else return x;
  }
}

static int read_sum(Reader *r) {
  if (++r->depth > DEEPEST) return fail(r, r->at, r->within ? "it needs itself, or is too deep" : "too many parentheses");
  int x = read_product(r);
  for (;;) {
    if (x >= 0 && take(r, '+')) x = put_sum(r, add, x, read_product(r));
    else if (x >= 0 && take(r, '-')) x = put_sum(r, subtract, x, read_product(r));
    else break;
  }
  r->depth--;
  return x;
}

int lag_measure_parse(Measures *m, int k, char *why, size_t size) {
  Reader r = {.m = m, .text = m->text[k], .at = m->text[k], .why = why, .size = size};
  m->root[k] = read_sum(&r);
  if (m->root[k] < 0) return -1;
  skip_blanks(&r);
  return *r.at ? fail(&r, r.at, "`%s` is too much", r.at) : 0;
}
