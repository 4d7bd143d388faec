/* lag.h: the public interface of liblag, the runtime of compiled Lagrangians.
 *
 * It takes a scene (lag_model.h), emitted by lagc, and computes its trajectory. A simulation is one opaque object; a
 * method of integration is a const descriptor, and a new method is a new file.
 *
 * Conventions, everywhere below: values are in SI units unless "declared unit" is said; arrays are dense; y = [q[nq]
 * | v[nq] | z[nz]] has n = 2 nq + nz elements; the library never keeps a pointer into an array of the caller, and
 * arrays passed to one call do not overlap. No function here is thread-safe on one object; different objects are
 * independent. Nothing is printed, nothing exits.
 *
 * Return values: LAG_OK is 0; > 0 is a planned stop; < 0 is a failure, and lag_sim_message() then says
 * when, where and why. After a failure the simulation holds the last accepted state. */
#ifndef LAG_H
#define LAG_H

#include "lag_libraries.h"
#include "lag_method.h"
#include "lag_model.h"

#ifdef __cplusplus
extern "C" {
#endif

#define LAG_VERSION "0.1.0"

/* Status codes, beside LAG_OK and LAG_ESINGULAR of lag_model.h. */
enum {
  LAG_STOPPED = 2,      /* an event ended the run */
  LAG_INTERRUPTED = 3,  /* the hook of lag_sim_on_step asked for it */
  LAG_ENAN = -2,        /* the model returned NaN or an infinity */
  LAG_EDOMAIN = -3,     /* the model left its domain, and smaller steps did not help */
  LAG_ESTEP = -4,       /* the step became too small for the tolerance */
  LAG_EINVAL = -5,      /* wrong argument, name, value or order of calls */
  LAG_ENOMEM = -6,
  LAG_EMONITOR = -7,    /* a monitored quantity drifted past its limit */
  LAG_EMODEL = -8,      /* the model returned another negative value */
  LAG_EZENO = -9,       /* an event repeats in ever shorter intervals */
  LAG_EMETHOD = -10,    /* the method cannot treat this model, or failed in its own way */
  LAG_EIO = -11,
  LAG_EDRIFT = -12,     /* the energy has drifted by more than its size: the numbers mean nothing */
  LAG_ESTALL = -13      /* no progress: the motion stays where a force jumps, or steps are lost in rounding */
};

/* The name of a status: "ok", "stopped", ... */
const char *lag_status_name(int status);

/* text := the shortest decimal that reads back as x, "0.1". Returns text. */
const char *lag_number_text(double x, char text[64]);

/* ---- Simulations ----------------------------------------------------------------------------- */

typedef struct lag_sim lag_sim;

typedef struct lag_stats {
  double t;
  long long steps, rejected, rhs_calls, events;
  long long systems, iterations; /* nonlinear systems solved within steps, and Newton corrections */
  double energy;        /* now */
  double energy_drift;  /* drift of charge 0 below; NaN when the model has no energy */
  /* largest |c| of a holonomic constraint and |r| of any (lag_model.h) at ends of steps [SI]; NaN without
   * constraints */
  double constraint, constraint_rate;
  double unresolved;    /* a period shorter than two steps of equal size [s]; NaN: none was seen */
} lag_stats;

/* Trend of a charge along a run: of its energy (number 0), or of the charge of a symmetry. */
enum {
  LAG_TREND_UNKNOWN,    /* too few steps */
  LAG_TREND_ROUNDING,   /* the drift is within the rounding that so many steps accumulate */
  LAG_TREND_OSCILLATES, /* a line does not explain the variation of its averages over parts of the run */
  LAG_TREND_GROWS       /* a line explains the variation */
};

typedef struct lag_charge_stats {
  const char *name, *unit; /* SI unit; strings of the scene */
  /* LAG_CONSERVED, LAG_BALANCED (lag_model.h); neither: its rate is not known, or not integrated (lag_sim_balance) */
  unsigned flags;
  double begin, now;    /* Q */
  double work;          /* int P dt, where P = dQ/dt is known and not 0 */
  /* of the energy: the part of `work` that dry friction does; NaN: the model has none, or it is not integrated */
  double dry_friction;
  /* of the energy: its change at events, as by impacts and where constraints begin to hold; 0: other charges */
  double at_events;
  /* largest |Q - int P dt - Q0| over the run, without jumps at events, relative to the larger of |Q0| and the median
   * over the run of the sum of |terms| of Q (a median, as a blow-up at the end would raise the maximum) */
  double drift;
  double absolute;      /* drift in `unit` */
  /* slope of a line fitted to Q - int P dt, relative as drift [1/s], and its standard error; NaN: too few steps */
  double slope, slope_error;
  int trend;
  /* of the energy: largest change within one step, relative like drift, and its time; 0: rounding, or not computed
   * (constant mass matrix, more than 64 coordinates) */
  double energy_jump, energy_jump_t;
  double mass_condition;        /* estimated condition of the mass matrix there; NaN: not known */
  const char *mass_condition_of; /* the coordinate of least inertia there */
} lag_charge_stats;

/* Number of charges of the model; 0 without a Lagrangian. *stats := the monitor of charge k so far. */
int lag_sim_ncharges(const lag_sim *sim);
void lag_sim_charge(lag_sim *sim, int k, lag_charge_stats *stats);
/* *contacts := counts of contacts that the method meets by impulses. Returns 1; 0: it does not, or the model has
 * none. */
int lag_sim_contacts(const lag_sim *sim, lag_contact_stats *contacts);

/* All functions below: a NULL that is not allowed explicitly, a time that is not finite, or an index out of range
 * gives LAG_EINVAL and changes nothing; functions that return a number then return NAN, or 0 for an integer, and
 * functions that return a pointer NULL. */

/* A simulation of the scene at the start of its span, with the scene's method, tolerance and options. The scene must
 * outlive it. NULL: no memory, or a model of another ABI or scalar type. A method that cannot integrate the model,
 * or is not in liblag.a, is refused by the first advance, unless another one is set. Free with lag_sim_free (NULL
 * allowed). */
lag_sim *lag_sim_new(const lag_scene *scene);
void lag_sim_free(lag_sim *sim);
/* A new simulation of the same scene with the same settings: values, inputs, method, tolerance; `sim` may have
 * begun. NULL: no memory. */
lag_sim *lag_sim_like(const lag_sim *sim);
/* The same in the memory of `used`, a simulation that this function made like the same `sim`, which has not changed
 * since; another one or NULL: it is freed, and a new one is made. NULL: no memory. */
lag_sim *lag_sim_renew(lag_sim *used, const lag_sim *sim);

/* The settings below are made before the first advance; later they return LAG_EINVAL. After an error the
 * simulation is unchanged and lag_sim_message() says what to write instead. */

/* Chooses a method. opt[nopt] are options by name; the others keep their defaults. */
int lag_sim_set_method(lag_sim *sim, const lag_method *method, const lag_option *opt, int nopt);
/* The method of `lagc run` where none is named: by the tolerance, and by trials for stiffness until `until`; with
 * these options. exponents: the run carries a tangent. why[size] := the reason. */
int lag_sim_choose_method(lag_sim *sim, double until, int exponents, const lag_option *opt, int nopt, char *why,
                          size_t size);
/* tol is at least 4.5 DBL_EPSILON, about 1e-15. */
int lag_sim_set_tolerance(lag_sim *sim, double tol);
/* Sets by name, in the declared unit: a parameter ("m", "drag.c", or "c" when nothing else ends in ".c"), the start of
 * a coordinate ("th"), of its velocity ("th'") or of a state, or a constant that replaces an input; of a family one
 * member ("m[2]", "r[1].x'") or all ("m", "r.x'"). A parameter of the wrong sign is an error. */
int lag_sim_set(lag_sim *sim, const char *name, double value);
/* Component i of [q|v|z] in its declared unit: asked, as it was set; begin, where the run began. With constraints
 * they differ: the first advance moves the start to the nearest consistent position, then velocity, in the mass
 * metric: first only components that were not set, then all if needed. LAG_EINVAL then: no start is near, or the
 * scene says `exactly` and its start is another; the message names the worst constraint. */
double lag_sim_requested_start(const lag_sim *sim, int i);
double lag_sim_actual_start(const lag_sim *sim, int i);
/* Coordinate i of another start that obeys the constraints, as of the other assembly of a linkage, where nobody set
 * the coordinates that move; NaN: none was found. */
double lag_sim_other_start(const lag_sim *sim, int i);
/* Rank of the constraints at the start; whether constraint k follows from others there (not before the first
 * advance). */
int lag_sim_rank(const lag_sim *sim);
int lag_sim_is_redundant(const lag_sim *sim, int k);
/* Rank of the constraints a hundredth away from the start, if larger: a singular start, as of bars in one line.
 * is_loose: whether the velocity of coordinate i is free at the start but determined nearby; the start then chooses
 * the branch of the motion. */
int lag_sim_nearby_rank(const lag_sim *sim);
int lag_sim_is_undetermined(const lag_sim *sim, int i);
/* Makes fn(context, t) the value of the input called name ("u", "wind.gust", or "gust" where that is unique), in SI
 * units unlike lag_sim_set; fn NULL: as the model says again. It must be a function of t alone: methods, events and
 * outputs call it for times that go back and forth, more than once for some. A quantity that depends on the motion
 * is a force of the model. For full accuracy fn has two continuous derivatives, or steps are short beside its
 * changes. A value that is not finite ends the run with LAG_ENAN. context must outlive the run. A saved state does
 * not hold fn: set it again before lag_sim_load. */
int lag_sim_set_input(lag_sim *sim, const char *name, lag_input_fn *fn, void *context);
/* Integrates, along the run, the work of forces on charges, so that lag_sim_charge gives balances. Off by default,
 * unless the scene monitors a charge: it takes dense output at up to 8 places in each step. */
int lag_sim_balance(lag_sim *sim);
/* Whether the method's dense output is accurate enough for balances; otherwise they are not integrated. */
int lag_method_balances(const lag_method *method);

/* Integrates to time t, before or after t0, but always in one direction. The steps do not depend on t: the state at
 * t is evaluated on the dense output (STEPS_TO methods: reached exactly), so runs that are split differently agree
 * bit by bit. An event at exactly t happens in the next call. LAG_OK: the state is at t. LAG_STOPPED,
 * LAG_INTERRUPTED: at lag_sim_time(). < 0: failure. */
int lag_sim_advance(lag_sim *sim, double t);

/* Makes the next step towards t, unless it is made: up to *reach, lag_sim_eval and lag_sim_outputs_at know the
 * motion. *reach is t, the step's end or the next event, whichever is first. An event at the present time happens
 * here. Returns what lag_sim_advance would; after an error or stop *reach is lag_sim_time(). */
int lag_sim_ensure_step(lag_sim *sim, double t, double *reach);

/* y[n] at time t within the last step and not after the next event, else LAG_EINVAL. Does not change the present
 * state; may call the model. */
int lag_sim_eval(lag_sim *sim, double t, double *y);

/* The present state and parameters: pointers that stay valid until lag_sim_free. */
double lag_sim_time(const lag_sim *sim);
const double *lag_sim_q(const lag_sim *sim);
const double *lag_sim_v(const lag_sim *sim);
const double *lag_sim_z(const lag_sim *sim);
const double *lag_sim_p(const lag_sim *sim);
const lag_scene *lag_sim_scene(const lag_sim *sim);
const lag_method *lag_sim_method(const lag_sim *sim);
double lag_sim_tolerance(const lag_sim *sim);
/* The values of the method's options, [method->noptions]. */
const double *lag_sim_options(const lag_sim *sim);

/* Number of columns of output besides t: the scene's outputs, or q, v, z when it names none. */
int lag_sim_noutputs(const lag_sim *sim);
/* Component i of the state q, v, z: name, with a prime for a velocity, and declared unit; buffers of the caller, cut
 * to fit, either may be NULL. Returns the size of one declared unit in SI. */
double lag_sim_state_info(const lag_sim *sim, int i, char *name, size_t nname, char *unit, size_t nunit);
/* An SI value of component i, converted to its declared unit. */
double lag_sim_declared(const lag_sim *sim, int i, double value);
/* Component i of the state q, v, z now, in its declared unit. */
double lag_sim_state_value(const lag_sim *sim, int i);
/* Name and unit of output i; returns as lag_sim_state_info. */
double lag_sim_output_info(const lag_sim *sim, int i, char *name, size_t nname, char *unit, size_t nunit);
/* out[noutputs] at the present state, in declared units. */
int lag_sim_outputs(lag_sim *sim, double *out);
/* out[noutputs] at a time that lag_sim_eval knows, in declared units; y[n] := the state there. */
int lag_sim_outputs_at(lag_sim *sim, double t, double *y, double *out);

/* The tangent of the flow: Y[n * k], row-major; each column is a small change of the state, carried along exactly,
 * as the derivative of what the method computes. It begins at Y here, NULL (k = n): the identity, so that it becomes
 * dy(t)/dy(0); k = 0: ends the tangent. Call it before the first advance, after the method is set; later at ends of
 * steps only, as in the hook of lag_sim_on_step. Needs the model's linearisation, or the derivatives that an
 * implicit method needs itself. LAG_EMETHOD: method or model have no such derivatives; the message names a method
 * that has. At an event that changes the state the tangent is multiplied by the saltation matrix; the run fails
 * (LAG_EMETHOD) where that does not exist: the event depends on an input, another one changes the state at the same
 * time, or the motion only touches it. A saved state cannot be loaded into a run with a tangent. At a branch of if,
 * abs, min, max the derivative is that of the branch taken; over a jump of a force, as of dry friction, columns are
 * multiplied by the saltation matrix, which loses a rank where the motion begins to slide. With constraints the
 * columns are projected onto their tangent space, in the mass metric; derivatives are differences, to some 11 digits,
 * without the emitted reverse mode. Impacts of contacts have saltation matrices, too; a run fails where a contact
 * with friction stays closed, or one that closes after ever faster impacts. */
int lag_sim_set_tangent(lag_sim *sim, int k, const double *Y);
/* Y[n * k] at the present time; between the ends of steps, by one shorter step of the method. */
int lag_sim_tangent(lag_sim *sim, double *Y);

/* The same with a column for each of k names: a parameter, or the start of a coordinate, velocity or state ("th",
 * "th'", "th(0)"): Y = dy/dname, in SI units. A parameter acts by the equations, the scene's start, inputs' formulas,
 * other parameters that depend on it, events, constraints. Call it before the first advance, after the method and all
 * values are set. Needs, without constraints, `lagc build --with sensitivities`; methods that step in momenta have no
 * derivatives by parameters (LAG_EMETHOD). LAG_EINVAL: a name that is none of these. */
int lag_sim_set_sensitivity(lag_sim *sim, int k, const char *const *names);
/* Name of column c, of a start with "(0)", and declared unit, as lag_sim_state_info; its value in SI. */
double lag_sim_sensitivity_info(const lag_sim *sim, int c, char *name, size_t nname, char *unit, size_t nunit);
double lag_sim_sensitivity_value(const lag_sim *sim, int c);
/* D[noutputs * k]: the change of each output, in its declared unit, by each name, in SI, where Y[n * k] changes the
 * present state. Outputs are differentiated by differences of order 6, correct to 11 digits or so. */
int lag_sim_output_sensitivity(lag_sim *sim, const double *Y, double *D);

/* Reverse mode, for the gradient of few numbers by many values: record keeps the steps of a run, before its first
 * advance, after method and all values are set. Gradient: J depends on the states y at t[rows], in the order of the
 * run and not beyond it, by weight[rows * n] = dJ/dy in SI; by_start[n] := dJ by the starts, by_p[np] := by the
 * parameters, with all that follows from them as in sensitivities, both in SI. It is the derivative of the steps that
 * were made, their sizes held. With `lagc build --with derivatives`, methods that have `adjoint`, outside of
 * slides and without redundant constraints or contacts, take some three times as long as the run, however many
 * parameters there are; else it takes as long as sensitivities by all of them. With constraints, and there, t[rows]
 * have to be times of lag_sim_advance. At the time of an event y is the state before it; the state behind it has the
 * next number, by nextafter. LAG_EMETHOD: as of a tangent. */
int lag_sim_record(lag_sim *sim);
/* The same where steps take more memory than this, 2^26 bytes by default: parts of the run are repeated from marks on
 * the way back, as few times as their number allows (revolve). One gradient can then be taken. */
int lag_sim_record_within(lag_sim *sim, size_t bytes);
int lag_sim_gradient(lag_sim *sim, int rows, const double *t, const double *weight, double *by_start, double *by_p);

void lag_sim_stats(lag_sim *sim, lag_stats *stats);
/* The drift of monitor i so far, as judged against its limit: at ends of steps, and at the present time. */
double lag_sim_monitor_drift(lag_sim *sim, int i);
/* Judges monitors and the energy at the present time; advancing judges them only at ends of steps, whatever times
 * are asked for. LAG_OK; LAG_EMONITOR; LAG_EDRIFT where half of an energy that is conserved or balanced is lost or
 * created; both with a message. The run itself can continue unchanged. */
int lag_sim_judge(lag_sim *sim);
/* Closed form k of the scene (k < lag_sim_scene(sim)->nexact): the largest |motion - closed form| at the ends of
 * steps so far, and the difference now, both in the declared unit (of degC: K); of angles modulo 2 pi. NaN: the
 * closed form is not finite. */
void lag_sim_exact(lag_sim *sim, int k, double *largest, double *now);
/* Number of firings of event k, and the times of the first and the last; NaN when there was none. */
long long lag_sim_event_times(const lag_sim *sim, int k, double *first, double *last);
/* Switching surface k < model->nmodes: the time during which the motion has slid on it, how often it has crossed the
 * surface, and begun to slide; NULL: not wanted. */
double lag_sim_switch_times(const lag_sim *sim, int k, long long *crossings, long long *slides);
/* Guide k < model->nguides sticks: the part of the largest friction by which its own force holds it, which loads that
 * grow alike do not change; NaN: it slips. */
double lag_sim_guide_part(lag_sim *sim, int k);
/* The last error, "" when there was none. */
const char *lag_sim_message(const lag_sim *sim);

/* Called after each step; != 0 ends the run with LAG_INTERRUPTED. */
void lag_sim_on_step(lag_sim *sim, int (*hook)(void *context, const lag_sim *sim), void *context);
/* A clock that only goes forward [s]. */
double lag_clock_seconds(void);
/* A hook: whether the time *until of that clock, a double that another thread may set, has passed. */
int lag_time_is_up(void *until, const lag_sim *sim);
/* Called when event k fires at time t, with the state y[n] before and after its action: the same where it changes
 * nothing. The arrays are valid during the call. */
typedef void lag_event_fn(void *context, int k, double t, const double *before, const double *after);
void lag_sim_on_event(lag_sim *sim, lag_event_fn *hook, void *context);

/* save: x[lag_sim_save_size()] := everything that a later run needs. LAG_EINVAL when the method cannot be saved.
 * load: into a simulation of the same scene, method and options; x may come from anywhere: numbers that cannot be
 * such a state are refused (LAG_EINVAL), and the simulation stays as it was. */
size_t lag_sim_save_size(const lag_sim *sim);
int lag_sim_save(lag_sim *sim, double *x);
int lag_sim_load(lag_sim *sim, const double *x);
/* A checksum of everything that must agree between save and load: the scene's names, sizes, equations and method. */
unsigned long long lag_sim_signature(const lag_sim *sim);

/* ---- Shared libraries ------------------------------------------------------------------------
 *
 * `lagc build MODEL --shared -o libNAME.so` makes a library that exports the functions of this header, by the same
 * names for every model. The functions below spare other languages the structs of lag_model.h. */

/* The model's scenes: the one function that the library adds to liblag. */
const lag_program *lag_library(void);

/* LAG_ABI; scene i, NULL past the last; its name, its span and `every`, 0 where it does not say; the method that it
 * names, or NULL. */
int lag_library_abi(void);
const lag_scene *lag_library_scene(const lag_program *program, int i);
const char *lag_scene_span(const lag_scene *scene, double *t0, double *t1, double *every);
const char *lag_scene_method(const lag_scene *scene);

/* Name of item i of a kind: 'q' coordinates, 'z' states, 'p' parameters, 'u' inputs, 'e' events, 'c' charges, 'm'
 * methods; NULL past the last. *unit, unless NULL: its declared unit; *factor, *offset: x units are x*factor +
 * offset in SI. */
const char *lag_item(const lag_scene *scene, int kind, int i, const char **unit, double *factor, double *offset);
/* The method of this name, or NULL. */
const lag_method *lag_find_method(const char *name);

/* Quantities of a model at a state. Derivatives are by y, by the inputs u[nu], held at their values, or by the
 * parameters p[np], which others and inputs follow as the scene says. Outputs are in SI here. */
typedef enum lag_quantity {
  LAG_RATES,                 /* dy/dt [n] */
  LAG_RATES_BY_STATE,        /* [n n], A of control theory */
  LAG_RATES_BY_INPUTS,       /* [n nu], B */
  LAG_RATES_BY_PARAMETERS,   /* [n np] */
  LAG_OUTPUTS,               /* [noutputs] */
  LAG_OUTPUTS_BY_STATE,      /* [noutputs n], C */
  LAG_OUTPUTS_BY_INPUTS,     /* [noutputs nu], D */
  LAG_OUTPUTS_BY_PARAMETERS, /* [noutputs np] */
  LAG_MASS_MATRIX,           /* M [nq nq] */
  LAG_INVERSE_DYNAMICS       /* [nq] forces that accelerations a[nq] need besides the model's; 0 of multipliers */
} lag_quantity;

/* out[count * rows * columns] := the quantity at t[k], y[k], a[k] for `count` states in SI (a for inverse dynamics
 * alone), with parameters and inputs as set; constraints with a condition hold where that is true, contacts as in the
 * run. Returns the first status that is not 0; LAG_EMETHOD: build it --with derivatives. rhs: LAG_RATES. */
int lag_sim_quantity(lag_sim *sim, lag_quantity of, int count, const double *t, const double *y, const double *a,
                     double *out);
void lag_sim_quantity_size(const lag_sim *sim, lag_quantity of, int *rows, int *columns);
int lag_sim_rhs(lag_sim *sim, int count, const double *t, const double *y, double *dy);

/* Advances to t[0] .. t[rows - 1]: y[rows * n] := the states [SI], out[rows * noutputs] := the outputs, in declared
 * units; either may be NULL. *done: rows written. Returns as lag_sim_advance. */
int lag_sim_rows(lag_sim *sim, int rows, const double *t, double *y, double *out, int *done);

/* `count` motions with the scene, method, tolerance, inputs and values of `like`, each from its own start y0[n] and
 * with its own parameters p[np], in SI; NULL: those of `like`, as for an element of p that is NaN, which follows its
 * formula if it has one. y[count * rows * n] := the states at t[rows]; NaN from a failure or stop on. status[count]
 * := that of each. `like` stays as it is; several threads may share it. Returns LAG_OK, LAG_ENOMEM or LAG_EINVAL. */
int lag_sim_batch(const lag_sim *like, int count, const double *y0, const double *p, int rows, const double *t,
                  double *y, int *status);
/* Batches of `like` compute several motions at once, in the lanes of vectors, from a library that has its scene and was
 * built with --lanes. Returns how many, 1 where method, model or processor have none; program NULL: how many there
 * would be. */
int lag_sim_set_lanes(lag_sim *like, const lag_program *program);

/* ---- Simulators ------------------------------------------------------------------------------ */

/* Parts of a simulator outside liblag.a. */
typedef struct lag_extras {
  const lag_method *const *methods; /* [nmethods] */
  int nmethods;
  const lag_algebra *algebra;       /* or NULL */
  /* u[n * dimensions] := the first n points of the quasi-random sequence "sobol" or "halton" in (0, 1). 0, or the
   * largest number of dimensions; or NULL */
  int (*points)(const char *sequence, int dimensions, long long n, double *u);
  /* Draws the picture in the SVG file at path svg, as PNG, into the open FILE. 0, or -1 with the reason in
   * why[size]; or NULL */
  int (*png)(const char *svg, void *file, char *why, size_t size);
  /* Writes the arrays to an HDF5 file. 0, or -1; or NULL */
  int (*hdf5)(const char *path, const lag_grid *grid);
  const lag_ranks *ranks; /* or NULL */
  void (*after_step)(const lag_program *program); /* called after each step of a run; or NULL */
  const lag_least_squares *fits; /* or NULL */
} lag_extras;

/* The contents of liblag_gsl.a, by the GNU Scientific Library. */
extern const lag_algebra lag_gsl_algebra;
extern const lag_least_squares lag_gsl_least_squares;
extern const lag_extras lag_gsl;
/* liblag_png.a, by librsvg. */
int lag_png_write(const char *svg, void *file, char *why, size_t size);
/* liblag_hdf5.a. */
int lag_hdf5_write(const char *path, const lag_grid *grid);
/* liblag_mpi.a, by MPI. */
extern const lag_ranks lag_mpi;

/* main() of a simulator: see --help, or app/simulator_help.c. extras may be NULL. Returns the exit status: 0 ok, 2
 * usage or I/O, 3 the run failed, 128 and the number of the signal (130: Ctrl-C) when it was interrupted. */
int lag_app_main(int argc, char **argv, const lag_program *program, const lag_extras *extras);

#ifdef __cplusplus
}
#endif

#endif
