/* The man page: src/lagc.1 with its commands and options in the place of @SYNOPSIS@, @COMMANDS@ and @EXPERT@, in the language of mdoc(7). `make install`
 * writes it by `lagc manpage`. */
#include <string.h>

#include "commands/command_table.h"
#include "commands/commands.h"
#include "commands/man_frame.h" /* generated from src/lagc.1 */

/* Text for roff: each sentence on a line of its own, code between backticks in bold. */
static void put_text(StrBuf *out, const char *text, size_t n) {
  int code = 0;
  for (size_t i = 0; i < n; i++) {
    int fresh = i == 0 || (text[i - 1] == ' ' && out->at[out->n - 1] == '\n');
    if (fresh && (text[i] == '.' || text[i] == '\'')) sb_puts(out, "\\&");
    if (text[i] == ' ' && i && text[i - 1] == '.') sb_putc(out, '\n');
    else if (text[i] == '`') sb_puts(out, (code = !code) ? "\\fB" : "\\fR");
    else if (text[i] == '\\') sb_puts(out, "\\e");
    else if (text[i] == '-') sb_puts(out, "\\-");
    else sb_putc(out, text[i]);
  }
  sb_putc(out, '\n');
}

/* Paragraphs of a page of help; lines that begin with white space are preformatted. */
static void put_paragraphs(StrBuf *out, const char *text) {
  int literal = 0, fresh = 0;
  for (const char *s = text; *s;) {
    size_t n = strcspn(s, "\n"), margin = strspn(s, " ") < 2 ? 0 : 2;
    if (n && margin && !literal) sb_puts(out, ".Bd -literal -offset indent\n");
    if (n && !margin && literal) sb_puts(out, ".Ed\n");
    if (n && !margin && fresh) sb_puts(out, ".Pp\n");
    if (n) literal = margin > 0;
    if (n) put_text(out, s + margin, n - margin);
    fresh = n == 0;
    s += n + (s[n] == '\n');
  }
  if (literal) sb_puts(out, ".Ed\n");
}

static void put_option(StrBuf *out, const OptionRow *o) {
  sb_puts(out, ".It ");
  if (o->brief) sb_printf(out, "Fl %s , ", o->brief + 1);
  sb_printf(out, "Fl %s", o->name + 1);
  if (o->value) sb_printf(out, " Ar \"%s\"", o->value);
  sb_putc(out, '\n');
  put_text(out, o->does, strlen(o->does));
}

/* Options of a command, less those of experts and those that stand at `run`; of CMD_NONE, those of experts. */
static void put_options(StrBuf *out, Command c) {
  int any = 0;
  for (size_t i = 0; option_row(i); i++) {
    const OptionRow *o = option_row(i);
    if (strcmp(o->name, "--help") == 0) continue; /* of all commands */
    int expert = option_expert(o), here = c == CMD_NONE ? expert : !expert && o->commands & 1u << c;
    if (!here || (c != CMD_NONE && c != CMD_RUN && o->passed && o->commands & 1u << CMD_RUN)) continue;
    if (!any++) sb_puts(out, ".Bl -tag -width Ds\n");
    put_option(out, o);
  }
  if (any) sb_puts(out, ".El\n");
}

static void put_commands(StrBuf *out, int synopsis) {
  for (size_t i = 0; command_row(i); i++) {
    const CommandRow *row = command_row(i);
    if (!row->help) continue;
    if (synopsis) {
      sb_printf(out, ".Nm\n.Cm %s\n", row->name);
      if (*row->arguments) put_text(out, row->arguments, strlen(row->arguments));
      continue;
    }
    sb_printf(out, ".Ss lagc %s\n", row->name);
    put_paragraphs(out, row->help);
    put_options(out, row->command);
  }
}

int command_manpage(Compiler *c) {
  StrBuf out = strbuf(c->arena);
  for (size_t i = 0; i < sizeof man_frame / sizeof *man_frame; i++) {
    const char *line = man_frame[i];
    if (strcmp(line, "@SYNOPSIS@\n") == 0) put_commands(&out, 1);
    else if (strcmp(line, "@COMMANDS@\n") == 0) put_commands(&out, 0);
    else if (strcmp(line, "@EXPERT@\n") == 0) put_options(&out, CMD_NONE);
    else sb_puts(&out, line);
  }
  return compiler_write(c, NULL, &out);
}
