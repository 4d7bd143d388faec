/* Parses the command line by the tables of command_table.c; mistakes are answered with the nearest word or the right
 * command. */
#include "commands/command_table.h"

#include <string.h>

#include "base/words.h"
#include "commands/help_search.h"
#include "toolchain/outfile.h" /* generated: a copy of runtime/io/outfile.h */

static const char *usage(Arena *a, Command c) {
  const CommandRow *row = command_find(c);
  return arena_printf(a, "lagc %s %s", row->name, row->arguments);
}

static const char *unknown_command(Arena *a, const char *word) {
  Name names[CMD_COUNT];
  size_t n = 0;
  for (const CommandRow *row; n < CMD_COUNT && (row = command_row(n)) != NULL && row->help; n++) names[n] = row->name;
  size_t len = strlen(word);
  if (len > 4 && strcmp(word + len - 4, ".lag") == 0)
    return arena_printf(a, "a command is missing before %s: `lagc run %s`, `lagc derive %s`, `lagc check %s`", word,
                        word, word, word);
  Name near = suggest(word, names, n);
  const char *way = help_way(a, word);
  if (near) return arena_printf(a, "unknown command `%s`: did you mean `%s`?", word, near);
  if (way) return arena_printf(a, "unknown command `%s`: %s; `lagc help %s` says more", word, way, word);
  return arena_printf(a, "unknown command `%s`; `lagc help` lists them", word);
}

typedef VEC(Name) Names;

/* ---- values of options ---- */

/* Says that what stands first gives way; options that are passed on are the simulator's to tell. */
static void note_replaced(const char *first, const char *later) {
  fprintf(stderr, "lagc: note: %s gives way to %s\n", first, later);
}

static int add_define(Arena *a, Options *o, const char *text, const char **error) {
  const char *eq = strchr(text, '=');
  if (!eq || eq == text || !eq[1]) return fail_with(error, "-D takes CONST=VALUE, for example -D N=50");
  Define d = {.name = arena_strndup(a, text, (size_t)(eq - text)), .value = eq + 1};
  for (uint32_t k = 0; k < o->defines.n; k++)
    if (strcmp(o->defines.at[k].name, d.name) == 0 && strcmp(o->defines.at[k].value, d.value) != 0)
      note_replaced(arena_printf(a, "-D %s=%s", d.name, o->defines.at[k].value), d.value);
  vec_push(a, &o->defines, d);
  return 1;
}

/* "text latex c" -> "text, latex, c" */
static const char *comma_separated(Arena *a, const char *choices) {
  char *text = arena_alloc(a, 2 * strlen(choices) + 1), *to = text;
  for (const char *s = choices; *s; s++) {
    if (*s == ' ') *to++ = ',';
    *to++ = *s;
  }
  return text;
}

/* ": did you mean `cvode`?", or "". */
static const char *nearest_choice(Arena *a, const char *choices, const char *word) {
  Names names = {0};
  for (const char *choice; (choice = word_at(a, choices, names.n)) != NULL;) vec_push(a, &names, choice);
  Name near = suggest(word, names.at, names.n);
  return near ? arena_printf(a, ": did you mean `%s`?", near) : "";
}

static int check_choices(Arena *a, const OptionRow *row, const char *value, const char **error) {
  int several = row->takes == TAKES_CHOICES;
  for (const char *s = value;;) {
    size_t n = several ? strcspn(s, ",") : strlen(s);
    const char *word = arena_strndup(a, s, n);
    if (!has_word(row->hint, word))
      return fail_with(error, arena_printf(a, "%s takes %s%s, not `%s`%s", row->name, comma_separated(a, row->hint),
                                           several ? ", with commas between several" : "", word,
                                           nearest_choice(a, row->hint, word)));
    s += n;
    if (!*s++ || !*s) return 1; /* a comma may end the list */
  }
}

/* Advice: the command or option that writes files of this suffix. */
static const char *advice_for_suffix(Command c, const char *suffix) {
  if (c == CMD_PLOT && has_word("png pdf jpg jpeg gif webp eps ps", suffix))
    return ", which browsers and `rsvg-convert` turn into other kinds";
  if (c == CMD_RUN && strcmp(suffix, "json") == 0) return "; --json prints the report as JSON";
  if (has_word("svg png", suffix) && option_find(c, "--svg", &(const char *){NULL})) return "; --svg FILE draws";
  if (c != CMD_ANIMATE && has_word("html htm", suffix)) return "; `lagc animate` writes HTML";
  if (c != CMD_HEADER && has_word("h hh hpp hxx", suffix)) return "; `lagc header` writes headers";
  if (c != CMD_EMIT && strcmp(suffix, "c") == 0)
    return "; `lagc emit` writes C for the runtime, `lagc derive --format c` the accelerations";
  return "";
}

