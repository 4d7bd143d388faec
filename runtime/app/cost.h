/* What the files of --cost share: what was measured. */
#ifndef LAG_APP_COST_H
#define LAG_APP_COST_H

#include "analysis/cost.h"
#include "app/app.h"

typedef struct Cost {
  Samples reference;
  char reference_name[96]; /* taylor in quadruple precision */
  CostMethod *method;      /* [nmethods] */
  int nmethods;
  double target;           /* 0: none */
} Cost;

/* rk45(tol=1e-06), variational(order=4, step=0.01): what --method takes, but for the tolerance. */
void cost_setting(const CostMethod *m, const CostRun *run, char *text, size_t n);
/* The same as options of a run: --method rk45 --tol 1e-06. */
void cost_options(const CostMethod *m, const CostRun *run, char *text, size_t n);

void cost_text(FILE *f, const App *app, const Cost *c);
void cost_json(FILE *f, const App *app, const Cost *c);
/* Errors against times. -1 with errno set. */
int cost_picture(const char *path, const App *app, const Cost *c);

#endif
