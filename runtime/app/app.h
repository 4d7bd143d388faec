/* Shared by the files of app/, the main program of a simulator: the command line, and the state of a run. Functions
 * that return 0 or EXIT_USAGE have printed a message in the second case. */
#pragma once


#include "analysis/error_estimate.h"
#include "analysis/measure.h"
#include "analysis/phase_volume.h"
#include "io/io.h"

enum { EXIT_FINE = 0, EXIT_USAGE = 2, EXIT_RUN = 3, EXIT_SIGNAL = 128 };
enum { MOST_OPTIONS = 16 };

/* The command line as text; numbers are not parsed yet. Lists are in order, with their number; NULL: none. */
typedef struct Args {
#define OWN_FLAG(f) int f;
#define OWN_TEXT(f) const char *f;
#define OWN_LIST(f) const char **f; int n##f;
#define PICTURE_FLAG TO
#define PICTURE_TEXT TO
#define TO(f)
#define LAGC(...)
#define BOTH(name, brief, value, takes, hint, commands, analyses, field, text) field
#define SIMULATOR(name, value, takes, analyses, field, text) field
#include "app/options.def"
  PictureOptions picture;
  const char *self, *scene, *plot_y; /* this program; the first of the scenes and of plot_ys */
  char **sets; /* name=value, in order */
  const char **scenes; /* all scenes named */
  int nsets, nscenes, argc;
  unsigned analysis; /* RUN, or the analysis that is asked for */
  char **argv; /* as main gets them */
} Args;

/* A column that pictures draw: its range so far, the deviation allowed, and the slopes of the swinging door. */
typedef struct DrawnColumn {
  int col, place; /* 1: a coordinate of a place */
  double least, most, width, low, high;
} DrawnColumn;

/* The rows that pictures show, chosen while the run goes on (picture_sampling.c). */
typedef struct PictureSampling {
  int on, places;   /* 1: rows are chosen here; number of samples in the last step */
  double soonest;   /* steps that end within this time after the last sampled one are not sampled [s] */
  /* end of the last sampled step; for STEPS_TO methods the longest step that few samples resolve */
  double seen_to, length;
  double *y, *seen; /* [n] scratch; samples of a step, [MOST_PLACES + 1][ncols] */
  int ends, cut;    /* 1: rows are ends of steps; the last sample is at an event within a step */
  int store;        /* 0: kept rows are counted, not stored */
  size_t kept;
  double part;      /* deviation allowed, as a part of the drawn range */
  double longest;   /* longest time between kept rows */
  int common;       /* 1: drawn places share one scale, of the widest range */
  int ndrawn;
  DrawnColumn *drawn; /* [ncols] */
  double *from, *last; /* [ncols] the row kept last; the last one since, if have_last */
  int have_last;
} PictureSampling;

typedef struct Sensitivity Sensitivity; /* sensitivity_columns.c */

