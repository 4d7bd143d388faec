/* A scene of the emitted model file: functions of its parameters, start, outputs and closed forms, then its tables. */
#include <string.h>

#include "emit/emit_impl.h"
#include "ir/roll.h"

/* Whether a store is of a constant; *n: which. */
static int is_constant(const Prog *p, const Store *x, Num *n) {
  const Ins *i = &p->ins.at[x->slot];
  *n = x->slot ? i->number : num_int(0);
  return !x->slot || i->op == IR_CONST;
}

enum { MANY = 16 }; /* stores that are a loop of their own */

/* Number of stores from k on that are constants of neighbouring elements, up to the next loop. */
static uint32_t constants_from(const Prog *p, uint32_t k) {
  const Store *x = p->stores.at + k;
  uint32_t n = 0;
  Num value;
  while (k + n < p->stores.n && x[n].array == x[0].array && x[n].index == x[0].index + n &&
         is_constant(p, &x[n], &value) && (!n || roll_constants(p, k + n) < MANY))
    n++;
  return n;
}

static void constant_table(const ModelFile *f, const Prog *p, const Store *x, uint32_t n, const CStyle *style) {
  enum { A_LINE = 6 };
  const char *to = style->out[x->array];
  sb_printf(f->out, "  static const LAG_LANE %s_%u[] = {", to, x->index);
  for (uint32_t i = 0; i < n; i++) {
    Num value;
    is_constant(p, &x[i], &value);
    sb_printf(f->out, "%s%s,", i % A_LINE ? " " : "\n    ", c_number_by(f->a, "LAG_NUMBER", value));
  }
  const char *first = comment_text(f->a, x->comment), *last = comment_text(f->a, x[n - 1].comment);
  sb_printf(f->out, "\n  };\n  /* %s ... %s */\n", first, last);
  const char *shift = x->index ? arena_printf(f->a, " + %u", x->index) : "";
  const char *guard = style->guard ? arena_printf(f->a, "if (!%s[i%s]) ", style->guard, shift) : "";
  sb_printf(f->out, "  for (int i = 0; i < %u; i++) %s%s[i%s] = LAG_C(0.0) + %s_%u[i];\n", n, guard, to, shift, to,
            x->index);
}

/* Writes long runs of constants as tables, which C compilers read in linear time; returns the other stores, and
 * those that are even: loops write them. */
static Prog constant_tables(const ModelFile *f, const Prog *p, const CStyle *style) {
  enum { LONG = 1000 };
  Prog rest = *p;
  memset(&rest.stores, 0, sizeof rest.stores);
  for (uint32_t k = 0; k < p->stores.n;) {
    const Store *x = &p->stores.at[k];
    uint32_t even = roll_constants(p, k), n = even >= MANY ? even : constants_from(p, k);
    int is_table = n >= LONG && n > even;
    if (is_table) constant_table(f, p, x, n, style);
    for (uint32_t i = 0; !is_table && i < (n ? n : 1); i++) vec_push(f->a, &rest.stores, x[i]);
    k += n ? n : 1;
  }
  return rest;
}

/* Function params_ID: parameters in order, as each formula may use the parameters before it. */
static void emit_params(const ModelFile *f, const IrScene *s, const char *id) {
  static const char *const own[] = {"self", "p", "fixed", NULL}, *const written[] = {"p"};
  sb_printf(f->out, "\nstatic void params_%s(const void *self, LAG_REAL *p, const unsigned char *fixed) {\n", id);
  sb_puts(f->out, f->u->p.n ? "  (void)self;\n" : "  (void)self; (void)p; (void)fixed;\n");
  CStyle st = model_style(f, own, written);
  st.guard = "fixed";
  for (uint32_t i = 0; i < s->params.n; i++) {
    Prog rest = constant_tables(f, s->params.at[i].values, &st);
    cwrite_params(&(IrParams){s->params.at[i].first, s->params.at[i].n, &rest}, st, f->a, f->out);
  }
  sb_puts(f->out, f->u->nderived ? "  derive(NULL, p);\n}\n" : "}\n");
}

