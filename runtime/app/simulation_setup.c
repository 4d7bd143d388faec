/* Sets up the simulation: scene, method, tolerance, values. Enters: Args; leaves: app->scene and app->sim. Holds:
 * the command line overrides the scene; scenes, methods and effects missing in this build are refused with the
 * command that builds them. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "io/visible.h"
#include "core/core.h"
#include "numeric/option_range.h"
#include "numeric/edit_distance.h"

static int no_scene(const App *app, const char *name) {
  const lag_program *p = app->program;
  lag_app_error(&app->args, "scene %s is not in this build. It holds:", name);
  for (int i = 0; i < p->nscenes; i++) fprintf(stderr, "  %s\n", p->scenes[i]->name);
  fprintf(stderr, "If %s has it, this builds and runs it: lagc run %s ", p->source, p->source);
  fput_visible(stderr, name, "");
  putc('\n', stderr);
  return EXIT_USAGE;
}

/* app->bare := the scene without monitors and closed forms. */
static const lag_scene *bare_scene(App *app, const lag_scene *scene) {
  app->bare = *scene;
  app->bare.nmonitors = app->bare.nexact = 0;
  return &app->bare;
}

static int choose_scene(App *app) {
  const lag_program *p = app->program;
  const char *name = app->resumed ? app->state.scene : app->args.scene;
  if (app->resumed && app->args.scene && strcmp(app->args.scene, name) != 0)
    return lag_app_error(&app->args, "%s was saved from scene %s, not %s", app->args.resume, name, app->args.scene);
  for (int i = 0; i < p->nscenes; i++)
    if (!name || strcmp(p->scenes[i]->name, name) == 0) {
      app->scene = p->scenes[i];
      app->whole = app->scene;
      if (lag_args_tangents(&app->args) || app->args.cost || app->args.reference || app->args.energy_error ||
          app->args.distance || app->args.cloud || app->compared) app->scene = bare_scene(app, app->scene);
      if (app->args.no_monitors) {
        app->unwatched = *app->scene;
        app->unwatched.nmonitors = 0;
        app->scene = &app->unwatched;
      }
      return 0;
    }
  return name ? no_scene(app, name) : lag_app_error(&app->args, "this program has no scenes");
}

int lag_app_no_span(const App *app) {
  return lag_app_error(&app->args,
                       "nothing to compute: the run begins and ends at t = %g s; write --until with another time",
                       app->scene->t0);
}

int lag_app_no_gsl(const App *app, const char *does) {
  return lag_app_error(&app->args,
                       "this simulator was built without GSL, which %s; install GSL (libgsl-dev), make lagc anew, and "
                       "leave out --no-gsl",
                       does);
}

App lag_app_like(const App *app) {
  return (App){.program = app->program, .extras = app->extras, .args = app->args, .last_row = NAN};
}

int lag_app_read_until(App *app) {
  enum { SPANS = 20 }; /* Lyapunov exponents are means over a long time, forwards */
  const Args *a = &app->args;
  const lag_scene *c = app->scene;
  double span = c->has_span ? c->t1 - c->t0 : 10;

  app->until = c->t0 + (a->lyapunov ? SPANS * fabs(span) : span);
  return !a->until || lag_args_number(a, "--until", a->until, a->lyapunov ? "--until 1000" : "--until 20", &app->until)
             ? 0
             : EXIT_USAGE;
}

const lag_method *lag_app_method_at(const App *app, int i) {
  return i < lag_nmethods                          ? lag_methods[i]
         : i - lag_nmethods < app->extras.nmethods ? app->extras.methods[i - lag_nmethods]
                                                   : NULL;
}

const lag_method *lag_app_find_method(const App *app, const char *name) {
  const lag_method *m = NULL;
  for (int i = 0; (m = lag_app_method_at(app, i)) != NULL && strcmp(m->name, name) != 0;) i++;
  return m;
}

/* A method's name and options while they are collected; strings point into `text`. */
typedef struct Choice {
  char text[512];
  const char *name;
  lag_option opt[MOST_OPTIONS + 1]; /* from the parentheses or the scene; --step */
  int n;
} Choice;

static char *trim(char *s) {
  s += strspn(s, " ");
  size_t n = strlen(s);
  while (n && s[n - 1] == ' ') s[--n] = '\0';
  return s;
}

