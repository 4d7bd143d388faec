/* Many motions in one call (lag.h): in lanes where the program has them, else one by one. */
#include <math.h>
#include <string.h>

#include "core/core.h"
#include "lanes/lane_runs.h"

typedef struct Motions {
  const lag_sim *like;
  const double *y0, *p, *t;
  double *y;
  int count, rows, next, *status;
  int motion[LAG_MOST_LANES], row[LAG_MOST_LANES]; /* in a lane: its number, rows that are there */
  lag_sim *used[LAG_MOST_LANES];                   /* memory for a lane's next motion */
} Motions;

static double *rows_of(const Motions *m, int i, int row) {
  return m->y + ((size_t)i * (size_t)m->rows + (size_t)row) * (size_t)m->like->pb.n;
}

static void clear_rows(const Motions *m, int i) {
  for (double *x = rows_of(m, i, 0), *end = rows_of(m, i, m->rows); x < end; x++) *x = NAN;
}

/* Motion i in the memory of `used`, at its start. NULL: no memory. */
static lag_sim *begin(const Motions *m, lag_sim *used, int i) {
  lag_sim *s = lag_sim_renew(used, m->like);
  if (!s) return NULL;
  const lag_model *of = s->scene->model;
  const double *p = m->p ? m->p + (size_t)i * (size_t)of->np : NULL;
  size_t n = (size_t)s->pb.n;
  for (int k = 0; p && k < of->np; k++) {
    if (isnan(p[k])) continue; /* as in `like`, or by its formula of others */
    s->p[k] = p[k];
    s->fixed[k] = 1;
  }
  if (p && s->scene->params) s->scene->params(s->scene, s->p, s->fixed);
  if (m->y0) memcpy(s->start, m->y0 + (size_t)i * n, n * sizeof *m->y0);
  lag_sim_on_step(s, m->like->on_step, m->like->on_step_context);
  clear_rows(m, i);
  return s;
}

/* Goes on with motion i to its last row. */
static int advance(const Motions *m, lag_sim *s, int i, int *row) {
  int done, rc = lag_sim_rows(s, m->rows - *row, m->t + *row, rows_of(m, i, *row), NULL, &done);
  *row += done;
  return rc;
}

static int one_by_one(Motions *m) {
  lag_sim *s = NULL;
  for (int i = 0, row = 0; i < m->count; i++, row = 0) {
    if (!(s = begin(m, s, i))) return LAG_ENOMEM;
    m->status[i] = advance(m, s, i, &row);
  }
  lag_sim_free(s);
  return LAG_OK;
}

/* ---- In lanes */

static lag_sim *next_motion(void *motions, int k) {
  Motions *m = motions;
  lag_sim *s = m->next < m->count ? begin(m, m->used[k], m->next) : NULL;
  if (m->next == m->count) return NULL;
  m->used[k] = s;
  m->motion[k] = m->next++;
  m->row[k] = 0;
  if (!s) m->status[m->motion[k]] = LAG_ENOMEM, m->count = m->next;
  return s;
}

static int advance_lane(void *motions, int k) {
  Motions *m = motions;
  return advance(m, m->used[k], m->motion[k], &m->row[k]);
}

static int follows(void *motions, int k) {
  (void)motions, (void)k;
  return 0;
}

static void end_motion(void *motions, int k, int status) {
  const Motions *m = motions;
  m->status[m->motion[k]] = status;
}

static void run_alone(void *motions, int k) {
  Motions *m = motions;
  m->row[k] = 0;
  m->used[k] = begin(m, m->used[k], m->motion[k]);
  end_motion(m, k, m->used[k] ? advance_lane(m, k) : LAG_ENOMEM);
}

/* The caller ends the batch: motions under way, and those to come. */
static void interrupt(Motions *m, unsigned busy) {
  for (int k = 0; k < LAG_MOST_LANES; k++)
    if (busy >> k & 1) m->status[m->motion[k]] = LAG_INTERRUPTED;
  for (; m->next < m->count; m->next++) {
    m->status[m->next] = LAG_INTERRUPTED;
    clear_rows(m, m->next);
  }
}

static int in_lanes(Motions *m, const LaneChoice *choice) {
  const lag_sim *like = m->like;
  int all = m->count;
  LaneRuns r = {.choice = choice, .batch = choice->kernel->new_batch(like, choice->model), .next = next_motion,
                .advance = advance_lane, .follows = follows, .end = end_motion, .alone = run_alone, .context = m};
  if (!r.batch) return LAG_ENOMEM;
  while (lag_lane_runs_fill(&r)) {
    if (lag_lane_runs_step(&r) || !like->on_step || !like->on_step(like->on_step_context, like)) continue;
    interrupt(m, r.busy);
    break;
  }
  for (int k = 0; k < LAG_MOST_LANES; k++) lag_sim_free(m->used[k]);
  choice->kernel->free_batch(r.batch);
  return m->count < all ? LAG_ENOMEM : LAG_OK;
}

/* ---- Interface */

int lag_sim_set_lanes(lag_sim *s, const lag_program *program) {
  LaneChoice c;
  if (!s) return LAG_EINVAL;
  s->lanes_4 = s->lanes_8 = NULL;
  if (!program) return lag_lanes_possible(s);
  for (int i = 0; i < program->nscenes; i++) {
    if (program->scenes[i] != s->scene) continue;
    s->lanes_4 = program->lanes_4 ? program->lanes_4[i] : NULL;
    s->lanes_8 = program->lanes_8 ? program->lanes_8[i] : NULL;
  }
  return (s->lanes_4 || s->lanes_8) && !lag_lanes_choose(s, s->lanes_4, s->lanes_8, 0, &c) ? c.lanes : 1;
}

int lag_sim_batch(const lag_sim *like, int count, const double *y0, const double *p, int rows, const double *t,
                  double *y, int *status) {
  LaneChoice choice = {.kernel = NULL};
  if (!like || count < 0 || rows < 0 || !t || !y || !status) return LAG_EINVAL;
  Motions m = {.like = like, .y0 = y0, .p = p, .t = t, .y = y, .count = count, .rows = rows, .status = status};
  if (like->lanes_4 || like->lanes_8) lag_lanes_choose(like, like->lanes_4, like->lanes_8, 0, &choice);
  return choice.kernel ? in_lanes(&m, &choice) : one_by_one(&m);
}
