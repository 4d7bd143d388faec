#include "cli/options.h"

#include <string.h>

#include "base/suggest.h"

static const struct {
  const char *name;
  Command command;
  const char *usage; /* one line */
  const char *help;
} commands[] = {
  {"check", CMD_CHECK, "lagc check MODEL [SCENE] [--allow-numeric]",
   "Parses and derives the model for every scene (or the one named), and proves or refutes its\n"
   "`expect` lines. Exit status 0 when all is well, 1 when not.\n\n"
   "  --allow-numeric   an expectation that is not decided by the prover, but agrees numerically,\n"
   "                    does not fail the check\n"},
  {"derive", CMD_DERIVE, "lagc derive MODEL [SCENE] [--format text|latex|c] [--ops] [-o FILE]",
   "Prints the equations of motion: momenta, M q'' = f, energy, and the operation count.\n\n"
   "  --format latex    as LaTeX\n"
   "  --format c        the C function that computes the accelerations\n"
   "  --ops             the operation counts only\n"},
  {"emit", CMD_EMIT, "lagc emit MODEL [SCENE] [--method NAME] [--with linear] -o FILE.c",
   "Writes C for the runtime: a `const lag_model` and a `const lag_scene` (see lag_model.h).\n\n"
   "  --method NAME     with what this method needs of the model besides accelerations\n"
   "  --with linear     with the exact linearisation of the model\n"},
  {"header", CMD_HEADER, "lagc header MODEL [SCENE] -o FILE.h",
   "Writes one self-contained C99/C++ header to embed: parameters as a struct, accelerations,\n"
   "energy, an RK4 step. It includes nothing but <math.h>. Its names begin with the file's: pend.h has\n"
   "PEND_IMPLEMENTATION and pend_accel.\n"},
  {"build", CMD_BUILD, "lagc build MODEL -o SIMULATOR [--method NAME] [--with linear] [--no-gsl]",
   "Compiles the model to a simulator with all its scenes; `SIMULATOR --help` lists its options.\n\n"
   "  --method NAME     with what this method needs of the model besides accelerations: variational, gauss,\n"
   "                    radau, taylor, or verlet of a model that is not separable. The scenes' own methods need no mention\n"
   "  --with linear     with the exact linearisation of the model\n"
   "  --no-gsl          leave the gsl-* methods out: a binary that links GSL is GPL-3 as a whole\n"},
  {"run", CMD_RUN, "lagc run MODEL [SCENE] [name=value ...] [--method M] [--tol X] [--until T] ...",
   "Builds the simulator (or takes it from the cache) and runs it; the options are the simulator's:\n\n"
   "  name=value        a parameter, a start value (th=1.2, \"th'=0.5\") or an input\n"
   "  --method NAME     rk45, dop853, taylor, verlet4, gsl-rk8pd, ...; `--method help` lists them\n"
   "  --tol X --step H --until T --every DT\n"
   "  -o FILE           .csv or .npy\n"
   "  --json            the summary as one JSON object\n"
   "  --observe EXPR    one more column: any expression of the model, --observe 'l*sin(th)'; can be repeated\n"
   "  --svg FILE        a picture of the outputs;  --sketch: one in the terminal\n"
   "  --save-state FILE, --resume FILE\n"},
  {"plot", CMD_PLOT, "lagc plot MODEL [SCENE] [name=value ...] [--x EXPR --y EXPR | --phase EXPR] [-o FILE.svg]",
   "Runs the model and draws it: all outputs against time, or one quantity against another.\n\n"
   "  --y EXPR          this against time\n"
   "  --x EXPR --y EXPR a path; one scale for both axes where their units agree\n"
   "  --phase EXPR      its rate against it: --phase th draws th' against th\n"
   "  -o FILE.svg       default: MODEL_SCENE.svg in this folder\n\n"
   "EXPR is any expression of the model: th, energy, an observable, 'l1*sin(th1)', \"th1' - th2'\".\n"
   "The options of `lagc run` are options here too; --sketch draws in the terminal as well.\n"},
  {"animate", CMD_ANIMATE, "lagc animate MODEL [SCENE] [name=value ...] [--points 'x1,y1 x2,y2'] [--trace] [-o FILE.html]",
   "Runs the model and writes its motion as one HTML file, which needs no network and no other file:\n"
   "space plays and pauses, arrow keys step, the slider scrubs.\n\n"
   "  --points 'X,Y X,Y' the points to draw, each two expressions; joined by rods in this order. Without\n"
   "                    it: the model's x,y, or x1,y1 x2,y2 ..., or px,py; or its only coordinate\n"
   "  --from 'X,Y'      where the first rod begins; default: the origin\n"
   "  --no-rods         points only\n"
   "  --trace           the path of the last point, fading\n"
   "  -o FILE.html      default: MODEL_SCENE.html in this folder\n\n"
   "The options of `lagc run` are options here too.\n"},
  {"modes", CMD_MODES, "lagc modes MODEL [SCENE] [name=value ...] [--json]",
   "Finds the equilibrium next to the scene's start, says whether it is stable and by which argument, and prints\n"
   "small motion about it: frequencies, damping, shapes. The linearisation is exact.\n\n"
   "  name=value        a parameter, another start (th=3), or an input that is held\n"
   "  --json            all modes, to 17 digits, as one JSON object\n\n"
   "Velocities of the start do not matter. In a shape the coordinate with the largest kinetic energy is 1 of its\n"
   "declared unit; 0.5@-90 is an amplitude of 0.5, a quarter of a period behind it. A zero mode is `free` where no\n"
   "force arises far along it. Needs GSL. Exit status 3: no equilibrium was found.\n"},
  {"methods", CMD_METHODS, "lagc methods",
   "Lists the methods of integration: order, what they keep, what they need, and their options.\n"},
};
enum { N_COMMANDS = sizeof commands / sizeof *commands };

