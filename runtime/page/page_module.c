/* The WebAssembly module of live pages: the functions of lag.h that take structs, for a page's script, which calls
 * the others (lag_item, lag_sim_set, lag_sim_advance, ..) as they are. Enters: numbers and names; leaves: numbers and
 * texts. Nothing here is called from elsewhere, and the module has no main. */
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "evaluator/evaluator.h"
#include "lag.h"

/* A text for the script, valid until the next call that returns one. */
static char text[512];

static const char *why = "";

/* The program of bytes[n], which `lagc page` wrote; NULL: page_why. */
const lag_program *page_program(const unsigned char *bytes, int n) { return lag_program_read(bytes, (size_t)n, &why); }
const char *page_why(void) { return why; }

/* Shape i of the scene's drawing, its fields behind tabs: kind, role, text, count, and the outputs a, b, size, turn;
 * NULL past the last. */
const char *page_shape(const lag_scene *scene, int i) {
  if (i < 0 || i >= scene->nshapes) return NULL;
  const lag_shape *s = &scene->shapes[i];
  int n = snprintf(text, sizeof text, "%s\t%s\t%.200s\t%d", s->kind, s->role, s->text ? s->text : "", s->count);
  for (int k = 0; k < 13; k++)
    n += snprintf(text + n, sizeof text - (size_t)n, "\t%d",
                  k < 3 ? s->a[k] : k < 6 ? s->b[k - 3] : k < 9 ? s->size[k - 6] : s->turn[k - 9]);
  return text;
}
/* Outputs that only the drawing has, the last ones. */
int page_drawn(const lag_scene *scene) { return scene->ndrawn; }

/* The scene's tolerance, and its method's step [s]; 0: it says none. */
double page_tolerance(const lag_scene *scene) { return scene->tolerance; }
double page_step(const lag_scene *scene) {
  for (int i = 0; i < scene->noptions; i++)
    if (strcmp(scene->options[i].name, "step") == 0) return scene->options[i].value;
  return 0;
}

/* Sets a method by name, with a step [s] where it has that option and step > 0, and a tolerance; an empty name: the
 * scene's, with its other options, or the one of `lagc run` for a run until `until`. Returns LAG_OK or a status with
 * a message (lag_sim_message). */
int page_set_method(lag_sim *sim, const char *name, double tol, double step, double until) {
  enum { MOST = 8 };
  const lag_scene *scene = lag_sim_scene(sim);
  int own = scene->method && (!*name || strcmp(name, scene->method) == 0), n = 0;
  lag_option option[MOST + 1];
  for (int i = 0; own && i < scene->noptions && n < MOST; i++)
    if (!(step > 0) || strcmp(scene->options[i].name, "step") != 0) option[n++] = scene->options[i];
  if (step > 0) option[n++] = (lag_option){.name = "step", .value = step};
  int rc = tol > 0 ? lag_sim_set_tolerance(sim, tol) : LAG_OK;
  rc = rc ? rc : lag_sim_balance(sim);
  if (rc) return rc;
  if (!own && !*name) return lag_sim_choose_method(sim, until, 0, option, n, text, sizeof text);
  return lag_sim_set_method(sim, lag_find_method(own ? scene->method : name), option, n);
}

const char *page_method(const lag_sim *sim) {
  const lag_method *m = lag_sim_method(sim);
  return m ? m->name : "";
}

/* Whether a method takes equal steps, so that a step is asked for and not a tolerance. */
int page_takes_steps(const char *name) {
  const lag_method *m = lag_find_method(name);
  return m && !(m->flags & LAG_METHOD_ADAPTIVE);
}

/* Declared sign of parameter i, as in lag_model.h; 0 past the last. */
int page_sign(const lag_scene *scene, int i) { return i >= 0 && i < scene->model->np ? scene->model->p[i].sign : 0; }

/* Of charge k: 0 its value, 1 its drift, relative, 2 its unit's drift, 3 the work that was taken off, 4 its trend. */
double page_charge(lag_sim *sim, int k, int what) {
  lag_charge_stats c = {.drift = NAN};
  if (k >= lag_sim_ncharges(sim)) return NAN;
  lag_sim_charge(sim, k, &c);
  const double of[] = {c.now, c.drift, c.absolute, c.work, c.trend};
  return what >= 0 && what < (int)(sizeof of / sizeof *of) ? of[what] : NAN;
}

