/* Runs cases with known values: hard CASES.json EXPECTED RUNS TIER [CASE | METHOD ...]: the runs of that tier, only
 * those of the cases and methods named. A line of EXPECTED, those of one scene in the order of time:
 *   CASE SCENE TIME OUTPUT VALUE TOLERANCE
 * TIME: a number; `end`, of the run, when an event ends it; EVENT#K, when EVENT happens for the K-th time, and
 * OUTPUT is `time`. OUTPUT: of the scene, or, over the run until then, `residual`: the largest error of a constraint
 * in positions or velocities; `energy`: the largest |E - E0|; `growth`, of symplectic methods alone: that in the
 * last tenth of the span over that in the first; `drift`, of the others: as `energy`. TOLERANCE: absolute; quad:X is
 * one for runs of 34 digits alone. A line of RUNS:
 *   TIER CASE METHOD [OPTION=VALUE ...]
 * CASE `*`: all cases without a line of their own for METHOD, but for those whose line begins with `only`. Options
 * are the method's, and
 *   tol=X; steps=N or A..B: fixed steps a span, doubled from A until all is within its tolerance, at most B; most=N:
 *   more steps
 *   fail; limit=X: known not to reach the tolerance; fails where the error is more than X times what is allowed;
 *   inf: known not to come to the end.
 * TIER `quad`: what is allowed is a unit in the last digit of VALUE, or 1e-18 of TOLERANCE where that is more, as
 * numbers of 34 digits are to those of 16. Models have no inputs and no contacts. A method that refuses a model says
 * why; that is no failure. For other precisions it goes through runtime/precision.awk. Prints a line a run, as TAP;
 * with TABLE in the environment, as a table. */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "lag.h"

extern const lag_scene *const all_scenes[];

enum { NAME = 64, FACTS = 4000, RUNS = 2000, OUTPUTS = 128, EVENTS = 8, HAPPENINGS = 64 };

typedef struct {
  char id[NAME], scene[NAME], time[NAME], output[NAME];
  double value, allowed; /* allowed < 0: not by this precision */
} Fact;

typedef struct {
  char tier[NAME], id[NAME], method[NAME], rest[200];
} Run;

/* What is asked of a run, and what came of it. */
typedef struct {
  lag_option opt[8];
  int nopt;
  double tol, limit;
  long long most, steps_least, steps_most;
  double worst, residual, energy, first_energy; /* worst: error over what is allowed; NaN: the run failed */
  lag_stats stats;
  const char *wrong; /* the fact that is worst */
  char message[400];
  int refused;
} Trial;

/* Starts and parameters with more digits than lagc keeps of a number in a model. */
static const struct {
  const char *id, *scene, *name;
  double value;
} starts[] = {
  {"arenstorf1", "go", "y'", -2.00158510637908252240537862224},
  {"cr3bp-L1-departure", "go", "x", 0.8369161257723573513650754},
  {"lagrange-top-steady", "slow", "f'", 0.367826846322586348126209587409},
  {"lagrange-top-steady", "slow", "s'", 5.71867051031667766935783785543},
  {"lagrange-top-steady", "fast", "f'", 3.55455093287819526149780891851},
  {"lagrange-top-steady", "fast", "s'", 3.28132948968332233064216214457},
  {"three-body-figure-eight", "go", "v1", 0.347116888118926938242776920320},
  {"three-body-figure-eight", "go", "v2", 0.532724945388030229262027987692},
};

static Fact facts[FACTS];
static Run runs[RUNS];
static int nfacts, nruns;
static int count; /* of runs judged */

/* ---- what is read -------------------------------------------------------------------------------- */

/* One unit in the last digit of a decimal. */
static double last_digit(const char *text) {
  double unit = 1;
  const char *e = strpbrk(text, "eE"), *point = strchr(text, '.');
  for (const char *c = point ? point + 1 : text; point && *c && c != e; c++) unit /= 10;
  for (int k = e ? atoi(e + 1) : 0; k != 0; k += k < 0 ? 1 : -1) unit = k < 0 ? unit / 10 : unit * 10;
  return unit;
}

static double allowed_of(const char *value, const char *tolerance, int digits) {
  const char *only = strchr(tolerance, ':');
  if (only) return digits ? strtod(only + 1, NULL) : -1;
  double tol = strtod(tolerance, NULL);
  return digits && strtod(value, NULL) != 0 ? fmax(last_digit(value), 1e-18 * tol) : tol;
}

