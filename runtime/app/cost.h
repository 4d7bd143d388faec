/* Shared by cost.c, cost_report.c and cost_picture.c: what `lagc cost` measured. */
#pragma once

#include "analysis/work_precision.h"
#include "app/app.h"

typedef struct Cost {
  Samples reference;
  char reference_name[96];   /* "taylor, 34 digits" */
  double *scale;             /* [reference.n] divisors of errors */
  double reached;            /* t at which a reference that was asked for longer ends [s]; NaN: it is whole */
  CostMethod *method;        /* [nmethods] */
  int nmethods;
  double seconds;            /* time to spend, by the clock */
  double target;             /* error of --target; 0: none */
  int stopped;               /* 1: Ctrl-C ended the sweep */
} Cost;

/* The knob of a method: "tol" or "step". */
const char *lag_cost_knob(const lag_method *m);

/* Families of methods that work alike, at most LAG_COST_FAMILIES. The family's best method: the fastest of it for most of the errors 1e-2, 1e-4, ..;
 * NULL where it has no run. */
enum { LAG_COST_FAMILIES = 8 };
const CostMethod *lag_cost_best_of_family(const Cost *c, int family);

/* cost_report.c: `lagc run` with the model, scene, values and end of this call, for a command to copy. */
void lag_cost_put_command(FILE *f, const App *app, const Cost *c);
/* As text, as one JSON object, as rows of CSV. lag_cost_put_csv: -1 with errno. */
void lag_cost_put_text(FILE *f, const App *app, const Cost *c);
void lag_cost_put_json(FILE *f, const App *app, const Cost *c);
int lag_cost_put_rows(const char *path, const App *app, const Cost *c);

/* realtime.c: --realtime: methods of equal steps with the step that was asked. Returns the exit status. */
int lag_app_realtime(App *app, const Cost *c);

/* cost_picture.c: time against error, as SVG (-1 with errno), or in a terminal. */
int lag_cost_put_picture(const char *path, const App *app, const Cost *c);
void lag_cost_sketch(FILE *f, const Cost *c);
