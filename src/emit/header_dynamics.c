/* Parts of an emitted header that `--with` asks for: matrices, inverse dynamics, derivatives, constraints, events,
 * names. */
#include <string.h>

#include "emit/header_impl.h"

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
  if (part & PART_ADJOINT && !u->adjoint) return "no constraints: their steps have no reverse mode yet";
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

/* The elimination, for all columns at once, is that of _solve. */
static const char *const solve_mass =
    " |\n"
    " |/* M X = B for the matrix with entries m: B[NQ*columns] becomes X. Gaussian elimination with partial pivoting. "
    "*/\n"
    " |static int lag_solve_mass(const LAG_REAL *m, int columns, LAG_REAL *B) {\n"
    " |  static const unsigned short at[][2] = {ENTRIES};\n"
    " |  LAG_REAL M[LAG_NQ*LAG_NQ];\n"
    " |  LAG_PIVOTS;\n"
    " |  for (int i = 0; i < LAG_NQ*LAG_NQ; i++) M[i] = LAG_C(0.0);\n"
    " |  for (int k = 0; k < NENTRIES; k++) {\n"
    " |    M[at[k][0]*LAG_NQ + at[k][1]] = m[k];\n"
    " |    M[at[k][1]*LAG_NQ + at[k][0]] = m[k];\n"
    " |  }\n"
    " |  for (int k = 0; k < LAG_NQ; k++) {\n"
    " |    for (int i = k + 1; i < LAG_NQ; i++) {\n"
    " |      const LAG_MASK larger = LAG_FN(fabs)(M[i*LAG_NQ + k]) > LAG_FN(fabs)(M[k*LAG_NQ + k]);\n"
    " |      for (int j = k; j < LAG_NQ + columns && LAG_ANY(larger); j++) {\n"
    " |        LAG_REAL *const upper = j < LAG_NQ ? &M[k*LAG_NQ + j] : &B[k*columns + j - LAG_NQ];\n"
    " |        LAG_REAL *const lower = j < LAG_NQ ? &M[i*LAG_NQ + j] : &B[i*columns + j - LAG_NQ];\n"
    " |        const LAG_REAL was = *upper;\n"
    " |        *upper = LAG_SELECT(larger, *lower, was);\n"
    " |        *lower = LAG_SELECT(larger, was, *lower);\n"
    " |      }\n"
    " |    }\n"
    " |    LAG_PIVOT(LAG_FN(fabs)(M[k*LAG_NQ + k]) > LAG_C(0.0));\n"
    " |    for (int i = k + 1; i < LAG_NQ; i++) {\n"
    " |      const LAG_REAL factor = M[i*LAG_NQ + k]/M[k*LAG_NQ + k];\n"
    " |      for (int j = k + 1; j < LAG_NQ; j++) M[i*LAG_NQ + j] -= factor*M[k*LAG_NQ + j];\n"
    " |      for (int j = 0; j < columns; j++) B[i*columns + j] -= factor*B[k*columns + j];\n"
    " |    }\n"
    " |  }\n"
    " |  for (int k = LAG_NQ - 1; k >= 0; k--)\n"
    " |    for (int j = 0; j < columns; j++) {\n"
    " |      for (int i = k + 1; i < LAG_NQ; i++) B[k*columns + j] -= M[k*LAG_NQ + i]*B[i*columns + j];\n"
    " |      B[k*columns + j] /= M[k*LAG_NQ + k];\n"
    " |    }\n"
    " |  return LAG_PIVOTS_STATUS;\n"
    " |}\n";

