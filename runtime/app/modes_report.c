/* --modes: the equilibrium near the start, its stability, and its normal modes. Enters: a simulation at its start;
 * leaves: a table, or one JSON object. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/steady_motion.h"
#include "app/amplitude_report.h"

/* Description of coordinate or state i of x[nq + nz]. */
static const lag_var *variable(const lag_model *m, int i) { return i < m->nq ? &m->q[i] : &m->z[i - m->nq]; }

/* ---- Refusals */

/* Name of the first input that changes in time; NULL: none. */
static const char *changing_input(const App *app) {
  lag_problem *pb = &app->sim->pb;
  const lag_model *m = pb->model;
  static const double times[] = {0, 0.1234567, 0.5772157, 2.7182818};
  double first[64];
  for (size_t k = 0; k < sizeof times / sizeof *times; k++) {
    if (lag_inputs(pb, app->scene->t0 + times[k])) return NULL;
    for (int i = 0; i < m->nu && i < 64; i++) {
      if (k > 0 && pb->u[i] != first[i]) return m->u[i].name;
      first[i] = k > 0 ? first[i] : pb->u[i];
    }
  }
  return NULL;
}

/* Whether modes are computed in the tangent space of the constraints, or about a motion. */
static int in_tangent_space(const App *app) { return app->scene->model->constraints || app->args.steady; }

/* EXIT_USAGE after a message where this simulator or model has no modes; else 0. */
static int refuse(const App *app) {
  const lag_model *m = app->scene->model;
  const Args *a = &app->args;
  const char *source = app->program->source;
  if (!app->extras.algebra) return lag_app_no_gsl(app, "finds roots and eigenvalues");
  if (!m->linear && !in_tangent_space(app)) {
    return lag_app_error(
        a,
        "this simulator was built without the model's linearisation; write lagc modes %s, or build it with: lagc "
        "build %s --with linear",
        source, source);
  }
  if (m->nq + m->nz == 0) return lag_app_error(a, "model %s has neither coordinates nor states", m->name);
  if (m->flags & LAG_AUTONOMOUS) return 0;
  if (!(m->flags & LAG_TIMELESS)) {
    return lag_app_error(
        a,
        "scene %s depends on time: t stands in its equations, so nothing stays at rest; take a scene without "
        "what drives it, or put a parameter in place of t",
        app->scene->name);
  }
  const char *input = changing_input(app);
  return input ? lag_app_error(a, "scene %s depends on time by its input %s, so nothing stays at rest; hold it: %s=0",
                               app->scene->name, input, input)
               : 0;
}

/* ---- Caution and reason of a result */

/* A caution about the result; NULL: none. */
static const char *caution_of(const App *app, const Equilibrium *r) {
  if (r->pole) return "the mass matrix is nearly singular here: a coordinate has lost its meaning";
  if (app->scene->model->ncontacts)
    return "contacts, and constraints with `while`, do not act here: small motion does not reach them";
  if (!(app->scene->model->flags & LAG_SMOOTH))
    return "the model has if, abs, sign, min, max, atan2 or roots: where they switch at the equilibrium, the modes are "
           "those of one side";
  return NULL;
}

/* Verdicts on stability, and their reasons where these are the same for every model. */
static const struct {
  const char *name, *reason;
} verdicts[] = {
    [LAG_UNSTABLE] = {"unstable", NULL},
    [LAG_DECAYS] = {"asymptotically stable", NULL},
    [LAG_MINIMUM] = {"stable", NULL},
    [LAG_DISSIPATIVE_MINIMUM] = {"stable", "the energy, less the work of forces that are constant or have a potential, "
                                           "has a minimum here, and nothing raises it (Lagrange, Dirichlet, Kelvin)"},
    [LAG_NEUTRAL] = {"neutral", NULL},
    [LAG_GYROSCOPIC] = {"undecided", NULL},
    [LAG_DEGENERATE] =
        {"undecided",
         "a zero mode, or several together: the linearisation has no force along it, so it does not decide stability"},
    [LAG_COORDINATE_POLE] =
        {"undecided",
         "a coordinate has lost its meaning here, as a longitude does at a pole; these are the modes of the others, "
         "and coordinates without a pole here would show all"},
    [LAG_HELD] = {"undecided", "dry friction holds what rests here against small forces, and stops small motions, so "
                               "that none is linear: these are "
                               "the modes without it; lagc run shows where the motion stops"},
    [LAG_NONSMOOTH] =
        {"undecided",
         "the forces' derivatives jump here, or have no limit, so that no motion is small enough to be linear"},
    [LAG_DEFECTIVE] =
        {"undecided",
         "a multiple frequency with too few shapes: small motion grows in proportion to time, until the nonlinear "
         "terms matter"},
    [LAG_CENTRE] = {"undecided", "some modes neither grow nor decay, and no energy is known that is conserved"},
};

