#include "emit/emit_model.h"

#include <string.h>

#include "base/num.h"
#include "emit/cnames.h"
#include "emit/cwriter.h"

static const char *const arrays[ARR_COUNT] = {"t", "q", "v", "z", "p", "u"};

static const char *const prelude =
  "/* The scalar and its spelling. Another precision: -DLAG_REAL='long double' '-DLAG_FN(f)=f##l'\n"
  " * '-DLAG_C(x)=x##L'; a vector of lanes defines LAG_SELECT, LAG_ANY and the logic as well. */\n"
  "#ifndef LAG_FN\n#define LAG_FN(f) f\n#endif\n"
  "#ifndef LAG_C\n#define LAG_C(x) ((LAG_REAL)x)\n#endif\n"
  "#ifndef LAG_SELECT\n#define LAG_SELECT(c, a, b) ((c) ? (a) : (b))\n#define LAG_NOT(c) (!(c))\n"
  "#define LAG_AND(a, b) ((a) && (b))\n#define LAG_OR(a, b) ((a) || (b))\n#define LAG_ANY(c) (c)\n#endif\n";

/* Gauss elimination with partial pivoting (Golub & Van Loan, algorithm 3.4.1), for blocks that are
 * not proved positive definite, or are large. */
static const char *const solver =
  "\n/* M x = b by elimination with partial pivoting: M[n*n] row-major is destroyed, b becomes x. */\n"
  "static int lag_solve(int n, LAG_REAL *M, LAG_REAL *b) {\n"
  "  for (int k = 0; k < n; k++) {\n"
  "    int pivot = k;\n"
  "    for (int i = k + 1; i < n; i++)\n"
  "      if (LAG_FN(fabs)(M[i*n + k]) > LAG_FN(fabs)(M[pivot*n + k])) pivot = i;\n"
  "    if (!(LAG_FN(fabs)(M[pivot*n + k]) > LAG_C(0.0))) return LAG_ESINGULAR;\n"
  "    for (int j = 0; j < n; j++) {\n"
  "      const LAG_REAL swap = M[k*n + j];\n"
  "      M[k*n + j] = M[pivot*n + j];\n"
  "      M[pivot*n + j] = swap;\n"
  "    }\n"
  "    const LAG_REAL swap = b[k];\n"
  "    b[k] = b[pivot];\n"
  "    b[pivot] = swap;\n"
  "    for (int i = k + 1; i < n; i++) {\n"
  "      const LAG_REAL factor = M[i*n + k]/M[k*n + k];\n"
  "      for (int j = k + 1; j < n; j++) M[i*n + j] -= factor*M[k*n + j];\n"
  "      b[i] -= factor*b[k];\n"
  "    }\n"
  "  }\n"
  "  for (int k = n - 1; k >= 0; k--) {\n"
  "    for (int j = k + 1; j < n; j++) b[k] -= M[k*n + j]*b[j];\n"
  "    b[k] /= M[k*n + k];\n"
  "  }\n"
  "  return 0;\n"
  "}\n";

/* --- functions --- */

/* A function of the state: t, q, v, z, p, u, what it writes, and work space. */
typedef struct {
  const char *head;           /* up to and with the opening brace */
  const char *const *own;     /* its parameters */
  const char *const *out;
} Signature;

static const char *const state_args =
  "LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z,\n"
  "    const LAG_REAL *p, const LAG_REAL *u";

static void unused(const Prog *p, const char *const *own, const char *const *written, StrBuf *out) {
  StrBuf b = strbuf(p->arena);
  for (int i = 0; own[i]; i++) {
    int used = 0;
    for (int k = 0; k < ARR_COUNT; k++)
      if (strcmp(own[i], arrays[k]) == 0) used |= prog_reads(p, (IrArray)k);
    for (uint32_t k = 0; k < p->stores.n; k++) used |= strcmp(written[p->stores.at[k].array], own[i]) == 0;
    if (strcmp(own[i], "w") == 0) used |= p->solves.n > 0;
    if (!used) sb_printf(&b, "%s(void)%s;", b.n ? " " : "", own[i]);
  }
  if (b.n) sb_printf(out, "  %s\n", sb_text(&b));
}

