/* `lagc cost --budget X`: the cheapest combination of effects, method, setting and precision whose motion differs
 * from the full model's by X at most. In: the scene's effects; out: the smallest set of them that may do
 * (effect_study.h), and for that set and for all of them the fastest setting. Holds: errors are measured against an
 * accurate run of the full model, so that they contain the effects left out, integration and rounding. */
#include "commands/budget.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/num.h"
#include "commands/effect_study.h"
#include "commands/simulator.h"
#include "toolchain/process.h"

enum { SIGNALLED = 128 }; /* exit status of a program that signal n ended: 128 + n */

/* The fastest setting of a set of effects. */
typedef struct {
  EffectSet set;
  double error, time; /* NaN error: none is accurate enough, and time is the smallest error found */
  const char *method, *knob, *value;
} Setting;

typedef struct {
  Arena *arena;
  const EffectStudy *study;
  double budget;
  const char *precision; /* NULL: double */
  const char *reference; /* "taylor, 16 digits" */
  double uncertainty, end, asked; /* asked: the end of the scene, or --until */
  int event;             /* 1: an event ends the run soon after `end` */
  VEC(Setting) all;
} Budget;

/* --- arguments --- */

typedef struct {
  const char *methods, *seconds;
  int json, quiet;
} BudgetOptions;

/* The options of the command line beside values; others mean nothing here. 0 after a message. */
static int read_options(const Compiler *c, BudgetOptions *b) {
  *b = (BudgetOptions){.seconds = c->o.seconds};
  for (uint32_t i = 0; i < c->o.rest.n; i++) {
    const char *word = c->o.rest.at[i], *eq = strchr(word, '=');
    size_t n = eq ? (size_t)(eq - word) : strlen(word);
    if (word[0] != '-') continue;
    int takes = option_takes_next(c->o.command, word);
    if (strcmp(word, "--json") == 0) b->json = 1;
    else if (strcmp(word, "--quiet") == 0) b->quiet = 1;
    else if (n == 9 && strncmp(word, "--methods", n) == 0) b->methods = eq ? eq + 1 : c->o.rest.at[i + 1];
    else if (strncmp(word, "--until", 7) != 0) {
      usage_error(arena_printf(c->arena,
                               "--budget and %.*s: leave one of them out; --budget takes name=value, --until, "
                               "--seconds, --methods and --json",
                               (int)n, word));
      return 0;
    }
    i += (uint32_t)takes;
  }
  if (!c->o.error) return 1;
  usage_error("--budget and --error: a budget is of the whole motion; leave one of them out");
  return 0;
}

/* Arguments of a program of variants: what = "runs" or "budget", and the pairs of words that follow, to NULL. */
static char *const *arguments(Compiler *c, const char *what, const char *const *more) {
  VEC(char *) argv = {0};
  vec_push(c->arena, &argv, c->picture.argv.at[0]);
  vec_push(c->arena, &argv, arena_strdup(c->arena, "--effects"));
  vec_push(c->arena, &argv, arena_strdup(c->arena, what));
  OptionTexts words = simulator_values(c);
  for (uint32_t i = 0; i < words.n; i++) vec_push(c->arena, &argv, arena_strdup(c->arena, words.at[i]));
  for (; *more; more++) vec_push(c->arena, &argv, arena_strdup(c->arena, *more));
  vec_push(c->arena, &argv, NULL);
  return argv.at;
}

/* --- measurements --- */

/* One line of the program's: see runtime/app/effect_costs.c. 0: it is none of them. */
static int read_line(Budget *b, const EffectSets *sets, char *line) {
  char *word[8] = {0};
  int n = 0;
  if (strncmp(line, "reference ", 10) == 0) {
    b->uncertainty = strtod(line + 10, &line);
    b->end = strtod(line, &line);
    b->event = (int)strtol(line, &line, 10);
    b->reference = line + 1;
    return 1;
  }
  if (strncmp(line, "setting ", 8) != 0 && strncmp(line, "none ", 5) != 0) return 0;
  for (char *at = strtok(line, " "); at && n < 8; at = strtok(NULL, " ")) word[n++] = at;
  unsigned long i = strtoul(word[1], NULL, 10);
  if (i >= sets->n) return 0;
  Setting s = {.set = sets->at[i], .error = NAN};
  if (n == 7) s = (Setting){sets->at[i], strtod(word[2], NULL), strtod(word[3], NULL), word[4], word[5], word[6]};
  else s.time = strtod(word[2], NULL);
  vec_push(b->arena, &b->all, s);
  return 1;
}