static int read_facts(const char *path, int digits) {
  char value[NAME], tolerance[NAME];
  FILE *f = fopen(path, "r");
  Fact *x = facts;
  while (f && nfacts < FACTS &&
         fscanf(f, "%63s %63s %63s %63s %63s %63s", x->id, x->scene, x->time, x->output, value, tolerance) == 6) {
    x->value = strtod(value, NULL);
    x->allowed = allowed_of(value, tolerance, digits);
    x = facts + ++nfacts;
  }
  if (f) fclose(f);
  return nfacts > 0 && nfacts < FACTS;
}

static int read_runs(const char *path) {
  char line[400];
  FILE *f = fopen(path, "r");
  while (f && nruns < RUNS && fgets(line, sizeof line, f)) {
    Run *r = &runs[nruns];
    int end = 0;
    if (line[0] == '#' || sscanf(line, "%63s %63s %63s %n", r->tier, r->id, r->method, &end) != 3) continue;
    snprintf(r->rest, sizeof r->rest, "%.*s", (int)strcspn(line + end, "#\n"), line + end);
    nruns++;
  }
  if (f) fclose(f);
  return nruns > 0 && nruns < RUNS;
}

/* What is difficult about a case, from CASES.json, of which each member has a line of its own. */
static void difficulty(const char *path, const char *id, char *text, size_t n) {
  char line[4000], found[NAME] = "";
  FILE *f = fopen(path, "r");
  text[0] = 0;
  while (f && !text[0] && fgets(line, sizeof line, f)) {
    sscanf(line, "   \"id\": \"%63[^\"]", found);
    char *at = strcmp(found, id) == 0 ? strstr(line, "   \"difficulty\": \"") : NULL;
    if (at) snprintf(text, n, "%.*s", (int)strcspn(at + 18, "\""), at + 18);
  }
  if (f) fclose(f);
}

/* ---- which scene, which method --------------------------------------------------------------------- */

/* Whether a model is called like a case: its name has `_` where the case's has - or . */
static int is_called(const char *model, const char *id) {
  for (; *model && *id; model++, id++)
    if (tolower((unsigned char)*model) != (*id == '-' || *id == '.' ? '_' : tolower((unsigned char)*id))) return 0;
  return *model == *id;
}

static int has_what_it_needs(const lag_model *m, const lag_method *method) {
  int splits = (method->flags & LAG_METHOD_SPLITS) && (m->flags & LAG_SEPARABLE);
  return (!(method->flags & LAG_METHOD_TAYLOR) || m->taylor) && (!(method->flags & LAG_METHOD_JACOBIAN) || m->linear) &&
         (!(method->flags & LAG_METHOD_VARIATION) || splits || m->variation);
}

/* The scene, in the program that has most of what the method needs. */
static const lag_scene *find_scene(const char *id, const char *scene, const lag_method *method) {
  const lag_scene *found = NULL;
  for (int i = 0; all_scenes[i]; i++)
    if (is_called(all_scenes[i]->model->name, id) && strcmp(all_scenes[i]->name, scene) == 0 &&
        (!found || has_what_it_needs(all_scenes[i]->model, method)))
      found = all_scenes[i];
  return found;
}

static const lag_method *find_method(const char *name) {
  for (int i = 0; i < lag_nmethods; i++)
    if (strcmp(lag_methods[i]->name, name) == 0) return lag_methods[i];
#ifdef WITH_GSL
  for (int i = 0; i < lag_gsl_nmethods; i++)
    if (strcmp(lag_gsl_methods[i]->name, name) == 0) return lag_gsl_methods[i];
#endif
  return NULL;
}

/* The value of a method's option, a number or one of its choices. */
static double option_value(const lag_method *m, const char *name, const char *text) {
  for (int i = 0; i < m->noptions; i++)
    for (int k = 0; strcmp(m->options[i].name, name) == 0 && m->options[i].choices && m->options[i].choices[k]; k++)
      if (strcmp(m->options[i].choices[k], text) == 0) return k;
  return strtod(text, NULL);
}

