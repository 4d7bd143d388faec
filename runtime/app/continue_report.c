/* --continue: states of rest or periodic motions over a parameter. Enters: the command line; leaves: the points where
 * a branch changes, as text or JSON; all points as rows and a picture. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/branch_problems.h"
#include "app/app.h"

enum { MOST_BRANCHES = 24, MOST_DOUBLINGS = 4, POINTS = 400, LOOKS = 128 };

/* A branch and the equations that it solves. */
typedef struct Part {
  Branch branch;
  const BranchProblem *problem;
  PeriodicOrbit *orbit; /* NULL: states of rest */
  int number, from;     /* of the branch that it is a half of; of the one that it leaves, 0: none */
} Part;

/* Motions of twice the period of another one. */
typedef struct Doubled {
  lag_sim *like;
  StateMap closing;
  PeriodicOrbit orbit;
  BranchProblem problem;
} Doubled;

typedef struct Job {
  App *app;
  char name[96];                                 /* of the parameter */
  const lag_var *unit;                           /* of a parameter of the model; NULL: of another quantity */
  double low, high, begin, size, offset, factor; /* range; first value; SI = factor x + offset */
  RestBranch rest;
  PeriodicOrbit orbit;
  BranchProblem problem;
  Doubled doubled[MOST_DOUBLINGS];
  int ndoubled;
  int periodic, led_kind, led_of; /* led_kind: of OrbitHold; -1: a parameter */
  BranchLimits limits;
  Part part[MOST_BRANCHES];
  int nparts, nbranches;
} Job;

/* ---- The parameter and its range */

/* job->name, low and high: of the one value that is a range, which is taken out of the settings. */
static int take_range(Job *job) {
  Args *a = &job->app->args;
  const char *found = NULL;
  int kept = 0;
  for (int i = 0; i < a->nsets; i++) {
    const char *eq = strchr(a->sets[i], '=');
    if (!eq || !strstr(eq, "..")) {
      a->sets[kept++] = a->sets[i];
      continue;
    }
    if (found) return lag_app_error(a, "%s and %s: one value runs over a range; leave one out", found, a->sets[i]);
    found = a->sets[i];
  }
  a->nsets = kept;
  if (!found) return lag_app_error(a, "a range is missing: NAME=A..B, for example mu=0.1..3");
  size_t n = strcspn(found, "=");
  char low[64];
  const char *dots = strstr(found, "..");
  snprintf(job->name, sizeof job->name, "%.*s", (int)n, found);
  snprintf(low, sizeof low, "%.*s", (int)(dots - found - (long)n - 1), found + n + 1);
  if (!lag_args_number(a, job->name, low, "mu=0.1..3", &job->low) ||
      !lag_args_number(a, job->name, dots + 2, "mu=0.1..3", &job->high))
    return EXIT_USAGE;
  return job->low != job->high ? 0 : lag_app_error(a, "%s: the ends of the range are equal", found);
}

/* The quantity of this name, and its value at the start. */
static int find_parameter(Job *job) {
  App *app = job->app;
  int index = 0, charge = lag_charge_named(app, job->name, strlen(job->name)),
      state = lag_state_named(app, job->name, strlen(job->name));
  job->factor = 1;
  job->led_kind = -1;
  if (strcmp(job->name, "period") == 0) job->led_kind = ORBIT_PERIOD;
  else if (state >= 0) {
    job->led_kind = ORBIT_STATE, job->led_of = state;
    job->offset = 0 - lag_sim_declared(app->sim, state, 0);
    job->factor = 1 / (lag_sim_declared(app->sim, state, 1) - lag_sim_declared(app->sim, state, 0));
    job->offset *= job->factor;
  } else if (charge >= 0) job->led_kind = ORBIT_CHARGE, job->led_of = charge;
  else if (lag_find_name(app->scene->model, job->name, &index, &job->unit) != LAG_IS_P)
    return lag_app_error(&app->args,
                         "%s: the model has no parameter of this name; of periodic motions also `energy`, a conserved "
                         "charge, `period`, a coordinate, velocity or state can run over a range",
                         job->name);
  else job->begin = lag_declared(job->unit, app->sim->p[index]);
  return 0;
}

