/* Closing of a periodic motion (periodic_orbit.h): turns of angles, symmetries of charges, shifts, exchanges of
 * coordinates, or the middle of one that is the same backwards in time. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/periodic_orbit.h"
#include "numeric/dense.h"

/* E[size * size] := exp(c G), by scaling and squaring of its series: G. H. Golub, C. F. Van Loan, Matrix Computations,
 * 4th ed. (2013), 9.3. scratch[2 * size * size]. */
static void matrix_exponential(int size, const double *G, double c, double *E, double *scratch) {
  double norm = 0, *term = scratch, *next = scratch + size * size;
  int halvings = 0;
  for (int e = 0; e < size * size; e++) norm += fabs(c * G[e]);
  for (; norm > 0.5; norm /= 2) halvings++;
  double part = ldexp(c, -halvings);
  for (int e = 0; e < size * size; e++) E[e] = term[e] = e % (size + 1) == 0;
  for (int k = 1; k <= 24 + halvings; k++) {
    const double *left = k <= 24 ? term : E, *right = k <= 24 ? G : E;
    lag_multiply(size, size, size, left, right, next);
    for (int i = 0; i < size * size && k <= 24; i++) next[i] = next[i] * part / k;
    memcpy(k <= 24 ? term : E, next, (size_t)(size * size) * sizeof *E);
    for (int e = 0; e < size * size && k <= 24; e++) E[e] += term[e];
  }
}

/* y[n] := the affine map E of the coordinates, and its linear part of the velocities; linear: of the coordinates,
 * too. */
static void act(const PeriodicOrbit *o, const double *E, int linear, double *y, double *scratch) {
  int nq = o->flow.nq, size = nq + 1;
  for (int i = 0; i < 2 * nq; i++) {
    const double *row = E + i % nq * size, *x = y + i / nq * nq;
    scratch[i] = i < nq && !linear ? row[nq] : 0;
    for (int j = 0; j < nq; j++) scratch[i] += row[j] * x[j];
  }
  memcpy(y, scratch, 2 * (size_t)nq * sizeof *y);
}

/* y[n] := G y; d[n], unless NULL, := its derivative by shift j. */
void lag_orbit_close_motion(const PeriodicOrbit *o, double *y, int linear, int j, double *d) {
  int size = o->flow.nq + 1;
  double *E = o->w, *scratch = E + size * size;
  if (o->closing) {
    lag_map_apply(o->closing, y, scratch);
    memcpy(y, scratch, (size_t)o->n * sizeof *y);
  }
  for (int k = o->ngroup - 1; k >= 0; k--) {
    const double *G = o->affine + k * size * size;
    matrix_exponential(size, G, o->shift[k], E, scratch);
    if (d && k < j) act(o, E, 1, d, scratch);
    act(o, E, linear, y, scratch);
    if (!d || k != j) continue;
    memset(d, 0, (size_t)o->n * sizeof *d);
    memcpy(d, y, 2 * (size_t)o->flow.nq * sizeof *d);
    act(o, G, linear, d, scratch);
  }
  for (int i = 0; i < o->n && !linear; i++) y[i] += o->turns[i];
}

/* target := the image of the middle, on which nothing but the middle itself depends. */
static void set_middle(PeriodicOrbit *o) {
  int n = o->n;
  lag_map_apply(o->reverse, o->end + (o->m - 1) * n, o->target);
  for (int i = 0; i < n; i++) o->target[i] += o->offset[i] + o->turns[i];
  memset(o->G, 0, (size_t)(n * n) * sizeof *o->G);
}

/* target and G at the present y and shifts. */
void lag_orbit_set_target(PeriodicOrbit *o) {
  int n = o->n;
  if (o->half) {
    set_middle(o);
    return;
  }
  memcpy(o->target, o->y, (size_t)n * sizeof *o->y);
  lag_orbit_close_motion(o, o->target, 0, -1, NULL);
  for (int c = 0; c < n; c++) {
    double *e = o->x;
    memset(e, 0, (size_t)n * sizeof *e);
    e[c] = 1;
    if (o->ngroup || o->closing) lag_orbit_close_motion(o, e, 1, -1, NULL);
    for (int r = 0; r < n; r++) o->G[r * n + c] = e[r];
  }
}

