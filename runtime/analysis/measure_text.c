/* Measures from words, as lagc compiles them (measure.h has the notation). Enters: words, the names of a scene.
 * Leaves: a node for each word, the unit of the value. Holds: a wrong word leaves a message; at most DEEPEST
 * operands wait. */
#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/measure_nodes.h"
#include "core/core.h"
#include "numeric/dense.h"

#ifndef LAG_OF_REAL
#define LAG_OF_REAL(f) f /* f of the scalar: with the suffix of long double or __float128 */
#endif

enum { DEEPEST = 500, LONGEST_WORD = 192 };

typedef struct Reader {
  Measures *m;
  const char *text;
  int stack[DEEPEST], waiting; /* nodes that no word has taken yet */
  MeasureUnit unit;
  char *why;
  size_t size;
} Reader;

static const struct {
  const char *word;
  TrackHow how;
} tracks[TRACK_KINDS] = {
#define TRACK_ROW(KIND, name, unit, how) {#name, how},
  TRACKS(TRACK_ROW)
};

static double add(double a, double b) { return a + b; }
static double subtract(double a, double b) { return a - b; }
static double multiply(double a, double b) { return a * b; }
static double divide(double a, double b) { return a / b; }
static double negative(double a) { return -a; }
static double least(double a, double b) { return a < b ? a : b; }
static double most(double a, double b) { return a > b ? a : b; }

static const MeasureFunction functions[] = {
#define ROW(OP, name, ...) {#name, LAG_OF_REAL(name), NULL},
  FUNCTIONS(ROW)
  {"sqrt", sqrt, NULL}, {"abs", fabs, NULL}, {"floor", floor, NULL}, {"neg", negative, NULL}, {"sign", lag_sign, NULL},
  {"atan2", NULL, atan2}, {"hypot", NULL, hypot}, {"lesser", NULL, least}, {"greater", NULL, most},
  {"+", NULL, add}, {"-", NULL, subtract}, {"*", NULL, multiply}, {"/", NULL, divide}, {"^", NULL, pow},
};

/* Writes the message; returns -1. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static int fail(Reader *r, const char *format, ...) {
  va_list list;
  int n = snprintf(r->why, r->size, "%s: ", r->text);
  if (n < 0 || (size_t)n >= r->size) return -1;
  va_start(list, format);
  vsnprintf(r->why + n, r->size - (size_t)n, format, list);
  va_end(list);
  return -1;
}

static int not_compiled(Reader *r, const char *word) {
  return fail(r, "`%s` is no word of a compiled measure; lagc compiles them: `measure top = max(x)` in the scene, or "
              "lagc run MODEL --measure 'max(x)'; a program takes operations behind their operands, 'x max()'", word);
}

/* ---- Nodes */

/* Puts a node in place of the last n waiting ones; 0, or -1 after a message. */
static int put(Reader *r, MeasureNode node, int n) {
  Measures *m = r->m;
  if (r->waiting - n + 1 > DEEPEST) return fail(r, "too many parts wait for an operation");
  if (m->nnodes == m->room) {
    int room = m->room ? 2 * m->room : 32;
    MeasureNode *all = realloc(m->node, (size_t)room * sizeof *all);
    if (!all) return fail(r, "out of memory");
    m->node = all;
    m->room = room;
  }
  node.begin = m->nnodes;
  r->waiting -= n;
  for (int i = n - 1; i >= 0; i--) {
    const MeasureNode *of = &m->node[r->stack[r->waiting + i]];
    *(i ? &node.b : &node.a) = r->stack[r->waiting + i];
    node.begin = of->begin;
    node.known = of->known > node.known ? of->known : node.known;
  }
  m->node[m->nnodes] = node;
  r->stack[r->waiting++] = m->nnodes++;
  return 0;
}

static int put_number(Reader *r, double x) {
  return put(r, (MeasureNode){.kind = MEASURE_NUMBER, .known = MEASURE_STATIC, .result = x}, 0);
}

/* A value of the run as a whole, which is known after it. */
static MeasureNode whole(MeasureKind kind, int index) {
  return (MeasureNode){.kind = kind, .index = index, .known = 0, .result = NAN};
}

/* ---- Names */

