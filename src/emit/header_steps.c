/* Steppers of an emitted header: frames around the runtime's kernels, whose steps and tables they carry, so that
 * digits are those of `lagc run`. */
#include <stdlib.h>
#include <string.h>

#include "emit/header_impl.h"
#include "kernels/steppers.def"
#include "emit/header_steps_text.h"

/* Method of a header: of kernels/steppers.def (table: its name there in upper case), or of header_taylor.c,
 * header_variational.c, header_moreau.c. */
typedef enum { OTHER, FIXED, ADAPTIVE, LATE, SPLITTING } MethodKind;
typedef struct {
  const char *name, *table, *words;
  MethodKind kind;
  unsigned wants;
} HeaderMethod;

#define RUNGE_KUTTA_ROW(name, table, kind, dense, order, line, words) {#name, #table, words, kind, 0},
#define SPLITTING_ROW(name, general, order, flags, line, words) {#name, NULL, words, SPLITTING, 0},
static const HeaderMethod methods[] = {
  LAG_RUNGE_KUTTA_METHODS(RUNGE_KUTTA_ROW)
  LAG_SPLITTING_METHODS(SPLITTING_ROW)
  {"variational", NULL, NULL, OTHER, WANT_VARIATION},
  {"taylor", NULL, NULL, OTHER, WANT_TAYLOR},
  {"moreau", NULL, NULL, OTHER, 0},
};
#define RUNGE_KUTTA_ID(name, table, kind, dense, order, line, words) ID_##name,
enum { LAG_RUNGE_KUTTA_METHODS(RUNGE_KUTTA_ID) NMETHODS = sizeof methods / sizeof *methods };

static int adapts(const HeaderMethod *m) { return m->kind == ADAPTIVE || m->kind == LATE; }

/* --- explicit Runge-Kutta methods --- */

static void write_trial(const Header *h, const HeaderMethod *m) {
  int holds = header_has(h, FN_HOLD), early = m->kind == ADAPTIVE, late = m->kind == LATE;
  const LineChoice choices[] = {{'A', adapts(m)},
                                {'I', holds && h->u->u.n}, {'F', holds && !adapts(m)}, {'H', holds && early},
                                {'E', !holds && early}, {'L', holds && late},
                                {0, 0}};
  const char *onto = arena_printf(h->a, "lag_onto(p, end%s, end->lost + 1)",
                                  h->u->u.n ? ", lag_held(p, end->t, u, input, context, now)" : "");
  const HeaderWord words[] = {{"WORDS", m->words},
                              {"METHOD", m->name},
                              {"TABLE", m->table},
                              {"MORE", adapts(m) ? ", const lag_adaptive *w, LAG_REAL *error" : ""},
                              {"ONTO", onto},
                              {"LAST", arena_printf(h->a, "LAG_%s_LAST", m->table)},
                              {"TWO", late ? "1" : "0"},
                              {NULL, NULL}};
  header_section(h, m->name);
  header_template(h, header_chosen(h, trial, choices), words);
}

/* --- the frame --- */

/* --- the methods of a header --- */

static int is_wanted(const Header *h, int i) { return i == ID_rk4 || (h->parts.methods >> i & 1) != 0; }
static int some_adaptive(const Header *h) {
  for (int i = 0; i < NMETHODS; i++)
    if (is_wanted(h, i) && adapts(&methods[i])) return 1;
  return 0;
}

int header_method(const char *name, size_t n) {
  for (int i = 0; i < NMETHODS; i++)
    if (strlen(methods[i].name) == n && strncmp(methods[i].name, name, n) == 0) return i;
  return -1;
}

unsigned header_method_wants(int method) { return methods[method].wants; }

int header_has_method(const Header *h, const char *name) {
  return is_wanted(h, header_method(name, strlen(name)));
}

const char *header_method_refusal(const ProgramSet *u, int i) {
  if (methods[i].wants == WANT_TAYLOR)
    return u->taylor ? NULL
                     : "analytic functions (no if, abs, sign, min, max), no tables and no constraints; rk45 and dop853 "
                       "step every model";
  if (methods[i].wants == WANT_VARIATION)
    return u->variation && !u->constraints.of.n && !u->z.n
               ? NULL
               : "coordinates alone, without states and constraints; rk45 and dop853 step every model";
  if (strcmp(methods[i].name, "moreau") == 0) return header_moreau_lacks(u);
  if (methods[i].kind != SPLITTING || (u->flags & 1u << UNIT_SEPARABLE && !u->constraints.of.n && !u->z.n)) return NULL;
  return "accelerations that depend on t and coordinates alone, a constant mass matrix, no states and no constraints";
}

unsigned header_methods(const ProgramSet *u) {
  unsigned all = 0;
  for (int i = 0; i < NMETHODS; i++) all |= header_method_refusal(u, i) ? 0 : 1u << i;
  return all;
}

