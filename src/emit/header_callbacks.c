/* Callbacks of an emitted header for the libraries of `--for`: thin functions around _rhs, _jac and _events, as GSL,
 * SUNDIALS and CasADi call them. */
#include <math.h>
#include <string.h>

#include "base/union_find.h"
#include "emit/header_impl.h"
#include "emit/header_callbacks_text.h"

enum { SUNDIALS = PART_CVODE | PART_ARKODE | PART_IDA, WITH_DATA = SUNDIALS | PART_GSL };

static int has(const Header *h, unsigned part) { return (h->parts.parts & part) != 0; }
static int is_timeless(const Header *h) { return (h->u->flags & 1u << UNIT_TIMELESS) != 0; }
static uint32_t ny(const Header *h) { return 2 * h->u->q.n + h->u->z.n; }

/* --- patterns of matrices --- */

typedef unsigned char Pattern; /* [NY*columns], row by row */

static Pattern *pattern_new(const Header *h, uint32_t columns) {
  return ARENA_ARRAY(h->a, Pattern, (size_t)ny(h) * columns + 1);
}

/* Derivatives of the rates from those of the residuals f - M q'' and of the constraints: the solution fills all rows
 * of a block of M and A. */
static Pattern *rates_pattern(const Header *h, const IrEntry *at, uint32_t n, uint32_t columns) {
  uint32_t nq = h->u->q.n, *block = union_find_new(h->a, nq + 1);
  Pattern *x = pattern_new(h, columns);
  const IrConstraints *c = &h->u->constraints;
  uint32_t m = nq + h->u->z.n, *first = ARENA_ARRAY(h->a, uint32_t, c->of.n + 1); /* a coordinate of each constraint */
  for (uint32_t k = 0; k < h->u->linear_mass.n; k++)
    union_find_join(block, h->u->linear_mass.at[k].row, h->u->linear_mass.at[k].col);
  for (uint32_t k = 0; k < c->jacobian.n; k++) first[c->jacobian.at[k].row] = c->jacobian.at[k].col;
  for (uint32_t k = 0; k < c->jacobian.n; k++)
    union_find_join(block, first[c->jacobian.at[k].row], c->jacobian.at[k].col);
  for (uint32_t k = 0; k < n; k++) {
    if (at[k].row >= nq && at[k].row < m) {
      x[(nq + at[k].row) * columns + at[k].col] = 1;
      continue;
    }
    uint32_t of = at[k].row < nq ? at[k].row : first[at[k].row - m];
    for (uint32_t i = 0; i < nq; i++)
      if (union_find_root(block, i) == union_find_root(block, of)) x[(nq + i) * columns + at[k].col] = 1;
  }
  return x;
}

static Pattern *jac_pattern(const Header *h) {
  Pattern *x = rates_pattern(h, h->u->linear_dr.at, h->u->linear_dr.n, ny(h));
  for (uint32_t i = 0; i < h->u->q.n; i++) x[i * ny(h) + h->u->q.n + i] = 1;
  return x;
}

/* IDA's: residuals by state, and by rates. */
static Pattern *residual_pattern(const Header *h) {
  const ProgramSet *u = h->u;
  uint32_t nq = u->q.n, n = ny(h);
  Pattern *x = u->constraints.of.n ? jac_pattern(h) : pattern_new(h, n);
  for (uint32_t i = 0; i < n && u->constraints.of.n; i++) x[i * n + i] = 1;
  if (u->constraints.of.n) return x;
  for (uint32_t k = 0; k < u->linear_dr.n; k++) x[(nq + u->linear_dr.at[k].row) * n + u->linear_dr.at[k].col] = 1;
  for (uint32_t k = 0; k < u->linear_mass.n; k++) {
    uint32_t i = nq + u->linear_mass.at[k].row, j = nq + u->linear_mass.at[k].col;
    x[i * n + j] = x[j * n + i] = 1;
  }
  for (uint32_t i = 0; i < n; i++) x[i * n + i] = 1;
  for (uint32_t i = 0; i < nq; i++) x[i * n + nq + i] = 1;
  return x;
}

static uint32_t entries(const Header *h, const Pattern *x) {
  uint32_t n = 0;
  for (size_t k = 0; k < (size_t)ny(h) * ny(h); k++) n += x[k];
  return n;
}

