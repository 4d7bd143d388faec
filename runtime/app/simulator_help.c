/* Help of a simulator. --help: its scenes, names and options. `lagc methods` and --method help: the descriptors of
 * all methods as a table and in words; `--method "help NAME"`: of one. Holds: lines about methods have at most 80
 * columns. */
#include <string.h>

#include "app/app.h"

static const char value_words[] =
    "\n"
    "  name=value            a parameter, the start of a coordinate (th=1.2) or of a\n"
    "                        velocity (\"th'=0.5\"), or a constant input, in its\n"
    "                        declared unit; drag.c, or c where only one ends so;\n"
    "                        m[2], or m for all of a family\n";
static const char file_words[] =
    "\n"
    "Rows appear as FILE.part-N-M until they are complete. Ctrl-C, or SIGTERM,\n"
    "finishes the step and writes what was computed; a resumed run writes the rows\n"
    "after the saved time. Exit status: 0 ok, 2 wrong usage or a file that cannot be\n"
    "written, 3 the run failed, 130 interrupted (by SIGTERM 143).\n";

/* A line of variables with units and, unless NULL, values in declared units. */
static void list(FILE *f, const char *head, int n, const lag_var *vars, const double *values) {
  for (int i = 0; i < n; i++) {
    fprintf(f, "%s%s", i == 0 ? head : ", ", vars[i].name);
    if (values) fprintf(f, " = %g", (values[i] - vars[i].offset) / vars[i].factor);
    if (vars[i].unit[0]) fprintf(f, " [%s]", vars[i].unit);
  }
  if (n) putc('\n', f);
}

enum { WIDTH = 80 };
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

static void put_option(FILE *f, const Option *o) {
  enum { MEANINGS = 24 };
  char line[600], term[64];
  snprintf(term, sizeof term, "%s%s%s%s%s", o->brief ? o->brief : "", o->brief ? ", " : "", o->name,
           o->value ? " " : "", o->value ? o->value : "");
  int fits = strlen(term) < MEANINGS - 2;
  if (fits) snprintf(line, sizeof line, "%-*s%s", MEANINGS - 2, term, o->text);
  else fprintf(f, "  %s\n", term);
  wrapped(f, fits ? line : o->text, fits ? 2 : MEANINGS, MEANINGS);
}

/* The options of runs; each analysis that stands in the place of a run, with the options that runs do not have. */
static void put_options(FILE *f) {
  const Option *o;
  for (int i = 0; (o = lag_args_option(i)) != NULL; i++)
    if (o->text && o->analyses & RUN && o->analyses != ANY) put_option(f, o);
  for (int i = 0; (o = lag_args_option(i)) != NULL; i++) {
    if (!o->text || o->analyses != ANY) continue;
    unsigned analysis = lag_args_analysis_named(o->name) & ~(unsigned)REFERENCE; /* its options are those of --cost */
    if (analysis) putc('\n', f);
    put_option(f, o);
    for (int k = 0; analysis && lag_args_option(k); k++) {
      const Option *with = lag_args_option(k);
      if (with->text && with->analyses & analysis && !(with->analyses & RUN)) put_option(f, with);
    }
  }
}

void lag_app_help(const App *app, FILE *f) {
  const lag_program *p = app->program;
  fprintf(f, "%s: %s\n\nusage: %s [SCENE] [name=value ...] [options]\n\nscenes (the first is the default):\n", p->name,
          p->doc ? p->doc : "", app->args.self);
  for (int i = 0; i < p->nscenes; i++)
    fprintf(f, "  %-20s %s\n", p->scenes[i]->name, p->scenes[i]->doc ? p->scenes[i]->doc : "");
  lag_sim *sim = lag_sim_new(p->scenes[0]);
  if (sim) {
    const lag_model *m = p->scenes[0]->model;
    list(f, "\ncoordinates: ", m->nq, m->q, NULL);
    list(f, "states: ", m->nz, m->z, NULL);
    list(f, "parameters: ", m->np, m->p, lag_sim_p(sim));
    list(f, "inputs: ", m->nu, m->u, NULL);
    lag_sim_free(sim);
  }
  fprintf(f, "%s%s\n", p->build ? "\nbuilt by: " : "", p->build ? p->build : "");
  if (p->nscenes > 0 && p->scenes[0]->model->math) fprintf(f, "%s\n", p->scenes[0]->model->math);
  fputs(value_words, f);
  put_options(f);
  fputs(file_words, f);
}

/* ---- Methods */

#define ROW "  %-16s %-5s %-5s %-5s %-10s %-6s %-6s %-5s %s\n"

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
  snprintf(text, sizeof text, "%s: %s%s", m->name, m->doc,
           m->flags & LAG_METHOD_NO_SAVE ? "; its state cannot be saved" : "");
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
  wrapped(f,
          "Where none is named, a run chooses and says why. dense: order between steps. both: symplectic and "
          "symmetric; with forces or explicit time a "
          "symplectic method keeps neither energy nor the two-form. Newton: whether each step solves "
          "equations by Newton's method; partly: unless the model is separable, with constant mass matrix, and "
          "accelerations that do not "
          "depend on velocities. states: whether the model may have a `state`; alone: without coordinates, or where L "
          "is linear in "
          "all velocities. deriv: whether its steps have a derivative (--tangent, lagc lyapunov). holds: whether its "
          "steps end on "
          "constraints. Options, with their defaults:",
          0, 0);
  for (int i = 0; (m = lag_app_method_at(app, i)) != NULL; i++)
    if (!name || strcmp(name, m->name) == 0) words(m, f);
}
