/* Shared by cost.c, cost_report.c and cost_picture.c: what `lagc cost` measured. */
#pragma once

#include "analysis/work_precision.h"
#include "app/app.h"

/* Reach and cost of one precision of numbers along the motion. */
typedef struct CostPrecision {
  char name[16];       /* "double", "long", "quad" */
  double epsilon;
  double seconds, to;  /* processor time of its most accurate run, to t = to */
  double horizon;      /* t at which rounding leaves no digit of the motion; HUGE_VAL: never, NaN: not known */
} CostPrecision;

enum { LAG_COST_PRECISIONS = 3 };

typedef struct Cost {
  Samples reference;
  char reference_name[96];   /* "taylor, 34 digits" */
  double *scale;             /* [reference.n] divisors of errors */
  double event;              /* t at which an event ends the run, about; app->until: none does */
  double reached;            /* t at which a reference that was asked for longer ends [s]; NaN: it is whole */
  CostPrecision precision[LAG_COST_PRECISIONS]; /* [nprecisions] */
  int nprecisions;
  double seen;               /* t to which the growth of errors was seen */
  CostMethod *method;        /* [nmethods] */
  int nmethods;
  int named;                 /* 1: --methods names them, few enough to show each: each is then a family of its own */
  double seconds, begun;     /* time to spend, by the clock, and its begin */
  double target;             /* error of --target; 0: none */
  char monitor[200];         /* a monitor's message, where it stops settings that would be answers; "" */
  int stopped;               /* 1: Ctrl-C ended the sweep */
} Cost;

/* cost.c. Time at which an event ends the run, to six digits; app->until where none does, or it cannot be found
 * soon. */
double lag_cost_event_end(App *app);
/* Room for a reference of n components at `rows` times, equally spaced from t0 to t0 + span; LAG_OK or LAG_ENOMEM.
 * Free with lag_cost_end, also after an error. */
enum { LAG_COST_ROWS = 17 }; /* the start among them, for the scales */
int lag_cost_begin(Cost *c, int rows, int n, double t0, double span);
void lag_cost_end(Cost *c);
/* Reference by taylor, or by dop853 where the model has no Taylor series, at two tolerances; their difference is its
 * uncertainty. It ends where that is too large or, after `seconds` of processor time, with the rows that it has:
 * then *limited = 1. 0, or an exit status after a message. */
int lag_cost_reference(App *app, Cost *c, double seconds, int *limited);
/* A simulation by the reference's method and tolerance; NULL after a message. */
lag_sim *lag_cost_most_accurate(App *app);
/* Lists the methods of --methods, or all, for a sweep. 0, or EXIT_USAGE after a message. */
int lag_cost_list_methods(App *app, Cost *c);

/* The knob of a method: "tol" or "step". */
const char *lag_cost_knob(const lag_method *m);

/* Families of methods that work alike, at most LAG_COST_FAMILIES. The family's best method: the fastest of it for
 * most of the errors 1e-2, 1e-4, ..; NULL where it has no run. */
enum { LAG_COST_FAMILIES = 8 };
const CostMethod *lag_cost_best_of_family(const Cost *c, int family);

/* cost_report.c: `lagc run` with the model, scene, values and end of this call, for a command to copy. */
void lag_cost_put_command(FILE *f, const App *app, const Cost *c);
/* precisions.c: adds this program's precision, and the horizons of all, for `seconds` at most. LAG_OK or LAG_ENOMEM. */
int lag_cost_precisions(App *app, Cost *c, double seconds);
void lag_cost_put_precisions(FILE *f, const Cost *c);
void lag_cost_put_precisions_json(Json *j, const Cost *c);

/* As text, as one JSON object, as rows of CSV. lag_cost_put_csv: -1 with errno. */
void lag_cost_put_text(FILE *f, const App *app, const Cost *c);
void lag_cost_put_json(FILE *f, const App *app, const Cost *c);
int lag_cost_put_rows(const char *path, const App *app, const Cost *c);

/* realtime.c: --realtime: methods of equal steps with the step that was asked. Returns the exit status. */
int lag_app_realtime(App *app, const Cost *c);

/* cost_picture.c: time against error, for lag_app_picture (cost: a Cost), or in a terminal. */
int lag_cost_put_picture(const Picture *picture, void *cost);
void lag_cost_sketch(FILE *f, const Cost *c);