/* text[n] := the reason of the verdict on stability. */
static void put_reason(const Modes *s, unsigned facts, char *text, size_t n) {
  const Mode *last = &s->mode[s->n - 1], *top = s->mode; /* the one that grows fastest, or decays slowest */
  for (int i = 0; i < s->n; i++) top = s->mode[i].re > top->re ? &s->mode[i] : top;
  const char *where = facts & LAG_CONSERVES_ENERGY ? "" : " at these values of parameters";
  if (s->verdict == LAG_CENTRE && (facts & LAG_CONSERVES_ENERGY || s->conserves)) {
    snprintf(text, n,
             "some modes neither grow nor decay, and the energy, which is conserved%s, is not known to have a minimum "
             "here",
             where);
  } else if (s->verdict == LAG_MINIMUM) {
    snprintf(text, n, "the energy, which is conserved%s, has a %s (%sDirichlet)", where,
             s->extremum < 0 ? "maximum here, and all rates follow from it" : "minimum here",
             s->extremum < 0 ? "" : "Lagrange, ");
  } else if (verdicts[s->verdict].reason) {
    snprintf(text, n, "%s", verdicts[s->verdict].reason);
  } else if (s->verdict == LAG_UNSTABLE) {
    snprintf(text, n, "mode %d grows by a factor of e in %.6g s", (int)(top - s->mode) + 1, 1 / top->re);
  } else if (s->verdict == LAG_DECAYS) {
    snprintf(text, n, "every mode decays, the slowest by a factor of e in %.6g s", -1 / top->re);
  } else if (s->verdict == LAG_NEUTRAL && s->steady) {
    snprintf(text, n, "zero modes lead to other steady motions%s",
             last->re == 0.0 && last->im == 0.0 ? "; there are no other modes"
                                                : "; all other modes decay, "
                                                  "so the motion comes back to one of them beside it");
  } else if (s->verdict == LAG_NEUTRAL) {
    snprintf(text, n, "no force along the zero modes%s%s", s->drifts ? ", so a push causes an endless drift" : "",
             last->re == 0.0 && last->im == 0.0 ? "; there are no others"
             : s->lowering == 0 && s->pairs     ? "; the energy has a minimum in all other directions"
                                                : "; all other modes decay");
  } else {
    snprintf(text, n,
             "all modes oscillate, but the energy falls in %d direction%s: forces at right angles to the motion alone "
             "hold it, and "
             "damping in all directions would make it unstable (Thomson, Tait, Chetaev)",
             s->lowering, s->lowering == 1 ? "" : "s");
  }
}

/* ---- Text */

enum { WIDE = 118, LISTED = 24, ALL_SHOWN = 6, MOST_MODES = 40, NUMBER = 13 };

/* A line of words that is wrapped at WIDE columns. */
typedef struct Line {
  FILE *f;
  int column, indent;
} Line;

static void put_word(Line *l, const char *word) {
  int n = (int)strlen(word);
  if (l->column + 1 + n > WIDE) {
    fprintf(l->f, "\n%*s", l->indent, "");
    l->column = l->indent;
  }
  l->column += fprintf(l->f, " %s", word);
}