static void read_options(char *rest, const lag_method *m, Trial *x) {
  for (char *word = strtok(rest, " "); word; word = strtok(NULL, " ")) {
    char *value = strchr(word, '='), *upper;
    if (!value) continue;
    *value++ = 0;
    if (strcmp(word, "tol") == 0) x->tol = strtod(value, NULL);
    else if (strcmp(word, "limit") == 0) x->limit = strtod(value, NULL);
    else if (strcmp(word, "most") == 0) x->most = atoll(value);
    else if (strcmp(word, "steps") == 0) {
      x->steps_least = atoll(value);
      x->steps_most = (upper = strstr(value, "..")) ? atoll(upper + 2) : x->steps_least;
    } else if (x->nopt < 7) {
      x->opt[x->nopt++] = (lag_option){word, option_value(m, word, value), NULL};
    }
  }
}

/* ---- a run ------------------------------------------------------------------------------------------- */

typedef struct {
  Trial *trial;
  long long steps;
  double energy0, span, early, late; /* early, late: the largest |E - E0| in the first and the last tenth of the span */
  double *work; /* [nw], c and r of constraints */
  int rung[EVENTS]; /* how often each event happened */
  double times[EVENTS][HAPPENINGS];
} Watch;

/* Processor time since it was asked last. */
static double seconds(void) {
  static clock_t before, now;
  before = now;
  now = clock();
  return (double)(now - before) / CLOCKS_PER_SEC;
}

static double energy_of(const lag_sim *sim, double *work) {
  const lag_model *m = lag_sim_scene(sim)->model;
  double e[2] = {NAN, NAN};
  if (m->energy)
    m->energy(m, lag_sim_time(sim), lag_sim_q(sim), lag_sim_v(sim), lag_sim_z(sim), lag_sim_p(sim), NULL, e, work);
  return e[0];
}

static double residual_of(const lag_sim *sim, double *work) {
  const lag_model *m = lag_sim_scene(sim)->model;
  const lag_constraints *k = m->constraints;
  double most = 0, *c = work + m->nw, *r = c + (k ? k->nholonomic : 0);
  if (!k) return 0;
  if (k->residuals(k, lag_sim_time(sim), lag_sim_q(sim), lag_sim_v(sim), lag_sim_z(sim), lag_sim_p(sim), NULL, c, r,
                   work))
    return NAN;
  for (int i = 0; i < k->nholonomic; i++) most = fmax(most, fabs(c[i]));
  for (int i = 0; i < k->n; i++) most = fmax(most, fabs(r[i]));
  return most;
}

/* After each step. */
static int watch(void *context, const lag_sim *sim) {
  Watch *w = context;
  Trial *x = w->trial;
  x->residual = fmax(x->residual, residual_of(sim, w->work));
  double off = fabs(energy_of(sim, w->work) - w->energy0), tenths = 10 * lag_sim_time(sim) / w->span;
  x->energy = fmax(x->energy, off);
  if (tenths <= 1) w->early = fmax(w->early, off);
  if (tenths >= 9) w->late = fmax(w->late, off);
  return ++w->steps >= x->most;
}

/* The time of happening k = 1, 2, ... of an event: events happen at ends of steps, and are kept as they come. */
static void ring(void *context, int k, double t, const double *before, const double *after) {
  Watch *w = context;
  (void)before, (void)after;
  if (k < EVENTS && w->rung[k] < HAPPENINGS) w->times[k][w->rung[k]++] = t;
}

static double time_of_event(const lag_model *m, const char *text, const Watch *w) {
  const char *sign = strchr(text, '#');
  int n = atoi(sign + 1);
  for (int k = 0; k < m->nev && k < EVENTS; k++)
    if (strncmp(m->ev[k].name, text, (size_t)(sign - text)) == 0 && n >= 1 && n <= w->rung[k])
      return w->times[k][n - 1];
  return NAN;
}

static double output_of(lag_sim *sim, const char *name) {
  double out[OUTPUTS];
  int n = lag_sim_noutputs(sim);
  for (int i = 0; i < n && n <= OUTPUTS; i++)
    if (strcmp(lag_sim_scene(sim)->outputs[i].name, name) == 0) return lag_sim_outputs(sim, out) ? (double)NAN : out[i];
  return NAN;
}

