/* Connections between periodic motions (connection.h). W. S. Koon, M. W. Lo, J. E. Marsden, S. D. Ross, Chaos 10
 * (2000) 427. */
#include "analysis/connection.h"

#include <math.h>
#include <string.h>

#include "lag.h"

enum { MOST_CUTS = 12, MOST_NEWTON = 20, MOST_TRIED = 400 };

static const double closed = 1e-8; /* gap in units of the motions: rounding of starts grows to some 1e-10 */

/* Cuts of one run. */
typedef struct Cuts {
  int section, n, count;
  double t0, time[MOST_CUTS], *y; /* [MOST_CUTS][n] */
} Cuts;

typedef struct Search {
  Connections *out;
  int n, section;
  double time, part;
  const double *unit; /* [n] */
  Cuts scratch;
} Search;

/* The starts of one end on one side, and the cuts of their runs. */
typedef struct Tube {
  const ConnectionEnd *end;
  int side, places;
  const ManifoldStart **start;
  Cuts *cuts;
} Tube;

/* ---- Runs */

static void at_event(void *context, int k, double t, const double *before, const double *after) {
  Cuts *c = context;
  (void)before;
  if (k != c->section || c->count == MOST_CUTS) return;
  c->time[c->count] = fabs(t - c->t0);
  memcpy(c->y + c->count++ * c->n, after, (size_t)c->n * sizeof *after);
}

/* Cuts of the run from y at time t; `stable` ones go backwards. It may end early, as in a collision. */
static int run(const Search *s, FlowMap *f, int stable, double t, const double *y, Cuts *c) {
  double along = stable ? -s->time : s->time;
  c->section = s->section, c->n = s->n, c->count = 0, c->t0 = t;
  lag_sim *sim = lag_flow_sim_along(f, t, y, along);
  if (!sim) return LAG_ENOMEM;
  sim->forwards = s->section + 1;
  lag_sim_on_event(sim, at_event, c);
  lag_sim_advance(sim, t + along);
  lag_sim_free(sim);
  return LAG_OK;
}

/* y[n] := the start at a place between two of the tube. */
static int start_at(const Search *s, const Tube *tube, double phase, double *y) {
  PeriodicOrbit *o = tube->end->orbit;
  int n = s->n, whole = (int)floor(phase), rc = LAG_OK;
  const ManifoldStart *m = tube->start[((whole % tube->places) + tube->places) % tube->places];
  double dt = (phase - whole) * o->T / tube->places, size = 0, *end = y + n, *v = end + n, *Phi = v + n;
  memcpy(end, m->at, (size_t)n * sizeof *y);
  memcpy(v, m->v, (size_t)n * sizeof *y);
  if (dt > 0) rc = lag_flow_run(&o->flow, m->t, dt, m->at, end, Phi);
  for (int i = 0; i < n && dt > 0 && rc == LAG_OK; i++) {
    v[i] = 0;
    for (int j = 0; j < n; j++) v[i] += Phi[i * n + j] * m->v[j];
  }
  for (int i = 0; i < n; i++) size += v[i] / o->unit[i] * (v[i] / o->unit[i]);
  for (int i = 0; i < n; i++) y[i] = end[i] + tube->side * s->part / sqrt(size) * v[i];
  return rc;
}

/* The same, and the cuts of its run in s->scratch. */
static int run_from(Search *s, const Tube *tube, double phase, double *y) {
  FlowMap *f = &tube->end->orbit->flow;
  int rc = start_at(s, tube, phase, y);
  return rc ? rc : run(s, f, tube->start[0]->stable, f->t0, y, &s->scratch);
}

static size_t room_of_start(int n) { return (size_t)(3 * n + n * n); }

/* ---- Newton's method on a pair of cuts */

/* A cut of each end, and their gap. */
typedef struct Gap {
  const Tube *tube[2];
  int cut[2];
  double phase[2], time[2], *start[2], *y[2]; /* starts with the room of run_from */
} Gap;

static int take_cut(Search *s, Gap *g, int e, double phase, double *y) {
  int rc = run_from(s, g->tube[e], phase, g->start[e]);
  if (rc) return rc;
  if (s->scratch.count <= g->cut[e]) return LAG_EDOMAIN;
  memcpy(y, s->scratch.y + g->cut[e] * s->n, (size_t)s->n * sizeof *y);
  g->time[e] = s->scratch.time[g->cut[e]];
  return LAG_OK;
}