/* The same with constraints, column by column: the elimination destroys its matrices. */
static const char *const solve_constrained =
    " |\n"
    " |/* M X - A^T L = B, A X = G for the matrices with entries m and A: B[NQ*columns] becomes X, G[NC*columns] "
    "becomes L. */\n"
    " |static int lag_solve_mass(const LAG_REAL *m, const LAG_REAL *A, int columns, LAG_REAL *B, LAG_REAL *G) {\n"
    " |  static const unsigned short at[][2] = {ENTRIES}, of[][2] = {JACOBIAN};\n"
    " |  LAG_REAL w[2*LAG_NQ*LAG_NQ + 2*LAG_NQ*LAG_NC + LAG_NC*LAG_NC + 3*LAG_NQ + 10*LAG_NC];\n"
    " |  LAG_REAL *const a = w + LAG_NQ*LAG_NQ, *const x = a + LAG_NC*LAG_NQ, *const l = x + LAG_NQ;\n"
    " |  LAG_PIVOTS;\n"
    " |  for (int j = 0; j < columns; j++) {\n"
    " |    for (int i = 0; i < LAG_NQ*(LAG_NQ + LAG_NC); i++) w[i] = LAG_C(0.0);\n"
    " |    for (int k = 0; k < NENTRIES; k++) w[at[k][0]*LAG_NQ + at[k][1]] = m[k];\n"
    " |    for (int k = 0; k < NENTRIES; k++) w[at[k][1]*LAG_NQ + at[k][0]] = m[k];\n"
    " |    for (int k = 0; k < NJACOBIAN; k++) a[of[k][0]*LAG_NQ + of[k][1]] = A[k];\n"
    " |    for (int i = 0; i < LAG_NQ; i++) x[i] = B[i*columns + j];\n"
    " |    for (int k = 0; k < LAG_NC; k++) l[k] = G[k*columns + j];\n"
    " |    LAG_PIVOT(lag_kkt(LAG_NQ, LAG_NC, 0, w));\n"
    " |    for (int i = 0; i < LAG_NQ; i++) B[i*columns + j] = x[i];\n"
    " |    for (int k = 0; k < LAG_NC; k++) G[k*columns + j] = l[k];\n"
    " |  }\n"
    " |  return LAG_PIVOTS_STATUS;\n"
    " |}\n";

/* PARTIALS_by: one column a variable; out[NY*columns] := derivatives of the rates. */
static const char *const by =
  " |\n"
  " |static const unsigned short lag_by_NAME_at[][2] = {ENTRIES};\n"
  " |static int lag_by_NAME(STATE, LAG_REAL *out) {\n"
  "q|  LAG_REAL a[LAG_NQ], m[NMASS];\n"
  "c|  LAG_REAL lambda[LAG_NC], A[NJACOBIAN], G[LAG_NC*COLUMNS];\n"
  "b|  LAG_REAL zd[LAG_NZ];\n"
  " |  LAG_REAL d[NALL];\n"
  "q|  int status = lag_accel(ARGSRATES);\n"
  "c|  if (status == LAG_OK) status = lag_multipliers(ARGS, lambda);\n"
  "q|  if (status != LAG_OK) return status;\n"
  " |  lag_partials_NAME(ARGSWITH, dOUT);\n"
  " |  for (int i = 0; i < LAG_NY*COLUMNS; i++) out[i] = LAG_C(0.0);\n"
  "c|  for (int i = 0; i < LAG_NC*COLUMNS; i++) G[i] = LAG_C(0.0);\n"
  " |  for (int k = 0; k < NENTRIES; k++) {\n"
  " |    const int row = lag_by_NAME_at[k][0], col = lag_by_NAME_at[k][1];\n"
  "c|    if (row >= LAG_NQ + LAG_NZ) G[(row - LAG_NQ - LAG_NZ)*COLUMNS + col] = d[k];\n"
  "c|    else\n"
  " |    out[(LAG_NQ + row)*COLUMNS + col] = d[k];\n"
  " |  }\n"
  "o|  return lag_solve_mass(m, COLUMNS, out + LAG_NQ*COLUMNS);\n"
  "c|  return lag_solve_mass(m, A, COLUMNS, out + LAG_NQ*COLUMNS, G);\n"
  "f|  return LAG_OK;\n"
  " |}\n";

