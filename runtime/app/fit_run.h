/* Shared by the files of `lagc fit`. */
#pragma once

#include "analysis/fit.h"
#include "app/app.h"
#include "io/data_file.h"

typedef struct FitRun {
  App *app;
  Fit fit;
  int nfiles;       /* at most MOST_FILES, with */
  DataFile *data;   /* their contents, */
  char **file;      /* names, and */
  int *first;       /* [nfiles + 1] first rows, in all */
  char *names;      /* of targets, as text */
  double *t;        /* [rows] times [s] */
  double time_unit; /* of the file, in seconds */
  int status;       /* LAG_... of the fit */
  int compares;     /* 1: one of several scenes: names of effects that it lacks are left out */
} FitRun;

/* fit_run.c: the fit; 0, or an exit status after a message. */
int lag_fit_run(FitRun *r);
void lag_fit_run_free(FitRun *r);
/* For designs, too: targets of --fit and --prior; the error of a column by --sigma; whether --columns names it. */
int lag_fit_take_targets(FitRun *r);
int lag_fit_take_sigma(FitRun *r, FitColumn *c);
int lag_fit_is_asked(const Args *a, const char *label);
/* ... 0, or an exit status after a message: --sigma and --columns name columns. */
int lag_fit_check_names(const Args *a, const Fit *f);
/* fit_compare.c: fits several scenes. Returns the exit status. */
int lag_fit_compare(App *app);

/* network_weights.c: names of --fit, each network by its weights, malloc'ed; the part "w1[2,1]" of a weight of one of
 * the networks among the names, or NULL; the file of weights: 0, or -1 with errno set. */
char *lag_network_targets(const lag_model *m, const char *names);
const char *lag_network_key(const char *names, const char *parameter);
int lag_network_write(const FitRun *r, const char *path);

/* fit_report.c; fit_picture.c: --svg, 0 or an exit status after a message. */
void lag_fit_report(const FitRun *r, FILE *f);
void lag_fit_report_json(const FitRun *r, FILE *f);
int lag_fit_picture(FitRun *r);
