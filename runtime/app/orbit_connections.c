/* --to SCENE: motions from the scene's periodic motion to another one's. Enters: the motion (analysis/connection.h);
 * leaves: where they cross the section, scenes to paste that start there, rows and a picture of their paths. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/connection.h"
#include "app/orbit_manifolds.h"

enum { ROWS = 500 }; /* of each half */

/* Distance of starts, in sizes of the motion: rounding grows by its reciprocal, and its square is left out. */
static const double apart = 1e-5;

/* ---- The other motion */

/* other->args.sets := those of parameters: starts on the command line are for the first motion. */
static int keep_parameters(App *app, App *other) {
  const Args *a = &app->args;
  other->args.sets = calloc((size_t)a->nsets + 1, sizeof *other->args.sets);
  if (!other->args.sets) return lag_app_error(a, "out of memory");
  other->args.nsets = 0;
  for (int k = 0; k < a->nsets; k++) {
    size_t n = strcspn(a->sets[k], "= ");
    if (lag_state_named(app, a->sets[k], n) < 0) other->args.sets[other->args.nsets++] = a->sets[k];
  }
  return 0;
}

/* Parameters and conserved charges of both motions are the same: motions keep them on their way. */
static int check_same(App *app, App *other, PeriodicOrbit *o, PeriodicOrbit *p) {
  const double rounding = 1e-9;
  const lag_model *m = app->scene->model;
  const Args *a = &app->args;
  char text[2][64];
  if (other->scene->model != m)
    return lag_app_error(a, "--to %s: its effects differ from those of %s", a->to, app->scene->name);
  for (int k = 0; k < m->np; k++)
    if (app->sim->p[k] != other->sim->p[k]) /* to the bit: given, or the same text */
      return lag_app_error(a, "--to %s: %s differs from that of scene %s; write one for both: %s=VALUE", a->to,
                           m->p[k].name, app->scene->name, m->p[k].name);
  for (int k = 0; k < lag_flow_charges(&o->flow); k++) {
    if (!lag_flow_conserves(&o->flow, k)) continue;
    double of = lag_flow_charge(&o->flow, k, o->flow.t0, o->y), to = lag_flow_charge(&p->flow, k, p->flow.t0, p->y);
    if (fabs(of - to) > rounding * (1 + fabs(of)))
      return lag_app_no_result(a, "--to %s: no motion leads there: %s is conserved, and is %s of the first, %s of the "
                               "second motion (SI units)", a->to, m->charges ? m->charges->of[k].name : "the energy",
                               lag_number_text(of, text[0]), lag_number_text(to, text[1]));
  }
  return 0;
}

/* The periodic motion of scene --to, by the same options. */
static int open_other(App *app, App *other, PeriodicOrbit *o, PeriodicOrbit *p) {
  *other = lag_app_like(app);
  other->args.scene = app->args.to;
  other->args.guess = other->args.period = NULL;
  int rc = keep_parameters(app, other);
  rc = rc ? rc : lag_app_orbit_set_up(other);
  rc = rc ? rc : lag_app_orbit_open(other, p);
  rc = rc ? rc : lag_app_orbit_solve(other, p);
  return rc ? rc : check_same(app, other, o, p);
}

/* ---- The report */

static void put_scene(FILE *f, const App *app, const Connection *c, int number) {
  fprintf(f, "\nscene connection_%d \"from %s to %s, in the section\" {\n  like %s\n", number, app->scene->name,
          app->args.to, app->args.to);
  lag_app_put_start(f, app, c->at, c->to.time);
}

static void put_text(FILE *f, const App *app, const Connections *all) {
  int k = 0;
  fprintf(f, "%s: %d motion%s from the periodic motion of scene %s to that of %s\n", app->scene->model->name,
          all->count,
          all->count == 1 ? "" : "s", app->scene->name, app->args.to);
  for (const Connection *c = all->first; c; c = c->next)
    fprintf(f, "%4d: %.6g s before and %.6g s after crossing %d of the one and %d of the other end; the halves meet to "
            "%.1g of the motion's size\n", ++k, c->from.time, c->to.time, c->from.cut, c->to.cut, c->residual);
  k = 0;
  for (const Connection *c = all->first; c; c = c->next) put_scene(f, app, c, ++k);
}

static void put_json(FILE *f, App *app, const Connections *all, int n) {
  Json j = lag_report_json_open(app, f);
  lag_json_string(&j, "to", app->args.to);
  lag_json_string(&j, "section", app->args.section);
  lag_json_begin(&j, "connections", '[');
  for (const Connection *c = all->first; c; c = c->next) {
    lag_json_begin(&j, NULL, '{');
    lag_json_number(&j, "before", c->from.time);
    lag_json_number(&j, "after", c->to.time);
    lag_json_count(&j, "crossing", c->from.cut);
    lag_json_count(&j, "crossing_from_end", c->to.cut);
    lag_json_number(&j, "residual", c->residual);
    JSON_EACH(&j, "state", '{', i, n)
      lag_json_number(&j, lag_state_column(app->sim, i).name, lag_sim_declared(app->sim, i, c->at[i]));
    lag_json_end(&j, '}');
  }
  lag_json_end(&j, ']');
  lag_json_close(&j);
}