static const char *const jac_body =
  " | {\n"
  " |  const int status = lag_by_state(ARGS, J);\n"
  "q|  for (int i = 0; i < LAG_NQ; i++) J[i*LAG_NY + LAG_NQ + i] = LAG_C(1.0);\n"
  " |  return status;\n"
  " |}\n";

static const char *const linearize_body =
  " | {\n"
  " |  const int status = lag_by_state(ARGS, A);\n"
  "q|  for (int i = 0; i < LAG_NQ; i++) A[i*LAG_NY + LAG_NQ + i] = LAG_C(1.0);\n"
  "u|  if (status != LAG_OK) return status;\n"
  "u|  return lag_by_inputs(ARGS, B);\n"
  "n|  return status;\n"
  " |}\n";

static const char *const products =
  " | {\n"
  "q|  LAG_REAL a[LAG_NQ], m[NMASS], w[LAG_NQ];\n"
  "c|  LAG_REAL lambda[LAG_NC], A[NJACOBIAN], G[LAG_NC];\n"
  "b|  LAG_REAL zd[LAG_NZ];\n"
  " |  LAG_REAL d[NALL];\n"
  "q|  int status = lag_accel(ARGSRATES);\n"
  "c|  if (status == LAG_OK) status = lag_multipliers(ARGS, lambda);\n"
  "q|  if (status != LAG_OK) return status;\n"
  " |  lag_partials_state(ARGSWITH, dOUT);\n";

static const char *const jvp_body =
  " |  for (int i = 0; i < LAG_NY; i++) out[i] = LAG_C(0.0);\n"
  "c|  for (int k = 0; k < LAG_NC; k++) G[k] = LAG_C(0.0);\n"
  "q|  for (int i = 0; i < LAG_NQ; i++) w[i] = LAG_C(0.0);\n"
  " |  for (int k = 0; k < NENTRIES; k++) {\n"
  " |    const int row = lag_by_state_at[k][0], col = lag_by_state_at[k][1];\n"
  "q|    if (row < LAG_NQ) w[row] += d[k]*x[col];\n"
  "c|    else if (row >= LAG_NQ + LAG_NZ) G[row - LAG_NQ - LAG_NZ] += d[k]*x[col];\n"
  "q|    else out[LAG_NQ + row] += d[k]*x[col];\n"
  "f|    out[row] += d[k]*x[col];\n"
  " |  }\n"
  "o|  status = lag_solve_mass(m, 1, w);\n"
  "c|  status = lag_solve_mass(m, A, 1, w, G);\n"
  "q|  for (int i = 0; i < LAG_NQ; i++) {\n"
  "q|    out[i] = x[LAG_NQ + i];\n"
  "q|    out[LAG_NQ + i] = w[i];\n"
  "q|  }\n"
  "q|  return status;\n"
  "f|  return LAG_OK;\n"
  " |}\n";