/* text := a component, "1.5", or "1.5@-90": 90 degrees behind. Values below 1e-9 of `most` are shown as 0. */
static void value_text(double re, double im, double most, char *text, size_t n) {
  double size = hypot(re, im), phase = atan2(im, re) * 180 / acos(-1);
  if (!(size > 1e-9 * most)) snprintf(text, n, "0");
  else if (fabs(im) <= 1e-9 * size) snprintf(text, n, "%.6g", re);
  else snprintf(text, n, "%.6g@%.4g", size, phase);
}

/* A vector to show: values in SI; im may be NULL. */
typedef struct Vector {
  const lag_model *m;
  const double *re, *im;
  int state; /* 1: a state, shown with units and their offsets; 0: a change of state */
  int all;   /* 1: zero components are shown, too */
} Vector;

static int units_differ(const lag_model *m) {
  for (int i = 1; i < m->nq + m->nz; i++)
    if (strcmp(variable(m, i)->unit, variable(m, 0)->unit) != 0) return 1;
  return 0;
}

/* Component i in its declared unit. */
static double part(const double *x, const Vector *v, int i) {
  const lag_var *var = variable(v->m, i);
  return x ? (x[i] - (v->state ? var->offset : 0)) / var->factor : 0;
}

/* Prints components, "th1 1, th2 1.41421"; of many every k-th. */
static void put_vector(Line *l, Vector v) {
  int n = v.m->nq + v.m->nz, shown = 0, with_units = v.state || units_differ(v.m);
  double most = 0;
  for (int i = 0; i < n; i++) most = fmax(most, hypot(part(v.re, &v, i), part(v.im, &v, i)));
  for (int i = 0; i < n; i++) shown += v.all || hypot(part(v.re, &v, i), part(v.im, &v, i)) > 1e-9 * most;
  int every = shown > LISTED ? (shown + LISTED - 1) / LISTED : 1;
  for (int i = 0, k = 0; i < n; i++) {
    const lag_var *var = variable(v.m, i);
    const char *unit = with_units && strcmp(var->unit, "1") != 0 ? var->unit : "";
    char value[64], word[300];
    if ((!v.all && hypot(part(v.re, &v, i), part(v.im, &v, i)) <= 1e-9 * most) || k++ % every) continue;
    value_text(part(v.re, &v, i), part(v.im, &v, i), most, value, sizeof value);
    snprintf(word, sizeof word, "%s %s%s%s%s", var->name, value, unit[0] ? " " : "", unit,
             k + every <= shown ? "," : "");
    put_word(l, word);
  }
  if (every > 1) l->column += fprintf(l->f, " (every %d)", every);
}

/* Distance of a variable from its start, in scales. */
static double moved(const Equilibrium *r, int i) { return fabs(r->found[i] - r->start[i]) / r->scale[i]; }

/* Rates of a steady motion: of coordinates, or of the states of a model that has no others. */
typedef struct Rates {
  int n;
  const double *of; /* [n] of variable(m, i) */
} Rates;

static Rates steady_rates(const lag_model *m, const Equilibrium *r) {
  return m->nq ? (Rates){m->nq, r->y + m->nq} : (Rates){m->nz, r->rate};
}

/* "  moving with x' 5 m/s, ...": the rates of a steady motion. */
static void put_velocities(FILE *f, const lag_model *m, Rates rates) {
  Line line = {f, fprintf(f, "  moving with"), 4};
  const double *v = rates.of;
  int last = rates.n - 1;
  while (last > 0 && v[last] == 0.0) last--;
  for (int i = 0; i <= last; i++) {
    char word[300];
    const lag_var *x = variable(m, i);
    const char *unit = strcmp(x->unit, "1") == 0 ? "" : x->unit;
    snprintf(word, sizeof word, "%s' %.6g%s%s%s%s", x->name, v[i] / x->factor, unit[0] ? " " : "", unit[0] ? unit : "",
             unit[0] ? "/s" : " /s", i < last ? "," : "");
    if (v[i] != 0.0) put_word(&line, word);
  }
  putc('\n', f);
}

