/* Table of --modes: the equilibrium, its stability, and a line for each mode. Enters: the results of analysis/modes.h;
 * leaves: text of 118 columns. */
#include "app/modes.h"

#include <math.h>
#include <string.h>

enum { WIDE = 118, LISTED = 12, ALL_SHOWN = 6, MOST_MODES = 40, NUMBER = 13 };

/* ---- Families */

/* Consecutive members of one family, or a single variable. */
typedef struct Group {
  int first, count;
  char label[96];
} Group;

/* Whether a and b are members of one family: equal but for the index in brackets. */
static int same_family(const char *a, const char *b)
{
  const char *x = strchr(a, '['), *y = strchr(b, '['), *ax = x ? strchr(x, ']') : NULL, *by = y ? strchr(y, ']') : NULL;

  return ax && by && x - a == y - b && memcmp(a, b, (size_t)(x - a)) == 0 && strcmp(ax, by) == 0;
}

/* The group that begins at variable `first` of n. */
static Group group_at(const lag_model *m, int first, int n)
{
  Group g = {.first = first, .count = 1};
  const char *name = lag_modes_variable(m, first)->name, *last = name;

  while (first + g.count < n && same_family(name, lag_modes_variable(m, first + g.count)->name)) {
    last = lag_modes_variable(m, first + g.count++)->name;
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

/* A line of words that is wrapped at WIDE columns. */
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

/* text := a component, "1.5", or "1.5@-90": 90 degrees behind. Values below 1e-9 of `most` are shown as 0. */
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

/* A vector to show: values in SI; im may be NULL. */
typedef struct Vector {
  const lag_model *m;
  const double *re, *im;
  int state; /* 1: a state, shown with units and their offsets; 0: a change of state */
  int all;   /* 1: zero components are shown, too */
  double most; /* largest component */
} Vector;

static int units_differ(const lag_model *m)
{
  for (int i = 1; i < m->nq + m->nz; i++) {
    if (strcmp(lag_modes_variable(m, i)->unit, lag_modes_variable(m, 0)->unit) != 0) {
      return 1;
    }
  }
  return 0;
}

/* Component i in its declared unit. */
static double part(const double *x, const Vector *v, int i)
{
  const lag_var *var = lag_modes_variable(v->m, i);

  return x ? (x[i] - (v->state ? var->offset : 0)) / var->factor : 0;
}

static int is_zero(const Vector *v, const Group *g)
{
  for (int i = g->first; i < g->first + g->count; i++) {
    if (hypot(part(v->re, v, i), part(v->im, v, i)) > 1e-9 * v->most) {
      return 0;
    }
  }
  return 1;
}

/* Prints a group, "u[1..8]: 0.34 0.64 ..."; of a large family every k-th member. */
static void put_group(Line *l, const Vector *v, const Group *g)
{
  int every = g->count > LISTED ? (g->count + LISTED - 2) / (LISTED - 1) : 1;
  const char *unit = v->state || units_differ(v->m) ? lag_modes_variable(v->m, g->first)->unit : "";
  unit = strcmp(unit, "1") == 0 ? "" : unit;

  for (int i = 0; i < g->count; i += every) {
    char label[160] = "", value[64], word[300];
    int k = g->first + i, ends = i + every >= g->count;
    value_text(part(v->re, v, k), part(v->im, v, k), v->most, value, sizeof value);
    if (i == 0) {
      snprintf(label, sizeof label, every > 1 ? "%s (every %d): " : g->count > 1 ? "%s: " : "%s ", g->label, every);
    }
    snprintf(word, sizeof word, "%s%s%s%s", label, value, ends && unit[0] ? " " : "", ends ? unit : "");
    put_word(l, word);
  }
}

static void put_vector(Line *l, Vector v)
{
  int n = v.m->nq + v.m->nz, some = 0;

  for (int i = 0; i < n; i++) {
    v.most = fmax(v.most, hypot(part(v.re, &v, i), part(v.im, &v, i)));
  }
  for (int first = 0; first < n;) {
    Group g = group_at(v.m, first, n);
    first += g.count;
    if (!v.all && is_zero(&v, &g)) {
      continue;
    }
    l->column += fprintf(l->f, "%s", some++ ? "," : "");
    put_group(l, &v, &g);
  }
}

/* Index of the variable farthest from its start, relative to its scale; -1: none moved. */
static int farthest(const Equilibrium *r, const double *x)
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

static void put_equilibrium(FILE *f, const App *app, const Equilibrium *r, double *x)
{
  const lag_model *m = app->scene->model;
  Line line = {f, 0, 4};
  int far = 0, moving = 0;

  lag_modes_unknowns(r, x);
  far = farthest(r, x);
  for (int i = 0; i < m->nq; i++) {
    moving |= r->sim->now[m->nq + i] != 0;
  }
  fprintf(f, "%s: scene %s\nequilibrium: ", m->name, app->scene->name);
  if (far < 0) {
    fputs("the start itself", f);
  } else {
    const lag_var *v = lag_modes_variable(m, far);
    fprintf(f, "from the start %s moved by %.6g%s%s", v->name, (x[far] - r->start[far]) / v->factor, v->unit[0] ? " " : "", v->unit);
  }
  fprintf(f, "%s\n ", moving ? ", at rest" : "");
  put_vector(&line, (Vector){.m = m, .re = x, .state = 1, .all = 1});
  putc('\n', f);
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
  put_vector(&line, (Vector){model, m->shape_re, m->shape_im, 0, model->nq + model->nz <= ALL_SHOWN, 0});
  if (zero || m->repeats > 1) {
    char text[60];
    snprintf(text, sizeof text, m->repeats > 1 ? "(%d equal, too few shapes)" : m->free ? "(free)" : "(zero mode)", m->repeats);
    put_word(&line, text);
  }
  putc('\n', f);
}

/* Whether a listed mode stands for a pair, one that grows and one that decays as fast. */
static int has_twins(const Modes *s)
{
  int twins = 0;

  for (int i = 0; i < s->n && i < MOST_MODES; i++) {
    twins |= s->pairs && s->mode[i].re > 0;
  }
  return twins;
}

/* Whether a component of a listed shape is out of phase with the component that is 1. */
static int has_phases(const lag_model *m, const Modes *s)
{
  for (int k = 0; k < s->n && k < MOST_MODES; k++) {
    for (int i = 0; i < m->nq + m->nz; i++) {
      double re = s->mode[k].shape_re[i], im = s->mode[k].shape_im[i];
      if (fabs(im) > 1e-9 * lag_modes_variable(m, i)->factor && fabs(im) > 1e-9 * hypot(re, im)) {
        return 1;
      }
    }
  }
  return 0;
}

static void put_modes(FILE *f, const App *app, const Modes *s)
{
  char text[300];
  int damped = 0;

  for (int i = 0; i < s->n; i++) {
    damped |= s->mode[i].re != 0;
  }
  lag_modes_reason(s, text, sizeof text);
  Line line = {f, fprintf(f, "%s%s:", lag_verdict_name(s->verdict), s->verdict >= LAG_GYROSCOPIC ? " by the linearisation" : ""), 2};
  for (char *word = strtok(text, " "); word; word = strtok(NULL, " ")) {
    put_word(&line, word);
  }
  fprintf(f, "\n\nmode  %-*s  %-*s  %-*s", NUMBER, "rad/s", NUMBER, "Hz", NUMBER, "period [s]");
  if (damped) {
    fprintf(f, "  %-*s  %-18s", NUMBER, "damping", "time to e [s]");
  }
  fputs(" shape\n", f);
  for (int i = 0; i < s->n && i < MOST_MODES; i++) {
    put_mode(f, app->scene->model, &s->mode[i], i, damped);
  }
  if (s->n > MOST_MODES) {
    fprintf(f, "(and %d more; --json has all)\n", s->n - MOST_MODES);
  }
  if (has_twins(s)) {
    fputs("a mode that grows stands for two: another decays as fast\n", f);
  }
  if (has_phases(app->scene->model, s)) {
    fputs("a@p: amplitude a, p degrees ahead\n", f);
  }
}

void lag_modes_text(FILE *f, const App *app, const Equilibrium *r, const Modes *s, double *x)
{
  const char *note = lag_modes_caution(app, r);

  put_equilibrium(f, app, r, x);
  if (note) {
    fprintf(f, "note: %s\n", note);
  }
  put_modes(f, app, s);
}