/* Adds an option: its value is a decimal number, as in lag_args_number, or else a word. */
static void add_option(Choice *c, const char *name, const char *value) {
  lag_option *o = &c->opt[c->n++];
  *o = (lag_option){.name = name};
  if (!lag_args_decimal(value, &o->value)) o->text = value;
}

/* Refuses wrong step sizes; 0, a method's value for "not given", is wrong where it is given. */
static int check_steps(const App *app, const Choice *c) {
  for (int i = 0; i < c->n; i++) {
    const lag_option *o = &c->opt[i];
    const char *wrong = lag_is_step_option(o->name) && !o->text ? lag_step_error(app->sim, o->value) : NULL;
    if (wrong) {
      const char *example = strcmp(o->name, "step") == 0 ? "--step 1e-3" : "max_step=1e-3";
      return lag_app_error(&app->args, "%s %g: %s; write for example %s, or leave it out", o->name, o->value, wrong,
                           example);
    }
  }
  return 0;
}

/* Parses --method: "NAME" or "NAME(option = value, ...)". */
static int parse_method(const Args *a, Choice *c) {
  char *open, *close, *save = NULL;
  snprintf(c->text, sizeof c->text, "%s", a->method);
  c->name = c->text;
  if ((open = strchr(c->text, '(')) == NULL) return 0;
  close = strrchr(open, ')');
  if (!close || *trim(close + 1)) return lag_app_error(a, "--method %s: write NAME(option=value, ...)", a->method);
  *open = *close = '\0';
  c->name = trim(c->text);
  for (char *s = strtok_r(open + 1, ",", &save); s; s = strtok_r(NULL, ",", &save)) {
    char *eq = strchr(s, '=');
    if (!eq || c->n == MOST_OPTIONS - 1)
      return lag_app_error(a, "--method %s: write NAME(option=value, ...)", a->method);
    *eq = '\0';
    add_option(c, trim(s), trim(eq + 1));
  }
  return 0;
}

/* Suggests the nearest name, or the method whose description has the word. */
int lag_app_unknown_method(const App *app, const char *name) {
  const lag_method *m;
  lag_nearest near = {.name = name};
  for (int i = 0; (m = lag_app_method_at(app, i)) != NULL; i++) lag_try_nearest(&near, m->name);
  for (int i = 0; !near.best && (m = lag_app_method_at(app, i)) != NULL; i++)
    near.best = lag_text_has_word(m->doc, name) ? m->name : NULL;
  if (strncmp(name, "gsl-", 4) == 0 && strcmp(LAG_PRECISION, "double") != 0)
    return lag_app_error(
        &app->args,
        "method %s computes with doubles, this run in " LAG_PRECISION " precision; dop853 and taylor do, too", name);
  if (near.best)
    return lag_app_error(&app->args, "unknown method %s; did you mean %s? --method help lists them", name, near.best);
  return lag_app_error(&app->args,
                       "unknown method %s; --method help lists them, and without --method the run chooses one", name);
}

int lag_app_choose_automatically(App *app, const lag_option *opt, int n) {
  int tangents = lag_args_tangents(&app->args);
  int rc = lag_sim_choose_method(app->sim, app->until, tangents, opt, n, app->why, sizeof app->why);
  return rc ? lag_app_error(&app->args, "%s", lag_sim_message(app->sim)) : 0;
}

static int choose_method(App *app) {
  const Args *a = &app->args;
  Choice c = {.name = a->accuracy ? NULL : app->scene->method};
  int rc = a->method ? parse_method(a, &c) : 0;
  if (rc) return rc;
  const lag_method *m = c.name ? lag_app_find_method(app, c.name) : NULL;
  if (c.name && !m) return lag_app_unknown_method(app, c.name);
  if (c.name && app->scene->method && strcmp(app->scene->method, c.name) == 0 && c.n == 0)
    for (int i = 0; i < app->scene->noptions && c.n < MOST_OPTIONS - 1; i++) c.opt[c.n++] = app->scene->options[i];
  if (a->step) {
    lag_option *o = &c.opt[c.n++];
    *o = (lag_option){.name = "step"};
    if (!lag_args_number(a, "--step", a->step, "--step 1e-3", &o->value)) return EXIT_USAGE;
  }
  if ((rc = check_steps(app, &c)) != 0) return rc;
  if (!m) return lag_app_choose_automatically(app, c.opt, c.n);
  rc = lag_sim_set_method(app->sim, m, c.opt, c.n);
  app->refused = rc == LAG_EMETHOD;
  if (rc == 0 && a->tol && lag_equal_step(app->sim) > 0 && !a->quiet)
    fprintf(stderr, "%s: note: %s has a fixed step; --tol does not change it\n", a->self, m->name);
  return rc ? lag_app_error(a, "%s", lag_sim_message(app->sim)) : 0;
}