typedef struct App {
  const lag_program *program;
  lag_extras extras;
  Args args;
  const lag_scene *scene;
  const lag_scene *whole; /* the scene with its monitors */
  /* for exponents, costs, errors and their pictures: the scene without monitors and closed forms, which would end a
   * rough run or take time */
  lag_scene bare;
  lag_scene unwatched; /* for --no-monitors */
  lag_sim *sim;
  State state;      /* the saved state of --resume */
  int resumed;      /* 1: the run continues from `state` */
  Table table;
  PictureSampling sampling;
  Rows rows;
  Animation show;
  int *marked;      /* [tracks] the words noted last; NULL: no animation */
  PlottedCurves drawn;
  char drawn_ys[96]; /* label of an axis with the names of several --plot-y */
  /* --portrait, --potential: a state; SI units in those of its first two components and of the energy, as drawn */
  double *portrait, portrait_unit[3];
  double *row;      /* [ncols] */
  double last_row;  /* time of the last row, NaN before the first */
  long long rows_put, empty_rows; /* rows written; rows with an output that is not finite */
  int empty_column;             /* column of the first such output */
  double empty_t, *empty_state; /* its time; the state [q|v|z] there */
  double until;
  double skip;      /* end of the transient that is left out; NaN: none */
  int skipping;     /* 1: within it */
  int section;      /* --section: event at which rows are written; -1: rows at times */
  int section_rc;   /* failure of its last row */
  char why[200];    /* reason of the automatic choice of the method; "" where one was named */
  int status;       /* LAG_... of the run */
  int refused;      /* 1: the method refuses the model */
  int overlaid;     /* 1: a run among others of one picture: its error is not estimated */
  int compared;     /* 1: beside runs by other methods, which the picture compares: monitors are not asked */
  int written;      /* 1: the file of rows is complete */
  double begun, shown; /* start of the run; last update of the progress line [s of lag_clock_seconds] */
  double wall;      /* wall-clock time of the run [s] */
  ErrorEstimate error; /* of the run, */
  int watched;      /* where it is estimated */
  double asked;     /* --accuracy; 0: none */
  double second_most; /* most work of the second run [operations], */
  double second_few;  /* and where it makes few steps */
  int progress;     /* progress line: 1 shown, 0 not yet, -1 never (no terminal, or --quiet) */
  PhaseVolume volume; /* --volume */
  int volume_rc;    /* failure of its last step */
  Sensitivity *sensitivity; /* --sensitivity; NULL: none */
  Measures *measures; /* of the scene and of --measure; NULL: none */
  const char **measure_texts; /* their words; of several variants, with semicolons between them */
  char **measure_names;
  double *measured; /* their values */
  Table log;        /* event log: its columns, */
  Rows log_rows;    /* its file, */
  double *log_row;  /* the row being written, */
  const char **log_names; /* [nev] and the names of events */
  const char *bad_file; /* file that could not be written; NULL: none */
  int bad_errno;        /* and why */
} App;

/* Tasks of a simulator: a run, or an analysis in its place. */
enum { RUN = 1, LYAPUNOV = 2, COST = 4, SWEEP = 8, MODES = 16, EFFECTS = 32, REFERENCE = 64, FIT = 128, ORBIT = 256,
       CONTINUE = 512, LINEARIZE = 1024, DESIGN = 2048, ANY = 4095, MOTION_PERIODIC = ORBIT | CONTINUE,
       MOTION = RUN | LYAPUNOV | SWEEP | EFFECTS | FIT | DESIGN };

/* A row of options.def. */
typedef struct Option {
  const char *name, *brief, *value; /* "--output", "-o" or NULL, the value in help or NULL */
  OptionTakes takes;
  const char *hint;
  unsigned analyses;    /* that take it */
  size_t field, count;  /* in Args: an int, a text, or a list with its number at count */
  const char *text;     /* NULL: not in help */
} Option;

/* Whether the analysis carries tangents along its runs. */
static inline int lag_args_tangents(const Args *a) { return a->lyapunov || a->orbit || a->continues; }

/* Row i; NULL past the end. */
const Option *lag_args_option(int i);
/* The analysis that an option begins; 0: none. */
unsigned lag_args_analysis_named(const char *option);

/* args.c: parses and checks the command line. 0, or EXIT_USAGE after a message. */
int lag_args_parse(Args *a, int argc, char **argv);
/* *x := the decimal number that is the whole text, maybe infinite; else 0. Other forms that strtod takes (inf, nan,
 * 0x1p3) are none. */
int lag_args_decimal(const char *text, double *x);
/* The same for finite numbers. Else a message with the name `what` and an example; returns 0. */
int lag_args_number(const Args *a, const char *what, const char *text, const char *example, double *x);
/* x := the whole number of an option, from 1 on. 0, or EXIT_USAGE after a message. */
int lag_args_count(const Args *a, const char *option, const char *text, const char *example, long long *x);
/* x := the positive number of an option, whose meaning the message states; unchanged where text is NULL. 0, or
 * EXIT_USAGE after a message. */
int lag_args_positive(const Args *a, const char *option, const char *text, const char *example, const char *meaning,
                      double *x);
/* every := the time between rows that --every gives, if it does. 0, or EXIT_USAGE after a message. */
int lag_args_every(const Args *a, double *every);
/* Prints an error to standard error after the program's name; returns EXIT_USAGE. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
int lag_app_error(const Args *a, const char *format, ...);
/* The same where an analysis has no result: EXIT_RUN. */
#define lag_app_no_result(...) (lag_app_error(__VA_ARGS__), EXIT_RUN)
/* Refuse a span without length, and a program without GSL, which "finds eigenvalues"; return EXIT_USAGE. */
int lag_app_no_span(const App *app);
int lag_app_no_gsl(const App *app, const char *does);
/* Another run of the same program and command line, not set up. */
App lag_app_like(const App *app);