/* with: inputs are a function of time. */
static const char *prototype(const Header *h, const HeaderMethod *m, int with) {
  const char *u = with        ? ", lag_input_fn *input, void *context"
                  : h->u->u.n ? ", const LAG_REAL *u"
                              : "",
             *step = with ? "step_with" : "step";
  if (!adapts(m))
    return arena_printf(h->a, "int lag_%s_%s(const lag_params *p, lag_state *s, LAG_REAL h%s%s)", m->name, step, u,
                        m->kind == SPLITTING ? ", LAG_REAL *a" : "");
  return arena_printf(h->a, "int lag_%s_%s(const lag_params *p, lag_state *s, lag_adaptive *w, LAG_REAL until%s)",
                      m->name, step, u);
}

static const char *const guard =
    "\n#if !defined(LAG_LANES) && !defined(LAG_COMPLEX) /* one step size for one state */\n";

static const char *const ordered = "\n#ifndef LAG_COMPLEX\n";

static int has_single(const Header *h) { return header_has_method(h, "variational") || header_has_method(h, "moreau"); }
static int has_status(const Header *h) { return some_adaptive(h) || has_single(h) || header_has_method(h, "taylor"); }

static void declare_both(const Header *h, const HeaderMethod *m) {
  for (int with = 0; with < (h->u->u.n ? 2 : 1); with++) {
    if (with) header_printf(h, "/* The same with inputs that change during the step. */\n");
    sb_puts(h->out, header_wrapped(h, "LAG_API %s;", prototype(h, m, with)));
    header_printf(h, "\n");
  }
}

static void declare_single(const Header *h) {
  header_printf(h, "%s", guard);
  if (header_has_method(h, "variational")) header_variational_declare(h);
  if (header_has_method(h, "moreau")) header_moreau_declare(h);
  header_printf(h, "#elif defined(LAG_LANES)\n");
  if (header_has_method(h, "variational")) {
    header_printf(h, "typedef struct lag_variational { int order; } lag_variational;\n");
    header_one_state(h, "variational_begin", "make steps by another method, or variational ones");
    header_one_state(h, "variational_step", "make steps by another method, or variational ones");
  }
  if (header_has_method(h, "moreau")) header_one_state(h, "moreau_step", "make such steps");
  header_printf(h, "#endif\n");
}

void header_steps_declare(const Header *h) {
  if (has_status(h))
    header_printf(
        h, "\n/* Status codes of steps: no step is short enough, Newton's method does not converge, a tolerance is "
           "not positive. */\nenum { LAG_ESTEP = -2, LAG_ENEWTON = -3, LAG_ETOLERANCE = -8 };\n");
  if (some_adaptive(h)) {
    header_printf(h, "%s", ordered);
    header_adaptive_declare(h);
  }
  for (int i = 0; i < NMETHODS; i++) {
    const HeaderMethod *m = &methods[i];
    if (!is_wanted(h, i) || !adapts(m)) continue;
    header_printf(h, "\n/* One step by %s, towards the time `until` and not beyond it.%s%s */\n", m->words,
                  h->u->u.n ? header_held_inputs : "", header_adaptive_lanes);
    declare_both(h, m);
  }
  if (some_adaptive(h)) header_printf(h, "#endif\n");
  if (header_has_method(h, "taylor")) {
    header_printf(h, "%s", ordered);
    header_taylor_declare(h);
    header_printf(h, "#endif\n");
  }
  if (has_single(h)) declare_single(h);
  for (int i = 0; i < NMETHODS; i++) {
    if (i == ID_rk4 || !is_wanted(h, i) || methods[i].kind != FIXED) continue;
    header_printf(h, "\n/* A step h by %s.%s */\n", methods[i].words, h->u->u.n ? header_held_inputs : "");
    declare_both(h, &methods[i]);
  }
  for (int i = 0; i < NMETHODS; i++) {
    const HeaderMethod *m = &methods[i];
    if (!is_wanted(h, i) || m->kind != SPLITTING) continue;
    header_printf(h,
                  "\n/* A step h by %s. a[LAG_NQ]: the accelerations at *s, by _accel before the first step; "
                  "the\n * step leaves those at its end.%s */\n",
                  m->words, h->u->u.n ? " u: the inputs, constant during the step; 0 for the model's formulas." : "");
    declare_both(h, m);
  }
}

/* With inputs, one internal function serves both kinds: u held, or evaluated at each stage. */
static void define_both(const Header *h, const HeaderMethod *m) {
  int splits = m->kind == SPLITTING;
  const char *call = splits ? arena_printf(h->a, "lag_splitting_step(&lag_compose_%s, p, s, h, a", m->name)
                            : arena_printf(h->a, "lag_%s(p, s, w, until", m->name);
  for (int with = 0; (h->u->u.n || splits) && with < (h->u->u.n ? 2 : 1); with++) {
    if (!splits || with) header_printf(h, "\n");
    sb_puts(h->out, header_wrapped(h, "LAG_API %s", prototype(h, m, with)));
    header_printf(h, " {\n  return %s%s);\n}\n", call, !h->u->u.n ? "" : with ? ", 0, input, context" : ", u, 0, 0");
  }
}

