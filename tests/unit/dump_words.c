/* dump_words: the words that the compiler knows, from its own tables, one a line: `statement coord`, `slot every`,
 * `function sin`, `unit m` (`prefixed m` where it takes SI prefixes), `command run`, `option run --tol`, `BROUGHT
 * python | load`: words that users bring along and what they mean. Help, the man page, completion and the editors'
 * grammar are held against them. */
#include <stdio.h>

#include "commands/command_table.h"
#include "model/model.h"
#include "syntax/token.h"

static void dump_options(const CommandRow *c) {
  for (size_t i = 0; option_row(i); i++) {
    const OptionRow *o = option_row(i);
    if (!(o->commands & 1u << c->command)) continue;
    printf("%s %s %s\n", o->passed ? "passed" : "option", c->name, o->name);
    if (o->brief) printf("%s %s %s\n", o->passed ? "passed" : "option", c->name, o->brief);
  }
}

int main(void) {
  for (int k = TOK_MODEL; k <= TOK_STOP; k++) printf("statement %s\n", token_word((TokKind)k));
  for (int k = TOK_PERIODIC; k <= TOK_EVERY; k++) printf("slot %s\n", token_word((TokKind)k));
  for (int k = TOK_SUM; k <= TOK_PRODUCT; k++) printf("function %s\n", token_word((TokKind)k));
  for (size_t i = 0; function_name(i); i++) printf("function %s\n", function_name(i));
  for (uint32_t i = 1; unit_name(i); i++) printf("%s %s\n", unit_takes_prefixes(i) ? "prefixed" : "unit", unit_name(i));
  for (size_t i = 0; command_row(i); i++) {
    if (!command_row(i)->help) continue;
    printf("command %s\n", command_row(i)->name);
    dump_options(command_row(i));
  }
#define WORDS(words, means, way) printf("BROUGHT %s | %s\n", words, means), printf("WAY %s\n", (way) ? (way) : "");
#include "commands/help_words.def"
  return 0;
}