/* simulation_setup.c: app->scene and app->sim with values and method; lag_app_set_up_start: without the method. 0,
 * or EXIT_USAGE after a message. */
int lag_app_set_up(App *app);
int lag_app_set_up_start(App *app);
/* app->until := end of the run, from --until or the scene; called by both above. 0, or EXIT_USAGE after a message. */
int lag_app_read_until(App *app);
/* Whether word[n] is one of the words in a list with spaces or commas; NULL: an empty list. */
int lag_app_has_word(const char *words, const char *word, size_t n);
/* Sets one name=value in app->sim. */
int lag_app_set_value(App *app, const char *text);
/* Another simulation of app->scene with the values of the command line. NULL: no memory, or a message. */
lag_sim *lag_app_fresh_sim(App *app);
/* The same of the scene without monitors and closed forms, which would end a rough run early or cost time. */
lag_sim *lag_app_fresh_bare_sim(App *app);
/* opt[noptions] := options of the method with these values; one called step: times `times`. */
void lag_app_options(const lag_method *m, const double *values, double times, lag_option *opt);
/* Sets tolerance and method of a new app->sim. 0, or EXIT_USAGE after a message. */
int lag_app_choose_method(App *app);
/* Method i of this program; NULL past the last. */
const lag_method *lag_app_method_at(const App *app, int i);
const lag_method *lag_app_find_method(const App *app, const char *name);
/* Prints that there is no such method; returns EXIT_USAGE. */
int lag_app_unknown_method(const App *app, const char *name);

/* Chooses a method with these options for app->sim, whose values are set; app->why := the reason. 0, or EXIT_USAGE
 * after a message. */
int lag_app_choose_automatically(App *app, const lag_option *opt, int n);

/* simulator_help.c: --help; the table of all methods, or of the one of this name. */
void lag_app_help(const App *app, FILE *f);
void lag_app_list_methods(const App *app, const char *name, FILE *f);

/* pictures.c: writes a picture to path, SVG or, where it ends in .png, PNG: `write` puts all but the last tag into p->f
 * (-1 with errno set). lag_app_draw_table: the table to --svg, if given. 0, or EXIT_USAGE after a message.
 * lag_app_check_parts: refuses files that only a program built with librsvg or libhdf5 writes. */
int lag_app_check_parts(const App *app);
int lag_app_picture(const App *app, const char *path, const char *title, int (*write)(const Picture *p, void *context),
                    void *context);
int lag_app_draw_table(App *app, const char *title);

/* column_lookup.c: app->drawn := columns of --plot-x and --plot-y, or all. 0, or EXIT_USAGE after a message. */
int lag_app_choose_curves(App *app);
/* app->show := the points of --points and --from, or the shapes of the scene. 0, or EXIT_USAGE after a message. */
int lag_app_choose_shapes(App *app);

/* picture_sampling.c: rows of pictures. lag_sampling_open comes after lag_app_choose_curves and
 * lag_app_choose_shapes. lag_sampling_advance is lag_sim_advance that samples the motion on the way.
 * lag_sampling_close thins the rows at the end. lag_sampling_warn: note := a warning about the picture, or ""; also
 * printed. */
int lag_sampling_open(App *app);
int lag_sampling_advance(App *app, double until);
int lag_sampling_close(App *app);
void lag_sampling_warn(App *app, char *note, size_t size);
void lag_sampling_free(App *app);

/* output_rows.c: time of row grid[2] of a grid that begins at grid[0], with rows grid[1] apart; the index of time t,
 * whole up to rounding of the times. */
double lag_app_row_time(const App *app, const double *grid);
double lag_app_row_at(const App *app, const double *grid, double t);
/* error_curves.c: whether the rows of a picture lie at equal times, as differences need them; the present row's
 * energy, less its jumps at events and the work of forces so far; the energies that are drawn := decimal logarithms
 * of their errors, relative where no run begins with the energy 0. sim: of the first run. */
