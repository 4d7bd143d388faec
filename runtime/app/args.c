/* Command line of a simulator. Enters: argv; leaves: Args. Holds: nothing is guessed; a message quotes the wrong word and
 * says what to write instead. */
#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "io/visible.h"
#include "core/core.h"

int lag_app_error(const Args *a, const char *format, ...) {
  char text[4096];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  fput_visible(stderr, a->self, "");
  fputs(": ", stderr);
  fput_visible(stderr, text, "\n\t");
  putc('\n', stderr);
  return EXIT_USAGE;
}

int lag_args_decimal(const char *text, double *x) {
  char *end;
  *x = strtod(text, &end);
  return end != text && *end == '\0' && strspn(text, "+-.0123456789eE") == strlen(text);
}

int lag_args_number(const Args *a, const char *what, const char *text, const char *example, double *x) {
  int decimal = lag_args_decimal(text, x);
  if (strchr(text, '[')) {
    lag_app_error(a, "%s: \"%s\" has a unit, and a simulator takes numbers in the units that --help shows, times in s; lagc run converts", what, text);
    return 0;
  }
  if (!decimal) {
    lag_app_error(a, "%s: \"%s\" is not a number; write for example %s", what, text, example);
    return 0;
  }
  if (!isfinite(*x)) {
    lag_app_error(a, "%s: %s is too large for " LAG_PRECISION " precision", what, text);
    return 0;
  }
  return 1;
}

typedef struct Option {
  const char *name;
  size_t offset;
  int is_flag;
  int takes; /* runs and analyses that use the option */
} Option;

enum { MODES = 1, COST = 2, LYAPUNOV = 4, EFFECTS = 8, REFERENCE = 16, RUN = 32, ANY = 63 };

static const Option options[] = {
    {"method", offsetof(Args, method), 0, RUN | LYAPUNOV | EFFECTS},
    {"tol", offsetof(Args, tol), 0, RUN | LYAPUNOV | EFFECTS}, {"accuracy", offsetof(Args, accuracy), 0, RUN},
    {"step", offsetof(Args, step), 0, RUN | LYAPUNOV | EFFECTS}, {"until", offsetof(Args, until), 0, ANY & ~MODES},
    {"every", offsetof(Args, every), 0, RUN}, {"svg", offsetof(Args, svg), 0, RUN | LYAPUNOV},
    {"plot-x", offsetof(Args, plot_x), 0, ANY}, {"plot-y", offsetof(Args, plot_y), 0, ANY},
    {"html", offsetof(Args, html), 0, RUN}, {"points", offsetof(Args, points), 0, ANY},
    {"from", offsetof(Args, from), 0, ANY}, {"no-rods", offsetof(Args, no_rods), 1, ANY},
    {"trace", offsetof(Args, trace), 1, ANY}, {"save-state", offsetof(Args, save), 0, RUN},
    {"resume", offsetof(Args, resume), 0, RUN}, {"events", offsetof(Args, events), 0, RUN},
    {"section", offsetof(Args, section), 0, RUN}, {"output", offsetof(Args, out), 0, RUN | LYAPUNOV | COST},
    {"json", offsetof(Args, json), 1, ANY}, {"sketch", offsetof(Args, sketch), 1, RUN | COST},
    {"quiet", offsetof(Args, quiet), 1, ANY},
    {"tangent", offsetof(Args, tangent), 1, RUN}, {"modes", offsetof(Args, modes), 1, ANY},
    {"lyapunov", offsetof(Args, lyapunov), 1, ANY}, {"transient", offsetof(Args, transient), 0, LYAPUNOV},
    {"exponents", offsetof(Args, exponents), 0, LYAPUNOV}, {"effects", offsetof(Args, effects), 0, ANY},
    {"help", offsetof(Args, help), 1, ANY}, {"cost", offsetof(Args, cost), 1, ANY},
    {"reference", offsetof(Args, reference), 1, ANY}, {"target", offsetof(Args, target), 0, COST},
    {"seconds", offsetof(Args, seconds), 0, COST | REFERENCE}, {"realtime", offsetof(Args, realtime), 0, COST}, {"methods", offsetof(Args, methods), 0, COST},
    {"against", offsetof(Args, against), 0, COST}, {"given", offsetof(Args, given), 0, COST}, {"error", offsetof(Args, error), 0, COST | REFERENCE}, {"all", offsetof(Args, all), 1, COST}, {"runs", offsetof(Args, runs), 1, COST},
};
enum { NOPTIONS = sizeof options / sizeof *options };

