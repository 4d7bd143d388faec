/* --sweep: many runs. Enters: ranges and measures of the command line; leaves: rows, by way of a journal of finished
 * chunks (sweep/journal.h), and statistics. Holds: run i has the same numbers on any number of threads, in any
 * shard, after any interruption. */
#include "app/sweep.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/measure.h"
#include "core/core.h"
#include "io/posix.h"
#include "numeric/clock.h"
#include "numeric/fnv1a.h"

/* ---- The plan */

/* Takes the ranges away from the values that all runs share. */
static int take_ranges(SweepApp *s) {
  Args *a = &s->app->args;
  char why[400];
  int kept = 0;
  for (int i = 0; i < a->nsets; i++) {
    if (!lag_plan_is_range(a->sets[i])) a->sets[kept++] = a->sets[i];
    else if (lag_plan_add(&s->plan, a->sets[i], why, sizeof why)) return lag_app_error(a, "%s", why);
  }
  a->nsets = kept;
  for (int k = 0; k < s->plan.n; k++)
    s->plan.factor[k].compiled = lag_app_has_word(a->consts, s->plan.factor[k].name, strlen(s->plan.factor[k].name));
  return a->rows && lag_plan_add_rows(&s->plan, a->rows, why, sizeof why) ? lag_app_error(a, "%s", why) : 0;
}

/* The points of a quasi-random sequence, by the library that has it. */
static int take_points(SweepApp *s) {
  const Args *a = &s->app->args;
  const char *name = a->sampling;
  int (*points)(const char *name, int dimensions, long long n, double *u) = s->app->extras.points; /* (as it stands) */
  if (!points)
    return lag_app_error(
        a, "--sampling %s needs GSL: the build found none, or --no-gsl or --precision left it out; lhs needs none",
        name);
  s->points = malloc((size_t)s->plan.samples * (size_t)s->plan.dimensions * sizeof *s->points);
  s->plan.points = s->points;
  if (!s->points)
    return lag_app_error(a, "--sampling %s: %lld points of %d numbers take %.3g GB; lhs and random take none", name,
                         s->plan.samples, s->plan.dimensions, 8e-9 * (double)s->plan.samples * s->plan.dimensions);
  int most = points(name, s->plan.dimensions, s->plan.samples, s->points);
  return most ? lag_app_error(a, "--sampling %s has up to %d dimensions, here are %d; lhs has any number", name, most,
                              s->plan.dimensions)
              : 0;
}

/* Refuses what would have no effect. */
static int check_options(const Args *a) {
  if (!a->samples && (a->sampling || a->seed))
    return lag_app_error(a, "--%s is for samples: write for example --samples 1000", a->sampling ? "sampling" : "seed");
  if (a->merge && (a->shard || a->go_on))
    return lag_app_error(a, "--merge and --%s: parts are made first, and then joined; leave one out",
                         a->shard ? "shard" : "resume");
  return 0;
}

static int make_plan(SweepApp *s) {
  const Args *a = &s->app->args;
  long long samples = 0, seed = 1;
  char why[400];
  if (check_options(a) || take_ranges(s)) return EXIT_USAGE;
  if (a->samples && lag_args_count(a, "--samples", a->samples, "--samples 1000", &samples)) return EXIT_USAGE;
  if (a->seed && lag_args_count(a, "--seed", a->seed, "--seed 2", &seed)) return EXIT_USAGE;
  s->plan.seed = (uint64_t)seed;
  s->plan.zip |= a->zip;
  if (a->sampling && strcmp(a->sampling, "lhs") == 0) s->plan.sampling = SAMPLING_HYPERCUBE;
  else if (a->sampling && (strcmp(a->sampling, "sobol") == 0 || strcmp(a->sampling, "halton") == 0))
    s->plan.sampling = SAMPLING_POINTS;
  if (lag_plan_finish(&s->plan, samples, why, sizeof why)) return lag_app_error(a, "%s", why);
  return s->plan.sampling == SAMPLING_POINTS && s->plan.dimensions ? take_points(s) : 0;
}