/* Rows of one half, in the order of time; 0 at the section. */
static int put_half(Manifolds *m, FlowMap *f, const ConnectionEnd *e, int number, int stable, double *states) {
  int n = f->n, done = 0;
  ManifoldStart row = {.stable = stable, .phase = number, .side = e->side};
  double along = stable ? -e->time : e->time;
  lag_sim *sim = lag_flow_sim_along(f, f->t0, e->start, along);
  for (; sim && done <= ROWS && lag_sim_advance(sim, f->t0 + along * done / ROWS) == LAG_OK; done++)
    memcpy(states + done * n, sim->now, (size_t)n * sizeof *states);
  lag_sim_free(sim);
  m->now = &row;
  for (int k = 0; k < done; k++) {
    int at = stable ? done - 1 - k : k;
    lag_manifolds_row(m, along * (at - ROWS) / ROWS + 0.0, states + at * n);
  }
  m->now = NULL;
  return m->rc;
}

static int put_paths(Manifolds *m, const Connections *all, PeriodicOrbit *o, PeriodicOrbit *p) {
  App *app = m->app;
  double *states = calloc((size_t)(ROWS + 1) * (size_t)o->n, sizeof *states);
  int number = 0, rc = states ? lag_manifolds_columns(m, "connection") : lag_app_error(&app->args, "out of memory");
  for (const Connection *c = all->first; c && rc == 0; c = c->next) {
    rc = put_half(m, &o->flow, &c->from, ++number, 0, states);
    rc = rc ? rc : put_half(m, &p->flow, &c->to, number, 1, states);
  }
  free(states);
  if (app->args.out && app->rows.open && lag_rows_close(&app->rows, rc == 0) && rc == 0)
    rc = lag_app_io_error(app, app->args.out);
  app->section = -1; /* paths */
  return rc ? rc : lag_manifolds_draw(m, app->args.section);
}

static int report(Manifolds *m, const Connections *all, PeriodicOrbit *o, PeriodicOrbit *p) {
  App *app = m->app;
  const Args *a = &app->args;
  if (!all->first && all->tried)
    return lag_app_no_result(a, "--to %s: %d pairs of crossings come close in the section, and none is a motion from "
                             "one to the other (nearest: %.2g of its size); more starts: --manifold unstable:%d", a->to,
                             all->tried, all->nearest, 2 * m->phases);
  if (!all->first)
    return lag_app_no_result(a, "--to %s: the manifolds do not meet in the section; a longer time: --follow T; more "
                             "starts: --manifold unstable:%d", a->to, 2 * m->phases);
  int rc = a->out || a->svg ? put_paths(m, all, o, p) : 0;
  if (rc == 0 && a->json) put_json(stdout, app, all, o->n);
  else if (rc == 0 && !(a->out && strcmp(a->out, "-") == 0)) put_text(stdout, app, all);
  return rc;
}

/* ---- The command */

static double rate_of(const Manifold *m) { return m->first ? m->first->rate : 1; }

static int connect(Manifolds *m, PeriodicOrbit *o, PeriodicOrbit *p, Manifold found[2], Connections *all) {
  App *app = m->app;
  const Args *a = &app->args;
  int status = lag_manifold_of_orbit(&found[0], o, 0, m->phases, apart);
  status = status ? status : lag_manifold_of_orbit(&found[1], p, 1, m->phases, apart);
  if (status) return lag_app_no_result(a, "%s", status == LAG_ENOMEM ? "out of memory" : o->flow.message);
  for (int k = 0; k < 2; k++)
    if (!found[k].first)
      return lag_app_no_result(a, "--to %s: the %s motion has no %s direction", a->to, k ? "second" : "first",
                               k ? "stable" : "unstable");
  double time = m->follow > 0 ? m->follow
                              : -log(apart) / fmin(rate_of(&found[0]), rate_of(&found[1])) + fmax(o->T, p->T);
  ConnectionEnd from = {.orbit = o, .manifold = &found[0]}, to = {.orbit = p, .manifold = &found[1]};
  status = lag_connections_find(all, &from, &to, app->section, time, apart);
  if (status == LAG_EMETHOD)
    return lag_app_no_result(a, "--to %s: motions with several unstable, or several stable, directions are not "
                             "supported yet: their manifolds cross in families", a->to);
  return status ? lag_app_no_result(a, "%s", status == LAG_ENOMEM ? "out of memory" : o->flow.message) : 0;
}

int lag_app_connections(App *app, PeriodicOrbit *o) {
  Manifolds m = {.app = app};
  Manifold found[2] = {{.rest_of = 0}, {.rest_of = 0}};
  Connections all = {.count = 0};
  PeriodicOrbit p = {0};
  App other = {0};
  int rc = lag_manifolds_settings(&m);
  if (rc == 0 && o->flow.forced)
    rc = lag_app_error(&app->args, "--to %s: scene %s depends on time; connections of driven motions are not supported "
                       "yet", app->args.to, app->scene->name);
  rc = rc ? rc : open_other(app, &other, o, &p);
  rc = rc ? rc : connect(&m, o, &p, found, &all);
  rc = rc ? rc : report(&m, &all, o, &p);
  lag_connections_free(&all);
  lag_manifold_free(&found[0]);
  lag_manifold_free(&found[1]);
  lag_table_free(&m.drawn);
  lag_orbit_free(&p);
  free(other.args.sets);
  lag_app_free(&other);
  return rc;
}