static CStyle style_for(const char *const *own, const char *const *written) {
  return (CStyle){.prefix = "LAG", .in = arrays, .out = written, .own = own, .solve = "lag_solve"};
}

static void function(const Prog *p, const char *comment, const char *head, const char *const *own,
                     const char *const *written, StrBuf *out) {
  CStyle st = style_for(own, written);
  sb_printf(out, "\n%s%s {\n", comment, head);
  unused(p, own, written, out);
  cwrite_body(p, &st, p->arena, out);
  sb_puts(out, "  return LAG_OK;\n}\n");
}

void emit_accel(const IrUnit *u, StrBuf *out) {
  static const char *const own[] = {"t", "q", "v", "z", "p", "u", "a", "zd", "w", NULL}, *const written[] = {"a", "zd"};
  const char *comment = arena_printf(u->arena, "/* Accelerations%s: %s. */\n", u->z.n ? " and rates" : "", ops_text(u->accel, u->arena));
  const char *head = arena_printf(u->arena, "static int accel(%s, LAG_REAL *a, LAG_REAL *zd, LAG_REAL *w)", state_args);
  function(u->accel, comment, head, own, written, out);
}

static void emit_energy(const IrUnit *u, StrBuf *out) {
  static const char *const own[] = {"t", "q", "v", "z", "p", "u", "out", "w", NULL}, *const written[] = {"out"};
  if (!u->energy) return;
  const char *head = arena_printf(u->arena, "static int energy(%s, LAG_REAL *out, LAG_REAL *w)", state_args);
  function(u->energy, "/* The energy p q' - L, and the scale |p q'| + |L| that its drift is compared with. */\n", head, own, written, out);
}

static void emit_actions(const IrUnit *u, StrBuf *out) {
  static const char *const own[] = {"t", "q", "v", "z", "p", "u", "q1", "v1", "z1", "w", NULL}, *const written[] = {"q1", "v1", "z1"};
  for (uint32_t i = 0; i < u->events.n; i++) {
    const IrEvent *ev = &u->events.at[i];
    const char *comment = arena_printf(u->arena, "/* What the event %s does. */\n", ev->name);
    const char *head = arena_printf(u->arena, "static int act_%s(%s,\n    LAG_REAL *q1, LAG_REAL *v1, LAG_REAL *z1, LAG_REAL *w)",
                                    cname(u->arena, ev->name), state_args);
    function(ev->action, comment, head, own, written, out);
  }
  sb_printf(out, "\nstatic int act(int k, %s,\n    LAG_REAL *q1, LAG_REAL *v1, LAG_REAL *z1, int *stop, LAG_REAL *w) {\n", state_args);
  sb_puts(out, "  switch (k) {\n");
  for (uint32_t i = 0; i < u->events.n; i++) {
    const IrEvent *ev = &u->events.at[i];
    sb_printf(out, "    case %u:%s return act_%s(t, q, v, z, p, u, q1, v1, z1, w);\n", i, ev->stop ? " *stop = 1;" : "", cname(u->arena, ev->name));
  }
  sb_puts(out, "    default: (void)stop; return LAG_OK;\n  }\n}\n");
}

static void emit_events(const IrUnit *u, StrBuf *out) {
  static const char *const own[] = {"t", "q", "v", "z", "p", "u", "out", "w", NULL}, *const written[] = {"out"};
  if (!u->events.n) return;
  const char *head = arena_printf(u->arena, "static int events(%s, LAG_REAL *out, LAG_REAL *w)", state_args);
  function(u->event_values, "/* An event happens where its function changes sign. */\n", head, own, written, out);
  emit_actions(u, out);
}

static void emit_inputs(const IrUnit *u, StrBuf *out) {
  static const char *const own[] = {"t", "p", "u", NULL}, *const written[] = {"u"};
  if (!u->u.n) return;
  function(u->inputs, "/* Inputs that have a formula. */\n", "static int inputs(LAG_REAL t, const LAG_REAL *p, LAG_REAL *u)", own, written, out);
}

/* --- a scene's functions --- */