/* ---- Variants: constants vary, and the program has a scene for each combination of their values */

/* s[n] := "with N=4: ", or "" where no constant varies. Returns s. */
static const char *variant_words(const SweepApp *s, int v, char *text, size_t size) {
  double *value = s->sweep.nvariants > 1 ? malloc((size_t)s->plan.n * sizeof *value) : NULL;
  size_t n = 0;
  text[0] = '\0';
  if (value) lag_plan_values(&s->plan, lag_plan_run_of(&s->plan, v), value);
  for (int k = 0; k < s->plan.n && value && n < size; k++)
    if (s->plan.factor[k].compiled)
      n += (size_t)snprintf(text + n, size - n, "%s%s=%g", n ? ", " : "with ", s->plan.factor[k].name, value[k]);
  if (value && n < size) snprintf(text + n, size - n, ": ");
  free(value);
  return text;
}

/* Whether the program has a scene for each combination: --consts is lagc's to write, beside the program that it
 * builds. */
static int has_variants(const SweepApp *s) {
  for (int k = 0; k < s->plan.n; k++)
    if (s->plan.factor[k].compiled && !s->plan.factor[k].n) return 0;
  /* the last run is of the last one */
  return lag_plan_variant(&s->plan, s->plan.runs - 1) + 1 == s->app->program->nscenes;
}

static int open_variants(SweepApp *s) {
  App *app = s->app;
  const lag_scene *first = app->scene;
  if (app->args.consts && !has_variants(s))
    return lag_app_error(&app->args, "%s: this program was built for other values; lagc sweep builds one",
                         app->args.consts);
  s->sweep.nvariants = app->args.consts ? app->program->nscenes : 1;
  s->sweep.variant = s->variants = calloc((size_t)s->sweep.nvariants, sizeof *s->variants);
  int rc = s->variants ? 0 : lag_app_error(&app->args, "out of memory");
  for (int v = 0; v < s->sweep.nvariants && rc == 0; v++) {
    if (v) app->scene = app->program->scenes[v];
    s->variants[v].like = v ? lag_app_fresh_sim(app) : app->sim;
    if (!s->variants[v].like) rc = EXIT_USAGE;
  }
  app->scene = first;
  return rc;
}

/* All variants run by the method of the first. */
static int share_method(SweepApp *s) {
  char with[200];
  for (int v = 1; v < s->sweep.nvariants; v++) {
    lag_sim *sim = s->variants[v].like;
    if (lag_app_copy_method(s->app->sim, sim, 1))
      return lag_app_error(&s->app->args, "%s%s", variant_words(s, v, with, sizeof with), lag_sim_message(sim));
  }
  return 0;
}

static void free_variants(SweepApp *s) {
  for (int v = 0; s->variants && v < s->sweep.nvariants; v++) {
    if (v) lag_sim_free(s->variants[v].like);
    free(s->variants[v].measure);
  }
  free(s->variants);
}

/* ---- Measures and columns */

/* Without --measure: the state at the end. */
static int default_measures(SweepApp *s) {
  Args *a = &s->app->args;
  const lag_sim *sim = s->app->sim;
  enum { ROOM = sizeof((Column *)0)->name };
  s->names = malloc((size_t)sim->pb.n * ROOM);
  a->measures = calloc((size_t)sim->pb.n + 1, sizeof *a->measures);
  if (!s->names || !a->measures) return lag_app_error(a, "out of memory");
  for (; a->nmeasures < sim->pb.n; a->nmeasures++) {
    char *name = s->names + (size_t)a->nmeasures * ROOM;
    snprintf(name, ROOM, "%s", lag_state_column(sim, a->nmeasures).name);
    a->measures[a->nmeasures] = name;
  }
  return 0;
}

/* The words of a measure in variant v; the only ones where all variants have the same. */
static const char *words_of(const char *words, int v) {
  const char *s = words, *end;
  for (; v && (end = strchr(s, ';')); v--) s = end + 1;
  return strchr(words, ';') ? s : words;
}

