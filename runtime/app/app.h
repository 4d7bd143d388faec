/* What the files of app/ share: the command line, and a run under way. */
#ifndef LAG_APP_APP_H
#define LAG_APP_APP_H

#include <signal.h>
#include <time.h>

#include "io/io.h"

enum { EXIT_FINE = 0, EXIT_USAGE = 2, EXIT_RUN = 3, EXIT_INTERRUPTED = 130 };
enum { MOST_OPTIONS = 16, LOGGED_EVENTS = 20 };

/* The command line as written; numbers are still text. */
typedef struct Args {
  const char *self, *scene, *method, *tol, *step, *until, *every, *out, *svg, *plot_x, *plot_y, *html, *points, *from, *save, *resume;
  int json, sketch, quiet, help, trace, no_rods, modes;
  char **sets; /* name=value, in order */
  int nsets;
} Args;

typedef struct App {
  const lag_program *program;
  lag_extras extras;
  Args args;
  const lag_scene *scene;
  lag_sim *sim;
  State state;      /* that was resumed */
  int resumed;
  Table table;
  Rows rows;
  Animation show;
  double *row;      /* [ncols] */
  double last_row;  /* time of the last row, NaN before the first */
  double until;
  int status;       /* LAG_... of the run */
  int written;      /* rows were completed */
  struct timespec begun, shown;
  double wall;
  int progress;     /* a progress line stands on the terminal */
  struct { int k; double t; } log[LOGGED_EVENTS];
  int nlog;
  long long nevents; /* in this part of the run */
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
const lag_method *app_find_method(const App *app, const char *name);

/* methods.c */
void app_list_methods(const App *app, FILE *f);

/* columns.c. The index of a column by its name; -1 after a message. */
int app_column(const App *app, const char *name);
/* Fills app->show from --points and --from. 0, or EXIT_USAGE after a message. */
int app_choose_points(App *app);

/* modes.c: --modes. Returns the exit status. */
int app_modes(App *app);

/* help.c */
void app_help(const App *app, FILE *f);

/* report.c */
void report_text(App *app, FILE *f);
void report_json(App *app, FILE *f);
/* method(step = 0.1, ...) */
void report_method(const App *app, char *s, size_t n);

#endif
