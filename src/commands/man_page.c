/* Commands and options as pages: the man page, which is src/lagc.1 with them in the place of
 * @SYNOPSIS@, @COMMANDS@ and @EXPERT@, in the language of mdoc(7) (`make install` writes it by
 * `lagc manpage`); and a chapter of grammar/LANGUAGE.md (`lagc manpage markdown`). */
#include <string.h>

#include "commands/command_table.h"
#include "commands/commands.h"
#include "commands/man_frame.h" /* generated from src/lagc.1 */
#include "commands/terminal_page.h"

/* Markup of one language. */
typedef struct {
  void (*command)(StrBuf *out, const CommandRow *row); /* heading and usage */
  void (*text)(StrBuf *out, const char *text, size_t n), (*code)(StrBuf *out, const char *line, size_t n);
  void (*option)(StrBuf *out, const OptionRow *o);
  const char *code_begins, *code_ends, *paragraph, *list_begins, *list_ends;
} Markup;

/* ---- mdoc ---- */

/* Text for roff: each sentence on a line of its own, code between backticks in bold. */
static void roff_text(StrBuf *out, const char *text, size_t n) {
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

static void roff_option(StrBuf *out, const OptionRow *o) {
  sb_puts(out, ".It ");
  if (o->brief) sb_printf(out, "Fl %s , ", o->brief + 1);
  sb_printf(out, "Fl %s", o->name + 1);
  if (o->value) sb_printf(out, " Ar \"%s\"", o->value);
  sb_putc(out, '\n');
  roff_text(out, o->does, strlen(o->does));
}

static void roff_command(StrBuf *out, const CommandRow *row) { sb_printf(out, ".Ss lagc %s\n", row->name); }

static const Markup roff = {roff_command, roff_text, roff_text, roff_option, ".Bd -literal -offset indent\n", ".Ed\n",
                            ".Pp\n", ".Bl -tag -width Ds\n", ".El\n"};

/* ---- Markdown ---- */

/* Text filled to lines; outside of code between backticks the signs of emphasis, of strokes and of
 * tags are taken literally. */
static void markdown_item(StrBuf *out, const char *text, size_t n, size_t indent) {
  StrBuf escaped = strbuf(out->arena);
  int code = 0;
  for (size_t i = 0; i < n; i++) {
    code ^= text[i] == '`';
    if (!code && strchr("*_~<", text[i])) sb_putc(&escaped, '\\');
    sb_putc(&escaped, text[i]);
  }
  page_words(out, sb_text(&escaped), escaped.n, 0, indent);
}
static void markdown_text(StrBuf *out, const char *text, size_t n) { markdown_item(out, text, n, 0); }

static void markdown_option(StrBuf *out, const OptionRow *o) {
  Arena *a = out->arena;
  const char *brief = o->brief ? arena_printf(a, "`%s`, ", o->brief) : "", *space = o->value ? " " : "",
      *value = o->value ? o->value : "";
  const char *item = arena_printf(a, "- %s`%s%s%s`: %s", brief, o->name, space, value, o->does);
  markdown_item(out, item, strlen(item), 2);
}

static void markdown_command(StrBuf *out, const CommandRow *row) {
  const char *usage = arena_printf(out->arena, "lagc %s %s", row->name, row->arguments);
  sb_printf(out, "\n### lagc %s\n```text\n", row->name);
  page_words(out, usage, strlen(usage), 0, 4);
  sb_puts(out, "```\n\n");
}

static void markdown_code(StrBuf *out, const char *line, size_t n) { sb_printf(out, "%.*s\n", (int)n, line); }

static const Markup markdown = {markdown_command, markdown_text, markdown_code, markdown_option, "\n```text\n", "```\n",
                                "\n", "\n", ""};

/* ---- pages ---- */

/* Paragraphs of a page of help; lines that begin with white space are preformatted. */
static void put_paragraphs(StrBuf *out, const Markup *m, const char *text) {
  int literal = 0, fresh = 0;
  for (const char *s = text; *s;) {
    size_t n = strcspn(s, "\n"), margin = strspn(s, " ") < 2 ? 0 : 2;
    if (n && margin && !literal) sb_puts(out, m->code_begins);
    if (n && !margin && literal) sb_puts(out, m->code_ends);
    if (n && !margin && fresh) sb_puts(out, m->paragraph);
    if (n) literal = margin > 0;
    if (n) (literal ? m->code : m->text)(out, s + margin, n - margin);
    fresh = n == 0;
    s += n + (s[n] == '\n');
  }
  if (literal) sb_puts(out, m->code_ends);
}

/* Options of a command, less those of experts and those that stand at `run`; of CMD_NONE, those of experts. */
static void put_options(StrBuf *out, const Markup *m, Command c) {
  int any = 0;
  for (size_t i = 0; option_row(i); i++) {
    const OptionRow *o = option_row(i);
    int expert = option_expert(o), here = c == CMD_NONE ? expert : !expert && option_listed(o, c);
    if (!here || strcmp(o->name, "--help") == 0) continue; /* all commands have --help */
    if (!any++) sb_puts(out, m->list_begins);
    m->option(out, o);
  }
  if (any) sb_puts(out, m->list_ends);
}

static void put_synopsis(StrBuf *out) {
  for (size_t i = 0; command_row(i); i++) {
    const CommandRow *row = command_row(i);
    if (!row->help) continue;
    sb_printf(out, ".Nm\n.Cm %s\n", row->name);
    if (*row->arguments) roff_text(out, row->arguments, strlen(row->arguments));
  }
}

static void put_commands(StrBuf *out, const Markup *m) {
  for (size_t i = 0; command_row(i); i++) {
    const CommandRow *row = command_row(i);
    if (!row->help) continue;
    m->command(out, row);
    put_paragraphs(out, m, row->help);
    put_options(out, m, row->command);
  }
}

static void put_man_page(StrBuf *out) {
  for (size_t i = 0; i < sizeof man_frame / sizeof *man_frame; i++) {
    const char *line = man_frame[i];
    if (strcmp(line, "@SYNOPSIS@\n") == 0) put_synopsis(out);
    else if (strcmp(line, "@COMMANDS@\n") == 0) put_commands(out, &roff);
    else if (strcmp(line, "@EXPERT@\n") == 0) put_options(out, &roff, CMD_NONE);
    else sb_puts(out, line);
  }
}

static void put_chapter(StrBuf *out) {
  sb_puts(out, "## Commands and options\nOptions of `run` that `plot`, `animate` and simulators have, too, are listed "
               "with `run`.\n");
  put_commands(out, &markdown);
  sb_puts(out, "\n### Options for experts\n");
  put_options(out, &markdown, CMD_NONE);
}

int command_manpage(Compiler *c) {
  StrBuf out = strbuf(c->arena);
  (c->o.topic ? put_chapter : put_man_page)(&out);
  return compiler_write(c, NULL, &out);
}
