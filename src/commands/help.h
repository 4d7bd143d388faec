/* `lagc help`: pages on a command, a chapter or a word of the reference, a function, a unit, an option.
 *
 * Nothing is written twice: commands and options come from their tables (commands/command_table.h), the language from its
 * reference (grammar/LANGUAGE.md), units from the compiler's own table. */
#ifndef LAGC_COMMANDS_HELP_H
#define LAGC_COMMANDS_HELP_H

#include "base/intern.h"
#include "base/strbuf.h"
#include "base/vec.h"

typedef VEC(Name) Topics;

/* All topics, each once, except functions, units and options. */
void help_topics(Arena *a, Topics *out);

/* Appends help on a topic (NULL: the list of topics). Returns 0 for an unknown topic; then *near is the nearest
 * known one, or NULL. */
int help_print(StrBuf *out, const char *topic, Name *near);

#endif