/* Compressed columns: where each begins, then the rows. */
static const char *compressed(const Header *h, const Pattern *x, uint32_t columns) {
  uint32_t n = 0;
  StrBuf b = strbuf(h->a), rows = strbuf(h->a);
  sb_puts(&b, "0");
  for (uint32_t j = 0; j < columns; j++) {
    for (uint32_t i = 0; i < ny(h); i++)
      if (x[(size_t)i * columns + j]) sb_printf(&rows, n++ % 24 ? ", %u" : ",\n  %u", i);
    sb_printf(&b, (j + 1) % 24 ? ", %u" : ",\n  %u", n);
  }
  sb_puts(&b, sb_text(&rows));
  return sb_text(&b);
}

/* --- which of them a header has --- */

enum { JAC = 1, EVENTS = 2, TIME = 4, IMPLICIT = 8, PLAIN = 16, LINEAR = 32, ALONE = 64 /* IDA without the others */ };

static unsigned facts_of(const Header *h) {
  int gsl_asks = has(h, PART_GSL) && has(h, PART_JAC) && (!is_timeless(h) || h->u->u.n),
      casadi_asks = has(h, PART_CASADI) && has(h, PART_LINEAR) && !is_timeless(h);
  int implicit = has(h, PART_INVERSE) && !h->u->constraints.of.n;
  return (has(h, PART_JAC) ? JAC : 0u) | (has(h, PART_LINEAR) ? LINEAR : 0u) | (h->u->events.n ? EVENTS : 0u) |
         (gsl_asks || casadi_asks ? TIME : 0u) | (implicit ? IMPLICIT : PLAIN) |
         (has(h, PART_GSL | PART_CVODE | PART_ARKODE) ? 0u : ALONE);
}

/* In order of definition: libraries that call a function, what it needs, the word LIBRARY or FUNCTION, its text, the
 * comment of its declaration. */
static const struct {
  unsigned of, needs;
  const char *name, *text, *doc;
} callbacks[] = {
    {WITH_DATA, 0, "", data, "y[LAG_NY] = (q, v, z) of a state, and back."},
    {PART_GSL | PART_CVODE | PART_ARKODE, JAC, "", jac_of_y, NULL},
    {PART_IDA, JAC | PLAIN | ALONE, "", jac_of_y, NULL},
    {SUNDIALS, EVENTS, "", events_of_y, NULL},
    {SUNDIALS, EVENTS, "", directions,
     "Directions of the events' zeros: 1 rising, -1 falling, 0 both. After a root: lag_from_y, lag_act, lag_to_y, and "
     "a new start."},
    {PART_GSL | PART_CASADI, TIME, "", by_time, NULL},
    {PART_GSL, 0, "", gsl_rhs, NULL},
    {PART_GSL, JAC, "", gsl_jac, NULL},
    {PART_GSL, 0, "", gsl_system, "The system of GSL's drivers, with data d. They end no step at events."},
    {SUNDIALS, JAC, "", store_matrix, NULL},
    {PART_CVODE | PART_ARKODE, JAC, "", jac_pattern_table, NULL},
    {PART_CVODE, 0, "cvode", ode_rhs,
     "For CVODE, with a lag_data as user data. Where the mass matrix is singular, a shorter step is tried."},
    {PART_CVODE, JAC, "cvode", ode_jac, NULL},
    {PART_CVODE, EVENTS, "cvode", ode_root, NULL},
    {PART_ARKODE, 0, "arkode", ode_rhs,
     "For ARKODE, with a lag_data as user data. Where the mass matrix is singular, a shorter step is tried."},
    {PART_ARKODE, JAC, "arkode", ode_jac, NULL},
    {PART_ARKODE, EVENTS, "arkode", ode_root, NULL},
    {PART_IDA, IMPLICIT, "", ida_implicit,
     "For IDA, with a lag_data as user data: the residual q' - v, M q'' + b. The rates of the start are from _rhs."},
    {PART_IDA, PLAIN, "", ida_plain,
     "For IDA, with a lag_data as user data: the residual y' - f(t, y). The rates of the start are from _rhs."},
    {PART_IDA, JAC | IMPLICIT, "", ida_jac, NULL},
    {PART_IDA, JAC | PLAIN, "", ida_plain_jac, NULL},
    {PART_IDA, EVENTS, "", ida_root, NULL},
    {PART_CASADI, 0, "lag_ode", casadi_ode,
     "For CasADi 3.6 and later: xdot(x, u, p, t) with x = (q, v, z), p in the order LAG_P_..., and its Jacobian.\n"
     " *   cc -O2 -shared -fPIC -x c -DLAG_IMPLEMENTATION FILE.h -o FILE.so -lm;  casadi.external(\"lag_ode\", "
     "\"./FILE.so\")"},
    {PART_CASADI, 0, "lag_ode", casadi_facts, NULL},
    {PART_CASADI, LINEAR, "jac_lag_ode", casadi_jac, NULL},
    {PART_CASADI, LINEAR, "jac_lag_ode", casadi_facts, NULL},
};
enum { CALLBACKS = sizeof callbacks / sizeof *callbacks };

