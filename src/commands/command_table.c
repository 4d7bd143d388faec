/* The tables of commands and options, with the texts of help, and look-ups in them. */
#include "commands/command_table.h"

#include <string.h>

#include "base/words.h"

/* ---- the commands ---- */

static const CommandRow commands[] = {
  {CMD_CHECK, "check", NULL, "MODEL [SCENE] [--allow-numeric] [--verbose] [--json]", "parse, derive, prove symmetries and `expect` lines",
   "Parses and derives the model for every scene (or the one named), and proves or refutes its `expect` lines. "
   "A proved line holds for all states at which both sides have real values; a refuted line comes with a state at which its sides differ. "
   "Exit status 0 if all is well, 1 if not.\n\n"
   "Every command compares its compiled programs with the text of the model, evaluated by Taylor arithmetic at random states; --verbose lists the comparisons."},
  {CMD_VERIFY, "verify", NULL, "MODEL [SCENE] [name=value ...] --against FILE.c:FUNCTION [--map NAMES]", "compare a function by hand with the derived equations",
   "Compares a right-hand side written by hand in C with the derived equations, in 34 digits where the C compiler has libquadmath, else in 19, at 75 states: "
   "the scene's start, states with its parameters, and states with others. The function is compiled as it is written:\n\n"
   "  void f(double t, const double *y, double *dydt, const double *p)\n\n"
   "y holds coordinates, velocities, states of the model; p its parameters in order of declaration; all in SI units. The function may return int, 0 for success, "
   "and may have GSL's arguments, `void *params` last.\n\n"
   "A difference counts if roundings do not explain it: the function is called with four directions of rounding, and with arguments some roundings beside each state. "
   "Where it differs, the state with the largest difference is shown, and the mistake, if one explains all: a sign, a factor, a missing term, swapped parameters, another order of y. "
   "Constraints: states that obey them. Contacts are open.\n\n"
   "  name=value            a parameter, held at this value at all states, for a\n"
   "                        function that has it as a number; a start; an input\n\n"
   "Exit status 0: it agrees; 3: it differs, crashes or does not return."},
  {CMD_DERIVE, "derive", NULL, "MODEL [SCENE] [--format text|latex|c] [--ops] [--hamiltonian | --lagrangian | --bracket 'F, G' | --in NAME] [-o FILE]", "print the equations of motion",
   "Prints the equations of motion: momenta, M q'' = f, energy, and the operation count; with --hamiltonian, momenta, H(q, p) and "
   "Hamilton's equations. The mass matrix is inverted in closed form if it has blocks of up to three coordinates with short results. "
   "--lagrangian goes back from a model that gives its Hamiltonian, and says where the velocities determine the momenta. "
   "--bracket 'F, G' prints the Poisson bracket of two expressions, with {x, p} = 1; {F, {G, H}} may stand in it. "
   "--in NAME prints the Hamiltonian and Hamilton's equations in the variables of a canonical transformation of the model, once it is proved; of a change of coordinates, the equations of motion."},
  {CMD_NOETHER, "noether", "symmetries", "MODEL [SCENE] [--degree 2|3|4] [--involution] [--seconds S] [--format text|latex|json] [-o FILE]", "find symmetries and conserved quantities",
   "Searches for the symmetries of L: transformations of coordinates, affine in them with coefficients that depend on time, and of time, that change "
   "L by a total derivative dF/dt at most. Every listed symmetry is proved, and shown with its generator, its F and its charge; then come the Poisson "
   "brackets of the charges, declared symmetries, cyclic coordinates, and a scaling that maps solutions to solutions.\n\n"
   "--degree 2 (3, 4) looks for charges that are polynomials of that degree in the momenta, too, such as the Runge-Lenz vector: their coefficients are "
   "polynomials of the coordinates, times functions that stand in L. Each is proved; products of charges already known are not listed.\n\n"
   "--involution reports a largest set of independent charges in involution: those listed, squares of angular momenta, and conserved functions that the model declares in `expect {f, g} = h`, "
   "`observe` and `symmetry`. All their brackets are proved to be 0; with n of them the motion is integrable in Liouville's sense.\n\n"
   "--seconds S is the processor time for the search; its matrices take half a gigabyte at most. What could not be searched in it is said.\n\n"
   "Without a scene the model has no effects, and a list shows how each effect alone changes the balance that replaces dQ/dt = 0."},
  {CMD_ACTION, "action", "actions", "MODEL [SCENE] [name=value ...] [--json]", "action variables and their frequencies, in numbers",
   "Computes the action variable of each coordinate at the scene's start, J = 1/(2 pi) times the closed integral of p dq between the turning points at the start's energy, "
   "and its frequency omega = dE/dJ, to about 15 digits. The model has one coordinate, or separates in its coordinates: the momentum of a cyclic angle is its action; "
   "a coordinate whose dH/dq and dH/dp have a ratio free of the others has a curve of its own; the same, then, for those that are left; and all that are left then, "
   "where Levi-Civita's conditions hold for every two of them. The separated equations are printed, or the two coordinates whose condition fails.\n\n"
   "A coordinate that goes round has the mean of p over a turn as its action; one that does not turn has none, and the line says why. Where H depends on t, it is held at the start's t.\n\n"
   "  name=value            a parameter, or another start\n\n"
   "Exit status 3: there is no action variable."},
  {CMD_RUN, "run", NULL, "MODEL [SCENE] [name=value ...] [options]", "simulate",
   "Builds the simulator (or takes it from the cache) and runs it.\n\n"
   "  name=value            a parameter, a start (th=1.2, \"th'=0.5\", th='90[deg]',\n"
   "                        th=pi/3) or an input; a bare number is in the declared\n"
   "                        unit; drag.c=0.2 for one of an effect, m=3 for a family\n"
   "  u=FILE.csv            a table for the input u; 'u=2*sin(t/(1 [s]))' a formula"},
  {CMD_PLOT, "plot", "picture", "MODEL [SCENE ...] [name=value ...] [--x EXPR --y EXPR | --phase EXPR | --portrait | --potential | --cloud N | --distance | --energy-error]", "simulate and draw, as SVG",
   "Runs the model and draws it: all outputs against time, or one quantity against another. "
   "EXPR is any expression of the model: th, energy, an observable, 'l1*sin(th1)', \"th1' - th2'\". "
   "Several scenes, or methods (--method euler,verlet), are drawn in one picture, with a legend. "
   "All options of `lagc run` are allowed."},
  {CMD_ANIMATE, "animate", NULL, "MODEL [SCENE] [name=value ...] [--points 'X,Y X,Y'] [--trace]",
   "simulate and show the motion, as one HTML file",
   "Runs the model and writes its motion as one HTML file, which needs no network and no other file: space plays and "
   "pauses, arrow keys step, the slider scrubs. All options of `lagc run` are allowed."},
  {CMD_MODES, "modes", "equilibrium", "MODEL [SCENE] [name=value ...] [--steady] [--json]", "equilibrium, stability, frequencies, shapes and damping",
   "Finds the equilibrium next to the scene's start, says whether it is stable and by which argument, and prints the modes of "
   "small motion about it: frequencies, damping, shapes. The linearisation is exact; with constraints and rotations it has 11 to 13 digits.\n\n"
   "Velocities of the start do not matter; with --steady they do: a top that spins, a wheel that rolls, a bicycle that runs straight. In a shape the coordinate with the largest kinetic energy is 1 of its declared "
   "unit; 0.5@-90 is an amplitude of 0.5, a quarter of a period behind. A zero mode is `free` if no force arises far "
   "along the mode. Needs GSL. Exit status 3: no equilibrium was found.\n\n"
   "  name=value            a parameter, another start (th=3), an input to hold"},
  {CMD_LYAPUNOV, "lyapunov", "exponents", "MODEL [SCENE] [name=value ...] [--until T] [--exponents K] [--json]", "Lyapunov exponents: how fast neighbouring motions part",
   "Runs the scene for a long time with the exact tangent of its flow, and prints the Lyapunov exponents: the mean rates at which small "
   "changes of the start grow, in the space of coordinates, velocities and states. The spread is the standard error from 20 blocks of the time "
   "measured; `at half the time` is the estimate then. An exponent of zero approaches 0 as log(t)/t. "
   "Method and steps are chosen as for `lagc run`: --method, --tol, --step.\n\n"
   "  name=value            a parameter, another start, an input: as for lagc run"},
  {CMD_COST, "cost", NULL, "MODEL [SCENE] [name=value ...] [--target X] [--seconds S] [-o FILE.svg]", "time against accuracy: all methods, side by side",
   "Names the fastest settings for errors of 1e-3, 1e-6, 1e-9 and 1e-12, or of --target X; then prints the time that the best method of each family "
   "takes for errors of 1e-2 to 1e-14, and the front: the runs that no other beats in time and error. Methods are tried from coarse to fine tolerances or "
   "steps, those near the front first, for --seconds S in all. The error is "
   "the largest difference, at 16 times, from a reference by Taylor series in the highest available precision, relative to the "
   "largest value of its kind and unit. Times are measured on this processor, now. Ctrl-C prints what is known.\n\n"
   "  name=value            a parameter, another start, an input, as for `lagc run`\n\n"
   "Exit status 3: no setting reaches the target."},
  {CMD_SWEEP, "sweep", "ensemble", "MODEL [SCENE] NAME=RANGE ... [--measure EXPR ...] -o FILE", "many runs: parameters and starts over ranges, or samples",
   "Runs the scene once for each combination of the values of all ranges, and writes a row a run: the values, the measures, and a status. "
   "Runs share the work of all processors; a run has the same numbers in any order.\n\n"
   "  name=A..B:N           N values from A to B, in equal steps\n"
   "  name=A..B:log:N       in equal ratios\n"
   "  name=A,B,C            these values; --zip: ranges are walked together\n"
   "  name~normal(M, D)     --samples N: around the mean M, with deviation D,\n"
   "  name~uniform(A, B)    or between A and B, which name=A..B says, too\n"
   "  name=value            for all runs, as for `lagc run`\n\n"
   "Ranges have units as values have: th=-180..180[deg]:512. Names are those that `lagc run` sets: parameters, starts, constant inputs; and constants, "
   "N=2,4,8, of which each value is compiled. With --samples, each combination of the "
   "other ranges has the same samples.\n\n"
   "Finished runs are kept in FILE.journal: after Ctrl-C, a kill or a full disk --resume goes on, and the result is the same to the byte. --mpi K shares the runs of K processes, on the machines that mpirun finds. Exit status 3 has no use here: a run that "
   "fails is a row with its reason."},
  {CMD_EFFECTS, "effects", NULL, "MODEL [SCENE] [name=value ...] [--accuracy X] [--json]", "cost of each effect, and whether the result needs it",
   "Runs the scene, then without each effect that the scene uses, and with each effect that it does not use. Prints for each effect its operations "
   "and its share of the time of a call of the right-hand side; its weight, the largest ratio of |acceleration with - without it| to "
   "|acceleration| along the run; its difference, the largest change at 256 times of the run and at its end, relative to the largest value of "
   "its kind and unit; and whether the difference exceeds twice the error of integration, measured by a run with a hundredth of the tolerance, or half the step. "
   "An effect is left out together with those that require it. `shared` are operations that several effects need. Method, steps and end are chosen as for "
   "`lagc run`: --method, --tol, --step, --until. `lagc help effect` says more.\n\n"
   "  name=value            a parameter, another start, an input, as for `lagc run`\n\n"
   "--accuracy X searches for the smallest set of the scene's effects whose result differs from the scene's by at most X: with all other effects left out together, in "
   "scenes of up to ten effects. Prints the `use` line of the set that it finds."},
  {CMD_BUILD, "build", NULL, "MODEL -o SIMULATOR [--shared] [--method NAME] [--with linear]", "make a simulator, or a shared library",
   "Compiles the model to a simulator with all its scenes; it has the options of `lagc run`, which `SIMULATOR --help` "
   "lists.\n\n"
   "With --shared it compiles a shared library, which exports the functions of lag.h by the same names for every model: simulations, rows, events, charges, tangents, "
   "batches. It links no GSL. Without -o it is kept in the cache, and its path is printed. lagc.py uses it from Python."},
  {CMD_HEADER, "header", "embedding", "MODEL [SCENE] [--with PART,...] [--for LIBRARY,...] -o FILE.h", "write one C header to embed",
   "Writes one self-contained C99/C++ header to embed: parameters as a struct, accelerations, energy, an RK4 step. It "
   "includes nothing but <math.h>, allocates nothing and has no globals. Its names begin with the file's:\n\n"
   "  lagc header models/pendulum.lag -o pend.h\n\n"
   "and in one file of a program\n\n"
   "  #define PEND_IMPLEMENTATION\n"
   "  #include \"pend.h\"\n\n"
   "Other files include it without the #define; link with -lm. Its first lines show its use. With PEND_LANES defined as 4 or 8 it computes 4 or 8 "
   "states at once, by rk45, dop853 and taylor (--with) each with a step size and an end of its own; pend_step_until_event, variational and moreau compute one state: over lanes a call of them does not compile, and says so.\n\n"
   "Contacts are followed by `pend_moreau_step`, with friction and however many they are (--with moreau; models of contacts with friction have it anyway). The state says which of them "
   "press, slip, stick, or were struck in the step. With --with moreau dry friction of joints sticks, too; other steps decide at each state.\n\n"
   "With --for it also has callbacks for solvers, exact Jacobians included, and includes their headers: `gsl_odeiv2_system sys = pend_gsl_system(&data);`, "
   "`CVodeInit(cvode, pend_cvode_rhs, t, y);`, or in Python `casadi.external(\"pend_ode\", \"./pend.so\")`. Where the model has constraints, accelerations obey them, positions drift as far as the "
   "solver's errors do (`pend_hold` leads back)."},
  {CMD_EMIT, "emit", NULL, "MODEL [SCENE] [--method NAME] [--with linear] [-o FILE.c]", "write C for the runtime",
   "Writes C for the runtime: a `const lag_model` and a `const lag_scene` (see lag_model.h). liblag "
   "integrates them; its interface is lag.h:\n\n"
   "  cc main.c pendulum.c $(pkg-config --cflags --libs liblag)\n\n"
   "With -DLAG_LANES=4 or 8 its functions take vectors of 4 or 8 doubles, and compute as many states at once."},
  {CMD_FMU, "fmu", "fmi", "MODEL [SCENE] -o FILE.fmu [--fmi 2|3] [--also-cc CC,CC]", "write an FMU, for Simulink, Modelica tools and others",
   "Writes the scene as a Functional Mock-up Unit (FMI 2.0, or 3.0), for model exchange and co-simulation: sources and a binary for this machine, "
   "which need nothing of lagc. Coordinates, velocities and states are its continuous states, with the starts of the scene; the scene's outputs are outputs; "
   "parameters can be set, within their declared signs; an input follows its formula until the importer sets it; events act, and `stop` ends the "
   "simulation. Effects are those of the scene. Values are in SI units, display units are the declared ones. Co-simulation steps by dop853, at the tolerance of the experiment; "
   "with dry friction by moreau, with steps that this tolerance chooses.\n\n"
   "CC names the compiler, and so the machine: CC=x86_64-w64-mingw32-gcc makes an FMU for Windows; `--also-cc x86_64-w64-mingw32-gcc` makes one for both. A model with contacts is for co-simulation alone, "
   "by steps of the method moreau, of the size that its scene gives, whatever the tolerance is. Constraints that hold while a condition is true are refused."},
  {CMD_METHODS, "methods", NULL, "", "list the methods of integration",
   "Lists the methods of integration: their order, the quantities that they keep, their demands on a model, and their options."},
  {CMD_MODELS, "models", "gallery", "[WORD]", "list the models that come with lagc",
   "Lists the gallery, with titles; with a word, the models whose name or title has it. Every command takes one of them by name:\n\n"
   "  lagc run @double_pendulum chaos --sketch"},
  {CMD_NEW, "new", NULL, "NAME [--like MODEL]", "start a model from one of the gallery",
   "Writes NAME.lag here, a copy of a model of the gallery under the new name: of the model that --like names, else of one with a similar name, else "
   "of pendulum. No file is overwritten."},
  {CMD_CACHE, "cache", NULL, "[--clear]", "show or empty the cache of simulators",
   "Shows the folder of built simulators, their number, their size and its limit; beyond the limit, simulators that were used longest ago are removed. "
   "Simulators are run only from a folder of yours that nobody else can write. LAGC_CACHE_MIB sets another limit, in MiB."},
  {CMD_HELP, "help", NULL, "[WORDS]", NULL, "Says more on a command, a word of the language, a unit, a function or an option; alone, lists the topics. "
   "Other words are searched in all pages, in the reference, the tutorial and README, and what answers them is shown, the best first: `lagc help normal modes`."},
  {CMD_COMPLETION, "completion", NULL, "bash|zsh|fish", "print the completion script of a shell",
   "Prints the script by which a shell completes the commands and options of lagc, and the scenes, parameters, methods and names of "
   "the model in question. `make install` puts it where these shells look; without `make install`,\n\n"
   "  source <(lagc completion bash)    in ~/.bashrc\n"
   "  source <(lagc completion zsh)     in ~/.zshrc, after compinit\n"
   "  lagc completion fish | source     in ~/.config/fish/config.fish"},
  {CMD_VERSION, "version", NULL, "", NULL, "Prints the version."},
  {CMD_COMPLETE, "complete", NULL, "WORD...", NULL, NULL}, /* for completion scripts: see completion.h */
};
enum { N_COMMANDS = sizeof commands / sizeof *commands };

