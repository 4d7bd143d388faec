/* Command line of a simulator. Enters: argv; leaves: Args. Holds: nothing is guessed; a message quotes the wrong
 * word and says what to write instead. */
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "io/posix.h"
#include "core/core.h"

int lag_args_decimal(const char *text, double *x) {
  char *end;
  *x = strtod(text, &end);
  return end != text && *end == '\0' && strspn(text, "+-.0123456789eE") == strlen(text);
}

/* "60deg" -> '60[deg]' (of an option in s: 5s -> 5), "9,81" -> 9.81. Returns 0 when it is neither. */
static int meant_number(const char *text, int units, char *out, size_t size) {
  size_t n = strspn(text, "+-.0123456789"),
         letters = strspn(text + n, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ/*^0123456789");
  if (!n || n + letters > size - 8) return 0;
  if (text[n] == ',' && n + 1 + strspn(text + n + 1, "0123456789") == strlen(text))
    return snprintf(out, size, "%.*s.%s", (int)n, text, text + n + 1);
  if (!letters || text[n + letters] || (!units && text[n] != 's')) return 0;
  return units ? snprintf(out, size, "'%.*s[%s]'", (int)n, text, text + n)
               : snprintf(out, size, "%.*s, in s", (int)n, text);
}

int lag_args_number(const Args *a, const char *what, const char *text, const char *example, double *x) {
  int decimal = lag_args_decimal(text, x);
  if (strchr(text, '[')) {
    lag_app_error(a,
                  "%s: \"%s\" has a unit, and a simulator takes numbers in the units that --help shows, times in s; "
                  "lagc run converts",
                  what, text);
    return 0;
  }
  if (!decimal) {
    char meant[64];
    if (!meant_number(text, strncmp(what, "--", 2) != 0, meant, sizeof meant))
      snprintf(meant, sizeof meant, "for example %s", example);
    lag_app_error(a, "%s: \"%s\" is not a number; write %s", what, text, meant);
    return 0;
  }
  if (!isfinite(*x)) {
    lag_app_error(a, "%s: %s is too large for " LAG_PRECISION " precision", what, text);
    return 0;
  }
  return 1;
}

int lag_args_count(const Args *a, const char *option, const char *text, const char *example, long long *x) {
  double value;
  if (!lag_args_number(a, option, text, example, &value)) return EXIT_USAGE;
  if (value > 1e12) return lag_app_error(a, "%s %s: up to 1e12", option, text);
  if (value < 1 || value != floor(value))
    return lag_app_error(a, "%s %s: a whole number above 0, for example %s", option, text, example);
  *x = (long long)value;
  return 0;
}

int lag_args_positive(const Args *a, const char *option, const char *text, const char *example, const char *meaning,
                      double *x) {
  if (!text) return 0;
  if (!lag_args_number(a, option, text, example, x)) return EXIT_USAGE;
  return *x > 0 ? 0 : lag_app_error(a, "%s %s: %s, for example %s", option, text, meaning, example);
}

int lag_args_every(const Args *a, double *every) {
  return lag_args_positive(a, "--every", a->every, "--every 0.01", "the time between rows must be positive", every);
}

static const Option options[] = {
#define TO(f) offsetof(Args, f), 0
#define OWN_FLAG TO
#define OWN_TEXT TO
#define OWN_LIST(f) offsetof(Args, f), offsetof(Args, n##f)
#define PICTURE_FLAG(f) TO(picture.f)
#define PICTURE_TEXT(f) TO(picture.f)
#define LAGC(...)
#define BOTH(name, brief, value, takes, hint, commands, analyses, field, text) \
  {name, brief, value, takes, hint, analyses, field, text},
#define SIMULATOR(name, value, takes, analyses, field, text) {name, NULL, value, takes, "", analyses, field, text},
#include "app/options.def"
};
enum { NOPTIONS = sizeof options / sizeof *options };

const Option *lag_args_option(int i) { return i < NOPTIONS ? &options[i] : NULL; }

/* Of the options of one name, which write to other fields in other analyses: --sweep comes before those that are its
 * own. */
static const Option *find_option(const Args *a, const char *name, size_t n) {
  const Option *found = NULL;
  for (int i = 0; i < NOPTIONS; i++) {
    const Option *o = &options[i];
    if (strlen(o->name) != n || memcmp(o->name, name, n) != 0) continue;
    if (!found || (a->sweep && o->analyses & SWEEP)) found = o;
  }
  return found;
}

static int is_given(const Args *a, const Option *o) {
  const void *field = (const char *)a + o->field;
  return o->takes == TAKES_NOTHING ? *(const int *)field : *(const char *const *)field != NULL;
}

static int unknown_option(const Args *a, const char *text, size_t n) {
  char name[64];
  lag_nearest near = {.name = name};
  snprintf(name, sizeof name, "%.*s", (int)(n < 60 ? n : 60), text);
  for (int i = 0; i < NOPTIONS; i++) lag_try_nearest(&near, options[i].name);
  return near.best ? lag_app_error(a, "unknown option %s; did you mean %s?", name, near.best)
                   : lag_app_error(a, "unknown option %s; see --help", name);
}

/* Sets an option's text, and says so if another gives way. */
static void replace(const Args *a, const char *option, const char **text, const char *value) {
  if (*text && strcmp(*text, value) != 0) lag_app_error(a, "note: %s %s gives way to %s", option, *text, value);
  *text = value;
}

/* Sets a text, or puts it to the end of a list with room for all arguments. */
static int set_text(Args *a, const Option *o, int argc, const char *value) {
  const char **text = (const char **)((char *)a + o->field), ***list = (const char ***)((char *)a + o->field);
  int *n = (int *)((char *)a + o->count);
  if (text == &a->starts && a->starts)
    return lag_app_error(a, "--starts stands twice, %s and %s: one range of runs is drawn", a->starts, value);
  if (o->count && !*list && !(*list = calloc((size_t)argc, sizeof **list))) return lag_app_error(a, "out of memory");
  if (o->count) (*list)[(*n)++] = value;
  else replace(a, o->brief ? o->brief : o->name, text, value);
  return 0;
}

/* Whether the value is one of the choices, which spaces separate. */
static int is_choice(const char *choices, const char *value) {
  size_t n = strlen(value), k;
  for (; *choices; choices += k + strspn(choices + k, " ")) {
    k = strcspn(choices, " ");
    if (k == n && memcmp(choices, value, n) == 0) return 1;
  }
  return 0;
}

/* Parses the long option at argv[*i]; its value follows "=" or is the next argument. */
static int long_option(Args *a, int argc, char **argv, int *i) {
  const char *name = argv[*i], *eq = strchr(name, '=');
  size_t n = eq ? (size_t)(eq - name) : strlen(name);
  const Option *o = find_option(a, name, n);
  if (!o) return unknown_option(a, name, n);
  if (o->takes == TAKES_NOTHING) {
    if (eq) return lag_app_error(a, "%s takes no value", o->name);
    *(int *)((char *)a + o->field) = 1;
    return 0;
  }
  const char *value = eq ? eq + 1 : *i + 1 < argc ? argv[++*i] : NULL;
  if (!value || !*value) return lag_app_error(a, "%s needs a value; see --help", o->name);
  if (o->takes == TAKES_CHOICE && !is_choice(o->hint, value))
    return lag_app_error(a, "%s %s: write %s %s", o->name, value, o->name, o->value);
  return set_text(a, o, argc, value);
}

/* Says that a value gives way to a later one; a range may stand beside the value at which it begins. */
static void note_replaced(const Args *a, const char *later) {
  size_t n = strcspn(later, "=~") + 1;
  for (int k = a->nsets - 1; k >= 0; k--)
    if (strncmp(a->sets[k], later, n) == 0 && strcmp(a->sets[k], later) != 0 &&
        !strstr(a->sets[k], "..") == !strstr(later, "..")) {
      lag_app_error(a, "note: %s gives way to %s", a->sets[k], later);
      return;
    }
}

static int one_argument(Args *a, int argc, char **argv, int *i) {
  char *s = argv[*i];
  if (strcmp(s, "-h") == 0) {
    a->help = 1;
  } else if (strcmp(s, "-o") == 0) {
    if (*i + 1 >= argc) return lag_app_error(a, "-o needs a file name, or - for standard output");
    replace(a, "-o", &a->out, argv[++*i]);
  } else if (strncmp(s, "--", 2) == 0) {
    return long_option(a, argc, argv, i);
  } else if (s[0] == '-') {
    return lag_app_error(a, "unknown option %s; see --help", s);
  } else if (strpbrk(s, "=~")) {
    note_replaced(a, s);
    a->sets[a->nsets++] = s;
  } else {
    a->scenes[a->nscenes++] = s;
    a->scene = a->scenes[0];
  }
  return 0;
}

/* Refuses an output whose suffix is of another file type than the analysis writes. */
static int check_files(const Args *a, unsigned what) {
  for (int i = 0; i < NOPTIONS; i++) {
    const Option *o = &options[i];
    const char *other, *name = o->brief ? o->brief : o->name, *path;
    if (o->takes != TAKES_FILE || !*o->hint || !(o->analyses & what) || !is_given(a, o)) continue;
    path = *(const char *const *)((const char *)a + o->field);
    if ((other = lag_outfile_other_type(path, o->hint)) != NULL)
      return lag_app_error(a, "%s %s: it writes %s; write %s %.*s%.*s", name, path, lag_outfile_contents(o->hint), name,
                           (int)(other - path), path, (int)strcspn(o->hint, " "), o->hint);
  }
  return 0;
}

/* The analyses that take this option's field. */
static unsigned analyses_with(const Option *o) {
  unsigned all = 0;
  for (int i = 0; i < NOPTIONS; i++) all |= options[i].field == o->field ? options[i].analyses : 0;
  return all;
}

/* Analyses and what they take. An option of several is said to be for the first; --design stands behind --fit, which it
 * takes. */
static const struct {
  unsigned is;
  const char *option, *takes;
} analyses[] = {
    {COST, "--cost", ", which runs all methods at many tolerances and steps; --methods NAME,NAME selects some"},
    {SWEEP, "--sweep",
     ", which takes name=RANGE, name=value, --measure, --motions, --until, a method, --samples and -o"},
    {MODES, "--modes", ", which takes name=value, --steady, --amplitude and --json"},
    {LINEARIZE, "--linearize", ", which takes name=value, --equilibrium, --steady, -o and --json"},
    {FIT, "--fit",
     ", which takes name=value, --data, --sigma, --prior, --loss, --segments, a method, --svg and --json"},
    {DESIGN, "--design",
     ", which takes name=value, --fit, --sigma, --prior, --columns, --best, --until, --every, a method and --json"},
    {ORBIT, "--orbit",
     ", which takes name=value, --period, --guess, --hold, --relative, --reverse, --segments, --until, a method and "
     "--json"},
    {CONTINUE, "--continue",
     ", which takes NAME=A..B, name=value, the options of --orbit, --steady, --most, --branches, -o, --svg and --json"},
    {LYAPUNOV, "--lyapunov",
     ", which takes name=value, --until, --transient, --exponents, a method, -o, --svg and --json"},
    {EFFECTS, "--effects", ", which takes name=value, --until and a method"},
    {REFERENCE, "--reference", ", which takes name=value and --until"},
};
enum { NANALYSES = sizeof analyses / sizeof *analyses };

unsigned lag_args_analysis_named(const char *option) {
  int i = 0;
  while (i < NANALYSES && strcmp(analyses[i].option, option) != 0) i++;
  return i < NANALYSES ? analyses[i].is : 0;
}

/* Index of the first of these analyses. */
static int first_of(unsigned some) {
  int i = 0;
  while (i < NANALYSES - 1 && !(analyses[i].is & some)) i++;
  return i;
}

/* Refuses options that a run, or the analysis that is asked for, does not use. */
static int check_analysis(Args *a) {
  unsigned what = RUN;
  for (int i = 0; i < NANALYSES; i++)
    if (is_given(a, find_option(a, analyses[i].option, strlen(analyses[i].option)))) what = analyses[i].is;
  a->analysis = what;
  for (int i = 0; i < NOPTIONS; i++) {
    const Option *o = &options[i];
    unsigned with = analyses_with(o);
    if (!is_given(a, o) || with & what) continue;
    if (what == RUN || (what == REFERENCE && !(with & RUN)))
      return lag_app_error(a, "%s is for %s", o->name, analyses[first_of(with)].option);
    return lag_app_error(a, "%s has no meaning for %s%s", o->name, analyses[first_of(what)].option,
                         analyses[first_of(what)].takes);
  }
  return check_files(a, what);
}

size_t lag_app_method_length(const char *list) {
  size_t n = strcspn(list, ",(");
  if (list[n] == '(') n += strcspn(list + n, ")");
  return n + strcspn(list + n, ",");
}

const char *lag_app_next_method(const char *list) {
  list += lag_app_method_length(list);
  return *list ? list + 1 + strspn(list + 1, " ") : NULL;
}

int lag_app_overlays(const Args *a) {
  return a->nscenes > 1 || a->nvs > 0 || a->starts || (a->method && a->method[lag_app_method_length(a->method)] == ',');
}

/* The first of these options that is given, or NULL. */
static const char *first_given(const Args *a, const char *const *names) {
  for (; *names; names++) {
    const Option *o = find_option(a, *names, strlen(*names));
    if (is_given(a, o)) return o->brief ? o->brief : o->name;
  }
  return NULL;
}

/* Options for one run that a picture of several goes without. */
static const char *const of_one_run[] = {"--output", "--json", "--html", "--save-state", "--resume", "--events",
                                         "--measure", "--tangent", "--sensitivity", "--volume", "--accuracy", NULL};

/* --cloud draws one scene by several methods, and writes nothing else. */
static int check_cloud(const Args *a) {
  static const char *const others[] = {"--section", "--vs", "--starts", "--distance", "--energy-error", "--portrait",
                                       "--potential", "--sketch", NULL};
  const char *other = first_given(a, others);
  other = other ? other : first_given(a, of_one_run);
  if (other) return lag_app_error(a, "%s and --cloud: a cloud is a picture of its own; leave one of them out", other);
  if (a->nscenes > 1)
    return lag_app_error(a, "--cloud: two scenes are named, %s and %s; a cloud is around the start of one",
                         a->scenes[0], a->scenes[1]);
  return a->svg && a->plot_x && a->plot_y
             ? 0
             : lag_app_error(a,
                             "--cloud needs a picture: `lagc plot` makes it, or add --svg FILE and --plot-x, --plot-y");
}

/* Several scenes or methods, or --vs, draw one picture, and write nothing else. */
static int check_overlay(const Args *a) {
  const char *other = first_given(a, of_one_run);
  if (a->cloud) return check_cloud(a);
  if (a->fit && !a->vs && !a->starts) return 0;
  if (!lag_app_overlays(a)) return 0;
  for (int i = 0; i < a->nvs; i++)
    if (!strchr(a->vs[i], '=')) return lag_app_error(a, "--vs %s: write name=value, for example --vs th=1.2", a->vs[i]);
  if (a->starts && (a->vs || a->distance))
    return lag_app_error(a, "--starts and --%s: the range says which runs are drawn; leave one of them out",
                         a->vs ? "vs" : "distance");
  if (a->modes || a->linearize || a->cost || lag_args_tangents(a) || a->reference || a->effects || a->sweep ||
      !a->svg) {
    return a->nscenes > 1 ? lag_app_error(a,
                                          "two scenes are named: %s and %s; `lagc plot` draws several in one picture; "
                                          "to set a value write name=value",
                                          a->scenes[0], a->scenes[1])
           : a->starts
               ? lag_app_error(a, "--starts %s: several runs are for a picture, which `lagc plot` draws", a->starts)
           : a->nvs
               ? lag_app_error(a, "--vs %s: another run is for a picture, which `lagc plot` draws", a->vs[0])
               : lag_app_error(a, "--method %s: several methods are for a picture, which `lagc plot` draws; name one",
                               a->method);
  }
  return other ? lag_app_error(a, "%s is for one run; a picture of several goes without it", other) : 0;
}

/* A mistake, and a word in its message. */
typedef struct Mistake {
  int made;
  const char *text, *word;
} Mistake;

static int first_mistake(const Args *a, size_t n, const Mistake m[]) {
  for (size_t i = 0; i < n; i++)
    if (m[i].made) return lag_app_error(a, m[i].text, m[i].word);
  return 0;
}

static int is_stdout(const char *path) { return path && strcmp(path, "-") == 0; }

/* Pictures: what they need, and what excludes what. */
static int check_pictures(const Args *a) {
  int axes = a->plot_x || a->plot_y, energies = a->portrait || a->potential, over_time = a->distance || a->energy_error;
  const Mistake m[] = {
      {axes && !a->svg && !a->sketch, "--plot-x and --plot-y need a picture: add --svg FILE or --sketch", NULL},
      {a->distance && a->energy_error, "--distance and --energy-error are two pictures; leave one of them out", NULL},
      {a->distance && !lag_app_overlays(a),
       "--distance is between runs: add one with another value, for example --vs th=1.2, or another method or scene",
       NULL},
      {over_time && (!a->svg || a->section || a->plot_x || energies || a->tangent || a->sensitivity),
       "--%s is a picture over time, which `lagc plot` draws", a->distance ? "distance" : "energy-error"},
      {energies && !(a->svg && a->plot_x && a->plot_y),
       "--portrait and --potential need a picture: `lagc plot` makes it, or add --svg FILE and --plot-x, --plot-y",
       NULL},
      {a->portrait && a->potential, "--portrait and --potential are two pictures; leave one of them out", NULL},
      {a->plot_x && !a->plot_y, "--plot-x %s: the other axis is missing; add --plot-y NAME", a->plot_x},
      {(a->points || a->from || a->trace || a->no_rods) && !a->html,
       "--points, --from, --trace and --no-rods need an animation: add --html FILE", NULL},
      {a->picture.drawing && !(atoi(a->picture.drawing) >= 1 && atoi(a->picture.drawing) <= 100),
       "--drawing %s: a number of instants from 1 to 100 is needed", a->picture.drawing},
      {a->picture.drawing && (!a->svg || a->section || axes || energies),
       "--drawing is a picture of its own, which `lagc plot` draws; leave out other axes", NULL},
      {a->section && a->html, "--section and --html: a motion is shown in time; leave one of them out", NULL}};
  return first_mistake(a, sizeof m / sizeof *m, m);
}

static int check_tangents(const Args *a) {
  const char *const tangents[] = {a->tangent ? "tangent" : NULL, a->sensitivity ? "sensitivity" : NULL,
                                  a->volume ? "volume" : NULL};
  for (int i = 0; i < 3; i++) {
    if (tangents[i] && (a->save || a->resume))
      return lag_app_error(a, "--%s and --%s: a saved state holds no tangent; run it in one piece", tangents[i],
                           a->save ? "save-state" : "resume");
    for (int k = 0; k < i; k++)
      if (tangents[i] && tangents[k])
        return lag_app_error(a, "--%s and --%s: each takes the tangent of the run for itself; make two runs",
                             tangents[k], tangents[i]);
  }
  return 0;
}

/* No file of doubles for 34 digits. */
static const char *file_of_doubles(const char *path) {
  int of_doubles = path && (lag_outfile_has_suffix(path, "npy") || lag_outfile_has_suffix(path, "h5"));
  return of_doubles && strcmp(LAG_PRECISION, "double") != 0 ? path : NULL;
}

static int check(Args *a) {
  const char *doubles = file_of_doubles(a->out) ? a->out : file_of_doubles(a->motions);
  const Mistake streams[] = {
      {is_stdout(a->motions), "--motions -: motions are written to a file, for example --motions motions.csv", NULL},
      {is_stdout(a->out) && a->json, "-o - and --json both write to standard output; give -o a file name", NULL},
      {is_stdout(a->events) && a->json,
       "--events - and --json both write to standard output; give --events a file name", NULL}};
  const Mistake rows[] = {
      {a->accuracy && (a->tol || a->step || a->resume), "--accuracy chooses the tolerance or step; leave out --%s",
       a->tol    ? "tol"
       : a->step ? "step"
                 : "resume"},
      {a->section && a->every,
       "--section and --every: rows are put out at crossings, or at equal distances in time; leave one of them out",
       NULL},
      {doubles != NULL,
       "%s: .npy and .h5 files hold doubles, this run computes in " LAG_PRECISION " precision; write to a .csv file",
       doubles}};
  if (check_overlay(a) || first_mistake(a, sizeof streams / sizeof *streams, streams) || check_pictures(a) ||
      check_tangents(a) || first_mistake(a, sizeof rows / sizeof *rows, rows))
    return EXIT_USAGE;
  return check_analysis(a);
}

int lag_args_parse(Args *a, int argc, char **argv) {
  const char *slash = argc > 0 ? lag_last_slash(argv[0]) : NULL;
  *a = (Args){.self = slash ? slash + 1 : argc > 0 ? argv[0] : "simulator", .argc = argc, .argv = argv};
  a->sets = calloc((size_t)argc + 1, sizeof *a->sets);
  a->scenes = calloc((size_t)argc + 1, sizeof *a->scenes);
  if (!a->sets || !a->scenes) return lag_app_error(a, "out of memory");
  for (int i = 1; i < argc; i++) {
    if (strpbrk(argv[i], "\n\t")) { /* messages show each argument on one line */
      return lag_app_error(
          a, "word %d has a line break or a tab: leave it out; a file with one in its name needs another name", i);
    }
  }
  for (int i = 1; i < argc; i++) {
    int rc = one_argument(a, argc, argv, &i);
    if (rc) return rc;
  }
  a->plot_y = a->nplot_ys ? a->plot_ys[0] : NULL;
  return check(a);
}
