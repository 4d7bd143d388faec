/* `lagc help`: pages on a command, a chapter or a word of the reference, a function, a unit, an option; put together
 * from the tables of commands and options, the chapters of grammar/LANGUAGE.md, and the table of units. */
#include "commands/commands.h"

#include <ctype.h>
#include <errno.h>
#include <string.h>

#include "base/method_table.h"
#include "base/words.h"
#include "commands/command_table.h"
#include "commands/help_search.h"
#include "commands/manual.h"
#include "commands/terminal_page.h"
#include "model/model.h"
#include "syntax/parse.h"
#include "toolchain/process.h"
#include "toolchain/toolchain.h"

enum { TERMS = 24 }; /* column of the meanings in lists */

/* ---- chapters of the language reference ---- */

/* A chapter of grammar/LANGUAGE.md runs from a heading (## or ###) to the next. A comment below the heading lists
 * the words that it explains; the first one names the chapter: <!-- help: scenes scene start span --> */
typedef struct {
  const char *const *lines; /* the heading first */
  size_t n;
  const char *words; /* "scenes scene start span"; "" where there is no comment */
} Chapter;

typedef VEC(Chapter) Chapters;

static void reference_chapters(Arena *a, Chapters *out) {
  const Document *d = &documents[LANGUAGE];
  int code = 0;
  for (size_t i = 0; i < d->n; i++) {
    code ^= strncmp(d->lines[i], "```", 3) == 0;
    if (!code && document_heading(d->lines[i])) {
      const char *words = i + 1 < d->n ? document_words(a, d->lines[i + 1]) : "";
      vec_push(a, out, ((Chapter){&d->lines[i], 0, words}));
    }
    if (out->n) out->at[out->n - 1].n++;
  }
}

/* The text of the chapter's heading. */
static const char *chapter_title(Arena *a, const Chapter *c) {
  const char *title = c->lines[0] + strspn(c->lines[0], "# ");
  return arena_strndup(a, title, strcspn(title, "\n"));
}

/* Whether the line has, before `end` (a | or a colon), code in backticks that begins with the word. */
static int says_first(const char *line, char end, const char *word) {
  size_t n = strlen(word);
  int code = 0;
  for (const char *s = line; *s && (code || *s != end); s++) {
    if (*s != '`') continue;
    code = !code;
    if (code && strncmp(s + 1, word, n) == 0 && !isalnum((unsigned char)s[n + 1])) return 1;
  }
  return 0;
}

/* Prints line i if it is a row of a table about the word, or, in a chapter that lists the word, an item of a list
 * about it. Returns 1 when it did. */
static int print_entry(StrBuf *out, const Chapter *c, size_t i, const char *word) {
  const char *line = c->lines[i];
  if (line[0] == '|' && says_first(line + 1, '|', word)) {
    page_row(out, line);
    return 1;
  }
  if (strncmp(line, "- ", 2) != 0 || !has_word(c->words, word) || !says_first(line, ':', word)) return 0;
  size_t n = 1;
  while (i + n < c->n && strncmp(c->lines[i + n], "  ", 2) == 0) n++;
  page_markdown(out, c->lines + i, n);
  return 1;
}

static int names_chapter(const Chapter *c, const char *word) {
  size_t n = strlen(word);
  return strncmp(c->words, word, n) == 0 && (c->words[n] == ' ' || c->words[n] == '\0');
}

/* Appends the chapter's text on a word: rows of tables that begin with it; for one of the chapter's own words also
 * items of lists that do, or, without any, the whole chapter. Returns 0 when there is nothing. */
static int chapter_print(StrBuf *out, const Chapter *c, const char *word) {
  int rows = 0;
  for (size_t i = 0; i < c->n && !names_chapter(c, word); i++) rows += print_entry(out, c, i, word);
  if (rows) {
    const char *chapter = word_at(out->arena, c->words, 0);
    if (chapter) sb_printf(out, "\n`lagc help %s` says more.\n", chapter);
    return 1;
  }
  if (!has_word(c->words, word)) return 0;
  page_markdown(out, c->lines, c->n);
  return 1;
}

