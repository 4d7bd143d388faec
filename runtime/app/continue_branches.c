/* --continue: states of rest or periodic motions over a parameter. Enters: the command line; leaves: the points where
 * a branch changes, as text or JSON; all points as rows and a picture. */
#include "app/continue_branches.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Following */

static const char *words_of(int rc, const char *message) {
  return rc == LAG_ENOMEM ? "out of memory"
         : rc == LAG_ESINGULAR
             ? "solutions form a family where the branch begins: --hold energy, or another charge, coordinate or "
               "`period`, chooses one; if this is a branch point let the range begin beside it"
         : message && message[0] ? message
                                 : "there is no solution to begin with";
}

static int failed(Job *job, int rc, const char *message) {
  return lag_app_no_result(&job->app->args, "%s", words_of(rc, message));
}

/* Whether the parameter stays along the branch, to rounding. */
static int stands(const Job *job, const Part *part) {
  const double rounding = 1e-9;
  int last = part->problem->cols - 1;
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const BranchPoint *at = part->branch.first; at; at = at->next)
    low = fmin(low, at->u[last]), high = fmax(high, at->u[last]);
  return job->led_kind < 0 && part->branch.npoints > 2 && high - low < rounding;
}

/* part->why := what kept the branch from going on: a value that the model refuses, a run that fails, a motion that
 * becomes a rest, or one whose period grows without limit. */
static void explain_end(const Job *job, Part *part) {
  const FlowMap *f = part->orbit ? &part->orbit->flow : job->steady.cols ? &job->steady.flow : &job->rest.flow;
  const BranchPoint *last = part->branch.last, *before = part->branch.first;
  while (before && before->next != last) before = before->next;
  if (stands(job, part))
    snprintf(part->why, sizeof part->why,
             "%s stays along this branch, a family at this value: `lagc continue` with that value and energy=A..B, "
             "period=A..B or a coordinate follows it", job->name);
  if (part->branch.end != BRANCH_LOST || part->why[0]) return;
  snprintf(part->why, sizeof part->why, "%s", f->message);
  if (part->orbit && !part->problem->place(part->problem->of, last->u)) {
    const char *event = lag_orbit_event_at_begin(part->orbit);
    if (event)
      snprintf(part->why, sizeof part->why,
               "%s passes the begin of the period, where the state jumps then: begin elsewhere, by the phase of the "
               "drive or at another point of the motion", event);
    part->moves = event != NULL;
    double t = 0;
    if (!event && (event = lag_orbit_grazes(part->orbit, &t)) != NULL)
      snprintf(part->why, sizeof part->why,
               "the motion grazes %s at t = %.6g s: beyond, it happens there once more, and other motions begin", event,
               t);
    if (event) return;
  }
  if (!part->orbit || f->forced || !before) return;
  const double steep = 1000; /* change of the period, in periods, over that of the parameter, in ranges */
  int cols = part->problem->cols, T = part->orbit->m * part->orbit->n;
  double longer = (last->u[T] - before->u[T]) / last->u[T], further = fabs(last->u[cols - 1] - before->u[cols - 1]);
  if (longer > steep * further)
    snprintf(part->why, sizeof part->why, "the period grows without limit, as next to a motion that ends at rest");
}

static int follow_moved(Job *job, Part *of);

/* Follows from u along d, or by sign, as the next part, and on from another begin where an impact passes the begin.
 * LAG_OK, or a status. */
static int follow(Job *job, const BranchProblem *p, PeriodicOrbit *o, const double *u, const double *d, int sign,
                  int from) {
  Part *part = &job->part[job->nparts];
  *part = (Part){.problem = p, .orbit = o, .number = job->number, .from = from};
  for (int k = 0; k < job->nparts; k++) part->second |= job->part[k].number == part->number;
  int rc = lag_branch_follow(&part->branch, p, u, d, sign, &job->limits);
  if (rc == LAG_OK) explain_end(job, part);
  if (rc == LAG_OK) job->nparts++;
  else lag_branch_free(&part->branch);
  return rc == LAG_OK && part->moves ? follow_moved(job, part) : rc;
}

/* ---- Another begin */

/* Times of events within segments, from their begins. */
typedef struct EventTimes {
  int count;
  double t0, at[256];
} EventTimes;

