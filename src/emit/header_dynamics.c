/* Parts of an emitted header that `--with` asks for: matrices, inverse dynamics, derivatives, constraints, events,
 * names. */
#include <string.h>

#include "emit/header_impl.h"
#include "emit/header_dynamics_text.h"

/* --- words --- */

enum {
  CONSTRAINED = WANT_CONSTRAINED | WANT_MULTIPLIERS,
  DERIVATIVES = PART_JAC | PART_LINEAR | PART_PARAMS | PART_OUTPUT_JACOBIAN | PART_ADJOINT
};
static const struct {
  const char *name;
  unsigned part, wants;
} words[] = {
  {"mass", PART_MASS, WANT_MASS},
  {"inverse", PART_INVERSE, WANT_INVERSE},
  {"jac", PART_JAC, WANT_LINEAR | CONSTRAINED},
  {"linear", PART_LINEAR, WANT_LINEAR | WANT_BY_INPUTS | CONSTRAINED},
  {"params", PART_PARAMS, WANT_BY_PARAMS | CONSTRAINED},
  {"constraints", PART_CONSTRAINTS, WANT_MULTIPLIERS},
  {"events", PART_EVENTS, 0},
  {"rhs", PART_RHS, 0},
  {"names", PART_NAMES, 0},
  {"outputs", PART_OUTPUT_JACOBIAN, WANT_OUTPUTS | WANT_LINEAR | WANT_BY_INPUTS | CONSTRAINED},
  {"adjoint", PART_ADJOINT, WANT_ADJOINT},
};
enum { WORDS = sizeof words / sizeof *words };

/* Libraries, and the parts that their callbacks call. */
static const struct {
  const char *name;
  unsigned part, parts;
} libraries[] = {
  {"gsl", PART_GSL, PART_RHS | PART_JAC},
  {"cvode", PART_CVODE, PART_RHS | PART_JAC},
  {"arkode", PART_ARKODE, PART_RHS | PART_JAC},
  {"ida", PART_IDA, PART_RHS | PART_JAC | PART_INVERSE},
  {"casadi", PART_CASADI, PART_RHS | PART_LINEAR | PART_PARAMS},
};
enum { LIBRARIES = sizeof libraries / sizeof *libraries };

static int is_word(const char *s, size_t n, const char *word) { return strlen(word) == n && strncmp(s, word, n) == 0; }

/* Index of a library, or -1. */
static int library(const char *s, size_t n) {
  for (int i = 0; i < LIBRARIES; i++)
    if (is_word(s, n, libraries[i].name)) return i;
  return -1;
}

/* Parts of a word; *some: those that the model lacks are left out. */
static unsigned parts_of(const char *s, size_t n, int *some) {
  int lib = library(s, n);
  *some = lib >= 0 || is_word(s, n, "all");
  if (*some) return lib >= 0 ? libraries[lib].parts : ~0u;
  for (size_t i = 0; i < WORDS; i++)
    if (is_word(s, n, words[i].name)) return words[i].part;
  return 0;
}

unsigned header_wants(const char *list) {
  unsigned wants = 0;
  int some;
  for (const char *s = list ? list : ""; *s; s += strcspn(s, ","), s += *s == ',') {
    int method = header_method(s, strcspn(s, ","));
    wants |= method >= 0                          ? header_method_wants(method)
             : is_word(s, strcspn(s, ","), "all") ? WANT_VARIATION | WANT_TAYLOR
                                                  : 0;
    for (size_t i = 0; i < WORDS; i++)
      if (words[i].part & parts_of(s, strcspn(s, ","), &some)) wants |= words[i].wants;
  }
  return wants;
}

/* Property that the model lacks for a part, or NULL. */
static const char *lack(const ProgramSet *u, unsigned part) {
  enum { DENSE = 300 };
  if (part & DERIVATIVES && u->contacts.n) return "no contacts: they open and close";
  if (part & (DERIVATIVES | PART_MASS) && 2 * u->q.n + u->z.n > DENSE)
    return "at most 300 coordinates, velocities and states: the matrices are dense";
  if (part & (PART_MASS | PART_INVERSE) && !u->q.n) return "coordinates: this model has states alone";
  if (part & PART_PARAMS && !u->p.n) return "parameters: this model has none that is free";
  if (part & PART_OUTPUT_JACOBIAN && !u->outputs) return "outputs without multipliers, in a scene that has some";
  if (part & PART_ADJOINT && u->constraints.of.n) return "no constraints: their steps have no reverse mode yet";
  if (part & PART_ADJOINT && !u->p.n) return "parameters: this model has none that is free";
  if (part & PART_CONSTRAINTS && !u->constraints.of.n) return "constraints: this model has none";
  if (part & PART_EVENTS && !u->events.n) return "events: this model has none";
  return NULL;
}

