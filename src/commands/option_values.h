/* The command line of lagc as read: the command and the values of its options. */
#ifndef LAGC_COMMANDS_OPTION_VALUES_H
#define LAGC_COMMANDS_OPTION_VALUES_H

#include "base/define.h"
#include "base/vec.h"

typedef enum {
  CMD_NONE, CMD_CHECK, CMD_DERIVE, CMD_NOETHER, CMD_RUN, CMD_PLOT, CMD_ANIMATE, CMD_MODES, CMD_LYAPUNOV, CMD_COST, CMD_EFFECTS, CMD_METHODS, CMD_CACHE, CMD_BUILD, CMD_HEADER, CMD_EMIT,
  CMD_HELP, CMD_COMPLETION, CMD_VERSION, CMD_COMPLETE, CMD_COUNT
} Command;

typedef VEC(const char *) OptionTexts;

typedef struct {
  Command command;
  const char *file, *scene;
  const char *output;      /* -o */
  const char *method;      /* --method; run, plot and animate pass it on as well */
  const char *resume;      /* of run */
  const char *tol;         /* run, plot, animate --tol */
  const char *format;      /* derive, noether --format */
  const char *dump;        /* --dump=ast,eqns,passes,prog */
  const char *topic;       /* help TOPIC; completion SHELL */
  int clear;               /* of cache */
  int help;                /* --help: then command is CMD_HELP */
  int verbose;             /* check --verbose */
  int allow_numeric;       /* check --allow-numeric */
  int no_gsl, ops, hamiltonian;
  const char *precision;   /* --precision: double, long, quad; NULL: double */
  const char *math;        /* --math own|libm */
  const char *with;        /* --with linear: optional parts of an emitted model */
  VEC(Define) defines;
  const char *fix;         /* --fix g,l: parameters that become numbers */
  const char *accuracy;    /* effects --accuracy */
  int json;                /* effects --json; other commands pass it on */
  OptionTexts rest;        /* run, plot, animate: the simulator's arguments, the scene included; complete: the words */
  OptionTexts observe;     /* run --observe: expressions */
  const char *section;     /* run, plot --section */
  const char *x, *y, *phase; /* plot */
  const char *points, *from; /* animate */
  int no_rods;
} Options;

#endif
