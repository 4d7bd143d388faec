/* A listing of a Model for --dump=model: one declaration a line, values in SI. */
#include "model/model.h"
#include "sym/print.h"

typedef struct {
  const Model *m;
  StrBuf *out;
} Dump;

static void value(const Dump *d, Expr e) {
  if (e) expr_print(d->m->g, e, PRINT_TEXT, d->out);
  else sb_puts(d->out, "-");
}

static void unit(const Dump *d, const Unit *u) {
  if (u->text[0]) sb_printf(d->out, " [%s: %.17g %s]", u->text, unit_factor(u), dim_text(d->m->dims, u->dim));
}

/* "word name [unit] = value" */
static void line(const Dump *d, const char *word, Name name, const Unit *u, Expr e) {
  sb_printf(d->out, "%s %s", word, name ? name : "-");
  if (u) unit(d, u);
  if (e) {
    sb_puts(d->out, " = ");
    value(d, e);
  }
  sb_putc(d->out, '\n');
}

static void event(const Dump *d, const Event *ev) {
  static const char *const ways[] = {"crossing", "rising", "falling"};
  sb_printf(d->out, "event %s: ", ev->name);
  value(d, ev->g);
  sb_printf(d->out, " %s\n", ways[ev->direction]);
  for (uint32_t i = 0; i < ev->actions.n; i++) line(d, "  set", expr_symbol(d->m->g, ev->actions.at[i].target)->name, NULL, ev->actions.at[i].value);
  if (ev->stop) sb_puts(d->out, "  stop\n");
}

/* One line per map: the coordinate and its first-order rate. */
static void symmetry(const Dump *d, const Symmetry *y) {
  sb_printf(d->out, "symmetry %s(%s)\n", y->name, expr_symbol(d->m->g, y->parameter)->name);
  for (uint32_t i = 0; i < y->moves.n; i++) line(d, "  rate of", expr_symbol(d->m->g, y->moves.at[i].target)->name, NULL, y->moves.at[i].rate);
}

static void scene(const Dump *d) {
  const Scene *s = &d->m->scene;
  sb_printf(d->out, "scene %s: t = %.17g .. %.17g", s->name, s->t0, s->t1);
  if (s->method) sb_printf(d->out, ", method %s", s->method);
  if (s->tolerance > 0) sb_printf(d->out, ", tolerance %.17g", s->tolerance);
  if (s->every > 0) sb_printf(d->out, ", every %.17g", s->every);
  sb_putc(d->out, '\n');
  for (uint32_t i = 0; i < s->starts.n; i++) line(d, "  start", expr_symbol(d->m->g, s->starts.at[i].target)->name, NULL, s->starts.at[i].value);
  for (uint32_t i = 0; i < s->outputs.n; i++) line(d, "  output", s->outputs.at[i].name, &s->outputs.at[i].unit, s->outputs.at[i].value);
  for (uint32_t i = 0; i < s->exacts.n; i++) line(d, "  exact", s->exacts.at[i].name, &s->exacts.at[i].unit, s->exacts.at[i].value);
  for (uint32_t i = 0; i < s->monitors.n; i++) sb_printf(d->out, "  monitor %s %.17g\n", s->monitors.at[i].name, s->monitors.at[i].limit);
}

void model_dump(const Model *m, StrBuf *out) {
  Dump d = {m, out};
  sb_printf(out, "model %s\n", m->name);
  for (uint32_t i = 0; i < m->effects.n; i++) sb_printf(out, "effect %s\n", m->effects.at[i]);
  for (uint32_t i = 0; i < m->coords.n; i++) line(&d, m->coords.at[i].periodic ? "periodic coord" : "coord", m->coords.at[i].name, &m->coords.at[i].unit, 0);
  for (uint32_t i = 0; i < m->states.n; i++) line(&d, "flow", m->states.at[i].name, &m->states.at[i].unit, m->states.at[i].flow);
  for (uint32_t i = 0; i < m->params.n; i++) line(&d, "param", m->params.at[i].name, &m->params.at[i].unit, m->params.at[i].value);
  for (uint32_t i = 0; i < m->inputs.n; i++) {
    const Input *in = &m->inputs.at[i];
    line(&d, "input", in->name, &in->unit, in->value);
    if (in->table) sb_printf(out, "  table \"%s\": %u rows\n", in->file, in->table->n);
  }
  if (m->lagrangian) line(&d, "lagrangian", "L", NULL, m->lagrangian);
  if (m->dissipation) line(&d, "dissipation", "R", NULL, m->dissipation);
  for (uint32_t i = 0; i < m->forces.n; i++) {
    sb_puts(out, "force along ");
    value(&d, m->forces.at[i].point);
    line(&d, ":", "F", NULL, m->forces.at[i].f);
  }
  for (uint32_t i = 0; i < m->symmetries.n; i++) symmetry(&d, &m->symmetries.at[i]);
  for (uint32_t i = 0; i < m->events.n; i++) event(&d, &m->events.at[i]);
  for (uint32_t i = 0; i < m->observes.n; i++) line(&d, "observe", m->observes.at[i].name, &m->observes.at[i].unit, m->observes.at[i].value);
  scene(&d);
}
