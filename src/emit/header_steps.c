/* Steppers of an emitted header. Coefficients are the text of the runtime's own tables, so that the digits are those of `lagc run`. */
#include <stdlib.h>
#include <string.h>

#include "emit/header_impl.h"

#include "emit/dop853_text.h" /* static const char *const NAME_text[]: lines of runtime/methods/NAME.c */
#include "emit/rk4_text.h"
#include "emit/rk45_text.h"

typedef VEC(const char *) Texts;

/* Method of a header: its table in a file of runtime/methods; or, with programs of its own, from header_taylor.c and header_variational.c. */
typedef struct {
  const char *name, *table, *words;
  const char *const *lines;
  size_t n;
  unsigned wants;
} HeaderMethod;

#define LINES(text) text, sizeof text / sizeof *text
static const HeaderMethod methods[] = {
  {"rk4", "lag_tableau tableau", "the classical Runge-Kutta method of order 4", LINES(rk4_text), 0},
  {"rk45", "lag_dopri5_tableau", "Dormand and Prince's Runge-Kutta pair of order 5(4)", LINES(rk45_text), 0},
  {"dop853", "lag_dop853_tableau", "Dormand and Prince's Runge-Kutta method of order 8(5,3)", LINES(dop853_text), 0},
  {"symplectic_euler", NULL, "symplectic Euler, order 1", NULL, 0, 0},
  {"verlet", NULL, "Stoermer and Verlet's method, symplectic, order 2", NULL, 0, 0},
  {"verlet4", NULL, "Blanes and Moan's symplectic method of order 4", NULL, 0, 0},
  {"verlet6", NULL, "Blanes and Moan's symplectic method of order 6", NULL, 0, 0},
  {"verlet8", NULL, "Blanes, Casas and Escorihuela's symplectic method of order 8", NULL, 0, 0},
  {"variational", NULL, NULL, NULL, 0, WANT_VARIATION},
  {"taylor", NULL, NULL, NULL, 0, WANT_TAYLOR},
  {"moreau", NULL, NULL, NULL, 0, 0},
};

/* --- the runtime's tables --- */

static const char *joined(Arena *a, const HeaderMethod *m) {
  StrBuf b = strbuf(a);
  for (size_t i = 0; i < m->n; i++) sb_puts(&b, m->lines[i]);
  return sb_text(&b);
}

/* The text of MEMBER's value in the initialiser of the table; "" where it has none. */
static const char *member(Arena *a, const HeaderMethod *m, const char *name) {
  const char *from = strstr(joined(a, m), arena_printf(a, "%s = {", m->table)), *end = strstr(from, "};");
  const char *at = strstr(from, arena_printf(a, ".%s = ", name));
  return at && at < end ? strchr(at, '=') + 2 : "";
}

/* A coefficient in C: numbers become constants of the scalar's type. */
static const char *coefficient(const Header *h, const char *s, size_t n) {
  StrBuf b = strbuf(h->a);
  const char *end = s + n, *minus = strstr(s, " - ");
  int difference = minus && minus < end;
  if (difference) sb_putc(&b, '(');
  while (s < end) {
    char *after;
    if ((*s < '0' || *s > '9') && *s != '.') {
      if (*s != ' ' || difference) sb_putc(&b, *s);
      s++;
      continue;
    }
    (void)strtod(s, &after);
    size_t digits = (size_t)(after - s);
    sb_printf(&b, "%s_C(%.*s%s)", h->upper, (int)digits, s, memchr(s, '.', digits) ? "" : ".0");
    s = after;
  }
  if (difference) sb_putc(&b, ')');
  return sb_text(&b);
}

/* The first list of coefficients at or after *s, `{a, b, ...}`; zeros are "". *s moves behind it. */
static Texts list_of(const Header *h, const char **s) {
  Texts t = {0};
  const char *at = *s + strcspn(*s, "{") + 1;
  while (*at != '}') {
    at += strspn(at, " \n");
    size_t n = strcspn(at, ",}");
    vec_push(h->a, &t, n == 1 && *at == '0' ? "" : coefficient(h, at, n));
    at += n;
    if (*at == ',') at++;
  }
  *s = at + 1;
  return t;
}