static void note_event(void *context, int k, double t, const double *before, const double *after) {
  EventTimes *e = context;
  (void)k, (void)before, (void)after;
  if (e->count < (int)(sizeof e->at / sizeof *e->at)) e->at[e->count++] = t - e->t0;
}

/* The time after the begins of segments that is farthest from all events. */
static double quiet_time(PeriodicOrbit *o) {
  enum { PLACES = 64 };
  EventTimes e = {.count = 0};
  double length = o->T / o->m, best = 0, most = -1;
  for (int k = 0; k < o->m; k++) {
    e.t0 = o->flow.t0 + length * k;
    lag_sim *sim = lag_flow_sim(&o->flow, e.t0, o->y + k * o->n);
    if (sim) lag_sim_on_event(sim, note_event, &e);
    if (sim) lag_sim_advance(sim, e.t0 + length);
    lag_sim_free(sim);
  }
  for (int p = 1; p < PLACES; p++) {
    double t = length * p / PLACES, least = length;
    for (int k = 0; k < e.count; k++) least = fmin(least, fabs(remainder(e.at[k] - t, length)));
    if (least > most) best = t, most = least;
  }
  return best;
}

/* The same motion, `later` after its begin. */
static int open_moved(Doubled *moved, PeriodicOrbit *o, const lag_scene *scene, double later) {
  int n = o->n, rc = LAG_OK;
  double *y = malloc((size_t)(o->m * n) * sizeof *y);
  if (!y) return LAG_ENOMEM;
  for (int k = 0; k < o->m && rc == LAG_OK; k++)
    rc = lag_flow_run(&o->flow, o->flow.t0 + o->T * k / o->m, later, o->y + k * n, y + k * n, NULL);
  moved->scene = *scene, moved->scene.t0 = o->flow.t0 + later;
  moved->scene.t1 = scene->t1 + (moved->scene.t0 - scene->t0);
  moved->like = rc ? NULL : lag_flow_sim(&o->flow, moved->scene.t0, y);
  if (moved->like) {
    moved->like->scene = &moved->scene;
    moved->orbit = (PeriodicOrbit){.nheld = o->nheld, .continues = 1, .led = o->led, .name = o->name,
                                   .parameter = o->parameter, .parameter_unit = o->parameter_unit,
                                   .ngroup = o->ngroup, .closing = o->closing};
    memcpy(moved->orbit.held, o->held, sizeof o->held);
    memcpy(moved->orbit.group, o->group, sizeof o->group);
    rc = lag_orbit_open(&moved->orbit, moved->like, o->algebra, o->T, o->m);
    if (rc == LAG_OK) memcpy(moved->orbit.y, y, (size_t)(o->m * n) * sizeof *y);
    if (rc == LAG_OK) memcpy(moved->orbit.shift, o->shift, sizeof o->shift);
    moved->orbit.pairing = o->pairing;
    lag_orbit_branch(&moved->problem, &moved->orbit);
  }
  free(y);
  return rc || moved->like ? rc : LAG_ENOMEM;
}

/* Whether the motion may begin anywhere: no condition holds a component there, and its state a period later is that at
 * its begin, but for turns and shifts. */
static int may_move(const PeriodicOrbit *o) {
  for (int k = 0; k < o->nheld; k++)
    if (o->held[k].kind == ORBIT_STATE) return 0;
  for (int j = 0; j < o->ngroup; j++)
    if (!o->group[j].n) return 0;
  return !o->reverse && !o->closing;
}

/* at->shown := the state at the scene's begin, of each point. LAG_OK, or a status. */
static int show_begins(Branch *b, const BranchProblem *p, PeriodicOrbit *o, double t0) {
  int n = o->n, rc = LAG_OK;
  for (BranchPoint *at = b->first; at && rc == LAG_OK; at = at->next) {
    double *y = lag_pool_doubles(&b->pool, (size_t)n), after;
    if (!y) return LAG_ENOMEM;
    if (p->place(p->of, at->u)) continue;
    double length = o->T / o->m, whole = o->T - fmod(o->flow.t0 - t0, o->T);
    int k = (int)fmin(whole / length, o->m - 1);
    after = whole - k * length;
    rc = lag_flow_run(&o->flow, o->flow.t0 + k * length, after, o->y + k * n, y, NULL);
    for (int i = 0; i < n; i++) y[i] -= o->turns[i];
    for (int j = 0; j < o->ngroup; j++)
      for (int i = 0; i < o->group[j].n; i++) y[o->group[j].shifted[i]] -= o->shift[j];
    if (rc == LAG_OK) at->shown = y;
  }
  return rc == LAG_ENOMEM ? rc : LAG_OK;
}