static const char general_help[] =
  "lagc compiles a Lagrangian written as text into C, and runs it.\n\n"
  "  lagc check MODEL [SCENE]            parse, derive, prove the `expect` lines\n"
  "  lagc derive MODEL [SCENE]           print the equations (--format text|latex|c)\n"
  "  lagc run MODEL [SCENE] [name=value] simulate\n"
  "  lagc plot MODEL [SCENE] [--x --y]   simulate and draw, as SVG\n"
  "  lagc animate MODEL [SCENE]          simulate and show the motion, as one HTML file\n"
  "  lagc modes MODEL [SCENE]            equilibrium, stability, frequencies, shapes and damping\n"
  "  lagc build MODEL -o SIM             make a simulator\n"
  "  lagc header MODEL -o FILE.h         a C header to embed\n"
  "  lagc emit MODEL [SCENE] -o FILE.c   C for the runtime\n"
  "  lagc methods                        the methods of integration, with what they keep and need\n"
  "  lagc help [COMMAND|units|functions] more on each\n\n"
  "All take -D CONST=VALUE, and --dump=ast,model,eqns,prog to see the stages. MODEL is a .lag file; without a SCENE\n"
  "the first one counts. Exit status: 0 ok, 1 bad model, 2 usage or files, 3 the run failed.\n";

static const char units_help[] =
  "SI base units m kg s A K mol cd; Hz N Pa J W C V F ohm S Wb T H lm lx Bq Gy Sv kat, with prefixes\n"
  "(km, mm, us as µs, MHz); rad sr deg rev; min h d (day) yr; au eV u bar L t.\n"
  "In brackets after white space or a number: 90 [deg], 9.81 [m/s^2], 1 [kg*m^2], 3 [m^(1/2)].\n";

static const char functions_help[] =
  "sin cos tan asin acos atan atan2(y, x) sinh cosh tanh exp log sqrt cbrt hypot pow min max abs sign\n"
  "if(condition, a, b), comparisons, and or not; d(expr, name) is a partial derivative; a prime is the\n"
  "total time derivative: x', (x*y)', px'.\n";

const char *options_help(const char *topic) {
  if (!topic) return general_help;
  if (strcmp(topic, "units") == 0) return units_help;
  if (strcmp(topic, "functions") == 0) return functions_help;
  for (int i = 0; i < N_COMMANDS; i++)
    if (strcmp(commands[i].name, topic) == 0) return commands[i].help;
  return NULL;
}

static const char *unknown_command(Arena *a, const char *word) {
  Name names[N_COMMANDS];
  for (int i = 0; i < N_COMMANDS; i++) names[i] = commands[i].name;
  static const char *const later[] = {"cost", "effects", "noether", "lyapunov"};
  for (size_t i = 0; i < sizeof later / sizeof *later; i++)
    if (strcmp(word, later[i]) == 0) return arena_printf(a, "not yet: `lagc %s`", word);
  size_t n = strlen(word);
  if (n > 4 && strcmp(word + n - 4, ".lag") == 0) return arena_printf(a, "say what to do with %s: `lagc run %s`, `lagc derive %s`, `lagc check %s`", word, word, word, word);
  Name near = suggest(word, names, N_COMMANDS);
  if (near) return arena_printf(a, "unknown command `%s`: did you mean `%s`?", word, near);
  return arena_printf(a, "unknown command `%s`; `lagc help` lists them", word);
}

