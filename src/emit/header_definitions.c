/* Definitions of an emitted header: support functions, functions around programs, constraints, Runge-Kutta step. */
#include <string.h>

#include "emit/header_impl.h"

static const char *const arrays[ARR_COUNT] = {"t", "q", "v", "z", "p", "u", "a", "g"};

static const char *const macros =
  "/* Functions and constants in the scalar's precision. */\n"
  "#ifndef LAG_FN\n"
  "#if defined(__cplusplus)\n"
  "#define LAG_FN(name) name\n"
  "#elif defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L\n"
  "#define LAG_FN(name) _Generic((LAG_REAL)0, float: name##f, long double: name##l, default: name)\n"
  "#else\n"
  "#define LAG_FN(name) (LAG_REAL)name\n"
  "#endif\n"
  "#endif\n"
  "#ifndef LAG_C\n"
  "#define LAG_C(x) (sizeof(LAG_REAL) > sizeof(double) ? (LAG_REAL)x##L : (LAG_REAL)x)\n"
  "#endif\n";

/* Classical Runge-Kutta method (Kutta 1901). Lines marked q, z, u or c are for models with coordinates, states, inputs or constraints. */
static const char *const rk4_body =
  " |  const LAG_REAL weight[4] = {h/LAG_C(6.0), h/LAG_C(3.0), h/LAG_C(3.0), h/LAG_C(6.0)};\n"
  " |  const LAG_REAL next[4] = {LAG_C(0.5)*h, LAG_C(0.5)*h, h, h}; /* from *s to the stage after this */\n"
  " |  lag_state x = *s, sum = *s;\n"
  "q|  LAG_REAL a[LAG_NQ];\n"
  "z|  LAG_REAL zd[LAG_NZ];\n"
  "u|  LAG_REAL now[LAG_NU];\n"
  " |  for (int k = 0; k < 4; k++) {\n"
  "u|    if (!u) lag_inputs(x.t, p, now);\n"
  "u|    if (!u && input) input(context, x.t, now);\n"
  " |    const int status = lag_accel(CALL);\n"
  " |    if (status != LAG_OK) return status;\n"
  "q|    for (int i = 0; i < LAG_NQ; i++) {\n"
  "q|      sum.q[i] += weight[k]*x.v[i];\n"
  "q|      sum.v[i] += weight[k]*a[i];\n"
  "q|      x.q[i] = s->q[i] + next[k]*x.v[i];\n"
  "q|      x.v[i] = s->v[i] + next[k]*a[i];\n"
  "q|    }\n"
  "z|    for (int i = 0; i < LAG_NZ; i++) {\n"
  "z|      sum.z[i] += weight[k]*zd[i];\n"
  "z|      x.z[i] = s->z[i] + next[k]*zd[i];\n"
  "z|    }\n"
  " |    x.t = s->t + next[k];\n"
  " |  }\n"
  " |  sum.t = s->t + h;\n"
  "c|  const int status = lag_hold(HELD);\n"
  "c|  if (status != LAG_OK) return status;\n"
  " |  *s = sum;\n"
  " |  return LAG_OK;\n"
  "}";

/* Newton's method onto the constraints, positions first, then velocities; stops when the residual no longer halves. */
static const char *const hold_body =
  " {\n"
  "  for (int level = LAG_FIRST; level < 2; level++) {\n"
  "    LAG_REAL last = LAG_C(0.0);\n"
  "    for (int turn = 0; turn < 20; turn++) {\n"
  "      LAG_REAL c[LAG_NC], r[LAG_NC], g[LAG_NC], d[LAG_NQ], force[LAG_NQ], size = LAG_C(0.0);\n"
  "      int status = lag_residuals(ARGS, c, r);\n"
  "      for (int k = 0; k < (level ? LAG_NC : LAG_NHOLONOMIC); k++) {\n"
  "        g[k] = -(level ? r[k] : c[k]);\n"
  "        size += LAG_FN(fabs)(g[k]);\n"
  "      }\n"
  "      if (status != LAG_OK || !LAG_ANY(size > LAG_C(0.0)) || (turn && !LAG_ANY(size < LAG_C(0.5)*last))) break;\n"
  "      last = size;\n"
  "      status = CORRECT;\n"
  "      if (status != LAG_OK) return status;\n"
  "      for (int i = 0; i < LAG_NQ; i++) {\n"
  "        if (level) s->v[i] += d[i];\n"
  "        else s->q[i] += d[i];\n"
  "      }\n"
  "    }\n"
  "  }\n"
  "  return LAG_OK;\n"
  "}\n";

/* --- functions around programs --- */

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