/* The measures in variant v, whose words may differ, x[N]. */
static int vary_measures(SweepApp *s, int v) {
  App *app = s->app;
  const lag_scene *first = app->scene, *scene = lag_sim_scene(s->variants[v].like);
  int n = s->sweep.nmeasures;
  char why[400], with[200];
  const char **text = s->variants[v].measure = calloc((size_t)n, sizeof *text);
  if (!text) return lag_app_error(&app->args, "out of memory");
  for (int k = 0; k < n; k++) {
    text[k] = words_of(app->measure_texts[k], v);
    for (int i = 0; i < first->nmeasures && i < scene->nmeasures; i++)
      if (text[k] == first->measures[i].text) text[k] = scene->measures[i].text;
  }
  Measures *m = lag_measures_new(scene, n, text, NULL, why, sizeof why);
  lag_measures_free(m);
  return m ? 0 : lag_app_error(&app->args, "%s--measure %s", variant_words(s, v, with, sizeof with), why);
}

static int choose_measures(SweepApp *s) {
  App *app = s->app;
  if ((!app->args.nmeasures && !app->scene->nmeasures && default_measures(s)) || lag_app_measures_open(app))
    return EXIT_USAGE;
  s->sweep.nmeasures = lag_measures_count(app->measures);
  for (int v = 0; v < s->sweep.nvariants; v++)
    if (vary_measures(s, v)) return EXIT_USAGE;
  return 0;
}

/* Unit of a name that varies: the declared one; that of its members, for a family. */
static void unit_of(const lag_sim *sim, const char *name, char *unit, size_t size) {
  const lag_model *m = sim->scene->model;
  const lag_var *var;
  char member[128];
  int index, kind = lag_find_name(m, name, &index, &var);
  if (kind == LAG_IS_NOTHING && lag_family_member(m, name, 0, member, sizeof member))
    kind = lag_find_name(m, member, &index, &var);
  if (kind == LAG_IS_NOTHING) snprintf(unit, size, "%s", "");
  else snprintf(unit, size, "%s%s", var->unit, kind == LAG_IS_V && var->unit[0] ? "/s" : "");
}

typedef struct Called {
  uint64_t hash; /* of a column's name, or of that with its unit */
  int column;
} Called;

static int by_hash(const void *a, const void *b) {
  const Called *x = a, *y = b;
  return x->hash != y->hash ? (x->hash > y->hash) - (x->hash < y->hash) : x->column - y->column;
}

/* Whether two columns may have one name; there may be as many as coordinates. */
static int may_be_alike(const Table *t) {
  size_t n = 2 * (size_t)t->ncols;
  Called *all = malloc((n + 1) * sizeof *all);
  char label[sizeof *t->cols + 4];
  int alike = !all;
  for (size_t i = 0; all && i < n; i++) {
    const Column *c = &t->cols[i / 2];
    const char *text = i % 2 ? lag_column_label(c, label, sizeof label) : c->name;
    all[i] = (Called){lag_hash_text(LAG_FNV1A_START, text), (int)(i / 2)};
  }
  if (all) qsort(all, n, sizeof *all, by_hash);
  for (size_t i = 1; all && i < n; i++) alike |= all[i].hash == all[i - 1].hash && all[i].column != all[i - 1].column;
  free(all);
  return alike;
}

/* Two columns of one name could not be told apart, and NumPy refuses the file; a measure called as a name that
 * varies is its value at the end. */
static int check_columns(SweepApp *s) {
  Column *c = s->table.cols;
  char label[2][sizeof *c + 4];
  for (int k = 0; k < s->plan.n; k++)
    for (int i = s->plan.n; i < s->table.ncols - 1; i++)
      if (strcmp(c[i].name, c[k].name) == 0 && strcmp(s->variants[0].measure[i - s->plan.n], c[k].name) == 0)
        snprintf(c[i].name, sizeof c[i].name, "%.80s(end)", s->plan.factor[k].name);
  if (!may_be_alike(&s->table)) return 0;
  for (int i = 0; i < s->table.ncols; i++)
    for (int k = 0; k < i; k++) {
      lag_column_label(&c[i], label[0], sizeof label[0]);
      lag_column_label(&c[k], label[1], sizeof label[1]);
      if (strcmp(c[i].name, c[k].name) != 0 && strcmp(label[0], label[1]) != 0 && strcmp(c[i].name, label[1]) != 0 &&
          strcmp(label[0], c[k].name) != 0)
        continue;
      return lag_app_error(&s->app->args,
                           "two columns would be called %s; give the measure another name, --measure NAME=EXPR",
                           label[1]);
    }
  return 0;
}