/* The value of an option that takes one: "--key=value", or the next word. */
static int take_value(const char *arg, const char *key, int argc, char **argv, int *i, const char **value) {
  size_t n = strlen(key);
  if (strncmp(arg, key, n) != 0) return 0;
  if (arg[n] == '=') {
    *value = arg + n + 1;
    return 1;
  }
  if (arg[n] != '\0') return 0;
  *value = *i + 1 < argc ? argv[++*i] : NULL;
  return 1;
}

static int add_define(Arena *a, Options *o, const char *text, const char **error) {
  const char *eq = text ? strchr(text, '=') : NULL;
  if (!eq || eq == text || !eq[1]) {
    *error = "-D takes CONST=VALUE, for example -D N=50";
    return 0;
  }
  if (strspn(eq + 1, "0123456789.eE+-") != strlen(eq + 1)) {
    *error = arena_printf(a, "-D %s: `%s` is not a number", text, eq + 1);
    return 0;
  }
  Define d = {arena_strndup(a, text, (size_t)(eq - text)), eq + 1};
  vec_push(a, &o->defines, d);
  return 1;
}

static int dump_is_known(const char *stages, const char **error) {
  static const char *const known[] = {"ast", "model", "eqns", "prog"};
  *error = "--dump takes stages: ast, model, eqns, prog, with commas between them";
  if (!stages || !stages[0]) return 0;
  for (const char *s = stages; *s;) {
    size_t n = strcspn(s, ","), found = 0;
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) found |= strlen(known[i]) == n && strncmp(known[i], s, n) == 0;
    if (!found) return 0;
    s += n + (s[n] == ',');
  }
  *error = NULL;
  return 1;
}

/* --with: parts of a model that are emitted only where something needs them. */
static int take_parts(Arena *a, const char *parts, Options *o, const char **error) {
  if (!parts) return 0;
  if (strcmp(parts, "linear") == 0) return o->linear = 1;
  *error = arena_printf(a, "--with takes linear (the exact linearisation), not `%s`", parts);
  return 0;
}

int options_simulate(const Options *o) {
  return o->command == CMD_RUN || o->command == CMD_PLOT || o->command == CMD_ANIMATE || o->command == CMD_MODES;
}

/* An option of plot or animate, or run's --observe: 1 with its value taken, 0 without one, -1 when it is none. */
static int picture_option(Arena *a, int argc, char **argv, int *i, Options *o) {
  const char *observed = NULL;
  const struct {
    Command command;
    const char *key;
    const char **value;
  } known[] = {
    {CMD_RUN, "--observe", &observed}, {CMD_PLOT, "--x", &o->x},           {CMD_PLOT, "--y", &o->y},
    {CMD_PLOT, "--phase", &o->phase},  {CMD_ANIMATE, "--points", &o->points}, {CMD_ANIMATE, "--from", &o->from},
  };
  for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
    if (known[k].command != o->command || !take_value(argv[*i], known[k].key, argc, argv, i, known[k].value)) continue;
    if (observed) vec_push(a, &o->observe, observed);
    return *known[k].value != NULL;
  }
  if (o->command != CMD_ANIMATE || strcmp(argv[*i], "--no-rods") != 0) return -1;
  return o->no_rods = 1;
}

/* What a simulator gets: an option, with its value where it takes one, a scene or a setting. */
static void pass_on(Arena *a, int argc, char **argv, int *i, Options *o) {
  static const char *const with_value[] = {"--method", "--tol", "--step", "--until", "--every", "--svg", "--plot-x",
                                           "--plot-y", "--save-state", "--resume", "--output", "-o", "--html", "--points", "--from"};
  const char *arg = argv[*i];
  int look = *i;
  take_value(arg, "--method", argc, argv, &look, &o->method);
  take_value(arg, "--resume", argc, argv, &look, &o->resume);
  vec_push(a, &o->rest, arg);
  if (arg[0] != '-' && !strchr(arg, '=') && !o->scene) o->scene = arg;
  for (size_t k = 0; k < sizeof with_value / sizeof *with_value; k++)
    if (strcmp(arg, with_value[k]) == 0 && *i + 1 < argc) {
      vec_push(a, &o->rest, argv[++*i]);
      return;
    }
}