static const char *const vjp_body =
  " |  for (int i = 0; i < LAG_NY; i++) out[i] = LAG_C(0.0);\n"
  "q|  for (int i = 0; i < LAG_NQ; i++) w[i] = x[LAG_NQ + i];\n"
  "c|  for (int k = 0; k < LAG_NC; k++) G[k] = LAG_C(0.0);\n"
  "o|  status = lag_solve_mass(m, 1, w);\n"
  "c|  status = lag_solve_mass(m, A, 1, w, G); /* the transposed system has -G */\n"
  "q|  for (int i = 0; i < LAG_NQ; i++) out[LAG_NQ + i] = x[i];\n"
  " |  for (int k = 0; k < NENTRIES; k++) {\n"
  " |    const int row = lag_by_state_at[k][0], col = lag_by_state_at[k][1];\n"
  "c|    if (row >= LAG_NQ + LAG_NZ) out[col] -= d[k]*G[row - LAG_NQ - LAG_NZ];\n"
  "c|    else\n"
  "q|    out[col] += d[k]*(row < LAG_NQ ? w[row] : x[LAG_NQ + row]);\n"
  "f|    out[col] += d[k]*x[row];\n"
  " |  }\n"
  "q|  return status;\n"
  "f|  return LAG_OK;\n"
  " |}\n";

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
  static const char *const all[] = {"a", "d", "m", NULL}, *const states[] = {"d", NULL}, *const out[] = {"d", "m", "A"},
                           *const constrained[] = {"a", "g", "d", "m", "A", NULL};
  const char *R = h->upper,
             *q = h->u->constraints.of.n
                      ? arena_printf(h->a, ", const %s_REAL *a, const %s_REAL *g, %s_REAL *d, %s_REAL *m, %s_REAL *A",
                                     R, R, R, R, R)
                  : h->u->q.n ? arena_printf(h->a, ", const %s_REAL *a, %s_REAL *d, %s_REAL *m", R, R, R)
                              : arena_printf(h->a, ", %s_REAL *d", R);
  const char *head =
      arena_printf(h->a, "static void %s_partials_%s(%s%s)", h->lower, name, header_state_args(h, 1, ""), q);
  header_state_function(h, p, NULL, header_wrapped(h, head),
                        h->u->constraints.of.n ? constrained
                        : h->u->q.n            ? all
                                               : states,
                        out, 0);
  Words w = words_of(h, name, at, n, columns);
  write_marked(h, by, w.at);
}

static void derivatives(const Header *h) {
  const ProgramSet *u = h->u;
  const char *ny = arena_printf(h->a, "%s_NY", h->upper), *nu = arena_printf(h->a, "%s_NU", h->upper),
             *np = arena_printf(h->a, "%s_NP", h->upper);
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
  if (parts & PART_LINEAR && u->u.n) define_by(h, u->by_inputs, "inputs", LIST(u->by_inputs_dr), nu);
  if (parts & PART_PARAMS) define_by(h, u->by_params, "params", LIST(u->by_params_dr), np);
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
  const char *const own[] = {out, NULL};
  const char *head = arena_printf(h->a, "static int %s_fill_%s(%s, %s_REAL *%s)", h->lower, name,
                                  header_state_args(h, 1, ""), h->upper, out);
  header_state_function(h, p, NULL, header_wrapped(h, head), own, own, 1);
  header_begin(h, f);
  const HeaderWord w[] = {{"SIZE", size}, {"NAME", name}, {"OUT", out}, {NULL, NULL}};
  header_template(
      h, " | {\n |  for (int i = 0; i < SIZE; i++) OUT[i] = LAG_C(0.0);\n |  return lag_fill_NAME(ARGS, OUT);\n |}\n",
      w);
}

static void constraints(const Header *h) {
  const IrConstraints *k = &h->u->constraints;
  header_begin(h, FN_CONSTRAINTS), header_template(h, " | {\n |  return lag_residuals(ARGS, c, r);\n |}\n", NULL);
  const char *head = arena_printf(h->a, "static int %s_matrices(%s, %s_REAL *d, %s_REAL *m)", h->lower,
                                  header_state_args(h, 1, ""), h->upper, h->upper);
  static const char *const out[] = {"d", "m", NULL};
  header_state_function(h, k->matrices, NULL, header_wrapped(h, head), out, out, 1);
  const HeaderWord w[] = {{"ENTRIES", header_positions(h, LIST(k->jacobian))},
                          header_number(h, "NENTRIES", k->jacobian.n),
                          header_number(h, "NMASS", k->mass.n ? k->mass.n : 1),
                          {NULL, NULL}};
  header_begin(h, FN_CONSTRAINT_JACOBIAN);
  header_template(h,
    " | {\n"
    " |  static const unsigned short at[][2] = {ENTRIES};\n"
    " |  LAG_REAL d[NENTRIES + 1], m[NMASS];\n"
    " |  const int status = lag_matrices(ARGS, d, m);\n"
    " |  for (int i = 0; i < LAG_NC*LAG_NQ; i++) A[i] = LAG_C(0.0);\n"
    " |  for (int k = 0; k < NENTRIES; k++) A[at[k][0]*LAG_NQ + at[k][1]] = d[k];\n"
    " |  return status;\n"
    " |}\n", w);
}

