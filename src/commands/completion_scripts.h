/* The shells' completion scripts, complete.bash, .zsh and .fish, built into lagc. */
#ifndef LAGC_COMMANDS_COMPLETION_SCRIPTS_H
#define LAGC_COMMANDS_COMPLETION_SCRIPTS_H

#include "base/strbuf.h"

/* Appends the script for a shell: bash, zsh or fish. */
void completion_print_script(StrBuf *out, const char *shell);

#endif
