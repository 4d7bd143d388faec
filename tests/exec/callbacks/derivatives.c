/* Callbacks of a header `--for gsl,cvode,arkode,ida --prefix mm` of any model: Jacobians against central differences
 * of right-hand sides and residuals, dense and of compressed columns. -DFILE_H="the header"; HAS_JAC, HAS_EVENTS,
 * HAS_INPUTS: 0 or 1; TIME_STEP of differences by time. */
#define MM_IMPLEMENTATION
#include FILE_H
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <string.h>
#include <sunmatrix/sunmatrix_band.h>

#ifndef TIME_STEP
#define TIME_STEP 1e-6
#endif
enum { N = MM_NY };
static int faults;
static mm_data data;
static SUNContext context;

static void expect(int ok, const char *what, double got, double wanted) {
  if (ok) return;
  faults++;
  printf("%s: %.17g, not %.17g\n", what, got, wanted);
}

static int near(double a, double b, double scale) { return fabs(a - b) <= 2e-5 * scale; }

static void residual(double t, const double *y, const double *rate, double *r) {
  N_Vector Y = N_VMake_Serial(N, (double *)y, context), D = N_VMake_Serial(N, (double *)rate, context),
           R = N_VMake_Serial(N, r, context);
  if (mm_ida_res(t, Y, D, R, &data) != 0) faults++, puts("no residual");
  N_VDestroy(Y), N_VDestroy(D), N_VDestroy(R);
}

/* Both kinds of matrices have the entries J. */
static void same(const char *what, const double *J, SUNMatrix dense, SUNMatrix sparse, int nonzero) {
  double *all = calloc(N * N, sizeof(double));
  const sunindextype *first = SM_INDEXPTRS_S(sparse), *row = SM_INDEXVALS_S(sparse);
  expect(first[N] == nonzero, "number of entries", (double)first[N], nonzero);
  for (int j = 0; j < N; j++)
    for (sunindextype k = first[j]; k < first[j + 1]; k++) {
      expect(k == first[j] || row[k] > row[k - 1], "rows ascend", (double)row[k], 0);
      all[row[k] * N + j] = SM_DATA_S(sparse)[k];
    }
  for (int k = 0; k < N * N; k++) {
    expect(SM_ELEMENT_D(dense, k / N, k % N) == J[k], what, SM_ELEMENT_D(dense, k / N, k % N), J[k]);
    expect(all[k] == J[k], what, all[k], J[k]);
  }
  free(all);
}

