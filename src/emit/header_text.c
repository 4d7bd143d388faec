/* Text of headers: which functions a model has, their prototypes and bodies; templates; tables and constants. */
#include <stdlib.h>
#include <string.h>

#include "emit/header_impl.h"

static const char *const arrays[ARR_COUNT] = {"t", "q", "v", "z", "p", "u", "a", "g"};

const char *header_wrapped(const Header *h, const char *fmt, ...) {
  enum { WIDTH = 110 };
  StrBuf b = strbuf(h->a), prototype = strbuf(h->a);
  size_t column = 0;
  va_list ap;
  va_start(ap, fmt);
  csupport_expand(arena_vprintf(h->a, fmt, ap), h->upper, h->lower, &prototype);
  va_end(ap);
  for (const char *s = sb_text(&prototype); *s;) {
    size_t n = strcspn(s, ","), whole = n + (s[n] == ',');
    if (column && column + whole > WIDTH) {
      sb_puts(&b, "\n   ");
      column = 3;
    }
    sb_putn(&b, s, whole);
    column += whole;
    s += whole;
  }
  return sb_text(&b);
}

void header_printf(const Header *h, const char *fmt, ...) {
  va_list ap;
  va_start(ap, fmt);
  csupport_expand(arena_vprintf(h->a, fmt, ap), h->upper, h->lower, h->out);
  va_end(ap);
}

const char *header_state_args(const Header *h, int typed, const char *from) {
  StrBuf b = strbuf(h->a);
  const char *real = typed ? arena_printf(h->a, "const %s_REAL *", h->upper) : from;
  if (typed) sb_printf(&b, "%s_REAL t", h->upper);
  else sb_printf(&b, "%st", from);
  if (h->u->q.n) sb_printf(&b, ", %sq, %sv", real, real);
  if (h->u->z.n) sb_printf(&b, ", %sz", real);
  if (typed) sb_printf(&b, ", const %s_params *p", h->lower);
  else sb_puts(&b, ", p");
  if (h->u->u.n) sb_printf(&b, ", %su", typed ? real : "");
  return sb_text(&b);
}

int header_has(const Header *h, HeaderFn f) {
  const ProgramSet *u = h->u;
  switch (f) {
    case FN_INPUTS: case FN_RK4_STEP_WITH: return u->u.n > 0;
    case FN_ENERGY: return u->energy != NULL;
    case FN_CHARGES: return u->charge_values != NULL;
    case FN_POWERS: return u->charge_values && u->charge_powers;
    case FN_OBSERVE: return h->scene->plain.n > 0;
    case FN_EVENTS: case FN_ACT: return u->events.n > 0;
    case FN_HOLD: return u->constraints.of.n > 0;
    case FN_UNTIL_EVENT: return (h->parts.parts & PART_EVENTS) != 0;
    case FN_RHS: return (h->parts.parts & PART_RHS) != 0;
    case FN_MASS: case FN_BIAS: return u->mass != NULL;
    case FN_INVERSE: return u->inverse != NULL;
    case FN_JAC: case FN_JVP: case FN_VJP: return (h->parts.parts & PART_JAC) != 0;
    case FN_LINEARIZE: return (h->parts.parts & PART_LINEAR) != 0;
    case FN_DPARAMS: return (h->parts.parts & PART_PARAMS) != 0;
    case FN_OUTPUT_JACOBIAN: return (h->parts.parts & PART_OUTPUT_JACOBIAN) != 0;
    case FN_ADJOINT_STEP: return (h->parts.parts & PART_ADJOINT) != 0;
    case FN_CONSTRAINTS: case FN_CONSTRAINT_JACOBIAN: return (h->parts.parts & PART_CONSTRAINTS) != 0;
    case FN_MULTIPLIERS:
      return u->constraints.of.n && (h->parts.parts & (PART_CONSTRAINTS | PART_JAC | PART_LINEAR | PART_PARAMS)) != 0;
    case FN_DEFAULTS: case FN_PARAM: case FN_START: case FN_ACCEL: case FN_RK4_STEP: case FN_COUNT: break;
  }
  return 1;
}