static void emit_start(const ModelFile *f, const IrScene *s, const char *id) {
  static const char *const own[] = {"self", "p", "q", "v", "z", NULL}, *const written[] = {"q", "v", "z"};
  CStyle st = model_style(f, own, written);
  sb_printf(f->out,
            "\nstatic void start_%s(const void *self, const LAG_REAL *p, LAG_REAL *q, LAG_REAL *v, LAG_REAL *z) {\n",
            id);
  sb_puts(f->out, "  (void)self; (void)p; (void)q; (void)v; (void)z;\n");
  if (f->u->q.n) sb_printf(f->out, "  for (int i = 0; i < %u; i++) q[i] = v[i] = LAG_C(0.0);\n", f->u->q.n);
  if (f->u->z.n) sb_printf(f->out, "  for (int i = 0; i < %u; i++) z[i] = LAG_C(0.0);\n", f->u->z.n);
  st.prefer_short_code = 1;
  Prog rest = constant_tables(f, s->start, &st);
  cwrite_body(&rest, &st, f->a, f->out);
  sb_puts(f->out, "}\n");
}

/* Function of the closed forms; its arguments q0, v0, z0 are the state at the start. */
static void emit_exact(const ModelFile *f, const IrScene *s, const char *id) {
  static const char *const own[] = {"self", "t", "q0", "v0", "z0", "p", "u", "out", NULL}, *const written[] = {"out"};
  static const char *const from_start[ARR_COUNT] = {"t", "q0", "v0", "z0", "p", "u", "a"};
  if (!s->exact_of.n) return;
  CStyle st = model_style(f, own, written);
  st.in = from_start;
  CFunction c = {.comment = arena_printf(f->a, "The closed forms of the scene %s.", s->name), .returns = 1};
  c.head = arena_printf(f->a,
                        "static int exact_%s(const void *self, LAG_REAL t, const LAG_REAL *q0, const LAG_REAL *v0,\n"
                        "    const LAG_REAL *z0, const LAG_REAL *p, const LAG_REAL *u, LAG_REAL *out)",
                        id);
  cfunction(s->exact, &st, &c, f->out);
  sb_printf(f->out, "\nstatic const int exact_of_%s[] = {", id);
  for (uint32_t i = 0; i < s->exact_of.n; i++) sb_printf(f->out, "%s%u", i ? ", " : "", s->exact_of.at[i]);
  sb_puts(f->out, "};\n");
}

/* Outputs with action variables: their curves, and a function that puts their values behind those in u. Rows of
 * output have no lanes. */
static void emit_observe(const ModelFile *f, const IrScene *s, const char *id) {
  const ProgramSet *u = f->u;
  StrBuf *out = f->out;
  const char *comment = arena_printf(f->a, "Outputs of the scene %s.", s->name);
  uint32_t n = u->u.n + u->nmodes + s->exact_of.n;
  if (!s->actions.n) {
    state_function(f, s->observe, arena_printf(f->a, "observe_%s", id), comment, "", "out");
    return;
  }
  sb_puts(out, "\n#ifndef LAG_LANES");
  state_function(f, s->momenta, arena_printf(f->a, "momenta_%s", id), "The momenta dL/dq'.", "", "out");
  for (uint32_t i = 0; i < s->actions.n; i++) {
    const IrAction *a = &s->actions.at[i];
    const char *what = s->momenta ? "H, dH/dp, d2H/dp2, dH/dq for the action of %s; v holds momenta."
                                  : "H, dH/dp, d2H/dp2, dH/dq for the action of %s.";
    state_function(f, a->curve, arena_printf(f->a, "curve_%s_%u", id, i), arena_printf(f->a, what, a->name), "", "out");
  }
  state_function(f, s->observe, arena_printf(f->a, "values_%s", id),
                 arena_printf(f->a, "%s Action variables stand behind the inputs.", comment), "", "out");
  sb_printf(
      out,
      "\nstatic int observe_%s(const void *self, LAG_REAL t, const LAG_REAL *q, const LAG_REAL *v, const LAG_REAL *z,\n"
      "    const LAG_REAL *p, const LAG_REAL *u, LAG_REAL *out, LAG_REAL *w) {\n",
      id);
  sb_printf(out, "  LAG_REAL with[%u], y[%u];\n", n + s->actions.n, 2 * u->q.n + u->z.n);
  if (n) sb_printf(out, "  for (int i = 0; i < %u; i++) with[i] = u[i];\n", n);
  for (uint32_t i = 0; i < s->actions.n; i++) {
    const IrAction *a = &s->actions.at[i];
    sb_printf(out, "  static const lag_action_curve of_%u = {%u, %u, %u, %u, %d, curve_%s_%u, %s%s};\n", i, u->q.n,
              u->z.n, a->q, a->p, a->periodic, id, i, s->momenta ? "momenta_" : "NULL", s->momenta ? id : "");
    sb_printf(out, "  with[%u] = lag_action(&of_%u, t, q, v, z, p, u, y, w);\n", n + i, i);
  }
  sb_printf(out, "  return values_%s(self, t, q, v, z, p, with, out, w);\n}\n#else\n#define observe_%s NULL\n#endif\n",
            id, id);
}

