/* --orbit: the periodic motion near a scene's start. Enters: the command line; leaves: period, multipliers, verdict
 * and a scene to paste, as text or JSON. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/periodic_orbit.h"
#include "app/app.h"

static const double same = 1e-6; /* multipliers that are nearer to 1, or to the unit circle, are not told from it */

/* ---- Settings */

int lag_charge_named(const App *app, const char *name, size_t n) {
  const lag_charges *of = app->scene->model->charges;
  if (!of) return n == 6 && memcmp(name, "energy", n) == 0 ? 0 : -1;
  for (int k = 0; k < of->n; k++)
    if (strlen(of->of[k].name) == n && memcmp(of->of[k].name, name, n) == 0) return k;
  return -1;
}

int lag_state_named(const App *app, const char *name, size_t n) {
  for (int i = 0; i < app->sim->pb.n; i++) {
    Column c = lag_state_column(app->sim, i);
    if (strlen(c.name) == n && memcmp(c.name, name, n) == 0) return i;
  }
  return -1;
}

static int add_held(App *app, PeriodicOrbit *o, const char *name, size_t n) {
  int charge = lag_charge_named(app, name, n), state = lag_state_named(app, name, n);
  if (o->nheld == ORBIT_MOST_HELD) return lag_app_error(&app->args, "--hold: at most %d names", ORBIT_MOST_HELD);
  if (charge < 0 && state < 0)
    return lag_app_error(&app->args,
                         "--hold %.*s: write `energy`, a conserved charge of the model, a coordinate, a velocity or a "
                         "state, several with commas between",
                         (int)n, name);
  o->held[o->nheld++] =
      state >= 0 ? (OrbitHold){.kind = ORBIT_STATE, .of = state} : (OrbitHold){.kind = ORBIT_CHARGE, .of = charge};
  return 0;
}

/* shifted := the coordinates of name[n], x or x[1]+x[2]. Returns their number; 0: it names others. */
static int coordinates_named(const App *app, const char *name, size_t n, int *shifted) {
  int count = 0;
  for (const char *s = name, *end = name + n; s < end && count < ORBIT_MOST_JOINT; count++) {
    const char *plus = memchr(s, '+', (size_t)(end - s));
    size_t length = (size_t)((plus ? plus : end) - s);
    int i = lag_state_named(app, s, length);
    if (i < 0 || i >= app->sim->pb.nq) return 0;
    shifted[count] = i;
    s += length + (plus != NULL);
  }
  return count;
}

static int add_group(App *app, PeriodicOrbit *o, const char *name, size_t n) {
  int charge = lag_charge_named(app, name, n);
  if (o->ngroup == ORBIT_MOST_GROUP) return lag_app_error(&app->args, "--relative: at most %d names", ORBIT_MOST_GROUP);
  OrbitClosing *c = &o->group[o->ngroup];
  c->charge = charge;
  c->n = charge < 1 ? coordinates_named(app, name, n, c->shifted) : 0;
  if (c->n) return o->ngroup++, 0;
  if (charge < 1 || !(app->scene->model->charges->of[charge].flags & LAG_CONSERVED))
    return lag_app_error(
        &app->args,
        "--relative %.*s: write the charge of a symmetry that was proved and moves coordinates, such "
        "as an angular momentum; `lagc noether` lists them, and `symmetry` declares one; or a coordinate on which "
        "nothing depends, several that move together with + between",
        (int)n, name);
  o->ngroup++;
  return 0;
}

static int read_names(App *app, PeriodicOrbit *o, const char *names,
                      int (*add)(App *, PeriodicOrbit *, const char *, size_t)) {
  int rc = 0;
  for (const char *s = names; s && *s && rc == 0; s += strspn(s, ", ")) {
    size_t n = strcspn(s, ",");
    int map = memchr(s, '=', n) != NULL; /* orbit_maps.c reads them */
    if (!map) n = strcspn(s, ", ");
    rc = map ? 0 : add(app, o, s, n);
    s += n;
  }
  return rc;
}

int lag_app_orbit_holds(App *app, PeriodicOrbit *o) { return read_names(app, o, app->args.hold, add_held); }