int lag_orbit_check_maps(const PeriodicOrbit *o, FlowMap *f, double T) {
  int forward = !o->closing || lag_flow_has_symmetry(f, o->closing, f->forced ? T : 0);
  if (forward && o->reverse && f->kicks) {
    snprintf(f->message, sizeof f->message, "--reverse: kicks are not the same backwards; leave it out");
    return LAG_EMETHOD;
  }
  if (forward && (!o->reverse || lag_flow_has_symmetry(f, o->reverse, 0))) return LAG_OK;
  snprintf(f->message, sizeof f->message,
           forward ? "--reverse: motions of this scene are not the same backwards in time with this map, which turns "
                     "round velocities and the coordinates that it names; friction spoils that, as does a drive that "
                     "is not even about the start"
                   : "--relative: this exchange of coordinates is not a symmetry of the equations of motion");
  return LAG_EMETHOD;
}

/* Whether what closes the motion leaves charge k beside the start: a mirror turns an angular momentum round. */
static int keeps_charge(PeriodicOrbit *o, int k) {
  const double same = 1e-9;
  double *y = o->x, *image = y + o->n;
  if (!o->closing) return 1;
  for (int i = 0; i < o->n; i++) y[i] = o->y[i] + 0.05 * (1 + i % 3) * o->unit[i];
  lag_map_apply(o->closing, y, image);
  double before = lag_flow_charge(&o->flow, k, o->flow.t0, y), size = o->flow.probe->charge_now[2 * k + 1];
  return fabs(lag_flow_charge(&o->flow, k, o->flow.t0, image) - before) <= same * fmax(size, fabs(before));
}

int lag_orbit_list_charges(PeriodicOrbit *o) {
  int size = o->flow.nq + 1, rc = LAG_OK;
  for (int k = 0; k < lag_flow_charges(&o->flow); k++)
    if (lag_flow_conserves(&o->flow, k) && keeps_charge(o, k)) o->charge[o->ncharges++] = k;
  for (int j = 0; j < o->ngroup && rc == LAG_OK; j++) {
    const OrbitClosing *c = &o->group[j];
    double *G = o->affine + j * size * size;
    if (c->n) {
      memset(G, 0, (size_t)(size * size) * sizeof *G);
      for (int i = 0; i < c->n; i++) G[c->shifted[i] * size + size - 1] = 1;
      if (!lag_flow_shifts(&o->flow, c->n, c->shifted)) rc = LAG_EMETHOD;
    } else rc = lag_flow_affine(&o->flow, c->charge, o->flow.t0, o->y, G);
    if (rc && c->n)
      snprintf(o->flow.message, sizeof o->flow.message,
               "--relative %s: the equations of motion or the events depend on where it is; coordinates that move "
               "together are written with +: --relative x[1]+x[2]",
               o->flow.like->scene->model->q[c->shifted[0]].name);
    else if (rc)
      snprintf(o->flow.message, sizeof o->flow.message,
               "the symmetry of %s is not an affine map of the coordinates, such as a shift or a rotation",
               o->flow.like->scene->model->charges->of[c->charge].name);
  }
  return rc;
}

/* Square of the distance of the end of the motion from G y(0), in units. */
static double miss(PeriodicOrbit *o) {
  double sum = 0;
  lag_orbit_set_target(o);
  for (int i = 0; i < o->n; i++) {
    double gap = (o->end[(o->m - 1) * o->n + i] - o->target[i]) / o->unit[i];
    sum += gap * gap;
  }
  return sum;
}

void lag_orbit_guess_shifts(PeriodicOrbit *o) {
  enum { TRIES = 32, ROUNDS = 3 };
  const double half = acos(-1);
  for (int j = 0; j < o->ngroup; j++) {
    int i = o->group[j].shifted[0];
    if (o->group[j].n) o->shift[j] = o->end[(o->m - 1) * o->n + i] - o->y[i];
  }
  for (int j = 0; j < o->ngroup * ROUNDS; j++) {
    double *shift = &o->shift[j % o->ngroup], width = half / pow(TRIES / 2, j / o->ngroup), middle = *shift,
           best = middle;
    double least = miss(o);
    for (int k = -TRIES; k <= TRIES && !o->group[j % o->ngroup].n; k++) {
      *shift = middle + width * k / TRIES;
      double off = miss(o);
      if (off < least) best = *shift, least = off;
    }
    *shift = best;
  }
  lag_orbit_set_target(o);
}
