/* From the command line to a simulation ready to run: scene, method, tolerance, values. Enters: Args; leaves:
 * app->scene and app->sim. Holds: the command line wins over the scene; what this build does not hold is refused
 * with the command that builds it. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "core/core.h"

static int no_scene(const App *app, const char *name)
{
  const lag_program *p = app->program;

  app_error(&app->args, "scene %s is not in this build. It holds:", name);
  for (int i = 0; i < p->nscenes; i++) {
    fprintf(stderr, "  %s\n", p->scenes[i]->name);
  }
  fprintf(stderr, "If %s has it, this builds and runs it: lagc run %s %s\n", p->source, p->source, name);
  return EXIT_USAGE;
}

static int choose_scene(App *app)
{
  const lag_program *p = app->program;
  const char *name = app->resumed ? app->state.scene : app->args.scene;

  if (app->resumed && app->args.scene && strcmp(app->args.scene, name) != 0) {
    return app_error(&app->args, "%s was saved from scene %s, not %s", app->args.resume, name, app->args.scene);
  }
  for (int i = 0; i < p->nscenes; i++) {
    if (!name || strcmp(p->scenes[i]->name, name) == 0) {
      app->scene = p->scenes[i];
      return 0;
    }
  }
  return name ? no_scene(app, name) : app_error(&app->args, "this program has no scenes");
}

const lag_method *app_find_method(const App *app, const char *name)
{
  for (int i = 0; i < lag_nmethods; i++) {
    if (strcmp(lag_methods[i]->name, name) == 0) {
      return lag_methods[i];
    }
  }
  for (int i = 0; i < app->extras.nmethods; i++) {
    if (strcmp(app->extras.methods[i]->name, name) == 0) {
      return app->extras.methods[i];
    }
  }
  return NULL;
}

/* A method's options as they are being collected; names and texts point into `text`. */
typedef struct Choice {
  char text[512];
  const char *name;
  lag_option opt[MOST_OPTIONS];
  int n;
} Choice;

static char *trim(char *s)
{
  s += strspn(s, " ");
  size_t n = strlen(s);
  while (n && s[n - 1] == ' ') {
    s[--n] = '\0';
  }
  return s;
}

/* "NAME" or "NAME(option = value, ...)". */
static int parse_method(const Args *a, Choice *c)
{
  char *open, *close, *save = NULL;

  snprintf(c->text, sizeof c->text, "%s", a->method);
  c->name = c->text;
  if ((open = strchr(c->text, '(')) == NULL) {
    return 0;
  }
  close = strrchr(open, ')');
  if (!close || *trim(close + 1)) {
    return app_error(a, "--method %s: write NAME(option=value, ...)", a->method);
  }
  *open = *close = '\0';
  c->name = trim(c->text);
  for (char *s = strtok_r(open + 1, ",", &save); s; s = strtok_r(NULL, ",", &save)) {
    char *eq = strchr(s, '=');
    if (!eq || c->n == MOST_OPTIONS - 1) {
      return app_error(a, "--method %s: write NAME(option=value, ...)", a->method);
    }
    *eq = '\0';
    lag_option *o = &c->opt[c->n++];
    char *end, *value = trim(eq + 1);
    *o = (lag_option){.name = trim(s)};
    o->value = strtod(value, &end);
    if (*end || end == value) {
      o->text = value;
    }
  }
  return 0;
}

static int choose_method(App *app)
{
  const Args *a = &app->args;
  Choice c = {.name = app->scene->method ? app->scene->method : lag_methods[0]->name};
  int rc = a->method ? parse_method(a, &c) : 0;

  if (rc) {
    return rc;
  }
  const lag_method *m = app_find_method(app, c.name);
  if (!m) {
    app_error(a, "unknown method %s", c.name);
    app_list_methods(app, stderr);
    return EXIT_USAGE;
  }
  if (app->scene->method && strcmp(app->scene->method, c.name) == 0 && c.n == 0) {
    for (int i = 0; i < app->scene->noptions && c.n < MOST_OPTIONS - 1; i++) {
      c.opt[c.n++] = app->scene->options[i];
    }
  }
  if (a->step) {
    lag_option *o = &c.opt[c.n++];
    *o = (lag_option){.name = "step"};
    if (!args_number(a, "--step", a->step, "--step 1e-3", &o->value)) {
      return EXIT_USAGE;
    }
    if (o->value <= 0) {
      return app_error(a, "--step %s: a step must be positive, for example --step 1e-3", a->step);
    }
    if (o->value < 1e-15 * (app->scene->has_span ? fabs(app->scene->t1 - app->scene->t0) : 1)) {
      return app_error(a, "--step %s: time would not move, double precision has 16 digits; for example --step 1e-3", a->step);
    }
  }
  rc = lag_sim_set_method(app->sim, m, c.opt, c.n);
  if (rc == 0 && a->tol && !(m->flags & LAG_METHOD_ADAPTIVE) && !a->quiet) {
    fprintf(stderr, "%s: note: %s has a fixed step; --tol does not change it\n", a->self, m->name);
  }
  return rc ? app_error(a, "%s", lag_sim_message(app->sim)) : 0;
}