static void emit_scene_lists(const ProgramSet *u, const IrScene *s, const char *id, StrBuf *fill, StrBuf *out) {
  table_vars(arena_printf(u->arena, "outputs_%s", id), s->outputs.at, s->outputs.n, fill, u->arena, out);
  if (s->options.n) {
    sb_printf(out, "\nstatic const lag_option options_%s[] = {\n", id);
    vec_each(const IrOption, o, s->options) {
      sb_printf(out, "  {%s, %s, %s},\n", c_string(u->arena, o->name), table_number(u->arena, o->value, NULL),
                o->text ? c_string(u->arena, o->text) : "NULL");
    }
    sb_puts(out, "};\n");
  }
  if (s->monitors.n) {
    sb_printf(out, "\nstatic const lag_monitor monitors_%s[] = {\n", id);
    vec_each(const IrMonitor, m, s->monitors) {
      sb_printf(out, "  {%s, %d, %s, %d},\n", c_string(u->arena, m->name), m->output,
                table_number(u->arena, m->limit, NULL), m->absolute);
    }
    sb_puts(out, "};\n");
  }
}

static void emit_measures(const ProgramSet *u, const IrScene *s, const char *id, StrBuf *out) {
  if (!s->measures.n) return;
  sb_printf(out, "\nstatic const lag_measure measures_%s[] = {\n", id);
  vec_each(const IrMeasure, m, s->measures)
    sb_printf(out, "  {%s, %s},\n", c_string(u->arena, m->name), c_string(u->arena, m->text));
  sb_puts(out, "};\n");
}

static void emit_indices(const char *name, const int *at, int n, StrBuf *out) {
  sb_printf(out, ", .%s = {", name);
  for (int i = 0; i < n; i++) sb_printf(out, "%s%d", i ? ", " : "", at[i]);
  sb_putc(out, '}');
}

static void emit_shapes(const ProgramSet *u, const IrScene *s, const char *id, StrBuf *out) {
  if (!s->shapes.n) return;
  sb_printf(out, "\nstatic const lag_shape shapes_%s[] = {\n", id);
  vec_each(const IrShape, x, s->shapes) {
    sb_printf(out, "  {%s, %s, ", c_string(u->arena, x->kind), c_string(u->arena, x->role));
    sb_printf(out, "%s, .count = %d", x->text ? c_string(u->arena, x->text) : "NULL", x->count);
    emit_indices("a", x->a, 3, out);
    emit_indices("b", x->b, 3, out);
    emit_indices("size", x->size, 3, out);
    emit_indices("turn", x->turn, 4, out);
    sb_puts(out, "},\n");
  }
  sb_puts(out, "};\n");
}