/* The rest of a branch along which an impact passes the begin of the period: it is solved from another begin, and
 * shown from the same one. Where none goes on the part ends, and says why. */
static int follow_moved(Job *job, Part *of) {
  PeriodicOrbit *o = of->orbit;
  const BranchPoint *last = of->branch.last;
  const lag_scene *scene = job->app->sim->scene;
  if (!may_move(o) || job->ndoubled == MOST_DOUBLINGS || job->nparts == MOST_BRANCHES) return LAG_OK;
  if (of->problem->place(of->problem->of, last->u)) return LAG_OK;
  Doubled *moved = &job->doubled[job->ndoubled++];
  int rc = open_moved(moved, o, scene, quiet_time(o)), at = job->nparts;
  double *u = rc ? NULL : malloc((size_t)moved->orbit.cols * sizeof *u);
  if (rc || !u) return rc == LAG_ENOMEM || !u ? LAG_ENOMEM : LAG_OK;
  lag_orbit_branch_unknowns(&moved->orbit, u);
  job->number = ++job->nbranches;
  int sign = last->tangent[moved->orbit.cols - 1] < 0 ? -1 : 1;
  rc = follow(job, &moved->problem, &moved->orbit, u, NULL, sign, of->number);
  free(u);
  if (job->nparts == at) job->nbranches--;
  else {
    snprintf(of->why, sizeof of->why, "an impact passes the begin of the period; branch %d goes on",
             job->part[at].number);
    rc = rc ? rc : show_begins(&job->part[at].branch, &moved->problem, &moved->orbit, scene->t0);
  }
  job->number = of->number;
  return rc == LAG_ENOMEM ? rc : LAG_OK;
}

/* The branch of an earlier run, from its last row on. */
static int follow_on(Job *job, const double *u, PeriodicOrbit *o) {
  const Table *t = &job->app->table;
  int cols = job->problem.cols;
  double *d = malloc((size_t)cols * sizeof *d);
  if (!d) return LAG_ENOMEM;
  lag_continue_direction(job, o, cols, d);
  job->number = (int)lag_continue_last(job)[1];
  for (size_t k = 0; k < t->nrows; k++) job->nbranches = (int)fmax(job->nbranches, lag_table_cell(t, k, 1));
  int rc = follow(job, &job->problem, o, u, d, 1, 0);
  free(d);
  return rc;
}

/* Both halves of the first branch. */
static int follow_first(Job *job, const double *u, PeriodicOrbit *o) {
  if (job->resumed) return follow_on(job, u, o);
  job->number = job->nbranches = 1;
  int rc = follow(job, &job->problem, o, u, NULL, 1, 0);
  const Branch *b = &job->part[0].branch;
  if (rc || b->end == BRANCH_CLOSED) return rc;
  rc = follow(job, &job->problem, o, u, NULL, -1, 0);
  return rc == LAG_ENOMEM ? rc : LAG_OK;
}

/* Both directions of the branch that crosses another one at a point. */
static int follow_other(Job *job, const Part *of, const BranchPoint *at) {
  int cols = of->problem->cols, number = of->number;
  double *d = malloc(2 * (size_t)cols * sizeof *d), *back = d + cols;
  if (!d) return LAG_ENOMEM;
  int rc = lag_branch_other(of->problem, at, d);
  for (int i = 0; i < cols; i++) back[i] = -d[i];
  if (rc == LAG_OK) job->number = ++job->nbranches;
  for (int k = 0; k < 2 && rc == LAG_OK && job->nparts < MOST_BRANCHES; k++)
    if (follow(job, of->problem, of->orbit, at->u, k ? back : d, 0, number) == LAG_ENOMEM) rc = LAG_ENOMEM;
  free(d);
  return rc;
}

