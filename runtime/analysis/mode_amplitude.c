/* Frequency over amplitude (mode_amplitude.h): periods of motions with some small amplitudes, and the polynomial
 * through them. For a normal form the same coefficients follow from derivatives of H up to the sixth; here each
 * motion is solved exactly, so that only the polynomial is cut off. */
#include "analysis/mode_amplitude.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "numeric/dense.h"

enum { POINTS = 7, LOOKS = 64 };

/* Whether the mode is undamped, and no other rate is a multiple of its own, 0 included: A. M. Lyapunov's theorem, by
 * which rates that grow or decay are no obstacle. */
static int has_family(const Modes *modes, int k) {
  const double near = 1e-3, undamped = 1e-9;
  const Mode *m = &modes->mode[k];
  if (!(m->im > 0) || fabs(m->re) > undamped * m->im || m->repeats > 1) return 0;
  for (int i = 0; i < modes->n; i++) {
    double ratio = modes->mode[i].im / m->im, growth = modes->mode[i].re / m->im;
    if (i != k && hypot(ratio - rint(ratio), growth) < near) return 0;
  }
  return 1;
}

/* Turning value of coordinate i near y at t: y moves there. */
static double turning_value(FlowMap *f, int i, double t, double *y) {
  for (int step = 0; step < 3; step++) {
    if (lag_flow_rates(f, t, y, f->up) || f->up[f->nq + i] == 0.0) return NAN;
    double dt = -y[f->nq + i] / f->up[f->nq + i];
    if (fabs(dt) < 1e-14 * (1 + fabs(t))) break;
    if (lag_flow_run(f, t, dt, y, f->square, NULL)) return NAN;
    memcpy(y, f->square, (size_t)f->n * sizeof *y);
    t += dt;
  }
  return y[i];
}

/* Half the swing of coordinate i. */
static double swing(PeriodicOrbit *o, int i) {
  double *high = o->x, *low = high + o->n;
  lag_sim *sim = lag_flow_sim(&o->flow, o->flow.t0, o->y);
  memcpy(high, o->y, (size_t)o->n * sizeof *high);
  memcpy(low, o->y, (size_t)o->n * sizeof *low);
  for (int k = 1; k <= LOOKS && sim && lag_sim_advance(sim, o->flow.t0 + o->T * k / LOOKS) == LAG_OK; k++) {
    if (sim->now[i] > high[i]) memcpy(high, sim->now, (size_t)o->n * sizeof *high);
    if (sim->now[i] < low[i]) memcpy(low, sim->now, (size_t)o->n * sizeof *low);
  }
  lag_sim_free(sim);
  return (turning_value(&o->flow, i, o->flow.t0, high) - turning_value(&o->flow, i, o->flow.t0, low)) / 2;
}

/* *T, *A := period and half the swing of the motion with coordinate `leads` at `value`, near the start. 0: none. */
static int solve(lag_sim *start, const lag_algebra *algebra, int leads, double value, double *T, double *A) {
  PeriodicOrbit o = {.nheld = 1, .held = {{.kind = ORBIT_STATE, .of = leads, .value = value}}};
  double about = *T;
  int rc = lag_orbit_open(&o, start, algebra, *T, 0);
  int found = rc == LAG_OK && lag_orbit_solve(&o) == 1 && lag_orbit_refine(&o) == LAG_OK && !o.at_rest;
  *T = o.T;
  *A = found ? swing(&o, leads) : NAN;
  lag_orbit_free(&o);
  return found && isfinite(*A) && fabs(*T - about) < 0.2 * about;
}

/* c[count] := coefficients of the powers of A^2 from the first on, through (A[k], r[k]). */
static int fit(int count, const double *A, const double *r, double *c) {
  double M[POINTS * POINTS], unit = A[count - 1] * A[count - 1];
  for (int i = 0; i < count; i++) {
    double x = A[i] * A[i] / unit;
    for (int j = 0; j < count; j++) M[i * count + j] = pow(x, j + 1);
    c[i] = r[i];
  }
  if (lag_solve_dense((size_t)count, 1, M, c)) return 0;
  for (int j = 0; j < count; j++) c[j] /= pow(unit, j + 1);
  return 1;
}

static int leading(const Mode *m, lag_problem *pb, const double *y) {
  int leads = 0;
  double most = 0;
  for (int i = 0; i < pb->nq; i++) {
    double size = hypot(m->shape_re[i], m->shape_im[i]) / lag_difference_scale(pb, y, i);
    if (size > most * (1 + 1e-6)) leads = i, most = size;
  }
  return leads;
}