/* Measures the settings of these sets of effects in one precision. Returns a STATUS. */
static int measure(Compiler *c, EffectStudy *s, Budget *b, const EffectSets *sets, const BudgetOptions *o,
                   double seconds) {
  const char *path, *words[8] = {"--target", arena_printf(c->arena, "%.17g", b->budget), "--seconds",
                                 arena_printf(c->arena, "%.3g", seconds)};
  char *said = NULL;
  if (o->methods) words[4] = "--methods", words[5] = o->methods;
  b->all.n = 0;
  c->o.precision = b->precision;
  int status = effect_sets_build(c, s, sets, &path);
  if (status != STATUS_OK) return status;
  void (*before)(int) = signal(SIGINT, SIG_IGN); /* Ctrl-C ends the program, which prints what is known by then */
  status = process_run(c->arena, path, arguments(c, "budget", words), &said);
  signal(SIGINT, before);
  for (char *line = said, *next; line && *line; line = next) {
    char *end = strchr(line, '\n');
    next = end ? end + 1 : NULL;
    if (end) *end = '\0';
    if (strncmp(line, "span ", 5) == 0) b->asked = strtod(line + 5, NULL);
    else if (!read_line(b, sets, line) && strncmp(line, "method ", 7) != 0) fprintf(stderr, "%s\n", line);
  }
  return status;
}

/* The fastest of all settings; of those that take the same time, as well as that is known, the one with fewer
 * effects. NULL: no set has one. */
static const Setting *fastest(const Budget *b) {
  const double same = 1.05;
  const Setting *best = NULL;
  for (uint32_t i = 0; i < b->all.n; i++) { /* sets with fewer effects follow */
    const Setting *s = &b->all.at[i];
    if (!isnan(s->error) && (!best || s->time < same*best->time)) best = s;
  }
  return best;
}

/* --- report --- */

static const char *left_out(const Budget *b, const Setting *s) {
  EffectSet gone = b->study->used & ~s->set;
  return gone ? effect_names_joined(b->study, gone) : "none";
}

static void put_settings(const Budget *b, const Setting *best, StrBuf *out) {
  const EffectStudy *s = b->study;
  sb_printf(out, "  %-32s %10s %12s  %s\n", "effects left out", "error", "time [ms]", "setting");
  vec_each(const Setting, x, b->all) {
    if (isnan(x->error))
      sb_printf(out, "  %-32s %10s %12s  its smallest error is %.1e\n", left_out(b, x), "-", "-", x->time);
    else
      sb_printf(out, "%c %-32s %10.1e %12.3g  %s, --%s %s\n", x == best ? '*' : ' ', left_out(b, x), x->error,
                1e3 * x->time, x->method, x->knob, x->value);
  }
  sb_printf(out,
            "error: the largest difference from the motion with all effects (%s, itself uncertain by %.1e) at 16 "
            "times, relative to the\n"
            "largest value of its kind and unit\n",
            b->reference, b->uncertainty);
  if (s->used)
    sb_printf(out,
              s->least == s->used ? "no effect can be left out: %u other sets differ by more than %.2g, the part of "
                                    "the budget that is for effects\n"
                                  : "no smaller set is enough: %u sets were run; alone it differs by %.1e\n",
              s->tried, s->least == s->used ? s->accuracy : s->least_difference);
  if (s->scene->scene.monitors.n)
    sb_puts(out, "the scene's monitors are not part of this: they may refer to effects that are left out\n");
}

static void put_text(const Compiler *c, const Budget *b, StrBuf *out) {
  const Setting *best = fastest(b), *full = &b->all.at[0];
  const EffectStudy *s = b->study;
  int cut = !b->event && fabs(b->end - s->scene->scene.t0) < 0.999*fabs(b->asked);
  sb_printf(out, "model %s, scene %s, to t = %.15g s: a budget of %g for effects, integration and rounding\n",
            s->scene->name, s->scene->scene.name, b->end, b->budget);
  if (b->event) sb_puts(out, "an event ends the run a little later; when it does is not part of the error\n");
  if (cut)
    sb_puts(out,
            "later no digit of this budget is left of the reference, or it takes too long: the run is shortened\n");
  if (!best) {
    sb_printf(out,
              "no setting keeps it: the smallest error found is %.1e; raise --budget, allow more time (--seconds), or "
              "end the run earlier (--until)\n",
              full->time);
    return;
  }
  sb_puts(out, "cheapest: ");
  if (best->set != s->used) sb_printf(out, "without %s, ", left_out(b, best));
  sb_printf(out, "%.3g ms, error %.1e", 1e3*best->time, best->error);
  if (best->set != s->used && !isnan(full->error)) sb_printf(out, "; with all effects %.3g ms", 1e3*full->time);
  if (best->set != s->used)
    sb_printf(out, "\nin the scene, in place of its `use` lines and of what refers to the others:\n  %s\nthen",
              effect_use_statement(s, best->set));
  const char *until = cut ? arena_printf(b->arena, " --until %.9g", b->end) : "";
  sb_printf(out, "\n  lagc run %s %s%s%s --method \"%s\" --%s %s%s%s\n\n", c->o.file, s->scene->scene.name,
            c->given_words, until, best->method, best->knob, best->value, b->precision ? " --precision " : "",
            b->precision ? b->precision : "");
  put_settings(b, best, out);
}