static void put_equilibrium(FILE *f, const App *app, const Equilibrium *r, const Modes *s) {
  const lag_model *m = app->scene->model;
  Line line = {f, 0, 4};
  int far = 0, moving = 0;
  for (int i = 0; i < r->n; i++) far = moved(r, i) > moved(r, far) ? i : far;
  for (int i = 0; i < m->nq; i++) moving |= r->sim->now[m->nq + i] != 0;
  fprintf(f, "%s: scene %s\n%s: ", m->name, app->scene->name, s->steady ? "steady motion" : "equilibrium");
  const lag_var *v = variable(m, far);
  if (moved(r, far) > 1e-12)
    fprintf(f, "from the start %s moved by %.6g%s%s", v->name, (r->found[far] - r->start[far]) / v->factor,
            v->unit[0] ? " " : "", v->unit);
  else fputs("the start itself", f);
  fprintf(f, "%s\n ", moving && !s->steady ? ", at rest (with the velocities of the start: --steady)" : "");
  put_vector(&line, (Vector){.m = m, .re = r->found, .state = 1, .all = 1});
  putc('\n', f);
  if (s->steady) put_velocities(f, m, steady_rates(m, r));
}

static void put_number(FILE *f, int width, double x) {
  if (isfinite(x)) fprintf(f, "  %-*.7g", width, x);
  else fprintf(f, "  %-*s", width, "-");
}

static void put_mode(FILE *f, const lag_model *model, const Mode *m, int k, int damped) {
  int oscillates = m->im > 0, zero = m->re == 0.0 && m->im == 0.0;
  double two_pi = 2 * acos(-1), w = oscillates || zero ? m->im : NAN;
  Line line = {f, 0, 0};
  line.column = fprintf(f, "%4d", k + 1) + 3 * (NUMBER + 2) + (damped ? NUMBER + 2 + 20 : 0);
  put_number(f, NUMBER, w);
  put_number(f, NUMBER, w / two_pi);
  put_number(f, NUMBER, oscillates ? two_pi / w : NAN);
  if (damped) {
    char text[40];
    put_number(f, NUMBER, !oscillates ? NAN : m->re == 0.0 ? 0 : -m->re / hypot(m->re, m->im));
    snprintf(text, sizeof text, m->re == 0.0 ? "-" : "%s %.7g", m->re > 0 ? "grows" : "decays", 1 / fabs(m->re));
    fprintf(f, "  %-18s", text);
  }
  line.indent = line.column;
  put_vector(&line, (Vector){model, m->shape_re, m->shape_im, 0, model->nq + model->nz <= ALL_SHOWN});
  if (zero || m->repeats > 1) {
    char text[60];
    snprintf(text, sizeof text,
             m->repeats > 1 ? "(%d equal, too few shapes)"
             : m->free      ? "(free)"
                            : "(zero mode)",
             m->repeats);
    put_word(&line, text);
  }
  putc('\n', f);
}

/* Whether a listed mode stands for a pair, one that grows and one that decays as fast. */
static int has_twins(const Modes *s) {
  int twins = 0;
  for (int i = 0; i < s->n && i < MOST_MODES; i++) twins |= s->pairs && s->mode[i].re > 0;
  return twins;
}

/* Whether a component of a listed shape is out of phase with the component that is 1. */
static int has_phases(const lag_model *m, const Modes *s) {
  for (int k = 0; k < s->n && k < MOST_MODES; k++)
    for (int i = 0; i < m->nq + m->nz; i++) {
      double re = s->mode[k].shape_re[i], im = s->mode[k].shape_im[i];
      if (fabs(im) > 1e-9 * variable(m, i)->factor && fabs(im) > 1e-9 * hypot(re, im)) return 1;
    }
  return 0;
}