static const char *scene_id(const IrUnit *u, const IrScene *s) { return cname(u->arena, s->name); }

/* Parameters one by one: each may use those before it, as they are then. */
static void emit_params(const IrUnit *u, const IrScene *s, StrBuf *out) {
  static const char *const own[] = {"p", "fixed", NULL}, *const written[] = {"p"};
  sb_printf(out, "\nstatic void params_%s(LAG_REAL *p, const unsigned char *fixed) {\n", scene_id(u, s));
  if (!u->p.n) sb_puts(out, "  (void)p; (void)fixed;\n");
  for (uint32_t i = 0; i < u->p.n; i++) {
    const Prog *p = s->params[i];
    CStyle st = style_for(own, written);
    st.loads_inline = 1;
    StrBuf body = strbuf(u->arena);
    cwrite_body(p, &st, u->arena, &body);
    const char *text = sb_text(&body);
    while (*text == '\n' || *text == ' ') text++;
    int one_line = strchr(text, '\n') == text + strlen(text) - 1;
    if (one_line) sb_printf(out, "  if (!fixed[%u]) %s", i, text);
    else sb_printf(out, "  if (!fixed[%u]) {\n  %s  }\n", i, text);
  }
  sb_puts(out, "}\n");
}

static void emit_start(const IrUnit *u, const IrScene *s, StrBuf *out) {
  static const char *const own[] = {"p", "q", "v", "z", NULL}, *const written[] = {"q", "v", "z"};
  CStyle st = style_for(own, written);
  sb_printf(out, "\nstatic void start_%s(const LAG_REAL *p, LAG_REAL *q, LAG_REAL *v, LAG_REAL *z) {\n", scene_id(u, s));
  sb_puts(out, "  (void)p; (void)q; (void)v; (void)z;\n");
  if (u->q.n) sb_printf(out, "  for (int i = 0; i < %u; i++) q[i] = v[i] = LAG_C(0.0);\n", u->q.n);
  if (u->z.n) sb_printf(out, "  for (int i = 0; i < %u; i++) z[i] = LAG_C(0.0);\n", u->z.n);
  cwrite_body(s->start, &st, u->arena, out);
  sb_puts(out, "}\n");
}

static void emit_observe(const IrUnit *u, const IrScene *s, StrBuf *out) {
  static const char *const own[] = {"t", "q", "v", "z", "p", "u", "out", "w", NULL}, *const written[] = {"out"};
  const char *comment = arena_printf(u->arena, "/* What the scene %s puts out. */\n", s->name);
  const char *head = arena_printf(u->arena, "static int observe_%s(%s, LAG_REAL *out, LAG_REAL *w)", scene_id(u, s), state_args);
  function(s->observe, comment, head, own, written, out);
}

/* --- tables --- */

static const char *double_text(Arena *a, double x) {
  char text[32];
  num_format_double(text, x);
  return arena_strdup(a, text);
}

static void table(const IrUnit *u, const char *name, const IrVar *v, uint32_t n, StrBuf *out) {
  if (!n) return;
  sb_printf(out, "\nstatic const lag_var %s[] = {\n", name);
  for (uint32_t i = 0; i < n; i++) {
    const char *label = c_string(u->arena, v[i].name), *unit = c_string(u->arena, v[i].unit);
    sb_printf(out, "  {%s, %s, %s, %d, %d},\n", label, unit, double_text(u->arena, v[i].factor), v[i].periodic, v[i].sign);
  }
  sb_puts(out, "};\n");
}

static uint32_t work_size(const IrUnit *u) {
  uint32_t most = 0;
  const Prog *all[] = {u->accel, u->energy, u->event_values};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++)
    if (all[i] && prog_work(all[i]) > most) most = prog_work(all[i]);
  for (uint32_t i = 0; i < u->scenes.n; i++)
    if (prog_work(u->scenes.at[i].observe) > most) most = prog_work(u->scenes.at[i].observe);
  return most;
}