/* The value to begin with: the scene's, if it lies in the range, else the first end. */
static int choose_begin(Job *job) {
  double low = fmin(job->low, job->high), high = fmax(job->low, job->high);
  job->size = high - low;
  if (!(job->begin >= low && job->begin <= high)) job->begin = job->low;
  return lag_sim_set(job->app->sim, job->name, job->begin)
             ? lag_app_error(&job->app->args, "%s", lag_sim_message(job->app->sim))
             : 0;
}

/* ---- Following */

static const char *words_of(int rc, const char *message) {
  return rc == LAG_ENOMEM ? "out of memory"
         : rc == LAG_ESINGULAR
             ? "at each value of the parameter there is a family of solutions: --hold energy, or another "
               "charge, coordinate or `period`, chooses one"
         : message && message[0] ? message
                                 : "there is no solution to begin with";
}

static int failed(Job *job, int rc, const char *message) {
  lag_app_error(&job->app->args, "%s", words_of(rc, message));
  return EXIT_RUN;
}

/* Follows from u along d, or by sign, as the next part. LAG_OK, or a status. */
static int follow(Job *job, const BranchProblem *p, PeriodicOrbit *o, const double *u, const double *d, int sign,
                  int from) {
  Part *part = &job->part[job->nparts];
  *part = (Part){.problem = p, .orbit = o, .number = job->nbranches, .from = from};
  int rc = lag_branch_follow(&part->branch, p, u, d, sign, &job->limits);
  if (rc == LAG_OK) job->nparts++;
  else lag_branch_free(&part->branch);
  return rc;
}

/* Both halves of the first branch. */
static int follow_first(Job *job, const double *u, PeriodicOrbit *o) {
  job->nbranches = 1;
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
  if (rc == LAG_OK) job->nbranches++;
  for (int k = 0; k < 2 && rc == LAG_OK && job->nparts < MOST_BRANCHES; k++)
    if (follow(job, of->problem, of->orbit, at->u, k ? back : d, 0, number) == LAG_ENOMEM) rc = LAG_ENOMEM;
  free(d);
  return rc;
}

/* The orbit over twice the period at a point where it doubles; its parts hold the same motion. */
static int open_doubled(Doubled *two, PeriodicOrbit *o, const lag_scene *scene) {
  two->like = lag_flow_sim(&o->flow, o->flow.t0, o->y);
  if (!two->like) return LAG_ENOMEM;
  two->like->scene = scene;
  two->orbit = (PeriodicOrbit){.nheld = o->nheld,
                               .continues = 1,
                               .led = o->led,
                               .name = o->name,
                               .parameter = o->parameter,
                               .parameter_unit = o->parameter_unit,
                               .ngroup = o->ngroup};
  memcpy(two->orbit.held, o->held, sizeof o->held);
  memcpy(two->orbit.group, o->group, sizeof o->group);
  if (o->closing && lag_map_square(&two->closing, &two->orbit.pool, o->closing)) return LAG_ENOMEM;
  two->orbit.closing = o->closing ? &two->closing : NULL;
  int rc = lag_orbit_open(&two->orbit, two->like, o->algebra, 2 * o->T, 2 * o->m);
  for (int s = 0; s < two->orbit.m && rc == LAG_OK; s++)
    memcpy(two->orbit.y + s * o->n, o->y + s % o->m * o->n, (size_t)o->n * sizeof *o->y);
  two->orbit.pairing = o->pairing;
  lag_orbit_branch(&two->problem, &two->orbit);
  return rc;
}

/* tangent[cols] := that of the same branch for twice the period: each half moves as the whole does. */
static void double_tangent(const PeriodicOrbit *o, const PeriodicOrbit *two, const double *of, double *tangent) {
  int part = o->m * o->n, whole = two->m * two->n;
  for (int i = 0; i < two->cols; i++) tangent[i] = of[i < whole ? i % part : part + i - whole];
}

/* Motions of twice the period, from a point where it doubles: in one direction, as the other one is the same motion
 * a period later. */
