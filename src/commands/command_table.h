/* Tables of lagc's commands and options, read by the parser, `lagc help` and completion; a test compares the man page
 * and the simulator's own options with them. */
#ifndef LAGC_COMMANDS_COMMAND_TABLE_H
#define LAGC_COMMANDS_COMMAND_TABLE_H

#include <stddef.h>

#include "commands/option_values.h"

typedef struct {
  Command command;
  const char *name;
  const char *topic;     /* synonym for `lagc help`, or NULL */
  const char *arguments; /* its arguments in the usage line */
  const char *does;      /* summary in a few words; NULL: not listed */
  const char *help;      /* paragraphs; lines that begin with white space are preformatted */
} CommandRow;

/* Kind of an option's value: decides how it is parsed and completed. */
typedef enum {
  TAKES_NOTHING,
  TAKES_TEXT,
  TAKES_NUMBER,
  TAKES_FILE,    /* hint: allowed suffixes, separated by spaces; "" for any */
  TAKES_CHOICE,  /* hint: the choices, separated by spaces */
  TAKES_CHOICES, /* one or more choices, separated by commas */
  TAKES_METHOD,
  TAKES_PARAMS,  /* names of parameters, separated by commas, or the hint */
  TAKES_EXPR,    /* an expression of the model */
  TAKES_EXPRS,   /* an expression; repeated options make a list */
  TAKES_DEFINE   /* CONST=VALUE */
} OptionTakes;

typedef struct {
  const char *name;  /* "--output" */
  const char *brief; /* "-o", or NULL */
  const char *value; /* the value in help; NULL: takes none */
  OptionTakes takes;
  const char *hint;
  unsigned commands; /* 1u << command for each command that has it */
  int passed;        /* passed on to the simulator */
  size_t field;      /* otherwise: offset in Options of an int, const char * or list */
  const char *does;
} OptionRow;

/* Row i of each table; NULL past the end. */
const CommandRow *command_row(size_t i);
const OptionRow *option_row(size_t i);

/* The command named by the first word ("run", "--help"), or CMD_NONE. */
Command command_named(const char *word);

/* The row of a command; NULL for CMD_NONE. */
const CommandRow *command_find(Command c);

/* The option of command c written as `arg` ("--until", "--until=3", "-o", "-DN=3"), or NULL. *value: the value in the
 * same word, or NULL. */
const OptionRow *option_find(Command c, const char *arg, const char **value);
/* Whether the word is an option whose value is the next word: in `--method rk4(step=0.01)` the second word is no setting. */
int option_takes_next(Command c, const char *word);

/* Whether the command runs a simulator, so that name=value is a setting; whether it reads a model. */
int command_simulates(Command c);
int command_reads_model(Command c);

#endif