/* By how much the parameter of a branch grows for motions of twice the period. */
static double doubling_factor(const PeriodicOrbit *o) {
  return o->led >= 0 && o->held[o->led].kind == ORBIT_PERIOD ? 2 : 1;
}

/* The orbit over twice the period at a point where it doubles; its parts hold the same motion. */
static int open_doubled(Doubled *two, PeriodicOrbit *o, const lag_scene *scene) {
  two->like = lag_flow_sim(&o->flow, o->flow.t0, o->y);
  if (!two->like) return LAG_ENOMEM;
  two->like->scene = scene;
  two->orbit = (PeriodicOrbit){.nheld = o->nheld, .continues = 1, .led = o->led, .name = o->name,
                               .parameter = o->parameter * doubling_factor(o), .parameter_unit = o->parameter_unit,
                               .ngroup = o->ngroup};
  memcpy(two->orbit.held, o->held, sizeof o->held);
  for (int k = 0; k < o->nheld; k++) two->orbit.held[k].value *= o->held[k].kind == ORBIT_PERIOD ? 2 : 1;
  memcpy(two->orbit.group, o->group, sizeof o->group);
  if (o->closing && lag_map_square(&two->closing, &two->orbit.pool, o->closing)) return LAG_ENOMEM;
  two->orbit.closing = o->closing ? &two->closing : NULL;
  int rc = lag_orbit_open(&two->orbit, two->like, o->algebra, 2 * o->T, 2 * o->m);
  for (int s = 0; s < two->orbit.m && rc == LAG_OK; s++)
    memcpy(two->orbit.y + s * o->n, o->y + s % o->m * o->n, (size_t)o->n * sizeof *o->y);
  if (rc == LAG_OK) memcpy(two->orbit.unit, o->unit, (size_t)o->n * sizeof *o->unit); /* a motion at rest has no size */
  two->orbit.pairing = o->pairing;
  lag_orbit_branch(&two->problem, &two->orbit);
  return rc;
}

/* tangent[cols] := that of the same branch for twice the period: each half moves as the whole does. */
static void double_tangent(const PeriodicOrbit *o, const PeriodicOrbit *two, const double *of, double *tangent) {
  int part = o->m * o->n, whole = two->m * two->n;
  for (int i = 0; i < two->cols; i++) tangent[i] = of[i < whole ? i % part : part + i - whole];
  tangent[two->cols - 1] *= doubling_factor(o);
}

/* Motions of twice the period, from a point where it doubles: in one direction, as the other one is the same motion
 * a period later. */
static int follow_doubled(Job *job, const Part *of, BranchPoint *at) {
  if (job->ndoubled == MOST_DOUBLINGS || of->problem->place(of->orbit, at->u)) return LAG_OK;
  Doubled *two = &job->doubled[job->ndoubled++];
  int rc = open_doubled(two, of->orbit, job->app->sim->scene), cols = two->orbit.cols;
  double *u = rc ? NULL : malloc(3 * (size_t)cols * sizeof *u);
  if (rc || !u) return rc == LAG_ENOMEM || !u ? LAG_ENOMEM : LAG_OK;
  BranchPoint start = {.u = u, .tangent = u + cols};
  lag_orbit_branch_unknowns(&two->orbit, u);
  double_tangent(of->orbit, &two->orbit, at->tangent, start.tangent);
  if (u[cols - 1] > job->limits.high || u[cols - 1] < job->limits.low) {
    free(u);
    return at->unfollowed = "its motions have twice this period, outside of the range", LAG_OK;
  }
  rc = lag_branch_other(&two->problem, &start, u + 2 * cols);
  if (rc == LAG_OK) job->number = ++job->nbranches;
  if (rc == LAG_OK) rc = follow(job, &two->problem, &two->orbit, u, u + 2 * cols, 0, of->number);
  free(u);
  return rc == LAG_ENOMEM ? rc : LAG_OK;
}