static void put_json(const Budget *b, StrBuf *out) {
  const Setting *best = fastest(b);
  const EffectStudy *s = b->study;
  sb_printf(out,
            "{\"model\": \"%s\", \"scene\": \"%s\", \"budget\": %.17g, \"precision\": \"%s\", \"until\": %.17g, "
            "\"uncertainty\": %.9g, \"sets_run\": %u, \"settings\": [",
            s->scene->name, s->scene->scene.name, b->budget, b->precision ? b->precision : "double", b->end,
            b->uncertainty, s->tried);
  for (uint32_t i = 0; i < b->all.n; i++) {
    const Setting *x = &b->all.at[i];
    EffectList gone = effect_names(s, s->used & ~x->set);
    sb_printf(out, "%s{\"left_out\": [", i ? ", " : "");
    for (uint32_t k = 0; k < gone.n; k++) sb_printf(out, "%s\"%s\"", k ? ", " : "", gone.at[k]);
    if (isnan(x->error)) sb_printf(out, "], \"error\": null, \"smallest_error\": %.9g, \"cheapest\": false}", x->time);
    else
      sb_printf(out, "], \"error\": %.9g, \"seconds\": %.9g, \"method\": \"%s\", \"%s\": %s, \"cheapest\": %s}",
                x->error, x->time, x->method, strcmp(x->knob, "tol") == 0 ? "tolerance" : "step", x->value,
                x == best ? "true" : "false");
  }
  sb_puts(out, "]}\n");
}

/* --- the command --- */

/* The scene's effects, and the smallest set of them that keeps most of the budget. NULL with *status. */
static EffectStudy *find_sets(Compiler *c, double budget, int *status) {
  const double part = 0.7, finer = 1e-3; /* for effects; of the tolerance of runs that compare them */
  const char *words[] = {"--tol", arena_printf(c->arena, "%.3g", fmax(finer*budget, 2e-15)), "--quiet", NULL};
  Model *m = compiler_model(c, &(ModelChoice){.scene = c->o.scene, .unfixed = 1});
  *status = STATUS_MODEL;
  if (!m) return NULL;
  EffectStudy *s = m->effects.n ? effect_study_plan(m) : ARENA_NEW(c->arena, EffectStudy);
  if (!s) return NULL;
  if (!m->effects.n) *s = (EffectStudy){.arena = c->arena, .ast = c->ast, .scene = m};
  s->accuracy = part*budget;
  s->least = s->used;
  *status = STATUS_OK;
  if (effect_count(s->used) > EFFECTS_SEARCHED)
    *status = usage_error(
        arena_printf(c->arena, "--budget: the scene has %u effects; all sets of up to %d are searched: leave some out",
                     effect_count(s->used), EFFECTS_SEARCHED));
  else if (s->used) {
    char *const *argv = arguments(c, "runs", words);
    c->o.command = CMD_EFFECTS; /* derivatives for the scene's method alone */
    *status = effect_find_least(c, s, argv);
    c->o.command = CMD_COST;
  }
  return *status == STATUS_OK ? s : NULL;
}

int cost_budget(Compiler *c) {
  static const char *const precisions[] = {NULL, "long", "quad"};
  BudgetOptions o;
  EffectSets sets = {0};
  int status;
  double seconds = 10;
  time_t begin = time(NULL);
  Budget b = {.arena = c->arena};
  StrBuf out = strbuf(c->arena);
  if (!num_parse_double(c->o.budget, &b.budget) || !(b.budget > 0))
    return usage_error(arena_printf(
        c->arena, "--budget %s: an error that does not matter, relative and positive; for example 1e-6", c->o.budget));
  if (c->o.seconds && (!num_parse_double(c->o.seconds, &seconds) || !(seconds > 0)))
    return usage_error(
        arena_printf(c->arena, "--seconds %s: the time to spend, for example --seconds 60", c->o.seconds));
  if (!read_options(c, &o)) return STATUS_USAGE;
  EffectStudy *s = find_sets(c, b.budget, &status);
  if (!s) return status;
  b.study = s;
  vec_push(c->arena, &sets, s->used);
  if (s->least != s->used) vec_push(c->arena, &sets, s->least);
  for (size_t i = 0; i < sizeof precisions/sizeof *precisions && !fastest(&b) && status == STATUS_OK; i++) {
    b.precision = precisions[i];
    status = measure(c, s, &b, &sets, &o, fmax(seconds - (double)(time(NULL) - begin), seconds/3));
  }
  if (status > SIGNALLED)
    fprintf(stderr, "lagc: interrupted%s\n",
            b.all.n ? ": settings known by then follow" : " before a setting was measured");
  if (b.all.n == 0 || (status != STATUS_OK && status < SIGNALLED)) return status;
  int ended = status;
  if (o.json) put_json(&b, &out);
  else if (!o.quiet) put_text(c, &b, &out);
  status = compiler_write(c, NULL, &out);
  return status != STATUS_OK ? status : ended != STATUS_OK ? ended : fastest(&b) ? STATUS_OK : STATUS_RUN;
}