static int set_tolerance(App *app) {
  const Args *a = &app->args;
  double x;
  if (!a->tol) return 0;
  if (!lag_args_number(a, "--tol", a->tol, "--tol 1e-9", &x)) return EXIT_USAGE;
  return lag_sim_set_tolerance(app->sim, x) ? lag_app_error(a, "--tol: %s", lag_sim_message(app->sim)) : 0;
}

int lag_app_has_word(const char *words, const char *word, size_t n) {
  for (const char *s = words; s && *s; s += strspn(s, ", ")) {
    size_t length = strcspn(s, ", ");
    if (length == n && memcmp(s, word, n) == 0) return 1;
    s += length;
  }
  return 0;
}

int lag_app_set_value(App *app, const char *text) {
  const Args *a = &app->args;
  const char *eq = strchr(text, '='), *dot = memchr(text, '.', (size_t)(eq - text));
  char name[128], example[160];
  double x;
  snprintf(name, sizeof name, "%.*s", (int)(eq - text), text);
  if (dot && lag_app_has_word(app->program->effects, text, (size_t)(dot - text)) &&
      !lag_app_has_word(app->scene->model->effects, text, (size_t)(dot - text))) {
    return lag_app_error(
        a,
        "%s: effect %.*s is not in scene %s of this build; take a scene of %s that uses it, or write one: "
        "scene %s_%.*s { like %s; use %.*s }",
        name, (int)(dot - text), text, app->scene->name, app->program->source, app->scene->name, (int)(dot - text),
        text, app->scene->name, (int)(dot - text), text);
  }
  for (size_t k = 1; name[k - 1]; k++) /* a parameter, or a member or component of it */
    if (strchr("[.", name[k]) && lag_app_has_word(app->scene->model->fixed, name, k))
      return lag_app_error(
          a,
          "%s is a number in this program (--fix); this builds one that takes all values: lagc build %s -o SIMULATOR",
          name, app->program->source);
  snprintf(example, sizeof example, "%s=1.5", name);
  if (!lag_args_number(a, name, eq + 1, example, &x)) return EXIT_USAGE;
  return lag_sim_set(app->sim, name, x) ? lag_app_error(a, "%s", lag_sim_message(app->sim)) : 0;
}

/* Sets the method, options and tolerance that the state was saved with. */
static int restore_method(App *app) {
  const Args *a = &app->args;
  const State *st = &app->state;
  const lag_method *m = lag_app_find_method(app, st->method);
  lag_option opt[MOST_OPTIONS];
  if (!m || m->noptions != st->noptions)
    return lag_app_error(a, "%s was saved with method %s, which is not in this build", a->resume, st->method);
  lag_app_options(m, st->options, 1, opt);
  if (lag_sim_set_method(app->sim, m, opt, m->noptions) || lag_sim_set_tolerance(app->sim, st->tol))
    return lag_app_error(a, "%s: %s", a->resume, lag_sim_message(app->sim));
  if (st->signature != lag_sim_signature(app->sim) || st->n != lag_sim_save_size(app->sim))
    return lag_app_error(
        a, "%s was saved by another model or build: names, sizes, effects or equations differ, or --precision",
        a->resume);
  return 0;
}

/* Refuses --method, --step and --tol of a resumed run that differ from those it was saved with. */
static int same_method(App *app) {
  const Args *a = &app->args;
  const State *st = &app->state;
  int rc = set_tolerance(app), named = a->method || a->step;
  rc = rc ? rc : named ? choose_method(app) : 0;
  if (rc) return rc;
  const lag_method *m = lag_sim_method(app->sim);
  if (a->tol && lag_sim_tolerance(app->sim) != st->tol)
    return lag_app_error(a, "%s was saved with --tol %g, and goes on with it; leave out --tol", a->resume, st->tol);
  if (named && (strcmp(m->name, st->method) != 0 || m->noptions != st->noptions ||
                memcmp(lag_sim_options(app->sim), st->options, (size_t)st->noptions * sizeof(double)) != 0))
    return lag_app_error(a, "%s was saved with method %s, and goes on with it and its options; leave out %s", a->resume,
                         st->method, a->method ? "--method" : "--step");
  return 0;
}