static MeasureUnit unit_of_var(const lag_var *v, int rate) {
  MeasureUnit u = {"", v->factor, rate ? 0 : v->offset};
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
  static const QuantityKind kinds[] = {[LAG_IS_P] = QUANTITY_PARAMETER,
                                       [LAG_IS_Q] = QUANTITY_STATE,
                                       [LAG_IS_V] = QUANTITY_STATE,
                                       [LAG_IS_Z] = QUANTITY_STATE,
                                       [LAG_IS_U] = QUANTITY_INPUT};
  const lag_model *m = scene->model;
  const lag_var *var;
  int found, kind = lag_find_name(m, name, &found, &var),
             state = kind == LAG_IS_Q || kind == LAG_IS_V || kind == LAG_IS_Z;
  /* an output of a state is the state, and costs all outputs */
  for (*index = 0; *index < scene->nout && !state; ++*index)
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
  *unit = (MeasureUnit){"", 1, 0};
  if ((*index = find_charge(m, name)) >= 0) {
    if (m->charges) snprintf(unit->text, sizeof unit->text, "%s", m->charges->of[*index].unit);
    return 1;
  }
  *of = QUANTITY_TIME;
  *unit = (MeasureUnit){"s", 1, 0};
  return strcmp(name, "t") == 0;
}

static int no_name(Reader *r, const char *name) {
  char near[LONGEST_WORD];
  int known = lag_nearest_name(r->m->scene->model, name, near, sizeof near);
  if (strpbrk(name, " (")) return not_compiled(r, name);
  return fail(r, "no output, coordinate, parameter or charge is called %s%s%s%s", name, known ? "; did you mean " : "",
              known ? near : "", known ? "?" : "");
}

/* A quantity; alone it is in its own unit. */
static int put_quantity(Reader *r, const char *name) {
  QuantityKind of;
  int index;
  MeasureUnit unit;
  if (!find_quantity(r->m->scene, name, &of, &index, &unit)) return no_name(r, name);
  r->unit = unit;
  r->m->uses[of] = 1;
  int known = of == QUANTITY_PARAMETER ? MEASURE_STATIC : 0;
  return put(r, (MeasureNode){.kind = MEASURE_QUANTITY, .of = of, .index = index, .known = known, .result = NAN}, 0);
}

/* ---- Operations */

/* max(), max(10..20), max(..20) */
static int put_track(Reader *r, TrackKind which, const char *window) {
  Measures *m = r->m;
  char *end = NULL;
  double from = NAN, to = NAN;
  const char *dots = strstr(window, "..");
  if (window[0] && (!dots || r->waiting < 1)) return not_compiled(r, window);
  if (dots && dots != window) from = strtod(window, &end);
  if (dots && dots[2]) to = strtod(dots + 2, &end);
  Track *track = realloc(m->track, (size_t)(m->ntracks + 1) * sizeof *track);
  if (!track) return fail(r, "out of memory");
  m->track = track;
  if (put(r, whole(MEASURE_TRACK, m->ntracks), 1)) return -1;
  int node = m->nnodes - 1;
  track[m->ntracks++] =
      (Track){.kind = which, .how = tracks[which].how, .node = node, .arg = m->node[node].a, .from = from, .to = to};
  *(tracks[which].how == INTEGRATED ? &m->integrates : &m->samples) = 1;
  return 0;
}

static int put_event(Reader *r, int hit, const char *event) {
  const lag_model *m = r->m->scene->model;
  int k = 0;
  lag_nearest near = {.name = event};
  while (k < m->nev && strcmp(m->ev[k].name, event) != 0) lag_try_nearest(&near, m->ev[k++].name);
  if (k == m->nev && near.best) return fail(r, "no event is called %s; did you mean %s?", event, near.best);
  if (k == m->nev) return fail(r, "no event is called %s", event);
  return put(r, whole(hit ? MEASURE_HIT : MEASURE_FIRINGS, k), hit);
}

/* x t at(): the value of quantity x at time t, which is known before the run, or after some run. */
static int put_at(Reader *r) {
  const MeasureNode *t = &r->m->node[r->stack[r->waiting - 1]];
  MeasureNode n = whole(MEASURE_AT, 0);
  n.known = t->known + 1;
  return put(r, n, 2) || (r->m->node[r->m->nnodes - 1].known = n.known, 0);
}

static const MeasureFunction *find_function(const Reader *r, const char *name) {
  const MeasureDialect *d = &r->m->dialect;
  for (size_t i = 0; i < sizeof functions / sizeof *functions; i++)
    if (strcmp(functions[i].name, name) == 0) return &functions[i];
  for (int i = 0; i < d->nfunctions; i++)
    if (strcmp(d->functions[i].name, name) == 0) return &d->functions[i];
  return NULL;
}

