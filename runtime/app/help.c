/* Help of a simulator. --help: its scenes, names and options. `lagc methods` and --method help: the descriptors of all methods as a table and in
 * words; `--method "help NAME"`: of one. Holds: lines about methods have at most 80 columns. */
#include <string.h>

#include "app/app.h"

static const char usage[] =
    "\n"
    "  name=value           a parameter, the start of a coordinate (th=1.2) or of a velocity (\"th'=0.5\"), or a\n"
    "                       constant input, in its declared unit; drag.c, or c where only one ends so; m[2], or m\n"
    "                       for all of a family\n"
    "  --until T            run to time T [s]; before the start: backwards\n"
    "  --method NAME        method of integration, NAME or \"NAME(option=value, ...)\"; --method help lists them\n"
    "  --tol X              tolerance, absolute and relative\n"
    "  --accuracy X         the method and tolerance with which the error at all times is below X, relative\n"
    "                       to the largest value of its kind and unit\n"
    "  --step H             step [s]; the first one tried where the method chooses its own\n"
    "  -o FILE              rows of output: CSV, or NumPy when FILE ends in .npy; - is standard output\n"
    "  --every DT           time between rows [s]; default: as the scene says, or a 1000th of the span\n"
    "                       (in pictures: as many as the motion needs)\n"
    "  --skip T             rows, pictures and measures begin at time T [s]: without the transient\n"
    "  --events FILE        a CSV row for each event: time, event, the state before and after it\n"
    "  --section EVENT      rows, and points of pictures, each time this event happens, instead of in time\n"
    "  --measure WORDS      a number of the run, as lagc compiles it: 'x max()', '3 hit(EVENT)', 'x 10 at()'; or NAME=WORDS; repeatable\n"
    "  --tangent            more columns, dx/dy(0): the exact derivative of the state by its start\n"
    "  --volume             the volume of phase space along the run, by the determinant of that derivative\n"
    "  --svg FILE           a picture of all output against time; --plot-x NAME --plot-y NAME: one against another\n"
    "  --cloud N            with --plot-x X --plot-y Y: N starts around the scene's, at several times, by each method\n"
    "  --portrait           with --plot-x X --plot-y \"X'\": level curves of the energy; --potential, with --plot-y energy: the potential\n"
    "  --energy-error       the picture shows |E/E(0) - 1| (--plot-y energy); --distance: of several runs, from the first\n"
    "  --vs name=value      another run in the picture; it also shows several SCENEs, and those of --method NAME,NAME\n"
    "  --starts name=A..B:N a run for each value of the range, in one picture, coloured by it, as for sections\n"
    "  --html FILE --points 'X,Y X,Y'   an animation of these points, X and Y names of outputs, joined by rods from\n"
    "                       --from 'X,Y' (the origin) on; --no-rods; --trace: the path of the last one\n"
    "  --sketch             a picture in the terminal\n"
    "  --json               the report as one JSON object; it also names the source of sines and cosines, and the build\n";
static const char more_usage[] =
    "  --modes              no run, but the equilibrium next to the start, and small motion about it; with --json as one\n"
    "                       object (in simulators built with GSL, and with their linearisation: --with linear); --steady:\n"
    "                       about the steady motion next to the start, in place of rest\n"
    "  --cost               no run, but time against error: all methods, or --methods NAME,NAME, at many tolerances or\n"
    "                       steps, their errors and times, in --seconds S, 10 by default; --target X names the cheapest that\n"
    "                       reaches X; --all: every method, --runs: every run; -o FILE.svg draws them, .csv and .json hold\n"
    "                       all runs; --sketch; --realtime H: methods of equal steps, with steps of H [s]; --error NAME: of this\n"
    "                       output, or final: of the state at the end, or residual, instead of the state at 16 times; methods need what the model was built with (--method NAME)\n"
    "  --where              with --cost: shares of the time of one run, the scene's or that of --method, --tol, --step; Linux\n"
    "  --reference          no run, but the motion at 16 times as precisely as this program can, as text; --against FILE:\n"
    "                       --cost compares with another simulator's\n"
    "  --sweep              many runs, one for each combination of name=FIRST..LAST:NUMBER, FIRST..LAST:log:NUMBER, A,B,C (--zip:\n"
    "                       together), of --rows FILE.csv, and of --samples N of name~normal(MEAN, DEVIATION) or ~uniform(A, B), by\n"
    "                       --sampling random|lhs|sobol|halton and --seed K; -o FILE gets a row each, with every --measure; --svg FILE;\n"
    "                       --histogram N: how many runs lie in each of N parts of a measure's range; --threads N;\n"
    "                       --lanes 1|4|8: runs at once in vectors (in simulators of lagc sweep);\n"
    "                       --motions FILE: their rows, .csv, .npy or .h5, every --every DT;\n"
    "                       --mpi K: K processes (in simulators that lagc sweep --mpi makes);\n"
    "                       --resume: goes on after an interruption; --shard I/N: part I of N, --merge N: joins them;\n"
    "                       --yes: begins what takes more than a day or 10 GB\n"
    "  --lyapunov           no run, but the Lyapunov exponents of the motion to --until T, 20 spans of the scene, without the first\n"
    "                       --transient T, a tenth of that; --exponents K: the largest ones; -o FILE, --svg FILE: as they\n"
    "                       settle; --json (in simulators built --with linear)\n"
    "  --quiet              no report\n"
    "  --no-monitors        no monitor of the scene ends the run\n"
    "  --save-state FILE    write the complete state at the end; --resume FILE goes on from there, with the same\n"
    "                       scene, method and values, which may be given again: results are those of an uninterrupted run, bit by bit.\n"
    "                       A resumed run writes the rows after the saved time (a run that ends between two rows\n"
    "                       writes one more at its end)\n"
    "\n"
    "Rows appear as FILE.part-N-M until they are complete. Ctrl-C, or SIGTERM, finishes the step and writes what was\n"
    "computed. Exit status: 0 ok, 2 wrong usage or a file that cannot be written, 3 the run failed, 130 interrupted\n"
    "(by SIGTERM 143).\n";

/* A line of variables with units and, unless NULL, values in declared units. */
static void list(FILE *f, const char *head, int n, const lag_var *vars, const double *values) {
  for (int i = 0; i < n; i++) {
    fprintf(f, "%s%s", i == 0 ? head : ", ", vars[i].name);
    if (values) fprintf(f, " = %g", (values[i] - vars[i].offset) / vars[i].factor);
    if (vars[i].unit[0]) fprintf(f, " [%s]", vars[i].unit);
  }
  if (n) putc('\n', f);
}

void lag_app_help(const App *app, FILE *f) {
  const lag_program *p = app->program;
  fprintf(f, "%s: %s\n\nusage: %s [SCENE] [name=value ...] [options]\n\nscenes (the first is the default):\n", p->name,
          p->doc ? p->doc : "", app->args.self);
  for (int i = 0; i < p->nscenes; i++) fprintf(f, "  %-20s %s\n", p->scenes[i]->name, p->scenes[i]->doc ? p->scenes[i]->doc : "");
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
  fputs(usage, f);
  fputs(more_usage, f);
}

/* ---- Methods */

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