static Texts list_member(const Header *h, const HeaderMethod *m, const char *name) {
  const char *s = member(h->a, m, name);
  return *s ? list_of(h, &s) : (Texts){0};
}

/* --- explicit Runge-Kutta methods --- */

/* The sum of the coefficients below n times stages, some on a line; NULL where all are 0. */
static const char *weighted(const Header *h, const Texts *row, uint32_t n) {
  enum { A_LINE = 3 };
  StrBuf b = strbuf(h->a);
  uint32_t terms = 0;
  for (uint32_t j = 0; j < n && j < row->n; j++)
    if (row->at[j][0]) sb_printf(&b, "%s%s*k[%u][i]", !terms++ ? "" : terms % A_LINE == 1 ? "\n      + " : " + ", row->at[j], j);
  return terms ? sb_text(&b) : NULL;
}

static void line(const Header *h, const char *text) { csupport_expand(text, h->upper, h->lower, h->out); }

/* A prototype, broken where it is long with the header's prefix. */
static void write_prototype(const Header *h, const char *text) {
  StrBuf b = strbuf(h->a);
  csupport_expand(text, h->upper, h->lower, &b);
  sb_puts(h->out, header_wrapped(h, sb_text(&b)));
}

/* A call within a step, and what its failure does. */
static const char *tried(const Header *h, const char *call) { return arena_printf(h->a, "  LAG_TRY(%s);\n", call); }

/* Stage s of a step: its state, and its rates. The newest stage is added last, as in the runtime. */
static void write_stage(const Header *h, const Texts *row, const char *c, uint32_t s) {
  const char *sum = weighted(h, row, s - 1);
  const char *newest = strchr(row->at[s - 1], '/') ? arena_printf(h->a, "(%s)", row->at[s - 1]) : row->at[s - 1];
  line(h, arena_printf(h->a, "  for (int i = 0; i < LAG_NY; i++) x[i] = y[i]%s + (h*%s)*k[%u][i];\n", sum ? arena_printf(h->a, " + h*(%s)", sum) : "", newest, s - 1));
  line(h, tried(h, arena_printf(h->a, "lag_rates(p, s->t + %s*h, x%s, k[%u])", c, h->u->u.n ? ", u, input, context" : "", s)));
}

/* Error estimates: squared, weighted by the tolerances, in pairs of components as in the runtime. */
static void write_error(const Header *h, const HeaderMethod *m, uint32_t last, int late) {
  Texts e = list_member(h, m, "e"), e3 = list_member(h, m, "e3");
  line(h, "  LAG_REAL fine = LAG_C(0.0), coarse = LAG_C(0.0);\n"
          "  for (int i = 0; i < LAG_NY; i++) {\n"
          "    const LAG_REAL a = LAG_FN(fabs)(y[i]), b = LAG_FN(fabs)(x[i]), per = LAG_C(1.0)/(w->absolute + w->tolerance*LAG_SELECT(a > b, a, b));\n");
  line(h, arena_printf(h->a, "    const LAG_REAL e = per*(%s);\n", weighted(h, &e, last + 1 - (uint32_t)late)));
  if (late) line(h, arena_printf(h->a, "    const LAG_REAL e3 = per*(%s);\n", weighted(h, &e3, last)));
  line(h, "    even = i % 2 ? even + e*e : e*e;\n    if (i % 2 || i == LAG_NY - 1) fine += even;\n");
  if (late) line(h, "    even3 = i % 2 ? even3 + e3*e3 : e3*e3;\n    if (i % 2 || i == LAG_NY - 1) coarse += even3;\n");
  line(h, "  }\n  fine *= h*h*(LAG_C(1.0)/(LAG_LANE)LAG_NY);\n");
  if (late) line(h, "  coarse *= LAG_C(0.01)*h*h*(LAG_C(1.0)/(LAG_LANE)LAG_NY);\n");
  line(h, "  const LAG_REAL both = fine + coarse;\n"
          "  *error = LAG_SELECT(both - both == LAG_C(0.0), ");
  line(h, late ? "LAG_SELECT(both > LAG_C(0.0), fine*(fine/both), LAG_C(0.0))" : "both");
  line(h, ", -LAG_C(1.0));\n");
}

