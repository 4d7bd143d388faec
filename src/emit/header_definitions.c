/* Definitions of an emitted header: support functions, functions around programs, constraints. */
#include <string.h>

#include "emit/header_impl.h"
#include "emit/header_definitions_text.h"

/* Compilers that drop NaN, or reorder sums. As in lag_model.h. */
#define FAST_MATH                                                                                 \
  "defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || (defined(__FINITE_MATH_ONLY__) && " \
  "__FINITE_MATH_ONLY__) || defined(_M_FP_FAST)"

/* --- functions around programs --- */

static void accel(const Header *h) {
  static const char *const out[] = {"a", "zd"};
  header_internal_function(h, h->u->accel, "rates_at",
                           "As _accel; results may be NaN or infinite: adaptive steps then try a shorter one.",
                           header_rates(h), out);
  header_printf(h, "\n%s {\n  int status = lag_rates_at(%s%s%s);\n", header_api(h, FN_ACCEL),
                header_state_args(h, 0, ""), h->u->q.n ? ", a" : "", h->u->z.n ? ", zd" : "");
  if (h->u->q.n) header_printf(h, "  LAG_TRY(LAG_STATUS(LAG_NOT(lag_finite(a, LAG_NQ)), LAG_ENAN));\n");
  if (h->u->z.n) header_printf(h, "  LAG_TRY(LAG_STATUS(LAG_NOT(lag_finite(zd, LAG_NZ)), LAG_ENAN));\n");
  sb_puts(h->out, "  return status;\n}\n");
}

/* --- parameters and the start --- */

/* The parameters in order, as each formula may use the parameters before it. */
static void write_defaults(const Header *h, const char *head, int follow) {
  static const char *const own[] = {"p", NULL}, *const out[] = {"p"};
  header_printf(h, "\n%s {\n", head);
  if (!h->u->p.n) sb_printf(h->out, "  p->none = 0;\n%s", follow ? "  (void)given;\n" : "");
  CStyle st = header_style(h, own, out);
  st.guard = follow ? "given" : NULL;
  for (uint32_t i = 0; i < h->scene->params.n; i++) cwrite_params(&h->scene->params.at[i], st, h->a, h->out);
  sb_puts(h->out, "}\n");
}

static void defaults(const Header *h) {
  write_defaults(h, header_api(h, FN_DEFAULTS), 0);
  if (h->parts.follows) write_defaults(h, "static void lag_follow(lag_params *p, const unsigned char *given)", 1);
}

static void param(const Header *h) {
  sb_printf(h->out, "\n%s {\n", header_api(h, FN_PARAM));
  if (!h->u->p.n) {
    sb_puts(h->out, "  (void)p; (void)index;\n  return 0;\n}\n");
    return;
  }
  sb_puts(h->out, "  switch (index) {\n");
  for (uint32_t i = 0; i < h->u->p.n; i++) sb_printf(h->out, "    case %s: return &p->%s;\n", h->p[i], h->fields[i]);
  sb_puts(h->out, "    default: return 0;\n  }\n}\n");
}

/* Condition on p->NAME, or on a size: comparisons by > alone, which types that differentiate have. */
static const char *demand(const Header *h, const char *x, int sign) {
  return arena_printf(h->a,
                      sign == 1    ? "%s > zero"
                      : sign == -1 ? "zero > %s"
                      : sign == 2  ? "LAG_NOT(zero > %s)"
                                   : "LAG_NOT(%s > zero)",
                      x);
}

static void write_demand(const Header *h, const char *demand) {
  header_printf(h, "  good = LAG_AND(good, %s);\n", demand);
}

