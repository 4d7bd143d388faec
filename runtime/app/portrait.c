/* Energy beneath motions: phase portraits, the level curves of the energy over coordinate and velocity (--portrait),
 * and the potential beneath the energy of the motion (--potential), for models with one coordinate, or with two of
 * first order, as a coordinate and its momentum. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "core/core.h"

/* The energy at the beginning of the scene's span, in the unit of its column, where the state is that of the start
 * but for its first two components, given in the units of the drawn columns. */
static double energy_at(void *app, double x, double y) {
  const App *a = app;
  lag_sim *s = a->sim;
  const lag_model *m = s->scene->model;
  double e[2], *at = a->portrait;
  at[0] = x * a->portrait_unit[0];
  at[1] = y * a->portrait_unit[1];
  if (lag_inputs_at(&s->pb, s->scene->t0, at) ||
      m->energy(m, s->scene->t0, at, at + m->nq, at + 2 * m->nq, s->p, s->u, e, s->work))
    return NAN;
  return e[0] / a->portrait_unit[2];
}

static const char *refusal(const App *app) {
  const lag_model *m = app->scene->model;
  if (!m->energy) return "the model has no energy";
  if (m->constraints) return "the model has constraints";
  return m->nq == 1 || (m->nq == 0 && m->nz == 2)
             ? NULL
             : "it needs a model with one coordinate, or with two of first order; --x and --y draw any expressions";
}

/* Whether the drawn columns are those that the picture is about. */
static int has_axes(const App *app, int x, int y) {
  const lag_model *m = app->scene->model;
  const char *first = (m->nq ? m->q : m->z)->name, *name = app->table.cols[y].name;
  size_t n = strlen(first);
  if (strcmp(app->table.cols[x].name, first) != 0) return 0;
  if (app->args.potential) return strcmp(name, "energy") == 0;
  return m->nq ? strncmp(name, first, n) == 0 && strcmp(name + n, "'") == 0 : strcmp(name, m->z[1].name) == 0;
}

/* SI units in one unit of a column. */
static double unit_of(const App *app, int col) { return lag_sim_output_info(app->sim, col - 1, NULL, 0, NULL, 0); }

int lag_portrait_open(App *app) {
  const Args *a = &app->args;
  const PlottedCurves *d = &app->drawn;
  if (!a->portrait && !a->potential) return 0;
  const char *why = refusal(app);
  if (!why && !has_axes(app, d->x[0], d->y[0]))
    why = "it is over the coordinate and its rate or momentum, or the energy; `lagc plot` chooses these";
  if (why) return lag_app_error(a, "--%s: %s", a->portrait ? "portrait" : "potential", why);
  app->portrait = calloc((size_t)app->sim->pb.n + 1, sizeof *app->portrait);
  if (!app->portrait) return lag_app_error(a, "out of memory");
  memcpy(app->portrait, app->sim->begin, (size_t)app->sim->pb.n * sizeof *app->portrait);
  for (int i = 0; i < 3; i++) app->portrait_unit[i] = 1;
  app->portrait_unit[0] = unit_of(app, d->x[0]);
  app->portrait_unit[a->potential ? 2 : 1] = unit_of(app, d->y[0]);
  const lag_var *x = app->scene->model->nq ? app->scene->model->q : app->scene->model->z;
  app->drawn.beneath = (Beneath){.value = energy_at,
                                 .of = app,
                                 .period = x->periodic ? 2 * acos(-1) / app->portrait_unit[0] : 0,
                                 .profile = a->potential};
  return 0;
}