/* lag_METHOD_trial: a step from *s to end->t, with the rates k[0] at *s. Adaptive methods estimate its error. */
static void write_trial(const Header *h, const HeaderMethod *m, int adaptive, int late) {
  const char *at = member(h->a, m, "a");
  Texts c = list_member(h, m, "c");
  uint32_t last = (uint32_t)strtoul(member(h->a, m, "stages"), NULL, 10) - 1;
  const char *u = h->u->u.n ? header_held_parameters : "", *pass = h->u->u.n ? ", u, input, context" : "";
  line(h, arena_printf(h->a, "\n/* The state after a step h by %s; k[0]: the rates at *s.%s */\n", m->words,
                       adaptive ? " *error: squared, relative to the tolerances; negative where\n * it is not finite." : ""));
  write_prototype(h, arena_printf(h->a, "static int lag_%s_trial(const lag_params *p, const lag_state *s, LAG_REAL h%s, LAG_REAL (*k)[LAG_NY], lag_state *end%s)", m->name, u,
                                         adaptive ? ", const lag_adaptive *w, LAG_REAL *error" : ""));
  int holds = header_has(h, FN_HOLD);
  line(h, arena_printf(h->a, " {\n  LAG_REAL y[LAG_NY], x[LAG_NY]%s%s%s;\n  int status%s;\n  lag_gather(s, y);\n", adaptive ? ", even = LAG_C(0.0)" : "",
                       late ? ", even3 = LAG_C(0.0)" : "", holds && *u ? ", now[LAG_NU]" : "", " = LAG_OK"));
  at++;
  list_of(h, &at); /* row 0 */
  Texts row = list_of(h, &at);
  for (uint32_t s = 1; s < last; s++, row = list_of(h, &at)) write_stage(h, &row, c.at[s], s);
  const char *sum = weighted(h, &row, last);
  line(h, arena_printf(h->a, "  for (int i = 0; i < LAG_NY; i++) x[i] = lag_compensated_sum(y[i], h*(%s), &end->lost[i + 1]);\n  lag_scatter(x, end);\n", sum));
  const char *hold = arena_printf(h->a, "lag_onto(p, end%s, end->lost + 1)", h->u->u.n ? ", lag_held(p, end->t, u, input, context, now)" : "");
  if (!late && holds && !adaptive) line(h, tried(h, hold));
  if (!late && adaptive) {
    const char *rates = arena_printf(h->a, "lag_rates(p, end->t, x%s, k[%u])", pass, last);
    if (holds) line(h, arena_printf(h->a, "  const LAG_MASK held = LAG_NOT(LAG_FAILED(%s)); /* a shorter step where it cannot be */\n"
                                          "  *error = -LAG_C(1.0);\n  if (!LAG_ANY(held)) return status;\n  lag_gather(end, x);\n", hold));
    line(h, tried(h, holds ? arena_printf(h->a, "LAG_WHERE(held, %s)", rates) : rates));
  }
  if (adaptive) write_error(h, m, last, late);
  if (!late && holds && adaptive) line(h, "  *error = LAG_SELECT(held, *error, -LAG_C(1.0));\n");
  if (late && holds)
    line(h, arena_printf(h->a, "  const LAG_MASK taken = LAG_AND(*error >= LAG_C(0.0), *error <= LAG_C(1.0));\n"
                               "  if (LAG_ANY(taken)) *error = LAG_SELECT(LAG_FAILED(LAG_WHERE(taken, %s)), -LAG_C(1.0), *error);\n", hold));
  line(h, "  return status;\n}\n");
}