static int name_columns(SweepApp *s) {
  static const char *const words[] = {"ok",      "stopped", "singular", "nan",    "domain", "step",  "value", "memory",
                                      "monitor", "model",   "zeno",     "method", "io",     "drift", "stall"};
  int n = s->plan.n + s->sweep.nmeasures + 1;
  s->table = (Table){.ncols = n, .cols = calloc((size_t)n, sizeof *s->table.cols)};
  if (!s->table.cols) return lag_app_error(&s->app->args, "out of memory");
  Column *c = s->table.cols;
  for (int k = 0; k < s->plan.n; k++, c++) {
    snprintf(c->name, sizeof c->name, "%s", s->plan.factor[k].name);
    unit_of(s->app->sim, c->name, c->unit, sizeof c->unit);
  }
  for (int k = 0; k < s->sweep.nmeasures; k++, c++) {
    snprintf(c->name, sizeof c->name, "%s", s->app->measure_names[k]);
    snprintf(c->unit, sizeof c->unit, "%s", lag_measures_unit(s->app->measures, k));
  }
  snprintf(c->name, sizeof c->name, "status");
  c->words = words;
  return check_columns(s);
}

/* ---- Runs */

/* Whether setting `name` sets `other`, too: the same name, or that of its family or vector. */
static int covers(const lag_model *m, const char *name, const char *other) {
  char member[128];
  if (strcmp(name, other) == 0) return 1;
  for (int k = 0; lag_family_member(m, name, k, member, sizeof member); k++)
    if (strcmp(member, other) == 0) return 1;
  return 0;
}

/* Refuses a name whose values would be replaced by those of name k that varies. */
static int check_covered(const SweepApp *s, int k) {
  const Args *a = &s->app->args;
  const lag_model *m = s->app->scene->model;
  const Factor *f = &s->plan.factor[k];
  char name[sizeof f->name];
  for (int i = 0; i < k; i++)
    if (covers(m, f->name, s->plan.factor[i].name))
      return lag_app_error(a, "%s varies, and all of %s after it: write %s first, or leave one out",
                           s->plan.factor[i].name, f->name, f->name);
  for (int i = 0; i < a->nsets; i++) {
    size_t n = strcspn(a->sets[i], "=");
    while (n && a->sets[i][n - 1] == ' ') n--;
    snprintf(name, sizeof name, "%.*s", (int)n, a->sets[i]);
    if (covers(m, f->name, name)) return lag_app_error(a, "%s: %s varies; leave one out", a->sets[i], f->name);
  }
  return 0;
}

/* Rows are read as they stand: their unit is the declared one. */
static int check_unit(const SweepApp *s, const Factor *f) {
  char unit[sizeof((Column *)0)->unit];
  unit_of(s->app->sim, f->name, unit, sizeof unit);
  return !f->unit[0] || strcmp(f->unit, unit) == 0
             ? 0
             : lag_app_error(&s->app->args, "%s: %s is in [%s] there, and in [%s] in the model: convert its numbers",
                             s->app->args.rows, f->name, f->unit, unit);
}

/* Sets what factor k is in the first run whose value the model takes: runs with others have rows that say so. Status
 * of lag_sim_set. */
static int set_factor(const SweepApp *s, lag_sim *sim, int k, double *value) {
  enum { MANY = 1000 };
  int bad = LAG_EINVAL;
  for (long long run = 0; run < s->plan.runs && run < MANY && bad == LAG_EINVAL; run++) {
    lag_plan_values(&s->plan, run, value);
    bad = lag_sim_set(sim, s->plan.factor[k].name, value[k]);
  }
  return bad;
}

