/* The tables of commands and options, with the texts of help, and look-ups in them. */
#include "commands/command_table.h"

#include <string.h>

#include "base/words.h"
#include "kernels/steppers.def"

/* ---- the commands ---- */

static const CommandRow commands[] = {
    {CMD_CHECK, "check", NULL, "MODEL [SCENE] [--allow-numeric] [--verbose] [--json]",
     "parse, derive, prove symmetries and `expect` lines",
     "Parses and derives the model for every scene (or the one named), and proves or refutes its `expect` lines. A "
     "proved line holds for all states at which both sides have real values; a refuted line comes with a state at "
     "which its sides differ. Exit status 0 if all is well, 1 if not.\n\n"
     "Every command compares its compiled programs with the text of the model, evaluated by Taylor arithmetic at "
     "random states; --verbose lists the comparisons."},
    {CMD_VERIFY, "verify", NULL, "MODEL [SCENE] [name=value ...] --against FILE.c:FUNCTION [--map NAMES]",
     "compare a function by hand with the derived equations",
     "Compares a right-hand side written by hand in C with the derived equations, in 34 digits where the C compiler "
     "has libquadmath, else in 19, at 75 states: the scene's start, states with its parameters, and states with "
     "others. The function is compiled as it is written:\n\n"
     "  void f(double t, const double *y, double *dydt, const double *p)\n\n"
     "y holds coordinates, velocities, states of the model; p its parameters in order of declaration; all in SI units. "
     "The function may return int, 0 for success, and may have GSL's arguments, `void *params` last.\n\n"
     "A difference counts if roundings do not explain it: the function is called with four directions of rounding, and "
     "with arguments some roundings beside each state. Where it differs, the state with the largest difference is "
     "shown, and the mistake, if one explains all: a sign, a factor, a missing term, swapped parameters, another order "
     "of y. Constraints: states that obey them. Contacts are open.\n\n"
     "  name=value            a parameter, held at this value at all states, for a\n"
     "                        function that has it as a number; a start; an input\n\n"
     "Exit status 0: it agrees; 3: it differs, crashes or does not return."},
    {CMD_DERIVE, "derive", NULL,
     "MODEL [SCENE] [--format text|latex|c] [--ops] [--hamiltonian | --lagrangian | --bracket 'F, G' | --in NAME] [-o "
     "FILE]",
     "print the equations of motion",
     "Prints the equations of motion: momenta, M q'' = f, energy, and the operation count; with --hamiltonian, "
     "momenta, H(q, p) and Hamilton's equations. Equations of five or more members of a family that differ by their "
     "index become one, `for i in 1..9`, and such terms a sum. The mass matrix is inverted in closed form if it has "
     "blocks of up to three coordinates with short results. --lagrangian goes back from a model that gives its "
     "Hamiltonian, and says where the velocities determine the momenta. --bracket 'F, G' prints the Poisson bracket of "
     "two expressions, with {x, p} = 1; {F, {G, H}} may stand in it. --in NAME prints the Hamiltonian and Hamilton's "
     "equations in the variables of a canonical transformation of the model, once it is proved; of a change of "
     "coordinates, the equations of motion."},
    {CMD_NOETHER, "noether", "symmetries",
     "MODEL [SCENE] [--degree 2|3|4] [--involution] [--seconds S] [--format text|latex|json] [-o FILE]",
     "find symmetries and conserved quantities",
     "Searches for the symmetries of L: transformations of coordinates, affine in them with coefficients that depend "
     "on time, and of time, that change L by a total derivative dF/dt at most. Every listed symmetry is proved, and "
     "shown with its generator, its F and its charge; then come the Poisson brackets of the charges, declared "
     "symmetries, cyclic coordinates, and a scaling that maps solutions to solutions.\n\n"
     "--degree 2 (3, 4) looks for charges that are polynomials of that degree in the momenta, too, such as the "
     "Runge-Lenz vector: their coefficients are polynomials of the coordinates, times functions that stand in L. Each "
     "is proved; products of charges already known are not listed.\n\n"
     "--involution reports a largest set of independent charges in involution: those listed, squares of angular "
     "momenta, and conserved functions that the model declares in `expect {f, g} = h`, `observe` and `symmetry`. All "
     "their brackets are proved to be 0; with n of them the motion is integrable in Liouville's sense.\n\n"
     "--seconds S is the processor time for the search; its matrices take half a gigabyte at most. What could not be "
     "searched in it is said.\n\n"
     "Without a scene the model has no effects, and a list shows how each effect alone changes the balance that "
     "replaces dQ/dt = 0."},
    {CMD_ACTION, "action", "actions", "MODEL [SCENE] [name=value ...] [--json]",
     "action variables and their frequencies, in numbers",
     "Computes the action variable of each coordinate at the scene's start, J = 1/(2 pi) times the closed integral of "
     "p dq between the turning points at the start's energy, and its frequency omega = dE/dJ, to about 15 digits. The "
     "model has one coordinate, or separates in its coordinates: the momentum of a cyclic angle is its action; a "
     "coordinate whose dH/dq and dH/dp have a ratio free of the others has a curve of its own; the same, then, for "
     "those that are left; and all that are left then, where Levi-Civita's conditions hold for every two of them. The "
     "separated equations are printed, or the two coordinates whose condition fails.\n\n"
     "A coordinate that goes round has the mean of p over a turn as its action; one that does not turn has none, and "
     "the line says why. Where H depends on t, it is held at the start's t.\n\n"
     "  name=value            a parameter, or another start\n\n"
     "Exit status 3: there is no action variable."},
    {CMD_RUN, "run", NULL, "MODEL [SCENE] [name=value ...] [options]", "simulate",
     "Runs the model: at once, evaluated by liblag, or by its simulator from the cache. What runs long is compiled "
     "meanwhile, kept in the cache, and changed over to, with the same digits; a large model is compiled first.\n\n"
     "  name=value            a parameter, a start (th=1.2, \"th'=0.5\", th='90[deg]',\n"
     "                        th=pi/3) or an input; a bare number is in the declared\n"
     "                        unit; drag.c=0.2 for one of an effect, m=3 for a family\n"
     "  u=FILE.csv            a table for the input u; 'u=2*sin(t/(1 [s]))' a formula"},
    {CMD_PLOT, "plot", "picture",
     "MODEL [SCENE ...] [name=value ...] [--x EXPR --y EXPR | --phase EXPR | --portrait | --potential | --cloud N | "
     "--distance | --energy-error]",
     "simulate and draw, as SVG",
     "Runs the model and draws it: all outputs against time, or one quantity against another. EXPR is any expression "
     "of the model: th, energy, an observable, 'l1*sin(th1)', \"th1' - th2'\". Several scenes, or methods (--method "
     "euler,verlet), are drawn in one picture, with a legend. All options of `lagc run` are allowed."},
    {CMD_ANIMATE, "animate", NULL, "MODEL [SCENE] [name=value ...] [--points 'X,Y X,Y'] [--trace]",
     "simulate and show the motion, as one HTML file",
     "Runs the model and writes its motion as one HTML file, which needs no network and no other file: space plays and "
     "pauses, arrow keys step, the slider scrubs. All options of `lagc run` are allowed."},
    {CMD_MODES, "modes", "equilibrium", "MODEL [SCENE] [name=value ...] [--steady | --amplitude] [--json]",
     "equilibrium, stability, frequencies, shapes and damping",
     "Finds the equilibrium next to the scene's start, says whether it is stable and by which argument, and prints the "
     "modes of small motion about it: frequencies, damping, shapes. The linearisation is exact; with constraints and "
     "rotations it has 11 to 13 digits.\n\n"
     "Velocities of the start do not matter; with --steady they do: a top that spins, a wheel that rolls, a bicycle "
     "that runs straight. In a shape the coordinate with the largest kinetic energy is 1 of its declared unit; 0.5@-90 "
     "is an amplitude of 0.5, a quarter of a period behind. A zero mode is `free` if no force arises far along the "
     "mode. Needs GSL. Exit status 3: no equilibrium was found.\n\n"
     "  name=value            a parameter, another start (th=3), an input to hold"},
    {CMD_LINEARIZE, "linearize", "linearise",
     "MODEL [SCENE] [name=value ...] [--equilibrium | --steady] [--json | -o FILE]",
     "state space: A, B, C, D of small changes",
     "Prints the linear system of small changes about the scene's start, y' = A y + B u, out = C y + D u: y is the "
     "coordinates, velocities and states, u the inputs, held at their values at the start; out the scene's outputs. "
     "Numbers are in SI units. A and B are exact, with constraints and rotations they have 11 digits, as C and D "
     "have.\n\n"
     "  name=value            a parameter, another start, an input to hold"},
    {CMD_ORBIT, "orbit", "periodic",
     "MODEL [SCENE] [name=value ...] [--guess T | --period T] [--hold NAMES] [--relative NAMES | --reverse MAP] "
     "[--manifold KIND -o FILE.csv] [--to SCENE --section 'x rising'] [--json]",
     "periodic motions: period, multipliers, stability",
     "Finds the periodic motion next to the scene's start, by Newton's method on the exact tangent of the flow, and "
     "prints its period, the Floquet multipliers with their meaning, and a scene to paste that starts on it. The error "
     "of the period is its change by a more precise run.\n\n"
     "The period is unknown: without --guess the motion is run until it first comes back next to its start. Where a "
     "scene is driven in time, it is the period of the drive, which is found; --period T names a multiple. Where "
     "motions form families, as where energy is conserved, the nearest one is taken; --hold energy, or the name of any "
     "conserved charge, coordinate or velocity, keeps its value at the start: --hold y is the section y = y(0). "
     "--relative spin: the motion may close after a rotation, or another symmetry that the model declares and lagc has "
     "proved, or after an exchange of coordinates; --reverse solves half of a motion that is the same backwards.\n\n"
     "Multipliers that are 1 by the phase, by conserved charges and by their symmetries are counted, not listed. "
     "Motions may go over events that set velocities, switches and contacts; where there is no tangent runs from "
     "beside the start replace it. Needs GSL. Exit status 3: no periodic motion was found.\n\n"
     "  name=value            a parameter, another start (th=3), an input to hold"},
    {CMD_CONTINUE, "continue", "bifurcation",
     "MODEL [SCENE] NAME=A..B [name=value ...] [--guess T | --period T | --steady] [--hold NAMES] [--branches] "
     "[-o FILE.csv] [--resume FILE.csv] [--svg FILE.svg] [--json]",
     "rest, steady and periodic motions over a parameter: folds, bifurcations",
     "Follows a state of rest, a steady motion (--steady), or a periodic motion, while a parameter runs over a range, "
     "round folds, too (pseudo-arclength continuation), and locates the points where it changes: folds, branch points, "
     "Hopf points, period doublings, Neimark-Sacker points, collisions of multipliers of Hamilton's equations. It "
     "begins at the scene's value of the parameter if that lies in the range, and goes both ways.\n\n"
     "NAME is a parameter; or, for a family of periodic motions, `energy` or another conserved charge, `period`, a "
     "coordinate or velocity at the start: the amplitude of a nonlinear mode. Periodic motions are followed where the "
     "scene depends on time, and where one of --guess, --period, --hold, --relative or such a NAME is given (the "
     "options of `lagc orbit`); else states of rest. Conserved charges keep their values unless one is NAME or --hold "
     "names others; --period T is kept in place of the energy.\n\n"
     "Derivatives by the parameter are differences, one-sided at its bounds; a constant is compiled as a parameter. A "
     "and B are in the declared unit, or the unit behind them: th=5..170[deg]. Needs GSL. Exit status 3: no solution "
     "was found to begin with.\n\n"
     "  name=value            a parameter, another start (th=3), an input to hold"},
    {CMD_LYAPUNOV, "lyapunov", "exponents", "MODEL [SCENE] [name=value ...] [--until T] [--exponents K] [--json]",
     "Lyapunov exponents: how fast neighbouring motions part",
     "Runs the scene for a long time with the exact tangent of its flow, and prints the Lyapunov exponents: the mean "
     "rates at which small changes of the start grow, in the space of coordinates, velocities and states. The spread "
     "is the standard error from 20 blocks of the time measured; `at half the time` is the estimate then. An exponent "
     "of zero approaches 0 as log(t)/t. Method and steps are chosen as for `lagc run`: --method, --tol, --step.\n\n"
     "  name=value            a parameter, another start, an input: as for lagc run"},
    {CMD_FIT, "fit", "estimate",
     "MODEL [SCENE ...] [name=value ...] --data FILE.csv --fit NAME,NAME [--sigma X] [--svg FILE]",
     "parameters and starts from a measured motion, with errors",
     "Finds the parameters and starts with which the motion is nearest to measured values, by nonlinear least squares "
     "on exact derivatives. A column of the data is any expression of the model with its unit: t [s],th "
     "[deg],l*sin(th) [cm]; rows are at any times. Records are fitted from short to long. A parameter that is declared "
     "> 0 stays so.\n\n"
     "The report has values with standard errors, chi squared where the errors of the data are given, a test whether "
     "the residuals have a trend, the combinations that the data cannot tell apart, `only g/l: (g, l) along (9.81, 1) "
     "changes nothing`, and a scene to paste. Several scenes are ranked: which effects do the data call for? Needs "
     "GSL.\n\n"
     "  name=value            a parameter or start: where the search begins, or held\n\n"
     "Exit status 3: the motion failed at the first values, or the search did not converge."},
    {CMD_DESIGN, "design", NULL,
     "MODEL [SCENE] [name=value ...] --fit NAME,NAME --sigma X [--best N] [--every DT] [--json]",
     "where and when to measure, so that values are determined best",
     "Takes each output of the scene at the time of each row as a possible measurement, and finds the N whose "
     "information on the values of --fit has the largest determinant (D-optimal), by exact derivatives and exchanges. "
     "Prints them, with the standard errors that a fit of them would have, beside those of as many at equal "
     "distances and of all. --observe adds an output; --prior is what is known already.\n\n"
     "  name=value            a parameter or start: the best guess so far\n\n"
     "Exit status 2: the measurements cannot determine the values; the message names what none of them feels."},
    {CMD_COST, "cost", NULL, "MODEL [SCENE] [name=value ...] [--target X] [--seconds S] [-o FILE.svg]",
     "time against accuracy: all methods, side by side",
     "Names the fastest settings for errors of 1e-3, 1e-6, 1e-9 and 1e-12, or of --target X; then prints the time that "
     "the best method of each family takes for errors of 1e-2 to 1e-14, and the front: the runs that no other beats in "
     "time and error. Methods are tried from coarse to fine tolerances or steps, those near the front first, for "
     "--seconds S in all. The error is the largest difference, at 16 times, from a reference by Taylor series in the "
     "highest available precision, relative to the largest value of its kind and unit. Times are measured on this "
     "processor, now. Ctrl-C prints what is known.\n\n"
     "  name=value            a parameter, another start, an input, as for `lagc run`\n\n"
     "Exit status 3: no setting reaches the target."},
    {CMD_SWEEP, "sweep", "ensemble", "MODEL [SCENE] NAME=RANGE ... [--measure EXPR ...] -o FILE",
     "many runs: parameters and starts over ranges, or samples",
     "Runs the scene once for each combination of the values of all ranges, and writes a row a run: the values, the "
     "measures, and a status. Runs share the work of all processors; a run has the same numbers in any order.\n\n"
     "  name=A..B:N           N values from A to B, in equal steps\n"
     "  name=A..B:log:N       in equal ratios\n"
     "  name=A,B,C            these values; --zip: ranges are walked together\n"
     "  name~normal(M, D)     --samples N: around the mean M, with deviation D,\n"
     "  name~uniform(A, B)    or between A and B, which name=A..B says, too\n"
     "  name=value            for all runs, as for `lagc run`\n\n"
     "Ranges have units as values have: th=-180..180[deg]:512. Names are those that `lagc run` sets: parameters, "
     "starts, constant inputs; and constants, N=2,4,8, of which each value is compiled. With --samples, each "
     "combination of the other ranges has the same samples.\n\n"
     "Finished runs are kept in FILE.journal: after Ctrl-C, a kill or a full disk --resume goes on, and the result is "
     "the same to the byte. --mpi K shares the runs of K processes, on the machines that mpirun finds. Exit status 3 "
     "has no use here: a run that fails is a row with its reason."},
    {CMD_EFFECTS, "effects", NULL, "MODEL [SCENE] [name=value ...] [--accuracy X] [--json]",
     "cost of each effect, and whether the result needs it",
     "Runs the scene, then without each effect that the scene uses, and with each effect that it does not use. Prints "
     "for each effect its operations and its share of the time of a call of the right-hand side; its weight, the "
     "largest ratio of |acceleration with - without it| to |acceleration| along the run; its difference, the largest "
     "change at 256 times of the run and at its end, relative to the largest value of its kind and unit; and whether "
     "the difference exceeds twice the error of integration, measured by a run with a hundredth of the tolerance, or "
     "half the step. An effect is left out together with those that require it. `shared` are operations that several "
     "effects need. Method, steps and end are chosen as for `lagc run`: --method, --tol, --step, --until. `lagc help "
     "effect` says more.\n\n"
     "  name=value            a parameter, another start, an input, as for `lagc run`\n\n"
     "--accuracy X searches for the smallest set of the scene's effects whose result differs from the scene's by at "
     "most X: with all other effects left out together, in scenes of up to ten effects. Prints the `use` line of the "
     "set that it finds."},
    {CMD_BUILD, "build", NULL, "MODEL -o SIMULATOR [--shared [--lanes]] [--method NAME] [--with linear]",
     "make a simulator, or a shared library",
     "Compiles the model to a simulator with all its scenes; it has the options of `lagc run`, which `SIMULATOR "
     "--help` lists.\n\n"
     "With --bytes it writes what `lag-run`, which stands beside liblag.a, evaluates: LAG_PROGRAM=FILE lag-run. With "
     "--shared it compiles a shared library, which exports the functions of lag.h by the same names for every model: "
     "simulations, rows, events, charges, tangents, batches, which with --lanes compute several motions at once. It "
     "links no GSL. Without -o it is kept in the cache, and its path is printed. lagc.py uses it from Python."},
    {CMD_HEADER, "header", "embedding", "MODEL [SCENE] [--with PART,...] [--for LIBRARY,...] -o FILE.h",
     "write one C header to embed",
     "Writes one self-contained C99/C++ header to embed: parameters as a struct, accelerations, energy, an RK4 step. "
     "It includes nothing but <math.h>, allocates nothing and has no globals. Its names begin with the file's:\n\n"
     "  lagc header models/pendulum.lag -o pend.h\n\n"
     "and in one file of a program\n\n"
     "  #define PEND_IMPLEMENTATION\n"
     "  #include \"pend.h\"\n\n"
     "Other files include it without the #define; link with -lm. Its first lines show its use. With PEND_LANES defined "
     "as 4 or 8 it computes 4 or 8 states at once, by rk45, dop853 and taylor (--with) each with a step size and an "
     "end of its own; pend_step_until_event, variational and moreau compute one state: over lanes a call of them does "
     "not compile, and says so.\n\n"
     "Contacts are followed by `pend_moreau_step`, with friction and however many they are (--with moreau; models of "
     "contacts with friction have it anyway). The state says which of them press, slip, stick, or were struck in the "
     "step. With --with moreau dry friction of joints sticks, too; other steps decide at each state.\n\n"
     "With --for it also has callbacks for solvers, exact Jacobians included, and includes their headers: "
     "`gsl_odeiv2_system sys = pend_gsl_system(&data);`, `CVodeInit(cvode, pend_cvode_rhs, t, y);`, or in Python "
     "`casadi.external(\"pend_ode\", \"./pend.so\")`. Where the model has constraints, accelerations obey them, "
     "positions drift as far as the solver's errors do (`pend_hold` leads back)."},
    {CMD_EMIT, "emit", NULL, "MODEL [SCENE] [--method NAME] [--with linear] [--standalone] [-o FILE.c]",
     "write C for the runtime",
     "Writes C for the runtime: a `const lag_model` and a `const lag_scene` (see lag_model.h). liblag "
     "integrates them; its interface is lag.h:\n\n"
     "  cc main.c pendulum.c $(pkg-config --cflags --libs liblag)\n\n"
     "With -DLAG_LANES=4 or 8 its functions take vectors of 4 or 8 doubles, and compute as many states at once.\n\n"
     "The file begins with the model; what models have in common, sines and linear systems, it includes from "
     "lag_math.h and other headers beside lag_model.h. With --standalone it has these functions itself."},
    {CMD_FMU, "fmu", "fmi", "MODEL [SCENE] -o FILE.fmu [--fmi 2|3] [--also-cc CC,CC]",
     "write an FMU, for Simulink, Modelica tools and others",
     "Writes the scene as a Functional Mock-up Unit (FMI 2.0, or 3.0), for model exchange and co-simulation: sources "
     "and a binary for this machine, which need nothing of lagc. Coordinates, velocities and states are its continuous "
     "states, with the starts of the scene; the scene's outputs are outputs; parameters can be set, within their "
     "declared signs; an input follows its formula until the importer sets it; events act, and `stop` ends the "
     "simulation. Effects are those of the scene. Values are in SI units, display units are the declared ones. "
     "Co-simulation steps by the scene's method, if that is an explicit Runge-Kutta one and the model has no events, "
     "else by dop853, at the tolerance of the experiment; with dry friction by moreau, with steps that this tolerance "
     "chooses.\n\n"
     "CC names the compiler, and so the machine: CC=x86_64-w64-mingw32-gcc makes an FMU for Windows; `--also-cc "
     "x86_64-w64-mingw32-gcc` makes one for both. A model with contacts is for co-simulation alone, by steps of the "
     "method moreau, of the size that its scene gives, whatever the tolerance is. Constraints that hold while a "
     "condition is true are refused."},
    {CMD_PAGE, "page", NULL, "MODEL [SCENE ...] -o FILE.html", "a page that computes the motion, as one HTML file",
     "Writes one HTML file that computes the motion as one watches: it has liblag as WebAssembly and the programs that "
     "were compared with the text, and needs no network and no compiler. Bodies can be dragged, parameters have "
     "sliders, effects switches: a program for each set of effects, where there are at most four, so that only what is "
     "switched on is computed. Methods and their tolerance or step can be changed while it runs, beside the drift of "
     "the energy and the time that a second of motion takes. The drawing is the model's (`lagc help draw`). The state "
     "of all controls is in the page's address."},
    {CMD_PLAYGROUND, "playground", NULL, "[MODEL] -o FILE.html", "lagc itself as a page: type a model, see it move",
     "Writes one HTML file that has lagc as WebAssembly: one types a model, and sees messages at their places, the "
     "equations, what is proved, the symmetries that a search finds, and the motion. It needs no network and no "
     "compiler; nothing is sent anywhere. It begins with MODEL, or offers some of the gallery. The text is in the "
     "page's address, to be shared as a link; of files that a model names it has those of models/lib."},
    {CMD_METHODS, "methods", NULL, "", "list the methods of integration",
     "Lists the methods of integration: their order, the quantities that they keep, their demands on a model, and "
     "their options."},
    {CMD_MODELS, "models", "gallery", "[WORD]", "list the models that come with lagc",
     "Lists the gallery, with titles; with a word, the models whose name or title has it. Every command takes one of "
     "them by name:\n\n"
     "  lagc run @double_pendulum chaos --sketch"},
    {CMD_NEW, "new", NULL, "NAME [--like MODEL]", "start a model from one of the gallery",
     "Writes NAME.lag here, a copy of a model of the gallery under the new name: of the model that --like names, else "
     "of one with a similar name, else of pendulum. No file is overwritten."},
    {CMD_CACHE, "cache", NULL, "[--clear]", "show or empty the cache of simulators",
     "Shows the folder of built simulators, their number, their size and its limit; beyond the limit, simulators that "
     "were used longest ago are removed. Simulators are run only from a folder of yours that nobody else can write. "
     "LAGC_CACHE_MIB sets another limit, in MiB."},
    {CMD_HELP, "help", NULL, "[WORDS]", NULL,
     "Says more on a command, a word of the language, a unit, a function or an option; alone, lists the topics. "
     "Other words are searched in all pages, in the reference, the tutorial and README, and what answers them is "
     "shown, the best first: `lagc help normal modes`."},
    {CMD_COMPLETION, "completion", NULL, "bash|zsh|fish", "print the completion script of a shell",
     "Prints the script by which a shell completes the commands and options of lagc, and the scenes, parameters, "
     "methods and names of "
     "the model in question. `make install` puts it where these shells look; without `make install`,\n\n"
     "  source <(lagc completion bash)    in ~/.bashrc\n"
     "  source <(lagc completion zsh)     in ~/.zshrc, after compinit\n"
     "  lagc completion fish | source     in ~/.config/fish/config.fish"},
    {CMD_VERSION, "version", NULL, "", NULL, "Prints the version."},
    {CMD_COMPLETE, "complete", NULL, "WORD...", NULL, NULL},  /* for completion scripts: see completion.h */
    {CMD_MANPAGE, "manpage", NULL, "[markdown]", NULL, NULL}, /* for `make install`, and for grammar/LANGUAGE.md */
};
enum { N_COMMANDS = sizeof commands / sizeof *commands };

