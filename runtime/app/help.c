/* --help of a simulator: its scenes, names and options. */
#include "app/app.h"

static const char text[] =
    "\n"
    "  name=value           a parameter, the start of a coordinate (th=1.2) or of a velocity (\"th'=0.5\"), or a\n"
    "                       constant input, in its declared unit; drag.c, or c where only one ends so; m[2], or m\n"
    "                       for all of a family\n"
    "  --until T            run to time T [s]; before the start: backwards\n"
    "  --method NAME        method of integration, NAME or \"NAME(option=value, ...)\"; --method help lists them\n"
    "  --tol X              tolerance, absolute and relative\n"
    "  --step H             step [s]; the first one tried where the method chooses its own\n"
    "  -o FILE              rows of output: CSV, or NumPy when FILE ends in .npy; - is standard output\n"
    "  --every DT           time between rows [s]; default: as the scene says, or a 1000th of the span\n"
    "                       (in pictures: as many as the motion needs)\n"
    "  --events FILE        a CSV row for each event: time, event, the state before and after it\n"
    "  --section EVENT      rows, and points of pictures, each time this event happens, instead of in time\n"
    "  --tangent            more columns, dx/dy(0): the exact derivative of the state by its start\n"
    "  --svg FILE           a picture of all output against time; --plot-x NAME --plot-y NAME: one against another\n"
    "  --html FILE --points 'X,Y X,Y'   an animation of these points, X and Y names of outputs, joined by rods from\n"
    "                       --from 'X,Y' (the origin) on; --no-rods; --trace: the path of the last one\n"
    "  --sketch             a picture in the terminal\n"
    "  --json               the report as one JSON object; it also names the source of sines and cosines, and the build\n"
    "  --modes              no run, but the equilibrium next to the start, and small motion about it; with --json as one\n"
    "                       object (in simulators built with GSL, and with their linearisation: --with linear)\n"
    "  --cost               no run, but time against error: all methods, or --methods NAME,NAME, at many tolerances or\n"
    "                       steps, their errors and times; --target X names the cheapest that reaches X; --longest S;\n"
    "                       --svg FILE draws them; methods need what the model was built with (--method NAME)\n"
    "  --reference          no run, but the motion at 16 times as precisely as this program can, as text; --against FILE:\n"
    "                       --cost compares with another simulator's\n"
    "  --lyapunov           no run, but the Lyapunov exponents of the motion to --until T, 20 spans of the scene, without the first\n"
    "                       --transient T, a tenth of that; --exponents K: the largest ones; -o FILE, --svg FILE: as they\n"
    "                       settle; --json (in simulators built --with linear)\n"
    "  --quiet              no report\n"
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
  fputs(text, f);
}