int lag_app_equal_times(const Args *a);
void lag_energy_kept(App *app);
void lag_energy_errors(App *app, lag_sim *sim);
/* portrait.c: what --portrait or --potential draws beneath app->drawn. 0, or EXIT_USAGE after a message. */
int lag_portrait_open(App *app);
/* output_rows.c: writes a row of the present state; writes app->row, also to the table if drawn. LAG_OK, or a
 * failure. */
int lag_app_put_row(App *app);
int lag_app_write_row(App *app, int drawn);
/* All rows of a table to a file; 0, or EXIT_USAGE after a message. */
int lag_app_write_table(const App *app, const char *path, const Table *t);
/* Signals that end a run (Ctrl-C, SIGTERM, SIGHUP) let it finish its step and write its files; nohup is respected.
 * Called before files are opened, so that none is left over. */
void lag_app_catch_interrupt(void);
/* Clock and progress line: lag_app_start_clock before a run, lag_app_stop_clock at its end, lag_app_after_step as
 * the function of lag_sim_on_step. lag_app_interrupted: the exit status after a signal. */
void lag_app_start_clock(App *app);
int lag_app_after_step(void *app, const lag_sim *sim);
void lag_app_stop_clock(App *app);
int lag_app_interrupted(void);
/* Refuses outputs that would overwrite the model, this program, a file that is read or each other. 0, or EXIT_USAGE
 * after a message. */
int lag_app_check_outputs(const App *app);

/* One run: set up, opened files, up to its end, app->status; no report. 0, or EXIT_USAGE after a message.
 * lag_app_free: all that it holds but the command line. */
int lag_app_run(App *app);
void lag_app_free(App *app);

/* multi_run_plot.c: whether the command line names several scenes or methods, or --vs, for one picture; draws it and
 * returns the exit status. */
int lag_app_overlays(const Args *a);
/* Length of the first method in a list with commas; those between the parentheses of options separate none.
 * lag_app_next_method: the one behind it; NULL: none. */
size_t lag_app_method_length(const char *list);
const char *lag_app_next_method(const char *list);
int lag_app_overlay(App *app);

/* area_plot.c: --cloud. Returns the exit status. */
int lag_app_cloud(App *app);

/* column_lookup.c: the period of an angle that is declared periodic, in the unit of its column, over which pictures of
 * more than a turn, and points of a section, are drawn; 0: none. */
double lag_app_period(const App *app, const char *name);

/* simulation_run.c: app->skip := the end of the transient, --skip; NaN: none is left out. The same. */
int lag_app_choose_skip(App *app);

/* event_log.c: --section. 0, or EXIT_USAGE after a message. */
int lag_section_choose(App *app);

/* tangent_columns.c: --tangent. lag_tangent_columns_open adds its columns to the table; 0, or EXIT_USAGE after a
 * message. lag_tangent_columns_row: their values in app->row; LAG_OK, or a failure. */
int lag_tangent_columns_open(App *app);
int lag_tangent_columns_row(App *app);
void lag_report_tangent(App *app, FILE *f);
void lag_report_tangent_json(App *app, Json *j);

/* s[n] := unit as numerator or denominator of a fraction, in parentheses if compound. */
void lag_unit_in_fraction(char *s, size_t n, const char *unit);
/* n more columns of the table and of app->row; NULL: no memory. */
Column *lag_app_add_columns(App *app, int n);

/* sensitivity_columns.c: --sensitivity. As the functions for --tangent. */
int lag_sensitivity_open(App *app);
int lag_sensitivity_row(App *app);
void lag_report_sensitivity(App *app, FILE *f);
void lag_report_sensitivity_json(App *app, Json *j);
void lag_sensitivity_free(App *app);
/* sensitivity_measures.c: d[measures] := derivatives of the measures by name j of --sensitivity, in declared units; by
 * four more runs. LAG_OK, or a failure. */
int lag_measures_by(App *app, int j, double *d);
/* gradient_report.c: d[n + np] := derivatives of measure k by the starts and parameters, in declared units; 0, or -1
 * with the reason. name: name and unit of start or parameter i, each of LAG_GRADIENT_NAME characters. */