/* --- events --- */

/* A step with its dense output, and its event functions along it. Lines marked s are for _step_until_event. */
static const char *const step_path =
    " |\n"
    " |/* A step from *from to *to; at: a state between. */\n"
    " |typedef struct lag_path {\n"
    " |  const lag_params *p;\n"
    " |  const lag_state *from, *to;\n"
    "u|  const LAG_REAL *u; /* inputs: these, or those of the model and of the caller */\n"
    "u|  lag_input_fn *input;\n"
    "u|  void *context;\n"
    "u|  LAG_REAL now[LAG_NU];\n"
    " |  LAG_REAL y[2][LAG_NY], MEMBERS;\n"
    " |  lag_step_ends ends;\n"
    " |  lag_state at;\n"
    "s|  int stepped; /* states are ends of steps of that length, not dense output */\n"
    " |} lag_path;\n"
    " |\n"
    " |static void lag_path_begin(lag_path *a, const lag_params *p, const lag_state *from, const lag_state *to,\n"
    " |    LAG_REAL h) {\n"
    " |  a->p = p, a->from = from, a->to = to;\n"
    " |  lag_gather(from, a->y[0]);\n"
    " |  lag_gather(to, a->y[1]);\n"
    " |  a->ends.h = h, a->ends.y0 = a->y[0], a->ends.y1 = a->y[1];\n"
    " |  a->ends.f0 = FIRST, a->ends.f1 = LAST;\n"
    " |}\n"
    " |\n"
    " |/* a->at := the state x after the begin of the step; shaken: with its last digits changed. */\n"
    " |static int lag_path_at(lag_path *a, int shaken, LAG_REAL x) {\n"
    " |  const LAG_REAL zero = LAG_C(0.0), h = a->ends.h;\n"
    " |  const int begins = !(x < zero) && !(x > zero);\n"
    " |  LAG_REAL y[LAG_NY];\n"
    "s|  a->at = *a->from;\n"
    "s|  if (a->stepped) return lag_rk4_step(a->p, &a->at, xOF_PATH);\n"
    " |  a->at = begins ? *a->from : *a->to;\n"
    " |  if (!begins && (x < h || x > h)) {\n"
    " |    WITHIN;\n"
    " |    lag_scatter(y, &a->at);\n"
    " |    for (int i = 1; i <= LAG_NY; i++) a->at.lost[i] = zero;\n"
    " |    a->at.lost[0] = a->from->lost[0];\n"
    " |    a->at.t = lag_compensated_sum(a->from->t, x, &a->at.lost[0]);\n"
    "c|    const int status = lag_onto(a->p, &a->atNOW_AT, 0);\n"
    "c|    if (status != LAG_OK) return status;\n"
    " |  }\n"
    " |  if (!shaken) return LAG_OK;\n"
    " |  const LAG_REAL last = LAG_C(4.0)*lag_epsilon();\n"
    " |  lag_gather(&a->at, y);\n"
    " |  for (int i = 0; i < LAG_NY; i++)\n"
    " |    y[i] += LAG_SELECT(i % 2, -last, last)*(LAG_FN(fabs)(y[i]) + LAG_FN(fabs)(y[i] - a->y[0][i]));\n"
    " |  lag_scatter(y, &a->at);\n"
    " |  a->at.t *= LAG_C(1.0) + last;\n"
    " |  return LAG_OK;\n"
    " |}\n"
    " |\n"
    " |static int lag_path_events(void *context, int shaken, LAG_REAL x, LAG_REAL *g) {\n"
    " |  lag_path *const a = (lag_path *)context;\n"
    " |  const lag_params *const p = a->p;\n"
    " |  const lag_state *const end = &a->at;\n"
    " |  int status = lag_path_at(a, shaken, x);\n"
    "u|  const LAG_REAL *const u = lag_held(p, end->t, a->u, a->input, a->context, a->now);\n"
    " |  if (status == LAG_OK) status = lag_events(AFTER, g);\n"
    " |  for (int k = 0; k < LAG_NEV && status == LAG_OK; k++)\n"
    " |    if (!(g[k] - g[k] >= LAG_C(0.0))) status = LAG_ENAN;\n"
    " |  return status;\n"
    " |}\n"
    " |\n"
    " |static int lag_event_direction(void *context, int k) {\n"
    " |  static const signed char direction[] = {DIRECTIONS};\n"
    " |  (void)context;\n"
    " |  return direction[k];\n"
    " |}\n"
    "s|\n"
    "s|/* Finds event k by steps, in place of dense output, which is off by more; a->stepped: they show it, near its "
    "root. */\n"
    "s|static int lag_step_to_root(const lag_locator *l, lag_path *a, int k) {\n"
    "s|  const LAG_REAL h = a->ends.h, x = l->root[k], half = LAG_C(0.5);\n"
    "s|  const LAG_REAL *const g[] = {l->value, l->value + LAG_NEV};\n"
    "s|  LAG_REAL d = h*LAG_C(9.5367431640625e-07);\n"
    "s|  int found = 0, status = LAG_OK;\n"
    "s|  a->stepped = 1;\n"
    "s|  for (int i = 0; i < 7 && status == LAG_OK && !found; i++, d *= LAG_C(8.0)) {\n"
    "s|    const LAG_REAL t[] = {LAG_SELECT(d/x < half, x - d, half*x), LAG_SELECT((x + d)/h < LAG_C(1.0), x + d, "
    "h)};\n"
    "s|    status = lag_path_events(a, 0, t[0], l->value);\n"
    "s|    if (status == LAG_OK) status = lag_path_events(a, 0, t[1], l->value + LAG_NEV);\n"
    "s|    if (status == LAG_OK && g[0][k]*l->sign[k] < LAG_C(0.0) && g[1][k]*l->sign[k] > LAG_C(0.0))\n"
    "s|      status = lag_find_crossing(l, k, LAG_C(0.0), t, g, &found);\n"
    "s|  }\n"
    "s|  a->stepped = found;\n"
    "s|  return status;\n"
    "s|}\n";