static int takes_method(const Options *o) { return o->command == CMD_EMIT || o->command == CMD_BUILD; }

/* One option of lagc itself; -1 when it is none. */
static int own_option(Arena *a, int argc, char **argv, int *i, Options *o, const char **error) {
  const char *arg = argv[*i], *value = NULL;
  if (strncmp(arg, "-D", 2) == 0) {
    value = arg[2] ? arg + 2 : *i + 1 < argc ? argv[++*i] : NULL;
    return add_define(a, o, value, error);
  }
  if (take_value(arg, "--dump", argc, argv, i, &o->dump)) return dump_is_known(o->dump, error);
  if (strcmp(arg, "--no-gsl") == 0) return o->no_gsl = 1;
  if (take_value(arg, "--with", argc, argv, i, &value)) return take_parts(a, value, o, error);
  int picture = picture_option(a, argc, argv, i, o);
  if (picture >= 0 || o->command == CMD_RUN || o->command == CMD_MODES) return picture;
  if (strcmp(arg, "-o") == 0 || strcmp(arg, "--output") == 0) {
    o->output = *i + 1 < argc ? argv[++*i] : NULL;
    if (!o->output) *error = "-o takes a file";
    return o->output != NULL;
  }
  if (options_simulate(o)) return -1;
  if (take_value(arg, "--format", argc, argv, i, &o->format)) {
    if (o->format && (strcmp(o->format, "text") == 0 || strcmp(o->format, "latex") == 0 || strcmp(o->format, "c") == 0)) return 1;
    *error = "--format takes text, latex or c";
    return 0;
  }
  if (takes_method(o) && take_value(arg, "--method", argc, argv, i, &o->method)) return o->method != NULL;
  if (strcmp(arg, "--ops") == 0) return o->ops = 1;
  if (strcmp(arg, "--allow-numeric") == 0) return o->allow_numeric = 1;
  return -1;
}

static int read_arguments(Arena *a, int argc, char **argv, Options *o, const char **error) {
  for (int i = 2; i < argc; i++) {
    const char *arg = argv[i];
    if (strcmp(arg, "--help") == 0 || strcmp(arg, "-h") == 0) {
      o->topic = argv[1];
      o->command = CMD_HELP;
      return 1;
    }
    int own = own_option(a, argc, argv, &i, o, error);
    if (own == 1) continue;
    if (own == 0) {
      if (!*error) *error = arena_printf(a, "%s needs a value", arg);
      return 0;
    }
    if (!o->file && arg[0] != '-' && o->command != CMD_METHODS) o->file = arg;
    else if (options_simulate(o)) pass_on(a, argc, argv, &i, o);
    else if (arg[0] == '-' && arg[1]) {
      *error = arena_printf(a, "`lagc %s` has no option `%s`; `lagc help %s` lists them", argv[1], arg, argv[1]);
      return 0;
    } else if (!o->scene && o->command != CMD_METHODS) o->scene = arg;
    else {
      *error = arena_printf(a, "one word too many: `%s`; usage: %s", arg, commands[o->command - CMD_CHECK].usage);
      return 0;
    }
  }
  if (!o->file && o->command != CMD_METHODS) {
    *error = arena_printf(a, "a model is missing; usage: %s", commands[o->command - CMD_CHECK].usage);
    return 0;
  }
  return 1;
}

int options_read(Arena *a, int argc, char **argv, Options *o, const char **error) {
  *o = (Options){0};
  *error = NULL;
  if (argc < 2 || strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 || strcmp(argv[1], "help") == 0) {
    o->command = CMD_HELP;
    o->topic = argc > 2 ? argv[2] : NULL;
    if (o->topic && !options_help(o->topic)) {
      *error = arena_printf(a, "no help on `%s`; `lagc help` lists the commands", o->topic);
      return 0;
    }
    return 1;
  }
  if (strcmp(argv[1], "--version") == 0 || strcmp(argv[1], "version") == 0) {
    o->command = CMD_VERSION;
    return 1;
  }
  for (int i = 0; i < N_COMMANDS; i++)
    if (strcmp(argv[1], commands[i].name) == 0) o->command = commands[i].command;
  if (!o->command) {
    *error = unknown_command(a, argv[1]);
    return 0;
  }
  o->linear = o->command == CMD_MODES;
  return read_arguments(a, argc, argv, o, error);
}