static double gap_size(const Search *s, const Gap *g) {
  double most = 0;
  for (int i = 0; i < s->n; i++) most = fmax(most, fabs(g->y[0][i] - g->y[1][i]) / s->unit[i]);
  return most;
}

/* D[2][n] := derivatives of both cuts by their places, in units. */
static int differentiate(Search *s, Gap *g, double *D, double *up, double *down) {
  const double h = 1e-3;
  for (int e = 0; e < 2; e++) {
    int rc = take_cut(s, g, e, g->phase[e] + h, up);
    rc = rc ? rc : take_cut(s, g, e, g->phase[e] - h, down);
    if (rc) return rc;
    for (int i = 0; i < s->n; i++) D[e * s->n + i] = (up[i] - down[i]) / (2 * h * s->unit[i]);
  }
  return LAG_OK;
}

/* step[2] := least squares of y_0 + D_0 a - y_1 - D_1 b. 0: the cuts run side by side. */
static int newton_step(const Search *s, const Gap *g, const double *D, double *step) {
  double aa = 0, ab = 0, bb = 0, ra = 0, rb = 0;
  for (int i = 0; i < s->n; i++) {
    double a = D[i], b = -D[s->n + i], r = (g->y[1][i] - g->y[0][i]) / s->unit[i];
    aa += a * a, ab += a * b, bb += b * b, ra += a * r, rb += b * r;
  }
  double det = aa * bb - ab * ab;
  if (!(det > 1e-12 * aa * bb)) return 0;
  step[0] = (bb * ra - ab * rb) / det;
  step[1] = (aa * rb - ab * ra) / det;
  return 1;
}

/* 1: the gap closes by single shooting; 0: it does not; < 0: a status. *gap := what is left. */
static int refine_halves(Search *s, Gap *g, double *D, double *gap) {
  double step[2], *up = D + 2 * s->n, *down = up + s->n, last = HUGE_VAL;
  *gap = HUGE_VAL;
  for (int k = 0; k < MOST_NEWTON; k++) {
    for (int e = 0, rc; e < 2; e++)
      if ((rc = take_cut(s, g, e, g->phase[e], g->y[e])) != LAG_OK) return rc == LAG_ENOMEM ? rc : 0;
    *gap = gap_size(s, g);
    if (*gap < closed && *gap > 0.1 * last) return 1;
    if (k > 5 && !(*gap < 0.9 * last)) return 0;
    last = *gap;
    int rc = differentiate(s, g, D, up, down);
    if (rc || !newton_step(s, g, D, step)) return rc == LAG_ENOMEM ? rc : 0;
    double most = fmax(fabs(step[0]), fabs(step[1])), part = most > 0.5 ? 0.5 / most : 1;
    g->phase[0] += part * step[0], g->phase[1] += part * step[1];
  }
  return *gap < closed;
}

typedef struct Ends {
  const Search *s;
  Gap *g;
} Ends;

static int start_of(void *of, int e, double phase, double *y) {
  const Ends *ends = of;
  int rc = start_at(ends->s, ends->g->tube[e], phase, ends->g->start[e]);
  memcpy(y, ends->g->start[e], (size_t)ends->s->n * sizeof *y);
  return rc;
}

/* The state in the section, next to the time given after the node before it; the times of both ends follow. */
static int cut_between(Search *s, Gap *g, const LongConnection *c) {
  double part = c->time[0] / c->parts[0], near = HUGE_VAL, all = c->time[0] + c->time[1];
  int rc = run(s, c->flow, 0, c->flow->t0, c->before, &s->scratch);
  for (int k = 0; k < s->scratch.count && rc == LAG_OK; k++) {
    if (fabs(s->scratch.time[k] - part) > near) continue;
    near = fabs(s->scratch.time[k] - part);
    memcpy(g->y[0], s->scratch.y + k * s->n, (size_t)s->n * sizeof(double));
    g->time[0] = c->time[0] - part + s->scratch.time[k];
    g->time[1] = all - g->time[0];
  }
  return rc ? rc : near < part;
}