static const Option *find_option(const char *name, size_t n) {
  for (int i = 0; i < NOPTIONS; i++)
    if (strlen(options[i].name) == n && memcmp(options[i].name, name, n) == 0) return &options[i];
  return NULL;
}

static int unknown_option(const Args *a, const char *text, size_t n) {
  char name[64];
  lag_nearest near = {.name = name};
  snprintf(name, sizeof name, "%.*s", (int)(n < 60 ? n : 60), text);
  for (int i = 0; i < NOPTIONS; i++) lag_try_nearest(&near, options[i].name);
  return near.best ? lag_app_error(a, "unknown option --%s; did you mean --%s?", name, near.best)
                   : lag_app_error(a, "unknown option --%s; see --help", name);
}

/* Parses the long option at argv[*i]; its value follows "=" or is the next argument. */
static int long_option(Args *a, int argc, char **argv, int *i) {
  const char *name = argv[*i] + 2, *eq = strchr(name, '=');
  size_t n = eq ? (size_t)(eq - name) : strlen(name);
  const Option *o = find_option(name, n);
  if (!o) return unknown_option(a, name, n);
  void *field = (char *)a + o->offset;
  if (o->is_flag) {
    if (eq) return lag_app_error(a, "--%s takes no value", o->name);
    *(int *)field = 1;
    return 0;
  }
  const char *value = eq ? eq + 1 : *i + 1 < argc ? argv[++*i] : NULL;
  if (!value || !*value) return lag_app_error(a, "--%s needs a value; see --help", o->name);
  *(const char **)field = value;
  return 0;
}

static int one_argument(Args *a, int argc, char **argv, int *i) {
  char *s = argv[*i];
  if (strcmp(s, "-h") == 0) {
    a->help = 1;
  } else if (strcmp(s, "-o") == 0) {
    if (*i + 1 >= argc) return lag_app_error(a, "-o needs a file name, or - for standard output");
    a->out = argv[++*i];
  } else if (strncmp(s, "--", 2) == 0) {
    return long_option(a, argc, argv, i);
  } else if (s[0] == '-') {
    return lag_app_error(a, "unknown option %s; see --help", s);
  } else if (strchr(s, '=')) {
    a->sets[a->nsets++] = s;
  } else if (a->scene) {
    return lag_app_error(a, "two scenes are named: %s and %s; to set a value write name=value", a->scene, s);
  } else {
    a->scene = s;
  }
  return 0;
}

/* Refuses options that a run, or the analysis that is asked for, does not use. */
static int check_analysis(const Args *a) {
  const int what = a->modes ? MODES : a->cost ? COST : a->reference ? REFERENCE : a->lyapunov ? LYAPUNOV : a->effects ? EFFECTS : RUN;
  for (int i = 0; i < NOPTIONS; i++) {
    const Option *o = &options[i];
    const void *field = (const char *)a + o->offset;
    int given = o->is_flag ? *(const int *)field : *(const char *const *)field != NULL;
    if (!given || o->takes & what) continue;
    if (what == RUN || what == REFERENCE) {
      return o->takes & RUN ? lag_app_error(a, "--%s has no meaning for --reference, which takes name=value and --until", o->name)
                            : lag_app_error(a, "--%s is for %s", o->name, o->takes & COST ? "--cost" : "--lyapunov");
    }
    return lag_app_error(a, "--%s has no meaning for %s", o->name,
                     what == COST ? "--cost, which runs all methods at many tolerances and steps; --methods NAME,NAME selects some"
                     : what == MODES ? "--modes, which takes name=value and --json"
                     : what == EFFECTS ? "--effects, which takes name=value, --until and a method"
                                     : "--lyapunov, which takes name=value, --until, --transient, --exponents, a method, -o, --svg and --json");
  }
  return 0;
}