static void flag_text(unsigned flags, StrBuf *out) {
  static const char *const names[] = {"LAG_CONSERVES_ENERGY", "LAG_CONSTANT_MASS", "LAG_AUTONOMOUS", "LAG_SMOOTH",
                                       "LAG_SEPARABLE"};
  int some = 0;
  for (int i = 0; i < 5; i++)
    if (flags >> i & 1) sb_printf(out, "%s%s", some++ ? " | " : "", names[i]);
  if (!some) sb_putc(out, '0');
}

static const char *or_null(uint32_t n, const char *name) { return n ? name : "NULL"; }

static void emit_tables(const IrUnit *u, const char *name, StrBuf *out) {
  table(u, "q_table", u->q.at, u->q.n, out);
  table(u, "z_table", u->z.at, u->z.n, out);
  table(u, "p_table", u->p.at, u->p.n, out);
  table(u, "u_table", u->u.at, u->u.n, out);
  if (u->events.n) {
    sb_puts(out, "\nstatic const lag_event ev_table[] = {\n");
    for (uint32_t i = 0; i < u->events.n; i++)
      sb_printf(out, "  {%s, %d},\n", c_string(u->arena, u->events.at[i].name), u->events.at[i].direction);
    sb_puts(out, "};\n");
  }
  const char *model = c_string(u->arena, u->name), *doc = c_string(u->arena, u->doc), *effects = c_string(u->arena, u->effects);
  sb_printf(out, "\nconst lag_model %s = {\n", name);
  sb_printf(out, "  .abi = LAG_ABI, .real_size = sizeof(LAG_REAL),\n  .name = %s,\n  .doc = %s,\n  .effects = %s,\n  .flags = ", model, doc, effects);
  flag_text(u->flags, out);
  sb_printf(out, ",\n  .ops = %u,\n", ops_total(prog_count(u->accel)));
  sb_printf(out, "  .nq = %u, .nz = %u, .np = %u, .nu = %u, .nev = %u, .nw = %u,\n", u->q.n, u->z.n, u->p.n, u->u.n, u->events.n, work_size(u));
  sb_printf(out, "  .q = %s, .z = %s, .p = %s, .u = %s, .ev = %s,\n", or_null(u->q.n, "q_table"), or_null(u->z.n, "z_table"),
            or_null(u->p.n, "p_table"), or_null(u->u.n, "u_table"), or_null(u->events.n, "ev_table"));
  sb_printf(out, "  .inputs = %s, .accel = accel, .energy = %s,\n  .events = %s, .act = %s,\n};\n", or_null(u->u.n, "inputs"),
            u->energy ? "energy" : "NULL", or_null(u->events.n, "events"), or_null(u->events.n, "act"));
}

static void emit_scene_lists(const IrUnit *u, const IrScene *s, const char *id, StrBuf *out) {
  table(u, arena_printf(u->arena, "outputs_%s", id), s->outputs.at, s->outputs.n, out);
  if (s->options.n) {
    sb_printf(out, "\nstatic const lag_option options_%s[] = {\n", id);
    for (uint32_t i = 0; i < s->options.n; i++) {
      const IrOption *o = &s->options.at[i];
      sb_printf(out, "  {%s, %s, %s},\n", c_string(u->arena, o->name), double_text(u->arena, o->value), o->text ? c_string(u->arena, o->text) : "NULL");
    }
    sb_puts(out, "};\n");
  }
  if (s->monitors.n) {
    sb_printf(out, "\nstatic const lag_monitor monitors_%s[] = {\n", id);
    for (uint32_t i = 0; i < s->monitors.n; i++) {
      const IrMonitor *m = &s->monitors.at[i];
      sb_printf(out, "  {%s, %d, %s},\n", c_string(u->arena, m->name), m->output, double_text(u->arena, m->limit));
    }
    sb_puts(out, "};\n");
  }
}

static const char *list_name(const IrUnit *u, uint32_t n, const char *stem, const char *id) {
  return n ? arena_printf(u->arena, "%s_%s", stem, id) : "NULL";
}