static int is_wanted(const Header *h, int i) { return has(h, callbacks[i].of) && !(callbacks[i].needs & ~facts_of(h)); }

/* Prototypes of a text: its lines from LAG_API to the brace. */
static const char *prototypes(const Header *h, const char *text) {
  StrBuf b = strbuf(h->a);
  for (const char *s = text; (s = strstr(s, " |LAG_API ")) != NULL; s++) {
    const char *end = strstr(s, " {");
    sb_putn(&b, s, (size_t)(end - s));
    sb_puts(&b, ";\n");
  }
  return sb_text(&b);
}

const char *header_libraries(const Header *h) {
  return !has(h, WITH_DATA)  ? ""
         : !has(h, SUNDIALS) ? ", GSL's headers"
         : !has(h, PART_GSL) ? ", headers of SUNDIALS"
                             : ", headers of GSL and SUNDIALS";
}

void header_callbacks_include(const Header *h) {
  if (has(h, PART_GSL)) sb_puts(h->out, "#include <gsl/gsl_odeiv2.h>\n");
  if (has(h, SUNDIALS))
    header_printf(h, "#include <sundials/sundials_matrix.h>\n#include <sundials/sundials_nvector.h>\n#include "
                     "<sundials/sundials_types.h>\n"
                     "#include <sunmatrix/sunmatrix_dense.h>\n#include <sunmatrix/sunmatrix_sparse.h>\n"
                     "#ifndef LAG_REAL\n#if defined(SUNDIALS_SINGLE_PRECISION)\n#define LAG_REAL float\n"
                     "#elif defined(SUNDIALS_EXTENDED_PRECISION)\n#define LAG_REAL long double\n#endif\n#endif\n");
  if (has(h, WITH_DATA)) sb_putc(h->out, '\n');
}

void header_callbacks_declare(const Header *h) {
  int sparse = has(h, SUNDIALS) && has(h, PART_JAC);
  const HeaderWord work[] = {{"WORK", sparse ? "  LAG_REAL J[LAG_NY*LAG_NY]; /* work space */\n" : ""}, {NULL, NULL}};
  if (has(h, WITH_DATA)) header_template(h, data_struct, work);
  if (sparse)
    header_printf(h,
                  "\n/* Nonzero entries of Jacobians, of rates and of IDA's residual, for matrices of compressed "
                  "columns (CSC_MAT); dense ones do as well. */\nenum { LAG_NNZ = %u, LAG_NNZ_IDA = %u };\n",
                  entries(h, jac_pattern(h)), entries(h, residual_pattern(h)));
  if (has(h, PART_CASADI))
    sb_puts(h->out, "\n#ifndef casadi_real\n#define casadi_real double\n#endif\n#ifndef casadi_int\n#define casadi_int "
                    "long long int\n#endif\n");
  for (int i = 0; i < CALLBACKS; i++) {
    const HeaderWord w[] = {{"LIBRARY", callbacks[i].name}, {"FUNCTION", callbacks[i].name}, {NULL, NULL}};
    if (!is_wanted(h, i)) continue;
    if (callbacks[i].doc) header_printf(h, "\n/* %s */\n", callbacks[i].doc);
    header_template(h, prototypes(h, callbacks[i].text), w);
  }
}

/* Patterns of Jacobians as text: of rates by state, inputs, parameters and time, and of IDA's residual. */
typedef struct {
  const char *jac, *residual, *inputs, *params, *time;
} Patterns;