/* Name and SI unit of charge k, a tab between them; NULL past the last. */
const char *page_charge_name(lag_sim *sim, int k) {
  lag_charge_stats c = {.name = "", .unit = ""};
  if (k < 0 || k >= lag_sim_ncharges(sim)) return NULL;
  lag_sim_charge(sim, k, &c);
  snprintf(text, sizeof text, "%s\t%s", c.name ? c.name : "", c.unit ? c.unit : "");
  return text;
}

/* 0: steps, 1: right-hand sides, 2: events, 3: the largest residual of a constraint [SI]. */
double page_count(lag_sim *sim, int what) {
  lag_stats s = {0};
  lag_sim_stats(sim, &s);
  const double of[] = {(double)s.steps, (double)s.rhs_calls, (double)s.events, s.constraint};
  return what >= 0 && what < (int)(sizeof of / sizeof *of) ? of[what] : NAN;
}

/* Name of output i, or of component i of [q|v|z], with its unit behind a tab; NULL past the last. */
static const char *joined(double found, const char *name, const char *unit) {
  snprintf(text, sizeof text, "%s\t%s", name, unit);
  return isnan(found) ? NULL : text;
}
const char *page_output(const lag_sim *sim, int i) {
  char name[200] = "", unit[100] = "";
  double factor = i < lag_sim_noutputs(sim) ? lag_sim_output_info(sim, i, name, sizeof name, unit, sizeof unit) : NAN;
  return joined(factor, name, unit);
}
const char *page_state(const lag_sim *sim, int i) {
  char name[200] = "", unit[100] = "";
  double factor = lag_sim_state_info(sim, i, name, sizeof name, unit, sizeof unit);
  return joined(factor, name, unit);
}

/* A simulation of a scene that begins at time t [s], NaN: where the scene does. Free with page_end. */
lag_sim *page_begin(const lag_scene *scene, double t) {
  lag_scene *own = malloc(sizeof *own);
  if (!own) return NULL;
  *own = *scene;
  own->nmonitors = 0; /* limits for the scene's own method */
  if (!isnan(t)) own->t0 = t;
  lag_sim *sim = lag_sim_new(own);
  if (!sim) free(own);
  return sim;
}
/* lag_sim_advance for so many seconds at most: after them LAG_INTERRUPTED, at the end of a step. */
int page_advance(lag_sim *sim, double t, double seconds) {
  static double until;
  until = lag_clock_seconds() + seconds;
  lag_sim_on_step(sim, lag_time_is_up, &until);
  return lag_sim_advance(sim, t);
}
void page_end(lag_sim *sim) {
  const lag_scene *own = lag_sim_scene(sim);
  lag_sim_free(sim);
  free((void *)(uintptr_t)own);
}

/* hypot with the digits of glibc: nearly always the nearest double. wasi-libc's is off by one in the last place.
 * Borges, An improved algorithm for hypot(a, b), arXiv:1904.09481. */
double hypot(double x, double y) {
  double a = fmax(fabs(x), fabs(y)), b = fmin(fabs(x), fabs(y)), scale = 1;
  if (isinf(x) || isinf(y)) return INFINITY;
  if (isnan(x) || isnan(y)) return NAN;
  if (b <= a * (DBL_EPSILON / 2)) return a + b;
  if (a > 0x1p+511) scale = 0x1p+600;
  else if (b < 0x1p-459) scale = 0x1p-600;
  a /= scale;
  b /= scale;
  double h = sqrt(a * a + b * b), d, t1, t2;
  if (h <= 2 * b) {
    d = h - b;
    t1 = a * (2 * d - a);
    t2 = (d - 2 * (a - b)) * d;
  } else {
    d = h - a;
    t1 = 2 * d * (a - 2 * b);
    t2 = (4 * d - b) * b + d * d;
  }
  return (h - (t1 + t2) / (2 * h)) * scale;
}
