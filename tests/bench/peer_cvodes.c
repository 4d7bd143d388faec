/* Sensitivities by all parameters and the gradient of the sum of the state at the end: liblag's forward and reverse
 * mode beside SUNDIALS' CVODES (Adams, fixed point; forward: simultaneous, with error control of the columns; adjoint:
 * marks every 100 steps, Hermite). Both have the equations and derivatives that lagc emits: methods are compared.
 * Then forward mode beside differences of runs by dop853, at 1e-6. Included: model.h, a header with prefix bench, and
 * the macro SCENE; leaves: the least time for an error of 1e-8. */
#include <cvodes/cvodes.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "lag.h"
#include "lag_method.h"
#include "model.h"

enum { N = BENCH_NY, NP = sizeof(bench_params) / sizeof(double), MARKS = 100 };
extern const lag_scene SCENE;
static double goal = 1e-8;
static double end, start[N];
static bench_params params;

typedef int Solver(double tol, double *out, double *took); /* out[N NP] sensitivities, or out[NP] gradient */

static double *data(N_Vector v) { return N_VGetArrayPointer(v); }

static int rates(realtype t, N_Vector y, N_Vector dy, void *of) {
  (void)of;
  return bench_rhs(t, data(y), &params, data(dy));
}

static int columns(int ns, realtype t, N_Vector y, N_Vector dy, N_Vector *s, N_Vector *ds, void *of, N_Vector a,
                   N_Vector b) {
  static double J[N * N], P[N * NP];
  (void)dy, (void)of, (void)a, (void)b;
  memset(J, 0, sizeof J), memset(P, 0, sizeof P);
  int rc = bench_jac(t, data(y), data(y) + N / 2, &params, J) || bench_dparams(t, data(y), data(y) + N / 2, &params, P);
  for (int c = 0; c < ns; c++)
    for (int i = 0; i < N; i++) {
      double sum = P[i * NP + c];
      for (int k = 0; k < N; k++) sum += J[i * N + k] * data(s[c])[k];
      data(ds[c])[i] = sum;
    }
  return rc;
}

static int forward(double tol, double *out, double *took) {
  SUNContext context;
  double at = 0;
  if (SUNContext_Create(NULL, &context)) return -1;
  N_Vector y = N_VNew_Serial(N, context), *s = N_VCloneVectorArray(NP, y);
  void *mem = CVodeCreate(CV_ADAMS, context);
  SUNNonlinearSolver of_y = SUNNonlinSol_FixedPoint(y, 0, context),
                     all = SUNNonlinSol_FixedPointSens(NP + 1, y, 0, context);
  double each[NP];
  memcpy(data(y), start, sizeof start);
  for (int c = 0; c < NP; c++) N_VConst(0, s[c]), each[c] = tol;
  int rc = CVodeInit(mem, rates, 0, y) || CVodeSStolerances(mem, tol, tol) || CVodeSetMaxNumSteps(mem, 200000) ||
           CVodeSetNonlinearSolver(mem, of_y) || CVodeSetStopTime(mem, end) ||
           CVodeSensInit(mem, NP, CV_SIMULTANEOUS, columns, s) || CVodeSensSStolerances(mem, tol, each) ||
           CVodeSetSensErrCon(mem, 1) || CVodeSetNonlinearSolverSensSim(mem, all);
  double t0 = lag_clock_seconds();
  rc = rc || CVode(mem, end, y, &at, CV_NORMAL) < 0 || CVodeGetSens(mem, &at, s);
  *took = lag_clock_seconds() - t0;
  for (int c = 0; c < NP; c++)
    for (int i = 0; i < N; i++) out[i * NP + c] = data(s[c])[i];
  CVodeFree(&mem);
  SUNNonlinSolFree(of_y), SUNNonlinSolFree(all);
  N_VDestroyVectorArray(s, NP), N_VDestroy(y);
  SUNContext_Free(&context);
  return rc;
}

static int back(realtype t, N_Vector y, N_Vector l, N_Vector dl, void *of) {
  (void)of;
  int rc = bench_vjp(t, data(y), data(y) + N / 2, &params, data(l), data(dl));
  for (int i = 0; i < N; i++) data(dl)[i] *= -1;
  return rc;
}

static int by_parameters(realtype t, N_Vector y, N_Vector l, N_Vector dq, void *of) {
  static double P[N * NP];
  (void)of;
  memset(P, 0, sizeof P);
  int rc = bench_dparams(t, data(y), data(y) + N / 2, &params, P);
  N_VConst(0, dq);
  for (int i = 0; i < N; i++)
    for (int c = 0; c < NP; c++) data(dq)[c] -= data(l)[i] * P[i * NP + c];
  return rc;
}