static void emit_flags(const char *stem, const char *id, const unsigned char *flags, uint32_t n, StrBuf *out) {
  sb_printf(out, "\nstatic const unsigned char %s_%s[] = {", stem, id);
  for (uint32_t i = 0; i < n; i++) sb_printf(out, "%s%d", i ? ", " : "", flags[i]);
  sb_puts(out, "};\n");
}

const unsigned char *scene_given(const ProgramSet *u, const IrScene *s) {
  uint32_t n = u->q.n, after[] = {0, n, 2 * n};
  unsigned char *given = ARENA_ARRAY(u->arena, unsigned char, 2 * n + u->z.n);
  for (uint32_t k = 0; k < s->start->stores.n; k++)
    given[after[s->start->stores.at[k].array] + s->start->stores.at[k].index] = 1;
  for (uint32_t k = 0; k < s->implied.n; k++) given[s->implied.at[k]] = 2;
  return given;
}

/* Whether an output of the scene contains forces. */
static int has_forces(const IrScene *s) { return s->forces.n && memchr(s->forces.at, 1, s->forces.n); }

static const char *list_name(const ProgramSet *u, uint32_t n, const char *stem, const char *id) {
  return n ? arena_printf(u->arena, "%s_%s", stem, id) : "NULL";
}

void emit_scene(const ModelFile *f, const char *name, uint32_t index) {
  const ProgramSet *u = f->u;
  const IrScene *s = &u->scenes.at[index];
  const char *id = scene_id(u, index);
  StrBuf *out = f->out;
  emit_params(f, s, id);
  emit_start(f, s, id);
  emit_observe(f, s, id);
  emit_exact(f, s, id);
  emit_scene_lists(u, s, id, f->fill, out);
  emit_measures(u, s, id, out);
  emit_shapes(u, s, id, out);
  if (u->constraints.of.n) emit_flags("given", id, scene_given(u, s), 2 * u->q.n + u->z.n, out);
  if (has_forces(s)) emit_flags("forces", id, s->forces.at, s->forces.n, out);
  sb_printf(out, "\nconst lag_scene %s_%s = {\n", name, id);
  sb_printf(out, "  .name = %s,\n  .doc = %s,\n", c_string(u->arena, s->name), c_string(u->arena, s->doc));
  sb_printf(out, "  .model = &%s,\n  .params = params_%s, .start = start_%s,\n", name, id, id);
  if (u->constraints.of.n) sb_printf(out, "  .given = given_%s, .exactly = %d,\n", id, s->exactly);
  sb_printf(out, "  .t0 = %s, .t1 = %s, .has_span = %d,\n", table_number(u->arena, s->t0, NULL),
            table_number(u->arena, s->t1, s->t1_digits), s->has_span);
  sb_printf(out, "  .method = %s, .noptions = %u, .options = %s,\n", s->method ? c_string(u->arena, s->method) : "NULL",
            s->options.n, list_name(u, s->options.n, "options", id));
  sb_printf(out, "  .tolerance = %s,\n", table_number(u->arena, s->tolerance, NULL));
  sb_printf(out, "  .nout = %u, .outputs = %s,\n", s->outputs.n, list_name(u, s->outputs.n, "outputs", id));
  if (has_forces(s)) sb_printf(out, "  .forces = forces_%s,\n", id);
  sb_printf(out, "  .every = %s, .observe = observe_%s,\n", table_number(u->arena, s->every, NULL), id);
  sb_printf(out, "  .nmonitors = %u, .monitors = %s,\n", s->monitors.n, list_name(u, s->monitors.n, "monitors", id));
  if (s->exact_of.n)
    sb_printf(out, "  .nexact = %u, .exact_of = exact_of_%s, .exact = exact_%s,\n", s->exact_of.n, id, id);
  if (s->measures.n) sb_printf(out, "  .nmeasures = %u, .measures = measures_%s,\n", s->measures.n, id);
  if (s->shapes.n)
    sb_printf(out, "  .ndrawn = %u, .nshapes = %u, .shapes = shapes_%s,\n", s->ndrawn, s->shapes.n, id);
  sb_puts(out, "};\n");
}
