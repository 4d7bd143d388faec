/* The report of --continue. Enters: branches; leaves: the points where one changes, as text or JSON; all points as rows
 * and a picture. */
#include "app/continue_branches.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- The report */

static const char *kind_word(BranchKind kind, int periodic) {
  static const char *const words[] = {"",     "fold",           "branch point", "period doubling",
                                      "Hopf", "Neimark-Sacker", "collision"};
  return kind == BRANCH_COLLISION ? periodic ? "multipliers collide" : "frequencies collide" : words[kind];
}

const char *lag_continue_solutions(const Job *job) {
  return job->periodic ? "periodic motions" : job->steady.cols ? "steady motions" : "states of rest";
}

/* The parameter at a point, in its declared unit. */
static double parameter_at(const Job *job, const Part *part, const BranchPoint *at) {
  double x = at->u[part->problem->cols - 1];
  double unit = part->orbit ? part->orbit->parameter_unit : job->steady.parameter_unit;
  return job->led_kind >= 0 ? (x * unit - job->offset) / job->factor : x * job->size;
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
  if (at->shown) return at->shown[i];
  if (part->orbit) return at->u[i] * part->orbit->unit[i];
  if (job->steady.cols) return at->u[i] * job->steady.steady.unit[i];
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

/* Height of the parabola through three values above the one in the middle, where that is the largest. */
static double crest(double before, double y, double after) {
  double up = y - before, down = y - after;
  return up >= 0 && down >= 0 && up + down > 0 ? (up - down) * (up - down) / (8 * (up + down)) : 0;
}

/* most[n] := the largest value of each component over the motion. */
static void largest_values(const Job *job, const Part *part, const BranchPoint *at, double *most) {
  PeriodicOrbit *o = part->orbit;
  int n = job->app->sim->pb.n;
  for (int i = 0; i < n; i++) most[i] = state_at(job, part, at, i);
  if (!o || part->problem->place(o, at->u)) return;
  double *last = o->x, *before = o->x + n;
  lag_sim *sim = lag_flow_sim(&o->flow, o->flow.t0, o->y);
  for (int i = 0; i < n; i++) last[i] = before[i] = o->y[i];
  for (int k = 1; sim && k <= LOOKS && lag_sim_advance(sim, o->flow.t0 + o->T * k / LOOKS) == LAG_OK; k++)
    for (int i = 0; i < n; i++) {
      double now = sim->now[i], top = k > 1 ? crest(before[i], last[i], now) : 0;
      most[i] = fmax(most[i], fmax(now, last[i] + top));
      before[i] = last[i], last[i] = now;
    }
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
    if (!part->orbit && !job->steady.cols && i >= job->app->sim->pb.nq && i < 2 * job->app->sim->pb.nq) continue;
    fprintf(f, ", %s %.8g", c.name, lag_sim_declared(job->app->sim, i, state_at(job, part, at, i)));
    shown++;
  }
  int after, before = unstable_before(&part->branch, at, &after);
  if (at->kind != BRANCH_REGULAR) fprintf(f, "; growing directions %d, then %d", before, after);
  else fprintf(f, "; growing directions %d", at->unstable);
  putc('\n', f);
  if (at->unfollowed) fprintf(f, "    the branch from there is not followed: %s\n", at->unfollowed);
}

static const char *const ends[] = {[BRANCH_AT_RANGE] = "end of the range",
                                   [BRANCH_AT_NUMBER] = "as many points as --most allows",
                                   [BRANCH_CLOSED] = "closed",
                                   [BRANCH_LOST] = "lost: no solution beside it",
                                   [BRANCH_NO_MEMORY] = "out of memory"};

void lag_continue_put_text(FILE *f, const Job *job) {
  const App *app = job->app;
  fprintf(f, "%s: scene %s, %s over %s from %g to %g%s%s\n", app->scene->model->name, app->scene->name,
          lag_continue_solutions(job), job->name, job->low, job->high,
          job->unit && job->unit->unit[0] ? " " : "", job->unit ? job->unit->unit : "");
  for (int k = 0; k < job->nparts; k++) {
    const Part *part = &job->part[k];
    fprintf(f, "branch %d%s, %d points", part->number,
            k == 0 && job->resumed ? ", goes on"
            : part->second ? ", other direction" : "",
            part->branch.npoints);
    if (part->from) fprintf(f, ", from branch %d", part->from);
    putc('\n', f);
    for (const BranchPoint *at = part->branch.first; at; at = at->next) {
      if (at == part->branch.first) put_point(f, job, part, at, "begins");
      else if (at->kind != BRANCH_REGULAR) put_point(f, job, part, at, kind_word(at->kind, part->orbit != NULL));
      else if (!at->next) put_point(f, job, part, at, ends[part->branch.end]);
    }
    if (part->branch.npoints == 1) fprintf(f, "  %s\n", ends[part->branch.end]);
    if (part->why[0]) fprintf(f, "  %s%s\n", part->branch.end == BRANCH_LOST ? "it ends there: " : "", part->why);
  }
}