/* Lines marked q, z or u are for models with coordinates, states or inputs. */
static const char *const support =
  " |\n"
  " |/* The state as one array: q, v, z. */\n"
  " |static void lag_gather(const lag_state *s, LAG_REAL *y) {\n"
  "q|  for (int i = 0; i < LAG_NQ; i++) {\n"
  "q|    y[i] = s->q[i];\n"
  "q|    y[LAG_NQ + i] = s->v[i];\n"
  "q|  }\n"
  "z|  for (int i = 0; i < LAG_NZ; i++) y[2*LAG_NQ + i] = s->z[i];\n"
  " |}\n"
  " |\n"
  " |static void lag_scatter(const LAG_REAL *y, lag_state *s) {\n"
  "q|  for (int i = 0; i < LAG_NQ; i++) {\n"
  "q|    s->q[i] = y[i];\n"
  "q|    s->v[i] = y[LAG_NQ + i];\n"
  "q|  }\n"
  "z|  for (int i = 0; i < LAG_NZ; i++) s->z[i] = y[2*LAG_NQ + i];\n"
  " |}\n"
  " |\n"
  "u|\n"
  "u|/* The inputs at time t: those held, or the model's own and the caller's. */\n"
  "u|static const LAG_REAL *lag_held(const lag_params *p, LAG_REAL t, const LAG_REAL *u, lag_input_fn *input, void *context, LAG_REAL *now) {\n"
  "u|  if (u) return u;\n"
  "u|  lag_inputs(t, p, now);\n"
  "u|  if (input) input(context, t, now);\n"
  "u|  return now;\n"
  "u|}\n"
  " |\n"
  " |static int lag_rates(const lag_params *p, LAG_REAL t, const LAG_REAL *yHELD, LAG_REAL *k) {\n"
  "u|  LAG_REAL now[LAG_NU];\n"
  "q|  for (int i = 0; i < LAG_NQ; i++) k[i] = y[LAG_NQ + i];\n"
  " |  return lag_rates_at(CALL);\n"
  " |}\n";

/* Steps of one size. */
static const char *const fixed_step =
  " | {\n"
  " |  LAG_REAL y[LAG_NY], k[STAGES][LAG_NY];\n"
  " |  lag_state end = *s;\n"
  " |  end.t = lag_compensated_sum(s->t, h, &end.lost[0]);\n"
  " |  lag_gather(s, y);\n"
  " |  int status = LAG_OK;\n"
  " |  LAG_TRY(lag_rates(p, s->t, yPASS, k[0]));\n"
  " |  LAG_TRY(lag_METHOD_trial(p, s, hPASS, k, &end));\n"
  " |  LAG_TRY(lag_check(&end));\n"
  " |  LAG_MOVE(LAG_NOT(LAG_FAILED(status)), s, &end);\n"
  " |  return status;\n"
  " |}\n";

/* Adaptive steps: a frame around header_adaptive.c. */
static const char *const adaptive_step =
  " | {\n"
  " |  LAG_REAL k[STAGES][LAG_NY];\n"
  " |  const lag_controller c = {lag_METHOD_trial, CONTROLLER};\n"
  " |  return lag_adapt(&c, p, s, w, untilPASS, k);\n"
  " |}\n";

/* Kicks and drifts: the frame of kernels/splitting.h, whose text comes after what it calls. */
static const char *const splitting_forces =
  " |#define LAG_MODEL const lag_params *pHELD\n"
  " |#define LAG_FORCES(t, q, v, a) lag_forces(p, t, q, vPASS, a)\n"
  " |static int lag_forces(const lag_params *p, LAG_REAL t, const LAG_REAL *q, const LAG_REAL *vHELD, LAG_REAL *a) {\n"
  "u|  LAG_REAL now[LAG_NU];\n"
  "u|  return lag_accel(t, q, v, p, lag_held(p, t, u, input, context, now), a);\n"
  "n|  return lag_accel(t, q, v, p, a);\n"
  " |}\n";