/* Refuses an output whose suffix is of another file type than is written. */
static int check_kinds(const Args *a) {
  const struct {
    const char *option, *path, *suffixes, *writes;
  } files[] = {{"-o", a->out, a->cost ? "svg csv json" : "csv npy", a->cost ? "a picture, .svg, or all runs, .csv or .json" : "CSV, or NumPy where the name ends in .npy"},
               {"--events", a->events, "csv", "CSV"}, {"--svg", a->svg, "svg", "SVG"}, {"--html", a->html, "html htm", "HTML"}};

  for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
    const char *path = files[i].path, *other = path ? lag_outfile_other_type(path, files[i].suffixes) : NULL;
    if (other) {
      return lag_app_error(a, "%s %s: it writes %s; write %s %.*s%.*s", files[i].option, path, files[i].writes, files[i].option, (int)(other - path), path,
                       (int)strcspn(files[i].suffixes, " "), files[i].suffixes);
    }
  }
  return 0;
}

static int check(const Args *a) {
  int on_stdout = a->out && strcmp(a->out, "-") == 0;
  if (on_stdout && a->json) return lag_app_error(a, "-o - and --json both write to standard output; give -o a file name");
  if (a->events && strcmp(a->events, "-") == 0 && a->json)
    return lag_app_error(a, "--events - and --json both write to standard output; give --events a file name");
  if ((a->plot_x || a->plot_y) && !a->svg && !a->sketch) return lag_app_error(a, "--plot-x and --plot-y need a picture: add --svg FILE or --sketch");
  if (a->plot_x && !a->plot_y) return lag_app_error(a, "--plot-x %s: the other axis is missing; add --plot-y NAME", a->plot_x);
  if ((a->points || a->from || a->trace || a->no_rods) && !a->html)
    return lag_app_error(a, "--points, --from, --trace and --no-rods need an animation: add --html FILE");
  if (a->html && !a->points) return lag_app_error(a, "--html %s: points are missing; add --points 'X,Y X,Y ...' with the names of outputs", a->html);
  if (a->section && a->html) return lag_app_error(a, "--section and --html: a motion is shown in time; leave one of them out");
  if (a->tangent && (a->save || a->resume))
    return lag_app_error(a, "--tangent and --%s: a saved state holds no tangent; run it in one piece", a->save ? "save-state" : "resume");
  if (a->accuracy && (a->tol || a->step || a->resume))
    return lag_app_error(a, "--accuracy chooses the tolerance or step; leave out --%s", a->tol ? "tol" : a->step ? "step" : "resume");
  if (a->section && a->every)
    return lag_app_error(a, "--section and --every: rows are put out at crossings, or at equal distances in time; leave one of them out");
  if (strcmp(LAG_PRECISION, "double") != 0 && a->out && lag_outfile_has_suffix(a->out, "npy")) /* NumPy has no type of 34 digits */
    return lag_app_error(a, "%s: .npy files hold doubles, this run computes in " LAG_PRECISION " precision; write to a .csv file", a->out);
  return check_kinds(a) || check_analysis(a) ? EXIT_USAGE : 0;
}

int lag_args_parse(Args *a, int argc, char **argv) {
  const char *slash = argc > 0 ? strrchr(argv[0], '/') : NULL;
  *a = (Args){.self = slash ? slash + 1 : argc > 0 ? argv[0] : "simulator"};
  a->sets = calloc((size_t)argc + 1, sizeof *a->sets);
  if (!a->sets) return lag_app_error(a, "out of memory");
  for (int i = 1; i < argc; i++) {
    if (strpbrk(argv[i], "\n\t")) { /* messages show each argument on one line */
      return lag_app_error(a, "word %d has a line break or a tab: leave it out; a file with one in its name needs another name", i);
    }
  }
  for (int i = 1; i < argc; i++) {
    int rc = one_argument(a, argc, argv, &i);
    if (rc) return rc;
  }
  return check(a);
}
