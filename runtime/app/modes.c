/* --modes: the equilibrium next to the start, its stability, and small motion about it. Enters: a simulation at its
 * start; leaves: a table for people, or one JSON object. */
#include "analysis/modes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"

enum { WIDE = 118, LISTED = 12, MOST_MODES = 40 };

static const lag_var *variable(const lag_model *m, int i)
{
  return i < m->nq ? &m->q[i] : &m->z[i - m->nq];
}

/* ---- What cannot be treated */

/* The first input whose value changes in time; NULL when none does. */
static const char *changing_input(const App *app)
{
  lag_problem *pb = &app->sim->pb;
  const lag_model *m = pb->model;
  static const double times[] = {0, 0.1234567, 0.5772157, 2.7182818};
  double first[64];

  for (size_t k = 0; k < sizeof times / sizeof *times; k++) {
    if (lag_inputs(pb, app->scene->t0 + times[k])) {
      return NULL;
    }
    for (int i = 0; i < m->nu && i < 64; i++) {
      if (k > 0 && pb->u[i] != first[i]) {
        return m->u[i].name;
      }
      first[i] = k > 0 ? first[i] : pb->u[i];
    }
  }
  return NULL;
}

static int refuse(const App *app)
{
  const lag_model *m = app->scene->model;
  const Args *a = &app->args;
  const char *source = app->program->source;

  if (!app->extras.algebra) {
    return app_error(a, "this simulator was built without GSL, which finds roots and eigenvalues; install GSL (libgsl-dev), make "
                        "lagc anew, and leave out --no-gsl");
  }
  if (!m->linear) {
    return app_error(a, "this simulator was built without the model's linearisation; write lagc modes %s, or build it with: lagc "
                        "build %s --with linear", source, source);
  }
  if (m->nq + m->nz == 0) {
    return app_error(a, "model %s has neither coordinates nor states", m->name);
  }
  if (m->flags & LAG_AUTONOMOUS) {
    return 0;
  }
  if (!(m->flags & LAG_TIMELESS)) {
    return app_error(a, "scene %s depends on time: t stands in its equations, so nothing stays at rest; take a scene without "
                        "what drives it, or put a parameter in place of t", app->scene->name);
  }
  const char *input = changing_input(app);
  return input ? app_error(a, "scene %s depends on time by its input %s, so nothing stays at rest; hold it: %s=0", app->scene->name,
                           input, input)
               : 0;
}

/* ---- Families */

/* Members first, first + 1, ... of one family; or a single variable. */
typedef struct Group {
  int first, count;
  char label[96];
} Group;

/* Whether b follows a in its family: alike but for the numbers in brackets. */
static int same_family(const char *a, const char *b)
{
  const char *x = strchr(a, '['), *y = strchr(b, '['), *ax = x ? strchr(x, ']') : NULL, *by = y ? strchr(y, ']') : NULL;

  return ax && by && x - a == y - b && memcmp(a, b, (size_t)(x - a)) == 0 && strcmp(ax, by) == 0;
}

/* The group that begins at `first`, of n variables. */
static Group group_at(const lag_model *m, int first, int n)
{
  Group g = {.first = first, .count = 1};
  const char *name = variable(m, first)->name, *last = name;

  while (first + g.count < n && same_family(name, variable(m, first + g.count)->name)) {
    last = variable(m, first + g.count++)->name;
  }
  const char *from = strchr(name, '['), *to = strchr(last, '[');
  if (g.count == 1 || !from || !to) {
    snprintf(g.label, sizeof g.label, "%s", name);
  } else {
    const char *end = strchr(from, ']'), *stop = strchr(to, ']');
    snprintf(g.label, sizeof g.label, "%.*s..%.*s%s", (int)(end - name), name, (int)(stop - to - 1), to + 1, end);
  }
  return g;
}

/* ---- Text */

/* Words at the end of a line that is not too long. */
typedef struct Line {
  FILE *f;
  int column, indent;
} Line;

static void put_word(Line *l, const char *word)
{
  int n = (int)strlen(word);

  if (l->column + 1 + n > WIDE) {
    fprintf(l->f, "\n%*s", l->indent, "");
    l->column = l->indent;
  }
  l->column += fprintf(l->f, " %s", word);
}

/* "1.5"; "1.5@-90": 90 degrees behind. What is below 1e-9 of `most` is 0. */
static void value_text(double re, double im, double most, char *text, size_t n)
{
  double size = hypot(re, im), phase = atan2(im, re) * 180 / acos(-1);

  if (!(size > 1e-9 * most)) {
    snprintf(text, n, "0");
  } else if (fabs(im) <= 1e-9 * size) {
    snprintf(text, n, "%.6g", re);
  } else {
    snprintf(text, n, "%.6g@%.4g", size, phase);
  }
}