static void put_modes(FILE *f, const App *app, const Modes *s) {
  char text[300];
  int damped = 0;
  for (int i = 0; i < s->n; i++) damped |= s->mode[i].re != 0;
  put_reason(s, app->scene->model->flags, text, sizeof text);
  Line line = {
      f, fprintf(f, "%s%s:", verdicts[s->verdict].name, s->verdict >= LAG_GYROSCOPIC ? " by the linearisation" : ""),
      2};
  for (char *word = strtok(text, " "); word; word = strtok(NULL, " ")) put_word(&line, word);
  fprintf(f, "\n\nmode  %-*s  %-*s  %-*s", NUMBER, "rad/s", NUMBER, "Hz", NUMBER, "period [s]");
  if (damped) fprintf(f, "  %-*s  %-18s", NUMBER, "damping", "time to e [s]");
  fputs(" shape\n", f);
  for (int i = 0; i < s->n && i < MOST_MODES; i++) put_mode(f, app->scene->model, &s->mode[i], i, damped);
  if (s->n > MOST_MODES) fprintf(f, "(and %d more; --json has all)\n", s->n - MOST_MODES);
  if (has_twins(s)) fputs("a mode that grows stands for two: another decays as fast\n", f);
  if (has_phases(app->scene->model, s)) fputs("a@p: amplitude a, p degrees ahead\n", f);
}

/* Prints the table of modes, text of 118 columns. */
static void put_text(FILE *f, const App *app, const Equilibrium *r, const Modes *s, const Amplitudes *bends) {
  const char *note = caution_of(app, r);
  put_equilibrium(f, app, r, s);
  if (note) fprintf(f, "note: %s\n", note);
  put_modes(f, app, s);
  if (bends->bend) lag_app_put_amplitudes(f, app->scene->model, s, s->n < MOST_MODES ? s->n : MOST_MODES, bends);
}

/* ---- JSON */

/* A JSON object of a state in declared units; with im a mode shape, entries [re, im]. */
static void json_vector(Json *j, const char *name, const lag_model *m, const double *re, const double *im) {
  JSON_EACH(j, name, '{', i, m->nq + m->nz) {
    const lag_var *v = variable(m, i);
    if (im) {
      lag_json_row(j, v->name, 2, (const double[]){re[i] / v->factor, im[i] / v->factor});
    } else {
      lag_json_number(j, v->name, (re[i] - v->offset) / v->factor);
    }
  }
}

static void json_modes(FILE *f, const App *app, const Equilibrium *r, const Modes *s, const Amplitudes *bends) {
  const lag_model *m = app->scene->model;
  char text[300];
  Json j = lag_app_json(app, f);
  put_reason(s, app->scene->model->flags, text, sizeof text);
  lag_json_strings(&j, {"status", "ok"}, {"verdict", verdicts[s->verdict].name}, {"reason", text},
                       {"note", caution_of(app, r)});
  lag_json_count(&j, "steps", r->steps);
  json_vector(&j, "start", m, r->start, NULL);
  json_vector(&j, s->steady ? "steady_motion" : "equilibrium", m, r->found, NULL);
  if (s->steady) {
    Rates rates = steady_rates(m, r);
    JSON_EACH(&j, "velocity", '{', i, rates.n)
      lag_json_number(&j, variable(m, i)->name, rates.of[i] / variable(m, i)->factor);
  }
  lag_json_truth(&j, "pairs", s->pairs != 0);
  JSON_OBJECTS(&j, "modes", i, s->n) {
    const Mode *k = &s->mode[i];
    lag_json_numbers(&j, {"re", k->re}, {"im", k->im});
    lag_json_truth(&j, "free", k->free != 0);
    lag_json_count(&j, "repeats", k->repeats);
    json_vector(&j, "shape", m, k->shape_re, k->shape_im);
    if (bends->bend) lag_app_json_amplitude(&j, m, &bends->bend[i]);
  }
  if (bends->bend) lag_app_json_couplings(&j, m, s, bends);
  lag_json_close(&j);
}

/* ---- The command */

static void json_none(const App *app) {
  if (!app->args.json) return;
  Json j = lag_app_json(app, stdout);
  lag_json_string(&j, "status", app->args.steady ? "no steady motion" : "no equilibrium");
  lag_json_close(&j);
}