/* ---- commands and options ---- */

static void put_option(StrBuf *out, const OptionRow *o) {
  Arena *a = out->arena;
  const char *term = o->brief ? arena_printf(a, "%s, %s", o->brief, o->name) : o->name;
  if (o->value) term = arena_printf(a, "%s %s", term, o->value);
  page_term(out, term, o->does, TERMS);
}

/* Lists a command's options; those passed on to the simulator are listed under `run` only. */
static void put_options(StrBuf *out, Command c) {
  int experts = 0;
  for (size_t i = 0; option_row(i); i++) {
    const OptionRow *o = option_row(i);
    if (!option_listed(o, c)) continue;
    experts |= option_expert(o);
    if (!option_expert(o)) put_option(out, o);
  }
  if (experts) sb_puts(out, "\nMore: `lagc help expert`.\n");
}

static int put_command(StrBuf *out, const char *topic) {
  for (size_t i = 0; command_row(i); i++) {
    const CommandRow *row = command_row(i);
    if (!row->help || (strcmp(row->name, topic) != 0 && (!row->topic || strcmp(row->topic, topic) != 0))) continue;
    const char *usage = arena_printf(out->arena, "usage: lagc %s %s", row->name, row->arguments);
    page_words(out, usage, strlen(usage), 0, 9);
    sb_putc(out, '\n');
    page_paragraphs(out, row->help);
    if (!command_reads_model(row->command)) return 1;
    if (!strstr(row->help, "  name=value ")) sb_putc(out, '\n'); /* a line on name=value heads the options */
    put_options(out, row->command);
    return 1;
  }
  return 0;
}

/* "run, plot, animate" */
static const char *commands_text(Arena *a, CommandSet commands) {
  StrBuf b = strbuf(a);
  for (size_t i = 0; command_row(i); i++)
    if (commands & command_bit(command_row(i)->command)) sb_printf(&b, "%s%s", b.n ? ", " : "", command_row(i)->name);
  return sb_text(&b);
}

/* Prints the options whose name (without dashes) or one of whose choices is the topic. */
static int put_named_options(StrBuf *out, const char *topic, int before) {
  int found = 0;
  topic += strspn(topic, "-");
  for (size_t i = 0; option_row(i); i++) {
    const OptionRow *o = option_row(i);
    if (strcmp(o->name + 2, topic) != 0 && (!o->brief || strcmp(o->brief + 1, topic) != 0) &&
        !(o->takes == TAKES_CHOICE && has_word(o->hint, topic)))
      continue;
    if (before && !found) sb_putc(out, '\n');
    const char *head =
        arena_printf(out->arena, "%s of %s:", found ? "and" : "option", commands_text(out->arena, o->commands));
    page_words(out, head, strlen(head), 0, 0);
    put_option(out, o);
    found = 1;
  }
  return found;
}

/* ---- units ---- */

static int put_unit(StrBuf *out, const char *name, int before) {
  for (uint32_t i = 0; unit_name(i); i++) {
    if (strcmp(unit_name(i), name) != 0) continue;
    const char *is = unit_meaning(i, out->arena);
    sb_printf(out, "%sunit:\n  [%s]%s%s%s\n", before ? "\n" : "", name, is ? " = " : "",
              is ? is : " of the SI, a base unit", unit_takes_prefixes(i) ? "; takes the SI prefixes" : "");
    return 1;
  }
  if (!unit_exists(name)) return 0;
  sb_printf(out, "%sunit:\n  [%s], with an SI prefix; `lagc help units` has the table\n", before ? "\n" : "", name);
  return 1;
}