/* Refuses name=value of a resumed run that differs: each is set in a simulation with the values of the run, and
 * compared with it. */
static int same_values(App *app) {
  const Args *a = &app->args;
  lag_sim *run = app->sim, *other = app->sim = lag_sim_new(app->scene);
  size_t np = (size_t)app->scene->model->np, nu = (size_t)app->scene->model->nu, n = (size_t)run->pb.n;
  int rc = other ? 0 : lag_app_error(a, "out of memory");
  if (other) {
    memcpy(other->p, run->p, np * sizeof(double));
    memset(other->fixed, 1, np);
    memcpy(other->hold, run->hold, nu * sizeof(double));
    memcpy(other->start, run->begin, n * sizeof(double));
  }
  for (int i = 0; i < a->nsets && rc == 0; i++) {
    rc = lag_app_set_value(app, a->sets[i]);
    if (rc == 0 && (memcmp(other->p, run->p, np * sizeof(double)) != 0 ||
                    memcmp(other->begin, run->begin, n * sizeof(double)) != 0 ||
                    memcmp(other->hold, run->hold, nu * sizeof(double)) != 0))
      rc = lag_app_error(a, "%s was saved with another value of %.*s, and goes on with it; leave out %s", a->resume,
                         (int)strcspn(a->sets[i], "="), a->sets[i], a->sets[i]);
  }
  lag_sim_free(other);
  app->sim = run;
  return rc;
}

/* Continues a saved run with its own settings; the command line may repeat them. */
static int resume(App *app) {
  int rc = same_method(app);
  rc = rc ? rc : restore_method(app);
  if (rc) return rc;
  if (lag_sim_load(app->sim, app->state.data)) return lag_app_error(&app->args, "%s", lag_sim_message(app->sim));
  return same_values(app);
}

static int new_simulation(App *app) {
  int rc = choose_scene(app);
  if (rc) return rc;
  app->sim = lag_sim_new(app->scene);
  if (!app->sim) {
    const lag_model *m = app->scene->model;
    return lag_app_error(&app->args,
                         "cannot simulate scene %s: out of memory, or built for another version or number type; its "
                         "linear systems and constraints take %.0f MB",
                         app->scene->name, 1e-6 * sizeof(double) * ((double)m->nw + (double)lag_rank_scratch_size(m)));
  }
  return lag_app_read_until(app);
}

static int set_values(App *app) {
  const Args *a = &app->args;
  int rc = 0;
  for (int i = 0; i < a->nsets && rc == 0; i++) rc = lag_app_set_value(app, a->sets[i]);
  return rc;
}

void lag_app_options(const lag_method *m, const double *values, double times, lag_option *opt) {
  for (int i = 0; i < m->noptions; i++)
    opt[i] = (lag_option){.name = m->options[i].name,
                          .value = strcmp(m->options[i].name, "step") == 0 ? times * values[i] : values[i]};
}

lag_sim *lag_app_fresh_bare_sim(App *app) {
  const lag_scene *own = app->scene;
  app->scene = bare_scene(app, own);
  lag_sim *sim = lag_app_fresh_sim(app);
  app->scene = own;
  return sim;
}

lag_sim *lag_app_fresh_sim(App *app) {
  lag_sim *own = app->sim, *fresh = app->sim = lag_sim_new(app->scene);
  if (fresh && set_values(app)) {
    lag_sim_free(fresh);
    fresh = NULL;
  }
  app->sim = own;
  return fresh;
}

int lag_app_choose_method(App *app) {
  int rc = set_tolerance(app);
  return rc ? rc : choose_method(app);
}

int lag_app_set_up_start(App *app) {
  int rc = new_simulation(app);
  return rc ? rc : set_values(app);
}

int lag_app_set_up(App *app) {
  const Args *a = &app->args;
  const char *why = NULL;
  int rc = a->resume ? lag_state_read(a->resume, &app->state, &why) : 0;
  if (rc < 0) return lag_app_error(a, "cannot read %s: %s", a->resume, strerror(errno));
  if (rc > 0) return lag_app_error(a, "%s %s", a->resume, why);
  app->resumed = a->resume != NULL;
  if (app->resumed) return (rc = new_simulation(app)) ? rc : resume(app);
  rc = lag_app_set_up_start(app);
  return rc ? rc : lag_app_choose_method(app);
}
