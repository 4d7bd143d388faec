/* Parser of lagc's command line. */
#ifndef LAGC_COMMANDS_OPTIONS_H
#define LAGC_COMMANDS_OPTIONS_H

#include "base/define.h"
#include "base/vec.h"
#include "commands/command_table.h"

typedef VEC(const char *) OptionTexts;

typedef struct {
  Command command;
  const char *file, *scene;
  const char *output;      /* -o */
  const char *method;      /* --method; run, plot and animate pass it on as well */
  const char *resume;      /* run --resume */
  const char *tol;         /* run, plot, animate --tol */
  const char *format;      /* derive, noether --format */
  const char *dump;        /* --dump=ast,model,eqns,prog */
  const char *topic;       /* help TOPIC; completion SHELL */
  int clear;               /* cache --clear */
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

/* Whether simulators compute with more digits than a double has. */
int options_more_digits(const Options *o);

/* Parses argv. Returns 0 on a mistake, with the message and advice in *error. */
int options_read(Arena *a, int argc, char **argv, Options *o, const char **error);

/* Whether a word of n bytes is one of the choices, which are separated by spaces. */
int is_choice(const char *choices, const char *word, size_t n);

#endif