/* Prints the table of units in columns that are read downwards. */
static void put_units(StrBuf *out) {
  enum { COLUMNS = 2, WIDE = 38 };
  VEC(const char *) cells = {0};
  int plain = 0;
  for (uint32_t i = 1; unit_name(i); i++) { /* the first is 1 */
    const char *is = unit_meaning(i, out->arena), *mark = unit_takes_prefixes(i) ? "" : "*";
    plain |= *mark;
    vec_push(out->arena, &cells,
             arena_printf(out->arena, "%s%s%s%s", unit_name(i), mark, is ? " = " : "", is ? is : ""));
  }
  uint32_t rows = (cells.n + COLUMNS - 1) / COLUMNS;
  sb_puts(out, "\nThe table\n---------\n");
  for (uint32_t r = 0; r < rows; r++) {
    const char *left = cells.at[r], *right = r + rows < cells.n ? cells.at[r + rows] : NULL;
    sb_printf(out, "    %s", left);
    for (size_t w = page_columns(left); right && w < WIDE; w++) sb_putc(out, ' ');
    sb_printf(out, "%s\n", right ? right : "");
  }
  if (plain) sb_puts(out, "    (* takes no SI prefix)\n");
}

/* ---- topics ---- */

static void add_topic(Arena *a, Topics *out, const char *word) {
  for (uint32_t i = 0; i < out->n; i++)
    if (strcmp(out->at[i], word) == 0) return;
  vec_push(a, out, word);
}

void help_topics(Arena *a, Topics *out) {
  Chapters chapters = {0};
  reference_chapters(a, &chapters);
  for (size_t i = 0; command_row(i); i++)
    if (command_row(i)->help) add_topic(a, out, command_row(i)->name);
  for (uint32_t i = 0; i < chapters.n; i++)
    for (size_t k = 0; word_at(a, chapters.at[i].words, k); k++) add_topic(a, out, word_at(a, chapters.at[i].words, k));
  for (size_t i = 0; i < N_DOCUMENTS; i++)
    if (i != LANGUAGE) add_topic(a, out, documents[i].topic);
  add_topic(a, out, "methods");
  add_topic(a, out, "expert");
}

static const char *all_functions(Arena *a) {
  StrBuf b = strbuf(a);
  for (size_t i = 0; function_name(i); i++) sb_printf(&b, "%s ", function_name(i));
  return sb_text(&b);
}

static void put_overview(StrBuf *out) {
  Arena *a = out->arena;
  Chapters chapters = {0};
  Topics shown = {0};
  reference_chapters(a, &chapters);
  sb_puts(out, "lagc compiles a Lagrangian written as text into C, and runs it.\n\n"
               "usage: lagc COMMAND MODEL [SCENE] [options]\n\n");
  for (size_t i = 0; command_row(i); i++)
    if (command_row(i)->does) page_term(out, command_row(i)->name, command_row(i)->does, TERMS);
  sb_puts(out, "\nlagc help tutorial is a quarter of an hour, lagc help python the way from Python.\n"
               "lagc help WORDS searches all of them (lagc help normal modes). Topics: each command,\nfunction, unit "
               "and option; expert; and\n\n");
  for (uint32_t i = 0; i < chapters.n; i++) {
    const char *words = chapters.at[i].words, *first = word_at(a, words, 0);
    uint32_t before = shown.n;
    if (first) add_topic(a, &shown, first);
    if (shown.n == before) continue;
    words += strlen(first);
    const char *more = *words                            ? words + 1
                       : strcmp(first, "functions") == 0 ? all_functions(a)
                                                         : chapter_title(a, &chapters.at[i]);
    page_term(out, first, more, TERMS);
  }
  page_term(out, "methods", "of integration, with their options", TERMS);
  sb_putc(out, '\n');
  page_paragraphs(out, "MODEL is a .lag file; without a SCENE its first scene is taken. Exit status: 0 ok, 1 bad "
                       "model, 2 usage or files, 3 the run failed.");
}

static Name nearest(Arena *a, const char *topic) {
  Topics known = {0};
  help_topics(a, &known);
  for (size_t i = 0; function_name(i); i++) add_topic(a, &known, function_name(i));
  for (size_t i = 0; option_row(i); i++) add_topic(a, &known, option_row(i)->name);
  return suggest(topic, known.at, known.n);
}

