/* The command line of lagc. */
#ifndef LAGC_OPTIONS_H
#define LAGC_OPTIONS_H

#include "base/define.h"
#include "base/vec.h"
#include "cli/commands.h"

typedef VEC(const char *) OptionTexts;

typedef struct {
  Command command;
  const char *file, *scene;
  const char *output;      /* -o */
  const char *method;      /* emit, build --method; of run, plot, animate, which pass it on */
  const char *resume;      /* of run */
  const char *tol;         /* of run, plot, animate */
  const char *format;      /* derive --format */
  const char *dump;        /* --dump=ast,model,eqns,prog */
  const char *topic;       /* of help; the shell of completion */
  int clear;               /* of cache */
  int help;                /* --help: then command is CMD_HELP */
  int verbose;             /* check --verbose */
  int allow_numeric;       /* check --allow-numeric */
  int no_gsl, ops, hamiltonian;
  const char *precision;   /* of simulators: double, long, quad; NULL: double */
  const char *math;        /* --math own|libm */
  const char *with;        /* --with linear: parts of a model that are emitted only where something needs them */
  VEC(Define) defines;
  const char *fix;         /* --fix g,l: parameters that become numbers */
  const char *accuracy;    /* effects --accuracy */
  int json;                /* of effects; others pass it on */
  OptionTexts rest;        /* run, plot, animate: what the simulator gets, the scene too; complete: the words */
  OptionTexts observe;     /* run --observe: expressions */
  const char *section;     /* run, plot --section */
  const char *x, *y, *phase; /* plot */
  const char *points, *from; /* animate */
  int no_rods;
} Options;

/* Whether simulators compute with more digits than a double has. */
int options_more_digits(const Options *o);

/* Reads argv. 0, with *error saying what is wrong and what to write, on a mistake. */
int options_read(Arena *a, int argc, char **argv, Options *o, const char **error);

/* Whether a word of n bytes is one of the choices, which stand with spaces between them. */
int is_choice(const char *choices, const char *word, size_t n);

#endif