static void json_point(Json *j, const Job *job, const Part *part, const BranchPoint *at) {
  lag_json_begin(j, NULL, '{');
  lag_json_string(j, "kind", at->kind == BRANCH_REGULAR ? "end" : kind_word(at->kind, part->orbit != NULL));
  lag_json_number(j, "parameter", parameter_at(job, part, at));
  if (part->orbit) lag_json_number(j, "period", period_at(part, at));
  JSON_EACH(j, "state", '{', i, job->app->sim->pb.n)
    lag_json_number(j, lag_state_column(job->app->sim, i).name,
                    lag_sim_declared(job->app->sim, i, state_at(job, part, at, i)));
  lag_json_count(j, "growing", at->unstable);
  if (at->unfollowed) lag_json_string(j, "unfollowed", at->unfollowed);
  JSON_EACH(j, part->orbit ? "multipliers" : "rates", '[', i, at->spectrum.n)
    lag_json_row(j, NULL, 2, (const double[]){at->spectrum.re[i], at->spectrum.im[i]});
  lag_json_end(j, '}');
}

void lag_continue_put_json(FILE *f, const Job *job) {
  Json j = lag_report_json_open(job->app, f);
  lag_json_strings(&j, {"of", lag_continue_solutions(job)}, {"over", job->name});
  JSON_OBJECTS(&j, "branches", k, job->nparts) {
    const Part *part = &job->part[k];
    lag_json_counts(&j, {"branch", part->number}, {"from", part->from}, {"points", part->branch.npoints});
    lag_json_string(&j, "end", ends[part->branch.end]);
    if (part->why[0]) lag_json_string(&j, "why", part->why);
    lag_json_begin(&j, "special", '[');
    for (const BranchPoint *at = part->branch.first; at; at = at->next)
      if (at->kind != BRANCH_REGULAR || !at->next) json_point(&j, job, part, at);
    lag_json_end(&j, ']');
  }
  lag_json_close(&j);
}

/* ---- Rows and picture */

static void add_column(Table *t, const char *name, const char *unit, const char *const *words) {
  Column *c = &t->cols[t->ncols++];
  snprintf(c->name, sizeof c->name, "%.95s", name);
  snprintf(c->unit, sizeof c->unit, "%s", unit);
  c->words = words;
}

int lag_continue_make_table(Job *job) {
  static const char *const kinds[] = {"",     "fold",           "branch point", "period doubling",
                                      "Hopf", "Neimark-Sacker", "collision",    NULL},
                    *const last[] = {"", "range", "number", "closed", "lost", NULL};
  static const char *by[] = {"", NULL, NULL};
  App *app = job->app;
  Table *t = &app->table;
  int n = app->sim->pb.n;
  size_t most = (size_t)(OF_STATE + 2 * n + 2);
  *t = (Table){.keep = 1, .cols = calloc(most, sizeof *t->cols)};
  app->row = calloc(most, sizeof *app->row);
  if (!t->cols || !app->row) return lag_app_error(&app->args, "out of memory");
  add_column(t, job->name, job->unit ? job->unit->unit : "", NULL);
  add_column(t, "branch", "", NULL);
  add_column(t, "kind", "", kinds);
  add_column(t, "growing", "", NULL);
  add_column(t, "period", "s", NULL);
  add_column(t, "growth", "", NULL);
  for (int i = 0; i < 2 * n; i++) {
    Column c = lag_state_column(app->sim, i % n);
    char name[sizeof c.name + 4];
    snprintf(name, sizeof name, "%s%s", i < n ? "" : "max ", c.name);
    add_column(t, name, c.unit, NULL);
  }
  lag_continue_describe(job);
  by[1] = job->written_by;
  add_column(t, "end", "", last);
  add_column(t, "written by", "", by);
  return 0;
}