enum { LAG_GRADIENT_NAME = 200 };
int lag_measure_gradient(App *app, int k, double *d, char *why, size_t size);
void lag_gradient_name(const App *app, int i, char *name, char *unit);

/* volume_report.c: --volume. open: gives the run its tangent; 0, or EXIT_USAGE after a message. step: at the end of
 * each step; a failure ends the run. */
int lag_app_volume_open(App *app);
void lag_app_volume_step(App *app);
void lag_report_volume(App *app, FILE *f);
void lag_report_volume_json(App *app, Json *j);

/* Emitted programs call this, by a declaration of their own: table[groups * size] := groups of the pattern's entries,
 * with the numbers first, first + 1, ... in place of \1 in their names. Without memory the program ends. */
void lag_app_names(lag_var *table, int first, int groups, const lag_var *pattern, int size);

/* measures.c: --measure, and the measures of the scene. open: before the run, and before files are opened; 0, or
 * EXIT_USAGE after a message. begin and end: of the run; a status. advance: lag_sim_advance, with measures if there
 * are any. */
int lag_app_measures_open(App *app);
int lag_app_measures_begin(App *app);
int lag_app_advance(App *app, double t);
int lag_app_measures_end(App *app);
void lag_app_measures_free(App *app);
void lag_report_measures(const App *app, FILE *f);
void lag_report_measures_json(const App *app, Json *j);
/* gradient_report.c: --gradient. open: refuses what has none. */
int lag_app_gradient_open(App *app);
void lag_report_gradient(App *app, FILE *f);
void lag_report_gradient_json(App *app, Json *j);

/* error_report.c: the error of the run, by a second run. begin: before the run; 0, or EXIT_USAGE after a message.
 * end: after it. */
int lag_app_error_begin(App *app);
void lag_app_error_end(App *app);
/* An option of the method of `sim`, where it has it; others stay. LAG_OK, or a refusal. */
int lag_app_set_option(lag_sim *sim, const char *name, double value);
/* `to` takes the method and options of `from`, and its tolerance times `times`. LAG_OK, or a refusal. */
int lag_app_copy_method(const lag_sim *from, lag_sim *to, double times);
/* Compares the motion noted in *e, of `run`, with a more accurate run of at most `most` operations. LAG_OK, also
 * where that fails (e->why), or LAG_ENOMEM. */
double lag_app_work(const lag_sim *run); /* operations of a run so far, about */
int lag_app_compare_errors(App *app, ErrorEstimate *e, lag_sim *run, double most);
/* Steps of a run that --accuracy tries, at most. */
#define LAG_ACCURACY_STEPS 2e7
/* accuracy.c: --accuracy: sets method and tolerance or step of app->sim. 0, or EXIT_USAGE after a message. */
int lag_app_choose_by_accuracy(App *app);
/* "bounded", "t", "t^2", "exponential"; "": not known. */
const char *lag_growth_name(ErrorGrowth growth);
void lag_report_error(const App *app, FILE *f);
void lag_report_error_json(const App *app, Json *j);

/* lyapunov_report.c: --lyapunov. Returns the exit status. */
int lag_app_lyapunov(App *app);

/* modes_report.c: --modes. Returns the exit status. rest: y[n] := the rest, or with --steady the steady motion, next to
 * the start; 0, or the exit status after a message. */
int lag_app_modes(App *app);
int lag_app_rest(App *app, double *y);

/* linear_report.c: --linearize. Returns the exit status. */
int lag_app_linearize(App *app);

/* orbit_report.c: --orbit. Returns the exit status. */
int lag_app_orbit(App *app);
/* For both: app->sim with the tolerance of searches; the orbit near its start, with the period and conditions of the
 * command line; its solution, with multipliers. 0, or the exit status after a message. */
struct PeriodicOrbit;
int lag_app_orbit_set_up(App *app);
int lag_app_orbit_holds(App *app, struct PeriodicOrbit *o); /* its conditions, those of --hold */
int lag_app_orbit_open(App *app, struct PeriodicOrbit *o);
int lag_app_orbit_solve(App *app, struct PeriodicOrbit *o);
/* The rest of a scene to paste: values of the command line that are no starts, the start y[n], the span. */
void lag_app_put_start(FILE *f, const App *app, const double *y, double span);
/* orbit_manifolds.c: --manifold, of the orbit, or with --equilibrium of the rest next to the start. 0, or the exit
 * status. */
