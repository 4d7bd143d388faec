/* What driver.c compares: functions like lag_model.accel, for double. */
#ifndef BENCH_ACCEL_H
#define BENCH_ACCEL_H

#define ACCEL(name)                                                                                            \
  int name(const void *self, double t, const double *q, const double *v, const double *z, const double *p,     \
           const double *u, double *a, double *zd, double *w);                                                 \
  int name(const void *self, double t, const double *q, const double *v, const double *z, const double *p,     \
           const double *u, double *a, double *zd, double *w)
#define UNUSED(x) (void)(x)
#define ONLY_QVP UNUSED(self), UNUSED(t), UNUSED(z), UNUSED(u), UNUSED(zd), UNUSED(w)

#endif
