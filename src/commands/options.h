/* Parser of lagc's command line. */
#ifndef LAGC_COMMANDS_OPTIONS_H
#define LAGC_COMMANDS_OPTIONS_H

#include "commands/command_table.h"

/* Whether simulators compute with more digits than a double has. */
int options_more_digits(const Options *o);

/* Parses argv. Returns 0 on a mistake, with the message and advice in *error. */
int options_read(Arena *a, int argc, char **argv, Options *o, const char **error);

#endif