/* The periodic motions that leave a Hopf point. */
static int follow_cycle(Job *job, const Part *of, const BranchPoint *at) {
  if (job->ndoubled == MOST_DOUBLINGS || job->steady.cols) return LAG_OK;
  Doubled *cycle = &job->doubled[job->ndoubled++];
  double *d = NULL;
  int rc = lag_hopf_orbit(&job->rest, at, &cycle->orbit, &cycle->like, &cycle->problem, &d);
  if (rc != 1) return rc;
  double *u = malloc((size_t)cycle->orbit.cols * sizeof *u), size = 0;
  if (!u) return LAG_ENOMEM;
  lag_orbit_branch_unknowns(&cycle->orbit, u);
  for (int i = 0; i < cycle->orbit.cols; i++) size += d[i] * d[i];
  for (int i = 0; i < cycle->orbit.cols; i++) d[i] /= sqrt(size);
  job->number = ++job->nbranches;
  rc = follow(job, &cycle->problem, &cycle->orbit, u, d, 1, of->number);
  free(u);
  return rc == LAG_ENOMEM ? rc : LAG_OK;
}

/* Branches that leave a point. */
static int follow_from(Job *job, const Part *of, BranchPoint *at, int first) {
  int before = job->nparts, rc = LAG_OK, doubled = job->ndoubled;
  if (at->kind == BRANCH_POINT && first) rc = follow_other(job, of, at);
  else if (at->kind == BRANCH_HOPF) rc = follow_cycle(job, of, at);
  else if (at->kind == BRANCH_DOUBLING) rc = follow_doubled(job, of, at);
  else return LAG_OK;
  if (rc == LAG_OK && job->nparts == before && !at->unfollowed)
    at->unfollowed = at->kind == BRANCH_HOPF && job->steady.cols
                         ? "motions about steady ones that change are not followed: `lagc orbit --relative NAME` "
                           "from a start beside it finds one"
                     : at->kind != BRANCH_POINT && doubled == MOST_DOUBLINGS
                         ? "branches of four such points are followed"
                         : "no solution was found on it";
  return rc;
}

/* Branches that leave the first one, and of those the motions whose period doubles again. */
static int follow_branches(Job *job) {
  int rc = LAG_OK, first = job->nparts;
  for (int k = 0; k < job->nparts && rc == LAG_OK; k++)
    for (BranchPoint *at = job->part[k].branch.first; at && rc == LAG_OK; at = at->next) {
      if (job->nparts < MOST_BRANCHES - 1) rc = follow_from(job, &job->part[k], at, k < first);
      else if (at->kind == BRANCH_POINT || at->kind == BRANCH_HOPF || at->kind == BRANCH_DOUBLING)
        at->unfollowed = "there are too many branches";
    }
  return rc;
}

/* ---- Beginning */

/* Whether the motion to begin with lies in the range; one beside an end by no more than its own error begins
 * there. */
static int check_begin(Job *job, const char *kind) {
  const double solved = 1e-8;
  double low = fmin(job->low, job->high), high = fmax(job->low, job->high), inside = fmin(fmax(job->begin, low), high);
  if (fabs(job->begin - inside) <= solved * job->size) {
    job->begin = inside;
    return 0;
  }
  return lag_app_error(&job->app->args,
                       "the %s motion near the start has %s = %.6g, outside of %g..%g: start within: "
                       "name=VALUE, or widen the range",
                       kind, job->name, job->begin, job->low, job->high);
}

static int begin_rest(Job *job) {
  int rc = lag_rest_branch_open(&job->rest, job->app->sim, job->app->extras.algebra, job->name, job->begin, job->size);
  if (rc) return failed(job, rc, job->rest.flow.message);
  double *u = malloc((size_t)job->rest.cols * sizeof *u);
  if (!u) return failed(job, LAG_ENOMEM, NULL);
  lag_rest_branch_unknowns(&job->rest, u);
  job->problem = job->rest.problem;
  rc = follow_first(job, u, NULL);
  free(u);
  return rc ? failed(job, rc, job->rest.flow.message) : 0;
}

/* Of steady motions over a parameter charges other than the energy keep their values, unless --hold names others; over
 * a charge the others. */