/* *T := the time that the option gives; 0: none is given. */
static int given_period(const Args *a, double *T) {
  const char *option = a->period ? "--period" : "--guess", *text = a->period ? a->period : a->guess;
  *T = 0;
  if (a->period && a->guess)
    return lag_app_error(a, "--period and --guess: the period is given, or about that; leave one out");
  return lag_args_positive(a, option, text, a->period ? "--period 6.28" : "--guess 6.28", "a period is a positive time",
                           T);
}

/* End of the search for a period: --until, or a little more than the scene's span, which may be the period. */
static double search_end(const App *app) {
  return app->args.until ? app->until : app->until + 0.05 * (app->until - app->scene->t0);
}

/* *T := the period of what drives the scene next to *T, for *T = 0 the shortest. */
static int driven_period(App *app, FlowMap *f, double *T) {
  const double rounding = 1e-9;
  double asked = *T;
  if (asked > 0 && lag_flow_drive(f, T) < rounding && fabs(*T - asked) <= (app->args.period ? 1e-3 : 0.2) * asked)
    return 0;
  double shortest = lag_flow_find_drive(f, search_end(app) - f->t0);
  *T = shortest;
  if (asked == 0 && shortest > 0) return 0;
  if (shortest > 0)
    lag_app_error(&app->args,
                  "%s %g: the equations are not the same that time later; what drives scene %s has the period %.16g s: "
                  "write a multiple of it, or leave the option out",
                  app->args.period ? "--period" : "--guess", asked, app->scene->name, shortest);
  else
    lag_app_error(&app->args,
                  "scene %s depends on time, and no period of what drives it is found until t = %g s: only with one "
                  "motions can be periodic; a longer one: --until, or --period T",
                  app->scene->name, app->until);
  return EXIT_RUN;
}

/* Refuses a start that is an equilibrium, but for rounding. */
static int check_moves(App *app, FlowMap *f) {
  const double rounding = 1e-12;
  double most = 0, span = search_end(app) - f->t0, *rates = f->up;
  if (f->forced || lag_flow_rates(f, f->t0, f->probe->now, rates)) return 0;
  for (int i = 0; i < f->n; i++)
    most = fmax(most, fabs(rates[i]) * span / lag_difference_scale(&f->probe->pb, f->probe->now, i));
  if (most > rounding) return 0;
  return lag_app_no_result(
      &app->args,
      "scene %s starts at rest, at an equilibrium, which has no period: `lagc modes` analyses it; start on a "
      "motion that comes back: name=VALUE",
      app->scene->name);
}

/* *T := the period, or a guess of it: of the drive, as given, or the first close return of the motion. */
static int choose_period(App *app, PeriodicOrbit *o, double *T) {
  const Args *a = &app->args;
  char message[600];
  FlowMap f;
  int rc = given_period(a, T);
  const double longest = 1e4 * (search_end(app) - app->scene->t0);
  if (rc == 0 && !(longest > 0))
    rc = lag_app_error(a, "a period is looked for forwards in time: write --until with a time after %g s",
                       app->scene->t0);
  if (rc == 0 && *T > longest)
    rc = lag_app_error(a, "%s %g: more than %g s, ten thousand times the span of scene %s; a longer one: --until T",
                       a->period ? "--period" : "--guess", *T, longest, app->scene->name);
  if (rc) return rc;
  rc = lag_flow_open(&f, app->sim) ? lag_app_no_result(a, "%s", f.message) : LAG_OK;
  f.closing = o->closing;
  rc = rc ? rc : check_moves(app, &f);
  if (rc == 0 && f.forced) rc = driven_period(app, &f, T);
  else if (rc == 0 && a->period) o->held[o->nheld++] = (OrbitHold){.kind = ORBIT_PERIOD, .value = *T};
  lag_flow_free(&f);
  if (rc || f.forced || a->period) return rc;
  double about = *T, until = about > 0 ? app->scene->t0 + 1.25 * about : search_end(app);
  rc = lag_orbit_guess(o, app->sim, until, about, T, message, sizeof message);
  if (about > 0) *T = rc == 0 && *T > 0 && !o->ngroup ? *T : about;
  else if (rc) return lag_app_no_result(a, "%s", message);
  if (*T > 0) return 0;
  return lag_app_no_result(
      a,
      "no periodic motion found near scene %s: until t = %g s the motion does not come back next to its "
      "start%s; run longer: --until, start nearer to one: name=VALUE, or write about how long it takes: "
      "--guess T",
      app->scene->name, app->until, message);
}