int header_parts(const ProgramSet *u, const char *list, HeaderParts *parts, const char **error) {
  for (const char *s = list ? list : ""; *s; s += *s == ',') {
    size_t n = strcspn(s, ",");
    int method = header_method(s, n), lib = library(s, n), some;
    unsigned asked = parts_of(s, n, &some);
    const char *lacks = method >= 0 ? header_method_refusal(u, method) : NULL;
    if (method >= 0) parts->methods |= 1u << method;
    if (lib >= 0) parts->parts |= libraries[lib].part;
    if (lib >= 0 && u->contacts.n)
      lacks = "no contacts, which open and close: a header without --for shows the loop of steps that they need";
    if (lib >= 0 && program_set_kick(u))
      lacks = "no kicks: a header without --for shows the loop of steps that they need";
    for (size_t i = 0; i < WORDS && !lacks; i++) {
      if (!(words[i].part & asked)) continue;
      lacks = lack(u, words[i].part);
      if (!lacks) parts->parts |= words[i].part;
      if (some) lacks = NULL;
    }
    if (is_word(s, n, "all")) parts->methods |= header_methods(u);
    if (lacks) {
      *error = arena_printf(u->arena, "a header has `%.*s` only of models with %s", (int)n, s, lacks);
      return 0;
    }
    s += n;
  }
  if (parts->parts & PART_OUTPUT_JACOBIAN) parts->parts |= PART_LINEAR; /* which it calls */
  return 1;
}

/* --- derivatives --- */

/* Chooses lines marked b (coordinates and states), f (states alone), n (no inputs), c (constraints), o (coordinates
 * without), which become plain ones or go. */
static void write_marked(const Header *h, const char *text, const HeaderWord *w) {
  const ProgramSet *u = h->u;
  StrBuf b = strbuf(h->a);
  for (const char *s = text; *s; s += strcspn(s, "\n") + 1) {
    int wanted = *s == 'b'   ? u->q.n && u->z.n
                 : *s == 'f' ? !u->q.n
                 : *s == 'n' ? !u->u.n
                 : *s == 'c' ? u->constraints.of.n > 0
                 : *s == 'o' ? u->q.n && !u->constraints.of.n
                             : 1;
    size_t n = strcspn(s, "\n") + 1;
    if (wanted) sb_printf(&b, "%c%.*s", strchr("bfnco", *s) ? ' ' : *s, (int)n - 1, s + 1);
  }
  header_template(h, sb_text(&b), w);
}

typedef struct {
  HeaderWord at[13];
} Words;

/* Words of the templates for derivatives by one kind of variables. */
static Words words_of(const Header *h, const char *name, const IrEntry *at, uint32_t n, const char *columns) {
  const ProgramSet *u = h->u;
  const char *a = u->q.n ? ", a" : "", *rates = u->z.n && u->q.n ? ", a, zd" : a,
             *q = u->constraints.of.n ? ", a, lambda" : a;
  const char *out = u->constraints.of.n ? ", m, A" : u->q.n ? ", m" : "";
  return (Words){{{"NAME", name},
                  {"ENTRIES", header_positions(h, at, n)},
                  header_number(h, "NENTRIES", n),
                  header_number(h, "NALL", n ? n : 1),
                  header_number(h, "NMASS", u->linear_mass.n ? u->linear_mass.n : 1),
                  {"COLUMNS", columns},
                  {"STATE", header_state_args(h, 1, "")},
                  header_number(h, "NJACOBIAN", u->constraints.jacobian.n ? u->constraints.jacobian.n : 1),
                  {"RATES", rates},
                  {"WITH", q},
                  {"OUT", out},
                  {NULL, NULL}}};
}

/* lag_by_NAME: derivatives of the rates by state, inputs or parameters. */
static void define_by(const Header *h, const Prog *p, const char *name, const IrEntry *at, uint32_t n,
                      const char *columns) {
  const char *params = h->u->constraints.of.n ? "const LAG_REAL *a, const LAG_REAL *g, LAG_REAL *d, LAG_REAL *m, "
                                                "LAG_REAL *A"
                       : h->u->q.n            ? "const LAG_REAL *a, LAG_REAL *d, LAG_REAL *m"
                                              : "LAG_REAL *d";
  header_state_function(
      h, p, NULL, header_wrapped(h, "static void lag_partials_%s(%s, %s)", name, header_state_args(h, 1, ""), params),
      params, NULL, 0);
  Words w = words_of(h, name, at, n, columns);
  write_marked(h, by, w.at);
}