/* ---- the options ---- */

#define C(name) ((CommandSet)1 << CMD_##name)
#define SIMULATE (C(RUN) | C(PLOT) | C(ANIMATE))
#define STEPS (SIMULATE | C(LYAPUNOV) | C(EFFECTS) | C(FIT) | C(DESIGN))
#define RUNS (STEPS | C(SWEEP) | C(ORBIT) | C(CONTINUE)) /* commands that run a scene, once or many times */
#define MODELS                                                                                                        \
  (RUNS | C(MODES) | C(LINEARIZE) | C(COST) | C(CHECK) | C(VERIFY) | C(DERIVE) | C(NOETHER) | C(ACTION) | C(BUILD) | \
   C(HEADER) | C(EMIT) | C(FMU) | C(PAGE))

static const OptionRow options[] = {
#define TO(f) offsetof(Options, f)
#define OWN_FLAG TO
#define OWN_TEXT TO
#define OWN_LIST TO
#define LAGC(name, brief, value, takes, hint, commands, field, text) \
  {name, brief, value, takes, hint, commands, 0, field, text},
#define BOTH(name, brief, value, takes, hint, commands, analyses, field, text) \
  {name, brief, value, takes, hint, commands, 1, 0, text},
#define SIMULATOR(...)
#include "app/options.def"
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
    if (!(o->commands & command_bit(c))) continue;
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

int option_listed(const OptionRow *o, Command c) {
  return (o->commands & command_bit(c)) != 0 && (c == CMD_RUN || !o->passed || !(o->commands & command_bit(CMD_RUN)));
}

int option_expert(const OptionRow *o) { return has_word("--math --fix --dump --no-gsl --define --precision", o->name); }

int command_simulates(Command c) { return ((RUNS | C(MODES) | C(LINEARIZE) | C(COST)) & command_bit(c)) != 0; }
int command_takes_values(Command c) { return command_simulates(c) || c == CMD_VERIFY || c == CMD_ACTION; }
int command_reads_model(Command c) { return (MODELS & command_bit(c)) != 0; }
