/* A header `--for gsl,cvode,arkode,ida --prefix mm` run by each library: `motions T VALUE...` compares y(T) of every
 * solver with the values. -DFILE_H="the header"; HAS_JAC, HAS_EVENTS: 0 or 1. */
#define MM_IMPLEMENTATION
#include FILE_H
#include <arkode/arkode_arkstep.h>
#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <stdlib.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunlinsol/sunlinsol_klu.h>

enum { N = MM_NY };
static const double TOL = 1e-11;
static int faults, events, checks;
static double end, wanted[N];
static SUNContext context;

static void compare(const char *solver, const double *y, double tolerance) {
  double worst = 0;
  for (int i = 0; i < N; i++) worst = fmax(worst, fabs(y[i] - wanted[i]) / (1 + fabs(wanted[i])));
  printf("%s: %.1e, %d events\n", solver, worst, events);
  faults += !(worst <= tolerance);
  checks++;
}

/* An event at t: its action, in y. */
#if HAS_EVENTS
static void act(const mm_data *d, double t, N_Vector y, const int *found) {
  mm_state s;
  int stop = 0;
  mm_from_y(t, N_VGetArrayPointer(y), &s);
  for (int k = 0; k < MM_NEV; k++)
    if (found[k]) mm_act(k, &d->p, &s, &stop), events++;
  mm_to_y(&s, N_VGetArrayPointer(y));
}
/* The events of the header for the solver s of LIBRARY, and the actions of those that it found. */
#define WATCH(LIBRARY, s, root) \
  (mm_directions(direction), LIBRARY##RootInit(s, MM_NEV, root), LIBRARY##SetRootDirection(s, direction))
#define ACT(LIBRARY, s) (LIBRARY##GetRootInfo(s, found), act(&d, t, y, found))
static int direction[MM_NEV], found[MM_NEV];
#else
#define WATCH(LIBRARY, s, root) ((void)0)
#define ACT(LIBRARY, s) ((void)0)
#endif

static N_Vector begin(mm_data *d, double *t) {
  static const mm_data zero;
  mm_state s;
  N_Vector y = N_VNew_Serial(N, context);
  *d = zero;
  mm_defaults(&d->p);
  mm_start(&d->p, &s);
  mm_to_y(&s, N_VGetArrayPointer(y));
  *t = s.t;
  events = 0;
  return y;
}

#if !HAS_EVENTS
static void by_gsl(const char *name, const gsl_odeiv2_step_type *type, double tolerance) {
  mm_data d;
  double t;
  N_Vector y = begin(&d, &t);
  gsl_odeiv2_system sys = mm_gsl_system(&d);
  gsl_odeiv2_driver *driver = gsl_odeiv2_driver_alloc_y_new(&sys, type, 1e-3, TOL, TOL);
  faults += gsl_odeiv2_driver_apply(driver, &t, end, N_VGetArrayPointer(y)) != 0;
  compare(name, N_VGetArrayPointer(y), tolerance);
  gsl_odeiv2_driver_free(driver);
}
#endif

#if HAS_JAC
static SUNMatrix matrix(int sparse, int nonzero) {
  return sparse ? SUNSparseMatrix(N, N, nonzero, CSC_MAT, context) : SUNDenseMatrix(N, N, context);
}
static SUNLinearSolver solver(int sparse, N_Vector y, SUNMatrix A) {
  return sparse ? SUNLinSol_KLU(y, A, context) : SUNLinSol_Dense(y, A, context);
}
#endif

/* kind: 0 Adams without Jacobian, 1 BDF dense, 2 BDF sparse. */
static void by_cvode(const char *name, int kind, double tolerance) {
  mm_data d;
  double t;
  N_Vector y = begin(&d, &t);
  void *c = CVodeCreate(kind ? CV_BDF : CV_ADAMS, context);
  CVodeInit(c, mm_cvode_rhs, t, y);
  CVodeSetUserData(c, &d);
  CVodeSStolerances(c, TOL, TOL);
  CVodeSetMaxNumSteps(c, 100000);
  CVodeSetStopTime(c, end);
#if HAS_JAC
  SUNMatrix A = matrix(kind == 2, MM_NNZ);
  CVodeSetLinearSolver(c, solver(kind == 2, y, A), A);
  if (kind) CVodeSetJacFn(c, mm_cvode_jac);
#else
  SUNMatrix A = SUNDenseMatrix(N, N, context); /* CVODE's differences */
  CVodeSetLinearSolver(c, SUNLinSol_Dense(y, A, context), A);
#endif
  WATCH(CVode, c, mm_cvode_root);
  int status;
  while ((status = CVode(c, end, y, &t, CV_NORMAL)) == CV_ROOT_RETURN) {
    ACT(CVode, c);
    CVodeReInit(c, t, y);
  }
  faults += status < 0;
  compare(name, N_VGetArrayPointer(y), tolerance);
}

static void by_erk(double tolerance) {
  mm_data d;
  double t;
  N_Vector y = begin(&d, &t);
  void *a = ERKStepCreate(mm_arkode_rhs, t, y, context);
  ERKStepSetUserData(a, &d);
  ERKStepSetOrder(a, 8);
  ERKStepSStolerances(a, TOL, TOL);
  ERKStepSetMaxNumSteps(a, 100000);
  ERKStepSetStopTime(a, end);
  WATCH(ERKStep, a, mm_arkode_root);
  int status;
  while ((status = ERKStepEvolve(a, end, y, &t, ARK_NORMAL)) == ARK_ROOT_RETURN) {
    ACT(ERKStep, a);
    ERKStepReInit(a, mm_arkode_rhs, t, y);
  }
  faults += status < 0;
  compare("ARKODE, explicit", N_VGetArrayPointer(y), tolerance);
}

#if HAS_JAC && !HAS_EVENTS
static void by_ark(const char *name, int sparse, double tolerance) {
  mm_data d;
  double t;
  N_Vector y = begin(&d, &t);
  void *a = ARKStepCreate(NULL, mm_arkode_rhs, t, y, context);
  SUNMatrix A = matrix(sparse, MM_NNZ);
  ARKStepSetUserData(a, &d);
  ARKStepSetOrder(a, 5);
  ARKStepSStolerances(a, 100 * TOL, 100 * TOL);
  ARKStepSetMaxNumSteps(a, 100000);
  ARKStepSetLinearSolver(a, solver(sparse, y, A), A);
  ARKStepSetJacFn(a, mm_arkode_jac);
  ARKStepSetStopTime(a, end);
  faults += ARKStepEvolve(a, end, y, &t, ARK_NORMAL) < 0;
  compare(name, N_VGetArrayPointer(y), tolerance);
}
#endif

static void by_ida(const char *name, int sparse, double tolerance) {
  mm_data d;
  double t;
  N_Vector y = begin(&d, &t), yp = N_VNew_Serial(N, context);
  void *m = IDACreate(context);
  mm_cvode_rhs(t, y, yp, &d); /* y' of the start */
  IDAInit(m, mm_ida_res, t, y, yp);
  IDASetUserData(m, &d);
  IDASStolerances(m, TOL, TOL);
  IDASetMaxNumSteps(m, 100000);
  IDASetStopTime(m, end);
#if HAS_JAC
  SUNMatrix A = matrix(sparse, MM_NNZ_IDA);
  IDASetLinearSolver(m, solver(sparse, y, A), A);
  IDASetJacFn(m, mm_ida_jac);
#else
  SUNMatrix A = SUNDenseMatrix(N, N, context);
  IDASetLinearSolver(m, SUNLinSol_Dense(y, A, context), A);
  (void)sparse;
#endif
  WATCH(IDA, m, mm_ida_root);
  int status;
  while ((status = IDASolve(m, end, &t, y, yp, IDA_NORMAL)) == IDA_ROOT_RETURN) {
    ACT(IDA, m);
    mm_cvode_rhs(t, y, yp, &d);
    IDAReInit(m, t, y, yp);
  }
  faults += status < 0;
  compare(name, N_VGetArrayPointer(y), tolerance);
}

int main(int argc, char **argv) {
  if (argc != 2 + N) return printf("%d values, not %d\n", argc - 2, N), 1;
  end = atof(argv[1]);
  for (int i = 0; i < N; i++) wanted[i] = atof(argv[2 + i]);
  SUNContext_Create(NULL, &context);
#if !HAS_EVENTS
  by_gsl("GSL, rk8pd", gsl_odeiv2_step_rk8pd, 1e-8);
#if HAS_JAC
  by_gsl("GSL, bsimp", gsl_odeiv2_step_bsimp, 1e-8);
  by_gsl("GSL, msbdf", gsl_odeiv2_step_msbdf, 1e-6);
  by_ark("ARKODE, implicit, dense", 0, 1e-6);
  by_ark("ARKODE, implicit, sparse", 1, 1e-6);
#endif
#endif
  by_cvode("CVODE, Adams", 0, 1e-7);
  by_cvode("CVODE, BDF, dense", 1, 1e-6);
  by_erk(1e-8);
  by_ida("IDA, dense", 0, 1e-6);
#if HAS_JAC
  by_cvode("CVODE, BDF, sparse", 2, 1e-6);
  by_ida("IDA, sparse", 1, 1e-6);
#endif
  printf("%d checks, %d faults\n", checks, faults);
  return faults != 0;
}