/* The values of a first run, so that wrong names and the method that is chosen show before anything runs. */
static int set_first_values(SweepApp *s) {
  double *value = malloc((size_t)s->plan.n * sizeof *value);
  const char *rows = s->app->args.rows;
  char with[200];
  int rc = value ? 0 : lag_app_error(&s->app->args, "out of memory");
  for (int k = 0; k < s->plan.n && rc == 0; k++) {
    if (s->plan.factor[k].compiled) continue;
    for (int v = 0; v < s->sweep.nvariants && rc == 0; v++) {
      lag_sim *sim = s->variants[v].like;
      int bad = set_factor(s, sim, k, value);
      rc = bad ? lag_app_error(&s->app->args, "%s%s%s%s", rows ? rows : "", rows ? ": " : "",
                               variant_words(s, v, with, sizeof with),
                               bad == LAG_ENOMEM ? "out of memory" : lag_sim_message(sim))
               : 0;
    }
    rc = rc || check_unit(s, &s->plan.factor[k]) || check_covered(s, k) ? EXIT_USAGE : 0;
  }
  free(value);
  return rc;
}

/* Progress on a terminal, and signals. */
static int note(void *context, long long runs) {
  SweepApp *s = context;
  App *app = s->app;
  s->made = runs;
  double now = lag_clock_seconds() - app->begun;
  if (app->progress >= 0 && lag_clock_seconds() - app->shown >= (app->progress ? 0.2 : 1.0)) {
    double all = (double)s->plan.runs, done = fmin((double)s->journal.finished * (double)s->sweep.chunk, all),
           rate = (double)runs / now;
    fprintf(stderr, "\r%.0f of %.0f runs, %.0f %%, %.3g a second, %.0f s left   ", done, all, 100 * done / all, rate,
            (all / (double)s->sweep.shards - done) / rate);
    app->shown = lag_clock_seconds();
    app->progress = 1;
  }
  return lag_app_interrupted() != EXIT_SIGNAL;
}

static int stop(void *context) {
  (void)context;
  return lag_app_interrupted() != EXIT_SIGNAL;
}

/* One run of each variant, timed, where that is a small part of all: refuses what would take longer than a day of
 * this machine, or more than 10 GB, without --yes, and tells what takes longer than a minute. */
static int estimate(SweepApp *s) {
  const Args *a = &s->app->args;
  /* runs of a thread; bytes: 8 in the journal, 18 of a CSV */
  const double day = 86400, few = 16, per_number = 26, most = 1e10;
  int variants = s->sweep.nvariants;
  double threads = (double)s->sweep.threads * s->sweep.nranks, share = (double)s->plan.runs / (double)s->sweep.shards;
  double bytes = share * (double)lag_sweep_numbers(&s->sweep) * per_number;
  if ((double)s->plan.runs < few * threads * variants) return 0;
  double *row = malloc((size_t)lag_sweep_columns(&s->sweep) * sizeof *row);
  char why[600], text[64];
  const char *unit;
  double begin = lag_clock_seconds();
  int rc = row ? 0 : LAG_ENOMEM;
  for (int v = 0; v < variants && rc == 0; v++)
    rc = lag_sweep_run_one(&s->sweep, lag_plan_run_of(&s->plan, v), 0, row, why, sizeof why);
  free(row);
  if (rc == LAG_ENOMEM) return lag_app_error(a, "out of memory");
  if (rc == LAG_INTERRUPTED) return lag_app_error(a, "interrupted in the first run"), lag_app_interrupted();
  double all = (lag_clock_seconds() - begin) / variants * share / threads, long_unit = lag_long_time_unit(all, &unit);
  double number = long_unit > 0 ? all / long_unit : all < 120 ? all : all / 60;
  snprintf(text, sizeof text, number < 10 ? "%.1f %s" : "%.0f %s", number,
           long_unit > 0 ? unit
           : all < 120   ? "s"
                         : "min");
  if (!a->yes && (all > day || bytes > most))
    return lag_app_error(
        a,
        "%lld runs would take about %s and %.3g GB on this machine: take fewer values, --shard i/n on many, or --yes",
        s->plan.runs, text, 1e-9 * bytes);
  if (all > 60 && !a->quiet) fprintf(stderr, "%s: %lld runs, about %s\n", a->self, s->plan.runs, text);
  return 0;
}

