/* The report of --cost. Enters: methods with their runs; leaves: the fastest settings, a table of times, the front,
 * notes; or all runs as JSON or CSV. */
#include <math.h>
#include <string.h>

#include "app/cost.h"

enum { COLUMNS = 7 }; /* errors 1e-2, 1e-4, .. 1e-14 */

const char *lag_cost_knob(const lag_method *m) { return m->flags & LAG_METHOD_ADAPTIVE ? "tol" : "step"; }

/* ---- Families */

/* By the begin of their methods' names; the last takes all others. Of methods that are named each is its own. */
static int family_of(const Cost *c, const CostMethod *m) {
  static const struct {
    const char *begin;
    int family;
  } names[] = {{"taylor", 0},      {"rk", 1},    {"dop", 1},   {"verlet", 2}, {"symplectic", 2},
               {"variational", 3}, {"gauss", 4}, {"radau", 5}, {"gsl-", 6}};
  if (c->named) return (int)(m - c->method);
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (strncmp(m->name, names[i].begin, strlen(names[i].begin)) == 0) return names[i].family;
  return LAG_COST_FAMILIES - 1;
}

/* Time of the method's fastest run with an error of 10^-2k at most; HUGE_VAL: there is none. */
static double time_for(const CostMethod *m, int k) {
  const CostRun *run;
  return lag_cost_cheapest(m, 1, pow(10, -2 * k), &run) ? run->time : HUGE_VAL;
}

const CostMethod *lag_cost_best_of_family(const Cost *c, int family) {
  const CostMethod *best = NULL;
  int most = -1;
  for (int i = 0; i < c->nmethods; i++) {
    const CostMethod *m = &c->method[i];
    int wins = 0;
    if (family_of(c, m) != family || m->nruns == 0) continue;
    for (int k = 1; k <= COLUMNS; k++) {
      double own = time_for(m, k);
      int first = own < HUGE_VAL;
      for (int j = 0; j < c->nmethods && first; j++)
        first = family_of(c, &c->method[j]) != family || time_for(&c->method[j], k) >= own;
      wins += first;
    }
    if (wins > most) {
      best = m;
      most = wins;
    }
  }
  return best;
}

/* How the error of a run grows with time: "t^2"; "": not visible, or rounding. */
static const char *growth_of(const Cost *c, const CostRun *r) {
  const double rounding = 1e-13;
  const Samples *s = &c->reference;
  int seen = s->rows <= LAG_COST_MOST_ROWS && r->error > rounding && r->error > 30 * s->uncertainty;
  return lag_growth_name(seen ? lag_error_growth(s->rows, s->t, r->at) : LAG_ERROR_UNKNOWN);
}

/* ---- Text */

/* s[n] := the options of `lagc run` for a setting. */
static void put_options(char *s, size_t n, const CostMethod *m, const CostRun *run) {
  const char *quote = m->option.name ? "\"" : "";
  snprintf(s, n, "--method %s%s%s --%s %.9g", quote, m->name, quote, lag_cost_knob(m->method), run->knob);
}

void lag_cost_put_command(FILE *f, const App *app, const Cost *c) {
  const Args *a = &app->args;
  fprintf(f, "  lagc run %s %s", app->program->source, app->scene->name);
  if (a->given) fputs(a->given, f);
  for (int i = 0; i < a->nsets && !a->given; i++) fprintf(f, " %s", a->sets[i]);
  /* errors were compared up to there; the last --until counts */
  if (!isnan(c->reached) && c->event == app->until) fprintf(f, " --until %.9g", c->reached);
  else if (a->until && !a->given) fprintf(f, " --until %s", a->until);
}

/* Whether more time would show more accurate runs. */
static int lacks_time(const Cost *c) {
  int any = 0;
  for (int i = 0; i < c->nmethods; i++) any |= c->method[i].left_out > 0 || c->method[i].nruns == 0;
  return any;
}