/* Reports a file name whose suffix is of another kind than the command writes. */
static int check_kind(Arena *a, Command c, const OptionRow *row, const char *path, const char *suffixes,
                      const char **error) {
  const char *other = lag_outfile_other_type(path, suffixes), *name = row->brief ? row->brief : row->name;
  if (!other) return 1;
  const char *writer = row->brief ? command_find(c)->name : row->name,
             *way = row->brief ? advice_for_suffix(c, other) : "";
  const char *kind = !*suffixes && c == CMD_BUILD ? "a program" : lag_outfile_contents(suffixes);
  int stem = (int)(other - path) - !*suffixes;
  return fail_with(error, arena_printf(a, "%s %s: %s writes %s%s; write %s %.*s%.*s", name, path, writer, kind, way,
                                       name, stem, path, (int)strcspn(suffixes, " "), suffixes));
}

/* derive and noether: takes the format from the name of the output file, or compares it with --format. */
static int check_format(Arena *a, Options *o, const char **error) {
  const OptionRow *output = option_find(o->command, "-o", &(const char *){NULL}),
                  *format = option_find(o->command, "--format", &(const char *){NULL});
  static const char *const formats[][2] = {{"latex", "tex"}, {"json", "json"}, {"c", "c"}};
  if (!o->output || !output || !format) return 1;
  const char *suffixes = "";
  for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
    if (!o->format && has_word(format->hint, formats[i][0]) && lag_outfile_has_suffix(o->output, formats[i][1]))
      o->format = formats[i][0];
    if (o->format && strcmp(o->format, formats[i][0]) == 0) suffixes = formats[i][1];
  }
  return check_kind(a, o->command, output, o->output, suffixes, error);
}

/* Stores the value in the field that the row names. */
static int set_value(Arena *a, Options *o, const OptionRow *row, const char *value, const char **error) {
  void *field = (char *)o + row->field;
  switch (row->takes) {
    case TAKES_NOTHING: *(int *)field = 1; return 1;
    case TAKES_DEFINE: return add_define(a, o, value, error);
    case TAKES_CHOICE: case TAKES_CHOICES:
      if (!check_choices(a, row, value, error)) return 0;
      break;
    case TAKES_EXPRS: vec_push(a, (OptionTexts *)field, value); return 1;
    case TAKES_TEXT: case TAKES_NUMBER: case TAKES_FILE: case TAKES_METHOD: case TAKES_PARAMS: case TAKES_EXPR: break;
  }
  const char **text = field;
  if (*text && strcmp(*text, value) != 0)
    note_replaced(arena_printf(a, "%s %s", row->brief ? row->brief : row->name, *text), value);
  *text = value;
  return 1;
}

/* ---- words ---- */

/* The option that other programs write as `arg`; NULL: unknown. */
static const char *meant_option(const char *arg) {
  static const char *const other[][2] = {
      {"--dt --timestep --stepsize --h", "--step"},
      {"--tolerance --rtol --atol --eps --accuracy", "--tol"},
      {"--time --tmax --tend --end --t1 --span --duration", "--until"},
      {"--integrator --solver", "--method"},
      {"--plot --image --figure --png --pdf --picture", "--svg"},
      {"--sampling --interval --fps", "--every"},
      {"--float --single --double --long-double --quad --float128 --digits", "--precision"}};
  for (size_t i = 0; i < sizeof other / sizeof *other; i++)
    if (has_word(other[i][0], arg)) return other[i][1];
  return NULL;
}

/* The message for a word that begins with `-` but is no option of this command. */
static const char *unknown_option(Arena *a, const Options *o, const char *word) {
  const char *value, *arg = arena_printf(a, "%.*s", (int)strcspn(word, "="), word);
  const CommandRow *row = command_find(o->command);
  if (o->command == CMD_COST && has_word("--method --tol --step", arg))
    return arena_printf(a,
                        "`lagc cost` has no option `%s`: it runs all methods at many tolerances and steps; --methods "
                        "NAME,NAME selects some",
                        arg);
  for (size_t i = 0; command_row(i); i++)
    if (option_find(command_row(i)->command, arg, &value))
      return arena_printf(a, "`%s` is an option of `lagc %s`; `lagc help %s` lists those of `lagc %s`", arg,
                          command_row(i)->name, row->name, row->name);
  Name names[64];
  size_t n = 0;
  for (size_t i = 0; option_row(i); i++)
    if (option_row(i)->commands & command_bit(o->command) && n < 64) names[n++] = option_row(i)->name;
  int letter = arg[0] == '-' && arg[1] == '-' && arg[2] && !arg[3]; /* one for another is no typing mistake */
  Name near = letter ? NULL : suggest(arg, names, n), meant = meant_option(arg);
  const char *says =
      !meant                      ? NULL
      : strcmp(arg, "--fps") == 0 ? "--every DT is the time between two frames in s: --every 0.0333 shows 30 a second"
      : o->command == CMD_HEADER && strcmp(meant, "--precision") == 0
          ? "the type of numbers is chosen where the header is included: `#define NAME_REAL float` before it"
          : NULL;
  if (says) return arena_printf(a, "`lagc %s` has no option `%s`; %s", row->name, arg, says);
  for (size_t i = 0; i < n && meant; i++)
    if (strcmp(names[i], meant) == 0)
      return arena_printf(a, "`lagc %s` has no option `%s`; here it is called `%s`", row->name, arg, meant);
  if (near) return arena_printf(a, "`lagc %s` has no option `%s`: did you mean `%s`?", row->name, arg, near);
  const char *set = command_takes_values(o->command) && strncmp(arg, "--", 2) == 0
                        ? arena_printf(a, "; a value of the model has no dashes: %s=1", arg + 2)
                        : "";
  return arena_printf(a, "`lagc %s` has no option `%s`; `lagc help %s` lists them%s", row->name, arg, row->name, set);
}