static CStyle style_for(const Header *h, const char *const *own, const char *const *out) {
  return (CStyle){.prefix = h->upper, .in = arrays, .params = h->fields, .out = out, .own = own, .globals = h->globals,
                  .solve = arena_printf(h->a, "%s_solve", h->lower), .kkt = arena_printf(h->a, "%s_kkt", h->lower), .spline = arena_printf(h->a, "%s_spline", h->lower),
                  .math = math_prefix(h->u, h->lower)};
}

static const char *api(const Header *h, HeaderFn f) { return header_wrapped(h, arena_printf(h->a, "%s_API %s", h->upper, header_prototype(h, f))); }

/* A function of the state around p; own: its further parameters; out: its output arrays. */
static void state_function(const Header *h, const Prog *p, const char *comment, const char *head, const char *const *own, const char *const *out, int returns) {
  CStyle st = style_for(h, own_names(h, own), out);
  CFunction c = {.comment = comment, .head = head, .returns = returns, .own_work = 1};
  cfunction(p, &st, &c, h->out);
}

static void accel(const Header *h) {
  static const char *const out[] = {"a", "zd", NULL}, *const none[] = {"a", NULL};
  const char *const *extra = !h->u->q.n ? out + 1 : h->u->z.n ? out : none;
  state_function(h, h->u->accel, NULL, api(h, FN_ACCEL), extra, out, 1);
}

/* --- parameters and the start --- */

/* Function _defaults: parameters in order, as each formula may use the parameters before it. */
static void defaults(const Header *h) {
  static const char *const own[] = {"p", NULL}, *const out[] = {"p"};
  sb_printf(h->out, "\n%s {\n", api(h, FN_DEFAULTS));
  if (!h->u->p.n) sb_puts(h->out, "  p->none = 0;\n");
  for (uint32_t i = 0; i < h->u->p.n; i++) {
    CStyle st = style_for(h, own, out);
    st.loads_inline = 1;
    StrBuf body = strbuf(h->a);
    cwrite_body(h->scene->params[i], &st, h->a, &body);
    cwrite_guarded("", sb_text(&body), h->out);
  }
  sb_puts(h->out, "}\n");
}

static void param(const Header *h) {
  sb_printf(h->out, "\n%s {\n", api(h, FN_PARAM));
  if (!h->u->p.n) {
    sb_puts(h->out, "  (void)p; (void)index;\n  return 0;\n}\n");
    return;
  }
  sb_puts(h->out, "  switch (index) {\n");
  for (uint32_t i = 0; i < h->u->p.n; i++) sb_printf(h->out, "    case %s: return &p->%s;\n", h->p[i], h->fields[i]);
  sb_puts(h->out, "    default: return 0;\n  }\n}\n");
}

static void start(const Header *h) {
  static const char *const own[] = {"p", "s", NULL}, *const out[] = {"s->q", "s->v", "s->z"};
  CStyle st = style_for(h, own, out);
  sb_printf(h->out, "\n%s {\n", api(h, FN_START));
  if (!prog_reads(h->scene->start, ARR_P) && !header_has(h, FN_HOLD)) sb_puts(h->out, "  (void)p;\n");
  sb_printf(h->out, "  s->t = %s_C(%s);\n", h->upper, shortest_double(h->a, h->scene->t0));
  if (h->u->q.n) sb_printf(h->out, "  for (int i = 0; i < %s_NQ; i++) s->q[i] = s->v[i] = %s_C(0.0);\n", h->upper, h->upper);
  if (h->u->z.n) sb_printf(h->out, "  for (int i = 0; i < %s_NZ; i++) s->z[i] = %s_C(0.0);\n", h->upper, h->upper);
  cwrite_body(h->scene->start, &st, h->a, h->out);
  for (uint32_t i = 0; i < h->scene->moves.n; i++) {
    const IrMove *x = &h->scene->moves.at[i];
    uint32_t n = h->u->q.n;
    sb_printf(h->out, "  s->%s[%s] = %s_C(%s);\n", x->component < n ? "q" : "v", h->q[x->component % n], h->upper, shortest_double(h->a, x->value));
  }
  if (header_has(h, FN_HOLD) && h->u->u.n)
    sb_printf(h->out, "  %s_REAL u[%s_NU];\n  %s_inputs(s->t, p, u);\n", h->upper, h->upper, h->lower);
  if (header_has(h, FN_HOLD)) sb_printf(h->out, "  return %s_hold(p, s%s);\n", h->lower, h->u->u.n ? ", u" : "");
  sb_puts(h->out, "}\n");
}

