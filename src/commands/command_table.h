/* Tables of lagc's commands and options, and the values that a command line gives to them. The parser, `lagc help`
 * and completion read the tables; a test compares the man page and the simulator's own options with them. */
#pragma once

#include <stdint.h>
#include <stddef.h>

#include "app/options.def" /* OptionTakes; a copy of runtime/app/options.def */
#include "model/model.h"

typedef enum {
  CMD_NONE, CMD_CHECK, CMD_VERIFY, CMD_DERIVE, CMD_NOETHER, CMD_ACTION, CMD_RUN, CMD_PLOT, CMD_ANIMATE, CMD_MODES,
  CMD_LINEARIZE, CMD_LYAPUNOV, CMD_FIT, CMD_DESIGN, CMD_ORBIT, CMD_CONTINUE, CMD_COST, CMD_SWEEP, CMD_EFFECTS,
  CMD_METHODS, CMD_MODELS, CMD_NEW,
  CMD_CACHE, CMD_BUILD, CMD_HEADER, CMD_EMIT, CMD_FMU, CMD_PAGE, CMD_PLAYGROUND, CMD_HELP, CMD_COMPLETION, CMD_VERSION,
  CMD_COMPLETE, CMD_MANPAGE,
  CMD_COUNT
} Command;

/* A set of commands, a bit each. */
typedef uint64_t CommandSet;
static inline CommandSet command_bit(Command c) { return (CommandSet)1 << c; }

typedef VEC(const char *) OptionTexts;

/* A constant that a sweep varies, and the texts of its values. */
typedef struct {
  const char *name;
  OptionTexts values;
} ConstRange;

/* The command line as read: the command and the values of its options. */
typedef struct {
  Command command;
#define OWN_FLAG(f) int f;
#define OWN_TEXT(f) const char *f;
#define OWN_LIST(f) OptionTexts f;
#define TO(f)
#define LAGC(name, brief, value, takes, hint, commands, field, text) field
#define BOTH(...)
#define SIMULATOR(...)
#include "app/options.def"
  const char *file, *scene;
  const char *topic;       /* help TOPIC; completion SHELL */
  /* --tol, --resume, --to, and --accuracy of a run: noted, and passed on */
  const char *tol, *resume, *to, *accurate;
  VEC(Define) defines;
  VEC(ConstRange) consts;  /* of sweep; `defines` ends with a value of each */
  OptionTexts scenes;      /* plot: all scenes named, each once */
  OptionTexts rest;        /* run, plot, animate: the simulator's arguments, the scene included; complete: the words */
} Options;

typedef struct {
  Command command;
  const char *name;
  const char *topic;     /* synonym for `lagc help`, or NULL */
  const char *arguments; /* its arguments in the usage line */
  const char *does;      /* summary in a few words; NULL: not listed */
  const char *help;      /* paragraphs; lines that begin with white space are preformatted */
} CommandRow;

typedef struct {
  const char *name;  /* "--output" */
  const char *brief; /* "-o", or NULL */
  const char *value; /* the value in help; NULL: takes none */
  OptionTakes takes;
  const char *hint;
  CommandSet commands; /* that have it */
  int passed;        /* passed on to the simulator */
  size_t field;      /* otherwise: offset in Options of an int, const char * or list */
  const char *does;
} OptionRow;

/* Parses argv. Returns 0 on a mistake, with the message and advice in *error. */
int options_read(Arena *a, int argc, char **argv, Options *o, const char **error);

/* The value of an option that the simulator reads: --NAME VALUE or --NAME=VALUE; NULL if it is not given. */
const char *options_passed(const Options *o, const char *name);
/* Whether an option without a value is passed on. */
int options_pass_flag(const Options *o, const char *name);

/* Whether simulators compute with more digits than a double has. */
int options_more_digits(const Options *o);

/* Row i of each table; NULL past the end. */
const CommandRow *command_row(size_t i);
const OptionRow *option_row(size_t i);

/* The command named by the first word ("run", "--help"), or CMD_NONE. */
Command command_named(const char *word);

/* The row of a command; NULL for CMD_NONE. */
const CommandRow *command_find(Command c);

/* The option of command c written as `arg` ("--until", "--until=3", "-o", "-DN=3"), or NULL. *value: the value in
 * the same word, or NULL. */
const OptionRow *option_find(Command c, const char *arg, const char **value);
/* Whether the word is an option whose value is the next word: in `--method rk4(step=0.01)` the second word is no
 * setting. */
int option_takes_next(Command c, const char *word);

/* Whether pages list the option with the command: those that are passed on stand at `run`. */
int option_listed(const OptionRow *o, Command c);

/* Whether the option is for experts: listed by `lagc help expert`, not on the page of each command. */
int option_expert(const OptionRow *o);

/* Whether the command runs a simulator; whether name=value is a setting, as it is there; whether it reads a model. */
int command_simulates(Command c);
int command_takes_values(Command c);
int command_reads_model(Command c);