static void take_values(PeriodicOrbit *o) {
  for (int k = 0; k < o->nheld; k++) {
    OrbitHold *h = &o->held[k];
    if (h->kind == ORBIT_STATE) h->value = o->flow.probe->now[h->of];
    if (h->kind == ORBIT_CHARGE) h->value = lag_flow_charge(&o->flow, h->of, o->flow.t0, o->flow.probe->now);
  }
}

/* ---- The report */

typedef enum OrbitVerdict {
  ORBIT_ATTRACTS,
  ORBIT_UNSTABLE,
  ORBIT_ELLIPTIC,
  ORBIT_BORDER,
  ORBIT_NO_OTHERS
} OrbitVerdict;

static const char *const verdict_names[] = {[ORBIT_ATTRACTS] = "attracts",
                                            [ORBIT_UNSTABLE] = "unstable",
                                            [ORBIT_ELLIPTIC] = "stable by the linearisation",
                                            [ORBIT_BORDER] = "undecided",
                                            [ORBIT_NO_OTHERS] = "stable"};

static double size_of(const PeriodicOrbit *o, int i) { return hypot(o->re[i], o->im[i]); }

static int near_one(const PeriodicOrbit *o, double sign) {
  int count = 0;
  for (int i = 0; i < o->nmultipliers; i++) count += hypot(o->re[i] - sign, o->im[i]) < same;
  return count;
}

/* Multipliers on the circle that meet others of it, not at 1 or -1. */
static int collides(const PeriodicOrbit *o) {
  for (int i = 0; i < o->nmultipliers; i++)
    for (int j = 0; j < i; j++)
      if (fabs(o->im[i]) > same && fabs(size_of(o, i) - 1) < 1e-3 &&
          hypot(o->re[i] - o->re[j], o->im[i] - o->im[j]) < 1e-3)
        return 1;
  return 0;
}

static OrbitVerdict verdict_of(const PeriodicOrbit *o) {
  if (o->nmultipliers > 0 && size_of(o, 0) > 1 + same) return ORBIT_UNSTABLE;
  if (o->opens) return ORBIT_BORDER;
  if (o->nmultipliers == 0) return ORBIT_NO_OTHERS;
  if (size_of(o, 0) < 1 - same) return ORBIT_ATTRACTS;
  return isfinite(o->pairing) && !near_one(o, 1) && !near_one(o, -1) && !collides(o) ? ORBIT_ELLIPTIC : ORBIT_BORDER;
}

static void reason(const PeriodicOrbit *o, OrbitVerdict v, char *s, size_t n) {
  if (v == ORBIT_NO_OTHERS)
    snprintf(s, n, "neighbouring motions differ by their phase and by the values of charges alone");
  else if (v == ORBIT_UNSTABLE)
    snprintf(s, n, "a small disturbance grows by a factor of %.6g in each period%s", size_of(o, 0),
             size_of(o, o->nmultipliers - 1) < 1 - same ? "; others decay: a saddle" : "");
  else if (v == ORBIT_ATTRACTS)
    snprintf(s, n, "every small disturbance decays, the slowest by a factor of %.6g in each period", size_of(o, 0));
  else if (v == ORBIT_ELLIPTIC)
    snprintf(s, n,
             "all multipliers lie on the unit circle, apart from each other: small disturbances turn around the "
             "motion");
  else if (o->opens)
    snprintf(s, n, "a small push opens %s, which is closed at the begin, and it is still open a period later",
             o->opens);
  else
    snprintf(s, n, "%s",
             near_one(o, 1)    ? "a further multiplier is 1: a family, a fold or a branch point, or a charge that "
                                 "is not proved"
             : near_one(o, -1) ? "a multiplier is -1: the period doubles here"
             : collides(o)     ? "two pairs of multipliers meet on the unit circle"
                               : "a multiplier lies on the unit circle");
}

