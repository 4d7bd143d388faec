/* SUNDIALS: CVODE's Adams methods with fixed-point iteration, and ARKODE's explicit method of order 8 (Fehlberg's 13
 * stages). */
#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <string.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "methods.h"

static int call(realtype t, N_Vector y, N_Vector dy, void *f) {
  return (*(bench_rhs **)f)(t, N_VGetArrayPointer(y), N_VGetArrayPointer(dy), NULL);
}

double peer_adams(int problem, bench_rhs *f, int n, double t, double tol, double *y) {
  SUNContext context;
  double at = 0;
  (void)problem;
  if (SUNContext_Create(NULL, &context)) return -1;
  N_Vector v = N_VMake_Serial(n, y, context);
  void *mem = CVodeCreate(CV_ADAMS, context);
  SUNNonlinearSolver solver = SUNNonlinSol_FixedPoint(v, 0, context);
  int rc = CVodeInit(mem, call, 0, v) || CVodeSStolerances(mem, tol, tol) || CVodeSetUserData(mem, &f) ||
           CVodeSetMaxNumSteps(mem, 200000) || CVodeSetNonlinearSolver(mem, solver) || CVodeSetStopTime(mem, t);
  CVodeSetErrFile(mem, NULL);
  double t0 = bench_now();
  rc = rc || CVode(mem, t, v, &at, CV_NORMAL) < 0;
  double took = bench_now() - t0;
  CVodeFree(&mem);
  SUNNonlinSolFree(solver);
  N_VDestroy(v);
  SUNContext_Free(&context);
  return rc ? -1 : took;
}

double peer_arkode(int problem, bench_rhs *f, int n, double t, double tol, double *y) {
  SUNContext context;
  double at = 0;
  (void)problem;
  if (SUNContext_Create(NULL, &context)) return -1;
  N_Vector v = N_VMake_Serial(n, y, context);
  void *mem = ERKStepCreate(call, 0, v, context);
  int rc = ERKStepSStolerances(mem, tol, tol) || ERKStepSetUserData(mem, &f) || ERKStepSetOrder(mem, 8) ||
           ERKStepSetMaxNumSteps(mem, 200000) || ERKStepSetStopTime(mem, t);
  ERKStepSetErrFile(mem, NULL);
  double t0 = bench_now();
  rc = rc || ERKStepEvolve(mem, t, v, &at, ARK_NORMAL) < 0;
  double took = bench_now() - t0;
  ERKStepFree(&mem);
  N_VDestroy(v);
  SUNContext_Free(&context);
  return rc ? -1 : took;
}