/* A document that has a name; the rest of `expert`: the options that pages of commands leave out. */
static int put_document(StrBuf *out, const char *topic) {
  for (size_t i = 0; i < N_DOCUMENTS; i++)
    if (i != LANGUAGE && strcmp(documents[i].topic, topic) == 0) {
      page_markdown(out, documents[i].lines, documents[i].n);
      return 1;
    }
  if (strcmp(topic, "expert") != 0) return 0;
  for (size_t i = 0; option_row(i); i++)
    if (option_expert(option_row(i))) {
      const char *of =
          arena_printf(out->arena, "%s (%s)", option_row(i)->does, commands_text(out->arena, option_row(i)->commands));
      OptionRow row = *option_row(i);
      row.does = of;
      put_option(out, &row);
    }
  return 1;
}

/* Appends help on a topic: everything of this name. Returns 0 for an unknown topic. */
static int print_topic(StrBuf *out, const char *topic) {
  Chapters chapters = {0};
  reference_chapters(out->arena, &chapters);
  int found = put_command(out, topic) || put_document(out, topic);
  for (uint32_t i = 0; i < chapters.n; i++) {
    StrBuf says = strbuf(out->arena);
    if (!chapter_print(&says, &chapters.at[i], topic)) continue;
    while (says.n > 1 && says.at[says.n - 2] == '\n') says.at[--says.n] = '\0';
    sb_printf(out, "%s%s", found ? "\n" : "", sb_text(&says));
    found = 1;
  }
  found |= put_named_options(out, topic, found);
  if (strcmp(topic, "units") == 0) put_units(out);
  else found |= put_unit(out, topic, found);
  return found;
}

/* --- the command --- */

/* A program of the runtime, built and cached like a simulator, prints the methods: `--method help` the table,
 * `--method "help NAME"` one method. */
static int help_methods(Compiler *c, const char *name) {
  static const char program[] =
    "#include \"lag.h\"\n\n"
    "int main(int argc, char **argv) {\n"
    "  static const lag_program none = {.name = \"\", .doc = \"\", .source = \"\", .effects = \"\"};\n"
    "  return lag_app_main(argc, argv, &none, %s);\n"
    "}\n";
  const char *error = NULL;
  char *argv[] = {"lagc", "--method", name ? arena_printf(c->arena, "help %s", name) : "help", NULL};
  Toolchain tools;
  if (!toolchain_find(c->arena, c->argv0, !c->o.no_gsl, &tools, &error)) return usage_error(error);
  SourceText text = {"runtime_methods.c", arena_printf(c->arena, program, tools.gsl ? "&lag_gsl" : "NULL")};
  const char *path = toolchain_simulator(c->arena, &tools, &text, 1, &error);
  if (!path) return usage_error(error);
  process_become(path, argv);
  return usage_error(arena_printf(c->arena, "cannot run %s: %s", path, strerror(errno)));
}

/* Answer to words that no page has as its name: advice, the passages found, models. */
static int search(Compiler *c, const char *topic) {
  StrBuf out = strbuf(c->arena), models = strbuf(c->arena);
  const char *advice = help_way(c->arena, topic) ? NULL : parse_advice(topic);
  if (advice) page_words(&out, advice, strlen(advice), 0, 0);
  int found = help_search(&out, topic);
  uint32_t n = models_list(c, topic, &models);
  if (n) sb_printf(&out, "%sModels: `lagc models %s`\n", out.n ? "\n" : "", topic);
  if (found || n) return compiler_write(c, NULL, &out);
  Name near = nearest(c->arena, topic);
  if (!near) near = method_suggest(c->arena, topic);
  if (near) return usage_error(arena_printf(c->arena, "no help on `%s`: did you mean `%s`?", topic, near));
  return usage_error(arena_printf(c->arena, "no help on `%s`; `lagc help` lists the topics", topic));
}

int command_help(Compiler *c) {
  StrBuf out = strbuf(c->arena);
  const char *topic = c->o.topic;
  if (topic && strcmp(topic, "methods") == 0) return help_methods(c, NULL);
  if (!topic) put_overview(&out);
  else if (!print_topic(&out, topic))
    return method_find(topic, strlen(topic)) ? help_methods(c, topic) : search(c, topic);
  return compiler_write(c, NULL, &out);
}

int command_methods(Compiler *c) { return help_methods(c, NULL); }