/* lag_sizes: whether parameters have their declared signs, and the sizes that they determine. */
static void sizes(const Header *h) {
  static const char *const own[] = {"p", "out", NULL}, *const out[] = {"out"};
  const ProgramSet *u = h->u;
  if (u->size_values) {
    CStyle st = header_style(h, own, out);
    CFunction c = {.comment = "Sizes of friction, inertias and coefficients, of parameters alone.", .own_work = 1};
    c.head = header_wrapped(h, "static void lag_size_values(const lag_params *p, LAG_REAL *out)");
    cfunction(u->size_values, &st, &c, h->out);
  }
  header_printf(h,
                "\nstatic int lag_sizes(const lag_params *p) {\n#ifdef LAG_COMPLEX /* has no order */\n  (void)p;\n  "
                "return LAG_OK;\n#else\n"
                "  const LAG_REAL zero = LAG_C(0.0);\n  LAG_MASK good = LAG_IS_FINITE(zero);\n");
  if (u->size_values) header_printf(h, "  LAG_REAL size[%u];\n  lag_size_values(p, size);\n", u->sizes.n - u->nmoving);
  else sb_puts(h->out, "  (void)p;\n");
  for (uint32_t i = 0; i < u->p.n; i++)
    if (u->p.at[i].sign) write_demand(h, demand(h, arena_printf(h->a, "p->%s", h->fields[i]), u->p.at[i].sign));
  for (uint32_t i = 0; i < u->sizes.n - u->nmoving; i++) {
    const char *size = arena_printf(h->a, "size[%u]", i);
    write_demand(h, demand(h, size, u->sizes.at[i].open ? 1 : 2));
    if (u->sizes.at[i].part) write_demand(h, arena_printf(h->a, "LAG_NOT(%s > LAG_C(1.0))", size));
  }
  header_printf(h, "  return LAG_STATUS(LAG_NOT(good), LAG_ESIZE);\n#endif\n}\n");
}

/* Whether parameters can be wrong. */
static int has_sizes(const ProgramSet *u) {
  int some = u->size_values != NULL;
  for (uint32_t i = 0; i < u->p.n; i++) some |= u->p.at[i].sign != 0;
  return some;
}

static void start(const Header *h) {
  static const char *const own[] = {"p", "s", NULL}, *const out[] = {"s->q", "s->v", "s->z"};
  CStyle st = header_style(h, own, out);
  int checks = has_sizes(h->u);
  if (checks) sizes(h);
  sb_printf(h->out, "\n%s {\n", header_api(h, FN_START));
  if (checks || header_has(h, FN_HOLD)) header_printf(h, "  int status = LAG_OK;\n");
  if (checks) header_printf(h, "  LAG_TRY(lag_sizes(p));\n");
  else if (!prog_reads(h->scene->start, ARR_P) && !header_has(h, FN_HOLD)) sb_puts(h->out, "  (void)p;\n");
  sb_printf(h->out, "  s->t = %s;\n", header_constant(h, h->scene->t0));
  if (h->u->q.n) header_printf(h, "  for (int i = 0; i < LAG_NQ; i++) s->q[i] = s->v[i] = LAG_C(0.0);\n");
  if (h->u->z.n) header_printf(h, "  for (int i = 0; i < LAG_NZ; i++) s->z[i] = LAG_C(0.0);\n");
  header_printf(h, "  for (int i = 0; i <= LAG_NY; i++) s->lost[i] = LAG_C(0.0);\n");
  if (header_has_method(h, "moreau")) header_moreau_start(h);
  cwrite_body(h->scene->start, &st, h->a, h->out);
  vec_each(const IrMove, x, h->scene->moves) {
    uint32_t n = h->u->q.n;
    sb_printf(h->out, "  s->%s[%s] = %s;\n", x->component < n ? "q" : "v", h->q[x->component % n],
              header_constant(h, x->value));
  }
  if (header_has(h, FN_HOLD) && h->u->u.n) header_printf(h, "  LAG_REAL u[LAG_NU];\n  lag_inputs(s->t, p, u);\n");
  if (header_has(h, FN_HOLD)) header_printf(h, "  LAG_TRY(lag_hold(p, s%s));\n", h->u->u.n ? ", u" : "");
  header_printf(h, "  return %s;\n}\n", checks || header_has(h, FN_HOLD) ? "status" : "LAG_OK");
}

static void inputs(const Header *h) {
  static const char *const own[] = {"t", "p", "u", NULL}, *const out[] = {"u"};
  if (!header_has(h, FN_INPUTS)) return;
  CStyle st = header_style(h, own, out);
  CFunction c = {.head = header_api(h, FN_INPUTS)};
  cfunction(h->u->inputs, &st, &c, h->out);
}

/* --- events --- */

static void action(const Header *h, uint32_t i) {
  static const char *const out[] = {"q1", "v1", "z1"};
  const char *q = h->u->q.n ? "LAG_REAL *q1, LAG_REAL *v1" : "", *z = h->u->z.n ? "LAG_REAL *z1" : "";
  const char *comment =
      arena_printf(h->a, "Action of the event %s: q1, v1, z1 hold the state after it.", h->u->events.at[i].name);
  header_internal_function(h, h->u->events.at[i].action, arena_printf(h->a, "act_%s", h->event_ids[i]), comment,
                           arena_printf(h->a, "%s%s%s", q, *q && *z ? ", " : "", z), out);
}

