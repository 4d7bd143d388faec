/* Shared by the files of --cost: the measurements. */
#ifndef LAG_APP_COST_H
#define LAG_APP_COST_H

#include "analysis/work_precision.h"
#include "app/app.h"

typedef struct Cost {
  Samples reference;
  char reference_name[96]; /* "taylor, 34 digits" */
  CostMethod *method;      /* [nmethods] */
  int nmethods;
  double target;           /* error of --target; 0: none */
} Cost;

/* text[n] := the setting of a run, "rk45(tol=1e-06)", "variational(order=4, step=0.01)". */
void lag_cost_setting(const CostMethod *m, const CostRun *run, char *text, size_t n);
/* text[n] := the same as options of a run, "--method rk45 --tol 1e-06". */
void lag_cost_options(const CostMethod *m, const CostRun *run, char *text, size_t n);

void lag_cost_text(FILE *f, const App *app, const Cost *c);
void lag_cost_json(FILE *f, const App *app, const Cost *c);
/* Writes the SVG picture, time against error. -1 with errno set. */
int lag_cost_picture(const char *path, const App *app, const Cost *c);

#endif