/* Goes on to the time of a fact. The value of its output there; NaN: the run failed, or there is no such output. */
static double value_at(lag_sim *sim, const Fact *f, const Watch *w) {
  int timed = isdigit((unsigned char)f->time[0]), event = strchr(f->time, '#') != NULL;
  int rc = lag_sim_advance(sim, timed ? strtod(f->time, NULL) : lag_sim_scene(sim)->t1);
  if (rc < 0 || rc == LAG_INTERRUPTED || (!timed && !event && rc != LAG_STOPPED)) return NAN;
  if (event) return time_of_event(lag_sim_scene(sim)->model, f->time, w);
  if (strcmp(f->output, "residual") == 0) return w->trial->residual;
  if (strcmp(f->output, "energy") == 0 || strcmp(f->output, "drift") == 0) return w->trial->energy;
  if (strcmp(f->output, "growth") == 0) return w->late / w->early;
  return output_of(sim, f->output);
}

/* The simulation as the run wants it; NULL, and x->refused or x->message: it cannot. */
static lag_sim *prepare(const lag_scene *s, const char *id, const lag_method *method, Trial *x, long long steps) {
  lag_sim *sim = lag_sim_new(s);
  if (!sim) return NULL;
  if (steps) x->opt[x->nopt] = (lag_option){"step", fabs(s->t1 - s->t0) / (double)steps, NULL};
  int bad = x->tol > 0 ? lag_sim_set_tolerance(sim, x->tol) : 0;
  if (!bad) bad = lag_sim_set_method(sim, method, x->opt, x->nopt + (steps != 0));
  x->refused = bad == LAG_EMETHOD || (bad && strstr(lag_sim_message(sim), "with constraints it is 2"));
  for (size_t i = 0; i < sizeof starts / sizeof *starts; i++)
    if (!bad && strcmp(starts[i].id, id) == 0 && strcmp(starts[i].scene, s->name) == 0)
      bad = lag_sim_set(sim, starts[i].name, starts[i].value);
  if (!bad) return sim;
  snprintf(x->message, sizeof x->message, "%s", lag_sim_message(sim));
  lag_sim_free(sim);
  return NULL;
}

/* Whether a fact is one of this run. */
static int concerns(const Fact *f, const char *id, const char *scene, const lag_method *method) {
  const char *not_mine = method->flags & LAG_METHOD_SYMPLECTIC ? "drift" : "growth";
  return f->allowed >= 0 && strcmp(f->id, id) == 0 && strcmp(f->scene, scene) == 0 && strcmp(f->output, not_mine) != 0;
}

/* One run of a scene: x->worst. */
static void run_once(const lag_scene *s, const char *id, const lag_method *method, Trial *x, long long steps) {
  static Watch w;
  const lag_constraints *k = s->model->constraints;
  lag_sim *sim = prepare(s, id, method, x, steps);
  x->worst = sim ? 0 : (double)NAN;
  if (!sim) return;
  w = (Watch){.trial = x,
              .work = calloc((size_t)s->model->nw + 8 + (k ? (size_t)(k->n + k->nholonomic) : 0), sizeof(double))};
  w.energy0 = energy_of(sim, w.work);
  w.span = s->t1;
  x->residual = x->energy = 0;
  lag_sim_on_step(sim, watch, &w);
  lag_sim_on_event(sim, ring, &w);
  for (int i = 0; i < nfacts && !isnan(x->worst); i++) {
    const Fact *f = &facts[i];
    if (!concerns(f, id, s->name, method)) continue;
    double error = fabs(value_at(sim, f, &w) - f->value) / f->allowed;
    if (isnan(error) || error >= x->worst) x->wrong = f->output, x->worst = error;
  }
  lag_sim_stats(sim, &x->stats);
  snprintf(x->message, sizeof x->message, "%s", w.steps >= x->most ? "more steps than allowed" : lag_sim_message(sim));
  free(w.work);
  lag_sim_free(sim);
}

/* Whether the scenes of a case have facts, each once. */
static int next_scene(const char *id, int *i, const char **scene) {
  for (; *i < nfacts; (*i)++) {
    int seen = 0;
    for (int k = 0; k < *i && !seen; k++)
      seen = strcmp(facts[k].id, id) == 0 && strcmp(facts[k].scene, facts[*i].scene) == 0;
    if (strcmp(facts[*i].id, id) == 0 && !seen) return *scene = facts[(*i)++].scene, 1;
  }
  return 0;
}

/* Whether a run is as it should be: within what is allowed, or not worse than the limit that is known of it. */
static int is_fine(const Trial *x) {
  return x->refused || isinf(x->limit) || x->worst <= (x->limit > 0 ? x->limit : 1);
}