/* Where a state is fresh, from _start or _act, an event may have just fired: its function leaves 0 at
 * once, and its sign is not known before. */
static const char *const until_event_body =
  " | {\n"
  " |  const LAG_REAL zero = LAG_C(0.0), epsilon = lag_epsilon(), together = LAG_C(4.0)*epsilon*LAG_FN(fabs)(h);\n"
  " |  const LAG_REAL none = LAG_C(2.0)*LAG_FN(fabs)(h);\n"
  " |  LAG_REAL value[(int)LAG_LOCATE_ROWS*LAG_NEV], sign[LAG_NEV], noise[LAG_NEV], root[LAG_NEV], first = none;\n"
  " |  lag_state end = *s;\n"
  " |  lag_path path;\n"
  " |  const lag_locator l = {LAG_NEV, lag_path_events, lag_event_direction, &path, epsilon,\n"
  " |                         LAG_C(1.3877787807814457e-17), sign, noise, root, value}; /* 2^-56 */\n"
  " |  int by_steps[LAG_NEV], fresh = 1, found = 0, status = LAG_OK;\n"
  " |  *event = -1;\n"
  "u|  path.u = u, path.input = 0, path.context = 0;\n"
  " |  path.stepped = 0;\n"
  " |  if (h < zero || h > zero) status = lag_rk4_step(p, &end, hWITH);\n"
  " |  lag_path_begin(&path, p, s, &end, h);\n"
  " |  if (status == LAG_OK) status = lag_rates(p, s->t, path.y[0]INPUTS, path.f[0]);\n"
  " |  if (status == LAG_OK) status = lag_rates(p, end.t, path.y[1]INPUTS, path.f[1]);\n"
  " |  for (int i = 0; i <= LAG_NY; i++)\n"
  " |    if (s->lost[i] < zero || s->lost[i] > zero) fresh = 0;\n"
  " |  if (status == LAG_OK) status = lag_path_events(&path, 0, zero, value);\n"
  " |  if (status == LAG_OK && fresh)\n"
  " |    status = lag_path_events(&path, 0, h*LAG_C(2.3283064365386963e-10), value + LAG_NEV); /* 2^-32 */\n"
  " |  for (int k = 0; k < LAG_NEV && status == LAG_OK; k++) {\n"
  " |    noise[k] = LAG_C(2.0)*LAG_FN(fabs)(value[k]);\n"
  " |    sign[k] = lag_locate_sign(value[fresh ? LAG_NEV + k : k]);\n"
  " |    if (fresh && LAG_FN(fabs)(value[LAG_NEV + k]) > noise[k]) sign[k] = zero;\n"
  " |    root[k] = none;\n"
  " |  }\n"
  " |  if (status == LAG_OK) status = lag_locate(&l, zero, h, &found);\n"
  " |  for (int k = 0; k < LAG_NEV && found && status == LAG_OK; k++) {\n"
  " |    if (!(LAG_FN(fabs)(root[k]) < none)) continue;\n"
  " |    status = lag_step_to_root(&l, &path, k);\n"
  " |    by_steps[k] = path.stepped;\n"
  " |    if (LAG_FN(fabs)(root[k]) < first) first = LAG_FN(fabs)(root[k]);\n"
  " |  }\n"
  " |  for (int k = LAG_NEV - 1; k >= 0 && found; k--)\n"
  " |    if (LAG_FN(fabs)(root[k]) <= first + together) *event = k;\n"
  " |  if (status == LAG_OK && found) path.stepped = by_steps[*event], status = lag_path_at(&path, 0, root[*event]);\n"
  " |  if (status != LAG_OK) return status;\n"
  " |  if (found) end = path.at;\n"
  " |  if (found && fresh && !(end.t < s->t) && !(end.t > s->t)) return LAG_EZENO;\n"
  " |  *s = end;\n"
  " |  return LAG_OK;\n"
  " |}\n";

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
  const char *const kernels[] = {"ends", dense_outputs[of].kernel, "root", "locate"};
  StrBuf d = strbuf(h->a);
  for (uint32_t i = 0; i < h->u->events.n; i++) sb_printf(&d, "%s%d", i ? ", " : "", h->u->events.at[i].direction);
  const char *now = h->u->u.n ? ", lag_held(a->p, a->at.t, a->u, a->input, a->context, a->now)" : "";
  const HeaderWord w[] = {{"DIRECTIONS", sb_text(&d)}, {"AFTER", header_state_args(h, 0, "end->")}, {"NOW_AT", now},
                          {"MEMBERS", dense_outputs[of].members}, {"WITHIN", dense_outputs[of].within},
                          {"OF_PATH", h->u->u.n ? ", a->u" : ""}, {"FIRST", dense_outputs[of].first},
                          {"LAST", dense_outputs[of].last}, {NULL, NULL}};
  for (size_t i = 0; i < sizeof kernels / sizeof *kernels; i++)
    header_section(h, kernels[i]);
  const LineChoice choices[] = {{'s', header_has(h, FN_UNTIL_EVENT)}, {0, 0}};
  write_marked(h, header_chosen(h, step_path, choices), w);
}