static int adjoint(double tol, double *out, double *took) {
  SUNContext context;
  double at = 0;
  int marks = 0, which = 0;
  if (SUNContext_Create(NULL, &context)) return -1;
  N_Vector y = N_VNew_Serial(N, context), l = N_VClone(y), q = N_VNew_Serial(NP, context);
  void *mem = CVodeCreate(CV_ADAMS, context);
  SUNNonlinearSolver of_y = SUNNonlinSol_FixedPoint(y, 0, context), of_l = SUNNonlinSol_FixedPoint(l, 0, context);
  memcpy(data(y), start, sizeof start);
  N_VConst(1, l), N_VConst(0, q);
  int rc = CVodeInit(mem, rates, 0, y) || CVodeSStolerances(mem, tol, tol) || CVodeSetMaxNumSteps(mem, 200000) ||
           CVodeSetNonlinearSolver(mem, of_y) || CVodeAdjInit(mem, MARKS, CV_HERMITE);
  double t0 = lag_clock_seconds();
  rc = rc || CVodeF(mem, end, y, &at, CV_NORMAL, &marks) < 0 || CVodeCreateB(mem, CV_ADAMS, &which) ||
       CVodeInitB(mem, which, back, end, l) || CVodeSStolerancesB(mem, which, tol, tol) ||
       CVodeSetMaxNumStepsB(mem, which, 200000) || CVodeSetNonlinearSolverB(mem, which, of_l) ||
       CVodeQuadInitB(mem, which, by_parameters, q) || CVodeQuadSStolerancesB(mem, which, tol, tol) ||
       CVodeSetQuadErrConB(mem, which, 1) || CVodeB(mem, 0, CV_NORMAL) < 0 || CVodeGetQuadB(mem, which, &at, q);
  *took = lag_clock_seconds() - t0;
  memcpy(out, data(q), NP * sizeof *out);
  CVodeFree(&mem);
  SUNNonlinSolFree(of_y), SUNNonlinSolFree(of_l);
  N_VDestroy(q), N_VDestroy(l), N_VDestroy(y);
  SUNContext_Free(&context);
  return rc;
}

static lag_sim *simulation(double tol) {
  lag_sim *sim = lag_sim_new(&SCENE);
  if (sim && (lag_sim_set_method(sim, lag_find_method("dop853"), NULL, 0) || lag_sim_set_tolerance(sim, tol)))
    lag_sim_free(sim), sim = NULL;
  return sim;
}

static int our_forward(double tol, double *out, double *took) {
  static const char *name[NP];
  lag_sim *sim = simulation(tol);
  for (int c = 0; c < NP; c++) name[c] = lag_item(&SCENE, 'p', c, NULL, NULL, NULL);
  int rc = sim ? lag_sim_set_sensitivity(sim, NP, name) : -1;
  double t0 = lag_clock_seconds();
  rc = rc ? rc : lag_sim_advance(sim, end) || lag_sim_tangent(sim, out);
  *took = lag_clock_seconds() - t0;
  lag_sim_free(sim);
  return rc;
}

static int our_adjoint(double tol, double *out, double *took) {
  double weight[N], by_start[N];
  for (int i = 0; i < N; i++) weight[i] = 1;
  lag_sim *sim = simulation(tol);
  int rc = sim ? lag_sim_record(sim) : -1;
  double t0 = lag_clock_seconds();
  rc = rc ? rc : lag_sim_advance(sim, end) || lag_sim_gradient(sim, 1, &end, weight, by_start, out);
  *took = lag_clock_seconds() - t0;
  lag_sim_free(sim);
  return rc;
}

/* Central differences of two runs a parameter, with the best steps for the runs' error. */
static int differences(double tol, double *out, double *took) {
  *took = 0;
  for (int c = 0; c < NP; c++) {
    const char *name = lag_item(&SCENE, 'p', c, NULL, NULL, NULL);
    double y[2][N], h = 0;
    for (int k = 0; k < 2; k++) {
      lag_sim *sim = simulation(tol);
      double p = sim ? lag_sim_p(sim)[c] : NAN;
      h = cbrt(tol) * fmax(fabs(p), 1e-3);
      int rc = !sim || lag_sim_set(sim, name, k ? p - h : p + h);
      double t0 = lag_clock_seconds();
      rc = rc || lag_sim_advance(sim, end);
      *took += lag_clock_seconds() - t0;
      if (!rc) memcpy(y[k], lag_sim_q(sim), sizeof y[k]);
      lag_sim_free(sim);
      if (rc) return rc;
    }
    for (int i = 0; i < N; i++) out[i * NP + c] = (y[0][i] - y[1][i]) / (2 * h);
  }
  return 0;
}

/* The least time whose error, relative to the largest number, is below the goal; NAN: none. */
static double least_time(Solver *solve, int n, const double *right, double *error) {
  double *x = malloc((size_t)n * sizeof *x), best = NAN, size = 0;
  for (int i = 0; i < n; i++) size = fmax(size, fabs(right[i]));
  for (double tol = 1e-5; tol > 1e-14; tol /= 3.1622776601683795)
    for (int round = 0; round < 5; round++) {
      double took = 0, far = 0;
      if (solve(tol, x, &took)) break;
      for (int i = 0; i < n; i++) far = fmax(far, fabs(x[i] - right[i]) / size);
      if (far < goal && !(took > best)) best = took, *error = far;
    }
  free(x);
  return best;
}

static void compare(const char *what, Solver *ours, Solver *peer, int n, const double *right) {
  double error[2] = {NAN, NAN}, a = least_time(ours, n, right, &error[0]), b = least_time(peer, n, right, &error[1]);
  printf("  %-21s %10.1f us (error %.0e) %10.1f us (error %.0e) %8.2f\n", what, 1e6 * a, error[0], 1e6 * b, error[1],
         b / a);
}

int main(int argc, char **argv) {
  static double right[N * NP], sum[NP], took;
  end = argc > 1 ? atof(argv[1]) : 1;
  bench_defaults(&params);
  lag_sim *sim = simulation(1e-13);
  if (!sim) return 1;
  memcpy(start, lag_sim_q(sim), sizeof start);
  lag_sim_free(sim);
  if (our_forward(3e-14, right, &took)) return 1;
  for (int c = 0; c < NP; c++)
    for (int i = 0; i < N; i++) sum[c] += right[i * NP + c];
  printf("%s to %g s, %d parameters: liblag's dop853, CVODES, time of CVODES over ours\n", SCENE.model->name, end, NP);
  compare("forward", our_forward, forward, N * NP, right);
  compare("adjoint", our_adjoint, adjoint, NP, sum);
  goal = 1e-6; /* which differences reach */
  compare("... 1e-6, differences", our_forward, differences, N * NP, right);
  return 0;
}