/* The motion of the linear mode, with the amplitude A of coordinate `leads`, which is at its end. */
static void place(const Mode *m, const double *y, int nq, int leads, double A, double *start) {
  double re = m->shape_re[leads], im = m->shape_im[leads], size = re * re + im * im;
  for (int i = 0; i < nq; i++) { /* shape times A / shape[leads] */
    double part = (m->shape_re[i] * re + m->shape_im[i] * im) / size,
           turned = (m->shape_im[i] * re - m->shape_re[i] * im) / size;
    start[i] = y[i] + A * part;
    start[nq + i] = -A * m->im * turned;
  }
}

typedef struct Family {
  const Mode *m;
  lag_sim *like;
  const lag_algebra *algebra;
  const double *y;
  int leads;
} Family;

/* *r := change of the frequency, as a part, of the motion with the amplitude *A, which becomes half its swing. 1:
 * found, 0: not, < 0: a status. */
static int change_at(const Family *f, double *A, double *r) {
  double T = 2 * acos(-1) / f->m->im;
  lag_sim *start = lag_sim_like(f->like);
  if (!start) return LAG_ENOMEM;
  place(f->m, f->y, f->like->pb.nq, f->leads, *A, start->start);
  int found = solve(start, f->algebra, f->leads, f->y[f->leads] + *A, &T, A);
  lag_sim_free(start);
  *r = 2 * acos(-1) / (T * f->m->im) - 1;
  return found;
}

/* *far, halved until the acceleration at the end of the linear motion is that of the mode but for a tenth. LAG_OK, or
 * LAG_ENOMEM. */
static int limit_amplitude(const Family *f, double *far) {
  const double part = 0.1;
  int n = f->like->pb.n, nq = f->like->pb.nq, i = f->leads;
  double *y = calloc(2 * (size_t)n, sizeof *y);
  lag_sim *probe = y ? lag_sim_like(f->like) : NULL;
  int rc = probe ? lag_sim_advance(probe, probe->scene->t0) : LAG_ENOMEM;
  for (int k = 0; k < 60 && rc == LAG_OK; k++) {
    memcpy(y, f->y, (size_t)n * sizeof *y);
    place(f->m, f->y, nq, i, *far, y);
    double *rates = y + n, linear = -*far * f->m->im * f->m->im;
    if (lag_rhs(&probe->pb, probe->scene->t0, y, rates) == 0 && fabs(rates[nq + i] / linear - 1) < part) break;
    *far /= 2;
  }
  lag_sim_free(probe);
  free(y);
  return rc == LAG_ENOMEM ? rc : LAG_OK;
}

/* An amplitude at which the frequency changes by 0.1 to 2 per cent, so that few powers are left and rounding is
 * small; 0: none is found, < 0: a status. */
static double choose_amplitude(const Family *f, double scale) {
  const double least = 1e-3, most = 0.02;
  double far = scale;
  if (limit_amplitude(f, &far)) return LAG_ENOMEM;
  for (int halved = 0, doubled = 0; halved < 20;) {
    double A = far, r = 0;
    int found = change_at(f, &A, &r);
    if (found < 0) return found;
    if (!found || fabs(r) > most) far /= 2, halved++;
    else if (fabs(r) < least && !halved && doubled < 3) far *= 2, doubled++;
    else return far;
  }
  return 0;
}

int lag_mode_amplitude(ModeAmplitude *a, const Modes *modes, int k, lag_sim *like, const lag_algebra *algebra,
                       const double *y) {
  const Mode *m = &modes->mode[k];
  double A[POINTS], r[POINTS], c[POINTS], fewer[POINTS];
  *a = (ModeAmplitude){.leads = -1};
  if (!has_family(modes, k) || !like->pb.nq || like->pb.nz) return LAG_OK;
  Family f = {m, like, algebra, y, leading(m, &like->pb, y)};
  double far = choose_amplitude(&f, 0.2 * lag_difference_scale(&like->pb, y, f.leads));
  if (!(far > 0)) return far < 0 ? LAG_ENOMEM : LAG_OK;
  for (int i = 0; i < POINTS; i++) {
    A[i] = far * sqrt((i + 1.0) / POINTS);
    int found = change_at(&f, &A[i], &r[i]);
    if (found != 1) return found < 0 ? found : LAG_OK;
  }
  if (!fit(POINTS, A, r, c) || !fit(POINTS - 1, A, r, fewer)) return LAG_OK;
  *a = (ModeAmplitude){.leads = f.leads, .a2 = c[0], .a4 = c[1], .error2 = fabs(c[0] - fewer[0]),
                       .error4 = fabs(c[1] - fewer[1])};
  return LAG_OK;
}