static void events(const Header *h) {
  const HeaderWord w[] = {{"WITH", h->u->u.n ? ", u" : ""}, {"INPUTS", h->u->u.n ? ", u, 0, 0" : ""}, {NULL, NULL}};
  sb_printf(h->out, "\n#if !defined(%s_LANES) && !defined(%s_COMPLEX)\n", h->upper, h->upper);
  define_path(h);
  if (header_has(h, FN_UNTIL_EVENT)) header_begin(h, FN_UNTIL_EVENT), header_template(h, until_event_body, w);
  sb_puts(h->out, "#endif\n");
}

/* --- names --- */

static void name_rows(const Header *h, const char *of, const IrVar *v, uint32_t n) {
  static const char *const least[] = {"-HUGE_VAL", "0"}, *const most[] = {"HUGE_VAL", "0"};
  if (!n) return;
  sb_printf(h->out, "static const %s_name %s_names_%s[] = {\n", h->lower, h->lower, of);
  for (uint32_t i = 0; i < n; i++)
    sb_printf(h->out, "  {%s, %s, %s, %s, %s, %s}%s\n", c_string(h->a, v[i].name), c_string(h->a, v[i].unit),
              shortest_double(h->a, v[i].factor), shortest_double(h->a, v[i].offset), least[v[i].sign > 0],
              most[v[i].sign < 0], i + 1 < n ? "," : "");
  sb_puts(h->out, "};\n");
}