/* ---- the options ---- */

#define C(name) (1u << CMD_##name)
#define SIMULATE (C(RUN) | C(PLOT) | C(ANIMATE))
#define STEPS (SIMULATE | C(LYAPUNOV) | C(EFFECTS))
#define MODELS (STEPS | C(SWEEP) | C(MODES) | C(COST) | C(CHECK) | C(VERIFY) | C(DERIVE) | C(NOETHER) | C(ACTION) | C(BUILD) | C(HEADER) | C(EMIT) | C(FMU))
#define OWN(f) 0, offsetof(Options, f)
#define PASSED 1, 0

static const OptionRow options[] = {
  {"--allow-numeric", NULL, NULL, TAKES_NOTHING, "", C(CHECK), OWN(allow_numeric),
   "an expectation that is not proved, but holds numerically to rounding, does not fail the check"},
  {"--json", NULL, NULL, TAKES_NOTHING, "", C(CHECK), OWN(json), "messages with their places, facts, scenes and verdicts as one JSON object"},
  {"--against", NULL, "FILE.c:FUNCTION", TAKES_TEXT, "", C(VERIFY), OWN(against), "the function to compare, and the file that has it"},
  {"--map", NULL, "NAME,NAME", TAKES_TEXT, "", C(VERIFY), OWN(map), "the order of the function's y, if it is another: th1,th1',th2,th2'"},
  {"--verbose", NULL, NULL, TAKES_NOTHING, "", C(CHECK), OWN(verbose), "also list the parts of the compiled programs that were compared with the text, and the number of states"},
  {"--format", NULL, "text|latex|c", TAKES_CHOICE, "text latex c", C(DERIVE), OWN(format),
   "as text, as LaTeX, or as the C function that computes the accelerations"},
  {"--format", NULL, "text|latex|json", TAKES_CHOICE, "text latex json", C(NOETHER), OWN(format), "as text, as LaTeX, or as one JSON object"},
  {"--degree", NULL, "2|3|4", TAKES_CHOICE, "2 3 4", C(NOETHER), OWN(degree), "charges of this degree in the momenta, and of lower ones, too"},
  {"--involution", NULL, NULL, TAKES_NOTHING, "", C(NOETHER), OWN(involution), "a largest set of independent charges in involution: is the motion integrable?"},
  {"--ops", NULL, NULL, TAKES_NOTHING, "", C(DERIVE), OWN(ops), "the operation counts only"},
  {"--hamiltonian", NULL, NULL, TAKES_NOTHING, "", C(DERIVE), OWN(hamiltonian), "momenta, H and Hamilton's equations"},
  {"--lagrangian", NULL, NULL, TAKES_NOTHING, "", C(DERIVE), OWN(lagrangian), "momenta and L of a model that gives its Hamiltonian"},
  {"--in", NULL, "NAME", TAKES_TEXT, "", C(DERIVE), OWN(in), "the Hamiltonian in the variables of the canonical transformation NAME; the equations in other coordinates"},
  {"--bracket", NULL, "'F, G'", TAKES_EXPR, "", C(DERIVE), OWN(bracket), "the Poisson bracket of two expressions of the model, in coordinates and momenta"},

  {"--observe", NULL, "EXPR", TAKES_EXPRS, "", C(RUN), OWN(observe),
   "one more column: any expression of the model, --observe 'l*sin(th)'; can be repeated"},
  {"--section", NULL, "'EXPR rising'", TAKES_EXPR, "", C(RUN) | C(PLOT), OWN(section),
   "a Poincare section: one row, or one point, each time EXPR crosses zero; or falling, or crossing (both ways). A periodic angle is zero once a turn: 'th2 rising'"},
  {"--y", NULL, "EXPR", TAKES_EXPRS, "", C(PLOT), OWN(y), "draws EXPR, or all members of a family, against time (can be repeated),"},
  {"--x", NULL, "EXPR", TAKES_EXPR, "", C(PLOT), OWN(x), "or against this one: a path, with one scale for both axes if their units agree"},
  {"--phase", NULL, "EXPR", TAKES_EXPR, "", C(PLOT), OWN(phase), "draws the rate of EXPR against EXPR: --phase th draws th' against th"},
  {"--cloud", NULL, "N", TAKES_TEXT, "", C(PLOT), OWN(cloud),
   "N starts on an ellipse around the scene's, as each method carries them along, with the area inside; N:PART is its size as a part of the motion's, by default 0.1; --every DT: the time between two drawings"},
  {"--portrait", NULL, NULL, TAKES_NOTHING, "", C(PLOT), OWN(portrait), "the phase portrait of a model with one coordinate: the motion over level curves of the energy"},
  {"--potential", NULL, NULL, TAKES_NOTHING, "", C(PLOT), OWN(potential), "the energy of the motion over the potential, of a model with one coordinate"},
  {"--energy-error", NULL, NULL, TAKES_NOTHING, "", C(PLOT), OWN(energy_error), "the relative error of the energy against time, on a logarithmic axis; of several methods: --method rk4,verlet --step 0.05"},
  {"--distance", NULL, NULL, TAKES_NOTHING, "", C(PLOT), OWN(distance), "how the distance of other runs from the first grows, on a logarithmic axis: --vs 'x=1.00000001'; of the outputs, or of --y EXPR"},
  {"--points", NULL, "'X,Y X,Y'", TAKES_EXPR, "", C(ANIMATE), OWN(points),
   "the points to draw, each two expressions, joined by rods in this order; for families, all members. Default: the model's x,y; or "
   "x1,y1 x2,y2 ...; or px,py; or a point made from its only coordinate, of an angle a rod; or the vectors among its coordinates; or a family, each member at its number"},
  {"--from", NULL, "'X,Y'", TAKES_EXPR, "", C(ANIMATE), OWN(from), "the point where the first rod begins; default: the origin"},
  {"--no-rods", NULL, NULL, TAKES_NOTHING, "", C(ANIMATE), OWN(no_rods), "points only"},
  {"--trace", NULL, NULL, TAKES_NOTHING, "", C(ANIMATE), PASSED, "the path of the last point, fading"},

  {"--output", "-o", "FILE", TAKES_FILE, "", C(DERIVE) | C(NOETHER), OWN(output), "writes to this file; endings .tex, .c and .json choose the format, too"},
  {"--output", "-o", "SIMULATOR", TAKES_FILE, "", C(BUILD), OWN(output), "the program to make, or with --shared the library FILE.so"},
  {"--output", "-o", "FILE.h", TAKES_FILE, "h hpp", C(HEADER), OWN(output), "the header to write; default: standard output"},
  {"--output", "-o", "FILE.fmu", TAKES_FILE, "fmu", C(FMU), OWN(output), "the FMU to write"},
  {"--output", "-o", "FILE.c", TAKES_FILE, "c", C(EMIT), OWN(output), "the C file to write; default: standard output"},
  {"--output", "-o", "FILE.svg", TAKES_FILE, "svg png", C(PLOT), OWN(output), "default: MODEL_SCENE.svg in this folder; FILE.png where lagc was built with librsvg"},
  {"--output", "-o", "FILE", TAKES_FILE, "svg png csv json", C(COST), PASSED, "a picture, FILE.svg or .png: time against error, on logarithmic axes; or all runs: FILE.csv, FILE.json"},
  {"--output", "-o", "FILE.html", TAKES_FILE, "html htm", C(ANIMATE), OWN(output), "default: MODEL_SCENE.html in this folder"},
  {"--output", "-o", "FILE", TAKES_FILE, "csv npy", C(RUN), PASSED, "rows of output: CSV, or NumPy where FILE ends in .npy; - is standard output"},
  {"--output", "-o", "FILE", TAKES_FILE, "csv npy h5", C(SWEEP), PASSED,
   "a row a run: CSV, NumPy where FILE ends in .npy, or, where lagc was built with it, HDF5 where FILE ends in .h5, with an axis for each range; - is standard output"},
  {"--output", "-o", "FILE", TAKES_FILE, "csv npy", C(LYAPUNOV), PASSED, "the estimates as they settle: CSV, or NumPy where FILE ends in .npy"},

  {"--method", NULL, "NAME", TAKES_METHOD, "", STEPS | C(COST) | C(SWEEP), PASSED,
   "method of integration, NAME or \"NAME(option=value, ...)\"; `lagc help methods` lists them"},
  {"--method", NULL, "NAME", TAKES_METHOD, "", C(BUILD) | C(EMIT), OWN(method),
   "adds the derivatives that this method needs besides accelerations; those of the scenes' methods are always there"},
  {"--tol", NULL, "X", TAKES_NUMBER, "", STEPS | C(COST) | C(SWEEP), PASSED, "tolerance, absolute and relative"},
  {"--accuracy", NULL, "X", TAKES_NUMBER, "", SIMULATE, PASSED,
   "chooses method and tolerance so that the error of the motion stays below X, relative to the largest value of its kind and unit, and reports the estimate"},
  {"--step", NULL, "H", TAKES_NUMBER, "", STEPS | C(COST) | C(SWEEP), PASSED, "step [s]; the first step to try if the method chooses its own steps"},
  {"--target", NULL, "X", TAKES_NUMBER, "", C(COST), PASSED, "names the cheapest setting whose error is at most X"},
  {"--methods", NULL, "NAME,NAME", TAKES_TEXT, "", C(COST), PASSED, "only these methods"},
  {"--seconds", NULL, "S", TAKES_NUMBER, "", C(COST) | C(NOETHER), OWN(seconds), "the time to spend; default: 10. What was left out is said"},
  {"--error", NULL, "EXPR|final|residual", TAKES_EXPR, "", C(COST), OWN(error), "the error of this expression, `energy` for example, or of the state at the end, or what is left of the equations of motion within steps, instead of the state at 16 times"},
  {"--realtime", NULL, "H", TAKES_NUMBER, "", C(COST), PASSED,
   "for games and controllers, which make steps of H [s]: the error of each method of equal steps, the time of a step at worst, and the largest step that follows the motion; with --target, the fastest with at most this error"},
  {"--budget", NULL, "X", TAKES_NUMBER, "", C(COST), OWN(budget),
   "the cheapest combination of effects, method, setting and precision whose motion differs from the full model's by X at most, with its error measured against that"},
  {"--where", NULL, NULL, TAKES_NOTHING, "", C(COST), PASSED,
   "where the time of one run goes, the scene's own or that of --method, --tol, --step: shares of right-hand side, linear algebra, Newton's method, step control, output; operations and time of a call"},
  {"--all", NULL, NULL, TAKES_NOTHING, "", C(COST), PASSED, "the times of every method, not of one a family"},
  {"--runs", NULL, NULL, TAKES_NOTHING, "", C(COST), PASSED, "every run, not the front alone"},
  {"--until", NULL, "T", TAKES_NUMBER, "", SIMULATE | C(COST) | C(EFFECTS) | C(SWEEP), PASSED, "run to time T [s]; before the start: backwards"},
  {"--accuracy", NULL, "X", TAKES_NUMBER, "", C(EFFECTS), OWN(accuracy), "the relative difference that does not matter; finds the smallest set of effects within it"},
  {"--until", NULL, "T", TAKES_NUMBER, "", C(LYAPUNOV), PASSED, "measure to time T [s]; default: 20 spans of the scene"},
  {"--transient", NULL, "T", TAKES_NUMBER, "", C(LYAPUNOV), PASSED, "the time left out at the beginning [s]; default: a tenth"},
  {"--exponents", NULL, "K", TAKES_NUMBER, "", C(LYAPUNOV), PASSED, "only the K largest exponents"},
  {"--every", NULL, "DT", TAKES_NUMBER, "", SIMULATE, PASSED, "time between rows [s]; default: as the scene says, or a 1000th of the span; in pictures, as the motion requires"},
  {"--skip", NULL, "T", TAKES_NUMBER, "", SIMULATE, PASSED, "rows, pictures, sections and measures begin at time T [s]: without the transient"},
  {"--measure", NULL, "EXPR", TAKES_EXPR, "", SIMULATE, PASSED,
   "a number of the run in the report: max(x), max(x, 10..20) from 10 to 20 s, min, mean, rms, drift, period(x), hit(EVENT, 3), count(EVENT), end, x(10), lyapunov, and arithmetic; NAME=EXPR names it; can be repeated"},
  {"--vs", NULL, "NAME=VALUE", TAKES_TEXT, "", C(PLOT), PASSED, "draws another run with this value beside; can be repeated"},
  {"--starts", NULL, "NAME=A..B:N", TAKES_TEXT, "", C(PLOT), PASSED, "a run for each value of a range, in one picture, coloured by its place: for sections of many motions; also A..B:log:N and A,B,C"},
  {"--tangent", NULL, NULL, TAKES_NOTHING, "", C(RUN), PASSED,
   "the tangent of the flow, dx/dy(0) of all coordinates, velocities and states x and y: adds more columns, and a matrix to the report"},
  {"--volume", NULL, NULL, TAKES_NOTHING, "", C(RUN), PASSED,
   "the volume of the phase space that the flow carries along, as the logarithm of the determinant of its tangent in (q, p): 0 by Liouville's theorem"},
  {"--svg", NULL, "FILE.svg", TAKES_FILE, "svg png", SIMULATE, PASSED, "a picture of all output against time; FILE.png where lagc was built with librsvg"},
  {"--svg", NULL, "FILE.svg", TAKES_FILE, "svg png", C(LYAPUNOV), PASSED, "a picture of the estimates as they settle"},
  {"--svg", NULL, "FILE.svg", TAKES_FILE, "svg png", C(SWEEP), PASSED, "a picture: the measures over one range, a map of the first one over two ranges, or else a matrix of scatter plots"},
  {"--plot-x", NULL, "NAME", TAKES_TEXT, "", SIMULATE, PASSED, "with --plot-y NAME: the picture shows one output against another"},
  {"--plot-y", NULL, "NAME", TAKES_TEXT, "", SIMULATE, PASSED, "the picture shows this output"},
  {"--sketch", NULL, NULL, TAKES_NOTHING, "", SIMULATE | C(COST), PASSED, "a picture in the terminal"},
  {"--html", NULL, "FILE.html", TAKES_FILE, "html htm", C(RUN) | C(PLOT), PASSED, "an animation of the points that --points names; `lagc animate` finds them itself"},
  {"--points", NULL, "'X,Y X,Y'", TAKES_TEXT, "", C(RUN) | C(PLOT), PASSED, "points of an animation; X and Y are names of outputs"},
  {"--from", NULL, "'X,Y'", TAKES_TEXT, "", C(RUN) | C(PLOT), PASSED, "the point where the first rod begins; default: the origin"},
  {"--no-rods", NULL, NULL, TAKES_NOTHING, "", C(RUN) | C(PLOT), PASSED, "points only"},
  {"--trace", NULL, NULL, TAKES_NOTHING, "", C(RUN) | C(PLOT), PASSED, "the path of the last point"},
  {"--json", NULL, NULL, TAKES_NOTHING, "", SIMULATE, PASSED, "the report as one JSON object; it also names the source of sines and cosines, and the build"},
  {"--json", NULL, NULL, TAKES_NOTHING, "", C(LYAPUNOV), PASSED, "exponents and spreads as one JSON object"},
  {"--json", NULL, NULL, TAKES_NOTHING, "", C(SWEEP), PASSED, "the statistics as one JSON object"},
  {"--json", NULL, NULL, TAKES_NOTHING, "", C(COST), PASSED, "all runs as one JSON object"},
  {"--steady", NULL, NULL, TAKES_NOTHING, "", C(MODES), PASSED, "about the steady motion next to the start, in place of rest: cyclic coordinates run at constant rates"},
  {"--json", NULL, NULL, TAKES_NOTHING, "", C(MODES), PASSED, "all modes as one JSON object"},
  {"--json", NULL, NULL, TAKES_NOTHING, "", C(EFFECTS), OWN(json), "the table as one JSON object"},
  {"--json", NULL, NULL, TAKES_NOTHING, "", C(ACTION), OWN(json), "actions and separated equations as one JSON object"},
  {"--events", NULL, "FILE.csv", TAKES_FILE, "csv", SIMULATE, PASSED, "each event with its time and the state before and after it"},
  {"--quiet", NULL, NULL, TAKES_NOTHING, "", SIMULATE | C(LYAPUNOV) | C(COST) | C(SWEEP), PASSED, "no report"},
  {"--no-monitors", NULL, NULL, TAKES_NOTHING, "", SIMULATE, PASSED, "no `monitor` of the scene ends the run: a method that is rougher than the scene's goes on"},
  {"--save-state", NULL, "FILE", TAKES_FILE, "", SIMULATE, PASSED, "writes the complete state at the end"},
  {"--resume", NULL, "FILE", TAKES_FILE, "", SIMULATE, PASSED,
   "continues from a saved state, with the same scene, method and values: the results are those of an uninterrupted run, bit by bit"},

  {"--measure", NULL, "EXPR", TAKES_TEXT, "", C(SWEEP), PASSED,
   "what is kept of a run, x, x(10), max(x), max(x, 10..20) from 10 to 20 s, period(th), hit(EVENT), count(EVENT), drift(energy), lyapunov, arithmetic of these; can be repeated. Default: the state at the end"},
  {"--motions", NULL, "FILE", TAKES_FILE, "csv npy h5", C(SWEEP), PASSED, "the whole motion of each run: its number, t and the outputs in a row each --every; CSV, NumPy where FILE ends in .npy, HDF5 where it ends in .h5"},
  {"--every", NULL, "DT", TAKES_NUMBER, "", C(SWEEP), PASSED, "time between the rows of --motions [s]; default: as the scene says, or a 1000th of the span"},
  {"--histogram", NULL, "N", TAKES_NUMBER, "", C(SWEEP), PASSED, "the picture of --svg shows how many runs lie in each of N parts of the range of a measure"},
  {"--rows", NULL, "FILE.csv", TAKES_FILE, "csv", C(SWEEP), PASSED, "the values of each run: names in the first line, a run a line below"},
  {"--zip", NULL, NULL, TAKES_NOTHING, "", C(SWEEP), PASSED, "walks the ranges together, first value with first value, instead of all combinations"},
  {"--samples", NULL, "N", TAKES_NUMBER, "", C(SWEEP), PASSED, "N samples of the names that have a distribution"},
  {"--sampling", NULL, "random|lhs|sobol|halton", TAKES_CHOICE, "random lhs sobol halton", C(SWEEP), PASSED,
   "how they are spread: at random (the default), by Latin hypercube, or by a quasi-random sequence (the last two need GSL)"},
  {"--seed", NULL, "K", TAKES_NUMBER, "", C(SWEEP), PASSED, "other random numbers; default: 1"},
  {"--threads", NULL, "N", TAKES_NUMBER, "", C(SWEEP), PASSED, "threads; default: one a processor"},
  {"--lanes", NULL, "1|4|8", TAKES_NUMBER, "", C(SWEEP), PASSED, "runs that a thread computes at once, in the lanes of vectors; default: as many as the processor has"},
  {"--mpi", NULL, "K", TAKES_NUMBER, "", C(SWEEP), PASSED, "K processes, by `mpirun -n K`, each with --threads, 1 by default"},
  {"--shard", NULL, "I/N", TAKES_TEXT, "", C(SWEEP), PASSED, "only part I of N, to be run on several machines: kept in FILE.I-of-N.journal"},
  {"--merge", NULL, "N", TAKES_NUMBER, "", C(SWEEP), PASSED, "joins the N parts, beside FILE, and writes the rows"},
  {"--resume", NULL, NULL, TAKES_NOTHING, "", C(SWEEP), PASSED, "goes on with a sweep that was interrupted"},
  {"--yes", NULL, NULL, TAKES_NOTHING, "", C(SWEEP), PASSED, "begins a sweep of more than a day or 10 GB"},
  {"--precision", NULL, "double|long|quad", TAKES_CHOICE, "double long quad", SIMULATE | C(LYAPUNOV) | C(SWEEP) | C(BUILD), OWN(precision),
   "numbers of the simulator: 16, 19 or 34 digits; gsl-* methods are for double only"},
  {"--like", NULL, "MODEL", TAKES_TEXT, "", C(NEW), OWN(like), "the model of the gallery to begin with"},
  {"--clear", NULL, NULL, TAKES_NOTHING, "", C(CACHE), OWN(clear), "removes all simulators from the cache"},
  {"--define", "-D", "CONST=VALUE", TAKES_DEFINE, "", MODELS, OWN(defines), "gives a `const` of the model another value"},
  {"--no-gsl", NULL, NULL, TAKES_NOTHING, "", STEPS | C(MODES) | C(COST) | C(SWEEP) | C(BUILD), OWN(no_gsl),
   "leaves the gsl-* methods out: a binary that links GSL is GPL-3 as a whole"},
  {"--shared", NULL, NULL, TAKES_NOTHING, "", C(BUILD), OWN(shared), "a shared library in place of a simulator"},
  {"--math", NULL, "own|libm", TAKES_CHOICE, "own libm", STEPS | C(MODES) | C(COST) | C(SWEEP) | C(DERIVE) | C(BUILD) | C(HEADER) | C(EMIT) | C(FMU), OWN(math),
   "sin and cos from functions in the emitted C (own, the default: faster, the same digits with every C library), "
   "or from the C library"},
  {"--with", NULL, "linear", TAKES_CHOICE, "linear", C(BUILD) | C(EMIT), OWN(with), "with the exact linearisation of the model"},
  {"--with", NULL, "PART,PART", TAKES_CHOICES, "rhs mass inverse jac linear params constraints events names rk4 rk45 dop853 symplectic_euler verlet verlet4 verlet6 verlet8 variational taylor moreau all", C(HEADER), OWN(with),
   "more functions in the header: rhs, the right-hand side of first order; mass, the mass matrix and the bias; inverse, inverse dynamics; jac, linear, params, Jacobians by state, inputs and parameters; "
   "constraints; events, steps to events; names, a table of names; methods: rk45, dop853, verlet, variational, taylor, moreau, ...; all: those that the model has"},
  {"--for", NULL, "LIBRARY,LIBRARY", TAKES_CHOICES, "gsl cvode arkode ida casadi", C(HEADER), OWN(target),
   "callbacks for these libraries in the header: GSL's system; right-hand side, Jacobian and root functions of SUNDIALS, residual of IDA; CasADi's external function"},
  {"--prefix", NULL, "NAME", TAKES_TEXT, "", C(HEADER), OWN(prefix), "how names in the header begin; without it, as its file is called"},
  {"--fmi", NULL, "2|3", TAKES_CHOICE, "2 3", C(FMU), OWN(fmi), "version of the standard; default: 2, which more tools read"},
  {"--also-cc", NULL, "CC,CC", TAKES_TEXT, "", C(FMU), OWN(also_cc),
   "compilers for other machines, whose binaries the FMU has, too: --also-cc x86_64-w64-mingw32-gcc for Windows"},
  {"--fix", NULL, "NAME,NAME", TAKES_PARAMS, "all", SIMULATE | C(SWEEP) | C(DERIVE) | C(BUILD) | C(HEADER) | C(EMIT) | C(FMU), OWN(fix),
   "replaces these parameters by numbers, with the scene's values: fewer operations, but no other value on the command line; "
   "a family by its name, drag.c for an effect's; all: every parameter"},
  {"--dump", NULL, "STAGE,STAGE", TAKES_CHOICES, "ast eqns passes prog", MODELS, OWN(dump), "prints the results of these stages of the compiler: ast, eqns, passes, prog"},
  {"--help", "-h", NULL, TAKES_NOTHING, "", MODELS | C(COMPLETION) | C(CACHE) | C(NEW), OWN(help), "this help"},
};
enum { N_OPTIONS = sizeof options / sizeof *options };