static void report(const Run *r, const char *id, const char *scene, const Trial *x, const char *cases) {
  char why[200], name[2 * NAME];
  int fine = is_fine(x);
  snprintf(name, sizeof name, "%s%s%s", id, strcmp(scene, "go") == 0 ? "" : ", ",
           strcmp(scene, "go") == 0 ? "" : scene);
  if (getenv("TABLE")) {
    difficulty(cases, id, why, sizeof why);
    printf("%-41s %-34.34s %-12s %8.2g %8.2g %8.2g %9lld %8.2g  %s\n", name, why, r->method, x->worst, x->residual,
           x->stats.energy_drift, x->stats.steps, seconds(),
           x->refused                     ? "refuses"
           : x->limit > 0 && x->worst > 1 ? "limit"
           : fine                         ? "pass"
                                          : "FAIL");
  } else if (x->refused) {
    printf("ok %d - %s by %s: refused: %s\n", ++count, name, r->method, x->message);
  } else {
    printf("%sok %d - %s by %s: error over what is allowed %.2g (%s), residual %.2g, energy drift %.2g, %lld steps, "
           "%lld rejected, %.2g s%s\n",
           fine ? "" : "not ", ++count, name, r->method, x->worst, x->wrong ? x->wrong : "", x->residual,
           x->stats.energy_drift, x->stats.steps, x->stats.rejected, seconds(), x->limit > 0 ? ": a known limit" : "");
    if (!fine) printf("# %s\n", x->message);
  }
  fflush(stdout);
}

/* The scenes of a case by the method of a line. Returns whether all is as it should be. */
static int run_case(const Run *r, const char *id, const char *cases) {
  const lag_method *method = find_method(r->method);
  const char *scene;
  int fine = 1;
  for (int i = 0; next_scene(id, &i, &scene);) {
    Trial x = {.most = 1000000};
    char rest[sizeof r->rest];
    const lag_scene *s = method ? find_scene(id, scene, method) : NULL;
    memcpy(rest, r->rest, sizeof rest);
    x.worst = NAN;
    seconds();
    if (s) read_options(rest, method, &x);
    else snprintf(x.message, sizeof x.message, "no such scene or method");
    for (long long steps = x.steps_least; s; steps *= 2) {
      run_once(s, id, method, &x, steps);
      if (x.worst <= 1 || x.refused || steps == 0 || 2 * steps > x.steps_most) break;
    }
    fine &= is_fine(&x);
    report(r, id, scene, &x, cases);
  }
  return fine;
}

/* Whether some line is for this case and method, or keeps other methods from the case. */
static int has_own(const char *id, const char *method) {
  for (int i = 0; i < nruns; i++)
    if (strcmp(runs[i].id, id) == 0 && (strcmp(runs[i].tier, "only") == 0 || strcmp(runs[i].method, method) == 0))
      return 1;
  return 0;
}

static int is_asked(int n, char **words, const char *id, const char *method) {
  int of_case = 1, of_method = 1;
  for (int i = 0; i < n; i++) *(find_method(words[i]) ? &of_method : &of_case) = 0;
  for (int i = 0; i < n; i++) {
    if (strcmp(words[i], id) == 0) of_case = 1;
    if (strcmp(words[i], method) == 0) of_method = 1;
  }
  return of_case && of_method;
}

/* `only` lines are of the tier quick. */
static int is_of(const char *tier, const char *of_line) {
  return strcmp(tier, of_line) == 0 || (strcmp(tier, "quick") == 0 && strcmp(of_line, "only") == 0);
}

int main(int argc, char **argv) {
  int bad = 0;
  if (argc < 5 || !read_facts(argv[2], strcmp(argv[4], "quad") == 0) || !read_runs(argv[3])) return 2;
  for (int k = 0; k < nruns; k++) {
    const char *id;
    if (!is_of(argv[4], runs[k].tier)) continue;
    for (int i = 0; i < nfacts; i++) {
      int first = i == 0 || strcmp(facts[i].id, facts[i - 1].id) != 0;
      id = facts[i].id;
      int its = strcmp(runs[k].id, "*") == 0 ? !has_own(id, runs[k].method) : strcmp(runs[k].id, id) == 0;
      if (first && its && is_asked(argc - 5, argv + 5, id, runs[k].method)) bad |= !run_case(&runs[k], id, argv[1]);
    }
  }
  if (!getenv("TABLE")) printf("1..%d\n", count);
  return bad;
}