void header_one_state(const Header *h, const char *name, const char *way) {
  header_printf(h,
                "int lag_%s(const void *p, ...) __attribute__((error(\"it computes one state, not LAG_LANES: %s\"\n"
                "  \" by a second header without LAG_LANES, with another --prefix\")));\n",
                name, way);
}

/* ---- functions around programs */

/* Parameter names of a function of the state; extra: its further parameters. */
static const char *const *own_names(const Header *h, const char *const *extra) {
  const char **own = ARENA_ARRAY(h->a, const char *, ARR_COUNT + 4);
  uint32_t n = 0;
  own[n++] = "t";
  if (h->u->q.n) own[n++] = "q", own[n++] = "v";
  if (h->u->z.n) own[n++] = "z";
  own[n++] = "p";
  if (h->u->u.n) own[n++] = "u";
  for (; *extra; extra++) own[n++] = *extra;
  return own;
}

CStyle header_style(const Header *h, const char *const *own, const char *const *out) {
  return (CStyle){.prefix = h->upper,
                  .in = arrays, .params = h->fields, .out = out, .own = own, .globals = h->globals,
                  .solve = arena_printf(h->a, "%s_solve", h->lower), .kkt = arena_printf(h->a, "%s_kkt", h->lower),
                  .spline = arena_printf(h->a, "%s_spline", h->lower),
                  .curve = arena_printf(h->a, "%s_curve", h->lower),
                  .math = math_prefix(h->u, h->lower)};
}

/* Names in a list of parameters, "const LAG_REAL *g, LAG_REAL *d"; outputs: of arrays that are written. */
static const char *const *parameter_names(const Header *h, const char *list, int outputs) {
  const char **names = ARENA_ARRAY(h->a, const char *, strlen(list));
  uint32_t n = 0;
  for (const char *s = list, *end; *s && *s != ')'; s = end + (*end == ',')) {
    s += strspn(s, " ");
    end = s + strcspn(s, ",)");
    const char *star = memchr(s, '*', (size_t)(end - s));
    if (star && !(outputs && strncmp(s, "const ", 6) == 0))
      names[n++] = arena_strndup(h->a, star + 1, (size_t)(end - star) - 1);
  }
  return names;
}

void header_state_function(const Header *h, const Prog *p, const char *comment, const char *head, const char *params,
                           const char *const *out, int returns) {
  CStyle st = header_style(h, own_names(h, parameter_names(h, params, 0)), out ? out : parameter_names(h, params, 1));
  CFunction c = {.comment = comment, .head = head, .returns = returns, .own_work = 1};
  cfunction(p, &st, &c, h->out);
}

void header_internal_function(const Header *h, const Prog *p, const char *name, const char *comment, const char *params,
                              const char *const *out) {
  const char *head = header_wrapped(h, "static int lag_%s(%s, %s)", name, header_state_args(h, 1, ""), params);
  header_state_function(h, p, comment, head, params, out, 1);
}

HeaderWord header_number(const Header *h, const char *mark, uint32_t n) {
  return (HeaderWord){mark, arena_printf(h->a, "%u", n)};
}

void header_begin(const Header *h, HeaderFn f) { sb_printf(h->out, "\n%s", header_api(h, f)); }

const char *header_constant(const Header *h, double x) {
  const char *text = shortest_double(h->a, x);
  return arena_printf(h->a, "%s_C(%s%s)", h->upper, text, strpbrk(text, ".en") ? "" : ".0");
}

const char *header_positions(const Header *h, const IrEntry *at, uint32_t n) {
  StrBuf b = strbuf(h->a);
  for (uint32_t k = 0; k < n; k++)
    sb_printf(&b, "%s{%u, %u}", !k ? "" : k % 12 ? ", " : ",\n    ", at[k].row, at[k].col);
  return n ? sb_text(&b) : "{0, 0}";
}

/* ---- templates */

void header_section(const Header *h, const char *name) { embedded_section(name, h->upper, h->lower, h->out); }