/* Message of a search that found none near the start. */
static int none_near(const App *app) {
  json_none(app);
  if (!app->args.steady)
    lag_app_error(&app->args,
                  "no equilibrium found near the start of scene %s: start near one: name=VALUE; for a motion that runs "
                  "steadily, as a wheel that rolls, write --steady",
                  app->scene->name);
  else
    lag_app_error(&app->args,
                  "no steady motion found near the start of scene %s: one along whose path nothing changes but "
                  "coordinates that run at constant rates%s; start near one: name=VALUE",
                  app->scene->name,
                  app->scene->model->nq ? ", or turn together"
                                        : " (a circle in x and y is found in polar coordinates)");
  return EXIT_RUN;
}

/* Whether a steady motion is found from the scene's start, where no rest is. */
static int runs_steadily(const App *app) {
  Equilibrium rest = {0};
  SteadyMotion steady = {0};
  int found = lag_steady_find(&steady, &rest, app->sim, app->extras.algebra, 1) > 0;
  lag_steady_free(&steady);
  lag_equilibrium_free(&rest);
  return found;
}

static int not_found(const App *app, const Equilibrium *r) {
  const lag_model *m = app->scene->model;
  if (runs_steadily(app)) {
    json_none(app);
    return lag_app_no_result(
        &app->args,
        "no equilibrium found from the start of scene %s, but a motion that runs steadily, along which only "
        "cyclic coordinates change: write --steady",
        app->scene->name);
  }
  int i = r->worst, nq = m->nq, at = nq + i;
  const lag_var *v = variable(m, i);
  char unit[80] = "";
  if (v->unit[0]) snprintf(unit, sizeof unit, " %s/s%s", v->unit, i < nq ? "^2" : "");
  json_none(app);
  if (r->away)
    lag_app_error(&app->args,
                  "no equilibrium found from the start of scene %s: forces only vanish at infinity. Where the model "
                  "has one, start near it: %s=VALUE",
                  app->scene->name, v->name);
  else
    lag_app_error(
        &app->args,
        "no equilibrium found in %d steps from the start of scene %s: at %s = %.6g%s%s, %s%s is still %.6g%s%s. A "
        "force "
        "that vanishes nowhere has none: add a force that balances it, such as a spring; where it vanishes, start near "
        "there: %s=VALUE",
        r->steps, app->scene->name, v->name, (r->y[i < nq ? i : at] - v->offset) / v->factor, v->unit[0] ? " " : "",
        v->unit, v->name, i < nq ? "''" : "'", r->rate[at] / v->factor, unit,
        r->pole ? "; the mass matrix is nearly singular there: other coordinates may help" : "", v->name);
  return EXIT_RUN;
}

/* Message for a failure of the analysis; returns the exit status. */
static int analysis_failed(const App *app, int rc, const char *where) {
  const Args *a = &app->args;
  const char *form = app->scene->model->flags & LAG_FIRST_ORDER ? "two-form of L" : "mass matrix";
  if (rc == LAG_ENOMEM) return lag_app_error(a, "out of memory");
  if (rc == LAG_ESINGULAR && app->scene->model->constraints)
    lag_app_error(a,
                  "the constraints are dependent, or nearly, %s and independent beside it, as bars in one line are, so "
                  "small motion has no one tangent "
                  "space; another start: name=VALUE",
                  where);
  else if (rc == LAG_ESINGULAR)
    lag_app_error(a, "the %s is singular %s: choose other coordinates there, or another start: name=VALUE", form,
                  where);
  else
    lag_app_error(a, "%s %s; another start: name=VALUE",
                  rc == LAG_EMETHOD ? "the eigenvalues do not converge" : "the model has no values", where);
  return EXIT_RUN;
}

/* Whether all contacts are open at y, where small motion does not feel them. */
static int check_open(const App *app, const double *y, const char *where) {
  const lag_model *m = app->scene->model;
  int k = lag_contact_not_open(app->sim, app->scene->t0, y);
  if (k == -1) return 0;
  if (k < 0) return lag_app_error(&app->args, "the contacts have no values %s; another start: name=VALUE", where);
  int ends = m->contacts[k].conditional; /* it is a constraint with `while` */
  return lag_app_error(&app->args, "%s %s %s %s: small motion leaves it on one side only, and has no modes; "
                       "start where it %s: name=VALUE", ends ? "constraint" : "contact",
                       m->constraints->of[m->contacts[k].constraint].name, ends ? "acts" : "is closed", where,
                       ends ? "does not act" : "is open");
}