/* Periods of a motion that closes after an exchange until it closes by itself; 0: it never does. */
static int closings(const PeriodicOrbit *o) { return !o->closing ? 1 : o->ngroup ? 0 : lag_map_order(o->closing); }

/* A name that no scene of the file has: orbit, orbit_2, ... */
static void free_name(const App *app, char name[32]) {
  const lag_program *p = app->program;
  int taken = 1;
  for (int k = 1; taken; k++) {
    snprintf(name, 32, k > 1 ? "orbit_%d" : "orbit", k);
    taken = 0;
    for (int i = 0; i < p->nscenes; i++) taken |= strcmp(p->scenes[i]->name, name) == 0;
  }
}

void lag_app_put_start(FILE *f, const App *app, const double *y, double span) {
  char text[64];
  for (int k = 0; k < app->args.nsets; k++) {
    const char *set = app->args.sets[k], *eq = strchr(set, '=');
    if (lag_state_named(app, set, (size_t)(eq - set)) < 0) fprintf(f, "  %.*s = %s\n", (int)(eq - set), set, eq + 1);
  }
  for (int i = 0; i < app->sim->pb.n; i++) {
    Column c = lag_state_column(app->sim, i);
    fprintf(f, "%s%s = %s", i % 4 == 0 ? i ? "\n  start " : "  start " : ", ", c.name,
            lag_number_text(lag_sim_declared(app->sim, i, y[i]), text));
    if (c.unit[0] && strcmp(c.unit, "1") != 0) fprintf(f, " [%s]", c.unit);
  }
  fprintf(f, "\n  span %s\n}\n", lag_number_text(span, text));
}

static void put_scene(FILE *f, const App *app, const PeriodicOrbit *o) {
  char name[32];
  free_name(app, name);
  fprintf(f, "\nscene %s \"periodic\" {\n  like %s\n", name, app->scene->name);
  lag_app_put_start(f, app, o->y, o->T * (closings(o) ? closings(o) : 1));
}

static void put_multipliers(FILE *f, const PeriodicOrbit *o) {
  if (o->ntrivial)
    fprintf(f, "%d multiplier%s 1 by the phase, conserved charges and their symmetries%s\n", o->ntrivial,
            o->ntrivial > 1 ? "s are" : " is", o->nmultipliers ? "; the others:" : "; there are no others");
  for (int i = 0; i < o->nmultipliers; i++) {
    fprintf(f, "  %-22.15g", o->re[i]);
    if (o->im[i] != 0.0) fprintf(f, " %c %.15g i", o->im[i] < 0 ? '-' : '+', fabs(o->im[i]));
    fprintf(f, "   size %.10g", size_of(o, i));
    if (o->im[i] > 0) fprintf(f, ", turns by %.8g of a turn in a period", atan2(o->im[i], o->re[i]) / (2 * acos(-1)));
    putc('\n', f);
  }
  if (isfinite(o->pairing))
    fprintf(f, "multipliers come in pairs a, 1/a, as of Hamilton's equations: to %.1g\n", o->pairing);
}

static void put_free(FILE *f, const PeriodicOrbit *o) {
  int phase = !o->flow.forced;
  if (o->steady)
    fputs("a steady motion: its symmetry alone carries it along, so it closes after any period; `lagc modes --steady` "
          "gives its modes; for another motion hold more: --hold NAME,NAME\n", f);
  else if (o->nfree == 0) fputs("isolated: there is no other periodic motion of this period beside it\n", f);
  else if (o->nfree == 1 && phase) fputs("isolated: beside it there are only its other phases\n", f);
  else
    fprintf(f,
            "one of a family: %d direction%s to others%s; the nearest one to the start is shown; --hold NAME fixes a "
            "charge or a coordinate\n",
            o->nfree, o->nfree > 1 ? "s lead" : " leads", phase ? ", one of them along the motion" : "");
}

static const char *group_name(const App *app, const PeriodicOrbit *o, int j) {
  const lag_model *m = app->scene->model;
  return o->group[j].n ? m->q[o->group[j].shifted[0]].name : m->charges->of[o->group[j].charge].name;
}