void header_sections(const Header *h, const char *names) {
  for (size_t n; *names; names += n + strspn(names + n, ", ")) {
    n = strcspn(names, ",");
    header_section(h, arena_strndup(h->a, names, n));
  }
}

const char *const header_held_inputs = "\n * u: the inputs, constant during the step; 0 for the model's formulas.";
const char *const header_adaptive_lanes = "\n * Over lanes: a try in each lane that is not at its `until`. One whose "
                                          "step is too long keeps its state, and has a shorter step in the next\n"
                                          " * call; the others go on. Status: minus the sum of 2^k over the lanes k "
                                          "that failed; until[k] = s->t[k] lets such a lane rest.";

const char *const header_held_parameters = ", const LAG_REAL *u, lag_input_fn *input, void *context";

static void expand_template(const Header *h, const char *text, const HeaderWord *more, StrBuf *out) {
  const ProgramSet *u = h->u;
  const char *call =
      arena_printf(h->a, "t%s%s, p%s%s%s", u->q.n ? ", y, y + LAG_NQ" : "", u->z.n ? ", y + 2*LAG_NQ" : "",
                   u->u.n ? ", lag_held(p, t, u, input, context, now)" : "", u->q.n ? ", k + LAG_NQ" : "",
                   u->z.n ? ", k + 2*LAG_NQ" : "");
  const HeaderWord usual[] = {{"HELD", u->u.n ? header_held_parameters : ""},
                              {"PASS", u->u.n ? ", u, input, context" : ""},
                              {"CALL", call},
                              {"ARGS", header_state_args(h, 0, "")},
                              {NULL, NULL}};
  StrBuf b = strbuf(h->a);
  for (const char *s = text; *s;) {
    size_t n = strcspn(s, "\n");
    n += s[n] != '\0';
    int wanted = *s == 'q' ? u->q.n > 0 : *s == 'z' ? u->z.n > 0 : *s == 'u' ? u->u.n > 0 : *s == 'n' ? !u->u.n : 1;
    for (const char *at = s + 2; wanted && at < s + n;) {
      const HeaderWord *w = usual;
      while (w->mark && strncmp(at, w->mark, strlen(w->mark)) != 0) w++;
      for (w = w->mark ? w : more; w && w->mark && strncmp(at, w->mark, strlen(w->mark)) != 0;) w++;
      if (w && w->mark) sb_puts(&b, w->text), at += strlen(w->mark);
      else sb_putc(&b, *at++);
    }
    s += n;
  }
  csupport_expand(sb_text(&b), h->upper, h->lower, out);
}

void header_template(const Header *h, const char *text, const HeaderWord *more) {
  expand_template(h, text, more, h->out);
}

/* STATE: the typed arguments of header_state_args; INPUT, RATES, BY_INPUTS, ALSO_BY_INPUTS: where there are inputs,
 * q, z. */