static int hold_for_steady(Job *job) {
  SteadyBranch *s = &job->steady;
  App *app = job->app;
  const lag_charges *of = app->scene->model->charges;
  int rc = lag_app_orbit_holds(app, &job->orbit), all = !app->args.hold && job->led_kind != ORBIT_STATE;
  s->nheld = job->orbit.nheld;
  memcpy(s->held, job->orbit.held, sizeof s->held);
  for (int k = 1; of && k < of->n && all && s->nheld < ORBIT_MOST_HELD - 1; k++) {
    int leads = job->led_kind == ORBIT_CHARGE && (job->led_of == k || job->led_of == 0);
    if (of->of[k].flags & LAG_CONSERVED && !leads) s->held[s->nheld++] = (OrbitHold){.kind = ORBIT_CHARGE, .of = k};
  }
  s->led = job->led_kind < 0 ? -1 : s->nheld;
  if (s->led >= 0) s->held[s->nheld++] = (OrbitHold){.kind = (OrbitHoldKind)job->led_kind, .of = job->led_of};
  return rc;
}

static int begin_steady(Job *job) {
  SteadyBranch *s = &job->steady;
  App *app = job->app;
  if (job->led_kind == ORBIT_PERIOD)
    return lag_app_error(&app->args, "period: a steady motion has none; write a parameter, a charge, a coordinate or a "
                                     "velocity: th'=1..8");
  int rc = hold_for_steady(job);
  if (rc) return rc;
  s->name = job->name;
  s->parameter = job->begin;
  s->parameter_unit = job->size * (job->led_kind < 0 ? 1 : fabs(job->factor));
  rc = lag_steady_branch_open(s, app->sim, app->extras.algebra);
  if (rc) return failed(job, rc, s->flow.message);
  double *u = malloc((size_t)s->cols * sizeof *u);
  if (!u) return failed(job, LAG_ENOMEM, NULL);
  lag_steady_branch_unknowns(s, u);
  job->problem = s->problem;
  job->begin = job->led_kind < 0 ? job->begin : (s->parameter - job->offset) / job->factor;
  rc = check_begin(job, "steady");
  int status = rc ? LAG_OK : follow_first(job, u, NULL);
  free(u);
  return status ? failed(job, status, s->flow.message) : rc;
}

/* Conserved charges keep their values unless --hold names others, or one is the parameter; --period is in place of the
 * energy. */
static void hold_charges(Job *job) {
  PeriodicOrbit *o = &job->orbit;
  const lag_charges *of = job->app->scene->model->charges;
  int conserves = (lag_facts(&job->app->sim->pb) & LAG_CONSERVES_ENERGY) != 0;
  if (job->led_kind < 0 && job->app->args.hold) return;
  for (int k = 0; k < job->app->scene->model->nev; k++)
    if (lag_is_kick(job->app->scene->model, k)) return; /* kicks change them */
  for (int k = 0; k < (of ? of->n : 1) && o->nheld < ORBIT_MOST_HELD - 2; k++) {
    if (of ? !(of->of[k].flags & LAG_CONSERVED) : !conserves) continue;
    if (k == 0 && (job->led_kind >= 0 || job->app->args.period)) continue;
    if (job->led_kind == ORBIT_CHARGE && job->led_of == k) continue;
    o->held[o->nheld++] = (OrbitHold){.kind = ORBIT_CHARGE, .of = k};
  }
}

static double led_value(Job *job) {
  PeriodicOrbit *o = &job->orbit;
  if (job->led_kind == ORBIT_PERIOD) return o->T;
  return job->led_kind == ORBIT_STATE ? o->y[job->led_of] : lag_flow_charge(&o->flow, job->led_of, o->flow.t0, o->y);
}

/* The quantity that runs over a range keeps its value for the first motion only: --period 2.5 period=2..3. */
static void release_led(Job *job) {
  PeriodicOrbit *o = &job->orbit;
  int kept = 0;
  for (int k = 0; k < o->nheld; k++) {
    const OrbitHold *h = &o->held[k];
    int same = (int)h->kind == job->led_kind && (h->kind == ORBIT_PERIOD || h->of == job->led_of);
    if (!same) o->held[kept++] = *h;
  }
  o->nheld = kept;
}