/* x[n] in SI, by families, in declared units; im may be NULL. A unit is said when others are there, too. */
static void put_vector(Line *l, const lag_model *m, const double *re, const double *im, int units)
{
  int n = m->nq + m->nz;

  for (int first = 0; first < n;) {
    Group g = group_at(m, first, n);
    const lag_var *v = variable(m, first);
    int every = g.count > LISTED ? (g.count + LISTED - 2) / (LISTED - 1) : 1;
    const char *comma = first + g.count < n ? "," : "";
    double most = 0;
    char text[300], value[64];
    for (int i = 0; i < n; i++) {
      most = fmax(most, hypot(re[i], im ? im[i] : 0) / variable(m, i)->factor);
    }
    for (int i = 0; i < g.count; i += every) {
      int k = first + i, ends = i + every >= g.count;
      char label[160] = "";
      value_text(re[k] / v->factor, im ? im[k] / v->factor : 0, most, value, sizeof value);
      if (i == 0) {
        snprintf(label, sizeof label, every > 1 ? "%s (every %d): " : g.count > 1 ? "%s: " : "%s ", g.label, every);
      }
      snprintf(text, sizeof text, "%s%s%s%s%s", label, value, ends && units && v->unit[0] ? " " : "", ends && units ? v->unit : "",
               ends ? comma : "");
      put_word(l, text);
    }
    first += g.count;
  }
}

static int units_differ(const lag_model *m)
{
  for (int i = 1; i < m->nq + m->nz; i++) {
    if (strcmp(variable(m, i)->unit, variable(m, 0)->unit) != 0) {
      return 1;
    }
  }
  return 0;
}

/* The first [nq + nz] of a state are coordinates, the rest states: y without velocities. */
static void unknowns(const Rest *r, const double *y, double *x)
{
  int nq = r->sim->pb.nq;

  for (int i = 0; i < r->n; i++) {
    x[i] = y[i < nq ? i : nq + i];
  }
}

/* The coordinate that is farthest from its start, by scale; -1: none moved. */
static int farthest(const Rest *r, const double *x)
{
  int best = -1;
  double most = 0;

  for (int i = 0; i < r->n; i++) {
    double d = fabs(x[i] - r->start[i]) / r->scale[i];
    if (d > most) {
      most = d;
      best = i;
    }
  }
  return most > 1e-12 ? best : -1;
}

static void put_equilibrium(FILE *f, const App *app, const Rest *r, double *x)
{
  const lag_model *m = app->scene->model;
  Line line = {f, 0, 4};
  int far = 0, moving = 0;

  unknowns(r, r->y, x);
  far = farthest(r, x);
  for (int i = 0; i < m->nq; i++) {
    moving |= r->sim->now[m->nq + i] != 0;
  }
  fprintf(f, "%s: scene %s\nequilibrium: ", m->name, app->scene->name);
  if (far < 0) {
    fputs("the start itself", f);
  } else {
    const lag_var *v = variable(m, far);
    fprintf(f, "%d steps from the start, %s by %.6g%s%s", r->steps, v->name, (x[far] - r->start[far]) / v->factor,
            v->unit[0] ? " " : "", v->unit);
  }
  fprintf(f, "%s\n ", moving ? ", at rest" : "");
  put_vector(&line, m, x, NULL, 1);
  putc('\n', f);
}

/* Why the verdict is what it is. */
static void reason(const Modes *s, char *text, size_t n)
{
  const Mode *m = s->mode;
  int last = s->n - 1;

  switch (s->verdict) {
  case LAG_UNSTABLE: {
    double rate = 0;
    int at = 0;
    for (int i = 0; i < s->n; i++) {
      if (m[i].re > rate) {
        rate = m[i].re;
        at = i;
      }
    }
    snprintf(text, n, "mode %d grows by a factor of e in %.6g s", at + 1, 1 / rate);
    return;
  }
  case LAG_DECAYS: {
    double slowest = m[last].re;
    for (int i = 0; i < s->n; i++) {
      slowest = fmax(slowest, m[i].re);
    }
    snprintf(text, n, "every mode decays, the slowest by a factor of e in %.6g s", -1 / slowest);
    return;
  }
  case LAG_MINIMUM:
    snprintf(text, n, "the energy, which is conserved, has a minimum here (Lagrange, Dirichlet)");
    return;
  case LAG_NEUTRAL:
    snprintf(text, n, "no force along the zero modes%s; %s", s->drifts ? ", where a push goes on for ever" : "",
             s->lowering == 0 && s->pairs ? "the energy has a minimum in all other directions" : "all other modes decay");
    return;
  case LAG_GYROSCOPIC:
    snprintf(text, n, "all modes oscillate, but the energy falls in %d direction%s: forces at right angles to the motion alone hold "
                      "it, and damping in all directions would make it unstable (Thomson, Tait, Chetaev)",
             s->lowering, s->lowering == 1 ? "" : "s");
    return;
  case LAG_FLAT:
    snprintf(text, n, "a zero mode: to second order there is no force along it, and what comes after is not linear");
    return;
  case LAG_DEFECTIVE:
    snprintf(text, n, "a multiple frequency with too few shapes: small motion grows in proportion to time, until what is not "
                      "linear counts");
    return;
  case LAG_CENTRE:
    snprintf(text, n, "some modes neither grow nor decay, and no energy is known that is conserved and has a minimum here");
    return;
  }
}