static int follow_doubled(Job *job, const Part *of, const BranchPoint *at) {
  if (job->ndoubled == MOST_DOUBLINGS || of->problem->place(of->orbit, at->u)) return LAG_OK;
  Doubled *two = &job->doubled[job->ndoubled++];
  int rc = open_doubled(two, of->orbit, job->app->sim->scene), cols = two->orbit.cols;
  double *u = rc ? NULL : malloc(3 * (size_t)cols * sizeof *u);
  if (rc || !u) return rc == LAG_ENOMEM || !u ? LAG_ENOMEM : LAG_OK;
  BranchPoint start = {.u = u, .tangent = u + cols};
  lag_orbit_branch_unknowns(&two->orbit, u);
  double_tangent(of->orbit, &two->orbit, at->tangent, start.tangent);
  rc = lag_branch_other(&two->problem, &start, u + 2 * cols);
  if (rc == LAG_OK) job->nbranches++;
  if (rc == LAG_OK) rc = follow(job, &two->problem, &two->orbit, u, u + 2 * cols, 0, of->number);
  free(u);
  return rc == LAG_ENOMEM ? rc : LAG_OK;
}

/* The periodic motions that leave a Hopf point. */
static int follow_cycle(Job *job, const Part *of, const BranchPoint *at) {
  if (job->ndoubled == MOST_DOUBLINGS) return LAG_OK;
  Doubled *cycle = &job->doubled[job->ndoubled++];
  double *d = NULL;
  int rc = lag_hopf_orbit(&job->rest, at, &cycle->orbit, &cycle->like, &cycle->problem, &d);
  if (rc != 1) return rc;
  double *u = malloc((size_t)cycle->orbit.cols * sizeof *u), size = 0;
  if (!u) return LAG_ENOMEM;
  lag_orbit_branch_unknowns(&cycle->orbit, u);
  for (int i = 0; i < cycle->orbit.cols; i++) size += d[i] * d[i];
  for (int i = 0; i < cycle->orbit.cols; i++) d[i] /= sqrt(size);
  job->nbranches++;
  rc = follow(job, &cycle->problem, &cycle->orbit, u, d, 1, of->number);
  free(u);
  return rc == LAG_ENOMEM ? rc : LAG_OK;
}

/* Branches that leave the first one, and of those the motions whose period doubles again. */
static int follow_branches(Job *job) {
  int rc = LAG_OK, first = job->nparts;
  for (int k = 0; k < job->nparts && rc == LAG_OK; k++)
    for (const BranchPoint *at = job->part[k].branch.first; at && rc == LAG_OK; at = at->next) {
      if (job->nparts >= MOST_BRANCHES - 1) return LAG_OK;
      if (at->kind == BRANCH_POINT && k < first) rc = follow_other(job, &job->part[k], at);
      if (at->kind == BRANCH_HOPF) rc = follow_cycle(job, &job->part[k], at);
      if (at->kind == BRANCH_DOUBLING) rc = follow_doubled(job, &job->part[k], at);
    }
  return rc;
}

/* ---- Beginning */

static int begin_rest(Job *job) {
  int rc = lag_rest_branch_open(&job->rest, job->app->sim, job->app->extras.algebra, job->name, job->begin, job->size);
  if (rc) return failed(job, rc, job->rest.flow.message);
  double *u = malloc((size_t)job->rest.cols * sizeof *u);
  if (!u) return failed(job, LAG_ENOMEM, NULL);
  lag_rest_branch_unknowns(&job->rest, u);
  job->problem = job->rest.problem;
  rc = follow_first(job, u, NULL);
  free(u);
  return rc ? failed(job, rc, NULL) : 0;
}

/* Conserved charges keep their values unless --hold names others, or one is the parameter. */
static void hold_charges(Job *job) {
  PeriodicOrbit *o = &job->orbit;
  const lag_charges *of = job->app->scene->model->charges;
  int conserves = (lag_facts(&job->app->sim->pb) & LAG_CONSERVES_ENERGY) != 0;
  if (job->led_kind < 0 && job->app->args.hold) return;
  for (int k = 0; k < (of ? of->n : 1) && o->nheld < ORBIT_MOST_HELD - 2; k++) {
    if (of ? !(of->of[k].flags & LAG_CONSERVED) : !conserves) continue;
    if (job->led_kind >= 0 && (k == 0 || (job->led_kind == ORBIT_CHARGE && job->led_of == k))) continue;
    o->held[o->nheld++] = (OrbitHold){.kind = ORBIT_CHARGE, .of = k};
  }
}