/* Words of the command line, and the place of the present one. */
typedef struct {
  char **at;
  int n, i;
} Arguments;

static int read_option(Arena *a, Arguments *words, Options *o, const OptionRow *row, const char *value,
                       const char **error) {
  const char *arg = words->at[words->i];
  if (strcmp(row->name, "--data") == 0 && options_passed(o, row->name))
    return fail_with(error, "--data stands twice; several files are one list: --data a.csv,b.csv");
  if (row->takes == TAKES_NOTHING && value) return fail_with(error, arena_printf(a, "%s takes no value", row->name));
  if (row->passed) vec_push(a, &o->rest, arg);
  if (row->takes != TAKES_NOTHING && !value) {
    const char *next = words->i + 1 < words->n ? words->at[words->i + 1] : NULL, *joined;
    if (!next || strcmp(next, "-o") == 0 || (strncmp(next, "--", 2) == 0 && option_find(o->command, next, &joined)))
      return fail_with(error, arena_printf(a, "%s needs a value: %s %s", arg, arg, row->value));
    value = words->at[++words->i];
    if (row->passed) vec_push(a, &o->rest, value);
  }
  /* --shared may come later: build.c judges */
  int library = o->command == CMD_BUILD && lag_outfile_has_suffix(value ? value : "", "so");
  if (row->takes == TAKES_FILE && (*row->hint || o->command == CMD_BUILD) && !library &&
      !check_kind(a, o->command, row, value, row->hint, error))
    return 0;
  /* passed on, and recorded: its derivatives are compiled in */
  if (strcmp(row->name, "--method") == 0) o->method = value;
  if (strcmp(row->name, "--resume") == 0) o->resume = value;
  if (strcmp(row->name, "--tol") == 0) o->tol = value;
  if (strcmp(row->name, "--to") == 0) o->to = value;
  if (strcmp(row->name, "--accuracy") == 0 && command_simulates(o->command)) o->accurate = value;
  if (strcmp(row->name, "--tangent") == 0 || strcmp(row->name, "--volume") == 0) o->with = "linear";
  return row->passed || set_value(a, o, row, value, error);
}

static void add_scene(Arena *a, Options *o, const char *name) {
  if (!o->scene) o->scene = name;
  for (uint32_t i = 0; i < o->scenes.n; i++)
    if (strcmp(o->scenes.at[i], name) == 0) return;
  vec_push(a, &o->scenes, name);
}

/* A word that is no option: the model, a scene, a value. */
static int read_word(Arena *a, const char *arg, Options *o, const char **error) {
  int sets = command_takes_values(o->command) &&
             (strchr(arg, '=') || (o->command == CMD_SWEEP && o->file && strchr(arg, '~')));
  if (!o->file && !sets) {
    o->file = arg;
    return 1;
  }
  const char *last = arg + strlen(arg) - (*arg != '\0');
  if (sets && (*last == '=' || *last == '~'))
    return fail_with(
        error, arena_printf(a, "%s: a value is missing; name and value are one word without spaces, as in k=1", arg));
  if (command_simulates(o->command) || sets) {
    if (!sets) add_scene(a, o, arg);
    vec_push(a, &o->rest, arg);
    return 1;
  }
  if (o->scene && o->command != CMD_PAGE)
    return fail_with(error, arena_printf(a, "one word too many: `%s`; usage: %s", arg, usage(a, o->command)));
  add_scene(a, o, arg);
  return 1;
}