/* Newton's law of impact for the contact whose constraint is `row`, which its input closes. */
static void strike(const Header *h) {
  uint32_t n = h->u->constraints.of.n, nu = h->u->u.n;
  if (!h->u->impact) return;
  header_internal_function(h, h->u->impact, "impact",
                           "Velocities after the impact of the contact whose entry of g is 1.",
                           "const LAG_REAL *g, LAG_REAL *v1", NULL);
  header_printf(
      h,
      "\n%s {\n  LAG_REAL g[%u], with[%u];\n  for (int i = 0; i < %u; i++) g[i] = LAG_C(0.0);\n  for (int i = "
      "0; i < %u; i++) with[i] = u[i];\n",
      header_wrapped(h, "static int lag_strike(int row, int input, %s, LAG_REAL *v1)", header_state_args(h, 1, "")), n,
      nu, n, nu);
  header_printf(h, "  g[row] = with[input] = LAG_C(1.0);\n  return lag_impact(t, q, v, %sp, with, g, v1);\n}\n",
                h->u->z.n ? "z, " : "");
}

static void act(const Header *h) {
  if (!header_has(h, FN_ACT)) return;
  strike(h);
  for (uint32_t i = 0; i < h->u->events.n; i++)
    if (!program_set_striking_contact(h->u, i)) action(h, i);
  header_printf(h,
                "\n%s {\n  const lag_state was = *s;\n  for (int i = 0; i <= LAG_NY; i++) s->lost[i] = LAG_C(0.0);\n  "
                "switch (event) {\n",
                header_api(h, FN_ACT));
  const char *q = h->u->q.n ? ", s->q, s->v" : "", *z = h->u->z.n ? ", s->z" : "",
             *args = header_state_args(h, 0, "was.");
  for (uint32_t i = 0; i < h->u->events.n; i++) {
    const IrContact *c = program_set_striking_contact(h->u, i);
    if (c)
      header_printf(h, "    case %s: return lag_strike(%u, %s, %s, s->v);\n", h->ev[i], c->constraint, h->in[c->input],
                    args);
    else
      header_printf(h, "    case %s:%s return lag_act_%s(%s%s%s);\n", h->ev[i],
                    h->u->events.at[i].stop ? " *stop = 1;" : "", h->event_ids[i], args, q, z);
  }
  header_printf(h, "    default: (void)stop; return LAG_OK;\n  }\n}\n");
}

/* --- constraints --- */

static void change(const Header *h, const Prog *p, const char *name) {
  header_internal_function(h, p, name, NULL, "const LAG_REAL *g, LAG_REAL *d, LAG_REAL *force", NULL);
}

/* The numbers of the coordinates' units, where there are several. */
static int units(const Header *h) {
  const IrVar *q = h->u->q.at;
  uint32_t n = h->u->q.n, several = 0;
  StrBuf text = strbuf(h->a);
  for (uint32_t i = 0; i < n; i++) {
    uint32_t first = 0;
    while (strcmp(q[first].unit->text, q[i].unit->text) != 0) first++;
    several |= first;
    sb_printf(&text, "%s%u", i ? ", " : "", first);
  }
  if (several)
    header_printf(h, "\nstatic const int lag_unit_of[] = {%s}; /* equal for coordinates with the same unit */\n",
                  sb_text(&text));
  return several != 0;
}

void header_hold_define(const Header *h) {
  const IrConstraints *k = &h->u->constraints;
  int both = k->position == k->velocity;
  const char *args = header_state_args(h, 0, "s->"), *u = h->u->u.n ? ", u" : "";
  header_internal_function(h, k->residuals, "residuals", NULL, "LAG_REAL *c, LAG_REAL *r", NULL);
  if (k->nholonomic) change(h, k->position, both ? "correct" : "correct_positions");
  if (!both) change(h, k->velocity, "correct_velocities");
  const char *correct =
      both ? arena_printf(h->a, "lag_correct(%s, g, d, at->force)", args)
      : !k->nholonomic
          ? arena_printf(h->a, "lag_correct_velocities(%s, g, d, at->force)", args)
          : arena_printf(h->a,
                         "level ? lag_correct_velocities(%s, g, d, at->force) "
                         ": lag_correct_positions(%s, g, d, at->force)",
                         args, args);
  const HeaderWord words[] = {{"STATE", args},
                              {"BESIDE", header_state_args(h, 0, "beside.")},
                              {"CORRECT", correct},
                              {"FIRST", k->nholonomic ? "0" : "1"},
                              {"INPUTS", h->u->u.n ? ", const LAG_REAL *u" : ""},
                              {"GIVEN", u},
                              {"WITH", units(h) ? "if (lag_unit_of[j] == lag_unit_of[i]) " : ""},
                              {NULL, NULL}};
  header_template(h, hold, words);
  header_section(h, "hold");
  header_template(h, onto, words);
  header_printf(h, "\n%s {\n  return lag_onto(p, s%s, 0);\n}\n", header_api(h, FN_HOLD), u);
}