static double led_value(Job *job) {
  PeriodicOrbit *o = &job->orbit;
  return job->led_kind == ORBIT_PERIOD  ? o->T
         : job->led_kind == ORBIT_STATE ? o->y[job->led_of]
                                        : lag_flow_charge(&o->flow, job->led_of, o->flow.t0, o->y);
}

static int begin_periodic(Job *job) {
  PeriodicOrbit *o = &job->orbit;
  App *app = job->app;
  hold_charges(job);
  int rc = lag_app_orbit_open(app, o);
  rc = rc ? rc : lag_app_orbit_solve(app, o);
  if (rc) return rc;
  if (job->led_kind >= 0) {
    o->led = o->nheld;
    o->held[o->nheld++] = (OrbitHold){.kind = (OrbitHoldKind)job->led_kind, .of = job->led_of};
    job->begin = (led_value(job) - job->offset) / job->factor;
    if (job->begin < fmin(job->low, job->high) || job->begin > fmax(job->low, job->high))
      return lag_app_error(&app->args,
                           "the periodic motion near the start has %s = %.6g, outside of %g..%g: start within: "
                           "name=VALUE, or widen the range",
                           job->name, job->begin, job->low, job->high);
  } else o->led = -1;
  o->name = job->led_kind < 0 ? job->name : NULL;
  o->parameter = job->led_kind < 0 ? job->begin : led_value(job);
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
  return rc ? failed(job, rc, NULL) : 0;
}

/* ---- The report */

static const char *kind_word(BranchKind kind, int periodic) {
  static const char *const words[] = {"",     "fold",           "branch point", "period doubling",
                                      "Hopf", "Neimark-Sacker", "collision"};
  return kind == BRANCH_COLLISION ? periodic ? "multipliers collide" : "frequencies collide" : words[kind];
}

/* The parameter at a point, in its declared unit. */
static double parameter_at(const Job *job, const Part *part, const BranchPoint *at) {
  double x = at->u[part->problem->cols - 1];
  return part->orbit && job->led_kind >= 0 ? (x * part->orbit->parameter_unit - job->offset) / job->factor
                                           : x * job->size;
}

static double period_at(const Part *part, const BranchPoint *at) {
  PeriodicOrbit *o = part->orbit;
  if (!o->flow.forced) return at->u[o->m * o->n] * o->time;
  lag_orbit_set_parameter(o, at->u[part->problem->cols - 1] * o->parameter_unit);
  return o->T;
}

/* Component i of the state [SI]; of periodic motions at the start. */
static double state_at(const Job *job, const Part *part, const BranchPoint *at, int i) {
  int nq = job->app->sim->pb.nq;
  if (part->orbit) return at->u[i] * part->orbit->unit[i];
  if (i >= nq && i < 2 * nq) return 0;
  int k = i < nq ? i : i - nq;
  return at->u[k] * job->rest.unit[k];
}

/* Sizes of the eigenvalue that grows most: of rates the real part, of multipliers the absolute value. */
static double growth_at(const Part *part, const BranchPoint *at) {
  double most = -HUGE_VAL;
  for (int i = 0; i < at->spectrum.n; i++)
    most = fmax(most, part->orbit ? hypot(at->spectrum.re[i], at->spectrum.im[i]) : at->spectrum.re[i]);
  return at->spectrum.n ? most : NAN;
}

/* most[n] := the largest value of each component over the motion. */
static void largest_values(const Job *job, const Part *part, const BranchPoint *at, double *most) {
  PeriodicOrbit *o = part->orbit;
  int n = job->app->sim->pb.n;
  for (int i = 0; i < n; i++) most[i] = state_at(job, part, at, i);
  if (!o || part->problem->place(o, at->u)) return;
  lag_sim *sim = lag_flow_sim(&o->flow, o->flow.t0, o->y);
  for (int k = 1; sim && k <= LOOKS && lag_sim_advance(sim, o->flow.t0 + o->T * k / LOOKS) == LAG_OK; k++)
    for (int i = 0; i < n; i++) most[i] = fmax(most[i], sim->now[i]);
  lag_sim_free(sim);
}