static void emit_scene(const IrUnit *u, const char *name, const IrScene *s, StrBuf *out) {
  const char *id = scene_id(u, s);
  emit_params(u, s, out);
  emit_start(u, s, out);
  emit_observe(u, s, out);
  emit_scene_lists(u, s, id, out);
  sb_printf(out, "\nconst lag_scene %s_%s = {\n", name, id);
  sb_printf(out, "  .name = %s,\n  .doc = %s,\n", c_string(u->arena, s->name), c_string(u->arena, s->doc));
  sb_printf(out, "  .model = &%s,\n  .params = params_%s, .start = start_%s,\n", name, id, id);
  sb_printf(out, "  .t0 = %s, .t1 = %s, .has_span = %d,\n", double_text(u->arena, s->t0), double_text(u->arena, s->t1), s->has_span);
  sb_printf(out, "  .method = %s, .noptions = %u, .options = %s,\n", s->method ? c_string(u->arena, s->method) : "NULL", s->options.n,
            list_name(u, s->options.n, "options", id));
  sb_printf(out, "  .tolerance = %s,\n", double_text(u->arena, s->tolerance));
  sb_printf(out, "  .nout = %u, .outputs = %s, .every = %s, .observe = observe_%s,\n", s->outputs.n, list_name(u, s->outputs.n, "outputs", id),
            double_text(u->arena, s->every), id);
  sb_printf(out, "  .nmonitors = %u, .monitors = %s,\n};\n", s->monitors.n, list_name(u, s->monitors.n, "monitors", id));
}

/* Text inside a comment must not end it. */
static const char *comment_text(Arena *a, const char *s) {
  char *t = arena_strdup(a, s);
  for (char *c = t; *c; c++)
    if (*c == '*' && c[1] == '/') c[1] = ' ';
  return t;
}

static void emit_head(const IrUnit *u, StrBuf *out) {
  sb_printf(out, "/* %s: %s\n", u->name, comment_text(u->arena, u->doc));
  sb_printf(out, " * Emitted by lagc; effects in use: %s.\n", u->effects[0] ? u->effects : "none");
  sb_printf(out, " * Accelerations: %s.\n", ops_text(u->accel, u->arena));
  sb_puts(out, " * This text may be used for any purpose without conditions (0BSD). */\n");
  sb_puts(out, "#include <math.h>\n\n#include \"lag_model.h\"\n\n");
}

void emit_model(const IrUnit *u, const char *name, StrBuf *out) {
  emit_head(u, out);
  sb_puts(out, prelude);
  if (work_size(u)) sb_puts(out, solver);
  emit_accel(u, out);
  emit_energy(u, out);
  emit_events(u, out);
  emit_inputs(u, out);
  emit_tables(u, name, out);
  for (uint32_t i = 0; i < u->scenes.n; i++) emit_scene(u, name, &u->scenes.at[i], out);
}

void emit_program(const IrUnit *const *units, const char *const *names, uint32_t n, int gsl, StrBuf *out) {
  const IrUnit *first = units[0];
  Arena *a = first->arena;
  sb_puts(out, "#include \"lag.h\"\n\n");
  uint32_t scenes = 0;
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t k = 0; k < units[i]->scenes.n; k++, scenes++)
      sb_printf(out, "extern const lag_scene %s_%s;\n", names[i], scene_id(units[i], &units[i]->scenes.at[k]));
  sb_puts(out, "\nstatic const lag_scene *const scenes[] = {\n");
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t k = 0; k < units[i]->scenes.n; k++)
      sb_printf(out, "  &%s_%s,\n", names[i], scene_id(units[i], &units[i]->scenes.at[k]));
  sb_puts(out, "};\n\n");
  const char *name = c_string(a, first->name), *doc = c_string(a, first->doc), *source = c_string(a, first->source);
  sb_printf(out, "static const lag_program program = {\n  .name = %s,\n  .doc = %s,\n  .source = %s,\n  .effects = %s,\n  .nscenes = %u, .scenes = scenes,\n};\n\n",
            name, doc, source, c_string(a, first->all_effects), scenes);
  sb_puts(out, "int main(int argc, char **argv) {\n");
  sb_printf(out, "  return lag_app_main(argc, argv, &program, %s);\n}\n", gsl ? "lag_gsl_methods, lag_gsl_nmethods" : "NULL, 0");
}