static const char *const prototypes[FN_COUNT] = {
    [FN_DEFAULTS] = " |void lag_defaults(lag_params *p)",
    [FN_PARAM] = " |LAG_REAL *lag_param(lag_params *p, int index)",
    [FN_START] = " |int lag_start(const lag_params *p, lag_state *s)",
    [FN_INPUTS] = " |void lag_inputs(LAG_REAL t, const lag_params *p, LAG_REAL *u)",
    [FN_ACCEL] = " |int lag_accel(STATE, RATES)",
    [FN_ENERGY] = " |void lag_energy(STATE, LAG_REAL *e)",
    [FN_CHARGES] = " |int lag_charges(STATE, LAG_REAL *out)",
    [FN_POWERS] = " |int lag_powers(STATE, LAG_REAL *out)",
    [FN_OBSERVE] = " |int lag_observe(STATE, LAG_REAL *out)",
    [FN_EVENTS] = " |int lag_events(STATE, LAG_REAL *g)",
    [FN_ACT] = " |int lag_act(int event, const lag_params *p, lag_state *sINPUT, int *stop)",
    [FN_HOLD] = " |int lag_hold(const lag_params *p, lag_state *sINPUT)",
    [FN_RK4_STEP] = " |int lag_rk4_step(const lag_params *p, lag_state *s, LAG_REAL hINPUT)",
    [FN_RK4_STEP_WITH] = (" |int lag_rk4_step_with(const lag_params *p, lag_state *s, LAG_REAL h, "
                          "lag_input_fn *input, void *context)"),
    [FN_UNTIL_EVENT] = " |int lag_step_until_event(const lag_params *p, lag_state *s, LAG_REAL hINPUT, int *event)",
    [FN_RHS] = " |int lag_rhs(LAG_REAL t, const LAG_REAL *y, const lag_params *pINPUT, LAG_REAL *dydt)",
    [FN_MASS] = " |int lag_mass(STATE, LAG_REAL *M)",
    [FN_BIAS] = " |int lag_bias(STATE, LAG_REAL *b)",
    [FN_INVERSE] = " |int lag_inverse_dynamics(STATE, const LAG_REAL *a, LAG_REAL *force)",
    [FN_JAC] = " |int lag_jac(STATE, LAG_REAL *J)",
    [FN_JVP] = " |int lag_jvp(STATE, const LAG_REAL *x, LAG_REAL *out)",
    [FN_VJP] = " |int lag_vjp(STATE, const LAG_REAL *x, LAG_REAL *out)",
    [FN_LINEARIZE] = " |int lag_linearize(STATE, LAG_REAL *ABY_INPUTS)",
    [FN_DPARAMS] = " |int lag_dparams(STATE, LAG_REAL *P)",
    [FN_CONSTRAINTS] = " |int lag_constraints(STATE, LAG_REAL *c, LAG_REAL *r)",
    [FN_CONSTRAINT_JACOBIAN] = " |int lag_constraint_jacobian(STATE, LAG_REAL *A)",
    [FN_MULTIPLIERS] = " |int lag_multipliers(STATE, LAG_REAL *lambda)",
    [FN_OUTPUT_JACOBIAN] = " |int lag_output_jacobian(STATE, LAG_REAL *CALSO_BY_INPUTS)",
    [FN_ADJOINT_STEP] = " |int lag_adjoint_step(const lag_params *p, const lag_state *s, LAG_REAL hINPUT, LAG_REAL *x, "
                        "LAG_REAL *g)",
};

const char *header_rates(const Header *h) {
  return !h->u->z.n ? "LAG_REAL *a" : h->u->q.n ? "LAG_REAL *a, LAG_REAL *zd" : "LAG_REAL *zd";
}

const char *header_prototype(const Header *h, HeaderFn f) {
  const HeaderWord words[] = {{"STATE", header_state_args(h, 1, "")},
                              {"INPUT", h->u->u.n ? ", const LAG_REAL *u" : ""},
                              {"BY_INPUTS", h->u->u.n ? ", LAG_REAL *B" : ""},
                              {"ALSO_BY_INPUTS", h->u->u.n ? ", LAG_REAL *D" : ""},
                              {"RATES", header_rates(h)},
                              {NULL, NULL}};
  StrBuf b = strbuf(h->a);
  expand_template(h, prototypes[f], words, &b);
  return sb_text(&b);
}

const char *header_api(const Header *h, HeaderFn f) { return header_wrapped(h, "LAG_API %s", header_prototype(h, f)); }

void header_api_function(const Header *h, const Prog *p, HeaderFn f) {
  static const char state[] = "(STATE, ";
  int returns = strncmp(prototypes[f], " |int", 5) == 0;
  const char *params = strstr(prototypes[f], state) + sizeof state - 1;
  if (header_has(h, f)) header_state_function(h, p, NULL, header_api(h, f), params, NULL, returns);
}

const char *header_chosen(const Header *h, const char *text, const LineChoice *choices) {
  StrBuf b = strbuf(h->a);
  for (const char *s = text; *s;) {
    size_t n = strcspn(s, "\n") + 1;
    const LineChoice *c = choices;
    while (c->mark && c->mark != *s) c++;
    if (!c->mark) sb_putn(&b, s, n);
    else if (c->wanted) sb_putc(&b, ' '), sb_putn(&b, s + 1, n - 1);
    s += n;
  }
  return sb_text(&b);
}