static int set_tolerance(App *app)
{
  const Args *a = &app->args;
  double x;

  if (!a->tol) {
    return 0;
  }
  if (!args_number(a, "--tol", a->tol, "--tol 1e-9", &x)) {
    return EXIT_USAGE;
  }
  return lag_sim_set_tolerance(app->sim, x) ? app_error(a, "--tol: %s", lag_sim_message(app->sim)) : 0;
}

/* Is word among words that are separated by spaces? */
static int has_word(const char *words, const char *word, size_t n)
{
  for (const char *s = words; s && *s; s += strspn(s, " ")) {
    size_t length = strcspn(s, " ");
    if (length == n && memcmp(s, word, n) == 0) {
      return 1;
    }
    s += length;
  }
  return 0;
}

static int set_value(App *app, const char *text)
{
  const Args *a = &app->args;
  const char *eq = strchr(text, '='), *dot = memchr(text, '.', (size_t)(eq - text));
  char name[128], example[160];
  double x;

  snprintf(name, sizeof name, "%.*s", (int)(eq - text), text);
  if (dot && has_word(app->program->effects, text, (size_t)(dot - text)) &&
      !has_word(app->scene->model->effects, text, (size_t)(dot - text))) {
    return app_error(a,
                     "%s: effect %.*s is not in scene %s of this build; let the scene use it, then this builds and runs "
                     "it: lagc run %s %s",
                     name, (int)(dot - text), text, app->scene->name, app->program->source, app->scene->name);
  }
  snprintf(example, sizeof example, "%s=1.5", name);
  if (!args_number(a, name, eq + 1, example, &x)) {
    return EXIT_USAGE;
  }
  return lag_sim_set(app->sim, name, x) ? app_error(a, "%s", lag_sim_message(app->sim)) : 0;
}

/* A resumed run keeps what it began with. */
static int resume(App *app)
{
  const Args *a = &app->args;
  const State *st = &app->state;
  const lag_method *m = app_find_method(app, st->method);
  lag_option opt[MOST_OPTIONS];

  if (a->nsets || a->tol || a->step || a->method) {
    return app_error(a, "--resume goes on with the values, method and tolerance it was saved with; leave out %s",
                     a->nsets ? a->sets[0] : a->tol ? "--tol" : a->step ? "--step" : "--method");
  }
  if (!m || m->noptions != st->noptions) {
    return app_error(a, "%s was saved with method %s, which is not in this build", a->resume, st->method);
  }
  for (int i = 0; i < m->noptions; i++) {
    opt[i] = (lag_option){.name = m->options[i].name, .value = st->options[i]};
  }
  if (lag_sim_set_method(app->sim, m, opt, m->noptions) || lag_sim_set_tolerance(app->sim, st->tol)) {
    return app_error(a, "%s: %s", a->resume, lag_sim_message(app->sim));
  }
  if (st->signature != lag_sim_signature(app->sim) || st->n != lag_sim_save_size(app->sim)) {
    return app_error(a, "%s was saved by another model or build: names, sizes, effects or equations differ", a->resume);
  }
  return lag_sim_load(app->sim, st->data) ? app_error(a, "%s", lag_sim_message(app->sim)) : 0;
}

static int read_state(App *app)
{
  const Args *a = &app->args;
  const char *why = NULL;
  int rc = a->resume ? state_read(a->resume, &app->state, &why) : 0;

  if (rc < 0) {
    return app_error(a, "cannot read %s: %s", a->resume, strerror(errno));
  }
  if (rc > 0) {
    return app_error(a, "%s %s", a->resume, why);
  }
  app->resumed = a->resume != NULL;
  return 0;
}

static int new_simulation(App *app)
{
  int rc = choose_scene(app);

  if (rc) {
    return rc;
  }
  app->sim = lag_sim_new(app->scene);
  if (!app->sim) {
    return app_error(&app->args, "cannot simulate scene %s: out of memory, or built for another version or number type",
                     app->scene->name);
  }
  return 0;
}

static int set_values(App *app)
{
  const Args *a = &app->args;
  int rc = 0;

  for (int i = 0; i < a->nsets && rc == 0; i++) {
    rc = set_value(app, a->sets[i]);
  }
  return rc;
}

int app_choose_start(App *app)
{
  int rc = new_simulation(app);

  return rc ? rc : set_values(app);
}

int app_choose(App *app)
{
  int rc = read_state(app);

  if (rc || (rc = new_simulation(app)) != 0) {
    return rc;
  }
  if (app->resumed) {
    return resume(app);
  }
  if ((rc = set_tolerance(app)) != 0 || (rc = choose_method(app)) != 0) {
    return rc;
  }
  return set_values(app);
}