/* The same, on long motions by multiple shooting: rounding has grown where halves meet, and their gap stays. */
static int refine(Search *s, Gap *g, double *D, double *gap) {
  const double near = 0.05, small = 1e-9;
  int found = refine_halves(s, g, D, gap);
  if (found < 0 || !(*gap < near) || *gap < small) return found;
  Ends ends = {s, g};
  LongConnection c = {.flow = &g->tube[0]->end->orbit->flow, .n = s->n, .unit = s->unit, .of = &ends,
                      .start = start_of, .before = g->y[1]};
  for (int e = 0; e < 2; e++) {
    c.phase[e] = g->phase[e], c.time[e] = g->time[e];
    c.rate = fmax(c.rate, g->tube[e]->start[0]->rate);
  }
  int rc = lag_connection_refine(&c);
  if (rc == LAG_ENOMEM) return rc;
  if (rc || !(c.residual < fmin(closed, *gap))) {
    for (int e = 0; e < 2 && found; e++) start_of(&ends, e, g->phase[e], g->y[1]);
    return found;
  }
  for (int e = 0; e < 2; e++) g->phase[e] = c.phase[e];
  *gap = c.residual;
  return cut_between(s, g, &c);
}

/* ---- Pairs of cuts that cross */

/* Whether lines y_0 + a (z_0 - y_0) and y_1 + b (z_1 - y_1) meet within both, but for a third of their lengths.
 * D[2][n]: their directions, in units. */
static int lines_meet(const Search *s, double *const y[2], double *const z[2], double ab[2], double *D) {
  const double beyond = 0.1, apart = 0.3;
  Gap g = {.y = {y[0], y[1]}};
  double left = 0, size = 0;
  int n = s->n;
  for (int e = 0; e < 2; e++)
    for (int i = 0; i < n; i++) D[e * s->n + i] = (z[e][i] - y[e][i]) / s->unit[i];
  if (!newton_step(s, &g, D, ab)) return 0;
  for (int e = 0; e < 2; e++)
    if (ab[e] < -beyond || ab[e] > 1 + beyond) return 0;
  for (int i = 0; i < n; i++) {
    double r = (y[0][i] - y[1][i]) / s->unit[i] + ab[0] * D[i] - ab[1] * D[s->n + i];
    left += r * r, size += D[i] * D[i] + D[s->n + i] * D[s->n + i];
  }
  return left < apart * apart * size;
}

static double turned(double phase, int places) { return phase - places * floor(phase / places); }

static int is_known(const Connections *c, const Gap *g) {
  const double same = 1e-5;
  for (const Connection *k = c->first; k; k = k->next) {
    double off = turned(k->from.phase - g->phase[0], g->tube[0]->places);
    if (k->from.side == g->tube[0]->side && fmin(off, g->tube[0]->places - off) < same) return 1;
  }
  return 0;
}

static int keep(Search *s, const Gap *g, double gap) {
  Connections *c = s->out;
  size_t n = (size_t)s->n, room = sizeof(Connection) / sizeof(double) + 1;
  Connection *k = (Connection *)(void *)lag_pool_doubles(&c->pool, room + 3 * n);
  if (!k) return LAG_ENOMEM;
  double *states = (double *)(void *)k + room;
  *k = (Connection){.from = *g->tube[0]->end, .to = *g->tube[1]->end, .residual = gap, .at = states};
  memcpy(k->at, g->y[0], n * sizeof *states);
  for (int e = 0; e < 2; e++) {
    ConnectionEnd *end = e ? &k->to : &k->from;
    end->side = g->tube[e]->side, end->cut = g->cut[e] + 1, end->time = g->time[e];
    end->phase = turned(g->phase[e], g->tube[e]->places);
    end->start = memcpy(states + (size_t)(1 + e) * n, g->start[e], n * sizeof *states);
  }
  Connection **at = &c->first;
  while (*at && (*at)->from.time + (*at)->to.time < k->from.time + k->to.time) at = &(*at)->next;
  k->next = *at;
  *at = k;
  c->count++;
  return LAG_OK;
}