int lag_app_manifolds(App *app, struct PeriodicOrbit *o);
int lag_app_rest_manifolds(App *app);
/* orbit_connections.c: --to, of the orbit. 0, or the exit status. */
int lag_app_connections(App *app, struct PeriodicOrbit *o);
/* orbit_maps.c: the map takes the terms NAME=NAME of an option, `x=-x, r[i]=r[i+1]`; others are left out. 0, or the
 * exit status after a message. */
struct StateMap;
int lag_app_map_terms(App *app, const char *option, const char *terms, struct StateMap *map);
/* Index of the charge, or the component of the state, of this name[n]; -1: none. */
int lag_charge_named(const App *app, const char *name, size_t n);
int lag_state_named(const App *app, const char *name, size_t n);

/* continue_report.c: --continue. Returns the exit status. */
int lag_app_continue(App *app);

/* effect_costs.c: --effects. Returns the exit status. */
int lag_app_effects(App *app);

/* design_report.c: --design. Returns the exit status. */
int lag_app_design(App *app);
/* fit.c: --fit. Returns the exit status. */
int lag_app_fit(App *app);

/* sweep.c: --sweep. Returns the exit status. */
int lag_app_sweep(App *app);

/* cost.c: --cost and --reference. Returns the exit status. */
int lag_app_cost(App *app);

/* Prints that a file cannot be written, with errno; returns EXIT_USAGE. */
int lag_app_io_error(const App *app, const char *path);
/* A state [q|v|z] where a value is not finite, and its time: where the run ended; or of the energy or a charge at the
 * end, or at the start; or of the first row with such an output; NULL: none. */
const double *lag_app_nonfinite_state(const App *app, double *t);
/* Notes a file that cannot be written, and errno; returns LAG_EIO, the run's status. */
int lag_app_bad_file(App *app, const char *path);
/* Writes what is left for standard output; EXIT_USAGE, after a message, where it cannot be written. */
int lag_app_flush(const App *app);
/* Tests before a long run whether a file can be written; path NULL: none. 0, or EXIT_USAGE after a message. */
int lag_app_try_file(const App *app, const char *path);

/* motion_marks.c: what an animation marks. lag_marks_note: the state now; LAG_ENOMEM. lag_marks_event: event k at
 * time t; -1: no memory. */
int lag_marks_open(App *app);
int lag_marks_note(App *app);
int lag_marks_event(App *app, int k, double t);
void lag_marks_free(App *app);

/* event_log.c: the log of --events. 0, or EXIT_USAGE after a message. lag_event_note: as the function of
 * lag_sim_on_event, for both. */
int lag_event_log_open(App *app);
void lag_event_note(void *app, int k, double t, const double *before, const double *after);
void lag_event_log_free(App *app);
void lag_report_events(const App *app, FILE *f);
void lag_report_events_json(const App *app, Json *j);

/* report.c */
void lag_report_text(App *app, FILE *f);
/* friction_report.c: lines of both on switching surfaces and guides. */
void lag_report_switches(const App *app, FILE *f);
void lag_report_guides(const App *app, FILE *f);
void lag_report_switches_json(const App *app, Json *j);
void lag_report_guides_json(const App *app, Json *j);
/* How a run that a monitor has ended goes on, behind its message; "" for others. */
const char *lag_app_way_on(const App *app);
void lag_report_json(App *app, FILE *f);
/* The word behind a charge's name: "energy drift", "spin balance". */
const char *lag_charge_word(const lag_charge_stats *charge);
extern const char lag_energy_scale[]; /* what drifts and balances of the energy are relative to */
/* A JSON object that begins with model and scene; of a run also with method, chosen and status. */
Json lag_app_json(const App *app, FILE *f);
Json lag_report_json_open(const App *app, FILE *f);
/* s[n] := method with the options that differ from their defaults, "rk45(tol=1e-09)". */
void lag_report_method(const App *app, char *s, size_t n);
/* The first line of reports: model, scene and method. */
void lag_report_head(const App *app, FILE *f);