static const char *const splitting_step =
  " |static int lag_splitting_step(const lag_composition *c, const lag_params *p, lag_state *s, LAG_REAL h, LAG_REAL *aHELD) {\n"
  " |  LAG_REAL dq[LAG_NQ], dv[LAG_NQ], b[LAG_NQ];\n"
  " |  lag_state end = *s;\n"
  " |  const lag_splitting m = {LAG_NQ, s->q, s->v, a, s->lost + 1, end.q, end.v, b, end.lost + 1, end.v, dq, dv};\n"
  " |  int status = LAG_OK;\n"
  " |  end.t = lag_compensated_sum(s->t, h, &end.lost[0]);\n"
  " |  LAG_TRY(lag_split(pPASS, &m, c, s->t, end.t, h));\n"
  " |  LAG_TRY(lag_check(&end));\n"
  " |  const LAG_MASK taken = LAG_NOT(LAG_FAILED(status));\n"
  " |  for (int i = 0; i < LAG_NQ; i++) a[i] = LAG_SELECT(taken, b[i], a[i]);\n"
  " |  LAG_MOVE(taken, s, &end);\n"
  " |  return status;\n"
  " |}\n";

/* --- the methods of a header --- */

static int is_adaptive(const Header *h, const HeaderMethod *m) { return member(h->a, m, "order_embedded")[0] != 0; }
static int is_splitting(const HeaderMethod *m) { return m->words && !m->lines; }
static int is_wanted(const Header *h, uint32_t i) { return i == 0 || (h->parts.methods >> i & 1) != 0; }
static int has_table(const HeaderMethod *m) { return m->words != NULL; }

static int some_adaptive(const Header *h) {
  for (uint32_t i = 0; i < sizeof methods / sizeof *methods; i++)
    if (is_wanted(h, i) && has_table(&methods[i]) && !is_splitting(&methods[i]) && is_adaptive(h, &methods[i])) return 1;
  return 0;
}

int header_method(const char *name, size_t n) {
  for (int i = 0; i < (int)(sizeof methods / sizeof *methods); i++)
    if (strlen(methods[i].name) == n && strncmp(methods[i].name, name, n) == 0) return i;
  return -1;
}

unsigned header_method_wants(int method) { return methods[method].wants; }

int header_has_method(const Header *h, const char *name) { return is_wanted(h, (uint32_t)header_method(name, strlen(name))); }

const char *header_method_refusal(const ProgramSet *u, int i) {
  if (methods[i].wants == WANT_TAYLOR)
    return u->taylor ? NULL : "analytic functions (no if, abs, sign, min, max), no tables and no constraints; rk45 and dop853 step every model";
  if (methods[i].wants == WANT_VARIATION)
    return u->variation && !u->constraints.of.n && !u->z.n ? NULL : "coordinates alone, without states and constraints; rk45 and dop853 step every model";
  if (strcmp(methods[i].name, "moreau") == 0) return header_moreau_lacks(u);
  if (!is_splitting(&methods[i]) || (u->flags & 1u << UNIT_SEPARABLE && !u->constraints.of.n && !u->z.n)) return NULL;
  return "accelerations that depend on t and coordinates alone, a constant mass matrix, no states and no constraints";
}

unsigned header_methods(const ProgramSet *u) {
  unsigned all = 0;
  for (int i = 0; i < (int)(sizeof methods / sizeof *methods); i++) all |= header_method_refusal(u, i) ? 0 : 1u << i;
  return all;
}

/* with: inputs are a function of time. */
static const char *prototype(const Header *h, const HeaderMethod *m, int with) {
  const char *u = with ? ", lag_input_fn *input, void *context" : h->u->u.n ? ", const LAG_REAL *u" : "", *step = with ? "step_with" : "step";
  if (is_splitting(m)) return arena_printf(h->a, "int lag_%s_%s(const lag_params *p, lag_state *s, LAG_REAL h%s, LAG_REAL *a)", m->name, step, u);
  return arena_printf(h->a, "int lag_%s_%s(const lag_params *p, lag_state *s, lag_adaptive *w, LAG_REAL until%s)", m->name, step, u);
}

static const char *const guard = "\n#if !defined(LAG_LANES) && !defined(LAG_COMPLEX) /* one step size for one state */\n";