/* ---- The command */

/* Lanes for the runs of all variants, or why there are none. */
static int choose_lanes(SweepApp *s) {
  const App *app = s->app;
  const lag_program *program = app->program;
  long long wanted = 0;
  int i = 0;
  if (app->args.lanes && lag_args_count(&app->args, "--lanes", app->args.lanes, "--lanes 4", &wanted))
    return EXIT_USAGE;
  if (wanted && wanted != 1 && wanted != 4 && wanted != 8)
    return lag_app_error(&app->args, "--lanes %lld: 1, 4 or 8 runs at once", wanted);
  while (program->scenes[i] != app->scene) i++;
  for (int v = 0; v < s->sweep.nvariants && !s->no_lanes; v++, i++)
    s->no_lanes = lag_lanes_choose(s->variants[v].like, program->lanes_4 ? program->lanes_4[i] : NULL,
                                   program->lanes_8 ? program->lanes_8[i] : NULL, (int)wanted, &s->variants[v].lanes);
  for (int v = 0; v < s->sweep.nvariants && s->no_lanes; v++) s->variants[v].lanes = (LaneChoice){.lanes = 1};
  return s->no_lanes && wanted > 1
             ? lag_app_error(&app->args, "--lanes %lld: there are none, %s; leave it out", wanted, s->no_lanes)
             : 0;
}

static int choose_threads(const Args *a, Sweep *s) {
  long long n = s->ranks ? 1 : lag_processors();
  const long long most = 1024;
  if (a->threads && lag_args_count(a, "--threads", a->threads, "--threads 2", &n)) return EXIT_USAGE;
  if (a->threads && n > most)
    return lag_app_error(a, "--threads %lld: up to %lld; this machine has %lld processors", n, most,
                         (long long)lag_processors());
  s->threads = n < 1 ? 1 : n > most ? (int)most : (int)n;
  return 0;
}

/* Runs of a chunk: some thousand chunks in all, so that none is long; up to 8 runs, some hundred thousand, so that
 * ten thousand ranks have work; with motions of up to 8 MB. */
static long long chunk_size(const SweepApp *s) {
  const long long few = 8192, many = 131072, lanes = 8, numbers = 1000000 / (long long)lag_sweep_numbers(&s->sweep) + 1,
                  most = s->sweep.nrows && numbers < 1024 ? numbers : 1024;
  long long runs = s->plan.runs, n = runs / many > lanes      ? runs / many
                                     : runs / few + 1 > lanes ? lanes
                                                              : runs / few + 1;
  return n > most ? most : n;
}

/* Refuses what needs a journal that outlives the process. */
static int check_stream(const Args *a) {
  const char *option = a->go_on ? "--resume" : a->shard ? "--shard" : a->merge ? "--merge" : NULL;
  return option && lag_sweep_is_stream(lag_sweep_result_file(a))
             ? lag_app_error(a, "%s: %s is no file, and runs are kept beside a file only; write -o FILE", option,
                             lag_sweep_result_file(a))
             : 0;
}