static void inputs(const Header *h) {
  static const char *const own[] = {"t", "p", "u", NULL}, *const out[] = {"u"};
  if (!header_has(h, FN_INPUTS)) return;
  CStyle st = style_for(h, own, out);
  CFunction c = {.head = api(h, FN_INPUTS)};
  cfunction(h->u->inputs, &st, &c, h->out);
}

/* --- events --- */

static const char *event_id(const Header *h, uint32_t i) { return arena_printf(h->a, "%s_act_%s", h->lower, cname_of_event(h->u, i)); }

static void action(const Header *h, uint32_t i) {
  const char **out = ARENA_ARRAY(h->a, const char *, 4), **own = ARENA_ARRAY(h->a, const char *, 4);
  StrBuf head = strbuf(h->a);
  uint32_t n = 0;
  out[0] = "q1", out[1] = "v1", out[2] = "z1";
  if (h->u->q.n) own[n++] = "q1", own[n++] = "v1";
  if (h->u->z.n) own[n++] = "z1";
  sb_printf(&head, "static int %s(%s", event_id(h, i), header_state_args(h, 1, ""));
  for (uint32_t k = 0; k < n; k++) sb_printf(&head, ", %s_REAL *%s", h->upper, own[k]);
  sb_putc(&head, ')');
  const char *comment = arena_printf(h->a, "Action of the event %s: q1, v1, z1 hold the state after it.", h->u->events.at[i].name);
  state_function(h, h->u->events.at[i].action, comment, header_wrapped(h, sb_text(&head)), own, out, 1);
}

static void act(const Header *h) {
  if (!header_has(h, FN_ACT)) return;
  for (uint32_t i = 0; i < h->u->events.n; i++) action(h, i);
  sb_printf(h->out, "\n%s {\n  const %s_state was = *s;\n  switch (event) {\n", api(h, FN_ACT), h->lower);
  const char *q = h->u->q.n ? ", s->q, s->v" : "", *z = h->u->z.n ? ", s->z" : "";
  for (uint32_t i = 0; i < h->u->events.n; i++)
    sb_printf(h->out, "    case %s:%s return %s(%s%s%s);\n", h->ev[i], h->u->events.at[i].stop ? " *stop = 1;" : "", event_id(h, i),
              header_state_args(h, 0, "was."), q, z);
  sb_printf(h->out, "    default: (void)stop; return %s_OK;\n  }\n}\n", h->upper);
}

/* --- constraints --- */

/* Internal function `static int lower_NAME(state, extra...)` around p. */
static void internal_function(const Header *h, const Prog *p, const char *name, const char *params, const char *const *extra, const char *const *out) {
  const char *head = arena_printf(h->a, "static int %s_%s(%s, %s)", h->lower, name, header_state_args(h, 1, ""), params);
  state_function(h, p, NULL, header_wrapped(h, head), extra, out, 1);
}

static void change(const Header *h, const Prog *p, const char *name) {
  static const char *const extra[] = {"g", "d", "force", NULL}, *const out[] = {"d", "force"};
  internal_function(h, p, name, arena_printf(h->a, "const %s_REAL *g, %s_REAL *d, %s_REAL *force", h->upper, h->upper, h->upper), extra, out);
}

static void hold(const Header *h) {
  static const char *const extra[] = {"c", "r", NULL};
  const IrConstraints *k = &h->u->constraints;
  if (!header_has(h, FN_HOLD)) return;
  int both = k->position == k->velocity;
  const char *args = header_state_args(h, 0, "s->"), *R = h->upper, *m = h->lower;
  internal_function(h, k->residuals, "residuals", arena_printf(h->a, "%s_REAL *c, %s_REAL *r", R, R), extra, extra);
  if (k->nholonomic) change(h, k->position, both ? "correct" : "correct_positions");
  if (!both) change(h, k->velocity, "correct_velocities");
  const char *correct = both ? arena_printf(h->a, "%s_correct(%s, g, d, force)", m, args)
                        : !k->nholonomic ? arena_printf(h->a, "%s_correct_velocities(%s, g, d, force)", m, args)
                        : arena_printf(h->a, "level ? %s_correct_velocities(%s, g, d, force) : %s_correct_positions(%s, g, d, force)", m, args, m, args);
  sb_printf(h->out, "\nenum { %s_NC = %u, %s_NHOLONOMIC = %u, %s_FIRST = %d }; /* constraints, those on positions; where %s_hold begins */\n", R, k->of.n, R, k->nholonomic, R,
            k->nholonomic == 0, m);
  sb_printf(h->out, "\n%s", api(h, FN_HOLD));
  StrBuf text = strbuf(h->a);
  for (const char *s = hold_body; *s;) {
    if (strncmp(s, "ARGS", 4) == 0) sb_puts(&text, args), s += 4;
    else if (strncmp(s, "CORRECT", 7) == 0) sb_puts(&text, correct), s += 7;
    else sb_putc(&text, *s++);
  }
  csupport_expand(sb_text(&text), R, m, h->out);
}