static void derivatives(const Header *h) {
  const ProgramSet *u = h->u;
  const char *ny = "LAG_NY";
  unsigned parts = h->parts.parts;
  if (parts & (PART_JAC | PART_LINEAR | PART_PARAMS) && u->q.n) {
    const HeaderWord w[] = {{"ENTRIES", header_positions(h, LIST(u->linear_mass))},
                            header_number(h, "NENTRIES", u->linear_mass.n),
                            {"JACOBIAN", header_positions(h, LIST(u->constraints.jacobian))},
                            header_number(h, "NJACOBIAN", u->constraints.jacobian.n),
                            {NULL, NULL}};
    header_template(h, u->constraints.of.n ? solve_constrained : solve_mass, w);
  }
  if (parts & (PART_JAC | PART_LINEAR)) define_by(h, u->linear, "state", LIST(u->linear_dr), ny);
  if (parts & PART_LINEAR && u->u.n) define_by(h, u->by_inputs, "inputs", LIST(u->by_inputs_dr), "LAG_NU");
  if (parts & PART_PARAMS) define_by(h, u->by_params, "params", LIST(u->by_params_dr), "LAG_NP");
  if (parts & PART_JAC) {
    Words w = words_of(h, "state", LIST(u->linear_dr), ny);
    header_begin(h, FN_JAC), write_marked(h, jac_body, NULL);
    header_begin(h, FN_JVP), write_marked(h, products, w.at), write_marked(h, jvp_body, w.at);
    header_begin(h, FN_VJP), write_marked(h, products, w.at), write_marked(h, vjp_body, w.at);
  }
  if (parts & PART_LINEAR) header_begin(h, FN_LINEARIZE), write_marked(h, linearize_body, NULL);
  if (parts & PART_PARAMS)
    header_begin(h, FN_DPARAMS), header_template(h, " | {\n |  return lag_by_params(ARGS, P);\n |}\n", NULL);
}

/* --- matrices, constraints --- */

/* A function that zeroes out[size] and fills it by an internal one around p. */
static void filled(const Header *h, const Prog *p, HeaderFn f, const char *name, const char *out, const char *size) {
  header_internal_function(h, p, arena_printf(h->a, "fill_%s", name), NULL, arena_printf(h->a, "LAG_REAL *%s", out),
                           NULL);
  header_begin(h, f);
  const HeaderWord w[] = {{"SIZE", size}, {"NAME", name}, {"OUT", out}, {NULL, NULL}};
  header_template(
      h, " | {\n |  for (int i = 0; i < SIZE; i++) OUT[i] = LAG_C(0.0);\n |  return lag_fill_NAME(ARGS, OUT);\n |}\n",
      w);
}

static void constraints(const Header *h) {
  const IrConstraints *k = &h->u->constraints;
  header_begin(h, FN_CONSTRAINTS), header_template(h, " | {\n |  return lag_residuals(ARGS, c, r);\n |}\n", NULL);
  header_internal_function(h, k->matrices, "matrices", NULL, "LAG_REAL *d, LAG_REAL *m", NULL);
  const HeaderWord w[] = {{"ENTRIES", header_positions(h, LIST(k->jacobian))},
                          header_number(h, "NENTRIES", k->jacobian.n),
                          header_number(h, "NMASS", k->mass.n ? k->mass.n : 1),
                          {NULL, NULL}};
  header_begin(h, FN_CONSTRAINT_JACOBIAN);
  header_template(h, constraint_jacobian, w);
}

/* --- events --- */

/* Dense output of the steps that a path is along: rk4 for _step_until_event, in FMUs moreau or dop853. */
static const struct {
  const char *kernel, *members, *first, *last, *within;
} dense_outputs[] = {
  {"hermite", "f[2][LAG_NY]", "a->f[0]", "a->f[1]", "lag_hermite_within(&a->ends, LAG_NQ, LAG_NZ, x/h, y)"},
  {"parabola", "f[LAG_NY], struck", "a->f", "a->f",
   "lag_parabola_within(&a->ends, a->struck > zero, LAG_NQ, LAG_NZ, x, y)"},
  {"contd8", "k[16][LAG_NY], high[4*LAG_NY]", "a->k[0]", "a->k[12]",
   "lag_contd8(&a->ends, a->high, LAG_NY, LAG_NY, x/h, y)"},
};