/* ---- look-ups ---- */

const CommandRow *command_row(size_t i) { return i < N_COMMANDS ? &commands[i] : NULL; }
const OptionRow *option_row(size_t i) { return i < N_OPTIONS ? &options[i] : NULL; }

Command command_named(const char *word) {
  if (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0) return CMD_HELP;
  if (strcmp(word, "--version") == 0) return CMD_VERSION;
  for (size_t i = 0; i < N_COMMANDS; i++)
    if (strcmp(word, commands[i].name) == 0) return commands[i].command;
  return CMD_NONE;
}

const CommandRow *command_find(Command c) {
  for (size_t i = 0; i < N_COMMANDS; i++)
    if (commands[i].command == c) return &commands[i];
  return NULL;
}

const OptionRow *option_find(Command c, const char *arg, const char **value) {
  *value = NULL;
  for (size_t i = 0; i < N_OPTIONS; i++) {
    const OptionRow *o = &options[i];
    if (!(o->commands & 1u << c)) continue;
    size_t n = strlen(o->name);
    if (strncmp(arg, o->name, n) == 0 && (arg[n] == '\0' || arg[n] == '=')) {
      if (arg[n]) *value = arg + n + 1;
      return o;
    }
    if (!o->brief || strncmp(arg, o->brief, 2) != 0) continue;
    if (arg[2] && o->takes != TAKES_DEFINE) continue; /* -DN=5, but no -ofile */
    if (arg[2]) *value = arg + 2;
    return o;
  }
  return NULL;
}

int option_takes_next(Command c, const char *word) {
  const char *joined = NULL;
  const OptionRow *row = option_find(c, word, &joined);
  return row && row->takes != TAKES_NOTHING && !joined;
}

int option_expert(const OptionRow *o) { return has_word("--math --fix --dump --no-gsl --define --precision", o->name); }

int command_simulates(Command c) { return ((STEPS | C(MODES) | C(COST) | C(SWEEP)) & 1u << c) != 0; }
int command_takes_values(Command c) { return command_simulates(c) || c == CMD_VERIFY || c == CMD_ACTION; }
int command_reads_model(Command c) { return (MODELS & 1u << c) != 0; }