int main(void) {
  double y[N], f[N], rate[N], r0[N], r1[N], scale = 0;
  mm_state s, back;
  memset(&data, 0, sizeof data);
  mm_defaults(&data.p);
  mm_start(&data.p, &s);
  mm_to_y(&s, y);
  mm_from_y(s.t, y, &back);
  expect(memcmp(&s, &back, sizeof s) == 0, "a state to y and back", 0, 0);
  for (int i = 0; i < N; i++) y[i] += 0.01 * sin(3 + 7 * i) * (1 + fabs(y[i]));
  s.t += 0.013;
  SUNContext_Create(NULL, &context);
#if HAS_INPUTS /* held by the caller, not those of the formulas */
  double u[MM_NU], own[N];
  for (int i = 0; i < MM_NU; i++) u[i] = 0.7 + i;
  data.u = u;
  expect(mm_cvode_rhs(s.t, N_VMake_Serial(N, y, context), N_VMake_Serial(N, own, context), &data) == 0 &&
             mm_rhs(s.t, y, &data.p, u, f) == 0,
         "rates", 0, 0);
  expect(memcmp(f, own, sizeof f) == 0, "rates of the caller's inputs", own[0], f[0]);
#endif
#if HAS_INPUTS && HAS_EVENTS
  double g[MM_NEV];
  expect(mm_ida_root(s.t, N_VMake_Serial(N, y, context), NULL, g, &data) == 0 && g[0] == 0.7 * y[0] - 1,
         "an event of an input", g[0], 0.7 * y[0] - 1);
#endif
  gsl_odeiv2_system sys = mm_gsl_system(&data);
  expect(sys.dimension == N && sys.function(s.t, y, f, sys.params) == 0, "the rates", 0, 0);
  N_Vector Y = N_VMake_Serial(N, y, context), F = N_VNew_Serial(N, context), R = N_VMake_Serial(N, rate, context);
  expect(mm_cvode_rhs(s.t, Y, F, &data) == 0 && memcmp(f, N_VGetArrayPointer(F), sizeof f) == 0, "CVODE's rates", 0, 0);
  expect(mm_arkode_rhs(s.t, Y, F, &data) == 0 && memcmp(f, N_VGetArrayPointer(F), sizeof f) == 0, "ARKODE's rates", 0,
         0);
  residual(s.t, y, f, r0);
  for (int i = 0; i < N; i++) rate[i] = f[i] + 0.1 * cos(5 * i) * (1 + fabs(f[i]));
  residual(s.t, y, rate, r1);
  double size = 0;
  for (int i = 0; i < N; i++) size += fabs(r1[i]);
  for (int i = 0; i < N; i++) expect(fabs(r0[i]) <= 1e-9 * size, "residual of the rates", r0[i], 0);
  expect(size > 0, "residual of other rates", size, 1);
#if HAS_JAC
  double *J = calloc(N * N, sizeof *J), *G = calloc(N * N, sizeof *G), dfdt[N], e0[N], e1[N];
  expect(sys.jacobian && sys.jacobian(s.t, y, J, dfdt, sys.params) == 0, "GSL's Jacobian", 0, 0);
  for (int j = 0; j <= N; j++) { /* column N: time */
    double h = j < N ? 1e-6 * (1e-2 + fabs(y[j])) : TIME_STEP, t0 = s.t - h * (j == N), t1 = s.t + h * (j == N),
           was = j < N ? y[j] : 0;
    if (j < N) y[j] = was - h;
    sys.function(t0, y, e0, sys.params);
    if (j < N) y[j] = was + h;
    sys.function(t1, y, e1, sys.params);
    if (j < N) y[j] = was;
    scale = 0;
    for (int i = 0; i < N; i++)
      scale = fmax(scale, fabs((e1[i] - e0[i]) / (2 * h)) + 1e-5 * fabs(f[i]) / (1e-2 + (j < N ? fabs(y[j]) : 1)));
    for (int i = 0; i < N; i++) {
      double got = j < N ? J[i * N + j] : dfdt[i];
      expect(near(got, (e1[i] - e0[i]) / (2 * h), scale), j < N ? "an entry of J" : "df/dt", got,
             (e1[i] - e0[i]) / (2 * h));
    }
  }
  SUNMatrix D = SUNDenseMatrix(N, N, context), S = SUNSparseMatrix(N, N, MM_NNZ, CSC_MAT, context),
            T = SUNSparseMatrix(N, N, MM_NNZ_IDA, CSC_MAT, context);
  SUNMatrix B = SUNBandMatrix(N, 1, 1, context), W = SUNSparseMatrix(N, N, MM_NNZ, CSR_MAT, context);
  expect(mm_cvode_jac(s.t, Y, F, D, &data, F, F, F) == 0 && mm_cvode_jac(s.t, Y, F, S, &data, F, F, F) == 0,
         "CVODE's Jacobians", 0, 0);
  same("an entry of CVODE's", J, D, S, MM_NNZ);
  SUNMatZero(D), SUNMatZero(S);
  expect(mm_arkode_jac(s.t, Y, F, D, &data, F, F, F) == 0 && mm_arkode_jac(s.t, Y, F, S, &data, F, F, F) == 0,
         "ARKODE's Jacobians", 0, 0);
  same("an entry of ARKODE's", J, D, S, MM_NNZ);
  expect(mm_cvode_jac(s.t, Y, F, B, &data, F, F, F) < 0 && mm_cvode_jac(s.t, Y, F, W, &data, F, F, F) < 0,
         "other matrices are refused", 0, 0);

  const double c = 37.5;
  SUNMatZero(D);
  expect(mm_ida_jac(s.t, c, Y, R, F, D, &data, F, F, F) == 0 && mm_ida_jac(s.t, c, Y, R, F, T, &data, F, F, F) == 0,
         "IDA's Jacobians", 0, 0);
  for (int k = 0; k < N * N; k++) G[k] = SM_ELEMENT_D(D, k / N, k % N);
  same("an entry of IDA's", G, D, T, MM_NNZ_IDA);
  for (int j = 0; j < N; j++) {
    double h = 1e-6 * (1e-2 + fabs(y[j])), d[N];
    const double was = y[j], was_rate = rate[j];
    y[j] = was - h, residual(s.t, y, rate, e0);
    y[j] = was + h, residual(s.t, y, rate, e1);
    y[j] = was;
    for (int i = 0; i < N; i++) d[i] = (e1[i] - e0[i]) / (2 * h);
    rate[j] = was_rate - 1, residual(s.t, y, rate, e0); /* linear in the rates */
    rate[j] = was_rate + 1, residual(s.t, y, rate, e1);
    rate[j] = was_rate;
    scale = 0;
    for (int i = 0; i < N; i++) d[i] += c * (e1[i] - e0[i]) / 2, scale = fmax(scale, fabs(d[i]));
    for (int i = 0; i < N; i++)
      expect(near(G[i * N + j], d[i], scale + 1e-6 * size / (1e-2 + fabs(y[j]))), "an entry of IDA's J", G[i * N + j],
             d[i]);
  }
#else
  expect(!sys.jacobian, "no Jacobian", 0, 0);
#endif
  return faults != 0;
}