/* Operation of a program that complex numbers lack, or NULL. Scales of drifts may have absolute values: LAG_ABS. */
static const char *comparison(const Prog *p, int has_scale) {
  static const char *const real_only[] = {"atan2", "hypot", "cbrt", "floor"};
  for (uint32_t k = 0; k < prog_parts(p); k++)
    for (Slot s = 1; s < prog_part(p, k)->ins.n; s++) {
      const Ins *i = &prog_part(p, k)->ins.at[s];
      if (ir_is_condition(i->op) || i->op == IR_MIN || i->op == IR_MAX || i->op == IR_SIGN) return "comparisons";
      if (i->op == IR_SOLVE) return "linear systems with pivots";
      if (i->op == IR_TABLE) return "tables";
      if ((i->op != IR_FN1 && i->op != IR_FN2) || (has_scale && strcmp(i->text, "fabs") == 0)) continue;
      if (strcmp(i->text, "fabs") == 0) return "abs";
      for (size_t f = 0; f < sizeof real_only / sizeof *real_only; f++)
        if (strcmp(i->text, real_only[f]) == 0) return real_only[f];
    }
  return NULL;
}

static const char *comparison_of_unit(const ProgramSet *u) {
  ProgList all = program_set_programs(u);
  if (u->constraints.of.n) return "constraints";
  if (u->q.n && (u->linear || u->by_params)) return "linear systems with pivots, for its derivatives";
  for (uint32_t i = 0; i < all.n; i++) {
    const Prog *p = all.at[i];
    const char *why = comparison(p, p == u->energy || p == u->charge_values || p == u->scenes.at[0].observe_plain);
    if (why) return why;
  }
  return NULL;
}

/* Limits of scalars: no order, or no functions in C++98. */
static void for_scalars(const Header *h) {
  const char *why = comparison_of_unit(h->u), *m = h->upper;
  if (why)
    sb_printf(h->out, "#ifdef %s_COMPLEX\n#error \"%s_REAL cannot be complex: the model has %s\"\n#endif\n\n", m, m,
              why);
  if (h->u->constraints.of.n || unit_calls(h->u, "cbrt") || unit_calls(h->u, "hypot")) sb_puts(h->out, overloads);
  if (header_has_method(h, "taylor")) header_taylor_overloads(h);
}

static int solves_dense(const Header *h) {
  const ProgramSet *u = h->u;
  return prog_solves_dense(u->accel) || prog_solves_dense(h->scene->observe_plain) ||
         (header_has(h, FN_ADJOINT_STEP) && prog_solves_dense(u->adjoint)) ||
         (h->parts.parts & (PART_OUTPUTS | PART_OUTPUT_JACOBIAN) && prog_solves_dense(u->outputs)) ||
         (u->taylor && prog_solves_dense(u->taylor->first));
}

void header_implementation(const Header *h) {
  sb_puts(h->out, "#if " FAST_MATH "\n#error \"this header needs NaN and exact sums: compile it without -ffast-math, "
                                   "-Ofast and /fp:fast\"\n#endif\n#include <math.h>\n\n");
  MathText math = {h->u, h->upper, h->lower, solves_dense(h)};
  for_scalars(h);
  sb_puts(h->out, "#ifdef __cplusplus\nextern \"C\" {\n#endif\n\n");
  math_lanes(&math, h->out);
  header_printf(h, "%s", macros);
  math_front(&math, h->out);
  defaults(h);
  param(h);
  header_sections(h, "failures, finite");
  start(h);
  inputs(h);
  accel(h);
  header_api_function(h, h->u->energy, FN_ENERGY);
  header_api_function(h, h->u->charge_values, FN_CHARGES);
  header_api_function(h, h->u->charge_powers, FN_POWERS);
  header_api_function(h, h->scene->observe_plain, FN_OBSERVE);
  header_api_function(h, h->u->event_values, FN_EVENTS);
  act(h);
  sb_putc(h->out, '\n');
  math_bodies(&math, h->out);
  header_steps_define(h);
  header_dynamics_define(h);
  sb_puts(h->out, "\n#ifdef __cplusplus\n}\n#endif\n");
}