/* Finds the rest, or steady motion, next to the start, whose state is r->y. 0, or the exit status after a message. */
static int find_rest(const App *app, Equilibrium *r, SteadyMotion *steady) {
  int tangent = in_tangent_space(app), rc = refuse(app);
  rc = rc ? rc : check_open(app, app->sim->now, "at the start");
  if (rc) return rc;
  rc = tangent ? lag_steady_find(steady, r, app->sim, app->extras.algebra, app->args.steady)
               : lag_equilibrium_find(r, app->sim, app->extras.algebra);
  if (rc == 0) return tangent ? none_near(app) : not_found(app, r);
  if (rc < 0) return analysis_failed(app, rc, "at the start");
  return check_open(app, r->y, "at the equilibrium next to the start");
}

int lag_app_rest(App *app, double *y) {
  Equilibrium rest = {0};
  SteadyMotion steady = {0};
  int rc = find_rest(app, &rest, &steady);
  if (rc == 0) memcpy(y, rest.y, (size_t)app->sim->pb.n * sizeof *y);
  lag_steady_free(&steady);
  lag_equilibrium_free(&rest);
  return rc;
}

static int report(const App *app, Equilibrium *r, const Modes *s) {
  Amplitudes bends = {0};
  int rc = app->args.amplitude ? lag_app_find_amplitudes(app, r, s, &bends) : 0;
  if (rc == 0 && app->args.json) json_modes(stdout, app, r, s, &bends);
  else if (rc == 0) put_text(stdout, app, r, s, &bends);
  free(bends.bend);
  return rc;
}

/* Whether --steady found the equilibrium of `lagc modes` without it, of coordinates alone; *r := that, so that its
 * stability is judged once. */
static int is_equilibrium(const App *app, Equilibrium *r) {
  const lag_problem *pb = &app->sim->pb;
  Equilibrium rest = {0};
  int same = pb->nq > 0 && pb->n == 2 * pb->nq && !pb->model->constraints;
  for (int i = pb->nq; i < pb->n && same; i++) same = r->y[i] == 0;
  same = same && lag_equilibrium_find(&rest, app->sim, app->extras.algebra) > 0;
  for (int i = 0; i < pb->nq && same; i++) same = fabs(rest.y[i] - r->y[i]) < 1e-6 * r->scale[i];
  Equilibrium other = same ? *r : rest;
  if (same) *r = rest;
  lag_equilibrium_free(&other);
  return same;
}

static int analyse(const App *app, Equilibrium *r, SteadyMotion *steady, Modes *s) {
  int tangent = in_tangent_space(app), moving = app->args.steady, rc = find_rest(app, r, steady);
  if (rc) return rc;
  if (moving && is_equilibrium(app, r)) tangent = 0;
  rc = tangent ? lag_steady_modes(s, steady, r) : lag_modes_find(s, r, app->extras.algebra);
  if (rc) return analysis_failed(app, rc, moving ? "at the steady motion" : "at the equilibrium");
  if (app->args.amplitude && (tangent || moving))
    return lag_app_error(&app->args, "--amplitude is for modes about rest, of models without constraints");
  return report(app, r, s);
}

int lag_app_modes(App *app) {
  Equilibrium rest = {0};
  SteadyMotion steady = {0};
  Modes modes = {0};
  int rc = lag_app_set_up_start(app);
  if (rc == 0 && lag_sim_advance(app->sim, app->scene->t0))
    rc = lag_app_error(&app->args, "%s", lag_sim_message(app->sim));
  rc = rc ? rc : analyse(app, &rest, &steady, &modes);
  lag_modes_free(&modes);
  lag_steady_free(&steady);
  lag_equilibrium_free(&rest);
  return rc;
}