static int unstable_before(const Branch *b, const BranchPoint *at, int *after) {
  const BranchPoint *before = NULL;
  for (const BranchPoint *k = b->first; k && k != at; k = k->next) before = k;
  *after = at->next ? at->next->unstable : at->unstable;
  return before ? before->unstable : at->unstable;
}

static void put_point(FILE *f, const Job *job, const Part *part, const BranchPoint *at, const char *word) {
  char text[64];
  fprintf(f, "  %-18s %s = %s", word, job->name, lag_number_text(parameter_at(job, part, at), text));
  if (part->orbit && job->led_kind != ORBIT_PERIOD) fprintf(f, ", period %.12g s", period_at(part, at));
  for (int i = 0, shown = 0; i < job->app->sim->pb.n && shown < 4; i++) {
    Column c = lag_state_column(job->app->sim, i);
    if (!part->orbit && i >= job->app->sim->pb.nq && i < 2 * job->app->sim->pb.nq) continue;
    fprintf(f, ", %s %.8g", c.name, lag_sim_declared(job->app->sim, i, state_at(job, part, at, i)));
    shown++;
  }
  int after, before = unstable_before(&part->branch, at, &after);
  if (at->kind != BRANCH_REGULAR) fprintf(f, "; growing directions %d, then %d", before, after);
  else fprintf(f, "; growing directions %d", at->unstable);
  putc('\n', f);
}

static const char *const ends[] = {[BRANCH_AT_RANGE] = "end of the range",
                                   [BRANCH_AT_NUMBER] = "as many points as --most allows",
                                   [BRANCH_CLOSED] = "closed",
                                   [BRANCH_LOST] = "lost: no solution beside it",
                                   [BRANCH_NO_MEMORY] = "out of memory"};

static void put_text(FILE *f, const Job *job) {
  const App *app = job->app;
  fprintf(f, "%s: scene %s, %s over %s from %g to %g%s%s\n", app->scene->model->name, app->scene->name,
          job->periodic ? "periodic motions" : "states of rest", job->name, job->low, job->high,
          job->unit && job->unit->unit[0] ? " " : "", job->unit ? job->unit->unit : "");
  for (int k = 0; k < job->nparts; k++) {
    const Part *part = &job->part[k];
    fprintf(f, "branch %d%s, %d points", part->number,
            k && job->part[k - 1].number == part->number ? ", other direction" : "", part->branch.npoints);
    if (part->from) fprintf(f, ", from branch %d", part->from);
    putc('\n', f);
    for (const BranchPoint *at = part->branch.first; at; at = at->next) {
      if (at == part->branch.first) put_point(f, job, part, at, "begins");
      else if (at->kind != BRANCH_REGULAR) put_point(f, job, part, at, kind_word(at->kind, part->orbit != NULL));
      else if (!at->next) put_point(f, job, part, at, ends[part->branch.end]);
    }
  }
}

static void json_point(Json *j, const Job *job, const Part *part, const BranchPoint *at) {
  lag_json_begin(j, NULL, '{');
  lag_json_string(j, "kind", at->kind == BRANCH_REGULAR ? "end" : kind_word(at->kind, part->orbit != NULL));
  lag_json_number(j, "parameter", parameter_at(job, part, at));
  if (part->orbit) lag_json_number(j, "period", period_at(part, at));
  lag_json_begin(j, "state", '{');
  for (int i = 0; i < job->app->sim->pb.n; i++)
    lag_json_number(j, lag_state_column(job->app->sim, i).name,
                    lag_sim_declared(job->app->sim, i, state_at(job, part, at, i)));
  lag_json_end(j, '}');
  lag_json_count(j, "growing", at->unstable);
  lag_json_begin(j, part->orbit ? "multipliers" : "rates", '[');
  for (int i = 0; i < at->spectrum.n; i++) {
    lag_json_begin(j, NULL, '[');
    lag_json_number(j, NULL, at->spectrum.re[i]);
    lag_json_number(j, NULL, at->spectrum.im[i]);
    lag_json_end(j, ']');
  }
  lag_json_end(j, ']');
  lag_json_end(j, '}');
}