static void put_text(FILE *f, App *app, const PeriodicOrbit *o) {
  char method[256], why[400], text[64];
  OrbitVerdict v = verdict_of(o);
  lag_report_method(app, method, sizeof method);
  fprintf(f, "%s: scene %s, method %s\n", app->scene->model->name, app->scene->name, method);
  fprintf(f, "periodic motion: period %s s", lag_number_text(o->T, text));
  if (o->flow.forced) fputs(", that of the drive or a multiple", f);
  else fprintf(f, ", error %.1g s", o->period_error);
  fprintf(f, "\nfound in %d step%s over %d segment%s", o->steps, o->steps == 1 ? "" : "s", o->m,
          o->m == 1 ? "" : "s");
  if (o->settled) fprintf(f, " from where the motion is after %d periods", o->settled);
  fprintf(f, "; it closes to %.1g of its size\n", o->residual);
  for (int j = 0; j < o->ngroup; j++) {
    int i = o->group[j].shifted[0];
    if (!o->group[j].n)
      fprintf(f, "relative: it closes after the symmetry of %s by %s\n", group_name(app, o, j),
              lag_number_text(o->shift[j], text));
    else
      fprintf(f, "relative: %s moves on by %s %s in each period\n", group_name(app, o, j),
              lag_number_text(lag_sim_declared(app->sim, i, o->shift[j]), text), app->scene->model->q[i].unit);
  }
  if (closings(o) > 1)
    fprintf(f, "relative: it closes after the exchange %s; after %d times that, %s s, all is as at its begin\n",
            app->args.relative, closings(o), lag_number_text(closings(o) * o->T, text));
  if (o->reverse)
    fprintf(f, "reversible by %s: from t = %s s on the motion is its first half backwards\n", app->args.reverse,
            lag_number_text(o->T / 2, text));
  if (o->flow.differences)
    fputs("multipliers to about 8 digits: a contact with friction, or one that comes and goes, has no tangent, which "
          "runs from beside the start replace\n", f);
  if (o->closed)
    fprintf(f, "%s is closed at the begin: multipliers are of disturbances that keep it so%s\n", o->closed,
            o->opens ? "" : "; after a small push that opens it, it is closed again within a period");
  put_free(f, o);
  if (o->repeats > 1)
    fprintf(f, "note: the motion comes back already after 1/%d of this period: --guess %s\n", o->repeats,
            lag_number_text(o->T / o->repeats, text));
  put_multipliers(f, o);
  reason(o, v, why, sizeof why);
  fprintf(f, "%s: %s\n", verdict_names[v], why);
  put_scene(f, app, o);
}

static void put_json(FILE *f, App *app, const PeriodicOrbit *o) {
  Json j = lag_report_json_open(app, f);
  char why[400];
  OrbitVerdict v = verdict_of(o);
  reason(o, v, why, sizeof why);
  lag_json_numbers(&j, {"period", o->T}, {"period_error", o->flow.forced ? NAN : o->period_error},
                       {"residual", o->residual});
  lag_json_count(&j, "newton_steps", o->steps);
  lag_json_count(&j, "periods_before", o->settled);
  lag_json_string(&j, "multipliers_by", o->flow.differences ? "differences" : "tangent");
  lag_json_counts(&j, {"segments", o->m}, {"free_directions", o->nfree});
  lag_json_truth(&j, "steady", o->steady);
  lag_json_count(&j, "repeats", o->repeats > 1 ? o->repeats : 1);
  lag_json_begin(&j, "shifts", '{');
  for (int k = 0, i; k < o->ngroup; k++) {
    i = o->group[k].shifted[0];
    lag_json_number(&j, group_name(app, o, k),
                    !o->group[k].n ? o->shift[k] : lag_sim_declared(app->sim, i, o->shift[k]));
  }
  lag_json_end(&j, '}');
  if (closings(o) > 1) lag_json_number(&j, "whole_period", closings(o) * o->T);
  JSON_EACH(&j, "start", '{', i, o->n)
    lag_json_number(&j, lag_state_column(app->sim, i).name, lag_sim_declared(app->sim, i, o->y[i]));
  lag_json_count(&j, "trivial_multipliers", o->ntrivial);
  JSON_EACH(&j, "multipliers", '[', i, o->nmultipliers)
    lag_json_row(&j, NULL, 2, (const double[]){o->re[i], o->im[i]});
  lag_json_string(&j, "closed", o->closed);
  lag_json_number(&j, "pairing", o->pairing);
  lag_json_strings(&j, {"verdict", verdict_names[v]}, {"reason", why});
  lag_json_close(&j);
}