/* The fastest setting for an error, as a command. Returns 0 where no run has such an error. */
static int put_cheapest(FILE *f, const App *app, const Cost *c, double error) {
  const CostRun *run;
  const CostMethod *m = lag_cost_answer(c->method, c->nmethods, error, &run);
  char options[160];
  if (!m) return 0;
  put_options(options, sizeof options, m, run);
  fprintf(f, "cheapest setting for an error of %g: %.4g ms, error %.1e\n", error, 1e3 * run->time, run->error);
  lag_cost_put_command(f, app, c);
  fprintf(f, " %s\n", options);
  return 1;
}

static void put_answer(FILE *f, const App *app, const Cost *c) {
  const double rounding = 1e-14, smallest = lag_cost_smallest_error(c->method, c->nmethods);
  static const double errors[] = {1e-3, 1e-6, 1e-9, 1e-12};
  int shown = 0;
  if (c->target > 0) {
    if (put_cheapest(f, app, c, c->target)) return;
    if (c->monitor[0])
      fprintf(f, "no setting with an error of %g or less is one that `lagc run` accepts\n", c->target);
    else
      fprintf(f, "no setting has an error of %g or less; the smallest found is %.1e; raise --target%s\n", c->target,
              smallest,
              smallest > rounding && lacks_time(c) ? ", or allow more time (--seconds)"
                                                   : ": that is rounding of doubles, or its growth");
    return;
  }
  for (size_t i = 0; i < sizeof errors / sizeof *errors; i++) shown += put_cheapest(f, app, c, errors[i]);
  if (!shown && c->monitor[0]) fprintf(f, "no setting with an error of 0.001 or less is one that `lagc run` accepts\n");
  else if (!shown && lacks_time(c))
    fprintf(f, "no setting has an error of 0.001 or less; allow more time: --seconds %.2g\n", 10 * c->seconds);
  else if (!shown)
    fprintf(f, "no setting has an error of 0.001 or less; the smallest found is %.1e: end the run earlier (--until)\n",
            smallest);
}

/* A line for each method, or for the best of each family: its times for errors of 1e-2, 1e-4, .. */
static void put_times(FILE *f, const Cost *c, int all) {
  fprintf(f, "\n  %-30s", "time [ms] for an error of");
  for (int k = 1; k <= COLUMNS; k++) fprintf(f, "%*s1e-%d", k < 5 ? 6 : 5, "", 2 * k);
  putc('\n', f);
  for (int i = 0; i < c->nmethods; i++) {
    const CostMethod *m = &c->method[i];
    if ((c->named ? m->nruns == 0 : time_for(m, 1) == HUGE_VAL) ||
        (!all && lag_cost_best_of_family(c, family_of(c, m)) != m))
      continue;
    fprintf(f, "  %-30s", m->name);
    for (int k = 1; k <= COLUMNS; k++) {
      const CostRun *any;
      double own = time_for(m, k);
      if (own < HUGE_VAL) {
        lag_cost_cheapest(c->method, c->nmethods, pow(10, -2 * k), &any);
        fprintf(f, " %8.3g%c", 1e3 * own, own <= any->time ? '*' : ' ');
      } else {
        fprintf(f, " %8s ", "-");
      }
    }
    putc('\n', f);
  }
  fputs(all || c->named ? "* the fastest of all\n"
                        : "* the fastest of all; one method of each family, --all: every method\n",
        f);
}

/* The runs of the front, or all. */
static void put_runs(FILE *f, const Cost *c, int all) {
  char setting[160], order[32], spread[32];
  fprintf(f, "\n  %-44s %-9s %-11s %12s %6s %10s %11s  %s\n", all ? "" : "the front", "error", "grows as", "time [ms]",
          "+-", "steps", "calls", "order");
  for (int i = 0; i < c->nmethods; i++) {
    const CostMethod *m = &c->method[i];
    int first = 1;
    snprintf(order, sizeof order,
             isnan(m->order)                          ? "  -"
             : m->method->flags & LAG_METHOD_ADAPTIVE ? "  %.1f"
                                                      : "  %.2f",
             m->order);
    for (int k = 0; k < m->nruns; k++) {
      const CostRun *r = &m->run[k];
      if (!all && !r->best) continue;
      snprintf(setting, sizeof setting, "%.*s%s%s=%.9g)", (int)strcspn(m->name, ")"), m->name,
               m->option.name ? ", " : "(", lag_cost_knob(m->method), r->knob);
      snprintf(spread, sizeof spread, isnan(r->spread) ? "-" : "%.0f %%", 50 * r->spread);
      fprintf(f, "%c %-44s %-9.2e %-11s %12.4g %6s %10lld %11lld%s\n", r->best ? '*' : ' ', setting, r->error,
              growth_of(c, r), 1e3 * r->time, spread, r->steps, r->calls, first ? order : "");
      first = 0;
    }
  }
  fprintf(
      f,
      "* no other run is both faster and more accurate%s. time: median processor time; +- half of the interquartile "
      "range of the\n"
      "times. order: as measured, the slope of log error against log steps, at the smallest errors above rounding\n",
      all ? "" : "; --runs: every run");
}