void header_name_tables(const Header *h) {
  const ProgramSet *u = h->u;
  if (!(h->parts.parts & PART_NAMES)) return;
  sb_printf(h->out, "\n#ifdef %s_WITH_NAMES\n#include <math.h>\n", h->upper);
  sb_printf(h->out,
            "/* A name, its unit, the size of the unit in SI (value = factor*number + offset), and bounds of the value "
            "in SI. */\n"
            "typedef struct %s_name {\n  const char *name, *unit;\n  double factor, offset, least, most;\n} %s_name;\n",
            h->lower, h->lower);
  name_rows(h, "q", u->q.at, u->q.n);
  name_rows(h, "z", u->z.at, u->z.n);
  name_rows(h, "p", u->p.at, u->p.n);
  name_rows(h, "u", u->u.at, u->u.n);
  name_rows(h, "out", h->scene->plain.at, h->scene->plain.n);
  sb_puts(h->out, "#endif\n");
}

void header_dynamics_define(const Header *h) {
  static const char *const b[] = {"b", NULL}, *const force[] = {"a", "force", NULL}, *const out[] = {"force"},
                           *const lambda[] = {"lambda", NULL};
  const ProgramSet *u = h->u;
  const HeaderWord inputs[] = {{"INPUTS", u->u.n ? ", u, 0, 0" : ""}, {NULL, NULL}};
  if (header_has(h, FN_MASS)) {
    filled(h, u->mass, FN_MASS, "mass", "M", arena_printf(h->a, "%s_NQ*%s_NQ", h->upper, h->upper));
    header_state_function(h, u->bias, NULL, header_api(h, FN_BIAS), b, b, 1);
  }
  if (header_has(h, FN_RHS))
    header_begin(h, FN_RHS), header_template(h, " | {\n |  return lag_rates(p, t, yINPUTS, dydt);\n |}\n", inputs);
  if (header_has(h, FN_INVERSE)) header_state_function(h, u->inverse, NULL, header_api(h, FN_INVERSE), force, out, 1);
  if (header_has(h, FN_MULTIPLIERS))
    header_state_function(h, u->multipliers, NULL, header_api(h, FN_MULTIPLIERS), lambda, lambda, 1);
  derivatives(h);
  header_outputs_define(h);
  if (header_has(h, FN_CONSTRAINTS)) constraints(h);
  if (header_has(h, FN_UNTIL_EVENT) || h->parts.parts & PART_PATH) events(h);
  header_callbacks_define(h);
}