static int read_arguments(Arena *a, int argc, char **argv, Options *o, const char **error) {
  for (Arguments words = {argv, argc, 2}; words.i < argc; words.i++) {
    const char *arg = argv[words.i], *value;
    int ok, dash = arg[0] == '-' && arg[1];
    const OptionRow *row = dash ? option_find(o->command, arg, &value) : NULL;
    if (row) ok = read_option(a, &words, o, row, value, error);
    else if (!dash) ok = read_word(a, arg, o, error);
    else {
      *error = unknown_option(a, o, arg);
      ok = 0;
    }
    if (!ok) return 0;
    if (o->help) {
      o->command = CMD_HELP;
      o->topic = argv[1];
      return 1;
    }
  }
  if (o->to && o->file && !o->scene)
    return fail_with(error, arena_printf(a, "--to %s: name the scene to begin with, too: lagc orbit %s SCENE --to %s",
                                         o->to, o->file, o->to));
  if (o->to) add_scene(a, o, o->to);
  if (!o->file && o->command != CMD_PLAYGROUND)
    *error =
        arena_printf(a, "a %s is missing; usage: %s", o->command == CMD_NEW ? "name" : "model", usage(a, o->command));
  return (o->file || o->command == CMD_PLAYGROUND) && check_format(a, o, error);
}

/* Commands that read no model take at most one word. */
static int read_one_word(Arena *a, int argc, char **argv, Options *o, const char **error) {
  const char *arg = argc > 2 ? argv[2] : NULL;
  if (o->command == CMD_HELP && arg) /* several words are a search */
    for (int i = 3; i < argc; i++) arg = arena_printf(a, "%s %s", arg, argv[i]);
  else if (argc > 3)
    return fail_with(error, arena_printf(a, "one word too many: `%s`; usage: %s", argv[3], usage(a, o->command)));
  o->topic = arg;
  if (arg && (strcmp(arg, "--help") == 0 || strcmp(arg, "-h") == 0)) {
    o->topic = o->command == CMD_HELP ? NULL : command_find(o->command)->name;
    o->command = CMD_HELP;
    return 1;
  }
  int takes_none = o->command == CMD_METHODS || (o->command == CMD_MANPAGE && arg && strcmp(arg, "markdown") != 0);
  if (arg && takes_none)
    return fail_with(error, arena_printf(a, "one word too many: `%s`; usage: %s", arg, usage(a, o->command)));
  if (o->command == CMD_CACHE && arg) {
    const char *value;
    const OptionRow *row = option_find(o->command, arg, &value);
    if (row) return read_option(a, &(Arguments){argv, argc, 2}, o, row, value, error);
    return fail_with(error, unknown_option(a, o, arg));
  }
  if (o->command == CMD_COMPLETION && (!arg || !has_word("bash zsh fish", arg)))
    return fail_with(error,
                     "which shell? write `lagc completion bash`, `lagc completion zsh` or `lagc completion fish`");
  return 1;
}

const char *options_passed(const Options *o, const char *name) {
  size_t n = strlen(name);
  for (uint32_t i = 0; i < o->rest.n; i++) {
    const char *word = o->rest.at[i];
    if (strncmp(word, name, n) == 0 && word[n] == '=') return word + n + 1;
    if (strcmp(word, name) == 0 && i + 1 < o->rest.n) return o->rest.at[i + 1];
  }
  return NULL;
}

int options_pass_flag(const Options *o, const char *name) {
  for (uint32_t i = 0; i < o->rest.n; i++)
    if (strcmp(o->rest.at[i], name) == 0) return 1;
  return 0;
}

int options_more_digits(const Options *o) { return o->precision && strcmp(o->precision, "double") != 0; }

int options_read(Arena *a, int argc, char **argv, Options *o, const char **error) {
  *o = (Options){.command = argc < 2 ? CMD_HELP : command_named(argv[1])};
  *error = NULL;
  for (int i = 1; i < argc && o->command != CMD_COMPLETE; i++)
    if (strpbrk(argv[i], "\n\t")) { /* messages show a word on one line */
      return fail_with(
          error,
          arena_printf(
              a, "word %d has a line break or a tab: leave it out; a file with one in its name needs another name", i));
    }
  if (!o->command) return fail_with(error, unknown_command(a, argv[1]));
  if (o->command == CMD_COMPLETE) {
    for (int i = 2; i < argc; i++) vec_push(a, &o->rest, argv[i]);
    return 1;
  }
  if (o->command == CMD_MODES || o->command == CMD_ORBIT || o->command == CMD_CONTINUE || o->command == CMD_LYAPUNOV)
    o->with = "linear";
  int named = command_reads_model(o->command) || o->command == CMD_NEW || o->command == CMD_PLAYGROUND;
  if (named) return read_arguments(a, argc, argv, o, error);
  return read_one_word(a, argc, argv, o, error);
}