/* Why a method has no runs, without its name. */
static const char *why_absent(const CostMethod *m) {
  const char *why = m->why[0] ? m->why : "no run had an error below 0.3 in the time allowed (--seconds)";
  size_t n = strcspn(m->name, "(");
  return strncmp(why, "method ", 7) == 0 && strncmp(why + 7, m->name, n) == 0 && why[7 + n] == ' ' ? why + 8 + n : why;
}

/* A line for each reason, with the methods that it keeps out of the table. */
static void put_absent(FILE *f, const Cost *c) {
  for (int i = 0; i < c->nmethods; i++) {
    const char *why = why_absent(&c->method[i]);
    int first = c->method[i].nruns == 0;
    for (int k = 0; k < i; k++) first &= c->method[k].nruns > 0 || strcmp(why_absent(&c->method[k]), why) != 0;
    if (!first) continue;
    fprintf(f, "not in the table: %s", c->method[i].name);
    for (int k = i + 1; k < c->nmethods; k++)
      if (c->method[k].nruns == 0 && strcmp(why_absent(&c->method[k]), why) == 0) fprintf(f, ", %s", c->method[k].name);
    fprintf(f, ": %s\n", why);
  }
}

static void put_notes(FILE *f, const App *app, const Cost *c) {
  const Samples *s = &c->reference;
  const double worth_telling = 1e-14; /* finer settings would meet rounding */
  int n = 0;
  if (s->output == LAG_SAMPLES_RESIDUAL)
    fprintf(f, "\nerror: what is left of the equations of motion in the middle of steps, relative to the largest rate "
               "of its kind and unit\n");
  else if (s->output)
    fprintf(f, "\nerror: of %s, the largest difference from the reference at %d times, relative to its largest value\n",
            app->args.error, s->rows - 1);
  else if (s->rows == 2)
    fputs("\nerror: the difference from the reference at the end, relative to the value or others of its kind and unit "
          "there\n",
          f);
  else
    fprintf(f,
            "\nerror: the largest difference from the reference at %d times, relative to the largest value of its kind "
            "and unit\n",
            s->rows - 1);
  if (s->output != LAG_SAMPLES_RESIDUAL)
    fprintf(f, "reference: %s, itself uncertain by %.1e\n", c->reference_name, s->uncertainty);
  for (int i = 0; i < c->nmethods; i++) {
    const CostMethod *m = &c->method[i];
    if (m->nruns == 0 || !(m->left_out > worth_telling)) continue;
    fprintf(f, "%s%s from %.0e",
            n++ ? ", " : "left out, as three times slower than others or for want of time: ", m->name, m->left_out);
  }
  if (n) fputs("; more --seconds measure more\n", f);
  put_absent(f, c);
}

/* Whether any component of the reference changes between its rows. */
static int moves(const Samples *s) {
  for (int i = 1; i < s->rows; i++)
    if (memcmp(s->y, s->y + (size_t)i * (size_t)s->n, (size_t)s->n * sizeof *s->y) != 0) return 1;
  return s->rows < 2;
}