static void define_path(const Header *h) {
  int of = header_has(h, FN_UNTIL_EVENT) ? 0 : header_has_method(h, "moreau") ? 1 : 2;
  StrBuf d = strbuf(h->a);
  for (uint32_t i = 0; i < h->u->events.n; i++) sb_printf(&d, "%s%d", i ? ", " : "", h->u->events.at[i].direction);
  const char *now = h->u->u.n ? ", lag_held(a->p, a->at.t, a->u, a->input, a->context, a->now)" : "";
  const HeaderWord w[] = {{"DIRECTIONS", sb_text(&d)}, {"AFTER", header_state_args(h, 0, "end->")}, {"NOW_AT", now},
                          {"MEMBERS", dense_outputs[of].members}, {"WITHIN", dense_outputs[of].within},
                          {"OF_PATH", h->u->u.n ? ", a->u" : ""}, {"FIRST", dense_outputs[of].first},
                          {"LAST", dense_outputs[of].last}, {NULL, NULL}};
  header_sections(h, arena_printf(h->a, "ends, %s, root, locate", dense_outputs[of].kernel));
  if (h->parts.parts & PART_PATH) header_section(h, "series");
  const LineChoice choices[] = {{'s', header_has(h, FN_UNTIL_EVENT)}, {0, 0}};
  write_marked(h, header_chosen(h, step_path, choices), w);
}

static void events(const Header *h) {
  const HeaderWord w[] = {{"WITH", h->u->u.n ? ", u" : ""}, {"INPUTS", h->u->u.n ? ", u, 0, 0" : ""}, {NULL, NULL}};
  header_printf(h, "\n#if !defined(LAG_LANES) && !defined(LAG_COMPLEX)\n");
  define_path(h);
  if (header_has(h, FN_UNTIL_EVENT)) header_begin(h, FN_UNTIL_EVENT), header_template(h, until_event_body, w);
  sb_puts(h->out, "#endif\n");
}

/* --- names --- */

static void name_rows(const Header *h, const char *of, const IrVar *v, uint32_t n) {
  static const char *const least[] = {"-HUGE_VAL", "0"}, *const most[] = {"HUGE_VAL", "0"};
  if (!n) return;
  header_printf(h, "static const lag_name lag_names_%s[] = {\n", of);
  for (uint32_t i = 0; i < n; i++)
    sb_printf(h->out, "  {%s, %s, %s, %s, %s, %s}%s\n", c_string(h->a, v[i].name), c_string(h->a, v[i].unit->text),
              shortest_double(h->a, v[i].unit->factor), shortest_double(h->a, v[i].unit->offset), least[v[i].sign > 0],
              most[v[i].sign < 0], i + 1 < n ? "," : "");
  sb_puts(h->out, "};\n");
}

void header_name_tables(const Header *h) {
  const ProgramSet *u = h->u;
  if (!(h->parts.parts & PART_NAMES)) return;
  header_printf(h, "\n#ifdef LAG_WITH_NAMES\n#include <math.h>\n");
  header_printf(h, "/* A name, its unit, the size of the unit in SI (value = factor*number + offset), and bounds of "
                   "the value in SI. */\ntypedef struct lag_name {\n  const char *name, *unit;\n  double factor, "
                   "offset, least, most;\n} lag_name;\n");
  name_rows(h, "q", u->q.at, u->q.n);
  name_rows(h, "z", u->z.at, u->z.n);
  name_rows(h, "p", u->p.at, u->p.n);
  name_rows(h, "u", u->u.at, u->u.n);
  name_rows(h, "out", h->scene->plain.at, h->scene->plain.n);
  sb_puts(h->out, "#endif\n");
}

void header_dynamics_define(const Header *h) {
  const ProgramSet *u = h->u;
  const HeaderWord inputs[] = {{"INPUTS", u->u.n ? ", u, 0, 0" : ""}, {NULL, NULL}};
  if (header_has(h, FN_MASS)) {
    filled(h, u->mass, FN_MASS, "mass", "M", "LAG_NQ*LAG_NQ");
    header_api_function(h, u->bias, FN_BIAS);
  }
  if (header_has(h, FN_RHS))
    header_begin(h, FN_RHS), header_template(h, " | {\n |  return lag_rates(p, t, yINPUTS, dydt);\n |}\n", inputs);
  header_api_function(h, u->inverse, FN_INVERSE);
  header_api_function(h, u->multipliers, FN_MULTIPLIERS);
  derivatives(h);
  header_outputs_define(h);
  if (header_has(h, FN_CONSTRAINTS)) constraints(h);
  if (header_has(h, FN_UNTIL_EVENT) || h->parts.parts & PART_PATH) events(h);
  header_callbacks_define(h);
}
