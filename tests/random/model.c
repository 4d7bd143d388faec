/* A grammar with weights: each rule is a text in which @K stands for an expression of kind K. Kinds bound values, so
 * that functions with a domain get arguments inside it near |q| < 2. Weights favour compositions: odd of odd,
 * inverse of direct, powers of negatives. */
#include "model.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAMES = 64, LENGTH = 64, ARGS = 4, DEEP = 4 };

typedef struct {
  char *at;
  size_t n, cap;
} Text;

typedef struct {
  uint64_t random;
  Text out;
  char name[NAMES][LENGTH]; /* values that expressions may use; the first `moving` are functions of the coordinates */
  unsigned names, moving, lets, budget;
  char velocity[NAMES][LENGTH];
  unsigned velocities;
  int failed;
} Maker;

/* SplitMix64 (Steele, Lea, Flood 2014, DOI 10.1145/2714064.2660195). */
static uint64_t next(Maker *m) {
  uint64_t x = m->random += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

static unsigned below(Maker *m, unsigned n) { return (unsigned)(next(m) >> 33) % n; }
static int chance(Maker *m, unsigned percent) { return below(m, 100) < percent; }

/* --- text --- */

static void put(Maker *m, const char *text, size_t n) {
  Text *t = &m->out;
  if (t->n + n + 1 > t->cap) {
    size_t cap = 2 * (t->n + n + 256);
    char *more = realloc(t->at, cap);
    if (!more) {
      m->failed = 1;
      return;
    }
    t->at = more;
    t->cap = cap;
  }
  memcpy(t->at + t->n, text, n);
  t->at[t->n += n] = 0;
}

static void say(Maker *m, const char *format, ...) {
  char line[512];
  va_list args;
  va_start(args, format);
  int n = vsnprintf(line, sizeof line, format, args);
  va_end(args);
  put(m, line, (size_t)n);
}

static void know(Maker *m, const char *format, ...) {
  va_list args;
  va_start(args, format);
  if (m->names < NAMES) vsnprintf(m->name[m->names++], LENGTH, format, args);
  va_end(args);
}

/* --- rules --- */

/* A: any value; B: in -1..1; P: positive, not near 0; S: some units at most; I: argument of a function that is odd
 * or inverse; C: made of parameters alone; q: a name; p: a parameter; n: a number; @1: the first argument again. */
typedef struct {
  char kind;
  unsigned weight;
  const char *text;
} Rule;

static const Rule rules[] = {
    {'A', 6, "@q"}, {'A', 3, "-@q"}, {'A', 4, "@I"}, {'A', 3, "(@A + @S)"}, {'A', 3, "(@S - @A)"}, {'A', 3, "@n*@A"},
    {'A', 3, "@p*@S"}, {'A', 2, "@S*@B"}, {'A', 1, "@A/@P"}, {'A', 2, "(@S + @C)"}, {'A', 1, "@S^2"}, {'A', 1, "@S^3"},
    {'A', 1, "(-@S)^3"}, {'A', 1, "(-@S)^2"}, {'A', 1, "sinh(@B)"}, {'A', 1, "tan(@B)"}, {'A', 1, "log(@P)"},
    {'A', 1, "abs(@S)"}, {'A', 1, "cbrt(@P)"}, {'A', 1, "if(@S > @n, @S, @B)"}, {'A', 1, "if(@S < @B, -@1, @B)"},
    {'A', 1, "hypot(@S, @A)"}, {'A', 1, "atan2(@S, @P)"}, {'A', 1, "atan2(@S, @A)"}, {'S', 8, "@q"}, {'S', 4, "-@q"},
    {'S', 3, "@q/2"}, {'S', 2, "(@q + @n)"}, {'S', 3, "(@q - @q)"}, {'S', 2, "(2*@q + @q)"}, {'S', 4, "@I"},
    {'S', 3, "@B"}, {'S', 1, "@p*@q"}, {'S', 1, "@q/@p"}, {'S', 2, "@C"}, {'S', 2, "(@B - @C)"}, {'S', 1, "@q*@B"},
    {'I', 4, "asin(tanh(@A))"}, {'I', 3, "atan(tanh(@A))"}, {'I', 3, "2*atan(tanh(@S/2))"}, {'I', 2, "atan(sinh(@S))"},
    {'I', 2, "asin(sin(@S))"}, {'I', 2, "acos(tanh(@S))"}, {'I', 2, "acos(cos(@S))"}, {'I', 2, "atan(tan(@B))"},
    {'I', 1, "tanh(sinh(@B))"}, {'I', 2, "asin(@B*3/4)"}, {'I', 2, "atan(@A)"}, {'I', 2, "-atan(-@S)"},
    {'I', 2, "atan2(sin(@S), cos(@1))"}, {'I', 1, "atan2(-@S, @P)"}, {'I', 1, "log(exp(@B))"},
    {'I', 1, "log(cosh(@S))"}, {'I', 1, "atan(exp(@B))"}, {'I', 1, "sqrt(@S^2)"}, {'I', 1, "(@P^2)^(1/2)"},
    {'I', 1, "(-8)^(1/3)*@S"}, {'I', 1, "asin(@S/sqrt(1 + @1^2))"}, {'I', 1, "acos(-tanh(@S))"}, {'I', 1, "cbrt(-@P)"},
    {'I', 1, "(-@P)^(1/3)"}, {'I', 1, "(-@P)^(2/3)"}, {'I', 1, "sign(@S)*@1"}, {'I', 1, "abs(-@S)"},
    {'I', 1, "max(@S, -@1)"}, {'I', 1, "min(@S, @B)"}, {'I', 1, "max(@S, @S)"}, {'B', 5, "sin(@A)"},
    {'B', 5, "cos(@A)"}, {'B', 4, "tanh(@A)"}, {'B', 3, "sin(tanh(@S))"}, {'B', 2, "tanh(sin(@S))"},
    {'B', 3, "sin(@I)"}, {'B', 3, "cos(@S + @I)"}, {'B', 3, "sin(@S - @I)"}, {'B', 2, "cos(@i*@S - 2*@I)"},
    {'B', 2, "tanh(@I)"}, {'B', 1, "@S/hypot(1, @1)"}, {'B', 1, "@S/(1 + @1^2)"}, {'B', 1, "sin(@S)^2"},
    {'B', 1, "cos(@S)^3"}, {'B', 1, "-sin(-@S)"}, {'B', 1, "exp(-@S^2)"}, {'B', 1, "1/(1 + exp(-@S))"},
    {'B', 1, "1/cosh(@S)"}, {'B', 1, "sin(@S)*cos(@1)"}, {'B', 1, "sin(atan2(@S, @P))"}, {'B', 1, "tanh(@S)*tanh(@1)"},
    {'P', 3, "(1 + @S^2)"}, {'P', 3, "(3/2 + @B)"}, {'P', 2, "cosh(@B)"}, {'P', 2, "exp(@B)"},
    {'P', 2, "sqrt(1 + @S^2)"}, {'P', 2, "@p"}, {'P', 1, "(2 + @B)^@p"}, {'P', 1, "(3/2 + @B)^(2/3)"},
    {'P', 1, "(1 + @S^2)^(-1/2)"}, {'P', 1, "(1 + sinh(@B)^2)"}, {'P', 1, "(2 - tanh(@S)^2)"}, {'P', 1, "hypot(1, @S)"},
    {'P', 1, "(1 + abs(@S))"}, {'P', 1, "2^@B"}, {'P', 1, "(1 + exp(@B))"}, {'P', 1, "sqrt(@P)"},
    {'P', 1, "max(@P, @P)"}, {'C', 3, "@d"}, {'C', 2, "atan(tanh(@d))"}, {'C', 2, "asin(tanh(-@d))"},
    {'C', 1, "sin(@d - @d)"}, {'C', 1, "-tanh(@d)"}, {'C', 1, "atan2(@d, -@p)"}, {'C', 1, "sqrt(@d^2)"},
    {'C', 1, "(-@p)^(1/3)"}, {'C', 1, "log(@p)"}, {'C', 1, "pi/@i"}, {'C', 1, "2*atan(tanh(@d/2))"},
    {'C', 1, "abs(@d)"}, {'F', 1, "tanh(@q/w)"}, {'F', 1, "w*log(cosh(@q/w))"}, {'F', 1, "1/(1 + exp(-@q/w))"},
    {'F', 1, "w*log(1 + exp(@q/w))"}, {'F', 1, "1/cosh(@q/w)^2"}, {'F', 1, "exp(-(@q/w)^2)"},
    {'F', 1, "@B*tanh((@q - @C)/w)"}, {'F', 1, "atan(sinh(@q/w))"}, {'F', 1, "exp(-2*(@q - @n)) - 2*exp(-(@q - @n))"},
    {'V', 8, "@A"}, {'V', 4, "@B"}, {'V', 3, "@F"}, {'V', 3, "@n*@S^2"}, {'V', 2, "@p*@A"}, {'V', 2, "cos(@A + @I)"},
    {'V', 1, "@P"}, {'V', 1, "@B*@B"}, {'T', 3, "@n*@w'"}, {'T', 2, "@w'*@v/8"}, {'T', 2, "@w'^2/2"}, {'T', 2, "@B*@v"},
    {'T', 1, "@A*@v"}, {'T', 1, "@w'*@w'/8"}, {'T', 1, "@B*@v*@v/4"}, {'T', 1, "@w*@w'"}, {'T', 1, "@P*@v^2/2"},
    {'T', 1, "@v^4/4"}, {'T', 1, "sqrt(1 + @v^2)"},
};

static const Rule *pick(Maker *m, char kind) {
  unsigned total = 0;
  for (size_t i = 0; i < sizeof rules / sizeof *rules; i++) total += rules[i].kind == kind ? rules[i].weight : 0;
  unsigned at = below(m, total);
  for (size_t i = 0;; i++) {
    if (rules[i].kind != kind) continue;
    if (at < rules[i].weight) return &rules[i];
    at -= rules[i].weight;
  }
}

static void leaf(Maker *m, char kind) {
  static const char *const positive[] = {"a", "b", "c"}, *const any[] = {"d", "e", "a", "f"},
                           *const number[] = {"2", "3", "1/2", "2/3", "-1", "-3/2", "1/4", "5"};
  switch (kind) {
    case 'p': say(m, "%s", positive[below(m, 3)]); return;
    case 'd': say(m, "%s", any[below(m, 4)]); return;
    case 'n': say(m, "%s", number[below(m, 8)]); return;
    case 'i': say(m, "%u", 2 + below(m, 5)); return;
    case 'v': say(m, "%s", m->velocity[below(m, m->velocities)]); return;
    case 'w': say(m, "w%u", 1 + below(m, m->lets)); return;
    case 'B': say(m, "sin(%s)", m->name[below(m, m->names)]); return;
    case 'P': say(m, "(1 + %s^2)", m->name[below(m, m->names)]); return;
    default: say(m, "%s", m->name[below(m, m->names)]);
  }
}

static int is_leaf(char kind) { return strchr("pdnivwq", kind) != NULL; }

/* One level for each function inside another: no deeper than DEEP. */
static void make(Maker *m, char kind, int depth) {
  size_t from[ARGS], len[ARGS];
  unsigned args = 0;
  if (is_leaf(kind) || depth >= DEEP || m->budget == 0) {
    leaf(m, kind);
    return;
  }
  m->budget--;
  for (const char *c = pick(m, kind)->text; *c && !m->failed; c++) {
    if (*c != '@') {
      put(m, c, 1);
    } else if (*++c == '1') {
      char *copy = malloc(len[0] + 1);
      if (!copy) m->failed = 1;
      else put(m, memcpy(copy, m->out.at + from[0], len[0]), len[0]);
      free(copy);
    } else {
      size_t start = m->out.n;
      make(m, *c, depth + 1);
      if (args < ARGS) from[args] = start, len[args++] = m->out.n - start;
    }
  }
}

/* --- statements --- */

static void value(Maker *m, char kind, unsigned budget) {
  m->budget = budget;
  make(m, kind, 0);
}

static void coordinate(Maker *m, const char *name) {
  know(m, "%s", name);
  snprintf(m->velocity[m->velocities++], LENGTH, "%s'", name);
}

typedef struct {
  unsigned scalars;
  int family, vector, rotation, state, input, effect, constraint, event, force;
} Shape;

static Shape shape_of(Maker *m) {
  Shape s = {.scalars = 1 + below(m, 3)};
  s.family = chance(m, 12);
  s.vector = chance(m, 12);
  s.rotation = chance(m, 4);
  s.state = chance(m, 15);
  s.input = chance(m, 15);
  s.effect = chance(m, 15);
  s.constraint = chance(m, 10);
  s.event = chance(m, 10);
  s.force = chance(m, 20);
  return s;
}

static void declare(Maker *m, const Shape *s) {
  static const char *const names[] = {"x", "y", "z"};
  for (unsigned i = 0; i < s->scalars; i++) {
    say(m, "coord %s\n", names[i]);
    coordinate(m, names[i]);
  }
  if (s->family) {
    say(m, "coord q[3]\n");
    coordinate(m, "q[1]");
    coordinate(m, "q[2]");
    coordinate(m, "q[3]");
  }
  if (s->vector) {
    say(m, "coord r: vec2\n");
    coordinate(m, "r.x");
    coordinate(m, "r.y");
  }
  if (s->constraint) say(m, "coord k\n");
  if (s->rotation) {
    say(m, "coord R: rotation\n");
    know(m, "(R*(0, 0, 1)).x");
    know(m, "(R*(1, 2, 0)).z");
  }
  say(m, "param a = %u/4 > 0, b = %u/5 > 0, c = %u/3 > 0, d = %d/4, e = -%u/7, f = %d/3 <= 0, w = 1/%u > 0\n",
      1 + below(m, 8), 2 + below(m, 8), 1 + below(m, 6), (int)below(m, 13) - 6, 1 + below(m, 9), -(int)below(m, 7),
      1 + below(m, 40));
}

static void lets(Maker *m) {
  unsigned n = 1 + below(m, 4);
  unsigned base = m->names;
  for (unsigned i = 1; i <= n; i++) {
    say(m, "let w%u = ", i);
    if (chance(m, 15)) know(m, "t");
    value(m, "BIIAS"[below(m, 5)], 7);
    say(m, "\n");
    if (m->names > base && strcmp(m->name[m->names - 1], "t") == 0) m->names--;
    know(m, "w%u", i);
    m->lets = i;
    base = m->names;
  }
  m->moving = m->names;
}

static void kinetic(Maker *m, const Shape *s) {
  static const char *const masses[] = {"1/2", "a/2", "b", "3/2"};
  say(m, "lagrangian = 0");
  for (unsigned i = 0; i < m->velocities; i++) say(m, " + %s*%s^2", masses[below(m, 4)], m->velocity[i]);
  if (s->constraint) say(m, " + k'^2/2");
  if (s->rotation) say(m, " + dot(omega(R), omega(R))/2 + a/2*omega(R).z^2");
  for (unsigned n = below(m, 3); n; n--) {
    say(m, "\n  + ");
    value(m, 'T', 5);
  }
}

static void potential(Maker *m, const Shape *s) {
  if (s->state) know(m, "s");
  if (s->input) know(m, "u");
  for (unsigned n = 1 + below(m, 3); n; n--) {
    say(m, "\n  %c ", "-+"[below(m, 2)]);
    value(m, 'V', 12);
  }
  if (s->family) {
    unsigned names = m->names;
    know(m, "q[i]");
    know(m, "(q[i+1] - q[i])");
    say(m, "\n  - sum(i in 1..2, ");
    value(m, 'V', 6);
    say(m, ")");
    m->names = names;
  }
  if (s->vector)
    say(m, "\n  - %s", below(m, 2) ? "b/hypot(1, norm(r))" : "a/2*dot(r, r) - 1/sqrt(1 + dot(r, (2, 1))^2)");
  say(m, "\n");
}

static void act(Maker *m, const Shape *s) {
  if (s->input) say(m, "input u = sin(%u*t)/2\n", 1 + below(m, 4));
  if (s->state) {
    say(m, "state s\nflow s' = -s + ");
    value(m, 'B', 6);
    say(m, "\n");
  }
  if (s->force) {
    say(m, "force x = -x'/8 + ");
    value(m, 'V', 6);
    say(m, "\n");
  }
  if (s->constraint) {
    unsigned names = m->names;
    m->names = m->moving;
    say(m, "constraint bead: k = ");
    value(m, 'B', 5);
    say(m, "\n");
    m->names = names;
  }
  if (s->effect) {
    say(m, "effect drag {\n  param h = 1/8 > 0\n  dissipation = h/2*x'^2\n  force x = ");
    value(m, 'B', 6);
    say(m, "\n}\n");
  }
  if (s->event) say(m, "event wall: x - 5/2 rising { x' = -x'/2 }\n");
}

static void scene(Maker *m, const Shape *s) {
  say(m, "observe seen = ");
  value(m, 'A', 6);
  say(m, "\nscene one {\n");
  for (unsigned i = 0; i < m->velocities; i++)
    say(m, "  start %s = %d/5, %s = %d/5\n", m->name[i], (int)below(m, 15) - 7, m->velocity[i], (int)below(m, 9) - 4);
  if (s->effect) say(m, "  use drag\n");
  say(m, "  span 1\n  output x, seen, energy every 1/10\n}\n");
}

char *random_model(uint64_t seed, uint64_t number) {
  Maker *m = calloc(1, sizeof *m);
  if (!m) return NULL;
  m->random = seed * 0x9e3779b97f4a7c15u ^ number * 0xd1342543de82ef95u;
  next(m);
  say(m, "model r%llu \"Random model %llu of seed %llu\"\n", (unsigned long long)number, (unsigned long long)number,
      (unsigned long long)seed);
  Shape s = shape_of(m);
  declare(m, &s);
  lets(m);
  kinetic(m, &s);
  potential(m, &s);
  act(m, &s);
  scene(m, &s);
  char *text = m->failed ? NULL : m->out.at;
  if (m->failed) free(m->out.at);
  free(m);
  return text;
}