/* --- a step --- */

/* Runge-Kutta step. With inputs, one internal function serves both kinds of step: u held, or evaluated at each stage. */
static void rk4_step(const Header *h) {
  StrBuf text = strbuf(h->a), call = strbuf(h->a);
  const IrUnit *u = h->u;
  sb_puts(&call, header_state_args(h, 0, "x."));
  if (u->u.n) call.n--, sb_puts(&call, "u ? u : now");
  sb_printf(&call, "%s%s", u->q.n ? ", a" : "", u->z.n ? ", zd" : "");
  for (const char *s = rk4_body; *s;) {
    size_t n = strcspn(s, "\n") + (strchr(s, '\n') != NULL);
    int wanted = *s == 'c' ? u->constraints.of.n > 0 : *s == 'q' ? u->q.n > 0 : *s == 'z' ? u->z.n > 0 : *s == 'u' ? u->u.n > 0 : 1;
    const char *line = *s == '}' ? arena_strdup(h->a, "}\n") : arena_strndup(h->a, s + 2, n - 2), *at = strstr(line, "CALL"), *held = strstr(line, "HELD");
    if (wanted && at) sb_printf(&text, "%.*s%s%s", (int)(at - line), line, sb_text(&call), at + 4);
    else if (wanted && held) sb_printf(&text, "%.*sp, &sum%s%s", (int)(held - line), line, u->u.n ? ", u ? u : now" : "", held + 4);
    else if (wanted) sb_puts(&text, line);
    s += n;
  }
  const char *shared = "static int lag_step(const lag_params *p, lag_state *s, LAG_REAL h, const LAG_REAL *u,\n"
                       "   lag_input_fn *input, void *context)";
  sb_putc(h->out, '\n');
  if (u->u.n) csupport_expand(shared, h->upper, h->lower, h->out);
  else sb_puts(h->out, api(h, FN_RK4_STEP));
  sb_puts(h->out, " {\n");
  csupport_expand(sb_text(&text), h->upper, h->lower, h->out);
  if (!u->u.n) return;
  sb_printf(h->out, "\n%s {\n  return %s_step(p, s, h, u, 0, 0);\n}\n", api(h, FN_RK4_STEP), h->lower);
  sb_printf(h->out, "\n%s {\n  return %s_step(p, s, h, 0, input, context);\n}\n", api(h, FN_RK4_STEP_WITH), h->lower);
}

void header_implementation(const Header *h) {
  static const char *const e[] = {"e", NULL}, *const out[] = {"out", NULL}, *const g[] = {"g", NULL};
  sb_puts(h->out, "#include <math.h>\n\n");
  math_lanes(h->upper, h->lower, h->out);
  csupport_expand(macros, h->upper, h->lower, h->out);
  csupport_logic(h->upper, h->out);
  sb_putc(h->out, '\n');
  math_functions(h->u, h->upper, h->lower, h->out);
  sb_puts(h->out, "\n#ifdef __cplusplus\nextern \"C\" {\n#endif\n");
  if (prog_solves_dense(h->u->accel) || prog_solves_dense(h->scene->observe_plain)) csupport_solver(h->upper, h->lower, h->out);
  math_kkt_solver(h->u, h->upper, h->lower, h->out);
  if (h->u->inputs->tables.n) csupport_spline(h->upper, h->lower, h->out);
  defaults(h);
  param(h);
  start(h);
  inputs(h);
  accel(h);
  if (header_has(h, FN_ENERGY)) state_function(h, h->u->energy, NULL, api(h, FN_ENERGY), e, e, 0);
  if (header_has(h, FN_CHARGES)) state_function(h, h->u->charge_values, NULL, api(h, FN_CHARGES), out, out, 1);
  if (header_has(h, FN_POWERS)) state_function(h, h->u->charge_powers, NULL, api(h, FN_POWERS), out, out, 1);
  if (header_has(h, FN_OBSERVE)) state_function(h, h->scene->observe_plain, NULL, api(h, FN_OBSERVE), out, out, 1);
  if (header_has(h, FN_EVENTS)) state_function(h, h->u->event_values, NULL, api(h, FN_EVENTS), g, g, 1);
  act(h);
  hold(h);
  rk4_step(h);
  sb_puts(h->out, "\n#ifdef __cplusplus\n}\n#endif\n");
}