static const char *const ordered = "\n#ifndef LAG_COMPLEX\n";

static int has_single(const Header *h) { return header_has_method(h, "variational") || header_has_method(h, "moreau"); }
static int has_status(const Header *h) { return some_adaptive(h) || has_single(h) || header_has_method(h, "taylor"); }

static void declare_both(const Header *h, const HeaderMethod *m) {
  for (int with = 0; with < (h->u->u.n ? 2 : 1); with++) {
    if (with) line(h, "/* The same with inputs that change during the step. */\n");
    write_prototype(h, arena_printf(h->a, "LAG_API %s;", prototype(h, m, with)));
    line(h, "\n");
  }
}

void header_steps_declare(const Header *h) {
  if (has_status(h)) line(h, "\n/* Status codes of steps: no step is short enough, Newton's method does not converge, a tolerance is not positive. */\nenum { LAG_ESTEP = -2, LAG_ENEWTON = -3, LAG_ETOLERANCE = -8 };\n");
  if (some_adaptive(h)) {
    line(h, ordered);
    header_adaptive_declare(h);
  }
  for (uint32_t i = 1; i < sizeof methods / sizeof *methods; i++) {
    const HeaderMethod *m = &methods[i];
    if (!is_wanted(h, i) || !has_table(m) || is_splitting(m)) continue;
    line(h, arena_printf(h->a, "\n/* One step by %s, towards the time `until` and not beyond it.%s%s */\n", m->words,
                         h->u->u.n ? header_held_inputs : "", header_adaptive_lanes));
    declare_both(h, m);
  }
  if (some_adaptive(h)) line(h, "#endif\n");
  if (header_has_method(h, "taylor")) {
    line(h, ordered);
    header_taylor_declare(h);
    line(h, "#endif\n");
  }
  if (has_single(h)) line(h, guard);
  if (header_has_method(h, "variational")) header_variational_declare(h);
  if (header_has_method(h, "moreau")) header_moreau_declare(h);
  if (has_single(h)) line(h, "#elif defined(LAG_LANES)\n");
  if (header_has_method(h, "variational")) {
    line(h, "typedef struct lag_variational { int order; } lag_variational;\n");
    header_one_state(h, "variational_begin", "make steps by another method, or variational ones");
    header_one_state(h, "variational_step", "make steps by another method, or variational ones");
  }
  if (header_has_method(h, "moreau")) header_one_state(h, "moreau_step", "make such steps");
  if (has_single(h)) line(h, "#endif\n");
  for (uint32_t i = 1; i < sizeof methods / sizeof *methods; i++) {
    const HeaderMethod *m = &methods[i];
    if (!is_wanted(h, i) || !is_splitting(m)) continue;
    line(h, arena_printf(h->a, "\n/* A step h by %s. a[LAG_NQ]: the accelerations at *s, by _accel before the first step; the\n * step leaves those at its end.%s */\n",
                         m->words, h->u->u.n ? " u: the inputs, constant during the step; 0 for the model's formulas." : ""));
    declare_both(h, m);
  }
}

/* The members 2 to 6 of the method's EmbeddedPair: beta, ratio, safety, and the limits of a change. */
static const char *controller(const Header *h, const HeaderMethod *m, int *late) {
  const char *s = strstr(joined(h->a, m), "EmbeddedPair pair = ");
  StrBuf b = strbuf(h->a);
  char *end;
  s = strchr(strchr(s, '{'), ',') + 1;
  *late = (int)strtol(s, &end, 10);
  const char *at = end + 1; /* beta, ratio, safety, shrink_most, grow_most */
  Texts t = {0};
  for (int i = 0; i < 5; i++) {
    size_t n = strcspn(at, ",");
    vec_push(h->a, &t, i == 1 ? arena_strndup(h->a, at, n) : coefficient(h, at, n));
    at += n + 1;
  }
  sb_printf(&b, "%s,%s, %s, %s, %s, %s", member(h->a, m, "order")[0] == '8' ? "8" : "5", t.at[1], t.at[0], t.at[2], t.at[3], t.at[4]);
  return sb_text(&b);
}