/* Cells i, j of both tubes, all pairs of cuts. */
static int try_cells(Search *s, const Tube *a, const Tube *b, int i, int j, Gap *g, double *D) {
  const Cuts *cuts[2][2] = {{&a->cuts[i], &a->cuts[(i + 1) % a->places]}, {&b->cuts[j], &b->cuts[(j + 1) % b->places]}};
  int rc = LAG_OK, n = s->n;
  for (int k = 0; k < cuts[0][0]->count && k < cuts[0][1]->count; k++)
    for (int l = 0; l < cuts[1][0]->count && l < cuts[1][1]->count && rc == LAG_OK; l++) {
      double ab[2], gap, *y[2] = {cuts[0][0]->y + k * n, cuts[1][0]->y + l * n},
                         *z[2] = {cuts[0][1]->y + k * n, cuts[1][1]->y + l * n};
      if (s->out->tried >= MOST_TRIED || !lines_meet(s, y, z, ab, D)) continue;
      s->out->tried++;
      g->tube[0] = a, g->tube[1] = b, g->cut[0] = k, g->cut[1] = l;
      g->phase[0] = i + ab[0], g->phase[1] = j + ab[1];
      rc = refine(s, g, D, &gap);
      if (rc == 0) s->out->nearest = fmin(s->out->nearest, gap);
      rc = rc == 1 && !is_known(s->out, g) ? keep(s, g, gap) : rc < 0 ? rc : LAG_OK;
    }
  return rc;
}

/* ---- The search */

/* tube := the starts on one side with their cuts. LAG_EMETHOD: there are several directions. */
static int open_tube(Search *s, Tube *tube, const ConnectionEnd *end, int side) {
  Pool *pool = &s->out->pool;
  *tube = (Tube){.end = end, .side = side};
  for (const ManifoldStart *m = end->manifold->first; m; m = m->next) tube->places += m->side == side;
  size_t N = (size_t)tube->places, pointers = sizeof(void *) / sizeof(double) + 1;
  tube->start = (const ManifoldStart **)(void *)lag_pool_doubles(pool, N * pointers + 1);
  tube->cuts = (Cuts *)(void *)lag_pool_doubles(pool, N * (sizeof(Cuts) / sizeof(double) + 1));
  double *y = lag_pool_doubles(pool, N * MOST_CUTS * (size_t)s->n);
  if (pool->failed) return LAG_ENOMEM;
  int rc = LAG_OK;
  for (const ManifoldStart *m = end->manifold->first; m && rc == LAG_OK; m = m->next) {
    if (m->side != side) continue;
    if (m->phase >= tube->places || tube->start[m->phase]) return LAG_EMETHOD;
    tube->start[m->phase] = m;
    tube->cuts[m->phase].y = y + m->phase * MOST_CUTS * s->n;
    rc = run(s, &end->orbit->flow, m->stable, m->t, m->y, &tube->cuts[m->phase]);
  }
  return rc;
}

static int pair_tubes(Search *s, const Tube *a, const Tube *b) {
  size_t n = (size_t)s->n;
  Pool *pool = &s->out->pool;
  Gap g;
  for (int e = 0; e < 2; e++) {
    g.start[e] = lag_pool_doubles(pool, room_of_start(s->n));
    g.y[e] = lag_pool_doubles(pool, n);
  }
  double *D = lag_pool_doubles(pool, 4 * n);
  int rc = pool->failed ? LAG_ENOMEM : LAG_OK;
  for (int i = 0; i < a->places; i++)
    for (int j = 0; j < b->places && rc == LAG_OK; j++) rc = try_cells(s, a, b, i, j, &g, D);
  return rc;
}

int lag_connections_find(Connections *c, const ConnectionEnd *from, const ConnectionEnd *to, int section, double time,
                         double part) {
  *c = (Connections){.nearest = HUGE_VAL};
  Search s = {.out = c, .n = from->orbit->n, .section = section, .time = time, .part = part, .unit = from->orbit->unit};
  Tube a[2], b[2];
  int rc = LAG_OK;
  s.scratch.y = lag_pool_doubles(&c->pool, MOST_CUTS * (size_t)s.n);
  if (c->pool.failed) return LAG_ENOMEM;
  for (int k = 0; k < 2 && rc == LAG_OK; k++) {
    rc = open_tube(&s, &a[k], from, k ? -1 : 1);
    rc = rc ? rc : open_tube(&s, &b[k], to, k ? -1 : 1);
  }
  for (int k = 0; k < 4 && rc == LAG_OK; k++) rc = pair_tubes(&s, &a[k / 2], &b[k % 2]);
  return rc;
}

void lag_connections_free(Connections *c) { lag_pool_free(&c->pool); }