static Patterns patterns(const Header *h) {
  const ProgramSet *u = h->u;
  Pattern *time = pattern_new(h, 1);
  if (!has(h, PART_JAC | PART_LINEAR)) return (Patterns){"", "", "", "", ""};
  /* the model is small enough for dense matrices */
  for (uint32_t i = u->q.n; i < ny(h) && !is_timeless(h); i++) time[i] = 1;
  return (Patterns){
      .jac = compressed(h, jac_pattern(h), ny(h)), .residual = compressed(h, residual_pattern(h), ny(h)),
      .inputs = compressed(h, rates_pattern(h, u->by_inputs_dr.at, u->by_inputs_dr.n, u->u.n), u->u.n),
      .params = compressed(h, rates_pattern(h, u->by_params_dr.at, u->by_params_dr.n, u->p.n), u->p.n),
      .time = compressed(h, time, 1)};
}

static const char *directions_of(const ProgramSet *u) {
  StrBuf to = strbuf(u->arena);
  for (uint32_t i = 0; i < u->events.n; i++) sb_printf(&to, "%s%d", i ? ", " : "", u->events.at[i].direction);
  return sb_text(&to);
}

static const char *by_time_of(const Header *h) {
  return arena_printf(h->a, "status == LAG_OK ? lag_by_time(t, y, &d->p%s, dfdt) : status",
                      h->u->u.n ? ", d->u" : "");
}

void header_callbacks_define(const Header *h) {
  const ProgramSet *u = h->u;
  const char *args = header_state_args(h, 0, ""), *ok = "if (status == LAG_OK) status =";
  const char *data_u = u->u.n ? ", ((lag_data *)data)->u" : "", *mass = arena_printf(h->a, "%u", u->linear_mass.n),
             *dr = arena_printf(h->a, "%u", u->linear_dr.n);
  int timeless = is_timeless(h);
  if (!has(h, WITH_DATA | PART_CASADI)) return;
  const Patterns at = patterns(h);
  for (int i = 0; i < CALLBACKS; i++) {
    int jac = callbacks[i].needs & LINEAR;
    const HeaderWord w[] = {
        {"LIBRARY", callbacks[i].name},
        {"FUNCTION", callbacks[i].name},
        {"DIRECTIONS", directions_of(u)},
        {"DATA_U", data_u},
        {"TYPED_U", u->u.n ? ", const LAG_REAL *u" : ""},
        {"WITH_U", u->u.n ? ", u" : ""},
        {"W_U", u->u.n ? ", w + LAG_NY" : ""},
        {"STEP", header_constant(h, 0x1p-24 * fabs(h->scene->t1 - h->scene->t0))},
        {"BY_TIME", timeless && !u->u.n ? "status" : by_time_of(h)},
        {"JACOBIAN", has(h, PART_JAC) ? "lag_gsl_jac" : "0"},
        {"JAC_AT", at.jac},
        {"RESIDUAL_AT", at.residual},
        {"TIME_AT", at.time},
        {"INPUTS_AT", at.inputs},
        {"PARAMS_AT", at.params},
        {"MASS_AT", header_positions(h, u->linear_mass.at, u->linear_mass.n)},
        {"NMASS", mass},
        {"NENTRIES", u->linear_dr.n ? dr : "1"},
        {"NDERIVATIVES", dr},
        {"OF_RATES", u->q.n ? ", rate + LAG_NQ, e, m" : ", e"},
        {"N_IN", jac ? "5" : "4"},
        {"N_OUT", jac ? "4" : "1"},
        {"OUTPUTS", jac ? "\"jac_xdot_x\", \"jac_xdot_u\", \"jac_xdot_p\", \"jac_xdot_t\"" : "\"xdot\""},
        {"PATTERNS", jac ? "static const casadi_int *const at[] = {lag_ode_A, lag_ode_B, lag_ode_P, lag_ode_T}"
                         : "static const casadi_int at[][3] = {{LAG_NY, 1, 1}}"},
        {"MATRICES", jac ? " + LAG_NY*(LAG_NY + LAG_NU + LAG_NP + 1)" : ""},
        {"INPUT_MATRIX", u->u.n ? ", B" : ""},
        {"PARAMS_MATRIX", u->p.n ? arena_printf(h->a, "  %s lag_dparams(%s, P);\n", ok, args) : ""},
        {"TIME_COLUMN",
         timeless ? "" : arena_printf(h->a, "  %s lag_by_time(t, w, p%s, T);\n", ok, u->u.n ? ", u" : "")},
        {NULL, NULL}};
    if (is_wanted(h, i)) header_template(h, callbacks[i].text, w);
  }
}
