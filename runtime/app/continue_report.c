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
            k && job->part[k - 1].number == part->number ? ", other direction" : "", part->branch.npoints);
    if (part->from) fprintf(f, ", from branch %d", part->from);
    putc('\n', f);
    for (const BranchPoint *at = part->branch.first; at; at = at->next) {
      if (at == part->branch.first) put_point(f, job, part, at, "begins");
      else if (at->kind != BRANCH_REGULAR) put_point(f, job, part, at, kind_word(at->kind, part->orbit != NULL));
      else if (!at->next) put_point(f, job, part, at, ends[part->branch.end]);
    }
    if (part->branch.npoints == 1) fprintf(f, "  %s\n", ends[part->branch.end]);
    if (part->why[0]) fprintf(f, "  it ends there: %s\n", part->why);
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
  if (at->unfollowed) lag_json_string(j, "unfollowed", at->unfollowed);
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

void lag_continue_put_json(FILE *f, const Job *job) {
  Json j = {.f = f};
  lag_json_begin(&j, NULL, '{');
  lag_report_json_head(job->app, &j);
  lag_json_string(&j, "of", lag_continue_solutions(job));
  lag_json_string(&j, "over", job->name);
  lag_json_begin(&j, "branches", '[');
  for (int k = 0; k < job->nparts; k++) {
    const Part *part = &job->part[k];
    lag_json_begin(&j, NULL, '{');
    lag_json_count(&j, "branch", part->number);
    lag_json_count(&j, "from", part->from);
    lag_json_count(&j, "points", part->branch.npoints);
    lag_json_string(&j, "end", ends[part->branch.end]);
    if (part->why[0]) lag_json_string(&j, "why", part->why);
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

int lag_continue_write_rows(Job *job) {
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

int lag_continue_draw(Job *job) {
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
           lag_continue_solutions(job), job->name);
  if (lag_app_choose_curves(app)) return EXIT_USAGE;
  snprintf(app->drawn_ys, sizeof app->drawn_ys, "%s", name);
  app->drawn.yname = app->drawn_ys;
  return lag_app_draw_table(app, title);
}