static int begin_periodic(Job *job) {
  PeriodicOrbit *o = &job->orbit;
  App *app = job->app;
  hold_charges(job);
  int rc = lag_app_orbit_open(app, o);
  rc = rc ? rc : lag_app_orbit_solve(app, o);
  if (rc) return rc;
  if (job->led_kind >= 0) {
    release_led(job);
    o->led = o->nheld;
    o->held[o->nheld++] = (OrbitHold){.kind = (OrbitHoldKind)job->led_kind, .of = job->led_of};
    job->begin = (led_value(job) - job->offset) / job->factor;
    if ((rc = check_begin(job, "periodic")) != 0) return rc;
  } else o->led = -1;
  o->name = job->led_kind < 0 ? job->name : NULL;
  o->parameter = job->led_kind < 0 ? job->begin : job->factor * job->begin + job->offset;
  o->parameter_unit = job->size * (job->led_kind < 0 ? 1 : fabs(job->factor));
  o->continues = 1;
  if (job->led_kind < 0 && lag_flow_set(&o->flow, o->name, o->parameter))
    return failed(job, LAG_EINVAL, o->flow.message);
  lag_orbit_branch(&job->problem, o);
  double *u = malloc((size_t)o->cols * sizeof *u);
  if (!u) return failed(job, LAG_ENOMEM, NULL);
  lag_orbit_branch_unknowns(o, u);
  rc = follow_first(job, u, o);
  free(u);
  return rc ? failed(job, rc, o->flow.message) : 0;
}

/* ---- The command */

static int read_limits(Job *job) {
  const Args *a = &job->app->args;
  long long most = POINTS;
  if (a->most && lag_args_count(a, "--most", a->most, "--most 400", &most)) return EXIT_USAGE;
  double a0 = job->low * job->factor + job->offset, b0 = job->high * job->factor + job->offset;
  double unit = job->size * fabs(job->factor);
  job->limits = (BranchLimits){.low = fmin(a0, b0) / unit,
                               .high = fmax(a0, b0) / unit,
                               .step = 0.01,
                               .longest = 0.1,
                               .most = (int)(most < 100000 ? most : 100000)};
  return 0;
}

/* Whether periodic motions are followed. */
static int is_periodic(Job *job) {
  const Args *a = &job->app->args;
  FlowMap f;
  if (job->led_kind >= 0 || a->guess || a->period || a->hold || a->relative || a->reverse) return 1;
  int forced = lag_flow_open(&f, job->app->sim) == LAG_OK && f.forced;
  lag_flow_free(&f);
  return forced;
}

static int run(Job *job) {
  if (job->app->args.steady) return begin_steady(job);
  job->periodic = is_periodic(job);
  return job->periodic ? begin_periodic(job) : begin_rest(job);
}

static void close_job(Job *job) {
  for (int k = 0; k < job->nparts; k++) lag_branch_free(&job->part[k].branch);
  lag_rest_branch_free(&job->rest);
  lag_steady_branch_free(&job->steady);
  for (int k = 0; k < job->ndoubled; k++) {
    lag_orbit_free(&job->doubled[k].orbit);
    lag_sim_free(job->doubled[k].like);
  }
  lag_orbit_free(&job->orbit);
}

int lag_app_continue(App *app) {
  Job job = {.app = app};
  const Args *a = &app->args;
  int rc = lag_continue_take_range(&job);
  rc = rc ? rc : lag_app_orbit_set_up(app);
  rc = rc ? rc : lag_continue_find_parameter(&job);
  rc = rc ? rc : lag_continue_make_table(&job);
  rc = rc ? rc : lag_continue_resume(&job);
  if (rc == 0 && job.led_kind < 0) rc = lag_continue_choose_begin(&job);
  job.size = fabs(job.high - job.low);
  rc = rc ? rc : read_limits(&job);
  rc = rc ? rc : run(&job);
  if (rc == 0 && a->branches && follow_branches(&job)) rc = failed(&job, LAG_ENOMEM, NULL);
  rc = rc ? rc : lag_continue_write_rows(&job);
  rc = rc ? rc : lag_continue_draw(&job);
  if (rc == 0 && a->json) lag_continue_put_json(stdout, &job);
  else if (rc == 0) lag_continue_put_text(a->out && strcmp(a->out, "-") == 0 ? stderr : stdout, &job);
  close_job(&job);
  return rc;
}