void lag_cost_put_text(FILE *f, const App *app, const Cost *c) {
  const Samples *s = &c->reference;
  fprintf(f, "model %s, scene %s, to t = %.15g s\n", app->scene->model->name, app->scene->name, s->t[s->rows - 1]);
  if (!s->output && !moves(s))
    fputs("note: nothing moves, so that every method is exact: a scene with a motion compares them, `start x = 1` in "
          "it or x=1 here\n",
          f);
  if (c->event != app->until)
    fprintf(f, "an event ends the run at about t = %.6g s; errors are compared up to t = %.6g s\n", c->event,
            s->t[s->rows - 1]);
  else if (!isnan(c->reached))
    fprintf(f,
            "the reference ends at t = %.15g s (an event ends the run, no digit is left, or it takes too long): errors "
            "are compared up to there\n",
            c->reached);
  if (c->stopped) fputs("interrupted: what was measured until then\n", f);
  put_answer(f, app, c);
  if (c->monitor[0]) fprintf(f, "`lagc run` refuses cheaper settings: %s\n", c->monitor);
  put_times(f, c, app->args.all);
  put_runs(f, c, app->args.runs);
  put_notes(f, app, c);
  lag_cost_put_precisions(f, c);
  if (app->args.sketch) lag_cost_sketch(f, c);
}

/* ---- JSON */

void lag_cost_put_json(FILE *f, const App *app, const Cost *c) {
  const Samples *s = &c->reference;
  const CostRun *cheapest = NULL;
  if (c->target > 0) lag_cost_answer(c->method, c->nmethods, c->target, &cheapest);
  Json j = lag_app_json(app, f);
  lag_json_number(&j, "until", s->t[s->rows - 1]);
  lag_json_string(&j, "reference", c->reference_name);
  lag_json_numbers(&j, {"uncertainty", s->uncertainty}, {"target", c->target > 0 ? c->target : NAN});
  lag_json_truth(&j, "interrupted", c->stopped);
  lag_cost_put_precisions_json(&j, c);
  JSON_OBJECTS(&j, "methods", i, c->nmethods) {
    const CostMethod *m = &c->method[i];
    lag_json_string(&j, "method", m->name);
    lag_json_number(&j, "order", m->order);
    lag_json_truth(&j, "best_of_family", lag_cost_best_of_family(c, family_of(c, m)) == m);
    lag_json_number(&j, "left_out_from", m->left_out > 0 ? m->left_out : NAN);
    lag_json_string(&j, "refused", m->why[0] ? m->why : NULL);
    JSON_OBJECTS(&j, "runs", k, m->nruns) {
      const CostRun *r = &m->run[k];
      lag_json_number(&j, m->method->flags & LAG_METHOD_ADAPTIVE ? "tolerance" : "step", r->knob);
      lag_json_numbers(&j, {"error", r->error}, {"seconds", r->time}, {"spread", r->spread});
      lag_json_counts(&j, {"steps", r->steps}, {"calls", r->calls});
      lag_json_truth(&j, "front", r->best);
      lag_json_truth(&j, "cheapest", r == cheapest);
      lag_json_string(&j, "growth", growth_of(c, r)[0] ? growth_of(c, r) : NULL);
    }
  }
  lag_json_close(&j);
}

/* ---- Rows */

static void put_csv(FILE *f, const Cost *c) {
  fputs("method,knob,setting,error,seconds,spread,steps,calls,front\n", f);
  for (int i = 0; i < c->nmethods; i++)
    for (int k = 0; k < c->method[i].nruns; k++) {
      const CostMethod *m = &c->method[i];
      const CostRun *r = &m->run[k];
      fprintf(f, "%s,%s,%.17g,%.17g,%.9g,%.3g,%lld,%lld,%d\n", m->name, lag_cost_knob(m->method), r->knob, r->error,
              r->time, r->spread, r->steps, r->calls, r->best);
    }
}

int lag_cost_put_rows(const char *path, const App *app, const Cost *c) {
  Outfile o;
  size_t n = strlen(path);
  if (lag_outfile_open(&o, path)) return -1;
  if (n > 5 && strcmp(path + n - 5, ".json") == 0) lag_cost_put_json(o.f, app, c);
  else put_csv(o.f, c);
  return lag_outfile_close(&o, OUTFILE_KEEP);
}