/* An operation with its argument, `max(10..20)`; `word` as it stands, for messages. */
static int put_operation(Reader *r, const char *word, const char *name, const char *argument) {
  r->unit = (MeasureUnit){"", 1, 0};
  const MeasureFunction *f = find_function(r, name);
  int hit = strcmp(name, "hit") == 0, at = strcmp(name, "at") == 0, track = 0;
  MeasureKind run = strcmp(name, "lyapunov") == 0 ? MEASURE_LYAPUNOV
                    : strcmp(name, "megno") == 0  ? MEASURE_MEGNO
                                                  : MEASURE_END;
  while (track < TRACK_KINDS && strcmp(name, tracks[track].word) != 0) track++;
  if (r->waiting < (f ? f->two ? 2 : 1 : at ? 2 : hit || track < TRACK_KINDS)) return not_compiled(r, word);
  if (track < TRACK_KINDS) return put_track(r, (TrackKind)track, argument);
  if (hit || strcmp(name, "count") == 0) return put_event(r, hit, argument);
  if (at) return put_at(r);
  MeasureKind kind = f && f->two ? MEASURE_TWO : MEASURE_ONE;
  MeasureNode call = {
      .kind = kind, .one = f ? f->one : NULL, .two = f ? f->two : NULL, .known = MEASURE_STATIC, .result = NAN};
  if (f) return put(r, call, f->two ? 2 : 1);
  if (strcmp(name, "pi") == 0) return put_number(r, 3.14159265358979323846264338327950288);
  r->m->exponent |= run == MEASURE_LYAPUNOV;
  r->m->megno |= run == MEASURE_MEGNO;
  if (run != MEASURE_END || strcmp(name, "end") == 0) return put(r, whole(run, 0), 0);
  return not_compiled(r, word);
}

/* [FACTOR OFFSET UNIT], [] for SI: the unit of the value. */
static int read_unit(Reader *r, const char *word) {
  char *end;
  r->unit = (MeasureUnit){"", 1, 0};
  if (word[1] == ']') return 0;
  r->unit.factor = strtod(word + 1, &end);
  r->unit.offset = strtod(end, &end);
  snprintf(r->unit.text, sizeof r->unit.text, "%.*s", (int)strcspn(end + (*end == ' '), "]"), end + (*end == ' '));
  return 0;
}

static int read_word(Reader *r, char *word) {
  char *open = strchr(word, '('), *close = word + strlen(word) - 1;
  if (*word == '[') return read_unit(r, word);
  if (*word == '"') return *close = '\0', put_quantity(r, word + 1);
  if (isdigit((unsigned char)*word) || *word == '.' || (*word == '-' && word[1])) {
    char *end;
    double x = strtod(word, &end);
    return *end ? not_compiled(r, word) : put_number(r, x);
  }
  if (open && *close == ')') {
    char name[LONGEST_WORD];
    snprintf(name, sizeof name, "%.*s", (int)(open - word), word);
    char argument[LONGEST_WORD];
    snprintf(argument, sizeof argument, "%.*s", (int)(close - open - 1), open + 1);
    return put_operation(r, word, name, argument);
  }
  return strchr("+-*/^", *word) && !word[1] ? put_operation(r, word, word, "") : put_quantity(r, word);
}

/* Length of the first word of s: up to a blank that is in no quotes or brackets. */
static size_t word_length(const char *s) {
  size_t n = 0;
  if (*s == '"') return s[1 + (n = strcspn(s + 1, "\""))] ? n + 2 : n + 1;
  for (int open = 0; s[n] && s[n] != ';' && (open || s[n] != ' '); n++)
    open += (s[n] == '(' || s[n] == '[') - ((s[n] == ')' || s[n] == ']') && open);
  return n;
}

int lag_measure_read(Measures *m, int k, const char *text, char *why, size_t size) {
  Reader r = {.m = m, .text = text, .unit = {"", 1, 0}, .why = why, .size = size};
  for (const char *s = text + strspn(text, " "); *s && *s != ';'; s += strspn(s, " ")) {
    char word[LONGEST_WORD];
    size_t n = word_length(s);
    if (n >= sizeof word) return fail(&r, "a name is too long");
    memcpy(word, s, n);
    word[n] = '\0';
    s += n;
    if (read_word(&r, word)) return -1;
  }
  if (r.waiting != 1) return not_compiled(&r, text);
  m->root[k] = r.stack[0];
  m->unit[k] = r.unit;
  return 0;
}
