/* Branches of --continue: followed by continue_branches.c, reported by continue_report.c; with --resume they go on from
 * rows that continue_resume.c reads. */
#pragma once

#include "analysis/branch_problems.h"
#include "analysis/steady_branch.h"
#include "app/app.h"

enum { MOST_BRANCHES = 24, MOST_DOUBLINGS = 4, POINTS = 400, LOOKS = 128 };
enum { OF_PERIOD = 4, OF_STATE = 6 }; /* columns of rows; after the states end and what wrote the file */

/* A branch and the equations that it solves. */
typedef struct Part {
  Branch branch;
  const BranchProblem *problem;
  PeriodicOrbit *orbit; /* NULL: states of rest, or steady motions */
  char why[600];        /* why it was lost; "": not known */
  int number, from;     /* of the branch that it is a half of; of the one that it leaves, 0: none */
  int second; /* 1: the other direction of a branch */
  int moves; /* 1: an impact passes the begin of the period where it ends */
} Part;

/* Motions of twice the period of another one, or that begin elsewhere on it. */
typedef struct Doubled {
  lag_scene scene; /* with the time at which they begin */
  lag_sim *like;
  StateMap closing;
  PeriodicOrbit orbit;
  BranchProblem problem;
} Doubled;

typedef struct Job {
  App *app;
  char name[96];                                 /* of the parameter */
  const lag_var *unit;                           /* of a parameter of the model; NULL: of another quantity */
  double low, high, begin, size, offset, factor; /* range; first value; SI = factor x + offset */
  RestBranch rest;
  SteadyBranch steady;
  PeriodicOrbit orbit;
  BranchProblem problem;
  Doubled doubled[MOST_DOUBLINGS];
  int ndoubled;
  int periodic, led_kind, led_of; /* led_kind: of OrbitHold; -1: a parameter */
  BranchLimits limits;
  Part part[MOST_BRANCHES];
  int nparts, nbranches, number; /* of branches; that of the next part */
  char written_by[1000], guess[64]; /* model, NAME, options in words, for --resume; the period to begin with */
  size_t resumed;                   /* number of the row that the first part goes on from; 0: none */
} Job;

/* The solutions in words: states of rest, steady or periodic motions. */
const char *lag_continue_solutions(const Job *job);

/* continue_range.c: name, low and high, of the one value that is a range, which is taken out of the settings; the
 * quantity of this name, and its value at the start; begin := the scene's value, if it lies in the range, else the
 * first end. 0, or EXIT_USAGE after a message. */
int lag_continue_take_range(Job *job);
int lag_continue_find_parameter(Job *job);
int lag_continue_choose_begin(Job *job);

/* Text or JSON: the points where a branch changes. */
void lag_continue_put_text(FILE *f, const Job *job);
void lag_continue_put_json(FILE *f, const Job *job);
/* app->table := columns of rows. 0, or EXIT_USAGE after a message, as of the other ones. */
int lag_continue_make_table(Job *job);
/* written_by := the run in words: what a file to resume must share. */
void lag_continue_describe(Job *job);
/* Reads the rows of --resume, if given: the start, and the row that a branch goes on from. */
int lag_continue_resume(Job *job);
/* That row, and the unit vector d[cols] from the one before it. */
const double *lag_continue_last(const Job *job);
void lag_continue_direction(const Job *job, const PeriodicOrbit *o, int cols, double *d);
/* All points as rows of --output, and the picture of --svg, if asked for. 0, or EXIT_USAGE after a message. */
int lag_continue_write_rows(Job *job);
int lag_continue_draw(Job *job);
