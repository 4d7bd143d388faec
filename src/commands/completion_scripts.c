/* `lagc completion SHELL`: prints a built-in script. */
#include "commands/completion_scripts.h"

#include <string.h>

#include "commands/complete_bash.h"
#include "commands/complete_fish.h"
#include "commands/complete_zsh.h"

void completion_print_script(StrBuf *out, const char *shell) {
  static const struct {
    const char *shell;
    const char *const *lines;
    size_t n;
  } scripts[] = {
    {"bash", complete_bash, sizeof complete_bash / sizeof *complete_bash},
    {"zsh", complete_zsh, sizeof complete_zsh / sizeof *complete_zsh},
    {"fish", complete_fish, sizeof complete_fish / sizeof *complete_fish},
  };
  for (size_t i = 0; i < sizeof scripts / sizeof *scripts; i++)
    for (size_t k = 0; k < scripts[i].n && strcmp(scripts[i].shell, shell) == 0; k++) sb_puts(out, scripts[i].lines[k]);
}