static void put_json(FILE *f, const Job *job) {
  Json j = {.f = f};
  lag_json_begin(&j, NULL, '{');
  lag_report_json_head(job->app, &j);
  lag_json_string(&j, "of", job->periodic ? "periodic motions" : "states of rest");
  lag_json_string(&j, "over", job->name);
  lag_json_begin(&j, "branches", '[');
  for (int k = 0; k < job->nparts; k++) {
    const Part *part = &job->part[k];
    lag_json_begin(&j, NULL, '{');
    lag_json_count(&j, "branch", part->number);
    lag_json_count(&j, "from", part->from);
    lag_json_count(&j, "points", part->branch.npoints);
    lag_json_string(&j, "end", ends[part->branch.end]);
    lag_json_begin(&j, "special", '[');
    for (const BranchPoint *at = part->branch.first; at; at = at->next)
      if (at->kind != BRANCH_REGULAR || !at->next) json_point(&j, job, part, at);
    lag_json_end(&j, ']');
    lag_json_end(&j, '}');
  }
  lag_json_end(&j, ']');
  lag_json_end(&j, '}');
  putc('\n', f);
}

/* ---- Rows and picture */

enum { OF_BRANCH = 4 }; /* columns before those of the state: parameter, branch, kind, growing directions */

static int make_table(Job *job) {
  static const char *const kinds[] = {"",     "fold",           "branch point", "period doubling",
                                      "Hopf", "Neimark-Sacker", "collision"};
  App *app = job->app;
  Table *t = &app->table;
  int n = app->sim->pb.n, k = 0;
  *t = (Table){
      .ncols = OF_BRANCH + 2 + 2 * n, .keep = 0, .cols = calloc((size_t)(OF_BRANCH + 2 + 2 * n), sizeof *t->cols)};
  app->row = calloc((size_t)t->ncols, sizeof *app->row);
  if (!t->cols || !app->row) return lag_app_error(&app->args, "out of memory");
  snprintf(t->cols[k].name, sizeof t->cols[k].name, "%s", job->name);
  if (job->unit) snprintf(t->cols[k].unit, sizeof t->cols[k].unit, "%s", job->unit->unit);
  strcpy(t->cols[++k].name, "branch");
  strcpy(t->cols[++k].name, "kind");
  t->cols[k].words = kinds;
  strcpy(t->cols[++k].name, "growing");
  strcpy(t->cols[++k].name, "period");
  strcpy(t->cols[k].unit, "s");
  strcpy(t->cols[++k].name, "growth");
  for (int i = 0; i < 2 * n; i++) {
    Column c = lag_state_column(app->sim, i % n);
    if (i >= n)
      memmove(c.name + 4, c.name, sizeof c.name - 4), memcpy(c.name, "max ", 4), c.name[sizeof c.name - 1] = '\0';
    t->cols[++k] = c;
  }
  return 0;
}

static int put_rows(Job *job) {
  App *app = job->app;
  int n = app->sim->pb.n, rc = 0;
  double *most = calloc((size_t)n, sizeof *most);
  for (int k = 0; k < job->nparts && rc == 0 && most; k++)
    for (const BranchPoint *at = job->part[k].branch.first; at && rc == 0; at = at->next) {
      const Part *part = &job->part[k];
      double *row = app->row;
      largest_values(job, part, at, most);
      row[0] = parameter_at(job, part, at);
      row[1] = part->number;
      row[2] = at->kind;
      row[3] = at->unstable;
      row[4] = part->orbit ? period_at(part, at) : NAN;
      row[5] = growth_at(part, at);
      for (int i = 0; i < n; i++) {
        row[6 + i] = lag_sim_declared(app->sim, i, state_at(job, part, at, i));
        row[6 + n + i] = lag_sim_declared(app->sim, i, most[i]);
      }
      rc = lag_rows_write(&app->rows, row);
    }
  free(most);
  return rc || !most ? -1 : 0;
}

static int write_rows(Job *job) {
  App *app = job->app;
  if (!app->args.out) return 0;
  int rc = make_table(job);
  if (rc) return rc;
  if (lag_rows_open(&app->rows, app->args.out, &app->table)) return lag_app_io_error(app, app->args.out);
  rc = put_rows(job);
  return lag_rows_close(&app->rows, rc == 0) || rc ? lag_app_io_error(app, app->args.out) : 0;
}

/* Rows of the picture: the parameter and the value where it is stable, or where it is not; rows without values part
 * the branches. */