/* ---- The command */

/* How near the search came, as JSON. */
static void json_not_found(App *app, const PeriodicOrbit *o) {
  Json j = lag_app_json(app, stdout);
  lag_json_string(&j, "status", "no periodic motion");
  lag_json_numbers(&j, {"period", o->T}, {"residual", o->residual});
  lag_json_count(&j, "newton_steps", o->steps);
  int traced = 0;
  while (traced < ORBIT_TRACE && o->trace[traced] > 0) traced++;
  lag_json_row(&j, "residuals", traced, o->trace);
  lag_json_close(&j);
}

static int not_found(App *app, const PeriodicOrbit *o) {
  char course[200] = "", text[64];
  size_t n = 0;
  if (app->args.json) json_not_found(app, o);
  for (int k = 0; k < ORBIT_TRACE && o->trace[k] > 0 && n < sizeof course - 20; k++)
    n += (size_t)snprintf(course + n, sizeof course - n, "%s%.2g", k ? ", " : "", o->trace[k]);
  return lag_app_no_result(
      &app->args,
      "no periodic motion found near the start of scene %s%s: after %d steps the motion of %s s still misses its "
      "start by %.2g of its size (before: %s). Start nearer to one: name=VALUE; another period: --guess T; "
      "%sor more segments: --segments %d",
      app->scene->name, o->settled ? ", nor after two hundred periods" : "", o->steps,
      lag_number_text(o->T, text), o->residual, course,
      o->nheld > (o->flow.forced != 0) ? "without --hold; " : "", 2 * o->m);
}

enum { SETTLE = 200 }; /* periods */

/* With friction a driven motion comes to one that repeats, however far it begins from it. As lag_orbit_solve. */
static int solve_settled(PeriodicOrbit *o) {
    if (!o->flow.forced || o->closing || o->reverse || o->ngroup || o->nheld || lag_orbit_settle(o, SETTLE)) return 0;
  return lag_orbit_solve(o);
}

int lag_app_orbit_solve(App *app, PeriodicOrbit *o) {
  const Args *a = &app->args;
  int rc = lag_orbit_solve(o);
  if (rc == 0) rc = solve_settled(o);
  if (rc == 0) return not_found(app, o);
  if (rc > 0) rc = lag_orbit_refine(o);
  if (rc == 0 && o->at_rest && o->T < 1e-3 * o->time)
    return lag_app_no_result(a,
                             "no periodic motion found near the start of scene %s: the search shrinks the period to "
                             "nothing; start nearer to one: name=VALUE, or another period: --guess T",
                             app->scene->name);
  if (rc == 0 && o->at_rest) {
    return lag_app_no_result(
        a,
        "the search from scene %s ends at rest, which has no period: `lagc modes` analyses it; start on a "
        "motion that comes back: name=VALUE, or hold one: --hold NAME",
        app->scene->name);
  }
  if (rc == 0 && o->asymmetric) {
    return lag_app_no_result(a,
                             "--relative %s: events of the scene do not have this symmetry: the motion that was found "
                             "does not go on as its image",
                             a->relative);
  }
  rc = rc ? rc : lag_orbit_multipliers(o);
  rc = rc ? rc : lag_orbit_contacts(o);
  if (rc == LAG_OK) return 0;
  return lag_app_no_result(a, "%s",
                           rc == LAG_ENOMEM                           ? "out of memory"
                           : rc == LAG_EMETHOD && !o->flow.message[0] ? "the multipliers do not converge"
                                                                      : o->flow.message);
}