/* With inputs, one internal function serves both kinds: u held, or evaluated at each stage. */
static void define_both(const Header *h, const HeaderMethod *m) {
  int splits = is_splitting(m);
  const char *call = splits ? arena_printf(h->a, "lag_splitting_step(&lag_compose_%s, p, s, h, a", m->name) : arena_printf(h->a, "lag_%s(p, s, w, until", m->name);
  for (int with = 0; (h->u->u.n || splits) && with < (h->u->u.n ? 2 : 1); with++) {
    if (!splits || with) line(h, "\n");
    write_prototype(h, arena_printf(h->a, "LAG_API %s", prototype(h, m, with)));
    line(h, arena_printf(h->a, " {\n  return %s%s);\n}\n", call, !h->u->u.n ? "" : with ? ", 0, input, context" : ", u, 0, 0"));
  }
}

static void define_method(const Header *h, const HeaderMethod *m) {
  uint32_t stages = (uint32_t)strtoul(member(h->a, m, "stages"), NULL, 10);
  int late;
  const HeaderWord words[] = {{"STAGES", arena_printf(h->a, "%u", stages)}, {"METHOD", m->name}, {"CONTROLLER", controller(h, m, &late)}, {NULL, NULL}};
  line(h, "\n");
  write_prototype(h, h->u->u.n ? arena_printf(h->a, "static int lag_%s(const lag_params *p, lag_state *s, lag_adaptive *w, LAG_REAL until%s)", m->name, header_held_parameters)
                               : arena_printf(h->a, "LAG_API %s", prototype(h, m, 0)));
  header_template(h, adaptive_step, words);
  define_both(h, m);
}

static void define_splitting(const Header *h) {
  int some = 0;
  for (uint32_t i = 1; i < sizeof methods / sizeof *methods; i++) {
    if (!is_wanted(h, i) || !is_splitting(&methods[i])) continue;
    if (!some++) {
      header_section(h, "composition");
      header_template(h, splitting_forces, NULL);
      header_section(h, "splitting");
      header_template(h, splitting_step, NULL);
    }
    header_section(h, methods[i].name);
    define_both(h, &methods[i]);
  }
}

/* Steps of dop853 that keep their stages k[16]; the rest of dense output: stages 12 to 15, the highest terms. */
static void define_dense_steps(const Header *h, const HeaderMethod *m) {
  int late;
  const char *at = member(h->a, m, "a"), *d = member(h->a, m, "d");
  const HeaderWord words[] = {{"CONTROLLER", controller(h, m, &late)}, {NULL, NULL}};
  Texts c = list_member(h, m, "c"), row;
  header_template(h,
    " |\n"
    " |static int lag_dop853_keep(const lag_params *p, lag_state *s, lag_adaptive *w, LAG_REAL untilHELD,\n"
    " |    LAG_REAL (*k)[LAG_NY]) {\n"
    " |  const lag_controller c = {lag_dop853_trial, CONTROLLER};\n"
    " |  return lag_adapt(&c, p, s, w, untilPASS, k);\n"
    " |}\n"
    " |\n"
    " |static int lag_dop853_extend(const lag_params *p, const lag_state *s, LAG_REAL h, const lag_state *endHELD,\n"
    " |    LAG_REAL (*k)[LAG_NY], LAG_REAL *high) {\n"
    " |  LAG_REAL y[LAG_NY], x[LAG_NY];\n"
    " |  int status = LAG_OK;\n"
    " |  lag_gather(end, x);\n"
    " |  lag_gather(s, y);\n"
    " |  LAG_TRY(lag_rates(p, end->t, xPASS, k[12]));\n", words);
  for (uint32_t s = (at++, 0); s < 16; s++) {
    row = list_of(h, &at);
    if (s > 12) write_stage(h, &row, c.at[s], s);
  }
  d++;
  for (uint32_t j = 0; j < 4; j++) {
    row = list_of(h, &d);
    const char *sum = weighted(h, &row, row.n);
    line(h, arena_printf(h->a, "  for (int i = 0; i < LAG_NY; i++) high[%u*LAG_NY + i] = %s;\n", j, sum));
  }
  line(h, "  return status;\n}\n");
}