static void define_method(const Header *h, const HeaderMethod *m) {
  const HeaderWord words[] = {{"METHOD", m->name}, {"TABLE", m->table}, {NULL, NULL}};
  header_printf(h, "\n");
  sb_puts(h->out, h->u->u.n
                      ? header_wrapped(h,
                                       "static int lag_%s(const lag_params *p, lag_state *s, lag_adaptive *w, LAG_REAL "
                                       "until%s)",
                                       m->name, header_held_parameters)
                      : header_wrapped(h, "LAG_API %s", prototype(h, m, 0)));
  header_template(h, adaptive_step, words);
  define_both(h, m);
}

static void define_splitting(const Header *h) {
  int some = 0;
  for (int i = 0; i < NMETHODS; i++) {
    if (!is_wanted(h, i) || methods[i].kind != SPLITTING) continue;
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
static void define_dense_steps(const Header *h) {
  header_sections(h, "dop853_dense, dense");
  header_template(h, dense_steps, NULL);
}

/* Steps of one size: rk4, which every header has, and others. */
static void define_fixed(const Header *h, const HeaderMethod *m) {
  const HeaderWord words[] = {{"METHOD", m->name}, {"TABLE", m->table}, {NULL, NULL}};
  const char *inner = m == &methods[ID_rk4] ? "step" : m->name;
  write_trial(h, m);
  header_printf(h, "\n");
  if (!h->u->u.n) sb_puts(h->out, header_wrapped(h, "LAG_API %s", prototype(h, m, 0)));
  else
    header_printf(h,
                  "static int lag_%s(const lag_params *p, lag_state *s, LAG_REAL h, const LAG_REAL *u,\n   "
                  "lag_input_fn *input, void *context)",
                  inner);
  header_template(h, fixed_step, words);
  for (int with = 0; h->u->u.n && with < 2; with++) {
    header_printf(h, "\n");
    sb_puts(h->out, header_wrapped(h, "LAG_API %s", prototype(h, m, with)));
    header_printf(h, " {\n  return lag_%s(p, s, h, %s);\n}\n", inner, with ? "0, input, context" : "u, 0, 0");
  }
}

static const char *longest(const Header *h) {
  const IrScene *s = h->scene;
  return s->has_span ? arena_printf(h->a, "(%s - %s)/LAG_C(10.0)", header_constant(h, s->t1), header_constant(h, s->t0))
                     : "LAG_C(0.0)";
}

/* Methods that need an order of numbers. */
static void define_adaptive(const Header *h) {
  header_printf(h, "%s", ordered);
  math_power(h->upper, h->lower, h->out);
  header_sections(h, "errors, step_size");
  header_adaptive_define(h, longest(h));
  for (int i = 0; i < NMETHODS; i++) {
    const HeaderMethod *m = &methods[i];
    if (!is_wanted(h, i) || !adapts(m)) continue;
    write_trial(h, m);
    define_method(h, m);
    if (h->parts.parts & PART_PATH && !header_has_method(h, "moreau")) define_dense_steps(h);
  }
  header_printf(h, "#endif\n");
}

static void define_taylor(const Header *h) {
  header_printf(h, "%s", ordered);
  if (!some_adaptive(h)) math_power(h->upper, h->lower, h->out);
  header_taylor_define(h, longest(h));
  header_printf(h, "#endif\n");
}

/* Methods that need one state, too: not over lanes. */
static void define_single(const Header *h) {
  header_printf(h, "%s", guard);
  if (header_has_method(h, "variational")) header_variational_define(h);
  if (header_has_method(h, "moreau")) header_moreau_define(h);
  header_printf(h, "#endif\n");
}

void header_steps_define(const Header *h) {
  header_template(h, support, NULL);
  header_section(h, "sum");
  int holds = header_has(h, FN_HOLD), events = (h->parts.parts & (PART_EVENTS | PART_PATH)) != 0;
  if (holds || events || header_has_method(h, "taylor") || has_single(h)) {
    if (!holds) header_printf(h, "%s", ordered);
    header_template(h, epsilon, NULL);
    if (!holds) header_printf(h, "#endif\n");
  }
  if (holds) header_hold_define(h);
  header_move(h);
  header_section(h, "runge_kutta");
  header_template(h, runge_kutta, NULL);
  for (int i = 0; i < NMETHODS; i++)
    if (is_wanted(h, i) && methods[i].kind == FIXED) define_fixed(h, &methods[i]);
  if (some_adaptive(h)) define_adaptive(h);
  if (header_has_method(h, "taylor")) define_taylor(h);
  if (has_single(h)) define_single(h);
  define_splitting(h);
}