static void put_number(FILE *f, int width, double x)
{
  if (isfinite(x)) {
    fprintf(f, "  %-*.7g", width, x);
  } else {
    fprintf(f, "  %-*s", width, "-");
  }
}

static void put_mode(FILE *f, const lag_model *model, const Mode *m, int k, int damped)
{
  int oscillates = m->im > 0, zero = m->re == 0.0 && m->im == 0.0;
  double two_pi = 2 * acos(-1), w = oscillates || zero ? m->im : NAN;
  Line line = {f, 0, 0};

  line.column = fprintf(f, "%4d", k + 1) + 3 * 14 + (damped ? 14 + 20 : 0);
  put_number(f, 12, w);
  put_number(f, 12, w / two_pi);
  put_number(f, 12, oscillates ? two_pi / w : NAN);
  if (damped) {
    char text[40];
    put_number(f, 12, !oscillates ? NAN : m->re == 0.0 ? 0 : -m->re / hypot(m->re, m->im));
    snprintf(text, sizeof text, m->re == 0.0 ? "-" : "%s %.7g", m->re > 0 ? "grows" : "decays", 1 / fabs(m->re));
    fprintf(f, "  %-18s", text);
  }
  line.indent = line.column;
  put_vector(&line, model, m->shape_re, m->shape_im, units_differ(model));
  if (zero || m->repeats > 1) {
    char text[60];
    snprintf(text, sizeof text, m->repeats > 1 ? "(%d equal, too few shapes)" : m->free ? "(free)" : "(zero mode)", m->repeats);
    put_word(&line, text);
  }
  putc('\n', f);
}

static void put_modes(FILE *f, const App *app, const Modes *s)
{
  char text[300];
  int damped = 0;

  for (int i = 0; i < s->n; i++) {
    damped |= s->mode[i].re != 0;
  }
  reason(s, text, sizeof text);
  Line line = {f, fprintf(f, "%s%s:", lag_verdict_name(s->verdict), s->verdict >= LAG_GYROSCOPIC ? " by the linearisation" : ""), 2};
  for (char *word = strtok(text, " "); word; word = strtok(NULL, " ")) {
    put_word(&line, word);
  }
  fprintf(f, "\n\nmode  rad/s         Hz            period [s]  %s shape\n", damped ? "  damping       time to e [s]     " : "");
  for (int i = 0; i < s->n && i < MOST_MODES; i++) {
    put_mode(f, app->scene->model, &s->mode[i], i, damped);
  }
  if (s->n > MOST_MODES) {
    fprintf(f, "(and %d more; --json has all)\n", s->n - MOST_MODES);
  }
}

/* ---- JSON */

static void json_vector(FILE *f, const lag_model *m, const double *re, const double *im)
{
  putc('{', f);
  for (int i = 0; i < m->nq + m->nz; i++) {
    const lag_var *v = variable(m, i);
    fputs(i ? ", " : "", f);
    json_string(f, v->name);
    fputs(im ? ": [" : ": ", f);
    json_number(f, re[i] / v->factor);
    if (im) {
      fputs(", ", f);
      json_number(f, im[i] / v->factor);
      putc(']', f);
    }
  }
  putc('}', f);
}

static void json_head(FILE *f, const App *app, const char *status)
{
  fputs("{\"model\": ", f);
  json_string(f, app->scene->model->name);
  fputs(", \"scene\": ", f);
  json_string(f, app->scene->name);
  fputs(", \"status\": ", f);
  json_string(f, status);
}

