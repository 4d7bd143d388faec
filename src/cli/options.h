/* The command line of lagc. */
#ifndef LAGC_OPTIONS_H
#define LAGC_OPTIONS_H

#include "base/define.h"
#include "base/vec.h"

typedef enum { CMD_NONE, CMD_CHECK, CMD_DERIVE, CMD_EMIT, CMD_HEADER, CMD_BUILD, CMD_RUN, CMD_PLOT, CMD_ANIMATE, CMD_MODES, CMD_METHODS, CMD_HELP, CMD_VERSION } Command;

typedef struct {
  Command command;
  const char *file, *scene;
  const char *output;      /* -o */
  const char *method;      /* emit, build --method; of run, plot, animate, which pass it on */
  const char *resume;      /* of run */
  const char *format;      /* derive --format */
  const char *dump;        /* --dump=ast,model,eqns,prog */
  const char *topic;       /* help TOPIC */
  int allow_numeric;       /* check --allow-numeric */
  int no_gsl, ops;
  int linear;              /* --with linear */
  VEC(Define) defines;
  VEC(const char *) rest;  /* run, plot, animate: what the simulator gets, the scene too */
  VEC(const char *) observe; /* run --observe: expressions */
  const char *x, *y, *phase; /* plot */
  const char *points, *from; /* animate */
  int no_rods;
} Options;

/* Reads argv. 0, with *error saying what is wrong and what to write, on a mistake. */
int options_read(Arena *a, int argc, char **argv, Options *o, const char **error);

/* Whether the command hands its values and options to a simulator. */
int options_simulate(const Options *o);

/* The text of `lagc help`, or of help on one command or topic; NULL when there is no such topic. */
const char *options_help(const char *topic);

#endif
