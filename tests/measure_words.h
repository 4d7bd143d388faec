/* Measures of tests: arithmetic as one writes it, `max(y) - h`, in words for runtime/analysis/measure.h, `y max() h
 * -`, without checks of names and units: the compiler's own way is src/model/measure.c. Precedence: + -, * /, unary
 * -, ^. pi, deg; x(10) at a time; min and max are those along the run. */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "numeric/functions.def"

typedef struct Words {
  const char *at;                       /* the next character */
  const char *(*let)(const char *name); /* the expression for which a name stands, or NULL; NULL: no such names */
  char *out;
  size_t size;
  int depth, wrong;
} Words;

static void words_put(Words *w, const char *word)
{
  size_t n = strlen(w->out);
  w->wrong |= snprintf(w->out + n, w->size - n, "%s%s", n ? " " : "", word) >= (int)(w->size - n);
}

static int words_take(Words *w, char c)
{
  w->at += strspn(w->at, " \t");
  return *w->at == c ? w->at++, 1 : 0;
}

static void words_sum(Words *w);

/* th[2]', r[1].x, "l*sin(th)" */
static void words_name(Words *w, char name[128])
{
  int quoted = *w->at == '"', open = 0;
  size_t n = quoted ? strcspn(w->at + 1, "\"") + 2 : 0;
  for (; !quoted &&
         (isalnum((unsigned char)w->at[n]) || (w->at[n] && strchr("_'.[]", w->at[n])) || (open && w->at[n] == ','));
       n++)
    open += (w->at[n] == '[') - (w->at[n] == ']');
  w->wrong |= n == 0 || n > 127;
  snprintf(name, 128, "%.*s", (int)n, w->at);
  w->at += w->wrong ? strlen(w->at) : n;
}

/* name( is read. */
static void words_call(Words *w, const char *name)
{
#define WORDS_TRACK(KIND, name, unit, how) #name,
#define WORDS_FUNCTION(OP, name, latex, symmetry, at_0, sign, proof, slope, derivative) #name,
  static const char *const words[] = {TRACKS(WORDS_TRACK) FUNCTIONS(WORDS_FUNCTION) "sqrt", "abs", "floor", "atan2",
                                      "hypot", "kepler", "K", "sn", "cn", "dn", "lambert"};
  char word[300], event[128] = "";
  int hit = strcmp(name, "hit") == 0, of = hit || strcmp(name, "count") == 0, known = 0;
  if (of) {
    size_t n = strcspn(w->at, ",)");
    snprintf(event, sizeof event, "%.*s", (int)n, w->at);
    w->at += n;
    if (hit && *w->at != ',') words_put(w, "1");
    if (hit && words_take(w, ',')) words_sum(w);
  } else {
    for (size_t i = 0; i < sizeof words/sizeof *words; i++) known |= strcmp(name, words[i]) == 0;
    if (!known) words_put(w, name);
    words_sum(w);
    if (words_take(w, ',')) words_sum(w);
  }
  w->wrong |= !words_take(w, ')');
  snprintf(word, sizeof word, "%s(%s)", of || known ? name : "at", event);
  words_put(w, word);
}

static void words_primary(Words *w)
{
  char name[128];
  w->at += strspn(w->at, " \t");
  if (words_take(w, '(')) {
    words_sum(w);
    w->wrong |= !words_take(w, ')');
    return;
  }
  if (isdigit((unsigned char)*w->at) || *w->at == '.') {
    char *end;
    strtod(w->at, &end);
    snprintf(name, sizeof name, "%.*s", (int)(end - w->at), w->at);
    w->at = end;
    words_put(w, name);
    return;
  }
  words_name(w, name);
  const char *let = w->let ? w->let(name) : NULL, *back = w->at;
  if (let) {
    w->at = let;
    words_sum(w);
    w->wrong |= w->at[strspn(w->at, " \t")] != '\0';
    w->at = back;
  } else if (words_take(w, '(')) words_call(w, name);
  else if (strcmp(name, "deg") == 0) words_put(w, "pi() 180 /");
  else {
    int call = strcmp(name, "pi") == 0 || strcmp(name, "end") == 0 || strcmp(name, "lyapunov") == 0;
    if (call) strcat(name, "()");
    words_put(w, name);
  }
}

static void words_power(Words *w)
{
  int minus = 0;
  while (words_take(w, '-')) minus = !minus;
  words_primary(w);
  if (words_take(w, '^')) {
    words_power(w);
    words_put(w, "^");
  }
  if (minus) words_put(w, "neg()");
}

static void words_product(Words *w)
{
  words_power(w);
  for (int times; (times = words_take(w, '*')) || words_take(w, '/');) {
    words_power(w);
    words_put(w, times ? "*" : "/");
  }
}

static void words_sum(Words *w)
{
  if (++w->depth > 50) w->wrong = 1, w->at += strlen(w->at);
  if (!w->wrong) words_product(w);
  for (int plus; !w->wrong && ((plus = words_take(w, '+')) || words_take(w, '-'));) {
    words_product(w);
    words_put(w, plus ? "+" : "-");
  }
  w->depth--;
}

/* out[size] := the words of text, with the unit `[]` for SI. Returns 0 if it is wrong. */
static int measure_words(const char *text, const char *(*let)(const char *name), char *out, size_t size)
{
  Words w = {.at = text, .let = let, .out = out, .size = size};
  *out = '\0';
  words_sum(&w);
  w.wrong |= w.at[strspn(w.at, " \t")] != '\0';
  words_put(&w, "[]");
  return !w.wrong;
}
