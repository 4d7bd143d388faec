/* `lagc methods` and --method help: the descriptors of all methods as a table and in words; `--method "help NAME"`: of
 * one. Holds: lines have at most 80 columns. */
#include <string.h>

#include "app/app.h"

enum { WIDTH = 80 };
#define ROW "  %-16s %-5s %-5s %-5s %-10s %-6s %-6s %-5s %s\n"

/* Prints text wrapped to WIDTH columns; the first line is indented by `first`, the others by `indent`. */
static void wrapped(FILE *f, const char *text, int first, int indent) {
  int column = fprintf(f, "%*s", first, "");
  for (int fresh = 1; *text; fresh = 0) {
    int n = (int)strcspn(text, " ");
    if (!fresh && column + 1 + n > WIDTH) column = fprintf(f, "\n%*s", indent, "") - 1;
    else if (!fresh) column += fprintf(f, " ");
    column += fprintf(f, "%.*s", n, text);
    text += n + (text[n] == ' ');
  }
  putc('\n', f);
}

/* text := the order, "5", or "2-8" where options choose it. */
static const char *order_text(const lag_method *m, int order, char *text, size_t size) {
  if (m->order_most > 0) snprintf(text, size, "%d-%d", m->order_least, m->order_most);
  else snprintf(text, size, "%d", order);
  return text;
}

static void row(const lag_method *m, FILE *f) {
  unsigned is = m->flags;
  char order[32], dense[32];
  fprintf(f, ROW, m->name, order_text(m, m->order, order, sizeof order),
          order_text(m, m->dense_order, dense, sizeof dense),
          is & LAG_METHOD_ADAPTIVE ? "adapt" : "fixed",
          is & LAG_METHOD_SYMMETRIC ? is & LAG_METHOD_SYMPLECTIC ? "both" : "symmetric"
          : is & LAG_METHOD_SYMPLECTIC ? "symplectic" : "-",
          is & LAG_METHOD_SPLITS ? "partly" : is & LAG_METHOD_NEWTON ? "yes" : "no",
          is & LAG_METHOD_FLOWS ? "alone" : is & LAG_METHOD_NO_STATES ? "no" : "yes",
          m->tangent ? "yes" : "no", is & LAG_METHOD_CONSTRAINTS ? "yes" : "no");
}

static void words(const lag_method *m, FILE *f) {
  char text[400];
  snprintf(text, sizeof text, "%s: %s%s", m->name, m->doc, m->flags & LAG_METHOD_NO_SAVE ? "; its state cannot be saved" : "");
  putc('\n', f);
  wrapped(f, text, 2, 4);
  for (int i = 0; i < m->noptions; i++) {
    const lag_method_option *o = &m->options[i];
    char number[32];
    snprintf(number, sizeof number, "%g", o->value);
    snprintf(text, sizeof text, "%s = %s: %s", o->name, o->choices ? o->choices[(int)o->value] : number, o->doc);
    wrapped(f, text, 6, 8);
  }
}

void lag_app_list_methods(const App *app, const char *name, FILE *f) {
  const lag_method *m;
  fprintf(f, ROW, "method", "order", "dense", "steps", "keeps", "Newton", "states", "deriv", "holds");
  for (int i = 0; (m = lag_app_method_at(app, i)) != NULL; i++)
    if (!name || strcmp(name, m->name) == 0) row(m, f);
  putc('\n', f);
  wrapped(f, "Where none is named, a run chooses and says why. dense: order between steps. both: symplectic and symmetric; with forces or explicit time a "
             "symplectic method keeps neither energy nor the two-form. Newton: whether each step solves "
             "equations by Newton's method; partly: unless the model is separable, with constant mass matrix, and accelerations that do not "
             "depend on velocities. states: whether the model may have a `state`; alone: without coordinates, or where L is linear in "
             "all velocities. deriv: whether its steps have a derivative (--tangent, lagc lyapunov). holds: whether its steps end on "
             "constraints. Options, with their defaults:", 0, 0);
  for (int i = 0; (m = lag_app_method_at(app, i)) != NULL; i++)
    if (!name || strcmp(name, m->name) == 0) words(m, f);
}