static int drawn_rows(Job *job, Table *t, double *most) {
  int rc = 0;
  for (int k = 0; k < job->nparts && rc == 0; k++) {
    const Part *part = &job->part[k];
    for (const BranchPoint *at = part->branch.first; at && rc == 0; at = at->next) {
      largest_values(job, part, at, most);
      double y = lag_sim_declared(job->app->sim, 0, most[0]), x = parameter_at(job, part, at);
      int changes = at->kind != BRANCH_REGULAR; /* here both curves meet */
      double row[] = {x, at->unstable && !changes ? NAN : y, at->unstable || changes ? y : NAN};
      rc = lag_table_add(t, row);
    }
    double gap[] = {NAN, NAN, NAN};
    rc = rc ? rc : lag_table_add(t, gap);
  }
  return rc;
}

static int draw(Job *job) {
  App *app = job->app;
  Column first = lag_state_column(app->sim, 0);
  char title[300], name[64];
  if (!app->args.svg) return 0;
  lag_table_free(&app->table);
  app->table = (Table){.ncols = 3, .keep = 1, .cols = calloc(3, sizeof *app->table.cols)};
  double *most = calloc((size_t)app->sim->pb.n, sizeof *most);
  if (!app->table.cols || !most || drawn_rows(job, &app->table, most)) {
    free(most);
    return lag_app_error(&app->args, "out of memory");
  }
  free(most);
  snprintf(name, sizeof name, "%s%.40s", job->periodic ? "max " : "", first.name);
  snprintf(app->table.cols[0].name, sizeof app->table.cols[0].name, "%s", job->name);
  if (job->unit) snprintf(app->table.cols[0].unit, sizeof app->table.cols[0].unit, "%s", job->unit->unit);
  for (int k = 1; k < 3; k++) {
    snprintf(app->table.cols[k].name, sizeof app->table.cols[k].name, "%s, %s", name,
             k == 1 ? "nothing grows" : "unstable");
    memcpy(app->table.cols[k].unit, first.unit, sizeof first.unit);
  }
  snprintf(title, sizeof title, "%s: %s, %s over %s", app->scene->model->name, app->scene->name,
           job->periodic ? "periodic motions" : "states of rest", job->name);
  if (lag_app_choose_curves(app)) return EXIT_USAGE;
  snprintf(app->drawn_ys, sizeof app->drawn_ys, "%s", name);
  app->drawn.yname = app->drawn_ys;
  return lag_app_draw_table(app, title);
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
  if (job->led_kind >= 0 || a->guess || a->period || a->hold || a->relative) return 1;
  int forced = lag_flow_open(&f, job->app->sim) == LAG_OK && f.forced;
  lag_flow_free(&f);
  return forced;
}

static int run(Job *job) {
  job->periodic = is_periodic(job);
  return job->periodic ? begin_periodic(job) : begin_rest(job);
}

static void close_job(Job *job) {
  for (int k = 0; k < job->nparts; k++) lag_branch_free(&job->part[k].branch);
  lag_rest_branch_free(&job->rest);
  for (int k = 0; k < job->ndoubled; k++) {
    lag_orbit_free(&job->doubled[k].orbit);
    lag_sim_free(job->doubled[k].like);
  }
  lag_orbit_free(&job->orbit);
}

int lag_app_continue(App *app) {
  Job job = {.app = app};
  const Args *a = &app->args;
  int rc = take_range(&job);
  rc = rc ? rc : lag_app_orbit_set_up(app);
  rc = rc ? rc : find_parameter(&job);
  if (rc == 0 && job.led_kind < 0) rc = choose_begin(&job);
  job.size = fabs(job.high - job.low);
  rc = rc ? rc : read_limits(&job);
  rc = rc ? rc : run(&job);
  if (rc == 0 && a->branches && follow_branches(&job)) rc = failed(&job, LAG_ENOMEM, NULL);
  rc = rc ? rc : write_rows(&job);
  rc = rc ? rc : draw(&job);
  if (rc == 0 && a->json) put_json(stdout, &job);
  else if (rc == 0) put_text(a->out && strcmp(a->out, "-") == 0 ? stderr : stdout, &job);
  close_job(&job);
  return rc;
}