static void json_modes(FILE *f, const App *app, const Rest *r, const Modes *s, double *x)
{
  const lag_model *m = app->scene->model;
  char text[300];

  reason(s, text, sizeof text);
  json_head(f, app, "ok");
  fputs(", \"verdict\": ", f);
  json_string(f, lag_verdict_name(s->verdict));
  fputs(", \"reason\": ", f);
  json_string(f, text);
  fprintf(f, ", \"steps\": %d, \"start\": ", r->steps);
  json_vector(f, m, r->start, NULL);
  fputs(", \"equilibrium\": ", f);
  unknowns(r, r->y, x);
  json_vector(f, m, x, NULL);
  fprintf(f, ", \"pairs\": %s, \"modes\": [", s->pairs ? "true" : "false");
  for (int i = 0; i < s->n; i++) {
    const Mode *k = &s->mode[i];
    fputs(i ? ", {\"re\": " : "{\"re\": ", f);
    json_number(f, k->re);
    fputs(", \"im\": ", f);
    json_number(f, k->im);
    fprintf(f, ", \"free\": %s, \"repeats\": %d, \"shape\": ", k->free ? "true" : "false", k->repeats);
    json_vector(f, m, k->shape_re, k->shape_im);
    putc('}', f);
  }
  fputs("]}\n", f);
}

/* ---- All of it */

/* Has a coordinate nearly lost its mass where the search ended? */
static int nearly_singular(const Rest *r)
{
  int nq = r->sim->pb.nq;
  double most = 0, least = HUGE_VAL;

  for (int i = 0; i < nq; i++) {
    double m = fabs(r->M[i * nq + i]) * r->scale[i] * r->scale[i];
    most = fmax(most, m);
    least = fmin(least, m);
  }
  return nq > 0 && least < 1e-12 * most;
}

static int not_found(const App *app, const Rest *r)
{
  const lag_model *m = app->scene->model;
  int i = r->worst, nq = m->nq, at = i < nq ? nq + i : nq + i;
  const lag_var *v = variable(m, i);
  char unit[80] = "";

  if (v->unit[0]) {
    snprintf(unit, sizeof unit, " %s/s%s", v->unit, i < nq ? "^2" : "");
  }
  if (app->args.json) {
    json_head(stdout, app, "no equilibrium");
    fputs("}\n", stdout);
  }
  if (r->away) {
    app_error(&app->args, "no equilibrium found from the start of scene %s: forces only fade, far away; another start: %s=VALUE",
              app->scene->name, v->name);
    return EXIT_RUN;
  }
  app_error(&app->args, "no equilibrium found in %d steps from the start of scene %s: at %s = %.6g%s%s, %s%s is still %.6g%s%s; another "
                        "start: %s=VALUE", r->steps, app->scene->name, v->name, r->y[i < nq ? i : nq + i] / v->factor,
            v->unit[0] ? " " : "", v->unit, v->name, i < nq ? "''" : "'", r->rate[at] / v->factor, unit,
            nearly_singular(r) ? "; the mass matrix is nearly singular there: other coordinates may help" : "", v->name);
  return EXIT_RUN;
}

/* What stopped it. */
static int failed(const App *app, int rc, const char *where)
{
  const Args *a = &app->args;

  if (rc == LAG_ENOMEM) {
    return app_error(a, "out of memory");
  }
  if (rc == LAG_ESINGULAR) {
    app_error(a, "the mass matrix is singular %s: choose other coordinates there, or another start: name=VALUE", where);
  } else {
    app_error(a, "%s %s; another start: name=VALUE", rc == LAG_EMETHOD ? "the eigenvalues do not converge" : "the model has no values", where);
  }
  return EXIT_RUN;
}

static int analyse(const App *app, Rest *r, Modes *s)
{
  int rc = lag_rest_find(r, app->sim, app->extras.algebra);

  if (rc == 0) {
    return not_found(app, r);
  }
  if (rc < 0) {
    return failed(app, rc, "at the start");
  }
  rc = lag_modes_find(s, r, app->extras.algebra);
  double *x = rc ? NULL : pool_doubles(&s->pool, (size_t)r->n);
  if (rc || !x) {
    return failed(app, rc ? rc : LAG_ENOMEM, "at the equilibrium");
  }
  if (app->args.json) {
    json_modes(stdout, app, r, s, x);
  } else {
    put_equilibrium(stdout, app, r, x);
    put_modes(stdout, app, s);
  }
  return fflush(stdout) ? app_error(&app->args, "cannot write standard output") : EXIT_FINE;
}

int app_modes(App *app)
{
  Rest rest = {0};
  Modes modes = {0};
  int rc = app_choose_start(app);

  if (rc == 0 && lag_sim_advance(app->sim, app->scene->t0)) {
    rc = app_error(&app->args, "%s", lag_sim_message(app->sim));
  }
  rc = rc ? rc : refuse(app);
  rc = rc ? rc : analyse(app, &rest, &modes);
  lag_modes_free(&modes);
  lag_rest_free(&rest);
  return rc;
}