static int set_up(SweepApp *s) {
  App *app = s->app;
  int rc = make_plan(s);
  rc = rc ? rc : lag_app_set_up_start(app);
  rc = rc ? rc : open_variants(s);
  rc = rc ? rc : set_first_values(s);
  rc = rc ? rc : lag_app_choose_method(app);
  rc = rc ? rc : share_method(s);
  rc = rc ? rc : choose_lanes(s);
  rc = rc ? rc : lag_app_choose_skip(app);
  rc = rc ? rc : choose_threads(&app->args, &s->sweep);
  rc = rc ? rc : lag_sweep_read_shard(s);
  rc = rc ? rc : choose_measures(s);
  rc = rc ? rc : name_columns(s);
  rc = rc ? rc : lag_sweep_motions_open(s);
  if (rc) return rc;
  if (app->until == app->scene->t0) return lag_app_no_span(app);
  if (!lag_sweep_result_file(&app->args))
    return lag_app_error(&app->args,
                         "the rows need a file: write -o FILE.csv or -o FILE.npy, or --svg FILE for a picture");
  if (lag_sweep_picture_check(s)) return EXIT_USAGE;
  if (s->plan.n > LAG_GRID_MOST - 1)
    return lag_app_error(&app->args, "%d names vary; up to %d may", s->plan.n, LAG_GRID_MOST - 1);
  s->sweep.plan = &s->plan;
  s->sweep.until = app->until;
  s->sweep.skip = app->skip;
  s->sweep.chunk = chunk_size(s);
  s->sweep.journal = &s->journal;
  s->sweep.note = note;
  s->sweep.stop = stop;
  s->sweep.context = s;
  if (s->sweep.rank) return 0; /* rank 0 has the files */
  if (lag_app_check_outputs(app) || check_stream(&app->args)) return EXIT_USAGE;
  return (!lag_sweep_is_stream(lag_sweep_result_file(&app->args)) && lag_app_try_file(app, app->args.out)) ||
                 lag_app_try_file(app, app->args.svg) || lag_app_try_file(app, app->args.motions)
             ? EXIT_USAGE
             : 0;
}

static int make_runs(SweepApp *s) {
  App *app = s->app;
  lag_app_catch_interrupt();
  int rc = estimate(s);
  rc = rc ? rc : lag_sweep_open_journal(s, app->args.go_on);
  rc = rc ? rc : lag_sweep_agree(s);
  if (rc) return rc;
  lag_app_start_clock(app);
  int status = lag_sweep_run(&s->sweep);
  lag_app_stop_clock(app);
  s->seconds = app->wall;
  if (s->sweep.silent && status == LAG_OK)
    lag_app_error(&app->args, "warning: %d of %d processes do not answer; others made their runs", s->sweep.silent,
                  s->sweep.nranks);
  if (status == LAG_OK) return 0;
  if (status == LAG_EIO) lag_app_io_error(app, s->journal.path);
  char kept[sizeof s->journal.path + 60] = "";
  if (!lag_sweep_is_stream(lag_sweep_result_file(&app->args)))
    snprintf(kept, sizeof kept, "; %s keeps the runs made so far, --resume goes on", s->journal.path);
  lag_app_error(&app->args, "%s%s",
                status == LAG_EIO      ? "the sweep is not complete"
                : status == LAG_ENOMEM ? "out of memory"
                                       : "interrupted",
                kept);
  return status == LAG_INTERRUPTED ? lag_app_interrupted() : EXIT_USAGE;
}

int lag_app_sweep(App *app) {
  SweepApp s = {.app = app, .journal.fd = -1, .sweep.nranks = 1};
  int rc = lag_sweep_check_mpi(&s);
  rc = rc ? rc : lag_sweep_join(&s);
  rc = rc ? rc : set_up(&s);
  rc = rc                ? rc
       : app->args.mpi   ? lag_sweep_start(&s)
       : s.sweep.rank    ? lag_sweep_serve(&s)
       : app->args.merge ? lag_sweep_merge(&s)
                         : make_runs(&s);
  if (rc == 0 && s.sweep.rank == 0) rc = s.sweep.shards > 1 ? lag_sweep_report_part(&s) : lag_sweep_report(&s);
  lag_journal_close(&s.journal, rc == 0 && s.sweep.shards == 1);
  lag_table_free(&s.table);
  lag_table_free(&s.motions);
  lag_table_free(&s.branches);
  free(s.times);
  lag_plan_free(&s.plan);
  free_variants(&s);
  free(s.names);
  free(s.points);
  lag_sweep_leave(&s, rc);
  return rc;
}