/* app->sim with the values, method and tolerance of the search. */
int lag_app_orbit_set_up(App *app) {
  const double fine = 1e-13;
  int rc = lag_app_set_up_start(app);
  if (rc) return rc;
  if (!app->extras.algebra) return lag_app_no_gsl(app, "finds eigenvalues");
  if (!app->args.tol && lag_sim_tolerance(app->sim) > fine && sizeof(double) == 8)
    lag_sim_set_tolerance(app->sim, fine);
  return lag_app_choose_method(app);
}

/* *map := that of the option, in the orbit's pool; NULL: it names none. */
static int read_map(App *app, PeriodicOrbit *o, const char *option, const char *terms, const StateMap **map) {
  int reverses = map == &o->reverse;
  if (!terms || (!reverses && !strchr(terms, '='))) return 0;
  StateMap *m = (StateMap *)(void *)lag_pool_doubles(&o->pool, sizeof *m / sizeof(double) + 1);
  if (!m || lag_map_open(m, &o->pool, app->sim->pb.n, app->sim->pb.nq, reverses))
    return lag_app_error(&app->args, "out of memory");
  *map = m;
  if (reverses && strcmp(terms, "rest") == 0) return 0;
  return lag_app_map_terms(app, option, terms, m);
}

static int read_maps(App *app, PeriodicOrbit *o) {
  const Args *a = &app->args;
  int rc = read_map(app, o, "--relative", a->relative, &o->closing);
  rc = rc ? rc : read_map(app, o, "--reverse", a->reverse, &o->reverse);
  if (rc || !o->reverse || (!o->closing && !o->ngroup)) return rc;
  return lag_app_error(a, "--reverse and --relative: a motion is solved by half, or closes after a symmetry; leave one "
                          "out");
}

int lag_app_orbit_open(App *app, PeriodicOrbit *o) {
  enum { MOST_SEGMENTS = 200 };
  const Args *a = &app->args;
  double T = 0, segments = 0;
  int rc = lag_app_orbit_holds(app, o);
  rc = rc ? rc : read_names(app, o, a->relative, add_group);
  rc = rc ? rc : read_maps(app, o);
  if (rc == 0 && a->segments) {
    long long count = 0;
    rc = lag_args_count(a, "--segments", a->segments, "--segments 4", &count);
    if (rc == 0 && count > MOST_SEGMENTS)
      rc = lag_app_error(a, "--segments %s: up to %d, whose equations are solved together", a->segments, MOST_SEGMENTS);
    segments = (double)count;
  }
  rc = rc ? rc : choose_period(app, o, &T);
  if (rc == 0 && lag_orbit_open(o, app->sim, app->extras.algebra, T, (int)segments)) {
    lag_app_error(a, "%s", o->flow.message[0] ? o->flow.message : "out of memory");
    rc = EXIT_RUN;
  }
  if (rc == 0) take_values(o);
  return rc;
}

int lag_app_orbit(App *app) {
  PeriodicOrbit o = {0};
  const Args *a = &app->args;
  int rc = lag_app_orbit_set_up(app);
  if (!a->manifold && !a->to && (a->out || a->svg || a->section || a->follow || a->equilibrium))
    return lag_app_error(a, "-o, --svg, --section, --follow and --equilibrium are for --manifold unstable|stable|both");
  if (a->to && (a->equilibrium || !a->section))
    return lag_app_error(a, "--to %s: motions from one periodic motion to another are found where they cross a "
                            "section: --section 'x rising'%s", a->to,
                         a->equilibrium ? "; leave --equilibrium out" : "");
  if (rc == 0 && a->equilibrium) return lag_app_rest_manifolds(app);
  rc = rc ? rc : lag_app_orbit_open(app, &o);
  rc = rc ? rc : lag_app_orbit_solve(app, &o);
  if (rc == 0 && a->manifold && !a->to) rc = lag_app_manifolds(app, &o);
  if (rc == 0 && a->to) rc = lag_app_connections(app, &o);
  else if (rc == 0 && a->json) put_json(stdout, app, &o);
  else if (rc == 0) put_text(stdout, app, &o);
  lag_orbit_free(&o);
  return rc;
}
