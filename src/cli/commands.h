/* The commands of lagc and their options, as tables: the parser, `lagc help` and completion read them, and a test
 * holds the man page and the simulator's own options against them. */
#ifndef LAGC_COMMANDS_H
#define LAGC_COMMANDS_H

#include <stddef.h>

typedef enum {
  CMD_NONE, CMD_CHECK, CMD_DERIVE, CMD_NOETHER, CMD_RUN, CMD_PLOT, CMD_ANIMATE, CMD_MODES, CMD_LYAPUNOV, CMD_COST, CMD_EFFECTS, CMD_METHODS, CMD_CACHE, CMD_BUILD, CMD_HEADER, CMD_EMIT,
  CMD_HELP, CMD_COMPLETION, CMD_VERSION, CMD_COMPLETE, CMD_COUNT
} Command;

typedef struct {
  Command command;
  const char *name;
  const char *topic;     /* another word for it, for `lagc help`; or NULL */
  const char *arguments; /* after the name, in a line of usage */
  const char *does;      /* in a few words; NULL: not listed */
  const char *help;      /* paragraphs; a line that begins with white space stands as it is */
} CommandRow;

/* What an option takes: how it is parsed, and what completion offers. */
typedef enum {
  TAKES_NOTHING,
  TAKES_TEXT,
  TAKES_NUMBER,
  TAKES_FILE,    /* hint: the suffixes that it may have, with spaces between them; "" for any */
  TAKES_CHOICE,  /* hint: the choices */
  TAKES_CHOICES, /* the same, with commas between several */
  TAKES_METHOD,
  TAKES_PARAMS,  /* names of parameters, with commas between several, or the hint */
  TAKES_EXPR,    /* of the model */
  TAKES_EXPRS,   /* the same; may be given several times: a list */
  TAKES_DEFINE   /* CONST=VALUE */
} OptionTakes;

typedef struct {
  const char *name;  /* "--output" */
  const char *brief; /* "-o", or NULL */
  const char *value; /* how help calls what it takes; NULL: nothing */
  OptionTakes takes;
  const char *hint;
  unsigned commands; /* 1u << command for each that has it */
  int passed;        /* belongs to the simulator */
  size_t field;      /* otherwise: where in Options it goes; int, const char *, or a list */
  const char *does;
} OptionRow;

/* Row i of each table; NULL past the end. */
const CommandRow *command_row(size_t i);
const OptionRow *option_row(size_t i);

/* The command that a first word names ("run", "--help"); CMD_NONE for none. */
Command command_named(const char *word);

/* The row of a command; NULL for CMD_NONE. */
const CommandRow *command_find(Command c);

/* The option that `arg` writes ("--until", "--until=3", "-o", "-DN=3"), among those of c; NULL for none. *value is what
 * stands in the same word after it, or NULL. */
const OptionRow *option_find(Command c, const char *arg, const char **value);
/* Whether the word is an option whose value is the next one: in `--method rk4(step=0.01)` that is no setting. */
int option_takes_next(Command c, const char *word);

/* Whether the command runs a simulator: then name=value is a setting; whether it reads a model at all. */
int command_simulates(Command c);
int command_reads_model(Command c);

#endif
