/* What the files of app/ share: the command line, and a run under way. */
#ifndef LAG_APP_APP_H
#define LAG_APP_APP_H

#include <signal.h>
#include <time.h>

#include "io/io.h"

enum { EXIT_FINE = 0, EXIT_USAGE = 2, EXIT_RUN = 3, EXIT_SIGNAL = 128 };
enum { MOST_OPTIONS = 16 };
enum { OWN_OPTIONS = 3 }; /* options of methods that are options of the command line, too */
extern const char *const args_own_options[OWN_OPTIONS];

/* The command line as written; numbers are still text. */
typedef struct Args {
  const char *method_options[OWN_OPTIONS]; /* values of --quadrature, --order, --stages */
  const char *self, *scene, *method, *tol, *step, *until, *every, *out, *svg, *plot_x, *plot_y, *html, *points, *from, *save, *resume, *events, *section;
  const char *transient, *exponents; /* of --lyapunov */
  const char *target, *longest, *methods, *against; /* of --cost */
  const char *effects; /* --effects: which measurements of a program that lagc effects made */
  int json, sketch, quiet, verbose, help, trace, no_rods, modes, tangent, lyapunov, cost, reference;
  char **sets; /* name=value, in order */
  int nsets;
} Args;

/* What pictures show of the run: see film.c. */
typedef struct Film {
  int on, places;   /* places of the last step that were looked at */
  Thin rows;
  double soonest;   /* steps that end sooner after the last are not looked at */
  double seen_to, length; /* length: how long a step may be of which a few places show what happens */
  double *y, *seen; /* [n]; rows [MOST_PLACES + 1][ncols] */
} Film;

typedef struct App {
  const lag_program *program;
  lag_extras extras;
  Args args;
  const lag_scene *scene;
  lag_sim *sim;
  State state;      /* that was resumed */
  int resumed;
  Table table;
  Film film;
  Rows rows;
  Animation show;
  Drawn drawn;
  double *row;      /* [ncols] */
  double last_row;  /* time of the last row, NaN before the first */
  long long rows_put, empty_rows;   /* that were put out, and those of them with an output that is not finite: */
  int empty_column;             /* the first of such, */
  double empty_t;               /* and when that was */
  double until;
  int section;      /* the event that rows are put out at; -1: they are put out in time */
  int section_rc;   /* why its last row could not be made */
  char why[200];    /* this method, where nobody named one; "" where somebody did */
  int status;       /* LAG_... of the run */
  int written;      /* rows were completed */
  struct timespec begun, shown;
  double wall;
  int progress;     /* a progress line stands on the terminal */
  Table log;        /* of events: its columns, */
  Rows log_rows;    /* its file, */
  double *log_row;
  const char **log_names; /* [nev] and the words in it */
  const char *bad_file; /* that could not be written */
} App;

/* args.c. 0, or EXIT_USAGE after a message. */
int args_parse(Args *a, int argc, char **argv);
/* A number, the whole text; after a message 0. what names it, example is what could stand there. */
int args_number(const Args *a, const char *what, const char *text, const char *example, double *x);
/* An error on standard error, with the program's name; returns EXIT_USAGE. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
int app_error(const Args *a, const char *format, ...);

/* choose.c: scene, method and values; without a method. 0, or EXIT_USAGE after a message. */
int app_choose(App *app);
int app_choose_start(App *app);
/* app->until := where the command line, or else the scene, lets it end; done by the two above. 0, or EXIT_USAGE after a message. */
int app_read_until(App *app);
/* The name=value of the command line, into app->sim. */
int app_set_value(App *app, const char *text); /* one of them, name=value */
int app_set_values(App *app);
/* Tolerance and method, for a simulation that has none of its own yet. 0, or EXIT_USAGE after a message. */
int app_choose_method(App *app);
/* Method i of this program; NULL past the last. */
const lag_method *app_method_at(const App *app, int i);
const lag_method *app_find_method(const App *app, const char *name);
/* The message that there is no such method; returns EXIT_USAGE. */
int app_unknown_method(const App *app, const char *name);

/* automatic.c: a method for app->sim, whose values are set, with these options; fills app->why. 0, or EXIT_USAGE after a message. */
int app_choose_automatically(App *app, const lag_option *opt, int n);

/* methods.c */
void app_list_methods(const App *app, FILE *f);
/* Of one method; 0 when there is none of this name. */
int app_explain_method(const App *app, const char *name, FILE *f);

/* columns.c. What pictures draw: --plot-x and --plot-y, or everything. 0, or EXIT_USAGE after a message. */
int app_choose_drawn(App *app);
/* Fills app->show from --points and --from. 0, or EXIT_USAGE after a message. */
int app_choose_points(App *app);

/* film.c: rows of pictures. film_open: after app_choose_drawn and app_choose_points. film_advance: lag_sim_advance, looking at
 * the motion on the way. film_warn: what should be said of the picture, "" when nothing; also said on standard error. */
int film_open(App *app);
int film_advance(App *app, double until);
int film_close(App *app);
void film_warn(App *app, char *note, size_t size);
void film_free(App *app);

/* app.c: a row of the present state. LAG_OK, or why there is none. */
int app_put_row(App *app);
/* What a long run does: watch before it begins and unwatch at its end, for Ctrl-C and the progress line; after_step is for
 * lag_sim_on_step. interrupted: the exit status that follows from the signal. */
/* What asks a run to end lets it finish its step and write what it has. nohup is respected. Before files are opened, which would be left. */
void app_catch_interrupt(void);
void app_watch(App *app);
int app_after_step(void *app, const lag_sim *sim);
void app_unwatch(App *app);
int app_interrupted(void);
/* Whether files that are written would overwrite what is needed. 0, or EXIT_USAGE after a message. */
int app_check_outputs(const App *app);

/* section.c: --section. 0, or EXIT_USAGE after a message; note: event k happens. */
int section_choose(App *app);
void section_note(App *app, int k);

/* tangent.c: --tangent. open: columns behind those of the table; 0, or EXIT_USAGE after a
 * message. row: their values; LAG_OK, or why there are none. */
int tangent_open(App *app);
int tangent_row(App *app);
void report_tangent(App *app, FILE *f);
void report_tangent_json(App *app, FILE *f);

/* charges.c: what the report says of the energy and of other charges; in JSON also of monitors. */
void report_charges(const App *app, FILE *f);
void report_charges_json(const App *app, FILE *f);
/* Whether the energy was kept much worse than asked for, where the mass matrix is almost singular. */
int report_lost_digits(const App *app, const lag_charge_stats *energy);

/* lyapunov.c: --lyapunov. Returns the exit status. */
int app_lyapunov(App *app);

/* modes.c: --modes. Returns the exit status. */
int app_modes(App *app);

/* effects.c: --effects. Returns the exit status. */
int app_effects(App *app);

/* cost.c: --cost and --reference. Returns the exit status. */
int app_cost(App *app);

/* help.c */
void app_help(const App *app, FILE *f);

/* The message that a file cannot be written, with errno; returns EXIT_USAGE. */
int app_io_error(const App *app, const char *path);

/* events.c. 0, or EXIT_USAGE after a message. note: what lag_sim_on_event calls. */
int events_open(App *app);
void events_note(void *app, int k, double t, const double *before, const double *after);
void events_free(App *app);
void report_events(const App *app, FILE *f);
void report_events_json(const App *app, FILE *f);

/* report.c */
void report_text(App *app, FILE *f);
void report_json(App *app, FILE *f);
/* method(step = 0.1, ...) */
void report_method(const App *app, char *s, size_t n);

#endif