/* Rows of a part; without its first point, which the file has, where it goes on from a row. */
static int add_part(Job *job, const Part *part, int goes_on, double *most) {
  Table *t = &job->app->table;
  double *row = job->app->row;
  int n = job->app->sim->pb.n, rc = 0;
  for (const BranchPoint *at = goes_on ? part->branch.first->next : part->branch.first; at && rc == 0; at = at->next) {
    largest_values(job, part, at, most);
    row[0] = parameter_at(job, part, at);
    row[1] = part->number;
    row[2] = at->kind;
    row[3] = at->unstable;
    row[OF_PERIOD] = part->orbit ? period_at(part, at) : NAN;
    row[5] = growth_at(part, at);
    for (int i = 0; i < n; i++) {
      row[OF_STATE + i] = lag_sim_declared(job->app->sim, i, state_at(job, part, at, i));
      row[OF_STATE + n + i] = lag_sim_declared(job->app->sim, i, most[i]);
    }
    row[t->ncols - 2] = at->next ? 0 : 1 + part->branch.end;
    row[t->ncols - 1] = t->nrows == 0;
    rc = lag_table_add(t, row);
  }
  return rc;
}

/* Adds the rows of all parts; those of a branch that goes on follow its last row. */
static int add_rows(Job *job) {
  Table *t = &job->app->table;
  size_t kept = t->nrows, width = (size_t)t->ncols * sizeof *t->data, at = job->resumed;
  double *most = calloc((size_t)job->app->sim->pb.n, sizeof *most), *rest = NULL;
  int rc = most ? 0 : -1;
  if (at) {
    rest = malloc((kept - at + 1) * width);
    if (!rest) rc = -1;
    else memcpy(rest, t->data + at * (size_t)t->ncols, (kept - at) * width);
    t->nrows = at;
    if (job->part[0].branch.first->next) t->data[at * (size_t)t->ncols - 2] = 0;
    rc = rc ? rc : add_part(job, &job->part[0], 1, most);
    for (size_t k = 0; k < kept - at && rc == 0; k++) rc = lag_table_add(t, rest + k * (size_t)t->ncols);
  }
  for (int k = at != 0; k < job->nparts && rc == 0; k++) rc = add_part(job, &job->part[k], 0, most);
  free(rest);
  free(most);
  return rc;
}

int lag_continue_write_rows(Job *job) {
  App *app = job->app;
  const char *out = app->args.out ? app->args.out : app->args.resume;
  if (!out && !app->args.svg) return 0;
  if (add_rows(job)) return lag_app_error(&app->args, "out of memory");
  return out ? lag_app_write_table(app, out, &app->table) : 0;
}

/* Rows of the picture: the parameter and the value where it is stable, or where it is not; rows without values part
 * the branches. */
static int drawn_rows(const Table *of, int value, Table *t) {
  int rc = 0;
  for (size_t k = 0; k < of->nrows && rc == 0; k++) {
    const double *row = of->data + k * (size_t)of->ncols, x = row[0], y = row[value];
    int changes = row[2] != 0.0, unstable = row[3] != 0.0; /* at a change both curves meet */
    double drawn[] = {x, unstable && !changes ? NAN : y, unstable || changes ? y : NAN}, gap[] = {NAN, NAN, NAN};
    rc = lag_table_add(t, drawn);
    if (rc == 0 && row[of->ncols - 2] != 0.0) rc = lag_table_add(t, gap);
  }
  return rc;
}

int lag_continue_draw(Job *job) {
  App *app = job->app;
  Column first = lag_state_column(app->sim, 0);
  char title[300], name[64];
  if (!app->args.svg) return 0;
  Table all = app->table;
  app->table = (Table){.ncols = 3, .keep = 1, .cols = calloc(3, sizeof *app->table.cols)};
  int rc = app->table.cols ? drawn_rows(&all, OF_STATE + app->sim->pb.n, &app->table) : -1;
  lag_table_free(&all);
  if (rc) return lag_app_error(&app->args, "out of memory");
  snprintf(name, sizeof name, "%s%.40s", job->periodic ? "max " : "", first.name);
  snprintf(app->table.cols[0].name, sizeof app->table.cols[0].name, "%s", job->name);
  if (job->unit) snprintf(app->table.cols[0].unit, sizeof app->table.cols[0].unit, "%s", job->unit->unit);
  for (int k = 1; k < 3; k++) {
    snprintf(app->table.cols[k].name, sizeof app->table.cols[k].name, "%s, %s", name,
             k == 1 ? "nothing grows" : "unstable");
    memcpy(app->table.cols[k].unit, first.unit, sizeof first.unit);
  }
  snprintf(title, sizeof title, "%s: %s, %s over %s", app->scene->model->name, app->scene->name,
           lag_continue_solutions(job), job->name);
  if (lag_app_choose_curves(app)) return EXIT_USAGE;
  snprintf(app->drawn_ys, sizeof app->drawn_ys, "%s", name);
  app->drawn.yname = app->drawn_ys;
  return lag_app_draw_table(app, title);
}