/* The step that every header has. */
static void define_rk4(const Header *h) {
  const HeaderMethod *m = &methods[0];
  const HeaderWord words[] = {{"STAGES", "4"}, {"METHOD", m->name}, {NULL, NULL}};
  write_trial(h, m, 0, 0);
  line(h, "\n");
  if (!h->u->u.n) line(h, header_wrapped(h, arena_printf(h->a, "LAG_API %s", header_prototype(h, FN_RK4_STEP))));
  else line(h, "static int lag_step(const lag_params *p, lag_state *s, LAG_REAL h, const LAG_REAL *u,\n   lag_input_fn *input, void *context)");
  header_template(h, fixed_step, words);
  if (!h->u->u.n) return;
  line(h, arena_printf(h->a, "\nLAG_API %s {\n  return lag_step(p, s, h, u, 0, 0);\n}\n", header_wrapped(h, header_prototype(h, FN_RK4_STEP))));
  line(h, arena_printf(h->a, "\nLAG_API %s {\n  return lag_step(p, s, h, 0, input, context);\n}\n", header_wrapped(h, header_prototype(h, FN_RK4_STEP_WITH))));
}

static const char *const epsilon =
  " |\n"
  " |/* Rounding of the scalar: the least power of 2 that 1 can be told from 1 plus it. */\n"
  " |static LAG_LANE lag_epsilon(void) {\n"
  " |  LAG_LANE one = (LAG_LANE)1, half = one/(LAG_LANE)2, e = one;\n"
  " |  while (one + half*e > one) e *= half;\n"
  " |  return e;\n"
  " |}\n";

static const char *longest(const Header *h) {
  const IrScene *s = h->scene;
  return s->has_span ? arena_printf(h->a, "(%s - %s)/LAG_C(10.0)", header_constant(h, s->t1), header_constant(h, s->t0)) : "LAG_C(0.0)";
}

/* Methods that need an order of numbers. */
static void define_adaptive(const Header *h) {
  line(h, ordered);
  math_power(h->upper, h->lower, h->out);
  header_adaptive_define(h, longest(h));
  for (uint32_t i = 1; i < sizeof methods / sizeof *methods; i++) {
    const HeaderMethod *m = &methods[i];
    int late;
    if (!is_wanted(h, i) || !has_table(m) || is_splitting(m)) continue;
    (void)controller(h, m, &late);
    write_trial(h, m, 1, late);
    define_method(h, m);
    if (h->parts.parts & PART_PATH && !header_has_method(h, "moreau")) define_dense_steps(h, m);
  }
  line(h, "#endif\n");
}

static void define_taylor(const Header *h) {
  line(h, ordered);
  if (!some_adaptive(h)) math_power(h->upper, h->lower, h->out);
  header_taylor_define(h, longest(h));
  line(h, "#endif\n");
}

/* Methods that need one state, too: not over lanes. */
static void define_single(const Header *h) {
  line(h, guard);
  if (header_has_method(h, "variational")) header_variational_define(h);
  if (header_has_method(h, "moreau")) header_moreau_define(h);
  line(h, "#endif\n");
}

void header_steps_define(const Header *h) {
  header_template(h, support, NULL);
  header_section(h, "sum");
  int holds = header_has(h, FN_HOLD), events = (h->parts.parts & (PART_EVENTS | PART_PATH)) != 0;
  if (holds || events || header_has_method(h, "taylor") || has_single(h)) {
    if (!holds) line(h, ordered);
    header_template(h, epsilon, NULL);
    if (!holds) line(h, "#endif\n");
  }
  if (holds) header_hold_define(h);
  header_move(h);
  define_rk4(h);
  if (some_adaptive(h)) define_adaptive(h);
  if (header_has_method(h, "taylor")) define_taylor(h);
  if (has_single(h)) define_single(h);
  define_splitting(h);
}
