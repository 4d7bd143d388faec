/* `lagc methods` and --method help: what the descriptors of methods say, as a table and in words. */
#include "app/app.h"

/* 5, or 2-8 where options choose. */
static const char *order_text(const lag_method *m, int order, char *text, size_t size)
{
  if (m->order_most > 0) {
    snprintf(text, size, "%d-%d", m->order_least, m->order_most);
  } else {
    snprintf(text, size, "%d", order);
  }
  return text;
}

static void row(const lag_method *m, FILE *f)
{
  unsigned is = m->flags;
  char order[32], dense[32];

  fprintf(f, "  %-16s  %-5s  %-5s  %-8s  %-21s  %-16s  %-6s  %s\n", m->name, order_text(m, m->order, order, sizeof order),
          order_text(m, m->dense_order, dense, sizeof dense),
          is & LAG_METHOD_ADAPTIVE ? "adaptive" : "fixed",
          is & LAG_METHOD_SYMMETRIC ? is & LAG_METHOD_SYMPLECTIC ? "symplectic, symmetric" : "symmetric"
          : is & LAG_METHOD_SYMPLECTIC ? "symplectic" : "-",
          is & LAG_METHOD_SPLITS ? "unless separable" : is & LAG_METHOD_NEWTON ? "yes" : "no",
          is & LAG_METHOD_CONSERVATIVE ? "no" : "yes", is & LAG_METHOD_NO_STATES ? "no" : "yes");
}

static void words(const lag_method *m, FILE *f)
{
  fprintf(f, "\n  %s: %s%s\n", m->name, m->doc, m->flags & LAG_METHOD_NO_SAVE ? "; its state cannot be saved" : "");
  for (int i = 0; i < m->noptions; i++) {
    const lag_method_option *o = &m->options[i];
    char number[32];
    snprintf(number, sizeof number, "%g", o->value);
    fprintf(f, "      %s = %s: %s\n", o->name, o->choices ? o->choices[(int)o->value] : number, o->doc);
  }
}

void app_list_methods(const App *app, FILE *f)
{
  fprintf(f, "  %-16s  %-5s  %-5s  %-8s  %-21s  %-16s  %-6s  %s\n", "method", "order", "dense", "steps", "keeps", "Newton's method",
          "forces", "states");
  for (int i = 0; i < lag_nmethods + app->extras.nmethods; i++) {
    row(i < lag_nmethods ? lag_methods[i] : app->extras.methods[i - lag_nmethods], f);
  }
  fputs("\nWhere none is named, a run chooses and says why. dense: order between steps. forces: whether the model may have forces\n"
        "and explicit time; what a symplectic method keeps without them it does not keep with them. states: whether it may have\n"
        "a `state`. separable: with constant mass matrix, and accelerations that do not depend on velocities. Options, with their\n"
        "defaults:\n", f);
  for (int i = 0; i < lag_nmethods + app->extras.nmethods; i++) {
    words(i < lag_nmethods ? lag_methods[i] : app->extras.methods[i - lag_nmethods], f);
  }
}
